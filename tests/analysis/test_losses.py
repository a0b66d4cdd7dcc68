"""Power losses: their sum is the rate of the dissipated energy.

Every output in watts is a loss, so that a new damper without an output fails here.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest

from analysis.test_wanted_outputs import CASES, Case
from gearbox.lanes.lane_cases import real_gears
from gearbox.test_compliant_flanks import bend, loaded_state
from gearbox.test_gearbox_jacobian import put
from gearbox.test_law_jacobian import CONTACTS, DAMPINGS, FRICTIONS, OF_OPERATING_POINT
from gearbox.test_loads import stirred, train
from kernel.gearbox import LOADED, UNLOADED, Gearbox, State
from kernel.gearbox_description import (
    BEARING,
    CLOSED_FORM,
    DIFFERENTIAL,
    SLIDER,
    TORQUE,
    VISCOUS,
    load,
    mesh,
    wheel,
)
from kernel.housing_cases import HOUSINGS
from kernel.kernel import CONTACT, DAMPING, FRICTION, Floats, Kernel
from load_samples import SUPPORTS

SEED = 5
LAWS = [
    *((contact, "linear", "coulomb") for contact in CONTACTS),
    *(("johnson", damping, "coulomb") for damping in (*DAMPINGS, "none")),
    *(("johnson", "linear", friction) for friction in (*FRICTIONS, *OF_OPERATING_POINT, "none")),
]
COULOMB = {"coefficient": 0.2, "regularisation_velocity": 2e-3}


def powers(gearbox: Gearbox, state: State) -> dict[str, Floats]:
    """Outputs in watts."""
    values = gearbox.outputs(state)
    names = {entry.name.decode() for entry in gearbox.table if entry.units == b"W"}
    return {name: values[name] for name in names if name in values}


def check_balance(gearbox: Gearbox, state: State) -> dict[str, float]:
    """Check the sum of the losses; return each."""
    losses = {name: float(np.sum(power)) for name, power in powers(gearbox, state).items()}
    rate = gearbox.derivative(state)[gearbox.index("dissipated_energy")]
    size = sum(abs(power) for power in losses.values())
    # sums of a dozen products; friction and damping of pairs may cancel in each
    assert abs(rate - sum(losses.values())) <= 1e-13 * size, losses
    return losses


def pair_with(kernel: Kernel, tracking: str, laws: tuple[str, str, str]) -> Gearbox:
    """On supports that move in all directions, so that the radii of curvature vary as well."""
    spring = {"support_stiffness": (1e8, 3e8), "support_damping": (2e4, 1e4)}
    wheels = [
        wheel(teeth=20, pitch_radius=0.1, support_kind=SLIDER, support_mass=2.0, **spring),
        wheel(teeth=33, support_kind=BEARING, support_mass=3.0, **spring),
    ]
    contact, damping, friction = laws
    pair = mesh(kernel, 0, 1, centre_line_angle=0.5, pressure_angle=0.35, tracking=tracking)
    pair.contact = kernel.law(CONTACT, contact, **CONTACTS[contact])
    pair.damping = kernel.law(DAMPING, damping, **DAMPINGS.get(damping, {}))
    parameters: dict[str, float] = {"coulomb": COULOMB, "none": {}, **FRICTIONS}.get(friction, {})
    if friction in OF_OPERATING_POINT:
        parameters = {"lubricant_factor": 1.0, "regularisation_velocity": 2e-3}
    pair.friction = kernel.law(FRICTION, friction, **parameters)
    return Gearbox(kernel, wheels, [load(0, TORQUE, -7.0), load(1, VISCOUS, 5.0)], [pair])


def test_every_law_is_asked(kernel: Kernel):
    for index, family in enumerate((CONTACT, DAMPING, FRICTION)):
        names = {law.name for law in kernel.laws(family)} - {"rigid"}  # those in CASES
        assert names == {laws[index] for laws in LAWS}


@pytest.mark.parametrize("mode", [LOADED, UNLOADED], ids=["loaded", "unloaded"])
@pytest.mark.parametrize("tracking", [CLOSED_FORM, DIFFERENTIAL])
@pytest.mark.parametrize("laws", LAWS, ids="-".join)
def test_with_every_law_the_losses_are_the_rate_of_the_dissipated_energy(
    kernel: Kernel, tracking: str, laws: tuple[str, str, str], mode: int
):
    gearbox = pair_with(kernel, tracking, laws)
    losses = check_balance(gearbox, put(gearbox, np.random.default_rng(SEED), (mode, 0)))
    if mode == LOADED:
        assert (losses["contact_damping_loss"] > 0) == (laws[1] != "none")
        assert (losses["friction_loss"] > 0) == (laws[2] != "none")
    else:
        assert losses["friction_loss"] == 0
        assert losses["contact_damping_loss"] != 0  # all of the elastic force


@pytest.mark.parametrize("name", SUPPORTS)
@pytest.mark.parametrize("body", [None, *HOUSINGS])
def test_with_every_support_in_every_housing_they_are(kernel: Kernel, name: str, body: str | None):
    housing = None if body is None else HOUSINGS[body]
    gearbox = train(kernel, "torque", housing, SUPPORTS[name])
    still = train(kernel, "torque", None, SUPPORTS[name])
    state, moving = gearbox.start(), stirred(still)
    for key, value in zip(still.names, moving.y, strict=True):
        state.y[gearbox.index(key)] = value
    state.integers[:] = moving.integers
    losses = check_balance(gearbox, state)
    assert (losses["support_damping_loss"] > 0) == (name != "fixed")
    assert losses["shaft_damping_loss"] > 0
    assert ("mount_damping_loss" in losses) == (body == "mounted")
    assert losses.get("mount_damping_loss", 1.0) > 0


@pytest.mark.parametrize("make", CASES.values(), ids=CASES)
def test_in_every_case_of_outputs_they_are(kernel: Kernel, make: Callable[[Kernel], Case]):
    gearbox, state = make(kernel)
    losses = check_balance(gearbox, state)
    # only the contacts of that case are held although they pull, and then rub along the sliding
    pulls = (gearbox.outputs(state)["pair_normal_force"] < 0).any()
    assert not pulls or make is CASES["temperatures"]
    for name, power in losses.items():
        assert power >= 0 or name == "curvature_loss" or pulls


@pytest.mark.parametrize("couples", [False, True], ids=["pairs alone", "coupled pairs"])
def test_with_teeth_that_bend_they_are(kernel: Kernel, couples: bool):
    gearbox = real_gears(kernel, "all of them")
    bend(gearbox, couples)
    losses = check_balance(gearbox, loaded_state(gearbox, np.random.default_rng(SEED)))
    assert losses["contact_damping_loss"] != 0
    assert losses["curvature_loss"] == 0  # their potential is exact


def test_the_dampers_of_a_pair_take_their_force_times_the_rate_of_penetration(kernel: Kernel):
    gearbox = pair_with(kernel, CLOSED_FORM, ("johnson", "linear", "none"))
    state = put(gearbox, np.random.default_rng(SEED), (LOADED, 0))
    values = gearbox.outputs(state)
    expected = DAMPINGS["linear"]["coefficient"] * values["gap_rate"] ** 2
    np.testing.assert_allclose(values["contact_damping_loss"], expected, rtol=1e-14)


def test_the_dampers_of_supports_and_shafts_take_coefficient_times_rate_squared(kernel: Kernel):
    gearbox = train(kernel, "torque")
    state = stirred(gearbox)
    values = gearbox.outputs(state)
    of_axle = np.array(SUPPORTS["bearing"]["damping"]) @ values["centre_velocity"][1] ** 2
    np.testing.assert_allclose(values["support_damping_loss"], [0, of_axle, 0], rtol=1e-14)
    speeds = values["angular_velocity"]
    of_shaft = 5.0 * (speeds[1] - speeds[2]) ** 2
    np.testing.assert_allclose(values["shaft_damping_loss"], [of_shaft], rtol=1e-9)  # a difference
