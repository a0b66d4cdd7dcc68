"""Gears that cannot be made and pairs that cannot mesh are refused with the reason."""

from __future__ import annotations

import re
from typing import Any

import numpy as np
import pytest

from kernel.gearbox import MESH, WHEEL, Gearbox, GearboxError, Warned
from kernel.gearbox_description import mesh as mesh_description
from kernel.gearbox_description import wheel
from kernel.gears import gear, gear_description, gear_mesh, gear_of, mesh_of
from kernel.kernel import INVALID_INPUT, Kernel, KernelError

NAN, INF = np.nan, np.inf

BAD_GEARS: dict[str, tuple[int, dict[str, Any], str, str]] = {
    "two teeth": (2, {}, "teeth", "teeth = 2 must be at least 3"),
    "no module": (20, {"module": 0.0}, "module", "module = 0 m must be greater than 0 m"),
    "a module that is none": (20, {"module": NAN}, "module", "must be a finite number"),
    "no addendum": (20, {"rack_addendum": 0.0}, "rack.addendum", "greater than 0"),
    "a negative dedendum": (20, {"rack_dedendum": -1.0}, "rack.dedendum", "= -1 must be"),
    "a negative rounding": (20, {"rack_root_radius": -0.1}, "rack.root_radius", "= -0.1 must be"),
    "flat flanks": (20, {"pressure_angle": np.radians(4.9)}, "pressure_angle", "4.9 deg must be"),
    "steep flanks": (20, {"pressure_angle": np.radians(46)}, "pressure_angle", "46 deg must be"),
    "no angle": (20, {"pressure_angle": NAN}, "pressure_angle", "must be a finite number"),
    "an infinite shift": (20, {"profile_shift": INF}, "profile_shift", "finite"),
    "an infinite alteration": (20, {"tip_alteration": INF}, "tip_alteration", "finite"),
    "a tip diameter of 0": (20, {"tip_diameter": 0.0}, "tip_diameter", "greater than 0"),
    "thicker teeth": (
        20,
        {"thickness_allowance": 1e-5},
        "thickness_allowance",
        "must be at most 0",
    ),
    "a negative rounding of the tip": (
        20,
        {"tip_rounding": -1e-4},
        "tip_rounding",
        "must be at least 0",
    ),
    "a negative bore": (20, {"bore": -0.01}, "bore", "must be at least 0"),
    # full rounding: (pi/4 - 1.25 tan 20) cos 20/(1 - sin 20) = 0.4719
    "a rounding wider than the tip": (20, {"rack_root_radius": 0.48}, "rack.root_radius", "0.4719"),
    # pointed: pi/4/tan 20 = 2.1579
    "a pointed rack": (
        20,
        {"rack_dedendum": 2.2, "rack_root_radius": 0.0},
        "rack.dedendum",
        "2.15786",
    ),
    "two tips": (
        20,
        {"tip_diameter": 0.044, "tip_alteration": -0.1},
        "tip_diameter",
        "0.044 m does not agree with 0.0436 m",
    ),
    "a pointed tooth": (12, {"profile_shift": 0.9}, "tip_diameter", "the tooth is pointed"),
    # d_b = 40 cos 20 = 37.5877 mm
    "a tip inside the base circle": (20, {"tip_diameter": 0.0375}, "tip_diameter", "0.0375877 m"),
    "a tip inside the form circle": (60, {"tip_diameter": 0.1155}, "tip_diameter", "form circle"),
    "a root without radius": (
        3,
        {"rack_dedendum": 1.6, "rack_root_radius": 0.1},
        "rack.dedendum",
        "must be greater than 0",
    ),
    "remove the whole tooth": (
        20,
        {"thickness_allowance": -0.0032},
        "thickness_allowance",
        "remove the whole tooth",
    ),
    "nothing of the space": (20, {"profile_shift": 2.2}, "profile_shift", "less than the pitch"),
    # d_f = 40 - 5 mm
    "a bore through the teeth": (20, {"bore": 0.035}, "bore", "0.035 m"),
    "a round tip that cuts everything": (
        4,
        {"pressure_angle": np.radians(5), "profile_shift": 0.88, "tip_alteration": -0.8},
        "rack.root_radius",
        "leave no part of the profile",
    ),
}


@pytest.mark.parametrize(
    ("teeth", "given", "field", "reason"), BAD_GEARS.values(), ids=list(BAD_GEARS)
)
def test_a_gear_that_cannot_be_made_is_refused(
    kernel: Kernel, teeth: int, given: dict[str, Any], field: str, reason: str
) -> None:
    with pytest.raises(KernelError) as error:
        gear(kernel, teeth, **given)
    assert (error.value.code, error.value.field) == (INVALID_INPUT, field)
    assert reason in error.value.message


