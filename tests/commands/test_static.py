"""`evolvent static`: its files and output, and its errors."""

from __future__ import annotations

import json
import re
import signal
import subprocess
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
import xarray as xr

from processes import catches, wait_for

Evolvent = Callable[..., subprocess.CompletedProcess[str]]
ANALYTIC = [
    *("--set", "wheels.0.compliance={model: analytic}"),
    *("--set", "wheels.1.compliance={model: analytic}"),
]
PITCH_ERRORS = ("--set", f"wheels.0.pitch_errors={[1e-6 * (k % 5) for k in range(19)]}")


@pytest.fixture
def case(examples: Path) -> Path:
    return examples / "spur-pair.yaml"


def opened(path: Path) -> xr.Dataset:
    with xr.open_dataset(path, engine="h5netcdf") as file:
        return file.load()


@pytest.fixture
def curves(evolvent: Evolvent, case: Path, tmp_path: Path) -> xr.Dataset:
    path = tmp_path / "harris.h5"
    result = evolvent("static", case, "--torque", "10:100:4", "-o", path, *ANALYTIC)
    assert result.returncode == 0, result.stderr
    return opened(path)


def assert_refused(result: subprocess.CompletedProcess[str], code: int, *parts: str) -> None:
    """One line on stderr that contains all parts, nothing on stdout."""
    assert result.returncode == code, result.stderr
    line = result.stderr.splitlines()[-1]
    assert result.stdout == ""
    for part in parts:
        assert part in line


def test_file_has_its_own_axes(curves: xr.Dataset) -> None:
    assert dict(curves.sizes) == {"torque": 4, "position": 200, "pair": 3, "harmonic": 10}
    np.testing.assert_allclose(curves["torque"], [10, 40, 70, 100], rtol=1e-15)
    np.testing.assert_allclose(curves["position"], np.arange(200) / 200, rtol=1e-15)
    assert curves["pair"].values.tolist() == [-1, 0, 1]
    assert curves["harmonic"].values.tolist() == list(range(1, 11))
    assert curves["transmission_error"].dims == ("torque", "position")
    assert curves["pair_normal_force"].dims == ("torque", "position", "pair")
    assert curves["harmonic_amplitude"].dims == ("torque", "harmonic")
    assert curves["free_transmission_error"].dims == ("position",)
    assert curves["contact_ratio"].dims == ()
    for name, variable in curves.variables.items():
        assert variable.attrs["long_name"], name
        assert "units" in variable.attrs, name


def test_documentation_lists_what_a_file_has(curves: xr.Dataset, root: Path) -> None:
    text = (
        (root / "docs" / "reference" / "result_format.md")
        .read_text()
        .split("## Static analysis")[1]
        .split("\n### Root stress")[0]
    )
    rows = re.findall(r"^\| `(\w+)` \| ([^|]*) \| ([^|]*) \|", text, re.MULTILINE)
    listed = {name: (tuple(dims.replace(",", " ").split()), units) for name, dims, units in rows}
    reported = {str(n): (v.dims, v.attrs["units"]) for n, v in curves.data_vars.items()}
    assert listed == reported


def test_attributes_tell_what_it_is(curves: xr.Dataset) -> None:
    found = curves.attrs
    assert found["evolvent_kind"] == "static"
    assert found["evolvent_format"] == 1
    assert (found["mesh"], found["points"], found["pitches"]) == ("pinion-gear", 200, 1)
    assert (found["status"], found["status_message"]) == ("done", "")
    assert "compliance: {model: analytic" in found["case"]


def test_histories_and_stacks_tell_what_they_are(
    evolvent: Evolvent, case: Path, tmp_path: Path
) -> None:
    path = tmp_path / "run.h5"
    assert evolvent("run", case, "-o", path, "--set", "simulation.duration=1e-4").returncode == 0
    assert opened(path).attrs["evolvent_kind"] == "history"


