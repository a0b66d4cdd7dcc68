"""A response of made-up numbers: two motions, of which one jumps to the other."""

from __future__ import annotations

import numpy as np
import xarray as xr

JUMP = (-502.0, -501.0)  # rad/s


def backlash_response() -> xr.Dataset:
    """One mesh, up and down, with a jump down and one value that is not periodic."""
    speed = -np.linspace(400.0, 600.0, 5)
    low = np.array([1.0, 1.1, 1.2, 1.4, 1.3])
    numbers = np.stack([low, np.where(speed < -501.5, 3.0, low)])[:, :, None]
    axes = ("direction", "parameter", "mesh")
    response = xr.Dataset(
        {
            "transmission_error_standard_deviation": (axes, 1e-6 * numbers, {"units": "m"}),
            "dynamic_factor": (axes, numbers, {"units": "1"}),
            "period": (axes[:2], [[1, 1, 1, 0, 1], [1, 1, 1, 2, 2]], {"units": "1"}),
            "jump_direction": ("jump", [1]),
            "jump_before": ("jump", [JUMP[0]], {"units": "rad s-1"}),
            "jump_after": ("jump", [JUMP[1]], {"units": "rad s-1"}),
        },
        {"direction": ["up", "down"], "parameter": speed, "mesh": ["pair"], "jump": [0]},
        {"evolvent_kind": "response", "parameter": "wheels.pinion.loads.0.value"},
    )
    response["parameter"].attrs["units"] = "rad s-1"
    return response
