"""What must hold of every contact: forces push, modes agree with gaps.

A run ends with exit code 4 where forces pull or modes contradict the gaps; here they are looked at
again in what was written.
"""

from __future__ import annotations

import xarray as xr

from evolvent.history import require
from evolvent.physics.applicable import NotApplicableError
from evolvent.physics.invariant import invariant

OPEN, LOADED, UNLOADED = 0, 1, 2  # values of `pair_contact_mode`


@invariant("pushing", "F_n >= 0", "reference force", 1e-6)
def pull(history: xr.Dataset) -> xr.DataArray:
    """Force with which flanks pull at each other over the reference force.

    Dims (time, mesh), or (time, mesh, pair) where the history has tooth pairs.
    """
    pairs = "pair_normal_force" in history
    force = require(history, "pair_normal_force" if pairs else "normal_force")
    return (-force).clip(min=0.0) / require(history, "reference_force")


@invariant(
    "contact modes",
    "in contact: h >= 0, else F_n = 0, and h <= 0 without tooth coupling",
    "reference penetration or force",
    1e-6,
)
def agreement_of_modes(history: xr.Dataset) -> xr.DataArray:
    """How far gaps and forces of tooth pairs contradict their modes, dims (time, mesh, pair).

    The largest of: penetration of open pairs and gap of pairs in contact, over the reference
    penetration; force of pairs that count as open or unloaded, over the reference force. A rigid
    contact keeps its gap by another invariant. Of teeth that are coupled a pair may overlap and be
    open: its neighbours' loads part its flanks.
    """
    if "pair_contact_mode" not in history:  # earlier versions
        raise NotApplicableError("the history does not tell the modes of its tooth pairs")
    mode, depth = require(history, "pair_contact_mode"), require(history, "pair_penetration")
    elastic = require(history, "rigid_contact") != 1
    touching = (mode == LOADED) | (mode == UNLOADED)
    alone = history["tooth_coupling"] != 1 if "tooth_coupling" in history else True
    wrong = (-depth).where(touching & elastic, 0.0) + depth.where((mode == OPEN) & alone, 0.0)
    length = wrong.clip(min=0.0) / require(history, "reference_penetration")
    force = abs(require(history, "pair_normal_force")).where(mode != LOADED, 0.0)
    force = force / require(history, "reference_force")
    return length.where(length > force, force).transpose("time", "mesh", "pair")
