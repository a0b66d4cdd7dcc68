"""Accelerometers of a housing: second differences of where they are, by sixty digits."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import mpmath as mp
import numpy as np
import pytest

from kernel.description import Block
from kernel.gearbox import Gearbox, GearboxError
from kernel.gearbox_cases import paper_gearbox
from kernel.gearbox_description import TORQUE, load, mesh, wheel
from kernel.housing_cases import ACCELEROMETERS, HOUSINGS, MOTION
from kernel.housing_description import (
    CONSTANT,
    HARMONIC,
    MOUNTED,
    PRESCRIBED,
    RATE,
    TURN_X,
    housing,
)
from kernel.kernel import INVALID_INPUT, Floats, Kernel

BY_FORMULA = [one for one in MOTION if one.kind in {CONSTANT, RATE, HARMONIC}]
GRAVITY = [0.5, -1.0, -9.7]


def gearbox_in(kernel: Kernel, body: Block) -> Gearbox:
    wheels = [wheel(pitch_radius=0.2, centre=(0.0, 0.0)), wheel(teeth=30)]
    return Gearbox(kernel, wheels, [load(0, TORQUE, -1.0)], [mesh(kernel)], body)


def readings(gearbox: Gearbox, t: float = 0.0) -> Floats:
    return gearbox.outputs(replace(gearbox.start(), t=t))["accelerometer_acceleration"]


def cross_matrix(v: Any) -> Any:
    return mp.matrix([[0, -v[2], v[1]], [v[2], 0, -v[0]], [-v[1], v[0], 0]])


def pose(t: Any) -> tuple[Any, Any]:
    """Position and rotation matrix of the motion, from its terms."""
    x = [mp.mpf(0)] * 6
    for one in BY_FORMULA:
        if one.kind == HARMONIC:
            angle = 2 * mp.pi * mp.mpf(one.frequency) * t + mp.mpf(one.phase)
            x[one.coordinate] += mp.mpf(one.amplitude) * mp.sin(angle)
        else:
            x[one.coordinate] += mp.mpf(one.value) * (t if one.kind == RATE else 1)
    return mp.matrix(x[:TURN_X]), mp.expm(cross_matrix(x[TURN_X:]))


@pytest.mark.parametrize("t", [0.0, 0.123, 0.9])
def test_in_a_prescribed_motion_they_tell_the_second_difference_of_their_place(
    kernel: Kernel, t: float
):
    body = housing(PRESCRIBED, terms=BY_FORMULA, gravity=GRAVITY, accelerometers=ACCELEROMETERS)
    reported = readings(gearbox_in(kernel, body), t)
    with mp.workdps(60):
        h = mp.mpf(10) ** -15
        for reading, one in zip(reported, ACCELEROMETERS, strict=True):
            at = {}
            for k in (-2, -1, 0, 1, 2):
                position, rotation = pose(mp.mpf(t) + k * h)
                at[k] = position + rotation * mp.matrix(one["point"])
            second = (16 * (at[1] + at[-1]) - (at[2] + at[-2]) - 30 * at[0]) / (12 * h**2)
            direction = pose(mp.mpf(t))[1] * mp.matrix(one["direction"]) / mp.norm(one["direction"])
            expected = float(sum(a * b for a, b in zip(second, direction, strict=True)))
            size = float(mp.norm(second)) + 10.0  # gravity is taken off and put on again
            assert abs(reading - expected) <= 2e-15 * 10 * size


def test_of_a_mounted_housing_they_tell_the_acceleration_of_a_rigid_body(kernel: Kernel):
    """From the acceleration of its origin in the ground frame, and its angular motion."""
    gearbox = gearbox_in(kernel, HOUSINGS["mounted"])
    out = gearbox.outputs(gearbox.start())
    p0, q = out["housing_orientation"][0], out["housing_orientation"][1:]
    rotation = (p0**2 - q @ q) * np.eye(3) + 2 * np.outer(q, q) + 2 * p0 * np.cross(np.eye(3), q)
    origin = rotation.T @ out["housing_acceleration"]
    spin, change = out["housing_angular_velocity"], out["housing_angular_acceleration"]
    for reading, one in zip(out["accelerometer_acceleration"], ACCELEROMETERS, strict=True):
        point, direction = np.array(one["point"]), np.array(one["direction"])
        felt = origin + np.cross(change, point) + np.cross(spin, np.cross(spin, point))
        expected = felt @ direction / np.linalg.norm(direction)
        assert reading == pytest.approx(expected, rel=1e-12)


def test_gravity_is_not_counted(kernel: Kernel):
    """Zero in a housing that rests under gravity; that of gravity in one that falls."""
    along = [{"name": axis, "point": [0.1, 0.2, 0.3], "direction": list(row)} for axis, row in AXES]
    still = housing(PRESCRIBED, gravity=GRAVITY, accelerometers=along)
    np.testing.assert_array_equal(readings(gearbox_in(kernel, still)), 0)
    falling = housing(
        MOUNTED, mass=30.0, inertia=[2.0, 2.5, 3.1], gravity=GRAVITY, accelerometers=along
    )
    np.testing.assert_allclose(readings(gearbox_in(kernel, falling)), GRAVITY, rtol=1e-12)


AXES = tuple(zip("xyz", np.eye(3), strict=True))


@pytest.mark.parametrize("size", [2.0**-600, 0.5, 2.0**600])
def test_a_direction_has_any_length_but_zero(kernel: Kernel, size: float):
    body = HOUSINGS["prescribed"]
    scaled = [{**one, "direction": [size * x for x in one["direction"]]} for one in ACCELEROMETERS]
    reported = readings(gearbox_in(kernel, Block(body, accelerometers=scaled)), 0.2)
    np.testing.assert_array_equal(reported, readings(gearbox_in(kernel, body), 0.2))


def test_one_without_a_direction_is_refused(kernel: Kernel):
    bad = [ACCELEROMETERS[0], {**ACCELEROMETERS[1], "direction": [0.0, 0.0, 0.0]}]
    with pytest.raises(GearboxError) as caught:
        gearbox_in(kernel, Block(HOUSINGS["prescribed"], accelerometers=bad))
    assert caught.value.code == INVALID_INPUT
    assert caught.value.field == "accelerometers.1.direction"
    assert "give for instance" in caught.value.message


def test_without_them_there_is_no_such_output(kernel: Kernel):
    gearbox = paper_gearbox(kernel)
    assert "accelerometer_acceleration" not in gearbox.outputs(gearbox.start())
