"""Checksums of files: a line with the checksum of all other bytes.

They reveal damage before a library reads the file. docs/reference/result_format.md describes the
line; driver/files/checksum.c of the program writes and reads the same. The line is at the front, in
the user block of HDF5 (plans), or at the end, after the data of HDF5 (histories, summaries). In
stacked histories it covers the first bytes of the file: the checksums of the rows are in the
journal.
"""

from __future__ import annotations

import re
import zlib
from pathlib import Path
from typing import BinaryIO

USER_BLOCK = 512  # bytes at the front, the smallest user block of HDF5
LENGTH = 64
MARK = b"evolvent-seal 1 crc32 "
FIRST = re.compile(rb".{8} of the first (\d{1,15}) ", re.DOTALL)  # after the mark
PIECE = 2**20  # bytes per read
HOLDS, NONE, BROKEN = "holds", "none", "broken"  # results of `check`


def prepend_checksum(path: Path) -> None:
    """Write the checksum of a file that has a user block of `USER_BLOCK` bytes at its front."""
    with path.open("r+b") as file:
        file.seek(LENGTH)
        line = _line(file, path.stat().st_size - LENGTH)
        file.seek(0)
        file.write(line)


def append_checksum(path: Path) -> None:
    """Append the checksum to a file."""
    size = path.stat().st_size
    with path.open("r+b") as file:
        line = _line(file, size)
        file.seek(size)
        file.write(line)


def check(path: Path) -> str:
    """Read a whole file and verify its checksum, if it has one.

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
        for offset, from_ in ((0, LENGTH), (covered, 0)):
            file.seek(max(offset, 0))
            found = file.read(LENGTH)
            if covered >= 0 and found.startswith(MARK):
                file.seek(from_)
                said = FIRST.match(found, len(MARK))
                n = min(int(said[1]), covered) if said else covered
                of = "of the first" if said else "of"
                return HOLDS if _line(file, n, of) == found else BROKEN
    return NONE


def _line(file: BinaryIO, covered: int, of: str = "of") -> bytes:
    """Checksum line of the next `covered` bytes."""
    checked, rest = 0, covered
    while rest > 0 and (piece := file.read(min(PIECE, rest))):
        checked = zlib.crc32(piece, checked)
        rest -= len(piece)
    return f"{MARK.decode()}{checked:08x} {of} {covered} bytes".encode().ljust(LENGTH - 1) + b"\n"
