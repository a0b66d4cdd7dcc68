"""What an engineer asks of a run first: forces, pressures, errors, losses, speeds; when and where.

Means, shares and factors are those over whole periods (docs/numbers.md) if a history tells them,
and otherwise over its outputs: in the same window, or in the whole run if there is none.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import numpy as np
import xarray as xr

from evolvent.physics.extremes import SIGNED, Extreme, extremes
from evolvent.physics.mesh_summary import mesh_summaries
from evolvent.physics.numbers import PREFIX, steady_window, window_text
from evolvent.physics.pair_places import place_of_pair
from evolvent.physics.wheel_torques import contact_torque, shaft_torque
from evolvent.units import quantity

DIGITS = 4
# Outputs whose largest values are told, and what they are called there.
LARGEST = {
    "normal_force": "normal force",
    "pair_normal_force": "normal force of a tooth pair",
    "pair_contact_pressure": "contact pressure",
    "penetration": "penetration of the flanks",
    "friction_force": "friction force",
    "sliding_velocity": "sliding velocity",
}


ONLY_IF_ANY = ("impacts", "rattle_index")
SHARED = "pair_normal_force"  # that of the mesh where there is one pair


@dataclass(frozen=True)
class Row:
    """A number of a mesh, by its name in a history without `window_`."""

    name: str
    label: str
    symbol: str
    units: str = "1"


MESH_ROWS = (
    Row("normal_force_mean", "mean normal force", "mean F_n", "N"),
    Row("dynamic_factor", "dynamic factor", "max F_n / mean F_n"),
    Row("pair_dynamic_factor", "dynamic factor of a tooth pair", ""),
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
    """One answer."""

    text: str
    where: str = ""  # when and where it was so


@dataclass(frozen=True)
class Answer:
    """One row: what, and how much for each mesh or wheel; None for what has no answer."""

    label: str
    symbol: str  # plain, as in docs/theory.md
    cells: tuple[Cell | None, ...]


@dataclass(frozen=True)
class Results:
    """The opening of a report."""

    largest: list[Answer]  # over the whole run, of each mesh
    scope: str  # what the means are of
    means: list[Answer]  # of each mesh
    wheels: list[Answer]
    lost: str  # power that the whole gearbox lost on average


def results(history: xr.Dataset) -> Results | None:
    """Sum up a run; None without two outputs."""
    if history.sizes["time"] < 2:
        return None
    shown, scope, is_window = _window(history)
    lost = shown["dissipated_energy"][-1] - shown["dissipated_energy"][0]
    return Results(
        largest=_told(_largest(history)),
        scope=scope,
        means=_told(_means(history, shown, is_window)),
        wheels=_told(_wheels(shown)),
        lost=quantity(float(lost) / _span(shown), "W", DIGITS),
    )


def _window(history: xr.Dataset) -> tuple[xr.Dataset, str, bool]:
    """Give the part of a history that means are of, what is said of it, if it has numbers."""
    window = steady_window(history)
    if window is not None:
        scope = f"{window_text(history)} Losses, torques and speeds are means of its outputs."
        return history.sel(time=slice(*window)), scope, True
    first, last = (quantity(float(history["time"][row]), "s", 5) for row in (0, -1))
    scope = (
        f"The whole run, from {first} to {last}, with its start; means are of its outputs. With "
        "simulation.numbers in the case they are of whole periods behind the start."
    )
    return history, scope, False


def _largest(history: xr.Dataset) -> Iterable[Answer]:
    """Of each quantity the value that lies farthest from 0."""
    found: dict[str, list[Extreme]] = {}
    for extreme in extremes(history):
        found.setdefault(extreme.output, []).append(extreme)
    for output, label in LARGEST.items():
        if output not in found or (output == SHARED and history.sizes["pair"] == 1):
            continue
        cells = []
        for mesh in range(history.sizes["mesh"]):
            ends = [(float(e.value[mesh]), float(e.time[mesh])) for e in found[output]]
            cells.append(_extreme_cell(history, output, mesh, *max(ends, key=_size)))
        symbol = str(history[output].attrs.get("symbol", ""))
        symbol = f"| {symbol} |" if output in SIGNED else symbol
        yield Answer(f"largest {label}", f"max {symbol}", tuple(cells))


def _size(extreme: tuple[float, float]) -> float:
    return abs(extreme[0])


def _extreme_cell(
    history: xr.Dataset, output: str, mesh: int, value: float, time: float
) -> Cell | None:
    if not np.isfinite(value) or value == 0.0:
        return None
    place = place_of_pair(history, mesh, time, output)
    when = f"at {quantity(time, 's', 5)}"
    units = str(history[output].attrs.get("units", "1"))
    return _cell(value, units, f"{when}, {place.text()}" if place is not None else when)


def _means(history: xr.Dataset, shown: xr.Dataset, is_window: bool) -> Iterable[Answer]:
    """What each mesh does on average, how much it varies, and what it loses."""
    told = {
        name.removeprefix(PREFIX): history[name]
        for name in map(str, history.data_vars)
        if is_window and name.startswith(PREFIX) and history[name].dims[:1] == ("mesh",)
    }
    found = {
        (e.output, e.is_largest): e.value for e in (() if is_window else extremes(history))
    }  # between the outputs, if they are told
    computed: dict[str, xr.DataArray] = {}
    for output in ("transmission_error", "normal_force"):
        computed[f"{output}_mean"] = _mean(shown[output])
        computed[f"{output}_max"] = found.get((output, True), shown[output].max("time"))
    least = found.get(("transmission_error", False), shown["transmission_error"].min("time"))
    spread = computed["transmission_error_max"] - least
    computed["transmission_error_peak_to_peak"] = spread
    with np.errstate(divide="ignore", invalid="ignore"):
        factor = computed["normal_force_max"] / computed["normal_force_mean"]
    computed["dynamic_factor"] = factor
    summaries = mesh_summaries(shown)
    if summaries:
        computed["share_no_contact"] = _of_meshes([s.apart for s in summaries])
    for row in MESH_ROWS:
        values = told.get(row.name, computed.get(row.name))
        if values is not None:
            first = values.values.reshape(values.sizes["mesh"], -1)[:, 0]
            if row.name not in ONLY_IF_ANY or first.any():
                yield _answer(row, first)
    yield from _losses(shown, [s.efficiency for s in summaries])


def _losses(shown: xr.Dataset, efficiencies: list[float | None]) -> Iterable[Answer]:
    for name, label in (("friction_loss", "friction"), ("contact_damping_loss", "damping")):
        if name in shown:
            row = Row(name, f"power lost to {label}", str(shown[name].attrs.get("symbol", "")), "W")
            yield _answer(row, _mean(shown[name]).values)
    if efficiencies:
        yield _answer(Row("efficiency", "efficiency", "eta", "%"), _of_meshes(efficiencies).values)


def _wheels(shown: xr.Dataset) -> Iterable[Answer]:
    """Speed, what turns each wheel, and what its bearing takes."""
    speed = shown["angular_velocity"]
    cells = []
    for wheel in range(shown.sizes["wheel"]):
        one = speed.isel(wheel=wheel)
        ends = [quantity(float(v), "rad s-1", DIGITS) for v in (one.min(), one.max())]
        mean = float(_mean(one))
        cells.append(_cell(mean, "rad s-1", "" if ends[0] == ends[1] else " to ".join(ends)))
    yield Answer("speed", "omega", tuple(cells))
    torques = {
        "torque of the loads": ("M", shown["load_torque"]),
        "torque of its meshes": ("", contact_torque(shown)),
        "torque of its shafts": ("", shaft_torque(shown)),
        "power of the loads": ("M omega", shown["load_torque"] * speed),
    }
    for label, (letter, values) in torques.items():
        units = "W" if label.startswith("power") else "N m"
        means = _mean(values.transpose("time", "wheel")).values
        yield Answer(label, letter, tuple(_cell(float(v), units) if v else None for v in means))
    if "bearing_force" in shown:
        size = np.linalg.norm(shown["bearing_force"].values, axis=2)
        largest, times = size.max(axis=0), shown["time"].values[size.argmax(axis=0)]
        yield Answer(
            "largest bearing force",
            "",
            tuple(
                _cell(float(v), "N", f"at {quantity(float(t), 's', 5)}") if v else None
                for v, t in zip(largest, times, strict=True)
            ),
        )


def _answer(row: Row, values: Iterable[float]) -> Answer:
    return Answer(row.label, row.symbol, tuple(_cell(float(value), row.units) for value in values))


def _cell(value: float, units: str, where: str = "") -> Cell | None:
    if not np.isfinite(value):
        return None
    if units == "%":
        return Cell(f"{100 * value:.{DIGITS}g} %", where)
    return Cell(quantity(value, units, DIGITS), where)


def _told(answers: Iterable[Answer]) -> list[Answer]:
    """Keep the rows in which something is told."""
    return [answer for answer in answers if any(cell is not None for cell in answer.cells)]


def _of_meshes(values: Sequence[float | None]) -> xr.DataArray:
    return xr.DataArray([np.nan if v is None else v for v in values], dims="mesh")


def _mean(values: xr.DataArray) -> xr.DataArray:
    """Mean over time by the trapezoidal rule."""
    return values.integrate("time") / _span(values)


def _span(shown: xr.Dataset | xr.DataArray) -> float:
    return float(shown["time"][-1] - shown["time"][0])
