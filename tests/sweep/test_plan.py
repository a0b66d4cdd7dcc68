"""Plans: what the methods give, and what is refused, with the program asked about the cases."""

from __future__ import annotations

import json
import re
import subprocess
from pathlib import Path

import h5py
import numpy as np
import pandas as pd
import pytest
from sweeps import PAPER

import machine
from evolvent.errors import SweepError
from evolvent.sweep import check
from evolvent.sweep.design import read_design
from evolvent.sweep.plan import with_accuracy
from evolvent.sweep.sampling import columns
from evolvent.sweep.spec import read_spec

LOAD = "wheels.pinion.loads.0.value"
FRICTION = "meshes.0.friction.coefficient"


@pytest.fixture
def sampled(tmp_path):
    """Columns of a plan by name, without the program."""

    def make(text: str) -> dict[str, np.ndarray]:
        path = tmp_path / "sweep.yaml"
        path.write_text(f"format: 1\ncase: case.yaml\n{text}")
        parameters, n_cases, _ = columns(read_spec(path))
        assert {p.values.size for p in parameters} == {n_cases}
        return {p.name: p.values for p in parameters}

    return make


def test_a_factorial_has_every_combination_once_the_last_parameter_fastest(sampled):
    got = sampled("""
method: factorial
parameters:
- {path: x, values: [1, 2]}
- {path: y, values: [a, b, c]}
- {path: z, from: 0, to: 1, number: 2}
""")
    rows = list(zip(got["x"].tolist(), got["y"].tolist(), got["z"].tolist(), strict=True))
    assert rows == [(x, y, z) for x in (1, 2) for y in "abc" for z in (0.0, 1.0)]


def test_lists_are_taken_side_by_side_and_a_value_goes_with_all(sampled):
    got = sampled("""
method: list
parameters:
- {path: x, values: [1, 2, 4]}
- {path: y, from: 8, to: 2, number: 3, scale: log}
- {path: z, value: {law: none}}
""")
    assert got["x"].tolist() == [1, 2, 4]
    np.testing.assert_allclose(got["y"], [8, 4, 2], rtol=1e-15)
    assert got["z"].tolist() == ["{law: none}"] * 3


def test_negative_ranges_can_be_logarithmic(sampled):
    got = sampled("""
method: factorial
parameters: [{path: x, from: -1, to: -100, number: 3, scale: log}]
""")
    np.testing.assert_allclose(got["x"], [-1, -10, -100], rtol=1e-15)


def test_draws_from_a_logarithmic_range_below_0_are_those_above_it_with_their_sign(sampled):
    below, above = (
        sampled(f"""
method: latin_hypercube
samples: 16
parameters: [{{path: x, from: {begin}, to: {end}, scale: log}}]
""")["x"]
        for begin, end in ((-1, -100), (1, 100))
    )
    np.testing.assert_array_equal(below, -above)


@pytest.mark.parametrize("method", ["latin_hypercube", "sobol"])
def test_a_sample_has_one_value_in_each_layer_of_each_parameter(sampled, method):
    got = sampled(f"""
method: {method}
samples: 64
seed: 5
parameters:
- {{path: x, from: 10, to: 20}}
- {{path: y, from: 1e-3, to: 1e3, scale: log}}
""")
    layers = np.floor((got["x"] - 10) / 10 * 64)
    assert sorted(layers) == list(range(64))
    layers = np.floor((np.log10(got["y"]) + 3) / 6 * 64)
    assert sorted(layers) == list(range(64))


def test_whole_numbers_and_texts_come_up_equally_often_in_a_sample(sampled):
    got = sampled("""
method: sobol
samples: 64
parameters:
- {path: x, from: 20, to: 23, whole: true}
- {path: y, values: [none, tanh]}
""")
    assert np.unique(got["x"], return_counts=True)[1].tolist() == [16] * 4
    assert got["x"].dtype == np.int64
    assert np.unique(got["x"]).tolist() == [20, 21, 22, 23]
    assert np.unique(got["y"].astype(str), return_counts=True)[1].tolist() == [32, 32]


