"""The command line: select mutants, run their tests, report the verdicts."""

from __future__ import annotations

import argparse
import multiprocessing
import os
import random
import signal
import sys
import time
from collections import Counter
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from queue import Empty

from mutation import trial
from mutation.entries import ROOT, ListError, Mutant, read_list, stale
from mutation.ground import Ground
from mutation.records import (
    KILLED,
    SURVIVED,
    WRONG,
    Record,
    append_record,
    read_records,
    summary,
)
from mutation.trial import adopt_orphans, run_tests

FOLDER = ROOT / "build" / "mutate"
RECORDS = FOLDER / "records.jsonl"
FEW = 8  # tests to run first because they detected mutants of the same file
REST = ("tests",)  # tests that --all runs when the named tests have passed


def _options() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(
        prog="tools/mutate",
        description="Make each change that tools/mutants lists, in a copy of the tree under"
        " build/mutate, and run tests on it: they should fail. What has a verdict is not run"
        " again.",
        epilog="Example: tools/mutate --only johnson",
    )
    parser.add_argument(
        "--only",
        metavar="TEXT",
        action="append",
        help="those whose line holds this text, or another",
    )
    parser.add_argument("--sample", type=int, metavar="N", help="N of them, drawn by chance")
    parser.add_argument("--seed", type=int, default=0, help="of the sample")
    parser.add_argument(
        "--survivors", action="store_true", help="those that survived or were wrong, again"
    )
    parser.add_argument("--again", action="store_true", help="also what has a verdict")
    parser.add_argument(
        "--all", action="store_true", help="ask the whole suite where the named tests pass"
    )
    parser.add_argument("-j", type=int, default=1, metavar="N", help="N copies at a time")
    parser.add_argument(
        "--seconds", type=int, default=trial.SECONDS, metavar="N", help="that each test may take"
    )
    parser.add_argument(
        "--doubt", action="store_true", help="only ask all that noticed, without a mutant"
    )
    parser.add_argument("--trust", action="store_true", help="leave that for later")
    parser.add_argument("--list", action="store_true", help="only list them")
    parser.add_argument("--report", action="store_true", help="only tell what came out so far")
    return parser


def chosen(
    mutants: list[Mutant], records: dict[str, Record], options: argparse.Namespace
) -> list[Mutant]:
    """Select the mutants to be run, without those known to be equivalent."""
    some = [m for m in mutants if not m.equivalent]
    if options.only:
        some = [m for m in some if any(text in str(m) or text == m.key for text in options.only)]
    if options.survivors:
        some = [m for m in some if m.key in records and records[m.key].verdict != KILLED]
    elif not options.again:
        some = [m for m in some if m.key not in records]
    if options.sample is not None and options.sample < len(some):
        drawn = set(random.Random(options.seed).sample(range(len(some)), options.sample))
        some = [m for i, m in enumerate(some) if i in drawn]
    return some


def judge(ground: Ground, mutant: Mutant, ask_all: bool, first: Sequence[str] = ()) -> Record:
    """Run the tests of one mutant, starting with `first`, which detected others."""
    start = time.monotonic()
    ground.put(mutant)
    outcome = run_tests(ground, mutant.tests, ground.folder, first)
    if outcome.passed and ask_all:
        outcome = run_tests(ground, REST, ground.folder)
    seconds = round(time.monotonic() - start, 1)
    if not outcome.is_built:
        return Record(mutant.key, WRONG, "it does not compile", "", seconds)
    verdict = SURVIVED if outcome.passed else KILLED
    return Record(mutant.key, verdict, outcome.by, outcome.how, seconds, outcome.left_behind)


def quickest(mutant: Mutant, records: dict[str, Record], path_of: dict[str, str]) -> list[str]:
    """List tests that detected other mutants of the file, the most frequent first."""
    count = Counter(
        record.by
        for record in records.values()
        if record.verdict == KILLED and path_of.get(record.key) == mutant.path
    )
    return [test for test, _ in count.most_common(FEW)]


def doubted(ground: Ground, records: list[Record]) -> list[Record]:
    """Run the detecting tests without a mutant: the verdict of a test that still fails is void."""
    killers = sorted({record.by for record in records if record.verdict == KILLED})
    failing = set()
    ground.put(None)
    while left := tuple(killer for killer in killers if killer not in failing):
        outcome = run_tests(ground, left, ground.folder)
        if outcome.passed:
            break
        if not outcome.is_built:
            raise ListError(f"the tree does not build: {ground.log}")
        if outcome.by in left:
            failing.add(outcome.by)
        else:  # one of them cannot even be run
            failing |= {k for k in left if not run_tests(ground, (k,), ground.folder).passed}
            break
    return [
        replace(record, verdict=WRONG, by=f"fails without any mutant: {record.by}")
        for record in records
        if record.verdict == KILLED and record.by in failing
    ]


