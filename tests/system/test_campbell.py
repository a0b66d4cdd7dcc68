"""evolvent-post campbell on actual cases: natural frequencies and orders."""

from __future__ import annotations

import json
import math
import sys
from pathlib import Path

import pytest
import xarray as xr

from evolvent.commands.post.app import main

TEETH = (19, 34)
CONSTANT = "wheels.pinion.loads.0={kind: speed, value: -157}"
TABLE = "wheels.pinion.loads.0={kind: speed, time: [0, 0.01, 1], speed: [-50, -50, -1250]}"
LOAD = "wheels.gear.loads.0={kind: torque, value: -178.9}"


@pytest.fixture
def campbell(monkeypatch, capsys, tmp_path, executable):
    """Run the command in an empty folder: exit code, stdout, stderr."""
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("EVOLVENT_EXECUTABLE", str(executable))

    def run(*words: object) -> tuple[int, str, str]:
        monkeypatch.setattr(sys, "argv", ["evolvent-post", "campbell", *map(str, words)])
        with pytest.raises(SystemExit) as stopped:
            main()
        captured = capsys.readouterr()
        return int(stopped.value.code or 0), captured.out, captured.err

    return run


def test_orders_meet_the_natural_frequency_of_the_program_at_speeds_by_the_teeth(
    campbell, evolvent, examples
):
    case = examples / "spur-pair.yaml"
    modes = json.loads(evolvent("modes", case, "--mean", "--json").stdout)["modes"]
    (natural,) = [m["natural_frequency"] for m in modes if m["natural_frequency"] is not None]
    code, out, err = campbell(case, "--speeds", "500:40000", "--json", "--mesh-orders", "3")
    assert (code, err) == (0, "")
    found = {row["order"]: row for row in json.loads(out)}
    assert list(found) == [f"{n} x mesh pinion-gear" for n in (3, 2, 1)]  # by speed
    for n in (1, 2, 3):
        row = found[f"{n} x mesh pinion-gear"]
        assert row["rpm"] == pytest.approx(60 * natural / (n * TEETH[0]), rel=1e-9)
        assert row["frequency"] == pytest.approx(natural, rel=1e-12)


def test_modes_have_the_numbers_that_the_program_gives_them(campbell, evolvent, examples):
    """In a train, non-oscillatory modes without a number are among the oscillatory ones."""
    case = examples / "tutorial-train.yaml"
    done = evolvent("modes", case, "--mean", "--json")
    modes = json.loads(done.stdout)["modes"]
    assert [mode["number"] for mode in modes if mode["natural_frequency"] is None] != []
    numbers = {m["number"]: m["natural_frequency"] for m in modes if m["number"] is not None}
    assert list(numbers) == list(range(1, len(numbers) + 1))
    text = evolvent("modes", case, "--mean").stdout
    for number, frequency in numbers.items():
        assert f"{number:6d}  {frequency:22.6g}" in text
    code, _, err = campbell(case, "--speeds", "500:3000", "-o", "c.h5")
    assert (code, err) == (0, "")
    with xr.open_dataset("c.h5", engine="h5netcdf") as found:
        assert found["mode"].values.tolist() == list(numbers)
        for number, frequency in numbers.items():
            shown = found["natural_frequency"].sel(mode=number).values
            assert shown == pytest.approx(frequency, rel=1e-9)


def test_speeds_are_those_of_any_wheel(campbell, examples):
    rows = []
    for wheel in ("pinion", "gear"):
        words = ("--speeds", "500:40000", "--wheel", wheel, "--json", "--mesh-orders", "2")
        rows.append(json.loads(campbell(examples / "spur-pair.yaml", *words)[1]))
    for pinion, gear in zip(*rows, strict=False):
        assert pinion["speed"] / gear["speed"] == pytest.approx(TEETH[1] / TEETH[0], rel=1e-12)


