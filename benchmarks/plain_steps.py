"""Speeds at which motions end in plain steps: `python benchmarks/plain_steps.py`.

The oscillator of docs/guides/response.md alone, from 2.4 down in steps of 0.005: over the position
in the pitch at which the speed changes, and over the number of pitches followed at each speed.
Twenty minutes.
"""

from __future__ import annotations

import copy
import random
import sys
from collections import Counter
from collections.abc import Iterable, Iterator
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parents[1] / "tests"))

from system.oscillator_alone import Oscillator, falls, steps

Line = tuple[float, float, float]
REFERENCE = ((0.83, 0.825, 1.0698), (0.44, 0.435, 0.5246))
FOURS = range(300, 601, 4)  # pitches
N_POSITIONS, TRIES, SMALL = 80, 1000, 1e-12


class Disturbed(Oscillator):
    """An oscillator with random changes of the last digits at each frequency."""

    def __init__(self, seed: int, size: float) -> None:
        super().__init__()
        self.draw, self.size = random.Random(seed), size

    def follow(
        self, values: Iterable[float], position: float, pitches: int = 0
    ) -> Iterator[tuple[float, float]]:
        """Continue from a disturbed state of the motion."""
        for omega in values:
            self.x += self.draw.uniform(-self.size, self.size)
            self.v += self.draw.uniform(-self.size, self.size)
            yield from super().follow([omega], position, pitches)


def both_ends(position: float, pitches: int, motion: Oscillator | None = None) -> tuple[Line, Line]:
    """Find the end of the motion of period 2, which ends above 0.7, and of its successor."""
    found = falls(steps(2.4, 0.4), position, pitches, motion)
    above, below = ([line for line in found if (line[1] > 0.7) == upper] for upper in (True, False))
    return above[-1], below[0]


def agrees(line: Line, expected: Line) -> bool:
    """Check for agreement in all digits that the other program printed."""
    return line[:2] == expected[:2] and round(line[2], 4) == expected[2]


def report(name: str, ends: list[tuple[Line, Line]]) -> None:
    """Print shares, and the speeds at which motions end."""
    expected = [tuple(map(agrees, pair, REFERENCE)) for pair in ends]
    first, second = (sum(of) for of in zip(*expected, strict=True))
    print(
        f"{name}: first line {first}, second {second}, "
        f"both {sum(map(all, expected))} of {len(ends)}"
    )
    for of in zip(*ends, strict=True):
        counts = Counter(line[:2] for line in of)
        print("  " + ", ".join(f"{a:g}-{b:g}: {n}" for (a, b), n in sorted(counts.items())[::-1]))
    sys.stdout.flush()


def one_step() -> None:
    """Step from 0.440 where the second pair comes, in both pitches of the period."""
    start = Disturbed(1, SMALL)
    falls(steps(0.8, 0.44), 0.0, 600, start)
    for pitch in range(2):
        counts: Counter[str] = Counter()
        for seed in range(TRIES):
            motion = copy.copy(start)
            motion.draw = random.Random(seed)
            ((_, deviation),) = motion.follow([0.435], 0.0, 400)
            counts[
                "0.5246" if deviation < 0.7 else "not periodic" if deviation < 2 else "goes on"
            ] += 1
        print(f"behind 0.440, pitch {pitch}, disturbed by {SMALL:g}: {dict(counts)}", flush=True)
        start.pitch(0.44, 0.0)


def main() -> None:
    """Count and print."""
    one_step()
    ends = [both_ends(0.0, n, Disturbed(n + twice, SMALL)) for n in FOURS for twice in range(2)]
    report(f"second pair comes, a multiple of four pitches, disturbed by {SMALL:g}", ends)
    report("the same, not disturbed", [both_ends(0.0, n) for n in FOURS[::4]])
    report("the same, one pitch more", [both_ends(0.0, n + 1) for n in FOURS[::4]])
    for n in (400, 0):
        ends = [both_ends(i / N_POSITIONS, n) for i in range(N_POSITIONS)]
        report(f"{N_POSITIONS} places, {f'{n} pitches' if n else 'until it repeats'}", ends)


if __name__ == "__main__":
    main()
