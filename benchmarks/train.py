"""What a step costs in a row of 2 to 20 wheels: no more than the square of their number.

Run it as ``python benchmarks/train.py [PROGRAM]``; it needs valgrind. Instructions are counted, so
that a busy machine gives the same numbers: those of a longer run less those of a shorter one, over
the steps between them. The exit code is 1 if the cost grows faster than n squared.
"""

from __future__ import annotations

import argparse
import json
import math
import re
import subprocess
import sys
import tempfile
from pathlib import Path
from typing import Any

from process import ROOT

NUMBERS = (2, 5, 10, 20)
SHORT, LONG = 1e-3, 3e-3  # [s]
SLACK = 1.1  # for what is not proportional to a power, such as events


def row(n: int, duration: float) -> dict[str, Any]:
    """Row of n wheels, each of which turns the next one; friction, and every axle in bearings."""
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
        "simulation": {"duration": duration, "output_interval": duration, "tolerance": 1e-7},
    }


def instructions(program: Path, case: dict[str, Any], folder: Path) -> tuple[int, int]:
    """Instructions and steps of a run."""
    file = folder / "case.yaml"
    file.write_text(json.dumps(case))  # JSON is YAML
    command = ["valgrind", "--tool=callgrind", f"--callgrind-out-file={folder / 'counts'}"]
    command += [str(program), "run", str(file), "-o", str(folder / "history.h5")]
    done = subprocess.run(command, check=True, capture_output=True, text=True)
    counted = re.search(r"Collected : (\d+)", done.stderr)
    steps = re.search(r"(\d+) steps", done.stderr)
    if counted is None or steps is None:
        sys.exit(f"cannot be understood:\n{done.stderr}")
    return int(counted[1]), int(steps[1])


def main() -> int:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument(
        "program", nargs="?", type=Path, default=ROOT / "build" / "release" / "evolvent"
    )
    program = parser.parse_args().program
    costs: dict[int, float] = {}
    print("wheels  states      steps  instructions a step  growth (power of n)")
    with tempfile.TemporaryDirectory() as name:
        for n in NUMBERS:
            few, few_steps = instructions(program, row(n, SHORT), Path(name))
            many, many_steps = instructions(program, row(n, LONG), Path(name))
            costs[n] = (many - few) / (many_steps - few_steps)
            before = max((m for m in costs if m < n), default=None)
            growth = "-"
            if before is not None:
                power = math.log(costs[n] / costs[before]) / math.log(n / before)
                growth = f"{power:.2f}"
            steps = many_steps - few_steps
            print(f"{n:6}  {6 * n + 2:6}  {steps:9}  {costs[n]:19.0f}  {growth:>19}")
    first, last = NUMBERS[0], NUMBERS[-1]
    grows_too_fast = costs[last] / costs[first] > SLACK * (last / first) ** 2
    if grows_too_fast:
        print("a step costs more than the square of the number of wheels")
    return int(grows_too_fast)


if __name__ == "__main__":
    sys.exit(main())
