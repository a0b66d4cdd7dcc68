"""Reference of the C interfaces, from the doc comments of their headers."""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

from docs_site.comments import escaped, markdown

HEADERS = {
    "evolvent": "driver/library/include/evolvent/evolvent.h",
    "kernel": "src/include/evolvent/kernel.h",
    "description": "src/include/evolvent/description.h",
}
SECTION = re.compile(r"/\* -{2,} (.*?) -{2,} \*/")
TOKEN = re.compile(
    r"(?P<section>/\* -{2,} .*? -{2,} \*/)"
    r"|/\*\*(?P<doc>(?!<).*?)\*/"
    r"|(?P<note>/\*.*?\*/)"
    r"|(?P<directive>^[ \t]*\#(?:[^\n]*\\\n)*[^\n]*)"
    r'|(?P<opening>extern "C" \{)|(?P<closing>\})'
    r"|(?P<declaration>[^\s/#}])",
    re.MULTILINE | re.DOTALL,
)


@dataclass(frozen=True)
class Declaration:
    """A declaration with its comment, and the heading it is under."""

    section: str
    doc: str
    code: str

    @property
    def plain(self) -> str:
        """Its code in one line, without comments and visibility."""
        code = re.sub(r"/\*.*?\*/", "", self.code, flags=re.DOTALL)
        return " ".join(code.replace("EVL_API", "").split()).removesuffix(";")

    @property
    def name(self) -> str:
        """Name of the function or type; "" for a group of constants."""
        if self.plain.startswith("enum {"):
            return ""
        if self.plain.startswith("typedef") and "(" not in self.plain.split("{")[0]:
            return self.plain.split()[-1]
        found = re.search(r"(\w+)\)? ?\(", self.plain)
        assert found, f"a declaration without a name: {self.plain}"
        return found[1]


def declarations(text: str) -> tuple[str, list[Declaration]]:
    """Comment of a header, and its declarations in order."""
    begin = 0
    head = doc = section = ""
    found = []
    while match := TOKEN.search(text, begin):
        begin = match.end()
        if match["section"]:
            heading = SECTION.fullmatch(match["section"])
            assert heading
            section = heading[1]
        elif match["doc"] is not None:
            doc = match["doc"]
        elif match["directive"] and not head:
            head, doc = doc, ""  # the include guard ends the comment of the file
        elif match["declaration"]:
            begin = _end(text, match.start())
            found.append(Declaration(section, doc, text[match.start() : begin]))
            doc = ""
    return head, found


def _end(text: str, begin: int) -> int:
    """Position after the semicolon that ends a declaration."""
    depth = 0
    for match in re.compile(r"/\*.*?\*/|[{};]", re.DOTALL).finditer(text, begin):
        depth += {"{": 1, "}": -1}.get(match[0], 0)
        if match[0] == ";" and depth == 0:
            return match.end()
    raise AssertionError(f"a declaration without an end: {text[begin : begin + 60]}")


def _body(doc: str) -> str:
    """Comment as Markdown, with its parameters and return value as fields."""
    lines = [re.sub(r"^ ?\*? {0,2}", "", line) for line in doc.strip().split("\n")]
    text, *fields = re.split(r"@(?=param|return)", "\n".join(lines))
    parts = (
        [markdown([line.rstrip() for line in text.split("\n")], indented=2)] if text.strip() else []
    )
    listed = []
    for field in fields:
        kind, rest = field.split(None, 1)
        name, content = ("", rest) if kind == "return" else rest.split(None, 1)
        label = f":param {name}:" if name else ":returns:"
        listed.append(f"{label} {escaped(' '.join(content.split()))}")
    return "\n\n".join([*parts, *(["\n".join(listed)] if listed else [])])


def _entry(item: Declaration) -> Iterator[str]:
    body = _body(item.doc) if item.doc else ""
    code = "\n".join(["```c", re.sub(r"^EVL_API ", "", item.code), "```"])
    if item.name == "":  # constants
        constants = re.findall(r"(\w+) =", item.plain)
        for constant in constants:
            yield from ["```{c:enumerator} " + constant, ":no-typesetting:", "```"]
        yield from ["", code]
    elif item.plain.startswith("typedef"):
        declared = item.plain.removeprefix("typedef ") if "(" in item.plain.split("{")[0] else ""
        constants = re.findall(r"(\w+) =", item.plain) if "enum" in item.plain[:16] else []
        yield from ["`````{c:type} " + (declared or item.name), "", body, ""]
        if "{" in item.code:
            yield from [code, ""]
        for constant in constants:
            yield from [f"```{{c:enumerator}} {constant}", ":no-typesetting:", "```"]
        yield "`````"
    else:
        yield from ["`````{c:function} " + item.plain, "", body, "`````"]


def page(title: str, name: str, text: str) -> str:
    """Page of a header."""
    head, items = declarations(text)
    lines = [f"# {title}", "", f"Include it as `#include <evolvent/{name}.h>`.", "", _body(head)]
    section = ""
    for item in items:
        if item.section != section:
            section = item.section
            lines += ["", f"## {section[0].upper()}{section[1:]}"]
        lines += ["", *_entry(item)]
    return "\n".join(lines) + "\n"


def pages(root: Path) -> dict[str, str]:
    """Pages of all headers, by their path in the site without the ending."""
    titles = {
        "evolvent": "evolvent.h: cases, runs and analyses",
        "kernel": "kernel.h: gearboxes, states, events, integration",
        "description": "description.h: description of a gearbox as data",
    }
    return {
        f"api/c/{name}.md": page(titles[name], name, (root / file).read_text(encoding="utf-8"))
        for name, file in HEADERS.items()
    }
