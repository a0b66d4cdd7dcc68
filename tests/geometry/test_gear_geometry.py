"""Real gears: reference values, ISO 21771 in 40 digits, identities, the rack that cuts them."""

from __future__ import annotations

import ctypes
from collections.abc import Iterator
from typing import Any

import mpmath as mp
import numpy as np
import pytest
from hypothesis import HealthCheck, assume, given, settings
from hypothesis import strategies as st

from kernel.gear_reference import exact_gear, exact_mesh, inv, inverse_inv
from kernel.gearbox import Gearbox
from kernel.gearbox_description import mesh as mesh_description
from kernel.gearbox_description import wheel
from kernel.gears import (
    GearGeometry,
    gear,
    gear_description,
    gear_mesh,
    gear_of,
    involute_inverse,
    involute_value,
    mesh_of,
    tooth_thickness,
)
from kernel.kernel import INVALID_INPUT, OK, OUT_OF_DOMAIN, Kernel, KernelError

EPS = np.finfo(float).eps
# the library is loaded once; examples share nothing else
SETTINGS = settings(
    max_examples=300, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture]
)
angles = st.floats(np.radians(14.5), np.radians(28.0))
modules = st.floats(0.5e-3, 20e-3)


@pytest.fixture(autouse=True)
def _digits() -> Iterator[None]:
    with mp.workdps(40):
        yield


@st.composite
def gears(draw: st.DrawFn) -> tuple[int, dict[str, Any]]:
    """Teeth and description of a gear; not every one of them can be made."""
    given: dict[str, Any] = {
        "module": draw(modules),
        "pressure_angle": draw(angles),
        "profile_shift": draw(st.floats(-0.5, 0.8)),
        "tip_alteration": draw(st.floats(-0.3, 0.0)),
    }
    given["thickness_allowance"] = -given["module"] * draw(st.floats(0.0, 0.1))
    given["tip_rounding"] = given["module"] * draw(st.sampled_from([0.0, 0.02, 0.1, 0.25]))
    return draw(st.integers(8, 150)), given


def made(kernel: Kernel, teeth: int, **given: Any) -> GearGeometry:
    """Make a gear; hypothesis looks for another example if there is none."""
    try:
        return gear(kernel, teeth, **given)
    except KernelError:
        assume(False)
        raise


# ---- involute function


def test_involute_function_and_its_inverse_are_exact_to_a_few_roundings(kernel: Kernel) -> None:
    alpha = np.concatenate([np.logspace(-8, -1, 200), np.linspace(0.1, 1.57, 300)])
    values = involute_value(kernel, alpha)
    for a, value in zip(alpha, values, strict=True):
        exact = inv(mp.mpf(float(a)))
        # a few roundings of u = tan(alpha) count d ln inv/d ln u times, which is from 1 to 3;
        # u - atan u from u = 1/2 on is 14 times smaller than u at most
        assert abs(float(mp.mpf(float(value)) / exact - 1)) < 14 * EPS
    back = involute_inverse(kernel, values)
    for value, a in zip(values, back, strict=True):
        exact = inverse_inv(mp.mpf(float(value)))
        assert abs(float(mp.mpf(float(a)) / exact - 1)) < 6 * EPS  # a third of it


@SETTINGS
@given(st.floats(1e-30, 1e6))
def test_inverse_involute_converges_everywhere(kernel: Kernel, involute: float) -> None:
    exact = inverse_inv(mp.mpf(involute))
    assert involute_inverse(kernel, involute)[0] == pytest.approx(float(exact), rel=6 * EPS)


def test_involute_of_no_angle_is_none(kernel: Kernel) -> None:
    assert involute_value(kernel, 0.0)[0] == 0
    assert involute_inverse(kernel, 0.0)[0] == 0


# ---- reference values


