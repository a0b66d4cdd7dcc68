"""Pairs of gears with compliant teeth and bodies: static analysis, energy, integrators, outputs."""

from __future__ import annotations

import json
import subprocess
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from contact.test_true_wheels import E, real_mesh
from evolvent import check_history
from kernel.compliant import true_mesh
from kernel.kernel import Kernel
from system.real_cases import real_pair, tip_diameters, torque, viscous
from system.runs import Run, Runs

TEETH, BORE, WIDTH = 50, 0.04, 0.02  # [m]
BASE_RADIUS = 0.075 * np.cos(np.radians(20))
FORCE = 150e3 * WIDTH  # along the line of action [N]
PITCH = 2 * np.pi / TEETH
FAST = 1500 * np.pi / 30  # [rad/s]
both_integrators = pytest.mark.parametrize("integrator", ["radau", "ida"])


def bending_pair(
    speed: float, pitches: float, initial: dict[str, Any], *, outputs: int = 400, **given: Any
) -> dict[str, Any]:
    """Two wheels of 50 teeth at 150 N/mm, held at their bores; further keys of the mesh."""
    simulation = {key: given.pop(key) for key in ("tolerance", "integrator") if key in given}
    wheel = {"bore": BORE, "compliance": {}}
    wheel |= given.pop("of_wheels", {})
    driven = given.pop("driven", torque(-FORCE * BASE_RADIUS))
    duration = pitches * PITCH / speed
    case = real_pair(
        (TEETH, TEETH),
        width=WIDTH,
        wheels=({**wheel, **torque(-FORCE * BASE_RADIUS)}, {**wheel, **driven}),
        mesh={"backlash": 5e-5, **given},
        **{"duration": duration, "output_interval": duration / outputs},
        **{"initial": initial, **simulation},
    )
    case["materials"]["steel"]["youngs_modulus"] = E
    return case


def start(speed: float, penetration: float) -> dict[str, Any]:
    """The driving wheel turns clockwise."""
    speeds = {"pinion": -speed, "gear": speed}
    return {"kind": "speeds", "speeds": speeds, "gaps": {"pinion-gear": -penetration}}


def energy(run: Run) -> Any:
    """T + V + D - W [J]."""
    h = run.history
    return (h.kinetic_energy + h.potential_energy + h.dissipated_energy - h.load_work).values


RELIEF = {"tip_relief": {"amount": 8e-6, "diameter": 0.1535}}
CROWN = {"root_relief": {"amount": 4e-6, "diameter": 0.1465}, "profile_crowning": 5e-6}
BEARING = {"support": {"kind": "bearing", "mass": 3.0, "stiffness": [1e8, 3e8]}}
EDGES: dict[str, dict[str, Any]] = {
    "perfect": {},
    "uncoupled": {"tooth_coupling": "false"},
    "relieved": {"of_wheels": RELIEF},
    "rounded": {"of_wheels": {"tip_rounding": 3e-4}},
    "both flanks slope": {"of_wheels": {**RELIEF, **CROWN}},
    "moving axles": {"of_wheels": BEARING},
    "relieved on moving axles, uncoupled": {
        "of_wheels": {**RELIEF, **BEARING},
        "tooth_coupling": "false",
    },
}


@pytest.mark.parametrize("given", EDGES.values(), ids=EDGES)
def test_energy_is_kept_through_twenty_pitches(runs: Runs, given: dict[str, Any]) -> None:
    """From a start with 30 % too little deflection: no energy is booked as pairs come and go."""
    left = []
    for tolerance in (1e-8, 1e-12):
        case = bending_pair(FAST, 20, start(FAST, 8e-6), tolerance=tolerance, outputs=2000, **given)
        run = runs(case)
        assert run.exit_code == 0, run.messages
        assert run.times("flank_reached").size >= 19
        assert float(abs(run.history.dissipated_energy).max()) == 0
        assert not [v for v in check_history(run.history) if v.failed]
        left.append(np.ptp(energy(run)) / float(run.history.potential_energy.max()))
    assert left[0] < 1e-6
    assert left[1] < min(1e-8, left[0] / 3)


