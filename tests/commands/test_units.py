"""Numbers with units, in files and options: the same doubles; what is no unit of the key."""

from __future__ import annotations

import json
import math
import subprocess
from collections.abc import Callable
from decimal import Decimal
from pathlib import Path
from typing import Any

import pytest

Evolvent = Callable[..., subprocess.CompletedProcess[str]]

CASE = 3
# By the unit of a key: units of it with their powers of ten.
POWERS: dict[str, dict[str, int]] = {
    "m": {"m": 0, "mm": -3, "um": -6, "µm": -6, "nm": -9, "cm": -2},
    "s": {"s": 0, "ms": -3, "us": -6, "µs": -6},
    "deg": {"deg": 0, "°": 0},
    "rad/s": {"rad/s": 0, "rad s-1": 0},
    "Hz": {"Hz": 0, "kHz": 3, "1/s": 0},
    "N": {"N": 0, "kN": 3},
    "N m": {"N m": 0, "Nm": 0, "kN m": 3, "N·mm": -3, "Ncm": -2, "mN m": -3},
    "Pa": {"Pa": 0, "kPa": 3, "MPa": 6, "GPa": 9, "N/mm2": 6, "N/mm^2": 6, "N/mm²": 6, "bar": 5},
    "1/Pa": {"1/Pa": 0, "um mm/N": -9, "mm2/N": -6, "1/GPa": -9},
    "kg": {"kg": 0, "g": -3, "t": 3},
    "kg/m3": {"kg/m3": 0, "g/cm3": 3, "kg/dm³": 3, "kg m-3": 0},
    "kg m2": {"kg m2": 0, "kg mm2": -6, "g*mm^2": -9, "g cm2": -7, "kgm²": 0},
    "m/s": {"m/s": 0, "mm/s": -3, "um/s": -6, "m s-1": 0, "cm/s": -2},
    "m/s2": {"m/s2": 0, "m/s^2": 0, "m/s²": 0, "m s-2": 0, "mm/s2": -3},
    "N/m": {"N/m": 0, "N/mm": 3, "N/um": 6, "N/µm": 6, "kN/mm": 6, "kN/m": 3, "MN/m": 6},
    "N m/rad": {"N m/rad": 0, "Nm/rad": 0, "kN m/rad": 3, "MN m/rad": 6, "N mm/rad": -3},
    "N s/m": {"N s/m": 0, "N s/mm": 3, "kN s/m": 3, "Ns/m": 0},
    "N m s/rad": {"N m s/rad": 0, "Nms/rad": 0, "N m s": 0, "N mm s": -3},
    "N s/m2": {"N s/m2": 0, "N s/mm2": 6},
    "N/m^exponent": {"N/m^exponent": 0},
    "": {"%": -2},
}  # fmt: skip


def shown(evolvent: Evolvent, case: Path, *options: str) -> dict[str, Any]:
    words = [word for option in options for word in ("--set", option)]
    result = evolvent("show", case, "--json", *words)
    assert result.returncode == 0, result.stderr
    told: dict[str, Any] = json.loads(result.stdout)
    return told


@pytest.mark.parametrize("turn", range(6))
def test_every_number_of_the_examples_is_the_same_double_in_another_unit(
    evolvent: Evolvent, examples: Path, turn: int
) -> None:
    seen: set[str] = set()
    for case in sorted(examples.glob("*.yaml")):
        if case.name.startswith("sweep"):
            continue
        given = json.loads(evolvent("show", case, "--parameters", "--json").stdout)
        options = []
        for index, (path, parameter) in enumerate(given.items()):
            seen.add(parameter["unit"])
            units = list(POWERS[parameter["unit"]].items())
            unit, power = units[(index + turn) % len(units)]
            values = parameter["value"]
            all_values = values if isinstance(values, list) else [values]
            if not parameter["unit"] and any(value == round(value) for value in all_values):
                continue  # it may be a whole number, which takes no unit
            texts = [f"{Decimal(repr(value)).scaleb(-power)} {unit}" for value in all_values]
            options.append(f"{path}={texts if isinstance(values, list) else texts[0]}")
        bare, with_units = shown(evolvent, case), shown(evolvent, case, *options)
        assert with_units == bare
    assert len(seen) > 10


