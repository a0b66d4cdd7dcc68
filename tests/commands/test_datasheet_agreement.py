"""`evolvent datasheet` against `show`, mirror images and other descriptions of the same mesh."""

from __future__ import annotations

import copy
import json
import re
from html.parser import HTMLParser
from pathlib import Path
from typing import Any

import pytest
import yaml

from commands.datasheet_cases import (
    EXAMPLES,
    Evolvent,
    Rows,
    fzg_gears,
    pair,
    plain_gears,
    sheet,
    value,
)

ELEMENTS = {"compliance": {"model": "finite_elements"}}
# Rows of the sheet with another key than in `show`.
OF_ROOT_STRESS = {"root_tension": "tension", "root_compression": "compression"}
OF_COMPLIANCE = {
    **{"single_stiffness": "single_pair", "double_stiffness": "double_pair"},
    "single_stiffness_iso": "iso_6336",
}
OF_BOTH_WHEELS = ("pitch_diameter", "active_diameter", "tip_clearance")


def printed(evolvent: Evolvent, *words: object) -> dict[str, Any]:
    done = evolvent(*words, "--json")
    assert done.returncode == 0, done.stderr
    result: dict[str, Any] = json.loads(done.stdout)
    return result


def without_missing(values: list[float | None]) -> list[float]:
    return [v for v in values if v is not None]


def assert_close(found: Rows, expected: Rows) -> None:
    """Assert that two sheets have the same rows, and values up to rounding."""
    assert list(found) == list(expected)
    for key, row in expected.items():
        values, others = row["values"], found[key]["values"]
        assert [v is None for v in values] == [v is None for v in others], key
        assert without_missing(others) == pytest.approx(without_missing(values), rel=1e-12), key


def shown_values(
    shown: dict[str, Any], mesh: str, wheels: list[str], key: str, n: int
) -> list[float | None] | None:
    """Values of `show` for a row of the sheet; None if it has no such quantity."""
    gears = [shown["wheels"][name].get("gear", {}) for name in wheels]
    if n == 2 and all(key in gear for gear in gears):
        return [gear[key] for gear in gears]
    of_mesh = {**shown["meshes"][mesh], **shown["meshes"][mesh].get("gear", {})}
    if key in OF_BOTH_WHEELS and f"{key}_driving" in of_mesh:
        return [of_mesh[f"{key}_{side}"] for side in ("driving", "driven")]
    if key in of_mesh:
        return [of_mesh[key]]
    root = shown["root_stress"].get(mesh, {})
    of_root = OF_ROOT_STRESS.get(key, key)
    if n == len(root) == 2 and of_root in root["driving"]:
        return [root[side][of_root] for side in ("driving", "driven")]
    of_compliance = shown["compliance"].get(mesh, {})
    if OF_COMPLIANCE.get(key) in of_compliance:
        return [of_compliance[OF_COMPLIANCE[key]]]
    return None


@pytest.mark.parametrize(
    "path", [p for p in EXAMPLES if "sweep" not in p.stem], ids=lambda p: p.stem
)
def test_show_and_the_sheet_have_the_same_numbers(evolvent: Evolvent, path: Path) -> None:
    """To the bit, and the same symbols in the texts of both."""
    shown = printed(evolvent, "show", path)
    for mesh in shown["meshes"]:
        result = printed(evolvent, "datasheet", path, "--mesh", mesh)
        n_shared = 0
        for row in result["rows"]:
            expected = shown_values(shown, mesh, result["wheels"], row["key"], len(row["values"]))
            if expected is not None:
                assert row["values"] == expected, row["key"]
                n_shared += 1
        has_racks = "gear" in shown["meshes"][mesh]
        assert n_shared >= (35 if has_racks else 5)
        n_shared = sum(row["key"] in OF_ROOT_STRESS for row in result["rows"])
        assert n_shared == (2 if mesh in shown["root_stress"] else 0)


def test_a_mirrored_case_has_the_same_sheet(evolvent: Evolvent, tmp_path: Path) -> None:
    """The opposite sense of rotation, of the torques, and the centre line turned."""
    case = fzg_gears()
    for wheel in case["wheels"]:
        wheel |= {**ELEMENTS, "accuracy": {"class": 6}}
    rows = sheet(evolvent, case, tmp_path)
    case["meshes"][0] |= {"driving_rotation": "clockwise", "centre_line_angle": 130}
    for wheel in case["wheels"]:
        for load in wheel["loads"]:
            load.update({k: -load[k] for k in ("torque", "speed", "value") if k in load})
    assert sheet(evolvent, case, tmp_path) == rows


