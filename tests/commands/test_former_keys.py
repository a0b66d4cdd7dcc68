"""Keys renamed within format 1: former names mean the same wherever a key or a path is given."""

from __future__ import annotations

import json
import re
import shutil
import subprocess
import zipfile
import zlib
from collections.abc import Callable
from pathlib import Path
from typing import Any

import h5py
import numpy as np
import pytest
import yaml
from fmpy.validation import validate_fmu
from jsonschema import Draft202012Validator

from designs import read_folder, read_journal, write_design
from evolvent.sweep.spec import TOP_KEYS, read_spec

Evolvent = Callable[..., subprocess.CompletedProcess[str]]

PRESENT = "eccentricity: {amount: 8 um, phase: 30}"
FORMER = "runout: {amount: 8 um, phase: 30}"
HALVED = "eccentricity: {radial_runout: 16 um, phase: 30}"
WINDOW = "metrics: {from: 10 ms}"
FORMER_WINDOW = "numbers: {from: 10 ms}"
SHORT = ("--set", "simulation.duration=20 ms")


def written(examples: Path, path: Path, eccentricity: str, window: str) -> Path:
    """Write a pair with an eccentric pinion and a window."""
    text = (examples / "spur-pair.yaml").read_text()
    changed = text.replace("- name: pinion\n", f"- name: pinion\n  {eccentricity}\n", 1)
    changed = changed.replace("simulation:\n", f"simulation:\n  {window}\n", 1)
    assert changed.count(eccentricity) == changed.count(window) == 1
    path.write_text(changed)
    return path


def resolved(evolvent: Evolvent, *words: str | Path) -> Any:
    shown = evolvent("show", *words, "--json")
    assert shown.returncode == 0, shown.stderr
    return json.loads(shown.stdout)["case"]


def test_a_case_with_former_keys_is_the_case_with_the_present_ones(
    evolvent: Evolvent, examples: Path, tmp_path: Path
) -> None:
    present = resolved(evolvent, written(examples, tmp_path / "p.yaml", PRESENT, WINDOW))
    former = resolved(evolvent, written(examples, tmp_path / "f.yaml", FORMER, FORMER_WINDOW))
    assert former == present
    assert present["wheels"][0]["eccentricity"] == {"amount": 8e-6, "phase": 30}
    assert present["simulation"]["metrics"] == {"from": 0.01}


def test_half_the_radial_runout_is_the_eccentricity(
    evolvent: Evolvent, examples: Path, tmp_path: Path
) -> None:
    penetrations = []
    for name, block in (("amount", PRESENT), ("runout", HALVED), ("none", "profile_crowning: 0")):
        case = written(examples, tmp_path / f"{name}.yaml", block, WINDOW)
        done = evolvent("run", case, *SHORT, "-o", f"{name}.h5")
        assert done.returncode == 0, done.stderr
        with h5py.File(tmp_path / f"{name}.h5") as history:
            penetrations.append(history["penetration"][:])
    np.testing.assert_array_equal(penetrations[0], penetrations[1])
    assert np.abs(penetrations[0] - penetrations[2]).max() > 1e-8


@pytest.mark.parametrize(
    ("block", "what"),
    [
        ("{phase: 3}", "eccentricity: needs either 'amount', the distance"),
        ("{amount: 1 um, radial_runout: 2 um}", "give one of them"),
        ("{radial_runout: -1 um}", "radial_runout: is -1 um (-1.0e-06 m), must be at least 0 m"),
    ],
)
def test_an_eccentricity_is_stated_once(
    evolvent: Evolvent, examples: Path, block: str, what: str
) -> None:
    option = f"wheels.pinion.eccentricity={block}"
    result = evolvent("validate", examples / "spur-pair.yaml", "--set", option)
    assert result.returncode == 3
    assert what in result.stderr


