"""Check specified accuracies, measure errors over tolerances, and the gain in sweeps.

    python benchmarks/stated_accuracy.py [PROGRAM]            (build/release/evolvent unless given)
    python benchmarks/stated_accuracy.py [PROGRAM] --measure  the errors at a row of tolerances
    python benchmarks/stated_accuracy.py [PROGRAM] --sweeps   the examples' sweeps

The error is the largest difference of a penetration at an output to that of radau at a tolerance of
1e-13, over the largest penetration of all meshes. The cases are examples in closed form, which both
integrators support. Prints the error over each accuracy; the exit code is 1 if a ratio is above
1, except for rattling gears with IDA.

Sweeps are planned as a user does, and again at a tolerance of 1e-9; every n-th of their cases runs
in both, alternating, in one process. Prints the processor time of the integrations with their
outputs over that at 1e-9, the smallest of some turns of each case, and the largest difference of a
result of the journal, over the largest value of that result in the sweep (a phase is weighted with
its amplitude: it is undefined at amplitude 0). The exit code is 1 if a difference is above its
limit, 1e-5 in the paper's gearbox, or the time above 0.55 there in closed form, with few events.
"""

from __future__ import annotations

import argparse
import dataclasses
import itertools
import json
import subprocess
import sys
import tempfile
from pathlib import Path
from typing import Any

import numpy as np
import yaml
from accuracy import penetration_error
from process import ROOT
from real_gears import run as run_case

from evolvent.sweep.design import Design, take, write_design
from evolvent.sweep.plan import ACCURACY, make_plan

ACCURACIES = (1e-4, 1e-5, 1e-6, 1e-7)
TOLERANCES = {
    "radau": (1e-3, 1e-4, 1e-5, 1e-6, 1e-7, 1e-8, 1e-9),
    "ida": (1e-5, 1e-6, 1e-7, 1e-8, 1e-9, 1e-10, 1e-11),
}
EXACT = {"tolerance": 1e-13, "integrator": "radau"}
# Cases with changes of their simulation block, which shorten the slow ones.
CASES: dict[str, tuple[str, dict[str, Any]]] = {
    "paper, f = 0": ("paper.yaml", {}),
    "paper, f = 0.3": ("paper-friction.yaml", {}),
    "paper, f = 0.3, 100 N m": ("paper-friction.yaml", {"duration": 1}),
    "pair of 23 and 41": ("pair-23-41.yaml", {"duration": 1}),
    "spur pair": ("spur-pair.yaml", {}),
    "tip relief": ("tip-relief.yaml", {}),
    "teeth that bend": ("tutorial-pair.yaml", {}),
    "motor": ("motor-driven.yaml", {}),
    "two stages": ("two-stage-gears.yaml", {"duration": 0.03}),
    "rattle": ("rattle.yaml", {}),
}
# Plans of the examples, in closed form or as they are: every n-th of their cases runs. Limits of
# time and differences; extremes of gears with a basic rack are known to 3e-5 at any tolerance.
SWEEPS = {
    "sweep-torque.yaml, closed form": (1, 0.55, 1e-5),
    "sweep-torque.yaml": (4, None, 1e-5),
    "sweep-speed.yaml": (23, None, 5e-5),
    "tutorial-sweep.yaml": (20, None, 5e-5),
}
TURNS = 3
OF_THE_RUN = ("steps", "cpu_time", "energy_residual", "check")  # no results of the case


def example(name: str) -> dict[str, Any]:
    """Make one of the cases."""
    file, changes = CASES[name]
    case = yaml.safe_load((ROOT / "examples" / file).read_text(encoding="utf-8"))
    case["simulation"] |= changes
    for mesh in case["meshes"]:
        mesh["tracking"] = "closed_form"
    if "100 N m" in name:
        case["wheels"][0]["loads"][0]["value"] = -100.0
    return case


def errors(program: Path, folder: Path, settings: list[dict[str, Any]]) -> dict[str, list[float]]:
    """Return the error of each case with each of some settings."""
    found = {}
    for name in CASES:
        case = example(name)

        def made(case: dict[str, Any], changes: dict[str, Any]) -> Any:
            simulation = case["simulation"] | changes
            return run_case(program, {**case, "simulation": simulation}, folder)

        exact = made(case, EXACT)
        found[name] = [penetration_error(made(case, changes), exact) for changes in settings]
    return found


def measure(program: Path, folder: Path) -> int:
    """Print the errors at the tolerances."""
    for integrator, tolerances in TOLERANCES.items():
        settings = [{"integrator": integrator, "tolerance": t} for t in tolerances]
        print(f"| {integrator} | " + " | ".join(f"{t:.0e}" for t in tolerances) + " |")
        for name, row in errors(program, folder, settings).items():
            print(f"| {name} | " + " | ".join(f"{error:.1e}" for error in row) + " |", flush=True)
    return 0


