"""Static analysis of a mesh of a gearbox: results of another program, closed forms."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
import pytest

from kernel.compliant import Edge, edge_geometry
from kernel.description import Block
from kernel.deviations import deviations, relief
from kernel.gearbox import MESH, Gearbox, GearboxError
from kernel.gearbox_description import EQUILIBRIUM, TORQUE, VISCOUS, load, mesh, wheel
from kernel.gears import gear_description, gear_of
from kernel.kernel import INVALID_INPUT, OUT_OF_DOMAIN, Kernel
from kernel.static import (
    EDGE_DRIVEN,
    EDGE_DRIVING,
    NO_FORCE,
    ON_FLANKS,
    Curve,
    pair_force_at_rest,
    static_curve,
    static_plan,
    table,
)

E, NU, MODULE = 2.06e11, 0.3, 3e-3
ELEMENTS = {"compliance": Block(model="finite_elements")}
RELIEVED = deviations(tip_relief=relief(5e-6, diameter=62e-3))
ANALYTIC = {"compliance": Block(model="analytic")}


def pair(
    kernel: Kernel,
    teeth: tuple[int, int] = (19, 34),
    shift: tuple[float, float] = (0.4, 0.1),
    bore: tuple[float, float] = (25e-3, 40e-3),
    width: float = 24e-3,
    compliance: dict[str, Any] = ELEMENTS,
    deviation: tuple[Block | None, Block | None] = (None, None),
    loads: tuple[Block, ...] = (),
    poisson: tuple[float, float] = (NU, NU),
    youngs: tuple[float, float] = (E, E),
    gear: dict[str, Any] | None = None,
    **fields: Any,
) -> Gearbox:
    """Two gears defined by a basic rack without backlash, wheel 0 driving clockwise."""
    wheels = [
        wheel(
            teeth=teeth[i],
            width=width,
            youngs_modulus=youngs[i],
            poisson_ratio=poisson[i],
            gear={
                **gear_description(MODULE, profile_shift=shift[i], bore=bore[i], **(gear or {})),
                **compliance,
            },
            deviation=deviation[i] or deviations(),
        )
        for i in (0, 1)
    ]
    return Gearbox(kernel, wheels, list(loads), [mesh(kernel, real=True, **fields)])


class Known(NamedTuple):
    """Results of the other program: um, N/(mm um), base pitches."""

    mean: float
    peak_to_peak: float
    secant: tuple[float, float, float]  # of the mesh: least, mean, largest
    tangent: tuple[float, float, float]
    at_start: tuple[float, float]  # h and the share of the later pair
    halfway: tuple[float, float]


FIFTY = {"teeth": (50, 50), "shift": (0.0, 0.0), "bore": (40e-3, 40e-3), "width": 20e-3}
PAIRS = {  # pair, load [N/mm], contact ratio, line of action [m], figures
    "50/50 at 50 N/mm": (
        *(FIFTY, 50, 1.75467328469810),
        Known(
            *(3.783446, 1.16221, (211.7222, 266.7972, 280.8230), (218.1875, 275.1643, 286.4514)),
            *((3.655749, 0.403217), (3.569599, 0.530351)),
        ),
    ),
    "50/50 at 150 N/mm": (
        *(FIFTY, 150, 1.75467328469810),
        Known(
            *(10.922248, 3.24290, (219.0410, 276.1617, 286.9943), (225.9011, 286.3582, 292.8193)),
            *((10.727602, 0.398630), (10.478084, 0.531884)),
        ),
    ),
    "19/34 at 150 N/mm": (
        *({}, 150, 1.49244605260050),
        Known(
            *(9.004218, 3.49702, (325.5053, 411.0128, 476.0199), (338.2282, 430.0609, 489.5356)),
            *((7.734273, 0.399276), (7.812351, 0.583721)),
        ),
    ),
}


@pytest.fixture(scope="module")
def fifty(kernel: Kernel) -> Gearbox:
    return pair(kernel, **FIFTY)


@pytest.fixture(scope="module")
def spur(kernel: Kernel) -> Gearbox:
    return pair(kernel)


def torque_of(gearbox: Gearbox, line_load: float) -> float:
    """Torque of the driving wheel [N m] for a line load [N/m]."""
    geometry = gearbox.mesh_geometry()
    return line_load * geometry.common_width * gearbox.wheel_geometry(0).base_radius


def curve_of(gearbox: Gearbox, line_load: float, points: int = 200) -> Curve:
    return static_curve(gearbox, torque_of(gearbox, line_load), points=points)


@pytest.mark.parametrize(("fields", "load", "ratio", "known"), PAIRS.values(), ids=PAIRS)
def test_curve_is_that_of_the_other_program(
    fields: dict, load: float, ratio: float, known: Known, fifty: Gearbox, spur: Gearbox
):
    """Built from a description; the other program's c is accurate to 1e-4, at the tips to 1e-3."""
    gearbox = fifty if fields else spur
    assert gearbox.mesh_geometry().contact_ratio == pytest.approx(ratio, rel=1e-12)
    curve = curve_of(gearbox, load * 1e3, points=720)
    h = curve.transmission_error
    assert curve.mean_transmission_error * 1e6 == pytest.approx(known.mean, rel=2e-4)
    assert np.ptp(h) * 1e6 == pytest.approx(known.peak_to_peak, rel=5e-4)
    for values, expected in (
        (curve.secant_stiffness, known.secant),
        (curve.tangent_stiffness, known.tangent),
    ):
        found = np.array([values.min(), values.mean(), values.max()]) / 1e6
        assert found == pytest.approx(expected, rel=2e-4)
    shares = curve.of_pair(0, "force_share")
    for position, (expected, share) in ((0, known.at_start), (360, known.halfway)):
        assert h[position] * 1e6 == pytest.approx(expected, rel=6e-4)
        assert shares[position] == pytest.approx(share, rel=1.5e-3)