@pytest.mark.parametrize("load", [CONSTANT, TABLE], ids=["constant", "table"])
def test_a_prescribed_speed_is_varied_and_its_wheel_does_not_vibrate(campbell, examples, load):
    settings = [word for text in (load, LOAD) for word in ("--set", text)]
    words = ("--speeds", "500:12000", "--points", "3", "-o", "c.h5", *settings)
    code, out, err = campbell(examples / "spur-pair.yaml", *words)
    assert (code, err) == (0, "")
    assert "at 3 speeds; pinion has a prescribed speed and does not vibrate" in out
    with xr.open_dataset("c.h5", engine="h5netcdf") as found:
        assert found["is_computed"].values.tolist() == [1, 1, 1]
        assert found["natural_frequency"].shape == (3, 1)
        # recorded: the gear alone on the mesh; both wheels together have 11.6 kHz
        assert found["natural_frequency"].values == pytest.approx(5880, rel=0.01)
        assert found.attrs["evolvent_kind"] == "campbell"
        assert found.attrs["title"].startswith("Spur gears 19/34")


def test_speeds_at_which_a_damper_outweighs_the_load_have_modes_too(campbell, examples):
    settings = ("--set", CONSTANT, "--set", LOAD)
    case = examples / "compliant-pair.yaml"
    code, out, _ = campbell(case, "--speeds", "500:12000", "--points", "3", "-o", "c.h5", *settings)
    assert code == 0
    with xr.open_dataset("c.h5", engine="h5netcdf") as found:
        computed = found["is_computed"].values
        assert computed.all()
        assert "the nearest modes are used" not in out
        first = found["natural_frequency"].values[computed == 1][0, 0]
        assert found["natural_frequency"].values.ravel() == pytest.approx(first, rel=0.01)


def test_crossings_are_a_table_for_other_programs_and_a_picture(campbell, examples):
    words = ("--speeds", "500:40000", "-o", "c.csv", "-o", "c.png", "-o", "c.h5")
    code, out, _ = campbell(examples / "spur-pair.yaml", *words)
    assert (code, out.splitlines()[-3:]) == (0, ["c.csv", "c.png", "c.h5"])
    head, *rows = Path("c.csv").read_text(encoding="utf-8").splitlines()
    assert head == "speed_rad_per_s,speed_rpm,frequency_Hz,mode,order"
    with xr.open_dataset("c.h5", engine="h5netcdf") as found:
        assert len(rows) == found.sizes["crossing"] > 0
        for row, speed in zip(rows, found["crossing_speed"].values, strict=True):
            assert float(row.split(",")[0]) == speed
            assert float(row.split(",")[1]) == pytest.approx(speed * 30 / math.pi, rel=1e-12)


def test_all_stages_of_a_train_have_their_orders(campbell, examples):
    words = ("--speeds", "100:3000", "--wheel", "motor", "-o", "c.h5", "--mesh-orders", "1")
    assert campbell(examples / "two-stage-gears.yaml", *words)[0] == 0
    with xr.open_dataset("c.h5", engine="h5netcdf") as found:
        orders = dict(
            zip(found["excitation"].values, found["excitation_order"].values, strict=True)
        )
    assert orders == pytest.approx(
        {
            "1 x mesh first": 20.0,
            "1 x mesh second": 20 / 47 * 23,
            "1 x wheel motor": 1.0,  # pinion-1 has the same speed, and is listed once
            "1 x wheel gear-1": 20 / 47,
            "1 x wheel gear-2": 20 / 47 * 23 / 53,
        },
        rel=1e-12,
    )


@pytest.mark.parametrize(
    ("words", "code", "message"),
    [
        (("spur-pair", "--speeds", "500"), 2, "500 is not a range of speeds in rpm"),
        (("spur-pair", "--speeds", "900:500"), 2, "is not a range of speeds in rpm"),
        (("spur-pair", "--speeds", "1:2", "-o", "c.txt"), 2, "must end in .h5, .csv"),
        (("spur-pair", "--speeds", "1:2", "--wheel", "x"), 2, "no wheel `x`; there is pinion, ge"),
        (("spur-pair", "--speeds", "1:2", "--set", "a.b=1"), 3, "--set a.b=1: "),
        (("paper-rigid", "--speeds", "1:2"), 3, "natural modes require a stiffness"),
        (("nothing", "--speeds", "1:2"), 3, "No such file or directory"),
    ],
)
def test_what_cannot_be_done_is_said_with_the_code_of_the_program(
    campbell, examples, words, code, message
):
    case, *options = words
    found, out, err = campbell(examples / f"{case}.yaml", *options)
    assert (found, out) == (code, "")
    assert message in " ".join(err.split())
