"""A picture of a gearbox at any output: wheels, lines of action, and forces on the teeth."""

from __future__ import annotations

from typing import Any

import numpy as np
import xarray as xr
from matplotlib import rc_context
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.collections import PolyCollection
from matplotlib.colors import to_rgba
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Patch, Polygon

from evolvent.errors import HistoryError
from evolvent.figures.style import STYLE
from evolvent.history import require, source_name
from evolvent.physics.teeth import DrawnMesh, DrawnWheel, drawn_meshes, drawn_wheels
from evolvent.units import quantity

# Light enough for the arrows on them, and told apart by a grey printer.
FILLS = ("#b9cbe0", "#f2dcc0", "#d5e6c9", "#e3d3ea")
EDGE, FORCE, ACTION = "#3a4654", "#b3122f", "#1f6f9f"
WIDTH, TOP, BOTTOM = 7.2, 0.42, 0.98  # of the picture and the bands above and below it [inch]
HEIGHTS = (2.6, 6.2)  # least and largest of the drawing between them [inch]
COAST: Any = (0, (2, 2))  # dashes of the coast flanks' lines
LONGEST = 0.17  # length of the arrow of the largest force, of the picture's smaller side
AROUND = 1.35  # half of the height of a zoom over the longer of path of contact and base pitch