def test_the_pair_12_40_has_its_reference_values(kernel: Kernel) -> None:
    """Given with the task of this program, in mm and degrees, to 1e-12."""
    a = gear(kernel, 12, 2e-3, profile_shift=0.3, tip_diameter=28e-3)
    b = gear(kernel, 40, 2e-3, profile_shift=-0.1, tip_diameter=83.2e-3)
    mesh = gear_mesh(kernel, a, b)
    tolerance = {"rel": 1e-12}
    assert np.degrees(mesh.working_pressure_angle) == pytest.approx(21.13868827687391, **tolerance)
    assert 1e3 * mesh.centre_distance == pytest.approx(52.38927831334764, **tolerance)
    assert 1e3 * mesh.line_of_action == pytest.approx(18.892972108605324, **tolerance)
    assert 2e3 * mesh.active_radius_a == pytest.approx(22.653576724323237, **tolerance)
    assert 2e3 * mesh.active_radius_b == pytest.approx(78.1051679820969, **tolerance)
    assert 1e3 * mesh.path_of_contact == pytest.approx(7.229131220081783, **tolerance)
    assert mesh.contact_ratio == pytest.approx(1.224391830355867, **tolerance)
    assert mesh.backlash == 0


def test_the_pair_12_24_has_its_reference_values(kernel: Kernel) -> None:
    """Printed values, in mm and degrees: half of the last digit."""
    a = gear(kernel, 12, 3e-3, profile_shift=0.6, tip_diameter=44.84e-3)
    b = gear(kernel, 24, 3e-3, profile_shift=0.36, tip_diameter=79.40e-3)
    mesh = gear_mesh(kernel, a, b, centre_distance=56.5e-3)
    assert np.degrees(mesh.working_pressure_angle) == pytest.approx(26.0888, abs=5e-5)
    assert 2e3 * a.base_radius == pytest.approx(33.8289, abs=5e-5)
    assert 2e3 * b.base_radius == pytest.approx(67.6579, abs=5e-5)
    assert 2e3 * mesh.pitch_radius_a == pytest.approx(37.667, abs=5e-4)
    assert 2e3 * mesh.pitch_radius_b == pytest.approx(75.333, abs=5e-4)
    assert mesh.contact_ratio == pytest.approx(1.202, abs=5e-4)


def test_a_pair_50_50_with_standard_tips_has_contact_ratio_1_755(kernel: Kernel) -> None:
    wheel_50 = gear(kernel, 50, 3e-3)
    assert gear_mesh(kernel, wheel_50, wheel_50).contact_ratio == pytest.approx(1.755, abs=5e-4)


def test_undercut_of_a_standard_gear_without_rounding_begins_below_17_1_teeth(
    kernel: Kernel,
) -> None:
    """2/sin(20 deg)^2 = 17.097 teeth of a rack whose straight flank ends one module deep."""
    sharp = {"rack_dedendum": 1.0, "rack_root_radius": 0.0}
    assert gear(kernel, 17, **sharp).is_undercut
    assert not gear(kernel, 18, **sharp).is_undercut
    # the known limit of 14 teeth with a shift: x = (17.097 - 14)/17.097
    assert gear(kernel, 14, **sharp).undercut_shift == pytest.approx(
        1 - 7 * np.sin(0.34906585) ** 2
    )


# ---- against mpmath


@SETTINGS
@given(gears())
def test_a_gear_has_the_lengths_of_iso_21771_in_40_digits(
    kernel: Kernel, one: tuple[int, dict[str, Any]]
) -> None:
    teeth, given = one
    geometry = made(kernel, teeth, **given)
    exact = exact_gear(teeth, gear_description(**given))
    size = geometry.tip_radius
    for name, value in exact.items():
        if name == "form_radius" and geometry.is_undercut:
            continue  # the end of the flank is not the start of the involute then
        # thicknesses and shifts are differences of larger numbers
        absolute = 1e-14 * (size if name.endswith(("thickness", "radius", "depth")) else 1)
        expected = pytest.approx(float(value), rel=1e-12, abs=absolute)
        assert getattr(geometry, name) == expected, name
    assert geometry.is_undercut == (exact["generating_shift"] < exact["undercut_shift"])