def exceeds(extreme: float, of_positions: float, by: float = 0.02) -> bool:
    """Whether an extreme, located between positions too, slightly exceeds theirs."""
    rounding = 1e-9 * abs(of_positions)
    return -rounding <= extreme - of_positions <= by * abs(of_positions)


def test_numbers_of_a_torque_are_those_of_its_curve(fifty: Gearbox):
    curve = curve_of(fifty, 150e3)
    geometry = fifty.mesh_geometry()
    h, force = curve.transmission_error, curve.tooth_force
    assert curve.line_load == pytest.approx(150e3, rel=1e-14)
    assert curve.mean_transmission_error == pytest.approx(h.mean(), rel=1e-13)
    assert exceeds(curve.peak_to_peak_transmission_error, np.ptp(h))
    np.testing.assert_allclose(curve.secant_stiffness, force / h, rtol=1e-14)
    loaded = force / (h - curve.free_transmission_error)
    np.testing.assert_allclose(curve.loaded_secant_stiffness, loaded, rtol=1e-13)
    assert curve.mean_secant_stiffness == pytest.approx(loaded.mean(), rel=1e-13)
    assert curve.mean_tangent_stiffness == pytest.approx(curve.tangent_stiffness.mean(), rel=1e-13)
    assert curve.mesh_stiffness_per_width == pytest.approx(
        loaded.mean() / geometry.common_width, rel=1e-13
    )
    np.testing.assert_allclose(
        curve.transmission_error_angle, h / fifty.wheel_geometry(1).base_radius, rtol=1e-14
    )
    np.testing.assert_allclose(
        curve.driving_angle, curve.position * 2 * np.pi / 50, rtol=1e-13, atol=1e-15
    )
    carries = curve.pair_normal_force > 0
    np.testing.assert_array_equal(curve.loaded_pairs, carries.sum(1))
    np.testing.assert_array_equal(carries, curve.pair_contact_kind != NO_FORCE)
    assert curve.loaded_contact_ratio == pytest.approx(carries.sum(1).mean(), rel=1e-13)
    assert exceeds(curve.largest_force_share, curve.force_share.max())
    assert exceeds(curve.largest_contact_pressure, np.nanmax(curve.pair_contact_pressure))
    on_edge = curve.pair_contact_kind > ON_FLANKS
    assert exceeds(curve.largest_edge_force, curve.pair_normal_force[on_edge].max())
    assert exceeds(-curve.smallest_tangent_stiffness, -curve.tangent_stiffness.min())
    assert exceeds(curve.largest_tangent_stiffness, curve.tangent_stiffness.max())
    np.testing.assert_array_equal(curve.force_share, curve.pair_normal_force / force)
    total = curve.pair_normal_force.sum(1)
    # except for the work of loads that move over compliant teeth, 1e-4 of it, and the shorter lever
    # arm of an edge of the driving wheel
    with_edge = (curve.pair_contact_kind == EDGE_DRIVING).any(1)
    np.testing.assert_allclose(total[~with_edge], force, rtol=3e-4)
    np.testing.assert_allclose(total[with_edge], force, rtol=5e-3)


