"""Opening histories: what is given back, and what is refused in which words."""

from __future__ import annotations

import fcntl
import shutil
from pathlib import Path

import h5py
import numpy as np
import pytest
import xarray as xr
from synthetic import write_history

from evolvent import HistoryError, open_events, open_history, run_warning


def test_history_comes_back_as_it_was_written(friction_run):
    with open_history(friction_run.path) as history:
        xr.testing.assert_identical(history.load(), friction_run.history)


def test_every_variable_has_units_and_a_long_name(friction_run):
    with open_history(friction_run.path) as history:
        for name, variable in history.data_vars.items():
            assert {"units", "long_name", "symbol"} <= set(variable.attrs), name


def test_times_stay_numbers_of_seconds(friction_run):
    with open_history(friction_run.path) as history:
        assert history["time"].dtype == np.float64
        assert history["time"].attrs["units"] == "s"


def test_selection_by_names_and_time_works(friction_run):
    with open_history(friction_run.path) as history:
        speed = history["angular_velocity"].sel(wheel="gear").interp(time=1.0005)
        around = friction_run.history["angular_velocity"].sel(wheel="gear")[1000:1002]
        assert float(speed) == pytest.approx(float(around.mean()), rel=1e-12)


def test_event_kinds_are_decoded_to_names(friction_run, kinds):
    events = open_events(friction_run.path)
    expected = [kinds[k] for k in friction_run.events["kind"].values]
    assert events["kind"].values.tolist() == expected
    assert expected.count("tooth_switch") == 1


def test_events_have_the_state_on_both_sides(friction_run):
    events = open_events(friction_run.path)
    assert events["reference_angle"].dims == ("event", "side")
    assert events["side"].values.tolist() == ["before", "after"]
    assert events["time"].dims == ("event",)


def test_a_run_without_events_has_an_empty_group(smooth_run):
    assert open_events(smooth_run.path).sizes["event"] == 0


def test_an_unknown_event_kind_keeps_its_number(friction_run, tmp_path):
    events = friction_run.events.copy(deep=True)
    events["kind"][0] = 99
    path = write_history(tmp_path / "a.h5", friction_run.history, events)
    assert open_events(path)["kind"].values[0] == "kind_99"


def test_a_finished_run_has_no_warning(friction_run):
    assert run_warning(friction_run.history) is None


def test_an_unfinished_run_says_why_and_how_far_it_came(friction_run, tmp_path):
    history = friction_run.history.isel(time=slice(0, 101)).assign_attrs(
        status="failed", status_message="failed at t = 0.1005 s: h = 1e-3 m is beyond limit (15)"
    )
    path = write_history(tmp_path / "a.h5.partial", history, friction_run.events)
    with open_history(path) as opened:
        assert run_warning(opened) == (
            "the run did not finish: failed at t = 0.1005 s: h = 1e-3 m is beyond limit (15) "
            "(last output at t = 0.1 s)"
        )


@pytest.mark.parametrize("status", ["running", None])
def test_a_history_that_was_never_closed_says_so(friction_run, status):
    history = friction_run.history.isel(time=slice(0, 0)).assign_attrs(status=status)
    if status is None:
        del history.attrs["status"]
    assert run_warning(history) == (
        "the run is still active or was killed: its file was not closed (there is no output)"
    )


def test_a_finished_run_that_lost_contact_says_so(friction_run):
    message = "mesh pinion-gear lost contact at t = 1 s and did not regain it"
    assert run_warning(friction_run.history.assign_attrs(status_message=message)) == message


def test_a_missing_file_is_named(tmp_path):
    with pytest.raises(HistoryError, match=r"nothing\.h5: no such file$"):
        open_history(tmp_path / "nothing.h5")


def test_a_missing_file_with_a_partial_one_beside_it_points_there(tmp_path):
    (tmp_path / "run.h5.partial").touch()
    with pytest.raises(HistoryError, match=r"no such file; .* there is run\.h5\.partial"):
        open_history(tmp_path / "run.h5")


