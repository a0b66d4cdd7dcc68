"""Natural modes: against independent eigenproblems, closed forms, and time histories."""

from __future__ import annotations

import json
import math
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from gearbox_reference import Gearbox, Setup
from hand_modes import Mesh, Modes, Wheel, johnson, modes, paper_angle

from evolvent import open_history
from system.steady_pairs import steady_pair

TORQUE, VISCOUS = 1.0, 10.0
PAPER_ANGLE = paper_angle(20, 30)
STEEL = {"youngs_modulus": 2.0e11, "poisson_ratio": 0.3, "density": 7800}


@pytest.fixture
def modes_of(evolvent) -> Callable[..., dict[str, Any]]:
    """Output of `evolvent modes ... --json`."""

    def run(*words) -> dict[str, Any]:
        result = evolvent("modes", *words, "--json")
        assert result.returncode == 0, result.stderr
        return json.loads(result.stdout)

    return run


@pytest.fixture
def write_case(tmp_path) -> Callable[..., str]:
    """Write a case in JSON, which is valid YAML; omitted keys have the defaults of the schema."""

    def write(wheels: list[dict], meshes: list[dict], **simulation) -> str:
        wheels = [{"width": 0.1, "material": "steel", **wheel} for wheel in wheels]
        case = {
            "format": 1,
            "materials": {"steel": STEEL},
            "wheels": wheels,
            "meshes": meshes,
            "simulation": {"duration": 1, "output_interval": 0.1, **simulation},
        }
        path = tmp_path / "case.yaml"
        path.write_text(json.dumps(case))
        return str(path)

    return write


def eigenvalues(found: dict[str, Any]) -> np.ndarray:
    return np.array([complex(*mode["eigenvalue"]) for mode in found["modes"]])


def column(found: dict[str, Any], kind: str, key: str) -> np.ndarray:
    """Values (wheel or mesh, mode) of the shapes."""
    return np.array(
        [[complex(*part[key]) for part in mode[kind].values()] for mode in found["modes"]]
    ).T


def assert_same_modes(found: dict[str, Any], expected: Modes) -> None:
    # Rounding: eps times the norm of the matrix, 1e4 1/s, is 1e-12 of the slowest eigenvalue, times
    # its condition number.
    np.testing.assert_allclose(eigenvalues(found), expected.eigenvalues, rtol=1e-9)
    shapes = {
        ("wheels", "arc"): expected.arcs,
        ("wheels", "displacement_x"): expected.displacements[:, 0],
        ("wheels", "displacement_y"): expected.displacements[:, 1],
        ("meshes", "penetration"): expected.penetrations,
    }
    both = [
        np.concatenate([column(found, *key) for key in shapes]),
        np.concatenate(list(shapes.values())),
    ]
    largest = (np.argmax(np.abs(both[1]), axis=0), range(len(expected.eigenvalues)))
    phases = [values / np.exp(1j * np.angle(values[largest])) for values in both]
    np.testing.assert_allclose(*phases, rtol=0, atol=1e-9)


def paper_by_hand() -> Modes:
    wheels = [
        Wheel(20, 0.2, 0.1, (0, 0), torque=-TORQUE),
        Wheel(30, 0.3, 0.1, (0.5, 0), 0, VISCOUS, [(1, 0)], [1e9], [1e5], extra_mass=10),
    ]
    return modes(wheels, [Mesh(0, 1, +1, PAPER_ANGLE, damping=1e4)])


def test_the_papers_case_has_the_eigenvalues_of_the_problem_assembled_by_hand(modes_of, examples):
    found = modes_of(examples / "paper.yaml")
    assert_same_modes(found, paper_by_hand())
    assert found["rigid_body_modes"] == 1
    assert found["state"]["kind"] == "steady"


def test_the_papers_case_has_the_recorded_digits(modes_of, examples):
    # Recorded from an earlier program in C; four digits, three of the real parts.
    _, slider, contact = eigenvalues(modes_of(examples / "paper.yaml"))
    assert (round(contact.real), round(contact.imag)) == (-146, 7206)
    assert (round(slider.real), round(slider.imag)) == (-216, 2069)


