"""What a flank lacks in material: against mpmath, at borders, against displaced involutes."""

from __future__ import annotations

import mpmath as mp
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from kernel.description import Block
from kernel.deviations import (
    LINEAR,
    NONE,
    PARABOLIC,
    ROOT,
    TIP,
    Formula,
    Profile,
    deviation_at,
    deviations,
    relief,
)
from kernel.kernel import INVALID_INPUT, Kernel, KernelError

# z = 20, m = 3 mm, 20 deg, active profile from 57 to 66 mm
R_B = 0.03 * np.cos(np.radians(20))
PROFILE = Profile(
    teeth=20,
    base_radius=R_B,
    reference_radius=0.03,
    rho_start=np.sqrt(0.0285**2 - R_B**2),
    rho_tip=np.sqrt(0.033**2 - R_B**2),
    tooth_angle=np.pi / 20 + 2 * (np.tan(np.radians(20)) - np.radians(20)),
)
PITCH = [1e-6 * (7 * k % 20 - 9) for k in range(20)]
ALL = {
    "tip_relief": relief(20e-6, diameter=0.0635, shape=PARABOLIC),
    "root_relief": relief(12e-6, roll_angle=np.radians(14.0)),
    "profile_crowning": 4e-6,
    "pitch_errors": PITCH,
    "runout_amount": 15e-6,
    "runout_phase": 0.7,
}
CASES = {
    "tip relief, linear": {"tip_relief": relief(20e-6, roll_angle=0.5)},
    "tip relief, parabolic": {"tip_relief": ALL["tip_relief"]},
    "root relief, linear": {"root_relief": ALL["root_relief"]},
    "root relief, parabolic": {"root_relief": relief(8e-6, diameter=0.0575, shape=PARABOLIC)},
    "crowning": {"profile_crowning": 4e-6},
    "pitch errors": {"pitch_errors": PITCH},
    "runout": {"runout_amount": 15e-6, "runout_phase": -2.0},
    "all": ALL,
}
AMOUNT = 60e-6  # more than any sum of the amounts above
ROUNDING = 1e-14  # a few dozen operations on doubles


@pytest.mark.parametrize("name", CASES)
def test_deviation_and_its_derivatives_are_the_formula(kernel: Kernel, name: str):
    """Against mpmath with 40 digits, on every branch, also continued beyond its border.

    An error is measured by the amount, over the shortest length in the formula for each derivative.
    """
    description = deviations(**CASES[name])
    formula = Formula(description, PROFILE)
    shortest = 0.003  # of relief; r_b is longer
    random = np.random.default_rng(1)
    rho = random.uniform(0.9 * PROFILE.rho_start, 1.05 * PROFILE.rho_tip, 60)
    tooth, side = random.integers(-45, 45, 60), random.choice([-1, 1], 60)
    zone = random.integers(-1, 2, 60)
    result = deviation_at(kernel, description, PROFILE, rho, tooth, side, zone)
    with mp.workdps(40):
        for i in range(60):
            where = int(tooth[i]), int(side[i]), int(zone[i])
            expected = mp.taylor(lambda x, at=where: formula.e(x, *at), mp.mpf(rho[i]), 2)
            e, de, d2e = expected[0], expected[1], 2 * expected[2]
            assert float(result.e[i]) == pytest.approx(float(e), abs=ROUNDING * AMOUNT)
            assert float(result.de[i]) == pytest.approx(float(de), abs=ROUNDING * AMOUNT / shortest)
            assert float(result.d2e[i]) == pytest.approx(
                float(d2e), abs=ROUNDING * AMOUNT / shortest**2
            )


def test_a_perfect_wheel_has_no_deviation_and_no_borders(kernel: Kernel):
    rho = np.linspace(PROFILE.rho_start, PROFILE.rho_tip, 9)
    result = deviation_at(kernel, deviations(), PROFILE, rho, 3, -1)
    for values in result[:3]:
        np.testing.assert_array_equal(values, 0)
    huge = np.finfo(float).max
    np.testing.assert_array_equal(result.borders, [-huge, huge])


