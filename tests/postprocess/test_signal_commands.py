"""evolvent-post spectrum, waterfall and sidebands: files, tables, and what is refused."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest
import xarray as xr
from signal_histories import START, by_angle, signal_history, steady, written
from signal_results import orders, run_up
from static_curves import static_curves

from evolvent.history import open_result

COMMANDS = ("spectrum", "waterfall", "sidebands")
ORDERS = ("--order-of", "pinion-gear")


@pytest.fixture(scope="module")
def steady_file(tmp_path_factory) -> Path:
    return written(
        tmp_path_factory.mktemp("steady") / "steady.h5", steady(500.0, 5e-5, 0.1, orders)
    )


@pytest.fixture(scope="module")
def angle_file(tmp_path_factory) -> Path:
    xi = np.arange(0, 40, 1 / 16)
    return written(
        tmp_path_factory.mktemp("angle") / "angle.h5",
        by_angle("pitch", "pinion-gear", 16, xi, orders(xi)),
    )


def test_spectrum_shows_the_largest_lines_with_what_was_done(post, steady_file):
    code, out, err = post("spectrum", steady_file, *ORDERS, "--lines", "3")
    assert (code, err) == (0, "")
    assert "50 pitches of mesh pinion-gear at 500 Hz, 1578.95 rpm of pinion; rows without" in out
    assert "rectangular window" in out
    assert "noise bandwidth 0.02 orders" in out
    rows = [line.split() for line in out.splitlines()[-4:]]
    assert rows == [
        ["mean", "10", "µm"],
        ["1", "500", "Hz", "500", "nm", "57.3°"],
        ["2", "1000", "Hz", "200", "nm", "114.6°"],
        ["5", "2500", "Hz", "30", "nm", "-73.5°"],
    ]


def test_spectrum_writes_numbers_that_xarray_reads_and_plot_draws(post, angle_file):
    code, out, _ = post("spectrum", angle_file, "-o", "a.h5", "-o", "a.svg")
    assert (code, out.splitlines()[-2:]) == (0, ["a.h5", "a.svg"])
    with xr.open_dataset("a.h5", engine="h5netcdf") as found:
        assert found.attrs["evolvent_kind"] == "spectrum"
        assert found["order"].attrs["long_name"] == "order of mesh pinion-gear"
        assert found["amplitude"].attrs["units"] == "m"
        assert found["phase"].attrs["units"] == "rad"
        assert float(found["amplitude"].sel(order=2)) == pytest.approx(2e-7, rel=1e-9)
        assert found.attrs["source"] == "angle.h5"
    code, out, _ = post("plot", "a.h5")
    assert (code, out) == (0, "a-spectrum.png\n")
    code, _, err = post("report", "a.h5")
    assert (code, err.count("\n")) == (3, 1)
    assert "is a spectrum, not a history; evolvent-post plot draws it" in err


def test_spectrum_over_frequency_has_a_hann_window_unless_another_is_chosen(post, steady_file):
    for more, name in (((), "hann"), (("--window", "flattop"), "flattop")):
        code, out, err = post("spectrum", steady_file, *more, "-o", "f.h5")
        assert (code, err) == (0, "")
        assert f"{name} window over 2001 outputs" in out
        with open_result("f.h5", "spectrum") as found:
            assert found["frequency"].attrs["units"] == "Hz"
            assert found.attrs["window"] == name


def test_spectrum_writes_json_for_scripts(post, steady_file):
    code, out, _ = post("spectrum", steady_file, *ORDERS, "--json", "--lines", "2")
    assert code == 0
    (found,) = json.loads(out)
    assert found["units"] == "m"
    assert [line["order"] for line in found["lines"]] == pytest.approx([1.0, 2.0])
    assert found["lines"][0]["amplitude"] == pytest.approx(5e-7, rel=1e-9)


def test_several_histories_come_in_one_picture(post, steady_file, angle_file):
    code, out, _ = post("spectrum", steady_file, angle_file, *ORDERS, "-o", "both.png")
    assert (code, out.splitlines()[-1]) == (0, "both.png")
    code, _, err = post("spectrum", steady_file, angle_file, *ORDERS, "-o", "both.h5")
    assert code == 2
    assert "write the numbers of each separately" in err
    assert not Path("both.h5").exists()


def test_a_speed_that_changes_is_said_of_a_spectrum_over_frequency(post, tmp_path):
    path = written(tmp_path / "up.h5", run_up())
    code, _, err = post("spectrum", path)
    assert code == 0
    assert "the speed changes by" in err
    assert "evolvent-post waterfall" in err
    assert post("spectrum", path, *ORDERS)[2] == ""


def test_waterfall_writes_map_and_picture_and_tells_where_orders_are_largest(post, tmp_path):
    path = written(tmp_path / "up.h5", run_up())
    code, out, err = post("waterfall", path, "-o", "w.h5", "-o", "w.png", "--highest", "4")
    assert (code, err) == (0, "")
    assert "windows of 4 pitches of mesh pinion-gear, rectangular" in out
    with open_result("w.h5", "order_map") as found:
        assert found["amplitude"].dims == ("time", "order")
        assert float(found["order"][-1]) == 4.0
        assert found["speed"].attrs["units"] == "rad s-1"
        assert found["frequency"].dims == ("time", "order")
    # order 2 is at 1.5 kHz where the pinion makes 39.5 rev/s; half the damping ratio 0.1 below
    (second,) = [line.split() for line in out.splitlines() if line.split()[:1] == ["2"]]
    assert float(second[3]) == pytest.approx(60 * 1500 / 2 / 19, rel=0.02)
    assert post("plot", "w.h5")[:2] == (0, "w-order_map.png\n")


def test_waterfall_takes_the_first_mesh_or_what_the_output_counts(post, angle_file):
    code, out, _ = post("waterfall", angle_file, "--length", "8")
    assert code == 0
    assert "windows of 8 pitches of mesh pinion-gear" in out
    assert "rows without resampling" in out


def test_sidebands_name_the_wheel_and_the_part_that_holds_its_turns(post, tmp_path):
    xi = np.arange(0, 60, 1 / 16)
    signal = 5e-7 * (1 + 0.2 * np.cos(2 * np.pi * xi / 19)) * np.cos(2 * np.pi * xi - 1.0)
    path = written(tmp_path / "side.h5", by_angle("pitch", "pinion-gear", 16, xi, signal))
    code, out, err = post("sidebands", path, "--carriers", "1", "--sides", "1")
    assert (code, err) == (0, "")
    assert "60 pitches: 3.158 turns of wheel pinion, 1.765 turns of wheel gear; rows without" in out
    assert "the same teeth meet after 646 pitches: other lines may leak into these" in out
    lines = {" ".join(line.split()[:4]): line.split() for line in out.splitlines()}
    assert lines["1 x mesh 1"][-3:] == ["500", "nm", "57.3°"]
    assert lines["+ 1 x pinion"][4:9] == ["1.05263", "50", "nm", "57.3°", "0.2"]
    code, out, _ = post("sidebands", path, "--carriers", "1", "--sides", "1", "--json")
    assert json.loads(out)[0]["amplitude_modulation"] == pytest.approx(0.2, rel=1e-9)


@pytest.mark.parametrize("command", COMMANDS)
@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (("--quantity", "colour"), "has no variable `colour` over time; no similar name"),
        (("--quantity", "transmision_error"), "did you mean transmission_error"),
        (("--quantity", "teeth"), "`teeth` is not a variable over time"),
        (("--quantity", "angular_velocity"), "has 2 wheels; select one with --wheel: pinion, gear"),
        (
            ("--quantity", "angular_velocity", "--wheel", "drum"),
            "has no wheel `drum`; there is pinion, gear",
        ),
        (("--wheel", "pinion"), "`transmission_error` has no wheel"),
        (("--select", "shaft=input"), "omit --select shaft=input"),
        (("--axis", "x"), "omit --axis"),
        (("--mesh", "second"), "has no mesh `second`; there is pinion-gear"),
        (("--from", "7"), "has 0 outputs between --from and --to; it goes from 0 s to 0.1 s"),
    ],
)
def test_what_there_is_not_is_named_with_what_there_is(
    post, steady_file, command, arguments, message
):
    code, out, err = post(command, steady_file, *arguments)
    assert (code, out) == (2, "")
    assert message in err
    assert err.startswith("evolvent-post: steady.h5: ")
    assert err.count("\n") == 1


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (("spectrum", "--order-of", "drum"), "no mesh and no wheel `drum`; there is the mesh "),
        (("spectrum", *ORDERS, "--periods", "51"), "not 51 whole; choose fewer, or increase"),
        (("spectrum", *ORDERS, "--periods", "60", "--from", "0.08"), "not 60 whole"),
        (("spectrum", *ORDERS, "--highest", "21"), "40 outputs a pitch resolve lines up to 20 of"),
        (("spectrum", "--highest", "11e3"), "outputs a second resolve lines up to 1e+04 Hz"),
        (("spectrum", *ORDERS, "--highest", "0"), "has no line up to 0, the first is at 0.02; "),
        (("spectrum", "--highest", "5"), "has no line up to 5, the first is at 9.995; choose a"),
        (("waterfall", "--highest", "0.2"), "has no line up to 0.2, the first is at 0.25"),
        (("waterfall", "--length", "40"), "too few for two windows of 40, 20 apart"),
        (("waterfall", "--order-of", "gear"), "choose a shorter --length"),
        (("sidebands", "--sides", "10"), "choose at most 9 by --sides"),
        (("sidebands", "--carriers", "20"), "not order 21; write outputs more often"),
    ],
)
def test_a_record_that_is_too_short_or_too_coarse_is_one_line_with_a_remedy(
    post, steady_file, arguments, message
):
    command, *options = arguments
    code, out, err = post(command, steady_file, *options)
    assert (code, out) == (2, "")
    assert message in err
    assert err.count("\n") == 1


def _with_hole(history: xr.Dataset) -> xr.Dataset:
    history = history.copy(deep=True)
    history["transmission_error"][100] = np.nan
    return history


def _standing() -> xr.Dataset:
    time = np.linspace(0.0, 1.0, 101)
    return signal_history(time, 0.0 * time, 0.0 * time)


def _back_and_forth() -> xr.Dataset:
    time = np.linspace(0.0, 1.0, 1001)
    turns = 5 * np.sin(4.0 * time)
    return signal_history(time, turns, orders(19 * turns + START))


def _from_rest() -> xr.Dataset:
    time = np.linspace(0.0, 1.0, 20001)
    turns = 45 * time**2 + 1e-7 * time
    return signal_history(time, turns, orders(19 * turns + START))


def _by_angle(kinds: dict[int, int] | None = None, left_out: int | None = None) -> xr.Dataset:
    xi = np.arange(0, 40, 1 / 16)
    history = by_angle("pitch", "pinion-gear", 16, xi, orders(xi))
    for row, kind in (kinds or {}).items():
        history["output_kind"][row] = kind
    if left_out is not None:
        history = history.isel(time=np.delete(np.arange(xi.size), left_out))
    return history


BAD = {
    "hole": (
        lambda: _with_hole(steady(500.0, 5e-5, 0.1, orders)), (),
        "`transmission_error` has no value at t = 0.005 s (1 of 2001 outputs); select times",
    ),
    "row": (
        lambda: steady(500.0, 5e-5, 0.1, orders).drop_isel(time=[50]), (),
        "outputs are missing between t = 0.00245 s and 0.00255 s; select a part",
    ),
    "order row": (
        lambda: steady(500.0, 5e-5, 0.1, orders).drop_isel(time=[50]), ORDERS,
        "outputs are missing between t = 0.00245 s and 0.00255 s; select a part",
    ),
    "standing": (_standing, ORDERS, "mesh pinion-gear does not turn (0 pitches in 1 s)"),
    "back": (_back_and_forth, ORDERS, "stops or turns back at t = 0.39"),
    "from rest": (
        _from_rest, ORDERS,
        "turns so slowly at t = 0 s that even angles as dense as the outputs there would be ",
    ),
    "coarse": (
        lambda: steady(500.0, 1 / 950.0, 0.2, orders), ORDERS,
        "1.9 outputs a pitch resolve lines up to 0.684 of mesh pinion-gear, not order 1; write",
    ),
    "few": (
        lambda: steady(500.0, 2e-4, 0.1, orders).isel(time=slice(0, 6)), ORDERS,
        "6 outputs are too few to interpolate, which takes 8",
    ),
    "short": (
        lambda: steady(500.0, 5e-5, 0.02, orders), ("--order-of", "pinion"),
        "holds 0.5276 turns of wheel pinion, not 1 whole; increase the duration",
    ),
    "by angle back": (
        lambda: _by_angle({200: 2, 201: 2}), (),
        "mesh pinion-gear turns back at t = 0.025 s, but orders require one sense of rotation; "
        "select a part",
    ),
    "by angle off": (
        lambda: _by_angle(dict.fromkeys(range(640), 1)), (),
        "has 0 outputs at even angles of mesh pinion-gear, too few for orders",
    ),
    "by angle row": (
        lambda: _by_angle(left_out=100), (),
        "outputs are missing between t = 0.012375 s and 0.012625 s; select a part",
    ),
}  # fmt: skip


@pytest.mark.parametrize(("make", "arguments", "message"), BAD.values(), ids=list(BAD))
def test_a_bad_record_is_one_line_with_place_and_remedy(post, tmp_path, make, arguments, message):
    path = written(tmp_path / "bad.h5", make())
    code, out, err = post("spectrum", path, *arguments)
    assert (code, out) == (3, "")
    assert message in err
    assert err.startswith("evolvent-post: bad.h5: ")
    assert err.count("\n") == 1


def test_a_history_of_an_older_program_has_orders_of_wheels_but_not_of_meshes(post, tmp_path):
    old = steady(500.0, 5e-5, 0.1, orders).drop_vars("start_position")
    path = written(tmp_path / "old.h5", old)
    code, _, err = post("spectrum", path, *ORDERS)
    assert (code, err.count("\n")) == (3, 1)
    assert (
        "no variable `start_position`), as written by an older evolvent; run the case again" in err
    )
    assert post("spectrum", path, "--order-of", "pinion")[0] == 0


def test_rows_off_the_grid_at_both_ends_of_output_by_angle_are_left_out(post, tmp_path):
    path = written(tmp_path / "ends.h5", _by_angle({0: 1, 639: 1}))
    code, out, _ = post("spectrum", path)
    assert code == 0
    assert "39 pitches of mesh pinion-gear" in out


def test_sidebands_of_less_than_a_turn_are_refused(post, steady_file):
    code, _, err = post("sidebands", steady_file, "--to", "0.02")
    assert (code, err.count("\n")) == (3, 1)
    assert "less than a revolution of a wheel, which takes 19; increase the duration" in err


@pytest.mark.parametrize("command", COMMANDS)
def test_a_static_analysis_is_no_record(post, tmp_path, command):
    static_curves().to_netcdf(tmp_path / "static.h5", engine="h5netcdf")
    code, out, err = post(command, "static.h5")
    assert (code, out) == (3, "")
    assert err.startswith("evolvent-post: static.h5: is a static analysis, not a history; ")
    assert err.count("\n") == 1


def test_a_constant_has_a_mean_and_no_lines(post, tmp_path):
    path = written(tmp_path / "constant.h5", steady(500.0, 5e-5, 0.1, lambda xi: 1.7 + 0 * xi))
    for words in (("spectrum",), ("spectrum", *ORDERS), ("waterfall",)):
        code, out, err = post(words[0], path, *words[1:], "-o", "c.png", "-o", "c.h5")
        assert (code, err) == (0, "")
        # nothing below the mean of a spectrum, and below the head of the table of a map
        *_, row, _, _ = out.splitlines()
        assert row.split()[0] == ("order" if words[0] == "waterfall" else "mean")


@pytest.mark.parametrize(
    "arguments",
    [
        ("spectrum", "-o", "a.txt"),
        ("waterfall", "-o", "a"),
        ("spectrum", "--select", "mesh"),
        ("spectrum", "--periods", "3"),
        ("spectrum", "--window", "triangle"),
        ("waterfall", "--length", "0"),
        ("spectrum", "steady.h5"),
    ],
)
def test_wrong_usage_is_code_2(post, steady_file, arguments):
    command, *options = (steady_file if word == "steady.h5" else word for word in arguments)
    code, out, err = post(command, steady_file, *options)
    assert (code, out) == (2, "")
    assert err.startswith("Usage: evolvent-post")


def test_output_that_cannot_be_written_is_code_74(post, steady_file):
    for name in ("nowhere/a.png", "nowhere/a.h5"):
        code, _, err = post("spectrum", steady_file, "-o", name)
        assert code == 74
        assert "cannot be written" in err
