"""Scripts for Slurm without one: how shards become arrays, and what their tasks run."""

from __future__ import annotations

import re
import subprocess
import sys
from pathlib import Path

import pytest

from evolvent.errors import SweepError
from evolvent.sweep import slurm
from evolvent.sweep.folder import Shard


def fake(folder: Path, name: str, text: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """Put a program into a folder that is looked through first."""
    (folder / name).write_text(f"#!/bin/bash\n{text}\n")
    (folder / name).chmod(0o755)
    monkeypatch.setenv("PATH", str(folder), prepend=":")


@pytest.mark.parametrize("most", [1, 5, 999, 1000, 4000])
def test_every_shard_is_a_task_of_one_array(most):
    shards = [Shard(2500, i) for i in range(1, 2501) if i % 7] + [Shard(4, 3)]
    arrays = slurm.split_arrays(shards, most)
    tasks = [Shard(a.of, a.offset + task) for a in arrays for task in a.tasks]
    assert sorted(tasks) == sorted(shards)
    assert len(tasks) == len(set(tasks))
    assert all(1 <= task <= most for a in arrays for task in a.tasks)


def test_as_few_arrays_as_fit():
    arrays = slurm.split_arrays([Shard(2500, i) for i in range(1, 2501)], 1000)
    assert [(a.offset, len(a.tasks)) for a in arrays] == [(0, 1000), (1000, 1000), (2000, 500)]
    assert len(slurm.split_arrays([Shard(2500, 2400)], 1000)) == 1


def test_every_python_module_that_a_script_starts_can_be_started(tmp_path):
    arrays = slurm.split_arrays([Shard(2, 1), Shard(2, 2)], 1000)
    design, lists = tmp_path / "design.h5", tmp_path / "lists"
    files, collector = slurm.write_scripts(
        Path("evolvent"), design, tmp_path, arrays, 1, slurm.Site(), lists
    )
    texts = "".join(file.read_text() for file in (*files, collector))
    modules = set(re.findall(r" -m (evolvent\S*)", texts))
    assert modules == {"evolvent.commands.sweep"}
    for module in modules:
        done = subprocess.run(
            [sys.executable, "-m", module, "--help"], capture_output=True, text=True, check=True
        )
        assert done.stderr == ""


@pytest.mark.parametrize(
    ("answer", "tasks"),
    [
        ("echo 'MaxArraySize            = 1001'", 1000),
        ("echo 'MaxArraySize=4000001'", 4000000),
        ("echo 'MaxArraySize = 6 # few'", 5),
        ("echo nothing", slurm.USUAL_TASKS),
        ("exit 1", slurm.USUAL_TASKS),
    ],
)
def test_the_size_of_an_array_is_asked_of_slurm(tmp_path, monkeypatch, answer, tasks):
    fake(tmp_path, "scontrol", answer, monkeypatch)
    assert slurm.tasks_of_an_array() == tasks


def test_without_slurm_an_array_has_the_usual_size(tmp_path, monkeypatch):
    monkeypatch.setenv("PATH", str(tmp_path))
    assert slurm.tasks_of_an_array() == slurm.USUAL_TASKS


def test_an_array_that_is_refused_leaves_those_before_with_their_collector(tmp_path, monkeypatch):
    calls = tmp_path / "calls"
    text = f"""echo "$@" >>{calls}
case "$*" in *shards-3*) echo too many >&2; exit 1 ;; esac
echo $(wc -l <{calls});cluster"""
    fake(tmp_path, "sbatch", text.replace(");cluster", ")';cluster'"), monkeypatch)
    scripts = [tmp_path / f"shards-{i}.sh" for i in (1, 2, 3, 4)]
    with pytest.raises(SweepError) as caught:
        slurm.submit(scripts, tmp_path / "collect.sh")
    assert "too many; submitted before: 2 of 4 arrays as 1, 2, the collector as 4" in str(
        caught.value
    )
    asked = [line.split()[1:] for line in calls.read_text().splitlines()]
    assert asked[-1] == ["--dependency=afterany:1:2", str(tmp_path / "collect.sh")]
    assert len(asked) == 4


def test_a_task_of_a_retry_runs_the_list_of_its_shard(tmp_path):
    lists, arrays = tmp_path / "a b", slurm.split_arrays([Shard(12, 7)], 5)
    (script,), _ = slurm.write_scripts(
        Path("/bin/evolvent"), tmp_path / "d.h5", tmp_path, arrays, 1, slurm.Site(), lists
    )
    (line,) = (text for text in script.read_text().splitlines() if "batch" in text.split()[:2])
    shown = ["bash", "-c", f"shard=7; printf '%s\\n' {line.removesuffix('&')}"]
    words = subprocess.run(shown, capture_output=True, text=True, check=True).stdout.splitlines()
    assert words[words.index("--cases") + 1] == f"{lists}/shard-7-of-12.txt"


def test_scripts_of_several_arrays_name_their_shards(tmp_path):
    arrays = slurm.split_arrays([Shard(12, i) for i in (1, 2, 6, 12)], 5)
    site = slurm.Site(account="gears")
    scripts, collector = slurm.write_scripts(
        Path("/bin/evolvent"), tmp_path / "d.h5", tmp_path, arrays, 2, site
    )
    assert [path.name for path in (*scripts, collector)] == [
        *("shards-1.sh", "shards-2.sh", "shards-3.sh", "collect.sh")
    ]
    texts = [path.read_text() for path in scripts]
    assert [re.findall("--array=(.*)", text) for text in texts] == [["1-2"], ["1"], ["2"]]
    assert [re.findall("^shard=(.*)", text, re.MULTILINE) for text in texts] == [
        ["$SLURM_ARRAY_TASK_ID"],
        ["$((5 + SLURM_ARRAY_TASK_ID))"],
        ["$((10 + SLURM_ARRAY_TASK_ID))"],
    ]
    assert all("--account=gears\n" in text for text in texts)
