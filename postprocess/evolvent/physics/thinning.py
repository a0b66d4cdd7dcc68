"""Thin out the rows of a line that is too long to show; extremes are preserved."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray

from evolvent.history.recording import Recording, Values, ever

Rows = NDArray[np.int64]


def thinned(values: NDArray[np.floating], most: int) -> Rows:
    """Select rows of a line: the minimum and the maximum of each of equal intervals.

    The first and the last row are included. For an interval with NaN or infinite values, one such
    row is included as well, so that a gap in the line is visible.

    Parameters
    ----------
    values : shape (n,).
    most : maximum number of rows; at least 8. A shorter line is complete.

    Returns
    -------
    Indices of the rows, ascending.
    """
    n = values.size
    if n <= most:
        return np.arange(n)
    is_whole = bool(np.isfinite(values).all())
    block = _stretch(n, most, is_whole)
    rows = _extremes(values[:, np.newaxis], block, is_whole)
    return np.unique(np.append(rows, (0, n - 1)))


def thinned_lines(run: Recording, name: str, most: int) -> list[Rows]:
    """Select rows of each line of a variable as `thinned` does, without holding a line in memory.

    Returns
    -------
    Indices of the rows of each line, in the order of the indices along the other dimensions.
    """
    n, count = run.n, int(np.prod(run.variables[name].shape))
    if n <= most:
        return [np.arange(n)] * count
    whole = ~ever(run, lambda part: ~np.isfinite(part[name])).reshape(count)
    found: dict[int, Rows] = {}
    for is_whole in (True, False):
        columns = np.flatnonzero(whole == is_whole)
        if not columns.size:
            continue
        block = _stretch(n, most, is_whole)
        step = max(run.block // block, 1) * block
        pieces = [
            begin
            + _extremes(
                run.read(name, begin, min(begin + step, n)).reshape(-1, count)[:, columns],
                block,
                is_whole,
            )
            for begin in range(0, n, step)
        ]
        rows = np.concatenate(pieces)
        found |= {
            column: np.unique(np.append(rows[:, number], (0, n - 1)))
            for number, column in enumerate(columns.tolist())
        }
    return [found[column] for column in range(count)]


def _stretch(n: int, most: int, is_whole: bool) -> int:
    """Rows of an interval; two of them remain, or three if there are gaps."""
    return -(-n // ((most - 2) // (2 if is_whole else 3)))


def _extremes(values: Values, block: int, is_whole: bool) -> Rows:
    """Rows of the extremes and gaps of each interval of each column; duplicates are possible."""
    if is_whole:
        return np.concatenate([_of(values, block, select) for select in (np.argmin, np.argmax)])
    # Non-finite values are excluded from minimum and maximum.
    finite = np.isfinite(values)
    gaps = _of(~finite, block, np.argmax)
    lowest = _of(np.where(finite, values, np.inf), block, np.argmin)
    highest = _of(np.where(finite, values, -np.inf), block, np.argmax)
    gaps = np.where(np.take_along_axis(finite, gaps, axis=0), lowest, gaps)
    return np.concatenate([lowest, highest, gaps])


def _of(values: Values, block: int, select: Callable[..., Any]) -> Rows:
    """Row that a function selects in each interval of each column; the last one may be shorter."""
    whole = values.shape[0] // block * block
    found = [select(values[:whole].reshape(-1, block, values.shape[1]), axis=1)] if whole else []
    found += [select(values[whole:], axis=0)[np.newaxis]] if whole < values.shape[0] else []
    rows = np.concatenate(found)
    return np.asarray(rows + block * np.arange(rows.shape[0])[:, np.newaxis])
