"""Table of the figures: one function each, with a decorator for its row.

`evolvent-post plot`, its --list, the report and the tests iterate over `FIGURES`.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import xarray as xr
from matplotlib.figure import Figure

from evolvent.errors import HistoryError
from evolvent.figures.campbell import draw_campbell
from evolvent.figures.on_path import draw_on_path
from evolvent.figures.orbits import draw_orbits
from evolvent.figures.order_map import draw_order_maps
from evolvent.figures.pairs import draw_pairs, last_pitches
from evolvent.figures.quantities import draw_quantities
from evolvent.figures.response import draw_response
from evolvent.figures.root_stress_map import draw_root_map
from evolvent.figures.spectrum import draw_spectra
from evolvent.figures.static import draw_curves, draw_harris, draw_roots, draw_sharing
from evolvent.history import (
    CAMPBELL,
    HISTORY,
    ORBITS,
    ORDER_MAP,
    RESPONSE,
    SPECTRUM,
    STATIC,
    WHAT,
    require,
    result_kind,
    source_name,
)
from evolvent.physics.static_root_stress import tooth_root_stress


@dataclass(frozen=True)
class Run:
    """Input of a figure."""

    history: xr.Dataset  # as from `open_history`, or a part of it
    events: xr.Dataset | None = None  # as from `open_events`; marked if given
    label: str = ""  # in a legend with several runs
    is_whole: bool = True  # no part was selected


@dataclass(frozen=True)
class Drawing:
    """One row of the table."""

    name: str  # of the option --quantity and of the file
    text: str  # description of the figure
    needs: tuple[str, ...]  # required variables of the histories
    title: str  # in a report; not in the report if empty
    together: bool  # several histories share one figure
    by_default: bool  # drawn without a request
    function: Callable[..., Figure]
    of: str = HISTORY  # kind of the files
    many: str = ""  # dimension that must be longer than 1
    chooses: bool = False  # accepts a selection of meshes and so on, and a horizontal axis

    def fits(self, run: Run) -> bool:
        """Whether the figure applies to a run."""
        return self.of == result_kind(run.history) and (
            not self.many or run.history.sizes.get(self.many, 1) > 1
        )

    def __call__(self, *runs: Run, **options: Any) -> Figure:
        """Draw; raise `HistoryError` for a missing variable."""
        for run in runs:
            if not self.fits(run):
                raise HistoryError(
                    f"{source_name(run.history)}: has nothing for {self.name}, which shows "
                    f"{WHAT[self.of]}{f' of more than one {self.many}' if self.many else ''}"
                )
            for name in self.needs:
                require(run.history, name)
        return self.function(runs, **options) if self.together else self.function(*runs, **options)


FIGURES: dict[str, Drawing] = {}


def figure(
    text: str,
    *needs: str,
    title: str = "",
    together: bool = False,
    by_default: bool = True,
    of: str = HISTORY,
    many: str = "",
    chooses: bool = False,
) -> Callable[[Callable[..., Figure]], Drawing]:
    """Register a function in the table under its name.

    It takes one run, or a sequence of runs if `together`.
    """

    def put(function: Callable[..., Figure]) -> Drawing:
        name = function.__name__
        FIGURES[name] = Drawing(
            name, text, needs, title, together, by_default, function, of, many, chooses
        )
        return FIGURES[name]

    return put


@figure(
    "transmission error and penetration over time",
    "transmission_error",
    "penetration",
    title="Transmission error and penetration",
    chooses=True,
)
def penetration(run: Run, **choice: Any) -> Figure:
    """Draw transmission error Delta and penetration h [m], one panel per mesh.

    Source: Kosenko & Gusev 2011, Figure 3.
    """
    return draw_quantities([run], penetration.needs, **choice)


@figure(
    "transmission errors of all histories over time",
    "transmission_error",
    together=True,
    chooses=True,
)
def transmission_error(runs: Sequence[Run], **choice: Any) -> Figure:
    """Draw the transmission error Delta of several runs [m], one panel per mesh.

    The events of a single run are marked.   Source: Kosenko & Gusev 2011, (19) and Figure 4.
    """
    return draw_quantities(runs, transmission_error.needs, **choice)


@figure(
    "normal forces over time", "normal_force", title="Normal force", together=True, chooses=True
)
def normal_force(runs: Sequence[Run], **choice: Any) -> Figure:
    """Draw the normal force F_n of every mesh [N], one panel per mesh."""
    return draw_quantities(runs, normal_force.needs, **choice)


@figure("speeds over time", "angular_velocity", title="Speeds", together=True, chooses=True)
def speeds(runs: Sequence[Run], **choice: Any) -> Figure:
    """Draw the angular velocity of every wheel [rad/s]; coincident lines are merged."""
    return draw_quantities(runs, speeds.needs, **choice)


@figure(
    "normal force and contact pressure of each tooth pair over the roll angle",
    "pair_normal_force",
    title="Tooth pairs, the last pitches",
    by_default=False,
)
def pairs(run: Run, over_time: bool = False) -> Figure:
    """Draw the load of each tooth pair; for a whole run in its last pitches."""
    history = last_pitches(run.history) if run.is_whole else run.history
    return draw_pairs(history, run.events, over_time)


@figure(
    "load of tooth pairs along the path of contact, by roll angle",
    "pair_normal_force",
    "pair_contact_pressure",
    "pair_position",
    title="Tooth pairs along the path of contact",
    together=True,
    by_default=False,
)
def path(runs: Sequence[Run], meshes: Sequence[str] = ()) -> Figure:
    """Draw the load of tooth pairs along the path; for a whole run in its last pitches."""
    return along_path(runs, path.needs[:2], meshes)


def along_path(runs: Sequence[Run], names: Sequence[str], meshes: Sequence[str] = ()) -> Figure:
    """Draw variables of tooth pairs along the path; for a whole run in its last pitches."""
    shown = [(r.label, last_pitches(r.history) if r.is_whole else r.history) for r in runs]
    return draw_on_path(shown, names, meshes)


@figure(
    "transmission error over the mesh cycle, a line for each torque",
    "transmission_error",
    of=STATIC,
)
def static_transmission_error(run: Run) -> Figure:
    """Draw the quasi-static transmission error h [m]."""
    return draw_curves(run.history, {"transmission_error": "transmission error $h$"})


@figure(
    "mesh stiffness over the mesh cycle, secant and tangent, a line for each torque",
    "loaded_secant_stiffness",
    "tangent_stiffness",
    of=STATIC,
)
def mesh_stiffness(run: Run) -> Figure:
    """Draw F/(h - h_0) and dF/dh [N/m]."""
    shown = {
        "loaded_secant_stiffness": "secant $F/(h - h_0)$",
        "tangent_stiffness": "tangent $dF/dh$",
    }
    return draw_curves(run.history, shown)


@figure(
    "load share of a tooth pair along its path, a line for each torque",
    "force_share",
    "pair_contact_kind",
    of=STATIC,
)
def load_sharing(run: Run) -> Figure:
    """Draw the force share of tooth pair 0 over its position on the path of contact."""
    return draw_sharing(run.history)


@figure(
    "root stress of both wheels over the mesh cycle, and the arc of the largest tension",
    "root_stress_max",
    "root_stress_min",
    "root_stress_max_arc",
    "root_stress_max_tooth",
    of=STATIC,
    many="wheel",
)
def root_stress(run: Run) -> Figure:
    """Draw tension and compression in the tooth roots [Pa], and the arc of the tension [m]."""
    return draw_roots(run.history)


@figure(
    "map of the root stress of one tooth over its position and the arc of its fillets",
    "root_stress_max",
    "pair_normal_force",
    "pair_position",
    "pair_position_driven",
    "common_width",
    by_default=False,
    of=STATIC,
    many="wheel",
)
def root_stress_map(run: Run) -> Figure:
    """Draw the root stress under the torque of largest magnitude [Pa]."""
    torque = int(np.abs(run.history["torque"].values).argmax())
    teeth = tooth_root_stress(run.history, torque)
    return draw_root_map(teeth, float(run.history["torque"][torque]))


@figure(
    "Harris map: peak to peak and harmonics over the torque",
    "peak_to_peak_transmission_error",
    "harmonic_amplitude",
    of=STATIC,
    many="torque",
)
def harris(run: Run) -> Figure:
    """Draw the variation of the transmission error over the torque [m].

    Source: S. L. Harris 1958, whose curves of static transmission error are named after him.
    """
    return draw_harris(run.history)


@figure(
    "amplitudes of all spectra over frequency or order", "amplitude", of=SPECTRUM, together=True
)
def spectrum(runs: Sequence[Run]) -> Figure:
    """Draw the spectra of one quantity of several histories."""
    return draw_spectra([(run.label, run.history) for run in runs])


@figure(
    "amplitudes over speed and order, a panel for each order map",
    "amplitude",
    "speed",
    of=ORDER_MAP,
    together=True,
)
def order_map(runs: Sequence[Run], over_time: bool = False, as_frequency: bool = False) -> Figure:
    """Draw the amplitudes of orders during a run-up."""
    return draw_order_maps([(run.label, run.history) for run in runs], over_time, as_frequency)


@figure(
    "metrics over an increasing and decreasing parameter, with the jumps of the motion",
    "transmission_error_standard_deviation",
    "dynamic_factor",
    "period",
    of=RESPONSE,
)
def response(run: Run) -> Figure:
    """Draw deviation of the transmission error, dynamic factor and period over the parameter."""
    return draw_response(run.history)


@figure(
    "branches of periodic orbits over a parameter, stable and unstable, with their special points",
    "transmission_error_standard_deviation",
    "dynamic_factor",
    of=ORBITS,
)
def orbits(run: Run) -> Figure:
    """Draw deviation of the transmission error and dynamic factor of all orbits."""
    return draw_orbits(run.history)


@figure(
    "natural frequencies and orders over the speed, and their intersections",
    "natural_frequency",
    "crossing_speed",
    of=CAMPBELL,
)
def campbell(run: Run) -> Figure:
    """Draw the Campbell diagram.

    Source: W. Campbell 1924, on the resonance speeds of turbine discs.
    """
    return draw_campbell(run.history)
