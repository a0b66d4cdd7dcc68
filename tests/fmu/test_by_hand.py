"""FMUs driven call by call: inputs, masters, states put away, what is refused."""

from __future__ import annotations

import ctypes
import subprocess
from collections.abc import Callable
from pathlib import Path

import h5py
import numpy as np
import pytest
from fmpy.fmi1 import FMICallException

from fmu.importer import Fmu, Make, model, numbers, slave

Evolvent = Callable[..., subprocess.CompletedProcess[str]]

HEAD = """\
format: 1
materials: {steel: {youngs_modulus: 2.0e+11, poisson_ratio: 0.3, density: 7800}}
simulation: {duration: 0.02, output_interval: 1e-3, tolerance: 1e-11, initial: {kind: INITIAL}}
"""
# A pair of spur gears; its first wheel stands where the second of another pair may.
WHEELS = """\
- {{name: {0}, teeth: 20, module: 3 mm, width: 0.02, material: steel, centre: [0, 0],
   axial_position: {2}, loads: [{{kind: {3}}}]}}
- {{name: {1}, teeth: 30, module: 3 mm, width: 0.02, material: steel, axial_position: {2},
   loads: [{{kind: {4}}}]}}
"""
MESH = """\
- {{name: {0}-{1}, driving: {0}, driven: {1}, driving_rotation: {2}, centre_line_angle: 0,
   backlash: 0.1 mm, contact: {{law: johnson}}, damping: {{law: linear, coefficient: 5e3}},
   friction: {{law: none}}, tracking: closed_form}}
"""
STIFFNESS = 2e4  # of the shaft [N m/rad]


def pair_case(first: str, initial: str = "rest") -> str:
    """One pair: what drives its first wheel."""
    wheels = WHEELS.format("a", "b", 0, first, "viscous, coefficient: 0.1")
    mesh = MESH.format("a", "b", "counterclockwise")
    return f"{HEAD.replace('INITIAL', initial)}wheels:\n{wheels}meshes:\n{mesh}"


def half(first: str, second: str, loads: tuple[str, str], sense: str) -> str:
    """A gearbox to be joined to another."""
    wheels = WHEELS.format(first, second, 0, *loads)
    mesh = MESH.format(first, second, sense)
    return f"{HEAD.replace('INITIAL', 'rest')}wheels:\n{wheels}meshes:\n{mesh}"


def whole() -> str:
    """Both gearboxes with the shaft: wheel c stands on the axis of b."""
    loads = (
        ("torque, value: 40", "torque, value: 0"),
        ("torque, value: 0", "viscous, coefficient: 0.5"),
    )
    second = WHEELS.format("c", "d", 0.1, *loads[1]).replace(" centre: [0, 0],", "")
    wheels = WHEELS.format("a", "b", 0, *loads[0]) + second
    meshes = MESH.format("a", "b", "counterclockwise") + MESH.format("c", "d", "clockwise")
    shafts = f"- {{name: s, wheels: [b, c], stiffness: {STIFFNESS}, damping: 0}}\n"
    return f"{HEAD.replace('INITIAL', 'rest')}wheels:\n{wheels}meshes:\n{meshes}shafts:\n{shafts}"


def written(folder: Path, name: str, text: str) -> Path:
    path = folder / f"{name}.yaml"
    path.write_text(text, encoding="utf-8")
    return path


def join(first: Fmu, second: Fmu, h: float) -> np.ndarray:
    """Speeds of the two joined wheels at each 1 ms, up to 20 ms.

    The torque of a step is that at its middle: of the angles as they go on.
    """
    logged = []
    every = round(1e-3 / h)
    for k in range(20 * every + 1):
        angle_b, omega_b = first.get("angle[b]", "angular_velocity[b]")
        angle_c, omega_c = second.get("angle[c]", "angular_velocity[c]")
        if k % every == 0:
            logged.append([omega_b, omega_c])
        torque = STIFFNESS * (angle_b - angle_c + h / 2 * (omega_b - omega_c))
        first.set(b__torque=-torque)
        second.set(c__torque=torque)
        first.step(k * h, h)
        second.step(k * h, h)
    return np.array(logged)


def test_two_fmus_joined_by_a_shaft_are_the_one_case(
    make: Make, evolvent: Evolvent, tmp_path: Path
) -> None:
    loads = (
        ("torque, value: 40", "torque, value: 0"),
        ("torque, value: 0", "viscous, coefficient: 0.5"),
    )
    paths = (
        make(written(tmp_path, "first", half("a", "b", loads[0], "counterclockwise")),
             "--input", "wheel:b:torque"),
        make(written(tmp_path, "second", half("c", "d", loads[1], "clockwise")),
             "--input", "wheel:c:torque"),
    )  # fmt: skip
    history = tmp_path / "whole.h5"
    done = evolvent("run", written(tmp_path, "whole", whole()), "-o", history, "-q")
    assert done.returncode == 0, done.stderr
    with h5py.File(history) as file:
        names = [name.decode() for name in file["wheel"][:]]
        expected = file["angular_velocity"][:][:, [names.index("b"), names.index("c")]]
    errors = []
    for h in (4e-5, 2e-5, 1e-5):
        fmus = [slave(path, tmp_path / f"{path.stem}-{h}") for path in paths]
        for fmu in fmus:
            fmu.begin()
        errors.append(np.abs(join(*fmus, h) - expected).max() / np.abs(expected).max())
        for fmu in fmus:
            fmu.end()
    assert errors[2] < 1e-4
    assert errors[0] > 3 * errors[1] > 9 * errors[2], errors  # of order 2 by the torque's middle


