"""Internal gears cut by a pinion-type cutter, and their inspection measures."""

from __future__ import annotations

import ctypes
import re
from typing import Any

import numpy as np
import pytest

from kernel.description import Block
from kernel.gears import GearGeometry, gear
from kernel.kernel import Kernel, KernelError

PRINTED = 1e-9


def cut(kernel: Kernel, teeth: int, m: float, cutter: dict[str, Any], **given: Any) -> GearGeometry:
    """Ring cut by a cutter; lengths in mm."""
    m *= 1e-3
    lengths = {key: value * 1e-3 for key, value in cutter.items() if key.startswith("tip")}
    block = Block({"cutter": Block({"profile_shift": 0.0, "tip_rounding": 0.0} | cutter | lengths)})
    return gear(kernel, teeth, m, internal="true", rack_addendum=0.8, fillet=block, **given)


def fillet(kernel: Kernel, ring: GearGeometry, share: float) -> complex:
    point = (ctypes.c_double * 2)()
    kernel.library.test_cutter_fillet(ring, share, point)
    return complex(*point)


# independent program, mm: cutter, root and form diameter, points at quarters from root to form
CUT: dict[str, tuple[tuple[int, float, float], dict[str, Any], float, float, list[complex]]] = {
    "98": (
        (98, 3.0, 0.0),
        {"teeth": 34, "tip_diameter": 109.5, "tip_rounding": 1.14},
        -301.5,
        299.635261,
        [
            150.7499956 + 0.03628035836j,
            150.5792615 + 0.6614393365j,
            150.2891634 + 1.004160972j,
            150.035239 + 1.178560911j,
            149.8121185 + 1.285128624j,
        ],
    ),
    "71": (
        (71, 2.0, -0.3),
        {"teeth": 25, "profile_shift": 0.1, "tip_diameter": 55.2, "tip_rounding": 0.5},
        -147.9759942,
        147.005403,
        [
            73.98782206 + 0.1609506677j,
            73.91720295 + 0.4403345381j,
            73.78039847 + 0.6169149026j,
            73.63966325 + 0.7228450085j,
            73.49838317 + 0.7967426864j,
        ],
    ),
}


@pytest.mark.parametrize("name", CUT)
def test_root_of_a_cutter_agrees_with_an_independent_program(kernel: Kernel, name: str) -> None:
    (teeth, m, x), cutter, root, form, points = CUT[name]
    ring = cut(kernel, teeth, m, cutter, profile_shift=x)
    assert 2e3 * ring.root_radius == pytest.approx(root, rel=PRINTED)
    assert -2e3 * ring.form_radius == pytest.approx(form, rel=PRINTED)
    for i, expected in enumerate(points):
        assert abs(fillet(kernel, ring, i / 4) * 1e3 - expected) < 1e-6, i


@pytest.mark.parametrize("name", CUT)
def test_the_fillet_is_the_envelope_of_the_rolling_cutter(kernel: Kernel, name: str) -> None:
    (teeth, m, x), cutter, *_ = CUT[name]
    ring = cut(kernel, teeth, m, cutter, profile_shift=x)
    # the tip circle of the cutter's rounding in many positions, in the frame of the ring
    z, q = cutter["teeth"], cutter["tip_rounding"] * 1e-3
    centre = cutter["tip_diameter"] * 0.5e-3 - q
    base = m * 1e-3 * z / 2 * np.cos(np.radians(20))
    rho = np.sqrt(centre**2 - base**2)
    shift = cutter.get("profile_shift", 0.0)
    psi = (np.pi / 2 + 2 * shift * np.tan(np.radians(20))) / (z / 2)
    psi += 2 * (np.tan(np.radians(20)) - np.radians(20))
    delta = psi / 2 - (q + rho) / base + np.arctan(rho / base)
    distance = -ring.root_radius - cutter["tip_diameter"] * 0.5e-3
    turn = np.linspace(-0.05, 0.4, 40001)  # of the cutter's rounding from the centre line
    frame = np.exp(-1j * (turn - delta) * z / teeth)
    centres = (distance + centre * np.exp(1j * turn)) * frame
    for share in np.linspace(0.05, 0.95, 7):
        point = fillet(kernel, ring, float(share))
        # the union of all positions reaches the point and not farther
        assert abs(abs(point - centres).min() - q) < 1e-10


def test_the_fillet_joins_the_involute_with_its_tangent(kernel: Kernel) -> None:
    (teeth, m, x), cutter, *_ = CUT["98"]
    ring = cut(kernel, teeth, m, cutter, profile_shift=x)
    end = fillet(kernel, ring, 1.0)
    assert abs(end) == pytest.approx(-ring.form_radius, rel=1e-13)
    u = np.sqrt((ring.form_radius / ring.base_radius) ** 2 - 1)
    half = u - np.arctan(u) - ring.tooth_angle / 2  # of the tooth
    assert np.angle(end) == pytest.approx(np.pi / teeth - half, abs=1e-13)
    before = fillet(kernel, ring, 1 - 1e-6)
    # tangent of the involute: the radial direction turned by the pressure angle
    direction = np.angle((before - end) / end)
    assert abs(direction) == pytest.approx(np.arctan(u), abs=1e-5)


REFUSED: dict[str, tuple[tuple[int, float, float], dict[str, Any], str, float | None]] = {
    "roundings overlap": (
        (98, 3.0, 0.0),
        {"teeth": 34, "tip_diameter": 109.5, "tip_rounding": 1.3},
        r"at most ([-+.\dE]+) m",
        1.2001355,
    ),
    "roundings overlap, shifted": (
        (71, 2.0, -0.3),
        {"teeth": 25, "profile_shift": 0.1, "tip_diameter": 55.2, "tip_rounding": 0.9},
        r"at most ([-+.\dE]+) m",
        0.7848221013,
    ),
    "does not reach": (
        (40, 3.0, 0.0),
        {"teeth": 34, "profile_shift": 0.2, "tip_diameter": 109.5},
        r"at most ([-+.\dE]+)$",
        0.1228483744e3,
    ),
    "too many teeth": ((34, 3.0, 0.0), {"teeth": 34, "tip_diameter": 109.5}, "fewer teeth", None),
    "a thick rounding": (
        (98, 3.0, 0.0),
        {"teeth": 34, "tip_diameter": 109.5, "tip_rounding": 5.0},
        "must lie outside its base circle",
        None,
    ),
}


@pytest.mark.parametrize("name", REFUSED)
def test_cutters_that_do_not_fit(kernel: Kernel, name: str) -> None:
    (teeth, m, x), cutter, words, limit = REFUSED[name]
    with pytest.raises(KernelError) as refused:
        cut(kernel, teeth, m, cutter, profile_shift=x)
    found = re.search(words, str(refused.value))
    assert found, str(refused.value)
    if limit is not None:
        assert float(found[1]) * 1e3 == pytest.approx(limit, rel=1e-5)


def test_measures_of_a_ring(kernel: Kernel) -> None:
    """Dimension between balls and base tangent length over spaces: independent program, mm."""
    ring = gear(kernel, 98, 3e-3, internal="true", rack_addendum=0.8)
    value = ctypes.c_double()
    assert (
        kernel.library.test_ball_measure(ring, ctypes.c_double(5.25e-3), ctypes.byref(value)) == 0
    )
    assert value.value * 1e3 == pytest.approx(-286.2654817, rel=PRINTED)
    assert kernel.library.test_span_measure(ring, 11, ctypes.byref(value)) == 0
    assert value.value * 1e3 == pytest.approx(97.1097688, rel=PRINTED)
