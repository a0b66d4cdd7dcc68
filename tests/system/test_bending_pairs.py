"""Random compliant pairs: energy balance, agreement with static analysis, or a permitted rejection.

``pytest tests/system/test_bending_pairs.py --long`` tests 300, without it 30.
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

from system.bending_pairs import BendingPair
from system.random_sets import seeds
from system.refusals import OF_A_PAIR
from system.slow_runs import apart

Evolvent = Callable[..., subprocess.CompletedProcess[str]]

SHORT, LONG = 30, 300
every_pair = pytest.mark.parametrize("seed", seeds(range(SHORT), LONG))
# A slow run takes twenty times as long as static analysis.
every_sixth = pytest.mark.parametrize("seed", seeds(range(0, SHORT, 6), LONG))

CODES = (3, 4)  # the case, a state of the run


class Files:
    """Runs the program on cases in a folder."""

    def __init__(self, evolvent: Evolvent, folder: Path) -> None:
        self.evolvent, self.folder = evolvent, folder

    def __call__(self, command: str, case: dict[str, Any], *words: str) -> xr.Dataset | None:
        """Return the output of a command; None if it rejects the case with a permitted message."""
        file, result = self.folder / "case.yaml", self.folder / f"{command}.h5"
        file.write_text(json.dumps(case))
        done = self.evolvent(command, file, "-o", result, *words)
        if done.returncode == 0:
            with xr.open_dataset(result, engine="netcdf4") as opened:
                return opened.load()
        last = done.stderr.splitlines()[-1]
        assert done.returncode in CODES, done.stderr
        assert any(words in last for words in OF_A_PAIR), last
        assert re.search(r"[0-9]", last.split("case.yaml")[-1]), last  # a value, or a location
        return None


@pytest.fixture
def files(evolvent: Evolvent, tmp_path: Path) -> Files:
    return Files(evolvent, tmp_path)


@every_pair
def test_a_pair_that_bends_keeps_its_energy(files: Files, seed: int) -> None:
    """Undamped, from too little deflection, over some pitches, with any changes of contact."""
    pair = BendingPair(seed)
    case = pair.case()
    history = files("run", case)
    if history is None:
        return
    energy = history.kinetic_energy + history.potential_energy + history.dissipated_energy
    spread = np.ptp((energy - history.load_work).values)
    rounding = 1e-13 * float(history.kinetic_energy.max())
    assert spread <= 1e-5 * float(history.potential_energy.max()) + rounding
    assert history.attrs["invariants"] == "held"
    bends = any(w["compliance"].get("model") != "none" for w in case["wheels"])
    if bends and case["meshes"][0].get("edge_contact") != "false":  # no pair adds or removes energy
        assert float(abs(history.dissipated_energy).max()) == 0


@every_pair
def test_a_mesh_gets_stiffer_with_its_load(files: Files, seed: int) -> None:
    """Contacts stiffen and more pairs carry: mean secant over six torques up to the load's."""
    pair = BendingPair(seed)
    torques = f"{pair.torque / 20!r}:{pair.torque!r}:6"
    curves = files("static", pair.at_rest(errors=True), "--torque", torques, "--points", "24")
    if curves is None:
        return
    stiffness = curves.mean_secant_stiffness.values / pair.common
    assert (np.diff(stiffness) > 0).all()
    assert (stiffness > 1e8).all()
    assert (stiffness < 1e11).all()
    assert (curves.transmission_error > curves.free_transmission_error).all()
    assert (curves.pair_normal_force >= 0).all()


@every_pair
def test_forces_at_rest_are_the_gradient_of_the_energy(files: Files, seed: int) -> None:
    """T_A/r_bA from differences of U and h along the positions, and along the torques.

    dU = (F_A - F_B) dx + F_B dh, where the force on B follows from its differences with A at rest.
    Where a pair enters, leaves, or passes the start of a relief, the differences span a corner.
    """
    pair = BendingPair(seed)
    step = 1e-3
    torques = f"{pair.torque * (1 - step)!r}:{pair.torque * (1 + step)!r}:3"
    case = pair.at_rest(errors=False)
    curves = files("static", case, "--torque", torques, "--points", "400")
    if curves is None:
        return
    u, h = curves.elastic_energy.values, curves.transmission_error.values
    force_b = ((u[2] - u[0]) / (h[2] - h[0]))[2:-2]

    def by_x(values: Any) -> Any:
        step = 12 * float(curves.base_pitch) / 400
        return (8 * (values[3:-1] - values[1:-3]) - (values[4:] - values[:-4])) / step

    force_a = by_x(u[1]) + force_b * (1 - by_x(h[1]))
    off = np.abs(force_a / curves.tooth_force.values[1] - 1)
    assert np.median(off) < 1e-6  # of the differences: the square of the step
    assert np.quantile(off, 0.8) < 1e-5


def see_slow_run(files: Files, seed: int, **of_mesh: str) -> None:
    """Compare the transmission error of a slow damped run over a pitch with static analysis.

    The difference is due to damping and inertia at 2e-6 of f_0. Every second pair coasts, half of
    them have friction, some have errors.
    """
    pair = BendingPair(seed)
    coasts, rubs = seed % 2 == 1, seed % 4 < 2
    torque = -pair.torque if coasts else pair.torque
    speed = ("--speed", repr(pair.slow_speed())) if rubs else ()
    differing = 1 if pair.errors is None else pair.wheels[pair.errors].teeth
    points = str(min(4000, 60000 // differing))

    def slow(lag: float) -> dict[str, Any]:
        case: dict[str, Any] = pair.slow(lag, coasts=coasts, friction=0.08 if rubs else 0.0)
        case["meshes"][0] |= of_mesh
        return case

    curve = files("static", slow(0.0), "--torque", repr(torque), "--points", points, *speed)
    if curve is None:
        return
    run = files("run", slow(float(curve.transmission_error[0, 0])))
    if run is None:
        return
    off, friction = apart(curve, run)
    if rubs:  # while a pair sticks at the pitch point, the wheels do not slide as they turn
        slides = friction < 1e-3 * pair.force
        assert slides.mean() > 0.6
        assert float(np.abs(curve.pair_friction_force.sum("pair")).max()) > 1e-2 * pair.force
        off = off[slides]
    assert off.size > 30
    assert np.median(off) < 1e-6
    assert np.quantile(off, 0.8) < 5e-6  # the rest: corners of the curve, after the entry of a pair


@every_sixth
def test_a_slow_damped_run_is_the_mesh_at_rest(files: Files, seed: int) -> None:
    see_slow_run(files, seed)


@pytest.mark.parametrize("seed", [20, 44, 45, 161, 276])
def test_slow_pairs_without_edges_come_to_their_end(files: Files, seed: int) -> None:
    """When a pair enters or leaves under load, sliding passes the friction knee within 1 ns."""
    see_slow_run(files, seed, edge_contact="false")


def test_few_of_the_pairs_are_refused(files: Files) -> None:
    """Otherwise the tests would cover little."""
    refused = [seed for seed in range(SHORT) if files("static", BendingPair(seed).case()) is None]
    assert len(refused) <= SHORT // 6, refused
