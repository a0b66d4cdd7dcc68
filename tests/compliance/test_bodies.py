"""Spectral elements on bodies whose displacements are known: a patch, a ring, a disc."""

from __future__ import annotations

import numpy as np
import pytest

from compliance.bodies import Body, Curve, lobatto, straight
from kernel.kernel import Floats, Kernel

NU = 0.3
SQUARE = [(0, 0), (2, 0), (2, 2), (0, 2)]


def arc(radius: float, start: float, end: float) -> Curve:
    """Arc round the origin between two angles."""

    def at(t: Floats) -> Floats:
        angle = start + t * (end - start)
        return radius * np.stack([np.cos(angle), np.sin(angle)], axis=-1)

    return at


@pytest.mark.parametrize("p", [4, 5, 8, 12])
def test_rule_is_exact_to_its_degree(kernel: Kernel, p: int) -> None:
    """Gauss and Lobatto's weights integrate degree 2p-1, the matrix differentiates degree p."""
    x, w, d = lobatto(kernel, p)
    for degree in range(2 * p):
        exact = 2 / (degree + 1) if degree % 2 == 0 else 0.0
        assert w @ x**degree == pytest.approx(exact, abs=1e-14)
    for degree in range(1, p + 1):
        # differences of neighbouring values over distances of 1/p^2 round
        assert d @ x**degree == pytest.approx(degree * x ** (degree - 1), abs=1e-14 * p**3)


@pytest.mark.parametrize("stress", [False, True])
def test_patch_of_curved_elements_answers_a_constant_strain_with_its_constant_stress(
    kernel: Kernel, stress: bool
) -> None:
    """Nothing pulls at inner nodes, and the work is that of Hooke's law over the area."""
    body = Body(kernel, 6)

    def wavy(a: Floats, b: Floats, height: float) -> Curve:
        across = np.array([b[1] - a[1], a[0] - b[0]])
        return lambda t: straight(a, b)(t) + height * (t * (1 - t))[:, None] * across

    corners = [np.array(c, float) for c in ((0, 0), (2, 0.3), (2.2, 1.7), (-0.2, 1.4))]
    curves = [
        wavy(corners[0], corners[1], 0.3),
        wavy(corners[1], corners[2], -0.4),
        wavy(corners[3], corners[2], 0.2),
        wavy(corners[0], corners[3], 0.25),
    ]
    body.patch(curves, 3, 2, 1)
    body.groups = [1, 2, 3, 1, 2, 3]
    n = body.nodes()[1]
    every = np.arange(2 * n)
    k = body.condensed([], every, np.empty((0, 2 * n)), nu=NU, stress=stress)
    at = body.points()
    strain = np.array([[0.7, 0.4], [-0.1, -0.5]])
    force = (k @ (at @ strain.T).ravel()).reshape(-1, 2)
    on_rim = np.zeros(n, bool)
    sides = body.nodes()[0]
    for e, (i, j) in enumerate((i, j) for j in range(2) for i in range(3)):
        for side, outer in enumerate((j == 0, i == 2, j == 1, i == 0)):
            if outer:
                on_rim[sides[e, side]] = True
    assert np.abs(force[~on_rim]).max() < 1e-13
    # the stress times the mean of x over the rim: sum of x f = area times stress
    e, shear = strain[[0, 1], [0, 1]], strain[0, 1] + strain[1, 0]
    factor = 1 / (1 - NU**2) if stress else 1 / ((1 + NU) * (1 - 2 * NU))
    other = (1, NU) if stress else (1 - NU, NU)
    sxx, syy = factor * (other[0] * e + other[1] * e[::-1])
    txy = shear / (2 * (1 + NU))
    moment = at.T @ force
    area = 0.0
    _, w, d = lobatto(kernel, 6)
    for e_sides in body.sides:
        for side, sign in ((0, 1), (1, 1), (2, -1), (3, -1)):
            along = d @ e_sides[side]
            area += (
                sign
                * 0.5
                * w
                @ (e_sides[side][:, 0] * along[:, 1] - e_sides[side][:, 1] * along[:, 0])
            )
    assert moment == pytest.approx(area * np.array([[sxx, txy], [txy, syy]]), rel=1e-11)


def test_ring_held_inside_twists_under_torque_as_its_closed_form(kernel: Kernel) -> None:
    """T/(4 pi G) (1/r_h^2 - 1/r^2), by a quarter whose ends turn alike."""
    hub, rim = 1.0, 2.5
    body = Body(kernel, 10)
    for ring in range(4):
        low, high = (hub * (rim / hub) ** (f / 4) for f in (3 - ring, 4 - ring))
        radial = [straight(*(r * np.array(to) for r in (low, high))) for to in ((1, 0), (0, 1))]
        arcs = [arc(r, 0, np.pi / 2) for r in (low, high)]
        body.patch([radial[0], arcs[1], radial[1], arcs[0]], 1, 4, ring + 1)
    at = body.points()
    radius = np.hypot(*at.T)
    # antisymmetric: on both straight ends there is no radial displacement
    ends = np.concatenate(
        [2 * np.flatnonzero(at[:, 1] < 1e-12), 2 * np.flatnonzero(at[:, 0] < 1e-12) + 1]
    )
    held = np.flatnonzero(radius < hub + 1e-9)
    _, w, _ = lobatto(kernel, 10)
    load = np.zeros(len(at) * 2)
    sides, _ = body.nodes()
    for e in range(4):  # a tangential traction of 1 on the rim
        nodes = sides[e, 1]
        share = w * rim * np.pi / 16
        load[2 * nodes] -= share * at[nodes, 1] / rim
        load[2 * nodes + 1] += share * at[nodes, 0] / rim
    fixed = np.concatenate([ends, 2 * held, 2 * held + 1])
    energy = -body.condensed(fixed, [], load, nu=NU)[0, 0]
    torque = 2 * np.pi * rim**2
    shear = 1 / (2 * (1 + NU))
    twist = torque / (4 * np.pi * shear) * (1 / hub**2 - 1 / rim**2)
    assert energy == pytest.approx(torque * twist / 4, rel=1e-10)