@both_integrators
def test_pressure_of_a_run_is_that_of_rounded_edges(runs: Runs, integrator: str) -> None:
    """Outputs and their maximum over the run: between first contact and the path of contact."""
    rounding = 3e-4
    given = {"of_wheels": {"tip_rounding": rounding}, "damping": {"law": "ratio", "value": 0.07}}
    driven = viscous(FORCE * BASE_RADIUS / FAST)
    run = runs(
        bending_pair(
            *(FAST, 2, {"kind": "steady"}),
            **{"driven": driven, "integrator": integrator, "outputs": 4000, **given},
        )
    )
    assert run.exit_code == 0, run.messages
    h = run.history
    assert float(h.tip_rounding[0]) == rounding
    force, pressure = h.pair_normal_force.values, h.pair_contact_pressure.values
    on_edge = (h.pair_contact_kind.values > 0) & (force > 1e-3 * FORCE)
    assert on_edge.any()
    per_curvature = force[on_edge] / WIDTH * float(h.effective_modulus[0]) / np.pi
    of_mate = pressure[on_edge] ** 2 / per_curvature - 1 / rounding
    tip = np.sqrt((0.078 - rounding) ** 2 - BASE_RADIUS**2) + rounding
    # further out on the mate than the start of its path: the foot point reverses there
    start = float(h.line_of_action_length[0]) - tip
    assert (of_mate < (1 + 1e-3) / start).all()
    assert (of_mate > 1 / (start + 1e-3)).all()
    largest = float(h.pair_contact_pressure_max[0])
    assert largest == pytest.approx(np.nanmax(pressure), rel=1e-3)
    assert largest >= np.nanmax(pressure)


@both_integrators
def test_energy_is_kept_without_edges_through_twenty_pitches(runs: Runs, integrator: str) -> None:
    """From a start with 30 % too little deflection; energy at entry and exit of pairs is booked."""
    left = []
    for tolerance in (1e-8, 1e-12):
        case = bending_pair(
            *(FAST, 20, start(FAST, 8e-6)),
            **{"tolerance": tolerance, "integrator": integrator, "outputs": 2000},
            edge_contact="false",
        )
        run = runs(case)
        assert run.exit_code == 0, run.messages
        left.append(np.ptp(energy(run)) / float(run.history.potential_energy.max()))
    assert left[0] < 2e-5
    assert left[1] < min(2e-7, left[0] / 3)


def test_a_slow_run_is_the_mesh_at_rest(runs: Runs, kernel: Kernel) -> None:
    """Over a pitch, with corner contact; h lags by 3e-8 of h, by inertia and damping."""
    slow = 2e-3
    damping = {"law": "ratio", "value": 0.07}
    case = bending_pair(
        *(slow, 1, {"kind": "steady"}),
        driven=viscous(FORCE * BASE_RADIUS / slow),
        damping=damping,
        tolerance=1e-10,
    )
    run = runs(case)
    assert run.exit_code == 0, run.messages
    h = run.history
    wheel = (TEETH, 0.0, BORE)
    mesh, samples = real_mesh(kernel, wheel, wheel, WIDTH)
    mesh.line = float(h.line_of_action_length.values.ravel()[0])
    mesh.reach = 0.4 * mesh.base_pitch
    rho = np.nanmin(h.pair_position.values.reshape(h.sizes["time"], -1)[:, :3], axis=1)
    curve = true_mesh(kernel, mesh, samples, E, rho, FORCE)
    np.testing.assert_allclose(h.penetration.values.ravel(), curve.h, rtol=1e-6)
    carried = h.pair_normal_force.values.reshape(len(rho), -1)
    np.testing.assert_allclose(carried.max(axis=1), curve.force.max(axis=1) * WIDTH, rtol=1e-6)


