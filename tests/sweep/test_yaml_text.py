"""Values of a plan are the values of a case file: YAML 1.2, not PyYAML's 1.1."""

from __future__ import annotations

import re

import pytest
from hypothesis import given
from hypothesis import strategies as st

from evolvent.errors import SweepError
from evolvent.sweep.yaml_text import MOST_BYTES, read_yaml, yaml_text


@pytest.mark.parametrize(
    ("text", "value"),
    [
        ("1e9", 1e9),
        ("1.0e+9", 1e9),
        ("-2", -2),
        ("010", 10),
        ("no", "no"),
        ("12:30", "12:30"),
        ("2020-01-01", "2020-01-01"),
        ("true", True),
        ("~", None),
        ("{law: none}", {"law": "none"}),
    ],
)
def test_a_text_is_read_as_yaml_1_2_has_it(text, value):
    assert read_yaml(text, "x") == value


VALUES = st.recursive(
    st.none()
    | st.booleans()
    | st.integers(-(2**60), 2**60)
    | st.floats(allow_nan=False)
    | st.text(st.characters(codec="utf-8")),
    lambda inner: (
        st.lists(inner, max_size=3) | st.dictionaries(st.text("abc", min_size=1), inner, max_size=3)
    ),
    max_leaves=8,
)


@pytest.mark.parametrize("text", ["\xa0", " a ", "\u3000a", "a\nb", "a\n...", "\x85", "\u2028"])
def test_a_text_of_white_space_or_several_lines_survives(text):
    written = yaml_text({"name": text})
    assert written.splitlines() == [written]
    assert read_yaml(written, "x") == {"name": text}
    assert read_yaml(yaml_text(text), "x") == text


@given(VALUES)
def test_a_value_survives_being_written_on_one_line_and_read(value):
    text = yaml_text(value)
    assert not re.search("[\n\r\x85\u2028\u2029]", text)
    assert read_yaml(text, "x") == value


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("a: 1\na: 2", "x:2:1: the key 'a' is given twice"),
        ("a: [1", "x:1:6: "),
        ("{[1]: 2}", "x:1:2: a key must be a text or a number"),
        ("!!python/object:os.system x", "x:1:1: could not determine a constructor"),
    ],
)
def test_what_is_no_plain_yaml_is_refused_with_its_place(text, message):
    with pytest.raises(SweepError) as caught:
        read_yaml(text, "x")
    assert str(caught.value).startswith(message)


def repeated(times: int) -> str:
    """A list of ten numbers, and one that has it so often."""
    return f"- &a {list(range(10))}\n- [{', '.join(['*a'] * times)}]\n"


def test_values_that_aliases_repeat_count_as_if_they_were_written_out():
    """Each time a list and its ten numbers; that one itself, the list of it and all add 13."""
    fit = (MOST_BYTES - 13) // 11
    assert len(read_yaml(repeated(fit), "x")[1]) == fit
    with pytest.raises(SweepError) as caught:
        read_yaml(repeated(fit + 1), "x")
    assert str(caught.value) == (f"x: its aliases contain, expanded, more than {MOST_BYTES} values")
