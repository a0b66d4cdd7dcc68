"""Deviations of the flanks in a gearbox: each wheel gets those of its profile, or is refused."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import pytest

from kernel.description import Block
from kernel.deviations import (
    Profile,
    deviation_at,
    deviations,
    pitch_error_sequence,
    pitch_tolerances,
    relief,
)
from kernel.gearbox import MESH, OF_DEVIATION, WHEEL, Gearbox, GearboxError
from kernel.gearbox_description import (
    ALGEBRAIC,
    DIFFERENTIAL,
    TORQUE,
    load,
    mesh,
    wheel,
)
from kernel.gears import gear_description
from kernel.kernel import CONTACT, INVALID_INPUT, Floats, Kernel, _at

MODULE, ALPHA = 3e-3, np.radians(20)
TEETH = (20, 35, 26)


def gear(teeth: int, deviation: Block | None = None, **fields: object) -> Block:
    """Gear of the standard rack without profile shift."""
    form = gear_description(MODULE)
    return wheel(teeth=teeth, width=0.02, gear=form, deviation=deviation or deviations(), **fields)


def real_mesh(kernel: Kernel, driving: int, driven: int, **fields: object) -> Block:
    """Mesh of two gears at the centre distance of their profile shifts."""
    description = mesh(kernel, driving, driven, **fields)
    description.pop("pressure_angle")
    return description


def train(kernel: Kernel, given: Sequence[Block | None], **fields: object) -> Gearbox:
    """Three gears in a row, the second one idle; fields of the first mesh."""
    wheels = [gear(z, d) for z, d in zip(TEETH, given, strict=True)]
    wheels[0].centre = (0.0, 0.0)
    meshes = [
        real_mesh(kernel, 0, 1, **fields),
        real_mesh(kernel, 1, 2, driving_rotation=1, centre_line_angle=0.5),
    ]
    return Gearbox(kernel, wheels, [load(0, TORQUE, -1.0)], meshes)


def evaluate(
    gearbox: Gearbox, wheel: int, rho: Floats, teeth: Sequence[int], side: int
) -> tuple[Floats, ...]:
    """e, de and d2e of a wheel of a gearbox."""
    n = len(rho)
    results = tuple(np.empty(n) for _ in range(3))
    numbers = np.array(teeth, dtype=np.int32)
    sides = np.full(n, side, dtype=np.int32)
    gearbox.library.test_gearbox_flank_deviation(
        gearbox.handle, wheel, n, _at(numbers), _at(sides), _at(rho), *map(_at, results)
    )
    return results


def profile(wheel: int) -> Profile:
    """Profile of a wheel of the train, by hand: a_w = m (z1+z2)/2, no shift."""
    z = TEETH[wheel]
    radius = MODULE * z / 2
    rho_tip = [
        np.sqrt((MODULE * n / 2 + MODULE) ** 2 - (MODULE * n / 2 * np.cos(ALPHA)) ** 2)
        for n in TEETH
    ]
    mates = [i for i in (wheel - 1, wheel + 1) if 0 <= i < len(TEETH)]
    starts = [MODULE * (z + TEETH[i]) / 2 * np.sin(ALPHA) - rho_tip[i] for i in mates]
    tooth = np.pi / z + 2 * (np.tan(ALPHA) - ALPHA)
    return Profile(z, radius * np.cos(ALPHA), radius, min(starts), rho_tip[wheel], tooth)


def test_each_wheel_has_the_deviations_of_its_own_profile(kernel: Kernel):
    """The idler's active profile starts where its larger mate needs it."""
    given = [
        deviations(
            tip_relief=relief(10e-6, diameter=0.063),
            runout_amount=8e-6,
            runout_phase=1.0,
        ),
        deviations(
            root_relief=relief(7e-6, roll_angle=np.radians(16)),
            profile_crowning=3e-6,
            pitch_errors=[1e-6 * (k % 7) for k in range(35)],
        ),
        deviations(accuracy_class=6, seed=3),
    ]
    gearbox = train(kernel, given)
    for index, (z, description) in enumerate(zip(TEETH, given, strict=True)):
        ends = profile(index)
        rho = np.linspace(ends.rho_start, ends.rho_tip, 41)
        teeth = np.arange(41) % z
        for side in (1, -1):
            found = evaluate(gearbox, index, rho, teeth, side)
            expected = deviation_at(kernel, description, ends, rho, teeth, side)
            # the profiles agree to rounding, which slopes of 1e-2 and curvatures of 1 /m see
            for one, other, scale in zip(found, expected, (1e-5, 1e-2, 1.0), strict=False):
                np.testing.assert_allclose(one, other, rtol=1e-11, atol=1e-12 * scale)