def test_a_tip_diameter_and_an_alteration_that_agree_are_accepted(kernel: Kernel) -> None:
    both = gear(kernel, 20, tip_diameter=0.0436, tip_alteration=-0.1)
    assert both.tip_radius == pytest.approx(0.0218, rel=1e-15)
    assert gear(kernel, 20, tip_diameter=0.0436).tip_alteration == pytest.approx(-0.1, rel=1e-13)


A, B = {"teeth": 20}, {"teeth": 40}  # centre distance 60 mm, base radii add up to 56.3816 mm
BAD_MESHES: dict[str, tuple[dict[str, Any], dict[str, Any], dict[str, Any], str, str]] = {
    "two modules": (A, {**B, "module": 0.0021}, {}, "", "base pitch"),
    "two pressure angles": (A, {**B, "pressure_angle": 0.3}, {}, "", "base pitch"),
    "a distance of 0": (A, B, {"centre_distance": 0.0}, "centre_distance", "greater than 0"),
    "base circles that overlap": (
        A,
        B,
        {"centre_distance": 0.056},
        "centre_distance",
        "0.0563816 m, the sum of the base radii",
    ),
    "too close": (
        A,
        B,
        {"centre_distance": 0.0599},
        "centre_distance",
        "the normal backlash would be -6.797",
    ),
    "a distance against a backlash": (
        A,
        B,
        {"centre_distance": 0.0601, "backlash": 1e-4},
        "backlash",
        "does not agree with 6.8",
    ),
    "teeth too thin for any distance": (
        {"teeth": 20, "profile_shift": -0.5},
        {"teeth": 20, "profile_shift": -0.5},
        {},
        "",
        "no centre distance gives this backlash",
    ),
    "out of reach": (A, B, {"centre_distance": 0.065}, "", "do not reach each other"),
    "tips past the base circle": (
        {"teeth": 18, "profile_shift": 0.1},
        {"teeth": 200, "tip_alteration": 0.5},
        {},
        "",
        "the path of contact leaves the line of action: the tip of the driven wheel",
    ),
    "tips past the base circle of the other": (
        {"teeth": 200, "tip_alteration": 0.5},
        {"teeth": 18, "profile_shift": 0.1},
        {},
        "",
        "the tip of the driving wheel",
    ),
    "undercut that leaves too little": (
        {"teeth": 9, "rack_root_radius": 0.1},
        {"teeth": 60},
        {},
        "",
        "undercut leaves it a contact ratio of 0.946245, which must be at least 1",
    ),
    "a tip in an undercut tooth": (
        {"teeth": 12},
        {"teeth": 40, "rack_addendum": 1.24},
        {},
        "",
        "the tip of the driven wheel enters the undercut tooth of the driving wheel by 1.65",
    ),
    "a tip in an undercut tooth of the other": (
        {"teeth": 40, "rack_addendum": 1.24},
        {"teeth": 12},
        {},
        "",
        "the tip of the driving wheel enters the undercut tooth of the driven wheel by 1.65",
    ),
    "a fillet in the way": (
        {"teeth": 20, "rack_dedendum": 1.05, "tip_alteration": -0.2},
        {"teeth": 40, "tip_alteration": 0.0},
        {"centre_distance": 0.06},
        "",
        "tip interference: the tip of the driven wheel meets the driving wheel",
    ),
    "tips in the root circle": (
        {"teeth": 60, "tip_alteration": 0.26},
        {"teeth": 60, "rack_root_radius": 0.1},
        {},
        "",
        "runs into the root circle of the driven wheel",
    ),
}


@pytest.mark.parametrize(
    ("a", "b", "given", "field", "reason"), BAD_MESHES.values(), ids=list(BAD_MESHES)
)
def test_gears_that_cannot_mesh_are_refused(
    kernel: Kernel,
    a: dict[str, Any],
    b: dict[str, Any],
    given: dict[str, Any],
    field: str,
    reason: str,
) -> None:
    with pytest.raises(KernelError) as error:
        gear_mesh(kernel, gear(kernel, **a), gear(kernel, **b), **given)
    assert (error.value.code, error.value.field) == (INVALID_INPUT, field)
    assert reason in error.value.message


