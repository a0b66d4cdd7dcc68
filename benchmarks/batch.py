"""Overhead of a sweep besides its integrations: cases of the paper's setup, 0.2 s each.

    python benchmarks/batch.py [PROGRAM]             (build/release/evolvent unless given)

Torque, friction and the stiffness of the slider vary. Prints three things: the processor time of
the whole batch over the sum of its integrations; the memory of a worker over its cases; how
busy two processes are, as sum of case CPU / (2 x wall), compared with one. Linux reports how long
the workers were ready but did not run. The part of that time not used by their own parent was taken
by other programs: "alone" is busy without it, for machines under other load. "idle" is the time in
which a worker neither ran nor was ready, waiting for its parent, the disk or a lock: other programs
do not affect it. Exits with 1 if a limit is exceeded.
"""

from __future__ import annotations

import argparse
import json
import os
import re
import statistics
import subprocess
import sys
import tempfile
import threading
import time
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
from sweep_design import write_design as write_columns

ROOT = Path(__file__).resolve().parents[1]
DURATION = 0.2  # [s]
OVERHEAD = 0.03  # of the sum of the integrations, at most
EFFICIENCY = 0.95  # of two processes, at least, without other load
IDLE = 0.03  # of the time of a worker, at most
MORE_CPU = 1.05  # CPU a case of two processes over that of one, at most
PAGE = os.sysconf("SC_PAGE_SIZE") / 1e6  # [MB]
GROWTH = 0.5  # of a worker's memory from its first cases to its last, at most [MB]


@dataclass(frozen=True)
class Cost:
    """Resources used by one batch."""

    wall: float  # [s]
    cpu: float  # of all its processes [s]
    integrations: float  # sum over the cases [s]
    memory: list[float]  # of a worker over time [MB]
    lost: float  # time that other programs took from the workers, summed over them [s]
    idle: float  # share of their time in which the workers could not run

    def busy(self, jobs: int, *, alone: bool) -> float:
        """Share of the wall time in which the workers integrate, corrected for other load."""
        return self.integrations / (jobs * self.wall - (self.lost if alone else 0.0))


def write_design(path: Path, program: Path, n: int, duration: float, tracking: str) -> None:
    """Write a design of n cases of the paper's setup, with a window over their second half."""
    version = subprocess.run([program, "--version"], capture_output=True, text=True, check=True)
    text = (ROOT / "examples/paper-friction.yaml").read_text()
    text = re.sub(r"tracking: \w+", f"tracking: {tracking}", text)
    case = re.sub(r"duration: [\d.]+", f"duration: {duration}", text)
    random = np.random.default_rng(1)
    columns = {
        "wheels.pinion.loads.0.value": -random.uniform(0.5, 2.0, n),
        "meshes.0.friction.coefficient": random.uniform(0.0, 0.3, n),
        "wheels.gear.support.stiffness": 10 ** random.uniform(8.0, 9.5, n),
    }
    write_columns(path, version.stdout.split()[1], case, columns, (duration / 2, duration))


def workers(parent: int) -> list[int]:
    """List the processes that the parent has forked."""
    found = []
    for entry in Path("/proc").glob("[0-9]*/stat"):
        try:
            if int(entry.read_text().rpartition(")")[2].split()[1]) == parent:
                found.append(int(entry.parent.name))
        except OSError:
            continue
    return sorted(found)


@dataclass
class ResourceMonitor:
    """Samples of the workers while they run."""

    memory: list[float] = field(default_factory=list)  # of the first one [MB]
    ran: dict[int, float] = field(default_factory=dict)  # of each [s]
    waited: dict[int, float] = field(default_factory=dict)  # ready to run [s]
    first: dict[int, tuple[float, float]] = field(default_factory=dict)  # first seen, used then
    last: dict[int, tuple[float, float]] = field(default_factory=dict)

    def look(self, parent: int) -> None:
        """Take a sample."""
        for i, pid in enumerate(workers(parent)):
            try:
                pages = int(Path(f"/proc/{pid}/statm").read_text().split()[1])
                times = Path(f"/proc/{pid}/schedstat").read_text().split()
            except OSError:
                continue
            self.ran[pid], self.waited[pid] = (1e-9 * float(spent) for spent in times[:2])
            self.last[pid] = (time.monotonic(), self.ran[pid] + self.waited[pid])
            self.first.setdefault(pid, self.last[pid])
            if i == 0 and pages > 0:
                self.memory.append(PAGE * pages)

    def idle(self) -> float:
        """Share of the time between first and last sample in which a worker could not run."""
        there = sum(self.last[pid][0] - self.first[pid][0] for pid in self.last)
        used = sum(self.last[pid][1] - self.first[pid][1] for pid in self.last)
        return 1.0 - used / there if there > 0.0 else 0.0


