"""What the tooth pairs of each mesh did during a run, in a few numbers."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import xarray as xr
from scipy.integrate import trapezoid

from evolvent.history import require
from evolvent.units import quantity


@dataclass(frozen=True)
class MeshSummary:
    """Numbers of one mesh over a run; None where the run gives no such number."""

    name: str
    pairs: int  # different tooth pairs that carried load, on both flanks
    contact_ratio: float | None  # path of contact over base pitch
    mean_pairs: float | None  # loaded tooth pairs, mean over time: the contact ratio seen
    apart: float | None  # share of the time without contact
    friction_loss: float | None  # energy [J]
    efficiency: float | None  # 1 - friction loss over the energy that the driving wheel handed over

    def texts(self) -> list[tuple[str, str]]:
        """Names and values as they are read."""

        def number(value: float | None, digits: int = 4) -> str:
            return "-" if value is None else f"{value:.{digits}g}"

        loss = "-" if self.friction_loss is None else quantity(self.friction_loss, "J", 4)
        return [
            ("tooth pairs that carried load", str(self.pairs)),
            ("contact ratio of the geometry", number(self.contact_ratio)),
            ("mean number of loaded pairs", number(self.mean_pairs)),
            ("share of time without contact", number(self.apart)),
            ("energy lost to friction", loss),
            ("efficiency", number(self.efficiency, 6)),
        ]


def mesh_summaries(history: xr.Dataset) -> list[MeshSummary]:
    """Sum up every mesh; empty for a history without tooth pairs or with less than two outputs.

    Means over time and energies are by the trapezoidal rule over the recorded outputs, so what
    happens between two outputs is not in them.

    Parameters
    ----------
    history : with pair_normal_force, pair_number (time, mesh, pair), pairs_in_contact,
        friction_loss [W] and mesh_torque_driving [N m] (time, mesh).
    """
    if "pair_normal_force" not in history or history.sizes["time"] < 2:
        return []
    time = history["time"].values
    span = float(time[-1] - time[0])
    speed = require(history, "angular_velocity").values
    found = []
    for mesh, name in enumerate(history["mesh"].values):
        loaded = require(history, "pair_normal_force").values[:, mesh] > 0
        numbers = require(history, "pair_number").values[:, mesh]
        flanks = ["coast" in str(pair) for pair in history["pair"].values]
        seen = {
            (flanks[place], int(number))
            for place in range(len(flanks))
            for number in np.unique(numbers[loaded[:, place], place])
        }
        count = require(history, "pairs_in_contact").values[:, mesh].astype(float)
        loss = float(trapezoid(require(history, "friction_loss").values[:, mesh], time))
        wheel = int(require(history, "driving_wheel")[mesh])
        torque = require(history, "mesh_torque_driving").values[:, mesh]
        handed = abs(float(trapezoid(torque * speed[:, wheel], time)))
        ratio = history["contact_ratio"].values[mesh] if "contact_ratio" in history else None
        found.append(
            MeshSummary(
                name=str(name),
                pairs=len(seen),
                contact_ratio=None if ratio is None else float(ratio),
                mean_pairs=float(trapezoid(count, time)) / span,
                apart=float(trapezoid((count == 0).astype(float), time)) / span,
                friction_loss=loss,
                efficiency=1 - loss / handed if handed > abs(loss) else None,
            )
        )
    return found
