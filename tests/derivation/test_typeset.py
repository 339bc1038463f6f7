"""Formulas in rows that fit, and what their names stand for."""

from __future__ import annotations

import re
from collections.abc import Iterator

import pytest
import sympy as sp

from duhem.derivation.typeset import WIDE, Rows, Typesetter, width

X = sp.symbols("x1:40", real=True)
Y = sp.Symbol("y")
SUM = sp.Add(*(x**2 for x in X))
HARD = {
    "a sum": SUM,
    "a root": sp.sqrt(SUM),
    "a quotient": sp.sqrt(SUM) * (X[0] + 2 * X[1]) / (SUM + X[0] * X[1] + 1),
    "a quotient of two sums": (SUM + 1) ** 2 / (2 * SUM + 3 * X[2]) ** sp.Rational(3, 2) - 5 * X[3] / (SUM + 1),
    "many arguments": sp.Max(*(sp.sqrt(x**2 + i) for i, x in enumerate(X)), evaluate=False),  # to compare them takes two seconds
    "branches": sp.Piecewise((sp.sqrt(SUM), sp.And(*(x > 0 for x in X[:30]))), (SUM / X[0], X[0] < 0), (X[1], True)),
    "branches within": X[0] * sp.Piecewise((sp.exp(SUM), X[0] > 0), (sp.S.One, True)),
    "a number": sp.Rational(3**300, 7**120) * X[0],
    "the other sign": (-X[0] - sp.Add(*X[1:])) / (X[3] + 1) * (SUM - 1),
}
NAME = re.compile(r"\\mathsf\{A\}_\{(\?*\d+)\}")


def rows_of(rows: Rows) -> list[str]:
    return [*rows.formula, *rows.named]


def meanings(rows: Rows) -> Iterator[tuple[str, str]]:
    """Names and what they are said to be; branches have one row or more each."""
    for statement in re.split(r"\n(?!\\qquad)", "\n".join(rows.named)):
        name, _, meaning = statement.partition(" = ")
        if NAME.fullmatch(name.strip()):
            yield name.strip(), meaning.replace("\n", " ")


def bare(formula: str) -> str:
    """Without brackets, spaces and what breaks a row."""
    return re.sub(r"\\(left|right|bigl|bigr)[()]|\\q?quad|\\,|\\cdot|[\s(){}]", "", formula)


@pytest.mark.parametrize("what", HARD)
def test_every_row_fits_and_every_name_is_defined_once(what: str) -> None:
    rows = Typesetter({}).rows(sp.Eq(Y, HARD[what], evaluate=False), "1")
    assert len(rows_of(rows)) > 1
    assert max(map(width, rows_of(rows))) <= WIDE
    used = set(NAME.findall(" ".join(rows_of(rows))))
    defined = [name for name, _ in meanings(rows)]
    assert "branches" in what or len(defined) == len(set(defined))
    assert set(NAME.findall(" ".join(defined))) == used == {str(i + 1) for i in range(len(used))}


@pytest.mark.parametrize("what", [what for what in HARD if what not in ("branches", "branches within", "the other sign")])
def test_names_put_back_give_the_formula(what: str) -> None:
    rows = Typesetter({}).rows(sp.Eq(Y, HARD[what], evaluate=False), "1")
    written = " ".join(rows.formula)
    stands_for = dict(meanings(rows))
    while NAME.search(written):
        written = NAME.sub(lambda found: stands_for[found.group()], written)
    whole = Typesetter({})._trial(sp.Eq(Y, HARD[what], evaluate=False))
    assert bare(written) == bare(whole)


def test_a_name_means_the_same_in_the_whole_document() -> None:
    typesetter = Typesetter({})
    first = typesetter.rows(sp.Eq(Y, sp.sqrt(SUM), evaluate=False), "1")
    again = typesetter.rows(sp.Eq(Y, X[0] / sp.sqrt(SUM), evaluate=False), "2")
    assert first.formula == [r"y = \sqrt{\mathsf{A}_{1}}"] and again.formula == [r"y = \frac{x_{1}}{\sqrt{\mathsf{A}_{1}}}"]
    assert again.named == [r"\mathsf{A}_{1} \text{ as in (1)}"]
    other = typesetter.rows(sp.Eq(Y, sp.sqrt(SUM + 1), evaluate=False), "3")
    assert other.formula == [r"y = \sqrt{\mathsf{A}_{2}}"]


def test_what_an_equation_defines_is_called_by_its_name_elsewhere() -> None:
    typesetter = Typesetter({}, {SUM: ("J_{2}", "D0.1")})
    own = typesetter.rows(sp.Eq(sp.Symbol("J2"), SUM, evaluate=False), "D0.1")
    assert len(own.formula) > 1 and not own.named
    assert typesetter.rows(sp.Eq(Y, sp.sqrt(SUM), evaluate=False), "2") == Rows([r"y = \sqrt{J_{2}}"], [r"J_{2} \text{ as in (D0.1)}"])


def test_what_fits_stays_as_it_is() -> None:
    assert Typesetter({}).rows(sp.Eq(Y, sp.sqrt(X[0] + 1), evaluate=False), "1") == Rows([r"y = \sqrt{x_{1} + 1}"], [])
