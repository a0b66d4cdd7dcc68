"""Root stress in the commands: nominal stress beside finite elements."""

from __future__ import annotations

import json
import math
import re
import subprocess
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import xarray as xr

Evolvent = Callable[..., subprocess.CompletedProcess[str]]

COS = math.cos(math.radians(20))
BASE_PITCH = math.pi * 3 * COS  # mm

# z, x, bore [mm]: rho [mm], m sigma/N: tension, compression; Y_F Y_S cos(alpha). By other programs.
ACCEPTED = {
    (50, 0.0, 40.0): (29.3098, 2.6915, -3.2930, 2.8662),
    (19, 0.4, 25.0): (15.7846, 2.6610, -3.4426, 2.9713),
    (40, 0.0, 36.0): (24.2484, 2.7535, -3.3702, 2.9227),
}
FORCE = 2000.0  # N
WIDTH = 20.0  # mm


def equal_pair(teeth: int, shift: float, bore: float, distance: float) -> str:
    """Two equal wheels of module 3 mm under FORCE."""
    wheel = (
        f"teeth: {teeth}, module: 3 mm, profile_shift: {shift}, bore: {bore} mm, "
        f"width: {WIDTH} mm, material: steel, compliance: {{}}"
    )
    torque = FORCE * 1.5 * teeth * COS / 1e3
    return f"""
format: 1
materials: {{steel: {{youngs_modulus: 206 GPa, poisson_ratio: 0.3, density: 7830 kg/m3}}}}
wheels:
- {{name: a, {wheel}, loads: [{{kind: torque, value: {-torque!r} N m}}]}}
- {{name: b, {wheel}, loads: [{{kind: torque, value: {-torque!r} N m}}]}}
meshes:
- {{name: a-b, driving: a, driven: b, driving_rotation: clockwise, centre_line_angle: 0 deg,
   centre_distance: {distance!r} mm, contact: {{law: johnson}}}}
simulation: {{duration: 1 ms, output_interval: 10 us}}
"""


def pair_with_load_at(teeth: int, shift: float, bore: float, rho: float) -> str:
    """Two equal wheels whose outer point of single contact is at rho [mm]."""
    base = 1.5 * teeth * COS
    tip = math.sqrt((1.5 * teeth + 3 * (1 + shift)) ** 2 - base**2)
    line = rho + tip - BASE_PITCH
    return equal_pair(teeth, shift, bore, math.hypot(line, 2 * base))


def shown(evolvent: Evolvent, case: Path, *options: str) -> dict[str, Any]:
    """The JSON of show."""
    given = [word for option in options for word in ("--set", option)]
    done = evolvent("show", case, "--json", *given)
    assert done.returncode == 0, done.stderr
    return json.loads(done.stdout)


@pytest.mark.parametrize(("wheel", "accepted"), ACCEPTED.items(), ids=map(str, ACCEPTED))
def test_show_prints_accepted_stresses_at_the_outer_point_of_single_contact(
    evolvent: Evolvent,
    tmp_path: Path,
    wheel: tuple[int, float, float],
    accepted: tuple[float, ...],
) -> None:
    rho, tension, compression, nominal = accepted
    case = tmp_path / "pair.yaml"
    case.write_text(pair_with_load_at(*wheel, rho))
    line_load = FORCE / WIDTH  # N/mm
    both = shown(evolvent, case)["root_stress"]["a-b"]
    assert list(both) == ["driving", "driven"]
    for found in both.values():
        assert found["load_position"] == pytest.approx(rho / 1e3, rel=1e-12)
        assert found["line_load"] == pytest.approx(line_load * 1e3, rel=1e-9)
        assert found["tension_coefficient"] == pytest.approx(tension, rel=1e-3)
        assert found["compression_coefficient"] == pytest.approx(compression, rel=1e-3)
        assert found["nominal_coefficient"] == pytest.approx(nominal, rel=1e-4)
        factors = found["form_factor"] * found["stress_correction_factor"]
        assert found["nominal_coefficient"] == pytest.approx(factors * COS, rel=1e-12)
        # MPa = N/mm2
        for stress in ("nominal_stress", "tension", "compression"):
            coefficient = stress.replace("_stress", "") + "_coefficient"
            expected = found[coefficient] * line_load / 3 * 1e6
            assert found[stress] == pytest.approx(expected, rel=1e-9), stress