def test_an_accuracy_class_is_that_of_the_reference_diameter(kernel: Kernel):
    gearbox = train(kernel, [None, None, deviations(accuracy_class=6, seed=3)])
    tolerances = pitch_tolerances(kernel, 26, MODULE, 6)
    arcs = pitch_error_sequence(kernel, 26, *tolerances, 3)
    e, *_ = evaluate(gearbox, 2, np.full(26, 0.01), np.arange(26), 1)
    np.testing.assert_allclose(e, arcs * np.cos(ALPHA), rtol=1e-12, atol=1e-18)


def pitch_errors_of(gearbox: Gearbox, wheel: int) -> Floats:
    """Cumulative position deviations of the teeth; none if there are none."""
    errors = np.full(TEETH[wheel], np.nan)
    ask = gearbox.library.evl_gearbox_pitch_errors
    n = ask(gearbox.handle, wheel, 0, None)
    assert ask(gearbox.handle, wheel, len(errors), _at(errors)) == n
    assert np.isnan(errors[n:]).all()
    return errors[:n]


def test_a_gearbox_tells_where_deviations_begin_and_how_large_pitch_errors_are(kernel: Kernel):
    pitch = [1e-6 * (k % 7) for k in range(35)]
    given = [
        deviations(
            tip_relief=relief(10e-6, diameter=0.063), root_relief=relief(1e-6, roll_angle=0.2)
        ),
        deviations(pitch_errors=pitch),
        None,
    ]
    gearbox = train(kernel, given)
    r_b, ends = profile(0).base_radius, profile(0)
    assert gearbox.quantities(OF_DEVIATION, 0) == {
        "profile_start_diameter": pytest.approx(2 * np.hypot(r_b, ends.rho_start), rel=1e-13),
        "profile_tip_diameter": pytest.approx(0.066, rel=1e-14),
        "tip_relief_diameter": pytest.approx(0.063, rel=1e-14),
        "tip_relief_roll_angle": pytest.approx(np.sqrt(0.0315**2 - r_b**2) / r_b, rel=1e-13),
        "root_relief_diameter": pytest.approx(2 * r_b * np.hypot(1, 0.2), rel=1e-14),
        "root_relief_roll_angle": pytest.approx(0.2, rel=1e-14),
    }
    reported = gearbox.quantities(OF_DEVIATION, 1)
    assert list(reported)[2:] == ["single_pitch_deviation", "total_pitch_deviation"]
    assert reported["single_pitch_deviation"] == pytest.approx(6e-6, rel=1e-13)
    assert reported["total_pitch_deviation"] == pytest.approx(6e-6, rel=1e-13)
    assert gearbox.quantities(OF_DEVIATION, 2) == {}
    np.testing.assert_allclose(pitch_errors_of(gearbox, 1), pitch, rtol=1e-14, atol=0)
    assert len(pitch_errors_of(gearbox, 0)) == len(pitch_errors_of(gearbox, 2)) == 0


def test_wheels_without_deviations_have_none(kernel: Kernel):
    gearbox = train(kernel, [None, deviations(runout_amount=1e-6), None])
    for index in (0, 2):
        for values in evaluate(gearbox, index, np.linspace(0.005, 0.02, 5), range(5), 1):
            np.testing.assert_array_equal(values, 0)


