"""Every description that makes no gearbox is refused with what, which, the field and the reason."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from kernel.description import Block
from kernel.gearbox import LOAD, MESH, NOTHING, WHEEL, Gearbox, GearboxError
from kernel.gearbox_description import (
    BEARING,
    SLIDER,
    SPEED,
    TABLE,
    TORQUE,
    VISCOUS,
    load,
    load_of,
    mesh,
    wheel,
)
from kernel.kernel import FRICTION, INVALID_INPUT, Kernel, KernelError

NAN, INF = np.nan, np.inf
Parts = tuple[list[Block], list[Block], list[Block]]


def parts(kernel: Kernel) -> Parts:
    """Three wheels in a row that make a gearbox."""
    wheels = [wheel(teeth=20, pitch_radius=0.2), wheel(teeth=30), wheel(teeth=25)]
    loads = [load(0, TORQUE, -1.0), load(2, VISCOUS, 10.0)]
    meshes = [
        mesh(kernel, 0, 1, pressure_angle=0.35),
        mesh(kernel, 1, 2, pressure_angle=0.35, driving_rotation=1, centre_line_angle=0.5),
    ]
    return wheels, loads, meshes


def refusal(kernel: Kernel, some: Parts) -> GearboxError:
    with pytest.raises(GearboxError) as error:
        Gearbox(kernel, *some)
    assert error.value.code == INVALID_INPUT
    assert error.value.message
    assert "\n" not in error.value.message
    assert not error.value.message.endswith(".")
    return error.value


def test_the_parts_that_the_refusals_start_from_make_a_gearbox(kernel: Kernel):
    assert Gearbox(kernel, *parts(kernel)).sizes.n_wheels == 3


POSITIVE = ("pitch_radius", "width", "inertia", "mass")
NOT_POSITIVE = [
    *((value, "must be greater than 0") for value in (0.0, -1.0)),
    *((value, "must be a finite number") for value in (NAN, INF, -INF)),
]
NOT_NEGATIVE = ("support_mass", "support_stiffness", "support_damping")
BAD_WHEELS: list[tuple[dict[str, Any], str, str]] = [
    *(({"teeth": z}, "teeth", str(z)) for z in (-3, 1, 2, 10001)),
    *(({name: value}, name, words) for name in POSITIVE for value, words in NOT_POSITIVE),
    *(({"centre": c}, "centre", "finite") for c in ((NAN, 0), (0, INF))),
    *(
        ({"support_kind": kind}, "support.kind", "must be one of fixed slider bearing")
        for kind in ("", "hydrostatic")
    ),
    *(
        ({"support_kind": SLIDER, "support_direction": value}, "support.direction", "finite")
        for value in (NAN, INF)
    ),
    *(
        (
            {"support_kind": kind, name: value if name == "support_mass" else pair},
            name.replace("_", "."),
            "must be at least 0" if value < 0 else "must be a finite number",
        )
        for kind in (SLIDER, BEARING)
        for name in NOT_NEGATIVE
        for value in (-1.0, NAN, INF)
        for pair in ((value, 0.0), (0.0, value))[: 1 if kind == SLIDER else 2]
    ),
]


@pytest.mark.parametrize(("fields", "field", "words"), BAD_WHEELS, ids=str)
@pytest.mark.parametrize("index", [0, 2])
def test_a_bad_wheel_is_refused(
    kernel: Kernel, index: int, fields: dict[str, Any], field: str, words: str
):
    wheels, loads, meshes = parts(kernel)
    given = {"teeth": wheels[index].teeth, "pitch_radius": 0.01 * wheels[index].teeth, **fields}
    wheels[index] = wheel(**given)
    error = refusal(kernel, (wheels, loads, meshes))
    assert (error.subject, error.index, error.field) == (WHEEL, index, field), error.message
    assert words in error.message


BAD_MATERIALS: list[tuple[str, float, str]] = [
    *((name, *bad) for name in ("youngs_modulus", "density") for bad in NOT_POSITIVE),
    *(("poisson_ratio", value, "must be less than 0.5") for value in (0.5, 0.7)),
    *(("poisson_ratio", value, "must be at least 0") for value in (-0.1, -1.0)),
    *(("poisson_ratio", value, "must be a finite number") for value in (NAN, INF)),
]


@pytest.mark.parametrize(("key", "value", "words"), BAD_MATERIALS, ids=str)
@pytest.mark.parametrize("index", [0, 2])
def test_a_bad_material_is_refused(kernel: Kernel, index: int, key: str, value: float, words: str):
    wheels, loads, meshes = parts(kernel)
    wheels[index].material[key] = value
    error = refusal(kernel, (wheels, loads, meshes))
    assert (error.subject, error.field) == (NOTHING, f"materials.m{index}.{key}"), error.message
    assert words in error.message


SUPPORTS: dict[str, tuple[Block, str, str]] = {
    "a slider without stiffness": (Block(kind=SLIDER), "support.stiffness", "is missing"),
    "a slider of two directions": (
        Block(kind=SLIDER, direction=(1.0, 1.0), stiffness=1.0),
        "support.direction",
        "one number",
    ),
    "a bearing of one stiffness": (
        Block(kind=BEARING, stiffness=1.0),
        "support.stiffness",
        "two numbers",
    ),
    "a bearing with a direction": (
        Block(kind=BEARING, direction=1.0, stiffness=(1.0, 1.0)),
        "support.direction",
        "no meaning here",
    ),
}


@pytest.mark.parametrize(("support", "field", "words"), SUPPORTS.values(), ids=SUPPORTS.keys())
def test_a_support_needs_the_numbers_of_its_kind(
    kernel: Kernel, support: Block, field: str, words: str
):
    wheels, loads, meshes = parts(kernel)
    wheels[1].support = support
    error = refusal(kernel, (wheels, loads, meshes))
    assert (error.subject, error.index, error.field) == (WHEEL, 1, field), error.message
    assert words in error.message


def with_table(kind: str, *knots: tuple[float, float]) -> Callable[[], Block]:
    return lambda: load(1, kind, table=knots)


def of_lengths(kind: str, **counts: int) -> Callable[[], Block]:
    return lambda: load_of(1, kind, **{key: list(range(n)) for key, n in counts.items()})


BAD_LOADS: dict[str, tuple[Callable[[], Block], str, str]] = {
    "kind that is none": (lambda: load(1, "thermal", 1.0), "kind", "must be one of torque"),
    "no kind": (lambda: load(1, "", 1.0), "kind", "must be one of torque"),
    "against nothing": (
        lambda: load_of(1, TORQUE, against="void", value=1.0),
        "against",
        "must be one of ground housing",
    ),
    "torque nan": (lambda: load(1, TORQUE, NAN), "value", "finite"),
    "torque inf": (lambda: load(1, TORQUE, INF), "value", "finite"),
    "speed inf": (lambda: load(1, SPEED, -INF), "value", "finite"),
    "viscous nan": (lambda: load(1, VISCOUS, NAN), "coefficient", "finite"),
    "viscous negative": (lambda: load(1, VISCOUS, -2.5), "coefficient", "-2.5 N m s/rad must be"),
    "table without knots": (lambda: load(1, TABLE), "time", "two knots"),
    "table of one knot": (with_table(TABLE, (0, 1)), "time", "two knots"),
    "table backwards": (with_table(TABLE, (0, 1), (2, 1), (1.5, 2)), "time", "1.5 s follows 2 s"),
    "table standing": (with_table(SPEED, (0, 1), (1, 1), (1, 2)), "time", "1 s follows 1 s"),
    "table with nan": (with_table(TABLE, (0, 1), (1, NAN)), "torque", "finite"),
    "table to the end of time": (with_table(TABLE, (0, 1), (INF, 1)), "time", "finite"),
    "table without torques": (of_lengths(TABLE, time=2), "torque", "is missing"),
    "more values than times": (of_lengths(TABLE, time=2, torque=3), "torque", "as many"),
    "torque without a value": (of_lengths(TORQUE), "value", "is missing"),
    "torque of no value": (of_lengths(TORQUE, value=0), "value", "one number"),
    "torque of two values": (of_lengths(TORQUE, value=2), "value", "one number"),
    "torque with a coefficient": (
        of_lengths(TORQUE, value=1, coefficient=1),
        "coefficient",
        "no meaning here",
    ),
    "speed of value and table": (
        of_lengths(SPEED, value=1, time=2, speed=2),
        "",
        "needs either",
    ),
    "speed of value and times": (of_lengths(SPEED, value=1, time=2), "", "needs either"),
    "speed without anything": (of_lengths(SPEED), "", "needs either"),
}


@pytest.mark.parametrize(("make", "field", "words"), BAD_LOADS.values(), ids=BAD_LOADS.keys())
def test_a_bad_load_is_refused(kernel: Kernel, make: Callable[[], Block], field: str, words: str):
    wheels, loads, meshes = parts(kernel)
    error = refusal(kernel, (wheels, [*loads, make()], meshes))
    assert (error.subject, error.index, error.field) == (LOAD, 2, field), error.message
    assert words in error.message


def test_a_second_prescribed_speed_of_a_wheel_is_refused(kernel: Kernel):
    wheels, loads, meshes = parts(kernel)
    loads = [load(1, SPEED, 1.0), *loads, load(1, SPEED, 1.0)]
    error = refusal(kernel, (wheels, loads, meshes))
    assert (error.subject, error.index, error.field) == (LOAD, 3, "")
    assert "a second prescribed speed" in error.message


BAD_MESHES: list[tuple[dict[str, Any], str, str]] = [
    ({"driving": 3}, "driving", "no such driving wheel"),
    ({"driving": -1}, "driving", "no such driving wheel"),
    ({"driven": 3}, "driven", "no such driven wheel"),
    ({"driven": 1}, "driven", "with itself"),
    *(({"tracking": t}, "tracking", "must be one of closed_form") for t in ("", "guessed")),
    *(
        ({"driving_rotation": r}, "driving_rotation", "must be one of clockwise counterclockwise")
        for r in ("", "widdershins")
    ),
    *(({"centre_line_angle": a}, "centre_line_angle", "") for a in (NAN, INF)),
    *(({"pressure_angle": a}, "pressure_angle", "") for a in (NAN, INF, 1.6, -0.3, 0.05)),
    *(({"friction": (f, 1e-4)}, "friction.coefficient", "") for f in (-0.1, NAN, INF)),
    *(
        ({"friction": (0.1, d)}, "friction.regularisation_velocity", "")
        for d in (0.0, -1e-4, NAN, INF)
    ),
    *(({"damping": c}, "damping.coefficient", "") for c in (-1.0, NAN, INF)),
]


@pytest.mark.parametrize(("fields", "field", "words"), BAD_MESHES, ids=str)
def test_a_bad_mesh_is_refused(kernel: Kernel, fields: dict[str, Any], field: str, words: str):
    wheels, loads, meshes = parts(kernel)
    given = {
        **{"driving": 1, "driven": 2, "pressure_angle": 0.35, "driving_rotation": 1},
        "centre_line_angle": 0.5,
        **fields,
    }
    meshes[1] = mesh(kernel, **given)
    error = refusal(kernel, (wheels, loads, meshes))
    assert (error.subject, error.index, error.field) == (MESH, 1, field), error.message
    assert words in error.message


def test_a_law_that_does_not_exist_is_refused(kernel: Kernel):
    for family in ("contact", "damping", "friction"):
        for law in ("", "hooke"):
            wheels, loads, meshes = parts(kernel)
            meshes[0][family] = Block(law=law)
            error = refusal(kernel, (wheels, loads, meshes))
            assert (error.subject, error.index, error.field) == (MESH, 0, f"{family}.law")


# ---- layouts that contradict themselves


def layout(kernel: Kernel, wheels: list[Block], *meshes: dict[str, Any]) -> GearboxError:
    return refusal(kernel, (wheels, [], [mesh(kernel, pressure_angle=0.35, **m) for m in meshes]))


def test_no_pitch_radius_at_all_is_refused(kernel: Kernel):
    error = layout(kernel, [wheel(teeth=20), wheel(teeth=30)], {})
    assert (error.subject, error.index, error.field) == (WHEEL, 0, "pitch_radius")


def test_pitch_radii_that_are_not_as_the_teeth_are_refused(kernel: Kernel):
    wheels = [wheel(teeth=20, pitch_radius=0.2), wheel(teeth=30, pitch_radius=0.31)]
    error = layout(kernel, wheels, {})
    assert (error.subject, error.index, error.field) == (WHEEL, 1, "pitch_radius")
    assert "0.31 m does not agree with 0.3 m" in error.message


def test_pitch_radii_that_agree_to_rounding_are_taken(kernel: Kernel):
    wheels = [wheel(teeth=20, pitch_radius=0.2), wheel(teeth=30, pitch_radius=0.3 * (1 + 1e-12))]
    assert Gearbox(kernel, wheels, [], [mesh(kernel)])


def test_centres_that_are_not_the_sum_of_the_radii_apart_are_refused(kernel: Kernel):
    wheels = [
        wheel(teeth=20, pitch_radius=0.2, centre=(0, 0)),
        wheel(teeth=30, centre=(0.0, 0.51)),
    ]
    error = layout(kernel, wheels, {"centre_line_angle": None})
    assert (error.subject, error.index, error.field) == (WHEEL, 1, "centre")
    assert "0.51 m" in error.message
    assert "0.5 m" in error.message


def test_a_centre_line_angle_that_is_not_the_direction_of_the_centres_is_refused(kernel: Kernel):
    wheels = [
        wheel(teeth=20, pitch_radius=0.2, centre=(0, 0)),
        wheel(teeth=30, centre=(0.0, 0.5)),
    ]
    error = layout(kernel, wheels, {"centre_line_angle": np.pi / 3})
    assert (error.subject, error.index, error.field) == (MESH, 0, "centre_line_angle")
    assert "60 deg does not agree with 90 deg" in error.message


def test_the_same_direction_a_turn_later_is_taken(kernel: Kernel):
    wheels = [
        wheel(teeth=20, pitch_radius=0.2, centre=(0, 0)),
        wheel(teeth=30, centre=(0.0, -0.5)),
    ]
    assert Gearbox(kernel, wheels, [], [mesh(kernel, centre_line_angle=1.5 * np.pi)])


def test_no_direction_of_the_centre_line_is_refused(kernel: Kernel):
    wheels = [wheel(teeth=20, pitch_radius=0.2, centre=(0, 0)), wheel(teeth=30)]
    error = layout(kernel, wheels, {"centre_line_angle": None})
    assert (error.subject, error.index, error.field) == (MESH, 0, "centre_line_angle")


def test_separate_trains_are_refused(kernel: Kernel):
    wheels = [wheel(teeth=20, pitch_radius=0.2, centre=(0, 0)), wheel(teeth=30)]
    wheels += [wheel(teeth=20, pitch_radius=0.2, centre=(1, 1)), wheel(teeth=30)]
    error = layout(kernel, wheels, {}, {"driving": 2, "driven": 3})
    assert (error.subject, error.index) == (WHEEL, 2)
    assert "separate" in error.message


def test_a_wheel_without_a_mesh_is_refused_beside_others(kernel: Kernel):
    wheels = [wheel(teeth=20, pitch_radius=0.2, centre=(0, 0)), wheel(teeth=30)]
    wheels.append(wheel(teeth=20, pitch_radius=0.2, centre=(1, 1)))
    error = layout(kernel, wheels, {})
    assert (error.subject, error.index) == (WHEEL, 2)


def test_a_ring_of_three_wheels_cannot_turn(kernel: Kernel):
    side, height = 0.4, 0.4 * np.sqrt(3) / 2
    centres = [(0, 0), (side, 0), (side / 2, height)]
    wheels = [wheel(teeth=20, pitch_radius=0.2, centre=c) for c in centres]
    rings = [{"driving": i, "driven": (i + 1) % 3, "centre_line_angle": None} for i in range(3)]
    error = layout(kernel, wheels, *rings)
    assert (error.subject, error.index) == (MESH, 2)
    assert "odd number" in error.message


def test_two_pressure_angles_at_one_wheel_are_refused(kernel: Kernel):
    """A wheel has one base circle."""
    wheels, loads, meshes = parts(kernel)
    meshes[1].pressure_angle = 0.36
    error = refusal(kernel, (wheels, loads, meshes))
    assert (error.subject, error.index, error.field) == (MESH, 1, "pressure_angle")
    assert "base radius" in error.message


def test_the_paper_s_rule_at_a_wheel_between_two_others_is_refused_too(kernel: Kernel):
    """It gives each mesh a pressure angle of its own."""
    wheels, loads, _ = parts(kernel)
    meshes = [mesh(kernel, 0, 1), mesh(kernel, 1, 2, driving_rotation=1, centre_line_angle=0.5)]
    error = refusal(kernel, (wheels, loads, meshes))
    assert (error.subject, error.index, error.field) == (MESH, 1, "pressure_angle")


def test_a_gearbox_of_no_wheels_is_refused(kernel: Kernel):
    assert refusal(kernel, ([], [], [])).subject == NOTHING


def test_a_wheel_alone_is_a_gearbox(kernel: Kernel):
    gearbox = Gearbox(kernel, [wheel(teeth=20, pitch_radius=0.2)], [load(0, TORQUE, 3.0)], [])
    state = gearbox.start()
    assert state.yp[1] == pytest.approx(3.0 / gearbox.wheel_geometry(0).inertia, rel=1e-15)
    assert gearbox.outputs(state)["angular_acceleration"][0] == state.yp[1]


# ---- what is allowed but worth knowing


def test_a_path_of_contact_without_the_pitch_point_is_warned_of(kernel: Kernel):
    wheels = [wheel(teeth=20, pitch_radius=0.1), wheel(teeth=90)]
    warnings = [
        Gearbox(kernel, wheels, [], [mesh(kernel, pressure_angle=angle)]).warnings()
        for angle in (0.07, 0.35)
    ]
    assert warnings[0] == []
    assert len(warnings[1]) == 1
    assert (warnings[1][0].subject, warnings[1][0].index) == (MESH, 0)
    assert "pitch point" in warnings[1][0].message


def test_a_flank_against_the_sense_of_the_first_mesh_is_warned_of(kernel: Kernel):
    wheels, loads, meshes = parts(kernel)
    assert Gearbox(kernel, wheels, loads, meshes).warnings() == []
    meshes[1].driving_rotation = "clockwise"
    (warning,) = Gearbox(kernel, wheels, loads, meshes).warnings()
    assert (warning.subject, warning.index) == (MESH, 1)
    assert "driving_rotation" in warning.message


def test_law_parameters_are_checked_by_the_law_table(kernel: Kernel):
    """The range stands in the row: the law says the same of it, and that it is the law."""
    wheels, loads, meshes = parts(kernel)
    meshes[0] = mesh(kernel, pressure_angle=0.35, friction=(-0.5, 1e-4))
    error = refusal(kernel, (wheels, loads, meshes))
    with pytest.raises(KernelError, match=r"-0\.5") as alone:
        kernel.law_validate(FRICTION, kernel.law(FRICTION, "coulomb", coefficient=-0.5))
    assert f"{error.message} (law coulomb)" == alone.value.message
