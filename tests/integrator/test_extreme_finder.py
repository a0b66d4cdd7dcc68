"""Where in a step an extreme may lie, by the values of a channel at its nodes."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import pytest

from integrator.radau import Floats, Library, _array, _pointer

MOST = 17  # candidates of one channel
NONE = 1e300  # nobody asks


class Candidate(NamedTuple):
    sense: float
    tau: float
    left: float
    right: float
    value: float


def candidates(
    library: Library, values: Floats, rough: bool, high: float = NONE, low: float = -NONE
) -> list[Candidate]:
    """Candidates of a channel with these values at the nodes; the last is at the start."""
    found = np.zeros((MOST, 5))
    n = library.c.rt_find_candidates(_pointer(_array(values)), rough, high, low, _pointer(found))
    return [Candidate(*row) for row in found[:n]]


SHAPES = {  # of time in the step, largest at
    "rises": (lambda tau: tau, 1.0),
    "falls": (lambda tau: -tau, 0.0),
    "crest": (lambda tau: -((tau - 0.4) ** 2), 0.4),
    "falls from a flat start": (lambda tau: -(tau**2), 0.0),
}
every_shape = pytest.mark.parametrize(("shape", "at"), SHAPES.values(), ids=SHAPES.keys())
up_and_down = pytest.mark.parametrize("sense", [1, -1], ids=["maximum", "minimum"])


def of(library: Library, shape, sense: int, rough: bool) -> Candidate:
    """The candidate of a channel whose extreme is 0.1 past what was known."""
    nodes = library.tables()["node"]
    values = sense * shape(nodes)
    limit = float(max(shape(np.linspace(0, 1, 1001)))) - 0.1
    asked = {"high": limit} if sense > 0 else {"low": -limit}
    (candidate,) = candidates(library, values, rough, **asked)
    assert candidate.sense == sense
    return candidate


@up_and_down
@every_shape
def test_the_extreme_of_a_polynomial_is_where_it_is(library: Library, shape, at, sense):
    candidate = of(library, shape, sense, rough=False)
    assert candidate.tau == pytest.approx(at, abs=1e-6)
    assert candidate.value == pytest.approx(sense * shape(at), abs=1e-12)
    assert candidate.left <= candidate.tau <= candidate.right


@up_and_down
@every_shape
def test_of_a_channel_that_is_estimated_all_of_the_step_is_looked_at(library, shape, at, sense):
    """Where an estimate is largest tells little of where the channel is: also at an end."""
    candidate = of(library, shape, sense, rough=True)
    assert (candidate.left, candidate.right) == (0, 1)


@every_shape
def test_a_channel_within_its_limits_has_no_candidate(library: Library, shape, at):
    values = shape(library.tables()["node"])
    for rough in (False, True):
        assert candidates(library, values, rough, high=5.0, low=-5.0) == []
