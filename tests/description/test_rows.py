"""The table of all rows: each is asked for, and nothing else is; texts, defaults, ranges."""

from __future__ import annotations

import math
import re
from pathlib import Path
from typing import Any

import pytest
import yaml

from kernel.description import (
    BLOCK,
    CHOICE,
    INTEGER,
    LIST,
    MAP,
    NAME,
    NAMED,
    NUMBER,
    TEXT_TYPE,
    Row,
    create,
    rows,
)
from kernel.gearbox import HOUSING, INITIAL, LOAD, MESH, NOTHING, SHAFT, WHEEL
from kernel.kernel import Kernel, Status

# numbers of a value, by type: a number, a whole one, a pair, a triple, a quaternion
SIZES = {NUMBER: 1, INTEGER: 1, 2: 2, 3: 3, 4: 4}
ASKED = re.compile(r'%(?:number|numbers|in_unit|whole|word|has|inner|elements)\("(\w+)"')
# they ask for the block
HANDED_ON = re.compile(r'\b(?:take_relief|lubricant_number)\((?:\w+, )+(?:\w+\(\w+\), )?"(\w+)"')
STRENGTH = {"strength", "sn"}  # the postprocessing of load spectra alone uses them
LAWS = {"contact", "damping", "friction"}  # law_table.f90 asks for all rows of the law chosen
READ = re.compile(r'\bnode_(?:get|find)\w*\([\w>-]+, "(\w+)"')


@pytest.fixture(scope="module")
def table(kernel: Kernel) -> list[Row]:
    return rows(kernel.library)


@pytest.fixture(scope="module")
def asked(root: Path) -> set[str]:
    """Keys that the kernel asks a block for."""
    source = "\n".join(file.read_text() for file in (root / "src").rglob("*.f90"))
    return {*ASKED.findall(source), *HANDED_ON.findall(source)}


@pytest.fixture(scope="module")
def read(root: Path) -> set[str]:
    """Keys that the driver asks a block for."""
    source = "\n".join(file.read_text() for file in (root / "driver").glob("*/*.c"))
    return set(READ.findall(source))


@pytest.fixture(scope="module")
def evaluated(root: Path) -> set[str]:
    """Keys that the postprocessing looks up in a case."""
    source = "\n".join(file.read_text() for file in (root / "postprocess").rglob("*.py"))
    return set(re.findall(r'"(\w+)"', source))


def test_every_key_that_the_kernel_asks_for_is_a_row(table: list[Row], asked: set[str]):
    assert asked
    assert asked - {row.key for row in table} == set()


def test_every_row_is_asked_for(
    table: list[Row], asked: set[str], read: set[str], evaluated: set[str]
):
    keys = {row.key for row in table if row.block not in LAWS | STRENGTH}
    assert keys - asked - read == {"strength"}
    assert {"strength", *(row.key for row in table if row.block in STRENGTH)} <= evaluated


def test_every_row_has_a_text(table: list[Row]):
    assert [(row.block, row.key) for row in table if not row.text] == []


def test_no_block_has_a_key_twice_in_one_variant(table: list[Row]):
    seen = [
        (row.block, row.key, variant)
        for row in table
        for variant in (
            [""] if row.variants.startswith(("+", "-")) else row.variants.split() or [""]
        )
    ]
    assert sorted(set(seen)) == sorted(seen)


def test_every_word_that_a_row_points_at_is_in_the_table(table: list[Row]):
    """Blocks, lists of references, keys that others need, variants."""
    blocks = {row.block for row in table}
    for row in table:
        own = [other for other in table if other.block == row.block]
        if row.type in (BLOCK, LIST, MAP):
            assert row.holds in blocks, row
        elif row.holds:
            assert row.holds in {other.key for other in table if other.block == "case"}, row
        if row.variants.startswith(("+", "-")):  # beside that key only, or never beside it
            assert row.variants[1:] in {other.key for other in own} - {row.key}, row
        else:
            assert {*row.variants.split()} <= {*own[0].words.split()}, row


def accepted(table: list[Row], row: Row, value: Any) -> bool:
    """Whether a value, as the case file has it, is one of a row."""
    if row.type in SIZES:
        numbers = value if isinstance(value, list) else [value]
        return len(numbers) == SIZES[row.type] and all(in_range(row, float(n)) for n in numbers)
    if row.type == CHOICE:
        return value in row.words.split()
    if row.type == BLOCK:
        return block_accepted(table, row.holds, value)
    if row.type == LIST:
        return isinstance(value, list) and in_range(row, len(value))
    if row.type == NAMED:
        return isinstance(value, dict) and all(in_range(row, n) for n in value.values())
    return row.type in (NAME, TEXT_TYPE) and isinstance(value, str)