@SETTINGS
@given(gears(), gears(), st.sampled_from(["", "centre_distance", "backlash"]), st.floats(0.0, 0.3))
def test_a_mesh_has_the_lengths_of_iso_21771_in_40_digits(
    kernel: Kernel,
    one: tuple[int, dict[str, Any]],
    other: tuple[int, dict[str, Any]],
    way: str,
    part: float,
) -> None:
    shared = {name: one[1][name] for name in ("module", "pressure_angle")}
    a = made(kernel, one[0], **one[1])
    b = made(kernel, other[0], **{**other[1], **shared})
    more: dict[str, float] = {}
    if way == "backlash":
        more = {"backlash": part * a.normal_module}
    elif way == "centre_distance":
        try:
            more = {"centre_distance": gear_mesh(kernel, a, b).centre_distance * (1 + part / 20)}
        except KernelError:
            assume(False)
    try:
        mesh = gear_mesh(kernel, a, b, **more)
    except KernelError:
        assume(False)
    # test_undercut_mesh.py has those that undercut shortens
    assume(mesh.rho_end_a == mesh.rho_tip_a and mesh.rho_end_b == mesh.rho_tip_b)
    for name, value in exact_mesh(a, b, more).items():
        # differences of numbers up to the centre distance; backlash over sin alpha_w
        expected = pytest.approx(float(value), rel=1e-12, abs=3e-14 * mesh.centre_distance)
        if name == "contact_ratio":
            expected = pytest.approx(float(value), rel=1e-12, abs=1e-11)
        assert getattr(mesh, name) == expected, name


# ---- identities


@SETTINGS
@given(gears(), st.floats(0.0, 1.0))
def test_tooth_thickness_goes_from_the_reference_circle_to_the_tip(
    kernel: Kernel, one: tuple[int, dict[str, Any]], part: float
) -> None:
    g = made(kernel, one[0], **one[1])
    radius = g.base_radius + part * (g.tip_radius - g.base_radius)
    some, codes = tooth_thickness(
        kernel, g, [g.base_radius, g.reference_radius, g.tip_radius, radius]
    )
    assert not codes.any()
    size = 1e-14 * g.tip_radius
    assert some[0] == pytest.approx(g.base_radius * g.tooth_angle, abs=size)
    assert some[1] == pytest.approx(g.thickness, abs=size)
    assert some[2] == pytest.approx(g.tip_thickness, abs=size)
    alpha = mp.acos(mp.mpf(g.base_radius) / mp.mpf(max(radius, g.base_radius)))
    exact = mp.mpf(radius) * (mp.mpf(g.tooth_angle) - 2 * inv(alpha))
    assert some[3] == pytest.approx(float(exact), abs=size)


@SETTINGS
@given(gears(), st.floats(0.01, 0.2))
def test_a_rounded_tip_touches_involute_and_tip_circle(
    kernel: Kernel, one: tuple[int, dict[str, Any]], part: float
) -> None:
    """Point by point: the arc's centre, seen from three sides; it lies on its half of the tooth."""
    teeth, given = one
    g = made(kernel, teeth, **{**given, "tip_rounding": part * given["module"]})
    r_b, r_t = mp.mpf(g.base_radius), mp.mpf(g.tip_rounding)
    rho = mp.sqrt(mp.mpf(g.tip_form_radius) ** 2 - r_b**2)

    def flank(rho: mp.mpf) -> mp.mpc:
        return (r_b - 1j * rho) * mp.expj(rho / r_b - mp.mpf(g.tooth_angle) / 2)

    end = flank(rho)
    along = mp.diff(flank, rho)
    centre = end + 1j * along / abs(along) * r_t
    assert float(abs(centre) + r_t) == pytest.approx(g.tip_radius, rel=1e-13)
    assert mp.arg(centre) < 0
    for step in (-1e-3, 1e-3):  # the involute lies outside the arc
        assert abs(flank(rho * (1 + step)) - centre) > r_t