def test_frequency_and_damping_follow_from_the_eigenvalue(modes_of, examples):
    slow, *oscillations = modes_of(examples / "paper.yaml")["modes"]
    assert slow["natural_frequency"] is slow["damped_frequency"] is slow["damping_ratio"] is None
    assert slow["time_constant"] == pytest.approx(-1 / slow["eigenvalue"][0], rel=1e-15)
    for mode in oscillations:
        pair = complex(*mode["eigenvalue"])
        rate = 2 * math.pi * mode["natural_frequency"]
        ratio = mode["damping_ratio"]
        rebuilt = rate * complex(-ratio, math.sqrt(1 - ratio**2))
        assert rebuilt == pytest.approx(pair, rel=1e-14)
        assert 2 * math.pi * mode["damped_frequency"] == pytest.approx(pair.imag, rel=1e-14)


def test_all_trackings_have_the_same_modes(modes_of, examples):
    setting = ("--set", "meshes.0.tracking=closed_form")
    expected = eigenvalues(modes_of(examples / "paper.yaml", *setting))
    for tracking in ("algebraic", "differential"):
        setting = ("--set", f"meshes.0.tracking={tracking}")
        # the same matrix except for the order of the states; rounding as above
        np.testing.assert_allclose(
            eigenvalues(modes_of(examples / "paper.yaml", *setting)), expected, rtol=1e-11
        )


@pytest.mark.parametrize("across", [0, 2e4], ids=["along the centre line", "both ways"])
def test_the_mirrored_flank_has_the_same_modes(modes_of, examples, across):
    """Also for a gear that moves across the centre line, whose direction then changes."""
    support = (
        "wheels.gear.support={kind: bearing, mass: 10, stiffness: [1e9, 3e8], damping: [1e5, %g]}"
    )
    moves = ("--set", support % across) if across else ()
    mirrored = modes_of(
        examples / "paper.yaml",
        *moves,
        *("--set", "meshes.0.driving_rotation=counterclockwise"),
        *("--set", "wheels.pinion.loads.0.value=1"),
    )
    expected = modes_of(examples / "paper.yaml", *moves)
    np.testing.assert_allclose(eigenvalues(mirrored), eigenvalues(expected), rtol=1e-11)
    for key in ("penetration", "transmission_error"):
        # Mirroring reverses the wheels' rotations, and with them the phase reference.
        np.testing.assert_allclose(
            np.abs(column(mirrored, "meshes", key)),
            np.abs(column(expected, "meshes", key)),
            rtol=0,
            atol=1e-10,
        )


def free_pair(**simulation) -> tuple[list[dict], list[dict], dict]:
    """The paper's wheels on fixed axles, without any load or damping."""
    wheels = [
        {"name": "a", "teeth": 20, "pitch_radius": 0.2, "centre": [0, 0]},
        {"name": "b", "teeth": 30},
    ]
    mesh = {
        "driving": "a",
        "driven": "b",
        "driving_rotation": "clockwise",
        "centre_line_angle": 0,
        "pressure_angle": "paper_rule",
    }
    return wheels, [mesh], simulation


def contact_stiffness(h: float) -> float:
    """Stiffness of the paper's pair on fixed axes: dF/dh + dF/d(rho_A + rho_B) [N/m]."""
    rho = 0.5 * math.sin(PAPER_ANGLE)
    load = 5.0
    for _ in range(60):  # fixed point of (13) for the force at h: contracts by 0.05
        modulus = math.pi * Mesh(0, 1, 1, 0).e_star
        load = modulus * h / (math.log(4 * modulus * (rho + h) / load) - 1)
    found, d_h, d_rho = johnson(load * 0.1, rho, 0.1, Mesh(0, 1, 1, 0).e_star)
    assert found == pytest.approx(h, rel=1e-13)
    return d_h + d_rho


def mobility(*radii: float) -> float:
    """Contact mobility of free discs of these pitch radii: the sum of r_b^2/J [1/kg]."""
    return sum((r * math.cos(PAPER_ANGLE)) ** 2 / Wheel(20, r, 0.1, (0, 0)).inertia for r in radii)


