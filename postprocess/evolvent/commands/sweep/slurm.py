"""The commands evolvent-sweep slurm and retry: jobs of a cluster, and cases once more."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import numpy as np
import typer

from evolvent.commands.sweep.common import DesignFile, Folder, Into, Jobs, told
from evolvent.commands.sweep.slurm_options import Order, with_options_of_slurm
from evolvent.sweep import folder
from evolvent.sweep import slurm as scripts
from evolvent.sweep.errors import USAGE, SweepError
from evolvent.sweep.estimate import seconds_per_case
from evolvent.sweep.journal import read_records
from evolvent.sweep.program import cores, find_program, program_version


@with_options_of_slurm
def slurm(
    design_file: DesignFile,
    output: Into,
    shards: Annotated[
        int | None,
        typer.Option(
            "--shards", metavar="N", min=1, help="Split into N shards; of ten minutes if not given."
        ),
    ] = None,
    *,
    order: Order,
) -> None:
    """Write job arrays of shards and a job that collects, for Slurm, and submit them.

    \b
    Only shards of which a case is missing are in the arrays: to go on, give the same command. More
    shards than the Slurm here takes in an array (MaxArraySize) go into several. The collecting job
    writes DIR/summary.h5 when all shards have ended, however they did.
    Example:
      evolvent-sweep slurm torque.h5 -o torque --shards 4 --time 00:30:00 --account gears
    """  # noqa: D301
    program = find_program()
    design = folder.open_for_run(design_file, output, program_version(program))
    split = shards or folder.common_split(output)
    if split is None:
        seconds, _ = seconds_per_case(design, program)
        split = scripts.shard_count(design.n_cases, seconds, order.cpus)
    if split > design.n_cases:
        raise SweepError(f"--shards {split}: the design has only {design.n_cases} cases", USAGE)
    todo = folder.remaining_shards(read_records(output, design, scalars=False).recorded, split)
    if not todo:
        typer.echo(f"{output}: all {design.n_cases} cases are recorded; there is nothing to run")
        return
    _to_slurm(program, output, todo, order)


@with_options_of_slurm
def retry(
    directory: Folder,
    failed: Annotated[
        bool, typer.Option("--failed", help="All cases that did not finish.")
    ] = False,
    case: Annotated[
        list[int] | None, typer.Option(metavar="NUMBER", help="This case; may be repeated.")
    ] = None,
    jobs: Jobs = None,
    on_slurm: Annotated[
        bool, typer.Option("--slurm", help="As jobs of Slurm; the options below are for them.")
    ] = False,
    *,
    order: Order,
) -> None:
    """Run cases again that are recorded already; the new records count.

    \b
    With --slurm the cases go into job arrays, a task for each shard that recorded some of them, and
    the summary is collected again.
    Example:
      evolvent-sweep retry torque --failed
      evolvent-sweep retry torque --case 17 --slurm --time 00:30:00
    """  # noqa: D301
    from evolvent.sweep.retry import retry_cases, write_lists

    if not failed and not case:
        raise typer.BadParameter("say what to run again: --failed, or --case NUMBER")
    if not on_slurm and order != Order():
        raise typer.BadParameter("options of Slurm go with --slurm only", param_hint="--slurm")
    if on_slurm and jobs is not None:
        raise typer.BadParameter("has no meaning with --slurm; take --cores", param_hint="--jobs")
    program = find_program()
    if not (directory / folder.COPY).exists():
        what = f"has no {folder.COPY}" if directory.is_dir() else "no such folder"
        raise SweepError(f"{directory}: {what}; nothing was run there")
    design = folder.open_for_run(directory / folder.COPY, directory, program_version(program))
    records = read_records(directory, design, scalars=False)
    wanted = set(np.flatnonzero(records.unfinished).tolist() if failed else []) | set(case or [])
    outside = [number for number in wanted if not 0 <= number < design.n_cases]
    if outside:
        raise typer.BadParameter(
            f"{outside[0]}: the cases are 0 to {design.n_cases - 1}", param_hint="--case"
        )
    if not wanted:
        typer.echo(f"{directory}: no case failed or was refused")
        return
    if on_slurm:
        lists, shards = write_lists(records, directory, sorted(wanted))
        _to_slurm(program, directory, shards, order, lists)
        return
    code = retry_cases(program, directory, records, sorted(wanted), jobs or cores())
    raise typer.Exit(told(directory, code))


def _to_slurm(
    program: Path,
    directory: Path,
    shards: list[folder.Shard],
    order: Order,
    lists: Path | None = None,
) -> None:
    """Write the scripts for these shards, and submit them if asked."""
    arrays = scripts.split_arrays(shards, scripts.tasks_of_an_array())
    kept = directory / folder.COPY  # the copy stays as it is while the jobs wait
    files, collector = scripts.write_scripts(
        program, kept, directory, arrays, order.cpus, order.site, lists
    )
    for file in (*files, collector):
        typer.echo(file)
    if order.submit:
        jobs, last = scripts.submit(files, collector)
        kind = "job" if len(jobs) == 1 else f"{len(jobs)} arrays,"
        number = f"{len(shards)} shard{'s' if len(shards) > 1 else ''}"
        typer.echo(f"submitted: {number} as {kind} {', '.join(jobs)}, the collector as {last}")
