"""Put the libraries that a wheel's binaries need into the wheel, and give it its manylinux tag.

    carry_libraries.py WHEEL FOLDER [--archive FILE ...]

auditwheel only determines the tag. Its repair puts libraries where only modules find them, and a
Python script before each program. So this script copies them, for the paths of an installation by
pip. Each library gets a name with its hash: in one process it is not confused with another library
of its name. Licences of carried libraries and of linked archives are added beside evolvent's own.
"""

from __future__ import annotations

import argparse
import hashlib
import json
import os
import re
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Iterator
from pathlib import Path, PurePosixPath

# The C library, and libgcc_s, which must exist only once in a process: every system has them.
SYSTEM = re.compile(r"(linux-vdso|ld-linux-x86-64|lib(c|m|mvec|dl|rt|pthread|gcc_s))\.so(\.\d+)?$")
# Libraries that may be carried. Any other, such as an HDF5 with a network client, is an error.
CARRIED = re.compile(r"lib(gfortran|quadmath|lapack|blas)\.so\.\d+$")
# Where pip installs a wheel's data, below the prefix; everything else goes to the modules' folder.
SCHEMES = {"scripts": PurePosixPath("bin"), "data": PurePosixPath()}
PREFIX_LIBRARIES = PurePosixPath("libexec/evolvent")


def run(*command: str | Path, **environment: str) -> str:
    """Run a command and return its output; a failure ends the program with the command's output."""
    done = subprocess.run(
        command, env=os.environ | environment, capture_output=True, text=True, check=False
    )
    if done.returncode:
        sys.exit(f"carry_libraries: {' '.join(map(str, command))}: {done.stderr or done.stdout}")
    return done.stdout


def binaries(folder: Path) -> list[Path]:
    """List the programs and shared libraries in a folder."""

    def is_binary(path: Path) -> bool:
        if path.is_symlink() or not path.is_file():
            return False
        with path.open("rb") as file:
            return file.read(4) == b"\x7fELF"

    return sorted(path for path in folder.rglob("*") if is_binary(path))


def installed_trees(tree: Path) -> Iterator[tuple[dict[Path, PurePosixPath], Path, PurePosixPath]]:
    """Binaries of an unpacked wheel that are installed together.

    As file -> installed path; with the folder of their carried libraries, and its installed path.
    """
    (data,) = [*tree.glob("*.data")] or [tree / "none.data"]
    prefix: dict[Path, PurePosixPath] = {}
    modules: dict[Path, PurePosixPath] = {}
    for path in binaries(tree):
        target_path = PurePosixPath(path.relative_to(data if data in path.parents else tree))
        scheme = target_path.parts[0] if data in path.parents else ""
        if scheme in SCHEMES:
            prefix[path] = SCHEMES[scheme] / target_path.relative_to(scheme)
        else:
            modules[path] = target_path.relative_to(scheme) if scheme else target_path
    if prefix:
        yield prefix, data / "data" / PREFIX_LIBRARIES, PREFIX_LIBRARIES
    if modules:
        yield modules, tree / "evolvent.libs", PurePosixPath("evolvent.libs")


def needed_from_outside(files: list[Path]) -> dict[str, Path]:
    """Find the libraries that a wheel of these files has to carry: name -> file on this machine."""
    own = {path.name for path in files}
    folders = ":".join(sorted({str(path.parent) for path in files}))
    outside: dict[str, Path] = {}
    for file in files:
        said = run("ldd", file, LD_LIBRARY_PATH=folders)
        for line in said.splitlines():
            name, _, target_path = (part.strip() for part in line.partition("=>"))
            name = name.split(" (")[0]
            if SYSTEM.search(Path(name).name) or name in own or name == "statically linked":
                continue
            if target_path == "not found":
                sys.exit(f"carry_libraries: {file.name} needs {name}, which is not found")
            outside[name] = Path(target_path.split(" (")[0]).resolve()
    if wrong := sorted(name for name in outside if not CARRIED.match(name)):
        sys.exit(
            f"carry_libraries: the wheel would have to carry {', '.join(wrong)}; link the static "
            "libraries of SUNDIALS, HDF5 and libyaml (EVOLVENT_STATIC), or widen CARRIED"
        )
    return outside


