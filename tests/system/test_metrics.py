"""Metrics of a case over whole periods: against other programs and independent quadrature."""

from __future__ import annotations

import math
from itertools import pairwise
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.interpolate import CubicSpline

from system.cases import STEEL
from system.runs import Run, Runs

Floats = NDArray[np.float64]
HARMONICS = np.arange(1, 11)


def number(run: Run, name: str, element: int = 0) -> float:
    return float(run.history[f"window_{name}"].values.ravel()[element])


# ---- rectangular mesh stiffness ----

TEETH, MODULE, PRESSURE_ANGLE, STIFFNESS, FORCE, RATIO = 30, 3e-3, math.radians(20), 3e8, 2.0, 1.638
BASE = TEETH * MODULE / 2 * math.cos(PRESSURE_ANGLE)
INERTIA = 1e-3


def rectangular(omega: float, pitches: int, window: int, integrator: str) -> dict[str, Any]:
    """One degree of freedom with stiffness k or 2 k, by independent pairs.

    The driving wheel has a constant speed. The driven wheel has so little load that no pair enters
    early: F/(k p_b) is 7.5e-7.
    """
    base_pitch = math.pi * MODULE * math.cos(PRESSURE_ANGLE)
    distance = TEETH * MODULE
    tip = math.hypot(BASE, (RATIO * base_pitch + distance * math.sin(PRESSURE_ANGLE)) / 2)
    frequency = omega * math.sqrt(STIFFNESS * RATIO) * BASE / math.sqrt(INERTIA)
    pitch = 2 * math.pi / frequency
    wheel = {
        **{"teeth": TEETH, "module": MODULE, "tip_diameter": 2 * tip, "bore": 0.02, "width": 0.02},
        **{"thickness_allowance": -1e-4, "material": "steel", "inertia": INERTIA},
    }
    loads = (
        {"kind": "speed", "value": -frequency / TEETH},
        {"kind": "torque", "value": -FORCE * BASE},
    )
    return {
        "format": 1,
        "materials": {"steel": dict(STEEL)},
        "wheels": [
            {"name": name, **wheel, "loads": [load]} for name, load in zip("ab", loads, strict=True)
        ],
        "meshes": [
            {
                **{"name": "ab", "driving": "a", "driven": "b", "driving_rotation": "clockwise"},
                **{"centre_line_angle": 0, "centre_distance": distance},
                "contact": {"law": "linear", "stiffness": STIFFNESS},
                "damping": {"law": "ratio", "value": 0.03},
            }
        ],
        "simulation": {
            **{"duration": (pitches + 0.25) * pitch, "output_interval": pitch * pitches / 10},
            **{"tolerance": 1e-10, "initial": {"kind": "steady"}, "integrator": integrator},
            "metrics": {"from": (pitches - window - 0.5) * pitch},
        },
    }


@pytest.mark.parametrize("integrator", ["radau", "ida"])
@pytest.mark.parametrize(
    ("omega", "expected", "parts"),
    [(0.7, 0.363006711, False), (1.3, 0.182425960, False), (2.0, 0.652445783, True)],
)
def test_rectangular_stiffness_has_the_deviation_of_an_independent_program(
    runs, omega, expected, parts, integrator
):
    """At twice the mean-stiffness frequency the flanks separate, with a period of two pitches.

    Values of an event-driven integration of the independent oscillator; F/(k p_b) shifts entry and
    exit by 1e-6 of a pitch.
    """
    run = runs(rectangular(omega, 700, 60, integrator))
    assert run.exit_code == 0, run.messages
    deviation = number(run, "transmission_error_standard_deviation") / (FORCE / STIFFNESS)
    assert deviation == pytest.approx(expected, rel=1e-5)
    assert (number(run, "share_no_contact") > 0) == parts
    assert number(run, "normal_force_mean") == pytest.approx(FORCE, rel=1e-9)
    assert number(run, "share_coast_flanks") == 0
    shares = [number(run, f"share_{n}") for n in ("one_pair", "two_pairs", "more_pairs")]
    if not parts:
        np.testing.assert_allclose(shares, [2 - RATIO, RATIO - 1, 0], atol=2e-6)


