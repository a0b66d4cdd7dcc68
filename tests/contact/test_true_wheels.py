"""Quasi-static meshes with wheels of finite elements, against an independent program.

That program has its own elements, potential and solver. Pairs without backlash, sharp tips, wheels
held at their bores, plane strain.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import pytest
from scipy.optimize import brentq

from compliance.influence import influence
from contact.meshes import EDGE_B, E, involute_mesh, start_of_path
from kernel.compliant import Curve, Mesh, true_mesh
from kernel.gears import gear
from kernel.kernel import Kernel

MODULE = 3e-3
POSITIONS = 720  # per pitch


class Known(NamedTuple):
    """Results of the other program: um, N/(mm um), base pitches."""

    mean: float
    peak_to_peak: float
    secant: tuple[float, float, float]  # of the mesh: least, mean, largest
    tangent: tuple[float, float, float]
    first: float  # onset of load on the edge of pair 0, before its start
    at_start: tuple[float, float]  # h and the share of pair 0
    halfway: tuple[float, float]


# teeth, profile shifts, bores, width [m], load [N/mm]
PAIRS = {
    "50/50 at 50 N/mm": (
        ((50, 0.0, 40e-3), (50, 0.0, 40e-3), 20e-3, 50),
        Known(
            *(3.783446, 1.16221, (211.7222, 266.7972, 280.8230), (218.1875, 275.1643, 286.4514)),
            *(-0.059493, (3.655749, 0.403217), (3.569599, 0.530351)),
        ),
    ),
    "50/50 at 150 N/mm": (
        ((50, 0.0, 40e-3), (50, 0.0, 40e-3), 20e-3, 150),
        Known(
            *(10.922248, 3.24290, (219.0410, 276.1617, 286.9943), (225.9011, 286.3582, 292.8193)),
            *(-0.098846, (10.727602, 0.398630), (10.478084, 0.531884)),
        ),
    ),
    "19/34 at 150 N/mm": (
        ((19, 0.4, 25e-3), (34, 0.1, 40e-3), 24e-3, 150),
        Known(
            *(9.004218, 3.49702, (325.5053, 411.0128, 476.0199), (338.2282, 430.0609, 489.5356)),
            *(-0.055434, (7.734273, 0.399276), (7.812351, 0.583721)),
        ),
    ),
}
Wheel = tuple[int, float, float]


def real_mesh(kernel: Kernel, a: Wheel, b: Wheel, width: float) -> tuple[Mesh, list]:
    """The pair at the zero-backlash centre distance, and samples of both wheels."""
    mesh = involute_mesh((a[0], b[0]), MODULE, width=width)
    rack = np.radians(20)

    def involute(alpha: float) -> float:
        return np.tan(alpha) - alpha

    turn = involute(rack) + 2 * (a[1] + b[1]) / (a[0] + b[0]) * np.tan(rack)
    mesh.line = (mesh.r_b[0] + mesh.r_b[1]) * np.tan(brentq(lambda x: involute(x) - turn, 0.2, 0.8))
    found = []
    for w, (teeth, shift, bore) in enumerate((a, b)):
        geometry = gear(kernel, teeth, MODULE, profile_shift=shift, bore=bore)
        mesh.ends[w] = np.sqrt(geometry.tip_radius**2 - mesh.r_b[w] ** 2)
        found.append(influence(kernel, geometry, bore / 2))
    samples = [np.stack([getattr(f, name) for f in found]) for name in ("rho", "own", "samples")]
    return mesh, samples


@pytest.fixture(scope="module", params=PAIRS.values(), ids=PAIRS)
def pair(request: pytest.FixtureRequest, kernel: Kernel):
    """Function of the positions in base pitches, force over the width, and known results."""
    (a, b, width, load), known = request.param
    mesh, samples = real_mesh(kernel, a, b, width)
    force = load * 1e3 * width

    def at(pitches) -> Curve:
        rho_a = start_of_path(mesh) + np.asarray(pitches) * mesh.base_pitch
        return true_mesh(kernel, mesh, samples, E, rho_a, force)

    return at, force, width, known


def three(values) -> tuple[float, float, float]:
    return values.min(), values.mean(), values.max()


def test_curve_is_that_of_the_other_program(pair):
    """The other program's c is accurate to 1e-4."""
    at, force, _, known = pair
    curve = at(np.arange(POSITIONS) / POSITIONS)
    assert curve.h.mean() * 1e6 == pytest.approx(known.mean, rel=2e-4)
    assert np.ptp(curve.h) * 1e6 == pytest.approx(known.peak_to_peak, rel=5e-4)
    assert three(force / curve.h / 1e6) == pytest.approx(known.secant, rel=2e-4)
    assert three(curve.stiffness / 1e6) == pytest.approx(known.tangent, rel=2e-4)


def test_edge_first_carries_where_the_other_program_says(pair):
    at, _, _, known = pair
    positions = np.linspace(known.first - 2e-4, known.first + 2e-4, 401)
    curve = at(positions)
    first = int(np.argmax(curve.force[:, 1] > 0))
    assert positions[first] == pytest.approx(known.first, abs=1e-5)
    assert curve.zone[first, 1] == EDGE_B


def test_pairs_share_the_load_as_the_other_program_says(pair):
    """At a tip c is extrapolated, with a larger error: 1e-3."""
    at, force, width, known = pair
    curve = at([0.0, 0.5])
    shares = curve.force[:, 1] * width / force
    assert (curve.h[0] * 1e6, shares[0]) == pytest.approx(known.at_start, rel=1.5e-3)
    assert (curve.h[1] * 1e6, shares[1]) == pytest.approx(known.halfway, rel=3e-4)
