"""The opening of a report: how much, when and where, against the history's own arrays."""

from __future__ import annotations

import numpy as np
import pytest
import xarray as xr
from real_gears import RealPair
from scipy.integrate import trapezoid

from evolvent.physics.extremes import extremes
from evolvent.physics.pair_positions import position_of_pair
from evolvent.physics.results import ResultRow, _largest, results
from evolvent.units import quantity


def texts(rows: list[ResultRow], label: str) -> list[str]:
    (row,) = [row for row in rows if row.label == label]
    return [cell.text if cell else "" for cell in row.cells]


def test_largest_values_are_those_of_the_outputs_where_none_are_told(friction_run):
    history = friction_run.history
    reported = results(history)
    force = history["normal_force"].values[:, 0]
    assert texts(reported.largest, "largest normal force") == [quantity(force.max(), "N", 4)]
    (row,) = [row for row in reported.largest if row.label == "largest normal force"]
    when = float(history["time"][int(force.argmax())])
    assert row.cells[0].where.startswith(f"at {quantity(when, 's', 5)}")


def test_the_largest_of_a_quantity_with_both_signs_is_the_farthest_from_0(friction_run):
    friction = friction_run.history["friction_force"].values[:, 0]
    farthest = friction[np.abs(friction).argmax()]
    reported = texts(results(friction_run.history).largest, "largest friction force")
    assert reported == [quantity(abs(float(farthest)), "N", 4)]


def test_the_largest_sliding_velocity_is_that_of_a_pair_that_carries():
    """Not of the leading pair alone, nor of a pair that waits off the path."""
    pair = RealPair()
    length = pair.path[1] - pair.path[0]
    of_pairs = pair.history(np.linspace(0.0, length / pair.base[0], 41))
    force = of_pairs["pair_normal_force"]
    slides = xr.where(force > 0, 1.0, 9.0)
    slides[20, 0, 0] = -3.0  # of pair 0
    extreme = {"sliding_velocity": (("time", "mesh"), np.full((41, 1), -2.0))}
    slides = slides.transpose(*force.dims).assign_attrs(units="m s-1")
    history = of_pairs.assign(pair_sliding_velocity=slides, **extreme)
    found = {row.label: row for row in _largest(history, extremes(history))}
    (cell,) = found["largest sliding velocity"].cells
    assert cell.text == quantity(3.0, "m/s", 4)
    assert cell.where.startswith(f"at {quantity(20.0, 's', 5)}, tooth pair 0")


@pytest.mark.parametrize(
    ("kind", "note"),
    [
        (None, ""),
        (0, "concave flanks: pressure undefined, force"),
        (2, "corner contact, no rounding given: pressure undefined, force"),
    ],
)
def test_a_largest_pressure_names_the_force_that_it_leaves_out(kind, note):
    """A pair that carries without a pressure stands on a sharp edge, or its flank is hollow."""
    pair = RealPair()
    length = pair.path[1] - pair.path[0]
    of_pairs = pair.history(np.linspace(0.0, length / pair.base[0], 41))
    force = of_pairs["pair_normal_force"]
    pressure = (1e6 * xr.where(force > 0, force, np.nan)).transpose(*force.dims)
    history = of_pairs.assign(pair_contact_kind=xr.zeros_like(force).astype(int))
    if kind is not None:
        pressure[20] = np.nan
        history["pair_contact_kind"][20] = kind
        note = f"; {note} {quantity(float(force[20].max()), 'N', 3)}"
    history = history.assign(pair_contact_pressure=pressure.assign_attrs(units="Pa"))
    found = {row.label: row for row in _largest(history, extremes(history))}
    (cell,) = found["largest contact pressure"].cells
    assert cell.where.endswith(note)
    assert ("undefined" in cell.where) == (kind is not None)


def test_without_a_window_means_and_factors_are_of_the_whole_run_and_say_so(friction_run):
    history = friction_run.history
    reported = results(history)
    force, time = history["normal_force"].values[:, 0], history["time"].values
    mean = trapezoid(force, time) / (time[-1] - time[0])
    error = history["transmission_error"].values[:, 0]
    assert "The whole run" in reported.scope
    assert texts(reported.means, "mean normal force") == [quantity(mean, "N", 4)]
    assert texts(reported.means, "dynamic factor of the mesh force") == [
        f"{force.max() / mean:.4g}"
    ]
    spread = quantity(np.ptp(error), "m", 4)
    assert texts(reported.means, "transmission error, peak to peak") == [spread]


def test_numbers_over_whole_periods_are_preferred(friction_run):
    window = {"window_begin": 1.0, "window_end": 2.0, "window_periods": 7}
    numbers = {"window_dynamic_factor": 1.25, "window_transmission_error_mean": 3e-6}
    history = friction_run.history.assign(
        {name: ((), value) for name, value in window.items()}
        | {name: ("mesh", [value]) for name, value in numbers.items()}
    )
    reported = results(history)
    assert "7 whole periods" in reported.scope
    assert texts(reported.means, "dynamic factor of the mesh force") == ["1.25"]
    assert texts(reported.means, "mean transmission error") == [quantity(3e-6, "m", 4)]
    speed = history["angular_velocity"].sel(time=slice(1.0, 2.0))
    mean = (speed.integrate("time") / float(speed.time[-1] - speed.time[0])).values
    assert texts(reported.wheels, "speed") == [quantity(v, "rad s-1", 4) for v in mean]


def test_losses_are_the_energy_that_went_over_the_time(friction_run):
    history = friction_run.history
    lost = float(history["dissipated_energy"][-1] - history["dissipated_energy"][0])
    assert results(history).lost == quantity(lost / float(history["time"][-1]), "W", 4)


def test_a_row_that_says_nothing_is_not_there(friction_run):
    reported = results(friction_run.history)
    for row in [*reported.largest, *reported.means, *reported.wheels]:
        assert any(cell is not None for cell in row.cells), row.label
    assert "torque of its shafts" not in [row.label for row in reported.wheels]


@pytest.mark.parametrize("outputs", [0, 1])
def test_less_than_two_outputs_have_no_results(friction_run, outputs):
    assert results(friction_run.history.isel(time=slice(0, outputs))) is None


@pytest.mark.parametrize("share", [0.05, 0.5, 0.95])
def test_the_place_of_a_force_between_two_outputs_is_that_of_its_pair(share):
    """In closed form: pair 0 rolls along its path by the base radius times the angle."""
    pair = RealPair()
    length = pair.path[1] - pair.path[0]
    history = pair.history(np.linspace(0.0, length / pair.base[0], 401))
    history = history.assign(pair_normal_force=history["pair_normal_force"] + 0.0)
    history["pair_normal_force"][:, 0, 0] *= 10.0  # that of pair 0
    time = 400 * share + 0.3
    position = position_of_pair(history, 0, time)
    rho = pair.path[0] + pair.penetration + length * time / 400
    assert (position.number, position.is_coast) == (0, False)
    assert position.roll_angle == pytest.approx(rho / pair.base[0], rel=1e-9)
    assert position.on_path == pytest.approx((rho - pair.path[0]) / length, rel=1e-9)


def test_the_place_of_a_coast_force_is_named(smooth_run):
    pair = RealPair(coast=True)
    history = pair.history(np.linspace(0.0, 0.1, 11))
    assert position_of_pair(history, 0, 5.0).is_coast
    assert "of the coast flanks" in position_of_pair(history, 0, 5.0).text()


def test_without_tooth_pairs_there_is_no_place(friction_run):
    assert position_of_pair(friction_run.history, 0, 1.0, "normal_force") is None