def test_a_mesh_without_load_has_the_values_of_100_newtons_per_millimetre(
    evolvent: Evolvent, examples: Path
) -> None:
    damping = "meshes.0.damping={law: linear, coefficient: 100}"
    unloaded = ("wheels.pinion.loads=[]", "wheels.gear.loads=[]", damping)
    found = shown(evolvent, examples / "compliant-pair.yaml", *unloaded)
    for side in ("driving", "driven"):
        assert found["root_stress"]["pinion-gear"][side]["line_load"] == 1e5
    assert found["compliance"]["pinion-gear"]["line_load"] == 1e5


def test_text_and_json_have_the_same_root_stress(evolvent: Evolvent, examples: Path) -> None:
    case = examples / "compliant-pair.yaml"
    both = shown(evolvent, case)["root_stress"]["pinion-gear"]
    text = evolvent("show", case).stdout.split("Root stress in mesh pinion-gear")[1]
    lines = [line.split() for line in text.splitlines()]
    for symbol, name, factor in (
        ("Y_F", "form_factor", 1),
        ("Y_S", "stress_correction_factor", 1),
        ("q_s", "notch_parameter", 1),
        ("sigma_F0", "nominal_stress", 1e-6),
        ("Sigma_F", "tension_coefficient", 1),
        ("sigma_F-", "compression", 1e-6),
    ):
        row = next(line for line in lines if symbol in line and not line[0].startswith("Y_F"))
        printed = [float(word) for word in row[-2:]]
        expected = [both[side][name] * factor for side in ("driving", "driven")]
        assert printed == pytest.approx(expected, rel=1e-4), symbol
    assert "K_Fbeta = K_Hbeta = 1" in text
    assert "no friction along the flank" in text


def test_only_wheels_with_finite_elements_have_root_stress(
    evolvent: Evolvent, examples: Path
) -> None:
    case = examples / "compliant-pair.yaml"
    both = shown(evolvent, case)["root_stress"]["pinion-gear"]
    one = shown(evolvent, case, "wheels.gear.compliance={model: analytic}")["root_stress"]
    assert one == {"pinion-gear": {"driving": both["driving"]}}
    none = ("wheels.pinion.compliance={model: analytic}", "wheels.gear.compliance={model: none}")
    assert shown(evolvent, case, *none)["root_stress"] == {}
    done = evolvent("show", case, "--set", none[0], "--set", none[1])
    assert "Root stress" not in done.stdout


def test_a_sharp_notch_has_no_nominal_stress(evolvent: Evolvent, tmp_path: Path) -> None:
    """Y_S holds for q_s from 1 to 8."""
    case = tmp_path / "pair.yaml"
    case.write_text(pair_with_load_at(200, 0.0, 540.0, 103.2))
    sharp = "wheels.a.rack={root_radius: 0.02}"
    both = shown(evolvent, case, sharp)["root_stress"]["a-b"]
    assert both["driving"]["notch_parameter"] > 8
    assert both["driven"]["notch_parameter"] < 8
    assert both["driving"]["nominal_stress"] is None
    assert both["driving"]["nominal_coefficient"] is None
    assert both["driving"]["tension"] > both["driven"]["tension"]
    assert both["driven"]["nominal_stress"] > 0
    text = evolvent("show", case, "--set", sharp).stdout
    assert "No nominal stress of the driving wheel: q_s = " in text
    assert "No nominal stress of the driven wheel" not in text


def test_two_pairs_everywhere_have_no_single_contact(evolvent: Evolvent, tmp_path: Path) -> None:
    case = tmp_path / "pair.yaml"
    case.write_text(equal_pair(50, 0.0, 40.0, 150.05))
    high = [
        f"wheels.{name}.rack={{addendum: 1.3, dedendum: 1.5, root_radius: 0.3}}" for name in "ab"
    ]
    reported = shown(evolvent, case, *high)
    assert reported["meshes"]["a-b"]["contact_ratio"] > 2
    for found in reported["root_stress"]["a-b"].values():
        assert {name for name, value in found.items() if value is not None} == {"line_load"}
    given = [word for option in high for word in ("--set", option)]
    assert "no position has a single tooth pair" in evolvent("show", case, *given).stdout


