"""Convert SWEEP.yaml to a design whose cases are checked by the program."""

from __future__ import annotations

from pathlib import Path

from evolvent.errors import SweepError
from evolvent.sweep.accuracy import with_accuracy
from evolvent.sweep.check import Checked, check_design
from evolvent.sweep.design import LAST_HALF, Design
from evolvent.sweep.program import program_version
from evolvent.sweep.sampling import columns
from evolvent.sweep.spec import read_spec, read_text


def make_plan(path: Path, program: Path) -> tuple[Design, Checked]:
    """Create a design from SWEEP.yaml.

    The program checks all cases: paths that the case does not have, values out of range and invalid
    initial states are found before anything runs.

    Returns
    -------
    The design, and the result of the check of its cases.

    Raises
    ------
    SweepError
        A plan, table or window that cannot be used, or no case that the program accepts.
    """
    spec = read_spec(path, program)
    parameters, n_cases, sampling = columns(spec, program)
    case = read_text(spec.case, f"{path}: case {spec.case}")
    design = Design(
        title=spec.title,
        # responses are those of `evolvent respond`, at the tolerance of the case
        case=case
        if spec.respond
        else with_accuracy(case, (parameter.path for parameter in parameters)),
        parameters=tuple(parameters),
        n_cases=n_cases,
        window=spec.window or LAST_HALF,
        metrics=spec.metrics,
        history_variables=spec.history_variables,
        history_every=spec.history_every,
        history_rows=spec.history_rows,
        plan=spec.text,
        method=spec.method,
        seed=spec.seed,
        version=program_version(program),
        sampling=sampling,
        respond=spec.respond,
    )
    checked = check_design(design, program, case_name=str(spec.case), name=str(path))
    if checked.refused == design.n_cases:
        most = checked.reasons[0]
        others = f"; {len(checked.reasons) - 1} other reasons" if len(checked.reasons) > 1 else ""
        raise SweepError(
            f"{path}: all {design.n_cases} cases would be refused; case {most.case}: "
            f"{most.example}{others}"
        )
    if design.window[1] > checked.shortest:
        raise SweepError(
            f"{path}: window.to: is {design.window[1]:g} s, but a case ends at "
            f"{checked.shortest:g} s"
        )
    return design, checked
