"""Case files of excessive cost: each ends soon, within bounded memory, with one line.

The bounds are for files of a few MB, far below the limits of the process here. A reader whose time
or memory grows with the square of its input, or with its nesting, reaches the limit of the kernel.
"""

from __future__ import annotations

import resource
import subprocess
from pathlib import Path

import pytest

SIZE = 2_000_000  # approximate size [B]
MEMORY = 500_000_000  # address space [B]
SECONDS = 20  # of processor time: 2 are required for 10 MB; machines are shared


def listed(item: str) -> str:
    """A list with as many items as fit."""
    return "format: 1\nx: [" + item * (SIZE // len(item)) + "1]\n"


def wheels(n: int) -> str:
    """Wheels, and nothing else."""
    block = "- {{name: w{}, teeth: 20, width: 0.1, material: steel}}\n"
    head = "format: 1\nmaterials: {steel: {youngs_modulus: 2e11, poisson_ratio: 0.3, density: 1}}\n"
    return (
        head
        + "wheels:\n"
        + "".join(block.format(i) for i in range(n))
        + "meshes: []\nsimulation: {}\n"
    )


# Part of the message for each text.
TEXTS = {
    "lists in lists": ("a: " + "[" * SIZE, "nested too deeply"),
    "blocks in blocks": ("a: " + "{a: " * (SIZE // 4), "nested too deeply"),
    "indented blocks": ("".join(" " * i + "a:\n" for i in range(1900)), "nested too deeply"),
    "dashes": ("- " * (SIZE // 2) + "\n", "nested too deeply"),
    "pairs of lists": ("a: " + "[[]," * (SIZE // 4), "nested too deeply"),
    "a list that is not closed": (listed("1,")[:-2], "not valid YAML"),
    "anchors": (
        "x: [" + ",".join(f"&a{i} 1" for i in range(SIZE // 11)) + "]\n",
        "too many anchors",
    ),
    "aliases of aliases": (
        "x0: &x0 [1,1,1,1,1,1,1,1,1]\n"
        + "".join(f"x{i}: &x{i} [{','.join([f'*x{i - 1}'] * 9)}]\n" for i in range(1, 20)),
        "too many values",
    ),
    "an alias in itself": ("a: &a {b: [*a]}\n", "an alias that contains itself"),
    "keys": ("".join(f"k{i}: 1\n" for i in range(SIZE // 12)), "too many keys in one block"),
    "blocks of many keys": (
        "x:\n" + ("- {" + ",".join(f"k{i}: 1" for i in range(1990)) + "}\n") * (SIZE // 20000),
        "unknown key 'x'",
    ),
    "values of an unknown key": (listed("1,"), "unknown key 'x'"),
    "a long key": ("x" * SIZE + ": 1\n", "not valid YAML"),
    "a long quoted key": ("? " + "x" * SIZE + "\n: 1\n", "unknown key 'xxx"),
    "documents": ("---\n" * (SIZE // 4), "a second YAML document"),
    "directives": ("%TAG !a! tag:x\n" * (SIZE // 15), "not valid YAML"),
    "comments": ("#\n" * (SIZE // 2), "is empty"),
    "empty lines": ("\n" * SIZE, "is empty"),
    "tabs": ("a:\n" + "\t" * SIZE, "a tab"),
    "wheels": (wheels(SIZE // 50), "elements, may have 1000"),
}


def limited() -> None:
    resource.setrlimit(resource.RLIMIT_AS, (MEMORY, MEMORY))
    resource.setrlimit(resource.RLIMIT_CPU, (SECONDS, SECONDS))


def validate(program: Path, text: str, folder: Path) -> subprocess.CompletedProcess[str]:
    """Result of the program for a text."""
    path = folder / "case.yaml"
    path.write_text(text, encoding="utf-8")
    return subprocess.run(
        [program, "validate", path],
        capture_output=True,
        text=True,
        env={"OPENBLAS_NUM_THREADS": "1"},
        preexec_fn=limited,
    )


@pytest.mark.parametrize("name", TEXTS)
def test_what_is_no_case_costs_little(name: str, executable: Path, tmp_path: Path) -> None:
    text, expected = TEXTS[name]
    ended = validate(executable, text, tmp_path)
    assert (ended.returncode, ended.stdout) == (3, "")
    assert ended.stderr.count("\n") == 1
    assert expected in ended.stderr


def test_a_table_of_a_million_knots_is_good(
    executable: Path, examples: Path, tmp_path: Path
) -> None:
    n = 1_000_000
    table = f"time: [{','.join(str(i / 10) for i in range(n))}], torque: [{','.join(['-1'] * n)}]"
    case = (examples / "paper.yaml").read_text(encoding="utf-8")
    load = "{kind: torque, value: -1}"
    assert load in case
    ended = validate(executable, case.replace(load, f"{{kind: table, {table}}}"), tmp_path)
    assert (ended.returncode, ended.stderr) == (0, "")
