"""Geometry of teeth for drawings: outlines of wheels and contact points.

Points are complex numbers x + iy [m] in the housing frame. The driving flank faces clockwise for
sigma = +1 and counterclockwise for sigma = -1, on both wheels. Radii and radii of curvature of an
internal wheel are negative, as in ISO 21771; its teeth point inwards.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from evolvent.history import require
from evolvent.history.recording import recording_of

Points = NDArray[np.complex128]
Numbers = NDArray[np.float64]

FLANK_POINTS = 48  # of an involute: the chord error is less than 1e-6 of the base radius
ARC_POINTS = 7
# Assumptions for wheels defined by their pitch radius, for values missing in the history:
LOOSE = 0.06  # normal backlash over base pitch: a visible gap at the coast flanks
CLEARANCE = 0.25  # between a tip and the other wheel's root circle, over the tip's addendum


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


@dataclass(frozen=True)
class ToothPosition:
    """Position of a wheel's teeth at the start, as given by a mesh."""

    towards: float  # direction of the mate [rad]
    middle: float  # direction of the middle of one of its teeth [rad]


@dataclass(frozen=True)
class DrawnWheel:
    """One wheel; `profile` is None for a disc without teeth."""

    name: str
    centre: complex  # reference position [m]
    radius: float  # outermost [m]
    profile: Profile | None
    tooth_positions: tuple[ToothPosition, ...]

    def directions(self, angle: float) -> Numbers:
        """Directions of the middles of all teeth [rad] when the wheel has turned by `angle`.

        Each mesh determines the teeth that are nearer to it than to other meshes. If the tooth
        thickness is not known, the tooth spaces may therefore vary between two meshes.
        """
        if self.profile is None:
            return np.empty(0)
        towards = np.array([tooth_position.towards for tooth_position in self.tooth_positions])
        retained = []
        for number, tooth_position in enumerate(self.tooth_positions):
            middle = (
                tooth_position.middle + angle + self.profile.pitch * np.arange(self.profile.teeth)
            )
            away = np.abs(_wrapped(middle[:, None] - towards))
            retained.append(middle[np.argmin(away, axis=1) == number])
        found = np.sort(np.concatenate(retained) % (2 * np.pi))
        apart = np.diff(found, prepend=found[-1] - 2 * np.pi)
        return np.asarray(found[apart > self.profile.pitch / 2])

    def outline(self, angle: float, shift: complex = 0.0, exaggeration: float = 1.0) -> Points:
        """Closed outline for a rotation by `angle` [rad] and a displacement of the axis [m]."""
        if self.profile is None:
            local = self.radius * np.exp(1j * np.linspace(0.0, 2 * np.pi, 181))
        else:
            tooth = self.profile.tooth(exaggeration)
            local = np.concatenate([tooth * np.exp(1j * d) for d in self.directions(angle)])
            if self.profile.base_radius < 0:
                rim = np.exp(1j * (np.angle(local[0]) - np.linspace(0.0, 2 * np.pi, 181)))
                local = np.concatenate([local, local[:1], self.radius * rim])
        return np.asarray(self.centre + shift + local)


