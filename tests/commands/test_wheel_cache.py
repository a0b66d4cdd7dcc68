"""The user's cache of compliant wheels: the same results for any contents."""

from __future__ import annotations

import os
import struct
import subprocess
import zlib
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

FRONT = 8 + 56 + 16  # magic, sources, lengths
MOST, KEPT = 64 << 20, 48 << 20

Show = Callable[..., str]


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    return tmp_path / "cache"


@pytest.fixture
def show(executable: Path, examples: Path, folder: Path) -> Show:
    """Output of `evolvent show` for the pair with compliant teeth."""

    def show(**environment: str) -> str:
        done = subprocess.run(
            [executable, "show", examples / "compliant-pair.yaml"],
            env={**os.environ, "EVOLVENT_CACHE": str(folder), **environment},
            capture_output=True,
            text=True,
            check=False,
        )
        assert done.returncode == 0, done.stderr
        assert "cache" not in done.stderr
        return done.stdout

    return show


def wheels(folder: Path) -> list[Path]:
    return sorted(folder.glob("wheel-*"))


def rewritten(path: Path, at: int, value: bytes) -> None:
    """Overwrite bytes of a file, and update the checksum."""
    data = bytearray(path.read_bytes()[:-4])
    data[at : at + len(value)] = value
    path.write_bytes(bytes(data) + struct.pack("<I", zlib.crc32(bytes(data))))


def numbers_at(path: Path) -> int:
    n_key, _ = struct.unpack_from("<qq", path.read_bytes(), FRONT - 16)
    return int(FRONT + 8 * n_key)


def test_a_second_run_reads_what_the_first_one_wrote(show: Show, folder: Path) -> None:
    first = show()
    assert len(wheels(folder)) == 4  # compliance and root stress of both
    assert {path.stat().st_mode & 0o777 for path in wheels(folder)} == {0o600}
    written = [path.stat().st_ino for path in wheels(folder)]
    assert show() == first == show(EVOLVENT_CACHE="off")
    assert [path.stat().st_ino for path in wheels(folder)] == written
    for path in wheels(folder):  # other values under the same key are used: the file is read
        rewritten(path, numbers_at(path), bytes(8 * 4))
    assert show() != first


@pytest.mark.parametrize("damage", ["bit", "short", "long", "empty", "folder", "link"])
def test_what_is_damaged_is_computed_anew(show: Show, folder: Path, damage: str) -> None:
    first = show()
    for path in wheels(folder):
        data = bytearray(path.read_bytes())
        data[-20] ^= 1
        if damage in ("folder", "link"):
            path.unlink()
        if damage == "folder":
            path.mkdir()
        elif damage == "link":
            path.symlink_to(folder.parent / "elsewhere")
        else:
            whole = path.read_bytes()
            short = {"bit": bytes(data), "short": whole[:-9], "long": whole + b"x", "empty": b""}
            path.write_bytes(short[damage])
    assert show() == first
    assert not (folder.parent / "elsewhere").exists()
    assert show() == first
    if damage != "folder":
        assert all(path.is_file() and not path.is_symlink() for path in wheels(folder))


def test_numbers_of_other_sources_are_not_used(show: Show, folder: Path) -> None:
    first = show()
    for path in wheels(folder):
        rewritten(path, numbers_at(path), bytes(8 * 4))
        rewritten(path, 8, b"another build")
    assert show() == first


@pytest.mark.parametrize("where", ["off", "below a file"])
def test_without_a_folder_nothing_is_kept_and_nothing_is_said(
    show: Show, folder: Path, where: str
) -> None:
    file = folder.parent / "file"
    file.write_text("")
    show(EVOLVENT_CACHE="off" if where == "off" else str(file / "cache"))
    assert not folder.exists()


def test_the_folder_follows_the_base_directories(show: Show, tmp_path: Path) -> None:
    base, home = tmp_path / "base", tmp_path / "home"
    show(EVOLVENT_CACHE="", XDG_CACHE_HOME=str(base), HOME=str(home))
    assert len(wheels(base / "evolvent")) == 4
    assert not home.exists()
    home.mkdir()
    show(EVOLVENT_CACHE="", XDG_CACHE_HOME="not/absolute", HOME=str(home))
    assert len(wheels(home / ".cache" / "evolvent")) == 4


def test_the_folder_is_bounded_and_the_oldest_go_first(show: Show, folder: Path) -> None:
    folder.mkdir()
    for i in range(80):
        path = folder / f"wheel-{i:016x}"
        with path.open("wb") as file:
            file.truncate(1 << 20)
        os.utime(path, (1e9 + i, 1e9 + i))
    other = folder / "notes"
    other.write_bytes(b"mine")
    show()
    left = {int(path.name[6:], 16) for path in wheels(folder) if path.stat().st_size == 1 << 20}
    assert sum(path.stat().st_size for path in wheels(folder)) <= KEPT < MOST
    assert left == set(range(80 - len(left), 80))
    assert len(left) > 40
    assert other.exists()
    assert len(wheels(folder)) == len(left) + 4


def test_many_processes_at_once_agree(executable: Path, examples: Path, folder: Path) -> None:
    environment = {**os.environ, "EVOLVENT_CACHE": str(folder)}
    command: list[Any] = [executable, "show", examples / "compliant-pair.yaml"]
    running = [subprocess.Popen(command, env=environment, stdout=subprocess.PIPE) for _ in range(8)]
    reported = {process.communicate()[0] for process in running}
    assert len(reported) == 1
    assert all(process.returncode == 0 for process in running)
    assert len(wheels(folder)) == 4  # compliance and root stress of both
