"""Format and kinds of the files of all analyses."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

from evolvent.errors import HistoryError

if TYPE_CHECKING:
    import xarray as xr

NEWEST_FORMAT = 1
# values of the attribute `evolvent_kind`
HISTORY, STATIC, RESPONSE, ORBITS = "history", "static", "response", "orbits"
SPECTRUM, ORDER_MAP, CAMPBELL = "spectrum", "order_map", "campbell"
DIMENSIONS = {
    HISTORY: ("time", "wheel", "mesh", "axis"),
    STATIC: ("torque", "position", "pair", "harmonic"),
    RESPONSE: ("direction", "parameter", "jump", "mesh"),
    ORBITS: ("branch", "point", "multiplier", "mesh"),
    SPECTRUM: (),  # frequency or order
    ORDER_MAP: ("time", "order"),
    CAMPBELL: ("speed", "mode", "excitation", "crossing"),
}
WHAT = {
    HISTORY: "a history",
    STATIC: "a static analysis",
    RESPONSE: "a response",
    ORBITS: "branches of orbits",
    SPECTRUM: "a spectrum",
    ORDER_MAP: "an order map",
    CAMPBELL: "a Campbell diagram",
    "stack": "histories of many cases",
}
DRAWN = (
    STATIC,
    RESPONSE,
    ORBITS,
    SPECTRUM,
    ORDER_MAP,
    CAMPBELL,
)  # by evolvent-post plot, besides histories


def result_kind(result: xr.Dataset) -> str:
    """Kind of analysis of a file; files of the first version have no kind and are histories.

    Parameters
    ----------
    result : xarray.Dataset
        As from `open_result`.

    Returns
    -------
    str
        "history", "static", "response", "orbits", "spectrum", "order_map" or "campbell".

    Examples
    --------
    >>> import evolvent
    >>> from evolvent.history import result_kind
    >>> result_kind(evolvent.open_history("paper.h5"))
    'history'
    """
    return kind_of(result.attrs)


def kind_of(attrs: Mapping[Any, Any]) -> str:
    """`result_kind` from the attributes of a file."""
    return str(attrs.get("evolvent_kind", HISTORY))


def check_format(path: Path, attrs: Mapping[Any, Any]) -> None:
    """Reject files of other programs, and formats that this package does not read."""
    import numpy as np

    number = attrs.get("evolvent_format")
    if number is None:
        raise HistoryError(f"{path}: is not an evolvent history (no attribute `evolvent_format`)")
    if not isinstance(number, int | np.integer) or number < 1:
        raise HistoryError(f"{path}: evolvent_format = {number} is not a format number")
    if number > NEWEST_FORMAT:
        raise HistoryError(
            f"{path}: has format {number}, but this evolvent-post reads formats up to "
            f"{NEWEST_FORMAT}; use a newer evolvent"
        )


def check_kind(
    path: Path, attrs: Mapping[Any, Any], sizes: Mapping[Any, int], kinds: tuple[str, ...]
) -> None:
    """Reject files of other kinds, and those without a dimension of their kind."""
    kind = kind_of(attrs)
    if kind not in kinds:
        requested = " or ".join(WHAT[name] for name in kinds)
        hint = "; evolvent-post plot draws it" if kind in DRAWN else ""
        raise HistoryError(
            f"{path}: is {WHAT.get(kind, f'a result {kind!r}')}, not {requested}{hint}"
        )
    missing = [name for name in DIMENSIONS[kind] if name not in sizes]
    if missing:
        what = WHAT[kind].split(" ", 1)[1]
        raise HistoryError(f"{path}: is not a complete {what} (no dimension {', '.join(missing)})")
