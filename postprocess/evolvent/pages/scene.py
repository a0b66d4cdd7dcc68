"""Picture of a gearbox at any output: loads of the wheels, forces and sliding on the teeth."""

from __future__ import annotations

from typing import Any

import numpy as np
import xarray as xr
from matplotlib import rc_context
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.collections import PolyCollection
from matplotlib.colors import to_rgba
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Patch, Polygon
from matplotlib.patheffects import withStroke
from matplotlib.text import Text
from matplotlib.transforms import Bbox

from evolvent.errors import HistoryError
from evolvent.figures.style import STYLE
from evolvent.history import require, source_name
from evolvent.pages.keys import Scale, draw_keys
from evolvent.pages.labels import AnchoredLabel, set_labels
from evolvent.pages.scales import Largest
from evolvent.pages.shapes import arrow, curved_arrow, xy
from evolvent.pages.touching import touching
from evolvent.physics.teeth import DrawnMesh, drawn_meshes, drawn_wheels
from evolvent.units import quantity

# Light behind the arrows, and distinguishable in grey print.
FILLS = ("#b9cbe0", "#f2dcc0", "#d5e6c9", "#e3d3ea")
EDGE, ACTION = "#3a4654", "#1f6f9f"
FORCE, SLIDES, DRIVES, BRAKES = "#b3122f", "#e07b00", "#2e7d32", "#6a3d9a"
WIDTH, TOP, BOTTOM = 7.2, 0.42, 1.1  # of the picture, and of the bands above and below it [inch]
HEIGHTS = (2.6, 6.2)  # minimum and maximum height of the drawing between them [inch]
COAST: Any = (0, (2, 2))  # dash pattern for the lines of the coast flanks
LONGEST = 0.17  # length of the arrow of the largest force, relative to the picture's smaller side
AROUND = 1.35  # half the height of a zoom over the larger of path of contact and base pitch
OUTLINED: Any = [withStroke(linewidth=2.5, foreground="white", alpha=0.8)]
LONGEST_TORQUE = "\nbrakes with 888 mN m"


