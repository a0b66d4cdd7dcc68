"""Shell completion: results of the scripts in bash, zsh and fish."""

from __future__ import annotations

import os
import re
import shutil
import subprocess
from collections.abc import Callable
from pathlib import Path

import pytest

import machine
from zsh import zsh

SHELLS = ("bash", "zsh", "fish")
Complete = Callable[..., list[str]]
# Values of options and files of commands, by their names in the help.
FILES = ["a b.yaml", "case.yaml", "design.h5", "folder", "notes.txt", "other.yml"]
CASES = ["a b.yaml", "case.yaml", "folder", "other.yml"]
OFFERED = {
    **dict.fromkeys(("HISTORY.h5", "FILE.h5", "FILE.fmu", "FILE"), FILES),
    **{"CASE.yaml": CASES, "DESIGN.h5": ["design.h5", "folder"], "DIR": ["folder"]},
    **{
        value: []
        for value in (
            *("TIME", "TIMES", "MINUTES", "X", "FROM:TO:STEPS", "PATH=FROM:TO[:STEPS]"),
            *("SPEED", "N", "I/N", "J", "INPUT"),
        )
    },
    **{"NAME": ["pinion-gear"], "bash": list(SHELLS)},
    "NAMES": [
        *("all", "gearbox", "wheels", "meshes", "pairs", "shafts", "bearings", "housing"),
        *("accelerometers", "energies", "losses", "forces", "tracking", "check"),
    ],
}


ODD = "p$(touch${IFS}PWNED)`touch${IFS}PWNED`';&|-%s\\"  # a wheel
ODD_MESH = "-$(touch${IFS}PWNED)"
ODD_FILES = ("$(touch PWNED).yaml", "-x.yaml", "'\".yaml", "%s.yaml")


def write_odd_cases(folder: Path, examples: Path) -> None:
    """A case with shell commands as names, in files with such names."""
    quoted = f"'{ODD.replace(chr(39), 2 * chr(39))}'"
    case = (examples / "paper.yaml").read_text().replace("pinion", quoted)
    case = case.replace(f"name: {quoted}-gear", f"name: {ODD_MESH}")
    for name in ("odd.yaml", *ODD_FILES):
        (folder / name).write_text(case)


def unquoted(shell: str, word: str, folder: Path) -> str:
    """A word as interpreted by a shell."""
    spelled = [shell, "-c", f"printf %s {word}"]
    if word.startswith("-"):
        spelled = [shell, "-c", f"printf -- '%s' {word}"]
    return subprocess.run(spelled, cwd=folder, capture_output=True, text=True, check=True).stdout


def script(executable: Path, shell: str) -> str:
    """Completion script of a shell."""
    command = [executable, "completion", shell]
    return subprocess.run(command, capture_output=True, text=True, check=True, timeout=60).stdout


@pytest.fixture
def complete(executable: Path, examples: Path, tmp_path: Path) -> Complete:
    """Completions of bash for the last word, in a folder with a case and other files."""
    (tmp_path / "complete.sh").write_text(script(executable, "bash"))
    folder = tmp_path / "work"
    (folder / "folder").mkdir(parents=True)
    for name in ("a b.yaml", "other.yml", "design.h5", "notes.txt"):
        (folder / name).touch()
    shutil.copyfile(examples / "spur-pair.yaml", folder / "case.yaml")

    def run(*words: str) -> list[str]:
        lines = (
            '. ../complete.sh; complete -p evolvent >/dev/null || exit; COMP_WORDS=("$@")\n'
            "COMP_CWORD=$((${#COMP_WORDS[@]} - 1))\n"
            '_evolvent evolvent "${COMP_WORDS[COMP_CWORD]}"; printf \'%s\\n\' "${COMPREPLY[@]}"'
        )
        done = subprocess.run(
            ["bash", "-c", lines, "bash", str(executable), *words],
            **{"cwd": folder, "capture_output": True, "text": True, "timeout": 60},
            check=True,
        )
        assert done.stderr == ""
        return sorted(filter(None, done.stdout.splitlines()))

    return run


