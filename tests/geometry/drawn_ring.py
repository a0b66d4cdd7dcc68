"""Outlines of an internal pair, drawn by a program of their own, and their overlap over a pitch.

A wheel is given by the half angle of its tooth over the radius, from the teeth, the rack and the
shifts; nothing here is taken from the kernel. Lengths in modules, radii positive.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Values = NDArray[np.float64]
ALPHA = np.radians(20.0)


def inv(tangent: Values | float) -> Values:
    """Involute function of tan alpha."""
    return np.asarray(tangent - np.arctan(tangent))


@dataclass(frozen=True)
class Outline:
    """Half angle of the tooth at increasing radii, from the root to the tip or back."""

    teeth: int
    radius: Values
    half: Values  # angle of the flank from the middle of the tooth
    tip: float
    root: float

    def points(self) -> Values:
        """Complex points of the flank at positive angles, with the tip arc."""
        arc = np.linspace(0.0, self.half_at(np.array([self.tip]))[0], 9)
        flank = (self.radius * np.exp(1j * self.half))[::8]
        return np.concatenate([flank, self.tip * np.exp(1j * arc)])

    def half_at(self, radius: Values) -> Values:
        """Half angle at radii between the root and the tip circle."""
        return np.interp(radius, self.radius, self.half)


def pinion(teeth: int, shift: float, addendum: float = 1.0, rounding: float = 0.38) -> Outline:
    """Draw a gear cut by the rack of ISO 53, without undercut."""
    r, rb = teeth / 2, teeth / 2 * np.cos(ALPHA)
    psi = (np.pi / 2 + 2 * shift * np.tan(ALPHA)) / r + 2 * inv(np.tan(ALPHA))
    tip, root = r + shift + addendum, r + shift - 1.25
    depth = 1.25 - rounding - shift  # of the tool's rounding below the rolling line
    # offset of the rounding's centre from the middle of the tool's tooth
    offset = np.pi / 4 - (1.25 - rounding) * np.tan(ALPHA) - rounding / np.cos(ALPHA)
    u = np.linspace(0.0, depth / np.tan(ALPHA), 2000)
    stretch = 1 + rounding / np.hypot(u, depth)  # the normal passes through the pitch point
    fillet = (r - stretch * depth) + 1j * stretch * u
    space = np.angle(fillet) - (u - offset) / r
    form = abs(fillet[-1])
    along = np.linspace(form, tip, 2000)[1:]
    involute = psi / 2 - inv(np.sqrt(along**2 / rb**2 - 1))
    return Outline(
        teeth,
        np.concatenate([abs(fillet), along]),
        np.concatenate([np.pi / teeth - space, involute]),
        tip,
        root,
    )


def annulus(teeth: int, shift: float, addendum: float, arc: float = 0.38) -> Outline:
    """Draw a ring with an arc at the root."""
    r, rb = teeth / 2, teeth / 2 * np.cos(ALPHA)
    # the space of the ring is as wide as the tooth of an external gear with the shift -x
    space = (np.pi / 2 - 2 * shift * np.tan(ALPHA)) / r + 2 * inv(np.tan(ALPHA))
    tip, root = r - shift - addendum, r - shift + 1.25
    middle = root - arc  # radius of the arc's centre
    moment = np.sqrt(middle**2 - rb**2)
    form = np.hypot(rb, moment + arc)
    along = np.linspace(tip, form, 2000)
    half_space = space / 2 - inv(np.sqrt(along**2 / rb**2 - 1))
    end = form * np.exp(1j * half_space[-1])
    # the centre lies on the flank's normal, which is the tangent to the base circle
    towards = end - rb * np.exp(1j * (half_space[-1] + np.arccos(rb / form)))
    centre = end - arc * towards / abs(towards)
    assert abs(abs(centre) - middle) < 1e-9 * middle, "the normal leads to the arc's centre"
    turn = np.linspace(np.angle(end - centre), np.angle(centre), 400)[1:]
    bottom = centre + arc * np.exp(1j * turn)
    radius = np.concatenate([along, abs(bottom)])
    half_space = np.concatenate([half_space, np.angle(bottom)])
    return Outline(teeth, radius, np.pi / teeth - half_space, tip, root)


def overlap(
    inner: Outline, outer: Outline, distance: float, backlash: float, positions: int = 21
) -> float:
    """Largest depth by which one outline lies in the other, over a pitch, drive flanks touching."""
    deepest = -np.inf
    base = inner.teeth / 2 * np.cos(ALPHA)
    cosine = (outer.tip**2 - distance**2 - inner.tip**2) / (2 * distance * inner.tip)
    # teeth up to where the tip circles cross
    reach = 3 + int(np.arccos(min(max(cosine, 0.0), 1.0)) * inner.teeth / (2 * np.pi))
    for turn in np.linspace(-0.5, 0.5, positions) * 2 * np.pi / inner.teeth:
        own = turn + backlash / (2 * base)
        other = turn * inner.teeth / outer.teeth
        for count in range(-reach, reach + 1):
            for mirrored in (False, True):
                flank = inner.points()
                flank = np.conj(flank) if mirrored else flank
                there = distance + flank * np.exp(1j * (own + 2 * np.pi * count / inner.teeth))
                deepest = max(deepest, _in_ring(outer, there * np.exp(-1j * other)))
                flank = outer.points()
                flank = np.conj(flank) if mirrored else flank
                tooth = 2 * np.pi * (count + 0.5) / outer.teeth + other
                there = (flank * np.exp(1j * tooth) - distance) * np.exp(-1j * own)
                deepest = max(deepest, _in_pinion(inner, there))
    return float(deepest)


def _beside(points: Values, teeth: int, start: float) -> Values:
    """Angle of points from the middle of the nearest tooth."""
    pitch = 2 * np.pi / teeth
    return np.asarray(abs((np.angle(points) - start + pitch / 2) % pitch - pitch / 2))


def _in_ring(ring: Outline, points: Values) -> float:
    radius = abs(points)
    depth = (ring.half_at(radius) - _beside(points, ring.teeth, np.pi / ring.teeth)) * radius
    depth = np.where(radius < ring.tip, -np.inf, depth)
    depth = np.minimum(depth, np.where(radius > ring.root, np.inf, radius - ring.tip))
    return float(np.where(radius > ring.root, radius - ring.root, depth).max())


def _in_pinion(gear: Outline, points: Values) -> float:
    radius = abs(points)
    depth = (gear.half_at(radius) - _beside(points, gear.teeth, 0.0)) * radius
    depth = np.minimum(depth, gear.tip - radius)
    return float(np.where(radius < gear.root, gear.root - radius, depth).max())
