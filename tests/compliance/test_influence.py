"""Influence functions of wheels: known digits, symmetry, refinement, sense, a whole wheel."""

from __future__ import annotations

import numpy as np
import pytest

from compliance.influence import OTHER, Influence, influence
from kernel.gears import gear
from kernel.kernel import Floats, Kernel, KernelError, _at

# teeth, profile shift, bore [m]; module 3 mm, rack 1/1.25/0.38, 20 degrees, steel, plane strain.
# rho [mm], E c, E c_1, E c_2 by another program of finite elements, which calls the error 2e-4
RHO_50 = [19.616157, 23.299863, 26.475907, 29.309788, 31.892847]
RHO_19 = [7.742616, 11.091288, 13.641307, 15.784608, 17.669816]
KNOWN = {
    (50, 0.0, 40e-3): (
        RHO_50,
        [4.33567, 5.10490, 6.25779, 7.99429, 10.62690],
        [4.01596, 3.98880, 3.94574, 3.88513, 3.80629],
        [3.61272, 3.60202, 3.58746, 3.56882, 3.54608],
    ),
    (19, 0.4, 25e-3): (
        RHO_19,
        [2.51396, 3.07407, 3.99678, 5.41464, 7.62633],
        [1.55486, 1.51845, 1.46428, 1.39107, 1.29824],
        [1.12967, 1.12085, 1.10840, 1.09216, 1.07208],
    ),
}
# E c_1 between both ends of the rows above, and with the places exchanged
SENSE = {50: (4.0418, 3.8890), 19: (1.5565, 1.3942)}
# z, x, hub radius and module alike: few and many teeth, thick and thin bodies
WHEELS = [(12, 0.5, 2.0), (19, 0.4, 4.2), (30, -0.1, 12.4), (50, 0.0, 6.7), (120, 0.3, 20.0)]


def known(kernel: Kernel, wheel: tuple[int, float, float], order: int = 8) -> Influence:
    """Influence functions of one of the wheels above."""
    teeth, shift, bore = wheel
    geometry = gear(kernel, teeth, 3e-3, profile_shift=shift, bore=bore)
    return influence(kernel, geometry, bore / 2, order=order)


@pytest.mark.parametrize("wheel", KNOWN)
def test_digits_are_those_of_another_program(
    kernel: Kernel, wheel: tuple[int, float, float]
) -> None:
    """C, c_1 and c_2 at five places of two wheels, within the error of both."""
    rho, own, first, second = (np.array(row) for row in KNOWN[wheel])
    found = known(kernel, wheel)
    assert found.own_at(rho / 3) == pytest.approx(own, rel=3e-4)
    for j, row in ((1, first), (2, second)):
        assert [found.other_at(j, r, r) for r in rho / 3] == pytest.approx(row, rel=3e-4)


@pytest.mark.parametrize("wheel", KNOWN)
def test_neighbours_count_toward_the_side_that_the_flank_faces(
    kernel: Kernel, wheel: tuple[int, float, float]
) -> None:
    """c_1 at the root here and the tip there is another number than the other way round."""
    rho = np.array(KNOWN[wheel][0]) / 3
    found = known(kernel, wheel)
    there, back = found.other_at(1, rho[0], rho[-1]), found.other_at(1, rho[-1], rho[0])
    assert (there, back) == pytest.approx(SENSE[wheel[0]], abs=1e-4)  # the digits given


@pytest.mark.parametrize(("teeth", "shift", "hub"), WHEELS)
def test_finer_elements_change_nothing(
    kernel: Kernel, teeth: int, shift: float, hub: float
) -> None:
    """Order 8 beside 10: less than 5e-5 of 1/E."""
    geometry = gear(kernel, teeth, 1.0, profile_shift=shift)
    coarse, fine = (influence(kernel, geometry, hub, order=p) for p in (8, 10))
    assert np.abs(fine.own - coarse.own).max() < 5e-5
    assert np.abs(fine.samples - coarse.samples).max() < 1e-6


