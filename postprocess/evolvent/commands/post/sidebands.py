"""The command evolvent-post sidebands."""

from __future__ import annotations

import json
import math
from typing import TYPE_CHECKING, Annotated, Any

from evolvent.commands.command_line import option
from evolvent.commands.post.common import AsJson, File, open_with_warning
from evolvent.commands.post.signal_options import Columns, OptionQuantity, Times
from evolvent.commands.program import json_number, new_console, right, say
from evolvent.errors import HistoryError
from evolvent.history import source_name
from evolvent.units import quantity

if TYPE_CHECKING:
    import xarray as xr
    from rich.table import Table

    from evolvent.signals.sidebands import Sideband


def sidebands(
    file: File,
    mesh: Annotated[
        str | None,
        option("--mesh NAME", "Mesh whose orders are the carriers; if not given, the first mesh."),
    ] = None,
    name: OptionQuantity = "transmission_error",
    *,
    columns: Columns,
    times: Times,
    carriers: Annotated[int, option("--carriers N", "Carriers: mesh orders 1 to N.", min=1)] = 2,
    sides: Annotated[int, option("--sides N", "Sidebands 1 to N of each wheel.", min=1)] = 2,
    as_json: AsJson = False,
) -> None:
    """Compute the sidebands of mesh orders for each wheel, and their modulation.

    \b
    The sidebands of a wheel with z teeth are 1/z, 2/z, ... mesh orders from each carrier n, at the
    wheel orders n z + k. The lines of both wheels are fitted simultaneously.
    Example:
      evolvent-post sidebands compliant-pair.h5 --carriers 1
    """  # noqa: D301 - \b keeps click from filling the lines
    from evolvent.signals.sampling import between
    from evolvent.signals.selection import select

    chosen = columns.chosen()
    history = open_with_warning(file)
    with history:
        carrier = mesh or str(history["mesh"].values[0])
        if name in history and "mesh" in history[name].dims:
            chosen["mesh"] = carrier
        part = between(history, times.begin, times.end)
        signal = select(part, name, chosen)
        found, remarks = _find(part, signal, carrier, carriers, sides)
    units = str(signal.attrs["units"])
    what = f"{file}: {name}" + (f" of {signal.attrs['place']}" if signal.attrs["place"] else "")
    if as_json:
        say(json.dumps([_as_json(band) for band in found], indent=2))
        return
    console = new_console()
    for line in [what, *remarks]:
        console.print(line, highlight=False, markup=False)
    console.print(_table(found, units))


def _find(
    history: xr.Dataset, signal: xr.DataArray, mesh: str, carriers: int, sides: int
) -> tuple[list[Sideband], list[str]]:
    """Compute the sidebands of both wheels of a mesh, and describe the part of the record used."""
    from evolvent.signals.results import describe_sampling
    from evolvent.signals.sampling import EVEN, check_reach, last_periods, read_record
    from evolvent.signals.sidebands import sidebands as find_sidebands
    from evolvent.signals.turning import find_mesh, ratio, wheels_of

    label = source_name(history)
    of = find_mesh(history, mesh)
    record = read_record(history, signal, of)
    check_reach(record, label, carriers + 1.0, 1.0)
    wheels = wheels_of(history, mesh)
    teeth = {wheel.name: int(ratio(of, wheel)) for wheel in wheels}
    both = math.lcm(*teeth.values())
    there = int(record.periods * (1 + EVEN))
    turning = [wheel for wheel in wheels if teeth[wheel.name] <= there]
    if not turning:
        raise HistoryError(
            f"{label}: holds {record.periods:.4g} pitches of {of}, less than a revolution of a "
            f"wheel, which takes {min(teeth.values())}; increase the duration"
        )
    record = last_periods(record, label, there // both * both or there)
    turns = ", ".join(f"{record.periods / teeth[w.name]:.4g} turns of {w}" for w in wheels)
    remarks = [f"{record.periods:.6g} pitches: {turns}; {describe_sampling(record)}"]
    if there < both:
        remarks.append(f"the same teeth meet after {both} pitches: other lines may leak into these")
    remarks += [f"{w}: omitted, less than a revolution" for w in wheels if w not in turning]
    return find_sidebands(record, label, turning, of, carriers, sides), remarks


def _table(found: list[Sideband], units: str) -> Table:
    from rich.markup import escape
    from rich.table import Table

    from evolvent.signals.sidebands import phase

    table = Table(
        "line", *map(right, ("order", "amplitude", "phase", "amplitude modulation")),
        right("phase modulation"), box=None,
    )  # fmt: skip

    def row(text: str, order: float, line: complex, *more: str) -> None:
        size = quantity(abs(line), units)
        table.add_row(
            escape(text), f"{order:.6g}", size, f"{math.degrees(phase(line)):.1f}°", *more
        )

    last = 0
    for band in found:
        n = band.mesh_order
        if n != last:
            row(f"{n} x mesh", float(n), band.carrier)
            last = n
        indices = (f"{band.amplitude_modulation:.4g}", f"{band.phase_modulation:.4g} rad")
        name = f"{band.wheel_order} x {band.wheel}"
        row(f"  - {name}", n - band.spacing, band.lower)
        row(f"  + {name}", n + band.spacing, band.upper, *indices)
    return table


def _as_json(band: Sideband) -> dict[str, Any]:
    from evolvent.signals.sidebands import phase

    lines = {"carrier": band.carrier, "lower": band.lower, "upper": band.upper}
    return {
        "mesh_order": band.mesh_order,
        "wheel": band.wheel,
        "wheel_order": band.wheel_order,
        "spacing": band.spacing,
        "amplitude_modulation": json_number(band.amplitude_modulation),
        "phase_modulation": json_number(band.phase_modulation),
        **{
            name: {"amplitude": json_number(abs(line)), "phase": json_number(phase(line))}
            for name, line in lines.items()
        },
    }
