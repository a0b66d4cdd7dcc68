"""A prescribed motion against mpmath and scipy: position, orientation and their derivatives."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import mpmath as mp
import numpy as np
import pytest
from scipy.interpolate import CubicSpline

from kernel.description import Block
from kernel.gearbox import Gearbox, GearboxError
from kernel.gearbox_cases import paper_gearbox
from kernel.gearbox_description import TORQUE, load, mesh, wheel
from kernel.housing_description import (
    CONSTANT,
    HARMONIC,
    PRESCRIBED,
    RATE,
    SPLINE,
    TURN_X,
    TURN_Y,
    TURN_Z,
    X,
    Y,
    housing,
    term,
)
from kernel.kernel import INVALID_INPUT, Floats, Kernel

KNOTS = [(-0.5, 1.0), (0.0, -2.0), (0.3, 0.5), (1.1, 0.7), (2.0, -1.0)]


def gearbox_with(kernel: Kernel, *terms: Block) -> Gearbox:
    wheels = [wheel(pitch_radius=0.2, centre=(0.0, 0.0)), wheel(teeth=30)]
    return Gearbox(
        kernel, wheels, [load(0, TORQUE, -1.0)], [mesh(kernel)], housing(PRESCRIBED, terms=terms)
    )


def motion(gearbox: Gearbox, t: float) -> dict[str, Floats]:
    """Return what the outputs say of the housing."""
    return gearbox.outputs(replace(gearbox.start(), t=t))


def cross_matrix(v: Any) -> Any:
    return mp.matrix([[0, -v[2], v[1]], [v[2], 0, -v[0]], [-v[1], v[0], 0]])


# Turns that are small, of order 1 on both sides of where the series ends, past a turn, and huge.
TURNS = {
    "none": (0.0, 0.0, 0.0),
    "small": (1e-9, -2e-9, 1e-9),
    "of order 1": (0.5, -0.6, 0.61),
    "just past 1": (0.6, -0.6, 0.55),
    "near a whole turn": (2 * np.pi, 1e-9, 0.0),
    "many turns": (40.0, -25.0, 30.0),
}


@pytest.mark.parametrize("turn", TURNS.values(), ids=TURNS)
def test_a_rotation_vector_gives_orientation_and_angular_motion(
    kernel: Kernel, turn: tuple[float, float, float]
) -> None:
    """Against R = exp([theta]) and [Omega] = R^T R' in 60 digits."""
    rate, frequency, amplitude = (0.7, -1.1, 0.4), 1.3, 0.9
    gearbox = gearbox_with(
        kernel,
        *(term(TURN_X + i, CONSTANT, turn[i]) for i in range(3)),
        *(term(TURN_X + i, RATE, rate[i]) for i in range(3)),
        term(TURN_Y, HARMONIC, amplitude, frequency=frequency),
    )
    out = motion(gearbox, 0.0)
    with mp.workdps(60):
        w = 2 * mp.pi * mp.mpf(frequency)

        def rotation(t: Any) -> Any:
            theta = [mp.mpf(turn[i]) + mp.mpf(rate[i]) * t for i in range(3)]
            theta[1] += mp.mpf(amplitude) * mp.sin(w * t)
            return mp.expm(cross_matrix(theta))

        h = mp.mpf(10) ** -15
        at = {k: rotation(k * h) for k in (-2, -1, 0, 1, 2)}
        first = (8 * (at[1] - at[-1]) - (at[2] - at[-2])) / (12 * h)
        second = (16 * (at[1] + at[-1]) - (at[2] + at[-2]) - 30 * at[0]) / (12 * h**2)
        spin = at[0].T * first
        change = at[0].T * second + first.T * first
        expected = np.array(at[0].tolist(), dtype=float)
        omega = np.array([spin[2, 1], spin[0, 2], spin[1, 0]], dtype=float)
        alpha = np.array([change[2, 1], change[0, 2], change[1, 0]], dtype=float)
    p0, q = out["housing_orientation"][0], out["housing_orientation"][1:]
    found = (p0**2 - q @ q) * np.eye(3) + 2 * np.outer(q, q) + 2 * p0 * np.cross(np.eye(3), q)
    # Rounding of the angle, and of products of rates with it.
    size = 1 + np.linalg.norm(turn)
    np.testing.assert_allclose(found, expected, rtol=0, atol=2e-15 * size)
    np.testing.assert_allclose(out["housing_angular_velocity"], omega, rtol=0, atol=1e-14 * size)
    np.testing.assert_allclose(
        out["housing_angular_acceleration"], alpha, rtol=0, atol=1e-12 * size
    )


