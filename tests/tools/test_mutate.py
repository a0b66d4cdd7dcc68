"""The list of mutants fits the tree, and tools/mutate reads, makes and counts them rightly."""

from __future__ import annotations

import argparse
import os
import subprocess
import sys
from pathlib import Path

import pytest
from mutation import command, trial
from mutation.entries import ListError, Mutant, read_list, stale
from mutation.ground import FOR_PYTHON, Ground
from mutation.records import KILLED, SURVIVED, Record, append_record, read_records, summary

LIST = """
[[file]]
path = "src/a.f90"
tests = ["tests/test_a.py"]
mutants = [
  { find = 'x = 1', put = 'x = 2' },
  { find = '''two
lines''', put = '', tests = ["tests/test_b.py"], note = "why" },
  { find = 'y', put = 'z', equivalent = "both are 0" },
]
"""


def written(folder: Path, text: str) -> Path:
    (folder / "some.toml").write_text(text)
    return folder


def test_every_row_of_the_list_fits_the_tree() -> None:
    """Who changes a line that has a mutant changes its row, too; 300 are promised."""
    mutants = read_list()
    assert stale(mutants) == []
    assert len(mutants) >= 300
    assert {mutant.path.split("/")[0] for mutant in mutants} == {"src", "driver", "postprocess"}


def test_a_row_takes_the_tests_of_its_file_unless_it_has_its_own(tmp_path: Path) -> None:
    first, second, third = read_list(written(tmp_path, LIST))
    assert first == Mutant("src/a.f90", "x = 1", "x = 2", ("tests/test_a.py",))
    assert second.tests == ("tests/test_b.py",)
    assert str(second) == "src/a.f90: two lines -> nothing  (why)"
    assert third.equivalent == "both are 0"
    assert len({mutant.key for mutant in (first, second, third)}) == 3
    assert (
        Mutant("postprocess/evolvent/physics/teeth.py", "", "", ()).module == "postprocess/physics"
    )


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        ("'x = 2' }", "'x = 1' }", "nothing is changed"),
        ("put = 'x = 2'", "to = 'x = 2'", "unknown key to"),
        ('tests = ["tests/test_a.py"]', "", "no tests are named"),
        ("find = 'y', put = 'z'", "find = 'x = 1', put = 'x = 2'", "twice in the list"),
        ("[[file]]", "[[files]]", "unknown key files"),
        ("mutants = [", "mutants = ", "some.toml"),
    ],
)
def test_a_wrong_row_is_named(tmp_path: Path, old: str, new: str, words: str) -> None:
    assert old in LIST
    with pytest.raises(ListError, match=words):
        read_list(written(tmp_path, LIST.replace(old, new)))


@pytest.mark.parametrize(
    ("text", "times"), [("x = 1\n", None), ("x = 3\n", "found 0"), ("x = 1; x = 1\n", "found 2")]
)
def test_a_text_has_to_be_there_once(tmp_path: Path, text: str, times: str | None) -> None:
    (tmp_path / "src").mkdir()
    (tmp_path / "src" / "a.f90").write_text(text)
    (tmp_path / "tests").mkdir()
    (tmp_path / "tests" / "test_a.py").touch()
    complaints = stale([Mutant("src/a.f90", "x = 1", "x = 2", ("tests/test_a.py",))], tmp_path)
    assert [times in line for line in complaints if times] == [True] * (times is not None)
    assert len(complaints) == (times is not None)


def test_a_missing_file_and_a_missing_test_are_stale(tmp_path: Path) -> None:
    mutant = Mutant("src/gone.f90", "x", "y", ("tests/gone.py::test_this",))
    no_file, no_test = stale([mutant], tmp_path)
    assert "gone.f90" in no_file
    assert "no such test: tests/gone.py" in no_test


def ground_of(folder: Path) -> Ground:
    ground = Ground(folder, 1)
    for name, text in {
        "src/laws/a.f90": "x = 1\n   include 'none'\n",
        "src/laws/b.f90": '   include "laws/b.inc"\n',
        "src/laws/b.inc": '   include "laws/c.inc"\n',
        "src/laws/c.inc": "y = 1\n",
    }.items():
        path = ground.tree / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text)
        os.utime(path, (1, 1))
    return ground


