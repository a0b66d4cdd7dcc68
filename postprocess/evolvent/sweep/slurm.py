"""Scripts for Slurm: a job array of shards, and a job that collects when they have ended."""

from __future__ import annotations

import math
import shlex
import subprocess
import sys
from dataclasses import dataclass
from pathlib import Path

from evolvent.sweep.errors import NOT_WRITTEN, SweepError
from evolvent.sweep.folder import Shard

A_SHARD = 600.0  # seconds that a shard should take
MOST = 1000  # tasks of an array that Slurm allows unless its site says otherwise
SCRIPTS = "slurm"  # folder of the scripts and logs, in that of the sweep
MOST_REQUEUES = 50

SHARDS = """\
#!/bin/bash
#SBATCH --job-name={name}
#SBATCH --array={array}
#SBATCH --cpus-per-task={cores}
#SBATCH --output="{logs}/shard-%a.log"
#SBATCH --open-mode=append
#SBATCH --requeue
#SBATCH --signal=B:USR1@120
{site}# Written by evolvent-sweep. Each task runs what is missing of its shard.
{lines}export OMP_NUM_THREADS=1 OPENBLAS_NUM_THREADS=1

{batch} --shard "$SLURM_ARRAY_TASK_ID/{of}" --jobs "${{SLURM_CPUS_PER_TASK:-1}}" &
batch=$!
out_of_time=false
trap 'out_of_time=true; kill -USR1 "$batch"' USR1
trap 'kill -TERM "$batch"' TERM INT
# A signal ends `wait` before the program has ended.
while kill -0 "$batch" 2>/dev/null; do wait "$batch"; done
wait "$batch"
code=$?
if [ "$code" = 75 ] && $out_of_time && [ "${{SLURM_RESTART_COUNT:-0}}" -lt {requeues} ]; then
  scontrol requeue "$SLURM_JOB_ID"
fi
[ "$code" = 1 ] && exit 0 # cases failed, which the journal tells; the shard is complete
exit "$code"
"""

COLLECTOR = """\
#!/bin/bash
#SBATCH --job-name={name}-collect
#SBATCH --output="{logs}/collect.log"
#SBATCH --open-mode=append
{site}# Written by evolvent-sweep.
{lines}
{collect}
code=$?
{status}
exit "$code"
"""


@dataclass(frozen=True)
class Site:
    """What a site wants in the head of the scripts."""

    account: str | None = None
    partition: str | None = None
    time: str | None = None  # limit of a shard
    options: tuple[str, ...] = ()  # as "constraint=haswell"
    lines: tuple[str, ...] = ()  # shell, such as "module load hdf5"

    def head(self, with_time: bool = True) -> str:
        """The #SBATCH lines."""
        given = [("account", self.account), ("partition", self.partition)]
        if with_time:
            given.append(("time", self.time))
        options = [f"{key}={value}" for key, value in given if value]
        options += [option.lstrip("-") for option in self.options]
        return "".join(f"#SBATCH --{option}\n" for option in options)


def shard_count(n_cases: int, seconds_a_case: float, cores: int) -> int:
    """Number of shards of about ten minutes each."""
    count = math.ceil(n_cases * seconds_a_case / (A_SHARD * cores))
    return max(1, min(count, MOST, n_cases))


def write_scripts(
    program: Path, design: Path, folder: Path, shards: list[Shard], cores: int, site: Site
) -> tuple[Path, Path]:
    """Write the scripts of an array for these shards and of its collector.

    Parameters
    ----------
    shards : those that have something to do, all of one split.
    cores : of each task.

    Raises
    ------
    SweepError
        They cannot be written.
    """
    folder = folder.absolute()
    place = folder / SCRIPTS
    python = [sys.executable, "-m", "evolvent.sweep"]
    batch = [str(program), "batch", str(design.absolute()), "-o", str(folder), "--resume"]
    collect = [*python, "collect", str(folder), "-o", str(folder / "summary.h5")]
    common = {
        "name": folder.name.replace(" ", "-"),
        "logs": str(place).replace("%", "%%"),
        "lines": "".join(f"{line}\n" for line in site.lines),
    }
    texts = {
        "shards.sh": SHARDS.format(
            **common,
            array=array_text([shard.index for shard in shards]),
            cores=cores,
            site=site.head(),
            of=shards[0].of,
            batch=shlex.join(batch),
            requeues=MOST_REQUEUES,
        ),
        "collect.sh": COLLECTOR.format(
            **common,
            site=site.head(with_time=False),
            collect=shlex.join(collect),
            status=shlex.join([*python, "status", str(folder)]),
        ),
    }
    try:
        place.mkdir(parents=True, exist_ok=True)
        for name, text in texts.items():
            (place / name).write_text(text, encoding="utf-8")
            (place / name).chmod(0o755)
    except OSError as error:
        raise SweepError(f"{place}: cannot be written ({error.strerror})", NOT_WRITTEN) from error
    return place / "shards.sh", place / "collect.sh"


def submit(shards: Path, collector: Path) -> tuple[str, str]:
    """Submit both scripts; return their job numbers.

    Raises
    ------
    SweepError
        There is no sbatch, or it refuses.
    """
    array = _sbatch([str(shards)])
    return array, _sbatch([f"--dependency=afterany:{array}", str(collector)])


def array_text(indices: list[int]) -> str:
    """Write task numbers as Slurm's --array has them: 1-4,7."""
    parts: list[list[int]] = []
    for index in sorted(indices):
        if parts and parts[-1][1] == index - 1:
            parts[-1][1] = index
        else:
            parts.append([index, index])
    return ",".join(f"{a}" if a == b else f"{a}-{b}" for a, b in parts)


def _sbatch(arguments: list[str]) -> str:
    command = ["sbatch", "--parsable", *arguments]
    try:
        done = subprocess.run(command, capture_output=True, text=True, check=False, timeout=120)
    except FileNotFoundError as error:
        raise SweepError("there is no sbatch here; submit the scripts on the cluster") from error
    except subprocess.TimeoutExpired as error:
        raise SweepError("sbatch does not answer") from error
    if done.returncode != 0:
        raise SweepError(f"sbatch refused {arguments[-1]}: {' '.join(done.stderr.split())}")
    return done.stdout.strip().split(";")[0]