def test_harmonics_are_those_of_the_curve(spur: Gearbox):
    curve = curve_of(spur, 150e3)
    spectrum = 2 * np.fft.rfft(curve.transmission_error) / len(curve.position)
    np.testing.assert_allclose(curve.harmonic_amplitude, np.abs(spectrum[1:11]), rtol=1e-9)
    turned = np.exp(1j * curve.harmonic_phase) * curve.harmonic_amplitude
    np.testing.assert_allclose(turned, spectrum[1:11], rtol=1e-9, atol=1e-12 * abs(spectrum[1]))


def test_pair_moves_on_from_place_to_place(fifty: Gearbox):
    """Forces and positions of a pair are continuous into its slot one pitch ahead."""
    curve = curve_of(fifty, 150e3, points=400)
    step = fifty.mesh_geometry().base_pitch / 400
    for name, most in (("pair_normal_force", 200.0), ("pair_position", 1.05 * step)):
        path = getattr(curve, name).T.reshape(-1)
        assert np.nanmax(np.abs(np.diff(path))) < most
    share = curve.force_share.T.reshape(-1)
    assert share[0] == share[-1] == 0
    inside = (share > 0).nonzero()[0]
    assert (np.diff(inside) == 1).all()
    assert len(inside) / 400 == pytest.approx(curve.loaded_contact_ratio, rel=1e-12)


def test_pair_begins_and_ends_on_edges(fifty: Gearbox):
    kinds = curve_of(fifty, 150e3).pair_contact_kind.T.reshape(-1)
    order = [int(kinds[0])]
    for kind in kinds:
        if kind != order[-1]:
            order.append(int(kind))
    assert order == [NO_FORCE, EDGE_DRIVEN, ON_FLANKS, EDGE_DRIVING, NO_FORCE]


def test_pressure_is_hertzs_and_unknown_on_sharp_edges(spur: Gearbox):
    curve = curve_of(spur, 150e3)
    kind, force = curve.pair_contact_kind, curve.pair_normal_force
    on_flanks = kind == ON_FLANKS
    rho_a, rho_b = curve.pair_position[on_flanks], curve.pair_position_driven[on_flanks]
    e_star = spur.mesh_geometry().effective_modulus
    line = force[on_flanks] / spur.mesh_geometry().common_width
    hertz = np.sqrt(line * e_star / np.pi * (1 / rho_a + 1 / rho_b))
    np.testing.assert_allclose(curve.pair_contact_pressure[on_flanks], hertz, rtol=1e-13)
    assert np.isnan(curve.pair_contact_pressure[kind > ON_FLANKS]).all()
    assert (curve.pair_contact_pressure[kind == NO_FORCE] == 0).all()
    np.testing.assert_allclose(
        rho_a + rho_b,
        (spur.mesh_geometry().line_of_action_length + curve.transmission_error)[
            on_flanks.nonzero()[0]
        ],
        rtol=1e-12,
    )


def test_rounded_edges_have_the_pressure_of_their_rounding(kernel: Kernel):
    """Hertzian pressure with 1/r_t and the curvature of the mate at the contact of the edge."""
    rounding = 2e-4
    gearbox = pair(kernel, gear={"tip_rounding": rounding})
    curve = curve_of(gearbox, 150e3)
    geometry = gearbox.mesh_geometry()
    kind, force = curve.pair_contact_kind, curve.pair_normal_force
    gears = [gear_of(gearbox, i) for i in (0, 1)]
    for i, on_edge in enumerate((kind == EDGE_DRIVING, kind == EDGE_DRIVEN)):
        assert on_edge.sum() > 3
        rho = (curve.pair_position[on_edge], curve.pair_position_driven[on_edge])
        base, mate = gears[i].base_radius, gears[1 - i].base_radius
        end = np.sqrt(gears[i].tip_form_radius ** 2 - base**2)
        edge = Edge(base, mate, end, rounding)
        at = edge_geometry(kernel, edge, rho[i] - end, geometry.line_of_action_length)
        curvature = 1 / rounding + 1 / (rho[1 - i] - at.foot)
        line = force[on_edge] / geometry.common_width
        hertz = np.sqrt(line * geometry.effective_modulus / np.pi * curvature)
        np.testing.assert_allclose(curve.pair_contact_pressure[on_edge], hertz, rtol=1e-9)
    assert exceeds(curve.largest_contact_pressure, np.nanmax(curve.pair_contact_pressure))


# Meshes without compliance


