"""Outputs at pitches of a mesh and revolutions of a wheel: their positions and values."""

from __future__ import annotations

import re
import subprocess
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import xarray as xr
import yaml

from system.cases import pair
from system.real_cases import real_pair, speed, torque, viscous
from system.runs import Run, Runs

INTEGRATORS = ("radau", "ida")
FORWARDS, OFF_GRID, BACKWARDS = 0, 1, 2
# A row's position is accurate to 1e-9 of the grid; the rest is rounding of angles in the history.
EXACT = 2e-9
COUNTS = ("steps", "residuals", "jacobians", "linear_setups", "newton_iterations", "rejections")


def steady(output: dict[str, Any] | None, **simulation: Any) -> dict[str, Any]:
    """A pair of gears with 19 and 34 teeth and a steady start at 157 rad/s."""
    wheels = (torque(-50.0), viscous(1.0193))
    mesh = {"damping": {"law": "ratio", "value": 0.07}}
    return real_pair((19, 34), wheels=wheels, mesh=mesh, **by(output, **simulation))


def by(output: dict[str, Any] | None, **simulation: Any) -> dict[str, Any]:
    """Settings of a simulation with outputs by position, or by time if that is None."""
    settings: dict[str, Any] = {"duration": 0.02, "initial": {"kind": "steady"}, **simulation}
    if output is not None:
        settings |= {"output": output, "output_interval": None}
    return settings


def run(runs: Runs, case: dict[str, Any]) -> Run:
    """Run a case without the keys of its simulation that are None."""
    kept = {key: value for key, value in case["simulation"].items() if value is not None}
    return runs({**case, "simulation": kept})


def pitches(run: Run, wheel: int, sense: int) -> np.ndarray:
    """Pitches of rotation of a wheel from angle 0, from its angle in the history."""
    teeth = run.history["teeth"].values[wheel]
    return np.asarray(sense * run.history["angle"].values[:, wheel] * teeth / (2 * np.pi))


def check_grid(history: xr.Dataset, number: int) -> None:
    """Properties for any motion: a row at each grid line passed, with its kind."""
    time, position = history["time"].values, history["output_position"].values
    kind = history["output_kind"].values
    assert np.all(np.diff(time) > 0.0)
    assert np.all(kind[1:-1] != OFF_GRID)
    line = position * number
    on_grid = kind != OFF_GRID
    np.testing.assert_array_equal(np.round(line[on_grid]) / number, position[on_grid])
    inside = slice(1 if kind[0] == OFF_GRID else 0, -1)
    steps = np.diff(np.round(line[inside]))
    assert set(steps) <= {-1.0, 0.0, 1.0}
    np.testing.assert_array_equal(kind[inside][1:][steps > 0], FORWARDS)
    np.testing.assert_array_equal(kind[inside][1:][steps < 0], BACKWARDS)


# ---- positions -----------------------------------------------------------------------------------


@pytest.mark.parametrize("integrator", INTEGRATORS)
def test_rows_of_a_steady_pair_stand_at_pitches_of_its_pinion(runs: Runs, integrator: str):
    start = {"kind": "steady", "position": 0}
    case = steady({"per_pitch": 16, "mesh": "pinion-gear"}, integrator=integrator, initial=start)
    done = run(runs, case)
    history = done.history
    check_grid(history, 16)
    assert done.exit_code == 0
    assert (history["time"].values[0], history["time"].values[-1]) == (0.0, 0.02)
    kind = history["output_kind"].values
    assert np.all(kind[:-1] == FORWARDS)
    assert kind[-1] == OFF_GRID
    # pair 0 of the first mesh starts at the start of contact
    np.testing.assert_array_equal(
        history["output_position"].values[:-1], np.arange(history.sizes["time"] - 1) / 16
    )
    xi = pitches(done, 0, -1)
    np.testing.assert_allclose(16 * xi, 16 * history["output_position"], rtol=0.0, atol=EXACT)
    assert 9.0 < xi[-1] < 10.0
    reported = [history.attrs[f"output_{key}"] for key in ("per", "number", "of")]
    assert reported == ["pitch", 16, "pinion-gear"]
    assert "pinion-gear" in history["output_position"].attrs["long_name"]