def test_the_share_of_coast_flanks_is_nan_where_there_are_none(runs):
    case = oscillator(1.0, -1e-5)
    case["meshes"][0].pop("backlash")
    for name in ("duration", "output_interval"):
        case["simulation"][name] /= 20
    case["simulation"]["metrics"] = {"from": 0}
    found = runs(case)
    assert found.exit_code == 0, found.messages
    assert np.isnan(number(found, "share_coast_flanks"))


# ---- backlash ----

MASS, CONTACT, HALF_GAP = 0.23, 3.8e8, 1e-4


def oscillator(omega: float, gap: float) -> dict[str, Any]:
    """A mass between two stops, preloaded by 0.1 k b, with a harmonic force of 0.05 k b."""
    base = 0.075 * math.cos(PRESSURE_ANGLE)
    frequency = omega * math.sqrt(CONTACT / MASS) / (2 * math.pi)
    period, unit = 1 / frequency, CONTACT * HALF_GAP * base
    speed = 2 * math.pi * frequency / 20  # one pitch per period
    return {
        "format": 1,
        "materials": {"steel": dict(STEEL)},
        "wheels": [
            {
                **{"name": "a", "teeth": 20, "pitch_radius": 0.05, "width": 0.02},
                **{"material": "steel", "centre": [0, 0]},
                "loads": [{"kind": "speed", "value": -speed}],
            },
            {
                **{"name": "b", "teeth": 30, "width": 0.02, "material": "steel"},
                "inertia": MASS * base**2,
                "loads": [
                    {
                        **{"kind": "harmonic", "mean": -0.1 * unit, "amplitude": -0.05 * unit},
                        "frequency": frequency,
                    }
                ],
            },
        ],
        "meshes": [
            {
                **{"name": "ab", "driving": "a", "driven": "b", "driving_rotation": "clockwise"},
                **{"centre_line_angle": 0, "pressure_angle": 20, "backlash": 2 * HALF_GAP},
                "contact": {"law": "linear", "stiffness": CONTACT},
                "damping": {
                    "law": "linear",
                    "coefficient": 2 * 0.05 * math.sqrt(CONTACT * MASS),
                },
            }
        ],
        "simulation": {
            **{"duration": 500 * period, "output_interval": 50 * period, "tolerance": 1e-10},
            "initial": {
                **{"kind": "speeds", "speeds": {"a": -speed, "b": speed * 20 / 30}},
                "gaps": {"ab": gap},
            },
            "metrics": {"from": 399.5 * period},
        },
    }


@pytest.mark.parametrize(
    ("omega", "gap", "expected"),
    [(0.7, 5e-5, 0.3208), (1.0, -1e-5, 0.1342)],
)
def test_backlash_oscillator_has_the_deviation_of_an_independent_program(
    runs, omega, gap, expected
):
    """At 0.7 a motion without impacts exists, too: the run starts apart to reach the other."""
    run = runs(oscillator(omega, gap))
    assert run.exit_code == 0, run.messages
    deviation = number(run, "transmission_error_standard_deviation") / HALF_GAP
    assert deviation == pytest.approx(expected, rel=1e-3)
    assert number(run, "impacts") == 100  # one per period
    assert number(run, "share_coast_flanks") == 0


@pytest.mark.parametrize("omega", np.linspace(0.2, 0.45, 16).tolist())
def test_extremes_of_one_period_are_those_of_the_linear_oscillator(runs, omega):
    """Closed form, flanks always in contact; a peak may be anywhere in an integration step."""
    case = oscillator(omega, -1e-5)
    period = 2 * math.pi / (omega * math.sqrt(CONTACT / MASS))
    case["simulation"].update(duration=60.3 * period, metrics={"from": 58.6 * period})
    run = runs(case)
    assert run.exit_code == 0, run.messages
    assert int(run.history["window_periods"]) == 1
    swing = 0.05 * HALF_GAP / math.hypot(1 - omega**2, 2 * 0.05 * omega)
    mean = number(run, "transmission_error_mean")
    assert abs(mean) == pytest.approx(0.1 * HALF_GAP, rel=1e-8)
    for which, sense in (("max", 1), ("min", -1)):
        extreme = number(run, f"transmission_error_{which}")
        assert extreme == pytest.approx(mean + sense * swing, abs=1e-7 * swing), which


