"""Extremes of the quasi-static analysis do not depend on the number of positions.

``pytest tests/system/test_static_extremes.py --long`` compares 120 random pairs, without it 8, half
of them with reliefs and tip roundings.
"""

from __future__ import annotations

from typing import Any

import pytest
import xarray as xr

from system.bending_pairs import BendingPair
from system.random_sets import seeds
from system.test_bending_pairs import Files, files
from system.test_relieved_tips import RelievedPair

__all__ = ["files"]

SHORT, LONG = 8, 120
EXTREMES = (
    *("peak_to_peak_transmission_error", "largest_force_share", "largest_contact_pressure"),
    *("largest_edge_force", "smallest_tangent_stiffness", "largest_tangent_stiffness"),
)


def case_of(seed: int) -> tuple[dict[str, Any], float]:
    """Return a case and its torque."""
    pair = (RelievedPair if seed % 2 else BendingPair)(seed)
    return pair.at_rest(errors=False), pair.torque


def sampled(curves: xr.Dataset) -> dict[str, float]:
    """Return the extremes of the positions alone."""
    h, k = curves.transmission_error[0], curves.tangent_stiffness[0]
    on_edge = curves.pair_contact_kind[0] > 1
    return {
        "peak_to_peak_transmission_error": float(h.max() - h.min()),
        "largest_force_share": float(curves.force_share[0].max()),
        "largest_contact_pressure": float(curves.pair_contact_pressure[0].max()),
        "largest_edge_force": float(curves.pair_normal_force[0].where(on_edge, 0.0).max()),
        "smallest_tangent_stiffness": float(k.min()),
        "largest_tangent_stiffness": float(k.max()),
    }


@pytest.mark.parametrize("seed", seeds(range(SHORT), LONG))
def test_extremes_are_those_of_many_positions(files: Files, seed: int) -> None:
    """200 positions per pitch give the extremes of 10,000, and no position exceeds them."""
    case, torque = case_of(seed)
    few = files("static", case, "--torque", repr(torque))
    if few is None:
        return
    many = files("static", case, "--torque", repr(torque), "--points", "10000")
    assert many is not None
    for name in EXTREMES:
        found = float(few[name][0])
        assert found == pytest.approx(float(many[name][0]), rel=1e-4), name
        least = name.startswith("smallest")
        of_positions = sampled(many)[name]
        assert (of_positions >= found * (1 - 1e-4)) if least else of_positions <= found * (1 + 1e-4)


def test_a_short_pressure_peak_is_found(files: Files) -> None:
    """A rounded tip carries load for a short time; the pressure jumps at the start of the flank."""
    wheel = {"teeth": 33, "module": 1.3631e-3, "material": "steel", "width": 8.46e-3}
    elements = {"model": "finite_elements", "hub_diameter": 16.76e-3}
    table = {
        **{"model": "table", "rho": [5.648e-3, 7.692e-3, 10.42e-3]},
        **{"c": [2.415e-11, 3.401e-11, 5.527e-11], "c_1": [1.208e-11, 1.159e-11, 1.087e-11]},
    }
    case = {
        **{"format": 1, "simulation": {"duration": 1e-3, "output_interval": 1e-5}},
        "materials": {"steel": {"youngs_modulus": 2.06e11, "poisson_ratio": 0.3, "density": 7830}},
        "wheels": [
            wheel | {"name": "A", "profile_shift": 0.027, "compliance": elements, "bore": 14.6e-3},
            wheel
            | {"name": "B", "profile_shift": 0.108, "compliance": table, "bore": 12.26e-3}
            | {"profile_crowning": 3.08e-8, "tip_rounding": 9.019e-5}
            | {"loads": [{"kind": "viscous", "coefficient": 0.0074}]},
        ],
        "meshes": [
            {"name": "M", "driving": "A", "driven": "B", "centre_line_angle": -99}
            | {"driving_rotation": "counterclockwise", "backlash": 3e-5}
        ],
    }
    curves = files("static", case, "--torque", "0.09498")
    assert curves is not None
    sampled_pressure = float(curves.pair_contact_pressure.max())
    assert float(curves.largest_contact_pressure[0]) > 1.2 * sampled_pressure
    many = files("static", case, "--torque", "0.09498", "--points", "20000")
    assert many is not None
    expected = float(many.pair_contact_pressure.max())
    assert float(curves.largest_contact_pressure[0]) == pytest.approx(expected, rel=1e-3)
