"""Gearboxes with falling friction: whether radau follows the vibrations that it feeds.

Run it as ``python benchmarks/self_excited.py [PROGRAM] [--count 200]`` after a build; 200 gearboxes
take some five minutes on two cores. They are those of tests/system/stribeck_gearboxes.py. Each is
run by radau by default, with steps of at most 1e-5 s, and once more with other small steps: where
those two do not agree, the motion is chaotic, and nothing can be asked of it.

What is compared are mean, standard deviation and 98 % range of the force of each mesh after the
first quarter of the run. The exit code is 1 if a run fails, or if a statistic differs by more than
5 % and the run did not say that a vibration feeds itself.
"""

from __future__ import annotations

import argparse
import json
import subprocess
import sys
import tempfile
from collections import Counter
from concurrent.futures import ProcessPoolExecutor
from functools import partial
from pathlib import Path
from typing import Any

import xarray as xr
from process import ROOT

sys.path.insert(0, str(ROOT / "tests"))
from system.self_excited import difference
from system.stribeck_gearboxes import stribeck_gearbox

LARGEST = 0.05  # difference of a statistic
SMALL_STEPS = ("simulation.max_step=1e-5", "simulation.max_step=8.3e-6")


def run(program: Path, case: Path, *settings: str) -> tuple[Any, str]:
    """Return history and messages; the history is None if the run failed."""
    output = case.with_suffix(".h5")
    options = [word for setting in settings for word in ("--set", setting)]
    done = subprocess.run(
        [program, "run", case, "-o", output, *options], capture_output=True, text=True, check=False
    )
    if done.returncode != 0:
        return None, done.stderr
    with xr.open_dataset(output, engine="netcdf4") as history:
        return history[["normal_force"]].load(), done.stderr


def judge(program: Path, seed: int) -> tuple[int, str, float, str]:
    """Return seed, verdict, difference and what the run said."""
    with tempfile.TemporaryDirectory() as folder:
        case = Path(folder) / "case.yaml"
        made = stribeck_gearbox(seed)
        made["simulation"]["integrator"] = "radau"
        case.write_text(json.dumps(made))
        history, messages = run(program, case)
        exact, other = (run(program, case, setting)[0] for setting in SMALL_STEPS)
    if any(what is None for what in (history, exact, other)):
        return seed, "failed", float("nan"), messages
    error = difference(history, exact)
    said = "feeds itself" in messages
    if error <= LARGEST:
        return seed, "agrees, said" if said else "agrees", error, messages
    if difference(other, exact) > LARGEST:
        return seed, "chaotic, said" if said else "chaotic", error, messages
    return seed, "differs, said" if said else "differs", error, messages


def main() -> int:
    """Run them all."""
    parser = argparse.ArgumentParser(description=__doc__.split("\n", maxsplit=1)[0])
    default = ROOT / "build" / "release" / "evolvent"
    parser.add_argument("program", nargs="?", type=Path, default=default)
    parser.add_argument("--count", type=int, default=200)
    arguments = parser.parse_args()
    verdicts: Counter[str] = Counter()
    with ProcessPoolExecutor() as pool:
        for result in pool.map(partial(judge, arguments.program), range(arguments.count)):
            seed, verdict, error, messages = result
            verdicts[verdict] += 1
            if verdict != "agrees":
                said = [line for line in messages.splitlines() if "feeds itself" in line]
                print(f"seed {seed}: {verdict}, {error:.2g}", *said[:1], flush=True)
    print(", ".join(f"{count} {verdict}" for verdict, count in sorted(verdicts.items())))
    return 1 if verdicts["failed"] or verdicts["differs"] else 0


if __name__ == "__main__":
    sys.exit(main())
