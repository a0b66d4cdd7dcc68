"""A wheel carries what its programs and modules need, or is refused; on a small wheel."""

from __future__ import annotations

import ctypes
import os
import platform
import re
import subprocess
import sys
from pathlib import Path

import pytest

import machine

SCRIPT = Path(__file__).resolve().parents[2] / "tools" / "carry_libraries.py"
# Quadruple precision has a library that no bare system has; the program gets it through a library
# of its own, which has a variant where the loader looks first.
OWN = "#include <quadmath.h>\nint half(void) { return (int)(2*(double)sqrtq(%s.0/16)); }"
PROGRAM = '#include <stdio.h>\nint half(void); int main(void) { printf("%d\\n", half()); }'
SEARCH = "-Wl,-rpath,$ORIGIN/../libexec/evolvent:/nowhere"


@pytest.fixture(autouse=True)
def on_debian() -> None:
    """Wheels are built on x86-64 Debian."""
    machine.program("dpkg")
    if platform.machine() != "x86_64":
        machine.unavailable("wheels are built on x86-64")


def compiled(target: Path, source: str, *options: str | Path) -> Path:
    target.parent.mkdir(parents=True, exist_ok=True)
    command = ["gcc", "-x", "c", "-", "-o", target, "-x", "none", *options]
    subprocess.run(command, input=source, text=True, check=True, timeout=60)
    return target


def packed(folder: Path, *options: str) -> Path:
    """A wheel with a program, its library, linked so, and a library among its modules."""
    tree = folder / "small-1.0"
    data = tree / "small-1.0.data"
    own = data / "data/libexec/evolvent/libown.so.0"
    shared = ["-shared", "-fPIC", "-Wl,-soname,libown.so.0"]
    compiled(own, OWN % "1", *shared, "-lquadmath", *options)
    compiled(own.parent / "glibc-hwcaps/x86-64-v2/libown.so.0", OWN % "1", *shared, "-lquadmath")
    compiled(data / "scripts/program", PROGRAM, own, SEARCH)
    compiled(tree / "small/libmodule.so", OWN % "4", *shared, "-lquadmath")
    info = tree / "small-1.0.dist-info"
    (info / "licenses").mkdir(parents=True)
    (info / "METADATA").write_text("Metadata-Version: 2.1\nName: small\nVersion: 1.0\n")
    (info / "WHEEL").write_text(
        "Wheel-Version: 1.0\nGenerator: test\nRoot-Is-Purelib: false\nTag: py3-none-linux_x86_64\n"
    )
    (info / "RECORD").touch()
    done([sys.executable, "-m", "wheel", "pack", tree, "--dest-dir", folder])
    (wheel,) = folder.glob("*.whl")
    return wheel


def done(command: list[str | Path], code: int = 0) -> str:
    path = f"{Path(sys.executable).parent}:{os.environ['PATH']}"
    ended = subprocess.run(
        command,
        env=os.environ | {"PATH": path},
        capture_output=True,
        text=True,
        timeout=60,
        check=False,
    )
    assert ended.returncode == code, ended.stderr
    return ended.stdout if code == 0 else ended.stderr


@pytest.fixture(scope="module")
def installed(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The small wheel after the work, installed."""
    folder = tmp_path_factory.mktemp("wheel")
    said = done([sys.executable, SCRIPT, packed(folder), folder / "out"])
    target = folder / "target"
    done(
        [
            sys.executable,
            "-m",
            "pip",
            "install",
            "--no-index",
            "--no-deps",
            "--quiet",
            "--target",
            target,
            said.strip(),
        ]
    )
    return target


def loaded(binary: Path) -> dict[str, str]:
    """Library -> file that the loader takes for a binary."""
    said = done(["ldd", binary])
    return {Path(name).name: path for name, path in re.findall(r"(\S+) => (\S+)", said)}


def test_the_installed_program_runs_and_loads_the_carried_library(installed: Path) -> None:
    program = installed / "bin/program"
    assert done([program]) == "0\n"
    paths = loaded(program)
    carried = [name for name in paths if "quadmath" in name]
    assert len(carried) == 1
    assert re.fullmatch(r"libquadmath-[0-9a-f]{8}\.so\.0", carried[0])
    assert Path(paths[carried[0]]).resolve() == installed / "libexec/evolvent" / carried[0]


def test_the_loader_still_takes_the_variant_for_the_processor(installed: Path) -> None:
    assert "/glibc-hwcaps/x86-64-v2/" in loaded(installed / "bin/program")["libown.so.0"]


def test_a_library_among_the_modules_has_its_own_copy(installed: Path) -> None:
    module = installed / "small/libmodule.so"
    assert ctypes.CDLL(str(module)).half() == 1
    (path,) = [path for name, path in loaded(module).items() if "quadmath" in name]
    assert Path(path).resolve().parent == installed / "evolvent.libs"


def test_no_binary_looks_in_folders_of_the_machine_that_built_it(installed: Path) -> None:
    program = installed / "bin/program"
    entries = done(["patchelf", "--print-rpath", program]).strip().split(":")
    assert entries == ["$ORIGIN/../libexec/evolvent"]


def test_licences_and_versions_of_what_is_carried_are_in_the_wheel(installed: Path) -> None:
    (folder,) = installed.glob("*.dist-info/licenses/carried")
    (row,) = (folder / "packages.txt").read_text().splitlines()
    assert re.fullmatch(r"libquadmath0:amd64 \S+: libquadmath\.so\.0[.0]*", row)
    assert "GNU compiler" in (folder / "libquadmath0.txt").read_text()


def test_the_tag_asks_for_no_newer_c_library_than_this_one(installed: Path) -> None:
    (info,) = installed.glob("*.dist-info/WHEEL")
    tags = re.findall(r"^Tag: py3-none-manylinux_2_(\d+)_x86_64$", info.read_text(), re.MULTILINE)
    assert len(tags) == 1
    assert int(tags[0]) <= int(platform.libc_ver()[1].split(".")[1])


def test_a_library_that_no_wheel_should_carry_is_refused_by_name(tmp_path: Path) -> None:
    """As HDF5 would be with its client of the network."""
    wheel = packed(tmp_path, "-Wl,--no-as-needed", "-lz")
    said = done([sys.executable, SCRIPT, wheel, tmp_path / "out"], code=1)
    assert said.startswith("carry_libraries: the wheel would have to carry libz.so.1; ")
    assert not (tmp_path / "out").exists()
