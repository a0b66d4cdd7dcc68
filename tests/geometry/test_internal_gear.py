"""Internal gears: geometry against independent numbers, root, interference and its remedy."""

from __future__ import annotations

import re
from typing import Any

import numpy as np
import pytest

from kernel.gears import GearGeometry, gear, gear_mesh, mesh_geometry
from kernel.kernel import Kernel, KernelError

PRINTED = 1e-9  # the given numbers have ten digits


def ring(kernel: Kernel, teeth: int, module: float, **given: Any) -> GearGeometry:
    rack = {"rack_addendum": 1.0} | given
    return gear(kernel, teeth, module, internal="true", **rack)


# Independent numpy programs; lengths in mm. The pair: teeth, module, shifts, tip diameters (None:
# addendum 1), centre distance or backlash (neither: tight). Radii of curvature as diameters.
GIVEN: dict[str, tuple[dict[str, Any], dict[str, Any]]] = {
    "16/24": (
        {"teeth": (16, 24), "m": 3.0, "x": (0.0, -0.5)},
        {
            "angle": 31.09362066,
            "a": -13.16826771,
            "line": -6.800593687,
            # undercut shortens its path of contact, which the other program does not do
            "active": (None, 80.32275074),
            "form": (45.10859621, 82.02381139),
            "tip": (54.0, -69.0),
            "root": (40.5, -82.5),
            "thickness": (1.99710254, 2.621377387),
            "clearance": (1.081732293, 1.081732293),
        },
    ),
    "17/56": (
        {
            "teeth": (17, 56),
            "m": 45.0,
            "x": (0.802, -0.501),
            "tips": (905.458, 2475.09),
            "a": 863.0,
        },
        {
            "angle": 17.1606551,
            "a": -863.0,
            "line": -254.6298696,
            "path": 169.8529761,
            "ratio": 1.278571318,
            "backlash": -5.376833695,
            "active": (749.1428958, 2594.360566),
            "form": (748.7847526, None),
            "tip": (905.458, -2475.09),
            "root": (724.68, -2677.59),
            "thickness": (26.59197538, 38.40855878),
            "clearance": (12.205, 23.066),
        },
    ),
    "35/98, tip circle 290": (
        {"teeth": (35, 98), "m": 3.0, "x": (0.0, 0.0), "tips": (None, 290.0)},
        {
            "angle": 20.0,
            "a": -94.5,
            "line": -32.32090354,
            "path": 13.65745567,
            "ratio": 1.542101131,
            "active": (101.4356975, 299.43809),
            "form": (100.3631985, 300.1030884),
            "tip": (111.0, -290.0),
            "root": (97.5, -301.5),
            "thickness": (2.251507838, 3.289795453),
            "clearance": (1.75, 0.75),
        },
    ),
    "35/98, backlash": (
        {"teeth": (35, 98), "m": 3.0, "x": (0.2, -0.1), "backlash": 0.06},
        {
            "angle": 19.33013711,
            "a": -94.10599229,
            "line": -31.15009776,
            "path": 16.13083094,
            "ratio": 1.82137678,
            "active": (100.9104821, 299.5257757),
            "form": (101.0642633, 300.7131032),
            "tip": (112.2, -288.6),
            "root": (98.7, -302.1),
            "thickness": (2.10501963, 2.625626774),
            "clearance": (0.8440077103, 0.8440077103),
        },
    ),
}


def pair(
    kernel: Kernel, teeth: tuple[int, int], m: float, x: tuple[float, float], **given: Any
) -> tuple[GearGeometry, GearGeometry]:
    tips = given.get("tips", (None, None))
    wheels = []
    for maker, z, shift, tip in zip((gear, ring), teeth, x, tips, strict=True):
        more = {} if tip is None else {"tip_diameter": tip * 1e-3}
        wheels.append(maker(kernel, z, m * 1e-3, profile_shift=shift, **more))
    return wheels[0], wheels[1]


