"""Columns of a plan: grids, lists, samples of the unit cube, tables, derived columns."""

from __future__ import annotations

import inspect
import math
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from evolvent.errors import SweepError, needing, reason_of
from evolvent.sweep.design import Parameter, identifier
from evolvent.sweep.expression import evaluate
from evolvent.sweep.quantities import Asked, key_unit, may_have_unit, read_quantities
from evolvent.sweep.spec import SAMPLED, Entry, Spec, check_unique
from evolvent.sweep.yaml_text import yaml_text

if TYPE_CHECKING:
    import pandas as pd

MOST_CASES = 50_000_000  # more is probably an error: a table of gigabytes
LARGEST_WHOLE = 2**53  # larger doubles do not represent all integers


def columns(spec: Spec, program: Path | None = None) -> tuple[list[Parameter], int, dict[str, Any]]:
    """Create all columns of a plan.

    Parameters
    ----------
    program : converts values with units in a table; None: the one found by `find_program`.

    Returns
    -------
    The parameters in the order of the plan, the number of cases, and the data of the samples for an
    analysis (empty for grids).

    Raises
    ------
    SweepError
        Values of different lengths, an empty design, a formula or a table that cannot be used.
    """
    try:
        return _columns(spec, program)
    except SweepError as error:
        raise error.at(str(spec.source)) from None


def _columns(spec: Spec, program: Path | None) -> tuple[list[Parameter], int, dict[str, Any]]:
    entries = spec.entries
    sampling: dict[str, Any] = {}
    table: pd.DataFrame | None = None
    if spec.method == "table":
        table = _read_table(spec)
        table, entries = _with_units_read(table, entries or _entries_of(table), spec, program)
        length = len(table)
    else:
        length, sampling = _length(spec)
    if not 1 <= length <= MOST_CASES:
        raise SweepError(f"has {length} cases, must have 1 to {MOST_CASES}")

    cube = _unit_cube(spec, sampling) if sampling else None
    values: dict[str, np.ndarray] = {}
    repeat = length  # of the factorial: repetitions of each value of a column
    derived_last = sorted(entries, key=lambda entry: entry.source == "expression")
    for entry in derived_last:
        if entry.source == "expression":
            column = _derived(entry, values, length)
        elif entry.source == "value":
            column = np.repeat(_typed([entry.value]), length)
        elif table is not None:
            column = _of_table(table, entry, spec.file)
        elif cube is not None:
            column = _scaled(entry, cube[:, sampling["names"].index(entry.name)])
        else:
            column = _levels(entry)
            if spec.method == "factorial":  # the last parameter varies fastest
                repeat //= column.size
                column = np.resize(np.repeat(column, repeat), length)
        values[entry.name] = column
    parameters = [
        Parameter(e.name, e.path, e.units, values[e.name], e.source == "expression")
        for e in entries
    ]
    return parameters, length, sampling


def _length(spec: Spec) -> tuple[int, dict[str, Any]]:
    sized = [e for e in spec.entries if e.source in ("values", "from")]
    if not sized:
        raise SweepError("no parameter has values or a range; nothing varies")
    if spec.method == "factorial":
        return math.prod(_count(entry) for entry in sized), {}
    if spec.method == "list":
        for entry in sized[1:]:
            if _count(entry) != _count(sized[0]):
                raise SweepError(
                    f"{entry.key_path}: has {_count(entry)} values, but {sized[0].key_path} "
                    f"has {_count(sized[0])}; with method list all have one length"
                )
        return _count(sized[0]), {}
    sampling: dict[str, Any] = {"names": [e.name for e in sized], "samples": spec.samples}
    blocks = 1
    if spec.method == "saltelli":
        sampling["second_order"] = spec.second_order
        blocks = 2 * len(sized) + 2 if spec.second_order else len(sized) + 2
    return spec.samples * blocks, sampling


def _count(entry: Entry) -> int:
    return len(entry.values) if entry.source == "values" else int(entry.number or 0)


def _levels(entry: Entry) -> np.ndarray:
    """Values of a parameter on a grid."""
    if entry.source == "values":
        return _typed(list(entry.values))
    spaced = np.geomspace if entry.log else np.linspace
    levels = spaced(entry.begin, entry.end, _count(entry))
    if not entry.whole:
        return levels
    whole = np.round(levels).astype(np.int64)
    if np.unique(whole).size < whole.size:
        raise SweepError(
            f"{entry.key_path}: rounded to whole numbers, some of its values are equal"
        )
    return whole


def _scaled(entry: Entry, drawn: np.ndarray) -> np.ndarray:
    """Values of a parameter from numbers in [0, 1)."""
    if entry.source == "values":
        levels = _typed(list(entry.values))
        return levels[np.minimum((drawn * levels.size).astype(np.int64), levels.size - 1)]
    begin, end = entry.begin, entry.end
    if entry.whole:
        begin, end = min(begin, end) - 0.5, max(begin, end) + 0.5
        drawn = np.minimum(drawn, 1.0 - 1e-12)
    if entry.log:
        sign = math.copysign(1.0, begin)
        low, high = math.log(abs(begin)), math.log(abs(end))
        values = sign * np.exp(low + drawn * (high - low))
    else:
        values = begin + drawn * (end - begin)
    return np.round(values).astype(np.int64) if entry.whole else values


