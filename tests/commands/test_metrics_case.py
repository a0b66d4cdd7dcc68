"""`simulation.metrics` and a design's `numbers`: rejected input, and output locations."""

from __future__ import annotations

import subprocess
from collections.abc import Callable
from pathlib import Path

import h5py
import numpy as np
import pytest
import xarray as xr
import yaml

from designs import read_journal, write_checksum, write_design
from evolvent.figures.response import SHOWN
from evolvent.physics.results import MESH_ROWS, ONLY_IF_ANY

Evolvent = Callable[..., subprocess.CompletedProcess[str]]
JOURNAL = "r/shard-1-of-1.jsonl"
SHORT = ("--set", "simulation.duration=0.01")


@pytest.fixture
def case(examples: Path) -> Path:
    return examples / "spur-pair.yaml"


@pytest.mark.parametrize(
    ("numbers", "reported"),
    [
        ("{from: 1}", "metrics: the window is from 1 to 0.01 s, which is not a time span"),
        ("{to: 1}", "metrics: the window ends at 1 s, but the case at 0.01 s"),
        ("{from: 0.003, to: 0.002}", "the window is from 0.003 to 0.002 s"),
        ("{from: -1}", "metrics.from: is -1 s, must be at least 0 s"),
        ("{pitches_of: gears}", "pitches_of: there is no mesh 'gears'; the case has pinion-gear"),
        ("{turns_of: gearr}", "turns_of: there is no wheel 'gearr' (did you mean 'gear'?)"),
        ("{turns_of: gear, pitches_of: pinion-gear}", "omit pitches_of or turns_of"),
        ("{every: 3}", "unknown key 'every'; known here: from, to, pitches_of, turns_of"),
        ("3", "metrics: must be a block of keys"),
    ],
)
def test_a_window_that_cannot_be_is_refused_at_its_place(
    evolvent: Evolvent, case: Path, tmp_path: Path, numbers: str, reported: str
) -> None:
    result = evolvent("run", case, *SHORT, "--set", f"simulation.metrics={numbers}", "-o", "n.h5")
    assert result.returncode == 3
    assert f"--set simulation.metrics={numbers}: simulation." in result.stderr
    assert reported in result.stderr
    assert len(result.stderr.splitlines()) == 1
    assert not list(tmp_path.glob("n.h5*"))


@pytest.mark.parametrize(
    ("numbers", "reported"),
    [
        (
            "{from: 9.5e-3}",
            "mesh 'pinion-gear', from one start of contact to the next: only 0.23",
        ),
        (
            "{turns_of: gear}",
            "no whole revolution of wheel 'gear', counted from its start: only 0.069",
        ),
    ],
)
def test_a_run_without_a_whole_period_in_its_window_fails_with_the_reason(
    evolvent: Evolvent, case: Path, tmp_path: Path, numbers: str, reported: str
) -> None:
    result = evolvent("run", case, *SHORT, "--set", f"simulation.metrics={numbers}", "-o", "n.h5")
    assert result.returncode == 4
    assert result.stderr.count(reported) == 1
    assert (
        "start the window earlier, or increase the duration; the history up to there is in 'n.h5."
        in result.stderr
    )
    assert not (tmp_path / "n.h5").exists()
    with xr.open_dataset(tmp_path / "n.h5.partial", engine="h5netcdf") as history:
        assert history.attrs["status"] == "failed"
        assert reported in history.attrs["status_message"]
        assert int(history["window_periods"]) == 0
        names = [name for name in history if str(name).startswith("window_")]
        assert len(names) > 40
        assert all(np.isnan(history[n].values).all() for n in names if n != "window_periods")


def test_a_run_tells_its_impacts_where_there_are_some(
    evolvent: Evolvent, examples: Path, case: Path, tmp_path: Path
) -> None:
    rattle = ("--set", "simulation.duration=0.1", "--set", "simulation.metrics={from: 0.02}")
    result = evolvent("run", examples / "rattle.yaml", *rattle, "-o", "rattle.h5")
    assert result.returncode == 0, result.stderr
    with h5py.File(tmp_path / "rattle.h5") as history:
        impacts = history["window_impacts"][0]
        speed = 1e3 * history["window_impact_speed_max"][0]
    assert impacts > 1
    assert f" %, {impacts:.0f} impacts at up to {speed:.3g} mm/s\n" in result.stderr
    result = evolvent("run", case, *SHORT, "--set", "simulation.metrics={from: 0}", "-o", "n.h5")
    assert "without contact 0 %\n" in result.stderr


