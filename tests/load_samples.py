"""Samples of every kind of load and support with the keys of the case file, for tests.

A kind in a table of the kernel without a sample here fails `test_every_kind_of_load_has_a_sample`,
or that of the supports.
"""

from __future__ import annotations

from typing import Any

SAMPLES: dict[str, dict[str, Any]] = {
    "torque": {"kind": "torque", "value": 4.0},
    "viscous": {"kind": "viscous", "coefficient": 5.0},
    "table": {"kind": "table", "time": [0.0, 0.5, 2.0], "torque": [1.0, -2.0, 4.0]},
    "speed": {"kind": "speed", "value": -3.0},
    "table of speeds": {"kind": "speed", "time": [0.0, 0.5, 2.0], "speed": [0.0, -2.0, -3.0]},
    "harmonic over time": {
        **{"kind": "harmonic", "mean": 1.0, "amplitude": 3.0},
        **{"frequency": 37.0, "phase": 25.0},
    },
    "harmonic by order": {"kind": "harmonic", "amplitude": 3.0, "order": 2.5, "phase": -40.0},
    "loss": {"kind": "loss", "speed": [1.0, 3.0, 40.0], "torque": [0.5, 2.5, 1.5]},
    "drive": {"kind": "drive", "speed": -3.0, "torque": -2.0, "slope": -5.0},
}

SUPPORTS: dict[str, dict[str, Any]] = {
    "fixed": {"kind": "fixed"},
    "slider": {
        **{"kind": "slider", "direction": 20.0, "mass": 3.0},
        **{"stiffness": 1e8, "damping": 2e3},
    },
    "bearing": {
        "kind": "bearing",
        "mass": 3.0,
        "stiffness": [1e8, 3e8],
        "damping": [2e3, 1e3],
    },
}
