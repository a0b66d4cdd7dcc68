"""Cost of the paper's case in lanes: of f and its Jacobian, and of the integration alone.

5 s with 1001 outputs, without and with friction, in closed form. Prints nanoseconds an
evaluation: of f for eight states at once, of the same with each call depending on the previous one,
of f for one state, and of the Jacobian for one; then for some tolerances the largest error of the
penetration over all outputs (against a tolerance of 1e-12, relative to the 3e-9 m of the paper's
figure 4), CPU time of the fastest of many runs, and the counts.

Run it as ``python benchmarks/lanes.py [libkernel_test.so]`` after a build with -DEVOLVENT_TESTS=ON;
the library is that of build/ci unless given. -DEVOLVENT_MARCH=x86-64-v3 or -v4 shows the gain by
wider vectors.
"""

from __future__ import annotations

import ctypes
import sys
import time
from collections.abc import Callable
from pathlib import Path

import numpy as np

ROOT = Path(__file__).resolve().parents[1]
sys.path.insert(0, str(ROOT / "tests"))

from kernel.gearbox import OPEN, Gearbox  # noqa: E402
from kernel.gearbox_cases import paper_gearbox  # noqa: E402
from kernel.kernel import Kernel, _at  # noqa: E402
from kernel.radau import Radau  # noqa: E402

LANES, EVALUATIONS, RUNS = 8, 200_000, 60
DURATION, OUTPUTS, PENETRATION = 5.0, 1001, 3e-9
TOLERANCES = (1e-3, 1e-4, 2e-5, 1e-5, 1e-6, 2e-7, 1e-7, 1e-8, 1e-9)
COUNTS = (
    "steps",
    "rejections",
    "evaluations",
    "iterations",
    "jacobians",
    "factorisations",
    "root_evaluations",
)


def fastest(call: Callable[[], object], runs: int) -> float:
    """Return the CPU time of the fastest of some calls [s]."""
    best = np.inf
    for _ in range(runs):
        before = time.process_time()
        call()
        best = min(best, time.process_time() - before)
    return float(best)


def evaluation(gearbox: Gearbox) -> tuple[float, ...]:
    """Measure f [ns]: eight states, independent and dependent calls; one state; its Jacobian."""
    state = gearbox.start()
    state.y[gearbox.index("angle_deviation_1")] -= 1e-8
    gearbox.mode(state)[:] = 0, 1, 1
    y = np.repeat(state.y[:, None], LANES, axis=1).copy()
    f, t = np.zeros_like(y), np.zeros(LANES)
    lanes, scalar = gearbox.library.lanes_rates, gearbox.library.lanes_scalar
    in_turn = gearbox.library.lanes_rates_in_turn
    jacobian = gearbox.library.lanes_jacobian
    modes = (_at(state.integers), _at(state.reals))
    one = (ctypes.c_double(0.0), _at(state.y))
    calls = (
        lambda: lanes(gearbox.handle, EVALUATIONS, _at(t), _at(y), *modes, _at(f)),
        lambda: in_turn(gearbox.handle, EVALUATIONS, _at(t), _at(y), *modes, _at(f)),
        lambda: scalar(gearbox.handle, EVALUATIONS, *one, *modes, _at(f)),
        lambda: jacobian(gearbox.handle, EVALUATIONS, *one, *modes),
    )
    return tuple(1e9 * fastest(call, 5) / EVALUATIONS for call in calls)


def integrate(gearbox: Gearbox, tolerance: float, runs: int) -> tuple[np.ndarray, float, list[int]]:
    """Return states at the outputs, time of the fastest run [s] and counts."""
    library, state = gearbox.library, gearbox.start()
    radau = Radau(gearbox, tolerance, max_step=DURATION / 50)
    outputs = np.empty((OUTPUTS, len(state.y)))

    def run() -> None:
        code = library.lanes_integrate(
            gearbox.handle,
            radau.handle,
            *(_at(state.y), _at(state.integers), _at(state.reals)),
            ctypes.c_double(DURATION),
            OUTPUTS,
            _at(outputs),
        )
        assert code == 0, code

    seconds = fastest(run, runs)
    counts = radau.counts()
    return outputs, seconds, [getattr(counts, name) for name in COUNTS]


def penetration(gearbox: Gearbox, outputs: np.ndarray) -> np.ndarray:
    """Return the penetration at every output [m], of any tooth pair: from psi and s."""
    state = gearbox.start()
    gearbox.mode(state)[1] = OPEN
    values = np.empty(len(outputs))
    for i, y in enumerate(outputs):
        state.y[1:] = y[1:]
        values[i] = -gearbox.outputs(state)["gap"][0]
    return values


def main() -> None:
    """Print both tables."""
    built = ROOT / "build/ci/tests/libkernel_test.so"
    named = sys.argv[1] if len(sys.argv) > 1 else built
    kernel = Kernel(Path(named))
    for friction in (0.0, 0.3):
        gearbox = paper_gearbox(kernel, friction=friction)
        lanes, waiting, scalar, jacobian = evaluation(gearbox)
        print(f"f = {friction}: {lanes:.0f} ns for eight states, ", end="")
        print(f"{waiting:.0f} ns if it waits for the one before, {scalar:.0f} ns for one,", end="")
        print(f" {jacobian:.0f} ns for the Jacobian")
        exact = penetration(gearbox, integrate(gearbox, 1e-12, 1)[0])
        for tolerance in TOLERANCES:
            outputs, seconds, counts = integrate(gearbox, tolerance, RUNS)
            error = np.max(np.abs(penetration(gearbox, outputs) - exact)) / PENETRATION
            numbers = ", ".join(f"{n} {name}" for n, name in zip(counts, COUNTS, strict=True))
            print(f"  {tolerance:.0e}: error {error:.1e}, {1e3 * seconds:.2f} ms, {numbers}")


if __name__ == "__main__":
    main()
