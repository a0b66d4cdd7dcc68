"""What must hold in every run, whatever the case: the invariants as a table, and their verdicts.

Each invariant is a function of the history that gives the deviation from what should be, divided
by its natural scale, so that one number bounds it: a fixed one, or a multiple of the tolerance of
the case where that is larger. docs/theory.md explains them. `evolvent run` holds its own run to
some of them, with the same bounds, and writes the outcome down (`invariants`).
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import xarray as xr
import yaml

from evolvent.history import require
from evolvent.physics.contact_invariants import contradiction, has_modes, pull
from evolvent.physics.wheel_torques import (
    contact_torque,
    largest_shaft_torque,
    rotor_inertia,
    shaft_torque,
)
from evolvent.told_extremes import told_extremes

CLOSED_FORM = 0  # value of `tracking`
LOADED = 1  # value of `contact_mode`: the flanks press on each other
OF_REAL_GEARS = {  # constants of wheels and meshes that other pairs do not have
    *("root_radius", "form_radius", "tooth_angle", "backlash"),
    *("tip_relief_start", "root_relief_start"),
}
APART = 3  # value of `contact_mode`: the flanks are too far apart to track points on them


class NotApplicableError(Exception):
    """An invariant says nothing about this history; the message is the reason."""


@dataclass(frozen=True)
class Invariant:
    """One line of the table."""

    name: str
    formula: str  # text, as in docs/theory.md
    relative_to: str
    least_bound: float
    deviation: Callable[[xr.Dataset], xr.DataArray]
    tolerances: float = 0.0  # the bound is at least so many times the tolerance of the case

    def bound(self, tolerance: float) -> float:
        """Largest deviation of a right run with that tolerance."""
        return max(self.least_bound, self.tolerances * tolerance)


@dataclass(frozen=True)
class Verdict:
    """What became of an invariant in one history."""

    invariant: Invariant
    bound: float  # for the tolerance of the case
    verdict: str  # "pass", "fail" or "not applicable"
    worst: float | None  # largest deviation; None if not applicable
    where: dict[str, str]  # coordinates of the worst value, such as {"time": "1.25 s"}
    reason: str  # why it is not applicable

    @property
    def failed(self) -> bool:
        """Whether the invariant is broken."""
        return self.verdict == "fail"


def check_history(history: xr.Dataset) -> list[Verdict]:
    """Check every invariant.

    Parameters
    ----------
    history : as from `open_history`.

    Returns
    -------
    One verdict for each line of `INVARIANTS`, in its order.

    Raises
    ------
    HistoryError
        A variable that an invariant needs is not in the file.
    """
    return [check_invariant(history, invariant) for invariant in INVARIANTS]


def check_invariant(history: xr.Dataset, invariant: Invariant) -> Verdict:
    """Check one invariant; a value that is no number breaks it."""
    bound = invariant.bound(tolerance_of(history))
    try:
        if history.sizes["time"] == 0:
            raise NotApplicableError("the history has no output")
        deviation = abs(invariant.deviation(history))
    except NotApplicableError as error:
        return Verdict(invariant, bound, "not applicable", None, {}, str(error))
    values = deviation.values
    broken = ~np.isfinite(values)
    position = np.unravel_index(
        int(np.argmax(broken)) if broken.any() else int(np.argmax(values)), values.shape
    )
    worst = float(values[position])
    where = {
        str(dim): _place(deviation, str(dim), int(index))
        for dim, index in zip(deviation.dims, position, strict=True)
    }
    passed = not broken.any() and worst <= bound
    return Verdict(invariant, bound, "pass" if passed else "fail", worst, where, "")


def tolerance_of(history: xr.Dataset) -> float:
    """Tolerance of the case, from the resolved case in the history."""
    case = yaml.safe_load(history.attrs.get("case", ""))
    simulation = case.get("simulation") if isinstance(case, dict) else None
    return float(simulation["tolerance"]) if simulation else DEFAULT_TOLERANCE


def gradient_ratio(history: xr.Dataset) -> xr.DataArray:
    """lambda over its constant value -r_bB/r_bA, minus 1, dims (time, mesh).

    Source: Kosenko & Gusev 2011, Assertion 2.
    """
    tracked, when = _tracked(history)
    driving, driven = _base_radii(tracked)
    return (require(tracked, "gradient_ratio") * driving / driven + 1.0).where(when, 0.0)


def transmission_error_identity(history: xr.Dataset) -> xr.DataArray:
    """Delta - h - e - R (inv alpha - inv alpha_0) over the depth, dims (time, mesh).

    Source: Kosenko & Gusev 2011, (19), generalised to axles that move.
    """
    pressed, depth = _pressed(history)
    lag = require(pressed, "transmission_error") + require(pressed, "gap")
    lag = lag - require(pressed, "flank_deviation")
    return (lag - require(pressed, "separation_curvature")) / depth


def distance_from_flanks(history: xr.Dataset) -> xr.DataArray:
    """Distance of the tracked points from their flanks, r_b g, over the depth.

    Dims (wheel_of_mesh, time, mesh).   Source: Kosenko & Gusev 2011, (1).
    """
    return _of_both_wheels(history, "tracking_residual")


def distance_from_line_of_action(history: xr.Dataset) -> xr.DataArray:
    """Distance of the tracked points from the line of action, (r_P - K_A).t, over the depth.

    Dims (wheel_of_mesh, time, mesh).   Source: Kosenko & Gusev 2011, Assertion 1.
    """
    return _of_both_wheels(history, "line_distance")


def rigid_gap(history: xr.Dataset) -> xr.DataArray:
    """Gap of closed rigid contacts over the depth, dims (time, mesh).

    Source: Kosenko & Gusev 2011, section 7.3.
    """
    rigid, closed = _rigid(history)
    gap = require(rigid, "gap") / depth_scale(rigid)
    return gap.where(closed, 0.0).transpose("time", "mesh")


def rigid_gap_rate(history: xr.Dataset) -> xr.DataArray:
    """Rate of the gap of closed rigid contacts over that of a vibration, dims (time, mesh).

    The scale is the depth times the natural frequency of a contact of stiffness F_0/h_0 between the
    two wheels.
    """
    rigid, closed = _rigid(history)
    radii = _base_radii(rigid)
    inertias = _of_meshes(rigid, rotor_inertia(rigid))
    mobility = sum(r**2 / inertia for r, inertia in zip(radii, inertias, strict=True))
    force, depth = require(rigid, "reference_force"), require(rigid, "reference_penetration")
    frequency = np.sqrt(force / depth * mobility)
    rate = require(rigid, "gap_rate") / (depth_scale(rigid) * frequency)
    return rate.where(closed, 0.0).transpose("time", "mesh")


def energy_balance(history: xr.Dataset) -> xr.DataArray:
    """Energy that appeared or got lost since the start over the energy put in, dim (time).

    T + V + dissipated - work of the loads is constant. What was put in is the gross work of the
    loads (the positive power on each wheel, integrated over the outputs) and the energy at the
    start; or, where outputs are few or gravity or a moving housing puts in more, the largest of
    these energies; and at least F_0 h_0, the work of the reference forces.
    """
    stored = require(history, "kinetic_energy") + require(history, "potential_energy")
    balance = stored + require(history, "dissipated_energy") - require(history, "load_work")
    power = require(history, "load_torque") * require(history, "angular_velocity")
    gross = float(power.clip(min=0.0).sum("wheel").integrate("time"))
    largest = [float(abs(history[name]).max()) for name in ENERGIES]
    least = float((require(history, "reference_force") * history["reference_penetration"]).sum())
    scale = max(gross + abs(float(stored[0])), *largest, least)
    return (balance - balance[0]) / scale


def torque_balance(history: xr.Dataset) -> xr.DataArray:
    """J omega' - load - contact - shaft torques over the wheel's largest contact or shaft torque.

    Dims (time, wheel). With friction, on approach and recess alike; a wheel that nothing turns but
    its loads is left out. A housing that turns adds its acceleration about the axles.
    """
    contact, shaft = contact_torque(history), shaft_torque(history)
    acceleration = require(history, "angular_acceleration")
    if "housing_angular_acceleration" in history:
        of_housing = history["housing_angular_acceleration"].sel(space="z", drop=True)
        acceleration = acceleration + of_housing
    inertia_torque = require(history, "inertia") * acceleration
    of_contacts = abs(contact).max("time")
    of_shafts = largest_shaft_torque(history)
    largest = of_contacts.where(of_contacts > of_shafts, of_shafts)
    touched = largest.values > 0.0
    if not touched.any():
        raise NotApplicableError("the teeth never touch")
    deviation = inertia_torque - require(history, "load_torque") - contact - shaft
    return (deviation / largest).isel(wheel=touched).transpose("time", "wheel")


def agreement_of_modes(history: xr.Dataset) -> xr.DataArray:
    """How far gaps and forces of tooth pairs contradict their modes, dims (time, mesh, pair)."""
    if not has_modes(history):
        raise NotApplicableError("the history does not tell the modes of its tooth pairs")
    return contradiction(history)


def beyond_extremes(history: xr.Dataset) -> xr.DataArray:
    """How far an output lies beyond its extreme over the run, over its largest value.

    Dims (extreme, mesh): found between the outputs, an extreme is none if an output exceeds it. The
    penetration of rigid contacts is rounding: it is measured by the reference penetration.
    """
    told = told_extremes(history)
    if not told:
        raise NotApplicableError("the history tells no extremes between its outputs")
    beyond = []
    for extreme in told:
        sense = 1.0 if extreme.is_largest else -1.0
        values = history[extreme.output]
        reached = (sense * values).max([dim for dim in values.dims if dim != "mesh"])
        scale = abs(values).max([dim for dim in values.dims if dim != "mesh"])
        if extreme.output == "penetration":
            scale = depth_scale(history)
        excess = (reached - sense * extreme.value).where(scale > 0.0, 0.0)
        beyond.append((excess / scale.where(scale > 0.0, 1.0)).clip(min=0.0))
    names = [str(extreme.value.name) for extreme in told]
    return xr.concat(beyond, dim=xr.DataArray(names, dims="extreme", name="extreme"))


def order_of_times(history: xr.Dataset) -> xr.DataArray:
    """1 where the time is not later than that of the row before, else 0, dim (time)."""
    time = require(history, "time")
    late = np.ones(time.size, dtype=bool)
    late[1:] = np.diff(time.values) > 0.0
    return xr.DataArray((~late).astype(float), dims="time", coords={"time": time})


def finiteness(history: xr.Dataset) -> xr.DataArray:
    """Share of the values that are no finite numbers, dim (variable).

    What only tracked points have is missing on purpose where none are tracked, position and
    penetration of a tooth pair off the path of contact, its pressure on a hollow flank, the
    efficiency of a mesh without power, the gap of coast flanks of a mesh that has none, what only
    real gears have, and the vibration of a mesh whose contact is rigid, that has no load or whose
    wheels both have prescribed speeds.
    """
    shares: dict[str, float] = {}
    for name, variable in history.variables.items():
        if variable.dtype.kind != "f":
            continue
        values = history[name]
        if name in TRACKED_ONLY:
            values = values.where(_is_tracked(history), 0.0)
        if name in ("pair_position", "pair_penetration"):
            values = values.where(require(history, "pair_on_path") == 1, 0.0)
        if name == "efficiency":
            driving = require(history, "driving_wheel").values.astype(int)
            speed = require(history, "angular_velocity").values[:, driving]
            values = values.where(require(history, "mesh_torque_driving") * speed != 0.0, 0.0)
        if name == "pair_contact_pressure":  # none where a hollow flank touches
            values = values.fillna(0.0)
        if name == "coast_gap":
            values = values.where(values.notnull().any("time"), 0.0)
        if name in OF_REAL_GEARS | OF_VIBRATING_MESHES:
            values = values.fillna(0.0)
        shares[str(name)] = float(np.mean(~np.isfinite(values.values))) if values.size else 0.0
    return xr.DataArray(list(shares.values()), dims="variable", coords={"variable": list(shares)})


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

DEFAULT_TOLERANCE = 1e-9
ENERGIES = ("kinetic_energy", "potential_energy", "dissipated_energy", "load_work")
DEPTH = "penetration"  # the largest or the reference one, whichever is larger
DEPTH_BOUND = 1e-10  # least bound of what is measured by it
ROUNDING = 4 * float(np.finfo(float).eps)  # of a sum of lengths

INVARIANTS = (
    Invariant("gradient ratio", "lambda = -r_bB/r_bA", "itself", 1e-12, gradient_ratio, 1e-3),
    Invariant(
        "transmission error",
        "Delta = h + e + R (inv alpha - inv alpha_0)",
        DEPTH,
        DEPTH_BOUND,
        transmission_error_identity,
        tolerances=1.0,
    ),
    Invariant(
        "points on flanks",
        "r_b g(r_P) = 0",
        DEPTH,
        DEPTH_BOUND,
        distance_from_flanks,
        tolerances=1.0,
    ),
    Invariant(
        "points on line of action",
        "(r_P - K_A).t = 0",
        DEPTH,
        DEPTH_BOUND,
        distance_from_line_of_action,
        tolerances=1.0,
    ),
    Invariant("rigid gap", "kappa = 0", DEPTH, 2 * DEPTH_BOUND, rigid_gap, tolerances=1.0),
    Invariant(
        "rigid gap rate",
        "kappa' = 0",
        "vibration of that depth",
        1e-10,
        rigid_gap_rate,
        tolerances=1.0,
    ),
    Invariant(
        "energy balance",
        "T + V + dissipated - work of loads = constant",
        "energy put in",
        1e-10,
        energy_balance,
        tolerances=10.0,
    ),
    Invariant(
        "torque balance",
        "J omega' = load + sigma (F_n r_b + F_t l) + shafts",
        "largest contact or shaft torque",
        1e-6,
        torque_balance,
    ),
    Invariant("pushing", "F_n >= 0", "reference force", 1e-6, pull),
    Invariant(
        "contact modes",
        "in contact: h >= 0, else h <= 0 and F_n = 0",
        "reference penetration or force",
        1e-6,
        agreement_of_modes,
    ),
    Invariant(
        "extremes",
        "no output beyond its extreme over the run",
        "largest value",
        1e-9,
        beyond_extremes,
    ),
    Invariant("order of times", "t_i < t_(i+1)", "1", 0.0, order_of_times),
    Invariant("finite values", "every value is a number", "number of values", 0.0, finiteness),
)


def _is_tracked(history: xr.Dataset) -> xr.DataArray:
    """Tell when contact points are tracked, dims (time, mesh)."""
    apart = require(history, "contact_mode") == APART
    return (~apart & (require(history, "tracking") != CLOSED_FORM)).transpose("time", "mesh")


def _tracked(history: xr.Dataset) -> tuple[xr.Dataset, xr.DataArray]:
    """Keep the meshes whose contact points are tracked, and tell when, dims (time, mesh)."""
    if not (require(history, "tracking") != CLOSED_FORM).any():
        raise NotApplicableError("closed form: no contact points are tracked")
    when = _is_tracked(history)
    ever = when.any("time").values
    if not ever.any():
        raise NotApplicableError("the flanks are too far apart to track points on them")
    return history.isel(mesh=ever), when.isel(mesh=ever)


def _pressed(history: xr.Dataset) -> tuple[xr.Dataset, xr.DataArray]:
    """Keep the meshes that ever touch, and give the depth that measures them [m], dim (mesh)."""
    pressed = require(history, "penetration") > 0.0
    loaded = require(history, "contact_mode") == LOADED
    touched = (pressed | (loaded & _is_rigid(history))).any("time").values
    if not touched.any():
        raise NotApplicableError("the teeth never touch")
    kept = history.isel(mesh=touched)
    return kept, depth_scale(kept)


def depth_scale(history: xr.Dataset) -> xr.DataArray:
    """Depth by which lengths in a mesh are measured [m], dim (mesh).

    The largest penetration, or the reference one where the teeth hardly touch or are rigid: the
    unit of the integrator's errors. It is at least so large that the rounding of the lengths of
    which a gap is the sum stays within the bound.
    """
    depth = require(history, "penetration").max("time")
    reference = require(history, "reference_penetration")
    arcs = require(history, "base_radius") * abs(require(history, "angle_deviation")).max("time")
    moved = abs(require(history, "centre_displacement")).max("time").sum("axis")
    driving, driven = _of_meshes(history, (arcs + moved).transpose("wheel"))
    least = ROUNDING * (driving + driven).values / DEPTH_BOUND
    return depth.copy(data=np.max([depth.values, reference.values, least], axis=0))


def _is_rigid(history: xr.Dataset) -> xr.DataArray:
    """Tell which meshes have rigid contact, dim (mesh)."""
    return require(history, "rigid_contact") == 1


def _rigid(history: xr.Dataset) -> tuple[xr.Dataset, xr.DataArray]:
    """Keep the meshes with rigid contact, and tell when they are closed, dims (time, mesh)."""
    which = _is_rigid(history).values
    if not which.any():
        raise NotApplicableError("no contact is rigid")
    rigid = history.isel(mesh=which)
    closed = require(rigid, "contact_mode") == LOADED
    if not closed.any():
        raise NotApplicableError("no rigid contact is ever closed")
    return rigid, closed


def _of_both_wheels(history: xr.Dataset, name: str) -> xr.DataArray:
    tracked, when = _tracked(history)
    pressed, depth = _pressed(tracked)
    sides = ["driving", "driven"]
    distances = [require(pressed, f"{name}_{side}") for side in sides]
    both = xr.concat(distances, dim=xr.DataArray(sides, dims="wheel_of_mesh", name="wheel_of_mesh"))
    relative = (both / depth).where(when.sel(mesh=depth["mesh"]), 0.0)
    return relative.transpose("wheel_of_mesh", "time", "mesh")


def _base_radii(history: xr.Dataset) -> tuple[xr.DataArray, xr.DataArray]:
    """Base radii of the driving and the driven wheel of each mesh [m], dims (mesh)."""
    return _of_wheels(history, "base_radius")


def _of_wheels(history: xr.Dataset, name: str) -> tuple[xr.DataArray, xr.DataArray]:
    """Constant of the driving and of the driven wheel of each mesh, dims (mesh)."""
    return _of_meshes(history, require(history, name))


def _of_meshes(history: xr.Dataset, constant: xr.DataArray) -> tuple[xr.DataArray, xr.DataArray]:
    """Values (wheel) of the driving and of the driven wheel of each mesh, dims (mesh)."""
    values = constant.values
    driving, driven = (
        xr.DataArray(values[require(history, f"{side}_wheel").values.astype(int)], dims="mesh")
        for side in ("driving", "driven")
    )
    return driving, driven


def _place(deviation: xr.DataArray, dim: str, index: int) -> str:
    if dim not in deviation.coords:
        return str(index)
    value = deviation[dim].values[index]
    return f"{value:.6g} s" if dim == "time" else str(value)
