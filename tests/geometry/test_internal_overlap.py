"""Random internal pairs: those accepted do not overlap, those refused do, by drawn outlines."""

from __future__ import annotations

from collections import Counter

import numpy as np
import pytest

from geometry.drawn_ring import annulus, overlap, pinion
from kernel.gears import GearGeometry, gear, gear_mesh, mesh_geometry
from kernel.kernel import Kernel, KernelError

MODULE = 1e-3
DRAWN = 2e-6  # error of the drawn outlines in modules: chords of 2000 points
PAIRS = 50  # of each seed
INTERFERENCES = (
    "involute interference",
    "fillet interference",
    "root circle",
    "foul",
    "the fillet",
)


@pytest.mark.parametrize("seed", range(4))
def test_accepted_pairs_do_not_overlap_and_refused_ones_do(kernel: Kernel, seed: int) -> None:
    random = np.random.default_rng(4300 + seed)
    kinds: Counter[str] = Counter()
    while kinds.total() < PAIRS:
        z = int(random.integers(18, 60))
        teeth = z, z + int(random.integers(5, 90))
        x = random.uniform(0.0, 0.6), random.uniform(-0.5, 0.5)
        addendum = float(random.uniform(0.6, 1.1))
        backlash = float(random.choice([0.0, random.uniform(0.0, 0.1)]))
        try:
            inner = gear(kernel, teeth[0], MODULE, profile_shift=x[0])
            shape = {"internal": "true", "rack_addendum": addendum}
            wheels = inner, gear(kernel, teeth[1], MODULE, profile_shift=x[1], **shape)
        except KernelError:
            continue  # a pointed tooth or no involute
        if wheels[0].is_undercut or wheels[1].fillet_radius < 0.38 * MODULE * (1 - 1e-12):
            continue
        kind = "accepted"
        try:
            mesh = gear_mesh(kernel, *wheels, backlash=backlash * MODULE)
            distance = -mesh.centre_distance / MODULE
        except KernelError as error:
            named = [word for word in INTERFERENCES if word in str(error)]
            if not named:
                continue  # too short a path of contact
            kind, distance = named[0], distance_of(kernel, wheels, backlash * MODULE)
        depth = overlap(
            pinion(teeth[0], x[0]), annulus(teeth[1], x[1], addendum), distance, backlash
        )
        assert (depth < DRAWN) == (kind == "accepted"), (teeth, x, addendum, backlash, kind, depth)
        kinds[kind] += 1
    assert kinds["accepted"] >= 10
    assert kinds.total() - kinds["accepted"] >= 5


def distance_of(
    kernel: Kernel, wheels: tuple[GearGeometry, GearGeometry], backlash: float
) -> float:
    """Centre distance of a backlash in modules, found by bisection of the geometry alone."""
    low = -(wheels[0].base_radius + wheels[1].base_radius) * (1 + 1e-9)
    high = 3 * low
    for _ in range(60):
        middle = (low + high) / 2
        # a larger centre distance closes an internal pair
        if mesh_geometry(kernel, *wheels, middle).backlash > backlash:
            low = middle
        else:
            high = middle
    return high / MODULE
