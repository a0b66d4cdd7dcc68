"""Geometry of a pair: the paper's numbers, mpmath, and what the points have to satisfy."""

from __future__ import annotations

import mpmath as mp
import numpy as np
import pytest

from kernel.kernel import INVALID_INPUT, Kernel, KernelError, SpurPair

PAPER = (20, 30, 0.2)
LAYOUTS = [
    {},
    {"sigma": -1},
    {"chi": 0.8, "centre_a": (0.3, -0.1)},
    {"chi": -2.6, "sigma": -1, "centre_a": (-1.0, 2.0)},
    {"chi": np.pi, "sigma": 1},
]
PAIRS = [(*PAPER, None), (23, 41, 0.115, None), (40, 17, 0.3, np.radians(20)), (3, 3, 0.01, None)]


def every_pair(kernel: Kernel) -> list[SpurPair]:
    return [
        kernel.spur_pair(*pair, sigma=layout.get("sigma", 1), **_location(layout))
        for pair in PAIRS
        for layout in LAYOUTS
    ]


def _location(layout: dict) -> dict:
    return {key: value for key, value in layout.items() if key != "sigma"}


def sigma_of(pair: SpurPair) -> int:
    """Read sigma off the points: the side of the centre line on which K_A lies."""
    line = np.subtract(pair.centre_b, pair.centre_a)
    to_k = np.subtract(pair.point_k_a, pair.centre_a)
    return int(np.sign(line[0] * to_k[1] - line[1] * to_k[0]))


def size(pair: SpurPair) -> float:
    """Return the largest coordinate there is, whose rounding all points share."""
    return float(np.abs(pair.centre_a).max() + np.abs(pair.centre_b).max()) + pair.centre_distance


def distance(p: object, q: object) -> float:
    return float(np.hypot(*np.subtract(p, q)))


def test_the_papers_pair_has_the_numbers_of_the_theory(kernel: Kernel):
    """Each to the digits printed there."""
    pair = kernel.spur_pair(*PAPER)
    assert np.degrees(pair.alpha_w) == pytest.approx(7.52058, abs=5e-6)
    assert pair.rho == pytest.approx(0.065441, abs=5e-7)
    assert pair.base_pitch == pytest.approx(0.062291, abs=5e-7)
    assert pair.tip_radius_a == pytest.approx(0.208312, abs=5e-7)
    assert pair.tip_radius_b == pytest.approx(0.304199, abs=5e-7)
    assert 1 / pair.base_radius_a == pytest.approx(5.0434, abs=5e-5)
    assert pair.centre_distance == pytest.approx(0.5, rel=1e-15)
    assert pair.contains_pitch_point


@pytest.mark.parametrize("given", PAIRS)
def test_lengths_are_those_of_the_formulas_in_40_digits(kernel: Kernel, given: tuple):
    teeth_a, teeth_b, r_a, alpha_w = given
    pair = kernel.spur_pair(*given)
    with mp.workdps(40):
        n, r_a = mp.mpf(teeth_b) / teeth_a, mp.mpf(r_a)
        alpha_inf = mp.atan(2 * mp.pi / (teeth_a * (1 + n)))
        alpha = mp.mpf(alpha_w) if alpha_w else mp.mpf("1.05") * alpha_inf
        r_b = n * r_a
        rb_a, rb_b = r_a * mp.cos(alpha), r_b * mp.cos(alpha)
        rho = mp.sqrt((r_a + r_b) ** 2 - (rb_a + rb_b) ** 2)
        pitch = rb_b * 2 * mp.pi / teeth_b
        exact = {
            "ratio": n,
            "pitch_radius_a": r_a,
            "pitch_radius_b": r_b,
            "centre_distance": r_a + r_b,
            "gamma_a": 2 * mp.pi / teeth_a,
            "alpha_inf": alpha_inf,
            "alpha_w": alpha,
            "base_radius_a": rb_a,
            "base_radius_b": rb_b,
            "base_radius_sum": rb_a + rb_b,
            "rho": rho,
            "base_pitch": pitch,
            "rho_start_a": (rho - pitch) / 2,
            "rho_start_b": (rho + pitch) / 2,
            "tip_radius_a": mp.sqrt(rb_a**2 + ((rho + pitch) / 2) ** 2),
            "tip_radius_b": mp.sqrt(rb_b**2 + ((rho + pitch) / 2) ** 2),
        }
        for name, value in exact.items():
            # rho - |ab| cancels to a twentieth by the paper's rule
            tolerance = 4e-14 if name == "rho_start_a" else 2e-15
            assert getattr(pair, name) == pytest.approx(float(value), rel=tolerance), name