# ---- independent quadrature ----

FINE = (
    "meshes.0.friction={law: none}",  # sliding would start and stop within a microsecond
    "simulation.duration=6.7e-3",
    "simulation.output_interval=2e-7",
    "simulation.tolerance=1e-10",
    "simulation.metrics={from: 1e-3}",
)


@pytest.fixture(scope="module")
def fine(runs: Runs) -> Run:
    """A mesh whose force jumps at entry and exit of pairs, with very many outputs."""
    run = runs("spur-pair.yaml", *FINE)
    assert run.exit_code == 0, run.messages
    assert int(run.history["window_periods"]) == 2
    return run


def pieces(run: Run, values: Floats) -> list[tuple[float, float, CubicSpline]]:
    """Splines between the events of a window, extrapolated by a fraction of an output step."""
    begin, end = (float(run.history[f"window_{which}"]) for which in ("begin", "end"))
    time = run.history["time"].values
    events = np.unique(run.events["time"].values)
    borders = [begin, *events[(events > begin) & (events < end)], end]
    limits = [-np.inf, *events, np.inf]
    found = []
    for left, right in pairwise(borders):
        before = max(t for t in limits if t <= left)
        after = min(t for t in limits if t >= right)
        inside = (time > before) & (time < after) & (time > left - 1e-5) & (time < right + 1e-5)
        assert inside.sum() > 10, "two events are too near to each other for this check"
        found.append((left, right, CubicSpline(time[inside], values[inside])))
    return found


def integral(run: Run, values: Floats) -> float:
    """Integral over the window of a quantity that is smooth between events."""
    return float(sum(s.integrate(left, right) for left, right, s in pieces(run, values)))


def harmonics(run: Run, values: Floats) -> Floats:
    """2/X times the integral of x exp(2 pi i n xi) over xi, along the window."""
    history = run.history
    position = -history["flank"].values[0] * history["teeth"].values[0] / (2 * math.pi)
    rate = position * history["angular_velocity"].values[:, 0]
    xi = position * history["angle"].values[:, 0] + float(history["start_position"].values[0])
    pitches = integral(run, rate)
    assert pitches == pytest.approx(int(history["window_periods"]), abs=1e-9)
    found = []
    for n in HARMONICS:
        wave = [f(2 * math.pi * n * xi) for f in (np.cos, np.sin)]
        found.append(
            sum(integral(run, values * rate * w) * i for w, i in zip(wave, (1, 1j), strict=True))
        )
    return 2 / pitches * np.array(found)


@pytest.mark.parametrize("quantity", ["transmission_error", "normal_force", "angular_acceleration"])
def test_numbers_are_integrals_between_the_events(fine, quantity):
    """To 1e-8 of the quantity, the accuracy of splines at steps of 2e-7 s."""
    values = fine.history[quantity].values[:, 0]
    span = float(fine.history["window_end"]) - float(fine.history["window_begin"])
    mean = integral(fine, values) / span
    moments = {k: integral(fine, (values - mean) ** k) / span for k in (2, 4)}
    size = math.sqrt(moments[2] + mean**2)
    for name, expected, scale in (
        ("mean", mean, size),
        ("standard_deviation", math.sqrt(moments[2]), size),
        ("rms", size, size),
        ("kurtosis", moments[4] / moments[2] ** 2, moments[4] / moments[2] ** 2),
    ):
        assert number(fine, f"{quantity}_{name}") == pytest.approx(expected, abs=1e-8 * scale), name
    amplitude = fine.history[f"window_{quantity}_amplitude"].values[0]
    phase = fine.history[f"window_{quantity}_phase"].values[0]
    reported = amplitude * np.exp(1j * phase)
    np.testing.assert_allclose(reported, harmonics(fine, values), atol=1e-8 * size)


