"""Profile of a tooth for drawings: involute, reliefs, tip rounding and fillet.

Points are complex numbers x + iy [m], relative to the axis of the wheel.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Points = NDArray[np.complex128]
Numbers = NDArray[np.float64]

FLANK_POINTS = 48  # of an involute: the chord error is less than 1e-6 of the base radius
ARC_POINTS = 7


@dataclass(frozen=True)
class Relief:
    """Material removed from a profile, starting at a radius; see docs/theory/deviations.md."""

    amount: float  # at the end of the profile [m]
    start: float  # radius of curvature at its start [m]
    end: float  # radius of curvature at the end of the profile [m]
    power: int  # 1 linear, 2 parabolic

    def at(self, rho: Numbers) -> Numbers:
        """Deviation [m] at radii of curvature [m]."""
        share = np.clip((rho - self.start) / (self.end - self.start), 0.0, None)
        return np.asarray(self.amount * share**self.power)


@dataclass(frozen=True)
class Profile:
    """Shape of the teeth of one wheel."""

    teeth: int
    base_radius: float  # [m]; this and all other radii are negative for an internal wheel
    start_radius: float  # start of the involute [m]
    active_radius: float  # start of the active profile [m]
    tip_radius: float  # [m]
    root_radius: float  # [m]
    tooth_angle: float  # angle of a tooth on the base circle [rad]
    rounding: float = 0.0  # radius of the tip rounding [m]
    reliefs: tuple[Relief, ...] = ()
    crowning: float = 0.0  # at both ends of the active profile [m]

    @property
    def pitch(self) -> float:
        """Angular pitch [rad]."""
        return 2 * np.pi / self.teeth

    def rho(self, radius: float) -> float:
        """Radius of curvature of the involute at a radius, 0 inside the base circle [m]."""
        rho = np.sqrt(max(radius**2 - self.base_radius**2, 0.0))
        return float(np.copysign(rho, self.base_radius))

    @property
    def rho_end(self) -> float:
        """Radius of curvature at the end of the involute, at the tip or its rounding [m]."""
        return self.rounding + self.rho(self.tip_radius - self.rounding)

    def deviation(self, rho: Numbers) -> Numbers:
        """Material removed from a flank by reliefs and crowning, at radii of curvature [m].

        Source: docs/theory/deviations.md; pitch errors and runout are not included.
        """
        begin, end = self.rho(self.active_radius), self.rho_end
        crowned = self.crowning * ((2 * rho - begin - end) / (end - begin)) ** 2
        return np.asarray(crowned + sum(relief.at(rho) for relief in self.reliefs))

    def flank(self, exaggeration: float = 1.0, n: int = FLANK_POINTS) -> Points:
        """Points of the flank that faces clockwise, shape (n,), relative to the axis.

        It extends from the start of the involute to the tip or its rounding, on a tooth centred at
        direction 0, with its deviation multiplied by `exaggeration`.

        Source: the involute by its radius of curvature, Kosenko & Gusev 2011, section 4.
        """
        rho = np.linspace(self.rho(self.start_radius), self.rho_end, n)
        moved = rho - exaggeration * self.deviation(rho)
        turned = np.exp(1j * (rho / self.base_radius - self.tooth_angle / 2))
        points = np.asarray((self.base_radius - 1j * moved) * turned)
        # negative radii: half a turn away, and the other side of the tooth
        return -np.conj(points) if self.base_radius < 0 else points

    def tooth(self, exaggeration: float = 1.0) -> Points:
        """Outline of a tooth centred at direction 0, counterclockwise.

        It starts and ends on the root circle, in the middle of the tooth spaces.
        """
        flank = self.flank(exaggeration)
        half = np.concatenate([self._root(flank), flank, self._rounded(flank[-1])])
        tip, end = float(abs(half[-1])), float(np.angle(half[-1]))
        land = np.linspace(end, -end, ARC_POINTS)[1:-1]
        return np.concatenate([half, tip * np.exp(1j * land), np.conj(half[::-1])])

    def _rounded(self, end: complex) -> Points:
        """Points from the end of the flank to the tip circle; empty for a sharp tip."""
        if not self.rounding > 0:
            return np.empty(0, complex)
        normal = -1j * np.exp(1j * (self.rho_end / self.base_radius - self.tooth_angle / 2))
        middle = end - self.rounding * normal
        to_tip = np.linspace(np.angle(normal), np.angle(middle), ARC_POINTS)[1:]
        return np.asarray(middle + self.rounding * np.exp(1j * to_tip))

    def _root(self, flank: Points) -> Points:
        """Points from the middle of the space to the flank: root circle and a smooth fillet.

        The fillet is not a generated curve: only its ends are known. It is slender enough for the
        tips of mates, which also clear the fillets of actual gears.
        """
        root = abs(self.root_radius)
        height = abs(abs(flank[0]) - root)
        direction = float(np.angle(flank[0]))
        width = min(0.9 * (direction + self.pitch / 2), 0.3 * height / root)
        end = direction - width
        foot = root * np.exp(1j * end)
        along = flank[1] - flank[0]
        pull = 0.85 * height * along / abs(along)
        push = 0.8 * width * root * 1j * np.exp(1j * end)
        u = np.linspace(0.0, 1.0, 2 * ARC_POINTS)[:-1]
        fillet = (
            (1 - u) ** 3 * foot
            + 3 * (1 - u) ** 2 * u * (foot + push)
            + 3 * (1 - u) * u**2 * (flank[0] - pull)
            + u**3 * flank[0]
        )
        bottom = np.linspace(-self.pitch / 2, end, ARC_POINTS)[:-1]
        return np.concatenate([root * np.exp(1j * bottom), fillet])
