"""Declaration of the parameters of commands, and the parser of command lines.

The parameters of a command are annotated with the results of `option` and `argument`. A command
with many options groups them in dataclasses: a parameter of such a type stands for the options of
its fields. Valid command lines are parsed here, by the types of the parameters: importing typer
takes as long as all else that a short command does. typer handles every other line: help,
completion and error messages.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, is_dataclass
from enum import Enum
from pathlib import Path
from types import UnionType
from typing import TYPE_CHECKING, Annotated, Any, get_args, get_origin, get_type_hints

if TYPE_CHECKING:
    from inspect import Parameter as Given

WHOLE = re.compile(r"[-+]?[0-9]+", re.ASCII)
REAL = re.compile(r"[-+]?(?:[0-9]+\.?[0-9]*|\.[0-9]+)(?:[eE][-+]?[0-9]+)?", re.ASCII)


class WrongUsageError(Exception):
    """Invalid value of an option or argument; reported like an error of typer.

    Parameters
    ----------
    option : name of the option or argument.
    """

    def __init__(self, message: str, option: str | None = None) -> None:
        super().__init__(message)
        self.option = option


class UnclearError(Exception):
    """Command line that this parser does not handle."""


@dataclass(frozen=True)
class OptionSpec:
    """Declaration of an option, or of an argument, which has no names."""

    names: tuple[str, ...]
    metavar: str | None
    text: str
    more: Mapping[str, Any] = field(default_factory=dict)

    def for_typer(self) -> Any:
        """Return the equivalent declaration of typer."""
        import typer

        if not self.names:
            return typer.Argument(metavar=self.metavar, help=self.text)
        more = dict(self.more)
        if "parser" in more:
            more["parser"] = _complaining(more["parser"])
        if self.metavar is not None:
            more["metavar"] = self.metavar
        return typer.Option(*self.names, help=self.text, **more)


@dataclass(frozen=True)
class Parameter:
    """One parameter of a command."""

    name: str
    spec: OptionSpec
    kind: Any  # type of one value
    is_list: bool
    default: Any
    is_required: bool

    def value(self, text: str) -> Any:
        """Convert one word to a value of the parameter's type."""
        value = self._value(text)
        least, most = self.spec.more.get("min"), self.spec.more.get("max")
        if (least is not None and value < least) or (most is not None and value > most):
            raise UnclearError
        return value

    def _value(self, text: str) -> Any:
        if "parser" in self.spec.more:
            try:
                return self.spec.more["parser"](text)
            except WrongUsageError:
                raise UnclearError from None
        if self.kind is Path and text:
            return Path(text)
        if self.kind is str:
            return text
        if self.kind is int and WHOLE.fullmatch(text):
            return int(text)
        if self.kind is float and REAL.fullmatch(text):
            return float(text)
        if issubclass(self.kind, Enum) and text in [member.value for member in self.kind]:
            return self.kind(text)
        raise UnclearError


def option(shown: str, text: str, **more: Any) -> OptionSpec:
    """Declare an option as its help shows it: option("-o --output DIR", "Folder of the results.").

    Parameters
    ----------
    more : `min`, `max`, `parser`, and other keywords of `typer.Option`.
    """
    *names, last = shown.split()
    if last.startswith("-"):
        return OptionSpec((*names, last), None, text, more)
    return OptionSpec(tuple(names), last, text, more)


def argument(shown: str, text: str) -> OptionSpec:
    """Declare an argument as its help shows it: argument("FILE", "History (.h5).")."""
    return OptionSpec((), shown, text)


def parameters(command: Callable[..., Any]) -> list[Parameter]:
    """List the parameters of a command, with the fields of its groups."""
    found = []
    for one, hint in _flat(command):
        kind, spec = get_args(hint)
        if get_origin(kind) is UnionType:
            kind = next(each for each in get_args(kind) if each is not type(None))
        is_list = get_origin(kind) is list
        is_required = one.default is one.empty
        default = None if is_required else one.default
        kind = get_args(kind)[0] if is_list else kind
        found.append(Parameter(one.name, spec, kind, is_list, default, is_required))
    return found


