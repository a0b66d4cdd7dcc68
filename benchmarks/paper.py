"""Reproduce the paper: its figures, its Table 1 and its conclusions, on a page with the values.

Run it as ``./reproduce-paper``, which builds first, or as ``python benchmarks/paper.py FOLDER``.
It runs examples/paper*.yaml with the program of build/release, or the one that is named. The four
runs of Table 1 alternate, so that other load of the machine affects all of them equally; CPU
times are medians. The exit code is 1 if an invariant or a conclusion does not hold.
"""

from __future__ import annotations

import argparse
import json
import os
import statistics
import subprocess
import sys
import tempfile
from collections import defaultdict
from pathlib import Path

from paper_page import RINGING, Costs, page
from paper_runs import (
    PaperRun,
    PaperRuns,
    claims,
    figure_discrepancy,
    figure_normal_force,
    figure_transmission_error,
)
from process import ROOT, cost

from evolvent import check_history, open_events, open_history
from evolvent.figures.style import save

CASES = {
    "compliant": "paper.yaml",
    "compliant_friction": "paper-friction.yaml",
    "rigid": "paper-rigid.yaml",
    "rigid_friction": "paper-rigid-friction.yaml",
}
FINE = "simulation.output_interval=5e-5"  # 17 outputs in a period of the contact vibration
CLOSED_FORM = "meshes.0.tracking=closed_form"
NO_OUTPUT = "simulation.output_interval=5"
NO_TIME = ("simulation.duration=1e-6", "simulation.output_interval=1e-6")


def paper_run(program: Path, case: str, folder: Path) -> PaperRun:
    """Make one run and load it into memory."""
    file = ROOT / "examples" / case
    output = folder / "history.h5"
    subprocess.run([program, "run", file, "-o", output, "--set", FINE], check=True)
    shown = subprocess.run([program, "show", file, "--json"], check=True, capture_output=True)
    resolved = json.loads(shown.stdout)
    with open_history(output) as history, open_events(output) as events:
        return PaperRun(history.load(), events.load(), resolved["case"])


def ringing_steps(program: Path, case: str, run: PaperRun) -> int:
    """Count steps within RINGING after the start and after each tooth switch."""

    def until(time: float) -> int:
        return cost(program, case, f"simulation.duration={time!r}").steps if time > 0 else 0

    begins = [0.0, *map(float, run.times("tooth_switch"))]
    return sum(until(begin + RINGING) - until(begin) for begin in begins)


def costs(program: Path, runs: PaperRuns, rounds: int) -> Costs:
    """Measure median CPU times of the four runs in differential tracking and of variants."""
    samples = defaultdict(list)
    for _ in range(rounds):
        for name, case in CASES.items():
            samples["differential", name].append(cost(program, case).cpu)
            closed = cost(program, case, CLOSED_FORM, "simulation.integrator=ida").cpu
            samples["closed_form", name].append(closed)
            if name.startswith("compliant"):
                radau = cost(program, case, CLOSED_FORM, "simulation.integrator=radau").cpu
                samples["radau", name].append(radau)
            samples["no_output", name].append(cost(program, case, NO_OUTPUT).cpu)
        samples["start", ""].append(cost(program, CASES["compliant"], *NO_TIME).cpu)
    medians = {key: statistics.median(values) for key, values in samples.items()}
    return Costs(
        **{
            kind: {name: medians[kind, name] for name in CASES if (kind, name) in medians}
            for kind in ("differential", "closed_form", "radau", "no_output")
        },
        start=medians["start", ""],
        ringing_steps={
            name: ringing_steps(program, CASES[name], run) for name, run in vars(runs).items()
        },
        rounds=rounds,
        processor=processor(),
    )


def processor() -> str:
    """Return the name of the processor, as reported by Linux."""
    try:
        lines = Path("/proc/cpuinfo").read_text(encoding="utf-8").splitlines()
    except OSError:
        lines = []
    names = [line.partition(":")[2].strip() for line in lines if line.startswith("model name")]
    return f"{names[0] if names else 'an unknown processor'}, {os.cpu_count()} cores"


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("folder", type=Path, help="where the page and its figures go")
    default = ROOT / "build/release/evolvent"
    parser.add_argument("program", nargs="?", type=Path, default=default)
    parser.add_argument("--rounds", type=int, default=15, help="of which the median is taken")
    options = parser.parse_args()
    program = options.program.resolve()
    options.folder.mkdir(parents=True, exist_ok=True)

    with tempfile.TemporaryDirectory() as folder:
        runs = PaperRuns(
            **{name: paper_run(program, case, Path(folder)) for name, case in CASES.items()}
        )
    measured = costs(program, runs, options.rounds)
    figures = {
        "figure-3.png": figure_discrepancy(runs.compliant_friction),
        "figure-4.png": figure_transmission_error(runs.compliant, runs.compliant_friction),
        "figure-5.png": figure_normal_force(runs.compliant_friction, runs.rigid_friction),
    }
    for name, figure in figures.items():
        save(figure, options.folder / name)
    conclusions = claims(runs)
    (options.folder / "README.md").write_text(page(runs, conclusions, measured), encoding="utf-8")

    failed = 0
    for name, run in vars(runs).items():
        for verdict in check_history(run.history):
            if verdict.failed:
                failed += 1
                print(f"DOES NOT HOLD: {CASES[name]}: {verdict.invariant.name}")
    for claim in conclusions:
        word = "holds" if claim.holds else "DOES NOT HOLD"
        failed += not claim.holds
        print(f"{word}: {claim.statement}: {claim.measured:.1e} <= {claim.bound:.0e}")
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
