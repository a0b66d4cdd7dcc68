"""Table of keys as printed by `evolvent show --keys`, and cases built from it.

A case of `Table.case` has the required keys of the table and two wheels with the same name. The
program detects the latter after all checks of the table: its message shows whether the table
accepts a case.
"""

from __future__ import annotations

import math
import re
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

TAKEN_BY_THE_TABLE = "the name 'a' is given to two wheels"
ROW = re.compile(r"^\| `(\w+)` \|(.*?)\| (.*?) \| (.*?) \| (.*?) \| (.*?) \| (.*?) \| (.*) \|$")
LENGTHS = {"[x, y]": 2, "[x, y, z]": 3, "[w, x, y, z]": 4}
ABSENT = object()  # a value: the key is omitted


@dataclass(frozen=True)
class Row:
    """A key of a block."""

    block: str
    key: str
    only_with: tuple[str, ...]
    not_with: tuple[str, ...]
    type: str  # type without its alternatives
    words: tuple[str, ...]
    unit: str
    low: float
    high: float
    is_low_open: bool
    is_high_open: bool
    plausible: str  # range of magnitudes as printed; empty if none is given
    default: str
    is_required: bool

    @classmethod
    def read(cls, block: str, line: str) -> Row:
        """Parse a line of the table."""
        match = ROW.match(line)
        assert match, line
        key, only_with, kind, unit, limits, plausible, default, _ = match.groups()
        words = tuple(re.findall(r"`([^`]*)`", kind))
        return cls(
            block=block,
            key=key,
            only_with=() if "not" in only_with else tuple(re.findall(r"`([^`]*)`", only_with)),
            not_with=tuple(re.findall(r"not `([^`]*)`", only_with)),
            type=re.sub(r"( or)? `.*", "", kind),
            words=words,
            unit=unit,
            plausible=plausible.strip(),
            default=default.strip("` "),
            is_required=default.strip() == "required",
            **limits_of(limits),
        )

    @property
    def is_whole(self) -> bool:
        return self.type == "whole number"

    @property
    def holds(self) -> str:
        """The block that is its value or in its value."""
        is_block = self.type in ("block", "list of blocks", "{name: block}")
        return self.words[0] if is_block else ""

    @property
    def number(self) -> float | int:
        """A number in the range."""
        if self.is_whole:
            return int(self.low if math.isfinite(self.low) else 1)
        if math.isfinite(self.low) and math.isfinite(self.high):
            return 0.5 * (self.low + self.high)
        return self.low + 1.0 if math.isfinite(self.low) else min(1.0, self.high - 1.0)

    def with_number(self, number: Any) -> Any:
        """A value that contains this number."""
        if self.type in LENGTHS:
            return [number, *[self.number] * (LENGTHS[self.type] - 1)]
        if self.type == "list of numbers":
            return [self.number, number]
        return {"a": number} if self.type == "{name: number}" else number

    @property
    def has_numbers(self) -> bool:
        kinds = ("number", "whole number", "list of numbers", "{name: number}")
        return self.type in kinds or self.type in LENGTHS


def limits_of(text: str) -> dict[str, Any]:
    """Parse a range given in words."""
    found: dict[str, Any] = {"low": -math.inf, "high": math.inf}
    found |= {"is_low_open": "greater than" in text, "is_high_open": "less than" in text}
    if match := re.search(r"from (\S+) to (\S+)", text):
        found |= {"low": float(match[1]), "high": float(match[2])}
    if match := re.search(r"(?:greater than|at least) (\S+)", text):
        found["low"] = float(match[1])
    if match := re.search(r"(?:less than|at most) (\S+)", text):
        found["high"] = float(match[1])
    return found


