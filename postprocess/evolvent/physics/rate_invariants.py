"""Rate invariants: the integral of a rate equals the change of its output."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from evolvent.history.recording import Part, Recording, Values, joined, largest_size
from evolvent.physics.applicable import NotApplicableError, is_rigid
from evolvent.physics.invariant import Deviation, invariant

ROUNDING = 64 * float(np.finfo(float).eps)  # of values that are subtracted
ROWS = (4, 6, 8)  # of the polynomials through a rate, half of them on either side of an interval
BESIDE = max(ROWS) // 2 - 1  # rows needed on either side
# Of the bound: if the polynomials resolve the rate, those of an interval and of its neighbours
# differ by less.
RESOLVED = 0.01
SHARE = 1 / 8  # of the period of the fastest vibration: the longest interval that resolves it
STIFFER = 1.5  # margin on the mesh frequency: several tooth pairs, inertias on supports
CONTACTS = ("tooth_pair", "contact_mode", "pair_number", "pair_contact_mode", "pairs_in_contact")
LEAST_BOUND, TOLERANCES = 1e-6, 100.0


@invariant(
    "rates",
    "x(t_(i+1)) - x(t_i) = integral of x'",
    "largest change between two rows",
    LEAST_BOUND,
    TOLERANCES,
)
def rates(run: Recording) -> Deviation:
    """Integral of each rate between two rows less the change of its output, over the largest one.

    Dims (time, rate). An output with attribute `rates` changes by the integral of those variables,
    or of their sum. The rate between two rows is the polynomial through four, six and eight rows
    around them. An interval is not evaluated in these cases: the polynomials differ, it is longer
    than an eighth of the period of the fastest vibration, or at one of these rows flanks of a mesh
    are separated or tooth contacts change. The rows then do not resolve the rate. Rigid contact is
    excluded: its impacts change speeds instantaneously.
    """
    if is_rigid(run).any():
        raise NotApplicableError("impacts of rigid contacts change speeds discontinuously")
    outputs = list(_outputs_with_rates(run))
    if not outputs:
        raise NotApplicableError("the history does not state the variables of its rates")
    if "normal_force" not in run:
        raise NotApplicableError("the history has no normal_force, which shows impacts")
    if run.n < max(ROWS):
        raise NotApplicableError(f"there are fewer than {max(ROWS)} rows")
    names = [f"{', '.join(own)} of {name}" for name, own in outputs]

    def change(part: Part) -> Values:
        return np.stack([_largest(_changes(part, name)) for name, _ in outputs])

    longest = SHARE / _fastest(run) if _fastest(run) > 0.0 else np.inf
    if not joined(run, lambda part: _steps(part).min(initial=np.inf), np.fmin) <= longest:
        raise NotApplicableError(
            f"vibrations at {_fastest(run):.4g} Hz need rows at most {longest:.2g} s apart"
        )
    scales = joined(run, change, np.fmax)
    lower_limits = [
        _energy(run) if str(run.variables[name].attrs["units"]) == "J" else 0.0
        for name, _ in outputs
    ]
    scales = np.where(scales > lower_limits, scales, 0.0)
    bound = _rates_bound(run)

    def deviation(part: Part) -> Values:
        columns = [
            _deviation(part, name, own, scale, bound, longest)
            for (name, own), scale in zip(outputs, scales, strict=True)
        ]
        return np.stack(columns, axis=1)

    resolved = joined(run, lambda part: np.array(np.isfinite(deviation(part)).any()), np.logical_or)
    if not resolved:
        raise NotApplicableError("no interval between two rows resolves a rate")
    return Deviation(("time", "rate"), lambda part: np.nan_to_num(deviation(part)), {"rate": names})


def _fastest(run: Recording) -> float:
    """Frequency of the fastest vibration of a mesh or an axis [Hz]; 0 if none is known."""
    found = [0.0]
    if "natural_frequency" in run:
        found.append(STIFFER * float(np.fmax.reduce(run["natural_frequency"], initial=0.0)))
    names = ("centre_displacement", "centre_acceleration")
    if all(name in run for name in names):
        moved, pushed = (largest_size(run, name) for name in names)
        with np.errstate(invalid="ignore", divide="ignore"):
            ratios = np.where(moved > 0.0, pushed / moved, 0.0)
        found.append(float(np.sqrt(np.fmax.reduce(ratios, axis=None, initial=0.0))) / (2 * np.pi))
    return max(found)


def _energy(run: Recording) -> float:
    """Negligible energy [J]: the tolerance, relative to the largest energy of the motion."""
    from evolvent.physics.invariants import tolerance_of

    names = [name for name in ("kinetic_energy", "potential_energy") if name in run]
    largest = sum(float(np.fmax.reduce(largest_size(run, name), axis=None)) for name in names)
    return float(run.once(tolerance_of)) * largest


def _steps(part: Part) -> Values:
    return np.asarray(np.diff(_rows(part, "time", 1)[:, 0]))


def _rates_bound(run: Recording) -> float:
    from evolvent.physics.invariants import tolerance_of

    return max(LEAST_BOUND, TOLERANCES * float(run.once(tolerance_of)))


def _outputs_with_rates(run: Recording) -> Iterator[tuple[str, list[str]]]:
    """Outputs with the variables that add up to their rate, if the history contains all of them."""
    for name, variable in run.variables.items():
        own = variable.attrs.get("rates", b"")
        own = (own.decode() if isinstance(own, bytes) else str(own)).split()
        if own and variable.is_over_time and all(rate in run for rate in own):
            yield name, own


def _rows(part: Part, name: str, beside: int) -> Values:
    """Rows of a part and some on either side, if they exist; elements along one axis."""
    run = part.recording
    values = run.read(name, max(part.begin - beside, 0), min(part.end + beside, run.n))
    return np.asarray(values, dtype=float).reshape(len(values), -1)


def _changes(part: Part, name: str) -> Values:
    return np.asarray(np.diff(_rows(part, name, 1), axis=0))


def _largest(values: Values) -> Values:
    finite = np.abs(values[np.isfinite(values)])
    return np.asarray(finite.max() if finite.size else 0.0)


def _rate(part: Part, own: list[str], width: int) -> Values:
    """Rate of an output of some width: one variable, or the sum of all for a scalar output."""
    found = [_rows(part, name, BESIDE + 1) for name in own]
    if width == 1:
        return np.asarray(sum(each.sum(axis=1, keepdims=True) for each in found))
    return found[0]


def _deviation(
    part: Part, name: str, own: list[str], scale: float, bound: float, longest: float
) -> Values:
    """Deviation of the interval before each row, the largest of all elements.

    NaN if the interval is not evaluated.
    """
    found = np.full(part.n, np.nan)
    if not scale > 0.0:
        return found
    time = _rows(part, "time", BESIDE + 1)[:, 0]
    values = _rows(part, name, BESIDE + 1)
    rate = _rate(part, own, values.shape[1])
    n = len(time)
    first = np.arange(BESIDE, n - BESIDE - 1)  # of the two rows of each interval
    if not first.size:
        return found
    integrals = [_integrals(time, rate, first, rows) for rows in ROWS]
    unsure = np.max([abs(a - b) for a, b in pairwise(integrals)], axis=0)
    around = np.max(unsure, axis=1)
    around = np.fmax(around, np.fmax(np.r_[0.0, around[:-1]], np.r_[around[1:], 0.0]))
    rounding = ROUNDING * (abs(values[first]) + abs(values[first + 1]))
    change = values[first + 1] - values[first]
    wrong = np.clip(abs(integrals[-1] - change) - rounding, 0.0, None).max(axis=1) / scale
    is_resolved = (around <= RESOLVED * bound * scale) & (np.diff(time)[first] <= longest)
    apart = _are_apart(part)[first[:, np.newaxis] + np.arange(-BESIDE, BESIDE + 2)].any(axis=1)
    changes = _have_events(part)[first[:, np.newaxis] + np.arange(-BESIDE, BESIDE + 1)].any(axis=1)
    is_resolved &= ~(apart | changes)
    wrong[~is_resolved] = np.nan
    row = first + 1 - (part.begin - max(part.begin - BESIDE - 1, 0))
    inside = (row >= 0) & (row < part.n)
    found[row[inside]] = wrong[inside]
    return found


def _are_apart(part: Part) -> NDArray[np.bool_]:
    """Rows at which the flanks of a mesh carry no load: an impact may lie between two such rows."""
    forces = _rows(part, "normal_force", BESIDE + 1)
    if "coast_force" in part.recording:
        forces = forces + np.nan_to_num(_rows(part, "coast_force", BESIDE + 1))
    return np.asarray((forces == 0.0).any(axis=1))


def _have_events(part: Part) -> NDArray[np.bool_]:
    """Intervals with changes of tooth contacts: forces may jump there."""
    found = np.zeros(max(len(_rows(part, "time", BESIDE + 1)) - 1, 0), dtype=bool)
    for name in CONTACTS:
        if name in part.recording:
            found |= (np.diff(_rows(part, name, BESIDE + 1), axis=0) != 0.0).any(axis=1)
    return found


def _integrals(time: Values, rate: Values, first: Values, rows: int) -> Values:
    """Integrals from each row to the next by the polynomial through `rows` rows around them."""
    around = np.arange(rows) - (rows // 2 - 1)
    step = time[first + 1] - time[first]
    abscissae = (time[first[:, np.newaxis] + around] - time[first, np.newaxis]) / step[
        :, np.newaxis
    ]
    powers = np.arange(rows)
    # Weights that integrate each power from 0 to 1.
    matrix = abscissae[:, np.newaxis, :] ** powers[np.newaxis, :, np.newaxis]
    moments = np.broadcast_to((1.0 / (powers + 1))[:, np.newaxis], (first.size, rows, 1))
    weights = np.linalg.solve(matrix, moments)[..., 0]
    sums = np.einsum("ik,ikj->ij", weights, rate[first[:, np.newaxis] + around])
    return np.asarray(step[:, np.newaxis] * sums)
