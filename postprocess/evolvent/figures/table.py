"""The figures over time, a row each: `evolvent-post plot` and the report draw what stands here."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import xarray as xr
from matplotlib.figure import Figure

from evolvent.figures.normal_force import figure_normal_force
from evolvent.figures.penetration import figure_penetration
from evolvent.figures.speeds import figure_speeds
from evolvent.figures.transmission_error import figure_transmission_error

DrawOne = Callable[[xr.Dataset, xr.Dataset | None], Figure]  # of a history and its events
DrawTogether = Callable[[list[xr.Dataset], list[str], xr.Dataset | None], Figure]  # with labels


@dataclass(frozen=True)
class Drawing:
    """One row."""

    name: str  # of the option --quantity and of the file
    one: DrawOne | None = None  # draws one history
    together: DrawTogether | None = None  # draws several in one figure
    title: str = ""  # on the page of a report; not there if empty


DRAWINGS = (
    Drawing("penetration", figure_penetration, title="Transmission error and penetration"),
    Drawing("transmission_error", together=figure_transmission_error),
    Drawing("normal_force", figure_normal_force, title="Normal force"),
    Drawing("speeds", figure_speeds, title="Speeds"),
)
