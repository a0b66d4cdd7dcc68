"""Load spectra of runs: against the kernel's root stress, windows, outputs, safety factors."""

from __future__ import annotations

import json
import subprocess
from collections.abc import Callable, Iterator
from pathlib import Path

import numpy as np
import pytest
import xarray as xr

import evolvent
from evolvent.library import binding
from evolvent.physics.load_spectrum import FACE_LOAD, WheelSpectrum, load_spectra

STRENGTH = (
    "materials.steel.strength={sn: {stress_type: range, stress: [800 MPa, 150 MPa], "
    "cycles: [1e4, 3e6], slope_above: 9, slope_below: none}, sigma_FP: 430 MPa, "
    "sigma_HP: 1300 MPa}"
)
OUTPUTS = "simulation.outputs=pairs,angle,centre_displacement,root_stress_max,root_stress_min"
Evolvent = Callable[..., subprocess.CompletedProcess[str]]


@pytest.fixture(scope="module", autouse=True)
def library(executable: Path) -> Iterator[None]:
    """The library beside the program under test."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv(binding.VARIABLE, str(executable.resolve().with_name(binding.NAME)))
        binding.load.cache_clear()
        yield
    binding.load.cache_clear()


def run(executable: Path, case: Path, path: Path, *settings: str) -> xr.Dataset:
    options = [word for text in (OUTPUTS, *settings) for word in ("--set", text)]
    subprocess.run([executable, "run", case, "-q", "-o", path, *options], check=True, timeout=120)
    return evolvent.open_history(path)


@pytest.fixture(scope="module")
def path(executable: Path, examples: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """One revolution of the gear, two of the pinion, after 18 ms."""
    path = tmp_path_factory.mktemp("spectra") / "pair.h5"
    run(executable, examples / "compliant-pair.yaml", path, "simulation.duration=90 ms", STRENGTH)
    return path


@pytest.fixture(scope="module")
def history(path: Path) -> xr.Dataset:
    return evolvent.open_history(path)


@pytest.fixture(scope="module")
def spectra(history: xr.Dataset) -> list[WheelSpectrum]:
    return load_spectra(history)


def rows(history: xr.Dataset, spectrum: WheelSpectrum) -> xr.Dataset:
    """Outputs of the window of a spectrum, of its wheel."""
    window = spectrum.window
    return history.isel(time=slice(window.first, window.last)).sel(wheel=spectrum.wheel)


def test_the_largest_root_stress_is_the_kernel_s(
    history: xr.Dataset, spectra: list[WheelSpectrum]
) -> None:
    """The kernel's outputs are not exceeded by more than the extremes between outputs."""
    for spectrum in spectra:
        expected = float(rows(history, spectrum)["root_stress_max"].max())
        assert spectrum.root_stress == pytest.approx(expected, rel=3e-4)
        assert spectrum.root_stress > expected * (1 - 2e-5)
        least = float(rows(history, spectrum)["root_stress_min"].min())
        assert min(point.least for point in spectrum.root) >= least * (1 + 3e-4)
        assert spectrum.is_resolved


def test_the_largest_force_and_pressure_are_those_of_the_pairs(
    history: xr.Dataset, spectra: list[WheelSpectrum]
) -> None:
    for spectrum in spectra:
        found = rows(history, spectrum)
        for name, value in (
            ("pair_normal_force", max(point.largest for point in spectrum.force)),
            ("pair_contact_pressure", spectrum.pressure),
        ):
            assert value == pytest.approx(float(found[name].max()), rel=3e-4), name
            assert value >= float(found[name].max()) * (1 - 1e-12)


def test_each_tooth_of_a_pair_has_one_large_cycle_a_revolution(
    spectra: list[WheelSpectrum],
) -> None:
    for spectrum, teeth in zip(spectra, (19, 34), strict=True):
        for points in (spectrum.root, spectrum.force):
            assert [point.tooth for point in points] == list(range(teeth))
            for point in points:
                large = point.cycles.ranges > 0.5 * point.cycles.largest
                assert point.cycles.counts[large].sum() == 1.0
                assert point.size == pytest.approx(point.cycles.largest, rel=1e-12)
        # compression by the own load at one point, tension by that of a neighbour
        worst = spectrum.worst_root
        assert worst is not None
        assert worst.least < 0 < worst.largest < 0.3 * -worst.least


