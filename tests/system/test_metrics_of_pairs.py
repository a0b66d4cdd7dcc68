"""Metrics of meshes in which two, three and more pairs share the load, and of trains."""

from __future__ import annotations

import json
import math
import subprocess
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from designs import read_folder, write_design
from system.cases import STEEL
from system.runs import Run
from system.test_metrics import HARMONICS, MODULE, number

TEETH, ANGLE = 80, math.radians(14.5)
BASE = TEETH * MODULE / 2 * math.cos(ANGLE)
PITCH = 2 * math.pi / TEETH  # also its duration [s]: the driving wheel turns at 1 rad/s


def slow_pair(
    ratio: float, force: float, rotation: str = "clockwise", errors: list[float] | None = None
) -> dict[str, Any]:
    """Wheels without errors with this contact ratio, so slow that they do not vibrate."""
    distance = TEETH * MODULE
    path = ratio * math.pi * MODULE * math.cos(ANGLE)
    tip = 2 * math.hypot(BASE, (path + distance * math.sin(ANGLE)) / 2)
    sense = 1 if rotation == "clockwise" else -1
    wheel = {
        **{"teeth": TEETH, "module": MODULE, "pressure_angle": 14.5, "tip_diameter": tip},
        **{"rack": {"addendum": 1.6, "dedendum": 1.8, "root_radius": 0.1}, "bore": 0.02},
        **{"width": 0.02, "thickness_allowance": -1e-4, "material": "steel", "inertia": 1e-3},
    }
    return {
        "format": 1,
        "materials": {"steel": dict(STEEL)},
        "wheels": [
            {
                **{"name": "a", **wheel, **({"pitch_errors": errors} if errors else {})},
                "loads": [{"kind": "speed", "value": -sense}],
            },
            {
                **{"name": "b", **wheel},
                "loads": [{"kind": "torque", "value": -sense * force * BASE}],
            },
        ],
        "meshes": [
            {
                **{"name": "ab", "driving": "a", "driven": "b", "driving_rotation": rotation},
                **{"centre_line_angle": 0, "centre_distance": distance},
                "contact": {"law": "johnson"},
                "damping": {"law": "ratio", "value": 0.2},
            }
        ],
        "simulation": {
            **{"duration": 12 * PITCH, "output_interval": PITCH / 10},
            **{"initial": {"kind": "steady"}, "metrics": {"from": 2 * PITCH}},
        },
    }


# ---- number of pairs in contact

SHARES = ("no_contact", "one_pair", "two_pairs", "more_pairs")


def expected_shares(ratio: float) -> list[float]:
    """A contact ratio of n + x: n + 1 pairs for the x-th part of a pitch, n for the rest."""
    n, part = divmod(ratio, 1)
    shares = np.zeros(5)
    shares[int(n)], shares[int(n) + 1] = 1 - part, part
    return [*shares[:3].tolist(), float(shares[3:].sum())]


@pytest.mark.parametrize("ratio", [1.7, 2.3, 3.15])
def test_shares_of_the_time_are_those_of_the_contact_ratio(runs, ratio):
    run = runs(slow_pair(ratio, 1.0))
    assert run.exit_code == 0, run.messages
    reported = [number(run, f"share_{name}") for name in SHARES]
    # under 1 N the flanks deflect by 1e-5 of a base pitch, and pairs enter and leave later by that
    np.testing.assert_allclose(reported, expected_shares(ratio), atol=1e-4)


def test_a_batch_counts_three_pairs_and_more_at_its_outputs(evolvent, tmp_path: Path):
    """A change between two outputs counts up to half of their distance, a hundredth of a pitch."""
    case = slow_pair(2.3, 1.0)
    del case["simulation"]["metrics"]
    case["simulation"] |= {"duration": 4 * PITCH, "output_interval": PITCH / 100}
    forces = {"wheels.b.loads.0.value": [-BASE]}
    window = (PITCH, 4 * PITCH)
    design = write_design(tmp_path / "d.h5", forces, json.dumps(case), window)
    assert evolvent("batch", design, "-o", "r", "-q").returncode == 0
    row = read_folder(tmp_path / "r")[0]
    reported = [row[f"share_{name}"] for name in SHARES]
    np.testing.assert_allclose(reported, expected_shares(2.3), atol=0.01)


# ---- a protruding tooth


def with_a_proud_tooth(rotation: str, tooth: int, force: float) -> dict[str, Any]:
    """Three pairs and more at once, and one tooth that protrudes by 2 um on the driving flank."""
    sense = 1 if rotation == "clockwise" else -1
    errors = [-sense * 2e-6 * (k == tooth) for k in range(TEETH)]  # counterclockwise positive
    return slow_pair(3.15, force, rotation, errors)


