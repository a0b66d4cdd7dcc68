"""What must hold in every run, whatever the case: the invariants as a table, and their verdicts.

Each invariant is a function of the history that gives the deviation from what should be, divided
by its natural scale, so that one number bounds it: a fixed one, or a multiple of the tolerance of
the case where that is larger. docs/theory.md explains them. `evolvent run` holds its own run to
some of them, with the same bounds, and writes the outcome down (`invariants`).
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import xarray as xr
import yaml

from evolvent.physics.applicable import DEPTH_BOUND, NotApplicableError
from evolvent.physics.balance_invariants import energy_balance, torque_balance
from evolvent.physics.contact_invariants import agreement_of_modes, pull, rigid_gap, rigid_gap_rate
from evolvent.physics.record_invariants import beyond_extremes, finiteness, order_of_times
from evolvent.physics.tracking_invariants import (
    distance_from_flanks,
    distance_from_line_of_action,
    gradient_ratio,
    transmission_error_identity,
)

DEFAULT_TOLERANCE = 1e-9
DEPTH = "penetration"  # the largest or the reference one, whichever is larger


@dataclass(frozen=True)
class Invariant:
    """One line of the table."""

    name: str
    formula: str  # text, as in docs/theory.md
    relative_to: str
    least_bound: float
    deviation: Callable[[xr.Dataset], xr.DataArray]
    tolerances: float = 0.0  # the bound is at least so many times the tolerance of the case

    def bound(self, tolerance: float) -> float:
        """Largest deviation of a right run with that tolerance."""
        return max(self.least_bound, self.tolerances * tolerance)


@dataclass(frozen=True)
class Verdict:
    """What became of an invariant in one history."""

    invariant: Invariant
    bound: float  # for the tolerance of the case
    verdict: str  # "pass", "fail" or "not applicable"
    worst: float | None  # largest deviation; None if not applicable
    where: dict[str, str]  # coordinates of the worst value, such as {"time": "1.25 s"}
    reason: str  # why it is not applicable

    @property
    def failed(self) -> bool:
        """Whether the invariant is broken."""
        return self.verdict == "fail"


INVARIANTS = (
    Invariant("gradient ratio", "lambda = -r_bB/r_bA", "itself", 1e-12, gradient_ratio, 1e-3),
    Invariant(
        "transmission error",
        "Delta = h + e + R (inv alpha - inv alpha_0)",
        DEPTH,
        DEPTH_BOUND,
        transmission_error_identity,
        tolerances=1.0,
    ),
    Invariant(
        "points on flanks",
        "r_b g(r_P) = 0",
        DEPTH,
        DEPTH_BOUND,
        distance_from_flanks,
        tolerances=1.0,
    ),
    Invariant(
        "points on line of action",
        "(r_P - K_A).t = 0",
        DEPTH,
        DEPTH_BOUND,
        distance_from_line_of_action,
        tolerances=1.0,
    ),
    Invariant("rigid gap", "kappa = 0", DEPTH, 2 * DEPTH_BOUND, rigid_gap, tolerances=1.0),
    Invariant(
        "rigid gap rate",
        "kappa' = 0",
        "vibration of that depth",
        1e-10,
        rigid_gap_rate,
        tolerances=1.0,
    ),
    Invariant(
        "energy balance",
        "T + V + dissipated - work of loads = constant",
        "energy put in",
        1e-10,
        energy_balance,
        tolerances=10.0,
    ),
    Invariant(
        "torque balance",
        "J omega' = load + sigma (F_n r_b + F_t l) + shafts",
        "largest contact or shaft torque",
        1e-6,
        torque_balance,
    ),
    Invariant("pushing", "F_n >= 0", "reference force", 1e-6, pull),
    Invariant(
        "contact modes",
        "in contact: h >= 0, else F_n = 0, and h <= 0 without tooth coupling",
        "reference penetration or force",
        1e-6,
        agreement_of_modes,
    ),
    Invariant(
        "extremes",
        "no output beyond its extreme over the run",
        "largest value",
        1e-9,
        beyond_extremes,
    ),
    Invariant("order of times", "t_i < t_(i+1)", "1", 0.0, order_of_times),
    Invariant("finite values", "every value is a number", "number of values", 0.0, finiteness),
)


def check_history(history: xr.Dataset) -> list[Verdict]:
    """Check every invariant.

    Parameters
    ----------
    history : as from `open_history`.

    Returns
    -------
    One verdict for each line of `INVARIANTS`, in its order.

    Raises
    ------
    HistoryError
        A variable that an invariant needs is not in the file.
    """
    return [check_invariant(history, invariant) for invariant in INVARIANTS]


def check_invariant(history: xr.Dataset, invariant: Invariant) -> Verdict:
    """Check one invariant; a value that is no number breaks it."""
    bound = invariant.bound(tolerance_of(history))
    try:
        if history.sizes["time"] == 0:
            raise NotApplicableError("the history has no output")
        deviation = abs(invariant.deviation(history))
    except NotApplicableError as error:
        return Verdict(invariant, bound, "not applicable", None, {}, str(error))
    values = deviation.values
    broken = ~np.isfinite(values)
    position = np.unravel_index(
        int(np.argmax(broken)) if broken.any() else int(np.argmax(values)), values.shape
    )
    worst = float(values[position])
    where = {
        str(dim): _place(deviation, str(dim), int(index))
        for dim, index in zip(deviation.dims, position, strict=True)
    }
    passed = not broken.any() and worst <= bound
    return Verdict(invariant, bound, "pass" if passed else "fail", worst, where, "")


def tolerance_of(history: xr.Dataset) -> float:
    """Tolerance of the case, from the resolved case in the history."""
    case = yaml.safe_load(history.attrs.get("case", ""))
    simulation = case.get("simulation") if isinstance(case, dict) else None
    return float(simulation["tolerance"]) if simulation else DEFAULT_TOLERANCE


def _place(deviation: xr.DataArray, dim: str, index: int) -> str:
    if dim not in deviation.coords:
        return str(index)
    value = deviation[dim].values[index]
    return f"{value:.6g} s" if dim == "time" else str(value)