class Scene:
    """A picture of the gearbox, or of one mesh of it, that shows any output of a history.

    Parameters
    ----------
    history : with the static variables of the teeth, the motion and the forces of tooth pairs.
    mesh : number of the mesh to zoom on; the whole gearbox if None.
    largest : force whose arrow is the longest [N].
    speed : shown beside the time, if given.
    exaggeration : factor of the deviations of the flanks.
    """

    def __init__(
        self,
        history: xr.Dataset,
        mesh: int | None = None,
        largest: float = 0.0,
        speed: float | None = None,
        exaggeration: float = 1.0,
    ) -> None:
        check_teeth(history)
        self.history, self.exaggeration, self.largest = history, exaggeration, largest
        self.wheels = drawn_wheels(history)
        self.meshes = drawn_meshes(history)
        self.zoomed = mesh is not None
        self.shown = range(len(self.meshes)) if mesh is None else range(mesh, mesh + 1)
        self.visible = range(len(self.wheels)) if mesh is None else self.meshes[mesh].wheels
        self.box = self._whole() if mesh is None else self._around(self.meshes[mesh])
        with rc_context(STYLE | {"axes.grid": False}):
            self._lay_out(speed)
            self._add_artists()
            self._add_keys()

    def show(self, row: int) -> Figure:
        """Move everything to output number `row` and return the figure."""
        history = self.history
        turned = require(history, "angle").values[row]
        moved = require(history, "centre_displacement").values[row]
        for number, (patch, mark) in self.artists.items():
            wheel, angle, shift = (
                self.wheels[number],
                float(turned[number]),
                complex(*moved[number]),
            )
            patch.set_xy(_xy(wheel.outline(angle, shift, self.exaggeration)))
            spoke = np.array([0.6, 0.75]) * wheel.radius * np.exp(1j * angle)
            mark.set_data(*_xy(wheel.centre + shift + spoke).T)
        arrows, points, loads = [], [], []
        for number, lines in zip(self.shown, self.lines, strict=True):
            mesh = self.meshes[number]
            shifts = mesh.shifts(history, row)
            for coast, (whole, path) in enumerate(lines):
                start, along, length = mesh.line(bool(coast), shifts)
                whole.set_data(*_xy(start + along * np.array([0.0, length])).T)
                path.set_data(*_xy(start + along * np.array(mesh.path)).T)
            touching = loaded_pairs(history, mesh, number, row, self)
            loads.append(float(require(history, "normal_force").values[row, number]))
            for point, force in touching:
                points.append(point)
                for on_wheel in (-force, force):
                    arrows.append(_arrow(point, on_wheel * self.per_newton, self.arrow_width))
        self.arrows.set_verts([_xy(arrow) for arrow in arrows])
        self.contacts.set_data(*(_xy(np.array(points)).T if points else ([], [])))
        self.clock.set_text(f"t = {float(history['time'][row]):.{self.decimals}f} s")
        if len(loads) == 1:
            count = len(touching)
            pairs = f"{count} tooth pair{'' if count == 1 else 's'} loaded"
            self.load.set_text(f"{pairs}: {quantity(loads[0], 'N', 3)}" if count else "no contact")
        return self.figure

    def _whole(self) -> tuple[float, float, float, float]:
        centres = np.array([wheel.centre for wheel in self.wheels])
        radii = np.array([wheel.radius for wheel in self.wheels])
        x, y = ((c - radii, c + radii) for c in (centres.real, centres.imag))
        return _fitted((x[0].min(), x[1].max()), (y[0].min(), y[1].max()), 0.03)

    def _around(self, mesh: DrawnMesh) -> tuple[float, float, float, float]:
        start, along, _ = mesh.line(False, (0j, 0j))
        middle = start + along * sum(mesh.path) / 2
        pitch = float(require(self.history, "base_pitch")[self.meshes.index(mesh)])
        half = AROUND * max(mesh.path[1] - mesh.path[0], pitch)
        x = middle.real - 1.25 * half, middle.real + 1.25 * half
        return _fitted(x, (middle.imag - half, middle.imag + half), 0.0)

    def _lay_out(self, speed: float | None) -> None:
        x0, x1, y0, y1 = self.box
        height = WIDTH * (y1 - y0) / (x1 - x0)
        total = TOP + height + BOTTOM
        # whole and even numbers of pixels at any usual resolution: videos need them
        total = np.ceil(total * 10) / 10
        self.figure = Figure(figsize=(WIDTH, total), facecolor="white")
        FigureCanvasAgg(self.figure)
        self.axes = self.figure.add_axes((0, 1 - (TOP + height) / total, 1, height / total))
        self.axes.set(xlim=(x0, x1), ylim=(y0, y1), xticks=[], yticks=[])
        self.axes.spines[["left", "right"]].set_visible(False)
        self.axes.spines[["top", "bottom"]].set_color("#aaaaaa")
        self.keys = self.figure.add_axes((0, 0, 1, 1 - (TOP + height) / total))
        self.keys.set(xlim=(0, x1 - x0), ylim=(0, 1))
        self.keys.set_axis_off()
        at = 1 - TOP / 2 / total
        self.clock = self.figure.text(0.015, at, "", va="center", fontsize=12)
        self.load = self.figure.text(0.34, at, "", va="center", fontsize=12)
        step = np.median(np.diff(self.history["time"].values)) if self.history.time.size > 1 else 1
        self.decimals = int(np.clip(np.ceil(-np.log10(step)), 0, 9))
        if speed is not None:
            text = _pace(speed)
            self.figure.text(0.985, at, text, va="center", ha="right", fontsize=11, color="#555555")

    def _add_artists(self) -> None:
        axes = self.axes
        self.artists: dict[int, tuple[Polygon, Line2D]] = {}
        self.lines: list[list[tuple[Line2D, Line2D]]] = []
        # of wheels one behind the other, the smaller ones are in front
        behind = np.argsort([-wheel.radius for wheel in self.wheels]).argsort()
        for number in self.visible:
            wheel = self.wheels[number]
            fill = to_rgba(FILLS[number % len(FILLS)], 1.0 if len(self.visible) <= 2 else 0.6)
            disc = wheel.profile is None
            depth = 1 + behind[number] / len(self.wheels)
            patch = Polygon(np.zeros((3, 2)), zorder=depth, edgecolor=EDGE, linewidth=1.0)
            patch.set(facecolor="none" if disc else fill, linestyle="--" if disc else "-")
            (mark,) = axes.plot([], [], color=EDGE, linewidth=2.5, zorder=depth + 0.01)
            axes.add_patch(patch)
            self.artists[number] = patch, mark
        self._name_wheels()
        for number in self.shown:
            flanks = []
            for coast in range(1 + self.meshes[number].has_coast):
                style: dict[str, Any] = {"color": ACTION, "linestyle": COAST if coast else "-"}
                (whole,) = axes.plot([], [], linewidth=0.9, zorder=3, **style)
                (path,) = axes.plot([], [], linewidth=2.6, zorder=3, **style)
                flanks.append((whole, path))
            self.lines.append(flanks)
        self.arrows = PolyCollection(
            [], facecolor=FORCE, edgecolor="white", linewidth=0.6, zorder=5
        )
        axes.add_collection(self.arrows, autolim=False)
        (self.contacts,) = axes.plot([], [], "o", color="black", markersize=3.5, zorder=6)

    def _name_wheels(self) -> None:
        """Name the wheels: those on one axis together, the smallest first."""
        axles: dict[complex, list[DrawnWheel]] = {}
        for number in self.visible:
            wheel = self.wheels[number]
            nearest = min(axles, key=lambda c: abs(c - wheel.centre), default=None)
            if nearest is None or abs(nearest - wheel.centre) > 1e-6 * wheel.radius:
                nearest = wheel.centre
            axles.setdefault(nearest, []).append(wheel)
        for centre, wheels in axles.items():
            wheels.sort(key=lambda wheel: wheel.radius)
            place = self._place_of_name(centre, wheels[-1].radius)
            if place is None:
                continue
            self.axes.plot(centre.real, centre.imag, "+", color=EDGE, zorder=4)
            names = "\n".join(wheel.name for wheel in wheels)
            self.axes.text(
                place.real,
                place.imag,
                names,
                ha="center",
                va="top",
                fontsize=12,
                zorder=4,
                clip_on=True,
            )

    def _place_of_name(self, centre: complex, radius: float) -> complex | None:
        """Below the centre, or where a zoom shows the wheel best: away from its mate."""
        x0, x1, y0, y1 = self.box
        if x0 < centre.real < x1 and y0 < centre.imag < y1:
            return centre - 0.025j * (y1 - y0)
        middle = complex((x0 + x1) / 2, (y0 + y1) / 2)
        towards = (centre - middle) / abs(centre - middle)
        reach = min(
            (x1 - x0) / max(abs(towards.real), 1e-9), (y1 - y0) / max(abs(towards.imag), 1e-9)
        )
        place = middle + 0.37 * reach * towards
        return place if abs(place - centre) < radius else None

    def _add_keys(self) -> None:
        """Below the picture: what is what, a length and a force to scale."""
        wide = self.box[1] - self.box[0]
        small = min(wide, self.box[3] - self.box[2])
        self.arrow_width = 0.011 * small
        longest = LONGEST * small
        if self.zoomed:
            # arrows of neighbouring tooth pairs, a base pitch apart, do not overlap
            pitch = require(self.history, "base_pitch").values[self.shown[0]]
            longest = min(longest, 0.46 * float(pitch))
        self.per_newton = longest / self.largest if self.largest > 0 else 0.0
        length = _round_below(wide / 5)
        keys: Axes = self.keys
        at = 0.03 * wide
        keys.plot([at, at + length], [0.78, 0.78], color="black", linewidth=2, marker="|")
        keys.text(at, 0.5, quantity(length, "m", 3), va="center", fontsize=10)
        if self.largest > 0:
            force = _round_below(self.largest)
            tall = (self.box[3] - self.box[2]) * BOTTOM / (self.axes.get_position().height)
            tall /= self.figure.get_size_inches()[1]  # height of the band in lengths of the picture
            arrow = _arrow(0j, force * self.per_newton, self.arrow_width)
            shape = np.stack([at + arrow.real, 0.27 + arrow.imag / tall], axis=1)
            keys.add_patch(Polygon(shape, facecolor=FORCE, edgecolor="white", linewidth=0.6))
            keys.text(at, 0.06, quantity(force, "N", 3), va="center", fontsize=10)
        entries: list[Any] = [
            Line2D([], [], color=ACTION, linewidth=0.9, label="line of action"),
            Line2D([], [], color=ACTION, linewidth=2.6, label="path of contact"),
        ]
        if any(self.meshes[m].has_coast for m in self.shown):
            label = "the same, coast flanks"
            entries.append(Line2D([], [], color=ACTION, linestyle=COAST, label=label))
        entries.append(Patch(facecolor=FORCE, label="force on the tooth it lies in"))
        if self.exaggeration != 1.0:
            label = f"deviations {self.exaggeration:g} times"
            entries.append(Line2D([], [], color=EDGE, linewidth=1.0, label=label))
        keys.legend(
            handles=entries,
            loc="center right",
            ncols=2,
            fontsize=10,
            columnspacing=1.2,
            bbox_to_anchor=(0.995, 0.5),
            borderaxespad=0.0,
        )


