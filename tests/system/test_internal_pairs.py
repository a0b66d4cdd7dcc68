"""Internal pairs on fixed or elastic axles: energy, force law, and cases said in another way."""

from __future__ import annotations

import copy
import json
from typing import Any

import numpy as np
import pytest

from evolvent import check_history
from system.internal_cases import internal_pair, random_pair
from system.periodic_cases import mirrored, reordered
from system.runs import TRACKED, Run, Runs
from system.scaled_cases import Scales, scaled_case

Block = dict[str, Any]
SAME = 1e-8
SEEDS = range(30)


def depth(run: Run) -> Any:
    """Penetration of the drive flanks less that of the coast flanks [m], (time,)."""
    assert run.exit_code == 0, run.messages
    names = [name for name in ("gap", "coast_gap") if name in run.history]
    return np.hstack([np.maximum(-np.nan_to_num(run.history[name].values), 0) for name in names])


def energy_drift(run: Run) -> float:
    """Largest departure of the energy balance over the largest elastic energy."""
    h = run.history
    total = h["kinetic_energy"] + h["potential_energy"] + h["dissipated_energy"] - h["load_work"]
    return float(abs(total - total[0]).max() / h["potential_energy"].max())


def same(one: Run, other: Run, rel: float = SAME, sign: int = 1) -> None:
    expected = depth(one)
    assert np.abs(depth(other) - expected).max() <= rel * expected.max()
    speeds = one.history["angular_velocity"].values
    names = list(one.history["wheel"].values)
    there = other.history["angular_velocity"].sel(wheel=names).values
    assert np.abs(sign * there - speeds).max() <= rel * np.abs(speeds).max()


def test_energy_is_kept_through_twenty_pitches(runs: Runs) -> None:
    long = internal_pair(duration=0.032)
    drifts = [
        energy_drift(runs(long, f"simulation.tolerance={tolerance}"))
        for tolerance in ("1e-8", "1e-10", "1e-12")
    ]
    run = runs(long, "simulation.tolerance=1e-10")
    pitches = abs(np.ptp(run.history["angle"].sel(wheel="pinion").values)) * 35 / (2 * np.pi)
    assert pitches > 20
    assert drifts[1] <= 1e-5
    assert drifts[2] < drifts[1] < drifts[0], "it falls with the tolerance"


LAWS: dict[str, Block] = {
    "johnson": {"contact": {"law": "johnson"}},
    "radzimovsky": {"contact": {"law": "radzimovsky"}},
    "yang_lin": {"contact": {"law": "yang_lin"}},
    "linear": {"contact": {"law": "linear", "stiffness": 5e8}},
    "coulomb": {"friction": {"law": "coulomb", "coefficient": 0.08}},
    "schlenk": {"friction": {"law": "schlenk"}},
    "mean_roughness": {"friction": {"law": "mean_roughness"}},
    "benedict_kelley": {"friction": {"law": "benedict_kelley"}},
    "xu_kahraman": {"friction": {"law": "xu_kahraman"}},
    "damped": {"damping": {"law": "linear", "coefficient": 1000.0}},
}


@pytest.mark.parametrize("name", LAWS)
def test_every_law_keeps_its_energy_and_both_integrators_agree(runs: Runs, name: str) -> None:
    case = internal_pair(mesh=LAWS[name]) | {"lubricant": {"viscosity": 0.02, "roughness": 5e-7}}
    radau, ida = runs(case), runs(case, "simulation.integrator=ida")
    assert energy_drift(radau) <= 1e-9
    # ida leaves 1e-7 at this tolerance
    same(radau, ida, rel=3e-7)
    assert [v.invariant.name for v in check_history(radau.history) if v.failed] == []


@pytest.mark.parametrize("tracking", TRACKED)
def test_tracked_points_agree_with_the_closed_form(runs: Runs, tracking: str) -> None:
    bearing = {"kind": "bearing", "stiffness": [2e8, 1e8], "damping": [2e3, 1e3]}
    case = internal_pair(pinion={"support": bearing}, ring={"thickness_allowance": 0.0})
    case["simulation"]["integrator"] = "ida"
    tracked = runs(case, f"meshes.0.tracking={tracking}")
    same(runs(case), tracked, rel=2e-6)
    assert [v.invariant.name for v in check_history(tracked.history) if v.failed] == []


