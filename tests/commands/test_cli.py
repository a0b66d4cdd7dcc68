"""Command line: accepted input, messages, exit codes."""

from __future__ import annotations

import re
import subprocess
from collections.abc import Callable
from pathlib import Path

import pytest

Evolvent = Callable[..., subprocess.CompletedProcess[str]]
SHORT = ("--set", "simulation.duration=0.01")  # a very short run


def assert_misuse(result: subprocess.CompletedProcess[str], complaint: str) -> None:
    """Exit code 2, the error in the first line of stderr, then a short help, no stdout."""
    first, *rest = result.stderr.splitlines()
    assert result.returncode == 2
    assert complaint in first
    assert any(line.startswith("Usage: evolvent") for line in rest)
    assert rest[-1].startswith("See 'evolvent ")
    assert rest[-1].endswith("--help'.")
    assert len(rest) < 16  # lines
    assert result.stdout == ""


@pytest.fixture(scope="session")
def commands(executable: Path) -> dict[str, str]:
    """All commands that the program lists, and their help."""

    def helped(*words: str) -> str:
        done = subprocess.run(
            [executable, *words, "--help"], capture_output=True, text=True, check=True, timeout=60
        )
        assert done.stderr == ""
        return done.stdout

    listed = helped().partition("\nCommands:\n")[2].partition("\n\n")[0]
    return {name: helped(name) for name in re.findall(r"^  (\w+) +\S", listed, re.MULTILINE)}


def test_without_arguments_a_short_help_goes_to_stderr(evolvent: Evolvent) -> None:
    assert_misuse(evolvent(), "a command is missing")


@pytest.mark.parametrize(
    ("words", "complaint"),
    [
        (["rum"], "unknown command 'rum' (did you mean 'run'?)"),
        (["shwo", "x.yaml"], "unknown command 'shwo' (did you mean 'show'?)"),
        (["mdoes", "x.yaml"], "unknown command 'mdoes' (did you mean 'modes'?)"),
        (["integrate"], "unknown command 'integrate'"),
        (["--versoin"], "unknown option '--versoin' (did you mean '--version'?)"),
        (["run"], "'run' needs a case file"),
        (["show"], "'show' needs a case file"),
        (["modes"], "'modes' needs a case file"),
        (["modes", "a.yaml", "--at"], "option '--at' needs a value"),
        (["modes", "a.yaml", "--att=1"], "unknown option '--att' (did you mean '--at'?)"),
        (["run", "--at=1", "a.yaml"], "unknown option '--at'"),
        (["run", "a.yaml", "b.yaml"], "one case at a time; 'b.yaml' follows 'a.yaml'"),
        (["run", "--ouput=x.h5"], "unknown option '--ouput' (did you mean '--output'?)"),
        (["run", "--json", "a.yaml"], "unknown option '--json'"),
        (["run", "-z", "a.yaml"], "unknown option '-z'"),
        (["run", "a.yaml", "-o"], "option '--output' needs a value"),
        (["run", "a.yaml", "-o", ""], "option '--output' needs a value"),
        (["run", "a.yaml", "--set"], "option '--set' needs a value"),
        (["run", "a.yaml", "--quiet=yes"], "option '--quiet' takes no value"),
        (["show", "--laws", "a.yaml"], "option '--laws' excludes all other arguments"),
        (["show", "--laws", "--keys"], "option '--laws' excludes all other arguments"),
    ],
)
def test_misuse_is_named_and_exits_with_2(
    evolvent: Evolvent, words: list[str], complaint: str
) -> None:
    assert_misuse(evolvent(*words), complaint)


def test_a_set_option_without_equals_sign_is_misuse(evolvent: Evolvent, examples: Path) -> None:
    result = evolvent("run", examples / "paper.yaml", "--set", "wheels.pinion.teeth")
    assert result.returncode == 2
    assert "'='" in result.stderr
    assert len(result.stderr.splitlines()) == 1


@pytest.mark.parametrize("words", [["--help"], ["-h"]])
def test_help_lists_every_command_and_exit_code_on_stdout(
    evolvent: Evolvent, commands: dict[str, str], words: list[str]
) -> None:
    result = evolvent(*words)
    assert (result.returncode, result.stderr) == (0, "")
    assert commands.keys() >= {"run", "show", "modes", "batch"}
    for code in (0, 2, 3, 4, 74, 75):
        assert re.search(rf"^ +{code}  \w", result.stdout, re.MULTILINE)


