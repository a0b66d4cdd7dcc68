"""Version of this package, equal to that of the program it is installed with."""

from importlib.metadata import PackageNotFoundError, version

try:
    __version__ = version("evolvent")
except PackageNotFoundError:  # used from the source folder
    __version__ = "unknown"
