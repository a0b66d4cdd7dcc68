"""A speed that is given to a wheel in a housing that turns, seen from the ground or the housing."""

from __future__ import annotations

import subprocess
from collections.abc import Callable
from math import cos, pi, radians
from pathlib import Path

import h5py
import pytest

from fmu.importer import Make, model, slave
from fmu.test_by_hand import pair_case, written

Evolvent = Callable[..., subprocess.CompletedProcess[str]]

DURATION, RAMP = 0.02, 1000.0  # s, rad/s^2
TURNS = "{kind: harmonic, axis: z, amplitude: 1, frequency: 20}"  # degrees, Hz


def spin(t: float) -> float:
    """Of that housing."""
    return radians(1) * 2 * pi * 20 * cos(2 * pi * 20 * t)


def turning_case(load: str, seen: float) -> str:
    """A pair whose first wheel starts at a speed in the housing."""
    start = f"{{kind: speeds, speeds: {{a: {seen!r}, b: {-seen * 20 / 30!r}}}}}"
    case = pair_case(load).replace("{kind: rest}", start)
    return f"{case}housing: {{kind: prescribed, rotation: [{TURNS}]}}\n"


@pytest.mark.parametrize(("against", "seen"), [("ground", 50 - spin(0)), ("housing", 50.0)])
def test_a_speed_refers_to_what_its_load_says(
    make: Make, evolvent: Evolvent, tmp_path: Path, against: str, seen: float
) -> None:
    load = f"speed, value: 50, against: {against}"
    table = f"speed, time: [0, 1], speed: [50, {50 + RAMP}], against: {against}"
    done = evolvent("run", written(tmp_path, "run", turning_case(table, seen)), "-o", "h.h5", "-q")
    assert done.returncode == 0, done.stderr
    with h5py.File(tmp_path / "h.h5") as file:
        expected = file["angular_velocity"][-1, :]
    fmu = slave(
        make(written(tmp_path, "pair", turning_case(load, seen)), "--input", "wheel:a:speed"),
        tmp_path / "x",
    )
    fmu.set(a__acceleration=RAMP)
    fmu.begin()
    n = 20
    for k in range(n):
        fmu.step(k * DURATION / n, DURATION / n)
        fmu.set(a__speed=50 + RAMP * DURATION * (k + 1) / n)
    got = fmu.get("angular_velocity[a]", "angular_velocity[b]")
    assert got == pytest.approx(expected, rel=1e-8)
    assert got[0] == pytest.approx(70 - (spin(DURATION) if against == "ground" else 0), rel=1e-9)
    assert fmu.logged == []
    fmu.end()


def test_an_importer_that_integrates_is_held_to_the_speed_seen_from_the_ground(
    make: Make, tmp_path: Path
) -> None:
    case = turning_case("speed, value: 50", 50 - spin(0))
    fmu = model(make(written(tmp_path, "pair", case), "--input", "wheel:a:speed"), tmp_path / "x")
    fmu.begin()
    fmu.fmu.updateDiscreteStates()
    fmu.fmu.enterContinuousTimeMode()
    assert fmu.fmu.completedIntegratorStep() == (False, False)
    rate = fmu.get("der(state.reference_speed)")
    assert rate == pytest.approx(0, abs=1e-9)  # the housing's own acceleration is 0 here
    fmu.end()
