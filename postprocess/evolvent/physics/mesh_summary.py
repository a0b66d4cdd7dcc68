"""Key figures of the tooth pairs of each mesh over a run."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from evolvent.history.recording import Part, Recording, Values, integral, recording_of
from evolvent.units import quantity

if TYPE_CHECKING:
    import xarray as xr


@dataclass(frozen=True)
class MeshSummary:
    """Key figures of one mesh over a run; None if the run does not give one."""

    name: str
    pairs: int  # distinct tooth pairs that carried load, on both flanks
    contact_ratio: float | None  # path of contact over base pitch
    mean_pairs: float | None  # loaded tooth pairs, mean over time: the effective contact ratio
    apart: float | None  # share of the time without contact
    friction_loss: float | None  # energy [J]
    efficiency: float | None  # 1 - friction loss over the energy that the driving wheel transmitted

    def texts(self) -> list[tuple[str, str]]:
        """Names and values as text."""

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


def mesh_summaries(history: xr.Dataset | Recording) -> list[MeshSummary]:
    """Summarise every mesh; empty for a history without tooth pairs or with less than two outputs.

    Means over time and energies are by the trapezoidal rule over the recorded outputs; they do not
    include what happens between two outputs.

    Parameters
    ----------
    history : with pair_normal_force, pair_number (time, mesh, pair), pairs_in_contact,
        friction_loss [W] and mesh_torque_driving [N m] (time, mesh).
    """
    run = recording_of(history)
    if "pair_normal_force" not in run or run.n < 2:
        return []
    span = float(run["time"][-1] - run["time"][0])
    driving = run["driving_wheel"].astype(int)

    def power(part: Part) -> Values:
        return np.asarray(part["mesh_torque_driving"] * part["angular_velocity"][:, driving])

    losses = integral(run, lambda part: part["friction_loss"])
    handed = abs(integral(run, power))
    counts = integral(run, lambda part: part["pairs_in_contact"])
    apart = integral(run, lambda part: part["pairs_in_contact"] == 0)
    pairs = _loaded_pairs(run)
    return [
        MeshSummary(
            name=name,
            pairs=len(pairs[mesh]),
            contact_ratio=float(run["contact_ratio"][mesh]) if "contact_ratio" in run else None,
            mean_pairs=float(counts[mesh]) / span,
            apart=float(apart[mesh]) / span,
            friction_loss=float(losses[mesh]),
            efficiency=_efficiency(float(losses[mesh]), float(handed[mesh])),
        )
        for mesh, name in enumerate(run.labels("mesh"))
    ]


def _efficiency(loss: float, handed: float) -> float | None:
    return 1 - loss / handed if handed > abs(loss) else None


def _loaded_pairs(run: Recording) -> list[set[tuple[int, bool]]]:
    """Numbers of the loaded pairs of each mesh, and whether they are of the coast flanks."""
    coast = np.array(["coast" in pair for pair in run.labels("pair")])
    found: list[set[tuple[int, bool]]] = [set() for _ in run.labels("mesh")]
    for part in run.parts():
        loaded, numbers = part["pair_normal_force"] > 0, part["pair_number"]
        for mesh, seen in enumerate(found):
            for flank in (False, True):
                which = loaded[:, mesh] & (coast == flank)
                seen |= {(int(n), flank) for n in np.unique(numbers[:, mesh][which])}
    return found
