"""What a wheel's compliance answers: values, derivatives, lanes, formulas, tables."""

from __future__ import annotations

import numpy as np
import pytest

from compliance.asked import LANES, Answers, analytic, ask_polynomial, ask_table
from compliance.influence import Influence, _polynomial, influence
from compliance.test_influence import KNOWN
from kernel.gears import gear
from kernel.kernel import Floats, Kernel

# E c by the same formulas elsewhere, at the places of KNOWN
FORMULAS = {
    50: [4.3397, 5.1838, 6.4459, 8.3135, 11.1040],
    19: [2.9369, 3.6205, 4.6903, 6.2734, 8.6818],
}
TABLE = np.array([[4.0, 5.0, 7.0, 8.0, 10.0], [2.0, 2.5, 2.5, 4.0, 9.0]])
NEXT = np.array([1.9, 1.8, 1.7, 1.6, 1.4])


@pytest.fixture(scope="module")
def samples(kernel: Kernel) -> Influence:
    """Samples of a wheel of 25 teeth."""
    return influence(kernel, gear(kernel, 25, 1.0), 4.0)


def positions_of(samples: Influence) -> Floats:
    """Places inside and beyond both ends."""
    low, high = samples.rho[[0, -1]]
    return np.linspace(low - 0.2, high + 0.3, 23)


def _differences(
    positions: Floats, at: Answers, up: Answers, down: Answers, step: float
) -> tuple[Floats, Floats]:
    own = (up.own[:, :2] - down.own[:, :2]) / (2 * step)
    assert len(own) == len(positions)
    return own, at.own[:, 1:]


def test_polynomials_go_through_the_samples_and_scale_with_the_modulus(
    kernel: Kernel, samples: Influence
) -> None:
    """C at its 17 points; c_j at every other one here and the next there."""
    at = ask_polynomial(kernel, samples, 1, samples.rho, 2.06e11)
    assert at.own[:, 0] * 2.06e11 == pytest.approx(samples.own, rel=1e-13)
    nodes = samples.rho[::2].copy()
    for j in (1, 2, 3, -1, -2, -3):
        at = ask_polynomial(kernel, samples, j, nodes)
        c = samples.other(j)
        expected = [c[i, (i + 1) % len(nodes)] for i in range(len(nodes))]
        assert at.coupled[:, 0] == pytest.approx(expected, rel=1e-12)
    assert not ask_polynomial(kernel, samples, 4, nodes).coupled.any()


@pytest.mark.parametrize("which", ["polynomial", "table"])
@pytest.mark.parametrize("j", [1, -1])
def test_derivatives_are_those_of_the_values(
    kernel: Kernel, samples: Influence, which: str, j: int
) -> None:
    """Central differences of values and of slopes, away from the ends and knots."""
    step = 1e-5
    if which == "polynomial":
        # none within a step of an end, where c'' jumps
        positions = positions_of(samples)

        def ask(x: Floats) -> Answers:
            return ask_polynomial(kernel, samples, j, np.ascontiguousarray(x))

    else:
        positions = np.linspace(3.3, 11.1, 23)

        def ask(x: Floats) -> Answers:
            return ask_table(kernel, *TABLE.copy(), NEXT, j, np.ascontiguousarray(x))

    at, up, down = ask(positions), ask(positions + step), ask(positions - step)
    # truncation 1e-10 of the third derivative, rounding 1e-16/1e-5
    assert (up.own[:, :2] - down.own[:, :2]) / (2 * step) == pytest.approx(
        at.own[:, 1:], rel=1e-6, abs=1e-7
    )
    # both places move: the sum of both derivatives
    both = (up.coupled[:, 0] - down.coupled[:, 0]) / (2 * step)
    assert both == pytest.approx(at.coupled[:, 1] + at.coupled[:, 2], rel=1e-6, abs=1e-8)
    slopes = (up.coupled[:, 1:3] - down.coupled[:, 1:3]) / (2 * step)
    mixed = at.coupled[:, 3:5] + at.coupled[:, 4:6]
    assert slopes == pytest.approx(mixed, rel=1e-6, abs=1e-7)


