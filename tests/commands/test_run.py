"""A run from case to history: its files, also after a failure."""

from __future__ import annotations

import os
import pty
import re
import signal
import subprocess
import time
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
import xarray as xr

import machine
from processes import running, wait_for

Evolvent = Callable[..., subprocess.CompletedProcess[str]]
SHORT = ("--set", "simulation.duration=0.05")
ENDLESS = ("--set", "simulation.duration=1e5", "--set", "simulation.output_interval=0.01")
# beyond the limit (15) of the Johnson force, about 1e9 N for this pair
OVERLOAD = ("--set", "wheels.pinion.loads.0.value=-1e9")


@pytest.fixture
def case(examples: Path) -> Path:
    """The paper's case."""
    return examples / "paper.yaml"


def names(folder: Path) -> list[str]:
    """Contents of a folder."""
    return sorted(path.name for path in folder.iterdir())


def attributes(path: Path) -> dict[str, object]:
    """Root attributes of a history."""
    with xr.open_dataset(path, engine="h5netcdf") as history:
        return dict(history.attrs)


# ---- files of a complete run ---------------------------------------------------------------------


def test_a_history_is_named_after_its_case_and_nothing_else_is_left(
    evolvent: Evolvent, case: Path, tmp_path: Path
) -> None:
    result = evolvent("run", case, *SHORT)
    assert result.returncode == 0, result.stderr
    assert result.stdout == ""
    assert names(tmp_path) == ["paper.h5"]


def test_the_summary_is_one_line_on_stderr(evolvent: Evolvent, case: Path) -> None:
    *others, mesh, summary = evolvent("run", case, *SHORT).stderr.splitlines()
    assert re.fullmatch(r"evolvent: \d+ steps, \d+ events?, \S+ s CPU: paper\.h5", summary)
    assert mesh == (
        "evolvent: mesh pinion-gear at 5.0434 N, one tooth pair: natural frequency 1145.5 Hz,"
        " damping ratio 0.0201"
    )
    assert all(line.startswith("evolvent: warning: ") for line in others)


def test_quiet_leaves_only_warnings(evolvent: Evolvent, case: Path) -> None:
    loud = evolvent("run", case, *SHORT).stderr.splitlines()
    quiet = evolvent("run", case, *SHORT, "-q").stderr.splitlines()
    assert quiet == [line for line in loud if line.startswith("evolvent: warning: ")]


def test_the_case_inside_a_history_runs_again_to_the_same_data(
    evolvent: Evolvent, case: Path, tmp_path: Path
) -> None:
    evolvent("run", case, *SHORT, "--set", "wheels.gear.teeth=31")
    (tmp_path / "again.yaml").write_text(str(attributes(tmp_path / "paper.h5")["case"]))
    assert evolvent("run", "again.yaml").returncode == 0
    with (
        xr.open_dataset(tmp_path / "paper.h5") as first,
        xr.open_dataset(tmp_path / "again.h5") as second,
    ):
        assert first.identical(second)


def test_the_same_case_gives_the_same_file_to_the_byte(
    evolvent: Evolvent, case: Path, tmp_path: Path
) -> None:
    evolvent("run", case, *SHORT, "-o", "a.h5")
    evolvent("run", case, *SHORT, "-o", "b.h5")
    assert (tmp_path / "a.h5").read_bytes() == (tmp_path / "b.h5").read_bytes()


def test_a_run_that_loses_contact_for_good_says_so(
    evolvent: Evolvent, case: Path, tmp_path: Path
) -> None:
    apart = ("--set", "wheels.pinion.loads.0.value=1", *SHORT)
    result = evolvent("run", case, *apart)
    assert result.returncode == 0, result.stderr
    said = r"(mesh 'pinion-gear' lost contact at t = \S+ s and did not regain it"
    said += r"|the flanks of mesh 'pinion-gear' never touched)"
    assert re.search(f"evolvent: warning: {said}", result.stderr)
    assert re.search(said, str(attributes(tmp_path / "paper.h5")["status_message"]))


# ---- on a terminal -------------------------------------------------------------------------------


