"""Dynamic factors of a run: definitions, limits, and K_V of ISO 6336-1 beside them."""

from __future__ import annotations

import json
import math
import re
import subprocess
from typing import Any

import pytest

from system.runs import Run, Runs
from system.test_metrics import number
from system.test_metrics_of_pairs import slow_pair

FACTORS = ("dynamic_factor", "pair_dynamic_factor")


def pair_at(speed: float, rotation: str = "clockwise") -> dict[str, Any]:
    """Two compliant wheels; `speed` of the driving one [rad/s]."""
    case = slow_pair(1.7, 1500.0, rotation)
    for wheel in case["wheels"]:
        wheel["compliance"] = {"model": "analytic"}
    case["wheels"][0]["loads"][0]["value"] *= speed
    simulation = case["simulation"]
    simulation["metrics"]["from"] /= speed
    for key in ("duration", "output_interval"):
        simulation[key] /= speed
    return case


@pytest.fixture(scope="module")
def fast(runs: Runs) -> Run:
    run = runs(pair_at(60.0))
    assert run.exit_code == 0, run.messages
    return run


def test_a_quasi_static_run_has_the_factors_1(runs: Runs) -> None:
    run = runs(pair_at(0.1))
    assert run.exit_code == 0, run.messages
    assert number(run, "pair_dynamic_factor") == pytest.approx(1, abs=1e-4)
    # corner contact has a shorter lever arm, and a larger force under the same torque
    assert number(run, "dynamic_factor") == pytest.approx(1, abs=5e-3)


def test_the_factors_do_not_depend_on_the_output_interval(runs: Runs, fast: Run) -> None:
    case = pair_at(60.0)
    case["simulation"]["output_interval"] = case["simulation"]["duration"] / 3
    coarse = runs(case)
    for name in FACTORS:
        assert abs(number(fast, name) - 1) > 0.01, name
        assert number(coarse, name) == pytest.approx(number(fast, name), rel=1e-9), name


def test_the_mirrored_case_has_the_same_factors(runs: Runs, fast: Run) -> None:
    mirrored = runs(pair_at(60.0, "counterclockwise"))
    for name in (*FACTORS, "dynamic_factor_iso"):
        assert number(mirrored, name) == pytest.approx(number(fast, name), rel=1e-6), name


def test_the_factor_of_iso_is_that_of_the_data_sheet(fast: Run, executable: str) -> None:
    command = [executable, "datasheet", str(fast.path.with_suffix(".yaml")), "--json", "-q"]
    printed = subprocess.run(command, capture_output=True, text=True, check=True, timeout=60)
    rows = {row["key"]: row["values"] for row in json.loads(printed.stdout)["rows"]}
    assert [number(fast, "dynamic_factor_iso")] == rows["dynamic_factor"]
    assert number(fast, "dynamic_factor_iso") > 1
    assert "dynamic_factor_of_class" not in rows
    assert math.isnan(number(fast, "dynamic_factor_iso_of_class"))


def test_the_command_prints_the_factors_by_their_names(fast: Run) -> None:
    names = ("of the mesh force", "of a tooth pair", "without deviations")
    for text, name in zip(names, (*FACTORS, "dynamic_factor_iso"), strict=True):
        found = re.search(rf"dynamic factor .*{text} ([\d.]+\d)", fast.messages)
        assert found is not None, fast.messages
        assert float(found[1]) == pytest.approx(number(fast, name), rel=1e-3)


def test_tolerance_classes_add_their_factor(runs: Runs) -> None:
    case = pair_at(60.0)
    for wheel in case["wheels"]:
        wheel["accuracy"] = {"class": 6, "seed": 3}
    run = runs(case)
    assert run.exit_code == 0, run.messages
    assert number(run, "dynamic_factor_iso_of_class") > number(run, "dynamic_factor_iso")
    assert "with those of the classes" in run.messages
