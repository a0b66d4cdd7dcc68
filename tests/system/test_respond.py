"""`evolvent respond`: motions over a parameter swept up and down."""

from __future__ import annotations

import math
import signal
import subprocess
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import xarray as xr
import yaml

from processes import catches, wait_for
from system.test_metrics import BASE, FORCE, INERTIA, RATIO, STIFFNESS, TEETH, rectangular

Respond = Callable[..., xr.Dataset]
UNIT = math.sqrt(STIFFNESS * RATIO) * BASE / math.sqrt(INERTIA) / TEETH  # rad/s of omega = 1
SPEED = "wheels.a.loads.0.value"


def speeds(first: float, last: float, step: float = 0.005) -> str:
    """Option for frequencies relative to that of the mean stiffness."""
    return f"{SPEED}={-first * UNIT!r}:{-last * UNIT!r}:{round(abs(last - first) / step) + 1}"


def write_rectangular(folder: Path) -> Path:
    """Write the oscillator with rectangular stiffness, whose flanks may separate."""
    case = rectangular(1.0, 1, 1, "radau")
    del case["simulation"]["metrics"]
    path = folder / "rectangular.yaml"
    path.write_text(yaml.safe_dump(case))
    return path


@pytest.fixture
def respond(evolvent: Callable[..., subprocess.CompletedProcess[str]], tmp_path: Path) -> Respond:
    """Return a function that computes the response over a range of the oscillator's frequency."""
    case = write_rectangular(tmp_path)

    def run(over: str, *options: Any) -> xr.Dataset:
        path = tmp_path / "response.h5"
        result = evolvent("respond", case, "--over", over, "-o", path, "-q", *options)
        assert result.returncode == 0, result.stderr
        with xr.open_dataset(path, engine="h5netcdf") as file:
            return file.load()

    return run


def deviation(response: xr.Dataset, direction: str, omega: float) -> float:
    """Standard deviation of the transmission error over F/k."""
    reported = response["transmission_error_standard_deviation"].sel(direction=direction)
    return float(reported.sel(parameter=-omega * UNIT, method="nearest")[0]) / (FORCE / STIFFNESS)


def period(response: xr.Dataset, direction: str, omega: float) -> int:
    reported = response["period"].sel(direction=direction)
    return int(reported.sel(parameter=-omega * UNIT, method="nearest"))


def jumps(response: xr.Dataset) -> list[tuple[float, float]]:
    """Frequencies between which the motion jumps."""
    ends = (response["jump_before"].values / -UNIT, response["jump_after"].values / -UNIT)
    return list(zip(*(end.tolist() for end in ends), strict=True))


@pytest.mark.parametrize(
    ("omega", "expected"), [(0.7, 0.363006711), (1.3, 0.182425960), (2.0, 0.652445783)]
)
def test_numbers_are_those_of_an_independent_program(respond, omega, expected):
    """Values of an event-driven integration of the independent oscillator, as in test_metrics."""
    response = respond(speeds(omega, omega + 0.005), "--up")
    assert deviation(response, "up", omega) == pytest.approx(expected, rel=1e-5)
    assert period(response, "up", omega) == (2 if omega == 2.0 else 1)
    assert (response["followed"] < 300).all()  # two periods are detected as soon as one


def test_motion_jumps_up_where_the_flanks_part(respond):
    """Of another program: 0.4975 at 0.750 and 1.3310 at 0.755, with all its printed digits."""
    response = respond(speeds(0.7, 0.765), "--up")
    assert deviation(response, "up", 0.75) == pytest.approx(0.4975, abs=6e-5)
    assert deviation(response, "up", 0.755) == pytest.approx(1.3310, abs=6e-5)
    ((before, after),) = jumps(response)
    assert 0.75 < before < after < 0.755
    assert after - before == pytest.approx(0.005 / 2**10, rel=1e-6)  # it was halved ten times
    assert response["period"].values.tolist() == [[1] * 14]


