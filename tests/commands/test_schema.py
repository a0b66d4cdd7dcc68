"""evolvent show --schema: a public validator decides as the table of keys does."""

from __future__ import annotations

import json
import re
import subprocess
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
import yaml
from jsonschema import Draft202012Validator

from commands.case_table import TAKEN_BY_THE_TABLE, Table
from example_cases import CASES, PLANS

Evolvent = Callable[..., subprocess.CompletedProcess[str]]
BLOCKS = re.findall(
    r"^### (\w+)$",
    (Path(__file__).resolve().parents[2] / "docs" / "reference" / "case_format.md").read_text(),
    re.MULTILINE,
)


@pytest.fixture(scope="session")
def schema(executable: Path) -> Draft202012Validator:
    done = subprocess.run([executable, "show", "--schema"], capture_output=True, check=True)
    text = json.loads(done.stdout)
    Draft202012Validator.check_schema(text)
    return Draft202012Validator(text)


@pytest.fixture(scope="session")
def table(executable: Path) -> Table:
    def shown(option: str) -> str:
        done = subprocess.run([executable, "show", option], capture_output=True, check=True)
        return done.stdout.decode()

    return Table(shown("--keys"), shown("--units"))


def test_every_example_is_accepted_and_a_plan_is_not(schema: Draft202012Validator) -> None:
    for path in CASES:
        schema.validate(yaml.safe_load(path.read_text()))
    assert PLANS
    for path in PLANS:
        assert not schema.is_valid(yaml.safe_load(path.read_text()))


def test_the_tests_know_every_block(table: Table) -> None:
    assert table.blocks == BLOCKS


def both(
    evolvent: Evolvent,
    folder: Path,
    schema: Draft202012Validator,
    cases: list[tuple[str, bool, Any]],
) -> list[str]:
    """Validate cases by the program and by the schema; return the unexpected results."""
    names = []
    for number, (_, _, case) in enumerate(cases):
        names.append(f"{number}.yaml")
        (folder / names[-1]).write_text(json.dumps(case))
    lines = evolvent("validate", *names).stderr.splitlines()
    assert len(lines) == len(cases)
    return [
        f"{what}: {line}; schema: {schema.is_valid(case)}"
        for (what, good, case), line in zip(cases, lines, strict=True)
        if (TAKEN_BY_THE_TABLE in line, schema.is_valid(case)) != (good, good)
    ]


@pytest.mark.parametrize("block", BLOCKS)
def test_what_the_table_decides_the_program_and_the_schema_decide_alike(
    evolvent: Evolvent, tmp_path: Path, schema: Draft202012Validator, table: Table, block: str
) -> None:
    """Of every key: valid values, the limits, wrong types and words, blocks without it."""
    cases = [
        (f"{row.key} ({', '.join(row.only_with)}): {what}", good, table.case(block, made))
        for row in table.of(block)
        for what, good, made in table.changes(row)
    ]
    cases.append(("an unknown key", False, table.case(block, table.block(block, no_such_key=1))))
    cases.append(("a list for a block", False, table.case(block, [1])))
    assert sum(not good for _, good, _ in cases) >= 3
    assert not both(evolvent, tmp_path, schema, cases)
