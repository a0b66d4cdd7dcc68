"""Lines of known signals: amplitudes and phases of orders and frequencies."""

from __future__ import annotations

import numpy as np
import pytest
import xarray as xr
from signal_histories import START, TEETH, by_angle, signal_history, steady

from evolvent.commands.post.spectrum import largest, make_spectrum
from evolvent.signals.resampling import REACH, loss, resample
from evolvent.signals.sampling import counted_over, read_record
from evolvent.signals.selection import select
from evolvent.signals.spectrum import line_at, line_spectrum, peaks
from evolvent.signals.window_names import WINDOWS
from evolvent.signals.windows import measures, noise_bandwidth, window

ORDERS = {1: (5e-7, 0.3), 2: (2e-7, -2.9), 5: (3e-8, 1.7)}  # amplitude [m], phase [rad]
MEAN = 1e-5
EXACT = 1e-9  # of the largest line, as the issue asks


def orders(xi: np.ndarray, lines: dict = ORDERS, mean: float = MEAN) -> np.ndarray:
    return mean + sum(a * np.cos(2 * np.pi * n * xi - p) for n, (a, p) in lines.items())


def spectrum(history: xr.Dataset, order_of: str | None = None, **more) -> xr.Dataset:
    options = {"periods": None, "shape": None, "highest": None, **more}
    signal = select(history, options.pop("quantity", "transmission_error"), {})
    return make_spectrum(history, signal, order_of, *options.values())


def assert_lines(found: xr.Dataset, lines: dict, bound: float, mean: float = MEAN) -> None:
    """Lines as they are, and nothing else."""
    top = max(a for a, _ in lines.values())
    assert found["amplitude"][0] == pytest.approx(mean, rel=bound)
    rest = found["amplitude"].values.copy()
    rest[0] = 0.0
    for order, (amplitude, phase) in lines.items():
        one = found.sel(order=order, method="nearest")
        assert float(one["order"]) == pytest.approx(order, rel=1e-12)
        assert float(one["amplitude"]) == pytest.approx(amplitude, abs=bound * top)
        error = np.angle(np.exp(1j * (float(one["phase"]) - phase)))
        assert abs(error) < bound * top / amplitude
        rest[int(np.argmin(abs(found["order"].values - order)))] = 0.0
    assert rest.max() < bound * top


@pytest.mark.parametrize("rows", [12, 13], ids=["even", "odd"])
@pytest.mark.parametrize("first", [0.0, 0.5, 1 / 3, 17.0])
def test_orders_of_rows_by_angle_are_exact_wherever_the_record_begins(rows, first):
    xi = np.ceil(first * rows) / rows + np.arange(23 * rows + 5) / rows
    history = by_angle("pitch", "pinion-gear", rows, xi, orders(xi))
    found = spectrum(history)
    assert found.attrs["sampling"] == "rows without resampling"
    assert found.attrs["periods"] == "23 pitches"
    assert_lines(found, ORDERS, EXACT)


def test_rows_by_pitch_give_orders_of_both_wheels_without_resampling():
    xi = np.arange(0, 34 * 19 + 1, 1 / 12)
    turns = {"pinion": (xi - START) / 19, "gear": (xi - START) / 34}
    for wheel, z in zip(("pinion", "gear"), TEETH, strict=True):
        lines = {1: (4e-6, 0.7), z: (5e-7, -1.0), 2 * z + 1: (1e-7, 2.0)}
        history = by_angle("pitch", "pinion-gear", 12, xi, orders(turns[wheel], lines))
        found = spectrum(history, wheel)
        assert found.attrs["sampling"] == "rows without resampling"
        assert_lines(found, lines, EXACT)


def test_rows_by_turn_give_orders_of_the_mesh_with_phases_from_the_start_of_contact():
    u = np.arange(0, 3, 1 / (19 * 12))
    xi = u * 19 + START
    found = spectrum(by_angle("turn", "pinion", 19 * 12, u, orders(xi)), "pinion-gear")
    assert_lines(found, ORDERS, EXACT)


def test_rows_by_turn_that_are_not_whole_ones_of_another_wheel_are_resampled():
    u = np.arange(0, 68, 1 / 40)  # turns of the pinion: a gear's turn is 40*34/19 rows
    history = by_angle("turn", "pinion", 40, u, orders(u * 19 / 34, {1: (1e-6, 0.4)}))
    found = spectrum(history, "gear")
    assert found.attrs["periods"] == "37 turns"
    assert "spline" in found.attrs["sampling"]
    assert_lines(found, {1: (1e-6, 0.4)}, EXACT)