def test_one_mutant_is_in_the_tree_at_a_time(tmp_path: Path) -> None:
    ground = ground_of(tmp_path)
    a, c = ground.tree / "src/laws/a.f90", ground.tree / "src/laws/c.inc"
    before = a.read_text(), c.read_text()
    ground.put(Mutant("src/laws/a.f90", "x = 1", "x = 2", ()))
    assert a.read_text().startswith("x = 2")
    ground.put(Mutant("src/laws/a.f90", "x = 1", "x = 3", ()))  # from what the file was
    assert a.read_text().startswith("x = 3")
    ground.put(Mutant("src/laws/c.inc", "y = 1", "y = 2", ()))
    assert (a.read_text(), c.read_text()) == (before[0], "y = 2\n")
    ground.put(None)
    assert (a.read_text(), c.read_text()) == before


def test_who_includes_a_changed_file_is_compiled_again(tmp_path: Path) -> None:
    ground = ground_of(tmp_path)
    ground.put(Mutant("src/laws/c.inc", "y = 1", "y = 2", ()))
    times = {path.name: path.stat().st_mtime for path in (ground.tree / "src/laws").iterdir()}
    assert times["b.f90"] > 1  # through b.inc
    assert times["a.f90"] == 1


def options(**given: object) -> argparse.Namespace:
    none = {"only": None, "survivors": False, "again": False, "sample": None, "seed": 0}
    return argparse.Namespace(**{**none, **given})


def test_what_has_a_verdict_is_not_run_again_unless_asked(tmp_path: Path) -> None:
    mutants = read_list(written(tmp_path, LIST))
    records = {
        mutants[0].key: Record(mutants[0].key, KILLED, "tests/test_a.py::test_x", "", 1.0),
        mutants[1].key: Record(mutants[1].key, SURVIVED, "", "", 1.0),
    }
    assert command.chosen(mutants, {}, options()) == mutants[:2]  # not the equivalent one
    assert command.chosen(mutants, records, options()) == []
    assert command.chosen(mutants, records, options(again=True)) == mutants[:2]
    assert command.chosen(mutants, records, options(survivors=True)) == [mutants[1]]
    assert command.chosen(mutants, {}, options(only=["two lines"])) == [mutants[1]]
    sampled = command.chosen(mutants, {}, options(sample=1))
    assert len(sampled) == 1
    assert command.chosen(mutants, {}, options(sample=1)) == sampled


def test_who_noticed_mutants_of_a_file_is_asked_first_about_the_next() -> None:
    by = {"a": "tests/test_x.py::test_1", "b": "tests/test_y.py", "c": "tests/test_x.py::test_1"}
    records = {key: Record(key, KILLED, test, "", 1.0) for key, test in by.items()}
    records["d"] = Record("d", SURVIVED, "", "", 1.0)
    records["e"] = Record("e", KILLED, "tests/test_z.py::test_2", "", 1.0)
    path_of = {**dict.fromkeys("abcd", "src/a.f90"), "e": "src/b.f90"}
    mutant = Mutant("src/a.f90", "x", "y", ("tests/test_x.py",))
    assert command.quickest(mutant, records, path_of) == [by["a"], by["b"]]


