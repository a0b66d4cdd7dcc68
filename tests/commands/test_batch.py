"""`evolvent batch`: records of each case, without loss of data."""

from __future__ import annotations

import json
import os
import pty
import re
import socket
import subprocess
import zlib
from collections.abc import Callable
from pathlib import Path

import h5py
import numpy as np
import pytest
import xarray as xr

from designs import TIMINGS, paper_case, read_folder, read_journal, write_checksum, write_design
from processes import running, wait_for

Evolvent = Callable[..., subprocess.CompletedProcess[str]]
TORQUE = "wheels.pinion.loads.0.value"
FRICTION = "meshes.0.friction.coefficient"
TORQUES = {TORQUE: [-1.0, -1.5, -2.0, -2.5, -3.0, -3.5]}
JOURNAL = "r/shard-1-of-1.jsonl"
# beyond the limit (15) of the Johnson force, about 1e9 N for this pair
OVERLOAD = -1e9


@pytest.fixture
def design(tmp_path: Path) -> Path:
    """A design of six cases."""
    return write_design(tmp_path / "design.h5", TORQUES)


# ---- check of the cases --------------------------------------------------------------------------


def test_a_check_tells_what_a_run_would_refuse_in_its_words_and_writes_nothing(
    evolvent: Evolvent, tmp_path: Path
) -> None:
    columns = {
        TORQUE: [-1.0, 2.0, -1.0, OVERLOAD, -1.0],
        "wheels.pinion.teeth": [20, 20, 2, 20, 20],
        "simulation.duration": [0.02, 0.02, 0.02, 0.02, 0.001],
    }
    base = paper_case().replace("kind: rest", "kind: steady")
    assert base != paper_case()
    design = write_design(tmp_path / "design.h5", columns, base, window=(0.01, 0.02))
    checked = evolvent("batch", design, "--check")
    assert checked.returncode == 1
    assert re.fullmatch(r"evolvent: warning: case 3: .* outside the plausible .*\n", checked.stderr)
    assert [path.name for path in tmp_path.iterdir()] == ["design.h5"]
    *lines, last = [json.loads(line) for line in checked.stdout.splitlines()]
    assert evolvent("batch", design, "-o", "r").returncode == 1
    rows = read_journal(tmp_path / JOURNAL).cases
    refused = {case: row["message"] for case, row in rows.items() if row["status"] == "refused"}
    assert {line["case"]: line["message"] for line in lines} == refused
    assert sorted(refused) == [1, 2, 3, 4]
    assert last == {"checked": 5, "refused": 4, "shortest": 0.02}


def test_a_check_goes_by_shards_and_without_refusals_its_code_is_0(
    evolvent: Evolvent, design: Path
) -> None:
    result = evolvent("batch", design, "--check", "--shard", "2/4")
    assert result.returncode == 0
    assert json.loads(result.stdout) == {"checked": 2, "refused": 0, "shortest": 0.02}


@pytest.mark.parametrize("words", [("-o", "r"), ("--jobs", "2"), ("--resume",), ("--cases", "x")])
def test_a_check_has_no_options_of_a_run(
    evolvent: Evolvent, design: Path, words: tuple[str, ...]
) -> None:
    result = evolvent("batch", design, "--check", *words)
    assert result.returncode == 2
    assert "'--check' runs no case" in result.stderr


# ---- records -------------------------------------------------------------------------------------


def test_each_case_is_a_line_with_its_status_and_reason(evolvent: Evolvent, tmp_path: Path) -> None:
    design = write_design(
        tmp_path / "design.h5",
        {TORQUE: [-1.0, OVERLOAD, -1.0, -1.0], "wheels.pinion.teeth": [20, 20, 2, 20.5]},
    )
    result = evolvent("batch", design, "-o", "r")
    assert result.returncode == 1, result.stderr
    assert "4 cases, 1 done, 3 did not finish (1 failed, 2 refused)" in result.stderr
    rows = read_journal(tmp_path / JOURNAL).cases
    assert [rows[i]["status"] for i in range(4)] == ["done", "failed", "refused", "refused"]
    assert [rows[i]["exit"] for i in range(4)] == [0, 4, 3, 3]
    assert rows[0]["message"] == ""
    assert "eq. (15)" in rows[1]["message"]
    for case, value in ((2, "2"), (3, "20.5")):
        assert (
            f"--set wheels.pinion.teeth={value}: wheels.pinion.teeth: is" in rows[case]["message"]
        )


def test_a_value_is_refused_in_the_words_of_the_set_option(
    evolvent: Evolvent, tmp_path: Path
) -> None:
    (tmp_path / "case.yaml").write_text(paper_case())
    values = ["{law: nonsense}", "{law: johnson, x: [}", "{law: power, exponent: 0}", '"\\"\t\x01']
    design = write_design(tmp_path / "design.h5", {"meshes.0.contact": values})
    assert evolvent("batch", design, "-o", "r").returncode == 1
    rows = read_journal(tmp_path / JOURNAL).cases
    for case, value in enumerate(values):
        single = evolvent("run", "case.yaml", "--set", f"meshes.0.contact={value}")
        assert rows[case]["message"] == single.stderr.rstrip("\n")
        assert rows[case]["exit"] == single.returncode == 3


