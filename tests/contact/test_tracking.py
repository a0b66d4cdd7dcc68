"""Contact tracking, against the paper's equations in absolute housing coordinates."""

from __future__ import annotations

import mpmath as mp
import numpy as np
import pytest

from kernel.gearbox import Gearbox, GearboxError, State
from kernel.gearbox_cases import PAIRS, draw, face, paper_gearbox, scatter, set_gap, worst
from kernel.gearbox_description import ALGEBRAIC, CLOSED_FORM, DIFFERENTIAL
from kernel.housing import Housing, Pair, cross
from kernel.kernel import Kernel

EVERY_PAIR = pytest.mark.parametrize("pair", PAIRS.values(), ids=PAIRS.keys())
SEEDS = range(8)


def stray(gearbox: Gearbox, state: State, random: np.random.Generator, size: float) -> None:
    """Displace the tracked points from flanks and line of action, with arbitrary rates."""
    r_b = gearbox.wheel_geometry(1).base_radius
    track = gearbox.tracked()
    state.y[track] += [draw(random, s) for s in (size, size, size, size, 0.1, r_b * size)]
    state.yp[track] = [draw(random, s) for s in (1.0, 0.1, 0.1, 0.1, 1.0, 0.1 * r_b)]


def amplification(housing: Housing) -> float:
    """Return a tangent's rotation times its circle's radius, per displacement across it."""
    radii = [float(housing.radius_of_curvature(i)) for i in (0, 1)]
    return float(max(housing.pair.base_radii)) / min(radii)


def deviations(gearbox: Gearbox, state: State) -> float:
    """Return the largest of the lengths from which the kernel computes the points."""
    r_b = max(gearbox.wheel_geometry(i).base_radius for i in (0, 1))
    arms = {"turn": r_b, "angle": r_b, "gradi": 0.0, "mu_0": 1 / r_b, "refer": 0.0, "speed": 0.0}
    arms |= {"dissi": 0.0, "load_": 0.0}
    return sum(
        abs(value) * arms.get(name[:5], 0.0 if "rate" in name else 1.0)
        for name, value in zip(gearbox.names, state.y, strict=True)
    )


def in_rows(housing: Housing, v: np.ndarray) -> list[mp.mpf]:
    """Return the components of v along t_0 and e_0, as in the rows of the residual."""
    t_0, e_0, *_ = housing._frame()
    return [v @ t_0, v @ e_0]


@EVERY_PAIR
@pytest.mark.parametrize("seed", SEEDS)
def test_algebraic_residual_is_equation_1_with_its_rows_scaled(
    kernel: Kernel, pair: Pair, seed: int
):
    """r_bA (grad g_A - lambda grad g_B), its first row times rho_B; -(r_PA - r_PB - mu grad g_B);
    r_bA g_A; r_bB g_B.
    """
    random = np.random.default_rng(seed)
    gearbox = pair.gearbox(kernel, tracking=ALGEBRAIC)
    state = scatter(gearbox, random, gap=draw(random, 1e-5))
    stray(gearbox, state, random, 1e-6)
    at = Housing(pair, gearbox, state)
    (g_a, grad_a), (g_b, grad_b) = at.flank(0), at.flank(1)
    r_ba, r_bb = pair.base_radii
    normals = in_rows(at, r_ba * (grad_a - at.tracked["gradient_ratio"] * grad_b))
    apart = in_rows(at, at.point(1) - at.point(0) + at.tracked["mu"] * grad_b)
    rho_b = mp.sqrt(sum((at.point(1) - at.axle(1)) ** 2) - r_bb**2)
    expected = [rho_b * normals[0], normals[1], *apart, r_ba * g_a, r_bb * g_b]
    residual = gearbox.residual(state)[gearbox.tracked()]
    # rounding of each length, propagated to the contact of the tangents; row 2 is 1 - 1
    tolerance = np.full(6, 1e-15 * deviations(gearbox, state) * amplification(at))
    tolerance[1] = 1e-15
    error = [r - e for r, e in zip(residual, expected, strict=True)]
    assert worst(error, tolerance) <= 1
    assert abs(residual).max() > 1e4 * tolerance.max()


