"""Runs of the program for the system tests, each made once."""

from __future__ import annotations

import json
import subprocess
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr

TRACKINGS = ("closed_form", "algebraic", "differential")
TRACKED = TRACKINGS[1:]  # those that track points instead of using the closed form
FRICTIONLESS, FRICTION = "paper.yaml", "paper-friction.yaml"

RIGID = ("meshes.0.contact={law: rigid}", "meshes.0.damping={law: none}")  # settings


@dataclass(frozen=True)
class Run:
    """Result of a run: its messages, and its history in memory."""

    exit_code: int
    messages: str  # on stderr
    path: Path  # of the history; of the partial one if the run failed
    history: xr.Dataset
    events: xr.Dataset

    def times(self, kind: str) -> Any:
        """Times of the events of a kind [s]."""
        return self.events["time"].values[self.events["kind"].values == kind]


@dataclass
class Runs:
    """Makes and caches runs: ``runs("paper.yaml", "simulation.duration=20")``."""

    executable: Path
    examples: Path
    folder: Path
    made: dict[str, Run] = field(default_factory=dict)

    def __call__(self, case: str | dict[str, Any], *settings: str, copy: int = 0) -> Run:
        """Run a case with changes by --set; another `copy` repeats the run.

        The case is the name of an example, or the content of a case file.
        """
        key = json.dumps([case, settings, copy])
        if key not in self.made:
            self.made[key] = self._run(case, settings, f"{len(self.made)}")
        return self.made[key]

    def _run(self, case: str | dict[str, Any], settings: tuple[str, ...], stem: str) -> Run:
        if isinstance(case, str):
            file = self.examples / case
        else:
            file = self.folder / f"{stem}.yaml"
            file.write_text(json.dumps(case))  # JSON is YAML
        output = self.folder / f"{stem}.h5"
        options = [word for setting in settings for word in ("--set", setting)]
        done = subprocess.run(
            [self.executable, "run", file, "-o", output, *options],
            capture_output=True,
            text=True,
            timeout=300,
            check=False,
        )
        path = output if done.returncode == 0 else output.with_name(f"{output.name}.partial")
        assert path.exists(), done.stderr
        # The engine netcdf4 opens a file twenty times faster than h5netcdf.
        with (
            xr.open_dataset(path, engine="netcdf4") as history,
            xr.open_dataset(path, engine="netcdf4", group="events") as events,
        ):
            named = events.load().assign(kind=named_kinds(events["kind"]))
            return Run(done.returncode, done.stderr, path, history.load(), named)


def named_kinds(kind: xr.DataArray) -> xr.DataArray:
    """Names of the kinds of events."""
    names = dict(zip(kind.attrs["flag_values"], kind.attrs["flag_meanings"].split(), strict=True))
    return kind.copy(data=np.array([names[value] for value in kind.values], dtype="U31"))


def tracking(kind: str) -> str:
    """Setting for the tracking of the first mesh."""
    return f"meshes.0.tracking={kind}"
