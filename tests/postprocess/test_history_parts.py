"""The folder of a run with checkpoints, read as one history while it grows."""

from __future__ import annotations

import json
import os
import subprocess
from collections.abc import Callable
from pathlib import Path

import h5py
import numpy as np
import pytest
import xarray as xr

from evolvent.errors import HistoryError
from evolvent.history import open_events, open_history, open_recording
from processes import running, wait_for

Post = Callable[..., tuple[int, str, str]]
N_PARTS = 4


@pytest.fixture(scope="module")
def folder(executable: Path, examples: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Parts of a run that was killed; beside it `plain.h5`, a run that goes further."""
    base = tmp_path_factory.mktemp("parts")
    words = [executable, "run", examples / "rattle.yaml", "-q"]
    words += ["--set", "simulation.integrator=radau", "--set"]
    more = ["simulation.duration=1000", "-o", "long.h5", "--checkpoint", "0.0005"]
    parts = base / "long.h5.parts"
    with running([*words, *more], base) as process:
        wait_for(lambda: len([*parts.glob("part-????.h5")]) > N_PARTS)
        process.kill()
        process.wait()
    with h5py.File(sorted(parts.glob("part-????.h5"))[-1]) as last:
        end = float(last["time"][-1]) + 0.01  # events come after the last output, too
    subprocess.run([*words, f"simulation.duration={end}", "-o", "plain.h5"], cwd=base, check=True)
    return parts


@pytest.fixture
def plain(folder: Path) -> Path:
    return folder.parent / "plain.h5"


def test_the_parts_together_are_the_history_of_one_run(folder: Path, plain: Path) -> None:
    with open_history(folder) as parts, open_history(plain) as whole:
        n = parts.sizes["time"]
        assert n > N_PARTS
        assert n < whole.sizes["time"]
        assert parts.attrs["status"] == "part"
        over_time = [name for name in whole.variables if "time" in whole[name].dims]
        for name in over_time:
            np.testing.assert_array_equal(parts[name].values, whole[name].values[:n])
        assert set(over_time) == {name for name in parts.variables if "time" in parts[name].dims}
        np.testing.assert_array_equal(parts.teeth, whole.teeth)
        assert list(parts.wheel.values) == list(whole.wheel.values)


@pytest.mark.parametrize(
    "rows",
    [slice(None), slice(5, None, 7), slice(-3, None), slice(None, None, -3), slice(900, 100, -7)],
)
def test_any_rows_of_parts_are_those_of_the_whole(folder: Path, plain: Path, rows: slice) -> None:
    with open_history(folder) as parts, open_history(plain) as whole:
        n = parts.sizes["time"]
        for name in ("normal_force", "angle", "pairs_in_contact"):
            expected = whole[name].values[:n][rows]
            np.testing.assert_array_equal(parts[name][rows].values, expected)
            np.testing.assert_array_equal(parts[name][n // 2].values, whole[name].values[n // 2])


def test_a_recording_of_parts_is_read_across_their_borders(folder: Path, plain: Path) -> None:
    with open_recording(folder) as parts, open_recording(plain) as whole:
        parts.block = 1 + parts.n // 7
        for part in parts.parts():
            for name in ("time", "normal_force", "teeth"):
                mine = whole.read(name, part.begin, part.end)
                np.testing.assert_array_equal(part[name], mine)
        assert parts.labels("wheel") == whole.labels("wheel")


def test_events_are_numbered_over_all_parts(folder: Path, plain: Path) -> None:
    with open_events(folder) as parts, open_events(plain) as whole:
        n = parts.sizes["event"]
        assert n > 0
        assert list(parts.event.values) == list(range(n))
        np.testing.assert_array_equal(parts.time.values, whole.time.values[:n])
        assert list(parts.kind.values) == list(whole.kind.values[:n])


def test_the_commands_take_the_folder_of_a_run(folder: Path, plain: Path, post: Post) -> None:
    code, out, err = post("check", folder, "--json")
    assert code == 0, err
    assert "the run did not finish: a part of an incomplete run" in json.loads(out)[0]["warning"]
    code, _, err = post("compare", folder, plain)
    assert code in (0, 1), err
    code, _, err = post("report", folder, "-o", "report.html")
    assert code == 0, err
    code, _, err = post("plot", folder, "--quantity", "normal_force")
    assert code == 0, err


def test_a_damaged_part_is_noticed(folder: Path, tmp_path: Path, post: Post) -> None:
    copy = tmp_path / "long.h5.parts"
    copy.mkdir()
    for path in folder.glob("part-????.h5"):
        (copy / path.name).write_bytes(path.read_bytes())
    damaged = copy / "part-0002.h5"
    data = bytearray(damaged.read_bytes())
    data[len(data) // 2] ^= 1
    damaged.write_bytes(data)
    code, _, err = post("check", copy)
    assert code == 3
    assert "part-0002.h5: is damaged" in err
    damaged.unlink()
    with pytest.raises(HistoryError, match=r"part-0002\.h5 is missing"):
        open_history(copy)


def test_a_folder_without_parts_is_no_history(tmp_path: Path) -> None:
    (tmp_path / "a.h5.parts").mkdir()
    for opened in (open_history, open_events):
        with pytest.raises(HistoryError, match="has no closed part yet"):
            opened(tmp_path / "a.h5.parts")
    with pytest.raises(HistoryError, match=r"did not finish, but there is a\.h5\.parts"):
        open_history(tmp_path / "a.h5")


def test_a_part_that_still_grows_does_not_count(folder: Path, tmp_path: Path) -> None:
    copy = tmp_path / "long.h5.parts"
    copy.mkdir()
    os.link(folder / "part-0001.h5", copy / "part-0001.h5")
    (copy / "part-0002.h5.partial").write_bytes(b"half")
    with open_history(copy) as one, xr.open_dataset(folder / "part-0001.h5") as first:
        assert one.sizes["time"] == first.sizes["time"]