def raw_differential(
    kernel: Kernel, at: Housing
) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """Return equations (2)-(3) as a linear system in (u_A, u_B, lambda', mu').

    Composed from the kernel's flank function in the housing frame.

    Returns
    -------
    matrix, constant
        matrix @ unknowns + constant = 0
    unknowns
        represented by the rates of the tracked variables
    size
        of the largest terms of each row
    """
    pair = at.pair
    gradients, hessians = [], []
    for i in (0, 1):
        flank = kernel.involute_flank_housing(
            np.array(at.point(i), dtype=float),
            np.array(at.axle(i), dtype=float),
            float(at.root_angle(i)),
            float(pair.base_radii[i]),
            pair.sigma,
        )
        gradients.append(flank.gradient[0])
        hessians.append(flank.hessian[0])
    (grad_a, grad_b), (hess_a, hess_b) = gradients, hessians
    lam, mu = float(at.tracked["gradient_ratio"]), float(at.tracked["mu"])
    turning, moving = [], []  # w x grad g; velocity of the material point
    for i in (0, 1):
        arm = at.point(i) - at.axle(i)
        moving.append(np.array(at.axle_velocity(i) + cross(at.omega(i), arm), dtype=float))
        turning.append(np.array(cross(float(at.omega(i)), gradients[i]), dtype=float))
    matrix, constant = np.zeros((6, 6)), np.zeros(6)
    matrix[0:2, 0:2] = hess_a
    matrix[0:2, 2:4] = -lam * hess_b
    matrix[0:2, 4] = -grad_b
    by_turning_b = turning[1] - hess_b @ moving[1]
    constant[0:2] = turning[0] - hess_a @ moving[0] - lam * by_turning_b
    matrix[2:4, 0:2] = np.eye(2)
    matrix[2:4, 2:4] = -np.eye(2) - mu * hess_b
    matrix[2:4, 5] = -grad_b
    constant[2:4] = -mu * by_turning_b
    matrix[4, 0:2], constant[4] = grad_a, -grad_a @ moving[0]
    matrix[5, 2:4], constant[5] = grad_b, -grad_b @ moving[1]
    unknowns = np.array(
        [
            *at.point_velocity(0),
            *at.point_velocity(1),
            at.tracked["gradient_ratio'"],
            at.tracked["mu'"],
        ],
        dtype=float,
    )
    return matrix, constant, unknowns, abs(matrix) @ abs(unknowns) + abs(constant)


@EVERY_PAIR
@pytest.mark.parametrize("seed", SEEDS)
def test_differential_residual_is_equations_2_and_3_with_their_rows_scaled(
    kernel: Kernel, pair: Pair, seed: int
):
    random = np.random.default_rng(seed)
    gearbox = pair.gearbox(kernel, tracking=DIFFERENTIAL)
    state = scatter(gearbox, random, gap=draw(random, 1e-5))
    stray(gearbox, state, random, 1e-6)
    at = Housing(pair, gearbox, state)
    matrix, constant, unknowns, size = raw_differential(kernel, at)
    raw = matrix @ unknowns + constant
    r_ba, r_bb = (float(r) for r in pair.base_radii)
    rho_b = float(mp.sqrt(sum((at.point(1) - at.axle(1)) ** 2) - pair.base_radii[1] ** 2))
    rows = np.array([in_rows(at, np.eye(2)[i]) for i in (0, 1)], dtype=float).T
    expected = np.concatenate(
        [rows @ (r_ba * raw[0:2]), -(rows @ raw[2:4]), [r_ba * raw[4], r_bb * raw[5]]]
    )
    expected[0] *= rho_b
    residual = gearbox.residual(state)[gearbox.tracked()]
    # the raw form sums terms that grow with the angular velocity, at rounded points: the error of
    # the normal is the rounding of its point over the radius of curvature
    scale = np.array([rho_b * r_ba, r_ba, 1, 1, r_ba, r_bb])
    size = scale * np.repeat([size[0:2].max(), size[2:4].max(), size[4:].max()], 2)
    tolerance = 1e-14 * amplification(at) * size
    error = residual - expected
    assert worst(error, tolerance) <= 1
    assert abs(residual).max() > 1e6 * tolerance.max()


