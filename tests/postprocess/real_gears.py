"""Histories of a real pair in closed form: what the drawings of teeth and tooth pairs need.

Two gears without profile shift, the driving one clockwise (sigma = +1) and centres on the x axis.
The flanks overlap by a constant penetration on the drive side, or on the coast side.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import Any

import numpy as np
import xarray as xr
from scipy.optimize import brentq

ALPHA = math.radians(20.0)


def involute(alpha: float) -> float:
    """Return inv alpha = tan alpha - alpha."""
    return math.tan(alpha) - alpha


@dataclass
class RealPair:
    """A pair of standard gears with backlash."""

    teeth: tuple[int, int] = (20, 31)
    module: float = 3e-3
    backlash: float = 1e-4
    penetration: float = 2e-6
    friction: float = 0.1  # F_t over F_n
    relief: tuple[float, float] = (0.0, 0.0)  # linear, from the pitch circle to the tip
    coast: bool = False  # whether the coast flanks touch
    base: tuple[float, float] = field(init=False)
    tip: tuple[float, float] = field(init=False)
    tooth_angle: tuple[float, float] = field(init=False)

    def __post_init__(self) -> None:
        radius = [self.module * z / 2 for z in self.teeth]
        self.base = (radius[0] * math.cos(ALPHA), radius[1] * math.cos(ALPHA))
        self.tip = (radius[0] + self.module, radius[1] + self.module)
        angles = [math.pi / z + 2 * involute(ALPHA) for z in self.teeth]
        self.tooth_angle = (angles[0], angles[1])
        both = sum(self.base)
        # backlash = 2 R (inv alpha_w - inv alpha) for full teeth
        self.alpha = brentq(
            lambda a: 2 * both * (involute(a) - involute(ALPHA)) - self.backlash, ALPHA, 0.6,
            xtol=1e-15,
        )  # fmt: skip
        self.distance = both / math.cos(self.alpha)
        self.length = both * math.tan(self.alpha)
        self.pitch = math.pi * self.module * math.cos(ALPHA)
        rho_tip = [math.sqrt(t**2 - b**2) for t, b in zip(self.tip, self.base, strict=True)]
        self.path = (self.length - rho_tip[1], rho_tip[0])

    def history(self, angles: np.ndarray) -> xr.Dataset:
        """History with one output a second, in which the driving wheel has rolled by `angles`."""
        mode = -1 if self.coast else 1
        wheel, mesh = ("wheel",), ("mesh",)
        # at the start pair 0 touches where the path begins; the coast flanks touch where the
        # driving wheel lags by the backlash
        lag = (self.backlash + self.penetration) / self.base[0] if self.coast else 0.0
        ahead = 0.0 if self.coast else self.penetration / self.base[0]
        turned = np.stack([-(angles + ahead - lag), angles * self.teeth[0] / self.teeth[1]], axis=1)
        rho = self.path[0] + self.base[0] * (angles + ahead - lag)
        n_slots = 6
        force, position, numbers, on_path = (np.zeros((angles.size, n_slots)) for _ in range(4))
        position[:] = np.nan
        for row in range(angles.size):
            for k in range(-40, 40):
                slot = k % 3 + (3 if self.coast else 0)
                along = rho[row] - k * self.pitch
                if self.coast:
                    along = self.base[0] * (2 * self.alpha + self.tooth_angle[0]) - along
                if not self.path[0] <= along <= self.path[1]:
                    continue
                on_path[row, slot], numbers[row, slot] = 1, k
                position[row, slot], force[row, slot] = along, 100.0 + 10.0 * (k % 3)
        total = force.sum(axis=1)
        relief = list(self.relief)
        starts = [
            self.module * z / 2 if amount > 0 else 0.0
            for z, amount in zip(self.teeth, relief, strict=True)
        ]
        integer = np.int32
        speeds = np.tile([-2.0, 2.0 * self.teeth[0] / self.teeth[1]], (angles.size, 1))
        root_b = math.pi + self.alpha - (self.length - self.path[0]) / self.base[1]
        time_mesh, time_pair = ("time", "mesh"), ("time", "mesh", "pair")
        data: dict[str, tuple[tuple[str, ...], Any, str]] = {
            "teeth": (wheel, np.array(self.teeth, dtype=integer), "1"),
            "pitch_radius": (wheel, [self.module * z / 2 for z in self.teeth], "m"),
            "base_radius": (wheel, list(self.base), "m"),
            "tip_radius": (wheel, list(self.tip), "m"),
            "root_radius": (wheel, [(z / 2 - 1.25) * self.module for z in self.teeth], "m"),
            "form_radius": (wheel, [1.002 * b for b in self.base], "m"),
            "active_radius": (
                wheel,
                [
                    math.hypot(self.base[0], self.path[0]),
                    math.hypot(self.base[1], self.length - self.path[1]),
                ],
                "m",
            ),
            "tooth_angle": (wheel, list(self.tooth_angle), "rad"),
            "tip_relief": (wheel, relief, "m"),
            "tip_relief_start": (wheel, starts, "m"),
            "tip_relief_power": (wheel, np.array([r > 0 for r in relief], dtype=integer), "1"),
            "root_relief": (wheel, [0.0, 0.0], "m"),
            "root_relief_start": (wheel, [0.0, 0.0], "m"),
            "root_relief_power": (wheel, np.zeros(2, dtype=integer), "1"),
            "profile_crowning": (wheel, [0.0, 0.0], "m"),
            "centre": (("wheel", "axis"), [[0.0, 0.0], [self.distance, 0.0]], "m"),
            "driving_wheel": (mesh, np.array([0], dtype=integer), "1"),
            "driven_wheel": (mesh, np.array([1], dtype=integer), "1"),
            "flank": (mesh, np.array([1], dtype=integer), "1"),
            "working_pressure_angle": (mesh, [self.alpha], "rad"),
            "base_pitch": (mesh, [self.pitch], "m"),
            "line_of_action_length": (mesh, [self.length], "m"),
            "rho_start_driving": (mesh, [self.path[0]], "m"),
            "rho_start_driven": (mesh, [self.length - self.path[0]], "m"),
            "contact_ratio": (mesh, [(self.path[1] - self.path[0]) / self.pitch], "1"),
            "backlash": (mesh, [self.backlash], "m"),
            "has_coast_flanks": (mesh, np.array([1], dtype=integer), "1"),
            "flank_root_driving": (mesh, [self.alpha - self.path[0] / self.base[0]], "rad"),
            "flank_root_driven": (mesh, [root_b], "rad"),
            "angle": (("time", "wheel"), turned, "rad"),
            "angular_velocity": (("time", "wheel"), speeds, "rad s-1"),
            "centre_displacement": (("time", "wheel", "axis"), np.zeros((angles.size, 2, 2)), "m"),
            "normal_force": (time_mesh, total[:, None], "N"),
            "pairs_in_contact": (time_mesh, (force > 0).sum(axis=1)[:, None].astype(integer), "1"),
            "friction_loss": (time_mesh, 0.01 * total[:, None], "W"),
            "mesh_torque_driving": (time_mesh, self.base[0] * total[:, None] * mode, "N m"),
            "pair_normal_force": (time_pair, force[:, None], "N"),
            "pair_friction_force": (time_pair, self.friction * force[:, None], "N"),
            "pair_position": (time_pair, position[:, None], "m"),
            "pair_contact_pressure": (time_pair, 1e6 * np.sqrt(force[:, None]), "Pa"),
            "pair_on_path": (time_pair, on_path[:, None].astype(integer), "1"),
            "pair_number": (time_pair, numbers[:, None].astype(integer), "1"),
        }  # fmt: skip
        variables = {
            name: (dims, values, {"units": units, "long_name": name, "symbol": name})
            for name, (dims, values, units) in data.items()
        }
        coords = {
            "time": ("time", np.arange(float(angles.size)), {"units": "s"}),
            "wheel": ["pinion", "gear"],
            "mesh": ["pinion-gear"],
            "axis": ["x", "y"],
            "pair": [f"{flank}_{slot}" for flank in ("drive", "coast") for slot in range(3)],
        }
        attributes = {"evolvent_format": 1, "status": "done", "status_message": ""}
        return xr.Dataset(variables, coords=coords, attrs=attributes)


def no_events() -> xr.Dataset:
    """Return an empty group of events."""
    names = ("time", "kind", "mesh", "tooth_pair", "flank")
    types = (float, np.int32, np.int32, np.int32, np.int32)
    return xr.Dataset(
        {name: ("event", np.empty(0, kind)) for name, kind in zip(names, types, strict=True)},
        coords={"event": np.empty(0, np.int32), "side": ["before", "after"]},
    )
