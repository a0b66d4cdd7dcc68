"""Moving housing: conservation laws, gyroscopic moments, apparent forces, limits."""

from __future__ import annotations

import json
import subprocess
from typing import Any

import numpy as np
import pytest

from evolvent import check_history
from system.cases import pair
from system.runs import Run, Runs
from system.scaled_cases import Scales, scaled_case

BODY = {
    "kind": "mounted",
    "mass": 300.0,
    "centre_of_mass": [0.2, 0.05, -0.1],
    "inertia": [20.0, 35.0, 40.0],
    "products_of_inertia": [1.0, -2.0, 3.0],
}
# of the wheels and the masses that move with them, as in the cases below
SUPPORT_MASS = np.array([0.0, 10.0])


def rotated(orientation: Any, x: Any) -> Any:
    """Rotate vectors in the housing frame into the ground frame; rows are times."""
    p0, q = orientation[:, :1], orientation[:, 1:]
    along = 2 * q * (q * x).sum(axis=1, keepdims=True)
    return (p0**2 - (q * q).sum(axis=1, keepdims=True)) * x + along + 2 * p0 * np.cross(q, x)


def in_space(plane: Any, z: float | Any) -> Any:
    """Append z to vectors (time, axis) in the plane."""
    return np.column_stack([plane, np.full(len(plane), z)])


def loose() -> dict[str, Any]:
    """Return a case without external forces and dissipation."""
    case = pair()
    case["wheels"][0]["loads"] = []
    case["wheels"][0]["axial_position"] = 0.03
    case["wheels"][0]["support"] = {"kind": "bearing", "stiffness": [2e7, 3e7]}
    case["wheels"][1]["loads"] = []
    case["wheels"][1]["support"] = {
        **{"kind": "slider", "direction": 20, "mass": 10, "stiffness": 1e8}
    }
    case["meshes"][0]["damping"] = {"law": "none"}
    case["meshes"][0]["friction"] = {"law": "none"}
    case["housing"] = {
        **BODY,
        "orientation": [0.9, 0.1, -0.3, 0.2],
        "velocity": [0.3, -0.2, 0.1],
        "angular_velocity": [0.4, -0.3, 0.5],
    }
    case["simulation"] = {
        "duration": 0.2,
        "output_interval": 1e-3,
        "tolerance": 1e-11,
        "initial": {
            "kind": "speeds",
            "speeds": {"pinion": -6.0, "gear": 3.9},
            "gaps": {"pinion-gear": -2e-6},
        },
    }
    return case


@pytest.fixture(scope="module")
def free(runs: Runs) -> Run:
    return runs(loose())


def momenta(run: Run) -> tuple[Any, Any]:
    """Linear momentum, and angular momentum about the ground's origin, dims (time, space)."""
    h = run.history
    position, orientation, velocity, omega = (
        h[f"housing_{name}"].values
        for name in ("position", "orientation", "velocity", "angular_velocity")
    )

    def body(mass: float, centre: Any, rate: Any, spin: Any) -> tuple[Any, Any]:
        """Momenta of a body from its position, relative velocity and own angular momentum."""
        linear = mass * (velocity + rotated(orientation, np.cross(omega, centre) + rate))
        location = position + rotated(orientation, centre)
        return linear, np.cross(location, linear) + rotated(orientation, spin)

    xy, yz, xz = BODY["products_of_inertia"]
    tensor = np.diag(BODY["inertia"]) + np.array([[0, xy, xz], [xy, 0, yz], [xz, yz, 0]])
    centre = np.tile(BODY["centre_of_mass"], (len(position), 1))
    linear, angular = body(BODY["mass"], centre, 0.0, omega @ tensor)
    for i in range(2):
        wheel = h.isel(wheel=i)
        mass = float(wheel["mass"]) + SUPPORT_MASS[i]
        along, across = float(wheel["inertia"]), float(wheel["transverse_inertia"])
        centre = in_space(
            wheel["centre"].values + wheel["centre_displacement"].values,
            float(wheel["axial_position"]),
        )
        spin = omega * [across, across, along]
        spin[:, 2] += along * wheel["angular_velocity"].values
        parts = body(mass, centre, in_space(wheel["centre_velocity"].values, 0.0), spin)
        linear, angular = linear + parts[0], angular + parts[1]
    return linear, angular


