"""Sweeps whose histories stand at pitches of a mesh."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
import xarray as xr
import yaml

from evolvent.sweep.design import read_design

PLAN = """
format: 1
case: pair.yaml
method: list
parameters:
- {path: wheels.pinion.loads.0.value, name: load, values: [-50, -100, -10, -20]}
window: {from: 0.002, to: 0.004}
histories: HISTORIES
"""
ROWS = "{variables: [transmission_error], every: 2, rows: 12}"


@pytest.fixture
def plan(examples: Path, tmp_path: Path) -> Path:
    case = yaml.safe_load((examples / "spur-pair.yaml").read_text(encoding="utf-8"))
    output = {"per_pitch": 10, "mesh": "pinion-gear"}
    case["simulation"] = {
        "duration": 0.004,
        "output": output,
        "initial": {"kind": "steady", "position": 0},
    }
    (tmp_path / "pair.yaml").write_text(yaml.safe_dump(case, sort_keys=False))
    (tmp_path / "sweep.yaml").write_text(PLAN.replace("HISTORIES", ROWS))
    return tmp_path / "sweep.yaml"


@pytest.mark.parametrize("copy", [(), ("--copy-histories",)])
def test_a_summary_has_histories_along_positions_with_their_times(sweep, plan, tmp_path, copy):
    assert sweep("plan", plan, "-o", "d.h5") == (0, "d.h5: 4 cases\n", "")
    assert sweep("run", "d.h5", "-o", "r", "--shards", "2")[0] == 0
    assert sweep("collect", "r", "-o", "s.h5", *copy)[0] == 0
    with xr.open_dataset(tmp_path / "s.h5", engine="h5netcdf") as summary:
        np.testing.assert_array_equal(summary["output_position"], np.arange(12) / 5)
        assert summary["transmission_error"].dims == ("case", "output_position", "mesh")
        assert summary["time"].dims == ("case", "output_position")
        assert summary["time"].attrs["role"] == "history"
        reached = np.count_nonzero(~np.isnan(summary["time"].values), axis=1)
        assert reached[1] == 12  # of the heaviest load, the fastest
        assert reached[1] > reached[0] > reached[3] > reached[2] > 0
        there = ~np.isnan(summary["transmission_error"].values[:, :, 0])
        np.testing.assert_array_equal(there, ~np.isnan(summary["time"].values))
        # a steady start: from the first pitch on, times go as the speed does
        assert np.all(np.diff(summary["time"].values[1]) > 0.0)
        assert np.all(summary["transmission_error_mean"].values[:2] > 0.0)


def test_the_number_of_positions_decides_about_the_results(sweep, plan, tmp_path):
    hashes = []
    for rows in ("12", "13"):
        plan.write_text(PLAN.replace("HISTORIES", ROWS.replace("12", rows)))
        assert sweep("plan", plan, "-o", "d.h5")[0] == 0
        design = read_design(tmp_path / "d.h5")
        assert design.history_rows == int(rows)
        hashes.append(design.hash)
    assert hashes[0] != hashes[1]


@pytest.mark.parametrize(
    ("histories", "message"),
    [
        ("{variables: [angle]}", "give the number of stored rows (in a plan histories.rows)"),
        ("{variables: [angle], rows: 0}", "histories.rows: is '0', must be a whole number of at"),
        ("{variables: [angle], rows: 2.5}", "histories.rows: is '2.5', must be a whole number"),
        ("{variables: [angle], row: 2}", "row"),
    ],
)
def test_a_plan_that_does_not_say_how_many_positions_are_kept_is_refused(
    sweep, plan, tmp_path, histories, message
):
    plan.write_text(PLAN.replace("HISTORIES", histories))
    code, out, err = sweep("plan", plan, "-o", "d.h5")
    assert (code, out) == (3, "")
    assert message in err
    assert not (tmp_path / "d.h5").exists()
