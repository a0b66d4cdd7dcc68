"""Programs that the tests require: machine.txt lists them, ./runtests installs them.

If ./runtests could install packages it sets EVOLVENT_TESTS_COMPLETE=1, and a missing program or
Python package fails its test. Otherwise the test is skipped with the name of the package.
"""

from __future__ import annotations

import importlib
import os
import shutil
import subprocess
import sys
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from types import ModuleType
from typing import NoReturn

import pytest

LIST = Path(__file__).with_name("machine.txt")
COMPLETE = "EVOLVENT_TESTS_COMPLETE"
SYSTEM_FOLDERS = ("/usr/sbin", "/usr/local/sbin", "/sbin")  # not in the PATH of ordinary users


@dataclass(frozen=True)
class Need:
    """A row of the list: alternative programs, the Debian packages with them, the purpose."""

    programs: tuple[str, ...]
    packages: tuple[str, ...]
    purpose: str

    def path(self) -> str | None:
        """Path of the first program that is installed."""
        path = os.pathsep.join([os.environ.get("PATH", ""), *SYSTEM_FOLDERS])
        return next(filter(None, (shutil.which(name, path=path) for name in self.programs)), None)


def needs(text: str) -> tuple[Need, ...]:
    """Parse the rows of a list. Raises ValueError for a malformed row."""
    rows = []
    for line in text.splitlines():
        if not line.strip() or line.startswith("#"):
            continue
        names, packages, purpose = (column.strip() for column in line.split(";"))
        rows.append(Need(tuple(names.split("|")), tuple(packages.split()), purpose))
    return tuple(rows)


NEEDS = needs(LIST.read_text(encoding="utf-8"))
LISTED = {name: need for need in NEEDS for name in need.programs}


def program(name: str) -> str:
    """Path of a program of the list; the test is skipped, or fails, if it is missing.

    Raises KeyError if the list has no such program.
    """
    need = LISTED[name]
    path = need.path()
    if path is None:
        missing(f"no {' or '.join(need.programs)} here", f"apt install {' '.join(need.packages)}")
    return path


def module(name: str) -> ModuleType:
    """Import a Python package of requirements/development.lock."""
    try:
        return importlib.import_module(name)
    except ModuleNotFoundError:
        missing(f"no Python package {name} here", "pip install -r requirements/development.lock")


def missing(what: str, remedy: str) -> NoReturn:
    """Skip a test that needs a missing package; fail it if all packages should be installed."""
    if os.environ.get(COMPLETE) == "1":
        pytest.fail(f"{what}, though ./runtests installs it: {remedy}", pytrace=False)
    pytest.skip(f"{what}: {remedy}")


def unavailable(reason: str) -> NoReturn:
    """Skip a test for a reason that no package removes: the kernel, the processor, the build."""
    pytest.skip(reason)


def with_mounts(words: Sequence[str | Path], folder: Path) -> subprocess.CompletedProcess[str]:
    """Run a shell script with its arguments in a private mount namespace.

    The script ends with 99 if a mount fails; the test is then skipped, as in most containers.
    """
    program("mount")
    as_root = [] if os.geteuid() == 0 else ["--map-root-user"]
    done = subprocess.run(
        [program("unshare"), "--mount", *as_root, "bash", "-c", *words],
        cwd=folder,
        capture_output=True,
        text=True,
        timeout=60,
        check=False,
    )
    if done.returncode == 99 or (done.returncode == 1 and done.stderr.startswith("unshare:")):
        unavailable(f"this system mounts nothing for a test: {done.stderr.splitlines()[0]}")
    return done


on_linux = pytest.mark.skipif(sys.platform != "linux", reason="only Linux has this system call")
