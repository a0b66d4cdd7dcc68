"""Time of one evaluation of the Johnson force, compared with the paper's iteration (18).

Run it as ``python benchmarks/johnson.py [libkernel_test.so]`` after a build with
-DEVOLVENT_TESTS=ON; the library is that of build/ci unless given. Prints the best of many
rounds, in nanoseconds a call of force with both derivatives, over penetrations of 1e-10 to 1e-4 m
in random order.
"""

from __future__ import annotations

import ctypes
import sys
import time
from pathlib import Path

import numpy as np

ROOT = Path(__file__).resolve().parents[1]
CALLS = 5000  # values a round: their arrays fit in the cache
ROUNDS = 200


def best_time(procedure: object, *arguments: object) -> float:
    """Return the shortest time of a round [ns a call]; arrays are passed by address."""
    passed = [ctypes.c_void_p(a.ctypes.data) if isinstance(a, np.ndarray) else a for a in arguments]
    best = np.inf
    for _ in range(ROUNDS):
        start = time.perf_counter()
        procedure(CALLS, *passed)
        best = min(best, time.perf_counter() - start)
    return best / CALLS * 1e9


def main() -> None:
    path = sys.argv[1] if len(sys.argv) > 1 else ROOT / "build/ci/tests/libkernel_test.so"
    library = ctypes.CDLL(str(path))
    h = 10 ** np.random.default_rng(1).uniform(-10, -4, CALLS)
    rho, e_star, start = np.full(CALLS, 0.065), np.full(CALLS, 1.1e11), np.full(CALLS, 0.2)
    force, d_h, d_rho, back = (np.empty(CALLS) for _ in range(4))
    turns, codes = np.empty(CALLS, np.int32), np.empty(CALLS, np.int32)
    given = (h, rho, e_star)
    fast = best_time(library.test_johnson_force, *given, force, d_h, d_rho, codes)
    inverse = best_time(library.test_johnson_penetration, force, rho, e_star, back, codes)
    tolerance = ctypes.c_double(1e-14)
    slow = best_time(
        library.test_johnson_iteration_force, *given, start, tolerance, 100, d_h, turns, codes
    )
    print(f"force and derivatives     {fast:6.1f} ns")
    print(f"penetration from force    {inverse:6.1f} ns")
    print(f"force by iteration (18)   {slow:6.1f} ns, {turns.mean():.1f} turns")


if __name__ == "__main__":
    main()
