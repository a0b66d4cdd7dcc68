"""evolvent itself: h from `evolvent run`, the time of the integration from `evolvent batch`.

A batch measures each of its cases alone, by the clock of its thread: from the initial state to the
end, with all quantities that it derives at the outputs, without reading the case, without files.
"""

from __future__ import annotations

import hashlib
import json
import subprocess
import tempfile
from pathlib import Path

import h5py
import numpy as np
from paper_case import DURATION, N_OUTPUTS, Array

ROOT = Path(__file__).resolve().parents[2]


def case_file(friction: float) -> Path:
    """Return the example that is the paper's setup."""
    return ROOT / "examples" / ("paper-friction.yaml" if friction > 0 else "paper.yaml")


def settings(integrator: str, tolerance: float) -> dict[str, str]:
    """What differs from the example."""
    given = {
        "meshes.0.tracking": "closed_form",
        "simulation.output_interval": repr(DURATION / (N_OUTPUTS - 1)),
        "simulation.tolerance": repr(tolerance),
    }
    return given | ({"simulation.integrator": integrator} if integrator else {})


def run(program: Path, integrator: str, friction: float, tolerance: float) -> Array:
    """Penetration at the outputs [m]."""
    with tempfile.TemporaryDirectory() as folder:
        output = Path(folder) / "history.h5"
        command = [program, "run", case_file(friction), "-o", output]
        for key, value in settings(integrator, tolerance).items():
            command += ["--set", f"{key}={value}"]
        subprocess.run(command, check=True, capture_output=True)
        with h5py.File(output) as history:
            return np.array(history["penetration"])[:, 0]


def seconds(
    program: Path, integrator: str, friction: float, tolerance: float, n: int
) -> list[float]:
    """Processor times of the integration of n equal cases [s]."""
    with tempfile.TemporaryDirectory() as folder:
        design = Path(folder) / "design.h5"
        write_design(design, program, integrator, friction, tolerance, n)
        results = Path(folder) / "results"
        subprocess.run([program, "batch", design, "-o", results, "-q"], check=True)
        journal = (results / "shard-1-of-1.jsonl").read_text(encoding="utf-8").splitlines()
        return [json.loads(line)["cpu_time"] for line in journal[1:]]


def write_design(
    path: Path, program: Path, integrator: str, friction: float, tolerance: float, n: int
) -> None:
    """Write a design of n equal cases."""
    version = subprocess.run([program, "--version"], capture_output=True, text=True, check=True)
    columns: dict[str, object] = dict(settings(integrator, tolerance))
    with h5py.File(path, "w") as design:
        design.attrs.update(
            evolvent_design_format=1,
            evolvent_version=version.stdout.split()[1],
            title="one case many times",
            case=case_file(friction).read_text(encoding="utf-8"),
            hash=hashlib.sha256(repr((columns, friction, n)).encode()).hexdigest(),
            window=[0.0, DURATION],
            history_variables="",
            history_every=1,
            n_cases=n,
        )
        for i, (where, value) in enumerate(columns.items()):
            texts = np.full(n, value, dtype=object)
            column = design.create_dataset(
                f"parameters/p{i}", data=texts, dtype=h5py.string_dtype("utf-8")
            )
            column.attrs["path"] = where


def knows_integrators(program: Path) -> bool:
    """Whether a case can name its integrator."""
    command = [program, "show", case_file(0.0), "--set", "simulation.integrator=ida"]
    return subprocess.run(command, capture_output=True).returncode == 0