def test_a_motion_that_winds_itself_to_an_orbit_is_followed_until_it_is_there(respond):
    """It nearly repeats after some periods sooner than after one; then the error was 1e-4."""
    response = respond(speeds(2.18, 2.185), "--up")
    assert response["period"].values.tolist() == [[1, 1]]
    assert (response["repeat_distance"].values <= 1e-6).all()
    found = respond(
        f"{SPEED}={-2.18 * UNIT!r}:{-2.185 * UNIT!r}", "--method", "orbits", "--longest", "1"
    )
    name = "transmission_error_standard_deviation"
    at = int(np.argmin(np.abs(found["orbit_parameter"].values + 2.18 * UNIT)))
    reported, exact = float(response[name][0, 0, 0]), float(found[name][at, 0])
    assert reported == pytest.approx(exact, rel=2e-5)  # 1e-6 of a scale, over 1 - 0.89


def test_a_motion_that_creeps_to_its_orbit_is_not_there_when_its_steps_are_small(respond):
    """Near a period doubling hardly anything decays in two periods: many such steps remain."""
    response = respond(speeds(1.83, 1.84), "--up")
    followed, apart = (response[name].values[0] for name in ("followed", "repeat_distance"))
    assert followed[-1] > 500  # the maximum; its steps are below 1e-6 after 337
    assert apart[-1] < 0.2e-6
    assert (followed[:2] < 400).all()


@pytest.mark.parametrize(("ratio", "periods"), [(1.6, 4), (1.5, 5)])
def test_passes_of_a_section_that_had_to_move_do_not_count(tmp_path, evolvent, ratio, periods):
    """A slow and damped motion repeats from its first pitch.

    Three crossings of its section detect that, and its metrics take one period more. A pair leaves
    its path at 0.6 of a pitch, or at half of one, at the section: it is moved, and restarts.
    """
    case = rectangular(0.02, 1, 1, "radau")
    del case["simulation"]["metrics"]
    case["simulation"]["initial"] = {"kind": "steady", "position": 0}
    base_pitch, distance = 2 * math.pi * BASE / TEETH, case["meshes"][0]["centre_distance"]
    contact = (ratio * base_pitch + math.sqrt(distance**2 - 4 * BASE**2)) / 2
    for wheel in case["wheels"]:
        wheel["tip_diameter"] = 2 * math.hypot(BASE, contact)
    case["meshes"][0]["damping"]["value"] = 0.8
    (tmp_path / "slow.yaml").write_text(yaml.safe_dump(case))
    over, path = speeds(0.02, 0.0202, 0.0002), tmp_path / "r.h5"
    result = evolvent("respond", tmp_path / "slow.yaml", "--over", over, "--up", "-o", path, "-q")
    assert result.returncode == 0, result.stderr
    with xr.open_dataset(path, engine="h5netcdf") as response:
        assert response["followed"].values[0, 0] == periods
        assert response["period"].values[0, 0] == 1


def test_period_doubles_where_the_mesh_excites_the_second_order(respond):
    response = respond(speeds(1.84, 1.87), "--up")
    assert [period(response, "up", omega) for omega in (1.85, 1.855, 1.86, 1.865)] == [2] * 4
    assert deviation(response, "up", 1.84) < 0.1 < 0.8 < deviation(response, "up", 1.85)
    assert ((response["followed"] > 1) & (response["followed"] <= 600)).all()


