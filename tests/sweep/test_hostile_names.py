"""Names that shells, Slurm or terminals would read otherwise, and links that lead elsewhere."""

from __future__ import annotations

import subprocess
from pathlib import Path

import pytest
from sweeps import PAPER, make_design, row, write_journal

from evolvent.errors import SweepError, replacing
from evolvent.sweep import slurm
from evolvent.sweep.expression import evaluate

ARRAYS = [slurm.Array(2, 0, (1, 2))]
# Lines, quotes and what escapes them, terminals, and what turns the direction of writing.
REFUSED = ["x\ntouch PWNED\n#", 'a"b', "a'b", "a`b`", "a\\b", "a\rb", "a\x1b[1mb", "a\u2028b"]
REFUSED += ["a\x85b", "a\u202eb", "a\tb", "a\x7fb"]
TAKEN = ["$(touch PWNED)", "; touch PWNED", "-o", "%a%%", "a b", "{x}", "#x", "é", "$HOME", "*"]


@pytest.mark.parametrize("name", REFUSED, ids=ascii)
def test_a_place_that_slurm_would_read_otherwise_is_refused(tmp_path, name):
    for design, folder in ((tmp_path / name, tmp_path), (tmp_path, tmp_path / name)):
        with pytest.raises(SweepError, match="a path for Slurm cannot contain the character"):
            slurm.write_scripts(Path("/bin/true"), design, folder, ARRAYS, 1, slurm.Site())
    assert not (tmp_path / "slurm").exists()


@pytest.mark.parametrize("name", TAKEN, ids=ascii)
def test_a_task_gets_its_paths_as_they_are(tmp_path, monkeypatch, name):
    """The scripts, run by a shell, call the program with these words and nothing else."""
    program = tmp_path / "program"
    program.write_text('#!/bin/bash\nprintf "%s\\n" "$@"\n')
    program.chmod(0o755)
    folder, design = tmp_path / name, tmp_path / f"{name}.h5"
    (script,), _ = slurm.write_scripts(program, design, folder, ARRAYS, 1, slurm.Site())
    monkeypatch.setenv("SLURM_ARRAY_TASK_ID", "2")
    done = subprocess.run(
        ["bash", script], cwd=tmp_path, capture_output=True, text=True, check=True
    )
    assert done.stdout.splitlines()[:4] == ["batch", str(design), "-o", str(folder)]
    assert not list(tmp_path.rglob("PWNED"))
    heads = [line for line in script.read_text().splitlines() if "output" in line]
    logs = str(folder / "slurm").replace("%", "%%")
    assert heads == [f'#SBATCH --output="{logs}/shard-%a.log"']


def test_an_option_that_would_end_its_line_is_refused(tmp_path):
    site = slurm.Site(options=("constraint=x\ntouch PWNED",))
    with pytest.raises(SweepError, match="has a character that cannot be printed"):
        slurm.write_scripts(Path("/bin/true"), tmp_path / "d", tmp_path, ARRAYS, 1, site)


def test_scripts_replace_a_link_and_do_not_follow_it(tmp_path):
    (tmp_path / "slurm").mkdir()
    victim = tmp_path / "victim"
    for name in ("shards", "collect"):
        victim.write_text("precious")
        (tmp_path / "slurm" / f"{name}.sh").symlink_to(victim)
    slurm.write_scripts(Path("/bin/true"), tmp_path / "d", tmp_path, ARRAYS, 1, slurm.Site())
    assert victim.read_text() == "precious"
    assert not (tmp_path / "slurm" / "collect.sh").is_symlink()


def test_a_file_that_is_replaced_has_a_name_that_nobody_knows_before(tmp_path):
    victim = tmp_path / "victim"
    victim.write_text("precious")
    target = tmp_path / "target.h5"
    target.symlink_to(victim)
    names = set()
    for text in ("one", "two"):
        with replacing(target) as temporary:
            names.add(temporary.name)
            temporary.write_text(text)
        assert target.read_text() == text
    assert len(names) == 2
    assert victim.read_text() == "precious"
    assert sorted(path.name for path in tmp_path.iterdir()) == ["target.h5", "victim"]


@pytest.mark.parametrize("character", ["\u2028", "\x85", "\u202e", "\n", "\u2066"], ids=ascii)
def test_a_message_is_one_line_whatever_is_in_a_name(sweep, tmp_path, character):
    code, out, err = sweep("status", f"no{character}folder")
    assert (code, out) == (3, "")
    assert err == "evolvent-sweep: no folder: no such folder\n"


@pytest.mark.parametrize("character", ["\u2028", "\x85", "\u202e", "\u2066", "\u200f"], ids=ascii)
def test_a_case_tells_of_odd_names_in_one_line(executable, tmp_path, character):
    case = PAPER.read_text().replace("name: pinion\n", f'name: "pin{character}ion"\n')
    case = case.replace("[pinion,", f'["pin{character}ion",')
    (tmp_path / "odd.yaml").write_text(case, encoding="utf-8")
    command = [executable, "validate", "odd.yaml"]
    done = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, check=False)
    assert done.returncode == 3
    assert len(done.stderr.splitlines()) == 1  # also of those lines that only Unicode knows
    assert character not in done.stderr
    assert "contains " in done.stderr  # YAML itself takes U+0085 for a blank


@pytest.mark.parametrize("text", ["9" * 400, "1 + " + "9" * 400, "0x" + "f" * 900])
def test_a_number_of_hundreds_of_digits_is_refused(text):
    with pytest.raises(SweepError, match="is too complex a formula"):
        evaluate(text, {}, 1)


@pytest.mark.parametrize("source", ["value: {}", "values: [{}, 1]", "from: 1, to: {}, number: 2"])
def test_a_plan_with_a_number_of_hundreds_of_digits_ends_in_one_line(sweep, tmp_path, source):
    digits = "9" * 400
    (tmp_path / "p.yaml").write_text(
        f"format: 1\ncase: {PAPER}\nmethod: list\nparameters:\n"
        f"- {{path: simulation.duration, name: x, {source.format(digits)}}}\n"
    )
    code, out, err = sweep("plan", "p.yaml", "-o", "d.h5")
    assert (code, out) == (3, "")
    assert err.count("\n") == 1


def test_a_message_of_a_case_may_have_any_character(tmp_path, sweep):
    design = make_design(2)
    message = "a\u2028b\x85c\u202ed"
    write_journal(tmp_path / "d", design, [row(0, status="failed", message=message), row(1)])
    code, out, err = sweep("status", "d")
    assert code == 1 or (code, err) == (0, "")
    assert "1 x " in out
