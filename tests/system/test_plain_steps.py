"""A sweep in plain steps, by an oscillator that knows nothing of the program."""

from __future__ import annotations

import pytest

from system.oscillator_alone import Oscillator, falls, steps


@pytest.mark.parametrize(
    ("omega", "known"), [(0.7, 0.363006711), (1.3, 0.182425960), (2.0, 0.652445783)]
)
def test_oscillator_alone_has_the_figures_of_another_program(omega: float, known: float) -> None:
    """Those that test_respond holds the program against."""
    motion = Oscillator()
    period = motion.settle(omega, 0.0, 2000)
    assert period in ({2, 4, 8} if omega == 2.0 else {1})
    assert motion.deviation(omega, 0.0, period) == pytest.approx(known, abs=1e-9)


@pytest.mark.parametrize("place", [0.0, 0.5])
def test_in_small_steps_the_motion_ends_where_respond_says(place: float) -> None:
    """0.4115, wherever in the pitch the speed changes."""
    values = [*steps(1.0, 0.46), *steps(0.459, 0.414, 0.001), *steps(0.41395, 0.411, 0.00005)]
    *_, (before, after, _) = falls(values, place)
    assert 0.4113 <= after < before <= 0.4117


def test_plain_steps_throw_it_out_earlier_and_where_they_are_taken_decides() -> None:
    """The table of the other program falls at 0.825 to 1.0698, and between 0.440 and 0.435."""
    ends = {place: falls(steps(2.4, 0.4), place)[-2:] for place in (0.2, 0.875)}
    (first, second), (_, last) = ends[0.2], ends[0.875]
    assert first == (0.83, 0.825, pytest.approx(1.0698, abs=6e-5))
    assert second[:2] == (0.415, 0.41)
    assert last[:2] == (0.44, 0.435)
