"""Single periodic orbits, driven and autonomous, and what is said where there is none."""

from __future__ import annotations

import numpy as np
import pytest

from continuation.orbits import OrbitError, System


def swept(system: System, y, parameter: float, turns: int, periods: int = 1):
    """Where a long run ends."""
    for _ in range(turns):
        y, _ = system.flow(y, periods * 2 * np.pi / parameter, parameter)
    return y


def test_an_orbit_that_is_known_is_found_with_its_multipliers(c):
    """z' = (l + iw - |z|^2) z around a cos Wt: the centre itself, with exp((l +- iw) T)."""
    frequency, rate, turning, amplitude = 1.3, -0.1, 0.77, 0.7
    system = System(c, "moving_focus", [frequency, rate, turning, amplitude])
    orbit = system.find([0.8, 0.1])
    assert orbit.y == pytest.approx([amplitude, 0], abs=1e-10)
    assert orbit.residual <= 1e-10
    expected = np.exp((rate + 1j * turning) * 2 * np.pi / frequency)
    assert orbit.multipliers == pytest.approx([expected.conj(), expected], abs=1e-11)


@pytest.mark.parametrize(
    ("name", "parameters", "start"),
    [
        ("backlash", [2.0, 0.05, 0.1, 0.3], [1, 0]),
        ("stop", [0.7, 0.05, 0.9, 1, 2], [0.4, 0.5]),
        ("duffing", [1.1, 0.1, 1, 1, 0.4], [0.6, -0.3]),
        ("parting", [0.9, 1.638, 0.03, 1], [3, 0.1]),
    ],
)
def test_an_orbit_is_where_a_long_run_ends(c, name, parameters, start):
    system = System(c, name, parameters)
    end = swept(system, start, parameters[0], 600)
    orbit = system.find(end + np.array([0.003, -0.002]))
    assert orbit.iterations > 0
    assert max(abs(orbit.multipliers)) < 0.96  # 600 periods are enough: 0.96**600 = 2e-11
    assert orbit.y == pytest.approx(end, abs=3e-9)  # residual 1e-10 over 1 - 0.96


def test_time_as_a_state_gives_the_driven_orbit_and_its_period(c):
    """Driven by a phase that advances by a turn: autonomous, with one multiplier 1 more."""
    parameters = [1.1, 0.1, 1, 1, 0.4]
    driven = System(c, "duffing", parameters)
    orbit = driven.find(swept(driven, [0.6, -0.3], 1.1, 100))
    free = System(c, "duffing_with_phase", parameters).find([*(orbit.y + 0.01), 0.0], period=5.6)
    assert free.period == pytest.approx(2 * np.pi / 1.1, abs=1e-10)
    expected = np.sort_complex([1, *orbit.multipliers])
    assert np.sort_complex(free.multipliers) == pytest.approx(expected, abs=1e-9)
    # the phase condition leaves the phase near that of the start: the same orbit, a little later
    later, _ = driven.flow(orbit.y, free.y[2] / 1.1 % (2 * np.pi / 1.1))
    assert free.y[:2] == pytest.approx(later, abs=1e-9)


def test_a_memory_that_nothing_sets_stays_as_it_is_and_is_no_multiplier(c):
    parameters = [0.8, 0.03, 0.2, 0.4, 0.3]
    system = System(c, "floating", parameters)
    for speed in (0.5, 1.0):
        orbit = system.find([-1.4, 0.1, speed])
        assert orbit.y[2] == speed
        assert len(orbit.multipliers) == 2
    # and that of the one which remembers is 0: it forgets in a period
    orbit = System(c, "remembering_stop", parameters).find([-2.3, 0.2, 0.6])
    assert len(orbit.multipliers) == 3
    assert abs(orbit.multipliers[2]) < 1e-12


def test_an_orbit_of_two_periods_has_the_square_of_the_multipliers(c):
    system = System(c, "duffing", [1.1, 0.1, 1, 1, 0.4])
    once = system.find([1.2, 0.3])
    twice = system.find(once.y, periods=2)
    assert twice.period == pytest.approx(2 * once.period)
    assert np.prod(twice.multipliers) == pytest.approx(np.prod(once.multipliers) ** 2, rel=1e-9)
    assert np.sum(twice.multipliers) == pytest.approx(np.sum(once.multipliers**2), rel=1e-9)


def test_modes_have_to_repeat_as_the_state_does(c):
    """A mode that changes once a period makes an orbit of two, though no state shows it."""
    system = System(c, "alternating", [1.3, -0.1, 0.77, 0.7])
    with pytest.raises(OrbitError, match="the state repeats, but the modes do not"):
        system.find([0.8, 0.1])
    twice = system.find([0.8, 0.1], periods=2)
    expected = np.exp((-0.1 + 0.77j) * 4 * np.pi / 1.3)
    assert twice.multipliers == pytest.approx([expected, expected.conj()], abs=1e-11)


def test_in_a_gap_without_a_spring_orbits_are_not_isolated(c):
    """Where nothing holds a mass with the mean force 0, every place is as good as the next."""
    system = System(c, "backlash", [2.0, 0.05, 0, 0.3])
    with pytest.raises(OrbitError, match="orbits are not isolated here"):
        system.find([0.1, 0.0])


def test_where_there_is_no_orbit_it_is_said_how_far_the_iteration_came(c):
    """z' = l - z^2 has no orbit for l < 0."""
    system = System(c, "moving_fold", [1.3, -0.003, 0.5], 1)
    said = (
        "no orbit of 1 periods was found at -0.003: after a period the state still differs by 0.01"
    )
    with pytest.raises(OrbitError, match=said):
        system.find([0.5])
    end = np.pi / 2 / np.sqrt(0.3)  # z = -sqrt(0.3) tan(sqrt(0.3) t)
    with pytest.raises(OrbitError, match=f"the state diverges at time {end:.5f}"):
        system.find([0.5], parameter=-0.3)


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"y": [np.nan, 0]}, "the start of an orbit is not finite"),
        ({"periods": 0}, "an orbit of no period"),
        ({"period": 0}, "period 0 is not positive"),
        ({"y": [0, 0]}, "the speed at the start is zero: no orbit passes through it"),
    ],
)
def test_a_bad_start_is_refused(c, change, message):
    system = System(c, "van_der_pol", [1])
    with pytest.raises(OrbitError, match=message):
        system.find(**({"y": [2, 0], "period": 6.5} | change))
