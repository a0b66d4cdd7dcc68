"""Long calls of the library that can be interrupted."""

from __future__ import annotations

import _thread
import threading
from collections.abc import Callable
from ctypes import c_int
from typing import Any

PATIENCE = 1.0  # s: within which a new thread starts


def call(work: Callable[[c_int], Any]) -> Any:
    """Call the library with the flag that stops it.

    Python handles signals in its main thread, between two of its own steps. The main thread
    therefore waits for a worker thread, and stops it if an exception such as KeyboardInterrupt
    ends the waiting. Calls from other threads run directly.
    """
    stop = c_int(0)
    if threading.current_thread() is not threading.main_thread():
        return work(stop)
    outcomes: list[Any] = []
    begun, ended = threading.Lock(), threading.Lock()
    begun.acquire()
    ended.acquire()

    def work_beside() -> None:
        begun.release()
        try:
            if stop.value == 0:  # else the caller no longer waits
                outcomes.append(work(stop))
        except BaseException as error:
            outcomes.append(error)
        finally:
            ended.release()

    try:
        _thread.start_new_thread(work_beside, ())
        ended.acquire()
    except BaseException:
        stop.value = 1
        _wait(begun, ended)
        raise
    if isinstance(outcomes[0], BaseException):
        raise outcomes[0]
    return outcomes[0]


def _wait(begun: Any, ended: Any) -> None:
    """Wait for the end of a thread after a stop request, if it has started; not interruptible."""
    while True:
        try:
            if begun.acquire(timeout=PATIENCE):
                begun.release()
                ended.acquire()
            return
        except BaseException:
            continue
