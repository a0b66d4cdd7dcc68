"""Reported geometry of a gearbox, row by row, against the data of its components."""

from __future__ import annotations

import math
from typing import Any

import pytest

from kernel.gearbox import OF_DEVIATION, OF_GEAR, OF_GEAR_MESH, OF_MESH, OF_WHEEL, Gearbox
from kernel.gearbox_cases import paper_gearbox
from kernel.gears import gear_of, mesh_of
from kernel.kernel import Kernel
from kernel.real_cases import PAIRS, made

#: Rows that are no field of the component: the corresponding field, and the factor.
FIELDS = {
    "flank": ("sigma", 1),
    "bore": ("bore_radius", 2),
    "pitch_diameter_driving": ("pitch_radius_a", 2),
    "pitch_diameter_driven": ("pitch_radius_b", 2),
    "active_diameter_driving": ("active_radius_a", 2),
    "active_diameter_driven": ("active_radius_b", 2),
    "reference_centre_distance": ("reference_distance", 1),
    "tight_centre_distance": ("tight_distance", 1),
    "tip_clearance_driving": ("clearance_a", 1),
    "tip_clearance_driven": ("clearance_b", 1),
}
#: Rows whose field is computed in another way: from the points of the path of contact.
ROUNDED = {"contact_ratio": 1e-14}
OF_TEETH = ("reference", "base", "tip", "tip_form", "root", "form")


def check(reported: dict[str, Any], part: Any, left_out: set[str]) -> None:
    """Check that every row is a field, to the bit, and every field is a row."""
    by_radius = {f"{name}_diameter": (f"{name}_radius", 2) for name in OF_TEETH}
    seen = set()
    for name, value in reported.items():
        field, factor = {**by_radius, **FIELDS}.get(name, (name, 1))
        expected = getattr(part, field)
        seen.add(field)
        if isinstance(value, list):
            assert value == list(expected)
        else:
            rounding = ROUNDED.get(name, 0)
            assert value == pytest.approx(factor * expected, rel=rounding, abs=0, nan_ok=True), name
    assert {name for name, *_ in part._fields_} - seen == left_out


def check_wheels_and_meshes(gearbox: Gearbox, gives_way: float) -> None:
    for i in range(gearbox.sizes.n_wheels):
        reported = gearbox.quantities(OF_WHEEL, i)
        check(reported, gearbox.wheel_geometry(i), {"is_reference"})
    for i in range(gearbox.sizes.n_meshes):
        reported = gearbox.quantities(OF_MESH, i)
        # no field: 0 for gears with Johnson's contact alone; not reported for others
        assert reported.pop("gives_way") == pytest.approx(gives_way, rel=0, abs=0, nan_ok=True)
        check(reported, gearbox.mesh_geometry(i), set())


def test_the_rows_of_real_gears_are_what_the_parts_have(kernel: Kernel) -> None:
    gearbox, _ = made(kernel, PAIRS["every deviation"], 0.0, 0)
    check_wheels_and_meshes(gearbox, gives_way=0.0)
    for i in range(2):
        check(
            gearbox.quantities(OF_GEAR, i),
            gear_of(gearbox, i),
            {"is_undercut", "tool_depth", "tool_rounding"}
            | {"rack_addendum", "rack_dedendum", "rack_root_radius"}
            | {"span_teeth", "ball_diameter"}
            # of internal gears only
            | {"is_internal", "rim_radius", "fillet_radius"}
            | {"cutter_teeth", "cutter_shift", "cutter_tip_radius", "cutter_rounding"},
        )
        assert gearbox.quantities(OF_DEVIATION, i)
    left_out = {"base_radius_sum", "rho_tip_a", "rho_tip_b", "rho_end_a", "rho_end_b", "exists"}
    reported = gearbox.quantities(OF_GEAR_MESH, 0)
    mesh = mesh_of(gearbox, 0)
    # no field: Ohlendorf's tooth loss factor, from the shares of the path of contact
    loss_factor = reported.pop("loss_factor")
    pitch_point = mesh.line_of_action / (1 + gear_of(gearbox, 1).teeth / gear_of(gearbox, 0).teeth)
    approach, recess = (
        (length - way) / mesh.base_pitch
        for length, way in (
            (mesh.rho_end_b, mesh.line_of_action - pitch_point),
            (mesh.rho_end_a, pitch_point),
        )
    )
    teeth = sum(1 / gear_of(gearbox, i).teeth for i in range(2))
    shape = 1 - approach - recess + approach**2 + recess**2
    assert loss_factor == pytest.approx(math.pi * teeth * shape, rel=1e-9)
    check(reported, mesh, left_out)


def test_a_pair_stated_by_its_pressure_angle_has_no_rows_of_real_gears(kernel: Kernel) -> None:
    gearbox = paper_gearbox(kernel)
    check_wheels_and_meshes(gearbox, gives_way=math.nan)
    for of in (OF_GEAR, OF_GEAR_MESH, OF_DEVIATION):
        assert gearbox.quantities(of, 0) == {}
