"""The command evolvent-post campbell."""

from __future__ import annotations

import json
import math
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

from evolvent.commands.command_line import WrongUsageError, argument, option
from evolvent.commands.post.gearbox import Gearbox
from evolvent.commands.post.signal_options import RPM, check_outputs, write_outputs
from evolvent.commands.program import new_console, right, say
from evolvent.errors import replacing

if TYPE_CHECKING:
    import xarray as xr


def campbell(
    case: Annotated[Path, argument("CASE.yaml", "Case file.")],
    speeds: Annotated[str, option("--speeds FROM:TO", "Range of speeds [rpm], such as 500:12000.")],
    output: Annotated[
        list[Path] | None,
        option(
            "-o --output FILE",
            "Data file (.h5), resonance speeds (.csv) or figure (.png, .svg, .pdf); may be "
            "repeated.",
        ),
    ] = None,
    wheel: Annotated[
        str | None,
        option(
            "--wheel NAME",
            "Wheel to which the speeds refer; if not given, the driving wheel of the first mesh.",
        ),
    ] = None,
    mesh_orders: Annotated[
        int, option("--mesh-orders N", "Orders 1 to N of every mesh.", min=1)
    ] = 5,
    wheel_orders: Annotated[
        int, option("--wheel-orders N", "Orders 1 to N of every wheel.", min=0)
    ] = 1,
    points: Annotated[
        int,
        option(
            "--points N",
            "Number of speeds at which modes are computed, if a load prescribes the speed.",
            min=2,
        ),
    ] = 13,
    settings: Annotated[
        list[str] | None,
        option(
            "--set PATH=VALUE",
            "Change a value of the case, as for `evolvent run`; may be repeated.",
        ),
    ] = None,
    as_json: Annotated[bool, option("--json", "Write JSON, for scripts.")] = False,
) -> None:
    """Compute a Campbell diagram: speeds at which mesh and wheel orders excite natural frequencies.

    \b
    Natural frequencies are those of `evolvent modes --mean`: at the mean stiffness, under the loads
    of the case. If a load prescribes the speed (`kind: speed`), they are computed for several
    speeds in the range.
    Example:
      evolvent-post campbell examples/compliant-pair.yaml --speeds 500:12000 -o c.png -o c.h5
    """  # noqa: D301 - \b keeps click from filling the lines
    import numpy as np

    from evolvent.signals.campbell import crossings
    from evolvent.signals.results import campbell_result

    check_outputs(output, 1, "csv")
    low, high = _range(speeds)
    gearbox = Gearbox.ask(case, settings or ())
    axis = wheel or gearbox.first_driving
    gearbox.check_wheel(axis)
    speed = np.linspace(low, high, points) / RPM
    modes = gearbox.modes(axis, speed)
    excitations = gearbox.excitations(axis, mesh_orders, wheel_orders)
    found = crossings(speed, modes.values["natural_frequency"], excitations)
    result = campbell_result(
        gearbox.text, case.stem, axis, speed, modes.values, modes.computed, excitations, found
    )
    result.attrs["title"] = str(gearbox.description["case"].get("title", ""))
    for path in output or ():
        if path.suffix.lower() == ".csv":
            with replacing(path) as temporary:
                temporary.write_text(_csv(result), encoding="utf-8")
    write_outputs(
        [p for p in output or () if p.suffix.lower() != ".csv"], [("", result)], "campbell"
    )
    if as_json:
        say(json.dumps(_rows(result), indent=2))
        return
    _print(result, case, modes.remark)
    for path in output or ():
        say(path)


def _range(text: str) -> tuple[float, float]:
    """Parse a range of two speeds [rpm]."""
    low, _, high = text.removesuffix("rpm").strip().partition(":")
    try:
        found = float(low), float(high)
    except ValueError:
        found = math.nan, math.nan
    if not 0 <= found[0] < found[1] < math.inf:
        raise WrongUsageError(
            f"{text} is not a range of speeds in rpm, such as 500:12000", "--speeds"
        )
    return found


def _rows(result: xr.Dataset) -> list[dict[str, Any]]:
    """Crossings in the order of speed."""
    return [
        {
            "speed": float(one["crossing_speed"]),
            "rpm": float(one["crossing_speed"]) * RPM,
            "frequency": float(one["crossing_frequency"]),
            "mode": int(one["crossing_mode"]),
            "order": str(result["excitation"].values[int(one["crossing_excitation"])]),
        }
        for one in (result.isel(crossing=i) for i in range(result.sizes["crossing"]))
    ]


def _csv(result: xr.Dataset) -> str:
    lines = ["speed_rad_per_s,speed_rpm,frequency_Hz,mode,order"]
    for row in _rows(result):
        name = row["order"].replace('"', '""')
        lines.append(f'{row["speed"]!r},{row["rpm"]!r},{row["frequency"]!r},{row["mode"]},"{name}"')
    return "\n".join(lines) + "\n"


def _print(result: xr.Dataset, case: Path, remark: str) -> None:
    from rich.markup import escape
    from rich.table import Table

    console = new_console()
    console.print(f"{case}: {remark}", highlight=False, markup=False)
    natural = Table(*map(right, ("mode", "natural frequency", "damping ratio")), box=None)
    for mode in result["mode"].values:
        one = result.sel(mode=mode)
        low, high = float(one["natural_frequency"].min()), float(one["natural_frequency"].max())
        span = f"{low:.6g} Hz" if high - low <= 1e-6 * high else f"{low:.6g} to {high:.6g} Hz"
        natural.add_row(str(mode), span, f"{float(one['damping_ratio'].mean()):.3g}")
    console.print(natural)
    heads = (f"speed of {escape(result.attrs['wheel'])}", "frequency", "mode")
    table = Table(*map(right, heads), "order", box=None)
    for row in _rows(result):
        table.add_row(
            f"{row['rpm']:.6g} rpm", f"{row['frequency']:.6g} Hz", str(row["mode"]),
            escape(row["order"]),
        )  # fmt: skip
    console.print(table)
    if not table.row_count:
        console.print("No order equals a natural frequency in this range.", highlight=False)
