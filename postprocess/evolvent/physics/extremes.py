"""The extremes over a run: those that a history tells, else those of its outputs."""

from __future__ import annotations

import xarray as xr

from evolvent.told_extremes import Extreme, told_extremes
from evolvent.units import quantity


def extremes(history: xr.Dataset) -> list[Extreme]:
    """List the extremes of a history: those that it tells, else those of its outputs."""
    told = told_extremes(history)
    if told or history.sizes["time"] == 0:
        return told
    names = ("normal_force", "friction_force", "penetration", "transmission_error")
    signed = ("friction_force", "transmission_error")
    found = []
    for name in (n for n in names if n in history):
        for is_largest in (True, False) if name in signed else (True,):
            values = history[name]
            place = values.argmax("time") if is_largest else values.argmin("time")
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