def test_relief_reaches_its_amount_at_the_end_of_the_profile_and_crowning_at_both(kernel: Kernel):
    ends = [PROFILE.rho_start, (PROFILE.rho_start + PROFILE.rho_tip) / 2, PROFILE.rho_tip]
    for name, expected in {
        "tip relief, linear": [0, 0, 20e-6],
        "tip relief, parabolic": [0, 0, 20e-6],
        "root relief, linear": [12e-6, 0, 0],
        "root relief, parabolic": [8e-6, 0, 0],
        "crowning": [4e-6, 0, 4e-6],
    }.items():
        result = deviation_at(kernel, deviations(**CASES[name]), PROFILE, ends)
        np.testing.assert_allclose(result.e, expected, rtol=ROUNDING, atol=ROUNDING * AMOUNT)


@pytest.mark.parametrize(("shape", "slope_jumps"), [(LINEAR, True), (PARABOLIC, False)])
def test_relief_is_continuous_at_its_border_and_a_parabolic_one_has_no_kink(
    kernel: Kernel, shape: str, slope_jumps: bool
):
    description = deviations(
        tip_relief=relief(20e-6, roll_angle=0.5, shape=shape),
        root_relief=relief(12e-6, roll_angle=0.3, shape=shape),
    )
    borders = deviation_at(kernel, description, PROFILE, 0.01).borders
    np.testing.assert_allclose(borders, np.array([0.3, 0.5]) * PROFILE.base_radius, rtol=1e-15)
    for border, zone in zip(borders, (ROOT, TIP), strict=True):
        inside = deviation_at(kernel, description, PROFILE, border, zones=NONE)
        beyond = deviation_at(kernel, description, PROFILE, border, zones=zone)
        assert beyond.e[0] == inside.e[0] == 0
        assert (beyond.de[0] != inside.de[0]) == slope_jumps
        assert np.sign(beyond.de[0]) == zone * slope_jumps  # material goes towards the end


def test_the_zone_that_holds_is_that_of_the_borders(kernel: Kernel):
    description = deviations(**ALL)
    low, high = deviation_at(kernel, description, PROFILE, 0.01).borders
    rho = np.array([low, high])
    around = np.concatenate([np.nextafter(rho, 0), rho, np.nextafter(rho, 1)])
    zones = np.array([ROOT, NONE, NONE, NONE, NONE, TIP])
    found = deviation_at(kernel, description, PROFILE, around)
    held = deviation_at(kernel, description, PROFILE, around, zones=zones)
    for one, other in zip(found, held, strict=True):
        np.testing.assert_array_equal(one, other)


def test_relief_and_crowning_are_alike_on_both_flanks_and_pitch_errors_opposite(kernel: Kernel):
    rho = np.linspace(PROFILE.rho_start, PROFILE.rho_tip, 7)
    for name in ("tip relief, linear", "root relief, parabolic", "crowning"):
        sides = [
            deviation_at(kernel, deviations(**CASES[name]), PROFILE, rho, 2, s).e for s in (1, -1)
        ]
        np.testing.assert_array_equal(*sides)
    errors = deviations(pitch_errors=PITCH)
    for tooth in (0, 7, -1, 20 + 7):
        arc = PITCH[tooth % 20]
        for side in (1, -1):
            e = deviation_at(kernel, errors, PROFILE, rho, tooth, side).e
            # a tooth that is displaced counterclockwise leaves room on its clockwise side
            np.testing.assert_allclose(e, side * arc * np.cos(np.radians(20)), rtol=1e-14)


