"""SWEEP.yaml: permitted contents of a plan, and its validation."""

from __future__ import annotations

import difflib
import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from evolvent.errors import SweepError, reason_of
from evolvent.sweep.design import NAME, Respond, identifier
from evolvent.sweep.quantities import may_have_unit, with_units_read
from evolvent.sweep.yaml_text import read_yaml

FORMAT = 1
GRIDS = ("factorial", "list")
SAMPLED = ("latin_hypercube", "sobol", "saltelli")
METHODS = (*GRIDS, *SAMPLED, "table")
SCALES = ("linear", "log")
# Variables that a summary always has.
TAKEN = ("case", "time", "status", "message", "exit_code", "recorded_at", "pi", "e")
TOP_KEYS = (
    "format", "title", "case", "method", "samples", "seed", "second_order", "file",
    "parameters", "window", "metrics", "histories", "respond",
)  # fmt: skip
FORMER_KEYS = {"numbers": "metrics"}  # accepted for one release
PARAMETER_KEYS = (
    "path", "name", "units", "value", "values", "from", "to", "number", "scale", "whole",
    "expression", "column",
)  # fmt: skip
DIRECTIONS = ("up", "down", "both")
LEAST_PERIODS = 100  # as `evolvent respond` takes them
# Keys for the values of a parameter; exactly one is required.
SOURCES = ("value", "values", "from", "expression", "column")


@dataclass(frozen=True)
class Entry:
    """One parameter as given in the plan; omitted values have their defaults."""

    key_path: str  # for messages
    name: str
    path: str
    units: str
    source: str  # one of `SOURCES`
    value: Any = None
    values: tuple[Any, ...] = ()
    begin: float = math.nan
    end: float = math.nan
    number: int | None = None
    log: bool = False
    whole: bool = False
    expression: str = ""
    column: str = ""


@dataclass(frozen=True)
class Spec:
    """A plan, read and validated except for checks by the program."""

    source: Path
    text: str
    title: str
    case: Path
    method: str
    samples: int
    seed: int
    second_order: bool
    file: Path | None
    entries: tuple[Entry, ...]
    window: tuple[float, float] | None
    metrics: tuple[str, ...]
    history_variables: tuple[str, ...]
    history_every: int
    history_rows: int  # 0: not given
    respond: Respond | None  # None: each case is a run


def read_spec(path: Path, program: Path | None = None) -> Spec:
    """Read SWEEP.yaml. Files named in it are relative to its folder.

    Parameters
    ----------
    program : converts values with units; None: the one found by `find_program`.

    Raises
    ------
    SweepError
        Unreadable, or with an invalid key or value; the message names the location.
    """
    text = read_text(path, str(path))
    try:
        plan = read_yaml(text, str(path))
        if isinstance(plan, dict):
            plan = {FORMER_KEYS.get(key, key): value for key, value in plan.items()}
        top = _mapping(plan, "the plan", TOP_KEYS)
        return _spec(path, text, top, program)
    except SweepError as error:
        raise error.at(str(path)) from None


def _spec(path: Path, text: str, top: Mapping[str, Any], program: Path | None) -> Spec:
    if top.get("format") != FORMAT:
        raise SweepError(f"format: is {top.get('format', 'missing')}, must be {FORMAT}")
    method = _one_of(top.get("method"), METHODS, "method")
    for key, methods in (
        ("samples", SAMPLED), ("second_order", ("saltelli",)), ("file", ("table",)),
    ):  # fmt: skip
        if key in top and method not in methods:
            raise SweepError(f"{key}: has no meaning with method {method}")
    samples = _whole(top.get("samples"), "samples", 1) if method in SAMPLED else 0
    if method in ("sobol", "saltelli") and samples & (samples - 1):
        better = 2 ** round(math.log2(samples))
        raise SweepError(f"samples: is {samples}, must be a power of 2 with {method}, as {better}")
    case = path.parent / _text(top.get("case"), "case")
    top = with_units_read(top, case, program)
    given = top.get("parameters", [] if method == "table" else None)
    if not isinstance(given, list) or (not given and method != "table"):
        raise SweepError("parameters: must be a list of at least one parameter")
    entries = tuple(_entry(e, f"parameters.{i}", method) for i, e in enumerate(given))
    check_unique(entries)
    histories = _mapping(top.get("histories", {}), "histories", ("variables", "every", "rows"))
    variables = _strings(histories.get("variables", []), "histories.variables")
    return Spec(
        source=path,
        text=text,
        title=str(top.get("title", "")),
        case=case,
        method=method,
        samples=samples,
        seed=_whole(top.get("seed", 0), "seed", 0),
        second_order=_truth(top.get("second_order", False), "second_order"),
        file=path.parent / _text(top.get("file"), "file") if method == "table" else None,
        entries=entries,
        window=_window(top.get("window")),
        metrics=_strings(top.get("metrics", []), "metrics"),
        history_variables=variables,
        history_every=_whole(histories.get("every", 1), "histories.every", 1),
        history_rows=_whole(histories["rows"], "histories.rows", 1) if "rows" in histories else 0,
        respond=_respond(top) if "respond" in top else None,
    )


