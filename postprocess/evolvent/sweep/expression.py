"""Columns derived from others by a formula, without executing arbitrary code.

The text is parsed by Python's grammar; only the nodes listed here are evaluated. Every name is a
column, a constant or a function of the tables below. Numbers are doubles, so that powers of
integers cannot exhaust the memory.
"""

from __future__ import annotations

import ast
import operator
from collections.abc import Callable, Mapping
from typing import Any

import numpy as np

from evolvent.errors import SweepError

MAX_LENGTH = 1000  # characters; longer texts are rejected
CONSTANTS = {"pi": np.pi, "e": np.e}
# Name: (function, smallest and largest number of arguments).
PLAIN = "abs ceil cos degrees exp floor log log10 radians round sin sqrt tan"
FUNCTIONS: dict[str, tuple[Callable[..., Any], int, int]] = {
    **{name: (getattr(np, name), 1, 1) for name in PLAIN.split()},
    **{f"a{name}": (getattr(np, f"arc{name}"), 1, 1) for name in ("cos", "sin", "tan")},
    "atan2": (np.arctan2, 2, 2),
    "max": (lambda *x: np.maximum.reduce(np.broadcast_arrays(*x)), 2, 20),
    "min": (lambda *x: np.minimum.reduce(np.broadcast_arrays(*x)), 2, 20),
}
BINARY: dict[type, Callable[[Any, Any], Any]] = {
    ast.Add: operator.add,
    ast.Sub: operator.sub,
    ast.Mult: operator.mul,
    ast.Div: np.true_divide,
    ast.FloorDiv: np.floor_divide,
    ast.Mod: np.mod,
    ast.Pow: np.float_power,
}
COMPARED: dict[type, Callable[[Any, Any], Any]] = {
    ast.Lt: np.less,
    ast.LtE: np.less_equal,
    ast.Gt: np.greater,
    ast.GtE: np.greater_equal,
    ast.Eq: np.equal,
    ast.NotEq: np.not_equal,
}


def evaluate(text: str, columns: Mapping[str, np.ndarray], length: int) -> np.ndarray:
    """Evaluate a formula for all cases at once.

    Parameters
    ----------
    text : such as "2*pi*speed/60" or "a if a < b else b".
    columns : names and values (case); columns of text may be present but not be used.
    length : number of cases.

    Returns
    -------
    Doubles (case).

    Raises
    ------
    SweepError
        Not a formula, an unknown name, or a result that is not finite.
    """
    if len(text) > MAX_LENGTH:
        raise SweepError(f"is longer than {MAX_LENGTH} characters")
    shown = " ".join(text.split())  # messages are one line
    try:
        tree = ast.parse(text.strip(), mode="eval")
        with np.errstate(all="ignore"):
            result = _Evaluation(columns).of(tree.body)
    except SyntaxError as error:
        raise SweepError(f"'{shown}' is not a formula ({error.msg})") from error
    except (RecursionError, MemoryError, OverflowError, ValueError) as error:
        raise SweepError(f"'{shown[:40]}' is too complex a formula") from error
    values = np.array(np.broadcast_to(np.asarray(result, dtype=float), (length,)))
    bad = np.flatnonzero(~np.isfinite(values))
    if bad.size:
        raise SweepError(
            f"'{shown}' is {values[bad[0]]} for case {bad[0]} ({bad.size} of {length} cases "
            "are not finite)"
        )
    return values


class _Evaluation:
    def __init__(self, columns: Mapping[str, np.ndarray]) -> None:
        self.columns = columns

    def of(self, node: ast.expr) -> Any:
        match node:
            case ast.Constant(value=bool()):
                pass
            case ast.Constant(value=int() | float() as value):
                return np.float64(value)
            case ast.Name(id=name):
                return self._named(name)
            case ast.UnaryOp(op=ast.USub(), operand=operand):
                return -self.of(operand)
            case ast.UnaryOp(op=ast.UAdd(), operand=operand):
                return self.of(operand)
            case ast.BinOp(left=left, op=op, right=right) if type(op) in BINARY:
                return BINARY[type(op)](self.of(left), self.of(right))
            case ast.IfExp(test=test, body=body, orelse=orelse):
                return np.where(self._truth(test), self.of(body), self.of(orelse))
            case ast.Call(func=ast.Name(id=name), args=arguments, keywords=[]):
                return self._called(name, arguments)
        raise SweepError(
            f"'{ast.unparse(node)[:60]}' is not allowed in a formula; use numbers, names, + - "
            "* / // "
            f"% **, 'a if b < c else d' and the functions {', '.join(sorted(FUNCTIONS))} are"
        )

    def _truth(self, node: ast.expr) -> Any:
        match node:
            case ast.Compare(left=left, ops=[op], comparators=[right]) if type(op) in COMPARED:
                return COMPARED[type(op)](self.of(left), self.of(right))
            case ast.BoolOp(op=ast.And(), values=values):
                return np.logical_and.reduce([self._truth(v) for v in values])
            case ast.BoolOp(op=ast.Or(), values=values):
                return np.logical_or.reduce([self._truth(v) for v in values])
        raise SweepError(f"'{ast.unparse(node)[:60]}' is not a comparison of two numbers")

    def _named(self, name: str) -> Any:
        if name in self.columns:
            column = self.columns[name]
            if column.dtype == object:
                raise SweepError(f"'{name}' is a text and cannot be used in a formula")
            return column.astype(float)
        if name in CONSTANTS:
            return np.float64(CONSTANTS[name])
        known = ", ".join([*self.columns, *CONSTANTS])
        raise SweepError(f"unknown name '{name}' in a formula; known here: {known}")

    def _called(self, name: str, arguments: list[ast.expr]) -> Any:
        if name not in FUNCTIONS:
            known = ", ".join(sorted(FUNCTIONS))
            raise SweepError(f"unknown function '{name}' in a formula; known: {known}")
        function, fewest, most = FUNCTIONS[name]
        if not fewest <= len(arguments) <= most:
            count = str(fewest) if fewest == most else f"{fewest} to {most}"
            raise SweepError(f"the function '{name}' takes {count} arguments")
        return function(*[self.of(argument) for argument in arguments])
