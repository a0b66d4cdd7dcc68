"""What is said of a sweep that goes on or has ended."""

from __future__ import annotations

import json
import re
import subprocess
import sys
import textwrap

import numpy as np
import pytest
from sweeps import BEGAN, failed, line_of, make_design, row, write_journal

from evolvent.sweep.collect import open_summary
from evolvent.sweep.estimate import span
from evolvent.sweep.figures import figure_response
from evolvent.sweep.folder import Shard, is_locked
from evolvent.sweep.journal import Counts, read_records
from evolvent.sweep.run import INTERVAL, LINE_EACH, Tally, display, log_interval, progress_line
from evolvent.sweep.status import listed, read_status, recent_rate


def test_cases_are_counted_by_what_became_of_them(tmp_path):
    design = make_design(10)
    refused = failed(4, "wheels.pinion.teeth: is 2", status="refused", exit=3)
    write_journal(tmp_path, design, [row(0), row(1), failed(2), refused])
    found = read_status(tmp_path, design)
    assert found.counts == Counts(done=2, failed=1, refused=1, missing=6)
    assert found.counts.n_cases == 10
    assert not found.is_complete


def test_every_command_counts_what_did_not_finish_alike(sweep, tmp_path):
    design, folder = make_design(20), tmp_path / "d"
    bad = [failed(i) for i in (3, 4, 5)]
    bad += [failed(i, "is 2", status="refused", exit=3) for i in (6, 9)]
    write_journal(folder, design, [*(row(i) for i in range(3)), *bad])
    reported = "20 cases: 3 done, 5 did not finish (3 failed, 2 refused), 12 missing"
    records = read_records(folder, design)
    assert str(records.counts) == reported
    assert sweep("collect", "d", "-o", "s.h5")[1].startswith(f"s.h5: {reported}\n")
    lines = [" ".join(line.split()) for line in sweep("status", "d")[1].splitlines()]
    assert lines[:2] == ["3 done", "5 did not finish (3 failed, 2 refused)"]
    assert lines[4:6] == ["3 x contact was lost (case 3)", "2 x is 2 (case 6)"]
    found = json.loads(sweep("status", "d", "--json")[1])
    assert [found[key] for key in ("unfinished", "failed", "refused")] == [5, 3, 2]
    with open_summary(tmp_path / "s.h5") as summary:
        figure = figure_response(summary, "penetration_max", ())
    legend = [text.get_text() for found in figure.legends for text in found.get_texts()]
    assert "did not finish: 5 of 20" in legend
    assert "8 of 20 cases, 5 did not finish" in progress_line(Tally(folder, records))


def test_the_progress_of_a_run_is_what_the_program_counts(tmp_path):
    """Of ten cases five are recorded, two of them bad; these two are run again, and one other."""
    design = make_design(10)
    before = [row(0), row(1), row(2), failed(3), failed(4)]
    journal = write_journal(tmp_path, design, before)
    tally = Tally(tmp_path, read_records(tmp_path, design), again=2)
    assert (tally.total, tally.recorded, tally.unfinished) == (10, 3, 2)
    head = journal.read_text().splitlines()[0]
    with journal.open("a") as file:
        file.write("".join(line_of(one, head) + "\n" for one in (row(3), failed(4), failed(7))))
        file.write(line_of(row(8), head)[:30])  # goes on
    tally.look()
    assert (tally.new, tally.recorded, tally.unfinished) == (3, 6, 2)
    with journal.open("a") as file:
        file.write(line_of(row(8), head)[30:] + "\n")
    tally.look(at_once=True)
    assert (tally.new, tally.recorded, tally.unfinished) == (4, 7, 2)


def test_a_log_gets_lines_with_the_time_of_how_far_a_sweep_is(tmp_path, monkeypatch, capsys):
    design = make_design(10)
    write_journal(tmp_path, design, [row(0), failed(1)])
    tally = Tally(tmp_path, read_records(tmp_path, design))
    with display(tally) as show:  # a minute is not over
        show()
    assert capsys.readouterr().err == ""
    monkeypatch.setenv(INTERVAL, "1e-9")
    with display(tally) as show:
        show()
    first, last = capsys.readouterr().err.splitlines()
    for line in (first, last):
        assert re.fullmatch(
            r"evolvent-sweep: \d{4}-\d\d-\d\d \d\d:\d\d:\d\d  2 of 10 cases, 1 did not finish, "
            r"0 a second, \? left",
            line,
        )


@pytest.mark.parametrize("interval", ["", "often", "0", "-1", "inf", "nan"])
def test_an_interval_that_is_no_number_of_seconds_is_a_minute(monkeypatch, interval):
    monkeypatch.setenv(INTERVAL, interval)
    assert log_interval() == LINE_EACH == 60.0


