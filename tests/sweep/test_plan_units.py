"""Plans with units: the program reads them, the design holds doubles in the units of the keys."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest
from sweeps import PAPER

from evolvent.errors import SweepError
from evolvent.sweep.design import Parameter
from evolvent.sweep.sampling import columns
from evolvent.sweep.spec import Spec, read_spec

WIDTH = "wheels.pinion.width"
LOAD = "wheels.pinion.loads.0.value"
SPEED = "simulation.initial.speeds.pinion"
FRICTION = "meshes.0.friction.coefficient"


@pytest.fixture
def planned(tmp_path):
    """A plan of the paper's pair, and its columns by name."""

    def make(text: str) -> tuple[Spec, dict[str, Parameter]]:
        path = tmp_path / "sweep.yaml"
        path.write_text(f"format: 1\ncase: {PAPER}\n{text}")
        spec = read_spec(path)
        return spec, {p.name: p for p in columns(spec)[0]}

    return make


def test_ranges_values_and_the_window_take_units(planned):
    spec, got = planned(f"""
method: factorial
window: {{from: 500 ms, to: 1}}
parameters:
- {{path: {WIDTH}, name: width, values: [20 mm, 0.03, 4cm]}}
- {{path: {LOAD}, name: load, from: 10 N m, to: 0.1 kN m, number: 4, scale: log}}
- {{path: {SPEED}, name: speed, from: 600 rpm, to: 1500 1/min, number: 4}}
- {{path: simulation.duration, name: end, value: 2000 ms}}
- {{path: {FRICTION}, name: friction, values: [5 %, 0.1]}}
- {{name: half, expression: width / 2}}
""")
    assert spec.window == (0.5, 1.0)
    assert sorted(set(got["width"].values)) == [0.02, 0.03, 0.04]
    np.testing.assert_array_equal(np.unique(got["load"].values), np.geomspace(10, 100, 4))
    ends = np.unique(got["speed"].values)[[0, -1]]
    np.testing.assert_allclose(ends, [20 * math.pi, 50 * math.pi], rtol=3e-16)
    assert set(got["end"].values) == {2.0}
    assert set(got["friction"].values) == {0.05, 0.1}
    assert set(got["half"].values) == {0.01, 0.015, 0.02}
    units = {name: parameter.units for name, parameter in got.items()}
    assert units == {
        **{"width": "m", "load": "N m", "speed": "rad/s", "end": "s"},
        **{"friction": "", "half": ""},
    }


def test_columns_of_a_table_take_units(planned, tmp_path: Path):
    (tmp_path / "cases.csv").write_text(
        f"{WIDTH},meshes.0.friction.law,{LOAD}\n20 mm,none,1\n 0.03 ,none,2\n4 cm ,none,3\n"
    )
    _, got = planned("method: table\nfile: cases.csv\n")
    width = got["wheels_pinion_width"]
    assert width.values.dtype == float
    assert width.values.tolist() == [0.02, 0.03, 0.04]
    assert width.units == "m"
    assert got["meshes_0_friction_law"].values.tolist() == ["none"] * 3
    assert got["wheels_pinion_loads_0_value"].units == ""


def test_texts_that_begin_with_a_digit_stay_texts(planned):
    _, got = planned("""
method: list
parameters:
- {path: title, values: [3 mm, 2nd]}
- {name: label, values: [3 mm, 2nd]}
""")
    assert got["title"].values.tolist() == ["3 mm", "2nd"]
    assert got["label"].values.tolist() == ["3 mm", "2nd"]


@pytest.mark.parametrize(
    ("parameter", "message"),
    [
        (
            f"{{path: {WIDTH}, values: [20 mm, 3 N]}}",
            "parameters.0.values: is 3 N; 'N' is a unit of force; write the length in mm, um,",
        ),
        (
            f"{{path: {WIDTH}, from: 2 cn, to: 5 cm, number: 3}}",
            "parameters.0.from: is 2 cn; the unit 'cn' is unknown (did you mean 'cm'?); write",
        ),
        (
            "{path: wheels.pinion.widht, value: 20 mm}",
            "parameters.0.value: is 20 mm; wheels.pinion has no key 'widht' (did you mean",
        ),
        (
            f"{{path: {SPEED}, units: rpm, from: 60 rpm, to: 100 rpm, number: 3}}",
            "units is rpm, but values with units are stored in that of the key, rad/s; omit units",
        ),
        (
            "{name: speed, from: 60 rpm, to: 100 rpm, number: 3}",
            "is '60 rpm', must be a finite number; only a path to a key with a unit takes others",
        ),
    ],
)
def test_what_is_no_unit_of_the_key_is_refused_with_its_place(planned, parameter, message):
    with pytest.raises(SweepError) as refusal:
        planned(f"method: factorial\nparameters: [{parameter}, {{path: title, values: [a, b]}}]\n")
    assert message in str(refusal.value)
    assert "sweep.yaml: " in str(refusal.value)


def test_all_texts_of_a_plan_are_asked_about_in_one_call(planned, monkeypatch):
    from evolvent.sweep import quantities

    calls: list[tuple[object, ...]] = []
    call = quantities.call

    def counted(*words: object) -> object:
        calls.append(words)
        return call(*words)

    monkeypatch.setattr(quantities, "call", counted)
    widths = ", ".join(f"{i} mm" for i in range(1, 300))
    _, got = planned(f"method: factorial\nparameters: [{{path: {WIDTH}, values: [{widths}]}}]")
    assert len(calls) == 1
    assert got["wheels_pinion_width"].values.tolist() == [float(f"{i}e-3") for i in range(1, 300)]
    planned(f"method: factorial\nparameters: [{{path: {WIDTH}, values: [0.01, 0.02]}}]")
    assert len(calls) == 1
