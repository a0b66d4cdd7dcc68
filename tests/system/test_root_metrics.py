"""Metrics of the root stress: extremes inside steps, their static reference, and who gets them."""

from __future__ import annotations

import json
import re
import subprocess
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
import xarray as xr

from commands.test_root_stress import slow_train
from designs import read_folder, write_design

Evolvent = Callable[..., subprocess.CompletedProcess[str]]

ROOTS = "root_stress_max,root_stress_min"
METRICS = (
    "root_stress_max",
    "root_stress_min",
    "root_stress_range",
    "root_stress_dynamic_factor",
)
TORQUE = 10.0  # of `slow_train` [N m]
PINION, GEAR = "pinion", "gear"


def run_of(evolvent: Evolvent, folder: Path, case: Path | str, *settings: str) -> xr.Dataset:
    """The history of a case, a path or a text."""
    if isinstance(case, str):
        (folder / "case.yaml").write_text(case)
        case = folder / "case.yaml"
    given = [word for setting in settings for word in ("--set", setting)]
    done = evolvent("run", case, "-q", "-o", folder / "run.h5", *given)
    assert done.returncode == 0, done.stderr
    with xr.open_dataset(folder / "run.h5", engine="h5netcdf") as file:
        return file.load()


@pytest.fixture
def short(examples: Path) -> str:
    """The compliant pair over 8 ms, with metrics of its last 5 ms and the root stress."""
    text = (examples / "compliant-pair.yaml").read_text()
    assert "duration: 50 ms" in text
    return text.replace(
        "duration: 50 ms", f"duration: 8 ms\n  metrics: {{from: 3 ms}}\n  outputs: {ROOTS}"
    )


def window(run: xr.Dataset, name: str) -> np.ndarray:
    """A metric of all wheels."""
    return run[f"window_{name}"].values


def test_a_slow_run_has_the_extremes_of_static(evolvent: Evolvent, tmp_path: Path) -> None:
    text = slow_train(40, 120.4)
    period = re.search(r"duration: ([\d.]+) s", text)
    assert period is not None
    text = text.replace(
        period[0], f"duration: {3.2 * float(period[1])} s\n  metrics: {{from: 0 s}}"
    )
    run = run_of(evolvent, tmp_path, text)
    words = ("--torque", repr(TORQUE), "--json", "-o", tmp_path / "static.h5")
    static = json.loads(evolvent("static", tmp_path / "case.yaml", *words).stdout)
    for wheel, side in enumerate(("driving", "driven")):
        for kind in ("max", "min"):
            expected = static[f"root_stress_{kind}_{side}"][0]
            assert window(run, f"root_stress_{kind}")[wheel] == pytest.approx(expected, rel=1e-4)
    np.testing.assert_allclose(window(run, "root_stress_dynamic_factor"), 1, rtol=1e-4)


def test_extremes_do_not_depend_on_outputs_and_integrator(
    evolvent: Evolvent, tmp_path: Path, short: str
) -> None:
    one = run_of(evolvent, tmp_path, short)
    coarse = run_of(evolvent, tmp_path, short, "simulation.output_interval=1 ms")
    fine = "simulation.accuracy=1e-7"
    radau = run_of(evolvent, tmp_path, short, fine)
    ida = run_of(evolvent, tmp_path, short, fine, "simulation.integrator=ida")
    dense = run_of(evolvent, tmp_path, short, fine, "simulation.output_interval=0.2 us")
    inside = (dense.time >= dense.window_begin) & (dense.time <= dense.window_end)
    for name in METRICS:
        np.testing.assert_array_equal(window(coarse, name), window(one, name))
        np.testing.assert_allclose(window(ida, name), window(radau, name), rtol=1e-4)
        np.testing.assert_allclose(window(one, name), window(radau, name), rtol=2e-3)
    for kind, sign in (("max", 1), ("min", -1)):
        seen = sign * (sign * dense[f"root_stress_{kind}"][inside]).max("time").values
        gain = sign * (window(dense, f"root_stress_{kind}") - seen) / abs(seen)
        assert (gain > -1e-9).all()
        assert (gain < 1e-4).all()


def test_metrics_are_only_computed_on_request(
    evolvent: Evolvent, tmp_path: Path, short: str
) -> None:
    asked = run_of(evolvent, tmp_path, short, f"simulation.outputs=all,{ROOTS}")
    plain = run_of(evolvent, tmp_path, short, "simulation.outputs=all")
    assert not [name for name in plain.variables if "root_stress" in str(name)]
    assert [f"window_{name}" in asked for name in METRICS] == [True] * len(METRICS)
    for name in plain.data_vars:  # the same bits
        np.testing.assert_array_equal(asked[name], plain[name])


