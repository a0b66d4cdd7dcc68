"""Invalid cases: exit code, location, reason, and no output."""

from __future__ import annotations

import json
import re
import subprocess
from collections.abc import Callable
from pathlib import Path

import h5py
import numpy as np
import pytest

Evolvent = Callable[..., subprocess.CompletedProcess[str]]

USAGE, CASE = 2, 3

FRICTION = "friction: {law: coulomb, coefficient: 0,"
NEW_LOAD = "wheels.pinion.loads.0="
MOTION = "housing={kind: prescribed, rotation: ["
MOVING = "housing={kind: prescribed, accelerometers: "
ACCELEROMETER = "[{name: foot, point: [0, 0, 0], direction: [1, 0, 0]}]"
BODY = "housing={kind: mounted, mass: 1, "

BAD_OPTIONS = {
    "no teeth": ("wheels.pinion.teeth=0", "is 0, must be a whole number from 3 to 10000"),
    "negative teeth": ("wheels.pinion.teeth=-3", "is -3, must be a whole number from 3 to 10000"),
    "half a tooth": ("wheels.pinion.teeth=2.5", "is 2.5, must be a whole number from 3 to 10000"),
    "a fraction in the range": ("wheels.pinion.teeth=20.5", "is 20.5, must be a whole number"),
    "too many teeth": ("wheels.pinion.teeth=1e9", "is 1e9, must be a whole number from 3 to 10000"),
    "teeth in quotes": ("wheels.pinion.teeth='20'", "text because of its quotes"),
    "teeth as a list": ("wheels.pinion.teeth=[20]", "must be a whole number, not a list"),
    "nothing": ("wheels.pinion.teeth=", "must be a whole number, not nothing"),
    "no width": ("wheels.pinion.width=0", "is 0 m, must be greater than 0 m"),
    "negative width": ("wheels.gear.width=-0.1", "is -0.1 m, must be greater than 0 m"),
    "no radius": ("wheels.pinion.pitch_radius=0", "is 0 m, must be greater than 0 m"),
    "negative radius": ("wheels.pinion.pitch_radius=-0.2", "is -0.2 m, must be greater than 0 m"),
    "no modulus": ("materials.steel.youngs_modulus=0", "is 0 Pa, must be greater than 0 Pa"),
    "negative modulus": ("materials.steel.youngs_modulus=-2e11", "must be greater than 0 Pa"),
    "negative density": ("materials.steel.density=-1", "must be greater than 0 kg/m3"),
    "incompressible": ("materials.steel.poisson_ratio=0.5", "is 0.5, must be at least 0 and less"),
    "nu past 0.5": ("materials.steel.poisson_ratio=0.7", "is 0.7, must be at least 0 and less"),
    "NaN": ("wheels.pinion.width=.nan", "is .nan, which is not a finite number"),
    "infinity": ("wheels.pinion.pitch_radius=.inf", "is .inf, which is not a finite number"),
    "minus infinity": ("wheels.pinion.loads.0.value=-.inf", "is -.inf, which is not a finite"),
    "more than a double holds": ("wheels.pinion.width=1e999", "is 1e999, which is not a finite"),
    "NaN in a table": (
        NEW_LOAD + "{kind: table, time: [0, 1], torque: [1, .nan]}",
        "wheels.pinion.loads.0.torque.1: is .nan",
    ),
    "half a centre": ("wheels.pinion.centre=[0]", "has 1 value, must be a pair [x, y]"),
    "unknown key": ("wheels.pinion.colour=red", "unknown key 'colour'; known here: name, teeth"),
    "misspelt key": ("wheels.pinion.teth=20", "unknown key 'teth' (did you mean 'teeth'?)"),
    "misspelt wheel": ("wheels.piniom.teeth=20", "wheels has no 'piniom' (did you mean 'pinion'?)"),
    "misspelt law": ("meshes.0.friction.law=coulumb", "not 'coulumb' (did you mean 'coulomb'?)"),
    "misspelt kind": (
        "wheels.gear.support.kind=silder",
        "must be one of fixed, slider, bearing, not 'silder' (did you mean 'slider'?)",
    ),
    "misspelt tracking": (
        "meshes.0.tracking=diferential",
        "not 'diferential' (did you mean 'differential'?)",
    ),
    "misspelt sense": ("meshes.0.driving_rotation=clockwize", "(did you mean 'clockwise'?)"),
    "misspelt start": ("simulation.initial.kind=stedy", "(did you mean 'steady'?)"),
    "misspelt rule": ("meshes.0.pressure_angle=paper-rule", "(did you mean 'paper_rule'?)"),
    "flat pressure angle": ("meshes.0.pressure_angle=90", "is 90 deg, must be greater than 0 and"),
    "negative friction": ("meshes.0.friction.coefficient=-0.1", "is -0.1, must be at least 0"),
    "restitution past 1": (
        "meshes.0.damping={law: hunt_crossley, restitution: 1.5}",
        "meshes.pinion-gear.damping.restitution: is 1.5, must be from 0 to 1",
    ),
    "negative restitution": (
        "meshes.0.damping={law: lee_wang, restitution: -0.1}",
        "meshes.pinion-gear.damping.restitution: is -0.1, must be from 0 to 1",
    ),
    "a factor that divides by 0": (
        "meshes.0.damping={law: gonthier, restitution: 0}",
        "meshes.pinion-gear.damping.restitution: is 0, must be greater than 0 and at most 1",
    ),
    "no approach speed": (
        "meshes.0.damping={law: flores, restitution: 0.5, v0_min: 0}",
        "meshes.pinion-gear.damping.v0_min: is 0 m/s, must be greater than 0 m/s",
    ),
    "a restitution is missing": (
        "meshes.0.damping={law: flores}",
        "meshes.pinion-gear.damping: 'restitution' is missing",
    ),
    "no stiffness": (
        "meshes.0.contact={law: linear, stiffness: 0}",
        "meshes.pinion-gear.contact.stiffness: is 0 N/m, must be greater than 0 N/m",
    ),
    "a contact that softens": (
        "meshes.0.contact={law: power, coefficient: 1e9, exponent: 0.5}",
        "meshes.pinion-gear.contact.exponent: is 0.5, must be at least 1",
    ),
    "Stribeck upside down": (
        "meshes.0.friction={law: stribeck, static_coefficient: 0.1, kinetic_coefficient: 0.2, "
        "stribeck_velocity: 0.01}",
        "static_coefficient = 0.1 must be at least the kinetic_coefficient = 0.2",
    ),
    "unknown wheel in a mesh": (
        "meshes.0.driven=geer",
        "there is no wheel 'geer' (did you mean 'gear'?); the case has pinion, gear",
    ),
    "a wheel meshing itself": (
        "meshes.0.driven=pinion",
        "meshes.pinion-gear.driven: a wheel cannot mesh with itself",
    ),
    "unknown material": ("wheels.gear.material=steal", "there is no material 'steal'"),
    "one name for two wheels": ("wheels.gear.name=pinion", "is given to two wheels"),
    "a number as a name": ("wheels.gear.name=7", "the name '7' is a number"),
    "a dot in a name": ("wheels.gear.name=a.b", "the name 'a.b' contains '.'"),
    "no wheels": ("wheels=[]", "has 0 elements, needs at least 2"),
    "no meshes": ("meshes=[]", "has 0 elements, needs at least 1"),
    "no duration": ("simulation.duration=0", "is 0 s, must be greater than 0 s"),
    "negative duration": ("simulation.duration=-5", "is -5 s, must be greater than 0 s"),
    "outputs rarer than the run": (
        "simulation.output_interval=5.5",
        "is 5.5 s, longer than the duration of 5 s",
    ),
    "too many outputs": ("simulation.output_interval=1e-12", "more than 1e+09 rows"),
    "loose tolerance": ("simulation.tolerance=1", "is 1, must be from 1e-14 to 0.001"),
    "times that stand still": (
        NEW_LOAD + "{kind: table, time: [0, 1, 1], torque: [1, 2, 3]}",
        "the times of a table must increase: 1 s follows 1 s",
    ),
    "times that go back": (
        NEW_LOAD + "{kind: speed, time: [0, 2, 1], speed: [1, 2, 3]}",
        "the times of a table must increase: 1 s follows 2 s",
    ),
    "a table of two lengths": (
        NEW_LOAD + "{kind: table, time: [0, 1], torque: [1, 2, 3]}",
        "has 3 values, but time has 2",
    ),
    "a table of one knot": (
        NEW_LOAD + "{kind: table, time: [0], torque: [1]}",
        "has 1 value, needs at least 2",
    ),
    "speed without a value": (NEW_LOAD + "{kind: speed}", "needs either 'value' or both"),
    "times without speeds": (
        NEW_LOAD + "{kind: speed, time: [0, 1]}",
        "needs either 'value' or both 'time' and 'speed'",
    ),
    "a speed beside speeds": (
        NEW_LOAD + "{kind: speed, value: 1, speed: [1, 2]}",
        "needs either 'value' or both 'time' and 'speed'",
    ),
    "a harmonic torque of nothing": (
        NEW_LOAD + "{kind: harmonic, amplitude: 1}",
        "wheels.pinion.loads.0: a harmonic torque needs either 'frequency' or 'order'",
    ),
    "a harmonic torque of both": (
        NEW_LOAD + "{kind: harmonic, amplitude: 1, frequency: 2, order: 3}",
        "a harmonic torque needs either 'frequency' or 'order'; it has both",
    ),
    "a harmonic torque at rest": (
        NEW_LOAD + "{kind: harmonic, amplitude: 1, frequency: 0}",
        "frequency: is 0 Hz, must be greater than 0 Hz",
    ),
    "an order that goes back": (
        NEW_LOAD + "{kind: harmonic, amplitude: 1, order: -1}",
        "order: is -1, must be greater than 0",
    ),
    "a harmonic torque without amplitude": (
        NEW_LOAD + "{kind: harmonic, frequency: 3}",
        "'amplitude' is missing (the torque is mean + amplitude sin(...) [N m])",
    ),
    "a key of another kind": (
        NEW_LOAD + "{kind: torque, value: 1, amplitude: 2}",
        "'amplitude' is not valid with 'kind: torque'; it is valid with harmonic",
    ),
    "a drive that feeds itself": (
        NEW_LOAD + "{kind: drive, speed: 150, torque: 50, slope: 2}",
        "wheels.pinion.loads.0.slope: the torque of a drive must decrease with the speed: slope = "
        "2 N m s/rad must be at most 0; if that is the stiffness of the motor's curve, give -2",
    ),
    "a drive without a slope": (
        NEW_LOAD + "{kind: drive, speed: 150, torque: 50}",
        "wheels.pinion.loads.0: 'slope' is missing",
    ),
    "a drive at no speed": (
        NEW_LOAD + "{kind: drive, speed: .inf, slope: -1}",
        "wheels.pinion.loads.0.speed: is .inf, which is not a finite number",
    ),
    "a drive at a table of speeds": (
        NEW_LOAD + "{kind: drive, speed: [0, 1], time: [0, 1], slope: -1}",
        "'time' is not valid with 'kind: drive'; it is valid with table, speed",
    ),
    "two prescribed speeds": (
        "wheels.pinion.loads=[{kind: speed, value: 1}, {kind: speed, value: 2}]",
        "a second prescribed speed",
    ),
    "a speed is missing": (
        "simulation.initial={kind: speeds, speeds: {pinion: 1}}",
        "the speed of wheel 'gear' is missing",
    ),
    "gaps of a steady start": (
        "simulation.initial={kind: steady, gaps: {pinion-gear: 1e-6}}",
        "'gaps' is not valid with 'kind: steady'",
    ),
    "half a gravity": ("gravity=[0, 1]", "gravity: has 2 values, must be a vector [x, y, z]"),
    "misspelt housing": ("housing.kind=mountd", "(did you mean 'mounted'?)"),
    "a motion that is mounted": (
        "housing={kind: mounted, mass: 1, inertia: [1, 1, 1], rotation: []}",
        "'rotation' is not valid with 'kind: mounted'; it is valid with prescribed",
    ),
    "an accelerometer without a housing": (
        "housing.accelerometers=" + ACCELEROMETER,
        "'accelerometers' is not valid with 'kind: fixed', the default; it is valid with "
        "prescribed,"
        " mounted",
    ),
    "an accelerometer at rest": (
        "housing={kind: fixed, accelerometers: " + ACCELEROMETER + "}",
        "'accelerometers' is not valid with 'kind: fixed'; it is valid with prescribed, mounted",
    ),
    "an accelerometer that feels nothing": (
        MOVING + ACCELEROMETER.replace("1", "0") + "}",
        "housing.accelerometers.0.direction: a vector of zero length has no direction; give",
    ),
    "an accelerometer in the plane": (
        MOVING + ACCELEROMETER.replace("[0, 0, 0]", "[0, 0]") + "}",
        "housing.accelerometers.foot.point: has 2 values, must be a vector [x, y, z]",
    ),
    "an accelerometer nowhere": (
        MOVING + ACCELEROMETER.replace("point: [0, 0, 0], ", "") + "}",
        "housing.accelerometers.foot: 'point' is missing (position, housing frame [m])",
    ),
    "an accelerometer that is far away": (
        MOVING + ACCELEROMETER.replace("[0, 0, 0]", "[0, 0, .inf]") + "}",
        "housing.accelerometers.foot.point: is .inf, which is not a finite number",
    ),
    "an accelerometer without a name": (
        MOVING + ACCELEROMETER.replace("name: foot, ", "") + "}",
        "housing.accelerometers.0: 'name' is missing",
    ),
    "two accelerometers of one name": (
        MOVING + ACCELEROMETER[:-1] + ", " + ACCELEROMETER[1:] + "}",
        "housing.accelerometers: the name 'foot' is given to two accelerometers; give each",
    ),
    "a single accelerometer": (
        MOVING + ACCELEROMETER[1:-1] + "}",
        "housing.accelerometers: must be a list, not a block of keys",
    ),
    "a housing without mass": ("housing={kind: mounted, inertia: [1, 1, 1]}", "'mass' is missing"),
    "a negative frequency": (
        MOTION + "{kind: harmonic, axis: x, amplitude: 1, frequency: -1}]}",
        "housing.rotation.0.frequency: is -1 Hz, must be at least 0 Hz",
    ),
    "a turn about no axis": (
        MOTION + "{kind: rate, axis: w, value: 1}]}",
        "housing.rotation.0.axis: must be one of x, y, z, not 'w'",
    ),
    "a motion whose times go back": (
        MOTION + "{kind: table, axis: x, time: [0, 2, 1], value: [1, 2, 3]}]}",
        "housing.rotation.0.time: the times of a table must increase: 1 s follows 2 s",
    ),
    "a motion whose times stand still": (
        MOTION.replace("rotation", "translation")
        + "{kind: table, axis: z, time: [0, 0], value: [1, 2]}]}",
        "housing.translation.0.time: the times of a table must increase: 0 s follows 0 s",
    ),
    "a motion of one knot": (
        MOTION + "{kind: table, axis: x, time: [0], value: [1]}]}",
        "has 1 value, needs at least 2",
    ),
    "a quaternion of zero length": (
        BODY + "inertia: [1, 1, 1], orientation: [0, 0, 0, 0]}",
        "housing.orientation: a quaternion of zero length is not an orientation",
    ),
    "a quaternion of three numbers": (
        BODY + "inertia: [1, 1, 1], orientation: [1, 0, 0]}",
        "housing.orientation: has 3 values, must be a quaternion [w, x, y, z]",
    ),
    "an indefinite inertia": (
        BODY + "inertia: [1, 1, 1], products_of_inertia: [1.1, 0, 0]}",
        "housing.inertia: the inertia tensor is not positive definite",
    ),
    "an inertia that is indefinite in no plane of two axes": (
        # principal moments 1.6, 1.6 and -0.2
        BODY + "inertia: [1, 1, 1], products_of_inertia: [-0.6, -0.6, -0.6]}",
        "housing.inertia: the inertia tensor is not positive definite",
    ),
    "an inertia that no body has": (
        BODY + "inertia: [1, 1, 2.1]}",
        "housing.inertia: the inertia tensor breaks the triangle inequality",
    ),
    "an oblique inertia that no body has": (
        # principal moments 2.4, 1.0 and 1.2
        BODY + "inertia: [1.7, 1.7, 1.2], products_of_inertia: [0.7, 0, 0]}",
        "breaks the triangle inequality",
    ),
    "a mount that pushes": (
        BODY + "inertia: [1, 1, 1], mount: {stiffness: [1, -1, 1]}}",
        "housing.mount.stiffness: is -1 N/m, must be at least 0 N/m",
    ),
    "faces that do not overlap": (
        "wheels.gear.axial_position=0.1",
        "wheels.gear.axial_position: the faces of the two wheels of a mesh do not overlap",
    ),
    "an impossible transverse inertia": (
        "wheels.pinion.transverse_inertia=0.1",
        "wheels.pinion.transverse_inertia: transverse_inertia 0.1 kg m^2 is less than half",
    ),
    "another format": ("format=2", "is 2, but this evolvent reads format 1 only"),
    "half a list": ("wheels.pinion.centre=[0, 0", "not valid YAML"),
}