class Table:
    """All rows."""

    def __init__(self, markdown: str, units: str) -> None:
        """Parse the output of `show --keys` and `show --units`."""
        reported = [line.split(" | ") for line in units.splitlines()[2:]]
        self.units = {key.strip("` "): re.findall("`([^`]+)`", names) for _, key, names in reported}
        self.rows: list[Row] = []
        for part in markdown.split("### ")[1:]:
            block, _, lines = part.partition("\n")
            table = [line for line in lines.splitlines() if line.startswith("| `")]
            self.rows += [Row.read(block, line) for line in table]

    @property
    def blocks(self) -> list[str]:
        return list(dict.fromkeys(row.block for row in self.rows))

    def of(self, block: str) -> list[Row]:
        """The rows of a block."""
        return [row for row in self.rows if row.block == block]

    def selector(self, block: str) -> Row | None:
        """The row that selects the kind of a block."""
        first = self.of(block)[0]
        return first if first.key in ("kind", "law", "model") and first.words else None

    def needs(self, row: Row) -> str:
        """The key that this one requires."""
        chooser = self.selector(row.block)
        is_of_kinds = chooser is not None and set(row.only_with) <= set(chooser.words)
        return row.only_with[0] if row.only_with and not is_of_kinds else ""

    def variants(self, row: Row) -> tuple[str, ...]:
        """The kinds of its block that have it."""
        chooser = self.selector(row.block)
        if chooser is None or row is chooser:
            return ("",)
        return row.only_with or chooser.words

    def good(self, row: Row) -> Any:
        """A value that the table accepts."""
        if row.block == "case" and row.key == "format":
            return 1
        if row.has_numbers:
            return row.with_number(row.number)
        if row.holds:
            count = max(1, int(row.low)) if math.isfinite(row.low) else 1
            names = [chr(ord("a") + i) for i in range(count)]
            made = self.block(row.holds)
            return (
                made
                if row.type == "block"
                else [made] * count
                if "list" in row.type
                else dict.fromkeys(names, made)
            )
        if row.type == "one of":
            return {"true": True, "false": False}.get(row.words[0], row.words[0])
        return ["a", "b"] if row.type == "[name, name]" else "a"

    def block(self, name: str, variant: str = "", /, **given: Any) -> dict[str, Any]:
        """A block of a kind, by default the first one, with all required keys."""
        chooser = self.selector(name)
        made: dict[str, Any] = {}
        if chooser is not None:
            variant = variant or chooser.words[0]
            made[chooser.key] = variant
        for row in self.of(name):
            is_of_it = not row.only_with or variant in row.only_with or self.needs(row) in given
            if row.is_required and row is not chooser and is_of_it:
                made[row.key] = self.good(row)
        for row in self.of(name):
            if row.key in given and self.needs(row) and variant not in row.only_with:
                first = next(r for r in self.of(name) if r.key == self.needs(row))
                made.setdefault(first.key, self.good(first))
        made.update(given)
        return {key: value for key, value in made.items() if value is not ABSENT}

    def case(self, name: str, block: Any) -> dict[str, Any]:
        """The smallest case with this block in it; its wheels have one name."""
        while name != "case":
            row = next(row for row in self.rows if row.holds == name)
            value = (
                block if row.type == "block" else [block] if "list" in row.type else {"a": block}
            )
            if "list" in row.type and row.low > 1:
                value = [block, self.block(name)]
            name, block = (
                row.block,
                self.block(row.block, self.variants(row)[0], **{row.key: value}),
            )
        return block

    def changes(self, row: Row) -> Iterator[tuple[str, bool, dict[str, Any]]]:
        """Blocks with this row: description, whether the table accepts it, the block."""
        for variant in self.variants(row):
            yield "a good value", True, self.block(row.block, variant, **{row.key: self.good(row)})
        variant = self.variants(row)[0]

        def with_value(value: Any) -> dict[str, Any]:
            return self.block(row.block, variant, **{row.key: value})

        yield "nothing where a value belongs", False, with_value(None)
        yield "no value", not row.is_required, with_value(ABSENT)
        if row.has_numbers:
            yield from ((what, good, with_value(value)) for what, good, value in self.numbers(row))
        if row.words and not row.holds:
            yield from (
                (f"the word {word}", True, with_value(word))
                for word in row.words
                if row is not self.selector(row.block)
            )
            yield "an unknown word", False, with_value("no_such_word")
        if row.holds:
            yield "text for a block", False, with_value("a")
            if "list" in row.type or "name" in row.type:
                empty: Any = [] if "list" in row.type else {}
                yield "none of them", row.low < 1, with_value(empty)
                yield (
                    "the other kind of container",
                    False,
                    with_value({"a": 1} if empty == [] else [1]),
                )
        if row.type == "name":
            for name in ("5", "-1e3", "inf", "a b", "a/b", "a=b", "a.b", "", 65 * "a"):
                value: Any = float(name) if name in ("5", "-1e3") else name
                yield f"the name '{name}'", False, with_value(value)
        if row.type == "[name, name]":
            yield "three names", False, with_value(["a", "b", "c"])
            yield "one name", False, with_value("a")
        if "name of" in row.type or row.type == "text":
            yield "a list for a text", False, with_value(["a"])
        yield from self.elsewhere(row)

    def numbers(self, row: Row) -> Iterator[tuple[str, bool, Any]]:
        """Values of a row of numbers."""
        yield "text for a number", False, row.with_number("many")
        yield "a truth value for a number", False, row.with_number(True)
        yield (
            "a block for a number",
            False,
            {"no": {}} if row.type == "{name: number}" else {"a": 1},
        )
        yield "a list in a number", False, row.with_number([1])
        if row.type in LENGTHS:
            yield "one more number", False, [row.number] * (LENGTHS[row.type] + 1)
            yield "one number for several", False, row.number
        if row.is_whole:
            yield "half a number", False, row.number + 0.5
            yield "a whole number with a decimal point", True, float(row.number)
            yield "too large a whole number", False, 1e12
        if row.block == "case" and row.is_whole:  # the format, of which there is one
            return
        yield from self.quantities(row)
        for limit, is_open, beyond in (
            (row.low, row.is_low_open, -1.0),
            (row.high, row.is_high_open, 1.0),
        ):
            if math.isfinite(limit):
                limit = int(limit) if row.is_whole else limit
                past = limit + (
                    int(beyond) if row.is_whole else beyond * max(1.0, abs(limit)) * 1e-6
                )
                yield f"the limit {limit}", not is_open, row.with_number(limit)
                yield f"past the limit {limit}", False, row.with_number(past)

    def quantities(self, row: Row) -> Iterator[tuple[str, bool, Any]]:
        """Numbers with units. Ranges are those of the key's own unit."""
        own = self.units[row.unit] if not row.is_whole else []
        yield "text of a number", False, row.with_number(f"{row.number}")
        for unit in ("no_such_unit", "", *(names[0] for names in self.units.values())):
            if unit not in own:
                yield f"1 {unit}", False, row.with_number(f"1 {unit}")
        for unit in own:
            if unit == row.unit or (row.low <= 0.0 and math.isinf(row.high)):
                number = row.number if unit == row.unit else 1
                yield f"{number} {unit}", True, row.with_number(f"{number} {unit}")
                joined = not unit[0].isdigit()  # 11/min cannot be joined
                yield f"{number}{unit}", joined, row.with_number(f"{number}{unit}")

    def elsewhere(self, row: Row) -> Iterator[tuple[str, bool, dict[str, Any]]]:
        """The row in blocks where it has no meaning."""
        chooser = self.selector(row.block)
        for other in row.not_with:
            of_other = next(r for r in self.of(row.block) if r.key == other)
            both = {row.key: self.good(row), other: self.good(of_other)}
            yield f"beside {other}", False, self.block(row.block, **both)
        if self.needs(row):
            alone = self.block(row.block, **{row.key: self.good(row)})
            alone.pop(self.needs(row))
            yield f"without {self.needs(row)}", False, alone
        elif chooser is not None and row is not chooser:
            with_key = {v for r in self.of(row.block) if r.key == row.key for v in self.variants(r)}
            for variant in set(chooser.words) - with_key:
                block = self.block(row.block, variant, **{row.key: self.good(row)})
                yield f"with {variant}", False, block