def test_the_seed_decides_a_sample(sampled):
    text = """
method: latin_hypercube
samples: 16
seed: {}
parameters: [{{path: x, from: 0, to: 1}}]
"""
    first, again, other = (sampled(text.format(seed))["x"] for seed in (1, 1, 2))
    assert np.array_equal(first, again)
    assert not np.array_equal(first, other)


@pytest.mark.parametrize(("second_order", "group"), [("false", 4), ("true", 6)])
def test_saltelli_makes_groups_that_differ_from_their_first_in_one_parameter(
    sampled, second_order, group
):
    machine.module("SALib")
    got = sampled(f"""
method: saltelli
samples: 8
second_order: {second_order}
parameters: [{{path: x, from: 0, to: 1}}, {{path: y, from: 5, to: 6}}]
""")
    points = np.stack([got["x"], got["y"]], axis=1).reshape(8, group, 2)
    for number in range(2):  # rows 1 and 2: one parameter of the last row, the rest of the first
        differs = points[:, 1 + number] != points[:, 0]
        assert differs[:, number].all()
        assert not np.delete(differs, number, axis=1).any()


def test_derived_columns_follow_from_others_and_from_each_other(sampled):
    got = sampled("""
method: list
parameters:
- {name: torque, values: [1, 2]}
- {path: load, expression: -torque}
- {path: teeth, expression: 20*load/-1 + 0.4, whole: true}
""")
    assert got["load"].tolist() == [-1.0, -2.0]
    assert got["teeth"].tolist() == [20, 40]
    assert got["teeth"].dtype == np.int64


@pytest.mark.parametrize("kind", ["csv", "parquet"])
def test_a_table_gives_its_rows_in_their_order(tmp_path, sampled, kind):
    table = pd.DataFrame({"load": [1.5, 2.5], "teeth": [20, 30], "law": ["none", "tanh"]})
    if kind == "csv":
        table.to_csv(tmp_path / "cases.csv", index=False)
    else:
        machine.module("pyarrow")
        table.to_parquet(tmp_path / "cases.parquet")
    got = sampled(f"""
method: table
file: cases.{kind}
parameters:
- {{path: a.load, column: load}}
- {{path: b, name: teeth}}
- {{path: c, name: law}}
- {{path: d, expression: 2*teeth}}
""")
    assert got["a_load"].tolist() == [1.5, 2.5]
    assert got["teeth"].tolist() == [20, 30]
    assert got["teeth"].dtype == np.int64
    assert got["law"].tolist() == ["none", "tanh"]
    assert got["d"].tolist() == [40.0, 60.0]


def test_column_heads_are_paths_if_a_table_comes_without_parameters(tmp_path, sampled):
    (tmp_path / "cases.csv").write_text("wheels.pinion.teeth, x\n20, none\n30, 1e3\n")
    got = sampled("method: table\nfile: cases.csv\n")
    assert got["wheels_pinion_teeth"].tolist() == [20, 30]
    assert got["x"].tolist() == ["none", "1e3"]


