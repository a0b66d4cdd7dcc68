"""`evolvent respond` of a case, of its mirror image, and with its lists reversed.

``pytest tests/system/test_respond_metamorphic.py --long`` takes 24 random gearboxes, without it 4.
"""

from __future__ import annotations

import json
import re
import subprocess
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import xarray as xr

from system.periodic_cases import mirrored, periodic_case, reordered
from system.random_sets import seeds

Evolvent = Callable[..., subprocess.CompletedProcess[str]]
Block = dict[str, Any]
# A motion counts as periodic if its estimated distance from the orbit is 1e-6 of its scales.
ALIKE = 2e-5


def wide_case(seed: int) -> Block:
    """A random gearbox whose responses start from the steady state."""
    case = periodic_case(seed)
    case["simulation"] |= {"tolerance": 1e-9, "initial": {"kind": "steady"}}
    case["meshes"][0]["name"] = "varied"
    return case


def response(evolvent: Evolvent, folder: Path, case: Block) -> xr.Dataset | str:
    """Three values of damping of the first mesh, or the last line of a rejection."""
    folder.mkdir()
    file, result = folder / "case.yaml", folder / "response.h5"
    file.write_text(json.dumps(case))
    over = "meshes.varied.damping.value=0.03:0.2:3"
    done = evolvent("respond", file, "--over", over, "-q", "-o", result)
    if done.returncode != 0:
        reported = done.stderr.splitlines()[-1].replace(str(folder), "")
        return re.sub(r"case.yaml[:\d]*", "", reported)
    with xr.open_dataset(result, engine="h5netcdf") as opened:
        return opened.load()


def size_of(found: xr.Dataset, metric: str) -> float:
    """Size of a metric: for a mean, which may be 0, that of its quantity."""
    rms = metric.removesuffix("_mean") + "_rms"
    return float(np.nanmax(abs(found[rms if rms in found else metric].values)))


def metrics(found: xr.Dataset, name: str) -> list[str]:
    """Metrics of forces and motions, except for the orders of wheels of two meshes.

    A mirror swaps the largest and the smallest acceleration: the range is unchanged.
    """
    turned = ("acceleration_max", "acceleration_min") if name == "mirrored" else ()
    return [
        str(key)
        for key, values in found.data_vars.items()
        if {"direction", "parameter"} <= set(values.dims)
        and values.dtype.kind == "f"
        and "harmonic" not in values.dims
        and key != "repeat_distance"
        and not str(key).endswith(turned)
    ]


@pytest.mark.parametrize("seed", seeds((1, 4, 7, 9), 24))
def test_a_mirror_and_another_order_change_nothing(
    evolvent: Evolvent, tmp_path: Path, seed: int
) -> None:
    case = wide_case(seed)
    first = response(evolvent, tmp_path / "first", case)
    for name, variant in (("mirrored", mirrored(case)), ("reordered", reordered(case))):
        other = response(evolvent, tmp_path / name, variant)
        if isinstance(first, str) or isinstance(other, str):
            assert first == other, name
            continue
        named = {key: first[key] for key in ("wheel", "mesh", "shaft") if key in first.coords}
        other = other.sel(named)
        assert np.array_equal(first.period, other.period), name
        assert len(metrics(first, name)) > 10
        for metric in metrics(first, name):
            a, b = (reported[metric].values for reported in (first, other))
            assert np.array_equal(np.isnan(a), np.isnan(b)), (name, metric)
            if np.isnan(a).all():
                continue
            # the sign of a mean, or of a vector's phase, changes in a mirror
            off = np.nanmax(abs(abs(a) - abs(b))) / (size_of(first, metric) or 1.0)
            assert off <= ALIKE, (name, metric, off)