# the wording of the kernel is free: object, value and limit must be named
BAD_GEOMETRY = {
    # tan(alpha_inf) = 2 pi/(20 + 30): 7.1625 deg
    "pressure angle below the limit": (
        "meshes.0.pressure_angle=5",
        r"= 5(\.0*)? deg .*7\.16\d* deg",
    ),
    "radius against the ratio": ("wheels.gear.pitch_radius=0.25", r"0\.25.*0\.3"),
    "centre against the radii": ("wheels.gear.centre=[0.6, 0]", r"0\.6"),
}

# old text, new text with a mark before the expected location, reason
BAD_TEXTS = {
    "unknown key": ("title:", "§titel:", "unknown key 'titel' (did you mean 'title'?)"),
    "unknown key in a block": ("stiffness: 1", "§stifness: 1", "unknown key 'stifness' (did you"),
    "American spelling": ("  centre:", "  §center:", "(did you mean 'centre'?)"),
    "repeated key": ("teeth: 30", "teeth: 30\n  §teeth: 31", "the key 'teeth' is given twice"),
    "missing key": ("- name: gear", "- §nome: gear", "unknown key 'nome' (did you mean 'name'?)"),
    "negative teeth": ("teeth: 30", "teeth: §-3", "wheels.gear.teeth: is -3, must be a whole"),
    "words for a number": (
        "density: 7800",
        "density: §heavy",
        "must be a number [kg/m3], not 'heavy'",
    ),
    "NaN": ("mass: 10 ", "mass: §.NaN ", "is .NaN, which is not a finite number"),
    "misspelt law": (FRICTION, "friction: {law: §coulom,", "(did you mean 'coulomb'?)"),
    "a tab": ("    density", "§\tdensity", "not valid YAML: a tab; indent with spaces"),
    "an open list": ("[0, 0]\n", "[0, 0\n  loads§: [", "not valid YAML"),
    "an unknown alias": ("teeth: 30", "teeth: §*thirty", "not valid YAML: found undefined alias"),
    "a tag": ("teeth: 30", "teeth: §!!int 30", "the tag '!!int' has no meaning in a case"),
    "a merge key": ("  teeth: 30", "  §<<: {teeth: 30}", "merge keys (<<) are not supported"),
    "two documents": ("simulation:", "---\n§simulation:", "a second YAML document"),
    "radius against the ratio": ("  teeth: 30", "  pitch_radius: §0.25\n  teeth: 30", "0.25"),
    "a list of keys": ("materials:\n  steel:", "materials:\n  §- steel:", "must be blocks by name"),
}


