"""`evolvent respond --method orbits`: periodic orbits over a parameter, stable or unstable."""

from __future__ import annotations

import math
import subprocess
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import xarray as xr
import yaml
from scipy.linalg import expm
from scipy.optimize import brentq

from system.test_metrics import (
    BASE,
    FORCE,
    HALF_GAP,
    INERTIA,
    RATIO,
    STIFFNESS,
    TEETH,
    oscillator,
    rectangular,
)
from system.test_respond import SPEED, UNIT, speeds

Orbits = Callable[..., xr.Dataset]
FOLD, CROSSING, DOUBLING, TOUCH = 1, 2, 3, 5
OMEGA_1 = math.sqrt(STIFFNESS) * BASE / math.sqrt(INERTIA)  # of one pair [rad/s]


@pytest.fixture
def orbits(evolvent: Callable[..., subprocess.CompletedProcess[str]], tmp_path: Path) -> Orbits:
    """Orbits of the oscillator with rectangular stiffness over its frequency."""

    def run(first: float, last: float, *options: Any) -> xr.Dataset:
        case = rectangular(1.0, 1, 1, "radau")
        del case["simulation"]["metrics"]
        path, result = tmp_path / "case.yaml", tmp_path / "orbits.h5"
        path.write_text(yaml.safe_dump(case))
        over = f"{SPEED}={-first * UNIT!r}:{-last * UNIT!r}"
        done = evolvent(
            *("respond", path, "--over", over, "--method", "orbits", "-o", result, "-q", *options)
        )
        assert done.returncode == 0, done.stderr
        with xr.open_dataset(result, engine="h5netcdf") as file:
            return file.load()

    return run


def frequencies(found: xr.Dataset, kind: int | None = None) -> np.ndarray:
    """Mesh frequencies of all points, or those of a kind, in units of UNIT."""
    which = slice(None) if kind is None else found["orbit_kind"].values == kind
    return -found["orbit_parameter"].values[which] / UNIT


def largest(found: xr.Dataset) -> np.ndarray:
    """Magnitude of the largest multiplier of each point."""
    return np.hypot(found["multiplier_real"], found["multiplier_imaginary"]).values[:, 0]


def deviations(found: xr.Dataset) -> np.ndarray:
    """Standard deviations of the transmission error over F/k."""
    return found["transmission_error_standard_deviation"].values[:, 0] / (FORCE / STIFFNESS)


def monodromy(omega: float, ratio: float, damping: float) -> np.ndarray:
    """Monodromy matrix of Meissner's equation with stiffness 1 and 2; damper of one pair."""
    pairs = [expm(np.array([[0, 1], [-k, -2 * damping * k]]) * t * 2 * math.pi / omega)
             for k, t in ((2, ratio - 1), (1, 2 - ratio))]  # fmt: skip
    return pairs[1] @ pairs[0]


def boundary(low: float, high: float, ratio: float, damping: float) -> float:
    """Frequency over omega_1 at which a multiplier is -1."""

    def over(omega: float) -> float:
        d = monodromy(omega, ratio, damping)
        return float(np.trace(d) + 1 + np.linalg.det(d))

    return float(brentq(over, low, high, xtol=1e-12))


def test_meissners_boundaries_are_the_figures_that_are_known() -> None:
    """Values of another program: 2.358078198 and 2.753118529."""
    assert boundary(2.2, 2.5, RATIO, 0.03) == pytest.approx(2.358078198, abs=1e-9)
    assert boundary(2.6, 2.9, RATIO, 0.03) == pytest.approx(2.753118529, abs=1e-9)


@pytest.mark.parametrize(
    ("ratio", "damping"), [(RATIO, 0.03), (1.4, 0.03), (1.7, 0.02), (RATIO, 0.05)]
)
def test_doublings_without_parting_are_meissners_boundaries(
    monkeypatch: pytest.MonkeyPatch, orbits: Orbits, ratio: float, damping: float
) -> None:
    """Pairs stay longer by F/(k p_b) = 7.5e-7 of a pitch: 1e-6 of the frequency.

    Between the boundaries the orbit continues, unstable: its largest multiplier is that of the
    equation at the same frequency.
    """
    monkeypatch.setattr("system.test_metrics.RATIO", ratio)
    low, high = (boundary(*ends, ratio, damping) for ends in _around(ratio, damping))
    scale = UNIT / OMEGA_1 * TEETH
    found = orbits(
        *(0.97 * low / scale, 1.03 * high / scale),
        *("--set", f"meshes.ab.damping.value={damping}"),
    )
    first = found.isel(point=found["orbit_branch"] == 0)
    at = np.sort(frequencies(first, DOUBLING)) * scale
    assert at == pytest.approx([low, high], rel=1e-6)
    inside = (frequencies(first) * scale > low) & (frequencies(first) * scale < high)
    assert inside.sum() > 3
    assert not first["orbit_stable"].values[inside & (first["orbit_kind"].values == 0)].any()
    for omega, mu in zip(frequencies(first) * scale, largest(first), strict=True):
        exact = np.abs(np.linalg.eigvals(monodromy(omega, ratio, damping))).max()
        # the multipliers split like a square root near the boundaries
        assert mu == pytest.approx(exact, abs=1e-4)


