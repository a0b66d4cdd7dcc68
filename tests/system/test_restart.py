"""A run that is stopped at random times and resumed writes the history of an uninterrupted one.

Every value and attribute is the same to the bit. With IDA, the reference is a run with checkpoints
at the same model times, which are in the history.
"""

from __future__ import annotations

import random
import signal
import subprocess
import time
from collections.abc import Callable
from pathlib import Path

import h5py
import pytest

from histories import contents
from processes import running
from system.random_sets import seeds

Evolvent = Callable[..., subprocess.CompletedProcess[str]]
CLOSED, IDA, RADAU = (
    "meshes.0.tracking=closed_form",
    "simulation.integrator=ida",
    "simulation.integrator=radau",
)

MOUNTED = (
    "housing={kind: mounted, mass: 300, inertia: [20, 35, 40], centre_of_mass: [0.05, -0.1, 0],"
    " mount: {point: [0.05, -0.2, 0], stiffness: [5e6, 2e7, 5e6], damping: [1e3, 2e3, 1e3],"
    " rotational_stiffness: [1e6, 1e6, 2e6], rotational_damping: [100, 100, 100]},"
    " accelerometers: [{name: foot, point: [0, -0.2, 0], direction: [0, 1, 0]}]}"
)
SHAKEN = (
    "housing={kind: prescribed,"
    " rotation: [{kind: harmonic, axis: x, amplitude: 0.1, frequency: 25}],"
    " translation: [{kind: harmonic, axis: y, amplitude: 1e-3, frequency: 40}]}"
)
AT_REST = "simulation.initial={kind: rest}"

#: Some tenths of a second each: every tracking, both integrators, rattling, sticking and rigid
#: contacts, trains, compliant wheels, moving and mounted housings, metrics.
SAMPLES = {
    "rattle": ("rattle.yaml", RADAU, "simulation.duration=4"),
    "rattle-ida": ("rattle.yaml", IDA, "simulation.duration=0.5"),
    "friction": ("paper-friction.yaml", CLOSED, RADAU, "simulation.duration=40"),
    "friction-ida": ("paper-friction.yaml", IDA, "simulation.duration=20"),
    "differential": ("paper.yaml", "meshes.0.tracking=differential", "simulation.duration=40"),
    "algebraic": ("paper.yaml", "meshes.0.tracking=algebraic", "simulation.duration=40"),
    "rigid": ("paper-rigid-friction.yaml", IDA, "simulation.duration=40"),
    "gears": ("spur-pair.yaml", RADAU, "simulation.duration=0.8"),
    "gears-ida": ("spur-pair.yaml", IDA, "simulation.duration=0.2"),
    "train": ("two-stage-gears.yaml", RADAU, "simulation.duration=0.6"),
    "train-ida": ("two-stage-gears.yaml", IDA, "simulation.duration=0.1"),
    "relief": ("tip-relief.yaml", RADAU),
    "yielding": ("compliant-pair.yaml", RADAU),
    "yielding-ida": ("compliant-pair.yaml", IDA, "simulation.duration=0.02"),
    "yielding-alone": ("compliant-pair.yaml", RADAU, "meshes.0.tooth_coupling=false"),
    "yielding-shaken": ("compliant-pair.yaml", RADAU, SHAKEN, AT_REST),
    "housing-ida": ("spur-pair.yaml", IDA, MOUNTED, "simulation.duration=0.1"),
    "train-housing-ida": ("two-stage-gears.yaml", IDA, MOUNTED, "simulation.duration=0.05"),
    "train-shaken": ("two-stage-gears.yaml", RADAU, SHAKEN, AT_REST, "simulation.duration=0.3"),
    "numbers": ("tutorial-pair.yaml", RADAU, "simulation.outputs=meshes"),
    "motor": ("motor-driven.yaml", RADAU),
}
WAYS = (signal.SIGKILL, signal.SIGKILL, signal.SIGTERM, signal.SIGUSR1, "--max-time")
STOPS = 6  # maximum stops of a run: 63 seeds make more than 200
N_SEEDS = 63  # three for each sample


def go_on(
    executable: Path, words: list[str], folder: Path, way: signal.Signals | str, seconds: float
) -> int:
    """Run, or resume, for some time; return the exit code, negative after a signal that kills."""
    limit = ["--max-time", str(seconds / 60)] if way == "--max-time" else []
    with running(
        [executable, *words, *limit], folder, stderr=subprocess.PIPE, text=True
    ) as process:
        if isinstance(way, signal.Signals):
            try:
                process.wait(timeout=seconds)
            except subprocess.TimeoutExpired:
                process.send_signal(way)
        _, errors = process.communicate(timeout=60)
    assert process.returncode in (0, 75, -way if isinstance(way, signal.Signals) else 75), errors
    return int(process.returncode)


@pytest.mark.parametrize("seed", seeds(range(8), N_SEEDS))
def test_a_run_stopped_at_random_has_the_bits_of_one_that_was_not(
    executable: Path,
    evolvent: Evolvent,
    examples: Path,
    tmp_path: Path,
    seed: int,
    record_property: Callable[[str, object], None],
) -> None:
    rng = random.Random(seed)
    name, *sets = SAMPLES[sorted(SAMPLES)[seed % len(SAMPLES)]]
    words = ["run", str(examples / name), *(w for s in sets for w in ("--set", s)), "-q"]
    begun = time.monotonic()
    whole = evolvent(*words, "-o", "whole.h5")
    length = time.monotonic() - begun
    assert whole.returncode == 0, whole.stderr
    stopped = [*words, "-o", "stopped.h5"]
    codes = []
    for _ in range(STOPS):
        folder = tmp_path / "stopped.h5.parts"
        again = ["--continue"] if (folder / "checkpoint.h5").exists() else []
        code = go_on(
            executable,
            [*stopped, "--checkpoint", str(length / 20 / 60), *again],
            tmp_path,
            rng.choice(WAYS),
            length * rng.uniform(0.1, 0.7),
        )
        codes.append(code)
        if code == 0:
            break
    record_property("stops", sum(code != 0 for code in codes))
    if codes[-1] != 0:
        again = ["--continue"] if (folder / "checkpoint.h5").exists() else ["--checkpoint", "1"]
        result = evolvent(*stopped, *again)
        assert result.returncode == 0, result.stderr
    assert not folder.exists()
    with h5py.File(tmp_path / "stopped.h5") as file:
        times = file.attrs.get("checkpoints", "")
    if times:
        assert RADAU not in sets
        result = evolvent(*words, "-o", "whole.h5", "--checkpoint-at", times)
        assert result.returncode == 0, result.stderr
    assert contents(tmp_path / "stopped.h5") == contents(tmp_path / "whole.h5")