def test_rounding_is_refused_where_no_arc_of_the_tip_or_no_involute_is_left(
    kernel: Kernel,
) -> None:
    """The largest one that is named is possible, and a little more is not."""
    for teeth, form, reason in (
        (20, {"tip_rounding": 1.5e-3}, "overlap on a tooth that is 0.00138"),
        (60, {"tip_rounding": 9e-4, "tip_diameter": 0.117}, "passes the form circle"),
    ):
        with pytest.raises(KernelError, match=reason) as error:
            gear(kernel, teeth, **form)
        assert (error.value.code, error.value.field) == (INVALID_INPUT, "tip_rounding")
        largest = float(error.value.message.split("give less than ")[1].split()[0])
        g = gear(kernel, teeth, **{**form, "tip_rounding": largest * (1 - 1e-5)})
        assert g.form_radius < g.tip_form_radius < g.tip_radius
        with pytest.raises(KernelError):
            gear(kernel, teeth, **{**form, "tip_rounding": largest * (1 + 1e-5)})


def test_inside_the_base_circle_there_is_no_tooth_thickness(kernel: Kernel) -> None:
    g = gear(kernel, 40)
    thickness, codes = tooth_thickness(kernel, g, [0.99 * g.base_radius, g.reference_radius])
    assert list(codes) == [OUT_OF_DOMAIN, OK]
    assert thickness[0] == 0


def pairs(kernel: Kernel) -> Iterator[tuple[GearGeometry, GearGeometry]]:
    """Some usual pairs, with and without allowances."""
    for teeth_a, teeth_b, x_a, x_b in ((20, 30, 0, 0), (13, 47, 0.4, -0.1), (25, 25, 0.5, 0.5)):
        for allowance in (0.0, -3e-5):
            a = gear(kernel, teeth_a, profile_shift=x_a, thickness_allowance=allowance)
            b = gear(kernel, teeth_b, profile_shift=x_b, tip_alteration=-0.05)
            yield a, b


def test_backlash_and_centre_distance_are_inverse_to_each_other(kernel: Kernel) -> None:
    for a, b in pairs(kernel):
        for backlash in (0.0, 1e-5, 2e-4):
            mesh = gear_mesh(kernel, a, b, backlash=backlash)
            assert mesh.backlash == backlash
            back = gear_mesh(kernel, a, b, centre_distance=mesh.centre_distance)
            # the distance is rounded to 1e-17 m
            assert back.backlash == pytest.approx(backlash, abs=1e-16)


def test_at_the_distance_from_the_profile_shifts_backlash_is_what_the_allowances_leave(
    kernel: Kernel,
) -> None:
    for a, b in pairs(kernel):
        mesh = gear_mesh(kernel, a, b)
        left = -(a.thickness_allowance + b.thickness_allowance) * np.cos(np.radians(20))
        assert mesh.centre_distance == mesh.tight_distance
        assert mesh.backlash == pytest.approx(left, abs=1e-18)
        at_it = gear_mesh(kernel, a, b, centre_distance=mesh.tight_distance)
        assert at_it.backlash == pytest.approx(left, abs=1e-16)


def test_teeth_and_backlash_fill_the_pitch_on_the_working_pitch_circles(kernel: Kernel) -> None:
    for a, b in pairs(kernel):
        mesh = gear_mesh(kernel, a, b, backlash=8e-5)
        s_a = tooth_thickness(kernel, a, mesh.pitch_radius_a)[0][0]
        s_b = tooth_thickness(kernel, b, mesh.pitch_radius_b)[0][0]
        pitch = 2 * np.pi * mesh.pitch_radius_a / a.teeth
        assert s_a + s_b + mesh.circumferential_backlash == pytest.approx(pitch, rel=1e-14)


def test_lengths_on_the_line_of_action_add_up(kernel: Kernel) -> None:
    for a, b in pairs(kernel):
        mesh = gear_mesh(kernel, a, b, backlash=8e-5)
        assert mesh.approach + mesh.recess == pytest.approx(mesh.path_of_contact, rel=1e-13)
        assert mesh.pitch_radius_a + mesh.pitch_radius_b == pytest.approx(
            mesh.centre_distance, rel=1e-15
        )
        for radius, base in (
            (mesh.pitch_radius_a, a.base_radius),
            (mesh.pitch_radius_b, b.base_radius),
        ):
            cosine = np.cos(mesh.working_pressure_angle)
            assert radius * cosine == pytest.approx(base, rel=1e-15)
        # the base pitch is that of the base circle
        assert mesh.base_pitch == pytest.approx(2 * np.pi * b.base_radius / b.teeth, rel=1e-15)


