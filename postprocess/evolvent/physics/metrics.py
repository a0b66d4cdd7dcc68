"""Metrics over whole periods in a history, as text."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from evolvent.units import quantity

if TYPE_CHECKING:
    import xarray as xr

    from evolvent.history.recording import Recording

PREFIX = "window_"
SETTLED = "window_settled"
MOST_HARMONICS = 5  # shown in tables


def is_number(name: str) -> bool:
    """Whether a static variable is a metric over whole periods, by its name."""
    return name.startswith(PREFIX)


def window_text(history: xr.Dataset | Recording) -> str:
    """Describe the window of the metrics; "" if the history has none."""
    if f"{PREFIX}periods" not in history:
        return ""
    begin, end, periods = (
        float(history[f"{PREFIX}{which}"]) for which in ("begin", "end", "periods")
    )
    if periods == 0:
        return "The window held no whole period."
    text = f"{periods:.0f} whole periods, from {begin:.6g} to {end:.6g} s."
    reason = str(history.attrs.get(f"{SETTLED}_reason", ""))  # not in older histories
    if not reason:
        return text
    is_known = float(history[SETTLED]) == 0
    return f"{text} The window {'is not' if is_known else 'may not be'} settled: {reason}."


def steady_window(history: xr.Dataset | Recording) -> tuple[float, float] | None:
    """Times of the window of a run's metrics [s]; None without, or without two outputs in it."""
    if f"{PREFIX}begin" not in history or f"{PREFIX}end" not in history:
        return None
    begin, end = float(history[f"{PREFIX}begin"]), float(history[f"{PREFIX}end"])
    time = np.asarray(history["time"])
    return (begin, end) if np.count_nonzero((time >= begin) & (time <= end)) > 1 else None


def metrics_tables(history: xr.Dataset) -> list[tuple[list[str], list[tuple[str, list[str]]]]]:
    """Tables of the metrics of meshes, wheels and accelerometers: their names, and one row each."""
    dims = [dim for dim in ("mesh", "wheel", "accelerometer") if dim in history.dims]
    return [([str(v) for v in history[dim].values], _rows(history, dim)) for dim in dims]


def _rows(history: xr.Dataset, dim: str) -> list[tuple[str, list[str]]]:
    """Rows of names and values; without phases, rows without values, and wheels at standstill."""
    rows = []
    for name, variable in history.data_vars.items():
        if not is_number(str(name)) or variable.dims[:1] != (dim,):
            continue
        values = variable.values.reshape(variable.shape[0], -1)
        if str(name).endswith("phase") or np.isnan(values).all():
            continue
        if dim != "mesh" and not np.nan_to_num(values).any():
            continue
        units = str(variable.attrs.get("units", "1"))
        label = str(variable.attrs.get("long_name", name))
        if "harmonic" in variable.dims:
            values = values[:, :MOST_HARMONICS]
            label += f", 1 to {values.shape[1]}"
        rows.append((label, [_texts(row, units) for row in values]))
    return rows


def _texts(values: np.ndarray, units: str) -> str:
    return ", ".join("-" if np.isnan(v) else quantity(float(v), units, 4) for v in values)