@pytest.mark.parametrize(("rotation", "tooth"), [("clockwise", 4), ("counterclockwise", 76)])
def test_the_force_at_rest_is_that_of_the_flanks_that_carry(runs, executable, rotation, tooth):
    """Docs/reference/numbers.md: over the largest quasi-static force under the mean torque.

    A tooth that protrudes on one of its flanks is set back on the other: the loaded flank
    determines the share of the load of one pair.
    """
    force = 700.0
    run = runs(with_a_proud_tooth(rotation, tooth, force))
    assert run.exit_code == 0, run.messages
    shares = []
    for flank in (1, -1):
        torque = flank * force * float(run.history["base_radius"][0])
        command = [executable, "static", run.path.with_suffix(".yaml"), "-q", "--json"]
        command += ["--torque", repr(torque), "-o", run.path.with_suffix(f".{flank}.h5")]
        reported = subprocess.run(command, capture_output=True, text=True, check=True, timeout=60)
        shares += json.loads(reported.stdout)["largest_force_share"]
    assert abs(shares[0] - shares[1]) > 0.1
    # 200 positions per pitch against 100, each a fraction of a pitch away from the largest
    assert number(run, "pair_normal_force_max") / number(run, "pair_dynamic_factor") == (
        pytest.approx(shares[0] * force, rel=1e-3)
    )


def test_the_largest_force_of_a_pair_is_the_larger_one_of_two_parts_of_its_window(runs):
    """The protruding tooth carries it, and has left before the second part."""
    case = with_a_proud_tooth("clockwise", 4, 700.0)
    parts = ((2, 8), (6.5, 12), (2, 12))
    first, second, both = (
        number(
            runs(case, f"simulation.metrics={{from: {begin * PITCH}, to: {end * PITCH}}}"),
            "pair_normal_force_max",
        )
        for begin, end in parts
    )
    assert first > 1.2 * second
    assert both == pytest.approx(first, rel=1e-12)  # the same steps, from the same nodes


def test_the_crest_of_an_acceleration_does_not_depend_on_the_sense_of_rotation(runs):
    """Largest distance from the mean: in the mirror image values above it are below."""
    reported = []
    for rotation, tooth in (("clockwise", 4), ("counterclockwise", 76)):
        run = runs(with_a_proud_tooth(rotation, tooth, 700.0))
        high, low, mean, deviation, crest = (
            number(run, f"angular_acceleration_{which}", 1)
            for which in ("max", "min", "mean", "standard_deviation", "crest_factor")
        )
        assert crest == pytest.approx(max(high - mean, mean - low) / deviation, rel=1e-12)
        reported.append((high - mean, mean - low, crest))
    (above, below, crest), mirrored = reported
    assert abs(above - below) > 0.1 * above
    assert mirrored == pytest.approx((below, above, crest), rel=1e-6)


# ---- mesh of an order


def orders(run: Run, values: np.ndarray, mesh: int) -> np.ndarray:
    """2/X times the integral of x exp(2 pi i n xi) over the pitches of a mesh in the window."""
    history = run.history
    wheel = int(history["driving_wheel"].values[mesh])
    per_turn = -history["flank"].values[mesh] * history["teeth"].values[wheel] / (2 * math.pi)
    begin, end = (float(history[f"window_{which}"]) for which in ("begin", "end"))
    inside = (history["time"].values >= begin) & (history["time"].values <= end)
    xi = per_turn * history["angle"].values[inside, wheel]
    waves = np.exp(2j * np.pi * HARMONICS[:, None] * xi)
    return np.abs(2 / (xi[-1] - xi[0]) * np.trapezoid(values[inside] * waves, xi, axis=1))


def test_orders_of_an_axle_are_those_of_its_wheel_s_mesh(runs):
    """Two stages with moving axes and different pitch frequencies."""
    axle = "{kind: slider, direction: 90, mass: 1, stiffness: 1.0e+8, damping: 1.0e+3}"
    run = runs(
        "two-stage-gears.yaml",
        *(f"wheels.{wheel}.support={axle}" for wheel in ("pinion-1", "gear-2")),
        # four pitches of the first mesh, 1.957 of the second
        *("simulation.metrics={from: 0.0285}", "simulation.output_interval=1e-6"),
        "simulation.duration=0.05",
        *(f"meshes.{mesh}.friction={{law: none}}" for mesh in ("first", "second")),
    )
    assert run.exit_code == 0, run.messages
    names = run.history["wheel"].values.tolist()
    for wheel, mesh in (("pinion-1", 0), ("gear-2", 1)):
        i = names.index(wheel)
        values = run.history["centre_acceleration"].values[:, i, 1]
        reported = run.history["window_centre_acceleration_amplitude"].values[i, 1]
        # the time of the jump within the microsecond between two outputs is not known
        near = 5e-3 * values.std()
        np.testing.assert_allclose(reported, orders(run, values, mesh), atol=near)
        assert abs(reported - orders(run, values, 1 - mesh)).max() > 10 * near