@dataclass(frozen=True)
class DrawnMesh:
    """One mesh: data of the line of action, and radii and points in the reference position."""

    name: str
    wheels: tuple[int, int]  # driving, driven
    sigma: int
    centres: tuple[complex, complex]
    base_radii: tuple[float, float]  # [m]
    path: tuple[float, float]  # radii of curvature of the driving flank at its ends [m]
    has_coast: bool

    def line(
        self, coast: bool = False, shifts: tuple[complex, complex] = (0j, 0j)
    ) -> tuple[complex, complex, float]:
        """Line of action: K_A, its unit vector e, and its length, negative if internal [m].

        Source: Kosenko & Gusev 2011, section 7.1; for the coast flank the mirror image.
        """
        sigma = -self.sigma if coast else self.sigma
        centre = self.centres[0] + shifts[0]
        axis = self.centres[1] + shifts[1] - centre
        total = self.base_radii[0] + self.base_radii[1]
        distance = np.copysign(abs(axis), total)
        alpha = np.arccos(min(total / distance, 1.0))
        across = axis / distance * np.exp(1j * sigma * alpha)
        length = float(np.copysign(np.sqrt(max(abs(axis) ** 2 - total**2, 0.0)), total))
        return complex(centre + self.base_radii[0] * across), complex(-1j * sigma * across), length

    @property
    def pitch_radii(self) -> tuple[float, float]:
        """Radii of the operating pitch circles [m]."""
        ratio = abs(self.centres[1] - self.centres[0]) / abs(sum(self.base_radii))
        return self.base_radii[0] * ratio, self.base_radii[1] * ratio

    @property
    def tip_radii(self) -> tuple[float, float]:
        """Radii of the circles through the ends of the path of contact [m]."""
        rho = self.path[1], self.line()[2] - self.path[0]
        a, b = (
            float(np.copysign(np.hypot(base, end), base))
            for base, end in zip(self.base_radii, rho, strict=True)
        )
        return a, b

    @property
    def points(self) -> dict[str, complex]:
        """K_A, K_B, the ends a and b of the path of contact, and the pitch point."""
        start, along, length = self.line()
        axis = self.centres[1] - self.centres[0]
        return {
            "K_A": start,
            "K_B": start + length * along,
            "a": start + self.path[0] * along,
            "b": start + self.path[1] * along,
            "P": self.centres[0] + axis / sum(self.pitch_radii) * self.pitch_radii[0],
        }

    def flank(self, wheel: int, contact: float, n: int = 200) -> Points:
        """Return an involute flank that touches the line of action.

        Parameters
        ----------
        wheel : 0 driving, 1 driven.
        contact : distance of the contact point from K_A [m].
        n : number of points.

        Returns
        -------
        Points from the root on the base circle to the tip, shape (n,); of an internal wheel from
        the other end of its path of contact.

        Source: the involute by its radius of curvature rho, Kosenko & Gusev 2011, section 4.
        """
        start, along, length = self.line()
        base, tip = self.base_radii[wheel], self.tip_radii[wheel]
        across = (start - self.centres[0]) / self.base_radii[0]
        first = (self.path[0], length - self.path[1])[wheel] if base < 0 else 0.0
        rho = np.linspace(first, np.copysign(np.sqrt(tip**2 - base**2), base), n)
        turned = np.exp(1j * self.sigma * (rho - (contact, length - contact)[wheel]) / base)
        local = (1, -1)[wheel] * (base * across + rho * along)
        return np.asarray(self.centres[wheel] + turned * local)

    def shifts(self, history: xr.Dataset, row: int) -> tuple[complex, complex]:
        """Displacements of both axes at an output [m]."""
        moved = require(history, "centre_displacement").values[row]
        return complex(*moved[self.wheels[0]]), complex(*moved[self.wheels[1]])


def drawn_meshes(history: xr.Dataset) -> list[DrawnMesh]:
    """Collect all meshes from the static variables of a history."""
    centres = [complex(*c) for c in require(history, "centre").values]
    base = require(history, "base_radius").values
    meshes = []
    for number, name in enumerate(history["mesh"].values):
        a = int(require(history, "driving_wheel")[number])
        b = int(require(history, "driven_wheel")[number])
        start = float(require(history, "rho_start_driving")[number])
        length = float(require(history, "base_pitch")[number])
        # Pairs without these variables are of the paper's type: one tooth pair, one flank.
        ratio, has_coast = (
            history[name].values[number] if name in history else usual
            for name, usual in (("contact_ratio", 1.0), ("has_coast_flanks", False))
        )
        meshes.append(
            DrawnMesh(
                name=str(name),
                wheels=(a, b),
                sigma=int(require(history, "flank")[number]),
                centres=(centres[a], centres[b]),
                base_radii=(float(base[a]), float(base[b])),
                path=(start, start + float(ratio) * length),
                has_coast=bool(has_coast),
            )
        )
    return meshes


