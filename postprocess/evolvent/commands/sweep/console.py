"""Output of evolvent-sweep on the terminal."""

from __future__ import annotations

import math
import time
from dataclasses import asdict
from pathlib import Path
from typing import TYPE_CHECKING, Any

from evolvent.commands.program import new_console, right, say

if TYPE_CHECKING:
    import xarray as xr

    from evolvent.sweep.check import Checked
    from evolvent.sweep.design import Design
    from evolvent.sweep.journal import Records
    from evolvent.sweep.status import Reason, Status

FIRST_ROWS = 8
MOST_REASONS = 8
MOST_VALUES = 8  # of the row of a case


def complain(message: str) -> None:
    """Print an error or a warning."""
    say(f"evolvent-sweep: {message}", err=True)


def show_design(design: Design) -> None:
    """Print the number of cases and the first of them."""
    from rich.markup import escape
    from rich.table import Table

    new_console().print(
        f"{design.n_cases} cases by {design.method}, seed {design.seed}", highlight=False
    )
    heads = [escape(f"{p.name} [{p.units}]" if p.units else p.name) for p in design.parameters]
    table = Table(*map(right, ("case", *heads)), box=None)
    for case in range(min(FIRST_ROWS, design.n_cases)):
        texts = [_value(p.values[case]) for p in design.parameters]
        table.add_row(str(case), *map(escape, texts))
    if design.n_cases > FIRST_ROWS:
        table.add_row("...")
    new_console().print(table)


def show_estimate(n_cases: int, seconds: float, is_bound: bool, n_cores: int) -> None:
    """Print the estimated run time of a design."""
    from evolvent.sweep.estimate import span

    least = "at least " if is_bound else "about "
    say(
        f"{least}{_duration(seconds)} a case: {least}{span(n_cases * seconds / n_cores)} on "
        f"{n_cores} cores here"
    )


def show_refusals(sweep: Path, design: Design, checked: Checked) -> None:
    """Print the number of cases that would be rejected, with each reason and its first case."""
    complain(f"{sweep}: {checked.refused} of {design.n_cases} cases would be refused:")
    for reason in checked.reasons[:MOST_REASONS]:
        row = ", ".join(
            f"{p.name} = {_value(p.values[reason.case])}" for p in design.parameters[:MOST_VALUES]
        )
        more = ", ..." if len(design.parameters) > MOST_VALUES else ""
        first = "first " if reason.count > 1 else ""
        say(
            f"  {reason.count} x {reason.example} ({first}case {reason.case}: {row}{more})",
            err=True,
        )
    _show_rest(checked.reasons, err=True)


def show_counts(directory: Path, found: Status) -> None:
    """Print the counts of cases by status in one line."""
    say(f"{directory}: {found.counts}")
    if found.counts.unfinished:
        say(f"why they did not finish: evolvent-sweep status {directory}")


def show_status(directory: Path, found: Status) -> None:
    """Print the progress of a sweep."""
    from rich.table import Table

    table = Table(right(""), "", box=None, show_header=False)
    counts = found.counts
    number, _, words = counts.unfinished_text.partition(" ")
    table.add_row(str(counts.done), "done")
    table.add_row(number, words)
    table.add_row(str(counts.missing), "missing")
    table.add_row(str(counts.n_cases), "cases")
    new_console().print(table)
    for reason in found.reasons[:MOST_REASONS]:
        say(f"{reason.count} x {reason.example} (case {reason.case})")
    _show_rest(found.reasons)
    say(_progress_rate(found))
    if found.torn:
        say(f"{found.torn} truncated or damaged lines of the journals are ignored")


def show_collected(output: Path, collected: Records) -> None:
    """Print the contents of a summary, and the missing cases."""
    from evolvent.sweep.status import listed

    say(f"{output}: {collected.counts}")
    if collected.holes.size:
        say(f"missing: {listed(collected.holes)}")
    if collected.repeated.size:
        say(f"recorded more than once, the latest is used: {listed(collected.repeated)}")
    if collected.torn:
        say(f"{collected.torn} truncated or damaged lines of the journals are ignored")
    if len(collected.versions) > 1:
        complain(f"the cases are of several versions of evolvent: {', '.join(collected.versions)}")


def show_indices(indices: xr.Dataset) -> None:
    """Print sensitivity indices."""
    from rich.table import Table

    kinds = [kind for kind in ("first_order", "total") if kind in indices]
    table = Table("parameter", *[right(kind.replace("_", " ")) for kind in kinds], box=None)
    for number, name in enumerate(indices["parameter"].values):
        row = indices.isel(parameter=number)
        table.add_row(
            str(name),
            *[f"{row[kind].item():.3f} ± {row[f'{kind}_confidence'].item():.3f}" for kind in kinds],
        )
    new_console().print(table)
    if indices.attrs["left_out"]:
        left_out = indices.attrs["left_out"]
        say(f"{left_out} cases are omitted: they, or others of their group, have no result")


def status_as_json(found: Status) -> dict[str, Any]:
    """Status for scripts; unknown values are null."""
    statuses = ("done", "unfinished", "failed", "refused", "missing")
    return {
        "cases": found.counts.n_cases,
        **{key: getattr(found.counts, key) for key in statuses},
        "repeated": found.repeated,
        "torn_lines": found.torn,
        "reasons": [asdict(reason) for reason in found.reasons],
        "running_shards": [f"{shard.index}/{shard.of}" for shard in found.running],
        "rate": found.rate if math.isfinite(found.rate) else None,
        "finished_at": found.finished_at if math.isfinite(found.finished_at) else None,
    }


def _progress_rate(found: Status) -> str:
    from evolvent.sweep.estimate import span

    rate = f"{found.rate:.3g} cases a second" if math.isfinite(found.rate) else "no rate yet"
    if found.is_complete:
        return f"finished, {rate}" if math.isfinite(found.rate) else "finished"
    if not found.running:
        return "no run is active; repeat its command to continue"
    shards = f"{len(found.running)} active shards, {rate}"
    if not math.isfinite(found.finished_at):
        return shards
    clock = time.strftime("%Y-%m-%d %H:%M", time.localtime(found.finished_at))
    return f"{shards}, finished in {span(found.finished_at - time.time())}, at {clock}"


def _show_rest(reasons: list[Reason], err: bool = False) -> None:
    if len(reasons) > MOST_REASONS:
        rest = sum(reason.count for reason in reasons[MOST_REASONS:])
        say(f"{rest} for {len(reasons) - MOST_REASONS} other reasons", err=err)


def _value(value: Any) -> str:
    return value if isinstance(value, str) else f"{value:.8g}"


def _duration(seconds: float) -> str:
    from evolvent.sweep.estimate import span

    return f"{1e3 * seconds:.3g} ms" if seconds < 1.0 else span(seconds)
