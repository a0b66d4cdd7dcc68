"""Every law of the table gives for eight states at once what it gives for each alone, to the bit.

The laws and the ranges of their parameters are those of the table, so a law that is entered there
takes part at once. A law's loop and the way of a law that has none are asked for the same.
"""

from __future__ import annotations

import ctypes
from collections.abc import Iterator

import numpy as np
import pytest

from kernel.kernel import (
    CONTACT,
    DAMPING,
    FRICTION,
    ContactContext,
    Floats,
    Kernel,
    KernelError,
    Kind,
    LawChoice,
    _at,
    _contexts,
)

LANES = 8
STATES = 60  # times eight, of each law
SPRING = 1e7  # stiffness of the contact that damping laws are asked in [N/m]


def drawn(kernel: Kernel, family: int, info: Kind, random: np.random.Generator) -> LawChoice:
    """Choose a law with parameters anywhere in their ranges, or over six decades."""
    while True:
        values = {}
        for parameter in info.rows:
            low = parameter.minimum if np.isfinite(parameter.minimum) else 0.0
            span = parameter.maximum - low
            step = random.uniform(0, span) if np.isfinite(span) else 10 ** random.uniform(-3, 3)
            values[parameter.key] = low + step
        choice = kernel.law(family, info.name, **values)
        try:
            kernel.law_validate(family, choice)
        except KernelError:
            continue  # some parameters bound each other
        return choice


def scattered(random: np.random.Generator, low: float, high: float) -> Floats:
    """Eight numbers of either sign whose sizes are powers of ten between the two, one of them 0."""
    numbers = random.choice([-1.0, 1.0], LANES) * 10 ** random.uniform(low, high, LANES)
    numbers[random.integers(LANES)] = 0.0
    return numbers


def cases(
    kernel: Kernel, family: int
) -> Iterator[tuple[str, LawChoice, dict[str, Floats], np.random.Generator]]:
    """All laws of a family in many states: name, choice, fields of eight contexts."""
    random = np.random.default_rng(7)
    for info in kernel.laws(family):
        for turn in range(STATES):
            rho_a, rho_b = 10 ** random.uniform(-3, 0, (2, LANES))
            if turn % 10 == 9:
                rho_a[random.integers(LANES)] = -2.0
            fields = {
                "h": scattered(random, -12, -4 if turn % 3 else 0),
                "h_dot": scattered(random, -9, 1),
                **{"rho_a": rho_a, "rho_b": rho_b},
                "e_star": np.full(LANES, 1.15e11),
                "width": np.full(LANES, 0.02),
                "v0": np.full(LANES, 10 ** random.uniform(-6, 0)),
            }
            yield info.name, drawn(kernel, family, info, random), fields, random


def contexts_of(fields: dict[str, Floats]) -> ctypes.Array[ContactContext]:
    """Eight contexts as C has them."""
    return _contexts(dict(fields))[1]


@pytest.mark.parametrize("bare", [0, 1], ids=["by its loop", "without a loop"])
def test_every_elastic_law_gives_in_lanes_what_it_gives_alone(kernel: Kernel, bare: int):
    """The force and what enters the energy; and whether it has an answer in all of the states."""
    answers = dict.fromkeys((info.name for info in kernel.laws(CONTACT)), 0)
    for name, law, fields, _ in cases(kernel, CONTACT):
        force, d_energy, excess = np.full((3, LANES), np.nan)
        is_defined = kernel.library.lanes_elastic(
            ctypes.byref(law), contexts_of(fields), bare, *map(_at, (force, d_energy, excess))
        )
        alone = kernel.law_elastic_force(law, **fields)
        energy = kernel.law_elastic_potential(law, **fields)
        assert is_defined == (not alone.code.any()), name
        answers[name] += is_defined
        if is_defined:
            np.testing.assert_array_equal(force, alone.force, err_msg=name)
            np.testing.assert_array_equal(d_energy, energy.d_length, err_msg=name)
            np.testing.assert_array_equal(force + excess, energy.d_h, err_msg=name)
    assert answers.pop("rigid") == 0  # it has no force
    assert min(answers.values()) > STATES / 2


