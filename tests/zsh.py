"""Interactive zsh in tests: completions of a line, and the resulting line."""

from __future__ import annotations

import os
import pty
import select
import signal
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

SECONDS = 30.0
TELL = b"\x14"  # key that completes the line, reports the result, and clears the line
SETUP = r"""
fpath=(.. $fpath); autoload -U compinit; compinit -u -d ../dump; PROMPT= ; unsetopt beep
compadd() {
    if [[ ${@[1,(i)(-|--)]} == *-(O|A|D)\ * ]]; then builtin compadd "$@"; return; fi
    local -a hits; builtin compadd -A hits "$@"
    (($#hits)) && print -rN -- $hits >>../offered
    builtin compadd "$@"
}
zle -C offer complete-word _main_complete
tell() { : >../offered; zle offer; print -rn -- "$BUFFER" >../line; zle kill-buffer; : >../told }
zle -N tell; bindkey '^T' tell
: >../ready
"""


class Zsh:
    """A shell in a folder; its reports are files in the folder above."""

    def __init__(self, terminal: int, root: Path) -> None:
        self.terminal, self.root = terminal, root

    def wait_for(self, name: str) -> None:
        """Read its output until it has created a file."""
        end = time.monotonic() + SECONDS
        while not (self.root / name).exists():
            assert time.monotonic() < end, f"zsh made no {name}"
            if select.select([self.terminal], [], [], 0.01)[0]:
                os.read(self.terminal, 65536)
        (self.root / name).unlink()

    def complete(self, line: str) -> tuple[list[str], str]:
        """Return the completions of the last word of a line, quoted, and the resulting line."""
        os.write(self.terminal, line.encode() + TELL)
        self.wait_for("told")
        offered = (self.root / "offered").read_text().split("\0")
        return [word for word in offered if word], (self.root / "line").read_text()


@contextmanager
def zsh(folder: Path, path: str) -> Iterator[Zsh]:
    """Start a shell with the functions of the folder above, and end it."""
    root = folder.parent
    (root / "setup").write_text(SETUP)
    pid, terminal = pty.fork()
    if pid == 0:
        try:
            os.chdir(folder)
            own = {"PATH": path, "TERM": "dumb", "HOME": str(root)}
            os.execvpe("zsh", ["zsh", "-f", "-i"], {**os.environ, **own})
        finally:
            os._exit(1)
    try:
        shell = Zsh(terminal, root)
        os.write(terminal, b"source ../setup\n")
        shell.wait_for("ready")
        yield shell
    finally:
        os.kill(pid, signal.SIGKILL)
        os.waitpid(pid, 0)
        os.close(terminal)
