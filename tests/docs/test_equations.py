"""Every numbered equation of the documentation has its procedure, and every procedure exists."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Callable
from functools import cache
from pathlib import PurePosixPath

import pytest

from documents import ROOT

NAME = "equations.md"
LABEL = re.compile(r"\\text\{\(([A-Z]+)(\d+)\)\}")
DISPLAY = re.compile(r"^ *```math\n(.*?)^ *```|\$\$(.+?)\$\$", re.MULTILINE | re.DOTALL)
TOPIC = re.compile(r"^Page [^\n]*?([\w-]+\.md)[`)]\.$", re.MULTILINE)
ROW = re.compile(r"^\| ([A-Z]+\d+) \| [^|]+ \| ([^|]+) \| ([^|]*) \| [^|]+ \|$", re.MULTILINE)
DERIVATION = re.compile(r"derivation of ([A-Z]+\d+)")
CITED = re.compile(r"\b[Ee]quations? ((?:[A-Z]+\d+(?:, | and )?)+)")
CODE = {"src": {".f90", ".inc"}, "driver": {".c"}, "postprocess": {".py"}}
NOT_EVALUATED = "not evaluated"

Read = Callable[[str], str | None]


def documents() -> dict[str, str]:
    """Text of every page by its path; names of pages are unique."""
    pages = sorted((ROOT / "docs").rglob("*.md"))
    return {str(page.relative_to(ROOT)): page.read_text(encoding="utf-8") for page in pages}


def read(file: str) -> str | None:
    """Text of a file of the repository; None if there is no such file."""
    path = ROOT / file
    return path.read_text(encoding="utf-8") if path.is_file() else None


@cache
def procedures_of(file: str, text: str) -> set[str]:
    """Names of the procedures that a Fortran, C or Python file defines, in lower case."""
    match PurePosixPath(file).suffix:
        case ".f90" | ".inc":
            forms = "subroutine|function"
            if re.search(r"^submodule\b", text, re.MULTILINE):
                forms += "|module procedure"
            pattern = rf"^ *(?!end\b|!)[^!\n'\"]*?\b(?:{forms}) +(\w+)"
        case ".c":
            pattern = r"^[A-Za-z_][^;{}()=]*?\b(\w+)\([^;{}]*\)\s*\{"
        case ".py":
            pattern = r"^ *def (\w+)\("
        case _:
            return set()
    return {name.lower() for name in re.findall(pattern, text, re.MULTILINE | re.IGNORECASE)}


def rows_of(table: str) -> dict[str, list[tuple[str, str, list[str]]]]:
    """Label, file and procedures of every row, by the page of its topic."""
    topics = TOPIC.split(table)[1:]
    return {
        page: [
            (label, file, re.findall(r"`(\w+)`", names)) for label, file, names in ROW.findall(rows)
        ]
        for page, rows in zip(topics[::2], topics[1::2], strict=True)
    }


def labels_of(pages: dict[str, str]) -> tuple[dict[str, str], list[str]]:
    """Name of the page of every label, and what is wrong with labels."""
    wrong: list[str] = []
    where: dict[str, str] = {}
    prefixes: dict[str, str] = {}
    for path, text in pages.items():
        name = PurePosixPath(path).name
        if name == NAME:
            continue
        for display in DISPLAY.finditer(text):
            formula = display[1] or display[2]
            if len(LABEL.findall(formula)) != 1:
                line = text.count("\n", 0, display.start()) + 1
                wrong.append(f"{path}:{line}: a display formula needs one label")
        counts = Counter(f"{prefix}{number}" for prefix, number in LABEL.findall(text))
        for label, count in counts.items():
            if count > 1 or label in where:
                wrong.append(f"{path}: label {label} occurs more than once")
            where[label] = name
        for prefix in {prefix for prefix, _ in LABEL.findall(text)}:
            if prefixes.setdefault(prefix, name) != name:
                wrong.append(f"{path}: labels {prefix} belong to {prefixes[prefix]}")
    return where, wrong


def table_of(pages: dict[str, str]) -> str:
    """Text of the page of equations."""
    return pages[page_of(pages, NAME)]


def page_of(pages: dict[str, str], name: str) -> str:
    """Path of a page."""
    [path] = [path for path in pages if PurePosixPath(path).name == name]
    return path


def faults(pages: dict[str, str], read: Read) -> list[str]:
    """What is wrong with labels and rows."""
    where, wrong = labels_of(pages)
    evaluated: set[str] = set()
    derived: dict[str, str] = {}
    seen: set[str] = set()
    rows_of_pages = rows_of(table_of(pages))
    for page, rows in rows_of_pages.items():
        for label, file, names in rows:
            seen.add(label)
            if where.get(label) != page:
                wrong.append(f"{label}: {page} has no such label")
            if derivation := DERIVATION.fullmatch(file):
                derived[label] = derivation[1]
            elif file != NOT_EVALUATED:
                evaluated.add(label)
                wrong += [f"{label}: {fault}" for fault in faults_of_row(file, names, read)]
    lines = len(re.findall(r"^\|", table_of(pages), re.MULTILINE))
    if lines != sum(len(rows) + 2 for rows in rows_of_pages.values()):
        wrong.append(f"{NAME}: a row of a table has another form")
    wrong += [f"{label}: no row" for label in where if label not in seen]
    wrong += [
        f"{label}: derivation of {target}, which no procedure evaluates"
        for label, target in derived.items()
        if target not in evaluated
    ]
    return wrong


def faults_of_row(cell: str, names: list[str], read: Read) -> list[str]:
    """What is wrong with file and procedures of a row."""
    file = cell.strip("`")
    text = read(file)
    if text is None:
        return [f"no file {file}"]
    if not names:
        return [f"no procedure of {file} is named"]
    defined = procedures_of(file, text)
    return [f"{file} does not define {name}" for name in names if name.lower() not in defined]


@pytest.fixture
def pages() -> dict[str, str]:
    """Give the documentation, to be spoiled."""
    return documents()


def test_every_equation_has_its_procedure(pages: dict[str, str]) -> None:
    assert faults(pages, read) == []


def cited(text: str) -> set[str]:
    """Labels that comments cite: 'Equation T71', 'Equations T24, TR3'."""
    return {label for group in CITED.findall(text) for label in re.findall(r"[A-Z]+\d+", group)}


def test_a_label_cited_in_a_file_has_a_row_with_this_file(pages: dict[str, str]) -> None:
    rows = {
        (file.strip("`"), label)
        for of_page in rows_of(table_of(pages)).values()
        for label, file, _ in of_page
    }
    found = {
        (str(path.relative_to(ROOT)), label)
        for tree, suffixes in CODE.items()
        for path in (ROOT / tree).rglob("*")
        if path.suffix in suffixes
        for label in cited(path.read_text(encoding="utf-8"))
    }
    assert found <= rows
    assert len(found) > 0.8 * len(rows)


def renamed(file: str, old: str, new: str) -> Read:
    """Read the repository with a name replaced in one file."""

    def spoiled(requested: str) -> str | None:
        text = read(requested)
        return re.sub(rf"\b{old}\b", new, text) if text and requested == file else text

    return spoiled


@pytest.mark.parametrize(
    ("file", "procedure"),
    [
        ("src/contact/closed_form.inc", "gap_along"),
        ("src/integrator/stage_errors.f90", "estimate_error"),
        ("src/laws/radzimovsky.f90", "johnson_of_larger_radii"),
        ("driver/respond/orbit.c", "has_come_to"),
        ("driver/simulate/metric_channel.c", "add_at_nodes"),
        ("postprocess/evolvent/signals/spectrum.py", "line_spectrum"),
    ],
)
def test_a_renamed_procedure_is_found(pages: dict[str, str], file: str, procedure: str) -> None:
    found = faults(pages, renamed(file, procedure, "another_name"))
    assert found
    assert all(fault.endswith(f"{file} does not define {procedure}") for fault in found)


def test_a_call_is_no_definition() -> None:
    file = "src/contact/closed_form.f90"
    text = read(file)
    assert text is not None
    assert "call point_on_line(" in text
    assert "point_on_line" not in procedures_of(file, text)
    assert "track_closed_form" in procedures_of(file, text)
    assert procedures_of("x.c", "double f(void)\n{\n    return g(1);\n}\ndouble h(int a);\n") == {
        "f"
    }


@pytest.mark.parametrize(
    ("page", "old", "new", "said"),
    [
        ("theory.md", r" \qquad \text{(T25)}", "", "a display formula needs one label"),
        ("theory.md", r"\text{(T25)}", r"\text{(T26)}", "label T26 occurs more than once"),
        ("theory.md", r"\text{(T25)}", r"\text{(T999)}", "T999: no row"),
        ("theory.md", r"\text{(T25)}", r"\text{(T999)}", "T25: theory.md has no such label"),
        ("laws.md", r"\text{(L4)}", r"\text{(T400)}", "labels T belong to"),
        (NAME, "| L13 |", "| L14 |", "L12: derivation of L13, which no procedure evaluates"),
        (NAME, "`src/laws/coulomb.f90`", "`src/laws/cool.f90`", "no file src/laws/cool.f90"),
        (NAME, "| `linear_spring` |", "| |", "a row of a table has another form"),
        (NAME, "| `linear_spring` |", "|  |", "no procedure of src/laws/linear_spring.f90"),
    ],
)
def test_a_fault_is_found(pages: dict[str, str], page: str, old: str, new: str, said: str) -> None:
    path = page_of(pages, page)
    assert old in pages[path]
    pages[path] = pages[path].replace(old, new)
    assert [fault for fault in faults(pages, read) if said in fault]