def _respond(top: Mapping[str, Any]) -> Respond:
    for key in ("window", "histories"):
        if key in top:
            raise SweepError(f"{key}: has no meaning with respond, whose cases are not runs")
    keys = _mapping(top["respond"], "respond", ("over", "direction", "periods"))
    over = _text(keys.get("over"), "respond.over")
    if "=" not in over:
        raise SweepError(f"respond.over: is '{over}', must be PATH=FROM:TO[:STEPS]")
    return Respond(
        over=over,
        direction=_one_of(keys.get("direction", "both"), DIRECTIONS, "respond.direction"),
        periods=_whole(keys["periods"], "respond.periods", LEAST_PERIODS)
        if "periods" in keys
        else 0,
    )


def read_text(path: Path, name: str) -> str:
    """Read a file of the plan.

    Parameters
    ----------
    name : of the file in messages.

    Raises
    ------
    SweepError
        It cannot be read.
    """
    try:
        return path.read_text(encoding="utf-8")
    except UnicodeDecodeError as error:
        raise SweepError(f"{name}: cannot be read (is not UTF-8 text)") from error
    except OSError as error:
        raise SweepError(f"{name}: cannot be read ({reason_of(error)})") from error


def check_unique(entries: Sequence[Entry]) -> None:
    """Reject two parameters with the same name or path."""
    for attribute in ("name", "path"):
        seen: dict[str, str] = {}
        for entry in entries:
            value = getattr(entry, attribute)
            if value and value in seen:
                raise SweepError(
                    f"{entry.key_path}: has the {attribute} '{value}' of {seen[value]}; "
                    f"each parameter needs its own"
                )
            seen[value] = entry.key_path


def _entry(given: Any, key_path: str, method: str) -> Entry:
    keys = _mapping(given, key_path, PARAMETER_KEYS)
    path = _text(keys["path"], f"{key_path}.path") if "path" in keys else ""
    if not path and "name" not in keys:
        raise SweepError(f"{key_path}: needs a path of the case, or a name for expressions")
    name = _text(keys.get("name", identifier(path)), f"{key_path}.name")
    key_path = f"{key_path} ({name})"
    if not NAME.fullmatch(name):
        raise SweepError(
            f"{key_path}: the name must consist of letters, digits and _ and not start with a digit"
        )
    if name in TAKEN:
        raise SweepError(f"{key_path}: this name is taken; choose another")
    sources = [key for key in SOURCES if key in keys]
    if method == "table" and not sources:
        keys, sources = {**keys, "column": name}, ["column"]
    if len(sources) != 1:
        found = " and ".join(sources) if sources else "none"
        raise SweepError(f"{key_path}: needs exactly one of {', '.join(SOURCES)}, not {found}")
    source = sources[0]
    _refuse_idle_keys(keys, key_path, source, method)
    said: dict[str, Any] = {"whole": _truth(keys.get("whole", False), f"{key_path}.whole")}
    match source:
        case "values":
            values = keys["values"]
            if not isinstance(values, list) or not values:
                raise SweepError(f"{key_path}: values must be a list of at least one")
            said["values"] = tuple(values)
        case "from":
            said |= _range(keys, key_path, method, said["whole"])
        case "column":
            said["column"] = _text(keys["column"], f"{key_path}.column")
        case "expression":
            said["expression"] = str(keys["expression"])
        case _:
            said["value"] = keys["value"]
    return Entry(
        key_path, name, path, _text(keys.get("units", ""), f"{key_path}.units"), source, **said
    )