def distance_along_normal(
    kernel: Kernel, rho: float, tooth: int, side: int, shift: complex
) -> float:
    """How far a displaced flank lies inside the nominal one, along the nominal normal.

    The points are those of the kernel's involute, turned to their tooth; the flank is the involute
    about the displaced centre.
    """
    r_b, teeth = PROFILE.base_radius, PROFILE.teeth
    root = np.exp(1j * (2 * np.pi * tooth / teeth - side * PROFILE.tooth_angle / 2))

    def flank(x: float) -> complex:
        x_y = kernel.involute_points(x / r_b, r_b, side)[0]
        return complex(*x_y) * root

    foot = 1j * side * root * np.exp(1j * side * rho / r_b)  # against the outward normal
    # e and the roll of the displaced flank where the normal meets it: Newton on two equations
    e, x = 0.0, rho
    for _ in range(20):
        miss = flank(x) + shift - flank(rho) - e * foot
        tangent = root * np.exp(1j * side * x / r_b) * x / r_b
        matrix = np.array([[-foot.real, tangent.real], [-foot.imag, tangent.imag]])
        de, dx = np.linalg.solve(matrix, [-miss.real, -miss.imag])
        e, x = e + de, x + dx
    return float(e)


@pytest.mark.parametrize("side", [1, -1])
def test_runout_is_the_displacement_of_the_flanks_of_an_eccentric_wheel(kernel: Kernel, side: int):
    """Geometric truth: the involutes about the displaced centre, cut with the nominal normals.

    To first order in e_c: the error is at most e_c^2/(2 rho), which curvature makes of the part of
    the displacement along the flank; 1e-15 for the differences of coordinates.
    """
    e_c, psi = 15e-6, 0.7
    description = deviations(runout_amount=e_c, runout_phase=psi)
    for tooth in (0, 3, 11, 19):
        for rho in np.linspace(PROFILE.rho_start, PROFILE.rho_tip, 5):
            truth = distance_along_normal(kernel, rho, tooth, side, e_c * np.exp(1j * psi))
            e = deviation_at(kernel, description, PROFILE, rho, tooth, side).e[0]
            assert abs(e - truth) <= 1.01 * e_c**2 / (2 * rho) + 1e-15


def test_runout_passes_from_a_tooth_to_the_next_one_pitch_on_without_a_step(kernel: Kernel):
    """It moves all flanks that touch one line of action alike: also the one a base pitch lower."""
    description = deviations(runout_amount=15e-6, runout_phase=0.7)
    pitch = 2 * np.pi * PROFILE.base_radius / PROFILE.teeth
    rho = 0.015
    for side in (1, -1):
        now = deviation_at(kernel, description, PROFILE, rho, 5, side)
        behind = deviation_at(kernel, description, PROFILE, rho - pitch, 5 + side, side)
        assert behind.e[0] == pytest.approx(now.e[0], abs=ROUNDING * 15e-6)
        assert behind.de[0] == pytest.approx(now.de[0], abs=ROUNDING * 15e-6 / 0.028)


@settings(max_examples=60, deadline=None)
@given(
    amounts=st.tuples(*[st.floats(0, 50e-6)] * 4),
    starts=st.tuples(st.floats(0.16, 0.35), st.floats(0.36, 0.6)),
    shape=st.sampled_from([LINEAR, PARABOLIC]),
    rho=st.floats(0.0043, 0.0171),
    tooth=st.integers(-10000, 10000),
    side=st.sampled_from([-1, 1]),
)
def test_derivatives_are_those_of_the_values(
    kernel: Kernel,
    amounts: tuple[float, ...],
    starts: tuple[float, float],
    shape: str,
    rho: float,
    tooth: int,
    side: int,
):
    """Central differences on one branch: error h^2 f'''/6 and rounding 1e-16 |e|/h.

    f''' is that of runout, amount/r_b^3; h = 1e-5 m.
    """
    description = deviations(
        tip_relief=relief(amounts[0], roll_angle=starts[1], shape=shape),
        root_relief=relief(amounts[1], roll_angle=starts[0], shape=shape),
        profile_crowning=amounts[2],
        runout_amount=amounts[3],
        pitch_errors=PITCH,
    )
    h = 1e-5
    low, high = deviation_at(kernel, description, PROFILE, rho).borders
    zone = ROOT if rho < low else TIP if rho > high else NONE
    result = deviation_at(kernel, description, PROFILE, [rho - h, rho, rho + h], tooth, side, zone)
    third = amounts[3] / PROFILE.base_radius**3
    tolerance = h**2 * third / 6 * 1.1 + 1e-15 * 3e-4 / h
    assert abs((result.e[2] - result.e[0]) / (2 * h) - result.de[1]) <= tolerance
    slopes = 3e-4 / 5e-4  # largest amount over the shortest relief
    tolerance = h**2 * third / PROFILE.base_radius / 6 * 1.1 + 1e-15 * slopes / h
    assert abs((result.de[2] - result.de[0]) / (2 * h) - result.d2e[1]) <= tolerance