def test_a_backlash_that_rounding_made_negative_is_none(kernel: Kernel) -> None:
    a, b = gear(kernel, 20), gear(kernel, 40)
    assert gear_mesh(kernel, a, b, centre_distance=0.06 * (1 - 1e-13)).backlash == 0
    both = gear_mesh(kernel, a, b, centre_distance=0.06, backlash=0.0)
    assert both.backlash == pytest.approx(0, abs=1e-16)


# ---- as parts of a gearbox


def real(kernel: Kernel, **given: Any) -> Any:
    return mesh_description(kernel, real=True, **given)


def gear_wheel(teeth: int, pitch_radius: float | None = None, **given: Any) -> Any:
    return wheel(teeth=teeth, pitch_radius=pitch_radius, gear=gear_description(**given))


def refusal(kernel: Kernel, wheels: list[Any], meshes: list[Any]) -> GearboxError:
    with pytest.raises(GearboxError) as error:
        Gearbox(kernel, wheels, [], meshes)
    assert error.value.code == INVALID_INPUT
    return error.value


def test_a_refusal_says_which_wheel(kernel: Kernel) -> None:
    error = refusal(kernel, [gear_wheel(20), gear_wheel(30, bore=0.1)], [real(kernel)])
    assert (error.subject, error.index, error.field) == (WHEEL, 1, "bore")


def test_a_refusal_says_which_mesh(kernel: Kernel) -> None:
    wheels = [gear_wheel(20), gear_wheel(30), gear_wheel(40, module=0.003)]
    meshes = [real(kernel), real(kernel, driving=1, driven=2)]
    error = refusal(kernel, wheels, meshes)
    assert (error.subject, error.index, error.field) == (MESH, 1, "")
    assert "base pitch" in error.message


def test_a_pitch_radius_has_to_be_the_reference_radius(kernel: Kernel) -> None:
    error = refusal(kernel, [gear_wheel(20, 0.021), gear_wheel(30)], [real(kernel)])
    assert (error.subject, error.index, error.field) == (WHEEL, 0, "pitch_radius")
    assert "0.021 m does not agree with the reference radius 0.02 m" in error.message
    Gearbox(kernel, [gear_wheel(20, 0.02), gear_wheel(30)], [], [real(kernel)])


def test_a_gear_does_not_mesh_with_a_wheel_without_module(kernel: Kernel) -> None:
    error = refusal(kernel, [gear_wheel(20), wheel(teeth=30)], [real(kernel)])
    assert (error.subject, error.index) == (MESH, 0)
    assert "one of its wheels has a module" in error.message


def test_a_pressure_angle_of_the_mesh_is_not_for_real_gears(kernel: Kernel) -> None:
    for mesh in (mesh_description(kernel), mesh_description(kernel, pressure_angle=0.35)):
        error = refusal(kernel, [gear_wheel(20), gear_wheel(30)], [mesh])
        assert (error.subject, error.field) == (MESH, "pressure_angle")


def test_a_centre_distance_is_for_real_gears(kernel: Kernel) -> None:
    wheels = [wheel(teeth=20, pitch_radius=0.2), wheel(teeth=30)]
    error = refusal(kernel, wheels, [mesh_description(kernel, centre_distance=0.5)])
    assert (error.subject, error.field) == (MESH, "centre_distance")
    error = refusal(kernel, wheels, [mesh_description(kernel, backlash=-1e-4)])
    assert (error.subject, error.field) == (MESH, "backlash")


def test_centres_have_to_agree_with_the_centre_distance(kernel: Kernel) -> None:
    wheels = [gear_wheel(20), gear_wheel(30)]
    wheels[0].centre, wheels[1].centre = (0.0, 0.0), (0.0501, 0.0)
    error = refusal(kernel, wheels, [real(kernel)])
    assert (error.subject, error.index, error.field) == (MESH, 0, "centre_distance")
    assert "0.0501 m apart, but its centre distance is 0.05 m" in error.message
    Gearbox(kernel, wheels, [], [real(kernel, centre_distance=0.0501)])


def test_a_ring_of_gears_has_to_close(kernel: Kernel) -> None:
    """Four equal gears on the corners of a square of 40 mm close; not of another quadrangle."""
    wheels = [gear_wheel(20) for _ in range(4)]
    quarter = np.pi / 2

    def ring(angle: float) -> list[Any]:
        turns = ((0, 1, 0.0), (1, 2, quarter), (3, 2, angle), (0, 3, None))
        return [
            real(kernel, driving=a, driven=b, centre_line_angle=direction)
            for a, b, direction in turns
        ]

    assert Gearbox(kernel, wheels, [], ring(0.0)).sizes.n_meshes == 4
    error = refusal(kernel, wheels, ring(0.3))
    assert (error.subject, error.index, error.field) == (MESH, 3, "centre_distance")
    assert "m apart, but its centre distance is 0.04 m" in error.message


