"""Extremes over a run: those in the history, else those of its outputs.

Extremes in the history were located between the outputs during the run.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from evolvent.history.recording import Recording, Values, recording_of
from evolvent.units import quantity

if TYPE_CHECKING:
    import xarray as xr

# Evaluated from the outputs if a history does not contain extremes.
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
ENDINGS = {"_max": True, "_min": False}  # name suffixes: whether it is the maximum


@dataclass(frozen=True)
class Extreme:
    """An extreme of an output, for each mesh."""

    output: str  # name of the output
    is_largest: bool
    between_outputs: bool  # located between the outputs; else it is that of the outputs
    value: xr.DataArray  # dim (mesh)
    time: xr.DataArray  # when it was first reached [s], dim (mesh)


def extreme_names(names: Iterable[str]) -> Iterator[tuple[str, str, bool]]:
    """List extremes among the variables of a history: name, output, whether it is the maximum."""
    there = list(names)
    for name in there:
        for ending, is_largest in ENDINGS.items():
            output = name.removesuffix(ending)
            if name.endswith(ending) and output in there and f"{name}_time" in there:
                yield name, output, is_largest


def recorded_extremes(history: xr.Dataset) -> list[Extreme]:
    """List the extremes in a history; none if it is of an older version, or its run was killed."""
    return [
        Extreme(output, is_largest, True, history[name], history[f"{name}_time"])
        for name, output, is_largest in extreme_names(map(str, history.data_vars))
    ]


def is_extreme(name: str) -> bool:
    """Whether a static variable is an extreme or the time of one, by its name."""
    return name.removesuffix("_time").endswith(tuple(ENDINGS))


def peaks(history: xr.Dataset, output: str, mesh: int) -> list[tuple[float, float]]:
    """Time [s] and value of the extremes of an output in one mesh, if the history has them."""
    return [
        (float(e.time[mesh]), float(e.value[mesh]))
        for e in recorded_extremes(history)
        if e.output == output
    ]


def extremes(history: xr.Dataset) -> list[Extreme]:
    """List the extremes of a history: those that it contains, else those of its outputs."""
    import xarray as xr

    recorded = recorded_extremes(history)
    if recorded or history.sizes["time"] == 0:
        return recorded
    run = recording_of(history)
    found = []
    for name in (n for n in OF_OUTPUTS if n in history):
        for is_largest in (True, False) if name in SIGNED else (True,):
            value, time = (
                xr.DataArray(one, dims="mesh", name=name)
                for one in _of_outputs(run, name, is_largest)
            )
            found.append(Extreme(name, is_largest, False, value, time))
    return found


def _of_outputs(run: Recording, name: str, is_largest: bool) -> tuple[Values, Values]:
    """Extreme of the outputs of each mesh, and when it was first reached; NaN if there is none."""
    sense = 1.0 if is_largest else -1.0
    shape = run.variables[name].shape[:1]
    best, when = np.full(shape, -np.inf), np.full(shape, float(run["time"][0]))
    for part in run.parts():
        values = sense * part[name]
        if values.ndim > 2:  # of tooth pairs
            values = np.fmax.reduce(values, axis=2)
        filled = np.where(np.isnan(values), -np.inf, values)
        rows = filled.argmax(axis=0)
        tops = np.take_along_axis(filled, rows[np.newaxis], axis=0)[0]
        is_new = tops > best
        best, when = np.where(is_new, tops, best), np.where(is_new, part["time"][rows], when)
    return sense * np.where(np.isneginf(best), np.nan, best), when


def extremes_table(history: xr.Dataset) -> list[tuple[str, list[str]]]:
    """Format the extremes as text: name, and value and time for each mesh."""
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
