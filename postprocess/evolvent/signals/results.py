"""Results as datasets by the conventions of a history: named axes, units, processing."""

from __future__ import annotations

from typing import Any

import numpy as np
import xarray as xr

from evolvent.history import (
    CAMPBELL,
    DONE,
    NEWEST_FORMAT,
    ORDER_MAP,
    SPECTRUM,
    file_label,
    source_name,
)
from evolvent.signals.campbell import Crossing, Excitation
from evolvent.signals.order_map import OrderMap
from evolvent.signals.resampling import DEGREE
from evolvent.signals.sampling import Record
from evolvent.signals.spectrum import Lines
from evolvent.signals.turning import TURN, Turning
from evolvent.signals.window_names import RECTANGULAR
from evolvent.signals.windows import noise_bandwidth, window
from evolvent.version import __version__

SCALING = (
    "The height of a line is the amplitude of its sine, half of peak to peak. The mean and the "
    "line at half the sampling rate are not doubled."
)
OVER = {"mesh": "xi", "wheel": "u"}


def spectrum_result(
    history: xr.Dataset, signal: xr.DataArray, record: Record, lines: Lines, name: str
) -> xr.Dataset:
    """Dataset of a spectrum.

    Parameters
    ----------
    history, signal : source of the spectrum.
    record : the samples.
    lines : of these.
    name : of the window.
    """
    over, unit = ("frequency", "Hz") if record.of is None else ("order", "1")
    coords: dict[str, Any] = {over: (over, lines.abscissa, _over_attrs(record.of))}
    if record.of is not None:
        at_speed = _named("Hz", f"frequency at the mean speed, {record.rate:.6g} times the order")
        coords["frequency"] = (over, lines.abscissa * record.rate, at_speed)
    bandwidth = noise_bandwidth(window(name, record.values.size)) / record.periods
    return xr.Dataset(
        {
            "amplitude": (over, lines.amplitude, _amplitude(signal)),
            "phase": (over, lines.phase, _named("rad", f"phase in {_definition(record.of)}")),
            "line_spacing": ((), 1 / record.periods, _named(unit, "from line to line")),
            "noise_bandwidth": ((), bandwidth, _named(unit, "equivalent noise bandwidth")),
            **_speed((), record.rate, record.of),
        },
        coords=coords,
        attrs=_attributes(SPECTRUM, history) | _what(history, signal, record, name),
    )


def order_map_result(
    history: xr.Dataset, signal: xr.DataArray, record: Record, found: OrderMap, name: str
) -> xr.Dataset:
    """Dataset of an order map, dims (time, order)."""
    assert record.of is not None
    dims = ("time", "order")
    length = 1 / found.order[1]
    coords: dict[str, Any] = {
        "time": ("time", found.time, _named("s", "middle of the window")),
        "order": ("order", found.order, _over_attrs(record.of)),
        "frequency": (dims, np.outer(found.rate, found.order), _named("Hz", "frequency")),
    }
    return xr.Dataset(
        {
            "amplitude": (dims, found.amplitude, _amplitude(signal)),
            "phase": (dims, found.phase, _named("rad", f"phase in {_definition(record.of)}")),
            "window_length": ((), length, _named("1", f"{record.of.periods} of a window")),
            **_speed(("time",), found.rate, record.of),
        },
        coords=coords,
        attrs=_attributes(ORDER_MAP, history) | _what(history, signal, record, name),
    )


