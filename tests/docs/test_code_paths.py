"""The paths through the code of the architecture page: each file defines its procedure."""

from __future__ import annotations

import re

import pytest

from documents import ROOT

(PAGE,) = (ROOT / "docs").rglob("architecture.md")
STEP = re.compile(r"^(\d+)\. `(\w+)`, `([\w./]+)`: (\S.*)$", re.MULTILINE)
DEFINITION = {
    **dict.fromkeys(
        (".f90", ".inc"), r"^ *(?!end\b)(?:[\w(), =]* )?(?:subroutine|function) {name}\("
    ),
    ".c": r"^[a-z][\w *]*[ *]{name}\([^;{{}}]*\)\n\{{",
}


def paths() -> dict[str, list[tuple[str, ...]]]:
    """Steps of each path by its heading: number, procedure, file, text."""
    section = PAGE.read_text("utf-8").split("## Five paths through the code\n")[1].split("\n## ")[0]
    _, *parts = re.split(r"^### (.*)$", section, flags=re.MULTILINE)
    return {
        heading: STEP.findall(part) for heading, part in zip(parts[::2], parts[1::2], strict=True)
    }


STEPS = [
    pytest.param(procedure, file, id=f"{file}:{procedure}")
    for steps in paths().values()
    for _, procedure, file, _ in steps
]


def defines(text: str, suffix: str, procedure: str) -> bool:
    """Whether a source text defines a procedure: a declaration or a call does not count."""
    pattern = DEFINITION[suffix].format(name=procedure)
    return re.search(pattern, text, re.MULTILINE) is not None


@pytest.mark.parametrize(("procedure", "file"), STEPS)
def test_a_file_defines_the_procedure_of_its_step(procedure: str, file: str) -> None:
    path = ROOT / file
    assert defines(path.read_text("utf-8"), path.suffix, procedure)


def test_there_are_five_paths_whose_steps_are_numbered() -> None:
    found = paths()
    assert len(found) == 5
    for heading, steps in found.items():
        assert [int(number) for number, *_ in steps] == list(range(1, len(steps) + 1)), heading
        assert len(steps) >= 10


@pytest.mark.parametrize(
    ("suffix", "text"),
    [
        (".f90", "   call look_at(gearbox)\n"),
        (".f90", "   end subroutine look_at\n"),
        (".f90", "   pure subroutine look_at_all(x)\n"),
        (".c", "bool look_at(int n);\n"),
        (".c", "    look_at(3)\n{\n"),
    ],
)
def test_neither_a_call_nor_another_procedure_is_a_definition(suffix: str, text: str) -> None:
    assert not defines(text, suffix, "look_at")
