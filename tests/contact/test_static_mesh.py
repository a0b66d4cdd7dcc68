"""Quasi-static mesh under load: closed forms, equilibrium, continuity, rejected input."""

from __future__ import annotations

import numpy as np
import pytest

from contact.meshes import EDGE_A, EDGE_B, FLANK, involute_mesh, start_of_path
from kernel.compliant import Mesh, Static, compliant_force, static_mesh
from kernel.kernel import NO_SOLUTION, OK, OUT_OF_DOMAIN, Kernel

LOAD = 150e3  # per metre of width [N/m]
MESHES = {
    "50/50": {},
    "19/34": {"teeth": (19, 34)},
    "uncoupled": {"couples": False},
    "unequal": {"teeth": (30, 70), "unequal": True},
    "relieved": {"relief": 4e-6},
    "coast": {"is_drive": False},
}
every_mesh = pytest.mark.parametrize("options", MESHES.values(), ids=MESHES)


def constant(mesh: Mesh, own: float, neighbour: float) -> None:
    """Wheels with constant compliance: E c and E c_1."""
    for w in range(2):
        mesh.influence[w][:] = [own / 2.06e11, 0, 0, neighbour / 2.06e11, 0, 0, 0, 0]


def at(kernel: Kernel, mesh: Mesh, pitches: float, load: float = LOAD) -> Static:
    """State with pair 0 this number of pitches after its start."""
    rho_a = start_of_path(mesh) + pitches * mesh.base_pitch
    state = static_mesh(kernel, mesh, rho_a, load * mesh.width)
    assert state.code == OK, state.message
    return state


def test_pairs_alike_share_the_load_in_closed_form(kernel: Kernel):
    """Wheels with constant compliance: h is that of one pair of compliance c + c_1."""
    mesh = involute_mesh()
    constant(mesh, 6.0, 3.9)
    state = at(kernel, mesh, 0.35)
    carries = state.force > 0
    np.testing.assert_allclose(state.force[carries], LOAD / 2, rtol=1e-9)
    assert carries.sum() == 2
    closed = compliant_force(kernel, state.h, mesh.line, 2 * 9.9 / 2.06e11, mesh.e_star)
    assert closed.force[0] == pytest.approx(LOAD / 2, rel=1e-9)
    assert state.stiffness == pytest.approx(2 * closed.d_h[0] * mesh.width, rel=1e-9)
    assert state.energy == pytest.approx(2 * closed.energy[0] * mesh.width, rel=1e-9)
    assert abs(state.h_0) < 1e-15
    assert (state.zones[carries] == FLANK).all()


def test_one_pair_alone_carries_all(kernel: Kernel):
    """19/34, with the next pair half a pitch away."""
    mesh = involute_mesh((19, 34))
    constant(mesh, 4.0, 1.5)
    state = at(kernel, mesh, 0.8, load=5e3)
    closed = compliant_force(kernel, state.h, mesh.line, 2 * 4.0 / 2.06e11, mesh.e_star)
    assert (state.force > 0).sum() == 1
    assert closed.force[0] == pytest.approx(5e3, rel=1e-9)


@every_mesh
def test_torque_about_the_driving_axle_is_balanced(kernel: Kernel, options: dict):
    mesh = involute_mesh(**options)
    for pitches in np.linspace(-0.1, 0.9, 40, endpoint=False):
        state = at(kernel, mesh, pitches)
        # or the force has a step there, at an end of the path: 1e-4 of it
        assert state.gradient[0] == pytest.approx(LOAD * mesh.width, rel=1e-12)
        np.testing.assert_allclose(state.rho.sum(1), mesh.line + state.h, rtol=1e-13)


@every_mesh
def test_tangent_stiffness_is_that_of_the_curve(kernel: Kernel, options: dict):
    mesh = involute_mesh(**options)
    for pitches in np.linspace(-0.1, 0.9, 23, endpoint=False):
        ends = [at(kernel, mesh, pitches, LOAD * (1 + by)) for by in (-1e-4, 1e-4)]
        middle = at(kernel, mesh, pitches)
        assert middle.stiffness > 0
        assert ends[0].h < middle.h < ends[1].h
        if (ends[0].zones.tolist(), *(ends[0].force > 0)) != (
            ends[1].zones.tolist(),
            *(ends[1].force > 0),
        ):
            continue
        slope = 2e-4 * LOAD * mesh.width / (ends[1].h - ends[0].h)
        assert middle.stiffness == pytest.approx(slope, rel=1e-5)


