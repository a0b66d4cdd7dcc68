"""YAML 1.2 as the program `evolvent` reads it.

PyYAML implements YAML 1.1, in which 1e9 is a text, `no` is false and 010 is eight. Here numbers are
decimal, with or without a point, and only true and false are truth values.
"""

from __future__ import annotations

import re
from typing import Any

import yaml

from evolvent.errors import SweepError

MOST_DIGITS = 300
MOST_BYTES = 200_000  # of a plan: PyYAML takes two seconds for them
WIDEST = 2**31  # columns: one line of any length
BREAKS = re.compile("[\n\r\x85\u2028\u2029]")  # line breaks of YAML
RESOLVED = (
    ("tag:yaml.org,2002:null", r"(?:~|null|Null|NULL|)$", ["~", "n", "N", ""]),
    ("tag:yaml.org,2002:bool", r"(?:true|True|TRUE|false|False|FALSE)$", list("tTfF")),
    ("tag:yaml.org,2002:int", r"[-+]?[0-9]+$", list("-+0123456789")),
    (
        "tag:yaml.org,2002:float",
        r"(?:[-+]?(?:\.[0-9]+|[0-9]+(?:\.[0-9]*)?)(?:[eE][-+]?[0-9]+)?"
        r"|[-+]?\.(?:inf|Inf|INF)|\.(?:nan|NaN|NAN))$",
        list("-+.0123456789"),
    ),
)


class _Loader(yaml.SafeLoader):  # type: ignore[misc] # PyYAML has no types
    yaml_implicit_resolvers: dict[str, Any] = {}  # noqa: RUF012 - PyYAML fills it a class

    def construct_mapping(self, node: Any, deep: bool = False) -> dict[Any, Any]:
        """Create a dict; duplicate keys are rejected."""
        seen: set[Any] = set()
        for key_node, _ in node.value:
            key = self.construct_object(key_node, deep=True)
            if not isinstance(key, str | int | float):
                raise yaml.constructor.ConstructorError(
                    None, None, "a key must be a text or a number", key_node.start_mark
                )
            if key in seen:
                raise yaml.constructor.ConstructorError(
                    None, None, f"the key '{key}' is given twice", key_node.start_mark
                )
            seen.add(key)
        return dict(super().construct_mapping(node, deep))


class _Dumper(yaml.SafeDumper):  # type: ignore[misc]
    yaml_implicit_resolvers: dict[str, Any] = {}  # noqa: RUF012

    def ignore_aliases(self, data: Any) -> bool:
        """Write repeated objects in full: the text is one value on one line."""
        return True


def _one_line(dumper: _Dumper, text: str) -> Any:
    """Represent a text with line breaks by escapes, so that it stays on one line."""
    style = '"' if BREAKS.search(text) else None
    return dumper.represent_scalar("tag:yaml.org,2002:str", text, style=style)


def _whole(_: _Loader, node: Any) -> int:
    """Read an integer; doubles have no more digits than `MOST_DIGITS` before the point."""
    if len(node.value) > MOST_DIGITS:
        raise yaml.constructor.ConstructorError(
            None, None, f"a number of {len(node.value)} digits is too large", node.start_mark
        )
    return int(node.value)


for tag, pattern, first in RESOLVED:
    for reader_or_writer in (_Loader, _Dumper):
        reader_or_writer.add_implicit_resolver(tag, re.compile(pattern), first)
_Loader.add_constructor("tag:yaml.org,2002:int", _whole)
_Dumper.add_representer(str, _one_line)


def _is_larger(value: Any, most: int) -> bool:
    """Whether a value contains more than `most` values, with aliases expanded."""
    rest, n = [value], 0
    while rest and n <= most:
        one = rest.pop()
        n += 1
        if isinstance(one, list):
            rest += one
        elif isinstance(one, dict):
            rest += one.values()
    return n > most


def read_yaml(text: str, source: str) -> Any:
    """Read one document.

    Raises
    ------
    SweepError
        Too large, or no YAML; the message starts with `source`, line and column.
    """
    if len(text) > MOST_BYTES:
        raise SweepError(
            f"{source}: has more than {MOST_BYTES} characters; put the values of its cases into a "
            "file (method: table)"
        )
    try:
        value = yaml.load(text, Loader=_Loader)
        if _is_larger(value, MOST_BYTES):
            raise SweepError(
                f"{source}: its aliases contain, expanded, more than {MOST_BYTES} values"
            )
        return value
    except yaml.MarkedYAMLError as error:
        mark = error.problem_mark or error.context_mark
        location = f":{mark.line + 1}:{mark.column + 1}" if mark else ""
        raise SweepError(f"{source}{location}: {error.problem or error.context}") from error
    except RecursionError as error:
        raise SweepError(f"{source}: is nested too deeply") from error
    except yaml.YAMLError as error:
        raise SweepError(f"{source}: {' '.join(str(error).split())}") from error


def yaml_text(value: Any) -> str:
    """Write a value as YAML on one line, as in `{law: linear, coefficient: 1.0e+4}`."""
    text = yaml.dump(
        value, Dumper=_Dumper, default_flow_style=True, width=WIDEST, allow_unicode=True
    )
    return str(text).removesuffix("\n").removesuffix("\n...")
