"""What must hold of every contact at every output: forces push, and modes agree with the gaps.

A run ends with exit code 4 where it breaks one of these itself; here they are looked at again in
what was written.
"""

from __future__ import annotations

import xarray as xr

from evolvent.history import require

OPEN, LOADED, UNLOADED = 0, 1, 2  # values of `pair_contact_mode`


def pull(history: xr.Dataset) -> xr.DataArray:
    """Force with which flanks pull at each other over the reference force.

    Dims (time, mesh), or (time, mesh, pair) where the history has tooth pairs.
    """
    pairs = "pair_normal_force" in history
    force = require(history, "pair_normal_force" if pairs else "normal_force")
    return (-force).clip(min=0.0) / require(history, "reference_force")


def has_modes(history: xr.Dataset) -> bool:
    """Tell whether a history says the mode of each tooth pair; earlier versions did not."""
    return "pair_contact_mode" in history


def contradiction(history: xr.Dataset) -> xr.DataArray:
    """Penetration of open pairs, gap of pairs in contact, over the reference penetration.

    Force of pairs that count as open or unloaded, over the reference force. The largest of these,
    dims (time, mesh, pair). A rigid contact keeps its gap by another invariant.
    """
    mode, depth = require(history, "pair_contact_mode"), require(history, "pair_penetration")
    elastic = require(history, "rigid_contact") != 1
    touching = (mode == LOADED) | (mode == UNLOADED)
    wrong = (-depth).where(touching & elastic, 0.0) + depth.where(mode == OPEN, 0.0)
    length = wrong.clip(min=0.0) / require(history, "reference_penetration")
    force = abs(require(history, "pair_normal_force")).where(mode != LOADED, 0.0)
    force = force / require(history, "reference_force")
    return length.where(length > force, force).transpose("time", "mesh", "pair")
