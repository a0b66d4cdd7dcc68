"""A pair whose axle is shaken by falling friction, and what a force's history is measured by."""

from __future__ import annotations

from typing import Any

import numpy as np

START = 0.25  # of the run: the initial shock is left out
SMALL = 0.01  # of the mean force: deviations and ranges below that count as that

PITCH = 3.07e-2  # between two changes of the teeth [s]


def self_excited(**friction: Any) -> dict[str, Any]:
    """Make a small, heavily loaded pair on a light bearing, its contact damped well.

    The bearing's mode of 3.6 kHz is damped where friction rises, near the pitch point, and grows on
    the rest of the path of contact: damping ratios down to -0.25.
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
    """Largest difference of the statistics to those of a reference, relative to them."""
    exact = statistics(reference)
    return float((abs(statistics(history) - exact) / abs(exact)).max())
