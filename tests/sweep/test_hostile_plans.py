"""Plans and formulas that nobody means well: each is taken, or refused in one line.

Whatever stands in a plan, no other error comes out of it, and 10 MB of it take neither long nor
much memory: a process of its own reads them under the limits of the system.
"""

from __future__ import annotations

import random
import re
import resource
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from sweeps import PAPER

from evolvent.errors import SweepError
from evolvent.sweep.expression import FUNCTIONS, evaluate
from evolvent.sweep.plan import make_plan
from system.random_sets import seeds

EACH = 25  # plans of a seed
SECONDS, BYTES = 4, 500 * 2**20  # 2 s of reading, and as much for Python to start
PLAN = """\
format: 1
title: a sweep
case: case.yaml
method: {method}
seed: 3
window: {{from: 0.001, to: 0.002}}
histories: {{variables: [normal_force], every: 2}}
parameters:
- {{path: wheels.pinion.loads.0.value, name: torque, units: N m, {source}}}
- {{path: meshes.0.damping, values: [{{law: linear, coefficient: 100}}, {{law: none}}]}}
- {{name: twice, expression: 2*torque + sin(torque)}}
"""
SOURCES = {
    "factorial": "values: [-1, -2.5e0, -3]",
    "list": "values: [-1, -2]",
    "latin_hypercube\nsamples: 4": "from: -2, to: -1",
    "sobol\nsamples: 4": "from: 1, to: 9, scale: log",
}
BITS = [
    "1e400", "-0", ".nan", "9" * 400, "1e-400", "0x10", "null", "~", "''", "[]", "{}", "- ",
    ": ", "&a ", "*a", "!!python/name:os.system ", "!!binary aGk=", "<<: ", "? ", "| ", "> ",
    "%YAML 1.1\n", "---\n", "...\n", "\t", "\x00", "\x07", "\x85", "\u2028", "\u202e", "\ufeff",
    "\U0001f600", "'", '"', "#", "{", "}", "[", "]", ",", "true", "no", "2**9**9**9",
    "torque.__class__", "__import__('os')", "2001-01-01", "1:30", "-1", "0", "torque", "\n",
    "  ", "10**400", "lambda: 0", "(", ")",
]  # fmt: skip
WORD = re.compile(r"[\w.+*-]+")
FORMULAS = [
    "9**9**9**9**9", "((" * 400, "-" * 900 + "1", "a" * 1001, "a" * 999, "9" * 400, "1e999",
    "a.real", "a.__class__", "a[0]", "[a]", "(a, a)", "{a}", "lambda: a", "(b := a)", "f'{a}'",
    "'x'*9", "eval(a)", "__import__('os')", "open('x')", "abs.__call__(a)", "max(*[a])",
    "max(a)", "sin(x=a)", "a if a else a", "a < a < a", "not a", "a and a", "a @ a", "a << 9",
    "~a", "await a", "yield a", "[a for a in a]", "...", "1j", "True", "None", "b'x'",
    "a\u2028+", "a\x85", "\u202ea", "a\x00", "a;a", "a=a", "a\na", "# a", "", "a if a < a else",
    "0x" + "f" * 900, "1_0", "\U0001d44e", "max(" * 90 + "a, 1" + ")" * 90, "a " * 400,
]  # fmt: skip
LARGE = {
    "values": "values: [" + "1," * 5_000_000 + "1]",
    "a long text": "values: ['" + "x" * 10_000_000 + "']",
    "a long number": "values: [" + "9" * 10_000_000 + "]",
    "deep lists": "values: " + "[" * 10_000_000,
    "deep lists in bounds": "values: " + "[" * 9_000 + "]" * 9_000,
    "deep blocks in bounds": "values: " + "{a: " * 40_000,
    "escapes": 'values: ["' + "\\x41" * 2_500_000 + '"]',
    "aliases of aliases": "values: [&a0 [1, 1, 1, 1, 1, 1, 1, 1, 1], "
    + ", ".join(f"&a{i} [{', '.join([f'*a{i - 1}'] * 9)}]" for i in range(1, 12))
    + "]",
    "keys": "units: '', " + ", ".join(f"k{i}: 1" for i in range(800_000)),
    "a comment": "values: [1]}\n#" + "x" * 10_000_000 + "\n- {name: x, value: 1",
}
READ = """\
import sys
from pathlib import Path
from evolvent.errors import SweepError
from evolvent.sweep.spec import read_spec
try:
    read_spec(Path(sys.argv[1]))
except SweepError as error:
    print(error)
else:
    print("taken")
"""