def test_a_speed_that_jumps_is_refused_in_one_line(make: Make, tmp_path: Path) -> None:
    case = written(tmp_path, "pair", pair_case("speed, value: 50", "steady"))
    fmu = slave(make(case, "--input", "wheel:a:speed"), tmp_path / "x")
    fmu.begin()
    fmu.set(a__acceleration=1000.0)
    fmu.step(0, 1e-3)
    fmu.set(a__speed=51.0)
    fmu.step(1e-3, 1e-3)
    assert fmu.get("angular_velocity[a]") == pytest.approx([52], rel=1e-9)  # its ramp
    fmu.set(a__speed=60.0, a__acceleration=0.0)
    with pytest.raises(FMICallException):
        fmu.step(2e-3, 1e-3)
    (line,) = fmu.logged
    assert (
        "the speed given for wheel 'a' jumps: it is 60 rad/s, and the wheel turns at 52 rad/s"
        in line
    )
    fmu.end()


def test_an_importer_that_integrates_hears_of_a_jump_too(make: Make, tmp_path: Path) -> None:
    case = written(tmp_path, "pair", pair_case("speed, value: 50", "steady"))
    fmu = model(make(case, "--input", "wheel:a:speed"), tmp_path / "x")
    fmu.begin()
    fmu.fmu.updateDiscreteStates()
    fmu.fmu.enterContinuousTimeMode()
    assert fmu.fmu.completedIntegratorStep() == (False, False)
    fmu.set(a__speed=60.0)
    with pytest.raises(FMICallException):
        fmu.fmu.completedIntegratorStep()
    assert "jumps: it is 60 rad/s, and the wheel turns at 50 rad/s" in fmu.logged[0]
    fmu.end()


def test_indicators_are_off_zero_and_idle_ones_constant(
    make: Make, examples: Path, tmp_path: Path
) -> None:
    fmu = model(make(examples / "spur-pair.yaml"), tmp_path / "x")
    fmu.begin()
    n = fmu.fmu.getNumberOfEventIndicators()
    indicators, seen = numbers(n), []
    fmu.fmu.updateDiscreteStates()
    fmu.fmu.getEventIndicators(indicators, n)
    seen = np.array(indicators)
    assert (np.abs(seen) > 0.9e-10).all()  # what the program keeps between a mode and the next
    assert (seen == 1).any()
    assert (seen != 1).any()
    fmu.end()


def test_a_state_put_away_goes_on_with_the_same_bits(make: Make, tmp_path: Path) -> None:
    case = written(tmp_path, "pair", pair_case("torque, value: 5"))
    path = make(case, "--input", "wheel:a:torque")
    names = ("angular_velocity[a]", "angle[b]", "normal_force[a-b]")
    first, second = slave(path, tmp_path / "x"), slave(path, tmp_path / "y")
    first.set(**{"materials__steel__density": 7000.0})
    first.begin()
    second.begin()
    first.step(0, 1e-3)
    first.set(a__torque=7.0)
    state = first.fmu.getFMUState()
    kept = first.fmu.serializeFMUState(state)
    first.step(1e-3, 2e-3)
    expected = first.get(*names)
    first.fmu.setFMUState(state)
    assert first.get("time", "a.torque").tolist() == [1e-3, 7]
    first.step(1e-3, 2e-3)
    assert first.get(*names).tolist() == expected.tolist()
    other = second.fmu.deserializeFMUState(kept)
    second.fmu.setFMUState(other)
    second.step(1e-3, 2e-3)
    assert second.get(*names).tolist() == expected.tolist()
    second.fmu.freeFMUState(other)
    first.fmu.freeFMUState(state)
    first.end()
    second.end()


def test_bytes_that_are_no_state_of_the_fmu_are_refused(make: Make, tmp_path: Path) -> None:
    path = make(written(tmp_path, "pair", pair_case("torque, value: 5")))
    other = make(written(tmp_path, "other", pair_case("torque, value: 6")))
    fmus = [slave(path, tmp_path / "x"), model(path, tmp_path / "y"), slave(other, tmp_path / "z")]
    for fmu in fmus:
        fmu.begin()
    kept = fmus[0].fmu.serializeFMUState(fmus[0].fmu.getFMUState())
    for bad, words in (
        (kept[:100], "these bytes are not a state of this FMU"),
        (kept[:-8], "a damaged state"),
        (kept[:-1] + bytes([kept[-1] ^ 1]), "a damaged state"),
        (b"x" + kept[1:], "these bytes are not a state of this FMU"),
    ):
        with pytest.raises(FMICallException):
            fmus[0].fmu.deserializeFMUState(bad)
        assert words in fmus[0].logged[-1]
    with pytest.raises(FMICallException):
        fmus[2].fmu.deserializeFMUState(kept)
    assert "these bytes are not a state of this FMU" in fmus[2].logged[-1]
    state = fmus[1].fmu.deserializeFMUState(kept)
    with pytest.raises(FMICallException):
        fmus[1].fmu.setFMUState(state)
    assert "is of an instance for co-simulation, this one is for model exch" in fmus[1].logged[-1]
    for fmu in fmus:
        fmu.end()


