"""A reported rate is the derivative of its quantity, or the run fails.

The kernel of the drill has an additional kind of load: a drag with a quadratic term.
"""

from __future__ import annotations

import json
import os
import subprocess
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import xarray as xr

import machine
from evolvent import check_history
from evolvent.physics.invariants import Verdict
from kernel.gearbox import Gearbox
from kernel.gearbox_description import CLOSED_FORM, TORQUE, load, mesh, wheel
from kernel.kernel import Kernel
from system.runs import Run, Runs

UNITS = {"W", "rad s-2", "m s-2", "rad s-1", "m s-1"}
LINEAR, QUADRATIC = 10, 2
SPIN = 2.0  # of the housing [rad/s]
TURNING = {"kind": "prescribed", "rotation": [{"kind": "rate", "axis": "z", "value": SPIN}]}
STEEL = {"youngs_modulus": 2e11, "poisson_ratio": 0.3, "density": 7800}
CASE: dict[str, Any] = {
    "format": 1,
    "materials": {"steel": STEEL},
    "wheels": [
        {
            **{"name": "pinion", "teeth": 20, "pitch_radius": 0.2, "width": 0.1},
            **{"material": "steel", "centre": [0, 0]},
            "loads": [{"kind": "torque", "value": -30}],
        },
        {
            **{"name": "gear", "teeth": 30, "width": 0.1, "material": "steel"},
            "loads": [{"kind": "drill", "coefficient": LINEAR, "quadratic": QUADRATIC}],
        },
    ],
    "meshes": [
        {
            **{"name": "pair", "driving": "pinion", "driven": "gear"},
            **{"driving_rotation": "clockwise", "centre_line_angle": 0},
            **{"pressure_angle": "paper_rule", "contact": {"law": "johnson"}},
            "damping": {"law": "linear", "coefficient": 1e4},
        }
    ],
    "simulation": {
        **{"duration": 0.02, "output_interval": 2e-5, "tolerance": 1e-9},
        "initial": {"kind": "rest"},
    },
}


@pytest.fixture(scope="session")
def drill() -> Path:
    """Kernel with an additional kind of load."""
    folder = Path(os.environ["EVOLVENT_TEST_LIBRARY"]).parent
    library = folder / "libkernel_drill.so"
    if not library.exists():
        machine.unavailable("a sanitizer takes the place of libraries that are preloaded")
    return library


@pytest.mark.parametrize(
    ("integrator", "tracking"),
    [("radau", "closed_form"), ("ida", "closed_form"), ("ida", "differential")],
)
@pytest.mark.parametrize("housing", [None, TURNING], ids=["fixed", "turning"])
def test_the_one_formula_of_a_load_serves_every_integrator_and_housing(
    runs: Runs,
    drill: Path,
    tmp_path: Path,
    housing: dict[str, Any] | None,
    integrator: str,
    tracking: str,
) -> None:
    case = tmp_path / "case.yaml"
    case.write_text(json.dumps(CASE if housing is None else {**CASE, "housing": housing}))
    settings = (f"simulation.integrator={integrator}", f"meshes.0.tracking={tracking}")
    options = [word for setting in settings for word in ("--set", setting)]
    done = subprocess.run(
        [runs.executable, "run", "-q", case, "-o", tmp_path / "case.h5", *options],
        **{"capture_output": True, "text": True, "timeout": 300, "check": False},
        env={**os.environ, "LD_PRELOAD": str(drill)},
    )
    assert done.returncode == 0, done.stderr
    with xr.open_dataset(tmp_path / "case.h5", engine="h5netcdf") as history:
        gear = history.isel(wheel=1)
        speed = gear["angular_velocity"].values + (0 if housing is None else SPIN)
        torque = gear["load_torque"].values
    assert np.ptp(speed) > 0.02
    expected = -(LINEAR + QUADRATIC * abs(speed)) * speed
    np.testing.assert_allclose(torque, expected, rtol=0, atol=1e-13 * abs(expected).max())


def test_every_output_with_the_unit_of_a_rate_names_its_integral(kernel: Kernel) -> None:
    table = {entry.name.decode(): entry for entry in small_gearbox(kernel).table}
    for name, entry in table.items():
        rate_of, no_rate = entry.rate_of.decode(), entry.no_rate.decode()
        if entry.units.decode() in UNITS:
            assert bool(rate_of) != bool(no_rate), name
        if rate_of:
            assert entry.units.decode() == unit_of_rate(table[rate_of].units.decode()), name


def small_gearbox(kernel: Kernel) -> Gearbox:
    wheels = [wheel(teeth=20, pitch_radius=0.1), wheel(teeth=33)]
    meshes = [mesh(kernel, 0, 1, centre_line_angle=0.5, tracking=CLOSED_FORM)]
    return Gearbox(kernel, wheels, [load(0, TORQUE, -7.0)], meshes)


def unit_of_rate(unit: str) -> str:
    """Unit of the rate of an output."""
    return {"rad": "rad s-1", "rad s-1": "rad s-2", "m": "m s-1", "m s-1": "m s-2", "J": "W"}[unit]


FINE = ("simulation.output_interval=5e-6", "simulation.duration=0.02")


@pytest.fixture(scope="module")
def fine(runs: Runs) -> Run:
    """Outputs that resolve the vibration."""
    case = json.loads(json.dumps(CASE))
    case["wheels"][1]["loads"] = [{"kind": "viscous", "coefficient": 10}]
    return runs(case, *FINE)


def verdict(history: Any) -> Verdict:
    return next(v for v in check_history(history) if v.invariant.name == "rates")


def test_a_history_names_the_rates_of_its_outputs(fine: Run) -> None:
    assert fine.history["angle"].attrs["rates"] == "angular_velocity"
    assert fine.history["angular_velocity"].attrs["rates"] == "angular_acceleration"
    losses = set(fine.history["dissipated_energy"].attrs["rates"].split())
    assert losses >= {"friction_loss", "contact_damping_loss", "support_damping_loss"}
    assert "rates" not in fine.history["gap_rate"].attrs


def test_the_check_integrates_rates_that_the_rows_resolve(fine: Run) -> None:
    assert verdict(fine.history).verdict == "pass", verdict(fine.history)


@pytest.mark.parametrize("name", ["angular_velocity", "angular_acceleration", "friction_loss"])
def test_the_check_finds_a_rate_that_is_wrong(fine: Run, name: str) -> None:
    if name == "friction_loss":
        name = "contact_damping_loss"
    changed = fine.history.copy(deep=True)
    changed[name] = changed[name] * 1.01
    changed[name].attrs.update(fine.history[name].attrs)
    assert verdict(changed).failed


def test_rows_too_far_apart_say_nothing(fine: Run) -> None:
    assert verdict(fine.history.isel(time=slice(None, None, 50))).verdict == "not applicable"
    assert np.diff(fine.history["time"].values).max() < 1e-5
