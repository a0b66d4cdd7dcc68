"""A steady start does not depend on the order of wheels, meshes, shafts and loads in the case.

``pytest tests/system/test_steady_order.py --long`` runs 500 pairs, without it 60.
"""

from __future__ import annotations

import json
import subprocess
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
import xarray as xr

from system.edrive import edrive
from system.random_sets import seeds
from system.refusals import OF_A_PAIR
from system.steady_pairs import PITCHES, POINTS, in_another_order, steady_pair

Evolvent = Callable[..., subprocess.CompletedProcess[str]]
SHORT, COUNTED, LONG = 30, 60, 500
START = 1e-13  # difference of the starts over the scales: rounding
LATER = 1e-9  # of the penetrations over five pitches, over the largest transmission error


def run(evolvent: Evolvent, folder: Path, stem: str, case: dict[str, Any]) -> xr.Dataset | str:
    """Return the history, or the last line of a rejection."""
    file, result = folder / f"{stem}.yaml", folder / f"{stem}.h5"
    file.write_text(json.dumps(case))
    done = evolvent("run", file, "-q", "-o", result)
    if done.returncode != 0:
        return done.stderr.splitlines()[-1]
    with xr.open_dataset(result, engine="netcdf4") as opened:
        return opened.load()


def compare(first: xr.Dataset, second: xr.Dataset) -> tuple[float, float]:
    """Return the largest differences of the start and of the first five pitches, over scales."""
    named = {key: first[key] for key in ("wheel", "mesh", "shaft") if key in first.coords}
    second = second.sel(named)
    n = min(first.time.size, second.time.size, PITCHES * POINTS)
    start, later = [], []
    for key in ("transmission_error", "penetration", "normal_force", "angular_velocity"):
        a, b = first[key].values[:n], second[key].values[:n]
        scale = {
            # a force has the rounding of positions over the penetration, some digits less
            "normal_force": 10 * abs(a).max(),
            "angular_velocity": abs(a[0]),
        }.get(key, float(abs(first.transmission_error).max()))
        off = abs(a - b) / scale
        start.append(off[0].max())
        if key in ("transmission_error", "penetration"):
            later.append(off.max())
    return max(start), max(later)


@pytest.mark.parametrize("seed", seeds(range(SHORT), LONG))
def test_a_random_pair_starts_alike_in_every_order(
    evolvent: Evolvent, tmp_path: Path, seed: int
) -> None:
    case = steady_pair(seed)
    first = run(evolvent, tmp_path, "first", case)
    second = run(evolvent, tmp_path, "second", in_another_order(case))
    if isinstance(first, str) or isinstance(second, str):
        assert isinstance(first, str), second
        assert isinstance(second, str), first
        assert any(words in first for words in OF_A_PAIR), first
        return
    start, later = compare(first, second)
    assert start < START
    assert later < LATER


@pytest.mark.parametrize("kind", [{}, {"position": 0.3}], ids=str)
def test_a_train_starts_alike_in_every_order(
    evolvent: Evolvent, tmp_path: Path, kind: dict[str, Any]
) -> None:
    case = edrive(15e3, **kind)
    case["simulation"] |= {"duration": 2e-3, "tolerance": 1e-12}
    del case["simulation"]["metrics"]
    first = run(evolvent, tmp_path, "first", case)
    second = run(evolvent, tmp_path, "second", in_another_order(case))
    assert not isinstance(first, str)
    assert not isinstance(second, str)
    start, later = compare(first, second)
    assert start < START
    assert later < LATER


def test_few_of_the_pairs_are_refused(evolvent: Evolvent, tmp_path: Path) -> None:
    """No pair is excluded from the set; rejected ones are counted."""
    refused = [
        seed
        for seed in range(0, COUNTED, 2)
        if isinstance(run(evolvent, tmp_path, "case", steady_pair(seed)), str)
    ]
    assert len(refused) <= COUNTED // 12, refused
