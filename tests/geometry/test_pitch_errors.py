"""Pitch errors from a flank tolerance class: the standard's numbers, the generator's promises."""

from __future__ import annotations

from collections.abc import Iterator
from decimal import ROUND_HALF_UP, Decimal, getcontext

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from kernel.deviations import (
    Profile,
    deviation_at,
    deviations,
    pitch_error_sequence,
    pitch_tolerances,
)
from kernel.kernel import INVALID_INPUT, Kernel, KernelError

MASK = 2**64 - 1


@pytest.mark.parametrize(
    ("teeth", "module", "accuracy_class", "single", "total"),
    [
        # by hand, um: 0.06 + 1.2 + 5 = 6.26 -> 6.5; 0.12 + 4.2603 + 2.1 + 12 = 18.4803 -> 18
        (20, 3e-3, 5, 6.5, 18),
        # sqrt(2) times: 8.853 -> 9; 26.135 -> 26
        (20, 3e-3, 6, 9, 26),
        # 2^(-2) times: 1.565 -> 1.6; 4.6201 -> 4.6
        (20, 3e-3, 1, 1.6, 4.6),
        # 8 times: 50.08 -> 50; 147.84 -> 148
        (20, 3e-3, 11, 50, 148),
        # d = 1000, m = 10: 1 + 4 + 5 = 10 -> 10; 2 + 17.3925 + 7 + 12 = 38.3925 -> 38
        (100, 10e-3, 5, 10, 38),
        # class 4, 1/sqrt(2) times: 7.0711 -> 7; 27.148 -> 27
        (100, 10e-3, 4, 7, 27),
        # class 3, half: 5 -> 5; 19.196 -> 19
        (100, 10e-3, 3, 5, 19),
        # the smallest module, m = 0.5, d = 10: 5.21 -> 5; 0.02 + 1.7393 + 0.35 + 12 = 14.1093 -> 14
        (20, 0.5e-3, 5, 5, 14),
        # the largest wheel, m = 60, d = 15000: 44 -> 44; 30 + 67.3610 + 42 + 12 = 151.361 -> 151
        (250, 60e-3, 5, 44, 151),
    ],
)
def test_tolerances_are_those_of_iso_1328_1_of_2013(
    kernel: Kernel, teeth: int, module: float, accuracy_class: int, single: float, total: float
):
    found = pitch_tolerances(kernel, teeth, module, accuracy_class)
    assert found == pytest.approx((single * 1e-6, total * 1e-6), rel=1e-15)


