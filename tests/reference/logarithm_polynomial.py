"""Fit the polynomial of the logarithm: the coefficients of src/numerics/logarithm_terms.inc.

With s = (m - 1)/(m + 1) and z = s**2, ln m = s (2 + z P(z)), P(z) = 2/3 + 2 z/5 + ... Fitted in the
Chebyshev sense for sqrt(1/2) <= m <= sqrt(2). Printed are the coefficients and the largest error of
z P(z), which counts against 2.

Run it as ``python tests/reference/logarithm_polynomial.py`` (mpmath, a second).
"""

from __future__ import annotations

import mpmath as mp

TERMS = 7


def exact(z: mp.mpf) -> mp.mpf:
    """Return P(z)."""
    if z < mp.mpf(10) ** -40:
        return mp.mpf(2) / 3
    s = mp.sqrt(z)
    return (2 * mp.atanh(s) / s - 2) / z


def main() -> None:
    """Print the fit."""
    mp.mp.dps = 50
    largest = ((mp.sqrt(2) - 1) / (mp.sqrt(2) + 1)) ** 2 * mp.mpf("1.001")
    coefficients, error = mp.chebyfit(exact, [0, largest], TERMS, error=True)
    for coefficient in reversed(coefficients):
        print(mp.nstr(coefficient, 20))
    print("largest error", mp.nstr(error * largest, 2))


if __name__ == "__main__":
    main()
