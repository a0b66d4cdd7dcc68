"""Contact of relieved flanks: the kernel against actual curves rotated into contact.

The curves are the involutes displaced along their normals, evaluated point by point. The contact
point is where the driving curve first reaches the other as it rotates. The curvatures are those of
the curves by numerical derivatives. The theory of the kernel is not used.
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
    """Deviations of one flank: reliefs as (amount, zone limit) and their power, and crowning."""

    wheel: int
    tip: tuple[float, float] = (0.0, 1.0)
    root: tuple[float, float] = (0.0, 0.0)
    power: int = 1
    crowning: float = 0.0

    def deviation(self, rho):
        """Deviation at a radius of curvature."""
        end, start = TIP[self.wheel], START[self.wheel]
        e = self.crowning * ((2 * rho - start - end) / (end - start)) ** 2
        if rho > self.tip[1]:
            e += self.tip[0] * ((rho - self.tip[1]) / (end - self.tip[1])) ** self.power
        if rho < self.root[1]:
            e += self.root[0] * ((self.root[1] - rho) / (self.root[1] - start)) ** self.power
        return e

    def point(self, rho):
        """Point of the actual flank in the wheel's frame; its involute starts on the x axis."""
        r, beta = BASE[self.wheel], rho / BASE[self.wheel]
        arm = rho - self.deviation(rho)
        sin, cos = (mp.sin, mp.cos) if isinstance(rho, mp.mpf) else (np.sin, np.cos)
        return r * cos(beta) + arm * sin(beta), r * sin(beta) - arm * cos(beta)

    def curvature(self, rho: float) -> float:
        """Curvature of the actual flank from its points."""
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
    """Two actual flanks in contact."""

    rho: float  # of the driving flank on the line of action
    second_order: float  # excess of the gap of first order over the actual one, which is 0
    curvature: float


def turned(
    flanks: tuple[Profile, Profile], rho: float, turn: float, s: float
) -> tuple[float, float]:
    """Distance of the point s of the driving flank from the driven flank, and the latter's rho.

    The driving wheel has its axis at the origin; the line of action runs along x at the height of
    its base radius. The driven wheel is equal, rotated by 180 degrees. The flanks meet the line at
    rho and LINE - rho before the driving wheel is rotated further.
    """
    x, y = flanks[0].point(s)
    angle = np.pi / 2 - rho / BASE[0] - turn
    x, y = np.cos(angle) * x - np.sin(angle) * y, np.sin(angle) * x + np.cos(angle) * y
    x, y = LINE - x, sum(BASE) - y
    tangent = np.sqrt(x**2 + y**2 - BASE[1] ** 2)
    beta = np.arctan2(y, x) + np.arctan2(tangent, BASE[1])
    other = LINE - rho + BASE[1] * (beta - np.pi / 2)
    return flanks[1].deviation(other) - (other - tangent), other


def touching(flanks: tuple[Profile, Profile], rho: float) -> Touch:
    """Rotate the driving wheel until the flanks touch."""
    reach = min(2e-3, 0.4 * rho)

    def nearest(turn: float) -> tuple[float, float]:
        positions = np.linspace(rho - reach, rho + reach, 401)
        gaps = [turned(flanks, rho, turn, s)[0] for s in positions]
        i = int(np.argmin(gaps))
        assert 0 < i < len(positions) - 1
        found = minimize_scalar(
            lambda s: turned(flanks, rho, turn, s)[0],
            bounds=(positions[i - 1], positions[i + 1]),
            method="bounded",
            options={"xatol": 1e-12},
        )
        return float(found.fun), float(found.x)

    turn = brentq(lambda turn: nearest(turn)[0], -1e-5, 2e-3, xtol=1e-13)
    position = nearest(turn)[1]
    other = turned(flanks, rho, turn, position)[1]
    on_line = rho + BASE[0] * turn
    first_order = flanks[0].deviation(on_line) + flanks[1].deviation(LINE - rho) - BASE[0] * turn
    curvature = flanks[0].curvature(position) + flanks[1].curvature(other)
    return Touch(on_line, first_order, curvature)


def gearbox_of(kernel: Kernel, flanks: tuple[Profile, Profile], **keys: str) -> Gearbox:
    wheels = [
        wheel(teeth=z, width=0.02, gear=gear_description(MODULE), deviation=flank.described())
        for z, flank in zip(TEETH, flanks, strict=True)
    ]
    wheels[0].centre = (0.0, 0.0)
    description = mesh(kernel, 0, 1, **keys)
    description.pop("pressure_angle")
    return Gearbox(kernel, wheels, [load(0, TORQUE, -100.0)], [description])