@every_mesh
def test_work_of_both_torques_is_the_same_over_a_pitch(kernel: Kernel, options: dict):
    """dU is the work of both wheels: it is conserved at entry and exit of pairs, also on edges."""
    options = {key: value for key, value in options.items() if key != "relief"}
    mesh = involute_mesh(**options)
    if "teeth" in options:
        mesh.width = 0.024
    states = [at(kernel, mesh, x) for x in np.linspace(0, 1, 1201)]
    h = np.array([s.h for s in states])
    forces = np.array([s.gradient[:2] for s in states])
    energy = np.array([s.energy for s in states])
    p = mesh.base_pitch
    moved_a = np.full(len(h) - 1, p / (len(h) - 1))
    work = forces[1:] + forces[:-1]
    work = (work[:, 0] * moved_a + work[:, 1] * (np.diff(h) - moved_a)) / 2
    # error of the trapezoidal rule at the onset of load; a torque on B of arm r_b would leave 1e-4
    scale = LOAD * mesh.width * h.mean()
    np.testing.assert_allclose(np.cumsum(work), energy[1:] - energy[0], atol=3e-3 * scale)
    assert energy[-1] == pytest.approx(energy[0], rel=1e-9)


@every_mesh
def test_pairs_come_and_go_without_a_step(kernel: Kernel, options: dict):
    """Shares and h over a pitch, in steps of 1/2000: only first contact is steep."""
    mesh = involute_mesh(**options)
    states = [at(kernel, mesh, x) for x in np.linspace(-0.35, 0.65, 2001)]

    def share(state: Static) -> float:
        """Share of pair 0."""
        carried = state.force[state.numbers == 0].sum()
        return float(carried * mesh.width / (LOAD * mesh.width))

    shares = np.array([share(s) for s in states])
    assert shares[0] == 0
    assert np.abs(np.diff(shares)).max() < 0.02
    h = np.array([s.h for s in states])
    assert np.abs(np.diff(h)).max() < 0.01 * h.mean()
    if not options.get("relief"):
        assert h[0] == pytest.approx(h[-1], rel=1e-9)


def test_edge_carries_before_the_path(kernel: Kernel):
    """The later pair's force starts at the tip edge of the driven wheel, before its path."""
    mesh = involute_mesh()
    seen = [at(kernel, mesh, x) for x in np.linspace(-0.2, 0.02, 221)]
    first = next(s for s in seen if s.force[s.numbers == 0].any())
    assert first.zones[first.numbers == 0] == EDGE_B
    last = at(kernel, mesh, mesh_end(mesh) + 0.02)
    assert last.zones[last.numbers == 0] == EDGE_A
    assert last.force[last.numbers == 0] > 0


def mesh_end(mesh: Mesh) -> float:
    return float((mesh.ends[0] - start_of_path(mesh)) / mesh.base_pitch)


@every_mesh
def test_mesh_is_the_same_a_pitch_on(kernel: Kernel, options: dict):
    mesh = involute_mesh(**options)
    if options.get("relief"):
        for w in range(2):
            mesh.flanks[w][3:] = [0, 0]  # else the teeth are different
    for x in (-0.03, 0.2, 0.7):
        one, next_one = at(kernel, mesh, x), at(kernel, mesh, x + 1)
        assert one.h == pytest.approx(next_one.h, rel=1e-9)
        np.testing.assert_array_equal(one.numbers + 1, next_one.numbers)
        np.testing.assert_allclose(one.force, next_one.force, rtol=1e-7, atol=1e-6 * LOAD)


@pytest.mark.parametrize("load", [1.0, 1e2, 1e4, 1e6])
def test_any_load_finds_its_place(kernel: Kernel, load: float):
    mesh = involute_mesh((19, 34), relief=5e-6)
    for x in np.linspace(0, 1, 25):
        state = at(kernel, mesh, x, load)
        assert state.h > state.h_0
        assert state.gradient[0] == pytest.approx(load * mesh.width, rel=1e-12)


