"""Histories and files of other analyses: open, check the format, read in pieces."""

from evolvent.history.files import (
    DONE,
    RUNNING,
    open_events,
    open_history,
    open_recording,
    open_result,
    rows_between,
    run_warning,
)
from evolvent.history.kinds import (
    CAMPBELL,
    DRAWN,
    HISTORY,
    NEWEST_FORMAT,
    ORBITS,
    ORDER_MAP,
    RESPONSE,
    SPECTRUM,
    STATIC,
    WHAT,
    result_kind,
)
from evolvent.history.names import file_label, require, source_name

__all__ = [
    "CAMPBELL",
    "DONE",
    "DRAWN",
    "HISTORY",
    "NEWEST_FORMAT",
    "ORBITS",
    "ORDER_MAP",
    "RESPONSE",
    "RUNNING",
    "SPECTRUM",
    "STATIC",
    "WHAT",
    "file_label",
    "open_events",
    "open_history",
    "open_recording",
    "open_result",
    "require",
    "result_kind",
    "rows_between",
    "run_warning",
    "source_name",
]
