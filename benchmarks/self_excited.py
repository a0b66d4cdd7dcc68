"""Gearboxes with falling friction: check that radau follows self-excited vibrations.

Run it as ``python benchmarks/self_excited.py [PROGRAM] [--count 200]`` after a build; 200 gearboxes
take some five minutes on two cores. They are those of tests/system/stribeck_gearboxes.py, judged as
tests/system/test_self_excited.py does with --long; here any number of them, with the results.

The exit code is 1 if a run fails, or if a statistic differs by more than 5 % and the run did not
report a self-excited vibration.
"""

from __future__ import annotations

import argparse
import sys
from collections import Counter
from concurrent.futures import ProcessPoolExecutor
from functools import partial
from pathlib import Path

from process import ROOT

sys.path.insert(0, str(ROOT / "tests"))
from system.self_excited import judge


def main() -> int:
    """Run them all."""
    parser = argparse.ArgumentParser(description=__doc__.split("\n", maxsplit=1)[0])
    default = ROOT / "build" / "release" / "evolvent"
    parser.add_argument("program", nargs="?", type=Path, default=default)
    parser.add_argument("--count", type=int, default=200)
    arguments = parser.parse_args()
    verdicts: Counter[str] = Counter()
    sound = True
    with ProcessPoolExecutor() as pool:
        results = pool.map(partial(judge, arguments.program), range(arguments.count))
        for seed, judged in enumerate(results):
            verdicts[f"{judged.verdict}, said" if judged.said else judged.verdict] += 1
            sound = sound and judged.is_sound
            if judged.verdict != "agrees" or judged.said:
                print(f"seed {seed}: {judged}", flush=True)
    print(", ".join(f"{count} {verdict}" for verdict, count in sorted(verdicts.items())))
    return 0 if sound else 1


if __name__ == "__main__":
    sys.exit(main())
