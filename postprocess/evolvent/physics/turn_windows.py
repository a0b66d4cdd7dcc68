"""Windows of whole revolutions of a wheel in a history."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from evolvent.errors import USAGE, HistoryError
from evolvent.history.recording import Recording

ROUNDING = 1e-9  # revolutions


@dataclass(frozen=True)
class TurnWindow:
    """Part of a history."""

    begin: float  # [s]; the output there, if any, is that of the end, one period earlier
    end: float  # time of its last output [s]
    first: int  # its outputs
    last: int  # index after the last one
    turns: float  # revolutions of the wheel
    repeats: bool  # it is one period of a repeating history: whole revolutions

    @property
    def period(self) -> float | None:
        """Duration of a repeating history [s]; None if it does not repeat."""
        return self.end - self.begin if self.repeats else None

    def kept(self, every: int, skipped: int = 0) -> NDArray[np.int64]:
        """Indices of its outputs, of the part that `first` starts.

        Parameters
        ----------
        every : every n-th output, counted from the end.
        skipped : outputs at the end that are left out.
        """
        return np.arange(self.last - self.first - 1 - skipped, -1, -every)[::-1]


def turn_window(
    run: Recording,
    label: str,
    wheel: int,
    turns: int,
    whole: bool,
    begin: float,
    end: float,
) -> TurnWindow:
    """Find the last revolutions of a wheel between two times.

    Parameters
    ----------
    label : of the history, for messages.
    wheel : its index.
    whole : take all outputs between the times, whatever the revolutions.

    Raises
    ------
    HistoryError
        The wheel makes fewer revolutions.
    """
    times = run["time"]
    first, last = np.searchsorted(times, (begin, end), side="left")
    last = int(np.searchsorted(times, end, side="right"))
    name = run.labels("wheel")[wheel]
    if last - first < 3:
        raise HistoryError(
            f"{label}: has {last - first} outputs in the window; it needs at least 3"
        )
    angle = run["angle"][first:last, wheel] / (2.0 * np.pi)
    passed = (angle - angle[-1]) * np.sign(angle[-1] - angle[0])
    if whole:
        return TurnWindow(
            float(times[first]), float(times[last - 1]), int(first), last, -float(passed[0]), False
        )
    before = np.flatnonzero(passed <= -turns + ROUNDING)
    if before.size == 0:
        raise HistoryError(
            f"{label}: wheel `{name}` makes {-passed[0]:.4g} revolutions from "
            f"{times[first]:.6g} to {times[last - 1]:.6g} s, less than {turns}; increase the "
            "duration, or count the whole window",
            USAGE,
        )
    row = int(before[-1])
    share = np.clip((-turns - passed[row]) / (passed[row + 1] - passed[row]), 0.0, 1.0)
    start = float(times[first + row] + share * (times[first + row + 1] - times[first + row]))
    return TurnWindow(start, float(times[last - 1]), int(first) + row + 1, last, float(turns), True)
