"""Files whose names follow from others are not written through symbolic links."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from subprocess import CompletedProcess

import pytest

from designs import write_design

Evolvent = Callable[..., CompletedProcess[str]]
TORQUE = "wheels.pinion.loads.0.value"
PRECIOUS = "what nobody has named\n"


@pytest.fixture
def victim(tmp_path: Path) -> Path:
    path = tmp_path / "victim"
    path.write_text(PRECIOUS)
    return path


@pytest.mark.parametrize("is_there", [True, False], ids=["to a file", "to nothing"])
@pytest.mark.parametrize("command", ["run", "static"])
def test_a_partial_file_is_not_written_through_a_link(
    evolvent: Evolvent, examples: Path, victim: Path, tmp_path: Path, command: str, is_there: bool
) -> None:
    if not is_there:
        victim.unlink()
    (tmp_path / "v.h5.partial").symlink_to(victim)
    short = ["--set", "simulation.duration=0.01"] if command == "run" else []
    done = evolvent(command, examples / "spur-pair.yaml", *short, "-o", "v.h5")
    assert done.returncode == 74
    assert done.stderr.splitlines()[-1] == (
        "evolvent: cannot write 'v.h5.partial': a symbolic link, which is not followed; remove it "
        "or choose another name"
    )
    assert victim.exists() == is_there
    assert not is_there or victim.read_text() == PRECIOUS
    assert not (tmp_path / "v.h5").exists()


@pytest.mark.parametrize("ending", ["jsonl", "lock", "h5.partial", "h5"])
def test_a_batch_writes_through_no_link_in_its_folder(
    evolvent: Evolvent, victim: Path, tmp_path: Path, ending: str
) -> None:
    design = write_design(tmp_path / "d.h5", {TORQUE: [-1.0]}, histories="normal_force")
    (tmp_path / "r").mkdir()
    (tmp_path / f"r/shard-1-of-1.{ending}").symlink_to(victim)
    done = evolvent("batch", design, "-o", "r")
    assert done.returncode in (3, 74)
    assert done.stderr.count("\n") == 1
    assert f"shard-1-of-1.{ending}" in done.stderr
    assert victim.read_text() == PRECIOUS
