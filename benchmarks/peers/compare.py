"""Compare evolvent with other programs: the paper's setup, closed form, 5 s, 1001 outputs.

    benchmarks/peers/install
    build/peers/venv/bin/python benchmarks/peers/compare.py [PROGRAM] [--plot FILE.png]

PROGRAM is build/release/evolvent unless given. Prints Markdown: versions, and for each friction the
cheapest run of each program that reaches an accuracy. All runs take turns; times are medians of
processor time: of evolvent all that a batch takes for a case, of the others the integration alone.
docs/reports/peers.md describes the measurements.
"""

from __future__ import annotations

import argparse
import contextlib
import importlib
import importlib.metadata
import json
import os
import platform
import statistics
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from dataclasses import asdict, dataclass, field
from pathlib import Path

import numpy as np
import with_evolvent
import with_scipy
from paper_case import H_REFERENCE, Array, grid

sys.path.insert(0, str(with_evolvent.ROOT / "tests/reference"))

FRICTIONS = (0.0, 0.3)
# Runs that take longer than this are not made in the rounds after the first few.
SLOW, FULL_ROUNDS = 0.05, 3  # [s]
TARGETS = (1.2e-6, 1e-7)  # largest error of h over all outputs, over H_REFERENCE
PACKAGES = ("heyoka", "numba", "numbalsoda", "numpy", "rumoca", "scikit-sundae", "scipy")


@dataclass(frozen=True)
class Peer:
    """A program with one of its methods."""

    name: str
    method: str
    module: str
    largest: float  # exponents of the tolerances that are tried
    smallest: float
    cases: int = 1  # that one run solves
    switches: str = "located"
    suffix: str = ""

    @property
    def label(self) -> str:
        """Name in the table."""
        return f"{self.name} {self.method}{self.suffix}"

    @property
    def tolerances(self) -> list[float]:
        """Two in a decade."""
        n = round(2 * (self.largest - self.smallest)) + 1
        return [float(f"{10.0**e:.3g}") for e in np.linspace(self.largest, self.smallest, n)]


INTEGRATION = ", integration"
EVOLVENT = [
    Peer("evolvent", "radau", "", -4, -10),
    Peer("evolvent", "radau", "", -4, -10, suffix=INTEGRATION),
    Peer("evolvent", "ida", "", -7, -11, suffix=INTEGRATION),
]
BATCH = {"radau": 64, "ida": 3}  # cases
OTHERS = [
    Peer("heyoka", "batch", "with_heyoka", -7, -12, cases=8),
    Peer("heyoka", "scalar", "with_heyoka", -7, -12),
    Peer("numbalsoda", "LSODA", "with_numbalsoda", -6, -10, switches="within f"),
    Peer("numbalsoda", "DOP853", "with_numbalsoda", -6, -10, switches="within f"),
    Peer("rumoca", "rk-like", "with_rumoca", -7.5, -9),
    Peer("rumoca", "bdf", "with_rumoca", -8, -10),
    Peer("scipy", "LSODA", "with_scipy", -7.5, -9.5),
    Peer("scipy", "Radau", "with_scipy", -6, -8),
    Peer("scikit-sundae", "CVODE", "with_sundae", -8, -10),
    Peer("scikit-sundae", "IDA", "with_sundae", -8, -10),
]


@dataclass
class Run:
    """One peer at one friction and tolerance."""

    label: str
    friction: float
    tolerance: float
    error: float = float("nan")
    failure: str = ""
    times: list[float] = field(default_factory=list)  # per case [s]

    @property
    def seconds(self) -> float:
        """Time per case."""
        return statistics.median(self.times)


@contextlib.contextmanager
def quiet() -> Iterator[None]:
    """Keep what compiled code prints away from the table."""
    sys.stdout.flush()
    saved = os.dup(1)
    nowhere = os.open(os.devnull, os.O_WRONLY)
    os.dup2(nowhere, 1)
    try:
        yield
    finally:
        os.dup2(saved, 1)
        os.close(nowhere)
        os.close(saved)


def reference(friction: float, program: Path) -> tuple[Array, str]:
    """Penetration at the outputs [m], and how far two other ways are from it."""
    from gearbox_reference import solve

    h = with_scipy.solver("DOP853", friction, 1e-12)()
    independent = solve(friction, t_eval=grid())["h"]
    own = with_evolvent.run(program, "ida", friction, 1e-13)
    away = [np.abs(other - h).max() / H_REFERENCE for other in (independent, own)]
    return h, f"tests/reference {away[0]:.1e}, evolvent's IDA at 1e-13 {away[1]:.1e}"


def timed(solve: Callable[[], Array]) -> float:
    """Processor time, of all threads if there are several [s]."""
    begin = time.process_time()
    solve()
    return time.process_time() - begin


def measure_other(peer: Peer, run: Run, h: Array) -> Callable[[], list[float]]:
    """Find the error, compile, and return what measures once more."""
    module = importlib.import_module(peer.module)
    solve = module.solver(peer.method, run.friction, run.tolerance)
    run.error = float(np.abs(solve() - h).max() / H_REFERENCE)
    if peer.name != "rumoca":
        return lambda: [timed(solve) / peer.cases]
    # Each simulate() prepares anew, which a run of 1 us tells.
    prepare = module.solver(peer.method, run.friction, run.tolerance, 1e-6)
    return lambda: [timed(solve) - timed(prepare)]


