#!/usr/bin/env python3
"""Modules of the code and their dependencies, read from the lines that name another file.

usage: tools/rooms.py [--write]

Without an argument: one line for every dependency that docs/rooms.toml does not allow, and exit
code 1 if there is any. With --write: generate the diagrams and tables of
docs/reference/architecture.md.
"""

from __future__ import annotations

import re
import sys
import tomllib
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

ROOMS = "rooms"
VARIABLES = "variables"


@dataclass(frozen=True)
class Tree:
    """One source tree: its table and its location."""

    root: Path
    name: str
    title: str
    language: str
    floors: list[list[str]]
    rooms: dict[str, str]
    outside: dict[str, list[str]]

    @property
    def folder(self) -> Path:
        """Folder of its files."""
        return self.root / self.name

    @cached_property
    def named(self) -> dict[str, Path]:
        """Paths of its files by file name."""
        return {file.name: file for file in self.files()}

    def files(self) -> list[Path]:
        """List the files of the language, relative to the tree."""
        endings = {"Fortran": ("f90", "inc"), "C": ("c", "h"), "Python": ("py",)}[self.language]
        found = (path for ending in endings for path in self.folder.rglob(f"*.{ending}"))
        return sorted(path.relative_to(self.folder) for path in found)

    def room(self, file: Path) -> str | None:
        """Module of a file: its folder, or the stem of a file at the top of the tree."""
        name = file.parts[0] if len(file.parts) > 1 else file.stem
        return name if name in self.rooms else None

    def floor(self, room: str) -> int:
        """Layer index of a module, lowest first."""
        return next(i for i, rooms in enumerate(self.floors) if room in rooms)

    def allows(self, start: str, end: str) -> bool:
        """Whether a module may depend on another."""
        return start == end or self.floor(end) < self.floor(start)


@dataclass(frozen=True)
class Arrow:
    """One dependency: a line of a file that names another file, or a name from outside the tree."""

    file: Path
    line: int
    target: str
    room: str | None


def trees(root: Path) -> list[Tree]:
    """Read all trees from the table of a checkout."""
    table = tomllib.loads((root / "docs" / "rooms.toml").read_text())
    return [
        Tree(
            root,
            name,
            entry["title"],
            entry["language"],
            entry["floors"],
            entry["rooms"],
            entry.get("outside", {}),
        )
        for name, entry in table.items()
    ]


def _fortran(tree: Tree, file: Path, text: str) -> Iterator[tuple[int, str, Path | None]]:
    for match in re.finditer(
        r'^ *(?:use +evl_(\w+)|submodule *\( *evl_(\w+)|include "([^"]+)")', text, re.MULTILINE
    ):
        line = text.count("\n", 0, match.start()) + 1
        module = match.group(1) or match.group(2)
        if module:
            yield line, f"evl_{module}", tree.named.get(f"{module}.f90")
        else:
            yield line, match.group(3), Path(match.group(3))


def _c(tree: Tree, file: Path, text: str) -> Iterator[tuple[int, str, Path | None]]:
    for match in re.finditer(r'^ *# *include *[<"]([^>"]+)[>"]', text, re.MULTILINE):
        line, name = text.count("\n", 0, match.start()) + 1, match.group(1)
        inside = [
            path for path in (file.parent / name, Path(name)) if (tree.folder / path).is_file()
        ]
        yield line, name, inside[0] if inside else None


def _python(tree: Tree, file: Path, text: str) -> Iterator[tuple[int, str, Path | None]]:
    package = tree.folder.name
    for match in re.finditer(
        rf"^ *(?:from +((?:{package}|\.)[\w.]*) +import +(?:\(([^)]*)\)|(.*))"
        rf"|import +({package}[\w.]*))",
        text,
        re.MULTILINE,
    ):
        line = text.count("\n", 0, match.start()) + 1
        source, several, one, plain = match.groups()
        dotted = plain or source
        if dotted.startswith("."):
            level = len(dotted) - len(dotted.lstrip("."))
            base = [package, *file.parts[:-1]]
            dotted = ".".join([*base[: len(base) - level + 1], *filter(None, [dotted.lstrip(".")])])
        parts = dotted.split(".")[1:]
        names = [name.split(" as ")[0].strip() for name in (several or one or "").split(",")]
        if not parts:  # names of the package itself: each is a module or a name of its __init__
            for name in names:
                yield line, f"{dotted}.{name}", Path(name, "__init__.py")
        else:
            yield line, dotted, Path(*parts, "__init__.py")


READERS = {"Fortran": _fortran, "C": _c, "Python": _python}


