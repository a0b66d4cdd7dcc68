"""The commands whose calls fail one by one."""

from __future__ import annotations

import io
import subprocess
import sys
from collections.abc import Callable, Mapping
from functools import lru_cache, partial
from pathlib import Path

import h5py
import numpy as np

from designs import paper_case, read_journal, write_design
from io_faults.trial import BAD_INPUT, Command
from io_faults.warm import START

CASE, DESIGN, JOURNAL, STACK = "case.yaml", "design.h5", "shard-1-of-1.jsonl", "shard-1-of-1.h5"
TORQUE = "wheels.pinion.loads.0.value"
TIMINGS_COLLECTED = ("cpu_time", "recorded_at")
N_CASES = 6
WHEEL = "{hub_diameter: 0.026, order: 5}"  # whose teeth bend: cheap elements
# Of Python: what it asks the system for beside files is not the program's business.
FILES = ("write", "fsync", "rename", "open", "close", "truncate", "read", "link", "lock")
SWEEPS, POST = (sys.executable, START, "sweep"), (sys.executable, START, "post")
# A run that has made no checkpoint begins anew.
_GO_ON = 'test -e h.h5.parts/checkpoint.h5 && set -- "$@" --continue; exec "$0" "$@"'
SWEEP = f"""\
format: 1
title: a sweep
case: {CASE}
method: list
histories: {{variables: [normal_force]}}
parameters:
- {{path: {TORQUE}, name: torque, units: N m, values: [-1, -2, -3, -4]}}
"""


# ---- what counts of a file -----------------------------------------------------------------------


def _of_hdf5(path: Path) -> object:
    """All attributes and values of a file, as they are read; most are those of another trial."""
    return _of_bytes(path.read_bytes())


@lru_cache(maxsize=100)
def _of_bytes(content: bytes) -> object:
    found: dict[str, object] = {}

    def look(name: str, thing: h5py.Group | h5py.Dataset) -> None:
        for key, value in thing.attrs.items():
            found[f"{name}@{key}"] = repr(value)
        if isinstance(thing, h5py.Dataset) and name not in TIMINGS_COLLECTED:
            if thing.is_virtual:  # where its values are
                found[name] = [
                    (one.file_name, one.dset_name, one.vspace.get_select_bounds())
                    for one in thing.virtual_sources()
                ]
                return
            value = thing[()]
            found[name] = repr(value) if thing.dtype == object else np.asarray(value).tobytes()

    with h5py.File(io.BytesIO(content)) as file:
        look("", file)
        file.visititems(look)
    return found


def _files(folder: Path, names: Mapping[str, Callable[[Path], object]]) -> dict[str, object]:
    """Those of the files that are there."""
    return {name: read(folder / name) for name, read in names.items() if (folder / name).exists()}


def _rows(folder: Path) -> dict[object, object]:
    """Rows of the journal by their cases, timings and all."""
    path = folder / "r" / JOURNAL
    if not path.exists() or path.stat().st_size == 0:
        return {}
    return {row["case"]: row for row in read_journal(path).rows}


# ---- the commands --------------------------------------------------------------------------------


def _write_case(folder: Path, duration: float = 0.002, example: str = "paper.yaml") -> None:
    (folder / CASE).write_text(paper_case(duration, example))


def _with_old(folder: Path, program: Path, *words: str, example: str = "paper.yaml") -> None:
    """A case, and what an earlier command has made of another one."""
    _write_case(folder, 0.004, example)
    subprocess.run([program, *words, "-q"], cwd=folder, check=True, stdout=subprocess.DEVNULL)
    _write_case(folder, example=example)


def _write_batch(folder: Path, program: Path, recorded: bool) -> None:
    """A design with histories; `recorded`: after a run that was killed in the midst of a row."""
    torques = {TORQUE: list(-np.linspace(1.0, 3.0, N_CASES))}
    write_design(folder / DESIGN, torques, paper_case(0.005), histories="normal_force")
    if recorded:
        subprocess.run([program, "batch", DESIGN, "-o", "r", "-q"], cwd=folder, check=True)
        journal = folder / "r" / JOURNAL
        lines = journal.read_bytes().splitlines(keepends=True)
        journal.write_bytes(b"".join(lines[:3]) + lines[3][:40])


def _write_wheels(folder: Path) -> None:
    """A design of wheels whose teeth bend."""
    columns = {
        "wheels.pinion.compliance": [WHEEL] * 2,
        "wheels.pinion.loads.0.value": [-40.0, -50.0],
    }
    write_design(folder / DESIGN, columns, paper_case(0.001, "spur-pair.yaml"))


def _write_responses(folder: Path) -> None:
    """A design whose cases are responses."""
    write_design(
        folder / DESIGN,
        {"meshes.0.damping.value": [0.07, 0.1]},
        paper_case(0.001, "spur-pair.yaml"),
        respond_over=f"{TORQUE}=-40:-50:2",
        respond_direction="up",
    )


def _write_sweep(folder: Path, is_run: bool) -> None:
    """A plan, and what came of it."""
    _write_case(folder)
    (folder / "sweep.yaml").write_text(SWEEP)
    if is_run:
        for words in (
            ["plan", "sweep.yaml", "-o", DESIGN],
            ["run", DESIGN, "-o", "r", "--jobs", "1"],
        ):
            subprocess.run([*SWEEPS, *words], cwd=folder, check=True, capture_output=True)


