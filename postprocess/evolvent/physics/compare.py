"""Largest differences between two histories."""

from __future__ import annotations

from typing import Any

import numpy as np
import xarray as xr

from evolvent.errors import HistoryError
from evolvent.history import source_name

# Two times are equal if they differ by less than this fraction of the output interval: the same
# multiple of an interval can be rounded differently.
SAME_TIME = 1e-6
FORWARDS, OFF_GRID = 0, 1  # output_kind: passed in the nominal direction; not on the grid
SETTINGS = ("tracking",)  # options, not results
# The time of an extreme depends on rounding if a curve is flat, or has equal peaks.
EXTREME_TIMES = ("_max_time", "_min_time")


def compare_histories(first: xr.Dataset, second: xr.Dataset) -> xr.Dataset:
    """Find the largest difference of every variable that both histories have.

    Histories are compared at their common times. If these are fewer than half of the coarser grid,
    the second is interpolated linearly to the times of the first (integers: the last value before).
    If outputs of both are by the same pitches or turns, the common positions are compared, at
    whatever times: all of them if both passed the same ones in the same order, else the first
    passage forwards. A value missing in only one history is an infinite difference; a quantity that
    is missing in one at all times, such as tracked points in closed form, is omitted. `tracking` is
    not compared.

    Parameters
    ----------
    first, second : xarray.Dataset
        As from `open_history`, with the same wheels and meshes.

    Returns
    -------
    xarray.Dataset
        Differences over the dimension variable: `absolute`, the largest difference, in the unit
        that `units` names; `largest`, the largest absolute value in either; `relative`, their
        ratio; `where`, time and location of the largest difference. Its attributes: `times` (how
        times were matched, in words), `n_times`, `only_in_first` and `only_in_second` (names of
        variables in one history only, comma-separated).

    Raises
    ------
    HistoryError
        Different wheels or meshes, or no time span in common.

    Examples
    --------
    >>> import evolvent
    >>> case = "examples/paper.yaml"
    >>> same = evolvent.compare_histories(evolvent.open_history("paper.h5"), evolvent.run(case))
    >>> float(same["absolute"].max())
    0.0
    """
    for dim in ("wheel", "mesh", "axis"):
        names = [[str(v) for v in history[dim].values] for history in (first, second)]
        if names[0] != names[1]:
            raise HistoryError(
                f"{source_name(second)}: its {dim} names are {', '.join(names[1])}, those of "
                f"{source_name(first)} are {', '.join(names[0])}; only like runs can be compared"
            )
    one, two, how = _on_common_positions(first, second) or _on_common_times(first, second)
    differences: dict[str, dict[str, Any]] = {}
    missing: dict[str, list[str]] = {"only_in_first": [], "only_in_second": []}
    for name in dict.fromkeys(str(n) for n in [*first.data_vars, *second.data_vars]):
        if name in SETTINGS or name.endswith(EXTREME_TIMES):
            continue
        if name not in two or (name in one and _is_blank(two[name]) and not _is_blank(one[name])):
            missing["only_in_first"].append(name)
        elif name not in one or (_is_blank(one[name]) and not _is_blank(two[name])):
            missing["only_in_second"].append(name)
        else:
            differences[name] = _largest_difference(name, one[name], two[name])
    columns = ("absolute", "largest", "relative", "where", "units")
    attributes = {side: ", ".join(names) for side, names in missing.items()}
    return xr.Dataset(
        {key: ("variable", [found[key] for found in differences.values()]) for key in columns},
        coords={"variable": list(differences)},
        attrs={"times": how, "n_times": one.sizes["time"], **attributes},
    )