def refusal(kernel: Kernel, description: Block) -> KernelError:
    with pytest.raises(KernelError) as caught:
        deviation_at(kernel, description, PROFILE, 0.01)
    assert caught.value.code == INVALID_INPUT
    return caught.value


@pytest.mark.parametrize(
    ("fields", "field", "words"),
    [
        ({"tip_relief": relief(-1e-6, roll_angle=0.5)}, "tip_relief.amount", "must be at least 0"),
        ({"root_relief": relief(np.nan, roll_angle=0.3)}, "root_relief.amount", "finite"),
        ({"profile_crowning": -1e-6}, "profile_crowning", "-1E-06 m"),
        ({"runout_amount": np.inf}, "eccentricity.amount", "finite"),
        ({"runout_amount": 1e-6, "runout_phase": np.nan}, "eccentricity.phase", "finite"),
        (
            {"tip_relief": relief(1e-6, diameter=0.0661)},
            "tip_relief.diameter",
            "a diameter of 0.0661 m does not start on the active profile, which goes from 0.057 m "
            "to 0.066 m",
        ),
        ({"tip_relief": relief(1e-6, diameter=0.05)}, "tip_relief.diameter", "active profile"),
        ({"tip_relief": relief(1e-6, diameter=-0.06)}, "tip_relief.diameter", "greater than 0"),
        (
            {"root_relief": relief(1e-6, roll_angle=0.1)},
            "root_relief.roll_angle",
            "a roll angle of 5.72958 deg does not start on the active profile, which goes from "
            "8.50955 deg to 34.8655 deg",
        ),
        (
            {"tip_relief": relief(1e-6, roll_angle=0.5, shape="cubic")},
            "tip_relief.shape",
            "must be one of linear parabolic, not cubic",
        ),
        (
            {
                "tip_relief": relief(1e-6, roll_angle=0.3),
                "root_relief": relief(1e-6, roll_angle=0.4),
            },
            "tip_relief",
            "must not overlap",
        ),
        ({"pitch_errors": PITCH[1:]}, "pitch_errors", "19 pitch errors are given for 20 teeth"),
        ({"pitch_errors": [*PITCH, 0.0]}, "pitch_errors", "21 pitch errors are given for 20 teeth"),
        ({"pitch_errors": [*PITCH[1:], np.nan]}, "pitch_errors", "finite"),
        ({"pitch_errors": PITCH, "accuracy_class": 6}, "accuracy", "not both"),
        ({"accuracy_class": 12}, "accuracy.class", "class = 12 must be at most 11"),
        ({"accuracy_class": -1}, "accuracy.class", "class = -1 must be at least 1"),
    ],
)
def test_senseless_deviations_are_refused_by_name(
    kernel: Kernel, fields: dict, field: str, words: str
):
    error = refusal(kernel, deviations(**fields))
    assert error.field == field
    assert words in error.message


def test_a_relief_without_amount_may_start_anywhere(kernel: Kernel):
    result = deviation_at(kernel, deviations(tip_relief=relief(0.0, diameter=1.0)), PROFILE, 0.01)
    assert result.e[0] == 0


def test_tip_and_root_relief_may_meet(kernel: Kernel):
    description = deviations(
        tip_relief=relief(1e-6, roll_angle=0.4), root_relief=relief(1e-6, roll_angle=0.4)
    )
    borders = deviation_at(kernel, description, PROFILE, 0.01).borders
    assert borders[0] == borders[1]