def test_beyond_its_ends_c_goes_on_straight(kernel: Kernel, samples: Influence) -> None:
    """Value and slope are continuous there, and the slope stays."""
    low, high = samples.rho[[0, -1]]
    at = ask_polynomial(
        kernel, samples, 1, np.array([low, low - 0.5, high, high + 0.5, low, low, low, low, low])
    )
    value, slope, curvature = at.own.T
    for end, beyond, distance in ((0, 1, -0.5), (2, 3, 0.5)):
        assert slope[beyond] == slope[end]
        assert curvature[beyond] == 0
        assert value[beyond] == pytest.approx(value[end] + distance * slope[end], rel=1e-14)


@pytest.mark.parametrize("which", ["polynomial", "table"])
def test_eight_states_at_once_get_what_one_gets(
    kernel: Kernel, samples: Influence, which: str
) -> None:
    """C, its slope, c_j and its derivatives."""
    if which == "polynomial":
        positions = positions_of(samples)[::2]
        at = ask_polynomial(kernel, samples, -2, positions.copy())
    else:
        at = ask_table(kernel, *TABLE.copy(), NEXT, 1, np.linspace(3.0, 11.0, 12))
    # another order of the same operations
    assert at.lanes[:, :2] == pytest.approx(at.own[:LANES, :2], rel=1e-12, abs=1e-13)
    assert at.lanes[:, 2:] == pytest.approx(at.coupled[:LANES, :3], rel=1e-12, abs=1e-13)


def test_table_is_met_and_does_not_overshoot(kernel: Kernel) -> None:
    """Between knots c stays between their values, and constant values stay constant."""
    rho, c = TABLE.copy()
    at = ask_table(kernel, rho, c, np.empty(0), 1, np.concatenate([rho, [5.5, 6.0, 6.5, 7.0]]))
    assert at.own[:5, 0] == pytest.approx(c, rel=1e-15)
    assert at.own[5:, 0] == pytest.approx(2.5, rel=1e-15)
    fine = np.linspace(4, 10, 200)
    at = ask_table(kernel, rho, c, np.empty(0), 1, fine)
    assert np.all(np.diff(at.own[:, 0]) >= -1e-14)
    assert not at.coupled.any()


def test_table_that_rises_and_falls_turns_at_its_knots(kernel: Kernel) -> None:
    """Fritsch and Butland: between two knots c is between their values, flat where it turns."""
    rho, c = np.array([4.0, 5.0, 7.0, 8.0, 10.0]), np.array([2.0, 5.0, 3.0, 3.5, 1.0])
    at = ask_table(kernel, rho, c, np.empty(0), 1, rho.copy())
    assert at.own[1:4, 1] == pytest.approx(0, abs=1e-14)
    for i in range(4):
        within = ask_table(kernel, rho, c, np.empty(0), 1, np.linspace(rho[i], rho[i + 1], 50))
        ends = np.sort(c[i : i + 2])
        assert within.own[:, 0].min() >= ends[0] - 1e-14
        assert within.own[:, 0].max() <= ends[1] + 1e-14


@pytest.mark.parametrize("wheel", KNOWN)
def test_formulas_give_the_digits_of_another_program(
    kernel: Kernel, wheel: tuple[int, float, float]
) -> None:
    """E c at five places; the root of 19 teeth is wider than the ring was fitted for."""
    teeth, shift, bore = wheel
    geometry = gear(kernel, teeth, 3e-3, profile_shift=shift, bore=bore)
    rho, c, fitted = analytic(kernel, geometry, bore / 2)
    at = _polynomial(rho, c, np.array(KNOWN[wheel][0]) / 3)
    assert at == pytest.approx(FORMULAS[teeth], rel=2e-5)  # digits given
    assert fitted == (teeth == 50)


@pytest.mark.parametrize(
    ("teeth", "shift", "hub"), [(20, 0.3, 8.0), (40, 0.0, 12.0), (80, -0.3, 30.0)]
)
def test_formulas_are_within_a_tenth_of_the_elements(
    kernel: Kernel, teeth: int, shift: float, hub: float
) -> None:
    """Beside the whole deflection of a tooth, that of its contact under a narrow strip included."""
    geometry = gear(kernel, teeth, 1.0, profile_shift=shift)
    rho, c, _ = analytic(kernel, geometry, hub / 2)
    elements = influence(kernel, geometry, hub / 2)
    contact = 2 / np.pi * (1 - 0.3**2) * (np.log(4 * rho / 0.05) - 0.5)
    assert np.all(np.abs((c - elements.own_at(rho + 1e-9)) / (elements.own + contact)) < 0.1)