def disc(kernel: Kernel, p: int, n: int, w: float) -> float:
    """E c of a disc of radius 1 that is pressed across its diameter, by a quarter of it."""
    body = Body(kernel, p)
    # the load's end lies at (1, 0): patches come closer to it
    inner, split = 0.5, np.pi / 5
    o, a, b = np.zeros(2), np.array([inner, 0]), np.array([0, inner])
    c = 0.45 * np.array([1.0, 1.0])
    tip = arc(1, 0, split)
    body.patch([straight(o, a), straight(a, c), straight(b, c), straight(o, b)], n, n, 1)
    rest = [
        straight(a, np.array([1.0, 0])),
        tip,
        straight(c, tip(np.array([1.0]))[0]),
        straight(a, c),
    ]
    body.patch(rest, n, n, 1)
    far = arc(1, np.pi / 2, split)
    rest = [
        straight(b, c),
        straight(c, far(np.array([1.0]))[0]),
        far,
        straight(b, np.array([0, 1.0])),
    ]
    body.patch(rest, n, n, 1)
    body.groups = list(range(1, len(body.groups) + 1))
    at = body.points()
    sides, _ = body.nodes()
    fixed = np.concatenate(
        [2 * np.flatnonzero(at[:, 1] < 1e-12) + 1, 2 * np.flatnonzero(at[:, 0] < 1e-12)]
    )
    x, _, _ = lobatto(kernel, p)
    gauss, weights = np.polynomial.legendre.leggauss(14)
    loads = np.zeros((2, 2 * len(at)))
    for row, half in enumerate((w, w / np.sqrt(2))):
        for e in range(n * n, 2 * n * n):
            nodes = sides[e, 1]
            if np.hypot(*at[nodes].T).min() < 1 - 1e-12:
                continue
            angle = np.arctan2(at[nodes, 1], at[nodes, 0])
            low, high = angle[0], min(angle[-1], half)
            if high <= low:
                continue
            s = low + (high - low) * (1 + gauss) / 2
            force = 35 / (32 * half) * (1 - (s / half) ** 2) ** 3 * weights * (high - low) / 2
            local = 2 * (s - angle[0]) / (angle[-1] - angle[0]) - 1
            values = np.array(
                [np.prod([(local - y) / (z - y) for y in x if y != z], axis=0) for z in x]
            )
            np.add.at(loads[row], 2 * nodes, -values @ (force * np.cos(s)))
            np.add.at(loads[row], 2 * nodes + 1, -values @ (force * np.sin(s)))
    wide, narrow = -2 * np.diag(body.condensed(fixed, [], loads, nu=NU))
    numbers = (wide, narrow, w, 1.0, NU)
    return float(kernel.library.test_finish(*map(float, numbers)))


def test_disc_pressed_across_its_diameter_lacks_nothing_of_johnsons_cylinder(
    kernel: Kernel,
) -> None:
    """C is 0, the closer the finer the elements."""
    coarse, fine = disc(kernel, 8, 3, 0.12), disc(kernel, 12, 5, 0.12)
    assert abs(coarse) < 1e-3
    # what is left is the fourth power of the width, beside 1
    assert abs(fine) < min(2e-5, abs(coarse))


@pytest.mark.parametrize("p", [4, 8])
def test_element_that_folds_gives_no_number(kernel: Kernel, p: int) -> None:
    """The second of two, a corner of which points inwards; both are fine where it points out.

    At 1 the angle there is flat: just below, the map folds at that corner alone.
    """
    for inner, folds in ((1.5, False), (0.99, True), (0.2, True)):
        body = Body(kernel, p)
        for shift in ((-3.0, -3.0), (0.0, 0.0)):
            at = [(0, 0), (2, 0), (inner, inner), (0, 2)] if shift[0] == 0 else SQUARE
            a, b, c, d = (np.array(corner, float) + shift for corner in at)
            body.patch([straight(a, b), straight(b, c), straight(d, c), straight(a, d)], 1, 1, 1)
        n = 2 * body.nodes()[1]
        if folds:
            with pytest.raises(AssertionError, match="element 2"):
                body.condensed([], np.arange(n), np.empty((0, n)))
        else:
            assert np.isfinite(body.condensed([], np.arange(n), np.empty((0, n)))).all()
