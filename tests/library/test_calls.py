"""What Python may give, what is refused, and what a call leaves alone."""

from __future__ import annotations

import json
import locale
import os
import pickle
import re
import subprocess
import sys
import threading
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import yaml

import evolvent as package
import machine
from evolvent.library import binding, waiting

SHORT = {"simulation.duration": 0.06}
LONG = {"simulation.duration": 1e6}
HEADER = "driver/library/include/evolvent/evolvent.h"


def bits(history: Any) -> bytes:
    return b"".join(v.values.tobytes() for v in history.variables.values() if v.dtype.kind in "fi")


# --- the binding and the header


def test_the_binding_has_every_procedure_of_the_header(root: Path, library: Path) -> None:
    text = re.sub(r"/\*.*?\*/", "", (root / HEADER).read_text(), flags=re.DOTALL)
    declared = dict(re.findall(r"(evolvent_\w+)\(([^;{]*)\);", text))
    assert set(declared) == set(binding.PROCEDURES)
    for name, arguments in declared.items():
        n = 0 if arguments.strip() == "void" else arguments.count(",") + 1
        assert n == len(binding.PROCEDURES[name][1]), name


def test_the_binding_s_structures_are_those_of_the_compiler(root: Path, tmp_path: Path) -> None:
    structures = {
        "evolvent_error": binding.Error,
        "evolvent_static_request": binding.StaticRequest,
        "evolvent_respond_request": binding.RespondRequest,
        "evolvent_modes_request": binding.ModesRequest,
        "evolvent_variable": binding.Variable,
        "evolvent_attribute": binding.Attribute,
    }
    text = re.sub(r"/\*.*?\*/", "", (root / HEADER).read_text(), flags=re.DOTALL)
    assert set(re.findall(r"typedef struct (\w+) \{", text)) == set(structures)
    lines = ["#include <evolvent/evolvent.h>", "#include <stdio.h>", "int main(void) {"]
    expected = []
    for name, structure in structures.items():
        lines.append(f'printf("{name} %zu\\n", sizeof({name}));')
        expected.append(f"{name} {binding.ctypes.sizeof(structure)}")
        for field, _ in structure._fields_:
            lines.append(f'printf("{field} %zu\\n", offsetof({name}, {field}));')
            expected.append(f"{field} {getattr(structure, field).offset}")
    source, program = tmp_path / "sizes.c", tmp_path / "sizes"
    source.write_text("\n".join([*lines, "return 0; }\n"]))
    folder = (root / HEADER).parents[1]
    subprocess.run(
        [
            os.environ.get("CC", "cc"),
            "-pedantic-errors",
            "-std=c99",
            f"-I{folder}",
            source,
            "-o",
            program,
        ],
        check=True,
    )
    reported = subprocess.run([program], capture_output=True, text=True, check=True)
    assert reported.stdout.split("\n")[:-1] == expected


def test_the_library_has_no_hdf5_and_shows_its_own_names_only(library: Path) -> None:
    assert b"H5F" not in library.read_bytes()
    loaded = subprocess.run(
        [
            sys.executable,
            "-c",
            f"import ctypes; ctypes.CDLL({str(library)!r})\nprint(open('/proc/self/maps').read())",
        ],
        capture_output=True,
        text=True,
        check=True,
    ).stdout
    assert "libevolvent_kernel" in loaded
    assert "hdf5" not in loaded
    names = subprocess.run(
        ["nm", "-D", "--defined-only", library], capture_output=True, text=True, check=True
    ).stdout
    shown = {line.split()[-1] for line in names.splitlines()}
    assert shown == {*binding.PROCEDURES, "evl_memory_run_out"}


# --- what may be given


def test_a_case_may_be_a_path_a_text_or_a_mapping(examples: Path) -> None:
    path = examples / "paper-friction.yaml"
    text = path.read_text()
    by_path = package.run(path, SHORT)
    for case in (str(path), text, yaml.safe_load(text)):
        other = package.run(case, SHORT)
        assert bits(other) == bits(by_path)
        whole = [yaml.safe_load(one.attrs["case"]) for one in (other, by_path)]
        assert whole[0] == whole[1]


