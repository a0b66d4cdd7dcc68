"""Base tangent length, dimension over balls, flank tolerances: printed values, drawn involutes."""

from __future__ import annotations

import ctypes
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.optimize import brentq, minimize_scalar

from kernel.gears import GearGeometry, gear
from kernel.kernel import Kernel

Floats = NDArray[np.float64]
VALID, BELOW, ABOVE, IN_SPACE, IN_ROOT = range(5)

# teeth, module [mm], x, teeth k, W_k [mm], decimals printed
SPANS = [
    (24, 3.0, 0.4, 4, 32.82662725, 8),
    (51, 1.0, 0.2032, 6, 17.09, 2),
    (52, 1.0, 0.3143, 6, 17.18, 2),
]
# teeth, module [mm], x, ball diameter [mm], M_dK [mm], decimals
BALLS = [
    (51, 1.0, 0.2032, 1.75, 53.846, 3),
    (52, 1.0, 0.3143, 1.75, 55.064, 3),
    (20, 3.0, 0.0, 5.0, 66.53522592, 8),
    (25, 2.0, 0.3, 3.5, 55.81596752, 8),
]


def measure(kernel: Kernel, call: str, geometry: GearGeometry, by: float) -> tuple[float, int]:
    """Value of a measure and its validity."""
    value = ctypes.c_double()
    validity = getattr(kernel.library, call)(geometry, by, ctypes.byref(value))
    return value.value, validity


def span(kernel: Kernel, geometry: GearGeometry, k: int) -> tuple[float, int]:
    """Base tangent length over k teeth."""
    return measure(kernel, "test_span_measure", geometry, k)


def over_balls(kernel: Kernel, geometry: GearGeometry, diameter: float) -> tuple[float, int]:
    """Dimension over balls."""
    return measure(kernel, "test_ball_measure", geometry, diameter)


