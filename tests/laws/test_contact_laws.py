"""The force laws behind their common interface, and the table that lists them."""

from __future__ import annotations

import re

import numpy as np
import pytest

from kernel.kernel import (
    CONTACT,
    DAMPING,
    FRICTION,
    INVALID_INPUT,
    OK,
    OUT_OF_DOMAIN,
    Kernel,
    KernelError,
    LawChoice,
)

GEOMETRY = {"rho_a": 0.02, "rho_b": 0.045441, "e_star": 1.1e11, "width": 0.1}
RHO = GEOMETRY["rho_a"] + GEOMETRY["rho_b"]
H = np.array([-1e-6, -3e-9, 1e-12, 3e-9, 1e-5])


# ---- elastic


def test_elastic_force_is_johnsons_over_the_width(kernel: Kernel):
    law = kernel.law(CONTACT, "johnson")
    result = kernel.law_elastic_force(law, h=H, **GEOMETRY)
    per_width = kernel.johnson_force(H, RHO, GEOMETRY["e_star"])
    fields = {"force": "force", "d_h": "d_h", "d_rho_a": "d_rho", "d_rho_b": "d_rho"}
    for name, of_sum in fields.items():
        np.testing.assert_array_equal(
            getattr(result, name), GEOMETRY["width"] * getattr(per_width, of_sum)
        )


def test_penetration_from_force_inverts_the_elastic_force(kernel: Kernel):
    law = kernel.law(CONTACT, "johnson")
    force = kernel.law_elastic_force(law, h=H, **GEOMETRY).force
    h, codes = kernel.law_penetration(law, force, **GEOMETRY)
    assert not codes.any()
    np.testing.assert_allclose(h, H, rtol=2e-15)


def test_elastic_force_is_continuous_and_smooth_through_the_end_of_contact(kernel: Kernel):
    """A root of force + damping is located from both sides of h = 0."""
    law = kernel.law(CONTACT, "johnson")
    h = np.array([-1e-15, -1e-300, 0.0, 1e-300, 1e-15])
    force = kernel.law_elastic_force(law, h=h, **GEOMETRY).force
    assert (np.diff(force) > 0).all()
    assert force[2] == 0
    assert np.abs(force).max() < 1e-4


def test_leaving_the_elastic_law_is_explained_with_value_and_limit(kernel: Kernel):
    law = kernel.law(CONTACT, "johnson")
    context = {"h": 0.04, **GEOMETRY}
    result = kernel.law_elastic_force(law, **context)
    assert list(result.code) == [OUT_OF_DOMAIN]
    assert result.force[0] == result.d_h[0] == result.d_rho_a[0] == result.d_rho_b[0] == 0
    message = kernel.law_elastic_limit(law, **context)
    sentence = (
        r"penetration h = (\S+) m exceeds the limit 4 \(rho_A \+ rho_B\)/e\^2 = (\S+) m "
        r"of the Johnson force, eq\. \(15\)"
    )
    found = re.fullmatch(sentence, message)
    assert found, message
    value, limit = map(float, found.groups())
    assert value == pytest.approx(0.04, rel=1e-5)  # six digits are printed
    assert limit == pytest.approx(4 * RHO / np.e**2, rel=1e-5)
    context.update(rho_a=-2.0, rho_b=1.0)
    assert "rho_A + rho_B = -1" in kernel.law_elastic_limit(law, **context)
    _, codes = kernel.law_penetration(law, 1e12, **GEOMETRY)
    assert list(codes) == [OUT_OF_DOMAIN]


# ---- viscous


def test_no_damping_gives_no_force(kernel: Kernel):
    results = kernel.law_viscous_force(
        kernel.law(CONTACT, "johnson"), kernel.law(DAMPING, "none"), h=H, h_dot=0.1, **GEOMETRY
    )
    assert not np.any(results)


