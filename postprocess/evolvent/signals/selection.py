"""Selection of a signal of a history: one variable of one mesh, wheel, tooth pair or axis."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from difflib import get_close_matches

import numpy as np
import xarray as xr

from evolvent.errors import USAGE, HistoryError
from evolvent.history import source_name

MOST_NEAR = 6  # names listed in an error message
PLURALS = {"mesh": "meshes", "axis": "axes", "space": "axes"}
OPTIONS = {"mesh": "--mesh", "wheel": "--wheel", "pair": "--pair", "axis": "--axis"}
OPTIONS |= {"space": "--axis"}  # both have x and y; the option is the same


def select(history: xr.Dataset, quantity: str, chosen: Mapping[str, str]) -> xr.DataArray:
    """Select one variable over time, with an index along each other dimension given by name.

    Parameters
    ----------
    history : as from `open_history`.
    quantity : name of a variable over time.
    chosen : names by dimension, such as {"mesh": "first"}; "axis" denotes `space` as well. A
        dimension of length 1 needs none.

    Returns
    -------
    Dims (time); the attribute `place` describes the selection, such as "mesh first".

    Raises
    ------
    HistoryError
        No such variable or name, or a selection is required; the message lists the options.
    """
    label = source_name(history)
    if quantity not in over_time(history):
        raise HistoryError(f"{label}: {unknown(history, quantity)}", USAGE)
    values = history[quantity]
    left = dict(chosen)
    labels = []
    for dim in [str(dim) for dim in values.dims if dim != "time"]:
        key = "axis" if dim == "space" and "space" not in left else dim
        name = left.pop(key, None)
        index = index_of(label, values, dim, name)
        labels.append(f"{dim} {names_along(values, dim)[index]}")
        values = values.isel({dim: index})
    if left:
        dim = next(iter(left))
        raise HistoryError(
            f"{label}: `{quantity}` has no {dim}, so none can be selected; omit "
            f"{OPTIONS.get(dim, f'--select {dim}={left[dim]}')}",
            USAGE,
        )
    return values.assign_attrs(place=", ".join(labels))


def over_time(history: xr.Dataset) -> list[str]:
    """Names of the numerical variables over time."""
    return [
        str(name)
        for name, values in history.data_vars.items()
        if "time" in values.dims and np.issubdtype(values.dtype, np.number)
    ]


def unknown(history: xr.Dataset, quantity: str, more: Sequence[str] = ()) -> str:
    """Error message for an unknown variable over time, with similar names.

    Parameters
    ----------
    more : other valid names.
    """
    if quantity in history.variables:
        return f"`{quantity}` is not a variable over time; evolvent-post report shows constants"
    near = get_close_matches(quantity, [*over_time(history), *more], 4, 0.5)
    parts = [name for name in over_time(history) if quantity in name]
    found = list(dict.fromkeys([*near, *parts]))[:MOST_NEAR]
    hint = f"did you mean {', '.join(found)}?" if found else "no similar name"
    return (
        f"has no variable `{quantity}` over time; {hint} "
        f"(evolvent-post plot {source_name(history)} --list shows all)"
    )


def names_along(values: xr.DataArray, dim: str) -> list[str]:
    """Names along a dimension; indices if it has none."""
    if dim in values.coords:
        return [str(name) for name in values[dim].values]
    return [str(i) for i in range(values.sizes[dim])]


def index_of(label: str, values: xr.DataArray, dim: str, name: str | None) -> int:
    """Index of a name along a dimension; of the only one if no name is given.

    Raises
    ------
    HistoryError
        No such name, or a selection is required; the message lists the options.
    """
    names = names_along(values, dim)
    if name in names:
        return names.index(name)
    if name is not None:
        raise HistoryError(
            f"{label}: `{values.name}` has no {dim} `{name}`; there is {', '.join(names)}", USAGE
        )
    if len(names) == 1:
        return 0
    raise HistoryError(
        f"{label}: `{values.name}` has {len(names)} {PLURALS.get(dim, f'{dim}s')}; select one "
        f"with {OPTIONS.get(dim, f'--select {dim}=NAME')}: {', '.join(names)}",
        USAGE,
    )
