"""What a history holds, as the readers of netCDF see it, and as docs/result_format.md tells it."""

from __future__ import annotations

import re
import subprocess
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
import xarray as xr

Evolvent = Callable[..., subprocess.CompletedProcess[str]]
ENGINES = ("h5netcdf", "netcdf4")
SHORT = ("--set", "simulation.duration=0.05")


@pytest.fixture
def case(examples: Path) -> Path:
    """The paper's case."""
    return examples / "paper.yaml"


def attributes(path: Path) -> dict[str, object]:
    """Root attributes of a history."""
    with xr.open_dataset(path, engine="h5netcdf") as history:
        return dict(history.attrs)


@pytest.mark.parametrize("engine", ENGINES)
def test_xarray_opens_a_history_with_named_coordinates_and_units(
    evolvent: Evolvent, case: Path, tmp_path: Path, engine: str
) -> None:
    evolvent("run", case, *SHORT)
    with xr.open_dataset(tmp_path / "paper.h5", engine=engine) as history:
        assert set(history.sizes) == {"time", "wheel", "mesh", "axis"}
        assert set(history.coords) == {"time", "wheel", "mesh", "axis"}
        assert history.wheel.values.tolist() == ["pinion", "gear"]
        assert history.mesh.values.tolist() == ["pinion-gear"]
        assert history.axis.values.tolist() == ["x", "y"]
        for variable in history.variables.values():
            assert {"units", "long_name", "symbol"} <= set(variable.attrs), variable
            missing = variable.encoding.get("_FillValue")
            if variable.dtype.kind == "f":
                assert missing is not None
                assert np.isnan(missing)
            else:
                assert missing is None
        assert history.penetration.dims == ("time", "mesh")
        assert history.centre_displacement.dims == ("time", "wheel", "axis")
        gear = history.angular_velocity.sel(wheel="gear")
        between = float(gear.interp(time=0.0205))
        neighbours = gear.sel(time=[0.020, 0.021], method="nearest").values
        assert between == pytest.approx(neighbours.mean(), rel=1e-12)  # linear interpolation


@pytest.mark.parametrize("engine", ENGINES)
def test_xarray_opens_the_events_with_names_for_their_kinds(
    evolvent: Evolvent, case: Path, tmp_path: Path, engine: str
) -> None:
    evolvent("run", case, "--set", "simulation.output_interval=0.1")
    with xr.open_dataset(tmp_path / "paper.h5", engine=engine, group="events") as events:
        assert events.side.values.tolist() == ["before", "after"]
        meanings = events.kind.attrs["flag_meanings"].split()
        assert np.atleast_1d(events.kind.attrs["flag_values"]).tolist() == list(
            range(len(meanings))
        )
        kinds = [meanings[kind] for kind in events.kind.values]
        assert "tooth_switch" in kinds
        assert np.all(np.diff(events.time) >= 0.0)
        states = [name for name, v in events.data_vars.items() if v.dims == ("event", "side")]
        assert states
        for variable in events.variables.values():
            assert {"units", "long_name", "symbol"} <= set(variable.attrs), variable


@pytest.mark.parametrize("engine", ENGINES)
def test_a_run_without_events_has_an_empty_group_of_them(
    evolvent: Evolvent, case: Path, tmp_path: Path, engine: str
) -> None:
    still = ("--set", "simulation.duration=1e-5", "--set", "simulation.output_interval=1e-6")
    assert evolvent("run", case, *still).returncode == 0
    with xr.open_dataset(tmp_path / "paper.h5", engine=engine, group="events") as events:
        events.load()
        assert events.sizes == {"event": 0, "side": 2}


