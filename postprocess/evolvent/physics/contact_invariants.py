"""Contact invariants: no adhesive forces, contact modes consistent with gaps.

A run ends with exit code 4 if forces are adhesive or modes contradict the gaps; here the written
values are checked.
"""

from __future__ import annotations

import numpy as np

from evolvent.history.recording import Part, Recording, Values
from evolvent.physics.applicable import NotApplicableError
from evolvent.physics.invariant import Deviation, invariant

OPEN, LOADED, UNLOADED = 0, 1, 2  # values of `pair_contact_mode`


@invariant("pushing", "F_n >= 0", "reference force", 1e-6)
def pull(run: Recording) -> Deviation:
    """Adhesive (negative) normal force over the reference force.

    Dims (time, mesh), or (time, mesh, pair) if the history has tooth pairs.
    """
    name, reference = "normal_force", run["reference_force"]
    dims: tuple[str, ...] = ("time", "mesh")
    if "pair_normal_force" in run:
        name, dims, reference = "pair_normal_force", (*dims, "pair"), reference[:, np.newaxis]
    return Deviation(dims, lambda part: np.clip(-part[name], 0.0, None) / reference)


@invariant(
    "contact modes",
    "in contact: h >= 0, else F_n = 0, and h <= 0 without tooth coupling",
    "reference penetration or force",
    1e-6,
)
def agreement_of_modes(run: Recording) -> Deviation:
    """Contradiction between modes and gaps or forces of tooth pairs, dims (time, mesh, pair).

    The largest of: penetration of open pairs and gap of pairs in contact, over the reference
    penetration; force of open or unloaded pairs, over the reference force. The gap of a rigid
    contact is covered by another invariant. With coupled teeth a pair may overlap and be open: the
    loads of adjacent pairs separate its flanks.
    """
    if "pair_contact_mode" not in run:  # earlier versions
        raise NotApplicableError(
            "the history does not contain the contact modes of its tooth pairs"
        )

    def of_mesh(values: Values) -> Values:
        return np.asarray(values)[:, np.newaxis]

    elastic = of_mesh(run["rigid_contact"] != 1)
    coupled = run["tooth_coupling"] == 1 if "tooth_coupling" in run else elastic[:, 0] & False
    alone = of_mesh(~coupled)
    depth_of, force_of = of_mesh(run["reference_penetration"]), of_mesh(run["reference_force"])

    def deviation(part: Part) -> Values:
        mode, depth = part["pair_contact_mode"], part["pair_penetration"]
        touching = (mode == LOADED) | (mode == UNLOADED)
        wrong = np.where(touching & elastic, -depth, 0.0)
        wrong = wrong + np.where((mode == OPEN) & alone, depth, 0.0)
        length = np.clip(wrong, 0.0, None) / depth_of
        force = np.where(mode != LOADED, abs(part["pair_normal_force"]), 0.0) / force_of
        return np.asarray(np.where(length > force, length, force))

    return Deviation(("time", "mesh", "pair"), deviation)
