"""Test trains with shafts."""

from __future__ import annotations

from typing import Any

import numpy as np

from kernel.description import Block
from kernel.gearbox import Gearbox, State
from kernel.gearbox_cases import draw
from kernel.gearbox_description import (
    BEARING,
    CLOSED_FORM,
    SLIDER,
    SPEED,
    SPEEDS,
    TORQUE,
    VISCOUS,
    load,
    mesh,
    shaft,
    wheel,
)
from kernel.kernel import Kernel

MOTOR, PINION, GEAR, SECOND_PINION, SECOND_GEAR, DRUM = range(6)


def two_stages(
    kernel: Kernel,
    *,
    middle: float | None = 3e4,
    tracking: str = CLOSED_FORM,
    driven_by: str = "torque",
    housing: Block | None = None,
    against_housing: bool = False,
    second_first: bool = False,
    **fields: Any,
) -> Gearbox:
    """Motor disc, two stages, drum; an elastic shaft at either end, one in the middle.

    middle: stiffness of the shaft between the stages, None if it is rigid; driven_by: torque, or
    the wheel with a prescribed speed, motor, gear or drum; second_first: order of the meshes.
    Fields of both meshes.
    """
    wheels = [
        wheel(teeth=0, pitch_radius=0.08, width=0.05),
        wheel(teeth=20, pitch_radius=0.05, width=0.03, centre=(0.0, 0.0)),
        wheel(
            teeth=47,
            width=0.03,
            **{"support_kind": SLIDER, "support_direction": 0.4, "support_mass": 1.0},
            **{"support_stiffness": (2e8, 0.0), "support_damping": (1e3, 0.0)},
        ),
        wheel(
            teeth=23,
            pitch_radius=0.06,
            width=0.03,
            axial_position=0.1,
            **{"support_kind": BEARING, "support_mass": 2.0},
            **{"support_stiffness": (1e8, 3e8), "support_damping": (2e3, 1e3)},
        ),
        wheel(teeth=53, width=0.03, axial_position=0.1),
        wheel(teeth=0, inertia=0.8, mass=50.0, width=0.2),
    ]
    loads = [load(DRUM, VISCOUS, 20.0), load(SECOND_PINION, VISCOUS, 0.1), load(GEAR, TORQUE, 0.3)]
    if driven_by == "torque":
        loads.append(load(MOTOR, TORQUE, -5.0))
    else:
        driver = {"motor": MOTOR, "gear": GEAR, "drum": DRUM}[driven_by]
        speed = [(0.0, -4.0), (0.5, -6.0), (2.0, -9.0)]
        loads.append(load(driver, SPEED, table=speed, against_housing=against_housing))
    common = {"pressure_angle": 0.35, "tracking": tracking, "friction": (0.2, 2e-3), "damping": 1e3}
    meshes = [
        mesh(kernel, PINION, GEAR, driving_rotation=-1, centre_line_angle=0.2, **common | fields),
        mesh(
            kernel,
            *(SECOND_PINION, SECOND_GEAR),
            **{"driving_rotation": 1, "centre_line_angle": 0.9},
            **common | fields,
        ),
    ]
    shafts = [
        shaft(MOTOR, PINION, 5e4, 1.0),
        shaft(GEAR, SECOND_PINION, middle, 0.0 if middle is None else 0.5),
        shaft(DRUM, SECOND_GEAR, 1e5, 5.0),
    ]
    if second_first:
        meshes.reverse()
    return Gearbox(kernel, wheels, loads, meshes, housing, shafts)


def stirred(gearbox: Gearbox, random: np.random.Generator, gap: float = -1e-6) -> State:
    """State on the path of contact, with small displacements and velocities of all bodies."""
    ratios = np.array([gearbox.wheel_geometry(i).speed_ratio for i in range(6)])
    pitch = gearbox.wheel_geometry(PINION).angular_pitch
    # the tables of speeds give -7 rad/s at 1 s
    state = gearbox.start(SPEEDS, speeds=-7.0 * ratios, gaps=[gap, gap], t=1.0)
    state.y[gearbox.index("reference_angle")] = -0.4 * pitch / ratios[PINION]
    for i, name in enumerate(gearbox.names):
        if name.startswith(("angle_deviation", "displacement")):
            state.y[i] += draw(random, 1e-3 if name.endswith("rate") else 0.1 * abs(gap))
        if name.startswith("speed_deviation"):
            state.y[i] += draw(random, 1e-2)
    state.yp = gearbox.derivative(state)
    return state
