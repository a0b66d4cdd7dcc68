"""Formulas of derived columns: what they give, and that they cannot do anything else."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from evolvent.errors import SweepError
from evolvent.sweep.expression import evaluate

A = np.array([1.0, 4.0, 9.0])
B = np.array([2, 3, 5])
COLUMNS = {"a": A, "b": B, "law": np.array(["none", "tanh", "none"], dtype=object)}


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("a + b", A + B),
        ("-a*b/2", -A * B / 2),
        ("2*pi*b/60", 2 * math.pi * B / 60),
        ("sqrt(a)", np.array([1.0, 2.0, 3.0])),
        ("a**2 - 1", A**2 - 1),
        ("b // 2 + b % 2", np.array([1.0, 2.0, 3.0])),
        ("-a // 2", np.array([-1.0, -2.0, -5.0])),  # as Python rounds: down
        ("-a % 2", np.array([1.0, 0.0, 1.0])),
        ("max(a, b, 3)", np.array([3.0, 4.0, 9.0])),
        ("min(a, b)", np.array([1.0, 3.0, 5.0])),
        ("a if a < b else b", np.array([1.0, 3.0, 5.0])),
        ("1 if a >= 4 else 0", np.array([0.0, 1.0, 1.0])),
        ("1 if a <= 4 else 0", np.array([1.0, 1.0, 0.0])),
        ("1 if a > 1 and b != 5 or a == 1 else 0", np.array([1.0, 1.0, 0.0])),
        ("degrees(atan2(1, 1))", np.array([45.0] * 3)),
        ("exp(log(a))", A),
        ("7", np.array([7.0] * 3)),
    ],
)
def test_a_formula_gives_what_arithmetic_gives(text, expected):
    # One rounding more or less, as of exp(log(a)).
    np.testing.assert_allclose(evaluate(text, COLUMNS, 3), expected, rtol=4e-16, atol=4e-16)


@pytest.mark.parametrize(
    "text",
    [
        "__import__('os').system('true')",
        "a.__class__",
        "a[0]",
        "[x for x in a]",
        "(lambda: 1)()",
        "open('x')",
        "'text'",
        "True",
        "a < b",
        "a if a else b",
        "f'{a}'",
        "(a := 1)",
        "max(*a)",
        "round(a, ndigits=1)",
        "a @ b",
        "a; b",
        "",
        "(" * 300 + "a" + ")" * 300,
        "a" + "+a" * 1000,
    ],
)
def test_what_is_no_arithmetic_is_refused(text):
    with pytest.raises(SweepError):
        evaluate(text, COLUMNS, 3)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("c + 1", "unknown name 'c' in a formula; known here: a, b, law, pi, e"),
        ("sine(a)", "unknown function 'sine'"),
        ("law", "'law' is a text"),
        ("1/(a - 4)", "is inf for case 1"),
        ("sqrt(-a)", "is nan for case 0"),
        ("9**9**9**9", "is inf for case 0"),
        ("atan2(a)", "takes 2 arguments"),
    ],
)
def test_a_refusal_says_what_is_wrong(text, message):
    with pytest.raises(SweepError) as caught:
        evaluate(text, COLUMNS, 3)
    assert message in str(caught.value)


@given(st.text(max_size=60))
def test_any_text_gives_numbers_or_a_refusal(text):
    try:
        values = evaluate(text, COLUMNS, 3)
    except SweepError:
        return
    assert values.shape == (3,)
    assert np.isfinite(values).all()


def test_a_formula_has_at_most_a_thousand_characters():
    long = "+".join(["a"] * 500)  # 999 characters
    np.testing.assert_allclose(evaluate(long, COLUMNS, 3), 500 * A, rtol=1e-13)
    with pytest.raises(SweepError, match="longer than 1000 characters"):
        evaluate(long + "+a", COLUMNS, 3)