def test_exchanging_the_gears_exchanges_what_is_theirs(kernel: Kernel) -> None:
    for a, b in pairs(kernel):
        one, other = gear_mesh(kernel, a, b), gear_mesh(kernel, b, a)
        assert one.centre_distance == pytest.approx(other.centre_distance, rel=1e-15)
        assert one.approach == pytest.approx(other.recess, rel=1e-13)
        assert one.active_radius_a == pytest.approx(other.active_radius_b, rel=1e-15)
        assert one.clearance_a == pytest.approx(other.clearance_b, rel=1e-12)


def test_gears_of_different_module_mesh_if_their_base_pitch_is_the_same(kernel: Kernel) -> None:
    """m cos alpha counts: 2 mm at 20 deg is 1.9 mm at acos(2/1.9 cos 20 deg)."""
    alpha = np.arccos(2 / 1.9 * np.cos(np.radians(20)))
    a = gear(kernel, 30, 2e-3)
    b = gear(kernel, 40, 1.9e-3, pressure_angle=alpha)
    mesh = gear_mesh(kernel, a, b)
    s_a = tooth_thickness(kernel, a, mesh.pitch_radius_a)[0][0]
    s_b = tooth_thickness(kernel, b, mesh.pitch_radius_b)[0][0]
    assert s_a + s_b == pytest.approx(2 * np.pi * mesh.pitch_radius_a / 30, rel=1e-14)


# ---- the rack cuts the gear

UNDERCUT = [
    (10, {}),
    (8, {"profile_shift": 0.2}),
    (14, {"profile_shift": -0.3}),
    (12, {"rack_root_radius": 0.0}),
    (9, {"pressure_angle": np.radians(25), "rack_dedendum": 1.4, "rack_root_radius": 0.2}),
    (20, {"pressure_angle": np.radians(14.5), "rack_root_radius": 0.25}),
    (16, {"thickness_allowance": -1e-4}),
]


def rack_tip(teeth: int, given: dict[str, Any]) -> tuple[float, float, float, float]:
    """Return r, alpha, and depth and radius of the rounding of the rack's tip."""
    d = gear_description(**given)
    x_e = d.profile_shift + d.thickness_allowance / (2 * d.module * np.tan(d.pressure_angle))
    depth = d.module * (d.rack.dedendum - d.rack.root_radius - x_e)
    return d.module * teeth / 2, d.pressure_angle, depth, d.module * d.rack.root_radius


@pytest.mark.parametrize(("teeth", "given"), UNDERCUT)
def test_undercut_ends_where_the_fillet_crosses_the_involute(
    kernel: Kernel, teeth: int, given: dict[str, Any]
) -> None:
    """Both curves in 40 digits, crossed by Newton; the next test says that it is the right one."""
    g = gear(kernel, teeth, **given)
    assert g.is_undercut
    r, alpha, depth, rho = (mp.mpf(value) for value in rack_tip(teeth, given))
    rb, end = r * mp.cos(alpha), depth / mp.tan(alpha)
    offset = alpha - (r * mp.sin(alpha) - depth / mp.sin(alpha) - rho) / rb

    def apart(u: mp.mpf, xi: mp.mpf) -> list[mp.mpf]:
        stretch = 1 + rho / mp.hypot(u, depth)
        x, y = stretch * u, r - stretch * depth
        turned = (u - end) / r
        angle = mp.atan2(x, y) - turned
        return [mp.hypot(x, y) - rb * mp.sqrt(1 + xi**2), angle - offset - (xi - mp.atan(xi))]

    xi_0 = mp.sqrt(mp.mpf(g.form_radius) ** 2 - rb**2) / rb
    u_0 = mp.findroot(
        lambda u: apart(u, xi_0)[0], (end / 3, end * mp.mpf("0.9")), solver="anderson", tol=1e-25
    )
    _, xi = mp.findroot(apart, (u_0, xi_0))
    assert g.form_radius == pytest.approx(float(rb * mp.sqrt(1 + xi**2)), rel=1e-12)


