"""evolvent-post and evolvent-sweep import only required modules, and parse like typer."""

from __future__ import annotations

import os
import subprocess
import sys
from collections.abc import Callable
from importlib import import_module
from pathlib import Path
from typing import Any

import pytest
import typer
from sweeps import failed, make_design, row, write_journal

from evolvent.commands.command_line import OptionSpec, UnclearError, for_typer, parameters, read
from evolvent.commands.post.app import COMMANDS as POST
from evolvent.commands.program import OPTIONS
from evolvent.commands.sweep.app import COMMANDS as SWEEP

HEAVY = {
    *("numpy", "h5py", "xarray", "pandas", "scipy", "matplotlib", "plotly", "PIL"),
    *("rich", "yaml", "jinja2", "typer", "pydantic", "distributed"),
}
FILES = {"numpy", "h5py", "rich", "yaml"}
DATASETS = {*FILES, "xarray", "pandas"}
SIGNALS = {*DATASETS, "scipy"}
FIGURES = {*DATASETS, "matplotlib", "PIL"}
OF_DASK = {"distributed", "scipy", "jinja2"}  # if installed: xarray imports it
# Permitted imports of each command during its work; for its help it imports none.
MAY_IMPORT = {
    "evolvent-post": {
        "animate": FIGURES,
        "check": FILES,
        "plot": FIGURES,
        "report": {*FIGURES, "plotly"},
        "compare": DATASETS,
        "spectrum": SIGNALS,
        "waterfall": SIGNALS,
        "sidebands": SIGNALS,
        "campbell": DATASETS,
        "fatigue": DATASETS,
    },
    "evolvent-sweep": {
        "plan": {*FILES, "scipy"},
        "run": FILES,
        "slurm": {*FILES, "jinja2"},
        "collect": {*DATASETS, *OF_DASK},
        "status": FILES,
        "retry": {*FILES, "jinja2"},
        "plot": {*FIGURES, *OF_DASK},
    },
}
FOLDERS = {"evolvent-post": "post", "evolvent-sweep": "sweep"}
TREE = [(name, command) for name, rows in MAY_IMPORT.items() for command in rows]
NAMES = [" ".join(words) for words in TREE]


def command_of(program: str, name: str) -> Callable[..., Any]:
    """The function of a command."""
    return getattr(import_module(f"evolvent.commands.{FOLDERS[program]}.{name}"), name)


def imported(lines: str, *words: object, folder: Path | None = None) -> set[str]:
    """Heavy modules imported by a separate Python after these lines."""
    spec = f"import sys\nfrom pathlib import Path\n{lines}\n"
    spec += f"Path('imported').write_text(' '.join(sorted({HEAVY!r} & set(sys.modules))))"
    done = subprocess.run(
        [sys.executable, "-c", spec, *map(str, words)],
        **{"cwd": folder, "capture_output": True, "text": True, "timeout": 60},
        check=False,
    )
    assert done.returncode == 0, done.stderr
    return set(((folder or Path()) / "imported").read_text().split())


def test_every_command_has_a_row() -> None:
    assert list(MAY_IMPORT["evolvent-post"]) == list(POST)
    assert list(MAY_IMPORT["evolvent-sweep"]) == list(SWEEP)


def test_no_command_imports_what_is_heavy_before_it_is_run(tmp_path: Path) -> None:
    lines = [f"import evolvent.commands.{FOLDERS[name]}.{command}" for name, command in TREE]
    assert imported("\n".join(lines), folder=tmp_path) == set()


