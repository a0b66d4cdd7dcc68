"""Cost of key figures of a sweep by orbits: `python benchmarks/orbits.py PROGRAM [CASE...]`.

For each case a sweep, up and down, and the stable orbits at the same 401 values: processor time of
both processes, medians of alternating runs, and the differences of key figures where the sweep's
motion is one of the orbits. Extremes of a sweep contain its remaining transient: a motion counts as
periodic when it repeats to about 1e-6.
The orbits also include unstable ones, folds and multipliers, which no sweep finds.

Cases: `backlash`, over the amplitude of its load, a curve with two folds; `resonance` and `mesh`,
rectangular mesh stiffness over a part and all of its speeds; in the last one orbits of 4 and more
pitches are omitted. Without a name: all.
"""

from __future__ import annotations

import resource
import subprocess
import sys
import tempfile
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr
import yaml

sys.path.insert(0, str(Path(__file__).parents[1] / "tests"))

from system.test_metrics import HALF_GAP, oscillator, rectangular
from system.test_respond import SPEED, UNIT

VALUES = 401
ALIKE = 1e-3  # relative: deviations of the transmission error this close belong to one motion
NEAR = 1e-5  # of key figures that count as equal
LONGEST = 2  # pitches
RUNS = 7  # of each, alternating
MOST = 600  # pitches that a motion is followed; with all of them it is still settling
COMPARED = ("transmission_error_standard_deviation", "dynamic_factor", "normal_force_max")

CASES: dict[str, tuple[dict[str, Any], str]] = {
    "backlash": (oscillator(0.8, HALF_GAP), "wheels.b.loads.0.amplitude=-20:-300"),
    "resonance": (
        rectangular(1.0, 1, 1, "radau"),
        f"{SPEED}={-1.0 * UNIT!r}:{-1.4 * UNIT!r}",
    ),
    "mesh": (
        rectangular(1.0, 1, 1, "radau"),
        f"{SPEED}={-0.4 * UNIT!r}:{-2.4 * UNIT!r}",
    ),
}


def run(program: str, folder: Path, over: str, *options: str) -> tuple[float, xr.Dataset]:
    """Return processor time [s] and result."""
    result = folder / "result.h5"
    before = resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime
    command = [program, "respond", folder / "case.yaml", "--over", over, "-q", "-o", result]
    subprocess.run([*command, *options], check=True)
    seconds = resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime - before
    with xr.open_dataset(result, engine="h5netcdf") as file:
        return seconds, file.load()


def compare(sweep: xr.Dataset, orbits: xr.Dataset) -> tuple[int, int, list[tuple[float, str]]]:
    """Count motions that repeat in time and those among the orbits; return their differences."""
    deviation = "transmission_error_standard_deviation"
    n, found, differences = 0, 0, []
    for direction in range(sweep.sizes["direction"]):
        for i in range(sweep.sizes["parameter"]):
            motion = sweep.isel(direction=direction, parameter=i)
            if not 0 < int(motion["period"]) <= LONGEST or int(motion["followed"]) >= MOST:
                continue
            n += 1
            there = np.flatnonzero(
                (orbits["orbit_value"].values == i)
                & (orbits["orbit_stable"].values == 1)
                & (orbits["orbit_period"].values == int(motion["period"]))
            )
            size = float(motion[deviation][0])
            near = [k for k in there if abs(float(orbits[deviation][k, 0]) / size - 1) < ALIKE]
            if not near:
                continue
            found += 1
            orbit = orbits.isel(point=near[0])
            for name in COMPARED:
                a, b = motion[name].values, orbit[name].values
                differences.append((float(np.max(np.abs(a / b - 1))), name))
    return n, found, differences


def measure(program: str, name: str, folder: Path) -> None:
    """Print the cost of one case both ways, and the differences of the key figures."""
    case, over = CASES[name]
    case["simulation"].pop("metrics", None)
    case["simulation"]["tolerance"] = 1e-9  # a sweep's motions repeat to a thousand times that
    (folder / "case.yaml").write_text(yaml.safe_dump(case))
    asked = ("--values", str(VALUES), "--longest", str(LONGEST))
    seconds = []
    for _ in range(RUNS):
        of_sweep, sweep = run(program, folder, f"{over}:{VALUES}", "--both")
        of_orbits, orbits = run(program, folder, over, "--method", "orbits", *asked)
        seconds.append((of_sweep, of_orbits))
    of_sweep, of_orbits = np.median(seconds, axis=0)
    n, found, differences = compare(sweep, orbits)
    differences.sort()
    largest = {name: max(d for d, of in differences if of == name) for name in COMPARED}
    n_at = int((orbits["orbit_value"].values >= 0).sum())
    print(f"{name}: sweep {of_sweep:.3g} s, {1e3 * of_sweep / sweep['period'].size:.3g} ms a value")
    ratios = [a / b for a, b in seconds]
    print(
        f"  orbits {of_orbits:.3g} s, {n_at} at values and {orbits.sizes['point'] - n_at} others: "
        f"{of_sweep / of_orbits:.1f} times cheaper ({min(ratios):.1f} to {max(ratios):.1f})"
    )
    print(f"  {found} of {n} motions are among them; largest differences:")
    print("  " + ", ".join(f"{name} {gap:.1e}" for name, gap in largest.items()))
    assert largest[COMPARED[0]] <= NEAR


def main(program: str, *names: str) -> None:
    """Measure and print."""
    with tempfile.TemporaryDirectory() as temporary:
        for name in names or CASES:
            measure(program, name, Path(temporary))


if __name__ == "__main__":
    main(*sys.argv[1:])
