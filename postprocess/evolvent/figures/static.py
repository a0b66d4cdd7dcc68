"""Curves of a static analysis: over the mesh cycle and over the torque."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
import xarray as xr
from matplotlib import colormaps, rc_context
from matplotlib.cm import ScalarMappable
from matplotlib.colors import ListedColormap, Normalize
from matplotlib.figure import Figure

from evolvent.figures.style import LINES, STYLE, legend
from evolvent.units import axis_label, engineering, quantity

# Light to dark: a larger torque is darker, and the lightest is visible on white.
TORQUES = ListedColormap(colormaps["viridis_r"](np.linspace(0.12, 1.0, 256)))
MOST_NAMED = 5  # torques that a legend names; more get a colour bar
SHOWN_HARMONICS = 3
PATH: dict[str, Any] = {"color": "#777777", "linewidth": 1.0, "linestyle": ":"}
TORQUE = "torque of the driving wheel"
CYCLE = "position in the mesh cycle [pitches]"


def draw_curves(static: xr.Dataset, shown: Mapping[str, str]) -> Figure:
    """Draw variables over the mesh cycle, one panel each and a line for each torque.

    Parameters
    ----------
    static : with the variables, dims (torque, position).
    shown : their labels by name.
    """
    with rc_context(STYLE):
        figure = Figure(figsize=(7.5, 1.2 + 3.0 * len(shown)), layout="constrained")
        panels = figure.subplots(len(shown), 1, sharex=True, squeeze=False)[:, 0]
        factor, unit = engineering(
            np.concatenate([static[name].values.ravel() for name in shown]),
            str(static[next(iter(shown))].attrs["units"]),
        )
        for panel, (name, label) in zip(panels, shown.items(), strict=True):
            x, values = closed_cycle(static, static[name].values)
            for style, line in zip(styles(static), values, strict=True):
                panel.plot(x, line * factor, **style)
            panel.set_ylabel(axis_label(label, unit))
            panel.set_xlim(x[0], x[-1])
        panels[-1].set_xlabel(CYCLE)
        name_torques(figure, static, list(panels))
    return figure


def draw_sharing(static: xr.Dataset) -> Figure:
    """Draw the force share of tooth pair 0 over its position, a line for each torque.

    Parameters
    ----------
    static : with force_share and pair_contact_kind, dims (torque, position, pair), contact_ratio.
    """
    x, share = path_of_pair(static, static["force_share"].values)
    end = float(static["contact_ratio"])
    with rc_context(STYLE):
        figure = Figure(figsize=(7.5, 4.4), layout="constrained")
        panel = figure.subplots()
        for style, line in zip(styles(static), share, strict=True):
            panel.plot(x, line, **style)
        for position, text in ((0.0, "start of the path"), (end, "end")):
            panel.axvline(position, **PATH)
            panel.annotate(
                text,
                (position, 1.0),
                xytext=(3, -3),
                xycoords=("data", "axes fraction"),
                textcoords="offset points",
                va="top",
                fontsize=10,
                color="#555555",
            )
        panel.set_xlabel("position of the tooth pair, from the start of its path [pitches]")
        panel.set_ylabel("share of the force")
        reach = x[(share > 0).any(axis=0)]
        panel.set_xlim(min(reach[0], 0.0) - 0.05, max(reach[-1], end) + 0.15)
        panel.set_ylim(0.0, 1.12)
        name_torques(figure, static, [panel])
    return figure


def draw_roots(static: xr.Dataset) -> Figure:
    """Draw the largest and the least root stress over the mesh cycle, a column for each wheel.

    The panels below have the arc of the largest one in the fillet, from the form circle. Lines end
    where another tooth takes over.

    Parameters
    ----------
    static : with root_stress_max, root_stress_min [Pa], root_stress_max_arc [m] and
        root_stress_max_tooth, dims (torque, position, wheel); NaN of a wheel without finite
        elements.
    """
    stress = static["root_stress_max"]
    wheels = [name for name in static["wheel"].values if stress.sel(wheel=name).notnull().any()]
    factor, unit = engineering(stress.values[np.isfinite(stress.values)], "Pa")
    with rc_context(STYLE):
        figure = Figure(figsize=(1.5 + 4.5 * len(wheels), 6.6), layout="constrained")
        panels = figure.subplots(
            2, len(wheels), sharex=True, sharey="row", squeeze=False, height_ratios=(3, 2)
        )
        for (above, below), wheel in zip(panels.T, wheels, strict=True):
            of_wheel = static.sel(wheel=wheel)
            for values, side in (
                ("root_stress_max", "tension"),
                ("root_stress_min", "compression"),
            ):
                x, lines = closed_cycle(static, of_wheel[values].values * factor)
                for style, line in zip(styles(static), lines, strict=True):
                    above.plot(x, line, **(style if side == "tension" else {**style, "label": ""}))
                _name_side(above, side)
            _, teeth = closed_cycle(static, of_wheel["root_stress_max_tooth"].values)
            _, arcs = closed_cycle(static, of_wheel["root_stress_max_arc"].values * 1e3)
            for style, line in zip(styles(static), _parted(arcs, teeth), strict=True):
                below.plot(x, line, **style)
            above.axhline(0.0, color="#555555", linewidth=0.8)
            above.set_title(f"wheel {wheel}", fontsize=12)
            below.set_xlabel(CYCLE)
            below.set_xlim(x[0], x[-1])
        panels[0, 0].set_ylabel(axis_label("root stress", unit))
        panels[1, 0].set_ylabel("arc of the tension, from\nthe form circle [mm]")
        name_torques(figure, static, list(panels.ravel()))
    return figure


def _name_side(panel: Any, side: str) -> None:
    """Name the curves on one side of zero."""
    up = side == "tension"
    panel.annotate(
        side,
        (0.01, 0.0),
        xytext=(0, 4 if up else -4),
        xycoords=("axes fraction", "data"),
        textcoords="offset points",
        va="bottom" if up else "top",
        fontsize=10,
        color="#555555",
    )


def _parted(values: np.ndarray, teeth: np.ndarray) -> np.ndarray:
    """Values (torque, position) without the first one of each other tooth, where a line ends."""
    parted = values.copy()
    parted[:, 1:][teeth[:, 1:] != teeth[:, :-1]] = np.nan
    return parted


def draw_harris(static: xr.Dataset) -> Figure:
    """Draw peak-to-peak value and first harmonics of the transmission error over the torque.

    Parameters
    ----------
    static : with peak_to_peak_transmission_error [m] (torque) and harmonic_amplitude [m]
        (torque, harmonic).
    """
    torque = static["torque"].values
    spread = static["peak_to_peak_transmission_error"].values
    factor, unit = engineering(spread, "m")
    scale, torque_unit = engineering(torque, "N m")
    curves = {"peak to peak": spread}
    for n in static["harmonic"].values[:SHOWN_HARMONICS]:
        curves[f"harmonic {n}, amplitude"] = static["harmonic_amplitude"].sel(harmonic=n).values
    with rc_context(STYLE):
        figure = Figure(figsize=(7.5, 4.4), layout="constrained")
        panel = figure.subplots()
        for style, (label, values) in zip(LINES, curves.items(), strict=False):
            panel.plot(torque * scale, values * factor, label=label, **style)
        panel.set_xlabel(axis_label(TORQUE, torque_unit))
        panel.set_ylabel(axis_label("transmission error", unit))
        panel.set_xlim(*reach(torque * scale))
        panel.set_ylim(bottom=0.0)
        handles, labels = panel.get_legend_handles_labels()
        legend(figure, dict(zip(labels, handles, strict=True)))
    return figure


def closed_cycle(static: xr.Dataset, values: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Positions and values (torque, position), with the first one repeated at the end."""
    x = static["position"].values
    end = float(static.attrs["pitches"])
    return np.append(x, end), np.concatenate([values, values[:, :1]], axis=1)


