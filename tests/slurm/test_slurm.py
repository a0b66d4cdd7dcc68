"""Sweeps on a real Slurm, which the tests start for themselves."""

from __future__ import annotations

import json
import os
import re
import signal
import subprocess
import time
from collections.abc import Callable, Iterator
from pathlib import Path

import h5py
import pytest

import machine
from documents import NOT_RUN, ROOT, blocks
from evolvent.sweep.folder import Shard, is_locked
from processes import awaits

HERE = Path(__file__).resolve().parent
EXAMPLES = ROOT / "examples"
PAPER = EXAMPLES / "paper-friction.yaml"
PATIENCE = 120.0  # until something that takes seconds is taken for stuck [s]
NEEDED = ("munged", "slurmctld", "slurmd", "sbatch")


@pytest.fixture(scope="module")
def slurm(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Path]:
    """Folder of a Slurm that runs; with its configuration in the environment."""
    for program in NEEDED:
        machine.program(program)
    folder = tmp_path_factory.mktemp("slurm")
    with (folder / "start.log").open("w+") as log:  # daemons would hold a pipe open
        started = subprocess.run(
            [HERE / "private-slurm", "start", folder],
            stdout=log,
            stderr=log,
            stdin=subprocess.DEVNULL,
            timeout=PATIENCE,
            check=False,
        )
        log.seek(0)
        output = log.read()
    try:
        if started.returncode != 0 and os.getuid() != 0:
            machine.unavailable(f"Slurm does not start without root: {output.splitlines()[-1:]}")
        assert started.returncode == 0, output
        yield folder
    finally:
        subprocess.run([HERE / "private-slurm", "stop", folder], timeout=PATIENCE, check=True)


@pytest.fixture
def slurm_sweep(
    slurm: Path, sweep: Callable[..., tuple[int, str, str]], monkeypatch: pytest.MonkeyPatch
) -> Callable[..., tuple[int, str, str]]:
    monkeypatch.setenv("SLURM_CONF", str(slurm / "slurm.conf"))
    return sweep


def ask(*command: str) -> str:
    """Run a command of Slurm; each may hang."""
    done = subprocess.run(command, capture_output=True, text=True, timeout=PATIENCE, check=True)
    return done.stdout


def wait_until(condition: Callable[[], bool], what: str) -> None:
    end = time.monotonic() + PATIENCE
    while not condition():
        assert time.monotonic() < end, f"{what} did not come: {ask('squeue', '--long')}"
        time.sleep(0.2)


def wait_for_jobs() -> None:
    wait_until(lambda: ask("squeue", "--noheader") == "", "the end of all jobs")


def journals(folder: Path) -> list[str]:
    return sorted(path.name for path in folder.glob("shard-*.jsonl"))


def recorded(folder: Path) -> list[int]:
    """Cases in the order of the journals, whatever became of them."""
    cases = []
    for path in sorted(folder.glob("*.jsonl")):
        rows = [json.loads(line) for line in path.read_text().splitlines()]
        cases += [row["case"] for row in rows if "case" in row]
    return cases


TURNING_BACK = "{kind: speeds, speeds: {pinion: 2, gear: -1.333}}"


def write_plan(
    path: Path, loads: list[float], brakes: list[float], starts: list[str], duration: float
) -> None:
    path.write_text(f"""
format: 1
case: {PAPER}
method: list
parameters:
- {{path: wheels.pinion.loads.0.value, name: load, values: {loads}}}
- {{path: wheels.gear.loads.0.coefficient, name: brake, values: {brakes}}}
- {{path: simulation.initial, name: start, values: [{", ".join(starts)}]}}
- {{path: simulation.duration, name: duration, value: {duration}}}
- {{path: simulation.output_interval, name: interval, value: 0.01}}
""")