@pytest.fixture
def paper(examples: Path) -> str:
    return (examples / "paper.yaml").read_text()


def refused(result: subprocess.CompletedProcess[str], code: int, folder: Path) -> str:
    """Return the one line of a rejected run; its folder may contain only the case."""
    assert result.returncode == code, result.stderr
    assert result.stdout == ""
    assert result.stderr.count("\n") == 1
    assert result.stderr.endswith("\n")
    assert [path.name for path in folder.iterdir() if path.suffix != ".yaml"] == []
    return result.stderr[:-1]


@pytest.mark.parametrize(("option", "reason"), BAD_OPTIONS.values(), ids=BAD_OPTIONS)
def test_a_refused_value_is_shown_with_its_option(
    evolvent: Evolvent, examples: Path, tmp_path: Path, option: str, reason: str
) -> None:
    result = evolvent("run", examples / "paper.yaml", "--set", option)
    line = refused(result, CASE, tmp_path)
    assert line.startswith(f"--set {option}: ")
    assert reason in line


@pytest.mark.parametrize(
    ("housing", "reason"),
    [
        (
            "housing.kind=prescribed",
            "simulation.initial.kind: a steady start requires a fixed or mounted housing",
        ),
        (
            BODY + "inertia: [1, 1, 1], velocity: [1, 0, 0]}",
            "housing.velocity: a steady start has a housing without velocity",
        ),
        (
            BODY + "inertia: [1, 1, 1]}",
            "simulation.initial.kind: the steady state is not determined",
        ),
    ],
)
def test_a_steady_start_needs_a_housing_that_can_be_at_rest(
    evolvent: Evolvent, examples: Path, tmp_path: Path, housing: str, reason: str
) -> None:
    start = "simulation.initial.kind=steady"
    result = evolvent("run", examples / "paper.yaml", "--set", start, "--set", housing)
    assert reason in refused(result, CASE, tmp_path)