def test_initial_gaps_are_those_of_perfect_flanks(kernel: Kernel):
    gearbox = train(kernel, [deviations(profile_crowning=3e-6), None, None])
    outputs = gearbox.outputs(gearbox.start(gaps=[2e-6, 0.0]))
    assert outputs["transmission_error"] == pytest.approx([-2e-6, 0.0], rel=1e-12)
    assert outputs["gap"][0] == pytest.approx(2e-6 + outputs["flank_deviation"][0], rel=1e-12)
    assert outputs["flank_deviation"][0] > 1e-7


def refusal(kernel: Kernel, given: Sequence[Block | None], **fields: object) -> GearboxError:
    with pytest.raises(GearboxError) as caught:
        train(kernel, given, **fields)
    assert caught.value.code == INVALID_INPUT
    assert "\n" not in caught.value.message
    return caught.value


@pytest.mark.parametrize("index", range(3))
def test_a_refused_deviation_names_its_wheel(kernel: Kernel, index: int):
    given = [None] * 3
    given[index] = deviations(profile_crowning=-1e-6)
    error = refusal(kernel, given)
    assert (error.subject, error.index, error.field) == (WHEEL, index, "profile_crowning")


def test_an_amount_that_is_no_number_is_refused_too(kernel: Kernel):
    error = refusal(kernel, [deviations(profile_crowning=np.nan), None, None])
    assert (error.field, error.index) == ("profile_crowning", 0)


@pytest.mark.parametrize("tracking", [ALGEBRAIC, DIFFERENTIAL])
@pytest.mark.parametrize("index", [0, 1])
def test_tracked_flanks_have_no_deviations(kernel: Kernel, tracking: str, index: int):
    given = [None] * 3
    given[index] = deviations(runout_amount=1e-6)
    error = refusal(kernel, given, tracking=tracking)
    assert (error.subject, error.index, error.field) == (MESH, 0, "tracking")
    assert "closed_form" in error.message


def test_rigid_contacts_have_no_deviations(kernel: Kernel):
    rigid = kernel.law(CONTACT, "rigid")
    given = [None, deviations(runout_amount=1e-6), None]
    error = refusal(kernel, given, contact=rigid, damping=None)
    assert (error.subject, error.index, error.field) == (MESH, 0, "contact.law")


def test_meshes_whose_wheels_are_perfect_may_be_tracked(kernel: Kernel):
    gearbox = train(kernel, [None, None, deviations(runout_amount=1e-6)], tracking=DIFFERENTIAL)
    outputs = gearbox.outputs(gearbox.start())
    assert outputs["tracking"].tolist() == [2, 0]  # differential, closed form
    assert outputs["flank_deviation"][0] == 0
    assert 0 < abs(outputs["flank_deviation"][1]) <= 1e-6


def test_a_wheel_without_module_has_no_deviations(kernel: Kernel):
    wheels: list[Block] = [
        wheel(teeth=20, pitch_radius=0.2, centre=(0, 0), deviation=deviations(runout_amount=1e-6)),
        wheel(teeth=30),
    ]
    with pytest.raises(GearboxError) as caught:
        Gearbox(kernel, wheels, [load(0, TORQUE, -1.0)], [mesh(kernel)])
    assert (caught.value.subject, caught.value.index) == (WHEEL, 0)
    assert caught.value.field == "eccentricity"
    assert "needs 'module' in the same block" in caught.value.message


def test_pitch_errors_are_copied(kernel: Kernel):
    numbers = [2e-6] * 20
    description = deviations(pitch_errors=numbers)
    gearbox = train(kernel, [description, None, None])
    numbers[0] = 1.0
    e, *_ = evaluate(gearbox, 0, np.full(1, 0.01), [0], 1)
    assert e[0] == pytest.approx(2e-6 * np.cos(ALPHA), rel=1e-14)
