"""Loads without a contact pressure: corner contact of sharp tip edges, and concave flanks."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from evolvent.units import quantity

if TYPE_CHECKING:
    import xarray as xr

FORCE = "pair_normal_force"
PRESSURE = "pair_contact_pressure"  # NaN on sharp tip edges and concave flanks
KIND = "pair_contact_kind"  # 0 flank on flank, 1 and 2 tip edges
ON_EDGE = "corner contact, no rounding given: pressure undefined, force {}"
ON_FLANK = "concave flanks: pressure undefined, force {}"
ANYWHERE = "sharp tip edges or concave flanks: pressure undefined, force {}"


def undefined_forces(
    force: np.ndarray, pressure: np.ndarray, kind: np.ndarray | None
) -> np.ndarray:
    """Largest forces of tooth pairs without a contact pressure.

    Parameters
    ----------
    force, pressure : pair_normal_force [N], pair_contact_pressure [Pa], dims (time, mesh, pair).
    kind : pair_contact_kind; None if unknown.

    Returns
    -------
    Of tip edges, of flanks, of either if the kinds are unknown, dims (mesh, 3) [N].
    """
    bare = np.where((force > 0) & np.isnan(pressure), force, 0.0)
    nothing = np.zeros(force.shape)
    if kind is not None:
        on_edge = kind > 0
        groups = (np.where(on_edge, bare, 0.0), np.where(on_edge, 0.0, bare), nothing)
    else:
        groups = (nothing, nothing, bare)
    return np.stack([np.max(of, axis=(0, 2), initial=0.0) for of in groups], axis=-1)


def note_of_history(history: xr.Dataset, mesh: int) -> str:
    """Text as of `note_of` for one mesh of a history in memory."""
    one = history.isel(mesh=[mesh])
    if FORCE not in one or PRESSURE not in one:
        return ""
    kind = one[KIND].values if KIND in one else None
    return note_of(undefined_forces(one[FORCE].values, one[PRESSURE].values, kind)[0])


def note_of(forces: np.ndarray) -> str:
    """Text beside a largest pressure that leaves these forces of one mesh out; "" for none."""
    texts = (ON_EDGE, ON_FLANK, ANYWHERE)
    return "; ".join(
        text.format(quantity(float(force), "N", 3))
        for text, force in zip(texts, forces, strict=True)
        if force > 0
    )