def arrows(tree: Tree) -> Iterator[Arrow]:
    """Iterate over the dependencies of a tree."""
    for file in tree.files():
        text = (tree.folder / file).read_text()
        for line, name, target in READERS[tree.language](tree, file, text):
            yield Arrow(file, line, name, tree.room(target) if target else None)


def faults(root: Path) -> list[str]:
    """List the violations of the table, one line each."""
    found = []
    for tree in trees(root):
        listed = [room for rooms in tree.floors for room in rooms]
        if sorted(listed) != sorted(tree.rooms):
            found.append(f"docs/rooms.toml: the floors of {tree.name} are not its rooms")
        top = {"__init__.py", "py.typed"}
        for file in tree.files():
            if tree.room(file) is None and file.name not in top:
                found.append(f"{tree.name}/{file}: stands in no room")
        for arrow in arrows(tree):
            start = tree.room(arrow.file)
            place = f"{tree.name}/{arrow.file}:{arrow.line}: {arrow.target}"
            if start is None:
                continue
            if arrow.room is not None and not tree.allows(start, arrow.room):
                found.append(f"{place}: {start} may not know {arrow.room}")
            for beginning, allowed in tree.outside.items():
                if (
                    arrow.room is None
                    and arrow.target.startswith(beginning)
                    and start not in allowed
                ):
                    found.append(f"{place}: only {', '.join(allowed)} may know {beginning}")
    return found


def drawing(tree: Tree) -> str:
    """Draw a tree as a diagram and a list; an arrow is a dependency of a module on another."""
    known = {
        (tree.room(arrow.file), arrow.room)
        for arrow in arrows(tree)
        if arrow.room is not None and tree.room(arrow.file) not in {None, arrow.room}
    }
    lines = [f"## {tree.title} (`{tree.name}/`)", "", "```mermaid", "flowchart BT"]
    for i, rooms in enumerate(tree.floors):
        lines.append(f'  subgraph floor{i}[" "]')
        lines.append("    direction LR")
        lines += [f"    {room}" for room in rooms]
        lines.append("  end")
    # Omit arrows that are implied by a path of two others.
    for start, end in sorted(known, key=lambda pair: (tree.floor(pair[0]), pair)):
        between = {b for a, b in known if a == start and b != end}
        if not any((middle, end) in known for middle in between):
            lines.append(f"  {start} --> {end}")
    lines += ["```", ""]
    lines += [f"- **{room}**: {says}." for room, says in tree.rooms.items()]
    return "\n".join(lines) + "\n"


def variables(root: Path) -> str:
    """Tabulate the variables of a history that each file of the kernel provides."""
    text = (root / "docs" / "reference" / "result_format.md").read_text()
    names = {
        name
        for row in re.findall(
            r"^\|((?: *`\w+`,?)+) *\| [^|]*(?:wheel|mesh|shaft|time)\b", text, re.MULTILINE
        )
        for name in re.findall(r"`(\w+)`", row)
    }
    files: dict[str, list[str]] = {}
    for file in sorted((root / "src" / "answers").glob("*.f90")):
        if file.stem == "static_outputs":  # of another analysis, with its own names
            continue
        row = r'^ +call add_(?:output|components)\(registry, "(\w+)"'
        added = set(re.findall(row, file.read_text(), re.MULTILINE))
        for name in sorted(names & added):
            files.setdefault(file.relative_to(root / "src").as_posix(), []).append(name)
    lines = ["| file (`src/`) | variables |", "|---|---|"]
    lines += [
        f"| `{file}` | {', '.join(f'`{name}`' for name in added)} |"
        for file, added in files.items()
    ]
    return "\n".join(lines) + "\n"


def _between(text: str, what: str, body: str) -> str:
    begin, end = f"<!-- {what}: made by tools/rooms.py -->", f"<!-- end of {what} -->"
    before, rest = text.split(begin, 1)
    _, after = rest.split(end, 1)
    return f"{before}{begin}\n\n{body}\n{end}{after}"


def page(text: str, root: Path) -> str:
    """Return the page with its generated parts updated."""
    text = _between(text, ROOMS, "\n".join(drawing(tree) for tree in trees(root)))
    return _between(text, VARIABLES, variables(root))


def main(arguments: list[str]) -> int:
    """Check the dependencies, or update the page."""
    root = Path(__file__).parents[1]
    if arguments == ["--write"]:
        file = root / "docs" / "reference" / "architecture.md"
        file.write_text(page(file.read_text(), root))
        return 0
    if arguments:
        print(__doc__)
        return 0 if arguments == ["--help"] else 2
    found = faults(root)
    print(*found, sep="\n", end="\n" if found else "")
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
