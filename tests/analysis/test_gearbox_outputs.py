"""Table of outputs and their values; names of states; geometry."""

from __future__ import annotations

import re

import numpy as np
import pytest

from kernel.gearbox import LOADED, TRACKED, Gearbox
from kernel.gearbox_cases import PAIRS, chain, in_mode, paper_gearbox, prescribed, scatter
from kernel.gearbox_description import (
    ALGEBRAIC,
    CLOSED_FORM,
    DIFFERENTIAL,
    TORQUE,
    load,
    mesh,
    wheel,
)
from kernel.housing import Housing, Pair
from kernel.kernel import CONTACT, Kernel

TRACKINGS = pytest.mark.parametrize("tracking", [CLOSED_FORM, ALGEBRAIC, DIFFERENTIAL])
# documented in docs/reference/result_format.md, besides the time
PROMISED = {
    *("teeth", "base_radius", "inertia", "working_pressure_angle", "base_pitch", "flank"),
    *("reference_angle", "reference_turns", "kinetic_energy", "potential_energy"),
    *("dissipated_energy", "load_work", "angle", "angle_deviation", "angular_velocity"),
    *("load_torque", "centre_displacement", "centre_velocity", "transmission_error"),
    *("penetration", "gap", "normal_force", "friction_force", "sliding_velocity"),
    *("gradient_ratio", "tooth_pair", "in_contact", "contact_point_driving"),
    "contact_point_driven",
}
UNITS = {
    *("1", "rad", "rad s-1", "rad s-2", "m", "m s-1", "m s-2", "m2", "kg", "kg m2"),
    *("K", "N", "N m", "J", "Pa", "W", "N m rad-1", "N m s rad-1", "N m-1", "N s m-1", "Hz"),
}


@pytest.mark.parametrize("n", [2, 4])
def test_the_table_covers_the_values_without_gap_or_overlap(kernel: Kernel, n: int):
    gearbox = chain(kernel, n, DIFFERENTIAL)
    counts = {0: 1, 1: n, 2: n - 1, 3: 2 * n, 4: 2 * (n - 1), 5: 0, 6: 0, 7: 3 * n}
    counts |= {8: n - 1, 9: 0, 13: 0}  # one tooth pair slot, no shafts, no accelerometers
    assert gearbox.sizes.n_pair_slots == gearbox.sizes.n_drive_slots == 1
    offset = 0
    for entry in gearbox.table:
        assert entry.offset == offset, entry.name
        # these flanks are never in contact, the housing is at rest, and no load is a loss
        absent = (b"coast_", b"mount_", b"load_loss", b"root_stress_")
        there = not entry.name.startswith(absent) and not entry.name.endswith(b"_temperature")
        assert entry.count == there * counts[entry.dims], entry.name
        offset += entry.count
    assert offset == gearbox.sizes.n_values


def test_names_are_unique_netcdf_names_and_units_are_udunits(kernel: Kernel):
    table = paper_gearbox(kernel).table
    names = [entry.name.decode() for entry in table]
    assert len(set(names)) == len(names)
    assert set(names) >= PROMISED
    for entry in table:
        assert re.fullmatch(r"[a-z][a-z0-9_]*", entry.name.decode())
        assert entry.units.decode() in UNITS
        assert entry.long_name
        if entry.is_integer:
            assert entry.units == b"1"


@TRACKINGS
def test_integers_are_whole_and_static_values_never_change(kernel: Kernel, tracking: str):
    gearbox = chain(kernel, 4, tracking)
    random = np.random.default_rng(1)
    first = gearbox.outputs(gearbox.start())
    for _ in range(5):
        values = gearbox.outputs(in_mode(gearbox, random, (LOADED, 1)))
        for entry in gearbox.table:
            name = entry.name.decode()
            if entry.count == 0:
                continue
            if entry.is_integer:
                np.testing.assert_array_equal(values[name], np.round(values[name]))
            if entry.is_static:
                np.testing.assert_array_equal(values[name], first[name])
            elif tracking != CLOSED_FORM:
                assert np.isfinite(values[name]).all(), name


OF_GEARS = ("root_radius", "form_radius", "tooth_angle", "backlash")


