"""Dependencies: every use, include and import against the table of modules, and no cycles."""

from __future__ import annotations

import importlib.util
import re
import shutil
import subprocess
import sys
from pathlib import Path
from types import ModuleType

import pytest

ROOT = Path(__file__).resolve().parents[2]
PAGE = next((ROOT / "docs").rglob("architecture.md"))
TREES = ["src", "driver", "postprocess"]


@pytest.fixture(scope="module")
def modules() -> ModuleType:
    """Give tools/modules.py as a module."""
    spec = importlib.util.spec_from_file_location("modules", ROOT / "tools" / "modules.py")
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    sys.modules[spec.name] = module
    spec.loader.exec_module(module)
    return module


@pytest.fixture
def copy(tmp_path: Path) -> Path:
    """Give a copy of the code and its table, to be spoiled."""
    for tree in TREES:
        shutil.copytree(ROOT / tree, tmp_path / tree, ignore=shutil.ignore_patterns("__pycache__"))
    (tmp_path / "docs").mkdir()
    shutil.copy(next((ROOT / "docs").rglob("modules.toml")), tmp_path / "docs")
    return tmp_path


def test_no_arrow_runs_up(modules: ModuleType) -> None:
    assert modules.faults(ROOT) == []


def test_the_command_says_nothing_and_ends_well() -> None:
    run = subprocess.run(
        [sys.executable, ROOT / "tools" / "modules.py"], capture_output=True, text=True, check=False
    )
    assert (run.returncode, run.stdout) == (0, "")


@pytest.mark.parametrize(
    ("file", "line", "said"),
    [
        (
            "src/laws/johnson.f90",
            "   use evl_gearbox, only: gearbox_t",
            "laws may not depend on gearbox",
        ),
        ("src/geometry/gear.f90", "   use evl_law_table", "geometry may not depend on laws"),
        ("src/numerics/kinds.f90", '   include "laws/x.inc"', "numerics may not depend on laws"),
        ("driver/base/log.c", '#include "case/case.h"', "base may not depend on case"),
        (
            "driver/integrate/integrate.c",
            '#include "case/case.h"',
            "integrate may not depend on case",
        ),
        ("driver/case/case.c", "#include <evolvent/kernel.h>", "only model may depend on"),
        ("driver/model/model.c", "#include <ida/ida.h>", "only integrate may depend on ida/"),
        ("driver/batch/batch.c", "#include <hdf5.h>", "only files may depend on hdf5"),
        (
            "postprocess/evolvent/history/files.py",
            "from ..pages import report",
            "history may not depend on",
        ),
        (
            "postprocess/evolvent/physics/teeth.py",
            "import evolvent.figures",
            "may not depend on figures",
        ),
        (
            "postprocess/evolvent/physics/teeth.py",
            "from evolvent import (\n    pages,\n)",
            "may not depend on pages",
        ),
    ],
)
def test_an_arrow_that_runs_up_is_named(
    modules: ModuleType, copy: Path, file: str, line: str, said: str
) -> None:
    spoiled = copy / file
    spoiled.write_text(line + "\n" + spoiled.read_text())
    found = modules.faults(copy)
    assert len(found) == 1
    assert said in found[0]
    assert found[0].startswith(f"{file}:1: ")


@pytest.mark.parametrize(
    ("files", "cycle"),
    [
        (
            {
                "src/laws/one.f90": "module evl_one\n   use evl_two, only: two\nend module\n",
                "src/laws/two.f90": 'module evl_two\n   include "laws/three.inc"\nend module\n',
                "src/laws/three.inc": "   use evl_one, only: one\n",
            },
            ["src/laws/one.f90:2", "src/laws/two.f90:2", "src/laws/three.inc:1"],
        ),
        (
            {
                "driver/case/one.h": "#pragma once\n",
                "driver/case/one.c": '#include "case/one.h"\n#include "case/two.h"\n',
                "driver/case/two.h": '#include "case/one.h"\n',
            },
            ["driver/case/one.c:2", "driver/case/two.h:1"],
        ),
        (
            {
                "postprocess/evolvent/physics/one.py": "from evolvent.physics.two import two\n",
                "postprocess/evolvent/physics/two.py": (
                    "def two() -> None:\n    from . import one\n\n    one.two()\n"
                ),
            },
            ["postprocess/evolvent/physics/one.py:1", "postprocess/evolvent/physics/two.py:2"],
        ),
    ],
    ids=["Fortran", "C", "Python"],
)
def test_a_cycle_of_files_is_named(
    modules: ModuleType, copy: Path, files: dict[str, str], cycle: list[str]
) -> None:
    for name, text in files.items():
        (copy / name).write_text(text)
    found = modules.faults(copy)
    assert len(found) == 1
    assert found[0].startswith(f"{cycle[0]}: cycle of files: {' -> '.join([*cycle, cycle[0]])}; ")


