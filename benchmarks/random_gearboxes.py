"""Random gearboxes: failed runs, errors, energy balance.

Run it as ``python benchmarks/random_gearboxes.py [PROGRAM]`` after a build; 300 gearboxes take some
two minutes on two cores. The gearboxes are those of tests/system/random_gearboxes.py: half of them
are designed to lose contact. Each is run with radau at the default tolerance, and three times at a
10,000 times smaller one: as it is, and twice with every torque, damper and initial gap changed by
at most 1e-10 of itself. A fifth run is at the default tolerance with steps of at most a thousandth
of the duration.

- *error*: largest difference of a penetration, drive or coast flank, to that of the tight run, over
  the largest penetration of all meshes;
- *growth*: the same for the changed runs, over 1e-10. Where small changes grow more than 1000
  times, ten times the tolerance, the expected error of the integrator, becomes
  more than 1e-5: no error below that can be expected, and the gearbox counts as chaotic;
- *energy*: the balance of evolvent-post check, of the run at the default tolerance;
- *events*: kinds whose number in the default run differs from that in both the run in short steps
  and the tight one. A contact closer than the errors may occur in any of them.

The exit code is 1 if a run fails, if an energy balance is worse than 1e-6, if more than 1 % of
the gearboxes that are not chaotic have an error above 1e-5, or if one of these has missed an event.
"""

from __future__ import annotations

import argparse
import collections
import copy
import json
import random
import subprocess
import sys
import tempfile
from collections.abc import Iterable
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr
from accuracy import penetration_error
from process import ROOT

from evolvent import check_history

sys.path.insert(0, str(ROOT / "tests"))
from system.random_gearboxes import loses_contact, random_gearbox

TIGHT = "simulation.tolerance=1e-13"
RADAU = "simulation.integrator=radau"
SHORT_STEPS = 1e-3  # of the duration
CHANGE = 1e-10  # of loads and gaps, relative
CHAOS = 1e3  # growth of that change from which a gearbox is chaotic
LARGEST_ERROR, LARGEST_ENERGY = 1e-5, 1e-6
SHARE = 0.99  # of gearboxes that are not chaotic that have to reach the accuracy
QUANTILES = (0.5, 0.9, 0.99, 1.0)


@dataclass(frozen=True)
class Result:
    """Results of one gearbox."""

    seed: int
    failure: str  # message of the run that failed; "" if none did
    steps: int = 0
    openings: int = 0  # number of losses of contact
    error: float = 0.0
    growth: float = 0.0
    energy: float = 0.0
    missed: str = ""  # kinds of events whose number differs from the two other runs

    @property
    def chaotic(self) -> bool:
        """Whether no accuracy can be required."""
        return self.growth > CHAOS


class RunError(Exception):
    """A run failed; the message is that of the program."""


def changed(case: dict[str, Any], seed: int) -> dict[str, Any]:
    """Change every torque, damper and initial gap by a random part of CHANGE."""
    other = copy.deepcopy(case)
    part = random.Random(seed)

    def change(block: dict[str, Any], key: str) -> None:
        factor = 1 + CHANGE * part.choice((-1, 1))
        value = block[key]
        block[key] = [v * factor for v in value] if isinstance(value, list) else value * factor

    for wheel in other["wheels"]:
        for load in wheel.get("loads", []):
            for key in {"value", "coefficient", "torque"} & load.keys():
                if load["kind"] != "speed":
                    change(load, key)
    gaps = other["simulation"]["initial"].get("gaps", {})
    for mesh in gaps:
        change(gaps, mesh)
    return other


def run(
    program: Path, case: dict[str, Any], *settings: str
) -> tuple[xr.Dataset, collections.Counter[str]]:
    """Run a case; return its history, and the number of events of each kind."""
    with tempfile.TemporaryDirectory() as folder:
        file, output = Path(folder) / "case.yaml", Path(folder) / "history.h5"
        file.write_text(json.dumps(case), encoding="utf-8")  # JSON is YAML
        command = [str(program), "run", str(file), "-o", str(output)]
        command += [word for setting in settings for word in ("--set", setting)]
        done = subprocess.run(command, capture_output=True, text=True, check=False)
        if done.returncode != 0:
            raise RunError(f"exit code {done.returncode}: {done.stderr.strip()}")
        with (
            xr.open_dataset(output, engine="netcdf4") as history,
            xr.open_dataset(output, engine="netcdf4", group="events") as events,
        ):
            attributes = events["kind"].attrs
            meanings = attributes["flag_meanings"].split()
            names = dict(zip(attributes["flag_values"], meanings, strict=True))
            return history.load(), collections.Counter(names[k] for k in events["kind"].values)