def test_the_last_line_counts_values_by_the_period_of_their_motion(tmp_path, evolvent):
    """Near a period doubling a motion settles slowly: some still do so after 300 periods."""
    path = tmp_path / "r.h5"
    result = evolvent(
        *("respond", write_rectangular(tmp_path), "--over", speeds(1.82, 1.88, 0.01), "--up"),
        *("--periods", "300", "-o", path),
    )
    assert result.returncode == 0, result.stderr
    with xr.open_dataset(path, engine="h5netcdf") as file:
        period, n_jumps = file["period"].values, file.sizes["jump"]
        apart = file["repeat_distance"].values
    n_other, n_wild = int((period > 1).sum()), int((period == 0).sum())
    n_settling = int((period == -2).sum())
    assert n_other > n_wild > 0
    assert (apart[period == 0] < 0.1).all()  # of the nearest orbit; the farthest differs by 0.7
    jumps_found = f"{n_jumps} jump{'' if n_jumps == 1 else 's'}"
    assert result.stderr.splitlines()[-1] == (
        f"evolvent: 7 values, {n_other} with a period of 2 and more, {n_wild} not periodic, "
        f"{n_settling} still settling, {jumps_found}: {path}"
    )


def test_motion_of_two_periods_is_kept_on_the_way_down(respond):
    """Below 0.825 it falls to the motion of one period, with 1.0698 in another program."""
    response = respond(speeds(0.8, 2.1), "--down")
    assert all(period(response, "down", omega) == 2 for omega in np.arange(1.0, 2.1, 0.05))
    assert deviation(response, "down", 0.83) > 5
    ((before, after),) = [pair for pair in jumps(response) if pair[0] < 1]
    assert 0.815 < after < before < 0.83
    up = respond(speeds(0.825, 0.83), "--up")
    assert deviation(response, "down", 0.815) == pytest.approx(1.1032, abs=1e-3)
    assert deviation(up, "up", 0.825) == pytest.approx(1.0698, abs=6e-5)


@pytest.mark.parametrize(
    ("first", "last", "known"),
    [
        (0.43, 0.8, {0.44: {1: 0.5833, 2: 4.484}, 0.435: {1: 0.5246, 2: 4.603}}),
        (0.825, 2.1, {0.83: {1: 1.0535, 8: 5.114}, 0.825: {1: 1.0698, 16: 5.179}}),
    ],
)
def test_stable_orbits_are_those_between_which_plain_steps_fall(respond, first, last, known):
    """Another program falls to 1.0698 at 0.825 and to 0.5246 at 0.435."""
    count = round((last - first) / 0.005) + 1
    over = f"{SPEED}={-first * UNIT!r}:{-last * UNIT!r}"
    found = respond(over, "--method", "orbits", "--values", count)
    found = found.isel(point=found["orbit_stable"].values == 1)
    reported = found["transmission_error_standard_deviation"].values[:, 0] / (FORCE / STIFFNESS)
    for omega, orbits in known.items():
        there = found["orbit_value"].values == round((omega - first) / 0.005)
        periods = found["orbit_period"].values[there].tolist()
        assert dict(zip(periods, reported[there], strict=True)) == pytest.approx(orbits, abs=5e-4)


def test_down_goes_on_from_where_up_ended(respond):
    """Between both jumps there are two motions, selected by the direction of the sweep."""
    response = respond(speeds(0.70, 0.77, 0.01))
    assert response["direction"].values.tolist() == ["up", "down"]
    assert deviation(response, "up", 0.77) == pytest.approx(
        deviation(response, "down", 0.77), rel=1e-5
    )
    assert deviation(response, "down", 0.73) > 2 * deviation(response, "up", 0.73)