def test_help_of_every_command_has_an_example_and_the_options_of_its_usage(
    commands: dict[str, str],
) -> None:
    for command, text in commands.items():
        usage, described = text.partition("\n")[0], text.partition("\nOptions:\n")[2]
        assert usage.startswith(f"Usage: evolvent {command} ")
        assert f"\n  evolvent {command} " in text.partition("\nExamples:\n")[2]
        for option in re.findall(r"(?<!\w)--?[a-z-]+", usage):
            assert re.search(rf"^ +(-\w, )?{option}\b", described, re.MULTILINE), option


def test_every_command_refuses_what_it_does_not_know_and_names_what_it_needs(
    evolvent: Evolvent, commands: dict[str, str]
) -> None:
    for command, text in commands.items():
        assert_misuse(evolvent(command), f"'{command}' needs a ")
        if "..." not in text.split()[3]:  # CASE.yaml... is several
            assert_misuse(evolvent(command, "a", "b"), " at a time; 'b' follows 'a'")
        assert_misuse(evolvent(command, "a", "-Z"), "unknown option '-Z'")
        complaint = f"unknown command '{command}x' (did you mean '{command}'?)"
        assert_misuse(evolvent(f"{command}x"), complaint)
        options = text.partition("\nOptions:\n")[2].partition("\n\n")[0]
        for option, value in re.findall(r"(--[a-z-]+) ([A-Z]\S*)?", options):
            assert_misuse(
                evolvent(command, f"{option}x"), f"'{option}x' (did you mean '{option}'?)"
            )
            if value:
                complaint = f"option '{option}' needs a value: {option} {value}"
                assert_misuse(evolvent(command, "a", option), complaint)
            else:
                assert_misuse(evolvent(command, f"{option}=1"), f"'{option}' takes no value")


def test_help_wins_over_a_missing_case(evolvent: Evolvent) -> None:
    result = evolvent("run", "no-such-case.yaml", "--help")
    assert (result.returncode, result.stderr) == (0, "")
    assert result.stdout == evolvent("run", "--help").stdout
    assert result.stdout.startswith("Usage: evolvent run ")


def test_version_is_that_of_the_build_and_names_the_libraries(
    evolvent: Evolvent, root: Path
) -> None:
    match = re.search(r"^\s*VERSION (\S+)", (root / "CMakeLists.txt").read_text(), re.MULTILINE)
    assert match
    result = evolvent("--version")
    assert result.returncode == 0
    assert result.stdout.splitlines()[0] == f"evolvent {match[1]}"
    assert re.search(r"^SUNDIALS \d+\.\d+", result.stdout, re.MULTILINE)
    assert re.search(r"^HDF5 \d+\.\d+", result.stdout, re.MULTILINE)


@pytest.mark.parametrize(
    "words",
    [
        ["-o", "x.h5", "CASE"],
        ["-ox.h5", "CASE"],
        ["-qo", "x.h5", "CASE"],
        ["-qox.h5", "CASE"],
        ["CASE", "--output", "x.h5"],
        ["CASE", "--output=x.h5"],
        ["--output=x.h5", "--", "CASE"],
    ],
)
def test_options_may_be_written_in_every_usual_way(
    evolvent: Evolvent, examples: Path, tmp_path: Path, words: list[str]
) -> None:
    case = str(examples / "paper.yaml")
    result = evolvent("run", *SHORT, *(case if word == "CASE" else word for word in words))
    assert result.returncode == 0, result.stderr
    assert [path.name for path in tmp_path.iterdir()] == ["x.h5"]


def test_after_two_dashes_a_word_is_a_file(
    evolvent: Evolvent, examples: Path, tmp_path: Path
) -> None:
    (tmp_path / "-q.yaml").write_text((examples / "paper.yaml").read_text())
    assert evolvent("run", *SHORT, "--", "-q.yaml").returncode == 0
    assert (tmp_path / "-q.h5").is_file()


@pytest.mark.parametrize(
    "words",
    [
        *(["--help"], ["--version"], ["show", "CASE"], ["show", "--laws"]),
        *(["modes", "CASE"], ["modes", "CASE", "--json"]),
    ],
)
def test_a_full_standard_output_exits_with_74(
    executable: Path, examples: Path, words: list[str]
) -> None:
    case = str(examples / "paper.yaml")
    with Path("/dev/full").open("w") as full:
        result = subprocess.run(
            [str(executable), *(case if word == "CASE" else word for word in words)],
            stdout=full,
            stderr=subprocess.PIPE,
            text=True,
            timeout=60,
            check=False,
        )
    assert result.returncode == 74
    assert "cannot write to standard output: No space left on device" in result.stderr
