"""Teeth that bend, from Python: what the kernel has of them for its tests."""

from __future__ import annotations

import ctypes
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from kernel.kernel import Floats, Integers, Kernel, _at, _floats

LANES = 8


class Contact(NamedTuple):
    """Forces per unit width with their derivatives to h, c and Lambda, and energies."""

    force: Floats
    d_h: Floats
    d_c: Floats
    d_length: Floats
    energy: Floats
    code: Integers


def compliant_force(
    kernel: Kernel, h: ArrayLike, length: ArrayLike, c: ArrayLike, e_star: ArrayLike
) -> Contact:
    """Johnson's contact in series with a body."""
    given = _floats(h, length, c, e_star)
    n = len(given[0])
    result = Contact(*np.empty((5, n)), np.empty(n, np.int32))
    kernel.library.test_compliant_force(n, *map(_at, given), *map(_at, result))
    return result


def compliant_lanes(
    kernel: Kernel, h: ArrayLike, length: ArrayLike, c: ArrayLike, e_star: float
) -> tuple[Floats, bool]:
    """Eight forces at once, and whether there is an answer."""
    given = _floats(h, length, c, np.zeros(LANES))
    force = np.empty(LANES)
    answer = kernel.library.test_compliant_lanes(
        *map(_at, given[:3]), ctypes.c_double(e_star), _at(force)
    )
    return force, bool(answer)


def compliant_penetration(
    kernel: Kernel, force: ArrayLike, length: ArrayLike, c: ArrayLike, e_star: ArrayLike
) -> tuple[Floats, Floats, Integers]:
    """Penetration under a force, its derivative, and the codes."""
    given = _floats(force, length, c, e_star)
    n = len(given[0])
    h, d_force, codes = np.empty(n), np.empty(n), np.empty(n, np.int32)
    kernel.library.test_compliant_penetration(n, *map(_at, given), *map(_at, (h, d_force, codes)))
    return h, d_force, codes
