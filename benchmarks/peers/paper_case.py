"""The paper's setup as y' = f(t, y), for programs that solve such systems.

Six states, each divided by its scale: theta, the angle that the pinion has turned in its
direction; omega, its rate; psi = r_bB times the gear's lag behind the kinematic ratio, which is the
transmission error [m]; psi'; s, the slider's displacement [m]; s'. Contact is the closed form of
docs/theory/theory.md, the force Johnson's by a start value and one correction (Fritsch, Shafer,
Crowley 1973). The discrete state is the number of teeth passed and the piece of the friction law.

The formulas are those of the kernel, written once more and compiled with numba.
tests/reference/gearbox_reference.py gets the same motion in another way.
"""

from __future__ import annotations

import math

import numpy as np
from numba import njit
from numpy.typing import NDArray

Array = NDArray[np.float64]

# examples/paper.yaml
TEETH_A, RATIO = 20, 1.5
PITCH_RADIUS_A = 0.2  # [m]
WIDTH = 0.1  # [m]
E_STAR = 2e11 / (2 * (1 - 0.3**2))  # [Pa]
DENSITY = 7800.0  # [kg/m^3]
TORQUE = 1.0  # on the pinion, in its direction [N m]
VISCOUS = 10.0  # on the gear [N m s]
DAMPING = 1e4  # of the contact [N s/m]
STIFFNESS, SLIDER_DAMPING = 1e9, 1e5  # of the slider [N/m, N s/m]
DELTA = 1e-4  # half width of the friction law's linear piece [m/s]

ALPHA_0 = 1.05 * math.atan(2 * math.pi / (TEETH_A * (1 + RATIO)))
BASE_A = PITCH_RADIUS_A * math.cos(ALPHA_0)
BASE_B = RATIO * BASE_A
BASES = BASE_A + BASE_B
DISTANCE = PITCH_RADIUS_A * (1 + RATIO)
PITCH = 2 * math.pi / TEETH_A
CURVATURE_START = (math.sqrt(DISTANCE**2 - BASES**2) - BASE_A * PITCH) / 2
MASS_A = DENSITY * math.pi * PITCH_RADIUS_A**2 * WIDTH
MASS_B = MASS_A * RATIO**2
INERTIA_A = MASS_A * PITCH_RADIUS_A**2 / 2
INERTIA_B = MASS_B * (RATIO * PITCH_RADIUS_A) ** 2 / 2
SLIDING_MASS = MASS_B + 10.0

DURATION, N_OUTPUTS = 5.0, 1001  # [s]; every 5 ms, both ends included
H_REFERENCE = 2.967e-9  # penetration at rest under the load [m]
# Of theta [rad], omega [rad/s], psi, psi' [m, m/s], s, s'. Theta decides when a tooth switches.
SCALES = np.array([1e-4, 1e-3, 3e-9, 2e-5, 3e-9, 2e-5])

# Pieces of the friction law beside 1 and -1: linear in between, or clamped anew at each call.
LINEAR, CLAMPED = 0, 2
# Rows of the parameters.
TORQUE_ROW, FRICTION_ROW, TEETH_ROW, PIECE_ROW = range(4)
TEETH_BY_ANGLE = -1.0  # number of teeth passed that means: by theta at each call


def grid() -> Array:
    """Times of the outputs [s]."""
    return np.linspace(0.0, DURATION, N_OUTPUTS)


def parameters(friction: float, located: bool, torque: float = TORQUE) -> Array:
    """Parameters at the start; not `located`: switches and kinks happen inside f."""
    if located:
        return np.array([torque, friction, 0.0, LINEAR])
    return np.array([torque, friction, TEETH_BY_ANGLE, CLAMPED])


@njit(cache=True, error_model="numpy")
def johnson(depth: float, curvature: float) -> float:
    """Elastic force [N] from the depth and rho_A + rho_B [m]; 0 for a gap."""
    if depth <= 0.0:
        return 0.0
    x = math.e * depth / (4 * curvature)
    excess = -math.log(x) - 1
    p = math.sqrt(2 * excess)
    v = p * (1.000047 + p * (1.583318 + p * (0.6421632 + p * 0.09953348)))
    v /= 1 + p * (1.249795 + p * 0.1994)
    z = v - math.log(1 + v) - excess
    q = 2 * v * (v - 2 / 3 * z)
    v -= (1 + v) * z * (q - z) / (v * (q - 2 * z))
    return WIDTH * math.pi * E_STAR * depth / (1 + v)


@njit(cache=True, error_model="numpy")
def gap_curvature(s: float) -> float:
    """R (inv alpha - inv alpha_0) [m], the integral of sin(alpha) over the centre distance.

    The midpoint rule leaves 600 s^2 of it, 1e-14 at the 5e-9 m of this case.
    """
    return s * math.sqrt(1 - (BASES / (DISTANCE + s / 2)) ** 2)


