"""The command evolvent-sweep slurm."""

from __future__ import annotations

from typing import Annotated

from evolvent.commands.command_line import option
from evolvent.commands.program import say
from evolvent.commands.sweep.common import DesignFile, Into
from evolvent.commands.sweep.slurm_jobs import to_slurm
from evolvent.commands.sweep.slurm_options import Order, with_options_of_slurm
from evolvent.errors import USAGE, SweepError


@with_options_of_slurm
def slurm(
    design_file: DesignFile,
    output: Into,
    shards: Annotated[
        int | None,
        option(
            "--shards N",
            "Split the cases into N shards; if not given, into shards of ten minutes each.",
            min=1,
        ),
    ] = None,
    *,
    order: Order,
) -> None:
    """Write and submit Slurm job arrays for the shards, and a job that collects the results.

    \b
    The arrays contain the shards with missing cases. Repeat the command to continue. More shards
    than Slurm accepts in an array (MaxArraySize) are split into several arrays. The last job
    writes DIR/summary.h5 when all shards have ended, also after failures.
    Example:
      evolvent-sweep slurm torque.h5 -o torque --shards 4 --time 00:30:00 --account gears
    """  # noqa: D301
    from evolvent.sweep import folder
    from evolvent.sweep import slurm as scripts
    from evolvent.sweep.estimate import seconds_per_case
    from evolvent.sweep.journal import read_records
    from evolvent.sweep.program import find_program, program_version

    program = find_program()
    design = folder.open_for_run(design_file, output, program_version(program))
    records = read_records(output, design, scalars=False)
    split = shards or folder.common_split(output, records.shards)
    if split is None:
        seconds, _ = seconds_per_case(design, program)
        split = scripts.shard_count(design.n_cases, seconds, order.cpus)
    if split > design.n_cases:
        raise SweepError(f"--shards {split}: the design has only {design.n_cases} cases", USAGE)
    todo = folder.remaining_shards(records.recorded, split)
    if not todo:
        say(f"{output}: all {design.n_cases} cases are recorded; no case is left to run")
        return
    to_slurm(program, output, todo, order)
