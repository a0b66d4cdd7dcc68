"""Thinned lines keep what they reach, and where they are broken."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from evolvent.physics.thinning import thinned

LINES = arrays(float, st.integers(1, 400), elements=st.floats(-1e9, 1e9) | st.just(np.nan))


@given(LINES, st.integers(8, 60))
def test_extremes_and_ends_stay_and_no_more_rows_than_allowed(line, most):
    rows = thinned(line, most)
    assert rows.size <= max(most, 8)
    assert (np.diff(rows) > 0).all()
    assert (rows[0], rows[-1]) == (0, line.size - 1)
    finite = line[np.isfinite(line)]
    if finite.size:
        # at the very rows at which they are reached first
        for reach in (np.nanargmin, np.nanargmax):
            assert reach(line) in rows


@given(LINES, st.integers(8, 60), st.integers(8, 60))
def test_thinning_again_loses_no_extreme(line, first, second):
    rows = thinned(line, first)
    again = rows[thinned(line[rows], second)]
    if np.isfinite(line).any():
        assert {np.nanargmin(line), np.nanargmax(line)} <= set(again.tolist())


def test_a_gap_in_a_line_stays_a_gap():
    line = np.sin(np.linspace(0, 20, 10_000))
    line[4000:4100] = np.nan
    rows = thinned(line, 200)
    assert np.isnan(line[rows]).any()
    assert set(rows[np.isnan(line[rows])].tolist()) <= set(range(4000, 4100))


@pytest.mark.parametrize("n", [1, 2, 100])
def test_a_short_line_stays_whole(n):
    assert thinned(np.zeros(n), 100).tolist() == list(range(n))