def test_each_cycle_of_a_module_is_named(modules: ModuleType, copy: Path) -> None:
    folder = copy / "driver" / "case"
    for first, second in (("one", "two"), ("three", "four")):
        (folder / f"{first}.h").write_text(f'#include "case/{second}.h"\n')
        (folder / f"{second}.h").write_text(f'#include "case/{first}.h"\n')
    found = modules.faults(copy)
    assert [line.split(":")[0] for line in found] == ["driver/case/four.h", "driver/case/one.h"]


def test_an_import_for_types_alone_is_no_cycle(modules: ModuleType, copy: Path) -> None:
    folder = copy / "postprocess" / "evolvent" / "physics"
    (folder / "one.py").write_text("import evolvent.physics.two\n")
    (folder / "two.py").write_text(
        "from typing import TYPE_CHECKING\n\nif TYPE_CHECKING:\n    import evolvent.physics.one\n"
    )
    assert modules.faults(copy) == []


@pytest.mark.parametrize(
    "file", ["src/stray.f90", "driver/new/stray.c", "postprocess/evolvent/stray.py"]
)
def test_a_file_outside_all_modules_is_named(modules: ModuleType, copy: Path, file: str) -> None:
    (copy / file).parent.mkdir(exist_ok=True)
    (copy / file).write_text("\n")
    assert modules.faults(copy) == [f"{file}: belongs to no module"]


def test_every_arrow_of_the_code_is_read(modules: ModuleType) -> None:
    """As many as a plain count of the lines finds: none escapes for its form."""
    for tree in modules.trees(ROOT):
        arrows = list(modules.arrows(tree))
        pattern = {
            "Fortran": r"^ *(?:use +evl_|submodule|include )",
            "C": r"^ *# *include ",
            "Python": r"^ *(?:from +(?:\.|evolvent)|import +evolvent)",
        }[tree.language]
        for file in tree.files():
            lines = re.findall(pattern, (tree.folder / file).read_text(), re.MULTILINE)
            read = {arrow.line for arrow in arrows if arrow.file == file} if lines else set()
            assert len(read) == len(lines), file


def test_a_module_is_named_as_its_file() -> None:
    for file in (ROOT / "src").rglob("*.f90"):
        assert re.search(
            rf"^(?:submodule.*|module) evl_{file.stem}$", file.read_text(), re.MULTILINE
        ), file


def test_what_is_made_from_the_code_is_the_codes(modules: ModuleType) -> None:
    assert modules.page(PAGE.read_text(), ROOT) == PAGE.read_text()


def test_every_result_variable_has_one_file(modules: ModuleType) -> None:
    """But for extremes, which stand where their outputs stand."""
    listed = re.findall(r"`(\w+)`", modules.variables(ROOT).split("|---|---|")[1])
    names = [name for name in listed if "/" not in name]
    assert sorted(set(names)) == sorted(names)
    text = modules.page_file(ROOT, "result_format.md").read_text()
    section = text.split("## Variables")[1].split("## Extremes")[0]
    reported = {
        name
        for cell in re.findall(r"^\| ([^|]*) \|", section, re.MULTILINE)
        for name in re.findall(r"`(\w+)`", cell)
    }
    assert reported - set(names) == set()


def test_every_block_of_a_case_is_in_the_table_of_keys() -> None:
    text = next((ROOT / "docs").rglob("case_format.md")).read_text()
    blocks = re.findall(r"^### (\w+)$", text.split("## All keys")[1], re.MULTILINE)
    section = PAGE.read_text().split("## Where a case key lives")[1].split("\n## ")[0]
    assert re.findall(r"^\| (\w+) \|", section, re.MULTILINE)[1:] == blocks


def _is_file(name: str) -> bool:
    return any(
        (ROOT / base / name).exists() for base in ("", "src", "driver", "postprocess/evolvent")
    )


@pytest.mark.parametrize(
    "page",
    [ROOT / "README.md", ROOT / "CONTRIBUTING.md", *sorted((ROOT / "docs").rglob("*.md"))],
    ids=lambda page: page.name,
)
def test_files_that_a_page_names_exist(page: Path) -> None:
    text = re.sub(r"^```.*?^```$", "", page.read_text(), flags=re.MULTILINE | re.DOTALL)
    named = re.findall(r"`([\w.-]+/[\w./-]+\.(?:f90|inc|c|h))`", text)
    named += re.findall(
        r"`((?:src|driver|tests|tools|cmake|benchmarks|postprocess)/[\w./-]*)`", text
    )
    assert [name for name in named if not _is_file(name) and not (ROOT / name).exists()] == []