# ---- rounded data of catalogues


def fitting_distance(kernel: Kernel, a: dict[str, Any], b: dict[str, Any]) -> float:
    """Centre distance without backlash."""
    return gear_mesh(kernel, gear(kernel, **a), gear(kernel, **b), backlash=0.0).centre_distance


def distance_of_overlap(
    kernel: Kernel, a: dict[str, Any], b: dict[str, Any], overlap: float
) -> float:
    """Centre distance at which the normal backlash is minus an overlap: j' = 2 sin alpha_w."""
    first, second = gear(kernel, **a), gear(kernel, **b)
    distance = fitting_distance(kernel, a, b)
    for _ in range(4):  # Newton's method on what allowances that are larger by it leave
        spare = 3e-4
        thin = {**b, "thickness_allowance": b.get("thickness_allowance", 0.0) - spare}
        mesh = gear_mesh(kernel, first, gear(kernel, **thin), centre_distance=distance)
        backlash = mesh.backlash - spare * np.cos(second.pressure_angle)
        distance -= (backlash + overlap) / (2 * np.sin(mesh.working_pressure_angle))
    return distance


CATALOGUE: dict[str, tuple[dict[str, Any], dict[str, Any]]] = {
    "standard": ({"teeth": 20}, {"teeth": 40}),
    "shifted": ({"teeth": 19, "profile_shift": 0.4}, {"teeth": 34, "profile_shift": 0.1}),
    "with allowances": (
        {"teeth": 19, "profile_shift": 0.4, "thickness_allowance": -3e-5},
        {"teeth": 34, "profile_shift": 0.1, "thickness_allowance": -5e-5},
    ),
}


def catalogue_pair(kernel: Kernel, name: str, distance: float, **second: Any) -> Gearbox:
    a, b = CATALOGUE[name]
    wheels = [gear_wheel(**a), gear_wheel(**{**b, **second})]
    return Gearbox(kernel, wheels, [], [real(kernel, centre_distance=distance)])


@pytest.mark.parametrize("name", CATALOGUE)
@pytest.mark.parametrize("overlap", [1e-9, 1e-8, 3e-7, 4.999e-7])
def test_rounded_data_make_the_driven_teeth_thinner(kernel: Kernel, name: str, overlap: float):
    a, b = CATALOGUE[name]
    distance = distance_of_overlap(kernel, a, b, overlap)
    gearbox = catalogue_pair(kernel, name, distance)
    (warned,) = gearbox.warnings()
    assert (warned.subject, warned.index) == (MESH, 0)
    assert warned.message.startswith("at its centre distance the normal backlash would be -")
    mesh, pinion, driven = mesh_of(gearbox, 0), gear_of(gearbox, 0), gear_of(gearbox, 1)
    assert (mesh.backlash, mesh.centre_distance) == (0, distance)
    alone = gear(kernel, **a)
    assert pinion.fields() == alone.fields()
    missing = overlap / np.cos(np.radians(20))
    # the centre distance that makes the overlap is known to its rounding, 1e-17 m
    allowance = b.get("thickness_allowance", 0.0) - missing
    assert driven.thickness_allowance == pytest.approx(allowance, abs=3e-17)
    # and it is that wheel in every respect
    fields = {**b, "thickness_allowance": driven.thickness_allowance}
    assert driven.fields() == gear(kernel, **fields).fields()
    given = catalogue_pair(kernel, name, distance, thickness_allowance=driven.thickness_allowance)
    assert given.warnings() == []
    states = [g.outputs(g.start()) for g in (gearbox, given)]
    for output in states[0]:
        np.testing.assert_array_equal(states[0][output], states[1][output])


def test_the_other_meshes_of_a_thinner_wheel_have_more_backlash(kernel: Kernel):
    a, b = CATALOGUE["standard"]
    distance = distance_of_overlap(kernel, a, b, 3e-7)
    wheels = [gear_wheel(**a), gear_wheel(**b), gear_wheel(**a)]
    second = {"driving": 1, "driven": 2, "driving_rotation": 1, "centre_line_angle": 1.0}
    meshes = [
        real(kernel, centre_distance=distance),
        real(kernel, **second, centre_distance=0.0601),
    ]
    gearbox = Gearbox(kernel, wheels, [], meshes)
    assert len(gearbox.warnings()) == 1
    alone = Gearbox(kernel, wheels[1:], [], [real(kernel, centre_distance=0.0601)])
    more = mesh_of(gearbox, 1).backlash - mesh_of(alone, 0).backlash
    assert more == pytest.approx(3e-7, abs=1e-16)
    # a mesh that thins the same wheel again takes only what is left
    meshes[1] = real(
        kernel, driving=2, driven=1, centre_line_angle=np.pi + 1.0, centre_distance=distance - 2e-7
    )
    twice = Gearbox(kernel, wheels, [], meshes)
    assert len(twice.warnings()) == 2
    assert mesh_of(twice, 1).backlash == 0
    assert 0 < mesh_of(twice, 0).backlash < 2e-7


