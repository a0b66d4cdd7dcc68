"""The programs of docs/guides/calling.md, built against an installation as others would."""

from __future__ import annotations

import os
import re
import subprocess
from pathlib import Path

import pytest

import machine
from documents import blocks

PROJECT = """
cmake_minimum_required(VERSION 3.22)
project(mine LANGUAGES C Fortran)
find_package(evolvent 0.1 REQUIRED)
add_executable(cases cases.c)
target_link_libraries(cases PRIVATE evolvent::evolvent)
add_executable(kernel_c kernel.c)
target_link_libraries(kernel_c PRIVATE evolvent::kernel)
add_executable(kernel_fortran kernel.f90)
target_link_libraries(kernel_fortran PRIVATE evolvent::kernel)
"""


def run(*words: object, **options: object) -> str:
    done = subprocess.run(
        [str(word) for word in words], capture_output=True, text=True, check=False, **options
    )
    assert done.returncode == 0, f"{words}: {done.stdout}{done.stderr}"
    return done.stdout


@pytest.fixture(scope="module")
def prefix(executable: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """An installation that was moved."""
    folder = tmp_path_factory.mktemp("installed")
    build = executable.resolve().parent
    run("cmake", "--install", build, "--prefix", folder / "first", "--component", "library")
    return (folder / "first").rename(folder / "moved")


@pytest.fixture(scope="module")
def sources(root: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The programs of the page."""
    folder = tmp_path_factory.mktemp("mine")
    page = root / "docs" / "guides" / "calling.md"
    cases, kernel = blocks(page, "c")
    (folder / "cases.c").write_text(cases)
    (folder / "kernel.c").write_text(kernel)
    (folder / "kernel.f90").write_text(*blocks(page, "fortran"))
    (folder / "CMakeLists.txt").write_text(PROJECT)
    return folder


def laws(executable: Path) -> list[str]:
    """Laws of contact, by the program."""
    reported = run(executable, "show", "--laws").split("damping:")[0]
    return re.findall(r"^  \{law: (\w+)\}", reported, re.MULTILINE)


def test_find_package_gives_both_libraries_to_c_and_fortran(
    prefix: Path, sources: Path, examples: Path, executable: Path, tmp_path: Path
) -> None:
    build = tmp_path / "build"
    run("cmake", "-S", sources, "-B", build, f"-DCMAKE_PREFIX_PATH={prefix}", "-G", "Ninja")
    run("cmake", "--build", build)
    reported = run(build / "cases", examples / "paper.yaml")
    assert re.fullmatch(r"101 outputs, last .+ [\d.]+ N\n", reported)
    by_c = [line.split(":")[0] for line in run(build / "kernel_c").splitlines()]
    by_fortran = [line.strip() for line in run(build / "kernel_fortran").splitlines()]
    assert by_c == by_fortran == laws(executable)


@pytest.mark.parametrize(
    ("module", "source"), [("evolvent", "cases.c"), ("evolvent-kernel", "kernel.c")]
)
def test_pkg_config_gives_each_library(
    prefix: Path, sources: Path, examples: Path, tmp_path: Path, module: str, source: str
) -> None:
    machine.program("pkg-config")
    [folder] = prefix.rglob("pkgconfig")
    environment = {**os.environ, "PKG_CONFIG_PATH": str(folder)}
    assert run("pkg-config", "--modversion", module, env=environment).startswith("0.")
    flags = run("pkg-config", "--cflags", "--libs", module, env=environment).split()
    compiler = os.environ.get("CC", "cc")
    rpath = f"-Wl,-rpath,{folder.parent}"
    program = tmp_path / "mine"
    run(compiler, "-std=c99", "-Wall", "-Werror", sources / source, *flags, rpath, "-o", program)
    assert run(program, examples / "paper.yaml") != ""


def test_the_headers_are_c_plus_plus_too(prefix: Path, tmp_path: Path) -> None:
    compiler = machine.program("c++")
    source = tmp_path / "x.cpp"
    source.write_text(
        "#include <evolvent/evolvent.h>\n#include <evolvent/kernel.h>\nint main() {}\n"
    )
    run(
        compiler,
        "-Wall",
        "-Wextra",
        "-Werror",
        "-pedantic",
        "-fsyntax-only",
        f"-I{prefix / 'include'}",
        source,
    )
