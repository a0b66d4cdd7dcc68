"""Branches of orbits as `evolvent respond --method orbits` writes them."""

from __future__ import annotations

import numpy as np
import xarray as xr

PARAMETER = [1.0, 2.0, 3.0, 3.5, 3.0, 2.5, 2.0]  # a fold at 3.5, a doubling at 2.5


def folded_orbits() -> xr.Dataset:
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