@pytest.mark.parametrize("integrator", INTEGRATORS)
def test_rows_of_a_run_up_stand_at_turns_of_the_gear(runs: Runs, integrator: str):
    """From rest, so the first revolutions take long; the gear's angle has its own deviation."""
    wheels = (torque(-5.0), viscous(0.02))
    settings = by(
        {"per_turn": 60, "wheel": "gear"},
        duration=0.15,
        initial={"kind": "rest"},
        integrator=integrator,
    )
    mesh = {"damping": {"law": "ratio", "value": 0.07}}
    done = run(runs, real_pair((19, 34), wheels=wheels, mesh=mesh, **settings))
    check_grid(done.history, 60)
    turns = done.history["angle"].values[:, 1] / (2 * np.pi)
    np.testing.assert_allclose(
        60 * turns, 60 * done.history["output_position"], rtol=0.0, atol=EXACT
    )
    forwards = done.history["output_kind"].values == FORWARDS
    assert np.count_nonzero(forwards) == 1 + int(60 * turns[-1])
    assert turns[-1] > 3.0
    assert done.history.attrs["output_per"] == "turn"


def test_positions_are_where_tooth_pairs_are_on_their_paths(runs: Runs, examples: Path):
    """For the second mesh of a train, whose pair 0 has any start: pair k is xi - k pitches past the
    start of its path, by rho_A of its contact with fixed axes.
    """
    case = yaml.safe_load((examples / "two-stage-gears.yaml").read_text(encoding="utf-8"))
    for wheel in case["wheels"]:
        wheel["support"] = {"kind": "fixed"}
    case["simulation"] = by({"per_pitch": 10, "mesh": "second"}, duration=0.02)
    history = run(runs, case).history
    check_grid(history, 10)
    assert np.count_nonzero(history["output_kind"] == FORWARDS) > 20
    mesh = history.sel(mesh="second")
    drive = mesh["pair"].str.startswith("drive")
    there = (mesh["pair_on_path"] == 1) & drive
    xi = (
        mesh["pair_number"]
        + (mesh["pair_position"] - mesh["rho_start_driving"]) / (mesh["base_pitch"])
    )
    off = (10 * (xi - history["output_position"])).where(there)
    assert int(there.sum()) > 20
    # rho_A is accurate to rounding of the radii, 1e-14 of a pitch or so
    assert float(abs(off).max()) < EXACT
    assert not np.isclose(float(history["output_position"][0]) % 1.0, 0.0)


def test_positions_are_those_of_the_static_analysis(runs: Runs, executable: Path, tmp_path: Path):
    """At low speed the transmission error at each position is the quasi-static one."""
    wheels = (speed(-0.5), torque(-89.5))
    mesh = {"damping": {"law": "ratio", "value": 0.07}}
    settings = by({"per_pitch": 25, "mesh": "pinion-gear"}, duration=1.5)
    case = real_pair((19, 34), wheels=wheels, mesh=mesh, **settings)
    done = run(runs, case)
    output = tmp_path / "static.h5"
    drive = 89.5 * 19 / 34
    subprocess.run(
        [
            *(executable, "static", done.path.with_suffix(".yaml"), "-q", "-o", output),
            *("--torque", f"{drive:.17g}", "--points", "25"),
        ],
        check=True,
    )
    with xr.open_dataset(output) as static:
        at_rest = static["transmission_error"].values[0]
    history = done.history.isel(time=done.history["output_kind"].values == FORWARDS)
    position = np.round(25 * history["output_position"].values).astype(int) % 25
    assert position.size > 50
    # Inertia and damping at 1.5 pitches a second; most at entry or exit of a pair.
    np.testing.assert_allclose(
        history["transmission_error"].values[:, 0],
        at_rest[position],
        rtol=0.0,
        atol=1e-3 * at_rest.max(),
    )


# ---- reversal, standstill, positions not reached -------------------------------------------------