def test_tolerances_are_rounded_as_the_standard_says(kernel: Kernel):
    """Against decimal arithmetic with 40 digits over the whole range of the formulas."""
    getcontext().prec = 40
    random = np.random.default_rng(3)
    for _ in range(300):
        teeth = int(random.integers(5, 1001))
        m = Decimal(int(random.integers(50, min(7000, 1500000 // teeth)))) / 100
        if not 5 <= teeth * m <= 15000:
            continue
        accuracy_class = int(random.integers(1, 12))
        d = teeth * m
        step = Decimal(2).sqrt() ** (accuracy_class - 5)
        exact = (
            (d / 1000 + m * 4 / 10 + 5) * step,
            (d / 500 + Decimal("0.55") * d.sqrt() + m * 7 / 10 + 12) * step,
        )
        found = pitch_tolerances(kernel, teeth, float(m) * 1e-3, accuracy_class)
        for value, tolerance in zip(exact, found, strict=True):
            unit = Decimal("1") if value > 10 else Decimal("0.5") if value >= 5 else Decimal("0.1")
            rounded = (value / unit).quantize(Decimal(1), rounding=ROUND_HALF_UP) * unit
            near_tie = abs((value / unit) % 1 - Decimal("0.5")) < Decimal("1e-9")
            assert near_tie or tolerance == pytest.approx(float(rounded) * 1e-6, rel=1e-14)


@pytest.mark.parametrize(
    ("teeth", "module", "accuracy_class", "words"),
    [
        (20, 3e-3, 0, "class 0 must be from 1 to 11"),
        (20, 3e-3, 12, "class 12"),
        (4, 3e-3, 5, "5 to 1000 teeth, not for 4"),
        (1001, 3e-3, 5, "not for 1001"),
        (20, 0.4e-3, 5, "not for 4E-04 m"),
        (20, 71e-3, 5, "not for 0.071 m"),
        (8, 0.6e-3, 5, "diameters of 0.005 to 15 m, not for 0.0048 m"),
        (300, 60e-3, 5, "not for 18 m"),
        (251, 60e-3, 5, "not for 15.06 m"),
        (20, np.nan, 5, "modules"),
    ],
)
def test_the_formulas_are_not_used_beyond_their_range(
    kernel: Kernel, teeth: int, module: float, accuracy_class: int, words: str
):
    with pytest.raises(KernelError) as caught:
        pitch_tolerances(kernel, teeth, module, accuracy_class)
    assert caught.value.code == INVALID_INPUT
    assert words in caught.value.message


def splitmix64(seed: int) -> Iterator[int]:
    """Random 64-bit numbers; written from the published algorithm."""
    state = seed
    while True:
        state = (state + 0x9E3779B97F4A7C15) & MASK
        z = state
        z = ((z ^ (z >> 30)) * 0xBF58476D1CE4E5B9) & MASK
        z = ((z ^ (z >> 27)) * 0x94D049BB133111EB) & MASK
        yield z ^ (z >> 31)


def uniform(seed: int, n: int) -> np.ndarray:
    random = splitmix64(seed)
    return np.array([(next(random) >> 11) * 2.0**-53 for _ in range(n)])


def wave_and_noise(seed: int, teeth: int) -> tuple[np.ndarray, np.ndarray]:
    u = uniform(seed, teeth + 1)
    return np.sin(2 * np.pi * (np.arange(teeth) / teeth + u[0])), 2 * u[1:] - 1


def test_the_reference_generator_gives_the_published_numbers():
    """First outputs of splitmix64.c for the seed 1234567, as its ports print them."""
    random = splitmix64(1234567)
    assert [next(random) for _ in range(5)] == [
        6457827717110365317,
        3203168211198807973,
        9817491932198370423,
        4593380528125082431,
        16408922859458223821,
    ]


def single_pitch(errors: np.ndarray) -> float:
    return float(np.abs(errors - np.roll(errors, 1)).max())


@pytest.mark.parametrize(("teeth", "seed"), [(20, 0), (23, 1), (101, 2**31 - 1), (37, 1234567)])
def test_the_sequence_is_a_wave_and_noise_from_splitmix64(kernel: Kernel, teeth: int, seed: int):
    """Wave and noise from an independent generator span the sequence, less its mean."""
    wave, noise = wave_and_noise(seed, teeth)
    basis = np.column_stack([wave - wave.mean(), noise - noise.mean()])
    errors = pitch_error_sequence(kernel, teeth, 9e-6, 26e-6, seed)
    shares, *_ = np.linalg.lstsq(basis, errors, rcond=None)
    np.testing.assert_allclose(basis @ shares, errors, atol=1e-13 * 26e-6)
    assert (shares > 0).all()


@settings(max_examples=100, deadline=None)
@given(
    teeth=st.integers(5, 1000),
    accuracy_class=st.integers(1, 11),
    module=st.floats(1.1e-3, 15e-3),
    seed=st.integers(0, 2**31 - 1),
)
def test_a_sequence_keeps_both_tolerances_and_meets_one(
    kernel: Kernel, teeth: int, accuracy_class: int, module: float, seed: int
):
    """It meets both if F_pT/f_pT lies between the ratios of the noise and of the wave, as with most
    wheels of more than ten teeth.
    """
    single, total = pitch_tolerances(kernel, teeth, module, accuracy_class)
    errors = pitch_error_sequence(kernel, teeth, single, total, seed)
    used = np.array([single_pitch(errors) / single, np.ptp(errors) / total])
    assert used.max() == pytest.approx(1, abs=1e-12)
    most, least = (np.ptp(x) / single_pitch(x) for x in wave_and_noise(seed, teeth))
    if least < total / single < most:
        assert used.min() == pytest.approx(1, abs=1e-9)
    assert errors.mean() == pytest.approx(0, abs=1e-14 * total)


def test_equal_seeds_give_equal_errors_and_others_do_not(kernel: Kernel):
    one, again, other = (pitch_error_sequence(kernel, 31, 9e-6, 26e-6, seed) for seed in (5, 5, 6))
    np.testing.assert_array_equal(one, again)
    assert np.abs(one - other).max() > 1e-6


def test_an_accuracy_class_gives_a_wheel_the_errors_of_its_sequence(kernel: Kernel):
    teeth, module, alpha = 20, 3e-3, np.radians(20)
    radius = teeth * module / 2
    profile = Profile(teeth, radius * np.cos(alpha), radius, 0.0042, 0.017, 0.2)
    single, total = pitch_tolerances(kernel, teeth, module, 7)
    arcs = pitch_error_sequence(kernel, teeth, single, total, 11)
    given = deviations(accuracy_class=7, seed=11)
    e = deviation_at(kernel, given, profile, 0.01, np.arange(teeth), -1).e
    np.testing.assert_allclose(e, -arcs * np.cos(alpha), rtol=1e-13, atol=1e-20)
