"""A result in memory is that of the program's file: every variable, every attribute."""

from __future__ import annotations

import copy
import pickle
import re
from collections.abc import Callable
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
import xarray as xr
import yaml

import evolvent as package
from evolvent.history import STATIC, open_result
from evolvent.library import layouts, records
from evolvent.library.cases import value_text
from example_cases import CASES

SHORT = {"simulation.duration": 0.06}
INTEGRATORS = {
    "radau": {"simulation.integrator": "radau"},
    "ida": {"simulation.integrator": "ida"},
}
BY_FILE = {"versions"}  # of the file with that of HDF5


def options(settings: dict[str, Any]) -> list[str]:
    """The same for the program."""
    return [
        word for key, value in settings.items() for word in ("--set", f"{key}={value_text(value)}")
    ]


def bytes_of(variable: xr.Variable) -> bytes:
    """Values with their type; texts of any width."""
    values = variable.values
    return repr(values.tolist()).encode() if values.dtype.kind in "UO" else values.tobytes()


def kind_of(variable: xr.Variable) -> str:
    """Texts are objects in older versions of xarray."""
    return "text" if variable.dtype.kind in "UO" else str(variable.dtype)


def assert_same(memory: xr.Dataset, file: xr.Dataset) -> None:
    assert list(memory.variables) == list(file.variables)
    assert dict(memory.sizes) == dict(file.sizes)
    assert set(memory.coords) == set(file.coords)
    for name, expected in file.variables.items():
        got = memory.variables[name]
        assert got.dims == expected.dims, name
        assert kind_of(got) == kind_of(expected), name
        assert bytes_of(got) == bytes_of(expected), name
        assert got.attrs.keys() == expected.attrs.keys(), name
        for key, value in expected.attrs.items():
            np.testing.assert_array_equal(got.attrs[key], value, str(name), strict=True)
    assert memory.attrs.keys() == file.attrs.keys()
    for key in file.attrs.keys() - BY_FILE:
        assert type(memory.attrs[key]) is type(file.attrs[key]), key
        assert memory.attrs[key] == file.attrs[key], key


def versions_without_hdf5(text: str) -> str:
    return ", ".join(part for part in text.split(", ") if not part.startswith("HDF5"))


@pytest.mark.parametrize("integrator", INTEGRATORS)
@pytest.mark.parametrize("case", CASES, ids=lambda path: path.stem)
def test_a_run_in_memory_is_the_program_s_history(
    evolvent: Callable[..., Any], tmp_path: Path, case: Path, integrator: str
) -> None:
    settings = SHORT | INTEGRATORS[integrator]
    done = evolvent("run", case, "-q", "-o", "h.h5", *options(settings))
    if done.returncode != 0:  # radau does not serve them all, nor is there a turn in each
        with pytest.raises(package.AnalysisError) as refused:
            package.run(case, settings)
        assert done.stderr.partition("; the history up to there is in")[0].rstrip() == str(
            refused.value
        )
        assert refused.value.code == done.returncode
        assert integrator == "radau" or "metrics contains no whole revolution" in done.stderr
        return
    memory = package.run(case, settings)
    with package.open_history(tmp_path / "h.h5") as file:
        assert_same(memory, file)
        assert memory.attrs["versions"] == versions_without_hdf5(file.attrs["versions"])
    with package.open_events(tmp_path / "h.h5") as file:
        assert_same(package.open_events(memory), file)


def test_numbers_outputs_and_positions_are_those_of_the_file(
    evolvent: Callable[..., Any], tmp_path: Path, examples: Path
) -> None:
    case = examples / "spur-pair.yaml"
    settings = {
        "simulation": {
            "duration": 0.05,
            "output": {"per_pitch": 128, "mesh": "pinion-gear"},
            "initial": {"kind": "steady"},
            "metrics": {"from": 0.02, "to": 0.05},
            "outputs": "energies transmission_error",
        }
    }
    done = evolvent("run", case, "-q", "-o", "h.h5", *options(settings))
    assert done.returncode == 0, done.stderr
    with package.open_history(tmp_path / "h.h5") as file:
        assert "harmonic" in file.sizes
        assert_same(package.run(case, settings), file)


@pytest.mark.parametrize("request_", [{}, {"torque": (10, 100, 3), "points": 60, "speed": 30.0}])
def test_a_static_analysis_in_memory_is_the_program_s_file(
    evolvent: Callable[..., Any], tmp_path: Path, examples: Path, request_: dict[str, Any]
) -> None:
    case = examples / "compliant-pair.yaml"
    words = ["--torque", "10:100:3", "--points", "60", "--speed", "30"] if request_ else []
    assert evolvent("static", case, "-q", "-o", "s.h5", *words).returncode == 0
    with open_result(tmp_path / "s.h5", STATIC) as file:
        assert_same(package.static(case, **request_), file)


