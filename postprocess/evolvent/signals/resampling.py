"""Resampling to equidistant positions by spline interpolation, and its amplitude loss."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Numbers = NDArray[np.float64]

DEGREE = 7
ROWS_NEEDED = DEGREE + 1
REACH = 0.36  # periods of a line per row up to which `loss` stays below 1 %


def loss(rows: float, degree: int = DEGREE) -> float:
    """Relative amplitude loss of a line by interpolation between equidistant rows.

    1 - 1/sum_j (f/(f + j))^(degree + 1) with f = 1/rows; an equal share appears as spurious lines
    elsewhere.   Valid: odd degree, rows > 2.   Equation S2.

    Parameters
    ----------
    rows : rows per period of the line.

    Source: the frequency response of cardinal splines, Unser, Aldroubi and Eden 1993.
    """
    f = 1.0 / rows
    j = np.arange(1.0, 101.0)
    power = degree + 1
    images = float((((f / (f + j)) ** power) + ((f / (j - f)) ** power)).sum())
    return images / (1.0 + images)


def resample(position: Numbers, columns: Numbers, targets: Numbers) -> Numbers:
    """Values at other positions, by one spline of degree `DEGREE` through all rows.

    Parameters
    ----------
    position : strictly increasing, at least `ROWS_NEEDED`.
    columns : dims (row, column).
    targets : within the positions.
    """
    from scipy.interpolate import make_interp_spline

    origin = position[0]  # large positions of long runs would lose digits
    spline = make_interp_spline(position - origin, columns, k=DEGREE)
    inside = np.clip(targets - origin, 0.0, position[-1] - origin)
    return np.asarray(spline(inside))
