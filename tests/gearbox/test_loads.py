"""Every kind of load in the table of the kernel: its derivatives, its power, its lanes, its rows.

The tests take the kinds from load_samples: a kind without a sample fails the first of them.
"""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from gearbox.test_housing_jacobian import HOUSINGS
from kernel.description import Block, Kind, kinds
from kernel.gearbox import LOADED, Gearbox, GearboxError, State
from kernel.gearbox_cases import in_mode
from kernel.gearbox_description import (
    CLOSED_FORM,
    SPEEDS,
    STEADY,
    TORQUE,
    load,
    load_like,
    mesh,
    shaft,
    support_like,
    wheel,
)
from kernel.jacobian import check_jacobian
from kernel.kernel import INVALID_INPUT, Kernel
from kernel.radau import LANES, model
from load_samples import SAMPLES, SUPPORTS

HARMONIC = {"kind": "harmonic", "mean": 0.5, "amplitude": 3.0}
INERTIA = 0.02
EVERY_LOAD = pytest.mark.parametrize("name", SAMPLES)


def train(
    kernel: Kernel,
    name: str,
    housing: Block | None = None,
    support: dict[str, Any] | None = None,
    *,
    against_housing: bool = False,
) -> Gearbox:
    """Three wheels, two of them on an elastic shaft; the sample acts on the last."""
    wheels = [
        wheel(teeth=20, pitch_radius=0.1),
        wheel(teeth=33, support=support_like(kernel, support or SUPPORTS["bearing"])),
        wheel(teeth=0, pitch_radius=0.1),
    ]
    loads = [
        load(0, TORQUE, -7.0),
        load(2, TORQUE, 0.7),
        load_like(kernel, 2, SAMPLES[name], against_housing=against_housing),
    ]
    meshes = [mesh(kernel, 0, 1, centre_line_angle=0.5, friction=0.1, tracking=CLOSED_FORM)]
    return Gearbox(kernel, wheels, loads, meshes, housing, shafts=[shaft(1, 2, 3e4, 5.0)])


def stirred(gearbox: Gearbox, seed: int = 3) -> State:
    """Return a moving state in contact, turns from the start, between the knots of a table."""
    state = in_mode(gearbox, np.random.default_rng(seed), (LOADED, 0))
    state.t = 0.7
    state.y[gearbox.index("reference_speed")] = 4.0
    gearbox.put(state, "knots_passed", 2)  # if there is a table
    state.yp = gearbox.derivative(state)
    return state


def all_given(infos: list[Kind], samples: dict[str, dict[str, Any]]) -> None:
    """Check that every parameter of every kind is given in a sample."""
    for info in infos:
        of_kind = [sample for sample in samples.values() if sample["kind"] == info.name]
        assert of_kind, f"tests/load_samples.py has no sample of kind {info.name}"
        given = {key for sample in of_kind for key in sample}
        assert given == {"kind", *(row.key for row in info.rows)}


def test_every_kind_of_load_has_a_sample(kernel: Kernel):
    all_given(kinds(kernel.library, "load"), SAMPLES)


def test_every_kind_of_support_has_a_sample(kernel: Kernel):
    all_given(kinds(kernel.library, "support"), SUPPORTS)


@pytest.mark.parametrize("name", SUPPORTS)
@pytest.mark.parametrize("body", [None, "gravity", "prescribed"])
def test_every_support_has_its_rates_in_lanes_and_its_jacobian(
    kernel: Kernel, name: str, body: str | None
):
    gearbox = train(kernel, "torque", None if body is None else HOUSINGS[body], SUPPORTS[name])
    state = stirred(gearbox)
    check_jacobian(gearbox, state)
    rates, jacobian = model(gearbox, [state] * LANES)
    np.testing.assert_array_equal(rates[0], state.yp)
    state.yp[:] = 0
    np.testing.assert_array_equal(jacobian, -gearbox.jacobian(state, 0.0))