def test_values_are_those_of_the_summary(curves: xr.Dataset) -> None:
    h = curves["transmission_error"]
    np.testing.assert_allclose(curves["mean_transmission_error"], h.mean("position"), rtol=1e-12)
    spread = h.max("position") - h.min("position")  # extremes are between positions
    np.testing.assert_allclose(curves["peak_to_peak_transmission_error"], spread, rtol=1e-2)
    assert (curves["peak_to_peak_transmission_error"] >= spread * (1 - 1e-9)).all()
    spectrum = 2 * np.abs(np.fft.rfft(h, axis=1))[:, 1:11] / 200
    np.testing.assert_allclose(curves["harmonic_amplitude"], spectrum, rtol=1e-6)
    # an edge of the driving wheel has a shorter lever arm than its base radius
    np.testing.assert_allclose(curves["force_share"].sum("pair"), 1, atol=1e-2)
    force = curves["torque"] / curves["base_radius_driving"]
    np.testing.assert_allclose(curves["tooth_force"], force, rtol=1e-13)


def test_torque_is_that_of_the_loads_and_the_file_named_after_the_case(
    evolvent: Evolvent, case: Path, tmp_path: Path
) -> None:
    result = evolvent("static", case, *ANALYTIC, cwd=tmp_path)
    assert result.returncode == 0
    assert [p.name for p in tmp_path.iterdir()] == ["spur-pair-static.h5"]
    np.testing.assert_allclose(opened(tmp_path / "spur-pair-static.h5")["torque"], [50], rtol=1e-12)
    assert result.stderr.endswith("200 positions, 1 torque: spur-pair-static.h5\n")


def test_text_and_json_tell_the_same_numbers(
    evolvent: Evolvent, case: Path, tmp_path: Path
) -> None:
    words = ("static", case, "--torque", "20:60:3", "-o", tmp_path / "x.h5")
    text = evolvent(*words).stdout
    reported = json.loads(evolvent(*words, "--json").stdout)
    rows = [line.split() for line in text.splitlines()]
    numbers = [row for row in rows if len(row) == 9 and row[0][0].isdigit()]
    assert len(numbers) == 3
    columns = (
        ("torque", 1.0),
        ("line_load", 1e-3),
        ("mean_transmission_error", 1e6),
        ("peak_to_peak_transmission_error", 1e6),
        ("mesh_stiffness_per_width", 1e-9),
        ("loaded_contact_ratio", 1.0),
        ("largest_force_share", 1.0),
        ("largest_contact_pressure", 1e-6),
        ("largest_edge_force", 1.0),
    )
    for i, (name, factor) in enumerate(columns):
        printed = [float(row[i]) for row in numbers]
        np.testing.assert_allclose(printed, np.array(reported[name]) * factor, rtol=6e-4)
    assert "ISO 6336-1" in text


@pytest.mark.parametrize(("rounding", "is_said"), [("0", True), ("0.1 mm", False)])
def test_a_largest_pressure_without_sharp_edges_says_so(
    evolvent: Evolvent, case: Path, tmp_path: Path, rounding: str, *, is_said: bool
) -> None:
    """Compliant teeth contact each other's tip edges: only rounded ones have a pressure."""
    rounded = [
        *("--set", f"wheels.0.tip_rounding={rounding}"),
        *("--set", f"wheels.1.tip_rounding={rounding}"),
    ]
    path = tmp_path / "edges.h5"
    done = evolvent("static", case, "--torque", "500", "-o", path, *ANALYTIC, *rounded)
    assert done.returncode == 0, done.stderr
    edges = opened(path).pair_contact_kind.values > 1
    assert edges.any()
    assert bool(np.isnan(opened(path).pair_contact_pressure.values[edges]).any()) == is_said
    assert ("Largest pressure without corner contact" in done.stdout) == is_said
    said = re.search(r"; corner contact, no rounding given: .* force ([\d.]+) kN", done.stdout)
    force = float(opened(path).sharp_edge_force[0])
    assert (force > 0) == (said is not None) == is_said
    if said is not None:
        assert float(said[1]) == pytest.approx(force / 1e3, rel=5e-3)


def test_a_damping_ratio_without_a_load_is_no_matter_at_rest(
    evolvent: Evolvent, case: Path, tmp_path: Path
) -> None:
    """A damping ratio refers to the case's load; `--torque` gives one. A motion is rejected."""
    unloaded = ("--set", "wheels.0.loads=[]", "--set", "wheels.1.loads=[]")
    shown = []
    for law in ("{law: ratio, value: 0.05}", "{law: linear, coefficient: 1000}"):
        words = (*unloaded, "--set", f"meshes.0.damping={law}")
        path = tmp_path / "rest.h5"
        done = evolvent("static", case, "--torque", "100", "-o", path, "--json", *words)
        assert done.returncode == 0, done.stderr
        shown.append(done.stdout)
        if law.startswith("{law: ratio"):
            for command in (
                ("run", "-o", tmp_path / "run.h5"),
                ("validate",),
                ("show",),
                ("modes",),
            ):
                refused = evolvent(command[0], case, *command[1:], *words)
                assert refused.returncode == 3
                assert "meshes.pinion-gear.damping.value: a damping ratio needs" in refused.stderr
            untold = evolvent("static", case, "-o", path, *words)
            assert untold.returncode == 3
            assert "give one with --torque" in untold.stderr
    assert shown[0] == shown[1]


