"""Gears defined by a basic rack: teeth on the path and their forces, in absolute coordinates."""

from __future__ import annotations

import mpmath as mp
import numpy as np
import pytest

from kernel.gearbox import APART, COAST, DRIVE, LOADED, OFF, UNLOADED, Gearbox, State
from kernel.gearbox_description import ALGEBRAIC, DIFFERENTIAL, SPEEDS, TORQUE, load
from kernel.jacobian import check_jacobian
from kernel.kernel import CONTACT, Floats, Kernel
from kernel.real_cases import DAMPING, FRICTION, GAPS, PAIRS, made
from kernel.real_pairs import RealPair, Teeth

EVERY_PAIR = pytest.mark.parametrize("pair", PAIRS.values(), ids=PAIRS.keys())
EVERY_GAP = pytest.mark.parametrize("gap", GAPS.values(), ids=GAPS.keys())
PERFECT = pytest.mark.parametrize(
    "pair",
    [pair for pair in PAIRS.values() if not pair.deviates],
    ids=[name for name, pair in PAIRS.items() if not pair.deviates],
)


def pair_values(gearbox: Gearbox, outputs: dict[str, Floats], name: str, flank: int) -> Floats:
    """Values of an output of the tooth pairs of a flank, by slot."""
    drive = gearbox.sizes.n_drive_slots
    return outputs[name][0][:drive] if flank == DRIVE else outputs[name][0][drive:]


@EVERY_PAIR
@EVERY_GAP
@pytest.mark.parametrize("seed", range(2))
def test_the_pairs_on_the_path_are_the_teeth_that_stand_there(
    kernel: Kernel, pair: RealPair, gap: float, seed: int
):
    """Both flanks: number of every tooth, its position on the path, the gap of the nearest pair."""
    gearbox, teeth = made(kernel, pair, gap, seed)
    o = gearbox.outputs(teeth.state)
    for flank in (DRIVE, COAST):
        contacts = [c for c in teeth.contacts if c.flank == flank]
        assert int(pair.contact_ratio) <= len(contacts) <= int(np.ceil(pair.contact_ratio))
        on_path = pair_values(gearbox, o, "pair_on_path", flank) == 1
        columns = [
            pair_values(gearbox, o, f"pair_{n}", flank)[on_path]
            for n in ("number", "tooth_driving", "tooth_driven")
        ]
        assert set(zip(*columns, strict=True)) == {(c.number, *c.teeth) for c in contacts}
        positions = pair_values(gearbox, o, "pair_position", flank)
        assert np.isnan(positions[~on_path]).all()
        for contact in contacts:
            # rounding of the angle of some revolutions
            found = positions[contact.number % pair.slots]
            assert found == pytest.approx(float(contact.rho[0]), abs=1e-15 + 2e-16 * 30)
        if contacts:
            name = "gap" if flank == DRIVE else "coast_gap"
            nearest = float(min(c.gap for c in contacts))
            assert o[name][0] == pytest.approx(nearest, rel=1e-9, abs=1e-17)


