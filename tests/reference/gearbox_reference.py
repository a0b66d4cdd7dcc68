"""The paper's gearbox once more: an independent program that evolvent is compared with.

Nothing here comes from the kernel. The plane is the complex plane, contact is the closed form (the
common tangent of the two base circles), the Johnson force comes from scipy's Lambert W, and the
integration is scipy's DOP853 from one located transition to the next. Vectors stay vectors: torques
and speeds are products of complex numbers, not formulas worked out beforehand.

Setup: a pinion A at the origin that turns clockwise, a gear B on a slider along x at L + s, a
constant torque on A and a viscous one on B; the defaults are those of examples/paper.yaml.

Source: Kosenko & Gusev, 8th Modelica Conference 2011, pp. 315-328, whose equation numbers we use.
"""

from __future__ import annotations

import cmath
import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, fields
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.integrate import solve_ivp
from scipy.special import lambertw

State = Sequence[float] | NDArray[np.float64]

# Order of the state. The two mesh variables are states of their own, so that a lag of nanometres is
# not the difference of two angles of many radians.
PHI_A, LAG, SLIDER, OMEGA_A, LAG_RATE, SLIDER_RATE, LOAD_WORK, DISSIPATED = range(8)

# Absolute tolerances at rtol 1e-10 [rad, m, m, rad/s, m/s, m/s, J, J]:
# about 1e-11 of what each reaches.
ABSOLUTE_TOLERANCE = np.array([1e-12, 3e-20, 3e-20, 2e-12, 2e-16, 2e-16, 1e-12, 1e-12])

GAUSS_NODES, GAUSS_WEIGHTS = (a.tolist() for a in np.polynomial.legendre.leggauss(4))


@dataclass(frozen=True)
class Setup:
    """Parameters in SI units; what the paper leaves open has the values of examples/paper.yaml."""

    friction: float = 0.0
    regularisation_velocity: float = 1e-4  # [m/s]
    teeth_a: int = 20
    teeth_b: int = 30
    pitch_radius_a: float = 0.2  # [m]
    width: float = 0.1  # [m]
    youngs_modulus: float = 2e11  # [Pa], both wheels
    poisson_ratio: float = 0.3
    density: float = 7800.0  # [kg/m^3], solid discs of the pitch radius
    torque_a: float = -1.0  # [N m], counterclockwise positive
    viscous_b: float = 10.0  # [N m s]
    contact_damping: float = 1e4  # [N s/m]
    slider_mass: float = 10.0  # [kg], beside the gear's own
    slider_stiffness: float = 1e9  # [N/m]
    slider_damping: float = 1e5  # [N s/m]
    pressure_angle: float | None = None  # [rad]; None: 1.05 times the smallest one