def test_without_forces_from_outside_momentum_and_angular_momentum_are_conserved(
    free: Run,
) -> None:
    assert free.history["in_contact"].values.any()
    assert np.abs(free.history["centre_displacement"].values).max() > 1e-5
    for momentum in momenta(free):
        drift = np.abs(momentum - momentum[0]).max()
        assert drift < 1e-9 * np.linalg.norm(momentum[0])  # measured 2e-14


def test_without_losses_energy_is_conserved(free: Run) -> None:
    h = free.history
    energy = h["kinetic_energy"] + h["potential_energy"]
    # A separating flank removes the force that remains below the root: D is 2e-8 J.
    assert float(abs(energy - energy[0]).max()) < 1e-9 * float(energy[0])
    assert float(h["dissipated_energy"].max()) < 1e-9 * float(energy[0])
    assert not h["load_work"].values.any()


@pytest.mark.parametrize(
    ("length", "mass"), [(2.0**-14, 2.0**-20), (2.0**-10, 2.0**-30), (2.0**10, 2.0**20)]
)
@pytest.mark.parametrize("kind", ["loose", "mounted"])
def test_a_mounted_housing_moves_alike_in_other_units(
    runs: Runs, kind: str, length: float, mass: float
) -> None:
    """Small moments of inertia and torques are accurate in the presence of accelerations."""
    mount = {"stiffness": [1e7] * 3, "rotational_stiffness": [1e6] * 3}
    case = loose() if kind == "loose" else mounted(mount=mount)
    other = scaled_case(runs.executable, case, Scales(length=length, mass=mass))
    here, there = runs(case).history, runs(other, "simulation.max_steps=1e5").history
    for name, unit in (
        ("angular_velocity", 1.0),
        ("housing_angular_velocity", 1.0),
        ("housing_orientation", 1.0),
        ("kinetic_energy", mass * length**2),
    ):
        size = float(abs(here[name]).max())
        # Powers of two are exact: 0 in small units; in large ones 7e-12, by different pivots.
        np.testing.assert_allclose(there[name] / unit, here[name], rtol=0, atol=1e-10 * size)


def test_the_quaternion_keeps_its_norm(free: Run) -> None:
    norms = np.linalg.norm(free.history["housing_orientation"].values, axis=1)
    assert np.abs(norms - 1).max() < 1e-12


def test_a_turn_about_x_makes_the_gyroscopic_moment_of_the_wheels(runs: Runs) -> None:
    """The reaction on the housing is J_z omega x Omega."""
    case = pair()
    case["wheels"][0]["loads"] = [{"kind": "speed", "value": -30.0, "against": "housing"}]
    case["wheels"][1]["loads"] = [{"kind": "viscous", "coefficient": 2.0, "against": "housing"}]
    del case["wheels"][1]["support"]
    rate = 0.7
    case["housing"] = {
        "kind": "prescribed",
        "rotation": [{"kind": "rate", "axis": "x", "value": rate}],
    }
    case["simulation"] = {
        **{"duration": 0.1, "output_interval": 1e-3},
        "initial": {"kind": "speeds", "speeds": {"pinion": -30.0, "gear": 20.0}},
    }
    h = runs(case).history
    spin = h["inertia"] * h["angular_velocity"]  # J_z omega along z
    moment = h["bearing_moment"]
    expected = spin * rate  # k x i = j
    largest = float(abs(expected).max())
    assert float(abs(moment.sel(space="y") - expected).max()) < 1e-9 * largest
    assert float(abs(moment.sel(space="x")).max()) < 1e-9 * largest
    # about z: the reactions of motor and brake, which are fixed to the housing
    np.testing.assert_allclose(moment.sel(space="z"), -h["load_torque"], rtol=1e-12)


def turning(rate: float, slider: bool) -> dict[str, Any]:
    """Return the paper's pair in a housing rotating about z, its torques against the housing."""
    case = pair(duration=1.0)
    case["wheels"][0]["loads"][0]["against"] = "housing"
    case["wheels"][1]["loads"][0]["against"] = "housing"
    if not slider:
        del case["wheels"][1]["support"]
    case["housing"] = {
        "kind": "prescribed",
        "rotation": [{"kind": "rate", "axis": "z", "value": rate}],
    }
    return case


def test_a_steady_turn_about_z_changes_no_penetration_of_fixed_axles(runs: Runs) -> None:
    still = {**turning(5.0, slider=False), "housing": {"kind": "fixed"}}
    fixed = runs(still).history["gap"]
    turned = runs(turning(5.0, slider=False)).history["gap"]
    assert float(abs(turned - fixed).max()) < 1e-11 * float(abs(fixed).max())