def _unit_cube(spec: Spec, sampling: dict[str, Any]) -> np.ndarray:
    """Sample the unit cube, shape (case, sampled parameter)."""
    assert spec.method in SAMPLED
    names: list[str] = sampling["names"]
    if spec.method == "saltelli":
        with needing("sensitivity", "method saltelli needs SALib"):
            from SALib.sample import sobol
        problem = {"num_vars": len(names), "names": names, "bounds": [[0.0, 1.0]] * len(names)}
        order = spec.second_order
        cube = sobol.sample(problem, spec.samples, calc_second_order=order, seed=spec.seed)
        return np.asarray(cube)
    from scipy.stats import qmc

    engine = qmc.Sobol if spec.method == "sobol" else qmc.LatinHypercube
    # SciPy renamed the argument.
    keyword = "rng" if "rng" in inspect.signature(engine).parameters else "seed"
    generator = np.random.default_rng(spec.seed)
    return np.asarray(engine(len(names), **{keyword: generator}).random(spec.samples))


def _derived(entry: Entry, values: dict[str, np.ndarray], length: int) -> np.ndarray:
    try:
        result = evaluate(entry.expression, values, length)
    except SweepError as error:
        raise SweepError(f"{entry.key_path}: {error}") from None
    if not entry.whole:
        return result
    if np.abs(result).max() > LARGEST_WHOLE:
        raise SweepError(f"{entry.key_path}: is too large for a whole number")
    return np.round(result).astype(np.int64)


def _typed(values: list[Any]) -> np.ndarray:
    """Create an array: int64, float64, or YAML texts if a value is not a number."""
    if all(type(v) is int and abs(v) < 2**63 for v in values):
        return np.array(values, dtype=np.int64)
    if all(type(v) in (int, float) for v in values):
        return np.array(values, dtype=np.float64)
    return np.array([yaml_text(v) for v in values], dtype=object)


def _read_table(spec: Spec) -> pd.DataFrame:
    import pandas as pd

    path = spec.file
    assert path is not None
    try:
        if path.suffix.lower() == ".parquet":
            with needing("parquet", f"{path}: Parquet needs pyarrow"):
                table = pd.read_parquet(path)
        else:
            # Texts such as "none" or "NA" are values of the case, not gaps.
            table = pd.read_csv(path, keep_default_na=False, na_values=[""], skipinitialspace=True)
    except FileNotFoundError as error:
        raise SweepError(f"{path}: no such file") from error
    except (OSError, ValueError) as error:
        raise SweepError(f"{path}: is not a readable table ({reason_of(error)})") from error
    return table.rename(columns=lambda name: str(name).strip())


def _entries_of(table: pd.DataFrame) -> tuple[Entry, ...]:
    """Parameters of a table whose column headings are paths."""
    entries = tuple(
        Entry(f"column '{head}'", identifier(head), head, "", "column", column=head)
        for head in map(str, table.columns)
    )
    if not entries:
        raise SweepError("the table has no columns")
    check_unique(entries)
    return entries


def _with_units_read(
    table: pd.DataFrame, entries: tuple[Entry, ...], spec: Spec, program: Path | None
) -> tuple[pd.DataFrame, tuple[Entry, ...]]:
    """Convert columns of numbers with units; columns with other texts are unchanged."""
    import pandas as pd

    asked: dict[str, list[Asked]] = {}
    for entry in entries:
        is_there = entry.column in table.columns
        is_text = is_there and not pd.api.types.is_numeric_dtype(table[entry.column].dtype)
        texts = table[entry.column].dropna().astype(str).str.strip().unique() if is_text else []
        if entry.path and len(texts) and all(may_have_unit(text) for text in texts):
            asked[entry.name] = [Asked(entry.key_path, entry.path, text) for text in texts]
    if not asked:
        return table, entries
    read = read_quantities([a for some in asked.values() for a in some], spec.case, program)
    changed = []
    for entry in entries:
        given = {each.text: read[each.option] for each in asked.get(entry.name, [])}
        numbers = {text: q.value for text, q in given.items() if q.value is not None}
        if given and len(numbers) == len(given):
            table = table.assign(**{entry.column: table[entry.column].str.strip().map(numbers)})
            unit = next(iter(given.values())).unit
            entry = replace(entry, units=key_unit(entry.units, unit, entry.key_path))
        changed.append(entry)
    return table, tuple(changed)


def _of_table(table: pd.DataFrame, entry: Entry, path: Path | None) -> np.ndarray:
    import pandas as pd

    if entry.column not in table.columns:
        known = ", ".join(map(str, table.columns))
        raise SweepError(f"{entry.key_path}: {path} has no column '{entry.column}'; it has {known}")
    column = table[entry.column]
    empty = np.flatnonzero(column.isna().to_numpy())
    if empty.size:
        raise SweepError(f"{entry.key_path}: {path} has no value for case {empty[0]}")
    if pd.api.types.is_bool_dtype(column.dtype):
        column = column.map({True: "true", False: "false"})
    if not pd.api.types.is_numeric_dtype(column.dtype):
        return np.array([str(text) for text in column], dtype=object)
    whole = pd.api.types.is_integer_dtype(column.dtype)
    values = np.asarray(column, dtype=np.int64 if whole else np.float64)
    bad = np.flatnonzero(~np.isfinite(values))
    if bad.size:
        raise SweepError(f"{entry.key_path}: {path} has {values[bad[0]]} for case {bad[0]}")
    return values
