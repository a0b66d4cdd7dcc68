"""Trains with shafts: against manual calculations, an independent eigenproblem, and limits."""

from __future__ import annotations

import json
import math
from typing import Any

import mpmath as mp
import numpy as np
import pytest
from hand_modes import johnson, paper_angle

from evolvent import check_history
from system.runs import Run
from system.trains import power_split, row

STEADY = "simulation.initial={kind: steady}"
NO_FRICTION = ("meshes.0.friction={law: none}", "meshes.1.friction={law: none}")
TORQUE, VISCOUS = 5.0, 2.0  # of examples/two-stage.yaml, as all that follows
TEETH = ((20, 47), (23, 53))
E_STAR = 2e11 / (2 * (1 - 0.3**2))


def broken_invariants(run: Run) -> list[str]:
    return [verdict.invariant.name for verdict in check_history(run.history) if verdict.failed]


# ---- two stages with shafts


def test_two_stages_run_and_no_invariant_is_broken(runs):
    run = runs("two-stage.yaml", "simulation.duration=0.2")
    assert run.exit_code == 0
    assert set(run.events["mesh"].values[run.events["kind"].values == "tooth_switch"]) == {0, 1}
    assert broken_invariants(run) == []  # energy, and the torques on each wheel, shafts included
    names = run.history["shaft"].values.tolist()
    assert names == ["input", "middle", "output"]
    assert float(abs(run.history["shaft_twist"].sel(shaft="middle")).max()) == 0.0


def test_two_stages_have_the_steady_speeds_and_torques_of_their_teeth(runs):
    run = runs("two-stage.yaml", STEADY, "simulation.duration=0.02", *NO_FRICTION)
    history = run.history
    first, second = (b / a for a, b in TEETH)
    torques = np.array([TORQUE, TORQUE * first, TORQUE * first * second])
    speed = torques[2] / VISCOUS
    speeds = speed * np.array([-first * second] * 2 + [second] * 2 + [-1.0] * 2)
    np.testing.assert_allclose(history["angular_velocity"] / speeds, 1.0, rtol=1e-9)
    np.testing.assert_allclose(history["shaft_torque"] / (torques * [-1, 1, -1]), 1.0, rtol=1e-9)
    twists = [-torques[0] / 2e4, -torques[2] / 5e4]
    np.testing.assert_allclose(
        history["shaft_twist"].sel(shaft=["input", "output"]) / twists, 1.0, rtol=1e-9
    )
    forces = torques[:2] / history["base_radius"].values[[1, 3]]
    np.testing.assert_allclose(history["normal_force"] / forces, 1.0, rtol=1e-9)


def disc_inertia(radius: float, width: float) -> float:
    return 7800 * math.pi * radius**4 * width / 2


def two_stages_by_hand(middle: float | None) -> np.ndarray:
    """Eigenvalues except 0, of absolute angles: J phi'' + C phi' + K phi = 0.

    Contact: h = -sigma (r_bA phi_A + r_bB phi_B), with Johnson's stiffness at the steady force.
    """
    radii = np.array([0.04, 0.04 * 47 / 20, 0.046, 0.046 * 53 / 23])
    inertia = [
        disc_inertia(0.06, 0.08),
        *(disc_inertia(r, b) for r, b in zip(radii, (0.03, 0.03, 0.04, 0.04), strict=True)),
        0.2,
    ]
    n = 6
    springs, dampers = np.zeros((2, n, n))

    def couple(a: int, b: int, arm_a: float, arm_b: float, k: float, c: float) -> None:
        arms = np.zeros(n)
        arms[[a, b]] = arm_a, arm_b
        springs[:] += k * np.outer(arms, arms)
        dampers[:] += c * np.outer(arms, arms)

    torque = TORQUE
    for stage, (a, b) in enumerate(TEETH):
        alpha = paper_angle(a, b)
        base = radii[2 * stage : 2 * stage + 2] * math.cos(alpha)
        rho = radii[2 * stage : 2 * stage + 2].sum() * math.sin(alpha)
        stiffness = johnson(torque / base[0], rho, (0.03, 0.04)[stage], E_STAR)
        # h changes rho_A + rho_B = rho + h as well
        couple(1 + 2 * stage, 2 + 2 * stage, *base, stiffness[1] + stiffness[2], 3e3)
        torque *= b / a
    couple(0, 1, 1, -1, 2e4, 2.0)
    couple(4, 5, 1, -1, 5e4, 10.0)
    dampers[5, 5] += VISCOUS
    join = np.eye(n)
    if middle is None:  # the gear's angle is the second pinion's
        join = np.delete(join, 3, axis=1)
        join[3, 2] = 1.0
    else:
        couple(2, 3, 1, -1, middle, 0.0)
    mass, damping, spring = (join.T @ m @ join for m in (np.diag(inertia), dampers, springs))
    m = len(mass)
    with mp.workdps(40):  # with absolute angles the slow modes are inaccurate in double precision
        inverse = mp.matrix(mass.tolist()) ** -1
        matrix = mp.zeros(2 * m)
        matrix[:m, m:] = mp.eye(m)
        matrix[m:, :m] = -inverse * mp.matrix(spring.tolist())
        matrix[m:, m:] = -inverse * mp.matrix(damping.tolist())
        values = np.array([complex(v) for v in mp.eig(matrix, left=False, right=False)])
    return values[abs(values) > 1e-6]


