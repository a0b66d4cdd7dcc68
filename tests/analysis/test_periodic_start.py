"""Search for a periodic start: its limit, its interruption, its report of the orbit."""

from __future__ import annotations

import ctypes
from typing import Any

import numpy as np
import pytest

from kernel.gearbox import Gearbox, State
from kernel.gearbox_description import SPEED, TORQUE, VISCOUS, initial, load
from kernel.kernel import OK, Kernel, Status, _at
from kernel.real_pairs import RealPair

PERIODIC = 3
INVALID_INPUT, NO_SOLUTION = 1, 4
IS_OVER = ctypes.CFUNCTYPE(ctypes.c_bool, ctypes.c_void_p)


class Setup(ctypes.Structure):
    """`evl_periodic_setup`."""

    _fields_ = [("self", ctypes.c_void_p), ("is_over", IS_OVER), ("most_flows", ctypes.c_int)]


class Periodic(ctypes.Structure):
    """`evl_periodic`."""

    _fields_ = [
        *((name, ctypes.c_int) for name in ("pitches", "flows", "periods", "ties")),
        *((name, ctypes.c_double) for name in ("time", "residual")),
        ("multiplier", ctypes.c_double * 2),
        ("time_constant", ctypes.c_double),
        *(
            (name, ctypes.c_bool)
            for name in (
                *("has_multiplier", "is_stable", "is_reached"),
                *("is_interrupted", "has_searched"),
            )
        ),
    ]


def search(
    gearbox: Gearbox, most_flows: int = 200, stop_after: int = 10**9
) -> tuple[int, Periodic, str, State]:
    """Search for the orbit of a gearbox; it is interrupted after `stop_after` flows."""
    sizes = gearbox.sizes
    state = State(
        0.0,
        np.empty(sizes.n_states),
        np.empty(sizes.n_states),
        np.empty(sizes.n_integers, np.int32),
        np.empty(sizes.n_reals),
    )
    gearbox.initial = initial(PERIODIC, None, None)
    gearbox.initial.mesh_position = 0.25
    asked = [0]

    def is_over(_: Any) -> bool:
        asked[0] += 1
        return asked[0] > stop_after

    setup = Setup(None, IS_OVER(is_over), most_flows)
    found, status = Periodic(), Status()
    code = gearbox.library.evl_gearbox_periodic_start(
        gearbox.handle,
        ctypes.byref(gearbox.initial),
        ctypes.byref(setup),
        ctypes.byref(found),
        *map(_at, (state.y, state.yp, state.integers, state.reals)),
        ctypes.byref(status),
    )
    return int(code), found, status.message.decode(), state


def pair(kernel: Kernel, damping: float = 2e3) -> Gearbox:
    return RealPair(fixed=True).gearbox(
        kernel, (load(0, SPEED, -300.0), load(1, TORQUE, -20.0)), damping=damping
    )


def free(kernel: Kernel) -> Gearbox:
    return RealPair(fixed=True).gearbox(
        kernel, (load(0, TORQUE, -20.0), load(1, VISCOUS, 0.2)), damping=2e3
    )


@pytest.mark.parametrize("make", [pair, free])
def test_an_orbit_is_found(kernel: Kernel, make: Any) -> None:
    code, found, message, _ = search(make(kernel))
    assert code == OK, message
    assert found.is_stable
    assert found.is_reached
    assert found.has_multiplier
    assert found.residual <= 1e-9
    assert found.pitches == 1
    size = np.hypot(*found.multiplier)
    assert found.time_constant == pytest.approx(-found.time / np.log(size), rel=1e-12)


@pytest.mark.parametrize("most", [1, 2, 5])
def test_more_flows_than_the_limit_are_refused(kernel: Kernel, most: int) -> None:
    """The message contains the number, and the residual if there is one."""
    code, found, message, _ = search(pair(kernel), most_flows=most)
    assert code == INVALID_INPUT
    assert f"the search needs more than {most} flows over the common period" in message
    assert "time constant" in message
    assert "start with kind: steady" in message
    assert found.flows == most
    assert found.has_searched


def test_the_limit_that_suffices_does_not_change_the_orbit(kernel: Kernel) -> None:
    _, found, _, state = search(pair(kernel))
    code, again, _, same = search(pair(kernel), most_flows=found.flows)
    assert code == OK
    assert again.flows == found.flows
    assert same.y.tobytes() == state.y.tobytes()


@pytest.mark.parametrize("flows", [0, 1, 4])
def test_a_search_is_interrupted_between_flows(kernel: Kernel, flows: int) -> None:
    code, found, message, _ = search(pair(kernel), stop_after=flows)
    assert code == NO_SOLUTION
    assert found.is_interrupted
    assert found.flows == flows
    assert "was interrupted" in message
