"""Tip edge on the flank of its mate, against the distance of the curves with 60 digits."""

from __future__ import annotations

from collections.abc import Callable

import mpmath as mp
import numpy as np
import pytest

from kernel.compliant import Edge, edge_end, edge_geometry
from kernel.kernel import Floats, Kernel

# 50/50, module 3, no shift: standard rack, centre distance 150 mm
R_B = 75e-3 * np.cos(np.radians(20))
RHO_TIP = np.sqrt(78e-3**2 - R_B**2)
RHO = 150e-3 * np.sin(np.radians(20))
PAIR = Edge(R_B, R_B, RHO_TIP)

# a pinion's edge on a gear, the gear's on the pinion, rounded edges
EDGES = {
    "50/50": (PAIR, RHO),
    "50/50 rounded": (PAIR._replace(rounding=0.3e-3), RHO),
    "pinion on gear": (Edge(26.8e-3, 47.9e-3, 17.6e-3), 31.07e-3),
    "gear on pinion": (Edge(47.9e-3, 26.8e-3, 24.1e-3, 0.2e-3), 31.07e-3),
    # from 2.8 mm on, the edge is beyond the foot of the line on the mate's base circle
    "near the base circle": (Edge(80.2e-3, 32.1e-3, 45.2e-3), 48.1e-3),
}
every_edge = pytest.mark.parametrize(("edge", "rho"), EDGES.values(), ids=EDGES)
X = np.concatenate([-np.logspace(-4, -8, 9), np.logspace(-12, np.log10(5e-3), 60)])


@pytest.fixture(autouse=True)
def _digits():
    with mp.workdps(60):
        yield


def tangent(edge: Edge, x: mp.mpf, rho: mp.mpf) -> tuple[mp.mpf, mp.mpf]:
    """Length from A's base circle to the centre of the rounding, and angle, by plane geometry.

    A's axis is the origin, (r_A, 0) the contact of the line of action with its base circle,
    e = (0, 1).
    """
    r, r_a, end, r_t = map(mp.mpf, edge)
    axle = mp.matrix([r_a + r, rho])
    angle = x / r
    arm = (-r, -(end - r_t))
    m = (
        axle[0] + mp.cos(angle) * arm[0] - mp.sin(angle) * arm[1],
        axle[1] + mp.sin(angle) * arm[0] + mp.cos(angle) * arm[1],
    )
    length = mp.sqrt(m[0] ** 2 + m[1] ** 2 - r_a**2)
    return length, mp.atan2(m[1], m[0]) - mp.atan2(length, r_a)


def gap(edge: Edge, x: float, rho: float) -> mp.mpf:
    x, rho = mp.mpf(x), mp.mpf(rho)
    length, angle = tangent(edge, x, rho)
    l_0 = rho - (mp.mpf(edge.rho_end) - mp.mpf(edge.rounding))
    return length - l_0 + mp.mpf(edge.r_mate) * angle + x


def foot(edge: Edge, x: float, rho: float) -> mp.mpf:
    return mp.mpf(edge.r_mate) * tangent(edge, mp.mpf(x), mp.mpf(rho))[1]


def worst(values: Floats, exact: Callable[[float], mp.mpf]) -> float:
    return max(
        float(abs(mp.mpf(float(v)) / exact(float(x)) - 1)) for v, x in zip(values, X, strict=True)
    )


@every_edge
def test_gap_and_slopes_keep_their_digits(kernel: Kernel, edge: Edge, rho: float):
    """S is 1e-27 m at the smallest x, with lengths of 1e-1 m."""
    at = edge_geometry(kernel, edge, X, rho)
    assert at.exists.all()
    assert worst(at.gap, lambda x: gap(edge, x, rho)) < 1e-13
    assert worst(at.d_x, lambda x: mp.diff(lambda y: gap(edge, y, rho), x)) < 1e-13
    assert worst(at.d_xx, lambda x: mp.diff(lambda y: gap(edge, y, rho), x, 2)) < 1e-13
    assert worst(at.d_rho, lambda x: mp.diff(lambda y: gap(edge, x, y), rho)) < 1e-13
    assert worst(at.foot, lambda x: foot(edge, x, rho)) < 1e-13


