"""A folder whose machine may lose power: what nobody has synced is gone then."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
from collections.abc import Sequence
from pathlib import Path

SYNC_ALL = """
import os, sys
for folder, _, names in os.walk(sys.argv[1]):
    for name in [*names, "."]:
        descriptor = os.open(os.path.join(folder, name), os.O_RDONLY)
        os.fsync(descriptor)
        os.close(descriptor)
"""


class Machine:
    """A machine with a disk of one folder. All that is there when it is made is on the disk."""

    def __init__(self, folder: Path, store: Path, layer: Path) -> None:
        self.folder, self.store, self.layer = folder.resolve(), store.resolve(), layer
        self.store.mkdir()
        self.sync()

    def environment(self, **more: str) -> dict[str, str]:
        """Of a program that runs on it; `more`: variables of the layer."""
        return {
            **os.environ,
            "LD_PRELOAD": str(self.layer),
            "LAYER_FOLDER": str(self.folder),
            "POWER_STORE": str(self.store),
            **more,
        }

    def run(self, words: Sequence[str | Path], **more: str) -> subprocess.CompletedProcess[str]:
        """Run a program on it; `more`: variables of the layer."""
        return subprocess.run(
            words,
            cwd=self.folder,
            env=self.environment(**more),
            capture_output=True,
            text=True,
            timeout=60,
            check=False,
        )

    def sync(self) -> None:
        """Bring all of it to the disk."""
        done = self.run([sys.executable, "-c", SYNC_ALL, self.folder])
        assert done.returncode == 0, done.stderr

    @property
    def n_syncs(self) -> int:
        """How often something was brought to the disk."""
        return (self.store / "syncs").stat().st_size

    def after_loss(self, target: Path) -> Path:
        """Make the folder as it is found when the power is back."""
        self._restore(self.store / "root", target)
        return target

    def on_disk(self, name: str) -> bytes:
        """Content of a file, as it would be found now; b"" if it is not there."""
        folder = self.store / "root"
        *above, last = Path(name).parts
        for part in above:
            key = self._names(folder).get(part)
            if key is None:
                return b""
            folder = self.store / f"{key[1]}.names"
        kind_and_key = self._names(folder).get(last)
        content = self.store / kind_and_key[1] if kind_and_key else None
        return content.read_bytes() if content is not None and content.exists() else b""

    def _names(self, listed: Path) -> dict[str, tuple[str, str]]:
        lines = listed.read_text().splitlines() if listed.exists() else []
        rows = (line.split(" ", 2) for line in lines)
        return {name: (kind, key) for kind, key, name in rows}

    def _restore(self, listed: Path, target: Path) -> None:
        target.mkdir()
        for name, (kind, key) in self._names(listed).items():
            if kind == "d":
                self._restore(self.store / f"{key}.names", target / name)
            elif (self.store / key).exists():
                shutil.copyfile(self.store / key, target / name)
            else:
                (target / name).touch()
