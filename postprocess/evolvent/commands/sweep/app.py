"""The program evolvent-sweep: its commands."""

from evolvent.commands.program import make_program

COMMANDS = (
    "plan",
    "run",
    "slurm",
    "collect",
    "status",
    "retry",
    "plot",
)
TEXT = """Parameter sweeps: many cases of one gearbox, here or on a Slurm cluster.

    \b
    Exit codes:
       0  done
       1  done, but some cases failed or were refused, or would be
       2  wrong usage of the command line
       3  bad plan, design, folder or summary
      74  output could not be written
      75  interrupted; the same command goes on
    """

main = make_program("evolvent-sweep", __package__, COMMANDS, TEXT)
