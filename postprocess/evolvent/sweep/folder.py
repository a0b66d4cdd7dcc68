"""Folder of a sweep: its shards, their journals and locks, its copy of the design.

`evolvent batch` writes the shards; docs/guides/sweeps.md describes the files.
"""

from __future__ import annotations

import fcntl
import os
import shutil
import struct
import sys
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from evolvent.checksums import NONE, check
from evolvent.errors import SweepError, replacing, writing
from evolvent.sweep.design import Design, read_design

HASH = "design.txt"
COPY = "design.h5"
FLOCK = "hhqqi4x"  # struct flock of Linux: type, whence, start, length, owner


@dataclass(frozen=True, order=True)
class Shard:
    """Part `index` (from 1) of `of`: the cases i with i mod of == index - 1."""

    of: int
    index: int

    @property
    def stem(self) -> str:
        """Name of its files, without the extension."""
        return f"shard-{self.index}-of-{self.of}"


def check_folder(folder: Path, design: Design) -> None:
    """Reject a folder that contains the results of another design.

    Raises
    ------
    SweepError
        It is not a folder, or of another design.
    """
    if folder.exists() and not folder.is_dir():
        raise SweepError(f"{folder}: is not a folder")
    try:
        found = (folder / HASH).read_text(encoding="utf-8").strip()
    except FileNotFoundError:
        return
    if found != design.hash:
        raise SweepError(
            f"{folder}: holds results of another design (its hash is {found[:12]}, not "
            f"{design.hash[:12]}); choose another folder"
        )


def open_for_run(design_path: Path, folder: Path, version: str) -> Design:
    """Read a design and prepare its folder for a run.

    Parameters
    ----------
    design_path : Path
        Design, as written by `evolvent-sweep plan`.
    folder : Path
        Folder of the results. It is created and gets a copy of the design.
    version : str
        Version of the program that is to run it.

    Returns
    -------
    Design
        The design.

    Raises
    ------
    SweepError
        A design of another version of evolvent, or a folder of another design.

    Examples
    --------
    >>> from pathlib import Path
    >>> from evolvent.sweep.folder import open_for_run
    >>> from evolvent.sweep.program import find_program, program_version
    >>> version = program_version(find_program())
    >>> open_for_run(Path("torque.h5"), Path("torque"), version).n_cases
    39
    """
    design = read_design(design_path)
    if check(design_path) == NONE:
        print(
            f"evolvent-sweep: warning: {design_path}: has no checksum, so damage would not be "
            "detected",
            file=sys.stderr,
        )
    if design.version != version:
        raise SweepError(
            f"{design_path}: was made by evolvent {design.version}, but the program is {version}; "
            "plan it again, so that all results are of one version"
        )
    check_folder(folder, design)
    _store_design(design_path, folder)
    return design


def _store_design(design_path: Path, folder: Path) -> None:
    """Copy the design into the folder, so that the folder is self-contained."""
    copy = folder / COPY
    with writing(copy):
        folder.mkdir(parents=True, exist_ok=True)
        if not copy.exists() or not copy.samefile(design_path):
            with replacing(copy) as temporary:
                shutil.copyfile(design_path, temporary)


def design_of(folder: Path, given: Path | None = None) -> Design:
    """Read the design of a folder: its copy, unless another path is given.

    Raises
    ------
    SweepError
        No such folder, no design in it, or the folder is of another one.
    """
    if not folder.is_dir():
        raise SweepError(f"{folder}: no such folder")
    path = given or folder / COPY
    if not path.exists() and given is None:
        raise SweepError(f"{folder}: has no {COPY}; name the design with --design")
    design = read_design(path)
    check_folder(folder, design)
    return design


def is_locked(folder: Path, shard: Shard) -> bool:
    """Whether a run is working on the shard. The lock of a terminated run does not count."""
    # The lock is tested, not acquired: acquiring it briefly could make a starting run fail.
    question = struct.pack(FLOCK, fcntl.F_WRLCK, os.SEEK_SET, 0, 0, 0)
    try:
        with (folder / f"{shard.stem}.lock").open("rb") as lock:
            reply = fcntl.fcntl(lock, fcntl.F_GETLK, question)
    except OSError:  # there is none, or this file system does not support locks
        return False
    return bool(struct.unpack(FLOCK, reply)[0] != fcntl.F_UNLCK)


def remaining_shards(recorded: np.ndarray, of: int) -> list[Shard]:
    """Shards with at least one case that is not recorded.

    Parameters
    ----------
    recorded : numpy.ndarray of bool
        Whether each case is recorded.
    of : int
        Number of shards of the sweep.

    Returns
    -------
    list of Shard
        The shards, by index.

    Examples
    --------
    >>> import numpy as np
    >>> from evolvent.sweep.folder import remaining_shards
    >>> [shard.stem for shard in remaining_shards(np.array([True, False, True, True]), of=2)]
    ['shard-2-of-2']
    """
    return [Shard(of, i) for i in range(1, of + 1) if not recorded[i - 1 :: of].all()]


def common_split(folder: Path, shards: Sequence[Shard]) -> int | None:
    """Number of shards of the folder; None if there was no run in it.

    Parameters
    ----------
    shards : those that have a journal.

    Raises
    ------
    SweepError
        Shards of different splits, which would repeat cases.
    """
    splits = {shard.of for shard in shards}
    if len(splits) > 1:
        kinds = " and ".join(map(str, sorted(splits)))
        raise SweepError(
            f"{folder}: holds runs in {kinds} shards; select one with --shards to continue it"
        )
    return splits.pop() if splits else None
