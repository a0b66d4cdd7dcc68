"""Pages in a real browser: nothing sticks out, nothing is fetched, pictures do what they say.

They need Chromium and its driver, which ./runtests installs where it can.
"""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import pytest
from headless import Browser
from long_history import MILLION, SPIKE
from selenium.webdriver.common.action_chains import ActionChains

PLOTS = "[...document.querySelectorAll('#panels .js-plotly-plot')]"
RANGES = f"return {PLOTS}.map((plot) => plot.layout.xaxis.range)"
CASES = ("paper", "spur-pair", "compliant-pair", "two-stage", "million")
PageOf = Callable[[str, bool], Path]


def assert_sound(browser: Browser) -> None:
    """Nothing is wider than the window, nothing was fetched, nothing complained."""
    wide, window = browser.run("return [document.documentElement.scrollWidth, innerWidth]")
    assert wide <= window
    assert browser.complaints() == []
    assert browser.requests() == []


@pytest.mark.parametrize("width", [1440, 500])
@pytest.mark.parametrize("interactive", [False, True], ids=["figures", "interactive"])
@pytest.mark.parametrize("case", CASES)
def test_a_page_is_sound(
    browser: Browser, page_of: PageOf, case: str, interactive: bool, width: int
) -> None:
    page = page_of(case, interactive)
    assert page.stat().st_size < 6_000_000
    browser.open(page, width)
    assert browser.run("return document.querySelector('h2').id") == "datasheet"
    assert len(browser.all("#panels .js-plotly-plot")) == (4 if interactive else 0)
    cut = "return [...document.querySelectorAll('h1,h2,h3,p,li,figure,fieldset,.js-plotly-plot')]"
    cut += ".filter((e) => e.getBoundingClientRect().right > innerWidth).map((e) => e.outerHTML)"
    assert browser.run(cut) == []
    assert_sound(browser)


@pytest.fixture
def opened(browser: Browser, page_of: PageOf) -> Browser:
    """The page of a pair with tooth pairs, interactive."""
    browser.open(page_of("spur-pair", True), 1440)
    return browser


def test_formulas_are_drawn_as_formulas(browser: Browser, page_of: PageOf) -> None:
    """A subscript stands below its letter, a denominator below its numerator."""
    browser.open(page_of("paper", False), 1440)
    below = """
        const top = (element) => element.getBoundingClientRect().top;
        return [...document.querySelectorAll(arguments[0])]
          .map((element) => top(element.children[1]) > top(element.children[0]));
    """
    for element in ("msub", "mfrac"):
        drawn = browser.run(below, element)
        assert drawn
        assert all(drawn)


def test_a_click_on_a_name_hides_and_shows_its_line(opened: Browser) -> None:
    plot = opened.all("#panels .js-plotly-plot")[1]
    shown = f"return {PLOTS}[1].data[0].visible !== 'legendonly'"
    assert opened.run(shown)
    opened.all(".legendtoggle", plot)[0].click()
    opened.wait(f"return {PLOTS}[1].data[0].visible === 'legendonly'")
    opened.all(".legendtoggle", plot)[0].click()
    opened.wait(shown)
    assert_sound(opened)


def drag(browser: Browser, plot: int) -> None:
    """Zoom a picture to a part of its time."""
    box = browser.all(".nsewdrag", browser.all("#panels .js-plotly-plot")[plot])[0]
    actions = ActionChains(browser.driver).move_to_element_with_offset(box, -100, 0)
    actions.click_and_hold().move_by_offset(150, 2).release().perform()


def test_all_pictures_show_the_time_that_one_is_zoomed_to(opened: Browser) -> None:
    whole = opened.run(RANGES)[0]
    drag(opened, 1)
    same = f"new Set({PLOTS}.map((plot) => `${{plot.layout.xaxis.range}}`)).size === 1"
    opened.wait(f"return {same} && {PLOTS}[1].layout.xaxis.range[0] > {whole[0]}")
    opened.all("#whole")[0].click()
    opened.wait(f"return {same} && {PLOTS}[1].layout.xaxis.range[0] === {whole[0]}")
    assert_sound(opened)


def test_a_double_click_shows_the_whole_run_again(opened: Browser) -> None:
    whole = opened.run(RANGES)
    drag(opened, 0)
    opened.wait(f"return {PLOTS}.every((p) => p.layout.xaxis.range[0] > {whole[0][0]})")
    box = opened.all(".nsewdrag", opened.all("#panels .js-plotly-plot")[0])[0]
    ActionChains(opened.driver).double_click(box).perform()
    opened.wait(f"return {PLOTS}.every((p) => p.layout.xaxis.range[1] === {whole[0][1]})")


def test_hovering_tells_values_with_their_unit(opened: Browser) -> None:
    box = opened.all(".nsewdrag", opened.all("#panels .js-plotly-plot")[0])[0]
    ActionChains(opened.driver).move_to_element(box).perform()
    opened.wait("return document.querySelector('.hoverlayer')?.textContent.includes('µm')")


def test_a_quantity_is_found_shown_and_taken_away(opened: Browser) -> None:
    opened.all("#explorer summary")[0].click()
    opened.all("#find")[0].send_keys("kinetic")
    seen = [label for label in opened.all("#explorer fieldset label") if label.is_displayed()]
    assert [label.text for label in seen] == ["kinetic energy"]
    seen[0].click()
    opened.wait(f"return {PLOTS}.length === 5")
    seen[0].click()
    opened.wait(f"return {PLOTS}.length === 4")
    assert_sound(opened)


def test_a_spike_in_a_million_outputs_is_drawn_at_its_time(
    browser: Browser, page_of: PageOf
) -> None:
    browser.open(page_of("million", True), 1440)
    top = (
        f"const {{x, y}} = {PLOTS}[0].data[0];"
        "const place = y.indexOf(Math.max(...y));"
        "return [x[place], y[place], y[0], x.length]"
    )
    time, value, usual, size = browser.run(top)
    assert time == pytest.approx(5.0 * SPIKE / (MILLION - 1), rel=1e-12)
    assert value > 2.5 * usual
    assert size < MILLION / 50