def test_settings_may_be_a_mapping_of_numbers_or_texts_of_options(examples: Path) -> None:
    path = examples / "paper.yaml"
    given = {
        "simulation.duration": np.float64(0.06),
        "wheels.gear.teeth": np.int32(33),
        "wheels.pinion.centre": np.array([0.0, 0.0]),
        "wheels.pinion.loads.0.value": "-2 N m",
        "meshes.0.tracking": "closed_form",
    }
    options = [
        "simulation.duration=0.06",
        "wheels.gear.teeth=33",
        "wheels.pinion.centre=[0.0, 0.0]",
        "wheels.pinion.loads.0.value=-2 N m",
        "meshes.0.tracking=closed_form",
    ]
    assert bits(package.run(path, given)) == bits(package.run(path, options))


def test_show_modes_and_parameters_are_what_the_program_prints(
    evolvent: Callable[..., Any], examples: Path
) -> None:
    case = examples / "two-stage-gears.yaml"
    setting = {"simulation.tolerance": 1e-6}
    words = ("--set", "simulation.tolerance=1e-6", "--json")
    for got, command in (
        (package.show(case, setting), ("show", case)),
        (package.parameters(case, setting), ("show", case, "--parameters")),
        (package.modes(case, setting), ("modes", case)),
        (package.modes(case, setting, mean=True), ("modes", case, "--mean")),
        (
            package.modes(case, setting, mesh_position=0.25),
            ("modes", case, "--mesh-position", 0.25),
        ),
        (package.modes(case, setting, at=0.01), ("modes", case, "--at", 0.01)),
        (package.datasheet(case, setting), ("datasheet", case)),
        (package.datasheet(case, setting, mesh="second"), ("datasheet", case, "--mesh", 1)),
    ):
        assert got == json.loads(evolvent(*command, *words).stdout), command


# --- what is refused


@pytest.mark.parametrize(
    ("call", "words"),
    [
        (
            lambda case: package.run(case, {"wheels.gear.teeth": -3}),
            ("run", "--set", "wheels.gear.teeth=-3"),
        ),
        (
            lambda case: package.show(case, ["wheels.gear.teth=3"]),
            ("show", "--set", "wheels.gear.teth=3"),
        ),
        (lambda case: package.run(case, ["teeth"]), ("run", "--set", "teeth")),
        (
            lambda case: package.show(
                case, ["simulation.initial={kind: steady}", "wheels.gear.loads=[]"]
            ),
            (
                *("show", "--set", "simulation.initial={kind: steady}"),
                *("--set", "wheels.gear.loads=[]"),
            ),
        ),
        (lambda case: package.modes(case, at=9), ("modes", "--at", "9")),
        (lambda case: package.modes(case, at="x"), ("modes", "--at", "x")),
        (lambda case: package.static(case, torque="5:2:3"), ("static", "--torque", "5:2:3")),
        (lambda case: package.static(case, mesh="pinion"), ("static", "--mesh", "pinion")),
        (lambda case: package.static(case, points=3), ("static", "--points", "3")),
        (lambda case: package.datasheet(case, mesh=2), ("datasheet", "--mesh", "2")),
    ],
)
def test_an_exception_has_the_words_of_the_program_s_line(
    evolvent: Callable[..., Any],
    examples: Path,
    call: Callable[[Path], Any],
    words: tuple[str, ...],
) -> None:
    case = examples / "paper.yaml"
    with pytest.raises(package.AnalysisError) as refused:
        call(case)
    done = evolvent(words[0], case, *words[1:])
    error = refused.value
    assert done.stderr == f"{error}\n"
    assert (error.code, str(error)) == (
        done.returncode,
        f"{error.place or 'evolvent'}: {error.reason}",
    )
    again = pickle.loads(pickle.dumps(error))
    assert (again.code, again.place, again.reason) == (error.code, error.place, error.reason)


def test_modes_are_those_of_one_state_at_a_time(examples: Path) -> None:
    with pytest.raises(package.AnalysisError, match="at a time") as refused:
        package.modes(examples / "paper.yaml", at=0.01, mean=True)
    assert refused.value.code == 2


