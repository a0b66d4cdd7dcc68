"""Calls that may take long, and end when this process is interrupted."""

from __future__ import annotations

import _thread
import threading
from collections.abc import Callable
from ctypes import c_int
from typing import Any

PATIENCE = 1.0  # s: in which a thread that was started begins


def call(work: Callable[[c_int], Any]) -> Any:
    """Call the library, with the word that stops it.

    Python hears of signals in its main thread, between two of its own steps. So that thread waits
    for another one that works, and stops it if an exception ends the waiting, such as
    KeyboardInterrupt; other threads work themselves.
    """
    stop = c_int(0)
    if threading.current_thread() is not threading.main_thread():
        return work(stop)
    answers: list[Any] = []
    begun, ended = threading.Lock(), threading.Lock()
    begun.acquire()
    ended.acquire()

    def work_beside() -> None:
        begun.release()
        try:
            if stop.value == 0:  # else nobody waits any more
                answers.append(work(stop))
        except BaseException as error:
            answers.append(error)
        finally:
            ended.release()

    try:
        _thread.start_new_thread(work_beside, ())
        ended.acquire()
    except BaseException:
        stop.value = 1
        _wait(begun, ended)
        raise
    if isinstance(answers[0], BaseException):
        raise answers[0]
    return answers[0]


def _wait(begun: Any, ended: Any) -> None:
    """Wait for the end of a thread that was told to stop, if it has begun; nothing ends that."""
    while True:
        try:
            if begun.acquire(timeout=PATIENCE):
                begun.release()
                ended.acquire()
            return
        except BaseException:
            continue
