"""Real pairs: which teeth are on the path, what each tooth pair does, against absolute coordinates."""

from __future__ import annotations

import mpmath as mp
import numpy as np
import pytest

from kernel.deviations import LINEAR, PARABOLIC, deviations, relief
from kernel.gearbox import LOADED, OPEN, Gearbox
from kernel.gearbox_cases import worst
from kernel.kernel import Floats, Kernel
from kernel.real_pairs import COAST, DRIVE, RealPair, Teeth, state_of

FRICTION = (0.2, 1e-2)
DAMPING = 3e3
ALL_DEVIATIONS = (
    deviations(
        tip_relief=relief(12e-6, diameter=0.0592),
        root_relief=relief(6e-6, roll_angle=np.radians(11), shape=PARABOLIC),
        profile_crowning=3e-6,
        runout_amount=7e-6,
        runout_phase=2.0,
    ),
    deviations(
        tip_relief=relief(9e-6, diameter=0.1043, shape=PARABOLIC),
        pitch_errors=[1e-6 * ((5 * k * k + 3 * k) % 17) for k in range(34)],
        runout_amount=11e-6,
        runout_phase=-0.7,
    ),
)
LINEAR_RELIEF = (
    deviations(tip_relief=relief(15e-6, diameter=0.0595, shape=LINEAR)),
    deviations(tip_relief=relief(15e-6, diameter=0.104, shape=LINEAR)),
)
PAIRS = {
    "standard": RealPair(),
    "mirrored": RealPair(sigma=-1, chi=0.7),
    "shifted": RealPair(teeth=(14, 37), shift=(0.5, -0.1), allowance=(-3e-5, -4e-5), chi=2.9),
    "high contact ratio": RealPair(
        **{"teeth": (120, 131), "module": 2e-3, "pressure_angle": float(np.radians(14))},
        **{"ratio": 3.3, "dedendum": 1.8, "sigma": -1, "chi": -2.4, "poisson": (0.2, 0.35)},
    ),
    "contact lost": RealPair(teeth=(25, 31), ratio=0.8),
    "driven wheel is the reference": RealPair(reference=1, chi=-1.0, sigma=-1),
    "linear tip relief": RealPair(deviations=LINEAR_RELIEF, chi=1.2),
    "every deviation": RealPair(deviations=ALL_DEVIATIONS),
    "every deviation, mirrored": RealPair(deviations=ALL_DEVIATIONS, sigma=-1, chi=-0.4),
}
EVERY_PAIR = pytest.mark.parametrize("pair", PAIRS.values(), ids=PAIRS.keys())
# gap of the perfect drive flanks: pressed, in the middle of the backlash, the coast flanks pressed
GAPS = {"drive": -2e-5, "between": 2.5e-5, "coast": 7e-5}
EVERY_GAP = pytest.mark.parametrize("gap", GAPS.values(), ids=GAPS.keys())


def made(kernel: Kernel, pair: RealPair, gap: float, seed: int) -> tuple[Gearbox, Teeth]:
    gearbox = pair.gearbox(kernel, damping=DAMPING, friction=FRICTION)
    teeth = state_of(gearbox, pair, np.random.default_rng(seed), gap=gap)
    teeth.settle()
    # friction branch from the sliding velocity, by the kernel
    return gearbox, teeth


def pair_values(gearbox: Gearbox, outputs: dict[str, Floats], name: str, flank: int) -> Floats:
    """Values of an output of the tooth pairs of a flank, place by place."""
    drive = gearbox.sizes.n_drive_places
    return outputs[name][0][:drive] if flank == DRIVE else outputs[name][0][drive:]


@EVERY_PAIR
@EVERY_GAP
@pytest.mark.parametrize("seed", range(3))
def test_the_pairs_on_the_path_are_the_teeth_that_stand_there(
    kernel: Kernel, pair: RealPair, gap: float, seed: int
):
    """Both flanks: number of every tooth, its place on the path, the gap of the nearest pair."""
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
            # rounding of the angle of some turns
            found = positions[contact.number % pair.slots]
            assert found == pytest.approx(float(contact.rho[0]), abs=1e-15 + 2e-16 * 30)
        if contacts:
            name = "gap" if flank == DRIVE else "coast_gap"
            nearest = float(min(c.gap for c in contacts))
            assert o[name][0] == pytest.approx(nearest, rel=1e-9, abs=1e-17)


@EVERY_PAIR
@EVERY_GAP
@pytest.mark.parametrize("seed", range(3))
def test_forces_of_every_pair_follow_the_gradient_of_its_gap(
    kernel: Kernel, pair: RealPair, gap: float, seed: int
):
    gearbox, teeth = made(kernel, pair, gap, seed)
    settle_friction(gearbox, pair, teeth)
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
        curvature = sum(1 / float(r) for r in contact.rho)
        geometry = gearbox.mesh_geometry()
        pressure = np.sqrt(
            float(force.normal) / geometry.common_width * geometry.effective_modulus
            * curvature / np.pi
        )
        values = pair_values(gearbox, o, "pair_contact_pressure", contact.flank)
        assert values[contact.number % pair.slots] == pytest.approx(pressure, rel=1e-9)
    # forces on the axles, from the accelerations of the bearings
    rates = gearbox.derivative(teeth.state)
    on_a = sum((f.on_a for f in forces), np.zeros(2))
    masses = o["mass"] + 5.0
    for i in (0, 1):
        for j, (x, k, c) in enumerate((("x", 1e9, 1e5), ("y", 7e8, 8e4))):
            s = float(teeth.q[2 + 2 * i + j])
            v = float(teeth.rates[2 + 2 * i + j])
            acceleration = rates[gearbox.place(f"displacement_{x}_rate_{i}")]
            expected = (1 - 2 * i) * float(on_a[j])
            found = masses[i] * acceleration + k * s + c * v
            assert found == pytest.approx(expected, abs=1e-9 * (largest + abs(k * s)))
    lost = sum(float(f.dissipation) for f in forces)
    for i in (0, 1):
        lost += 1e5 * float(teeth.rates[2 + 2 * i]) ** 2 + 8e4 * float(teeth.rates[3 + 2 * i]) ** 2
    if pair.deviates or not pair.fixed:
        lost -= radius_power(kernel, gearbox, teeth)
    assert rates[-2] == pytest.approx(lost, rel=1e-7, abs=1e-9 * largest)


def settle_friction(gearbox: Gearbox, pair: RealPair, teeth: Teeth) -> None:
    """Put every loaded pair on the branch of friction that belongs to its sliding velocity."""
    width = 5 if pair.deviates else 3
    for contact in teeth.contacts:
        if contact.gap >= 0:
            continue
        at = 1 + width * (contact.flank * pair.slots + contact.number % pair.slots)
        slip = -teeth.force(contact, 0.0, (1.0, 1e9)).friction / teeth.force(contact).normal * 1e9
        teeth.state.integers[at + 2] = 0 if abs(slip) <= FRICTION[1] else int(mp.sign(slip))


def radius_power(kernel: Kernel, gearbox: Gearbox, teeth: Teeth) -> float:
    """Power by which energies change because radii of curvature do, beside the penetrations'."""
    power = 0.0
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
        values = [
            kernel.johnson_potential(h, rho + sign * change, geometry.effective_modulus)[0][0]
            for sign in (1, -1)
        ]
        power += geometry.common_width * (values[0] - values[1]) / (2 * change) * excess
    return power