@EVERY_PAIR
@EVERY_GAP
@pytest.mark.parametrize("seed", range(2))
def test_forces_of_every_pair_follow_the_gradient_of_its_gap(
    kernel: Kernel, pair: RealPair, gap: float, seed: int
):
    gearbox, teeth = made(kernel, pair, gap, seed)
    o = gearbox.outputs(teeth.state)
    loaded = [c for c in teeth.contacts if c.gap < 0]
    forces = [teeth.force(c, DAMPING, FRICTION) for c in loaded]
    assert o["pairs_in_contact"][0] == len(loaded)
    largest = max([1.0] + [abs(float(f.normal)) for f in forces])
    for contact, force in zip(loaded, forces, strict=True):
        for name, value in (("normal", force.normal), ("friction", force.friction)):
            values = pair_values(gearbox, o, f"pair_{name}_force", contact.flank)
            found = values[contact.number % pair.slots]
            assert found == pytest.approx(float(value), rel=1e-9, abs=1e-10 * largest)
    for i, name in enumerate(("driving", "driven")):
        expected = float(sum(f.torques[i] for f in forces))
        arm = float(pair.base_radii[i])
        found = o[f"mesh_torque_{name}"][0]
        assert found == pytest.approx(expected, rel=1e-9, abs=1e-10 * largest * arm)
    assert o["normal_force"][0] == pytest.approx(float(sum(f.normal for f in forces)), rel=1e-9)
    assert o["friction_loss"][0] == pytest.approx(float(sum(f.loss for f in forces)), rel=1e-8)
    if forces:
        power = abs(o["mesh_torque_driving"][0] * o["angular_velocity"][0])
        assert o["efficiency"][0] == pytest.approx(1 - o["friction_loss"][0] / power, abs=1e-14)
    for contact, force in zip(loaded, forces, strict=True):
        if pair.deviates:
            continue  # test_contact_curvature.py covers the curvature of flanks with deviations
        curvature = sum(1 / float(r) for r in contact.rho)
        geometry = gearbox.mesh_geometry()
        pressure = np.sqrt(
            float(force.normal)
            / geometry.common_width
            * geometry.effective_modulus
            * curvature
            / np.pi
        )
        values = pair_values(gearbox, o, "pair_contact_pressure", contact.flank)
        assert values[contact.number % pair.slots] == pytest.approx(pressure, rel=1e-9)
    # forces on the axes, from the accelerations of the bearings
    rates = gearbox.derivative(teeth.state)
    on_a = sum((f.on_a for f in forces), np.zeros(2))
    masses = o["mass"] + 5.0
    for i in (0, 1):
        for j, (x, k, c) in enumerate((("x", 1e9, 1e5), ("y", 7e8, 8e4))):
            s = float(teeth.q[2 + 2 * i + j])
            v = float(teeth.rates[2 + 2 * i + j])
            acceleration = rates[gearbox.index(f"displacement_{x}_rate_{i}")]
            expected = (1 - 2 * i) * float(on_a[j])
            found = masses[i] * acceleration + k * s + c * v
            assert found == pytest.approx(expected, abs=1e-9 * (largest + abs(k * s)))
    lost = sum(float(f.dissipation) for f in forces)
    for i in (0, 1):
        lost += 1e5 * float(teeth.rates[2 + 2 * i]) ** 2 + 8e4 * float(teeth.rates[3 + 2 * i]) ** 2
    if pair.deviates or not pair.fixed:
        lost -= radius_power(kernel, gearbox, teeth)
    assert rates[-2] == pytest.approx(lost, rel=1e-7, abs=1e-9 * largest)


def radius_power(kernel: Kernel, gearbox: Gearbox, teeth: Teeth) -> float:
    """Power by the change of energies with the radii of curvature, besides the penetrations."""
    power = 0.0
    law = kernel.law(CONTACT, "johnson")
    geometry = gearbox.mesh_geometry()
    for contact in teeth.contacts:
        h = float(-contact.gap)
        if h <= 0:
            continue
        gradient = teeth.gradient(contact)
        h_dot = -float(mp.fdot(gradient, teeth.rates))
        step = mp.mpf(10) ** -12
        q = [x + step * v for x, v in zip(teeth.q, teeth.rates, strict=True)]
        side = teeth.side(contact.flank)
        later = sum(teeth.radius(q, i, side, contact.teeth[i]) for i in (0, 1))
        rho = float(sum(contact.rho))
        excess = float((later - sum(contact.rho)) / step) - h_dot
        change = 1e-7 * rho
        arguments = {"h": h, "e_star": geometry.effective_modulus, "width": geometry.common_width}
        values = [
            kernel.law_elastic_potential(
                law, rho_a=rho, rho_b=sign * change, **arguments
            ).potential[0]
            for sign in (1, -1)
        ]
        power += (values[0] - values[1]) / (2 * change) * excess
    return power


@PERFECT
@EVERY_GAP
@pytest.mark.parametrize("seed", range(4))
def test_both_gaps_add_up_to_the_backlash_at_the_present_centre_distance(
    kernel: Kernel, pair: RealPair, gap: float, seed: int
):
    """kappa_drive + kappa_coast = j_bn + 2 R (inv alpha - inv alpha_0), with displaced axes."""
    gearbox, teeth = made(kernel, pair, gap, seed)
    o = gearbox.outputs(teeth.state)
    _, alpha, _ = teeth.line(teeth.q)
    involute = mp.tan(alpha) - alpha - mp.tan(pair.alpha_0) + pair.alpha_0
    expected = pair.backlash + float(2 * sum(pair.base_radii) * involute)
    # the backlash computed by the kernel has the rounding of a pitch; the rest is 1e-14 of it
    start = gearbox.start(SPEEDS, speeds=(0.0, 3.0 * pair.reference))
    derived = gearbox.outputs(start)["coast_gap"][0]
    assert derived == pytest.approx(pair.backlash, abs=1e-16)
    found = o["gap"][0] + o["coast_gap"][0] - derived
    assert found == pytest.approx(expected - pair.backlash, abs=1e-14 * pair.backlash)


