"""Design of a sweep in a file: a base case and a table case x parameter.

The only module that depends on the layout of DESIGN.h5; `evolvent batch` reads the same layout, and
docs/guides/sweeps.md describes it.

Unlike journals, designs are read here and not by the program: four columns of a million cases take
0.03 s of processor time this way, but 2.7 s as lines of JSON (0.7 s to print, 2 s to parse), 1.4 s
as lists. The program reads what determines a case (case, hash, n_cases, window, histories, paths
and values); title, plan, method, seed, sampling, names and units are read only by this module.
"""

from __future__ import annotations

import dataclasses
import hashlib
import json
import math
import re
from collections.abc import Sequence
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path
from typing import Any

import h5py
import numpy as np

from evolvent.checksums import BROKEN, USER_BLOCK, check, prepend_checksum
from evolvent.errors import SweepError, reason_of, replacing_hdf5

FORMAT = 1
IDENTITY = "evolvent design 1"  # prefix of the hashed data
LAST_HALF = (math.nan, math.nan)  # the window that is the last half of each case's duration
NAME = re.compile(r"[A-Za-z_][A-Za-z0-9_]*")
TEXT = h5py.string_dtype("utf-8")
# Attributes of the file by the names of their fields.
TEXTS = ("title", "case", "plan", "method")
NUMBERS = ("n_cases", "history_every", "history_rows", "seed")


@dataclass(frozen=True)
class Parameter:
    """One column of the design."""

    name: str  # a netCDF identifier
    path: str  # as for --set; "" for a column used only in, or computed by, expressions
    units: str
    values: np.ndarray  # (case): float64, int64, or object holding YAML text
    derived: bool = False  # computed by an expression from the other parameters

    @property
    def is_text(self) -> bool:
        """Whether the values are YAML text rather than numbers."""
        return self.values.dtype == object


@dataclass(frozen=True)
class Respond:
    """Definition of each case as a response (docs/guides/response.md) instead of a run."""

    over: str  # PATH=FROM:TO[:STEPS]
    direction: str  # up, down or both
    periods: int  # at a value; 0: the default number


@dataclass(frozen=True)
class Design:
    """Complete definition of a sweep."""

    title: str
    case: str  # the base case, YAML text
    parameters: tuple[Parameter, ...]
    n_cases: int
    window: tuple[float, float]  # of the statistics [s], or `LAST_HALF`
    metrics: tuple[str, ...]  # over whole periods, in addition to the default ones
    history_variables: tuple[str, ...]
    history_every: int
    plan: str  # text of the plan that made the design
    method: str
    seed: int
    version: str  # of the program evolvent that it was made for
    # Data of the samples for an analysis: names of the sampled parameters and so on.
    sampling: dict[str, Any] = field(default_factory=dict)

    history_rows: int = 0  # rows stored for outputs by position; 0 for outputs by time
    respond: Respond | None = None  # None: each case is a run
    maker: str = ""  # hash assigned by another program

    @cached_property
    def hash(self) -> str:
        """Identity of the results: SHA-256 over all data that determine them.

        The program computes the same (driver/files/design_hash.c); docs/guides/batch.md
        describes it.
        """
        columns = [p for p in self.parameters if p.path]
        digest = hashlib.sha256(b"".join(_text(t) for t in (IDENTITY, self.maker, self.case)))
        digest.update(np.array(self.window, dtype="<f8").tobytes())
        for words in (self.metrics, self.history_variables):
            digest.update(_integer(len(words)) + b"".join(map(_text, words)))
        for number in (self.history_every, self.history_rows):
            digest.update(_integer(number))
        if self.respond is not None:
            words = ("respond", self.respond.over, self.respond.direction)
            digest.update(b"".join(map(_text, words)) + _integer(self.respond.periods))
        for number in (self.n_cases, len(columns)):
            digest.update(_integer(number))
        for p in columns:
            kind = "text" if p.is_text else "real" if p.values.dtype.kind == "f" else "integer"
            digest.update(_text(p.path) + _text(kind))
            if p.is_text:
                digest.update(b"".join(map(_text, p.values)))
            else:
                digest.update(p.values.astype("<f8" if kind == "real" else "<i8").tobytes())
        return digest.hexdigest()

    @property
    def sampling_text(self) -> str:
        """`sampling` as JSON."""
        return json.dumps(self.sampling)


def _integer(number: int) -> bytes:
    return number.to_bytes(8, "little", signed=True)


def _text(text: str) -> bytes:
    """Encode with the length first: distinct sequences of texts have distinct encodings."""
    return _integer(len(text.encode())) + text.encode()


def identifier(path: str) -> str:
    """Convert a path to a name: wheels.pinion.teeth becomes wheels_pinion_teeth."""
    name = re.sub(r"\W+", "_", path, flags=re.ASCII).strip("_")
    return name if NAME.fullmatch(name) else f"p_{name}"


