"""Program evolvent-post: the table of its commands."""

from evolvent.commands.program import make_program

COMMANDS = {
    "animate": "Write an animation of the rotating wheels and the tooth forces.",
    "check": "Check the invariants of runs: energy, torques, contact, geometry.",
    "plot": "Plot results over time, roll angle or path of contact.",
    "report": "Write a report of a run as one HTML page.",
    "compare": "Show the largest difference between two runs for every variable.",
    "spectrum": "Compute the spectrum of a signal: amplitudes and phases over frequency or order.",
    "waterfall": "Compute the spectra of a signal over the speed: a waterfall or order map.",
    "sidebands": "Compute the sidebands of mesh orders for each wheel, and their modulation.",
    "campbell": "Compute a Campbell diagram: speeds at which mesh and wheel orders excite "
    "natural frequencies.",
    "fatigue": "Count load cycles of teeth: root stress, tooth force, damage, safety factors.",
}
TEXT = """Check, plot and compare the time histories that `evolvent run` writes.

    \b
    Exit codes:
       0  done
       1  an invariant is violated, or a difference is beyond the tolerance
       2  invalid command line
       3  a file is not a readable history
      74  output could not be written
    """

main = make_program("evolvent-post", __package__, COMMANDS, TEXT, unused=("dask", "pyarrow"))