def _around(ratio: float, damping: float) -> tuple[tuple[float, float], tuple[float, float]]:
    """Brackets of the boundaries of the first instability."""
    omega = np.linspace(2.0, 3.2, 1201)
    over = [float(np.trace(d) + 1 + np.linalg.det(d))
            for d in (monodromy(o, ratio, damping) for o in omega)]  # fmt: skip
    (change,) = np.nonzero(np.diff(np.sign(over)))
    assert len(change) == 2
    return tuple((omega[i], omega[i + 1]) for i in change)  # type: ignore[return-value]


def test_fold_is_where_a_sweep_jumps(orbits: Orbits, evolvent, tmp_path: Path) -> None:
    """A sweep halves the step of a jump ten times."""
    found = orbits(0.7, 0.765)
    (fold,) = frequencies(found, FOLD)
    over = speeds(0.7, 0.765)
    path = tmp_path / "sweep.h5"
    done = evolvent("respond", tmp_path / "case.yaml", "--over", over, "--up", "-q", "-o", path)
    assert done.returncode == 0, done.stderr
    with xr.open_dataset(path, engine="h5netcdf") as sweep:
        assert -float(sweep["jump_before"][0]) / UNIT == pytest.approx(fold, abs=1e-4)
        assert -float(sweep["jump_after"][0]) / UNIT == pytest.approx(fold, abs=1e-4)


def test_unstable_branch_is_followed_from_the_fold(orbits: Orbits) -> None:
    """At a fold one multiplier is 1, beyond it larger; all orbits close to 1e-10 of the scales."""
    found = orbits(0.7, 0.765)
    first = found.isel(point=found["orbit_branch"] == 0)
    stable = first["orbit_stable"].values == 1
    (fold,) = np.flatnonzero(first["orbit_kind"].values == FOLD)
    assert largest(first)[fold] == pytest.approx(1, abs=1e-6)
    assert (first["orbit_stable"].values[:fold] != 0).all()  # -1 at grazing points
    assert not stable[fold + 1 :].any()
    assert frequencies(first)[-1] == pytest.approx(0.7, rel=1e-12)  # back at the end of the range
    assert np.all(np.diff(deviations(first)[fold:]) > 0)
    assert (found["orbit_residual"].values <= 1e-10).all()


def test_touches_of_pairs_that_share_the_force_are_one_point(orbits: Orbits) -> None:
    """Two equal springs: their forces vanish together, and soon after that their gap opens."""
    found = orbits(0.4, 0.45)
    touches = frequencies(found, TOUCH)
    assert len(touches) >= 4
    assert np.diff(np.sort(touches)).min() > 1e-5  # one point is located to 1e-10
    names = found["orbit_touch"].values[found["orbit_kind"].values == TOUCH]
    assert len(set(names)) == 2


@pytest.mark.parametrize("omega", [0.7, 1.3, 2.0])
def test_numbers_of_an_orbit_are_those_at_the_end_of_a_long_run(
    orbits: Orbits, evolvent, tmp_path: Path, omega: float
) -> None:
    """At 2 the stable orbit has two pitches."""
    found = orbits(omega, omega + 0.002)
    case = rectangular(omega, 1200, 60, "radau")
    case["simulation"]["tolerance"] = 1e-12
    path, result = tmp_path / "long.yaml", tmp_path / "long.h5"
    path.write_text(yaml.safe_dump(case))
    done = evolvent("run", path, "-o", result, "-q")
    assert done.returncode == 0, done.stderr
    here = _near(frequencies(found), omega) & (found["orbit_stable"].values == 1)
    orbit = found.isel(point=np.flatnonzero(here))
    assert set(orbit["orbit_period"].values.tolist()) == {2 if omega == 2.0 else 1}
    with xr.open_dataset(result, engine="h5netcdf") as run:
        for name in ("transmission_error_standard_deviation", "normal_force_max"):
            reported = float(run[f"window_{name}"][0])
            assert float(orbit[name][0, 0]) == pytest.approx(reported, rel=1e-8)


