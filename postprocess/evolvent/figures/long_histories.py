"""Thin out the outputs of a history that is too long to draw; extremes are preserved."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import xarray as xr

from evolvent.history.recording import Recording, recording_of
from evolvent.physics.thinning import thinned_lines

LONG = 50_000  # outputs; shorter histories are not thinned out
MOST, FEWEST, MOST_OF_ALL = 6000, 1000, 200_000  # outputs of a line, and of all lines together
# Variables that figures need in addition to the displayed ones.
BESIDE = ("angle", "pair_on_path", "pair_normal_force", "pair_number", "pair_position")


def drawable(history: xr.Dataset, names: Sequence[str]) -> xr.Dataset:
    """Select the outputs of a long history that figures of some variables need.

    Each line is divided into equal intervals; the minimum and maximum of each are retained with
    their times. The history is read in parts, so only the selected outputs are in memory.

    Parameters
    ----------
    names : variables over time.

    Returns
    -------
    The history itself if it is short or does not contain one of them; else one in memory with these
    variables, those that figures need in addition, and all constants.
    """
    if history.sizes["time"] <= LONG or not set(names) <= set(history.data_vars):
        return history
    run = recording_of(history)
    retained = _rows(
        run, [name for name in dict.fromkeys(names) if run.variables[name].is_over_time]
    )
    requested = [name for name in dict.fromkeys(("time", *names, *BESIDE)) if name in run]
    gathered = {name: _gathered(run, name, retained) for name in requested}
    found = history.drop_dims("time").assign(
        {
            name: (history[name].transpose("time", ...).dims, values, history[name].attrs)
            for name, values in gathered.items()
            if run.variables[name].is_over_time
        }
    )
    found.encoding = history.encoding
    return found


def _rows(run: Recording, names: Sequence[str]) -> np.ndarray:
    """Rows that are retained for at least one line."""
    count = sum(int(np.prod(run.variables[name].shape)) for name in names)
    most = int(np.clip(MOST_OF_ALL // max(count, 1), FEWEST, MOST))
    is_retained = np.zeros(run.n, dtype=bool)
    is_retained[[0, -1]] = True
    for name in names:
        for rows in thinned_lines(run, name, most):
            is_retained[rows] = True
    return np.flatnonzero(is_retained)


def _gathered(run: Recording, name: str, rows: np.ndarray) -> np.ndarray:
    if not run.variables[name].is_over_time:
        return run[name]
    pieces = []
    for part in run.parts():
        first, last = np.searchsorted(rows, (part.begin, part.end))
        pieces.append(part[name][rows[first:last] - part.begin])
    return np.concatenate(pieces)