@EVERY_PAIR
@pytest.mark.parametrize("tracking", [ALGEBRAIC, DIFFERENTIAL])
@pytest.mark.parametrize("seed", SEEDS)
def test_derivative_of_the_tracked_variables_solves_equations_2_and_3(
    kernel: Kernel, pair: Pair, tracking: str, seed: int
):
    """Also in the algebraic form: its states have their true derivative."""
    random = np.random.default_rng(seed)
    gearbox = pair.gearbox(kernel, tracking=tracking)
    state = scatter(gearbox, random, gap=draw(random, 1e-5))
    if seed % 2:
        stray(gearbox, state, random, 1e-6)
    state.yp = gearbox.derivative(state)
    at = Housing(pair, gearbox, state)
    matrix, constant, unknowns, size = raw_differential(kernel, at)
    # rounding of the raw form, as in the test before
    largest = np.repeat([size[:2].max(), size[2:4].max(), size[4:].max()], 2)
    tolerance = 1e-14 * amplification(at) * largest
    error = matrix @ unknowns + constant
    assert worst(error, tolerance) <= 1
    assert np.linalg.cond(matrix) < 1e9  # so that the solution is unique


@EVERY_PAIR
@pytest.mark.parametrize("seed", SEEDS)
def test_algebraic_and_differential_form_hold_on_along_the_same_motion(
    kernel: Kernel, pair: Pair, seed: int
):
    """The derivative of (1) along the rates that solve (2)-(3) is zero."""
    random = np.random.default_rng(seed)
    gearbox = pair.gearbox(kernel, tracking=ALGEBRAIC)
    state = scatter(gearbox, random, gap=draw(random, 1e-6))
    state.yp = gearbox.derivative(state)
    track = gearbox.tracked()
    gradient = gearbox.jacobian(state, 0.0)[track]
    at = Housing(pair, gearbox, state)
    # rounding of the products that cancel, and of the normals in the rates
    tolerance = 1e-13 * amplification(at) * (abs(gradient) @ abs(state.yp))
    assert worst(gradient @ state.yp, tolerance) <= 1


@EVERY_PAIR
@pytest.mark.parametrize("size", [1e-9, 1e-6, 1e-4])
@pytest.mark.parametrize("seed", SEEDS)
def test_closed_form_is_assertions_1_and_2(kernel: Kernel, pair: Pair, size: float, seed: int):
    """Gap, normal, radii of curvature and contact points, for displacements of the size of the gap.

    Exact to the rounding of the displacements themselves, however small relative to the radii.
    """
    random = np.random.default_rng(seed)
    gearbox = pair.gearbox(kernel, tracking=CLOSED_FORM)
    state = scatter(gearbox, random, displacement=size, gap=size)
    at = Housing(pair, gearbox, state)
    outputs = gearbox.outputs(state)
    apart = float(sum(abs(x) for i in (0, 1) for x in (at.axle(i) - origin(at, i))))
    psi = [float(state.y[i]) for i, name in enumerate(gearbox.names) if "angle_dev" in name]
    largest = apart + abs(psi[0]) * float(max(pair.base_radii))
    # R (inv alpha - inv alpha_0) is a sum of two lengths R/rho times larger
    cancelling = float(sum(pair.base_radii) / pair.rho_0)
    assert worst(at.kappa - outputs["gap"][0], 4e-16 * cancelling * largest) <= 1
    # positions in the housing are rounded to 1e-16 of themselves
    absolute = 4e-16 * (float(pair.rho_0) + 10 * float(max(pair.base_radii)))
    for i, name in enumerate(("driving", "driven")):
        expected = np.array(at.line_point(i), dtype=float)
        np.testing.assert_allclose(
            outputs[f"contact_point_{name}"][0], expected, rtol=0, atol=absolute
        )
    h = -outputs["gap"][0]
    share = gearbox.mesh_geometry().elastic_share_driving
    rho_a = outputs["friction_arm_driving"][0] + share * h
    rho_b = outputs["friction_arm_driven"][0] + (1 - share) * h
    # theta times the base radius is rounded to 1e-16 of many pitches
    rounding = 2e-16 * abs(float(at.turn(0))) * float(pair.base_radii[0]) + absolute
    assert abs(rho_a - float(at.radius_of_curvature(0))) <= rounding
    assert abs(rho_b - float(at.radius_of_curvature(1))) <= rounding
    assert abs(rho_a + rho_b - float(at.rho) - h) <= absolute