def test_interrupted_and_killed_it_goes_on_with_the_same_bits(tmp_path, evolvent, executable):
    case = write_rectangular(tmp_path)
    over = speeds(1.3, 1.8, 0.00075)
    whole, stopped = tmp_path / "whole.h5", tmp_path / "stopped.h5"
    folder = tmp_path / "stopped.h5.parts"
    command = [executable, "respond", case, "--over", over, "--up", "-q", "-o", stopped]
    for sent in (signal.SIGINT, signal.SIGKILL):
        kept = folder / "checkpoint.h5"
        before = kept.stat().st_mtime_ns if kept.exists() else 0
        with subprocess.Popen(command, stderr=subprocess.PIPE, text=True) as process:
            wait_for(
                lambda kept=kept, before=before: kept.exists() and kept.stat().st_mtime_ns > before
            )
            process.send_signal(sent)
            _, messages = process.communicate(timeout=30)
        if sent == signal.SIGINT:
            assert process.returncode == 75
            assert "repeat the command to continue" in messages
            with xr.open_dataset(f"{stopped}.partial", engine="h5netcdf") as partial:
                done = int(partial.attrs["values_done"])
                assert partial.attrs["status"] == "interrupted"
                assert 0 < done == int((partial["period"] >= 0).sum())
        else:
            assert process.returncode == -signal.SIGKILL
        assert not stopped.exists()
    for path in (stopped, whole):
        result = evolvent("respond", case, "--over", over, "--up", "-q", "-o", path)
        assert result.returncode == 0, result.stderr
    assert not folder.exists()
    with (
        xr.open_dataset(stopped, engine="h5netcdf") as a,
        xr.open_dataset(whole, engine="h5netcdf") as b,
    ):
        xr.testing.assert_identical(a.load(), b.load())


def test_who_is_interrupted_does_not_wait_for_the_check_of_all_values(tmp_path, executable):
    case = write_rectangular(tmp_path)
    path = tmp_path / "r.h5"
    command = [executable, "respond", case, "--over", speeds(1.3, 2.1, 1e-5)]
    # the check takes some hundred microseconds per value: half a minute in all
    with subprocess.Popen([*command, "-o", path], stderr=subprocess.PIPE, text=True) as process:
        wait_for(lambda: catches(process.pid, signal.SIGINT))
        process.send_signal(signal.SIGINT)
        _, messages = process.communicate(timeout=15)
    assert process.returncode == 75
    assert "0 of 160002 values are done" in messages


def test_kept_state_of_another_response_is_refused(tmp_path, evolvent, executable):
    case = write_rectangular(tmp_path)
    path = tmp_path / "r.h5"
    command = [executable, "respond", case, "--over", speeds(1.3, 2.1, 0.001), "-q", "-o", path]
    with subprocess.Popen(command, stderr=subprocess.PIPE, text=True) as process:
        wait_for(lambda: (tmp_path / "r.h5.parts" / "checkpoint.h5").exists())
        process.send_signal(signal.SIGTERM)
        process.communicate(timeout=30)
    result = evolvent("respond", case, "--over", speeds(1.3, 2.0, 0.001), "-q", "-o", path)
    assert result.returncode == 3
    assert "another incomplete response" in result.stderr.splitlines()[-1]


def test_common_period_is_that_of_all_meshes(tmp_path, evolvent, examples):
    """23 teeth of the second mesh's driving wheel for the 47 of the gear on the same shaft."""
    path = tmp_path / "r.h5"
    result = evolvent(
        *("respond", examples / "two-stage-gears.yaml"),
        *("--over", "meshes.first.damping.value=0.05:0.1:2", "--up", "-q", "-o", path),
    )
    assert result.returncode == 0, result.stderr
    with xr.open_dataset(path, engine="h5netcdf") as response:
        assert response["common_period"].values.tolist() == [[47, 47]]
        assert response["period"].values.tolist() == [[1, 1]]


def test_harmonic_loads_count_in_the_common_period(tmp_path, evolvent):
    """Three cycles of the load in two pitches."""
    case = write_rectangular(tmp_path)
    mean = -FORCE * BASE
    pitch_rate = UNIT * TEETH / (2 * math.pi)
    load = (
        f"{{kind: harmonic, mean: {mean}, amplitude: {0.1 * mean}, "
        f"frequency: {1.5 * pitch_rate!r}}}"
    )
    path = tmp_path / "r.h5"
    options = ("--set", f"{SPEED}={-UNIT!r}", "--set", f"wheels.b.loads.0={load}")
    result = evolvent(
        *("respond", case, "--over", f"wheels.b.loads.0.mean={mean!r}:{1.1 * mean!r}:2"),
        *("--up", "-q", "-o", path, *options),
    )
    assert result.returncode == 0, result.stderr
    with xr.open_dataset(path, engine="h5netcdf") as response:
        assert response["common_period"].values.tolist() == [[2, 2]]
        assert response["period"].values.tolist() == [[1, 1]]
    result = evolvent("respond", case, "--over", speeds(1, 1.23456, 0.23456), "-o", path, *options)
    assert result.returncode == 3
    assert "there is no common period" in result.stderr.splitlines()[-1]


