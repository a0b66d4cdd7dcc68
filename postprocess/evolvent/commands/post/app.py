"""Program evolvent-post: the table of its commands."""

from evolvent.commands.program import make_program

COMMANDS = {
    "animate": "Write an animation of the rotating wheels and the forces on their teeth.",
    "check": "Check the invariants of runs.",
    "plot": "Draw quantities over time, the roll angle or the path of contact, also of several "
    "histories.",
    "report": "Write one self-contained HTML page about a run.",
    "compare": "Show the largest difference of every variable of two runs.",
    "spectrum": "Show the lines of a signal: amplitudes and phases over frequency or order.",
    "waterfall": "Show how the lines of a signal change with the speed: an order map.",
    "sidebands": "Show the sidebands of mesh orders for each wheel, and their modulation.",
    "campbell": "Show the speeds at which orders of meshes and wheels equal natural frequencies.",
}
TEXT = """Check, draw and compare the histories that `evolvent run` writes.

    \b
    Exit codes:
       0  done
       1  an invariant is violated, or a difference is beyond the tolerance
       2  wrong usage of the command line
       3  a file is not a readable history
      74  output could not be written
    """

main = make_program("evolvent-post", __package__, COMMANDS, TEXT, unused=("dask", "pyarrow"))
