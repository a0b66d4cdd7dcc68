"""Drawn teeth against the closed form: thickness, touching flanks, no overlap, deviations."""

from __future__ import annotations

import math

import numpy as np
import pytest
import xarray as xr
from matplotlib.path import Path as Outline
from real_gears import ALPHA, RealPair, involute

from evolvent.pages.touching import touching
from evolvent.physics.teeth import drawn_meshes, drawn_wheels
from evolvent.physics.tooth_profile import Profile

ROLLED = np.linspace(0.0, 1.0, 14)  # more than three pitches
CHORD = 1e-6  # by how much a drawn chord may leave its involute [m]


def distance(point: complex, outline: np.ndarray) -> float:
    """Distance of a point from a closed outline."""
    along = np.roll(outline, -1) - outline
    along = np.where(along == 0, 1e-30, along)
    share = ((point - outline) * along.conjugate()).real / np.abs(along) ** 2
    return float(np.abs(outline + np.clip(share, 0.0, 1.0) * along - point).min())


def outlines(history: xr.Dataset, row: int, exaggeration: float = 1.0) -> list[np.ndarray]:
    turned, moved = history["angle"].values[row], history["centre_displacement"].values[row]
    return [
        wheel.outline(float(angle), complex(*shift), exaggeration)
        for wheel, angle, shift in zip(drawn_wheels(history), turned, moved, strict=True)
    ]


def overlap(one: np.ndarray, other: np.ndarray) -> float:
    """How deep the points of one outline lie in the other."""
    inside = Outline(np.stack([other.real, other.imag], axis=1)).contains_points(
        np.stack([one.real, one.imag], axis=1)
    )
    return max((distance(point, other) for point in one[inside]), default=0.0)


def test_crowning_takes_as_much_from_both_ends_of_the_active_profile_and_nothing_between():
    radii = {"base_radius": 0.09, "start_radius": 0.091, "active_radius": 0.093}
    profile = Profile(20, **radii, tip_radius=0.1, root_radius=0.08, tooth_angle=0.1, crowning=5e-6)
    begin, end = math.sqrt(0.093**2 - 0.09**2), math.sqrt(0.1**2 - 0.09**2)
    rho = np.array([begin, (3 * begin + end) / 4, (begin + end) / 2, end])
    taken = profile.deviation(rho)
    np.testing.assert_allclose(taken, [5e-6, 1.25e-6, 0, 5e-6], rtol=1e-12, atol=1e-20)


@pytest.mark.parametrize("coast", [False, True])
def test_the_touching_point_lies_on_both_outlines(coast):
    pair = RealPair(coast=coast)
    history = pair.history(ROLLED)
    (mesh,) = drawn_meshes(history)
    sign = -1 if coast else 1
    # K_A and e of theory.md by hand, for centres on the x axis
    start = pair.base[0] * np.exp(1j * sign * pair.alpha)
    along = math.sin(pair.alpha) - 1j * sign * math.cos(pair.alpha)
    touched = 0
    for row in range(ROLLED.size):
        driving, driven = outlines(history, row)
        for slot in range(6):
            if history["pair_normal_force"].values[row, 0, slot] <= 0:
                continue
            point = start + history["pair_position"].values[row, 0, slot] * along
            assert distance(point, driving) < CHORD
            assert distance(point - pair.penetration * along, driven) < CHORD
            touched += 1
        points = [touch.point for touch in touching(history, mesh, 0, row)]
        assert all(min(abs(start + r * along - p) for p in points) < 1e-15
                   for r in history["pair_position"].values[row, 0] if np.isfinite(r))  # fmt: skip
    assert touched > 1.4 * ROLLED.size  # contact ratio 1.59


@pytest.mark.parametrize("coast", [False, True])
def test_outlines_overlap_by_the_penetration_only(coast):
    pair = RealPair(coast=coast)
    history = pair.history(ROLLED)
    for row in range(ROLLED.size):
        one, two = outlines(history, row)
        assert overlap(one, two) < pair.penetration + CHORD
        assert overlap(two, one) < pair.penetration + CHORD


def test_wheels_without_known_teeth_touch_and_do_not_overlap():
    """Only the working flanks are known of the paper's kind: teeth and spaces are made even."""
    pair = RealPair()
    history = pair.history(ROLLED)
    for name in ("root_radius", "form_radius", "tooth_angle"):
        history[name][:] = 0.0
    history["backlash"][:] = 0.0
    history["has_coast_flanks"][:] = 0
    (mesh,) = drawn_meshes(history)
    assert not mesh.has_coast
    for row in range(ROLLED.size):
        one, two = outlines(history, row)
        assert max(overlap(one, two), overlap(two, one)) < pair.penetration + CHORD
        for touch in touching(history, mesh, 0, row):
            point = touch.point
            assert max(distance(point, one), distance(point, two)) < pair.penetration + CHORD
    for wheel in drawn_wheels(history):
        assert wheel.profile.root_radius < wheel.profile.active_radius


