"""What a release is made of agrees: version, citation, container, pins, scripts."""

from __future__ import annotations

import re
import subprocess
import tomllib
from pathlib import Path

import pytest
import yaml

from documents import ROOT, blocks

PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text())
CITATION = yaml.safe_load((ROOT / "CITATION.cff").read_text())
CHANGELOG = (ROOT / "CHANGELOG.md").read_text()
DOCKERFILE = (ROOT / "Dockerfile").read_text()
LOCKS = sorted(path.stem for path in (ROOT / "requirements").glob("*.lock"))
LOCK = re.compile(r"\brequirements/[\w.-]+\.lock\b")


def version() -> str:
    """The version where it stands."""
    found = re.search(
        r"project\(\s*evolvent\s+VERSION ([0-9.]+)", (ROOT / "CMakeLists.txt").read_text()
    )
    assert found
    return found[1]


def number(text: str) -> tuple[int, ...]:
    """Give a version as numbers that can be compared."""
    return tuple(int(part) for part in text.split("."))


def changelog() -> dict[str, str]:
    """Give the text of each section of the changelog by its heading, in order."""
    _, *parts = re.split(r"^## (.*)$", CHANGELOG, flags=re.MULTILINE)
    return dict(zip(parts[::2], map(str.strip, parts[1::2]), strict=True))


def test_the_version_is_read_from_cmakelists_and_stands_in_no_other_place(executable: Path) -> None:
    said = subprocess.run([executable, "--version"], capture_output=True, text=True, check=True)
    assert said.stdout.splitlines()[0] == f"evolvent {version()}"
    assert PROJECT["project"]["dynamic"] == ["version"]
    reader = PROJECT["tool"]["scikit-build"]["metadata"]["version"]
    found = re.search(reader["regex"], (ROOT / reader["input"]).read_text())
    assert found
    assert found["value"] == version()
    for name in ("pyproject.toml", "CITATION.cff", "Dockerfile", "README.md", "environment.yml"):
        assert version() not in (ROOT / name).read_text(), f"{name} would have to be changed too"


def test_the_changelog_has_unreleased_changes_and_then_versions() -> None:
    """In the form of Keep a Changelog; only the newest version may have no date yet."""
    first, *versions = changelog()
    assert first == "[Unreleased]"
    assert versions
    for index, head in enumerate(versions):
        dated = re.fullmatch(r"\[\d+\.\d+\.\d+\] - (\d{4}-\d\d-\d\d|not released)", head)
        assert dated, head
        assert index == 0 or dated[1] != "not released"
    kinds = {"Added", "Changed", "Deprecated", "Removed", "Fixed", "Security"}
    assert set(re.findall(r"^### (.*)$", CHANGELOG, re.MULTILINE)) <= kinds


def test_the_version_is_the_newest_of_the_changelog_or_that_of_the_unreleased_changes() -> None:
    sections = changelog()
    newest = next(head for head in sections if head != "[Unreleased]")
    released, date = re.fullmatch(r"\[(.*)\] - (.*)", newest).groups()
    if sections["[Unreleased]"] and date != "not released":
        assert number(version()) > number(released)
    else:
        assert version() == released


def test_a_release_of_the_changelog_is_recorded_with_its_commit() -> None:
    """But the newest one until the commit after it."""
    dated = re.findall(r"^## \[([0-9.]+)\] - (\d{4}-\d\d-\d\d)$", CHANGELOG, re.MULTILINE)
    rows = re.findall(
        r"^\| ([0-9.]+) \| (\S+) \| ([0-9a-f]{40}) \|$",
        (ROOT / "docs/reports/releases.md").read_text(),
        re.MULTILINE,
    )
    assert [row[:2] for row in rows] in (dated, dated[1:])


def test_the_citation_is_complete_and_agrees_with_the_project() -> None:
    """The keys that the format's version 1.2.0 requires; a whole check is part of the release."""
    assert CITATION["cff-version"] == "1.2.0"
    assert CITATION["message"]
    assert CITATION["title"] == PROJECT["project"]["name"]
    assert [author["name"] for author in CITATION["authors"]] == [
        author["name"] for author in PROJECT["project"]["authors"]
    ]
    assert CITATION["license"] == PROJECT["project"]["license"]


