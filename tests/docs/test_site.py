"""The built site: no warning, no broken link, no network, a search, all references."""

from __future__ import annotations

import re
import subprocess
import sys
from pathlib import Path

import pytest
from docs_site import c_headers, fortran_modules, links
from docs_site.command import MODULES
from docs_site.comments import markdown
from docs_site.python_api import public
from docs_site.staging import contents

import machine
from documents import ROOT


@pytest.fixture(scope="session")
def site(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Build the site as the command does."""
    for name in MODULES:
        machine.module(name)
    folder = tmp_path_factory.mktemp("docs") / "site"
    command = [sys.executable, ROOT / "tools" / "build-docs", folder]
    done = subprocess.run(command, capture_output=True, text=True, timeout=1200, check=False)
    assert (done.returncode, done.stderr) == (0, "")
    assert done.stdout == f"{folder / 'index.html'}\n"
    return folder


def test_the_site_has_a_search_without_a_server(site: Path) -> None:
    index = (site / "searchindex.js").read_text(encoding="utf-8")
    assert index.startswith("Search.setIndex(")
    assert "docs/theory/theory" in index
    assert "backlash" in index
    assert "searchindex.js" in (site / "search.html").read_text(encoding="utf-8")


def test_formulas_are_drawn_without_a_script(site: Path) -> None:
    text = (site / "docs" / "theory" / "theory.html").read_text(encoding="utf-8")
    assert text.count("<math") > 100
    assert "\N{GREEK SMALL LETTER ALPHA}</mi>" in text
    assert "&amp;#x" not in text
    assert "MathJax" not in text


def test_every_public_name_of_python_has_an_entry(site: Path) -> None:
    anchors = set()
    for page in (site / "api" / "python").glob("*.html"):
        anchors |= links.read(page).anchors
    assert {".".join(name) for name in public(ROOT)} - anchors == set()


@pytest.mark.parametrize("header", c_headers.HEADERS)
def test_every_function_of_a_header_has_an_entry(site: Path, header: str) -> None:
    code = (ROOT / c_headers.HEADERS[header]).read_text(encoding="utf-8")
    plain = re.sub(r"/\*.*?\*/", "", code, flags=re.DOTALL)
    declared = set(re.findall(r"\b((?:evl|evolvent)_\w+)\((?=\w)", plain))
    types = set(re.findall(r"^(?:typedef .*?|\}) (\w+);$", plain, re.MULTILINE))
    anchors = links.read(site / "api" / "c" / f"{header}.html").anchors
    assert types
    assert {f"c.{name}" for name in declared | types} - anchors == set()


def test_every_module_of_the_kernel_has_a_section(site: Path) -> None:
    for folder in {file.parent for file in (ROOT / "src").glob("*/*.f90")}:  # with its subfolders
        text = (site / "api" / "fortran" / f"{folder.name}.html").read_text(encoding="utf-8")
        modules = [
            name
            for file in folder.rglob("*.f90")
            for name in re.findall(r"^module (evl_\w+)$", file.read_text(), re.MULTILINE)
        ]
        assert [name for name in modules if f"<h2>{name}<" not in text] == []


def test_every_page_is_in_the_contents() -> None:
    listed = contents((ROOT / "docs" / "README.md").read_text(encoding="utf-8"), {})
    pages = {path.relative_to(ROOT).with_suffix("") for path in (ROOT / "docs").rglob("*/*.md")}
    assert [page for page in pages if str(page) not in listed.splitlines()] == []


@pytest.mark.parametrize(
    ("body", "fault"),
    [
        ('<a href="other.html#there">', None),
        ('<a href="other.html#nowhere">', "index.html: other.html#nowhere: no such anchor"),
        ('<a href="gone.html">', "index.html: gone.html does not exist"),
        ('<img src="gone.png">', "index.html: gone.png does not exist"),
        ('<a href="https://doi.org/1">', None),
        (
            '<script src="https://host/a.js">',
            "index.html: loads https://host/a.js from the network",
        ),
    ],
)
def test_a_broken_link_is_named(tmp_path: Path, body: str, fault: str | None) -> None:
    (tmp_path / "other.html").write_text('<p id="there">')
    (tmp_path / "index.html").write_text(body)
    assert links.broken(tmp_path) == ([fault] if fault else [])


def test_a_comment_keeps_its_formulas_and_its_lists() -> None:
    lines = [
        "Force a*b of _x_:",
        "",
        "   F = k x",
        "",
        "- one",
        "- two",
        "see docs/theory/theory.md",
    ]
    assert markdown(lines) == (
        "Force a\\*b of \\_x\\_:\n\n```text\nF = k x\n```\n\n- one\n- two\n"
        "see [docs/theory/theory.md](/docs/theory/theory.md)"
    )


def test_public_entities_of_a_module_are_read_with_their_comments() -> None:
    module = fortran_modules.read(
        """!> Purpose.
module evl_sample
   implicit none
   private
   public :: area, &
             sides

   integer, parameter :: sides = 4 !! of a square

contains

   !> Area of a square.
   pure real(wp) function area(side) &
      result(squared)
   end function area

   subroutine hidden()
   end subroutine hidden
end module evl_sample
"""
    )
    assert module is not None
    assert (module.name, module.doc) == ("evl_sample", ["Purpose."])
    assert [(one.name, one.code, one.doc) for one in module.public] == [
        ("area", "pure real(wp) function area(side) result(squared)", ["Area of a square."]),
        ("sides", "integer, parameter :: sides", ["of a square"]),
    ]