@PERFECT
def test_tracked_pairs_have_the_forces_of_the_closed_form(kernel: Kernel, pair: RealPair):
    """Several pairs share one set of tracked points; the coast flank stays in closed form."""
    for gap in GAPS.values():
        closed, teeth = made(kernel, pair, gap, 5)
        expected = closed.outputs(teeth.state)
        for tracking in (ALGEBRAIC, DIFFERENTIAL):
            gearbox = pair.gearbox(
                kernel,
                (load(0, TORQUE, -50.0 * pair.sigma),),
                **{"damping": DAMPING, "friction": FRICTION, "tracking": tracking},
            )
            state = tracked(closed, gearbox, teeth.state)
            found = gearbox.outputs(state)
            for name, values in expected.items():
                if name in ("tracking", "gradient_ratio") or "distance" in name:
                    continue
                if "residual" in name or np.isnan(values).all():
                    continue
                # rounding of radii of 0.1 m against penetrations of 1e-5 m
                np.testing.assert_allclose(
                    found[name],
                    values,
                    rtol=1e-9,
                    atol=1e-10 * np.nanmax(abs(values)) + 1e-14,
                    err_msg=name,
                )


def tracked(closed: Gearbox, gearbox: Gearbox, state: State) -> State:
    """Add the consistent tracked points to the state of the closed form."""
    same = State(state.t, *np.zeros((2, gearbox.sizes.n_states)), state.integers, state.reals)
    for i, name in enumerate(closed.names):
        same.y[gearbox.index(name)] = state.y[i]
    near = same.copy()
    on_path = [c for c in range(gearbox.sizes.n_drive_slots) if gearbox.mode(near, c)[1] != OFF]
    if on_path:
        gearbox.mode(near, on_path[0])[1] = APART
        near, _ = gearbox.apply(near, "apart", contact=on_path[0])
        same.y[gearbox.tracked()] = near.y[gearbox.tracked()]
    same.yp = gearbox.derivative(same)
    return same


@EVERY_PAIR
@EVERY_GAP
def test_jacobian_is_the_derivative_of_the_residual(kernel: Kernel, pair: RealPair, gap: float):
    """Several pairs on the path, both flanks, all zones of flanks with deviations, moving axes."""
    for seed in range(2):
        gearbox, teeth = made(kernel, pair, gap, 20 + seed)
        teeth.state.yp = gearbox.derivative(teeth.state)
        check_jacobian(gearbox, teeth.state)


@EVERY_PAIR
def test_jacobian_where_a_pair_overlaps_without_force(kernel: Kernel, pair: RealPair):
    gearbox, teeth = made(kernel, pair, GAPS["drive"], 31)
    for contact in range(gearbox.sizes.n_drive_slots):
        mode = gearbox.mode(teeth.state, contact)
        if mode[1] == LOADED:
            mode[1] = UNLOADED
            break
    teeth.state.yp = gearbox.derivative(teeth.state)
    check_jacobian(gearbox, teeth.state)


@PERFECT
@pytest.mark.parametrize("tracking", [ALGEBRAIC, DIFFERENTIAL])
def test_jacobian_of_tracked_pairs_is_the_derivative_of_the_residual(
    kernel: Kernel, pair: RealPair, tracking: str
):
    for gap in (GAPS["drive"], GAPS["coast"]):
        closed, teeth = made(kernel, pair, gap, 41)
        gearbox = pair.gearbox(
            kernel,
            (load(0, TORQUE, -50.0 * pair.sigma),),
            **{"damping": DAMPING, "friction": FRICTION, "tracking": tracking},
        )
        state = tracked(closed, gearbox, teeth.state)
        check_jacobian(gearbox, state)
