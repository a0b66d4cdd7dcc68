"""FMUs in an importer, fmpy: made by the program, unpacked, driven by hand or by fmpy's masters."""

from __future__ import annotations

import ctypes
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

import fmpy
import numpy as np
from fmpy.fmi3 import FMU3Model, FMU3Slave

Make = Callable[..., Path]


class Fmu:
    """An instance of an FMU whose variables are known by name; what it tells is in `told`."""

    def __init__(self, path: Path, kind: type, folder: Path) -> None:
        """Unpack and instantiate."""
        self.logged: list[str] = []
        description = fmpy.read_model_description(str(path))
        self.references = {v.name: v.valueReference for v in description.modelVariables}
        self.variables = {v.name: v for v in description.modelVariables}
        self.unpacked = Path(fmpy.extract(str(path), unzipdir=str(folder)))
        self.fmu: Any = kind(
            guid=description.guid,
            unzipDirectory=str(self.unpacked),
            modelIdentifier=description.coSimulation.modelIdentifier,
            instanceName="one",
        )
        self.fmu.instantiate(logMessage=self._hear)

    def _hear(self, _environment: Any, _status: int, _category: bytes, text: bytes) -> None:
        self.logged.append(text.decode())

    def begin(self, stop: float | None = None) -> None:
        """Through the initialization."""
        self.fmu.enterInitializationMode(stopTime=stop)
        self.fmu.exitInitializationMode()

    def get(self, *names: str) -> np.ndarray:
        """Values of scalar variables."""
        return np.array(self.fmu.getFloat64([self.references[name] for name in names]))

    def set(self, **values: float) -> None:
        """Give values; a point in a name is written as two underscores."""
        names = [name.replace("__", ".") for name in values]
        self.fmu.setFloat64([self.references[name] for name in names], list(values.values()))

    def step(self, now: float, h: float) -> None:
        """One communication step."""
        self.fmu.doStep(now, h)

    def end(self) -> None:
        """Free it."""
        self.fmu.freeInstance()


def slave(path: Path, folder: Path) -> Fmu:
    """For co-simulation."""
    return Fmu(path, FMU3Slave, folder)


def model(path: Path, folder: Path) -> Fmu:
    """For model exchange."""
    return Fmu(path, FMU3Model, folder)


def simulate(path: Path, kind: str, output: Sequence[str], **options: Any) -> np.ndarray:
    """What fmpy's own master makes of it."""
    return fmpy.simulate_fmu(str(path), fmi_type=kind, output=list(output), **options)


def numbers(n: int) -> ctypes.Array[ctypes.c_double]:
    """Room for so many."""
    return (ctypes.c_double * n)()
