"""The flank as an implicit curve, against mpmath and against what makes it an involute."""

from __future__ import annotations

import mpmath as mp
import numpy as np
import pytest

from kernel.kernel import OK, OUT_OF_DOMAIN, Kernel

BASE_RADII = (0.19827958, 0.03, 2.5)
HANDS = (1, -1)


def outside(base_radius: float, n: int = 200, largest: float = 1.6, seed: int = 1) -> np.ndarray:
    """Return points between the base circle and `largest` base radii, some very near the circle."""
    random = np.random.default_rng(seed)
    radius = base_radius * (1 + (largest - 1) * random.random(n) ** 4 + 1e-6)
    theta = random.uniform(-3, 3, n)  # f jumps where theta passes pi
    return np.stack([radius * np.cos(theta), radius * np.sin(theta)], axis=1)


def exact_f(x: mp.mpf, y: mp.mpf, base_radius: float, hand: int) -> mp.mpf:
    """Evaluate the definition (4) itself."""
    radius = mp.sqrt(x**2 + y**2)
    rb = mp.mpf(base_radius)
    return mp.sqrt(radius**2 - rb**2) / rb - mp.acos(rb / radius) - hand * mp.atan2(y, x)


@pytest.mark.parametrize("base_radius", BASE_RADII)
@pytest.mark.parametrize("hand", HANDS)
@pytest.mark.parametrize("form", ["short", "polar"])
def test_value_gradient_and_hessian_are_those_of_the_definition(
    kernel: Kernel, base_radius: float, hand: int, form: str
):
    points = outside(base_radius, 12)
    # rounding of R - r_b near the base circle enters s = sqrt(R**2 - r_b**2) and the polar form's
    # acos by 1/sqrt(nearest), and 1/s in the Hessian by 1/nearest
    nearest = (np.hypot(*points.T) / base_radius - 1).min()
    value_tolerance = 4e-15 if form == "short" else 1e-15 / np.sqrt(nearest)
    flank = kernel.involute_flank(points, base_radius, hand, form)
    assert not flank.code.any()
    with mp.workdps(40):
        for i, (x, y) in enumerate(points):

            def f(u: mp.mpf, v: mp.mpf) -> mp.mpf:
                return exact_f(u, v, base_radius, hand)

            at = (mp.mpf(x), mp.mpf(y))
            assert abs(flank.value[i] - float(f(*at))) < value_tolerance
            gradient = [float(mp.diff(f, at, n)) for n in ((1, 0), (0, 1))]
            np.testing.assert_allclose(
                flank.gradient[i], gradient, rtol=0, atol=1e-15 / np.sqrt(nearest) / base_radius
            )
            fxx, fxy, fyy = (float(mp.diff(f, at, n)) for n in ((2, 0), (1, 1), (0, 2)))
            scale = np.abs([fxx, fxy, fyy]).max()
            np.testing.assert_allclose(
                flank.hessian[i], [[fxx, fxy], [fxy, fyy]], rtol=0, atol=2e-15 / nearest * scale
            )


@pytest.mark.parametrize("hand", HANDS)
def test_the_two_forms_are_equal_on_a_tooth(kernel: Kernel, hand: int):
    """To 4e-14, from 1 % of the base radius outward; nearer the difference R - r_b cancels."""
    rb = BASE_RADII[0]
    points = outside(rb, 500)
    points = points[np.hypot(*points.T) > 1.01 * rb]
    short = kernel.involute_flank(points, rb, hand)
    polar = kernel.involute_flank(points, rb, hand, "polar")
    np.testing.assert_allclose(short.value, polar.value, rtol=0, atol=4e-14)
    np.testing.assert_allclose(short.gradient, polar.gradient, rtol=0, atol=4e-14 / rb)
    scale = np.abs(short.hessian).max(axis=(1, 2), keepdims=True)
    np.testing.assert_allclose(short.hessian / scale, polar.hessian / scale, rtol=0, atol=4e-14)


@pytest.mark.parametrize("base_radius", BASE_RADII)
@pytest.mark.parametrize("hand", HANDS)
def test_gradient_has_length_1_over_base_radius_everywhere(
    kernel: Kernel, base_radius: float, hand: int
):
    flank = kernel.involute_flank(outside(base_radius, largest=50), base_radius, hand)
    np.testing.assert_allclose(np.hypot(*flank.gradient.T) * base_radius, 1, rtol=4e-16 * 4)


