"""Summaries of folders whose journals are known: what is in them, and what they say is not."""

from __future__ import annotations

import re
from dataclasses import replace

import h5py
import netCDF4
import numpy as np
import pandas as pd
import pytest
import xarray as xr
from sweeps import (
    BEGAN,
    failed,
    header,
    line_of,
    make_design,
    row,
    write_histories,
    write_journal,
)

import machine
from evolvent.checksums import append_checksum
from evolvent.errors import SweepError
from evolvent.sweep.collect import collect
from evolvent.sweep.design import Parameter, write_design
from evolvent.sweep.figures import varying_parameters
from evolvent.sweep.journal import Counts


def opened(path, **options) -> xr.Dataset:
    with xr.open_dataset(path, engine="h5netcdf", **options) as summary:
        return summary.load()


def test_a_summary_has_parameters_results_and_status_of_every_case(tmp_path):
    laws = np.array(["none", "tanh", "none", "tanh"], dtype=object)
    design = make_design({"load": [1.0, 2.0, 3.0, 4.0], "teeth": [20, 21, 22, 23], "law": laws})
    write_journal(tmp_path / "d", design, [row(2), failed(1), row(0)])
    found = collect(tmp_path / "d", design, tmp_path / "s.h5")
    assert (found.counts, found.holes.tolist()) == (Counts(2, 1, 0, 1), [3])
    summary = opened(tmp_path / "s.h5")
    assert summary["case"].values.tolist() == [0, 1, 2, 3]
    assert summary["load"].values.tolist() == [1.0, 2.0, 3.0, 4.0]
    assert summary["teeth"].dtype == np.int64
    assert summary["law"].values.tolist() == laws.tolist()
    np.testing.assert_array_equal(summary["penetration_max"], [1e-9, np.nan, 3e-9, np.nan])
    np.testing.assert_array_equal(summary["status"], [1, 2, 1, 0])
    assert summary["status"].attrs["flag_meanings"] == "missing done failed refused"
    assert summary["message"].values.tolist() == ["", "contact was lost", "", ""]
    assert summary["exit_code"].values.tolist() == [0, 4, 0, -1]
    np.testing.assert_array_equal(summary["recorded_at"], BEGAN + np.array([0, 1, 2, np.nan]))
    assert summary["penetration_max"].attrs["units"] == "m"
    assert summary["penetration_max"].attrs["long_name"] == "largest penetration"
    assert summary["load"].attrs["units"] == "N"
    assert summary["load"].attrs["path"] == "some.load"
    assert summary.attrs["case"] == design.case
    assert summary.attrs["plan"] == "a plan"
    assert list(summary)[:4] == ["load", "teeth", "law", "penetration_max"]


def test_a_column_that_follows_from_others_says_so_in_the_summary_and_is_not_drawn_against(
    tmp_path,
):
    chosen = Parameter("load", "some.load", "N", np.array([1.0, 3.0, 2.0]))
    squared = Parameter("squared", "some.other", "N2", np.array([4.0, 1.0, 9.0]), derived=True)
    design = replace(make_design(3), parameters=(chosen, squared))
    write_journal(tmp_path / "d", design, [row(0), row(1), row(2)])
    collect(tmp_path / "d", design, tmp_path / "s.h5")
    summary = opened(tmp_path / "s.h5")
    assert [int(summary[name].attrs["derived"]) for name in ("load", "squared")] == [0, 1]
    assert varying_parameters(summary) == ["load"]


def test_the_netcdf_library_reads_a_summary_as_well(tmp_path):
    design = make_design(3)
    write_journal(tmp_path / "d", design, [row(0), row(1), row(2)])
    collect(tmp_path / "d", design, tmp_path / "s.h5")
    with netCDF4.Dataset(tmp_path / "s.h5") as summary:
        assert summary.dimensions["case"].size == 3
        assert summary["load"].dimensions == ("case",)
        assert summary["steps"][:].tolist() == [100.0, 101.0, 102.0]


def test_lines_that_were_cut_off_do_not_count(tmp_path):
    design = make_design(5)
    path = write_journal(tmp_path / "d", design, [row(0), row(1)])
    whole = path.read_text()
    head = whole.splitlines()[0]
    torn = line_of(row(3), head)
    # Cut off, then terminated by a resumed run; and the last line without its newline.
    path.write_text(whole + torn[:40] + "\n" + line_of(row(2), head) + "\n" + torn)
    found = collect(tmp_path / "d", design, tmp_path / "s.h5")
    assert (found.counts.done, found.torn, found.holes.tolist()) == (3, 2, [3, 4])


@pytest.mark.parametrize("cut", range(0, 60, 7))
def test_a_journal_may_end_anywhere(tmp_path, cut):
    design = make_design(5)
    path = write_journal(tmp_path / "d", design, [row(0), row(1)])
    path.write_bytes(path.read_bytes()[: len(path.read_bytes()) - cut])
    found = collect(tmp_path / "d", design, tmp_path / "s.h5")
    assert found.counts.done == (2 if cut == 0 else 1)
    assert found.torn == (0 if cut == 0 else 1)