def test_an_array_with_failing_cases_is_collected_and_goes_on_with_what_is_missing(
    slurm_sweep, tmp_path
):
    n, turned, braked = 40, (2, 9, 17, 31), (5, 6, 22)
    # A pinion that turns back leaves the involute: failed. No brake is negative: refused.
    starts = [TURNING_BACK if i in turned else "{kind: rest}" for i in range(n)]
    brakes = [-5.0 if i in braked else 10.0 for i in range(n)]
    write_plan(tmp_path / "sweep.yaml", [-1.0] * n, brakes, starts, 0.2)
    assert slurm_sweep("plan", "sweep.yaml", "-o", "design.h5", "--keep-refused")[0] == 0

    command = ("slurm", "design.h5", "-o", "d", "--shards", "4", "--time", "00:05:00", "--submit")
    code, out, err = slurm_sweep(*command, "--partition", "low", "--line", "export SITE=here")
    assert (code, err) == (0, "")
    assert re.search(r"submitted: 4 shards as job \d+, the collector as \d+", out)
    script = Path("d/slurm/shards.sh").read_text()
    for line in (
        "#SBATCH --array=1-4",
        "#SBATCH --requeue",
        "#SBATCH --open-mode=append",
        "#SBATCH --signal=B:USR1@120",
        "#SBATCH --partition=low",
        "#SBATCH --time=00:05:00",
        "export SITE=here",
    ):
        assert f"{line}\n" in script
    wait_for_jobs()

    assert sorted(recorded(Path("d"))) == list(range(n))
    assert journals(Path("d")) == [f"shard-{i}-of-4.jsonl" for i in range(1, 5)]
    with h5py.File("d/summary.h5") as summary:  # the collector came after the array
        status = summary["status"][:].tolist()
    assert [i for i in range(n) if status[i] == 2] == sorted(turned)
    assert [i for i in range(n) if status[i] == 3] == sorted(braked)
    assert status.count(1) == n - 7
    log = Path("d/slurm/collect.log").read_text()
    assert "summary.h5: 40 cases: 33 done, 7 did not finish (4 failed, 3 refused), 0 missing" in log

    code, out, _ = slurm_sweep(*command)
    assert (code, out) == (0, "d: all 40 cases are recorded; no case is left to run\n")

    # Two cases of one shard and the journal of another are lost.
    third = Path("d/shard-3-of-4.jsonl")
    third.write_text("".join(third.read_text().splitlines(keepends=True)[:-2]))
    Path("d/shard-2-of-4.jsonl").unlink()
    kept = recorded(Path("d"))
    assert len(kept) == 28
    code, out, _ = slurm_sweep(*command)
    assert code == 0
    assert "submitted: 2 shards" in out
    assert "#SBATCH --array=2-3\n" in Path("d/slurm/shards.sh").read_text()
    wait_for_jobs()
    now = recorded(Path("d"))
    assert sorted(now) == list(range(n))  # each once: what was recorded was not run again
    log = Path("d/slurm/collect.log").read_text()
    assert (
        log.count("40 cases: 33 done, 7 did not finish (4 failed, 3 refused), 0 missing") == 2
    )  # appended


