"""The command evolvent-sweep run."""

from __future__ import annotations

from enum import StrEnum
from typing import Annotated

from evolvent.commands.command_line import WrongUsageError, option
from evolvent.commands.sweep.common import DesignFile, Into, Jobs, report_result


class ExecutorName(StrEnum):
    """Executor of the cases."""

    EMBEDDED = "embedded"
    DASK = "dask"


def run(
    design_file: DesignFile,
    output: Into,
    jobs: Jobs = None,
    executor: Annotated[
        ExecutorName,
        option("--executor", "Executor of the cases: this machine, or a Dask cluster."),
    ] = ExecutorName.EMBEDDED,
    scheduler: Annotated[
        str | None,
        option(
            "--scheduler ADDRESS",
            "Address of the Dask scheduler; if not given, workers on this machine.",
        ),
    ] = None,
    shards: Annotated[
        int | None,
        option(
            "--shards N",
            "Split the cases into N shards; if not given, 1, or the number of shards in the "
            "folder.",
            min=1,
        ),
    ] = None,
) -> None:
    """Run the missing cases of a design on this machine.

    \b
    The command can be interrupted at any time. Repeat it to continue. With a Dask cluster, all
    workers must have access to the folder.
    Example:
      evolvent-sweep run torque.h5 -o torque
    """  # noqa: D301
    from evolvent.sweep import dask, folder
    from evolvent.sweep.journal import read_records
    from evolvent.sweep.program import cores, find_program, program_version
    from evolvent.sweep.run import Tally, Work, run_shards

    if scheduler is not None and executor is not ExecutorName.DASK:
        raise WrongUsageError("only with --executor dask", "--scheduler")
    program = find_program()
    design = folder.open_for_run(design_file, output, program_version(program))
    workers = jobs or cores()
    records = read_records(output, design, scalars=False)
    split = shards or folder.common_split(output, records.shards)
    if executor is ExecutorName.DASK:
        split = split or dask.split(design, program, workers)
    todo = folder.remaining_shards(records.recorded, split or 1)
    work, tally = Work(program, design_file, output), Tally(output, records)
    if executor is ExecutorName.DASK:
        code = dask.run(work, todo, workers, scheduler, tally)
    else:
        code = run_shards(work, todo, workers, tally)
    raise SystemExit(report_result(output, code))
