"""evolvent validate: the messages of `run`, for several cases, without output files.

Every test of this folder checks that it rejects what `run` rejects: see the fixture `evolvent`.
"""

from __future__ import annotations

import subprocess
from collections.abc import Callable
from pathlib import Path

import pytest

from example_cases import CASES

Evolvent = Callable[..., subprocess.CompletedProcess[str]]
BAD = ("--set", "wheels.0.teeth=2")


def test_every_example_passes_and_nothing_is_written(evolvent: Evolvent, tmp_path: Path) -> None:
    assert len(CASES) > 10
    done = evolvent("validate", *CASES)
    assert done.returncode == 0
    (warning,) = done.stderr.splitlines()  # the one explained in docs/theory/deviations.md
    assert warning.startswith(f"evolvent: warning: {CASES[0].parent / 'tip-relief.yaml'}: meshes.")
    assert done.stdout.splitlines() == [f"{path}: ok" for path in CASES]
    assert not list(tmp_path.iterdir())


def test_each_case_has_its_line_in_order_and_the_worst_code_counts(
    evolvent: Evolvent, examples: Path, tmp_path: Path
) -> None:
    (tmp_path / "bad.yaml").write_text("format: 1\nwheeels: []\n")
    (tmp_path / "good.yaml").write_text((examples / "paper.yaml").read_text())
    cases = ("good.yaml", "missing.yaml", "bad.yaml", "good.yaml")
    done = evolvent(
        "validate", *cases, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, capture_output=False
    )
    assert done.returncode == 3
    lines = done.stdout.splitlines()
    assert [line.partition(":")[0] for line in lines] == list(cases)
    assert (lines[0], lines[3]) == ("good.yaml: ok", "good.yaml: ok")
    assert lines[2].startswith("bad.yaml:2:1: unknown key 'wheeels' (did you mean 'wheels'?)")


def test_quiet_says_nothing_of_good_cases(evolvent: Evolvent, examples: Path) -> None:
    good, other = examples / "paper.yaml", examples / "no-such.yaml"
    assert evolvent("validate", "-q", good).stdout == ""
    done = evolvent("validate", "-q", good, other)
    assert (done.returncode, done.stdout) == (3, "")
    assert done.stderr.startswith(f"{other}: cannot be read")


def test_options_change_every_case(evolvent: Evolvent, examples: Path) -> None:
    done = evolvent("validate", examples / "paper.yaml", examples / "spur-pair.yaml", *BAD)
    assert done.returncode == 3
    assert done.stderr.count("must be a whole number from 3 to 10000\n") == 2


# ---- standard input ------------------------------------------------------------------------------

READERS = (("validate",), ("show",), ("show", "--json"), ("modes", "--json"))


@pytest.mark.parametrize("words", READERS, ids=" ".join)
def test_a_case_from_standard_input_is_the_case(
    evolvent: Evolvent, examples: Path, words: tuple[str, ...]
) -> None:
    path = examples / "spur-pair.yaml"
    by_name = evolvent(words[0], path, *words[1:])
    by_input = evolvent(words[0], "-", *words[1:], input=path.read_text())
    assert by_name.returncode == by_input.returncode == 0
    assert by_input.stdout == by_name.stdout.replace(str(path), "stdin")


@pytest.mark.parametrize("command", ["run", "static"])
def test_what_is_written_of_standard_input_is_what_is_written_of_the_file(
    evolvent: Evolvent, examples: Path, tmp_path: Path, command: str
) -> None:
    path = examples / "spur-pair.yaml"
    short = ("--set", "simulation.duration=1e-3")
    assert evolvent(command, path, "-o", "by-name.h5", *short).returncode == 0
    done = evolvent(command, "-", "-o", "by-input.h5", *short, input=path.read_text())
    assert done.returncode == 0, done.stderr
    assert (tmp_path / "by-input.h5").read_bytes() == (tmp_path / "by-name.h5").read_bytes()


@pytest.mark.parametrize("command", ["run", "static"])
def test_standard_input_has_no_name_to_write_to(
    evolvent: Evolvent, examples: Path, tmp_path: Path, command: str
) -> None:
    done = evolvent(command, "-", input=(examples / "spur-pair.yaml").read_text())
    assert (done.returncode, done.stdout) == (2, "")
    assert "a case from standard input has no name" in done.stderr
    assert done.stderr.endswith("name a file with -o\n")
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize("command", ["run", "static"])
def test_the_file_that_standard_input_comes_from_is_not_replaced(
    evolvent: Evolvent, examples: Path, tmp_path: Path, command: str
) -> None:
    text = (examples / "spur-pair.yaml").read_text()
    (tmp_path / "case.yaml").write_text(text)
    with (tmp_path / "case.yaml").open() as case:
        done = evolvent(command, "-", "-o", "case.yaml", stdin=case)
    assert done.returncode == 2
    assert "would replace the case 'case.yaml'" in done.stderr
    assert (tmp_path / "case.yaml").read_text() == text


@pytest.mark.parametrize("command", ["validate", "run", "show", "modes", "static"])
def test_a_fault_in_standard_input_has_its_place(evolvent: Evolvent, command: str) -> None:
    output = ("-o", "x.h5") if command in ("run", "static") else ()
    done = evolvent(command, "-", *output, input="format: 1\nwheeels: []\n")
    assert (done.returncode, done.stdout) == (3, "")
    assert done.stderr.startswith("stdin:2:1: unknown key 'wheeels'")
    empty = evolvent(command, "-", *output, input="")
    assert empty.stderr == "stdin: is empty; a case starts with 'format: 1'\n"
