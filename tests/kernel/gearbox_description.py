"""Descriptions of gearboxes with the keys of the case file, with defaults for the tests.

`wheel`, `load`, `mesh` and `initial` fill in all fields that a test does not set. Values are in SI
units and radians; wheels are numbered until `case_of` names them.
"""

from __future__ import annotations

import ctypes
from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from kernel.description import Block, kinds
from kernel.interface import fields
from kernel.kernel import FAMILIES, Kernel, LawChoice, _double

FIXED, SLIDER, BEARING = "fixed", "slider", "bearing"
TORQUE, VISCOUS, TABLE, SPEED = "torque", "viscous", "table", "speed"
CLOSED_FORM, ALGEBRAIC, DIFFERENTIAL = "closed_form", "algebraic", "differential"
EQUILIBRIUM, REST, STEADY, SPEEDS = range(-1, 3)
ROTATIONS: dict[int | str, str] = {-1: "clockwise", 1: "counterclockwise"}


class InitialDescription(ctypes.Structure):
    """`evl_initial`."""

    _fields_ = fields("evl_initial")


def _given(fields: dict[str, Any]) -> Block:
    return Block({key: value for key, value in fields.items() if value is not None})


def wheel(**fields: Any) -> Block:
    """Steel wheel on a fixed axle; None for quantities that follow from the mesh.

    The keys of the blocks `gear` and `deviation`, and of a material, become those of the wheel.
    """
    defaults = {"teeth": 20, "width": 0.1}
    steel = {"youngs_modulus": 2e11, "poisson_ratio": 0.3, "density": 7800.0}
    steel |= {"thermal_conductivity": 45.0, "specific_heat": 460.0}
    material = Block({key: fields.pop(key, value) for key, value in steel.items()})
    of_support = {key: fields.pop(key) for key in list(fields) if key.startswith("support_")}
    result = _given({**defaults, "material": material, "support": support(**of_support), **fields})
    for key in ("gear", "deviation"):
        result.update(result.pop(key, {}))
    if result.teeth == 0:
        del result["teeth"]
        if "pitch_radius" in result:
            result.radius = result.pop("pitch_radius")
    return result


def support(
    support_kind: str = FIXED,
    support_direction: float = 0.0,
    support_mass: float = 0.0,
    support_stiffness: tuple[float, float] = (0.0, 0.0),
    support_damping: tuple[float, float] = (0.0, 0.0),
) -> Block:
    """Support of any kind; a slider uses the first value of each pair."""
    if support_kind == SLIDER:
        return Block(
            kind=SLIDER,
            direction=support_direction,
            mass=support_mass,
            stiffness=support_stiffness[0],
            damping=support_damping[0],
        )
    if support_kind == BEARING:
        return Block(
            kind=BEARING, mass=support_mass, stiffness=support_stiffness, damping=support_damping
        )
    return Block(kind=support_kind)


def load(
    wheel: int,
    kind: str,
    value: float = 0.0,
    table: ArrayLike | None = None,
    *,
    against_housing: bool = False,
) -> Block:
    """Load of a wheel; table: (time, value) pairs."""
    knots = np.array(() if table is None else table, dtype=float).reshape(-1, 2)
    keys = {TABLE: "torque", SPEED: "speed"}
    if kind == TABLE or (kind == SPEED and table is not None):
        numbers = {"time": knots[:, 0], keys[kind]: knots[:, 1]}
    else:
        numbers = {"coefficient" if kind == VISCOUS else "value": value}
    return load_of(wheel, kind, against_housing=against_housing, **numbers)


def load_of(wheel: int, kind: str, *, against_housing: bool = False, **keys: Any) -> Block:
    """Load of a wheel by the keys of its kind."""
    against = "housing" if against_housing else "ground"
    return Block({"wheel": wheel, "kind": kind, "against": against, **keys})


def load_like(
    kernel: Kernel, wheel: int, sample: dict[str, Any], *, against_housing: bool = False
) -> Block:
    """Load of a wheel as in the case file, angles in degrees."""
    return load_of(wheel, against_housing=against_housing, **_in_radians(kernel, "load", sample))


def support_like(kernel: Kernel, sample: dict[str, Any]) -> Block:
    """Support as in the case file, angles in degrees."""
    return Block(_in_radians(kernel, "support", sample))


def _in_radians(kernel: Kernel, block: str, sample: dict[str, Any]) -> dict[str, Any]:
    (kind,) = [kind for kind in kinds(kernel.library, block) if kind.name == sample["kind"]]
    angles = {row.key for row in kind.rows if row.unit == "deg"}
    return {key: np.radians(value) if key in angles else value for key, value in sample.items()}


