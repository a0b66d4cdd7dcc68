"""Scripts for Slurm: job arrays of shards, and a job that collects the results at their end."""

from __future__ import annotations

import math
import re
import shlex
import subprocess
import sys
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from jinja2 import Environment, PackageLoader, StrictUndefined

from evolvent.errors import USAGE, SweepError, replacing, writing
from evolvent.sweep.folder import Shard
from evolvent.sweep.status import joined, runs

A_SHARD = 600.0  # target duration of a shard [s]
MOST = 5000  # shards, unless more are requested
USUAL_TASKS = 1000  # default limit of the tasks of an array in Slurm
SCRIPTS = "slurm"  # folder of the scripts and logs, in that of the sweep
MOST_REQUEUES = 50
QUOTES = "\"'`\\"
TASK = "SLURM_ARRAY_TASK_ID"


@dataclass(frozen=True)
class Array:
    """A job array: task i runs shard `offset` + i of `of`."""

    of: int
    offset: int
    tasks: tuple[int, ...]


@dataclass(frozen=True)
class Site:
    """Site-specific contents of the head of the scripts."""

    account: str | None = None
    partition: str | None = None
    time: str | None = None  # limit of a shard
    options: tuple[str, ...] = ()  # as "constraint=haswell"
    lines: tuple[str, ...] = ()  # shell, such as "module load hdf5"

    def head(self, with_time: bool = True) -> str:
        """Return the #SBATCH lines.

        Raises
        ------
        SweepError
            A value contains an unprintable character, such as a line break.
        """
        given = [("account", self.account), ("partition", self.partition)]
        if with_time:
            given.append(("time", self.time))
        options = [f"{key}={value}" for key, value in given if value]
        options += [option.lstrip("-") for option in self.options]
        for option in options:
            if not option.isprintable():
                raise SweepError(f"--{option}: has a character that cannot be printed", USAGE)
        return "".join(f"#SBATCH --{option}\n" for option in options)


def shard_count(n_cases: int, seconds_a_case: float, cores: int) -> int:
    """Number of shards of about ten minutes each."""
    count = math.ceil(n_cases * seconds_a_case / (A_SHARD * cores))
    return max(1, min(count, MOST, n_cases))


def tasks_of_an_array() -> int:
    """Maximum number of tasks of an array in the local Slurm; the default without Slurm."""
    command = ["scontrol", "show", "config"]
    try:
        done = subprocess.run(command, capture_output=True, text=True, check=False, timeout=60)
    except (FileNotFoundError, subprocess.TimeoutExpired):
        return USUAL_TASKS
    found = re.search(r"^MaxArraySize\s*=\s*(\d+)", done.stdout, re.MULTILINE)
    # MaxArraySize is one more than the largest task index. 0 and 1: no arrays at all.
    return max(int(found[1]) - 1, 1) if found else USUAL_TASKS


def split_arrays(shards: Sequence[Shard], most: int) -> list[Array]:
    """Distribute shards over the smallest number of arrays.

    Parameters
    ----------
    most : largest index of a task.
    """
    blocks: dict[tuple[int, int], list[int]] = {}
    for shard in sorted(shards):
        offset = (shard.index - 1) // most * most
        blocks.setdefault((shard.of, offset), []).append(shard.index - offset)
    return [Array(of, offset, tuple(tasks)) for (of, offset), tasks in blocks.items()]


def check_path(path: Path) -> None:
    """Reject a path that is not valid in the head of a script, where Slurm has its own syntax.

    Raises
    ------
    SweepError
        It has a quote, a backslash or a character that cannot be printed.
    """
    bad = next((c for c in str(path) if c in QUOTES or not c.isprintable()), None)
    if bad is not None:
        raise SweepError(
            f"{path}: a path for Slurm cannot contain the character {bad!a}; choose another name"
        )


