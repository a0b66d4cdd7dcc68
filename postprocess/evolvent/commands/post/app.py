"""Program evolvent-post: the table of its commands."""

from evolvent.commands.program import make_program

COMMANDS = {
    "animate": "Write a moving picture: the turning wheels and the forces on their teeth.",
    "check": "Check the invariants of runs: what must hold whatever the case.",
    "plot": "Draw quantities over time, the roll angle or the path of contact; several histories "
    "in one.",
    "report": "Write one self-contained HTML page about a run.",
    "compare": "Show the largest difference of every variable of two runs.",
    "spectrum": "Show the lines of a signal: amplitudes and phases over frequency or order.",
    "waterfall": "Show how the lines of a signal change with the speed: an order map.",
    "sidebands": "Show the lines beside the orders of a mesh, wheel by wheel, and how much they "
    "modulate it.",
    "campbell": "Show at which speeds the orders of meshes and wheels meet the natural "
    "frequencies.",
}
TEXT = """Check, draw and compare the histories that `evolvent run` writes.

    \b
    Exit codes:
       0  done
       1  an invariant is broken, or a difference is beyond the tolerance
       2  wrong usage of the command line
       3  a file is no readable history
      74  output could not be written
    """

main = make_program("evolvent-post", __package__, COMMANDS, TEXT, unused=("dask", "pyarrow"))
