"""The extremes over a run: those that a history tells, else those of its outputs.

What it tells was found between the outputs while it ran.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import xarray as xr

from evolvent.units import quantity

# Found in the outputs where a history does not tell them.
OF_OUTPUTS = (
    "normal_force",
    "pair_normal_force",
    "friction_force",
    "pair_contact_pressure",
    "penetration",
    "transmission_error",
    "sliding_velocity",
)
SIGNED = ("friction_force", "transmission_error", "sliding_velocity")
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


def extremes(history: xr.Dataset) -> list[Extreme]:
    """List the extremes of a history: those that it tells, else those of its outputs."""
    told = told_extremes(history)
    if told or history.sizes["time"] == 0:
        return told
    found = []
    for name in (n for n in OF_OUTPUTS if n in history):
        values = history[name]
        for is_largest in (True, False) if name in SIGNED else (True,):
            if "pair" in values.dims:
                values = values.max("pair")
            filled = values.fillna(-np.inf if is_largest else np.inf)
            place = filled.argmax("time") if is_largest else filled.argmin("time")
            value = values.isel(time=place).drop_vars("time")
            found.append(Extreme(name, is_largest, False, value, history["time"][place]))
    return found


def extremes_table(history: xr.Dataset) -> list[tuple[str, list[str]]]:
    """Write the extremes as they are read: what, and for each mesh how much and when."""
    rows = []
    for e in extremes(history):
        variable = history[e.output]
        which = "largest" if e.is_largest else "smallest"
        label = f"{which} {variable.attrs.get('long_name', e.output)}"
        if e.between_outputs:
            label = str(e.value.attrs.get("long_name", label))
        units = str(variable.attrs.get("units", "1"))
        texts = [
            f"{quantity(float(value), units)} at {float(time):.6g} s"
            for value, time in zip(e.value, e.time, strict=True)
        ]
        rows.append((label, texts))
    return rows
