"""Bit flips, truncated files, zeroed blocks: rejected with the file name, or read correctly.

Each seed is some damages of one kind of file; docs/reports/random_sets.md gives the results.
"""

from __future__ import annotations

import json
import random
import subprocess
from collections import Counter
from collections.abc import Callable
from pathlib import Path
from typing import Any

import h5py
import numpy as np
import pytest

from designs import paper_case, read_folder, write_design
from evolvent.errors import HistoryError, SweepError
from evolvent.history import open_recording
from evolvent.history.files import verify_checksum
from evolvent.sweep.collect import collect, open_summary
from evolvent.sweep.design import Design, read_design
from system.random_sets import seeds

EACH = 25  # damages of a seed
BLOCK = 512  # bytes of a zeroed block, as lost by a disk
CHECKSUM_LENGTH = 64
Outcomes = Counter[str]
Evolvent = Callable[..., subprocess.CompletedProcess[str]]
TORQUE = "wheels.pinion.loads.0.value"


def damaged(content: bytes, chance: random.Random) -> tuple[bytes, range]:
    """Damage a file, and return the changed bytes."""
    kind = chance.choice(["flip", "flip", "flip", "cut", "zeros"])
    offset = chance.randrange(len(content))
    if kind == "cut":
        return content[:offset], range(offset, len(content))
    if kind == "zeros":
        begin = offset // BLOCK * BLOCK
        block = content[begin : begin + BLOCK]
        return (
            content[:begin] + bytes(len(block)) + content[begin + len(block) :],
            range(begin, begin + len(block)),
        )
    flipped = bytearray(content)
    flipped[offset] ^= 1 << chance.randrange(8)
    return bytes(flipped), range(offset, offset + 1)


def assert_refused(done: subprocess.CompletedProcess[str], name: str) -> None:
    """One line with the name of the file, and the exit code of an invalid case."""
    assert done.returncode == 3, done
    assert name in done.stderr.splitlines()[-1], done
    assert all(line.startswith(("evolvent: ", name)) or name in line
               for line in done.stderr.splitlines()), done  # fmt: skip


def same(one: Design, other: Design) -> bool:
    """Whether two designs agree in all their data."""
    return one.hash == other.hash and all(
        a.name == b.name and a.units == b.units and np.array_equal(a.values, b.values)
        for a, b in zip(one.parameters, other.parameters, strict=True)
    )


def plans(seed: int, folder: Path, evolvent: Evolvent) -> Outcomes:
    path, found = folder / "design.h5", Counter[str]()
    laws = [f"{{law: coulomb, coefficient: {c}, regularisation_velocity: 0.001}}" for c in (0, 0.1)]
    write_design(path, {TORQUE: [-1.0, -2.0], "meshes.0.friction": laws}, plan=None)
    whole = read_design(path)
    content, chance = path.read_bytes(), random.Random(seed)
    expected = evolvent("batch", path, "--check").stdout
    assert '"checked":2,"refused":0' in expected
    for _ in range(EACH):
        path.write_bytes(damaged(content, chance)[0])
        done = evolvent("batch", path, "--check")
        if done.returncode != 0:
            assert_refused(done, "design.h5")
            with pytest.raises(SweepError):
                read_design(path)
        else:
            assert done.stdout == expected
            assert same(read_design(path), whole)
        found["refused" if done.returncode else "right"] += 1
    return found


def journals(seed: int, folder: Path, evolvent: Evolvent) -> Outcomes:
    design = write_design(folder / "design.h5", {TORQUE: [-1.0, -2.0, -3.0, -4.0]})
    assert evolvent("batch", design, "-o", "r").returncode == 0
    path, found = folder / "r/shard-1-of-1.jsonl", Counter[str]()
    content, chance = path.read_bytes(), random.Random(seed)
    rows = {row["case"]: row for row in map(json.loads, content.splitlines()[1:])}
    results = read_folder(folder / "r")
    for _ in range(EACH):
        path.write_bytes(damaged(content, chance)[0])
        reported = [json.loads(line) for line in evolvent("records", "r").stdout.splitlines()]
        for row in reported[1:]:  # the written rows count
            expected = {"journal": 0, **rows[row["case"]]}
            del expected["check"]
            assert row == expected
        done = evolvent("batch", design, "-o", "r", "--resume", "-q")
        assert done.returncode == 0, done
        mended = [json.loads(line) for line in evolvent("records", "r").stdout.splitlines()]
        assert {row["case"]: timeless(row) for row in mended[1:]} == {
            case: timeless(row) for case, row in rows.items()
        }
        found["right" if len(reported) == len(rows) + 1 else "run again"] += 1
    assert len(results) == len(rows)
    return found


def timeless(row: dict[str, Any]) -> dict[str, Any]:
    """A row without the fields that differ between runs."""
    return {k: v for k, v in row.items() if k not in ("journal", "at", "cpu_time", "check")}