class Gearbox:
    """Geometry, forces and right-hand side at frozen contact and friction modes."""

    def __init__(self, setup: Setup) -> None:
        p = self.setup = setup
        ratio = p.teeth_b / p.teeth_a
        smallest = math.atan(2 * math.pi / (p.teeth_a * (1 + ratio)))
        self.alpha_0 = 1.05 * smallest if p.pressure_angle is None else p.pressure_angle
        radius_a, radius_b = p.pitch_radius_a, ratio * p.pitch_radius_a
        self.base_a = radius_a * math.cos(self.alpha_0)
        self.base_b = radius_b * math.cos(self.alpha_0)
        self.distance_0 = radius_a + radius_b
        self.pitch_a = 2 * math.pi / p.teeth_a
        length = math.sqrt(self.distance_0**2 - (self.base_a + self.base_b) ** 2)
        self.curvature_start_a = (length - self.base_a * self.pitch_a) / 2
        self.phi_start = self.alpha_0 - self.curvature_start_a / self.base_a
        mass_a = p.density * math.pi * radius_a**2 * p.width
        mass_b = p.density * math.pi * radius_b**2 * p.width
        self.inertia_a = mass_a * radius_a**2 / 2
        self.inertia_b = mass_b * radius_b**2 / 2
        self.sliding_mass = mass_b + p.slider_mass
        self.effective_modulus = p.youngs_modulus / (2 * (1 - p.poisson_ratio**2))

    def johnson(self, depth: float, curvature: float) -> float:
        """Elastic force [N] by (13)-(14) from the depth and rho_A + rho_B [m]; 0 for a gap."""
        if depth <= 0.0:
            return 0.0
        x = math.e * depth / (4 * curvature)
        if x >= 1 / math.e:
            raise ValueError(f"depth {depth} m is beyond limit (15)")
        y = math.exp(lambertw(-x, -1).real)
        return self.setup.width * 4 * math.pi * self.effective_modulus * curvature * y / math.e

    def separation_curvature(self, slider: float) -> float:
        """R (inv alpha - inv alpha_0) [m]: the integral of sin(alpha) over the centre distance."""
        base = self.base_a + self.base_b
        total = 0.0
        for node, weight in zip(GAUSS_NODES, GAUSS_WEIGHTS, strict=True):
            distance = self.distance_0 + slider * (1 + node) / 2
            total += weight * math.sqrt(1 - (base / distance) ** 2)
        return slider * total / 2

    def mesh(self, y: State, teeth_passed: int) -> dict[str, Any]:
        """Everything of the mesh at a state: depth, unclipped force, sliding, contact point."""
        p = self.setup
        phi_a, lag, slider, omega_a, lag_rate, slider_rate = (float(v) for v in y[:6])
        omega_b = -(lag_rate + self.base_a * omega_a) / self.base_b
        distance = self.distance_0 + slider
        alpha = math.acos((self.base_a + self.base_b) / distance)
        across = cmath.exp(1j * alpha)  # common normal of the base circles
        along = -1j * across  # A pushes B this way
        length = distance * math.sin(alpha)
        depth = lag - self.separation_curvature(slider)
        curvature_a = self.base_a * (alpha - phi_a) - teeth_passed * self.base_a * self.pitch_a
        curvature_b = length + depth - curvature_a
        point = self.base_a * across + (curvature_a - depth / 2) * along
        velocity = 1j * omega_a * point - (1j * omega_b * (point - distance) + slider_rate)
        relative = velocity * across.conjugate()  # real part: across, imaginary part: against along
        approach = -relative.imag
        elastic = self.johnson(depth, length + depth)
        return {
            "omega_b": omega_b,
            "alpha": alpha,
            "across": across,
            "along": along,
            "distance": distance,
            "length": length,
            "depth": depth,
            "curvature_a": curvature_a,
            "curvature_b": curvature_b,
            "point": point,
            "sliding": relative.real,
            "approach": approach,
            "elastic": elastic,
            "unclipped": elastic + (p.contact_damping * approach if depth > 0 else 0.0),
        }

    def loads(self, y: State, teeth_passed: int, pushing: bool, sliding: int) -> dict[str, Any]:
        """The mesh with its forces. `sliding`: on which piece of the friction law, -1, 0 or 1."""
        m = self.mesh(y, teeth_passed)
        normal = m["unclipped"] if pushing else 0.0
        saturation = sliding if sliding else m["sliding"] / self.setup.regularisation_velocity
        friction = -self.setup.friction * normal * saturation
        m.update(normal=normal, friction=friction)
        m["force_a"] = -normal * m["along"] + friction * m["across"]
        return m

    def rhs(self, y: State, teeth_passed: int, pushing: bool, sliding: int) -> list[float]:
        """Time derivative of the state."""
        p = self.setup
        omega_a, slider, slider_rate = y[OMEGA_A], y[SLIDER], y[SLIDER_RATE]
        m = self.loads(y, teeth_passed, pushing, sliding)
        force = m["force_a"]
        torque_a = (m["point"].conjugate() * force).imag
        torque_b = ((m["point"] - m["distance"]).conjugate() * -force).imag
        acceleration_a = (torque_a + p.torque_a) / self.inertia_a
        acceleration_b = (torque_b - p.viscous_b * m["omega_b"]) / self.inertia_b
        spring_and_damper = p.slider_stiffness * slider + p.slider_damping * slider_rate
        lost = (m["normal"] - (m["elastic"] if m["depth"] > 0 else 0.0)) * m["approach"]
        return [
            omega_a,
            y[LAG_RATE],
            slider_rate,
            acceleration_a,
            -(self.base_a * acceleration_a + self.base_b * acceleration_b),
            (-force.real - spring_and_damper) / self.sliding_mass,
            p.torque_a * omega_a - p.viscous_b * m["omega_b"] ** 2,
            lost - m["friction"] * m["sliding"] + p.slider_damping * slider_rate**2,
        ]


@dataclass
class Mode:
    """What is constant between two transitions."""

    teeth_passed: int = 0
    pushing: bool = True
    sliding: int = 0


def transitions(gearbox: Gearbox, mode: Mode) -> dict[str, Callable[[float, State], Any]]:
    """The functions of (t, state) whose roots end the present mode: terminal events."""
    delta = gearbox.setup.regularisation_velocity

    def next_tooth(_t: float, y: State) -> float:
        return gearbox.phi_start - y[PHI_A] - (mode.teeth_passed + 1) * gearbox.pitch_a

    def tooth_before(_t: float, y: State) -> float:
        return gearbox.phi_start - y[PHI_A] - (mode.teeth_passed - 1) * gearbox.pitch_a

    def push(_t: float, y: State) -> Any:
        m = gearbox.mesh(y, mode.teeth_passed)
        return m["unclipped"] if m["depth"] > 0 else gearbox.setup.slider_stiffness * m["depth"]

    def above(_t: float, y: State) -> Any:
        return gearbox.mesh(y, mode.teeth_passed)["sliding"] - delta

    def below(_t: float, y: State) -> Any:
        return gearbox.mesh(y, mode.teeth_passed)["sliding"] + delta

    def directed(function: Any, direction: int) -> Any:
        function.terminal, function.direction = True, direction
        return function

    found = {
        "tooth_switch": directed(next_tooth, 1),
        "tooth_switch_back": directed(tooth_before, -1),
        "push": directed(push, -1 if mode.pushing else 1),
    }
    if gearbox.setup.friction > 0.0:
        if mode.sliding == 0:
            found["above"], found["below"] = directed(above, 1), directed(below, -1)
        elif mode.sliding > 0:
            found["above"] = directed(above, -1)
        else:
            found["below"] = directed(below, 1)
    return found


