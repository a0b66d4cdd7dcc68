"""Map of the root stress of a tooth over its position and the arc of its fillets."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from matplotlib import colormaps, rc_context
from matplotlib.axes import Axes
from matplotlib.cm import ScalarMappable
from matplotlib.colors import Normalize
from matplotlib.figure import Figure
from matplotlib.patheffects import withStroke
from matplotlib.ticker import MaxNLocator

from evolvent.figures.style import STYLE
from evolvent.physics.static_root_stress import LOADED, OTHER, ToothRootStress
from evolvent.units import axis_label, engineering, quantity

DARK = colormaps["magma_r"]  # lightness decreases monotonically: readable in grey as well
EDGE = 0.05  # of the height of a panel, without labels of contour lines
LEVELS = 8  # contour lines of a row of panels
FILLETS = (
    (LOADED, 1.0, "tension, fillet of the loaded flank"),
    (OTHER, -1.0, "compression, other fillet"),
)


def draw_root_map(teeth: Sequence[ToothRootStress], torque: float) -> Figure:
    """Draw tension in the fillet of the loaded flank, and compression in the other fillet.

    Parameters
    ----------
    teeth : one tooth of each wheel.
    torque : of the driving wheel [N m].
    """
    largest = max(float(np.abs(tooth.stress).max()) for tooth in teeth)
    factor, unit = engineering(largest, "Pa")
    with rc_context({**STYLE, "axes.grid": False}):
        figure = Figure(figsize=(1.8 + 4.2 * len(teeth), 7.2), layout="constrained")
        panels = figure.subplots(2, len(teeth), sharex=True, sharey="col", squeeze=False)
        for row, (fillet, sign, text) in zip(panels, FILLETS, strict=True):
            shown = [sign * tooth.stress[:, fillet].T * factor for tooth in teeth]
            ends = [float(end) for values in shown for end in (values.min(), values.max())]
            norm, levels = Normalize(0.0, max(ends)), MaxNLocator(LEVELS)
            for panel, tooth, values in zip(row, teeth, shown, strict=True):
                contours = np.asarray(levels.tick_values(min(ends), max(ends)))
                _draw(panel, tooth, values, norm, contours)
            bar = figure.colorbar(ScalarMappable(norm, DARK), ax=list(row))
            bar.set_label(axis_label(text, unit))
        for panel, tooth in zip(panels[0], teeth, strict=True):
            panel.set_title(f"wheel {tooth.wheel}", fontsize=12)
        for panel in panels[:, 0]:
            panel.set_ylabel("arc from the form circle [mm]")
        figure.supxlabel(
            "position of the tooth pair, from the start of its path [pitches]", fontsize=12
        )
        at = f"{quantity(torque, 'N m', 4)} of the driving wheel"
        heading = f"root stress of one tooth, torque {at}; circle: largest value"
        figure.suptitle(heading, x=0.01, ha="left", fontsize=11)
    return figure


def _draw(
    panel: Axes, tooth: ToothRootStress, values: np.ndarray, norm: Normalize, levels: np.ndarray
) -> None:
    """Draw a map with labelled contour lines, and its largest value."""
    arcs = tooth.arcs * 1e3
    low, high = np.quantile(arcs, (EDGE, 1.0 - EDGE))
    panel.pcolormesh(
        tooth.positions, arcs, np.maximum(values, 0.0), norm=norm, cmap=DARK, rasterized=True
    )
    lines = panel.contour(tooth.positions, arcs, values, levels, colors="#808080", linewidths=0.8)
    for label in panel.clabel(lines, fontsize=9, fmt="%g", colors="#222222"):
        label.set_path_effects([withStroke(linewidth=2.0, foreground="white")])
        if not low < label.get_position()[1] < high:  # its panel would clip it
            label.remove()
    arc, position = np.unravel_index(int(values.argmax()), values.shape)
    panel.plot(
        tooth.positions[position],
        arcs[arc],
        "o",
        markersize=6,
        markerfacecolor="white",
        markeredgecolor="black",
        clip_on=False,
        zorder=4,
    )
