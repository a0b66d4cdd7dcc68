"""`evolvent modes`: its output, and its errors."""

from __future__ import annotations

import json
import re
import signal
import subprocess
from collections.abc import Callable
from pathlib import Path

import pytest

from processes import catches, wait_for

Evolvent = Callable[..., subprocess.CompletedProcess[str]]


@pytest.fixture
def case(examples: Path) -> Path:
    return examples / "paper.yaml"


def assert_refused(result: subprocess.CompletedProcess[str], code: int, *parts: str) -> None:
    """One line on stderr that contains all parts, nothing on stdout."""
    (line,) = result.stderr.splitlines()
    assert result.returncode == code
    assert result.stdout == ""
    for part in parts:
        assert part in line


def test_text_and_json_tell_the_same_numbers(evolvent: Evolvent, case: Path) -> None:
    text = evolvent("modes", case).stdout
    modes = json.loads(evolvent("modes", case, "--json").stdout)["modes"]
    rows = re.findall(
        r"^ +d?\d+  +(\S+)  +(\S+)  +(\S+)  (\S+)(?: \+- (\S+)i)?$", text, re.MULTILINE
    )
    assert len(rows) == len(modes) == 3
    for (frequency, ratio, time, real, imaginary), mode in zip(rows, modes, strict=True):
        shown = [
            (frequency, mode["natural_frequency"], 1e-5),  # number of printed digits
            (ratio, mode["damping_ratio"], 1e-3),
            (time, mode["time_constant"], 1e-3),
            (real, mode["eigenvalue"][0], 1e-5),
            (imaginary or "0", mode["eigenvalue"][1], 1e-5),
        ]
        for printed, exact, precision in shown:
            if exact is None:
                assert printed == "-"
            else:
                assert float(printed) == pytest.approx(exact, rel=precision)


def test_the_text_names_state_units_and_every_coordinate(evolvent: Evolvent, case: Path) -> None:
    result = evolvent("modes", case)
    assert (result.returncode, result.stderr) == (0, "")
    assert result.stdout.startswith(f"Case {case}, linearised at its steady state under load\n")
    for part in ("[Hz]", "[1/s]", "[s]", "[deg]", "rad/s", "loaded", "1 rigid-body mode"):
        assert part in result.stdout
    for coordinate in ("rotation", "displacement of the slider", "penetration h", "Delta"):
        assert result.stdout.count(coordinate) >= 3
    assert max(map(len, result.stdout.splitlines())) <= 110


def test_at_a_time_the_modes_of_contact_and_friction_are_told(
    evolvent: Evolvent, examples: Path
) -> None:
    words = ("modes", examples / "paper-friction.yaml", "--at", "1.2")
    assert "linearised at t = 1.2 s" in evolvent(*words).stdout
    state = json.loads(evolvent(*words, "--json").stdout)["state"]
    assert (state["kind"], state["time"]) == ("at", 1.2)
    mesh = state["meshes"]["pinion-gear"]
    assert (mesh["contact"], mesh["friction_branch"]) == ("loaded", 1)


def test_nothing_is_written_but_standard_output(
    evolvent: Evolvent, case: Path, tmp_path: Path
) -> None:
    assert evolvent("modes", case, "--at", "0.01").returncode == 0
    assert list(tmp_path.iterdir()) == []


def test_the_steady_state_is_that_of_the_loads_whatever_the_initial_state(
    evolvent: Evolvent, case: Path
) -> None:
    steady = ("--set", "simulation.initial={kind: steady}")
    from_rest = evolvent("modes", case, "--json")
    assert from_rest.stdout == evolvent("modes", case, "--json", *steady).stdout


def test_the_motion_settles_into_the_steady_state(evolvent: Evolvent, case: Path) -> None:
    def slowest(*words: str) -> dict[str, float]:
        return json.loads(evolvent("modes", case, "--json", *words).stdout)["modes"][0]

    # After 20 time constants 2e-9 of the start remain.
    late = slowest("--at", "30", "--set", "simulation.duration=30")
    assert late["time_constant"] == pytest.approx(slowest()["time_constant"], rel=1e-7)


def test_without_a_steady_state_the_time_is_asked_for(evolvent: Evolvent, case: Path) -> None:
    result = evolvent("modes", case, "--set", "wheels.gear.loads=[]")
    assert_refused(result, 3, str(case), "no steady state", "--at TIME")


def test_a_load_of_the_wrong_sense_is_refused_at_its_place(evolvent: Evolvent, case: Path) -> None:
    result = evolvent("modes", case, "--set", "wheels.pinion.loads.0.value=1")
    assert_refused(
        result, 3, "wheels.pinion.loads.0.value", "has the wrong sense", "opens the drive"
    )


@pytest.mark.parametrize("time", ["-1", "soon", ".inf", "-1 ms"])
def test_a_time_that_is_none_is_misuse(evolvent: Evolvent, case: Path, time: str) -> None:
    result = evolvent("modes", case, "--at", time)
    assert_refused(result, 2, f"--at {time}: ", "at least 0")


def test_a_time_with_a_unit_is_that_in_seconds(evolvent: Evolvent, case: Path) -> None:
    assert (
        evolvent("modes", case, "--at", "0 ms").stdout
        == evolvent("modes", case, "--at", "0").stdout
    )
    assert_refused(
        evolvent("modes", case, "--at", "1 m"), 2, "--at 1 m: ", "write the time in s, ms"
    )