def write_scripts(
    program: Path,
    design: Path,
    folder: Path,
    arrays: Sequence[Array],
    cores: int,
    site: Site,
    lists: Path | None = None,
) -> tuple[list[Path], Path]:
    """Write a script for each array, and that of the collector.

    Parameters
    ----------
    cores : of each task.
    lists : folder of lists of cases to run again, one per shard (`retry`); None: each task runs the
        missing cases of its shard.

    Raises
    ------
    SweepError
        They cannot be written, or a path is not valid in them.
    """
    folder, design = folder.absolute(), design.absolute()
    for path in (folder, design, program, Path(sys.executable)):
        check_path(path)
    scripts = folder / SCRIPTS
    python = [sys.executable, "-m", "evolvent.commands.sweep"]
    batch = [str(program), "batch", str(design), "-o", str(folder), "--resume"]
    collect = [*python, "collect", str(folder), "-o", str(folder / "summary.h5")]
    templates = Environment(
        loader=PackageLoader("evolvent.sweep"),
        keep_trailing_newline=True,
        undefined=StrictUndefined,
    )
    templates.globals = {
        "name": folder.name.replace(" ", "-"),
        "logs": str(scripts).replace("%", "%%"),
        "lines": "".join(f"{line}\n" for line in site.lines),
    }
    kind = "shards" if lists is None else "retry"
    texts = {}
    for number, array in enumerate(arrays, start=1):
        listed = f' --cases {shlex.quote(str(lists))}/"shard-$shard-of-{array.of}.txt"'
        texts[kind if len(arrays) == 1 else f"{kind}-{number}"] = templates.get_template(
            "shards.sh.j2"
        ).render(
            array=joined(runs(array.tasks), ","),
            log=f"shard-{array.offset}+%a.log" if array.offset else "shard-%a.log",
            shard=f"$(({array.offset} + {TASK}))" if array.offset else f"${TASK}",
            what="the missing cases" if lists is None else "the listed cases",
            cores=cores,
            site=site.head(),
            of=array.of,
            batch=shlex.join(batch),
            cases="" if lists is None else listed,
            requeues=MOST_REQUEUES,
        )
    collector = templates.get_template("collect.sh.j2").render(
        site=site.head(with_time=False),
        collect=shlex.join(collect),
        status=shlex.join([*python, "status", str(folder)]),
    )
    with writing(scripts):
        scripts.mkdir(parents=True, exist_ok=True)
        for old in scripts.glob(f"{kind}*.sh"):  # of a command with other arrays
            old.unlink()
        for name, text in {**texts, "collect": collector}.items():
            with replacing(scripts / f"{name}.sh") as temporary:
                temporary.write_text(text, encoding="utf-8")
                temporary.chmod(0o755)
    return [scripts / f"{name}.sh" for name in texts], scripts / "collect.sh"


def submit(arrays: Sequence[Path], collector: Path) -> tuple[list[str], str]:
    """Submit the scripts, and the collector after all arrays; return their job numbers.

    Raises
    ------
    SweepError
        There is no sbatch, or it fails. Arrays submitted before remain, with a collector.
    """
    jobs: list[str] = []
    for script in arrays:
        try:
            jobs.append(_sbatch([str(script)]))
        except SweepError as error:
            if not jobs:
                raise
            after = _submit_collector(jobs, collector)
            raise SweepError(
                f"{error}; submitted before: {len(jobs)} of {len(arrays)} arrays as "
                f"{', '.join(jobs)}, the collector as {after}; repeat the command when they "
                "have ended"
            ) from error
    return jobs, _submit_collector(jobs, collector)


def _submit_collector(jobs: Sequence[str], collector: Path) -> str:
    return _sbatch([f"--dependency=afterany:{':'.join(jobs)}", str(collector)])


def _sbatch(arguments: list[str]) -> str:
    command = ["sbatch", "--parsable", *arguments]
    try:
        done = subprocess.run(command, capture_output=True, text=True, check=False, timeout=120)
    except FileNotFoundError as error:
        raise SweepError(
            "sbatch is not installed here; submit the scripts on the cluster"
        ) from error
    except subprocess.TimeoutExpired as error:
        raise SweepError("sbatch does not respond") from error
    if done.returncode != 0:
        raise SweepError(f"sbatch refused {arguments[-1]}: {' '.join(done.stderr.split())}")
    return done.stdout.strip().split(";")[0]
