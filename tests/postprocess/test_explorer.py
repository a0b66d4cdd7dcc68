"""Interactive pages: what is in them, however long the history, and how large they are."""

from __future__ import annotations

import builtins
import json

import numpy as np
import pytest
import xarray as xr
from real_gears import RealPair, no_events

from evolvent.errors import EvolventError
from evolvent.pages import explorer as module
from evolvent.pages.explorer import LARGEST, explorer
from evolvent.pages.report import report
from evolvent.units import engineering
from pages import read_lines, script, unpacked

MB = 1_000_000


@pytest.fixture(scope="module")
def page(friction_run) -> str:
    return report(friction_run.history, friction_run.events, interactive=True)


def long_history(n: int) -> xr.Dataset:
    """Noise and one spike each, in lines of wheels, a mesh and tooth pairs."""
    random = np.random.default_rng(3)

    def noise(*shape: int) -> np.ndarray:
        values = random.normal(size=(n, *shape))
        flat = values.reshape(n, -1)
        for number in range(flat.shape[1]):
            flat[random.integers(n), number] = 30.0 + number
            flat[random.integers(n), number] = -20.0 - number
        return values

    pairs = noise(1, 6)
    pairs[: n // 3, 0, 1] = np.nan
    return xr.Dataset(
        {
            "transmission_error": (("time", "mesh"), 1e-6 * noise(1), {"units": "m"}),
            "pair_normal_force": (("time", "mesh", "pair"), pairs, {"units": "N"}),
            "angular_velocity": (("time", "wheel"), noise(2), {"units": "rad s-1"}),
            "kinetic_energy": (("time",), noise(), {"units": "J"}),
        },
        coords={
            "time": np.cumsum(random.uniform(0.5, 1.5, n)) * 1e-6,
            "wheel": ["pinion", "gear"],
            "mesh": ["pinion-gear"],
            "pair": [f"drive_{slot}" for slot in range(6)],
        },
    )


def test_of_a_million_outputs_every_line_keeps_its_extremes_at_their_times():
    history = long_history(1_000_000)
    made = explorer(history, no_events())
    assert len(made.numbers) <= LARGEST
    assert " of 1,000,000 outputs: the smallest and the largest of each interval" in made.note
    page = "".join(
        f'<script type="t" id="explorer-{name}">{text}</script>'
        for name, text in (("facts", made.facts), ("numbers", made.numbers))
    )
    found = read_lines(page)
    assert set(found) == set(history.data_vars)
    seconds = engineering(history["time"].values[[0, -1]], "s")[0]
    for name, quantity in found.items():
        whole = history[name].values.reshape(history.sizes["time"], -1)
        factor = engineering(whole, history[name].attrs["units"])[0]
        assert len(quantity["lines"]) == whole.shape[1]
        for number, (times, values) in enumerate(quantity["lines"].values()):
            assert 1000 < values.size < 20_000
            for reach in (np.nanargmin, np.nanargmax):
                row = reach(whole[:, number])
                index = reach(values)
                assert values[index] == np.float32(whole[row, number] * factor)
                assert times[index] == history["time"].values[row] * seconds


def test_a_page_holds_every_quantity_that_is_not_0_throughout(page, friction_run):
    history = friction_run.history
    of_time = [n for n, v in history.data_vars.items() if v.dims[:1] == ("time",)]
    there = [n for n in of_time if np.nan_to_num(history[n].values).any()]
    assert set(read_lines(page)) == set(there)
    for name in there:
        assert f'value="{name}"' in page


def test_a_page_is_small_and_asks_no_network(page):
    assert len(page.encode()) < 6 * MB
    assert "default-src 'none'" in page
    for reference in ("src=", "href="):
        for part in page.split(reference)[1:]:
            assert part.startswith(('"data:', '"#')), part[:80]


def test_a_page_holds_the_library_with_its_license(page):
    library = unpacked(script(page, "library")).decode()
    assert "plotly.js v" in library[:200]
    assert "MIT license" in page


def test_a_page_shows_extremes_between_the_outputs(friction_run):
    reported = friction_run.history.assign(
        normal_force_max=("mesh", [42.0]), normal_force_max_time=("mesh", [0.12345])
    )
    found = read_lines(report(reported, friction_run.events, interactive=True))
    assert found["normal_force"]["extremes"] == [[pytest.approx(0.12345), 42.0, "pinion-gear"]]


def test_pictures_begin_with_the_window_of_the_numbers(friction_run):
    window = {"window_begin": 1.0, "window_end": 2.0, "window_periods": 7}
    reported = friction_run.history.assign({name: ((), v) for name, v in window.items()})
    page = report(reported, friction_run.events, interactive=True)
    assert json.loads(script(page, "facts"))["window"] == [1.0, 2.0]
    assert "1 to 2 s" in page


def test_pictures_show_the_times_that_were_asked_for_in_full(friction_run):
    reported = friction_run.history.assign(
        normal_force_max=("mesh", [42.0]), normal_force_max_time=("mesh", [2.5])
    )
    page = report(reported, friction_run.events, interactive=True, times=(1.0, 2.0))
    found = read_lines(page)["normal_force"]
    times, _ = found["lines"]["pinion-gear"]
    part = friction_run.history.sel(time=slice(1.0, 2.0))
    assert (times == part["time"].values).all()
    assert found["extremes"] == []  # beyond what is shown
    assert "All 1,001 outputs" in page
    assert all(
        1.0 <= t <= 2.0 for e in json.loads(script(page, "facts"))["events"] for t in e["times"]
    )


def test_names_of_a_case_cannot_end_the_script(friction_run):
    history = friction_run.history.assign_coords(mesh=["</script><b>"])
    page = report(history, friction_run.events, interactive=True)
    assert "</script><b>" not in page
    assert "\\u003c/script>" in script(page, "facts")


def test_places_of_pairs_that_never_carry_load_are_no_lines():
    history = RealPair().history(np.linspace(0.0, 1.0, 50))
    made = explorer(history, no_events())
    page = f'<script type="t" id="explorer-facts">{made.facts}</script>'
    facts = json.loads(script(page, "facts"))
    (force,) = [q for q in facts["quantities"] if q["name"] == "pair_normal_force"]
    assert [line["label"] for line in force["lines"]] == ["drive 0", "drive 1", "drive 2"]


def test_the_same_history_gives_the_same_interactive_page(page, friction_run):
    assert page == report(friction_run.history, friction_run.events, interactive=True)


def test_without_plotly_the_remedy_is_named(friction_run, monkeypatch):
    imported = builtins.__import__

    def without_plotly(name, *arguments, **more):
        if name.startswith("plotly"):
            raise ImportError(name)
        return imported(name, *arguments, **more)

    module._library.cache_clear()
    monkeypatch.setattr(builtins, "__import__", without_plotly)
    with pytest.raises(EvolventError, match=r"pip install 'evolvent\[interactive\]'"):
        explorer(friction_run.history, friction_run.events)
