"""A case in other units: the same gearbox with all lengths, times and masses multiplied by factors.

The unit of a value is read from the program's table of keys, `evolvent show --keys`, so that new
keys are scaled automatically. Values that a case leaves to a default are not scaled.
"""

from __future__ import annotations

import re
import subprocess
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path
from typing import Any

Block = dict[str, Any]

# Powers of length, time and mass.
UNITS = {
    **{"": (0, 0, 0), "deg": (0, 0, 0), "m": (1, 0, 0), "s": (0, 1, 0), "kg": (0, 0, 1)},
    **{"Hz": (0, -1, 0), "rad/s": (0, -1, 0), "m/s": (1, -1, 0), "m/s2": (1, -2, 0)},
    **{"kg/m3": (-3, 0, 1), "kg m2": (2, 0, 1), "Pa": (-1, -2, 1), "1/Pa": (1, 2, -1)},
    **{"Pa s": (-1, -1, 1)},
    **{"K": (0, 0, 0), "W/(m K)": (1, -3, 1), "J/(kg K)": (2, -2, 0)},  # the kelvin is kept
    **{"N": (1, -2, 1), "N/m": (0, -2, 1), "N s/m": (0, -1, 1), "N s/m2": (-1, -1, 1)},
    **{"N m": (2, -2, 1), "N m/rad": (2, -2, 1), "N m s/rad": (2, -1, 1)},
}


@dataclass(frozen=True)
class Row:
    """A key of a block."""

    only: tuple[str, ...]  # kinds or laws with this key; empty: all
    type: str
    unit: str


@dataclass(frozen=True)
class Scales:
    """Factors of length, time and mass."""

    length: float = 1.0
    time: float = 1.0
    mass: float = 1.0

    def of(self, unit: str, block: Block) -> float:
        """Return the factor of a unit."""
        if unit == "N/m^exponent":
            length, time, mass = 1 - block["exponent"], -2, 1
        else:
            length, time, mass = UNITS[unit]
        return float(self.length**length * self.time**time * self.mass**mass)


@lru_cache
def keys(program: Path) -> dict[str, dict[str, list[Row]]]:
    """Rows of each block by key."""
    command = [program, "show", "--keys"]
    text = subprocess.run(command, check=True, capture_output=True, text=True).stdout
    blocks: dict[str, dict[str, list[Row]]] = {}
    for line in text.splitlines():
        if line.startswith("### "):
            rows = blocks.setdefault(line[4:], {})
        elif line.startswith("| `"):
            key, only, kind, unit = (cell.strip() for cell in line.split("|")[1:5])
            row = Row(tuple(re.findall("`(.*?)`", only)), kind, unit)
            rows.setdefault(key.strip("`"), []).append(row)
    return blocks


def scaled_case(program: Path, case: Block, scales: Scales) -> Block:
    """Return the case with every value multiplied by the factor of its unit."""
    table = keys(program)

    def scaled(value: Any, row: Row, block: Block) -> Any:
        inner = re.search(r"blocks? `(\w+)`", row.type) or re.search(r"block} `(\w+)`", row.type)
        if inner and row.type.startswith("{"):
            return {name: whole(inner[1], one) for name, one in value.items()}
        if inner:
            one = inner[1]
            return [whole(one, v) for v in value] if isinstance(value, list) else whole(one, value)
        if isinstance(value, dict):
            return {name: scaled(one, row, block) for name, one in value.items()}
        if isinstance(value, list):
            return [scaled(one, row, block) for one in value]
        if isinstance(value, str | bool) or row.unit == "":
            return value
        return value * scales.of(row.unit, block)

    def whole(name: str, block: Block) -> Block:
        given = {block.get("kind"), block.get("law"), block.get("model", "finite_elements")}
        result = {}
        for key, value in block.items():
            rows = table[name][key]
            fitting = [row for row in rows if not row.only or given & set(row.only)] or rows
            result[key] = scaled(value, fitting[0], block)
        return result

    return whole("case", case)
