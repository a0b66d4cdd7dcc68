"""From SWEEP.yaml to a design, with the program asked whether it takes the cases."""

from __future__ import annotations

import json
import subprocess
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from evolvent.sweep.design import LAST_HALF, Design
from evolvent.sweep.errors import SweepError
from evolvent.sweep.program import program_version
from evolvent.sweep.sampling import columns
from evolvent.sweep.spec import Spec, read_spec

MOST_TEXTS = 50  # different texts of one column that are tried


@dataclass(frozen=True)
class Refusal:
    """A case that the program does not take."""

    case: int
    message: str


def make_plan(path: Path, program: Path) -> tuple[Design, list[Refusal]]:
    """Make a design of SWEEP.yaml.

    The program is asked about the first case and, of each parameter, about the cases with its
    smallest and largest value, or each of its texts: paths that the case does not have and values
    out of range come to light before anything runs.

    Returns
    -------
    The design, and what the program said of the cases that it refuses.

    Raises
    ------
    SweepError
        A plan, table or window that cannot be used, or no case that the program takes.
    """
    spec = read_spec(path)
    parameters, n_cases, sampling = columns(spec)
    try:
        case = spec.case.read_text(encoding="utf-8")
    except (OSError, UnicodeDecodeError) as error:
        reason = getattr(error, "strerror", None) or "is not UTF-8 text"
        raise SweepError(f"{path}: case {spec.case}: cannot be read ({reason})") from error
    design = Design(
        title=spec.title,
        case=case,
        parameters=tuple(parameters),
        n_cases=n_cases,
        window=spec.window or LAST_HALF,
        history_variables=spec.history_variables,
        history_every=spec.history_every,
        plan=spec.text,
        method=spec.method,
        seed=spec.seed,
        version=program_version(program),
        sampling=sampling,
    )
    durations, refusals = _ask(program, spec.case, design)
    if not durations:
        raise SweepError(f"{path}: case {refusals[0].case}: {refusals[0].message}")
    _check_window(spec, durations)
    return design, refusals


def _ask(program: Path, case_file: Path, design: Design) -> tuple[list[float], list[Refusal]]:
    durations: list[float] = []
    refusals: list[Refusal] = []
    for case in _telling_cases(design):
        command = [str(program), "show", str(case_file), "--json"]
        for setting in design.settings(case):
            command += ["--set", setting]
        done = subprocess.run(command, capture_output=True, text=True, check=False)
        if done.returncode == 0:
            shown = json.loads(done.stdout)
            durations.append(float(shown["case"]["simulation"]["duration"]))
        else:
            refusals.append(Refusal(case, done.stderr.strip() or f"exit code {done.returncode}"))
    return durations, refusals


def _telling_cases(design: Design) -> list[int]:
    """The first case, and those with the extremes and the texts of each parameter."""
    cases = {0}
    for parameter in design.parameters:
        if not parameter.path:
            continue
        if parameter.is_text:
            first = np.unique(parameter.values.astype(str), return_index=True)[1]
            cases.update(int(case) for case in first[:MOST_TEXTS])
        else:
            cases.update((int(parameter.values.argmin()), int(parameter.values.argmax())))
    return sorted(cases)


def _check_window(spec: Spec, durations: list[float]) -> None:
    if spec.window is not None and spec.window[1] > min(durations):
        raise SweepError(
            f"{spec.source}: window.to: is {spec.window[1]:g} s, but a case ends at "
            f"{min(durations):g} s"
        )
