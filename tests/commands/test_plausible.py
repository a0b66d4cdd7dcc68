"""Plausible ranges: every key with a unit has one, and values outside it cause one warning."""

from __future__ import annotations

import json
import math
import re
import subprocess
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

import machine
from commands.case_table import Row, Table
from designs import read_journal, write_design
from example_cases import CASES

Evolvent = Callable[..., subprocess.CompletedProcess[str]]
OUTSIDE = "is outside the plausible range"
SHORT = ("simulation.duration=1e-4", "simulation.output_interval=1e-4")


@pytest.fixture(scope="session")
def table(executable: Path) -> Table:
    def shown(option: str) -> str:
        done = subprocess.run([executable, "show", option], capture_output=True, check=True)
        return done.stdout.decode()

    return Table(shown("--keys"), shown("--units"))


def dimensional(table: Table) -> list[Row]:
    return [row for row in table.rows if row.unit]


# Powers of ten of the units of printed ranges, besides a key's own unit.
POWERS = {
    "mm": -3,
    "um": -6,
    "g": -3,
    "kg mm2": -6,
    "GPa": 9,
    "MPa": 6,
    "um mm/N": -9,
    "ms": -3,
    "us": -6,
}
POWERS |= {"N/um": 6, "N/mm": 3, "mm/s": -3, "um/s": -6, "mPa s": -3}


def in_unit(text: str, unit: str) -> float:
    """Convert a limit of a range to the unit of the key."""
    number, _, name = text.partition(" ")
    return float(number) * (1.0 if name == unit else 10.0 ** POWERS[name])


def span_of(row: Row) -> tuple[float, float]:
    """The plausible magnitudes of a key."""
    least, _, most = row.plausible.removeprefix("up to ").rpartition(" to ")
    return in_unit(least, row.unit) if least else 0.0, in_unit(most, row.unit)


def test_every_key_with_a_unit_states_a_plausible_range_within_its_range(table: Table) -> None:
    rows = dimensional(table)
    assert len(rows) > 80
    assert not [f"{row.block}.{row.key}" for row in rows if not row.plausible]
    for row in rows:
        least, most = span_of(row)
        assert 0.0 <= least < most, row
        assert most <= max(abs(row.low), abs(row.high)), row


def test_every_default_is_plausible(table: Table) -> None:
    for row in dimensional(table):
        for number in re.findall(r"-?[\d.]+(?:e-?\d+)?", row.default):
            least, most = span_of(row)
            size = abs(float(number))
            assert size <= 0.0 or least <= size <= most, row


def named_apart(case: dict[str, Any]) -> dict[str, Any]:
    """Give the two wheels of a case of the table distinct names."""
    wheels = case["wheels"] = [dict(wheel) for wheel in case["wheels"]]
    wheels[1]["name"] = "b"
    for mesh in case["meshes"]:
        mesh["driven"] = "b"
    initial = case["simulation"].get("initial", {})
    if "speeds" in initial:
        initial["speeds"] = {"b": 0, **initial["speeds"]}
    return case


def time_for(case: dict[str, Any], row: Row, number: float) -> None:
    """Make the case long enough for a time value."""
    simulation = case["simulation"]
    if not simulation.keys() & {"output", "output_interval"}:
        simulation["output_interval"] = simulation["duration"]
    if row.block in ("simulation", "output", "metrics") and row.unit == "s":
        if row.key == "duration":
            simulation["output_interval"] = number / 10
        elif row.key != "max_step":
            simulation["duration"] = 2 * number
            if row.block == "metrics":
                simulation["output_interval"] = number / 10
            if row.key == "from":
                simulation["metrics"]["to"] = 2 * number
            if row.key == "to":
                simulation["metrics"]["from"] = 0


def outside(row: Row) -> list[float]:
    """Numbers that the table accepts, outside the plausible range."""
    least, most = span_of(row)
    sign = -1.0 if row.high <= 0.0 else 1.0
    found = [sign * number for number in (0.9 * least, 1.1 * most) if number > 0.0]
    return [number for number in found if row.low <= number <= row.high]