def piece(sliding_velocity: float, delta: float) -> int:
    """Which piece of the friction law a sliding velocity is on."""
    return int(sliding_velocity > delta) - int(sliding_velocity < -delta)


def apply_transition(gearbox: Gearbox, mode: Mode, name: str, y: State) -> None:
    """Change the mode; a tooth switch moves the contact point, which changes the sliding."""
    if name.startswith("tooth_switch"):
        mode.teeth_passed += 1 if name == "tooth_switch" else -1
        sliding = gearbox.mesh(y, mode.teeth_passed)["sliding"]
        mode.sliding = piece(sliding, gearbox.setup.regularisation_velocity)
    elif name == "push":
        mode.pushing = not mode.pushing
    else:
        leaving = 1 if name == "above" else -1
        mode.sliding = leaving if mode.sliding == 0 else 0


def solve(
    friction: float = 0.0,
    t_end: float = 5.0,
    t_eval: ArrayLike | None = None,
    rtol: float = 1e-10,
    **params: Any,
) -> dict[str, Any]:
    """Integrate from rest, flanks touching at the start of contact.

    Parameters
    ----------
    friction : coefficient of friction [1].
    t_end : end of the integration [s].
    t_eval : shape (n,), times of the output [s]; every millisecond if not given.
    rtol : relative tolerance; the absolute ones go with it.
    **params : any other field of `Setup`, SI units.

    Returns
    -------
    dict with arrays of shape (n,): t [s], h (signed) [m], normal_force, elastic_force [N],
    friction_force (on A, along t) [N], sliding_velocity [m/s], phi_a (since the start) [rad],
    omega_a, omega_b [rad/s], acceleration_a, acceleration_b [rad/s^2], slider, delta (lag of the
    gear, (19)) [m], delta_rate, slider_rate [m/s], teeth_passed, load_work, dissipated [J],
    curvature_a, curvature_b [m], alpha [rad]; point and along (complex), the contact point [m] and
    the direction of the line of action. Beside them switch_times [s]; events, a list of (t, name,
    state before); gearbox, the `Gearbox`.
    """
    unknown = set(params) - {field.name for field in fields(Setup)}
    if unknown:
        raise TypeError(f"no such parameter: {', '.join(sorted(unknown))}")
    gearbox = Gearbox(Setup(friction=friction, **params))
    if t_eval is None:
        t_eval = np.linspace(0.0, t_end, round(t_end * 1000) + 1)
    grid = np.asarray(t_eval, float)
    rows: dict[str, list[Any]] = {}
    events: list[tuple[float, str, NDArray[np.float64]]] = []
    mode = Mode()
    t = 0.0
    y = np.zeros(8)
    y[PHI_A] = gearbox.phi_start
    while True:
        watched = transitions(gearbox, mode)
        solution = solve_ivp(
            lambda _t, y: gearbox.rhs(y, mode.teeth_passed, mode.pushing, mode.sliding),
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
        for time, state in zip(solution.t, np.transpose(solution.y), strict=True):
            record(rows, time, state, gearbox, mode)
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
        events.append((t, name, y))
        apply_transition(gearbox, mode, name, y)
    result: dict[str, Any] = {name: np.array(values) for name, values in rows.items()}
    result["switch_times"] = np.array([time for time, name, _ in events if name == "tooth_switch"])
    result["events"] = events
    result["gearbox"] = gearbox
    return result


def record(rows: dict[str, list[Any]], t: float, y: State, gearbox: Gearbox, mode: Mode) -> None:
    """Append one row of output."""
    m = gearbox.loads(y, mode.teeth_passed, mode.pushing, mode.sliding)
    rates = gearbox.rhs(y, mode.teeth_passed, mode.pushing, mode.sliding)
    acceleration_a = rates[OMEGA_A]
    row = {
        "t": t,
        "h": m["depth"],
        "normal_force": m["normal"],
        "elastic_force": m["elastic"],
        "friction_force": m["friction"],
        "sliding_velocity": m["sliding"],
        "phi_a": y[PHI_A] - gearbox.phi_start,
        "omega_a": y[OMEGA_A],
        "omega_b": m["omega_b"],
        "acceleration_a": acceleration_a,
        "acceleration_b": -(rates[LAG_RATE] + gearbox.base_a * acceleration_a) / gearbox.base_b,
        "slider": y[SLIDER],
        "delta": y[LAG],
        "delta_rate": y[LAG_RATE],
        "slider_rate": y[SLIDER_RATE],
        "teeth_passed": mode.teeth_passed,
        "load_work": y[LOAD_WORK],
        "dissipated": y[DISSIPATED],
        "curvature_a": m["curvature_a"],
        "curvature_b": m["curvature_b"],
        "alpha": m["alpha"],
        "point": m["point"],
        "along": m["along"],
    }
    for name, value in row.items():
        rows.setdefault(name, []).append(value)
