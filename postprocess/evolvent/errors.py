"""Exceptions, and files that are written completely or not at all."""

from __future__ import annotations

import errno
import io
import os
import re
import secrets
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import TYPE_CHECKING, Any, BinaryIO, cast

if TYPE_CHECKING:
    import xarray as xr

OF_SYSTEM = re.compile(r"errno = \d+, error message = '([^']*)'")  # in messages of HDF5
OF_FILE = re.compile(r"filename = '([^']*)'")
FAILED_CASES, USAGE, BAD_INPUT, NOT_WRITTEN, INTERRUPTED = 1, 2, 3, 74, 75


class EvolventError(Exception):
    """Base class of errors; the message gives object, value, location and remedy.

    Parameters
    ----------
    message : one line.
    code : exit code of a program that ends with it.
    """

    def __init__(self, message: str, code: int = BAD_INPUT) -> None:
        super().__init__(message)
        self.code = code


class HistoryError(EvolventError):
    """A file that cannot be used as a history; the message names the file and the reason.

    Parameters
    ----------
    message : one line.
    code : exit code of a program that ends with it.
    """


class AnalysisError(EvolventError):
    """Failure of a library function; `str` gives the line that the program would end with.

    Parameters
    ----------
    code : exit code of the program.
    place : location such as "CASE.yaml:12:5", or the setting or argument; "" if there is none.
    reason : error and remedy.
    """

    def __init__(self, code: int, place: str, reason: str) -> None:
        super().__init__(f"{place or 'evolvent'}: {reason}", code)
        self.place, self.reason = place, reason
        self.history: xr.Dataset | None = None  # results before the failure

    def __reduce__(self) -> tuple[Any, ...]:
        """Pickle the error without its history."""
        return type(self), (self.code, self.place, self.reason)


class CaseWarning(UserWarning):
    """Warning of the program about an accepted case, such as a value of an implausible size."""


class SweepError(EvolventError):
    """Failure of evolvent-sweep."""

    def at(self, place: str) -> SweepError:
        """Return the same error with a location in front, unless it starts with that location."""
        message = str(self)
        return SweepError(
            message if message.startswith(place) else f"{place}: {message}", self.code
        )


# Raised by h5py, h5netcdf and xarray for a file; the last if a dimension has lost its name.
UNREADABLE = (OSError, KeyError, ValueError, RuntimeError, AttributeError)


def reason_of(error: Exception) -> str:
    """Message of an error of the system or a library, in one line."""
    if isinstance(error, AttributeError):
        return "a name in it cannot be read"
    text = str(getattr(error, "strerror", None) or error)
    by_hdf5 = OF_SYSTEM.search(text)
    return by_hdf5[1] if by_hdf5 else " ".join(text.split())


def is_of_system(error: Exception) -> bool:
    """Whether an error comes from the operating system; HDF5 reports it in errors of all types."""
    return isinstance(error, OSError) or OF_SYSTEM.search(str(error)) is not None


def has_system_error(error: BaseException) -> bool:
    """Whether an error of HDF5 contains an error of the operating system."""
    return OF_SYSTEM.search(str(error)) is not None


def is_hdf5_broken(error: BaseException) -> bool:
    """Whether an operation of HDF5 failed in the operating system: HDF5 may then crash at exit.

    It does so after a file that could not be closed, in C as in Python, up to HDF5 2.0 at least.
    """
    cause = error.__cause__ or error.__context__
    return has_system_error(error) or (cause is not None and is_hdf5_broken(cause))


def file_of(error: Exception) -> str:
    """Name of the file in an error, followed by a colon; "" if the error gives none."""
    by_hdf5 = OF_FILE.search(str(error))
    name = by_hdf5[1] if by_hdf5 else getattr(error, "filename", None)
    return f"{name}: " if name else ""


@contextmanager
def needing(extra: str, what: str, code: int = BAD_INPUT) -> Iterator[None]:
    """Report which feature needs a missing library, and how to install it.

    Raises
    ------
    SweepError
        It could not be imported.
    """
    try:
        yield
    except ImportError as error:
        raise SweepError(
            f"{what}; install it with: pip install 'evolvent[{extra}]'", code
        ) from error


@contextmanager
def writing(path: Path) -> Iterator[None]:
    """Report which file or folder cannot be written.

    Raises
    ------
    EvolventError
        It cannot be written.
    """
    try:
        yield
    except Exception as error:
        if not is_of_system(error):
            raise
        raise EvolventError(
            f"{path}: cannot be written ({reason_of(error)})", NOT_WRITTEN
        ) from error


@contextmanager
def replacing(path: Path) -> Iterator[Path]:
    """Yield a temporary file that replaces an older one when it is complete and on disk.

    The temporary name is unpredictable. A symbolic link of the older one's name is replaced, not
    followed. Special files, such as pipes, are written directly.

    Raises
    ------
    EvolventError
        It cannot be written.
    """
    if path.exists() and not path.is_file() and not path.is_dir():
        with writing(path):
            yield path
        return
    temporary = path.with_name(f"{path.stem[:40]}.{secrets.token_hex(8)}.tmp{path.suffix[:40]}")
    new = os.O_WRONLY | os.O_CREAT | os.O_EXCL
    try:
        with writing(path):
            os.close(os.open(temporary, new, 0o666))
            yield temporary
            _sync(temporary)
            temporary.replace(path)
            _sync(path.parent)
    finally:
        with suppress(OSError):
            temporary.unlink()


def _sync(path: Path) -> None:
    """Flush a file, or the entries of a folder, to disk."""
    try:
        descriptor = os.open(path, os.O_RDONLY)
    except PermissionError:  # a folder with write permission only
        return
    try:
        os.fsync(descriptor)
    except OSError as error:
        if error.errno != errno.EINVAL:  # not all file systems support it
            raise
    finally:
        os.close(descriptor)


HALF_WRITTEN: list[io.FileIO] = []  # HDF5 files whose data could not all be written


class _Patient(io.FileIO):
    """File object for HDF5, which may crash or omit data after a failed write.

    The first error is stored, and success is reported to HDF5; only failed reads are raised.
    """

    error: OSError | None = None

    def write(self, data: Any) -> int:
        """Write all data, or store the error."""
        rest = memoryview(data).cast("B")
        size = len(rest)
        try:
            while rest and self.error is None:
                rest = rest[super().write(rest) or 0 :]
        except OSError as error:
            self.error = error
        return size

    def readinto(self, buffer: Any) -> int | None:
        """Read; store and raise an error, which HDF5 may not survive either."""
        try:
            return super().readinto(buffer)
        except OSError as error:
            self.error = self.error or error
            raise

    def truncate(self, size: int | None = None) -> int:
        """Set the length, or store the error."""
        try:
            return super().truncate(size)
        except OSError as error:
            self.error = self.error or error
            return self.tell() if size is None else size


@contextmanager
def replacing_hdf5(path: Path, finish: Callable[[Path], None] | None = None) -> Iterator[BinaryIO]:
    """Yield an empty file for h5py that replaces an older one when it is complete.

    Parameters
    ----------
    finish
        Called with the complete file before it gets its final name.

    Raises
    ------
    EvolventError
        It cannot be written.
    """
    with replacing(path) as temporary:
        file = _Patient(temporary, "w+")
        try:
            yield cast("BinaryIO", file)
            file.close()
            if finish is not None and file.error is None:
                finish(temporary)
        except Exception as error:  # any exception may follow a failed write
            if file.error is None:
                raise
            HALF_WRITTEN.append(file)  # it stays open: h5py may still write
            raise file.error from error
        if file.error is not None:
            raise file.error
