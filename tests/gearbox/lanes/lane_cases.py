"""Gearboxes for the lanes: one for each law, each deviation of a flank and each kind of load."""

from __future__ import annotations

from typing import Any

import numpy as np

from kernel.description import Block
from kernel.deviations import LINEAR, PARABOLIC, deviations, relief
from kernel.gearbox import LOADED, Gearbox, State
from kernel.gearbox_cases import draw
from kernel.gearbox_description import (
    BEARING,
    SLIDER,
    TORQUE,
    VISCOUS,
    load,
    load_like,
    mesh,
    wheel,
)
from kernel.gears import gear_description
from kernel.kernel import CONTACT, DAMPING, FRICTION, Kernel
from load_samples import SAMPLES

OFF = 4

CONTACTS: dict[str, dict[str, float]] = {
    "johnson": {},
    "radzimovsky": {},
    "linear": {"stiffness": 1e8},
    "yang_lin": {},
    "power": {"coefficient": 1e12, "exponent": 1.5},
}
RESTITUTION = {"restitution": 0.5, "v0_min": 1e-2}
DAMPINGS: dict[str, dict[str, float]] = {
    "none": {},
    "linear": {"coefficient": 3e3},
    "one_sided": {"coefficient": 1e10},
    **dict.fromkeys(
        ("hunt_crossley", "lankarani_nikravesh", "flores", "gonthier", "lee_wang"), RESTITUTION
    ),
    "ratio": {"value": 0.07},
}
FRICTIONS: dict[str, dict[str, float]] = {
    "none": {},
    "coulomb": {"coefficient": 0.2, "regularisation_velocity": 2e-3},
    "tanh": {"coefficient": 0.2, "regularisation_velocity": 2e-3},
    "stribeck": {
        "static_coefficient": 0.3,
        "kinetic_coefficient": 0.1,
        "stribeck_velocity": 0.02,
        "regularisation_velocity": 2e-3,
    },
    "schlenk": {"lubricant_factor": 3.0, "regularisation_velocity": 2e-3},
    "mean_roughness": {"lubricant_factor": 3.0, "regularisation_velocity": 2e-3},
    "benedict_kelley": {"regularisation_velocity": 2e-3},
    "xu_kahraman": {"regularisation_velocity": 2e-3},
}
LAWS = [
    *((contact, "flores", "coulomb") for contact in CONTACTS),
    *(("johnson", damping, "coulomb") for damping in DAMPINGS),
    *(("radzimovsky", "linear", friction) for friction in FRICTIONS),
]

TEETH = (20, 35)
TIP, ROOT = (0.0645, 0.1095), (0.0575, 0.1015)  # diameters at the start of relief [m]
ROOT_ROLL = (0.2, 0.24)  # about the same as roll angles
DEVIATIONS: dict[str, tuple[dict[str, Any], dict[str, Any]]] = {
    "perfect": ({}, {}),
    "linear tip relief": tuple({"tip_relief": relief(2e-5, diameter=d)} for d in TIP),
    "parabolic tip relief": tuple(
        {"tip_relief": relief(2e-5, diameter=d, shape=PARABOLIC)} for d in TIP
    ),
    "linear root relief": tuple({"root_relief": relief(1e-5, roll_angle=a)} for a in ROOT_ROLL),
    "parabolic root relief": tuple(
        {"root_relief": relief(1e-5, diameter=d, shape=PARABOLIC)} for d in ROOT
    ),
    "crowning": ({"profile_crowning": 3e-6}, {"profile_crowning": 4e-6}),
    "pitch errors": tuple(
        {"pitch_errors": list(1e-6 * np.random.default_rng(z).normal(size=z))} for z in TEETH
    ),
    "accuracy class": tuple({"accuracy_class": 6, "seed": z} for z in TEETH),
    "runout": (
        {"runout_amount": 1e-5},
        {"radial_runout": 4e-5, "runout_phase": 1.0},
    ),
    "all of them": tuple(
        {
            "tip_relief": relief(2e-5, diameter=TIP[i], shape=(PARABOLIC, LINEAR)[i]),
            "root_relief": relief(1e-5, diameter=ROOT[i], shape=(LINEAR, PARABOLIC)[i]),
            "profile_crowning": 3e-6,
            "accuracy_class": 5,
            "seed": i,
            "runout_amount": 1e-5,
            "runout_phase": 0.5,
        }
        for i in range(2)
    ),
}