def carry(
    installed: dict[Path, PurePosixPath], folder: Path, target_path: PurePosixPath
) -> list[Path]:
    """Copy required libraries into a folder, set search paths to it, return the copied sources."""
    outside = needed_from_outside([*installed])
    folder.mkdir(parents=True, exist_ok=True)
    names = {}
    for name, source in outside.items():
        stem, dot, rest = name.partition(".so")
        names[name] = f"{stem}-{hashlib.sha256(source.read_bytes()).hexdigest()[:8]}{dot}{rest}"
        shutil.copy2(source, folder / names[name])
        (folder / names[name]).chmod(0o755)
        installed[folder / names[name]] = target_path / names[name]
        run("patchelf", "--set-soname", names[name], folder / names[name])
    for file, where in installed.items():
        here = os.path.relpath(target_path, where.parent)
        entries = run("patchelf", "--print-rpath", file).strip().split(":")
        retained = [entry for entry in entries if entry.startswith("$ORIGIN")]  # not this machine's
        search = ["$ORIGIN" if here == "." else f"$ORIGIN/{here}", *retained]
        change = [
            option
            for name in run("patchelf", "--print-needed", file).split()
            if name in names
            for option in ("--replace-needed", name, names[name])
        ]
        run("patchelf", *change, "--set-rpath", ":".join(dict.fromkeys(search)), file)
    return [*outside.values()]


def add_licences(tree: Path, sources: list[Path]) -> None:
    """Add copyright files of the Debian packages of carried files, with a list of versions."""
    (info,) = tree.glob("*.dist-info")
    folder = info / "licenses" / "carried"
    folder.mkdir(parents=True)
    packages: dict[str, set[str]] = {}
    for source in sorted({path.resolve() for path in sources}):
        package = run("dpkg", "-S", source).split(": ")[0]
        packages.setdefault(package, set()).add(source.name)
    rows = []
    for package, files in sorted(packages.items()):
        version = run("dpkg-query", "-W", "-f", "${Version}", package)
        rows.append(f"{package} {version}: {', '.join(sorted(files))}\n")
        name = package.partition(":")[0]
        shutil.copyfile(f"/usr/share/doc/{name}/copyright", folder / f"{name}.txt")
    (folder / "packages.txt").write_text("".join(rows))


def manylinux_tag(tree: Path, trees: list[dict[Path, PurePosixPath]]) -> str:
    """Determine auditwheel's tag for the binaries, laid out as in an installation."""
    with tempfile.TemporaryDirectory() as scratch:
        laid = Path(scratch, tree.name)
        (info,) = tree.glob("*.dist-info")
        shutil.copytree(info, laid / info.name)
        for number, installed in enumerate(trees):
            for file, where in installed.items():
                target = laid / f"tree{number}" / where
                target.parent.mkdir(parents=True, exist_ok=True)
                shutil.copy2(file, target)
        run(sys.executable, "-m", "wheel", "pack", laid, "--dest-dir", scratch)
        (wheel,) = Path(scratch).glob("*.whl")
        # Kernels for newer processors are selected by the loader, not by the tag.
        said = json.loads(run("auditwheel", "show", "--json", "--disable-isa-ext-check", wheel))
    tag = said.get("overall_tag") or said.get("overall_policy") or ""
    if not isinstance(tag, str) or not tag.startswith("manylinux_"):
        sys.exit(f"carry_libraries: auditwheel finds no manylinux tag: {json.dumps(said)}")
    return tag


def main() -> None:
    """Run the command line."""
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("wheel", type=Path)
    parser.add_argument("folder", type=Path)
    parser.add_argument("--archive", type=Path, action="append", default=[])
    options = parser.parse_args()
    with tempfile.TemporaryDirectory() as scratch:
        run(sys.executable, "-m", "wheel", "unpack", options.wheel, "--dest", scratch)
        (tree,) = Path(scratch).iterdir()
        trees, sources = [], [*options.archive]
        for installed, folder, target_path in installed_trees(tree):
            sources += carry(installed, folder, target_path)
            trees.append(installed)
        add_licences(tree, sources)
        tag = manylinux_tag(tree, trees)
        packed = Path(scratch, "packed")
        packed.mkdir()
        run(sys.executable, "-m", "wheel", "pack", tree, "--dest-dir", packed)
        (wheel,) = packed.iterdir()
        run(sys.executable, "-m", "wheel", "tags", "--platform-tag", tag, "--remove", wheel)
        (wheel,) = packed.iterdir()
        options.folder.mkdir(parents=True, exist_ok=True)
        print(shutil.move(wheel, options.folder / wheel.name))


if __name__ == "__main__":
    main()