def test_root_stress_of_the_driving_gear_is_that_of_the_driven_one(
    evolvent: Evolvent, tmp_path: Path
) -> None:
    """Two equal gears have equal columns; the stress does not depend on which of them drives."""
    gear = {"teeth": 30, "module": 2e-3, "bore": 0.02, **ELEMENTS}
    case = pair(gear, copy.deepcopy(gear), backlash=1e-4)
    case["wheels"][0]["loads"] = [{"kind": "torque", "value": 20.0}]
    case["wheels"][1]["loads"] = [{"kind": "torque", "value": 20.0}]
    rows = sheet(evolvent, case, tmp_path)
    for key, row in rows.items():
        if len(row["values"]) == 2 and not key.startswith(("diameter_", "curvature_", "sliding_")):
            assert row["values"][0] == pytest.approx(row["values"][1], rel=1e-12), key
    assert value(rows, "root_tension") > 0 > value(rows, "root_compression")
    assert "uniform over the face width" in rows["root_tension"]["note"]
    product = value(rows, "form_factor") * value(rows, "stress_correction_factor")
    # F_t/(b m) Y_F Y_S
    expected = value(rows, "tangential_force") / (0.02 * 2e-3) * product
    assert value(rows, "nominal_stress") == pytest.approx(expected, rel=1e-12)


def test_a_reversed_torque_loads_the_coast_flanks_alike(evolvent: Evolvent, tmp_path: Path) -> None:
    case = plain_gears()
    case["meshes"][0]["backlash"] = 1e-4
    for wheel in case["wheels"]:
        wheel |= {**ELEMENTS, "bore": 0.012, "profile_shift": 0.1}
    case["wheels"][1]["loads"] = [{"kind": "torque", "value": 20.0 * 43 / 17}]
    rows = sheet(evolvent, case, tmp_path)
    for wheel in case["wheels"]:
        wheel["loads"][0]["value"] *= -1
    reversed_rows = sheet(evolvent, case, tmp_path)
    assert reversed_rows["normal_force"]["note"] == "on the coast flanks"
    assert_close(reversed_rows, rows)


@pytest.mark.parametrize(
    ("gear", "reason"),
    [
        ({"teeth": 12, "module": 2e-3}, "no formula for an undercut gear"),
        (
            {"teeth": 80, "module": 2e-3, "rack": {"addendum": 1.6, "dedendum": 1.8}},
            "contact ratio of 2 or more: no position with a single pair",
        ),
    ],
)
def test_no_nominal_root_stress_has_a_reason(
    evolvent: Evolvent, tmp_path: Path, gear: dict[str, Any], reason: str
) -> None:
    if "rack" in gear:
        gear["rack"]["root_radius"] = 0.1
        gear["pressure_angle"] = 14.5
    case = pair(gear, {**gear, "teeth": 80})
    case["wheels"][0]["loads"] = [{"kind": "torque", "value": 20.0}]
    row = sheet(evolvent, case, tmp_path)["nominal_stress"]
    assert None in row["values"]
    assert row["note"] == reason


def train(first: dict[str, Any], second: dict[str, Any]) -> dict[str, Any]:
    """Return two pairs as the stages of a train on a rigid shaft, the load of the first pair."""
    case = copy.deepcopy(first)
    for wheel in (*case["wheels"], *second["wheels"]):
        wheel.pop("loads", None)
    case["wheels"][0]["loads"] = [{"kind": "torque", "value": 20.0}]
    for wheel in copy.deepcopy(second["wheels"]):
        case["wheels"].append({**wheel, "name": f"{wheel['name']}-2", "axial_position": 0.1})
    case["wheels"][3]["loads"] = [{"kind": "viscous", "coefficient": 0.5}]
    stage = {**second["meshes"][0], "driving": "pinion-2", "driven": "gear-2"}
    stage["driving_rotation"] = "clockwise"
    case["meshes"] = [
        {**case["meshes"][0], "name": "slow"},
        {**stage, "name": "fast"},
    ]
    case["shafts"] = [{"name": "shaft", "kind": "rigid", "wheels": ["gear", "pinion-2"]}]
    return case


