"""Order map: spectra of short windows along a record."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from evolvent.errors import USAGE, HistoryError
from evolvent.signals.sampling import Record
from evolvent.signals.spectrum import line_spectrum
from evolvent.signals.windows import window

Numbers = NDArray[np.float64]


@dataclass(frozen=True)
class OrderMap:
    """Spectra over time."""

    order: Numbers
    time: Numbers  # middle of each window [s]
    rate: Numbers  # periods per second, the mean over the window
    amplitude: Numbers  # dims (time, order)
    phase: Numbers  # dims (time, order) [rad]


def order_map(
    record: Record, label: str, length: int, hop: int, name: str, highest: float
) -> OrderMap:
    """Compute spectra of windows of whole periods.

    Parameters
    ----------
    record : over an angle.
    label : of the history, for error messages.
    length : periods of a window.
    hop : periods from window to window.
    name : of the window function.
    highest : order.

    Raises
    ------
    HistoryError
        The record is too short for two windows.
    """
    assert record.per_period is not None
    assert record.of is not None
    n, advance = length * record.per_period, hop * record.per_period
    starts = range(0, record.values.size - n + 1, advance)
    if len(starts) < 2:
        raise HistoryError(
            f"{label}: holds {record.periods:.4g} {record.of.periods} of {record.of}, too few for "
            f"two windows of {length}, {hop} apart; choose a shorter --length, or increase the "
            "duration",
            USAGE,
        )
    weights = window(name, n)
    parts = [record.part(start, start + n) for start in starts]
    lines = [line_spectrum(p.values, p.first, p.step, weights).upto(highest) for p in parts]
    return OrderMap(
        lines[0].abscissa,
        np.array([(p.time[0] + p.time[-1]) / 2 for p in parts]),
        np.array([p.rate for p in parts]),
        np.stack([line.amplitude for line in lines]),
        np.stack([line.phase for line in lines]),
    )