def test_refused_cases_show_no_root_stress(evolvent: Evolvent, examples: Path) -> None:
    given = ("--set", "meshes.0.centre_distance=0.09")
    done = evolvent("show", examples / "compliant-pair.yaml", "--json", *given)
    assert done.returncode != 0
    assert json.loads(done.stdout)["root_stress"] == {}


# ---- static

# z 50: rho [mm], tension of the loaded tooth, and stress at one arc under loads on teeth -1 and 1
RHO = [19.6162, 23.2999, 26.4759, 29.3098, 31.8928]
OWN = [1.8389, 1.9582, 2.2703, 2.6915, 3.1819]
BEHIND = [0.1569, 0.1470, 0.1408, 0.1357, 0.1306]
OF_WHEEL = ("max", "min", "max_arc", "min_arc")


def analysed(
    evolvent: Evolvent, case: Path, folder: Path, torque: float, *options: str
) -> xr.Dataset:
    """Results of `static` at one torque, without the dimension torque."""
    given = [word for option in options for word in ("--set", option)]
    path = folder / "static.h5"
    done = evolvent("static", case, "--torque", repr(torque), "-o", path, *given)
    assert done.returncode == 0, done.stderr
    with xr.open_dataset(path, engine="h5netcdf") as file:
        return file.load().isel(torque=0)


def coefficients(found: xr.Dataset) -> xr.DataArray:
    """Largest stress times the module over the line load of all pairs (position, wheel)."""
    line_load = found["pair_normal_force"].sum("pair") / found["common_width"]
    return found["root_stress_max"] * 3e-3 / line_load


@pytest.mark.parametrize(("wheel", "accepted"), ACCEPTED.items(), ids=map(str, ACCEPTED))
def test_a_single_pair_has_the_accepted_stress_on_both_wheels(
    evolvent: Evolvent,
    tmp_path: Path,
    wheel: tuple[int, float, float],
    accepted: tuple[float, ...],
) -> None:
    case = tmp_path / "pair.yaml"
    case.write_text(pair_with_load_at(*wheel, accepted[0]))
    found = analysed(evolvent, case, tmp_path, 1.0)
    assert found["wheel"].values.tolist() == ["a", "b"]
    single = found.isel(position=np.flatnonzero(found["loaded_pairs"] == 1))
    slot = single["pair_normal_force"].argmax("pair")
    for name, flank in (("a", "pair_position"), ("b", "pair_position_driven")):
        rho = single[flank].isel(pair=slot).values
        order = np.argsort(rho)
        stress = coefficients(single).sel(wheel=name).values[order]
        assert abs(rho.max() * 1e3 - accepted[0]) < 0.1
        fit = np.polyfit(rho[order][-20:] * 1e3 - accepted[0], stress[-20:], 2)
        assert fit[-1] == pytest.approx(accepted[1], rel=1e-3)


def test_the_pair_behind_adds_tension_to_the_tooth_ahead(
    evolvent: Evolvent, tmp_path: Path
) -> None:
    """The flank of the loaded tooth faces away from the other one: + 4 %, not - 3 %."""
    case = tmp_path / "pair.yaml"
    case.write_text(pair_with_load_at(50, 0.0, 40.0, 29.3098))
    found = analysed(evolvent, case, tmp_path, 50.0)
    double = found.isel(position=np.flatnonzero(found["loaded_pairs"] == 2))
    force = (double["pair_normal_force"] / double["common_width"]).values
    for name, flank in (("a", "pair_position"), ("b", "pair_position_driven")):
        rho = double[flank].values * 1e3
        assert force.shape == rho.shape
        checked = 0
        for i in range(len(force)):
            low, high = sorted(np.flatnonzero(force[i] > 0), key=lambda slot: rho[i, slot])
            if not (RHO[0] < rho[i, low] and rho[i, high] < RHO[-1] and force[i, high] > 2e4 / 9):
                continue
            own = np.polyval(np.polyfit(RHO, OWN, 4), rho[i, high])
            other = np.interp(rho[i, low], RHO, BEHIND)
            expected = (force[i, high] * own + force[i, low] * other) / 3e-3
            stress = float(double["root_stress_max"].sel(wheel=name)[i])
            if force[i, high] > force[i, low]:
                assert stress == pytest.approx(expected, rel=0.01)
                checked += 1
        assert checked > 5