def test_linear_damping_is_proportional_to_the_rate(kernel: Kernel):
    h_dot = np.array([-0.2, 0.0, 1e-6, 3.0])
    viscous = kernel.law_viscous_force(
        kernel.law(CONTACT, "johnson"),
        kernel.law(DAMPING, "linear", coefficient=1e4),
        h=1e-9,
        h_dot=h_dot,
        **GEOMETRY,
    )
    np.testing.assert_array_equal(viscous.force, 1e4 * h_dot)
    np.testing.assert_array_equal(viscous.d_h, 0)
    np.testing.assert_array_equal([viscous.d_rho_a, viscous.d_rho_b], 0)
    np.testing.assert_array_equal(viscous.d_h_dot, 1e4)


def test_one_sided_damping_acts_on_approach_only(kernel: Kernel):
    """Force damp |kappa| |h'| on approach, 0 on separation, as the paper's group writes it."""
    h, h_dot = np.meshgrid([1e-9, 2e-6], [-0.2, 0.0, 1e-6, 3.0])
    h, h_dot = h.ravel(), h_dot.ravel()
    viscous = kernel.law_viscous_force(
        kernel.law(CONTACT, "johnson"),
        kernel.law(DAMPING, "one_sided", coefficient=5e9),
        h=h,
        h_dot=h_dot,
        **GEOMETRY,
    )
    approach = h_dot > 0
    np.testing.assert_allclose(viscous.force, np.where(approach, 5e9 * h * h_dot, 0), rtol=4e-16)
    np.testing.assert_allclose(viscous.d_h, np.where(approach, 5e9 * h_dot, 0), rtol=4e-16)
    np.testing.assert_array_equal([viscous.d_rho_a, viscous.d_rho_b], 0)
    np.testing.assert_allclose(viscous.d_h_dot, np.where(approach, 5e9 * h, 0), rtol=4e-16)


# ---- friction


def test_no_friction_has_no_branches(kernel: Kernel):
    law = kernel.law(FRICTION, "none")
    assert kernel.law_friction_knee(law) == 0
    assert not kernel.law_friction_mode(law, [-1.0, 0.0, 1.0]).any()
    assert not np.any(kernel.law_friction_factor(law, [-1, 0, 1], 0.5))


def test_coulomb_friction_in_its_own_mode_is_the_clamped_line(kernel: Kernel):
    f, delta = 0.3, 1e-4
    law = kernel.law(FRICTION, "coulomb", coefficient=f, regularisation_velocity=delta)
    v = np.concatenate([np.linspace(-3, 3, 61) * delta, [-10.0, 10.0]])
    modes = kernel.law_friction_mode(law, v)
    factor, d_v = kernel.law_friction_factor(law, modes, v)
    np.testing.assert_allclose(factor, f * np.clip(v / delta, -1, 1), rtol=4e-16)
    np.testing.assert_allclose(d_v, np.where(modes == 0, f / delta, 0), rtol=4e-16)
    assert set(modes) == {-1, 0, 1}
    assert kernel.law_friction_knee(law) == delta


def test_the_knee_itself_belongs_to_the_line(kernel: Kernel):
    """As |v_t| <= delta in docs/reference/laws.md says; the slope there is that of the line."""
    delta = 1e-4
    law = kernel.law(FRICTION, "coulomb", coefficient=0.3, regularisation_velocity=delta)
    beyond = np.nextafter(delta, 1.0)
    modes = kernel.law_friction_mode(law, [-beyond, -delta, 0.0, delta, beyond])
    np.testing.assert_array_equal(modes, [-1, 0, 0, 0, 1])


def test_coulomb_branches_are_continued_smoothly_past_their_ends(kernel: Kernel):
    """Inside a mode nothing bends: the event is located on a smooth function."""
    law = kernel.law(FRICTION, "coulomb", coefficient=0.3)
    v = np.array([-5e-4, 0.0, 5e-4])
    factor, _ = kernel.law_friction_factor(law, 0, v)
    np.testing.assert_allclose(factor, 0.3 * v / 1e-4, rtol=4e-16)
    for mode in (-1, 1):
        factor, d_v = kernel.law_friction_factor(law, mode, v)
        np.testing.assert_array_equal(factor, 0.3 * mode)
        assert not d_v.any()