def test_a_case_without_results_has_nulls_for_numbers(evolvent: Evolvent, tmp_path: Path) -> None:
    design = write_design(tmp_path / "design.h5", {TORQUE: [OVERLOAD, np.nan, np.inf]})
    assert evolvent("batch", design, "-o", "r").returncode == 1
    rows = read_journal(tmp_path / JOURNAL).cases
    assert [rows[i]["status"] for i in range(3)] == ["failed", "refused", "refused"]
    assert all(rows[i]["transmission_error_mean"] is None for i in range(3))
    assert rows[0]["steps"] > 0  # of the work before the failure
    assert rows[1]["steps"] is None


def test_the_first_line_describes_every_number(evolvent: Evolvent, design: Path) -> None:
    assert evolvent("batch", design, "-o", "r").returncode == 0
    journal = read_journal(design.parent / JOURNAL)
    head = journal.head
    assert (head["journal"], head["shard"], head["of"], head["n_cases"]) == (2, 1, 1, 6)
    names = [scalar["name"] for scalar in head["scalars"]]
    assert len(set(names)) == len(names)
    assert all(scalar["units"] and scalar["long_name"] for scalar in head["scalars"])
    for row in journal.rows:
        assert list(row) == ["case", "status", "exit", "message", *names, "at", "check"]


def test_numbers_are_those_of_the_case_s_history(evolvent: Evolvent, tmp_path: Path) -> None:
    base = paper_case(0.05).replace("tracking: differential", "tracking: closed_form")
    (tmp_path / "case.yaml").write_text(base)
    torque, friction, window = -37.5, 0.1, (0.0101, 0.0333)
    design = write_design(
        tmp_path / "design.h5", {TORQUE: [torque], FRICTION: [friction]}, base, window
    )
    assert evolvent("batch", design, "-o", "r").returncode == 0
    row = read_journal(tmp_path / JOURNAL).cases[0]
    sets = ("--set", f"{TORQUE}={torque}", "--set", f"{FRICTION}={friction}")
    assert evolvent("run", "case.yaml", *sets, "-o", "x.h5").returncode == 0
    with (
        xr.open_dataset(tmp_path / "x.h5", engine="h5netcdf") as history,
        xr.open_dataset(tmp_path / "x.h5", engine="h5netcdf", group="events") as events,
    ):
        inside = history.sel(time=slice(*window)).isel(mesh=0)
        assert inside.sizes["time"] == 23

        def mean(values: xr.DataArray) -> float:
            span = float(inside.time[-1] - inside.time[0])
            return float(np.trapezoid(values, inside.time)) / span

        error, force = inside.transmission_error, inside.normal_force
        pairs = inside.get("pairs_in_contact", inside.in_contact)
        expected = {
            "transmission_error_mean": mean(error),
            "normal_force_mean": mean(force),
            "share_no_contact": mean(1.0 * (pairs == 0)),
            "share_one_pair": mean(1.0 * (pairs == 1)),
            "share_two_pairs": mean(1.0 * (pairs == 2)),
            "share_more_pairs": mean(1.0 * (pairs > 2)),
            "energy_residual": energy_residual(history),
            "steps": float(history.attrs["integrator_steps"]),
        }
        for code, meaning in enumerate(events.kind.attrs["flag_meanings"].split()):
            expected[f"events_{meaning}"] = float((events.kind == code).sum())
        # sums of a few hundred terms in another order
        assert {name: row[name] for name in expected} == pytest.approx(
            expected, rel=1e-12, abs=1e-30
        )
        between = {
            "transmission_error_peak_to_peak": float(error.max() - error.min()),
            "normal_force_max": float(force.max()),
            "penetration_max": float(inside.penetration.max()),
        }
        assert set(row) - set(expected) - set(between) == {
            "case",
            "status",
            "exit",
            "message",
            *TIMINGS,
        }
        # located between the outputs, of which a vibration has hardly one
        for name, sampled in between.items():
            assert sampled <= row[name] <= 2 * sampled, name


def test_extremes_are_those_of_the_window_and_do_not_depend_on_the_outputs(
    evolvent: Evolvent, tmp_path: Path
) -> None:
    base = paper_case(0.02).replace("tracking: differential", "tracking: closed_form")
    window = (0.0101, 0.0173)  # no limit on either grid
    intervals = {"simulation.output_interval": [1e-3, 1e-6]}
    design = write_design(tmp_path / "design.h5", intervals, base, window)
    assert evolvent("batch", design, "-o", "r").returncode == 0
    coarse, fine = (read_folder(tmp_path / "r")[i] for i in range(2))
    (tmp_path / "case.yaml").write_text(base)
    fine_outputs = ("--set", "simulation.output_interval=1e-6")
    assert evolvent("run", "case.yaml", *fine_outputs, "-o", "x.h5").returncode == 0
    with xr.open_dataset(tmp_path / "x.h5", engine="h5netcdf") as history:
        inside = history.sel(time=slice(*window)).isel(mesh=0)
        error = inside.transmission_error
        brute = {
            "transmission_error_peak_to_peak": float(error.max() - error.min()),
            "normal_force_max": float(inside.normal_force.max()),
            "penetration_max": float(inside.penetration.max()),
        }
        # the whole run has larger ones: it starts from rest
        assert float(history.normal_force.max()) > 1.05 * brute["normal_force_max"]
    for name, sampled in brute.items():
        assert coarse[name] == pytest.approx(fine[name], rel=1e-9), name
        # 1.2 kHz: a microsecond misses at most (2 pi 1.2e3 * 5e-7)**2/2 at a peak; at a limit of
        # the window the curve may have moved for a microsecond
        assert coarse[name] == pytest.approx(sampled, rel=1e-4), name


