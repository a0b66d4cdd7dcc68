"""Right or refused: judges wide gearboxes, each by runs that have to agree.

A seed's case is run by the integrator that the program chooses and, where that is radau, by IDA.
Promised are the exit code, one line that says why a case is refused or a run ended, and of a run
that comes to its end that its invariants hold and nothing pulls. Where both integrators disagree,
a hundredth of the tolerance has to bring them together, or a change in the tenth digit of loads and
gaps has to move the motion as far: then the case amplifies errors. Or IDA lags: radau gives the
same motion at a hundredth of its tolerance, and IDA comes to that only at a ten thousandth; where
the case amplifies errors that motion may have moved, too.

    python tests/system/right_or_refused.py RESULTS.jsonl --seeds 10000    # goes on where it ended
    python tests/system/right_or_refused.py RESULTS.jsonl --seed 17        # one, with its case
    python tests/system/right_or_refused.py RESULTS.jsonl                  # what came out
"""

from __future__ import annotations

import argparse
import json
import os
import re
import resource
import signal
import subprocess
import sys
import tempfile
from collections import Counter
from collections.abc import Callable
from concurrent.futures import ProcessPoolExecutor
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr

sys.path[:0] = [str(Path(__file__).resolve().parents[1])]

from evolvent import check_history  # noqa: E402
from system.refusals import OF_A_PAIR  # noqa: E402
from system.wide_gearboxes import OUTPUTS, Block, kind_of, wide_case  # noqa: E402

# CPU time limit of a run, twice the required time since machines differ; at a fraction of the
# tolerance.
SECONDS, TIGHT_SECONDS = 10, 40
DONE, REFUSED, ENDED = 0, 3, 4  # exit codes permitted here
# Of the range of the motion; half of the pairs of runs agree to 1e-8.
WITHIN = 1e-4
LAST_DIGITS = 1e-10  # perturbation of a case to detect amplification of errors
# Response to it above which a motion counts as chaotic, as in docs/guides/integrators.md; and the
# permitted ratio of the integrators' difference to it, whose errors are 1e-6 against 1e-10.
CHAOTIC, FARTHER = 1e-7, 1e4
SHARE = 0.1  # permitted fraction of an error that remains at a fraction of the tolerance
PARTS = (1e-2, 1e-4)  # these fractions: at the first one, an error may still depend on few events
LEAST_TOLERANCE = 1e-13  # of radau

# Permitted reasons to reject a valid case: the pair of gears, or an invalid start.
REFUSALS = (
    *OF_A_PAIR,
    *("there is no steady state", "is on a slope of its deviating flanks"),
    "has left the involute",  # gaps that are too wide
)
# Permitted reasons for the end of a run: a state outside the model.
ENDS = (
    *("fillet of the", "off its path of contact", "past both ends of its path of contact"),
    *("has left the involute", "lies inside its wheel's base circle", "of the Johnson force"),
    *("endless impacts", "do not end at this instant"),
    "no other pair on the path separated them",  # rigid flanks
    "the integrator cannot continue",  # IDA under loads beyond double precision
)


ENDED_IN_WORDS = ("refused", "ended")  # outcomes of `unfinished`

Wrong = list[tuple[str, float, float]]  # invariants, worst value, bound


@dataclass(frozen=True)
class Judged:
    """Verdict on a seed."""

    seed: int
    kind: str
    outcome: str
    words: str
    apart: float  # difference of both integrators, over the range of the motion
    cpu: float  # of all runs [s]

    @property
    def is_sound(self) -> bool:
        """Whether the outcome is permitted."""
        return self.outcome in SOUND


SOUND = (
    *("agree", "alone", "converges", "ida lags", "amplifies", "says so"),
    *("refused", "ended", "ida ended"),
)


@dataclass(frozen=True)
class Ran:
    """A run: exit code, messages, CPU time and history."""

    code: int
    words: str
    cpu: float
    history: xr.Dataset | None

    @property
    def last(self) -> str:
        lines = self.words.strip().splitlines()
        return lines[-1] if lines else ""


