"""The program evolvent-post: its commands."""

from evolvent.commands.program import make_program

COMMANDS = (
    "animate",
    "check",
    "plot",
    "report",
    "compare",
    "spectrum",
    "waterfall",
    "sidebands",
    "campbell",
)
TEXT = """Check, draw and compare the histories that `evolvent run` writes.

    \b
    Exit codes:
       0  done
       1  an invariant is broken, or a difference is beyond the tolerance
       2  wrong usage of the command line
       3  a file is no readable history
      74  output could not be written
    """

main = make_program("evolvent-post", __package__, COMMANDS, TEXT)