def test_a_steady_turn_about_z_moves_the_slider_by_the_centrifugal_force(runs: Runs) -> None:
    rate, stiffness, distance = 5.0, 1e9, 0.5
    still = runs({**turning(rate, slider=True), "housing": {"kind": "fixed"}}).history
    h = runs(turning(rate, slider=True)).history
    mass = float(h["mass"][1]) + 10.0
    # the contact force on the slider is the same in both
    moved = (h - still)["centre_displacement"].sel(wheel="gear", axis="x")[-100:]
    expected = mass * distance * rate**2 / (stiffness - mass * rate**2)
    np.testing.assert_allclose(moved, expected, rtol=2e-7)  # except for its direction: 7e-8
    np.testing.assert_allclose(moved, mass * distance * rate**2 / stiffness, rtol=1e-5)


def test_torques_against_the_ground_feel_the_turn_of_the_housing(runs: Runs) -> None:
    """A brake on the ground holds the gear at rest there: its torque is -c (phi' + Omega_z)."""
    case = turning(5.0, slider=False)
    case["wheels"][1]["loads"][0]["against"] = "ground"
    h = runs(case).history
    seen = h["angular_velocity"].sel(wheel="gear") + 5.0
    np.testing.assert_allclose(h["load_torque"].sel(wheel="gear"), -10.0 * seen, rtol=1e-12)


def mounted(**body: Any) -> dict[str, Any]:
    """Return the paper's pair in a mounted housing."""
    return {**pair(friction=0.3, duration=0.5), "housing": {**BODY, **body}}


def test_a_heavy_mounted_housing_tends_to_the_fixed_one(runs: Runs) -> None:
    fixed = runs({**mounted(), "housing": {"kind": "fixed"}}).history
    differences = []
    for mass in (1e5, 1e7):
        heavy = {"mass": mass, "inertia": [mass] * 3, "products_of_inertia": [0, 0, 0]}
        mount = {"stiffness": [1e5 * mass] * 3, "rotational_stiffness": [1e5 * mass] * 3}
        h = runs(mounted(**heavy, mount=mount)).history
        settled = slice(300, None)
        difference = abs(h["normal_force"] - fixed["normal_force"])[settled].max()
        differences.append(float(difference / fixed["normal_force"].max()))
    assert differences[1] < 1e-5
    assert differences[1] < differences[0] / 30  # inversely proportional to the mass


def test_a_still_prescribed_housing_is_a_fixed_one(runs: Runs) -> None:
    case = pair(friction=0.3, duration=0.5)
    fixed = runs(case).history
    posed = {
        "kind": "prescribed",
        "translation": [{"kind": "rate", "axis": "y", "value": 3.0}],
        "rotation": [{"kind": "constant", "axis": "x", "value": 30.0}],
    }
    moved = runs({**case, "housing": posed}).history
    for name in ("gap", "angular_velocity", "normal_force", "bearing_force"):
        np.testing.assert_array_equal(moved[name], fixed[name], err_msg=name)
    y = moved["housing_position"].sel(space="y")
    np.testing.assert_allclose(y, 3.0 * moved["time"], rtol=1e-15)


MOUNT = {
    "point": [0.25, -0.2, 0.1],
    "stiffness": [1e6, 2e6, 1.5e6],
    "damping": [100.0, 100.0, 200.0],
    "rotational_stiffness": [1e5, 1e5, 2e5],
    "rotational_damping": [10.0, 10.0, 20.0],
}


def test_a_steady_start_finds_the_pose_in_which_weight_and_torques_balance(runs: Runs) -> None:
    case = mounted(mount=MOUNT)
    case["meshes"][0]["friction"] = {"law": "none"}
    case["gravity"] = [0.3, -9.81, 0.5]
    case["simulation"] = {
        **{"duration": 0.2, "output_interval": 1e-2},
        "initial": {"kind": "steady"},
    }
    h = runs(case).history
    # It stays at rest, and the mount carries the weight.
    sagged = h["housing_position"]
    assert float(abs(sagged - sagged[0]).max()) < 1e-9 * float(abs(sagged[0]).max())
    mass = BODY["mass"] + float(h["mass"].sum()) + SUPPORT_MASS.sum()
    weight = mass * np.array(case["gravity"])
    orientation = h["housing_orientation"].values[:1]
    point = np.array([MOUNT["point"]])
    deflection = (sagged.values[:1] + rotated(orientation, point) - point)[0]
    np.testing.assert_allclose(MOUNT["stiffness"] * deflection, weight, rtol=1e-10)


