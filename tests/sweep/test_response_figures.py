"""Figures of summaries show the right data and hide no failure. How they look was looked at."""

from __future__ import annotations

import numpy as np
import pytest
import xarray as xr
from sweeps import failed, make_design, row, write_journal

from evolvent.errors import SweepError
from evolvent.sweep.collect import collect, open_summary
from evolvent.sweep.figures import figure_indices, figure_response, varying_parameters
from pictures import faults

LOADS = [1.0, 2.0, 3.0, 4.0]
FRICTIONS = [0.0, 0.1, 0.3]


@pytest.fixture
def summarise(tmp_path):
    """Make a summary of these columns in which the cases of `bad` failed."""

    def make(columns: dict, bad: tuple[int, ...] = (), missing: tuple[int, ...] = ()):
        design = make_design(columns)
        cases = [i for i in range(design.n_cases) if i not in missing]
        rows = [failed(i) if i in bad else row(i) for i in cases]
        write_journal(tmp_path / "d", design, rows)
        collect(tmp_path / "d", design, tmp_path / "s.h5")
        with open_summary(tmp_path / "s.h5") as summary:
            return summary.load()

    return make


@pytest.fixture
def grid(summarise) -> xr.Dataset:
    """Each of four loads with each of three frictions; case 4 (2 N, 0.1) failed."""
    loads, frictions = np.repeat(LOADS, 3), np.tile(FRICTIONS, 4)
    return summarise({"load": loads, "friction": frictions, "width": [5] * 12}, bad=(4,))


def legend(figure) -> list[str]:
    return [text.get_text() for found in figure.legends for text in found.get_texts()]


@pytest.mark.parametrize("wide", [False, True], ids=["linear", "logarithmic"])
def test_no_figure_of_a_sweep_has_a_fault(summarise, wide):
    loads = np.geomspace(1.0, 1e4, 4) if wide else np.array(LOADS)
    for short in (1.0, 0.3):  # a logarithmic axis of less than a decade as well
        columns = {"load": np.repeat(loads**short, 3), "friction": np.tile(FRICTIONS, 4)}
        grid = summarise(columns, bad=(0, 11))
        for against in (["load"], ["friction"], ["load", "friction"]):
            assert faults(figure_response(grid, "penetration_max", against)) == []


def test_a_grid_gives_a_line_for_each_value_of_the_other_parameter(grid):
    figure = figure_response(grid, "penetration_max", ["load"])
    lines = figure.axes[0].lines
    assert legend(figure) == [
        "friction = 0 mN",
        "friction = 100 mN",
        "friction = 300 mN",
        "did not finish: 1 of 12",
    ]
    for number, line in enumerate(lines[:3]):
        np.testing.assert_array_equal(line.get_xdata(), LOADS)
        cases = np.arange(4) * 3 + number
        expected = np.where(cases == 4, np.nan, cases + 1.0)
        np.testing.assert_allclose(line.get_ydata(), expected, rtol=1e-12)
    assert lines[3].get_xdata().tolist() == [2.0]  # the failure, at its load
    assert figure.axes[0].get_ylabel() == "largest penetration [nm]"
    assert figure.axes[0].get_xlabel() == "load [N]"


def test_the_parameter_of_most_values_is_drawn_if_none_is_named(grid):
    assert varying_parameters(grid) == ["load", "friction"]
    assert figure_response(grid, "steps").axes[0].get_xlabel() == "load [N]"


def test_two_parameters_give_a_map_with_the_failures_marked(grid):
    figure = figure_response(grid, "penetration_max", ["load", "friction"])
    (mesh,) = figure.axes[0].collections
    cells = np.ma.filled(mesh.get_array(), np.nan).reshape(3, 4)
    expected = (np.arange(12.0) + 1).reshape(4, 3).T
    expected[1, 1] = np.nan
    np.testing.assert_allclose(cells, expected, rtol=1e-12)
    (mark,) = figure.axes[0].lines
    np.testing.assert_allclose([mark.get_xdata()[0], mark.get_ydata()[0]], [2.0, 100.0])
    assert figure.axes[0].get_ylabel() == "friction [mN]"
    assert legend(figure) == ["did not finish: 1 of 12"]


