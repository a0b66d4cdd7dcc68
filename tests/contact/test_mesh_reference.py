"""A mesh at its nominal load: stiffness, mass, frequency, damping; laws that refer to them."""

from __future__ import annotations

import ctypes
import math

import numpy as np
import pytest
from restitution import FACTORS, factor

from kernel.description import Block
from kernel.gearbox import LOADED, OFF, Gearbox, GearboxError
from kernel.gearbox_description import (
    SPEED,
    TORQUE,
    VISCOUS,
    load,
    mesh,
    shaft,
    wheel,
)
from kernel.gears import gear_description
from kernel.kernel import CONTACT, DAMPING, INVALID_INPUT, Kernel

TORQUE_A = 7.0
WIDTH, E_STAR = 0.02, 2e11 / (2 * (1 - 0.3**2))
BASE = [m * z / 2 * math.cos(math.radians(20)) for m, z in ((3e-3, 20), (3e-3, 35))]
FORCE = TORQUE_A / BASE[0]
RHO = (BASE[0] + BASE[1]) * math.tan(math.radians(20))  # without backlash and profile shift
INERTIA = (3e-4, 2e-3)
STIFFNESS = 2e8
LINEAR = ("linear", {"stiffness": STIFFNESS})
DRIVEN = {"loads": [load(0, TORQUE, -TORQUE_A), load(1, VISCOUS, 0.1)]}


def pair(
    kernel: Kernel,
    damping: tuple[str, dict[str, float]] = ("ratio", {"value": 0.07}),
    contact: tuple[str, dict[str, float]] = LINEAR,
    loads: list | None = None,
    n_more: int = 0,
    shafts: tuple = (),
) -> Gearbox:
    """Gears of 20 and 35 teeth with given inertias, and `n_more` discs of 1e-3 kg m^2."""
    form = gear_description(3e-3)
    wheels = [
        wheel(teeth=z, width=WIDTH, gear=form, inertia=j)
        for z, j in zip((20, 35), INERTIA, strict=True)
    ]
    wheels += [wheel(teeth=0, width=0.1, inertia=1e-3, mass=1.0)] * n_more
    description: Block = mesh(kernel, 0, 1, backlash=0.0)
    description.pop("pressure_angle")
    description.contact = kernel.law(CONTACT, contact[0], **contact[1])
    description.damping = kernel.law(DAMPING, damping[0], **damping[1])
    loads = DRIVEN["loads"] if loads is None else loads
    return Gearbox(kernel, wheels, loads, [description], shafts=shafts)


def mass(inertia_a: float, inertia_b: float) -> float:
    return 1 / (BASE[0] ** 2 / inertia_a + BASE[1] ** 2 / inertia_b)


def johnson() -> tuple[float, float]:
    """Penetration and stiffness under FORCE, by manual calculation from docs/reference/laws.md."""
    line, modulus = FORCE / WIDTH, math.pi * E_STAR
    logarithm = math.log(4 * modulus * RHO / line)
    return line / modulus * (logarithm - 1), WIDTH * modulus / (logarithm - 2)


def damping_of(gearbox: Gearbox) -> list[float]:
    parameters = (ctypes.c_double * 8)()
    gearbox.library.evl_gearbox_damping(gearbox.handle, 0, parameters)
    return list(parameters)


def test_the_reference_is_that_computed_by_hand(kernel: Kernel):
    at = pair(kernel, contact=("johnson", {})).mesh_geometry()
    h_0, stiffness = johnson()
    # rounding of logarithms of 25 and of their differences
    assert at.reference_force == pytest.approx(FORCE, rel=1e-13)
    assert at.reference_penetration == pytest.approx(h_0, rel=1e-12)
    assert at.reference_stiffness == pytest.approx(stiffness, rel=1e-12)
    assert at.reference_mass == pytest.approx(mass(*INERTIA), rel=1e-13)
    frequency = math.sqrt(stiffness / mass(*INERTIA)) / (2 * math.pi)
    assert at.natural_frequency == pytest.approx(frequency, rel=1e-12)
    assert at.damping_ratio == pytest.approx(0.07, rel=1e-14)
    coefficient = 2 * 0.07 * math.sqrt(stiffness * mass(*INERTIA))
    assert at.damping_coefficient == pytest.approx(coefficient, rel=1e-12)


