"""Numbers with units, in files and options: the same doubles; invalid units of a key."""

from __future__ import annotations

import json
import math
import re
import subprocess
from collections.abc import Callable
from decimal import Decimal
from pathlib import Path
from typing import Any

import pytest

import machine
from example_cases import CASES

Evolvent = Callable[..., subprocess.CompletedProcess[str]]

CASE = 3
# By the unit of a key: its units with their powers of ten.
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
    "Pa s": {"Pa s": 0, "mPa s": -3, "cP": -3},
    "K": {"K": 0},
    "W/(m K)": {"W/(m K)": 0, "W m-1 K-1": 0, "W/(m*K)": 0, "kW/(m·K)": 3},
    "J/(kg K)": {"J/(kg K)": 0, "J kg-1 K-1": 0, "kJ/(kgK)": 3},
    "": {"%": -2},
}  # fmt: skip


# Cases with long computations of wheels have the same keys as compliant-pair.
CHEAP = [c for c in CASES if "compliance: {" not in c.read_text() or c.stem == "compliant-pair"]


def shown(evolvent: Evolvent, case: Path, *options: str) -> dict[str, Any]:
    words = [word for option in options for word in ("--set", option)]
    result = evolvent("show", case, "--json", *words)
    assert result.returncode == 0, result.stderr
    reported: dict[str, Any] = json.loads(result.stdout)
    return reported


@pytest.mark.parametrize("turn", range(4))
def test_every_number_of_the_examples_is_the_same_double_in_another_unit(
    evolvent: Evolvent, turn: int
) -> None:
    seen: set[str] = set()
    for case in CHEAP:
        given = json.loads(evolvent("show", case, "--parameters", "--json").stdout)
        options = []
        for index, (path, parameter) in enumerate(given.items()):
            seen.add(parameter["unit"])
            units = list(POWERS[parameter["unit"]].items())
            unit, power = units[(index + turn) % len(units)]
            values = parameter["value"]
            all_values = values if isinstance(values, list) else [values]
            if not parameter["unit"] and any(value == round(value) for value in all_values):
                continue  # it may be an integer, which has no unit
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
        "module: 3 mm": "module: &m 3 mm",
        " module: 3 mm": " module: *m",
        "{kind: torque, value: -50 N m}": "{kind: table, time: [0, 10 ms],"
        " torque: [-50 N m, -0.05kNm]}",
        "{kind: steady}": "{kind: speeds, speeds: {pinion: -1500 rpm, gear: 900 1/min},"
        " gaps: {pinion-gear: 2um}}",
        "centre_distance: 80.9 mm": "centre_distance: '80.9 mm'",
        "206 GPa": '"206 GPa"',
    }
    for old, new in changes.items():
        assert old in text
        text = text.replace(old, new, 1)
    case = tmp_path / "case.yaml"
    case.write_text(text)
    reported = shown(evolvent, case, "gravity=[0, -9810 mm/s^2, 0 m/s²]")["case"]
    assert [wheel["module"] for wheel in reported["wheels"]] == [0.003, 0.003]
    load = reported["wheels"][0]["loads"][0]
    assert (load["time"], load["torque"]) == ([0, 0.01], [-50, -50])
    initial = reported["simulation"]["initial"]
    ulp = 3e-16  # one rounding error here, three there
    assert initial["speeds"] == pytest.approx(
        {"pinion": -50 * math.pi, "gear": 30 * math.pi}, rel=ulp
    )
    assert initial["gaps"] == {"pinion-gear": 2e-6}
    assert reported["meshes"][0]["centre_distance"] == 0.0809
    assert reported["materials"]["steel"]["youngs_modulus"] == 2.06e11
    assert reported["gravity"] == [0, -9.81, 0]


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
        "is 20 Mm, but the unit 'Mm' is unknown (did you mean 'mm'?); write the length in mm,",
    ),
    "no unit at all": ("wheels.pinion.width=3 thou", "the unit 'thou' is unknown; write the"),
    "a unit where none is": (
        "meshes.0.friction={law: coulomb, coefficient: 0.1 mm}",
        "friction.coefficient: is 0.1 mm, but 'mm' is a unit of length, and this number has none; "
        "omit it, or write %",
    ),
    "a whole number": ("wheels.pinion.teeth=20 mm", "must be a whole number, not '20 mm'"),
    "out of range": ("wheels.pinion.width=-3 mm", "is -3 mm (-0.003 m), must be greater than 0 m"),
    "beside a word": (
        "meshes.0.pressure_angle=20 mm",
        "is 20 mm, but 'mm' is a unit of length; write the angle in deg, °, rad, mrad, arcmin",
    ),
    "too large": ("wheels.pinion.width=1e400 mm", "is 1e400 mm, which is not a finite number"),
    "a comma": ("wheels.pinion.width=3,5 mm", "must be a number with a decimal point, no "
        "comma [m]"),
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