@pytest.mark.parametrize("damping", ["law: ratio, value: 0.07", "law: flores, restitution: 0.8"])
def test_damping_by_the_mesh_is_found_anew_for_every_case(
    evolvent: Evolvent, tmp_path: Path, damping: str
) -> None:
    """Cases that differ in values are modified in place, also after one whose mesh has no load."""
    base = re.sub("damping: {.*?}", f"damping: {{{damping}}}", paper_case(0.02))
    (tmp_path / "case.yaml").write_text(base)
    torques = [-1.0, 0.0, -200.0, -3.0]
    design = write_design(tmp_path / "design.h5", {TORQUE: torques}, base, (0.0, 0.02))
    assert evolvent("batch", design, "-o", "r").returncode == 1
    rows = read_journal(tmp_path / JOURNAL).cases
    assert [rows[i]["status"] for i in range(4)] == ["done", "refused", "done", "done"]
    assert "no load presses its flanks together" in rows[1]["message"]
    for i in (0, 2, 3):
        run = evolvent("run", "case.yaml", "--set", f"{TORQUE}={torques[i]}", "-o", "x.h5")
        assert run.returncode == 0
        with xr.open_dataset(tmp_path / "x.h5", engine="h5netcdf") as history:
            assert rows[i]["normal_force_max"] == float(history.normal_force_max[0])
            assert rows[i]["steps"] == history.attrs["integrator_steps"]


def energy_residual(history: xr.Dataset) -> float:
    """Largest error of the energy balance by docs/guides/batch.md, computed independently."""
    stored = history.kinetic_energy + history.potential_energy
    balance = stored + history.dissipated_energy - history.load_work
    power = (history.load_torque * history.angular_velocity).clip(min=0.0).sum("wheel")
    put_in = float(np.trapezoid(power, history.time)) + abs(float(stored[0]))
    scale = max(put_in, float(history.kinetic_energy.max()))
    return float(abs(balance - balance[0]).max()) / scale


def test_without_a_window_the_numbers_are_those_of_the_last_half(
    evolvent: Evolvent, tmp_path: Path
) -> None:
    columns = {"simulation.duration": [0.02, 0.04]}
    open_ended = write_design(tmp_path / "open.h5", columns)
    assert evolvent("batch", open_ended, "-o", "open").returncode == 0
    of_each = read_folder(tmp_path / "open")
    for case, duration in enumerate(columns["simulation.duration"]):
        window = (duration / 2, duration)
        design = write_design(tmp_path / "window.h5", columns, None, window)
        assert evolvent("batch", design, "-o", f"w{case}").returncode in (0, 1)
        assert read_folder(tmp_path / f"w{case}")[case] == of_each[case]


def test_a_window_without_an_output_is_refused(evolvent: Evolvent, tmp_path: Path) -> None:
    design = write_design(
        tmp_path / "design.h5", {"simulation.duration": [0.02, 0.04]}, None, (0.025, 0.03)
    )
    assert evolvent("batch", design, "-o", "r").returncode == 1
    rows = read_journal(tmp_path / JOURNAL).cases
    assert [rows[i]["status"] for i in range(2)] == ["refused", "done"]
    assert "the window from 0.025 to 0.03 s contains no output" in rows[0]["message"]


def test_rows_of_periodic_starts_have_the_multiplier_that_a_run_reports(
    evolvent: Evolvent, tmp_path: Path, examples: Path
) -> None:
    columns = {"wheels.0.loads.0.value": [-50.0, -80.0]}
    base = (examples / "spur-pair.yaml").read_text()
    periodic = base.replace("{kind: steady}", "{kind: periodic}")
    assert periodic != base
    design = write_design(tmp_path / "design.h5", columns, periodic)
    assert evolvent("batch", design, "-o", "r").returncode == 0
    rows = read_folder(tmp_path / "r")
    (tmp_path / "case.yaml").write_text(periodic)
    for case, torque in enumerate(columns["wheels.0.loads.0.value"]):
        load = ("--set", f"wheels.0.loads.0.value={torque}")
        assert evolvent("run", "case.yaml", "-o", "x.h5", *load).returncode == 0
        with xr.open_dataset(tmp_path / "x.h5") as history:
            assert rows[case]["start_multiplier"] == history.attrs["start_multiplier"]
    steady = write_design(tmp_path / "steady.h5", columns, base)
    assert evolvent("batch", steady, "-o", "s").returncode == 0
    assert "start_multiplier" not in read_folder(tmp_path / "s")[0]


