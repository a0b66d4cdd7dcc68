"""Documents in tests: their fenced blocks, executed as by a reader, and the quoted outputs."""

from __future__ import annotations

import os
import re
import subprocess
from dataclasses import dataclass
from decimal import Decimal
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
TUTORIAL = ROOT / "docs" / "tutorial" / "tutorial.md"
GUIDES = tuple(ROOT / "docs" / "guides" / name for name in ("strength.md", "internal_pair.md"))
SESSIONS = (TUTORIAL, *GUIDES)  # test_tutorial.py runs them
# Fenced blocks: the language, then everything up to the closing fence.
FENCE = re.compile(r"^```(\w*)\n(.*?)^```$", re.MULTILINE | re.DOTALL)
NOT_RUN = "# not run:"  # after a command, or in a comment above a block; the reason follows
MARK = re.compile(r"^<!-- (not run:.*) -->\n(```\w+\n)", re.MULTILINE)
NUMBER = re.compile(r"[-+]?\d+(?:\.\d+)?(?:e[-+]?\d+)?")
TOKEN = re.compile(rf"{NUMBER.pattern}|\.\.\.|[^\s\d+-]+|[-+]")
LEFT_OUT = "..."  # in a quote: an omitted line, or the rest of one


def read(page: Path) -> str:
    """Text of a page; a block that is not run starts with `NOT_RUN`."""
    return MARK.sub(r"\2# \1\n", page.read_text(encoding="utf-8"))


def blocks(page: Path, *languages: str) -> list[str]:
    """Fenced blocks of these languages, in order."""
    text = read(page)
    return [body for language, body in FENCE.findall(text) if language in languages]


@dataclass(frozen=True)
class Step:
    """A block of commands or of Python, and its quoted output."""

    language: str
    text: str
    quote: str | None


def steps(page: Path) -> list[Step]:
    """Blocks that a reader runs, in order; a text block after one is its output."""
    text = read(page)
    found = list(FENCE.finditer(text))
    listed = []
    for block, behind in zip(found, [*found[1:], None], strict=True):
        if block[1] not in ("bash", "python") or block[2].startswith(NOT_RUN):
            continue
        quoted = behind and behind[1] == "text" and not text[block.end() : behind.start()].strip()
        listed.append(Step(block[1], block[2], behind[2] if behind and quoted else None))
    return listed


def run_as_reader(words: list[str], folder: Path) -> subprocess.CompletedProcess[str]:
    """Run a command with `folder/bin` in the path; stdout and stderr are combined."""
    path = os.pathsep.join([str(folder / "bin"), os.environ["PATH"]])
    python_path = os.pathsep.join([str(ROOT / "postprocess"), os.environ.get("PYTHONPATH", "")])
    return subprocess.run(
        words,
        cwd=folder,
        env={
            **os.environ,
            "PATH": path,
            "PYTHONPATH": python_path.rstrip(os.pathsep),
            "EVOLVENT_PROGRESS_INTERVAL": "3600",  # no progress output, also on a busy machine
        },
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
        timeout=300,
        check=False,
    )


def tokens(line: str) -> list[str]:
    """Numbers and the texts between them; blanks are ignored."""
    return TOKEN.findall(line)


def same(quoted: str, printed: str) -> bool:
    """Whether a token agrees with the quoted one: equal words, numbers to the digits shown.

    Numbers with a decimal point, and integers from 1000 on, may differ by one in the last digit.
    """
    if not NUMBER.fullmatch(quoted) or not NUMBER.fullmatch(printed):
        return quoted == printed
    digits = quoted.partition("e")[0].lstrip("+-")
    if "." not in digits and len(digits) < 4:
        return quoted == printed
    shown = Decimal(quoted)
    last = Decimal(1).scaleb(int(shown.as_tuple().exponent))
    return abs(shown - Decimal(printed)) <= last


def agrees(quoted: str, printed: str) -> bool:
    """Whether a printed line agrees with the quoted one, which may omit its end."""
    here, there = tokens(quoted), tokens(printed)
    if here and here[-1] == LEFT_OUT:
        here.pop()
        there = there[: len(here)]
    return len(here) == len(there) and all(map(same, here, there))


def missing_line(quote: str, output: str) -> str | None:
    """Return the first line of a quote that is missing in the output; None if all are found.

    Lines must be consecutive in the output; a line `...` matches any omitted lines. Empty lines
    are ignored.
    """
    printed = [line for line in output.splitlines() if line.strip()]
    index, free = 0, False
    for quoted in filter(str.strip, quote.splitlines()):
        if quoted.strip() == LEFT_OUT:
            free = True
            continue
        last = len(printed) if free else index + 1
        fits = [i for i in range(index, min(last, len(printed))) if agrees(quoted, printed[i])]
        if not fits:
            return quoted
        index, free = fits[0] + 1, False
    return None if free or index == len(printed) else f"nothing behind: {printed[index]}"