def test_what_is_not_computed_is_nan_and_never_zero(kernel: Kernel):
    """The paper's wheels have no basic rack, no relief, no coast flanks and no tracked points."""
    gearbox = paper_gearbox(kernel, tracking=CLOSED_FORM)
    values = gearbox.outputs(in_mode(gearbox, np.random.default_rng(2), (LOADED, 1)))
    nan = {name for name, some in values.items() if np.isnan(some).any()}
    assert nan == {
        "gradient_ratio",
        *(f"tracking_residual_{w}" for w in ("driving", "driven")),
        *(f"line_distance_{w}" for w in ("driving", "driven")),
        *(f"{end}_relief_start" for end in ("tip", "root")),
        *OF_GEARS,
    }


@pytest.mark.parametrize("tracked", [ALGEBRAIC, DIFFERENTIAL])
@pytest.mark.parametrize("first", [True, False], ids=["first", "last"])
def test_a_mesh_reports_nothing_of_its_neighbour_s_tracking(
    kernel: Kernel, tracked: str, first: bool
):
    """A mesh in closed form before or after a tracked one has no tracked point."""
    gearbox = chain(kernel, 3, *((tracked, CLOSED_FORM) if first else (CLOSED_FORM, tracked)))
    values = gearbox.outputs(in_mode(gearbox, np.random.default_rng(4), (LOADED, 1)))
    ends = ("driving", "driven")
    for kind in ("gradient_ratio", "tracking_residual", "line_distance"):
        for name in [kind] if kind in values else [f"{kind}_{end}" for end in ends]:
            empty = np.isnan(values[name]).reshape(2, -1)
            assert empty[int(first)].all(), name
            assert not empty[int(not first)].any(), name


@TRACKINGS
def test_the_paper_s_start(kernel: Kernel, tracking: str):
    """Section 7.1 of the paper: at rest, contact of the teeth at a, the start of contact."""
    gearbox = paper_gearbox(kernel, tracking=tracking)
    o = gearbox.outputs(gearbox.start())
    alpha = 1.05 * np.arctan(2 * np.pi / 50)
    r_b = np.array([0.2, 0.3]) * np.cos(alpha)
    rho, pitch = 0.5 * np.sin(alpha), r_b[0] * np.pi / 10
    mass = 7800 * np.pi * np.array([0.2, 0.3]) ** 2 * 0.1
    expected = {
        "teeth": [20, 30],
        "pitch_radius": [0.2, 0.3],
        "base_radius": r_b,
        "mass": mass,
        "inertia": mass * np.array([0.2, 0.3]) ** 2 / 2,
        "centre": [[0, 0], [0.5, 0]],
        "driving_wheel": [0],
        "driven_wheel": [1],
        "flank": [1],
        "tracking": [(CLOSED_FORM, ALGEBRAIC, DIFFERENTIAL).index(tracking)],
        "centre_line_angle": [0],
        "working_pressure_angle": [alpha],
        "base_pitch": [pitch],
        "line_of_action_length": [rho],
        "rho_start_driving": [(rho - pitch) / 2],
        "rho_start_driven": [(rho + pitch) / 2],
        "common_width": [0.1],
        "effective_modulus": [2e11 / (1 - 0.09) / 2],
        "elastic_share_driving": [0.5],
        "reference_force": [1 / r_b[0]],
        "angular_acceleration": [-1 / (mass[0] * 0.02), 0],
        "load_torque": [-1, 0],
        "friction_arm_driving": [(rho - pitch) / 2],
        "friction_arm_driven": [(rho + pitch) / 2],
        "contact_mode": [LOADED],
    }
    zeros = [
        *("reference_angle", "reference_turns", "kinetic_energy", "potential_energy"),
        *("dissipated_energy", "load_work", "angle", "angle_deviation", "angular_velocity"),
        *("centre_displacement", "centre_velocity", "transmission_error", "penetration", "gap"),
        *("separation_curvature", "normal_force", "friction_force", "sliding_velocity"),
        *("tooth_pair", "in_contact"),
    ]
    for name, values in expected.items():
        np.testing.assert_allclose(o[name], values, rtol=4e-15, atol=1e-16, err_msg=name)
    for name in zeros:
        np.testing.assert_array_equal(o[name], 0, err_msg=name)
    # as printed in the paper, or computed from its printed values
    assert np.degrees(o["working_pressure_angle"][0]) == pytest.approx(7.52058, abs=5e-6)
    assert o["line_of_action_length"][0] == pytest.approx(0.065441, abs=5e-7)
    assert o["base_pitch"][0] == pytest.approx(0.062291, abs=5e-7)
    assert o["tip_radius"] == pytest.approx([0.208312, 0.304199], abs=5e-7)
    k_a = r_b[0] * np.array([np.cos(alpha), np.sin(alpha)])
    a = k_a + (rho - pitch) / 2 * np.array([np.sin(alpha), -np.cos(alpha)])
    for name in ("driving", "driven"):
        np.testing.assert_allclose(o[f"contact_point_{name}"][0], a, rtol=0, atol=1e-16)
    if tracking != CLOSED_FORM:
        assert o["gradient_ratio"][0] == pytest.approx(-1.5, rel=4e-16)
        for name in ("tracking_residual", "line_distance"):
            assert abs(o[f"{name}_driving"][0]) == abs(o[f"{name}_driven"][0]) == 0