def test_what_is_missing_is_said_once_without_compliance(
    evolvent: Evolvent, case: Path, tmp_path: Path
) -> None:
    words = ("static", case, "-o", tmp_path / "x.h5")
    assert "Only the contacts are compliant" in evolvent(*words).stdout
    assert "Only the contacts" not in evolvent(*words, *ANALYTIC).stdout
    assert evolvent(*words, "-q").stdout == ""


def test_any_mesh_is_found_by_name_and_index(
    evolvent: Evolvent, examples: Path, tmp_path: Path
) -> None:
    case = examples / "two-stage-gears.yaml"
    for words in (("--mesh", "1"), ("--mesh", "second")):
        path = tmp_path / "x.h5"
        assert evolvent("static", case, *words, "-o", path).returncode == 0
        assert opened(path).attrs["mesh"] == "second"


def test_teeth_that_differ_are_all_met(evolvent: Evolvent, case: Path, tmp_path: Path) -> None:
    path = tmp_path / "x.h5"
    result = evolvent("static", case, "--points", "30", "-o", path, *PITCH_ERRORS)
    assert "570 positions over 19 pitches, until the same teeth meet again" in result.stdout
    assert opened(path)["position"].values[-1] == pytest.approx(19 - 1 / 30)


def test_examples_of_the_help_work(evolvent: Evolvent, examples: Path, tmp_path: Path) -> None:
    lines = evolvent("static", "--help").stdout.splitlines()
    words = [line.split()[1:] for line in lines if line.startswith("  evolvent static examples")]
    assert len(words) == 3
    for each in words:
        each[1] = str(examples.parent / each[1])
        assert evolvent(*each, cwd=tmp_path).returncode == 0


@pytest.mark.parametrize(
    ("words", "parts"),
    [
        (["--mesh", "pinion-geer"], ["--mesh pinion-geer", "did you mean 'pinion-gear'?"]),
        (["--mesh", "1"], ["--mesh 1", "no such mesh"]),
        (["--mesh", "0.5"], ["--mesh 0.5", "no such mesh"]),
        (["--torque", "0"], ["--torque 0", "give one above 0, in the sense of driving_rotation"]),
        (["--torque", "-50:50:4"], ["--torque -50:50:4", "those below 0 the coast flanks"]),
        (["--torque", "0:50:4"], ["--torque 0:50:4", "0 loads none; give torques of one sign"]),
        (["--speed", "fast"], ["--speed fast", "speed of the driving wheel [rad/s]"]),
        (["--speed", "inf"], ["--speed inf", "speed of the driving wheel [rad/s]"]),
        (["--torque", "50:10:3"], ["--torque 50:10:3", "it must be FROM:TO:STEPS"]),
        (["--torque", "10:50"], ["--torque 10:50", "it must be FROM:TO:STEPS"]),
        (["--torque", "10:50:1"], ["--torque 10:50:1", "from 2 to 1000"]),
        (["--torque", "10:50:2.5"], ["it must be FROM:TO:STEPS"]),
        (["--torque", "10:50:3:4"], ["it must be FROM:TO:STEPS"]),
        (["--torque", ".inf"], ["it must be FROM:TO:STEPS"]),
        (["--torque", "much"], ["it must be FROM:TO:STEPS"]),
        (["--torque", "10:50 N m:3"], ["one of its torques has a unit", "both a unit, or neither"]),
        (["--torque", "10 N:50 N:3"], ["'N' is a unit of force; write the torque in N m, kN m"]),
        (["--torque", "0.05 kN m:10 N m:3"], ["it must be FROM:TO:STEPS"]),
        (["--speed", "3 m/s"], ["--speed 3 m/s", "write the angular velocity in rpm, 1/min"]),
        (["--points", "20"], ["--points 20", "21 or more show 10 harmonics"]),
        (["--points", "many"], ["--points many", "whole number of positions a pitch"]),
    ],
    ids=lambda words: " ".join(words),
)
def test_bad_options_are_named_and_exit_with_2(
    evolvent: Evolvent, case: Path, tmp_path: Path, words: list[str], parts: list[str]
) -> None:
    assert_refused(evolvent("static", case, *words, cwd=tmp_path), 2, *parts)
    assert not any(tmp_path.iterdir())


