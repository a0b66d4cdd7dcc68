"""How far two histories of one case are apart."""

from __future__ import annotations

import numpy as np
import xarray as xr
from numpy.typing import NDArray


def penetrations(history: xr.Dataset) -> NDArray[np.float64]:
    """Penetrations of all flanks in mesh [m], (time, flank of a mesh); 0 where there is a gap."""
    names = [name for name in ("gap", "coast_gap") if name in history]
    gaps = [np.nan_to_num(history[name].values) for name in names]  # some meshes have no backlash
    return np.maximum(-np.concatenate(gaps, axis=1), 0.0)


def penetration_error(history: xr.Dataset, reference: xr.Dataset) -> float:
    """Largest difference of a penetration, over the largest penetration of all meshes."""
    return _relative(penetrations(history), penetrations(reference))


def force_error(history: xr.Dataset, reference: xr.Dataset) -> float:
    """Largest difference of a normal force, over the largest normal force of all meshes."""
    return _relative(history["normal_force"].values, reference["normal_force"].values)


def _relative(values: NDArray[np.float64], expected: NDArray[np.float64]) -> float:
    scale = np.abs(expected).max()
    return float(np.abs(values - expected).max() / scale) if scale > 0.0 else 0.0