@pytest.mark.parametrize("bare", [0, 1], ids=["by its loop", "without a loop"])
def test_every_damping_law_gives_in_lanes_what_it_gives_alone(kernel: Kernel, bare: int):
    """On the side that the rate of each state says."""
    spring = kernel.law(CONTACT, "linear", stiffness=SPRING)
    for name, law, fields, _ in cases(kernel, DAMPING):
        force, elastic = np.full(LANES, np.nan), SPRING * fields["h"]
        kernel.library.lanes_damping(
            ctypes.byref(law), contexts_of(fields), 0, bare, _at(elastic), _at(force)
        )
        if name == "ratio":  # acts as another law; itself it has no force
            expected = np.zeros(LANES)
        else:
            expected = kernel.law_viscous_force(spring, law, **fields).force
        np.testing.assert_array_equal(force, expected, err_msg=name)


@pytest.mark.parametrize("side", [-1, 1])
def test_every_damping_law_gives_the_same_by_its_loop_and_without_on_either_side(
    kernel: Kernel, side: int
):
    """The side is that of the discrete state, whatever the rates of trial states say."""
    for name, law, fields, random in cases(kernel, DAMPING):
        forces, elastic = np.full((2, LANES), np.nan), scattered(random, -3, 5)
        for bare in (0, 1):
            kernel.library.lanes_damping(
                ctypes.byref(law), contexts_of(fields), side, bare, _at(elastic), _at(forces[bare])
            )
        assert np.all(np.isfinite(forces)), name
        np.testing.assert_array_equal(*forces, err_msg=name)


@pytest.mark.parametrize("bare", [0, 1], ids=["by its loop", "without a loop"])
@pytest.mark.parametrize("side", [-1, 1], ids=["separation", "approach"])
def test_one_sided_damping_acts_where_the_discrete_state_says_approach(
    kernel: Kernel, side: int, bare: int
):
    """C kappa kappa' on that side, also of rates that have left it, and 0 on the other."""
    law = kernel.law(DAMPING, "one_sided", coefficient=5e9)
    fields = {
        "h": np.repeat([1e-9, 2e-6], LANES // 2),
        "h_dot": np.tile([-0.2, 0.0, 1e-6, 3.0], 2),
        **{"rho_a": np.full(LANES, 0.1), "rho_b": np.full(LANES, 0.2)},
        **{"e_star": np.full(LANES, 1.15e11), "width": np.full(LANES, 0.02), "v0": np.ones(LANES)},
    }
    force = np.full(LANES, np.nan)
    kernel.library.lanes_damping(
        ctypes.byref(law), contexts_of(fields), side, bare, _at(SPRING * fields["h"]), _at(force)
    )
    expected = 5e9 * fields["h"] * fields["h_dot"] if side > 0 else np.zeros(LANES)
    np.testing.assert_allclose(force, expected, rtol=4e-16)


@pytest.mark.parametrize("bare", [0, 1], ids=["by its loop", "without a loop"])
def test_every_friction_law_gives_in_lanes_what_it_gives_alone(kernel: Kernel, bare: int):
    """On each branch, also where the sliding velocity has left it."""
    for name, law, _, random in cases(kernel, FRICTION):
        if name in {"benedict_kelley", "xu_kahraman"}:
            continue  # local: test_local_friction.py
        v_t = scattered(random, -9, 2)
        for branch in (-1, 0, 1):
            factor = np.full(LANES, np.nan)
            kernel.library.lanes_friction(ctypes.byref(law), branch, _at(v_t), bare, _at(factor))
            expected, _ = kernel.law_friction_factor(law, np.full(LANES, branch), v_t)
            np.testing.assert_array_equal(factor, expected, err_msg=name)
