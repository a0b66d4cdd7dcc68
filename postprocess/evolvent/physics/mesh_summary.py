"""What the tooth pairs of each mesh did during a run, in a few numbers."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import xarray as xr

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
    span = float(history["time"][-1] - history["time"][0])
    speed = require(history, "angular_velocity")
    coast = np.array(["coast" in str(pair) for pair in history["pair"].values])
    found = []
    for mesh, name in enumerate(history["mesh"].values):
        one = history.isel(mesh=mesh)
        loaded = require(one, "pair_normal_force").values > 0
        # Number and flank of each pair that carried load.
        flanks = np.broadcast_to(coast, loaded.shape)
        seen = np.stack([require(one, "pair_number").values[loaded], flanks[loaded]])
        count = require(one, "pairs_in_contact").astype(float)
        loss = float(require(one, "friction_loss").integrate("time"))
        driving = speed.isel(wheel=int(require(one, "driving_wheel")))
        handed = abs(float((require(one, "mesh_torque_driving") * driving).integrate("time")))
        found.append(
            MeshSummary(
                name=str(name),
                pairs=np.unique(seen, axis=1).shape[1],
                contact_ratio=float(one["contact_ratio"]) if "contact_ratio" in one else None,
                mean_pairs=float(count.integrate("time")) / span,
                apart=float((count == 0).astype(float).integrate("time")) / span,
                friction_loss=loss,
                efficiency=1 - loss / handed if handed > abs(loss) else None,
            )
        )
    return found