def test_a_bad_case_is_refused_at_its_line(
    evolvent: Callable[..., Any], examples: Path, tmp_path: Path
) -> None:
    text = (examples / "paper.yaml").read_text().replace("width: 0.1 ", "width: -1 ", 1)
    bad = tmp_path / "bad.yaml"
    bad.write_text(text)
    done = evolvent("run", bad)
    with pytest.raises(package.AnalysisError) as by_path:
        package.run(bad)
    assert f"{by_path.value}\n" == done.stderr
    place = by_path.value.place.removeprefix(f"{bad}")
    with pytest.raises(package.AnalysisError) as by_text:
        package.run(text)
    assert by_text.value.place == f"case{place}"
    with pytest.raises(package.AnalysisError) as by_mapping:
        package.run(yaml.safe_load(text))
    assert by_mapping.value.place == "case"
    assert by_mapping.value.reason == by_path.value.reason
    assert by_mapping.value.reason.startswith("wheels.pinion.width: ")


@pytest.mark.parametrize(
    ("case", "settings", "what"),
    [
        ("no-such.yaml", None, "no-such.yaml: cannot be read: No such file or directory"),
        ("a\0b", None, "holds a character of code 0"),
        ("format: 1\nx: \0\n", None, "holds a character of code 0"),
        ({"format": 1}, None, "case: "),
        ({}, None, "case: "),
        ("\n", None, "case: is empty"),
        ({"format": float("nan")}, None, "case: "),
        ("no-such.yaml", "a=1", "must be {path: value} or a list"),
        ("no-such.yaml", {"a": "\0"}, "holds a character of code 0"),
        (5, None, "case=5: must be the path of a case file, its text, or the equivalent mapping"),
        (None, None, "case=None: must be the path of a case file"),
        (b"format: 1", None, "case=b'format: 1': must be the path of a case file"),
        ({"format": {1, 2}}, None, "case: {1, 2} is neither a number nor a text, list or mapping"),
        ("no-such.yaml", 5, "set=5: must be {path: value} or a list"),
        ("no-such.yaml", [("a", 1)], "set=[('a', 1)]: must be {path: value} or a list"),
        ("no-such.yaml", {"a.b": 1j}, "a.b: 1j is neither a number nor a text, list or mapping"),
    ],
)
def test_what_is_no_case_is_refused(case: Any, settings: Any, what: str) -> None:
    with pytest.raises(package.AnalysisError, match=re.escape(what)) as refused:
        package.run(case, settings)
    assert "\n" not in str(refused.value)
    assert refused.value.history is None


def test_a_run_that_fails_gives_what_there_is(
    evolvent: Callable[..., Any], examples: Path, tmp_path: Path
) -> None:
    start = "{kind: speeds, speeds: {pinion: -1, gear: 0.6667}, gaps: {pinion-gear: -0.01}}"
    settings = {"simulation.initial": start}
    done = evolvent(
        "run",
        examples / "paper.yaml",
        "-q",
        "-o",
        "h.h5",
        *(word for key, value in settings.items() for word in ("--set", f"{key}={value}")),
    )
    assert done.returncode == 4, done.stderr
    with pytest.raises(package.AnalysisError) as failed:
        package.run(examples / "paper.yaml", settings)
    assert done.stderr.splitlines()[-1].startswith(f"{failed.value}; the history up to there")
    assert failed.value.code == 4
    history = failed.value.history
    assert history is not None
    with package.open_history(tmp_path / "h.h5.partial") as file:
        assert bits(history) == bits(file)
        assert history.attrs["status_message"] == file.attrs["status_message"]


def test_a_run_without_a_whole_period_in_its_window_raises_the_reason(examples: Path) -> None:
    settings = {"simulation.metrics": {"turns_of": "gear"}, "simulation.duration": 0.01}
    with pytest.raises(
        package.AnalysisError, match="contains no whole revolution of wheel 'gear'"
    ) as failed:
        package.run(examples / "tutorial-pair.yaml", settings)
    assert failed.value.code == 4
    assert int(failed.value.history["window_periods"]) == 0


# --- what a call leaves alone


