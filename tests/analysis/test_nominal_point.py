"""Nominal operating point, against an independent solution of the torque balance.

The reference sums the torques of all loads as defined in docs/reference/case_format.md, finds the
speed by `scipy.optimize.brentq`, and takes the load of a mesh from the torques on one side of it.
`show --json` and `static` must agree to 1e-9.
"""

from __future__ import annotations

import itertools
import json
import subprocess
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from scipy.optimize import brentq

from kernel.description import kinds
from kernel.kernel import Kernel

Evolvent = Callable[..., subprocess.CompletedProcess[str]]
Block = dict[str, Any]

AGREEMENT = 1e-9  # relative, of speeds and forces
MODULE, WIDTH = 4e-3, 0.02
BASE = MODULE / 2 * np.cos(np.radians(20))  # base radius over the number of teeth
STEEL = {"youngs_modulus": 206e9, "poisson_ratio": 0.3, "density": 7830.0}
SPIN_UP = 1.0  # s, after which the speed of an unbalanced gearbox is evaluated


def drawn_torque(rng: np.random.Generator) -> Block:
    return {"kind": "torque", "value": rng.uniform(-100, 100)}


def drawn_viscous(rng: np.random.Generator) -> Block:
    return {"kind": "viscous", "coefficient": rng.uniform(0.05, 2)}


def drawn_table(rng: np.random.Generator) -> Block:
    times = np.cumsum(rng.uniform(0.01, 0.1, 4)) - 0.05
    return {"kind": "table", "time": times.tolist(), "torque": rng.uniform(-80, 80, 4).tolist()}


def drawn_speed(rng: np.random.Generator) -> Block:
    if rng.random() < 0.5:
        return {"kind": "speed", "value": rng.uniform(-300, 300)}
    times = np.cumsum(rng.uniform(0.01, 0.1, 3))
    return {"kind": "speed", "time": times.tolist(), "speed": rng.uniform(-300, 300, 3).tolist()}


def drawn_harmonic(rng: np.random.Generator) -> Block:
    cycles = {"order": 2.0} if rng.random() < 0.5 else {"frequency": 30.0, "phase": 50.0}
    amplitude = rng.uniform(1, 200)
    return {"kind": "harmonic", "mean": rng.uniform(-90, 90), "amplitude": amplitude, **cycles}


def drawn_drive(rng: np.random.Generator) -> Block:
    return {
        "kind": "drive",
        "speed": rng.uniform(-200, 200),
        "torque": rng.uniform(-50, 50),
        "slope": -(10 ** rng.uniform(-3, 1)),
    }


def drawn_loss(rng: np.random.Generator) -> Block:
    speeds, torques = np.cumsum(rng.uniform(5, 80, 3)), np.cumsum(rng.uniform(0.1, 5, 3))
    return {"kind": "loss", "speed": speeds.tolist(), "torque": torques.tolist()}


DRAWN: dict[str, Callable[[np.random.Generator], Block]] = {
    "torque": drawn_torque,
    "viscous": drawn_viscous,
    "table": drawn_table,
    "speed": drawn_speed,
    "harmonic": drawn_harmonic,
    "drive": drawn_drive,
    "loss": drawn_loss,
}


def table_at(load: Block, key: str, t: float) -> float:
    return float(np.interp(t, load["time"], load[key]))


def loss_at(load: Block, omega: float) -> float:
    size = np.interp(abs(omega), [0.0, *load["speed"]], [0.0, *load["torque"]])
    return -float(np.copysign(size, omega))


# Mean torque [N m] of each kind at a time and a speed of its wheel; None: a prescribed speed.
TORQUES: dict[str, Callable[[Block, float, float], float] | None] = {
    "torque": lambda load, _t, _omega: load["value"],
    "viscous": lambda load, _t, omega: -load["coefficient"] * omega,
    "table": lambda load, t, _omega: table_at(load, "torque", t),
    "speed": None,
    "harmonic": lambda load, _t, _omega: load["mean"],
    "drive": lambda load, _t, omega: load["torque"] + load["slope"] * (omega - load["speed"]),
    "loss": lambda load, _t, omega: loss_at(load, omega),
}