def test_a_reset_instance_begins_anew(make: Make, tmp_path: Path) -> None:
    case = written(tmp_path, "pair", pair_case("torque, value: 5"))
    fmu = slave(make(case, "--input", "wheel:a:torque"), tmp_path / "x")

    def go() -> list[float]:
        fmu.begin()
        fmu.step(0, 5e-3)
        return fmu.get("angular_velocity[a]", "a.torque").tolist()

    once = go()
    fmu.fmu.reset()
    fmu.set(**{"a__torque": 9.0, "materials__steel__density": 7000.0})
    assert go() != once
    fmu.fmu.reset()
    assert go() == once
    fmu.end()


def test_what_is_not_possible_is_told_in_one_line(
    make: Make, examples: Path, tmp_path: Path
) -> None:
    path = make(examples / "spur-pair.yaml", "--input", "wheel:pinion:torque")
    fmu = slave(path, tmp_path / "x")
    calls: list[tuple[Callable[[], object], str]] = [
        (lambda: fmu.step(0, 1e-3), "fmi3DoStep is not allowed here: the instance is in the"),
        (lambda: fmu.get("time"), "before the initialization only parameters and inputs"),
        (lambda: fmu.fmu.enterInitializationMode(startTime=1.0), "a case starts at 0"),
        (lambda: fmu.fmu.enterInitializationMode(stopTime=0.0), "the stop time is 0 s, but must"),
        (lambda: fmu.fmu.getFloat64([12345]), "no variable with the value reference 12345"),
        (lambda: fmu.fmu.getInt32([0]), "this FMU has no variables of the type Int32"),
        (lambda: fmu.set(**{"state__reference_angle": 1.0}), "only inputs and parameters"),
        (lambda: fmu.set(**{"wheels__gear__teeth": 30.5}) or fmu.begin(0.1), "wheels.gear.teeth"),
        (lambda: fmu.set(**{"wheels__gear__teeth": 34.0}) or fmu.fmu.exitInitializationMode()
         or fmu.step(1.0, 1e-3), "the communication point is 1 s, but the FMU is at 0 s"),
        (lambda: fmu.step(0, -1e-3), "the communication step is -0.001 s, but must be positive"),
        (lambda: fmu.step(0, 0.0), "the communication step is 0 s, but must be positive"),
        (lambda: fmu.step(0, 0.2), "the step ends at 0.2 s, after the stop time 0.1 s"),
        (lambda: fmu.set(**{"pinion__torque": float("nan")}), "is nan, but must be"),
        (lambda: fmu.set(**{"wheels__gear__teeth": 35.0}), "parameters are set before"),
        (lambda: fmu.fmu.enterEventMode(), "in co-simulation this FMU has no event mode"),
    ]  # fmt: skip
    for number, (call, words) in enumerate(calls):
        with pytest.raises(FMICallException):
            call()
        assert len(fmu.logged) == number + 1
        assert words in fmu.logged[-1]
        assert "\n" not in fmu.logged[-1]
    fmu.end()


def test_an_fmu_of_another_case_is_refused(make: Make, examples: Path, tmp_path: Path) -> None:
    path = make(examples / "spur-pair.yaml")
    fmu = slave(path, tmp_path / "x")
    good = fmu.fmu.component
    case = fmu.unpacked / "resources" / "case.yaml"
    case.write_text(case.read_text(encoding="utf-8").replace("7830", "7831"), encoding="utf-8")
    with pytest.raises(Exception, match="Failed to instantiate"):
        fmu.fmu.instantiate(logMessage=fmu._hear)
    assert "the instantiation token is not that of this case and program" in fmu.logged[0]
    fmu.fmu.component = good
    fmu.end()


def test_functions_of_the_standard_are_all_there(
    make: Make, examples: Path, tmp_path: Path
) -> None:
    """Importers may look every one of them up."""
    from fmpy import fmi3

    fmu = slave(make(examples / "spur-pair.yaml"), tmp_path / "x")
    library = ctypes.CDLL(str(fmu.unpacked / "binaries" / "x86_64-linux" / "evolvent.so"))
    names = {name for kind in (fmi3.FMU3Model, fmi3.FMU3Slave, fmi3.FMU3ScheduledExecution)
             for name in dir(kind) if name.startswith("fmi3")}  # fmt: skip
    assert len(names) > 70
    for name in names:
        assert hasattr(library, name), name
    fmu.end()
