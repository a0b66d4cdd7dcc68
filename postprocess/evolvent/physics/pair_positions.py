"""Contact position of a mesh's tooth pairs at a time: pair, and position on the path of contact."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import xarray as xr

NEEDS = ("pair_normal_force", "pair_number", "pair_position")


@dataclass(frozen=True)
class PairPosition:
    """Contact position of a tooth pair."""

    number: int  # of the tooth pair, pitches since the start
    is_coast: bool
    on_path: float  # 0 at the start of the path of contact, 1 at its end
    roll_angle: float  # radius of curvature of the driving flank over its base radius [rad]

    def text(self) -> str:
        """Describe the position in words."""
        flank = " of the coast flanks" if self.is_coast else ""
        if 0.0 <= self.on_path <= 1.0:
            position = f"at {100 * self.on_path:.0f} % of the path"
        elif self.on_path < 0.0:
            position = "before the path"
        else:
            position = "behind the path"
        return (
            f"tooth pair {self.number}{flank}, {position} (roll angle "
            f"{np.degrees(self.roll_angle):.3g}°)"
        )


def position_of_pair(
    history: xr.Dataset, mesh: int, time: float, output: str = "pair_normal_force"
) -> PairPosition | None:
    """Find the loaded tooth pair of a mesh with the largest value of an output, and its position.

    The pair is that of the nearest output with a value; its position is interpolated between two
    outputs that both contain it. None if no pair has a value other than 0, or the history has no
    tooth pairs.

    Parameters
    ----------
    time : [s].
    output : of tooth pairs, dims (time, mesh, pair); for other outputs the forces are used.
    """
    if not all(name in history for name in (*NEEDS, "base_pitch")):
        return None
    if "pair" not in history[output].dims:
        output = "pair_normal_force"
    times = history["time"].values
    behind = int(np.clip(np.searchsorted(times, time), 1, max(times.size - 1, 1)))
    rows = sorted({behind - 1, min(behind, times.size - 1)}, key=lambda r: abs(times[r] - time))
    for row in rows:
        carries = history["pair_normal_force"][row, mesh].values > 0
        size = np.where(carries, np.nan_to_num(np.abs(history[output][row, mesh].values)), 0.0)
        slot = int(np.argmax(size))
        if size[slot] > 0:
            break
    else:
        return None
    around = history.isel(time=slice(behind - 1, behind + 1), mesh=mesh, pair=slot)
    number = int(history["pair_number"][row, mesh, slot])
    positions = around["pair_position"].values
    if (around["pair_number"].values == number).all() and np.isfinite(positions).all():
        rho = float(np.interp(time, around["time"].values, positions))
    else:
        rho = float(history["pair_position"][row, mesh, slot])
    return _position(history, mesh, slot, number, rho) if np.isfinite(rho) else None


def _position(history: xr.Dataset, mesh: int, slot: int, number: int, rho: float) -> PairPosition:
    ratio = float(history["contact_ratio"][mesh]) if "contact_ratio" in history else 1.0
    start, length = (float(history[name][mesh]) for name in ("rho_start_driving", "base_pitch"))
    wheel = int(history["driving_wheel"][mesh])
    return PairPosition(
        number,
        str(history["pair"].values[slot]).startswith("coast"),
        (rho - start) / (ratio * length),
        rho / float(history["base_radius"][wheel]),
    )