def test_progress_appears_on_a_terminal_and_is_wiped_at_the_end(
    executable: Path, case: Path, tmp_path: Path
) -> None:
    ours, theirs = pty.openpty()
    with subprocess.Popen(
        [str(executable), "run", str(case), *ENDLESS], cwd=tmp_path, stderr=theirs
    ) as process:
        os.close(theirs)
        text = os.read(ours, 4096)
        while text.count(b"%") < 2:
            text += os.read(ours, 4096)
        process.send_signal(signal.SIGINT)
        assert process.wait(timeout=60) == 75
    while not text.endswith(b"\n"):
        text += os.read(ours, 65536)
    os.close(ours)
    assert re.search(rb"\r *\d+\.\d %  t = \S+ of 1e\+05 s, \S+ s per s, \S+( h)? left", text)
    assert re.search(rb"\r\x1b\[K[^\r]*interrupted by SIGINT", text)


LINE = re.compile(
    r"evolvent: (\d{4}-\d\d-\d\d \d\d:\d\d:\d\d)  +(\S+) %  t = (\S+) of 1e\+05 s, \S+ s per s, "
    r"(\d+:\d\d|\d+\.\d h) left"
)


def lines_of_an_interrupted_run(
    executable: Path, case: Path, folder: Path, *words: str
) -> list[str]:
    """Lines of an endless run in a log with frequent output."""
    log = folder / "log"
    often = {**os.environ, "EVOLVENT_PROGRESS_INTERVAL": "0.01"}
    command = [executable, "run", case, *ENDLESS, *words]
    partial = folder / "paper.h5.partial"
    with log.open("w") as stderr, running(command, folder, stderr=stderr, env=often) as process:
        wait_for(lambda: log.read_text().count(" % ") > 2 or ("-q" in words and partial.exists()))
        process.send_signal(signal.SIGINT)
    assert process.returncode == 75
    return log.read_text().splitlines()


def test_a_log_gets_lines_with_the_time_of_how_far_a_run_is(
    executable: Path, case: Path, tmp_path: Path
) -> None:
    lines = lines_of_an_interrupted_run(executable, case, tmp_path)
    found = [match for match in map(LINE.fullmatch, lines) if match]
    assert len(found) > 2
    assert len(found) == sum(" % " in line for line in lines)
    times = [float(match[3]) for match in found]
    assert times == sorted(times)
    for match in found:  # the share is printed with one decimal
        assert float(match[2]) == pytest.approx(1e-3 * float(match[3]), abs=0.05)
        time.strptime(match[1], "%Y-%m-%d %H:%M:%S")
    assert not any("\r" in line or "\x1b" in line for line in lines)


def test_a_quiet_run_keeps_the_log_empty(executable: Path, case: Path, tmp_path: Path) -> None:
    (line,) = lines_of_an_interrupted_run(executable, case, tmp_path, "-q")
    assert "interrupted by SIGINT" in line


@pytest.mark.parametrize("interval", [None, "", "often", "0", "-1", "inf"])
def test_a_run_below_a_minute_says_nothing_of_how_far_it_is(
    evolvent: Evolvent, case: Path, interval: str | None
) -> None:
    """Also if the variable is not a number of seconds."""
    more = {} if interval is None else {"EVOLVENT_PROGRESS_INTERVAL": interval}
    result = evolvent("run", case, "--set", "simulation.duration=20", env={**os.environ, **more})
    assert result.returncode == 0
    assert " % " not in result.stderr


# ---- rejected runs leave no file -----------------------------------------------------------------


@pytest.mark.parametrize(
    ("target", "reason"),
    [
        ("missing/x.h5", "No such file or directory; create the folder"),
        ("folder", "Is a directory; name a file"),
        ("file/x.h5", "Not a directory"),
        ("/dev/null", "not a regular file"),
        ("x" * 300, "File name too long"),
    ],
)
def test_an_impossible_output_is_refused_with_its_reason(
    evolvent: Evolvent, case: Path, tmp_path: Path, target: str, reason: str
) -> None:
    (tmp_path / "folder").mkdir()
    (tmp_path / "file").touch()
    result = evolvent("run", case, *SHORT, "-q", "-o", target)
    assert result.returncode == 74
    last = result.stderr.splitlines()[-1]
    assert last.startswith("evolvent: cannot write '")
    assert target[-50:] in last  # the start of a long path is omitted
    assert reason in last
    assert names(tmp_path) == ["file", "folder"]


