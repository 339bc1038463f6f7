"""What leads from a question to the deciders, without them: a question is put to a world of one point.

There every decider is exact: it evaluates.  Whatever takes a question to pieces (branches, factors, cleared quotients, roots by
name, values put in place, the half-angle of the circle) must therefore find the violation at a violated point, and must find
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

from duhem.proof import decide
from duhem.proof.decide import Answer, Budget, Question, Sense, deciders
from duhem.proof.decide.polynomials import System
from duhem.proof.decide.reduction import parts
from tests.proof.decide.questions import GOALS, Violated, as_system, is_polynomial, violated_ones
from tests.proof.decide.truth import Point, UndefinedError, UnsuitedError, system_violated, value, violated


@cache
def many() -> list[Violated]:
    return [one for kind in GOALS for one in violated_ones(f"glue/{kind}", 10, kind)]


def _with_roots(system: System, at: Point) -> dict[sp.Symbol, Fraction]:
    """The point with the values that their definitions give the symbols of roots; 0 where there is none."""
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
                if form.length() <= 2 and form.degree() > 1:
                    top, rest = value(form.LC(), at), value(form.nth(0), at)
                    if top == 0 or rest / top > 0:
                        return Fraction(0)
                    return value(sp.root(sp.Rational(*(-rest / top).as_integer_ratio()), form.degree()), {})
    return Fraction(0)


@pytest.fixture
def world(monkeypatch: pytest.MonkeyPatch) -> Callable[[Question, Point], bool | None]:
    """``decide`` where every decider but the sign rules evaluates at the one point there is, with the values that words have there."""
    beyond = deciders._beyond_words

    def asked(question: Question, at: Point) -> bool | None:
        at = dict(at)

        def beyond_words(question: Question, budget: Budget) -> Question | None:
            wider = beyond(question, budget)
            if wider is not None:
                replaced = sorted(sp.Tuple(question.expr, *question.given).atoms(sp.exp, sp.tan), key=sp.default_sort_key)
                names = [r.lhs for r in wider.given[len(question.given) :]]
                kept = sp.Tuple(wider.expr, *wider.given).atoms(sp.exp, sp.tan)
                at.update(zip(names, (value(n, at) for n in replaced if n not in kept), strict=True))
            return wider

        def of_system(system: System, _: object) -> Answer:
            return Answer(not system_violated(system, _with_roots(system, at)), "evaluation")

        def of_question(question: Question, _: object) -> Answer:
            return Answer(not violated(question, at), "evaluation")

        monkeypatch.setattr(deciders, "POLYNOMIAL_DECIDERS", (of_system,))
        monkeypatch.setattr(deciders, "_enclosed", of_question)
        monkeypatch.setattr(deciders, "_beyond_words", beyond_words)
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


def test_pinned_keeps_a_violation() -> None:
    assert _each(lambda one: any(sp.I in q.expr.atoms() or violated(q, one.point) for q in one.question.pinned())) == []


@pytest.mark.slow
def test_parts_keep_a_violation() -> None:
    """One of the smaller questions is violated at the point, and gives the point back."""

    def kept(one: Violated) -> bool:
        system, at = as_system(one.question), dict(one.point)
        for part in parts(system):
            new = [v for v in part.system.variables if v not in at]
            if new:  # t = tan(theta/2)
                c, s = (at[v] for v in system.circle or ())
                if c == -1:
                    continue
                at[new[0]] = s / (1 + c)
            found = part.restored({v: sp.Rational(*at[v].as_integer_ratio()) for v in part.system.variables})
            if all(found[v] == at[v] for v in system.variables) and system_violated(part.system, at):
                return True
        return False

    assert [one for one in violated_ones("parts", 60, "polynomial") if is_polynomial(one.question) and not kept(one)] == []


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
