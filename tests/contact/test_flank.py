"""Flank: forces of all its contacts, their derivatives, and their coupling."""

from __future__ import annotations

import numpy as np
import pytest

from gearbox.lanes.lane_cases import CONTACTS, DAMPINGS
from gearbox.test_compliant_flanks import bend
from kernel.gearbox import LOADED, OPEN, UNLOADED, Gearbox
from kernel.gearbox_description import TORQUE, VISCOUS, load, mesh, wheel
from kernel.gears import gear_description
from kernel.kernel import CONTACT, DAMPING, OK, OUT_OF_DOMAIN, Floats, Kernel, _at

FLANKS = np.array([LOADED, UNLOADED, LOADED], np.int32)
# h, h', rho_A, rho_B of each contact: deep and shallow, approaching and separating
INPUTS = np.array(
    [[7e-6, 3e-3, 0.004, 0.021], [2e-7, -2e-3, 0.009, 0.016], [3e-5, 8e-4, 0.017, 0.008]]
)
LANES = 8
LAWS = [(c, d) for c in CONTACTS for d in DAMPINGS]
BENDING = [("johnson that bends", d) for d in DAMPINGS]
COUPLED = [("johnson coupled", d) for d in DAMPINGS]
every_law = pytest.mark.parametrize(("contact", "damping"), LAWS + BENDING)
every_flank = pytest.mark.parametrize(("contact", "damping"), LAWS + BENDING + COUPLED)


def pair(kernel: Kernel, contact: str, damping: str) -> Gearbox:
    """Gears of contact ratio 1.6: three contacts on each flank."""
    form = gear_description(3e-3)
    wheels = [wheel(teeth=z, width=0.02, gear=form) for z in (20, 35)]
    description = mesh(kernel, 0, 1, backlash=2e-5)
    description.pop("pressure_angle")
    law, *bends = contact.split(maxsplit=1)
    description.contact = kernel.law(CONTACT, law, **CONTACTS[law])
    description.damping = kernel.law(DAMPING, damping, **DAMPINGS[damping])
    gearbox = Gearbox(
        kernel, wheels, [load(0, TORQUE, -20.0), load(1, VISCOUS, 5.0)], [description]
    )
    assert kernel.library.test_flank_contacts(gearbox.handle) == len(INPUTS)
    return bend(gearbox, bends == ["coupled"]) if bends else gearbox


def laws(
    gearbox: Gearbox, inputs: Floats = INPUTS, flanks: Floats = FLANKS, flank: int = 1
) -> Floats:
    """Elastic and viscous force of each contact, (2, contact); NaN without contact."""
    elastic, viscous = np.full((2, len(inputs)), np.nan)
    arrays = (flanks, np.ascontiguousarray(inputs), elastic, viscous)
    n = len(inputs)
    assert gearbox.library.test_flank_laws(gearbox.handle, flank, n, *map(_at, arrays)) == OK
    return np.array([elastic, viscous])


def changes(gearbox: Gearbox, which: int) -> Floats:
    """Derivatives of both forces of a contact to the variables of all (2, contact, variable)."""
    result = np.full((2, INPUTS.size), np.nan)
    gearbox.library.test_flank_changes(
        gearbox.handle, len(INPUTS), _at(FLANKS), _at(INPUTS), which + 1, *map(_at, result)
    )
    return result.reshape(2, *INPUTS.shape)


@every_flank
def test_changes_of_the_forces_are_differences_of_the_forces(
    kernel: Kernel, contact: str, damping: str
):
    """To the penetration, its rate, rho_A and rho_B separately, for every contact of the flank."""
    gearbox = pair(kernel, contact, damping)
    at = laws(gearbox)
    for which in range(len(INPUTS)):
        found = changes(gearbox, which)
        for other in range(len(INPUTS)):
            for entry in range(4):
                step = 1e-5 * abs(INPUTS[other, entry])
                moved = [INPUTS.copy(), INPUTS.copy()]
                moved[0][other, entry] += step
                moved[1][other, entry] -= step
                above, below = (laws(gearbox, m)[:, which] for m in moved)
                # step**2 from the quotient, eps/step from rounding of the forces
                noise = 1e-10 * np.abs(at[:, which]).max() / abs(INPUTS[other, entry])
                np.testing.assert_allclose(
                    (above - below) / (2 * step), found[:, other, entry], rtol=1e-8, atol=noise
                )