def test_the_case_itself_is_never_overwritten(
    evolvent: Evolvent, case: Path, tmp_path: Path
) -> None:
    mine = tmp_path / "mine.h5"
    mine.write_text(case.read_text())
    for words in (["run", "mine.h5"], ["run", "mine.h5", "-o", "./mine.h5"]):
        result = evolvent(*words)
        assert result.returncode == 2
        assert "would replace the case" in result.stderr
    assert mine.read_text() == case.read_text()
    assert names(tmp_path) == ["mine.h5"]


def test_a_bad_case_leaves_an_older_history_alone(
    evolvent: Evolvent, case: Path, tmp_path: Path
) -> None:
    (tmp_path / "paper.h5").write_text("older")
    result = evolvent("run", case, "--set", "wheels.pinion.width=-1")
    assert result.returncode == 3
    assert len(result.stderr.splitlines()) == 1
    assert names(tmp_path) == ["paper.h5"]
    assert (tmp_path / "paper.h5").read_text() == "older"


def test_two_runs_do_not_write_the_same_file(
    evolvent: Evolvent, executable: Path, case: Path, tmp_path: Path
) -> None:
    partial = tmp_path / "paper.h5.partial"
    with subprocess.Popen([str(executable), "run", "-q", str(case), *ENDLESS], cwd=tmp_path) as one:
        wait_for(lambda: partial.exists() and partial.stat().st_size > 100_000)
        other = evolvent("run", "-q", case, *SHORT)
        one.terminate()
        assert one.wait(timeout=60) == 75
    assert other.returncode == 74
    assert "another run is writing it" in other.stderr
    assert attributes(partial)["status"] == "interrupted"


# ---- incomplete runs stay readable under another name --------------------------------------------


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM, signal.SIGUSR1])
def test_an_interrupted_run_leaves_what_it_has_and_says_why(
    executable: Path, case: Path, tmp_path: Path, number: signal.Signals
) -> None:
    (tmp_path / "paper.h5").write_text("older")
    partial = tmp_path / "paper.h5.partial"
    with subprocess.Popen(
        [str(executable), "run", "-q", str(case), *ENDLESS],
        cwd=tmp_path,
        stderr=subprocess.PIPE,
        text=True,
    ) as process:
        wait_for(lambda: partial.exists() and partial.stat().st_size > 100_000)
        process.send_signal(number)
        _, message = process.communicate(timeout=60)
    assert process.returncode == 75
    match = re.search(
        rf"t = (\S+) s: interrupted by {number.name}; .*'paper\.h5\.partial'", message
    )
    assert match
    with xr.open_dataset(partial) as history:
        assert history.attrs["status"] == "interrupted"
        assert (
            f"interrupted by {number.name} at t = {match[1]} s" in history.attrs["status_message"]
        )
        assert history.time[-1] == pytest.approx(float(match[1]), rel=1e-8)  # printed with 9 digits
        assert np.all(np.diff(history.time) > 0.0)
        assert np.all(np.isfinite(history.angular_velocity))
    assert (tmp_path / "paper.h5").read_text() == "older"


@pytest.mark.parametrize("engine", ["h5netcdf", "netcdf4"])
def test_a_killed_run_leaves_whole_rows_that_readers_of_netcdf_open(
    executable: Path, case: Path, tmp_path: Path, engine: str
) -> None:
    partial = tmp_path / "paper.h5.partial"
    with running([executable, "run", "-q", case, *ENDLESS], tmp_path) as process:
        wait_for(lambda: partial.exists() and partial.stat().st_size > 0)
        process.kill()
    with xr.open_dataset(partial, engine=engine) as history:
        history.load()
        assert history.attrs["status"] == "running"
        assert history.sizes["time"] > 1
        assert np.all(np.diff(history.time) > 0.0)
        assert np.all(np.isfinite(history.angular_velocity))
        assert history.wheel.values.tolist() == ["pinion", "gear"]
    with xr.open_dataset(partial, engine=engine, group="events") as events:
        assert np.all(np.isfinite(events.load().time))