def test_a_former_key_of_a_file_is_warned_of_at_its_location(
    evolvent: Evolvent, examples: Path, tmp_path: Path
) -> None:
    case = written(examples, tmp_path / "f.yaml", FORMER, FORMER_WINDOW)
    lines = case.read_text().splitlines()
    result = evolvent("validate", case)
    assert result.returncode == 0
    for former, present in (("runout", "eccentricity"), ("numbers", "metrics")):
        line = 1 + next(i for i, text in enumerate(lines) if text.startswith(f"  {former}:"))
        assert f"{case}:{line}:3: '{former}' is the former name of '{present}'" in result.stderr


def test_a_key_beside_its_former_name_is_refused(
    evolvent: Evolvent, examples: Path, tmp_path: Path
) -> None:
    case = written(examples, tmp_path / "b.yaml", f"{PRESENT}\n  {FORMER}", WINDOW)
    result = evolvent("validate", case)
    assert result.returncode == 3
    assert "'runout' is the former name of 'eccentricity', which is given too" in result.stderr


@pytest.mark.parametrize("block", [PRESENT, FORMER])
@pytest.mark.parametrize(
    "option",
    [
        "wheels.pinion.runout.amount=3 um",
        "wheels.0.runout={amount: 3 um, phase: 30}",
        "wheels.pinion.eccentricity.amount=3 um",
    ],
)
def test_options_take_both_names_whatever_the_file_has(
    evolvent: Evolvent, examples: Path, tmp_path: Path, block: str, option: str
) -> None:
    case = written(examples, tmp_path / "c.yaml", block, FORMER_WINDOW)
    options = ("--set", option, "--set", "simulation.numbers.to=18 ms")
    found = resolved(evolvent, case, *options)
    assert found["wheels"][0]["eccentricity"] == {"amount": 3e-6, "phase": 30}
    assert found["simulation"]["metrics"] == {"from": 0.01, "to": 0.018}


def test_a_wheel_may_have_a_former_key_for_its_name(
    evolvent: Evolvent, examples: Path, tmp_path: Path
) -> None:
    case = written(examples, tmp_path / "n.yaml", PRESENT, WINDOW)
    case.write_text(case.read_text().replace("pinion", "runout"))
    found = resolved(evolvent, case, "--set", "wheels.runout.runout.amount=2 um")
    assert found["wheels"][0]["name"] == "runout"
    assert found["wheels"][0]["eccentricity"]["amount"] == 2e-6


def test_a_batch_and_a_response_take_former_paths(
    evolvent: Evolvent, examples: Path, tmp_path: Path
) -> None:
    rows = {}
    for key, block in (("runout", FORMER), ("eccentricity", PRESENT)):
        case = written(examples, tmp_path / f"{key}.yaml", block, WINDOW).read_text()
        case = case.replace("duration: 50 ms", "duration: 20 ms")
        columns = {f"wheels.pinion.{key}.amount": [2e-6, 4e-6]}
        design = write_design(tmp_path / f"{key}-design.h5", columns, case)
        done = evolvent("batch", design, "-o", f"{key}-results", "-q")
        assert done.returncode == 0, done.stderr
        rows[key] = read_folder(tmp_path / f"{key}-results")
    assert sorted(rows["runout"]) == [0, 1]
    for index, row in rows["runout"].items():
        other = rows["eccentricity"][index]
        assert row["penetration_max"] == other["penetration_max"]
    assert rows["runout"][0]["penetration_max"] != rows["runout"][1]["penetration_max"]


def as_before(journal: Path, n_rows: int) -> None:
    """Leave the first rows of a journal, under the head of a program with other texts."""
    head, *rows = [line.rpartition(b',"check"')[0] for line in journal.read_bytes().splitlines()]
    head = re.sub(rb'"long_name":"', rb'"long_name":"formerly: ', head)
    start = zlib.crc32(head)
    lines = [(head, start), *((row, zlib.crc32(row, start)) for row in rows[:n_rows])]
    journal.write_bytes(b"".join(b'%b,"check":"%08x"}\n' % line for line in lines))