@pytest.mark.parametrize("name", CATALOGUE)
@pytest.mark.parametrize("overlap", [5.01e-7, 1.234e-6, 7.7e-6, 2.3456789e-5, 9.9e-5, 1.2e-4])
def test_the_allowance_that_is_named_makes_the_teeth_fit(kernel: Kernel, name: str, overlap: float):
    distance = distance_of_overlap(kernel, *CATALOGUE[name], overlap)
    with pytest.raises(GearboxError) as caught:
        catalogue_pair(kernel, name, distance)
    error = caught.value
    assert (error.code, error.subject, error.field) == (INVALID_INPUT, MESH, "centre_distance")
    assert "the teeth do not fit" in error.message
    named = re.search(r"teeth of the driven wheel with thickness_allowance (\S+) m$", error.message)
    assert named
    gearbox = catalogue_pair(kernel, name, distance, thickness_allowance=float(named[1]))
    assert gearbox.warnings() == []
    # the sixth digit of the allowance is the largest backlash that is left
    assert 0 <= mesh_of(gearbox, 0).backlash < 1.1e-5 * abs(float(named[1]))


def test_no_allowance_is_named_where_none_makes_the_teeth_fit(kernel: Kernel):
    """The gears are a millimetre too close: their tips run into the roots."""
    with pytest.raises(GearboxError) as caught:
        catalogue_pair(kernel, "standard", 0.059)
    assert "the teeth do not fit" in caught.value.message
    assert "thickness_allowance" not in caught.value.message


# ---- allowed, with a warning


def warnings(kernel: Kernel, wheels: list[Any], **given: Any) -> list[Warned]:
    return Gearbox(kernel, wheels, [], [real(kernel, **given)]).warnings()


def test_a_thin_tip_is_a_warning(kernel: Kernel) -> None:
    (warning,) = warnings(kernel, [gear_wheel(40), gear_wheel(14, profile_shift=0.75)])
    assert (warning.subject, warning.index, warning.field) == (WHEEL, 1, "")
    assert warning.message.startswith("the tooth is ")
    assert "less than 0.2 modules" in warning.message


def test_a_contact_ratio_below_1_is_a_warning(kernel: Kernel) -> None:
    wheels = [gear_wheel(20), gear_wheel(40)]
    assert warnings(kernel, wheels) == []
    (warning,) = warnings(kernel, wheels, centre_distance=0.0618)
    assert (warning.subject, warning.index, warning.field) == (MESH, 0, "")
    assert warning.message.startswith("its contact ratio is 0.")


@pytest.mark.parametrize(("change", "fits"), [(1e-10, True), (1e-8, False), (1e-4, False)])
def test_base_pitches_that_differ_by_more_than_rounding_do_not_mesh(
    kernel: Kernel, change: float, fits: bool
) -> None:
    """1e-9 is the same length, src/geometry/gear.f90; a tenth of a micrometre in a metre is not."""
    wheels = [gear_wheel(20), gear_wheel(30, module=0.002 * (1 + change))]
    if fits:
        Gearbox(kernel, wheels, [], [real(kernel)])
    else:
        assert "base pitch" in refusal(kernel, wheels, [real(kernel)]).message


@pytest.mark.parametrize("short", [0, 1], ids=["driving", "driven"])
def test_teeth_that_end_below_their_pitch_circle_never_meet_at_the_pitch_point(
    kernel: Kernel, short: int
) -> None:
    """Short teeth of the driving wheel leave approach alone, of the driven one recess alone."""

    def warned(alteration: float) -> bool:
        given = [{"tip_alteration": alteration} if i == short else {} for i in (0, 1)]
        wheels = [gear_wheel(40, module=0.002, **given[i]) for i in (0, 1)]
        gearbox = Gearbox(kernel, wheels, [], [real(kernel)])
        return any("does not contain the pitch" in w.message for w in gearbox.warnings())

    # the addendum is 1 module; the pitch circle is the reference circle but for the backlash
    assert not warned(-0.9)
    assert warned(-1.1)
