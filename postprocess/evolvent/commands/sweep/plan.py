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
        Path | None, option("-o --output DESIGN", "Design to write; if not given, SWEEP.h5.")
    ] = None,
    dry_run: Annotated[
        bool, option("--dry-run", "Show the cases and their expected run time, but write no file.")
    ] = False,
    keep_refused: Annotated[
        bool, option("--keep-refused", "Return exit code 0 even if cases would be refused.")
    ] = False,
) -> None:
    """Create a design (the table of all cases) from a plan.

    \b
    The command checks every case. Refused cases are listed. They remain in the design and appear in
    the results with their reasons. The exit code is then 1, or 3 if all cases are refused.
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