@pytest.mark.parametrize("ratio", [40.0, 41.3])
def test_orders_of_rows_by_time_at_a_steady_speed_are_exact(ratio):
    # 5 orders: 8 rows a period of the highest line, where the spline takes 1.7e-7 of it, 1e-8 of
    # the largest; of whole rows a pitch nothing is interpolated
    rate = 500.0
    history = steady(rate, 1 / (rate * ratio), 0.1, orders)
    found = spectrum(history, "pinion-gear")
    assert ("spline" in found.attrs["sampling"]) == (ratio != 40.0)
    assert_lines(found, ORDERS, 3e-8 if ratio != 40.0 else EXACT)


def test_frequencies_of_orders_are_those_at_the_mean_speed():
    found = spectrum(steady(500.0, 5e-5, 0.1, orders), "pinion-gear")
    np.testing.assert_allclose(found["frequency"], 500.0 * found["order"], rtol=1e-9)
    assert float(found["speed"]) == pytest.approx(2 * np.pi * 500 / 19, rel=1e-9)


def test_orders_of_a_run_up_are_exact_where_rows_are_many():
    time = np.linspace(0.0, 1.0, 40001)
    turns = 5.0 * time + 20.0 * time**2  # 5 to 45 rev/s: 47 rows a pitch at the end
    xi = 19 * turns + START
    found = spectrum(signal_history(time, turns, orders(xi)), "pinion-gear", highest=10.0)
    assert_lines(found, ORDERS, 1e-8)


def test_a_run_against_the_nominal_sense_has_the_same_orders():
    time = np.linspace(0.0, 0.1, 4001)
    turns = -500.0 / 19 * time
    found = spectrum(signal_history(time, turns, orders(19 * turns + START)), "pinion-gear")
    assert_lines(found, ORDERS, 1e-8)


@pytest.mark.parametrize("name", list(WINDOWS))
@pytest.mark.parametrize("samples", [1000, 1001])
def test_a_sine_on_a_line_reads_as_high_as_it_is_with_every_window(name, samples):
    # Side lobes of the window's zeros: every other line within the main lobe only.
    step = 1e-4
    time = 0.37 + step * np.arange(samples)
    frequency = 40 / (samples * step)
    lines = line_spectrum(
        3.0 + 2.0 * np.cos(2 * np.pi * frequency * time - 1.1), time[0], step,
        window(name, samples),
    )  # fmt: skip
    assert lines.abscissa[40] == pytest.approx(frequency, rel=1e-12)
    assert lines.amplitude[40] == pytest.approx(2.0, rel=1e-9)
    assert lines.phase[40] == pytest.approx(1.1, abs=1e-9)
    assert lines.amplitude[0] == pytest.approx(3.0, rel=1e-9)
    far = abs(np.arange(lines.abscissa.size) - 40) >= measures(name).half_width
    far[0] = False
    assert lines.amplitude[far].max() < 1e-9


@pytest.mark.parametrize("name", list(WINDOWS))
def test_a_sine_between_two_lines_reads_low_by_what_the_table_says(name):
    samples, step = 1000, 1e-4
    time = step * np.arange(samples)
    between = np.cos(2 * np.pi * 40.5 / (samples * step) * time - 0.4)
    lines = line_spectrum(between, 0.0, step, window(name, samples))
    reported = measures(name)
    # its mirror image at -40.5 lines leaks 81 lines further: 1/81 of a rectangle's side lobes
    image = 1 / (np.pi * 81) if name == "rectangular" else 1e-3
    assert 1 - lines.amplitude[40:42].max() == pytest.approx(reported.reads_low, abs=image)
    far = abs(np.arange(lines.abscissa.size) - 40.5) > reported.half_width
    assert lines.amplitude[far].max() < reported.leakage + image


def test_noise_bandwidths_are_those_of_the_books():
    # F. J. Harris 1978, table 1; of flattop D'Antona and Ferrero
    for name, expected in (
        ("rectangular", 1.0), ("hann", 1.5), ("hamming", 1.36), ("blackman", 1.73),
        ("blackmanharris", 2.0), ("flattop", 3.77),
    ):  # fmt: skip
        assert noise_bandwidth(window(name, 4096)) == pytest.approx(expected, abs=0.006)