def test_a_mesh_that_does_not_turn_is_told(evolvent: Evolvent, examples: Path) -> None:
    settings = ("wheels.0.loads=[]", "simulation.duration=0.01", "simulation.metrics={}")
    words = [word for setting in settings for word in ("--set", setting)]
    result = evolvent("run", examples / "paper.yaml", *words, "-o", "n.h5")
    assert result.returncode == 4, result.stderr
    assert "start of contact to the next: only 0 pitches" in result.stderr


def rows_of(
    evolvent: Evolvent, folder: Path, case: Path, words: str | None, *, code: int = 0
) -> dict[int, dict[str, float]]:
    base = case.read_text().replace("duration: 50 ms", "duration: 20 ms")
    assert base != case.read_text()
    design = write_design(folder / "d.h5", {"wheels.pinion.loads.0.value": [-50.0, -30.0]}, base)
    if words is not None:
        with h5py.File(design, "a") as file:
            file.attrs["numbers"] = words
        write_checksum(design)
    result = evolvent("batch", design, "-o", folder / "r")
    assert result.returncode == code, result.stderr
    return read_journal(folder / JOURNAL).cases


def test_a_batch_tells_the_numbers_that_its_design_names(
    evolvent: Evolvent, case: Path, tmp_path: Path
) -> None:
    folders = [tmp_path / name for name in ("usual", "some", "all")]
    for folder in folders:
        folder.mkdir()
    usual = rows_of(evolvent, folders[0], case, None)
    some = rows_of(evolvent, folders[1], case, "dynamic_factor normal_force_amplitude")
    every = rows_of(evolvent, folders[2], case, "all")
    harmonics = [f"normal_force_amplitude_{n}" for n in range(1, 11)]
    new = [name for name in some[0] if name not in usual[0]]
    assert sorted(new) == sorted([*harmonics, "dynamic_factor", "window_settled"])
    for i in range(2):
        for name in usual[i]:
            if name not in ("at", "check", "cpu_time"):
                assert some[i][name] == usual[i][name], name
        for name in new:
            assert some[i][name] == every[i][name], name


def test_numbers_of_a_batch_are_those_of_the_history(
    evolvent: Evolvent, case: Path, tmp_path: Path
) -> None:
    rows = rows_of(evolvent, tmp_path, case, "all")
    settings = ("simulation.metrics={}", "wheels.pinion.loads.0.value=-30")
    words = [word for setting in settings for word in ("--set", setting)]
    words += ["--set", "simulation.duration=0.02"]
    assert evolvent("run", case, *words, "-o", "n.h5").returncode == 0
    with xr.open_dataset(tmp_path / "n.h5", engine="h5netcdf") as history:
        reported = {
            "normal_force_mean": history["window_normal_force_mean"][0],
            "transmission_error_phase_3": history["window_transmission_error_phase"][0, 2],
            "angular_acceleration_rms_gear": history["window_angular_acceleration_rms"][1],
            "share_two_pairs": history["window_share_two_pairs"][0],
            "pair_dynamic_factor": history["window_pair_dynamic_factor"][0],
        }
        for name, value in reported.items():
            assert rows[1][name] == float(value), name
        assert all(
            len([key for key in rows[1] if key.startswith(str(name).removeprefix("window_"))])
            for name in history
            if str(name).startswith("window_")
            and str(name) not in ("window_begin", "window_end", "window_periods", "window_settled")
        )


def test_a_case_of_a_batch_without_a_whole_period_is_recorded_as_failed(
    evolvent: Evolvent, case: Path, tmp_path: Path
) -> None:
    base = case.read_text().replace("duration: 50 ms", "duration: 2 ms")
    design = write_design(tmp_path / "d.h5", {"wheels.pinion.loads.0.value": [-50.0]}, base)
    with h5py.File(design, "a") as file:
        file.attrs["numbers"] = "dynamic_factor"
    write_checksum(design)
    assert evolvent("batch", design, "-o", "r").returncode == 1
    row = read_journal(tmp_path / JOURNAL).cases[0]
    assert (row["status"], row["exit"], row["dynamic_factor"]) == ("failed", 4, None)
    assert "contains no whole pitch of mesh 'pinion-gear'" in row["message"]