def path_of_pair(static: xr.Dataset, values: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Follow tooth pair 0 through the pair slots.

    Parameters
    ----------
    static : with position [pitches] and pair.
    values : dims (torque, position, pair).

    Returns
    -------
    Position of the pair from the start of its path [pitches], values (torque, position).
    """
    points, pitches = int(static.attrs["points"]), int(static.attrs["pitches"])
    positions, parts = [], []
    for i, ahead in enumerate(static["pair"].values):
        first = points * (int(ahead) % pitches)
        positions.append(ahead + np.arange(points) / points)
        parts.append(values[:, first : first + points, i])
    return np.concatenate(positions), np.concatenate(parts, axis=1)


def styles(static: xr.Dataset) -> list[dict[str, Any]]:
    """Line style of each torque."""
    torque = static["torque"].values
    if torque.size <= MOST_NAMED:
        return [
            {**line, "label": quantity(value, "N m", 4)}
            for line, value in zip(LINES, torque, strict=False)
        ]
    return [{"color": TORQUES(Normalize(*reach(torque))(value))} for value in torque]


def reach(torque: np.ndarray) -> tuple[float, float]:
    """Limits of a torque axis, which includes 0."""
    return min(0.0, float(torque.min())), max(0.0, float(torque.max()))


def name_torques(figure: Figure, static: xr.Dataset, panels: list[Any]) -> None:
    """Identify the lines by torque: a legend for few, a colour bar for many."""
    torque = static["torque"].values
    if torque.size <= MOST_NAMED:
        handles, labels = panels[0].get_legend_handles_labels()
        legend(figure, dict(zip(labels, handles, strict=True)))
        return
    factor, unit = engineering(torque, "N m")
    colours = ScalarMappable(Normalize(*reach(torque * factor)), TORQUES)
    figure.colorbar(colours, ax=panels, label=axis_label(TORQUE, unit))