def test_with_several_meshes_each_has_its_own_numbers(evolvent: Evolvent, tmp_path: Path) -> None:
    base = """
format: 1
materials: {steel: {youngs_modulus: 2.0e11, poisson_ratio: 0.3, density: 7800}}
wheels:
- {name: a, teeth: 20, pitch_radius: 0.2, width: 0.1, material: steel, centre: [0, 0],
   loads: [{kind: torque, value: -1}]}
- {name: b, teeth: 30, width: 0.1, material: steel}
- {name: c, teeth: 30, width: 0.1, material: steel, loads: [{kind: viscous, coefficient: 10}]}
meshes:
- {name: first-one, driving: a, driven: b, driving_rotation: clockwise, centre_line_angle: 0,
   pressure_angle: 22, damping: {law: linear, coefficient: 1e4}}
- {driving: b, driven: c, driving_rotation: counterclockwise, centre_line_angle: 0,
   pressure_angle: 22, damping: {law: linear, coefficient: 1e4}}
simulation: {duration: 0.02, output_interval: 1e-3}
"""
    design = write_design(tmp_path / "design.h5", {"wheels.a.loads.0.value": [-1.0]}, base)
    assert evolvent("batch", design, "-o", "r").returncode == 0
    row = read_journal(tmp_path / JOURNAL).cases[0]
    (tmp_path / "case.yaml").write_text(base)
    assert evolvent("run", "case.yaml", "-o", "x.h5").returncode == 0
    with xr.open_dataset(tmp_path / "x.h5", engine="h5netcdf") as history:
        late = history.sel(time=slice(0.01 - 1e-9, None))
        for mesh, name in (("first-one", "first_one"), ("b-c", "b_c")):
            largest = float(late.normal_force.sel(mesh=mesh).max())
            assert largest <= row[f"normal_force_max_{name}"] <= 1.1 * largest


# ---- histories -----------------------------------------------------------------------------------


def test_histories_are_those_of_single_runs_in_single_precision(
    evolvent: Evolvent, tmp_path: Path
) -> None:
    (tmp_path / "case.yaml").write_text(paper_case(0.0205))
    names = ("normal_force", "angular_velocity", "contact_point_driving", "kinetic_energy")
    every = 4
    design = write_design(
        tmp_path / "design.h5", TORQUES, paper_case(0.0205), histories=" ".join(names), every=every
    )
    for shard in ("1/2", "2/2"):
        assert evolvent("batch", design, "-o", "r", "--shard", shard).returncode == 0
    for i, torque in enumerate(TORQUES[TORQUE]):
        run = evolvent("run", "case.yaml", "-o", "x.h5", "--set", f"{TORQUE}={torque}")
        assert run.returncode == 0
        stacked = tmp_path / f"r/shard-{i % 2 + 1}-of-2.h5"
        with (
            xr.open_dataset(tmp_path / "x.h5", engine="h5netcdf") as single,
            xr.open_dataset(stacked, engine="h5netcdf") as stack,
        ):
            assert single.sizes["time"] == 22  # the end is not on the grid
            for name in names:
                assert stack[name].dtype == np.float32
                assert stack[name].dims == ("case", *single[name].dims)
                kept = single[name].isel(time=slice(None, None, every))
                np.testing.assert_array_equal(stack.time, kept.time)
                np.testing.assert_array_equal(
                    stack[name].sel(case=i), kept.values.astype(np.float32)
                )
                assert stack[name].units == single[name].units


def test_a_batch_does_not_go_on_with_histories_of_which_one_bit_turned(
    evolvent: Evolvent, tmp_path: Path
) -> None:
    """A changed bit in the location of their values, which HDF5 does not detect."""
    design = write_design(tmp_path / "design.h5", TORQUES, histories="normal_force")
    assert evolvent("batch", design, "-o", "r").returncode == 0
    stack = tmp_path / "r/shard-1-of-1.h5"
    content = bytearray(stack.read_bytes())
    journal = tmp_path / JOURNAL
    rows = journal.read_bytes().splitlines(keepends=True)
    journal.write_bytes(b"".join(rows[:4]))  # some cases remain
    content[100] ^= 1
    stack.write_bytes(content)
    done = evolvent("batch", design, "-o", "r", "--resume")
    assert done.returncode == 3
    assert done.stderr.splitlines()[-1].startswith(
        "r/shard-1-of-1.h5: is damaged: its checksum is wrong"
    )
    assert stack.read_bytes() == content


def test_histories_of_cases_that_do_not_run_are_nan(evolvent: Evolvent, tmp_path: Path) -> None:
    columns = {TORQUE: [-1.0, OVERLOAD, -1.0], "wheels.pinion.teeth": [2, 20, 20]}
    design = write_design(tmp_path / "design.h5", columns, histories="normal_force")
    assert evolvent("batch", design, "-o", "r").returncode == 1
    with xr.open_dataset(tmp_path / "r/shard-1-of-1.h5", engine="h5netcdf") as stack:
        missing = np.isnan(stack.normal_force.isel(mesh=0))
        assert missing.isel(case=0).all()
        assert not missing.isel(case=1, time=0)
        assert missing.isel(case=1, time=slice(1, None)).all()
        assert not missing.isel(case=2).any()


def test_cases_of_other_times_are_refused_if_histories_are_stacked(
    evolvent: Evolvent, tmp_path: Path
) -> None:
    columns = {"simulation.duration": [0.02, 0.03]}
    design = write_design(tmp_path / "design.h5", columns, histories="penetration")
    assert evolvent("batch", design, "-o", "r").returncode == 1
    rows = read_journal(tmp_path / JOURNAL).cases
    assert rows[0]["status"] == "done"
    assert rows[1]["status"] == "refused"
    assert "its history differs in times" in rows[1]["message"]


# ---- independence of workers and shards ----------------------------------------------------------


