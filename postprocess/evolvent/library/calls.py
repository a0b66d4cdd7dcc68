"""Python interface of the library: the program's commands as functions."""

from __future__ import annotations

from ctypes import byref
from typing import TYPE_CHECKING, Any

from evolvent.errors import USAGE, AnalysisError
from evolvent.library.binding import Error, ModesRequest, RespondRequest, StaticRequest, load
from evolvent.library.cases import (
    Case,
    Settings,
    encoded_or_none,
    opened,
    source_of,
    value_text,
)
from evolvent.library.procedures import dataset_of, json_result, parsed, recorded, taken, text_of

if TYPE_CHECKING:
    import xarray as xr


def run(case: Case, set: Settings = None) -> xr.Dataset:
    """Integrate a case in this process, as `evolvent run` does.

    Other threads continue to run. Ctrl-C ends the run with KeyboardInterrupt.

    Parameters
    ----------
    case : str, Path or mapping
        Path of a case file, its text, or the equivalent mapping.
    set : mapping or list of str, optional
        {path: value}, or texts "PATH=VALUE" as `--set` takes them. A value is a number, or a
        text such as "2 kN m".

    Returns
    -------
    xarray.Dataset
        History as from `open_history`, with the same variables and bitwise equal values, without a
        file; `open_events` accepts it, too.

    Raises
    ------
    AnalysisError
        The case is rejected, or cannot be integrated to its end; `history` holds partial results.

    Examples
    --------
    >>> import evolvent
    >>> history = evolvent.run("examples/paper.yaml", {"simulation.duration": 0.1})
    >>> history.sizes["time"]
    101
    >>> history["normal_force"].attrs["units"]
    'N'
    """
    return dataset_of(case, set, "evolvent_run")


def static(
    case: Case,
    set: Settings = None,
    *,
    torque: str | float | tuple[float, float, int] | None = None,
    mesh: str | int | None = None,
    speed: str | float | None = None,
    points: int | None = None,
) -> xr.Dataset:
    """Compute a quasi-static analysis of one mesh over torques, as `evolvent static` does.

    Parameters
    ----------
    case : str, Path or mapping
        Path of a case file, its text, or the equivalent mapping.
    set : mapping or list of str, optional
        {path: value}, or texts "PATH=VALUE" as `--set` takes them. A value is a number, or a
        text such as "2 kN m".
    torque : str, float or tuple, optional
        Torque of the driving wheel [N m], a text as `--torque` takes it, or (from, to, steps); by
        default that of the loads. Negative torques load the coast flanks.
    mesh : str or int, optional
        Name or index of the mesh; by default the first one.
    speed : str or float, optional
        Speed of the driving wheel [rad/s], or a text such as "1500 rpm", at which the flanks rub;
        by default there is no friction.
    points : int, optional
        Number of positions over a pitch; by default 200.

    Returns
    -------
    xarray.Dataset
        Results over torque [N m], position [pitches], pair and harmonic.

    Raises
    ------
    AnalysisError
        The case or the request is rejected.

    Examples
    --------
    >>> import evolvent
    >>> result = evolvent.static("examples/compliant-pair.yaml", torque=(50.0, 150.0, 3))
    >>> result["torque"].values.tolist()
    [50.0, 100.0, 150.0]
    >>> result["peak_to_peak_transmission_error"].dims
    ('torque',)
    """
    if isinstance(torque, tuple):
        torque = ":".join(str(part) for part in torque)
    request = StaticRequest(
        mesh=encoded_or_none("mesh", mesh),
        torque=encoded_or_none("torque", torque),
        speed=encoded_or_none("speed", speed),
        points=encoded_or_none("points", points),
    )
    return dataset_of(case, set, "evolvent_static", byref(request))


