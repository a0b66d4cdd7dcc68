"""A history of a million outputs that takes little memory."""

from __future__ import annotations

import numpy as np
import xarray as xr

MILLION = 1_000_000
SPIKE = 654_321  # row of values that are there once
TALL = 3.0  # times what is around it


def million(history: xr.Dataset) -> xr.Dataset:
    """A million outputs: the last one again and again, noise in some lines, and one spike."""
    last = history.isel(time=slice(-1, None)).load()
    random = np.random.default_rng(11)
    variables = {}
    for name, variable in last.data_vars.items():
        if variable.dims[:1] == ("time",):
            shape = (MILLION, *variable.shape[1:])
            # one value in memory, a million times
            variables[name] = (
                variable.dims,
                np.broadcast_to(variable.values, shape),
                variable.attrs,
            )
    long = last.drop_dims("time").assign(variables)
    long = long.assign_coords(time=("time", np.linspace(0.0, 5.0, MILLION), {"units": "s"}))
    for name in ("transmission_error", "normal_force", "angular_velocity"):
        noisy = long[name].values * (1.0 + 0.01 * random.normal(size=long[name].shape))
        noisy[SPIKE] *= TALL
        long[name] = (long[name].dims, noisy, long[name].attrs)
    reported = [name for name in long if str(name).startswith("transmission_error_m")]
    return long.drop_vars(reported)