def check(program: Path, folder: Path) -> int:
    """Print error over accuracy; return the number of ratios above 1."""
    above = 0
    for integrator in TOLERANCES:
        settings = [{"integrator": integrator, "accuracy": a} for a in ACCURACIES]
        print(f"{integrator:30}" + "".join(f"{a:9.0e}" for a in ACCURACIES))
        for name, row in errors(program, folder, settings).items():
            shares = [error / a for error, a in zip(row, ACCURACIES, strict=True)]
            if (integrator, name) != ("ida", "rattle"):
                above += sum(share > 1 for share in shares)
            print(f"  {name:28}" + "".join(f"{share:9.2g}" for share in shares), flush=True)
    return 1 if above else 0


def records(program: Path, design: Design, folder: Path) -> list[dict[str, Any]]:
    """Run a design; return its records in the order of the cases."""
    write_design(design, folder / "design.h5")
    with tempfile.TemporaryDirectory(dir=folder) as results:
        command = [program, "batch", folder / "design.h5", "-o", f"{results}/r", "-j", "1", "-q"]
        subprocess.run(command, check=False)
        lines = (Path(results) / "r" / "shard-1-of-1.jsonl").read_text().splitlines()[1:]
    return sorted(map(json.loads, lines), key=lambda record: int(record["case"]))


def difference(records: list[dict[str, Any]], others: list[dict[str, Any]]) -> tuple[float, str]:
    """Return the largest difference of a result over its largest value, and the result's name."""
    worst = (0.0, "none")

    def column(some: list[dict[str, Any]], name: str) -> np.ndarray:
        return np.array([record[name] for record in some], dtype=float)

    for name, value in records[0].items():
        if value is None or name in ("case", "status", "exit", "message", "at", *OF_THE_RUN):
            continue
        a, b = column(records, name), column(others, name)
        apart, scale = np.abs(a - b), np.nanmax(np.abs(b), initial=0.0)
        if "_phase_" in name:
            amplitude = column(others, name.replace("_phase_", "_amplitude_"))
            apart, scale = amplitude * np.abs(np.sin((a - b) / 2)), np.nanmax(amplitude)
        if scale > 0:
            worst = max(worst, (float(np.nanmax(apart) / scale), name))
    return worst


def sweeps(program: Path, folder: Path) -> int:
    """Compare the examples' sweeps with those at a tolerance of 1e-9; 1 if a limit is exceeded."""
    exceeded = False
    for name, (every, limit, farthest) in SWEEPS.items():
        design, _ = make_plan(ROOT / "examples" / name.split(",")[0], program)
        design = take(design, range(0, design.n_cases, every))
        if "closed form" in name:
            text = design.case.replace("tracking: differential", "tracking: closed_form")
            design = dataclasses.replace(design, case=text)
        said = f"accuracy: {ACCURACY}"
        assert said in design.case
        old = dataclasses.replace(design, case=design.case.replace(said, "tolerance: 1.0e-09"))
        cpu = np.full((2, design.n_cases), np.inf)
        found: dict[int, list[dict[str, Any]]] = {}
        for _, (i, one) in itertools.product(range(TURNS), enumerate((design, old))):
            found[i] = records(program, one, folder)
            cpu[i] = np.minimum(cpu[i], [record["cpu_time"] for record in found[i]])
        apart, number = difference(found[0], found[1])
        steps = [sum(record["steps"] for record in found[i]) for i in (0, 1)]
        share = cpu[0].sum() / cpu[1].sum()
        over = apart > farthest or (limit is not None and share > limit)
        exceeded = exceeded or over
        print(f"{name}: {design.n_cases} cases, {steps[0] / steps[1]:.2f} of the steps,", end=" ")
        print(f"{share:.3f} of the time{'' if limit is None else f' <= {limit}'},", end=" ")
        print(f"differences {apart:.1e} ({number}){'  EXCEEDED' if over else ''}", flush=True)
    return 1 if exceeded else 0


def main() -> int:
    """Run the requested comparison."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    default = ROOT / "build" / "release" / "evolvent"
    parser.add_argument("program", nargs="?", type=Path, default=default)
    parser.add_argument("--measure", action="store_true", help="errors at a row of tolerances")
    parser.add_argument("--sweeps", action="store_true", help="what the examples' sweeps gain")
    options = parser.parse_args()
    program = options.program.resolve()
    with tempfile.TemporaryDirectory() as folder:
        part = measure if options.measure else sweeps if options.sweeps else check
        return part(program, Path(folder))


if __name__ == "__main__":
    sys.exit(main())
