"""The restitution that docs/reference/laws.md tabulates is the one that the equation gives."""

from __future__ import annotations

from pathlib import Path

from restitution import table

LAWS = Path(__file__).resolve().parents[2] / "docs/reference/laws.md"


def test_the_table_of_nominal_and_real_restitution_is_that_of_the_equation() -> None:
    assert f"\n{table()}\n" in LAWS.read_text(encoding="utf-8")
