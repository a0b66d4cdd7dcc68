"""What the commands do that make jobs of Slurm: write the scripts, submit them."""

from __future__ import annotations

from pathlib import Path

import typer

from evolvent.commands.sweep.slurm_options import Order
from evolvent.sweep import folder
from evolvent.sweep import slurm as scripts


def to_slurm(
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