def test_metrics_are_mirrored_by_rotation_and_order_of_wheels(
    evolvent: Evolvent, tmp_path: Path
) -> None:
    def fast(text: str) -> str:
        text = re.sub(r"value: (-?)0\.0002 rad/s", r"value: \g<1>60 rad/s", text)
        return re.sub(r"duration: [\d.]+ s", "duration: 8 ms\n  metrics: {from: 1 ms}", text)

    one = run_of(evolvent, tmp_path, fast(slow_train(40, 120.4)))
    turned = run_of(evolvent, tmp_path, fast(slow_train(40, 120.4, sense=1)))
    order = run_of(evolvent, tmp_path, fast(slow_train(40, 120.4, order="ba")))
    for name in METRICS:
        expected = one[f"window_{name}"].values
        assert np.isfinite(expected).all()
        for other in (turned, order):
            found = other[f"window_{name}"].sel(wheel=["a", "b"]).values
            np.testing.assert_allclose(found, expected, rtol=1e-4)
    assert (window(one, "root_stress_dynamic_factor") > 1.001).all()


def slow(teeth: int, distance: float, n: int, pitches: float = 3.2) -> str:
    """A slow train with metrics of whole pitches."""
    text = slow_train(teeth, distance, n)
    period = re.search(r"duration: ([\d.]+) s", text)
    assert period is not None
    duration = pitches * float(period[1])
    return text.replace(period[0], f"duration: {duration!r} s\n  metrics: {{from: 0 s}}")


@pytest.mark.parametrize("flanks", ["drive", "coast"])
@pytest.mark.parametrize(("teeth", "distance"), [(40, 120.4), (19, 57.3)])
def test_the_wheels_of_a_slow_train_have_the_dynamic_factor_1(
    evolvent: Evolvent, tmp_path: Path, teeth: int, distance: float, flanks: str
) -> None:
    """An idler's reference includes the loads of its other mesh: up to 1e-3 of its stress."""
    text = slow(teeth, distance, 3)
    if flanks == "coast":  # the torque reversed; without a steady start
        speeds = "initial: {kind: speeds, speeds: {a: -0.0002, b: 0.0002, c: -0.0002}}"
        text = text.replace(f"value: -{TORQUE} N m", f"value: {TORQUE} N m")
        text = text.replace("metrics: {from: 0 s}", "metrics: {from: 400 s}")
        text = text.replace("initial: {kind: steady}", speeds)
    run = run_of(evolvent, tmp_path, text)
    assert (run["window_share_coast_flanks"] == (flanks == "coast")).all()
    np.testing.assert_allclose(window(run, "root_stress_dynamic_factor"), 1, rtol=1e-4)


def test_the_fillets_of_an_idler_are_stressed_in_both_directions(
    evolvent: Evolvent, tmp_path: Path
) -> None:
    """A point has the tension by one mesh and the compression by the other one."""
    run = run_of(evolvent, tmp_path, slow(40, 120.4, 3))
    metric = {name: run[f"window_{name}"] for name in METRICS}
    whole = metric["root_stress_max"] - metric["root_stress_min"]
    share = (metric["root_stress_range"] / whole).sel(wheel=["a", "b", "c"]).values
    # tension and compression of a fillet are largest at nearly the same point
    assert share[1] == pytest.approx(1, abs=2e-3)
    assert share[1] <= 1 + 1e-9
    # pulsating: compression by the own load, and a little tension by that of a neighbour
    assert share[0] == pytest.approx(share[2], rel=1e-4)
    assert 1 < float(metric["root_stress_range"][0] / -metric["root_stress_min"][0]) < 1.15


def test_the_range_is_that_of_the_load_cycles(
    evolvent: Evolvent, executable: Path, examples: Path, tmp_path: Path
) -> None:
    """Of the most stressed point of a tooth in a revolution: counted from the outputs."""
    from evolvent.library import binding
    from evolvent.physics.load_spectrum import load_spectra

    asked = f"simulation.outputs=pairs,angle,centre_displacement,{ROOTS}"
    settings = (asked, "simulation.duration=45 ms", "simulation.metrics={from: 3 ms}")
    case = examples / "compliant-pair.yaml"
    run = run_of(evolvent, tmp_path, case, *settings, "simulation.output_interval=2.5 us")
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv(binding.VARIABLE, str(executable.resolve().with_name(binding.NAME)))
        binding.load.cache_clear()
        (spectrum,) = load_spectra(run, [PINION])
    binding.load.cache_clear()
    found = float(run["window_root_stress_range"].sel(wheel=PINION))
    assert spectrum.worst_root is not None
    assert found == pytest.approx(spectrum.worst_root.size, rel=5e-4)


