"""A file that the system refuses HDF5 is known to the program, which then ends at once."""

from __future__ import annotations

import os
from pathlib import Path

import pytest

from evolvent.errors import HALF_WRITTEN, NOT_WRITTEN, EvolventError, replacing_hdf5


class BrokenError(Exception):
    """What HDF5 tells of what it was refused before."""


def use(path: Path, refused: str) -> None:
    """Use a file as HDF5 does, of which the system lets nothing be read, or written."""
    with replacing_hdf5(path) as file:
        file.write(b"one")
        flags = os.O_WRONLY if refused == "read" else os.O_RDONLY
        other = os.open(os.devnull, flags)
        os.dup2(other, file.fileno())
        os.close(other)
        if refused == "read":
            try:
                file.readinto(bytearray(3))  # type: ignore[attr-defined]
            except OSError as error:
                raise BrokenError from error
        file.write(b"two")
        raise BrokenError


@pytest.mark.parametrize("refused", ["read", "write"])
def test_what_hdf5_cannot_read_back_or_write_is_half_written(tmp_path: Path, refused: str) -> None:
    """HDF5 may crash over either as the program ends."""
    with pytest.raises(
        EvolventError, match=r"all\.h5: cannot be written \(Bad file desc"
    ) as reported:
        use(tmp_path / "all.h5", refused)
    assert reported.value.code == NOT_WRITTEN
    HALF_WRITTEN.pop().close()
    assert HALF_WRITTEN == []
    assert list(tmp_path.iterdir()) == []
