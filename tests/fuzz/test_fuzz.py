"""Any bytes to the reader of cases, by libFuzzer, with the sanitizers watching.

The fuzzer is part of the build with sanitizers if clang compiles its C code; the sanitizers watch
the kernel, too. `./runtests` lets it try for most of a minute, `./runtests --long` for an hour.
Where there is no clang there is no fuzzer, and the test is skipped. By hand, with more to choose:

    python tests/fuzz/test_fuzz.py build/sanitize -runs=1000000

What harms it and the slowest input, by processor time, are kept in the present folder.
"""

from __future__ import annotations

import re
import subprocess
import sys
import tempfile
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "tests"))  # by hand

import machine  # noqa: E402

LARGEST = 16384  # bytes of an input
# What ends it with a report: an input that takes so long [s], or so much memory [MB].
TIMEOUT, MEMORY = 2, 500
# Behind the text of a case, after zero bytes, options follow.
OPTIONS = (
    "wheels.pinion.teeth=21",
    "meshes.0.friction={law: stribeck}",
    "simulation.initial.kind=steady",
    "wheels.0.loads.0.value=3 N*m",
)


def words(program: Path) -> list[str]:
    """Keys, values and units that mean something in a case."""
    reported = [
        subprocess.run([program, "show", what], capture_output=True, text=True, check=True).stdout
        for what in ("--keys", "--units")
    ]
    return sorted(
        set(re.findall(r"`([^`\"\\\s]{2,40})`", reported[0]) + re.findall(r"\S{1,20}", reported[1]))
    )


def write_corpus(folder: Path, program: Path) -> None:
    """Where it begins: the examples, some with options; and words to put in."""
    (folder / "corpus").mkdir()
    examples = sorted((ROOT / "examples").glob("*.yaml"))
    for i, example in enumerate(examples):
        text = example.read_bytes()
        option = OPTIONS[i % len(OPTIONS)].encode()
        (folder / "corpus" / example.stem).write_bytes(text)
        (folder / "corpus" / f"{example.stem}-set").write_bytes(text + b"\0" + option)
    known = (
        f'"{word}"\n'
        for word in words(program)
        if '"' not in word and "\\" not in word and word.isascii()
    )
    (folder / "words.dict").write_text("".join(known), encoding="utf-8")


def fuzz(build: Path, folder: Path, *options: str) -> subprocess.CompletedProcess[str]:
    """Try inputs until the options say that it is enough, or one is found that does harm."""
    write_corpus(folder, build / "evolvent")
    # The most memory that a process had counts on when it becomes another, and pytest grows: a
    # shell's child begins anew.
    begin_anew = ["/bin/sh", "-c", '"$@"; exit $?', "sh"]
    return subprocess.run(
        [
            *begin_anew,
            build / "tests/fuzz/fuzz_case",
            f"-max_len={LARGEST}",
            f"-timeout={TIMEOUT}",
            f"-rss_limit_mb={MEMORY}",
            f"-dict={folder / 'words.dict'}",
            f"-artifact_prefix={folder}/",
            "-print_final_stats=1",
            "-report_slow_units=1",
            *options,
            str(folder / "corpus"),
        ],
        capture_output=True,
        text=True,
        env={
            "OPENBLAS_NUM_THREADS": "1",
            "ASAN_OPTIONS": "quarantine_size_mb=16",
            "FUZZ_SLOWEST": str(folder / "slowest"),
        },
    )


def has_tried(report: str) -> int:
    """How many inputs."""
    return int(re.findall(r"number_of_executed_units: *(\d+)", report)[0])


@pytest.mark.parametrize(
    "seconds", [40, pytest.param(3600, marks=pytest.mark.long)], ids=["most of a minute", "an hour"]
)
def test_no_bytes_break_the_reader_of_cases(seconds: int, tmp_path: Path) -> None:
    build = ROOT / "build" / "sanitize"
    if not (build / "tests/fuzz/fuzz_case").exists():
        machine.missing("no fuzzer in this build", "apt install clang libclang-rt-dev")
    ended = fuzz(build, tmp_path, f"-max_total_time={seconds}")
    assert ended.returncode == 0, ended.stderr[-5000:]
    assert has_tried(ended.stderr) > 1000  # it did try
    assert re.search(r"^slowest input: \d\.\d+ s", ended.stderr, re.MULTILINE), ended.stderr[-5000:]


if __name__ == "__main__":
    with tempfile.TemporaryDirectory() as temporary:
        reported = fuzz(Path(sys.argv[1]).resolve(), Path(temporary), *sys.argv[2:])
        print("\n".join(reported.stderr.splitlines()[-40:]))
        for kept in [*Path(temporary).glob("*-*"), Path(temporary) / "slowest"]:
            if kept.is_file():
                kept.replace(Path(kept.name))
                print(f"kept as {kept.name}")
    sys.exit(reported.returncode)
