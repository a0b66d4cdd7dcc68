"""C and c_1 beside a program that shares nothing with the kernel."""

from __future__ import annotations

import numpy as np
import pytest

from compliance.influence import influence
from kernel.gears import gear
from kernel.kernel import Kernel
from reference.wheel_compliance import WHEELS, Wheel


@pytest.mark.parametrize("wheel", WHEELS, ids=lambda wheel: str(wheel.teeth))
def test_whole_wheels_of_triangles_under_hertz_strips_give_the_same(
    kernel: Kernel, wheel: Wheel
) -> None:
    """Between its two meshes that program moves by 5e-4, toward these numbers."""
    found = influence(kernel, gear(kernel, wheel.teeth, 1.0, profile_shift=wheel.shift), wheel.hub)
    assert found.own_at(np.array(wheel.rho)) == pytest.approx(wheel.own, rel=3e-4)
    following = [found.other_at(1, rho, rho) for rho in wheel.rho]
    assert following == pytest.approx(wheel.following, rel=3e-4)