def _work(
    number: int, files: multiprocessing.Queue[list[Mutant]], ask_all: bool, jobs: int
) -> None:
    """Run the mutants of one file after another in a separate copy."""
    signal.signal(signal.SIGTERM, signal.default_int_handler)  # its child processes end with it
    os.nice(max(0, 10 - os.nice(0)))
    adopt_orphans()
    ground = Ground(FOLDER / str(number), jobs)
    ground.prepare()
    while True:
        try:
            group = files.get(timeout=1)
        except Empty:
            break
        path_of = {mutant.key: mutant.path for mutant in group}
        for mutant in group:
            first = quickest(mutant, read_records(RECORDS), path_of)
            record = judge(ground, mutant, ask_all, first)
            append_record(RECORDS, record)
            _report(record, str(mutant))


def _doubt(mutants: list[Mutant], jobs: int) -> None:
    """Check all killed mutants again, with the unmodified tree."""
    records = read_records(RECORDS)
    ground = Ground(FOLDER / "1", jobs)
    ground.prepare()
    for record in doubted(ground, [records[m.key] for m in mutants if m.key in records]):
        append_record(RECORDS, record)
        _report(record, next(str(m) for m in mutants if m.key == record.key))


def _report(record: Record, what: str) -> None:
    how = f" ({record.how})" if record.how else ""
    by = f"\n{'':<20}{record.by}{how}" if record.by else ""
    left = f"\n{'':<20}{record.left_behind} processes were left behind" * bool(record.left_behind)
    print(f"{record.verdict:<10}{record.seconds:>7.1f} s  {what}{by}{left}", flush=True)


def _run(mutants: list[Mutant], copies: int, ask_all: bool) -> bool:
    by_file: dict[str, list[Mutant]] = {}
    for mutant in mutants:
        by_file.setdefault(mutant.path, []).append(mutant)
    groups = list(by_file.values())
    random.Random(0).shuffle(groups)  # a run that is stopped has sampled all modules
    files: multiprocessing.Queue[list[Mutant]] = multiprocessing.Queue()
    for group in groups:
        files.put(group)
    jobs = max(1, (os.cpu_count() or 1) // copies)
    arguments = [
        (number, files, ask_all, jobs) for number in range(1, min(copies, len(groups)) + 1)
    ]
    workers = [multiprocessing.Process(target=_work, args=row) for row in arguments]
    for worker in workers:
        worker.start()
    try:
        for worker in workers:
            worker.join()
    except BaseException:
        files.cancel_join_thread()  # no process takes the remaining ones
        for worker in workers:
            worker.terminate()
        raise
    return all(worker.exitcode == 0 for worker in workers)


def main(arguments: list[str] | None = None) -> int:
    """Return exit code 0 if all are killed, 1 if one survived, 2 if the list is wrong."""
    signal.signal(signal.SIGTERM, signal.default_int_handler)
    adopt_orphans()
    options = _options().parse_args(arguments)
    try:
        mutants = read_list()
    except ListError as error:
        print(f"tools/mutate: {error}", file=sys.stderr)
        return 2
    if complaints := stale(mutants):
        print("\n".join(f"tools/mutate: {text}" for text in complaints), file=sys.stderr)
        return 2
    trial.SECONDS = options.seconds
    FOLDER.mkdir(parents=True, exist_ok=True)
    selected = chosen(mutants, read_records(RECORDS), options)
    if options.list:
        print("\n".join(f"{mutant.key}  {mutant}" for mutant in selected))
        return 0
    only_report = options.report or options.doubt
    ended = only_report or not selected or _run(selected, options.j, options.all)
    if options.doubt or (selected and not options.report and not options.trust):
        _doubt(mutants if options.doubt else selected, os.cpu_count() or 1)
    records = read_records(RECORDS)
    print(summary(mutants, records))
    bad = [m for m in selected if m.key in records and records[m.key].verdict != KILLED]
    return 0 if ended and not bad else 1


def paths() -> tuple[Path, Path]:
    """Return the paths of the copies and of the records, for tests."""
    return FOLDER, RECORDS
