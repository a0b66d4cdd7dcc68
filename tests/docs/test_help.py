"""Every example of every help text runs: the test finds the commands and their examples itself."""

from __future__ import annotations

import dataclasses
import re
import shlex
import shutil
import subprocess
import sys
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest

import machine
from designs import write_design

ROOT = Path(__file__).resolve().parents[2]
EXAMPLES = {path.stem for path in (ROOT / "examples").glob("*.yaml")}
COMMAND = re.compile(r"^  ([a-z]\w*)(?: |$)", re.MULTILINE)
# Alone on its line but for what is told of it, two blanks or more behind it.
EXAMPLE = re.compile(r"^ +(evolvent(?:-\w+)? .*?)(?: {2,}\S.*)?$", re.MULTILINE)
HISTORY = re.compile(r"^([\w-]+)\.h5$")
TRACKINGS = ("closed_form", "algebraic", "differential")

Program = Callable[..., tuple[int, str, str]]


@pytest.fixture
def program(
    executable: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
    tmp_path: Path,
) -> Program:
    """Run a command line of any of the three programs: exit code, stdout, stderr."""
    from evolvent.commands.post.app import main as post
    from evolvent.commands.sweep.app import main as sweep
    from evolvent.pages import animation

    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("EVOLVENT_EXECUTABLE", str(executable))
    choose = animation.choose_clip

    def two_frames(*arguments: object) -> animation.Clip:  # drawing one takes a tenth of a second
        clip = choose(*arguments)  # type: ignore[arg-type]
        return dataclasses.replace(clip, rows=clip.rows[:2])

    monkeypatch.setattr(animation, "choose_clip", two_frames)
    mains = {"evolvent-post": post, "evolvent-sweep": sweep}

    def run(name: str, *words: str) -> tuple[int, str, str]:
        if name == "evolvent":
            done = subprocess.run([executable, *words], capture_output=True, text=True, check=False)
            return done.returncode, done.stdout, done.stderr
        monkeypatch.setattr(sys, "argv", [name, *words])
        with pytest.raises(SystemExit) as stopped:
            mains[name]()
        out, err = capsys.readouterr()
        return int(stopped.value.code or 0), out, err

    return run


def examples_of(program: Program, *words: str) -> Iterator[str]:
    """Examples in the help of a command and of those below it."""
    code, text, err = program(*words, "--help")
    assert (code, err) == (0, "")
    yield from EXAMPLE.findall(text)
    _, _, listed = text.partition("\nCommands:\n")
    for command in COMMAND.findall(listed.partition("\n\n")[0]):
        below = list(examples_of(program, *words, command))
        assert below, f"the help of '{' '.join([*words, command])}' has no example"
        yield from below


def make_history(program: Program, name: str) -> None:
    """Make NAME.h5, of the example NAME or of the paper's with that tracking."""
    case = name if name in EXAMPLES else "paper"
    setting = ["--set", f"meshes.0.tracking={name}"] if name in TRACKINGS else []
    assert program("evolvent", "run", f"examples/{case}.yaml", "-o", f"{name}.h5", *setting)[0] == 0


def make_sweep(program: Program) -> None:
    """Make the design, the folder and the summary of the example of a sweep."""
    plan = ("plan", "examples/sweep-torque.yaml", "-o", "torque.h5")
    for words in (plan, ("run", "torque.h5", "-o", "torque")):
        assert program("evolvent-sweep", *words)[0] == 0
    assert program("evolvent-sweep", "collect", "torque", "-o", "torque-summary.h5")[0] == 0


def make_inputs(program: Program, name: str, examples: list[str]) -> None:
    """Make the files that examples read, as their users have them."""
    if name == "evolvent":
        write_design(Path("design.h5"), {"wheels.pinion.loads.0.value": [-1.0, -2.0, -3.0]})
        assert program(name, "batch", "design.h5", "-o", "torque")[0] == 0
    elif name == "evolvent-sweep":
        make_sweep(program)
    else:
        words = {word for example in examples for word in shlex.split(example)}
        for match in filter(None, map(HISTORY.match, sorted(words))):
            make_history(program, match[1])


@pytest.mark.parametrize("name", ["evolvent", "evolvent-post", "evolvent-sweep"])
def test_every_example_of_every_help_text_runs(
    program: Program, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, name: str
) -> None:
    if name == "evolvent-sweep":
        machine.module("pyarrow")
    examples = list(dict.fromkeys(examples_of(program, name)))
    assert len(examples) >= 7
    (tmp_path / "examples").symlink_to(ROOT / "examples")
    make_inputs(program, name, examples)
    made = [path for path in tmp_path.iterdir() if path.name != "examples"]
    for number, example in enumerate(examples):
        folder = tmp_path / "runs" / str(number)
        folder.mkdir(parents=True)
        (folder / "examples").symlink_to(ROOT / "examples")
        for path in made:
            (shutil.copytree if path.is_dir() else shutil.copyfile)(path, folder / path.name)
        monkeypatch.chdir(folder)
        if ".mp4" in example:
            machine.program("ffmpeg")
        code, _, err = program(*shlex.split(example))
        assert code == 0, f"{example}: {err}"
