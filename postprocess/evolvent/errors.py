"""What cannot be done, and files that are written whole or not at all."""

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

OF_SYSTEM = re.compile(r"errno = \d+, error message = '([^']*)'")  # in what HDF5 says
OF_FILE = re.compile(r"filename = '([^']*)'")
FAILED_CASES, USAGE, BAD_INPUT, NOT_WRITTEN, INTERRUPTED = 1, 2, 3, 74, 75


class EvolventError(Exception):
    """What cannot be done; the message names the thing, the value, the place and the remedy.

    Parameters
    ----------
    message : one line.
    code : exit code of the program that meets it.
    """

    def __init__(self, message: str, code: int = BAD_INPUT) -> None:
        super().__init__(message)
        self.code = code


class HistoryError(EvolventError):
    """A file that cannot be used as a history; the message names it and says why."""


class AnalysisError(EvolventError):
    """What the library cannot do; as a text it is the line that the program would end with.

    Parameters
    ----------
    code : exit code of the program.
    place : "CASE.yaml:12:5", or what was set or asked for; "" if there is none.
    reason : what is wrong and what to do.
    """

    def __init__(self, code: int, place: str, reason: str) -> None:
        super().__init__(f"{place or 'evolvent'}: {reason}", code)
        self.place, self.reason = place, reason
        self.history: xr.Dataset | None = None  # of a run or analysis that began: what there is

    def __reduce__(self) -> tuple[Any, ...]:
        """As another process gets it: without its history."""
        return type(self), (self.code, self.place, self.reason)


class CaseWarning(UserWarning):
    """What the program accepts in a case but warns of, such as a number of an implausible size."""


class SweepError(EvolventError):
    """What evolvent-sweep cannot do."""

    def at(self, place: str) -> SweepError:
        """The same error with a place in front, unless it begins with that place."""
        message = str(self)
        return SweepError(
            message if message.startswith(place) else f"{place}: {message}", self.code
        )


# What h5py, h5netcdf and xarray raise over a file; the last where a dimension has lost its name.
UNREADABLE = (OSError, KeyError, ValueError, RuntimeError, AttributeError)


def reason_of(error: Exception) -> str:
    """What an error of the system or a library says, in one line."""
    if isinstance(error, AttributeError):
        return "a name in it cannot be read"
    text = str(getattr(error, "strerror", None) or error)
    by_hdf5 = OF_SYSTEM.search(text)
    return by_hdf5[1] if by_hdf5 else " ".join(text.split())


def is_of_system(error: Exception) -> bool:
    """Whether the system refused something; HDF5 tells it in errors of all kinds."""
    return isinstance(error, OSError) or OF_SYSTEM.search(str(error)) is not None


def tells_of_system(error: BaseException) -> bool:
    """Whether HDF5 tells what the system refused it."""
    return OF_SYSTEM.search(str(error)) is not None


def is_hdf5_broken(error: BaseException) -> bool:
    """Whether the system refused HDF5 something: it may crash over that as the program ends.

    So it does after a file that could not be closed, in C as in Python, up to HDF5 2.0 at least.
    """
    cause = error.__cause__ or error.__context__
    return tells_of_system(error) or (cause is not None and is_hdf5_broken(cause))


def file_of(error: Exception) -> str:
    """Which file it is about, with a colon behind; "" if it does not say."""
    by_hdf5 = OF_FILE.search(str(error))
    name = by_hdf5[1] if by_hdf5 else getattr(error, "filename", None)
    return f"{name}: " if name else ""


@contextmanager
def needing(extra: str, what: str, code: int = BAD_INPUT) -> Iterator[None]:
    """Say what needs a library that is not there, and how to get it.

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
    """Say which file or folder it is that cannot be written.

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
    """Give the name of a file that replaces an older one when it is whole, and on the disk.

    Nobody can know the name before, and a symbolic link of the older one's name is replaced, not
    followed. What is no regular file, such as a pipe, is written as it is.

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
    """Bring a file, or the names in a folder, to the disk."""
    try:
        descriptor = os.open(path, os.O_RDONLY)
    except PermissionError:  # a folder that may only be written
        return
    try:
        os.fsync(descriptor)
    except OSError as error:
        if error.errno != errno.EINVAL:  # not all file systems can do that
            raise
    finally:
        os.close(descriptor)


HALF_WRITTEN: list[io.FileIO] = []  # files of HDF5 that the disk did not take


class _Patient(io.FileIO):
    """A file for HDF5, which may crash, or leave data out, over what it could not write.

    It is told that all is well, and the first error is kept; but of what cannot be read back.
    """

    error: OSError | None = None

    def write(self, data: Any) -> int:
        """Write all of it, or keep the error."""
        rest = memoryview(data).cast("B")
        size = len(rest)
        try:
            while rest and self.error is None:
                rest = rest[super().write(rest) or 0 :]
        except OSError as error:
            self.error = error
        return size

    def readinto(self, buffer: Any) -> int | None:
        """Read, and keep the error, which HDF5 may not survive either."""
        try:
            return super().readinto(buffer)
        except OSError as error:
            self.error = self.error or error
            raise

    def truncate(self, size: int | None = None) -> int:
        """Set the length, or keep the error."""
        try:
            return super().truncate(size)
        except OSError as error:
            self.error = self.error or error
            return self.tell() if size is None else size


@contextmanager
def replacing_hdf5(path: Path, finish: Callable[[Path], None] | None = None) -> Iterator[BinaryIO]:
    """Give an empty file for h5py, in place of a name; it replaces an older one when it is whole.

    Parameters
    ----------
    finish
        What is done to it then, before it gets its name.

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
        except Exception as error:  # what follows a failure may be anything
            if file.error is None:
                raise
            HALF_WRITTEN.append(file)  # it stays open: h5py may still write
            raise file.error from error
        if file.error is not None:
            raise file.error
