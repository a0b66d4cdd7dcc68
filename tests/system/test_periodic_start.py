"""`initial: {kind: periodic}`: a run of one common period ends at its initial state."""

from __future__ import annotations

import json
import math
import signal
import subprocess
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import xarray as xr

from designs import read_folder, write_design
from system.periodic_cases import mirrored, periodic_case, reordered
from system.random_sets import seeds
from system.test_metrics import RATIO, TEETH, rectangular
from system.test_orbits import OMEGA_1, UNIT, monodromy

Evolvent = Callable[..., subprocess.CompletedProcess[str]]
Run = Callable[..., xr.Dataset]
PERIODIC = "simulation.initial={kind: periodic}"
EPSILON = float(np.finfo(float).eps)


@pytest.fixture
def run(evolvent: Evolvent, tmp_path: Path) -> Run:
    """Return a function that returns the history of a case, with settings."""

    def run(case: Any, **settings: Any) -> xr.Dataset:
        path = case if isinstance(case, Path) else tmp_path / "case.yaml"
        if path is not case:
            path.write_text(json.dumps(case))
        words = [
            word
            for key, value in settings.items()
            for word in ("--set", f"simulation.{key}={value}")
        ]
        done = evolvent("run", path, "-o", tmp_path / "history.h5", *words)
        assert done.returncode == 0, done.stderr
        with xr.open_dataset(tmp_path / "history.h5", engine="netcdf4") as history:
            return history.load().assign_attrs(messages=done.stderr)

    return run


def distance(history: xr.Dataset) -> float:
    """Largest difference of the first and the last state in units of h_0 and h_0 omega."""
    h = float(history["reference_penetration"].min())
    rate = h * 2 * math.pi * float(history["natural_frequency"].min())
    arm = history["pitch_radius"].values
    largest = 0.0
    for name, factor in (
        ("angle_deviation", arm / h),
        ("angular_velocity", arm / rate),
        ("centre_displacement", 1 / h),
        ("centre_velocity", 1 / rate),
    ):
        values = history[name].values
        change = (values[-1] - values[0]).T * factor
        largest = max(largest, float(np.nanmax(np.abs(change))))
    return largest


def over_a_period(run: Run, case: dict[str, Any], integrator: str = "radau") -> xr.Dataset:
    """Run one common period from the periodic start."""
    first = run(case, integrator=integrator)
    period = float(first.attrs["start_period"])
    return run(case, integrator=integrator, duration=repr(period), output_interval=repr(period / 8))


# ---- the orbit -----------------------------------------------------------------------------------


@pytest.mark.parametrize("seed", seeds((1, 4, 5, 7, 9), 50))
def test_a_common_period_later_the_state_is_that_of_the_start(run: Run, seed: int) -> None:
    """Both integrators at a tolerance of 1e-12, wheels and meshes in another order, mirrored."""
    case = periodic_case(seed)
    variants = {"case": case, "reordered": reordered(case), "mirrored": mirrored(case)}
    multipliers = []
    for name, variant in variants.items():
        history = over_a_period(run, variant)
        assert distance(history) <= 1e-9, name
        assert history.attrs["start_residual"] <= 1e-9
        multipliers.append(history.attrs["start_multiplier"])
    # multipliers are accurate to the tolerance of their flow, times the norm of the derivative
    assert multipliers == pytest.approx([multipliers[0]] * 3, rel=1e-5, abs=1e-8)
    by_ida = over_a_period(run, case, "ida")
    # IDA rounds in each of its small steps: seed 48 has 480,000 in 150 pitches, and is off by
    # 6e-10, 1.2e-9 and 2.7e-9 at tolerances of 1e-11, 1e-12, 1e-13; radau by 4e-11 at all of them
    assert distance(by_ida) <= max(1e-9, 16 * EPSILON * by_ida.attrs["integrator_steps"])


def test_both_integrators_start_from_the_same_bits(run: Run) -> None:
    case = periodic_case(4)
    radau, ida = (run(case, integrator=name) for name in ("radau", "ida"))
    names = [name for name, values in radau.data_vars.items() if "time" in values.dims]
    assert "angular_velocity" in names
    for name in names:
        starts = [history[name].isel(time=0).values.tobytes() for history in (radau, ida)]
        assert starts[0] == starts[1], name


@pytest.mark.parametrize("name", ["compliant-pair", "spur-pair", "tutorial-pair"])
def test_the_orbit_is_where_the_motion_from_the_steady_start_ends(
    run: Run, examples: Path, name: str
) -> None:
    """After 0.3 s and more the motion has settled to 1e-2 of its slowest mode."""
    history = run(examples / f"{name}.yaml", initial="{kind: periodic}", metrics="{from: 0}")
    settled = run(
        examples / f"{name}.yaml",
        **{"initial": "{kind: steady}", "duration": 0.6, "metrics": "{from: 0.55}"},
    )
    for quantity in ("window_dynamic_factor", "window_transmission_error_peak_to_peak"):
        assert history[quantity].values == pytest.approx(settled[quantity].values, rel=1e-4)


