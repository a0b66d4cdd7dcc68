"""The library as others link it: calls share nothing, and it needs and does nothing of its own."""

from __future__ import annotations

import ctypes
import re
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from kernel.gearbox import LOADED, Gearbox, State
from kernel.gearbox_cases import PAIRS, chain, in_mode
from kernel.gearbox_description import ALGEBRAIC, DIFFERENTIAL
from kernel.kernel import Kernel


def all_results(gearbox: Gearbox, state: State) -> list[np.ndarray]:
    after, _ = gearbox.apply(state, "force", "contact")
    return [
        gearbox.residual(state),
        gearbox.jacobian(state, 100.0),
        gearbox.derivative(state),
        gearbox.roots(state),
        gearbox.values(state),
        after.y,
        after.yp,
        after.integers,
        after.reals,
    ]


def test_calls_on_two_gearboxes_do_not_disturb_each_other(kernel: Kernel):
    """Interleaved in any order they give the bits that each gives alone."""
    random = np.random.default_rng(2)
    gearboxes = [
        chain(kernel, 3, DIFFERENTIAL),
        PAIRS["tilted"].gearbox(kernel, tracking=ALGEBRAIC),
    ]
    states = [[in_mode(g, random, (LOADED, 0)) for _ in range(3)] for g in gearboxes]
    alone = [[all_results(g, s) for s in some] for g, some in zip(gearboxes, states, strict=True)]
    for which in random.integers(0, 2, 60):
        i = random.integers(0, 3)
        again = all_results(gearboxes[which], states[which][i])
        for one, other in zip(again, alone[which][i], strict=True):
            np.testing.assert_array_equal(one, other)


def test_calls_do_not_touch_the_state_that_they_are_given(kernel: Kernel):
    gearbox = chain(kernel, 3, DIFFERENTIAL)
    state = in_mode(gearbox, np.random.default_rng(3), (LOADED, 1))
    before = state.copy()
    for array in (state.y, state.yp, state.integers, state.reals):
        array.flags.writeable = False
    all_results(gearbox, state)
    for name in ("y", "yp", "integers", "reals"):
        np.testing.assert_array_equal(getattr(state, name), getattr(before, name))


def test_two_gearboxes_of_one_description_give_the_same_bits(kernel: Kernel):
    one, two = (chain(kernel, 4, DIFFERENTIAL) for _ in range(2))
    state = in_mode(one, np.random.default_rng(4), (LOADED, -1))
    for a, b in zip(all_results(one, state), all_results(two, state), strict=True):
        np.testing.assert_array_equal(a, b)


def test_a_deleted_gearbox_may_be_deleted_again(kernel: Kernel):
    gearbox = chain(kernel, 2, DIFFERENTIAL)
    for _ in range(2):
        kernel.library.evl_gearbox_delete(ctypes.byref(gearbox.handle))
        assert gearbox.handle.value is None
    kernel.library.evl_gearbox_delete(None)


# ---- the library itself


@pytest.fixture(scope="module")
def symbols(kernel_library: Path) -> list[tuple[str, str]]:
    """(type, name) of every dynamic symbol, without versions."""
    command = ["nm", "-D", str(kernel_library)]
    text = subprocess.run(command, check=True, capture_output=True, text=True).stdout
    rows = [line.split()[-2:] for line in text.splitlines()]
    return [(kind, name.split("@")[0]) for kind, name in rows]


def test_the_kernel_knows_no_integrator_and_no_file_format(
    kernel_library: Path, symbols: list[tuple[str, str]]
):
    needed = subprocess.run(
        ["readelf", "-d", str(kernel_library)], check=True, capture_output=True, text=True
    ).stdout
    libraries = [line for line in needed.splitlines() if "(NEEDED)" in line]
    assert any("lapack" in line for line in libraries)
    for other in ("sundials", "hdf5", "yaml"):
        assert not [line for line in libraries if other in line]
    foreign = ("IDA", "SUN", "N_V", "H5", "yaml_", "CVode", "netcdf", "nc_")
    assert not [name for _, name in symbols if name.startswith(foreign)]