def _near(values: np.ndarray, value: float) -> np.ndarray:
    return np.abs(values - value) < 1e-9


# ---- limit of the periods ----


def test_longest_bounds_the_branches_at_doublings(orbits: Orbits) -> None:
    """Period 2 is stable between the doublings, so both ends of the range have period 1."""
    short, long = (orbits(1.5, 1.86, "--longest", n) for n in ("1", "2"))
    assert set(short["orbit_period"].values.tolist()) == {1}
    assert set(long["orbit_period"].values.tolist()) == {1, 2}
    # the doubling is still reported, and the orbits of one period are the same
    np.testing.assert_array_equal(frequencies(short, DOUBLING), frequencies(long, DOUBLING)[:1])
    first = long.isel(point=long["orbit_branch"] == 0)
    alike = short.isel(point=short["orbit_branch"] == 0)
    np.testing.assert_array_equal(first["orbit_parameter"], alike["orbit_parameter"])
    assert (short["branch_parent"].values == -1).all()
    assert 0 in long["branch_parent"].values.tolist()


def test_longest_leaves_out_motions_of_more_periods(evolvent, tmp_path: Path) -> None:
    """At 2.0 the motion has two pitches."""
    case = rectangular(1.0, 1, 1, "radau")
    del case["simulation"]["metrics"]
    path = tmp_path / "case.yaml"
    path.write_text(yaml.safe_dump(case))
    over = f"{SPEED}={-2.0 * UNIT!r}:{-2.002 * UNIT!r}"
    common = ("respond", path, "--over", over, "--method", "orbits", "-o")
    done = evolvent(*common, tmp_path / "short.h5", "--longest", "1")
    assert done.returncode == 4
    assert "the motion repeats after 2 common periods, more than --longest 1: it is" in done.stderr
    again = evolvent(*common, tmp_path / "long.h5", "--longest", "2")
    assert again.returncode == 0, again.stderr


# ---- backlash: a curve with two folds ----

AMPLITUDE = "wheels.b.loads.0.amplitude"


@pytest.fixture
def stops(tmp_path: Path) -> Path:
    """The oscillator with backlash at 0.8 of its frequency."""
    case = oscillator(0.8, HALF_GAP)
    del case["simulation"]["metrics"]
    path = tmp_path / "stops.yaml"
    path.write_text(yaml.safe_dump(case))
    return path


def follow(evolvent, case: Path, over: str, *options: str) -> xr.Dataset:
    """Response of a case over a parameter."""
    result = case.with_name("follow.h5")
    done = evolvent("respond", case, "--over", over, "-q", "-o", result, *options, timeout=400)
    assert done.returncode == 0, done.stderr
    with xr.open_dataset(result, engine="h5netcdf") as file:
        return file.load()


def test_unstable_branch_joins_both_jumps_of_a_sweep(evolvent, stops: Path) -> None:
    """A sweep jumps at the folds, to 1e-4; one branch contains all three orbits between them."""
    found = follow(evolvent, stops, f"{AMPLITUDE}=-20:-300", "--method", "orbits")
    sweep = follow(evolvent, stops, f"{AMPLITUDE}=-20:-300:57", "--both")
    assert found.sizes["branch"] == 1
    kind, parameter = found["orbit_kind"].values, found["orbit_parameter"].values
    folds = np.flatnonzero(kind == FOLD)
    assert len(folds) == 2
    jumps = (sweep["jump_before"].values + sweep["jump_after"].values) / 2
    np.testing.assert_allclose(parameter[folds], jumps, rtol=1e-4)
    stable = found["orbit_stable"].values == 1
    unstable = found["orbit_stable"].values == 0  # -1 at grazing points
    assert not unstable[: folds[0]].any()
    assert not stable[folds[0] + 1 : folds[1]].any()
    assert not unstable[folds[1] + 1 :].any()
    assert (found["orbit_residual"].values <= 1e-10).all()
    assert parameter[[0, -1]] == pytest.approx([-20, -300], rel=1e-12)


