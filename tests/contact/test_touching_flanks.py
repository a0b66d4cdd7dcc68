"""Where relieved flanks touch: the kernel against real curves that are turned until they touch.

The curves are the involutes moved along their normals, written down point by point; the place of
contact is where the driving one first reaches the other as it turns, the curvatures are those of
the curves there by numerical derivatives. Nothing of the kernel's theory enters.
"""

from __future__ import annotations

from dataclasses import dataclass

import mpmath as mp
import numpy as np
import pytest
from scipy.optimize import brentq, minimize_scalar

from kernel.description import Block
from kernel.deviations import LINEAR, PARABOLIC, deviations, relief
from kernel.gearbox import Gearbox
from kernel.gearbox_description import TORQUE, load, mesh, wheel
from kernel.gears import gear_description
from kernel.kernel import Floats, Kernel, _at

MODULE, ALPHA, TEETH = 3e-3, np.radians(20), (20, 35)
BASE = [MODULE * z / 2 * np.cos(ALPHA) for z in TEETH]
TIP = [np.sqrt((MODULE * (z / 2 + 1)) ** 2 - r**2) for z, r in zip(TEETH, BASE, strict=True)]
LINE = MODULE * sum(TEETH) / 2 * np.sin(ALPHA)
START = [LINE - TIP[1], LINE - TIP[0]]


@dataclass(frozen=True)
class Profile:
    """What one flank lacks: reliefs as (amount, border) and their power, and crowning."""

    wheel: int
    tip: tuple[float, float] = (0.0, 1.0)
    root: tuple[float, float] = (0.0, 0.0)
    power: int = 1
    crowning: float = 0.0

    def lacks(self, rho):
        """Deviation at a radius of curvature."""
        end, start = TIP[self.wheel], START[self.wheel]
        e = self.crowning * ((2 * rho - start - end) / (end - start)) ** 2
        if rho > self.tip[1]:
            e += self.tip[0] * ((rho - self.tip[1]) / (end - self.tip[1])) ** self.power
        if rho < self.root[1]:
            e += self.root[0] * ((self.root[1] - rho) / (self.root[1] - start)) ** self.power
        return e

    def point(self, rho):
        """Point of the real flank in the wheel's frame; its involute begins on the x axis."""
        r, beta = BASE[self.wheel], rho / BASE[self.wheel]
        arm = rho - self.lacks(rho)
        sin, cos = (mp.sin, mp.cos) if isinstance(rho, mp.mpf) else (np.sin, np.cos)
        return r * cos(beta) + arm * sin(beta), r * sin(beta) - arm * cos(beta)

    def curvature(self, rho: float) -> float:
        """Curvature of the real flank from its points."""
        with mp.workdps(40):
            at = mp.mpf(rho)
            x, y = (
                [mp.diff(lambda s, i=i: self.point(s)[i], at, n) for n in (1, 2)] for i in (0, 1)
            )
            return float((x[0] * y[1] - y[0] * x[1]) / (x[0] ** 2 + y[0] ** 2) ** 1.5)

    def described(self) -> Block:
        """Describe it for the kernel."""
        shape, r = (LINEAR, PARABOLIC)[self.power - 1], BASE[self.wheel]
        blocks = {
            name: relief(amount, roll_angle=border / r, shape=shape)
            for name, (amount, border) in {"tip_relief": self.tip, "root_relief": self.root}.items()
            if amount > 0
        }
        return deviations(profile_crowning=self.crowning, **blocks)


@dataclass(frozen=True)
class Touch:
    """Two real flanks in contact."""

    rho: float  # of the driving flank on the line of action
    second_order: float  # by how much the gap of first order is wider than the real one, which is 0
    curvature: float


def turned(
    flanks: tuple[Profile, Profile], rho: float, turn: float, s: float
) -> tuple[float, float]:
    """Distance from the driven flank of the point s of the driving one, and the driven one's rho.

    The driving wheel has its axle at the origin, the line of action runs along x at the height of
    its base radius; the driven wheel is its like, turned upside down. The flanks meet the line at
    rho and LINE - rho before the driving wheel turns on.
    """
    x, y = flanks[0].point(s)
    angle = np.pi / 2 - rho / BASE[0] - turn
    x, y = np.cos(angle) * x - np.sin(angle) * y, np.sin(angle) * x + np.cos(angle) * y
    x, y = LINE - x, sum(BASE) - y
    tangent = np.sqrt(x**2 + y**2 - BASE[1] ** 2)
    beta = np.arctan2(y, x) + np.arctan2(tangent, BASE[1])
    other = LINE - rho + BASE[1] * (beta - np.pi / 2)
    return flanks[1].lacks(other) - (other - tangent), other


def touching(flanks: tuple[Profile, Profile], rho: float) -> Touch:
    """Turn the driving wheel until the flanks touch."""
    reach = min(2e-3, 0.4 * rho)

    def nearest(turn: float) -> tuple[float, float]:
        places = np.linspace(rho - reach, rho + reach, 401)
        gaps = [turned(flanks, rho, turn, s)[0] for s in places]
        i = int(np.argmin(gaps))
        assert 0 < i < len(places) - 1
        found = minimize_scalar(
            lambda s: turned(flanks, rho, turn, s)[0],
            bounds=(places[i - 1], places[i + 1]),
            method="bounded",
            options={"xatol": 1e-12},
        )
        return float(found.fun), float(found.x)

    turn = brentq(lambda turn: nearest(turn)[0], -1e-5, 2e-3, xtol=1e-13)
    place = nearest(turn)[1]
    other = turned(flanks, rho, turn, place)[1]
    on_line = rho + BASE[0] * turn
    first_order = flanks[0].lacks(on_line) + flanks[1].lacks(LINE - rho) - BASE[0] * turn
    curvature = flanks[0].curvature(place) + flanks[1].curvature(other)
    return Touch(on_line, first_order, curvature)