@pytest.mark.parametrize("base_radius", BASE_RADII)
@pytest.mark.parametrize("hand", HANDS)
def test_points_by_roll_angle_lie_on_the_flank(kernel: Kernel, base_radius: float, hand: int):
    xi = np.linspace(1e-3, 2.0, 100)
    points = kernel.involute_points(xi, base_radius, hand)
    flank = kernel.involute_flank(points, base_radius, hand)
    assert not flank.code.any()
    # near the root d f/dR = xi/r_b is small; rounding of the coordinates is all there is
    assert np.abs(flank.value).max() < 4e-15
    # radius of curvature r_b xi; rounding of R - r_b = r_b xi**2/2 enters
    radius_of_curvature = 1 / np.trace(flank.hessian, axis1=1, axis2=2) / base_radius
    np.testing.assert_allclose(radius_of_curvature / (base_radius * xi), 1, atol=1e-9)
    far = xi > 0.1
    np.testing.assert_allclose(radius_of_curvature[far] / (base_radius * xi[far]), 1, atol=1e-13)


@pytest.mark.parametrize("hand", HANDS)
def test_the_root_of_the_involute_is_on_the_x_axis(kernel: Kernel, hand: int):
    rb = BASE_RADII[0]
    np.testing.assert_array_equal(kernel.involute_points(0.0, rb, hand), [[rb, 0.0]])


@pytest.mark.parametrize("hand", HANDS)
@pytest.mark.parametrize("distance", [-0.004, 1e-6, 0.01])
def test_f_times_base_radius_is_the_signed_distance(kernel: Kernel, hand: int, distance: float):
    rb = BASE_RADII[0]
    feet = kernel.involute_points(np.linspace(0.2, 1.0, 30), rb, hand)
    normals = kernel.involute_flank(feet, rb, hand).gradient * rb
    flank = kernel.involute_flank(feet + distance * normals, rb, hand)
    np.testing.assert_allclose(flank.value * rb, distance, rtol=0, atol=2e-15)
    np.testing.assert_allclose(flank.gradient * rb, normals, rtol=0, atol=1e-14)


@pytest.mark.parametrize("hand", HANDS)
def test_gradient_points_out_of_the_tooth(kernel: Kernel, hand: int):
    """The tooth of the counterclockwise involute lies at larger polar angles, where f < 0."""
    rb = BASE_RADII[0]
    on = kernel.involute_points(np.linspace(0.2, 1.0, 10), rb, hand)
    turn = 0.05 * hand
    rotation = np.array([[np.cos(turn), -np.sin(turn)], [np.sin(turn), np.cos(turn)]])
    inside = on @ rotation.T
    assert (kernel.involute_flank(inside, rb, hand).value < 0).all()
    gradient = kernel.involute_flank(on, rb, hand).gradient
    assert (np.sum(gradient * (inside - on), axis=1) < 0).all()


@pytest.mark.parametrize("form", ["short", "polar"])
def test_hands_are_mirror_images(kernel: Kernel, form: str):
    rb = BASE_RADII[0]
    points = outside(rb)
    mirror = np.array([1.0, -1.0])
    plus = kernel.involute_flank(points, rb, 1, form)
    minus = kernel.involute_flank(points * mirror, rb, -1, form)
    np.testing.assert_array_equal(minus.value, plus.value)
    np.testing.assert_array_equal(minus.gradient, plus.gradient * mirror)
    np.testing.assert_array_equal(minus.hessian, plus.hessian * np.outer(mirror, mirror))


@pytest.mark.parametrize("hand", HANDS)
@pytest.mark.parametrize("angle", [0.0, 0.7, -2.9, 40.0])
def test_housing_frame_is_the_wheels_frame_moved(kernel: Kernel, hand: int, angle: float):
    rb = BASE_RADII[0]
    centre = np.array([0.5, -0.2])
    points = outside(rb)
    points = points[np.hypot(*points.T) > 1.001 * rb]
    rotation = np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])
    own = kernel.involute_flank(points, rb, hand)
    housing = kernel.involute_flank_housing(centre + points @ rotation.T, centre, angle, rb, hand)
    assert list(housing.code) == [OK] * len(points)
    # rounding of the coordinates, amplified by 1/sqrt(1e-3) and 1/1e-3 near the base circle
    np.testing.assert_allclose(housing.value, own.value, rtol=0, atol=2e-14)
    gradient = own.gradient @ rotation.T
    np.testing.assert_allclose(housing.gradient * rb, gradient * rb, rtol=0, atol=1e-12)
    hessian = rotation @ own.hessian @ rotation.T
    scale = np.abs(hessian).max(axis=(1, 2), keepdims=True)
    np.testing.assert_allclose(housing.hessian / scale, hessian / scale, rtol=0, atol=2e-12)


@pytest.mark.parametrize("form", ["short", "polar"])
@pytest.mark.parametrize("factor", [0.0, 0.5, 1.0, np.nan])
def test_points_not_outside_the_base_circle_are_out_of_domain(
    kernel: Kernel, form: str, factor: float
):
    rb = BASE_RADII[0]
    flank = kernel.involute_flank([[factor * rb, 0.0], [1.1 * rb, 0.0]], rb, 1, form)
    assert list(flank.code) == [OUT_OF_DOMAIN, OK]
    assert flank.value[0] == 0
    assert not np.any(flank.gradient[0])
    assert not np.any(flank.hessian[0])