@pytest.fixture(scope="module")
def helps(executable: Path) -> dict[str, str]:
    """The help of the program, and of every command that it lists."""

    def helped(*words: str) -> str:
        command = [executable, *words, "--help"]
        return subprocess.run(command, capture_output=True, text=True, check=True).stdout

    listed = helped().partition("\nCommands:\n")[2].partition("\n\n")[0]
    names = re.findall(r"^  (\w+) +\S", listed, re.MULTILINE)
    return {"": helped(), **{name: helped(name) for name in names}}


def options_of(text: str) -> dict[str, str]:
    """Options of a help text with the names of their values, or ""."""
    described = text.partition("\nOptions:\n")[2].partition("\n\n")[0]
    rows = re.findall(r"^ +(?:(-\w), )?(--[\w-]+)(?: ([A-Z]\S*))? ", described, re.MULTILINE)
    return {name: value for letter, long, value in rows for name in (letter, long) if name}


def test_bash_completes_commands_and_the_options_of_the_program(
    complete: Complete, helps: dict[str, str]
) -> None:
    names = [name for name in helps if name]
    assert complete("") == sorted([*names, *options_of(helps[""])])
    assert complete("s") == ["show", "static"]
    assert complete("no-such-command", "") == []


def test_bash_completes_every_option_of_every_command(
    complete: Complete, helps: dict[str, str]
) -> None:
    for name, text in helps.items():
        if name:
            options = options_of(text)
            assert "--help" in options
            assert complete(name, "-") == sorted(options)
            assert complete(name, "case.yaml", "--h") == ["--help"]


def test_bash_offers_what_fits_for_every_value_and_every_file(
    complete: Complete, helps: dict[str, str]
) -> None:
    for name, text in helps.items():
        if not name:
            continue
        file = text.split()[3].removesuffix("...")
        assert complete(name, "") == sorted(OFFERED[file]), name
        for option, value in options_of(text).items():
            if value and value != "PATH=VALUE":
                offered = sorted(OFFERED[value])
                assert complete(name, "case.yaml", option, "") == offered, (name, option)
                if option.startswith("--"):  # bash splits --option=value into three words
                    assert complete(name, "case.yaml", option, "=") == offered


def test_bash_offers_the_paths_of_the_case_for_settings(
    complete: Complete, helps: dict[str, str]
) -> None:
    for name in ("run", "validate", "show", "modes", "static"):
        assert "--set" in options_of(helps[name])
        found = complete(name, "case.yaml", "--set", "wheels.pinion.t")
        assert {"wheels.pinion.teeth=", "wheels.pinion.tip_rounding="} <= set(found)
        assert all(re.fullmatch(r"wheels\.pinion\.t\w+=", path) for path in found)
        assert complete(name, "case.yaml", "--set", "=", "wheels.pinion.te")  # --set=...
        assert complete(name, "case.yaml", "--set", "wheels.pinion.teeth", "=") == []
        assert complete(name, "--set", "wheels.") == []  # without a case


def test_a_word_that_begins_a_name_with_a_blank_is_one_word(complete: Complete) -> None:
    assert complete("run", "a") == ["a b.yaml"]


def test_names_of_a_case_are_quoted_and_nothing_in_them_is_run(
    complete: Complete, examples: Path, tmp_path: Path
) -> None:
    folder = tmp_path / "work"
    write_odd_cases(folder, examples)
    offered = complete("run", "odd.yaml", "--set", "wheels.p")
    assert len(offered) > 3
    for word in offered:
        assert unquoted("bash", word, folder).startswith(f"wheels.{ODD}.")
    assert complete("run", "odd.yaml", "--set", offered[0][:-3])
    assert complete("static", "odd.yaml", "--mesh", "") == ["-\\$\\(touch\\$\\{IFS\\}PWNED\\)"]
    for name in ODD_FILES:
        complete("run", name, "--set", "wheels.p")
    assert set(complete("run", "")) >= set(ODD_FILES)
    assert not (folder / "PWNED").exists()