def test_an_empty_folder_gives_a_summary_of_holes(tmp_path):
    design = make_design(4)
    (tmp_path / "d").mkdir()
    found = collect(tmp_path / "d", design, tmp_path / "s.h5")
    assert found.holes.tolist() == [0, 1, 2, 3]
    assert opened(tmp_path / "s.h5")["status"].values.tolist() == [0] * 4


def test_of_repeated_records_the_latest_counts_whatever_journal_has_it(tmp_path):
    design = make_design(4)
    again = row(1, steps=7, at=BEGAN + 100)
    write_journal(tmp_path / "d", design, [row(0), failed(1), row(2), again])
    other = [row(1, steps=8, at=BEGAN + 50), row(3, at=BEGAN + 1)]
    write_journal(tmp_path / "d", design, other, shard=2, of=2)
    found = collect(tmp_path / "d", design, tmp_path / "s.h5")
    assert found.repeated.tolist() == [1]
    assert found.holes.tolist() == []
    summary = opened(tmp_path / "s.h5")
    assert summary["steps"].values.tolist() == [100.0, 7.0, 102.0, 103.0]
    assert summary["status"].values.tolist() == [1, 1, 1, 1]


def test_shards_give_the_summary_that_one_journal_gives(tmp_path):
    design = make_design(11)
    rows = [failed(i) if i == 4 else row(i) for i in range(11)]
    write_journal(tmp_path / "one", design, rows[::-1])
    for shard in (1, 2, 3):
        write_journal(tmp_path / "three", design, rows[shard - 1 :: 3], shard, 3)
    for name in ("one", "three"):
        collect(tmp_path / name, design, tmp_path / f"{name}.h5")
    xr.testing.assert_identical(opened(tmp_path / "one.h5"), opened(tmp_path / "three.h5"))


def test_histories_of_which_one_bit_turned_are_refused_and_whole_ones_are_not(tmp_path):
    design = make_design(3, history_variables=("normal_force",))
    write_journal(tmp_path / "d", design, [row(i) for i in range(3)])
    write_histories(tmp_path / "d", design, [0, 1, 2], 1, 1)
    path = tmp_path / "d" / "shard-1-of-1.h5"
    append_checksum(path)
    collect(tmp_path / "d", design, tmp_path / "s.h5")
    content = bytearray(path.read_bytes())
    content[content.index(np.float32(211.0).tobytes())] ^= 1  # case 2, output 1, mesh 1
    path.write_bytes(content)
    with pytest.raises(SweepError) as refused:
        collect(tmp_path / "d", design, tmp_path / "t.h5")
    assert str(refused.value) == (
        f"{path}: is damaged, or was changed: its checksum is wrong; run its cases again in "
        "another folder"
    )
    assert not (tmp_path / "t.h5").exists()


@pytest.mark.parametrize("copy", [False, True], ids=["virtual", "copied"])
def test_histories_come_from_the_shard_that_has_the_case(tmp_path, copy):
    design = make_design(7, history_variables=("normal_force",))
    for shard in (1, 2, 3):
        cases = list(range(shard - 1, 7, 3))
        write_journal(tmp_path / "d", design, [row(i) for i in cases], shard, 3)
        write_histories(tmp_path / "d", design, cases, shard, 3)
    (tmp_path / "out").mkdir()
    collect(tmp_path / "d", design, tmp_path / "out" / "s.h5", copy_histories=copy)
    summary = opened(tmp_path / "out" / "s.h5", decode_times=False)
    force = summary["normal_force"]
    assert force.dims == ("case", "time", "mesh")
    assert force.dtype == np.float32
    assert force.attrs["units"] == "N"
    expected = 100 * force["case"] + 10 * force["time"] + force["mesh"]
    np.testing.assert_array_equal(force, expected)
    with h5py.File(tmp_path / "out" / "s.h5") as file:
        assert file["normal_force"].is_virtual is not copy


def test_virtual_histories_are_found_after_the_folders_moved_together(tmp_path):
    design = make_design(2, history_variables=("normal_force",))
    write_journal(tmp_path / "a" / "d", design, [row(0), row(1)])
    write_histories(tmp_path / "a" / "d", design, [0, 1], 1, 1)
    collect(tmp_path / "a" / "d", design, tmp_path / "a" / "s.h5")
    (tmp_path / "a").rename(tmp_path / "b")
    summary = opened(tmp_path / "b" / "s.h5", decode_times=False)
    assert summary["normal_force"].values[1, 3, 1] == 131.0