@pytest.mark.parametrize("name", GIVEN)
def test_geometry_agrees_with_an_independent_program(kernel: Kernel, name: str) -> None:
    case, expected = GIVEN[name]
    pinion, annulus = pair(kernel, **case)
    # the geometry alone, at the printed centre distance: also of pairs that are refused
    mesh = mesh_geometry(kernel, pinion, annulus, case.get("a", -expected["a"]) * 1e-3)
    if case.keys() <= {"teeth", "m", "x", "tips"}:  # a tight pair, to all digits
        mesh = mesh_geometry(kernel, pinion, annulus, -mesh.tight_distance)
    found = {
        "angle": np.degrees(mesh.working_pressure_angle),
        "a": mesh.centre_distance * 1e3,
        "line": mesh.line_of_action * 1e3,
        "path": mesh.path_of_contact * 1e3,
        "ratio": mesh.contact_ratio,
        "backlash": mesh.backlash * 1e6,
        "active": (2e3 * mesh.active_radius_a, -2e3 * mesh.active_radius_b),
        "form": (2e3 * pinion.form_radius, -2e3 * annulus.form_radius),
        "tip": (2e3 * pinion.tip_radius, 2e3 * annulus.tip_radius),
        "root": (2e3 * pinion.root_radius, 2e3 * annulus.root_radius),
        "thickness": (1e3 * pinion.tip_thickness, 1e3 * annulus.tip_thickness),
        "clearance": (1e3 * mesh.clearance_a, 1e3 * mesh.clearance_b),
    }
    for key, value in expected.items():
        # a printed centre distance leaves 1e-9 of it in the angle and the path
        loose = 30 * PRINTED if key in ("angle", "line", "path", "ratio", "active") else PRINTED
        absolute = 1e-4 if key == "backlash" else 0.0
        for one, wanted in zip(np.atleast_1d(found[key]), np.atleast_1d(value), strict=True):
            if wanted is not None:
                assert one == pytest.approx(wanted, rel=loose, abs=absolute), key


@pytest.mark.parametrize(
    ("teeth", "module", "shift", "largest", "form"),
    [
        (24, 3.0, -0.5, 0.5421234021, 82.02381139),
        (56, 45.0, -0.501, 15.93035748, None),
        (98, 3.0, 0.0, 1.342443446, None),
    ],
)
def test_a_wide_arc_at_the_root_is_the_full_round(
    kernel: Kernel, teeth: int, module: float, shift: float, largest: float, form: float | None
) -> None:
    wide = ring(kernel, teeth, module * 1e-3, profile_shift=shift, rack_root_radius=3.0)
    assert wide.fillet_radius * 1e3 == pytest.approx(largest, rel=PRINTED)
    if form is not None:
        assert -2e3 * wide.form_radius == pytest.approx(form, rel=PRINTED)


def test_the_arc_touches_the_root_circle_and_the_involute(kernel: Kernel) -> None:
    for teeth, shift, q in ((40, -0.3, 0.2), (98, 0.0, 0.38), (200, -0.8, 0.1)):
        made = ring(kernel, teeth, 2e-3, profile_shift=shift, rack_root_radius=q)
        base, root, radius = -made.base_radius, -made.root_radius, made.fillet_radius
        assert radius == pytest.approx(q * 2e-3, rel=1e-14)
        form = np.sqrt(made.form_radius**2 - base**2)
        # centre of the arc: on the involute's normal at its end, and q inside the root circle
        centre = np.hypot(base, form - radius)
        assert centre + radius == pytest.approx(root, rel=1e-12)


def test_default_addendum_of_a_ring(kernel: Kernel) -> None:
    made = gear(kernel, 98, 3e-3, internal="true", rack_addendum=0.8)
    assert -2 * made.tip_radius == pytest.approx(0.294 - 2 * 0.8 * 0.003, rel=1e-14)


REFUSED: dict[str, tuple[dict[str, Any], str, float | None]] = {
    # smallest tip diameters: independent program, 288.4715670, 69.12189925 and 36.85944659 mm
    "undercut": ({"teeth": (16, 24), "m": 3.0, "x": (0.0, -0.5)}, "undercut", 69.12189925),
    "fillet": ({"teeth": (35, 98), "m": 3.0, "x": (0.0, 0.0)}, "fillet interference", 288.471567),
    "fouling": ({"teeth": (32, 38), "m": 1.0, "x": (0.0, 0.0)}, "", 36.85944659),
}


