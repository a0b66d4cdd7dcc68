"""Wide gearboxes run correctly or are rejected: 200 of them always, 10,000 with --long."""

from __future__ import annotations

from pathlib import Path

import pytest

from system.right_or_refused import Judge
from system.scaled_cases import UNITS, keys
from system.wide_gearboxes import KINDS, kind_of

SHORT, LONG, TOGETHER = 100, 10_000, 10  # seeds, and the number of seeds judged in a test
# Open cases: docs/reports/random_sets.md gives the reasons.
OPEN = {0: "slow", 59: "slow"}


@pytest.mark.parametrize("first", range(0, SHORT, TOGETHER))
def test_wide_gearboxes_run_right_or_are_refused(executable: Path, tmp_path: Path, first: int):
    judge_all(executable, tmp_path, first)


@pytest.mark.long
@pytest.mark.parametrize("first", range(SHORT, LONG, TOGETHER))
def test_more_wide_gearboxes_run_right_or_are_refused(
    executable: Path, tmp_path: Path, first: int
) -> None:
    judge_all(executable, tmp_path, first)


# Further seeds that failed in the past.
MENDED = (
    *(678, 921, 2052, 3062, 3345, 3400, 5378, 8758),
    *(3061, 4682, 4723, 5314, 6184, 6754),  # with differences of large numbers
    *(1629, 3346, 7079, 7729, 8439),  # rigid flanks that separate simultaneously
    *(531, 5272, 8992),  # grazing flanks
    *(1972, 4584),  # digits of a force; a start beyond a hand-over
    *(1384, 2665),  # steady starts near a tiny speed
    *(3496, 9926),  # tracked points without a pair on the path
    *(5739, 6886, 7911),  # ended or rejected with a message
    *(1030, 2614, 6540),  # steps that shrank to rounding
    1414,  # the energy of a mounted housing in a short run
    20151,  # a transmission error at rounding level
)


@pytest.mark.parametrize("seed", MENDED)
def test_wide_gearboxes_that_were_wrong_run_right(executable: Path, tmp_path: Path, seed: int):
    judged = Judge(executable, tmp_path)(seed)
    assert judged.is_sound, str(judged)


def judge_all(program: Path, folder: Path, first: int) -> None:
    """Judge the seeds of a test."""
    judge = Judge(program, folder)
    judged = [judge(seed) for seed in range(first, first + TOGETHER) if seed not in OPEN]
    assert [str(one) for one in judged if not one.is_sound] == []
    kinds = ("agree", "alone", "says so", "converges", "ida lags")
    ran = [one for one in judged if one.outcome in kinds]
    assert len(ran) >= TOGETHER // 2, "a set that is refused shows nothing"


def test_all_kinds_are_among_the_short_ones() -> None:
    assert {kind_of(seed) for seed in range(TOGETHER)} == set(KINDS)


def test_the_units_of_all_keys_are_known(executable: Path) -> None:
    """A case in other units is equivalent only if every key with a unit is scaled."""
    rows = [row for block in keys(executable).values() for of in block.values() for row in of]
    assert {row.unit for row in rows} <= {*UNITS, "N/m^exponent"}
