"""A test that leaves a process behind fails, and the process is ended."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest

import leftovers
from processes import is_alive

HEAD = "import subprocess, sys\nfrom leftovers import *\n"
LEAVES = """
def test_leaves(tmp_path):
    {how}
def test_after():
    pass
"""
SLEEP = "['sleep', '60']"


@pytest.mark.parametrize(
    ("how", "passed"),
    [
        (f"process = subprocess.Popen({SLEEP}); open('pid', 'w').write(str(process.pid))", False),
        # an orphan
        ("subprocess.run('sleep 60 & echo $! > pid', shell=True)", False),
        (f"process = subprocess.Popen({SLEEP}); process.terminate(); process.wait()", True),
        ("subprocess.Popen(['sleep', '0.3'])", True),  # ends by itself
    ],
    ids=["child", "orphan", "ended", "ends"],
)
def test_what_a_test_leaves_behind_is_named_and_ended(
    tmp_path: Path, how: str, passed: bool
) -> None:
    (tmp_path / "conftest.py").write_text(HEAD)
    (tmp_path / "test_it.py").write_text(HEAD.splitlines()[0] + LEAVES.format(how=how))
    path = str(Path(leftovers.__file__).parent)
    done = subprocess.run(
        [sys.executable, "-m", "pytest", "-q", "-p", "no:cacheprovider", "test_it.py"],
        cwd=tmp_path, env={**os.environ, "PYTHONPATH": path},
        capture_output=True, text=True, timeout=60, check=False,
    )  # fmt: skip
    assert done.returncode == (0 if passed else 1)
    assert ("2 passed" if passed else "2 passed, 1 error") in done.stdout
    if not passed:
        pid = int((tmp_path / "pid").read_text())
        assert f"the test left processes behind: {pid} (sleep 60)" in done.stdout
        assert not is_alive(pid)