def test_a_half_finished_batch_of_the_program_before_continues(
    evolvent: Evolvent, examples: Path, tmp_path: Path
) -> None:
    """Its case and path have former keys, the results in its journal other texts."""
    case = written(examples, tmp_path / "c.yaml", FORMER, FORMER_WINDOW).read_text()
    case = case.replace("duration: 50 ms", "duration: 20 ms")
    columns = {"wheels.pinion.runout.amount": [2e-6, 4e-6, 6e-6]}
    design = write_design(tmp_path / "d.h5", columns, case)
    done = evolvent("batch", design, "-o", "r", "-q", "-j", "1")
    assert done.returncode == 0, done.stderr
    journal = tmp_path / "r" / "shard-1-of-1.jsonl"
    before = read_journal(journal)
    as_before(journal, 2)
    done = evolvent("batch", design, "-o", "r", "-q", "--resume")
    assert done.returncode == 0, done.stderr
    after = read_journal(journal)
    assert after.head["scalars"][0]["long_name"].startswith("formerly: ")
    assert after.results == before.results
    assert [row["at"] for row in after.rows[:2]] == [row["at"] for row in before.rows[:2]]
    counts = json.loads(evolvent("records", "r", "--counts").stdout)
    assert (counts["rows"], counts["done"], counts["torn"]) == (3, 3, 0)


def test_documents_and_examples_have_present_keys_only(root: Path) -> None:
    pages = [*root.glob("docs/*/*.md"), *root.glob("examples/*.yaml"), root / "README.md"]
    assert len(pages) > 40
    former = re.compile(
        r"\brunout(: *\{|=\{|\.amount)|simulation\.numbers\b|^\s*numbers:", re.MULTILINE
    )
    named = {page.name for page in pages if former.search(page.read_text(encoding="utf-8"))}
    assert named == {"case_format.md"}  # which names them


def test_the_documentation_has_every_key_of_a_plan(root: Path) -> None:
    text = (root / "docs" / "guides" / "sweeps.md").read_text(encoding="utf-8")
    table = text.split("## The plan")[1].split("\n\n| key | meaning |\n")[1].split("\n\n")[0]
    assert sorted(re.findall(r"^\| `(\w+)` \|", table, re.MULTILINE)) == sorted(TOP_KEYS)


def test_a_plan_takes_the_former_name_of_its_metrics(examples: Path, tmp_path: Path) -> None:
    text = (examples / "tutorial-sweep.yaml").read_text(encoding="utf-8")
    assert "\nmetrics: [" in text
    plans = {}
    for key in ("metrics", "numbers"):
        path = tmp_path / f"{key}.yaml"
        path.write_text(text.replace("\nmetrics: [", f"\n{key}: ["))
        shutil.copy(examples / "tutorial-pair.yaml", tmp_path)
        plans[key] = read_spec(path).metrics
    assert plans["numbers"] == plans["metrics"] == ("dynamic_factor", "transmission_error")


def test_an_fmu_lists_the_former_name_as_an_alias(
    evolvent: Evolvent, examples: Path, tmp_path: Path
) -> None:
    case = written(examples, tmp_path / "e.yaml", PRESENT, WINDOW)
    done = evolvent("fmu", case, "-o", "e.fmu")
    assert done.returncode == 0, done.stderr
    with zipfile.ZipFile(tmp_path / "e.fmu") as archive:
        text = archive.read("modelDescription.xml").decode()
    name = "wheels.pinion.eccentricity.amount"
    variable = re.search(rf'<Float64 name="{name}".*?</Float64>', text, re.DOTALL)
    assert variable
    assert '<Alias name="wheels.pinion.runout.amount"' in variable[0]
    assert validate_fmu(str(tmp_path / "e.fmu")) == []


def test_editors_accept_former_keys_as_deprecated(
    evolvent: Evolvent, examples: Path, tmp_path: Path
) -> None:
    schema = json.loads(evolvent("show", "--schema").stdout)
    case = written(examples, tmp_path / "f.yaml", FORMER, FORMER_WINDOW)
    Draft202012Validator(schema).validate(yaml.safe_load(case.read_text()))
    assert schema["$defs"]["wheel"]["properties"]["runout"]["deprecated"] is True
    assert schema["$defs"]["simulation"]["properties"]["numbers"]["deprecated"] is True
