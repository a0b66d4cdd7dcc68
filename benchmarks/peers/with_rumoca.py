"""rumoca: a Modelica compiler with its own solvers; switch and kinks are Modelica's events."""

from __future__ import annotations

import re
from collections.abc import Callable
from pathlib import Path

import numpy as np
import paper_case as case
import rumoca
from paper_case import SCALES, Array

SMALL_RTOL = 1e-12  # next to the absolute tolerance it does not count
PARAMETERS = {
    "base_a": case.BASE_A,
    "base_b": case.BASE_B,
    "distance_0": case.DISTANCE,
    "pitch": case.PITCH,
    "curvature_start": case.CURVATURE_START,
    "alpha_0": case.ALPHA_0,
    "inertia_a": case.INERTIA_A,
    "inertia_b": case.INERTIA_B,
    "sliding_mass": case.SLIDING_MASS,
    "e_star": case.E_STAR,
    "width": case.WIDTH,
    "damping": case.DAMPING,
    "viscous": case.VISCOUS,
    "stiffness": case.STIFFNESS,
    "slider_damping": case.SLIDER_DAMPING,
    "delta": case.DELTA,
    "torque": case.TORQUE,
}


def source(friction: float) -> str:
    """Gearbox.mo with its parameters filled in."""
    text = Path(__file__).with_name("Gearbox.mo").read_text(encoding="utf-8")
    for name, value in {**PARAMETERS, "friction": friction}.items():
        text = re.sub(rf"\b{name} = [01]\b", f"{name} = {float(value)!r}", text)
    scales = ", ".join(repr(float(scale)) for scale in SCALES)
    return text.replace("{1, 1, 1, 1, 1, 1}", f"{{{scales}}}")


def solver(
    method: str, friction: float, tolerance: float, duration: float = case.DURATION
) -> Callable[[], Array]:
    """Return what integrates the case once and gives h at the outputs [m].

    A duration shorter than an output interval measures the cost of a run before it integrates.
    """
    model = rumoca.Session().loads(source(friction), model="Gearbox")
    interval = min(case.DURATION / (case.N_OUTPUTS - 1), duration)
    config = rumoca.SimConfig(solver=method, rtol=SMALL_RTOL, atol=tolerance)

    def run() -> Array:
        result = model.simulate((0.0, duration), dt=interval, config=config)
        if duration < case.DURATION:
            return np.array(result["depth"])
        times, depth = np.array(result.time), np.array(result["depth"])
        # Before an event and after it there are rows beside those of the grid.
        indices = np.searchsorted(times, case.grid() - 1e-9)
        if np.abs(times[indices] - case.grid()).max() > 1e-9:
            raise RuntimeError("an output is missing")
        return depth[indices]

    return run
