"""CONTRIBUTING.md names what exists: options, presets, commands, identifiers."""

from __future__ import annotations

import json
import re
from functools import cache
from pathlib import Path

import pytest

from documents import ROOT

TEXT = (ROOT / "CONTRIBUTING.md").read_text("utf-8")
TREES = ("src", "driver", "postprocess", "tests", "tools", "cmake", "benchmarks")
SUFFIXES = {".f90", ".inc", ".c", ".h", ".py", ".txt", ".cmake", ".toml"}
INDENTED = [line.strip() for line in re.findall(r"^ {4}(\S.*)$", TEXT, re.MULTILINE)]


@cache
def code() -> str:
    """All text of the code but this file."""
    files = [path for tree in TREES for path in (ROOT / tree).rglob("*")]
    files = [path for path in files if path.suffix in SUFFIXES and path != Path(__file__)]
    files += [ROOT / name for name in ("CMakeLists.txt", "pyproject.toml", "runtests")]
    return "\n".join(path.read_text("utf-8") for path in files)


def test_its_table_has_every_option_of_cmake() -> None:
    listed = set(re.findall(r"`(EVOLVENT_\w+)`", TEXT.split("| CMake option ")[1].split("\n\n")[0]))
    cmake = [ROOT / "CMakeLists.txt", *(ROOT / "cmake").glob("*.cmake")]
    pattern = r"^(?:cmake_dependent_option|option|set)\(\s*(EVOLVENT_\w+)\s+\"[^\"]*\"(.*)$"
    options = {
        name
        for path in cmake
        for name, rest in re.findall(pattern, path.read_text(), re.MULTILINE)
        if "PARENT_SCOPE" not in rest
    }
    assert listed == options


def test_its_presets_exist() -> None:
    presets = json.loads((ROOT / "CMakePresets.json").read_text())
    kinds = {"cmake": "configurePresets", "cmake --build": "buildPresets", "ctest": "testPresets"}
    named = re.findall(r"\b(cmake|cmake --build|ctest) --preset (\w+)", TEXT)
    assert {command for command, _ in named} == set(kinds)
    for command, preset in named:
        assert preset in [one["name"] for one in presets[kinds[command]]]


def test_its_scripts_are_executable() -> None:
    named = set(
        re.findall(r"(?:^|[ `])(?:\./)?((?:tools|benchmarks|\.ci)/[\w-]+|runtests)\b", TEXT)
    )
    scripts = [ROOT / name for name in named if (ROOT / name).is_file()]
    assert len(scripts) >= 6
    for script in scripts:
        assert script.stat().st_mode & 0o111, script


@cache
def words() -> set[str]:
    """All identifiers of the code."""
    return set(re.findall(r"[A-Za-z_]\w*", code()))


@pytest.mark.parametrize("name", sorted(set(re.findall(r"`([A-Za-z_]\w*)(?:\([^`]*\))?`", TEXT))))
def test_an_identifier_is_one_of_the_code(name: str) -> None:
    assert name in words() or (ROOT / name).exists()


def test_its_examples_of_rows_have_the_form_of_the_code() -> None:
    """The output is one of the code; the event, which is new, has the next number."""
    output = re.search(r"^ +call add_output\((?:.*&\n)*.*\)$", TEXT, re.MULTILINE)
    assert output
    assert " ".join(output[0].split()) in " ".join(code().split())
    event = re.search(r"integer :: sliding_turned = (\d+)", TEXT)
    assert event
    kinds = (ROOT / "src/contact/root_kinds.f90").read_text()
    numbers = re.findall(
        r"\w+ = (\d+)", kinds.split("type :: root_numbers")[1].split("end type")[0]
    )
    assert int(event[1]) == max(map(int, numbers)) + 1