def _refuse_idle_keys(keys: Mapping[str, Any], key_path: str, source: str, method: str) -> None:
    for key in ("to", "number", "scale"):
        if key in keys and source != "from":
            raise SweepError(f"{key_path}: {key} has no meaning without from")
    if "whole" in keys and source not in ("from", "expression"):
        raise SweepError(f"{key_path}: whole has no meaning with {source}")
    if source == "column" and method != "table":
        raise SweepError(f"{key_path}: column has no meaning with method {method}")
    if source in ("values", "from") and method == "table":
        raise SweepError(f"{key_path}: with method table, values come from the table's columns")


def _range(keys: Mapping[str, Any], key_path: str, method: str, whole: bool) -> dict[str, Any]:
    begin = _number(keys["from"], f"{key_path}.from")
    end = _number(keys.get("to"), f"{key_path}.to")
    log = _one_of(keys.get("scale", "linear"), SCALES, f"{key_path}.scale") == "log"
    if log and begin * end <= 0.0:
        raise SweepError(
            f"{key_path}: a log range must exclude 0, but is from {begin:g} to {end:g}"
        )
    if whole and (begin != round(begin) or end != round(end)):
        raise SweepError(f"{key_path}: a whole range must start and end with whole numbers")
    number = None
    if method in GRIDS:
        if "number" not in keys:
            raise SweepError(
                f"{key_path}: a range needs `number`, the number of values, with {method}"
            )
        number = _whole(keys["number"], f"{key_path}.number", 1)
        if number == 1 and begin != end:
            raise SweepError(f"{key_path}: number is 1, but the range has two ends; use `value`")
    elif "number" in keys:
        raise SweepError(f"{key_path}: number has no meaning with {method}; see `samples`")
    return {"begin": begin, "end": end, "number": number, "log": log}


def _window(given: Any) -> tuple[float, float] | None:
    if given is None:
        return None
    keys = _mapping(given, "window", ("from", "to"))
    begin, end = (_number(keys.get(key), f"window.{key}") for key in ("from", "to"))
    if not 0.0 <= begin < end:
        raise SweepError(f"window: from {begin:g} to {end:g} must be 0 <= from < to")
    return begin, end


def _mapping(given: Any, key_path: str, known: Sequence[str]) -> dict[str, Any]:
    if not isinstance(given, dict):
        raise SweepError(f"{key_path}: must be a block of keys and values")
    for key in given:
        if key not in known:
            raise SweepError(
                f"{key_path}: unknown key '{key}'{_hint(key, known)}; "
                f"known here: {', '.join(known)}"
            )
    return given


def _hint(given: Any, known: Sequence[str]) -> str:
    near = difflib.get_close_matches(str(given), known, 1)
    return f" (did you mean '{near[0]}'?)" if near else ""


def _checked(given: Any, good: bool, key_path: str, must: str) -> Any:
    if not good:
        shown = "missing" if given is None else f"'{given}'"
        raise SweepError(f"{key_path}: is {shown}, must be {must}")
    return given


def _one_of(given: Any, known: Sequence[str], key_path: str) -> str:
    must = f"one of {', '.join(known)}{_hint(given, known)}"
    return str(_checked(given, given in known, key_path, must))


def _number(given: Any, key_path: str) -> float:
    good = type(given) in (int, float) and math.isfinite(given)
    why = "; only a path to a key with a unit takes others" if may_have_unit(given) else ""
    return float(_checked(given, good, key_path, f"a finite number{why}"))


def _whole(given: Any, key_path: str, least: int) -> int:
    good = type(given) is int and least <= given < 2**53
    return int(_checked(given, good, key_path, f"a whole number of at least {least}"))


def _truth(given: Any, key_path: str) -> bool:
    return bool(_checked(given, isinstance(given, bool), key_path, "true or false"))


def _text(given: Any, key_path: str) -> str:
    return str(_checked(given, isinstance(given, str), key_path, "a text"))


def _strings(given: Any, key_path: str) -> tuple[str, ...]:
    if not isinstance(given, list):
        raise SweepError(f"{key_path}: must be a list of names")
    return tuple(_text(item, key_path) for item in given)
