"""Formulas on pages: MathML that says what the plain text says."""

from __future__ import annotations

import re
from xml.etree import ElementTree

import pytest

from evolvent.pages.formulas import GREEK, SIGNS, formula, symbol
from evolvent.physics.invariants import INVARIANTS

# fmt: off
SYMBOLS = (
    "F_n", "max F_nk", "omega'", "u''", "E_star", "eps_alpha", "r_bA g_A", "kappa_c", "P_rho",
    "R (inv alpha - inv alpha_0)", "max F_n / mean F_n", "max Delta - min Delta", "max | F_t |",
)
# fmt: on
PLAIN = {typeset: plain for plain, typeset in (SIGNS | GREEK).items()} | {"·": ".", "′": "'"}  # noqa: RUF001


def read_back(markup: str) -> str:
    """Plain text of markup, without blanks, brackets, bars of fractions and marks of subscripts."""
    text = "".join(ElementTree.fromstring(f"<p>{markup.replace('<wbr>', '')}</p>").itertext())
    return bare("".join(PLAIN.get(letter, letter) for letter in text))


def bare(text: str) -> str:
    return re.sub(r"[\s()/_]", "", text.replace("*", "star"))


@pytest.mark.parametrize("text", [row.formula for row in INVARIANTS])
def test_an_invariant_reads_as_its_plain_text(text):
    assert read_back(formula(text)) == bare(text)


@pytest.mark.parametrize("text", SYMBOLS)
def test_a_symbol_reads_as_its_plain_text(text):
    assert read_back(symbol(text)) == bare(text)


def test_subscripts_primes_and_fractions_are_typeset():
    assert "<msub><mi>F</mi><mi>n</mi></msub>" in symbol("F_n")
    assert "<msup><mi>u</mi>" in symbol("u''")
    assert "<mfrac>" in formula("lambda = -r_bB/r_bA")
    assert symbol("max F_n / mean F_n").count("<mi>F</mi>") == 2
    assert re.search("<mfrac><mrow>.*</mrow><mrow>.*</mrow></mfrac>", symbol("max F_n / mean F_n"))


def test_words_are_no_products_of_letters():
    assert "<math>" not in formula("every value is finite")
    assert "<mtext>\u00a0work of loads\u00a0</mtext>" in formula("D - work of loads = constant")


def test_lines_break_between_terms_only():
    assert formula("J omega' = load + sigma (F_n r_b + F_t l)").count("<wbr>") == 2


def test_what_looks_like_markup_stays_text():
    assert "<b>" not in formula("a <b> c = d")
    assert symbol("") == ""
