"""The paper's case with every force law: invariants hold, the steady state follows the law."""

from __future__ import annotations

import math

import numpy as np
import pytest
from restitution import FACTORS as RESTITUTION

from evolvent import check_history
from system.runs import FRICTION, FRICTIONLESS

WIDTH, POISSON, YOUNG = 0.1, 0.3, 2e11
E_STAR = YOUNG / (2 * (1 - POISSON**2))
ALPHA = 1.05 * math.atan(2 * math.pi / 50)
BASE_PINION, RHO = 0.2 * math.cos(ALPHA), 0.5 * math.sin(ALPHA)

CONTACTS = {
    "johnson": "",
    "radzimovsky": "",
    "linear": ", stiffness: 1e9",
    "yang_lin": "",
    "power": ", coefficient: 1e13, exponent: 1.5",
}
# With little or no damping, the contact vibrates for thousands of oscillations.
DAMPINGS = {
    "none": "",
    "linear": ", coefficient: 1e4",
    "one_sided": ", coefficient: 1e12",
    **dict.fromkeys(RESTITUTION, ", restitution: 0.5, v0_min: 1e-4"),
    "ratio": ", value: 0.02",
}
FRICTIONS = {
    "none": "",
    "coulomb": ", coefficient: 0.3",
    "tanh": ", coefficient: 0.3",
    "stribeck": ", static_coefficient: 0.3, kinetic_coefficient: 0.1, stribeck_velocity: 5e-3",
    "schlenk": "",
    "mean_roughness": "",
    "benedict_kelley": "",
    "xu_kahraman": "",
}
OIL = "meshes.0.lubricant={viscosity: 20 mPa s, roughness: 0.5 um}"


def setting(family: str, law: str, parameters: str) -> str:
    """Setting for another law of the mesh."""
    return f"meshes.0.{family}={{law: {law}{parameters}}}"


def with_laws(runs, *settings: str, duration: float = 5.0):
    """Run the paper's case with friction, and check the invariants."""
    run = runs(FRICTION, *settings, f"simulation.duration={duration}")
    assert run.exit_code == 0, run.messages
    assert [
        verdict.invariant.name for verdict in check_history(run.history) if verdict.failed
    ] == []
    return run


@pytest.mark.parametrize("law", CONTACTS)
def test_every_elastic_law_runs_with_friction_and_keeps_the_invariants(runs, law):
    run = with_laws(runs, setting("contact", law, CONTACTS[law]))
    assert len(run.times("tooth_switch")) > 0
    assert float(run.history["penetration"].max()) > 0


@pytest.mark.parametrize("law", DAMPINGS)
def test_every_viscous_law_runs_with_friction_and_keeps_the_invariants(runs, law):
    # undamped, 5 s take seconds of CPU
    duration = 1.0 if law == "none" else 5.0
    run = with_laws(runs, setting("damping", law, DAMPINGS[law]), duration=duration)
    lost = run.history["dissipated_energy"].values
    assert np.diff(lost).min() >= -1e-9 * lost[-1]  # the integrator's tolerance


@pytest.mark.parametrize("law", FRICTIONS)
def test_every_friction_law_runs_and_keeps_the_invariants(runs, law):
    run = with_laws(runs, OIL, setting("friction", law, FRICTIONS[law]))
    kinks = len(run.times("sliding_began")) + len(run.times("sliding_ended"))
    smooth = law in {"none", "tanh", "stribeck", "benedict_kelley", "xu_kahraman"}
    assert (kinks > 0) != smooth


PHI = {
    "none": np.zeros_like,
    "coulomb": lambda v: 0.3 * np.clip(v / 1e-4, -1, 1),
    "tanh": lambda v: 0.3 * np.tanh(v / 1e-4),
    "stribeck": lambda v: (0.1 + 0.2 * np.exp(-((v / 5e-3) ** 2))) * np.tanh(v / 1e-4),
}


@pytest.mark.parametrize("law", PHI)
def test_the_friction_force_in_the_history_is_that_of_the_law(runs, law):
    history = with_laws(runs, setting("friction", law, FRICTIONS[law])).history
    normal, v = history["normal_force"].values, history["sliding_velocity"].values
    expected = -normal * PHI[law](v)
    np.testing.assert_allclose(
        history["friction_force"].values, expected, rtol=1e-12, atol=1e-14 * normal.max()
    )


def johnson(force: float) -> float:
    line = force / WIDTH
    return line / (math.pi * E_STAR) * (math.log(4 * math.pi * E_STAR * RHO / line) - 1)


def radzimovsky(force: float) -> float:
    line = force / WIDTH
    strip = 2 * math.sqrt(4 * line * RHO / 4 / (math.pi * E_STAR))  # rho_A = rho_B = rho/2
    return line / (math.pi * E_STAR) * (2 / 3 + 2 * math.log(4 * RHO / 2 / strip))


PENETRATION = {
    "johnson": johnson,
    "radzimovsky": radzimovsky,
    "linear": lambda force: force / 1e9,
    "yang_lin": lambda force: force / (math.pi * E_STAR * WIDTH / 2),
    "power": lambda force: (force / 1e13) ** (2 / 3),
}


@pytest.mark.parametrize("law", CONTACTS)
def test_the_steady_penetration_is_that_of_the_law_under_the_torque(runs, law):
    run = runs(
        FRICTIONLESS,
        setting("contact", law, CONTACTS[law]),
        "simulation.initial={kind: steady}",
        "simulation.duration=0.01",
    )
    force = 1.0 / BASE_PINION
    np.testing.assert_allclose(run.history["normal_force"], force, rtol=1e-9)
    # the slider yields by 5e-9 m, and rho by less than 1e-6 of it
    np.testing.assert_allclose(run.history["penetration"], PENETRATION[law](force), rtol=1e-6)