@pytest.mark.parametrize(("option", "reason"), BAD_GEOMETRY.values(), ids=BAD_GEOMETRY)
def test_geometry_that_cannot_be_is_refused(
    evolvent: Evolvent, examples: Path, tmp_path: Path, option: str, reason: str
) -> None:
    line = refused(evolvent("run", examples / "paper.yaml", "--set", option), CASE, tmp_path)
    assert line.startswith(f"--set {option}: {option.split('=')[0].split('.')[0]}.")
    assert re.search(reason, line)


@pytest.mark.parametrize(("old", "new", "reason"), BAD_TEXTS.values(), ids=BAD_TEXTS)
def test_a_fault_in_the_file_is_shown_at_its_line_and_column(
    evolvent: Evolvent, paper: str, tmp_path: Path, old: str, new: str, reason: str
) -> None:
    assert old in paper
    marked = paper.replace(old, new, 1)
    before, after = marked.split("§")
    number, column = before.count("\n") + 1, len(before.rpartition("\n")[2]) + 1
    case = tmp_path / "case.yaml"
    case.write_text(before + after)
    line = refused(evolvent("run", "case.yaml"), CASE, tmp_path)
    assert line.startswith(f"case.yaml:{number}:{column}: ")
    assert reason in line


@pytest.mark.parametrize("option", ["wheels.pinion.teeth", "=20", "wheels..teeth=20", ".=1"])
def test_a_malformed_option_is_wrong_usage(
    evolvent: Evolvent, examples: Path, tmp_path: Path, option: str
) -> None:
    line = refused(evolvent("run", examples / "paper.yaml", "--set", option), USAGE, tmp_path)
    assert line.startswith(f"--set {option}")
    assert "--set wheels.pinion.teeth=20" in line