def test_torques_and_speeds_with_units_are_those_in_newton_metres_and_radians_a_second(
    evolvent: Evolvent, case: Path, tmp_path: Path
) -> None:
    def reported(torque: str, speed: str) -> str:
        words = ("--torque", torque, "--speed", speed, "--points", "21", "--json", "-o", "out.h5")
        return evolvent("static", case, *words, cwd=tmp_path).stdout

    bare = reported("10:200:3", "157.07963267948966")
    assert '"torque"' in bare
    assert reported("10 N m:0.2 kN m:3", "1500 rpm") == bare
    assert reported("10000 Nmm:200 N·m:3", "1500 min-1") == bare


def test_too_many_positions_exit_with_2(evolvent: Evolvent, case: Path, tmp_path: Path) -> None:
    words = ("--points", "100000", *PITCH_ERRORS)
    assert_refused(
        evolvent("static", case, *words, cwd=tmp_path), 2, "--points 100000", "19 pitches of 100000"
    )


@pytest.mark.parametrize(
    ("name", "words", "parts"),
    [
        ("paper", [], [":40:3", "meshes.pinion-gear", "give both wheels a module"]),
        ("paper-rigid", [], ["meshes.pinion-gear", "give both wheels a module"]),
        (
            "spur-pair",
            [
                *("--set", "meshes.0.contact={law: linear, stiffness: 1e8}"),
                *("--set", "meshes.0.damping={law: none}"),
            ],
            ["--set", "meshes.pinion-gear.contact.law", "contact law: johnson"],
        ),
        (
            "spur-pair",
            [
                *("--set", "wheels.0.loads=[]", "--set", "wheels.1.loads=[]"),
                *("--set", "meshes.0.damping={law: none}"),
            ],
            ["no torque on mesh pinion-gear", "--torque 50"],
        ),
    ],
    ids=["no module", "rigid", "other law", "no load"],
)
def test_cases_without_an_answer_exit_with_3(
    evolvent: Evolvent,
    examples: Path,
    tmp_path: Path,
    name: str,
    words: list[str],
    parts: list[str],
) -> None:
    result = evolvent("static", examples / f"{name}.yaml", *words, cwd=tmp_path)
    assert_refused(result, 3, *parts)
    assert not any(tmp_path.iterdir())


def test_load_beyond_the_model_leaves_what_was_found(
    evolvent: Evolvent, case: Path, tmp_path: Path
) -> None:
    """Contact alone: under 1e9 N m the deflection of the teeth exceeds the path length."""
    result = evolvent("static", case, "--torque", "100:1e9:3", "-o", tmp_path / "x.h5")
    assert_refused(result, 3, "under 5E+08 N m", "the torques before it are in", "x.h5.partial")
    partial = opened(tmp_path / "x.h5.partial")
    assert partial.attrs["status"] == "failed"
    assert "under 5E+08 N m" in partial.attrs["status_message"]
    assert partial["torque"].values.tolist() == [100.0]
    assert not (tmp_path / "x.h5").exists()


def test_interrupt_leaves_what_was_found(executable: Path, case: Path, tmp_path: Path) -> None:
    words = [
        executable,
        "static",
        case,
        "--torque",
        "1:1000:1000",
        "--points",
        "2000",
        "-o",
        "x.h5",
    ]
    with subprocess.Popen(words, cwd=tmp_path, stderr=subprocess.PIPE, text=True) as process:
        wait_for(
            lambda: (tmp_path / "x.h5.partial").exists() and catches(process.pid, signal.SIGINT)
        )
        process.send_signal(signal.SIGINT)
        _, error = process.communicate(timeout=60)
    assert process.returncode == 75
    assert "interrupted by SIGINT; the torques before it are in 'x.h5.partial'" in error
    assert opened(tmp_path / "x.h5.partial").attrs["status"] == "interrupted"


def test_unwritable_output_exits_with_74(evolvent: Evolvent, case: Path, tmp_path: Path) -> None:
    words = ("static", case, "-o", tmp_path / "nowhere" / "x.h5")
    assert_refused(evolvent(*words), 74, "cannot write", "create the folder first")