def monitor(parent: int, has_ended: threading.Event, seen: ResourceMonitor) -> None:
    """Sample the workers until the batch has ended."""
    while not has_ended.wait(0.1):
        seen.look(parent)


def run(program: Path, design: Path, folder: Path, jobs: int) -> Cost:
    """Run a design in a number of workers."""
    command = [str(program), "batch", str(design), "-o", str(folder), "-j", str(jobs), "-q"]
    seen = ResourceMonitor()
    start = time.monotonic()
    process = subprocess.Popen(command, env={**os.environ, "OPENBLAS_NUM_THREADS": "1"})
    has_ended = threading.Event()
    sampling = threading.Thread(target=monitor, args=(process.pid, has_ended, seen))
    sampling.start()
    _, status, usage = os.wait4(process.pid, 0)
    wall = time.monotonic() - start
    process.returncode = os.waitstatus_to_exitcode(status)
    has_ended.set()
    sampling.join()
    if process.returncode != 0:
        sys.exit(f"{' '.join(command)} ended with {process.returncode}")
    lines = (folder / "shard-1-of-1.jsonl").read_text().splitlines()[1:]
    integrations = sum(json.loads(line)["cpu_time"] for line in lines)
    cpu = usage.ru_utime + usage.ru_stime  # of a process and its reaped children
    by_parent = cpu - sum(seen.ran.values())  # it may have made the workers wait
    lost = max(sum(seen.waited.values()) - by_parent, 0.0)
    return Cost(wall, cpu, integrations, seen.memory, lost, seen.idle())


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    default = ROOT / "build/release/evolvent"
    parser.add_argument("program", nargs="?", type=Path, default=default)
    parser.add_argument("--cases", type=int, default=2000)
    options = parser.parse_args()
    program = options.program.resolve()
    exceeded = 0
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        write_design(folder / "design.h5", program, options.cases, DURATION, "differential")
        print(f"{options.cases} cases of {DURATION} s, {os.cpu_count()} cores")
        head = (
            "processes",
            "wall [s]",
            "CPU [s]",
            "integrations [s]",
            "overhead",
            "busy",
            "alone",
            "idle",
        )
        print("".join(f"{word:>18}" for word in head))
        costs = {}
        for jobs in (1, 2):
            cost = run(program, folder / "design.h5", folder / str(jobs), jobs)
            costs[jobs] = cost
            overhead = cost.cpu / cost.integrations - 1.0
            busy, alone = (cost.busy(jobs, alone=alone) for alone in (False, True))
            disturbed = cost.lost > 0.02 * jobs * cost.wall  # by other programs: busy is void
            over = overhead > OVERHEAD or cost.idle > IDLE
            over = over or (jobs == 2 and not disturbed and busy < EFFICIENCY)
            exceeded += over
            words = (f"{jobs}", f"{cost.wall:.1f}", f"{cost.cpu:.1f}", f"{cost.integrations:.1f}")
            shares = (f"{100 * share:.1f} %" for share in (overhead, busy, alone, cost.idle))
            line = "".join(f"{word:>18}" for word in (*words, *shares))
            print(f"{line}{'  EXCEEDED' if over else ''}")
        per_case = 1e3 * costs[1].integrations / options.cases
        print(f"a case takes {per_case:.1f} ms; limits: overhead {100 * OVERHEAD:.0f} %, ", end="")
        print(f"two processes busy {100 * EFFICIENCY:.0f} %, idle {100 * IDLE:.0f} %")
        more = costs[2].cpu / costs[1].cpu
        exceeded += more > MORE_CPU
        line = f"CPU a case of two processes over one: {more:.3f} <= {MORE_CPU}"
        print(f"{line}{'  EXCEEDED' if more > MORE_CPU else ''}")
        memory = costs[1].memory
        tenth = max(len(memory) // 10, 1)
        early = statistics.median(memory[tenth : 2 * tenth])
        late = statistics.median(memory[-tenth:])
        over = late > early + GROWTH
        exceeded += over
        line = f"memory of a worker: {early:.1f} MB in its second tenth, {late:.1f} MB in its last"
        print(f"{line}{'  EXCEEDED' if over else ''}")
    return 1 if exceeded else 0


if __name__ == "__main__":
    sys.exit(main())