def test_reversed_torques_and_rotations_are_mirror_images(
    evolvent: Evolvent, tmp_path: Path
) -> None:
    """Coast flanks are the drive flanks of the other sense, along the path from its end."""
    case = tmp_path / "pair.yaml"
    base, contact_ratio, points = 28.5 * COS, 1.35, 200
    tip = math.sqrt(32.7**2 - base**2)
    case.write_text(
        equal_pair(19, 0.4, 25.0, math.hypot(2 * tip - contact_ratio * BASE_PITCH, 2 * base))
    )
    counter = "meshes.0.driving_rotation=counterclockwise"
    drive = analysed(evolvent, case, tmp_path, 80.0)
    coast = analysed(evolvent, case, tmp_path, -80.0, counter)
    turned = analysed(evolvent, case, tmp_path, 80.0, counter)
    backwards = (round(contact_ratio * points) - np.arange(points)) % points
    for name in OF_WHEEL:
        expected = drive[f"root_stress_{name}"].values
        scale = float(abs(expected).max())
        mirrored = turned[f"root_stress_{name}"].values
        np.testing.assert_allclose(mirrored, expected, rtol=0, atol=1e-7 * scale)
        found = coast[f"root_stress_{name}"].values[backwards]
        np.testing.assert_allclose(found, expected, rtol=0, atol=1e-6 * scale)
    for side in ("max", "min"):
        ahead = drive[f"root_stress_{side}_tooth"].sel(wheel="a").values
        behind = turned[f"root_stress_{side}_tooth"].sel(wheel="a").values
        assert ((ahead + behind - ahead[0] - behind[0]) % 19 == 0).all()
        assert len(np.unique(ahead)) == 2
        assert ((ahead >= 0) & (ahead < 19)).all()


def test_stress_is_that_of_a_pair_twice_as_large_under_four_times_the_force(
    evolvent: Evolvent, tmp_path: Path
) -> None:
    case, large = tmp_path / "pair.yaml", tmp_path / "large.yaml"
    text = equal_pair(40, 0.0, 36.0, 120.4)
    case.write_text(text)
    for small in ("module: 3 mm", "bore: 36.0 mm", f"width: {WIDTH} mm", "distance: 120.4 mm"):
        assert small in text
        key, number, unit = small.split()
        text = text.replace(small, f"{key} {2 * float(number)} {unit}")
    large.write_text(text)
    # forces per width and length are equal
    one, two = (
        analysed(evolvent, case, tmp_path, 50.0),
        analysed(evolvent, large, tmp_path, 400.0),
    )
    for name in ("max", "min"):
        expected = one[f"root_stress_{name}"]
        np.testing.assert_allclose(two[f"root_stress_{name}"], expected, rtol=1e-7)
        arcs = one[f"root_stress_{name}_arc"]
        np.testing.assert_allclose(two[f"root_stress_{name}_arc"], 2 * arcs, rtol=1e-6)


def test_the_summary_has_the_extremes_over_the_path(
    evolvent: Evolvent, examples: Path, tmp_path: Path
) -> None:
    words = ("static", examples / "compliant-pair.yaml", "--torque", "50:100:2")
    path = tmp_path / "static.h5"
    text = evolvent(*words, "-o", path).stdout.split("Root stress, largest and least")[1]
    reported = json.loads(evolvent(*words, "-o", path, "--json").stdout)
    rows = [line.split() for line in text.splitlines()]
    printed = {
        side: np.array([row[1:] for row in rows if row and row[0] == side], float)
        for side in ("driving", "driven")
    }
    with xr.open_dataset(path, engine="h5netcdf") as file:
        found = file.load()
    assert found["root_stress_max"].dims == ("torque", "position", "wheel")
    for wheel, side in (("pinion", "driving"), ("gear", "driven")):
        of_wheel = found.sel(wheel=wheel)
        assert printed[side][:, 0].tolist() == [50, 100]
        for column, name, sign in ((1, "max", 1), (5, "min", -1)):
            at_positions = getattr(of_wheel[f"root_stress_{name}"], name)("position").values
            extreme = np.array(reported[f"root_stress_{name}_{side}"])
            gain = sign * (extreme - at_positions) / abs(at_positions)
            assert (gain >= 0).all()
            assert (gain < 5e-3).all()
            for k, (suffix, factor) in enumerate(
                {"": 1e-6, "_x": 1, "_tooth": 1, "_arc": 1e3}.items()
            ):
                expected = np.array(reported[f"root_stress_{name}{suffix}_{side}"]) * factor
                assert printed[side][:, column + k] == pytest.approx(expected, rel=1e-3)
    assert "K_Fbeta = K_Hbeta = 1" in text
    assert "no friction along the flank" in text


