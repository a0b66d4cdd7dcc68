"""Loads and root stresses of each tooth of a wheel over some outputs of a history."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from evolvent.history.recording import Recording

Values = NDArray[np.float64]
Integers = NDArray[np.int64]
RIGHT, LEFT = 0, 1  # flanks and fillets of a tooth; the right flank faces counterclockwise
SIDES = ("right", "left")

# Stress of both fillets of a tooth at all arcs under unit line loads, shape (n, 2, arcs).
Influence = Callable[[ArrayLike, ArrayLike, ArrayLike], Values]


@dataclass(frozen=True)
class ToothLoads:
    """Forces of all loaded tooth pairs of a wheel, each in one output."""

    n_rows: int  # outputs
    teeth: int  # of the wheel
    rows: Integers  # output of each force
    tooth: Integers  # loaded, from 0, counterclockwise
    flank: Integers  # RIGHT or LEFT
    rho: Values  # radius of curvature of the flank at the contact [m]
    force: Values  # normal force [N]
    line_load: Values  # over the common width of the mesh [N/m]
    pressure: Values  # largest contact pressure [Pa]; NaN where it is undefined or not recorded

    def of_rows(self, kept: Integers) -> ToothLoads:
        """Loads of some outputs, by their ascending indices."""
        position = np.full(self.n_rows, -1)
        position[kept] = np.arange(kept.size)
        own = position[self.rows] >= 0
        return ToothLoads(
            kept.size,
            self.teeth,
            position[self.rows[own]],
            self.tooth[own],
            self.flank[own],
            self.rho[own],
            self.force[own],
            self.line_load[own],
            self.pressure[own],
        )

    def forces(self, tooth: int) -> Values:
        """Normal force of both flanks of a tooth, shape (outputs, 2) [N]."""
        return self._of_flanks(tooth, self.force)

    def pressures(self, tooth: int) -> Values:
        """Largest contact pressure of both flanks of a tooth, shape (outputs, 2) [Pa]."""
        return self._of_flanks(tooth, np.nan_to_num(self.pressure))

    def _of_flanks(self, tooth: int, values: Values) -> Values:
        found = np.zeros((self.n_rows, 2))
        own = self.tooth == tooth
        np.maximum.at(found, (self.rows[own], self.flank[own]), values[own])
        return found

    def stresses(self, tooth: int, influence: Influence) -> Values:
        """Root stress of a tooth at all arcs of both fillets, shape (outputs, 2, arcs) [Pa].

        Loads on all teeth of the wheel count. Equations LS1, RS3.
        """
        at_unit_load = influence(self.flank, self.rho, self.tooth - tooth)
        found = np.zeros((self.n_rows, *at_unit_load.shape[1:]))
        np.add.at(found, self.rows, self.line_load[:, None, None] * at_unit_load)
        return found


def tooth_loads(run: Recording, wheel: int) -> ToothLoads:
    """Collect the forces of the tooth pairs of a wheel in all meshes.

    Parameters
    ----------
    run : some outputs of a history.
    wheel : its index.

    Raises
    ------
    HistoryError
        The history has no outputs of tooth pairs.
    """
    columns: list[tuple[ArrayLike, ...]] = []
    force, on_driving = run["pair_normal_force"], run["pair_position"]
    is_coast = np.array([name.startswith("coast") for name in run.labels("pair")])
    is_known = "pair_contact_pressure" in run
    pressures = run["pair_contact_pressure"] if is_known else np.full(force.shape, np.nan)
    for mesh in range(force.shape[1]):
        ends = [int(run[name][mesh]) for name in ("driving_wheel", "driven_wheel")]
        if wheel not in ends:
            continue
        side = ends.index(wheel)
        rho = on_driving[:, mesh]
        if side == 1:
            rho = lines(run, mesh, ends)[:, None] + run["pair_penetration"][:, mesh] - rho
        of_pairs = run[("pair_tooth_driving", "pair_tooth_driven")[side]][:, mesh]
        rows, slots = np.nonzero(force[:, mesh] > 0.0)
        sigma = np.where(is_coast, -1, 1) * int(run["flank"][mesh])
        own = force[rows, mesh, slots]
        columns.append(
            (
                rows,
                of_pairs[rows, slots],
                np.where(sigma * float(run["base_radius"][wheel]) > 0, LEFT, RIGHT)[slots],
                rho[rows, slots],
                own,
                own / float(run["common_width"][mesh]),
                pressures[rows, mesh, slots],
            )
        )
    kinds = (int, int, int, float, float, float, float)
    joined = [
        np.concatenate([np.asarray(one[i], dtype=kind) for one in columns] or [np.zeros(0, kind)])
        for i, kind in enumerate(kinds)
    ]
    return ToothLoads(run.n, abs(int(run["teeth"][wheel])), *joined)


def lines(run: Recording, mesh: int, wheels: list[int]) -> Values:
    """Length of the line of action of a mesh in all outputs [m]; negative for an internal pair."""
    a, b = wheels
    centre = run["centre"]
    between = np.broadcast_to(centre[b] - centre[a], (run.n, 2))
    if "centre_displacement" in run:
        moved = run["centre_displacement"]
        between = between + moved[:, b] - moved[:, a]
    radii = run["base_radius"][a] + run["base_radius"][b]
    return np.asarray(np.sign(radii) * np.sqrt((between**2).sum(axis=1) - radii**2))
