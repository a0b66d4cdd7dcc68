"""The extremes over a run that a history tells: found between its outputs while it ran."""

from __future__ import annotations

from dataclasses import dataclass

import xarray as xr

ENDINGS = {"_max": True, "_min": False}  # of the names: whether it is the largest


@dataclass(frozen=True)
class Extreme:
    """An extreme of an output, for each mesh."""

    output: str  # name of the output
    is_largest: bool
    between_outputs: bool  # found between the outputs; else it is that of the outputs
    value: xr.DataArray  # dim (mesh)
    time: xr.DataArray  # when it was first reached [s], dim (mesh)


def told_extremes(history: xr.Dataset) -> list[Extreme]:
    """List the extremes that a history tells; none if it is of an older evolvent, or was killed."""
    found = []
    for name in map(str, history.data_vars):
        for ending, is_largest in ENDINGS.items():
            output = name.removesuffix(ending)
            if name.endswith(ending) and output in history and f"{name}_time" in history:
                value, time = history[name], history[f"{name}_time"]
                found.append(Extreme(output, is_largest, True, value, time))
    return found


def is_extreme(name: str) -> bool:
    """Tell whether a static variable is an extreme or the time of one, by its name."""
    return name.removesuffix("_time").endswith(tuple(ENDINGS))


def peaks(history: xr.Dataset, output: str, mesh: int) -> list[tuple[float, float]]:
    """Time [s] and value of the extremes of an output in one mesh, if the history tells them."""
    return [
        (float(e.time[mesh]), float(e.value[mesh]))
        for e in told_extremes(history)
        if e.output == output
    ]