@pytest.mark.parametrize("pair", PAIRS.values(), ids=PAIRS.keys())
@pytest.mark.parametrize("seed", range(4))
def test_transmission_error_is_the_lag_of_the_driven_wheel(kernel: Kernel, pair: Pair, seed: int):
    """Delta = -sigma (r_bA Dphi_A + r_bB Dphi_B - R Dchi) = h + R (inv alpha - inv alpha_0)."""
    random = np.random.default_rng(seed)
    gearbox = pair.gearbox(kernel)
    state = scatter(gearbox, random)
    at = Housing(pair, gearbox, state)
    o = gearbox.outputs(state)
    delta, h = o["transmission_error"][0], -o["gap"][0]
    assert o["penetration"][0] == max(h, 0)
    # both are 1e-6 m; difference formulas are accurate to 1e-15 of their operands
    assert delta == pytest.approx(h + o["separation_curvature"][0], abs=1e-19)
    c = at.centre_line
    chi = np.arctan2(float(c[1]), float(c[0])) - pair.chi
    chi -= 2 * np.pi * np.round(chi / (2 * np.pi))
    r_b = [float(r) for r in pair.base_radii]
    turned = float(sum(r * at.turn(i) for i, r in enumerate(pair.base_radii)))
    # chi is rounded here to 1e-16
    assert delta == pytest.approx(-pair.sigma * (turned - sum(r_b) * chi), abs=1e-15)
    np.testing.assert_allclose(o["angle"], [float(at.turn(i)) for i in (0, 1)], rtol=1e-14)
    speeds = [float(at.omega(i)) for i in (0, 1)]
    np.testing.assert_allclose(o["angular_velocity"], speeds, rtol=1e-15)


def test_potential_energy_is_that_of_contacts_and_springs(kernel: Kernel):
    gearbox = paper_gearbox(kernel)
    state = gearbox.start(0, gaps=[-1e-6])
    contact = gearbox.outputs(state)["potential_energy"][0]
    h = gearbox.outputs(state)["penetration"][0]
    geometry = gearbox.mesh_geometry()
    rho = (geometry.line_of_action_length + h) / 2  # of either wheel: only their sum is relevant
    arguments = {"rho_a": rho, "rho_b": rho, "width": geometry.common_width}
    law = kernel.law(CONTACT, "johnson")
    of_law = kernel.law_elastic_potential(law, h=h, e_star=geometry.effective_modulus, **arguments)
    assert contact == pytest.approx(of_law.potential[0], rel=1e-13)
    gearbox.mode(state)[1] = 0
    state.y[gearbox.index("displacement_1")] = 2e-4
    assert gearbox.outputs(state)["potential_energy"][0] == pytest.approx(0.5 * 1e9 * 4e-8)


