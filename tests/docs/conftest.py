"""A folder in which a reader of the documents works."""

from __future__ import annotations

import shutil
import sys
from collections.abc import Callable
from pathlib import Path

import pytest

from documents import ROOT


@pytest.fixture(scope="session")
def make_workplace(
    tmp_path_factory: pytest.TempPathFactory, executable: Path
) -> Callable[[str], Path]:
    """Make a folder with the examples, and all commands in its `bin`."""

    def make(name: str) -> Path:
        folder = tmp_path_factory.mktemp(name)
        shutil.copytree(ROOT / "examples", folder / "examples")
        (folder / "bin").mkdir()
        (folder / "bin" / "evolvent").symlink_to(executable)
        for name in ("post", "sweep"):
            script = folder / "bin" / f"evolvent-{name}"
            script.write_text(
                f"#!{sys.executable}\nfrom evolvent.commands.{name}.app import main\n\nmain()\n"
            )
            script.chmod(0o755)
        return folder

    return make


@pytest.fixture(scope="session")
def workplace(make_workplace: Callable[[str], Path]) -> Path:
    """Give the folder that the pages share."""
    return make_workplace("docs")