def johnson(h: np.ndarray, length: float, e_star: float) -> np.ndarray:
    """Line load of one pair by Johnson's law, its logarithm solved by iteration."""
    load = np.pi * e_star * h / 15
    for _ in range(200):
        load = np.pi * e_star * h / (np.log(4 * np.pi * e_star * length / load) - 1)
    return load


@pytest.mark.parametrize("unequal", [False, True], ids=["one material", "two"])
def test_contact_alone_shares_alike(kernel: Kernel, unequal: bool):
    """Johnson's law is independent of position: pairs on the path share equally, without edges."""
    given = {"youngs": (E, 0.7e11), "poisson": (0.3, 0.34)} if unequal else {}
    gearbox = pair(kernel, compliance={}, **given)
    geometry = gearbox.mesh_geometry()
    curve = curve_of(gearbox, 150e3)
    assert set(np.unique(curve.pair_contact_kind)) == {NO_FORCE, ON_FLANKS}
    n = curve.loaded_pairs
    assert set(n) == {1, 2}
    load = johnson(
        curve.transmission_error, geometry.line_of_action_length, geometry.effective_modulus
    )
    np.testing.assert_allclose(load * n, 150e3, rtol=1e-12)
    carries = curve.pair_normal_force > 0
    np.testing.assert_allclose(curve.force_share, carries / n[:, np.newaxis], rtol=1e-12)
    # two pairs from the path length less its reduction by the deflection
    assert curve.loaded_contact_ratio == pytest.approx(geometry.contact_ratio, abs=0.011)


@pytest.mark.parametrize("soft", ["driving", "driven"])
def test_one_pair_of_two_materials_at_the_pitch_point_is_as_stiff_as_told(
    kernel: Kernel, soft: str
):
    """C_kk has (K_A - K_B)/2 ln(rho_A/rho_B): `pair_stiffness_per_width` alone, and the flank.

    For steel and aluminium that term is 2 % of the compliance; a wrong sign doubles the error.
    """
    youngs, poisson = (0.7e11, E), (0.34, NU)
    order = slice(None, None, 1 if soft == "driving" else -1)
    gearbox = pair(kernel, youngs=youngs[order], poisson=poisson[order])
    geometry, wheel_a = gearbox.mesh_geometry(), gearbox.wheel_geometry(0)
    curve = curve_of(gearbox, 150e3, points=400)
    along = wheel_a.base_radius * np.tan(geometry.working_pressure_angle)
    position = (along - geometry.rho_start_driving) / geometry.base_pitch
    at = int(np.argmin(np.abs(curve.position - position)))
    assert curve.loaded_pairs[at] == 1
    stiffness = np.interp(position, curve.position, curve.secant_stiffness) / geometry.common_width
    # 22 um of deflection are 2e-3 of the radii of curvature
    assert stiffness == pytest.approx(curve.pair_stiffness_per_width, rel=2e-3)


BENDING = {"contact alone": {}, "alone": {"tooth_coupling": "false"}, "coupled": {}}


@pytest.mark.parametrize("position", [0.1, 0.3, 0.52, 0.75, 0.98])
@pytest.mark.parametrize("eased", [False, True], ids=["perfect", "eased"])
@pytest.mark.parametrize("bending", BENDING)
def test_mesh_rests_where_the_dynamics_do(
    kernel: Kernel, bending: str, eased: bool, position: float
):
    """The steady state under the same torques, with corner contact."""
    loads = (load(0, TORQUE, -50.0), load(1, VISCOUS, 1.0))
    ease = deviations(tip_relief=relief(6e-6, diameter=0.0608), profile_crowning=2e-6)
    compliance = {} if bending == "contact alone" else ELEMENTS
    gearbox = pair(
        kernel,
        compliance=compliance,
        loads=loads,
        deviation=(ease if eased else None, None),
        damping=None,
        **BENDING[bending],
    )
    curve = static_curve(gearbox, 50.0)
    state = gearbox.start(EQUILIBRIUM, mesh_position=position)
    at = int(np.argmin(np.abs(curve.position - position)))
    outputs = gearbox.outputs(state)
    error, force = outputs["transmission_error"][0], outputs["normal_force"][0]
    # without compliance the law of the dynamics has the length rho + h instead of rho
    bound = 2e-5 if bending == "contact alone" else 1e-9
    assert curve.transmission_error[at] == pytest.approx(float(error), rel=bound)
    assert curve.pair_normal_force[at].sum() == pytest.approx(float(force), rel=bound)


