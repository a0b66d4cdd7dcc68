"""Test pairs of gears defined by a basic rack, and states of them."""

from __future__ import annotations

import mpmath as mp
import numpy as np

from kernel.deviations import LINEAR, PARABOLIC, deviations, relief
from kernel.gearbox import Gearbox
from kernel.gearbox_description import CLOSED_FORM, TORQUE, load
from kernel.kernel import Kernel
from kernel.real_pairs import RealPair, Teeth, state_of

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
# gap of the perfect drive flanks: loaded, in the middle of the backlash, coast flanks loaded
GAPS = {"drive": -2e-5, "between": 2.5e-5, "coast": 7e-5}


def made(
    kernel: Kernel, pair: RealPair, gap: float, seed: int, tracking: str = CLOSED_FORM
) -> tuple[Gearbox, Teeth]:
    """Create the gearbox with damping and friction, and a state with its pairs in their slots."""
    gearbox = pair.gearbox(
        kernel,
        (load(0, TORQUE, -50.0 * pair.sigma),),
        **{"damping": DAMPING, "friction": FRICTION, "tracking": tracking},
    )
    teeth = state_of(gearbox, pair, np.random.default_rng(seed), gap=gap)
    teeth.settle()
    settle_friction(pair, teeth)
    return gearbox, teeth


def settle_friction(pair: RealPair, teeth: Teeth) -> None:
    """Set every loaded pair to the friction branch of its sliding velocity."""
    for contact in teeth.contacts:
        if contact.gap >= 0:
            continue
        slot = contact.flank * pair.slots + contact.number % pair.slots
        slip = -teeth.force(contact, 0.0, (1.0, 1e9)).friction / teeth.force(contact).normal * 1e9
        branch = 0 if abs(slip) <= FRICTION[1] else int(mp.sign(slip))
        teeth.gearbox.mode(teeth.state, slot)[2] = branch
