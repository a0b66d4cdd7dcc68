"""`evolvent datasheet`: values of known gears, formats, exchanges, refusals."""

from __future__ import annotations

import copy
import json
import math
import re
from html.parser import HTMLParser
from pathlib import Path
from typing import Any

import pytest

from commands.datasheet_cases import (
    EXAMPLES,
    POINTS,
    Evolvent,
    fzg_gears,
    pair,
    plain_gears,
    sheet,
    value,
)


@pytest.fixture
def fzg() -> dict[str, Any]:
    """FZG gears type C."""
    return fzg_gears()


@pytest.fixture
def plain() -> dict[str, Any]:
    """Pair 17/43."""
    return plain_gears()


def test_fzg_gears_have_their_known_values(
    evolvent: Evolvent, fzg: dict[str, Any], tmp_path: Path
) -> None:
    rows = sheet(evolvent, fzg, tmp_path)
    assert value(rows, "torque") == pytest.approx(302, rel=1e-9)
    assert value(rows, "torque", 1) == pytest.approx(453, rel=1e-9)
    assert value(rows, "contact_ratio") == pytest.approx(1.437537, abs=5e-7)
    assert value(rows, "loss_factor") == pytest.approx(0.19495824, abs=5e-9)
    # by manual calculation
    assert value(rows, "pressure_c") == pytest.approx(1655.6e6, abs=0.05e6)
    assert value(rows, "pressure_b") == pytest.approx(1779e6, abs=0.5e6)
    assert rows["pressure_a"]["note"] == "load share 1/2"
    assert rows["pressure_b"]["note"] == "single contact"
    rpm = math.pi / 30
    assert value(rows, "speed") == pytest.approx(2250 * rpm, rel=1e-9)
    assert value(rows, "resonance_speed_iso") == pytest.approx(21611 * rpm, abs=0.5 * rpm)
    assert value(rows, "resonance_speed_case") == pytest.approx(21834 * rpm, abs=20 * rpm)
    assert value(rows, "dynamic_factor") == pytest.approx(1.024, abs=5e-4)


def test_specific_sliding_of_17_43(
    evolvent: Evolvent, plain: dict[str, Any], tmp_path: Path
) -> None:
    rows = sheet(evolvent, plain, tmp_path)
    known = {"a": (-9.9539642, 0.90870885), "e": (0.60662119, -1.5420789)}
    for point, expected in known.items():
        assert rows[f"sliding_{point}"]["values"] == pytest.approx(expected, rel=5e-8)
    assert rows["sliding_c"]["values"] == [0, 0]
    for point in POINTS:
        first, second = rows[f"sliding_{point}"]["values"]
        assert (1 - first) * (1 - second) == pytest.approx(1, rel=1e-12)


def test_single_stiffness_of_62_62_at_a_low_load(evolvent: Evolvent, tmp_path: Path) -> None:
    """E 211 GPa, F_t/b 80.6 N/mm."""
    gear = {"teeth": 62, "module": 2e-3, "width": 0.02}
    case = pair(gear, gear)
    case["materials"]["steel"]["youngs_modulus"] = 2.11e11
    case["wheels"][0]["loads"] = [{"kind": "torque", "value": 100}]
    case["wheels"][1]["loads"] = [{"kind": "torque", "value": 100}]
    rows = sheet(evolvent, case, tmp_path)
    assert value(rows, "tangential_force") / 0.02 == pytest.approx(80645.161, rel=1e-7)
    assert value(rows, "single_stiffness_iso") == pytest.approx(14.0469e9, abs=5e4)
    factor = 0.75 * value(rows, "contact_ratio") + 0.25
    found = value(rows, "mesh_stiffness_iso") / value(rows, "single_stiffness_iso")
    assert found == pytest.approx(factor, rel=1e-12)


