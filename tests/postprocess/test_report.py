"""The report is one page that holds everything and needs nothing else."""

from __future__ import annotations

import base64
import re
from collections import Counter
from html.parser import HTMLParser
from xml.etree import ElementTree

import numpy as np
import pytest

from evolvent import open_events, open_history
from evolvent.errors import AnalysisError
from evolvent.figures.table import FIGURES
from evolvent.pages.report import event_counts, report, static_table

VOID = {"col", "meta", "img", "br", "link", "input", "hr", "wbr"}


class Page(HTMLParser):
    """Collects text, images and references, and checks that every element is closed."""

    def __init__(self, source: str) -> None:
        super().__init__()
        self.open: list[str] = []
        self.text: list[str] = []
        self.images: list[dict[str, str | None]] = []
        self.references: list[str] = []
        self.headings: list[str] = []
        self.elements: Counter[str] = Counter()
        self.feed(source)
        self.close()

    def handle_starttag(self, tag, attrs):
        attributes = dict(attrs)
        self.elements[tag] += 1
        if tag not in VOID:
            self.open.append(tag)
        if tag == "h2":
            self.headings.append(str(attributes["id"]))
        if tag == "img":
            self.images.append(attributes)
        self.references += [str(v) for k, v in attrs if k in ("src", "href")]

    def handle_endtag(self, tag):
        assert self.open.pop() == tag

    def handle_data(self, data):
        self.text.append(data)


@pytest.fixture(scope="module")
def page(friction_run) -> Page:
    with open_history(friction_run.path) as history, open_events(friction_run.path) as events:
        return Page(report(history, events))


def test_page_is_well_formed(page):
    assert page.open == []


def test_page_needs_no_other_file(page):
    assert page.references
    assert all(reference.startswith(("data:", "#")) for reference in page.references)


def test_the_contents_lead_to_headings_that_exist(page):
    entries = [reference[1:] for reference in page.references if reference.startswith("#")]
    assert len(entries) > 5
    assert set(entries) <= set(page.headings)
    assert page.headings[:2] == ["datasheet", "results"]


def test_every_figure_is_a_readable_image_with_a_text(page, friction_run):
    drawn = [r for r in FIGURES.values() if r.title and set(r.needs) <= set(friction_run.history)]
    assert len(page.images) == len(drawn) + 1  # and the mesh scheme
    for image in page.images:
        assert image["alt"]
        svg = base64.b64decode(re.sub("^data:image/svg.xml;base64,", "", image["src"]))
        assert ElementTree.fromstring(svg).tag == "{http://www.w3.org/2000/svg}svg"


@pytest.mark.parametrize(
    "text",
    [
        "The virtual setup of Kosenko and Gusev (2011)",
        "energy balance",
        "torque balance",
        "65.4411 mm",  # the line of action
        "7.52058°",  # the working pressure angle
        "differential",
        "tooth switch",
        "9,700",  # steps
        "SUNDIALS 6.4.1",
        "- {name: pinion, teeth: 20}",
    ],
)
def test_page_holds(page, text):
    assert text in "".join(page.text)


def test_without_a_data_sheet_the_report_says_why_and_draws_the_scheme(smooth_run, monkeypatch):
    def refuse(*_):
        raise AnalysisError(2, "", "the library cannot be loaded")

    monkeypatch.setattr("evolvent.pages.report.datasheets_html", refuse)
    page = Page(report(smooth_run.history, open_events(smooth_run.path)))
    said = " ".join("".join(page.text).split())
    assert "Not available: the library cannot be loaded." in said
    assert page.elements["svg"] == 0
    assert any("to scale" in str(image["alt"]) for image in page.images)


def test_a_broken_invariant_is_shown_as_failed(smooth_run):
    broken = smooth_run.history.copy(deep=True)
    broken["load_work"][100] += 1.0
    page = Page(report(broken, open_events(smooth_run.path)))
    assert page.text.count("fail") == 1
    assert page.text.count("pass") == 8


def test_an_unfinished_run_is_announced(smooth_run):
    stopped = smooth_run.history.assign_attrs(status="interrupted", status_message="by SIGTERM")
    page = report(stopped, open_events(smooth_run.path))
    assert "the run did not finish: by SIGTERM (last output at t = 0.5 s)" in page


def test_every_warning_of_the_start_is_shown(smooth_run):
    warned = smooth_run.history.assign_attrs(warnings="half width is large\nno pitch point")
    page = Page(report(warned, open_events(smooth_run.path)))
    assert {"half width is large", "no pitch point"} <= set(page.text)


def test_a_run_without_output_has_a_report(smooth_run):
    nothing = smooth_run.history.isel(time=slice(0, 0)).assign_attrs(status="failed")
    page = Page(report(nothing, open_events(smooth_run.path)))
    assert "The history has no output." in "".join(page.text)


def test_text_of_the_case_cannot_become_markup(smooth_run):
    history = smooth_run.history.assign_attrs(title="<script>x</script>", case="a: <b>")
    page = report(history, open_events(smooth_run.path))
    assert "<script>" not in page
    assert "a: &lt;b&gt;" in page


def test_the_same_history_gives_the_same_page(smooth_run):
    events = open_events(smooth_run.path)
    assert report(smooth_run.history, events) == report(smooth_run.history, events)


def test_wheels_of_a_mesh_are_named(smooth_run):
    rows = {label: texts for label, _, texts in static_table(smooth_run.history, "mesh")["rows"]}
    assert rows["driving wheel"] == ["pinion"]
    assert rows["driven wheel"] == ["gear"]


def test_events_are_counted_by_kind_and_mesh(friction_run):
    events = open_events(friction_run.path)
    counted = event_counts(friction_run.history, events)
    assert ("tooth switch", "pinion-gear", 1) in counted
    assert sum(number for _, _, number in counted) == events.sizes["event"]


def test_page_tells_what_the_tooth_pairs_did(smooth_run):
    """Contact in 251 of 501 outputs; 1 W lost of 4 W that the pinion hands over."""
    history = smooth_run.history
    size, one = history.sizes["time"], ("time", "mesh")
    loaded = (np.arange(size) < size / 2).astype(np.int32)
    speed = history["angular_velocity"].values[:, :1]
    entries = {
        "pair_normal_force": 5.0 * loaded,
        "pair_contact_pressure": 1e6 * loaded,
        "pair_on_path": np.ones(size, np.int32),
        "pair_number": np.zeros(size, np.int32),
    }
    with np.errstate(divide="ignore"):
        torque = np.where(speed != 0, 4.0 / speed, 0.0)
    with_pairs = history.assign(
        {name: ((*one, "pair"), values[:, None, None]) for name, values in entries.items()}
        | {
            "pairs_in_contact": (one, loaded[:, None]),
            "friction_loss": (one, np.where(speed != 0, 1.0, 0.0)),
            "mesh_torque_driving": (one, torque),
            "contact_ratio": ("mesh", [1.0]),
        }
    ).assign_coords(pair=["drive_0"])
    page = Page(report(with_pairs, open_events(smooth_run.path)))
    text = " ".join(" ".join(page.text).split())
    assert page.open == []
    assert "tooth pairs that carried load 1 contact ratio of the geometry 1 " in text
    assert "mean number of loaded pairs 0.501 share of time without contact 0.499 " in text
    assert "efficiency 0.75 " in text
    assert any("tooth pair" in str(image["alt"]) for image in page.images)
