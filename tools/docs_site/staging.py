"""Pages of the repository in the form that Sphinx reads, at the same relative paths.

README.md becomes the first page. Links to files of the code lead to pages that show them.
"""

from __future__ import annotations

import os
import re
import shutil
from collections.abc import Iterator
from pathlib import Path, PurePosixPath

from docs_site.c_headers import HEADERS

LINK = re.compile(r"(?P<text>!?\[[^\]]*\])\((?P<target>[^)\s#]*)(?P<anchor>#[^)\s]*)?\)")
MERMAID = re.compile(r"^```mermaid\n(.*?)^```$", re.MULTILINE | re.DOTALL)
CODE = re.compile(r"(^```.*?^```$)", re.MULTILINE | re.DOTALL)
MARK = re.compile(r"^# not run:.*\n|(?<=\S) +# not run:.*$", re.MULTILINE)  # for the tests
TOP = ("README.md", "CONTRIBUTING.md", "CHANGELOG.md")
FOLDERS = ("tutorial", "guides", "reference", "theory", "reports")
LANGUAGES = {".c": "c", ".h": "c", ".f90": "fortran", ".py": "python", ".yaml": "yaml"}
START = "docs/README.md"  # index of all pages by task


def _page(path: str) -> str:
    """Path in the site of a page of the repository."""
    return "index.md" if path == "README.md" else path


def write(root: Path, source: Path, pages: dict[str, str]) -> None:
    """Write the source folder of Sphinx.

    Parameters
    ----------
    pages : generated pages by their path in the site.
    """
    shutil.rmtree(source, ignore_errors=True)
    for name, text in pages.items():
        _put(source / name, text)
    for image in sorted((root / "docs").rglob("*.png")):
        target = source / image.relative_to(root)
        target.parent.mkdir(parents=True, exist_ok=True)
        shutil.copyfile(image, target)
    texts = {name: (root / name).read_text(encoding="utf-8") for name in (*TOP, *_docs(root))}
    shown: set[str] = set()
    for name, original in texts.items():
        text = MARK.sub("", original)
        converted = "".join(
            part if i % 2 else _linked(root, name, part, shown)
            for i, part in enumerate(CODE.split(MERMAID.sub(_table, text)))
        )
        extra = contents(texts[START], pages) if name == "README.md" else ""
        _put(source / _page(name), converted + extra)
    for name in sorted(shown):
        _show(root, source, name)


def _put(path: Path, text: str) -> None:
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(text, encoding="utf-8")


def _docs(root: Path) -> list[str]:
    return sorted(path.relative_to(root).as_posix() for path in (root / "docs").rglob("*.md"))


def _linked(root: Path, page: str, text: str, shown: set[str]) -> str:
    """Text with links to files of the repository replaced by links to pages of the site."""

    def replaced(match: re.Match[str]) -> str:
        target, anchor = match["target"], match["anchor"] or ""
        if not target or re.match(r"\w+:", target):
            return match[0]
        linked = os.path.normpath(PurePosixPath(page).parent / target)
        if (root / linked).is_dir():
            return match["text"].strip("[]")
        if linked.endswith(".png"):
            return match[0]
        header = next((name for name, file in HEADERS.items() if file == linked), None)
        if header:
            here = f"api/c/{header}.md"
        elif linked.endswith(".md"):
            here = _page(linked)
        else:
            shown.add(linked)
            here = f"files/{linked}.md"
        relative = os.path.relpath(here, PurePosixPath(_page(page)).parent)
        return f"{match['text']}({relative}{anchor})"

    return LINK.sub(replaced, text)


def _show(root: Path, source: Path, name: str) -> None:
    """Write a page that shows a file of the repository."""
    copy = source / "files" / name
    copy.parent.mkdir(parents=True, exist_ok=True)
    shutil.copyfile(root / name, copy)
    language = LANGUAGES.get(copy.suffix, "text")
    lines = ["---", "orphan: true", "---", "", f"# `{name}`", ""]
    lines += ["```{literalinclude} " + copy.name, f":language: {language}", "```", ""]
    _put(copy.with_name(f"{copy.name}.md"), "\n".join(lines))


def _table(match: re.Match[str]) -> str:
    """Diagram of the flowchart language as a table of its arrows."""
    arrows: dict[str, list[str]] = {}
    labels = re.findall(r'(\w+)(?:\["([^"]+)"\]|\(\[([^\]]+)\]\))', match[1])
    names = {name: quoted or round_ for name, quoted, round_ in labels}
    rows = [line.strip() for line in match[1].splitlines() if "-->" in line]
    for row in rows:
        plain = re.sub(r'(\w+)(?:\(\[.*?\]\)|\[".*?"\])', r"\1", row)
        begin, *label, end = re.split(r" -- | --> ", plain)
        by = f" ({label[0].strip(chr(34))})" if label else ""
        arrows.setdefault(names.get(begin, begin), []).append(names.get(end, end) + by)
    head = ["| module | uses |" if "subgraph" in match[1] else "| from | to |", "|---|---|"]
    return "\n".join([*head, *(f"| {a} | {', '.join(b)} |" for a, b in arrows.items())])


def contents(start: str, pages: dict[str, str]) -> str:
    """Tables of contents of the first page, each page in the order of the index by task."""
    listed = [target for _, target in re.findall(r"(\[[^\]]*\])\(([\w/.]+)[^)]*\)", start)]
    parts = ["", *_contents("", ["docs/README"])]
    for folder in FOLDERS:
        named = [f"docs/{page[:-3]}" for page in listed if page.startswith(f"{folder}/")]
        parts += _contents(folder.capitalize(), list(dict.fromkeys(named)))
    for language in ("python", "c", "fortran"):
        made = [name for name in pages if name.startswith(f"api/{language}/")]
        title = {"python": "Python", "c": "C", "fortran": "Fortran"}[language]
        parts += _contents(f"{title} interface", [name.rsplit(".", 1)[0] for name in made])
    parts += _contents("Project", ["CONTRIBUTING", "CHANGELOG"])
    return "\n".join(parts) + "\n"


def _contents(caption: str, documents: list[str]) -> Iterator[str]:
    title = [f":caption: {caption}"] if caption else []
    yield from ["", "```{toctree}", ":hidden:", *title, "", *documents, "```"]