class Scene:
    """Picture of the gearbox, or of one of its meshes, for any output of a history.

    Parameters
    ----------
    history : with the static variables of the teeth, the motion and the forces of tooth pairs.
    mesh : index of the mesh to zoom on; the whole gearbox if None.
    largest : values of the longest arrows.
    speed : shown beside the time, if given.
    exaggeration : factor of the deviations of the flanks.
    """

    def __init__(
        self,
        history: xr.Dataset,
        mesh: int | None = None,
        largest: Largest | None = None,
        speed: float | None = None,
        exaggeration: float = 1.0,
    ) -> None:
        check_teeth(history)
        self.history, self.exaggeration = history, exaggeration
        self.largest = largest or Largest()
        self.wheels = drawn_wheels(history)
        self.meshes = drawn_meshes(history)
        self.zoomed = mesh is not None
        self.shown = range(len(self.meshes)) if mesh is None else range(mesh, mesh + 1)
        self.visible = range(len(self.wheels)) if mesh is None else self.meshes[mesh].wheels
        self.box = self._whole() if mesh is None else self._around(self.meshes[mesh])
        self._scale()
        with rc_context(STYLE | {"axes.grid": False}):
            self._lay_out(speed)
            self._add_artists()
            self._add_keys()
            self._add_names()

    def show(self, row: int) -> Figure:
        """Update all artists to the output with index `row` and return the figure."""
        history = self.history
        turned = require(history, "angle").values[row]
        moved = require(history, "centre_displacement").values[row]
        for number, (patch, mark) in self.artists.items():
            wheel, angle, shift = (
                self.wheels[number],
                float(turned[number]),
                complex(*moved[number]),
            )
            patch.set_xy(xy(wheel.outline(angle, shift, self.exaggeration)))
            spoke = np.array([0.6, 0.75]) * wheel.radius * np.exp(1j * angle)
            mark.set_data(*xy(wheel.centre + shift + spoke).T)
        self._show_contacts(row)
        self._show_torques(row)
        self.clock.set_text(f"t = {float(history['time'][row]):.{self.decimals}f} s")
        return self.figure

    def _show_contacts(self, row: int) -> None:
        """Update lines of action, forces and sliding of all loaded tooth pairs."""
        forces, slides, points, loads = [], [], [], []
        for number, lines in zip(self.shown, self.lines, strict=True):
            mesh = self.meshes[number]
            shifts = mesh.shifts(self.history, row)
            for coast, (whole, path) in enumerate(lines):
                start, along, length = mesh.line(bool(coast), shifts)
                whole.set_data(*xy(start + along * np.array([0.0, length])).T)
                path.set_data(*xy(start + along * np.array(mesh.path)).T)
            touches = touching(self.history, mesh, number, row, self._deviation(mesh))
            loads.append(float(require(self.history, "normal_force").values[row, number]))
            for touch in touches:
                points.append(touch.point)
                for on_wheel in (-touch.force, touch.force):
                    forces.append(arrow(touch.point, on_wheel * self.per_newton, self.arrow_width))
                slide = touch.sliding * self.per_speed
                slides.append(arrow(touch.point, slide, self.arrow_width))
        self.arrows.set_verts([xy(outline) for outline in forces])
        self.slides.set_verts([xy(outline) for outline in slides])
        self.contacts.set_data(*(xy(np.array(points)).T if points else ([], [])))
        if len(loads) == 1:
            self.load.set_text(_loaded(len(touches), loads[0]))

    def _show_torques(self, row: int) -> None:
        """Update the curved arrows of the loads, and their texts."""
        shapes, colours, words = [], [], {}
        for number in self.loaded:
            torque = float(self.history["load_torque"].values[row, number])
            speed = float(require(self.history, "angular_velocity").values[row, number])
            if torque == 0.0:
                continue
            drives = torque * speed >= 0
            shapes.append(xy(self._torque_arrow(number, torque / self.largest.torque)))
            colours.append(DRIVES if drives else BRAKES)
            verb = "drives" if drives else "brakes"
            words[number] = f"\n{verb} with {quantity(abs(torque), 'N m', 3)}"
        self.torques.set_verts(shapes)
        self.torques.set_facecolor(colours)
        for text, numbers in self.names:
            lines = [self.wheels[n].name + words.get(n, "") for n in numbers]
            text.set_text("\n".join(lines))

    def _torque_arrow(self, number: int, share: float) -> np.ndarray:
        """Outline of the arrow of a torque, given as a fraction of the largest torque."""
        wheel, away = self.wheels[number], self._away(number)
        radius, longest = 0.5 * wheel.radius, 2.4
        if self.zoomed:
            position = self._position_in_zoom(number, 0.25)
            distance = abs(position - wheel.centre)
            if wheel.profile is not None:
                distance = min(distance, 0.93 * abs(wheel.profile.root_radius))
            away = float(np.angle(position - wheel.centre))
            radius, longest = distance, 0.45 * self.small / distance
        angle = np.sign(share) * longest * (0.25 + 0.75 * min(abs(share), 1.0))
        return curved_arrow(wheel.centre, radius, away, float(angle), 1.3 * self.arrow_width)

    def _away(self, number: int) -> float:
        """Direction away from the mates of all wheels on a wheel's axis [rad]."""
        centre = self.wheels[number].centre
        pull = 0j
        for mesh in self.meshes:
            for side, wheel in enumerate(mesh.wheels):
                towards = mesh.centres[1 - side] - mesh.centres[side]
                if abs(self.wheels[wheel].centre - centre) < 1e-9 + 1e-6 * abs(towards):
                    pull -= towards / abs(towards)
        return float(np.angle(pull)) if abs(pull) > 0.1 else np.pi / 2

    def _deviation(self, mesh: DrawnMesh) -> Any:
        profile = self.wheels[mesh.wheels[0]].profile
        if profile is None:
            return None
        return lambda rho: self.exaggeration * float(profile.deviation(np.array(rho)))

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

    def _scale(self) -> None:
        """Set the lengths of the arrows."""
        wide, high = self.box[1] - self.box[0], self.box[3] - self.box[2]
        self.small = min(wide, high)
        self.arrow_width = 0.011 * self.small
        longest = LONGEST * self.small
        if self.zoomed:
            # arrows of adjacent tooth pairs, a base pitch apart, do not overlap
            pitch = require(self.history, "base_pitch").values[self.shown[0]]
            longest = min(longest, 0.46 * float(pitch))
        force, sliding = self.largest.force, self.largest.sliding
        self.per_newton = longest / force if force > 0 else 0.0
        self.per_speed = longest / sliding if sliding > 0 else 0.0
        self.longest = longest
        self.loaded: list[int] = []
        if "load_torque" in self.history and self.largest.torque > 0:
            ever = (self.history["load_torque"] != 0).any("time").values
            self.loaded = [number for number in self.visible if ever[number]]

    def _lay_out(self, speed: float | None) -> None:
        x0, x1, y0, y1 = self.box
        height = WIDTH * (y1 - y0) / (x1 - x0)
        total = TOP + height + BOTTOM
        # whole and even numbers of pixels at any usual resolution, as videos require
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
        self.clock = self.figure.text(0.015, at, "", va="center", fontsize=11)
        self.load = self.figure.text(0.3, at, "", va="center", fontsize=11)
        step = np.median(np.diff(self.history["time"].values)) if self.history.time.size > 1 else 1
        self.decimals = int(np.clip(np.ceil(-np.log10(step)), 0, 9))
        if speed is not None:
            text = _playback_rate(speed)
            self.figure.text(0.985, at, text, va="center", ha="right", fontsize=10, color="#555555")

    def _add_artists(self) -> None:
        axes = self.axes
        self.artists: dict[int, tuple[Polygon, Line2D]] = {}
        self.lines: list[list[tuple[Line2D, Line2D]]] = []
        # smaller wheels are drawn in front of larger ones
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
        for number in self.shown:
            flanks = []
            for coast in range(1 + self.meshes[number].has_coast):
                style: dict[str, Any] = {"color": ACTION, "linestyle": COAST if coast else "-"}
                (whole,) = axes.plot([], [], linewidth=0.9, zorder=3, **style)
                (path,) = axes.plot([], [], linewidth=2.6, zorder=3, **style)
                flanks.append((whole, path))
            self.lines.append(flanks)
        self.torques, self.arrows, self.slides = (
            PolyCollection([], facecolor=colour, edgecolor="white", linewidth=0.6, zorder=5 + depth)
            for depth, colour in enumerate((DRIVES, FORCE, SLIDES))
        )
        for shapes in (self.torques, self.arrows, self.slides):
            axes.add_collection(shapes, autolim=False)
        (self.contacts,) = axes.plot([], [], "o", color="black", markersize=3.5, zorder=8)

    def _add_names(self) -> None:
        """Place the names of the wheels in free areas; wheels on one axis share a label."""
        self.names: list[tuple[Text, list[int]]] = []
        axles: dict[complex, list[int]] = {}
        for number in self.visible:
            wheel = self.wheels[number]
            nearest = min(axles, key=lambda c: abs(c - wheel.centre), default=None)
            if nearest is None or abs(nearest - wheel.centre) > 1e-6 * wheel.radius:
                nearest = wheel.centre
            axles.setdefault(nearest, []).append(number)
        anchored = []
        for centre, numbers in axles.items():
            numbers.sort(key=lambda number: self.wheels[number].radius)
            lines = [
                self.wheels[n].name + (LONGEST_TORQUE if n in self.loaded else "") for n in numbers
            ]
            text = self.axes.text(
                0, 0, "\n".join(lines), ha="center", va="center", zorder=9,
                path_effects=OUTLINED,
            )  # fmt: skip
            self.names.append((text, numbers))
            anchor = centre
            if self.zoomed:
                anchor = self._position_in_zoom(numbers[0], 0.37)
            else:
                self.axes.plot(centre.real, centre.imag, "+", color=EDGE, zorder=4)
            anchored.append(AnchoredLabel(text, anchor))
        set_labels(self.axes, anchored, self._taken())

    def _taken(self) -> list[Bbox]:
        """Boxes around the arrows: of contacts anywhere on their paths, of the largest torques."""
        boxes = []
        for number in self.shown:
            mesh = self.meshes[number]
            ends = []
            for coast in range(1 + mesh.has_coast):
                start, along, _ = mesh.line(bool(coast))
                ends += [start + along * rho for rho in mesh.path]
            x, y = np.real(ends), np.imag(ends)
            reach = self.longest
            boxes.append(
                Bbox([[x.min() - reach, y.min() - reach], [x.max() + reach, y.max() + reach]])
            )
        for number in self.loaded:
            for sense in (1.0, -1.0):
                outline = xy(self._torque_arrow(number, sense))
                boxes.append(Bbox([outline.min(axis=0), outline.max(axis=0)]))
        return boxes

    def _position_in_zoom(self, number: int, share: float) -> complex:
        """Position of a wheel in a zoom: a fraction of the way to the edge, away from the mate."""
        centre = self.wheels[number].centre
        x0, x1, y0, y1 = self.box
        middle = complex((x0 + x1) / 2, (y0 + y1) / 2)
        towards = (centre - middle) / abs(centre - middle)
        reach = min(
            (x1 - x0) / max(abs(towards.real), 1e-9), (y1 - y0) / max(abs(towards.imag), 1e-9)
        )
        profile = self.wheels[number].profile
        if profile is not None and profile.base_radius < 0:
            share = -share  # its body is on the other side of its teeth
        return middle + share * reach * towards

    def _add_keys(self) -> None:
        """Draw the legend below the picture, with scales of length, force and speed."""
        wide, high = self.box[1] - self.box[0], self.box[3] - self.box[2]
        per_unit = BOTTOM / (WIDTH * high / wide) * high  # height of the band in the picture
        scales = [
            Scale(wide / 7, 1.0, "m", ""),
            Scale(self.largest.force, self.per_newton, "N", FORCE),
            Scale(self.largest.sliding, self.per_speed, "m s-1", SLIDES),
        ]
        entries: list[Any] = [
            Line2D([], [], color=ACTION, linewidth=0.9, label="line of action"),
            Line2D([], [], color=ACTION, linewidth=2.6, label="path of contact"),
        ]
        if any(self.meshes[m].has_coast for m in self.shown):
            label = "the same, coast flanks"
            entries.append(Line2D([], [], color=ACTION, linestyle=COAST, label=label))
        if self.exaggeration != 1.0:
            label = f"deviations {self.exaggeration:g} times"
            entries.append(Line2D([], [], color=EDGE, linewidth=1.0, label=label))
        entries.append(Patch(facecolor=FORCE, label="acts on the tooth it lies in"))
        if self.largest.sliding > 0:
            label = "sliding of the driving flank"
            entries.append(Patch(facecolor=SLIDES, label=label))
        if self.loaded:
            entries.append(Patch(facecolor=DRIVES, label="driving torque"))
            entries.append(Patch(facecolor=BRAKES, label="braking torque"))
        draw_keys(self.keys, scales, self.arrow_width, per_unit, entries)


