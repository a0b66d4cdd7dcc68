"""What holds of every picture: nothing clipped, nothing on top of another, no style twice."""

from __future__ import annotations

import numpy as np
import pytest
import xarray as xr
from matplotlib.figure import Figure
from real_gears import RealPair
from signal_results import signal_result
from static_curves import static_curves

from evolvent.figures.over_time import EVENT_MARKS
from evolvent.figures.quantities import X, draw_quantities
from evolvent.figures.style import LINES, MOST_STYLES, line_style, log_ticks
from evolvent.figures.table import FIGURES, Run
from evolvent.history import HISTORY, STATIC
from evolvent.signals.selection import over_time
from pictures import faults, style_of

LONG = "a-run-with-a-name-that-says-what-was-changed"


def two_stages(turns: float = 0.2) -> xr.Dataset:
    """History with two meshes and four wheels, of which two turn alike; forces of both differ."""
    pair = RealPair(teeth=(20, 31)).history(np.linspace(0.0, turns * 2 * np.pi, 241))
    of_mesh = [str(n) for n, v in pair.data_vars.items() if "mesh" in v.dims]
    of_wheel = [str(n) for n, v in pair.data_vars.items() if "wheel" in v.dims]
    second = pair[of_mesh].assign({n: 300 * pair[n] for n in ("normal_force",)})
    meshes = xr.concat([pair[of_mesh], second], dim="mesh")
    wheels = xr.concat([pair[of_wheel], pair[of_wheel]], dim="wheel")
    wheels["angular_velocity"] = wheels["angular_velocity"] * [1.0, 1.0, -20 / 31, 0.3]
    ripple = 1.0 + 0.001 * np.sin(np.arange(241))
    wheels["angular_velocity"] = wheels["angular_velocity"] * xr.DataArray(ripple, dims="time")
    names = {"mesh": ["first", "second"], "wheel": ["motor", "gear-1", "pinion-2", "drum"]}
    parts = [pair.drop_dims(["mesh", "wheel"]), meshes, wheels]
    return xr.merge(parts, combine_attrs="override").assign_coords(names)


def events_at_the_edges(history: xr.Dataset, mesh: int = 0) -> xr.Dataset:
    """Events of every marked kind at the first and at the last output."""
    ends = history["time"].values[[0, -1]]
    kinds = [*EVENT_MARKS, "pair_entered", "pair_left"]
    return xr.Dataset(
        {
            "time": ("event", np.tile(ends, len(kinds))),
            "kind": ("event", np.repeat(np.array(kinds, dtype=object), 2)),
            "mesh": ("event", np.full(2 * len(kinds), mesh)),
            "flank": ("event", np.zeros(2 * len(kinds), dtype=int)),
        }
    )


def filled(history: xr.Dataset) -> xr.Dataset:
    """The same with all that pictures of histories ask for, and extremes at both ends."""
    for row in FIGURES.values():
        for name in row.needs if row.of == HISTORY else ():
            if name not in history:
                history[name] = history["normal_force"].assign_attrs(units="m") * 1e-9
                history[name].attrs["units"] = "m"
    ends = history["time"].values[[0, -1]]
    for ending, value, time in (("max", 1e3, ends[0]), ("min", -1e3, ends[1])):
        size = history.sizes["mesh"]
        history[f"normal_force_{ending}"] = ("mesh", np.full(size, value))
        history[f"normal_force_{ending}_time"] = ("mesh", np.full(size, time))
    return history


def runs_of(kind: str, n: int) -> list[Run]:
    if kind == STATIC:
        return [Run(static_curves())]
    if kind != HISTORY:
        return [Run(signal_result(kind), label=f"{LONG}-{i}") for i in range(n)]
    history = filled(two_stages())
    return [Run(history, events_at_the_edges(history), f"{LONG}-{i}") for i in range(n)]


@pytest.mark.parametrize("n", [1, 3])
@pytest.mark.parametrize("row", FIGURES.values(), ids=list(FIGURES))
def test_no_picture_of_the_table_has_a_fault(row, n):
    runs = runs_of(row.of, n)
    assert faults(row(*runs) if row.together else row(runs[0])) == []