@pytest.mark.parametrize("omega", [0.7, 1.3, 1.9])
def test_the_largest_multiplier_is_that_of_meissners_equation(run: Run, omega: float) -> None:
    """Stable at the first two frequencies; a warning between the boundaries of doubling."""
    case = rectangular(omega, 1, 1, "radau")
    del case["simulation"]["metrics"]
    case["simulation"]["initial"] = {"kind": "periodic"}
    history = run(case)
    scale = UNIT / OMEGA_1 * TEETH
    exact = float(np.abs(np.linalg.eigvals(monodromy(omega * scale, RATIO, 0.03))).max())
    assert history.attrs["start_multiplier"] == pytest.approx(exact, rel=1e-4)
    assert ("the periodic orbit is unstable" in history.attrs["warnings"]) == (exact > 1)
    assert ("the periodic orbit is unstable" in history.attrs["messages"]) == (exact > 1)


def test_the_common_period_is_named_if_it_is_longer_than_a_pitch(run: Run) -> None:
    for seed in (4, 5):
        history = run(periodic_case(seed))
        pitches = int(history.attrs["start_pitches"])
        assert (pitches > 1) == (f"orbit of {pitches} pitches" in history.attrs["messages"])
        assert "largest Floquet multiplier" in history.attrs["messages"]


def test_a_shaken_housing_has_a_periodic_start(run: Run) -> None:
    """Its motion repeats after three pitches."""
    case = periodic_case(5)
    speed = abs(case["wheels"][0]["loads"][0]["value"])
    term = {
        **{"kind": "harmonic", "axis": "x", "amplitude": 1e-6},
        "frequency": speed * case["wheels"][0]["teeth"] / (2 * math.pi) / 3,
    }
    case["housing"] = {"kind": "prescribed", "translation": [term]}
    case["wheels"][1]["support"] = {
        **{"kind": "bearing", "mass": 1.0},
        **{"stiffness": [1e8, 1e8], "damping": [1e3, 1e3]},
    }
    history = over_a_period(run, case)
    assert history.attrs["start_pitches"] == 3
    assert distance(history) <= 1e-9


# ---- rejected cases ------------------------------------------------------------------------------

WITHOUT = "a periodic start is refused: "
REFUSED: dict[str, tuple[str, dict[str, Any], str]] = {
    "rigid contact": (
        "paper-rigid.yaml",
        {},
        WITHOUT + "a rigid contact is a constraint, which radau does not integrate; start with "
        "simulation.initial.kind: steady",
    ),
    "tracked points": ("paper.yaml", {}, WITHOUT + "tracked contact points are algebraic states"),
    "mounted housing": (
        "spur-pair.yaml",
        {"housing": "{kind: mounted, mass: 30, inertia: [1, 1, 1], mount: {stiffness: "
                    "[1e7, 1e7, 1e7], rotational_stiffness: [1e6, 1e6, 1e6]}}"},
        WITHOUT + "the accelerations of a mounted housing are coupled",
    ),
    "table load": (
        "spur-pair.yaml",
        {"wheels.pinion.loads.0": "{kind: table, time: [0, 1], torque: [-50, -40]}"},
        WITHOUT + "there is no common period: the load is a table over time",
    ),
    "table of speeds": (
        "spur-pair.yaml",
        {"wheels.pinion.loads.0": "{kind: speed, time: [0, 1], speed: [-100, -90]}",
         "wheels.gear.loads.0": "{kind: torque, value: -80}"},
        WITHOUT + "there is no common period: the prescribed speed changes over time",
    ),
    "frequency without speed": (
        "spur-pair.yaml",
        {"wheels.pinion.loads.0": "{kind: harmonic, mean: -50, amplitude: 5, frequency: 30}"},
        WITHOUT + "there is no common period: the load depends on time, and no speed is prescribed",
    ),
    "housing that drifts": (
        "spur-pair.yaml",
        {"housing": "{kind: prescribed, translation: [{kind: rate, axis: x, value: 0.1}]}"},
        WITHOUT + "there is no common period: the housing moves, and not harmonically",
    ),
    "order that is no fraction": (
        "spur-pair.yaml",
        {"wheels.pinion.loads.0": "{kind: harmonic, mean: -50, amplitude: 5, order: 3.14159265}"},
        WITHOUT + "there is no common period: it makes",
    ),
    "long common period": (
        "spur-pair.yaml",
        {"wheels.pinion.loads": "[{kind: torque, value: -50}, "
                                f"{{kind: harmonic, amplitude: 5, order: {19 / 999!r}}}, "
                                f"{{kind: harmonic, amplitude: 5, order: {19 / 998!r}}}]"},
        "more than 1000",
    ),
    "prescribed speed against driving_rotation": (
        "spur-pair.yaml",
        {"wheels.pinion.loads": "[{kind: speed, value: 157}]",
         "wheels.gear.loads": "[{kind: torque, value: -80}]"},
        WITHOUT + "the wheels turn against driving_rotation",
    ),
    "drive flanks that are turned back": ( # (50 + 0.0375 omega) 34/19 = 100 at +157 rad/s
        "spur-pair.yaml",
        {"wheels.pinion.loads": "[{kind: torque, value: -50}, "
                                "{kind: viscous, coefficient: 0.0375}]",
         "wheels.gear.loads": "[{kind: torque, value: -100}]"},
        WITHOUT + "in the steady state the first mesh does not turn in its nominal sense",
    ),
    "gaps": (
        "spur-pair.yaml",
        {"simulation.initial": "{kind: periodic, gaps: {pinion-gear: 1e-6}}"},
        "gaps",
    ),
}  # fmt: skip