def test_extremes_are_those_of_very_many_outputs(fine):
    history = fine.history
    inside = (history["time"] >= history["window_begin"]) & (
        history["time"] <= history["window_end"]
    )
    for quantity in ("transmission_error", "normal_force", "angular_acceleration"):
        values = history[quantity].values[inside.values, 0]
        size = np.ptp(values)
        high, low = (number(fine, f"{quantity}_{end}") for end in ("max", "min"))
        # a peak just after an event may be between two outputs
        assert values.max() - 1e-7 * size <= high <= values.max() + 1e-3 * size
        assert values.min() - 1e-3 * size <= low <= values.min() + 1e-7 * size
        assert number(fine, f"{quantity}_peak_to_peak") == pytest.approx(high - low, rel=1e-12)
    force = history["normal_force"].values[inside.values, 0]
    assert number(fine, "dynamic_factor") == pytest.approx(
        number(fine, "normal_force_max") / number(fine, "normal_force_mean"), rel=1e-12
    )
    assert number(fine, "dynamic_factor") == pytest.approx(force.max() / force.mean(), rel=1e-3)


def numbers(run: Run) -> dict[str, Floats]:
    return {
        str(name): variable.values
        for name, variable in run.history.data_vars.items()
        if str(name).startswith("window_")
    }


@pytest.mark.parametrize("example", ["spur-pair", "compliant-pair", "two-stage-gears", "rattle"])
def test_both_integrators_find_the_same(runs, example):
    """In lanes and one by one; to the accuracy of accelerations at a tolerance of 1e-9."""
    found = [
        numbers(runs(f"{example}.yaml", "simulation.metrics={}", f"simulation.integrator={which}"))
        for which in ("radau", "ida")
    ]
    for name, values in found[0].items():
        size = np.nanmax(np.abs(values), initial=0.0)
        if name.startswith("window_angular_acceleration_mean"):
            size = np.nanmax(found[0]["window_angular_acceleration_rms"])
        if name.endswith("phase"):  # the phase of a negligible amplitude is noise
            amplitude = found[0][name.replace("phase", "amplitude")]
            clear = amplitude > 1e-3 * amplitude.max(axis=-1, keepdims=True)
            difference = np.where(clear, values - found[1][name], 0)
            np.testing.assert_allclose(np.sin(difference / 2), 0, atol=1e-4, err_msg=name)
            continue
        np.testing.assert_allclose(
            found[1][name], values, rtol=1e-5, atol=1e-5 * size, err_msg=name
        )


def test_numbers_do_not_depend_on_the_outputs(runs):
    many, few = (
        numbers(runs("rattle.yaml", "simulation.metrics={}", f"simulation.output_interval={dt}"))
        for dt in (1e-4, 1e-2)
    )
    for name, values in many.items():
        np.testing.assert_array_equal(values, few[name], err_msg=name)


@pytest.mark.parametrize("start", ["", ", position: 0.6", ", position: 7.3"])
@pytest.mark.parametrize("wheel", ["pinion", "gear"])
def test_turns_count_from_where_the_wheel_starts(runs, start, wheel):
    """In a window from 0 the first revolution starts at 0, for any start position in a pitch."""
    run = runs(
        "spur-pair.yaml",
        f"simulation.initial={{kind: steady{start}}}",
        f"simulation.metrics={{from: 0, turns_of: {wheel}}}",
        f"simulation.duration={0.0421 if wheel == 'pinion' else 0.0421 * 34 / 19}",
    )
    assert float(run.history["window_begin"]) == 0
    assert int(run.history["window_periods"]) == 1


def test_a_turn_has_as_many_pitches_as_teeth(runs):
    start = "simulation.initial={kind: steady, position: 0}"
    turns = runs("spur-pair.yaml", start, "simulation.metrics={from: 0, turns_of: pinion}").history
    speed = abs(float(turns["angular_velocity"].values[0, 0]))
    span = float(turns["window_end"]) - float(turns["window_begin"])
    assert int(turns["window_periods"]) == 1
    assert span == pytest.approx(2 * math.pi / speed, rel=2e-3)  # the speed at one instant
    pitches = runs("spur-pair.yaml", start, "simulation.metrics={from: 0, to: 0.0405}").history
    assert int(pitches["window_periods"]) == int(turns["teeth"].values[0])
    for name in ("transmission_error_amplitude", "normal_force_mean"):
        reported = turns[f"window_{name}"].values
        np.testing.assert_allclose(
            reported, pitches[f"window_{name}"].values, rtol=1e-9, atol=1e-16
        )


