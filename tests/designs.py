"""Designs for `evolvent batch`, and its results in a folder."""

from __future__ import annotations

import json
import re
import zlib
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import h5py
import numpy as np

ROOT = Path(__file__).resolve().parents[1]
TEXT = h5py.string_dtype()
CHECKSUM_MARK = b"evolvent-seal"
TIMINGS = ("cpu_time", "at", "check")  # fields that differ between two runs of one case


def paper_case(duration: float = 0.02, name: str = "paper-friction.yaml") -> str:
    """The paper's case with a short duration."""
    text = (ROOT / "examples" / name).read_text(encoding="utf-8")
    return re.sub(r"duration: [\d.e+-]+( m?s\b)?", f"duration: {duration!r}", text)


def version() -> str:
    """Version of the program in CMakeLists.txt."""
    text = (ROOT / "CMakeLists.txt").read_text()
    found = re.search(r"project\(\s*evolvent\s+VERSION\s+([\d.]+)", text)
    assert found
    return found[1]


def write_design(
    path: Path,
    columns: Mapping[str, Sequence[Any]],
    case: str | None = None,
    window: tuple[float, float] = (np.nan, np.nan),
    histories: str = "",
    every: int = 1,
    **attributes: object,
) -> Path:
    """Write a design as another program does; `attributes` replace its own, None removes one."""
    n = len(next(iter(columns.values())))
    case = paper_case() if case is None else case
    all_attributes: dict[str, object] = {
        "evolvent_design_format": 1,
        "evolvent_version": version(),
        "title": "a test",
        "case": case,
        "window": np.array(window),
        "history_variables": histories,
        "history_every": every,
        "n_cases": np.int64(n),
        **attributes,
    }
    with h5py.File(path, "w", userblock_size=512) as file:
        for name, value in all_attributes.items():
            if value is not None:
                file.attrs[name] = value
        group = file.create_group("parameters")
        for i, (where, values) in enumerate(columns.items()):
            is_text = n > 0 and isinstance(values[0], str)
            column = group.create_dataset(
                f"p{i}",
                data=list(values) if is_text else np.array(values),
                dtype=TEXT if is_text else None,
            )
            column.attrs.update({"path": where, "name": f"x{i}", "units": "1"})
    write_checksum(path)
    return path


def write_checksum(path: Path, at_end: bool = False) -> None:
    """Write the checksum of a file by docs/reference/result_format.md; replace an existing one."""
    content = path.read_bytes()
    if at_end:
        content = content[:-64] if content[-64:].startswith(CHECKSUM_MARK) else content
    else:
        content = content[64:]
    line = CHECKSUM_MARK + f" 1 crc32 {zlib.crc32(content):08x} of {len(content)} bytes".encode()
    line = line.ljust(63) + b"\n"
    path.write_bytes(content + line if at_end else line + content)


@dataclass(frozen=True)
class Journal:
    """A journal, read as `evolvent-sweep collect` does."""

    head: dict[str, Any]
    rows: list[dict[str, Any]]  # complete lines, in order
    torn: int

    @property
    def cases(self) -> dict[int, dict[str, Any]]:
        """The latest row of each case."""
        return {row["case"]: row for row in self.rows}

    @property
    def results(self) -> dict[int, dict[str, Any]]:
        """Rows without timings, which differ between runs."""
        return {
            case: {name: value for name, value in row.items() if name not in TIMINGS}
            for case, row in self.cases.items()
        }


def read_journal(path: Path) -> Journal:
    """Read the complete lines of a journal."""
    objects, torn = [], 0
    for line in path.read_bytes().splitlines(keepends=True):
        try:
            assert line.endswith(b"\n")
            objects.append(json.loads(line))
        except (AssertionError, ValueError):
            torn += 1
    return Journal(objects[0], objects[1:], torn)


def read_folder(folder: Path) -> dict[int, dict[str, Any]]:
    """Results of all shards of a folder; no case may be in two of them."""
    together: dict[int, dict[str, Any]] = {}
    for path in sorted(folder.glob("*.jsonl")):
        results = read_journal(path).results
        assert not together.keys() & results.keys()
        together |= results
    return together