def test_teeth_alone_are_stiffer_than_coupled_ones(kernel: Kernel):
    """Two bodies in parallel instead of one: 18.75 and 19.56 instead of 13.81 and 17.12."""
    for fields, known in ((FIFTY, 18.75), ({}, 19.56)):
        gearbox = pair(kernel, tooth_coupling="false", **fields)
        assert curve_of(gearbox, 150e3).mesh_stiffness_per_width / 1e9 == pytest.approx(
            known, rel=1e-3
        )


def test_formulas_of_single_teeth_come_with_no_coupling(kernel: Kernel):
    curve = curve_of(pair(kernel, compliance=ANALYTIC), 150e3)
    assert 18e9 < curve.mesh_stiffness_per_width < 21e9


# Deviations


def test_crowning_is_the_transmission_error_without_load(kernel: Kernel):
    """Without load h is the smallest deviation of all pairs; light load approaches it.

    It is the minimum of the crowning and, beside the line, of the rotation away from the mate.
    """
    crowning = 8e-6
    gearbox = pair(kernel, deviation=(deviations(profile_crowning=crowning), None))
    geometry = gearbox.mesh_geometry()
    first = geometry.rho_start_driving
    half = geometry.contact_ratio * geometry.base_pitch / 2
    curve = curve_of(gearbox, 50.0)
    positions = (curve.position[:, np.newaxis] + np.arange(2)) * geometry.base_pitch
    u = positions / half - 1
    away = 1 / (1 / (first + positions) - 1 / geometry.line_of_action_length)
    stiff = away / gear_of(gearbox, 0).base_radius ** 2 + 2 * crowning / half**2
    crown = crowning * u**2 - (2 * crowning * u / half) ** 2 / 2 / stiff
    lacks = np.where(positions < 2 * half, crown, np.inf).min(1)
    h_0 = curve.free_transmission_error
    assert first > 0
    # no pair was on an edge
    np.testing.assert_allclose(h_0[h_0 < 0.9 * h_0.max()], lacks[h_0 < 0.9 * h_0.max()], atol=1e-11)
    assert h_0.max() > 1e-6
    assert np.abs(curve.transmission_error - h_0).max() < 0.1e-6


def test_stiffness_goes_by_the_deflection_that_load_adds(kernel: Kernel):
    """Crowned flanks have gaps away from the middle before there is a load."""
    curve = curve_of(pair(kernel, deviation=(deviations(profile_crowning=8e-6), None)), 50e3)
    added = curve.transmission_error - curve.free_transmission_error
    assert curve.mean_secant_stiffness == pytest.approx(
        (curve.tooth_force / added).mean(), rel=1e-13
    )
    plain = (curve.tooth_force / curve.transmission_error).mean()
    assert plain < 0.99 * curve.mean_secant_stiffness


def test_mesh_of_iso_6336_has_three_quarters_of_its_contact_ratio_in_pairs(spur: Gearbox):
    """ISO 6336-1: c_gamma_alpha = c' (0.75 epsilon_alpha + 0.25)."""
    curve = curve_of(spur, 300e3)
    pairs = 0.75 * spur.mesh_geometry().contact_ratio + 0.25
    assert curve.iso_mesh_stiffness_per_width == pytest.approx(
        pairs * curve.iso_pair_stiffness_per_width, rel=1e-14
    )


def test_relief_lowers_the_peaks_at_its_load(kernel: Kernel):
    """Linear relief equal to the tooth deflection, up to single contact: low transmission error."""
    ease = [deviations(tip_relief=relief(8e-6, diameter=d)) for d in (0.0608, 0.1048)]
    plain = curve_of(pair(kernel), 150e3)
    eased = curve_of(pair(kernel, deviation=tuple(ease)), 150e3)
    assert eased.largest_edge_force < 0.06 * plain.largest_edge_force
    assert eased.peak_to_peak_transmission_error < 0.3 * plain.peak_to_peak_transmission_error


PITCH = deviations(pitch_errors=[1e-6 * ((5 * k * k + 3 * k) % 17) for k in range(19)])
RUNOUT = deviations(runout_amount=20e-6, runout_phase=0.3)