@pytest.mark.parametrize(
    "material",
    [
        {"youngs_modulus": 173e9, "poisson_ratio": 0.275, "density": 7100},  # nodular cast iron
        {"youngs_modulus": 115e9, "poisson_ratio": 0.34, "density": 4430},  # titanium
        {"youngs_modulus": 210e9, "poisson_ratio": 0.3, "density": 2700},
    ],
)
def test_gears_of_other_materials_than_steel_have_no_dynamic_factor(
    evolvent: Evolvent, fzg: dict[str, Any], tmp_path: Path, material: dict[str, float]
) -> None:
    fzg["wheels"][0]["accuracy"] = fzg["wheels"][1]["accuracy"] = {"class": 7}
    keys = ("dynamic_factor", "dynamic_factor_of_class")
    assert all(value(sheet(evolvent, fzg, tmp_path), key) > 1 for key in keys)
    fzg["materials"]["other"] = material
    for wheel in fzg["wheels"]:  # one gear of it is enough, on either side
        before = wheel["material"]
        wheel["material"] = "other"
        rows = sheet(evolvent, fzg, tmp_path)
        for key in keys:
            assert rows[key]["values"] == [None]
            assert "gears of steel" in rows[key]["note"]
        assert value(rows, "resonance_ratio") > 0
        wheel["material"] = before


def test_inspection_follows_the_case(
    evolvent: Evolvent, plain: dict[str, Any], tmp_path: Path
) -> None:
    """The numbers of teeth and the ball of the case, in the printed example 51/52."""
    for wheel, teeth, shift in zip(plain["wheels"], (51, 52), (0.2032, 0.3143), strict=True):
        wheel |= {"teeth": teeth, "module": 1e-3, "profile_shift": shift}
        wheel |= {"span_teeth": 6, "ball_diameter": 1.75e-3}
    rows = sheet(evolvent, plain, tmp_path)
    assert rows["span_teeth"]["values"] == [6, 6]
    spans = [round(w * 1e3, 2) for w in rows["base_tangent_length"]["values"]]
    assert spans == [17.09, 17.18]
    balls = [round(m * 1e3, 3) for m in rows["dimension_over_balls"]["values"]]
    assert balls == [53.846, 55.064]
    plain["wheels"][1]["span_teeth"] = 1
    row = sheet(evolvent, plain, tmp_path)["base_tangent_length"]
    assert row["values"][1] is None
    assert row["note"] == "driven: k touches below the form circle; give span_teeth"


def test_tolerances_appear_with_a_class_only(
    evolvent: Evolvent, plain: dict[str, Any], tmp_path: Path
) -> None:
    assert "tolerance_class" not in sheet(evolvent, plain, tmp_path)
    plain["wheels"][0] |= {"teeth": 40, "module": 3e-3, "width": 0.03, "accuracy": {"class": 6}}
    plain["wheels"][1] |= {"teeth": 50, "module": 3e-3, "width": 0.03}
    rows = sheet(evolvent, plain, tmp_path)
    keys = [key for key in rows if key.endswith("_tolerance")]
    found = [value(rows, key) * 1e6 for key in keys]
    assert found == pytest.approx([9, 29, 7.5, 9.5, 12, 9, 10, 14], rel=1e-9)
    assert all(rows[key]["values"][1] is None for key in keys)
    assert "dynamic_factor_of_class" not in rows
    plain["wheels"][1]["accuracy"] = {"class": 7}
    assert "dynamic_factor_of_class" in sheet(evolvent, plain, tmp_path)


def test_class_tolerances_raise_the_dynamic_factor(
    evolvent: Evolvent, fzg: dict[str, Any], tmp_path: Path
) -> None:
    for wheel in fzg["wheels"]:
        wheel["accuracy"] = {"class": 6}
    rows = sheet(evolvent, fzg, tmp_path)
    w = value(rows, "tangential_force") / 0.014
    ratio, c = value(rows, "resonance_ratio"), value(rows, "single_stiffness_iso")
    pitch = max(rows["single_pitch_tolerance"]["values"]) * math.cos(math.radians(20))
    form = max(rows["profile_form_tolerance"]["values"])
    expected = 1 + ratio * (0.32 * c * pitch / w + 0.34 * c * form / w + 0.23)
    assert value(rows, "dynamic_factor_of_class") == pytest.approx(expected, rel=1e-12)
    assert value(rows, "dynamic_factor") == pytest.approx(1 + 0.23 * ratio, rel=1e-12)
    for wheel, amount in zip(fzg["wheels"], (1e-5, 2e-5), strict=True):
        wheel["accuracy"] = {"class": 5}
        wheel["tip_relief"] = {"amount": amount, "roll_angle": 28}
    row = sheet(evolvent, fzg, tmp_path)["dynamic_factor_of_class"]
    assert row["values"] == [None]
    assert row["note"] == "the tip reliefs of the two gears differ"


