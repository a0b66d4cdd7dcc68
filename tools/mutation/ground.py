"""Build folders of mutants: a copy of the tree with its own build, under build/mutate."""

from __future__ import annotations

import os
import re
import subprocess
import sys
from pathlib import Path

from mutation.entries import ROOT, Mutant

OPTIONS = {
    "CMAKE_BUILD_TYPE": "Release",
    "EVOLVENT_TESTS": "ON",
    "EVOLVENT_LTO": "OFF",
    "EVOLVENT_VARIANTS": "OFF",
}
# Targets for tests in Python: the program, the libraries, the layers below a program.
FOR_PYTHON = (
    "evolvent",
    "evolvent_library",
    "evolvent_kernel_shared",
    "kernel_test",
    "lanes_of_case",
    "faults",
    "power_loss",
)
INCLUDE = re.compile(r'^\s*include "(.+)"', re.MULTILINE)

SCAN = re.compile(r"^(rule Fortran_SCAN\w*\n)  depfile = .*\n", re.MULTILINE)


class Ground:
    """One copy of the tree, and its build."""

    def __init__(self, folder: Path, jobs: int) -> None:
        self.folder = folder
        self.tree = folder / "tree"
        self.build = folder / "build"
        self.log = folder / "build.log"
        self.jobs = jobs
        self._sources: dict[str, str] = {}
        self._mutated: str | None = None
        self._is_dirty = True  # a compiled file has changed since the last build
        self._made: set[str] = set()  # targets built from the present tree

    def prepare(self) -> None:
        """Copy the present tree, and configure its build."""
        names = subprocess.run(
            ["git", "ls-files", "-z", "--cached", "--others", "--exclude-standard"],
            cwd=ROOT, check=True, capture_output=True, text=True,
        ).stdout.split("\0")  # fmt: skip
        selected = {name for name in names if name and (ROOT / name).is_file()}
        for name in selected:
            self._write(name, self._as_copied(name, (ROOT / name).read_bytes()))
            (self.tree / name).chmod((ROOT / name).stat().st_mode)
        for path in [path for path in self.tree.rglob("*") if path.is_file()]:
            if str(path.relative_to(self.tree)) not in selected:
                path.unlink()
        # Checked against its source on import: a mutant's module is compiled anew, in memory.
        compiler = [sys.executable, "-m", "compileall", "-q", "--invalidation-mode", "checked-hash"]
        folders = [str(self.tree / "postprocess"), str(self.tree / "tests")]
        subprocess.run([*compiler, *folders], check=True)
        if not (self.build / "build.ninja").is_file():
            options = [f"-D{key}={value}" for key, value in OPTIONS.items()]
            command = [
                "cmake",
                "-S",
                str(self.tree),
                "-B",
                str(self.build),
                "-G",
                "Ninja",
                *options,
            ]
            subprocess.run(command, check=True, stdout=subprocess.DEVNULL)

    def put(self, mutant: Mutant | None) -> None:
        """Apply one mutant to the tree, or restore the tree."""
        if self._mutated is not None and (mutant is None or mutant.path != self._mutated):
            self._change(self._mutated, self._sources[self._mutated])
            self._mutated = None
        if mutant is not None:
            source = self._sources.setdefault(mutant.path, (self.tree / mutant.path).read_text())
            self._mutated = mutant.path
            self._change(mutant.path, mutant.applied(source))

    def make(self, tests: tuple[str, ...]) -> bool:
        """Build C tests, or everything that tests in Python load or run."""
        named = {Path(test).stem for test in tests if test.endswith(".c")}
        if any(not test.endswith(".c") for test in tests):
            named |= set(FOR_PYTHON)
        if not self._is_dirty and named <= self._made:
            return True
        self._quicken()
        command = ["ninja", "-C", str(self.build), f"-j{self.jobs}", *sorted(named)]
        with self.log.open("w") as log:
            done = subprocess.run(command, stdout=log, stderr=log, check=False).returncode == 0
        self._made = named | (set() if self._is_dirty else self._made)
        self._is_dirty = not done
        return done

    def environment(self) -> dict[str, str]:
        """Environment of the tests: this build, Python of this tree, no stale bytecode."""
        python = [self.tree / "postprocess", ROOT / "tools", ROOT / "tools" / "mutation" / "site"]
        return {
            **os.environ,
            "EVOLVENT_EXECUTABLE": str(self.build / "evolvent"),
            "EVOLVENT_LIBRARY": str(self.build / "libevolvent.so.0"),
            "EVOLVENT_KERNEL_LIBRARY": str(self.build / "libevolvent_kernel.so"),
            "EVOLVENT_TEST_LIBRARY": str(self.build / "tests" / "libkernel_test.so"),
            "PATH": f"{Path(sys.executable).parent}:{os.environ['PATH']}",
            "PYTHONPATH": ":".join(map(str, python)),
            "PYTHONDONTWRITEBYTECODE": "1",
        }

    def _quicken(self) -> None:
        """Scan only changed files: the depfile of a scan by CMake 3.25 names another file."""
        rules = self.build / "CMakeFiles" / "rules.ninja"
        text = rules.read_text()
        if SCAN.search(text):
            rules.write_text(SCAN.sub(r"\1", text))

    def _as_copied(self, name: str, content: bytes) -> bytes:
        """Drop needless dependencies: interfaces do not change, `_change` handles includes."""
        if Path(name).name != "CMakeLists.txt":
            return content
        lines = content.decode().splitlines(keepends=True)
        return "".join(line for line in lines if "OBJECT_DEPENDS" not in line).encode()

    def _write(self, name: str, content: bytes) -> None:
        path = self.tree / name
        if path.is_file() and path.read_bytes() == content:
            return
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_bytes(content)

    def _change(self, name: str, text: str) -> None:
        self._write(name, text.encode())
        self._is_dirty = self._is_dirty or not name.endswith(".py")
        if name.endswith(".inc") and name.startswith("src/"):
            for file in self._includers(name.removeprefix("src/")):
                (self.tree / file).touch()

    def _includers(self, included: str) -> set[str]:
        """Fortran files that include a file, also indirectly: CMake does not track includes."""
        found: set[str] = set()
        names = {included}
        files = [*self.tree.glob("src/**/*"), *self.tree.glob("tests/*/*.f90")]
        texts = {str(f.relative_to(self.tree)): f.read_text() for f in files if f.is_file()}
        size = -1
        while size != len(names | found):
            size = len(names | found)
            for name, text in texts.items():
                if names & set(INCLUDE.findall(text)):
                    found.add(name)
                    names.add(name.removeprefix("src/"))
        return {name for name in found if name.endswith(".f90")}