def test_documentation_lists_the_root_stress_of_a_file(
    evolvent: Evolvent, examples: Path, tmp_path: Path, root: Path
) -> None:
    found = analysed(evolvent, examples / "compliant-pair.yaml", tmp_path, 100.0)
    text = (root / "docs" / "reference" / "result_format.md").read_text()
    section = text.split("\n### Root stress")[1].split("\n## ")[0]
    rows = re.findall(r"^\| `(\w+)` \| ([^|]*) \| ([^|]*) \|", section, re.MULTILINE)
    # without the dimension torque
    listed = {name: (tuple(dims.split(", ")[1:]), unit) for name, dims, unit in rows}
    variables = {str(name): v for name, v in found.data_vars.items() if "root_stress" in str(name)}
    assert listed == {name: (v.dims, v.attrs["units"]) for name, v in variables.items()}


def test_static_without_finite_elements_has_no_root_stress(
    evolvent: Evolvent, examples: Path, tmp_path: Path
) -> None:
    words = ("static", examples / "compliant-pair.yaml", "-o", tmp_path / "static.h5")
    pinion, gear = (f"wheels.{name}.compliance={{model: analytic}}" for name in ("pinion", "gear"))
    text = evolvent(*words, "--set", pinion, "--set", gear).stdout
    assert "No root stress: neither wheel has a compliance by finite elements" in text
    with xr.open_dataset(tmp_path / "static.h5", engine="h5netcdf") as file:
        assert "wheel" not in file.sizes
        assert not [name for name in file.variables if str(name).startswith("root_stress")]
    reported = json.loads(evolvent(*words, "--json", "--set", pinion, "--set", gear).stdout)
    assert not [name for name in reported if name.startswith("root_stress")]
    text = evolvent(*words, "--set", gear).stdout
    assert "No root stress of the driven wheel: it has no compliance by finite elements" in text
    with xr.open_dataset(tmp_path / "static.h5", engine="h5netcdf") as file:
        one = file.load()
    assert (one["root_stress_max"].sel(wheel="pinion") > 0).all()
    assert one["root_stress_max"].sel(wheel="gear").isnull().all()
    assert (one["root_stress_max_tooth"].sel(wheel="gear") == -1).all()
    assert np.isnan(one["root_stress_max_driven"]).all()


# ---- run

SLOW = 2e-4  # rad/s
TORQUE = 10.0  # N m


def slow_train(
    teeth: int, distance: float, n: int = 2, *, sense: int = -1, order: str = "abc"
) -> str:
    """A train of equal wheels in line that turns slowly.

    The first wheel drives in `sense`, counterclockwise positive; the last one limits the speed.
    """
    last = "abc"[n - 1]
    loads = {
        "a": f"{{kind: torque, value: {sense * TORQUE} N m}}",
        last: f"{{kind: speed, value: {sense * (-1) ** (n - 1) * SLOW} rad/s}}",
    }
    wheels = "".join(
        f"""
- name: {name}
  teeth: {teeth}
  module: 3 mm
  bore: 36 mm
  width: {WIDTH} mm
  material: steel
  compliance: {{}}
  loads: [{loads.get(name, "")}]"""
        for name in order
        if name in "abc"[:n]
    )
    meshes = "".join(
        f"""
- name: {a}-{b}
  driving: {a}
  driven: {b}
  driving_rotation: {"clockwise" if turn < 0 else "counterclockwise"}
  centre_line_angle: 0 deg
  centre_distance: {distance!r} mm
  contact: {{law: johnson}}
  damping: {{law: ratio, value: 0.07}}"""
        for a, b, turn in (("a", "b", sense), ("b", "c", -sense))[: n - 1]
    )
    period = 2 * math.pi / teeth / SLOW
    return f"""
format: 1
materials: {{steel: {{youngs_modulus: 206 GPa, poisson_ratio: 0.3, density: 7830 kg/m3}}}}
wheels:{wheels}
meshes:{meshes}
simulation:
  duration: {period!r} s
  output: {{per_pitch: 50, mesh: a-b}}
  outputs: root_stress_max,root_stress_min,pair_contact_kind,pair_normal_force
  initial: {{kind: steady}}
"""