@pytest.mark.parametrize("middle", [None, 3e4], ids=["rigid", "elastic"])
def test_two_stages_have_the_modes_of_the_problem_assembled_by_hand(evolvent, examples, middle):
    settings = list(NO_FRICTION)
    if middle is not None:
        shaft = "{name: middle, wheels: [gear-1, pinion-2], stiffness: " + f"{middle}" + "}"
        settings.append(f"shafts.middle={shaft}")
    found = eigenvalues(evolvent, examples, *settings)
    expected = two_stages_by_hand(middle)
    expected = expected[expected.imag >= -1e-20 * abs(expected)]
    expected = expected[np.argsort(abs(expected))]
    assert len(found) == len(expected)
    assert abs(found / expected - 1).max() <= 1e-8


def eigenvalues(evolvent: Any, examples: Any, *settings: str) -> np.ndarray:
    """Eigenvalues of the example, in ascending order of magnitude."""
    options = [word for setting in settings for word in ("--set", setting)]
    result = evolvent("modes", examples / "two-stage.yaml", "--json", *options)
    assert result.returncode == 0, result.stderr
    modes = json.loads(result.stdout)["modes"]
    return np.array([complex(*mode["eigenvalue"]) for mode in modes])


def test_a_rigid_shaft_is_the_limit_of_a_stiff_one(evolvent, examples):
    """The modes of the rigid one are approached as 1/c; one additional mode grows as sqrt(c)."""
    rigid = eigenvalues(evolvent, examples)
    shaft = "shafts.middle={{name: middle, wheels: [gear-1, pinion-2], stiffness: {}}}"
    stiff, stiffer = (eigenvalues(evolvent, examples, shaft.format(c)) for c in ("1e9", "1e10"))
    n = len(rigid)
    assert len(stiff) == n + 1
    away, less = (abs(values[:n] / rigid - 1).max() for values in (stiff, stiffer))
    assert away < 1e-3
    # to first order in 1/c: the second-order remainder is less than the first itself
    assert less == pytest.approx(away / 10, rel=10 * away)
    assert abs(stiffer[-1] / stiff[-1]) == pytest.approx(math.sqrt(10), rel=1e-2)


def test_a_stiff_shaft_gives_the_history_of_a_rigid_one(runs):
    """Start from rest under the motor's torque; the torque of the middle shaft, too."""
    settings = (*NO_FRICTION, "simulation.duration=0.02")
    middle = "shafts.middle={name: middle, wheels: [gear-1, pinion-2], stiffness: 1e8, damping: 10}"
    rigid = runs("two-stage.yaml", *settings).history
    stiff = runs("two-stage.yaml", *settings, middle).history
    for name in ("angular_velocity", "normal_force", "shaft_torque"):
        scale = float(abs(rigid[name]).max())
        # modes up to 40000 1/s, J omega^2/c of the rotor: 0.01 * 1.6e9/1e8
        assert float(abs(stiff[name] - rigid[name]).max()) <= 0.02 * scale, name


# ---- loops


def test_two_idlers_between_two_wheels_share_the_torque(runs):
    """From rest; by symmetry half each, in both stages, at all times."""
    run = runs(power_split())
    assert run.exit_code == 0
    force = run.history["normal_force"]
    largest = float(force.max())
    for stage in (0, 1):
        upper, lower = force.isel(mesh=stage), force.isel(mesh=stage + 2)
        assert float(abs(upper - lower).max()) <= 1e-9 * largest
    assert broken_invariants(run) == []


def test_in_the_steady_state_each_idler_carries_half_the_torque(runs):
    run = runs(power_split(duration=0.01, initial={"kind": "steady"}))
    half = 8 / (2 * 0.04 * math.cos(math.radians(10)))
    np.testing.assert_allclose(run.history["normal_force"], half, rtol=1e-9)
    speed = 8 * 0.1 / 0.04 / 1
    np.testing.assert_allclose(run.history["angular_velocity"][:, 3], -speed, rtol=1e-9)


def test_a_loop_whose_centres_do_not_close_is_refused(evolvent, tmp_path):
    split = power_split()
    split["wheels"][3]["centre"][0] += 1e-3
    file = tmp_path / "split.yaml"
    file.write_text(json.dumps(split))
    result = evolvent("show", file)
    assert result.returncode == 3
    assert "wheels.output.centre: its centre is" in result.stderr
    assert "pitch radii add up to 0.16 m" in result.stderr


# ---- many wheels


def test_a_row_of_twenty_wheels_runs_and_no_invariant_is_broken(runs):
    run = runs(row(20, duration=0.01))
    assert run.exit_code == 0
    assert run.history.sizes["wheel"] == 20
    assert float(run.history["normal_force"][-1].min()) > 0.0
    assert broken_invariants(run) == []


def test_a_disc_that_only_hands_on_the_torque_of_two_rigid_shafts_balances(runs):
    case = row(2, duration=0.01, initial={"kind": "steady"})
    load = case["wheels"][-1].pop("loads")
    case["wheels"] += [
        {"name": "middle", "radius": 0.05, "width": 0.02, "material": "steel"},
        {"name": "far", "radius": 0.05, "width": 0.02, "material": "steel", "loads": load},
    ]
    case["shafts"] = [
        {"name": "near", "wheels": ["w1", "middle"], "kind": "rigid"},
        {"name": "end", "wheels": ["middle", "far"], "kind": "rigid"},
    ]
    run = runs(case)
    assert broken_invariants(run) == []
    first, second = run.history["shaft_torque"].values.T
    # no acceleration: the torques of both shafts of the disc are equal
    np.testing.assert_allclose(first, second, rtol=1e-9)
    assert abs(first).min() > 1