@njit(cache=True, error_model="numpy")
def mesh(y, p):  # type: ignore[no-untyped-def]
    """Depth, its rate, force before the clip, sliding velocity, lever arms, sin and cos alpha."""
    theta, omega = y[0] * SCALES[0], y[1] * SCALES[1]
    psi, psi_rate = y[2] * SCALES[2], y[3] * SCALES[3]
    s, s_rate = y[4] * SCALES[4], y[5] * SCALES[5]
    teeth = math.floor(theta / PITCH) if p[TEETH_ROW] < 0 else p[TEETH_ROW]
    distance = DISTANCE + s
    cosine = BASES / distance
    sine = math.sqrt(1 - cosine * cosine)
    alpha = math.acos(cosine)
    depth = psi - gap_curvature(s)
    depth_rate = psi_rate - s_rate * sine
    length = distance * sine
    curvature_a = CURVATURE_START + BASE_A * (alpha - ALPHA_0 + theta - teeth * PITCH)
    arm_a = curvature_a - depth / 2
    arm_b = length - curvature_a + depth / 2
    omega_b = (BASE_A * omega - psi_rate) / BASE_B
    sliding = omega_b * arm_b - omega * arm_a - s_rate * cosine
    force = johnson(depth, length + depth) + (DAMPING * depth_rate if depth > 0 else 0.0)
    return depth, force, sliding, arm_a, arm_b, sine, cosine, omega_b


@njit(cache=True, error_model="numpy")
def rhs(y, p, dy):  # type: ignore[no-untyped-def]
    """dy/dt of the scaled states."""
    _, force, sliding, arm_a, arm_b, sine, cosine, omega_b = mesh(y, p)
    normal = max(force, 0.0)
    piece = p[PIECE_ROW]
    if piece == CLAMPED:
        saturation = min(max(sliding / DELTA, -1.0), 1.0)
    elif piece == LINEAR:
        saturation = sliding / DELTA
    else:
        saturation = piece
    tangential = -p[FRICTION_ROW] * normal * saturation
    acceleration_a = (p[TORQUE_ROW] - normal * BASE_A - tangential * arm_a) / INERTIA_A
    acceleration_b = (normal * BASE_B + tangential * arm_b - VISCOUS * omega_b) / INERTIA_B
    s, s_rate = y[4] * SCALES[4], y[5] * SCALES[5]
    dy[0] = y[1] * (SCALES[1] / SCALES[0])
    dy[1] = acceleration_a / SCALES[1]
    dy[2] = y[3] * (SCALES[3] / SCALES[2])
    dy[3] = (BASE_A * acceleration_a - BASE_B * acceleration_b) / SCALES[3]
    dy[4] = y[5] * (SCALES[5] / SCALES[4])
    support = STIFFNESS * s + SLIDER_DAMPING * s_rate
    dy[5] = (normal * sine - tangential * cosine - support) / (SLIDING_MASS * SCALES[5])


@njit(cache=True, error_model="numpy")
def roots(y, p, g):  # type: ignore[no-untyped-def]
    """Event functions: next tooth, force reaching 0, sliding velocity leaving +delta, -delta."""
    _, force, sliding, _, _, _, _, _ = mesh(y, p)
    g[0] = y[0] * SCALES[0] - (p[TEETH_ROW] + 1) * PITCH
    g[1] = force
    g[2] = sliding / DELTA - 1
    g[3] = sliding / DELTA + 1


N_ROOTS = 4


def root_directions(p: Array) -> list[int]:
    """Which crossing of each root function counts on the present piece of the friction law."""
    piece = p[PIECE_ROW]
    return [1, -1, -1 if piece > 0 else 1, 1 if piece < 0 else -1]


def pass_event(y: Array, p: Array, root: int) -> None:
    """Change the discrete state after a root; a tooth switch moves the contact point."""
    if root == 0:
        p[TEETH_ROW] += 1
        sliding = mesh(y, p)[2]
        p[PIECE_ROW] = float(sliding > DELTA) - float(sliding < -DELTA)
    elif root == 1:
        raise RuntimeError("contact was lost, which does not happen in the paper's setup")
    elif p[PIECE_ROW] == LINEAR:
        p[PIECE_ROW] = 1.0 if root == 2 else -1.0
    else:
        p[PIECE_ROW] = LINEAR


def depths(states: Array) -> Array:
    """Penetration h [m] of scaled states, shape (n, 6)."""
    psi, s = states[:, 2] * SCALES[2], states[:, 4] * SCALES[4]
    return psi - s * np.sqrt(1 - (BASES / (DISTANCE + s / 2)) ** 2)
