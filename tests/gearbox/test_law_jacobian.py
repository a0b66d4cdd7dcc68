"""Analytic Jacobian of a gearbox with every force law, against differences of the residual."""

from __future__ import annotations

import numpy as np
import pytest

from gearbox.test_gearbox_jacobian import TRACKINGS, put
from kernel.gearbox import LOADED, UNLOADED, Gearbox
from kernel.gearbox_description import BEARING, SLIDER, TORQUE, VISCOUS, load, mesh, wheel
from kernel.jacobian import check_jacobian
from kernel.kernel import CONTACT, DAMPING, FRICTION, Kernel

CONTACTS = {
    "johnson": {},
    "radzimovsky": {},
    "linear": {"stiffness": 1e8},
    "yang_lin": {},
    "power": {"coefficient": 1e12, "exponent": 1.5},
}
RESTITUTION = {"restitution": 0.5, "v0_min": 1e-2}
DAMPINGS = {
    "linear": {"coefficient": 3e3},
    "one_sided": {"coefficient": 1e10},
    **dict.fromkeys(
        ("hunt_crossley", "lankarani_nikravesh", "flores", "gonthier", "lee_wang"), RESTITUTION
    ),
    "ratio": {"value": 0.07},
}
FRICTIONS = {
    "tanh": {"coefficient": 0.2, "regularisation_velocity": 2e-3},
    "stribeck": {
        "static_coefficient": 0.3,
        "kinetic_coefficient": 0.1,
        "stribeck_velocity": 0.02,
        "regularisation_velocity": 2e-3,
    },
    "benedict_kelley": {"regularisation_velocity": 2e-3},
    "xu_kahraman": {"regularisation_velocity": 2e-3},
}
LOCAL = ("benedict_kelley", "xu_kahraman")
OF_OPERATING_POINT = ("schlenk", "mean_roughness")  # they act as Coulomb's law
CASES = [
    *((contact, "flores", "tanh") for contact in CONTACTS),
    *(("johnson", damping, "stribeck") for damping in DAMPINGS),
    *((contact, "linear", friction) for contact in ("johnson", "linear") for friction in LOCAL),
]


def test_every_smooth_law_of_the_program_has_its_case(kernel: Kernel):
    names = [{law.name for law in kernel.laws(family)} for family in range(3)]
    # a rigid contact has no force law; Coulomb's law has branches and its own test
    assert names[CONTACT] == {*CONTACTS, "rigid"}
    assert names[DAMPING] == {*DAMPINGS, "none"}
    assert names[FRICTION] == {*FRICTIONS, *OF_OPERATING_POINT, "none", "coulomb"}


@pytest.mark.parametrize("mode", [LOADED, UNLOADED], ids=["loaded", "unloaded"])
@pytest.mark.parametrize(("contact", "damping", "friction"), CASES)
@TRACKINGS
def test_jacobian_with_every_law_is_the_derivative_of_the_residual(
    kernel: Kernel, tracking: str, contact: str, damping: str, friction: str, mode: int
):
    """On supports that move in all directions, so that the radii of curvature vary as well."""
    spring = {"support_stiffness": (1e8, 3e8), "support_damping": (2e4, 1e4)}
    wheels = [
        wheel(teeth=20, pitch_radius=0.1, support_kind=SLIDER, support_mass=2.0, **spring),
        wheel(teeth=33, support_kind=BEARING, support_mass=3.0, **spring),
    ]
    pair = mesh(kernel, 0, 1, centre_line_angle=0.5, pressure_angle=0.35, tracking=tracking)
    pair.contact = kernel.law(CONTACT, contact, **CONTACTS[contact])
    pair.damping = kernel.law(DAMPING, damping, **DAMPINGS[damping])
    pair.friction = kernel.law(FRICTION, friction, **FRICTIONS[friction])
    gearbox = Gearbox(kernel, wheels, [load(0, TORQUE, -7.0), load(1, VISCOUS, 5.0)], [pair])
    # far away this coefficient is at a limit, where differences are 0 to the bit
    largest = 1e-2 if friction == "benedict_kelley" else 1e4
    check_jacobian(gearbox, put(gearbox, np.random.default_rng(11), (mode, 0)), largest)
