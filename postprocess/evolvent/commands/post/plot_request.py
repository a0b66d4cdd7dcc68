"""Figures requested from evolvent-post plot, and how each is drawn."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from enum import StrEnum
from typing import TYPE_CHECKING

from evolvent.errors import USAGE, HistoryError
from evolvent.history import HISTORY, WHAT, result_kind

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from evolvent.figures.table import Drawing, Run


class Over(StrEnum):
    """Variable on the horizontal axis."""

    TIME = "time"
    ROLL_ANGLE = "roll-angle"
    PATH = "path"


@dataclass(frozen=True)
class Request:
    """One figure: its quantities, what is selected of them, and the horizontal axis."""

    names: Sequence[str]  # one figure of the table, or variables
    chosen: Mapping[str, Sequence[str]] = field(default_factory=dict)  # names by dimension
    over: Over | None = None

    @property
    def is_plain(self) -> bool:
        """Whether the figure is drawn without any selection."""
        return not self.chosen and self.over is None

    def options(self) -> str:
        """Return the options of the selection as typed on the command line."""
        given = [f"--{dim}" for dim in self.chosen] + ([] if self.over is None else ["--over"])
        return ", ".join(given)

    def draw(self, runs: Sequence[Run]) -> dict[str, Figure]:
        """Draw one figure for all runs, or one for each; return figures by file name."""
        from evolvent.figures.table import FIGURES

        row = FIGURES.get(self.names[0]) if len(self.names) == 1 else None
        name = "-".join(self.names)
        if row is None:
            name += "" if self.over in (None, Over.TIME) else f"-over-{self.over}"
            figure = _draw_variables(replace(self, names=_expanded(self.names)), runs)
        elif row.together and len(runs) > 1:
            figure = _draw_row(row, self, runs)
        else:
            return {f"{run.label}-{name}": _draw_row(row, self, [run]) for run in runs}
        return {name if len(runs) > 1 else f"{runs[0].label}-{name}": figure}


def _draw_row(row: Drawing, request: Request, runs: Sequence[Run]) -> Figure:
    """Draw a figure of the table with the selection that it supports."""
    from evolvent.figures.quantities import X
    from evolvent.figures.table import pairs, path

    chosen, over = request.chosen, request.over
    if request.is_plain:
        return row(*runs)
    if row is pairs and not chosen and over is not Over.PATH:
        return row(*runs, over_time=over is Over.TIME)
    if row is path and set(chosen) <= {"mesh"} and over in (None, Over.PATH):
        return row(*runs, meshes=chosen.get("mesh", ()))
    if not row.chooses:
        raise HistoryError(
            f"{request.options()} cannot be used with {row.name}; draw its variables instead: "
            f"--quantity {','.join(row.needs)}",
            USAGE,
        )
    if over is Over.PATH:
        return _draw_variables(replace(request, names=row.needs), runs)
    return row(*runs, chosen=chosen, over=X(over or X.TIME))


def _draw_variables(request: Request, runs: Sequence[Run]) -> Figure:
    """Draw any variables of histories."""
    from evolvent.figures.quantities import X, draw_quantities
    from evolvent.figures.table import along_path

    for run in runs:
        for name in request.names:
            _check_variable(run, name)
    if request.over is not Over.PATH:
        return draw_quantities(runs, request.names, request.chosen, X(request.over or X.TIME))
    if set(request.chosen) - {"mesh"}:
        raise HistoryError("--over path takes --mesh only: it shows all tooth pairs", USAGE)
    return along_path(runs, request.names, request.chosen.get("mesh", ()))


def _check_variable(run: Run, name: str) -> None:
    """Reject a name that is no variable over time of a history."""
    from evolvent.figures.table import FIGURES
    from evolvent.signals.selection import over_time, unknown

    kind = result_kind(run.history)
    if kind != HISTORY:
        known = [row.name for row in FIGURES.values() if row.fits(run)]
        raise HistoryError(
            f"{run.label}: is {WHAT[kind]}; --quantity accepts {', '.join(known)}, not {name}",
            USAGE,
        )
    if name in FIGURES and name not in run.history:
        raise HistoryError(f"{name} is a separate figure; give it its own --quantity", USAGE)
    if name not in over_time(run.history):
        pictures = [row.name for row in FIGURES.values() if row.of == HISTORY]
        raise HistoryError(f"{run.label}.h5: {unknown(run.history, name, pictures)}", USAGE)


def _expanded(names: Sequence[str]) -> list[str]:
    """Replace figure names among variables by their variables: speeds by angular_velocity."""
    from evolvent.figures.table import FIGURES

    found: list[str] = []
    for name in names:
        row = FIGURES.get(name)
        found += row.needs if row is not None and row.chooses else [name]
    return list(dict.fromkeys(found))
