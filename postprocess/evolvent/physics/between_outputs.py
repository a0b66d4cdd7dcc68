"""Values of smooth signals between the outputs of a history: extremes, and both sides of events."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Values = NDArray[np.float64]

MOST_OVERSHOOT = 0.25  # of an extreme beyond an output, over the difference to a neighbour
MOST_DISTANCE = 0.3  # from an output to the event, over the distance of the outputs: farther
# extrapolations overshoot the peaks of corner contacts
MOST_GROWTH = 1.3  # of the slope up to an event, over that between the outputs before it


def with_extremes(
    times: Values, values: Values, events: Values, period: float | None = None
) -> Values:
    """Values at the outputs, with local extremes between them and the values beside events.

    Where no event separates an output that is a local extreme from its neighbours, its value
    becomes that of the vertex of the parabola through the three. At events near an output, values
    extrapolated by parabolas are inserted. Equation LS2.

    Parameters
    ----------
    times : increasing, of the outputs [s], shape (n,).
    values : smooth between events, shape (n, signals).
    events : increasing times at which the signals may have kinks or steps [s].
    period : the outputs repeat after this time, which is at least their time span [s].

    Returns
    -------
    In order of time, shape (at least n, signals). With a period they start with the second output.
    """
    n = times.size
    if n < 3:
        return values
    if period is not None:
        times = np.concatenate([times, times[:3] + period])
        values = np.concatenate([values, values[:3]])
        events = np.concatenate([events, events + period])
    part = np.searchsorted(events, times, side="right")
    refined = values.copy()
    inside = part[:-2] == part[2:]
    refined[1:-1][inside] = _vertices(times, values)[inside]
    rows, more = _beside_events(times, values, events, part)
    order = np.insert(np.arange(times.size, dtype=float), rows, rows - 0.5)
    refined = np.insert(refined, rows, more, axis=0)
    return refined if period is None else refined[(order >= 1) & (order < n + 1)]


def _vertices(times: Values, values: Values) -> Values:
    """Values of inner outputs; of local extremes the vertex of the parabola through neighbours."""
    step = np.diff(times)[:, None]
    rise = np.diff(values, axis=0)
    slope = rise / step
    before, behind = step[:-1], step[1:]
    bend = (slope[1:] - slope[:-1]) / (before + behind)
    at = (slope[:-1] * behind + slope[1:] * before) / (before + behind)
    is_extreme = (rise[:-1] * rise[1:] <= 0.0) & (bend != 0.0)
    most = MOST_OVERSHOOT * np.maximum(abs(rise[:-1]), abs(rise[1:]))
    over = -(at**2) / np.where(is_extreme, 4.0 * bend, 1.0)
    return np.asarray(values[1:-1] + np.where(is_extreme, np.clip(over, -most, most), 0.0))


def _beside_events(
    times: Values, values: Values, events: Values, part: NDArray[np.int64]
) -> tuple[NDArray[np.int64], Values]:
    """Values at events between two outputs, and the rows before which they belong."""
    last = times.size - 1
    row = np.flatnonzero(np.diff(part))
    own = np.concatenate([row[:, None] - [0, 1, 2], row[:, None] + [1, 2, 3]])
    at = np.concatenate([events[part[row]], events[part[row + 1] - 1]])
    fits = (own.min(axis=1) >= 0) & (own.max(axis=1) <= last)
    own = np.clip(own, 0, last)
    fits &= part[own[:, 0]] == part[own[:, 2]]
    fits &= abs(at - times[own[:, 0]]) <= MOST_DISTANCE * abs(times[own[:, 0]] - times[own[:, 1]])
    before = np.concatenate([row, row])[fits] + 1
    order = np.argsort(before, kind="stable")
    own, at = own[fits][order], at[fits][order]
    return before[order], _extrapolated(times[own].T[:, :, None], values[own], at[:, None])


def _extrapolated(times: Values, values: Values, time: Values) -> Values:
    """Values at times of the parabolas through three outputs, the nearest first.

    Parameters
    ----------
    times : shape (3, events, 1). values : shape (events, 3, signals). time : shape (events, 1).
    """
    near, middle, far = times
    value = np.moveaxis(values, 1, 0)
    first = (value[0] - value[1]) / (near - middle)
    second = (first - (value[1] - value[2]) / (middle - far)) / (near - far)
    change = (time - near) * (first + second * (time - middle))
    steps = np.abs(np.diff(value, axis=0)).max(axis=0)
    most = MOST_GROWTH * steps * np.abs((time - near) / (near - middle))
    return np.asarray(value[0] + np.clip(change, -most, most))