def test_errors_of_the_teeth_move_the_free_play(kernel: Kernel):
    """Without load the first pair touches: h_0 is the smallest deviation on the path."""
    mesh = involute_mesh()
    for w in range(2):
        mesh.flanks[w][:] = [5e-6, 0, 0, 0, 0]
    mesh.flanks[0][3] = 2e-6  # times the cosine of the pair's number
    state = at(kernel, mesh, 0.3)
    assert state.h_0 == pytest.approx(1e-5 + 2e-6 * np.cos(1), abs=1e-14)  # pairs 0 and -1


def test_edge_in_the_fillet_is_refused(kernel: Kernel):
    mesh = involute_mesh()
    mesh.fillets[0] = start_of_path(mesh) + 1e-3  # the foot point reverses there
    rho_a = start_of_path(mesh) - 0.05 * mesh.base_pitch
    state = static_mesh(kernel, mesh, rho_a, LOAD * mesh.width)
    assert state.code == OUT_OF_DOMAIN
    assert "tip edge of the driven wheel touches the fillet of the driving wheel" in state.message
    assert "relieve the tips" in state.message


def test_no_pair_within_reach_is_refused(kernel: Kernel):
    mesh = involute_mesh()
    mesh.ends[0] = mesh.ends[1] = 0.3 * mesh.line
    mesh.reach = 0.0
    state = static_mesh(kernel, mesh, 0.4 * mesh.line, LOAD * mesh.width)
    assert state.code == NO_SOLUTION
    assert "no tooth pair can touch" in state.message


def test_contact_ratio_below_one_rests_on_its_edges(kernel: Kernel):
    """Without a pair on the path an edge supports the wheels."""
    mesh = involute_mesh()
    short = 0.45 * mesh.base_pitch
    mesh.ends[0] = mesh.ends[1] = mesh.line / 2 + short
    states = [at(kernel, mesh, x) for x in np.linspace(0, 1, 41)]
    assert any((s.zones[s.force > 0] != FLANK).all() for s in states)


def test_pair_that_waits_past_a_base_circle_does_no_harm(kernel: Kernel):
    """Its foot is at a negative roll length, where the logarithm of two materials is undefined."""
    mesh = involute_mesh((16, 120), unequal=True)
    states = [at(kernel, mesh, x) for x in np.linspace(-0.45, 0.55, 101)]
    assert min(s.feet.min() for s in states) < -1e-3
    assert all(s.force[(s.feet < 0).any(1)].sum() == 0 for s in states)


def test_pair_that_comes_early_by_its_errors_is_the_first_to_touch(kernel: Kernel):
    """4 um before its nominal start, by 10 um more material than the flanks on the path have."""
    mesh = involute_mesh()
    mesh.reach = 0.0
    mesh.flanks[0][3] = 1e-5  # times the cosine of the pair's number: 3 has -9.9 um, 2 has -4.2 um
    mesh.flanks[0][0] = -4e-6
    state = at(kernel, mesh, 3 - 4e-6 / mesh.base_pitch, load=10.0)
    assert state.h_0 == pytest.approx(-4e-6 + 1e-5 * np.cos(3), abs=1e-14)
    assert state.force[state.numbers == 3] == pytest.approx(10.0, rel=1e-3)


def test_pair_that_would_carry_past_the_reach_of_its_edge_is_refused(kernel: Kernel):
    """First contact of 50/50 is 0.0988 pitches before the path."""
    mesh = involute_mesh()
    mesh.reach = 0.05 * mesh.base_pitch
    state = static_mesh(kernel, mesh, start_of_path(mesh) - 0.07 * mesh.base_pitch, LOAD * 0.02)
    assert state.code == OUT_OF_DOMAIN
    assert "another tooth pair would carry with a tip edge 0.05 pitches off" in state.message
    assert "reduce the load" in state.message
    mesh.reach = 0.4 * mesh.base_pitch
    assert at(kernel, mesh, -0.07).force[0] >= 0


def test_pair_past_both_ends_is_refused(kernel: Kernel):
    """A path of 4 um, shorter than the deflection of the teeth."""
    mesh = involute_mesh()
    mesh.ends[0] = mesh.ends[1] = mesh.line / 2 + 2e-6
    state = static_mesh(kernel, mesh, mesh.line / 2 + 3e-6, LOAD * mesh.width)
    assert state.code == OUT_OF_DOMAIN
    assert "past both ends of its path of contact" in state.message