def test_orbits_of_the_ends_are_those_of_the_sweep(evolvent, stops: Path) -> None:
    """The sweep approaches an orbit to 1e-6."""
    found = follow(evolvent, stops, f"{AMPLITUDE}=-20:-300", "--method", "orbits")
    sweep = follow(evolvent, stops, f"{AMPLITUDE}=-20:-300:57", "--up")
    for value_index, end in ((0, 0), (-1, -1)):
        for name in ("transmission_error_standard_deviation", "dynamic_factor"):
            assert float(found[name][value_index, 0]) == pytest.approx(
                float(sweep[name][0, end, 0]), rel=1e-5
            )


def test_orbits_at_the_values_of_a_sweep_have_its_numbers(evolvent, stops: Path) -> None:
    """The deviation, up and down; the sweep approaches an orbit to 1e-6."""
    over = f"{AMPLITUDE}=-20:-300"
    found = follow(evolvent, stops, over, "--method", "orbits", "--values", "57")
    sweep = follow(evolvent, stops, f"{over}:57", "--both")
    value_index, stable = found["orbit_value"].values, found["orbit_stable"].values == 1
    assert (sweep["period"].values == 1).all()
    assert (found["orbit_kind"].values[value_index >= 0] == 0).all()
    np.testing.assert_array_equal(
        found["orbit_parameter"].values[value_index >= 0],
        sweep["parameter"].values[value_index[value_index >= 0]],
    )
    assert set(value_index.tolist()) == {-1, *range(57)}
    for direction in ("up", "down"):
        for i in range(57):
            motion = sweep.sel(direction=direction).isel(parameter=i)
            orbits = found.isel(point=np.flatnonzero((value_index == i) & stable))
            name = "transmission_error_standard_deviation"
            nearest = int(np.argmin(np.abs(orbits[name].values[:, 0] - float(motion[name][0]))))
            reported = float(orbits[name][nearest, 0])
            assert reported == pytest.approx(float(motion[name][0]), rel=1e-5), (direction, i)


def test_orbits_at_values_hold_and_are_the_same_each_time(evolvent, stops: Path) -> None:
    """Where two stable branches overlap both are reported, the unstable one between is not."""
    options = (f"{AMPLITUDE}=-30:-120", "--method", "orbits", "--values", "301")
    found, again = (follow(evolvent, stops, *options) for _ in range(2))
    xr.testing.assert_identical(found, again)
    reported = found["multiplier_status"].values == 1
    assert reported.sum() > 301
    assert (found["orbit_residual"].values[~reported] <= 1e-10).all()
    assert (found["orbit_residual"].values[reported] <= 1e-7).all()
    assert (found["orbit_value"].values[reported] >= 0).all()
    value_index, parameter = found["orbit_value"].values, found["orbit_parameter"].values
    low, high = sorted(parameter[found["orbit_kind"].values == FOLD])
    inside = (parameter > low) & (parameter < high) & (value_index >= 0)
    assert (found["orbit_stable"].values[value_index >= 0] == 1).all()
    for i in set(value_index[inside].tolist()):
        assert (value_index == i).sum() == 2
    turns = np.diff(np.sign(np.diff(parameter))) != 0
    assert turns.sum() == 2  # at the folds: other points are consecutive along the branch


def test_unstable_orbits_right_behind_a_fold_are_not_told(evolvent, stops: Path) -> None:
    """The stable branch ends at 105.81: values next to it are on both sides."""
    options = ("--method", "orbits", "--values", "3001")
    found = follow(evolvent, stops, f"{AMPLITUDE}=-30:-110", *options)
    stable, value_index = found["orbit_stable"].values == 1, found["orbit_value"].values
    assert (found["orbit_kind"].values == FOLD).any()
    assert stable[value_index >= 0].all()
    assert not stable[value_index < 0].all()


