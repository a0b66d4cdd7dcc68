"""The command evolvent-sweep plan."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

from evolvent.commands.command_line import argument, option
from evolvent.commands.program import say
from evolvent.commands.sweep import console
from evolvent.errors import FAILED_CASES


def plan(
    sweep: Annotated[Path, argument("SWEEP", "Plan (.yaml).")],
    output: Annotated[
        Path | None, option("-o --output DESIGN", "Design; SWEEP.h5 if not given.")
    ] = None,
    dry_run: Annotated[
        bool, option("--dry-run", "Show the cases and how long they take; write nothing.")
    ] = False,
    keep_refused: Annotated[
        bool, option("--keep-refused", "Exit code 0 also if cases would be refused.")
    ] = False,
) -> None:
    """Make a design, the table of all cases, from a plan.

    \b
    The program is asked about every case. What it would refuse is told, stays in the design and
    becomes rows with their reason; the exit code is 1 then, and 3 if it would refuse all cases.
    Example:
      evolvent-sweep plan examples/sweep-torque.yaml --dry-run
      evolvent-sweep plan examples/sweep-torque.yaml -o torque.h5
    """  # noqa: D301 - \b keeps click from filling the lines
    from evolvent.sweep.design import write_design
    from evolvent.sweep.estimate import seconds_per_case
    from evolvent.sweep.plan import make_plan
    from evolvent.sweep.program import cores, find_program

    program = find_program()
    design, checked = make_plan(sweep, program)
    path = output if output is not None else Path(f"{sweep.stem}.h5")
    if dry_run:
        console.show_design(design)
        seconds, is_bound = seconds_per_case(design, program)
        console.show_estimate(design.n_cases, seconds, is_bound, cores())
    else:
        write_design(design, path)
        say(f"{path}: {design.n_cases} cases")
    if checked.refused:
        console.show_refusals(sweep, design, checked)
        raise SystemExit(0 if keep_refused else FAILED_CASES)
