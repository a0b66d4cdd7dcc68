"""The picture of branches of orbits."""

from __future__ import annotations

import numpy as np
import xarray as xr

from evolvent.figures.orbits import UNSTABLE, draw_orbits

PARAMETER = [1.0, 2.0, 3.0, 3.5, 3.0, 2.5, 2.0]  # a fold at 3.5, a doubling at 2.5


def folded() -> xr.Dataset:
    """One branch that turns back, and one of twice the period."""
    other = [2.5, 3.0]
    n, m = len(PARAMETER), len(other)
    numbers = np.arange(1.0, n + m + 1)[:, None]
    return xr.Dataset(
        {
            "orbit_parameter": ("point", [*PARAMETER, *other], {"units": "N m"}),
            "orbit_branch": ("point", [0] * n + [1] * m),
            "orbit_period": ("point", [1] * n + [2] * m),
            "orbit_stable": ("point", [1, 1, 1, 0, 0, 0, 1, 1, 1]),
            "orbit_kind": ("point", [0, 0, 0, 1, 0, 3, 0, 0, 0]),
            "transmission_error_standard_deviation": (
                ("point", "mesh"),
                1e-6 * numbers,
                {"units": "m"},
            ),
            "dynamic_factor": (("point", "mesh"), numbers, {"units": "1"}),
        },
        {"mesh": ["pair"]},
        {"evolvent_kind": "orbits", "parameter": "wheels.gear.loads.0.value"},
    )


def test_picture_tells_stable_from_unstable_and_marks_where_that_changes() -> None:
    panel, factor = draw_orbits(folded()).axes
    for axes in (panel, factor):
        drawn = [
            (str(line.get_label()), np.asarray(line.get_xdata()).tolist()) for line in axes.lines
        ]
        assert drawn == [
            ("period 1, stable", [1.0, 2.0, 3.0, 3.5]),
            ("period 1, unstable", [3.5, 3.0, 2.5]),
            ("period 1, stable", [2.5, 2.0]),
            ("period 2, stable", [2.5, 3.0]),
            ("fold", [3.5]),
            ("period doubling", [2.5]),
        ]
    styles = [line.get_linestyle() for line in panel.lines[:3]]
    assert styles == ["-", "--", "-"]
    assert UNSTABLE != "-"
    assert panel.lines[0].get_color() == panel.lines[1].get_color() != panel.lines[3].get_color()
    np.testing.assert_allclose(panel.lines[0].get_ydata(), [1, 2, 3, 4])
