"""The paper's figures and conclusions, from the four runs of its virtual setup.

Source: Kosenko & Gusev 2011, sections 7.2, 7.3 and 8. The runs are those of `examples/paper*.yaml`;
`./reproduce-paper` makes them and writes these results. docs/theory/theory.md explains the terms.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
import xarray as xr
from matplotlib.figure import Figure

from evolvent.errors import HistoryError
from evolvent.figures.over_time import Curve, Panel, figure_over_time
from evolvent.history import require

MEAN_FROM = 2.0  # mean forces are taken over the whole pitches after this time [s]
# The contact vibration decays with 146/s: 8e-6 of it remain this long after an event [s].
SETTLING = 0.08


@dataclass(frozen=True)
class PaperRun:
    """One run of the paper's setup: a driving wheel on a fixed axle and a driven one on a slider.

    The slider moves along the centre line.
    """

    history: xr.Dataset  # as from `open_history`
    events: xr.Dataset  # as from `open_events`
    case: Mapping[str, Any]  # the resolved case: `case` in the output of `evolvent show --json`

    @property
    def friction(self) -> float:
        """Coefficient of friction."""
        return float(self.case["meshes"][0]["friction"]["coefficient"])

    @property
    def rigid(self) -> bool:
        """Whether contact is rigid."""
        return bool(self.static("rigid_contact"))

    @property
    def axle_stiffness(self) -> float:
        """Stiffness of the slider [N/m]."""
        return float(self.case["wheels"][1]["support"]["stiffness"])

    def of_mesh(self, name: str) -> xr.DataArray:
        """Variable of the only mesh, dim (time)."""
        return require(self.history, name).isel(mesh=0)

    def static(self, name: str) -> float:
        """Constant of the only mesh."""
        return float(require(self.history, name)[0])

    def times(self, kind: str) -> np.ndarray:
        """Times of the events of a kind [s]."""
        times: np.ndarray = self.events["time"].values[self.events["kind"].values == kind]
        return times


@dataclass(frozen=True)
class PaperRuns:
    """The four runs of the paper's Table 1."""

    compliant: PaperRun
    compliant_friction: PaperRun
    rigid: PaperRun
    rigid_friction: PaperRun


@dataclass(frozen=True)
class Jump:
    """A change of the friction force that is short compared with a pitch: `begin` to `end` [s]."""

    what: str  # "pitch point" or "tooth switch"
    begin: float
    end: float


@dataclass(frozen=True)
class Claim:
    """A statement about the runs, with the value that decides it."""

    statement: str
    measured: float
    bound: float
    relative_to: str

    @property
    def holds(self) -> bool:
        """Whether the claim holds; NaN decides against it."""
        return self.measured <= self.bound


def mean_force(run: PaperRun, after: float = MEAN_FROM) -> float:
    """Return the mean normal force [N] over the whole pitches after a time [s].

    From the first to the last tooth switch after that time, by the trapezoidal rule; the output
    interval has to be less than a fifth of a period of the contact vibration.

    Raises
    ------
    HistoryError
        There are fewer than two tooth switches after that time.
    """
    switches = run.times("tooth_switch")
    switches = switches[switches > after]
    if switches.size < 2:
        raise HistoryError(f"there is no whole pitch after {after:g} s")
    force = run.of_mesh("normal_force")
    time = force["time"].values
    inside = (time > switches[0]) & (time < switches[-1])
    grid = np.concatenate([switches[:1], time[inside], switches[-1:]])
    values = np.interp(grid, time, force.values)
    return float(np.trapezoid(values, grid) / (switches[-1] - switches[0]))