def test_a_call_prints_nothing_and_touches_no_file(
    examples: Path,
    tmp_path: Path,
    capfd: pytest.CaptureFixture[str],
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.chdir(tmp_path)
    for case in ("paper.yaml", "compliant-pair.yaml", "rattle.yaml"):
        package.run(examples / case, SHORT)
        package.modes(examples / case, at=0.01)
        package.show(examples / case)
    package.static(examples / "compliant-pair.yaml", torque=5)
    assert capfd.readouterr() == ("", "")
    assert list(tmp_path.iterdir()) == []


COMMA = """comment_char %
escape_char /
LC_NUMERIC
decimal_point ","
thousands_sep "."
grouping 3;3
END LC_NUMERIC
"""


def ascii_charmap() -> str:
    """Character map of a locale; that of the system is in a package of its own."""
    rows = "\n".join(f"<U{code:04X}> /x{code:02x} character {code}" for code in range(128))
    head = "<code_set_name> ASCII\n<comment_char> %\n<escape_char> /\nCHARMAP"
    return f"{head}\n{rows}\nEND CHARMAP\n"


def test_a_process_with_a_decimal_comma_gets_the_texts_and_bits_of_one_without(
    examples: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """In a locale made for the test, without the system's locale data."""
    case = examples / "paper-friction.yaml"

    def answers() -> tuple[str, bytes]:
        return json.dumps(package.show(case)), bits(package.run(case, SHORT))

    expected = answers()
    (tmp_path / "comma.txt").write_text(COMMA)
    (tmp_path / "ascii.txt").write_text(ascii_charmap())
    sources = ["-f", tmp_path / "ascii.txt", "-i", tmp_path / "comma.txt"]
    words = [machine.program("localedef"), "--no-archive", "-c", *sources, tmp_path / "comma"]
    made = subprocess.run(words, capture_output=True, text=True, check=False)
    assert made.returncode in (0, 1), made.stderr  # 1: made, with warnings of missing categories
    monkeypatch.setenv("LOCPATH", str(tmp_path))
    before = locale.setlocale(locale.LC_NUMERIC)
    locale.setlocale(locale.LC_NUMERIC, "comma")
    try:
        assert locale.localeconv()["decimal_point"] == ","
        reported = answers()
        assert locale.localeconv()["decimal_point"] == ","
    finally:
        locale.setlocale(locale.LC_NUMERIC, before)
    assert reported == expected


def test_threads_side_by_side_give_the_bits_of_single_runs(examples: Path) -> None:
    cases = ["paper.yaml", "rattle.yaml", "compliant-pair.yaml", "paper-rigid.yaml"]
    single = {case: bits(package.run(examples / case, SHORT)) for case in cases}
    wrong: list[str] = []

    def work(case: str) -> None:
        for _ in range(3):
            if bits(package.run(examples / case, SHORT)) != single[case]:
                wrong.append(case)

    threads = [threading.Thread(target=work, args=(case,)) for case in cases]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert wrong == []


def test_other_threads_go_on_during_a_call(examples: Path) -> None:
    ticks: list[int] = []
    ended = threading.Event()

    def tick() -> None:
        while not ended.wait(0.001):
            ticks.append(1)

    def tick_while(work: Callable[[], Any]) -> int:
        before = len(ticks)
        work()
        return len(ticks) - before

    thread = threading.Thread(target=tick)
    thread.start()
    try:
        counts = [tick_while(lambda: package.run(examples / "paper.yaml")) for _ in range(3)]
    finally:
        ended.set()
        thread.join()
    assert max(counts) > 1  # one may come before or after the call itself, not two


INTERRUPTED = """
import os, signal, threading, time, evolvent
def interrupt():
    time.sleep(0.3)
    os.kill(os.getpid(), signal.SIGINT)
evolvent.run(CASE, {"simulation.duration": 0.01})
before = signal.getsignal(signal.SIGINT)
for _ in range(2):
    threading.Thread(target=interrupt).start()
    begun = time.monotonic()
    try:
        evolvent.run(CASE, {"simulation.duration": 1e6})
    except KeyboardInterrupt:
        print("interrupted", time.monotonic() - begun < 20, threading.active_count() <= 2)
again = evolvent.run(CASE, {"simulation.duration": 0.01})
print(signal.getsignal(signal.SIGINT) is before, again.sizes["time"] > 1)
"""


def test_ctrl_c_ends_a_run_and_leaves_nothing(examples: Path, tmp_path: Path) -> None:
    program = INTERRUPTED.replace("CASE", repr(str(examples / "paper.yaml")))
    done = subprocess.run(
        [sys.executable, "-c", program],
        capture_output=True,
        text=True,
        cwd=tmp_path,
        timeout=50,
        check=False,
    )
    assert (done.stdout, done.stderr) == (2 * "interrupted True True\n" + "True True\n", "")
    assert done.returncode == 0
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize("error", [MemoryError("too little"), KeyboardInterrupt()])
def test_what_goes_wrong_in_the_thread_that_works_is_raised_by_who_called(
    error: BaseException,
) -> None:
    def work(stop: Any) -> None:
        assert threading.current_thread() is not threading.main_thread()
        raise error

    with pytest.raises(type(error)) as raised:
        waiting.call(work)
    assert raised.value is error


def test_a_library_of_another_version_is_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    binding.load.cache_clear()
    try:
        monkeypatch.setattr(binding, "__version__", "9.9.9")
        with pytest.raises(
            package.AnalysisError, match=r"is of version .*, this package of 9\.9\.9"
        ):
            binding.load()
        monkeypatch.setenv(binding.VARIABLE, "/no/such/library.so")
        with pytest.raises(package.AnalysisError, match=r"cannot be loaded .*EVOLVENT_LIBRARY"):
            binding.load()
    finally:
        binding.load.cache_clear()


def test_the_package_starts_without_the_library() -> None:
    program = (
        "import sys, evolvent; evolvent.run; print('numpy' in sys.modules, 'xarray' in sys.modules)"
    )
    done = subprocess.run(
        [sys.executable, "-c", program], capture_output=True, text=True, check=True
    )
    assert done.stdout == "False False\n"


# --- texts that are no text, and warnings


SURROGATES: dict[str, Callable[[Path, str], Any]] = {
    "a value to set": lambda case, text: package.show(case, {"title": text}),
    "a text to set": lambda case, text: package.show(case, [f"title={text}"]),
    "a path to set": lambda case, text: package.show(case, {f"wheels.{text}.width": 1}),
    "the path of a case": lambda _, text: package.show(f"{text}.yaml"),
    "the text of a case": lambda case, text: package.run(case.read_text() + f"# {text}\n"),
    "a case of mappings": lambda case, text: package.run(
        {**yaml.safe_load(case.read_text()), "title": text}
    ),
    "the key of a case": lambda case, text: package.run(
        {**yaml.safe_load(case.read_text()), text: 1}
    ),
    "a mesh": lambda case, text: package.static(case, mesh=text),
    "a torque": lambda case, text: package.static(case, torque=text),
    "a range": lambda case, text: package.respond(case, over=f"{text}=1:2"),
    "a direction": lambda case, text: package.respond(
        case, over="wheels.pinion.width=1:2", direction=text
    ),
    "a speed": lambda case, text: package.modes(case, at=text),
}


@pytest.mark.parametrize("what", SURROGATES)
@pytest.mark.parametrize("text", ["\ud800", "a\udfffb"])
def test_a_lone_surrogate_is_refused(examples: Path, what: str, text: str) -> None:
    """In whatever it stands: with the exit code of wrong usage, or of a case that is refused."""
    with pytest.raises(package.AnalysisError) as error:
        SURROGATES[what](examples / "paper.yaml", text)
    assert error.value.code in (2, 3)
    assert "\n" not in str(error.value)


def test_python_warns_of_what_the_program_warns_of(examples: Path) -> None:
    case, wide = examples / "spur-pair.yaml", {**SHORT, "wheels.pinion.width": 14}
    calls = (
        lambda: package.run(case, wide),
        lambda: package.respond(
            case, wide, over="wheels.pinion.loads.0.value=-50:-51:2", direction="up", periods=100
        ),
    )
    for call in calls:
        with pytest.warns(package.CaseWarning, match="width: 14 m is outside") as caught:
            warned = call()
        assert [str(warning.message) for warning in caught] == warned.attrs["warnings"].splitlines()
        assert {warning.filename for warning in caught} == {__file__}
    assert "14 m is outside" in package.show(case, wide)["warnings"][0]
