"""The cases by which two revisions are compared: benchmarks/against.

A row is a command of one build; both builds read the same files, those of the present tree. A new
capability adds its row to ROWS.
"""

from __future__ import annotations

import json
import re
import sys
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from sweep_design import write_design
from train import row as train_of

ROOT = Path(__file__).resolve().parents[1]
EXAMPLES = ROOT / "examples"
RADAU, IDA = "simulation.integrator=radau", "simulation.integrator=ida"


@dataclass(frozen=True)
class Build:
    """A program, and the tree of its Python package."""

    program: Path
    tree: Path
    version: str  # as printed by the program


@dataclass(frozen=True)
class Row:
    """A case; `command` writes its input into a folder."""

    name: str
    command: Callable[[Build, Path], list[str]]
    by_python: bool = False  # the command runs the package of the build's tree


def of_run(name: str, case: str, *settings: str) -> Row:
    """Make a row of `evolvent run` of an example."""

    def command(build: Build, folder: Path) -> list[str]:
        words = [word for setting in settings for word in ("--set", setting)]
        history = str(folder / "history.h5")
        return [str(build.program), "run", "-q", str(EXAMPLES / case), "-o", history, *words]

    return Row(name, command)


def of_train(name: str, wheels: int, duration: float, integrator: str) -> Row:
    """Make a row of `evolvent run` of a train of wheels."""

    def command(build: Build, folder: Path) -> list[str]:
        case = folder / "train.yaml"
        case.write_text(json.dumps(train_of(wheels, duration, integrator, outputs=200)))
        history = str(folder / "history.h5")
        return [str(build.program), "run", "-q", str(case), "-o", history]

    return Row(name, command)


def of_batch(name: str, friction: float, tolerance: float, outputs: int, cases: int = 40) -> Row:
    """Make a row of `evolvent batch`: the paper's case, radau, closed form, 5 s, torque varied."""

    def command(build: Build, folder: Path) -> list[str]:
        text = (EXAMPLES / "paper-friction.yaml").read_text()
        text = re.sub(r"tracking: \w+", "tracking: closed_form", text)
        columns = {
            "wheels.pinion.loads.0.value": -np.linspace(0.5, 1.5, cases),
            "simulation.output_interval": np.full(cases, 5.0 / (outputs - 1)),
            "simulation.tolerance": np.full(cases, tolerance),
            "meshes.0.friction.coefficient": np.full(cases, friction),
        }
        design = folder / "design.h5"
        write_design(design, build.version, text, columns)
        results = folder / f"results-{len(list(folder.iterdir()))}"
        words = [str(build.program), "batch", str(design), "-o", str(results)]
        return [*words, "-q", "-j", "1"]

    return Row(name, command)


def of_words(name: str, *words: str) -> Row:
    """Make a row of any command; EXAMPLES in a word is their folder, OUTPUT a result file."""

    def command(build: Build, folder: Path) -> list[str]:
        paths = {"EXAMPLES": str(EXAMPLES), "OUTPUT": str(folder / "results.h5")}
        filled = [re.sub("|".join(paths), lambda found: paths[found[0]], word) for word in words]
        return [str(build.program), *filled]

    return Row(name, command)


def of_python(name: str, module: str, *words: str) -> Row:
    """Make a row of the start of a command of the package."""

    def command(_build: Build, _folder: Path) -> list[str]:
        code = f"import sys; from {module} import main; sys.argv[1:] = {list(words)}; main()"
        return [sys.executable, "-c", code]

    return Row(name, command, by_python=True)


TORQUES = "wheels.pinion.loads.0.value=-30 N m:-70 N m:41"
ROWS = [
    of_batch("paper's batch, f = 0, 2e-5, 11 outputs", 0.0, 2e-5, 11),
    of_batch("paper's batch, f = 0, 2e-5, 1001 outputs", 0.0, 2e-5, 1001),
    of_batch("paper's batch, f = 0.3, 1e-5, 11 outputs", 0.3, 1e-5, 11),
    of_batch("paper's batch, f = 0.3, 2e-7, 11 outputs", 0.3, 2e-7, 11),
    of_run("spur pair", "spur-pair.yaml"),
    of_run("pair with relief", "tip-relief.yaml"),
    of_run("compliant pair", "compliant-pair.yaml"),
    of_run("pair at high speed", "high-speed-pair.yaml"),
    of_run("tutorial's pair", "tutorial-pair.yaml"),
    of_run(
        "pair between motor and machine, 1 s, 50,000 outputs",
        "motor-driven.yaml",
        "simulation.duration=1",
        "simulation.output_interval=2e-5",
    ),
    of_run("two stages with shafts", "two-stage.yaml"),
    of_run("two stages of gears with a basic rack", "two-stage-gears.yaml"),
    of_run("tutorial's train", "tutorial-train.yaml"),
    of_run("rattle", "rattle.yaml"),
    of_train("50 wheels", 50, 3e-3, "radau"),
    of_run("paper, tracked points, IDA", "paper-friction.yaml"),
    of_run("spur pair, IDA", "spur-pair.yaml", IDA),
    of_run("compliant pair, IDA", "compliant-pair.yaml", IDA),
    of_run("rigid contact, IDA", "paper-rigid-friction.yaml"),
    of_words("static", "static", "EXAMPLES/compliant-pair.yaml", "-o", "OUTPUT", "-q"),
    of_words(
        "respond, 41 values",
        *("respond", "EXAMPLES/spur-pair.yaml", "--over", TORQUES, "-o", "OUTPUT", "-q"),
    ),
    of_words("modes", "modes", "EXAMPLES/two-stage-gears.yaml"),
    of_words("show", "show", "EXAMPLES/spur-pair.yaml"),
    of_python("evolvent-post --help", "evolvent.commands.post.app", "--help"),
    of_python("evolvent-sweep --help", "evolvent.commands.sweep.app", "--help"),
]