def measure_evolvent(peer: Peer, run: Run, h: Array, program: Path) -> Callable[[], list[float]]:
    """Find the error and return what measures a batch."""
    chosen = (program, peer.method, run.friction, run.tolerance)
    run.error = float(np.abs(with_evolvent.run(*chosen) - h).max() / H_REFERENCE)
    part = 1 if peer.suffix == INTEGRATION else 0
    return lambda: [with_evolvent.seconds(*chosen, BATCH[peer.method])[part]]


def compare(program: Path, rounds: int, chosen: list[Peer]) -> tuple[list[Run], list[str]]:
    """Make all runs, in turns."""
    runs, measures, notes = [], [], []
    for friction in FRICTIONS:
        h, checks = reference(friction, program)
        notes.append(f"Distance of other solutions from the reference, f = {friction:g}: {checks}.")
        for peer in chosen:
            for tolerance in peer.tolerances:
                run = Run(peer.label, friction, tolerance)
                runs.append(run)
                try:
                    measure = (
                        measure_other(peer, run, h)
                        if peer.module
                        else measure_evolvent(peer, run, h, program)
                    )
                except Exception as failure:  # of any kind: the others go on, the table tells
                    run.failure = str(failure).splitlines()[0]
                else:
                    measures.append((run, measure))
            print(f"{peer.label}, f = {friction:g}: ready", file=sys.stderr)
    for i in range(rounds):
        for run, measure in measures:
            if i < FULL_ROUNDS or run.seconds < SLOW:
                run.times += measure()
        print(f"round {i + 1} of {rounds}", file=sys.stderr)
    return runs, notes


def cheapest(runs: list[Run], label: str, friction: float, target: float) -> Run | None:
    """Return the cheapest run that is accurate enough."""
    good = [
        r
        for r in runs
        if (r.label, r.friction) == (label, friction) and r.times and r.error <= target
    ]
    return min(good, key=lambda r: r.seconds, default=None)


def short(number: float) -> str:
    """Two digits, or all of a whole number."""
    return f"{number:.0f}" if number >= 10 else f"{number:.2g}"


def table(runs: list[Run], chosen: list[Peer], friction: float) -> str:
    """Markdown."""
    basis = chosen[0].label
    heads = [f"error <= {target:g} | ms | times {basis}" for target in TARGETS]
    lines = [
        f"| f = {friction:g} | switches, kinks | {' | '.join(heads)} |",
        "|---" * (2 + 3 * len(TARGETS)) + "|",
    ]
    for peer in chosen:
        cells = []
        for target in TARGETS:
            run = cheapest(runs, peer.label, friction, target)
            base = cheapest(runs, basis, friction, target)
            if run is None:
                cells += ["not reached", "-", "-"]
            else:
                ratio = short(run.seconds / base.seconds) if base else "-"
                cells += [f"{run.error:.1e}", short(1e3 * run.seconds), ratio]
        name = peer.label + (f" {peer.cases}, a case" if peer.cases > 1 else "")
        lines.append(f"| {name} | {peer.switches} | {' | '.join(cells)} |")
    return "\n".join(lines)


def machine(program: Path) -> str:
    """Processor and versions."""
    info = Path("/proc/cpuinfo")
    text = info.read_text(encoding="utf-8") if info.exists() else ""
    names = [line.partition(":")[2].strip() for line in text.splitlines() if "model name" in line]
    vectors = next((v for v in ("avx512f", "avx2") if v in text), "no AVX2")
    said = subprocess.run([program, "--version"], capture_output=True, text=True, check=True)
    versions = ", ".join(f"{package} {found(package)}" for package in PACKAGES)
    return (
        f"{names[0] if names else platform.machine()}, {os.cpu_count()} cores, {vectors}; "
        f"{said.stdout.splitlines()[0]}, Python {platform.python_version()}, {versions}"
    )


def found(package: str) -> str:
    """Version of an installed package."""
    try:
        return importlib.metadata.version(package)
    except importlib.metadata.PackageNotFoundError:
        return "not installed"


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    default = with_evolvent.ROOT / "build/release/evolvent"
    parser.add_argument("program", nargs="?", type=Path, default=default)
    parser.add_argument("--rounds", type=int, default=9, help="runs of which the median is taken")
    parser.add_argument("--only", default="", help="others to take, by names with commas between")
    parser.add_argument("--plot", type=Path, help="work-precision plot to write")
    parser.add_argument("--save", type=Path, help="JSON file for all runs")
    options = parser.parse_args()
    program = options.program.resolve()
    if not program.exists():
        parser.error(f"there is no program {program}: build it, or name another")
    names = [name for name in options.only.split(",") if name]
    if unknown := set(names) - {peer.name for peer in OTHERS}:
        parser.error(f"no such program: {', '.join(sorted(unknown))}")

    chosen = EVOLVENT + [peer for peer in OTHERS if not names or peer.name in names]
    with quiet():
        runs, notes = compare(program, options.rounds, chosen)
    print(machine(program), *notes, sep="\n\n")
    for friction in FRICTIONS:
        print(f"\n{table(runs, chosen, friction)}")
    for failure in sorted({(r.label, r.friction, r.failure) for r in runs if r.failure}):
        print("\n{} at f = {:g} failed: {}".format(*failure))
    if options.save:
        options.save.write_text(json.dumps([asdict(run) for run in runs]), encoding="utf-8")
    if options.plot:
        from work_precision import draw

        draw([run for run in runs if run.times], [peer.label for peer in chosen], options.plot)
    return 0


if __name__ == "__main__":
    sys.exit(main())