def test_the_order_of_the_wheels_in_the_file_changes_nothing(
    evolvent: Evolvent, fzg: dict[str, Any], tmp_path: Path
) -> None:
    mirrored = copy.deepcopy(fzg)
    mirrored["wheels"].reverse()
    rows, changed = sheet(evolvent, fzg, tmp_path), sheet(evolvent, mirrored, tmp_path)
    assert list(changed) == list(rows)
    for key, row in rows.items():
        numbers = [v for v in row.pop("values") if v is not None]
        found = [v for v in changed[key].pop("values") if v is not None]
        assert found == pytest.approx(numbers, rel=1e-12), key
        assert changed[key] == row


def test_driving_and_driven_gear_exchange_columns_and_points(
    evolvent: Evolvent, fzg: dict[str, Any], tmp_path: Path
) -> None:
    """If the other gear drives, the path is traversed from E to A, and the columns change."""
    rows = sheet(evolvent, fzg, tmp_path)
    mesh = fzg["meshes"][0]
    mesh |= {"driving": "gear", "driven": "pinion", "driving_rotation": "clockwise"}
    for wheel in fzg["wheels"]:
        for load in wheel["loads"]:
            load["torque" if load["kind"] == "drive" else "value"] *= -1
    exchanged = sheet(evolvent, fzg, tmp_path)
    assert list(exchanged) == list(rows)
    inverse = {"gear_ratio": -1}
    names = {"approach": "recess", "recess": "approach"}
    for key, row in rows.items():
        ended = re.fullmatch(r"(.*_)([a-e])", key)
        other = f"{ended[1]}{'edcba'[POINTS.index(ended[2])]}" if ended else names.get(key, key)
        found = exchanged[other]["values"]
        if None in row["values"]:
            assert found == row["values"][::-1]
            continue
        expected = [v ** inverse.get(key, 1) for v in reversed(row["values"])]
        if key in ("resonance_speed_iso", "resonance_speed_case"):
            expected = [v * 16 / 24 for v in expected]  # of the driving gear
        assert found == pytest.approx(expected, rel=1e-11, abs=1e-13), key


def test_stresses_are_proportional_to_loads_of_any_size(
    evolvent: Evolvent, fzg: dict[str, Any], tmp_path: Path
) -> None:
    """Also to loads below the scale of the integrator's errors."""
    rows = sheet(evolvent, fzg, tmp_path)
    for wheel in fzg["wheels"]:
        load = wheel["loads"][0]
        for key in {"torque", "value", "slope"} & set(load):
            load[key] *= 1e-8
    small = sheet(evolvent, fzg, tmp_path)
    for key, power in (("normal_force", 1.0), ("nominal_stress", 1.0), ("pressure_c", 0.5)):
        expected = [1e-8**power * v for v in rows[key]["values"]]
        assert small[key]["values"] == pytest.approx(expected, rel=1e-9), key


