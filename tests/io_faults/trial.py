"""A command whose k-th system call fails: what is tried, and what must be true of it."""

from __future__ import annotations

import errno
import os
import re
import shutil
import struct
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path

from io_faults.warm import Starter, by_system

KINDS = (
    *("write", "fsync", "rename", "open", "close", "truncate"),
    *("mmap", "malloc", "read", "link", "fork", "lock"),
)  # in the order of faults.c
STATE_BYTES, MOST_PROCESSES = 65536, 64
HALF_THEN_FULL, HALF = 0, -1  # instead of an error: half is written, then the disk is full or not
HARMLESS = (errno.EINTR, HALF)  # the rest is written with the next call
EFFECTS: dict[str, tuple[tuple[int, bool], ...]] = {  # errors of each kind, and whether they last
    "write": (
        *((errno.ENOSPC, True), (errno.EIO, False), (errno.EINTR, False)),
        *((HALF_THEN_FULL, False), (HALF, False)),
    ),
    "fsync": ((errno.EIO, False), (errno.ENOSPC, True)),
    "rename": ((errno.EIO, False), (errno.ENOSPC, True)),
    "open": ((errno.EIO, False), (errno.EMFILE, True), (errno.EINTR, False)),
    "close": ((errno.EIO, False), (errno.EINTR, False)),
    "truncate": ((errno.EIO, False), (errno.EINTR, False)),
    "mmap": ((errno.ENOMEM, False),),
    "malloc": ((errno.ENOMEM, False),),
    "read": ((errno.EIO, False), (errno.EINTR, False)),
    "link": ((errno.ENOSPC, False), (errno.EPERM, False)),
    "fork": ((errno.EAGAIN, False),),
    "lock": ((errno.EAGAIN, False), (errno.EACCES, False), (errno.ENOLCK, False)),
}
DONE, BAD_INPUT, NO_MEMORY, NOT_WRITTEN, NOT_STARTED = 0, 3, 71, 74, 75
PROMISED: dict[str, set[int]] = {kind: {DONE, NOT_WRITTEN} for kind in KINDS} | {
    "open": {DONE, NOT_WRITTEN, BAD_INPUT},
    "read": {DONE, NOT_WRITTEN, BAD_INPUT},
    "close": {DONE, NOT_WRITTEN, BAD_INPUT},
    "mmap": {DONE, NOT_STARTED, NO_MEMORY},
    "malloc": {DONE, NO_MEMORY, NOT_WRITTEN, BAD_INPUT},  # the last two: that of a file's stream
    "fork": {DONE, NOT_STARTED},
    "lock": {DONE, BAD_INPUT, NOT_WRITTEN},
}
# Of a wheel's file, by a writer that died: the next batch drops it when it is ten minutes old.
LEFT_BY_A_WRITER = re.compile(r"compliance-[0-9a-f]{16}\.h5\.\w{6}$")
LOCKED = ["another run", "is being written", "permission denied"]
NAMELESS = ("mmap", "malloc", "fork")  # these happen to no file


@dataclass(frozen=True)
class Fault:
    """A call that fails."""

    kind: str
    process: int  # 0 is the first, children count on
    at: int  # from 1
    error: int
    lasts: bool = False

    @property
    def reason(self) -> str:
        """What the system says of it."""
        return os.strerror(self.error if self.error > 0 else errno.ENOSPC)

    def __str__(self) -> str:
        """Name it in one line."""
        names = {HALF: "half is written", HALF_THEN_FULL: "half is written, then ENOSPC"}
        error = names.get(self.error) or errno.errorcode[self.error]
        then = " from there on" if self.lasts else ""
        return f"{self.kind} {self.at} of process {self.process}: {error}{then}"

    @property
    def variables(self) -> dict[str, str]:
        """Environment of the layer."""
        return {
            "FAULTS_KIND": self.kind,
            "FAULTS_PROCESS": str(self.process),
            "FAULTS_AT": str(self.at),
            "FAULTS_ERROR": str(self.error),
            "FAULTS_ON": str(int(self.lasts)),
        }


@dataclass(frozen=True)
class Command:
    """A command of the program, the folder it begins in, and what becomes of that.

    Parameters
    ----------
    prepare : makes the files that the command finds.
    words : the command; what ends it after a fault is `again`, or the same.
    contents : what counts of the files in the folder when it has ended, by their names.
    recorded : of what a fault may never take away, by name; read in any state of the folder.
    prints : the file that takes standard output, which may be cut off if the command says so.
    """

    name: str
    prepare: Callable[[Path], None]
    words: Sequence[str | Path]
    contents: Callable[[Path], Mapping[str, object]]
    again: Sequence[str | Path] = ()
    recorded: Callable[[Path], Mapping[object, object]] = lambda folder: {}
    prints: str = ""
    kinds: Sequence[str] = KINDS
    promised: Mapping[str, set[int]] = field(default_factory=dict)

    def codes(self, fault: Fault) -> set[int]:
        """Exit codes that are promised when this happens."""
        if fault.kind == "write" and fault.error in HARMLESS and not self.prints:
            return {
                DONE
            }  # standard output is a matter of the C library, which takes a signal for an error
        return PROMISED[fault.kind] | self.promised.get(fault.kind, set())


@dataclass(frozen=True)
class Ended:
    """How a command ended under the layer."""

    code: int  # -1: it did not
    said: str
    has_failed: bool  # a call
    calls: list[dict[str, int]]  # of each process, by kind