@pytest.fixture(scope="module")
def history(executable: Path, examples: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A history of a few outputs, of a pair with nearly constant speed."""
    path = tmp_path_factory.mktemp("start") / "run.h5"
    short = ("--set", "simulation.duration=0.02", "--set", "simulation.output_interval=0.0001")
    case = examples / "spur-pair.yaml"
    subprocess.run([executable, "run", case, "-o", path, "-q", *short], check=True, timeout=60)
    return path


@pytest.mark.parametrize("command", ["check", "compare", "spectrum", "plot"])
def test_a_command_imports_no_more_than_its_row_allows(
    history: Path, tmp_path: Path, command: str
) -> None:
    files = [history, history.with_name("other.h5")]
    if not files[1].exists():
        files[1].symlink_to(history)
    words = [command, *(files if command == "compare" else files[:1])]
    lines = (
        "from evolvent.commands.post.app import main\n"
        "try:\n    main()\nexcept SystemExit as end:\n    assert not end.code, end.code"
    )
    allowed = MAY_IMPORT["evolvent-post"][command]
    assert imported(lines, *words, folder=tmp_path) <= allowed


@pytest.mark.parametrize(
    "words", [["status", "d"], ["collect", "d", "-o", "s.h5"], ["plan", "sweep.yaml"]], ids=" ".join
)
def test_a_command_of_sweeps_imports_no_more_than_its_row_allows(
    executable: Path, examples: Path, tmp_path: Path, words: list[str]
) -> None:
    write_journal(tmp_path / "d", make_design(10), [row(0), row(1), failed(2)])
    plan = f"format: 1\ncase: {examples / 'paper.yaml'}\nmethod: sobol\nsamples: 2\nparameters:\n"
    path = "wheels.pinion.loads.0.value"
    (tmp_path / "sweep.yaml").write_text(f"{plan}- {{path: {path}, from: -1, to: -2}}\n")
    lines = (
        f"import os\nos.environ['EVOLVENT_EXECUTABLE'] = {str(executable)!r}\n"
        "from evolvent.commands.sweep.app import main\n"
        "try:\n    main()\nexcept SystemExit as end:\n    assert not end.code, end.code"
    )
    allowed = MAY_IMPORT["evolvent-sweep"][words[0]]
    assert imported(lines, *words, folder=tmp_path) <= allowed


def helped(program: str, *words: str, **environment: str) -> str:
    lines = f"from evolvent.commands.{FOLDERS[program]}.app import main; main()"
    done = subprocess.run(
        [sys.executable, "-c", lines, *words],
        **{"capture_output": True, "text": True, "timeout": 60},
        env={**os.environ, **environment},
        check=True,
    )
    return done.stdout


@pytest.mark.parametrize("program", FOLDERS)
def test_help_of_a_program_tells_what_typer_would_tell(program: str) -> None:
    module = import_module(f"evolvent.commands.{FOLDERS[program]}.app")
    app = typer.Typer(
        rich_markup_mode=None,
        context_settings={"help_option_names": ["-h", "--help"]},
        help=module.TEXT,
    )
    for name in module.COMMANDS:
        app.command()(for_typer(command_of(program, name)))

    @app.callback()
    def _(version: bool = typer.Option(False, "--version", help=OPTIONS["--version"])) -> None:
        pass

    from typer.testing import CliRunner

    theirs = CliRunner().invoke(app, ["--help"], prog_name=program, env={"COLUMNS": "80"}).stdout
    ours = helped(program, "--help", COLUMNS="80")
    assert ours.split("Commands:")[0] == theirs.split("Commands:")[0]
    for name, text in module.COMMANDS.items():
        spec = " ".join((command_of(program, name).__doc__ or "").split())
        assert spec.startswith(text)
        assert f"  {name} " in ours


def test_no_word_at_all_is_answered_by_the_help_and_code_2(
    capfd: pytest.CaptureFixture[str],
) -> None:
    lines = "from evolvent.commands.post.app import main; main()"
    done = subprocess.run([sys.executable, "-c", lines], check=False, timeout=60)
    said = capfd.readouterr()
    assert (done.returncode, said.out) == (2, "")
    assert said.err.startswith("Usage: evolvent-post ")


def test_help_fits_a_narrow_terminal() -> None:
    spec = helped("evolvent-post", "--help", COLUMNS="60").split("Options:")[1]
    assert max(map(len, spec.splitlines())) <= 58


SAMPLES = {int: "30", float: "1.5", str: "a,b", Path: "a b.h5"}


def words_of(command: Callable[..., Any]) -> list[str]:
    """A command line with every option and argument, repeatable ones twice."""
    words: list[str] = []
    for one in parameters(command):
        is_flag = one.kind is bool
        for _ in range(2 if one.is_list else 1):
            words += one.spec.names[-1:]
            if not is_flag:
                words.append(SAMPLES.get(one.kind) or next(iter(one.kind)).value)
    return words


@pytest.mark.parametrize(("program", "name"), TREE, ids=NAMES)
def test_a_command_line_is_read_as_typer_reads_it(program: str, name: str) -> None:
    from typer.testing import CliRunner

    command = command_of(program, name)
    whole = words_of(command)
    least = [w for one in parameters(command) if one.is_required for w in _least(one.spec)]
    for words in (whole, least):
        seen: list[dict[str, Any]] = []

        def note(_seen: list[dict[str, Any]] = seen, **values: Any) -> None:
            _seen.append(values)

        shown = for_typer(command)
        note.__signature__ = shown.__signature__  # type: ignore[attr-defined]
        note.__annotations__ = shown.__annotations__
        app = typer.Typer()
        app.command()(note)
        done = CliRunner().invoke(app, words)
        assert done.exit_code == 0, done.output
        ours = {key: value or None for key, value in read(command, words).items()}
        assert ours == {key: value or None for key, value in seen[0].items()}


def _least(spec: OptionSpec) -> list[str]:
    return [*spec.names[-1:], "a b.h5" if not spec.names else "500:900"]


@pytest.mark.parametrize(
    "words",
    [
        ["--help"],
        ["a.h5", "-h"],
        [],
        ["a.h5", "--no-such"],
        ["a.h5", "--last-pitches", "0"],
        ["a.h5", "--last-pitches", "nan"],
        ["a.h5", "--last-pitches"],
        ["a.h5", "--from", "3x"],
        ["a.h5", "--format", "gif"],
        ["a.h5", "--quantity", "-x"],
        ["a.h5", "--", "-b.h5"],
        ["a.h5", "--whole=1"],
        ["a.h5", "-ofigures"],
        [""],
    ],
    ids=" ".join,
)
def test_what_is_wrong_or_asks_for_help_is_left_to_typer(words: list[str]) -> None:
    with pytest.raises(UnclearError):
        read(command_of("evolvent-post", "check" if not words else "plot"), words)