def in_range(row: Row, value: float) -> bool:
    above = value > row.minimum if row.minimum_open else value >= row.minimum
    below = value < row.maximum if row.maximum_open else value <= row.maximum
    return math.isfinite(value) and above and below


def block_accepted(table: list[Row], block: str, value: dict[str, Any]) -> bool:
    """Whether a block has only keys of its variant, and all that are required."""
    of_block = [row for row in table if row.block == block]
    variant = value.get(of_block[0].key, of_block[0].default_text)
    own = {
        row.key: row
        for row in of_block
        if not row.variants
        or row.variants.startswith(("+", "-"))
        or variant in row.variants.split()
    }
    return {*value} <= {*own} and all(
        accepted(table, row, value[key]) if key in value else not row.required
        for key, row in own.items()
    )


def test_every_default_is_accepted_by_its_own_row(table: list[Row]):
    with_default = [row for row in table if row.default_text]
    assert len(with_default) > 40
    for row in with_default:
        default = row.default_text if row.type == NAME else yaml.safe_load(row.default_text)
        assert accepted(table, row, default), row


def test_no_row_is_both_required_and_given_a_default(table: list[Row]):
    assert [(row.block, row.key) for row in table if row.required and row.default_text] == []


BAD_ENTRIES: dict[str, tuple[dict[str, Any], int, int, str]] = {
    "a material": (
        {"materials": {"lead": {"density": -1.0}}},
        NOTHING,
        -1,
        "materials.lead.density",
    ),
    "a support": (
        {"wheels": [{}, {"support": {"mass": -1.0}}]},
        *(WHEEL, 1, "support.mass"),
    ),
    "the second load of the second wheel": (
        {"wheels": [{"loads": [{}]}, {"loads": [{}, {"against": "void"}]}]},
        *(LOAD, 2, "against"),
    ),
    "a law": ({"meshes": [{"friction": {"law": "wet"}}]}, MESH, 0, "friction.law"),
    "a shaft": ({"shafts": [{"stiffness": 0.0}]}, SHAFT, 0, "stiffness"),
    "a mount": (
        {"housing": {"mount": {"stiffness": (1.0, -1.0, 1.0)}}},
        *(HOUSING, -1, "mount.stiffness"),
    ),
    "a term of a motion": (
        {"housing": {"rotation": [{}, {"axis": "w"}]}},
        *(HOUSING, -1, "rotation.1.axis"),
    ),
    "the duration": ({"simulation": {"duration": 0.0}}, NOTHING, -1, "simulation.duration"),
    "the start": ({"simulation": {"initial": {"kind": "asleep"}}}, INITIAL, -1, "kind"),
    "gravity": ({"gravity": (0.0, math.inf, 0.0)}, NOTHING, -1, "gravity"),
}


@pytest.mark.parametrize("name", BAD_ENTRIES)
def test_a_refused_entry_is_found_wherever_it_stands(kernel: Kernel, name: str):
    """Subject, index and field: of what belongs to no subject the field is the whole path."""
    case, *location = BAD_ENTRIES[name]
    status = Status()
    assert not create(kernel.library, case, status)
    assert [status.subject, status.index, status.field.decode()] == location


def nested(table: list[Row], block: str, inner: dict[str, Any]) -> dict[str, Any]:
    """A case with nothing but a block where it belongs."""
    while block != "case":
        holder = next(row for row in table if row.holds == block and row.type in (BLOCK, LIST, MAP))
        held: Any = {LIST: [inner], MAP: {"one": inner}}.get(holder.type, inner)
        inner, block = {holder.key: held}, holder.block
    return inner


def test_every_number_out_of_its_range_is_refused_by_the_kernel(kernel: Kernel, table: list[Row]):
    """Below it, above it, or no number at all: nothing behind the rows needs to look again."""
    seen = 0
    for row in table:
        if (
            row.type not in (NUMBER, INTEGER)
            or sum((other.block, other.key) == (row.block, row.key) for other in table) > 1
        ):  # one key of several kinds: the kind decides
            continue
        ends = [row.minimum - max(1, abs(row.minimum)), row.maximum + max(1, abs(row.maximum))]
        ends += [row.minimum] * row.minimum_open + [row.maximum] * row.maximum_open
        for value in [math.nan, math.inf, -math.inf, *(end for end in ends if math.isfinite(end))]:
            given = math.radians(value) if row.unit == "deg" else value
            status = Status()
            assert not create(kernel.library, nested(table, row.block, {row.key: given}), status)
            assert row.key in status.field.decode(), (row, value)
            assert row.key in status.message.decode(), (row, value)
            seen += 1
    assert seen > 200
