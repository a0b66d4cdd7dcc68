"""Cost of key figures over whole periods: `python benchmarks/case_metrics.py PROGRAM [CASE]`.

Processor time of a batch with all key figures over one with the usual list, in alternation; the
window is the last half of each case, the default.
"""

from __future__ import annotations

import json
import statistics
import subprocess
import sys
import tempfile
from pathlib import Path

import h5py
import numpy as np

CASES, ALTERNATIONS = 8, 15
ROOT = Path(__file__).parents[1]


def write_design(path: Path, case: str, version: str, numbers: str) -> None:
    """Write a design of equal cases."""
    with h5py.File(path, "w") as file:
        file.attrs.update(
            evolvent_design_format=1, evolvent_version=version, title="", case=case,
            hash=path.stem, window=[np.nan, np.nan], history_variables="", history_every=1,
            n_cases=CASES, numbers=numbers,
        )  # fmt: skip
        column = file.create_dataset("parameters/p0", data=np.full(CASES, 0.5))
        column.attrs["path"] = "simulation.duration"
        column = file.create_dataset("parameters/p1", data=np.full(CASES, 5e-4))
        column.attrs["path"] = "simulation.output_interval"


def cpu_time(program: str, design: Path, folder: Path) -> float:
    """Return the processor time of the integrations with all consumers of their steps [s]."""
    subprocess.run([program, "batch", design, "-o", folder, "-q"], check=True)
    lines = (folder / "shard-1-of-1.jsonl").read_text().splitlines()[1:]
    return sum(json.loads(line)["cpu_time"] for line in lines)


def main(program: str, case: Path) -> None:
    """Measure and print."""
    said = subprocess.run([program, "--version"], check=True, capture_output=True, text=True)
    with tempfile.TemporaryDirectory() as temporary:
        designs = []
        for name, numbers in (("usual", ""), ("all", "all")):
            designs.append(Path(temporary) / f"{name}.h5")
            write_design(designs[-1], case.read_text(), said.stdout.split()[1], numbers)
        times: list[list[float]] = [[], []]
        for i in range(ALTERNATIONS):
            for design, of in zip(designs, times, strict=True):
                of.append(cpu_time(program, design, Path(temporary) / f"{design.stem}-{i}"))
    usual, every = (statistics.median(of) for of in times)
    print(f"{case.stem}: usual list {usual:.3f} s, all numbers {every:.3f} s: {every / usual:.3f}")


if __name__ == "__main__":
    main(sys.argv[1], Path(sys.argv[2]) if len(sys.argv) > 2 else ROOT / "examples/spur-pair.yaml")
