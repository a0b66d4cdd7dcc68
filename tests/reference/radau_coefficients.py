"""Radau IIA with seven stages: the tables of src/integrator/radau_coefficients.f90 come from here.

Everything follows from the nodes by collocation (Hairer & Wanner, Solving Ordinary Differential
Equations II, 2nd ed., IV.5 and IV.8), computed with 60 digits:

- nodes c: zeros of d^6/dx^6 (x^6 (x - 1)^7); A and b integrate the Lagrange polynomials;
- A^-1 T = T Lambda: one real eigenvalue and three pairs; the columns of T are the real
  eigenvector and, for a pair alpha + i beta with eigenvector u - i v, the vectors u and v, so
  that p + i q solves ((alpha + i beta)/h - J)(p + i q) = r;
- error estimate (IV.8, eq. 8.17-8.19, for s stages): the embedded formula of order 7 with weight
  gamma_0 = 1/gamma at the start of the step; e = (b^ - b) A^-1, here divided by gamma_0.

- the matrix from values at the nodes to the coefficients of the shifted Chebyshev polynomials;
- A in lanes: the integral of the polynomial through the values at the stages, up to each of them.

A lane is one of 8 reals: lanes 1 to 7 are the stages, lane 8 is the start of the step (node 0).
The transformed lanes are gamma, Re 1, Re 2, Re 3, nothing, Im 1, Im 2, Im 3.

Run it as ``python tests/reference/radau_coefficients.py``: it prints the Fortran tables.
"""

from __future__ import annotations

import itertools
from typing import Any, NamedTuple

import mpmath as mp

STAGES = 7
LANES = 8
DIGITS = 60
REAL = (0, 1, 2, 3)  # lanes of the real parts; the real system stands first
IMAGINARY = (4, 5, 6, 7)  # lane 4 belongs to the real system and stays 0


class Radau(NamedTuple):
    """All tables, as mpmath numbers."""

    node: list[Any]
    a: Any
    b: list[Any]
    to_stage: Any
    from_stage: Any
    shift_re: list[Any]
    shift_im: list[Any]
    error: list[Any]
    barycentric: list[Any]
    slope: Any
    chebyshev: Any
    integral: Any


def nodes() -> list[Any]:
    """Zeros of the 6th derivative of x^6 (x - 1)^7, ascending."""
    s = STAGES
    power = [mp.mpf(0)] * (2 * s)  # coefficients of x^(s-1) (x - 1)^s, lowest first
    for k in range(s + 1):
        power[s - 1 + k] = mp.binomial(s, k) * (-1) ** (s - k)
    for _ in range(s - 1):
        power = [i * power[i] for i in range(1, len(power))]

    def value(x: Any) -> Any:
        return mp.fsum(c * x**i for i, c in enumerate(power))

    grid = [mp.mpf(i) / 200 for i in range(200)]  # the last node, 1, is a simple zero at the end
    brackets = [pair for pair in itertools.pairwise(grid) if value(pair[0]) * value(pair[1]) < 0]
    return [*(mp.findroot(value, pair, solver="anderson") for pair in brackets), mp.mpf(1)]


def lagrange(points: list[Any], k: int) -> list[Any]:
    """Coefficients, lowest first, of the Lagrange polynomial of one of the points."""
    result = [mp.mpf(1)]
    for m, point in enumerate(points):
        if m == k:
            continue
        shifted = [mp.mpf(0), *result]
        for i, value in enumerate(result):
            shifted[i] -= point * value
        result = [value / (points[k] - point) for value in shifted]
    return result


def integral(coefficients: list[Any], x: Any) -> Any:
    """Integrate a polynomial from 0 to x."""
    return mp.fsum(value * x ** (i + 1) / (i + 1) for i, value in enumerate(coefficients))


def derivative(coefficients: list[Any], x: Any) -> Any:
    """Differentiate a polynomial at x."""
    terms = list(enumerate(coefficients))[1:]
    return mp.fsum(i * value * x ** (i - 1) for i, value in terms)


