"""Contents of a history: as netCDF readers see it, and as docs/reference/result_format.md says."""

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
        assert set(history.sizes) == {"time", "wheel", "mesh", "pair", "axis", "space"}
        assert set(history.coords) == {"time", "wheel", "mesh", "pair", "axis", "space"}
        assert history.wheel.values.tolist() == ["pinion", "gear"]
        assert history.mesh.values.tolist() == ["pinion-gear"]
        assert history.pair.values.tolist() == ["drive_0"]
        assert history.axis.values.tolist() == ["x", "y"]
        assert history.space.values.tolist() == ["x", "y", "z"]
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
        # the grid is start + k * interval in floating point: at most one rounding error
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


def documented(text: str) -> dict[str, tuple[str, ...]]:
    """Variables and their dimensions in the tables of docs/reference/result_format.md."""
    rows = re.findall(r"^\| (`[^|]*) \| ([^|]*) \| [^|]* \|", text, re.MULTILINE)
    return {
        name: tuple(dims.split(", "))
        for names, dims in rows
        for name in re.findall(r"`(\w+)`", names)
    }


def test_the_documentation_lists_the_variables_that_a_history_has(
    evolvent: Evolvent, case: Path, tmp_path: Path, root: Path
) -> None:
    text = (root / "docs" / "reference" / "result_format.md").read_text()
    variables = text.split("## Variables")[1].split("## Tooth pairs")[0]
    events = text.split("## Group `events`")[1]
    evolvent("run", case, *SHORT)
    with xr.open_dataset(tmp_path / "paper.h5") as history:
        found = {str(name): variable.dims for name, variable in history.data_vars.items()}
    assert documented(variables) == found
    with xr.open_dataset(tmp_path / "paper.h5", group="events") as group:
        plain = {str(n): v.dims for n, v in group.data_vars.items() if v.dims == ("event",)}
    assert documented(events.split("## Attributes")[0]) == plain


def test_the_documentation_lists_what_coast_flanks_add(
    evolvent: Evolvent, case: Path, examples: Path, tmp_path: Path, root: Path
) -> None:
    text = (root / "docs" / "reference" / "result_format.md").read_text()
    evolvent("run", case, *SHORT)
    with xr.open_dataset(tmp_path / "paper.h5") as history:
        without = set(history.data_vars)
    evolvent("run", examples / "spur-pair.yaml", "--set", "simulation.duration=1e-3")
    with xr.open_dataset(tmp_path / "spur-pair.h5") as history:
        added = {str(n): v.dims for n, v in history.data_vars.items() if n not in without}
        slots = [f"{flank}_{slot}" for flank in ("drive", "coast") for slot in range(3)]
        assert history.pair.values.tolist() == slots
    assert documented(text.split("## Tooth pairs")[1].split("## Group")[0]) == added


def test_the_documentation_lists_what_a_moving_housing_adds(
    evolvent: Evolvent, case: Path, tmp_path: Path, root: Path
) -> None:
    text = (root / "docs" / "reference" / "result_format.md").read_text()
    evolvent("run", case, *SHORT)
    with xr.open_dataset(tmp_path / "paper.h5") as history:
        fixed = set(history.data_vars)
    body = "housing={kind: mounted, mass: 100, inertia: [9, 9, 9], accelerometers: "
    one = "{name: foot, point: [0, 1, 0], direction: [1, 0, 0]}"
    evolvent("run", case, *SHORT, "--set", f"{body}[{one}]}}")
    with xr.open_dataset(tmp_path / "paper.h5") as history:
        assert history.quaternion.values.tolist() == ["w", "x", "y", "z"]
        assert history.accelerometer.values.tolist() == ["foot"]
        added = {str(n): v.dims for n, v in history.data_vars.items() if n not in fixed}
    assert documented(text.split("## A housing that moves")[1].split("\n## ")[0]) == added


def test_the_documentation_lists_what_shafts_add(
    evolvent: Evolvent, case: Path, examples: Path, tmp_path: Path, root: Path
) -> None:
    text = (root / "docs" / "reference" / "result_format.md").read_text()
    for file in (case, examples / "two-stage.yaml"):
        assert evolvent("run", file, *SHORT).returncode == 0
    with (
        xr.open_dataset(tmp_path / "paper.h5") as without,
        xr.open_dataset(tmp_path / "two-stage.h5") as history,
    ):
        names = set(history.data_vars) - set(without.data_vars)
        added = {str(name): history[name].dims for name in names}
        assert history.shaft.values.tolist() == ["input", "middle", "output"]
    assert documented(text.split("## Shafts")[1].split("## A housing")[0]) == added


def test_the_documentation_lists_what_outputs_by_position_add(
    evolvent: Evolvent, case: Path, tmp_path: Path, root: Path
) -> None:
    text = (root / "docs" / "reference" / "result_format.md").read_text()
    section = text.split("## Outputs by position")[1].split("\n## ")[0]
    evolvent("run", case, *SHORT)
    with xr.open_dataset(tmp_path / "paper.h5") as history:
        plain = set(history.data_vars)
    before = set(attributes(tmp_path / "paper.h5"))
    output = "{per_turn: 500, wheel: gear}"
    start = "{kind: speeds, speeds: {pinion: -0.3, gear: 0.2}}"
    evolvent(
        "run", case, "--set", f"simulation={{duration: 1, output: {output}, initial: {start}}}"
    )
    with xr.open_dataset(tmp_path / "paper.h5") as history:
        added = {str(n): v.dims for n, v in history.data_vars.items() if n not in plain}
        assert history["output_kind"].dtype.kind == "i"
    assert documented(section) == added
    reported = set(attributes(tmp_path / "paper.h5")) - before
    assert reported == {"output_per", "output_number", "output_of"}
    assert all(f"`{name}`" in section for name in reported)


def test_the_documentation_lists_the_attributes_that_a_history_has(
    evolvent: Evolvent, case: Path, tmp_path: Path, root: Path
) -> None:
    text = (root / "docs" / "reference" / "result_format.md").read_text()
    table = text.split("## Attributes of the root")[1].split("## NAME.partial")[0]
    found: set[str] = set()
    for integrator in ("ida", "radau"):
        chosen = ("--set", f"simulation.integrator={integrator}")
        evolvent("run", case, *SHORT, "--set", "meshes.0.tracking=closed_form", *chosen)
        found |= set(attributes(tmp_path / "paper.h5"))
    more = ("simulation.initial={kind: periodic}", "simulation.metrics={from: 0}")
    words = [word for setting in more for word in ("--set", setting)]
    done = evolvent("run", root / "examples" / "spur-pair.yaml", "-o", "spur.h5", *words)
    assert done.returncode == 0, done.stderr
    found |= set(attributes(tmp_path / "spur.h5"))
    listed = {
        name
        for names in re.findall(r"^\| (`[^|]*) \|", table, re.MULTILINE)
        for name in re.findall(r"`(\w+)`", names)
    }
    assert listed == found | {"checkpoints"}  # of runs by IDA with checkpoints only
