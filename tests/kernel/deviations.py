"""Flank deviations from Python, and the same formulas in mpmath.

The calls are those of `tests/geometry/deviation_calls.f90`; `Formula` is written from
docs/deviations.md, not from the kernel.
"""

from __future__ import annotations

import ctypes
from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple

import mpmath as mp
import numpy as np
from numpy.typing import ArrayLike

from kernel.kernel import OK, Floats, Kernel, Status, _at, _double, _error, _int

LINEAR, PARABOLIC = range(2)
ROOT, NONE, TIP = -1, 0, 1


class ReliefDescription(ctypes.Structure):
    """`evl_relief`."""

    _fields_ = [
        ("amount", _double),
        ("by_roll_angle", ctypes.c_bool),
        ("start", _double),
        ("shape", _int),
    ]


class DeviationDescription(ctypes.Structure):
    """`evl_flank_deviation`."""

    _fields_ = [
        ("tip_relief", ReliefDescription),
        ("root_relief", ReliefDescription),
        ("profile_crowning", _double),
        ("n_pitch_errors", _int),
        ("pitch_errors", ctypes.POINTER(_double)),
        ("accuracy_class", _int),
        ("seed", _int),
        ("runout_amount", _double),
        ("runout_phase", _double),
    ]


class Profile(ctypes.Structure):
    """`given_profile` of the tests."""

    _fields_ = [
        ("teeth", _int),
        ("base_radius", _double),
        ("reference_radius", _double),
        ("rho_start", _double),
        ("rho_tip", _double),
        ("tooth_angle", _double),
    ]


class Deviation(NamedTuple):
    """e with its derivatives to rho, and the borders of the zones."""

    e: Floats
    de: Floats
    d2e: Floats
    borders: Floats


def relief(
    amount: float,
    *,
    diameter: float | None = None,
    roll_angle: float | None = None,
    shape: int = LINEAR,
) -> ReliefDescription:
    """Relief that starts at a diameter or at a roll angle."""
    start = roll_angle if diameter is None else diameter
    return ReliefDescription(amount, diameter is None, start, shape)


def deviations(
    *, pitch_errors: Sequence[float] | None = None, **fields: object
) -> DeviationDescription:
    """Deviations of a wheel: all 0 but those given."""
    description = DeviationDescription(**fields)
    if pitch_errors is not None:
        description.n_pitch_errors = len(pitch_errors)
        description.pitch_errors = (_double * len(pitch_errors))(*pitch_errors)
    return description


def deviation_at(
    kernel: Kernel,
    given: DeviationDescription,
    profile: Profile,
    rho: ArrayLike,
    tooth: ArrayLike = 0,
    side: ArrayLike = 1,
    zones: ArrayLike | None = None,
) -> Deviation:
    """Deviations at radii of curvature; zones: None for those that hold there.

    Raises
    ------
    KernelError
        If the description is refused.
    """
    arrays = np.broadcast_arrays(*np.atleast_1d(rho, tooth, side, 0 if zones is None else zones))
    radii = np.ascontiguousarray(arrays[0], dtype=float)
    teeth, sides, held = (np.ascontiguousarray(a, dtype=np.int32) for a in arrays[1:])
    n = radii.size
    result = Deviation(np.empty(n), np.empty(n), np.empty(n), np.empty(2))
    status = Status()
    kernel.library.test_flank_deviation(
        ctypes.byref(given),
        ctypes.byref(profile),
        n,
        *map(_at, (teeth, sides, radii)),
        None if zones is None else _at(held),
        *map(_at, result),
        ctypes.byref(status),
    )
    if status.code != OK:
        raise _error(status)
    return result


def pitch_tolerances(
    kernel: Kernel, teeth: int, module: float, accuracy_class: int
) -> tuple[float, float]:
    """f_pT and F_pT [m].

    Raises
    ------
    KernelError
        If the standard has none.
    """
    single, total, status = _double(), _double(), Status()
    kernel.library.test_pitch_tolerances(
        teeth,
        _double(module),
        accuracy_class,
        ctypes.byref(single),
        ctypes.byref(total),
        ctypes.byref(status),
    )
    if status.code != OK:
        raise _error(status)
    return single.value, total.value


def pitch_error_sequence(
    kernel: Kernel, teeth: int, single: float, total: float, seed: int
) -> Floats:
    """Cumulative position deviation of every tooth [m]."""
    errors = np.empty(teeth)
    kernel.library.test_pitch_error_sequence(
        teeth, _double(single), _double(total), seed, _at(errors)
    )
    return errors


@dataclass
class Formula:
    """e(rho) of docs/deviations.md in mpmath, on the branch that a zone selects."""

    given: DeviationDescription
    profile: Profile

    def start(self, relief: ReliefDescription) -> mp.mpf:
        """Radius of curvature at which a relief starts."""
        r_b = mp.mpf(self.profile.base_radius)
        if relief.by_roll_angle:
            return r_b * mp.mpf(relief.start)
        return mp.sqrt((mp.mpf(relief.start) / 2) ** 2 - r_b**2)

    def e(self, rho: mp.mpf, tooth: int, side: int, zone: int) -> mp.mpf:
        """Material that the flank lacks [m]."""
        given, profile = self.given, self.profile
        low, high = mp.mpf(profile.rho_start), mp.mpf(profile.rho_tip)
        r_b, z = mp.mpf(profile.base_radius), profile.teeth
        e = mp.mpf(0)
        if zone != NONE:
            chosen, end = {ROOT: (given.root_relief, low), TIP: (given.tip_relief, high)}[zone]
            if chosen.amount > 0:
                border = self.start(chosen)
                power = 1 if chosen.shape == LINEAR else 2
                e += chosen.amount * ((rho - border) / (end - border)) ** power
        e += given.profile_crowning * ((2 * rho - low - high) / (high - low)) ** 2
        if given.n_pitch_errors:
            arc = mp.mpf(given.pitch_errors[tooth % z])
            e += side * arc * r_b / mp.mpf(profile.reference_radius)
        # outward normal of the flank, whose involute starts at `root` on the base circle
        root = 2 * mp.pi * tooth / z - side * mp.mpf(profile.tooth_angle) / 2
        beta = root + side * rho / r_b
        normal = (side * mp.sin(beta), -side * mp.cos(beta))
        centre = (mp.cos(given.runout_phase), mp.sin(given.runout_phase))
        e -= given.runout_amount * (normal[0] * centre[0] + normal[1] * centre[1])
        return e
