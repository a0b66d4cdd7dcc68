"""Deviations of flanks: rejected input, locations and messages."""

from __future__ import annotations

import json
import subprocess
from collections.abc import Callable
from pathlib import Path

import pytest

Evolvent = Callable[..., subprocess.CompletedProcess[str]]

CASE = 3
RELIEF = "wheels.pinion.tip_relief"

# option; part of the message
BAD_OPTIONS = {
    "negative amount": (
        f"{RELIEF}.amount=-1e-6",
        f"{RELIEF}.amount: is -1e-6 m, must be at least 0",
    ),
    "no start": (
        RELIEF + "={amount: 1e-6}",
        f"{RELIEF}: needs either 'diameter' or 'roll_angle', where it starts",
    ),
    "two starts": (
        RELIEF + "={amount: 1e-6, diameter: 0.06, roll_angle: 20}",
        "needs either 'diameter' or 'roll_angle', where it starts; it has both",
    ),
    "start past the tip": (
        f"{RELIEF}.diameter=0.0661",
        "starts at a diameter of 0.0661 m does not start on the active profile, which goes from "
        "0.0567806 m to 0.066 m",
    ),
    "start below the active profile": (
        f"{RELIEF}.diameter=0.0567",
        f"{RELIEF}.diameter: a relief that starts at a diameter of 0.0567 m",
    ),
    "roll angle past the tip": (
        "wheels.gear.root_relief={amount: 1e-6, roll_angle: 60}",
        "wheels.gear.root_relief.roll_angle: a relief that starts at a roll angle of 60 deg does "
        "not start on the active profile, which goes from 12.0838 deg to 30.775 deg",
    ),
    "a cubic": (f"{RELIEF}.shape=cubic", "must be one of linear, parabolic, not 'cubic'"),
    "negative crowning": (
        "wheels.gear.profile_crowning=-1e-6",
        "wheels.gear.profile_crowning: is -1e-6 m, must be at least 0 m",
    ),
    "class 0": ("wheels.gear.accuracy.class=0", "is 0, must be a whole number from 1 to 11"),
    "class 12": ("wheels.gear.accuracy.class=12", "is 12, must be a whole number from 1 to 11"),
    "negative seed": ("wheels.gear.accuracy.seed=-1", "is -1, must be a whole number from 0 to"),
    "negative runout": (
        "wheels.gear.eccentricity={amount: -1e-6}",
        "wheels.gear.eccentricity.amount: is -1e-6",
    ),
    "runout without amount": (
        "wheels.gear.eccentricity={phase: 3}",
        "eccentricity: needs either 'amount'",
    ),
    "tracked flanks": (
        "meshes.0.tracking=differential",
        "meshes.pinion-gear.tracking: flanks with deviations cannot be tracked; choose tracking "
        "closed_form",
    ),
}


def refused(result: subprocess.CompletedProcess[str], folder: Path) -> str:
    """Return the one line of a rejected run without output."""
    assert result.returncode == CASE, result.stderr
    assert result.stdout == ""
    assert result.stderr.count("\n") == 1
    assert list(folder.iterdir()) == []
    return result.stderr[:-1]


@pytest.mark.parametrize(("option", "reason"), BAD_OPTIONS.values(), ids=BAD_OPTIONS)
def test_a_senseless_deviation_is_refused_at_its_option(
    evolvent: Evolvent, examples: Path, tmp_path: Path, option: str, reason: str
) -> None:
    line = refused(evolvent("run", examples / "tip-relief.yaml", "--set", option), tmp_path)
    assert line.startswith(f"--set {option}: ")
    assert reason in line


def line_of(path: Path, text: str, after: str = "") -> int:
    """Line with the first `text`, from the line with `after` on."""
    lines = path.read_text().splitlines()
    start = next(i for i, line in enumerate(lines) if after in line)
    return next(i for i, line in enumerate(lines) if i >= start and text in line) + 1


@pytest.mark.parametrize(
    ("option", "key", "reason"),
    [
        (
            "wheels.gear.pitch_errors=[1e-6]",
            "accuracy:",
            "wheels.gear.accuracy: pitch errors are listed and generated from a class",
        ),
        (
            "wheels.gear.root_relief={amount: 1e-6, roll_angle: 26}",
            "tip_relief:",
            "wheels.gear.tip_relief: tip relief starts at a roll angle of 24.1885 deg, below that "
            "of root relief at 26 deg",
        ),
    ],
)
def test_what_contradicts_an_option_is_shown_in_the_file(
    evolvent: Evolvent, examples: Path, tmp_path: Path, option: str, key: str, reason: str
) -> None:
    case = examples / "tip-relief.yaml"
    line = refused(evolvent("run", case, "--set", option), tmp_path)
    assert line.startswith(f"{case}:{line_of(case, key, 'name: gear')}:")
    assert reason in line