def test_wheels_on_rigid_shafts_count_and_those_on_elastic_shafts_do_not(kernel: Kernel):
    shafts = (shaft(0, 2), shaft(1, 3, stiffness=1e5))
    at = pair(kernel, n_more=2, shafts=shafts).mesh_geometry()
    assert at.reference_mass == pytest.approx(mass(INERTIA[0] + 1e-3, INERTIA[1]), rel=1e-13)
    shafts = (shaft(0, 2, stiffness=1e5), shaft(1, 3))
    at = pair(kernel, n_more=2, shafts=shafts).mesh_geometry()
    assert at.reference_mass == pytest.approx(mass(INERTIA[0], INERTIA[1] + 1e-3), rel=1e-13)


@pytest.mark.parametrize("prescribed", [0, 1])
def test_a_prescribed_speed_is_an_infinite_inertia(kernel: Kernel, prescribed: int):
    other = 1 - prescribed
    torque = TORQUE_A * BASE[other] / BASE[0]
    loads = [load(prescribed, SPEED, 3.0), load(other, TORQUE, torque)]
    at = pair(kernel, loads=loads).mesh_geometry()
    assert at.reference_mass == pytest.approx(INERTIA[other] / BASE[other] ** 2, rel=1e-13)
    assert at.damping_ratio == pytest.approx(0.07, rel=1e-14)


def test_a_prescribed_speed_stands_for_its_whole_rotor(kernel: Kernel):
    loads = [load(2, SPEED, 3.0), load(1, TORQUE, 5.0)]
    at = pair(kernel, loads=loads, n_more=1, shafts=(shaft(0, 2),)).mesh_geometry()
    assert at.reference_mass == pytest.approx(INERTIA[1] / BASE[1] ** 2, rel=1e-13)


E = 0.8
COEFFICIENT = {
    "none": ({}, lambda _: 0.0),
    "linear": ({"coefficient": 300.0}, lambda _: 300.0),
    # c h on approach, nothing on separation: a small vibration loses half of the work of c h h'
    "one_sided": ({"coefficient": 1e9}, lambda h_0: 1e9 * h_0 / 2),
    **{
        name: (
            {"restitution": E, "v0_min": 0.02},
            lambda _, name=name: FORCE * float(factor(name, E)) / 0.02,
        )
        for name in FACTORS
    },
    "ratio": ({"value": 0.07}, lambda _: 2 * 0.07 * math.sqrt(STIFFNESS * mass(*INERTIA))),
}


def test_every_damping_law_of_the_program_has_its_coefficient(kernel: Kernel):
    assert set(COEFFICIENT) == {law.name for law in kernel.laws(DAMPING)}


@pytest.mark.parametrize("law", COEFFICIENT)
def test_the_damping_ratio_is_that_of_the_linearised_law(kernel: Kernel, law: str):
    parameters, coefficient = COEFFICIENT[law]
    at = pair(kernel, (law, parameters)).mesh_geometry()
    c = coefficient(FORCE / STIFFNESS)
    assert at.damping_coefficient == pytest.approx(c, rel=1e-12)
    assert at.damping_ratio == pytest.approx(
        c / (2 * math.sqrt(STIFFNESS * mass(*INERTIA))), rel=1e-12
    )


@pytest.mark.parametrize("contact", [LINEAR, ("johnson", {})], ids=["linear", "johnson"])
def test_ratio_is_the_linear_law_with_its_coefficient(kernel: Kernel, contact: tuple):
    """Bit by bit, with pairs in contact on both flanks."""
    by_ratio = pair(kernel, contact=contact)
    coefficient = by_ratio.mesh_geometry().damping_coefficient
    by_coefficient = pair(kernel, ("linear", {"coefficient": coefficient}), contact)
    for sign in (1, -1):
        state = by_ratio.start()
        psi = by_ratio.index("angle_deviation_1")
        state.y[psi] += sign * 1e-7 / BASE[1]
        state.y[psi + 1] += 1e-3
        for contact in range(by_ratio.sizes.n_reals):
            mode = by_ratio.mode(state, contact)
            mode[1] = OFF if mode[1] == OFF else LOADED  # all pairs on the path carry load
        np.testing.assert_array_equal(by_ratio.derivative(state), by_coefficient.derivative(state))
        at_rest = state.copy()
        at_rest.y[psi + 1] -= 1e-3
        assert np.any(by_ratio.derivative(state) != by_ratio.derivative(at_rest))