REFUSED = [
    ("method: factorial\nparameters: [{path: x, values: []}]", "values must be a list of at least"),
    ("method: factorial\nparameters: [{path: x, value: 1}]", "nothing varies"),
    ("method: factoral\nparameters: [{path: x, value: 1}]", "did you mean 'factorial'?"),
    ("method: factorial\nparameters: []", "parameters: must be a list of at least one"),
    ("method: factorial\nsamples: 3\nparameters: []", "samples: has no meaning with method"),
    ("method: sobol\nsamples: 100\nparameters: [{path: x, from: 0, to: 1}]", "as 128"),
    ("method: sobol\nsamples: 0\nparameters: [{path: x, from: 0, to: 1}]", "samples: is '0'"),
    ("method: list\nparameters: [{path: x, from: 0, to: 1}]", "needs `number`"),
    ("method: list\nparameters: [{path: x, values: [1, 2]}, {path: y, values: [1]}]", "one length"),
    ("method: list\nparameters: [{path: x, values: [1], to: 2}]", "to has no meaning without from"),
    ("method: list\nparameters: [{path: x, values: [1], value: 2}]", "exactly one of"),
    ("method: list\nparameters: [{path: x, valeus: [1]}]", "did you mean 'value"),
    ("method: list\nparameters: [{path: x, values: [1]}, {path: x, values: [1]}]", "needs its own"),
    ("method: list\nparameters: [{path: x, name: a b, values: [1]}]", "of letters, digits and _"),
    ("method: list\nparameters: [{path: x, name: status, values: [1]}]", "this name is taken"),
    ("method: list\nparameters: [{path: x, values: [1]}, {path: y, expression: z}]", "'z'"),
    (
        "method: list\nparameters: [{path: x, from: 0, to: 1, number: 3, scale: log}]",
        "must exclude 0",
    ),
    (
        "method: list\nparameters: [{path: x, from: 1, to: 2, number: 9, whole: true}]",
        "some of its values are equal",
    ),
    ("method: table\nfile: none.csv", "none.csv: no such file"),
    ("method: list\nwindow: {from: 2, to: 1}\nparameters: [{path: x, values: [1]}]", "from < to"),
    ("method: list\nhistories: {every: 0}\nparameters: [{path: x, values: [1]}]", "at least 1"),
    ("method: list\nfile: 3\nparameters: [", ":"),
    (
        "method: factorial\nparameters:\n"
        + "".join(f"- {{path: p{i}, from: 0, to: 1, number: 100}}\n" for i in range(5)),
        "has 10000000000 cases",
    ),
]


@pytest.mark.parametrize(("text", "message"), REFUSED)
def test_a_plan_that_cannot_be_used_is_refused_with_its_place(sampled, tmp_path, text, message):
    with pytest.raises(SweepError) as caught:
        sampled(text)
    assert message in str(caught.value)
    assert str(tmp_path) in str(caught.value)


def test_a_gap_in_a_table_is_refused(tmp_path, sampled):
    (tmp_path / "cases.csv").write_text("x,y\n1,2\n3,\n")
    with pytest.raises(SweepError, match=re.escape("has no value for case 1")):
        sampled("method: table\nfile: cases.csv\n")


def test_an_empty_table_is_refused(tmp_path, sampled):
    (tmp_path / "cases.csv").write_text("x,y\n")
    with pytest.raises(SweepError, match="has 0 cases, must have 1 to"):
        sampled("method: table\nfile: cases.csv\n")


def write_plan(folder: Path, parameters: str, rest: str = "") -> Path:
    path = folder / "sweep.yaml"
    path.write_text(
        f"format: 1\ntitle: T\ncase: {PAPER}\nmethod: list\nparameters:\n{parameters}\n{rest}"
    )
    return path


def test_a_design_holds_the_case_the_columns_and_the_settings(sweep, tmp_path):
    path = write_plan(
        tmp_path,
        f"- {{path: {LOAD}, name: load, units: N m, values: [-1, -2.5]}}\n"
        "- {path: meshes.0.contact.law, name: law, values: [johnson, linear_of_hertz]}\n"
        f"- {{path: {FRICTION}, values: [0, 1]}}",
        "window: {from: 1, to: 2}\nhistories: {variables: [normal_force], every: 5}",
    )
    code, out, err = sweep("plan", path, "-o", "d.h5", "--keep-refused")
    assert (code, out) == (0, "d.h5: 2 cases\n")
    assert "linear_of_hertz" in err
    assert sweep("plan", path, "-o", "d.h5") == (1, out, err)
    with h5py.File("d.h5") as file:
        assert file.attrs["evolvent_design_format"] == 1
        assert file.attrs["case"] == with_accuracy(PAPER.read_text(), [])
        assert file.attrs["n_cases"] == 2
        assert file.attrs["window"].tolist() == [1.0, 2.0]
        assert file.attrs["history_variables"] == "normal_force"
        assert file.attrs["history_every"] == 5
        assert re.fullmatch("[0-9a-f]{64}", file.attrs["hash"])
        load, law, friction = (file[f"parameters/p{i}"] for i in range(3))
        assert (load.attrs["path"], load.attrs["name"]) == (LOAD, "load")
        assert load.attrs["units"] == "N m"
        assert [load.dtype, friction.dtype] == [np.float64, np.int64]
        assert law.asstr()[:].tolist() == ["johnson", "linear_of_hertz"]
    assert [(p.path, p.values[1]) for p in read_design(Path("d.h5")).parameters] == [
        (LOAD, -2.5),
        ("meshes.0.contact.law", "linear_of_hertz"),
        (FRICTION, 1),
    ]