@pytest.mark.parametrize(("contact", "damping"), COUPLED)
def test_every_pair_of_coupled_teeth_knows_all_others(kernel: Kernel, contact: str, damping: str):
    """Loaded neighbours open its gap; at equal depth it has less force than alone."""
    gearbox = pair(kernel, contact, damping)
    inputs = INPUTS.copy()
    inputs[:, 0] = 1e-5
    elastic = laws(gearbox, inputs)[0]
    for which in range(len(INPUTS)):
        flanks = np.full(len(INPUTS), OPEN, np.int32)
        flanks[which] = LOADED
        assert laws(gearbox, inputs, flanks)[0, which] > elastic[which]
        assert changes(gearbox, which)[0, :, [0, 2, 3]].all()


def test_pairs_come_on_coast_flanks_in_the_opposite_order(kernel: Kernel):
    """By the tooth direction there: c_j with j exchanged, as for wheels of a mirror image."""
    gearbox = pair(kernel, "johnson coupled", "flores")
    drive, coast = laws(gearbox), laws(gearbox, INPUTS[::-1], FLANKS[::-1].copy(), 2)
    np.testing.assert_allclose(coast[:, ::-1], drive, rtol=1e-12)
    assert np.abs(laws(gearbox, INPUTS, FLANKS, 2) / drive - 1).max() > 1e-6


@every_law
def test_each_pair_stands_alone(kernel: Kernel, contact: str, damping: str):
    """A pair's forces are bitwise independent of the positions and contact of the others."""
    gearbox = pair(kernel, contact, damping)
    at = laws(gearbox)
    for which in range(len(INPUTS)):
        others = [k for k in range(len(INPUTS)) if k != which]
        inputs, flanks = INPUTS.copy(), FLANKS.copy()
        inputs[others] *= 1.3
        np.testing.assert_array_equal(laws(gearbox, inputs)[:, which], at[:, which])
        flanks[others] = OPEN
        np.testing.assert_array_equal(laws(gearbox, INPUTS, flanks)[:, which], at[:, which])
        assert np.isnan(laws(gearbox, INPUTS, flanks)[:, others]).all()
        assert not changes(gearbox, which)[:, others].any()


@every_flank
def test_eight_states_have_the_forces_of_each(kernel: Kernel, contact: str, damping: str):
    gearbox = pair(kernel, contact, damping)
    random = np.random.default_rng(3)
    inputs = INPUTS * random.uniform(0.5, 2, (LANES, *INPUTS.shape))
    elastic, viscous = np.full((2, LANES, len(INPUTS)), np.nan)
    arrays = (FLANKS, inputs, elastic, viscous)
    answer = kernel.library.test_flank_in_lanes(gearbox.handle, len(INPUTS), *map(_at, arrays))
    assert answer == 1
    alone = np.array([laws(gearbox, entry) for entry in inputs])
    # loops over lanes have their own reciprocals and powers
    np.testing.assert_allclose(elastic, alone[:, 0], rtol=1e-14)
    np.testing.assert_allclose(viscous, alone[:, 1], rtol=1e-14, atol=1e-14)


def test_two_callers_in_turn_have_the_bits_of_each_alone(kernel: Kernel):
    """Scratch memory belongs to the caller: residual and roots of alternating states."""
    gearbox = pair(kernel, "johnson", "flores")
    states = [gearbox.start() for _ in range(2)]
    states[1].y *= 1 + 1e-6
    states[1].y[2:] += 1e-7

    def ask(state: object) -> list[Floats]:
        return [gearbox.residual(state), gearbox.roots(state), gearbox.jacobian(state, 1.0)]

    alone = [ask(state) for state in states]
    for _ in range(3):
        for state, expected in zip(states, alone, strict=True):
            for found, value in zip(ask(state), expected, strict=True):
                np.testing.assert_array_equal(found, value)


def test_a_penetration_past_the_limit_of_a_law_is_refused(kernel: Kernel):
    """Johnson's law ends at h = 4 (rho_A + rho_B)/e**2, where dh/dN is zero."""
    gearbox = pair(kernel, "johnson", "none")
    inputs = INPUTS.copy()
    limit = 4 * (inputs[2, 2] + inputs[2, 3]) / np.e**2
    for h, expected in ((0.999 * limit, OK), (1.001 * limit, OUT_OF_DOMAIN), (0.05, OUT_OF_DOMAIN)):
        inputs[2, 0] = h
        forces = np.full((2, len(INPUTS)), np.nan)
        arrays = (FLANKS, inputs, *forces)
        code = kernel.library.test_flank_laws(gearbox.handle, 1, len(INPUTS), *map(_at, arrays))
        assert code == expected
