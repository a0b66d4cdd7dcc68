"""Friction-induced vibration of a pair with decreasing friction, and whether radau resolves it.

Compared are mean, standard deviation and 98 % range of the force of each mesh after the first
quarter of the run.
"""

from __future__ import annotations

import json
import subprocess
import tempfile
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr

from system.stribeck_gearboxes import stribeck_gearbox

START = 0.25  # fraction of the run that is omitted: the initial transient
SMALL = 0.01  # of the mean force: lower limit of deviations and ranges
WITHIN = 0.05  # of each statistic: uncertainty of an onset that grows from below the tolerance

RADAU = "simulation.integrator=radau"
SMALL_STEPS = "simulation.max_step=1e-5"
REFUSED = 3  # exit code of an invalid case, or one without a valid start
OTHER_SMALL_STEPS = "simulation.max_step=8.3e-6"

PITCH = 3.07e-2  # between two tooth changes [s]


def self_excited(**friction: Any) -> dict[str, Any]:
    """Create a small, heavily loaded pair on a light bearing, with a well damped contact.

    The bearing's mode of 3.6 kHz is damped near the pitch point, where friction increases, and
    grows on the rest of the path of contact: damping ratios down to -0.25.
    """
    law = {
        "law": "stribeck",
        "regularisation_velocity": 0.013,
        "static_coefficient": 0.31,
        "kinetic_coefficient": 0.21,
        "stribeck_velocity": 0.11,
    }
    return {
        "format": 1,
        "materials": {"s": {"youngs_modulus": 2.06e11, "poisson_ratio": 0, "density": 7830}},
        "wheels": [
            {
                **{"name": "driver", "teeth": 15, "width": 0.00445, "material": "s"},
                **{"centre": [0, 0], "pitch_radius": 0.012},
                "loads": [{"kind": "speed", "value": -13.6}],
            },
            {
                **{"name": "driven", "teeth": 26, "width": 0.00455, "material": "s"},
                "support": {
                    **{"kind": "bearing", "mass": 0.0198},
                    **{"stiffness": [2.84e7, 7.08e7], "damping": [42, 42]},
                },
                "loads": [{"kind": "viscous", "coefficient": 2.78}],
            },
        ],
        "meshes": [
            {
                **{"driving": "driver", "driven": "driven", "driving_rotation": "clockwise"},
                **{"centre_line_angle": 143, "pressure_angle": 15.6, "backlash": 1.5e-4},
                **{"tracking": "closed_form", "contact": {"law": "johnson"}},
                "damping": {"law": "lee_wang", "restitution": 0.485, "v0_min": 1e-3},
                "friction": friction or law,
            }
        ],
        "simulation": {
            **{"duration": 0.0655, "output_interval": 1.6e-5},
            "initial": {
                **{"kind": "speeds", "speeds": {"driver": -13.6, "driven": 7.846}},
                "gaps": {"driver-driven": 6.5e-8},
            },
        },
    }


def statistics(history: Any) -> np.ndarray:
    """Mean, standard deviation and 98 % range of the normal force of each mesh, [3, mesh]."""
    force = np.nan_to_num(history["normal_force"].values)
    force = force.reshape(len(force), -1)[int(START * len(force)) :]
    least = SMALL * abs(force.mean(axis=0))
    low, high = np.quantile(force, [0.01, 0.99], axis=0)
    return np.array([force.mean(0), np.maximum(force.std(0), least), np.maximum(high - low, least)])


def difference(history: Any, reference: Any) -> float:
    """Largest difference of the statistics from those of a reference, relative to the reference."""
    exact = statistics(reference)
    return float((abs(statistics(history) - exact) / abs(exact)).max())


@dataclass(frozen=True)
class Judged:
    """Verdict on a random gearbox."""

    verdict: str  # "agrees", "differs", "chaotic" (small steps differ, too), "refused" or "failed"
    said: str  # warning about a self-excited vibration or motion; empty without a warning
    difference: float  # of the statistics
    words: str  # messages of the run

    @property
    def is_sound(self) -> bool:
        """Whether the run was correct or warned, or the case was rejected."""
        if self.verdict == "differs":
            return self.said != ""
        return self.verdict in ("agrees", "chaotic", "refused")

    def __str__(self) -> str:
        words = self.said or self.words.strip().splitlines()[-1]
        return f"{self.verdict}, {self.difference:.2g}: {words}"


def judge(program: Path, seed: int) -> Judged:
    """Compare radau by default with radau in small steps for the gearbox of a seed.

    If they differ, a second run with small steps shows whether the motion is chaotic: then no
    agreement is required.
    """
    with tempfile.TemporaryDirectory() as folder:
        case = Path(folder) / "case.yaml"
        case.write_text(json.dumps(stribeck_gearbox(seed)))
        history, words, exit_code = _run(program, case)
        exact, _, _ = _run(program, case, SMALL_STEPS)
        said = next((line for line in words.splitlines() if "self-excited" in line), "")
        if history is None or exact is None:
            verdict = "refused" if exit_code == REFUSED else "failed"
            return Judged(verdict, said, float("nan"), words)
        error = difference(history, exact)
        if error <= WITHIN:
            return Judged("agrees", said, error, words)
        other, _, _ = _run(program, case, OTHER_SMALL_STEPS)
    chaotic = other is not None and difference(other, exact) > WITHIN
    return Judged("chaotic" if chaotic else "differs", said, error, words)


def _run(program: Path, case: Path, *settings: str) -> tuple[Any, str, int]:
    """Return the forces, the messages and the exit code; no forces if the run failed."""
    output = case.with_suffix(".h5")
    options = [word for setting in (RADAU, *settings) for word in ("--set", setting)]
    command = [program, "run", case, "-o", output, *options]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    if done.returncode != 0:
        return None, done.stderr, done.returncode
    with xr.open_dataset(output, engine="netcdf4") as history:
        return history[["normal_force"]].load(), done.stderr, 0
