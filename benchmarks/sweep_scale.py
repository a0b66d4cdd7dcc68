"""Plan, status and collect of a large sweep: time and memory, with journals that are made up.

    python benchmarks/sweep_scale.py [NUMBER OF CASES]       (200,000 unless given)

Nothing is integrated: the journals of four shards are written as `evolvent batch` would. Each step
runs in a process of its own, with a tenth of the cases first; processor time and the memory beyond
that of the imported package should grow with the cases, not faster. Exits with 1 if a step takes
longer than its limit.
"""

from __future__ import annotations

import argparse
import json
import multiprocessing
import resource
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
SHARDS = 4
EVENTS = 16
LONGEST = 10.0  # processor time of a step with 200,000 cases [s]
FULL = 200_000
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


def nothing(folder: Path) -> None:
    """Only the imports that the others need as well."""
    import evolvent.sweep.collect
    import evolvent.sweep.plan
    import evolvent.sweep.status  # noqa: F401


def write_journals(folder: Path) -> None:
    """Write journals as long as real ones; every hundredth case failed, some are missing."""
    from evolvent.sweep.folder import design_of

    design = design_of(folder / "d")
    results = ["transmission_error_mean", "normal_force_max", "penetration_max", "cpu_time"]
    results += [f"events_kind_{i}" for i in range(EVENTS)]
    scalars = [{"name": name, "units": "1", "long_name": name} for name in results]
    (folder / "d" / "design.txt").write_text(design.hash)
    for shard in range(1, SHARDS + 1):
        head = {"journal": 1, "design": design.hash, "shard": shard, "of": SHARDS}
        head |= {"n_cases": design.n_cases, "evolvent": design.version, "scalars": scalars}
        with (folder / "d" / f"shard-{shard}-of-{SHARDS}.jsonl").open("w") as journal:
            journal.write(json.dumps(head, separators=(",", ":")) + "\n")
            for case in range(shard - 1, design.n_cases, SHARDS):
                if case % 5003 == 7:
                    continue
                bad = case % 100 == 3
                row = {"case": case, "status": "failed" if bad else "done", "exit": 4 * bad}
                row["message"] = f"contact was lost at t = {case:g} s" if bad else ""
                row |= dict.fromkeys(results, None if bad else 1.0 / (case + 3.0))
                row["at"] = 1.7e9 + 0.01 * case
                journal.write(json.dumps(row, separators=(",", ":")) + "\n")


def measured(step: Callable[[Path], None], folder: Path) -> tuple[float, float]:
    """Processor time [s] and largest memory [MB] of a step in a process of its own."""
    context = multiprocessing.get_context("spawn")
    receiver, sender = context.Pipe(duplex=False)
    process = context.Process(target=_measure, args=(step, folder, sender))
    process.start()
    sender.close()
    seconds, memory = receiver.recv()
    process.join()
    return seconds, memory


def _measure(step: Callable[[Path], None], folder: Path, sender) -> None:
    nothing(folder)
    start = time.process_time()
    step(folder)
    seconds = time.process_time() - start
    sender.send((seconds, resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024))


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("cases", nargs="?", type=int, default=FULL)
    n = parser.parse_args().cases
    version = subprocess.run(
        [sys.executable, "--version"], capture_output=True, text=True, check=True
    )
    print(f"{version.stdout.strip()}, {SHARDS} shards, {EVENTS + 4} results a case\n")
    print(f"{'step':<8} {'cases':>8} {'CPU [s]':>9} {'memory [MB]':>12} {'bytes a case':>13}")
    slow = []
    for count in (n // 10, n):
        with tempfile.TemporaryDirectory() as name:
            folder = Path(name)
            (folder / "d").mkdir()
            case = ROOT / "examples" / "paper-friction.yaml"
            (folder / "sweep.yaml").write_text(PLAN.format(case=case, n=count))
            _, imported = measured(nothing, folder)
            for step in (plan, write_journals, status, collect):
                seconds, memory = measured(step, folder)
                if step is write_journals:
                    continue
                a_case = 1024**2 * (memory - imported) / count
                print(
                    f"{step.__name__:<8} {count:>8} {seconds:>9.2f} {memory:>12.0f} {a_case:>13.0f}"
                )
                if seconds > LONGEST * max(count / FULL, 0.1):
                    slow.append(step.__name__)
            size = sum(path.stat().st_size for path in folder.rglob("*.jsonl"))
            print(f"         journals: {size / 1e6:.0f} MB\n")
    if slow:
        print(f"too slow: {', '.join(slow)}")
    return 1 if slow else 0


if __name__ == "__main__":
    sys.exit(main())
