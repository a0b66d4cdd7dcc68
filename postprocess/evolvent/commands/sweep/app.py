"""Program evolvent-sweep: the table of its commands."""

from evolvent.commands.program import make_program

COMMANDS = {
    "plan": "Make a design, the table of all cases, from a plan.",
    "run": "Run what is missing of a design, here and now.",
    "slurm": "Write job arrays of shards and a job that collects, for Slurm, and submit them.",
    "collect": "Write one file of all results, for xarray.",
    "status": "Show what is done, what failed and why, what is missing, and when it will be "
    "finished.",
    "retry": "Run cases again that are recorded already; the new records count.",
    "plot": "Draw a result against one or two parameters.",
}
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
