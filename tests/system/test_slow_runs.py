"""A quasi-static run has the transmission error of `evolvent static`."""

from __future__ import annotations

import json
import math
import subprocess
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import xarray as xr

from system.real_cases import real_pair
from system.slow_runs import apart

Evolvent = Callable[..., subprocess.CompletedProcess[str]]

TEETH = (19, 23)
TORQUE = 120.0  # of the pinion [N m]
SPEED = 1e-5 * 2 * math.pi * 5e3 / TEETH[0]  # a pitch in 1e5 natural periods, about [rad/s]

FIELDS: dict[str, tuple[dict[str, Any], dict[str, Any]]] = {
    "perfect": ({}, {}),
    "relieved": (
        {"tip_relief": {"amount": 2e-5, "diameter": 0.0605, "shape": "linear"}},
        {
            "root_relief": {"amount": 1e-5, "diameter": 0.0675, "shape": "parabolic"},
            "profile_crowning": 5e-6,
        },
    ),
    "pitch errors": ({"pitch_errors": [4e-6 * math.sin(3.0 * k**2) for k in range(19)]}, {}),
    "runout": ({}, {"eccentricity": {"amount": 1e-5, "phase": 40}}),
    "rounded": ({"tip_rounding": 2e-4}, {"tip_rounding": 3e-4}),
}


def case(name: str, lag: float, *, coasts: bool) -> dict[str, Any]:
    """Torque on the pinion, a constant speed of the gear, over two pitches."""
    speeds = {"pinion": -SPEED, "gear": SPEED * TEETH[0] / TEETH[1]}
    torque = TORQUE if coasts else -TORQUE
    loads = (
        {"loads": [{"kind": "torque", "value": torque}]},
        {"loads": [{"kind": "speed", "value": speeds["gear"]}]},
    )
    bent = {"bore": 0.02, "compliance": {"order": 4}}
    duration = 2 * 2 * math.pi / TEETH[0] / SPEED
    return real_pair(
        TEETH,
        wheels=tuple({**bent, **loads[i], **FIELDS[name][i]} for i in (0, 1)),
        mesh={"backlash": 1e-4, "damping": {"law": "ratio", "value": 0.1}},
        **{"duration": duration, "output_interval": duration / 97, "max_step": duration},
        **{"tolerance": 1e-10},
        initial={"kind": "speeds", "speeds": speeds, "gaps": {"pinion-gear": -lag}},
    )


@pytest.mark.parametrize("coasts", [False, True], ids=["drive", "coast"])
@pytest.mark.parametrize("name", FIELDS)
def test_a_slow_run_is_the_mesh_at_rest(
    evolvent: Evolvent, tmp_path: Path, name: str, coasts: bool
) -> None:
    """The same teeth meet at the same positions, with any deviations; the difference is inertia."""

    def made(command: str, lag: float, *words: str) -> xr.Dataset:
        file, result = tmp_path / "case.yaml", tmp_path / f"{command}.h5"
        file.write_text(json.dumps(case(name, lag, coasts=coasts)))
        done = evolvent(command, file, "-o", result, *words)
        assert done.returncode == 0, done.stderr
        with xr.open_dataset(result, engine="netcdf4") as opened:
            return opened.load()

    torque = repr(-TORQUE if coasts else TORQUE)
    curve = made("static", 0.0, "--torque", torque, "--points", "2000")
    run = made("run", float(curve.transmission_error[0, 0]))
    off, _ = apart(curve, run)
    assert np.median(off) < 1e-7
    assert np.quantile(off, 0.95) < 2e-6  # inertia, after entry or exit of a pair
    if curve.attrs["pitches"] > 1:  # and other teeth do not
        others = curve.roll(position=curve.attrs["points"])
        assert np.median(apart(others, run)[0]) > 1e-3