def campbell_result(
    case: str,
    label: str,
    wheel: str,
    speed: np.ndarray,
    modes: dict[str, np.ndarray],
    computed: np.ndarray,
    excitations: list[Excitation],
    found: list[Crossing],
) -> xr.Dataset:
    """Dataset of a Campbell diagram.

    Parameters
    ----------
    case : the resolved case, as text.
    label : of the case, for legends.
    wheel : whose speed is the axis.
    speed : speeds of this wheel [rad/s].
    modes : natural_frequency [Hz] and damping_ratio, dims (speed, mode).
    computed : whether the modes are of this speed, or taken from others; dims (speed).
    excitations, found : orders, and their crossings with modes.
    """
    names = np.array([str(excitation) for excitation in excitations], dtype=object)
    order = [e.order * e.per_turn for e in excitations]
    at = "crossing"
    kinds = {"natural_frequency": ("Hz", "natural frequency"), "damping_ratio": ("1", "damping")}
    return xr.Dataset(
        {
            **{
                name: (("speed", "mode"), values, _named(*kinds[name]))
                for name, values in modes.items()
            },
            "is_computed": (
                "speed", computed.astype(np.int32), _named("1", "1 if the modes are of this speed"),
            ),
            "excitation_order": (
                "excitation", order, _named("1", f"events per revolution of {wheel}"),
            ),
            "is_mesh": (
                "excitation",
                np.array([e.kind == "mesh" for e in excitations], dtype=np.int32),
                _named("1", "1 for an order of a mesh, 0 for a wheel"),
            ),
            "crossing_speed": (at, [c.speed for c in found], _named("rad s-1", f"of {wheel}")),
            "crossing_frequency": (at, [c.frequency for c in found], _named("Hz", "frequency")),
            "crossing_mode": (
                at, np.array([c.mode + 1 for c in found], dtype=np.int32),
                _named("1", "mode, from 1"),
            ),
            "crossing_excitation": (
                at, np.array([c.excitation for c in found], dtype=np.int32),
                _named("1", "index of the excitation, from 0"),
            ),
        },
        coords={
            "speed": ("speed", speed, _named("rad s-1", f"speed of {wheel}")),
            "mode": ("mode", np.arange(1, modes["natural_frequency"].shape[1] + 1)),
            "excitation": ("excitation", names),
        },
        attrs=_common(CAMPBELL) | {"case": case, "source": label, "wheel": wheel},
    )  # fmt: skip


def _wheel(history: xr.Dataset, of: Turning) -> str:
    """Wheel whose speed is given with orders: the driving wheel for a mesh."""
    return str(history["wheel"].values[of.wheel])


def describe_sampling(record: Record) -> str:
    """Describe how the samples were obtained from the rows."""
    if not record.resampled:
        return "rows without resampling"
    return f"resampled by a spline of degree {DEGREE} from {record.rows:.4g} rows or more a period"


def _common(kind: str) -> dict[str, Any]:
    return {
        "Conventions": "CF-1.10",
        "evolvent_format": NEWEST_FORMAT,
        "evolvent_kind": kind,
        "status": DONE,
        "status_message": "",
        "versions": f"evolvent-post {__version__}",
    }


def _attributes(kind: str, history: xr.Dataset) -> dict[str, Any]:
    source = source_name(history)
    return _common(kind) | {
        "title": str(history.attrs.get("title", "")),
        "case": str(history.attrs.get("case", "")),
        "source": source,
        "label": file_label(source),
    }


def _what(history: xr.Dataset, signal: xr.DataArray, record: Record, name: str) -> dict[str, Any]:
    """Signal and processing parameters."""
    return {
        "quantity": str(signal.name),
        "quantity_long_name": str(signal.attrs.get("long_name", signal.name)),
        "place": str(signal.attrs["place"]),
        "order_of": "" if record.of is None else str(record.of),
        "wheel": "" if record.of is None else _wheel(history, record.of),
        "periods": "" if record.of is None else record.of.counted(record.periods),
        "begin": float(record.time[0]),
        "end": float(record.time[-1]),
        "samples": int(record.values.size),
        "sampling": describe_sampling(record),
        "window": name,
        "scaling": SCALING,
        "leakage": (
            "none of periodic signals: whole periods"
            if name == RECTANGULAR and record.of is not None
            else "see docs/guides/signals.md for the window"
        ),
    }


def _speed(dims: tuple[str, ...], rate: Any, of: Turning | None) -> dict[str, Any]:
    if of is None:
        return {}
    text = "mean speed of the driving wheel" if of.kind == "mesh" else "mean speed of the wheel"
    return {"speed": (dims, rate / of.per_turn * TURN, _named("rad s-1", text))}


def _over_attrs(of: Turning | None) -> dict[str, str]:
    return _named("Hz", "frequency") if of is None else _named("1", f"order of {of}")


def _definition(of: Turning | None) -> str:
    s = "f t" if of is None else f"n {OVER[of.kind]}"
    return f"A cos(2 pi {s} - phase)"


def _amplitude(signal: xr.DataArray) -> dict[str, str]:
    what = str(signal.attrs.get("long_name", signal.name))
    return _named(str(signal.attrs.get("units", "1")), f"amplitude of {what}")


def _named(units: str, long_name: str) -> dict[str, str]:
    return {"units": units, "long_name": long_name}
