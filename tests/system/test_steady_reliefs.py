"""Random pairs with relief and tip roundings have a steady start, or a rejection with its cause.

``pytest tests/system/test_steady_reliefs.py --long`` starts 300 pairs, without it 30.
"""

from __future__ import annotations

import json
import subprocess
from collections.abc import Callable
from pathlib import Path

import pytest
import xarray as xr

from system.edrive import edrive
from system.random_sets import seeds
from system.refusals import OF_A_PAIR
from system.steady_pairs import PITCHES, POINTS, in_another_order, steady_pair
from system.test_steady_order import run

Evolvent = Callable[..., subprocess.CompletedProcess[str]]


@pytest.mark.parametrize("seed", seeds(range(15), 300))
def test_a_relieved_pair_has_a_steady_start(evolvent: Evolvent, tmp_path: Path, seed: int) -> None:
    """Damped pairs settle from rest, so each has a start unless its geometry is rejected.

    If the wheels are too slow to follow the quasi-static path they start at its mean, and there
    the flanks may be separated.
    """
    case = steady_pair(seed, rounding=True)
    duration = case["simulation"]["duration"] / (100 * PITCHES)
    case["simulation"] |= {"duration": duration, "output_interval": duration / POINTS}
    history = run(evolvent, tmp_path, "case", case)
    if isinstance(history, str):
        assert any(words in history for words in OF_A_PAIR), history
        return
    force = float(history.normal_force[0, 0])
    if force > 0:
        return
    quasi_static = tmp_path / "static.h5"
    done = evolvent("static", tmp_path / "case.yaml", "-q", "-o", quasi_static)
    assert done.returncode == 0, done.stderr
    with xr.open_dataset(quasi_static, engine="netcdf4") as static:
        errors = static.transmission_error.load()
    start = float(history.transmission_error[0, 0])
    assert float(errors.min()) < start < float(errors.max())


@pytest.mark.parametrize("seed", [0, 7, 29])
@pytest.mark.parametrize("reverse", [False, True], ids=["as given", "in another order"])
def test_modes_are_those_of_the_equilibrium_where_the_steady_start_is_apart(
    evolvent: Evolvent, tmp_path: Path, seed: int, *, reverse: bool
) -> None:
    """In equilibrium the mesh carries the load and has a stiffness; separated flanks have none."""
    case = steady_pair(seed, rounding=True)
    load = sum(abs(load["value"]) for load in case["wheels"][0]["loads"])
    radius = case["wheels"][0]["teeth"] * case["wheels"][0]["module"] / 2
    file = tmp_path / "case.yaml"
    found = []
    for words in ([], ["--mean"]):
        file.write_text(json.dumps(case))
        done = evolvent("modes", file, "--json", *words)
        assert done.returncode == 0, done.stderr
        report = json.loads(done.stdout)
        mesh = report["state"]["meshes"]["pinion-gear"]
        assert mesh["pairs_in_contact"] >= 1
        assert abs(mesh["normal_force"]) == pytest.approx(load / radius, rel=0.4)
        assert report["rigid_body_modes"] == 1
        found.append([mode["eigenvalue"] for mode in report["modes"]])
    if not reverse:
        return
    file.write_text(json.dumps(in_another_order(case)))
    for before, words in zip(found, ([], ["--mean"]), strict=True):
        report = json.loads(evolvent("modes", file, "--json", *words).stdout)
        after = [mode["eigenvalue"] for mode in report["modes"]]
        for one, other in zip(before, after, strict=True):
            assert other == pytest.approx(one, rel=1e-6)


@pytest.mark.parametrize("words", [[], ["--mean"]], ids=["start", "mean"])
def test_modes_of_a_train_do_not_depend_on_the_order_of_the_wheels(
    evolvent: Evolvent, tmp_path: Path, words: list[str]
) -> None:
    case = edrive(15e3)
    found = []
    for one in (case, in_another_order(case)):
        (tmp_path / "case.yaml").write_text(json.dumps(one))
        done = evolvent("modes", tmp_path / "case.yaml", "--json", *words)
        assert done.returncode == 0, done.stderr
        found.append([mode["eigenvalue"] for mode in json.loads(done.stdout)["modes"]])
    assert len(found[0]) == len(found[1])
    for one, other in zip(*found, strict=True):
        assert other == pytest.approx(one, rel=1e-6)
