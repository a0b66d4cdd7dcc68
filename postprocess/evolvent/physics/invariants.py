"""Table of invariants, which hold in every run of any case, and their verdicts.

Each invariant is a function of the history, whose decorator is its row (`invariant`). It returns
the deviation, divided by its natural scale, so that a single number bounds it: a fixed one, or a
multiple of the tolerance of the case if that is larger. docs/theory/theory.md explains them. The
history is read in parts, twice: for the scales, then for the deviations.

`evolvent run` checks its own run against some of them, with the same bounds, and writes the result
(`invariants`).
"""

from __future__ import annotations

from dataclasses import dataclass
from importlib import import_module
from typing import TYPE_CHECKING

import numpy as np

from evolvent.history.recording import Recording, Values, recording_of
from evolvent.physics.applicable import NotApplicableError
from evolvent.physics.invariant import INVARIANTS, Deviation, Invariant

if TYPE_CHECKING:
    import xarray as xr

# In the order of the table.
for _of in ("tracking", "rigid", "balance", "rate", "contact", "record"):
    import_module(f"evolvent.physics.{_of}_invariants")

DEFAULT_TOLERANCE = 1e-9


@dataclass(frozen=True)
class Verdict:
    """Result of an invariant for one history."""

    invariant: Invariant
    bound: float  # for the tolerance of the case
    verdict: str  # "pass", "fail" or "not applicable"
    worst: float | None  # largest deviation; None if not applicable
    where: dict[str, str]  # coordinates of the worst value, such as {"time": "1.25 s"}
    reason: str  # why it is not applicable

    @property
    def failed(self) -> bool:
        """Whether the invariant is violated."""
        return self.verdict == "fail"


def check_history(history: xr.Dataset | Recording) -> list[Verdict]:
    """Check every invariant.

    Parameters
    ----------
    history : xarray.Dataset or Recording
        As from `open_history` or `open_recording`.

    Returns
    -------
    list of Verdict
        One for each row of `INVARIANTS`, in its order.

    Raises
    ------
    HistoryError
        A variable required by an invariant is not in the file.

    Examples
    --------
    >>> import evolvent
    >>> verdicts = evolvent.check_history(evolvent.open_history("paper.h5"))
    >>> [verdict.invariant.name for verdict in verdicts if verdict.failed]
    []
    """
    run = recording_of(history)
    return [check_invariant(run, invariant) for invariant in INVARIANTS]


def check_invariant(history: xr.Dataset | Recording, invariant: Invariant) -> Verdict:
    """Check one invariant; NaN violates it."""
    run = recording_of(history)
    bound = invariant.bound(run.once(tolerance_of))
    try:
        if run.n == 0:
            raise NotApplicableError("the history has no output")
        with np.errstate(all="ignore"):
            deviation = invariant.deviation(run)
            worst = _worst(run, deviation)
    except NotApplicableError as error:
        return Verdict(invariant, bound, "not applicable", None, {}, str(error))
    where = {
        dim: _label_of(run, deviation, dim, index)
        for dim, index in zip(deviation.dims, worst.position, strict=True)
    }
    passed = not worst.is_broken and worst.value <= bound
    return Verdict(invariant, bound, "pass" if passed else "fail", worst.value, where, "")


@dataclass(frozen=True)
class _Worst:
    """Value with the largest magnitude, or the first non-finite value."""

    is_broken: bool
    value: float
    position: tuple[int, ...]

    def beats(self, other: _Worst) -> bool:
        """Whether it replaces the other; of two equal values the first one counts."""
        if self.is_broken or other.is_broken:
            return self.is_broken and (not other.is_broken or self.position < other.position)
        if self.value == other.value:
            return self.position < other.position
        return self.value > other.value


def _worst(run: Recording, deviation: Deviation) -> _Worst:
    if not callable(deviation.values):
        return _worst_of(deviation.values)
    time = deviation.dims.index("time")
    worst: _Worst | None = None
    for part in run.parts():
        found = _worst_of(deviation.values(part), (time, part.begin))
        worst = found if worst is None or found.beats(worst) else worst
    assert worst is not None
    return worst


def _worst_of(deviation: Values, shift: tuple[int, int] = (0, 0)) -> _Worst:
    values = abs(deviation)
    broken = ~np.isfinite(values)
    is_broken = bool(broken.any())
    position = list(np.unravel_index(int(np.argmax(broken if is_broken else values)), values.shape))
    value = float(values[tuple(position)])
    position[shift[0]] += shift[1]
    return _Worst(is_broken, value, tuple(int(index) for index in position))


def tolerance_of(history: xr.Dataset | Recording) -> float:
    """Tolerance of the integrator: given in the case, or resulting from its accuracy."""
    if "integrator_tolerance" in history.attrs:
        return float(history.attrs["integrator_tolerance"])
    import yaml

    # The faster loader of libyaml, if PyYAML has it.
    loader = getattr(yaml, "CSafeLoader", yaml.SafeLoader)
    case = yaml.load(history.attrs.get("case", ""), loader)
    simulation = case.get("simulation") if isinstance(case, dict) else None
    return float((simulation or {}).get("tolerance", DEFAULT_TOLERANCE))


def _label_of(run: Recording, deviation: Deviation, dim: str, index: int) -> str:
    if dim == "time":
        return f"{float(run.read('time', index, index + 1)[0]):.6g} s"
    names = deviation.names.get(dim)
    return str(names[index] if names is not None else run.labels(dim)[index])