class Drawn:
    """Flanks of a gear as curves, from its thickness on the reference circle alone."""

    def __init__(self, geometry: GearGeometry) -> None:
        self.teeth = geometry.teeth
        r, self.base = geometry.reference_radius, geometry.base_radius
        involute = np.tan(np.arccos(self.base / r)) - np.arccos(self.base / r)
        self.half_tooth = geometry.thickness / (2 * r) + involute
        self.ends = [
            np.sqrt((at / self.base) ** 2 - 1)
            for at in (geometry.form_radius, geometry.tip_form_radius)
        ]

    def flank(self, tooth: float, side: int, roll: float) -> Floats:
        """Point of a flank, +1 on the counterclockwise side of its tooth; tooth 0 on the x axis."""
        radius = self.base * np.sqrt(1 + roll**2)
        angle = self.half_tooth - (roll - np.arctan(roll))
        angle = tooth * 2 * np.pi / self.teeth + side * angle
        point: Floats = radius * np.array([np.cos(angle), np.sin(angle)])
        return point

    def between_planes(self, k: int) -> float:
        """Distance of parallel planes that touch the outer flanks of k teeth: y = constant.

        The x axis is the middle of the k teeth.
        """
        last = (k - 1) / 2 - self.teeth / 4  # turned so that the planes' normal is the y axis
        turn = self.teeth / 4

        def height(roll: float) -> float:
            return -float(self.flank(last + turn, 1, roll)[1])

        found = minimize_scalar(
            height, bounds=self.ends, method="bounded", options={"xatol": 1e-12}
        )
        return 2 * -float(found.fun)

    def over_balls(self, diameter: float) -> float:
        """Distance over two balls in the spaces that are most nearly opposite."""

        def gap(radius: float) -> float:
            centre = np.array([radius, 0.0])

            def distance(roll: float) -> float:
                return float(np.linalg.norm(self.flank(0.5, -1, roll) - centre))

            # the space between teeth -1/2 and 1/2 is on the x axis
            options = {"xatol": 1e-13}
            found = minimize_scalar(distance, bounds=(0, 2), method="bounded", options=options)
            return float(found.fun) - diameter / 2

        radius = brentq(gap, self.base, 2 * self.base, xtol=1e-16, rtol=1e-15)
        opposite = 2 * np.pi * (self.teeth // 2) / self.teeth
        ball = radius * np.array([np.cos(opposite), np.sin(opposite)])
        return float(np.linalg.norm(ball - np.array([radius, 0.0]))) + diameter


@pytest.mark.parametrize(("teeth", "module", "x", "k", "printed", "decimals"), SPANS)
def test_base_tangent_length_has_the_printed_digits(
    kernel: Kernel, teeth: int, module: float, x: float, k: int, printed: float, decimals: int
) -> None:
    value, validity = span(kernel, gear(kernel, teeth, module * 1e-3, profile_shift=x), k)
    assert validity == VALID
    assert round(value * 1e3, decimals) == pytest.approx(printed, abs=0.51 * 10**-decimals)
    assert abs(value * 1e3 - printed) <= 0.5 * 10**-decimals


@pytest.mark.parametrize(("teeth", "module", "x", "diameter", "printed", "decimals"), BALLS)
def test_dimension_over_balls_has_the_printed_digits(
    kernel: Kernel,
    teeth: int,
    module: float,
    x: float,
    diameter: float,
    printed: float,
    decimals: int,
) -> None:
    geometry = gear(kernel, teeth, module * 1e-3, profile_shift=x)
    value, validity = over_balls(kernel, geometry, diameter * 1e-3)
    assert validity == VALID
    assert abs(value * 1e3 - printed) <= 0.5 * 10**-decimals


@pytest.mark.parametrize("teeth", [17, 18, 31, 64, 101])
@pytest.mark.parametrize("x", [0.0, 0.35, -0.1])
def test_measures_are_those_of_drawn_involutes(kernel: Kernel, teeth: int, x: float) -> None:
    given: dict[str, Any] = {"profile_shift": x, "thickness_allowance": -5e-5}
    geometry = gear(kernel, teeth, 2.5e-3, **given)
    drawn = Drawn(geometry)
    k = kernel.library.test_span_teeth(geometry)
    value, validity = span(kernel, geometry, k)
    assert validity == VALID
    assert value == pytest.approx(drawn.between_planes(k), rel=1e-9)
    diameter = kernel.library.test_ball_diameter(geometry)
    value, validity = over_balls(kernel, geometry, diameter)
    assert validity == VALID
    assert value == pytest.approx(drawn.over_balls(diameter), rel=1e-9)


def test_default_measures_touch_near_the_circle_of_the_profile_shift(kernel: Kernel) -> None:
    for teeth in range(12, 120, 3):
        for x in (0.0, 0.3, 0.6):
            geometry = gear(kernel, teeth, 2e-3, profile_shift=x)
            wanted = geometry.reference_radius + x * 2e-3
            k = kernel.library.test_span_teeth(geometry)
            value, validity = span(kernel, geometry, k)
            assert validity == VALID or geometry.is_undercut
            if validity == VALID:
                step = geometry.base_pitch / 4 * 1.001
                rho = np.sqrt(wanted**2 - geometry.base_radius**2)
                assert abs(value / 2 - rho) <= step or geometry.form_radius > wanted
            diameter = kernel.library.test_ball_diameter(geometry)
            assert round(diameter / 1e-4) == pytest.approx(diameter / 1e-4, abs=1e-9)
            assert 1.3 * 2e-3 < diameter < 2.6 * 2e-3


def test_measures_off_the_involute_are_refused_with_their_reason(kernel: Kernel) -> None:
    geometry = gear(kernel, 24, 3e-3)
    assert [span(kernel, geometry, k)[1] for k in (1, 3, 5)] == [BELOW, VALID, ABOVE]
    assert np.isnan(span(kernel, geometry, 1)[0])
    touching = {over_balls(kernel, geometry, d * 1e-3)[1] for d in np.arange(3.0, 12.0, 0.05)}
    assert {VALID, BELOW, ABOVE} <= touching
    # a tip circle that stands far above the balls
    high = gear(kernel, 60, 3e-3, tip_alteration=0.6)
    assert over_balls(kernel, high, 3e-3 * 1.55)[1] in (IN_SPACE, BELOW)


def tolerances(kernel: Kernel, teeth: int, module: float, width: float, grade: int) -> Floats:
    """f_pT, F_pT, f_HaT, f_faT, F_aT, f_HbT, f_fbT, F_bT in um."""
    values = np.empty(8)
    kernel.library.test_flank_tolerances(teeth, module, width, grade, values)
    return values * 1e6


def test_tolerances_are_those_of_iso_1328_1(kernel: Kernel) -> None:
    """Values of a table, rounded as there."""
    found = tolerances(kernel, 40, 3e-3, 30e-3, 6)
    assert found == pytest.approx([9.0, 29, 7.5, 9.5, 12, 9.0, 10, 14], rel=1e-12)
    found = tolerances(kernel, 50, 2e-3, 20e-3, 5)
    assert found == pytest.approx([6.0, 19, 4.9, 6.0, 8.0, 6.0, 6.5, 9.0], rel=1e-12)


def test_tolerances_end_at_the_limits_of_the_standard(kernel: Kernel) -> None:
    assert np.isnan(tolerances(kernel, 40, 3e-3, 3.9e-3, 6)[5:]).all()
    assert np.isfinite(tolerances(kernel, 40, 3e-3, 3.9e-3, 6)[:5]).all()
    assert np.isnan(tolerances(kernel, 40, 0.4e-3, 30e-3, 6)).all()
