"""The kernel's integrator of gearboxes from Python: a ctypes binding of `evolvent/kernel.h`."""

from __future__ import annotations

import ctypes
from typing import Any

import numpy as np

from kernel.gearbox import Gearbox, State
from kernel.kernel import OK, Floats, Integers, Status, _at, _double, _int

STEP, EVENT, STOP = range(3)
LANES = 8


class Counts(ctypes.Structure):
    """`evl_radau_counts`."""

    _fields_ = [
        *((name, _int) for name in ("steps", "rejections", "evaluations", "iterations")),
        *((name, _int) for name in ("jacobians", "factorisations", "root_evaluations")),
        *((f"growth_{name}", _double) for name in ("t", "rate", "frequency")),
    ]


def serves(gearbox: Gearbox) -> None:
    """Raise a GearboxError if the integrator does not serve a gearbox."""
    status = Status()
    code = gearbox.library.evl_radau_serves(gearbox.handle, ctypes.byref(status))
    gearbox.check(code, status)


class Radau:
    """An integration.

    Raises
    ------
    GearboxError
        From the constructor and from every call that the kernel does not answer with EVL_OK.
    """

    def __init__(self, gearbox: Gearbox, tolerance: float = 1e-9, max_step: float = 1.0) -> None:
        self.gearbox = gearbox
        library = gearbox.library
        library.evl_radau_create.restype = ctypes.c_void_p
        status = Status()
        handle = library.evl_radau_create(
            gearbox.handle,
            _at(gearbox.scales()[0]),
            _double(tolerance),
            _double(max_step),
            ctypes.byref(status),
        )
        self.handle = ctypes.c_void_p(handle)
        if not handle:
            gearbox.check(status.code, status)
        assert status.code == OK

    def __del__(self) -> None:
        if getattr(self, "handle", None):
            self.delete()

    def delete(self) -> None:
        """Free it; a second time does nothing."""
        self.gearbox.library.evl_radau_delete(ctypes.byref(self.handle))

    def _call(self, name: str, *arguments: Any) -> None:
        status = Status()
        function = getattr(self.gearbox.library, name)
        code = function(self.handle, *arguments, ctypes.byref(status))
        self.gearbox.check(code, status)

    def start(self, state: State) -> None:
        """Begin at a state."""
        arrays = (state.y, state.integers, state.reals)
        self._call("evl_radau_start", _double(state.t), *map(_at, arrays))

    def advance(self, t_stop: float, state: State) -> tuple[int, Integers]:
        """Make one step; what it came to and which root functions fired."""
        t, outcome = _double(), _int()
        fired = np.full(self.gearbox.sizes.n_roots, -99, np.int32)
        self._call(
            "evl_radau_advance",
            _double(t_stop),
            ctypes.byref(t),
            _at(state.y),
            _at(fired),
            ctypes.byref(outcome),
        )
        state.t = t.value
        return outcome.value, fired

    def interpolate(self, t: float) -> Floats:
        """State at a time within the last step."""
        y = np.empty(self.gearbox.sizes.n_states)
        self.gearbox.library.evl_radau_interpolate(self.handle, _double(t), _at(y))
        return y

    def interpolate_lanes(self, t: Floats) -> Floats:
        """States at eight times within the last step, a row each."""
        y = np.empty((self.gearbox.sizes.n_states, len(t)))
        self.gearbox.library.evl_radau_interpolate_lanes(self.handle, _at(t), _at(y))
        return y.T

    def restart(self, state: State) -> None:
        """Go on from the state that an event left."""
        arrays = (state.y, state.integers, state.reals)
        restart = self.gearbox.library.evl_radau_restart
        restart(self.handle, _double(state.t), *map(_at, arrays))

    def redo(self, state: State) -> None:
        """Take the last step back; the state is that of its start."""
        t = _double()
        self.gearbox.library.evl_radau_redo(self.handle, ctypes.byref(t), _at(state.y))
        state.t = t.value

    def counts(self) -> Counts:
        """What it cost."""
        counts = Counts()
        self.gearbox.library.evl_radau_get_counts(self.handle, ctypes.byref(counts))
        return counts


def sight(gearbox: Gearbox, t: float = 0.0) -> tuple[Floats, float]:
    """How far a step from t may go: in each state, and in time; the largest number if any way."""
    reach, time = np.empty(gearbox.sizes.n_states), _double()
    gearbox.library.lanes_sight(
        gearbox.handle, _at(gearbox.scales()[0]), _double(t), _at(reach), ctypes.byref(time)
    )
    return reach, time.value


def model(gearbox: Gearbox, states: list[State]) -> tuple[Floats, Floats]:
    """Rates [8, n] at eight states that share the first one's modes, and df/dy at the first."""
    n = gearbox.sizes.n_states
    t = np.array([state.t for state in states])
    y = np.array([state.y for state in states]).T.copy()
    f, jacobian = np.full((n, LANES), np.nan), np.full((n, n), np.nan, order="F")
    arrays = (gearbox.scales()[0], t, y, states[0].integers, states[0].reals, f, jacobian)
    status = Status()
    gearbox.library.lanes_model(gearbox.handle, *map(_at, arrays), ctypes.byref(status))
    gearbox.check(status.code, status)
    return f.T, jacobian
