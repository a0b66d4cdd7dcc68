"""The command evolvent-post waterfall."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated

from evolvent.commands.command_line import option
from evolvent.commands.post.common import Files, labels
from evolvent.commands.post.signal_options import (
    RPM,
    OptionOutput,
    OptionWindow,
    Signal,
    check_outputs,
    open_signal,
    write_outputs,
)
from evolvent.commands.program import new_console, right, say
from evolvent.units import quantity

if TYPE_CHECKING:
    import xarray as xr


def waterfall(
    files: Files,
    order_of: Annotated[
        str | None,
        option(
            "--order-of NAME",
            "Orders refer to this mesh or wheel. If not given, to the first mesh, or for "
            "histories with outputs by angle to their mesh or wheel.",
        ),
    ] = None,
    output: OptionOutput = None,
    *,
    signal: Signal,
    length: Annotated[int, option("--length N", "Length of a window in periods.", min=1)] = 4,
    hop: Annotated[
        int | None,
        option(
            "--hop N", "Distance between windows in periods; if not given, half the length.", min=1
        ),
    ] = None,
    window: OptionWindow = None,
    highest: Annotated[float | None, option("--highest X", "Highest order.", min=0.0)] = None,
    over_time: Annotated[bool, option("--over-time", "Plot over time instead of speed.")] = False,
    frequency: Annotated[
        bool, option("--frequency", "Plot frequencies instead of orders.")
    ] = False,
) -> None:
    """Compute the spectra of a signal over the speed: a waterfall or order map.

    \b
    Each window contains whole pitches of the mesh, or whole revolutions of the wheel.
    Example:
      evolvent-post waterfall compliant-pair.h5 --order-of pinion-gear -o map.png -o map.h5
    """  # noqa: D301 - \b keeps click from filling the lines
    check_outputs(output, len(files))
    chosen = signal.columns.chosen(signal.mesh)
    results = []
    for path, label in zip(files, labels(files), strict=True):
        history, values = open_signal(path, signal.name, chosen, signal.times)
        with history:
            result = make_map(history, values, order_of, length, hop, window, highest)
        results.append((label, result))
    written = write_outputs(
        output, results, "order_map", over_time=over_time, as_frequency=frequency
    )
    for _, result in results:
        _print(result)
    for path in written:
        say(path)


def make_map(
    history: xr.Dataset,
    signal: xr.DataArray,
    order_of: str | None,
    length: int,
    hop: int | None,
    shape: str | None,
    highest: float | None,
) -> xr.Dataset:
    """Compute the order map of one signal."""
    from evolvent.history import source_name
    from evolvent.signals import results, sampling
    from evolvent.signals.order_map import order_map
    from evolvent.signals.window_names import RECTANGULAR

    label = source_name(history)
    of = sampling.counted_over(history, order_of) or sampling.counted_over(
        history, str(history["mesh"].values[0])
    )
    record = sampling.read_record(history, signal, of)
    reach = sampling.check_reach(record, label, highest, 1 / length)
    name = str(shape or RECTANGULAR)
    found = order_map(record, label, length, hop or max(1, length // 2), name, reach)
    return results.order_map_result(history, signal, record, found, name)


def _print(result: xr.Dataset) -> None:
    """Print a description of the map, and where each of the largest whole orders peaks."""
    from rich.table import Table

    from evolvent.signals.spectrum import ROUNDING

    a = result.attrs
    console = new_console()
    periods = str(result["window_length"].attrs["long_name"]).split()[0]
    place = f" of {a['place']}" if a["place"] else ""
    console.print(
        f"{a['source']}: {a['quantity']}{place}, t = {a['begin']:.6g} to {a['end']:.6g} s\n"
        f"{result.sizes['time']} windows of {float(result['window_length']):.4g} "
        f"{periods} of {a['order_of']}, {a['window']}, {a['sampling']}; "
        f"lines up to order {float(result['order'][-1]):.4g}",
        highlight=False, markup=False,
    )  # fmt: skip
    units = str(result["amplitude"].attrs["units"])
    table = Table(
        *map(right, ("order", "largest amplitude", f"speed of {a['wheel']}", "frequency", "time")),
        box=None,
    )
    tops = result["amplitude"][:, 1:].max("time")
    least = ROUNDING * float(abs(result["amplitude"]).max())
    for index in sorted(1 + i for i in tops.argsort().values[::-1][:5] if tops[i] > least):
        line = result.isel(order=int(index))
        at = line.isel(time=int(line["amplitude"].values.argmax()))
        table.add_row(
            f"{float(at['order']):.6g}",
            quantity(float(at["amplitude"]), units),
            f"{float(at['speed']) * RPM:.5g} rpm",
            f"{float(at['frequency']):.5g} Hz",
            f"{float(at['time']):.6g} s",
        )
    console.print(table)
