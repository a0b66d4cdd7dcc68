"""Viscous forces after Hunt and Crossley: chi by name, force, derivatives, and the v0 they use."""

from __future__ import annotations

import numpy as np
import pytest
from restitution import DIVIDING, FACTORS, factor

from kernel.kernel import CONTACT, DAMPING, Kernel

GEOMETRY = {"rho_a": 0.02, "rho_b": 0.045441, "e_star": 1.1e11, "width": 0.1}
H, H_DOT = (grid.ravel() for grid in np.meshgrid([-2e-7, 3e-9, 1e-6], [-0.3, 0.0, 0.02]))
ELASTIC = {"johnson": {}, "power": {"coefficient": 2e11, "exponent": 1.5}}


def viscous(kernel: Kernel, name: str, contact: str = "johnson", v0_min: float = 1e-6, **given):
    """Viscous force of a law with e = 0.7 unless `given` has another restitution."""
    damping = kernel.law(DAMPING, name, restitution=given.pop("restitution", 0.7), v0_min=v0_min)
    elastic = kernel.law(CONTACT, contact, **ELASTIC[contact])
    return kernel.law_viscous_force(elastic, damping, **{**GEOMETRY, **given})


@pytest.fixture(params=FACTORS)
def name(request):
    return request.param


@pytest.mark.parametrize(
    ("name", "restitution"),
    [(name, e) for name in FACTORS for e in (0.01, 0.25, 0.7, 0.99, 1.0)]
    + [(name, 0.0) for name in FACTORS if name not in DIVIDING],
)
@pytest.mark.parametrize("contact", ELASTIC)
def test_the_force_is_the_elastic_one_times_chi_and_the_rate_over_v0(
    kernel: Kernel, name: str, contact: str, restitution: float
):
    chi = float(factor(name, restitution))
    v0 = 0.05
    elastic = kernel.law_elastic_force(
        kernel.law(CONTACT, contact, **ELASTIC[contact]), h=H, **GEOMETRY
    )
    result = viscous(kernel, name, contact, restitution=restitution, h=H, h_dot=H_DOT, v0=v0)
    expected = {
        "force": elastic.force * chi * H_DOT / v0,
        "d_h": elastic.d_h * chi * H_DOT / v0,
        "d_rho_a": elastic.d_rho_a * chi * H_DOT / v0,
        "d_rho_b": elastic.d_rho_b * chi * H_DOT / v0,
        "d_h_dot": elastic.force * chi / v0,
    }
    for field, values in expected.items():
        # a handful of roundings; (1 - e)(1 + e) does not cancel
        np.testing.assert_allclose(getattr(result, field), values, rtol=2e-15, err_msg=field)


def test_derivatives_are_the_slopes_of_the_force(kernel: Kernel, name: str):
    step = 1e-5
    given = {"h": H, "h_dot": H_DOT, "v0": 0.05}
    at = viscous(kernel, name, **given)
    for field, variable, values in (
        ("d_h", "h", H),
        ("d_h_dot", "h_dot", np.full_like(H, 0.1)),
        ("d_rho_a", "rho_a", np.full_like(H, GEOMETRY["rho_a"])),
        ("d_rho_b", "rho_b", np.full_like(H, GEOMETRY["rho_b"])),
    ):
        centre = {**GEOMETRY, **given}[variable]
        above, below = (
            viscous(kernel, name, **{**given, variable: centre + s * step * values}).force
            for s in (1, -1)
        )
        slope = (above - below) / (2 * step * values)
        # step**2 from the quotient, eps/step from rounding of the largest force
        largest = np.abs(getattr(at, field)).max()
        np.testing.assert_allclose(slope, getattr(at, field), rtol=1e-8, atol=1e-10 * largest)


@pytest.mark.parametrize("v0", [0.0, 1e-9, 9e-4])
def test_v0_is_never_below_its_minimum(kernel: Kernel, name: str, v0: float):
    """A contact that starts closed and at rest has v0 = v0_min."""
    low = viscous(kernel, name, h=1e-8, h_dot=1e-3, v0=v0, v0_min=1e-3)
    at_minimum = viscous(kernel, name, h=1e-8, h_dot=1e-3, v0=1e-3, v0_min=1e-3)
    for values, expected in zip(low, at_minimum, strict=True):
        np.testing.assert_array_equal(values, expected)
    above = viscous(kernel, name, h=1e-8, h_dot=1e-3, v0=2e-3, v0_min=1e-3)
    assert above.force[0] == pytest.approx(at_minimum.force[0] / 2, rel=1e-15)


def test_a_restitution_of_1_is_no_damping(kernel: Kernel, name: str):
    assert not np.any(viscous(kernel, name, restitution=1.0, h=H, h_dot=H_DOT, v0=0.05))


def test_the_smallest_v0_is_left_to_the_mesh_by_default(kernel: Kernel, name: str):
    (info,) = [law for law in kernel.laws(DAMPING) if law.name == name]
    restitution, v0_min = info.rows[:2]
    assert (v0_min.key, v0_min.unit, v0_min.required) == ("v0_min", "m/s", False)
    assert not v0_min.default_text
    assert (v0_min.minimum, v0_min.minimum_open) == (0, True)
    assert (restitution.key, restitution.unit, restitution.required) == ("restitution", "", True)
    assert (restitution.minimum, restitution.minimum_open) == (0, name in DIVIDING)
    assert (restitution.maximum, restitution.maximum_open) == (1, False)