@pytest.mark.parametrize(
    ("content", "reason"),
    [
        (b"", "is empty; a case starts with 'format: 1'"),
        (b"# nothing yet\n", "is empty; a case starts with 'format: 1'"),
        (b"just words\n", "must be a block of keys, not 'just words'"),
        (b"- 1\n- 2\n", "must be a block of keys, not a list"),
        (b"\x89HDF\r\n\x1a\n\0\0", "case.yaml:1:1: not readable as UTF-8 text"),
        (
            "format: 1\ntitle: Zahnräder\n".encode("latin-1"),
            "case.yaml:2:14: not readable as UTF-8",
        ),
        (b"a: [1\nb: }", "not valid YAML"),
        (b"a: &a [*a]\n", "an alias that contains itself"),
    ],
)
def test_what_is_no_case_is_refused(
    evolvent: Evolvent, tmp_path: Path, content: bytes, reason: str
) -> None:
    (tmp_path / "case.yaml").write_bytes(content)
    line = refused(evolvent("run", "case.yaml"), CASE, tmp_path)
    assert line.startswith("case.yaml")
    assert reason in line


@pytest.mark.parametrize(
    ("path", "reason"),
    [("missing.yaml", "No such file or directory"), (".", "is a directory, not a case file")],
)
def test_a_path_without_a_case_is_named(
    evolvent: Evolvent, tmp_path: Path, path: str, reason: str
) -> None:
    line = refused(evolvent("run", path), CASE, tmp_path)
    assert line.startswith(f"{path}: ")
    assert reason in line