class Train:
    """Wheels in a row, each in mesh with the next, and their loads."""

    def __init__(self, teeth: list[int], loads: list[list[Block]], sense: int = 1):
        self.teeth, self.loads, self.sense = teeth, loads, sense
        self.ratios = np.array([(-1) ** i * teeth[0] / z for i, z in enumerate(teeth)])
        self.inertias = np.array([1e-4 * (1 + i) * z for i, z in enumerate(teeth)])

    def case(self) -> dict[str, Any]:
        """Return the case, whose first mesh turns counterclockwise if the sense is positive."""
        senses = ("counterclockwise", "clockwise")
        wheels = [
            {
                **{"name": f"w{i}", "teeth": z, "module": MODULE, "width": WIDTH},
                **{"material": "steel", "inertia": float(self.inertias[i]), "loads": loads},
            }
            for i, (z, loads) in enumerate(zip(self.teeth, self.loads, strict=True))
        ]
        meshes = [
            {
                **{"name": f"m{i}", "driving": f"w{i}", "driven": f"w{i + 1}"},
                "driving_rotation": senses[(i + (self.sense < 0)) % 2],
                "centre_line_angle": 0,
                "damping": {"law": "none"},
            }
            for i in range(len(self.teeth) - 1)
        ]
        speed = next((v / self.ratios[i] for i, v in self.prescribed(0.0).items()), 0.0)
        speeds = {f"w{i}": float(g * speed) for i, g in enumerate(self.ratios)}
        initial = {"kind": "speeds", "speeds": speeds}
        simulation = {"duration": 1e-3, "output_interval": 1e-4, "initial": initial}
        parts = {"materials": {"steel": STEEL}, "wheels": wheels, "meshes": meshes}
        return {"format": 1, **parts, "simulation": simulation}

    def times(self) -> list[float]:
        """A time before the first knot of all tables, and all knots."""
        knots = {t for loads in self.loads for load in loads for t in load.get("time", [])}
        return [min(knots, default=0.0) - 1.0, *sorted(knots)]

    def torques(self, t: float, speed: float) -> np.ndarray:
        """Sum of the known torques of each wheel [N m]."""
        return np.array(
            [
                sum(torque(load, t, g * speed) for load, torque in self.known(i))
                for i, g in enumerate(self.ratios)
            ]
        )

    def gross(self, t: float, speed: float) -> float:
        """Sum of the magnitudes of all torques, as a normal force [N]."""
        return sum(
            abs(g * torque(load, t, g * speed)) / BASE / self.teeth[0]
            for i, g in enumerate(self.ratios)
            for load, torque in self.known(i)
        )

    def known(self, wheel: int) -> list[tuple[Block, Callable[[Block, float, float], float]]]:
        of_kind = [(load, TORQUES[load["kind"]]) for load in self.loads[wheel]]
        return [(load, torque) for load, torque in of_kind if torque is not None]

    def prescribed(self, t: float) -> dict[int, float]:
        """Prescribed speeds of wheels [rad/s]."""
        return {
            i: load["value"] if "value" in load else table_at(load, "speed", t)
            for i, loads in enumerate(self.loads)
            for load in loads
            if TORQUES[load["kind"]] is None
        }

    def point(self, t: float) -> tuple[float, np.ndarray]:
        """Speed of the first wheel [rad/s] and normal forces, > 0 on the drive flanks [N]."""
        prescribed = self.prescribed(t)
        if prescribed:
            ((driver, omega),) = prescribed.items()
            speed = omega / self.ratios[driver]
            return speed, self.forces(self.torques(t, speed), driver, self.gross(t, speed))

        def left(speed: float) -> float:
            return float(self.ratios @ self.torques(t, speed))

        at_rest = left(0.0)
        reach = 1.0
        while left(reach) * left(-reach) > 0 and reach < 1e9:
            reach *= 2
        if at_rest == 0:
            return 0.0, self.forces(self.torques(t, 0.0), None, self.gross(t, 0.0))
        if reach < 1e9:
            speed = float(brentq(left, -reach, reach, xtol=1e-13, rtol=1e-14, maxiter=500))
            return speed, self.forces(self.torques(t, speed), None, self.gross(t, speed))
        acceleration = at_rest / (self.inertias @ self.ratios**2)
        inertial = self.inertias * self.ratios * acceleration
        forces = self.forces(self.torques(t, 0.0) - inertial, None, self.gross(t, 0.0))
        return acceleration * SPIN_UP, forces

    def forces(self, torques: np.ndarray, driver: int | None, gross: float) -> np.ndarray:
        """Normal forces from the torques before each mesh, and from those after it.

        The force of the drive flanks and an opposing torque on the driving wheel are in
        equilibrium: F r_b g_A = sense sum of g M over the wheels before the mesh.
        """
        forces = np.empty(len(self.teeth) - 1)
        for mesh in range(len(forces)):
            arm = BASE * self.teeth[0] * self.sense  # |g| r_b, equal for all wheels
            before = self.ratios[: mesh + 1] @ torques[: mesh + 1] / arm
            behind = -self.ratios[mesh + 1 :] @ torques[mesh + 1 :] / arm
            if driver is None:
                assert before == pytest.approx(behind, rel=AGREEMENT, abs=1e-11 * gross)
            forces[mesh] = behind if driver is not None and driver <= mesh else before
        return forces

    def nominal(self) -> tuple[float, np.ndarray]:
        """Speed and forces of largest magnitude over the knots."""
        points = [self.point(t) for t in self.times()]
        speeds = np.array([speed for speed, _ in points])
        forces = np.array([force for _, force in points])
        largest = np.abs(forces).argmax(axis=0)
        return float(speeds[np.abs(speeds).argmax()]), np.take_along_axis(forces, largest[None], 0)[
            0
        ]