def test_a_pair_first_touches_where_another_program_says(runs: Runs) -> None:
    """Its tip edge meets the mate 0.0988 base pitches before the nominal start of the path."""
    slow = 2e-3
    damping = {"law": "ratio", "value": 0.07}
    case = bending_pair(
        *(slow, 2, {"kind": "steady"}),
        driven=viscous(FORCE * BASE_RADIUS / slow),
        damping=damping,
        tolerance=1e-9,
        backlash=0,
    )
    run = runs(case)
    events = run.events.where(run.events["flank"] == 0, drop=True)
    names, pairs, times = (events[name].values for name in ("kind", "tooth_pair", "time"))
    turned = -events["reference_angle"].values[:, 0]
    closed, begun = names == "edge_closed", names == "flank_reached"
    pair = max(set(pairs[closed]) & set(pairs[begun]))
    (touched,), (reached,) = (turned[what & (pairs == pair)] for what in (closed, begun))
    pitches = (reached - touched) / PITCH
    # its flank is reached where rho_B is that of the tip, h after the nominal start
    (time,) = times[begun & (pairs == pair)]
    h = float(run.history.penetration.interp(time=time).values.ravel()[0])
    pitches -= h / (BASE_RADIUS * PITCH)
    assert pitches == pytest.approx(0.098846, abs=1e-5)


def tips_in_fillets(amount: float, **given: Any) -> dict[str, Any]:
    """The path starts 40 um of roll above the fillet; with a steep relief the edge starts below.

    With a steeper one the flank extends so far that its edge never carries load.
    """
    wheel = {"tip_alteration": 0.17, "tip_relief": {"amount": amount, "diameter": 0.156}}
    given |= {"of_wheels": wheel, "tooth_coupling": "false"}
    damping = {"law": "ratio", "value": 0.07}
    return bending_pair(FAST, 2, start(FAST, 8e-6), damping=damping, **given)


tips = pytest.mark.parametrize("amount", [2e-6, 1.1e-5], ids=["edge", "end of the flank"])


@both_integrators
@tips
def test_a_tip_in_the_fillet_of_its_mate_ends_a_run(
    runs: Runs, integrator: str, amount: float
) -> None:
    run = runs(tips_in_fillets(amount, integrator=integrator))
    assert run.exit_code == 4, run.messages
    assert "wheel touches the fillet of the" in run.messages
    assert "relieve the tips, or reduce the load" in run.messages


@tips
def test_a_tip_in_the_fillet_of_its_mate_is_refused_at_rest(
    evolvent: Callable[..., subprocess.CompletedProcess[str]], tmp_path: Path, amount: float
) -> None:
    file = tmp_path / "case.yaml"
    file.write_text(json.dumps(tips_in_fillets(amount)))
    done = evolvent("static", file, "-o", tmp_path / "x.h5")
    assert done.returncode == 3, done.stderr
    assert "wheel touches the fillet of the" in done.stderr


# teeth, profile shift of the pinion, its torque [N m]; message
TOO_MUCH = {
    "14/80": (14, 0.2, 200.0, "N with a tip edge 0.4 pitches off its path of contact"),
    "20/80": (20, 0.0, 1000.0, "N with a tip edge 0.4 pitches off its path of contact"),
}


@both_integrators
def test_a_pair_past_both_ends_of_its_path_ends_a_run(runs: Runs, integrator: str) -> None:
    """A path of 9 um, with a larger deflection of the teeth."""
    (tip, _) = tip_diameters((TEETH, TEETH), 0.0251)  # less the backlash
    case = bending_pair(
        *(FAST, 0.1, start(FAST, 2e-5)),
        **{"integrator": integrator, "of_wheels": {"tip_diameter": tip}},
    )
    run = runs(case)
    assert run.exit_code == 4, run.messages
    assert "past both ends of its path of contact and carries force" in run.messages


