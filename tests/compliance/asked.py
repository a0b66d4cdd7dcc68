"""A compliance asked by itself, and formulas and tables (`analytic_calls.f90`)."""

from __future__ import annotations

import ctypes
from dataclasses import dataclass

import numpy as np

from compliance.influence import OWN, ROUNDING, Influence
from kernel.gears import GearGeometry
from kernel.kernel import Floats, Kernel, _at, _double

LANES = 8


@dataclass
class Answers:
    """At each place c, c', c''; c_j from there to the next, with derivatives; lanes."""

    own: Floats
    coupled: Floats
    lanes: Floats


def analytic(kernel: Kernel, gear: GearGeometry, hub_radius: float) -> tuple[Floats, Floats, bool]:
    """Places, E c by formulas, and whether they were fitted there."""
    rho, c = np.empty(OWN), np.empty(OWN)
    fitted = kernel.library.test_analytic(
        ctypes.byref(gear),
        *(_double(ROUNDING), _double(hub_radius / gear.normal_module), _double(0.3)),
        *(_at(rho), _at(c)),
    )
    return rho, c, bool(fitted)


def _answers(n: int) -> Answers:
    return Answers(np.empty((n, 3)), np.empty((n, 6)), np.empty((LANES, 5)))


def ask_polynomial(
    kernel: Kernel, samples: Influence, j: int, positions: Floats, modulus: float = 1.0
) -> Answers:
    """Of samples, with a module of 1 m."""
    answers = _answers(len(positions))
    kernel.library.test_ask_polynomial(
        *(_at(samples.rho), _at(samples.own), _at(samples.samples), _double(modulus), j),
        *(
            len(positions),
            _at(positions),
            _at(answers.own),
            _at(answers.coupled),
            _at(answers.lanes),
        ),
    )
    return answers


def ask_table(
    kernel: Kernel, rho: Floats, c: Floats, following: Floats, j: int, positions: Floats
) -> Answers:
    """Of a table; an empty `following`: without c_1."""
    answers = _answers(len(positions))
    kernel.library.test_ask_table(
        *(len(rho), _at(rho), _at(c), len(following), _at(following), j),
        *(
            len(positions),
            _at(positions),
            _at(answers.own),
            _at(answers.coupled),
            _at(answers.lanes),
        ),
    )
    return answers
