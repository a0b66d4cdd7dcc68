"""The command evolvent-sweep retry."""

from __future__ import annotations

from typing import Annotated

from evolvent.commands.command_line import WrongUsageError, option
from evolvent.commands.program import say
from evolvent.commands.sweep.common import Folder, Jobs, report_result
from evolvent.commands.sweep.slurm_jobs import to_slurm
from evolvent.commands.sweep.slurm_options import Order, with_options_of_slurm
from evolvent.errors import SweepError


@with_options_of_slurm
def retry(
    directory: Folder,
    failed: Annotated[
        bool, option("--failed", "Run all cases again that failed or were refused.")
    ] = False,
    case: Annotated[
        list[int] | None, option("--case NUMBER", "Run this case again; may be repeated.")
    ] = None,
    jobs: Jobs = None,
    on_slurm: Annotated[
        bool, option("--slurm", "Run the cases as Slurm jobs, with the options below.")
    ] = False,
    *,
    order: Order,
) -> None:
    """Run recorded cases again; the new records replace the old ones.

    \b
    With --slurm the cases run in job arrays, with one task for each shard that recorded some of
    them. The summary is then collected again.
    Example:
      evolvent-sweep retry torque --failed
      evolvent-sweep retry torque --case 17 --slurm --time 00:30:00
    """  # noqa: D301
    import numpy as np

    from evolvent.sweep import folder
    from evolvent.sweep.journal import read_records
    from evolvent.sweep.program import cores, find_program, program_version
    from evolvent.sweep.retry import folder_of_lists, retry_cases, write_lists

    if not failed and not case:
        raise WrongUsageError("select the cases to run again; --failed, or --case NUMBER")
    if not on_slurm and order != Order():
        raise WrongUsageError("Slurm options require --slurm", "--slurm")
    if on_slurm and jobs is not None:
        raise WrongUsageError("has no meaning with --slurm; use --cores", "--jobs")
    program = find_program()
    if not (directory / folder.COPY).exists():
        what = f"has no {folder.COPY}" if directory.is_dir() else "no such folder"
        raise SweepError(f"{directory}: {what}; it contains no runs")
    design = folder.open_for_run(directory / folder.COPY, directory, program_version(program))
    records = read_records(directory, design, scalars=False)
    selected = set(np.flatnonzero(records.unfinished).tolist() if failed else []) | set(case or [])
    outside = [number for number in selected if not 0 <= number < design.n_cases]
    if outside:
        raise WrongUsageError(f"{outside[0]}: the cases are 0 to {design.n_cases - 1}", "--case")
    if not selected:
        say(f"{directory}: no case failed or was refused")
        return
    if on_slurm:
        lists = folder_of_lists(directory)
        shards = list(write_lists(records, sorted(selected), lists))
        to_slurm(program, directory, shards, order, lists)
        return
    code = retry_cases(program, directory, records, sorted(selected), jobs or cores())
    raise SystemExit(report_result(directory, code))
