"""Kernels for newer processors: the loader selects one of them, with identical results."""

from __future__ import annotations

import os
import re
import shutil
import subprocess
from collections.abc import Callable
from pathlib import Path

import pytest
import yaml

import machine
from histories import contents

Evolvent = Callable[..., subprocess.CompletedProcess[str]]
LIBRARY = "libevolvent_kernel.so.0"
BASELINE = "x86-64"
PROCESSORS = {"x86-64-v3": "avx2", "x86-64-v4": "avx512vl"}  # with a flag that identifies them
EXAMPLES = Path(__file__).parents[2] / "examples"
CASES = sorted(
    path.name for path in EXAMPLES.glob("*.yaml") if "meshes" in yaml.safe_load(path.read_text())
)


def has_flag(flag: str) -> bool:
    """Whether the processor has this feature, according to Linux."""
    cpuinfo = Path("/proc/cpuinfo")
    return (
        cpuinfo.is_file()
        and re.search(rf"^flags.*\b{flag}\b", cpuinfo.read_text(), re.M) is not None
    )


@pytest.fixture
def with_kernel(executable: Path, tmp_path: Path) -> Callable[[str], dict[str, str]]:
    """Environment in which the program finds only the kernel of one processor."""
    folder = executable.resolve().parent
    if not (folder / "glibc-hwcaps").is_dir():
        machine.unavailable("this build has one kernel only (EVOLVENT_VARIANTS=OFF)")

    def environment(processor: str) -> dict[str, str]:
        if processor != BASELINE and not has_flag(PROCESSORS[processor]):
            machine.unavailable(f"this processor is no {processor}")
        directory = folder if processor == BASELINE else folder / "glibc-hwcaps" / processor
        alone = tmp_path / processor  # without folders of variants beside it
        alone.mkdir()
        (alone / LIBRARY).symlink_to(directory / LIBRARY)
        return {**os.environ, "LD_LIBRARY_PATH": str(alone)}

    return environment


def kernel_processor(evolvent: Evolvent, **options: object) -> str:
    """The processor for which the loaded kernel was compiled."""
    result = evolvent("--version", **options)
    assert result.returncode == 0, result.stderr
    return result.stdout.splitlines()[-1].removeprefix("kernel compiled for ")


@pytest.mark.parametrize("processor", [BASELINE, *PROCESSORS])
def test_each_kernel_is_compiled_for_the_processor_of_its_folder(
    evolvent: Evolvent, with_kernel: Callable[[str], dict[str, str]], processor: str
) -> None:
    assert kernel_processor(evolvent, env=with_kernel(processor)) == processor


@pytest.mark.parametrize("integrator", ["radau", "ida"])
@pytest.mark.parametrize("tracking", ["closed_form", "algebraic", "differential"])
@pytest.mark.parametrize("case", CASES)
def test_the_kernel_of_a_newer_processor_writes_the_same_history_to_the_bit(
    evolvent: Evolvent,
    with_kernel: Callable[[str], dict[str, str]],
    examples: Path,
    tmp_path: Path,
    case: str,
    tracking: str,
    integrator: str,
) -> None:
    text = yaml.safe_load((examples / case).read_text())
    text["meshes"][0]["tracking"] = tracking
    text["simulation"]["integrator"] = integrator
    if integrator == "ida":  # three times as slow as radau; a fourth has the same kinds of events
        value, _, unit = str(text["simulation"]["duration"]).partition(" ")
        text["simulation"]["duration"] = f"{float(value) / 4} {unit}".strip()
        text["simulation"].pop("metrics", None)  # their window would not be there
    (tmp_path / case).write_text(yaml.safe_dump(text))

    def outcome(processor: str) -> tuple[int, str, tuple[object, ...]]:
        history = tmp_path / f"{processor}.h5"
        kernel = with_kernel(processor)
        result = evolvent("run", tmp_path / case, "-q", "-o", history, env=kernel)
        return result.returncode, result.stderr, contents(history) if history.exists() else ()

    newer = [processor for processor, flag in PROCESSORS.items() if has_flag(flag)]
    if not newer:
        machine.unavailable("this processor runs one kernel only")
    assert len({outcome(processor) for processor in (BASELINE, *newer)}) == 1


def test_no_kernel_holds_a_fused_product_and_sum(executable: Path) -> None:
    """Also for code that no example covers: fused operations would give other bits elsewhere."""
    kernels = [*executable.resolve().parent.glob(f"**/{LIBRARY}")]
    assert kernels
    for kernel in kernels:
        text = subprocess.run(
            [machine.program("objdump"), "-d", "--no-show-raw-insn", kernel],
            capture_output=True,
            text=True,
            check=True,
        )
        assert re.findall(r"\tvfn?m\w+.*", text.stdout) == [], kernel


def test_a_processor_with_avx512_gets_its_kernel_unasked_also_through_a_link(
    executable: Path, with_kernel: Callable[[str], dict[str, str]], tmp_path: Path
) -> None:
    with_kernel("x86-64-v4")  # skips if it cannot run
    link = tmp_path / "evolvent"
    link.symlink_to(executable.resolve())
    for program in (executable, link):
        text = subprocess.run([program, "--version"], capture_output=True, text=True, check=True)
        assert text.stdout.splitlines()[-1] == "kernel compiled for x86-64-v4"


def test_a_program_moved_with_its_baseline_kernel_alone_runs_with_that(
    executable: Path, with_kernel: Callable[[str], dict[str, str]], tmp_path: Path
) -> None:
    with_kernel(BASELINE)  # skips if there is one kernel only
    program = Path(shutil.copy2(executable, tmp_path / "evolvent"))
    shutil.copy2(executable.resolve().parent / LIBRARY, tmp_path)
    text = subprocess.run([program, "--version"], capture_output=True, text=True, check=True)
    assert text.stdout.splitlines()[-1] == f"kernel compiled for {BASELINE}"