def test_ranges_include_the_same_bits_with_and_without_cache_and_in_other_units(
    evolvent: Evolvent, tmp_path: Path, short: str
) -> None:
    cached, bare, scaled = (tmp_path / name for name in ("cached", "bare", "scaled"))
    for folder in (cached, bare, scaled):
        folder.mkdir()
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("EVOLVENT_CACHE", str(tmp_path / "cache"))
        run_of(evolvent, cached, short)  # writes the cache
        one = run_of(evolvent, cached, short)
        patch.setenv("EVOLVENT_CACHE", "off")
        two = run_of(evolvent, bare, short)
        in_units = short.replace("module: 3 mm", "module: 0.3 cm").replace("206 GPa", "206e3 MPa")
        assert in_units != short
        three = run_of(evolvent, scaled, in_units)
    for name in METRICS:
        np.testing.assert_array_equal(window(two, name), window(one, name))
        np.testing.assert_allclose(window(three, name), window(one, name), rtol=1e-9)
    for kind in ("max", "min"):
        np.testing.assert_array_equal(two[f"root_stress_{kind}"], one[f"root_stress_{kind}"])


def test_rattling_flanks_have_finite_extremes(
    evolvent: Evolvent, tmp_path: Path, examples: Path
) -> None:
    """Loads on drive and coast flanks, and none in between."""
    text = (examples / "rattle.yaml").read_text()
    text = text.replace("width: 0.02", "width: 0.02\n  bore: 0.02\n  compliance: {}")
    short = ("simulation.duration=0.06", "simulation.output_interval=1.0e-5")
    asked = f"simulation.outputs={ROOTS},coast_force,normal_force"
    run = run_of(evolvent, tmp_path, text, *short, asked, "simulation.metrics={from: 0.01}")
    inside = (run.time >= run.window_begin) & (run.time <= run.window_end)
    assert (run["coast_force"][inside] > 0).any()
    assert ((run["coast_force"] == 0) & (run["normal_force"] > 0)).any()
    ranges = window(run, "root_stress_range")
    assert (ranges >= window(run, "root_stress_max") * (1 - 1e-4)).all()
    assert (
        ranges <= (window(run, "root_stress_max") - window(run, "root_stress_min")) * (1 + 1e-4)
    ).all()
    at_rest = (run["root_stress_max"][inside] == 0) & (run["root_stress_min"][inside] == 0)
    assert at_rest.any()
    for kind, sign in (("max", 1), ("min", -1)):
        assert np.isfinite(run[f"root_stress_{kind}"]).all()
        seen = (sign * run[f"root_stress_{kind}"][inside]).max("time").values
        found = sign * window(run, f"root_stress_{kind}")
        assert (found >= seen * (1 - 1e-9)).all()
        assert (found < 1.1 * seen).all()


# ---- batches


def batch(
    evolvent: Evolvent, folder: Path, case: str, metrics: str, **options: str
) -> subprocess.CompletedProcess[str]:
    """Run a batch of two torques."""
    columns = {"wheels.pinion.loads.0.value": [-100.0, -90.0]}
    write_design(folder / "design.h5", columns, case, numbers=metrics, **options)
    return evolvent("batch", folder / "design.h5", "-o", folder / "r")


def test_a_plan_names_what_its_case_does_not(
    evolvent: Evolvent, tmp_path: Path, short: str
) -> None:
    run = run_of(evolvent, tmp_path, short)
    case = short.replace(f"\n  outputs: {ROOTS}", "")
    assert "root_stress" not in case
    done = batch(
        evolvent, tmp_path, case, "root_stress dynamic_factor", histories="root_stress_max"
    )
    assert done.returncode == 0, done.stderr
    rows = read_folder(tmp_path / "r")
    first = rows[0]
    assert first["status"] == "done", first
    for name in METRICS:
        for wheel in (PINION, GEAR):
            expected = float(run[f"window_{name}"].sel(wheel=wheel))
            assert first[f"{name}_{wheel}"] == pytest.approx(expected, rel=1e-9)
    assert 0.7 < rows[1]["root_stress_max_pinion"] / first["root_stress_max_pinion"] < 0.95


def test_all_metrics_exclude_the_root_stress(
    evolvent: Evolvent, tmp_path: Path, short: str
) -> None:
    """As `outputs: all`: it costs computing time."""
    assert batch(evolvent, tmp_path, short, "all").returncode == 0
    first = read_folder(tmp_path / "r")[0]
    assert not [name for name in first if name.startswith("root_stress")]


def test_a_plan_needs_finite_elements(evolvent: Evolvent, tmp_path: Path, short: str) -> None:
    case = short.replace(f"\n  outputs: {ROOTS}", "").replace("compliance: {}", "")
    batch(evolvent, tmp_path, case, "root_stress_max")
    first = read_folder(tmp_path / "r")[0]
    assert first["status"] == "refused"
    assert "the root stress requires a wheel with finite elements" in first["message"]


def test_responses_have_no_root_stress(evolvent: Evolvent, tmp_path: Path, short: str) -> None:
    done = batch(
        evolvent,
        tmp_path,
        short,
        "root_stress_max",
        respond_over="wheels.gear.loads.0.coefficient=1.9:2.1:2",
    )
    assert done.returncode == 3
    assert "responses have no metrics of the root stress" in done.stderr
    assert done.stderr.count("\n") == 1
