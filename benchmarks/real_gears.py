"""Cost of radau and IDA for involute gears: a loaded pair, a rattling pair, a two-stage train.

Run it as ``python benchmarks/real_gears.py [PROGRAM]`` after a build. Three cases in closed form,
each by both integrators at a row of tolerances:

- *pair*: 49 and 69 teeth, contact ratio 1.75, both flanks followed, so four entries and exits
  of tooth pairs a pitch, under 50 N m at 1500 rpm, with friction;
- *rattle*: examples/rattle.yaml, which loses contact some hundred times;
- *train*: examples/two-stage-gears.yaml with bearings under the first pinion and the last gear: 20
  states.

CPU is `cpu_time` of `evolvent batch`, the processor time of the integration: with the quantities
that are derived at every output, and with one output only. No history is written. Both integrators
alternate; the smallest of several times counts. The error is the largest difference of a
penetration to that of radau at a tolerance of 1e-13, over the largest penetration, and the same for
the normal force, which jumps where a pair enters or leaves under load: an output there shows the
error of an event's time.

The ratio of both is taken at the default tolerance, and at the same accuracy: IDA at its cheapest
tolerance that is as accurate as radau's default. The exit code is 1 if radau is not 10 times
faster, with one output, in both.
"""

from __future__ import annotations

import argparse
import json
import subprocess
import sys
import tempfile
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import h5py
import xarray as xr
import yaml
from accuracy import force_error, penetration_error
from process import ROOT

DEFAULT = 1e-9
TOLERANCES = {"radau": (1e-7, 1e-8, DEFAULT), "ida": (1e-8, DEFAULT, 1e-10, 1e-11, 1e-12)}
REFERENCE = 1e-13  # 1e-4 times the default
FASTER = 10.0


@dataclass
class Measured:
    """Cost and errors of one integrator at one tolerance."""

    steps: int = 0
    events: int = 0
    cpu: list[float] = field(default_factory=list)  # with its outputs [s]
    bare: list[float] = field(default_factory=list)  # with one output [s]
    penetration: float = 0.0  # error
    force: float = 0.0  # error


def example(name: str) -> dict[str, Any]:
    """Read an example."""
    return yaml.safe_load((ROOT / "examples" / name).read_text(encoding="utf-8"))


def pair() -> dict[str, Any]:
    """Change examples/spur-pair.yaml to a contact ratio of 1.75."""
    case = example("spur-pair.yaml")
    for wheel, teeth in zip(case["wheels"], (49, 69), strict=True):
        wheel |= {"teeth": teeth, "profile_shift": 0, "thickness_allowance": 0}
    mesh = case["meshes"][0]
    del mesh["centre_distance"]
    mesh["backlash"] = 6e-5
    return case


def train() -> dict[str, Any]:
    """Add bearings to examples/two-stage-gears.yaml."""
    case = example("two-stage-gears.yaml")
    for wheel in case["wheels"]:
        if wheel["name"] in ("pinion-1", "gear-2"):
            bearing = {"kind": "bearing", "stiffness": [2e8, 3e8], "damping": [2e3, 3e3], "mass": 1}
            wheel["support"] = bearing
    return case


CASES = {"pair": pair, "rattle": lambda: example("rattle.yaml"), "train": train}


def run(program: Path, case: dict[str, Any], folder: Path) -> xr.Dataset:
    """Run a case for its history."""
    file, output = folder / "case.yaml", folder / "history.h5"
    file.write_text(json.dumps(case), encoding="utf-8")  # JSON is YAML
    command = [str(program), "run", str(file), "-o", str(output)]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    if done.returncode != 0:
        sys.exit(f"{' '.join(command)} ended with {done.returncode}: {done.stderr}")
    with xr.open_dataset(output, engine="netcdf4") as history:
        return history.load()


def seconds(program: Path, case: dict[str, Any], folder: Path) -> float:
    """Measure the processor time of the integration alone [s]."""
    version = subprocess.run([program, "--version"], capture_output=True, text=True, check=True)
    with h5py.File(folder / "design.h5", "w") as design:
        design.attrs.update(
            evolvent_design_format=1,
            evolvent_version=version.stdout.split()[1],
            title="benchmark",
            case=json.dumps(case),
            hash="0" * 64,
            window=[0, case["simulation"]["duration"]],
            history_variables="",
            history_every=1,
            n_cases=1,
        )
        tolerance = case["simulation"]["tolerance"]  # a design needs a varied parameter
        column = design.create_dataset("parameters/p0", data=[tolerance])
        column.attrs["path"] = "simulation.tolerance"
    with tempfile.TemporaryDirectory(dir=folder) as results:
        command = [str(program), "batch", str(folder / "design.h5"), "-o", f"{results}/r", "-q"]
        subprocess.run(command, check=True)
        journal = Path(results, "r", "shard-1-of-1.jsonl").read_text(encoding="utf-8")
    return float(json.loads(journal.splitlines()[1])["cpu_time"])


