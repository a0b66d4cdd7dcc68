"""Label placement: near the labelled object, inside the picture, without overlap."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from matplotlib.axes import Axes
from matplotlib.text import Text
from matplotlib.transforms import Bbox, BboxBase

GRID = 48  # candidate positions along each side of the picture
APART = 3.0  # minimum distance of two labels, and from the edge [pixels]
LARGEST = 11.0  # font size [points]
SMALLEST = 6.0  # below it a label is omitted


@dataclass(frozen=True)
class AnchoredLabel:
    """A label and its preferred position."""

    text: Text  # with the longest text that it will have
    anchor: complex  # preferred centre, in the axes' coordinates


def set_labels(axes: Axes, labels: Sequence[AnchoredLabel], taken: Sequence[Bbox] = ()) -> None:
    """Move labels to the free positions nearest to their anchors.

    Parameters
    ----------
    taken : boxes in the axes' coordinates that labels avoid if there is space elsewhere.

    Labels are placed in order. The font size decreases where there is no space; a label that does
    not fit in the smallest size is hidden.
    """
    drawn = [box.transformed(axes.transData) for box in taken]
    occupied: list[Bbox] = []
    for label in labels:
        box = _fitting(axes, label, drawn, occupied)
        label.text.set_visible(box is not None)
        if box is not None:
            occupied.append(box)


def _fitting(
    axes: Axes, label: AnchoredLabel, drawn: list[Bbox], occupied: list[Bbox]
) -> Bbox | None:
    """Reduce the font size of a label until it fits, and move it."""
    size = LARGEST
    while size >= SMALLEST:
        label.text.set_fontsize(size)
        for obstacles in (drawn + occupied, occupied):
            box = _free(axes, label, obstacles)
            if box is not None:
                middle = axes.transData.inverted().transform(_corners(box).mean(axis=0))
                label.text.set_position((float(middle[0]), float(middle[1])))
                return box
        size *= 0.9
    return None


def _free(axes: Axes, label: AnchoredLabel, obstacles: list[Bbox]) -> Bbox | None:
    """Return the free box nearest to the anchor; boxes are in pixels."""
    extent = label.text.get_window_extent()
    half = np.array([extent.width / 2 + APART, extent.height / 2 + APART])
    low, high = _corners(axes.bbox)
    if (low + half > high - half).any():
        return None
    anchor = axes.transData.transform((label.anchor.real, label.anchor.imag))
    sides = [np.linspace(a, b, GRID) for a, b in zip(low + half, high - half, strict=True)]
    grid = np.stack(np.meshgrid(*sides), axis=-1).reshape(-1, 2)
    positions = np.concatenate([[np.clip(anchor, low + half, high - half)], grid])
    free = np.ones(len(positions), bool)
    for box in obstacles:
        begin, end = _corners(box)
        away = np.abs(positions - (begin + end) / 2)
        free &= (away >= (end - begin) / 2 + half).any(axis=1)
    if not free.any():
        return None
    distance = np.where(free, np.linalg.norm(positions - anchor, axis=1), np.inf)
    middle = positions[int(distance.argmin())]
    return Bbox([middle - half + APART, middle + half - APART])


def _corners(box: BboxBase) -> np.ndarray:
    """Lower left and upper right corner, shape (2, 2)."""
    return np.array([[box.xmin, box.ymin], [box.xmax, box.ymax]])
