"""What is said of a history does not depend on the parts in which it is read."""

from __future__ import annotations

import subprocess
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest
import xarray as xr

from evolvent.figures import long_histories
from evolvent.figures.table import FIGURES, Run
from evolvent.history import open_events, open_history, open_recording, rows_between
from evolvent.history import recording as module
from evolvent.history.recording import integral, recording_of
from evolvent.pages import explorer as pages
from evolvent.pages.explorer import explorer
from evolvent.physics.extremes import extremes
from evolvent.physics.invariants import check_history
from evolvent.physics.mesh_summary import mesh_summaries
from evolvent.physics.results import results
from evolvent.physics.teeth import pitches_passed
from evolvent.physics.thinning import thinned, thinned_lines

# Tracked points, rigid contact, lost contact, several tooth pairs, shafts and meshes.
CASES = ["paper-friction", "paper-rigid-friction", "rattle", "two-stage-gears", "motor-driven"]
OUTPUTS = 60
LENGTHS = [1, 7, OUTPUTS + 1]


@pytest.fixture(scope="module", params=CASES)
def path(
    request: pytest.FixtureRequest,
    executable: Path,
    examples: Path,
    tmp_path_factory: pytest.TempPathFactory,
) -> Path:
    """A short history of an example, with few outputs."""
    file = tmp_path_factory.mktemp("parts") / f"{request.param}.h5"
    short = ("simulation.duration=0.006", f"simulation.output_interval={0.006 / OUTPUTS}")
    words = [word for one in short for word in ("--set", one)]
    case = examples / f"{request.param}.yaml"
    command = [executable, "run", case, "-o", file, "-q", *words]
    done = subprocess.run(command, capture_output=True, text=True, timeout=60, check=False)
    assert done.returncode == 0, done.stderr
    return file


@pytest.fixture(scope="module")
def history(path: Path) -> Iterator[xr.Dataset]:
    with open_history(path) as opened:
        yield opened.load()


def test_invariants_have_the_same_outcome_whatever_the_length_of_a_part(
    path: Path, history: xr.Dataset
) -> None:
    reported = check_history(history)
    assert sum(v.verdict == "pass" for v in reported) >= 6
    for length in LENGTHS:
        with open_recording(path) as run:
            run.block = length
            assert check_history(run) == reported


@pytest.mark.parametrize("outputs", [0, 1, 2])
def test_a_history_of_hardly_any_output_is_checked_as_well(
    history: xr.Dataset, outputs: int
) -> None:
    verdicts = check_history(history.isel(time=slice(0, outputs)))
    assert not [v for v in verdicts if v.failed]


def test_results_are_the_same_whatever_the_length_of_a_part(
    history: xr.Dataset, monkeypatch: pytest.MonkeyPatch
) -> None:
    untold = history.drop_vars([name for name in history.data_vars if "_max" in str(name)])

    def reported() -> list[object]:
        found = [(e.output, e.is_largest, e.value.values, e.time.values) for e in extremes(untold)]
        return [
            results(history),
            results(untold),
            mesh_summaries(history),
            [str(one) for one in found],
            pitches_passed(history).tolist(),
        ]

    whole = reported()
    row = recording_of(history)._row_bytes()
    for length in LENGTHS:
        monkeypatch.setattr(module, "AT_ONCE", length * row)
        assert recording_of(history).block == length
        assert reported() == whole


def test_an_integral_is_that_of_the_trapezoidal_rule(history: xr.Dataset) -> None:
    for name in ("angular_velocity", "normal_force"):
        run = recording_of(history)
        run.block = 7
        whole = history[name].integrate("time").transpose(*history[name].dims[1:]).values
        found = integral(run, lambda part, name=name: part[name])
        # a sum of so many numbers, in another order
        np.testing.assert_allclose(found, whole, rtol=OUTPUTS * np.finfo(float).eps)


def test_parts_between_two_times_are_those_of_xarray(history: xr.Dataset) -> None:
    run = recording_of(history).between(0.001, 0.002)
    chosen = history.sel(time=slice(0.001, 0.002))
    assert run.n == chosen.sizes["time"] > 0
    np.testing.assert_array_equal(run["angle"], chosen["angle"])
    short = recording_of(history).between(0.001, 0.002)
    short.block = 3
    rows = np.concatenate([part["angle"] for part in short.parts()])
    np.testing.assert_array_equal(rows, chosen["angle"])
    assert history.isel(time=rows_between(history, 0.001, 0.002)).identical(chosen)


def random_history(rng: np.random.Generator, n: int) -> xr.Dataset:
    values = rng.normal(size=(n, 2, 3))
    values[rng.random((n, 2, 3)) < 0.1] = np.nan
    values[:, 0, 0] = rng.integers(0, 3, n)
    values[:, 1, 1] = np.nan
    times = {"time": np.arange(n, dtype=float)}
    return xr.Dataset({"load": (("time", "mesh", "pair"), values)}, coords=times)


@pytest.mark.parametrize("most", [8, 30, 1000])
@pytest.mark.parametrize("length", [1, 7, 500])
def test_lines_that_are_thinned_in_parts_keep_the_rows_of_whole_ones(
    most: int, length: int
) -> None:
    history = random_history(np.random.default_rng(3), 437)
    run = recording_of(history)
    run.block = length
    lines = history["load"].values.reshape(437, -1).T
    for line, rows in zip(lines, thinned_lines(run, "load", most), strict=True):
        np.testing.assert_array_equal(rows, thinned(line, most))


def test_a_picture_of_a_long_history_reaches_what_the_history_reaches(
    path: Path, history: xr.Dataset, monkeypatch: pytest.MonkeyPatch
) -> None:
    with open_events(path) as events:
        run = Run(history, events, "run", is_whole=False)
        rows = [r for r in FIGURES.values() if r.fits(run) and set(r.needs) <= set(history)]
        whole = [reach(row(run)) for row in rows]
        for name, value in {"LONG": 20, "MOST": 16, "FEWEST": 16}.items():
            monkeypatch.setattr(long_histories, name, value)
        assert long_histories.drawable(history, ["penetration"]).sizes["time"] < OUTPUTS
        assert len(rows) >= 5
        assert [reach(row(run)) for row in rows] == whole


def reach(figure) -> list[list[float]]:
    """Lowest and highest value of each panel."""
    found = []
    for axis in figure.axes:
        heights = [np.asarray(line.get_ydata(), dtype=float) for line in axis.lines]
        seen = np.concatenate([h[np.isfinite(h)] for h in heights if h.size > 2] or [[]])
        found.append([seen.min(initial=np.inf), seen.max(initial=-np.inf)])
    return found


def test_pages_hold_the_same_lines_whatever_the_length_of_a_part(
    path: Path, history: xr.Dataset, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(pages, "_library", lambda: ("", ""))
    with open_events(path) as events:
        whole = explorer(history, events)
        monkeypatch.setattr(module, "AT_ONCE", 7 * recording_of(history)._row_bytes())
        parts = explorer(history, events)
    assert (parts.facts, parts.numbers) == (whole.facts, whole.numbers)