def with_settings(case: dict[str, Any], **settings: Any) -> dict[str, Any]:
    """Change the block simulation."""
    return case | {"simulation": case["simulation"] | settings}


def measure(
    program: Path, case: dict[str, Any], rounds: int, folder: Path
) -> dict[tuple[str, float], Measured]:
    """Run a case by both integrators at all tolerances, in alternation."""
    exact = with_settings(case, integrator="radau", tolerance=REFERENCE)
    reference = run(program, exact, folder)
    table = {(name, tol): Measured() for name, row in TOLERANCES.items() for tol in row}
    for (integrator, tolerance), measured in table.items():
        setting = with_settings(case, integrator=integrator, tolerance=tolerance)
        history = run(program, setting, folder)
        measured.steps = int(history.attrs["integrator_steps"])
        measured.events = int(history.attrs["integrator_events"])
        measured.penetration = penetration_error(history, reference)
        measured.force = force_error(history, reference)
    only_end = {"output_interval": case["simulation"]["duration"]}
    for _ in range(rounds):
        for (integrator, tolerance), measured in table.items():
            setting = with_settings(case, integrator=integrator, tolerance=tolerance)
            measured.cpu.append(seconds(program, setting, folder))
            measured.bare.append(seconds(program, with_settings(setting, **only_end), folder))
    return table


def same_accuracy(table: dict[tuple[str, float], Measured]) -> float | None:
    """Return the tolerance of IDA's cheapest run as accurate as radau by default, or None."""
    bound = table["radau", DEFAULT].penetration
    enough = [key for key, m in table.items() if key[0] == "ida" and m.penetration <= bound]
    return min(enough, key=lambda key: min(table[key].bare))[1] if enough else None


def print_table(name: str, table: dict[tuple[str, float], Measured]) -> None:
    """Print the measurements of a case."""
    columns = ("steps", "events", "CPU [ms]", "one output", "error of h", "of the force")
    print(f"{name:8} {'tolerance':>9} " + " ".join(f"{column:>12}" for column in columns))
    for (integrator, tolerance), m in table.items():
        print(
            f"{integrator:8} {tolerance:9.0e} {m.steps:12d} {m.events:12d} {1e3 * min(m.cpu):12.1f}"
            f" {1e3 * min(m.bare):12.1f} {m.penetration:12.1e} {m.force:12.1e}"
        )


def ratios(table: dict[tuple[str, float], Measured]) -> bool:
    """Print the speed ratios; return whether radau is fast enough."""
    radau, ida = table["radau", DEFAULT], table["ida", DEFAULT]
    slowest = min(ida.bare) / min(radau.bare)
    print(f"IDA over radau, both by default: {slowest:.1f}", end="")
    print(f" ({min(ida.cpu) / min(radau.cpu):.1f} with its outputs)")
    tolerance = same_accuracy(table)
    if tolerance is None:
        print("no run of IDA is as accurate as radau by default")
    else:
        accurate = table["ida", tolerance]
        same = min(accurate.bare) / min(radau.bare)
        print(f"at the same accuracy, IDA at {tolerance:.0e}: {same:.1f}", end="")
        print(f" ({min(accurate.cpu) / min(radau.cpu):.1f} with its outputs)")
        slowest = min(slowest, same)
    return slowest >= FASTER


def main() -> int:
    """Measure all cases and print the table."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    default = ROOT / "build" / "release" / "evolvent"
    parser.add_argument("program", nargs="?", type=Path, default=default)
    parser.add_argument("--rounds", type=int, default=5, help="of which the fastest counts")
    parser.add_argument("--only", choices=CASES, help="one case")
    options = parser.parse_args()
    program = options.program.resolve()
    enough = True
    with tempfile.TemporaryDirectory() as folder:
        for name in [options.only] if options.only else CASES:
            table = measure(program, CASES[name](), options.rounds, Path(folder))
            print_table(name, table)
            enough = ratios(table) and enough
            print()
    return 0 if enough else 1


if __name__ == "__main__":
    sys.exit(main())