def test_more_shards_than_an_array_takes_go_in_several_and_failed_cases_are_retried_so(
    slurm_sweep, tmp_path
):
    n, turned, braked = 24, (2, 9), (5,)
    starts = [TURNING_BACK if i in turned else "{kind: rest}" for i in range(n)]
    brakes = [-5.0 if i in braked else 10.0 for i in range(n)]
    write_plan(tmp_path / "sweep.yaml", [-1.0] * n, brakes, starts, 0.2)
    assert slurm_sweep("plan", "sweep.yaml", "-o", "design.h5", "--keep-refused")[0] == 0

    command = ("slurm", "design.h5", "-o", "d", "--shards", "12", "--submit")
    code, out, err = slurm_sweep(*command, "--partition", "low")
    assert (code, err) == (0, "")  # tasks 1 to 5: MaxArraySize is 6
    assert re.search(r"submitted: 12 shards as 3 arrays, \d+, \d+, \d+, the collector as \d+", out)
    wait_for_jobs()
    assert sorted(recorded(Path("d"))) == list(range(n))
    assert journals(Path("d")) == sorted(f"shard-{i}-of-12.jsonl" for i in range(1, 13))
    logs = {path.name for path in Path("d/slurm").glob("shard-*.log")}
    assert logs >= {"shard-1.log", "shard-5+1.log", "shard-10+2.log"}
    counts = "24 cases: 21 done, 3 did not finish (2 failed, 1 refused), 0 missing"
    assert counts in Path("d/slurm/collect.log").read_text()  # after all three

    # Half of a shard of the second array and a shard of the third are lost.
    eighth = Path("d/shard-8-of-12.jsonl")
    eighth.write_text("".join(eighth.read_text().splitlines(keepends=True)[:-1]))
    Path("d/shard-12-of-12.jsonl").unlink()
    assert "missing" in slurm_sweep("status", "d")[1]
    assert "submitted: 2 shards as 2 arrays" in slurm_sweep(*command)[1]
    assert {path.name for path in Path("d/slurm").glob("*.sh")} == {
        *("shards-1.sh", "shards-2.sh", "collect.sh")
    }
    wait_for_jobs()
    assert sorted(recorded(Path("d"))) == list(range(n))

    code, out, err = slurm_sweep("retry", "d", "--failed", "--case", "0", "--slurm", "--submit")
    assert (code, err) == (0, "")
    assert "submitted: 4 shards as 2 arrays" in out  # 1, 3 and 6, 10
    assert "#SBATCH --array=1,3\n" in Path("d/slurm/retry-1.sh").read_text()
    wait_for_jobs()
    assert sorted(recorded(Path("d"))) == sorted([*range(n), *turned, *braked, 0])
    log = Path("d/slurm/collect.log").read_text()
    assert log.count(counts) == 3
    assert "recorded more than once, the latest is used: 0, 2, 5, 9" in log


def long_design(slurm_sweep, tmp_path) -> int:
    n = 60
    loads = [-1.0 - 0.01 * i for i in range(n)]
    write_plan(tmp_path / "sweep.yaml", loads, [10.0] * n, ["{kind: rest}"] * n, 5.0)
    assert slurm_sweep("plan", "sweep.yaml", "-o", "design.h5")[0] == 0
    return n


def submit_one_shard(slurm_sweep, n: int) -> tuple[str, int, list[int]]:
    """Submit `n` cases as one shard and stop it after some: its job, its process, those cases.

    Until the process is let go on, no case is recorded, however long Slurm takes for anything.
    """
    command = ("slurm", "design.h5", "-o", "d", "--shards", "1", "--partition", "low")
    code, out, _ = slurm_sweep(*command, "--time", "00:10:00", "--submit")
    assert code == 0
    match = re.search(r"as job (\d+)", out)
    assert match
    wait_until(lambda: len(recorded_whole(Path("d"))) >= 3, "the first cases")
    owner = re.search(r"pid (\d+) ", Path("d/shard-1-of-1.lock").read_text())
    assert owner
    os.kill(int(owner[1]), signal.SIGSTOP)
    first = recorded(Path("d"))
    assert 3 <= len(first) < n
    return match[1], int(owner[1]), first


def recorded_whole(folder: Path) -> list[str]:
    """Lines of cases of journals that grow."""
    texts = [path.read_text() for path in folder.glob("*.jsonl")]
    return [line for text in texts for line in text.splitlines() if line.startswith('{"case":')]


def assert_continued(first: list[int], n: int) -> None:
    """All cases are recorded once, and those of the first start stayed."""
    assert recorded(Path("d"))[: len(first)] == first
    assert sorted(recorded(Path("d"))) == list(range(n))
    assert not is_locked(Path("d"), Shard(1, 1))
    assert (
        f"{n} cases: {n} done, 0 did not finish, 0 missing"
        in Path("d/slurm/collect.log").read_text()
    )