@every_edge
def test_other_derivatives_are_those_of_gap_and_foot(kernel: Kernel, edge: Edge, rho: float):
    at = edge_geometry(kernel, edge, X, rho)

    def of(function: Callable[..., mp.mpf], orders: tuple[int, int]) -> Callable[[float], mp.mpf]:
        return lambda x: mp.diff(lambda y, z: function(edge, y, z), (x, rho), orders)

    assert worst(at.d_x_rho, of(gap, (1, 1))) < 1e-12
    assert worst(at.d_rho_rho, of(gap, (0, 2))) < 1e-12
    assert worst(at.foot_x, of(foot, (1, 0))) < 1e-12
    assert worst(at.foot_rho, of(foot, (0, 1))) < 1e-12
    assert worst(at.foot_xx, of(foot, (2, 0))) < 1e-11
    assert worst(at.foot_x_rho, of(foot, (1, 1))) < 1e-12
    assert worst(at.foot_rho_rho, of(foot, (0, 2))) < 1e-12


def test_gap_of_equal_wheels_has_its_known_values(kernel: Kernel):
    """50/50, module 3 mm: results of an independent program, and S''(0) in closed form."""
    at = edge_geometry(kernel, PAIR, [0.0, 1.25e-3, 3e-3], RHO)
    assert pytest.approx(51.3030214988503e-3, rel=1e-13) == RHO
    assert at.d_xx[0] == pytest.approx(19.3051027, rel=1e-8)
    assert at.gap[1] == pytest.approx(15.7718381767e-6, rel=1e-11)
    assert at.gap[2] == pytest.approx(96.3317856239e-6, rel=1e-11)
    assert np.degrees(-edge_geometry(kernel, PAIR, 1e-3, RHO).turn[0]) == pytest.approx(
        1.6, abs=0.1
    )


@every_edge
def test_edge_begins_with_the_curvature_of_the_closed_form(kernel: Kernel, edge: Edge, rho: float):
    at = edge_geometry(kernel, edge, 0.0, rho)
    rho_mate = rho - edge.rho_end
    closed = (edge.rho_end - edge.rounding) * rho / ((rho_mate + edge.rounding) * edge.r_b**2)
    assert at.gap[0] == at.d_x[0] == at.turn[0] == 0
    assert at.d_xx[0] == pytest.approx(closed, rel=1e-14)


@every_edge
def test_friction_arm_is_that_of_the_edge(kernel: Kernel, edge: Edge, rho: float):
    """Its distance from the wheel's axis along the force: sqrt(|P - O|^2 - r_b^2 (1 - S')^2)."""
    for x in (0.0, 1e-4, 1e-3, 3e-3):
        at = edge_geometry(kernel, edge, x, rho)
        r, _, end, r_t = map(mp.mpf, edge)
        _, delta = tangent(edge, mp.mpf(x), mp.mpf(rho))
        angle = mp.mpf(x) / r
        arm = (-r, -(end - r_t))
        p = (
            mp.cos(angle) * arm[0] - mp.sin(angle) * arm[1] + r_t * mp.sin(delta),
            mp.sin(angle) * arm[0] + mp.cos(angle) * arm[1] - r_t * mp.cos(delta),
        )
        exact = mp.sqrt(p[0] ** 2 + p[1] ** 2 - (r * (1 - mp.mpf(float(at.d_x[0])))) ** 2)
        assert float(at.arm[0] / exact) == pytest.approx(1, abs=1e-13)
    assert edge_geometry(kernel, edge, 0.0, rho).arm[0] == pytest.approx(edge.rho_end, rel=1e-15)


@every_edge
@pytest.mark.parametrize("slope", [1e-6, 1e-4, 5e-3, 0.02])
def test_edge_takes_over_from_a_relief_where_slopes_are_equal(
    kernel: Kernel, edge: Edge, rho: float, slope: float
):
    x = edge_end(kernel, edge, slope, rho)
    assert x > 0
    assert edge_geometry(kernel, edge, x, rho).d_x[0] == pytest.approx(slope, rel=1e-13)


def test_edge_takes_over_at_once_without_relief(kernel: Kernel):
    assert edge_end(kernel, PAIR, 0.0, RHO) == edge_end(kernel, PAIR, -1e-3, RHO) == 0


def test_edge_inside_the_mates_base_circle_touches_nothing(kernel: Kernel):
    """The mate has no involute there, where S continues to x < 0; beyond the end no edge enters."""
    edge = Edge(26.8e-3, 47.9e-3, 17.6e-3)
    assert not edge_geometry(kernel, edge, -1e-3, 17.7e-3).exists[0]
    assert edge_geometry(kernel, edge, X[X > 0], 17.7e-3).exists.all()