@pytest.mark.parametrize("start", ["", "x", "xx"])
def test_a_long_unit_is_cut_between_characters(
    evolvent: Evolvent, examples: Path, start: str
) -> None:
    option = f"wheels.pinion.width=3 {start}{'°µ∑' * 40}"
    line = evolvent("show", examples / "paper.yaml", "--set", option).stderr
    assert "�" not in line
    assert "is unknown; write the length in mm," in line


def test_a_history_holds_the_case_in_the_keys_units(
    evolvent: Evolvent, examples: Path, tmp_path: Path
) -> None:
    h5py = machine.module("h5py")
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


# ---- output of `show`


def printed_case(evolvent: Evolvent, case: Path, *words: str) -> str:
    """The case as printed by `show`, as a case file."""
    lines = evolvent("show", case, *words).stdout.split("\n\n")[1].splitlines()
    assert all(line.startswith("  ") for line in lines)
    return "\n".join(line[2:] for line in lines) + "\n"


def test_the_case_that_show_prints_is_a_case_of_the_same_doubles(
    evolvent: Evolvent, tmp_path: Path
) -> None:
    odd = ("--set", "simulation.duration=0.123456789012345678", "--set", "gravity=[0, -9.80665, 0]")
    for case in CHEAP:
        for words in ((), odd):
            first = json.loads(evolvent("show", case, "--json", *words).stdout)
            (tmp_path / "printed.yaml").write_text(printed_case(evolvent, case, *words))
            second = shown(evolvent, tmp_path / "printed.yaml")
            assert {**second, "path": ""} == {**first, "path": ""}


def test_show_prints_the_numbers_of_its_json_in_engineering_units(
    evolvent: Evolvent, examples: Path
) -> None:
    """Each row of a wheel and a mesh, by an independent table of powers."""
    case = examples / "spur-pair.yaml"
    reported = shown(evolvent, case)
    sections = evolvent("show", case).stdout.split("\n\n")
    (mesh,) = [text for text in sections if text.startswith("Mesh ")]
    units = {"N/um": 1e6, "mm": 1e-3, "um": 1e-6, "GPa": 1e9, "kg": 1, "N": 1, "Hz": 1}
    units |= {"deg": math.pi / 180, "N s/m": 1}
    values = reported["meshes"]["pinion-gear"]
    values.pop("gear")
    rows = mesh.splitlines()[1:]
    assert len(rows) == len(values)
    checked = 0
    for row, value in zip(rows, values.values(), strict=True):
        words = row.split("  ")[-1].strip().removeprefix("(").replace("(", "").split()
        numbers = [float(word.strip("(),")) for word in words if word.strip("(),-.")[:1].isdigit()]
        unit = " ".join(word for word in words if not word.strip("(),-.")[:1].isdigit())
        expected = value if isinstance(value, list) else [value]
        scaled = [number * units.get(unit, 1) for number in numbers]
        assert scaled == pytest.approx(expected, rel=1e-9, abs=1e-15)
        assert unit in units or not unit
        checked += bool(unit)
    assert checked > 15


def test_show_prints_speeds_both_ways(evolvent: Evolvent, examples: Path) -> None:
    case = examples / "spur-pair.yaml"
    given = "wheels.0.loads.0={kind: drive, speed: -1500 rpm, torque: -50 N m, slope: 0}"
    assert "speed: -1500 rpm, torque: -50 N m, slope: 0 N m s/rad}   # -157.08 rad/s\n" in (
        evolvent("show", case, "--set", given).stdout
    )
    given = given.replace("-1500 rpm", "-150")
    assert "speed: -150 rad/s, torque: -50 N m, slope: 0 N m s/rad}   # -1432.39 rpm\n" in (
        evolvent("show", case, "--set", given).stdout
    )


