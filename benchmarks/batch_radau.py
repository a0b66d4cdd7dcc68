"""Cases per second of a sweep in closed form, and what share of it is integration.

    python benchmarks/batch_radau.py [PROGRAM]       (build/release/evolvent unless given)

The paper's setup with friction by the integrator radau, 1 s of model time with an output each
millisecond; torque, friction and the stiffness of the slider vary. One worker, the processor time
of the parent included. Prints the processor time of a case with and without its integration, which
includes the values at each output. Both are processor time of one run: their ratio is the same on a
busy machine, within a few parts in a hundred. Exits with 1 if a limit is exceeded.
"""

from __future__ import annotations

import argparse
import sys
import tempfile
from pathlib import Path

from batch import ROOT, run, write_design

DURATION = 1.0  # [s]
SHARE = 0.9  # of the integrations, at least


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    default = ROOT / "build/release/evolvent"
    parser.add_argument("program", nargs="?", type=Path, default=default)
    parser.add_argument("--cases", type=int, default=10_000)
    options = parser.parse_args()
    program = options.program.resolve()
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
    return 1 if is_exceeded else 0


if __name__ == "__main__":
    sys.exit(main())
