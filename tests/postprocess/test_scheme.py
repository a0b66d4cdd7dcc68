"""The mesh scheme is geometry: its points and flanks obey what defines them."""

from __future__ import annotations

import numpy as np
import pytest
import xarray as xr

from evolvent.figures.scheme import figure_mesh_scheme
from evolvent.physics.teeth import drawn_meshes


def _turned(history: xr.Dataset, angle: float, flank: int) -> xr.Dataset:
    """The same mesh with its centre line turned, on either flank."""
    turned = history.copy(deep=True)
    distance = history["centre"].values[1, 0]
    turned["centre"][1] = [distance * np.cos(angle), distance * np.sin(angle)]
    turned["centre_line_angle"][:] = angle
    turned["flank"][:] = flank
    return turned


@pytest.fixture(
    params=[(0.0, 1), (0.0, -1), (2.0, 1), (-1.0, -1)],
    ids=["paper", "mirrored", "turned", "turned-mirrored"],
)
def geometry(request, smooth_run):
    return drawn_meshes(_turned(smooth_run.history, *request.param))[0]


def test_line_of_action_touches_both_base_circles(geometry):
    points = geometry.points
    line = points["K_B"] - points["K_A"]
    for wheel, key in enumerate(("K_A", "K_B")):
        radius = points[key] - geometry.centres[wheel]
        assert abs(radius) == pytest.approx(geometry.base_radii[wheel], rel=1e-12)
        # Perpendicular, to the rounding of lengths of 0.3 m.
        assert (radius * line.conjugate()).real == pytest.approx(0.0, abs=1e-15)


def test_pitch_point_lies_on_the_line_of_action_and_both_pitch_circles(geometry):
    points = geometry.points
    line, to_pitch_point = points["K_B"] - points["K_A"], points["P"] - points["K_A"]
    assert (to_pitch_point * line.conjugate()).imag == pytest.approx(0.0, abs=1e-15)
    for centre, radius in zip(geometry.centres, geometry.pitch_radii, strict=True):
        assert abs(points["P"] - centre) == pytest.approx(radius, rel=1e-12)


def test_path_of_contact_ends_on_the_tip_circles(geometry):
    points = geometry.points
    assert abs(points["b"] - geometry.centres[0]) == pytest.approx(geometry.tip_radii[0], rel=1e-12)
    assert abs(points["a"] - geometry.centres[1]) == pytest.approx(geometry.tip_radii[1], rel=1e-12)


@pytest.mark.parametrize("wheel", [0, 1])
def test_flank_is_an_involute_of_its_base_circle(geometry, wheel):
    """Polar angle against radius: sqrt(R^2 - r_b^2)/r_b - acos(r_b/R), up to a constant, (4)."""
    local = geometry.flank(wheel, contact=0.02) - geometry.centres[wheel]
    base, radius = geometry.base_radii[wheel], np.abs(local)
    assert radius[0] == pytest.approx(base, rel=1e-12)
    assert radius[-1] == pytest.approx(geometry.tip_radii[wheel], rel=1e-12)
    root = np.sqrt(np.maximum(radius**2 - base**2, 0.0))
    involute = root / base - np.arccos(np.minimum(base / radius, 1.0))
    polar = np.unwrap(np.angle(local))
    # acos near 1 keeps half of the digits.
    np.testing.assert_allclose(geometry.sigma * (polar - polar[0]), involute, rtol=0, atol=1e-8)


def test_flanks_touch_on_the_line_of_action(geometry):
    start, along, _ = geometry.line()
    contact = geometry.path[0] + 0.3 * (geometry.path[1] - geometry.path[0])
    point = start + contact * along
    one, two = (geometry.flank(wheel, contact, n=20001) for wheel in (0, 1))
    for flank in (one, two):
        nearest = int(np.argmin(np.abs(flank - point)))
        assert abs(flank[nearest] - point) < 1e-5  # half of the spacing of the points
        tangent = flank[nearest + 1] - flank[nearest - 1]
        aligned = (tangent * along.conjugate()).real / abs(tangent)
        assert abs(aligned) < 1e-3  # the normal is the line of action


def test_flanks_do_not_cut_each_other(geometry):
    """Each flank stays on its side of the common tangent: apart from the contact, on both sides."""
    start, along, _ = geometry.line()
    contact = geometry.path[0] + 0.3 * (geometry.path[1] - geometry.path[0])
    point = start + contact * along
    for wheel, side in ((0, -1), (1, 1)):
        beyond = ((geometry.flank(wheel, contact) - point) * along.conjugate()).real
        assert (side * beyond >= -1e-15).all()


def test_scheme_names_the_wheels_and_the_points(smooth_run):
    figure = figure_mesh_scheme(smooth_run.history)
    whole, zone = figure.axes
    assert {"pinion", "gear"} <= {text.get_text() for text in whole.texts}
    assert [text.get_text() for text in zone.texts] == [
        "$K_A$",
        "$K_B$",
        "$a$",
        "$b$",
        "pitch point",
    ]
    for axis in (whole, zone):
        assert axis.get_aspect() == 1.0
        assert axis.get_xlabel() == "x [m]"
