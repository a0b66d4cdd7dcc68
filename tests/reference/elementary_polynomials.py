"""Fit the polynomials of sine, cosine, exponential, arc tangent: those of src/numerics/*.inc.

    sin r = r + r z S(z),  cos r = 1 - z/2 + z**2 C(z),  z = r**2 <= (pi/4)**2
    exp r = 1 + r + r**2/2 + r**3 E(r),  |r| <= ln(2)/2
    arctan u = u + u z A(z),  z = u**2 <= tan(pi/8)**2

Fitted in the Chebyshev sense. Printed are the coefficients and the largest error: of z S(z) and
z**2 C(z), which count against 1 and 0.7, and of r**2 E(r) and z A(z), which count against 1.

Run it as ``python tests/reference/elementary_polynomials.py`` (mpmath, a second).
"""

from __future__ import annotations

from collections.abc import Callable

import mpmath as mp

BEYOND = mp.mpf("1.001")


def sine(z: mp.mpf) -> mp.mpf:
    """Return S(z)."""
    if z < mp.mpf(10) ** -25:
        return -mp.mpf(1) / 6
    return (mp.sin(mp.sqrt(z)) / mp.sqrt(z) - 1) / z


def cosine(z: mp.mpf) -> mp.mpf:
    """Return C(z)."""
    if z < mp.mpf(10) ** -15:
        return mp.mpf(1) / 24
    return (mp.cos(mp.sqrt(z)) - 1 + z / 2) / z**2


def exponential(r: mp.mpf) -> mp.mpf:
    """Return E(r)."""
    if abs(r) < mp.mpf(10) ** -12:
        return mp.mpf(1) / 6 + r / 24
    return (mp.expm1(r) - r - r**2 / 2) / r**3


def arctangent(z: mp.mpf) -> mp.mpf:
    """Return A(z)."""
    if z < mp.mpf(10) ** -25:
        return -mp.mpf(1) / 3
    return (mp.atan(mp.sqrt(z)) / mp.sqrt(z) - 1) / z


def fit(f: Callable[[mp.mpf], mp.mpf], ends: list[mp.mpf], terms: int, weight: mp.mpf) -> None:
    """Print coefficients, from the lowest power, and the error."""
    coefficients, error = mp.chebyfit(f, ends, terms, error=True)
    print(f.__name__)
    for coefficient in reversed(coefficients):
        print("  ", mp.nstr(coefficient, 20))
    print("   largest error", mp.nstr(error * weight, 2))


def main() -> None:
    """Print the fits."""
    mp.mp.dps = 60
    z = (mp.pi / 4 * BEYOND) ** 2
    r = mp.log(2) / 2 * BEYOND
    fit(sine, [mp.mpf(0), z], 6, z)
    fit(cosine, [mp.mpf(0), z], 6, z**2)
    fit(exponential, [-r, r], 10, r**2)
    u = (mp.tan(mp.pi / 8) * BEYOND) ** 2
    fit(arctangent, [mp.mpf(0), u], 11, u)


if __name__ == "__main__":
    main()