def test_a_time_past_the_end_of_the_case_is_refused_with_the_remedy(
    evolvent: Evolvent, case: Path
) -> None:
    result = evolvent("modes", case, "--at", "6")
    assert_refused(result, 3, "--at 6: ", "5 s", "--set simulation.duration=6")


def test_a_bad_case_is_refused_as_everywhere(evolvent: Evolvent, case: Path) -> None:
    result = evolvent("modes", case, "--set", "wheels.gear.teeth=-3")
    assert_refused(result, 3, "wheels.gear.teeth: is -3")


def test_a_motion_that_leaves_the_model_exits_with_4(evolvent: Evolvent, case: Path) -> None:
    overload = ("--set", "wheels.pinion.loads.0.value=-1e9")
    result = evolvent("modes", case, "--at", "1", *overload)
    assert_refused(result, 4, f"{case}: t = ", "exceeds the limit")


def test_an_interrupt_while_integrating_exits_with_75(executable: Path, case: Path) -> None:
    many_steps = ("--set", "simulation.duration=1e5", "--set", "simulation.max_step=1e-5")
    words = ["modes", str(case), "--at", "1e5", *many_steps]
    with subprocess.Popen(
        [str(executable), *words], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True
    ) as process:
        wait_for(lambda: catches(process.pid, signal.SIGINT))
        with pytest.raises(subprocess.TimeoutExpired):
            process.wait(1)  # it is far from finished
        process.send_signal(signal.SIGINT)
        output, complaint = process.communicate(timeout=60)
    assert (process.returncode, output) == (75, "")
    assert "interrupted by SIGINT" in complaint


def test_a_state_that_grows_is_called_unstable(evolvent: Evolvent, case: Path) -> None:
    # In y the gear has no support; the contact pushes it away like a compressed strut, since the
    # line of action turns with the axis.
    loose = "wheels.gear.support={kind: bearing, stiffness: [1.0e+9, 0], damping: [1.0e+5, 0]}"
    words = ("modes", case, "--at", "0.001", "--set", loose)
    modes = json.loads(evolvent(*words, "--json").stdout)["modes"]
    assert any(mode["time_constant"] < 0 for mode in modes)
    assert "this state is unstable" in evolvent(*words).stdout
    assert "unstable" not in evolvent("modes", case).stdout


# ---- state of the mesh


@pytest.fixture
def real(examples: Path) -> Path:
    return examples / "spur-pair.yaml"


@pytest.mark.parametrize(
    ("option", "words", "kind"),
    [
        ([], ["at its steady state under load"], "steady"),
        (["--mesh-position", "0.25"], ["at its steady state", " 0.25 pitches"], "steady"),
        (["--mean"], ["with the mean over one pitch"], "mean"),
        (["--at", "0.001"], ["at t = 0.001 s"], "at"),
    ],
)
def test_the_output_names_the_state_that_was_linearised(
    evolvent: Evolvent, real: Path, option: list[str], words: list[str], kind: str
) -> None:
    head = evolvent("modes", real, *option).stdout.split("\n\n")[0]
    for word in words:
        assert word in head
    state = json.loads(evolvent("modes", real, *option, "--json").stdout)["state"]
    assert state["kind"] == kind
    position = {"['--mesh-position', '0.25']": 0.25}.get(str(option))
    assert state["mesh_position"] == position


def test_the_position_of_the_mesh_decides_how_many_pairs_there_are(
    evolvent: Evolvent, real: Path
) -> None:
    for position, pairs in (
        ("0", 1),
        ("0.01", 2),
        ("0.48", 2),
        ("0.51", 1),
        ("0.99", 1),
        ("7.3", 2),
    ):
        result = evolvent("modes", real, "--json", "--mesh-position", position)
        mesh = json.loads(result.stdout)["state"]["meshes"]["pinion-gear"]
        assert mesh["pairs_in_contact"] == pairs, position
        assert mesh["position"] == pytest.approx(float(position) % 1, abs=1e-12)


EXCLUSIVE = (["--at", "0.01"], ["--mesh-position", "0.5"], ["--mean"])


@pytest.mark.parametrize("omitted", range(3))
def test_states_exclude_each_other(evolvent: Evolvent, real: Path, omitted: int) -> None:
    words = [word for i, option in enumerate(EXCLUSIVE) if i != omitted for word in option]
    result = evolvent("modes", real, *words)
    assert (result.returncode, result.stdout) == (2, "")
    for option in EXCLUSIVE:
        assert f"'{option[0]}'" in result.stderr.splitlines()[0]


@pytest.mark.parametrize("position", ["-0.1", "half", ".nan", "1e7"])
def test_a_position_that_is_none_is_misuse(evolvent: Evolvent, real: Path, position: str) -> None:
    result = evolvent("modes", real, "--mesh-position", position)
    assert_refused(result, 2, f"--mesh-position {position}: ", "pitches", "1e6")


@pytest.mark.parametrize("option", [["--mean"], ["--mesh-position", "0.5"]])
def test_a_chosen_state_that_does_not_exist_is_refused(
    evolvent: Evolvent, real: Path, option: list[str]
) -> None:
    rest = ("--set", "simulation.initial={kind: rest}")
    result = evolvent("modes", real, *rest, "--set", "wheels.gear.loads=[]", *option)
    assert_refused(result, 3, "no steady state", "--at TIME")
    result = evolvent(
        "modes",
        real,
        "--set",
        "meshes.0.contact={law: rigid}",
        "--set",
        "meshes.0.damping={law: none}",
        *option,
    )
    assert_refused(result, 3, "rigid", "elastic law")
