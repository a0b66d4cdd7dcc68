"""Runs of compliant wheels: invalid combinations, and every model runs."""

from __future__ import annotations

import subprocess
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
import xarray as xr

from gearbox.lanes.lane_cases import CONTACTS

Evolvent = Callable[..., subprocess.CompletedProcess[str]]

CASE = 3
PINION = "wheels.pinion.compliance"
BENDS = f"{PINION}={{}}"
TABLE = PINION + "={model: table, rho: [0.005, 0.03], c: [1.5e-11, 5e-11]}"
COUPLED = "meshes.0.tooth_coupling=true"
LAWS = {
    **{law: ", ".join([law, *(f"{k}: {v}" for k, v in CONTACTS[law].items())]) for law in CONTACTS},
    "rigid": "rigid",
}

# options; part of the message
BAD_OPTIONS = {
    **{
        law: (
            (BENDS, "meshes.0.damping={law: none}", f"meshes.0.contact={{law: {given}}}"),
            "meshes.pinion-gear.contact.law: a wheel with compliance requires contact "
            f"{{law: johnson}}, to which its c is added, not {law}",
        )
        for law, given in LAWS.items()
        if law != "johnson"
    },
    **{
        tracking: (
            (BENDS, f"meshes.0.tracking={tracking}"),
            "meshes.pinion-gear.tracking: a wheel with compliance requires tracking: closed_form",
        )
        for tracking in ("algebraic", "differential")
    },
    "coupling of a tooth alone": (
        (PINION + "={model: analytic}", COUPLED),
        "meshes.pinion-gear.tooth_coupling: a wheel with compliance {model: analytic}, or a table "
        "without c_1, does not include deflections by loads of neighbouring teeth",
    ),
    "coupling of a table without c_1": ((TABLE, COUPLED), "or a table without c_1"),
    "coupling of wheels that do not bend": (
        (COUPLED,),
        "meshes.pinion-gear.tooth_coupling: tooth coupling results from compliant wheels, but "
        "none of these has a compliance",
    ),
    "another word": (
        (BENDS, "meshes.0.tooth_coupling=maybe"),
        "tooth_coupling: must be one of true, false, not 'maybe'",
    ),
}


def settings(*options: str) -> list[str]:
    return [word for option in options for word in ("--set", option)]


@pytest.mark.parametrize(("options", "reason"), BAD_OPTIONS.values(), ids=BAD_OPTIONS)
def test_what_bending_wheels_cannot_have_is_refused(
    evolvent: Evolvent, examples: Path, tmp_path: Path, options: tuple[str, ...], reason: str
) -> None:
    result = evolvent("run", examples / "spur-pair.yaml", *settings(*options))
    assert result.returncode == CASE, result.stderr
    assert result.stdout == ""
    assert result.stderr.count("\n") == 1
    assert reason in result.stderr
    assert list(tmp_path.iterdir()) == []


def test_a_wheel_without_module_cannot_bend(evolvent: Evolvent, examples: Path) -> None:
    result = evolvent("run", examples / "paper.yaml", "--set", "wheels.0.compliance={}")
    assert result.returncode == CASE
    assert "'compliance' needs 'module' in the same block" in result.stderr


@pytest.mark.parametrize(
    "options",
    [
        (BENDS,),
        (BENDS, "wheels.gear.compliance={}", COUPLED),
        (BENDS, "wheels.gear.compliance={}", "meshes.0.tooth_coupling=false"),
        (BENDS, "wheels.gear.compliance={model: none}"),
        (BENDS, "wheels.gear.compliance={model: analytic}"),
        (TABLE,),
        (TABLE.replace("}", ", c_1: [7e-12, 6e-12]}"), COUPLED),
    ],
)
def test_every_model_runs(
    evolvent: Evolvent, examples: Path, tmp_path: Path, options: tuple[str, ...]
) -> None:
    """Its energy balances, and its teeth are softer than those of Johnson's contact alone."""
    error = {}
    for name, given in {"stiff": (), "compliant": options}.items():
        result = evolvent(
            *("run", examples / "spur-pair.yaml", "--set", "simulation.duration=2e-3"),
            *(*settings(*given), "-o", "x.h5"),
        )
        assert result.returncode == 0, result.stderr
        with xr.open_dataset(tmp_path / "x.h5", engine="netcdf4") as run:
            energy = run.kinetic_energy + run.potential_energy + run.dissipated_energy
            rest = (energy - run.load_work).values
            # the tolerance of the integration, of the energy that flows through the mesh
            assert np.abs(rest - rest[0]).max() < 1e-8 * run.load_work.values[-1]
            error[name] = abs(run.transmission_error.values.mean())
    assert error["compliant"] > 1.2 * error["stiff"]


# an example with changes; the note on a mesh whose wheels could be compliant; "": no note
STIFF = {
    "real gears": ("spur-pair.yaml", (), "mesh pinion-gear: only the contact is compliant"),
    "several meshes": ("two-stage-gears.yaml", (), "mesh first and 1 more: only the contact"),
    "one wheel bends": ("spur-pair.yaml", (BENDS,), ""),
    "another law": ("spur-pair.yaml", ("meshes.0.contact={law: yang_lin}",), ""),
    "tracked": ("spur-pair.yaml", ("meshes.0.tracking=algebraic",), ""),
    "no real gears": ("paper.yaml", (), ""),
}


@pytest.mark.parametrize(("case", "options", "said"), STIFF.values(), ids=STIFF)
def test_real_gears_that_do_not_bend_are_told_once_how_they_could(
    evolvent: Evolvent, examples: Path, case: str, options: tuple[str, ...], said: str
) -> None:
    changes = settings(*options, "simulation.duration=1e-4", "simulation.output_interval=1e-4")
    run = evolvent("run", examples / case, *changes, "-o", "x.h5")
    assert run.returncode == 0, run.stderr
    show = evolvent("show", examples / case, *changes)
    for text in (run.stderr, show.stdout):
        assert text.count("only the contact is compliant") == bool(said)
        assert said in text
        assert text.count("'compliance: {}' to its wheels") == bool(said)


def test_more_pairs_than_can_be_coupled_are_refused(evolvent: Evolvent, examples: Path) -> None:
    """Slender teeth of a contact ratio of 4.6: six pairs with their edges, and one in reserve."""
    rack = "{addendum: 2.2, dedendum: 2.45, root_radius: 0.05}"
    slender = [
        f"wheels.{wheel}.{key}={value}"
        for wheel in (0, 1)
        for key, value in (("teeth", 120), ("profile_shift", 0), ("pressure_angle", 14.5))
    ]
    racks = [f"wheels.{wheel}.rack={rack}" for wheel in (0, 1)]
    table = TABLE.replace("}", ", c_1: [7e-12, 6e-12]}")
    options = settings(*slender, *racks, "meshes.0.centre_distance=0.3603", table)
    result = evolvent("run", examples / "spur-pair.yaml", *options)
    assert result.returncode == CASE
    assert "tooth_coupling: at its contact ratio of 4.61389 more tooth pairs" in result.stderr
