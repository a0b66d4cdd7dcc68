"""Results so far: a line for each mutant, so that a stopped run can be resumed."""

from __future__ import annotations

import json
from collections import Counter
from dataclasses import asdict, dataclass
from pathlib import Path

from mutation.entries import Mutant

KILLED, SURVIVED, WRONG = "killed", "survived", "wrong"


@dataclass(frozen=True)
class Record:
    """The verdict on one mutant."""

    key: str
    verdict: str
    by: str  # the detecting test, or the error
    how: str  # empty if it simply failed
    seconds: float
    left_behind: int = 0


def read_records(file: Path) -> dict[str, Record]:
    """Read the last verdict on every mutant; a truncated line is ignored."""
    records = {}
    for line in file.read_text().splitlines() if file.is_file() else []:
        try:
            record = Record(**json.loads(line))
        except (ValueError, TypeError):
            continue
        records[record.key] = record
    return records


def append_record(file: Path, record: Record) -> None:
    """Append one line, completely or not at all."""
    with file.open("a") as out:
        out.write(json.dumps(asdict(record)) + "\n")


def summary(mutants: list[Mutant], records: dict[str, Record]) -> str:
    """Summarise run and killed mutants of each module, survivors and wrong rows."""
    modules: dict[str, Counter[str]] = {}
    for mutant in mutants:
        count = modules.setdefault(mutant.module, Counter())
        count["listed"] += 1
        if mutant.equivalent:
            count["equivalent"] += 1
        elif mutant.key in records:
            count[records[mutant.key].verdict] += 1
    total = sum(modules.values(), Counter())
    columns = ("listed", "equivalent", KILLED, SURVIVED, WRONG)
    lines = [f"{'':<24}" + "".join(f"{column:>12}" for column in columns)]
    for module, count in [*sorted(modules.items()), ("all", total)]:
        lines.append(f"{module:<24}" + "".join(f"{count[column]:>12}" for column in columns))
    run = total[KILLED] + total[SURVIVED]
    share = f", {100 * total[KILLED] / run:.1f} %" if run else ""
    lines.append(f"{run} run, {total[KILLED]} killed{share}")
    for mutant in mutants:
        record = records.get(mutant.key)
        if mutant.equivalent:
            lines.append(f"equivalent  {mutant}: {mutant.equivalent}")
        elif record and record.verdict in (SURVIVED, WRONG):
            lines.append(f"{record.verdict:<12}{mutant}{f': {record.by}' if record.by else ''}")
    return "\n".join(lines)
