#!/usr/bin/env python3
"""Modules of the code and their dependencies, read from the lines that name another file.

usage: tools/modules.py [--write]

Without an argument: one line for every dependency that docs/modules.toml does not allow and for
every cycle of files inside a module, and exit code 1 if there is any. With --write: generate the
diagrams and tables of docs/reference/architecture.md.

In C, X.h and X.c are one file: an include from either is a dependency of the pair. In Python,
imports under `if TYPE_CHECKING:` do not count for cycles, since they are not executed.
"""

from __future__ import annotations

import ast
import re
import sys
import tomllib
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property
from graphlib import CycleError, TopologicalSorter
from itertools import pairwise
from pathlib import Path

MODULES = "modules"
VARIABLES = "variables"


@dataclass(frozen=True)
class Tree:
    """One source tree: its table and its location."""

    root: Path
    name: str
    title: str
    language: str
    layers: list[list[str]]
    modules: dict[str, str]
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

    def module(self, file: Path) -> str | None:
        """Module of a file: its folder, or the stem of a file at the top of the tree."""
        name = file.parts[0] if len(file.parts) > 1 else file.stem
        return name if name in self.modules else None

    def layer(self, module: str) -> int:
        """Layer index of a module, lowest first."""
        return next(i for i, modules in enumerate(self.layers) if module in modules)

    def allows(self, start: str, end: str) -> bool:
        """Whether a module may depend on another."""
        return start == end or self.layer(end) < self.layer(start)


@dataclass(frozen=True)
class Arrow:
    """One dependency: a line of a file that names another file, or a name from outside the tree."""

    file: Path
    line: int
    target: str
    module: str | None
    target_file: Path | None  # in the same tree
    is_executed: bool  # not under `if TYPE_CHECKING:`


def page_file(root: Path, name: str) -> Path:
    """Path of a page or table by its name, in any folder below docs."""
    return next((root / "docs").rglob(name))


def trees(root: Path) -> list[Tree]:
    """Read all trees from the table of a checkout."""
    table = tomllib.loads(page_file(root, "modules.toml").read_text())
    return [
        Tree(
            root,
            name,
            entry["title"],
            entry["language"],
            entry["layers"],
            entry["modules"],
            entry.get("outside", {}),
        )
        for name, entry in table.items()
    ]


Found = tuple[int, str, Path | None, bool]  # line, name, file in the tree, is_executed


def _fortran(tree: Tree, file: Path, text: str) -> Iterator[Found]:
    for match in re.finditer(
        r'^ *(?:use +evl_(\w+)|submodule *\( *evl_(\w+)|include "([^"]+)")', text, re.MULTILINE
    ):
        line = text.count("\n", 0, match.start()) + 1
        module = match.group(1) or match.group(2)
        if module:
            yield line, f"evl_{module}", tree.named.get(f"{module}.f90"), True
        else:
            yield line, match.group(3), Path(match.group(3)), True


def _c(tree: Tree, file: Path, text: str) -> Iterator[Found]:
    for match in re.finditer(r'^ *# *include *[<"]([^>"]+)[>"]', text, re.MULTILINE):
        line, name = text.count("\n", 0, match.start()) + 1, match.group(1)
        inside = [
            path for path in (file.parent / name, Path(name)) if (tree.folder / path).is_file()
        ]
        yield line, name, inside[0] if inside else None, True


def _python(tree: Tree, file: Path, text: str) -> Iterator[Found]:
    package = tree.folder.name
    code = ast.parse(text)
    unexecuted = {
        node
        for block in ast.walk(code)
        if isinstance(block, ast.If) and ast.unparse(block.test).endswith("TYPE_CHECKING")
        for statement in block.body
        for node in ast.walk(statement)
    }
    for node in ast.walk(code):
        if isinstance(node, ast.ImportFrom):
            base = [package, *file.parts[:-1]]
            above = base[: len(base) - node.level + 1] if node.level else []
            source = ".".join([*above, *filter(None, [node.module])])
            names = [f"{source}.{alias.name}" for alias in node.names]
        elif isinstance(node, ast.Import):
            names = [alias.name for alias in node.names]
        else:
            continue
        for name in names:
            if name.split(".")[0] == package:
                yield node.lineno, name, _python_file(tree, name), node not in unexecuted


def _python_file(tree: Tree, name: str) -> Path:
    """File of a dotted name: that of a module, or of the module or package that contains it."""
    parts = name.split(".")[1:]
    for path in (Path(*parts), Path(*parts[:-1])):
        for file in (path.parent / f"{path.name}.py", path / "__init__.py"):
            if (tree.folder / file).is_file():
                return file
    return Path(*parts)


READERS = {"Fortran": _fortran, "C": _c, "Python": _python}


def arrows(tree: Tree) -> Iterator[Arrow]:
    """Iterate over the dependencies of a tree."""
    for file in tree.files():
        text = (tree.folder / file).read_text()
        for line, name, target, is_executed in READERS[tree.language](tree, file, text):
            module = tree.module(target) if target else None
            yield Arrow(file, line, name, module, target, is_executed)


