"""Coupled tooth pairs: equations, potential, derivatives, rejected input."""

from __future__ import annotations

import mpmath as mp
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.optimize import minimize

from kernel.compliant import compliant_force, coupled_pairs
from kernel.kernel import OK, OUT_OF_DOMAIN, SINGULAR, Floats, Kernel

E_STAR = 1.1318681318681319e11  # steel on steel, E 206 GPa [Pa]
LENGTH = 0.0513
STIFF = np.pi * E_STAR
MOST = 6


def compliances(rng: np.random.Generator, n: int, coupling: float = 0.85) -> Floats:
    """Compliances of n pairs, as of teeth: own 15 to 32, neighbours less; positive definite."""
    own = rng.uniform(15, 32, n)
    index = np.arange(n)
    far = np.abs(index[:, None] - index)
    c = coupling * np.minimum.outer(own, own) * np.exp(-0.1 * far) * (far > 0)
    c += np.diag(own)
    return c / STIFF


def leftover(h: Floats, c: Floats, force: Floats) -> Floats:
    """Residual of the equations with 40 digits, relative to their largest term."""
    with mp.workdps(40):
        stiff = mp.pi * mp.mpf(E_STAR)
        rest = []
        for k, n_k in enumerate(map(mp.mpf, force)):
            coupled = [mp.mpf(float(c[k, i])) * mp.mpf(force[i]) for i in range(len(h))]
            own = n_k / stiff * (mp.log(4 * stiff * mp.mpf(LENGTH) / abs(n_k)) - 1) if n_k else 0
            rest.append((mp.mpf(h[k]) - own - sum(coupled)) / (abs(mp.mpf(h[k])) + sum(coupled)))
        return np.array([float(r) for r in rest])


def potential(force: Floats, h: Floats, c: Floats) -> float:
    """Work of the gaps less the complementary energy; W is 0 at N = 0."""
    with np.errstate(divide="ignore", invalid="ignore"):
        logs = np.where(force > 0, np.log(4 * STIFF * LENGTH / force) - 0.5, 0)
    return float(force @ h - force**2 @ logs / (2 * STIFF) - force @ c @ force / 2)


seeds = st.integers(0, 2**31)
numbers = st.integers(1, MOST)


@settings(max_examples=300, deadline=None, derandomize=True)
@given(seed=seeds, n=numbers, light=st.booleans())
def test_forces_solve_the_equations(kernel: Kernel, seed: int, n: int, light: bool):
    rng = np.random.default_rng(seed)
    c = compliances(rng, n)
    h = rng.uniform(-3e-6, 2e-5, n) * (10.0 ** rng.uniform(-9, 0) if light else 1)
    pairs = coupled_pairs(kernel, h, LENGTH, c, E_STAR)
    assert pairs.code == OK
    assert (pairs.force >= 0).all()
    carries = pairs.force > 0
    assert (np.abs(leftover(h, c, pairs.force)[carries]) < 1e-14).all()
    assert (pairs.g[~carries] <= 0).all()
    assert pairs.turns <= 30
    np.testing.assert_allclose(pairs.g, h - (c - np.diag(np.diag(c))) @ pairs.force, atol=1e-20)


@settings(max_examples=40, deadline=None, derandomize=True)
@given(seed=seeds, n=numbers)
def test_potential_has_its_maximum_there(kernel: Kernel, seed: int, n: int):
    """Against a maximisation independent of the equations; the energy is the potential."""
    rng = np.random.default_rng(seed)
    c = compliances(rng, n)
    h = rng.uniform(-3e-6, 2e-5, n)
    h[rng.integers(n)] = 1.5e-5
    pairs = coupled_pairs(kernel, h, LENGTH, c, E_STAR)
    unit = 1e5  # N/m, a typical force

    def loss(x: Floats) -> float:
        return -potential(unit * x, h, c)

    start = np.full(n, 0.5)
    found = minimize(
        loss,
        start,
        method="L-BFGS-B",
        bounds=[(0, None)] * n,
        options={"ftol": 1e-15, "gtol": 1e-13},
    )
    assert pairs.energy == pytest.approx(potential(pairs.force, h, c), rel=1e-13)
    assert -found.fun <= pairs.energy * (1 + 1e-13)
    # its line search ends where the potential is flat: 1e-8 of it
    assert -found.fun == pytest.approx(pairs.energy, rel=1e-7)


@settings(max_examples=60, deadline=None, derandomize=True)
@given(seed=seeds, n=numbers)
def test_changes_are_those_of_the_forces(kernel: Kernel, seed: int, n: int):
    """Central differences along random dh, dC and dLambda at once."""
    rng = np.random.default_rng(seed)
    c = compliances(rng, n)
    h = rng.uniform(5e-6, 2e-5, n)
    at = coupled_pairs(kernel, h, LENGTH, c, E_STAR)
    d_h = rng.uniform(-1, 1, n) * 1e-5
    d_c = rng.uniform(-1, 1, (n, n)) / STIFF
    d_c = (d_c + d_c.T) / 2
    d_length = LENGTH * rng.uniform(-1, 1)
    small = 1e-6

    def moved(by: float) -> Floats:
        there = coupled_pairs(kernel, h + by * d_h, LENGTH + by * d_length, c + by * d_c, E_STAR)
        return there.force

    change = coupled_pairs(
        kernel, h, LENGTH, c, E_STAR, ways=[d_h - d_c @ at.force], d_length=[d_length]
    ).change[0]
    if (at.g < 1e-9).any():
        return  # a pair that opens in between
    difference = (moved(small) - moved(-small)) / (2 * small)
    np.testing.assert_allclose(change, difference, atol=1e-7 * np.abs(change).max())