def check_teeth(history: xr.Dataset) -> None:
    """Refuse a history from before the teeth were written down."""
    if "flank_root_driving" not in history:
        raise HistoryError(
            f"{source_name(history)}: does not tell where the teeth are; run the case again with "
            "this version of evolvent"
        )


def loaded_pairs(
    history: xr.Dataset, mesh: DrawnMesh, number: int, row: int, scene: Scene | None = None
) -> list[tuple[complex, complex]]:
    """Where tooth pairs carry load, and the force on the driven wheel there, friction included.

    Parameters
    ----------
    history : with pair_position [m], pair_normal_force and pair_friction_force [N].
    mesh, number : the mesh and its number in the history.
    row : output.
    scene : whose exaggerated deviations move the points; the perfect flanks if None.

    Returns
    -------
    Points [m] and forces [N] in the housing frame. The driving wheel feels the opposite.

    Source: docs/theory.md, forces: -F_n e + F_t t on the driving wheel.
    """
    names = [str(name) for name in history["pair"].values]
    normal = require(history, "pair_normal_force").values[row, number]
    friction = require(history, "pair_friction_force").values[row, number]
    position = require(history, "pair_position").values[row, number]
    found = []
    for place, name in enumerate(names):
        if not normal[place] > 0:
            continue
        coast = name.startswith("coast")
        start, along, _ = mesh.line(coast, mesh.shifts(history, row))
        across = (start - mesh.centres[0] - mesh.shifts(history, row)[0]) / mesh.base_radii[0]
        rho = float(position[place])
        profile = scene.wheels[mesh.wheels[0]].profile if scene is not None else None
        if scene is not None and profile is not None:
            rho -= scene.exaggeration * float(profile.deviation(np.array(rho)))
        force = complex(normal[place] * along - friction[place] * across)
        found.append((complex(start + rho * along), force))
    return found


