"""Outlines of arrows, and round values for a scale."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

Points = NDArray[np.complex128]
HEAD = 4.0  # length of an arrow's head over its width
CHORDS = 40


def arrow(tail: complex, vector: complex, width: float) -> Points:
    """Outline of a straight arrow; the head of a short one is reduced."""
    length = abs(vector)
    if length == 0.0:
        return np.full(7, tail)
    head, half = _head(length, width)
    flat = np.array([
        -1j * half, length - head - 1j * half, length - head - 1j * head / 2.4, length,
        length - head + 1j * head / 2.4, length - head + 1j * half, 1j * half,
    ])  # fmt: skip
    return np.asarray(tail + flat * vector / length)


def curved_arrow(
    centre: complex, radius: float, middle: float, angle: float, width: float
) -> Points:
    """Outline of an arrow along a circle.

    Parameters
    ----------
    middle : direction of its middle, seen from the centre [rad].
    angle : spanned angle, counterclockwise positive [rad].
    """
    if angle == 0.0:
        return np.full(7, centre + radius * np.exp(1j * middle))
    head, half = _head(radius * abs(angle), width)
    sign = np.sign(angle)
    begin, end = middle - angle / 2, middle + angle / 2
    neck = end - sign * head / radius
    along = np.exp(1j * np.linspace(begin, neck, CHORDS))
    tip = [(radius + head / 2.4), (radius - head / 2.4)]
    barbs = np.array([tip[0] * np.exp(1j * neck), radius * np.exp(1j * end)])
    back = tip[1] * np.exp(1j * neck)
    outline = np.concatenate(
        [(radius + half) * along, barbs, [back], (radius - half) * along[::-1]]
    )
    return np.asarray(centre + outline)


def _head(length: float, width: float) -> tuple[float, float]:
    """Length of the head, and half the width of the shaft."""
    head = min(HEAD * width, 0.6 * length)
    return head, width / 2 * min(1.0, head / (HEAD * width) + 0.4)


def round_below(value: float) -> float:
    """Largest of 1, 2, 5 times a power of ten that does not exceed a value."""
    power = 10.0 ** np.floor(np.log10(value))
    return float(max(step * power for step in (1, 2, 5) if step * power <= value * (1 + 1e-9)))


def xy(points: Any) -> NDArray[np.float64]:
    """Coordinates of complex points, shape (n, 2)."""
    return np.stack([np.real(points), np.imag(points)], axis=-1)