def test_one_pair_is_the_closed_form(kernel: Kernel):
    for h in np.logspace(-30, -3, 50):
        for body in (15, 30):
            pairs = coupled_pairs(kernel, [h], LENGTH, [[body / STIFF]], E_STAR)
            closed = compliant_force(kernel, h, LENGTH, body / STIFF, E_STAR)
            assert pairs.force[0] == pytest.approx(closed.force[0], rel=1e-13)
            assert pairs.energy == pytest.approx(closed.energy[0], rel=1e-13)


def test_pairs_without_coupling_stand_alone(kernel: Kernel):
    h = np.array([1e-5, 3e-6, -1e-6, 7e-6])
    body = np.array([16, 22, 19, 28]) / STIFF
    pairs = coupled_pairs(kernel, h, LENGTH, np.diag(body), E_STAR)
    alone = compliant_force(kernel, np.maximum(h, 0), LENGTH, body, E_STAR).force
    np.testing.assert_allclose(pairs.force, alone, rtol=1e-14)


def test_order_of_the_pairs_does_not_matter(kernel: Kernel):
    rng = np.random.default_rng(3)
    c = compliances(rng, 5)
    h = rng.uniform(2e-6, 2e-5, 5)
    order = rng.permutation(5)
    there = coupled_pairs(kernel, h, LENGTH, c, E_STAR).force
    back = coupled_pairs(kernel, h[order], LENGTH, c[np.ix_(order, order)], E_STAR).force
    np.testing.assert_allclose(back, there[order], rtol=1e-13)


def test_neighbours_load_opens_a_gap(kernel: Kernel):
    """Flanks of the second pair overlap, and yet it carries no load."""
    c = compliances(np.random.default_rng(0), 2)
    pairs = coupled_pairs(kernel, [1e-5, 1e-6], LENGTH, c, E_STAR)
    assert pairs.force[1] == 0
    assert pairs.g[1] < 0
    assert pairs.force[0] == compliant_force(kernel, 1e-5, LENGTH, c[0, 0], E_STAR).force[0]


def test_forces_pass_zero_smoothly_where_pairs_may_pull(kernel: Kernel):
    """An integrator searches the root of g from both sides: force and g are odd around it."""
    c = compliances(np.random.default_rng(0), 2)
    g, force = [], []
    heights = np.linspace(2e-6, 1e-5, 601)
    for h in heights:
        pairs = coupled_pairs(kernel, [1e-5, h], LENGTH, c, E_STAR, pushes_only=False)
        assert pairs.code == OK
        assert np.abs(leftover(np.array([1e-5, h]), c, pairs.force)).max() < 1e-14
        g.append(pairs.g[1])
        force.append(pairs.force[1])
    assert g[0] < 0 < g[-1]
    assert (np.sign(g) == np.sign(force)).all()
    assert (np.diff(force) > 0).all()
    pushing = coupled_pairs(kernel, [1e-5, heights[-1]], LENGTH, c, E_STAR)
    assert pushing.force[1] == pytest.approx(force[-1], rel=1e-14)


def test_force_that_begins_is_found_from_nothing(kernel: Kernel):
    """At the onset of load of a pair, dh/dN is infinite."""
    c = compliances(np.random.default_rng(0), 2)
    opened = c[0, 1] * compliant_force(kernel, 1e-5, LENGTH, c[0, 0], E_STAR).force[0]
    for past in (-1e-10, 1e-15, 1e-13, 1e-10, 1e-8):
        h = np.array([1e-5, opened * (1 + past)])
        pairs = coupled_pairs(kernel, h, LENGTH, c, E_STAR)
        assert pairs.code == OK
        assert pairs.turns <= 30
        assert (pairs.force[1] > 0) == (past > 0)
        carries = pairs.force > 0
        assert np.abs(leftover(h, c, pairs.force)[carries]).max() < 1e-14


def test_no_contact_no_force(kernel: Kernel):
    pairs = coupled_pairs(
        kernel, [-1e-6, 0.0], LENGTH, compliances(np.random.default_rng(1), 2), E_STAR
    )
    assert pairs.code == OK
    assert not pairs.force.any()
    assert pairs.energy == 0


def test_compliances_that_are_not_definite_are_refused(kernel: Kernel):
    """Two pairs with larger coupling than own compliance: no potential with a maximum."""
    c = np.array([[20.0, 90.0], [90.0, 20.0]]) / STIFF
    pairs = coupled_pairs(kernel, [1e-5, 1e-5], LENGTH, c, E_STAR, pushes_only=False)
    assert pairs.code in (SINGULAR, OUT_OF_DOMAIN)  # it diverges up to the limit of the law
    assert np.isnan(pairs.force).all()


def test_state_outside_the_domain_is_refused(kernel: Kernel):
    """And has no forces. Of a pair alone h(N) is largest, and dh/dN zero, at h = 4 L/e**2."""
    c = compliances(np.random.default_rng(1), 2)
    limit = 4 * LENGTH / np.e**2
    below = coupled_pairs(kernel, [0.999 * limit], LENGTH, [[0.0]], E_STAR)
    assert below.code == OK
    assert np.abs(leftover(np.array([0.999 * limit]), np.zeros((1, 1)), below.force)).max() < 1e-14
    for h, length, compliance in (
        ([1e-5, np.nan], LENGTH, c),
        ([1e-5, 1e-5], -1.0, c),
        ([1.001 * limit], LENGTH, [[0.0]]),
        ([1.0], LENGTH, [[0.0]]),
    ):
        pairs = coupled_pairs(kernel, h, length, compliance, E_STAR)
        assert pairs.code == OUT_OF_DOMAIN
        assert np.isnan(pairs.force).all()