def test_friction_opposes_sliding_or_does_nothing(kernel: Kernel):
    law = kernel.law(FRICTION, "coulomb", coefficient=0.3)
    v = np.random.default_rng(2).normal(scale=2e-4, size=200)
    factor, _ = kernel.law_friction_factor(law, kernel.law_friction_mode(law, v), v)
    assert (factor * v >= 0).all()


def test_a_coefficient_of_zero_has_no_knee_and_no_branches(kernel: Kernel):
    """So that a frictionless run has no events to locate."""
    law = kernel.law(FRICTION, "coulomb", coefficient=0.0)
    assert kernel.law_friction_knee(law) == 0
    assert not kernel.law_friction_mode(law, [-1.0, 1.0]).any()


# ---- the table


def test_the_laws_of_each_family_keep_their_indices(kernel: Kernel):
    """Programs that link the library choose by index, so a new law comes last."""
    restitution = ["hunt_crossley", "lankarani_nikravesh", "flores", "gonthier", "lee_wang"]
    known = [
        ["johnson", "radzimovsky", "linear", "yang_lin", "power", "rigid"],
        ["none", "linear", "one_sided", *restitution, "ratio"],
        ["none", "coulomb", "tanh", "stribeck"],
    ]
    for family, names in enumerate(known):
        listed = [law.name for law in kernel.laws(family)]
        assert listed[: len(names)] == names
        assert len(set(listed)) == len(listed)


def test_parameters_are_described_with_unit_default_and_range(kernel: Kernel):
    (coefficient, delta) = kernel.laws(FRICTION)[1].rows[:2]
    assert (coefficient.key, coefficient.unit, coefficient.required) == ("coefficient", "", True)
    assert (coefficient.minimum, coefficient.minimum_open, coefficient.maximum) == (
        0,
        False,
        np.inf,
    )
    assert (delta.key, delta.unit, delta.required) == ("regularisation_velocity", "m/s", False)
    assert (float(delta.default_text), delta.minimum, delta.minimum_open) == (1e-4, 0, True)
    linear, one_sided = kernel.laws(DAMPING)[1:3]
    assert linear.rows[0].unit == "N s/m"
    assert one_sided.rows[0].unit == "N s/m2"
    for family in range(3):
        for law in kernel.laws(family):
            assert law.text
            for parameter in law.rows:
                assert parameter.text
                assert parameter.minimum < parameter.maximum


@pytest.mark.parametrize(
    ("family", "past"), [(0, 0), (0, None), (1, 0), (2, 0), (2, 5), (3, 0), (-1, 0)]
)
def test_a_law_that_does_not_exist_is_refused(kernel: Kernel, family: int, past: int | None):
    """Past the last one, or before the first."""
    known = len(kernel.laws(family)) if 0 <= family < 3 else 0
    index = -1 if past is None else known + past
    with pytest.raises(KernelError) as error:
        kernel.law_validate(family, LawChoice(law=index))
    assert error.value.field == "law"
    assert str(index) in error.value.message


ACCEPTED = [
    (CONTACT, "johnson", {}),
    (CONTACT, "rigid", {"restitution": 0.0}),
    (CONTACT, "rigid", {"restitution": 1.0, "rest_velocity": 1e-12}),
    (DAMPING, "none", {}),
    (DAMPING, "linear", {"coefficient": 0.0}),
    (DAMPING, "one_sided", {"coefficient": 1e12}),
    (FRICTION, "coulomb", {"coefficient": 0.3}),
    (FRICTION, "coulomb", {"coefficient": 0.0, "regularisation_velocity": 1e-12}),
    (CONTACT, "power", {"coefficient": 1e-3, "exponent": 1.0}),
    (DAMPING, "hunt_crossley", {"restitution": 0.0}),
    (DAMPING, "lankarani_nikravesh", {"restitution": 0.0}),
    (DAMPING, "lee_wang", {"restitution": 0.0}),
    (DAMPING, "flores", {"restitution": 1e-3}),
    (DAMPING, "gonthier", {"restitution": 1.0, "v0_min": 1e-12}),
    (DAMPING, "hunt_crossley", {"restitution": 0.5, "v0_min": np.nan}),  # left to the mesh
    (DAMPING, "ratio", {"value": 0.0}),
    (DAMPING, "ratio", {"value": 0.999}),
    (
        FRICTION,
        "stribeck",
        {"static_coefficient": 0.2, "kinetic_coefficient": 0.2, "stribeck_velocity": 1e-9},
    ),
]