def shaft(
    wheel_a: int, wheel_b: int, stiffness: float | None = None, damping: float = 0.0
) -> Block:
    """Shaft between two wheels; rigid without a stiffness."""
    wheels = (wheel_a, wheel_b)
    if stiffness is None:
        return Block(kind="rigid", wheels=wheels)
    return Block(kind="elastic", wheels=wheels, stiffness=stiffness, damping=damping)


def law_block(kernel: Kernel, family: int, choice: LawChoice | Block) -> Block:
    """Law as a block of a mesh."""
    if isinstance(choice, dict):
        return choice
    law = kernel.laws(family)[choice.law]
    given = {
        row.key: value
        for row, value in zip(law.rows, choice.parameters, strict=False)
        if row.required or row.default_text or not np.isnan(value)
    }
    return Block(law=law.name, **given)


def mesh(
    _kernel: Kernel,
    driving: int = 0,
    driven: int = 1,
    *,
    damping: float | tuple[str, float] | LawChoice | Block | None = 1e4,
    friction: float | tuple[float, float] | LawChoice | Block = 0.0,
    pressure_angle: float | None = None,
    driving_rotation: int | str = -1,
    real: bool = False,
    **fields: Any,
) -> Block:
    """Mesh with Johnson's law; friction: coefficient, or coefficient and regularisation velocity.

    `damping` is the coefficient of the linear law, or the name of another law with its coefficient,
    or None for no damping. Without a pressure angle the paper's rule determines it, except for
    gears defined by a basic rack.
    """
    if not isinstance(damping, (dict, LawChoice)):
        name, coefficient = damping if isinstance(damping, tuple) else ("linear", damping)
        damping = Block(law="none") if damping is None else Block(law=name, coefficient=coefficient)
    if not isinstance(friction, (dict, LawChoice)):
        f, delta = friction if isinstance(friction, tuple) else (friction, 1e-4)
        friction = Block(law="coulomb", coefficient=f, regularisation_velocity=delta)
    return _given(
        {
            **{"driving": driving, "driven": driven},
            "driving_rotation": ROTATIONS.get(driving_rotation, driving_rotation),
            "centre_line_angle": 0.0,
            "pressure_angle": None if real else pressure_angle or "paper_rule",
            "tracking": CLOSED_FORM,
            "contact": Block(law="johnson"),
            # for laws that need it, and temperatures
            "lubricant": Block(viscosity=0.02, roughness=5e-7, bulk_temperature=363.15),
            **fields,
            "damping": damping,
            "friction": friction,
        }
    )


def case_of(
    kernel: Kernel,
    wheels: Sequence[Block],
    loads: Sequence[Block],
    meshes: Sequence[Block],
    housing: Block | None = None,
    shafts: Sequence[Block] = (),
) -> tuple[Block, list[int]]:
    """Assemble a case.

    Returns it, and the index of each load of the case (wheel by wheel) in the given order.
    """
    order = [k for i in range(len(wheels)) for k, one in enumerate(loads) if one.wheel == i]
    root = {
        "materials": {f"m{i}": given.material for i, given in enumerate(wheels)},
        "wheels": [
            {
                **given,
                "name": f"w{i}",
                "material": f"m{i}",
                "loads": [
                    {key: value for key, value in one.items() if key != "wheel"}
                    for one in loads
                    if one.wheel == i
                ],
            }
            for i, given in enumerate(wheels)
        ],
        "meshes": [
            {
                **given,
                "driving": f"w{given.driving}",
                "driven": f"w{given.driven}",
                **{key: law_block(kernel, i, given[key]) for i, key in enumerate(FAMILIES)},
            }
            for given in meshes
        ],
        "shafts": [
            {**given, "name": f"s{i}", "wheels": [f"w{k}" for k in given.wheels]}
            for i, given in enumerate(shafts)
        ],
    }
    of_housing = dict(housing or {})
    if "gravity" in of_housing:
        root["gravity"] = of_housing.pop("gravity")
    if of_housing:
        root["housing"] = of_housing
    return Block(root), order


def initial(
    kind: int = REST, speeds: ArrayLike | None = None, gaps: ArrayLike | None = None
) -> InitialDescription:
    """Start of a run."""
    description = InitialDescription(kind=kind)
    for name, given in (("speeds", speeds), ("gaps", gaps)):
        if given is not None:
            values = np.atleast_1d(np.asarray(given, dtype=float))
            setattr(description, name, (_double * len(values))(*values))
    return description
