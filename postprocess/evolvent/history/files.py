"""Open a history file, or that of another analysis.

As datasets of xarray, or as a recording, which is read in pieces without xarray. Only this module
and `kinds` depend on the file layout; docs/reference/result_format.md describes it.
"""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

from evolvent.checksums import BROKEN, NONE, check
from evolvent.errors import UNREADABLE, HistoryError, has_system_error, is_of_system, reason_of
from evolvent.history.kinds import HISTORY, check_format, check_kind

if TYPE_CHECKING:
    import h5py
    import xarray as xr

    from evolvent.history.recording import Recording

EVENTS = "events"  # group of a file; else key in `encoding` of the function that makes it
EVENT = "event"  # dimension of events, and the variable of their numbers
DONE, RUNNING = "done", "running"  # values of the attribute `status`


def open_history(path: str | Path) -> xr.Dataset:
    """Open a history.

    Values are read on first use. Close the dataset, or use it in a `with` statement, to release the
    file. Histories of unfinished runs can be opened as well: see `run_warning`.

    Parameters
    ----------
    path : str or Path
        File written by `evolvent run`, its NAME.partial, or the folder NAME.parts of a run with
        checkpoints: its closed parts together.

    Returns
    -------
    xarray.Dataset
        Variables over time [s], wheel, mesh and axis (x, y), in SI units and radians, each with
        `units`, `long_name` and `symbol`. `case`, the whole resolved case, and the counts and
        versions of the run are attributes.

    Raises
    ------
    HistoryError
        No such file, not HDF5, no history, or of a newer format than this package reads.

    Examples
    --------
    >>> import evolvent
    >>> with evolvent.open_history("paper.h5") as history:
    ...     print(history["mesh"].values.tolist(), history["penetration"].attrs["units"])
    ['pinion-gear'] m
    """
    return open_result(path, HISTORY)


def open_result(path: str | Path, *kinds: str) -> xr.Dataset:
    """Open the file of an analysis of one of these kinds; `result_kind` returns the kind.

    A static analysis has the dimensions torque [N m], position [pitches], pair and harmonic.

    Parameters
    ----------
    path : str or Path
        File of an analysis.
    *kinds : str
        Accepted kinds, such as `STATIC` and `RESPONSE` of this package.

    Returns
    -------
    xarray.Dataset
        Contents of the file.

    Raises
    ------
    HistoryError
        As for `open_history`; or the file is of another kind.

    Examples
    --------
    >>> from evolvent.history import HISTORY, STATIC, open_result, result_kind
    >>> with open_result("paper.h5", HISTORY, STATIC) as result:
    ...     print(result_kind(result))
    history
    """
    path = Path(path)
    result = _open(path, None)
    try:
        check_format(path, result.attrs)
        check_kind(path, result.attrs, result.sizes, kinds)
    except HistoryError:
        result.close()
        raise
    return result


@contextmanager
def open_recording(path: str | Path) -> Iterator[Recording]:
    """Open a history for reading in pieces, with h5py alone.

    Parameters
    ----------
    path : str or Path
        As for `open_history`.

    Yields
    ------
    Recording
        The history; it is closed at the end of the `with` statement.

    Raises
    ------
    HistoryError
        As for `open_history`.

    Examples
    --------
    >>> from evolvent.history import open_recording
    >>> with open_recording("paper.h5") as recording:
    ...     print(sum(part.n for part in recording.parts()) == recording.n)
    True
    """
    path = Path(path)
    _check_file(path)
    with ExitStack() as stack:
        with _readable(path):
            if path.is_dir():
                from evolvent.history.parts import recording_of_parts

                recording = stack.enter_context(recording_of_parts(path, path.name))
            else:
                recording = stack.enter_context(_recording_of_file(path))
        check_format(path, recording.attrs)
        check_kind(path, recording.attrs, recording.sizes, (HISTORY,))
        yield recording


@contextmanager
def _recording_of_file(path: Path) -> Iterator[Recording]:
    import h5py

    from evolvent.history.recording import of_file

    # A chunk cache would take a megabyte per variable; rows are read once, in order.
    file = h5py.File(path, "r", rdcc_nbytes=0)
    try:
        yield of_file(file, path.name)
    finally:
        _close(path, file)


def verify_checksum(path: Path) -> str | None:
    """Verify the checksum of a file, or of each closed part; reads all data.

    Returns
    -------
    Warning for a complete file without a checksum, or None.

    Raises
    ------
    HistoryError
        It is damaged.
    """
    _check_file(path)
    if path.is_dir():
        from evolvent.history.parts import closed_parts

        return next(filter(None, [verify_checksum(part) for part in closed_parts(path)]), None)
    with _readable(path):
        status = check(path)
    if status == BROKEN:
        raise HistoryError(f"{path}: is damaged, or was changed: its checksum is wrong")
    if status == NONE and not path.name.endswith(".partial"):
        return "has no checksum, so damage would not be detected"
    return None


