"""Histories made without the executable: the independent program's solution in the file's layout.

What the independent program does not have, because it tracks no points, is what the theory says
of tracked points: they lie on their flanks and on the line of action, and lambda is constant.
"""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr
from gearbox_reference import Gearbox

CASE = """format: 1
title: The virtual setup of Kosenko and Gusev (2011)
wheels:
- {name: pinion, teeth: 20}
- {name: gear, teeth: 30}
"""


def make_history(solution: dict[str, Any]) -> xr.Dataset:
    """Build the root group from what `solve` returns."""
    gearbox: Gearbox = solution["gearbox"]
    data: dict[str, tuple[tuple[str, ...], Any, str]] = {}
    data.update(_statics(gearbox))
    data.update(_of_time(gearbox, solution))
    data.update(_of_wheels(gearbox, solution))
    data.update(_of_meshes(gearbox, solution))
    variables = {
        name: (dims, values, {"units": units, "long_name": name.replace("_", " "), "symbol": name})
        for name, (dims, values, units) in data.items()
    }
    attributes = {
        "Conventions": "CF-1.10",
        "title": "The virtual setup of Kosenko and Gusev (2011)",
        "evolvent_format": 1,
        "case": CASE,
        "status": "done",
        "status_message": "",
        "versions": "evolvent 0.1.0, SUNDIALS 6.4.1, HDF5 1.10.8",
        "warnings": "",
        "integrator_steps": 9700,
        "integrator_events": len(solution["events"]),
    }
    time = ("time", solution["t"], {"units": "s", "long_name": "model time", "symbol": "t"})
    names = {"wheel": ["pinion", "gear"], "mesh": ["pinion-gear"], "axis": ["x", "y"]}
    return xr.Dataset(variables, coords={"time": time, **names}, attrs=attributes)


def make_events(solution: dict[str, Any], names: list[str]) -> xr.Dataset:
    """Build the group of events; `names` are the program's kinds of them."""
    kinds, states = [], []
    sliding = False
    for _, name, state in solution["events"]:
        if name in ("above", "below"):
            sliding = not sliding
            kinds.append(names.index("sliding_began" if sliding else "sliding_ended"))
        else:
            sliding = True
            kinds.append(names.index(name))
        states.append([state[0], state[0]])
    n = len(kinds)
    flags = {
        "flag_values": np.arange(len(names), dtype=np.int32),
        "flag_meanings": " ".join(names),
        "units": "1",
        "long_name": "what happened",
        "symbol": "kind",
    }
    return xr.Dataset(
        {
            "time": ("event", np.array([t for t, _, _ in solution["events"]]), {"units": "s"}),
            "kind": ("event", np.array(kinds, dtype=np.int32), flags),
            "mesh": ("event", np.zeros(n, dtype=np.int32)),
            "tooth_pair": ("event", np.zeros(n, dtype=np.int32)),
            "reference_angle": (
                ("event", "side"),
                np.reshape(np.array(states, dtype=float), (n, 2)),
                {"units": "rad"},
            ),
        },
        coords={"event": np.arange(n, dtype=np.int32), "side": ["before", "after"]},
    )


def write_history(path: Path, history: xr.Dataset, events: xr.Dataset | None) -> Path:
    """Write both groups to one file; `events=None` leaves that group out."""
    history.to_netcdf(path, engine="h5netcdf")
    if events is not None:
        events.to_netcdf(path, mode="a", group="events", engine="h5netcdf")
    return path


def _statics(g: Gearbox) -> dict[str, tuple[tuple[str, ...], Any, str]]:
    wheel, mesh = ("wheel",), ("mesh",)
    length = g.distance_0 * math.sin(g.alpha_0)
    pitch = g.base_a * g.pitch_a
    start_a, start_b = g.curvature_start_a, length - g.curvature_start_a
    tips = [math.hypot(g.base_a, start_a + pitch), math.hypot(g.base_b, start_b)]
    ratio = g.setup.teeth_b / g.setup.teeth_a
    pitch_radii = [g.setup.pitch_radius_a, ratio * g.setup.pitch_radius_a]
    masses = [g.setup.density * math.pi * r**2 * g.setup.width for r in pitch_radii]
    return {
        "teeth": (wheel, np.array([g.setup.teeth_a, g.setup.teeth_b], dtype=np.int32), "1"),
        "base_radius": (wheel, [g.base_a, g.base_b], "m"),
        "inertia": (wheel, [g.inertia_a, g.inertia_b], "kg m2"),
        "pitch_radius": (wheel, pitch_radii, "m"),
        "tip_radius": (wheel, tips, "m"),
        "mass": (wheel, masses, "kg"),
        "centre": (("wheel", "axis"), [[0.0, 0.0], [g.distance_0, 0.0]], "m"),
        "working_pressure_angle": (mesh, [g.alpha_0], "rad"),
        "base_pitch": (mesh, [pitch], "m"),
        "flank": (mesh, np.array([1], dtype=np.int32), "1"),
        "driving_wheel": (mesh, np.array([0], dtype=np.int32), "1"),
        "driven_wheel": (mesh, np.array([1], dtype=np.int32), "1"),
        "common_width": (mesh, [g.setup.width], "m"),
        "effective_modulus": (mesh, [g.effective_modulus], "Pa"),
        "elastic_share_driving": (mesh, [0.5], "1"),
        "line_of_action_length": (mesh, [length], "m"),
        "rho_start_driving": (mesh, [start_a], "m"),
        "rho_start_driven": (mesh, [start_b], "m"),
        "reference_force": (mesh, [abs(g.setup.torque_a) / g.base_a], "N"),
        "reference_penetration": (mesh, [3e-9], "m"),
        "rigid_contact": (mesh, np.array([0], dtype=np.int32), "1"),
        "centre_line_angle": (mesh, [0.0], "rad"),
        "tracking": (mesh, np.array([2], dtype=np.int32), "1"),
    }