def test_scaled_lengths_scale_the_rows(
    evolvent: Evolvent, fzg: dict[str, Any], tmp_path: Path
) -> None:
    """Lengths times 2, torques times 4 at half the speed: the same pressures per width."""
    rows = sheet(evolvent, fzg, tmp_path)
    for wheel in fzg["wheels"]:
        for key in ("module", "thickness_allowance", "bore", "width", "tip_diameter"):
            wheel[key] *= 2
        load = wheel["loads"][0]
        for key in {"torque", "value", "slope"} & set(load):
            load[key] *= 8
        if load["kind"] == "drive":
            load["slope"] *= 2
            load["speed"] /= 2
    fzg["meshes"][0]["centre_distance"] *= 2
    scaled = sheet(evolvent, fzg, tmp_path)
    powers = {"m": 2.0, "1": 1.0, "rad": 1.0, "Pa": 1.0, "N": 4.0, "N m": 8.0, "N/m": 2.0}
    powers["rad/s"] = 0.5
    for key, row in rows.items():
        factor = powers[row["unit"]]
        expected = [v * factor for v in row["values"] if v is not None]
        found = [v for v in scaled[key]["values"] if v is not None]
        assert found == pytest.approx(expected, rel=1e-9, abs=1e-12), key


def test_units_of_the_case_do_not_matter(
    evolvent: Evolvent, fzg: dict[str, Any], tmp_path: Path
) -> None:
    rows = sheet(evolvent, fzg, tmp_path)
    fzg["wheels"][0] |= {"module": "4.5 mm", "bore": "3 cm", "width": "14000 um"}
    assert sheet(evolvent, fzg, tmp_path) == rows


@pytest.mark.parametrize(
    "path", [p for p in EXAMPLES if "sweep" not in p.stem], ids=lambda p: p.stem
)
def test_every_missing_value_has_a_reason(evolvent: Evolvent, path: Path) -> None:
    done = evolvent("datasheet", path, "--json")
    assert done.returncode == 0, done.stderr
    rows = json.loads(done.stdout)["rows"]
    assert all(row["note"] for row in rows if None in row["values"])
    assert all(v is None or math.isfinite(v) for row in rows for v in row["values"])
    keys = {row["key"] for row in rows}
    assert {"teeth", "centre_distance", "sliding_a", "pressure_c", "loss_factor"} <= keys


def test_gears_without_a_rack_have_the_rows_that_exist(evolvent: Evolvent, examples: Path) -> None:
    done = evolvent("datasheet", examples / "paper.yaml", "--json")
    rows = {row["key"]: row for row in json.loads(done.stdout)["rows"]}
    assert rows["normal_module"]["values"] == [None, None]
    assert rows["normal_module"]["note"] == "not defined: a gear without basic rack"
    for key in ("base_diameter", "contact_ratio", "sliding_a", "pressure_a", "pressure_e"):
        assert None not in rows[key]["values"], key
    # one pair from A to E: its points are at both ends
    assert rows["diameter_b"]["values"] == pytest.approx(rows["diameter_a"]["values"], rel=1e-12)
    assert rows["pressure_a"]["note"] == "single contact"


def test_every_key_of_the_sheet_is_documented(
    evolvent: Evolvent, fzg: dict[str, Any], tmp_path: Path
) -> None:
    for wheel in fzg["wheels"]:
        wheel |= {"accuracy": {"class": 6}, "compliance": {"model": "finite_elements"}}
    rows = sheet(evolvent, fzg, tmp_path)
    page = (EXAMPLES[0].parents[1] / "docs/reference/datasheet_format.md").read_text()
    table = page[page.index("| section | keys |") :]
    listed = re.findall(r"`(\w+)`", re.sub(r"`(\w+_)a` to `\w+_e`", _spread, table))
    assert sorted(listed) == sorted(rows)
    sections = re.findall(r"^\| ([^|`]+) \| `", table, re.MULTILINE)
    assert sections == list(dict.fromkeys(row["section"] for row in rows.values()))


def _spread(found: re.Match[str]) -> str:
    return " ".join(f"`{found[1]}{point}`" for point in POINTS)


