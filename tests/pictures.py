"""Layout errors of figures: clipped or overlapping texts and marks, duplicate styles, bare axes."""

from __future__ import annotations

from itertools import combinations
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.transforms import Bbox

PIXEL = 1.0  # texts are positioned at whole pixels


def faults(figure: Figure) -> list[str]:
    """Describe all layout errors of a figure."""
    canvas = FigureCanvasAgg(figure)
    canvas.draw()
    texts = _texts(figure, canvas.get_renderer())
    found = [f"clipped: {name}" for name, box in texts if not _inside(box, figure.bbox)]
    found += [
        f"collide: {one} and {other}"
        for (one, a), (other, b) in combinations(texts, 2)
        if _overlap(a, b)
    ]
    for axes in figure.axes:
        if axes.get_visible():
            found += [*_clipped_marks(figure, axes), *_same_styles(axes), *_bare_axes(axes)]
    return found


def _texts(figure: Figure, renderer: Any) -> list[tuple[str, Bbox]]:
    """Names and boxes of all texts: legends as a whole, and visible ticks of axes."""
    artists: list[Any] = [*figure.texts, figure._suptitle, figure._supxlabel]
    for axes in filter(Axes.get_visible, figure.axes):
        artists += [axes.title, axes._left_title, axes.xaxis.label, axes.yaxis.label, *axes.texts]
        artists += [axis.get_offset_text() for axis in (axes.xaxis, axes.yaxis)]
        for axis in (axes.xaxis, axes.yaxis):
            low, high = sorted(axis.get_view_interval())
            artists += [
                tick.label2 if tick.label2.get_visible() else tick.label1
                for tick in axis.get_major_ticks()
                if low <= tick.get_loc() <= high
                and (tick.label1.get_visible() or tick.label2.get_visible())
            ]
    seen = {id(a): a for a in artists if a is not None and a.get_visible() and a.get_text()}
    boxes = [(a.get_text(), a.get_window_extent(renderer)) for a in seen.values()]
    legends = [*figure.legends, *(a.get_legend() for a in figure.axes if a.get_legend())]
    for legend in legends:
        boxes.append(("legend", legend.get_window_extent(renderer)))
    return boxes


def _inside(box: Bbox, outer: Bbox) -> bool:
    return bool(
        box.x0 >= outer.x0 - PIXEL
        and box.y0 >= outer.y0 - PIXEL
        and box.x1 <= outer.x1 + PIXEL
        and box.y1 <= outer.y1 + PIXEL
    )


def _overlap(a: Bbox, b: Bbox) -> bool:
    wide = min(a.x1, b.x1) - max(a.x0, b.x0)
    high = min(a.y1, b.y1) - max(a.y0, b.y0)
    return bool(wide > PIXEL and high > PIXEL)


def _clipped_marks(figure: Figure, axes: Axes) -> list[str]:
    """Marks clipped by the edge of a panel or of the figure."""
    found = []
    for line in axes.lines:
        if line.get_marker() in ("None", "", " ", None) or line.get_linestyle() != "None":
            continue
        points = line.get_transform().transform(np.column_stack(line.get_data(orig=False)))
        half = line.get_markersize() * figure.dpi / 72 / 2
        outer = axes.bbox if line.get_clip_on() else figure.bbox
        for x, y in points[np.isfinite(points).all(axis=1)]:
            if not _inside(Bbox([[x - half, y - half], [x + half, y + half]]), outer):
                found.append(f"clipped: mark of {line.get_label()} at {x:.0f}, {y:.0f}")
    return found


def _same_styles(axes: Axes) -> list[str]:
    """Labels of lines with equal style; labels starting with _ are in no legend."""
    looks: dict[Any, set[str]] = {}
    for line in axes.lines:
        if not str(line.get_label()).startswith("_") and len(line.get_xdata()):
            looks.setdefault(style_of(line), set()).add(str(line.get_label()))
    return [f"one style: {sorted(names)}" for names in looks.values() if len(names) > 1]


def style_of(line: Line2D) -> tuple[Any, ...]:
    """Properties that distinguish a line from others."""
    return (
        line.get_color(),
        str(line._unscaled_dash_pattern),
        str(line.get_marker()),
        line.get_linestyle(),
        str(line.get_markeredgecolor()),
        str(line.get_markerfacecolor()),
        line.get_linewidth(),
    )


def _bare_axes(axes: Axes) -> list[str]:
    found = []
    for axis in (axes.xaxis, axes.yaxis):
        low, high = sorted(axis.get_view_interval())
        numbers = [
            tick.label1.get_text() or tick.label2.get_text()
            for tick in axis.get_major_ticks()
            if low <= tick.get_loc() <= high
        ]
        is_shown = any(
            t.label1.get_visible() or t.label2.get_visible() for t in axis.get_major_ticks()
        )
        if axis.get_scale() == "log" and is_shown and len(list(filter(None, numbers))) < 2:
            found.append(f"logarithmic axis with ticks {numbers}")
    return found