PUSHED = (("a", 40), ("b", 30))


def run_of(evolvent: Evolvent, folder: Path, text: str, *options: str) -> xr.Dataset:
    """The history of a case."""
    (folder / "run.yaml").write_text(text)
    given = [word for option in options for word in ("--set", option)]
    done = evolvent("run", folder / "run.yaml", "-q", "-o", folder / "run.h5", *given)
    assert done.returncode == 0, done.stderr
    with xr.open_dataset(folder / "run.h5", engine="h5netcdf") as file:
        return file.load()


def statics_of(evolvent: Evolvent, folder: Path, torque: float) -> xr.Dataset:
    """Static results of the same case at the same positions."""
    words = ("--torque", repr(torque), "--points", "50", "-o", folder / "static.h5")
    done = evolvent("static", folder / "run.yaml", *words)
    assert done.returncode == 0, done.stderr
    with xr.open_dataset(folder / "static.h5", engine="h5netcdf") as file:
        return file.load().isel(torque=0)


def test_a_slow_run_has_the_stress_of_static(evolvent: Evolvent, tmp_path: Path) -> None:
    run = run_of(evolvent, tmp_path, slow_train(40, 120.4))
    static = statics_of(evolvent, tmp_path, TORQUE)
    place = run["output_position"].values * 50
    k = np.round(place).astype(int)
    rows = np.flatnonzero(abs(place - k) < 1e-6)
    assert len(np.unique(k[rows] % 50)) == 50
    for name in ("root_stress_max", "root_stress_min"):
        expected = static[name].values
        scale = abs(expected).max()
        found = run[name].values[rows]
        np.testing.assert_allclose(found, expected[k[rows] % 50], rtol=0, atol=1e-6 * scale)


def test_runs_are_mirrored_by_rotation_flank_and_order_of_wheels(
    evolvent: Evolvent, tmp_path: Path
) -> None:
    runs = {
        "drive": slow_train(40, 120.4),
        "turned": slow_train(40, 120.4, sense=1),
        "order": slow_train(40, 120.4, order="ba"),
    }
    found = {name: run_of(evolvent, tmp_path, text) for name, text in runs.items()}
    for name in ("root_stress_max", "root_stress_min"):
        expected = found["drive"][name]
        scale = float(abs(expected).max())
        for other in ("turned", "order"):
            values = found[other][name].sel(wheel=["a", "b"]).values
            np.testing.assert_allclose(values, expected, rtol=0, atol=1e-6 * scale)


def test_pairs_on_coast_flanks_have_the_stress_of_static(
    evolvent: Evolvent, tmp_path: Path
) -> None:
    """From rest through the backlash, then against driving_rotation: rows with a single pair."""
    text = equal_pair(40, 0.0, 36.0, 120.4)
    turning = [f"wheels.{name}.loads=[{{kind: torque, value: {t} N m}}]" for name, t in PUSHED]
    only = "simulation.outputs=root_stress_max,root_stress_min,pairs"
    run = run_of(evolvent, tmp_path, text, *turning, only, "simulation.duration=20 ms")
    static = statics_of(evolvent, tmp_path, -30.0)
    found, expected = (
        of.isel({axis: np.flatnonzero((of["pair_normal_force"] > 0).sum("pair") == 1)})
        for of, axis in ((run.squeeze("mesh"), "time"), (static, "position"))
    )
    loaded, exact = (of.where(of["pair_normal_force"] > 0).max("pair") for of in (found, expected))
    slots = found["pair_normal_force"].argmax("pair").values
    on_coast = found["pair"].str.startswith("coast").values[slots]
    line = math.sqrt(120.4**2 - (120 * COS) ** 2) / 1e3
    rho_a = loaded["pair_position"].values
    positions = {
        "a": (rho_a, exact["pair_position"].values),
        "b": (
            line + loaded["pair_penetration"].values - rho_a,
            exact["pair_position_driven"].values,
        ),
    }
    for wheel, (rho, knots) in positions.items():
        inside = on_coast & (rho > knots.min()) & (rho < knots.max())
        assert inside.sum() > 20
        order = np.argsort(knots)
        for name in ("root_stress_max", "root_stress_min"):
            of_run, of_static = (
                of[name].sel(wheel=wheel).values / force["pair_normal_force"].values
                for of, force in ((found, loaded), (expected, exact))
            )
            curve = np.interp(rho, knots[order], of_static[order])
            np.testing.assert_allclose(of_run[inside], curve[inside], rtol=1e-3)