@pytest.mark.parametrize(("teeth", "given"), [*UNDERCUT, (12, {"profile_shift": 0.5}), (40, {})])
def test_the_moving_rack_leaves_the_involute_above_the_form_circle_and_cuts_it_below(
    kernel: Kernel, teeth: int, given: dict[str, Any]
) -> None:
    """Every point of the rack's outline at every position, in the frame of the gear."""
    g = gear(kernel, teeth, **given)
    r, alpha, depth, rho = rack_tip(teeth, given)
    normal, along = (
        np.array([np.cos(alpha), -np.sin(alpha)]),
        np.array([np.sin(alpha), np.cos(alpha)]),
    )
    directions = np.linspace(-np.pi / 2, -alpha, 400)
    tip = rho * np.column_stack([np.cos(directions), np.sin(directions)])
    flank = rho * normal + np.linspace(0, 3.0 * g.normal_module, 400)[:, None] * along
    outline = np.concatenate([tip, flank])
    shift = np.linspace(-1.2, 0.6, 6001)[:, None] * np.sqrt(teeth) * g.normal_module
    x = depth / np.tan(alpha) + shift + outline[:, 0]
    y = r - depth + outline[:, 1]
    radius = np.hypot(x, y)
    rho_end = r * np.sin(alpha) - depth / np.sin(alpha) - rho
    root = alpha - rho_end / g.base_radius
    tangent = np.sqrt(np.maximum((radius / g.base_radius) ** 2 - 1, 0))
    excess = np.arctan2(x, y) - shift / r - root - (tangent - np.arctan(tangent))
    above = (radius > g.form_radius * (1 + 1e-9)) & (radius < g.tip_radius)
    # rounding of angles; points of the flank touch the involute to second order in the step
    assert excess[above].max() < 1e-12
    assert excess[above].max() > -1e-5
    below = (radius < g.form_radius * (1 - 1e-5)) & (radius > g.base_radius)
    if g.is_undercut:
        assert excess[below].max() > 1e-6
    elif below.any():
        # the fillet stays outside of the extended involute: material is left
        deepest = radius[below] > g.form_radius * (1 - 1e-2)
        assert excess[below][deepest].max() < 1e-12


def test_the_form_circle_is_continuous_where_undercut_begins(kernel: Kernel) -> None:
    limit = gear(kernel, 12).undercut_shift
    for step in (1e-3, 1e-5, 1e-7):
        below = gear(kernel, 12, profile_shift=limit - step)
        above = gear(kernel, 12, profile_shift=limit + step)
        assert below.is_undercut
        assert not above.is_undercut
        assert below.form_radius - below.base_radius < step * below.base_radius
        assert above.form_radius - above.base_radius < step * above.base_radius


# ---- in a gearbox


def wheel_of(teeth: int, **given: Any) -> Any:
    return wheel(teeth=teeth, width=0.02, gear=gear_description(**given))


def real(kernel: Kernel, *of: int, **given: Any) -> Any:
    return mesh_description(kernel, *of, real=True, **given)


def fields(structure: ctypes.Structure) -> dict[str, Any]:
    return {name: getattr(structure, name) for name, _ in structure._fields_}


def test_a_gearbox_hands_out_its_gears_and_other_wheels_are_none(kernel: Kernel) -> None:
    box = Gearbox(kernel, [wheel_of(23), wheel_of(41)], [], [real(kernel, backlash=5e-5)])
    a, b = gear(kernel, 23), gear(kernel, 41)
    mesh = gear_mesh(kernel, a, b, backlash=5e-5)
    for index, expected in enumerate((a, b)):
        got = gear_of(box, index)
        assert got is not None
        assert fields(got) == fields(expected)
    got_mesh = mesh_of(box, 0)
    assert got_mesh is not None
    assert fields(got_mesh) == fields(mesh)
    paper = Gearbox(
        kernel, [wheel(pitch_radius=0.2), wheel(teeth=30)], [], [mesh_description(kernel)]
    )
    assert gear_of(paper, 0) is None
    assert mesh_of(paper, 0) is None


