"""Every entry of every table in whole runs: radau and IDA agree, energy holds, no adhesive forces.

Laws, loads and supports are the kernel's tables, so that new entries are included automatically:
their parameters are drawn, or a sample is required. Lanes and single states are compared in
tests/laws and tests/gearbox/lanes. Rigid contact is not a force law: radau rejects it, and only
IDA is available for comparison; it is combined with every load, support and friction law here.
"""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from evolvent import check_history
from kernel.kernel import CONTACT, DAMPING, FRICTION, Kernel
from load_samples import SAMPLES, SUPPORTS
from system.cases import rigid
from system.pushing_cases import DEVIATIONS, pushing_case
from system.test_integrators import IDA, RADAU, TIGHT, error
from system.test_loads import loaded

PLAIN = ("none", "none", "johnson", "linear", "coulomb")  # entries while another table is tested
DURATION = "simulation.duration=1e-3"


def names(kernel: Kernel, family: int) -> list[str]:
    return [info.name for info in kernel.laws(family)]


def row(**entries: str) -> tuple[str, ...]:
    """Entries of a pair of gears, default except for those named."""
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


def check_rigid(runs, case: dict[str, Any], *settings: str, what: object = "") -> None:
    """By IDA alone, against a smaller tolerance; no failure, and the flanks make contact."""
    run = runs(rigid(case), IDA, "simulation.tolerance=1e-9", *settings)
    exact = runs(rigid(case), IDA, "simulation.tolerance=1e-11", *settings)
    assert run.exit_code == exact.exit_code == 0, (what, run.messages)
    assert [v.invariant.name for v in check_history(run.history) if v.failed] == [], what
    assert float(run.history["normal_force"].max()) > 0, what
    speeds = [at.history["angular_velocity"].values for at in (run, exact)]
    assert np.max(np.abs(speeds[0] - speeds[1])) <= 1e-5 * np.max(np.abs(speeds[1])), what


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


@pytest.mark.parametrize("name", SAMPLES)
def test_every_load_on_rigid_contact(runs, name: str) -> None:
    check_rigid(runs, loaded(name), "simulation.duration=0.05")


@pytest.mark.parametrize("name", SUPPORTS)
def test_every_support_of_rigid_contact(runs, name: str) -> None:
    case = loaded("torque")
    case["wheels"][1]["support"] = dict(SUPPORTS[name])
    # scale of energies: from rest it would initially be less than IDA's error
    speeds = {"pinion": -3.0, "gear": 2.0}
    case["simulation"]["initial"] = {"kind": "speeds", "speeds": speeds}
    check_rigid(runs, case, "simulation.duration=0.02")


def test_every_friction_law_on_rigid_contact(runs, kernel: Kernel) -> None:
    """Local laws are errors: their coefficient depends on the force, a multiplier here."""
    local = [law.name for law in kernel.laws(FRICTION) if law.text.startswith("local ")]
    assert local == ["benedict_kelley", "xu_kahraman"]
    for seed, name in enumerate(names(kernel, FRICTION)):
        if name not in local:
            case = pushing_case(kernel, row(friction=name), seed)
            check_rigid(runs, case, DURATION, what=name)