def test_zsh_completes_and_runs_nothing_that_names_say(
    executable: Path, examples: Path, tmp_path: Path
) -> None:
    machine.program("zsh")
    folder = tmp_path / "work"
    folder.mkdir()
    write_odd_cases(folder, examples)
    names = [*ODD_FILES, "a\nb.yaml"]
    shutil.copyfile(folder / "odd.yaml", folder / names[-1])
    (tmp_path / "_evolvent").write_text(script(executable, "zsh"))
    (tmp_path / "bin").mkdir()
    (tmp_path / "bin" / "evolvent").symlink_to(executable)
    with zsh(folder, f"{tmp_path / 'bin'}:{os.environ['PATH']}") as shell:
        assert shell.complete("evolvent s")[0] == ["show", "static"]
        assert shell.complete("evolvent va")[1] == "evolvent validate "
        assert shell.complete("evolvent run --q")[1] == "evolvent run --quiet "
        assert shell.complete("evolvent completion ")[0] == list(SHELLS)
        offered = shell.complete("evolvent run ")[0]
        assert {unquoted("zsh", word, folder) for word in offered} == {*names, "odd.yaml"}
        for case in ("odd.yaml", *(word for word in offered if not word.startswith("-"))):
            settings, line = shell.complete(f"evolvent run {case} --set wheels.p")
            assert len(settings) > 3, case
            for word in settings:
                assert unquoted("zsh", word, folder).startswith(f"wheels.{ODD}.")
            assert unquoted("zsh", line.split("--set ")[1], folder) == f"wheels.{ODD}."
        (mesh,), _ = shell.complete("evolvent static odd.yaml --mesh ")
        assert unquoted("zsh", mesh, folder) == ODD_MESH
    assert not list(tmp_path.rglob("PWNED*"))


def test_an_unknown_shell_is_named(executable: Path) -> None:
    command = [executable, "completion", "bsh"]
    done = subprocess.run(command, capture_output=True, text=True, check=False, timeout=60)
    assert (done.returncode, done.stdout) == (2, "")
    known = "completions exist for bash, zsh, fish\n"
    said = f"evolvent: unknown shell 'bsh' (did you mean 'bash'?); {known}"
    assert done.stderr == said


@pytest.mark.parametrize("shell", SHELLS)
def test_the_shell_reads_its_script_and_finds_no_fault(
    executable: Path, tmp_path: Path, shell: str
) -> None:
    path = tmp_path / "script"
    path.write_text(script(executable, shell))
    done = subprocess.run(
        [machine.program(shell), "-n", path], capture_output=True, text=True, check=False
    )
    assert (done.returncode, done.stdout, done.stderr) == (0, "", "")


@pytest.mark.parametrize("shell", SHELLS)
def test_scripts_name_every_command_and_option(
    executable: Path, helps: dict[str, str], shell: str
) -> None:
    text = script(executable, shell)
    for name, spelled in helps.items():
        assert re.search(rf"\b{name}\b", text)
        for option in options_of(spelled):
            flag = "-s" if len(option) == 2 else "-l"
            assert (f"{flag} {option.lstrip('-')} " if shell == "fish" else option) in text


def test_fish_completes_commands_options_and_settings(
    executable: Path, examples: Path, tmp_path: Path
) -> None:
    fish = machine.program("fish")
    (tmp_path / "evolvent.fish").write_text(script(executable, "fish"))
    (tmp_path / "evolvent").symlink_to(executable)
    shutil.copyfile(examples / "spur-pair.yaml", tmp_path / "case.yaml")

    def offered(line: str) -> list[str]:
        lines = f"set PATH {tmp_path} $PATH; source evolvent.fish; complete -C '{line}'"
        done = subprocess.run(
            [fish, "-c", lines],
            **{"cwd": tmp_path, "capture_output": True, "text": True, "timeout": 60},
            env={**os.environ, "HOME": str(tmp_path), "XDG_CONFIG_HOME": str(tmp_path)},
            check=True,
        )
        return [text.partition("\t")[0] for text in done.stdout.splitlines()]

    assert offered("evolvent va") == ["validate"]
    assert offered("evolvent run --q") == ["--quiet"]
    assert offered("evolvent run case.yaml --set wheels.pinion.te") == ["wheels.pinion.teeth="]
    write_odd_cases(tmp_path, examples)
    assert offered("evolvent static odd.yaml --mesh ") == [ODD_MESH]
    assert {*ODD_FILES[:1], *ODD_FILES[2:]} <= set(offered("evolvent run "))
    for case in ("odd.yaml", "\\$\\(touch\\ PWNED\\).yaml", "%s.yaml"):
        settings = offered(f"evolvent run {case} --set wheels.p")
        assert len(settings) > 3, case
        assert all(word.startswith(f"wheels.{ODD}.") for word in settings)
    assert not list(tmp_path.rglob("PWNED*"))
