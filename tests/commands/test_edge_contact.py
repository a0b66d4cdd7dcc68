"""Meshes with tip-edge (corner) contact: invalid combinations; no compliance is required."""

from __future__ import annotations

import subprocess
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
import xarray as xr

Evolvent = Callable[..., subprocess.CompletedProcess[str]]

CASE = 3
EDGES = "meshes.0.edge_contact=true"
FIELD = "meshes.pinion-gear.edge_contact: "
BAD_CASES = {
    "another word": (
        ("spur-pair.yaml", "meshes.0.edge_contact=maybe"),
        FIELD + "must be one of true, false, not 'maybe'",
    ),
    "another law": (
        ("spur-pair.yaml", EDGES, "meshes.0.contact={law: linear, stiffness: 1e8}"),
        FIELD + "corner contact requires contact {law: johnson}, not linear",
    ),
    "rigid": (
        ("spur-pair.yaml", EDGES, "meshes.0.contact={law: rigid}", "meshes.0.damping={law: none}"),
        FIELD + "corner contact requires contact {law: johnson}, not rigid",
    ),
    "tracked": (
        ("spur-pair.yaml", EDGES, "meshes.0.tracking=algebraic"),
        FIELD + "corner contact requires tracking: closed_form",
    ),
    "without module": (
        ("paper.yaml", EDGES, "meshes.0.tracking=closed_form"),
        FIELD + "corner contact requires gears with a basic rack; give both wheels a module, "
        "or false",
    ),
}


def settings(*options: str) -> list[str]:
    return [word for option in options for word in ("--set", option)]


@pytest.mark.parametrize(("given", "reason"), BAD_CASES.values(), ids=BAD_CASES)
def test_what_edges_cannot_have_is_refused(
    evolvent: Evolvent, examples: Path, tmp_path: Path, given: tuple[str, ...], reason: str
) -> None:
    result = evolvent("run", examples / given[0], *settings(*given[1:]))
    assert result.returncode == CASE, result.stderr
    assert result.stderr.count("\n") == 1
    assert reason in result.stderr
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize("case", ["spur-pair", "tip-relief", "rattle", "two-stage-gears"])
def test_edges_of_wheels_that_do_not_bend_run(
    evolvent: Evolvent, examples: Path, tmp_path: Path, case: str
) -> None:
    """Johnson's contact alone: pairs touch at flanks and edges, and energy balances."""
    short = ("simulation.duration=3e-3", "simulation.output_interval=1e-5")
    result = evolvent(
        "run", examples / f"{case}.yaml", *settings(EDGES, *short), "-o", "x.h5", "-q"
    )
    assert result.returncode == 0, result.stderr
    with xr.open_dataset(tmp_path / "x.h5", engine="netcdf4") as run:
        assert np.unique(run.pair_contact_kind).tolist() == [0, 1, 2]  # none, flanks, an edge
        energy = run.kinetic_energy + run.potential_energy + run.dissipated_energy
        rest = (energy - run.load_work).values
        # the tolerance of the integration, of the energy that flows through the mesh
        assert np.abs(rest - rest[0]).max() < 1e-8 * np.abs(run.load_work).max()
