"""Orders of actual runs: reference position, and agreement with other results."""

from __future__ import annotations

import math
import subprocess
from pathlib import Path

import numpy as np
import pytest
import xarray as xr

from evolvent.commands.post.spectrum import make_spectrum
from evolvent.history import open_history
from evolvent.signals.selection import select
from evolvent.signals.turning import find_mesh, find_turning, nominal_speeds, ratio

RPM = math.pi / 30


@pytest.fixture(scope="module")
def train(executable: Path, examples: Path, tmp_path_factory: pytest.TempPathFactory) -> xr.Dataset:
    """Two stages of gears defined by a basic rack with shafts, a few pitches."""
    path = tmp_path_factory.mktemp("train") / "train.h5"
    case = examples / "two-stage-gears.yaml"
    words = ("-o", path, "-q", "--set", "simulation.duration=0.02")
    subprocess.run([executable, "run", case, *words], check=True, timeout=120)
    return open_history(path)


def test_pitches_from_the_start_of_contact_are_where_tooth_pairs_are(train):
    for mesh in ("first", "second"):
        drive = [pair for pair in train["pair"].values if str(pair).startswith("drive")]
        one = train.sel(mesh=mesh, pair=drive)
        xi = find_mesh(train, mesh).position(train)
        along = (one["pair_position"] - one["rho_start_driving"]) / one["base_pitch"]
        positions = (along + one["pair_number"]).where(one["pair_on_path"] == 1).values
        reported = np.isfinite(positions)
        assert reported.any(axis=1).all()
        # with fixed axes a contact is at the rotation of its driving flank
        error = positions - xi[:, None]
        assert abs(error[reported]).max() < 1e-9


def test_nominal_speeds_are_those_of_the_run(train):
    _, speeds = nominal_speeds(train)
    turned = train["angle"][-1].values - train["angle_deviation"][-1].values
    reference = train["reference_angle"][-1] + 2 * np.pi * train["reference_turns"][-1]
    np.testing.assert_allclose(
        [float(speed / speeds[0]) for speed in speeds], turned / float(reference), rtol=1e-12
    )
    assert [float(s) > 0 for s in speeds] == [bool(a > 0) for a in turned]
    motor, second = find_turning(train, "motor"), find_turning(train, "second")
    assert float(ratio(second, motor)) == pytest.approx(20 / 47 * 23, rel=1e-15)


def test_orders_are_the_harmonics_that_a_run_finds_between_its_events(
    evolvent, examples, tmp_path: Path
):
    """From 500 outputs per pitch, and without outputs.

    The initial vibration decays to 1e-5 and affects both slightly differently; forces have corners,
    whose orders above half of the outputs are aliased.
    """
    simulation = (
        "{duration: 0.04, output_interval: 4.2e-6, initial: {kind: steady}, metrics: {from: 0.02}}"
    )
    case = examples / "compliant-pair.yaml"
    run = evolvent("run", case, "-o", "run.h5", "-q", "--set", f"simulation={simulation}")
    assert run.returncode == 0, run.stderr
    for name, bound in (("transmission_error", 1e-4), ("normal_force", 1e-3)):
        with open_history(tmp_path / "run.h5") as history:
            periods = int(history["window_periods"])
            signal = select(history, name, {})
            found = make_spectrum(history, signal, "pinion-gear", periods, None, None)
            amplitude = history[f"window_{name}_amplitude"].values[0]
            expected = amplitude * np.exp(-1j * history[f"window_{name}_phase"].values[0])
            mean = float(history[f"window_{name}_mean"][0])
        lines = found.sel(order=np.arange(1, 11), method="nearest")
        reported = lines["amplitude"].values * np.exp(-1j * lines["phase"].values)
        assert abs(reported - expected).max() < bound * amplitude[0]
        assert float(found["amplitude"][0]) == pytest.approx(mean, rel=bound)


def test_orders_of_a_slow_run_are_the_harmonics_of_the_mesh_at_rest(
    evolvent, examples, tmp_path: Path
):
    """At 15 rpm the mesh frequency is 1/1500 of the natural frequency.

    The remainder is due to the tooth pairs' damping, 0.1 % of the harmonics at 150 rpm, and the 200
    positions per pitch of the static analysis, whose kinks alias 1e-4.
    """
    case, speed = examples / "compliant-pair.yaml", 15 * RPM
    settings = ("--set", "meshes.0.friction={law: none}")
    assert evolvent("static", case, "-o", "rest.h5", *settings).returncode == 0
    pitch = 2 * math.pi / (19 * speed)
    load = f"wheels.gear.loads.0={{kind: speed, value: {speed * 19 / 34!r}}}"
    run = evolvent(
        "run", case, "-o", "slow.h5", "-q", *settings, "--set", load,
        "--set", f"simulation.duration={3.1 * pitch!r}",
        "--set", f"simulation.output_interval={pitch / 200!r}",
    )  # fmt: skip
    assert run.returncode == 0, run.stderr
    with open_history(tmp_path / "slow.h5") as history:
        signal = select(history, "transmission_error", {})
        found = make_spectrum(history, signal, "pinion-gear", 3, None, None)
    with xr.open_dataset(tmp_path / "rest.h5", engine="h5netcdf") as rest:
        amplitude, angle = rest["harmonic_amplitude"].values[0], rest["harmonic_phase"].values[0]
        mean = float(rest["mean_transmission_error"][0])
    lines = found.sel(order=np.arange(1, 7), method="nearest")
    at_rest = amplitude[:6] * np.exp(1j * angle[:6])
    turning = lines["amplitude"].values * np.exp(-1j * lines["phase"].values)
    assert abs(turning - at_rest).max() < 2e-3 * amplitude[0]
    assert float(found["amplitude"][0]) == pytest.approx(mean, rel=1e-4)
