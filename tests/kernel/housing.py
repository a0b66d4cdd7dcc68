"""One pair of wheels at a state, in absolute coordinates of the housing, with fifty digits.

Based only on section 7.1 of Kosenko & Gusev (2011) and the definition of the involute. Unlike the
kernel, it does not use deviations from a nominal motion.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cached_property
from typing import Any

import mpmath as mp
import numpy as np

from kernel.description import Block
from kernel.gearbox import TRACKED, Gearbox, State
from kernel.gearbox_description import BEARING, SPEED, load, mesh, wheel
from kernel.kernel import Kernel

mp.mp.dps = 50


def vector(x: Any, y: Any) -> np.ndarray:
    """Vector with fifty digits."""
    return np.array([mp.mpf(x), mp.mpf(y)], dtype=object)


def cross(omega: Any, v: np.ndarray) -> np.ndarray:
    """Return omega k x v."""
    return np.array([-omega * v[1], omega * v[0]], dtype=object)


def turned(angle: Any, v: np.ndarray) -> np.ndarray:
    """Return v rotated counterclockwise."""
    c, s = mp.cos(angle), mp.sin(angle)
    return vector(c * v[0] - s * v[1], s * v[0] + c * v[1])


def length(v: np.ndarray) -> mp.mpf:
    """Return |v|."""
    return mp.sqrt(v[0] ** 2 + v[1] ** 2)


@dataclass(frozen=True)
class Pair:
    """Description of two wheels on bearings and their mesh; wheel 0 drives."""

    teeth: tuple[int, int] = (20, 30)
    pitch_radius: float = 0.2
    alpha_w: float | None = None  # None: the paper's rule
    chi: float = 0.0
    sigma: int = 1
    centre: tuple[float, float] = (0.0, 0.0)
    reference: int = 0  # wheel whose angle is theta: the one with a prescribed speed
    poisson: tuple[float, float] = (0.3, 0.3)

    def gearbox(self, kernel: Kernel, loads: tuple[Block, ...] = (), **fields: Any) -> Gearbox:
        """Create the gearbox; fields of the mesh."""
        bearing = {
            **{"support_kind": BEARING, "support_mass": 5.0},
            **{"support_stiffness": (1e9, 7e8), "support_damping": (1e5, 8e4)},
        }
        wheels = [
            wheel(
                teeth=self.teeth[0],
                pitch_radius=self.pitch_radius,
                centre=self.centre,
                poisson_ratio=self.poisson[0],
                **bearing,
            ),
            wheel(teeth=self.teeth[1], poisson_ratio=self.poisson[1], **bearing),
        ]
        if self.reference == 1:
            loads = (*loads, load(1, SPEED, 3.0))
        description = mesh(
            kernel,
            driving_rotation=-self.sigma,
            centre_line_angle=self.chi,
            pressure_angle=self.alpha_w,
            **fields,
        )
        return Gearbox(kernel, wheels, loads, [description])

    @cached_property
    def ratio(self) -> mp.mpf:
        return mp.mpf(self.teeth[1]) / self.teeth[0]

    @cached_property
    def alpha_0(self) -> mp.mpf:
        if self.alpha_w is not None:
            return mp.mpf(self.alpha_w)
        return mp.mpf("1.05") * mp.atan(2 * mp.pi / (self.teeth[0] * (1 + self.ratio)))

    @cached_property
    def base_radii(self) -> tuple[mp.mpf, mp.mpf]:
        r = mp.mpf(self.pitch_radius) * mp.cos(self.alpha_0)
        return r, r * self.ratio

    @cached_property
    def rho_0(self) -> mp.mpf:
        return sum(self.base_radii) * mp.tan(self.alpha_0)

    @cached_property
    def base_pitch(self) -> mp.mpf:
        return 2 * mp.pi / self.teeth[0] * self.base_radii[0]

    @cached_property
    def speed_ratios(self) -> tuple[mp.mpf, mp.mpf]:
        return (mp.mpf(1), -1 / self.ratio) if self.reference == 0 else (-self.ratio, mp.mpf(1))


@dataclass
class Housing:
    """The pair at a state."""

    pair: Pair
    gearbox: Gearbox
    state: State
    tracked: dict[str, mp.mpf] = field(init=False)

    def __post_init__(self) -> None:
        self.tracked = {}
        if "turn_0" in self.gearbox.names:
            indices = self.gearbox.tracked()
            values = zip(TRACKED, self.state.y[indices], self.state.yp[indices], strict=True)
            for name, value, rate in values:
                self.tracked[name] = mp.mpf(float(value))
                self.tracked[name + "'"] = mp.mpf(float(rate))

    def _y(self, name: str) -> mp.mpf:
        return mp.mpf(float(self.state.y[self.gearbox.index(name)]))

    def _of_wheel(self, name: str, wheel: int) -> mp.mpf:
        return mp.mpf(0) if wheel == self.pair.reference else self._y(f"{name}_{wheel}")

    # ---- wheels

    def turn(self, wheel: int) -> mp.mpf:
        """Angle since the start."""
        theta = self._y("reference_angle") + 2 * mp.pi * int(self.state.integers[0])
        return self.pair.speed_ratios[wheel] * theta + self._of_wheel("angle_deviation", wheel)

    def omega(self, wheel: int) -> mp.mpf:
        """Angular velocity."""
        nominal = self.pair.speed_ratios[wheel] * self._y("reference_speed")
        return nominal + self._of_wheel("speed_deviation", wheel)

    def axle(self, wheel: int) -> np.ndarray:
        """Position of the axis."""
        p = self.pair
        distance = mp.mpf(p.pitch_radius) * (1 + p.ratio)
        centre = vector(*p.centre) + wheel * turned(mp.mpf(p.chi), vector(distance, 0))
        return centre + vector(*(self._y(f"displacement_{x}_{wheel}") for x in "xy"))

    def axle_velocity(self, wheel: int) -> np.ndarray:
        """Velocity of the axis."""
        return vector(*(self._y(f"displacement_{x}_rate_{wheel}") for x in "xy"))

    def root_angle(self, wheel: int) -> mp.mpf:
        """Angle phi of the root of the flank in mesh: start angle, rotation, and tooth number."""
        p = self.pair
        start = (p.rho_0 - p.base_pitch) / 2, (p.rho_0 + p.base_pitch) / 2
        at_start = p.sigma * (p.alpha_0 - start[wheel] / p.base_radii[wheel] + wheel * mp.pi)
        on = (1 - 2 * wheel) * p.sigma * 2 * mp.pi / p.teeth[wheel] * int(self.state.integers[1])
        return mp.mpf(p.chi) + at_start + self.turn(wheel) + on

    # ---- closed form, Assertions 1 and 2

    @property
    def centre_line(self) -> np.ndarray:
        """Vector from the driving to the driven axis."""
        return self.axle(1) - self.axle(0)

    @property
    def alpha(self) -> mp.mpf:
        """Pressure angle at the present centre distance."""
        return mp.acos(sum(self.pair.base_radii) / length(self.centre_line))

    @property
    def directions(self) -> tuple[np.ndarray, np.ndarray]:
        """Return t and e, across and along the line of action."""
        c = self.centre_line
        chi, a, sigma = mp.atan2(c[1], c[0]), self.alpha, self.pair.sigma
        t = vector(mp.cos(a), sigma * mp.sin(a))
        e = vector(mp.sin(a), -sigma * mp.cos(a))
        return turned(chi, t), turned(chi, e)

    def radius_of_curvature(self, wheel: int) -> mp.mpf:
        """Radius of curvature of the wheel's flank at the line of action."""
        c = self.centre_line
        chi = mp.atan2(c[1], c[0])
        roll = wheel * mp.pi + self.alpha - self.pair.sigma * (self.root_angle(wheel) - chi)
        return self.pair.base_radii[wheel] * wrapped(roll)

    @property
    def rho(self) -> mp.mpf:
        """Length of the line of action."""
        return sum(self.pair.base_radii) * mp.tan(self.alpha)

    @property
    def kappa(self) -> mp.mpf:
        """Gap."""
        return self.rho - self.radius_of_curvature(0) - self.radius_of_curvature(1)

    def line_point(self, wheel: int) -> np.ndarray:
        """Intersection of the line of action with the wheel's flank."""
        t, e = self.directions
        sign = 1 - 2 * wheel
        r_b, rho = self.pair.base_radii[wheel], self.radius_of_curvature(wheel)
        return self.axle(wheel) + sign * (r_b * t + rho * e)

    # ---- tracked points

    def _frame(self) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray, mp.mpf]:
        """Return t_0, e_0 of the reference position, t, e turned by `turn`, and rho_A0."""
        p = self.pair
        t_0 = turned(mp.mpf(p.chi), vector(mp.cos(p.alpha_0), p.sigma * mp.sin(p.alpha_0)))
        e_0 = turned(mp.mpf(p.chi), vector(mp.sin(p.alpha_0), -p.sigma * mp.cos(p.alpha_0)))
        c, s = mp.cos(self.tracked["turn"]), mp.sin(self.tracked["turn"])
        theta = self._y("reference_angle") + 2 * mp.pi * int(self.state.integers[0])
        nominal = p.sigma * p.base_radii[0] * p.speed_ratios[0] * theta
        rho_a0 = (p.rho_0 - p.base_pitch) / 2 - nominal - p.base_pitch * int(self.state.integers[1])
        return t_0, e_0, c * t_0 + s * e_0, c * e_0 - s * t_0, rho_a0

    def _apart(self, rate: str = "") -> np.ndarray:
        t_0, e_0, *_ = self._frame()
        return self.tracked["dr_t" + rate] * t_0 + self.tracked["dr_e" + rate] * e_0

    def point(self, wheel: int) -> np.ndarray:
        """Return r_PA or r_PB."""
        *_, t, e, rho_a0 = self._frame()
        a = self.axle(0) + self.pair.base_radii[0] * t + (rho_a0 + self.tracked["zeta"]) * e
        return a + wheel * self._apart()

    def point_velocity(self, wheel: int) -> np.ndarray:
        """Return u_A or u_B."""
        p = self.pair
        *_, t, e, rho_a0 = self._frame()
        advance = -p.sigma * p.base_radii[0] * p.speed_ratios[0] * self._y("reference_speed")
        along = self.tracked["turn'"] * p.base_radii[0] + advance + self.tracked["zeta'"]
        across = -self.tracked["turn'"] * (rho_a0 + self.tracked["zeta"])
        return self.axle_velocity(0) + along * e + across * t + wheel * self._apart("'")

    def flank(self, wheel: int) -> tuple[mp.mpf, np.ndarray]:
        """Flank function g at the tracked point by its definition (4), and its gradient."""
        r_b, sigma = self.pair.base_radii[wheel], self.pair.sigma
        r = self.point(wheel) - self.axle(wheel)
        radius = length(r)
        s = mp.sqrt(radius**2 - r_b**2)
        angle = wrapped(sigma * (mp.atan2(r[1], r[0]) - self.root_angle(wheel)))
        value = s / r_b - mp.acos(r_b / radius) - angle
        return value, (s / r_b * r - sigma * cross(1, r)) / radius**2


def wrapped(angle: mp.mpf) -> mp.mpf:
    """Angle modulo whole revolutions, between -pi and pi."""
    return angle - 2 * mp.pi * mp.nint(angle / (2 * mp.pi))