@EVERY_LOAD
@pytest.mark.parametrize("against_housing", [False, True], ids=["ground", "housing"])
@pytest.mark.parametrize("body", [None, "gravity", "prescribed"])
def test_the_jacobian_of_every_load_is_the_derivative_of_the_residual(
    kernel: Kernel, name: str, body: str | None, against_housing: bool
):
    """Those in a mounted housing are in test_housing_jacobian."""
    housing = None if body is None else HOUSINGS[body]
    gearbox = train(kernel, name, housing, against_housing=against_housing)
    check_jacobian(gearbox, stirred(gearbox))


@EVERY_LOAD
@pytest.mark.parametrize("body", [None, "gravity", "prescribed"])
def test_radau_has_the_rates_and_the_jacobian_of_every_load(
    kernel: Kernel, name: str, body: str | None
):
    """In lanes if supported: at eight times, speeds and angles."""
    gearbox = train(kernel, name, None if body is None else HOUSINGS[body])
    random = np.random.default_rng(4)
    states = [stirred(gearbox).copy() for _ in range(LANES)]
    for state in states[1:]:
        state.t += 0.01 * random.random()
        state.y *= 1 + 1e-4 * random.normal(size=len(state.y))
    rates, jacobian = model(gearbox, states)
    for lane, state in enumerate(states):
        np.testing.assert_array_equal(rates[lane], gearbox.derivative(state))
    states[0].yp[:] = 0
    np.testing.assert_array_equal(jacobian, -gearbox.jacobian(states[0], 0.0))


@EVERY_LOAD
def test_the_work_of_every_load_is_its_torque_times_the_speed(kernel: Kernel, name: str):
    gearbox = train(kernel, name)
    state = stirred(gearbox)
    values = gearbox.outputs(state)
    power = float(np.sum(values["load_torque"] * values["angular_velocity"]))
    power += float(np.sum(values.get("load_loss", 0.0)))  # the power of a loss is dissipated
    rate = state.yp[gearbox.names.index("load_work")]
    np.testing.assert_allclose(rate, power, rtol=1e-12)  # sums of three products


# ---- the drive ----


@pytest.mark.parametrize("against_housing", [False, True], ids=["ground", "housing"])
@pytest.mark.parametrize("body", [None, "gravity", "prescribed", "mounted"])
def test_a_drive_at_no_speed_and_no_torque_is_a_viscous_load_to_the_bit(
    kernel: Kernel, monkeypatch: pytest.MonkeyPatch, body: str | None, against_housing: bool
):
    monkeypatch.setitem(SAMPLES, "drive", {"kind": "drive", "speed": 0.0, "slope": -5.0})
    housing = None if body is None else HOUSINGS[body]
    reported = []
    for name in ("viscous", "drive"):
        gearbox = train(kernel, name, housing, against_housing=against_housing)
        state = gearbox.start(SPEEDS, speeds=[-6.0, 3.7, 3.5])
        state.t = 0.7
        reported.append((gearbox.derivative(state), gearbox.jacobian(state, 3.0), gearbox.scales()))
    for viscous, drive in zip(*reported, strict=True):
        for a, b in zip(viscous, drive, strict=True):
            np.testing.assert_array_equal(a, b)


# ---- the loss ----

KNOTS, TORQUES = [2.0, 5.0, 30.0], [0.8, 3.0, 1.2]


def losing(kernel: Kernel, omega: float, **fields: Any) -> tuple[Gearbox, State]:
    """Return a pair without contact, its second wheel at a speed under a loss."""
    sample = {"kind": "loss", "speed": KNOTS, "torque": TORQUES, **fields}
    wheels = [wheel(teeth=20, pitch_radius=0.1), wheel(teeth=33, inertia=INERTIA)]
    gearbox = Gearbox(kernel, wheels, [load_like(kernel, 1, sample)], [mesh(kernel, 0, 1)])
    state = gearbox.start(SPEEDS, speeds=[-omega * 33 / 20, omega], gaps=[1e-6])
    return gearbox, state