@pytest.mark.parametrize("rotation", [-1, 1])
def test_the_pair_of_a_gearbox_has_its_path_between_the_tip_circles(
    kernel: Kernel, rotation: int
) -> None:
    box = Gearbox(
        kernel,
        [wheel_of(23, profile_shift=0.2), wheel_of(41)],
        [],
        [real(kernel, backlash=5e-5, centre_line_angle=0.7, driving_rotation=rotation)],
    )
    geometry, mesh = box.mesh_geometry(), mesh_of(box, 0)
    assert mesh is not None
    a, b = (np.array(getattr(geometry, name)) for name in ("point_a", "point_b"))
    k_a, k_b = (np.array(getattr(geometry, name)) for name in ("point_k_a", "point_k_b"))
    centres = [np.array(box.wheel_geometry(i).centre) for i in (0, 1)]
    size = 1e-15 * (1 + mesh.centre_distance)
    assert np.hypot(*(centres[1] - centres[0])) == pytest.approx(mesh.centre_distance, abs=size)
    assert np.hypot(*(b - centres[0])) == pytest.approx(geometry.tip_radius_driving, abs=size)
    assert np.hypot(*(a - centres[1])) == pytest.approx(geometry.tip_radius_driven, abs=size)
    assert np.hypot(*(k_b - k_a)) == pytest.approx(mesh.line_of_action, abs=size)
    assert np.hypot(*(b - a)) == pytest.approx(mesh.path_of_contact, abs=size)
    assert geometry.contact_ratio == pytest.approx(mesh.contact_ratio, rel=1e-13)
    assert np.hypot(*(a - k_a)) == pytest.approx(geometry.rho_start_driving, abs=size)
    # the driving wheel, clockwise or not, moves the point of contact from a to b
    turn = rotation * np.array([-(a - centres[0])[1], (a - centres[0])[0]])
    assert turn @ (b - a) > 0


def test_an_idler_has_one_base_circle_and_a_working_pitch_circle_in_each_mesh(
    kernel: Kernel,
) -> None:
    box = Gearbox(
        kernel,
        [wheel_of(20, profile_shift=0.3), wheel_of(31), wheel_of(45)],
        [],
        [
            real(kernel, 0, 1),
            real(kernel, 1, 2, driving_rotation=1, backlash=1e-4, centre_line_angle=1.0),
        ],
    )
    first, second = mesh_of(box, 0), mesh_of(box, 1)
    assert first is not None
    assert second is not None
    assert first.pitch_radius_b != pytest.approx(second.pitch_radius_a, rel=1e-4)
    idler = box.wheel_geometry(1)
    assert idler.pitch_radius == pytest.approx(0.031, rel=1e-15)
    assert idler.base_radius == pytest.approx(0.031 * np.cos(np.radians(20)), rel=1e-15)
    position = np.array([first.centre_distance, 0]) + second.centre_distance * np.array(
        [np.cos(1.0), np.sin(1.0)]
    )
    np.testing.assert_allclose(box.wheel_geometry(2).centre, position, rtol=1e-15)


def test_the_disc_of_a_gear_has_its_reference_radius_and_a_bore(kernel: Kernel) -> None:
    box = Gearbox(kernel, [wheel_of(30, bore=0.02), wheel_of(40)], [], [real(kernel)])
    r, bore, width, density = 0.03, 0.01, 0.02, 7800.0
    mass = density * np.pi * (r**2 - bore**2) * width
    geometry = box.wheel_geometry(0)
    assert geometry.mass == pytest.approx(mass, rel=1e-14)
    assert geometry.inertia == pytest.approx(mass * (r**2 + bore**2) / 2, rel=1e-14)