def test_a_rigid_contact_has_the_forces_of_a_stiff_one(runs: Runs) -> None:
    rigid = runs(internal_pair(mesh={"contact": {"law": "rigid"}}, integrator="ida"))
    assert rigid.exit_code == 0, rigid.messages
    force = rigid.history["normal_force"].values[:, 0]
    # steady acceleration without deflection: N r_b = torque less inertia times acceleration
    h = rigid.history
    rate = h["angular_acceleration"].values
    inertia = h["inertia"].values
    base = h["base_radius"].values
    assert force * base[0] == pytest.approx(150.0 - inertia[0] * rate[:, 0], rel=1e-6)
    torque = h["load_torque"].values[:, 1]
    assert -force * base[1] == pytest.approx(inertia[1] * rate[:, 1] - torque, rel=1e-6)


def test_force_law_is_that_of_an_external_pair_with_the_same_line_of_action(runs: Runs) -> None:
    internal = internal_pair()
    external = copy.deepcopy(internal)
    wheel = external["wheels"][1]
    for key in ("internal", "tip_diameter", "rim_diameter", "thickness_allowance"):
        del wheel[key]
    wheel["teeth"] = 28  # (35 + 28)/2 m = (98 - 35)/2 m: the same T1T2
    found = [runs(case).history for case in (internal, external)]
    lines = [abs(float(h["line_of_action_length"].values[0])) for h in found]
    assert lines[0] == pytest.approx(lines[1], rel=1e-14)
    # under the same load
    assert [float(h["reference_force"].values[0]) for h in found] == pytest.approx(
        [150.0 / 0.0525 / np.cos(np.radians(20))] * 2, rel=1e-12
    )
    depths = [float(h["reference_penetration"].values[0]) for h in found]
    assert depths[0] == pytest.approx(depths[1], rel=1e-12)
    # independent program: 4.907196822 um at 150 N/mm
    torque = 150e3 * 0.02 * 0.0525 * np.cos(np.radians(20))
    at_given = runs(internal, f"wheels.pinion.loads.0.value={torque}").history
    assert float(at_given["reference_penetration"].values[0]) == pytest.approx(
        4.907196822e-6, rel=1e-9
    )


def turned(case: Block) -> Block:
    """Turn about the origin; bearings turn by a right angle with it."""
    other = copy.deepcopy(case)
    other["meshes"][0]["centre_line_angle"] -= 90.0
    for wheel in other["wheels"]:
        if "support" in wheel:
            for key in ("stiffness", "damping"):
                wheel["support"][key] = wheel["support"][key][::-1]
    return other


def coasting(case: Block) -> Block:
    """Name the ring as the driving wheel: the flanks that carry are then its coast flanks."""
    other = copy.deepcopy(case)
    mesh = other["meshes"][0]
    mesh["driving"], mesh["driven"] = "ring", "pinion"
    mesh["centre_line_angle"] -= 180.0
    return other


CHANGES = {"mirrored": (mirrored, -1), "turned": (turned, 1), "reordered": (reordered, 1)}


@pytest.mark.parametrize("seed", SEEDS)
def test_a_random_internal_pair_said_otherwise_moves_the_same(
    runs: Runs, executable: Any, seed: int
) -> None:
    case = random_pair(seed)
    run = runs(case)
    assert run.exit_code == 0, run.messages
    assert energy_drift(run) <= 1e-8
    for change, sign in CHANGES.values():
        same(run, runs(change(case)), sign=sign)
    scales = Scales(length=2.0, time=0.5, mass=4.0)
    scaled = runs(scaled_case(executable, case, scales))
    expected = depth(run)
    error = np.abs(depth(scaled) / 2 - expected).max()
    assert error <= 1e-6 * expected.max()