def test_a_free_pair_without_damping_rings_for_ever_at_the_closed_forms_frequency(
    modes_of, write_case
):
    h = 3e-9
    initial = {"kind": "speeds", "speeds": {"a": -3, "b": 2}, "gaps": {"a-b": -h}}
    wheels, meshes, simulation = free_pair(initial=initial)
    found = modes_of(write_case(wheels, meshes, **simulation), "--at", 0)
    (only,) = eigenvalues(found)
    assert found["rigid_body_modes"] == 1
    assert abs(only.real) <= 1e-13 * abs(only)  # rounding
    assert only.imag == pytest.approx(
        math.sqrt(contact_stiffness(h) * mobility(0.2, 0.3)), rel=1e-12
    )
    a, b = column(found, "wheels", "arc")[:, 0]
    # Momentum of free bodies: J_A phi_A/r_bA and J_B phi_B/r_bB are equal.
    assert b / a == pytest.approx(mobility(0.3) / mobility(0.2), rel=1e-12)


def test_a_prescribed_wheel_has_no_motion_of_its_own(modes_of, write_case):
    wheels, meshes, _ = free_pair()
    wheels[0]["loads"] = [{"kind": "speed", "value": -3}]
    wheels[1]["loads"] = [{"kind": "torque", "value": -1}]
    found = modes_of(write_case(wheels, meshes, initial={"kind": "steady"}))
    (only,) = eigenvalues(found)
    h = found["state"]["meshes"]["a-b"]["penetration"]
    assert found["rigid_body_modes"] == 0
    assert only.imag == pytest.approx(math.sqrt(contact_stiffness(h) * mobility(0.3)), rel=1e-12)
    np.testing.assert_array_equal(column(found, "wheels", "arc")[:, 0], [0, 1])


def test_two_prescribed_wheels_have_no_modes(modes_of, write_case):
    wheels, meshes, _ = free_pair()
    wheels[0]["loads"] = [{"kind": "speed", "value": -3}]
    wheels[1]["loads"] = [{"kind": "speed", "value": 2}]
    speeds = {"kind": "speeds", "speeds": {"a": -3, "b": 2}}
    found = modes_of(write_case(wheels, meshes, initial=speeds), "--at", 0)
    assert found["modes"] == []
    assert found["rigid_body_modes"] == 0


def test_parted_flanks_leave_each_wheel_a_rigid_body_mode(modes_of, write_case):
    apart = {"kind": "rest", "gaps": {"a-b": 1e-6}}
    wheels, meshes, _ = free_pair()
    found = modes_of(write_case(wheels, meshes, initial=apart), "--at", 0)
    assert found["state"]["meshes"]["a-b"]["contact"] == "open"
    assert found["modes"] == []
    assert found["rigid_body_modes"] == 2


def test_parted_flanks_leave_each_side_of_a_train_a_rigid_body_mode(modes_of, write_case):
    """Discs on shafts behind one wheel: the rotation of that side is rigid only up to rounding."""
    apart = {"kind": "rest", "gaps": {"a-b": 1e-6}}
    wheels, meshes, _ = free_pair()
    inertia = {"c": 0.3, "d": 0.7, "e": 0.11, "f": 1.3}
    wheels += [{"name": name, "inertia": j, "mass": 9} for name, j in inertia.items()]
    stiffness = {"bc": 1.1e4, "cd": 7.3e4, "de": 2.9e4, "ef": 3.7e4}
    shafts = [{"name": ends, "wheels": list(ends), "stiffness": k} for ends, k in stiffness.items()]
    case = write_case(wheels, meshes, initial=apart)
    found = modes_of(case, "--at", 0, "--set", f"shafts={json.dumps(shafts)}")
    assert found["rigid_body_modes"] == 2
    assert len(found["modes"]) == len(shafts)


def test_a_parted_wheel_runs_down_with_the_time_constant_of_its_load(modes_of, write_case):
    wheels, meshes, _ = free_pair()
    wheels[1]["loads"] = [{"kind": "viscous", "coefficient": 10}]
    apart = {"kind": "rest", "gaps": {"a-b": 1e-6}}
    found = modes_of(write_case(wheels, meshes, initial=apart), "--at", 0)
    (only,) = found["modes"]
    assert only["time_constant"] == pytest.approx(
        Wheel(30, 0.3, 0.1, (0, 0)).inertia / 10, rel=1e-13
    )
    assert only["natural_frequency"] is None
    assert found["rigid_body_modes"] == 2


