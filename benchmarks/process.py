"""Cost of whole runs of the paper's case: CPU time, steps and peak memory of the process.

Run it as ``python benchmarks/process.py [evolvent]`` after a build; the program is that of
build/release unless given. Each line is the median of several runs of 5 s of model time with an
output each millisecond. The budget, if there is one, is printed beside the measured value. Then

- `run` is compared with `show`, which also starts, reads the case and builds the gearbox, but
  does not integrate or write: both alternate, and the ratio of their CPU times counts;
- if valgrind is installed, the instructions of the run in closed form are counted;
- the peak memory of 500 s is compared with that of 5 s: it writes 320 MB to the temporary folder;
- steps and errors of radau by default are compared with those without a longest step and of steps
  of at most 20 ms (``--steps``: only these).

The exit code is 1 if a budget is exceeded.
"""

from __future__ import annotations

import argparse
import functools
import os
import re
import resource
import shutil
import statistics
import subprocess
import sys
import tempfile
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import xarray as xr
from accuracy import penetration_error

ROOT = Path(__file__).resolve().parents[1]
ONE_THREAD = {**os.environ, "OPENBLAS_NUM_THREADS": "1"}  # starting more takes up to 50 ms
MEMORY = 30.0  # budget of every run [MB]
# Case, contact, tracking, integrator, budget of CPU time [s] and of steps, which count in closed
# form only. Radau has no budget of its own: it has to stay within that of IDA.
BUDGETS = [
    ("paper.yaml", "johnson", "closed_form", "ida", 0.06, 15_000),
    ("paper.yaml", "johnson", "closed_form", "radau", 0.06, 15_000),
    ("paper.yaml", "johnson", "algebraic", "ida", 0.09, None),
    ("paper.yaml", "johnson", "differential", "ida", 0.09, None),
    ("paper-friction.yaml", "johnson", "closed_form", "ida", 0.12, 45_000),
    ("paper-friction.yaml", "johnson", "closed_form", "radau", 0.12, 45_000),
    ("paper-friction.yaml", "johnson", "algebraic", "ida", 0.18, None),
    ("paper-friction.yaml", "johnson", "differential", "ida", 0.18, None),
    ("paper-friction.yaml", "rigid", "closed_form", "ida", 0.06, None),
]
SETTINGS = {
    "johnson": [],
    "rigid": ["meshes.0.contact={law: rigid}", "meshes.0.damping={law: none}"],
}
LONG = "simulation.duration=500"
# Case, tolerance and duration of runs by radau whose steps are counted.
STEPPED = [
    ("paper.yaml", 2e-5, 5),
    ("paper.yaml", 1e-9, 5),
    ("paper-friction.yaml", 1e-5, 5),
    ("paper-friction.yaml", 1e-9, 5),
    ("paper.yaml", 2e-5, 500),
]
MORE_STEPS = 1.02  # of a run by default, over those without a longest step
MORE_ERROR = 1.25  # of its error, over that of a run in short steps, if above the tolerance
SHORT_STEP = 0.02  # [s]
MORE_MEMORY = 1.0  # of 500 s over 5 s, at most: page counts vary [MB]
PEAKS = [("closed_form", "radau"), ("closed_form", "ida"), ("differential", "ida")]
CLOSED_FORM = "meshes.0.tracking=closed_form"
RATIOS = [("closed form", [CLOSED_FORM], 2.0), ("as it is", [], 4.0)]  # CPU of run over show
INSTRUCTIONS = 45e6  # of the run in closed form


@dataclass(frozen=True)
class Cost:
    """Resources used by one run."""

    cpu: float  # user and system time of the process [s]
    steps: int


def set_options(settings: Sequence[str]) -> list[str]:
    """Return the settings as options of the program."""
    return [word for setting in settings for word in ("--set", setting)]


def usage_of(command: list[str]) -> tuple[resource.struct_rusage, str]:
    """Run a command; return its resource usage from the operating system and its output."""
    with tempfile.TemporaryFile("w+") as messages:
        process = subprocess.Popen(
            command, stdout=subprocess.DEVNULL, stderr=messages, env=ONE_THREAD
        )
        _, status, usage = os.wait4(process.pid, 0)
        process.returncode = os.waitstatus_to_exitcode(status)
        messages.seek(0)
        said = messages.read()
    if process.returncode != 0:
        sys.exit(f"{' '.join(command)} ended with {process.returncode}: {said}")
    return usage, said