def test_a_driving_ring_is_the_coast_flank_of_a_driving_pinion(runs: Runs) -> None:
    """The loads and flanks of one motion, named from either wheel, after the start has decayed."""
    damped = {"damping": {"law": "linear", "coefficient": 8000.0}}
    case = internal_pair(mesh=damped, duration=0.01)
    one, other = runs(case), runs(coasting(case))
    last = slice(-40, None)
    drive = one.history["normal_force"].values[last].sum(axis=1)
    coast = other.history["coast_force"].values[last].sum(axis=1)
    assert drive.mean() == pytest.approx(coast.mean(), rel=2e-2)
    assert np.all(one.history["coast_force"].values[last] == 0)
    assert coast == pytest.approx(other.history["normal_force"].values[last].sum(axis=1))
    # speeds in the ratio of the teeth, both wheels in one sense
    speeds = other.history["angular_velocity"].values[last].mean(axis=0)
    assert speeds[1] / speeds[0] == pytest.approx(35 / 98, rel=1e-3)


def test_a_train_of_sun_planet_and_ring_on_fixed_axles(runs: Runs) -> None:
    case = internal_pair(duration=0.05, tolerance=1e-9)
    steel = {"module": 0.003, "width": 0.02, "material": "steel"}
    damped = {"damping": {"law": "linear", "coefficient": 8000.0}}
    sun = {"name": "sun", "teeth": 28, "loads": case["wheels"][0].pop("loads"), **steel}
    case["wheels"][0] |= {"loads": [], "thickness_allowance": -3e-5}
    case["wheels"].insert(0, sun)
    case["meshes"] = [
        {
            **{"driving": "sun", "driven": "pinion", "driving_rotation": "counterclockwise"},
            **{"centre_line_angle": 0.0, **damped},
        },
        {
            **{"driving": "pinion", "driven": "ring", "driving_rotation": "clockwise"},
            # the ring's centre is the sun's
            **{"centre_line_angle": 180.0, **damped},
        },
    ]
    run = runs(case)
    assert run.exit_code == 0, run.messages
    centres = run.history["centre"].values
    assert centres[2] == pytest.approx(centres[0], abs=1e-15)
    speeds = run.history["angular_velocity"].values[-500:].mean(axis=0)
    assert speeds[1] / speeds[0] == pytest.approx(-28 / 35, rel=1e-3)
    assert speeds[2] / speeds[0] == pytest.approx(-28 / 98, rel=1e-3)
    assert energy_drift(run) <= 1e-7
    assert [v.invariant.name for v in check_history(run.history) if v.failed] == []


def planets_in_a_ring(count: int) -> Block:
    """Sun 28, planets 35 and ring 98 on fixed axles: two planets close a loop of teeth."""
    case = internal_pair(tolerance=1e-9)
    steel = {"module": 0.003, "width": 0.02, "material": "steel", "loads": []}
    ring = case["wheels"][1] | {"centre": [0.0, 0.0], "thickness_allowance": -1e-5}
    sun = {"name": "sun", "teeth": 28, "centre": [0.0, 0.0], **steel}
    sun["loads"] = [{"kind": "torque", "value": 150.0}]
    case["wheels"], case["meshes"] = [sun, ring], []
    for i in range(count):
        angle = 2 * np.pi * i / count
        centre = [0.0945 * np.cos(angle), 0.0945 * np.sin(angle)]
        case["wheels"].append({"name": f"planet{i}", "teeth": 35, "centre": centre, **steel})
        damped = {"damping": {"law": "linear", "coefficient": 8000.0}}
        case["meshes"] += [
            {
                **{"driving": "sun", "driven": f"planet{i}"},
                **{"driving_rotation": "counterclockwise", **damped},
            },
            {
                **{"driving": f"planet{i}", "driven": "ring"},
                **{"driving_rotation": "clockwise", **damped},
            },
        ]
    return case


@pytest.mark.parametrize("count", [2, 3, 6])
def test_planets_that_divide_the_teeth_of_sun_and_ring_share_the_load(
    runs: Runs, count: int
) -> None:
    """(28 + 98)/count is whole: all teeth fit."""
    run = runs(planets_in_a_ring(count))
    assert run.exit_code == 0, run.messages
    force = run.history["normal_force"].values
    for meshes in (force[:, 0::2], force[:, 1::2]):
        assert (meshes.max(axis=0) > 100).all(), "every planet carries"
        if 28 % count == 0:  # planets at the same place in the pitch do the same
            assert meshes == pytest.approx(meshes[:, :1] + 0 * meshes, rel=1e-6, abs=1e-3)


