"""Run a design with any executor of the type of `concurrent.futures`: threads, MPI, Dask.

The design is split into shards, and a shard is one task, so that a task takes seconds and not the
milliseconds of a case. Workers write into a shared folder. A task whose worker died is submitted
again; recorded cases of its shard are not repeated.
"""

from __future__ import annotations

import math
import time
from collections import Counter
from collections.abc import Callable
from concurrent.futures import FIRST_COMPLETED, BrokenExecutor, Executor, Future, wait
from pathlib import Path

from evolvent.errors import FAILED_CASES, INTERRUPTED, SweepError
from evolvent.sweep.folder import Shard, is_locked
from evolvent.sweep.program import call, last_message
from evolvent.sweep.run import Work

SHORTEST = 1.0  # duration of a task [s]
A_WORKER = 16  # tasks: few for one folder, but enough that no worker waits long for the last
MOST = 1000  # tasks
ATTEMPTS = 4
ASKED = 0.5  # polling interval of a lock [s]


def task_count(n_cases: int, seconds_a_case: float, workers: int) -> int:
    """Number of tasks: each of at least a second, about 16 per worker."""
    of_a_second = math.floor(n_cases * seconds_a_case / SHORTEST)
    return max(1, min(n_cases, of_a_second, A_WORKER * max(workers, 1), MOST))


def run_with_executor(
    program: Path,
    design: Path,
    folder: Path,
    shards: list[Shard],
    executor: Executor,
    *,
    show: Callable[[], None] | None = None,
) -> int:
    """Run shards as tasks of an executor.

    Parameters
    ----------
    program, design, folder : Path
        Paths that are valid for the workers as well.
    shards : list of Shard
        Shards to run, as from `remaining_shards`.
    executor : concurrent.futures.Executor
        Executor of the tasks: threads, MPI, Dask.
    show : callable, optional
        Called several times a second.

    Returns
    -------
    int
        Exit code: 0, or 1 if cases failed.

    Raises
    ------
    SweepError
        Another run is working in the folder, the executor broke, or a task failed in all attempts,
        with the reason of the last one.

    Examples
    --------
    >>> from concurrent.futures import ThreadPoolExecutor
    >>> from pathlib import Path
    >>> from evolvent.sweep.folder import Shard
    >>> from evolvent.sweep.pool import run_with_executor
    >>> from evolvent.sweep.program import find_program
    >>> with ThreadPoolExecutor(1) as executor:
    ...     run_with_executor(
    ...         find_program(), Path("torque.h5"), Path("torque"), [Shard(1, 1)], executor
    ...     )
    0
    """
    for shard in shards:
        if is_locked(folder, shard):
            raise SweepError(
                f"{folder}: another run is processing shard {shard.index}/{shard.of}; wait until "
                "it ends, or stop it first"
            )
    try:
        return _run(Work(program, design.absolute(), folder.absolute()), shards, executor, show)
    except BrokenExecutor as error:
        raise SweepError(
            "the executor failed because a worker died; repeat the command to continue", INTERRUPTED
        ) from error


def _run(
    work: Work, shards: list[Shard], executor: Executor, show: Callable[[], None] | None
) -> int:
    attempts: Counter[Shard] = Counter()
    running: dict[Future[tuple[int, str]], Shard] = {}
    result = 0

    def submit(shard: Shard) -> None:
        attempts[shard] += 1
        running[executor.submit(run_task, work, shard)] = shard

    for shard in shards:
        submit(shard)
    while running:
        done, _ = wait(running, timeout=ASKED, return_when=FIRST_COMPLETED)
        for future in done:
            shard = running.pop(future)
            code, message = _outcome(future)
            if code in (0, FAILED_CASES):
                result = max(result, code)
            elif code >= 0 and code != INTERRUPTED:
                raise SweepError(message, code)
            elif attempts[shard] < ATTEMPTS:
                submit(shard)
            else:
                raise SweepError(
                    f"shard {shard.index}/{shard.of} was tried {ATTEMPTS} times: {message}",
                    INTERRUPTED,
                )
        if show is not None:
            show()
    return result


def run_task(work: Work, shard: Shard) -> tuple[int, str]:
    """Run one shard on a worker; return its exit code and last message.

    The program of a dead worker may still be working on the shard. Its end is awaited: its
    records need not be computed again.
    """
    while is_locked(work.folder, shard):
        time.sleep(ASKED)
    done = call(*work.command(shard, jobs=1))
    return done.returncode, last_message(done.stderr)


def _outcome(future: Future[tuple[int, str]]) -> tuple[int, str]:
    """Exit code and message of a task; -1 if its worker died."""
    try:
        return future.result()
    except BrokenExecutor:
        raise
    except Exception as error:  # Dask's KilledWorker and other failures of workers
        return -1, f"{type(error).__name__}: {' '.join(str(error).split())[:200]}"