def of_each_kind() -> list[tuple[str, X]]:
    """Variables of each shape, type and unit, with each axis that they can be drawn over."""
    history = two_stages()
    kinds = {}
    for name in over_time(history):
        values = history[name]
        kinds.setdefault(
            (values.dims, values.dtype.kind, len(str(values.attrs["units"])) > 1), name
        )
    return [
        (name, over)
        for name in kinds.values()
        for over in X
        if over is X.TIME or "mesh" in history[name].dims  # others have no roll angle
    ]


@pytest.mark.parametrize(("name", "over"), of_each_kind())
def test_no_picture_of_a_variable_of_any_kind_has_a_fault(name, over):
    history = filled(two_stages())
    run = Run(history, events_at_the_edges(history))
    assert faults(draw_quantities([run], [name], over=over)) == []


def test_a_picture_of_runs_that_differ_has_no_fault():
    one, other = filled(two_stages()), filled(RealPair().history(np.linspace(0.0, 1.0, 31)))
    runs = [Run(one, events_at_the_edges(one), LONG), Run(other, events_at_the_edges(other), "b")]
    for names in (
        ["normal_force"],
        ["angular_velocity"],
        ["normal_force", "transmission_error"],
        ["normal_force", "centre_displacement"],
    ):
        assert faults(draw_quantities(runs, names)) == []


def test_faults_are_found():
    figure = Figure(figsize=(3, 3))
    axes = figure.subplots()
    axes.plot([0, 1], [0, 1], "-", color="red", label="one")
    axes.plot([0, 1], [1, 0], "-", color="red", label="other")
    axes.plot([0.0], [0.5], "o", label="mark")
    axes.set(
        xlim=(0, 1), ylim=(1.1, 1.9), yscale="log", ylabel="a label that is too long for a panel"
    )
    axes.text(0.5, 1.5, "first")
    axes.text(0.5, 1.5, "second")
    found = " | ".join(faults(figure))
    for fault in (
        "clipped: a label that is too long",
        "clipped: mark of mark",
        "collide: first and second",
        "one style: ['one', 'other']",
        "logarithmic axis with ticks",
    ):
        assert fault in found


def test_no_two_styles_are_the_same():
    axes = Figure().subplots()
    for number in range(MOST_STYLES):
        axes.plot([0, 1], [0, 1], **line_style(number))
    assert len({style_of(line) for line in axes.lines}) == MOST_STYLES


def test_neighbours_among_the_first_styles_differ_in_grey_or_in_dashes():
    def grey(colour: str) -> float:
        parts = [int(colour[i : i + 2], 16) for i in (1, 3, 5)]
        return float(np.dot(parts, [0.299, 0.587, 0.114]))

    for number, one in enumerate(LINES):
        for other in LINES[:number]:
            assert one["color"] != other["color"]
            assert one["linestyle"] != other["linestyle"]
        assert grey(one["color"]) < 180  # seen on white


@pytest.mark.parametrize("ratio", [1.001, 1.05, 1.3, 2.0, 4.9, 9.0, 30.0, 99.0, 1e3, 1e6, 1e12])
@pytest.mark.parametrize("low", [3.3e-7, 0.011, 1.0, 7.7, 4.2e4])
def test_a_logarithmic_axis_has_ticks_with_numbers_however_long_it_is(low, ratio):
    figure = Figure(figsize=(6, 4))
    axes = figure.subplots()
    axes.set(yscale="log", ylim=(low, ratio * low))
    log_ticks(axes.yaxis)
    figure.draw_without_rendering()
    ticks = [t for t in axes.yaxis.get_major_ticks() if low <= t.get_loc() <= ratio * low]
    texts = [tick.label1.get_text() for tick in ticks]
    assert 2 <= len(texts) <= 12
    assert len(set(texts)) == len(texts)
    if low >= 1e-4 and ratio * low <= 1e5:
        np.testing.assert_allclose(
            [float(text) for text in texts], [t.get_loc() for t in ticks], 1e-5
        )
