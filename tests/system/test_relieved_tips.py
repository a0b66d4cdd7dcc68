"""Random pairs with reliefs, crowning and rounded tips pass all zone limits of their flanks.

The zone limits of a flank are the ends of the relief corners, the end of the flank and the start of
the tip corner. They may coincide: a linear relief can be shorter than its rounded corner, and tip
and root relief can start at the same diameter. A pair that passes such limits, in either direction,
must not be treated as one with a missed event.

``pytest tests/system/test_relieved_tips.py --long`` runs 300 pairs, without it 24.
"""

from __future__ import annotations

import json
import subprocess
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
import xarray as xr

from system.bending_pairs import BendingPair, Block, Wheel
from system.random_sets import seeds
from system.refusals import OF_A_PAIR
from system.test_bending_pairs import CODES

Evolvent = Callable[..., subprocess.CompletedProcess[str]]

SHORT, LONG = 12, 300
MISSED = "an event was missed"


class RelievedPair(BendingPair):
    """A random pair whose flanks have short and long reliefs, crowning and roundings."""

    def __init__(self, seed: int) -> None:
        super().__init__(8 * (seed // 7) + seed % 7)  # none of those drawn without restrictions

    def reliefs(self, wheel: Wheel) -> Block:
        """Tip and root relief: linear or parabolic, from shallow to steep."""
        tip = self.module * (wheel.teeth + 2 + 2 * wheel.shift)
        fields: Block = {}
        for end, likely, depths in (("tip", 0.8, (0.1, 1.2)), ("root", 0.4, (0.8, 1.5))):
            if self.chance(likely):
                fields[f"{end}_relief"] = {
                    "amount": self.log(1e-3, 3e-2) * self.module,
                    "diameter": tip - 2 * self.draw.uniform(*depths) * self.module,
                    "shape": self.draw.choice(("linear", "linear", "parabolic")),
                }
        if len(fields) == 2:  # the reliefs must not overlap; every fourth pair has a common limit
            both = sorted(relief["diameter"] for relief in fields.values())
            joined = self.chance(0.25)
            fields["root_relief"]["diameter"] = both[0]
            fields["tip_relief"]["diameter"] = both[0] if joined else both[1]
        return fields

    def deviations(self, i: int) -> Block:
        wheel = self.wheels[i]
        fields = self.reliefs(wheel)
        if self.chance(0.3):
            fields["profile_crowning"] = self.log(1e-4, 5e-3) * self.module
        if self.chance(0.7):
            fields["tip_rounding"] = self.log(5e-3, 0.15) * self.module
        if self.errors == i:
            fields["eccentricity"] = {"amount": self.log(1e-4, 3e-3) * self.module}
        return fields


def run(evolvent: Evolvent, case: Block, folder: Path, integrator: str) -> xr.Dataset | None:
    """Run a case; None if it is rejected, or ends, for a permitted reason."""
    case["simulation"]["integrator"] = integrator
    file, result = folder / "case.yaml", folder / f"{integrator}.h5"
    file.write_text(json.dumps(case))
    done = evolvent("run", file, "-o", result)
    if done.returncode == 0:
        with xr.open_dataset(result, engine="netcdf4") as opened:
            return opened.load()
    last = done.stderr.splitlines()[-1]
    assert MISSED not in last, last
    assert done.returncode in CODES, done.stderr
    assert any(words in last for words in OF_A_PAIR), last
    return None


@pytest.mark.parametrize("integrator", ["radau", "ida"])
@pytest.mark.parametrize("seed", seeds(range(SHORT), LONG))
def test_a_relieved_pair_passes_the_borders_of_its_flanks(
    evolvent: Evolvent, tmp_path: Path, seed: int, integrator: str
) -> None:
    """No event is missed, and the energy of the undamped pair is conserved."""
    case = RelievedPair(seed).case()
    case["simulation"]["tolerance"] = 1e-9
    history = run(evolvent, case, tmp_path, integrator)
    if history is None:
        return
    energy = history.kinetic_energy + history.potential_energy + history.dissipated_energy
    spread = np.ptp((energy - history.load_work).values)
    rounding = 1e-13 * float(history.kinetic_energy.max())
    assert spread <= 1e-4 * float(history.potential_energy.max()) + rounding
    assert history.attrs["invariants"] == "held"