def test_only_what_the_tests_need_is_built(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A program of C tests is built by itself; what tests in Python load only for those."""
    ground = ground_of(tmp_path)
    rules = ground.build / "CMakeFiles" / "rules.ninja"
    rules.parent.mkdir(parents=True)
    rules.touch()
    ninja = tmp_path / "ninja"
    ninja.write_text('#!/bin/sh\necho "$@" >>"$0.log"\n')
    ninja.chmod(0o755)
    monkeypatch.setenv("PATH", f"{tmp_path}:{os.environ['PATH']}")
    for test in ("tests/driver/test_a.c", "tests/driver/test_a.c", "tests/test_b.py"):
        assert ground.make((test,))
    built = [line.split()[3:] for line in (tmp_path / "ninja.log").read_text().splitlines()]
    assert built == [["test_a"], sorted(FOR_PYTHON)]


def test_records_outlast_a_line_that_was_cut_off(tmp_path: Path) -> None:
    file = tmp_path / "records.jsonl"
    assert read_records(file) == {}
    append_record(file, Record("a", SURVIVED, "", "", 1.0))
    append_record(file, Record("b", KILLED, "test", "", 2.0))
    with file.open("a") as out:
        out.write('{"key": "c", "verd\n')
    append_record(file, Record("a", KILLED, "test", "", 3.0))
    found = read_records(file)
    assert {key: record.verdict for key, record in found.items()} == {"a": KILLED, "b": KILLED}


def test_the_summary_counts_and_names_survivors(tmp_path: Path) -> None:
    mutants = read_list(written(tmp_path, LIST))
    verdicts = zip(mutants, (KILLED, SURVIVED), strict=False)
    records = {mutant.key: Record(mutant.key, verdict, "", "", 1.0) for mutant, verdict in verdicts}
    text = summary(mutants, records)
    assert "2 run, 1 killed, 50.0 %" in text
    assert "survived    src/a.f90: two lines -> nothing  (why)" in text
    assert "equivalent  src/a.f90: y -> z: both are 0" in text


# ---- tests of a mutant are run as promised


def tree_with(tmp_path: Path, body: str) -> Ground:
    ground = Ground(tmp_path / "ground", 1)
    (ground.tree / "tests").mkdir(parents=True)
    (ground.tree / "tests" / "test_one.py").write_text(body)
    return ground


PROBE = """
import sys
from pathlib import Path
from mutation import trial
from mutation.ground import Ground
class Made(Ground):
    def make(self, tests):
        return True
trial.SECONDS = 1
trial.adopt_orphans()
folder = Path({folder!r})
outcome = trial.run_tests(Made(folder, 1), ("tests/test_one.py",), folder, {first!r})
print(outcome.passed, outcome.by, outcome.how, outcome.left_behind, sep="|")
"""


@pytest.mark.parametrize(
    ("body", "expected"),
    [
        ("def test_good():\n    pass\n", "True|||0"),
        ("def test_bad():\n    assert False\n", "False|tests/test_one.py::test_bad||0"),
        (
            "def test_endless():\n    while True:\n        pass\n",
            "False|tests/test_one.py::test_endless|not within 1 s|0",
        ),
        (
            "import os\ndef test_dies():\n    os.kill(os.getpid(), 11)\n",
            "False|tests/test_one.py::test_dies|SIGSEGV|0",
        ),
        (
            "import subprocess\ndef test_leaves():\n    subprocess.Popen(['sleep', '60'])\n",
            "True|||1",
        ),
        ("def test_broken(:\n", "False|tests/test_one.py||0"),
        (
            "import pytest\ndef test_good():\n    pass\ndef test_away():\n    pytest.skip()\n",
            "True||1 skipped|0",
        ),
        (
            "def test_bad():\n    assert False\ndef test_first():\n    assert False\n",
            "False|tests/test_one.py::test_first||0",
        ),
    ],
)
def test_a_trial_tells_which_test_noticed_and_ends_what_is_left(
    tmp_path: Path, body: str, expected: str
) -> None:
    ground = tree_with(tmp_path, body)
    tools = Path(trial.__file__).parents[1]
    code = PROBE.format(folder=str(ground.tree.parent), first=["tests/test_one.py::test_first"])
    done = subprocess.run(
        [sys.executable, "-c", code],
        env={**os.environ, "PYTHONPATH": str(tools)},
        capture_output=True, text=True, timeout=60, check=False,
    )  # fmt: skip
    assert (done.returncode, done.stdout.strip()) == (0, expected), done.stderr


STOPPED = """
import signal, time
from mutation import command
from mutation.entries import Mutant
signal.signal(signal.SIGTERM, signal.default_int_handler)
def work(*_):
    print("at work", flush=True)
    time.sleep(60)
command._work = work
command._run([Mutant(str(i), "x" * 100000, "", ()) for i in range(9)], 1, False)
"""


def test_a_run_that_is_stopped_ends_though_files_are_left() -> None:
    """More of them than a pipe holds."""
    tools = Path(trial.__file__).parents[1]
    process = subprocess.Popen(
        [sys.executable, "-c", STOPPED],
        env={**os.environ, "PYTHONPATH": str(tools)},
        stdout=subprocess.PIPE, stderr=subprocess.DEVNULL,
    )  # fmt: skip
    assert process.stdout is not None
    try:
        assert process.stdout.readline() == b"at work\n"
        process.terminate()
        assert process.wait(30) != 0
    finally:
        process.kill()
        process.communicate()
