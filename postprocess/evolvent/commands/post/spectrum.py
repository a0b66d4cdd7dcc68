"""The command evolvent-post spectrum."""

from __future__ import annotations

import json
import math
from typing import TYPE_CHECKING, Annotated, Any

from evolvent.commands.command_line import WrongUsageError, option
from evolvent.commands.post.common import AsJson, Files, complain, labels
from evolvent.commands.post.signal_options import (
    RPM,
    OptionOutput,
    OptionWindow,
    Signal,
    check_outputs,
    open_signal,
    write_outputs,
)
from evolvent.commands.program import json_number, new_console, right, say
from evolvent.units import displayed, quantity

if TYPE_CHECKING:
    import xarray as xr


def spectrum(
    files: Files,
    output: OptionOutput = None,
    order_of: Annotated[
        str | None,
        option(
            "--order-of NAME",
            "Orders refer to this mesh or wheel. If not given, the spectrum is over frequency, or "
            "for histories with outputs by angle over the order of their mesh or wheel.",
        ),
    ] = None,
    *,
    signal: Signal,
    periods: Annotated[
        int | None,
        option(
            "--periods N", "Use only the last N periods; if not given, all whole periods.", min=1
        ),
    ] = None,
    window: OptionWindow = None,
    highest: Annotated[
        float | None, option("--highest X", "Highest order, or highest frequency [Hz].", min=0.0)
    ] = None,
    count: Annotated[
        int, option("--lines N", "Number of the largest lines in the table.", min=1)
    ] = 10,
    as_json: AsJson = False,
) -> None:
    """Compute the spectrum of a signal: amplitudes and phases over frequency or order.

    \b
    Amplitudes are those of sines (half the peak-to-peak value). The mean is a separate line.
    Phases are defined by A cos(2 pi n xi - phase). xi is in pitches from the start of contact of
    pair 0, in revolutions since the start, or in periods since t = 0.
    Example:
      evolvent-post spectrum compliant-pair.h5 --order-of pinion-gear -o orders.png -o orders.h5
      evolvent-post spectrum compliant-pair.h5 spur-pair.h5 --from 0.02 -o frequencies.png
      evolvent-post spectrum two-stage-gears.h5 --order-of motor --mesh first --lines 5
    """  # noqa: D301 - \b keeps click from filling the lines
    check_outputs(output, len(files))
    chosen = signal.columns.chosen(signal.mesh)
    results = []
    for path, label in zip(files, labels(files), strict=True):
        history, values = open_signal(path, signal.name, chosen, signal.times)
        with history:
            result = make_spectrum(history, values, order_of, periods, window, highest)
        results.append((label, result))
    written = write_outputs(output, results, "spectrum")
    if as_json:
        say(json.dumps([_as_json(result, count) for _, result in results], indent=2))
        return
    for _, result in results:
        _print(result, count)
    for path in written:
        say(path)


def make_spectrum(
    history: xr.Dataset,
    signal: xr.DataArray,
    order_of: str | None,
    periods: int | None,
    shape: str | None,
    highest: float | None,
) -> xr.Dataset:
    """Compute the spectrum of one signal; warn if a changing speed smears its lines."""
    from evolvent.history import source_name
    from evolvent.signals import results, sampling
    from evolvent.signals.spectrum import line_spectrum
    from evolvent.signals.window_names import HANN, RECTANGULAR
    from evolvent.signals.windows import window as window_of

    label = source_name(history)
    of = sampling.counted_over(history, order_of)
    record = sampling.read_record(history, signal, of)
    if of is not None:
        record = sampling.last_periods(record, label, periods)
    elif periods is not None:
        raise WrongUsageError("requires --order-of", "--periods")
    elif (change := sampling.speed_change(history)) > sampling.STEADY:
        complain(
            f"{label}: the speed changes by {100 * change:.2g} %, which smears lines over "
            "frequency; use --order-of NAME, or evolvent-post waterfall"
        )
    reach = sampling.check_reach(record, label, highest, 1 / record.periods)
    name = str(shape or (HANN if of is None else RECTANGULAR))
    weights = window_of(name, record.values.size)
    lines = line_spectrum(record.values, record.first, record.step, weights).upto(reach)
    return results.spectrum_result(history, signal, record, lines, name)


def _print(result: xr.Dataset, count: int) -> None:
    """Print a description of the spectrum, and its largest lines."""
    from rich.table import Table

    console = new_console()
    for line in describe(result):
        console.print(line, highlight=False, markup=False)
    over = str(result["amplitude"].dims[0])
    units = str(result["amplitude"].attrs["units"])
    columns = ["frequency"] if over == "frequency" else ["order", "frequency"]
    table = Table(*map(right, [*columns, "amplitude", "phase"]), box=None)
    table.add_row(
        *[""] * (len(columns) - 1), "mean", quantity(float(result["amplitude"][0]), units), ""
    )
    for i in largest(result, count):
        one = result.isel({over: i})
        cells = [] if over == "frequency" else [f"{float(one['order']):.6g}"]
        table.add_row(
            *cells,
            f"{float(one['frequency']):.6g} Hz",
            quantity(float(one["amplitude"]), units),
            f"{math.degrees(float(one['phase'])):.1f}°",
        )
    console.print(table)


def describe(result: xr.Dataset) -> list[str]:
    """Describe the signal and the processing of a spectrum in two or three lines."""
    a = result.attrs
    place = f" of {a['place']}" if a["place"] else ""
    what = f"{a['source']}: {a['quantity']}{place}, t = {a['begin']:.6g} to {a['end']:.6g} s"
    spacing = float(result["line_spacing"])
    bandwidth = float(result["noise_bandwidth"])
    if not a["order_of"]:
        return [
            what,
            f"{a['window']} window over {a['samples']} outputs: a line every {spacing:.4g} Hz, "
            f"noise bandwidth {bandwidth:.4g} Hz",
        ]
    rate = float(result["frequency"][-1] / result["order"][-1])
    rpm = float(result["speed"]) * RPM
    return [
        what,
        f"{a['window']} window over {a['periods']} of {a['order_of']} at {rate:.6g} Hz, "
        f"{rpm:.6g} rpm of {a['wheel']}; {a['sampling']}",
        f"a line every {spacing:.4g} orders, noise bandwidth {bandwidth:.4g} orders",
    ]


def largest(result: xr.Dataset, count: int) -> list[int]:
    """Indices of the largest lines, in the order of amplitude."""
    from evolvent.signals.spectrum import Lines, peaks

    over = str(result["amplitude"].dims[0])
    return peaks(
        Lines(result[over].values, result["amplitude"].values, result["phase"].values), count
    )


def _as_json(result: xr.Dataset, count: int) -> dict[str, Any]:
    names = [n for n in ("order", "frequency", "amplitude", "phase") if n in result.variables]
    over = str(result["amplitude"].dims[0])
    rows = [
        {name: json_number(float(result[name][i])) for name in names}
        for i in largest(result, count)
    ]
    copied = ("source", "quantity", "place", "order_of", "window", "sampling", "begin", "end")
    return {
        **{name: result.attrs[name] for name in copied},
        "units": displayed(str(result["amplitude"].attrs["units"])),
        "mean": json_number(float(result["amplitude"].isel({over: 0}))),
        "line_spacing": float(result["line_spacing"]),
        "noise_bandwidth": float(result["noise_bandwidth"]),
        "lines": rows,
    }
