"""Rows of a history as equidistant samples: over time, or over the angle of a mesh or wheel."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from fractions import Fraction

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from evolvent.errors import BAD_INPUT, USAGE, HistoryError
from evolvent.history import require, rows_between, source_name
from evolvent.signals.resampling import REACH, ROWS_NEEDED, resample
from evolvent.signals.turning import Turning, find_turning, ratio

Numbers = NDArray[np.float64]

ON_GRID, TURNING_BACK = 0, 2  # values of `output_kind`
EVEN = 1e-6  # of a step: unevenness of equidistant rows by rounding and the text of a case
GAP = 1.5  # steps; a row is missing if two are further apart
STANDING = 1e-3  # periods; less is a standstill
MOST_SAMPLES = 2**23  # memory: each takes about 100 bytes during processing
STEADY = 0.01  # permitted change of speed over a record for a spectrum over frequency


@dataclass(frozen=True)
class Record:
    """A signal at equidistant positions."""

    values: Numbers
    time: Numbers  # [s]
    first: float  # position of the first sample [s, or periods]
    per_period: int | None  # samples per period; None over time
    step: float  # from sample to sample [s, or periods]
    rows: float  # smallest number of rows of the history in a period; samples per period if even
    of: Turning | None = None  # None over time

    @property
    def resampled(self) -> bool:
        """Whether the samples are interpolated between the rows."""
        return self.per_period is not None and self.rows != self.per_period

    @property
    def reach(self) -> float:
        """Highest resolved line: half the sampling rate, or the limit of exact interpolation."""
        half = 0.5 / self.step
        return min(half, REACH * self.rows) if self.resampled else half

    @property
    def periods(self) -> float:
        """Number of periods covered by the samples."""
        return self.values.size * self.step

    @property
    def rate(self) -> float:
        """Mean number of periods per second."""
        if self.time.size < 2:
            return math.nan
        return float((self.time.size - 1) * self.step / (self.time[-1] - self.time[0]))

    def part(self, begin: int, end: int) -> Record:
        """Samples from `begin` to before `end`."""
        return replace(
            self, values=self.values[begin:end], time=self.time[begin:end],
            first=self.first + begin * self.step,
        )  # fmt: skip


def is_by_angle(history: xr.Dataset) -> bool:
    """Whether the rows of a history are at equidistant angles."""
    return "output_position" in history and "output_of" in history.attrs


def counted_over(history: xr.Dataset, order_of: str | None) -> Turning | None:
    """Reference of the orders: as requested, else that of the output by angle; None over time."""
    name = order_of or (str(history.attrs["output_of"]) if is_by_angle(history) else None)
    return None if name is None else find_turning(history, name)


def between(history: xr.Dataset, begin: float, end: float) -> xr.Dataset:
    """Select the rows between two times.

    Raises
    ------
    HistoryError
        There are fewer than two.
    """
    time = history["time"]
    part = history.isel(time=rows_between(history, begin, end))
    if part.sizes["time"] < 2:
        raise HistoryError(
            f"{source_name(history)}: has {part.sizes['time']} outputs between --from and --to; "
            + (f"it goes from {time[0]:.6g} s to {time[-1]:.6g} s" if time.size else "it is empty"),
            USAGE,
        )
    return part


def read_record(history: xr.Dataset, signal: xr.DataArray, of: Turning | None) -> Record:
    """Return equidistant samples of a signal: unchanged rows if possible, else interpolated.

    Parameters
    ----------
    history : as from `open_history`, or a part of it over time.
    signal : a variable of it, dims (time).
    of : reference of the orders; over time if None.

    Raises
    ------
    HistoryError
        Missing values or rows, uneven rows, or a rotation that stands still or reverses.
    """
    values = np.asarray(signal.values, dtype=float)
    holes = np.flatnonzero(~np.isfinite(values))
    if holes.size:
        raise HistoryError(
            f"{source_name(history)}: `{signal.name}` has no value at t = "
            f"{float(history['time'][holes[0]]):.6g} s ({holes.size} of {values.size} outputs); "
            "select times or a variable without gaps"
        )
    if of is None:
        return _over_time(history, values)
    if is_by_angle(history):
        return _by_angle(history, values, of)
    steps = np.diff(history["time"].values)
    if (steps > GAP * np.median(steps)).any():
        _over_time(history, values)  # raises an error with the time
    return _between_rows(history, values, of)


def last_periods(record: Record, label: str, count: int | None = None) -> Record:
    """Select the last whole periods of a record over an angle, all of them if `count` is None.

    Raises
    ------
    HistoryError
        There are fewer whole periods, or none.
    """
    assert record.per_period is not None
    assert record.of is not None
    there = record.values.size // record.per_period
    requested = there if count is None else count
    if not 1 <= requested <= there:
        raise HistoryError(
            f"{label}: holds {record.periods:.4g} {record.of.periods} of {record.of}, not "
            f"{max(requested, 1)} whole"
            + ("; choose fewer, or increase the duration" if there else "; increase the duration"),
            BAD_INPUT if count is None else USAGE,
        )
    return record.part(record.values.size - requested * record.per_period, record.values.size)


def check_reach(record: Record, label: str, highest: float | None, spacing: float) -> float:
    """Highest line of the result: as requested, else the highest resolved one.

    Parameters
    ----------
    spacing : from line to line.

    Raises
    ------
    HistoryError
        The record has too few samples for it, or there is no line up to it.
    """
    if highest is not None and highest < spacing * (1 - EVEN):
        raise HistoryError(
            f"{label}: has no line up to {highest:.6g}, the first is at {spacing:.4g}; choose a "
            "larger --highest, or a longer record",
            USAGE,
        )
    requested = 1.0 if highest is None and record.of is not None else highest or 0.0
    if requested > record.reach * (1 + EVEN):
        unit = "Hz" if record.of is None else f"of {record.of}"
        rows = (
            f"{1 / record.step:.4g} outputs a second"
            if record.of is None
            else f"{record.rows:.4g} outputs a {record.of.period}"
        )
        raise HistoryError(
            f"{label}: {rows} resolve lines up to {record.reach:.4g} {unit}, not "
            f"{'order ' if record.of else ''}{requested:.6g}; write outputs more often",
            BAD_INPUT if highest is None else USAGE,
        )
    return record.reach if highest is None else highest


def speed_change(history: xr.Dataset) -> float:
    """Relative change of the first driving wheel's speed over a record.

    Difference of the means over the first and the last tenth, to suppress vibrations.
    """
    wheel = int(require(history, "driving_wheel")[0])
    speed = require(history, "angular_velocity").isel(wheel=wheel).values
    tenth = max(speed.size // 10, 1)
    mean = abs(float(speed.mean()))
    change = abs(float(speed[-tenth:].mean() - speed[:tenth].mean()))
    return change / mean if mean > 0 else 0.0


def _over_time(history: xr.Dataset, values: Numbers) -> Record:
    time = np.asarray(history["time"].values, dtype=float)
    steps = np.diff(time)
    step = float(np.median(steps))
    if steps.size > 1 and steps[-1] < step * (1 - EVEN):  # the end of the run, off the grid
        time, values, steps = time[:-1], values[:-1], steps[:-1]
    _check_steps(history, time, steps, step, "--order-of accepts uneven rows")
    step = float(time[-1] - time[0]) / steps.size
    return Record(values, time, float(time[0]), None, step, 1.0)


def _check_steps(
    history: xr.Dataset, time: Numbers, steps: Numbers, step: float, remedy: str
) -> None:
    """Reject missing and uneven rows."""
    wide = np.flatnonzero(steps > GAP * step)
    if wide.size:
        i = int(wide[0])
        raise HistoryError(
            f"{source_name(history)}: outputs are missing between t = {time[i]:.6g} s and "
            f"{time[i + 1]:.6g} s; select a part without gaps with --from and --to"
        )
    uneven = np.flatnonzero(abs(steps - step) > EVEN * step)
    if uneven.size:
        raise HistoryError(
            f"{source_name(history)}: outputs are not evenly spaced at t = "
            f"{time[int(uneven[0])]:.6g} s; {remedy}"
        )


def _by_angle(history: xr.Dataset, signal: Numbers, of: Turning) -> Record:
    """Rows of a history with output by angle; unchanged if their number per period is whole."""
    label = source_name(history)
    kinds = require(history, "output_kind").values
    time = np.asarray(history["time"].values, dtype=float)
    by = find_turning(history, str(history.attrs["output_of"]))
    back = np.flatnonzero(kinds == TURNING_BACK)
    if back.size:
        raise HistoryError(
            f"{label}: {by} turns back at t = {time[back[0]]:.6g} s, but orders require one sense "
            "of rotation; select a part with --from and --to"
        )
    retained = np.flatnonzero(kinds == ON_GRID)
    position = np.asarray(history["output_position"].values[retained], dtype=float)
    fresh = np.diff(position, prepend=-math.inf) != 0  # a position at standstill may occur twice
    retained, position = retained[fresh], position[fresh]
    if retained.size < 2:
        raise HistoryError(
            f"{label}: has {retained.size} outputs at even angles of {by}, too few for orders; "
            "increase the duration, or select more of it with --from and --to"
        )
    number = int(history.attrs["output_number"])
    _check_steps(
        history, time[retained], np.diff(position), 1.0 / number, "this is not output by angle"
    )
    geared = ratio(of, by)
    per_period = Fraction(number) / geared
    if per_period.denominator > 1:
        return _between_rows(history.isel(time=retained), signal[retained], of)
    first = of.start + (float(position[0]) - by.start) * float(geared)
    n = int(per_period)
    return Record(signal[retained], time[retained], first, n, 1.0 / n, float(n), of)


def _between_rows(history: xr.Dataset, values: Numbers, of: Turning) -> Record:
    """Interpolated samples at equidistant angles, at least as dense as the rows.

    The last row is a sample: at constant speed and whole rows per period all rows are samples.
    """
    label = source_name(history)
    time = np.asarray(history["time"].values, dtype=float)
    position = of.position(history)
    moved = abs(position[-1] - position[0])
    if moved < STANDING:
        raise HistoryError(
            f"{label}: {of} does not turn ({moved:.2g} {of.periods} in "
            f"{time[-1] - time[0]:.3g} s), so it has no orders; omit --order-of for lines over "
            "frequency"
        )
    if position[-1] < position[0]:  # rotates against its nominal direction all the time
        time, position, values = time[::-1], position[::-1], values[::-1]
    advance = np.diff(position)
    if not (advance > 0).all():
        i = int(np.flatnonzero(advance <= 0)[0])
        raise HistoryError(
            f"{label}: {of} stops or turns back at t = {time[i]:.6g} s, but orders require one "
            "sense of rotation; select a part with --from and --to"
        )
    if position.size < ROWS_NEEDED:
        raise HistoryError(
            f"{label}: {position.size} outputs are too few to interpolate, which takes "
            f"{ROWS_NEEDED}; select more of the run with --from and --to, or write outputs "
            "more often"
        )
    # The last step to the end of the run, off the grid, may be arbitrarily small.
    usual = advance[:-1] if advance[-1] < advance[-2] * (1 - EVEN) else advance
    per_period = math.ceil((1 - EVEN) / float(usual.min()))
    count = math.floor(moved * per_period * (1 + 1e-12)) + 1
    if count > MOST_SAMPLES:
        # number of samples from each row to the end; small for the last rows
        samples = (position[-1] - position[:-1]) / np.minimum.accumulate(advance[::-1])[::-1]
        enough = int(np.flatnonzero(samples < MOST_SAMPLES / 4)[0])
        raise HistoryError(
            f"{label}: {of} turns so slowly at t = {time[int(usual.argmin())]:.6g} s that even "
            f"angles as dense as the outputs there would be {count} samples; exclude that part, "
            f"such as with --from {time[enough]:.3g}"
        )
    positions = position[-1] - np.arange(count)[::-1] / per_period
    both = resample(position, np.stack([values, time], axis=1), positions)
    fewest = 1.0 / float(advance.max())
    rows = float(per_period) if abs(fewest / per_period - 1) < EVEN else fewest
    return Record(
        both[:, 0], both[:, 1], float(positions[0]), per_period, 1.0 / per_period, rows, of
    )
