"""Overhead of the Python commands: their start, and the memory of long histories.

    python benchmarks/python_start.py [evolvent] [--outputs N]     (a million outputs unless given)

Processor time of `evolvent-post check` of a small history, and of the help of both programs, over
that of `python -c "import h5py"`: medians of ratios of alternating runs. Then the largest memory
of `check`, `plot` of each figure and `report`, of a history of a million outputs of a pair with
several tooth pairs in contact: it writes 1 GB to the temporary folder, and takes a minute or two.
The program is that of build/release unless given. Exits with 1 if a limit is exceeded.
"""

from __future__ import annotations

import argparse
import os
import statistics
import subprocess
import sys
import tempfile
from collections.abc import Sequence
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
RUNS = 21
DURATION = 0.5  # of the long history [s]
MEMORY = 250.0  # [MB]
FIGURES = ("penetration", "transmission_error", "normal_force", "speeds", "pairs", "path")
STARTS = {  # words, and the limit over `import h5py`
    "evolvent-post check": (("post", "check", "short.h5"), 2.0),
    "evolvent-post --help": (("post", "--help"), 0.6),
    "evolvent-sweep --help": (("sweep", "--help"), 0.6),
}


def cost(folder: Path, words: Sequence[str]) -> tuple[float, float]:
    """Measure processor time [s] and largest memory [MB] of a separate Python process."""
    process = subprocess.Popen(
        [sys.executable, *words],
        cwd=folder,
        env={**os.environ, "OPENBLAS_NUM_THREADS": "1", "MPLBACKEND": "Agg"},
        stdout=subprocess.DEVNULL,
        stderr=subprocess.PIPE,
    )
    assert process.stderr is not None
    said = process.stderr.read()
    _, code, used = os.wait4(process.pid, 0)
    if code != 0:
        sys.exit(f"{' '.join(words)}: {said.decode()}")
    return used.ru_utime + used.ru_stime, used.ru_maxrss / 1024


def called(program: str, *words: str) -> list[str]:
    """Return the code that starts a command, as its script does."""
    return ["-c", f"from evolvent.commands.{program}.app import main; main()", *words]


def run(program: Path, path: Path, outputs: int) -> None:
    """Write a history."""
    settings = (
        f"simulation.duration={DURATION}", f"simulation.output_interval={DURATION / outputs!r}"
    )  # fmt: skip
    case = ROOT / "examples" / "spur-pair.yaml"
    words = [word for setting in settings for word in ("--set", setting)]
    subprocess.run([program, "run", case, "-o", path, "-q", *words], check=True)


def starts(folder: Path) -> bool:
    """Compare starts; return whether all are within their limits."""
    ratios: dict[str, list[float]] = {name: [] for name in STARTS}
    for _ in range(RUNS):
        plain, _ = cost(folder, ["-c", "import h5py"])
        for name, (words, _) in STARTS.items():
            ratios[name].append(cost(folder, called(*words))[0] / plain)
    print(f"{'processor time over that of import h5py':<44} {'ratio':>6} {'limit':>6}")
    good = True
    for name, (_, limit) in STARTS.items():
        found = statistics.median(ratios[name])
        print(f"{name:<44} {found:>6.2f} {limit:>6.2f}")
        good &= found <= limit
    return good


def long_history(folder: Path) -> bool:
    """Use a long history; return whether all commands are within the memory limit."""
    commands = [["check", "long.h5"]]
    commands += [["plot", "long.h5", "--whole", "--quantity", name] for name in FIGURES]
    commands += [["plot", "long.h5", "--whole"], ["report", "long.h5"]]
    commands += [["report", "long.h5", "--interactive"]]
    print(f"\n{'a long history':<44} {'CPU [s]':>8} {'memory [MB]':>12}")
    good = True
    for words in commands:
        seconds, memory = cost(folder, called("post", *words))
        print(f"{'evolvent-post ' + ' '.join(words):<44} {seconds:>8.2f} {memory:>12.0f}")
        good &= memory <= MEMORY
    return good


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    usual = ROOT / "build" / "release" / "evolvent"
    parser.add_argument("program", nargs="?", type=Path, default=usual)
    parser.add_argument("--outputs", type=int, default=1_000_000)
    options = parser.parse_args()
    program = options.program.resolve()
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        run(program, folder / "short.h5", 1000)
        good = starts(folder)
        run(program, folder / "long.h5", options.outputs)
        good &= long_history(folder)
    if not good:
        print("a limit is exceeded")
    return 0 if good else 1


if __name__ == "__main__":
    sys.exit(main())