def _fitted(
    x: tuple[float, float], y: tuple[float, float], margin: float
) -> tuple[float, float, float, float]:
    """Widen a box by a margin, and until its shape gives a height among `HEIGHTS`."""
    wide, high = ((1 + 2 * margin) * (end - begin) for begin, end in (x, y))
    high = max(high, wide * HEIGHTS[0] / WIDTH)
    wide = max(wide, high * WIDTH / HEIGHTS[1])
    middle = sum(x) / 2, sum(y) / 2
    return (
        middle[0] - wide / 2, middle[0] + wide / 2, middle[1] - high / 2, middle[1] + high / 2,
    )  # fmt: skip


def _arrow(tail: complex, vector: complex, width: float) -> np.ndarray:
    """Outline of an arrow; the head of a short one shrinks with it."""
    length = abs(vector)
    if length == 0.0:
        return np.full(7, tail)
    head = min(4.0 * width, 0.6 * length)
    half = width / 2 * min(1.0, head / (4.0 * width) + 0.4)
    flat = np.array([
        -1j * half, length - head - 1j * half, length - head - 1j * head / 2.4, length,
        length - head + 1j * head / 2.4, length - head + 1j * half, 1j * half,
    ])  # fmt: skip
    return np.asarray(tail + flat * vector / length)


def _round_below(value: float) -> float:
    """The largest of 1, 2, 5 times a power of ten that is not above a value."""
    power = 10.0 ** np.floor(np.log10(value))
    return float(max(step * power for step in (1, 2, 5) if step * power <= value * (1 + 1e-9)))


def _pace(speed: float) -> str:
    if abs(speed - 1) < 0.005:
        return "real time"
    return f"slowed down {1 / speed:.3g} times" if speed < 1 else f"sped up {speed:.3g} times"


def _xy(points: Any) -> np.ndarray:
    return np.stack([np.real(points), np.imag(points)], axis=-1)