@pytest.mark.parametrize(
    ("settings", "settled"),
    [
        ({}, 1.0),
        ({"simulation.initial.kind": "rest"}, 0.0),
        ({"meshes.0.contact.law": "rigid", "meshes.0.damping.law": "none"}, None),
    ],
    ids=["settled", "unsettled", "missing"],
)
def test_a_row_says_whether_the_window_is_settled_as_the_history_does(
    evolvent: Evolvent, case: Path, tmp_path: Path, settings: dict[str, str], settled: float | None
) -> None:
    shorter = yaml.safe_load(case.read_text())
    shorter["simulation"] |= {"duration": 0.02, "metrics": {"from": 4e-3}}
    for path, value in settings.items():
        *folders, key = path.split(".")
        at = shorter
        for folder in folders:
            at = at[int(folder)] if isinstance(at, list) else at[folder]
        if key == "law":
            at.clear()
        at[key] = value
    base = tmp_path / "base.yaml"
    base.write_text(yaml.safe_dump(shorter))
    column = {"wheels.pinion.loads.0.value": [-50.0]}
    design = write_design(tmp_path / "d.h5", column, base.read_text(), window=(4e-3, 0.02))
    with h5py.File(design, "a") as file:
        file.attrs["numbers"] = "all"
    write_checksum(design)
    done = evolvent("batch", design, "-o", "r")
    assert done.returncode == 0, done.stderr
    row = read_journal(tmp_path / JOURNAL).cases[0]
    assert row["window_settled"] == settled
    assert evolvent("run", base, "-o", "n.h5").returncode == 0
    with xr.open_dataset(tmp_path / "n.h5", engine="h5netcdf") as history:
        reported = float(history["window_settled"])
        assert (None if np.isnan(reported) else reported) == settled
        reason = history.attrs["window_settled_reason"]
    assert (reason == "") == (settled == 1)
    assert reason in row["message"]
    assert ("the window may not be settled" in row["message"]) == (settled != 1)


def test_an_unknown_number_is_refused(evolvent: Evolvent, case: Path, tmp_path: Path) -> None:
    design = write_design(
        tmp_path / "d.h5", {"wheels.pinion.loads.0.value": [-50.0]}, case.read_text()
    )
    with h5py.File(design, "a") as file:
        file.attrs["numbers"] = "all dynamicfactor"
    write_checksum(design)
    result = evolvent("batch", design, "-o", "r")
    assert result.returncode == 3
    assert "metrics: unknown metric 'dynamicfactor'; known are all, contact," in result.stderr


def documented_metrics() -> dict[str, tuple[tuple[str, ...], str]]:
    """Dimensions and unit of each metric, from the tables of its page."""
    page = Path(__file__).parents[2] / "docs" / "reference" / "numbers.md"
    text = page.read_text(encoding="utf-8")
    lines = [line for line in text.splitlines() if line.startswith("| `")]
    cells = [[cell.strip(" `") for cell in line.split("|")[1:-1]] for line in lines]
    quantities = [(row[0], tuple(row[1].split(", ")), row[2]) for row in cells if len(row) == 4]
    found = {}
    for name, unit, what in (row for row in cells if len(row) == 3):
        dims = ("wheel",) if name.startswith("root_stress_") else ("mesh",)
        of_each = quantities if name.startswith("QUANTITY_") else [("", dims, "")]
        for quantity, dims, its_unit in of_each:
            orders = ("harmonic",) if "harmonics" in what else ()
            found[name.replace("QUANTITY", quantity)] = ((*dims, *orders), unit or its_unit)
    return found


def test_the_page_has_the_metrics_of_the_program_with_their_dimensions_and_units(
    evolvent: Evolvent, case: Path, tmp_path: Path
) -> None:
    accelerometers = "[{name: top, point: [0, 0.1, 0], direction: [0, 1, 0]}]"
    settings = (
        "simulation.metrics={}",
        "simulation.initial={kind: rest}",
        f"housing={{kind: prescribed, accelerometers: {accelerometers}}}",
        "wheels.pinion.compliance={}",
        "materials.steel.thermal_conductivity=45 W/(m K)",
        "materials.steel.specific_heat=460 J/(kg K)",
        "lubricant={bulk_temperature: 90 degC}",
        "simulation.outputs=all,root_stress_max,pair_flash_temperature",
    )
    words = [word for setting in settings for word in ("--set", setting)]
    result = evolvent("run", case, *SHORT, *words, "-o", "n.h5")
    assert result.returncode == 0, result.stderr
    with xr.open_dataset(tmp_path / "n.h5", engine="h5netcdf") as history:
        metrics = {
            str(name).removeprefix("window_"): (values.dims, values.attrs["units"])
            for name, values in history.items()
            if str(name).startswith("window_")
        }
    for name in ("begin", "end", "periods", "settled"):
        del metrics[name]
    assert metrics == documented_metrics()


def test_reports_and_figures_name_metrics_of_the_program_and_their_units() -> None:
    documented = documented_metrics()
    for row in MESH_ROWS:
        assert row.units.replace("%", "1") == documented[row.name][1], row.name
    assert {*SHOWN, *ONLY_IF_ANY} <= documented.keys()
