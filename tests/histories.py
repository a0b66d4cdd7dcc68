"""Comparison of histories in tests."""

from __future__ import annotations

from pathlib import Path

import h5py
import numpy as np

REFERENCES = {"DIMENSION_LIST", "REFERENCE_LIST"}  # offsets of objects in the file


def contents(path: Path) -> tuple[tuple[str, str, bytes], ...]:
    """All values and attributes to the bit, by name; independent of flushes during a slow run.

    Data flushed during a run of more than a few seconds change the bytes of its file, but not the
    contents.
    """
    found: list[tuple[str, str, bytes]] = []

    def take(name: str, value: object) -> None:
        array = np.asarray(value)
        data = repr(array.tolist()).encode() if array.dtype.hasobject else array.tobytes()
        found.append((name, f"{array.dtype} {array.shape}", data))

    def visit(name: str, node: h5py.Group | h5py.Dataset) -> None:
        for key in sorted(set(node.attrs) - REFERENCES):
            take(f"{name}@{key}", node.attrs[key])
        if isinstance(node, h5py.Dataset):
            take(name, node[()])

    with h5py.File(path) as file:
        visit("/", file)
        file.visititems(visit)
    return tuple(found)