def cycles(tree: Tree, known: list[Arrow]) -> list[str]:
    """List the cycles of files inside modules, one line each."""
    pair = tree.language == "C"  # a header and its source are one file
    lines: dict[tuple[Path, Path], str] = {}
    for arrow in known:
        if arrow.target_file is None or not arrow.is_executed:
            continue
        ends = [file.with_suffix("") if pair else file for file in (arrow.file, arrow.target_file)]
        if ends[0] != ends[1] and arrow.module == tree.module(arrow.file):
            lines.setdefault((ends[0], ends[1]), f"{tree.name}/{arrow.file}:{arrow.line}")
    found: list[str] = []
    while True:
        graph: dict[Path, list[Path]] = {}
        for start, end in lines:
            graph.setdefault(end, []).append(start)
        try:
            TopologicalSorter(graph).prepare()
        except CycleError as error:
            cycle = error.args[1]
        else:
            return found
        steps = list(pairwise(cycle))
        first = min(range(len(steps)), key=lambda i: steps[i])
        steps = steps[first:] + steps[:first]
        locations = [lines[step] for step in steps]
        found.append(
            f"{locations[0]}: cycle of files: {' -> '.join([*locations, locations[0]])}; "
            "move what they share into a lower file, or merge them"
        )
        del lines[steps[-1]]


def faults(root: Path) -> list[str]:
    """List the violations of the table, one line each."""
    found = []
    for tree in trees(root):
        listed = [module for modules in tree.layers for module in modules]
        if sorted(listed) != sorted(tree.modules):
            found.append(f"docs/modules.toml: the layers of {tree.name} are not its modules")
        top = {"__init__.py", "py.typed"}
        for file in tree.files():
            if tree.module(file) is None and file.name not in top:
                found.append(f"{tree.name}/{file}: belongs to no module")
        known = list(arrows(tree))
        for arrow in known:
            start = tree.module(arrow.file)
            location = f"{tree.name}/{arrow.file}:{arrow.line}: {arrow.target}"
            if start is None:
                continue
            if arrow.module is not None and not tree.allows(start, arrow.module):
                found.append(f"{location}: {start} may not depend on {arrow.module}")
            for beginning, allowed in tree.outside.items():
                if (
                    arrow.module is None
                    and arrow.target.startswith(beginning)
                    and start not in allowed
                ):
                    found.append(f"{location}: only {', '.join(allowed)} may depend on {beginning}")
        found += cycles(tree, known)
    return list(dict.fromkeys(found))


def drawing(tree: Tree) -> str:
    """Draw a tree as a diagram and a list; an arrow is a dependency of a module on another."""
    known = {
        (tree.module(arrow.file), arrow.module)
        for arrow in arrows(tree)
        if arrow.module is not None and tree.module(arrow.file) not in {None, arrow.module}
    }
    lines = [f"## {tree.title} (`{tree.name}/`)", "", "```mermaid", "flowchart BT"]
    for i, modules in enumerate(tree.layers):
        lines.append(f'  subgraph layer{i}[" "]')
        lines.append("    direction LR")
        lines += [f"    {module}" for module in modules]
        lines.append("  end")
    # Omit arrows that are implied by a path of two others.
    for start, end in sorted(known, key=lambda pair: (tree.layer(pair[0]), pair)):
        between = {b for a, b in known if a == start and b != end}
        if not any((middle, end) in known for middle in between):
            lines.append(f"  {start} --> {end}")
    lines += ["```", ""]
    lines += [f"- **{module}**: {says}." for module, says in tree.modules.items()]
    return "\n".join(lines) + "\n"


def variables(root: Path) -> str:
    """Tabulate the variables of a history that each file of the kernel provides."""
    text = page_file(root, "result_format.md").read_text()
    names = {
        name
        for row in re.findall(
            r"^\|((?: *`\w+`,?)+) *\| [^|]*(?:wheel|mesh|shaft|time)\b", text, re.MULTILINE
        )
        for name in re.findall(r"`(\w+)`", row)
    }
    files: dict[str, list[str]] = {}
    for file in sorted((root / "src" / "analysis").glob("*.f90")):
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
    begin, end = f"<!-- {what}: made by tools/modules.py -->", f"<!-- end of {what} -->"
    before, rest = text.split(begin, 1)
    _, after = rest.split(end, 1)
    return f"{before}{begin}\n\n{body}\n{end}{after}"


def page(text: str, root: Path) -> str:
    """Return the page with its generated parts updated."""
    text = _between(text, MODULES, "\n".join(drawing(tree) for tree in trees(root)))
    return _between(text, VARIABLES, variables(root))


def main(arguments: list[str]) -> int:
    """Check the dependencies, or update the page."""
    root = Path(__file__).parents[1]
    if arguments == ["--write"]:
        file = page_file(root, "architecture.md")
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