def test_parameters_stay_in_the_units_of_their_keys(evolvent: Evolvent, examples: Path) -> None:
    words = ("--set", "wheels.pinion.module=3 mm", "--parameters")
    text = evolvent("show", examples / "spur-pair.yaml", *words).stdout
    assert "wheels.pinion.module = 0.003 m\n" in text


# ---- the table, and values


def test_show_lists_the_units_that_numbers_take(evolvent: Evolvent) -> None:
    rows = evolvent("show", "--units").stdout.splitlines()[2:]
    table = {
        row.split("|")[2].strip().strip("`"): re.findall("`([^`]+)`", row.split("|")[3])
        for row in rows
    }
    keys = evolvent("show", "--keys").stdout
    used = {row.split("|")[4].strip() for row in keys.splitlines() if row.startswith("| `")}
    assert table.keys() == used == POWERS.keys()
    for key_unit, names in table.items():
        assert not key_unit or key_unit in names


def test_the_documented_table_of_units_is_the_program_s(evolvent: Evolvent, examples: Path) -> None:
    page = (examples.parent / "docs" / "reference" / "case_format.md").read_text(encoding="utf-8")
    assert f"\n\n{evolvent('show', '--units').stdout}\n" in page


def test_the_documented_refusals_are_the_program_s(evolvent: Evolvent, examples: Path) -> None:
    page = (examples.parent / "docs" / "reference" / "case_format.md").read_text(encoding="utf-8")
    for option in ("wheels.pinion.width=3 N", "wheels.pinion.module=-3 mm"):
        line = evolvent("run", examples / "spur-pair.yaml", "--set", option).stderr
        assert line.split(": ", 1)[1] in page


def test_convert_tells_values_in_the_units_of_their_keys(
    evolvent: Evolvent, examples: Path
) -> None:
    options = {
        "wheels.pinion.module=3 mm": ("m", 0.003, "quantity"),
        "wheels.pinion.module=0.003": ("m", 0.003, "number"),
        "wheels.0.loads.0.value=0.05 kNm": ("N m", 50, "quantity"),
        "wheels.0.loads.0.speed=3000 rpm": ("rad/s", 100 * math.pi, "quantity"),
        "simulation.initial.speeds.pinion=30 1/min": ("rad/s", math.pi, "quantity"),
        "meshes.0.pressure_angle=paper_rule": ("deg", None, "text"),
        "wheels.pinion.name=3 mm": ("", None, "text"),
        "wheels.pinion.teeth=3 mm": ("", None, "text"),
        "title=3 mm": ("", None, "text"),
        # Of two laws with different units, neither of which is in the case.
        "meshes.0.damping.coefficient=3 N s/m": ("", None, "text"),
    }
    words = [word for option in options for word in ("--convert", option)]
    result = evolvent("show", examples / "spur-pair.yaml", *words)
    reported = json.loads(result.stdout)
    assert [row["option"] for row in reported] == list(options)
    for row, (unit, value, given) in zip(reported, options.values(), strict=True):
        assert (row["unit"], row["given"]) == (unit, given)
        assert row["value"] == (None if value is None else pytest.approx(value, rel=3e-16))


@pytest.mark.parametrize(
    ("option", "code", "reason"),
    [
        ("wheels.pinion.module=3 N", 3, "'N' is a unit of force; write the length in mm,"),
        ("wheels.pinion.modul=3 mm", 3, "wheels.pinion has no key 'modul' (did you mean 'module'?"),
        ("wheels.pinon.module=3 mm", 3, "wheels has no 'pinon' (did you mean 'pinion'?)"),
        ("wheels.pinion.module", 2, "has no '='; write --convert PATH=VALUE"),
    ],
)
def test_convert_refuses_as_set_does(
    evolvent: Evolvent, examples: Path, option: str, code: int, reason: str
) -> None:
    result = evolvent("show", examples / "spur-pair.yaml", "--convert", option)
    assert result.returncode == code
    assert result.stdout == ""
    (line,) = result.stderr.splitlines()
    assert line.startswith(f"--convert {option}: ")
    assert reason in line
