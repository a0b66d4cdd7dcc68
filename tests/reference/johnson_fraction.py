"""Fit the Johnson force's fraction: the coefficients of src/laws/johnson.f90.

With p = sqrt(2 excess), solve v - ln(1 + v) = p**2/2 for v > 0. Fitted is

    v = p (1 + n1 p + ... + n11 p**11)/(1 + d1 p + ... + d10 p**10)

for the least largest relative error over 0 < p < 37.4 (x from 1e-304 to 1/e), by weighted least
squares in 50 digits whose weights follow the errors (C. L. Lawson 1961, in the form of J. R. Rice
and K. H. Usow, Mathematics of Computation 22 (1968) 118). Printed are the coefficients to 18
digits, their largest error, and that of the coefficients in use.

Run it as ``python tests/reference/johnson_fraction.py`` (mpmath, a minute or two).
"""

from __future__ import annotations

import re
from pathlib import Path

from mpmath import cos, log, lu_solve, matrix, mp, mpf, nstr, pi

LARGEST_P = mpf("37.4")
ABOVE, BELOW = 11, 10
NODES, TURNS = 12 * (ABOVE + BELOW), 25

Terms = list[mpf]


def ratio(p: mpf) -> mpf:
    """Return v(p)/p by Newton's method."""
    goal = 1 + p**2 / 2
    w = 1 + p + p**2 / 3 if p < 2 else goal + log(goal) + 1
    for _ in range(200):
        step = (w - log(w) - goal) / (1 - 1 / w)
        w -= step
        if abs(step) < mpf(10) ** (5 - mp.dps) * w:
            break
    return (w - 1) / p


def value(terms: Terms, p: mpf) -> mpf:
    """Evaluate 1 + terms[0] p + terms[1] p**2 + ..."""
    total = mpf(0)
    for term in reversed(terms):
        total = (total + term) * p
    return 1 + total


def error_at(above: Terms, below: Terms, p: mpf, exact: mpf) -> mpf:
    """Relative error of the fraction."""
    return abs(value(above, p) / value(below, p) / exact - 1)


def solve(nodes: Terms, exact: Terms, weights: Terms) -> tuple[Terms, Terms]:
    """Weighted least squares of above - exact*below = 0, p in units of its largest value."""
    size = ABOVE + BELOW
    left, right = matrix(size, size), matrix(size, 1)
    for p, v, weight in zip(nodes, exact, weights, strict=True):
        x = p / LARGEST_P
        row = [x**k for k in range(1, ABOVE + 1)] + [-v * x**k for k in range(1, BELOW + 1)]
        for i in range(size):
            right[i] += weight * row[i] * (v - 1)
            for j in range(size):
                left[i, j] += weight * row[i] * row[j]
    found = lu_solve(left, right)
    above = [found[k] / LARGEST_P ** (k + 1) for k in range(ABOVE)]
    return above, [found[ABOVE + k] / LARGEST_P ** (k + 1) for k in range(BELOW)]


def fit() -> tuple[mpf, Terms, Terms]:
    """Return the largest error at the nodes, and the coefficients above and below."""
    # dense near 0, where v changes from p to p**2/2
    nodes = [LARGEST_P * ((1 + cos(pi * (2 * k + 1) / (2 * NODES))) / 2) ** 2 for k in range(NODES)]
    exact = [ratio(p) for p in nodes]
    shares = [mpf(1)] * NODES
    below: Terms = []
    best = None
    for _ in range(TURNS):
        sizes = [v * value(below, p) for p, v in zip(nodes, exact, strict=True)]
        weights = [share / size**2 for share, size in zip(shares, sizes, strict=True)]
        above, below = solve(nodes, exact, weights)
        errors = [error_at(above, below, p, v) for p, v in zip(nodes, exact, strict=True)]
        largest = max(errors)
        if best is None or largest < best[0]:
            best = largest, above, below
        shares = [
            share * error / largest + mpf(10) ** -30
            for share, error in zip(shares, errors, strict=True)
        ]
        shares = [share / sum(shares) * NODES for share in shares]
    assert best is not None
    return best


def in_use() -> tuple[Terms, Terms]:
    """Read the coefficients of src/laws/johnson.f90."""
    file = Path(__file__).parents[2] / "src" / "laws" / "johnson.f90"
    text = file.read_text(encoding="utf-8")
    lists = re.findall(r"parameter :: [nd]\(\d+\) = \[(.*?)\]", text, re.DOTALL)
    above, below = ([mpf(c) for c in re.findall(r"([\d.e+-]+)_wp", one)] for one in lists)
    return above, below


def main() -> None:
    """Fit and print."""
    mp.dps = 50
    largest, above, below = fit()
    for name, terms in (("above", above), ("below", below)):
        print(name, *(nstr(term, 18, min_fixed=0, max_fixed=0) for term in terms))
    print("largest relative error", nstr(largest, 3))
    nodes = [LARGEST_P * (mpf(k) / 1000) ** 3 for k in range(1, 1001)]
    used = in_use()
    largest = max(error_at(*used, p, ratio(p)) for p in nodes)
    print("in use: largest relative error", nstr(largest, 3))


if __name__ == "__main__":
    main()
