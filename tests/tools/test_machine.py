"""One list of what the tests need of the machine; no failure of a program is overlooked."""

from __future__ import annotations

import ast
import subprocess
from collections.abc import Iterator
from pathlib import Path

import pytest

import helper_programs
import machine

TESTS = Path(__file__).resolve().parents[1]
ROOT = TESTS.parent
OWN = ("machine.py", "helper_programs.py", "test_machine.py")  # they look programs up
FILES = sorted(path for path in TESTS.rglob("*.py") if path.name not in OWN)
SKIPS = {
    *("pytest.skip", "pytest.importorskip", "pytest.mark.skip", "pytest.mark.skipif"),
    *("unittest.skip", "shutil.which"),
}


def dotted(node: ast.AST) -> str:
    """Name of an attribute such as `pytest.mark.skipif`."""
    if isinstance(node, ast.Attribute):
        return f"{dotted(node.value)}.{node.attr}"
    return node.id if isinstance(node, ast.Name) else ""


def own_skips(tree: ast.AST) -> list[int]:
    """Lines that skip a test, or look for a program, without the list."""
    return [node.lineno for node in ast.walk(tree) if dotted(node) in SKIPS]  # type: ignore[attr-defined]


def functions(tree: ast.AST) -> Iterator[ast.FunctionDef]:
    return (node for node in ast.walk(tree) if isinstance(node, ast.FunctionDef))


def unchecked_runs(tree: ast.AST) -> list[int]:
    """Lines with a `subprocess.run` whose exit status nothing looks at.

    A run is checked by `check=True`, by a read of its `returncode`, or by code to which its result
    is returned or given.
    """
    found = []
    for function in functions(tree):
        used = {
            dotted(node.value)
            for node in ast.walk(function)
            if isinstance(node, ast.Attribute) and node.attr in ("returncode", "check_returncode")
        }
        used |= {
            node.id
            for call in ast.walk(function)
            if isinstance(call, (ast.Call, ast.Return, ast.Yield))
            for node in ast.iter_child_nodes(call)
            if isinstance(node, ast.Name)
        }
        statements = [node for node in ast.walk(function) if isinstance(node, ast.stmt)]
        for statement in statements:
            value = getattr(statement, "value", None)
            if not isinstance(statement, (ast.Expr, ast.Assign)) or not isinstance(value, ast.Call):
                continue
            if dotted(value.func) != "subprocess.run" or is_checked(value):
                continue
            if isinstance(statement, ast.Assign) and dotted(statement.targets[0]) in used:
                continue
            found.append(value.lineno)
    return found


def is_checked(call: ast.Call) -> bool:
    return any(
        key.arg == "check" and isinstance(key.value, ast.Constant) and key.value.value is True
        for key in call.keywords
    )


def parsed() -> Iterator[tuple[Path, ast.AST]]:
    return ((path, ast.parse(path.read_text(encoding="utf-8"))) for path in FILES)


def test_tests_skip_and_look_for_programs_by_the_list_alone() -> None:
    assert {str(path): lines for path, tree in parsed() if (lines := own_skips(tree))} == {}


def test_tests_look_at_the_status_of_every_program_that_they_run() -> None:
    assert {str(path): lines for path, tree in parsed() if (lines := unchecked_runs(tree))} == {}


@pytest.mark.parametrize(
    ("source", "lines"),
    [
        ("def f():\n    subprocess.run(words, check=False)", [2]),
        ("def f():\n    subprocess.run(words)", [2]),
        ("def f():\n    subprocess.run(words, check=True)", []),
        ("def f():\n    done = subprocess.run(words)\n    assert done.stdout", [2]),
        ("def f():\n    done = subprocess.run(words)\n    assert done.returncode == 0", []),
        ("def f():\n    done = subprocess.run(words)\n    judge(done)", []),
        ("def f():\n    done = subprocess.run(words)\n    return done", []),
    ],
)
def test_a_run_that_nobody_checks_is_found(source: str, lines: list[int]) -> None:
    assert unchecked_runs(ast.parse(source)) == lines


def test_rows_of_the_list_are_whole_and_stand_in_their_order() -> None:
    assert all(need.programs and need.packages and need.purpose for need in machine.NEEDS)
    first = [need.programs[0] for need in machine.NEEDS]
    assert first == sorted(set(first))
    assert len(machine.LISTED) == sum(len(need.programs) for need in machine.NEEDS)


def test_the_set_up_script_reads_the_packages_of_missing_programs(tmp_path: Path) -> None:
    """Those of a machine that has bash alone, and none of one that has all."""
    script = f'. "{ROOT}/tools/setup.sh"; missing_test_packages'
    (tmp_path / "build").mkdir()
    for path, expected in (
        (str(tmp_path), {package for need in machine.NEEDS for package in need.packages}),
        (None, set()),
    ):
        for need in machine.NEEDS:
            machine.program(need.programs[0])
        lookup = "" if path is None else f"SYSTEM_FOLDERS= PATH={path}; "
        done = subprocess.run(
            [machine.program("bash"), "-c", script.replace("; ", f"; {lookup}", 1)],
            **{"cwd": tmp_path, "capture_output": True, "text": True},
            check=True,
        )
        assert set(done.stdout.split()) == expected


def test_a_program_that_the_list_lacks_is_refused_by_name() -> None:
    with pytest.raises(AssertionError, match=r"unlisted-program is not in machine\.txt"):
        subprocess.run(["unlisted-program"], check=True)
    with pytest.raises(KeyError):
        machine.program("unlisted-program")


def test_a_missing_program_fails_where_everything_can_be_installed(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(machine, "SYSTEM_FOLDERS", ())
    monkeypatch.setenv("PATH", "")
    monkeypatch.delenv(machine.COMPLETE, raising=False)
    with pytest.raises(pytest.skip.Exception, match="no zsh here: apt install zsh"):
        machine.program("zsh")
    monkeypatch.setenv(machine.COMPLETE, "1")
    with pytest.raises(pytest.fail.Exception, match="no zsh here, though"):
        machine.program("zsh")
    with pytest.raises(pytest.fail.Exception, match="no Python package no_such_module"):
        machine.module("no_such_module")


def test_what_a_failed_program_printed_is_in_the_report() -> None:
    error = subprocess.CalledProcessError(1, ["x"], stderr="the reason")
    info = pytest.CallInfo.from_call(lambda: (_ for _ in ()).throw(error), "call")
    report = type("Report", (), {"sections": []})()
    hook = helper_programs.pytest_runtest_makereport(info)
    next(hook)
    with pytest.raises(StopIteration):
        hook.send(report)
    assert report.sections == [("stderr of ['x']", "the reason")]