def respond(
    case: Case,
    set: Settings = None,
    *,
    over: str | tuple[str, str | float, str | float] | tuple[str, str | float, str | float, int],
    direction: str = "both",
    periods: int | None = None,
) -> xr.Dataset:
    """Compute the response over a parameter swept up and down, as `evolvent respond` does.

    Parameters
    ----------
    case : str, Path or mapping
        Path of a case file, its text, or the equivalent mapping.
    set : mapping or list of str, optional
        {path: value}, or texts "PATH=VALUE" as `--set` takes them. A value is a number, or a
        text such as "2 kN m".
    over : str or tuple
        Parameter, first and last value, and number of values: (path, from, to),
        (path, from, to, steps), or the text that `--over` takes. By default 101 values.
    direction : str, optional
        "up", "down", or "both": up, and from there down.
    periods : int, optional
        Maximum number of common periods at a value; by default 25 time constants of the slowest
        mode, at least 600 pitches.

    Returns
    -------
    xarray.Dataset
        Results over direction and parameter, with the jumps, as in the file of the program.

    Raises
    ------
    AnalysisError
        The case, a value or the range is rejected, or a motion cannot be integrated; `history`
        holds the results at the values before.

    Examples
    --------
    >>> import evolvent
    >>> response = evolvent.respond(
    ...     "examples/spur-pair.yaml",
    ...     over=("meshes.pinion-gear.damping.value", 0.05, 0.1, 2),
    ...     direction="up",
    ... )
    >>> response.sizes["parameter"]
    2
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
    return recorded(
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
    """Compute natural frequencies, damping and mode shapes, as `evolvent modes --json` does.

    Parameters
    ----------
    case : str, Path or mapping
        Path of a case file, its text, or the equivalent mapping.
    set : mapping or list of str, optional
        {path: value}, or texts "PATH=VALUE" as `--set` takes them. A value is a number, or a
        text such as "2 kN m".
    at : str or float, optional
        Time [s], or a text such as "20 ms", up to which the case is integrated and at which it is
        linearised.
    mesh_position : float, optional
        Linearise the steady state at this distance of the first mesh from the start of contact
        [pitches].
    mean : bool, optional
        Linearise at all positions of the meshes and take the mean. At most one of `at`,
        `mesh_position` and `mean` may be given; by default the steady state is linearised.

    Returns
    -------
    dict
        The JSON output of the program.

    Raises
    ------
    AnalysisError
        The case is rejected, or cannot be linearised there.

    Examples
    --------
    >>> import evolvent
    >>> result = evolvent.modes("examples/paper.yaml")
    >>> frequencies = [mode["natural_frequency"] for mode in result["modes"]]  # None: rigid body
    >>> [f"{frequency:.0f} Hz" for frequency in frequencies if frequency is not None]
    ['331 Hz', '1147 Hz']
    """
    request = ModesRequest(
        at=encoded_or_none("at", at),
        mesh_position=encoded_or_none("mesh_position", mesh_position),
        mean=int(mean),
    )
    return json_result(case, set, "evolvent_modes", byref(request))


def show(case: Case, set: Settings = None) -> dict[str, Any]:
    """Return the case with all defaults and its geometry, as `evolvent show --json` does.

    Parameters
    ----------
    case : str, Path or mapping
        Path of a case file, its text, or the equivalent mapping.
    set : mapping or list of str, optional
        {path: value}, or texts "PATH=VALUE" as `--set` takes them. A value is a number, or a
        text such as "2 kN m".

    Returns
    -------
    dict
        The JSON output of the program.

    Raises
    ------
    AnalysisError
        The case is rejected.

    Examples
    --------
    >>> import evolvent
    >>> shown = evolvent.show("examples/spur-pair.yaml")
    >>> round(shown["meshes"]["pinion-gear"]["contact_ratio"], 3)
    1.496
    """
    return json_result(case, set, "evolvent_show")


def parameters(case: Case, set: Settings = None) -> dict[str, Any]:
    """Return the numerical values of a case by their paths for `set`.

    Parameters
    ----------
    case : str, Path or mapping
        Path of a case file, its text, or the equivalent mapping.
    set : mapping or list of str, optional
        {path: value}, or texts "PATH=VALUE" as `--set` takes them. A value is a number, or a
        text such as "2 kN m".

    Returns
    -------
    dict
        {path: {"unit": ..., "value": ...}}.

    Raises
    ------
    AnalysisError
        The case is rejected.

    Examples
    --------
    >>> import evolvent
    >>> evolvent.parameters("examples/paper.yaml")["simulation.duration"]
    {'unit': 's', 'value': 5}
    """
    return json_result(case, set, "evolvent_parameters")


def datasheet(case: Case, set: Settings = None, *, mesh: str | int | None = None) -> dict[str, Any]:
    """Return the data sheet of a mesh, as `evolvent datasheet --json` does.

    Parameters
    ----------
    case : str, Path or mapping
        Path of a case file, its text, or the equivalent mapping.
    set : mapping or list of str, optional
        {path: value}, or texts "PATH=VALUE" as `--set` takes them. A value is a number, or a
        text such as "2 kN m".
    mesh : str or int, optional
        Name or index; by default the first mesh.

    Returns
    -------
    dict
        The JSON output of the program.

    Raises
    ------
    AnalysisError
        The case is rejected, or has no such mesh.

    Examples
    --------
    >>> import evolvent
    >>> rows = evolvent.datasheet("examples/spur-pair.yaml")["rows"]
    >>> [round(row["values"][0], 3) for row in rows if row["key"] == "contact_ratio"]
    [1.496]
    """
    return parsed(text_of(case, set, "evolvent_datasheet", encoded_or_none("mesh", mesh), 0))


def datasheets_html(text: str, name: str, meshes: list[str]) -> list[str]:
    """Return the data sheets of meshes as HTML elements `section`, each with its style.

    Parameters
    ----------
    text : of the case.
    name : shown as its name.
    """
    error = Error()
    with opened(text, None, name) as case:
        return [
            taken(
                load().evolvent_datasheet(case, encoded_or_none("mesh", mesh), 1, byref(error)),
                text,
                error,
            )
            for mesh in meshes
        ]