def test_line_of_action_touches_both_base_circles(kernel: Kernel):
    for pair in every_pair(kernel):
        scale = size(pair)
        t, e = np.array(pair.t), np.array(pair.e)
        assert np.hypot(*t) == pytest.approx(1, rel=1e-15)
        assert np.hypot(*e) == pytest.approx(1, rel=1e-15)
        assert abs(t @ e) < 1e-15
        k_a, k_b = np.array(pair.point_k_a), np.array(pair.point_k_b)
        assert distance(k_a, pair.centre_a) == pytest.approx(
            pair.base_radius_a, abs=2e-15 * size(pair)
        )
        assert distance(k_b, pair.centre_b) == pytest.approx(
            pair.base_radius_b, abs=2e-15 * size(pair)
        )
        np.testing.assert_allclose(k_b - k_a, pair.rho * e, rtol=0, atol=2e-15 * scale)
        assert abs((k_a - pair.centre_a) @ e) < 2e-15 * scale
        assert abs((k_b - pair.centre_b) @ e) < 2e-15 * scale


def test_path_of_contact_is_one_base_pitch_between_the_tip_circles(kernel: Kernel):
    for pair in every_pair(kernel):
        a, b = np.array(pair.point_a), np.array(pair.point_b)
        e = np.array(pair.e)
        np.testing.assert_allclose(b - a, pair.base_pitch * e, atol=2e-15 * size(pair))
        assert distance(b, pair.centre_a) == pytest.approx(
            pair.tip_radius_a, abs=2e-15 * size(pair)
        )
        assert distance(a, pair.centre_b) == pytest.approx(
            pair.tip_radius_b, abs=2e-15 * size(pair)
        )
        middle = (np.add(pair.point_k_a, pair.point_k_b)) / 2
        np.testing.assert_allclose((a + b) / 2, middle, atol=2e-15 * size(pair))


def test_pitch_point_lies_on_both_pitch_circles_and_on_the_line_of_action(kernel: Kernel):
    for pair in every_pair(kernel):
        point = np.array(pair.pitch_point)
        assert distance(point, pair.centre_a) == pytest.approx(
            pair.pitch_radius_a, abs=2e-15 * size(pair)
        )
        assert distance(point, pair.centre_b) == pytest.approx(
            pair.pitch_radius_b, abs=2e-15 * size(pair)
        )
        assert abs((point - pair.point_k_a) @ pair.t) < 2e-15 * size(pair)
        along = (point - pair.point_a) @ pair.e
        assert pair.contains_pitch_point == (0 <= along <= pair.base_pitch)


def test_path_of_contact_may_miss_the_pitch_point_and_then_says_so(kernel: Kernel):
    """A small pinion at a large pressure angle: the pitch point lies before a."""
    assert not kernel.spur_pair(20, 60, 0.1, np.radians(20)).contains_pitch_point
    assert kernel.spur_pair(20, 20, 0.1, np.radians(20)).contains_pitch_point