def test_neither_workers_nor_shards_change_a_bit(evolvent: Evolvent, design: Path) -> None:
    folder = design.parent
    assert evolvent("batch", design, "-o", "one").returncode == 0
    assert evolvent("batch", design, "-o", "two", "--jobs", "2").returncode == 0
    for shard in range(1, 5):
        assert evolvent("batch", design, "-o", "four", "--shard", f"{shard}/4").returncode == 0
    one = read_folder(folder / "one")
    assert sorted(one) == list(range(6))
    assert read_folder(folder / "two") == one
    assert read_folder(folder / "four") == one


def test_a_shard_beyond_the_last_case_has_nothing_to_do(evolvent: Evolvent, design: Path) -> None:
    result = evolvent("batch", design, "-o", "r", "--shard", "8/9")
    assert result.returncode == 0, result.stderr
    assert read_journal(design.parent / "r/shard-8-of-9.jsonl").rows == []


# ---- resume --------------------------------------------------------------------------------------


def test_recorded_cases_are_not_run_again(evolvent: Evolvent, design: Path) -> None:
    journal = design.parent / JOURNAL
    assert evolvent("batch", design, "-o", "r").returncode == 0
    lines = journal.read_bytes().splitlines(keepends=True)
    journal.write_bytes(b"".join(lines[:4]))
    assert evolvent("batch", design, "-o", "r", "--resume").returncode == 0
    again = journal.read_bytes().splitlines(keepends=True)
    assert again[:4] == lines[:4]
    assert len(again) == len(lines)
    assert sorted(read_journal(journal).cases) == list(range(6))
    assert evolvent("batch", design, "-o", "r", "--resume").returncode == 0
    assert journal.read_bytes() == b"".join(again)


def test_without_resume_recorded_cases_are_left_alone(evolvent: Evolvent, design: Path) -> None:
    journal = design.parent / JOURNAL
    assert evolvent("batch", design, "-o", "r").returncode == 0
    before = journal.read_bytes()
    result = evolvent("batch", design, "-o", "r")
    assert result.returncode == 3
    assert "6 cases are already recorded here; continue with --resume" in result.stderr
    assert journal.read_bytes() == before


@pytest.mark.parametrize("cut", [1, 2, 40, "message", "head"])
def test_a_torn_last_line_is_closed_and_its_case_run_again(
    evolvent: Evolvent, tmp_path: Path, cut: int | str
) -> None:
    # the message of the last case ends in a bracket, which could be taken for the end of line
    columns = {"meshes.0.contact": ["{law: johnson}", "{law: {a: 1}}"]}
    design = write_design(tmp_path / "design.h5", columns)
    journal = tmp_path / JOURNAL
    assert evolvent("batch", design, "-o", "r").returncode == 1
    whole = read_journal(journal)
    text = journal.read_bytes()
    if cut == "message":
        text = text[: text.rindex(b"{a: 1}}") + 7]
    elif cut == "head":
        text = text[:100]
    else:
        text = text[:-cut]
    journal.write_bytes(text)
    assert evolvent("batch", design, "-o", "r", "--resume").returncode == 1
    again = read_journal(journal)
    assert again.head == whole.head
    assert again.results == whole.results
    assert len(again.rows) == len(whole.rows)
    assert again.torn == (0 if cut in (1, "head") else 1)  # only the newline was missing


def test_a_damaged_line_is_run_again_and_a_damaged_head_written_anew(
    evolvent: Evolvent, design: Path
) -> None:
    journal = design.parent / JOURNAL
    assert evolvent("batch", design, "-o", "r").returncode == 0
    whole = read_journal(journal)
    lines = journal.read_bytes().splitlines(keepends=True)
    lines[0] = lines[0].replace(b'"shard":1', b'"shard":3')
    lines[2] = lines[2].replace(b'"steps":', b'"steps":1')
    journal.write_bytes(b"".join(lines))
    lost = json.loads(evolvent("records", "r").stdout)
    assert (lost["torn"], lost["rows"], lost["journals"][0]["head"]) == (7, 0, None)
    again = evolvent("batch", design, "-o", "r", "--resume")
    assert again.returncode == 0
    assert f"{JOURNAL}: its first line is damaged and is rewritten; 5 cases are re" in again.stderr
    reported = [json.loads(line) for line in evolvent("records", "r").stdout.splitlines()]
    assert (reported[0]["torn"], reported[0]["rows"], reported[0]["journals"][0]["head"]) == (
        2,
        6,
        whole.head,
    )
    for row in reported[1:]:
        expected = whole.results[row["case"]]
        assert {key: row[key] for key in expected} == expected


def test_named_cases_are_run_again_and_the_later_line_counts(
    evolvent: Evolvent, design: Path
) -> None:
    journal = design.parent / JOURNAL
    assert evolvent("batch", design, "-o", "r").returncode == 0
    before = journal.read_bytes()
    (design.parent / "cases.txt").write_text("4\n1\n\n")
    result = evolvent("batch", design, "-o", "r", "--cases", "cases.txt")
    assert result.returncode == 0, result.stderr
    after = read_journal(journal)
    assert journal.read_bytes().startswith(before)
    assert [row["case"] for row in after.rows[6:]] == [1, 4]
    assert after.results == {**after.results, **{r["case"]: _timeless(r) for r in after.rows[:6]}}