@pytest.mark.parametrize("wheel", [0, 1])
def test_a_drawn_tooth_is_as_thick_as_its_gear_and_reaches_from_root_to_tip(wheel):
    pair = RealPair()
    drawn = drawn_wheels(pair.history(ROLLED))[wheel]
    tooth = drawn.profile.tooth()
    radius, polar = np.abs(tooth), np.angle(tooth)
    reference = pair.module * pair.teeth[wheel] / 2
    flank = slice(int(np.argmin(radius)), int(np.argmax(radius)))
    half = -np.interp(reference, radius[flank], polar[flank])
    # s = pi m/2: half a pitch; interpolated between points 0.1 mm apart
    assert 2 * half * reference == pytest.approx(math.pi * pair.module / 2, abs=1e-6)
    assert radius.max() == pytest.approx(pair.tip[wheel], rel=1e-12)
    assert radius.min() == pytest.approx(reference - 1.25 * pair.module, rel=1e-12)
    tip_alpha = math.acos(pair.base[wheel] / pair.tip[wheel])
    land = pair.tooth_angle[wheel] / 2 - involute(tip_alpha)
    corner = int(np.argmax(radius > pair.tip[wheel] * (1 - 1e-12)))
    assert -polar[corner] == pytest.approx(land, abs=1e-9)
    half_pitch = math.pi / pair.teeth[wheel]
    assert polar[[0, -1]] == pytest.approx([-half_pitch, half_pitch])
    outline = drawn.outline(0.3)
    assert outline.size == pair.teeth[wheel] * tooth.size


@pytest.mark.parametrize("relief", [0.0, 20e-6])
def test_a_rounded_tip_goes_from_the_flank_to_the_tip_circle_without_a_corner(relief):
    pair = RealPair(relief=(relief, relief))
    history = pair.history(ROLLED)
    sharp = drawn_wheels(history)[1].profile
    history["tip_rounding"] = ("wheel", [0.0, 0.15 * pair.module])
    profile = drawn_wheels(history)[1].profile
    assert drawn_wheels(history)[0].profile.rounding == 0
    rounded, tooth = profile.tooth(), sharp.tooth()
    assert np.abs(rounded).max() == pytest.approx(np.abs(tooth).max(), abs=2 * relief + 1e-12)
    turns = np.diff(np.unwrap(np.angle(np.diff(rounded))))
    top = np.abs(rounded)[1:-1] > np.abs(profile.flank()[-1]) - 1e-9
    # the arc's six chords turn by about 70 degrees; a sharp corner by all of it
    assert np.abs(turns[top]).max() < np.radians(15)
    assert np.abs(np.diff(np.unwrap(np.angle(np.diff(tooth))))).max() > np.radians(50)
    assert profile.flank().size == sharp.flank().size
    assert abs(rounded[len(profile.tooth()) // 2]) < abs(tooth[len(tooth) // 2]) + 2 * relief


@pytest.mark.parametrize("exaggeration", [0.0, 1.0, 40.0])
def test_relief_moves_the_flank_along_its_normal(exaggeration):
    amount = 20e-6
    pair = RealPair(relief=(amount, 0.0))
    profile = drawn_wheels(pair.history(ROLLED))[0].profile
    moved = profile.flank(exaggeration) - profile.flank(0.0)
    rho = np.linspace(
        profile.rho(profile.start_radius), profile.rho(profile.tip_radius), moved.size
    )
    pitch_point = pair.base[0] * math.tan(ALPHA)
    expected = amount * np.clip((rho - pitch_point) / (rho[-1] - pitch_point), 0.0, None)
    np.testing.assert_allclose(np.abs(moved), exaggeration * expected, rtol=1e-9, atol=1e-16)
    # into the tooth: counterclockwise from the flank that faces clockwise
    assert (np.angle(moved[-1] / profile.flank(0.0)[-1]) > 0) or exaggeration == 0.0


def test_relieved_flanks_overlap_by_no_more_than_penetration_and_deviation():
    pair = RealPair(relief=(10e-6, 10e-6))
    history = pair.history(ROLLED)
    for row in range(ROLLED.size):
        one, two = outlines(history, row)
        assert overlap(one, two) < pair.penetration + CHORD


@pytest.mark.parametrize("coast", [False, True])
def test_drawn_forces_have_the_torques_of_the_theory(coast):
    """sigma (F_n r_b + F_t l) on both wheels, with l = rho at no penetration."""
    pair = RealPair(coast=coast, penetration=0.0)
    history = pair.history(ROLLED)
    (mesh,) = drawn_meshes(history)
    sign = -1 if coast else 1
    for row in range(0, ROLLED.size, 5):
        slots = np.flatnonzero(history["pair_normal_force"].values[row, 0] > 0)
        drawn = touching(history, mesh, 0, row)
        for slot, touch in zip(slots, drawn, strict=True):
            point, force = touch.point, touch.force
            normal = float(history["pair_normal_force"].values[row, 0, slot])
            rho = float(history["pair_position"].values[row, 0, slot])
            tangential = pair.friction * normal
            on_a = (point.conjugate() * -force).imag
            on_b = ((point - pair.distance).conjugate() * force).imag
            expected_a = sign * (normal * pair.base[0] + tangential * rho)
            expected_b = sign * (normal * pair.base[1] + tangential * (pair.length - rho))
            assert on_a == pytest.approx(expected_a, rel=1e-9)
            assert on_b == pytest.approx(expected_b, rel=1e-9)


def test_a_wheel_between_two_meshes_has_all_its_teeth():
    """Two meshes that agree on the teeth: none is drawn twice, none is missing."""
    pair = RealPair()
    one = pair.history(ROLLED)
    names = [n for n, v in one.data_vars.items() if "mesh" in v.dims]
    both = xr.concat([one[names]] * 2, dim="mesh").assign_coords(mesh=["first", "second"])
    history = one.drop_vars([*names, "mesh"]).merge(both)
    for angle in np.linspace(0.0, 0.4, 9):
        for wheel, teeth in zip(drawn_wheels(history), pair.teeth, strict=True):
            directions = wheel.directions(float(angle))
            assert directions.size == teeth
            assert np.diff(directions) == pytest.approx(2 * math.pi / teeth)
