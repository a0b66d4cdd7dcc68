"""Cost of orbits: branches of test systems, and long runs for the same states.

    python benchmarks/orbit_branches.py [LIBRARY]    (build/ci/tests/libkernel_test.so)

Prints processor time: of a branch; of one period with its derivative; of Newton's iteration from a
distance of 0.1 to an orbit, and of a run from there long enough to come within 1e-8 of the orbit.
"""

from __future__ import annotations

import sys
import time
from pathlib import Path

import numpy as np
from batch import ROOT

sys.path.insert(0, str(ROOT / "tests"))
from continuation.orbits import System, load

SYSTEMS = {
    "duffing": ([0.9, 0.1, 1, 1, 0.4], [0.5, 0], (0.9, 2.5)),
    "parting": ([0.7, 1.638, 0.03, 1], [0.8, 0], (0.65, 1.2)),
    "stop": ([0.7, 0.05, 0.9, 1, 2], [0.4, 0.5], (0.6, 3)),
}


def report(system: System, start: list[float], between: tuple[float, float]) -> str:
    frequency = system.p[0]
    period, y = 2 * np.pi / frequency, np.array(start)
    began = time.process_time()
    for _ in range(500):
        y, _ = system.flow(y, period)
    once = (time.process_time() - began) / 500
    system.options(between=between, steps=(0.003, 1e-7, 0.03))
    began = time.process_time()
    for _ in range(20):
        orbit = system.find(y + 0.1)
    found = (time.process_time() - began) / 20
    turns = int(np.ceil(np.log(1e-7) / np.log(max(abs(orbit.multipliers)))))
    began = time.process_time()
    points = system.follow()
    branch = time.process_time() - began
    return (
        f"branch of {len(points)} points {1e3 * branch:.0f} ms, a period with its derivative "
        f"{1e3 * once:.3f} ms, from 0.1 beside: Newton {1e3 * found:.2f} ms, "
        f"a run of {turns} periods {1e3 * once * turns:.1f} ms"
    )


def main() -> None:
    library = Path(sys.argv[1]) if len(sys.argv) > 1 else ROOT / "build/ci/tests/libkernel_test.so"
    for name, (parameters, start, between) in SYSTEMS.items():
        print(f"{name}: {report(System(load(library), name, parameters), start, between)}")


if __name__ == "__main__":
    main()
