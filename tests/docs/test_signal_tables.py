"""The tables of guides/signals.md and reference/result_format.md are what the program has."""

from __future__ import annotations

import re
from pathlib import Path

import pytest
from signal_results import campbell_of_two_modes, map_of_run_up, spectrum_of_orders

from evolvent.signals.resampling import loss
from evolvent.signals.window_names import WINDOWS
from evolvent.signals.windows import measures

DOCS = Path(__file__).resolve().parents[2] / "docs"
SIGNALS = (DOCS / "guides" / "signals.md").read_text(encoding="utf-8")


def cells(line: str) -> list[str]:
    return [cell.strip() for cell in line.strip("|").split("|")]


def test_the_table_of_windows_is_what_they_measure() -> None:
    rows = [
        cells(line) for line in SIGNALS.splitlines() if re.match(r"\| `\w+` \| \d\.\d{3} ", line)
    ]
    assert [row[0].strip("`") for row in rows] == list(WINDOWS)
    for name, bandwidth, low, width, leakage in rows:
        reported = measures(name.strip("`"))
        assert float(bandwidth) == pytest.approx(reported.noise_bandwidth, abs=6e-4)
        assert float(low.rstrip(" %")) == pytest.approx(100 * reported.reads_low, abs=6e-3)
        assert int(width) == reported.half_width
        assert float(leakage.rstrip(" %")) == pytest.approx(100 * reported.leakage, rel=0.04)


def test_the_table_of_what_resampling_costs_is_its_formula() -> None:
    lines = SIGNALS.splitlines()
    (first,) = [i for i, line in enumerate(lines) if line.startswith("| rows a period of the line")]
    rows, losses = cells(lines[first])[1:], cells(lines[first + 2])[1:]
    for count, reported in zip(rows, losses, strict=True):
        assert float(reported) == pytest.approx(loss(float(count)), rel=0.04)


def test_every_variable_of_the_results_is_in_the_format() -> None:
    text = (DOCS / "reference" / "result_format.md").read_text(encoding="utf-8")
    section = text.partition("## Spectra, order maps, Campbell pictures")[2]
    named = set(re.findall(r"`(\w+)`", section))
    reported = set(re.findall(r"^\| `(\w+)` \| (?!rows)", section, re.MULTILINE))
    results = (spectrum_of_orders(), map_of_run_up(), campbell_of_two_modes())
    assert reported == {str(name) for result in results for name in result.data_vars}
    for result in results:
        assert named >= set(result.attrs) - {"Conventions", "label", "status_message"}
        assert named >= {str(name) for name in result.coords}
