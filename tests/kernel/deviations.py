"""Flank deviations from Python, and the same formulas in mpmath.

The calls are those of `tests/geometry/deviation_calls.f90`; `Formula` follows
docs/theory/deviations.md, not the kernel.
"""

from __future__ import annotations

import ctypes
from dataclasses import dataclass
from typing import NamedTuple

import mpmath as mp
import numpy as np
from numpy.typing import ArrayLike

from kernel.description import Block, described
from kernel.interface import fields
from kernel.kernel import OK, Floats, Kernel, Status, _error

LINEAR, PARABOLIC = "linear", "parabolic"
ROOT, NONE, TIP = -1, 0, 1


class Profile(ctypes.Structure):
    """A profile of a flank."""

    _fields_ = fields("given_profile")


class Deviation(NamedTuple):
    """Deviation e with its derivatives to rho, and the limits of the zones."""

    e: Floats
    de: Floats
    d2e: Floats
    borders: Floats


def relief(
    amount: float,
    *,
    diameter: float | None = None,
    roll_angle: float | None = None,
    shape: str = LINEAR,
) -> Block:
    """Relief that starts at a diameter or at a roll angle."""
    start = {"roll_angle": roll_angle} if diameter is None else {"diameter": diameter}
    return Block(amount=amount, **start, shape=shape)


def deviations(
    *,
    accuracy_class: int = 0,
    seed: int = 0,
    runout_amount: float | None = None,
    runout_phase: float = 0.0,
    radial_runout: float | None = None,
    **fields: object,
) -> Block:
    """Deviations of a wheel; those not given are zero."""
    result = Block({key: value for key, value in fields.items() if value is not None})
    if accuracy_class:
        result.accuracy = Block({"class": accuracy_class, "seed": seed})
    if runout_amount is not None:
        result.eccentricity = Block(amount=runout_amount, phase=runout_phase)
    if radial_runout is not None:
        result.eccentricity = Block(radial_runout=radial_runout, phase=runout_phase)
    return result


def deviation_at(
    kernel: Kernel,
    given: Block,
    profile: Profile,
    rho: ArrayLike,
    tooth: ArrayLike = 0,
    side: ArrayLike = 1,
    zones: ArrayLike | None = None,
) -> Deviation:
    """Deviations at radii of curvature; zones: None for the zones at these radii.

    Raises KernelError if the description is rejected.
    """
    arrays = np.broadcast_arrays(*np.atleast_1d(rho, tooth, side, 0 if zones is None else zones))
    radii = np.ascontiguousarray(arrays[0], dtype=float)
    teeth, sides, held = (np.ascontiguousarray(a, dtype=np.int32) for a in arrays[1:])
    n = radii.size
    result = Deviation(np.empty(n), np.empty(n), np.empty(n), np.empty(2))
    status = Status()
    wheel = {"name": "w", "material": "m", "width": 1.0, "module": 1.0, **given}
    with described(kernel.library, {"wheels": [wheel]}, status) as description:
        if description:
            arguments = (teeth, sides, radii, None if zones is None else held)
            kernel.library.test_flank_deviation(
                description, profile, n, *arguments, *result, status
            )
    if status.code != OK:
        raise _error(status)
    return result


def pitch_tolerances(
    kernel: Kernel, teeth: int, module: float, accuracy_class: int
) -> tuple[float, float]:
    """Return f_pT and F_pT [m]; raises KernelError if the standard gives none."""
    single, total = np.empty((2, 1))
    kernel.checked("test_pitch_tolerances", teeth, module, accuracy_class, single, total)
    return float(single[0]), float(total[0])


def pitch_error_sequence(
    kernel: Kernel, teeth: int, single: float, total: float, seed: int
) -> Floats:
    """Cumulative position deviation of every tooth [m]."""
    errors = np.empty(teeth)
    kernel.library.test_pitch_error_sequence(teeth, single, total, seed, errors)
    return errors


@dataclass
class Formula:
    """Deviation e(rho) of docs/theory/deviations.md in mpmath, on the branch selected by a zone."""

    given: Block
    profile: Profile

    def relief(self, zone: int) -> Block | None:
        """Relief of the zone TIP or ROOT; None if there is none."""
        given: Block = self.given.get({ROOT: "root_relief", TIP: "tip_relief"}[zone], {})
        return given if given.get("amount", 0.0) > 0 else None

    def start(self, relief: Block) -> mp.mpf:
        """Radius of curvature at which a relief starts."""
        r_b = mp.mpf(self.profile.base_radius)
        if "roll_angle" in relief:
            return r_b * mp.mpf(relief.roll_angle)
        return mp.sqrt((mp.mpf(relief.diameter) / 2) ** 2 - r_b**2)

    def e(self, rho: mp.mpf, tooth: int, side: int, zone: int) -> mp.mpf:
        """Material removed from the flank [m]."""
        given, profile = self.given, self.profile
        low, high = mp.mpf(profile.rho_start), mp.mpf(profile.rho_tip)
        r_b, z = mp.mpf(profile.base_radius), profile.teeth
        e = mp.mpf(0)
        if zone != NONE and (chosen := self.relief(zone)):
            border, end = self.start(chosen), low if zone == ROOT else high
            power = 1 if chosen.shape == LINEAR else 2
            e += chosen.amount * ((rho - border) / (end - border)) ** power
        e += given.get("profile_crowning", 0) * ((2 * rho - low - high) / (high - low)) ** 2
        if "pitch_errors" in given:
            arc = mp.mpf(given.pitch_errors[tooth % z])
            e += side * arc * r_b / mp.mpf(profile.reference_radius)
        # outward normal of the flank, whose involute starts at `root` on the base circle
        root = 2 * mp.pi * tooth / z - side * mp.mpf(profile.tooth_angle) / 2
        beta = root + side * rho / r_b
        normal = (side * mp.sin(beta), -side * mp.cos(beta))
        eccentricity = given.get("eccentricity", Block(amount=0.0, phase=0.0))
        centre = (mp.cos(eccentricity.phase), mp.sin(eccentricity.phase))
        e -= eccentricity.amount * (normal[0] * centre[0] + normal[1] * centre[1])
        return e