def cost(program: Path, case: str, *settings: str) -> Cost:
    """Run the program once."""
    with tempfile.TemporaryDirectory() as folder:
        command = [str(program), "run", str(ROOT / "examples" / case), "-o", f"{folder}/x.h5"]
        usage, said = usage_of([*command, *set_options(settings)])
    summary = re.search(r"(\d+) steps", said)
    if summary is None:
        sys.exit(f"{' '.join(command)} told no steps: {said}")
    return Cost(usage.ru_utime + usage.ru_stime, int(summary[1]))


def run_beside_show(runs: int, program: Path, settings: Sequence[str]) -> tuple[float, float]:
    """Return medians of the CPU time of `run` and of `show`, alternating [s]."""
    show = [str(program), "show", str(ROOT / "examples/paper.yaml"), *set_options(settings)]
    times: tuple[list[float], list[float]] = ([], [])
    for _ in range(runs):
        times[0].append(cost(program, "paper.yaml", *settings).cpu)
        usage, _ = usage_of(show)
        times[1].append(usage.ru_utime + usage.ru_stime)
    return statistics.median(times[0]), statistics.median(times[1])


def instructions(program: Path) -> float | None:
    """Count the instructions of the run in closed form; None without valgrind."""
    valgrind = shutil.which("valgrind")
    if valgrind is None:
        return None
    with tempfile.TemporaryDirectory() as folder:
        counted = [valgrind, "--tool=callgrind", f"--callgrind-out-file={folder}/out"]
        run = [str(program), "run", "-q", str(ROOT / "examples/paper.yaml"), "-o", f"{folder}/x.h5"]
        _, said = usage_of([*counted, *run, *set_options([CLOSED_FORM])])
    found = re.search(r"Collected : (\d+)", said)
    return float(found[1]) if found else None


def peak_memory(program: Path, case: str, *settings: str) -> float:
    """Return the peak memory of a run [MB].

    That of its own address space, sampled until it ends: the usual value, reported to the
    parent, includes the memory of this Python, from which the program was started.
    """
    peak = 0
    with tempfile.TemporaryDirectory() as folder:
        run = [str(program), "run", "-q", str(ROOT / "examples" / case), "-o", f"{folder}/x.h5"]
        process = subprocess.Popen([*run, *set_options(settings)], env=ONE_THREAD)
        while process.poll() is None:
            try:
                status = Path(f"/proc/{process.pid}/status").read_text()
            except OSError:
                break
            found = re.search(r"VmHWM:\s+(\d+) kB", status)
            peak = max(peak, int(found[1]) if found else 0)
        if process.wait() != 0:
            sys.exit(f"{' '.join(run)} ended with {process.returncode}")
    return 1.024e-3 * peak


def median_cost(runs: int, program: Path, case: str, *settings: str) -> Cost:
    """Return the median of each cost."""
    costs = [cost(program, case, *settings) for _ in range(runs)]
    return Cost(
        statistics.median(c.cpu for c in costs),
        costs[0].steps,  # the same in every run
    )


def history(program: Path, case: str, *settings: str) -> xr.Dataset:
    """Run the program for its history."""
    with tempfile.TemporaryDirectory() as folder:
        command = [program, "run", ROOT / "examples" / case, "-o", f"{folder}/x.h5"]
        for setting in settings:
            command += ["--set", setting]
        subprocess.run(command, check=True, stderr=subprocess.DEVNULL)
        with xr.open_dataset(f"{folder}/x.h5", engine="netcdf4") as opened:
            return opened.load()