def _on_common_positions(
    first: xr.Dataset, second: xr.Dataset
) -> tuple[xr.Dataset, xr.Dataset, str] | None:
    attributes = [
        [h.attrs.get(key) for key in ("output_per", "output_of")] for h in (first, second)
    ]
    if attributes[0] != attributes[1] or None in attributes[0]:
        return None
    one, two = (h.isel(time=h["output_kind"].values != OFF_GRID) for h in (first, second))
    if not np.array_equal(one["output_position"], two["output_position"]):
        one, two = (h.isel(time=h["output_kind"].values == FORWARDS) for h in (one, two))
        coordinates = one["output_position"].values, two["output_position"].values
        _, of_one, of_two = np.intersect1d(*coordinates, return_indices=True)
        one, two = one.isel(time=of_one), two.isel(time=of_two)
    n = one.sizes["time"]
    return (one, two, f"the {n} positions that both have") if n > 1 else None


def _on_common_times(first: xr.Dataset, second: xr.Dataset) -> tuple[xr.Dataset, xr.Dataset, str]:
    for history in (first, second):
        if history.sizes["time"] == 0:
            raise HistoryError(f"{source_name(history)}: has no output")
    one, two = first["time"].values, second["time"].values
    begin, end = max(one[0], two[0]), min(one[-1], two[-1])
    slack = SAME_TIME * min(np.diff(one).min(initial=np.inf), np.diff(two).min(initial=np.inf))
    slack = slack if np.isfinite(slack) else 0.0
    if begin > end + slack:
        raise HistoryError(f"{source_name(first)} and {source_name(second)} have no time in common")
    nearest = np.clip(np.searchsorted(two, one - slack), 0, two.size - 1)
    common = np.abs(two[nearest] - one) <= slack
    coarser = min(np.count_nonzero((t >= begin - slack) & (t <= end + slack)) for t in (one, two))
    if 2 * np.count_nonzero(common) >= coarser:
        how = f"the {np.count_nonzero(common)} times that both have"
        return first.isel(time=common), second.isel(time=nearest[common]), how
    inside = (one >= begin) & (one <= end)
    times = one[inside]
    before = np.clip(np.searchsorted(two, times, side="right") - 1, 0, two.size - 1)
    interpolated = second.interp(time=times)
    for name, variable in second.data_vars.items():
        if "time" in variable.dims and variable.dtype.kind in "iu":
            interpolated[name] = variable.isel(time=before).assign_coords(time=times)
    how = f"{times.size} times of the first; the second is interpolated linearly between its own"
    return first.isel(time=inside), interpolated, how


def _is_blank(values: xr.DataArray) -> bool:
    return values.dtype.kind == "f" and values.size > 0 and bool(np.isnan(values.values).all())


def _largest_difference(name: str, first: xr.DataArray, second: xr.DataArray) -> dict[str, Any]:
    if first.dims != second.dims or first.shape != second.shape:
        raise HistoryError(f"variable `{name}` has different dimensions in the two histories")
    one, two = first.values.astype(float), second.values.astype(float)
    units = str(first.attrs.get("units", "1"))
    none = {"absolute": 0.0, "largest": 0.0, "relative": 0.0, "where": "", "units": units}
    if one.size == 0:
        return none
    with np.errstate(invalid="ignore"):
        difference = np.asarray(np.abs(one - two))  # a scalar of the whole run has no dimension
    difference[np.isnan(difference)] = np.inf
    difference[(one == two) | (np.isnan(one) & np.isnan(two))] = 0.0
    if "time" in first.dims:
        # A mesh in closed form has no tracked points, unlike the other history.
        blank_one, blank_two = (
            np.isnan(v).all(axis=first.get_axis_num("time")) for v in (one, two)
        )
        difference[..., blank_one ^ blank_two] = 0.0
    finite = np.concatenate([v[np.isfinite(v)] for v in (one, two)])
    largest = float(np.abs(finite).max(initial=0.0))
    position = np.unravel_index(int(np.argmax(difference)), difference.shape)
    if difference[position] == 0.0:
        return {**none, "largest": largest}
    coordinates = []
    for dim, index in zip(first.dims, position, strict=True):
        label = first[dim].values[index]
        coordinates.append(f"t = {label:.6g} s" if dim == "time" else str(label))
    absolute = float(difference[position])
    relative = absolute / largest if largest > 0.0 else float("inf")
    return {
        "absolute": absolute,
        "largest": largest,
        "relative": relative,
        "where": ", ".join(coordinates),
        "units": units,
    }