@pytest.mark.parametrize(
    ("over", "code", "parts"),
    [
        ("wheels.a.teeth=20:40", 2, ["structure"]),
        ("wheels.a.loads.0.kind=1:2", 3, ["must be one of"]),
        (f"{SPEED}=-500:-500", 2, ["the same value"]),
        (f"{SPEED}=-500:-600:1", 2, ["from 2 to 100000"]),
        (f"{SPEED}=-500", 2, ["PATH=FROM:TO"]),
        ("wheels.a.loads.0.valu=-500:-600", 3, ["did you mean 'value'"]),
        ("simulation.duration=1:2", 2, ["a setting of the simulation"]),
        ("wheels.b.loads.0.value=-1 rpm:-2 rpm", 3, ["rpm"]),
        ("meshes.ab.contact.stiffness=3e8:-3e8:3", 3, ["greater than 0"]),
        (f"{SPEED}=-500:500:3", 3, ["no common period"]),
        (f"{SPEED}=500:600:3", 3, ["driving_rotation"]),
    ],
)
def test_what_cannot_be_is_refused_in_one_line(tmp_path, evolvent, over, code, parts):
    case = write_rectangular(tmp_path)
    result = evolvent("respond", case, "--over", over, "-o", tmp_path / "r.h5")
    assert result.returncode == code, result.stderr
    (line,) = result.stderr.splitlines()
    for part in parts:
        assert part in line
    assert not (tmp_path / "r.h5").exists()
    assert not (tmp_path / "r.h5.parts").exists()


def test_a_list_of_the_case_is_no_parameter_with_one_value(tmp_path, evolvent):
    """Pitch errors of the case: a single number is not a valid value of this key."""
    case = write_rectangular(tmp_path)
    errors = f"wheels.a.pitch_errors={[1e-6] * TEETH}"
    over = ("--over", "wheels.a.pitch_errors=0:1e-6:2")
    result = evolvent("respond", case, *over, "--set", errors, "-o", tmp_path / "r.h5")
    assert result.returncode == 2
    assert result.stderr == (
        "--over wheels.a.pitch_errors: a list of numbers is not a parameter with one value\n"
    )


def test_a_motion_that_fails_says_how_far_it_came(tmp_path, evolvent, examples):
    """Under 20 kN m the teeth deflect by more than their distance."""
    path = tmp_path / "r.h5"
    load = "wheels.gear.loads.0"
    settings = (
        f"{load}={{kind: torque, value: -178.9}}",
        "wheels.pinion.loads.0={kind: speed, value: -157}",
        *(f"wheels.{wheel}.compliance={{model: analytic}}" for wheel in ("pinion", "gear")),
    )
    result = evolvent(
        *("respond", examples / "compliant-pair.yaml", "--over", f"{load}.value=-178:-40000:3"),
        *("--up", "-o", path, *(word for text in settings for word in ("--set", text))),
    )
    assert result.returncode == 4, result.stderr
    line = result.stderr.splitlines()[-1]
    assert f"{load}.value=-20089: " in line
    assert "1 of 3 values are done" in line
    with xr.open_dataset(f"{path}.partial", engine="h5netcdf") as response:
        assert response.attrs["status"] == "failed"
        assert response["period"].values.tolist() == [[1, -1, -1]]
        assert np.isfinite(response["normal_force_mean"].values[0, 0]).all()
        assert np.isnan(response["normal_force_mean"].values[0, 1:]).all()
