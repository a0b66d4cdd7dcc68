"""One-sided damping is accurate; a test of the driver covers the steps at its kink."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from system.real_cases import real_pair, torque, viscous

TIGHT = "simulation.tolerance=1e-13"


def ringing(integrator: str) -> dict[str, Any]:
    """Gears that vibrate under one-sided damping, from rest under load."""
    return real_pair(
        teeth=(25, 40),
        wheels=(torque(-60.0), viscous(2.0)),
        mesh={
            **{"contact": {"law": "johnson"}, "damping": {"law": "one_sided", "coefficient": 2e8}},
            **{"backlash": 5e-5, "tracking": "closed_form"},
        },
        **{"duration": 0.01, "output_interval": 1e-5, "integrator": integrator},
    )


@pytest.mark.parametrize("integrator", ["radau", "ida"])
def test_one_sided_damping_is_right_to_a_millionth_of_the_penetration(runs, integrator):
    run, exact = runs(ringing(integrator)), runs(ringing("radau"), TIGHT)
    assert run.exit_code == 0, run.messages
    depth = exact.history["penetration"].values
    assert depth.max() > 0
    error = np.abs(run.history["penetration"].values - depth).max() / depth.max()
    assert error <= {"radau": 1e-7, "ida": 1e-5}[integrator]  # tolerance 1e-9
