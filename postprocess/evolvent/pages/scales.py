"""Scales of the arrows of an animation."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import xarray as xr

from evolvent.history import require


@dataclass(frozen=True)
class Largest:
    """Values of the longest arrows; 0: there are none."""

    force: float = 0.0  # of a tooth pair [N]
    torque: float = 0.0  # of the loads of a wheel [N m]
    sliding: float = 0.0  # of a loaded tooth pair [m/s]


def largest_of(history: xr.Dataset, rows: list[int], mesh: int | None = None) -> Largest:
    """Find the largest values over some outputs, in one mesh or in all."""
    chosen = slice(None) if mesh is None else [mesh]
    force = require(history, "pair_normal_force").values[rows][:, chosen]
    torque = sliding = 0.0
    if "load_torque" in history:
        wheels = list(range(history.sizes["wheel"]))
        if mesh is not None:
            sides = ("driving_wheel", "driven_wheel")
            wheels = [int(require(history, side)[mesh]) for side in sides]
        torque = _size(history["load_torque"].values[rows][:, wheels])
    if "pair_sliding_velocity" in history:
        speed = history["pair_sliding_velocity"].values[rows][:, chosen]
        sliding = _size(np.where(force > 0, speed, 0.0))
    return Largest(_size(np.clip(force, 0.0, None)), torque, sliding)


def _size(values: np.ndarray) -> float:
    return float(np.nanmax(np.abs(values), initial=0.0))
