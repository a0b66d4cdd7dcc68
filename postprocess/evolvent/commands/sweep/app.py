"""Program evolvent-sweep: the table of its commands."""

from evolvent.commands.program import make_program

COMMANDS = {
    "plan": "Create a design (the table of all cases) from a plan.",
    "run": "Run the missing cases of a design on this machine.",
    "slurm": "Write and submit Slurm job arrays for the shards, and a job that collects the "
    "results.",
    "collect": "Write all results to one file for xarray.",
    "status": "Show finished, failed and missing cases, reasons of failures, and the expected "
    "end time.",
    "retry": "Run recorded cases again; the new records replace the old ones.",
    "plot": "Plot a result over one or two parameters.",
}
TEXT = """Parameter sweeps: many cases of one gearbox, on this machine or on a Slurm cluster.

    \b
    Exit codes:
       0  done
       1  done, but some cases failed or were refused, or would be refused
       2  invalid command line
       3  invalid plan, design, folder or summary
      74  output could not be written
      75  interrupted; repeat the command to continue
    """

main = make_program("evolvent-sweep", __package__, COMMANDS, TEXT)
