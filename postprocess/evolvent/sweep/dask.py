"""Run a design on a Dask cluster, an optional extra. The only file that uses Dask."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from evolvent.errors import USAGE, SweepError, needing, reason_of
from evolvent.sweep.design import Design
from evolvent.sweep.estimate import seconds_per_case
from evolvent.sweep.folder import Shard
from evolvent.sweep.pool import run_with_executor, task_count
from evolvent.sweep.run import Tally, Work, display


def split(design: Design, program: Path, workers: int) -> int:
    """Number of shards of a new folder: tasks of at least a second."""
    seconds, _ = seconds_per_case(design, program)
    return task_count(design.n_cases, seconds, workers)


def run(work: Work, shards: list[Shard], workers: int, scheduler: str | None, tally: Tally) -> int:
    """Run shards as tasks of a Dask cluster, or of workers on this machine.

    Parameters
    ----------
    workers : number of workers to start on this machine if no scheduler is given.
    scheduler : address of a scheduler whose workers can access all paths of `work`.

    Raises
    ------
    SweepError
        Dask is not installed, the scheduler does not answer, or as `run_with_executor`.
    """
    with needing("dask", "--executor dask needs Dask", USAGE):
        import distributed
    make_client: Any = distributed.Client
    try:
        if scheduler is not None:
            client = make_client(scheduler, timeout="20s")
        else:
            client = make_client(n_workers=workers, threads_per_worker=1, dashboard_address=None)
    except (OSError, ValueError) as error:
        raise SweepError(f"no Dask scheduler at {scheduler}: {reason_of(error)}") from error
    with client, display(tally) as show:
        # A task is the same command on any worker, but Dask must not reuse a cached result.
        executor = client.get_executor(pure=False)
        return run_with_executor(
            work.program, work.design, work.folder, shards, executor, show=show
        )