def test_a_list_leaves_out_what_was_recorded_since_it_was_written(
    evolvent: Evolvent, design: Path
) -> None:
    """A requeued job continues with the remainder of its list."""
    assert evolvent("batch", design, "-o", "r").returncode == 0
    cases = design.parent / "cases.txt"

    def run(text: str) -> list[int]:
        journal = design.parent / JOURNAL
        before = len(read_journal(journal).rows) if journal.exists() else 0
        cases.write_text(text)
        result = evolvent("batch", design, "-o", "r", "--cases", "cases.txt")
        assert result.returncode == 0, result.stderr
        return [row["case"] for row in read_journal(journal).rows[before:]]

    journal = json.loads(evolvent("records", "r").stdout.splitlines()[0])["journals"][0]
    assert journal["rows"] == 6
    assert run("after 6\n4\n") == [4]
    assert run("after 6\n4\n1\n") == [1]  # 4 was run since
    assert run("after 6\n4\n1\n") == []
    assert run("after 8\n4\n1\n") == [1, 4]  # a later list
    (design.parent / JOURNAL).unlink()
    assert run("after 6\n4\n1\n") == [1, 4]


def test_records_are_counted_by_what_became_of_the_cases(
    evolvent: Evolvent, design: Path, tmp_path: Path
) -> None:
    columns = {
        "wheels.pinion.loads.0.value": [-1.0, -2.0, -3.0],
        "simulation.duration": [0.01, -1, 0.01],
    }
    bad = write_design(tmp_path / "bad.h5", columns)
    assert evolvent("batch", bad, "-o", "r").returncode == 1
    (tmp_path / "cases.txt").write_text("0\n")
    assert evolvent("batch", bad, "-o", "r", "--cases", "cases.txt").returncode == 1
    counts = {"torn": 0, "rows": 4, "done": 2, "failed": 0, "refused": 1}
    assert json.loads(evolvent("records", "r", "--counts").stdout) == counts
    head = json.loads(evolvent("records", "r", "--brief").stdout.splitlines()[0])
    assert {key: head[key] for key in counts} == counts


def _timeless(row: dict[str, object]) -> dict[str, object]:
    return {name: value for name, value in row.items() if name not in TIMINGS}


def test_named_cases_of_other_shards_are_left_to_them(evolvent: Evolvent, design: Path) -> None:
    (design.parent / "cases.txt").write_text("0\n1\n2\n3\n")
    for shard in ("1/2", "2/2"):
        done = evolvent("batch", design, "-o", "r", "--shard", shard, "--cases", "cases.txt")
        assert done.returncode == 0
    assert sorted(read_folder(design.parent / "r")) == [0, 1, 2, 3]


@pytest.mark.parametrize("line", ["6", "-1", "one", "1 2", "99999999999999999999", "after 3"])
def test_numbers_of_no_case_are_refused(evolvent: Evolvent, design: Path, line: str) -> None:
    (design.parent / "cases.txt").write_text(f"0\n{line}\n")
    result = evolvent("batch", design, "-o", "r", "--cases", "cases.txt")
    assert result.returncode == 3
    said = f"cases.txt:2: '{line}' is not a case of the design; cases are numbered 0 to 5"
    assert result.stderr == f"{said}\n"


# ---- rejected input ------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("columns", "changes", "said"),
    [
        (
            {"wheels.pinion.tooth": [20]},
            {},
            "wheels.pinion has no key 'tooth' (did you mean 'teeth'?)",
        ),
        ({"wheels.pinon.teeth": [20]}, {}, "wheels has no 'pinon' (did you mean 'pinion'?)"),
        ({"wheels.0.loads.3.value": [2]}, {}, "wheels.0.loads has no element '3'"),
        ({"title.x": ["a"]}, {}, "title is a single value and has no 'x'"),
        ({"simulation.duraton": [1.0]}, {}, "did you mean 'duration'?"),
        ({"a=b": [1.0]}, {}, "no case has the path 'a=b': it contains '='"),
        ({TORQUE: []}, {}, "is an empty design without cases"),
        ({TORQUE: [-1.0]}, {"evolvent_version": "0.0.1"}, "was made by evolvent 0.0.1, this is"),
        ({TORQUE: [-1.0]}, {"evolvent_design_format": 2}, "reads format 1 only"),
        ({TORQUE: [-1.0]}, {"evolvent_design_format": None}, "is not a design"),
        ({TORQUE: [-1.0]}, {"case": "format: ["}, "base case:2:1: not valid YAML"),
        ({TORQUE: [-1.0]}, {"case": ""}, "base case: is empty"),
        ({TORQUE: [-1.0]}, {"window": [1.0]}, "window: this attribute of the design is missing"),
        ({TORQUE: [-1.0]}, {"window": [2.0, 1.0]}, "window: from 2 to 1 s is not a time span"),
        ({TORQUE: [-1.0]}, {"n_cases": 2}, "p0: does not have one value for each of the 2 cases"),
        ({TORQUE: [-1.0]}, {"history_every": 0}, "history_every: this attribute"),
        ({TORQUE: [-1.0]}, {"history_variables": "gap teeth"}, "has no 'teeth' over time"),
        ({TORQUE: [-1.0]}, {"history_variables": "gop"}, "did you mean 'gap'?"),
    ],
    ids=lambda value: "-".join(value) if isinstance(value, dict) else "",
)
def test_a_bad_design_is_refused_as_a_whole(
    evolvent: Evolvent,
    tmp_path: Path,
    columns: dict[str, list[object]],
    changes: dict[str, object],
    said: str,
) -> None:
    design = write_design(tmp_path / "design.h5", columns, **changes)
    result = evolvent("batch", design, "-o", "r")
    assert result.returncode == 3
    assert result.stderr.startswith(str(design))
    assert said in result.stderr
    assert len(result.stderr.splitlines()) == 1
    assert not (tmp_path / "r").exists()


