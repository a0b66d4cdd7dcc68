"""Read, check, draw and compare the histories that evolvent writes."""

from importlib.metadata import PackageNotFoundError, version

from evolvent.compare import compare_histories
from evolvent.history import HistoryError, open_events, open_history, run_warning
from evolvent.invariants import check_history

try:
    __version__ = version("evolvent")
except PackageNotFoundError:  # used from the source folder
    __version__ = "unknown"

__all__ = [
    "HistoryError",
    "__version__",
    "check_history",
    "compare_histories",
    "open_events",
    "open_history",
    "run_warning",
]