def of_kernel(gearbox: Gearbox, rho: Floats) -> tuple[Floats, Floats, Floats]:
    """Excess of the gap, curvature, deviation used by the gap.

    All at radii of curvature of the driving flank.
    """
    values = np.empty((3, len(rho)))
    gearbox.library.test_touching_flanks(
        gearbox.handle, 0, 0, len(rho), _at(rho), *(_at(row) for row in values)
    )
    too_wide, curvature, gap = values
    return too_wide, curvature, gap


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
WIDE = 1e-3  # from a corner, at the start of linear relief, and from the ends of the path [m]
POSITIONS = np.linspace(START[0] + WIDE, TIP[0] - 2e-4, 7)


def smooth(name: str, rho: float) -> bool:
    """Whether a position is away from the corner of a linear relief."""
    return not name.startswith("linear") or abs(rho - BORDER - WIDE / 2) > WIDE


@pytest.mark.parametrize("name", CASES)
def test_pressure_and_gap_are_those_of_real_curves(kernel: Kernel, name: str):
    flanks = CASES[name]
    gearbox = gearbox_of(kernel, flanks)
    touches = [touching(flanks, rho) for rho in POSITIONS if smooth(name, rho)]
    assert len(touches) >= 5
    second_order, curvature, _ = of_kernel(gearbox, np.array([touch.rho for touch in touches]))
    exact = np.array([touch.curvature for touch in touches])
    gap = np.array([touch.second_order for touch in touches])
    # the pressure is proportional to the root of the curvature: 1 % is required
    np.testing.assert_allclose(np.sqrt(curvature), np.sqrt(exact), rtol=2e-3)
    # the remainder is of third order; the reference resolves 1e-9 m
    np.testing.assert_allclose(second_order, gap, rtol=0.02, atol=2e-9)
    involutes = [1 / touch.rho + 1 / (LINE - touch.rho) for touch in touches]
    assert np.abs(np.sqrt(involutes / exact) - 1).max() > 0.005  # that of the involutes is wrong


def test_flanks_without_deviations_have_the_curvatures_of_involutes(kernel: Kernel):
    second_order, curvature, _ = of_kernel(gearbox_of(kernel, NONE), POSITIONS)
    assert not second_order.any()
    np.testing.assert_allclose(curvature, 1 / POSITIONS + 1 / (LINE - POSITIONS), rtol=1e-15)


def test_a_flank_too_hollow_for_a_hertzian_contact_has_no_pressure(kernel: Kernel):
    """Linear relief whose slope rotates with the arc: hollow next to the base circle."""
    flank = Profile(0, tip=(2.9e-4, START[0] + 1e-4))
    second_order, curvature, _ = of_kernel(gearbox_of(kernel, (flank, NONE[1])), POSITIONS)
    hollow = np.isnan(curvature)
    assert hollow.any()
    assert (curvature[~hollow] > 0).all()
    assert np.isfinite(second_order).all()


def test_one_warning_names_the_second_order_of_the_gap_and_its_place(kernel: Kernel):
    gearbox = gearbox_of(kernel, CASES["linear, 40 um"])
    (warning,) = [w for w in gearbox.warnings() if "first order" in str(w)]
    second_order, _, _ = of_kernel(gearbox, np.linspace(START[0], TIP[0], 201))
    given = float(str(warning).split("up to ")[1].split(" m too wide")[0])
    assert given == pytest.approx(second_order.max(), rel=1e-5)  # six digits
    # 0.1 um of relief: its second order is far below 2 % of the penetration
    small = gearbox_of(kernel, (Profile(0, tip=(1e-7, BORDER)), NONE[1]))
    assert not [w for w in small.warnings() if "first order" in str(w)]


# Gap of second order: for meshes with corner contact

