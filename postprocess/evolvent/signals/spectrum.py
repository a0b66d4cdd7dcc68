"""Spectrum of a record: amplitudes and phases by the discrete Fourier transform."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Numbers = NDArray[np.float64]

ROUNDING = 1e-14  # relative to the mean or the largest line: smaller lines are rounding errors


@dataclass(frozen=True)
class Lines:
    """x = A_0 + sum A_k cos(2 pi abscissa_k s - phase_k) over the coordinate s of the record."""

    abscissa: Numbers  # frequency or order
    amplitude: Numbers  # A_0 is the mean, with its sign
    phase: Numbers  # [rad], from -pi to pi; that of the mean is 0

    def upto(self, highest: float) -> Lines:
        """Lines up to a frequency or order."""
        retained = self.abscissa <= highest * (1 + 1e-9)
        return Lines(self.abscissa[retained], self.amplitude[retained], self.phase[retained])


def line_spectrum(values: Numbers, first: float, step: float, weights: Numbers) -> Lines:
    """Compute lines at multiples of 1/(n step), equation S1.

    The amplitude of a sine on a line is exact: 2/sum(w) times the transform; the mean and, for an
    even number of samples, the line at half the sampling rate count once. The weighted mean is
    subtracted first, so that it does not leak into a line.

    Parameters
    ----------
    values : equidistant samples.
    first : coordinate of the first one; it affects phases by rounding only.
    step : from sample to sample.
    weights : window, of the same length.
    """
    n = values.size
    mean = float(values @ weights / weights.sum())
    lines = np.fft.rfft((values - mean) * weights) * (2.0 / weights.sum())
    if n % 2 == 0:
        lines[-1] /= 2.0
    order = np.arange(lines.size)
    abscissa = order / (n * step)
    amplitude, phase = np.abs(lines), wrapped(2 * math.pi * abscissa * first - np.angle(lines))
    amplitude[0], phase[0] = mean, 0.0
    return Lines(abscissa, amplitude, phase)


def line_at(
    values: Numbers, first: float, step: float, weights: Numbers, abscissa: float
) -> complex:
    """Compute one line A exp(-i phase) at 0 < abscissa < 1/(2 step), without the mean."""
    mean = float(values @ weights / weights.sum())
    s = first + step * np.arange(values.size)
    turned = np.exp(-2j * math.pi * ((abscissa * s) % 1.0))
    return complex(2.0 * ((values - mean) * weights) @ turned / weights.sum())


def wrapped(angle: Numbers) -> Numbers:
    """Angles from -pi to pi."""
    return np.asarray((angle + math.pi) % (2 * math.pi) - math.pi)


def peaks(lines: Lines, count: int) -> list[int]:
    """Indices of the largest local maxima without the mean, in the order of amplitude."""
    size = lines.amplitude.copy()
    size[0] = 0.0
    size[size < ROUNDING * max(abs(float(lines.amplitude[0])), size.max())] = 0.0
    padded = np.concatenate([[0.0], size, [0.0]])
    tops = np.flatnonzero((size > 0) & (size >= padded[:-2]) & (size > padded[2:]))
    return [int(i) for i in tops[np.argsort(-size[tops], kind="stable")][:count]]
