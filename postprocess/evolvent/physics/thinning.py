"""Fewer rows of a line that is too long to be shown, without losing what it reaches."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray

from evolvent.history.recording import Recording, Values, ever

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
    is_whole = bool(np.isfinite(values).all())
    block = _stretch(n, most, is_whole)
    rows = _extremes(values[:, np.newaxis], block, is_whole)
    return np.unique(np.append(rows, (0, n - 1)))


def thinned_lines(run: Recording, name: str, most: int) -> list[Rows]:
    """Choose rows of each line of a variable as `thinned` does, without having one in memory.

    Returns
    -------
    Numbers of the rows of each line, in the order of the indices along the other dimensions.
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
    """Rows of a stretch, of which two stay, or three where there are gaps."""
    return -(-n // ((most - 2) // (2 if is_whole else 3)))


def _extremes(values: Values, block: int, is_whole: bool) -> Rows:
    """Rows of the extremes and gaps of each stretch of each column; some stand twice."""
    if is_whole:
        return np.concatenate([_of(values, block, place) for place in (np.argmin, np.argmax)])
    # What is no number is neither the smallest nor the largest.
    finite = np.isfinite(values)
    gaps = _of(~finite, block, np.argmax)
    lowest = _of(np.where(finite, values, np.inf), block, np.argmin)
    highest = _of(np.where(finite, values, -np.inf), block, np.argmax)
    gaps = np.where(np.take_along_axis(finite, gaps, axis=0), lowest, gaps)
    return np.concatenate([lowest, highest, gaps])


def _of(values: Values, block: int, place: Callable[..., Any]) -> Rows:
    """Row that a function finds in each stretch of each column; the last one may be shorter."""
    whole = values.shape[0] // block * block
    found = [place(values[:whole].reshape(-1, block, values.shape[1]), axis=1)] if whole else []
    found += [place(values[whole:], axis=0)[np.newaxis]] if whole < values.shape[0] else []
    rows = np.concatenate(found)
    return np.asarray(rows + block * np.arange(rows.shape[0])[:, np.newaxis])