@pytest.mark.parametrize("name", REFUSED)
@pytest.mark.parametrize("command", ["run", "validate", "show"])
def test_what_has_no_periodic_start_is_refused_with_the_reason(
    evolvent: Evolvent, examples: Path, name: str, command: str
) -> None:
    example, settings, reason = REFUSED[name]
    words = [
        word
        for key, value in {"simulation.initial": "{kind: periodic}", **settings}.items()
        for word in ("--set", f"{key}={value}")
    ]
    done = evolvent(command, examples / example, *words)
    assert done.returncode == 3
    assert reason in done.stderr
    assert done.stderr.count("\n") == 1


def test_where_there_is_no_steady_state_there_is_no_periodic_start(
    evolvent: Evolvent, examples: Path
) -> None:
    done = evolvent(
        "run",
        examples / "spur-pair.yaml",
        "--set",
        PERIODIC,
        "--set",
        "wheels.pinion.loads.0.value=50",
    )
    assert done.returncode == 3
    assert "wrong sense for a steady state" in done.stderr


def test_a_search_that_is_interrupted_ends_with_75(
    executable: Path, examples: Path, tmp_path: Path
) -> None:
    """The search for two-stage.yaml takes seconds; no file is written."""
    process = subprocess.Popen(
        [executable, "run", examples / "two-stage.yaml", "-o", "h.h5", "--set", PERIODIC],
        cwd=tmp_path,
        stderr=subprocess.PIPE,
        text=True,
    )
    time.sleep(0.7)
    process.send_signal(signal.SIGTERM)
    _, messages = process.communicate(timeout=60)
    assert process.returncode == 75
    assert "the search for a periodic start was interrupted" in messages
    assert list(tmp_path.iterdir()) == []


RATTLE = (
    "meshes.0.damping={law: none}",
    "meshes.0.friction={law: none}",
    "wheels.pinion.loads=[{kind: speed, value: -1500}]",
    "wheels.gear.loads=[{kind: torque, value: -0.5}]",
    "wheels.pinion.eccentricity={amount: 20 um}",
)


def test_where_no_orbit_is_found_the_run_ends_with_4(
    evolvent: Evolvent, examples: Path, tmp_path: Path
) -> None:
    """A rattling undamped pair; validate does not search."""
    words = [word for setting in (PERIODIC, *RATTLE) for word in ("--set", setting)]
    assert evolvent("validate", examples / "spur-pair.yaml", *words).returncode == 0
    done = evolvent("run", examples / "spur-pair.yaml", "-o", "h.h5", *words)
    assert done.returncode == 4
    assert (
        "simulation.initial.kind: no periodic orbit was found from the steady start" in done.stderr
    )
    assert "the state still differs by" in done.stderr
    assert "a disturbance there grows by" in done.stderr
    assert "start with kind: steady and a longer duration" in done.stderr
    assert list(tmp_path.iterdir()) == []


def test_a_batch_starts_each_case_on_its_own_orbit(
    evolvent: Evolvent, examples: Path, tmp_path: Path
) -> None:
    """In any order, with the same metrics; rejected cases are recorded as such."""
    text = (examples / "spur-pair.yaml").read_text().replace("kind: steady", "kind: periodic")
    assert "kind: periodic" in text
    torques = [-50.0, -45.0, 50.0, -40.0]
    rows = []
    for order in (torques, torques[::-1]):
        folder = f"r{len(rows)}"
        columns = {"wheels.pinion.loads.0.value": order, "simulation.duration": [0.005] * 4}
        design = write_design(tmp_path / f"{folder}.h5", columns, case=text)
        assert evolvent("batch", design, "-o", folder).returncode == 1
        found = read_folder(tmp_path / folder)
        rows.append({torque: found[i] for i, torque in enumerate(order)})
    first, second = rows
    for torque in torques:
        assert first[torque]["status"] == ("refused" if torque > 0 else "done")
        for key, value in first[torque].items():
            if key not in ("case", "at", "cpu_time"):
                assert value == second[torque][key], key