@pytest.mark.parametrize(
    ("deviation", "pitches"),
    [((None, None), 1), ((PITCH, None), 19), ((None, RUNOUT), 34), ((PITCH, RUNOUT), 646)],
    ids=["like teeth", "pitch errors", "runout", "both"],
)
def test_all_teeth_are_met_where_they_differ(kernel: Kernel, deviation: tuple, pitches: int):
    gearbox = pair(kernel, compliance=ANALYTIC, deviation=deviation)
    assert static_plan(gearbox, points=25).n_pitches == pitches
    if pitches > 40:
        return
    curve = curve_of(gearbox, 50e3, points=25)
    assert len(curve.position) == 25 * pitches
    whole = curve.transmission_error.reshape(pitches, 25)
    assert (np.ptp(whole, axis=0).min() > 1e-7) == (pitches > 1)


def test_tooth_cycle_of_wheels_with_a_common_divisor_is_the_least_that_both_divide(kernel: Kernel):
    gearbox = pair(kernel, teeth=(20, 34), deviation=(RUNOUT, RUNOUT), compliance=ANALYTIC)
    assert static_plan(gearbox, points=25).n_pitches == 340


def test_runout_of_the_driven_wheel_is_its_long_wave(kernel: Kernel):
    """An eccentric wheel lags and leads by its eccentricity along the line of action."""
    e_c = 20e-6
    gearbox = pair(kernel, compliance={}, deviation=(None, deviations(runout_amount=e_c)))
    curve = curve_of(gearbox, 50e3, points=25)
    wave = 2 * np.fft.rfft(curve.transmission_error) / len(curve.position)
    assert abs(wave[1]) == pytest.approx(e_c, rel=0.01)


def test_positions_without_number_are_refused(kernel: Kernel):
    gearbox = pair(kernel, compliance={}, deviation=(PITCH, RUNOUT))
    with pytest.raises(GearboxError, match=r"646 pitches of 1000 positions .* than 500000"):
        static_plan(gearbox, points=1000)


# The largest force of a tooth pair

TALL = {"rack_addendum": 1.3, "rack_dedendum": 1.5, "rack_root_radius": 0.2}
HIGH: dict[str, Any] = {"teeth": (38, 34), "shift": (0.0, 0.0), "gear": TALL}
WAVY = deviations(pitch_errors=[2e-7 * ((7 * k * k + k) % 13) for k in range(38)])


@pytest.mark.parametrize(
    ("fields", "share"),
    [
        ({}, 1.0),
        ({"compliance": ANALYTIC, "deviation": (PITCH, None)}, 1.0),
        ({**HIGH, "compliance": ANALYTIC}, 0.57),
        ({**HIGH, "compliance": ANALYTIC, "deviation": (WAVY, None)}, 0.68),
    ],
    ids=["bending", "pitch errors", "contact ratio above 2", "contact ratio above 2, errors"],
)
@pytest.mark.parametrize("sense", [1, -1])
def test_largest_force_of_a_pair_is_that_of_the_curve(
    kernel: Kernel, fields: dict[str, Any], share: float, sense: int
):
    """For some pitches it is that of their part, which repeats with the teeth."""
    gearbox = pair(kernel, **fields)
    torque = sense * 100.0
    curve = static_curve(gearbox, torque, points=100)
    forces = curve.pair_normal_force.max(axis=1).reshape(-1, 100).max(axis=1)
    assert exceeds(pair_force_at_rest(gearbox, torque), forces.max())
    largest = curve.largest_force_share * curve.tooth_force
    assert pair_force_at_rest(gearbox, torque) == pytest.approx(largest, rel=1e-5)
    assert curve.largest_force_share == pytest.approx(share, rel=0.1)
    n = len(forces)
    for first, pitches in [(3, 2), (-1, 1), (5 * n + 1, 2)]:
        some = forces[(first + np.arange(pitches)) % n].max()
        assert exceeds(pair_force_at_rest(gearbox, torque, first, pitches), some)


def test_largest_force_is_known_however_many_pairs_meet(kernel: Kernel):
    """Its curve would have too many positions: 9797 pitches of 100."""
    errors = [1e-6 * ((5 * k * k + 3 * k) % 17) for k in range(97)]
    gearbox = pair(
        kernel,
        teeth=(97, 101),
        shift=(0.0, 0.0),
        compliance=ANALYTIC,
        deviation=(deviations(pitch_errors=errors), RUNOUT),
    )
    with pytest.raises(GearboxError, match="more than 500000 positions"):
        static_plan(gearbox, points=100)
    some = [pair_force_at_rest(gearbox, 100.0, first, 1) for first in range(-2, 2)]
    assert pair_force_at_rest(gearbox, 100.0, -2, 4) == pytest.approx(max(some), rel=1e-5)
    assert max(some) > min(some)


