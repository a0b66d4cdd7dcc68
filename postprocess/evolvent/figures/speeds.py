"""Speeds of all wheels."""

from __future__ import annotations

import xarray as xr
from matplotlib.figure import Figure

from evolvent.figures.over_time import Curve, Panel, figure_over_time, name_of
from evolvent.history import require


def figure_speeds(history: xr.Dataset, events: xr.Dataset | None = None) -> Figure:
    """Draw the angular velocity [rad/s] of every wheel over time, dims (time, wheel)."""
    speed = require(history, "angular_velocity")
    curves = [
        Curve(name_of(history, "wheel", w), speed.isel(wheel=w)) for w in range(speed.wheel.size)
    ]
    return figure_over_time([Panel(r"angular velocity $\omega$", curves, events=events)])
