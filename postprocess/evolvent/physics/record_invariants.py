"""What must hold of what was written: extremes, order of times, numbers that are numbers."""

from __future__ import annotations

import numpy as np
import xarray as xr

from evolvent.history import require
from evolvent.physics.applicable import NotApplicableError, depth_scale, is_tracked
from evolvent.physics.extremes import told_extremes
from evolvent.physics.invariant import invariant
from evolvent.physics.numbers import is_number

OF_REAL_GEARS = {  # constants of wheels and meshes that other pairs do not have
    *("root_radius", "form_radius", "tooth_angle", "backlash"),
    *("tip_relief_start", "root_relief_start"),
}
OF_VIBRATING_MESHES = frozenset(
    {
        "reference_stiffness",
        "reference_mass",
        "natural_frequency",
        "damping_coefficient",
        "damping_ratio",
    }
)
TRACKED_ONLY = frozenset(
    {
        "gradient_ratio",
        "tracking_residual_driving",
        "tracking_residual_driven",
        "line_distance_driving",
        "line_distance_driven",
    }
)


@invariant("extremes", "no output beyond its extreme over the run", "largest value", 1e-9)
def beyond_extremes(history: xr.Dataset) -> xr.DataArray:
    """How far an output lies beyond its extreme over the run, over its largest value.

    Dims (extreme, mesh): found between the outputs, an extreme is none if an output exceeds it. The
    penetration of rigid contacts is rounding: it is measured by the reference penetration; and a
    friction force that is rounding, by the normal force.
    """
    told = told_extremes(history)
    if not told:
        raise NotApplicableError("the history tells no extremes between its outputs")
    beyond = []
    for extreme in told:
        sense = 1.0 if extreme.is_largest else -1.0
        values = history[extreme.output]
        reached = (sense * values).max([dim for dim in values.dims if dim != "mesh"])
        measure = history["normal_force"] if extreme.output == "friction_force" else values
        scale = abs(measure).max([dim for dim in values.dims if dim != "mesh"])
        if extreme.output == "penetration":
            scale = depth_scale(history)
        excess = (reached - sense * extreme.value).where(scale > 0.0, 0.0)
        beyond.append((excess / scale.where(scale > 0.0, 1.0)).clip(min=0.0))
    names = [str(extreme.value.name) for extreme in told]
    return xr.concat(beyond, dim=xr.DataArray(names, dims="extreme", name="extreme"))


@invariant("order of times", "t_i < t_(i+1)", "1", 0.0)
def order_of_times(history: xr.Dataset) -> xr.DataArray:
    """1 where the time is not later than that of the row before, else 0, dim (time)."""
    time = require(history, "time")
    late = np.ones(time.size, dtype=bool)
    late[1:] = np.diff(time.values) > 0.0
    return xr.DataArray((~late).astype(float), dims="time", coords={"time": time})


@invariant("finite values", "every value is a number", "number of values", 0.0)
def finiteness(history: xr.Dataset) -> xr.DataArray:
    """Share of the values that are no finite numbers, dim (variable).

    What only tracked points have is missing on purpose where none are tracked, position,
    penetration and sliding velocity of a tooth pair off the path of contact, its pressure on a
    hollow flank, the efficiency of a mesh without power, the gap of coast flanks of a mesh that has
    none, what only real gears have, the vibration of a mesh whose contact is rigid, that has no
    load or whose wheels both have prescribed speeds, and numbers over whole periods that do not
    apply, as the crest factor of an axle that rests.
    """
    shares: dict[str, float] = {}
    for name, variable in history.variables.items():
        if variable.dtype.kind != "f":
            continue
        values = history[name]
        if name in TRACKED_ONLY:
            values = values.where(is_tracked(history), 0.0)
        if name in ("pair_position", "pair_penetration", "pair_sliding_velocity"):
            values = values.where(require(history, "pair_on_path") == 1, 0.0)
        if name == "efficiency":
            driving = require(history, "driving_wheel").values.astype(int)
            speed = require(history, "angular_velocity").values[:, driving]
            values = values.where(require(history, "mesh_torque_driving") * speed != 0.0, 0.0)
        if name == "pair_contact_pressure":  # none where a hollow flank touches
            values = values.fillna(0.0)
        if name == "coast_gap":
            values = values.where(values.notnull().any("time"), 0.0)
        if name in OF_REAL_GEARS | OF_VIBRATING_MESHES or is_number(str(name)):
            values = values.fillna(0.0)
        shares[str(name)] = float(np.mean(~np.isfinite(values.values))) if values.size else 0.0
    return xr.DataArray(list(shares.values()), dims="variable", coords={"variable": list(shares)})
