"""Name of a history in messages, and a variable of it by name."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from evolvent.errors import HistoryError

if TYPE_CHECKING:
    import xarray as xr


def source_name(history: xr.Dataset) -> str:
    """Name of the file that a history was opened from.

    Parameters
    ----------
    history : xarray.Dataset
        As from `open_history`.

    Returns
    -------
    str
        Name without the folder; "history" if it is from no file.

    Examples
    --------
    >>> import evolvent
    >>> from evolvent.history import source_name
    >>> source_name(evolvent.open_history("paper.h5"))
    'paper.h5'
    """
    return Path(str(history.encoding.get("source", "history"))).name


def file_label(path: str | Path) -> str:
    """Label of a history in legends and file names: its file name without the extensions.

    Parameters
    ----------
    path : str or Path
        File, or folder of parts, of a history.

    Returns
    -------
    str
        Name without the folder and without ".h5", ".partial" and ".parts".

    Examples
    --------
    >>> from evolvent.history import file_label
    >>> file_label("runs/pair.h5.partial")
    'pair'
    """
    name = Path(path).name.removesuffix(".partial").removesuffix(".parts")
    return name.removesuffix(".h5")


def require(history: xr.Dataset, name: str) -> xr.DataArray:
    """Return a variable of a history; raise `HistoryError` with the file name if it is missing.

    Parameters
    ----------
    history : xarray.Dataset
        As from `open_history`.
    name : str
        Name of the variable.

    Returns
    -------
    xarray.DataArray
        The variable.

    Raises
    ------
    HistoryError
        The history does not contain it.

    Examples
    --------
    >>> import evolvent
    >>> from evolvent.history import require
    >>> require(evolvent.open_history("paper.h5"), "penetration").dims
    ('time', 'mesh')
    """
    if name not in history:
        raise missing_error(source_name(history), name)
    return history[name]


def missing_error(source: str, name: str) -> HistoryError:
    """Error for a required variable that a history does not contain."""
    return HistoryError(
        f"{source}: has no variable `{name}`; run the case again with it among its outputs "
        "(`check` selects all variables for evolvent-post check)"
    )
