"""The list of mutants: the change of each, and the tests to run first."""

from __future__ import annotations

import hashlib
import tomllib
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
LIST = ROOT / "tools" / "mutants"


class ListError(Exception):
    """An error of the list, in one line."""


@dataclass(frozen=True)
class Mutant:
    """One change of one file."""

    path: str
    find: str
    put: str
    tests: tuple[str, ...]
    note: str = ""
    equivalent: str = ""

    @property
    def key(self) -> str:
        """Its name in the records: a hash of the change, independent of the line number."""
        text = "\0".join((self.path, self.find, self.put))
        return hashlib.sha256(text.encode()).hexdigest()[:10]

    @property
    def module(self) -> str:
        """Tree and module of the file: `src/laws`."""
        folders = [part for part in self.path.split("/")[:-1] if part != "evolvent"]
        return "/".join(folders[:2])

    def __str__(self) -> str:
        """One line that describes the change."""
        before, after = (" ".join(text.split()) for text in (self.find, self.put))
        note = f"  ({self.note})" if self.note else ""
        return f"{self.path}: {before} -> {after or 'nothing'}{note}"

    def applied(self, text: str) -> str:
        """Return the text of the file with the change."""
        count = text.count(self.find)
        if count != 1:
            raise ListError(f"stale: found {count} times instead of once: {self}")
        return text.replace(self.find, self.put)


def _entries(file: Path) -> Iterator[Mutant]:
    try:
        blocks = tomllib.loads(file.read_text())
    except tomllib.TOMLDecodeError as error:
        raise ListError(f"{file.name}: {error}") from error
    for block in blocks.pop("file", []):
        where = f"{file.name}: {block.get('path', 'a block without path')}"
        if unknown := block.keys() - {"path", "tests", "mutants"}:
            raise ListError(f"{where}: unknown key {sorted(unknown)[0]}")
        for row in block["mutants"]:
            if unknown := row.keys() - {"find", "put", "tests", "note", "equivalent"}:
                raise ListError(f"{where}: unknown key {sorted(unknown)[0]}")
            tests = tuple(row.pop("tests", block.get("tests", [])))
            mutant = Mutant(block["path"], tests=tests, **row)
            if not tests and not mutant.equivalent:
                raise ListError(f"no tests are named: {mutant}")
            if mutant.find == mutant.put:
                raise ListError(f"nothing is changed: {mutant}")
            yield mutant
    if blocks:
        raise ListError(f"{file.name}: unknown key {sorted(blocks)[0]}")


def read_list(folder: Path = LIST) -> list[Mutant]:
    """Read all mutants, grouped by file, so that builds are incremental.

    Raises
    ------
    ListError
        For an invalid row, and for two rows with the same change.
    """
    mutants = [mutant for file in sorted(folder.glob("*.toml")) for mutant in _entries(file)]
    seen: dict[str, Mutant] = {}
    for mutant in mutants:
        if mutant.key in seen:
            raise ListError(f"twice in the list: {mutant}")
        seen[mutant.key] = mutant
    return sorted(mutants, key=lambda mutant: mutant.path)


def stale(mutants: list[Mutant], root: Path = ROOT) -> list[str]:
    """List rows that do not fit the tree: text not found exactly once, test file missing."""
    complaints = []
    for mutant in mutants:
        file = root / mutant.path
        try:
            mutant.applied(file.read_text())
        except (OSError, ListError) as error:
            complaints.append(str(error))
        for test in mutant.tests:
            if not (root / test.split("::")[0]).is_file():
                complaints.append(f"no such test: {test}: {mutant}")
    return complaints