def test_the_tooth_of_an_idler_has_the_loads_of_both_meshes(
    evolvent: Evolvent, tmp_path: Path
) -> None:
    """The second mesh mirrors the first: nearly the same stress, on the other flank."""
    pair = run_of(evolvent, tmp_path, slow_train(40, 120.4))
    train = run_of(evolvent, tmp_path, slow_train(40, 120.4, 3))
    turned = run_of(evolvent, tmp_path, slow_train(40, 120.4, 3, sense=1, order="cab"))
    for name in ("root_stress_max", "root_stress_min"):
        scale = float(abs(train[name]).max())
        mirrored = turned[name].sel(wheel=["a", "b", "c"]).values
        np.testing.assert_allclose(mirrored, train[name], rtol=0, atol=1e-6 * scale)
        extreme = "max" if name.endswith("max") else "min"
        idler, ends = (
            getattr(train[name].sel(wheel=wheels), extreme)().item() for wheels in ("b", ["a", "c"])
        )
        alone = getattr(pair[name], extreme)().item()
        assert ends == pytest.approx(alone, rel=0.02)
        # the other mesh loads a tooth half a revolution away
        assert idler == pytest.approx(alone, rel=0.05)
        assert abs(idler - ends) > 1e-4 * abs(ends)


def test_stress_is_recorded_only_on_request(
    evolvent: Evolvent, examples: Path, tmp_path: Path
) -> None:
    case = examples / "compliant-pair.yaml"
    short = ("-q", "--set", "simulation.duration=1 ms", "-o", tmp_path / "run.h5")
    for outputs in ((), ("--outputs", "all"), ("--outputs", "wheels")):
        assert evolvent("run", case, *short, *outputs).returncode == 0
        with xr.open_dataset(tmp_path / "run.h5", engine="h5netcdf") as file:
            assert not [name for name in file.variables if "root_stress" in str(name)]
    outputs = ("--outputs", "all,root_stress_max")
    with xr.open_dataset(tmp_path / "run.h5", engine="h5netcdf") as file:
        before = file.load()
    assert evolvent("run", case, *short, *outputs).returncode == 0
    with xr.open_dataset(tmp_path / "run.h5", engine="h5netcdf") as file:
        after = file.load()
    assert after["root_stress_max"].dims == ("time", "wheel")
    assert (after["root_stress_max"] > 0).all()
    assert (after["root_stress_min"] < 0).all()
    for name in before.data_vars:  # the same bits
        np.testing.assert_array_equal(after[name], before[name])


def test_requested_stress_needs_finite_elements(
    evolvent: Evolvent, examples: Path, tmp_path: Path
) -> None:
    case = examples / "compliant-pair.yaml"
    wheels = [
        word
        for name in ("pinion", "gear")
        for word in ("--set", f"wheels.{name}.compliance={{model: analytic}}")
    ]
    words = ("run", case, "-o", tmp_path / "run.h5", "--set", "simulation.outputs=root_stress_min")
    done = evolvent(*words, *wheels)
    assert done.returncode == 3
    assert done.stderr.count("\n") == 1
    assert "root stress requires a wheel with finite elements; give one" in done.stderr
    assert not (tmp_path / "run.h5").exists()
    short = ("-q", "--set", "simulation.duration=0.1 ms")
    assert evolvent(*words, *short, *wheels[2:]).returncode == 0
    with xr.open_dataset(tmp_path / "run.h5", engine="h5netcdf") as file:
        stress = file["root_stress_min"].load()
    assert (stress.sel(wheel="pinion") < 0).all()
    assert stress.sel(wheel="gear").isnull().all()