@pytest.mark.parametrize("count", [4, 5])
def test_planets_that_do_not_divide_the_teeth_are_refused(
    evolvent: Any, tmp_path: Any, count: int
) -> None:
    file = tmp_path / "planets.yaml"
    file.write_text(json.dumps(planets_in_a_ring(count)))
    done = evolvent("validate", file)
    assert done.returncode == 3
    assert "closes a loop whose teeth do not fit" in done.stderr


def pitch_errors(teeth: int) -> list[float]:
    """Draw a single pitch error for each tooth [m]."""
    errors = 3e-6 * np.random.default_rng(teeth).normal(size=teeth)
    return [float(error) for error in errors - errors.mean()]


DEVIATIONS: dict[str, Block] = {
    "tip relief of the pinion": {
        "pinion": {"tip_relief": {"amount": 1e-5, "diameter": 0.1085, "shape": "parabolic"}}
    },
    "tip relief of the ring": {"ring": {"tip_relief": {"amount": 1e-5, "diameter": 0.2925}}},
    "root relief of the ring": {"ring": {"root_relief": {"amount": 1e-5, "diameter": 0.2975}}},
    "crowned ring": {"ring": {"profile_crowning": 5e-6}},
    "accuracy class of the ring": {"ring": {"accuracy": {"class": 6}}},
    "pitch errors of the ring": {"ring": {"pitch_errors": pitch_errors(98)}},
    "pitch errors of the pinion": {"pinion": {"pitch_errors": pitch_errors(35)}},
    "eccentric ring": {"ring": {"eccentricity": {"amount": 2e-5, "phase": 30.0}}},
    "eccentric pinion": {"pinion": {"eccentricity": {"amount": 2e-5, "phase": 30.0}}},
}


@pytest.mark.parametrize("name", DEVIATIONS)
def test_deviating_flanks_of_an_internal_pair_keep_their_energy(runs: Runs, name: str) -> None:
    case = internal_pair(duration=0.01, **DEVIATIONS[name])
    run = runs(case)
    assert run.exit_code == 0, run.messages
    assert energy_drift(run) <= 1e-8
    same(run, runs(case, "simulation.integrator=ida"), rel=3e-5)
    assert [v.invariant.name for v in check_history(run.history) if v.failed] == []
    if "accuracy" not in DEVIATIONS[name].get("ring", {}):  # its errors are drawn, not given
        same(run, runs(mirrored(case)), rel=1e-6, sign=-1)


def turn_of_ring(runs: Runs, **changes: Any) -> float:
    """Angle by which deviations turn the ring at a steady start [rad]."""
    damped = {"damping": {"law": "linear", "coefficient": 1000.0}}
    start = {"initial": {"kind": "steady"}, "duration": 2e-3}
    one, other = (
        runs(internal_pair(mesh=damped, **start, **given)).history["angle_deviation"].values[0]
        for given in ({}, changes)
    )
    return float((other - one)[1])


def test_teeth_that_are_all_displaced_turn_their_wheel_back(runs: Runs) -> None:
    """A cumulative pitch deviation is a counterclockwise arc on the reference circle."""
    arc = 1e-5
    back = turn_of_ring(runs, ring={"pitch_errors": [arc] * 98})
    assert back == pytest.approx(-arc / 0.147, rel=1e-4)
    forth = turn_of_ring(runs, pinion={"pitch_errors": [arc] * 35})
    assert forth == pytest.approx(arc / 0.0525 * 35 / 98, rel=1e-4)


def test_an_eccentric_ring_displaces_the_tooth_in_contact(runs: Runs) -> None:
    """Towards 90 deg from tooth 0, which is in contact, as its pitch error would."""
    off = 2e-5
    back = turn_of_ring(runs, ring={"eccentricity": {"amount": off, "phase": 90.0}})
    # the contact is some degrees beside the middle of the tooth
    assert back == pytest.approx(-off / 0.147, rel=0.05)