class Workshop:
    """Folders in which one command is tried again and again."""

    def __init__(
        self, command: Command, layer: Path, root: Path, start: Starter = by_system
    ) -> None:
        self.command, self.layer, self.root, self.start = command, layer, root, start
        self.origin, self.folder = root / "origin", root / "tried"
        self.state = root / "state"
        self.origin.mkdir(parents=True)
        command.prepare(self.origin)
        self.before = dict(command.contents(self.origin))
        self._begin()
        self.whole = self._run(command.words)
        assert self.whole.code == DONE, self.whole.said
        self.after = dict(command.contents(self.folder))
        self.names = self._names()
        self.known = {Path(name).name for name in self.names} | {"standard output"}

    def faults(self, kinds: Sequence[str], most: int | None = None) -> Iterator[Fault]:
        """All calls that can fail, in all ways.

        Parameters
        ----------
        most : of each kind in each process only so many, from the first to the last one, whose
            ways to fail take turns.
        """
        for kind in kinds:
            ways = EFFECTS[kind]
            for process, calls in enumerate(self.whole.calls):
                n = calls[kind]
                if most is None or n * len(ways) <= most:
                    chosen = [(at, way) for at in range(1, n + 1) for way in ways]
                else:
                    indices = [1 + round(i * (n - 1) / max(most - 1, 1)) for i in range(most)]
                    chosen = [(at, ways[i % len(ways)]) for i, at in enumerate(indices)]
                for at, (error, lasts) in chosen:
                    yield Fault(kind, process, at, error, lasts)

    def judge(self, fault: Fault) -> list[str]:
        """Try it. Return what is wrong: each begins with "lost", "code", "line" or "again"."""
        self._begin()
        ended = self.last = self._run(self.command.words, fault)
        if not ended.has_failed:
            return ["missed: there was no such call"]
        reported = f"{fault}: code {ended.code}, said {ended.said!r}"
        wrong = self._wrong_end(fault, ended)
        now = self._read(wrong)
        known = self.command.recorded(self.folder)
        kept = self.command.recorded(self.origin).items()
        if any(known.get(name) != value for name, value in kept):
            wrong.append("lost: what was recorded before")
        wrong += [
            f"lost: {name} is neither the old nor the new one"
            for name, content in now.items()
            if content not in (self.before.get(name), self.after.get(name))
            and (name != self.command.prints or ended.code == DONE)
        ]
        if ended.code == DONE and now != self.after:
            wrong.append("lost: done, but the result is another one")
        if self._bytes(self.folder) == self._bytes(self.origin):
            return [f"{one} ({reported})" for one in wrong]  # as if it had never begun
        again = self._run(self.command.again or self.command.words)
        finally_known = self.command.recorded(self.folder)
        if any(finally_known.get(name) != value for name, value in known.items()):
            wrong.append("lost: what was recorded")
        if again.code != DONE:
            wrong.append(f"again: code {again.code}, said {again.said!r}")
        elif self._read(wrong) != self.after or self._names() != self.names:
            wrong.append(f"again: the result is another one; {sorted(self._names() ^ self.names)}")
        return [f"{one} ({reported})" for one in wrong]

    def _wrong_end(self, fault: Fault, ended: Ended) -> list[str]:
        if ended.code not in self.command.codes(fault):
            return ["code: not promised"]
        lines = ended.said.splitlines()
        if ended.code == DONE:
            # A worker that had no memory was replaced.
            known = ("warning", "memory") if fault.kind == "malloc" else ("warning",)
            is_known = all(any(word in line for word in known) for line in lines)
            return [] if is_known else ["line: done"]
        if len(lines) != 1:
            return ["line: there must be one"]
        if fault.kind not in NAMELESS and not any(name in lines[0] for name in self.known):
            return ["line: does not tell where"]
        # What cannot be read may be taken for damaged.
        words = {"malloc": ["memory"], "lock": [*LOCKED, fault.reason]}
        is_reported = any(word in lines[0] for word in words.get(fault.kind, [fault.reason]))
        is_reported |= fault.kind == "read" and ended.code == BAD_INPUT
        return [] if is_reported else ["line: does not tell why"]

    def _read(self, wrong: list[str]) -> Mapping[str, object]:
        try:
            return self.command.contents(self.folder)
        except Exception as error:
            wrong.append(f"lost: a file is not whole ({error!r})")
            return {}

    def _begin(self) -> None:
        shutil.rmtree(self.folder, ignore_errors=True)
        shutil.copytree(self.origin, self.folder)

    def _bytes(self, folder: Path) -> dict[str, bytes]:
        files = (path for path in folder.rglob("*") if path.is_file())
        return {str(path.relative_to(folder)): path.read_bytes() for path in files}

    def _names(self) -> set[str]:
        names = {str(path.relative_to(self.folder)) for path in self.folder.rglob("*")}
        return {name for name in names if not LEFT_BY_A_WRITER.search(name)}

    def _run(self, words: Sequence[str | Path], fault: Fault | None = None) -> Ended:
        self.state.write_bytes(bytes(STATE_BYTES))
        environment = {
            **os.environ,
            "LD_PRELOAD": str(self.layer),
            "LAYER_FOLDER": str(self.folder),
            "FAULTS_STATE": str(self.state),
            "TMPDIR": str(self.root),
            **(fault.variables if fault else {}),
        }
        printed = self.folder / self.command.prints if self.command.prints else Path(os.devnull)
        code, said = self.start(words, self.folder, environment, printed)
        return Ended(code, said, *self._read_state())

    def _read_state(self) -> tuple[bool, list[dict[str, int]]]:
        state = self.state.read_bytes()
        n, failed = struct.unpack_from("ii", state)
        row = struct.Struct(f"{len(KINDS)}q")
        counts = [row.unpack_from(state, 8 + i * row.size) for i in range(min(n, MOST_PROCESSES))]
        return failed != 0, [dict(zip(KINDS, one, strict=True)) for one in counts]
