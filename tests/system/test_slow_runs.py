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


REACH = (0.0595, 0.0715)  # diameters where the tip reliefs start [m]
RELIEF = 3e-5


def relieved_arms(curve: xr.Dataset, run: xr.Dataset) -> tuple[Any, Any]:
    """Arms of the friction force on both wheels, in base radii, from the static contact positions.

    Pairs touch flank on flank only; each wheel takes half of the overlap.
    """
    base = [float(curve.base_radius_driving), float(curve.base_radius_driven)]
    line = sum(base) * math.tan(float(run.working_pressure_angle[0]))
    rho = [curve.pair_position.values[0], curve.pair_position_driven.values[0]]
    removed = []
    for i in (0, 1):
        start, end = (
            math.sqrt(r**2 - base[i] ** 2) for r in (REACH[i] / 2, float(run.tip_radius[i]))
        )
        removed.append(RELIEF * np.maximum((rho[i] - start) / (end - start), 0.0) ** 2)
    overlap = rho[0] + rho[1] - removed[0] - removed[1] - line
    arms = [(rho[i] - removed[i] - overlap / 2) / base[i] for i in (0, 1)]
    return arms[0], arms[1]


@pytest.mark.parametrize("bends", [True, False], ids=["compliant", "contact only"])
def test_the_mean_friction_loss_is_that_of_the_static_analysis(
    evolvent: Evolvent, tmp_path: Path, bends: bool
) -> None:
    """mu F_n |v| over the shares of `static`, in the time of the driven wheel's constant speed.

    The driving wheel advances by the transmission error. Reliefs exceed the deflection: no pair
    enters under load, whose impact would rub even in the slowest run.
    """
    mu, torque = 0.01, TORQUE / 3
    one = case("perfect", 0.0, coasts=False)
    one["wheels"][0]["loads"][0]["value"] = -torque
    for wheel, diameter in zip(one["wheels"], REACH, strict=True):
        wheel["tip_relief"] = {"amount": RELIEF, "diameter": diameter, "shape": "parabolic"}
        if not bends:
            del wheel["compliance"]
    friction = {"law": "coulomb", "coefficient": mu, "regularisation_velocity": 1e-7}
    one["meshes"][0]["friction"] = friction
    one["simulation"]["metrics"] = {"from": one["simulation"]["duration"] / 2}
    one["simulation"]["duration"] *= 1.5  # the vibration of the start has decayed after a pitch
    file, result = tmp_path / "case.yaml", tmp_path / "result.h5"

    def made(command: str, *words: str) -> xr.Dataset:
        file.write_text(json.dumps(one))
        done = evolvent(command, file, "-o", result, *words)
        assert done.returncode == 0, done.stderr
        with xr.open_dataset(result, engine="netcdf4") as opened:
            return opened.load()

    speeds = ("--speed", repr(SPEED))
    curve = made("static", "--torque", repr(torque), *speeds, "--points", "1000")
    assert set(np.unique(curve.pair_contact_kind)) == {0, 1}
    h = curve.transmission_error.values[0]
    one["simulation"]["initial"]["gaps"] = {"pinion-gear": -float(h[0])}
    run = made("run")
    arms = relieved_arms(curve, run)
    pitch = float(curve.base_pitch)
    growth = (np.roll(h, -1) - np.roll(h, 1)) / (2 * pitch / h.size)
    lags = 1 - growth  # advance of the driven flank per advance of the driving one
    slides = np.abs(arms[1] * lags[:, None] - arms[0])  # per advance of the driving flank
    forces = np.nan_to_num(curve.pair_normal_force.values[0])
    lost = mu * np.where(forces > 0, forces * slides, 0.0).sum(1).mean()  # [J/m]
    advance = SPEED * float(curve.base_radius_driving)
    assert float(run.window_friction_loss_mean[0]) == pytest.approx(lost * advance, rel=1e-5)
