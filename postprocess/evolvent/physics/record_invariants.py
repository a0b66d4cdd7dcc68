"""Record invariants: extremes, order of times, finite values."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from evolvent.history.recording import Part, Recording, Values, ever, joined, largest
from evolvent.physics.applicable import NotApplicableError, base_radii, depth_scale, is_tracked
from evolvent.physics.extremes import extreme_names
from evolvent.physics.invariant import Deviation, invariant
from evolvent.physics.metrics import is_number

OF_REAL_GEARS = {  # constants that exist only for gears defined by a basic rack
    *("root_radius", "form_radius", "tooth_angle", "backlash"),
    *("tip_relief_start", "root_relief_start", "active_radius", "base_radius", "tip_radius"),
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
OF_PATH = ("pair_position", "pair_penetration", "pair_sliding_velocity")
FORCES = ("normal_force", "pair_normal_force")
SLIDING = 1e-6  # of the largest speed: with the bound of 1e-9, some digits above rounding
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
def beyond_extremes(run: Recording) -> Deviation:
    """Excess of an output over its extreme over the run, relative to its largest value.

    Dims (extreme, mesh): extremes are located between the outputs, so no output may exceed them.
    The scale is the output's largest value, with these exceptions for values at rounding level:
    penetration: the depth scale, at least the reference penetration; friction force: the normal
    force; normal force under hardly any load, with the digits of positions: at least a thousandth
    of the reference force; transmission error of rigid flanks: at least a thousandth of the depth;
    sliding velocity: at least a millionth of the fastest wheel's speed times the mesh's larger base
    radius, since a wheel's speed is the reference wheel's plus its own deviation.
    """
    recorded = list(extreme_names(run.variables))
    if not recorded:
        raise NotApplicableError("the history contains no extremes between its outputs")
    beyond = []
    for name, output, is_largest in recorded:
        sense = 1.0 if is_largest else -1.0
        reached = _largest_of_meshes(run, output, sense)
        measure = "normal_force" if output == "friction_force" else output
        scale = _largest_of_meshes(run, measure)
        if output == "penetration":
            scale = depth_scale(run)
        elif output == "transmission_error":
            scale = np.maximum(scale, 1e-3 * depth_scale(run))
        elif measure in FORCES:
            scale = np.where(scale > 0.0, np.maximum(scale, 1e-3 * run["reference_force"]), 0.0)
        elif output == "sliding_velocity":
            fastest = largest(run, lambda part: abs(part["angular_velocity"])).max()
            scale = np.maximum(scale, SLIDING * fastest * np.max(np.abs(base_radii(run)), axis=0))
        excess = np.where(scale > 0.0, reached - sense * run[name], 0.0)
        beyond.append(np.clip(excess / np.where(scale > 0.0, scale, 1.0), 0.0, None))
    return Deviation(
        ("extreme", "mesh"), np.stack(beyond), {"extreme": [row[0] for row in recorded]}
    )


def _largest_of_meshes(run: Recording, name: str, sense: float | None = None) -> Values:
    """Largest value of each mesh, or of the negated values, or, without sense, of magnitudes."""
    found = largest(run, lambda part: abs(part[name]) if sense is None else sense * part[name])
    return np.asarray(np.fmax.reduce(found.reshape(found.shape[0], -1), axis=1))


@invariant("order of times", "t_i < t_(i+1)", "1", 0.0)
def order_of_times(run: Recording) -> Deviation:
    """Return 1 if the time is not later than that of the row before, else 0, dim (time)."""

    def late(part: Part) -> Values:
        time = run.read("time", max(part.begin - 1, 0), part.end)
        is_late = np.ones(time.size, dtype=bool)
        is_late[1:] = np.diff(time) > 0.0
        return (~is_late[-part.n :]).astype(float)

    return Deviation(("time",), late)


@invariant("finite values", "every value is finite", "number of values", 0.0)
def finiteness(run: Recording) -> Deviation:
    """Fraction of the values that are not finite, dim (variable).

    Permitted gaps: tracked quantities without tracking; position, penetration and sliding velocity
    of a tooth pair off the path of contact; its pressure on a hollow flank; the efficiency of a
    mesh without power; gap and force of coast flanks of a mesh without coast flanks; quantities of
    gears defined by a basic rack for other gears; the vibration of a mesh with rigid contact,
    without load or with prescribed speeds of both wheels; and metrics over whole periods that do
    not apply, such as the crest factor of an axis at standstill.
    """
    shares: dict[str, float] = {}
    for name, variable in run.variables.items():
        if variable.dtype.kind != "f":
            continue
        size = int(np.prod(variable.shape)) * (run.n if variable.is_over_time else 1)
        if not size:
            shares[name] = 0.0
        elif variable.is_over_time:
            shares[name] = float(_missing_over_time(run, name)) / size
        else:
            has_excuse = name in OF_REAL_GEARS | OF_VIBRATING_MESHES or is_number(name)
            values = run[name]
            shares[name] = float(_missing(values, has_excuse & np.isnan(values))) / size
    return Deviation(("variable",), np.array(list(shares.values())), {"variable": list(shares)})


def _missing_over_time(run: Recording, name: str) -> Values:
    excused = _excuse(run, name)
    return joined(run, lambda part: _missing(part[name], excused(part)), np.add)


def _missing(values: Values, excused: Values) -> Values:
    """Number of non-finite values without an excuse."""
    return np.asarray(np.count_nonzero(~np.isfinite(values) & ~excused))


def _excuse(run: Recording, name: str) -> Callable[[Part], Values]:
    """Return a function that marks the permitted gaps of a variable over time."""

    def pair_pressure(part: Part) -> Values:  # none where a hollow flank is in contact
        return np.asarray(np.isnan(part[name]))

    def efficiency(part: Part) -> Values:
        speed = part["angular_velocity"][:, run["driving_wheel"].astype(int)]
        return np.asarray(part["mesh_torque_driving"] * speed == 0.0)

    if name in TRACKED_ONLY:
        return lambda part: ~is_tracked(part)
    if name in OF_PATH:
        return lambda part: np.asarray(part["pair_on_path"] != 1)
    if name == "efficiency":
        return efficiency
    if name == "pair_contact_pressure":
        return pair_pressure
    if name in {"coast_gap", "coast_force"}:
        has_coast = ever(run, lambda part: ~np.isnan(part["coast_gap"]))
        return lambda part: np.broadcast_to(~has_coast, part[name].shape)
    return lambda _: np.zeros((), dtype=bool)