def with_value(table: Table, row: Row, number: float) -> dict[str, Any]:
    """A case with this value of the key."""
    value = row.with_number(number)
    if row.type == "list of numbers":
        value = [2 * number, number] if row.block == "sn" else [number, 2 * number]
    if row.block == "initial" and row.key == "gaps":
        value = {"a-b": number}
    given: dict[str, Any] = {row.key: value}
    variant = table.variants(row)[0]
    for other in table.of(row.block):  # tables have as many values as knots
        is_there = not other.only_with or variant in other.only_with
        is_other = other is not row and other.is_required and is_there
        if is_other and other.type == row.type == "list of numbers":
            given[other.key] = [0.001, 0.002]
    block = table.block(row.block, variant, **given)
    case = json.loads(json.dumps(named_apart(table.case(row.block, block))))
    time_for(case, row, number)
    return dict(case)


def test_every_key_with_a_unit_warns_of_numbers_outside_with_the_location(
    evolvent: Evolvent, tmp_path: Path, table: Table
) -> None:
    """Also for a case that is rejected later: the unit may be the reason."""
    warned = 0
    for row in dimensional(table):
        for number in outside(row):
            (tmp_path / "case.yaml").write_text(json.dumps(with_value(table, row, number)))
            done = evolvent("show", "case.yaml", "--json", cwd=tmp_path)
            assert done.stdout, (row, done.stderr)
            texts = json.loads(done.stdout)["warnings"]
            mine = [text for text in texts if re.search(rf"[.\s]{row.key}(\.[\w-]+)?: ", text)]
            assert len(mine) == 1, (row, number, texts, done.stderr)
            assert mine[0].startswith("case.yaml:1:")
            assert f"{OUTSIDE}, {row.plausible}" in mine[0]
            warned += 1
    assert warned > 120


def test_no_example_has_an_implausible_number(evolvent: Evolvent) -> None:
    done = evolvent("validate", *CASES)
    assert done.stdout.count(": ok\n") == len(CASES)
    assert OUTSIDE not in done.stderr


# An option, its value in the warning, and the probable intention.
SLIPS = {
    "metres for millimetres": ("wheels.pinion.width=14", "14 m", "14 mm"),
    "a module": ("wheels.pinion.module=3000 mm", "3000 mm (3 m)", "3000 um"),
    "a backlash": ("meshes.0={driving: pinion, driven: gear, driving_rotation: clockwise, "
                   "backlash: 50 mm}", "50 mm (0.05 m)", "50 um"),
    "GPa": ("materials.steel.youngs_modulus=206", "206 Pa", "206 GPa"),
    "N/mm2": ("materials.steel.youngs_modulus=206000", "206000 Pa", "206000 MPa"),
    "a permissible stress": ("materials.steel.strength={sigma_FP: 430}", "430 Pa", "430 MPa"),
    "a density": ("materials.steel.density=7.85", "7.85 kg/m3", "7.85 kg/dm3"),
    "rpm": ("wheels.pinion.loads.0={kind: drive, speed: 18000, slope: -1}", "18000 rad/s",
            "18000 rpm"),
    "N mm": ("wheels.pinion.loads.0.value=2e10", "2e10 N m", ""),
    "percent": ("meshes.0.friction={law: coulomb, coefficient: 8}", "8", "8 %"),
    "a support": ("wheels.pinion.support={kind: slider, stiffness: 0.5}", "0.5 N/m", "0.5 N/um"),
    "gravity": ("gravity=[0, -9810, 0]", "-9810 m/s2", "-9810 mm/s2"),
}  # fmt: skip


@pytest.mark.parametrize("slip", SLIPS)
def test_the_warning_has_the_location_the_value_and_the_likely_unit(
    evolvent: Evolvent, examples: Path, slip: str
) -> None:
    option, value, likely = SLIPS[slip]
    done = evolvent("show", examples / "spur-pair.yaml", "--json", "--set", option)
    (text,) = [text for text in json.loads(done.stdout)["warnings"] if OUTSIDE in text]
    assert text.startswith(f"--set {option}: ")
    assert f": {value} {OUTSIDE}, " in text
    assert text.endswith(f"; did you mean {likely}?" if likely else "; check its unit")


