"""Sessions of the documents: their blocks run in order and print what is quoted."""

from __future__ import annotations

import re
import sys
from collections.abc import Callable
from pathlib import Path

import pytest

from documents import (
    ROOT,
    SESSIONS,
    TUTORIAL,
    agrees,
    blocks,
    missing_line,
    run_as_reader,
    steps,
)

CASES = sorted((ROOT / "examples").glob("tutorial-*.yaml"))


@pytest.mark.parametrize("page", SESSIONS, ids=lambda page: page.stem)
def test_the_commands_of_a_session_print_what_it_says(
    make_workplace: Callable[[str], Path], page: Path
) -> None:
    folder = make_workplace(page.stem)
    for step in steps(page):
        shell = ["bash", "-euo", "pipefail", "-c"]
        words = shell if step.language == "bash" else [sys.executable, "-c"]
        done = run_as_reader([*words, step.text], folder)
        assert done.returncode == 0, f"{step.text}\n{done.stdout}"
        if step.quote is not None:
            line = missing_line(step.quote, done.stdout)
            assert line is None, f"{step.text}\nis said to print\n{line}\nprints\n{done.stdout}"


def test_the_cases_of_the_tutorial_are_those_of_the_examples() -> None:
    texts = [case.read_text(encoding="utf-8") for case in CASES]
    shown = blocks(TUTORIAL, "yaml")
    assert shown
    for block in shown:
        assert any(block in text for text in texts), block


def test_the_pictures_of_the_tutorial_are_small() -> None:
    pictures = re.findall(r"\]\((\.\./images/tutorial-\S+)\)", TUTORIAL.read_text(encoding="utf-8"))
    assert 1 <= len(pictures) <= 4
    for picture in pictures:
        assert (TUTORIAL.parent / picture).stat().st_size < 60_000


@pytest.mark.parametrize(
    ("quoted", "printed", "alike"),
    [
        ("factor 1.109, 28 pitches", "factor  1.1088, 28 pitches", True),
        ("factor 1.109, 28 pitches", "factor 1.111, 28 pitches", False),
        ("factor 1.109, 28 pitches", "factor 1.109, 29 pitches", False),
        ("factor 1.109", "force 1.109", False),
        ("factor 1.109", "factor 1.109 again", False),
        ("factor 1.109 ...", "factor 1.109 again", True),
        ("1.2e-05 m", "1.24e-05 m", True),
        ("-3.5", "3.5", False),
        ("5031", "5030.5", True),
        ("nan", "1", False),
    ],
)
def test_quotes_agree_to_the_digits_shown(quoted: str, printed: str, alike: bool) -> None:
    assert agrees(quoted, printed) is alike


@pytest.mark.parametrize(
    ("quote", "missing"),
    [
        ("a\nb\nc\n", None),
        ("...\nb\n...\n", None),
        ("a\n...\n", None),
        ("...\nc\n", None),
        ("a\nc\n", "c"),
        ("b\n...\n", "b"),
        ("...\nc\nb\n", "b"),
        ("a\nb\n", "nothing behind: c"),
    ],
)
def test_quotes_leave_out_lines_only_where_they_say_so(quote: str, missing: str | None) -> None:
    assert missing_line(quote, "a\nb\n\nc\n") == missing
