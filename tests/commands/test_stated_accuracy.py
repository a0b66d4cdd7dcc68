"""`simulation.accuracy` instead of `simulation.tolerance`: resulting tolerance, and its outputs."""

from __future__ import annotations

import json
import subprocess
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
import xarray as xr
import yaml

from evolvent.physics.invariants import tolerance_of

Evolvent = Callable[..., subprocess.CompletedProcess[str]]
SHORT = {"duration": 0.002, "output_interval": 1e-5}
OPTIONS = {"radau": "meshes.0.tracking=closed_form", "ida": "meshes.0.tracking=differential"}


@pytest.fixture
def case(examples: Path, tmp_path: Path) -> Path:
    """A pair of gears, 2 ms long, without both keys."""
    text = yaml.safe_load((examples / "spur-pair.yaml").read_text())
    text["simulation"] = {**SHORT, "initial": text["simulation"]["initial"]}
    path = tmp_path / "case.yaml"
    path.write_text(yaml.safe_dump(text))
    return path


def sets(*settings: str) -> list[str]:
    return [word for setting in settings for word in ("--set", setting)]


def tolerance(evolvent: Evolvent, case: Path, *settings: str) -> float:
    """Tolerance in the output of `show`."""
    done = evolvent("show", case, "--json", *sets(*settings))
    assert done.returncode == 0, done.stderr
    return float(json.loads(done.stdout)["integration"]["tolerance"])


def test_both_are_refused_in_one_line_with_both_places(
    evolvent: Evolvent, case: Path, tmp_path: Path
) -> None:
    both = tmp_path / "both.yaml"
    text = yaml.safe_load(case.read_text())
    text["simulation"] |= {"accuracy": 1e-6, "tolerance": 1e-9}
    both.write_text(yaml.safe_dump(text, sort_keys=False))
    accuracy, stated = (
        next(i for i, line in enumerate(both.read_text().splitlines(), 1) if key in line)
        for key in ("  accuracy:", "  tolerance:")
    )
    for command in ("run", "show", "validate"):
        done = evolvent(command, both)
        assert done.returncode == 3
        assert done.stderr == (
            f"{both}:{stated}:3: simulation: 'tolerance' conflicts with 'accuracy' "
            f"({both}:{accuracy}:3); give one of them\n"
        )


def test_an_accuracy_set_on_a_case_that_says_a_tolerance_is_refused(
    evolvent: Evolvent, case: Path
) -> None:
    settings = sets("simulation.tolerance=1e-8", "simulation.accuracy=1e-6")
    done = evolvent("run", case, *settings)
    assert done.returncode == 3
    assert "'tolerance' conflicts with 'accuracy' (--set simulation.accuracy=1e-6)" in done.stderr
    assert done.stderr.count("\n") == 1


@pytest.mark.parametrize("value", ["0", "-1e-6", "1e-10", "0.01", "1", "high"])
def test_an_accuracy_out_of_range_is_refused(evolvent: Evolvent, case: Path, value: str) -> None:
    done = evolvent("run", case, *sets(f"simulation.accuracy={value}"))
    assert done.returncode == 3
    assert "simulation.accuracy: " in done.stderr


@pytest.mark.parametrize("integrator", ["radau", "ida"])
def test_a_smaller_accuracy_is_a_smaller_tolerance(
    evolvent: Evolvent, case: Path, integrator: str
) -> None:
    found = [
        tolerance(evolvent, case, OPTIONS[integrator], f"simulation.accuracy={accuracy}")
        for accuracy in (1e-9, 1e-8, 1e-7, 1e-6, 1e-5, 1e-4)
    ]
    assert found == sorted(set(found))
    assert found[0] >= {"radau": 1e-13, "ida": 1e-14}[integrator]
    assert found[-1] <= 1e-3  # limit for a case


@pytest.mark.parametrize(
    ("integrator", "factor", "power"), [("radau", 1.4e-3, 4 / 7), ("ida", 10.0, 5 / 6)]
)
@pytest.mark.parametrize("accuracy", [1e-9, 1e-7, 1e-5])
def test_the_tolerance_is_where_the_law_of_the_measured_errors_meets_the_accuracy(
    evolvent: Evolvent, case: Path, integrator: str, factor: float, power: float, accuracy: float
) -> None:
    """The laws of docs/guides/integrators.md: no measured gearbox has a larger error."""
    reported = tolerance(evolvent, case, OPTIONS[integrator], f"simulation.accuracy={accuracy}")
    assert factor * reported**power == pytest.approx(accuracy, rel=0.03)  # printed with two digits


def test_a_case_that_says_neither_has_a_tolerance_of_1e_9(evolvent: Evolvent, case: Path) -> None:
    assert tolerance(evolvent, case) == 1e-9


@pytest.mark.parametrize("integrator", ["radau", "ida"])
def test_show_run_and_the_history_tell_the_tolerance_and_the_case_gives_the_same_bits(
    evolvent: Evolvent, case: Path, tmp_path: Path, integrator: str
) -> None:
    where, stated = OPTIONS[integrator], "simulation.accuracy=1e-5"
    expected = tolerance(evolvent, case, where, stated)
    text = evolvent("show", case, *sets(where, stated)).stdout
    assert "accuracy: 1.0e-05" in text
    assert f"Accuracy\n  1e-05 of the largest penetration: {integrator} with a tolerance of" in text

    def gap(path: Path, *settings: str) -> Any:
        output = tmp_path / "history.h5"
        done = evolvent("run", path, "-o", output, *sets(*settings))
        assert done.returncode == 0, done.stderr
        with xr.open_dataset(output, engine="netcdf4") as history:
            return history.load()

    first = gap(case, where, stated)
    assert first.attrs["integrator_tolerance"] == expected
    assert tolerance_of(first) == expected
    resolved = tmp_path / "resolved.yaml"
    resolved.write_text(first.attrs["case"])
    simulation = yaml.safe_load(resolved.read_text())["simulation"]
    assert float(simulation["accuracy"]) == 1e-5
    assert "tolerance" not in simulation
    same = [gap(resolved), gap(case, where, f"simulation.tolerance={expected!r}")]
    for other in same:
        assert other.gap.values.tobytes() == first.gap.values.tobytes()
        assert other.attrs["integrator_tolerance"] == expected


def test_no_accuracy_asks_for_a_tolerance_that_radau_refuses(
    evolvent: Evolvent, case: Path
) -> None:
    radau = (OPTIONS["radau"], "simulation.integrator=radau")
    smallest = (*radau, "simulation.accuracy=1e-9")
    assert evolvent("validate", case, *sets(*smallest)).returncode == 0
    assert tolerance(evolvent, case, *smallest) >= 1e-13
    for value, code in ((1e-13, 0), (0.99e-13, 3)):  # the smallest tolerance of radau
        options = sets(*radau, f"simulation.tolerance={value}")
        assert evolvent("validate", case, *options).returncode == code