def check_teeth(history: xr.Dataset) -> None:
    """Reject a history of a version that did not write the tooth positions."""
    if "flank_root_driving" not in history:
        raise HistoryError(
            f"{source_name(history)}: does not contain the positions of the teeth; run the case "
            "again with "
            "this version of evolvent"
        )


def _fitted(
    x: tuple[float, float], y: tuple[float, float], margin: float
) -> tuple[float, float, float, float]:
    """Widen a box by a margin, and until its aspect ratio gives a height within `HEIGHTS`."""
    wide, high = ((1 + 2 * margin) * (end - begin) for begin, end in (x, y))
    high = max(high, wide * HEIGHTS[0] / WIDTH)
    wide = max(wide, high * WIDTH / HEIGHTS[1])
    middle = sum(x) / 2, sum(y) / 2
    return (
        middle[0] - wide / 2, middle[0] + wide / 2, middle[1] - high / 2, middle[1] + high / 2,
    )  # fmt: skip


def _loaded(count: int, force: float) -> str:
    if count == 0:
        return "no contact"
    return f"{count} tooth pair{'' if count == 1 else 's'} loaded: {quantity(force, 'N', 3)}"


def _playback_rate(speed: float) -> str:
    if abs(speed - 1) < 0.005:
        return "real time"
    return f"slowed down {1 / speed:.3g} times" if speed < 1 else f"sped up {speed:.3g} times"
