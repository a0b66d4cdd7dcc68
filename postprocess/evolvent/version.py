"""The version of this package, which is that of the program it came with."""

from importlib.metadata import PackageNotFoundError, version

try:
    __version__ = version("evolvent")
except PackageNotFoundError:  # used from the source folder
    __version__ = "unknown"