@pytest.mark.parametrize("name", REFUSED)
def test_interference_is_refused_with_the_smallest_tip_that_fits(kernel: Kernel, name: str) -> None:
    case, reason, fits = REFUSED[name]
    pinion, annulus = pair(kernel, **case)
    with pytest.raises(KernelError) as refused:
        gear_mesh(kernel, pinion, annulus)
    message = str(refused.value)
    assert reason in message
    named = float(re.search(r"that fits is ([\d.]+) m", message)[1]) * 1e3  # type: ignore[index]
    assert fits is not None
    assert 0 <= named - fits <= 1.1e-5 * fits, "rounded up in the sixth digit"
    # with the named tip the pair runs, with a slightly smaller one it does not
    good = pair(kernel, **case, tips=(None, named))
    gear_mesh(kernel, *good)
    with pytest.raises(KernelError):
        gear_mesh(kernel, *pair(kernel, **case, tips=(None, fits * (1 - 1e-6))))


def test_a_long_pinion_is_refused_at_the_root_of_the_ring(kernel: Kernel) -> None:
    wheels = pair(kernel, (35, 98), 3.0, (0.0, 0.0), tips=(113.0, 290.0))
    with pytest.raises(KernelError, match=r"runs into the .* below ([\d.]+) m") as refused:
        gear_mesh(kernel, *wheels)
    below = float(re.search(r"below ([\d.]+) m", str(refused.value))[1]) * 1e3  # type: ignore[index]
    # hypot(r_bA, |rho_Ff| - |rho|), independent program
    assert below == pytest.approx(111.7952756, rel=1e-5)
    gear_mesh(kernel, *pair(kernel, (35, 98), 3.0, (0.0, 0.0), tips=(below - 1e-3, 290.0)))


def test_a_larger_centre_distance_closes_an_internal_pair(kernel: Kernel) -> None:
    wheels = pair(kernel, (35, 98), 3.0, (0.0, 0.0), tips=(None, 290.0))
    wide = gear_mesh(kernel, *wheels, centre_distance=94.4e-3)
    tight = gear_mesh(kernel, *wheels, centre_distance=94.45e-3)
    assert wide.backlash > tight.backlash > 0
    with pytest.raises(KernelError, match="do not fit at the centre distance"):
        gear_mesh(kernel, *wheels, centre_distance=94.6e-3)


def test_swapped_wheels_have_the_same_mesh(kernel: Kernel) -> None:
    pinion, annulus = pair(kernel, (35, 98), 3.0, (0.1, 0.0), tips=(None, 290.0))
    one, other = gear_mesh(kernel, pinion, annulus), gear_mesh(kernel, annulus, pinion)
    for name in ("centre_distance", "line_of_action", "contact_ratio", "backlash", "base_pitch"):
        assert getattr(one, name) == getattr(other, name), name
    assert (one.approach, one.recess) == (other.recess, other.approach)
    assert (one.clearance_a, one.clearance_b) == (other.clearance_b, other.clearance_a)


@pytest.mark.parametrize("teeth", [(35, 35), (98, 35)])
def test_too_small_a_difference_of_teeth_is_refused(kernel: Kernel, teeth: tuple[int, int]) -> None:
    wheels = gear(kernel, teeth[0], 3e-3), ring(kernel, teeth[1], 3e-3, rack_addendum=0.8)
    with pytest.raises(KernelError, match="needs a mate with fewer teeth"):
        gear_mesh(kernel, *wheels)


def test_two_rings_are_refused(kernel: Kernel) -> None:
    one = ring(kernel, 98, 3e-3, rack_addendum=0.8)
    with pytest.raises(KernelError, match="both internal"):
        gear_mesh(kernel, one, one)


@pytest.mark.parametrize(
    ("given", "field", "words"),
    [
        ({"bore": 0.02}, "bore", "has no bore; give 'rim_diameter'"),
        ({"rim_diameter": 0.300}, "rim_diameter", "greater than the root diameter"),
        ({"tip_diameter": 0.27}, "tip_diameter", "inside the base circle"),
        ({"tip_diameter": 0.3009}, "tip_diameter", "outside the form circle"),
    ],
)
def test_rings_that_cannot_be_made(
    kernel: Kernel, given: dict[str, Any], field: str, words: str
) -> None:
    with pytest.raises(KernelError) as refused:
        ring(kernel, 98, 3e-3, **given)
    assert words in str(refused.value)
    assert refused.value.field == field  # type: ignore[attr-defined]


def test_a_rim_needs_an_internal_gear(kernel: Kernel) -> None:
    with pytest.raises(KernelError, match="a rim diameter is that of an internal gear"):
        gear(kernel, 30, 2e-3, rim_diameter=0.1)
