"""The kernel's integrator of gearboxes in Python: a ctypes binding of `evolvent/kernel.h`."""

from __future__ import annotations

import ctypes
from typing import Any

import numpy as np

from kernel.gearbox import Gearbox, State
from kernel.interface import fields
from kernel.kernel import OK, Floats, Integers, Status

STEP, EVENT, STOP = range(3)
LANES = 8


class Counts(ctypes.Structure):
    """`evl_radau_counts`."""

    _fields_ = fields("evl_radau_counts")


def serves(gearbox: Gearbox) -> None:
    """Raise a GearboxError if the integrator does not support a gearbox."""
    gearbox.call("evl_radau_serves", gearbox.handle)


class Radau:
    """An integration.

    Raises
    ------
    GearboxError
        From the constructor and from every call that does not return EVL_OK.
    """

    def __init__(self, gearbox: Gearbox, tolerance: float = 1e-9, max_step: float = 1.0) -> None:
        self.gearbox = gearbox
        status, scale = Status(), gearbox.scales()[0]
        create = gearbox.library.evl_radau_create
        self.handle = create(gearbox.handle, scale, tolerance, max_step, status)
        if not self.handle:
            gearbox.check(status.code, status)
        assert status.code == OK

    def __del__(self) -> None:
        if getattr(self, "handle", None):
            self.delete()

    def delete(self) -> None:
        """Free the integrator; repeated calls have no effect."""
        self.gearbox.library.evl_radau_delete(ctypes.byref(self.handle))

    def _call(self, name: str, *arguments: Any) -> None:
        self.gearbox.call(name, self.handle, *arguments)

    def start(self, state: State) -> None:
        """Start at a state."""
        self._call("evl_radau_start", state.t, *state.arrays)

    def advance(self, t_stop: float, state: State) -> tuple[int, Integers]:
        """Make one step; return its outcome and the root functions that fired."""
        t, outcome = ctypes.c_double(), ctypes.c_int()
        fired = np.full(self.gearbox.sizes.n_roots, -99, np.int32)
        results = (ctypes.byref(t), state.y, fired, ctypes.byref(outcome))
        self._call("evl_radau_advance", t_stop, *results)
        state.t = t.value
        return outcome.value, fired

    def interpolate(self, t: float) -> Floats:
        """State at a time within the last step."""
        y = np.empty(self.gearbox.sizes.n_states)
        self.gearbox.library.evl_radau_interpolate(self.handle, t, y)
        return y

    def interpolate_lanes(self, t: Floats) -> Floats:
        """States at eight times within the last step, one row each."""
        y = np.empty((self.gearbox.sizes.n_states, len(t)))
        self.gearbox.library.evl_radau_interpolate_lanes(self.handle, t, y)
        return y.T

    def restart(self, state: State) -> None:
        """Continue from the state after an event."""
        self.gearbox.library.evl_radau_restart(self.handle, state.t, *state.arrays)

    def redo(self, state: State) -> None:
        """Undo the last step; the state is that of its start."""
        t = ctypes.c_double()
        self.gearbox.library.evl_radau_redo(self.handle, ctypes.byref(t), state.y)
        state.t = t.value

    def counts(self) -> Counts:
        """Work counters."""
        counts = Counts()
        self.gearbox.library.evl_radau_get_counts(self.handle, counts)
        return counts


def sight(gearbox: Gearbox, t: float = 0.0) -> tuple[Floats, float]:
    """Step limits from t: for each state, and in time; the largest number if there is none."""
    reach, time = np.empty(gearbox.sizes.n_states), ctypes.c_double()
    given = (gearbox.handle, gearbox.scales()[0], t, reach, ctypes.byref(time))
    gearbox.library.lanes_sight(*given)
    return reach, time.value


def model(gearbox: Gearbox, states: list[State]) -> tuple[Floats, Floats]:
    """Rates [8, n] at eight states with the modes of the first one, and df/dy at the first."""
    n = gearbox.sizes.n_states
    t = np.array([state.t for state in states])
    y = np.array([state.y for state in states]).T.copy()
    f, jacobian = np.full((n, LANES), np.nan), np.full((n, n), np.nan, order="F")
    arrays = (gearbox.scales()[0], t, y, *states[0].arrays[1:], f, jacobian)
    status = Status()
    gearbox.library.lanes_model(gearbox.handle, *arrays, status)
    gearbox.check(status.code, status)
    return f.T, jacobian