def origin(at: Housing, wheel: int) -> np.ndarray:
    """Return the reference position of an axis."""
    still = at.state.copy()
    still.y[:] = 0
    return Housing(at.pair, at.gearbox, still).axle(wheel)


@EVERY_PAIR
@pytest.mark.parametrize("seed", SEEDS)
def test_tracked_points_start_where_assertions_1_and_2_put_them(
    kernel: Kernel, pair: Pair, seed: int
):
    random = np.random.default_rng(seed)
    gearbox = pair.gearbox(kernel, tracking=DIFFERENTIAL)
    state = scatter(gearbox, random, displacement=1e-8, gap=1e-8)
    face(gearbox, state)
    at = Housing(pair, gearbox, state)
    r_ba, r_bb = (float(r) for r in pair.base_radii)
    largest = deviations(gearbox, state)
    kappa = float(at.kappa)
    assert float(at.tracked["gradient_ratio"]) == pytest.approx(-r_bb / r_ba, rel=4e-16)
    assert abs(float(at.tracked["mu"]) / r_bb - kappa) <= 1e-15 * largest
    for i in (0, 1):
        distance = at.point(i) - at.line_point(i)
        # the points have 50 digits from the kernel's values: only the rounding of these remains
        assert float(max(abs(distance))) <= 1e-15 * largest * amplification(at)
    outputs = gearbox.outputs(state)
    for name in ("driving", "driven"):
        assert abs(outputs[f"tracking_residual_{name}"][0]) <= 1e-15 * largest * amplification(at)
        assert abs(outputs[f"line_distance_{name}"][0]) <= 1e-15 * largest * amplification(at)


@EVERY_PAIR
@pytest.mark.parametrize("seed", SEEDS)
def test_distances_from_the_line_of_action_are_those_of_the_points(
    kernel: Kernel, pair: Pair, seed: int
):
    """Compute (r_PA - K_A).t and (r_PB - K_B).t for points off the line."""
    random = np.random.default_rng(seed)
    gearbox = pair.gearbox(kernel, tracking=DIFFERENTIAL)
    state = scatter(gearbox, random, displacement=1e-6, gap=1e-6)
    stray(gearbox, state, random, 1e-6)
    at = Housing(pair, gearbox, state)
    t, _ = at.directions
    outputs = gearbox.outputs(state)
    tolerance = 1e-15 * deviations(gearbox, state) * amplification(at)
    for i, name in enumerate(("driving", "driven")):
        tangency = at.axle(i) + (1 - 2 * i) * pair.base_radii[i] * t
        expected = float((at.point(i) - tangency) @ t)
        assert abs(outputs[f"line_distance_{name}"][0] - expected) <= tolerance
        assert abs(expected) > 1e4 * tolerance


@EVERY_PAIR
def test_gap_and_its_rate_belong_together(kernel: Kernel, pair: Pair):
    """Test mu' = r_bB kappa' with kappa' from the wheels' speeds and the moving axes."""
    random = np.random.default_rng(5)
    gearbox = pair.gearbox(kernel, tracking=DIFFERENTIAL)
    for _ in range(20):
        state = scatter(gearbox, random)
        set_gap(gearbox, state, 0, draw(random, 1e-6))
        at = Housing(pair, gearbox, state)
        _, e = at.directions
        speeds = sum(r * at.omega(i) for i, r in enumerate(pair.base_radii))
        rate = pair.sigma * speeds + (at.axle_velocity(1) - at.axle_velocity(0)) @ e
        mu_rate = gearbox.derivative(state)[gearbox.tracked()][5]
        # the tracked normal equals that of the line of action to rounding
        assert mu_rate == pytest.approx(float(pair.base_radii[1] * rate), rel=1e-11)


@pytest.mark.parametrize("nearer", [0.1, 0.3, 0.6])
def test_axles_whose_base_circles_have_no_inner_tangent_have_left_the_involute(
    kernel: Kernel, nearer: float
):
    """The paper's axes, 0.5 m apart, nearer than the sum of base radii, or beyond each other."""
    gearbox = paper_gearbox(kernel)
    state = gearbox.start()
    state.y[gearbox.index("displacement_1")] = -nearer
    with pytest.raises(GearboxError, match="below its base circle") as refused:
        gearbox.derivative(state)
    assert refused.value.field == "tracking"