class Cells(HTMLParser):
    """Cells of numbers of each row of a page, by its key; elements that are open."""

    def __init__(self) -> None:
        super().__init__()
        self.rows: dict[str, list[str]] = {}
        self.open: list[str] = []
        self.key, self.is_value = "", False

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        given = dict(attrs)
        if tag not in ("meta", "path", "circle", "col"):
            self.open.append(tag)
        if tag == "tr" and given.get("data-key"):
            self.key = str(given["data-key"])
            self.rows[self.key] = []
        self.is_value = tag == "td" and given.get("class") == "v"

    def handle_endtag(self, tag: str) -> None:
        if tag not in ("meta", "path", "circle", "col"):
            assert self.open.pop() == tag
        self.is_value = False

    def handle_data(self, data: str) -> None:
        if self.is_value:
            self.rows[self.key].append(data)


def test_all_formats_have_the_same_table(
    evolvent: Evolvent, fzg: dict[str, Any], tmp_path: Path
) -> None:
    rows = sheet(evolvent, fzg, tmp_path)
    case = tmp_path / "sheet-case.yaml"
    for end in ("html", "md", "json"):
        done = evolvent("datasheet", case, "-q", "-o", f"sheet.{end}", cwd=tmp_path)
        assert (done.returncode, done.stdout, done.stderr) == (0, "", "")
    text = evolvent("datasheet", case).stdout
    in_json = {row["key"]: row for row in json.loads((tmp_path / "sheet.json").read_text())["rows"]}
    assert in_json == rows
    page = Cells()
    page.feed((tmp_path / "sheet.html").read_text())
    assert page.open == []
    assert list(page.rows) == list(rows)
    markdown = (tmp_path / "sheet.md").read_text()
    tables = [line.split("|") for line in markdown.splitlines() if line.startswith("| ")]
    tables = [cells for cells in tables if cells[1] != " quantity "]
    lines = [line for line in text.splitlines() if line.startswith("  ")]
    assert len(tables) == len(lines) == len(rows)
    for (key, row), cells, line in zip(rows.items(), tables, lines, strict=True):
        numbers = page.rows[key]
        assert len(numbers) == len(row["values"])
        assert [cells[4].strip(), cells[5].strip()][: len(numbers)] == numbers
        assert line.split("[")[0].split()[-len(numbers) :] == numbers
        assert row["text"] in line
    assert value(rows, "pressure_c") / 1e6 == pytest.approx(float(page.rows["pressure_c"][0]), 1e-6)
    assert "<svg" in (tmp_path / "sheet.html").read_text()


@pytest.mark.parametrize(
    ("words", "code", "message"),
    [
        (("-o", "sheet.txt"), 2, "option '-o' needs a file that ends in .html, .md or .json"),
        (("-o", ".html"), 2, "option '-o' needs a file that ends in .html, .md or .json"),
        (("--mesh", "piniongear"), 2, "the case has no such mesh"),
        (("--mesh", "2"), 2, "the case has no such mesh"),
        (("--set", "wheels.pinion.span_teeth=0"), 3, "wheels.pinion.span_teeth: is 0"),
        (("--set", "wheels.pinion.ball_diameter=-1"), 3, "wheels.pinion.ball_diameter: is -1 m"),
        (("-o", "nowhere/sheet.md"), 74, "cannot write"),
    ],
)
def test_wrong_options_are_refused(
    evolvent: Evolvent,
    examples: Path,
    words: tuple[str, ...],
    code: int,
    message: str,
    tmp_path: Path,
) -> None:
    done = evolvent("datasheet", examples / "spur-pair.yaml", *words, cwd=tmp_path)
    assert (done.returncode, done.stdout) == (code, "")
    assert message in done.stderr
    assert not list(tmp_path.iterdir())


def test_an_unloaded_mesh_has_no_pressure(
    evolvent: Evolvent, plain: dict[str, Any], tmp_path: Path
) -> None:
    for wheel in plain["wheels"]:
        del wheel["loads"]
    rows = sheet(evolvent, plain, tmp_path)
    for key in ("normal_force", "pressure_c", "single_stiffness_iso", "dynamic_factor"):
        assert rows[key]["values"] == [None]
        assert rows[key]["note"] == "no nominal load of this mesh"
    assert value(rows, "loss_factor") > 0