def test_the_grid_of_outputs_starts_at_0_and_ends_at_the_end(
    evolvent: Evolvent, case: Path, tmp_path: Path
) -> None:
    step, end = 0.003, 0.05
    grid = ("--set", f"simulation.output_interval={step}", "--set", f"simulation.duration={end}")
    evolvent("run", case, *grid)
    with xr.open_dataset(tmp_path / "paper.h5") as history:
        expected = [*(step * k for k in range(17)), end]
        # the grid is start + k * interval in floating point: at most one rounding apart
        np.testing.assert_allclose(history.time, expected, rtol=1e-15, atol=0.0)


def test_the_attributes_tell_how_the_history_came_about(
    evolvent: Evolvent, case: Path, tmp_path: Path
) -> None:
    evolvent("run", case, *SHORT, "--set", "wheels.gear.teeth=31")
    found = attributes(tmp_path / "paper.h5")
    assert str(found["Conventions"]).startswith("CF-")
    assert found["evolvent_format"] == 1
    assert (found["status"], found["status_message"]) == ("done", "")
    assert str(found["title"]) in case.read_text()
    assert int(str(found["integrator_steps"])) > 0
    for library in ("evolvent", "SUNDIALS", "HDF5"):
        assert re.search(rf"\b{library} \d+\.\d+", str(found["versions"]))


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
    assert target[-50:] in last  # the beginning of a long path is left out
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


# ---- what ends early stays readable under another name -------------------------------------------


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
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
    """Run a command where `folder` is a file system of its own; skip if that is forbidden here."""
    unshare = (
        ["unshare", "--mount"] if os.geteuid() == 0 else ["unshare", "--mount", "--map-root-user"]
    )
    script = f'mount -t tmpfs -o {options} none "$0" || exit 99; "$@"; code=$?; ls "$0"; exit $code'
    if shutil.which("unshare") is None:
        pytest.skip("needs unshare (util-linux) for a file system of its own")
    result = subprocess.run(
        [*unshare, "bash", "-c", script, str(folder), *command],
        capture_output=True,
        text=True,
        timeout=60,
        check=False,
    )
    if result.returncode in (1, 99) and ("unshare:" in result.stderr or "mount:" in result.stderr):
        pytest.skip(f"this system mounts nothing for a test: {result.stderr.splitlines()[0]}")
    return result


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


# ---- the description of the format ---------------------------------------------------------------


def documented(text: str) -> dict[str, tuple[str, ...]]:
    """Variables and their dimensions in the tables of docs/result_format.md."""
    rows = re.findall(r"^\| (`[^|]*) \| ([^|]*) \| [^|]* \|", text, re.MULTILINE)
    return {
        name: tuple(dims.split(", "))
        for names, dims in rows
        for name in re.findall(r"`(\w+)`", names)
    }


def test_the_documentation_lists_the_variables_that_a_history_has(
    evolvent: Evolvent, case: Path, tmp_path: Path, root: Path
) -> None:
    text = (root / "docs" / "result_format.md").read_text()
    variables, events = text.split("## Variables")[1].split("## Group `events`")
    evolvent("run", case, *SHORT)
    with xr.open_dataset(tmp_path / "paper.h5") as history:
        found = {str(name): variable.dims for name, variable in history.data_vars.items()}
    assert documented(variables) == found
    with xr.open_dataset(tmp_path / "paper.h5", group="events") as group:
        plain = {str(n): v.dims for n, v in group.data_vars.items() if v.dims == ("event",)}
    assert documented(events.split("## Attributes")[0]) == plain


def test_the_documentation_lists_the_attributes_that_a_history_has(
    evolvent: Evolvent, case: Path, tmp_path: Path, root: Path
) -> None:
    text = (root / "docs" / "result_format.md").read_text()
    table = text.split("## Attributes of the root")[1].split("## NAME.partial")[0]
    evolvent("run", case, *SHORT)
    listed = {
        name
        for names in re.findall(r"^\| (`[^|]*) \|", table, re.MULTILINE)
        for name in re.findall(r"`(\w+)`", names)
    }
    assert listed == set(attributes(tmp_path / "paper.h5"))
