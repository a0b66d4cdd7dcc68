"""What must hold in every run, whatever the case: the table of invariants, and their verdicts.

Each invariant is a function of the history, whose decorator is its row (`invariant`). It gives the
deviation from what should be, divided by its natural scale, so that one number bounds it: a fixed
one, or a multiple of the tolerance of the case where that is larger. docs/theory.md explains them.
`evolvent run` holds its own run to some of them, with the same bounds, and writes the outcome down
(`invariants`).
"""

from __future__ import annotations

from dataclasses import dataclass
from importlib import import_module

import numpy as np
import xarray as xr
import yaml

from evolvent.physics.applicable import NotApplicableError
from evolvent.physics.invariant import INVARIANTS, Invariant

# In the order of the table.
for _of in ("tracking", "rigid", "balance", "contact", "record"):
    import_module(f"evolvent.physics.{_of}_invariants")

DEFAULT_TOLERANCE = 1e-9


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
