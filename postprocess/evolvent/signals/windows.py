"""Window functions by name, and their effect on a line.

Source: F. J. Harris, On the use of windows for harmonic analysis with the discrete Fourier
transform, Proceedings of the IEEE 66, 1978, for the measures.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from evolvent.signals.window_names import WINDOWS

Numbers = NDArray[np.float64]

MEASURED = 512  # samples of a measured window
FINE = 64  # evaluation points of its transform between two lines


@dataclass(frozen=True)
class Measures:
    """Measures of a window; a line is 1/duration wide."""

    noise_bandwidth: float  # equivalent noise bandwidth [lines]
    reads_low: float  # relative amplitude loss half way between two lines
    half_width: int  # lines from the middle of a line to its first zero
    leakage: float  # highest side lobe over the line


def window(name: str, n: int) -> Numbers:
    """Periodic window of n samples; the zeros of its transform coincide with lines."""
    from scipy.signal import get_window

    return np.asarray(get_window(WINDOWS[name], n, fftbins=True), dtype=float)


def noise_bandwidth(weights: Numbers) -> float:
    """Equivalent noise bandwidth in lines, N sum w^2 / (sum w)^2; equation S4."""
    return float(weights.size * (weights**2).sum() / weights.sum() ** 2)


def measures(name: str) -> Measures:
    """Measure a window by its transform between the lines."""
    weights = window(name, MEASURED)
    lobes = np.abs(np.fft.rfft(weights, FINE * MEASURED)) / weights.sum()
    # the main lobe ends where the transform first rises again; a flat top has ripples
    rising = np.flatnonzero((np.diff(lobes) > 0) & (lobes[1:] < 0.5))
    end = int(rising[0])
    return Measures(
        noise_bandwidth(weights), 1.0 - float(lobes[FINE // 2]), round(end / FINE),
        float(lobes[end:].max()),
    )  # fmt: skip