def test_case_is_not_replaced_by_its_result(evolvent: Evolvent, case: Path, tmp_path: Path) -> None:
    copy = tmp_path / "case.yaml"
    copy.write_text(case.read_text())
    result = evolvent("static", copy, "-o", copy)
    assert_refused(result, 2, "the result would replace the case")
    assert copy.read_text() == case.read_text()


def test_same_case_gives_the_same_file(evolvent: Evolvent, case: Path, tmp_path: Path) -> None:
    for name in ("a.h5", "b.h5"):
        assert evolvent("static", case, "-o", tmp_path / name, *ANALYTIC).returncode == 0
    assert (tmp_path / "a.h5").read_bytes() == (tmp_path / "b.h5").read_bytes()


def test_mean_modes_have_the_mean_tangent_stiffness(
    evolvent: Evolvent, case: Path, tmp_path: Path
) -> None:
    """Except for the slope of the pair compliance, and for the viscous load: 1e-3 of it."""
    soft = ("--set", "wheels.0.compliance={}", "--set", "wheels.1.compliance={}")
    words = (case, *soft, "--set", "meshes.0.friction={law: none}", "--json")
    reported = json.loads(evolvent("static", *words, "-o", tmp_path / "x.h5").stdout)
    mass = json.loads(evolvent("show", *words).stdout)["meshes"]["pinion-gear"]["reference_mass"]
    modes = json.loads(evolvent("modes", "--mean", *words).stdout)["modes"]
    expected = np.sqrt(reported["mean_tangent_stiffness"][0] / mass) / (2 * np.pi)
    assert modes[-1]["natural_frequency"] == pytest.approx(expected, rel=2e-3)


def test_mean_modes_pass_places_without_a_balance(evolvent: Evolvent, case: Path) -> None:
    """A damper's force jumps as flanks close: at one of 997 positions neither mode is balanced.

    There the damping of the contacts is omitted.
    """
    model = "{model: analytic}"
    words = (case, "--set", f"wheels.0.compliance={model}", "--set", f"wheels.1.compliance={model}")
    words = (*words, "--set", "meshes.0.friction={law: none}")
    alone = evolvent("modes", *words, "--mesh-position", repr(948.5 / 997))
    assert alone.returncode == 0, alone.stderr
    mean = evolvent("modes", "--mean", *words, "--json")
    assert mean.returncode == 0, mean.stderr
    near = [
        json.loads(evolvent("modes", *words, "--mesh-position", x, "--json").stdout)["modes"]
        for x in ("0.25", "0.75")
    ]
    low, high = sorted(modes[-1]["natural_frequency"] for modes in near)
    assert low < json.loads(mean.stdout)["modes"][-1]["natural_frequency"] < high


def test_iso_stiffness_at_low_load_goes_by_the_tangential_load(
    evolvent: Evolvent, case: Path, tmp_path: Path
) -> None:
    """ISO 6336-1: below F_t K_A/b = 100 N/mm c' falls with the fourth root of that load."""
    words = ("static", case, "--json", "-o", tmp_path / "x.h5")
    reported = json.loads(evolvent(*words, "--torque", "1:400:2").stdout)
    radius = 0.003 * 19 / 2  # of the pinion's reference circle
    width = reported["common_width"]
    low, high = reported["iso_pair_stiffness_per_width"]
    assert 400 / radius / width > 1e5  # of the second torque
    assert low / high == pytest.approx((1 / radius / width / 1e5) ** 0.25, rel=1e-9)


def test_a_mesh_far_softer_than_iso_says_why(
    evolvent: Evolvent, case: Path, tmp_path: Path
) -> None:
    """Below 0.8 of c_gamma: the bodies are compliant down to the bore if no hub is given."""

    def text(hub: str) -> str:
        soft = [("--set", f"wheels.{i}.compliance={{{hub}}}") for i in (0, 1)]
        thin = ("--set", "wheels.1.bore=10e-3")
        words = ("static", case, *soft[0], *soft[1], *thin, "-o", tmp_path / "x.h5")
        return evolvent(*words, "--torque", "100").stdout

    assert "of c_gamma: the bodies are compliant down to hub_diameter" in text("")
    assert "of c_gamma: the bodies" not in text("hub_diameter: 40e-3")