def test_no_procedure_keeps_anything_between_calls(kernel_library: Path):
    """What two threads would race for; gfortran also keeps the length of a deferred-length result.

    Variables of procedures have a number behind their name; tables of jumps are constant.
    """
    command = ["nm", "--defined-only", str(kernel_library)]
    text = subprocess.run(command, check=True, capture_output=True, text=True).stdout
    rows = [line.split()[-2:] for line in text.splitlines()]
    assert any(name.startswith("__evl_") for _, name in rows), "a stripped library shows nothing"
    kept = {name for kind, name in rows if kind in "bBdD" and re.match(r"\w+\.\d+", name)}
    assert {name for name in kept if not re.match(r"(jumptable|completed)\.", name)} == set()


def test_the_kernel_never_stops_the_program_nor_opens_a_file(symbols: list[tuple[str, str]]):
    undefined = {name for kind, name in symbols if kind == "U"}
    assert undefined, "nm finds no undefined symbol: the library is not what it should be"
    ending = ("_gfortran_stop", "_gfortran_error_stop", "_gfortran_st_open", "_gfortran_st_inquire")
    assert not [name for name in undefined if name.startswith(ending)]
    assert not undefined & {"exit", "abort", "_exit", "printf", "puts", "fopen", "open", "system"}


@pytest.mark.parametrize("name", ["pack", "spread", "cshift", "eoshift", "unpack"])
def test_gfortrans_library_makes_no_arrays(symbols: list[tuple[str, str]], name: str):
    """Where it finds no memory for one, it ends the program by itself, in lines of its own."""
    made = [found for _, found in symbols if re.match(rf"_gfortran_{name}(\d|_|$)", found)]
    assert not made


def test_the_kernel_writes_nothing(kernel_library: Path):
    """Not even where it is refused: a program that only calls it prints nothing."""
    program = f"""
import ctypes
library = ctypes.CDLL({str(kernel_library)!r})
library.evl_description_create.restype = library.evl_gearbox_create.restype = ctypes.c_void_p
status = ctypes.create_string_buffer(512)
no_such_row = (ctypes.c_int * 8)(-1)
for _ in range(3):
    assert library.evl_description_create(1, no_such_row, status) is None
    description = ctypes.c_void_p(library.evl_description_create(0, None, status))
    assert description
    assert library.evl_gearbox_create(description, None, status) is None
    library.evl_description_delete(ctypes.byref(description))
"""
    result = subprocess.run([sys.executable, "-c", program], capture_output=True, check=True)
    assert result.stdout == result.stderr == b""


@pytest.fixture(scope="module")
def declared(root: Path) -> set[str]:
    """Calls that the header declares."""
    header = (root / "src/include/evolvent/kernel.h").read_text()
    return set(re.findall(r"^EVL_API [^;(]*?(evl_\w+)\(", header, re.MULTILINE))


def test_the_library_exports_what_the_header_declares(
    symbols: list[tuple[str, str]], declared: set[str]
):
    """Fortran's own names carry their module's."""
    exported = {name for kind, name in symbols if kind == "T"} - {"_init", "_fini"}
    assert {name for name in exported if not name.startswith("__evl_")} == declared


FOR_OTHER_PROGRAMS = {
    "evl_description_set": "`evolvent` takes parameters from --set before there is a description;"
    " a program that varies them has no case file. tests/driver/test_parameters.c is one",
}


def test_the_header_declares_what_a_program_calls_and_nothing_for_tests(
    root: Path, declared: set[str]
):
    """A call that tests alone need is one of theirs, in the folder of its module."""
    sources = [path.read_text() for path in (root / "driver").glob("*/*.[ch]")]
    called = set(re.findall(r"\bevl_\w+", "\n".join(sources)))
    assert declared
    left = declared - called
    assert left == {*FOR_OTHER_PROGRAMS}, f"no program calls {sorted(left)}"
