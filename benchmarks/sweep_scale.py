"""Plan, status and collect of a large sweep: time and memory, with synthetic journals.

    python benchmarks/sweep_scale.py [NUMBER OF CASES]       (a million unless given)

No case is integrated: the journals of four shards are written as by `evolvent batch`. Each step
runs in a separate process, with a tenth of the cases first. Processor time is that of the step
with its imports, and separately that of the program `evolvent` which it calls: for `plan` the
program checks every case, most of the cost of a plan, which grows with the case; for `status` and
`collect` it reads the journals. Exits with 1 if a step exceeds its limit: for a million cases 2 s
for a plan without the program, 10 s for a status and 60 s to collect with it, and 1 GB.
"""

from __future__ import annotations

import argparse
import json
import multiprocessing
import resource
import subprocess
import sys
import tempfile
import zlib
from collections.abc import Callable
from pathlib import Path
from typing import Any, TextIO

ROOT = Path(__file__).resolve().parents[1]
SHARDS = 4
EVENTS = 16
FULL = 1_000_000
LONGEST = {"plan": 2.0, "status": 10.0, "collect": 60.0}  # processor time of all cases [s]
SETTLED = 1.0  # part independent of the size of a sweep: imports
LARGEST = 1024.0  # memory [MB]
PLAN = """
format: 1
case: {case}
method: latin_hypercube
samples: {n}
parameters:
- {{path: wheels.pinion.loads.0.value, name: load, units: N m, from: -1, to: -100, scale: log}}
- {{path: meshes.0.friction.coefficient, name: friction, from: 0, to: 0.3}}
- {{path: wheels.gear.support.stiffness, name: stiffness, units: N/m, from: 1e8, to: 1e9}}
- {{name: power, units: W, expression: load**2/10}}
"""


def plan(folder: Path) -> None:
    from evolvent.sweep.design import write_design
    from evolvent.sweep.plan import make_plan
    from evolvent.sweep.program import find_program

    design, _ = make_plan(folder / "sweep.yaml", find_program())
    write_design(design, folder / "d" / "design.h5")


def status(folder: Path) -> None:
    from evolvent.sweep.folder import design_of
    from evolvent.sweep.status import read_status

    read_status(folder / "d", design_of(folder / "d"))


def collect(folder: Path) -> None:
    from evolvent.sweep import collect as module
    from evolvent.sweep.folder import design_of

    module.collect(folder / "d", design_of(folder / "d"), folder / "summary.h5")


def write_journals(folder: Path) -> None:
    """Write journals as long as real ones; every hundredth case failed, some are missing."""
    from evolvent.sweep.folder import design_of

    design = design_of(folder / "d")
    results = ["transmission_error_mean", "normal_force_max", "penetration_max", "cpu_time"]
    results += [f"events_kind_{i}" for i in range(EVENTS)]
    scalars = [{"name": name, "units": "1", "long_name": name} for name in results]
    (folder / "d" / "design.txt").write_text(design.hash)
    for shard in range(1, SHARDS + 1):
        head = {"journal": 2, "design": design.hash, "shard": shard, "of": SHARDS}
        head |= {"n_cases": design.n_cases, "evolvent": design.version, "scalars": scalars}
        with (folder / "d" / f"shard-{shard}-of-{SHARDS}.jsonl").open("w") as journal:
            begin = write_line(journal, head, 0)
            for case in range(shard - 1, design.n_cases, SHARDS):
                if case % 5003 == 7:
                    continue
                bad = case % 100 == 3
                row = {"case": case, "status": "failed" if bad else "done", "exit": 4 * bad}
                row["message"] = f"contact was lost at t = {case:g} s" if bad else ""
                row |= dict.fromkeys(results, None if bad else 1.0 / (case + 3.0))
                row["at"] = 1.7e9 + 0.01 * case
                write_line(journal, row, begin)


def write_line(journal: TextIO, row: dict[str, Any], head: int) -> int:
    """Write a line with its check, which continues from that of the head; return the check."""
    line = json.dumps(row, separators=(",", ":"))[:-1]
    check = zlib.crc32(line.encode(), head)
    journal.write(f'{line},"check":"{check:08x}"}}\n')
    return check


def measured(step: Callable[[Path], None], folder: Path) -> tuple[float, float, float]:
    """Measure a step in a separate process: its and the program's CPU time [s], memory [MB]."""
    context = multiprocessing.get_context("spawn")
    receiver, sender = context.Pipe(duplex=False)
    process = context.Process(target=_measure, args=(step, folder, sender))
    process.start()
    sender.close()
    found: tuple[float, float, float] = receiver.recv()
    process.join()
    return found


def _measure(step: Callable[[Path], None], folder: Path, sender) -> None:
    step(folder)
    own, asked = (resource.getrusage(w) for w in (resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN))
    memory = max(own.ru_maxrss, asked.ru_maxrss) / 1024
    sender.send((own.ru_utime + own.ru_stime, asked.ru_utime + asked.ru_stime, memory))


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("cases", nargs="?", type=int, default=FULL)
    n = parser.parse_args().cases
    version = subprocess.run(
        [sys.executable, "--version"], capture_output=True, text=True, check=True
    )
    print(f"{version.stdout.strip()}, {SHARDS} shards, {EVENTS + 4} results a case\n")
    print(f"{'step':<8} {'cases':>8} {'CPU [s]':>9} {'program [s]':>12} {'memory [MB]':>12}")
    slow = []
    for count in (n // 10, n):
        with tempfile.TemporaryDirectory() as temporary:
            folder = Path(temporary)
            (folder / "d").mkdir()
            case = ROOT / "examples" / "paper-friction.yaml"
            (folder / "sweep.yaml").write_text(PLAN.format(case=case, n=count))
            for step in (plan, write_journals, status, collect):
                own, asked, memory = measured(step, folder)
                if step is write_journals:
                    continue
                name = step.__name__
                print(f"{name:<8} {count:>8} {own:>9.2f} {asked:>12.2f} {memory:>12.0f}")
                counted = own if step is plan else own + asked
                longest = max(LONGEST[name] * count / FULL, SETTLED)
                if counted > longest or memory > LARGEST:
                    slow.append(f"{name} of {count} cases")
            size = sum(path.stat().st_size for path in folder.rglob("*.jsonl"))
            print(f"         journals: {size / 1e6:.0f} MB\n")
    if slow:
        print(f"beyond the limit: {', '.join(slow)}")
    return 1 if slow else 0


if __name__ == "__main__":
    sys.exit(main())