def test_histories_of_two_splits_come_from_the_shard_whose_record_counts(tmp_path):
    design = make_design(4, history_variables=("normal_force",))
    write_journal(tmp_path / "d", design, [row(0), row(1)])
    write_histories(tmp_path / "d", design, [0, 1, 2, 3], 1, 1)
    write_journal(tmp_path / "d", design, [row(1, at=BEGAN + 99), row(3)], 2, 2)
    write_histories(tmp_path / "d", design, [1, 3], 2, 2)
    with h5py.File(tmp_path / "d" / "shard-2-of-2.h5", "r+") as file:
        file["normal_force"][...] += 5000
    collect(tmp_path / "d", design, tmp_path / "s.h5")
    force = opened(tmp_path / "s.h5", decode_times=False)["normal_force"][:, 0, 0]
    np.testing.assert_array_equal(force, [0.0, 5100.0, np.nan, 5300.0])


def test_a_parquet_copy_has_all_that_has_one_value_a_case(tmp_path):
    machine.module("pyarrow")
    design = make_design(3)
    write_journal(tmp_path / "d", design, [row(0), failed(1)])
    collect(tmp_path / "d", design, tmp_path / "s.h5", parquet=tmp_path / "s.parquet")
    table = pd.read_parquet(tmp_path / "s.parquet")
    assert table["status"].tolist() == ["done", "failed", "missing"]
    assert table["load"].tolist() == [1.0, 1.5, 2.0]
    np.testing.assert_array_equal(table["steps"], [100.0, np.nan, np.nan])


def test_a_parameter_with_the_name_of_a_result_keeps_its_values(tmp_path):
    design = make_design({"steps": [3, 4]})
    write_journal(tmp_path / "d", design, [row(0), row(1)])
    collect(tmp_path / "d", design, tmp_path / "s.h5")
    summary = opened(tmp_path / "s.h5")
    assert summary["steps_parameter"].values.tolist() == [3, 4]
    assert summary["steps"].values.tolist() == [100.0, 101.0]


def test_a_journal_of_another_design_or_format_is_refused(tmp_path):
    design = make_design(3)
    for changes, message in (
        ({"design": "0" * 64}, "is of another design (its hash is 000000000000"),
        ({"journal": 1}, "has journal format 1"),
    ):
        path = write_journal(tmp_path / "d", design, [row(0)])
        path.write_text(line_of({**header(design), **changes}) + "\n")
        with pytest.raises(SweepError, match=re.escape(message)):
            collect(tmp_path / "d", design, tmp_path / "s.h5")
    assert not list(tmp_path.glob("s.h5*"))


@pytest.mark.parametrize(
    ("line", "message"),
    [
        (row(3), "has case 3, but the design has 3"),
        (row(0, status="dunno"), "case 0: the status 'dunno' is unknown"),
    ],
)
def test_a_record_that_cannot_be_is_refused(tmp_path, line, message):
    design = make_design(3)
    write_journal(tmp_path / "d", design, [line])
    with pytest.raises(SweepError, match=re.escape(message)):
        collect(tmp_path / "d", design, tmp_path / "s.h5")


def test_holes_and_repeated_cases_are_told_by_number_and_are_no_error(sweep, tmp_path):
    design = make_design(40)
    rows = [row(i) for i in range(40) if i not in (3, 7, 8, 9, 39)]
    write_journal(tmp_path / "d", design, [*rows, row(5, at=BEGAN + 900)])
    code, out, err = sweep("collect", "d", "-o", "s.h5")
    assert (code, err) == (0, "")
    assert out.splitlines() == [
        "s.h5: 40 cases: 35 done, 0 did not finish, 5 missing",
        "missing: 3, 7-9, 39",
        "recorded more than once, the latest is used: 5",
    ]


def test_a_folder_of_another_design_is_refused(sweep, tmp_path):
    write_journal(tmp_path / "d", make_design(3), [row(0)])
    write_design(make_design(4), tmp_path / "other.h5")
    for command in (("collect", "d", "-o", "s.h5"), ("status", "d")):
        code, out, err = sweep(*command, "--design", "other.h5")
        assert (code, out) == (3, "")
        assert err.startswith("evolvent-sweep: d: holds results of another design (its hash is ")
        assert err.count("\n") == 1


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (("collect", "none", "-o", "s.h5"), "none: no such folder"),
        (("collect", "empty", "-o", "s.h5"), "empty: has no design.h5; name the design"),
        (("retry", "none", "--failed"), "none: no such folder; it contains no runs"),
        (("retry", "empty", "--case", "1"), "empty: has no design.h5; it contains no runs"),
        (("collect", "d", "-o", "no/s.h5"), "no/s.h5: cannot be written"),
        (("plot", "none.h5"), "none.h5: no such file; make it with"),
        (("plot", "d/design.h5"), "is not a summary"),
        (("plot", "d/design.txt"), "is not a readable summary"),
    ],
)
def test_what_is_not_there_is_one_line(sweep, tmp_path, arguments, message):
    (tmp_path / "empty").mkdir()
    write_journal(tmp_path / "d", make_design(3), [row(0)])
    code, out, err = sweep(*arguments)
    assert code == (74 if "written" in message else 3)
    assert out == ""
    assert message in err
    assert err.count("\n") == 1
