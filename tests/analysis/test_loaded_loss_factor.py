"""Tooth loss factor with the load shares of a static analysis, from its own tooth pairs."""

from __future__ import annotations

import math

import numpy as np
import pytest

from analysis.test_static_analysis import FIFTY, pair, torque_of
from kernel.gearbox import Gearbox
from kernel.kernel import Kernel
from kernel.static import Curve, static_curve

LINE_LOAD = 150e3  # [N/m]
TALL = {"rack_addendum": 1.35, "rack_dedendum": 1.55, "rack_root_radius": 0.2}


def by_pairs(gearbox: Gearbox, curve: Curve) -> float:
    """Mean of share times sliding; flanks without deviations share their overlap equally."""
    line = gearbox.mesh_geometry().line_of_action_length
    base = (curve.base_radius_driving, curve.base_radius_driven)
    rho = (curve.pair_position, curve.pair_position_driven)
    overlap = rho[0] + rho[1] - line
    arms = [(rho[i] - overlap / 2) / base[i] for i in (0, 1)]
    terms = np.where(curve.force_share > 0, curve.force_share * abs(arms[1] - arms[0]), 0.0)
    return float(terms.sum(1).mean())


@pytest.mark.parametrize("drives", [True, False], ids=["drive flanks", "coast flanks"])
@pytest.mark.parametrize("gears", [FIFTY, {}], ids=["50/50", "19/34"])
def test_it_is_the_mean_of_share_times_sliding(
    kernel: Kernel, gears: dict[str, object], *, drives: bool
):
    gearbox = pair(kernel, **{**gears, "compliance": {}})
    torque = torque_of(gearbox, LINE_LOAD) * (1 if drives else -1)
    curve = static_curve(gearbox, torque, points=100)
    assert curve.loaded_tooth_loss_factor == pytest.approx(by_pairs(gearbox, curve), rel=1e-12)


def test_pairs_that_deflect_alone_share_nearly_equally(kernel: Kernel):
    """Johnson's stiffness hardly depends on the position: H_V of equal shares is near."""
    gearbox = pair(kernel, **{**FIFTY, "compliance": {}})
    curve = static_curve(gearbox, torque_of(gearbox, LINE_LOAD), points=1000)
    assert curve.loaded_tooth_loss_factor == pytest.approx(curve.tooth_loss_factor, rel=5e-3)


def test_friction_moves_it_with_the_direction_of_power_and_not_on_the_mean(kernel: Kernel):
    """First order in the coefficient of friction: 0 on the mean of both directions."""
    mu, speed = 1e-3, 10.0
    smooth = pair(kernel, **FIFTY)
    gearbox = pair(kernel, **FIFTY, friction=(mu, 1e-9))
    torque = torque_of(gearbox, LINE_LOAD)
    without = static_curve(smooth, torque).loaded_tooth_loss_factor
    either = [
        static_curve(gearbox, torque, speed=sign * speed).loaded_tooth_loss_factor
        for sign in (1, -1)
    ]
    assert abs(either[0] - either[1]) > 1e-5 * without
    assert np.mean(either) == pytest.approx(without, rel=1e-5)


def test_corner_contact_adds_to_it(kernel: Kernel):
    """Compliant teeth enter early on their corners, where they slide most."""
    gearbox = pair(kernel, **FIFTY)
    light, heavy = (
        static_curve(gearbox, torque_of(gearbox, load), points=400) for load in (5e3, 4e5)
    )
    assert (heavy.pair_contact_kind > 1).any()
    assert heavy.loaded_tooth_loss_factor > light.loaded_tooth_loss_factor


def test_outside_its_validity_there_is_no_factor_of_equal_shares(kernel: Kernel):
    """Tall teeth: a contact ratio above 2."""
    gearbox = pair(kernel, **{**FIFTY, "compliance": {}, "gear": TALL})
    curve = static_curve(gearbox, torque_of(gearbox, LINE_LOAD))
    assert curve.contact_ratio > 2
    assert math.isnan(curve.tooth_loss_factor)
    assert curve.loaded_tooth_loss_factor > 0