def drawn_wheels(history: xr.Dataset) -> list[DrawnWheel]:
    """Collect all wheels from the static variables of a history."""
    meshes = drawn_meshes(history)
    wheels = []
    for number, name in enumerate(history["wheel"].values):
        own = [m for m, mesh in enumerate(meshes) if number in mesh.wheels]
        profile = _profile(history, meshes, number, own) if own else None
        tooth_positions = []
        for m in own if profile else []:
            mesh, side = meshes[m], meshes[m].wheels.index(number)
            roots = require(history, ("flank_root_driving", "flank_root_driven")[side])
            axis = (mesh.centres[1] - mesh.centres[0]) * (1, -1)[side]
            assert profile is not None
            middle = float(roots[m]) + mesh.sigma * profile.tooth_angle / 2
            middle += np.pi * (profile.base_radius < 0)
            axis *= np.sign(sum(mesh.base_radii)) * np.sign(profile.base_radius)
            tooth_positions.append(ToothPosition(float(np.angle(axis)), middle))
        pitch_radius = float(require(history, "pitch_radius")[number])
        outermost = profile.tip_radius if profile else pitch_radius
        if profile and profile.base_radius < 0:
            outermost = profile.tip_radius - 2 * profile.root_radius  # a rim as high as the teeth
        wheels.append(
            DrawnWheel(
                name=str(name),
                centre=complex(*require(history, "centre").values[number]),
                radius=outermost,
                profile=profile,
                tooth_positions=tuple(tooth_positions),
            )
        )
    return wheels


def pitches_passed(history: xr.Dataset) -> Numbers:
    """Pitches that the fastest teeth have passed since the first output, in either direction."""
    run = recording_of(history)
    passed = np.zeros(run.n)
    for part in run.parts():
        first = max(part.begin - 1, 0)
        turned = np.abs(np.diff(run.read("angle", first, part.end), axis=0))
        pitches = (turned * abs(run["teeth"]) / (2 * np.pi)).max(axis=1)
        passed[first : part.end] = np.cumsum(np.append(passed[first], pitches))
    return passed


def _profile(
    history: xr.Dataset, meshes: list[DrawnMesh], wheel: int, own: list[int]
) -> Profile | None:
    """Shape of a wheel's teeth; unknown values are derived from its meshes."""

    def known(name: str) -> float:
        return float(require(history, name)[wheel])

    base, tip, active = known("base_radius"), known("tip_radius"), known("active_radius")
    teeth = abs(int(known("teeth")))
    tooth_angle, form, root = known("tooth_angle"), known("form_radius"), known("root_radius")
    if np.isnan(tooth_angle):
        tooth_angle = _even_tooth_angle(history, meshes[own[0]], own[0], wheel)
        form = active
        root = min(_root_below(history, meshes[m], wheel) for m in own)
    profile = Profile(
        teeth=teeth,
        base_radius=base,
        start_radius=form,
        active_radius=active,
        tip_radius=tip,
        root_radius=root,
        tooth_angle=tooth_angle,
        # Tips of older histories are sharp.
        rounding=known("tip_rounding") if "tip_rounding" in history else 0.0,
        crowning=known("profile_crowning"),
    )
    reliefs = []
    for kind, end in (("tip", profile.rho_end), ("root", profile.rho(active))):
        amount = known(f"{kind}_relief")
        if amount > 0:
            start = profile.rho(known(f"{kind}_relief_start"))
            reliefs.append(Relief(amount, start, end, int(known(f"{kind}_relief_power"))))
    return replace(profile, reliefs=tuple(reliefs))


def _even_tooth_angle(history: xr.Dataset, mesh: DrawnMesh, number: int, wheel: int) -> float:
    """Angle of a tooth on the base circle if both wheels have equally thick teeth [rad].

    The thickness is half the pitch on the operating pitch circle, less half of the backlash.
    """
    base = mesh.base_radii[mesh.wheels.index(wheel)]
    alpha = float(require(history, "working_pressure_angle")[number])
    pitch = float(require(history, "base_pitch")[number])
    backlash = float(require(history, "backlash")[number])
    if not mesh.has_coast:
        backlash = LOOSE * pitch
    return float((pitch - backlash) / (2 * base) + 2 * (np.tan(alpha) - alpha))


def _root_below(history: xr.Dataset, mesh: DrawnMesh, wheel: int) -> float:
    """Root radius with some clearance to the mate's tip [m]."""
    side = mesh.wheels.index(wheel)
    mate = mesh.wheels[1 - side]
    distance = abs(mesh.centres[1] - mesh.centres[0])
    share = mesh.base_radii[1 - side] / (mesh.base_radii[0] + mesh.base_radii[1])
    tip = float(require(history, "tip_radius")[mate])
    return distance - tip - CLEARANCE * abs(tip - share * distance)


def _wrapped(angle: Numbers) -> Numbers:
    """Equivalent directions from -pi to pi."""
    return np.asarray((angle + np.pi) % (2 * np.pi) - np.pi)