def test_a_folder_is_refused(tmp_path):
    with pytest.raises(HistoryError, match="is a folder"):
        open_history(tmp_path)


@pytest.mark.parametrize("content", [b"", b"time,h\n0,0\n"])
def test_a_file_that_is_not_hdf5_is_refused(tmp_path, content):
    path = tmp_path / "table.h5"
    path.write_bytes(content)
    with pytest.raises(HistoryError, match=r"table\.h5: is not a readable HDF5 file"):
        open_history(path)


def test_a_truncated_history_is_refused(friction_run, tmp_path):
    path = tmp_path / "cut.h5"
    path.write_bytes(friction_run.path.read_bytes()[:5000])
    with pytest.raises(HistoryError, match=r"cut\.h5: is not a readable HDF5 file"):
        open_history(path)


def test_a_history_of_which_a_name_cannot_be_read_is_refused(smooth_run, tmp_path, monkeypatch):
    path = write_history(tmp_path / "a.h5", smooth_run.history, smooth_run.events)

    def lose_a_name(*_, **__):
        None.split("/")  # as h5netcdf does where HDF5 reads no name

    monkeypatch.setattr("xarray.open_dataset", lose_a_name)
    with pytest.raises(HistoryError, match=r"a\.h5: is not a readable HDF5 file \(a name in it"):
        open_history(path)


def test_a_history_that_is_being_written_is_not_called_broken(smooth_run, tmp_path):
    path = write_history(tmp_path / "a.h5.partial", smooth_run.history, smooth_run.events)
    with path.open("rb+") as writer:
        fcntl.flock(writer, fcntl.LOCK_EX | fcntl.LOCK_NB)  # as a running evolvent holds it
        with pytest.raises(HistoryError, match=r"a\.h5\.partial: is being written; wait"):
            open_history(path)


def test_another_hdf5_file_is_no_history(tmp_path):
    path = tmp_path / "other.h5"
    with h5py.File(path, "w") as file:
        file["x"] = np.arange(3.0)
    with pytest.raises(HistoryError, match="is not an evolvent history"):
        open_history(path)


def _with_format(run, path: Path, number) -> Path:
    return write_history(path, run.history.assign_attrs(evolvent_format=number), run.events)


def test_a_newer_format_is_refused(smooth_run, tmp_path):
    path = _with_format(smooth_run, tmp_path / "new.h5", 2)
    with pytest.raises(HistoryError, match=r"has format 2, .* up to 1; use a newer evolvent"):
        open_history(path)


@pytest.mark.parametrize("number", [0, -1, 1.5, "one"])
def test_a_format_that_is_no_number_is_refused(smooth_run, tmp_path, number):
    path = _with_format(smooth_run, tmp_path / "odd.h5", number)
    with pytest.raises(HistoryError, match="is not a format number"):
        open_history(path)


def test_a_history_without_wheels_is_refused(smooth_run, tmp_path):
    path = write_history(tmp_path / "a.h5", smooth_run.history.drop_dims("wheel"), None)
    with pytest.raises(HistoryError, match="no dimension wheel"):
        open_history(path)


def test_a_history_without_events_is_refused_by_open_events(smooth_run, tmp_path):
    path = write_history(tmp_path / "a.h5", smooth_run.history, None)
    with pytest.raises(HistoryError, match="no readable group `events`"):
        open_events(path)


def test_events_that_are_closed_let_go_of_their_file(friction_run, tmp_path):
    path = tmp_path / "own.h5"
    shutil.copyfile(friction_run.path, path)
    with open_events(path) as events:
        assert path in open_files()
        assert events.sizes["event"] > 0
    assert path not in open_files()


def open_files() -> set[Path]:
    """What this process has open."""
    return {link.resolve() for link in Path("/proc/self/fd").iterdir()}