@pytest.mark.parametrize(("teeth", "shift", "hub"), WHEELS)
def test_places_of_load_and_displacement_may_be_exchanged(
    kernel: Kernel, teeth: int, shift: float, hub: float
) -> None:
    """c_j(a, b) = c_-j(b, a), each from its own sum, and the own tooth gives way most."""
    found = influence(kernel, gear(kernel, teeth, 1.0, profile_shift=shift), hub)
    for j in (1, 2, 3):
        assert np.abs(found.other(j) - found.other(-j).T).max() < 1e-11
        assert np.all(np.diag(found.other(j)) < found.own[::2] + 4)


def test_stress_in_place_of_strain_and_another_material_change_c_as_they_must(
    kernel: Kernel,
) -> None:
    """Without Poisson's effect both plane states are one; with it plane stress gives way more."""
    geometry = gear(kernel, 30, 1.0)
    strain, stress = (influence(kernel, geometry, 5.0, nu=0.0, stress=s) for s in (False, True))
    assert np.abs(strain.own - stress.own).max() < 1e-12
    strain, stress = (influence(kernel, geometry, 5.0, stress=s) for s in (False, True))
    assert np.all(stress.own > strain.own)
    # plane strain with nu is plane stress with E (1-nu^2), nu/(1-nu); c E' depends on that alone
    like = influence(kernel, geometry, 5.0, nu=0.3 / 0.7, stress=True)
    assert np.abs(like.own * (1 - 0.3**2) - strain.own).max() < 1e-9


def test_units_of_length_do_not_matter(kernel: Kernel) -> None:
    """E c of a wheel of module 3 mm is that of module 1 m."""
    small = influence(kernel, gear(kernel, 25, 3e-3), 12e-3)
    large = influence(kernel, gear(kernel, 25, 1.0), 4.0)
    assert np.abs(small.own - large.own).max() < 1e-9