@pytest.mark.parametrize(("family", "name", "parameters"), ACCEPTED)
def test_parameters_in_range_are_accepted(kernel: Kernel, family: int, name: str, parameters: dict):
    kernel.law_validate(family, kernel.law(family, name, **parameters))


REFUSED = [
    (DAMPING, "linear", {"coefficient": -1.0}, "coefficient", "coefficient = -1"),
    (DAMPING, "one_sided", {"coefficient": np.inf}, "coefficient", "finite"),
    (DAMPING, "linear", {"coefficient": np.nan}, "coefficient", "finite"),
    (FRICTION, "coulomb", {"coefficient": -0.1}, "coefficient", "must be at least 0"),
    (FRICTION, "coulomb", {"coefficient": np.nan}, "coefficient", "finite"),
    (
        FRICTION,
        "coulomb",
        {"coefficient": 0.3, "regularisation_velocity": 0.0},
        "regularisation_velocity",
        "must be greater than 0",
    ),
    (
        FRICTION,
        "coulomb",
        {"coefficient": 0.3, "regularisation_velocity": -1e-4},
        "regularisation_velocity",
        "must be greater than 0",
    ),
    (CONTACT, "linear", {"stiffness": 0.0}, "stiffness", "must be greater than 0"),
    (CONTACT, "power", {"coefficient": 1e9, "exponent": 0.99}, "exponent", "must be at least 1"),
    (DAMPING, "hunt_crossley", {"restitution": -0.1}, "restitution", "must be at least 0"),
    (DAMPING, "lee_wang", {"restitution": 1.1}, "restitution", "must be at most 1"),
    (DAMPING, "lankarani_nikravesh", {"restitution": np.nan}, "restitution", "finite"),
    (DAMPING, "flores", {"restitution": 0.0}, "restitution", "must be greater than 0"),
    (DAMPING, "gonthier", {"restitution": 0.0}, "restitution", "must be greater than 0"),
    (DAMPING, "flores", {"restitution": 0.5, "v0_min": 0.0}, "v0_min", "must be greater than 0"),
    (DAMPING, "ratio", {"value": 1.0}, "value", "must be less than 1"),
    (DAMPING, "ratio", {"value": -0.1}, "value", "must be at least 0"),
    (DAMPING, "ratio", {"value": np.nan}, "value", "finite"),
    (FRICTION, "tanh", {"coefficient": -0.1}, "coefficient", "must be at least 0"),
    (
        FRICTION,
        "stribeck",
        {"static_coefficient": 0.1, "kinetic_coefficient": 0.2, "stribeck_velocity": 0.01},
        "static_coefficient",
        "static_coefficient = 0.1 must be at least the kinetic_coefficient = 0.2",
    ),
    (
        FRICTION,
        "stribeck",
        {"static_coefficient": 0.2, "kinetic_coefficient": 0.1, "stribeck_velocity": 0.0},
        "stribeck_velocity",
        "must be greater than 0",
    ),
]


@pytest.mark.parametrize(("family", "name", "parameters", "field", "text"), REFUSED)
def test_parameters_out_of_range_are_refused_by_name(
    kernel: Kernel, family: int, name: str, parameters: dict, field: str, text: str
):
    with pytest.raises(KernelError) as error:
        kernel.law_validate(family, kernel.law(family, name, **parameters))
    assert error.value.code == INVALID_INPUT != OK
    assert error.value.field == field
    assert text in error.value.message
    assert name in error.value.message


def test_a_rigid_contact_has_no_force_law(kernel: Kernel):
    law = kernel.law(CONTACT, "rigid")
    assert kernel.law_elastic_force(law, h=[1e-9], **GEOMETRY).code == [OUT_OF_DOMAIN]
    assert "multiplier" in kernel.law_elastic_limit(law, h=[1e-9], **GEOMETRY)