def quasi_static(run: PaperRun, *, with_friction: bool = True) -> xr.Dataset:
    """Compute normal force [N] and transmission error [m] without any oscillation, dim (time).

    The force is that of rigidly coupled wheels under the
    loads and with the ratio of friction to normal force that the run has at that time (or without
    friction). The transmission error adds the penetration by (13), if contact is compliant, and
    the deflection of the axle under this force. A closed form: it uses speeds and arms of the run.
    """
    force = run.of_mesh("normal_force")
    ratio = (run.of_mesh("friction_force") / force.where(force > 0.0)).fillna(0.0)
    if not with_friction:
        ratio = xr.zeros_like(ratio)
    pressing = compliance = xr.zeros_like(force)
    wheels = (run.static("driving_wheel"), run.static("driven_wheel"))
    for wheel, side in zip(map(int, wheels), ("driving", "driven"), strict=True):
        base = float(run.history["base_radius"][wheel])
        base_by_inertia = base / float(run.history["inertia"][wheel])
        arm = base + ratio * run.of_mesh(f"friction_arm_{side}")
        load = run.static("flank") * run.history["load_torque"].isel(wheel=wheel)
        pressing = pressing - load * base_by_inertia
        compliance = compliance + arm * base_by_inertia
    force = pressing / compliance
    alpha = run.static("working_pressure_angle")
    give = force * (np.sin(alpha) - ratio * np.cos(alpha)) / run.axle_stiffness
    lag = give * np.sin(alpha)
    if not run.rigid:
        scale = np.pi * run.static("effective_modulus")
        line = force / run.static("common_width")
        lag = lag + line / scale * (
            np.log(4 * scale * run.static("line_of_action_length") / line) - 1
        )
    return xr.Dataset({"normal_force": force, "transmission_error": lag.assign_attrs(units="m")})


def friction_part(run: PaperRun) -> xr.DataArray:
    """Subtract the quasi-static value without friction from the transmission error [m] (time)."""
    smooth = quasi_static(run, with_friction=False)["transmission_error"]
    part = run.of_mesh("transmission_error") - smooth
    return part.assign_attrs(units="m")


def jumps(run: PaperRun) -> list[Jump]:
    """List passages of the pitch point and tooth switches that the run covers until settled.

    At the pitch point sliding ends and starts again; before the first passage it starts once.
    """
    ended, began = run.times("sliding_ended"), run.times("sliding_began")
    found = [Jump("pitch point", t, began[began > t].min(initial=np.inf)) for t in ended]
    found += [Jump("tooth switch", t, t) for t in run.times("tooth_switch")]
    last = float(run.history["time"][-1]) - SETTLING
    return sorted((j for j in found if j.end <= last), key=lambda jump: jump.begin)


def jump_size(jump: Jump, values: xr.DataArray) -> float:
    """Return the change of a quantity from the last output before a jump to the first settled."""
    before = values["time"].values < jump.begin
    after = values["time"].values >= jump.end + SETTLING
    return float(values[after][0] - values[before][-1])


def calm(run: PaperRun) -> xr.DataArray:
    """Return a mask of times without an event during the settling time before, dim (time)."""
    time = run.history["time"]
    found = xr.ones_like(time, dtype=bool) & (time > SETTLING)
    for event in run.events["time"].values:
        found = found & ~((time >= event) & (time < event + SETTLING))
    for jump in jumps(run):
        found = found & ~((time >= jump.begin) & (time < jump.end + SETTLING))
    return found


def claims(runs: PaperRuns) -> list[Claim]:
    """Check the conclusions of the paper (its sections 7.2, 7.3 and 8) with the four runs."""
    found = [
        Claim(
            f"Compliant and rigid contact give the same mean force, f = {compliant.friction:g}",
            abs(mean_force(compliant) / mean_force(rigid) - 1),
            1e-5,
            "the mean force",
        )
        for compliant, rigid in (
            (runs.compliant, runs.rigid),
            (runs.compliant_friction, runs.rigid_friction),
        )
    ]
    return [
        *found,
        Claim(
            "Beyond the vibrations after jumps, both give the same force, f = "
            f"{runs.compliant_friction.friction:g}",
            _largest_between_jumps(
                runs.compliant_friction,
                runs.compliant_friction.of_mesh("normal_force")
                / runs.rigid_friction.of_mesh("normal_force")
                - 1,
            ),
            1e-5,
            "the force",
        ),
        Claim(
            "Without friction the transmission error has no periodic part",
            _largest_between_jumps(runs.compliant, friction_part(runs.compliant))
            / _largest_error(runs.compliant),
            1e-5,
            "the largest transmission error",
        ),
        Claim(
            "With friction it has one; between the jumps it is the closed form",
            _largest_between_jumps(runs.compliant_friction, _from_closed_form(runs))
            / _largest_error(runs.compliant_friction),
            1e-5,
            "the largest transmission error",
        ),
        Claim(
            "It jumps at the pitch point and at each switch by the value of the closed form",
            max(jump_errors(runs.compliant_friction).values()),
            1e-4,
            "the jump",
        ),
        Claim(
            "lambda is an integral, in all four runs",
            max(_largest_lambda_deviation(run) for run in vars(runs).values()),
            1e-12,
            "lambda",
        ),
        Claim(
            "Discrepancy less depth is R (inv alpha - inv alpha_0), the deflection of the axle",
            float(abs(_beyond_identity(runs.compliant_friction)).max())
            / _largest_error(runs.compliant_friction),
            1e-10,
            "the largest transmission error",
        ),
        Claim(
            "Rigid flanks neither overlap nor part [m]",
            max(float(abs(run.of_mesh("gap")).max()) for run in (runs.rigid, runs.rigid_friction)),
            1e-18,
            "1 m",
        ),
    ]


