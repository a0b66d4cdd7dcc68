"""The largest differences between two histories."""

from __future__ import annotations

import numpy as np
import xarray as xr

from evolvent.history import HistoryError, source_name

# Two times are one if they differ by less than this part of the output interval: the same multiple
# of an interval can be rounded differently.
SAME_TIME = 1e-6


def compare_histories(first: xr.Dataset, second: xr.Dataset) -> xr.Dataset:
    """Find the largest difference of every variable that both histories have.

    On the times that both have; if these are fewer than half of the coarser grid, the second is
    interpolated linearly to the times of the first (integers: the last value before). Equal
    missing values are no difference, a value missing in one only is an infinite one.

    Parameters
    ----------
    first, second : as from `open_history`, with the same wheels and meshes.

    Returns
    -------
    Dataset with the dimension variable: `absolute`, the largest difference, in the unit that
    `units` names; `largest`, the largest absolute value in either; `relative`, their ratio;
    `where`, time and place of the largest difference. Its attributes: `times` (how times were
    matched, in words), `n_times`, `only_in_first` and `only_in_second` (names, comma-separated).

    Raises
    ------
    HistoryError
        Different wheels or meshes, or no time span in common.
    """
    for dim in ("wheel", "mesh", "axis"):
        names = [[str(v) for v in history[dim].values] for history in (first, second)]
        if names[0] != names[1]:
            raise HistoryError(
                f"{source_name(second)}: its {dim} names are {', '.join(names[1])}, those of "
                f"{source_name(first)} are {', '.join(names[0])}; only like runs can be compared"
            )
    first_names, second_names = ([str(n) for n in h.data_vars] for h in (first, second))
    shared = [name for name in first_names if name in set(second_names)]
    one, two, how = _on_common_times(first, second)
    rows = [_compare_variable(name, one[name], two[name]) for name in shared]
    absolute, largest, where = (list(column) for column in zip(*rows, strict=True))
    relative = [_ratio(a, b) for a, b in zip(absolute, largest, strict=True)]
    units = [str(first[name].attrs.get("units", "1")) for name in shared]
    return xr.Dataset(
        {
            "absolute": ("variable", absolute),
            "largest": ("variable", largest),
            "relative": ("variable", relative),
            "where": ("variable", where),
            "units": ("variable", units),
        },
        coords={"variable": shared},
        attrs={
            "times": how,
            "n_times": one.sizes["time"],
            "only_in_first": ", ".join(n for n in first_names if n not in set(second_names)),
            "only_in_second": ", ".join(n for n in second_names if n not in set(first_names)),
        },
    )


def _ratio(difference: float, largest: float) -> float:
    if difference == 0.0:
        return 0.0
    return difference / largest if largest > 0.0 else float("inf")


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


def _compare_variable(
    name: str, first: xr.DataArray, second: xr.DataArray
) -> tuple[float, float, str]:
    if first.dims != second.dims or first.shape != second.shape:
        raise HistoryError(f"variable `{name}` has different dimensions in the two histories")
    if first.dtype.kind not in "iufb":
        different = first.values != second.values
        return float(np.any(different)), 1.0, ""
    one, two = first.values.astype(float), second.values.astype(float)
    if one.size == 0:
        return 0.0, 0.0, ""
    difference = np.abs(one - two)
    missing = np.isnan(one), np.isnan(two)
    difference[missing[0] & missing[1]] = 0.0
    difference[missing[0] ^ missing[1]] = np.inf
    finite = np.concatenate([v[np.isfinite(v)] for v in (one, two)])
    largest = float(np.abs(finite).max(initial=0.0))
    position = np.unravel_index(int(np.argmax(difference)), difference.shape)
    worst = float(difference[position])
    places = []
    for dim, index in zip(first.dims, position, strict=True):
        label = first[dim].values[index]
        places.append(f"t = {label:.6g} s" if dim == "time" else str(label))
    return worst, largest, ", ".join(places) if worst > 0 else ""