@pytest.mark.parametrize(
    ("parameter", "message"),
    [
        ("{path: wheels.pinion.teth, values: [20, 21]}", "no key 'teth' (did you mean 'teeth'?)"),
        ("{path: wheels.wheel.teeth, values: [20, 21]}", "wheel"),
        (
            f"{{path: {FRICTION}, values: [-0.2, -0.1]}}",
            "all 2 cases would be refused; case 0: --set",
        ),
        (f"{{path: {LOAD}, values: [a, b]}}", "must be a number"),
    ],
)
def test_a_path_that_no_case_has_or_no_case_that_is_taken_is_code_3(
    sweep, tmp_path, parameter, message
):
    code, out, err = sweep("plan", write_plan(tmp_path, f"- {parameter}"))
    assert (code, out) == (3, "")
    assert message in err
    assert not (tmp_path / "sweep.h5").exists()


def test_every_case_is_asked_about_and_those_that_would_be_refused_are_counted_by_reason(
    sweep, tmp_path
):
    """A start that does not exist is found, and a value between the extremes of its column."""
    n, pulled, braked = 40, (3, 4, 30), (7,)
    loads = [5.0 + i if i in pulled else -1.0 - i for i in range(n)]
    brakes = [-5.0 if i in braked else 10.0 for i in range(n)]
    loads[20], brakes[20] = 100.0, -10.0  # a value is refused before its start
    path = write_plan(
        tmp_path,
        f"- {{path: {LOAD}, name: load, values: {loads}}}\n"
        f"- {{path: wheels.gear.loads.0.coefficient, name: brake, values: {brakes}}}\n"
        "- {path: simulation.initial.kind, value: steady}",
    )
    code, out, err = sweep("plan", path, "-o", "d.h5")
    assert (code, out) == (1, f"d.h5: {n} cases\n")
    head, pulls, values = err.splitlines()
    assert head == f"evolvent-sweep: {path}: 5 of 40 cases would be refused:"
    assert pulls.startswith("  3 x --set wheels.pinion.loads.0.value=8: ")
    assert "has the wrong sense" in pulls
    assert pulls.endswith("(first case 3: load = 8, brake = 10, simulation_initial_kind = steady)")
    assert values.startswith("  2 x --set wheels.gear.loads.0.coefficient=-5")
    assert "(first case 7: load = -8, brake = -5" in values
    refused = sorted((*pulled, *braked, 20))
    assert sweep("run", "d.h5", "-o", "d")[0] == 1  # as many, in the same words
    out = sweep("status", "d")[1]
    assert re.search(r"35 +done\s+5 +did not finish \(0 failed, 5 refused\)", out)
    rows = [json.loads(line) for line in Path("d/shard-1-of-1.jsonl").read_text().splitlines()[1:]]
    assert sorted(row["case"] for row in rows if row["status"] == "refused") == refused


def test_many_cases_are_asked_about_by_several_processes(sweep, tmp_path, monkeypatch):
    monkeypatch.setattr(check, "A_PROCESS", 5)
    monkeypatch.setenv("SLURM_CPUS_PER_TASK", "3")
    values = [-0.1 if i % 4 == 1 else 0.1 for i in range(17)]
    path = write_plan(tmp_path, f"- {{path: {FRICTION}, values: {values}}}")
    code, out, err = sweep("plan", path, "-o", "d.h5", "--dry-run")
    assert (code, "4 of 17 cases would be refused" in err, "(first case 1:" in err) == (
        1,
        True,
        True,
    )
    assert "17 cases by list" in out
    assert not Path("d.h5").exists()


