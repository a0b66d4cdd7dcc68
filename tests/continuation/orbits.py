"""Orbits from Python: a thin ctypes binding of the test library, and the systems that it has."""

from __future__ import annotations

import ctypes
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

Floats = NDArray[np.float64]
KINDS = ("ordinary", "fold", "crossing", "doubling", "neimark_sacker", "touch", "touch_fold")
# which states each system has and what its parameters are: orbit_systems.f90
SYSTEMS = {
    "meissner": (1, 2),
    "duffing": (2, 2),
    "backlash": (3, 2),
    "ball": (4, 3),
    "remembering_stop": (5, 3),
    "van_der_pol": (6, 2),
    "duffing_with_phase": (7, 3),
    "moving_focus": (8, 2),
    "moving_fold": (9, 1),
    "stop": (10, 2),
    "parting": (11, 2),
    "floating": (12, 3),
    "alternating": (13, 2),
    "switched": (14, 2),
    "one_sided": (15, 2),
}

_double, _int, _bool = ctypes.c_double, ctypes.c_int, ctypes.c_bool
_doubles, _ints = ctypes.POINTER(_double), ctypes.POINTER(_int)


class OrbitError(Exception):
    """What the kernel said."""


@dataclass
class Point:
    """A point of a branch."""

    y: Floats
    parameter: float
    period: float
    residual: float
    way: float
    kind: str
    root: int
    iterations: int
    periods: int
    multipliers: NDArray[np.complex128]
    tangent: Floats
    is_recorded: bool


def load(path: Path) -> ctypes.CDLL:
    """Load the test library."""
    c = ctypes.CDLL(str(path))
    handle = ctypes.c_void_p
    c.ot_new.restype = handle
    c.ot_new.argtypes = [_int, _int, _doubles, _int]
    c.ot_delete.argtypes = [handle]
    c.ot_message.argtypes = [handle, ctypes.c_char_p]
    c.ot_options.argtypes = [handle, *[_double] * 4, _bool, *[_double] * 3, _int]
    c.ot_flow.argtypes = [handle, _double, _doubles, _double, _doubles, _doubles, _ints]
    c.ot_find.argtypes = [handle, _double, _int, _doubles, _double]
    c.ot_follow.argtypes = [handle, _int, _bool, _ints]
    c.ot_switch.argtypes = [handle, _int, _double]
    c.ot_values.argtypes = [handle, _int, _doubles]
    c.ot_is_recorded.argtypes = [handle, _int]
    c.ot_point.argtypes = [handle, _int, _doubles, _doubles, _ints, *[_doubles] * 3]
    return c


def _array(values: ArrayLike) -> Floats:
    return np.ascontiguousarray(values, dtype=np.float64)


def _pointer(values: NDArray[Any]) -> Any:
    return values.ctypes.data_as(_doubles if values.dtype == np.float64 else _ints)


class System:
    """One system of the test library; `varied` is the index of its parameter."""

    def __init__(self, c: ctypes.CDLL, name: str, parameters: ArrayLike, varied: int = 0) -> None:
        self.c = c
        kind, self.n = SYSTEMS[name]
        self.p = _array(parameters)
        self.varied = varied
        self.handle = c.ot_new(kind, len(self.p), _pointer(self.p), varied)
        self.options()

    def __del__(self) -> None:
        self.c.ot_delete(self.handle)

    def options(
        self,
        tolerance: float = 1e-12,
        scale: float = 1.0,
        between: tuple[float, float] = (-1e300, 1e300),
        rising: bool = True,
        steps: tuple[float, float, float] = (0.01, 1e-7, 0.1),
        most: int = 1000,
    ) -> None:
        """Choose; steps are the first, the smallest, the largest."""
        first, smallest, largest = steps
        self.c.ot_options(
            self.handle, tolerance, scale, *between, rising, first, smallest, largest, most
        )

    def values(self, values: ArrayLike) -> None:
        """Ask for stable orbits at values of the parameter, too, and let them be told of."""
        rising = _array(values)
        self.c.ot_values(self.handle, len(rising), _pointer(rising))

    def _check(self, code: int) -> None:
        if code:
            text = ctypes.create_string_buffer(401)
            self.c.ot_message(self.handle, text)
            raise OrbitError(text.value.decode())

    def flow(self, y: ArrayLike, duration: float, parameter: float | None = None):
        """Where the flow from y on the section ends, and its derivative."""
        end, derivative = np.zeros(self.n), np.zeros((self.n, self.n))
        numbers = np.zeros(4, np.int32)
        value = self.p[self.varied] if parameter is None else parameter
        arrays = [_pointer(x) for x in (end, derivative, numbers)]
        self._check(self.c.ot_flow(self.handle, value, _pointer(_array(y)), duration, *arrays))
        self.steps, self.ties, self.same_modes, self.events = map(int, numbers)
        return end, derivative.T

    def find(self, y: ArrayLike, parameter: float | None = None, periods: int = 1, period=0.0):
        """Find an orbit near y."""
        value = self.p[self.varied] if parameter is None else parameter
        self._check(self.c.ot_find(self.handle, value, periods, _pointer(_array(y)), period))
        return self.point(0)

    def follow(self, index: int = 0, with_tangent: bool = False) -> list[Point]:
        """Follow the branch of one of the present points."""
        n = _int(0)
        code = self.c.ot_follow(self.handle, index, with_tangent, ctypes.byref(n))
        self.kept = n.value
        self._check(code)
        return [self.point(i) for i in range(n.value)]

    def switch(self, index: int, distance: float) -> Point:
        """From a doubling to the orbit of twice the period."""
        self._check(self.c.ot_switch(self.handle, index, distance))
        return self.point(0)

    def point(self, index: int) -> Point:
        """Return one of the present points."""
        n = self.n
        y, numbers, counts = np.zeros(n), np.zeros(4), np.zeros(5, np.int32)
        re, im, tangent = np.zeros(n), np.zeros(n), np.zeros(n + 2)
        arrays = [_pointer(x) for x in (y, numbers, counts, re, im, tangent)]
        self.c.ot_point(self.handle, index, *arrays)
        kind, root, iterations, periods, m = map(int, counts)
        return Point(
            y,
            *map(float, numbers),
            KINDS[kind],
            root,
            iterations,
            periods,
            re[:m] + 1j * im[:m],
            tangent,
            bool(self.c.ot_is_recorded(self.handle, index)),
        )


def special(points: list[Point], kind: str) -> list[Point]:
    """Return the points of one kind."""
    return [point for point in points if point.kind == kind]