def test_units_stand_in_scalars_lists_tables_names_and_beside_anchors(
    evolvent: Evolvent, examples: Path, tmp_path: Path
) -> None:
    text = (examples / "spur-pair.yaml").read_text()
    changes = {
        "module: 3.0e-3                   # m": "module: &m 3 mm  # m",
        "module: 3.0e-3\n": "module: *m\n",
        "{kind: torque, value: -50}": "{kind: table, time: [0, 10 ms],"
        " torque: [-50 N m, -0.05kNm]}",
        "{kind: steady}": "{kind: speeds, speeds: {pinion: -1500 rpm, gear: 900 1/min},"
        " gaps: {pinion-gear: 2um}}",
        "centre_distance: 0.0809 ": "centre_distance: '80.9 mm' ",
        "2.06e+11": '"206 GPa"',
    }  # fmt: skip
    for old, new in changes.items():
        assert old in text or "3.0e-3" in old
        text = text.replace(old, new, 1)
    case = tmp_path / "case.yaml"
    case.write_text(text)
    told = shown(evolvent, case, "gravity=[0, -9810 mm/s^2, 0 m/s²]")["case"]
    assert [wheel["module"] for wheel in told["wheels"]] == [0.003, 0.003]
    load = told["wheels"][0]["loads"][0]
    assert (load["time"], load["torque"]) == ([0, 0.01], [-50, -50])
    initial = told["simulation"]["initial"]
    ulp = 3e-16  # one rounding here, three there
    assert initial["speeds"] == pytest.approx(
        {"pinion": -50 * math.pi, "gear": 30 * math.pi}, rel=ulp
    )
    assert initial["gaps"] == {"pinion-gear": 2e-6}
    assert told["meshes"][0]["centre_distance"] == 0.0809
    assert told["materials"]["steel"]["youngs_modulus"] == 2.06e11
    assert told["gravity"] == [0, -9.81, 0]


REFUSED = {
    "another kind": (
        "wheels.pinion.width=3 N",
        "wheels.pinion.width: is 3 N, but 'N' is a unit of force; "
        "write the length in mm, um, nm, cm, m, in",
    ),
    "two other kinds": (
        "wheels.pinion.width=3 1/min",
        "is 3 1/min, but '1/min' is a unit of angular velocity, frequency; write the length in mm,",
    ),
    "mega for milli": (
        "wheels.pinion.width=20 Mm",
        "is 20 Mm, but the unit 'Mm' is not known (did you mean 'mm'?); write the length in mm,",
    ),
    "no unit at all": ("wheels.pinion.width=3 thou", "the unit 'thou' is not known; write the"),
    "a unit where none is": (
        "meshes.0.friction={law: coulomb, coefficient: 0.1 mm}",
        "friction.coefficient: is 0.1 mm, but 'mm' is a unit of length, and this number has none; "
        "leave it away, or write %",
    ),
    "a whole number": ("wheels.pinion.teeth=20 mm", "must be a whole number, not '20 mm'"),
    "out of range": ("wheels.pinion.width=-3 mm", "is -3 mm (-0.003 m), must be greater than 0 m"),
    "beside a word": (
        "meshes.0.pressure_angle=20 mm",
        "is 20 mm, but 'mm' is a unit of length; write the angle in deg, °, rad, mrad, arcmin",
    ),
    "too large": ("wheels.pinion.width=1e400 mm", "is 1e400 mm, which is not a finite number"),
    "a comma": ("wheels.pinion.width=3,5 mm", "must be a number [m], not '3,5 mm'"),
    "an element": ("wheels.pinion.centre=[0 mm, 0 s]", "is 0 s, but 's' is a unit of time; write"),
    "cycles for an angle": (
        "wheels.pinion.loads.0={kind: speed, value: 25 Hz}",
        "'Hz' is a unit of frequency; write the angular velocity in rpm, 1/min, rad/s, deg/s, °/s",
    ),
    "knots": (
        "wheels.pinion.loads.0={kind: table, time: [0, 20 ms, 0.01], torque: [1, 1, 1]}",
        "the times of a table must increase: 0.01 s follows 20 ms (0.02 s)",
    ),
    "an interval": (
        "simulation.output_interval=10 min",
        "is 10 min (600 s), longer than the duration of 5 s",
    ),
}  # fmt: skip


@pytest.mark.parametrize(("option", "reason"), REFUSED.values(), ids=REFUSED)
def test_what_is_no_unit_of_the_key_is_refused_with_those_that_are(
    evolvent: Evolvent, examples: Path, option: str, reason: str
) -> None:
    result = evolvent("run", examples / "paper.yaml", "--set", option)
    assert result.returncode == CASE
    (line,) = result.stderr.splitlines()
    assert line.startswith(f"--set {option}: ")
    assert reason in line


def test_a_history_holds_the_case_in_the_keys_units(
    evolvent: Evolvent, examples: Path, tmp_path: Path
) -> None:
    h5py = pytest.importorskip("h5py")
    words = ("--set", "simulation.duration=0.2 ms", "--set", "simulation.output_interval=20 us")
    result = evolvent("run", examples / "spur-pair.yaml", "-o", "a.h5", "-q", *words, cwd=tmp_path)
    assert result.returncode == 0, result.stderr
    with h5py.File(tmp_path / "a.h5") as history:
        text = history.attrs["case"]
        (tmp_path / "stored.yaml").write_text(text if isinstance(text, str) else text.decode())
    assert evolvent("run", "stored.yaml", "-o", "b.h5", "-q", cwd=tmp_path).returncode == 0
    assert "mm" not in (tmp_path / "stored.yaml").read_text().split("simulation")[1]
    with h5py.File(tmp_path / "a.h5") as first, h5py.File(tmp_path / "b.h5") as second:
        assert first.attrs["case"] == second.attrs["case"]
        assert (first["normal_force"][...] == second["normal_force"][...]).all()
