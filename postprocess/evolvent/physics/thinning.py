"""Fewer rows of a line that is too long to be shown, without losing what it reaches."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Rows = NDArray[np.int64]


def thinned(values: NDArray[np.floating], most: int) -> Rows:
    """Choose rows of a line: the smallest and the largest value of each of equal stretches.

    The first and the last row are among them. Where a stretch has values that are no numbers, one
    of these stays as well, so that a gap in the line is seen.

    Parameters
    ----------
    values : shape (n,).
    most : rows that may stay; at least 8. A line that is no longer stays whole.

    Returns
    -------
    Numbers of the rows, ascending.
    """
    n = values.size
    if n <= most:
        return np.arange(n)
    finite = np.isfinite(values)
    kept = 2 if finite.all() else 3
    block = -(-n // ((most - 2) // kept))
    short = -n % block
    # what fills the last stretch up is never the smallest, the largest or no number
    low = np.pad(np.where(finite, values, np.inf), (0, short), constant_values=np.inf)
    high = np.pad(np.where(finite, values, -np.inf), (0, short), constant_values=-np.inf)
    starts = np.arange(0, n + short, block)
    rows = [
        starts + low.reshape(-1, block).argmin(axis=1),
        starts + high.reshape(-1, block).argmax(axis=1),
        np.array([0, n - 1]),
    ]
    if kept == 3:
        gaps = np.pad(~finite, (0, short)).reshape(-1, block)
        rows.append((starts + gaps.argmax(axis=1))[gaps.any(axis=1)])
    return np.unique(np.concatenate(rows))
