"""Step limits of a gearbox that resolve all periodic features."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from kernel.gearbox import Gearbox
from kernel.gearbox_cases import chain
from kernel.gearbox_description import CLOSED_FORM, TORQUE, VISCOUS, load, load_of, mesh, wheel
from kernel.housing_description import (
    CONSTANT,
    HARMONIC,
    PRESCRIBED,
    RATE,
    SPLINE,
    TURN_Z,
    X,
    Y,
    housing,
    term,
)
from kernel.kernel import Kernel
from kernel.radau import sight

ANY = np.finfo(float).max
TURN = 2 * np.pi


def pair(kernel: Kernel, *loads: Any, **more: Any) -> Gearbox:
    """Create a pair of 20 and 30 teeth; the driving wheel is the reference."""
    wheels = [wheel(teeth=20, pitch_radius=0.2, centre=(0.0, 0.0)), wheel(teeth=30)]
    always = [load(0, TORQUE, -1.0), load(1, VISCOUS, 10.0)]
    return Gearbox(kernel, wheels, [*always, *loads], [mesh(kernel)], **more)


def moved(kernel: Kernel, *terms: Any) -> Gearbox:
    return pair(kernel, housing=housing(PRESCRIBED, terms=terms))


def test_the_reference_angle_goes_by_a_pitch_and_no_other_state_is_held(kernel: Kernel):
    reach, time = sight(pair(kernel))
    assert reach[0] == pytest.approx(TURN / 20, rel=1e-15)
    assert (reach[1:] == ANY).all()
    assert time == ANY


def test_the_teeth_that_pass_fastest_count(kernel: Kernel):
    gearbox = chain(kernel, 4, CLOSED_FORM, sigma=1)  # idlers: all wheels have a common pitch
    teeth = (20, 33, 27, 20)
    theta = sight(gearbox)[0][0]
    assert any(theta == pytest.approx(TURN / z, rel=1e-14) for z in teeth)


@pytest.mark.parametrize(("wheel_of", "ratio"), [(0, 1.0), (1, 20 / 30)])
def test_a_load_by_the_angle_goes_by_a_cycle_of_its_wheel(kernel: Kernel, wheel_of, ratio):
    ripple = load_of(wheel_of, "harmonic", amplitude=1.0, order=100.0)
    reach, time = sight(pair(kernel, ripple))
    assert reach[0] == pytest.approx(TURN / 100 / ratio, rel=1e-14)
    assert time == ANY
    slow = load_of(wheel_of, "harmonic", amplitude=1.0, order=0.5)
    assert sight(pair(kernel, slow))[0][0] == pytest.approx(TURN / 20, rel=1e-14)


def test_time_goes_by_the_shortest_cycle_of_a_load(kernel: Kernel):
    loads = [load_of(0, "harmonic", amplitude=1.0, frequency=f) for f in (40.0, 250.0)]
    reach, time = sight(pair(kernel, *loads))
    assert time == pytest.approx(1 / 250, rel=1e-15)
    assert reach[0] == pytest.approx(TURN / 20, rel=1e-15)


def test_a_load_that_does_not_swing_has_no_cycle(kernel: Kernel):
    still = load_of(0, "harmonic", mean=1.0, amplitude=0.0, frequency=1e6)
    assert sight(pair(kernel, still))[1] == ANY


def test_time_goes_by_a_cycle_or_a_turn_of_the_housing(kernel: Kernel):
    shaken = [term(X, HARMONIC, 1e-4, frequency=f) for f in (7.0, 3.0)]
    assert sight(moved(kernel, *shaken))[1] == pytest.approx(1 / 7, rel=1e-15)
    turning = [term(TURN_Z, RATE, -50.0), term(Y, RATE, 1e4), term(X, CONSTANT, 1.0)]
    assert sight(moved(kernel, *turning))[1] == pytest.approx(TURN / 50, rel=1e-15)


@pytest.mark.parametrize(
    ("t", "expected"),
    [
        (0.0, 1.0),  # to the next knot: later ones are too close to be resolved from here
        (0.999, 0.004),  # beyond it, at most four times the distance of the knots there
        (1.0, 0.004),
        (1.0015, 0.0035),
        (1.007, 0.003),  # to the last but one: the last is too far
        (1.01, 1.99),
        (3.0, ANY),  # constant after the last knot
        (7.0, ANY),
    ],
)
def test_a_table_is_followed_to_its_next_knot_and_past_it_where_knots_are_close(
    kernel: Kernel, t: float, expected: float
):
    knots = [0.0, *(1 + 1e-3 * k for k in range(11)), 3.0]
    table = [(knot, 1e-6 * (knot == 1.005)) for knot in knots]
    found = sight(moved(kernel, term(X, SPLINE, table=table)), t)[1]
    assert found == (ANY if expected == ANY else pytest.approx(expected, rel=1e-9))
