"""Convert SWEEP.yaml to a design whose cases are checked by the program."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path

import yaml

from evolvent.errors import SweepError
from evolvent.sweep.check import Checked, check_design
from evolvent.sweep.design import LAST_HALF, Design
from evolvent.sweep.program import program_version
from evolvent.sweep.sampling import columns
from evolvent.sweep.spec import read_spec, read_text

ACCURACY = "1.0e-06"  # default of a sweep, of the largest penetration
SAID_BY = ("simulation", "simulation.tolerance", "simulation.accuracy")  # paths of parameters


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


def with_accuracy(case: str, paths: Iterable[str | None]) -> str:
    """Insert the accuracy into the text of a case that has neither accuracy nor tolerance.

    The rest of the text is unchanged. An invalid text is returned as it is; the program rejects it.

    Parameters
    ----------
    case
        YAML, as the user wrote it.
    paths
        Of the parameters of the sweep: a parameter for accuracy or tolerance sets it for all cases.
    """
    if not set(SAID_BY).isdisjoint(paths):
        return case
    block = _simulation(case)
    if block is None or {key.value for key, _ in block.value} & {"tolerance", "accuracy"}:
        return case
    first = block.value[0][0].start_mark
    entry = f"accuracy: {ACCURACY}\n{' ' * first.column}"
    if block.flow_style:
        entry = f'"accuracy": {ACCURACY}, '  # JSON stays JSON
    return case[: first.index] + entry + case[first.index :]


def _simulation(case: str) -> yaml.MappingNode | None:
    """Return the block `simulation` with the locations of its keys; None if the text has none."""
    try:
        root = yaml.compose(case, Loader=yaml.SafeLoader)
    except yaml.YAMLError:
        return None
    for key, value in root.value if isinstance(root, yaml.MappingNode) else []:
        if key.value == "simulation" and isinstance(value, yaml.MappingNode) and value.value:
            return value
    return None