@pytest.mark.parametrize(("torque", "says"), [(0.0, "loads no flanks"), (np.nan, "loads no")])
def test_torques_that_press_nothing_have_no_largest_force(spur: Gearbox, torque: float, says: str):
    with pytest.raises(GearboxError, match=says):
        pair_force_at_rest(spur, torque)


# Stiffness over load, loads, refusals


def test_mesh_stiffens_with_load_where_more_teeth_come_in(spur: Gearbox):
    stiffness = [curve_of(spur, w * 1e3).mean_secant_stiffness for w in (1, 10, 100, 400)]
    assert (np.diff(stiffness) > 0).all()


@pytest.mark.parametrize("line_load", [1.0, 1e3, 1e6])
def test_any_load_finds_its_rest(spur: Gearbox, line_load: float):
    curve = curve_of(spur, line_load, points=40)
    assert (curve.transmission_error > curve.free_transmission_error).all()
    assert np.isfinite(curve.tangent_stiffness).all()


def test_torque_is_that_of_the_loads(kernel: Kernel):
    loads = (load(0, TORQUE, -50.0), load(1, TORQUE, -50.0 * 34 / 19))
    assert static_plan(pair(kernel, compliance={}, loads=loads)).torque == pytest.approx(50)
    assert static_plan(pair(kernel, compliance={})).torque == 0


@pytest.mark.parametrize("turned", [False, True], ids=["as it stands", "mirrored"])
def test_curve_knows_no_place_in_the_housing(kernel: Kernel, spur: Gearbox, turned: bool):
    gearbox = pair(
        kernel, centre_line_angle=2.1, driving_rotation="counterclockwise" if turned else -1
    )
    np.testing.assert_allclose(
        curve_of(gearbox, 150e3).transmission_error,
        curve_of(spur, 150e3).transmission_error,
        rtol=1e-9,
    )


@pytest.mark.parametrize("torque", [0.0, np.nan, np.inf])
def test_torque_that_presses_nothing_is_refused(spur: Gearbox, torque: float):
    with pytest.raises(GearboxError, match="give one above 0") as refusal:
        static_curve(spur, torque)
    assert refusal.value.code == INVALID_INPUT


def test_coast_flanks_are_the_mirror_image_of_the_drive_flanks(kernel: Kernel):
    """With backlash: pairs enter at the other end, and the driven wheel leads."""
    gearbox = pair(kernel, backlash=5e-5)
    torque = torque_of(gearbox, 150e3)
    drive, coast = (static_curve(gearbox, t, points=1000) for t in (torque, -torque))
    backlash = coast.normal_backlash
    assert backlash == pytest.approx(5e-5, rel=1e-9)
    assert coast.free_transmission_error == pytest.approx(-backlash, abs=1e-15)
    assert coast.tooth_force == drive.tooth_force
    assert coast.mean_transmission_error == pytest.approx(
        -backlash - drive.mean_transmission_error, rel=1e-7
    )
    np.testing.assert_allclose(coast.harmonic_amplitude, drive.harmonic_amplitude, rtol=2e-3)
    # x pitches after its start on one side, a pair is as far from its end on the other
    at = (gearbox.mesh_geometry().contact_ratio - coast.position) % 1
    mirrored = np.interp(at, drive.position, drive.transmission_error, period=1)
    smooth = np.abs(np.diff(mirrored, append=mirrored[0])) < 1e-8
    off = coast.transmission_error + backlash + mirrored
    assert np.abs(off[smooth]).max() < 2e-9
    for name in ("secant_stiffness", "loaded_secant_stiffness", "tangent_stiffness"):
        assert getattr(coast, name).mean() == pytest.approx(getattr(drive, name).mean(), rel=5e-4)
    edges = np.bincount(coast.pair_contact_kind.astype(int).ravel(), minlength=4)
    others = np.bincount(drive.pair_contact_kind.astype(int).ravel(), minlength=4)
    assert edges[EDGE_DRIVING] == pytest.approx(others[EDGE_DRIVING], abs=2)
    # an entering pair is on the driving wheel's edge, not on the driven wheel's
    assert (coast.of_pair(-1, "pair_contact_kind") == EDGE_DRIVING).any()
    assert (drive.of_pair(-1, "pair_contact_kind") == EDGE_DRIVEN).any()