@pytest.mark.parametrize("law", FACTORS)
def test_v0_min_is_the_speed_amplitude_of_the_mesh_mode_at_h_0(kernel: Kernel, law: str):
    left_open = pair(kernel, (law, {"restitution": E}))
    at = left_open.mesh_geometry()
    expected = at.reference_penetration * 2 * math.pi * at.natural_frequency
    parameters = damping_of(left_open)
    assert parameters[:2] == pytest.approx([E, expected], rel=1e-14)
    given = pair(kernel, (law, {"restitution": E, "v0_min": parameters[1]}))
    state = given.start()
    state.y[given.index("angle_deviation_1") + 1] += 1e-3
    np.testing.assert_array_equal(given.derivative(state), left_open.derivative(state))
    # c = chi F/v0 and F = k h_0
    assert at.damping_ratio == pytest.approx(float(factor(law, E)) / 2, rel=1e-12)


def test_a_given_v0_min_stays(kernel: Kernel):
    parameters = damping_of(pair(kernel, ("flores", {"restitution": E, "v0_min": 3e-4})))
    assert parameters[1] == pytest.approx(3e-4, rel=0)


REFERRING = [("ratio", {"value": 0.07}), *((name, {"restitution": E}) for name in FACTORS)]
NO_REFERENCE = {
    "no load": ([], "no load"),
    "a speed alone": ([load(0, SPEED, 3.0)], "no load"),
    "both speeds": ([load(0, SPEED, 3.0), load(1, SPEED, -1.0), load(1, TORQUE, 1.0)], "both"),
}


@pytest.mark.parametrize("loads", NO_REFERENCE)
@pytest.mark.parametrize("law", REFERRING, ids=[name for name, _ in REFERRING])
def test_a_law_that_refers_to_what_the_mesh_has_not_is_refused(
    kernel: Kernel, law: tuple, loads: str
):
    """Without a load at the start: `static` and `modes` accept a given one."""
    given, reason = NO_REFERENCE[loads]
    with pytest.raises(GearboxError) as error:
        pair(kernel, law, loads=given).start()
    assert error.value.code == INVALID_INPUT
    assert error.value.field.split(".")[0] == "damping"
    assert reason in error.value.message
    remedy = "{law: linear, coefficient: ...}" if law[0] == "ratio" else "give v0_min"
    assert remedy in error.value.message


def test_a_law_that_is_complete_needs_no_load(kernel: Kernel):
    for law in (("linear", {"coefficient": 3.0}), ("lee_wang", {"restitution": E, "v0_min": 1.0})):
        at = pair(kernel, law, loads=[]).mesh_geometry()
        assert np.isnan([at.reference_stiffness, at.natural_frequency, at.damping_ratio]).all()


@pytest.mark.parametrize(("contact", "damping"), [("rigid", "ratio"), ("rigid", "flores")])
def test_a_rigid_contact_has_no_damping_that_could_refer_to_it(
    kernel: Kernel, contact: str, damping: str
):
    parameters = dict(REFERRING)[damping]
    with pytest.raises(GearboxError, match="rigid contact has no penetration"):
        pair(kernel, (damping, parameters), (contact, {}))


def test_a_law_that_refers_to_its_mesh_has_no_force_without_one(kernel: Kernel):
    arguments = {"rho_a": RHO / 2, "rho_b": RHO / 2, "e_star": E_STAR, "width": WIDTH}
    elastic = kernel.law(CONTACT, "johnson")
    for name, parameters in REFERRING:
        damping = kernel.law(DAMPING, name, **parameters)
        with pytest.raises(AssertionError):
            kernel.law_viscous_force(elastic, damping, h=1e-6, h_dot=1e-3, **arguments)


def test_much_damping_is_warned_of_once_and_little_is_not(kernel: Kernel):
    def warnings(value: float) -> list[str]:
        return [warned.message for warned in pair(kernel, ("ratio", {"value": value})).warnings()]

    assert warnings(0.3) == []
    (line,) = warnings(0.31)
    assert "damping ratio at the nominal load is 0.31" in line
    assert "0.03 to 0.17" in line