def test_a_path_need_not_stand_in_the_base_case(evolvent: Evolvent, tmp_path: Path) -> None:
    """The mass of the pinion changes the force of the pair as the equation of motion states."""
    masses = np.array([49.0, 98.0])
    columns = {
        "simulation.max_step": [0.01] * 2,
        "gravity": ["[0, 0, 0]"] * 2,
        "wheels.pinion.mass": masses.tolist(),
    }
    base, window = paper_case(0.2, "paper.yaml"), (0.1, 0.2)
    design = write_design(tmp_path / "design.h5", columns, base, window)
    assert evolvent("batch", design, "-o", "r").returncode == 0
    rows = read_journal(tmp_path / JOURNAL).results.values()
    # rigid teeth: (J + J') omega' = T - c' omega from rest, J' and c' of the gear over 1.5**2;
    # the elastic pair vibrates about it and is damped before the window
    inertia, other, drag = masses * 0.2**2 / 2, 9.924291192690157 / 1.5**2, 10 / 1.5**2
    rate = drag / (inertia + other)
    decay = (np.exp(-rate * window[0]) - np.exp(-rate * window[1])) / (rate * 0.1)
    force = (1 - inertia / (inertia + other) * decay) / 0.19827958341640872
    found = [row["normal_force_mean"] for row in rows]
    np.testing.assert_allclose(found, force, rtol=1e-3)


def test_a_column_without_path_changes_nothing(evolvent: Evolvent, tmp_path: Path) -> None:
    other = write_design(tmp_path / "other.h5", {TORQUE: [-1.0]})
    assert evolvent("batch", other, "-o", "other").returncode == 0
    expected = read_journal(tmp_path / "other/shard-1-of-1.jsonl").results
    assert expected[0]["normal_force_mean"] > 0
    design = write_design(tmp_path / "design.h5", {TORQUE: [-1.0], "other": [3.0]})
    with h5py.File(design, "a") as file:
        file["parameters/p1"].attrs["path"] = ""
    write_checksum(design)
    assert evolvent("batch", design, "-o", "r").returncode == 0
    assert read_journal(tmp_path / JOURNAL).results == expected


@pytest.mark.parametrize("text", ["no HDF5", ""])
def test_what_is_no_design_is_refused(evolvent: Evolvent, tmp_path: Path, text: str) -> None:
    (tmp_path / "design.h5").write_text(text)
    result = evolvent("batch", "design.h5", "-o", "r")
    assert result.returncode == 3
    assert "is not an HDF5 file; create a design with evolvent-sweep plan" in result.stderr


def test_a_design_that_was_edited_is_none_of_its_folder_whatever_it_says_of_its_hash(
    evolvent: Evolvent, tmp_path: Path
) -> None:
    design = write_design(tmp_path / "design.h5", {TORQUE: [-1.0]}, hash="the same")
    assert evolvent("batch", design, "-o", "r").returncode == 0
    with h5py.File(design, "a") as file:
        file["parameters/p0"][0] = -1.0000000000000002
    broken = evolvent("batch", design, "-o", "r", "--resume")
    write_checksum(design)
    edited = evolvent("batch", design, "-o", "r", "--resume")
    assert (broken.returncode, edited.returncode) == (3, 3)
    assert "is damaged, or was changed: its checksum is wrong; use an intact copy" in broken.stderr
    assert "this folder holds the results of another design" in edited.stderr


def test_a_design_without_a_check_sum_is_taken_with_a_warning(
    evolvent: Evolvent, tmp_path: Path
) -> None:
    design = write_design(tmp_path / "design.h5", {TORQUE: [-1.0]})
    sealed = evolvent("batch", design, "--check")
    with design.open("r+b") as file:
        file.write(bytes(64))
    bare = evolvent("batch", design, "--check")
    assert (sealed.returncode, bare.returncode) == (0, 0)
    assert sealed.stderr == ""
    assert bare.stderr == (
        f"evolvent: warning: {design}: has no checksum, so damage would not be detected; plan it "
        "again with evolvent-sweep plan\n"
    )


def test_a_folder_of_another_design_is_refused(evolvent: Evolvent, design: Path) -> None:
    assert evolvent("batch", design, "-o", "r").returncode == 0
    other = write_design(design.parent / "other.h5", {TORQUE: [-1.0]})
    result = evolvent("batch", other, "-o", "r", "--resume")
    assert result.returncode == 3
    assert "r/design.txt: this folder holds the results of another design" in result.stderr