def jump_errors(run: PaperRun) -> dict[Jump, float]:
    """Return the relative deviation of each jump of the transmission error from the closed form."""
    expected = quasi_static(run)["transmission_error"]
    measured = run.of_mesh("transmission_error")
    return {j: abs(jump_size(j, measured) / jump_size(j, expected) - 1) for j in jumps(run)}


def figure_discrepancy(run: PaperRun) -> Figure:
    """Draw discrepancy Delta and depth h over time, and below their difference [m].

    Source: Kosenko & Gusev 2011, Figure 3.
    """
    delta, depth = run.of_mesh("transmission_error"), run.of_mesh("penetration")
    difference = (delta - depth).assign_attrs(units="m")
    return figure_over_time(
        [
            Panel(
                "length",
                [Curve(r"discrepancy $\Delta$", delta), Curve("depth $h$", depth)],
                events=run.events,
            ),
            Panel("difference", [Curve(r"$\Delta - h$", difference, style=2)]),
        ]
    )


def figure_transmission_error(without: PaperRun, with_friction: PaperRun) -> Figure:
    """Draw the transmission error [m] of both runs over time, and below the effect of friction.

    Source: Kosenko & Gusev 2011, Figure 4.
    """
    both = (without, with_friction)
    return figure_over_time(
        [
            Panel(
                r"transmission error $\Delta$",
                [Curve(f"f = {run.friction:g}", run.of_mesh("transmission_error")) for run in both],
                events=with_friction.events,
            ),
            Panel(
                "part from friction",
                [
                    # The vibration at the start is many times larger, and unrelated to it.
                    Curve(f"f = {run.friction:g}", part.where(part["time"] > SETTLING))
                    for run, part in ((run, friction_part(run)) for run in both)
                ],
            ),
        ]
    )


def figure_normal_force(compliant: PaperRun, rigid: PaperRun) -> Figure:
    """Draw the normal force [N] of both contacts over time, and below around a tooth switch.

    Source: Kosenko & Gusev 2011, Figure 5.
    """
    switch = float(compliant.times("tooth_switch")[0])
    curves = [
        Curve(label, run.of_mesh("normal_force"))
        for label, run in (("compliant", compliant), ("rigid", rigid))
    ]
    label = "normal force $F_n$"
    return figure_over_time(
        [
            Panel(label, curves, events=compliant.events),
            Panel(label, curves, "around the first tooth switch", window=_around(switch)),
        ]
    )


def _around(time: float) -> tuple[float, float]:
    return time - SETTLING / 8, time + SETTLING / 2


def _largest_between_jumps(run: PaperRun, values: xr.DataArray) -> float:
    return float(abs(values.where(calm(run))).max())


def _largest_error(run: PaperRun) -> float:
    return float(abs(run.of_mesh("transmission_error")).max())


def _from_closed_form(runs: PaperRuns) -> xr.DataArray:
    run = runs.compliant_friction
    return run.of_mesh("transmission_error") - quasi_static(run)["transmission_error"]


def _beyond_identity(run: PaperRun) -> xr.DataArray:
    beyond = run.of_mesh("transmission_error") - run.of_mesh("penetration")
    return beyond - run.of_mesh("separation_curvature")


def _largest_lambda_deviation(run: PaperRun) -> float:
    driving, driven = (
        float(run.history["base_radius"][int(run.static(f"{side}_wheel"))])
        for side in ("driving", "driven")
    )
    # NaN, as in closed form, remains NaN and decides against the claim.
    return float(abs(run.of_mesh("gradient_ratio") * driving / driven + 1).max(skipna=False))
