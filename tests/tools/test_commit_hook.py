"""The hook for commit messages, in a repository of its own."""

from __future__ import annotations

import os
import subprocess
from pathlib import Path

import pytest

from documents import ROOT

SUBJECT = "radau: limit the step at load periods"
IDENTITY = {
    f"GIT_{role}_{what}": value
    for role in ("AUTHOR", "COMMITTER")
    for what, value in (("NAME", "A"), ("EMAIL", "a@b.example"))
}
ALONE = {"GIT_CONFIG_GLOBAL": os.devnull, "GIT_CONFIG_NOSYSTEM": "1"}


class Repository:
    """A repository in which the hook is installed as CONTRIBUTING.md describes."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        inherited = {name: value for name, value in os.environ.items() if name[:4] != "GIT_"}
        self.environment = inherited | IDENTITY | ALONE
        self.git("init", "-q", "-b", "main")
        (folder / ".githooks").symlink_to(ROOT / ".githooks")
        (command,) = [
            line.strip()
            for line in (ROOT / "CONTRIBUTING.md").read_text().splitlines()
            if line.startswith("    git config")
        ]
        self.git(*command.split("#")[0].split()[1:])

    def git(self, *arguments: str, check: bool = True) -> subprocess.CompletedProcess[str]:
        return subprocess.run(
            ["git", *arguments],
            cwd=self.folder,
            env=self.environment,
            capture_output=True,
            text=True,
            timeout=60,
            check=check,
        )

    def commit(self, message: str, *options: str) -> subprocess.CompletedProcess[str]:
        command = ["commit", "--allow-empty", "--cleanup=strip", "-m", message, *options]
        return self.git(*command, check=False)

    def subjects(self) -> list[str]:
        return self.git("log", "--topo-order", "--format=%s", check=False).stdout.splitlines()


@pytest.fixture
def repository(tmp_path: Path) -> Repository:
    """Give an empty repository with the hook."""
    return Repository(tmp_path)


@pytest.mark.parametrize(
    "message",
    [
        SUBJECT,
        f"{SUBJECT}\n\nThe reason is here: a long line, {'x' * 100}",
        f"{SUBJECT}\n# a comment of the editor",
        "tests, docs: name the locks in requirements/",
        "tools/update-locks: pass the hashes",
        "src/laws: need no table",
        "docs: write " + "ä" * 60,  # 72 characters, 132 bytes
        "build: " + "b" * 65,
        'Revert "whatever it was"',
        f"fixup! {SUBJECT}",
    ],
)
def test_a_message_of_the_form_is_accepted(repository: Repository, message: str) -> None:
    done = repository.commit(message)
    assert (done.returncode, done.stderr) == (0, "")
    assert repository.subjects() == [message.splitlines()[0]]


@pytest.mark.parametrize(
    ("message", "reason"),
    [
        ("limit the step", "not an area, a colon, a blank and a lower-case verb"),
        ("Radau: limit the step", "not an area, a colon, a blank and a lower-case verb"),
        ("radau: Limit the step", "not an area, a colon, a blank and a lower-case verb"),
        ("radau:limit the step", "not an area, a colon, a blank and a lower-case verb"),
        ("radau: limited the step", '"limited" is not an imperative'),
        ("radau: limiting the step", '"limiting" is not an imperative'),
        ("radau: limits the step", '"limits" is not an imperative'),
        ("radau: the step is limited", '"the" is not an imperative'),
        ("build: " + "b" * 66, "has 73 characters, more than 72"),
        (f"{SUBJECT}\nthe reason at once", "the second line is not blank"),
    ],
)
def test_another_message_is_refused_with_its_reason_and_a_remedy(
    repository: Repository, message: str, reason: str
) -> None:
    done = repository.commit(message)
    assert done.returncode == 1
    (line,) = done.stderr.splitlines()
    assert line.startswith(f'commit-msg: "{message.splitlines()[0]}": ')
    assert f"{reason}; " in line
    assert repository.subjects() == []


def test_the_changes_that_git_shows_in_the_editor_are_no_part_of_the_message(
    repository: Repository,
) -> None:
    (repository.folder / "file").write_text("text\n")
    repository.git("add", "file")
    repository.environment["GIT_EDITOR"] = f"sed -i '1s/.*/{SUBJECT}/'"
    repository.git("commit", "-v")
    assert repository.subjects() == [SUBJECT]


def test_a_merge_and_a_revert_keep_the_messages_of_git(repository: Repository) -> None:
    assert repository.commit(SUBJECT).returncode == 0
    repository.git("checkout", "-q", "-b", "side")
    (repository.folder / "file").write_text("text\n")
    repository.git("add", "file")
    assert repository.commit("tests: add a file").returncode == 0
    repository.git("checkout", "-q", "main")
    repository.git("merge", "--no-ff", "--no-edit", "side")
    repository.git("revert", "--no-edit", "side")
    assert repository.subjects()[:2] == ['Revert "tests: add a file"', "Merge branch 'side'"]