def test_a_window_beyond_the_end_is_refused(sweep, tmp_path):
    path = write_plan(
        tmp_path, "- {path: simulation.duration, values: [4, 3]}", "window: {from: 1, to: 3.5}"
    )
    code, _, err = sweep("plan", path)
    assert code == 3
    assert "window.to: is 3.5 s, but a case ends at 3 s" in err


def test_the_hash_tells_apart_what_gives_other_results(sweep, tmp_path):
    one = f"- {{path: {LOAD}, values: [-1, -2]}}"
    variants = [
        (one, ""),
        (one, "title: other"),
        (f"- {{path: {LOAD}, values: [-1, -2.0000000000000004]}}", ""),
        (f"- {{path: {FRICTION}, values: [1, 2]}}", ""),
        (one, "window: {from: 1, to: 2}"),
        (one, "histories: {variables: [normal_force]}"),
    ]
    hashes = []
    for parameters, rest in variants:
        path = write_plan(tmp_path, parameters, rest)
        if "title" in rest:
            path.write_text(path.read_text().replace("title: T\n", ""))
        assert sweep("plan", path, "-o", "d.h5")[0] == 0
        hashes.append(read_design(Path("d.h5")).hash)
    assert hashes[0] == hashes[1]  # a title changes no result
    assert len(set(hashes)) == len(variants) - 1


def without_checksum(path):
    with path.open("r+b") as file:
        file.write(bytes(64))


def test_a_design_of_another_format_or_changed_by_hand_is_refused(sweep, tmp_path):
    path = write_plan(tmp_path, f"- {{path: {LOAD}, values: [-1, -2]}}")
    for change, message in (
        (lambda file: file.attrs.modify("evolvent_design_format", 2), "design format 2"),
        (lambda file: file.attrs.pop("evolvent_design_format"), "is not a design"),
        (lambda file: file["parameters/p0"].write_direct(np.array([-1, -3])), "it was changed"),
        (lambda file: file.attrs.pop("case"), "is not a complete design"),
        (lambda file: file.attrs.modify("evolvent_version", "9.9.9"), "made by evolvent 9.9.9"),
    ):
        assert sweep("plan", path, "-o", "d.h5")[0] == 0
        with h5py.File("d.h5", "r+") as file:
            change(file)
        code, out, err = sweep("run", "d.h5", "-o", "d")
        assert (code, out) == (3, "")
        assert "d.h5: is damaged, or was changed: its checksum is wrong" in err
        without_checksum(Path("d.h5"))
        code, out, err = sweep("run", "d.h5", "-o", "d")
        assert (code, out) == (3, "")
        assert message in err.splitlines()[-1]


def test_a_design_of_another_program_needs_no_more_than_the_batch_does(sweep, executable, tmp_path):
    version = subprocess.run([executable, "--version"], capture_output=True, text=True, check=True)
    with h5py.File(tmp_path / "d.h5", "w") as file:
        file.attrs.update(
            evolvent_design_format=1,
            evolvent_version=version.stdout.split()[1],
            title="",
            case=PAPER.read_text(),
            hash="of another kind",
            window=[0.0, 0.01],
            history_variables="",
            history_every=1,
            n_cases=2,
        )
        file["parameters/p0"] = [0.01, 0.02]
        file["parameters/p0"].attrs["path"] = "simulation.duration"
    assert sweep("run", "d.h5", "-o", "d")[:2] == (
        0,
        "d: 2 cases: 2 done, 0 did not finish, 0 missing\n",
    )
    assert sweep("collect", "d", "-o", "s.h5")[0] == 0
    with h5py.File(tmp_path / "s.h5") as file:
        assert file["simulation_duration"][:].tolist() == [0.01, 0.02]


def test_the_plan_of_the_sampling_is_kept_for_its_analysis(sweep, tmp_path):
    path = write_plan(tmp_path, f"- {{path: {LOAD}, name: load, from: -2, to: -1}}")
    path.write_text(path.read_text().replace("method: list", "method: sobol\nsamples: 4"))
    assert sweep("plan", path, "-o", "d.h5")[0] == 0
    with h5py.File("d.h5") as file:
        assert json.loads(file.attrs["sampling"]) == {"names": ["load"], "samples": 4}
        assert file.attrs["method"] == "sobol"
