"""A static analysis that is made up, in the layout of result_format."""

from __future__ import annotations

import numpy as np
import xarray as xr

PAIRS = (-1, 0, 1)
RATIO = 1.5  # contact ratio
REACH = 0.2  # pitches past the ends of the path


# Data of the pair, so that its influence functions are known; with few degrees of freedom.
WHEEL = "module: 3 mm, width: 20 mm, bore: 25 mm, material: steel, compliance: {order: 4}"
CASE = f"""
format: 1
materials: {{steel: {{youngs_modulus: 206 GPa, poisson_ratio: 0.3, density: 7830 kg/m3}}}}
wheels:
- {{name: pinion, teeth: 19, profile_shift: 0.4, {WHEEL}, loads: [{{kind: torque, value: -20}}]}}
- {{name: gear, teeth: 34, profile_shift: 0.1, {WHEEL}, loads: [{{kind: torque, value: -36}}]}}
meshes:
- {{name: pinion-gear, driving: pinion, driven: gear, driving_rotation: clockwise,
   centre_line_angle: 0}}
simulation: {{duration: 1 ms, output_interval: 10 us}}
"""
PITCH = 8.86e-3  # on the line of action [m]
LOWEST = (8e-3, 24e-3)  # radius of curvature on both wheels at the start of the path [m]


def share_at(position: np.ndarray) -> np.ndarray:
    """Share of a pair that is so many pitches from the start of its path: a trapezium."""
    return np.interp(
        position, [-REACH, 0.0, 0.5, 1.0, RATIO, RATIO + REACH], [0, 0.4, 1, 1, 0.4, 0]
    )


def static_curves(
    torques: tuple[float, ...] = (10.0, 20.0), points: int = 40, pitches: int = 1
) -> xr.Dataset:
    """Transmission errors that grow with the torque, alike in all pitches but for a long wave."""
    x = np.arange(points * pitches) / points
    torque = np.array(torques)[:, np.newaxis]
    wave = 1e-6 * np.sin(2 * np.pi * x / pitches) if pitches > 1 else 0.0
    h = torque * 1e-7 * (1 + 0.3 * np.cos(2 * np.pi * x)) + wave
    position = (x % 1)[:, np.newaxis] + np.array(PAIRS)
    share = np.broadcast_to(share_at(position), (len(torques), *position.shape))
    along = np.broadcast_to(position, share.shape) * PITCH
    rho = (LOWEST[0] + along, LOWEST[1] - along)
    curve, pair = ("torque", "position"), ("torque", "position", "pair")
    wheel = ("torque", "position", "wheel")
    stress = (torque * (2 + np.cos(2 * np.pi * x)))[:, :, np.newaxis] * np.array([1e6, 1.2e6])
    tooth = np.broadcast_to((x[:, np.newaxis] % 1 > 0.5).astype(int), stress.shape)
    per_m = {"units": "N m-1"}
    return xr.Dataset(
        {
            "transmission_error": (curve, h, {"units": "m"}),
            "loaded_secant_stiffness": (curve, torque / h, per_m),
            "tangent_stiffness": (curve, 1.1 * torque / h, per_m),
            "force_share": (pair, share, {"units": "1"}),
            "pair_normal_force": (
                pair,
                share * abs(torque)[:, :, np.newaxis] * 37.0,
                {"units": "N"},
            ),
            "pair_position": (pair, rho[0], {"units": "m"}),
            "pair_position_driven": (pair, rho[1], {"units": "m"}),
            "common_width": ((), 0.02, {"units": "m"}),
            "pair_contact_kind": (pair, (share > 0).astype(int), {"units": "1"}),
            "contact_ratio": ((), RATIO),
            "root_stress_max": (wheel, stress, {"units": "Pa"}),
            "root_stress_min": (wheel, -1.2 * stress, {"units": "Pa"}),
            "root_stress_max_arc": (wheel, 1e-3 * (1 + 0.1 * tooth), {"units": "m"}),
            "root_stress_max_tooth": (wheel, tooth, {"units": "1"}),
            "peak_to_peak_transmission_error": ("torque", np.ptp(h, axis=1), {"units": "m"}),
            "harmonic_amplitude": (
                ("torque", "harmonic"),
                0.3e-7 * torque / np.arange(1, 11) ** 2,
                {"units": "m"},
            ),
        },
        coords={
            "torque": np.array(torques),
            "position": x,
            "pair": list(PAIRS),
            "harmonic": np.arange(1, 11),
            "wheel": ["pinion", "gear"],
        },
        attrs={
            **{"evolvent_format": 1, "evolvent_kind": "static", "mesh": "pinion-gear"},
            "case": CASE,
            **{"points": points, "pitches": pitches, "status": "done", "status_message": ""},
        },
    )