def gearbox_of(kernel: Kernel, flanks: tuple[Profile, Profile]) -> Gearbox:
    wheels = [
        wheel(teeth=z, width=0.02, gear=gear_description(MODULE), deviation=flank.described())
        for z, flank in zip(TEETH, flanks, strict=True)
    ]
    wheels[0].centre = (0.0, 0.0)
    description = mesh(kernel, 0, 1)
    description.pop("pressure_angle")
    return Gearbox(kernel, wheels, [load(0, TORQUE, -100.0)], [description])


def of_kernel(gearbox: Gearbox, rho: Floats) -> tuple[Floats, Floats]:
    """Second order and curvature at radii of curvature of the driving flank."""
    second_order, curvature = np.empty(len(rho)), np.empty(len(rho))
    gearbox.library.test_touching_flanks(
        gearbox.handle, 0, 0, len(rho), _at(rho), _at(second_order), _at(curvature)
    )
    return second_order, curvature


NONE = (Profile(0), Profile(1))
BORDER = TIP[0] - 3e-3  # of tip relief on the driving flank [m]
CASES = {
    "linear": (Profile(0, tip=(20e-6, BORDER)), NONE[1]),
    "linear, 40 um": (Profile(0, tip=(40e-6, BORDER)), NONE[1]),
    "parabolic": (Profile(0, tip=(20e-6, BORDER), power=2), NONE[1]),
    "parabolic, 40 um": (Profile(0, tip=(40e-6, BORDER), power=2), NONE[1]),
    "driven tip": (NONE[0], Profile(1, tip=(30e-6, TIP[1] - 3e-3), power=2)),
    "root": (Profile(0, root=(10e-6, START[0] + 2e-3), power=2), NONE[1]),
    "crowned": (Profile(0, crowning=10e-6), Profile(1, crowning=15e-6)),
    "all": (
        Profile(0, tip=(20e-6, BORDER), crowning=5e-6, power=2),
        Profile(1, tip=(15e-6, TIP[1] - 2e-3), crowning=5e-6, power=2),
    ),
}
WIDE = 1e-3  # from a corner, where linear relief begins, and from the ends of the path [m]
PLACES = np.linspace(START[0] + WIDE, TIP[0] - 2e-4, 7)


def smooth(name: str, rho: float) -> bool:
    """Whether a place is away from the corner of a linear relief."""
    return not name.startswith("linear") or abs(rho - BORDER - WIDE / 2) > WIDE


@pytest.mark.parametrize("name", CASES)
def test_pressure_and_gap_are_those_of_real_curves(kernel: Kernel, name: str):
    flanks = CASES[name]
    gearbox = gearbox_of(kernel, flanks)
    touches = [touching(flanks, rho) for rho in PLACES if smooth(name, rho)]
    assert len(touches) >= 5
    second_order, curvature = of_kernel(gearbox, np.array([touch.rho for touch in touches]))
    exact = np.array([touch.curvature for touch in touches])
    gap = np.array([touch.second_order for touch in touches])
    # the pressure is as the root of the curvature: 1 % is asked for
    np.testing.assert_allclose(np.sqrt(curvature), np.sqrt(exact), rtol=2e-3)
    # what is left is of third order; 1e-9 m is what the reference resolves
    np.testing.assert_allclose(second_order, gap, rtol=0.02, atol=2e-9)
    involutes = [1 / touch.rho + 1 / (LINE - touch.rho) for touch in touches]
    assert np.abs(np.sqrt(involutes / exact) - 1).max() > 0.005  # that of the involutes is wrong


def test_flanks_without_deviations_have_the_curvatures_of_involutes(kernel: Kernel):
    second_order, curvature = of_kernel(gearbox_of(kernel, NONE), PLACES)
    assert not second_order.any()
    np.testing.assert_allclose(curvature, 1 / PLACES + 1 / (LINE - PLACES), rtol=1e-15)


def test_a_flank_too_hollow_for_a_hertzian_contact_has_no_pressure(kernel: Kernel):
    """Linear relief of the root whose slope turns with the arc: hollow next to the base circle."""
    flank = Profile(0, tip=(1.2e-3, START[0] + 1e-4))
    second_order, curvature = of_kernel(gearbox_of(kernel, (flank, NONE[1])), PLACES)
    hollow = np.isnan(curvature)
    assert hollow.any()
    assert (curvature[~hollow] > 0).all()
    assert np.isfinite(second_order).all()


def test_one_warning_names_the_second_order_of_the_gap_and_its_place(kernel: Kernel):
    gearbox = gearbox_of(kernel, CASES["linear, 40 um"])
    (warning,) = [w for w in gearbox.warnings() if "first order" in str(w)]
    second_order, _ = of_kernel(gearbox, np.linspace(START[0], TIP[0], 201))
    given = float(str(warning).split("up to ")[1].split(" m too wide")[0])
    assert given == pytest.approx(second_order.max(), rel=1e-5)  # six digits
    # 0.1 um of relief: its second order is far below 2 % of the penetration
    small = gearbox_of(kernel, (Profile(0, tip=(1e-7, BORDER)), NONE[1]))
    assert not [w for w in small.warnings() if "first order" in str(w)]