def one_line(error: SweepError) -> bool:
    """Whether a message is what it should be; what cannot be printed becomes a blank later."""
    text = str(error)
    return 0 < len(text) < 2000 and "\n" not in text and "Traceback" not in text


def mutated(text: str, chance: random.Random) -> str:
    """Some places of a plan hold something else: a word, a number, or any bytes."""
    if chance.random() < 0.7:
        word = chance.choice(list(WORD.finditer(text)))
        other = chance.choice([*BITS, *WORD.findall(text), "-1", "-2.5", "-0.3"])
        return text[: word.start()] + other + text[word.end() :]
    for _ in range(chance.choice([1, 1, 2, 4])):
        begin = chance.randrange(len(text))
        end = min(len(text), begin + chance.choice([0, 0, 1, 3, 9, 40]))
        text = text[:begin] + chance.choice([*BITS, text[begin:end] * 3, ""]) + text[end:]
    return text


@pytest.mark.parametrize("method", SOURCES)
def test_what_is_mutated_is_taken_as_it_is(executable: Path, tmp_path: Path, method: str) -> None:
    (tmp_path / "case.yaml").write_bytes(PAPER.read_bytes())
    path = tmp_path / "sweep.yaml"
    path.write_text(PLAN.format(method=method, source=SOURCES[method]))
    assert make_plan(path, executable)[0].n_cases > 1


@pytest.mark.parametrize("seed", seeds(range(8), 200))
def test_a_mutated_plan_is_taken_or_refused_in_one_line(
    executable: Path, tmp_path: Path, seed: int
) -> None:
    chance, path = random.Random(seed), tmp_path / "sweep.yaml"
    (tmp_path / "case.yaml").write_bytes(PAPER.read_bytes())
    for _ in range(EACH):
        method = chance.choice(list(SOURCES))
        plan = PLAN.format(method=method, source=SOURCES[method])
        path.write_text(mutated(plan, chance), encoding="utf-8")
        try:
            design, _ = make_plan(path, executable)
        except SweepError as error:
            if not one_line(error):
                raise
        else:
            assert design.n_cases >= 1
            assert all(len(p.values) == design.n_cases for p in design.parameters)


@pytest.mark.parametrize("text", FORMULAS, ids=range(len(FORMULAS)))
def test_a_hostile_formula_gives_finite_numbers_or_one_line(text: str) -> None:
    try:
        found = evaluate(text, {"a": np.array([1.0, 2.0])}, 2)
    except SweepError as error:
        if not one_line(error):
            raise
    else:
        assert np.isfinite(found).all()


@pytest.mark.parametrize("seed", seeds(range(4), 200))
def test_random_formulas_give_finite_numbers_or_one_line(seed: int) -> None:
    chance = random.Random(seed)
    words = [*"ab()+-*/%.,<[]{}:=09", "1e9", "**", "//", " if ", " else ",
             *FUNCTIONS, "__class__", "lambda", "'", "\u2028", "import"]  # fmt: skip
    columns = {"a": np.array([1.0, 2.0]), "b": np.array(["x", "y"], dtype=object)}
    n_taken = 0
    for _ in range(20 * EACH):
        text = "".join(chance.choices(words, k=chance.randrange(1, 12)))
        try:
            assert np.isfinite(evaluate(text, columns, 2)).all()
            n_taken += 1
        except SweepError as error:
            if not one_line(error):
                raise
    assert n_taken > 0


@pytest.mark.parametrize("name", LARGE)
def test_ten_megabytes_of_a_plan_take_neither_long_nor_much_memory(
    tmp_path: Path, name: str
) -> None:
    (tmp_path / "case.yaml").write_bytes(PAPER.read_bytes())
    path = tmp_path / "sweep.yaml"
    path.write_text(PLAN.format(method="list", source=LARGE[name]))

    def limit() -> None:
        resource.setrlimit(resource.RLIMIT_CPU, (SECONDS, SECONDS))
        resource.setrlimit(resource.RLIMIT_DATA, (BYTES, BYTES))

    done = subprocess.run(
        [sys.executable, "-c", READ, path],
        preexec_fn=limit,
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, done.stderr[-500:]
    assert len(done.stdout) < 2000
    assert done.stdout.count("\n") == 1