def _of_time(g: Gearbox, s: dict[str, Any]) -> dict[str, tuple[tuple[str, ...], Any, str]]:
    time = ("time",)
    kinetic = (
        g.inertia_a * s["omega_a"] ** 2
        + g.inertia_b * s["omega_b"] ** 2
        + g.sliding_mass * s["slider_rate"] ** 2
    ) / 2
    line_load = s["elastic_force"] / g.setup.width
    curvature = s["curvature_a"] + s["curvature_b"]
    e_star = math.pi * g.effective_modulus
    with np.errstate(divide="ignore", invalid="ignore"):
        contact = line_load**2 / (2 * e_star) * (np.log(4 * e_star * curvature / line_load) - 1.5)
    contact = g.setup.width * np.where(line_load > 0, contact, 0.0)
    turn = 2 * math.pi
    return {
        "reference_angle": (time, np.fmod(s["phi_a"], turn), "rad"),
        "reference_turns": (time, np.trunc(s["phi_a"] / turn).astype(np.int32), "1"),
        "kinetic_energy": (time, kinetic, "J"),
        "potential_energy": (time, contact + g.setup.slider_stiffness * s["slider"] ** 2 / 2, "J"),
        "dissipated_energy": (time, s["dissipated"], "J"),
        "load_work": (time, s["load_work"], "J"),
    }


def _of_wheels(g: Gearbox, s: dict[str, Any]) -> dict[str, tuple[tuple[str, ...], Any, str]]:
    dims, moved_dims = ("time", "wheel"), ("time", "wheel", "axis")
    zero = np.zeros_like(s["t"])

    def both(a: Any, b: Any) -> Any:
        return np.stack([a, b], axis=1)

    def moved(x: Any) -> Any:
        return np.stack([both(zero, zero), both(x, zero)], axis=1)

    angle_b = -(g.base_a * s["phi_a"] + s["delta"]) / g.base_b
    return {
        "angle": (dims, both(s["phi_a"], angle_b), "rad"),
        "angle_deviation": (dims, both(zero, -s["delta"] / g.base_b), "rad"),
        "angular_velocity": (dims, both(s["omega_a"], s["omega_b"]), "rad s-1"),
        "angular_acceleration": (dims, both(s["acceleration_a"], s["acceleration_b"]), "rad s-2"),
        "load_torque": (
            dims,
            both(zero + g.setup.torque_a, -g.setup.viscous_b * s["omega_b"]),
            "N m",
        ),
        "centre_displacement": (moved_dims, moved(s["slider"]), "m"),
        "centre_velocity": (moved_dims, moved(s["slider_rate"]), "m s-1"),
    }


def _of_meshes(g: Gearbox, s: dict[str, Any]) -> dict[str, tuple[tuple[str, ...], Any, str]]:
    dims = ("time", "mesh")
    separation = np.array([g.separation_curvature(float(x)) for x in s["slider"]])
    zero = np.zeros_like(s["t"])
    k_a = g.base_a * 1j * s["along"]
    point_a = k_a + s["curvature_a"] * s["along"]
    point_b = point_a - s["h"] * s["along"]
    columns: dict[str, tuple[Any, str]] = {
        "transmission_error": (s["delta"], "m"),
        "penetration": (np.maximum(s["h"], 0.0), "m"),
        "gap": (-s["h"], "m"),
        "normal_force": (s["normal_force"], "N"),
        "friction_force": (s["friction_force"], "N"),
        "sliding_velocity": (s["sliding_velocity"], "m s-1"),
        "gradient_ratio": (zero - g.base_b / g.base_a, "1"),
        "tooth_pair": (s["teeth_passed"].astype(np.int32), "1"),
        "in_contact": ((s["h"] > 0).astype(np.int32), "1"),
        "contact_mode": ((s["h"] > 0).astype(np.int32), "1"),
        "tracking_residual_driving": (zero, "m"),
        "tracking_residual_driven": (zero, "m"),
        "line_distance_driving": (zero, "m"),
        "line_distance_driven": (zero, "m"),
        "separation_curvature": (separation, "m"),
        "flank_deviation": (zero, "m"),
        "friction_arm_driving": (s["curvature_a"] - s["h"] / 2, "m"),
        "friction_arm_driven": (s["curvature_b"] - s["h"] / 2, "m"),
    }
    data: dict[str, tuple[tuple[str, ...], Any, str]] = {
        name: (dims, np.reshape(values, (-1, 1)), units)
        for name, (values, units) in columns.items()
    }
    for side, point in (("driving", point_a), ("driven", point_b)):
        values = np.stack([point.real, point.imag], axis=1)[:, None, :]
        data[f"contact_point_{side}"] = (("time", "mesh", "axis"), values, "m")
    return data
