"""What a run says of its own invariants is what the check says: one set of scales and bounds."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from evolvent import check_history
from evolvent.physics.invariants import INVARIANTS
from system.runs import FRICTION, RIGID, TRACKINGS, Runs, tracking

WATCHED = (
    *("gradient ratio", "transmission error", "points on flanks", "points on line of action"),
    *("rigid gap", "energy balance"),
)
SOURCE = Path(__file__).parents[2] / "driver" / "simulate" / "invariant_watch.c"


def test_both_have_the_same_bounds() -> None:
    """The table in driver/simulate/invariant_watch.c against that of the package."""
    rows = re.findall(r'\] = \{"([^"]+)", ([0-9.e-]+), ([0-9.e-]+)\}', SOURCE.read_text())
    watched = {name: (float(least), float(tolerances)) for name, least, tolerances in rows}
    assert set(watched) == set(WATCHED)
    for invariant in INVARIANTS:
        if invariant.name in watched:
            assert (invariant.least_bound, invariant.tolerances) == watched[invariant.name]


@pytest.mark.parametrize("tolerance", ["1e-3", "1e-5", "1e-9"])
@pytest.mark.parametrize("contact", [(), RIGID], ids=["elastic", "rigid"])
@pytest.mark.parametrize("kind", TRACKINGS)
def test_a_run_and_the_check_agree(
    runs: Runs, kind: str, contact: tuple[str, ...], tolerance: str
) -> None:
    run = runs(FRICTION, tracking(kind), *contact, f"simulation.tolerance={tolerance}")
    said = run.history.attrs["invariants"]
    verdicts = check_history(run.history)
    failed = [v.invariant.name for v in verdicts if v.failed and v.invariant.name in WATCHED]
    assert (said == "held") == (not failed)
    assert all(name in said for name in failed)
    assert ("own invariants are broken" in run.messages.splitlines()[-1]) == bool(failed)
    assert [v.invariant.name for v in verdicts if v.failed] == failed  # the rest hold
