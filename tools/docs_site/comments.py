"""Comments of the code as Markdown: paragraphs, lists, indented formulas."""

from __future__ import annotations

import re
from textwrap import dedent


def markdown(lines: list[str], indented: int = 3) -> str:
    """Convert the lines of a comment, without its markers, to Markdown.

    Lines with so many blanks in front, other than those of a list, keep their layout. Names of
    pages become links.
    """
    blocks: list[str] = []
    text: list[str] = []
    literal: list[str] = []

    def close() -> None:
        while literal and not literal[-1]:
            literal.pop()
        if text:
            blocks.append("\n".join(text))
        if literal:
            blocks.append(f"```text\n{dedent(chr(10).join(literal))}\n```")
        text.clear()
        literal.clear()

    in_list = False
    for line in lines:
        is_item = re.match(r" *(?:[-*]|\d+\.) ", line) is not None
        is_indented = len(line) - len(line.lstrip()) >= indented
        if not line.strip():
            if literal:
                literal.append("")
            else:
                close()
            in_list = False
        elif is_indented and not in_list and not is_item:
            if text:
                close()
            literal.append(line)
        else:
            if literal or (is_item and text and not in_list):
                close()
            in_list = in_list or is_item
            text.append(escaped(line))
    close()
    return "\n\n".join(blocks)


def escaped(text: str) -> str:
    """Text without the characters that Markdown would interpret; code between backticks stays."""
    parts = re.split(r"(`[^`\n]+`)", text)
    plain = [re.sub(r"([\\*_<>$\[\]|#~{}`])", r"\\\1", part) for part in parts[::2]]
    parts[::2] = [re.sub(r"docs/[\w/\\]+\.md\b", _link, part) for part in plain]
    return "".join(parts)


def _link(match: re.Match[str]) -> str:
    page = match[0].replace("\\", "")
    return f"[{match[0]}](/{page})"
