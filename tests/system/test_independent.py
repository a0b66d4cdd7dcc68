"""Agreement of the program with the independent program of tests/reference, in every tracking."""

from __future__ import annotations

import subprocess
from pathlib import Path

import numpy as np
import pytest
import xarray as xr
from gearbox_reference import solve

from evolvent import check_history, open_events, open_history

# Claimed agreement, relative to the largest value. The independent program is accurate to 4e-9
# (measured by a smaller tolerance), the integrator at its default tolerance to 6e-7.
TOLERANCE = 1e-6
CASES = {"paper.yaml": 0.0, "paper-friction.yaml": 0.3}
TRACKINGS = ("closed_form", "algebraic", "differential")


@pytest.fixture(scope="module", params=CASES)
def case(request):
    return request.param


@pytest.fixture(scope="module")
def reference(case):
    return solve(friction=CASES[case], t_end=5.0)


@pytest.fixture(scope="module", params=TRACKINGS)
def history_file(request, case, executable, examples, tmp_path_factory) -> Path:
    path = tmp_path_factory.mktemp("independent") / "history.h5"
    setting = f"meshes.pinion-gear.tracking={request.param}"
    command = [executable, "run", examples / case, "-o", path, "--set", setting]
    subprocess.run(command, check=True, timeout=120)
    return path


@pytest.fixture(scope="module")
def history(history_file):
    with open_history(history_file) as opened:
        yield opened


def _agree(values: xr.DataArray, expected: np.ndarray) -> None:
    assert values.shape == expected.shape
    assert np.abs(values.values - expected).max() <= TOLERANCE * np.abs(expected).max()


def test_outputs_are_at_the_same_times(history, reference):
    np.testing.assert_allclose(history["time"], reference["t"], rtol=1e-14)


def test_penetration_agrees(history, reference):
    _agree(-history["gap"][:, 0], reference["h"])


def test_transmission_error_agrees(history, reference):
    _agree(history["transmission_error"][:, 0], reference["delta"])


def test_normal_force_agrees(history, reference):
    _agree(history["normal_force"][:, 0], reference["normal_force"])


def test_friction_force_agrees(history, reference):
    expected = reference["friction_force"]
    largest = max(np.abs(expected).max(), np.abs(reference["normal_force"]).max())
    difference = history["friction_force"][:, 0].values - expected
    assert np.abs(difference).max() <= TOLERANCE * largest


@pytest.mark.parametrize(("wheel", "name"), [("pinion", "omega_a"), ("gear", "omega_b")])
def test_speeds_agree(history, reference, wheel, name):
    _agree(history["angular_velocity"].sel(wheel=wheel), reference[name])


def test_slider_displacement_agrees(history, reference):
    _agree(history["centre_displacement"].sel(wheel="gear", axis="x"), reference["slider"])


@pytest.mark.parametrize("name", ["load_work", "dissipated_energy"])
def test_work_agrees(history, reference, name):
    _agree(history[name], reference[name.removesuffix("_energy")])


def test_teeth_change_at_the_same_instants(history_file, reference):
    with open_events(history_file) as events:
        switches = events["time"].values[events["kind"].values == "tooth_switch"]
    # 1e-9 of the angle of a pitch, at 0.2 rad/s.
    np.testing.assert_allclose(switches, reference["switch_times"], rtol=0, atol=1e-8)


def test_friction_changes_its_law_as_often_and_at_the_same_instants(history_file, reference):
    with open_events(history_file) as events:
        kinks = events["time"].values[
            np.isin(events["kind"].values, ["sliding_began", "sliding_ended"])
        ]
    expected = [t for t, name, _ in reference["events"] if name in ("above", "below")]
    # The sliding velocity crosses delta slowly: different trackings agree to 2e-6 s.
    np.testing.assert_allclose(kinks, expected, rtol=0, atol=2e-6)


def test_no_invariant_is_broken(history):
    broken = [verdict for verdict in check_history(history) if verdict.failed]
    assert broken == []
