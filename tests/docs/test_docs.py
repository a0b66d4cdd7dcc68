"""What the documents say is so: links lead somewhere, commands run, snippets run."""

from __future__ import annotations

import re
import subprocess
import sys
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest

from documents import FENCE, NOT_RUN, ROOT, SESSIONS, blocks, run_as_reader

README = ROOT / "README.md"
LAWS = ROOT / "docs" / "reference" / "laws.md"
PAGES = sorted(
    [README, ROOT / "CONTRIBUTING.md", ROOT / "CHANGELOG.md", *(ROOT / "docs").rglob("*.md")]
)
INDENTED = re.compile(r"^ {4}(.*)$", re.MULTILINE)
LINK = re.compile(r"\]\(([^)\s]+)\)")


def commands(page: Path) -> Iterator[str]:
    """Command lines of the three programs in a page's blocks, fenced or indented."""
    text = page.read_text(encoding="utf-8")
    indented = "\n".join(INDENTED.findall(FENCE.sub("", text)))
    for block in [*blocks(page, "bash", "console"), indented]:
        if block.startswith(NOT_RUN):
            continue
        for line in block.replace("\\\n", " ").splitlines():
            command = line.strip().removeprefix("$ ")
            if re.match(r"evolvent(-post|-sweep)?\s", command) and NOT_RUN not in command:
                yield command


def anchors(page: Path) -> set[str]:
    """Anchors that GitHub gives the headings of a page."""
    text = FENCE.sub("", page.read_text(encoding="utf-8"))
    headings = re.findall(r"^#+ +(.*)$", text, re.MULTILINE)
    return {re.sub(r"[^\w\- ]", "", h.strip().lower()).replace(" ", "-") for h in headings}


def run(command: str, folder: Path) -> None:
    """Run a command line as a user would; it has to succeed."""
    done = run_as_reader(["bash", "-c", command], folder)
    assert done.returncode == 0, f"{command}\n{done.stdout}"


@pytest.fixture(scope="module")
def run_page(workplace: Path) -> Callable[[Path], None]:
    """Run the commands of a page, once, whichever test comes first."""
    done: set[Path] = set()

    def once(page: Path) -> None:
        if page not in done:
            for command in commands(page):
                run(command, workplace)
            done.add(page)

    return once


@pytest.mark.parametrize("page", PAGES, ids=lambda page: str(page.relative_to(ROOT)))
def test_links_lead_to_files_and_headings_that_exist(page: Path) -> None:
    for target in LINK.findall(FENCE.sub("", page.read_text(encoding="utf-8"))):
        if re.match(r"\w+:", target):  # https:, mailto:
            continue
        name, _, anchor = target.partition("#")
        linked = (page.parent / name).resolve() if name else page
        assert linked.is_relative_to(ROOT), f"{target} leads out of the repository"
        assert linked.exists(), f"{target} does not exist"
        if anchor:
            assert anchor in anchors(linked), f"{target}: no such heading"


@pytest.mark.parametrize(
    "page",
    [page for page in PAGES if page not in SESSIONS and next(commands(page), None)],
    ids=lambda page: str(page.relative_to(ROOT)),
)
def test_commands_succeed_in_the_order_in_which_they_are_printed(
    page: Path, run_page: Callable[[Path], None]
) -> None:
    run_page(page)


def test_the_index_lists_every_page() -> None:
    index = ROOT / "docs" / "README.md"
    listed = {(index.parent / target).resolve() for target in LINK.findall(index.read_text())}
    assert set((ROOT / "docs").glob("*/**/*.md")) - listed == set()


def test_readme_prints_commands_of_all_programs() -> None:
    first_words = {command.split()[0] for command in commands(README)}
    assert first_words == {"evolvent", "evolvent-post", "evolvent-sweep"}


@pytest.mark.parametrize(
    "page",
    [page for page in PAGES if page not in SESSIONS and blocks(page, "python")],
    ids=lambda page: str(page.relative_to(ROOT)),
)
def test_python_runs_on_the_histories_that_its_page_the_readme_and_the_program_make(
    page: Path, workplace: Path, run_page: Callable[[Path], None]
) -> None:
    run_page(page)
    run("evolvent run examples/paper.yaml", workplace)
    for command in commands(README):
        if command.startswith("evolvent run"):
            run(command, workplace)
    for snippet in blocks(page, "python"):
        script = workplace / "snippet.py"
        script.write_text(snippet, encoding="utf-8")
        run(f"{sys.executable} {script.name}", workplace)


def test_every_force_law_of_the_program_has_a_section(executable: Path) -> None:
    printed = subprocess.run(
        [executable, "show", "--laws"], capture_output=True, text=True, check=True, timeout=60
    ).stdout
    named = set()
    family = ""
    for line in printed.splitlines():
        if match := re.match(r"(\w+):$", line):
            family = match[1]
        elif match := re.match(r"  \{law: (\w+)\}", line):
            named.add(f"{family}: {match[1]}")
    described = re.findall(r"^## (\w+: \w+)$", LAWS.read_text(), re.MULTILINE)
    assert set(described) == named


def test_the_figure_of_the_readme_is_small() -> None:
    images = re.findall(r'(?:\]\(|<img src=")(docs/images/[^)"]+)', README.read_text())
    assert len(images) == 3
    for image in images:
        assert (ROOT / image).stat().st_size < 200_000  # a page opens at once


def test_the_figures_of_the_paper_are_small() -> None:
    images = sorted((ROOT / "docs/reports/paper").glob("*.png"))
    assert len(images) == 3
    for image in images:
        assert image.stat().st_size < 150_000
