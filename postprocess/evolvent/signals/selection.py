"""Which signal of a history: one variable at one mesh, wheel, tooth pair or axis."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
import xarray as xr

from evolvent.errors import USAGE, HistoryError
from evolvent.history import source_name

PLURALS = {"mesh": "meshes", "axis": "axes", "space": "axes"}
OPTIONS = {"mesh": "--mesh", "wheel": "--wheel", "pair": "--pair", "axis": "--axis"}
OPTIONS |= {"space": "--axis"}  # both have x and y; the option knows no difference


def select(history: xr.Dataset, quantity: str, chosen: Mapping[str, str]) -> xr.DataArray:
    """One variable over time, everything else chosen by name.

    Parameters
    ----------
    history : as from `open_history`.
    quantity : name of a variable over time.
    chosen : names by dimension, such as {"mesh": "first"}; "axis" stands for `space` as well. A
        dimension of length 1 needs none.

    Returns
    -------
    Dims (time); the attribute `place` tells what was chosen, such as "mesh first".

    Raises
    ------
    HistoryError
        No such variable or name, or one that has to be chosen; the message lists what there is.
    """
    label = source_name(history)
    if quantity not in history.data_vars or "time" not in history[quantity].dims:
        raise HistoryError(
            f"{label}: has no variable `{quantity}` over time; there is "
            f"{', '.join(over_time(history))}",
            USAGE,
        )
    values = history[quantity]
    left = dict(chosen)
    places = []
    for dim in [str(dim) for dim in values.dims if dim != "time"]:
        key = "axis" if dim == "space" and "space" not in left else dim
        name = left.pop(key, None)
        index = _index(label, values, dim, name)
        places.append(f"{dim} {_names(values, dim)[index]}")
        values = values.isel({dim: index})
    if left:
        dim = next(iter(left))
        raise HistoryError(
            f"{label}: `{quantity}` has no {dim}, so none can be chosen; leave out "
            f"{OPTIONS.get(dim, f'--select {dim}={left[dim]}')}",
            USAGE,
        )
    return values.assign_attrs(place=", ".join(places))


def over_time(history: xr.Dataset) -> list[str]:
    """Names of the variables that are numbers over time."""
    return [
        str(name)
        for name, values in history.data_vars.items()
        if "time" in values.dims and np.issubdtype(values.dtype, np.number)
    ]


def _names(values: xr.DataArray, dim: str) -> list[str]:
    if dim in values.coords:
        return [str(name) for name in values[dim].values]
    return [str(i) for i in range(values.sizes[dim])]


def _index(label: str, values: xr.DataArray, dim: str, name: str | None) -> int:
    names = _names(values, dim)
    if name in names:
        return names.index(name)
    if name is not None:
        raise HistoryError(
            f"{label}: `{values.name}` has no {dim} `{name}`; there is {', '.join(names)}", USAGE
        )
    if len(names) == 1:
        return 0
    raise HistoryError(
        f"{label}: `{values.name}` has {len(names)} {PLURALS.get(dim, f'{dim}s')}; choose one by "
        f"{OPTIONS.get(dim, f'--select {dim}=NAME')}: {', '.join(names)}",
        USAGE,
    )