def _whole_wheel(teeth: int, halves: list[Floats], n: int, loaded: int) -> Floats:
    """Displacements at all loads' places of all teeth, (tooth, at, load), by one system."""
    symmetric, antisymmetric = halves
    mirror = np.tile([1.0, -1.0], n // 2)
    k = np.zeros((teeth * n, teeth * n))
    m = symmetric.shape[0] - n
    shares = np.zeros((teeth, teeth * n, m))
    for tooth in range(teeth):
        left, right = np.zeros((2, n, teeth * n))
        left[:, tooth * n : (tooth + 1) * n] = np.eye(n)
        after = (tooth + 1) % teeth
        right[:, after * n : (after + 1) * n] = np.eye(n)
        for half, sign in ((symmetric, 1), (antisymmetric, -1)):
            v = (right + sign * mirror[:, None] * left) / 2
            k += 2 * v.T @ half[:n, :n] @ v
            shares[tooth] += v.T @ half[:n, n:]
    u = np.linalg.solve(k, shares[loaded])
    response = np.einsum("tua,ul->tal", shares, u)
    response[loaded] -= (symmetric[n:, n:] + antisymmetric[n:, n:]) / 2
    return response


@pytest.mark.parametrize("teeth", [5, 6])
def test_harmonics_of_a_wheel_are_the_wheel_put_together_and_a_load_may_turn_by_a_tooth(
    kernel: Kernel, teeth: int
) -> None:
    """Any stiffness of half a sector: tooth k counted from the loaded one, whichever that is."""
    n, m, last = 8, 3, 3
    rng = np.random.default_rng(16)
    halves = []
    for _ in range(2):
        root = rng.normal(size=(n + 2, n))
        half = np.zeros((n + m, n + m))
        half[:n, :n] = root.T @ root
        half[:n, n:] = rng.normal(size=(n, m))
        half[n:, :n] = half[:n, n:].T
        half[n:, n:] = -np.diag(rng.uniform(1, 2, m))
        halves.append(half)
    response = np.empty((last + 1, m, m))
    arguments = teeth, n, m, _at(halves[0]), _at(halves[1]), last, _at(response)
    assert kernel.library.test_wheel_response(*arguments) == 0
    for loaded in (0, 1, teeth - 1):
        whole = _whole_wheel(teeth, halves, n, loaded)
        for k in range(last + 1):
            # Fortran's (at, load) arrives as (load, at)
            there = whole[(loaded + k) % teeth].T
            assert response[k] == pytest.approx(there, rel=1e-10, abs=1e-10 * np.abs(whole).max())


def test_random_wheels_are_meshed(kernel: Kernel) -> None:
    """Teeth, shifts, allowances, hubs: c is found wherever a gear is, unless it is refused."""
    rng = np.random.default_rng(3)
    found = 0
    while found < 12:
        form = {
            "profile_shift": rng.uniform(-0.6, 1.0),
            "thickness_allowance": -rng.choice([0.0, 0.05, 0.15]),
            "tip_alteration": -rng.choice([0.0, 0.15]),
        }
        geometry = gear(kernel, int(rng.integers(16, 121)), 1.0, **form)
        if geometry.is_undercut or geometry.tip_thickness < 0.1:
            continue
        hub = rng.uniform(0.05, 1.0) * (geometry.root_radius - 1.2)
        at = influence(kernel, geometry, hub)
        # stiffer toward the root; a neighbour gives way less than 3 teeth away it would
        assert np.all(np.diff(at.own) > 0)
        assert np.all(np.isfinite(at.samples))
        assert at.other(1).shape == (OTHER, OTHER)
        found += 1


# rounding of the tip over the module: as in drawings, and nearly all of the tip
@pytest.mark.parametrize("rounding", [0.03, 0.1, 0.3])
@pytest.mark.parametrize(("teeth", "shift", "hub"), [(19, 0.4, 12.5e-3), (50, 0.0, 20e-3)])
def test_rounded_tips_are_meshed_and_finer_elements_change_nothing(
    kernel: Kernel, teeth: int, shift: float, hub: float, rounding: float
) -> None:
    """The corner that is missing moves c of the involute that is left by less than 1e-4 of it."""
    form = {"profile_shift": shift, "tip_rounding": rounding * 3e-3 * (0.6 if teeth == 19 else 1)}
    rounded = gear(kernel, teeth, 3e-3, **form)
    found, finer = (influence(kernel, rounded, hub, order=order) for order in (8, 10))
    # as of sharp tips: 5e-5 of E c, which is 2 and more
    assert found.own == pytest.approx(finer.own, abs=5e-5)
    sharp = influence(kernel, gear(kernel, teeth, 3e-3, profile_shift=shift), hub)
    inside = found.rho[1:-1]
    assert sharp.own_at(inside) == pytest.approx(found.own[1:-1], rel=2e-4)


def test_a_rounding_that_vanishes_leaves_the_sharp_tip(kernel: Kernel) -> None:
    sharp = influence(kernel, gear(kernel, 50, 3e-3), 20e-3)
    for rounding, most in ((1e-6, 1e-4), (1e-7, 1e-5)):
        found = influence(kernel, gear(kernel, 50, 3e-3, tip_rounding=rounding), 20e-3)
        inside = found.rho[1:-1]
        # the outermost places of load move with the end of the involute
        assert sharp.own_at(inside) == pytest.approx(found.own[1:-1], abs=most)


def test_random_rounded_wheels_are_meshed(kernel: Kernel) -> None:
    """No element folds: thin tips, many teeth, small and large roundings."""
    random = np.random.default_rng(1)
    meshed = 0
    while meshed < 12:
        teeth = int(np.exp(random.uniform(np.log(12), np.log(120))))
        shift, rounding = random.uniform(-0.3, 0.6), 10 ** random.uniform(-2.5, -0.4)
        try:
            rounded = gear(kernel, teeth, 1e-3, profile_shift=shift, tip_rounding=rounding * 1e-3)
        except KernelError as error:
            assert "overlap on a tooth" in error.message  # noqa: PT017
            continue
        if rounded.is_undercut:
            continue
        hub = random.uniform(0.1, 0.9) * (rounded.root_radius - 1.2e-3)
        assert influence(kernel, rounded, hub, order=6).own.min() > -2
        meshed += 1