def test_a_sample_gives_points_and_missing_cases_are_none(summarise):
    random = np.random.default_rng(1)
    columns = {"load": random.random(50), "friction": random.random(50)}
    summary = summarise(columns, bad=(3,), missing=(7, 8))
    points = figure_response(summary, "steps", ["load"]).axes[0].lines[0]
    assert points.get_xdata().size == 47
    assert points.get_linestyle() == "None"
    scatter = figure_response(summary, "steps", ["load", "friction"]).axes[0].collections[0]
    assert scatter.get_offsets().shape == (47, 2)


def test_texts_stand_at_the_axis_and_wide_ranges_are_logarithmic(summarise):
    laws = np.array(["none", "tanh", "none", "tanh"], dtype=object)
    summary = summarise({"law": laws, "load": [1.0, 3.0, 30.0, 100.0]})
    axis = figure_response(summary, "steps", ["law"]).axes[0]
    assert [text.get_text() for text in axis.get_xticklabels()] == ["none", "tanh"]
    assert figure_response(summary, "steps", ["load"]).axes[0].get_xscale() == "log"


def test_columns_that_follow_from_others_do_not_count_as_varied(summarise):
    summary = summarise({"load": LOADS, "minus": [-load for load in LOADS], "other": [1, 2, 2, 1]})
    assert varying_parameters(summary) == ["load", "other"]


@pytest.mark.parametrize(
    ("response", "against", "message"),
    [
        ("speed", (), "no result 'speed'; it has penetration_max, steps, cpu_time"),
        ("load", (), "no result 'load'"),
        ("steps", ("speed",), "no parameter 'speed'; it has load, friction, width"),
        ("steps", ("load", "friction", "width"), "one or two parameters"),
    ],
)
def test_what_is_not_there_is_refused(grid, response, against, message):
    with pytest.raises(SweepError, match=message):
        figure_response(grid, response, against)


def test_nothing_is_drawn_if_nothing_varies(summarise):
    with pytest.raises(SweepError, match="no parameter varies"):
        figure_response(summarise({"load": [1.0, 1.0]}), "steps")


def test_a_sweep_of_failures_alone_is_drawn_as_such(summarise):
    figure = figure_response(summarise({"load": LOADS}, bad=(0, 1, 2, 3)), "steps")
    assert legend(figure) == ["did not finish: 4 of 4"]


def test_indices_are_bars_with_their_intervals():
    indices = xr.Dataset(
        {
            "first_order": ("parameter", [0.6, 0.1]),
            "first_order_confidence": ("parameter", [0.05, 0.02]),
            "total": ("parameter", [0.8, 0.3]),
            "total_confidence": ("parameter", [0.05, 0.02]),
        },
        coords={"parameter": ["load", "friction"]},
        attrs={"response": "steps"},
    )
    figure = figure_indices(indices)
    assert [bar.get_width() for bar in figure.axes[0].patches] == [0.6, 0.1, 0.8, 0.3]
    assert [text.get_text() for text in figure.axes[0].get_yticklabels()] == ["load", "friction"]
    assert legend(figure) == ["first order", "total"]


def test_the_command_writes_the_figure_and_says_where(sweep, grid):
    code, out, err = sweep("plot", "s.h5", "-r", "steps", "-a", "load")
    assert (code, out, err) == (0, "s-steps.png\n", "")
    assert sweep("plot", "s.h5", "-a", "load", "-a", "friction", "-o", "map.svg")[1] == "map.svg\n"
    code, _, err = sweep("plot", "s.h5", "-o", "figure.gif")
    assert code == 2
    assert "must end in .png, .svg or .pdf" in " ".join(err.split())
    code, _, err = sweep("plot", "s.h5", "--indices")
    assert code == 2
    assert "need a plan by saltelli, sobol or latin_hypercube" in err