def test_flanks_touch_at_a_with_opposite_normals_at_the_start(kernel: Kernel):
    for given in PAIRS:
        for layout in LAYOUTS:
            sigma = layout.get("sigma", 1)
            pair = kernel.spur_pair(*given, sigma=sigma, **_location(layout))
            a = np.array(pair.point_a)
            flank_a, flank_b = (
                kernel.involute_flank_housing(a, centre, angle, radius, sigma)
                for centre, angle, radius in (
                    (pair.centre_a, pair.phi_a, pair.base_radius_a),
                    (pair.centre_b, pair.phi_b, pair.base_radius_b),
                )
            )
            # coordinates of size 2 m round to 2e-16 m, beside base radii from 0.007 m on; near the
            # base circle of A (rho_start_a = r_bA/100) the angle is hardly affected
            size = 1 + np.abs(a).max()
            for flank, radius in ((flank_a, pair.base_radius_a), (flank_b, pair.base_radius_b)):
                assert abs(flank.value[0]) * radius < 1e-15 * size + 4e-15 * radius
            normal_a = flank_a.gradient[0] * pair.base_radius_a
            normal_b = flank_b.gradient[0] * pair.base_radius_b
            # the normal turns with the square root of the distance from the base circle
            np.testing.assert_allclose(normal_a, pair.e, atol=1e-12 * size)
            np.testing.assert_allclose(normal_b, np.negative(pair.e), atol=1e-12 * size)


def test_driving_wheel_pushes_along_the_line_of_action(kernel: Kernel):
    """sigma = +1: A clockwise; its base circle moves at K_A towards K_B. sigma = -1: the mirror."""
    for layout in LAYOUTS:
        sigma = layout.get("sigma", 1)
        pair = kernel.spur_pair(*PAPER, sigma=sigma, **_location(layout))
        assert sigma_of(pair) == sigma
        arm = np.subtract(pair.point_k_a, pair.centre_a)
        velocity = -sigma * np.array([-arm[1], arm[0]])  # omega = -sigma
        assert velocity @ np.array(pair.e) == pytest.approx(
            pair.base_radius_a, abs=2e-15 * size(pair)
        )


def test_mirrored_pair_is_the_mirror_image(kernel: Kernel):
    plus, minus = kernel.spur_pair(*PAPER), kernel.spur_pair(*PAPER, sigma=-1)
    for name in ("t", "e", "point_k_a", "point_k_b", "point_a", "point_b", "pitch_point"):
        np.testing.assert_allclose(
            getattr(minus, name), np.array(getattr(plus, name)) * [1, -1], atol=1e-16
        )
    assert minus.phi_a == -plus.phi_a
    assert minus.phi_b == -plus.phi_b


def test_rotated_pair_is_the_pair_rotated(kernel: Kernel):
    chi, centre = 2.2, np.array([0.4, 0.7])
    pair, rotated = kernel.spur_pair(*PAPER), kernel.spur_pair(*PAPER, chi=chi, centre_a=centre)
    rotation = np.array([[np.cos(chi), -np.sin(chi)], [np.sin(chi), np.cos(chi)]])
    for name in ("centre_a", "centre_b", "point_k_a", "point_k_b", "point_a", "point_b"):
        expected = centre + rotation @ np.array(getattr(pair, name))
        np.testing.assert_allclose(getattr(rotated, name), expected, atol=1e-15)
    for name in ("t", "e"):
        expected = rotation @ np.array(getattr(pair, name))
        np.testing.assert_allclose(getattr(rotated, name), expected, atol=1e-15)
    assert rotated.phi_a - pair.phi_a == pytest.approx(chi, rel=1e-15)
    assert rotated.phi_b - pair.phi_b == pytest.approx(chi, rel=1e-15)


@pytest.mark.parametrize("degrees", [-20.0, 0.1, 7.1625, 90.0, 120.0, np.nan, np.inf])
def test_pressure_angles_out_of_range_are_refused_with_both_angles(kernel: Kernel, degrees: float):
    """alpha_inf of the paper's pair is 7.16246 degrees."""
    accepted = 7.1625
    if degrees == accepted:
        kernel.spur_pair(*PAPER, np.radians(degrees))
        degrees = 7.1624
    with pytest.raises(KernelError) as error:
        kernel.spur_pair(*PAPER, np.radians(degrees))
    assert (error.value.code, error.value.field) == (INVALID_INPUT, "pressure_angle")
    assert "alpha_inf = 7.16246 deg" in error.value.message
    if np.isfinite(degrees):
        assert f"alpha_w = {degrees:.4g}" in error.value.message