def shown(evolvent: Evolvent, case: dict[str, Any], tmp_path: Path) -> dict[str, Any]:
    (tmp_path / "case.yaml").write_text(json.dumps(case))
    done = evolvent("show", "case.yaml", "--json")
    assert done.returncode == 0, done.stderr
    return json.loads(done.stdout)


def find(tree: Any, name: str) -> Any:
    """Return the part of a tree that has this name."""
    if isinstance(tree, dict):
        for key, value in tree.items():
            if key == name and isinstance(value, dict):
                return value
            found = find(value, name)
            if found is not None:
                return found
    return None


def check(evolvent: Evolvent, train: Train, tmp_path: Path) -> None:
    speed, forces = train.nominal()
    reported = shown(evolvent, train.case(), tmp_path)
    gross = max(train.gross(t, speed) for t in train.times())
    for i, ratio in enumerate(train.ratios):
        value = find(reported, f"w{i}")["nominal_speed"]
        assert value == pytest.approx(ratio * speed, rel=AGREEMENT, abs=1e-12)
    for i, force in enumerate(forces):
        mesh = find(reported, f"m{i}")
        assert mesh["nominal_force"] == pytest.approx(force, rel=AGREEMENT, abs=1e-11 * gross)
        if abs(force) > 1e-9 * gross:
            assert mesh["reference_force"] == pytest.approx(abs(force), rel=AGREEMENT)


def draw(rng: np.random.Generator, names: tuple[str, ...], wheels: int) -> list[list[Block]]:
    """One load of each kind, on any wheel, with at most one prescribed speed."""
    loads: list[list[Block]] = [[] for _ in range(wheels)]
    for index, name in enumerate(dict.fromkeys(names) if names.count("speed") > 1 else names):
        wheel = index if index < wheels and rng.random() < 0.7 else int(rng.integers(wheels))
        loads[wheel].append(DRAWN[name](rng))
    return loads


def test_every_kind_of_load_has_a_reference(kernel: Kernel):
    names = {info.name for info in kinds(kernel.library, "load")}
    assert set(DRAWN) == names
    assert set(TORQUES) == names


