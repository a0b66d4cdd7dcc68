"""Every entry of every table in whole runs: radau and IDA agree, energy holds, no pair pulls.

Laws, loads and supports are the kernel's tables, so that an entry that is new takes part at once:
its parameters are drawn, or a sample is asked for. Lanes and single states are compared in
tests/laws and tests/gearbox/lanes.
"""

from __future__ import annotations

from typing import Any

import pytest

from evolvent import check_history
from kernel.kernel import CONTACT, DAMPING, FRICTION, Kernel
from load_samples import SAMPLES, SUPPORTS
from system.pushing_cases import DEVIATIONS, pushing_case
from system.test_integrators import IDA, RADAU, TIGHT, error
from system.test_loads import loaded

PLAIN = ("none", "none", "johnson", "linear", "coulomb")  # entries where another table is tried
DURATION = "simulation.duration=1e-3"


def names(kernel: Kernel, family: int) -> list[str]:
    return [info.name for info in kernel.laws(family)]


def row(**entries: str) -> tuple[str, ...]:
    """Entries of a pair of real gears, plain but for those named."""
    factors = ("pinion", "gear", "contact", "damping", "friction")
    plain = dict(zip(factors, PLAIN, strict=True)) | entries
    return (*(plain[factor] for factor in factors), "radau", "drive")


def check_case(runs, case: dict[str, Any], *settings: str, what: object = "") -> None:
    radau = runs(case, RADAU, "simulation.tolerance=1e-10", *settings)
    ida = runs(case, IDA, "simulation.tolerance=1e-10", *settings)
    exact = runs(case, RADAU, TIGHT, *settings)
    for run in (radau, ida, exact):
        assert run.exit_code == 0, (what, run.messages)
        verdicts = {verdict.invariant.name: verdict for verdict in check_history(run.history)}
        assert {"energy balance", "pushing", "contact modes"} <= set(verdicts)
        assert [name for name, verdict in verdicts.items() if verdict.failed] == [], what
    assert error(ida, exact) <= 1e-5, what
    assert error(radau, exact) <= 1e-6, what


@pytest.fixture(scope="session")
def laws(kernel: Kernel) -> list[tuple[str, str]]:
    """All compliant laws of the three families."""
    families = (("contact", CONTACT), ("damping", DAMPING), ("friction", FRICTION))
    table = [(family, name) for family, number in families for name in names(kernel, number)]
    return [entry for entry in table if entry != ("contact", "rigid")]


def test_every_force_law(runs, kernel: Kernel, laws) -> None:
    for seed, (family, name) in enumerate(laws):
        case = pushing_case(kernel, row(**{family: name}), seed)
        check_case(runs, case, DURATION, what=(family, name))


@pytest.mark.parametrize("deviation", DEVIATIONS)
@pytest.mark.parametrize("wheel", ["pinion", "gear"])
def test_every_deviation(runs, kernel: Kernel, wheel: str, deviation: str) -> None:
    case = pushing_case(kernel, row(**{wheel: deviation}), DEVIATIONS.index(deviation))
    check_case(runs, case, DURATION)


@pytest.mark.parametrize("name", SAMPLES)
def test_every_load(runs, name: str) -> None:
    check_case(runs, loaded(name), "simulation.duration=0.05")


@pytest.mark.parametrize("wheel", [0, 1], ids=["driving", "driven"])
@pytest.mark.parametrize("name", SUPPORTS)
def test_every_support(runs, name: str, wheel: int) -> None:
    case = loaded("torque")
    case["wheels"][wheel]["support"] = dict(SUPPORTS[name])
    check_case(runs, case, "simulation.duration=0.02")