def take(design: Design, cases: Sequence[int]) -> Design:
    """Return a design with some cases of another."""
    chosen = np.asarray(cases, dtype=np.int64)
    parameters = tuple(dataclasses.replace(p, values=p.values[chosen]) for p in design.parameters)
    return dataclasses.replace(design, parameters=parameters, n_cases=chosen.size)


def write_design(design: Design, path: Path) -> None:
    """Write DESIGN.h5; an older one is replaced when the new one is complete.

    Raises
    ------
    SweepError
        It could not be written.
    """
    with (
        replacing_hdf5(path, prepend_checksum) as stream,
        h5py.File(stream, "w", userblock_size=USER_BLOCK) as file,
    ):
        _write(design, file)


def read_design(path: Path) -> Design:
    """Read DESIGN.h5.

    Raises
    ------
    SweepError
        No such file, no design, of a newer format, or damaged.
    """
    if not path.exists():
        raise SweepError(f"{path}: no such file; make it with `evolvent-sweep plan`")
    try:
        if check(path) == BROKEN:  # before HDF5 reads it, which does not detect damage
            raise SweepError(
                f"{path}: is damaged, or was changed: its checksum is wrong; use an intact copy, "
                "or plan it again"
            )
        with h5py.File(path, "r") as file:
            _check_format(path, file)
            design, given = _read(file)
    except OSError as error:
        raise SweepError(f"{path}: is not a readable HDF5 file ({reason_of(error)})") from error
    except (KeyError, TypeError, ValueError) as error:
        raise SweepError(f"{path}: is not a complete design ({error}); plan it again") from error
    if design.plan and design.hash != given:
        raise SweepError(
            f"{path}: its values do not match its hash, so it was changed; plan it anew"
        )
    return design


def _write(design: Design, file: h5py.File) -> None:
    file.attrs.update({name: getattr(design, name) for name in (*TEXTS, *NUMBERS, "hash")})
    file.attrs.update(
        evolvent_design_format=FORMAT,
        evolvent_version=design.version,
        window=design.window,
        numbers=" ".join(design.metrics),
        history_variables=" ".join(design.history_variables),
        sampling=design.sampling_text,
    )
    if design.respond is not None:
        file.attrs.update(
            {f"respond_{key}": value for key, value in dataclasses.asdict(design.respond).items()}
        )
    group = file.create_group("parameters")
    for number, parameter in enumerate(design.parameters):
        kind = TEXT if parameter.is_text else parameter.values.dtype
        column = group.create_dataset(f"p{number}", data=parameter.values, dtype=kind)
        column.attrs.update(path=parameter.path, name=parameter.name, units=parameter.units)
        column.attrs["derived"] = np.int8(parameter.derived)


def _read(file: h5py.File) -> tuple[Design, str]:
    """Read the design, and its hash at the time of writing."""
    group = file["parameters"]
    parameters = []
    for number in range(len(group)):
        column = group[f"p{number}"]
        values = column.asstr()[:] if h5py.check_string_dtype(column.dtype) else column[:]
        path = str(column.attrs["path"])
        name = str(column.attrs.get("name", identifier(path)))
        units = str(column.attrs.get("units", ""))
        derived = bool(column.attrs.get("derived", 0))
        parameters.append(Parameter(name, path, units, values, derived))
    # Designs of other programs contain only the data for a batch.
    absent = {"hash": "", "plan": "", "method": "list", "seed": 0, "sampling": "{}", "numbers": ""}
    attrs = {**absent, "history_rows": 0, **file.attrs}
    begin, end = (float(t) for t in attrs["window"])
    texts: dict[str, Any] = {name: str(attrs[name]) for name in TEXTS}
    numbers: dict[str, Any] = {name: int(attrs[name]) for name in NUMBERS}
    over = str(attrs.get("respond_over", ""))
    direction = str(attrs.get("respond_direction", "both"))
    respond = Respond(over, direction, int(attrs.get("respond_periods", 0))) if over else None
    design = Design(
        **texts,
        **numbers,
        parameters=tuple(parameters),
        window=(begin, end),
        metrics=tuple(str(attrs["numbers"]).split()),
        history_variables=tuple(str(attrs["history_variables"]).split()),
        version=str(attrs["evolvent_version"]),
        sampling=json.loads(str(attrs["sampling"])),
        respond=respond,
        maker="" if attrs["plan"] else str(attrs["hash"]),
    )
    if design.n_cases < 1 or any(p.values.shape != (design.n_cases,) for p in parameters):
        raise ValueError("its columns do not have the length n_cases")
    return design, str(attrs["hash"])


def _check_format(path: Path, file: h5py.File) -> None:
    number = file.attrs.get("evolvent_design_format")
    if number is None:
        raise SweepError(f"{path}: is not a design (no attribute `evolvent_design_format`)")
    if number != FORMAT:
        raise SweepError(
            f"{path}: was made by evolvent {file.attrs.get('evolvent_version', '?')} in design "
            f"format {number}, but this evolvent-sweep reads format {FORMAT}; plan it again"
        )
