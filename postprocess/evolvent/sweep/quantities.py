"""Values with units in a plan, converted by the program to the units of their keys."""

from __future__ import annotations

import json
import re
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from evolvent.errors import SweepError
from evolvent.sweep.program import call, find_program, last_message

AT_ONCE = 500  # options of one call
BEGINS_AS_NUMBER = re.compile(r"[-+]?\.?[0-9]")
SECONDS = "simulation.duration"  # a key whose unit is that of a plan's times


@dataclass(frozen=True)
class Quantity:
    """A text converted for its key."""

    value: float | None  # None: not a number
    unit: str  # of the key
    has_unit: bool  # the text contained a unit


@dataclass(frozen=True)
class Asked:
    """A text of a plan, and its key."""

    key_path: str  # for messages
    path: str
    text: str

    @property
    def option(self) -> str:
        """As the program takes it."""
        return f"{self.path}={self.text}"


def may_have_unit(value: Any) -> bool:
    """Whether it is a text that starts like a number; the program checks the rest."""
    return isinstance(value, str) and BEGINS_AS_NUMBER.match(value) is not None


def read_quantities(
    asked: Sequence[Asked], case: Path, program: Path | None
) -> dict[str, Quantity]:
    """Convert texts to the units of their keys by the program.

    Parameters
    ----------
    case : the base case, which has the keys.
    program : None: the one found by `find_program`.

    Returns
    -------
    By `Asked.option`.

    Raises
    ------
    SweepError
        A unit that the key does not accept, or a path that the case does not have.
    """
    options = list(dict.fromkeys(each.option for each in asked))
    read: dict[str, Quantity] = {}
    for first in range(0, len(options), AT_ONCE):
        some = options[first : first + AT_ONCE]
        words = [word for option in some for word in ("--convert", option)]
        done = call(program or find_program(), "show", case, *words)
        if done.returncode != 0:
            raise _refusal(last_message(done.stderr), asked)
        for row in json.loads(done.stdout):
            value = None if row["value"] is None else float(row["value"])
            read[row["option"]] = Quantity(value, row["unit"], row["given"] == "quantity")
    return read


def _refusal(message: str, asked: Iterable[Asked]) -> SweepError:
    """Error message of the program, with the location in the plan."""
    for each in asked:
        beginning = f"--convert {each.option}: "
        if message.startswith(beginning):
            return SweepError(f"{each.key_path}: is {each.text}; {message.removeprefix(beginning)}")
    return SweepError(message)


def with_units_read(top: Mapping[str, Any], case: Path, program: Path | None) -> dict[str, Any]:
    """Replace numbers with units in a plan by plain numbers, and set `units` to the key's unit."""
    asked: list[Asked] = []

    def note(value: Any, key_path: str, path: Any) -> None:
        if may_have_unit(value) and isinstance(path, str):
            asked.append(Asked(key_path, path, value))

    parameters = top.get("parameters")
    blocks = [p for p in parameters if isinstance(p, dict)] if isinstance(parameters, list) else []
    for i, block in enumerate(blocks):
        for key in ("value", "from", "to"):
            note(block.get(key), f"parameters.{i}.{key}", block.get("path"))
        values = block.get("values")
        for value in values if isinstance(values, list) else []:
            note(value, f"parameters.{i}.values", block.get("path"))
    window = top["window"] if isinstance(top.get("window"), dict) else {}
    for key, value in window.items():
        note(value, f"window.{key}", SECONDS)
    if not asked:
        return dict(top)
    read = read_quantities(asked, case, program)
    changed = {**top, "window": _read_block(window, SECONDS, read)} if window else dict(top)
    if blocks:
        changed["parameters"] = [
            _with_key_unit(each, f"parameters.{i}", read) for i, each in enumerate(parameters or [])
        ]
    return changed


def _read_value(value: Any, path: str, read: Mapping[str, Quantity]) -> Any:
    quantity = read.get(f"{path}={value}") if may_have_unit(value) else None
    return value if quantity is None or quantity.value is None else quantity.value


def _read_block(block: Mapping[str, Any], path: str, read: Mapping[str, Quantity]) -> Any:
    return {
        key: [_read_value(v, path, read) for v in value]
        if isinstance(value, list)
        else _read_value(value, path, read)
        for key, value in block.items()
    }


def _with_key_unit(block: Any, key_path: str, read: Mapping[str, Quantity]) -> Any:
    """Convert the values of one parameter."""
    path = block.get("path") if isinstance(block, dict) else None
    if not isinstance(path, str):
        return block
    values = {key: block[key] for key in ("value", "from", "to", "values") if key in block}
    flat = [v for value in values.values() for v in (value if isinstance(value, list) else [value])]
    units = {
        read[option].unit
        for option in (f"{path}={value}" for value in flat if may_have_unit(value))
        if read[option].has_unit
    }
    changed = {**block, **_read_block(values, path, read)}
    for unit in units:
        changed["units"] = key_unit(block.get("units", ""), unit, key_path)
    return changed


def key_unit(given: Any, unit: str, key_path: str) -> str:
    """Unit of the key; an error if the plan gives the column another unit."""
    if given not in ("", unit):
        raise SweepError(
            f"{key_path}: units is {given}, but values with units are stored in that of the key, "
            f"{unit or 'none'}; omit units"
        )
    return unit
