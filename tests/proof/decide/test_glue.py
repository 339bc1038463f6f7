"""What leads from a question to the deciders, without them: a question is put to a world of one point.

There every decider is exact: it evaluates.  Whatever takes a question to pieces (branches, roots, quotients and words by
name, values put in place) must therefore find the violation at a violated point, and must find
none at a point where the hypotheses fail or the goal is as wanted.
"""

from __future__ import annotations

import importlib
import pkgutil
from collections.abc import Callable
from dataclasses import is_dataclass
from fractions import Fraction
from functools import cache

import pytest
import sympy as sp

import duhem.proof.decide as deciders
from duhem.proof import decide
from duhem.proof.decide import Answer, Question, Sense
from duhem.proof.decide.smt import System
from tests.proof.decide.questions import GOALS, Violated, violated_ones
from tests.proof.decide.truth import Point, UndefinedError, UnsuitedError, system_violated, value


@cache
def many() -> list[Violated]:
    return [one for kind in GOALS for one in violated_ones(f"glue/{kind}", 10, kind)]


def _with_roots(system: System, at: Point) -> dict[sp.Symbol, Fraction]:
    """The point with the values that their definitions give the symbols of roots and quotients; 0 where there is none."""
    whole = dict(at)
    for rho in system.variables:
        if rho not in whole:
            whole[rho] = _root(system, rho, whole)
    return whole


def _root(system: System, rho: sp.Symbol, at: Point) -> Fraction:
    for o in (system, *system.obligations):
        for r in o.given:
            if r.op == "==" and rho in r.poly.free_symbols and r.poly.free_symbols <= {rho, *at}:
                form = sp.Poly(r.poly, rho)
                if form.length() <= 2:
                    top, rest = value(form.LC(), at), value(form.nth(0), at)
                    if form.degree() == 1:
                        return -rest / top if top else Fraction(0)
                    if top == 0 or rest / top > 0:
                        return Fraction(0)
                    return value(sp.root(sp.Rational(*(-rest / top).as_integer_ratio()), form.degree()), {})
    return Fraction(0)


@pytest.fixture
def world(monkeypatch: pytest.MonkeyPatch) -> Callable[[Question, Point], bool | None]:
    """``decide`` where every decider but the sign rules evaluates at the one point there is, with the values that words have there."""
    name, words = deciders._name, dict[sp.Symbol, sp.Expr]()

    def named(word: sp.Expr) -> sp.Symbol:
        words[found := name(word)] = word
        return found

    def asked(question: Question, at: Point) -> bool | None:
        words.clear()

        def of_system(system: System, _: object) -> Answer:
            here = {**at, **{x: value(words[x], at) for x in system.variables if x in words}}
            return Answer(not system_violated(system, _with_roots(system, here)), "evaluation")

        monkeypatch.setattr(deciders, "POLYNOMIAL_DECIDERS", (of_system,))
        monkeypatch.setattr(deciders, "_name", named)
        return deciders.decide(question).holds

    return asked


def _each(check: Callable[[Violated], bool]) -> list[Violated]:
    """The questions that fail a check; those whose roots are no fractions are left out, and may not be many."""
    failed, unsuited = [], 0
    for one in many():
        try:
            failed += [] if check(one) else [one]
        except UnsuitedError:
            unsuited += 1
    assert unsuited < len(many()) // 8
    return failed


@pytest.mark.slow
def test_a_violation_is_found(world: Callable[[Question, Point], bool | None]) -> None:
    assert _each(lambda one: world(one.question, one.point) is not True) == []


@pytest.mark.slow
def test_what_holds_at_the_point_is_not_denied(world: Callable[[Question, Point], bool | None]) -> None:
    """Nothing is lost: turned round, with the goal as wanted, the same questions hold in their worlds."""

    def passes(one: Violated) -> bool:
        asked = one.question
        try:
            here = value(asked.expr, one.point)
        except UndefinedError:
            return True
        turned = Question(asked.expr + sp.Rational(*(1 - here).as_integer_ratio()), Sense.POSITIVE, asked.given, asked.circle)
        return world(turned, one.point) is True

    assert _each(passes) == []


def test_what_is_handed_on_is_frozen() -> None:
    modules = [importlib.import_module(f"duhem.proof.decide.{m.name}") for m in pkgutil.iter_modules(decide.__path__)]
    values = {c for module in modules for c in vars(module).values() if isinstance(c, type) and is_dataclass(c)}
    assert {Answer, Question, System} <= values and [c for c in values if not c.__dataclass_params__.frozen] == []
