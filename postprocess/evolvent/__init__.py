"""Read, check, draw and compare the histories that evolvent writes."""

from evolvent.errors import HistoryError
from evolvent.history import open_events, open_history, run_warning
from evolvent.physics.compare import compare_histories
from evolvent.physics.invariants import check_history
from evolvent.version import __version__

__all__ = [
    "HistoryError",
    "__version__",
    "check_history",
    "compare_histories",
    "open_events",
    "open_history",
    "run_warning",
]