def three_wheels(supports: list[dict]) -> tuple[list[dict], list[dict]]:
    angle = {"pressure_angle": 20.0}
    wheels = [
        {"name": "a", "teeth": 20, "pitch_radius": 0.2, "centre": [0, 0]},
        {"name": "b", "teeth": 30, "width": 0.08},
        {"name": "c", "teeth": 24},
    ]
    wheels[0]["loads"] = [{"kind": "torque", "value": -300}]
    wheels[2]["loads"] = [{"kind": "viscous", "coefficient": 200}]
    for wheel, support in zip(wheels, supports, strict=True):
        wheel["support"] = support
    damping = {"law": "linear", "coefficient": 2e4}
    meshes = [
        {"driving": "a", "driven": "b", "driving_rotation": "clockwise", "centre_line_angle": 0},
        {
            "driving": "b",
            "driven": "c",
            "driving_rotation": "counterclockwise",
            "centre_line_angle": 50,
        },
    ]
    return wheels, [{**mesh, **angle, "damping": damping} for mesh in meshes]


def three_wheels_by_hand(supports: list[dict]) -> Modes:
    turn = math.radians(50)
    centres = [(0, 0), (0.5, 0), (0.5 + 0.54 * math.cos(turn), 0.54 * math.sin(turn))]
    wheels = [
        Wheel(20, 0.2, 0.1, centres[0], torque=-300),
        Wheel(30, 0.3, 0.08, centres[1]),
        Wheel(24, 0.24, 0.1, centres[2], viscous=200),
    ]
    for wheel, support in zip(wheels, supports, strict=True):
        if support["kind"] == "bearing":
            wheel.directions = [(1, 0), (0, 1)]
            wheel.stiffness, wheel.damping = support["stiffness"], support["damping"]
        elif support["kind"] == "slider":
            angle = math.radians(support["direction"])
            wheel.directions = [(math.cos(angle), math.sin(angle))]
            wheel.stiffness, wheel.damping = [support["stiffness"]], [support["damping"]]
        wheel.extra_mass = support.get("mass", 0.0)
    angle = math.radians(20)
    return modes(wheels, [Mesh(0, 1, +1, angle, damping=2e4), Mesh(1, 2, -1, angle, damping=2e4)])


FIXED = {"kind": "fixed"}
BEARING = {"kind": "bearing", "stiffness": [3e8, 5e8], "damping": [2e4, 1e4], "mass": 5}
SLIDER = {"kind": "slider", "direction": 30, "stiffness": 2e8, "damping": 1e4}


@pytest.mark.parametrize(
    ("supports", "n"),
    [
        ([FIXED, FIXED, FIXED], 3),
        ([BEARING, FIXED, BEARING], 7),
        ([BEARING, BEARING, BEARING], 9),
        ([SLIDER, BEARING, FIXED], 6),
    ],
    ids=["fixed", "outer bearings", "bearings", "slider and bearing"],
)
def test_a_train_of_three_wheels_has_the_modes_of_the_problem_assembled_by_hand(
    modes_of, write_case, supports, n
):
    found = modes_of(write_case(*three_wheels(supports)))
    assert len(found["modes"]) == n  # the speed, two meshes, every degree of freedom of a support
    assert_same_modes(found, three_wheels_by_hand(supports))


@pytest.mark.parametrize(
    ("delta", "branch"), [(1e-4, 1), (0.05, 0)], ids=["sliding", "linear part"]
)
def test_with_friction_the_modes_are_those_of_the_independent_programs_derivatives(
    evolvent, modes_of, examples, tmp_path, delta, branch
):
    settings = (
        *("--set", "simulation.duration=1.2"),
        *("--set", f"meshes.0.friction.regularisation_velocity={delta}"),
    )
    case = examples / "paper-friction.yaml"
    found = modes_of(case, "--at", 1.2, *settings)
    assert found["state"]["meshes"]["pinion-gear"]["friction_branch"] == branch
    assert evolvent("run", case, "-o", "history.h5", *settings).returncode == 0
    gearbox = Gearbox(Setup(friction=0.3, regularisation_velocity=delta))
    with open_history(tmp_path / "history.h5") as history:
        last = history.isel(time=-1, mesh=0)
        omega = last["angular_velocity"].values
        teeth = int(last["tooth_pair"])
        state = np.array(
            [
                gearbox.phi_start + float(last["angle"][0]),
                float(last["transmission_error"]),
                float(last["centre_displacement"][1, 0]),
                omega[0],
                -(gearbox.base_a * omega[0] + gearbox.base_b * omega[1]),
                float(last["centre_velocity"][1, 0]),
                0.0,
                0.0,
            ]
        )
    free = slice(1, 6)  # all but the angle, whose mesh position is fixed, and the energies
    steps = [3e-13, 1e-12, 1e-5, 1e-9, 1e-9]
    derivatives = np.empty((5, 5))
    for j, step in enumerate(steps):
        change = np.zeros(8)
        change[1 + j] = step
        ahead, behind = (
            np.array(gearbox.rhs(state + s * change, teeth, True, branch))[free] for s in (1, -1)
        )
        derivatives[:, j] = (ahead - behind) / (2 * step)
    expected = np.linalg.eigvals(derivatives)
    expected = expected[np.argsort(np.abs(expected))]
    expected = expected[expected.imag >= 0]
    # Central differences: their own error is 1e-8 of the stiffness (step over h squared).
    np.testing.assert_allclose(eigenvalues(found), expected, rtol=1e-6)


