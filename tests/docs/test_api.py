"""The reference of the Python package: every public function is described and has an example."""

from __future__ import annotations

import doctest
import inspect
import re
from collections.abc import Callable
from pathlib import Path

import pytest
from docs_site.python_api import public

import machine
from documents import ROOT, run_as_reader
from evolvent.library.binding import NAME, VARIABLE

PUBLIC = {".".join(name): thing for name, thing in public(ROOT).items()}
FUNCTIONS = [name for name, thing in PUBLIC.items() if inspect.isfunction(thing)]
# Of numpydoc: undocumented or unknown parameters, their types and descriptions; results; examples.
REQUIRED = {"SS01", "PR01", "PR02", "PR03", "PR04", "PR07", "RT01", "RT03", "YD01", "EX01"}
# Results of these commands are what the examples open.
COMMANDS = (
    "evolvent run examples/paper.yaml -o paper.h5",
    "evolvent-sweep plan examples/sweep-torque.yaml -o torque.h5",
    "evolvent-sweep run torque.h5 -o torque",
)


@pytest.fixture(scope="module")
def results(make_workplace: Callable[[str], Path]) -> Path:
    """Folder with the results that the examples open."""
    folder = make_workplace("api")
    for command in COMMANDS:
        done = run_as_reader(["bash", "-c", command], folder)
        assert done.returncode == 0, done.stdout
    return folder


def test_the_package_exports_what_the_reference_lists() -> None:
    import evolvent

    assert {f"evolvent.{name}" for name in evolvent.__all__ if name != "__version__"} <= set(PUBLIC)


@pytest.mark.parametrize("name", FUNCTIONS)
def test_a_public_function_has_all_sections(name: str) -> None:
    machine.module("numpydoc")
    from numpydoc.validate import validate

    thing = PUBLIC[name]
    errors = validate(f"{thing.__module__}.{thing.__qualname__}")["errors"]
    assert [error for error in errors if error[0] in REQUIRED] == []
    text = inspect.getdoc(thing) or ""
    if re.search(r"^ +raise\b", inspect.getsource(thing), re.MULTILINE):
        assert "Raises\n------" in text


@pytest.mark.parametrize("name", FUNCTIONS)
def test_the_example_of_a_public_function_gives_what_it_prints(
    name: str, results: Path, executable: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(results)
    monkeypatch.setenv("EVOLVENT_EXECUTABLE", str(executable))
    monkeypatch.setenv(VARIABLE, str(executable.resolve().parent / NAME))
    thing = PUBLIC[name]
    (found,) = doctest.DocTestFinder(recurse=False).find(thing, name, globs={})
    assert found.examples
    printed: list[str] = []
    doctest.DocTestRunner().run(found, out=printed.append)
    assert "".join(printed) == ""
