"""Histories of known signals: a pair that turns as told, with any transmission error."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np
import xarray as xr
from real_gears import RealPair, no_events
from synthetic import write_history

TEETH = (19, 34)
START = 0.37  # pitches from pair 0's start of contact where the run starts
Signal = Callable[[np.ndarray], np.ndarray]


def signal_history(
    time: np.ndarray, turns: np.ndarray, signal: np.ndarray, start: float = START
) -> xr.Dataset:
    """History in which the pinion has turned by `turns`, in its nominal sense: clockwise.

    Parameters
    ----------
    signal : transmission error [m].
    start : pitches by which pair 0 is ahead of its start of contact at the start.
    """
    pair = RealPair(teeth=TEETH, penetration=0.0)
    still = pair.history(np.zeros(1))
    history = still.drop_dims("time").drop_dims("pair", errors="ignore")
    angle = 2 * np.pi * np.stack([-turns, turns * TEETH[0] / TEETH[1]], axis=1)
    units = {"units": "m", "long_name": "transmission error"}
    history = history.assign(
        start_position=("mesh", [start], {"units": "1"}),
        angle=(("time", "wheel"), angle, {"units": "rad"}),
        angular_velocity=(
            ("time", "wheel"),
            np.gradient(angle, time, axis=0) if time.size > 1 else angle,
            {"units": "rad s-1"},
        ),
        transmission_error=(("time", "mesh"), signal[:, None], units),
    ).assign_coords(time=("time", time, {"units": "s"}))
    return history.assign_attrs(still.attrs, title="a known signal", case="format: 1\n")


def by_angle(
    per: str, of: str, n: int, position: np.ndarray, signal: np.ndarray, rate: float = 500.0
) -> xr.Dataset:
    """History with output by angle: n rows a pitch of the mesh, or a turn of a wheel.

    Parameters
    ----------
    position : of the rows [pitches from pair 0's start of contact, or turns since the start].
    rate : periods a second.
    """
    turns = {
        "pair": (position - START) / TEETH[0], "pinion": position,
        "gear": position * TEETH[1] / TEETH[0],
    }["pair" if per == "pitch" else of]  # fmt: skip
    history = signal_history(position / rate, turns, signal)
    return history.assign(
        output_position=("time", position, {"units": "1"}),
        output_kind=("time", np.zeros(position.size, dtype=np.int32), {"units": "1"}),
    ).assign_attrs(output_per=per, output_number=n, output_of=of)


def steady(rate: float, step: float, duration: float, signal: Signal) -> xr.Dataset:
    """History over even times at a steady speed.

    Parameters
    ----------
    rate : pitches a second.
    signal : of the pitches from pair 0's start of contact.
    """
    time = step * np.arange(round(duration / step) + 1)
    pitches = rate * time
    return signal_history(time, pitches / TEETH[0], signal(pitches + START))


def written(path: Path, history: xr.Dataset) -> Path:
    """Write it as a run does, without events."""
    return write_history(path, history, no_events())
