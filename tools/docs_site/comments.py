"""Comments of the code as Markdown: paragraphs, lists, indented formulas."""

from __future__ import annotations

import re

INDENTED = 3  # blanks in front of a formula or a table


def markdown(lines: list[str]) -> str:
    """Convert the lines of a comment, without its markers, to Markdown.

    Indented lines, other than those of a list, keep their layout.
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
            blocks.append("\n".join(["```text", *literal, "```"]))
        text.clear()
        literal.clear()

    in_list = False
    for line in lines:
        is_item = re.match(r" *(?:[-*]|\d+\.) ", line) is not None
        is_indented = len(line) - len(line.lstrip()) >= INDENTED
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
    return "".join(
        part if i % 2 else re.sub(r"([\\*_<>$\[\]|#~{}`])", r"\\\1", part)
        for i, part in enumerate(parts)
    )