def test_the_citation_names_the_paper_as_the_readme_does() -> None:
    (bibtex,) = blocks(ROOT / "README.md", "bibtex")
    entry = dict(re.findall(r"(\w+)\s+= \{(.*)\},?$", bibtex, re.MULTILINE))
    (paper,) = CITATION["references"]
    authors = [f"{one['family-names']}, {one['given-names']}" for one in paper["authors"]]
    assert " and ".join(authors) == entry["author"]
    assert paper["title"] == entry["title"]
    assert paper["doi"] == entry["doi"]
    assert str(paper["year"]) == entry["year"]
    assert f"{paper['start']}--{paper['end']}" == entry["pages"]


def test_the_container_copies_and_runs_files_that_are_there() -> None:
    copied = re.findall(r"^COPY (?!--from)(\S+) ", DOCKERFILE, re.MULTILINE)
    assert copied
    for name in copied:
        assert (ROOT / name).exists()
    (lock,) = re.findall(r"--require-hashes -r /evolvent/(\S+)", DOCKERFILE)
    assert lock in [Path(name).name for name in copied]
    (script,) = re.findall(r"^RUN /evolvent/(\S+)", DOCKERFILE, re.MULTILINE)
    assert (ROOT / script).stat().st_mode & 0o111


def test_the_pipeline_checks_out_and_calls_the_script_of_all_checks() -> None:
    (workflow,) = (ROOT / ".github/workflows").glob("*.yml")
    (job,) = yaml.safe_load(workflow.read_text())["jobs"].values()
    used = [step["uses"] for step in job["steps"] if "uses" in step]
    assert [name.partition("@")[0] for name in used] == [
        "actions/checkout",
        "actions/upload-artifact",
    ]
    assert all(re.fullmatch(r"[\w/-]+@v\d+\.\d+\.\d+", name) for name in used)
    (command,) = [step["run"] for step in job["steps"] if ".ci/run" in step.get("run", "")]
    assert command.endswith(" && .ci/run")
    script = ROOT / ".ci/run"
    assert script.stat().st_mode & 0o111
    assert script.read_text().splitlines()[-1].startswith("exec ./runtests")


def test_the_scripts_name_every_lock_and_no_other() -> None:
    scripts = ["quickstart", "runtests", "reproduce-paper", "Dockerfile", "tools/build-wheel"]
    named = {
        name for script in scripts for name in LOCK.findall((ROOT / script).read_text("utf-8"))
    }
    assert named == {f"requirements/{name}.lock" for name in LOCKS}
    assert set(LOCK.findall((ROOT / "tools/update-locks").read_text("utf-8"))) == named


@pytest.mark.parametrize("name", LOCKS)
def test_every_package_is_pinned_by_version_and_hash(name: str) -> None:
    lines = (ROOT / f"requirements/{name}.lock").read_text().replace("\\\n", " ").splitlines()
    requirements = [line for line in lines if line and not line.lstrip().startswith("#")]
    assert len(requirements) > 5
    for requirement in requirements:
        assert re.match(r"[\w.-]+==[\w.]+ ", requirement), requirement
        assert re.search(r"--hash=sha256:[0-9a-f]{64}\b", requirement), requirement


@pytest.mark.parametrize("script", ["build-wheel", "check-wheel"])
def test_a_script_for_wheels_tells_what_it_does_and_refuses_other_options(script: str) -> None:
    def done(*arguments: str) -> subprocess.CompletedProcess[str]:
        return subprocess.run(
            [ROOT / "tools" / script, *arguments],
            capture_output=True,
            text=True,
            timeout=60,
            check=False,
        )

    helped = done("--help")
    assert helped.returncode == 0
    assert helped.stdout.startswith(f"{script} [")
    assert done("--no-such-option").returncode == 2
    assert done("one", "two").returncode == 2
