"""A struct of the C header and its Fortran type have the same fields in the same order."""

from __future__ import annotations

import ctypes
import importlib
import re
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
HEADERS = sorted((ROOT / "src" / "include" / "evolvent").glob("*.h"))

#: Types that only tests read; all others have the struct's name above them.
OF_TESTS = ("gear_t", "gear_mesh_t")


def structs() -> dict[str, list[str]]:
    """Fields of every struct of the headers."""
    found = {}
    for header in HEADERS:
        text = re.sub(r"/\*.*?\*/", "", header.read_text(), flags=re.DOTALL)
        for body, name in re.findall(r"typedef struct \{(.*?)\} (\w+);", text, flags=re.DOTALL):
            declarations = " ".join(body.split()).split(";")
            found[name] = [
                re.sub(r"\[.*?\]|\*", "", part).split()[-1]
                for declaration in declarations
                if declaration.strip()
                for part in re.sub(r"\[[^]]*\]", "", declaration).split(",")
            ]
    return found


def types() -> dict[str, list[str]]:
    """Components of every interoperable type of the kernel, by the struct that it is."""
    found = {}
    for source in (ROOT / "src").rglob("*.f90"):
        text = source.read_text().replace("&\n", "")
        pattern = r"(?:!> (evl_\w+)\n *)?type, bind\(c\) :: (\w+)\n(.*?)end type"
        for comment, name, body in re.findall(pattern, text, flags=re.DOTALL):
            lines = [re.sub(r"!.*", "", line) for line in body.splitlines()]
            declared = [line.split("::")[1] for line in lines if "::" in line]
            components = [
                re.sub(r"\(.*?\)|=.*", "", part).strip()
                for line in declared
                for part in re.sub(r"\([^)]*\)", "", line).split(",")
            ]
            if name not in OF_TESTS:
                found[comment] = components
    return found


@pytest.mark.parametrize("name", sorted(types()))
def test_the_fields_of_a_struct_are_those_of_its_type(name: str) -> None:
    assert structs()[name] == types()[name]


def bindings() -> dict[str, type[ctypes.Structure]]:
    """Structures of the tests' binding, by the struct that their first line names."""
    found = {}
    for module in sorted((ROOT / "tests" / "kernel").glob("[a-z]*.py")):
        for value in vars(importlib.import_module(f"kernel.{module.stem}")).values():
            if isinstance(value, type) and issubclass(value, ctypes.Structure):
                name = re.match(r"`(evl_\w+)`", value.__doc__ or "")
                if name:
                    found[name[1]] = value
    return found


@pytest.mark.parametrize("name", sorted(bindings()))
def test_the_fields_of_a_struct_are_those_of_its_binding(name: str) -> None:
    """A binding that is shorter than its struct lets the kernel write beyond it."""
    assert structs()[name] == [field[0] for field in bindings()[name]._fields_]