def test_a_stage_of_a_train_has_the_sheet_of_its_pair(evolvent: Evolvent, tmp_path: Path) -> None:
    """By name and by index; its load is that of the train, and its resonance that of its gears."""
    first, second = plain_gears(), fzg_gears()
    alone = sheet(evolvent, second, tmp_path)
    case = train(first, second)
    rows = sheet(evolvent, case, tmp_path, "--mesh", "fast")
    assert sheet(evolvent, case, tmp_path, "--mesh", "1") == rows
    assert sheet(evolvent, case, tmp_path, "--mesh", "slow") == sheet(evolvent, case, tmp_path)
    of_load = ("Nominal load", "Hertz pressure", "Root stress", "Stiffness per width", "Dynamics")
    assert_close(
        *({k: r for k, r in a.items() if r["section"] not in of_load} for a in (rows, alone))
    )
    assert value(rows, "torque") == pytest.approx(20 * 43 / 17, rel=1e-9)


class Page(HTMLParser):
    """All texts of a page."""

    def __init__(self) -> None:
        super().__init__()
        self.texts: list[str] = []
        self.tags: set[str] = set()

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.tags.add(tag)

    def handle_data(self, data: str) -> None:
        self.texts.append(data)


NAMES = ("<b>&amp;|\"'`*_", "zahnräder→齿轮")


def test_names_of_the_case_are_escaped(evolvent: Evolvent, tmp_path: Path) -> None:
    case = fzg_gears()
    case["title"] = "- <script>alert(1)</script> & *stars* | bars\n# line"
    case["meshes"][0] |= {"name": "m<i>|&", "driving": NAMES[0], "driven": NAMES[1]}
    for wheel, name in zip(case["wheels"], NAMES, strict=True):
        wheel["name"] = name
    sheet(evolvent, case, tmp_path)
    path = tmp_path / "sheet-case.yaml"
    for end in ("html", "md", "json"):
        done = evolvent("datasheet", path, "-q", "-o", tmp_path / f"x.{end}")
        assert done.returncode == 0, done.stderr
    page = Page()
    page.feed((tmp_path / "x.html").read_text())
    assert not page.tags & {"script", "b"}
    whole = "\n".join(page.texts)
    assert all(name in text for name in NAMES for text in [whole])
    assert case["title"] in whole.replace("\r", "")
    written = json.loads((tmp_path / "x.json").read_text())
    assert (written["mesh"], written["wheels"]) == ("m<i>|&", list(NAMES))
    markdown = (tmp_path / "x.md").read_text()
    bare = re.sub(r"\\.", "", markdown)  # without the characters that are escaped
    assert "<" not in bare
    lines = [line for line in bare.splitlines() if line.startswith("| ")]
    assert {line.count("|") for line in lines} == {7}
    starts = {line[:2] for line in markdown.splitlines()}
    assert starts <= {"# ", "##", "| ", "|-", "Ca", ""}
    text = evolvent("datasheet", path).stdout.splitlines()
    heading = next(line for line in text if line.startswith("Basic rack"))
    values = next(line for line in text if "normal module" in line)
    assert len(heading) == len(values)


def test_units_of_pages_have_their_symbols(evolvent: Evolvent, tmp_path: Path) -> None:
    """Micrometres, degrees and products; the text stays in ASCII."""
    case = fzg_gears()
    sheet(evolvent, case, tmp_path)
    path = tmp_path / "sheet-case.yaml"
    for end in ("html", "md"):
        assert evolvent("datasheet", path, "-q", "-o", tmp_path / f"x.{end}").returncode == 0
        page = (tmp_path / f"x.{end}").read_text()
        for unit in ("µm", "N/(mm·µm)", "N·m", "°", "MPa"):
            assert unit in page
        assert not re.search(r"\bum\b|\bdeg\b|N m\b", page)
    text = evolvent("datasheet", path).stdout
    assert text.isascii()
    assert "N/(mm um)" in text


def test_the_sheet_of_a_case_with_other_units_is_the_same(
    evolvent: Evolvent, tmp_path: Path
) -> None:
    case = fzg_gears()
    rows = sheet(evolvent, case, tmp_path)
    case["wheels"][0]["loads"][0] |= {"speed": "2250 rpm", "torque": "0.302 kN m"}
    case["meshes"][0]["centre_distance"] = "9.15 cm"
    assert_close(sheet(evolvent, case, tmp_path), rows)


def test_datasheet_reads_a_title_of_several_lines(evolvent: Evolvent, tmp_path: Path) -> None:
    """A title of YAML's block style does not break the table of Markdown."""
    case = plain_gears()
    path = tmp_path / "c.yaml"
    path.write_text(yaml.safe_dump(case, sort_keys=False) + "title: |\n  one\n  - two\n")
    assert evolvent("datasheet", path, "-q", "-o", tmp_path / "c.md").returncode == 0
    assert "one - two" in (tmp_path / "c.md").read_text()
