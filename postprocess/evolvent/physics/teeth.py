"""Geometry of teeth for drawings: outlines of wheels and contact points.

Points are complex numbers x + iy [m] in the housing frame. The driving flank faces clockwise for
sigma = +1 and counterclockwise for sigma = -1, on both wheels. Radii and radii of curvature of an
internal wheel are negative, as in ISO 21771; its teeth point inwards.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
import xarray as xr

from evolvent.history import require
from evolvent.history.recording import recording_of
from evolvent.physics.tooth_profile import Numbers, Points, Profile, Relief

# Assumptions for wheels defined by their pitch radius, for values missing in the history:
LOOSE = 0.06  # normal backlash over base pitch: a visible gap at the coast flanks
CLEARANCE = 0.25  # between a tip and the other wheel's root circle, over the tip's addendum


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
    if np.isnan(tooth_angle) or tooth_angle == 0.0:
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
