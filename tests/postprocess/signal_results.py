"""A spectrum, an order map and a Campbell diagram of known signals."""

from __future__ import annotations

import numpy as np
import xarray as xr
from orbits_results import folded_orbits
from response_results import backlash_response
from signal_histories import START, by_angle, signal_history

from evolvent.commands.post.spectrum import make_spectrum
from evolvent.commands.post.waterfall import make_map
from evolvent.history import CAMPBELL, ORBITS, ORDER_MAP, RESPONSE, SPECTRUM
from evolvent.signals.campbell import Excitation, crossings
from evolvent.signals.results import campbell_result
from evolvent.signals.selection import select


def orders(xi: np.ndarray) -> np.ndarray:
    """Transmission error with three orders [m]."""
    lines = {1: 5e-7, 2: 2e-7, 5: 3e-8}
    return 1e-5 + sum(a * np.cos(2 * np.pi * n * xi - n) for n, a in lines.items())


def spectrum_of_orders(pitches: int = 5, scale: float = 1.0) -> xr.Dataset:
    """Spectrum over the orders of a mesh."""
    xi = np.arange(0, pitches + 1, 1 / 16)
    history = by_angle("pitch", "pinion-gear", 16, xi, scale * orders(xi))
    signal = select(history, "transmission_error", {})
    return make_spectrum(history, signal, None, None, None, None)


def run_up() -> xr.Dataset:
    """History of a run-up, 5 to 45 rev/s, with a resonance at 1.5 kHz."""
    time = np.linspace(0.0, 1.0, 20001)
    xi = 19 * (5.0 * time + 20.0 * time**2) + START
    rate = 19 * (5.0 + 40.0 * time)
    signal = 0.0 * time
    for n, amplitude in {1: 1e-7, 2: 5e-8, 3: 3e-8, 4: 2e-8}.items():
        gain = 1 / np.abs(1 - (n * rate / 1500) ** 2 + 0.2j * n * rate / 1500)
        signal += amplitude * gain * np.cos(2 * np.pi * n * xi)
    return signal_history(time, (xi - START) / 19, signal)


def map_of_run_up() -> xr.Dataset:
    """Order map of it."""
    history = run_up()
    signal = select(history, "transmission_error", {})
    return make_map(history, signal, "pinion-gear", 4, None, None, None)


def campbell_of_two_modes() -> xr.Dataset:
    """Campbell picture with two modes and three orders."""
    speed = np.linspace(50.0, 1250.0, 5)
    modes = {
        "natural_frequency": np.tile([250.0, 7000.0], (5, 1)),
        "damping_ratio": np.tile([0.2, 0.1], (5, 1)),
    }
    lines = [Excitation("mesh", "pinion-gear", n, 19.0) for n in (1, 2, 3)]
    lines.append(Excitation("wheel", "pinion", 1, 1.0))
    found = crossings(speed, modes["natural_frequency"], lines)
    computed = np.ones(5, dtype=bool)
    return campbell_result("{}", "case", "pinion", speed, modes, computed, lines, found)


def signal_result(kind: str) -> xr.Dataset:
    """One of a kind."""
    made = {SPECTRUM: spectrum_of_orders, ORDER_MAP: map_of_run_up, CAMPBELL: campbell_of_two_modes}
    made[RESPONSE] = backlash_response
    made[ORBITS] = folded_orbits
    return made[kind]()
