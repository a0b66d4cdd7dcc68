"""Fixtures of all tests: the program, the libraries, the examples."""

from __future__ import annotations

import os
import signal
import subprocess
from collections.abc import Callable, Sequence
from pathlib import Path

import pytest

import machine
from kernel.kernel import Kernel

pytest_plugins = ("leftovers", "helper_programs")

ROOT = Path(__file__).resolve().parents[1]
os.environ["EVOLVENT_CACHE"] = "off"  # the compliance of wheels is computed in every test
BUILDS = ("ci", "release", "debug")  # in order of preference, without an environment variable
# Folders and files of tests of whole runs and of other programs: --quick leaves them out.
SYSTEM = (
    *("io_faults", "fmu", "fuzz", "pages", "slurm", "system"),
    "commands/test_batch_checkpoint.py",
    "commands/test_batch_kill.py",
    "commands/test_batch_orphans.py",
    "commands/test_checkpoint.py",
    "commands/test_compliant_run.py",
    "commands/test_kernel_variants.py",
    "commands/test_memory.py",
    "commands/test_undercut.py",
    "docs/test_docs.py",
    "docs/test_site.py",
    "docs/test_tutorial.py",
    "library/test_examples.py",
    "library/test_installed.py",
    "library/test_same_bits.py",
    "continuation/test_backlash_branch.py",
    "continuation/test_branches.py",
    "continuation/test_corner_touch.py",
    "continuation/test_doubling_cascade.py",
    "sweep/test_end_to_end.py",
    "tools/test_carry_libraries.py",
)

MOST_SETS = 6  # of parameters that --quick runs of a test

# A shell that starts the tests in the background makes them ignore SIGINT, and all child processes
# inherit that: programs interrupted by tests would never end. With a handler here, child processes
# have the default action.
signal.signal(signal.SIGINT, signal.default_int_handler)


def _built(variable: str, name: str) -> Path:
    """Path of a built file: from the environment variable, else the first in build/."""
    named = os.environ.get(variable)
    candidates = [Path(named)] if named else [ROOT / "build" / build / name for build in BUILDS]
    for candidate in candidates:
        if candidate.is_file():
            return candidate
    looked = ", ".join(str(candidate) for candidate in candidates)
    pytest.fail(
        f"{name} is not built (looked for {looked}); run ./runtests, or set {variable}",
        pytrace=False,
    )


def pytest_addoption(parser: pytest.Parser) -> None:
    """Add the options of the tiers."""
    tiers = parser.getgroup("tiers")
    tiers.addoption("--quick", action="store_true", help="run only unit and contract tests")
    tiers.addoption("--long", action="store_true", help="run the tests marked `long`, too")


def pytest_configure(config: pytest.Config) -> None:
    """Declare the marker of the tests that only --long runs, and check the list of --quick."""
    config.addinivalue_line("markers", "long: part of a set that takes many minutes, see --long")
    moved = [name for name in SYSTEM if not (ROOT / "tests" / name).exists()]
    if moved:
        raise pytest.UsageError(f"SYSTEM in tests/conftest.py names what is not there: {moved}")


def _is_system(item: pytest.Item) -> bool:
    path = item.path.relative_to(ROOT / "tests")
    return any(path.is_relative_to(name) for name in SYSTEM)


def _thinned(items: list[pytest.Item]) -> list[pytest.Item]:
    """At most MOST_SETS parameter sets of a test, evenly spaced."""
    of_test: dict[str, list[pytest.Item]] = {}
    for item in items:
        of_test.setdefault(item.nodeid.partition("[")[0], []).append(item)
    chosen = {item for sets in of_test.values() for item in sets[:: -(-len(sets) // MOST_SETS)]}
    return [item for item in items if item in chosen]


def pytest_collection_modifyitems(config: pytest.Config, items: list[pytest.Item]) -> None:
    """Deselect the tests of tiers that are not requested."""
    quick, long = config.getoption("--quick"), config.getoption("--long")
    selected = [
        item
        for item in items
        if (long or not item.get_closest_marker("long")) and not (quick and _is_system(item))
    ]
    selected = _thinned(selected) if quick else selected
    if len(selected) < len(items):
        config.hook.pytest_deselected(items=list(set(items).difference(selected)))
        items[:] = selected


@pytest.fixture(scope="session")
def kernel(kernel_test_library: Path) -> Kernel:
    """Binding of the kernel, with the procedures for tests."""
    return Kernel(kernel_test_library)


@pytest.fixture(scope="session")
def kernel_test_library() -> Path:
    """Test library: the kernel with entry points of procedures that it does not export."""
    return _built("EVOLVENT_TEST_LIBRARY", "tests/libkernel_test.so")


@pytest.fixture(scope="session")
def root() -> Path:
    """Root of the repository."""
    return ROOT


@pytest.fixture(scope="session")
def examples() -> Path:
    """Folder of the example cases."""
    return ROOT / "examples"


@pytest.fixture(scope="session")
def executable() -> Path:
    """Path of the program `evolvent`."""
    return _built("EVOLVENT_EXECUTABLE", "evolvent")


@pytest.fixture(scope="session")
def kernel_library() -> Path:
    """Path of the kernel's shared library for linking."""
    return _built("EVOLVENT_KERNEL_LIBRARY", "libevolvent_kernel.so")


def _layer(kernel_test_library: Path, name: str) -> Path:
    path = kernel_test_library.resolve().parent / name
    if not path.is_file():
        machine.unavailable(
            f"this build has no {name}: only Linux has it, and no build with sanitizers"
        )
    return path


@pytest.fixture(scope="session")
def faults_layer(kernel_test_library: Path) -> Path:
    """Preload library that makes the k-th call of a program fail."""
    return _layer(kernel_test_library, "libfaults.so")


@pytest.fixture(scope="session")
def power_layer(kernel_test_library: Path) -> Path:
    """Preload library that preserves only data that a program has synced."""
    return _layer(kernel_test_library, "libpower_loss.so")


@pytest.fixture
def evolvent(executable: Path, tmp_path: Path) -> Callable[..., subprocess.CompletedProcess[str]]:
    """Run the program in an empty folder: ``evolvent("run", case, "-o", "x.h5")``.

    The exit code is not checked. Keyword arguments go to `subprocess.run`: ``cwd``, ``env``,
    ``input``, ``timeout`` (120 s unless given).
    """

    def run(*arguments: str | Path, **options: object) -> subprocess.CompletedProcess[str]:
        command: Sequence[str] = [str(executable), *map(str, arguments)]
        settings = {"cwd": tmp_path, "timeout": 120, "capture_output": True, "text": True}
        return subprocess.run(command, **{**settings, **options}, check=False)

    return run