def test_damage_is_that_of_the_s_n_line(spectra: list[WheelSpectrum]) -> None:
    for spectrum in spectra:
        worst = spectrum.worst_root
        assert worst is not None
        slope = np.log(3e6 / 1e4) / np.log(800 / 150)
        expected = (worst.cycles.largest / 800e6) ** slope / 1e4  # no damage by the small cycles
        assert worst.damage == pytest.approx(expected, rel=1e-9)
        assert spectrum.life == pytest.approx(1 / expected, rel=1e-9)


def test_safety_factors_need_permissible_stresses_and_name_the_face_load(
    executable: Path, examples: Path, tmp_path: Path, spectra: list[WheelSpectrum]
) -> None:
    for spectrum in spectra:
        assert spectrum.safety_f == pytest.approx(430e6 / spectrum.root_stress, rel=1e-12)
        assert spectrum.safety_h == pytest.approx(1300e6 / spectrum.pressure, rel=1e-12)
        assert FACE_LOAD in spectrum.remarks
    case, path = examples / "compliant-pair.yaml", tmp_path / "run.h5"
    with run(executable, case, path, "simulation.duration=41 ms") as plain:
        spectrum = load_spectra(plain, ["pinion"])[0]
    assert np.isnan([spectrum.safety_f, spectrum.safety_h, spectrum.life]).all()
    assert spectrum.line is None
    assert np.isnan([point.damage for point in spectrum.root]).all()


def test_the_cycles_do_not_depend_on_outputs_and_cut(
    executable: Path, examples: Path, tmp_path: Path, history: xr.Dataset
) -> None:
    """The motion repeats: any revolution of the pinion has the same cycles."""
    case = examples / "compliant-pair.yaml"
    others = ["simulation.output_interval=7 us", "simulation.duration=90 ms"]
    ranges = []
    with run(executable, case, tmp_path / "run.h5", *others) as finer:
        for of, end in ((history, np.inf), (history, 0.0871), (finer, np.inf), (finer, 0.0863)):
            spectrum = load_spectra(of, ["pinion"], end=end)[0]
            worst, force = spectrum.worst_root, spectrum.worst_force
            assert worst is not None
            assert force is not None
            ranges.append((worst.cycles.largest, force.cycles.largest, spectrum.root_stress))
    for found in ranges[1:]:
        assert found == pytest.approx(ranges[0], rel=1e-4)


def test_outputs_too_far_apart_are_warned_of(
    executable: Path, examples: Path, tmp_path: Path, spectra: list[WheelSpectrum]
) -> None:
    """The even outputs alone have the range of all; the odd ones show that both miss the peak."""
    case, far = examples / "compliant-pair.yaml", "simulation.output_interval=40 us"
    with run(executable, case, tmp_path / "run.h5", "simulation.duration=90 ms", far) as history:
        found = load_spectra(history, ["pinion"])[0]
    worst, expected = found.worst_root, spectra[0].worst_root
    assert worst is not None
    assert expected is not None
    assert not found.is_resolved
    assert 5e-4 < abs(worst.size / expected.size - 1) < found.change


TRAIN = """
format: 1
materials: {steel: {youngs_modulus: 206 GPa, poisson_ratio: 0.3, density: 7830 kg/m3}}
wheels:
- {name: a, <<, loads: [{kind: torque, value: SENSE 50 N m}]}
- {name: b, <<}
- {name: c, <<, loads: [{kind: speed, value: SENSE 40 rad/s}]}
meshes:
- {name: a-b, driving: a, driven: b, driving_rotation: FIRST, <<m}
- {name: b-c, driving: b, driven: c, driving_rotation: SECOND, <<m}
simulation: {duration: 0.16 s, output: {per_pitch: 120, mesh: a-b}, initial: {kind: steady}}
"""


def idler(sense: int) -> str:
    """Three equal wheels in line; the middle one is loaded on both flanks."""
    first = ("clockwise", "counterclockwise")
    changes = {
        "<<m": "centre_line_angle: 0 deg, centre_distance: 60.5 mm, "
        "contact: {law: johnson}, damping: {law: ratio, value: 0.1}",
        "<<": "teeth: 20, module: 3 mm, bore: 20 mm, width: 20 mm, material: steel, compliance: {}",
        "SENSE ": "-" if sense < 0 else "",
        "FIRST": first[sense > 0],
        "SECOND": first[sense < 0],
    }
    text = TRAIN
    for mark, replacement in changes.items():
        text = text.replace(mark, replacement)
    return text


