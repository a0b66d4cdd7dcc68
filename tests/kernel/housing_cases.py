"""Housings at rest under gravity, with prescribed motion, or on a mount."""

from __future__ import annotations

from kernel.housing_description import (
    CONSTANT,
    HARMONIC,
    HOUSING_FIXED,
    MOUNTED,
    PRESCRIBED,
    RATE,
    SPLINE,
    TURN_X,
    TURN_Y,
    TURN_Z,
    X,
    Y,
    Z,
    housing,
    term,
)

MOTION = (
    term(X, HARMONIC, 0.01, frequency=3.0, phase=0.4),
    term(Y, RATE, 0.2),
    term(Z, CONSTANT, -0.3),
    term(TURN_X, HARMONIC, 0.4, frequency=2.0),
    term(TURN_Y, SPLINE, table=[(-1.0, 0.3), (0.2, -0.1), (0.5, 0.4), (2.0, 0.2)]),
    term(TURN_Z, RATE, 1.7),
)
ACCELEROMETERS = [
    {"name": "foot", "point": [0.4, -0.3, 0.2], "direction": [0.0, 0.0, 2.0]},
    {"name": "bearing", "point": [-0.1, 0.2, 0.5], "direction": [1.0, -2.0, 0.5]},
]
BODY = {
    "mass": 30.0,
    "centre_of_mass": [0.1, -0.2, 0.05],
    "inertia": [2.0, 2.5, 3.1],
    "products_of_inertia": [0.2, -0.3, 0.15],
    "mount_point": [0.3, 0.1, -0.2],
    "stiffness": [2e5, 3e5, 1e5],
    "damping": [200.0, 150.0, 90.0],
    "rotational_stiffness": [3e4, 2e4, 5e4],
    "rotational_damping": [30.0, 40.0, 20.0],
    "force": [20.0, -30.0, 15.0],
    "moment": [-4.0, 3.0, 5.0],
    "gravity": [0.5, -1.0, -9.7],
    "position": [0.01, -0.02, 0.03],
    "orientation": [0.9, 0.1, -0.3, 0.2],
    "velocity": [0.3, -0.4, 0.2],
    "angular_velocity": [0.7, -1.1, 0.9],
    "accelerometers": ACCELEROMETERS,
}


HOUSINGS = {
    "gravity": housing(HOUSING_FIXED, gravity=[1.0, -9.0, 2.0]),
    "prescribed": housing(
        PRESCRIBED, terms=MOTION, gravity=[0.5, -1.0, -9.7], accelerometers=ACCELEROMETERS
    ),
    "mounted": housing(MOUNTED, **BODY),
}