def frequencies(evolvent_modes: dict[str, Any]) -> Any:
    """Return the natural frequencies of the modes that vibrate [rad/s]."""
    values = [complex(*mode["eigenvalue"]) for mode in evolvent_modes["modes"]]
    return np.array([abs(value) for value in values if value.imag > 0])


def modes(runs: Runs, case: dict[str, Any]) -> dict[str, Any]:
    """Return the result of `evolvent modes` for a case."""
    file = runs.folder / "modes.yaml"
    file.write_text(json.dumps(case))
    command = [runs.executable, "modes", file, "--json"]
    done = subprocess.run(command, check=True, capture_output=True, text=True, timeout=60)
    return json.loads(done.stdout)


def undamped(**mount: Any) -> dict[str, Any]:
    """Return a balanced mounted housing: the mount is at the centre of mass of the gearbox."""
    case = mounted(centre_of_mass=[0.0, 0.0, 0.0], products_of_inertia=[0, 0, 0])
    case["meshes"][0]["friction"] = {"law": "none"}
    masses = 7800 * np.pi * 0.1 * np.array([0.2, 0.3]) ** 2 + SUPPORT_MASS
    location = 0.5 * masses[1] / (BODY["mass"] + masses.sum())
    case["housing"]["mount"] = {"point": [location, 0, 0], **mount}
    return case


def test_modes_of_a_mounted_housing_have_the_frequencies_of_closed_forms(runs: Runs) -> None:
    stiffness = [1e5, 2e5, 3e5]
    case = undamped(stiffness=stiffness, rotational_stiffness=[1e5, 1e5, 1e5])
    found = frequencies(modes(runs, case))
    masses = 7800 * np.pi * 0.1 * np.array([0.2, 0.3]) ** 2 + SUPPORT_MASS
    mass = BODY["mass"] + masses.sum()
    # Along z the whole mass moves; along x and y the slider yields by 1e-4.
    assert np.abs(found / np.sqrt(stiffness[2] / mass) - 1).min() < 1e-9
    # About x: all inertias about the axis through the centres, with no mass off that axis.
    discs = 7800 * np.pi * 0.1 * np.array([0.2, 0.3]) ** 2
    across = (discs * (3 * np.array([0.2, 0.3]) ** 2 + 0.1**2) / 12).sum()
    # The gyroscopic moments of the wheels change it by 1e-7.
    assert np.abs(found / np.sqrt(1e5 / (BODY["inertia"][0] + across)) - 1).min() < 1e-6


def test_a_mounted_housing_rings_at_the_frequency_of_its_mode(runs: Runs) -> None:
    """About y: this rotation is uncoupled, and the periods are counted in the history."""
    case = undamped(stiffness=[1e5, 2e5, 3e5], rotational_stiffness=[1e5, 4e5, 1e5])
    case["housing"]["angular_velocity"] = [0.0, 1e-5, 0.0]
    case["simulation"] = {"duration": 0.5, "output_interval": 1e-4, "tolerance": 1e-11}
    h = runs(case).history
    rate = h["housing_angular_velocity"].sel(space="y").values
    del case["housing"]["angular_velocity"]
    found = frequencies(modes(runs, case))
    at = np.flatnonzero((rate[:-1] < 0) & (rate[1:] >= 0))
    times = h["time"].values
    crossings = times[at] - rate[at] * (times[at + 1] - times[at]) / (rate[at + 1] - rate[at])
    assert len(crossings) > 4
    rung = 2 * np.pi / np.diff(crossings).mean()
    assert np.abs(found / rung - 1).min() < 1e-5


def test_every_invariant_holds_on_a_shaken_and_on_a_mounted_housing(runs: Runs) -> None:
    shaken = pair(friction=0.3, duration=0.5)
    shaken["gravity"] = [0, -9.81, 0]
    shaken["housing"] = {
        "kind": "prescribed",
        "translation": [
            {"kind": "harmonic", "axis": "x", "amplitude": 1e-4, "frequency": 20},
            {"kind": "table", "axis": "y", "time": [0, 0.2, 0.5], "value": [0, 1e-3, 0]},
        ],
        "rotation": [{"kind": "harmonic", "axis": "z", "amplitude": 1e-4, "frequency": 7}],
    }
    mount = mounted(mount=MOUNT)
    mount["gravity"] = [0, -9.81, 0]
    for case in (shaken, mount):
        run = runs(case)
        assert run.exit_code == 0, run.messages
        broken = [verdict for verdict in check_history(run.history) if verdict.failed]
        assert broken == []