def contents(file: h5py.File) -> dict[str, bytes]:
    """Bytes of all datasets."""
    found: dict[str, bytes] = {}

    def take(name: str, thing: h5py.Dataset | h5py.Group) -> None:
        if isinstance(thing, h5py.Dataset):
            values = np.asarray(thing[()])
            found[name] = (
                repr(values.tolist()).encode() if values.dtype == object else values.tobytes()
            )

    file.visititems(take)
    return found


def histories(seed: int, folder: Path, evolvent: Evolvent) -> Outcomes:
    case = Path(__file__).resolve().parents[2] / "examples" / "paper.yaml"
    short = ("--set", "simulation.duration=0.01")
    assert evolvent("run", case, *short, "-o", "h.h5", "-q").returncode == 0
    path, found = folder / "h.h5", Counter[str]()
    content, chance = path.read_bytes(), random.Random(seed)
    with h5py.File(path) as file:
        expected = contents(file)
    for _ in range(EACH):
        harmed, where = damaged(content, chance)
        path.write_bytes(harmed)
        try:
            warning = verify_checksum(path)
            if warning is None or where.start >= len(content) - CHECKSUM_LENGTH:
                with open_recording(path), h5py.File(path) as file:
                    assert contents(file) == expected
                found["right"] += 1
            else:  # truncated, or zeros at the end
                assert where.stop == len(content)
                found["warned"] += 1
        except HistoryError as error:
            found["refused" if str(error).startswith(str(path)) else "without its name"] += 1
    return found


def stacks(seed: int, folder: Path, evolvent: Evolvent) -> Outcomes:
    """Histories of a batch, as read by `evolvent-sweep collect --copy-histories` and --resume."""
    path, found = folder / "design.h5", Counter[str]()
    write_design(
        path, {TORQUE: [-1.0, -2.0, -3.0]}, paper_case(0.01), histories="normal_force angle"
    )
    assert evolvent("batch", path, "-o", "r").returncode == 0
    design, chance = read_design(path), random.Random(seed)
    stack = folder / "r/shard-1-of-1.h5"
    content = stack.read_bytes()
    collect(folder / "r", design, folder / "all.h5", copy_histories=True)
    with open_summary(folder / "all.h5") as summary:
        expected = summary.load()
    for _ in range(EACH):
        begin = chance.choice([0, values_begin(content)])
        harmed, where = damaged(content[begin:], chance)
        where = range(begin + where.start, begin + where.stop)
        stack.write_bytes(content[:begin] + harmed)
        try:
            collect(folder / "r", design, folder / "all.h5", copy_histories=True)
            with open_summary(folder / "all.h5") as summary:
                assert summary.equals(expected)
            found["right"] += 1
        except SweepError as error:
            found["refused" if str(error).startswith(str(stack)) else "without its name"] += 1
        if where.stop < len(content) - CHECKSUM_LENGTH:  # else its own checksum may be lost
            done = evolvent("batch", path, "-o", "r", "--resume", "-q")
            assert done.returncode == 0 or "checksum is wrong" in done.stderr, done
    return found


def values_begin(content: bytes) -> int:
    """Start of a stack's values, from its checksum line."""
    return int(content[-CHECKSUM_LENGTH:].split(b" of the first ")[1].split()[0])


def summaries(seed: int, folder: Path, evolvent: Evolvent) -> Outcomes:
    path, found, chance = folder / "design.h5", Counter[str](), random.Random(seed)
    write_design(path, {TORQUE: [-1.0, -2.0]}, paper_case(0.005), histories="normal_force")
    assert evolvent("batch", path, "-o", "r").returncode == 0
    summary_path = folder / "all.h5"
    collect(folder / "r", read_design(path), summary_path, copy_histories=True)
    content = summary_path.read_bytes()
    with open_summary(summary_path) as summary:
        expected = summary.load()
    for _ in range(EACH):
        harmed, where = damaged(content, chance)
        summary_path.write_bytes(harmed)
        try:
            with open_summary(summary_path) as summary:
                assert summary.equals(expected)
            assert where.stop > len(content) - CHECKSUM_LENGTH or harmed == content
            found["right"] += 1
        except SweepError as error:
            named = str(error).startswith(str(summary_path))
            found["refused" if named else "without its name"] += 1
    return found


KINDS = {
    "plan": plans,
    "journal": journals,
    "history": histories,
    "stack": stacks,
    "summary": summaries,
}


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("seed", seeds(range(2), 134))
def test_damage_is_refused_by_name_or_touches_nothing(
    evolvent: Evolvent,
    executable: Path,
    monkeypatch: pytest.MonkeyPatch,
    tmp_path: Path,
    record_property: Callable[..., None],
    seed: int,
    kind: str,
) -> None:
    monkeypatch.setenv("EVOLVENT_EXECUTABLE", str(executable))
    found = KINDS[kind](seed, tmp_path, evolvent)
    assert found["without its name"] == 0
    assert sum(found.values()) == EACH
    for outcome, count in found.items():
        record_property(f"{kind} {outcome}", count)