def test_states_have_names_of_their_own_with_units(kernel: Kernel):
    gearbox = chain(kernel, 4, DIFFERENTIAL)
    assert len(set(gearbox.names)) == len(gearbox.names)
    units = {
        "turn": "rad",
        "zeta": "m",
        "dr_t": "m",
        "dr_e": "m",
        "gradient_ratio": "1",
        "mu": "m2",
    }
    assert tuple(units) == TRACKED
    for m in range(3):
        for name, unit in units.items():
            assert gearbox.units[gearbox.index(f"{name}_{m}")] == unit
    assert gearbox.names[:2] == ["reference_angle", "reference_speed"]
    assert gearbox.names[-2:] == ["dissipated_energy", "load_work"]
    assert set(gearbox.units) <= UNITS
    assert gearbox._name(-1) == gearbox._name(len(gearbox.names)) == ("", "")


def test_scales_are_positive_and_only_algebraic_points_are_algebraic(kernel: Kernel):
    for tracking in (CLOSED_FORM, ALGEBRAIC, DIFFERENTIAL):
        for gearbox in (chain(kernel, 3, tracking), prescribed(kernel, tracking)):
            state, row = gearbox.scales()
            assert np.isfinite(state).all()
            assert np.isfinite(row).all()
            assert (state > 0).all()
            assert (row > 0).all()
            start = gearbox.start()
            of_rates = gearbox.jacobian(start, 1.0) - gearbox.jacobian(start, 0.0)  # dF/dy'
            algebraic = {n for n, of in zip(gearbox.names, of_rates.T, strict=True) if not of.any()}
            expected = (
                {f"{n}_{m}" for n in TRACKED for m in range(gearbox.sizes.n_meshes)}
                if tracking == ALGEBRAIC
                else set()
            )
            assert algebraic == expected


def test_geometry_of_wheels_and_meshes_is_that_of_each_pair(kernel: Kernel):
    gearbox = chain(kernel, 4, CLOSED_FORM)
    teeth = (20, 33, 27, 20)
    for m in range(3):
        geometry = gearbox.mesh_geometry(m)
        a, b = gearbox.wheel_geometry(m), gearbox.wheel_geometry(m + 1)
        pair = kernel.spur_pair(
            teeth[m],
            teeth[m + 1],
            a.pitch_radius,
            0.35,
            chi=0.5 - 1.1 * m,
            sigma=(-1) ** m,
            centre_a=list(a.centre),
        )
        assert geometry.sigma == (-1) ** m
        for name, value in {
            "centre_distance": pair.centre_distance,
            "minimum_pressure_angle": pair.alpha_inf,
            "working_pressure_angle": pair.alpha_w,
            "base_pitch": pair.base_pitch,
            "line_of_action_length": pair.rho,
            "transmission_ratio": pair.ratio,
            "contact_ratio": 1.0,
        }.items():
            assert getattr(geometry, name) == pytest.approx(value, rel=1e-14), name
        for name in ("point_k_a", "point_k_b", "point_a", "point_b", "pitch_point"):
            np.testing.assert_allclose(getattr(geometry, name), getattr(pair, name), atol=1e-15)
        assert list(b.centre) == pytest.approx(list(pair.centre_b), abs=1e-15)
        assert b.base_radius == pytest.approx(pair.base_radius_b, rel=1e-14)
        assert b.speed_ratio == pytest.approx((-1) ** (m + 1) * 20 / teeth[m + 1], rel=1e-15)
        assert b.tip_radius >= pair.tip_radius_b * (1 - 1e-15)
        assert not b.is_reference
    assert gearbox.wheel_geometry(0).is_reference


def test_mass_and_inertia_are_those_given_or_of_a_solid_disc(kernel: Kernel):
    wheels = [
        wheel(teeth=20, pitch_radius=0.2, inertia=3.5),
        wheel(teeth=30, mass=12.0),
    ]
    gearbox = Gearbox(kernel, wheels, [load(1, TORQUE, 1.0)], [mesh(kernel)])
    one, two = gearbox.wheel_geometry(0), gearbox.wheel_geometry(1)
    assert (one.mass, one.inertia) == (pytest.approx(7800 * np.pi * 0.04 * 0.1), 3.5)
    assert (two.mass, two.inertia) == (12.0, pytest.approx(12 * 0.09 / 2))
