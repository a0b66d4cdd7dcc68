"""Difference of the transmission errors of a slow run and of the quasi-static analysis."""

from __future__ import annotations

from typing import Any

import numpy as np
import xarray as xr
from scipy.interpolate import CubicSpline

SETTLED = 5  # outputs after which the initial vibration has decayed


def positions_of(curve: xr.Dataset, run: xr.Dataset) -> tuple[Any, int, Any]:
    """Indices of a run's outputs in the positions of a curve, their number, and the run's forces.

    They follow from the position and number of the pair with the largest force.
    """
    pitch, points = float(curve.base_pitch), int(curve.attrs["points"])
    along = pitch if float(curve.torque[0]) > 0 else -pitch
    on_flanks = np.flatnonzero(curve.pair_contact_kind.sel(pair=0).values[0, :points] == 1)
    middle = on_flanks[len(on_flanks) // 2]
    start = float(curve.pair_position.sel(pair=0)[0, middle]) - middle / points * along
    forces = np.nan_to_num(run.pair_normal_force.values.reshape(run.sizes["time"], -1))
    largest = np.arange(len(forces)), forces.argmax(1)
    rho = run.pair_position.values.reshape(forces.shape)[largest]
    number = run.pair_number.values.reshape(forces.shape)[largest]
    return ((rho - start) / along + number) % int(curve.attrs["pitches"]), points, forces


def apart(curve: xr.Dataset, run: xr.Dataset) -> tuple[Any, Any]:
    """Relative difference of the transmission errors, and the difference of the friction forces.

    The curve has one torque, and speeds if there is friction. Outputs at which errors take up the
    backlash are omitted: both flanks carry load, which the curve does not include.
    """
    run = run.isel(time=slice(SETTLED, None))
    at, points, forces = positions_of(curve, run)
    h = curve.transmission_error.values[0]
    of = CubicSpline(np.arange(h.size + 1) / points, np.append(h, h[0]), bc_type="periodic")
    off = np.abs(run.transmission_error.values[:, 0] / of(at) - 1)
    at_rest = curve.pair_friction_force.sum("pair").values[0, (at * points).astype(int) % h.size]
    rubbing = np.nansum(run.pair_friction_force.values.reshape(forces.shape), axis=1)
    on_coast = run.coast_force.values[:, 0]
    on_drive = run.normal_force.values[:, 0] - on_coast
    one = np.minimum(on_drive, on_coast) <= 1e-9 * np.maximum(on_drive, on_coast)
    return off[one], np.abs(rubbing - at_rest)[one]