@pytest.mark.parametrize("sense", [1, -1], ids=["counterclockwise", "clockwise"])
@pytest.mark.parametrize("names", itertools.product(DRAWN, repeat=2), ids="-".join)
def test_two_loads_on_a_pair(
    evolvent: Evolvent, tmp_path: Path, names: tuple[str, str], sense: int
):
    rng = np.random.default_rng([sense + 1, *map(list(DRAWN).index, names)])
    for _ in range(2):
        check(evolvent, Train([20, 50], draw(rng, names, 2), sense), tmp_path)


@pytest.mark.parametrize("names", itertools.combinations_with_replacement(DRAWN, 3), ids="-".join)
def test_three_loads_on_a_triple(evolvent: Evolvent, tmp_path: Path, names: tuple[str, ...]):
    rng = np.random.default_rng([7, *map(list(DRAWN).index, names)])
    sense = int(rng.choice([1, -1]))
    check(evolvent, Train([19, 30, 43], draw(rng, names, 3), sense), tmp_path)


@pytest.mark.parametrize("name", DRAWN)
def test_the_other_sense_of_rotation_is_the_mirror_image(
    evolvent: Evolvent, tmp_path: Path, name: str
):
    mirrored = {"value", "torque", "speed", "mean"}
    rng = np.random.default_rng(11)
    loads = draw(rng, (name, "torque", "drive"), 2)
    images = [
        [
            load  # against the motion in either sense
            if load["kind"] == "loss"
            else {k: (-np.array(v)).tolist() if k in mirrored else v for k, v in load.items()}
            for load in of_wheel
        ]
        for of_wheel in loads
    ]
    there = shown(evolvent, Train([20, 50], loads).case(), tmp_path)
    image = shown(evolvent, Train([20, 50], images, -1).case(), tmp_path)
    for wheel in ("w0", "w1"):
        assert find(image, wheel)["nominal_speed"] == -find(there, wheel)["nominal_speed"]
    for key in ("nominal_force", "reference_force"):
        assert find(image, "m0")[key] == find(there, "m0")[key]


@pytest.mark.parametrize("brakes", [False, True], ids=["drive flanks", "coast flanks"])
def test_static_takes_the_nominal_torque(evolvent: Evolvent, tmp_path: Path, brakes: bool):
    """A motor against a load and a drag, driving or braking on the coast flanks."""
    sign = -1 if brakes else 1
    loads = [
        [{"kind": "torque", "value": 51.0}],
        [{"kind": "torque", "value": 120.0}, {"kind": "viscous", "coefficient": 0.1875}],
    ]
    if brakes:  # torques against the direction of rotation, a driving drag: the balance is mirrored
        for load in (loads[0][0], loads[1][0]):
            load["value"] *= -1
    train = Train([20, 50], loads)
    reported = find(shown(evolvent, train.case(), tmp_path), "m0")
    assert reported["nominal_force"] == pytest.approx(sign * 1356.8266599, rel=1e-9)
    done = evolvent("static", "case.yaml", "--json", "-o", "s.h5")
    assert done.returncode == 0, done.stderr
    numbers = json.loads(done.stdout)
    assert numbers["torque"] == pytest.approx([sign * 51.0], rel=AGREEMENT)
    # 624 MPa at the positions of the curve, more between them
    assert numbers["largest_contact_pressure"] == pytest.approx([628.6308e6], rel=1e-6)


def test_an_unloaded_mesh_has_no_nominal_force_but_a_reference_force(
    evolvent: Evolvent, tmp_path: Path
):
    """The last wheel is idle: error scales are those of the loaded mesh."""
    loads = [[{"kind": "speed", "value": 100.0}], [{"kind": "torque", "value": 30.0}], []]
    reported = shown(evolvent, Train([20, 30, 25], loads).case(), tmp_path)
    loaded, idle = find(reported, "m0"), find(reported, "m1")
    assert loaded["nominal_force"] == pytest.approx(30.0 / (BASE * 30), rel=AGREEMENT)
    assert idle["nominal_force"] == 0
    assert idle["reference_force"] == pytest.approx(loaded["reference_force"], rel=AGREEMENT)
    done = evolvent("static", "case.yaml", "--mesh", "m1", "-o", "s.h5")
    assert done.returncode == 3
    assert "its loads exert no torque on mesh m1" in done.stderr