def test_the_case_in_a_history_gives_the_same_run(
    evolvent: Evolvent, examples: Path, tmp_path: Path
) -> None:
    options = [
        "--set=simulation={duration: 0.05, output_interval: 1e-3}",
        "--set=meshes.0.friction.coefficient=0.12345678901234567",
        "--set=wheels.gear.support.direction=33.3",
        "--set=wheels.pinion.loads.1={kind: table, time: [0, 0.03], torque: [0, -1e-1]}",
        "--set=title='100 % of it: \"quoted\", #5'",
    ]
    first = evolvent("run", examples / "paper.yaml", "-o", "first.h5", *options)
    assert first.returncode == 0, first.stderr
    with h5py.File(tmp_path / "first.h5") as history:
        text = history.attrs["case"]
    (tmp_path / "again.yaml").write_text(text)
    second = evolvent("run", "again.yaml", "-o", "second.h5")
    assert second.returncode == 0, second.stderr
    with h5py.File(tmp_path / "first.h5") as a, h5py.File(tmp_path / "second.h5") as b:
        assert b.attrs["case"] == text
        assert a.attrs["title"] == b.attrs["title"] == '100 % of it: "quoted", #5'
        names = [name for name, item in a.items() if isinstance(item, h5py.Dataset)]
        assert {"time", "penetration", "angular_velocity"} <= set(names)
        for name in names:
            np.testing.assert_array_equal(a[name][...], b[name][...], err_msg=name)