def ringing(values: np.ndarray, interval: float, order: int) -> np.ndarray:
    """Exponents of a sum of `order` exponentials, by the matrix pencil method.

    Source: Hua & Sarkar, IEEE Trans. Acoust. Speech Signal Process. 38 (1990), 814-824.
    """
    rows = len(values) // 2
    hankel = np.lib.stride_tricks.sliding_window_view(values, rows)
    _, _, modes_in_time = np.linalg.svd(hankel, full_matrices=False)
    basis = modes_in_time[:order].T
    poles = np.linalg.eigvals(np.linalg.pinv(basis[:-1]) @ basis[1:])
    return np.log(poles.astype(complex)) / interval


def test_the_history_rings_after_a_step_of_the_torque_as_the_modes_say(
    evolvent, modes_of, examples, tmp_path
):
    interval, step = 2e-5, 1e-4
    table = f"{{kind: table, time: [0, {step}, {step * 1.001}], torque: [-1, -1, -1.001]}}"
    settings = (
        *("--set", f"wheels.pinion.loads=[{table}]"),
        *("--set", "simulation.initial={kind: steady}"),
        *("--set", "simulation.duration=0.03"),
        *("--set", f"simulation.output_interval={interval}"),
        *("--set", "simulation.tolerance=1e-12"),
        *("--set", "meshes.0.tracking=closed_form"),
    )
    case = examples / "paper.yaml"
    done = evolvent("run", case, "-o", "ringing.h5", *settings)
    assert done.returncode == 0, done.stderr
    with open_history(tmp_path / "ringing.h5") as history:
        h = history["penetration"].isel(mesh=0).sel(time=slice(1.5 * step, None)).values
    found = ringing(h - h[-1], interval, order=6)  # two oscillations, the speed, a constant
    found = found[np.argsort(np.abs(found))]
    found = found[found.imag > 1000]
    _, slider, contact = eigenvalues(modes_of(case))
    assert len(found) == 2
    for fitted, mode in zip(found, (slider, contact), strict=True):
        # The step changes the force by 1e-3, Johnson's stiffness by a twentieth of that; h vibrates
        # by 1e-3, and so the fit has three digits less than the history's nine.
        assert fitted.imag == pytest.approx(mode.imag, rel=1e-3)
        assert fitted.real == pytest.approx(mode.real, rel=1e-3)


@pytest.mark.parametrize("seed", [0, 1, 2, 3])
def test_a_mesh_that_carries_load_is_said_to_be_loaded(
    modes_of: Callable[..., dict[str, Any]], tmp_path: Path, seed: int
) -> None:
    """For any of its tooth pairs: on drive flanks or, from rest, on coast flanks."""
    case = steady_pair(seed)
    path = tmp_path / "case.yaml"
    backwards = f"wheels.0.loads.0.value={-case['wheels'][0]['loads'][0]['value']}"
    rest = ("--set", "simulation.initial={kind: rest}")
    at = ("--at", str(case["simulation"]["duration"] / 50))
    carried = set()
    path.write_text(json.dumps(case))
    for words in ((), (*rest, *at), (*rest, "--set", backwards, *at)):
        for mesh in modes_of(path, *words)["state"]["meshes"].values():
            carries = mesh["pairs_in_contact"] > 0
            carried.add(carries)
            assert (mesh["contact"] == "loaded") == carries, (words, mesh)
    assert True in carried
