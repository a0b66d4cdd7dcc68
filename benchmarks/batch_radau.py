"""Cases per second of a sweep in closed form, the share of integration, the cost of outputs.

    python benchmarks/batch_radau.py [PROGRAM]       (build/release/evolvent unless given)

The paper's setup with friction by the integrator radau, 1 s of model time with an output each
millisecond; torque, friction and the stiffness of the slider vary. One worker, the processor time
of the parent included. Prints the processor time of a case with and without its integration, which
includes the values at each output. Both are processor time of one run: their ratio is the same on a
busy machine, within a few parts in a hundred.

Then the paper's cases of 5 s, without and with friction: the processor time of the integration with
1001 outputs over that with 11, medians of cases that alternate in one run. `--outputs` runs only
this part. Exits with 1 if a limit is exceeded.
"""

from __future__ import annotations

import argparse
import json
import statistics
import subprocess
import sys
import tempfile
from pathlib import Path

import numpy as np
from batch import ROOT, run, write_design
from sweep_design import write_design as write_columns

DURATION = 1.0  # [s]
SHARE = 0.9  # of the integrations, at least
# Friction and tolerance, for an error of 1e-6 of the penetration; 1001 outputs over 11, at most.
OUTPUTS = [(0.0, 2e-5, 1.2), (0.3, 1e-5, 1.15)]
PAIRS = 100  # of cases


def cost_of_outputs(program: Path, folder: Path, friction: float, tolerance: float) -> list[float]:
    """Return processor times of an integration of 5 s with 11 outputs, and with 1001 [s]."""
    version = subprocess.run([program, "--version"], capture_output=True, text=True, check=True)
    case = (ROOT / "examples/paper-friction.yaml").read_text()
    case = case.replace("tracking: differential", "tracking: closed_form")
    columns = {
        "simulation.output_interval": np.tile([0.5, 0.005], PAIRS),
        "simulation.tolerance": np.full(2 * PAIRS, tolerance),
        "meshes.0.friction.coefficient": np.full(2 * PAIRS, friction),
    }
    design = folder / f"outputs-{friction}.h5"
    write_columns(design, version.stdout.split()[1], case, columns)
    results = folder / f"outputs-{friction}"
    subprocess.run([program, "batch", design, "-o", results, "-q", "-j", "1"], check=True)
    lines = (results / "shard-1-of-1.jsonl").read_text().splitlines()[1:]
    rows = sorted(map(json.loads, lines), key=lambda row: row["case"])
    return [statistics.median(row["cpu_time"] for row in rows[first::2]) for first in (0, 1)]


def outputs_exceed(program: Path) -> bool:
    """Print the cost of outputs; return whether a limit is exceeded."""
    exceed = False
    for friction, tolerance, limit in OUTPUTS:
        with tempfile.TemporaryDirectory() as name:
            few, many = cost_of_outputs(program, Path(name), friction, tolerance)
        is_exceeded = many / few > limit
        exceed = exceed or is_exceeded
        print(
            f"f = {friction}: {1e6 * few:.0f} us with 11 outputs, {1e6 * many:.0f} us with 1001, "
            f"{1e9 * (many - few) / 990:.0f} ns an output; "
            f"ratio {many / few:.3f}, at most {limit}{'  EXCEEDED' if is_exceeded else ''}"
        )
    return exceed


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    default = ROOT / "build/release/evolvent"
    parser.add_argument("program", nargs="?", type=Path, default=default)
    parser.add_argument("--cases", type=int, default=10_000)
    parser.add_argument("--outputs", action="store_true", help="what outputs cost, alone")
    options = parser.parse_args()
    program = options.program.resolve()
    if options.outputs:
        return 1 if outputs_exceed(program) else 0
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        design = folder / "design.h5"
        write_design(design, program, options.cases, DURATION, "closed_form")
        cost = run(program, design, folder / "results", 1)
    share = cost.integrations / cost.cpu
    integration = 1e6 * cost.integrations / options.cases
    rest = 1e6 * (cost.cpu - cost.integrations) / options.cases
    is_exceeded = share < SHARE
    print(f"{options.cases} cases of {DURATION:g} s, one process")
    print(f"{options.cases / cost.cpu:.0f} cases a second of processor time")
    print(f"integration {integration:.0f} us a case, all the rest {rest:.0f} us")
    mark = "  EXCEEDED" if is_exceeded else ""
    print(f"share of the integrations {100 * share:.1f} %, at least {100 * SHARE:.0f} %{mark}")
    exceed = outputs_exceed(program)
    return 1 if is_exceeded or exceed else 0


if __name__ == "__main__":
    sys.exit(main())
