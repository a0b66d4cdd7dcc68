"""Seals of files: a line that tells the check sum of all other bytes.

So damage is noticed before a library reads the file. docs/result_format.md describes the line; the
program's driver/files/seal.c writes and reads the same. It stands at the front, where HDF5 leaves
room for its user (plans), or at the end, behind what HDF5 reads (histories, summaries). That of
stacked histories is of the file's first bytes: rows have their checks in the journal.
"""

from __future__ import annotations

import re
import zlib
from pathlib import Path
from typing import BinaryIO

ROOM = 512  # bytes at the front, the least that HDF5 leaves
LENGTH = 64
MARK = b"evolvent-seal 1 crc32 "
FIRST = re.compile(rb".{8} of the first (\d{1,15}) ", re.DOTALL)  # behind the mark
PIECE = 2**20  # bytes that are read at a time
HOLDS, NONE, BROKEN = "holds", "none", "broken"  # what `check` answers


def seal_front(path: Path) -> None:
    """Seal a file that has `ROOM` bytes for it at its front."""
    with path.open("r+b") as file:
        file.seek(LENGTH)
        line = _line(file, path.stat().st_size - LENGTH)
        file.seek(0)
        file.write(line)


def seal_end(path: Path) -> None:
    """Seal a file at its end."""
    size = path.stat().st_size
    with path.open("r+b") as file:
        line = _line(file, size)
        file.seek(size)
        file.write(line)


def check(path: Path) -> str:
    """Read all of a file and hold it against its seal, if it has one.

    Returns
    -------
    HOLDS, NONE or BROKEN.

    Raises
    ------
    OSError
        It cannot be read.
    """
    covered = path.stat().st_size - LENGTH
    with path.open("rb") as file:
        for seal_at, from_ in ((0, LENGTH), (covered, 0)):
            file.seek(max(seal_at, 0))
            found = file.read(LENGTH)
            if covered >= 0 and found.startswith(MARK):
                file.seek(from_)
                said = FIRST.match(found, len(MARK))
                n = min(int(said[1]), covered) if said else covered
                of = "of the first" if said else "of"
                return HOLDS if _line(file, n, of) == found else BROKEN
    return NONE


def _line(file: BinaryIO, covered: int, of: str = "of") -> bytes:
    """The seal of so many bytes from here on."""
    checked, rest = 0, covered
    while rest > 0 and (piece := file.read(min(PIECE, rest))):
        checked = zlib.crc32(piece, checked)
        rest -= len(piece)
    return f"{MARK.decode()}{checked:08x} {of} {covered} bytes".encode().ljust(LENGTH - 1) + b"\n"