class Judge:
    """Judges seeds with a program, in its own folder."""

    def __init__(self, program: Path, folder: Path) -> None:
        self.program, self.folder = program, folder
        self.cpu = 0.0

    def __call__(self, seed: int) -> Judged:
        self.cpu = 0.0
        case = wide_case(self.program, seed)
        outcome, words, apart = self.judge(case)
        return Judged(seed, kind_of(seed), outcome, words, apart, round(self.cpu, 3))

    def judge(self, case: Block) -> tuple[str, str, float]:
        """Return outcome, message and difference of the integrators."""
        first = self.run(case)
        if first.code != DONE:
            return *unfinished(first), 0.0
        wrong = wrong_in(first)
        if wrong:
            return *self.weigh(case, first, wrong), 0.0
        if not is_radaus(case):
            return "alone", "", 0.0
        other = self.run(case, "simulation.integrator=ida")
        if other.code != DONE:
            outcome, words = unfinished(other)
            return f"ida {outcome}", words, 0.0
        wrong = wrong_in(other)
        if wrong:
            outcome, words = self.weigh(case, other, wrong, "simulation.integrator=ida")
            return outcome.replace("broken", "ida broken"), words, 0.0
        apart = distance(first, other)
        if apart <= WITHIN:
            return "agree", "", apart
        return *self.explain(case, first, apart), apart

    def weigh(self, case: Block, run: Ran, wrong: Wrong, *settings: str) -> tuple[str, str]:
        """Judge violated invariants: a run must report them, a smaller tolerance remove them."""
        words = "; ".join(f"{name} {worst:.3g}, bound {bound:.3g}" for name, worst, bound in wrong)
        assert run.history is not None
        said = run.history.attrs["invariants"]
        if not all(name in said for name, _, _ in wrong):
            return "broken", words
        for part in PARTS:
            tight = self.run(case, tightened(case, part), *settings, seconds=TIGHT_SECONDS)
            if tight.code != DONE:
                how, ends = unfinished(tight)
                outcome = "says so" if how in ENDED_IN_WORDS else how
                return outcome, f"{words}; at {part:g} of the tolerance it ends with: {ends}"
            left = {name: worst for name, worst, _ in wrong_in(tight)}
            words += f"; at {part:g} of the tolerance {left}"
            if all(left.get(name, 0.0) <= SHARE * worst for name, worst, _ in wrong):
                return "says so", words
        return "broken", words

    def explain(self, case: Block, first: Ran, apart: float) -> tuple[str, str]:
        """Determine if errors are amplified, or a smaller tolerance removes the difference."""
        changed = self.run(in_last_digits(case))
        if changed.code != DONE and unfinished(changed)[0] not in ENDED_IN_WORDS:
            return unfinished(changed)
        moved = distance(first, changed) if changed.code == DONE else float("inf")
        words = f"{apart:.2g} apart, {LAST_DIGITS:g} moves it by {moved:.2g}"
        amplifies = moved >= CHAOTIC
        if amplifies and FARTHER * moved >= apart:
            return "amplifies", words
        for part in PARTS:
            tight = [
                self.run(case, tightened(case, part), *setting, seconds=TIGHT_SECONDS)
                for setting in ((), ("simulation.integrator=ida",))
            ]
            if any(run.code != DONE for run in tight):
                how, ends = unfinished(next(run for run in tight if run.code != DONE))
                outcome = "differ" if how in ENDED_IN_WORDS else how
                return outcome, f"{words}; at {part:g} of the tolerance: {ends}"
            closer, moved = distance(*tight), distance(first, tight[0])
            words += f"; at {part:g} of the tolerance {closer:.2g}, radau moved by {moved:.2g}"
            if part < PARTS[0] and moved > WITHIN and not amplifies:
                break
            if closer <= max(WITHIN, SHARE * apart):
                slowly = "amplifies" if amplifies else "ida lags"
                return "converges" if part == PARTS[0] else slowly, words
        return "differ", words

    def run(self, case: Block, *settings: str, seconds: int = SECONDS) -> Ran:
        """Run a case."""
        file, output = self.folder / "case.yaml", self.folder / "history.h5"
        file.write_text(json.dumps(case))
        output.unlink(missing_ok=True)
        options = [word for setting in settings for word in ("--set", setting)]
        before = resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime
        done = subprocess.run(
            ["prlimit", f"--cpu={seconds}", self.program, "run", file, "-o", output, *options],
            capture_output=True,
            text=True,
            check=False,
        )
        cpu = resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime - before
        self.cpu += cpu
        history = None
        if done.returncode == DONE:
            with xr.open_dataset(output, engine="netcdf4") as opened:
                history = opened.load()
        return Ran(done.returncode, done.stderr, cpu, history)


def unfinished(run: Ran) -> tuple[str, str]:
    """Outcome and message of a run that did not reach its end."""
    last = re.sub(r"^\S*case\.yaml", "case.yaml", run.last)
    last = re.sub(r"; the history up to there is in .*", "", last)
    if run.code in (-signal.SIGXCPU, -signal.SIGKILL):
        return "slow", last
    if run.code == REFUSED and any(words in last for words in REFUSALS):
        return "refused", last
    if run.code == ENDED and any(words in last for words in ENDS):
        return "ended", last
    return f"code {run.code}", last


