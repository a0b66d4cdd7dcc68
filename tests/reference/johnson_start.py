"""Fit the start value of the Johnson force: the coefficients of src/formulas/johnson.inc.

With p = sqrt(2 excess), solve v - ln(1 + v) = p**2/2 for v > 0. The start value is

    v = p (a0 + a1 p + a2 p**2 + a3 p**3)/(1 + b1 p + b2 p**2)

fitted for the least largest relative error over 0 < p < 37.3 (x from 1e-301 to 1/e). Printed are
the coefficients to seven digits, their largest error, and what Fritsch's correction leaves of it in
exact arithmetic. Any coefficients of about this error would do.

Run it as ``python tests/reference/johnson_start.py`` (scipy and mpmath, a few seconds).
"""

from __future__ import annotations

import re
from pathlib import Path

import mpmath as mp
import numpy as np
from scipy.optimize import least_squares

LARGEST_P = 37.3
DEGREES = (3, 2)


def exact(p: np.ndarray) -> np.ndarray:
    """Return v(p) by Lambert's W in 40 digits."""
    with mp.workdps(40):
        return np.array(
            [float(-mp.lambertw(-mp.exp(-1 - mp.mpf(q) ** 2 / 2), -1).real - 1) for q in p]
        )


def rational(coefficients: np.ndarray, p: np.ndarray) -> np.ndarray:
    """Evaluate v/p."""
    split = DEGREES[0] + 1
    numerator = np.polynomial.polynomial.polyval(p, coefficients[:split])
    denominator = np.polynomial.polynomial.polyval(p, np.r_[1.0, coefficients[split:]])
    return numerator / denominator


def fit(p: np.ndarray, target: np.ndarray) -> np.ndarray:
    """Minimise the largest relative error of v/p: Lawson's weights, then rising power norms."""
    weight, denominator = np.ones_like(p), np.ones_like(p)
    best = np.inf
    for _ in range(60):
        columns = [p**k for k in range(DEGREES[0] + 1)]
        columns += [-target * p**k for k in range(1, DEGREES[1] + 1)]
        row = np.sqrt(weight) / denominator
        scaled = np.stack(columns, axis=1) * (row / target)[:, None]
        size = np.abs(scaled).max(axis=0)
        trial = np.linalg.lstsq(scaled / size, row)[0] / size
        denominator = np.polynomial.polynomial.polyval(p, np.r_[1.0, trial[DEGREES[0] + 1 :]])
        error = np.abs(rational(trial, p) / target - 1)
        if denominator.min() > 0 and error.max() < best:
            best, coefficients = error.max(), trial
        weight *= np.sqrt(error / error.max()) + 1e-3
        weight /= weight.max()
    start = coefficients
    for power in (1, 2, 4, 8, 12, 16, 24):
        largest = np.abs(rational(coefficients, p) / target - 1).max()

        def residual(factor: np.ndarray, power: int = power, largest: float = largest):
            error = rational(factor * start, p) / target - 1
            return np.sign(error) * np.abs(error / largest) ** power

        factor = least_squares(residual, coefficients / start, xtol=1e-15, ftol=1e-15).x
        if np.abs(rational(factor * start, p) / target - 1).max() < largest:
            coefficients = factor * start
    return coefficients


def corrected_error(coefficients: np.ndarray, p: float) -> mp.mpf:
    """Relative error of v after one correction, in exact arithmetic."""
    with mp.workdps(40):
        q = mp.mpf(p)
        excess = q**2 / 2
        truth = -mp.lambertw(-mp.exp(-1 - excess), -1).real - 1
        numerator = mp.polyval([mp.mpf(float(c)) for c in coefficients[3::-1]], q)
        denominator = mp.polyval([mp.mpf(float(c)) for c in coefficients[:3:-1]] + [1], q)
        v = q * numerator / denominator
        z = v - mp.log(1 + v) - excess
        r = 2 * v * (v - 2 * z / 3)
        v -= (1 + v) * z * (r - z) / (v * (r - 2 * z))
        return abs(v / truth - 1)


def in_use() -> np.ndarray:
    """Read the coefficients of src/formulas/johnson.inc."""
    file = Path(__file__).parents[2] / "src" / "formulas" / "johnson.inc"
    text = file.read_text(encoding="utf-8")
    lists = re.findall(r"parameter :: (?:num|den)\(.*\) = \[(.*)\]", text)
    return np.array([float(c) for c in re.findall(r"([\d.]+)_wp", " ".join(lists))])


def main() -> None:
    """Fit and print."""
    # dense near 0, where v changes from p to p**2/2, and at both ends, where the error peaks
    share = (1 - np.cos(np.pi * (np.arange(2000) + 0.5) / 2000)) / 2
    p = 0.3 * np.expm1(share * np.log1p(LARGEST_P / 0.3))
    target = exact(p) / p
    coefficients = np.array([float(f"{c:.7g}") for c in fit(p, target)])
    error = np.abs(rational(coefficients, p) / target - 1).max()
    remaining = max(corrected_error(coefficients, q) for q in p[::10])
    print("numerator  ", *coefficients[: DEGREES[0] + 1])
    print("denominator", 1.0, *coefficients[DEGREES[0] + 1 :])
    print(f"largest relative error {error:.2e}, after one correction {float(remaining):.1e}")
    used = in_use()
    error = np.abs(rational(used, p) / target - 1).max()
    remaining = max(corrected_error(used, q) for q in p[::10])
    print(
        f"in use: largest relative error {error:.2e}, after one correction {float(remaining):.1e}"
    )


if __name__ == "__main__":
    main()
