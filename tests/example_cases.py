"""Example cases, and plans of sweeps, which refer to the case that they vary."""

from __future__ import annotations

from pathlib import Path

EXAMPLES = sorted((Path(__file__).resolve().parents[1] / "examples").glob("*.yaml"))
PLANS = [path for path in EXAMPLES if "\ncase:" in path.read_text()]
CASES = [path for path in EXAMPLES if path not in PLANS]