def test_a_journal_of_another_version_is_refused(evolvent: Evolvent, design: Path) -> None:
    journal = design.parent / JOURNAL
    assert evolvent("batch", design, "-o", "r").returncode == 0
    head, *rows = journal.read_bytes().splitlines(keepends=True)
    other = head[:-21].replace(b'"evolvent":"', b'"evolvent":"9.')
    other += b',"check":"%08x"}\n' % zlib.crc32(other)
    journal.write_bytes(b"".join([other, *rows]))
    result = evolvent("batch", design, "-o", "r", "--resume")
    assert result.returncode == 3
    assert "was started by another version" in result.stderr


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (["--shard", "0/4"], "--shard 0/4: write I/N"),
        (["--shard", "5/4"], "--shard 5/4: write I/N"),
        (["--shard", "1"], "--shard 1: write I/N"),
        (["--shard", "1/2x"], "--shard 1/2x: write I/N"),
        (["--jobs", "0"], "--jobs 0: write a number of processes"),
        (["--jobs", "2.5"], "--jobs 2.5: write a number of processes"),
    ],
)
def test_misuse_is_told(evolvent: Evolvent, design: Path, arguments: list[str], said: str) -> None:
    result = evolvent("batch", design, "-o", "r", *arguments)
    assert result.returncode == 2
    assert said in result.stderr


def test_a_folder_is_needed(evolvent: Evolvent, design: Path) -> None:
    result = evolvent("batch", design)
    assert result.returncode == 2
    assert "'batch' needs a folder: -o DIR" in result.stderr


def test_a_folder_that_cannot_be_made_is_an_error_of_output(
    evolvent: Evolvent, design: Path
) -> None:
    result = evolvent("batch", design, "-o", "no/such/folder")
    assert result.returncode == 74
    assert result.stderr == "no/such/folder: cannot be written: No such file or directory\n"


def test_a_second_run_of_a_shard_is_refused_and_told_who_is_first(
    executable: Path, evolvent: Evolvent, tmp_path: Path
) -> None:
    endless = {TORQUE: [-1.0], "simulation.duration": [1e6], "simulation.output_interval": [0.01]}
    design = write_design(tmp_path / "design.h5", endless)
    first = subprocess.Popen([executable, "batch", design, "-o", "r", "-q"], cwd=tmp_path)
    try:
        wait_for(lambda: (tmp_path / JOURNAL).is_file())
        result = evolvent("batch", design, "-o", "r", "--resume")
        assert result.returncode == 3
        assert f"(pid {first.pid} on {socket.gethostname()} since " in result.stderr
        assert "shard-1-of-1.lock: another run uses this folder" in result.stderr
    finally:
        first.kill()
        first.wait()
    # its lock file remains, but is not locked
    command = [executable, "batch", design, "-o", "r", "--resume"]
    with running(command, tmp_path, stderr=subprocess.PIPE, text=True) as ended:
        wait_for(lambda: f"pid {ended.pid} " in (tmp_path / "r/shard-1-of-1.lock").read_text())
        ended.terminate()
        assert "interrupted by SIGTERM" in ended.communicate(timeout=60)[1]
    assert ended.returncode == 75


# ---- progress ------------------------------------------------------------------------------------


def test_a_terminal_shows_each_second_how_far_a_batch_is(executable: Path, tmp_path: Path) -> None:
    columns = {"simulation.duration": [0.02, 1e5, 0.02], "wheels.pinion.teeth": [20, 20, 2]}
    design = write_design(tmp_path / "design.h5", columns)
    ours, theirs = pty.openpty()
    command = [executable, "batch", design, "-o", "r", "--jobs", "2"]
    with running(command, tmp_path, stderr=theirs) as process:
        os.close(theirs)
        shown = ""
        while "2 of 3 done" not in shown:  # a busy machine shows less at first
            shown = os.read(ours, 4096).decode()
        process.terminate()
    end = ""
    while not end.endswith("\n"):  # in between the journal is written to disk
        end += os.read(ours, 4096).decode()
    os.close(ours)
    assert re.match(r"\r2 of 3 done, 1 of them did not finish, \S+ a second, \d+:\d\d left", shown)
    assert end.startswith("\r\x1b[K")  # the line is cleared before the message
    assert "interrupted by SIGTERM; 2 of 3 cases were finished, --resume runs the others" in end


def test_a_log_gets_lines_with_the_time_of_how_far_a_batch_is(
    executable: Path, tmp_path: Path
) -> None:
    columns = {"simulation.duration": [0.02, 1e5, 0.02], "wheels.pinion.teeth": [20, 20, 2]}
    design = write_design(tmp_path / "design.h5", columns)
    command = [executable, "batch", design, "-o", "r", "--jobs", "2"]
    log = tmp_path / "log"
    often = {**os.environ, "EVOLVENT_PROGRESS_INTERVAL": "0.01"}
    with log.open("w") as stderr, running(command, tmp_path, stderr=stderr, env=often) as process:
        wait_for(lambda: log.read_text().count("  2 of 3 done") > 1)
        process.terminate()
    *lines, last = log.read_text().splitlines()
    line = (
        r"evolvent: \d{4}-\d\d-\d\d \d\d:\d\d:\d\d  [0-2] of 3 done, [01] of them did not finish, "
    )
    assert all(re.match(line + r"\S+ a second(, \d+:\d\d left)?$", text) for text in lines), lines
    assert "interrupted by SIGTERM; 2 of 3 cases were finished" in last


def test_quiet_says_nothing(evolvent: Evolvent, design: Path) -> None:
    result = evolvent("batch", design, "-o", "r", "-q")
    assert (result.returncode, result.stdout, result.stderr) == (0, "", "")
