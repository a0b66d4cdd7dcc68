"""Binding of `evl_wheel_store`: the caller's cache of wheel compliances."""

from __future__ import annotations

import ctypes
from collections.abc import Callable

import numpy as np

_Numbers = ctypes.POINTER(ctypes.c_double)
_Call = ctypes.CFUNCTYPE(
    ctypes.c_int, ctypes.c_void_p, ctypes.c_int, _Numbers, ctypes.c_int, _Numbers
)


class WheelStore(ctypes.Structure):
    """Values by key, and call counters; `alter` changes the values computed by the kernel."""

    _fields_ = [("self", ctypes.c_void_p), ("find", _Call), ("put", _Call)]

    def __init__(self, alter: Callable[[np.ndarray], None] | None = None, answer: int = 1) -> None:
        super().__init__(None, _Call(self._find), _Call(self._put))
        self.known: dict[bytes, np.ndarray] = {}
        self.asked = self.computed = 0
        self.alter = alter
        self.answer = answer

    def _find(self, _: int, n_key: int, key: _Numbers, n: int, numbers: _Numbers) -> int:  # type: ignore[valid-type]
        self.asked += 1
        found = self.known.get(np.ctypeslib.as_array(key, (n_key,)).tobytes())
        if found is None:
            return min(self.answer, 0)
        np.ctypeslib.as_array(numbers, (n,))[:] = found
        return 1

    def _put(self, _: int, n_key: int, key: _Numbers, n: int, numbers: _Numbers) -> int:  # type: ignore[valid-type]
        self.computed += 1
        values = np.ctypeslib.as_array(numbers, (n,))
        if self.alter is not None:
            self.alter(values)
        self.known[np.ctypeslib.as_array(key, (n_key,)).tobytes()] = values.copy()
        return self.answer