def step_lengths(program: Path) -> int:
    """Compare radau by default with other step lengths; return the number of exceeded limits."""
    exceeded = 0
    print(f"steps of radau by default over those without a longest step, <= {MORE_STEPS},")
    print(f"and its error over that of steps of at most {SHORT_STEP:g} s, <= {MORE_ERROR}")
    for case, tolerance, duration in STEPPED:
        made = functools.partial(
            history,
            *(program, case, "meshes.0.tracking=closed_form", f"simulation.duration={duration}"),
            f"simulation.output_interval={5e-3 * duration / 5}",
        )
        stated = f"simulation.tolerance={tolerance}"
        default, free = made(stated), made(stated, "simulation.max_step=1000")
        exact, short = (
            made("simulation.tolerance=1e-13"),
            made(stated, f"simulation.max_step={SHORT_STEP}"),
        )
        steps = [run.attrs["integrator_steps"] for run in (default, free, short)]
        errors = [penetration_error(run, exact) for run in (default, short)]
        over = steps[0] > MORE_STEPS * steps[1] or errors[0] > max(
            MORE_ERROR * errors[1], tolerance
        )
        exceeded += over
        row = f"{case:20} {tolerance:7.0e} {duration:4} s: {steps[0]} over {steps[1]} steps"
        row += f" ({steps[2]} short ones), errors {errors[0]:.2e} over {errors[1]:.2e}"
        print(f"{row}{'  EXCEEDED' if over else ''}")
    return exceeded


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    default = ROOT / "build/release/evolvent"
    parser.add_argument("program", nargs="?", type=Path, default=default)
    parser.add_argument("--runs", type=int, default=11, help="of which the median is taken")
    parser.add_argument("--steps", action="store_true", help="compare lengths of steps only")
    options = parser.parse_args()
    program = options.program.resolve()
    if options.steps:
        return 1 if step_lengths(program) else 0

    exceeded = 0
    print(f"5 s of model time, an output each millisecond; median of {options.runs} runs")
    head = f"{'case':20} {'contact':8} {'tracking':12} {'integrator':10}"
    print(f"{head} {'CPU [s]':>14} {'steps':>15} {'memory [MB]':>12}")
    for case, contact, kind, integrator, most_cpu, most_steps in BUDGETS:
        settings = [f"meshes.0.tracking={kind}", *SETTINGS[contact]]
        settings.append(f"simulation.integrator={integrator}")
        took = median_cost(options.runs, program, case, *settings)
        memory = peak_memory(program, case, *settings)
        over = took.cpu > most_cpu or memory > MEMORY
        over = over or (most_steps is not None and took.steps > most_steps)
        exceeded += over
        cpu = f"{took.cpu:.3f} <= {most_cpu:.2f}"
        steps = f"{took.steps}" + (f" <= {most_steps}" if most_steps else "")
        size = f"{memory:.1f} <= {MEMORY:.0f}"
        row = f"{case:20} {contact:8} {kind:12} {integrator:10} {cpu:>14} {steps:>15} {size:>12}"
        print(f"{row}{'  EXCEEDED' if over else ''}")

    print(f"CPU time of run over that of show, paper.yaml, median of {4 * options.runs} each")
    for name, settings, most in RATIOS:
        run, show = run_beside_show(4 * options.runs, program, settings)
        over = run > most * show
        exceeded += over
        pair = f"{1e3 * run:.1f} ms over {1e3 * show:.1f} ms: {run / show:.2f} <= {most:.0f}"
        print(f"{name:12} {pair}{'  EXCEEDED' if over else ''}")
    count = instructions(program)
    if count is None:
        print("instructions in closed form: not counted, valgrind is not there")
    else:
        over = count > INSTRUCTIONS
        exceeded += over
        pair = f"{1e-6 * count:.1f} <= {1e-6 * INSTRUCTIONS:.0f} million"
        print(f"instructions in closed form: {pair}{'  EXCEEDED' if over else ''}")

    print("peak memory of 500 s beside that of 5 s, an output each millisecond [MB]")
    for kind, integrator in PEAKS:
        settings = [f"meshes.0.tracking={kind}", f"simulation.integrator={integrator}"]
        short = max(peak_memory(program, "paper.yaml", *settings) for _ in range(3))
        long = peak_memory(program, "paper.yaml", *settings, LONG)
        over = long > short + MORE_MEMORY
        exceeded += over
        pair = f"{long:.1f} beside {short:.1f}"
        print(f"{kind:12} {integrator:8} {pair:>18}{'  EXCEEDED' if over else ''}")
    exceeded += step_lengths(program)
    return 1 if exceeded else 0


if __name__ == "__main__":
    sys.exit(main())
