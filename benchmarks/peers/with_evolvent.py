"""evolvent itself: h from `evolvent run`, processor times from `evolvent batch`.

What a user pays for a case is the time of the whole process over its cases. Of that the journal
tells the integration's: from the initial state to the end, with all quantities that are derived at
the outputs.
"""

from __future__ import annotations

import hashlib
import json
import resource
import subprocess
import tempfile
from pathlib import Path

import h5py
import numpy as np
from paper_case import DURATION, N_OUTPUTS, Array

ROOT = Path(__file__).resolve().parents[2]
TORQUE = "wheels.pinion.loads.0.value"
SPREAD = 0.2  # of the torques of a batch


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


def children_seconds() -> float:
    """Processor time of all processes that have ended."""
    spent = resource.getrusage(resource.RUSAGE_CHILDREN)
    return spent.ru_utime + spent.ru_stime


def seconds(
    program: Path, integrator: str, friction: float, tolerance: float, n: int
) -> tuple[float, float]:
    """Processor time of a case in a batch of n [s]: of the whole process, of the integration."""
    with tempfile.TemporaryDirectory() as folder:
        design = Path(folder) / "design.h5"
        write_design(design, program, integrator, friction, tolerance, n)
        results = Path(folder) / "results"
        begin = children_seconds()
        subprocess.run([program, "batch", design, "-o", results, "-q"], check=True)
        whole = children_seconds() - begin
        journal = (results / "shard-1-of-1.jsonl").read_text(encoding="utf-8").splitlines()
        return whole / n, sum(json.loads(line)["cpu_time"] for line in journal[1:]) / n


def write_design(
    path: Path, program: Path, integrator: str, friction: float, tolerance: float, n: int
) -> None:
    """Write a design of n cases, whose torques are spread around the paper's."""
    version = subprocess.run([program, "--version"], capture_output=True, text=True, check=True)
    columns: dict[str, object] = dict(settings(integrator, tolerance))
    torques = [repr(-1 + SPREAD * ((i + 0.5) / n - 0.5)) for i in range(n)]
    with h5py.File(path, "w") as design:
        design.attrs.update(
            evolvent_design_format=1,
            evolvent_version=version.stdout.split()[1],
            title="one case with many torques",
            case=case_file(friction).read_text(encoding="utf-8"),
            hash=hashlib.sha256(repr((columns, friction, n)).encode()).hexdigest(),
            window=[0.0, DURATION],
            history_variables="",
            history_every=1,
            n_cases=n,
        )
        all_columns = {where: [value] * n for where, value in columns.items()} | {TORQUE: torques}
        for i, (where, values) in enumerate(all_columns.items()):
            texts = np.array(values, dtype=object)
            column = design.create_dataset(
                f"parameters/p{i}", data=texts, dtype=h5py.string_dtype("utf-8")
            )
            column.attrs["path"] = where