def pair_with_laws(kernel: Kernel, contact: str, damping: str, friction: str) -> Gearbox:
    """Two wheels on supports that move in all directions."""
    spring = {"support_stiffness": (1e8, 3e8), "support_damping": (2e4, 1e4)}
    wheels = [
        wheel(teeth=20, pitch_radius=0.1, support_kind=SLIDER, support_mass=2.0, **spring),
        wheel(teeth=33, support_kind=BEARING, support_mass=3.0, **spring),
    ]
    description = mesh(kernel, 0, 1, centre_line_angle=0.5, pressure_angle=0.35)
    description.contact = kernel.law(CONTACT, contact, **CONTACTS[contact])
    description.damping = kernel.law(DAMPING, damping, **DAMPINGS[damping])
    description.friction = kernel.law(FRICTION, friction, **FRICTIONS[friction])
    loads = [load(0, TORQUE, -7.0), load(1, VISCOUS, 5.0)]
    return Gearbox(kernel, wheels, loads, [description])


def internal_pair_with_laws(kernel: Kernel, contact: str, damping: str, friction: str) -> Gearbox:
    """A pinion in a ring, on axes that move in all directions; pairs on both flanks."""
    spring = {"support_stiffness": (1e8, 3e8), "support_damping": (2e4, 1e4)}
    on_bearing = {"support_kind": BEARING, "support_mass": 3.0, "width": 0.02, **spring}
    ring = {"internal": "true", "tip_diameter": 0.29, "rim_diameter": 0.34}
    wheels = [
        wheel(teeth=35, gear=gear_description(3e-3), **on_bearing),
        wheel(teeth=98, gear=gear_description(3e-3, rack_addendum=0.8, **ring), **on_bearing),
    ]
    description = mesh(kernel, 0, 1, centre_line_angle=0.5, backlash=2e-5, real=True)
    description.contact = kernel.law(CONTACT, contact, **CONTACTS[contact])
    description.damping = kernel.law(DAMPING, damping, **DAMPINGS[damping])
    description.friction = kernel.law(FRICTION, friction, **FRICTIONS[friction])
    loads = [load(0, TORQUE, -20.0), load(1, VISCOUS, 5.0)]
    return Gearbox(kernel, wheels, loads, [description])


def loaded_pair(kernel: Kernel, name: str) -> Gearbox:
    """Two fixed wheels with one of SAMPLES, after another load, on the second wheel."""
    wheels = [wheel(teeth=20, pitch_radius=0.1), wheel(teeth=33)]
    loads = [load(1, TORQUE, -0.3), load_like(kernel, 1, SAMPLES[name])]
    return Gearbox(kernel, wheels, loads, [mesh(kernel, 0, 1)])


def real_gears(
    kernel: Kernel, name: str, *, fixed: bool = False, friction: float = 0.1, **keys: Any
) -> Gearbox:
    """Gears with one of DEVIATIONS on moving or fixed axes; pairs on both flanks.

    The keys are those of the mesh, the rounding of the tips of its wheels, and whether the wheels
    have the compliance of finite elements and the gearbox the outputs of the temperatures.
    """
    with_temperatures = keys.pop("with_temperatures", False)
    roundings = keys.pop("tip_roundings", (0.0, 0.0))
    elements = {"bore": 0.02, "compliance": Block({"model": "finite_elements"})}
    held = elements if keys.pop("elements", False) else {}
    support = {"support_kind": BEARING, "support_stiffness": (1e8, 3e8), "support_mass": 3.0}
    if fixed:
        support = {}
    given: list[Block] = [deviations(**fields) for fields in DEVIATIONS[name]]
    wheels = [
        wheel(
            teeth=z,
            width=0.02,
            gear=gear_description(3e-3, tip_rounding=rounding, **held),
            deviation=deviation,
            **support,
        )
        for z, deviation, rounding in zip(TEETH, given, roundings, strict=True)
    ]
    description = mesh(kernel, 0, 1, friction=(friction, 1e-3), backlash=2e-5, **keys)
    description.pop("pressure_angle")
    loads = [load(0, TORQUE, -20.0), load(1, VISCOUS, 5.0)]
    return Gearbox(kernel, wheels, loads, [description], with_temperatures=with_temperatures)


def real_state(gearbox: Gearbox, random: np.random.Generator) -> tuple[State, int]:
    """State of `real_gears` with contact of all pairs on the path, in any zone; their number."""
    state = gearbox.start()
    state.y[gearbox.index("reference_angle")] = draw(random, 0.02)
    state.y[gearbox.index("reference_speed")] = draw(random, 10.0)
    loaded = 0
    for contact in range(gearbox.sizes.n_reals):
        mode = gearbox.mode(state, contact)
        if mode[1] == OFF:
            continue
        mode[1:3] = LOADED, random.integers(-1, 2)
        mode[3:] = random.integers(-1, 2, size=mode.size - 3)
        loaded += 1
    return state, loaded
