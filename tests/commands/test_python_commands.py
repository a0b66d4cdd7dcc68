"""evolvent-post and evolvent-sweep: exact help texts, and completion in an actual bash."""

from __future__ import annotations

import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import pytest

import machine
from evolvent.commands.post.app import COMMANDS as POST
from evolvent.commands.post.app import main as post
from evolvent.commands.sweep.app import COMMANDS as SWEEP
from evolvent.commands.sweep.app import main as sweep

PROGRAMS = {"evolvent-post": (post, POST, "post"), "evolvent-sweep": (sweep, SWEEP, "sweep")}
TREE = [(name, *words) for name, row in PROGRAMS.items() for words in [(), *((c,) for c in row[1])]]


@pytest.mark.parametrize("words", TREE, ids=[" ".join(words) for words in TREE])
def test_h_and_help_are_the_same_for_every_command(
    words: tuple[str, ...], monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    def said(option: str) -> str:
        monkeypatch.setattr(sys, "argv", [*words, option])
        with pytest.raises(SystemExit) as stopped:
            PROGRAMS[words[0]][0]()
        assert not stopped.value.code
        return capsys.readouterr().out

    assert said("-h") == said("--help")
    assert said("-h").startswith(f"Usage: {' '.join(words)} ")


@pytest.fixture
def in_bash(tmp_path: Path) -> Callable[[str, str], str]:
    """Run lines in a bash that finds only one of the programs; return their output."""

    def run(program: str, lines: str) -> str:
        folder = PROGRAMS[program][2]
        call = f"from evolvent.commands.{folder}.app import main; main()"
        script = tmp_path / program
        script.write_text(f"#!/bin/sh\nexec '{sys.executable}' -c '{call}' \"$@\"\n")
        script.chmod(0o755)
        lines = f"PATH='{tmp_path}':$PATH\n{lines}\n:"  # `:`, or bash would become the last command
        done = subprocess.run(
            [machine.program("bash"), "-c", lines],
            capture_output=True,
            text=True,
            check=True,
            timeout=60,
        )
        assert done.stderr == ""
        return done.stdout

    return run


@pytest.mark.parametrize("program", PROGRAMS)
def test_what_show_completion_prints_completes_commands_in_bash(
    in_bash: Callable[[str, str], str], program: str
) -> None:
    commands = list(PROGRAMS[program][1])
    lines = f"""
        {program} --show-completion >completion || exit 1
        . ./completion
        rm completion
        complete -p {program}
        COMP_WORDS=({program} {commands[0][:1]})
        COMP_CWORD=1
        _{program.replace("-", "_")}_completion {program}
        printf '%s\\n' "${{COMPREPLY[@]}}"
    """
    first, *completed = in_bash(program, f'cd "$(mktemp -d)"\n{lines}').splitlines()
    assert first.endswith(f" {program}")
    assert sorted(completed) == sorted(c for c in commands if c[0] == commands[0][0])
