"""Load spectra of wheels: cycles of root stress and tooth force, damage, and safety factors.

Equations, assumptions and sources: docs/theory/load_spectra.md.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.polynomial import chebyshev
from numpy.typing import NDArray

from evolvent.errors import USAGE, AnalysisError, HistoryError
from evolvent.history import open_events, source_name
from evolvent.history.recording import Recording, recording_of
from evolvent.physics.between_outputs import with_extremes
from evolvent.physics.load_cycles import Cycles, SNLine, count_cycles, sn_line
from evolvent.physics.tooth_loads import SIDES, ToothLoads, tooth_loads
from evolvent.physics.turn_windows import TurnWindow, turn_window

if TYPE_CHECKING:
    import xarray as xr

    from evolvent.library.root_influence import RootInfluence

Values = NDArray[np.float64]

FACE_LOAD = "uniform load over the face width; misalignment and K_Hbeta not covered"
ARCS = 49  # points of a fillet at which cycles are counted
FINE_ARCS = 513  # points of a fillet for the largest stress
NEAR = 0.95  # of the largest range: points with less are not counted
RESOLVED = 2e-3  # of the largest range: change if every second output is left out


@dataclass(frozen=True)
class PointSpectrum:
    """Cycles at one point of a tooth: of a fillet, or of a flank."""

    tooth: int  # from 0, counterclockwise
    side: str  # "right" or "left"; the right flank faces counterclockwise
    arc: float  # from the form circle to the point of the fillet [m]; NaN for a flank
    largest: float  # over the window, in the unit of the signal
    least: float
    peak: float  # largest value at all points of both fillets of the tooth
    cycles: Cycles
    damage: float = np.nan  # Miner sum of the window; NaN without S-N line

    @property
    def size(self) -> float:
        """Range of the window."""
        return self.largest - self.least


@dataclass(frozen=True)
class WheelSpectrum:
    """Load spectrum of one wheel over a window of a history."""

    wheel: str
    material: str
    window: TurnWindow
    root: tuple[PointSpectrum, ...]  # most loaded point of each tooth; empty without root stress
    no_root: str  # the reason
    force: tuple[PointSpectrum, ...]  # most loaded flank of each tooth [N]
    line: SNLine | None
    pressure: float  # largest contact pressure [Pa]; NaN if it was not recorded
    bare_force: float  # largest force of a contact without pressure, on a sharp tip edge [N]
    sigma_fp: float  # permissible stresses of the material [Pa]; NaN if not given
    sigma_hp: float
    change: float  # of the largest range without every second output, relative

    @property
    def worst_root(self) -> PointSpectrum | None:
        """Point with the largest damage, or without S-N line the largest range."""
        return _worst(self.root)

    @property
    def worst_force(self) -> PointSpectrum | None:
        """Flank with the largest range of force."""
        return _worst(self.force)

    @property
    def root_stress(self) -> float:
        """Largest root stress [Pa]; NaN without root stress."""
        return max((point.peak for point in self.root), default=np.nan)

    @property
    def safety_f(self) -> float:
        """S_F = sigma_FP/sigma_F; NaN without permissible stress. Equation LS6."""
        return self.sigma_fp / self.root_stress if self.root_stress > 0.0 else np.nan

    @property
    def safety_h(self) -> float:
        """S_H = sigma_HP/sigma_H; NaN without permissible stress. Equation LS6."""
        return self.sigma_hp / self.pressure if self.pressure > 0.0 else np.nan

    @property
    def life(self) -> float:
        """Revolutions until the Miner sum is 1; NaN without S-N line or whole turns."""
        worst = self.worst_root
        if worst is None or not self.window.repeats or np.isnan(worst.damage):
            return np.nan
        return self.window.turns / worst.damage if worst.damage > 0.0 else np.inf

    @property
    def remarks(self) -> list[str]:
        """Limits of the result, for print beside it."""
        found = []
        if np.isfinite(self.safety_f) or np.isfinite(self.safety_h) or self.line is not None:
            found.append(FACE_LOAD)
        if self.root:
            found.append("no friction along the flank; mean stresses are not corrected for")
        if self.no_root:
            found.append(self.no_root)
        if self.bare_force > 0.0:
            found.append(
                f"corner contact, no rounding given: pressure undefined, force up to "
                f"{self.bare_force:.4g} N"
            )
        if not self.is_resolved:
            found.append(self.change_text)
        return found

    @property
    def is_resolved(self) -> bool:
        """Whether the outputs are near enough for their extremes."""
        return self.change <= RESOLVED

    @property
    def change_text(self) -> str:
        """Describe the effect of the distance of the outputs."""
        return (
            f"without every second output the largest range changes by {100 * self.change:.2g} %: "
            "the outputs are too far apart; write more outputs per pitch"
        )


def _worst(points: Sequence[PointSpectrum]) -> PointSpectrum | None:
    return max(points, key=lambda point: (np.nan_to_num(point.damage), point.size), default=None)


def load_spectra(
    history: xr.Dataset,
    wheels: Sequence[str] | None = None,
    *,
    turns: int = 1,
    whole_window: bool = False,
    begin: float = -np.inf,
    end: float = np.inf,
) -> list[WheelSpectrum]:
    """Count the load cycles of the teeth of wheels: root stress and normal force of each tooth.

    Parameters
    ----------
    history : xarray.Dataset
        As from `open_history` or `run`, with the outputs of the tooth pairs.
    wheels : sequence of str, optional
        Names of the wheels; by default all wheels with teeth.
    turns : int, optional
        Revolutions of each wheel, the last ones of the window. They are one period of a repeating
        history.
    whole_window : bool, optional
        Count the whole window, whatever its revolutions, with half cycles for the residue.
    begin, end : float, optional
        Window [s]; by default the whole history.

    Returns
    -------
    list of WheelSpectrum
        One for each wheel.

    Raises
    ------
    HistoryError
        The history has no outputs of tooth pairs, or of the displacement of moving axles, or the
        window has fewer revolutions.

    Examples
    --------
    >>> import evolvent
    >>> history = evolvent.run("examples/compliant-pair.yaml", {"simulation.duration": "45 ms"})
    >>> spectrum = evolvent.load_spectra(history, ["pinion"])[0]
    >>> len(spectrum.root), round(spectrum.window.turns)
    (19, 1)
    """
    from evolvent.library.calls import show
    from evolvent.library.cases import opened

    run = recording_of(history)
    label = source_name(history)
    names = run.labels("wheel")
    chosen = list(wheels) if wheels else [n for n, z in zip(names, run["teeth"], strict=True) if z]
    for name in chosen:
        if name not in names:
            raise HistoryError(f"{label}: has no wheel `{name}`; it has {', '.join(names)}", USAGE)
    text = str(run.attrs["case"])
    case = show(text)["case"]
    if "centre_displacement" not in run and any(is_moving(wheel) for wheel in case["wheels"]):
        raise HistoryError(
            f"{label}: has no variable `centre_displacement`, on which the contacts of gears on "
            "moving axles depend; repeat the run with this output"
        )
    events = np.unique(np.sort(_events(history)))
    found = []
    with opened(text, None) as handle:
        for name in chosen:
            index = names.index(name)
            window = turn_window(run, label, index, turns, whole_window, begin, end)
            influence, reason = _influence(handle, text, index)
            material = str(case["wheels"][index]["material"])
            strength = case["materials"][material].get("strength", {})
            found.append(
                _of_wheel(name, material, strength, run, index, window, events, influence, reason)
            )
    return found


def is_moving(wheel: Mapping[str, Any]) -> bool:
    """Whether the axle of a wheel of a case can move."""
    return bool(wheel.get("support", {}).get("kind", "fixed") != "fixed")


def _events(history: xr.Dataset) -> Values:
    """Times of all events of a history; none if it has no group of events."""
    source = history.encoding.get("source")
    try:
        with open_events(Path(source) if source else history) as events:
            return np.asarray(events["time"].values, dtype=float)
    except HistoryError:
        return np.zeros(0)


def _influence(handle: Any, text: str, wheel: int) -> tuple[RootInfluence | None, str]:
    """Influence functions of a wheel, or the reason why it has none."""
    from evolvent.library.root_influence import RootInfluence

    try:
        return RootInfluence(handle, text, wheel), ""
    except AnalysisError as error:
        return None, error.reason


def _of_wheel(
    name: str,
    material: str,
    strength: Mapping[str, Any],
    run: Recording,
    wheel: int,
    window: TurnWindow,
    events: Values,
    influence: RootInfluence | None,
    reason: str,
) -> WheelSpectrum:
    line = sn_line(strength["sn"]) if "sn" in strength else None
    part = run.rows_from(window.first, window.last)
    every_load = tooth_loads(part, wheel)
    signals = [
        _Signals(every_load.of_rows(kept), part["time"][kept], _within(events, window), window)
        for kept in (window.kept(1), window.kept(2), window.kept(2, skipped=1))
    ]
    force = [tuple(of.flanks()) for of in signals]
    root: tuple[PointSpectrum, ...] = ()
    if influence is not None:
        root = tuple(signals[0].fillet(influence, line, j) for j in range(every_load.teeth))
    worst = _worst(root)
    change = max(_change(force[0], coarse) for coarse in force[1:])
    if influence is not None and worst is not None:
        change = max(
            _change([worst], [of.fillet(influence, line, worst.tooth)]) for of in signals[1:]
        )
    has_pressure = "pair_contact_pressure" in run
    bare = every_load.force[np.isnan(every_load.pressure)] if has_pressure else np.zeros(0)
    return WheelSpectrum(
        wheel=name,
        material=material,
        window=window,
        root=root,
        no_root=reason,
        force=force[0],
        line=line,
        pressure=signals[0].pressure() if has_pressure else np.nan,
        bare_force=float(bare.max(initial=0.0)),
        sigma_fp=float(strength.get("sigma_FP", np.nan)),
        sigma_hp=float(strength.get("sigma_HP", np.nan)),
        change=change,
    )


def _within(events: Values, window: TurnWindow) -> Values:
    return events[(events > window.begin) & (events <= window.end)]


def _change(fine: Sequence[PointSpectrum], coarse: Sequence[PointSpectrum]) -> float:
    """Relative change of the largest range of all teeth."""
    sizes = [max(point.size for point in points) for points in (fine, coarse)]
    return abs(sizes[1] - sizes[0]) / sizes[0] if sizes[0] > 0.0 else 0.0


@dataclass(frozen=True)
class _Signals:
    """Signals of the teeth of a wheel in a window."""

    loads: ToothLoads
    times: Values
    events: Values
    window: TurnWindow

    def refined(self, values: Values) -> Values:
        """Values with the extremes between the outputs."""
        return with_extremes(self.times, values, self.events, self.window.period)

    def point(
        self, tooth: int, side: int, arc: float, values: Values, line: SNLine | None = None
    ) -> PointSpectrum:
        """Count the cycles of one signal."""
        cycles = count_cycles(values, repeats=self.window.repeats)
        return PointSpectrum(
            tooth=tooth,
            side=SIDES[side],
            arc=arc,
            largest=float(values.max()),
            least=float(values.min()),
            peak=float(values.max()),
            cycles=cycles,
            damage=np.nan if line is None else line.damage(cycles),
        )

    def flanks(self) -> Iterator[PointSpectrum]:
        """Flank of each tooth with the largest range of force."""
        for tooth in range(self.loads.teeth):
            values = np.maximum(self.refined(self.loads.forces(tooth)), 0.0)
            side = int(np.argmax(np.ptp(values, axis=0)))
            yield self.point(tooth, side, np.nan, values[:, side])

    def pressure(self) -> float:
        """Largest contact pressure of all teeth [Pa]."""
        teeth = range(self.loads.teeth)
        return max(float(self.refined(self.loads.pressures(tooth)).max()) for tooth in teeth)

    def fillet(self, influence: RootInfluence, line: SNLine | None, tooth: int) -> PointSpectrum:
        """Most damaged point of both fillets of a tooth, or the one with the largest range."""
        arcs, weights = fillet_points(influence.arcs, ARCS)
        at_arcs = self.loads.stresses(tooth, influence.stress)
        signals = (at_arcs @ weights).reshape(self.loads.n_rows, -1)
        sizes = np.ptp(signals, axis=0)
        near = np.flatnonzero(sizes >= (1.0 if line is None else NEAR) * sizes.max())
        values = self.refined(signals[:, near])
        points = []
        for column, index in enumerate(near):
            side, arc = divmod(int(index), arcs.size)
            points.append(self.point(tooth, side, float(arcs[arc]), values[:, column], line))
        worst = _worst(points)
        assert worst is not None
        largest = signals.max(axis=1, keepdims=True)
        row = int(np.argmax(largest))
        between = (at_arcs[row] @ fillet_points(influence.arcs, FINE_ARCS)[1]).max() / largest[row]
        peak = float(self.refined(largest).max() * max(float(between[0]), 1.0))
        return replace(worst, peak=max(worst.peak, peak))


def fillet_points(arcs: Values, n: int) -> tuple[Values, Values]:
    """Equidistant points of a fillet, and weights of the values at known arcs in those there.

    The stress over the arc is the polynomial through the values at Chebyshev points, as in the
    kernel.
    """
    points = np.linspace(arcs.min(), arcs.max(), n)
    middle, half = (arcs.max() + arcs.min()) / 2, (arcs.max() - arcs.min()) / 2
    degree = arcs.size - 1
    at_arcs, at_points = (
        chebyshev.chebvander((values - middle) / half, degree) for values in (arcs, points)
    )
    return points, np.asarray(np.linalg.solve(at_arcs.T, at_points.T))
