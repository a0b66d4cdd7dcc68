"""Differences between two histories of one case."""

from __future__ import annotations

import numpy as np
import xarray as xr
from numpy.typing import NDArray


def penetrations(history: xr.Dataset) -> NDArray[np.float64]:
    """Return penetrations of all flanks in mesh [m], (time, flank of a mesh); 0 for a gap."""
    names = [name for name in ("gap", "coast_gap") if name in history]
    gaps = [np.nan_to_num(history[name].values) for name in names]  # some meshes have no backlash
    return np.maximum(-np.concatenate(gaps, axis=1), 0.0)


def penetration_error(history: xr.Dataset, reference: xr.Dataset) -> float:
    """Return the largest difference of penetrations, over the largest penetration of all meshes."""
    return _relative(penetrations(history), penetrations(reference))


def force_error(history: xr.Dataset, reference: xr.Dataset) -> float:
    """Return the largest difference of normal forces, over the largest force of all meshes."""
    return _relative(history["normal_force"].values, reference["normal_force"].values)


def _relative(values: NDArray[np.float64], expected: NDArray[np.float64]) -> float:
    scale = np.abs(expected).max()
    return float(np.abs(values - expected).max() / scale) if scale > 0.0 else 0.0
