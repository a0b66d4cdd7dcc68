"""The report of a run begins with the data sheet of each mesh."""

from __future__ import annotations

import subprocess
from pathlib import Path

import pytest

from evolvent.pages.report import report
from postprocess.test_report import Page
from system.runs import Run, Runs


@pytest.fixture(scope="module")
def run(runs: Runs) -> Run:
    return runs("compliant-pair.yaml", "simulation.duration=2e-3")


def sheet_of(page: str) -> str:
    return page[page.index('<section class="datasheet">') : page.index("</section>")]


def test_the_report_begins_with_the_data_sheet_of_the_program(
    run: Run, executable: Path, examples: Path, tmp_path: Path
) -> None:
    """The same element as in the page of the command, but for heading and name of the case."""
    text = report(run.history, run.events)
    page = Page(text)
    assert page.open == []
    assert page.headings[:2] == ["datasheet", "results"]
    assert page.elements["svg"] == 1
    assert not any("to scale" in str(image["alt"]) for image in page.images)
    path = tmp_path / "sheet.html"
    command = [executable, "datasheet", examples / "compliant-pair.yaml", "-q", "-o", path]
    subprocess.run(command, check=True, timeout=60)
    found, expected = (sheet_of(page) for page in (text, path.read_text()))
    cut = "</header>"
    assert found[found.index(cut) :] == expected[expected.index(cut) :]
    assert f"case of {run.path.name}" in found


def test_the_report_of_a_train_has_a_sheet_for_each_mesh(runs: Runs) -> None:
    run = runs("two-stage-gears.yaml", "simulation.duration=2e-3")
    page = Page(report(run.history, run.events))
    assert page.open == []
    assert page.elements["svg"] == page.elements["section"] == 2
    assert page.elements["details"] == 1