def test_white_noise_reads_by_its_noise_bandwidth():
    generator = np.random.default_rng(1)
    noise = generator.normal(0.0, 1.0, 2**16)
    for name in ("rectangular", "hann", "flattop"):
        weights = window(name, 256)
        parts = noise.reshape(-1, 256)
        power = np.mean(
            [line_spectrum(p, 0.0, 1.0, weights).amplitude[30:100] ** 2 / 2 for p in parts]
        )
        # of a density of 2 a line's spacing over 256: noise bandwidth times the spacing;
        # 256 parts of some 20 independent lines: 1/sqrt(5000) = 1.4 %
        assert power * 128 == pytest.approx(noise_bandwidth(weights), rel=0.05)


def test_the_line_at_half_the_sampling_rate_counts_once():
    values = np.array([1.0, -1.0] * 8)
    lines = line_spectrum(values, 0.0, 0.5, window("rectangular", 16))
    assert (lines.abscissa[-1], lines.amplitude[-1]) == (1.0, pytest.approx(1.0, rel=1e-12))


def test_a_line_anywhere_is_the_transform_there():
    xi = np.arange(480) / 24 + 0.25
    values = orders(xi)
    for n, (amplitude, phase) in ORDERS.items():
        line = line_at(values, 0.25, 1 / 24, window("rectangular", 480), n)
        assert line == pytest.approx(amplitude * np.exp(-1j * phase), abs=EXACT * 5e-7)


def test_the_largest_lines_are_peaks_by_size_without_the_mean():
    xi = np.arange(240) / 24
    lines = line_spectrum(orders(xi), 0.0, 1 / 24, window("hann", 240))
    assert [round(lines.abscissa[i]) for i in peaks(lines, 3)] == [1, 2, 5]


@pytest.mark.parametrize("rows", [3.0, 4.0, 6.5, 10.0])
def test_interpolation_takes_what_it_is_said_to(rows):
    # 200 periods in the middle of 400 and more: what the ends do fades with each row
    position = np.arange(4001) / rows
    positions = 100.0 + np.arange(200 * 64) / 64
    values = resample(position, np.cos(2 * np.pi * position)[:, None], positions)[:, 0]
    line = line_at(values, 100.0, 1 / 64, np.ones(positions.size), 1.0)
    assert 1 - abs(line) == pytest.approx(loss(rows), rel=2e-3, abs=1e-11)


def test_lines_are_told_up_to_where_interpolation_takes_one_percent():
    assert loss(1 / REACH) == pytest.approx(0.01, rel=0.05)


def test_frequencies_are_those_of_the_rows_without_the_last_off_the_grid():
    history = steady(500.0, 1e-4, 0.2, lambda xi: orders(xi - START))
    end = history.isel(time=[-1]).assign_coords(time=[0.20003])
    found = spectrum(
        xr.concat([history, end], "time", data_vars="minimal", coords="minimal", compat="override"),
        shape="flattop",
    )
    assert found.attrs["samples"] == 2001
    at = found.sel(frequency=500.0, method="nearest")
    assert float(at["amplitude"]) == pytest.approx(5e-7, rel=1e-3)  # flattop reads 0.1 % low
    assert found.attrs["window"] == "flattop"
    assert float(found["noise_bandwidth"]) == pytest.approx(3.77 / 0.2001, rel=1e-3)


def test_the_record_of_an_order_is_the_last_whole_periods():
    history = steady(500.0, 5e-5, 0.1, orders)
    found = spectrum(history, "pinion-gear", periods=7)
    assert found.attrs["periods"] == "7 pitches"
    assert found.attrs["end"] == pytest.approx(0.1, abs=1e-12)
    assert found.attrs["begin"] == pytest.approx(0.1 - 7 / 500 + 5e-5, abs=1e-9)
    assert_lines(found, ORDERS, EXACT)


def test_pitches_are_counted_from_the_start_of_contact_of_pair_0():
    history = steady(500.0, 5e-5, 0.01, orders)
    of = counted_over(history, "pinion-gear")
    assert of.start == pytest.approx(START, abs=1e-12)
    record = read_record(history, history["transmission_error"][:, 0], of)
    assert record.first == pytest.approx(START, abs=1e-12)


def test_the_table_has_the_largest_lines_of_a_spectrum():
    found = spectrum(steady(500.0, 5e-5, 0.1, orders), "pinion-gear")
    assert [round(float(found["order"][i])) for i in largest(found, 3)] == [1, 2, 5]