def test_impacts_are_closings_after_a_flight(runs):
    """Counted from the events and the outputs before them, with the speeds of the states there."""
    run = runs("rattle.yaml", "simulation.metrics={}", "simulation.output_interval=1e-5")
    history, events, radius = run.history, run.events, run.history["base_radius"].values
    begin, end = (float(history[f"window_{which}"]) for which in ("begin", "end"))
    closings = np.flatnonzero(events["kind"].values == "contact_closed")
    speeds, seen = [], -1
    for i in closings:
        time = float(events["time"].values[i])
        row = int(np.searchsorted(history["time"].values, time)) - 1
        in_flight = history["pairs_in_contact"].values[row, 0] == 0 and row != seen
        seen = row
        if in_flight and begin < time <= end:
            speeds.append(radius[1] * abs(float(events["speed_deviation_1"].values[i, 0])))
    assert number(run, "impacts") == len(speeds) > 20
    assert number(run, "impact_speed_max") == pytest.approx(max(speeds), rel=1e-9)
    energy = float(history["reference_mass"].values[0]) / 2 * sum(v**2 for v in speeds)
    assert number(run, "impact_energy") == pytest.approx(energy, rel=1e-9)
    transmitted = number(run, "transmitted_energy")
    assert number(run, "rattle_index") == pytest.approx(energy / transmitted, rel=1e-9)


def test_the_friction_loss_is_the_mean_of_its_output(runs):
    """Trapezes between 10,000 outputs; the loss jumps where pairs enter and leave."""
    run = runs("spur-pair.yaml", "simulation.metrics={}", "simulation.output_interval=5e-6")
    history = run.history
    begin, end = (float(history[f"window_{which}"]) for which in ("begin", "end"))
    rows = (history["time"].values >= begin) & (history["time"].values <= end)
    time, loss = history["time"].values[rows], history["friction_loss"].values[rows, 0]
    mean = float(np.trapezoid(loss, time)) / (time[-1] - time[0])
    assert number(run, "friction_loss_mean") == pytest.approx(mean, rel=1e-3)
    assert mean > 10.0
    lost = number(run, "friction_loss_mean") * (end - begin)
    share = lost / number(run, "transmitted_energy")
    assert number(run, "friction_efficiency") == pytest.approx(1 - share, rel=1e-12)


def test_accelerometers_and_moving_axles_have_numbers(runs):
    """A moving housing: one of its points moves as prescribed, with ten cycles per revolution."""
    shake, speed, amplitude = 250.0, 1500 * 2 * math.pi / 60, 1e-6
    run = runs(
        "spur-pair.yaml",
        "housing={kind: prescribed, translation: [{kind: harmonic, axis: y, amplitude: 1.0e-6, "
        "frequency: 250}], accelerometers: "
        "[{name: top, point: [0, 0.1, 0], direction: [0, 1, 0]}]}",
        f"wheels.pinion.loads.0={{kind: speed, value: {-speed}}}",
        "wheels.gear.support={kind: slider, direction: 90, mass: 1, "
        "stiffness: 1.0e+8, damping: 1.0e+3}",
        "meshes.0.damping={law: linear, coefficient: 1000}",
        "simulation.initial={kind: speeds, speeds: "
        f"{{pinion: {-speed}, gear: {speed * 19 / 34}}}}}",
        "simulation.metrics={from: 0, to: 0.0401, turns_of: pinion}",
    )
    assert run.exit_code == 0, run.messages
    assert int(run.history["window_periods"]) == 1
    top = amplitude * (2 * math.pi * shake) ** 2
    for name, expected in (
        ("rms", top / math.sqrt(2)),
        ("max", top),
        ("min", -top),
        ("kurtosis", 1.5),
        ("crest_factor", math.sqrt(2)),
    ):
        assert number(run, f"accelerometer_acceleration_{name}") == pytest.approx(
            expected, rel=1e-7
        )
    assert abs(number(run, "accelerometer_acceleration_mean")) < 1e-7 * top
    history = run.history
    inside = history["time"].values <= float(history["window_end"])
    axle = history["centre_acceleration"].values[inside, 1, 1]
    assert number(run, "centre_acceleration_rms", 3) == pytest.approx(
        float(np.sqrt(np.mean(axle**2))), rel=0.02
    )
    assert number(run, "centre_acceleration_rms", 0) == 0
