"""heyoka.py: Taylor series from expression trees, events located on the series.

heyoka has no Lambert W. Of the two ways to give it Johnson's force, W as a seventh state and the
start value with its correction, the first was 1.05 to 1.9 times faster. With w = W(-x):
w' = w x'/(x (1 + w)). The series has no start at h = 0, where x ln x is singular, so the case
starts at START with constant acceleration, which is wrong by 6e-11 of the scale of h' there.

The batch solves eight cases at once, whose torques differ by 1 % from one to the next; the first is
the paper's.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import heyoka as hy
import numpy as np
import paper_case as case
from numpy.typing import NDArray
from paper_case import SCALES, Array
from scipy.special import lambertw

START = 1e-8  # [s]
W_SCALE = 30.0
BATCH = 8
TORQUE, TEETH, SLOPE, SATURATION = range(4)  # rows of the parameters


def system(friction: float) -> tuple[list[tuple[Any, Any]], dict[str, Any]]:
    """Equations of the scaled states, and the expressions of the events."""
    y = hy.make_vars("theta", "omega", "psi", "psi_rate", "s", "s_rate", "w")
    theta, omega, psi, psi_rate, s, s_rate = (
        variable * scale for variable, scale in zip(y, SCALES, strict=False)
    )
    w = y[6] * W_SCALE
    distance = case.DISTANCE + s
    cosine = case.BASES / distance
    sine = hy.sqrt(1.0 - cosine * cosine)
    alpha = hy.acos(cosine)
    middle = case.BASES / (case.DISTANCE + 0.5 * s)
    depth = psi - s * hy.sqrt(1.0 - middle * middle)
    depth_rate = psi_rate - s_rate * sine
    length = distance * sine
    curvature_a = case.CURVATURE_START + case.BASE_A * (
        alpha - case.ALPHA_0 + theta - hy.par[TEETH] * case.PITCH
    )
    arm_a = curvature_a - 0.5 * depth
    arm_b = length - arm_a
    omega_b = (case.BASE_A * omega - psi_rate) * (1 / case.BASE_B)
    sliding = omega_b * arm_b - omega * arm_a - s_rate * cosine
    normal = -case.WIDTH * math.pi * case.E_STAR * depth / w + case.DAMPING * depth_rate
    torque_a, torque_b = normal * case.BASE_A, normal * case.BASE_B
    along = normal * sine
    if friction > 0:
        saturation = hy.par[SLOPE] * sliding * (1 / case.DELTA) + hy.par[SATURATION]
        tangential = -friction * normal * saturation
        torque_a += tangential * arm_a
        torque_b += tangential * arm_b
        along -= tangential * cosine
    acceleration_a = (hy.par[TORQUE] - torque_a) * (1 / case.INERTIA_A)
    acceleration_b = (torque_b - case.VISCOUS * omega_b) * (1 / case.INERTIA_B)
    support = case.STIFFNESS * s + case.SLIDER_DAMPING * s_rate
    # x'/x; the length of the line of action grows by s'/sin(alpha)
    sum_ = length + depth
    sum_rate = s_rate / sine + depth_rate
    w_rate = w / (1.0 + w) * (depth_rate / depth - sum_rate / sum_)
    rates = [
        omega,
        acceleration_a,
        psi_rate,
        case.BASE_A * acceleration_a - case.BASE_B * acceleration_b,
        s_rate,
        (along - support) * (1 / case.SLIDING_MASS),
    ]
    equations = [
        (variable, rate * (1 / scale))
        for variable, rate, scale in zip(y, rates, SCALES, strict=False)
    ]
    equations.append((y[6], w_rate * (1 / W_SCALE)))
    events = {
        "tooth": (theta - (hy.par[TEETH] + 1.0) * case.PITCH) * (1 / case.PITCH),
        "force": normal,
        "above": sliding * (1 / case.DELTA) - 1.0,
        "below": sliding * (1 / case.DELTA) + 1.0,
    }
    return equations, events


def start(torque: float) -> Array:
    """State at START."""
    acceleration = torque / case.INERTIA_A
    psi_rate = case.BASE_A * acceleration * START
    psi = psi_rate * START / 2
    length = math.sqrt(case.DISTANCE**2 - case.BASES**2)
    w = lambertw(-math.e * psi / (4 * (length + psi)), -1).real
    si = [acceleration * START**2 / 2, acceleration * START, psi, psi_rate, 0.0, 0.0]
    return np.append(np.array(si) / SCALES, w / W_SCALE)


def sliding_of(state: Array, teeth: float) -> float:
    """Sliding velocity [m/s] once so many teeth have passed."""
    return float(case.mesh(state, np.array([0.0, 0.0, teeth, 0.0]))[2])


def on_event(name: str, index: Callable[..., Any]) -> Callable[..., bool]:
    """What changes the parameters when the event fires; `index` selects the case of a batch."""

    def change(integrator: Any, _sign: int, *lane: int) -> bool:
        parameters, state = integrator.pars[index(*lane)], integrator.state[index(*lane)]
        if name == "tooth":
            parameters[TEETH] += 1
            if parameters.size == SLOPE:  # without friction
                return True
            sliding = sliding_of(state, parameters[TEETH])
            piece = float(sliding > case.DELTA) - float(sliding < -case.DELTA)
            parameters[SLOPE], parameters[SATURATION] = float(piece == 0), piece
        elif name == "force":
            return False
        elif parameters[SLOPE]:
            parameters[SLOPE], parameters[SATURATION] = 0.0, 1.0 if name == "above" else -1.0
        else:
            parameters[SLOPE], parameters[SATURATION] = 1.0, 0.0
        return True

    return change


def solver(method: str, friction: float, tolerance: float) -> Callable[[], NDArray[np.float64]]:
    """Return what integrates once and gives h at the outputs [m], of the first case of a batch."""
    equations, events = system(friction)
    watched = list(events)[: 4 if friction > 0 else 2]
    directions = {
        "tooth": hy.event_direction.positive,
        "force": hy.event_direction.negative,
    }
    batch = method == "batch"
    kind, index = (
        (hy.t_event_batch, lambda lane: (slice(None), lane))
        if batch
        else (hy.t_event, lambda: slice(None))
    )
    found = [
        kind(
            events[name],
            callback=on_event(name, index),
            direction=directions.get(name, hy.event_direction.any),
        )
        for name in watched
    ]
    torques = case.TORQUE * (1 + 0.01 * np.arange(BATCH)) if batch else np.array([case.TORQUE])
    first = np.array([start(torque) for torque in torques]).T.copy()
    discrete = np.zeros((4 if friction > 0 else 2, torques.size))
    discrete[TORQUE], discrete[SLOPE:SATURATION] = torques, 1.0
    times = case.grid()
    times[0] = START
    if batch:
        integrator = hy.taylor_adaptive_batch(
            equations, first, pars=discrete.copy(), t_events=found, tol=tolerance
        )
        times = np.repeat(times[:, None], BATCH, axis=1)
    else:
        first, discrete = first[:, 0], discrete[:, 0]
        integrator = hy.taylor_adaptive(
            equations, first, pars=discrete.copy(), t_events=found, tol=tolerance
        )

    def run() -> Array:
        integrator.state[:] = first
        integrator.pars[:] = discrete
        if batch:
            integrator.set_time(np.full(BATCH, START))
        else:
            integrator.time = START
        integrator.reset_cooldowns()
        *_, states = integrator.propagate_grid(times)
        depth = case.depths(states[:, :, 0] if batch else states)
        depth[0] = 0.0  # at rest, before START
        return depth

    return run
