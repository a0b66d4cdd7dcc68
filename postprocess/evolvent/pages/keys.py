"""Band below an animation: legend, and scales of lengths, forces and speeds."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np
from matplotlib.axes import Axes
from matplotlib.patches import Polygon

from evolvent.pages.shapes import arrow, round_below
from evolvent.units import quantity

LEFT = 0.02  # of the picture's width
SMALL = 9.5  # font size [points]


class Scale(NamedTuple):
    """One line of the band: the value that an arrow of some length represents."""

    largest: float  # largest visible value
    per_unit: float  # length in the picture of one unit
    units: str
    colour: str  # of its arrow; "" for a bar


def draw_keys(
    keys: Axes, scales: Sequence[Scale], width: float, aspect: float, entries: Sequence[Any]
) -> None:
    """Draw the scales on the left and the legend on the right.

    Parameters
    ----------
    keys : axes of the band, from 0 to the picture's width and from 0 to 1.
    width : of an arrow.
    aspect : height of the band in lengths of the picture.
    entries : handles of the legend.
    """
    shown = [scale for scale in scales if scale.largest > 0]
    wide = keys.get_xlim()[1]
    at = LEFT * wide
    sizes = [round_below(scale.largest) for scale in shown]
    longest = max(size * scale.per_unit for size, scale in zip(sizes, shown, strict=True))
    for number, (size, scale) in enumerate(zip(sizes, shown, strict=True)):
        height = 1.0 - (number + 0.6) / max(len(shown), 3)
        length = size * scale.per_unit
        if scale.colour:
            outline = arrow(0j, length, width)
            shape = np.stack([at + outline.real, height + outline.imag / aspect], axis=1)
            keys.add_patch(Polygon(shape, facecolor=scale.colour, edgecolor="white", linewidth=0.6))
        else:
            bar: dict[str, Any] = {"color": "black", "linewidth": 2, "marker": "|"}
            keys.plot([at, at + length], [height, height], **bar)
        keys.text(
            at + longest + 0.015 * wide, height, quantity(size, scale.units, 3), va="center",
            fontsize=SMALL,
        )  # fmt: skip
    keys.legend(
        handles=list(entries),
        loc="center right",
        ncols=2,
        fontsize=SMALL,
        columnspacing=1.0,
        handlelength=1.6,
        labelspacing=0.35,
        bbox_to_anchor=(0.995, 0.5),
        borderaxespad=0.0,
    )