@pytest.mark.parametrize("integrator", INTEGRATORS)
def test_a_wheel_that_swings_passes_positions_both_ways(runs: Runs, integrator: str):
    load = {"kind": "harmonic", "amplitude": 3.0, "frequency": 20.0, "phase": 90.0}
    wheels = ({"loads": [load]}, viscous(0.01))
    mesh = {"damping": {"law": "ratio", "value": 0.07}, "backlash": 5e-5}
    settings = by(
        {"per_pitch": 8, "mesh": "pinion-gear"},
        duration=0.2,
        initial={"kind": "rest"},
        integrator=integrator,
    )
    done = run(runs, real_pair((19, 34), wheels=wheels, mesh=mesh, **settings))
    history = done.history
    check_grid(history, 8)
    kinds = np.bincount(history["output_kind"].values, minlength=3)
    assert kinds[FORWARDS] > 20
    assert kinds[BACKWARDS] > 20
    np.testing.assert_allclose(
        8 * pitches(done, 0, -1), 8 * history["output_position"], rtol=0.0, atol=EXACT
    )
    backwards = history["angular_velocity"].values[:, 0] > 0.0  # clockwise is forwards
    assert np.all(backwards[history["output_kind"].values == BACKWARDS])
    assert not np.any(backwards[1:][history["output_kind"].values[1:] == FORWARDS])


@pytest.mark.parametrize("integrator", INTEGRATORS)
def test_a_wheel_that_is_held_gives_two_rows_and_a_remark(runs: Runs, integrator: str):
    settings = by(
        {"per_pitch": 10, "mesh": "pinion-gear"},
        duration=0.1,
        initial={"kind": "rest"},
        integrator=integrator,
    )
    wheels, mesh = (torque(-5.0), speed(0.0)), {"damping": {"law": "ratio", "value": 0.07}}
    done = run(runs, real_pair((19, 34), wheels=wheels, mesh=mesh, **settings))
    assert done.exit_code == 0
    assert done.history["output_kind"].values.tolist() == [FORWARDS, OFF_GRID]
    remark = done.history.attrs["status_message"]
    assert re.fullmatch(
        r"output by pitch: mesh pinion-gear moved \S+e-05 pitches, from 0 to \S+e-05, "
        r"less than one: 0 positions forwards, 0 backwards",
        remark,
    )
    assert remark in done.messages


def test_a_run_that_gets_there_has_no_remark_and_one_that_turns_too_little_says_how_far(runs: Runs):
    far = run(runs, steady({"per_pitch": 4, "mesh": "pinion-gear"}))
    near = run(runs, steady({"per_turn": 4, "wheel": "gear"}))
    assert far.history.attrs["status_message"] == ""
    remark = near.history.attrs["status_message"]
    assert re.search(
        r"wheel gear moved 0\.27\d+ turns, from 0\.00.*: 1 position forwards, 0 backwards", remark
    )


# ---- values, and what does not change ------------------------------------------------------------


@pytest.mark.parametrize("integrator", INTEGRATORS)
def test_a_row_shows_what_an_output_at_its_time_shows(runs: Runs, integrator: str):
    """To the bit for radau; IDA locates events between outputs, with different rounding."""
    output = {"per_pitch": 3, "mesh": "pinion-gear"}
    history = run(runs, steady(output, integrator=integrator)).history
    for row in (1, 7, 20):
        time = float(history["time"][row])
        timed = run(runs, steady({"interval": time}, integrator=integrator)).history
        assert float(timed["time"][1]) == time
        for name, variable in timed.data_vars.items():
            if "time" in variable.dims:
                here, there = history[name].values[row], variable.values[1]
                if integrator == "radau":
                    np.testing.assert_array_equal(here, there, str(name))
                else:
                    scale = np.nanmax(np.abs(variable.values), initial=1e-300)
                    np.testing.assert_allclose(here, there, rtol=0.0, atol=1e-5 * scale)


