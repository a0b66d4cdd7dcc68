"""Rotation of wheels in pitches and revolutions, the positions of outputs."""

from __future__ import annotations

import numpy as np
import pytest

from kernel.gearbox import Gearbox
from kernel.gearbox_cases import chain, prescribed, scatter, wheels_of_meshes
from kernel.gearbox_description import CLOSED_FORM, REST, SPEED, TORQUE, load, mesh, wheel
from kernel.housing_description import HARMONIC, PRESCRIBED, TURN_Z, housing, term
from kernel.kernel import Kernel

SENSES = pytest.mark.parametrize("sigma", [1, -1])


def trains(kernel: Kernel, sigma: int) -> list[Gearbox]:
    """Trains whose reference wheel is the first and, with a prescribed speed, the driven one."""
    return [chain(kernel, 3, CLOSED_FORM, sigma=sigma), prescribed(kernel, CLOSED_FORM, sigma)]


@SENSES
def test_pitches_are_those_of_the_driving_wheels_angle_from_the_start_of_contact(
    kernel: Kernel, sigma: int
):
    random = np.random.default_rng(1)
    for gearbox in trains(kernel, sigma):
        for _ in range(20):
            state = scatter(gearbox, random)
            values = gearbox.outputs(state)
            for m, driving in enumerate(wheels_of_meshes(gearbox, state, "driving")):
                angle = values["angle"][driving] / (2 * np.pi)
                sense = -gearbox.mesh_geometry(m).sigma  # +1 of A is clockwise
                # pairs defined by a pressure angle start at the start of contact in every mesh
                expected = sense * values["teeth"][driving] * angle
                assert gearbox.pitches(state, m) == pytest.approx(expected, rel=1e-13, abs=1e-13)
                assert gearbox.turns(state, driving) == pytest.approx(
                    -gearbox.mesh_geometry(0).sigma * (-1) ** m * angle, rel=1e-13, abs=1e-15
                )


@SENSES
def test_whole_turns_of_the_reference_wheel_keep_their_digits(kernel: Kernel, sigma: int):
    """Ten million revolutions are an exact integer part; no step when they are subtracted."""
    random = np.random.default_rng(2)
    for gearbox in trains(kernel, sigma):
        state = scatter(gearbox, random)
        theta = gearbox.index("reference_angle")
        for turns in (1, -3, 10_000_000):
            there, taken = state.copy(), state.copy()
            there.integers[0] += turns
            taken.integers[0] += turns - 1
            taken.y[theta] += 2 * np.pi
            for ask, n in ((gearbox.pitches, gearbox.sizes.n_meshes), (gearbox.turns, 2)):
                for i in range(n):
                    moved = ask(there, i) - ask(state, i)
                    one = state.copy()
                    one.integers[0] += 1
                    assert moved == pytest.approx(turns * (ask(one, i) - ask(state, i)), rel=1e-12)
                    assert ask(taken, i) == pytest.approx(ask(there, i), rel=1e-15, abs=1e-13)


def test_they_are_linear_in_the_state(kernel: Kernel):
    """Linearity makes a step's dense output of them a polynomial."""
    random = np.random.default_rng(3)
    for gearbox in trains(kernel, 1):
        one, two = scatter(gearbox, random), scatter(gearbox, random)
        two.integers[:] = one.integers
        between = one.copy()
        between.y[:] = 0.3 * one.y + 0.7 * two.y
        for ask in (gearbox.pitches, gearbox.turns):
            assert ask(between) == pytest.approx(0.3 * ask(one) + 0.7 * ask(two), abs=1e-13)


def pair(kernel: Kernel, *loads: object) -> Gearbox:
    wheels = [wheel(teeth=20, pitch_radius=0.2), wheel(teeth=30)]
    return Gearbox(kernel, wheels, list(loads), [mesh(kernel)])


def test_only_what_something_turns_can_turn(kernel: Kernel):
    free, pushed = pair(kernel), pair(kernel, load(0, TORQUE, -1.0))
    held = pair(kernel, load(0, TORQUE, -1.0), load(1, SPEED, 0.0))
    driven = pair(kernel, load(1, SPEED, table=[(0.0, 0.0), (1.0, 0.3)]))
    for gearbox, expected in (
        (free, (False, False)),
        (pushed, (True, True)),
        (held, (True, False)),
        (driven, (True, True)),
    ):
        state = gearbox.start(REST)
        assert tuple(gearbox.can_turn(state, i) for i in (0, 1)) == expected
    wheels = [wheel(teeth=20, pitch_radius=0.2), wheel(teeth=30)]
    swinging = housing(PRESCRIBED, terms=[term(TURN_Z, HARMONIC, 0.1, frequency=3.0)])
    shaken = Gearbox(kernel, wheels, [], [mesh(kernel)], swinging)
    assert shaken.can_turn(shaken.start(REST), 0)
    moving = free.start(REST)
    moving.y[free.index("reference_speed")] = 1e-9
    assert free.can_turn(moving, 1)