def grouped(command: Callable[..., Any], values: Mapping[str, Any]) -> dict[str, Any]:
    """Build the groups of options of a command from the values of their fields.

    Parameters
    ----------
    values : as from `read`.

    Returns
    -------
    Arguments of the command.
    """
    return {
        one.name: hint(**grouped(hint, values)) if _is_group(hint) else values[one.name]
        for one, hint in _declared(command)
    }


def _is_group(hint: Any) -> bool:
    return isinstance(hint, type) and is_dataclass(hint)


def _declared(command: Callable[..., Any]) -> Iterator[tuple[Given, Any]]:
    """Iterate over the parameters of a command, or the fields of a group, with their types."""
    from inspect import signature

    hints = get_type_hints(command, include_extras=True)
    for name, one in signature(command).parameters.items():
        yield one, one.annotation if get_origin(one.annotation) is Annotated else hints[name]


def _flat(command: Callable[..., Any]) -> Iterator[tuple[Given, Any]]:
    """Iterate over the parameters of a command, with the fields of groups in their place."""
    for one, hint in _declared(command):
        if _is_group(hint):
            yield from _flat(hint)
        else:
            yield one, hint


def read(command: Callable[..., Any], words: Sequence[str]) -> dict[str, Any]:
    """Parse the words of a command line.

    Returns
    -------
    Values by the names of the parameters and of the fields of groups.

    Raises
    ------
    UnclearError
        They are invalid, request help, or use a form that only typer supports.
    """
    known = parameters(command)
    by_option = {name: one for one in known for name in one.spec.names}
    given: dict[str, list[Any]] = {one.name: [] for one in known}
    positionals: list[str] = []
    rest = iter(words)
    for word in rest:
        name, equals, text = word.partition("=")
        if not word.startswith("-") or word == "-":
            positionals.append(word)
        elif name not in by_option or (equals and not name.startswith("--")):
            raise UnclearError
        elif by_option[name].kind is bool:
            if equals:
                raise UnclearError
            given[by_option[name].name] = [True]
        else:
            value = text if equals else next(rest, "-")
            if value.startswith("-") and not equals:
                raise UnclearError
            given[by_option[name].name].append(by_option[name].value(value))
    for one in (one for one in known if not one.spec.names):
        taken = positionals if one.is_list else positionals[:1]
        given[one.name] = [one.value(word) for word in taken]
        positionals = positionals[len(taken) :]
    if positionals or any(one.is_required and not given[one.name] for one in known):
        raise UnclearError
    return {one.name: _final(one, given[one.name]) for one in known}


def _final(one: Parameter, values: list[Any]) -> Any:
    if not values:
        return one.default
    return values if one.is_list else values[-1]


def for_typer(
    command: Callable[..., Any], error: WrongUsageError | None = None
) -> Callable[..., Any]:
    """Return the command with the declarations that typer expects.

    Parameters
    ----------
    error : reported instead of running the command.
    """
    from functools import wraps
    from inspect import signature

    import typer

    @wraps(command)
    def called(**values: Any) -> Any:
        if error is not None:
            raise typer.BadParameter(str(error), param_hint=error.option)
        return _complaining(command)(**grouped(command, values))

    given = []
    for one, hint in _flat(command):
        kind, spec = get_args(hint)
        named = one.replace(kind=one.KEYWORD_ONLY)  # groups of commands are given by name
        given.append(named.replace(annotation=Annotated[kind, spec.for_typer()]))
    called.__signature__ = signature(command).replace(parameters=given)  # type: ignore[attr-defined]
    called.__annotations__ = {one.name: one.annotation for one in given}
    return called


def _complaining(function: Callable[..., Any]) -> Callable[..., Any]:
    """Wrap a function: typer reports its `WrongUsageError`."""

    def called(*values: Any, **named: Any) -> Any:
        import typer

        try:
            return function(*values, **named)
        except WrongUsageError as error:
            raise typer.BadParameter(str(error), param_hint=error.option) from error

    called.__name__ = function.__name__
    return called
