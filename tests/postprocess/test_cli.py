"""The command evolvent-post: exit codes, one-line errors, files where they belong."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest
from PIL import Image
from real_gears import RealPair, no_events
from synthetic import write_history

from evolvent.commands.post.app import COMMANDS as POST
from evolvent.figures.table import FIGURES
from evolvent.history import HISTORY


@pytest.fixture
def broken_file(smooth_run, tmp_path) -> Path:
    broken = smooth_run.history.copy(deep=True)
    broken["load_work"][100] += 1.0
    return write_history(tmp_path / "broken.h5", broken, smooth_run.events)


@pytest.fixture
def partial_file(smooth_run, tmp_path) -> Path:
    stopped = smooth_run.history.assign_attrs(status="failed", status_message="too much")
    return write_history(tmp_path / "stopped.h5.partial", stopped, smooth_run.events)


COMMANDS = POST


def test_help_names_every_command_and_exit_code(post):
    code, out, _ = post("--help")
    assert code == 0
    for word in (*COMMANDS, "Exit codes", "an invariant is violated"):
        assert word in out


@pytest.mark.parametrize("command", COMMANDS)
def test_every_command_has_help_with_an_example(post, command):
    code, out, _ = post(command, "--help")
    assert code == 0
    assert f"\n    evolvent-post {command} " in out  # on a line of its own


def test_version_is_shown(post):
    code, out, _ = post("--version")
    assert code == 0
    assert out.startswith("evolvent-post ")


@pytest.mark.parametrize(
    "arguments",
    [
        ("chek", "a.h5"),
        ("check",),
        ("compare", "a.h5"),
        ("plot", "a.h5", "--format", "gif"),
        ("plot",),
        ("plot", "a.h5", "--mesh", "first"),
        ("plot", "a.h5", "--quantity", "gap", "--select", "shaft"),
        ("plot", "a.h5", "--quantity", "gap", "--over", "angle"),
        ("plot", "a.h5", "--whole", "--from", "1"),
        ("plot", "a.h5", "--last-pitches", "0"),
        ("plot", "a.h5", "--over-time"),
        ("animate", "a.h5", "--fps", "0"),
        ("animate", "a.h5", "--speed", "-1"),
        ("animate", "a.h5", "--speed", "nan"),
        ("compare", "a.h5", "b.h5", "--tolerance", "-1"),
        ("compare", "a.h5", "b.h5", "--tolerance", "nan"),
    ],
)
def test_wrong_usage_is_code_2(post, arguments):
    code, out, err = post(*arguments)
    assert code == 2
    assert out == ""
    assert err.startswith("Usage: evolvent-post")


@pytest.mark.parametrize("command", ["check", "plot", "report"])
@pytest.mark.parametrize("content", [None, "text"], ids=["missing", "not-hdf5"])
def test_an_unreadable_file_is_code_3_and_one_line(post, tmp_path, command, content):
    if content is not None:
        (tmp_path / "a.h5").write_text(content)
    code, out, err = post(command, "a.h5")
    assert code == 3
    assert out == ""
    assert err.startswith("evolvent-post: a.h5: ")
    assert err.count("\n") == 1


def test_comparing_with_a_missing_file_is_code_3(post, smooth_run):
    code, _, err = post("compare", smooth_run.path, "b.h5")
    assert (code, err) == (3, "evolvent-post: b.h5: no such file\n")


def test_check_of_a_sound_run_is_code_0(post, friction_run):
    code, out, err = post("check", friction_run.path)
    assert code == 0
    assert err == (  # of a file that was not written by the program
        f"evolvent-post: {friction_run.path}: has no checksum, so damage would not be detected\n"
    )
    assert out.count("pass") == 9
    assert "energy balance" in out


def test_check_of_a_broken_run_is_code_1(post, friction_run, broken_file):
    code, out, _ = post("check", friction_run.path, broken_file)
    assert code == 1
    assert out.count("fail") == 1
    assert out.count("pass") == 17


def test_check_goes_on_after_an_unreadable_file(post, broken_file):
    code, out, err = post("check", "nothing.h5", broken_file)
    assert code == 3
    assert "no such file" in err
    assert "energy balance" in out


def test_check_warns_of_an_unfinished_run(post, partial_file):
    code, out, err = post("check", partial_file)
    assert code == 0
    assert "the run did not finish: too much" in err
    assert out.count("pass") == 9


def test_check_writes_json_for_scripts(post, broken_file):
    code, out, _ = post("check", broken_file, "--json")
    assert code == 1
    (result,) = json.loads(out)
    verdicts = {i["name"]: i for i in result["invariants"]}
    assert verdicts["energy balance"]["verdict"] == "fail"
    assert verdicts["energy balance"]["where"] == {"time": "0.1 s"}
    assert verdicts["energy balance"]["worst"] > verdicts["energy balance"]["bound"]
    assert verdicts["torque balance"]["verdict"] == "pass"


def test_plot_writes_every_figure_and_says_where(post, friction_run, tmp_path):
    code, out, _ = post("plot", friction_run.path, "-o", "a/b")
    assert code == 0
    names = [row.name for row in FIGURES.values() if row.by_default and row.of == HISTORY]
    assert out.split() == [f"a/b/friction-{name}.png" for name in names]
    for line in out.split():
        assert (tmp_path / line).read_bytes().startswith(b"\x89PNG")


def test_plot_lists_every_figure_and_what_it_needs_without_any_history(post):
    code, out, err = post("plot", "--list")
    assert (code, err) == (0, "")
    for line, row in zip(out.splitlines()[1:], FIGURES.values(), strict=True):
        assert line.split()[0] == row.name
        assert row.text in line
        assert line.rstrip().endswith(", ".join(row.needs))
        assert ("(on request)" in line) is not row.by_default


def test_plot_puts_the_transmission_errors_of_all_files_in_one_figure(
    post, friction_run, smooth_run
):
    files = [friction_run.path, smooth_run.path]
    code, out, _ = post("plot", *files, "--quantity", "transmission_error", "--format", "svg")
    assert (code, out.split()) == (0, ["transmission_error.svg"])


def test_plot_tells_files_of_the_same_name_apart(post, smooth_run, tmp_path):
    files = []
    for folder in ("one", "two"):
        (tmp_path / folder).mkdir()
        path = tmp_path / folder / "run.h5"
        files.append(write_history(path, smooth_run.history, smooth_run.events))
    code, out, _ = post("plot", *files, "--quantity", "penetration")
    assert (code, out.split()) == (0, ["one-run-penetration.png", "two-run-penetration.png"])


def test_plot_refuses_the_same_file_twice(post, smooth_run):
    code, _, err = post("plot", smooth_run.path, smooth_run.path)
    assert code == 2
    assert "the same file is given twice" in err


def test_plot_between_times_without_output_is_code_2(post, smooth_run):
    code, _, err = post("plot", smooth_run.path, "--from", "7", "--to", "8")
    assert code == 2
    assert "has no output between --from and --to" in err


@pytest.mark.parametrize("arguments", [("plot", "-o", "file/x"), ("report", "-o", "file/x.html")])
def test_output_that_cannot_be_written_is_code_74(post, smooth_run, tmp_path, arguments):
    (tmp_path / "file").touch()
    command, *options = arguments
    code, _, err = post(command, smooth_run.path, *options)
    assert code == 74
    assert err.startswith("evolvent-post: file/x")
    assert "cannot be written (Not a directory)" in err


def test_report_is_named_after_the_history(post, friction_run, tmp_path):
    code, out, _ = post("report", friction_run.path)
    assert (code, out) == (0, "friction.html\n")
    assert (tmp_path / "friction.html").read_text(encoding="utf-8").startswith("<!DOCTYPE html>")


@pytest.mark.parametrize("options", [("--from", "7"), ("--from", "0.3", "--to", "0.2")])
def test_report_between_times_without_output_is_code_2(post, smooth_run, options):
    code, _, err = post("report", smooth_run.path, *options)
    assert (code, err) == (2, "evolvent-post: smooth.h5: has no output between --from and --to\n")


def test_report_of_an_unfinished_run_drops_both_endings(post, partial_file):
    code, out, err = post("report", partial_file, "-o", "x.html")
    assert (code, out) == (0, "x.html\n")
    assert "the run did not finish" in err
    assert post("report", partial_file)[1] == "stopped.html\n"


def test_compare_of_equal_runs_is_code_0(post, smooth_run):
    code, out, _ = post("compare", smooth_run.path, smooth_run.path, "--tolerance", 0)
    assert code == 0
    results = len(smooth_run.history.data_vars) - 1  # all but the choice of tracking
    assert f"{results} variables are the same to the bit." in out


def test_compare_beyond_the_tolerance_is_code_1_and_names_the_worst(post, smooth_run, broken_file):
    code, out, err = post("compare", smooth_run.path, broken_file, "--tolerance", 1e-3)
    assert code == 1
    assert "load_work" in out
    assert "1.000e+00 J" in out
    assert "1 variables differ by more than 0.001, the largest being load_work" in err


def test_compare_without_a_tolerance_only_shows(post, smooth_run, broken_file):
    code, out, _ = post("compare", smooth_run.path, broken_file)
    assert code == 0
    assert "t = 0.1 s" in out


def test_compare_writes_json_for_scripts(post, smooth_run, broken_file):
    code, out, _ = post("compare", smooth_run.path, broken_file, "--json")
    assert code == 0
    result = json.loads(out)
    assert result["variables"]["load_work"]["absolute"] == pytest.approx(1.0, rel=1e-12)
    assert result["variables"]["angle"]["relative"] == 0.0


@pytest.fixture
def gears_file(tmp_path) -> Path:
    history = RealPair().history(np.linspace(0.0, 1.0, 31))
    return write_history(tmp_path / "gears.h5", history, no_events())


def test_animate_writes_a_gif_named_after_the_history(post, gears_file):
    code, out, err = post("animate", gears_file, "--to", "0.2", "--dpi", "30")
    assert (code, out, err) == (0, "gears.gif\n", "")
    with Image.open("gears.gif") as gif:
        assert gif.format == "GIF"


def test_animate_warns_of_teeth_that_jump(post, gears_file):
    arguments = ("animate", gears_file, "--speed", "100", "--fps", "10", "--dpi", "30")
    code, out, err = post(*arguments, "--mesh", "pinion-gear", "-o", "fast.gif")
    assert (code, out) == (0, "fast.gif\n")
    assert "pitches from frame to frame" in err
    assert err.count("\n") == 1


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (("-o", "gears.avi"), "gears.avi: the file name must end in .gif or .mp4"),
        (("--mesh", "gear"), "has no mesh `gear`; there is pinion-gear"),
        (("--from", "40"), "there is no output between --from and --to"),
        (("--speed", "1e-4"), "select a shorter time with --from and --to, a --speed above 0.4 or"),
    ],
)
def test_what_cannot_be_animated_is_one_line_and_code_2(post, gears_file, arguments, message):
    code, out, err = post("animate", gears_file, *arguments)
    assert (code, out) == (2, "")
    assert message in err
    assert err.count("\n") == 1


def test_mp4_without_ffmpeg_names_the_remedy(post, gears_file, monkeypatch, tmp_path):
    monkeypatch.setenv("PATH", str(tmp_path))
    code, _, err = post("animate", gears_file, "-o", "gears.mp4")
    assert code == 2
    assert "needs the program ffmpeg, which is not installed" in err
    assert "write a .gif" in err
    assert not Path("gears.mp4").exists()


def test_a_history_that_does_not_know_its_teeth_cannot_be_animated(post, smooth_run):
    code, _, err = post("animate", smooth_run.path)
    assert code == 3
    assert "does not contain the positions of the teeth; run the case again" in err


def test_an_animation_that_cannot_be_written_is_code_74(post, gears_file):
    code, _, err = post("animate", gears_file, "-o", "nowhere/gears.gif", "--to", "0.1")
    assert code == 74
    assert "nowhere/gears.gif: cannot be written" in err


def test_plot_draws_the_tooth_pairs_alone(post, gears_file):
    code, out, _ = post("plot", gears_file, "--pairs")
    assert (code, out) == (0, "gears-pairs.png\n")
    assert Path("gears-pairs.png").stat().st_size > 0


def test_plot_of_pairs_needs_a_history_with_pairs(post, smooth_run):
    code, _, err = post("plot", smooth_run.path, "--pairs")
    assert code == 3
    assert "has no variable `pair_" in err
