"""Designs, and journals and histories as `evolvent batch` writes them, without running anything."""

from __future__ import annotations

import json
import zlib
from collections.abc import Iterable
from pathlib import Path
from typing import Any

import h5py
import numpy as np

from evolvent.sweep.design import LAST_HALF, Design, Parameter, write_design

PAPER = Path(__file__).resolve().parents[2] / "examples" / "paper.yaml"
SCALARS = [
    {"name": "penetration_max", "units": "m", "long_name": "largest penetration"},
    {"name": "steps", "units": "1", "long_name": "steps of the integrator"},
    {"name": "cpu_time", "units": "s", "long_name": "processor time"},
]
BEGAN = 1_700_000_000.0  # Unix time of the first record


def make_design(parameters: dict[str, Any] | int = 10, **changes: Any) -> Design:
    """Make a design of these columns; a number stands for one column `load` of that length."""
    if isinstance(parameters, int):
        parameters = {"load": np.linspace(1.0, 2.0, parameters)}
    columns = tuple(
        Parameter(name, f"some.{name}", "N", np.asarray(values))
        for name, values in parameters.items()
    )
    settings: dict[str, Any] = {
        "title": "A sweep",
        "case": "format: 1\n",
        "parameters": columns,
        "n_cases": columns[0].values.size,
        "window": LAST_HALF,
        "metrics": (),
        "history_variables": (),
        "history_every": 1,
        "plan": "a plan",
        "method": "list",
        "seed": 0,
        "version": "0.1.0",
    }
    return Design(**{**settings, **changes})


def header(design: Design, shard: int = 1, of: int = 1) -> dict[str, Any]:
    """First line of a journal."""
    return {
        "journal": 2,
        "design": design.hash,
        "shard": shard,
        "of": of,
        "n_cases": design.n_cases,
        "evolvent": "0.1.0",
        "scalars": SCALARS,
    }


def row(case: int, **changes: Any) -> dict[str, Any]:
    """Record of a case that is done; its results follow from its number."""
    return {
        "case": case,
        "status": "done",
        "exit": 0,
        "message": "",
        "penetration_max": (case + 1) / 1e9,
        "steps": 100 + case,
        "cpu_time": 0.02,
        "at": BEGAN + case,
        **changes,
    }


def failed(case: int, message: str = "contact was lost", **changes: Any) -> dict[str, Any]:
    """Record of a case that failed."""
    nothing = {scalar["name"]: None for scalar in SCALARS}
    return row(case, **{"status": "failed", "exit": 4, "message": message, **nothing, **changes})


def write_journal(
    folder: Path, design: Design, rows: Iterable[dict[str, Any]], shard: int = 1, of: int = 1
) -> Path:
    """Write the journal of a shard and what the folder needs beside it."""
    folder.mkdir(parents=True, exist_ok=True)
    (folder / "design.txt").write_text(f"{design.hash}\n")
    if not (folder / "design.h5").exists():
        write_design(design, folder / "design.h5")
    path = folder / f"shard-{shard}-of-{of}.jsonl"
    with path.open("w") as journal:
        head = line_of(header(design, shard, of))
        journal.writelines(f"{line}\n" for line in [head, *(line_of(row, head) for row in rows)])
    return path


def line_of(row: dict[str, Any], head: str = "") -> str:
    """A line of a journal, as the program writes it behind a head; without one: the head."""
    line = json.dumps(row, separators=(",", ":"))[:-1]
    check = zlib.crc32(line.encode(), int(head[-10:-2], 16) if head else 0)
    return f'{line},"check":"{check:08x}"}}'


def write_histories(folder: Path, design: Design, cases: list[int], shard: int, of: int) -> None:
    """Write histories of a shard: normal_force (case, time, mesh) = 100 case + 10 time + mesh."""
    with h5py.File(folder / f"shard-{shard}-of-{of}.h5", "w") as file:
        scales = {"case": np.array(cases), "time": np.arange(4.0), "mesh": np.array([0, 1])}
        for name, values in scales.items():
            file.create_dataset(name, data=values).make_scale(name)
        file["time"].attrs["units"] = "s"
        values = (
            100.0 * scales["case"][:, None, None]
            + 10.0 * scales["time"][None, :, None]
            + scales["mesh"][None, None, :]
        )
        force = file.create_dataset("normal_force", data=values.astype("f4"))
        force.attrs["units"] = "N"
        for axis, name in enumerate(scales):
            force.dims[axis].attach_scale(file[name])