@pytest.mark.parametrize("sign", [1, -1])
@pytest.mark.parametrize("size", [0.0, 1e-12, 0.5, 2.0, 3.1, 5.0, 17.0, 30.0, 31.0, 1e4])
def test_a_loss_is_against_the_motion_and_linear_between_its_knots(
    kernel: Kernel, size: float, sign: int
):
    """From 0 at standstill to the first knot, and constant beyond the last."""
    gearbox, state = losing(kernel, sign * size)
    torque = np.interp(size, [0.0, *KNOTS], [0.0, *TORQUES])
    values = gearbox.outputs(state)
    # sums of three parts of the table; the speed is that of the reference wheel by the ratio
    np.testing.assert_allclose(values["load_torque"], [0.0, -sign * torque], rtol=1e-14)
    np.testing.assert_allclose(values["load_loss"], [0.0, torque * size], rtol=1e-14)
    assert INERTIA * acceleration(gearbox, state) == pytest.approx(-sign * torque, rel=1e-13)
    rates = dict(zip(gearbox.names, gearbox.derivative(state), strict=True))
    assert rates["dissipated_energy"] == pytest.approx(torque * size, rel=1e-14)
    assert abs(rates["load_work"]) <= 1e-15 * torque * size


def test_a_loss_has_its_stated_slope_through_standstill(kernel: Kernel):
    values = [
        losing(kernel, speed)[0].outputs(losing(kernel, speed)[1])["load_torque"][1]
        for speed in (-1e-9, 1e-9)
    ]
    assert (values[1] - values[0]) / 2e-9 == pytest.approx(-TORQUES[0] / KNOTS[0], rel=1e-12)


@pytest.mark.parametrize("zero", [True, False], ids=["with", "without"])
def test_a_first_knot_at_standstill_is_the_implied_one(kernel: Kernel, zero: bool):
    fields = {"speed": [0.0, *KNOTS], "torque": [0.0, *TORQUES]} if zero else {}
    gearbox, state = losing(kernel, 1.3, **fields)
    expected = np.interp(1.3, [0.0, *KNOTS], [0.0, *TORQUES])
    assert gearbox.outputs(state)["load_torque"][1] == pytest.approx(-expected, rel=1e-15)


def test_the_power_of_a_loss_is_dissipated_also_at_a_prescribed_speed(kernel: Kernel):
    """The work of the load that prescribes the speed supplies it."""
    loss = {"kind": "loss", "speed": KNOTS, "torque": TORQUES}
    wheels = [wheel(teeth=20, pitch_radius=0.1), wheel(teeth=33, inertia=INERTIA)]
    loads = [load_like(kernel, 1, {"kind": "speed", "value": 17.0}), load_like(kernel, 1, loss)]
    gearbox = Gearbox(kernel, wheels, loads, [mesh(kernel, 0, 1)])
    state = gearbox.start(SPEEDS, speeds=[-17.0 * 33 / 20, 17.0], gaps=[1e-6])
    rates = dict(zip(gearbox.names, gearbox.derivative(state), strict=True))
    power = 17.0 * np.interp(17.0, KNOTS, TORQUES)
    assert rates["dissipated_energy"] == pytest.approx(power, rel=1e-13)
    assert rates["load_work"] == pytest.approx(power, rel=1e-13)
    check_jacobian(gearbox, state)


def test_only_gearboxes_with_a_loss_have_its_output(kernel: Kernel):
    gearbox = train(kernel, "viscous")
    assert "load_loss" not in gearbox.outputs(stirred(gearbox))


@pytest.mark.parametrize(
    ("fields", "reason"),
    [
        ({"speed": [0.0, 3.0], "torque": [0.5, 1.0]}, "at standstill must be 0, but is 0.5 N m"),
        ({"speed": [2.0, 1.0], "torque": [0.5, 1.0]}, "must increase"),
        ({"speed": [-1.0, 1.0], "torque": [0.5, 1.0]}, "at least 0"),
        ({"speed": [1.0, 2.0], "torque": [0.5, -1.0]}, "at least 0"),
        ({"speed": [1.0, 2.0], "torque": [0.5]}, "as many values as knots"),
    ],
)
def test_a_bad_loss_is_refused(kernel: Kernel, fields: dict[str, Any], reason: str):
    with pytest.raises(GearboxError, match=reason) as refusal:
        losing(kernel, 1.0, **fields)
    assert refusal.value.code == INVALID_INPUT


# ---- the harmonic torque ----