@both_integrators
@pytest.mark.parametrize(("teeth", "shift", "load", "said"), TOO_MUCH.values(), ids=TOO_MUCH)
def test_what_edges_cannot_carry_ends_a_run(
    runs: Runs, integrator: str, teeth: int, shift: float, load: float, said: str
) -> None:
    """Far off the path, where the model of tip edges is not valid."""
    speed = 150.0
    start_here = {"pinion": -speed, "gear": speed * teeth / 80}
    held = {"bore": 0.008, "compliance": {}}
    case = real_pair(
        (teeth, 80),
        width=WIDTH,
        wheels=(
            {**held, "profile_shift": shift, **torque(-load)},
            {**held, **torque(-load * 80 / teeth)},
        ),
        mesh={"backlash": 1e-5, "tooth_coupling": "false"},
        **{"duration": 4e-3, "output_interval": 1e-5, "tolerance": 1e-7},
        **{"integrator": integrator},
        initial={"kind": "speeds", "speeds": start_here, "gaps": {"pinion-gear": -1e-5}},
    )
    run = runs(case)
    assert run.exit_code == 4, run.messages
    assert said in run.messages


def test_both_integrators_have_one_motion(runs: Runs) -> None:
    """The difference is the error of both tolerances, 1e-10 of the scales per step."""
    found = []
    for integrator in ("radau", "ida"):
        case = bending_pair(FAST, 6, start(FAST, 8e-6), tolerance=1e-11, integrator=integrator)
        run = runs(case)
        assert run.exit_code == 0, run.messages
        found.append(run)
    for name in ("penetration", "pair_normal_force", "potential_energy", "mesh_torque_driving"):
        radau, ida = (run.history[name].values for run in found)
        np.testing.assert_allclose(radau, ida, atol=1e-5 * np.nanmax(np.abs(ida)), equal_nan=True)
    kinds = [list(run.events["kind"].values) for run in found]
    assert kinds[0] == kinds[1]


@pytest.mark.parametrize(("coupling", "largest"), [("true", 1.5), ("false", 1.9)])
def test_pairs_of_a_damped_mesh_push_and_share(runs: Runs, coupling: str, largest: float) -> None:
    """Expected properties: no adhesive forces, mean forces of the load, no loss of contact.

    Edges are in contact before and after the path: no pair takes its load at once.
    """
    damping = {"law": "ratio", "value": 0.07}
    case = bending_pair(
        *(FAST, 40, {"kind": "steady"}),
        driven=viscous(FORCE * BASE_RADIUS / FAST),
        damping=damping,
        tooth_coupling=coupling,
        outputs=4000,
    )
    run = runs(case)
    assert run.exit_code == 0, run.messages
    assert not [v for v in check_history(run.history) if v.failed]
    forces = np.nan_to_num(run.history.pair_normal_force.values)
    assert forces.min() >= 0
    assert float(run.history.normal_force.mean()) == pytest.approx(FORCE, rel=5e-3)
    assert float(run.history.normal_force.max()) < largest * FORCE
    assert float(run.history.penetration.min()) > 0


def test_one_pair_has_the_stiffness_that_its_compliance_says(runs: Runs) -> None:
    """At the pitch point, dF/dh is Johnson's and C = c_A + c_B of the other program in series."""
    run = runs(bending_pair(FAST, 0.1, start(FAST, 8e-6), outputs=2))
    h = run.history
    rho = 0.075 * np.sin(np.radians(20))  # close to the third position of the table: E c 6.2578
    assert rho == pytest.approx(0.025652, abs=1e-5)
    compliance = 2 * np.interp(rho, [0.023299863, 0.026475907], [5.10490, 6.25779]) / E
    e_star = float(h.effective_modulus.values.ravel()[0])
    load = float(h.reference_force.values.ravel()[0]) / WIDTH
    johnson = (np.log(4 * np.pi * e_star * 2 * rho / load) - 2) / (np.pi * e_star)
    stiffness = WIDTH / (johnson + compliance)
    # c is linear between two positions of the table: 1 %
    assert float(h.reference_stiffness.values.ravel()[0]) == pytest.approx(stiffness, rel=1e-2)
    frequency = np.sqrt(stiffness / float(h.reference_mass.values.ravel()[0])) / (2 * np.pi)
    assert float(h.natural_frequency.values.ravel()[0]) == pytest.approx(frequency, rel=5e-3)
