"""Run cases in this process; read, check, draw and compare the histories that evolvent writes."""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from evolvent.errors import AnalysisError, CaseWarning, HistoryError
    from evolvent.history import open_events, open_history, run_warning
    from evolvent.library.calls import datasheet, modes, parameters, respond, run, show, static
    from evolvent.physics.compare import compare_histories
    from evolvent.physics.invariants import check_history
    from evolvent.physics.load_spectrum import load_spectra
    from evolvent.version import __version__

__all__ = [
    "AnalysisError",
    "CaseWarning",
    "HistoryError",
    "__version__",
    "check_history",
    "compare_histories",
    "datasheet",
    "load_spectra",
    "modes",
    "open_events",
    "open_history",
    "parameters",
    "respond",
    "run",
    "run_warning",
    "show",
    "static",
]
# Module of each name. Modules are imported on first use: a command needs only a few of them.
_HOMES = {
    "AnalysisError": "errors",
    "CaseWarning": "errors",
    "HistoryError": "errors",
    "__version__": "version",
    "check_history": "physics.invariants",
    "compare_histories": "physics.compare",
    "datasheet": "library.calls",
    "load_spectra": "physics.load_spectrum",
    "modes": "library.calls",
    "open_events": "history",
    "open_history": "history",
    "parameters": "library.calls",
    "respond": "library.calls",
    "run": "library.calls",
    "run_warning": "history",
    "show": "library.calls",
    "static": "library.calls",
}


def __getattr__(name: str) -> Any:
    if name not in _HOMES:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    return getattr(import_module(f"{__name__}.{_HOMES[name]}"), name)
