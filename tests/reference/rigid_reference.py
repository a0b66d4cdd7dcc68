"""The paper's gearbox with rigid contact, an independent program that evolvent is compared with.

The constraint is eliminated: the pinion's angle and the slider are left, and the gear's
angle follows from them. The normal force is what keeps the second derivative of the gap at 0.
Geometry comes from `gearbox_reference`; scipy's DOP853 integrates between located transitions.

Source: Kosenko & Gusev, 8th Modelica Conference 2011, section 7.3.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import numpy as np
from gearbox_reference import Gearbox, Mode, Setup, State, piece
from numpy.typing import ArrayLike, NDArray
from scipy.integrate import solve_ivp

# Order of the state: angle of the pinion, displacement of the slider, and their rates.
PHI_A, SLIDER, OMEGA_A, SLIDER_RATE = range(4)
# At rtol 1e-10 [rad, m, rad/s, m/s]: about 1e-11 of what each reaches.
ABSOLUTE_TOLERANCE = np.array([1e-12, 1e-20, 2e-12, 1e-16])


class RigidGearbox(Gearbox):
    """Forces and right-hand side of a closed rigid contact."""

    def full(self, y: State) -> list[float]:
        """State of `Gearbox` at the independent coordinates: the lag closes the gap."""
        phi_a, slider, omega_a, slider_rate = (float(v) for v in y)
        sine = math.sqrt(1 - ((self.base_a + self.base_b) / (self.distance_0 + slider)) ** 2)
        lag = self.separation_curvature(slider)
        return [phi_a, lag, slider, omega_a, sine * slider_rate, slider_rate]

    def solve_contact(self, y: State, mode: Mode) -> dict[str, Any]:
        """Forces and accelerations at which the gap stays closed."""
        p = self.setup
        m = self.mesh(self.full(y), mode.teeth_passed)
        saturation = mode.sliding if mode.sliding else m["sliding"] / p.regularisation_velocity
        per_newton = -m["along"] - p.friction * saturation * m["across"]  # force on A over F_n
        cosine, sine = math.cos(m["alpha"]), math.sin(m["alpha"])
        slider_force = p.slider_stiffness * y[SLIDER] + p.slider_damping * y[SLIDER_RATE]

        def accelerations(normal: float) -> tuple[float, float, float]:
            force = normal * per_newton
            torque_a = (m["point"].conjugate() * force).imag
            torque_b = ((m["point"] - m["distance"]).conjugate() * -force).imag
            return (
                (torque_a + p.torque_a) / self.inertia_a,
                (torque_b - p.viscous_b * m["omega_b"]) / self.inertia_b,
                (-force.real - slider_force) / self.sliding_mass,
            )

        def gap(normal: float) -> float:  # second derivative
            a, b, s = accelerations(normal)
            curved = cosine**2 / (m["distance"] * sine) * y[SLIDER_RATE] ** 2
            return float(self.base_a * a + self.base_b * b + sine * s + curved)

        normal = -gap(0.0) / (gap(1.0) - gap(0.0))
        a, b, s = accelerations(normal)
        friction = -p.friction * saturation * normal
        m.update(normal=normal, friction=friction, acceleration_a=a, acceleration_b=b, slider=s)
        return m


def solve_rigid(
    friction: float = 0.0,
    t_end: float = 5.0,
    t_eval: ArrayLike | None = None,
    rtol: float = 1e-10,
    **params: Any,
) -> dict[str, Any]:
    """Integrate from rest while the contact stays closed.

    Parameters
    ----------
    friction : coefficient of friction [1].
    t_end : end of the integration [s].
    t_eval : shape (n,), times of the output [s]; every millisecond if not given.
    rtol : relative tolerance; the absolute ones go with it.
    **params : any other field of `Setup`, SI units.

    Returns
    -------
    dict with arrays of shape (n,): t [s], normal_force, friction_force (on A, along t) [N],
    sliding_velocity [m/s], omega_a, omega_b [rad/s], slider [m], delta [m]. Beside them
    switch_times [s], and events, a list of (t, name).
    """
    gearbox = RigidGearbox(Setup(friction=friction, **params))
    if t_eval is None:
        t_eval = np.linspace(0.0, t_end, round(t_end * 1000) + 1)
    grid = np.asarray(t_eval, float)
    mode = Mode()
    t, y = 0.0, np.array([gearbox.phi_start, 0.0, 0.0, 0.0])
    rows: list[dict[str, float]] = []
    events: list[tuple[float, str]] = []
    while True:
        watched = transitions(gearbox, mode)
        solution = solve_ivp(
            lambda _t, y: rates(gearbox, mode, y),
            (t, t_end),
            y,
            method="DOP853",
            t_eval=grid[(grid >= t) & (grid <= t_end)],
            events=list(watched.values()),
            first_step=min(1e-7, t_end - t),
            rtol=rtol,
            atol=ABSOLUTE_TOLERANCE * rtol / 1e-10,
        )
        if solution.status < 0:
            raise RuntimeError(f"at t = {solution.t[-1]} s: {solution.message}")
        rows += [
            row(gearbox, mode, time, state)
            for time, state in zip(solution.t, np.transpose(solution.y), strict=True)
        ]
        if solution.status == 0:
            break
        name, t, y = next(
            (name, times[0], states[0])
            for name, times, states in zip(
                watched, solution.t_events, solution.y_events, strict=True
            )
            if len(times)
        )
        grid = grid[grid > t]
        events.append((t, name))
        apply(gearbox, mode, name, y)
    result: dict[str, Any] = {name: np.array([r[name] for r in rows]) for name in rows[0]}
    result["switch_times"] = np.array([time for time, name in events if name == "tooth_switch"])
    result["events"] = events
    return result


def rates(gearbox: RigidGearbox, mode: Mode, y: State) -> list[float]:
    """Time derivative of the state."""
    m = gearbox.solve_contact(y, mode)
    return [y[OMEGA_A], y[SLIDER_RATE], m["acceleration_a"], m["slider"]]


def row(gearbox: RigidGearbox, mode: Mode, t: float, y: NDArray[np.float64]) -> dict[str, float]:
    """One row of output."""
    m = gearbox.solve_contact(y, mode)
    if m["normal"] < 0:
        raise RuntimeError(f"at t = {t} s the contact would have to pull")
    return {
        "t": t,
        "normal_force": m["normal"],
        "friction_force": m["friction"],
        "sliding_velocity": m["sliding"],
        "omega_a": y[OMEGA_A],
        "omega_b": m["omega_b"],
        "slider": y[SLIDER],
        "delta": gearbox.separation_curvature(y[SLIDER]),
    }


def transitions(gearbox: RigidGearbox, mode: Mode) -> dict[str, Callable[[float, State], Any]]:
    """Functions of (t, state) whose roots end the present mode: terminal events."""
    delta = gearbox.setup.regularisation_velocity

    def next_tooth(_t: float, y: State) -> float:
        return gearbox.phi_start - y[PHI_A] - (mode.teeth_passed + 1) * gearbox.pitch_a

    def sliding(y: State) -> float:
        return float(gearbox.mesh(gearbox.full(y), mode.teeth_passed)["sliding"])

    def above(_t: float, y: State) -> float:
        return sliding(y) - delta

    def below(_t: float, y: State) -> float:
        return sliding(y) + delta

    def directed(function: Any, direction: int) -> Any:
        function.terminal, function.direction = True, direction
        return function

    found = {"tooth_switch": directed(next_tooth, 1)}
    if gearbox.setup.friction > 0.0:
        if mode.sliding == 0:
            found["above"], found["below"] = directed(above, 1), directed(below, -1)
        elif mode.sliding > 0:
            found["above"] = directed(above, -1)
        else:
            found["below"] = directed(below, 1)
    return found


def apply(gearbox: RigidGearbox, mode: Mode, name: str, y: State) -> None:
    """Change the mode; a tooth switch moves the contact point, which changes the sliding."""
    if name == "tooth_switch":
        mode.teeth_passed += 1
        sliding = gearbox.mesh(gearbox.full(y), mode.teeth_passed)["sliding"]
        mode.sliding = piece(sliding, gearbox.setup.regularisation_velocity)
    else:
        leaving = 1 if name == "above" else -1
        mode.sliding = leaving if mode.sliding == 0 else 0