def test_a_preempted_shard_is_requeued_and_continues(slurm_sweep, tmp_path):
    n = long_design(slurm_sweep, tmp_path)
    job, _, first = submit_one_shard(slurm_sweep, n)
    urgent = tmp_path / "urgent.sh"
    urgent.write_text("#!/bin/bash\nsleep 1\n")
    options = ["--partition=high", "--exclusive", f"--output={tmp_path}/urgent.log"]
    # It takes the node from the shard, which Slurm lets go on to be told so.
    ask("sbatch", "--wait", *options, str(urgent))
    assert "Restarts=1" in ask("scontrol", "show", "job", f"{job}_1")
    wait_for_jobs()
    assert_continued(first, n)


def test_a_shard_that_runs_out_of_time_requeues_itself_and_continues(slurm_sweep, tmp_path):
    n = long_design(slurm_sweep, tmp_path)
    job, process, first = submit_one_shard(slurm_sweep, n)
    # What Slurm sends 120 s before the limit.
    ask("scancel", "--signal=USR1", "--batch", f"{job}_1")
    wait_until(lambda: awaits(process, signal.SIGUSR1), "the signal")
    os.kill(process, signal.SIGCONT)
    wait_until(
        lambda: "Restarts=1" in ask("scontrol", "show", "job", f"{job}_1"), "the second start"
    )
    wait_for_jobs()
    assert_continued(first, n)


def test_what_slurm_refuses_is_told_in_its_words(slurm_sweep, tmp_path):
    write_plan(tmp_path / "sweep.yaml", [-1.0, -2.0], [10.0, 10.0], ["{kind: rest}"] * 2, 0.1)
    assert slurm_sweep("plan", "sweep.yaml", "-o", "design.h5")[0] == 0
    command = ("slurm", "design.h5", "-o", "d", "--shards", "2", "--submit")
    code, _, err = slurm_sweep(*command, "--partition", "nowhere")
    assert code == 3
    assert "sbatch refused" in err
    assert "invalid partition specified: nowhere" in err
    code, _, err = slurm_sweep("slurm", "design.h5", "-o", "d", "--shards", "3")
    assert code == 2
    assert "--shards 3: the design has only 2 cases" in err


def test_the_submission_of_the_tutorial_runs(slurm_sweep, tmp_path):
    text = (EXAMPLES / "tutorial-sweep.yaml").read_text(encoding="utf-8")
    (tmp_path / "tutorial-pair.yaml").symlink_to(EXAMPLES / "tutorial-pair.yaml")
    few = text.replace("number: 100}", "number: 2}")  # 10 cases in place of 500
    assert few != text
    (tmp_path / "sweep.yaml").write_text(few, encoding="utf-8")
    assert slurm_sweep("plan", "sweep.yaml", "-o", "relief-design.h5")[0] == 0
    lines = "".join(steps_with_slurm(ROOT / "docs" / "tutorial" / "tutorial.md")).splitlines()
    submitting = next(line for line in lines if line.endswith("--submit"))
    words = submitting.removeprefix("evolvent-sweep ").replace(" --account gears", "").split()
    code, out, err = slurm_sweep(*words)
    assert (code, err) == (0, "")
    assert "submitted: 8 shards" in out
    wait_for_jobs()
    asking = next(line for line in lines if line.startswith("evolvent-sweep status"))
    assert " 10  done" in slurm_sweep(*asking.split()[1:])[1]
    with h5py.File("cluster/summary.h5") as summary:
        assert summary["dynamic_factor"][:].min() > 1


def steps_with_slurm(page: Path) -> list[str]:
    """Blocks of a page that tests of documents leave out because they need Slurm."""
    return [body for body in blocks(page, "bash") if body.startswith(f"{NOT_RUN} needs Slurm")]