def open_events(path: str | Path | xr.Dataset) -> xr.Dataset:
    """Open the located events of a history.

    Parameters
    ----------
    path : str, Path or xarray.Dataset
        As for `open_history`, or the history returned by `evolvent.run`.

    Returns
    -------
    xarray.Dataset
        Variables over event and side (before, after): `time` [s] (event); `kind` (event), decoded
        to names such as "tooth_switch"; `mesh` (event), an index from 0, -1 if the event concerns
        no mesh; `tooth_pair` (event), pitches since the start; every state (event, side).

    Raises
    ------
    HistoryError
        As for `open_history`, or if there is no group of events.

    Examples
    --------
    >>> import evolvent
    >>> evolvent.open_events("paper.h5")["kind"].values.tolist()
    ['tooth_switch', 'tooth_switch']
    """
    if not isinstance(path, str | Path):
        make = path.encoding.get(EVENTS)
        if make is None:
            raise HistoryError("the dataset contains no events; give the path of its file")
        return _name_kinds(make())
    path = Path(path)
    with open_recording(path):  # rejects files that are not histories
        events = _open(path, EVENTS, EVENT)
    if "kind" not in events:
        events.close()
        raise HistoryError(f"{path}: the group `events` has no variable `kind`")
    decoded = _name_kinds(events)
    decoded.set_close(events.close)  # else the file would be closed at exit of Python, or never
    return decoded


def _name_kinds(events: xr.Dataset) -> xr.Dataset:
    return events.assign(kind=_decode_flags(events["kind"]))


def run_warning(history: xr.Dataset | Recording) -> str | None:
    """Return a warning about the end of a run: why it stopped, or that contact was lost.

    Parameters
    ----------
    history : xarray.Dataset or Recording
        As from `open_history`, or the result of a static analysis.

    Returns
    -------
    str or None
        One line, with the last output of an unfinished run; None if the run reached its end without
        a message.

    Examples
    --------
    >>> import evolvent
    >>> print(evolvent.run_warning(evolvent.open_history("paper.h5")))
    None
    """
    status = history.attrs.get("status")
    message = str(history.attrs.get("status_message", ""))
    if status == DONE:
        return message or None
    if status in (None, RUNNING):
        text = "the run is still active or was killed: its file was not closed"
    else:
        text = f"the run did not finish: {message or status}"
    axis, symbol, unit = ("time", "t", "s") if "time" in history.sizes else ("torque", "T", "N m")
    if history.sizes[axis] == 0:
        return f"{text} (there is no output)"
    return f"{text} (last output at {symbol} = {float(history[axis][-1]):.6g} {unit})"


def rows_between(history: xr.Dataset, begin: float, end: float) -> slice:
    """Rows of times from `begin` to `end`, both included: a slice, without a copy.

    Parameters
    ----------
    history : xarray.Dataset
        As from `open_history`.
    begin, end : float
        Times [s].

    Returns
    -------
    slice
        Rows of the history.

    Examples
    --------
    >>> import evolvent
    >>> from evolvent.history import rows_between
    >>> rows_between(evolvent.open_history("paper.h5"), 1.0, 2.0)
    slice(1000, 2001, None)
    """
    time = history["time"].values
    first = int(time.searchsorted(begin, "left"))
    return slice(first, max(int(time.searchsorted(end, "right")), first))


def _open(path: Path, group: str | None, axis: str = "time") -> xr.Dataset:
    _check_file(path)
    if not path.is_dir():
        return _open_file(path, group)
    from evolvent.history.parts import closed_parts, joined_dataset

    parts = [_open_file(part, group) for part in closed_parts(path)]
    return joined_dataset(parts, axis, str(path), EVENT if group == EVENTS else None)


def _open_file(path: Path, group: str | None) -> xr.Dataset:
    import xarray as xr

    with _readable(path, group):
        # Times stay seconds since the start of the run; xarray would convert some units to dates.
        opened = xr.open_dataset(
            path, engine="h5netcdf", group=group, decode_times=False, phony_dims="access"
        )
    wrapped = opened.copy(deep=False)  # its `close` reports the file that could not be closed
    wrapped.set_close(partial(_close, path, opened))
    return wrapped


def _close(path: Path, opened: xr.Dataset | h5py.File) -> None:
    try:
        opened.close()
    except Exception as error:
        if not is_of_system(error):
            raise
        raise HistoryError(f"{path}: cannot be read ({reason_of(error)})") from error


def _check_file(path: Path) -> None:
    if not path.exists():
        unfinished = path.with_name(path.name + ".partial")
        parts = path.with_name(path.name + ".parts")
        there = next((other.name for other in (unfinished, parts) if other.exists()), None)
        hint = f"; its run did not finish, but there is {there}" if there else ""
        raise HistoryError(f"{path}: no such file{hint}")
    if path.is_dir() and not path.name.endswith(".parts"):
        raise HistoryError(f"{path}: is a folder, not a history")


@contextmanager
def _readable(path: Path, group: str | None = None) -> Iterator[None]:
    """Report why a file cannot be opened."""
    try:
        yield
    except PermissionError as error:
        raise HistoryError(f"{path}: cannot be read: permission denied") from error
    except BlockingIOError as error:
        raise HistoryError(f"{path}: is being written; wait until its run has ended") from error
    except UNREADABLE as error:
        if has_system_error(error):
            raise HistoryError(f"{path}: cannot be read ({reason_of(error)})") from error
        if group is not None:
            raise HistoryError(f"{path}: has no readable group `{group}`") from error
        raise HistoryError(f"{path}: is not a readable HDF5 file ({reason_of(error)})") from error


def _decode_flags(flags: xr.DataArray) -> xr.DataArray:
    """Replace the values of a CF flag variable by their meanings."""
    meanings = str(flags.attrs.get("flag_meanings", "")).split()
    import numpy as np
    import xarray as xr

    values: list[Any] = np.atleast_1d(flags.attrs.get("flag_values", [])).tolist()
    names = dict(zip(values, meanings, strict=False))
    decoded = np.array([names.get(int(k), f"kind_{int(k)}") for k in flags.values], dtype=object)
    attrs = {k: v for k, v in flags.attrs.items() if not k.startswith("flag_")}
    return xr.DataArray(decoded, dims=flags.dims, attrs=attrs)