def test_show_gives_the_geometry_of_the_papers_pair(evolvent: Evolvent, examples: Path) -> None:
    result = evolvent("show", examples / "paper.yaml", "--json")
    assert result.returncode == 0
    shown = json.loads(result.stdout)
    pinion, gear = shown["wheels"]["pinion"], shown["wheels"]["gear"]
    mesh = shown["meshes"]["pinion-gear"]
    alpha = 1.05 * np.arctan(2 * np.pi / 50)
    base_radius = 0.2 * np.cos(alpha)
    mass = 7800 * np.pi * 0.3**2 * 0.1
    # closed forms in double precision: a few rounding errors
    tolerance = {"rel": 1e-14}
    assert mesh["working_pressure_angle"] == pytest.approx(alpha, **tolerance)
    assert pinion["base_radius"] == pytest.approx(base_radius, **tolerance)
    assert mesh["base_pitch"] == pytest.approx(base_radius * 2 * np.pi / 20, **tolerance)
    assert mesh["line_of_action_length"] == pytest.approx(0.5 * np.sin(alpha), **tolerance)
    assert mesh["centre_distance"] == pytest.approx(0.5, **tolerance)
    assert gear["pitch_radius"] == pytest.approx(0.3, **tolerance)
    assert gear["centre"] == pytest.approx([0.5, 0], abs=1e-15)
    assert gear["mass"] == pytest.approx(mass, **tolerance)
    assert gear["inertia"] == pytest.approx(mass * 0.3**2 / 2, **tolerance)
    assert shown["case"]["wheels"][0]["teeth"] == 20
    assert shown["case"]["meshes"][0]["contact"] == {"law": "johnson"}


def test_show_for_reading_has_defaults_and_engineering_units(
    evolvent: Evolvent, examples: Path
) -> None:
    text = evolvent("show", examples / "paper.yaml").stdout
    assert "max_step: 20 ms" in text
    assert "youngs_modulus: 200 GPa" in text
    assert re.search(r"working pressure angle +alpha_w +7\.5205\d* deg\n", text)
    assert re.search(r"base pitch.* 62\.29\d* mm\n", text)
    assert re.search(r"its penetration +h_0 +0\.002966\d* um\n", text)
    assert re.search(r"stiffness of one tooth pair there +k +1788\.15\d* N/um\n", text)
    assert re.search(r"reference position of the axle +O +\(500, 0\) mm\n", text)


@pytest.mark.parametrize(
    ("given", "radius"), [("radius: 0.2", 0.2), ("inertia: 0.1, mass: 8", None)]
)
def test_a_disc_shows_a_radius_only_if_it_has_one(
    evolvent: Evolvent, examples: Path, tmp_path: Path, given: str, radius: float | None
) -> None:
    """A disc has no teeth: no tooth data are shown, and no zeros."""
    case = tmp_path / "disc.yaml"
    text = (examples / "spur-pair.yaml").read_text()
    disc = f"wheels:\n- {{name: disc, width: 0.01, material: steel, {given}}}\n"
    shaft = "shafts:\n- {kind: rigid, name: one, wheels: [disc, pinion]}\n\nmeshes:"
    case.write_text(text.replace("wheels:\n", disc, 1).replace("meshes:", shaft, 1))
    shown = json.loads(evolvent("show", case, "--json").stdout)["wheels"]["disc"]
    assert shown.get("pitch_radius") == radius
    assert not {"base_radius", "tip_radius", "angular_pitch"} & set(shown)
    assert "base_radius" in json.loads(evolvent("show", case, "--json").stdout)["wheels"]["gear"]


@pytest.mark.parametrize("n", [1000, 1001])
def test_show_cuts_lists_of_more_than_1000_numbers(
    evolvent: Evolvent, examples: Path, tmp_path: Path, n: int
) -> None:
    """For reading; the JSON output contains all of them."""
    table = {"kind": "table", "time": list(range(n)), "torque": [-1.0] * n}
    text = f"\n  - {json.dumps(table)}"
    case = tmp_path / "long.yaml"
    case.write_text((examples / "spur-pair.yaml").read_text().replace("loads:", f"loads:{text}", 1))
    shown = evolvent("show", case).stdout
    assert shown.count("(995 more)") == (2 if n > 1000 else 0)
    loads = json.loads(evolvent("show", case, "--json").stdout)["case"]["wheels"][0]["loads"]
    assert loads[0]["time"] == table["time"]
    assert loads[0]["torque"] == table["torque"]