def test_steps_and_events_of_radau_do_not_depend_on_outputs(runs: Runs):
    """Nor do the extremes; the rows of any two outputs are on the same motion."""
    outputs: list[dict[str, Any]] = [
        {"interval": 1e-4},
        {"per_pitch": 16, "mesh": "pinion-gear"},
        {"per_turn": 1000, "wheel": "gear"},
    ]
    first, *others = [run(runs, steady(output, integrator="radau")) for output in outputs]
    for other in others:
        for count in COUNTS:
            name = f"integrator_{count}"
            assert first.history.attrs.get(name) == other.history.attrs.get(name)
        xr.testing.assert_identical(first.events, other.events)
        for name in ("normal_force_max", "normal_force_max_time", "transmission_error_min"):
            np.testing.assert_array_equal(first.history[name], other.history[name])
        for name in first.history.data_vars:
            if "time" in first.history[name].dims:
                np.testing.assert_array_equal(
                    first.history[name].values[-1], other.history[name].values[-1]
                )


def test_rows_between_events_show_the_teeth_that_events_left(runs: Runs):
    """The oldest pair on the path at a row is that of the last event before it."""
    case = pair(duration=8, output={"per_pitch": 7, "mesh": "pinion-gear"}, output_interval=None)
    done = run(runs, case)
    switches = done.events["kind"].values == "tooth_switch"
    times, pairs = (done.events[name].values[switches] for name in ("time", "tooth_pair"))
    assert times.size >= 2
    for time, tooth_pair in zip(
        done.history["time"].values, done.history["tooth_pair"].values[:, 0], strict=True
    ):
        before = times < time
        assert tooth_pair == (pairs[before][-1] if before.any() else 0)


def test_an_interval_in_the_block_is_the_output_interval(runs: Runs):
    """A history by time contains no positions."""
    one = run(runs, steady({"interval": 1e-3}))
    two = run(runs, steady(None, output_interval=1e-3))
    for name in two.history.data_vars:
        np.testing.assert_array_equal(one.history[name], two.history[name])
    assert not [name for name in one.history.variables if str(name).startswith("output")]
    assert not [name for name in one.history.attrs if name.startswith("output")]


def test_a_run_that_fails_ends_with_a_row_off_the_grid(runs: Runs):
    case = steady({"per_pitch": 16, "mesh": "pinion-gear"}, initial={"kind": "rest"})
    load = {"kind": "table", "time": [0, 0.01, 0.0101], "torque": [-50, -50, -1e9]}
    case["wheels"][0]["loads"] = [load]
    done = run(runs, case)
    assert done.exit_code == 4
    check_grid(done.history, 16)
    assert done.history["output_kind"].values[-1] == OFF_GRID


@pytest.mark.parametrize(
    ("example", "mesh"), [("spur-pair.yaml", "pinion-gear"), ("two-stage-gears.yaml", "second")]
)
def test_sums_over_rows_are_the_harmonics_that_the_run_found(
    runs: Runs, examples: Path, example: str, mesh: str
):
    """Metrics are integrals over time, independent of rows; both count pitches alike."""
    case = yaml.safe_load((examples / example).read_text(encoding="utf-8"))
    numbers = {"from": 0.01, "pitches_of": mesh}
    case["simulation"] = by({"per_pitch": 512, "mesh": mesh}, duration=0.03, metrics=numbers)
    history = run(runs, case).history
    begin, end = (float(history[f"window_{side}"]) for side in ("begin", "end"))
    time, position = history["time"].values, history["output_position"].values
    # The window starts and ends at whole pitches, to the rounding of times.
    inside = (time > begin - 1e-12) & (time < end - 1e-12)
    np.testing.assert_array_equal(position[inside][[0, -1]] % 1.0, [0.0, 511 / 512])
    assert np.all(history["output_kind"].values[inside] == FORWARDS)
    error = history.sel(mesh=mesh)["transmission_error"].values[inside]
    waves = np.exp(2j * np.pi * np.outer(np.arange(1, 11), position[inside]))
    found = 2 * waves @ error / error.size
    amplitude, phase = (
        history.sel(mesh=mesh)[f"window_transmission_error_{part}"].values
        for part in ("amplitude", "phase")
    )
    # 512 samples per pitch alias orders above the 256th.
    expected = amplitude * np.exp(1j * phase)
    np.testing.assert_allclose(found, expected, rtol=0.0, atol=2e-4 * amplitude.max())