def wrong_in(run: Ran) -> Wrong:
    """Violated invariants of a complete run: name, worst value, bound."""
    assert run.history is not None
    outputs = len(run.history["time"])
    if outputs != OUTPUTS + 1:
        return [("outputs", outputs, OUTPUTS + 1)]
    failed = [v for v in check_history(run.history) if v.failed]
    return [(v.invariant.name, v.worst or 0.0, v.bound) for v in failed]


def tightened(case: Block, part: float) -> str:
    """Setting for a fraction of a case's tolerance."""
    tolerance = part * case["simulation"].get("tolerance", 1e-9)
    return f"simulation.tolerance={max(tolerance, LEAST_TOLERANCE)}"


def is_radaus(case: Block) -> bool:
    """Whether radau supports the case."""
    closed = all(mesh.get("tracking") in (None, "closed_form") for mesh in case["meshes"])
    soft = all(mesh.get("contact", {}).get("law") != "rigid" for mesh in case["meshes"])
    return closed and soft and case.get("housing", {}).get("kind") != "mounted"


def distance(one: Ran, other: Ran) -> float:
    """Largest difference of speeds and transmission errors over the range of each."""
    worst = 0.0
    for name, dim in (("angular_velocity", "wheel"), ("transmission_error", "mesh")):
        a, b = (run.history[name].transpose("time", dim).values for run in (one, other))
        size = np.max(abs(a)) if name == "angular_velocity" else np.ptp(a, axis=0)
        floor = 1e-3 * one.history["reference_penetration"].values if dim == "mesh" else 1e-300
        worst = max(worst, float(np.max(abs(a - b) / np.maximum(size, floor))))
    return worst


def in_last_digits(case: Block) -> Block:
    """Return the case with perturbed gaps, and widths, which affect loads and contacts."""
    changed: Block = json.loads(json.dumps(case))
    for i, wheel in enumerate(changed["wheels"]):
        wheel["width"] *= 1 + LAST_DIGITS * (-1) ** i
        for load in wheel.get("loads", []):
            for key in ("value", "coefficient", "amplitude"):
                if key in load and load["kind"] != "speed":
                    load[key] *= 1 + LAST_DIGITS
    for name, gap in changed["simulation"].get("initial", {}).get("gaps", {}).items():
        changed["simulation"]["initial"]["gaps"][name] = gap * (1 + LAST_DIGITS)
    return changed


# The command.


def judged_here(seed: int) -> Judged:
    """Judge a seed with the program of the environment."""
    program = Path(os.environ["EVOLVENT_EXECUTABLE"])
    with tempfile.TemporaryDirectory() as folder:
        return Judge(program, Path(folder))(seed)


def read(results: Path) -> list[dict[str, Any]]:
    """Rows of a file of results, the last one of each seed."""
    lines = results.read_text().splitlines() if results.exists() else []
    rows = (json.loads(line) for line in lines)
    return list({row["seed"]: row for row in rows}.values())


def summary(rows: list[dict[str, Any]], say: Callable[[str], None]) -> None:
    """Report outcomes by kind, and those that are not permitted."""
    outcomes = Counter(row["outcome"] for row in rows)
    by_kind = Counter((row["kind"], row["outcome"]) for row in rows)
    say("| kind | " + " | ".join(outcomes) + " |")
    for kind in sorted({row["kind"] for row in rows}):
        say(f"| {kind} | " + " | ".join(str(by_kind[kind, o]) for o in outcomes) + " |")
    say("| all | " + " | ".join(str(outcomes[o]) for o in outcomes) + " |")
    for row in rows:
        if row["outcome"] not in SOUND:
            say(f"{row['seed']} {row['kind']}: {row['outcome']}: {row['words']}")


def main() -> None:
    """Run the seeds without results, two at a time, and report the outcomes."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("results", type=Path)
    parser.add_argument("--seeds", type=int, default=0, help="up to, without this one")
    parser.add_argument("--first", type=int, default=0, help="of them")
    parser.add_argument("--seed", type=int, help="this one, with its case on stdout")
    parser.add_argument("--again", action="store_true", help="those too that were not as promised")
    parser.add_argument("--jobs", type=int, default=2)
    given = parser.parse_args()
    if given.seed is not None:
        print(json.dumps(wide_case(Path(os.environ["EVOLVENT_EXECUTABLE"]), given.seed)))
        print(judged_here(given.seed), file=sys.stderr)
        return
    done = read(given.results)
    known = {row["seed"] for row in done if row["outcome"] in SOUND or not given.again}
    left = [seed for seed in range(given.first, given.seeds) if seed not in known]
    with ProcessPoolExecutor(given.jobs) as pool, given.results.open("a") as file:
        for judged in pool.map(judged_here, left, chunksize=1):
            file.write(json.dumps(asdict(judged)) + "\n")
            file.flush()
    summary(read(given.results), print)


if __name__ == "__main__":
    main()
