"""The mesh scheme: two wheels with their circles, the line of action and two flanks, to scale."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
import xarray as xr
from matplotlib import rc_context
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Rectangle
from numpy.typing import NDArray

from evolvent.figures.style import BELOW, STYLE
from evolvent.history import require

DRIVING_COLOR, DRIVEN_COLOR, ACTION_COLOR = "#10243e", "#b8530f", "#2b7bb0"
CIRCLES: dict[str, Any] = {"base": (0, (6, 2)), "pitch": (0, (6, 2, 1.2, 2)), "tip": "-"}
LINE_OF_ACTION, PATH_OF_CONTACT, FLANK = 1.0, 3.0, 2.2  # line widths [pt]
# The drawn contact is this far from a to b: away from the labelled points.
DRAWN_CONTACT = 0.3


@dataclass(frozen=True)
class MeshGeometry:
    """The geometry of one mesh at its reference centres; points are complex numbers x + iy [m]."""

    names: tuple[str, str]  # of the driving and the driven wheel
    sigma: int
    centres: tuple[complex, complex]
    base_radii: tuple[float, float]  # [m]
    pitch_radii: tuple[float, float]  # [m]
    tip_radii: tuple[float, float]  # [m], which reach to the ends of contact of this mesh
    across: complex  # unit vector t, normal to the line of action
    along: complex  # unit vector e: the driving wheel pushes this way
    length: float  # of the line of action [m]
    start: float  # distance of a from K_A [m]
    path: float  # length of the path of contact [m]

    @property
    def points(self) -> dict[str, complex]:
        """K_A, K_B, a, b and the pitch point."""
        k_a = self.centres[0] + self.base_radii[0] * self.across
        a = k_a + self.start * self.along
        axis = self.centres[1] - self.centres[0]
        return {
            "K_A": k_a,
            "K_B": k_a + self.length * self.along,
            "a": a,
            "b": a + self.path * self.along,
            "P": self.centres[0] + axis / abs(axis) * self.pitch_radii[0],
        }

    def flank(self, wheel: int, contact: float, n: int = 200) -> NDArray[np.complex128]:
        """Return an involute flank that touches the line of action.

        Parameters
        ----------
        wheel : 0 driving, 1 driven.
        contact : distance of the contact point from K_A [m].
        n : number of points.

        Returns
        -------
        Points from the root on the base circle to the tip, shape (n,).

        Source: the involute by its radius of curvature rho, Kosenko & Gusev 2011, section 4.
        """
        base, tip = self.base_radii[wheel], self.tip_radii[wheel]
        rho = np.linspace(0.0, np.sqrt(tip**2 - base**2), n)
        at_contact = contact if wheel == 0 else self.length - contact
        turned = np.exp(1j * self.sigma * (rho - at_contact) / base)
        outward = 1.0 if wheel == 0 else -1.0
        local = outward * (base * self.across + rho * self.along)
        return np.asarray(self.centres[wheel] + turned * local)


def mesh_geometry(history: xr.Dataset, mesh: int) -> MeshGeometry:
    """Collect the geometry of mesh number `mesh` from the static variables of a history."""

    def of_mesh(name: str) -> float:
        return float(require(history, name)[mesh])

    wheels = [int(of_mesh(f"{side}_wheel")) for side in ("driving", "driven")]
    sigma = int(of_mesh("flank"))
    centres = [complex(*require(history, "centre").values[wheel]) for wheel in wheels]
    base = [float(require(history, "base_radius")[wheel]) for wheel in wheels]
    distance = abs(centres[1] - centres[0])
    alpha = of_mesh("working_pressure_angle")
    across = (centres[1] - centres[0]) / distance * np.exp(1j * sigma * alpha)
    ratio = of_mesh("contact_ratio") if "contact_ratio" in history else 1.0
    path, start = ratio * of_mesh("base_pitch"), of_mesh("rho_start_driving")
    return MeshGeometry(
        names=(str(history["wheel"].values[wheels[0]]), str(history["wheel"].values[wheels[1]])),
        sigma=sigma,
        centres=(centres[0], centres[1]),
        base_radii=(base[0], base[1]),
        pitch_radii=(base[0] / np.cos(alpha), base[1] / np.cos(alpha)),
        tip_radii=(
            float(np.hypot(base[0], start + path)),
            float(np.hypot(base[1], of_mesh("rho_start_driven"))),
        ),
        across=complex(across),
        along=complex(-1j * sigma * across),
        length=of_mesh("line_of_action_length"),
        start=start,
        path=path,
    )


def figure_mesh_scheme(history: xr.Dataset, mesh: int = 0) -> Figure:
    """Draw a mesh to scale: the two wheels, and enlarged beside them the zone of contact.

    Parameters
    ----------
    history : with the static variables of geometry.
    mesh : which mesh, from 0.

    Source: Kosenko & Gusev 2011, Figure 1.
    """
    geometry = mesh_geometry(history, mesh)
    with rc_context(STYLE | {"axes.grid": False}):
        figure = Figure(figsize=(10.5, 6.3), layout="constrained")
        whole, zone = figure.subplots(1, 2, width_ratios=[1.5, 1.0])
        for axis in (whole, zone):
            _draw(axis, geometry)
            axis.set_aspect("equal")
            axis.set_xlabel("x [m]")
            axis.set_ylabel("y [m]")
        _frame_whole(whole, geometry)
        _frame_zone(zone, geometry)
        _label_wheels(whole, geometry)
        _label_points(zone, geometry)
        low, high = zone.get_xlim(), zone.get_ylim()
        frame = Rectangle((low[0], high[0]), low[1] - low[0], high[1] - high[0])
        frame.set(fill=False, edgecolor="#666666", linewidth=0.9)
        whole.add_patch(frame)
        whole.set_title("to scale", loc="left", fontsize=12)
        zone.set_title("the frame, enlarged", loc="left", fontsize=12)
        figure.legend(handles=_legend_entries(), loc=BELOW, ncols=3)
    return figure


def _draw(axis: Axes, geometry: MeshGeometry) -> None:
    turn = np.exp(1j * np.linspace(0.0, 2 * np.pi, 1441))
    for wheel, color in enumerate((DRIVING_COLOR, DRIVEN_COLOR)):
        radii = (geometry.base_radii, geometry.pitch_radii, geometry.tip_radii)
        for style, radius in zip(CIRCLES.values(), radii, strict=True):
            circle = geometry.centres[wheel] + radius[wheel] * turn
            axis.plot(circle.real, circle.imag, color=color, linestyle=style, linewidth=0.9)
    points = geometry.points
    ends = np.array([points["K_A"], points["K_B"]])
    axis.plot(ends.real, ends.imag, color=ACTION_COLOR, linewidth=LINE_OF_ACTION)
    path = np.array([points["a"], points["b"]])
    axis.plot(path.real, path.imag, color=ACTION_COLOR, linewidth=PATH_OF_CONTACT)
    contact = geometry.start + DRAWN_CONTACT * geometry.path
    for wheel, color in enumerate((DRIVING_COLOR, DRIVEN_COLOR)):
        flank = geometry.flank(wheel, contact)
        axis.plot(flank.real, flank.imag, color=color, linewidth=FLANK)


def _legend_entries() -> list[Line2D]:
    """Explain the kinds of lines; whose they are their colour and the names in the wheels say."""
    grey: dict[str, Any] = {"color": "#444444"}
    entries = [
        Line2D([], [], linestyle=style, linewidth=0.9, label=f"{kind} circle", **grey)
        for kind, style in CIRCLES.items()
    ]
    action: dict[str, Any] = {"color": ACTION_COLOR}
    return [
        *entries,
        Line2D([], [], linewidth=LINE_OF_ACTION, label=r"line of action $K_A K_B$", **action),
        Line2D([], [], linewidth=PATH_OF_CONTACT, label="path of contact $ab$", **action),
        Line2D([], [], linewidth=FLANK, label="flanks in contact", **grey),
    ]


def _frame_whole(axis: Axes, geometry: MeshGeometry) -> None:
    centres = np.array(geometry.centres)
    reach = 1.04 * np.array(geometry.tip_radii)
    axis.set_xlim((centres.real - reach).min(), (centres.real + reach).max())
    axis.set_ylim((centres.imag - reach).min(), (centres.imag + reach).max())


def _frame_zone(axis: Axes, geometry: MeshGeometry) -> None:
    ends = np.array([geometry.points["K_A"], geometry.points["K_B"]])
    margin = 0.25 * geometry.length
    axis.set_xlim(ends.real.min() - margin, ends.real.max() + margin)
    axis.set_ylim(ends.imag.min() - margin / 2, ends.imag.max() + margin / 2)


def _label_wheels(axis: Axes, geometry: MeshGeometry) -> None:
    colors = (DRIVING_COLOR, DRIVEN_COLOR)
    for centre, name, color in zip(geometry.centres, geometry.names, colors, strict=True):
        axis.plot(centre.real, centre.imag, "+", color=color, markersize=10)
        axis.annotate(
            name,
            (centre.real, centre.imag),
            xytext=(0, 9),
            textcoords="offset points",
            ha="center",
            color=color,
        )


def _label_points(axis: Axes, geometry: MeshGeometry) -> None:
    """Label the points beside the line of action, near pairs on opposite sides of it."""
    sides = {"K_A": -1, "a": 1, "P": 1, "b": -1, "K_B": 1}
    names = {"K_A": "$K_A$", "K_B": "$K_B$", "a": "$a$", "b": "$b$", "P": "pitch point"}
    for key, point in geometry.points.items():
        axis.plot(point.real, point.imag, "o", color=ACTION_COLOR, markersize=5, zorder=5)
        offset = 14 * sides[key] * geometry.across
        axis.annotate(
            names[key],
            (point.real, point.imag),
            xytext=(offset.real, offset.imag),
            textcoords="offset points",
            ha="left" if offset.real > 0 else "right",
            va="center",
            bbox={"boxstyle": "square,pad=0.1", "facecolor": "white", "edgecolor": "none"},
            zorder=6,
        )