@pytest.mark.parametrize("stiffness", [2e3, 5e4], ids=["soft", "stiff"])
def test_a_power_split_has_the_least_complementary_energy(
    evolvent: Evolvent, tmp_path: Path, stiffness: float
):
    """Two parallel meshes between two shafts; the reference is a KKT system of all unknowns."""
    wheels = [
        *({"name": name, "teeth": 20, "loads": []} for name in ("a1", "a2")),
        *({"name": name, "teeth": 50, "loads": []} for name in ("b1", "b2")),
    ]
    for wheel, width in zip(wheels, (0.02, 0.03, 0.02, 0.03), strict=True):
        wheel.update({"module": MODULE, "width": width, "material": "steel"})
    wheels[0]["loads"] = [{"kind": "speed", "value": 50.0}]
    wheels[2]["loads"] = [{"kind": "torque", "value": 120.0}]
    for name, position in (("1", 0.0), ("2", 0.1)):
        for wheel in wheels:
            if wheel["name"].endswith(name):
                wheel["axial_position"] = position
    meshes = [
        {
            **{"name": f"m{k}", "driving": f"a{k}", "driven": f"b{k}", "centre_line_angle": 0},
            "driving_rotation": "counterclockwise",
        }
        for k in (1, 2)
    ]
    shafts = [
        {"name": f"s{x}", "wheels": [f"{x}1", f"{x}2"], "stiffness": stiffness} for x in ("a", "b")
    ]
    case = {
        **{"format": 1, "materials": {"steel": STEEL}, "wheels": wheels},
        **{"shafts": shafts, "meshes": meshes},
        "simulation": {
            **{"duration": 1e-3, "output_interval": 1e-4},
            "initial": {"kind": "speeds", "speeds": {"a1": 50, "a2": 50, "b1": -20, "b2": -20}},
        },
    }
    reported = shown(evolvent, case, tmp_path)
    r_a, r_b = 20 * BASE, 50 * BASE
    e_star = 206e9 / (2 * (1 - 0.3**2))
    compliance = [4 / (np.pi * e_star * b) for b in (0.02, 0.03)] + [1 / stiffness] * 2
    # rows: equilibrium of a2, b1, b2; columns: forces of the meshes, torques of the shafts
    balance = np.array([[0, -r_a, 1, 0], [-r_b, 0, 0, -1], [0, -r_b, 0, 1]])
    system = np.block([[np.diag(compliance), balance.T], [balance, np.zeros((3, 3))]])
    unknowns = np.linalg.solve(system, [0, 0, 0, 0, 0, -120.0, 0])
    for k in (1, 2):
        assert find(reported, f"m{k}")["nominal_force"] == pytest.approx(
            unknowns[k - 1], rel=AGREEMENT
        )


def warned_speed(evolvent: Evolvent, loads: list[list[Block]], tmp_path: Path) -> str:
    (tmp_path / "case.yaml").write_text(json.dumps(Train([20, 50], loads).case()))
    done = evolvent("show", "case.yaml", "--json")
    return " ".join(w for w in done.stderr.splitlines() if "give it a speed of" in w) or str(
        [w for w in json.loads(done.stdout).get("warnings", []) if "give it a speed of" in w] or ""
    )


def test_a_balance_at_a_low_speed_is_not_called_a_runaway(evolvent: Evolvent, tmp_path: Path):
    drive = {"kind": "drive", "speed": 100.0, "torque": 50.0, "slope": -0.001}
    balanced = [[drive], [{"kind": "torque", "value": 125.0}]]
    assert warned_speed(evolvent, balanced, tmp_path) == ""


def test_a_runaway_is_named_with_its_speed(evolvent: Evolvent, tmp_path: Path):
    """The load of the machine is missing: the drive is in equilibrium at 100 + 150/0.001 rad/s."""
    drive = {"kind": "drive", "speed": 100.0, "torque": 150.0, "slope": -0.001}
    assert "give it a speed of 150100 rad/s" in warned_speed(evolvent, [[drive], []], tmp_path)
