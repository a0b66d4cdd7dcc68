"""What the library does for Python: the program's commands, as functions."""

from __future__ import annotations

import ctypes
import json
import sys
import warnings
from ctypes import byref, c_int, c_void_p
from typing import TYPE_CHECKING, Any

from evolvent.errors import USAGE, AnalysisError, CaseWarning
from evolvent.library.binding import Error, ModesRequest, RespondRequest, StaticRequest, load
from evolvent.library.cases import (
    Case,
    Settings,
    encoded_or_none,
    error_of,
    opened,
    source_of,
    value_text,
)
from evolvent.library.waiting import call

if TYPE_CHECKING:
    from types import FrameType

    import xarray as xr

_DONE = 0


def _result(case: Case, settings: Settings, procedure: str, *request: Any) -> xr.Dataset:
    """What a procedure of the library records of a case."""
    with opened(case, settings) as handle:
        return _recorded(case, procedure, handle, *request)


def _recorded(case: Case, procedure: str, *arguments: Any) -> xr.Dataset:
    """What a procedure of the library records."""
    library, error, record = load(), Error(), c_void_p()

    def work(stop: c_int) -> int:
        return int(
            getattr(library, procedure)(*arguments, byref(stop), byref(record), byref(error))
        )

    try:
        code = call(work)
    except BaseException:
        library.evolvent_record_free(record)
        raise
    result = None
    if record.value is not None:
        from evolvent.library.records import dataset

        result = dataset(record.value)
    if code != _DONE:
        refusal = error_of(error, case)
        refusal.history = result
        raise refusal
    assert result is not None
    _warn(result.attrs["warnings"].splitlines())
    return result


def _warn(texts: list[str]) -> None:
    """Warn the caller of the package's function."""
    for text in texts:
        warnings.warn(text, CaseWarning, stacklevel=_depth())


def _depth() -> int:
    """Level of the first frame outside this package, as `warnings.warn` of the caller counts."""
    frame: FrameType | None = sys._getframe(1)
    depth = 1
    package = __name__.partition(".")[0]
    while frame is not None and frame.f_globals.get("__name__", "").partition(".")[0] == package:
        frame, depth = frame.f_back, depth + 1
    return depth


def _answer(case: Case, settings: Settings, procedure: str, *request: Any) -> dict[str, Any]:
    """What a procedure of the library tells of a case in JSON."""
    library, error = load(), Error()

    with opened(case, settings) as handle:
        if request:
            text = call(
                lambda stop: getattr(library, procedure)(
                    handle, *request, byref(stop), byref(error)
                )
            )
        else:
            text = getattr(library, procedure)(handle, byref(error))
    if text is None:
        raise error_of(error, case)
    try:
        answer: dict[str, Any] = json.loads(ctypes.string_at(text))
    finally:
        library.evolvent_text_free(text)
    return answer


def run(case: Case, set: Settings = None) -> xr.Dataset:
    """Integrate a case in this process, as `evolvent run` does.

    Other threads go on meanwhile. Ctrl-C ends the run with KeyboardInterrupt.

    Parameters
    ----------
    case : path of a case file, its text, or the mapping that such a text stands for.
    set : {path: value}, or a list of texts "PATH=VALUE", as --set takes them; a value may be a
        number, or a text such as "2 kN m".

    Returns
    -------
    History as `open_history` gives it, variable by variable and bit by bit, without a file;
    `open_events` takes it, too.

    Raises
    ------
    AnalysisError
        The case is refused, or cannot be integrated to its end; `history` is what there is.
    """
    return _result(case, set, "evolvent_run")


def static(
    case: Case,
    set: Settings = None,
    *,
    torque: str | float | tuple[float, float, int] | None = None,
    mesh: str | int | None = None,
    speed: str | float | None = None,
    points: int | None = None,
) -> xr.Dataset:
    """Put one mesh under torques at rest, as `evolvent static` does.

    Parameters
    ----------
    case, set : as of `run`.
    torque, mesh, speed, points : as the options of the program; a torque may be
        (from, to, steps) as well.

    Returns
    -------
    Dataset over torque [N m], position [pitches], pair and harmonic.

    Raises
    ------
    AnalysisError
        The case or what is asked for is refused.
    """
    if isinstance(torque, tuple):
        torque = ":".join(str(part) for part in torque)
    request = StaticRequest(
        mesh=encoded_or_none("mesh", mesh),
        torque=encoded_or_none("torque", torque),
        speed=encoded_or_none("speed", speed),
        points=encoded_or_none("points", points),
    )
    return _result(case, set, "evolvent_static", byref(request))


def respond(
    case: Case,
    set: Settings = None,
    *,
    over: str | tuple[str, str | float, str | float] | tuple[str, str | float, str | float, int],
    direction: str = "both",
    periods: int | None = None,
) -> xr.Dataset:
    """Follow the motion over a parameter that goes up and down, as `evolvent respond` does.

    Parameters
    ----------
    case, set : as of `run`.
    over : the parameter, its first and last value, and how many values there are: (path, from, to),
        (path, from, to, steps), or the text that the program takes.
    direction : "up", "down", or "both": up, and from there down.
    periods : common periods at a value, at most.

    Returns
    -------
    Dataset over direction and parameter, with the jumps, as in the file of the program.

    Raises
    ------
    AnalysisError
        The case, a value or the range is refused, or a motion cannot be integrated; `history` is
        what there is of the values before.
    """
    if isinstance(over, tuple | list) and len(over) > 0:
        path, *values = over
        over = f"{path}={':'.join(value_text(value, 'over') for value in values)}"
    if not isinstance(over, str):
        raise AnalysisError(
            USAGE, f"over={over!r}", "must be (path, from, to), (path, from, to, steps) or a text"
        )
    request = RespondRequest(
        over=encoded_or_none("over", over),
        direction=encoded_or_none("direction", direction),
        periods=encoded_or_none("periods", periods),
    )
    source = source_of(case, set)
    return _recorded(
        case,
        "evolvent_respond",
        source.name,
        source.text,
        len(source.options),
        source.options,
        byref(request),
    )


def modes(
    case: Case,
    set: Settings = None,
    *,
    at: str | float | None = None,
    mesh_position: float | None = None,
    mean: bool = False,
) -> dict[str, Any]:
    """Natural frequencies, damping and mode shapes: what `evolvent modes --json` prints.

    Parameters
    ----------
    case, set : as of `run`.
    at, mesh_position, mean : as the options of the program; at most one of them.

    Raises
    ------
    AnalysisError
        The case is refused, or cannot be linearised there.
    """
    request = ModesRequest(
        at=encoded_or_none("at", at),
        mesh_position=encoded_or_none("mesh_position", mesh_position),
        mean=int(mean),
    )
    return _answer(case, set, "evolvent_modes", byref(request))


def show(case: Case, set: Settings = None) -> dict[str, Any]:
    """The case with every default and its geometry: what `evolvent show --json` prints.

    Raises
    ------
    AnalysisError
        The case is refused.
    """
    return _answer(case, set, "evolvent_show")


def parameters(case: Case, set: Settings = None) -> dict[str, Any]:
    """The numbers that the case gives: {path: {"unit": ..., "value": ...}}, for `set`.

    Raises
    ------
    AnalysisError
        The case is refused.
    """
    return _answer(case, set, "evolvent_parameters")
