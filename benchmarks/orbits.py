"""What orbits cost beside a sweep: `python benchmarks/orbits.py PROGRAM`.

The oscillator with backlash of docs/orbits.md over the amplitude of its load, a curve with two
folds: processor time of a value of the sweep, up and down, and of an orbit of the branch. The
orbits include the unstable ones, the folds and the multipliers, which no sweep finds.
"""

from __future__ import annotations

import resource
import subprocess
import sys
import tempfile
from pathlib import Path

import xarray as xr
import yaml

sys.path.insert(0, str(Path(__file__).parents[1] / "tests"))

from system.test_numbers import HALF_GAP, oscillator

OVER = "wheels.b.loads.0.amplitude=-20:-300"


def run(program: str, folder: Path, over: str, *options: str) -> tuple[float, xr.Dataset]:
    """Processor time [s] and result."""
    result = folder / "result.h5"
    before = resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime
    command = [program, "respond", folder / "case.yaml", "--over", over, "-q", "-o", result]
    subprocess.run([*command, *options], check=True)
    seconds = resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime - before
    with xr.open_dataset(result, engine="h5netcdf") as file:
        return seconds, file.load()


def main(program: str) -> None:
    """Measure and print."""
    case = oscillator(0.8, HALF_GAP)
    del case["simulation"]["numbers"]
    with tempfile.TemporaryDirectory() as temporary:
        folder = Path(temporary)
        (folder / "case.yaml").write_text(yaml.safe_dump(case))
        of_sweep, sweep = run(program, folder, f"{OVER}:101", "--both")
        of_orbits, orbits = run(program, folder, OVER, "--method", "orbits")
    n_values, n_orbits = sweep["period"].size, orbits.sizes["point"]
    print(f"sweep: {n_values} values in {of_sweep:.3g} s, {1e3 * of_sweep / n_values:.3g} ms each")
    print(f"orbits: {n_orbits} in {of_orbits:.3g} s, {1e3 * of_orbits / n_orbits:.3g} ms each")
    folds = orbits["orbit_parameter"].values[orbits["orbit_kind"].values == 1]
    print(f"folds at {folds.tolist()}")
    print(f"jumps at {((sweep.jump_before + sweep.jump_after) / 2).values.tolist()}")


if __name__ == "__main__":
    main(*sys.argv[1:])
