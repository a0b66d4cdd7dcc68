"""Friction laws with one coefficient for an operating point, against mpmath."""

from __future__ import annotations

import ctypes
from typing import Any

import mpmath as mp
import pytest

from kernel.interface import fields
from kernel.kernel import FRICTION, Kernel, LawChoice

# 300 N/mm, 5 m/s, 10 mm, 73.2 mm, 20 mPa s, 0.5 um
POINT = {
    "line_load": 3e5,
    "rolling_speed": 5.0,
    "radius": 0.01,
    "diameter": 0.0732,
    "viscosity": 0.02,
    "roughness": 5e-7,
}
# Computed once with 30 digits from the formulas, as printed in docs/reference/laws.md.
PRINTED = {"mean_roughness": 0.0605605194350115, "schlenk": 0.0497235913701627}
DELTA = 1e-3


class Point(ctypes.Structure):
    """`given_operating_point`."""

    _fields_ = fields("given_operating_point")


def coefficient(kernel: Kernel, name: str, factor: float = 1.0, **changes: float) -> Any:
    """Return the coefficient, and the factor of the law that replaces it at 1 m/s."""
    law: LawChoice = kernel.law(
        FRICTION, name, lubricant_factor=factor, regularisation_velocity=DELTA
    )
    mu, acting = ctypes.c_double(), ctypes.c_double()
    kernel.library.test_law_operating_coefficient(
        law, Point(**{**POINT, **changes}), ctypes.byref(mu), ctypes.byref(acting)
    )
    return mu.value, acting.value


def exact(name: str, factor: float = 1.0, **changes: float) -> float:
    with mp.workdps(30):
        at = {key: mp.mpf(str(value)) for key, value in {**POINT, **changes}.items()}
        load = max(at["line_load"] / 1000, mp.mpf(150))
        mu = (load / (at["rolling_speed"] * at["radius"] * 1000)) ** mp.mpf("0.2")
        mu *= (at["viscosity"] * 1000) ** mp.mpf("-0.05") * mp.mpf(str(factor))
        ra = at["roughness"] * 10**6
        if name == "schlenk":
            return float(mp.mpf("0.048") * mu * ra ** mp.mpf("0.25"))
        x_r = mp.mpf("3.8") * (ra / (at["diameter"] * 1000)) ** mp.mpf("0.25")
        return float(mp.mpf("0.045") * mu * x_r)


@pytest.mark.parametrize("name", PRINTED)
def test_the_coefficient_at_the_stated_point(kernel: Kernel, name: str):
    mu, acting = coefficient(kernel, name)
    assert mu == pytest.approx(PRINTED[name], rel=1e-14)  # rounding of four powers
    assert acting == mu


@pytest.mark.parametrize("name", PRINTED)
@pytest.mark.parametrize(
    "changes",
    [
        {"line_load": 1.5e5},
        {"line_load": 2e6, "rolling_speed": 0.03},
        {"radius": 1e-3, "diameter": 0.01},
        {"viscosity": 0.8, "roughness": 3e-6},
        {"viscosity": 5e-4, "factor": 0.6},
    ],
    ids=str,
)
def test_the_coefficient_follows_its_formula(kernel: Kernel, name: str, changes: dict[str, float]):
    mu, _ = coefficient(kernel, name, **changes)
    assert mu == pytest.approx(exact(name, **changes), rel=1e-14)


@pytest.mark.parametrize("name", PRINTED)
def test_a_line_load_below_150_newtons_per_millimetre_counts_as_that(kernel: Kernel, name: str):
    light, least, more = (
        coefficient(kernel, name, line_load=load)[0] for load in (0.0, 1.5e5, 1.6e5)
    )
    assert light == least < more


@pytest.mark.parametrize("name", PRINTED)
def test_before_the_mesh_is_known_there_is_a_knee_but_no_friction(kernel: Kernel, name: str):
    law = kernel.law(FRICTION, name, lubricant_factor=1.0, regularisation_velocity=DELTA)
    assert kernel.law_friction_knee(law) == DELTA
    factor, d_v = kernel.law_friction_factor(law, [-1, 0, 1], [-1.0, 0.0, 1.0])
    assert not factor.any()
    assert not d_v.any()
