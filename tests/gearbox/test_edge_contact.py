"""Corner contact of pairs before and after their path: Jacobian, lanes, energy, events."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from typing import Any

import numpy as np
import pytest

from gearbox.lanes.lane_cases import DEVIATIONS, real_gears
from gearbox.lanes.test_lanes import around, check, check_bits
from gearbox.test_compliant_flanks import bend
from kernel.deviations import ROOT, TIP
from kernel.gearbox import LOADED, OPEN, UNLOADED, Gearbox, State
from kernel.gearbox_cases import worst
from kernel.gearbox_description import STEADY
from kernel.jacobian import check_jacobian
from kernel.kernel import Floats, Kernel

OFF = 4
END, EDGE = 2, 3  # zones beyond the end of a flank
TIP_CORNER, ROOT_CORNER = -3, -2  # zones of the corners of reliefs
# the relief of a corner, the zone that a contact comes from and the one that it leaves for
BESIDE_CORNER = {TIP_CORNER: ("tip", 0, TIP), ROOT_CORNER: ("root", 0, ROOT)}
ROUNDED = "rounded"  # tips, on flanks with all deviations
every_deviation = pytest.mark.parametrize("name", [*DEVIATIONS, ROUNDED])
alone_and_coupled = pytest.mark.parametrize("couples", [False, True], ids=["alone", "coupled"])
every_axle = pytest.mark.parametrize("fixed", [False, True], ids=["moving axles", "fixed axles"])
# steady position in pitches past the start of the path, and the additional penetration [m]
POSITIONS = [(p, h) for p in (0.0, 0.35, 0.62, 0.9) for h in (1e-4, 3e-5)]


def with_edges(
    kernel: Kernel, name: str, couples: bool, *, fixed: bool = False, **keys: Any
) -> Gearbox:
    """Compliant `real_gears` with corner contact."""
    if name == ROUNDED:
        name, keys["tip_roundings"] = "all of them", (2e-4, 4e-4)
    return bend(real_gears(kernel, name, fixed=fixed, edge_contact="true", **keys), couples)


def pressed(gearbox: Gearbox, position: float, h: float, mode: int = LOADED) -> State:
    """Turn both wheels against each other, so that pairs are in contact far beyond the path.

    All overlapping pairs of the drive flank are in the mode.
    """
    state = gearbox.start(STEADY, mesh_position=position)
    state.y[gearbox.index("angle_deviation_1")] -= h / gearbox.wheel_geometry(1).base_radius
    n = gearbox.sizes.n_reals
    for contact in range(n // 2):
        of = gearbox.mode(state, contact)
        if of[1] != OFF:
            of[1] = OPEN
    gaps = gearbox.outputs(state)["pair_penetration"][0]
    for contact in range(n // 2):
        of = gearbox.mode(state, contact)
        if of[1] != OFF:
            of[1] = mode if gaps[contact] > 0 else OPEN
    gearbox.take_sides(state)
    return state


def at_positions(
    gearbox: Gearbox, seed: int, positions: Iterable[tuple[float, float]], *modes: int
) -> Iterator[State]:
    """Loaded states with small displacements, in each of the modes."""
    random = np.random.default_rng(seed)
    for position, h in positions:
        for mode in modes:
            state = pressed(gearbox, position, h, mode)
            yield around(state, random, size=1e-6)[0]


def check_balance(gearbox: Gearbox, state: State, fixed: bool) -> None:
    """Check d/dt (T + V + D - W) = 0 along the flow.

    Richardson differences of V: 1e-9 of the largest power.
    """
    state.yp = gearbox.derivative(state)
    o = gearbox.outputs(state)
    d_kinetic = o["inertia"] * o["angular_velocity"] * o["angular_acceleration"]
    if not fixed:
        masses = o["mass"] + 3.0  # of the supports of `real_gears`
        power = (o["centre_velocity"] * axle_accelerations(gearbox, state)).sum(axis=1)
        d_kinetic = np.append(d_kinetic, masses * power)
    parts = [
        *d_kinetic,
        rate_of_potential(gearbox, state),
        state.yp[gearbox.index("dissipated_energy")],
        -state.yp[gearbox.index("load_work")],
    ]
    assert worst(np.sum(parts), 1e-9 * np.abs(parts).max()) <= 1


def on_edges(gearbox: Gearbox, state: State) -> int:
    """Number of pairs in contact beyond the end of a flank."""
    modes = [gearbox.mode(state, contact) for contact in range(gearbox.sizes.n_reals)]
    return sum(m[1] in (LOADED, UNLOADED) and max(m[3:5]) >= END for m in modes)


def axle_accelerations(gearbox: Gearbox, state: State) -> Floats:
    """Accelerations of the axes [wheel, 2]: stored as velocities, and read as such."""
    moved = state.copy()
    for i, name in enumerate(gearbox.names):
        if name.startswith("displacement") and "rate" in name:
            moved.y[i] = state.yp[i]
    for contact in range(gearbox.sizes.n_reals):
        gearbox.mode(moved, contact)[1] = OPEN
    return gearbox.outputs(moved)["centre_velocity"]


def rate_of_potential(gearbox: Gearbox, state: State, step: float = 1e-6) -> float:
    """Rate of the elastic energy along the flow, by differences."""
    values = {}
    for k in (-2, -1, 1, 2):
        moved = state.copy()
        moved.y = state.y + k * step * state.yp
        values[k] = gearbox.outputs(moved)["potential_energy"][0]
    return float((8 * (values[1] - values[-1]) - (values[2] - values[-2])) / (12 * step))


@alone_and_coupled
@every_axle
@every_deviation
def test_jacobian_is_the_derivative_of_the_residual(
    kernel: Kernel, name: str, fixed: bool, couples: bool
):
    gearbox = with_edges(kernel, name, couples, fixed=fixed)
    found = 0
    for state in at_positions(gearbox, 7, POSITIONS, LOADED):
        state.yp = gearbox.derivative(state)
        check_jacobian(gearbox, state)
        found += on_edges(gearbox, state)
    assert found >= 2


@alone_and_coupled
@every_axle
@every_deviation
def test_eight_states_at_once_are_the_bits_of_each(
    kernel: Kernel, name: str, fixed: bool, couples: bool
):
    gearbox = with_edges(kernel, name, couples, fixed=fixed)
    random = np.random.default_rng(3)
    for state in at_positions(gearbox, 3, POSITIONS, LOADED, UNLOADED):
        check(gearbox, around(state, random, size=1e-6))


@alone_and_coupled
@every_axle
def test_eight_states_of_finite_elements_are_the_bits_of_each(
    kernel: Kernel, fixed: bool, couples: bool
):
    keys = {"edge_contact": "true", "tooth_coupling": str(couples).lower()}
    gearbox = real_gears(kernel, "parabolic tip relief", elements=True, fixed=fixed, **keys)
    random = np.random.default_rng(5)
    for position, h in POSITIONS:
        check_bits(gearbox, around(pressed(gearbox, position, h), random, size=1e-6))


@alone_and_coupled
@every_axle
@every_deviation
def test_energy_changes_by_the_work_of_the_loads_less_what_is_dissipated(
    kernel: Kernel, name: str, fixed: bool, couples: bool
):
    """Check d/dt (T + V + D - W) = 0 along the flow, on edges and with overlap without force."""
    gearbox = with_edges(kernel, name, couples, fixed=fixed)
    for state in at_positions(gearbox, 11, POSITIONS, LOADED, UNLOADED):
        check_balance(gearbox, state, fixed)


CORNERS = {  # and their zones
    "linear tip relief": ("tip_a", "tip_b"),
    "linear root relief": ("root_a", "root_b"),
    "all of them": ("root_a", "tip_b"),
}


@alone_and_coupled
@every_axle
@pytest.mark.parametrize("name", CORNERS)
def test_corners_of_reliefs_have_forces_that_are_their_gaps_gradient(
    kernel: Kernel, name: str, fixed: bool, couples: bool
):
    """Pairs in contact at the corner at the start of a linear relief: Jacobian, lanes, power."""
    gearbox = with_edges(kernel, name, couples, fixed=fixed, friction=0.0, damping=None)
    random = np.random.default_rng(5)
    found = 0
    for state in at_positions(gearbox, 5, [(p, 3e-5) for p in np.linspace(0, 1, 120)], LOADED):
        modes = [gearbox.mode(state, contact) for contact in range(gearbox.sizes.n_reals)]
        on_corners = [m for m in modes if m[1] == LOADED and min(m[3:5]) <= ROOT_CORNER]
        if not on_corners or found >= 4:
            continue
        found += len(on_corners)
        check_balance(gearbox, state, fixed)
        check_jacobian(gearbox, state)
        check(gearbox, around(state, random, size=1e-6))
    assert found >= 2


def at_border(gearbox: Gearbox, state: State, name: str, contact: int, value: float = 0.0) -> State:
    """Roll to a value of a root function of a contact, at the same penetration."""
    angle = gearbox.index("reference_angle")
    for _ in range(12):
        moved = state.copy()
        moved.y[angle] += 1e-7
        here, there = (gearbox.root(s, name, contact) for s in (state, moved))
        state.y[angle] -= (here - value) / (there - here) * 1e-7
    return state


@alone_and_coupled
@pytest.mark.parametrize("name", ["perfect", "crowning", "runout"])
def test_forces_and_energy_go_on_where_a_pair_leaves_its_path(
    kernel: Kernel, name: str, couples: bool
):
    """At the end of a flank and the transition to its edge: the same state in both zones.

    The torque about the edge's axis has a step of 1e-4 of itself, since the load stops on the edge.
    If the mate has a slope, its reversing foot point meets that slope: no damper here.
    """
    gearbox = with_edges(kernel, name, couples, fixed=True, friction=0.0, damping=None)
    found = 0
    for position, h in ((0.0, 3e-5), (0.55, 3e-5), *POSITIONS[::2]):
        state = pressed(gearbox, position, h)
        for contact in range(gearbox.sizes.n_reals // 2):
            mode = gearbox.mode(state, contact)
            for wheel, letter in enumerate("ab"):
                border = f"edge_{letter}"
                if mode[1] != LOADED or mode[3 + wheel] != EDGE:
                    continue
                there = at_border(gearbox, state.copy(), border, contact)
                inside = there.copy()
                gearbox.mode(inside, contact)[3 + wheel] = END if name == "crowning" else 0
                gearbox.take_sides(inside)
                outer, inner = gearbox.outputs(there), gearbox.outputs(inside)
                for what in ("pair_normal_force", "pair_penetration", "potential_energy"):
                    largest = np.nanmax(abs(outer[what]))
                    np.testing.assert_allclose(inner[what], outer[what], atol=1e-9 * largest)
                arms = [f"mesh_torque_{x}" for x in ("driving", "driven")]
                torques = [abs(outer[x] / inner[x] - 1).max() for x in arms]
                assert torques[1 - wheel] < (1e-9 if name == "perfect" else 3e-3)
                assert 1e-6 < torques[wheel] < 3e-3
                found += 1
    assert found


@alone_and_coupled
@pytest.mark.parametrize("name", CORNERS)
def test_forces_and_energy_go_on_where_a_pair_comes_to_a_corner_and_where_it_leaves_it(
    kernel: Kernel, name: str, couples: bool
):
    """At the start of corner contact and of contact with the relief beyond: equal in both."""
    gearbox = with_edges(kernel, name, couples, fixed=True, friction=0.0, damping=None)
    found = set()
    for position in np.linspace(0, 1, 60):
        state = pressed(gearbox, position, 3e-5)
        for contact in range(gearbox.sizes.n_reals // 2):
            mode = gearbox.mode(state, contact)
            for wheel, letter in enumerate("ab"):
                zone = int(mode[3 + wheel])
                if mode[1] != LOADED or zone not in BESIDE_CORNER:
                    continue
                part, *zones = BESIDE_CORNER[zone]
                for end, other in zip(("", "corner_"), zones, strict=True):
                    border = f"{part}_{end}{letter}"
                    there = at_border(gearbox, state.copy(), border, contact)
                    behind = there.copy()
                    gearbox.mode(behind, contact)[3 + wheel] = other
                    one, two = gearbox.outputs(there), gearbox.outputs(behind)
                    for what in ("pair_normal_force", "pair_penetration", "potential_energy"):
                        largest = np.nanmax(abs(one[what]))
                        np.testing.assert_allclose(one[what], two[what], atol=1e-9 * largest)
                    found.add(border)
    corners = [border.replace("_", "_corner_") for border in CORNERS[name]]
    assert found == {*CORNERS[name], *corners}


@pytest.mark.parametrize("rate", [-1e-3, 1e-3], ids=["moves together", "moves apart"])
@pytest.mark.parametrize(("mode", "overlap", "then"), [(LOADED, -5e-7, OPEN), (OPEN, 5e-7, LOADED)])
def test_pairs_that_yield_together_touch_where_they_overlap_whichever_way_they_move(
    kernel: Kernel, mode: int, overlap: float, then: int, rate: float
):
    """Load changes of other pairs open and close the flanks of a pair, too."""
    gearbox = with_edges(kernel, "perfect", couples=True, fixed=True, friction=0.0, damping=None)
    state = pressed(gearbox, 0.92, 3e-5)
    gearbox.mode(state, 1)[1] = mode
    state = at_border(gearbox, state, "contact", 1, value=overlap)
    state.y[gearbox.index("reference_speed")] = 0
    state.y[gearbox.index("angle_deviation_1") + 1] = rate / gearbox.wheel_geometry(1).base_radius
    assert gearbox.outputs(state)["pair_penetration"][0, 1] > 1e-6  # of rigid flanks
    after, _ = gearbox.apply_all(state, [])
    assert gearbox.mode(after, 0)[1] == LOADED
    assert gearbox.mode(after, 1)[1] == then