def test_rigid_contacts_have_no_deviations(
    evolvent: Evolvent, examples: Path, tmp_path: Path
) -> None:
    options = ("--set", "meshes.0.contact={law: rigid}", "--set", "meshes.0.damping={law: none}")
    line = refused(evolvent("run", examples / "tip-relief.yaml", *options), tmp_path)
    assert (
        "meshes.pinion-gear.contact.law: flanks with deviations require an elastic contact" in line
    )


@pytest.mark.parametrize(
    "option",
    [
        "tip_relief={amount: 1e-6, diameter: 0.41}",
        "root_relief={amount: 1e-6, diameter: 0.41}",
        "profile_crowning=1e-6",
        "accuracy={class: 5}",
        "eccentricity={amount: 1e-6}",
        "pitch_errors=[0]",
    ],
)
def test_a_wheel_that_is_stated_by_its_pitch_radius_has_none(
    evolvent: Evolvent, examples: Path, tmp_path: Path, option: str
) -> None:
    result = evolvent("run", examples / "paper.yaml", "--set", f"wheels.pinion.{option}")
    key = option.partition("=")[0]
    assert f"wheels.pinion: '{key}' needs 'module' in the same block" in refused(result, tmp_path)


def test_a_wheel_needs_a_pitch_error_for_each_tooth(
    evolvent: Evolvent, examples: Path, tmp_path: Path
) -> None:
    text = (examples / "tip-relief.yaml").read_text()
    listed = text.replace("accuracy: {class: 5, seed: 2}", "pitch_errors: [0, 1.0e-6, 2.0e-6]")
    assert listed != text
    folder = tmp_path / "empty"
    folder.mkdir()
    case = tmp_path / "case.yaml"
    case.write_text(listed)
    line = refused(evolvent("run", case, cwd=folder), folder)
    assert line.startswith(f"{case}:{line_of(case, 'pitch_errors')}:")
    assert "3 pitch errors are given for 30 teeth; give one for each tooth" in line


def test_the_resolved_case_shows_deviations_with_their_defaults(
    evolvent: Evolvent, examples: Path
) -> None:
    shown = evolvent(
        "show", examples / "tip-relief.yaml", "--json", "--set", "wheels.gear.accuracy={class: 7}"
    )
    pinion, gear = json.loads(shown.stdout)["case"]["wheels"]
    assert pinion["tip_relief"] == {"amount": 12e-6, "diameter": 0.0615, "shape": "parabolic"}
    assert gear["accuracy"] == {"class": 7, "seed": 0}
    assert gear["profile_crowning"] == 0
    assert "eccentricity" not in gear


def test_show_tells_where_relief_begins_and_the_pitch_errors_of_a_class(
    evolvent: Evolvent, examples: Path
) -> None:
    """For scripts in SI units; ISO 1328-1, class 5, d = 60 mm, m = 3 mm: 6.5 um and 18 um."""
    case = examples / "tip-relief.yaml"
    pinion = json.loads(evolvent("show", case, "--json").stdout)["deviations"]["pinion"]
    errors = pinion["pitch_errors"]
    assert len(errors) == 20
    steps = [abs(a - b) for a, b in zip(errors, [errors[-1], *errors[:-1]], strict=True)]
    assert max(steps) == pytest.approx(6.5e-6, rel=1e-12)
    assert max(errors) - min(errors) == pytest.approx(18e-6, rel=1e-12)
    assert pinion["single_pitch_deviation"] == pytest.approx(6.5e-6, rel=1e-12)
    assert pinion["tip_relief_diameter"] == pytest.approx(0.0615, rel=1e-14)
    text = evolvent("show", case).stdout
    table = text[text.index("Deviations of the flanks of wheel pinion") :]
    assert "pitch errors of teeth 0 to 19 [um]" in table
    shown = table.split("[um]\n")[1].split()[:20]
    assert [float(word) for word in shown] == pytest.approx([1e6 * e for e in errors], abs=6e-4)


def test_show_has_no_deviations_of_perfect_wheels(evolvent: Evolvent, examples: Path) -> None:
    assert (
        json.loads(evolvent("show", examples / "paper.yaml", "--json").stdout)["deviations"] == {}
    )
    assert "Deviations" not in evolvent("show", examples / "paper.yaml").stdout
