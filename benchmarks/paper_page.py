"""The page about the reproduced paper: measured values beside those of the paper."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from jinja2 import Environment, FileSystemLoader, StrictUndefined
from paper_runs import (
    MEAN_FROM,
    SETTLING,
    Claim,
    PaperRun,
    PaperRuns,
    jump_errors,
    jump_size,
    mean_force,
)

# CPU time of 5 s of model time [s].   Source: Kosenko & Gusev 2011, Table 1.
PAPER_CPU = {"compliant_friction": 20.4, "compliant": 16.1, "rigid_friction": 13.0, "rigid": 11.4}
RINGING = 0.1  # assumed duration of contact vibration after the start and after a tooth switch [s]


@dataclass(frozen=True)
class Costs:
    """CPU times of whole processes [s], each the median of several, and steps; by run."""

    differential: Mapping[str, float]  # the examples unchanged: an output each millisecond
    closed_form: Mapping[str, float]  # the same in closed form tracking, also by IDA
    radau: Mapping[str, float]  # by the integrator radau, which supports compliant contacts only
    no_output: Mapping[str, float]  # differential, with the first and last output only
    start: float  # of a run over almost no time
    ringing_steps: Mapping[str, int]  # steps within RINGING after the start and each tooth switch
    rounds: int  # number of runs for each median
    processor: str


@dataclass(frozen=True)
class CostRow:
    """One line of Table 1."""

    contact: str
    friction: float
    paper: float
    differential: float
    closed_form: float
    radau: float | None  # of a compliant contact
    counts: Mapping[str, int]  # of the integrator, in differential tracking
    ringing_steps: int  # see `Costs`
    microseconds: float  # of a step: without start and output


@dataclass(frozen=True)
class JumpRow:
    """One jump of the transmission error."""

    what: str
    time: float  # of its start [s]
    lasting: float  # duration [s]
    change: float  # of the transmission error [m]
    penetration: float  # its part from the contact [m]
    error: float  # relative, from the closed form

    @property
    def axle_share(self) -> float:
        """Part of the change that is not penetration, and so is due to the axle."""
        return 1 - self.penetration / self.change


def page(runs: PaperRuns, claims: Sequence[Claim], costs: Costs) -> str:
    """Make the page, Markdown; its figures are in the same folder."""
    environment = Environment(
        loader=FileSystemLoader(Path(__file__).parent),
        trim_blocks=True,
        lstrip_blocks=True,
        keep_trailing_newline=True,
        undefined=StrictUndefined,
    )
    rows = {name: _cost_row(name, run, costs) for name, run in vars(runs).items()}
    friction = runs.compliant_friction
    return environment.get_template("paper.md.j2").render(
        claims=claims,
        rows=rows,
        mean_from=MEAN_FROM,
        settling=SETTLING,
        ringing=RINGING,
        interval=float(friction.history["time"][1]),
        ratios=[_ratios(rows, suffix) for suffix in ("_friction", "")],
        jumps=_jump_rows(friction),
        means={name: mean_force(run) for name, run in vars(runs).items()},
        costs=costs,
        wheel=friction.case["wheels"],
        mesh=friction.case["meshes"][0],
        simulation=friction.case["simulation"],
        density=next(iter(friction.case["materials"].values()))["density"],
        limit=float(runs.compliant.of_mesh("transmission_error")[-1]),
        depth=float(runs.compliant.of_mesh("penetration")[-1]),
        rigid_limit=float(runs.rigid.of_mesh("transmission_error")[-1]),
        versions=str(friction.history.attrs["versions"]).replace("\n", ", "),
    )


def _cost_row(name: str, run: PaperRun, costs: Costs) -> CostRow:
    counts = {
        count: int(run.history.attrs[f"integrator_{count}"])
        for count in ("steps", "newton_iterations", "jacobians")
    }
    return CostRow(
        "rigid" if run.rigid else "compliant",
        run.friction,
        PAPER_CPU[name],
        costs.differential[name],
        costs.closed_form[name],
        costs.radau.get(name),
        counts,
        costs.ringing_steps[name],
        (costs.no_output[name] - costs.start) / counts["steps"] * 1e6,
    )


def _ratios(rows: Mapping[str, CostRow], suffix: str) -> dict[str, float]:
    """Return the ratios compliant/rigid with the same friction."""
    compliant, rigid = rows[f"compliant{suffix}"], rows[f"rigid{suffix}"]
    return {
        "friction": compliant.friction,
        "paper": compliant.paper / rigid.paper,
        "differential": compliant.differential / rigid.differential,
        "closed_form": compliant.closed_form / rigid.closed_form,
        "steps": compliant.counts["steps"] / rigid.counts["steps"],
        "step": compliant.microseconds / rigid.microseconds,
    }


def _jump_rows(run: PaperRun) -> list[JumpRow]:
    return [
        JumpRow(
            jump.what,
            jump.begin,
            jump.end - jump.begin,
            jump_size(jump, run.of_mesh("transmission_error")),
            jump_size(jump, run.of_mesh("penetration")),
            error,
        )
        for jump, error in jump_errors(run).items()
    ]
