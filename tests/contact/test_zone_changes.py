"""Zones of a wheel's flank: transitions at each zone limit, in both directions."""

from __future__ import annotations

import ctypes
from itertools import pairwise
from typing import NamedTuple

import numpy as np
import pytest

from kernel.kernel import Kernel, _at

BORDERS = ("tip", "tip_corner", "root", "root_corner", "end", "edge")
NO_RELIEF, SMOOTH, CORNER = range(3)
TIP_CORNER, ROOT_CORNER, ROOT, MIDDLE, TIP, END, EDGE = range(-3, 4)


class Way(NamedTuple):
    """From the middle of a profile outwards: the zone limits, and the zone beyond each."""

    reliefs: tuple[int, int]  # of tip and root
    takes_over: float  # distance from the end of the flank to the transition to the edge
    borders: tuple[str, ...]
    zones: tuple[int, ...]


WAYS = {
    "tip relief": Way((SMOOTH, NO_RELIEF), 0.0, ("tip", "edge"), (TIP, EDGE)),
    "its end goes on": Way((SMOOTH, NO_RELIEF), 1e-5, ("tip", "end", "edge"), (TIP, END, EDGE)),
    "tip relief with a corner": Way(
        *((CORNER, NO_RELIEF), 1e-5),
        *(("tip", "tip_corner", "end", "edge"), (TIP_CORNER, TIP, END, EDGE)),
    ),
    "no tip relief": Way((NO_RELIEF, SMOOTH), 0.0, ("edge",), (EDGE,)),
    "its end slopes": Way((NO_RELIEF, SMOOTH), 1e-5, ("end", "edge"), (END, EDGE)),
    "root relief": Way((SMOOTH, SMOOTH), 0.0, ("root",), (ROOT,)),
    "root relief with a corner": Way(
        (CORNER, CORNER), 0.0, ("root", "root_corner"), (ROOT_CORNER, ROOT)
    ),
}
every_way = pytest.mark.parametrize("way", WAYS.values(), ids=WAYS.keys())


def after(kernel: Kernel, way: Way, zone: int, *passed: str) -> int:
    """Zone of a contact that passed these limits at once."""
    reliefs, fired = (
        np.array(x, np.int32) for x in (way.reliefs, [border in passed for border in BORDERS])
    )
    change = kernel.library.test_change_zone
    return int(change(_at(reliefs), ctypes.c_double(way.takes_over), _at(fired), zone))


@every_way
def test_each_border_leads_to_the_zone_behind_it_and_back(kernel: Kernel, way: Way):
    zones = (MIDDLE, *way.zones)
    for border, (inside, outside) in zip(way.borders, pairwise(zones), strict=True):
        assert after(kernel, way, inside, border) == outside
        assert after(kernel, way, outside, border) == inside


@every_way
def test_borders_that_are_passed_at_once_lead_as_far_as_one_after_the_other(
    kernel: Kernel, way: Way
):
    """Within one relief, and beyond the end of a flank, also from both sides."""
    zones = (MIDDLE, *way.zones)
    n_relief = sum("tip" in border or "root" in border for border in way.borders)
    for first, last in ((0, n_relief), (n_relief, len(way.borders))):
        if first < last:
            passed = way.borders[first:last]
            assert after(kernel, way, zones[first], *passed) == zones[last]
            assert after(kernel, way, zones[last], *passed) == zones[first]
