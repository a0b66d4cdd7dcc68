"""Formulas on pages: MathML from the plain text of symbols and invariants.

The text is that of `symbol` attributes and docs/theory/theory.md: Greek letters by their names, `_`
before a subscript, ' for a time derivative, products by a blank, words for quantities without a
letter.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from html import escape
from unicodedata import lookup

from markupsafe import Markup

# fmt: off
LETTERS = (
    "alpha", "chi", "epsilon", "eta", "kappa", "mu", "omega", "phi", "psi", "rho", "sigma", "theta",
    "xi", "zeta",
)
# fmt: on
GREEK = {name: lookup(f"GREEK SMALL LETTER {name.upper()}") for name in LETTERS}
GREEK |= {
    "lambda": lookup("GREEK SMALL LETTER LAMDA"),
    "Delta": lookup("GREEK CAPITAL LETTER DELTA"),
}
GREEK["eps"] = GREEK["epsilon"]
FUNCTIONS = ("inv", "max", "min", "mean")
RELATIONS = ("<=", ">=", "=", "<", ">")
SIGNS = {"<=": "≤", ">=": "≥", "-": "−", "*": "·", ".": "·"}  # noqa: RUF001 - the minus of print
TOKEN = re.compile(r"[A-Za-z]+(?:_(?:[A-Za-z0-9]+|\([^)]*\)))?'*|\d[\d.]*|<=|>=|\S")
NAME = re.compile(r"([A-Za-z]+)(?:_(\w+|\([^)]*\)))?('*)")


def symbol(text: str) -> Markup:
    """Typeset a symbol such as `F_nk` or `max F_n`; an empty symbol gives empty markup."""
    return Markup(_math(TOKEN.findall(text)) if text else "")


def formula(text: str) -> Markup:
    """Typeset an invariant; words around the formulas stay text, and lines break between terms.

    >>> "<mfrac>" in formula("lambda = -r_bB/r_bA")
    True
    """
    parts = re.split(r"([,:] )", text)
    return Markup("".join(_clause(part) for part in parts))


def _clause(text: str) -> str:
    """Typeset a relation with the words before and after it, or words alone."""
    if not any(sign in text for sign in RELATIONS):
        return escape(text)
    tokens = TOKEN.findall(text)
    begin, end = 0, len(tokens)
    while _is_word(tokens[begin]) and not _is_sign(tokens[begin + 1]):
        begin += 1
    while _is_word(tokens[end - 1]) and not _is_sign(tokens[end - 2]):
        end -= 1
    terms = "<wbr>".join(
        _math(term, goes_on=number > 0) for number, term in enumerate(_terms(tokens[begin:end]))
    )
    words = (" ".join(tokens[:begin]), terms, " ".join(tokens[end:]))
    return " ".join(part for part in words if part)


def _terms(tokens: list[str]) -> Iterator[list[str]]:
    """Split a formula before the signs at which lines may break."""
    term: list[str] = []
    depth = 0
    for token in tokens:
        if depth == 0 and term and term[-1] not in RELATIONS and token in (*RELATIONS, "+", "-"):
            yield term
            term = []
        depth += {"(": 1, ")": -1}.get(token, 0)
        term.append(token)
    yield term


def _math(tokens: list[str], goes_on: bool = False) -> str:
    """Return one element; `goes_on` if it follows another one, so that its first sign is infix."""
    row: list[str] = []
    rest = iter(_joined(tokens))
    for token in rest:
        if token == "/" and row:
            row.append(f"<mfrac>{row.pop()}{_operand(next(rest), rest)}</mfrac>")
        elif goes_on and not row and _is_sign(token):
            row.append(f'<mo form="infix">{escape(SIGNS.get(token, token))}</mo>')
        else:
            row.append(_operand(token, rest))
    shown = "".join(row)
    return (
        f'<math displaystyle="true">{shown}</math>'
        if "<mfrac>" in shown
        else f"<math>{shown}</math>"
    )


def _joined(tokens: list[str]) -> list[str]:
    """Join consecutive words."""
    joined: list[str] = []
    for token in tokens:
        if joined and _is_word(token) and _is_word(joined[-1].split()[-1]):
            joined[-1] += f" {token}"
        else:
            joined.append(token)
    return joined


def _operand(token: str, rest: Iterator[str]) -> str:
    """Typeset a token, or an expression up to its closing bracket."""
    if token == "(":
        inside = []
        for inner in rest:
            if inner == ")":
                break
            inside.append(_operand(inner, rest))
        return f"<mrow><mo>(</mo>{''.join(inside)}<mo>)</mo></mrow>"
    if token[0].isdigit():
        return f"<mn>{token}</mn>"
    if _is_word(token.split()[0]):
        return f"<mtext>\u00a0{escape(token)}\u00a0</mtext>"
    match = NAME.fullmatch(token)
    if match is None:
        return f"<mo>{escape(SIGNS.get(token, token))}</mo>"
    name, below, primes = match.groups()
    if name in FUNCTIONS:
        of = _operand(next(rest), rest)
        return f'<mrow><mi>{name}</mi><mspace width="0.17em"></mspace>{of}</mrow>'
    base = f"<mi>{GREEK.get(name, name)}</mi>"
    above = f"<mo>{'′' * len(primes)}</mo>" if primes else ""  # noqa: RUF001 - primes
    if below == "star":
        return f"<msup>{base}<mo>*</mo></msup>"
    under = _below(below) if below else ""
    if under and above:
        return f"<msubsup>{base}{under}{above}</msubsup>"
    if under:
        return f"<msub>{base}{under}</msub>"
    return f"<msup>{base}{above}</msup>" if above else base


def _below(text: str) -> str:
    """Typeset a subscript: letters, a number, or a sum in brackets."""
    if text.startswith("("):
        tokens = iter(TOKEN.findall(text[1:-1]))
        return f"<mrow>{''.join(_operand(token, tokens) for token in tokens)}</mrow>"
    if text.isdigit():
        return f"<mn>{text}</mn>"
    return f"<mi>{GREEK.get(text, text)}</mi>"


def _is_word(token: str) -> bool:
    """Whether a token is a word of the language, not a symbol."""
    return token.isalpha() and len(token) > 1 and token not in GREEK and token not in FUNCTIONS


def _is_sign(token: str) -> bool:
    return not token[0].isalnum() and token not in "()"