def test_a_failed_run_names_time_value_and_limit_and_keeps_the_history_up_to_there(
    evolvent: Evolvent, case: Path, tmp_path: Path
) -> None:
    (tmp_path / "paper.h5").write_text("older")
    result = evolvent("run", "-q", case, *OVERLOAD, timeout=30)
    assert result.returncode == 4
    last = result.stderr.splitlines()[-1]
    match = re.search(r"paper\.yaml: t = (\S+) s: (.*); .* 'paper\.h5\.partial'", last)
    assert match
    assert len(re.findall(r"\d+\.?\d*(?:[eE][-+]?\d+)? m\b", match[2])) >= 2  # value and limit
    with xr.open_dataset(tmp_path / "paper.h5.partial") as history:
        history.load()
        assert history.attrs["status"] == "failed"
        assert match[2] in history.attrs["status_message"]
        assert history.sizes["time"] > 0
        assert history.time[-1] <= float(match[1]) * (1.0 + 1e-8)  # printed with 9 digits
    assert (tmp_path / "paper.h5").read_text() == "older"


def test_a_contact_that_is_thrown_below_a_base_circle_is_named_though_no_step_is_left(
    evolvent: Evolvent, examples: Path
) -> None:
    """The trial states approach the last valid one until no time step remains."""
    start = "{kind: speeds, speeds: {pinion: -1, gear: 0.6667}, gaps: {pinion-gear: -0.01}}"
    run = evolvent("run", examples / "paper.yaml", "--set", f"simulation.initial={start}")
    assert run.returncode == 4
    assert "mesh 'pinion-gear': the contact has left the involute" in run.stderr


def test_a_complete_run_replaces_an_older_history_and_a_partial_one(
    evolvent: Evolvent, case: Path, tmp_path: Path
) -> None:
    (tmp_path / "paper.h5").write_text("older")
    (tmp_path / "paper.h5.partial").write_text("of a killed run")
    assert evolvent("run", case, *SHORT).returncode == 0
    assert names(tmp_path) == ["paper.h5"]
    assert attributes(tmp_path / "paper.h5")["status"] == "done"


# ---- disks ---------------------------------------------------------------------------------------


@pytest.mark.parametrize("kilobytes", [0, 4, 100, 1000])
def test_a_write_that_fails_exits_with_74_and_keeps_the_older_history(
    executable: Path, case: Path, tmp_path: Path, kilobytes: int
) -> None:
    (tmp_path / "paper.h5").write_text("older")
    limited = f'ulimit -f {kilobytes}; exec "$@"'  # bash counts in blocks of 1 kB
    result = subprocess.run(
        ["bash", "-c", limited, "bash", str(executable), "run", "-q", str(case)],
        cwd=tmp_path,
        capture_output=True,
        text=True,
        timeout=60,
        check=False,
    )
    assert result.returncode == 74
    last = result.stderr.splitlines()[-1]
    assert "cannot write 'paper.h5.partial': File too large; raise the limit" in last
    assert (tmp_path / "paper.h5").read_text() == "older"


def in_own_mount(options: str, folder: Path, *command: str) -> subprocess.CompletedProcess[str]:
    """Run a command with `folder` as a separate file system, and list that folder."""
    script = f'mount -t tmpfs -o {options} none "$0" || exit 99; "$@"; code=$?; ls "$0"; exit $code'
    return machine.with_mounts([script, folder, *command], folder)


def test_a_full_disk_exits_with_74_and_leaves_no_history(
    executable: Path, case: Path, tmp_path: Path
) -> None:
    output = tmp_path / "x.h5"
    command = (str(executable), "run", "-q", str(case), "-o", str(output))
    result = in_own_mount("size=256k", tmp_path, *command)
    assert result.returncode == 74
    assert "No space left on device; free some space" in result.stderr.splitlines()[-1]
    assert result.stdout.split() == ["x.h5.partial"]


def test_a_read_only_folder_exits_with_74(executable: Path, case: Path, tmp_path: Path) -> None:
    output = tmp_path / "x.h5"
    command = (str(executable), "run", "-q", str(case), "-o", str(output))
    result = in_own_mount("ro", tmp_path, *command)
    assert result.returncode == 74
    assert "Read-only file system; write to a folder" in result.stderr.splitlines()[-1]
    assert result.stdout == ""