@pytest.mark.parametrize(
    ("case", "over", "n"),
    [
        ("stops", f"{AMPLITUDE}=-30:-120", 31),
        ("spur-pair", "wheels.pinion.loads.0.value=-50:-45", 6),
        ("compliant-pair", "wheels.pinion.loads.0.value=-100:-95", 6),
    ],
)
def test_orbits_that_are_told_are_those_that_are_found(
    evolvent, stops: Path, examples: Path, tmp_path: Path, case: str, over: str, n: int
) -> None:
    """A branch that starts at the value of a reported orbit starts at a computed orbit."""
    path = tmp_path / "case.yaml"
    path.write_text((stops if case == "stops" else examples / f"{case}.yaml").read_text())
    found = follow(evolvent, path, over, "--method", "orbits", "--values", str(n))
    reported = np.flatnonzero(found["multiplier_status"].values == 1)
    assert len(reported) >= n // 2
    parameter, to = found["orbit_parameter"].values, over.rsplit(":", 1)[1]
    compared = 0
    for k in reported[:: max(1, len(reported) // 3)]:
        from_here = f"{over.split('=')[0]}={float(parameter[k])!r}:{to}"
        again = follow(evolvent, path, from_here, "--method", "orbits")
        same = again.isel(point=0)
        deviation = "transmission_error_standard_deviation"
        if case == "stops" and abs(float(same[deviation][0] / found[deviation][k, 0]) - 1) > 1e-2:
            continue  # the motion of the start is that of the other stable branch
        compared += 1
        assert float(same["orbit_residual"]) <= 1e-10
        for name in (
            "transmission_error_mean",
            "transmission_error_standard_deviation",
            "transmission_error_max",
            "normal_force_max",
            "dynamic_factor",
            "share_one_pair",
        ):
            np.testing.assert_allclose(
                found[name].values[k], same[name].values, rtol=1e-6, err_msg=f"{name} at {k}"
            )
        assert float(found["orbit_time"][k]) == pytest.approx(float(same["orbit_time"]), rel=1e-8)
    assert compared >= 2


# ---- unknown periods ----


@pytest.mark.parametrize("damping", ["ratio", "flores"])
def test_period_under_torques_alone_is_found(evolvent, examples, tmp_path, damping: str) -> None:
    """Without time-dependent loads; the metrics agree with a sweep, which approaches to 1e-6."""
    law = "{law: flores, restitution: 0.8}" if damping == "flores" else "{law: ratio, value: 0.07}"
    case = tmp_path / "torques.yaml"
    case.write_text((examples / "spur-pair.yaml").read_text())
    over = "wheels.pinion.loads.0.value=-50:-45:2"
    options = ("--set", f"meshes.pinion-gear.damping={law}")
    found = follow(evolvent, case, over, "--method", "orbits", *options)
    sweep = follow(evolvent, case, over, "--up", *options)
    assert (found["orbit_stable"].values != 0).all()
    assert (found["orbit_residual"].values <= 1e-10).all()
    assert (np.diff(found["orbit_time"].values) > 0).all()  # less torque: slower
    for name in ("transmission_error_standard_deviation", "normal_force_mean"):
        np.testing.assert_allclose(
            found[name].values[[0, -1], 0], sweep[name].values[0, :, 0], rtol=1e-5
        )


# ---- rejected input ----


@pytest.mark.parametrize(
    ("options", "code", "part"),
    [
        (("--over", "wheels.a.teeth=20:40"), 2, "structure"),
        (("--over", f"{SPEED}=-500:-500"), 2, "the same value"),
        (("--over", f"{SPEED}=-500:500:3"), 3, "no common period"),
        (("--over", f"{SPEED}=-500:-600", "--both"), 2, "omit --up, --down and --both"),
        (("--over", f"{SPEED}=-500:-600", "--method", "shooting"), 2, "sweep or orbits"),
        (
            ("--over", f"{SPEED}=-500:-600", "--method", "sweep", "--values", "9"),
            2,
            "require --method",
        ),
        (("--over", f"{SPEED}=-500:-600", "--values", "1"), 2, "from 2 to 100000"),
        (("--over", f"{SPEED}=-500:-600", "--longest", "17"), 2, "from 1 to 16"),
        (("--over", "wheels.a.loads.0.kind=1:2"), 3, "must be one of"),
    ],
)
def test_what_cannot_be_is_refused_in_one_line(
    evolvent, tmp_path: Path, options: tuple[str, ...], code: int, part: str
) -> None:
    case = rectangular(1.0, 1, 1, "radau")
    del case["simulation"]["metrics"]
    path = tmp_path / "case.yaml"
    path.write_text(yaml.safe_dump(case))
    method = () if "--method" in options else ("--method", "orbits")
    done = evolvent("respond", path, "-o", tmp_path / "o.h5", *options, *method)
    assert done.returncode == code
    *_, line = done.stderr.strip().splitlines()
    assert part in done.stderr, line
    assert not list(tmp_path.glob("o.h5*"))


def test_where_no_motion_repeats_orbits_begin_at_its_last_state(evolvent, tmp_path: Path) -> None:
    """After the last doubling on the way down the motion at some speeds is chaotic."""
    case = rectangular(1.0, 1, 1, "radau")
    del case["simulation"]["metrics"]
    case["meshes"][0]["damping"] = {"law": "none"}
    path = tmp_path / "case.yaml"
    path.write_text(yaml.safe_dump(case))
    over = f"{SPEED}={-1.31 * UNIT!r}:{-1.32 * UNIT!r}"
    done = evolvent(
        *("respond", path, "--over", over, "--method", "orbits", "-o", tmp_path / "o.h5")
    )
    assert done.returncode == 0, done.stderr
    assert "the motion is not periodic: an orbit was found from its last state" in done.stderr
    assert "0 of them stable" in done.stderr.splitlines()[-1]


@pytest.mark.parametrize("damping", ["{law: none}", "{law: ratio, value: 0}"])
def test_an_undamped_mesh_has_an_orbit_though_no_motion_settles(
    orbits: Orbits, damping: str
) -> None:
    """The final motions of a sweep are not periodic: Newton's iteration starts from them.

    Compared with the periodic solution of the undamped oscillator. All multipliers have magnitude
    1, which is not stable, and there are no Neimark-Sacker points.
    """
    found = orbits(1.3, 1.35, "--set", f"meshes.ab.damping={damping}")
    assert found.sizes["branch"] == 1
    assert not (found["orbit_kind"] == 4).any()
    assert (found["orbit_stable"] == 0).all()
    np.testing.assert_allclose(largest(found), 1, atol=1e-8)
    np.testing.assert_allclose(frequencies(found)[[0, -1]], [1.3, 1.35], rtol=1e-12)
    scale = UNIT / OMEGA_1 * TEETH
    for at in (0, found.sizes["point"] - 1):
        omega = frequencies(found)[at] * scale
        expected = undamped_deviation(omega, RATIO)
        assert deviations(found)[at] == pytest.approx(expected, rel=1e-4)


def undamped_deviation(omega: float, ratio: float) -> float:
    """Standard deviation over F/k of the periodic solution of x'' + k(t) x = 1, k = 2 and 1."""
    pitch = 2 * math.pi / omega
    pieces = [(2, (ratio - 1) * pitch), (1, (2 - ratio) * pitch)]
    flow, shift = np.eye(2), np.zeros(2)
    for k, t in pieces:
        piece = expm(np.array([[0, 1], [-k, 0]]) * t)
        rest = np.array([1 / k, 0])
        flow, shift = piece @ flow, piece @ (shift - rest) + rest
    state = np.linalg.solve(np.eye(2) - flow, shift)
    values = []
    n = 20000
    for k, t in pieces:
        c, s = math.cos(math.sqrt(k) * t / n), math.sin(math.sqrt(k) * t / n)
        root, rest = math.sqrt(k), np.array([1 / k, 0])
        step = np.array([[c, s / root], [-root * s, c]])
        for _ in range(n):
            values.append((state[0] + (step @ (state - rest) + rest)[0]) / 2)
            state = step @ (state - rest) + rest
    weights = np.repeat([t / n for _, t in pieces], n)
    x = np.array(values)
    mean = np.average(x, weights=weights)
    return float(math.sqrt(np.average((x - mean) ** 2, weights=weights)))


def test_multipliers_are_undefined_where_flanks_just_touch(orbits: Orbits) -> None:
    """They depend on the side from which the orbit is approached: NaN, with a flag.

    Here the whole mesh separates after the grazing point, as the share of time without contact
    shows.
    """
    found = orbits(0.70, 0.77)
    grazing = np.isin(found["orbit_kind"].values, [5, 6])
    assert grazing.any()
    status, real = found["multiplier_status"].values, found["multiplier_real"].values
    assert (status[grazing] == 2).all()
    assert np.isnan(real[grazing]).all()
    assert (status[~grazing] == 0).all()
    assert np.isfinite(real[~grazing]).all()
    assert (found["orbit_stable"].values[grazing] == -1).all()
    assert (found["orbit_grazing"].values[~grazing] == 0).all()
    apart = found["share_no_contact"].values[:, 0] > 0
    for at in np.nonzero(grazing)[0]:
        if not apart[at - 1 : at + 2].all():  # else it separates elsewhere, too
            assert found["orbit_grazing"].values[at] == (2 if apart[at - 1 : at + 2].any() else 1)