def changed(examples: Path, folder: Path) -> Path:
    """A case with widths in metres in two wheels."""
    text = (examples / "spur-pair.yaml").read_text()
    case = folder / "wide.yaml"
    case.write_text(text.replace("width: 25 mm", "width: 25").replace("width: 24 mm", "width: 24"))
    return case


def location_of(case: Path, words: str) -> str:
    """Line and column of the first number after some words."""
    lines = case.read_text().splitlines()
    line = next(i for i, line in enumerate(lines) if words in line)
    return f"{case}:{line + 1}:{lines[line].index(words) + len(words) + 1}"


def test_every_command_prints_one_warning_of_a_key(
    evolvent: Evolvent, examples: Path, tmp_path: Path
) -> None:
    case = changed(examples, tmp_path)
    expected = (
        f"{location_of(case, 'width: ')}: wheels.pinion.width: 25 m {OUTSIDE}, 10 um to 1 m, "
        "as is another value of this key; did you mean 25 mm?"
    )
    settings = [word for option in SHORT for word in ("--set", option)]
    run = ("run", case, "-o", tmp_path / "x.h5", *settings)
    for command in (run, ("validate", case), ("validate", "-q", case), ("modes", case)):
        done = evolvent(*command)
        assert done.returncode == 0
        reported = [line for line in done.stderr.splitlines() if OUTSIDE in line]
        assert reported == [f"evolvent: warning: {expected}"]
    shown = evolvent("show", case).stdout
    assert shown.count(OUTSIDE) == 1
    assert f"\n  {expected}\n" in shown.split("\nWarnings")[1]


def test_several_cases_have_their_names_in_front(
    evolvent: Evolvent, examples: Path, tmp_path: Path
) -> None:
    case = changed(examples, tmp_path)
    option = "meshes.0.centre_distance=0.0845"
    rest = ("--set", "simulation.initial={kind: rest}")
    cases = (case, examples / "spur-pair.yaml")
    reported = evolvent("validate", *cases, "--set", option, *rest).stderr
    ratios = [line for line in reported.splitlines() if "its contact ratio" in line]
    assert [line.split(": meshes")[0] for line in ratios] == [
        f"evolvent: warning: {path}" for path in cases
    ]
    assert reported.count(OUTSIDE) == 1


def test_a_warning_does_not_change_results(
    evolvent: Evolvent, examples: Path, tmp_path: Path
) -> None:
    """A value with a warning in one unit, and the same value in another unit."""
    h5py = machine.module("h5py")
    short = [word for option in SHORT for word in ("--set", option)]
    files = []
    for number, width in enumerate(("2", "2000 mm")):
        setting = ("--set", f"wheels.pinion.width={width}", "--set", "wheels.gear.width=20 mm")
        files.append(tmp_path / f"{number}.h5")
        done = evolvent("run", examples / "spur-pair.yaml", "-o", files[-1], *setting, *short)
        assert done.returncode == 0
        assert OUTSIDE in done.stderr
    with h5py.File(files[0]) as first, h5py.File(files[1]) as second:
        assert first["normal_force"][...].tobytes() == second["normal_force"][...].tobytes()
        assert OUTSIDE in first.attrs["warnings"]


