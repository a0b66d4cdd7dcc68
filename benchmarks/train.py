"""Cost of a step, an output and the set-up in a train of 10 to 200 wheels: growth with its length.

Run it as ``python benchmarks/train.py [PROGRAM] [--integrator radau|ida] [--instructions]``; it
needs valgrind. Instructions are counted, which do not depend on other load: those of a
longer run less those of a shorter one, over the steps between them; of a run with many outputs less
one with few, over the outputs between them; the set-up is the cost of a run of one step. CPU times
are the fastest of alternating runs of both lengths. The exit code is 1 if a ratio in
instructions, or of CPU times, is above its limit.
"""

from __future__ import annotations

import argparse
import json
import os
import re
import subprocess
import sys
import tempfile
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from process import ROOT

NUMBERS = {"radau": (10, 20, 50, 100, 200), "ida": (10, 20, 50, 100)}
SPANS = {"radau": (1e-3, 3e-3), "ida": (2e-4, 6e-4)}  # [s] shorter and longer run
OUTPUTS = 200  # of the run with many
ONE_STEP = 1e-9  # [s]
TURNS = 7  # of CPU times
LIMITS = {"radau": 2.3, "ida": 2.5}  # of twice as many wheels: longest train over the previous


def row(n: int, duration: float, integrator: str = "radau", outputs: int = 1) -> dict[str, Any]:
    """Make a train of n wheels, each driving the next; friction, and every axle in bearings."""
    teeth = [20 + 3 * (i % 5) for i in range(n)]
    bearing = {"kind": "bearing", "stiffness": [2e8, 3e8], "damping": [2e3, 3e3], "mass": 1}
    wheels: list[dict[str, Any]] = [
        {
            **{"name": f"w{i}", "teeth": z, "pitch_radius": 0.0025 * z, "width": 0.02},
            **{"material": "steel", "support": bearing},
        }
        for i, z in enumerate(teeth)
    ]
    wheels[0] |= {"centre": [0, 0], "loads": [{"kind": "torque", "value": -20}]}
    wheels[-1]["loads"] = [{"kind": "viscous", "coefficient": 1}]
    friction = {"law": "coulomb", "coefficient": 0.05, "regularisation_velocity": 1e-3}
    meshes = [
        {
            **{"driving": f"w{i}", "driven": f"w{i + 1}", "pressure_angle": 20},
            "driving_rotation": ("clockwise", "counterclockwise")[i % 2],
            "centre_line_angle": 30 * (-1) ** i,
            "damping": {"law": "linear", "coefficient": 2e3},
            "friction": friction,
        }
        for i in range(n - 1)
    ]
    steel = {"youngs_modulus": 2e11, "poisson_ratio": 0.3, "density": 7800}
    return {
        **{"format": 1, "materials": {"steel": steel}, "wheels": wheels, "meshes": meshes},
        "simulation": {
            **{"duration": duration, "output_interval": duration / outputs, "tolerance": 1e-7},
            "integrator": integrator,
        },
    }


@dataclass
class Run:
    """A case and its working folder."""

    program: Path
    folder: Path

    def command(self, case: dict[str, Any]) -> list[str]:
        """Write the case; return the command of its run."""
        file = self.folder / "case.yaml"
        file.write_text(json.dumps(case))  # JSON is YAML
        return [str(self.program), "run", str(file), "-o", str(self.folder / "history.h5")]

    def instructions(self, case: dict[str, Any]) -> tuple[int, int]:
        """Count instructions and steps."""
        command = ["valgrind", "--tool=callgrind", f"--callgrind-out-file={self.folder / 'counts'}"]
        command += self.command(case)
        done = subprocess.run(command, check=True, capture_output=True, text=True)
        counted = re.search(r"Collected : (\d+)", done.stderr)
        steps = re.search(r"(\d+) steps?\b", done.stderr)
        if counted is None or steps is None:
            sys.exit(f"cannot be understood:\n{done.stderr}")
        return int(counted[1]), int(steps[1])

    def cpu(self, case: dict[str, Any]) -> float:
        """Measure the CPU time [s]."""
        child = subprocess.Popen(
            self.command(case), stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL
        )
        _, status, usage = os.wait4(child.pid, 0)
        child.returncode = os.waitstatus_to_exitcode(status)
        if child.returncode != 0:
            sys.exit(f"a run ended with {child.returncode}")
        return usage.ru_utime + usage.ru_stime


@dataclass
class Cost:
    """Cost of a train."""

    step: float  # instructions
    output: float
    set_up: float
    cpu: float  # of a step [s]; 0 if not measured
    steps: int


def cost(run: Run, n: int, integrator: str, *, timed: bool) -> Cost:
    """Measure a train of n wheels."""
    short, long = SPANS[integrator]
    cases = row(n, short, integrator), row(n, long, integrator)
    (few, few_steps), (many, many_steps) = (run.instructions(case) for case in cases)
    with_outputs, _ = run.instructions(row(n, short, integrator, OUTPUTS))
    set_up, _ = run.instructions(row(n, ONE_STEP, integrator))
    steps = many_steps - few_steps
    seconds = 0.0
    if timed:
        turns = [[run.cpu(case) for case in cases] for _ in range(TURNS)]
        seconds = (min(t[1] for t in turns) - min(t[0] for t in turns)) / steps
    return Cost((many - few) / steps, (with_outputs - few) / (OUTPUTS - 1), set_up, seconds, steps)


def judge(integrator: str, costs: dict[int, Cost]) -> bool:
    """Compare the longest train with the previous one; return whether a limit is exceeded."""
    before, last = (costs[n] for n in NUMBERS[integrator][-2:])
    limit, broken = LIMITS[integrator], False
    for name in ("step", "output", "set_up", "cpu"):
        if not getattr(before, name) > 0:
            continue
        ratio = getattr(last, name) / getattr(before, name)
        verdict = "" if ratio <= limit else "  above the limit"
        print(f"  {name.replace('_', '-'):7} {ratio:5.2f}, limit {limit}{verdict}")
        broken |= ratio > limit
    return broken


def main() -> int:
    """Print the tables."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument(
        "program", nargs="?", type=Path, default=ROOT / "build" / "release" / "evolvent"
    )
    parser.add_argument("--integrator", choices=NUMBERS, help="this one alone")
    parser.add_argument("--instructions", action="store_true", help="no CPU times")
    options = parser.parse_args()
    broken = False
    with tempfile.TemporaryDirectory() as name:
        run = Run(options.program, Path(name))
        for integrator, numbers in NUMBERS.items():
            if options.integrator not in (None, integrator):
                continue
            print(f"{integrator}: thousands of instructions, microseconds of CPU")
            print("wheels  states  steps     a step  an output     set-up  CPU a step")
            costs: dict[int, Cost] = {}
            for n in numbers:
                c = costs[n] = cost(run, n, integrator, timed=not options.instructions)
                print(
                    f"{n:6}  {6 * n + 2:6}  {c.steps:5}  {c.step / 1e3:9.0f}  {c.output / 1e3:9.0f}"
                    f"  {c.set_up / 1e3:9.0f}  {c.cpu * 1e6:10.0f}",
                    flush=True,
                )
            twice = " over ".join(str(n) for n in reversed(numbers[-2:]))
            print(f"{integrator}, {twice} wheels:")
            broken |= judge(integrator, costs)
    return int(broken)


if __name__ == "__main__":
    sys.exit(main())
