"""Main results of a run: forces, pressures, errors, losses, speeds; with times and positions.

Means, shares and factors are those over whole periods (docs/reference/numbers.md) if a history has
them. They are otherwise evaluated from its outputs: in the same window, or in the whole run without
one.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from evolvent.history.recording import (
    Part,
    Recording,
    Values,
    integral,
    largest,
    recording_of,
)
from evolvent.physics.extremes import SIGNED, Extreme, extremes
from evolvent.physics.mesh_summary import mesh_summaries
from evolvent.physics.metrics import PREFIX, steady_window, window_text
from evolvent.physics.pair_positions import position_of_pair
from evolvent.physics.undefined_pressure import KIND, note_of, undefined_forces
from evolvent.physics.wheel_torques import contact_torque, shaft_torque
from evolvent.units import quantity

if TYPE_CHECKING:
    import xarray as xr

DIGITS = 4
# Outputs whose maxima are reported, and their labels.
LARGEST = {
    "normal_force": "normal force",
    "pair_normal_force": "normal force of a tooth pair",
    "pair_contact_pressure": "contact pressure",
    "penetration": "penetration of the flanks",
    "friction_force": "friction force",
    "sliding_velocity": "sliding velocity",
    "pair_sliding_velocity": "sliding velocity",
}
OF_PAIRS = "pair_sliding_velocity"  # replaces that of a mesh if a history has it
ABSOLUTE = (*SIGNED, OF_PAIRS)

ONLY_IF_ANY = ("impacts", "rattle_index")
SHARED = "pair_normal_force"  # equals that of the mesh if there is one pair
PRESSURE = "pair_contact_pressure"  # NaN on sharp tip edges and hollow flanks


@dataclass(frozen=True)
class Row:
    """A metric of a mesh, by its name in a history without `window_`."""

    name: str
    label: str
    symbol: str
    units: str = "1"


MESH_ROWS = (
    Row("normal_force_mean", "mean normal force", "mean F_n", "N"),
    Row("dynamic_factor", "dynamic factor of the mesh force", "max F_n / mean F_n"),
    Row("pair_dynamic_factor", "dynamic factor of a tooth pair, over its quasi-static maximum", ""),
    Row("dynamic_factor_iso", "dynamic factor of ISO 6336-1, method B, without deviations", "K_V"),
    Row(
        "dynamic_factor_iso_of_class",
        "dynamic factor of ISO 6336-1, method B, with the tolerances of the classes",
        "K_V",
    ),
    Row("transmission_error_mean", "mean transmission error", "mean Delta", "m"),
    Row(
        "transmission_error_peak_to_peak",
        "transmission error, peak to peak",
        "max Delta - min Delta",
        "m",
    ),
    Row("transmission_error_amplitude", "transmission error, first mesh order", "", "m"),
    Row("share_no_contact", "share of the time without contact", "", "%"),
    Row("impacts", "impacts", ""),
    Row("rattle_index", "rattle index", ""),
)


@dataclass(frozen=True)
class Cell:
    """One value."""

    text: str
    where: str = ""  # time and position


@dataclass(frozen=True)
class ResultRow:
    """One row: label and a value for each mesh or wheel; None if there is none."""

    label: str
    symbol: str  # plain, as in docs/theory/theory.md
    cells: tuple[Cell | None, ...]


@dataclass(frozen=True)
class Results:
    """First section of a report."""

    largest: list[ResultRow]  # over the whole run, of each mesh
    scope: str  # range of the means
    means: list[ResultRow]  # of each mesh
    wheels: list[ResultRow]
    lost: str  # mean power loss of the whole gearbox


def results(history: xr.Dataset) -> Results | None:
    """Summarise a run; None with less than two outputs."""
    if history.sizes["time"] < 2:
        return None
    run = recording_of(history)
    shown, scope, is_window = _window(run)
    first, last = (shown.read("dissipated_energy", row, row + 1)[0] for row in (0, shown.n - 1))
    lost = last - first
    found = extremes(history)
    return Results(
        largest=_with_values(_largest(history, found)),
        scope=scope,
        means=_with_values(_means(run, shown, [] if is_window else found, is_window)),
        wheels=_with_values(_wheels(shown)),
        lost=quantity(float(lost) / _span(shown), "W", DIGITS),
    )


def _window(run: Recording) -> tuple[Recording, str, bool]:
    """Return the part of a history for the means, its description, and whether it is a window."""
    window = steady_window(run)
    if window is not None:
        scope = f"{window_text(run)} Losses, torques and speeds are means of its outputs."
        return run.between(*window), scope, True
    first, last = (quantity(float(run["time"][row]), "s", 5) for row in (0, -1))
    scope = (
        f"The whole run, from {first} to {last}, with its start; means are of its outputs. With "
        "simulation.metrics in the case they are of whole periods after the start."
    )
    return run, scope, False


def _largest(history: xr.Dataset, recorded: list[Extreme]) -> Iterable[ResultRow]:
    """Value with the largest magnitude of each quantity."""
    found: dict[str, list[Extreme]] = {}
    for extreme in recorded:
        found.setdefault(extreme.output, []).append(extreme)
    if recorded and OF_PAIRS in history and SHARED in history:
        found[OF_PAIRS] = [_largest_sliding(history), *found.pop("sliding_velocity", [])]
    notes = _undefined_pressures(history) if PRESSURE in found else []
    for output, label in LARGEST.items():
        if output not in found or (output == SHARED and history.sizes["pair"] == 1):
            continue
        cells = []
        for mesh in range(history.sizes["mesh"]):
            ends = [(float(e.value[mesh]), float(e.time[mesh])) for e in found[output]]
            value, time = max(ends, key=_size)
            value = abs(value) if output in ABSOLUTE else value
            cell = _extreme_cell(history, output, mesh, value, time)
            if cell is not None and output == PRESSURE and notes[mesh]:
                cell = Cell(cell.text, f"{cell.where}; {notes[mesh]}")
            cells.append(cell)
        symbol = str(history[output].attrs.get("symbol", ""))
        symbol = f"| {symbol} |" if output in ABSOLUTE else symbol
        yield ResultRow(f"largest {label}", f"max {symbol}", tuple(cells))


def _largest_sliding(history: xr.Dataset) -> Extreme:
    """Find the largest sliding velocity of the loaded tooth pairs among the outputs.

    The output `sliding_velocity` of a mesh is that of its leading pair; another one may slide
    faster.
    """
    import xarray as xr

    run = recording_of(history)
    n = history.sizes["mesh"]
    best, when = np.zeros(n), np.full(n, float(run["time"][0]))
    for part in run.parts():
        size = np.where(part[SHARED] > 0, np.abs(part[OF_PAIRS]), 0.0)
        size = np.fmax.reduce(np.nan_to_num(size), axis=2)
        rows = size.argmax(axis=0)
        found = size[rows, np.arange(n)]
        is_new = found > best
        best, when = np.where(is_new, found, best), np.where(is_new, part["time"][rows], when)
    value, time = (xr.DataArray(one, dims="mesh") for one in (best, when))
    return Extreme(OF_PAIRS, True, False, value, time)


def _undefined_pressures(history: xr.Dataset) -> list[str]:
    """Note on the loads without a contact pressure among the outputs, for each mesh."""
    run = recording_of(history)
    forces = np.zeros((history.sizes["mesh"], 3))
    if SHARED in run and PRESSURE in run:
        for part in run.parts():
            kind = part[KIND] if KIND in run else None
            forces = np.maximum(forces, undefined_forces(part[SHARED], part[PRESSURE], kind))
    return [note_of(of_mesh) for of_mesh in forces]


def _size(extreme: tuple[float, float]) -> float:
    return abs(extreme[0])


def _extreme_cell(
    history: xr.Dataset, output: str, mesh: int, value: float, time: float
) -> Cell | None:
    if not np.isfinite(value) or value == 0.0:
        return None
    position = position_of_pair(history, mesh, time, output)
    when = f"at {quantity(time, 's', 5)}"
    units = str(history[output].attrs.get("units", "1"))
    return _cell(value, units, f"{when}, {position.text()}" if position is not None else when)


def _means(
    run: Recording, shown: Recording, found: list[Extreme], is_window: bool
) -> Iterable[ResultRow]:
    """Mean values, variation and losses of each mesh.

    Parameters
    ----------
    found : extremes between the outputs, if they are to be used.
    """
    n_meshes = run.sizes["mesh"]
    recorded = {
        name.removeprefix(PREFIX): run[name]
        for name, variable in run.variables.items()
        if is_window and name.startswith(PREFIX) and variable.dims()[:1] == ("mesh",)
    }
    between = {(e.output, e.is_largest): np.asarray(e.value) for e in found}
    computed: dict[str, Values] = {}
    for output in ("transmission_error", "normal_force"):
        computed[f"{output}_mean"] = _mean(shown, output)
        computed[f"{output}_max"] = between.get((output, True), _top(shown, output))
    least = between.get(("transmission_error", False), -_top(shown, "transmission_error", -1.0))
    computed["transmission_error_peak_to_peak"] = computed["transmission_error_max"] - least
    with np.errstate(divide="ignore", invalid="ignore"):
        factor = computed["normal_force_max"] / computed["normal_force_mean"]
    computed["dynamic_factor"] = factor
    summaries = mesh_summaries(shown)
    if summaries:
        computed["share_no_contact"] = _of_meshes([s.apart for s in summaries])
    for row in MESH_ROWS:
        values = recorded.get(row.name, computed.get(row.name))
        if values is not None:
            first = values.reshape(n_meshes, -1)[:, 0]
            if row.name not in ONLY_IF_ANY or first.any():
                yield _result_row(row, first)
    yield from _losses(shown, [s.efficiency for s in summaries])


def _losses(shown: Recording, efficiencies: list[float | None]) -> Iterable[ResultRow]:
    for name, label in (("friction_loss", "friction"), ("contact_damping_loss", "damping")):
        if name in shown:
            symbol = str(shown.variables[name].attrs.get("symbol", ""))
            yield _result_row(Row(name, f"power lost to {label}", symbol, "W"), _mean(shown, name))
    if efficiencies:
        yield _result_row(Row("efficiency", "efficiency", "eta", "%"), _of_meshes(efficiencies))


def _wheels(shown: Recording) -> Iterable[ResultRow]:
    """Speed, torques and bearing force of each wheel."""
    ends = [sense * _top(shown, "angular_velocity", sense) for sense in (-1.0, 1.0)]
    cells = []
    for mean, *both in zip(_mean(shown, "angular_velocity"), *ends, strict=True):
        low, high = (quantity(float(v), "rad s-1", DIGITS) for v in both)
        cells.append(_cell(float(mean), "rad s-1", "" if low == high else f"{low} to {high}"))
    yield ResultRow("speed", "omega", tuple(cells))
    torques: dict[str, tuple[str, str | Callable[[Part], Values]]] = {
        "torque of the loads": ("M", "load_torque"),
        "torque of its meshes": ("", contact_torque),
        "torque of its shafts": ("", shaft_torque),
        "power of the loads": ("M omega", _power),
    }
    if "load_loss" in shown:
        torques["power lost in load-independent losses"] = ("P_l", "load_loss")
    for label, (letter, values) in torques.items():
        units = "W" if label.startswith("power") else "N m"
        means = _mean(shown, values)
        yield ResultRow(label, letter, tuple(_cell(float(v), units) if v else None for v in means))
    if "bearing_force" in shown:
        yield ResultRow("largest bearing force", "", tuple(_bearings(shown)))


def _power(part: Part) -> Values:
    return np.asarray(part["load_torque"] * part["angular_velocity"])


def _bearings(shown: Recording) -> Iterable[Cell | None]:
    """Largest bearing force of each wheel, and its time."""
    top, when = np.full((2, shown.sizes["wheel"]), -np.inf)
    for part in shown.parts():
        size = np.linalg.norm(part["bearing_force"], axis=2)
        rows = size.argmax(axis=0)
        found = size[rows, np.arange(top.size)]
        is_new = ~(found <= top)
        top, when = np.where(is_new, found, top), np.where(is_new, part["time"][rows], when)
    for force, time in zip(top, when, strict=True):
        yield _cell(float(force), "N", f"at {quantity(float(time), 's', 5)}") if force else None


def _result_row(row: Row, values: Iterable[float]) -> ResultRow:
    return ResultRow(
        row.label, row.symbol, tuple(_cell(float(value), row.units) for value in values)
    )


def _cell(value: float, units: str, where: str = "") -> Cell | None:
    if not np.isfinite(value):
        return None
    if units == "%":
        return Cell(f"{100 * value:.{DIGITS}g} %", where)
    return Cell(quantity(value, units, DIGITS), where)


def _with_values(rows: Iterable[ResultRow]) -> list[ResultRow]:
    """Drop the rows without any value."""
    return [row for row in rows if any(cell is not None for cell in row.cells)]


def _of_meshes(values: Sequence[float | None]) -> Values:
    return np.array([np.nan if v is None else v for v in values])


def _mean(shown: Recording, values: str | Callable[[Part], Values]) -> Values:
    """Mean over time by the trapezoidal rule, of a variable or a function of the outputs."""
    of = values if callable(values) else lambda part: part[values]
    return np.asarray(integral(shown, of) / _span(shown))


def _top(shown: Recording, name: str, sense: float = 1.0) -> Values:
    """Maximum of the outputs, or of the negated outputs."""
    return largest(shown, lambda part: sense * part[name])


def _span(shown: Recording) -> float:
    return float(shown["time"][-1] - shown["time"][0])