def test_reasons_that_differ_in_numbers_are_one_and_the_most_frequent_comes_first(tmp_path):
    design = make_design(10)
    rows = [failed(9, "no steady state")]
    rows += [failed(i, f"contact was lost at t = {0.1 * i:g} s") for i in (5, 3, 7)]
    write_journal(tmp_path, design, rows)
    reasons = read_status(tmp_path, design).reasons
    assert [(r.count, r.example, r.case) for r in reasons] == [
        (3, "contact was lost at t = 0.3 s", 3),
        (1, "no steady state", 9),
    ]


def test_the_rate_is_that_of_the_last_minutes():
    early = np.linspace(0.0, 100.0, 1001)  # 10 a second
    late = np.linspace(10_000.0, 10_500.0, 1001)  # 2 a second
    times = np.concatenate([late, [np.nan], early])
    assert recent_rate(times, None) == pytest.approx(2.0, rel=1e-12)
    # 500 s later only the last 100 s of records are recent: 200 cases in 600 s.
    assert recent_rate(times, 11_000.0) == pytest.approx(200 / 600, rel=0.01)
    assert recent_rate(times, 20_000.0) == 0.0
    assert np.isnan(recent_rate(np.array([5.0, np.nan]), None))


HOLD = textwrap.dedent("""
    import fcntl, sys
    file = open(sys.argv[1], "w")
    fcntl.lockf(file, fcntl.LOCK_EX)
    print("held", flush=True)
    sys.stdin.read()
""")


def test_a_lock_counts_as_long_as_its_owner_lives(tmp_path):
    shard = Shard(of=1, index=1)
    assert not is_locked(tmp_path, shard)
    command = [sys.executable, "-c", HOLD, str(tmp_path / "shard-1-of-1.lock")]
    with subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE) as owner:
        assert owner.stdout is not None
        owner.stdout.readline()
        assert is_locked(tmp_path, shard)
        owner.kill()
    assert (tmp_path / "shard-1-of-1.lock").exists()
    assert not is_locked(tmp_path, shard)


def test_a_running_sweep_says_when_it_will_be_finished(tmp_path):
    design = make_design(100)
    write_journal(tmp_path, design, [row(i) for i in range(41)])  # one a second
    command = [sys.executable, "-c", HOLD, str(tmp_path / "shard-1-of-1.lock")]
    with subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE) as owner:
        assert owner.stdout is not None
        owner.stdout.readline()
        found = read_status(tmp_path, design, now=BEGAN + 40)
        owner.kill()
    assert found.rate == pytest.approx(1.0, rel=1e-12)
    assert found.finished_at == pytest.approx(BEGAN + 40 + 59, rel=1e-12)
    assert found.running == [Shard(of=1, index=1)]
    assert np.isnan(read_status(tmp_path, design, now=BEGAN + 40).finished_at)  # nobody works


def test_status_is_shown_for_people_and_for_scripts(sweep, tmp_path):
    design = make_design(10)
    write_journal(tmp_path / "d", design, [row(0), row(1), failed(2), failed(3)])
    code, out, err = sweep("status", "d")
    assert (code, err) == (0, "")
    lines = [line.strip() for line in out.splitlines()]
    assert lines[:4] == [
        "2  done",
        "2  did not finish (2 failed, 0 refused)",
        "6  missing",
        "10  cases",
    ]
    assert "2 x contact was lost (case 2)" in lines
    assert lines[-1] == "no run is active; repeat its command to continue"
    code, out, _ = sweep("status", "d", "--json")
    found = json.loads(out)
    assert code == 0
    assert (found["done"], found["unfinished"], found["missing"]) == (2, 2, 6)
    assert found["reasons"] == [{"count": 2, "example": "contact was lost", "case": 2}]
    assert found["rate"] == pytest.approx(1.0, rel=1e-12)
    assert found["finished_at"] is None


def test_a_finished_sweep_is_called_finished(sweep, tmp_path):
    write_journal(tmp_path / "d", make_design(3), [row(0), row(1), row(2)])
    assert sweep("status", "d")[1].splitlines()[-1] == "finished, 1 cases a second"


@pytest.mark.parametrize(
    ("cases", "text"),
    [
        ([], "none"),
        ([4], "4"),
        ([1, 2, 3, 7, 9, 10], "1-3, 7, 9-10"),
        (range(0, 100, 2), ", ".join(str(2 * i) for i in range(20)) + " and 30 more"),
    ],
)
def test_case_numbers_are_listed_in_runs(cases, text):
    assert listed(np.array(list(cases), dtype=np.int64)) == text


@pytest.mark.parametrize(
    ("seconds", "text"),
    [
        (0.2, "less than 1 s"),
        (59.4, "59 s"),
        (200, "3 min 20 s"),
        (18_420, "5 h 07 min"),
        (273_600, "3 d 4 h"),
    ],
)
def test_times_are_written_as_people_say_them(seconds, text):
    assert span(seconds) == text
