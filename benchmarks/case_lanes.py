"""Possible gain of eight cases in lanes: an iteration of Newton's method in two layouts.

    python benchmarks/case_lanes.py [-march=...]     (-march=native unless given; needs gfortran)

Compiles benchmarks/case_lanes.f90 with the kernel's sources and options, and checks that both
layouts give the same bits. Prints nanoseconds of processor time for an iteration of one case, the
shortest of many turns: with its stages in lanes, as in radau; with eight cases in lanes; and the
conversion from one layout to the other and back, since the model has the stages in lanes.
"""

from __future__ import annotations

import subprocess
import sys
import tempfile
from pathlib import Path

from batch import ROOT

SOURCES = [
    "numerics/kinds",
    "numerics/number_text",
    "numerics/status",
    "integrator/radau_coefficients",
    "integrator/stage_blocks",
    "integrator/sparse_lu",
    "integrator/block_inverse",
    "integrator/condensed_systems",
    "integrator/stage_transforms",
]
OPTIONS = (
    "-O3 -flto -std=f2018 -frecursive -fopenmp-simd -ffp-contract=off "
    "-ftree-slp-vectorize -fno-loop-unroll-and-jam -fno-trapping-math -fno-math-errno -nocpp -w"
)


def main() -> None:
    processor = sys.argv[1] if len(sys.argv) > 1 else "-march=native"
    sources = [ROOT / f"src/{name}.f90" for name in SOURCES]
    with tempfile.TemporaryDirectory() as folder:
        program = Path(folder) / "case_lanes"
        command = ["gfortran", processor, *OPTIONS.split(), f"-I{ROOT / 'src'}", "-o", program]
        subprocess.run(
            [*command, *sources, ROOT / "benchmarks/case_lanes.f90"],
            cwd=folder,
            check=True,
            stderr=subprocess.DEVNULL,
        )
        printed = subprocess.run([program], capture_output=True, text=True, check=True).stdout
    stages, cases, exchange = map(float, printed.split())
    print(f"stages in lanes {stages:.0f} ns, cases in lanes {cases:.0f} ns + {exchange:.0f} ns")
    print(f"ratio {(cases + exchange) / stages:.2f}")


if __name__ == "__main__":
    main()
