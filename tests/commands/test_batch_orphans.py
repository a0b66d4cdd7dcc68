"""Workers end with their parent, however that ends, and hold no socket but their own."""

from __future__ import annotations

import os
import signal
import subprocess
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import h5py
import numpy as np
import pytest

from designs import write_design
from processes import children, is_alive, running, wait_for

TORQUE = "wheels.pinion.loads.0.value"
N_WORKERS = 4


@pytest.fixture
def endless(tmp_path: Path) -> Path:
    """A design whose cases never end."""
    columns = {
        TORQUE: [-1.0] * N_WORKERS,
        "simulation.duration": [1e6] * N_WORKERS,
        "simulation.output_interval": [0.01] * N_WORKERS,
    }
    return write_design(tmp_path / "endless.h5", columns)


@contextmanager
def batch_at_work(
    executable: Path, design: Path, folder: Path, jobs: int = N_WORKERS
) -> Iterator[tuple[subprocess.Popen[bytes], list[int]]]:
    """A batch with all workers inside a case; none remains afterwards."""
    command = [executable, "batch", design, "-o", "r", "--jobs", str(jobs), "-q"]
    workers: list[int] = []
    with running(command, folder, stdin=subprocess.DEVNULL) as parent:
        try:
            wait_for(lambda: len(children(parent.pid)) == jobs)
            workers = children(parent.pid)
            wait_for(lambda: all(spent(pid) > 0.02 for pid in workers))  # long after their start
            yield parent, workers
        finally:
            parent.kill()
            for pid in workers:
                if is_alive(pid) and "evolvent" in Path(f"/proc/{pid}/comm").read_text():
                    os.kill(pid, signal.SIGKILL)


def spent(pid: int) -> float:
    """Processor time of a process [s]."""
    words = Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()
    return (int(words[11]) + int(words[12])) / os.sysconf("SC_CLK_TCK")


def test_workers_in_the_midst_of_a_case_die_with_their_parent(
    executable: Path, tmp_path: Path, endless: Path
) -> None:
    """Immediately: the case would never reach the failing send of its result."""
    with batch_at_work(executable, endless, tmp_path) as (parent, workers):
        parent.kill()
        wait_for(lambda: not any(map(is_alive, workers)), seconds=10.0)


def test_a_worker_holds_the_socket_of_no_other(
    executable: Path, tmp_path: Path, endless: Path
) -> None:
    """Through it a worker that outlives its parent would appear to have one."""
    with batch_at_work(executable, endless, tmp_path) as (_, workers):
        for worker in workers:
            open_files = [str(file.readlink()) for file in Path(f"/proc/{worker}/fd").iterdir()]
            assert sum(name.startswith("socket:") for name in open_files) == 1, open_files


def test_a_worker_whose_parent_died_before_it_could_notice_runs_nothing(
    executable: Path, faults_layer: Path, tmp_path: Path
) -> None:
    """The preloaded library ends the parent just before the worker requests to die with it."""
    design = write_design(tmp_path / "design.h5", {TORQUE: [-1.0]}, histories="normal_force")
    state = tmp_path / "state"
    state.write_bytes(bytes(65536))
    environment = {
        **os.environ,
        "LD_PRELOAD": str(faults_layer),
        "LAYER_FOLDER": str(tmp_path),
        "FAULTS_STATE": str(state),
        "FAULTS_ORPHAN": "1",
    }
    command = [executable, "batch", design, "-o", "r", "-q"]
    with running(command, tmp_path, env=environment) as parent:
        parent.wait(timeout=60)
    assert parent.returncode == -signal.SIGKILL
    time.sleep(1.0)  # an orphan would need a tenth of that
    with h5py.File(tmp_path / "r" / "shard-1-of-1.h5") as stack:
        assert np.isnan(stack["normal_force"]).all()