def test_a_batch_warns_once_of_its_base_and_once_of_a_column(
    evolvent: Evolvent, examples: Path, tmp_path: Path
) -> None:
    base = changed(examples, tmp_path).read_text()
    n = 40
    columns: dict[str, list[Any]] = {path: [1e-4] * n for path in (o.split("=")[0] for o in SHORT)}
    columns["wheels.pinion.inertia"] = [1e-4] * (n - 1) + [1e5]
    design = write_design(tmp_path / "design.h5", columns, base, (0.0, 1e-4))
    done = evolvent("batch", design, "-o", "r", "-j", "2", cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    reported = [line for line in done.stderr.splitlines() if OUTSIDE in line]
    assert len(reported) == 2
    assert "wheels.pinion.width: 25 m" in reported[0]
    assert "case 39: " in reported[1]
    assert "wheels.pinion.inertia: 100000 kg m2" in reported[1]
    cases = read_journal(tmp_path / "r/shard-1-of-1.jsonl").cases
    messages = [cases[i]["message"] for i in range(n)]
    assert not any(OUTSIDE in message for message in messages[:-1])
    assert messages[-1].count(OUTSIDE) == 1
    assert "inertia" in messages[-1]


# ---- refusals and warnings in modules


@pytest.mark.parametrize(
    ("option", "field", "reason"),
    [
        ("wheels.pinion.tip_relief={amount: 16, diameter: 65 mm}", "tip_relief.amount",
         "16 m is more than 0.1 modules, 300 um; did you mean 16 um?"),
        ("wheels.pinion.root_relief={amount: 0.31 mm, diameter: 56 mm}", "root_relief.amount",
         "310 um is more than 0.1 modules, 300 um; give less, or another unit"),
        ("wheels.pinion.profile_crowning=5", "profile_crowning",
         "5 m is more than 0.1 modules, 300 um; did you mean 5 um?"),
        ("wheels.pinion.profile_crowning=5 mm", "profile_crowning",
         "0.005 m is more than 0.1 modules, 300 um; did you mean 5 um?"),
        (f"wheels.pinion.pitch_errors=[{', '.join(['0'] * 19 + ['-12'])}]", "pitch_errors",
         "-12 m is more than 0.1 modules, 300 um; did you mean -12 um?"),
    ],
)  # fmt: skip
def test_deviations_above_a_tenth_of_a_module_are_refused(
    evolvent: Evolvent, examples: Path, option: str, field: str, reason: str
) -> None:
    case = examples / "spur-pair.yaml"
    teeth = json.loads(evolvent("show", case, "--json").stdout)["wheels"]["pinion"]["gear"]["teeth"]
    option = option.replace("0, " * 19, "0, " * (teeth - 1))
    done = evolvent("validate", case, "--set", option)
    assert done.returncode == 3
    assert done.stderr.endswith(f"wheels.pinion.{field}: {reason}\n")


def test_deviations_below_it_are_accepted(evolvent: Evolvent, examples: Path) -> None:
    """Up to the bound of 0.1 modules itself, 300 um; one micrometre more is refused."""
    case = examples / "spur-pair.yaml"
    for given, code in (("0.3 mm", 0), ("0.301 mm", 3)):
        option = f"wheels.pinion.profile_crowning={given}"
        assert evolvent("validate", case, "--set", option).returncode == code
        shown = evolvent("show", case, "--set", option, "--json")
        assert shown.returncode == code
        if code == 0:
            assert json.loads(shown.stdout)["case"]["wheels"][0]["profile_crowning"] == 0.3e-3


@pytest.mark.parametrize(
    ("option", "field"),
    [
        ("wheels.pinion.eccentricity={amount: 0.4 mm}", "eccentricity"),
        ("wheels.pinion.thickness_allowance=-0.4 mm", "thickness_allowance"),
    ],
)
def test_runout_and_allowances_above_it_are_warned_of(
    evolvent: Evolvent, examples: Path, option: str, field: str
) -> None:
    mesh = "driving: pinion, driven: gear, driving_rotation: clockwise, centre_line_angle: 0"
    backlash = f"meshes.0={{{mesh}}}"
    words = ("--set", option, "--set", backlash)
    done = evolvent("show", examples / "spur-pair.yaml", "--json", *words)
    assert done.returncode == 0, done.stderr
    texts = [t for t in json.loads(done.stdout)["warnings"] if "0.1 modules" in t]
    assert len(texts) == 1
    assert texts[0].startswith(f"wheels.pinion.{field}: ")
    smaller = [word.replace("0.4", "0.2") for word in words]
    done = evolvent("show", examples / "spur-pair.yaml", "--json", *smaller)
    assert not [t for t in json.loads(done.stdout)["warnings"] if "0.1 modules" in t]


def test_the_json_schema_has_the_plausible_ranges(executable: Path, table: Table) -> None:
    done = subprocess.run([executable, "show", "--schema"], capture_output=True, check=True)
    text = done.stdout.decode()
    for row in dimensional(table):
        assert f"; plausible: {row.plausible}" in text
    assert math.isclose(span_of(next(r for r in table.rows if r.key == "module"))[1], 0.1)