def transformation(a: Any) -> tuple[Any, list[Any], list[Any]]:
    """Return T with a column for each transformed lane but the empty one, and the eigenvalues."""
    values, vectors = mp.eig(a**-1)
    order = sorted(range(STAGES), key=lambda i: mp.im(values[i]))
    chosen = [i for i in order if mp.im(values[i]) > -(mp.mpf(10) ** (-DIGITS // 2))]
    columns_re, columns_im, shift_re, shift_im = [], [], [], []
    for lane, i in enumerate(chosen):
        vector = [vectors[row, i] for row in range(STAGES)]
        largest = max(vector, key=abs)  # its value becomes 1: T is of order 1 and unique
        vector = [value / largest for value in vector]
        columns_re.append([mp.re(value) for value in vector])
        columns_im.append([-mp.im(value) for value in vector])
        shift_re.append(mp.re(values[i]))
        shift_im.append(mp.im(values[i]) if lane else mp.mpf(0))
    return mp.matrix([*columns_re, *columns_im[1:]]).T, shift_re, shift_im


def radau() -> Radau:
    """Compute every table with 60 digits."""
    with mp.workdps(DIGITS):
        s = STAGES
        c = nodes()
        basis = [lagrange(c, k) for k in range(s)]
        a = mp.matrix([[integral(basis[k], c[i]) for k in range(s)] for i in range(s)])
        b = [integral(basis[k], mp.mpf(1)) for k in range(s)]
        t, shift_re, shift_im = transformation(a)
        inverse = t**-1
        lanes = [*REAL, *IMAGINARY[1:]]
        to_stage, from_stage = mp.zeros(LANES), mp.zeros(LANES)
        for (column, lane), row in itertools.product(enumerate(lanes), range(s)):
            to_stage[row, lane] = t[row, column]
            from_stage[lane, row] = inverse[column, row]
        gamma_0 = 1 / shift_re[0]
        vandermonde = mp.matrix([[c[i] ** k for i in range(s)] for k in range(s)])
        right = mp.matrix([mp.mpf(1) / (k + 1) - (gamma_0 if k == 0 else 0) for k in range(s)])
        embedded = mp.lu_solve(vandermonde, right)
        e = (embedded - mp.matrix(b)).T * a**-1
        node = [*c, mp.mpf(0)]
        full = [lagrange(node, k) for k in range(LANES)]
        slope = mp.matrix(
            [[derivative(full[k], node[i]) for k in range(LANES)] for i in range(LANES)]
        )
        integral_to = mp.zeros(LANES)
        for i, k in itertools.product(range(s), range(s)):
            integral_to[i, k] = a[i, k]
        points = [[mp.chebyt(k, 2 * x - 1) for k in range(LANES)] for x in node]
        return Radau(
            node=node,
            a=a,
            b=b,
            to_stage=to_stage,
            from_stage=from_stage,
            shift_re=shift_re,
            shift_im=shift_im,
            error=[*(e[k] / gamma_0 for k in range(s)), mp.mpf(0)],
            barycentric=[full[k][-1] for k in range(LANES)],
            slope=slope,
            chebyshev=mp.matrix(points) ** -1,
            integral=integral_to,
        )


def fortran(name: str, values: list[Any], shape: str, meaning: str) -> str:
    """Write one table as a Fortran constant, 4 numbers a line."""
    words = [mp.nstr(value, 20, min_fixed=-3, max_fixed=5) + "_wp" for value in values]
    lines = [", ".join(words[i : i + 4]) for i in range(0, len(words), 4)]
    body = ", &\n      ".join(lines)
    head = f"   !> {meaning}\n   real(wp), parameter :: {name}({shape}) = "
    if "," in shape:
        return f"{head}reshape([ &\n      {body}], [{shape}])\n"
    return f"{head}[ &\n      {body}]\n"


def main() -> None:
    """Print the tables."""
    tables = radau()
    by_columns = {
        name: [getattr(tables, name)[i, k] for k in range(LANES) for i in range(LANES)]
        for name in ("to_stage", "from_stage", "slope", "chebyshev", "integral")
    }
    print(fortran("node", tables.node, "lanes", "Nodes in units of the step."))
    print(fortran("to_stage", by_columns["to_stage"], "lanes, lanes", "T."))
    print(fortran("from_stage", by_columns["from_stage"], "lanes, lanes", "Inverse of T."))
    print(fortran("shift_re", tables.shift_re, "n_systems", "Real parts of the eigenvalues."))
    print(fortran("shift_im", tables.shift_im, "n_systems", "Imaginary parts."))
    print(fortran("error_weight", tables.error, "lanes", "Error estimate."))
    print(fortran("barycentric", tables.barycentric, "lanes", "1/prod(node_k - node_m)."))
    print(fortran("slope_at_node", by_columns["slope"], "lanes, lanes", "Derivatives."))
    print(fortran("to_chebyshev", by_columns["chebyshev"], "lanes, lanes", "Coefficients."))
    print(fortran("integral_to_node", by_columns["integral"], "lanes, lanes", "A."))


if __name__ == "__main__":
    main()