def test_show_applies_options(evolvent: Evolvent, examples: Path) -> None:
    result = evolvent("show", examples / "paper.yaml", "--json", "--set", "wheels.gear.teeth=40")
    shown = json.loads(result.stdout)
    assert shown["case"]["wheels"][1]["teeth"] == 40
    assert shown["wheels"]["gear"]["pitch_radius"] == pytest.approx(0.4, rel=1e-14)


@pytest.mark.parametrize(
    ("name", "teeth"),
    [("paper.yaml", (20, 30)), ("paper-friction.yaml", (20, 30)), ("pair-23-41.yaml", (23, 41))],
)
def test_every_example_is_a_good_case(
    evolvent: Evolvent, examples: Path, name: str, teeth: tuple[int, int]
) -> None:
    """Its geometry is that of two involutes of one base pitch that meet at the pitch point."""
    for options in ((), ("--json",)):
        result = evolvent("show", examples / name, *options)
        assert result.returncode == 0, result.stderr
    shown = json.loads(result.stdout)
    (mesh,), pair = shown["meshes"].values(), list(shown["wheels"].values())
    assert mesh["transmission_ratio"] == pytest.approx(teeth[1] / teeth[0], rel=1e-14)
    assert mesh["contact_ratio"] == pytest.approx(1, abs=1e-12)  # one pair hands over to the next
    alpha = mesh["working_pressure_angle"]
    for wheel, z in zip(pair, teeth, strict=True):
        assert wheel["base_radius"] == pytest.approx(wheel["pitch_radius"] * np.cos(alpha))
        assert mesh["base_pitch"] == pytest.approx(2 * np.pi * wheel["base_radius"] / z, rel=1e-14)
    assert mesh["centre_distance"] == pytest.approx(sum(w["pitch_radius"] for w in pair), rel=1e-14)


def test_all_laws_are_listed_with_their_parameters_and_units(evolvent: Evolvent) -> None:
    text = evolvent("show", "--laws").stdout
    families = re.split(r"^(\w+):\n", text, flags=re.MULTILINE)[1:]
    listed = {
        family: {
            entry.group(1): re.findall(r"^ {6}(\w+(?: \[.*?\])?): ", entry.group(2), re.MULTILINE)
            for entry in re.finditer(r"^  \{law: (\w+)\}.*\n((?: {6}.*\n)*)", laws, re.MULTILINE)
        }
        for family, laws in zip(families[::2], families[1::2], strict=True)
    }
    for laws in listed.values():
        for parameters in laws.values():
            if "source" in parameters:
                parameters.remove("source")
    impact = ["restitution", "v0_min [m/s]"]
    named = ["hunt_crossley", "lankarani_nikravesh", "flores", "gonthier", "lee_wang"]
    delta = "regularisation_velocity [m/s]"
    assert listed == {
        "contact": {
            "johnson": [],
            "radzimovsky": [],
            "linear": ["stiffness [N/m]"],
            "yang_lin": [],
            "power": ["coefficient [N/m^exponent]", "exponent"],
            "rigid": ["restitution", "rest_velocity [m/s]"],
        },
        "damping": {
            "none": [],
            "linear": ["coefficient [N s/m]"],
            "one_sided": ["coefficient [N s/m2]"],
            **dict.fromkeys(named, impact),
            "ratio": ["value"],
        },
        "friction": {
            "none": [],
            "coulomb": ["coefficient", delta],
            "tanh": ["coefficient", delta],
            "stribeck": [
                "static_coefficient",
                "kinetic_coefficient",
                "stribeck_velocity [m/s]",
                delta,
            ],
            "schlenk": ["lubricant_factor", delta],
            "mean_roughness": ["lubricant_factor", delta],
            "benedict_kelley": [delta],
            "xu_kahraman": [delta],
        },
    }


def test_the_documentation_has_every_key(evolvent: Evolvent, root: Path) -> None:
    keys = evolvent("show", "--keys").stdout
    assert keys.count("\n| `") > 55
    assert (root / "docs" / "reference" / "case_format.md").read_text().endswith(keys)


def test_output_that_cannot_be_written_is_said(evolvent: Evolvent, examples: Path) -> None:
    with Path("/dev/full").open("w") as full:
        result = evolvent(
            "show",
            examples / "paper.yaml",
            capture_output=False,
            stdout=full,
            stderr=subprocess.PIPE,
        )
    assert result.returncode == 74
    assert "No space left on device" in result.stderr