def test_a_result_outlives_its_record(examples: Path) -> None:
    gap = package.run(examples / "paper.yaml", SHORT)["gap"].values
    others = [package.run(examples / "rattle.yaml", SHORT)["gap"].values for _ in range(3)]
    again = package.run(examples / "paper.yaml", SHORT)["gap"].values
    assert gap.tobytes() == again.tobytes()
    assert len({one.tobytes() for one in others}) == 1


def test_a_record_is_freed_once_with_its_last_array(monkeypatch: pytest.MonkeyPatch) -> None:
    freed: list[int] = []
    monkeypatch.setattr(records, "load", lambda: SimpleNamespace(evolvent_record_free=freed.append))
    record, numbers = records.Record(7), np.arange(3.0)
    values = records._Values(record).array(numbers.ctypes.data, (3,), "<f8")
    part = values[1:]
    del record, values
    assert (freed, part.tolist()) == ([], [1.0, 2.0])
    del part
    assert freed == [7]


def test_a_result_can_be_copied_sent_and_written(examples: Path, tmp_path: Path) -> None:
    history = package.run(examples / "rattle.yaml", SHORT)
    events = package.open_events(history)
    assert events.sizes["event"] > 0
    for other in (
        pickle.loads(pickle.dumps(history)),
        copy.deepcopy(history),
        history.copy(deep=True),
    ):
        assert other.identical(history)
        assert package.open_events(other).identical(events)
    history.to_netcdf(tmp_path / "h.h5", engine="h5netcdf")
    with package.open_history(tmp_path / "h.h5") as file:
        assert_same(history, file)


def test_a_dataset_without_events_says_so() -> None:
    with pytest.raises(package.HistoryError, match="contains no events; give the path"):
        package.open_events(xr.Dataset())


@pytest.mark.parametrize("case", ["paper.yaml", "two-stage-gears.yaml"])
def test_a_dataset_is_what_the_constructor_of_xarray_makes(
    examples: Path, case: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    def made() -> list[xr.Dataset]:
        history = package.run(examples / case, SHORT)
        return [history, package.open_events(history)]

    assert layouts._is_made_of_four()  # else this version of xarray is served, but slowly
    quick = made()
    with monkeypatch.context() as patch:
        patch.setattr(records, "_inner", lambda: xr.Dataset.no_such_procedure)
        patch.setattr(layouts, "_is_made_of_four", lambda: False)
        public = made()
    for ours, other in zip(quick, public, strict=True):
        parts, coordinates = (
            {name: one.variable for name, one in some.items()}
            for some in (ours.data_vars, ours.coords)
        )
        rebuilt = xr.Dataset(parts, coordinates, ours.attrs)
        for expected in (other, rebuilt):
            assert ours.identical(expected)
            assert list(ours.variables) == list(expected.variables)
            assert dict(ours.sizes) == dict(expected.sizes)
            assert ours.indexes.keys() == expected.indexes.keys()
            for name, index in expected.indexes.items():
                assert ours.indexes[name].identical(index), name
    some = {"wheel": quick[0].wheel.values[-1]}
    assert quick[0].sel(some).identical(public[0].sel(some))


def test_who_changes_a_result_changes_no_other(examples: Path) -> None:
    first, other = (package.run(examples / "paper.yaml", SHORT) for _ in range(2))
    expected = other.copy(deep=True)  # what is shared would change in a third result, too
    for variable in first.variables.values():
        variable.attrs["units"] = "changed"
        variable.attrs["more"] = 1
    first["normal_force"].values[:] = 0
    first = first.assign_coords(wheel=["a", "b"]).drop_vars("mesh")
    assert other.identical(expected)
    assert package.run(examples / "paper.yaml", SHORT).identical(expected)


def test_a_result_is_the_same_whatever_results_came_before(examples: Path) -> None:
    text = (examples / "two-stage-gears.yaml").read_text(encoding="utf-8")
    wheel = yaml.safe_load(text)["wheels"][0]["name"]
    renamed = re.sub(rf"\b{wheel}\b", "renamed", text)

    def made(alone: bool) -> list[xr.Dataset]:
        results = []
        for case in (text, renamed):
            for more in ({}, {"simulation.duration": 0.03}, {"simulation.outputs": "energies"}):
                if alone:
                    layouts._cache.clear()
                history = package.run(case, {**SHORT, **more})
                results += [history, package.open_events(history)]
        return results

    made(alone=False)
    after = made(alone=False)
    assert len(layouts._cache) >= 4
    for one, other in zip(after, made(alone=True), strict=True):
        assert one.identical(other)
    assert ("renamed" in after[0].wheel, "renamed" in after[6].wheel) == (False, True)