def judge(program: Path, seed: int) -> Result:
    """Make the four runs of a seed."""
    case = random_gearbox(seed)
    try:
        default, events = run(program, case, RADAU)
        longest = SHORT_STEPS * case["simulation"]["duration"]
        _, short = run(program, case, RADAU, f"simulation.max_step={longest}")
        tight, exact = run(program, case, TIGHT)
        others = [run(program, changed(case, i), TIGHT)[0] for i in (1, 2)]
    except RunError as failure:
        return Result(seed, str(failure))
    return Result(
        **{"seed": seed, "failure": "", "openings": events["contact_opened"]},
        missed=", ".join(
            f"{kind} {events[kind]} times, not {exact[kind]}"
            for kind in sorted(events | short | exact)
            if short[kind] == exact[kind] != events[kind]
        ),
        steps=int(default.attrs["integrator_steps"]),
        error=penetration_error(default, tight),
        growth=max(penetration_error(other, tight) for other in others) / CHANGE,
        energy=worst_energy(default),
    )


def worst_energy(history: xr.Dataset) -> float:
    """Return the largest error of the energy balance over the energy input."""
    verdicts = {v.invariant.name: v for v in check_history(history)}
    return float(verdicts["energy balance"].worst or 0.0)


def quantiles(values: Iterable[float]) -> str:
    """Return the quantiles of a row of the table."""
    numbers = list(values)
    if not numbers:
        return "  ".join("      -" for _ in QUANTILES)
    return "  ".join(f"{np.quantile(numbers, q):7.1e}" for q in QUANTILES)


def print_group(name: str, group: list[Result]) -> None:
    """Print the distributions of a group of gearboxes."""
    calm = [r for r in group if not r.chaotic]
    opened = sum(r.openings > 0 for r in group)
    chaotic = len(group) - len(calm)
    print(f"{name}: {len(group)} gearboxes, {opened} lost contact, {chaotic} chaotic")
    print(f"  {'':30}" + "  ".join(f"{f'{q:.0%}':>7}" for q in QUANTILES))
    print(f"  {'steps':30}" + quantiles(r.steps for r in group))
    print(f"  {'losses of contact':30}" + quantiles(r.openings for r in group))
    print(f"  {'error of those without chaos':30}" + quantiles(r.error for r in calm))
    print(f"  {'growth of a change of 1e-10':30}" + quantiles(r.growth for r in group))
    print(f"  {'energy balance':30}" + quantiles(r.energy for r in group))


def main() -> int:
    """Run all seeds and print the results."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    default = ROOT / "build" / "release" / "evolvent"
    parser.add_argument("program", nargs="?", type=Path, default=default)
    parser.add_argument("--first", type=int, default=0, help="first seed")
    parser.add_argument("--number", type=int, default=300, help="number of seeds")
    parser.add_argument("--workers", type=int, default=2, help="runs at once")
    options = parser.parse_args()

    seeds = range(options.first, options.first + options.number)
    with ProcessPoolExecutor(options.workers) as pool:
        results = list(pool.map(partial(judge, options.program.resolve()), seeds, chunksize=4))
    good = [r for r in results if not r.failure]
    for name, losing in (("made to keep contact", False), ("made to lose contact", True)):
        print_group(name, [r for r in good if loses_contact(r.seed) == losing])

    calm = [r for r in good if not r.chaotic]
    accurate = sum(r.error <= LARGEST_ERROR for r in calm)
    leaking = [r for r in good if not r.energy <= LARGEST_ENERGY]
    missing = [r for r in calm if r.missed]
    failed = [r for r in results if r.failure]
    share = accurate / max(1, len(calm))
    print(f"error <= {LARGEST_ERROR:.0e}: {accurate} of {len(calm)} without chaos ({share:.1%})")
    for result in calm:
        if result.error > LARGEST_ERROR:
            print(f"  seed {result.seed}: error {result.error:.1e}, growth {result.growth:.0f}")
    print(f"energy balance > {LARGEST_ENERGY:.0e}: {len(leaking)}")
    for result in leaking:
        print(f"  seed {result.seed}: {result.energy:.1e}")
    print(f"events missed: {len(missing)} of {len(calm)} without chaos")
    for result in missing:
        print(f"  seed {result.seed}: {result.missed}")
    print(f"failed: {len(failed)}")
    for result in failed:
        print(f"  seed {result.seed}: {result.failure}")
    return 1 if failed or leaking or missing or share < SHARE else 0


if __name__ == "__main__":
    sys.exit(main())
