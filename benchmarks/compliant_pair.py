"""Cost of compliant teeth in a run: the same pair stiff and with compliance, by radau and IDA.

Run it as ``python benchmarks/compliant_pair.py [PROGRAM]`` after a build. The pair is
examples/spur-pair.yaml, 1 s at 1500 rpm and 50 N m with an output each millisecond: unchanged, and
with finite elements in both wheels, coupled teeth and corner contact of the tip edges.

CPU is that of the whole process, less that of the same process for a run of 1 ns, which excludes
its start and the elements. The runs alternate, and the smallest of several times counts. The
exit code is 1 if compliance takes more than 3 times as long by radau, or IDA less than 5 times as
long as radau with compliance.
"""

from __future__ import annotations

import argparse
import sys
from collections import defaultdict
from pathlib import Path

from process import ROOT, cost

MOST, LEAST = 3.0, 5.0
KINDS = {"stiff": [], "bending": [f"wheels.{i}.compliance={{}}" for i in (0, 1)]}
WHOLE = ["simulation.duration=1", "simulation.output_interval=1e-3"]
ALMOST_NO = ["simulation.duration=1e-9", "simulation.output_interval=1e-9"]


def main() -> int:
    """Measure and print."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("program", nargs="?", type=Path, default=ROOT / "build/release/evolvent")
    parser.add_argument("--rounds", type=int, default=5, help="of which the smallest time counts")
    options = parser.parse_args()
    program = options.program.resolve()

    run: defaultdict[tuple[str, str], list[float]] = defaultdict(list)
    start: defaultdict[tuple[str, str], list[float]] = defaultdict(list)
    steps: dict[tuple[str, str], int] = {}
    for _ in range(options.rounds):
        for kind, settings in KINDS.items():
            for integrator in ("radau", "ida"):
                key = kind, integrator
                closed = "meshes.0.tracking=closed_form"
                every = [*settings, closed, f"simulation.integrator={integrator}"]
                took = cost(program, "spur-pair.yaml", *every, *WHOLE)
                run[key].append(took.cpu)
                steps[key] = took.steps
                start[key].append(cost(program, "spur-pair.yaml", *every, *ALMOST_NO).cpu)
    least = {key: min(run[key]) - min(start[key]) for key in run}

    print(f"{'pair':8} {'integrator':10} {'steps':>8} {'CPU [s]':>8} {'before it [s]':>14}")
    for (kind, integrator), seconds in least.items():
        key = kind, integrator
        print(f"{kind:8} {integrator:10} {steps[key]:8} {seconds:8.3f} {min(start[key]):14.3f}")
    for integrator in ("radau", "ida"):
        ratio = least["bending", integrator] / least["stiff", integrator]
        print(f"bending over stiff by {integrator}: {ratio:.2f}")
    for kind in KINDS:
        print(f"ida over radau, {kind}: {least[kind, 'ida'] / least[kind, 'radau']:.2f}")
    dear = least["bending", "radau"] > MOST * least["stiff", "radau"]
    slow = least["bending", "ida"] < LEAST * least["bending", "radau"]
    return 1 if dear or slow else 0


if __name__ == "__main__":
    sys.exit(main())
