"""Cost of the integrator alone: a chain of oscillators, compared with scipy's methods.

Masses on a line with hardening springs and dampers (tests/integrator/oscillator_chain.f90), n = 6,
20 and 50 states, fastest mode near 1 to 1.6 kHz, like the contacts of a gearbox. Prints, for
three tolerances, the largest error over 1001 outputs (states in units of their scales, against a
run with a tolerance of 1e-13), CPU time of the fastest of many runs, microseconds a step, and the
counts. Then the evaluations of f that scipy's methods need for the same error: evaluations, since
their time would be that of Python.

Run it as ``python benchmarks/radau_core.py [libkernel_test.so]`` after a build with
-DEVOLVENT_TESTS=ON; the library is that of build/ci unless given.
"""

from __future__ import annotations

import ctypes
import sys
import time
from pathlib import Path

import numpy as np
from scipy.integrate import solve_ivp

ROOT = Path(__file__).resolve().parents[1]
OUTPUTS = 1001
RUNS = 30
CHAINS = (  # masses, time [s], stiffness [1/s^2], hardening, damping [1/s]
    (3, 0.2, 2.6e7, 10.0, 288.0),
    (10, 0.05, 2.6e7, 10.0, 100.0),
    (25, 0.05, 2.6e7, 10.0, 100.0),
)
PEERS = (("DOP853", 1e-9), ("LSODA", 1e-10), ("Radau", 1e-9))
double = ctypes.c_double
Chain = tuple[int, float, float, float, float]


def start(masses: int, stiffness: float) -> np.ndarray:
    """Return the initial state: one mass displaced, all of them moving."""
    y = np.zeros(2 * masses)
    y[0], y[masses:] = 0.3, 0.1 * np.sqrt(stiffness)
    return y


def ours(library: ctypes.CDLL, chain: Chain, tolerance: float, runs: int = RUNS):
    """Return rows at the outputs, fastest time [s], counts."""
    masses, t_end, *law = chain
    best, rows = np.inf, np.empty((OUTPUTS, 2 * masses))
    counts = np.zeros(9, np.int32)
    for _ in range(runs):
        handle = library.rt_new_chain(
            masses, *map(double, law), False, double(0), double(tolerance)
        )
        t, y = np.zeros(1), start(masses, law[0])
        solver = ctypes.c_void_p(handle)
        pointers = [ctypes.c_void_p(a.ctypes.data) for a in (t, y, rows)]
        interval = t_end / (OUTPUTS - 1)
        began = time.process_time()
        code = library.rt_integrate_chain(
            solver, *pointers[:2], double(t_end), double(interval), OUTPUTS, pointers[2]
        )
        best = min(best, time.process_time() - began)
        if code != 0:
            sys.exit(f"the integration of {chain} failed with code {code}")
        library.rt_counts(solver, ctypes.c_void_p(counts.ctypes.data))
        library.rt_delete(solver)
    return rows, best, counts


def peer(chain: Chain, method: str, tolerance: float):
    """Return rows at the outputs and evaluations of f of one of scipy's methods."""
    masses, t_end, stiffness, hardening, damping = chain
    u, v = np.zeros(masses + 2), np.zeros(masses + 2)

    def f(t: float, y: np.ndarray) -> np.ndarray:
        u[1:-1], v[1:-1] = y[:masses], y[masses:]
        stretch = np.diff(u)
        force = stiffness * (stretch + hardening * stretch**3) + damping * np.diff(v)
        return np.concatenate([y[masses:], np.diff(force)])

    scale = np.repeat([1, np.sqrt(stiffness)], masses)
    outputs = np.linspace(0, t_end, OUTPUTS)
    y0 = start(masses, stiffness)
    result = solve_ivp(f, (0, t_end), y0, method, outputs, rtol=1e-13, atol=tolerance * scale)
    return result.y.T, result.nfev


def main() -> None:
    path = sys.argv[1] if len(sys.argv) > 1 else ROOT / "build/ci/tests/libkernel_test.so"
    library = ctypes.CDLL(str(path))
    library.rt_new_chain.restype = ctypes.c_void_p
    for chain in CHAINS:
        masses, _, stiffness, *_ = chain
        scale = np.repeat([1, np.sqrt(stiffness)], masses)
        exact, _, _ = ours(library, chain, 1e-13, 1)
        print(f"n = {2 * masses}")
        for tolerance in (1e-7, 1e-9, 1e-11):
            rows, seconds, counts = ours(library, chain, tolerance)
            error = np.abs((rows - exact) / scale).max()
            steps, rejected, lanes, single, jacobians, factors = counts[:6]
            print(
                f"  tolerance {tolerance:.0e}  error {error:.1e}  {1e3 * seconds:7.3f} ms  "
                f"{1e6 * seconds / steps:5.2f} us a step  {steps} steps, {rejected} rejected, "
                f"{7 * lanes + single} f in {lanes} calls, {jacobians} J, {factors} LU"
            )
        for method, tolerance in PEERS:
            rows, evaluations = peer(chain, method, tolerance)
            error = np.abs((rows - exact) / scale).max()
            print(f"  scipy {method:6}    error {error:.1e}  {evaluations} f")


if __name__ == "__main__":
    main()