ROOT_BORDER = START[0] + 2e-3  # of root relief on the driving flank [m]
ONE_SLOPES = {
    **{name: CASES[name] for name in ("linear", "parabolic", "driven tip", "root")},
    "linear root": (Profile(0, root=(5e-6, ROOT_BORDER)), NONE[1]),
    "corner on a crown": (Profile(0, tip=(20e-6, BORDER), crowning=5e-6), NONE[1]),
}
MATE_BORDER = LINE - BORDER + 5e-4  # of root relief on the driven flank [m]
TWO_SLOPES = {
    "crowned": CASES["crowned"],
    "tip on a crown": (Profile(0, tip=(20e-6, BORDER)), Profile(1, crowning=10e-6)),
    "tip on a root": (
        Profile(0, tip=(20e-6, BORDER)),
        Profile(1, root=(10e-6, MATE_BORDER), power=2),
    ),
    "corner on a linear root": (
        Profile(0, tip=(20e-6, BORDER)),
        Profile(1, root=(10e-6, MATE_BORDER)),
    ),
    "crowns with corners": (
        Profile(0, tip=(20e-6, BORDER), crowning=5e-6),
        Profile(1, tip=(15e-6, TIP[1] - 3e-3), crowning=8e-6),
    ),
}
BESIDE = np.array([-3e-4, -1e-4, 1e-4, 2e-4, 3e-4, 6e-4])  # from a corner [m]


def found_touches(flanks: tuple[Profile, Profile], positions: Floats) -> list[Touch]:
    """Contacts within the reach of the reference."""
    found = []
    for rho in positions:
        try:
            found.append(touching(flanks, rho))
        except (AssertionError, ValueError):
            continue
    return found


def lacking(flanks: tuple[Profile, Profile], touches: list[Touch]) -> tuple[Floats, Floats]:
    """Deviations of the flanks on the line of action, and the reduction of the actual gap."""
    first = [flanks[0].deviation(t.rho) + flanks[1].deviation(LINE - t.rho) for t in touches]
    return np.array(first), np.array([t.second_order for t in touches])


@pytest.mark.parametrize("name", ONE_SLOPES)
def test_gap_of_edge_contact_is_that_of_real_curves_on_flanks_and_corners(
    kernel: Kernel, name: str
):
    flanks = ONE_SLOPES[name]
    corners = [BORDER + BESIDE, ROOT_BORDER - BESIDE]
    touches = found_touches(flanks, np.concatenate([POSITIONS, *corners]))
    assert len(touches) >= 15
    first, second = lacking(flanks, touches)
    gearbox = gearbox_of(kernel, flanks, edge_contact="true")
    _, _, gap = of_kernel(gearbox, np.array([touch.rho for touch in touches]))
    assert second.max() > 1e-7  # excess of the gap of first order [m]
    # the remainder is of third order: 10 to 20 times less, and more near the root's base circle
    slack = 0.25 if "root" in name else 0.07
    assert (np.abs(gap - (first - second)) <= slack * second + 2e-9).all()


@pytest.mark.parametrize("name", TWO_SLOPES)
def test_gap_knows_that_both_flanks_are_turned(kernel: Kernel, name: str):
    """The remainder is of third order, and at corners near the mate's slope."""
    flanks = TWO_SLOPES[name]
    corners = np.array([BORDER, LINE - TIP[1] + 3e-3])
    beside = np.concatenate([POSITIONS, *(corner + BESIDE for corner in corners)])
    touches = found_touches(flanks, beside)
    assert len(touches) >= 15
    first, second = lacking(flanks, touches)
    rho = np.array([touch.rho for touch in touches])
    too_wide, _, gap = of_kernel(gearbox_of(kernel, flanks, edge_contact="true"), rho)
    near = (np.abs(rho[:, np.newaxis] - corners) < 2.9e-4).any(axis=1)
    left = gap - (first - second)
    assert second.max() > 5e-7
    assert (np.abs(left) <= np.where(near, 0.4, 0.08) * second + 2e-9).all()
    np.testing.assert_allclose(too_wide, np.maximum(left, 0), rtol=0.05, atol=3e-9)


@pytest.mark.parametrize("name", [*ONE_SLOPES, *TWO_SLOPES])
def test_gap_and_its_slope_go_on_at_corners(kernel: Kernel, name: str):
    """Over the whole path, in steps of 0.1 um: a jump of the slope would be visible."""
    flanks = (ONE_SLOPES | TWO_SLOPES)[name]
    gearbox = gearbox_of(kernel, flanks, edge_contact="true")
    step = 1e-7
    for border in (BORDER, ROOT_BORDER, LINE - TIP[1] + 3e-3):
        _, _, gap = of_kernel(gearbox, border + step * np.arange(-6000, 6000))
        slope = np.diff(gap) / step
        # e'' is at most that of a corner, 1/q, 100 to 300 1/m here; rounding of the gap, 1e-20 m
        assert np.abs(np.diff(slope)).max() < 400 * step