@pytest.mark.parametrize("sense", [1, -1])
@pytest.mark.parametrize("flank", [1, -1], ids=["drive", "coast"])
def test_torque_is_balanced_with_friction_in_closed_form(kernel: Kernel, flank: int, sense: int):
    """Only contacts yield: T = sum F_n (r_b - phi l_A), phi of either sign, 0 at standstill."""
    gearbox = pair(kernel, compliance={}, backlash=2e-5, friction=(0.07, 1e-6))
    torque = torque_of(gearbox, 150e3)
    curve = static_curve(gearbox, flank * torque, speed=sense * 10.0)
    r_a, r_b = curve.base_radius_driving, curve.base_radius_driven
    carries = curve.pair_normal_force > 0
    depth = flank * curve.transmission_error - (flank < 0) * curve.normal_backlash
    # the contact point is in the middle of the overlap of both flanks, which have one material
    arm = curve.pair_position - depth[:, None] / 2
    arm_b = curve.pair_position_driven - depth[:, None] / 2
    slides = flank * sense * (arm_b * r_a / r_b - arm)
    assert (np.sign(slides[carries]) == -np.sign(curve.pair_friction_force[carries])).all()
    phi = -curve.pair_friction_force[carries] / curve.pair_normal_force[carries]
    np.testing.assert_allclose(np.abs(phi)[np.abs(slides[carries]) > 1e-6], 0.07, rtol=1e-12)
    found = (curve.pair_normal_force * r_a + curve.pair_friction_force * np.nan_to_num(arm)).sum(1)
    np.testing.assert_allclose(found, torque, rtol=1e-12)
    without = static_curve(gearbox, flank * torque)
    assert (without.pair_friction_force == 0).all()
    assert np.abs(curve.transmission_error / without.transmission_error - 1).max() > 1e-3


def test_tangent_stiffness_with_friction_is_that_of_the_curve(kernel: Kernel):
    gearbox = pair(kernel, friction=(0.07, 1e-2), deviation=(RELIEVED, None))
    torque = torque_of(gearbox, 150e3)
    low, middle, high = (
        static_curve(gearbox, torque * (1 + by), points=40, speed=20.0) for by in (-1e-4, 0, 1e-4)
    )
    slope = 2e-4 * middle.tooth_force / (high.transmission_error - low.transmission_error)
    same = (low.pair_contact_kind == high.pair_contact_kind).all(1)
    assert same.mean() > 0.8
    np.testing.assert_allclose(middle.tangent_stiffness[same], slope[same], rtol=1e-6)


def test_meshes_without_an_answer_are_refused(kernel: Kernel):
    paper = Gearbox(
        kernel,
        [wheel(pitch_radius=0.2, centre=(0, 0)), wheel(teeth=30)],
        [],
        [mesh(kernel)],
    )
    short = pair(kernel, compliance={}, gear={"tip_alteration": -0.55})
    laws = [
        pair(kernel, compliance={}, contact=Block(law="linear", stiffness=1e8), damping=None),
    ]
    for gearbox, words in (
        (paper, "give both wheels a module"),
        (short, "its contact ratio is 0.[0-9]*: without a tooth pair on the path"),
        *((law, "only the contact law: johnson") for law in laws),
    ):
        with pytest.raises(GearboxError, match=words) as refusal:
            static_plan(gearbox)
        assert refusal.value.code == INVALID_INPUT


def test_too_few_points_are_refused(spur: Gearbox):
    with pytest.raises(GearboxError, match="20 positions a pitch are too few: 21 or more"):
        static_plan(spur, points=20)


def test_contact_ratio_below_one_rests_on_its_edges(kernel: Kernel):
    gearbox = pair(kernel, gear={"tip_alteration": -0.55})
    curve = curve_of(gearbox, 150e3)
    alone = curve.pair_contact_kind.max(1) > ON_FLANKS
    assert gearbox.mesh_geometry().contact_ratio < 1
    assert alone.any()
    assert curve.loaded_contact_ratio > 1


def test_mesh_whose_pairs_do_not_reach_each_other_is_refused_with_its_place(kernel: Kernel):
    gearbox = pair(kernel, compliance=ANALYTIC, gear={"tip_alteration": -0.9})
    with pytest.raises(
        GearboxError,
        match=r"under .* N m, 0\.[0-9]* pitches from the start .* 0\.4 pitches off its path",
    ) as refusal:
        curve_of(gearbox, 1e5)
    assert refusal.value.code == OUT_OF_DOMAIN
    assert refusal.value.subject == MESH


def test_rows_are_told_once(spur: Gearbox):
    names = [row.name for row in table(spur)]
    assert len(set(names)) == len(names)
    assert max(len(row.long_name) for row in table(spur)) < 95  # else they may be truncated
