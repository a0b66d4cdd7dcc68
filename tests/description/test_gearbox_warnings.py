"""Numbers that hardly any gearbox has are allowed, with one warning that names a wheel."""

from __future__ import annotations

import re
from typing import Any

import numpy as np
import pytest

from kernel.gearbox import WHEEL, Gearbox
from kernel.gearbox_description import (
    REST,
    SPEED,
    SPEEDS,
    STEADY,
    TABLE,
    TORQUE,
    VISCOUS,
    load,
    mesh,
    wheel,
)
from kernel.gears import gear_description
from kernel.kernel import Kernel


def real_pair(kernel: Kernel, module: float, *loads: Any, allowance: float = 0.0) -> Gearbox:
    gear = gear_description(module, thickness_allowance=allowance)
    wheels = [wheel(teeth=z, width=0.02, gear=gear, mass=1.0, inertia=0.1) for z in (17, 19)]
    description = mesh(kernel, backlash=1e-4)
    description.pop("pressure_angle")
    return Gearbox(kernel, wheels, loads, [description])


@pytest.mark.parametrize("pinion", [0, 1], ids=["the pinion drives", "the wheel drives"])
def test_a_contact_strip_is_measured_by_the_smallest_radius_of_either_flank(
    kernel: Kernel, pinion: int
):
    """Near the pinion's base circle, where its path begins or ends: whoever drives."""
    teeth = (17, 60) if pinion == 0 else (60, 17)
    gear = gear_description(0.003)
    wheels = [wheel(teeth=z, width=0.02, gear=gear, mass=1.0, inertia=0.1) for z in teeth]
    description = mesh(kernel, backlash=1e-4)
    description.pop("pressure_angle")
    torque = (1 if pinion else -1) * 3000.0  # of the pinion
    against = (
        torque * teeth[1 - pinion] / teeth[pinion]
    )  # balances it: both turn against each other
    loads = [load(pinion, TORQUE, torque), load(1 - pinion, TORQUE, against)]
    gearbox = Gearbox(kernel, wheels, loads, [description])
    (warned,) = (w for w in gearbox.warnings() if "contact strip" in w.message)
    geometry = gearbox.mesh_geometry()
    wheel_b = gearbox.wheel_geometry(1)
    ends = (
        geometry.rho_start_driving,
        np.sqrt(geometry.tip_radius_driving**2 - gearbox.wheel_geometry(0).base_radius ** 2),
    )
    radii = (ends[0], geometry.line_of_action_length - ends[1])
    assert radii[pinion] == min(radii)
    assert np.hypot(wheel_b.base_radius, radii[1]) < geometry.tip_radius_driven
    reported = float(re.search(r"smallest radius of curvature (\S+) m", warned.message)[1])
    assert reported == pytest.approx(min(radii), rel=1e-5)  # six digits are told


@pytest.mark.parametrize(("allowance", "n"), [(-1.99e-4, 0), (-2.01e-4, 2)])
def test_an_allowance_above_a_tenth_of_a_module_is_named(kernel: Kernel, allowance: float, n: int):
    """Of each wheel: a module of 2 mm."""
    all_warned = real_pair(kernel, 0.002, allowance=allowance).warnings()
    warned = [w for w in all_warned if "0.1 modules" in w.message]
    assert [(w.subject, w.index) for w in warned] == [(WHEEL, 0), (WHEEL, 1)][:n]
    assert all(w.message.startswith("the thickness allowance of -2.01E-04 m is") for w in warned)


# Speeds of the wheels of 17 and 19 teeth: loads, start, and the wheel that is named.
SLOW: dict[str, tuple[list[Any], dict[str, Any]]] = {
    "nothing": ([], {}),
    "a torque alone": ([load(0, TORQUE, -1e9)], {}),
    "a torque alone, steady": ([load(0, TORQUE, -1e9)], {"kind": STEADY}),
    "a prescribed speed": ([load(0, SPEED, -8.9e4)], {}),
    "given speeds": ([], {"kind": SPEEDS, "speeds": [-1e5, 8e4]}),
}
FAST: dict[str, tuple[list[Any], dict[str, Any], int, str]] = {
    "a prescribed speed": ([load(0, SPEED, -1.01e5)], {}, 0, "101000 rad/s;"),
    "of the driven wheel": ([load(1, SPEED, 9e4)], {}, 0, "100588 rad/s;"),
    "of both": ([load(1, SPEED, 2e5)], {}, 0, "223529 rad/s, and so has another wheel"),
    "a table": ([load(1, SPEED, table=[(0, 0), (1, 9.5e4)])], {}, 0, "106176 rad/s;"),
    "by the loads": ([load(0, TABLE, table=[(0, 1), (1, 10)]), load(0, VISCOUS, 9e-5)], {}, 0, ""),
    "given speeds": ([], {"kind": SPEEDS, "speeds": [0.0, -1.2e5]}, 1, "120000 rad/s;"),
}


@pytest.mark.parametrize("case", SLOW)
def test_likely_speeds_are_no_news(kernel: Kernel, case: str):
    loads, start = SLOW[case]
    assert real_pair(kernel, 3e-3, *loads).speed_warning(**start) is None


@pytest.mark.parametrize("case", FAST)
def test_an_unlikely_speed_is_named_with_its_wheel(kernel: Kernel, case: str):
    loads, start, index, words = FAST[case]
    gearbox = real_pair(kernel, 3e-3, *loads)
    warned = gearbox.speed_warning(**start)
    assert warned is not None
    assert (warned.subject, warned.index) == (WHEEL, index)
    assert warned.message.startswith("loads and initial state give it a speed of ")
    assert words in warned.message
    assert gearbox.speed_warning(kind=REST) == warned or start
