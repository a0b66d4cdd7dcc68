"""Create Slurm jobs: write the scripts, submit them."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from evolvent.commands.program import say
from evolvent.commands.sweep.slurm_options import Order

if TYPE_CHECKING:
    from evolvent.sweep import folder


def to_slurm(
    program: Path,
    directory: Path,
    shards: list[folder.Shard],
    order: Order,
    lists: Path | None = None,
) -> None:
    """Write the scripts for these shards, and submit them if requested."""
    from evolvent.sweep import folder
    from evolvent.sweep import slurm as scripts

    arrays = scripts.split_arrays(shards, scripts.tasks_of_an_array())
    copy = directory / folder.COPY  # the copy does not change while the jobs wait
    files, collector = scripts.write_scripts(
        program, copy, directory, arrays, order.cpus, order.site, lists
    )
    for file in (*files, collector):
        say(file)
    if order.submit:
        jobs, last = scripts.submit(files, collector)
        kind = "job" if len(jobs) == 1 else f"{len(jobs)} arrays,"
        number = f"{len(shards)} shard{'s' if len(shards) > 1 else ''}"
        say(f"submitted: {number} as {kind} {', '.join(jobs)}, the collector as {last}")
