"""Reference of the Fortran kernel, from the `!>` comments of its modules."""

from __future__ import annotations

import re
from dataclasses import dataclass
from pathlib import Path

from docs_site.comments import escaped, markdown

NAME = r"[a-z]\w*"
PROCEDURE = re.compile(
    rf"^ *(?P<head>(?:(?!end\b)[\w()=, ]+ )?(?:subroutine|function) +(?P<name>{NAME}) *"
    r"(?:\((?:[^()&]|&\n *)*\))?(?:[ &\n]*result *\(\w+\))?)",
    re.MULTILINE,
)
TYPE = re.compile(rf"^ *(?P<head>type(?:, *[\w()]+)* *:: *(?P<name>{NAME}))", re.MULTILINE)
ABSTRACT = re.compile(r"^ *abstract interface *\n(.*?)^ *end interface", re.MULTILINE | re.DOTALL)
GENERIC = re.compile(rf"^ *(?P<head>interface +(?P<name>{NAME}))", re.MULTILINE)


@dataclass(frozen=True)
class Public:
    """A public entity: its declaration and its comment."""

    name: str
    code: str
    doc: list[str]


@dataclass(frozen=True)
class Module:
    """A module: its name, its comment, its public entities in the order of the file."""

    name: str
    doc: list[str]
    public: list[Public]


def _above(lines: list[str], index: int) -> list[str]:
    """Lines of the `!>` comment that ends above a line."""
    first = index
    while first > 0 and re.match(r" *!>", lines[first - 1]):
        first -= 1
    return [re.sub(r"^ *!> ?", "", line).rstrip() for line in lines[first:index]]


def _statements(text: str, pattern: str) -> list[str]:
    """Lists of names after a statement, continued lines joined, comments removed."""
    joined = re.sub(r"&[^\n]*\n *&?", "", text)
    return [re.sub(r"!.*", "", line) for line in re.findall(pattern, joined, re.MULTILINE)]


def _public_names(text: str) -> set[str]:
    names = {
        name
        for listed in _statements(text, r"^ *public *:: *(.*)")
        for name in re.findall(NAME, listed)
    }
    return names | set(re.findall(rf"^[^!\n]*\bpublic\b[^!\n]*:: *({NAME})", text, re.MULTILINE))


def _constant(name: str, lines: list[str]) -> Public | None:
    """Declaration of a constant or variable, with its `!!` comment."""
    for index, line in enumerate(lines):
        declared, _, comment = line.partition("!!")
        head, separator, names = declared.partition("::")
        if separator and re.match(r" *(?:integer|real|logical|character|type\()", head):
            match = re.search(rf"(?<![\w=]){name}\b(\([^)]*\))?(?! *\()", names)
            if match and not re.match(r" *public", head):
                doc = [comment.strip()] if comment.strip() else _above(lines, index)
                return Public(name, f"{' '.join(head.split())} :: {name}{match[1] or ''}", doc)
    return None


def read(text: str) -> Module | None:
    """Read the module of a file; None for a submodule."""
    lines = text.split("\n")
    heads = [i for i, line in enumerate(lines) if re.match(rf"module +{NAME} *$", line)]
    if not heads:
        return None
    public = _public_names(text)
    found: dict[str, tuple[int, Public]] = {}
    for pattern in (GENERIC, TYPE, PROCEDURE):
        for match in pattern.finditer(text):
            index = text.count("\n", 0, match.start())
            if match["name"] in public and match["name"] not in found:
                code = " ".join(match["head"].replace("&", "").split())
                doc = _above(lines, index)
                found[match["name"]] = (index, Public(match["name"], code, doc))
    entities = [entity for _, entity in sorted(found.values(), key=lambda pair: pair[0])]
    for name in sorted(public - set(found)):
        if (constant := _constant(name, lines)) is not None:
            entities.append(constant)
    name = lines[heads[0]].split()[1]
    return Module(name, _above(lines, heads[0]), entities)


def _section(module: Module, file: Path) -> list[str]:
    lines = [f"## {module.name}", "", f"`{file}`", "", markdown(module.doc), ""]
    for entity in module.public:
        lines += [f"### {escaped(entity.name)}", "", "```fortran", entity.code, "```", ""]
        lines += [markdown(entity.doc), ""]
    return lines


def pages(root: Path) -> dict[str, str]:
    """A page for each folder of the kernel, by its path in the site."""
    made = {}
    for folder in sorted(path for path in (root / "src").iterdir() if list(path.rglob("*.f90"))):
        lines = ["---", "tocdepth: 2", "---", "", f"# src/{folder.name}", ""]
        for file in sorted(folder.rglob("*.f90")):
            if (module := read(file.read_text(encoding="utf-8"))) is not None:
                lines += _section(module, file.relative_to(root))
        made[f"api/fortran/{folder.name}.md"] = "\n".join(lines) + "\n"
    return made