def turning(kernel: Kernel, turns: int, angle: float, **fields: float) -> tuple[Gearbox, State]:
    """Return a pair without contact, after revolutions of its first wheel."""
    wheels = [wheel(teeth=20, pitch_radius=0.1), wheel(teeth=33, inertia=INERTIA)]
    gearbox = Gearbox(
        kernel, wheels, [load_like(kernel, 1, {**HARMONIC, **fields})], [mesh(kernel, 0, 1)]
    )
    state = gearbox.start(gaps=[1e-6])
    state.integers[0] = turns
    state.y[gearbox.index("reference_angle")] = -angle * 33 / 20
    return gearbox, state


def acceleration(gearbox: Gearbox, state: State) -> float:
    yp = gearbox.derivative(state)
    names = gearbox.names
    reference = yp[names.index("reference_speed")]
    return float(yp[names.index("speed_deviation_1")] - 20 / 33 * reference)


@pytest.mark.parametrize("phase", [0.0, 90.0, -30.0, 400.0])
@pytest.mark.parametrize("t", [0.0, 0.013, 1e3 + 1 / 3])
def test_a_harmonic_torque_over_time_is_the_sine(kernel: Kernel, t: float, phase: float):
    gearbox, state = turning(kernel, 0, 0.0, frequency=50.0, phase=phase)
    state.t = t
    expected = 0.5 + 3 * np.sin(2 * np.pi * ((50.0 * t) % 1) + np.radians(phase))
    # the product 50 t is rounded: 1e-16 of 5e4 cycles
    assert INERTIA * acceleration(gearbox, state) == pytest.approx(expected, abs=1e-10)


@pytest.mark.parametrize("order", [1.0, 2.0, 33.0, 0.5, 2.25])
@pytest.mark.parametrize("turns", [0, 1, -3, 1000, 2**31 - 2])
def test_a_harmonic_torque_by_order_is_the_sine_of_the_whole_angle(
    kernel: Kernel, turns: int, order: float
):
    """After two thousand million revolutions as accurate as at the start: exact fractions."""
    gearbox, state = turning(kernel, turns, 0.3, order=order, phase=20.0)
    psi = state.y[gearbox.names.index("angle_deviation_1")]
    whole = (int(4 * order) * (-20) * turns) % (4 * 33) / (4 * 33)  # of a cycle, exact
    expected = 0.5 + 3 * np.sin(2 * np.pi * whole + order * (0.3 + psi) + np.radians(20.0))
    assert INERTIA * acceleration(gearbox, state) == pytest.approx(expected, abs=1e-12)


def test_a_revolution_of_the_reference_wheel_leaves_the_torque_continuous(kernel: Kernel):
    gearbox, state = turning(kernel, 7, 0.0, order=3.7)
    state.y[gearbox.index("reference_angle")] = 2 * np.pi * (1 + 1e-15)
    before = acceleration(gearbox, state)
    after, _ = gearbox.apply(state)
    assert after.integers[0] == 8
    assert acceleration(gearbox, after) == pytest.approx(before, rel=1e-12)


def steady(kernel: Kernel, sample: dict[str, object]) -> Gearbox:
    wheels = [wheel(teeth=20, pitch_radius=0.1), wheel(teeth=33)]
    loads = [
        load_like(kernel, 0, sample),
        load_like(kernel, 1, {"kind": "viscous", "coefficient": 2.0}),
    ]
    return Gearbox(kernel, wheels, loads, [mesh(kernel, 0, 1, damping=1e4)])


@pytest.mark.parametrize("by", [{"frequency": 50.0}, {"order": 3.0}], ids=["time", "order"])
def test_steady_states_scales_and_modes_take_the_mean(kernel: Kernel, by: dict[str, float]):
    """Bitwise equal to those of the constant torque, for any amplitude."""
    mean = steady(kernel, {"kind": "torque", "value": -7.0})
    other = steady(
        kernel, {"kind": "harmonic", "mean": -7.0, "amplitude": 60.0, "phase": 33.0, **by}
    )
    expected, state = mean.start(STEADY), other.start(STEADY)
    np.testing.assert_array_equal(state.y, expected.y)
    for a, b in zip(mean.scales(), other.scales(), strict=True):
        np.testing.assert_array_equal(a, b)
    assert not np.array_equal(state.yp, expected.yp)  # it oscillates from the start
