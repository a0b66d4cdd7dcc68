"""A lightly loaded two-stage reducer of an electric drive, excited by its torque ripple."""

from __future__ import annotations

import re
from typing import Any

import numpy as np
import pytest

from evolvent import check_history
from system.runs import Run, Runs


def wheel(name: str, teeth: int, module: str, shift: float, **more: Any) -> dict[str, Any]:
    return {
        **{"name": name, "teeth": teeth, "module": module, "profile_shift": shift},
        **{"material": "steel", "compliance": {}},
        "support": {
            **{"kind": "bearing", "stiffness": ["250 N/um", "250 N/um"]},
            "damping": ["2 N s/mm", "2 N s/mm"],
        },
        **more,
    }


def mesh(name: str, driving: str, driven: str, sense: str, angle: str) -> dict[str, Any]:
    return {
        **{"name": name, "driving": driving, "driven": driven, "driving_rotation": sense},
        **{"centre_line_angle": angle, "damping": {"law": "ratio", "value": 0.07}},
        "friction": {"law": "coulomb", "coefficient": 0.05, "regularisation_velocity": "1 mm/s"},
    }


def shaft(name: str, wheels: list[str], stiffness: str, damping: str) -> dict[str, Any]:
    return {"name": name, "wheels": wheels, "stiffness": stiffness, "damping": damping}


def reducer() -> dict[str, Any]:
    """19/61 and 23/77 teeth at 1500 rpm, 10 N m with a ripple of 15 N m twice per revolution."""
    motor = {
        **{"name": "motor", "inertia": "0.03 kg m2", "mass": "15 kg", "width": "100 mm"},
        "material": "steel",
        "loads": [
            {"kind": "drive", "speed": "1500 rpm", "torque": "3 N m", "slope": "-0.05 N m/rpm"},
            {"kind": "harmonic", "amplitude": "15 N m", "order": 2},
        ],
    }
    car = {
        **{"name": "car", "inertia": "3 kg m2", "mass": "100 kg", "width": "200 mm"},
        **{"axial_position": "200 mm", "material": "steel"},
        "loads": [{"kind": "torque", "value": "-32 N m"}],
    }
    first = {"thickness_allowance": "-40 um", "bore": "16 mm", "width": "28 mm"}
    second = {"thickness_allowance": "-60 um", "bore": "40 mm", "width": "26 mm"}
    third = {"thickness_allowance": "-40 um", "bore": "25 mm", "width": "38 mm"}
    fourth = {"thickness_allowance": "-80 um", "bore": "60 mm", "width": "36 mm"}
    there = {"axial_position": "50 mm"}
    return {
        "format": 1,
        "materials": {
            "steel": {
                **{"youngs_modulus": "206 GPa", "poisson_ratio": 0.3},
                "density": "7830 kg/m3",
            }
        },
        "wheels": [
            motor,
            wheel("p1", 19, "2 mm", 0.4, **first),
            wheel("g1", 61, "2 mm", 0.1, **second),
            wheel("p2", 23, "2.5 mm", 0.35, **third, **there),
            wheel("g2", 77, "2.5 mm", 0.1, **fourth, **there),
            car,
        ],
        "shafts": [
            shaft("input", ["motor", "p1"], "20 kN m/rad", "0.3 N m s/rad"),
            shaft("middle", ["g1", "p2"], "100 kN m/rad", "1 N m s/rad"),
            shaft("output", ["g2", "car"], "15 kN m/rad", "3 N m s/rad"),
        ],
        "meshes": [
            mesh("first", "p1", "g1", "counterclockwise", "0 deg"),
            mesh("second", "p2", "g2", "clockwise", "40 deg"),
        ],
        "simulation": {
            **{"duration": "0.26 s", "output": {"per_pitch": 60, "mesh": "first"}},
            **{"initial": {"kind": "steady"}, "metrics": {"from": "20 ms", "turns_of": "g1"}},
        },
    }


@pytest.fixture(scope="module")
def both(runs: Runs) -> dict[str, Run]:
    return {name: runs(reducer(), f"simulation.integrator={name}") for name in ("radau", "ida")}


def test_both_integrators_find_the_same_motion(both: dict[str, Run]) -> None:
    """To 1e-4 of the largest value: at the default tolerance IDA has accelerations to 1e-5."""
    radau, ida = (both[name].history for name in ("radau", "ida"))
    names = [name for name in radau.data_vars if name.startswith("window_")]
    assert radau.window_dynamic_factor.notnull().all()
    for name in names:
        if radau[name].dtype.kind == "f":
            bound = 1e-4 * float(abs(radau[name]).max())
            np.testing.assert_allclose(ida[name], radau[name], rtol=0, atol=bound, err_msg=name)


def test_the_flanks_only_push_and_energy_is_kept(both: dict[str, Run]) -> None:
    for run in both.values():
        assert run.exit_code == 0
        assert float(run.history.normal_force.min()) >= 0
        assert not [verdict for verdict in check_history(run.history) if verdict.failed]


def test_the_command_prints_its_dynamic_factors(both: dict[str, Run]) -> None:
    for run in both.values():
        found = re.findall(r"factor of the mesh force ([\d.]+)", run.messages)
        factors = [float(text) for text in found]
        assert len(factors) == 2
        assert all(1.1 < factor < 2.5 for factor in factors)
