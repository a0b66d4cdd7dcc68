"""The command evolvent-post check."""

from __future__ import annotations

import json
from pathlib import Path
from typing import TYPE_CHECKING, Any

from evolvent.commands.post.common import BROKEN, AsJson, Files, complain
from evolvent.commands.program import json_number, new_console, right, say
from evolvent.errors import BAD_INPUT, HistoryError
from evolvent.history import open_recording, run_warning
from evolvent.history.files import verify_checksum

if TYPE_CHECKING:
    from evolvent.physics.invariants import Verdict


def check(files: Files, as_json: AsJson = False) -> None:
    """Check the invariants of runs: energy, torques, contact, geometry.

    \b
    The exit code is 1 if an invariant is violated, and 3 if a file cannot be read.
    Example:
      evolvent-post check paper.h5 paper-friction.h5
    """  # noqa: D301 - \b keeps click from filling the lines
    from evolvent.physics.invariants import check_history

    checked: list[tuple[Path, str | None, list[Verdict]]] = []
    unreadable = False
    for path in files:
        try:
            missing = verify_checksum(path)
            with open_recording(path) as history:
                if missing is not None:
                    complain(f"{path}: {missing}")
                checked.append((path, run_warning(history), check_history(history)))
        except HistoryError as error:
            complain(str(error))
            unreadable = True
    if as_json:
        say(json.dumps([_verdicts_as_json(*one) for one in checked], indent=2))
    else:
        for path, warning, verdicts in checked:
            if warning:
                complain(f"{path}: {warning}")
            _print_verdicts(path, verdicts)
    if unreadable:
        raise SystemExit(BAD_INPUT)
    if any(verdict.failed for _, _, verdicts in checked for verdict in verdicts):
        raise SystemExit(BROKEN)


def _print_verdicts(path: Path, verdicts: list[Verdict]) -> None:
    from rich.markup import escape
    from rich.table import Table

    table = Table(
        "invariant", right("worst"), right("bound"), "relative to", "where", "verdict",
        title=escape(str(path)), title_justify="left", title_style="bold", box=None,
    )  # fmt: skip
    styles = {"pass": "green", "fail": "bold red", "not applicable": "dim"}
    for v in verdicts:
        table.add_row(
            v.invariant.name,
            "" if v.worst is None else f"{v.worst:.2e}",
            f"{v.bound:g}",
            v.invariant.relative_to,
            escape(v.reason or (", ".join(v.where.values()) if v.worst else "")),
            f"[{styles[v.verdict]}]{v.verdict}[/]",
        )
    new_console().print(table)


def _verdicts_as_json(path: Path, warning: str | None, verdicts: list[Verdict]) -> dict[str, Any]:
    return {
        "file": str(path),
        "warning": warning,
        "invariants": [
            {
                **{key: getattr(v.invariant, key) for key in ("name", "formula", "relative_to")},
                **{
                    key: getattr(v, key) for key in ("bound", "worst", "where", "verdict", "reason")
                },
                "worst": json_number(v.worst),
            }
            for v in verdicts
        ],
    }
