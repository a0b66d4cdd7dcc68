"""Cost of one evaluation of f for eight states: for each law, load, deviation and compliance.

Prints for each the nanoseconds for eight states in lanes, for eight states one by one, and their
ratio; for flanks also the number of pairs in contact. With a second library, of
another build, it also prints the ratio of its time in lanes to that of the first: how much faster
the first one is. Times are CPU times, the shortest of many turns in which the libraries alternate.

Run it as ``python benchmarks/lane_laws.py [libkernel_test.so [another libkernel_test.so]]`` after a
build with -DEVOLVENT_TESTS=ON; the library is that of build/ci unless given.
"""

from __future__ import annotations

import ctypes
import sys
import time
from collections.abc import Callable, Iterator
from concurrent.futures import ProcessPoolExecutor
from multiprocessing import get_context
from pathlib import Path
from typing import Any

import numpy as np

ROOT = Path(__file__).resolve().parents[1]
sys.path.insert(0, str(ROOT / "tests"))

from gearbox.lanes.lane_cases import (  # noqa: E402
    CONTACTS,
    DAMPINGS,
    DEVIATIONS,
    FRICTIONS,
    SAMPLES,
    loaded_pair,
    pair_with_laws,
    real_gears,
    real_state,
)
from kernel.gearbox import LOADED, Gearbox, State  # noqa: E402
from kernel.gearbox_cases import in_mode  # noqa: E402
from kernel.gearbox_description import STEADY  # noqa: E402
from kernel.kernel import Kernel, _at  # noqa: E402

LANES, EVALUATIONS, TURNS = 8, 5000, 15
BENDING: dict[str, dict[str, Any]] = {
    "stiff": {},
    "bending": {"elements": True, "tooth_coupling": "false", "edge_contact": "false"},
    "bending together": {"elements": True, "edge_contact": "false"},
}


def cases(kernel: Kernel) -> Iterator[tuple[str, Gearbox, State]]:
    """Return name, gearbox and a loaded state of each case."""

    def paired(name: str, gearbox: Gearbox) -> tuple[str, Gearbox, State]:
        state = in_mode(gearbox, np.random.default_rng(1), (LOADED, 0), displacement=1e-6)
        return name, gearbox, state

    for name in CONTACTS:
        yield paired(f"contact {name}", pair_with_laws(kernel, name, "none", "none"))
    for name in DAMPINGS:
        yield paired(f"damping {name}", pair_with_laws(kernel, "johnson", name, "none"))
    for name in FRICTIONS:
        yield paired(f"friction {name}", pair_with_laws(kernel, "johnson", "none", name))
    for name in SAMPLES:
        yield paired(f"load {name}", loaded_pair(kernel, name))
    for name in DEVIATIONS:
        gearbox = real_gears(kernel, name)
        state, loaded = real_state(gearbox, np.random.default_rng(1))
        yield f"flanks {name} ({loaded} pairs)", gearbox, state
    for name, keys in BENDING.items():
        gearbox = real_gears(kernel, "perfect", **keys)
        for mesh_position in (0.1, 0.75):
            state = gearbox.start(STEADY, mesh_position=mesh_position)
            modes = [gearbox.mode(state, contact)[1] for contact in range(gearbox.sizes.n_reals)]
            yield f"at rest, {name}, pairs: {modes.count(LOADED)}", gearbox, state


class Worker:
    """All cases of one library. Two libraries need two processes: each has its own kernel."""

    def __init__(self, library: str) -> None:
        self.cases = list(cases(Kernel(Path(library))))

    def names(self) -> list[str]:
        """Return the names of the cases."""
        return [name for name, *_ in self.cases]

    def measure(self, case: int) -> tuple[float, float]:
        """Return the nanoseconds of f for eight states in lanes, and for one."""
        _, gearbox, state = self.cases[case]
        y = np.repeat(state.y[:, None], LANES, axis=1).copy()
        f, t = np.empty_like(y), np.full(LANES, state.t)
        rest = (state.integers, state.reals, f)
        lanes, scalar = gearbox.library.lanes_rates, gearbox.library.lanes_scalar
        eight, one = tuple(map(_at, (t, y, *rest))), tuple(map(_at, (state.y, *rest)))
        return (
            nanoseconds(lambda: lanes(gearbox.handle, EVALUATIONS, *eight)),
            nanoseconds(lambda: scalar(gearbox.handle, EVALUATIONS, ctypes.c_double(0.0), *one)),
        )


def nanoseconds(call: Callable[[], int]) -> float:
    """Measure the CPU time of one evaluation."""
    before = time.process_time_ns()
    code = call()
    assert code == 0, code
    return (time.process_time_ns() - before) / EVALUATIONS


def load_library(library: str) -> None:
    """Make the worker of this process."""
    global worker
    worker = Worker(library)


def names() -> list[str]:
    """Return the names of the cases, from a separate process."""
    return worker.names()


def measure(case: int) -> tuple[float, float]:
    """Return the nanoseconds of a case, from a separate process."""
    return worker.measure(case)


def main() -> None:
    """Print the table."""
    libraries = sys.argv[1:] or [str(ROOT / "build/ci/tests/libkernel_test.so")]
    pools = [
        ProcessPoolExecutor(1, get_context("spawn"), load_library, (library,))
        for library in libraries
    ]
    print(f"{'':34} lanes   8 x 1   ratio" + "   other lanes   ratio" * (len(pools) - 1))
    for case, name in enumerate(pools[0].submit(names).result()):
        turns = [[p.submit(measure, case).result() for p in pools] for _ in range(TURNS)]
        (lanes, one), *others = np.min(turns, axis=0)
        line = f"{name:33} {lanes:6.0f} {8 * one:7.0f} {8 * one / lanes:7.1f}"
        print(line + "".join(f" {other:13.0f} {other / lanes:7.2f}" for other, _ in others))


if __name__ == "__main__":
    main()
