"""Histories of selected variables: those named in the case, with unchanged values."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
import xarray as xr

from commands.conftest import Evolvent
from evolvent import check_history, open_history

SHORT = ("--set", "simulation.duration=0.05")
# Closed form by radau, in lanes; tracked points by IDA, state by state.
CASES = {
    "closed form": ("paper-friction.yaml", "--set", "meshes.0.tracking=closed_form"),
    "tracked": ("paper.yaml", "--set", "meshes.0.tracking=differential"),
    "by position": (
        "spur-pair.yaml",
        "--set",
        "simulation={duration: 0.01, output: {per_pitch: 20, mesh: pinion-gear}}",
    ),
    "shafts": ("two-stage-gears.yaml", "--set", "simulation.output_interval=1e-3"),
}
EVERY_CASE = pytest.mark.parametrize("case", CASES.values(), ids=CASES)


def history(
    evolvent: Evolvent, examples: Path, path: Path, case: tuple[str, ...], *more: str
) -> xr.Dataset:
    """Run an example for a short time."""
    short = () if any("simulation={" in word for word in case) else SHORT
    words = ("run", examples / case[0], "-o", path, "-q", *case[1:], *short, *more)
    done = evolvent(*words)
    assert done.returncode == 0, done.stderr
    with xr.open_dataset(path, engine="h5netcdf", decode_times=False) as opened:
        return opened.load()


def over_time(opened: xr.Dataset) -> set[str]:
    return {str(name) for name in opened.data_vars if "time" in opened[name].dims}


@EVERY_CASE
def test_a_history_has_what_the_case_names_and_all_that_is_constant(
    evolvent, examples, tmp_path, case
):
    whole = history(evolvent, examples, tmp_path / "whole.h5", case)
    grid = over_time(whole) & {"output_position", "output_kind"}
    words = "energies, angular_velocity,pair_normal_force bearings"
    some = history(evolvent, examples, tmp_path / "some.h5", case, "--outputs", words)
    energies = {f"{kind}_energy" for kind in ("kinetic", "potential", "dissipated")}
    bearings = {"bearing_force", "bearing_moment"} & over_time(whole)
    named = {*energies, "load_work", "angular_velocity", "pair_normal_force"}
    assert over_time(some) == named | bearings | grid
    assert set(whole.data_vars) - over_time(whole) == set(some.data_vars) - over_time(some)
    for name in some.data_vars:
        # in lanes they may differ by rounding: sums of energies and forces that cancel
        scale = float(abs(whole[name]).max()) if whole[name].dtype.kind == "f" else 0.0
        np.testing.assert_allclose(
            some[name], whole[name], rtol=1e-12, atol=1e-12 * scale, err_msg=str(name)
        )


def test_each_group_is_known_and_all_of_them_are_all(evolvent, examples, tmp_path):
    case = CASES["closed form"]
    whole = history(evolvent, examples, tmp_path / "whole.h5", case)
    known = "gearbox wheels meshes pairs shafts bearings housing accelerometers"
    refused = evolvent(
        "run", examples / "paper.yaml", "--set", "simulation.outputs=nothing-like-it"
    ).stderr
    assert f"groups are all {known} energies losses forces tracking check, " in refused
    groups = known.replace(" ", ",")
    some = history(evolvent, examples, tmp_path / "some.h5", case, "--outputs", groups)
    assert some.identical(whole.assign_attrs(case=some.attrs["case"]))
    named = "energies,losses,forces,tracking"
    few = history(evolvent, examples, tmp_path / "few.h5", case, "--outputs", named)
    assert set() < over_time(few) < over_time(whole)


CHECKED = {
    **CASES,
    "rigid": ("paper-rigid.yaml",),
    "coupled teeth": ("compliant-pair.yaml",),
    "prescribed housing": (
        "paper.yaml",
        "--set",
        "housing={kind: prescribed, rotation: [{kind: rate, axis: z, value: 5}]}",
    ),
}


@pytest.mark.parametrize("case", CHECKED.values(), ids=CHECKED)
def test_a_history_of_the_group_check_is_checked_as_the_whole_one(
    evolvent, examples, tmp_path, case
):
    found = []
    for words in ((), ("--outputs", "check")):
        history(evolvent, examples, tmp_path / "checked.h5", case, *words)
        with open_history(tmp_path / "checked.h5") as opened:
            found.append(check_history(opened))
    whole, some = found
    assert [(row.invariant.name, row.verdict) for row in whole] == [
        (row.invariant.name, row.verdict) for row in some
    ]


def test_the_case_in_a_history_of_some_variables_gives_it_again(evolvent, examples, tmp_path):
    first = history(
        evolvent, examples, tmp_path / "a.h5", CASES["closed form"], "--outputs", "energies"
    )
    (tmp_path / "again.yaml").write_text(first.attrs["case"])
    evolvent("run", str(tmp_path / "again.yaml"), "-o", str(tmp_path / "b.h5"), "-q")
    assert (tmp_path / "a.h5").read_bytes() == (tmp_path / "b.h5").read_bytes()


@pytest.mark.parametrize(
    ("words", "said"),
    [
        ("enrgies", "unknown output or group 'enrgies' (did you mean 'energies'?)"),
        ("energies,gapp", "unknown output or group 'gapp' (did you mean 'gap'?)"),
        ("' , '", "names no output; omit it, or give all"),
    ],
)
def test_a_name_that_is_none_is_refused_with_what_was_meant(evolvent, examples, words, said):
    case = str(examples / "paper.yaml")
    for command in ("run", "validate"):
        setting = ("--set", f"simulation.outputs={words}")
        ended = evolvent(command, case, *setting)
        assert ended.returncode == 3
        assert "simulation.outputs: " + said in ended.stderr
        assert len(ended.stderr.splitlines()) == 1