@pytest.mark.parametrize("t", [-0.4, 0.0, 0.1, 0.3, 0.9, 1.9999])
def test_a_table_is_the_natural_cubic_spline(kernel: Kernel, t: float) -> None:
    gearbox = gearbox_with(kernel, term(X, SPLINE, table=KNOTS))
    times, values = zip(*KNOTS, strict=True)
    spline = CubicSpline(times, values, bc_type="natural")
    out = motion(gearbox, t)
    for name, order in (("position", 0), ("velocity", 1), ("acceleration", 2)):
        expected = float(spline(t, order))
        found = out[f"housing_{name}"][0]
        assert found == pytest.approx(expected, rel=1e-13, abs=1e-12), name


def test_a_table_goes_on_straight_outside_its_knots(kernel: Kernel) -> None:
    gearbox = gearbox_with(kernel, term(Y, SPLINE, table=KNOTS))
    for end, outside in ((-0.5, -1.5), (2.0, 3.5)):
        edge, out = motion(gearbox, end), motion(gearbox, outside)
        slope = edge["housing_velocity"][1]
        assert out["housing_velocity"][1] == pytest.approx(slope, rel=1e-14)
        assert out["housing_acceleration"][1] == 0.0
        moved = out["housing_position"][1] - edge["housing_position"][1]
        assert moved == pytest.approx(slope * (outside - end), rel=1e-13)


def test_terms_add_up(kernel: Kernel) -> None:
    gearbox = gearbox_with(
        kernel,
        term(X, CONSTANT, 0.3),
        term(X, RATE, -2.0),
        term(X, HARMONIC, 0.1, frequency=5.0, phase=0.7),
        term(TURN_Z, RATE, 3.0),
    )
    out, angle, w = motion(gearbox, 0.4), 10 * np.pi * 0.4 + 0.7, 10 * np.pi
    assert out["housing_position"][0] == pytest.approx(0.3 - 0.8 + 0.1 * np.sin(angle), rel=1e-14)
    assert out["housing_velocity"][0] == pytest.approx(-2.0 + 0.1 * w * np.cos(angle), rel=1e-13)
    assert out["housing_acceleration"][0] == pytest.approx(-0.1 * w**2 * np.sin(angle), rel=1e-13)
    np.testing.assert_allclose(out["housing_angular_velocity"], [0, 0, 3.0], rtol=1e-15, atol=1e-15)


@pytest.mark.parametrize(
    ("bad", "reason"),
    [
        (term(X, "wobble", 1.0), "must be one of constant rate harmonic table"),
        (term(X, RATE, np.nan), "finite number"),
        (term(X, HARMONIC, 1.0, frequency=-1.0), "must be at least 0"),
        (term(X, SPLINE), "needs at least two knots"),
        (term(X, SPLINE, table=[(0.0, 1.0), (0.0, 2.0)]), "must increase, but 0 s follows 0 s"),
    ],
)
def test_a_bad_term_is_refused(kernel: Kernel, bad: Block, reason: str) -> None:
    with pytest.raises(GearboxError, match=reason) as refusal:
        gearbox_with(kernel, bad)
    assert refusal.value.code == INVALID_INPUT
    assert refusal.value.field.startswith("translation.")


def test_a_fixed_housing_has_no_pose(kernel: Kernel) -> None:
    gearbox = paper_gearbox(kernel)
    names = gearbox.outputs(gearbox.start())
    assert "bearing_force" in names
    assert not [name for name in names if name.startswith("housing_")]
