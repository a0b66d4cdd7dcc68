"""A response in this process is that of the program: values, jumps, refusals."""

from __future__ import annotations

import re
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import xarray as xr
import yaml

import evolvent as package
from library.test_same_bits import assert_same, options, versions_without_hdf5
from system.test_respond import SPEED, speeds, write_rectangular

JUMPING = speeds(0.7, 0.76, 0.02)  # there is a jump up between 0.750 and 0.755
CALM = speeds(1.3, 1.31, 0.01)


def given(over: str) -> tuple[str, float, float, int]:
    """The same for Python."""
    path, values = over.split("=")
    first, last, n = values.split(":")
    return path, float(first), float(last), int(n)


@pytest.mark.parametrize(
    ("direction", "over", "jumps"), [("both", JUMPING, 1), ("up", CALM, 0), ("down", CALM, 0)]
)
def test_a_response_in_memory_is_the_program_s_file(
    evolvent: Callable[..., Any], tmp_path: Path, direction: str, over: str, jumps: int
) -> None:
    case = write_rectangular(tmp_path)
    words = [f"--{direction}", "--periods", "3000", "-q", "-o", "r.h5"]
    done = evolvent("respond", case, "--over", over, *words)
    assert done.returncode == 0, done.stderr
    memory = package.respond(case, over=given(over), direction=direction, periods=3000)
    with xr.open_dataset(tmp_path / "r.h5", engine="h5netcdf") as file:
        assert file.sizes["jump"] == jumps
        assert_same(memory, file)
        assert memory.attrs["versions"] == versions_without_hdf5(file.attrs["versions"])


def test_a_case_may_be_a_path_a_text_or_a_mapping(tmp_path: Path) -> None:
    path = write_rectangular(tmp_path)
    expected = package.respond(path, over=CALM, direction="up")
    for case in (path.read_text(), yaml.safe_load(path.read_text())):
        assert package.respond(case, over=CALM, direction="up").equals(expected)


def test_values_may_have_units_and_the_case_settings(
    evolvent: Callable[..., Any], tmp_path: Path
) -> None:
    case = write_rectangular(tmp_path)
    settings = {"meshes.ab.damping.value": 0.05}
    over = (SPEED, "-6000 rpm", "-6100 rpm", 2)
    words = ["--over", f"{SPEED}=-6000 rpm:-6100 rpm:2", "-q", "-o", "r.h5", *options(settings)]
    done = evolvent("respond", case, *words)
    assert done.returncode == 0, done.stderr
    with xr.open_dataset(tmp_path / "r.h5", engine="h5netcdf") as file:
        assert_same(package.respond(case, settings, over=over), file)


@pytest.mark.parametrize(
    ("over", "more"),
    [
        ("wheels.a.teeth=20:40", {}),
        (f"{SPEED}=-500:-500", {}),
        (f"{SPEED}=-500:-600:1", {}),
        (f"{SPEED}=-500", {}),
        ("wheels.a.loads.0.valu=-500:-600", {}),
        ("meshes.ab.contact.stiffness=3e8:-3e8:3", {}),
        (f"{SPEED}=-500:500:3", {}),
        (f"{SPEED}=500:600:3", {}),
        (f"{SPEED}=-500:-600", {"set": ["teeth"]}),
    ],
)
def test_an_exception_has_the_words_of_the_program_s_line(
    evolvent: Callable[..., Any], tmp_path: Path, over: str, more: dict[str, Any]
) -> None:
    case = write_rectangular(tmp_path)
    words = [word for text in more.get("set", ()) for word in ("--set", text)]
    done = evolvent("respond", case, "--over", over, "-o", tmp_path / "r.h5", *words)
    with pytest.raises(package.AnalysisError) as refused:
        package.respond(case, over=over, **more)
    assert done.stderr == f"{refused.value}\n"
    assert refused.value.code == done.returncode
    assert refused.value.history is None


@pytest.mark.parametrize(
    ("more", "what"),
    [
        ({"direction": "left"}, "direction: is 'left', must be up, down or both"),
        ({"periods": 99}, "--periods takes a whole number of common periods from 100 to"),
        ({"over": "\0"}, "over: holds a character of code 0"),
    ],
)
def test_what_is_no_request_is_refused(tmp_path: Path, more: dict[str, Any], what: str) -> None:
    case = write_rectangular(tmp_path)
    with pytest.raises(package.AnalysisError, match=re.escape(what)) as refused:
        package.respond(case, **{"over": CALM, **more})
    assert refused.value.code == 2


def test_a_motion_that_fails_gives_what_was_done(
    evolvent: Callable[..., Any], tmp_path: Path, examples: Path
) -> None:
    load = "wheels.gear.loads.0"
    settings = {
        load: "{kind: torque, value: -178.9}",
        "wheels.pinion.loads.0": "{kind: speed, value: -157}",
        "wheels.pinion.compliance": "{model: analytic}",
        "wheels.gear.compliance": "{model: analytic}",
    }
    over, case = f"{load}.value=-178:-40000:3", examples / "compliant-pair.yaml"
    words = ["--over", over, "--up", "-q", "-o", "r.h5", *options(settings)]
    done = evolvent("respond", case, *words)
    assert done.returncode == 4
    with pytest.raises(package.AnalysisError) as failed:
        package.respond(case, settings, over=over, direction="up")
    assert failed.value.code == 4
    assert done.stderr.splitlines()[-1] == f"{failed.value} and in 'r.h5.partial'"
    response = failed.value.history
    assert response is not None
    with xr.open_dataset(tmp_path / "r.h5.partial", engine="h5netcdf") as file:
        assert_same(response, file)
    assert np.isfinite(response["normal_force_mean"].values[0, 0]).all()


INTERRUPTED = """
import os, signal, threading, time, evolvent
def interrupt():
    time.sleep(0.5)
    os.kill(os.getpid(), signal.SIGINT)
threading.Thread(target=interrupt).start()
begun = time.monotonic()
try:
    evolvent.respond("rectangular.yaml", over=OVER)
except KeyboardInterrupt:
    print("interrupted", time.monotonic() - begun < 20)
again = evolvent.respond("rectangular.yaml", over=SHORT)
print(again.attrs["status"], again.attrs["values_done"])
"""


def test_ctrl_c_ends_a_response_and_leaves_nothing(tmp_path: Path) -> None:
    case = write_rectangular(tmp_path)
    program = INTERRUPTED.replace("OVER", repr(speeds(0.7, 2.1, 0.0001)))
    done = subprocess.run(
        [sys.executable, "-c", program.replace("SHORT", repr(CALM))],
        capture_output=True,
        text=True,
        cwd=tmp_path,
        timeout=50,
        check=False,
    )
    assert (done.stdout, done.stderr) == ("interrupted True\ndone 4\n", "")
    assert done.returncode == 0
    assert list(tmp_path.iterdir()) == [case]