def _batch_contents(folder: Path) -> dict[str, object]:
    """What a batch has made so far: its rows, each with its history; a row may not be there."""
    journal, stack = folder / "r" / JOURNAL, folder / "r" / STACK
    found: dict[str, object] = _files(folder, {"r/design.txt": Path.read_bytes})
    for pattern in ("compliance-*.h5", "responses/case-*.h5"):
        found |= {f"r/{path.name}": _of_hdf5(path) for path in folder.glob(f"r/{pattern}")}
    if journal.exists() and journal.read_bytes().count(b"\n") > 0:
        read = read_journal(journal)
        assert len(read.cases) == len(read.rows), "a case is there twice"
        found |= {"head": read.head} | {f"row {case}": row for case, row in read.results.items()}
        if read.cases and "spur" not in (folder / DESIGN).read_text("latin-1"):
            found |= {f"history {case}": _history(stack, case) for case in read.cases}
    return found


def _history(stack: Path, case: int) -> bytes:
    with h5py.File(stack) as file:
        return bytes(np.asarray(file["normal_force"][case]).tobytes())


def commands(program: Path) -> dict[str, Command]:
    """All of them by their names."""
    batch = [program, "batch", DESIGN, "-o", "r", "-q"]
    run_checkpoints = [program, "run", CASE, "-o", "h.h5", "-q", "--checkpoint-at", "5e-4,1e-3"]
    static = ["static", CASE, "-o", "s.h5", "--points", "21", "--torque"]
    found = [
        Command(
            "run",
            lambda folder: _with_old(folder, program, "run", CASE, "-o", "h.h5"),
            [program, "run", CASE, "-o", "h.h5", "-q"],
            partial(_files, names={"h.h5": _of_hdf5}),
        ),
        Command(
            "run-outputs",
            _write_case,
            [program, "run", CASE, "-o", "h.h5", "-q", "--outputs", "angle,normal_force"],
            partial(_files, names={"h.h5": _of_hdf5}),
        ),
        Command(
            "run-checkpoints",
            _write_case,
            run_checkpoints,
            partial(_files, names={"h.h5": _of_hdf5}),
            again=["/bin/sh", "-c", _GO_ON, *run_checkpoints],
        ),
        Command(
            "static",
            lambda folder: _with_old(folder, program, *static, "1:9:3", example="spur-pair.yaml"),
            [program, *static, "1:5:3", "-q"],
            partial(_files, names={"s.h5": _of_hdf5}),
        ),
        Command(
            "respond",
            lambda folder: _write_case(folder, example="spur-pair.yaml"),
            [program, "respond", CASE, "--over", f"{TORQUE}=-40:-50:2", "-o", "r.h5", "-q"],
            partial(_files, names={"r.h5": _of_hdf5}),
        ),
        Command(
            "respond-orbits",
            lambda folder: _write_case(folder, example="spur-pair.yaml"),
            [
                *(program, "respond", CASE, "--over", f"{TORQUE}=-40:-41:2", "-o", "r.h5", "-q"),
                *("--method", "orbits"),
            ],
            partial(_files, names={"r.h5": _of_hdf5}),
        ),
        Command(
            "fmu",
            _write_case,
            [program, "fmu", CASE, "-o", "g.fmu", "-q", "--set", "meshes.0.tracking=closed_form"],
            partial(_files, names={"g.fmu": Path.read_bytes}),
        ),
        Command(
            "show",
            _write_case,
            [program, "show", CASE],
            partial(_files, names={"shown": Path.read_bytes}),
            prints="shown",
        ),
        Command(
            "batch",
            lambda folder: _write_batch(folder, program, recorded=False),
            [*batch, "--jobs", "2"],
            _batch_contents,
            again=[*batch, "--resume"],
            recorded=_rows,
        ),
        Command(
            "resume",
            lambda folder: _write_batch(folder, program, recorded=True),
            [*batch, "--jobs", "2", "--resume"],
            _batch_contents,
            again=[*batch, "--resume"],
            recorded=_rows,
        ),
        Command(
            "batch-wheels",
            _write_wheels,
            batch,
            _batch_contents,
            again=[*batch, "--resume"],
            recorded=_rows,
        ),
        Command(
            "batch-responses",
            _write_responses,
            batch,
            _batch_contents,
            again=[*batch, "--resume"],
            recorded=_rows,
        ),
        Command(
            "records",
            lambda folder: _write_batch(folder, program, recorded=True),
            [program, "records", "r"],
            partial(_files, names={"records": Path.read_bytes}),
            recorded=_rows,
            prints="records",
            promised={"open": {BAD_INPUT}},
        ),
        Command(
            "plan",
            lambda folder: _write_sweep(folder, is_run=False),
            [*SWEEPS, "plan", "sweep.yaml", "-o", DESIGN],
            partial(_files, names={DESIGN: _of_hdf5}),
            kinds=FILES,
        ),
        Command(
            "collect",
            lambda folder: _write_sweep(folder, is_run=True),
            [*SWEEPS, "collect", "r", "-o", "all.h5", "--copy-histories"],
            partial(_files, names={"all.h5": _of_hdf5}),
            recorded=_rows,
            kinds=FILES,
        ),
        Command(
            "collect-refers",
            lambda folder: _write_sweep(folder, is_run=True),
            [*SWEEPS, "collect", "r", "-o", "all.h5"],
            partial(_files, names={"all.h5": _of_hdf5}),
            recorded=_rows,
            kinds=FILES,
        ),
        Command(
            "plot",
            lambda folder: _with_old(folder, program, "run", CASE, "-o", "h.h5"),
            [*POST, "plot", "h.h5", "--quantity", "normal_force"],
            partial(_files, names={"h-normal_force.png": Path.read_bytes}),
            kinds=FILES,
        ),
        Command(
            "report",
            lambda folder: _with_old(folder, program, "run", CASE, "-o", "h.h5"),
            [*POST, "report", "h.h5", "-o", "h.html"],
            partial(_files, names={"h.html": Path.read_bytes}),
            kinds=FILES,
        ),
    ]
    return {command.name: command for command in found}