@pytest.mark.parametrize("sense", [-1, 1])
def test_a_tooth_of_an_idler_is_loaded_in_both_directions(
    executable: Path, tmp_path: Path, sense: int
) -> None:
    case = tmp_path / "train.yaml"
    case.write_text(idler(sense))
    with run(executable, case, tmp_path / "run.h5") as history:
        driving, middle = load_spectra(history, ["a", "b"])
        expected = rows(history, middle)
        # without relief, peaks of corner contacts lie between the outputs: up to 2 % above them
        for name, found in (
            ("root_stress_max", middle.root_stress),
            ("root_stress_min", min(point.least for point in middle.root)),
        ):
            extreme = float(getattr(expected[name], name[-3:])())
            assert found == pytest.approx(extreme, rel=0.03), name
            assert abs(found) >= abs(extreme) * (1 - 2e-4), name
    one, both = driving.worst_root, middle.worst_root
    assert one is not None
    assert both is not None
    assert one.largest < 0.4 * -one.least
    assert both.largest > 0.6 * -both.least
    assert both.cycles.largest > 1.4 * one.cycles.largest


BEARING = "wheels.gear.support={kind: bearing, stiffness: [3e6, 3e6], damping: [3e3, 3e3]}"


def test_loads_of_a_gear_follow_its_moving_axle(
    executable: Path, examples: Path, tmp_path: Path
) -> None:
    """Its axle moves by 1.1 mm: at the load positions of a fixed axle the stress is 7 % lower."""
    case, path = examples / "compliant-pair.yaml", tmp_path / "run.h5"
    with run(executable, case, path, "simulation.duration=80 ms", BEARING) as moving:
        spectrum = load_spectra(moving, ["gear"])[0]
        expected = float(rows(moving, spectrum)["root_stress_max"].max())
        assert spectrum.root_stress == pytest.approx(expected, rel=3e-4)
        moved = abs(moving["centre_displacement"].sel(wheel="gear")).max()
        assert float(moved) > 5e-4
        with pytest.raises(evolvent.HistoryError, match="has no variable `centre_displacement`"):
            load_spectra(moving.drop_vars("centre_displacement"), ["gear"])


def test_a_wheel_without_finite_elements_has_only_forces(
    executable: Path, examples: Path, tmp_path: Path
) -> None:
    case, path = examples / "compliant-pair.yaml", tmp_path / "run.h5"
    only = ["simulation.outputs=pairs,angle", "wheels.pinion.compliance={model: analytic}"]
    with run(executable, case, path, "simulation.duration=41 ms", STRENGTH, *only) as one:
        spectrum = load_spectra(one, ["pinion"])[0]
    assert spectrum.root == ()
    assert "wheel 'pinion' has no finite elements" in spectrum.no_root
    assert np.isnan(spectrum.safety_f)
    assert np.isfinite(spectrum.safety_h)
    assert len(spectrum.force) == 19


def test_the_command_prints_results_refuses_short_windows_and_draws(
    path: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    from evolvent.commands.post.app import main

    def post(*words: object) -> tuple[int, str, str]:
        monkeypatch.setattr("sys.argv", ["evolvent-post", "fatigue", *map(str, words)])
        with pytest.raises(SystemExit) as end:
            main()
        said = capsys.readouterr()
        return int(end.value.code or 0), said.out, said.err

    figure = tmp_path / "spectra.svg"
    code, out, err = post(path, "--wheel", "pinion", "-o", figure)
    assert (code, err) == (0, "")
    assert FACE_LOAD in out
    assert "S_F: " in out
    assert figure.read_text().startswith("<?xml")
    code, out, _ = post(path, "--wheel", "pinion", "--json")
    assert code == 0
    found = json.loads(out)[0]
    assert found["root_stress"][3]["cycles"][0].keys() == {"range", "mean", "count"}
    assert FACE_LOAD in found["remarks"]
    code, out, err = post(path, "--wheel", "gear", "--turns", 3)
    assert code == 2
    assert "wheel `gear` makes 1.248" in err
    assert err.count("\n") == 1
    code, out, _ = post(path, "--wheel", "gear", "--turns", 3, "--whole-window")
    assert (code, "half cycles for the residue" in out) == (0, True)
    assert post(path, "--wheel", "no")[0] == 2
