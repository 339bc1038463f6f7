"""A law under examination: what is derived from it, each form once, within steps that the verification renews.

And exact parameter values to look at: inside the ranges that single relations give, the plainest first.
"""

from __future__ import annotations

import random
from collections.abc import Callable, Iterator, Mapping, Sequence
from fractions import Fraction
from functools import cached_property, wraps
from itertools import combinations, islice, product
from math import prod
from typing import Any, TypeVar

import sympy as sp

from duhem.expression import holds_at
from duhem.expression.number import rational
from duhem.law.curve_law import Law
from duhem.law.domain import Domain
from duhem.law.formula_law import Criterion
from duhem.proof.decide import ANY_STEPS, Answer, Budget, Question, decide, defined
from duhem.proof.decide.question import bounds
from duhem.proof.statement import texts

__all__ = ["Point", "Subject", "Values", "fact", "middle_of", "plain_choices", "rationals", "walk"]

_SCALES = (Fraction(1), Fraction(1, 2), Fraction(2), Fraction(1, 10), Fraction(10), Fraction(1, 100), Fraction(100))
_SHARES = (Fraction(0), Fraction(1), *(Fraction(k, 100) for k in (50, 1, 99, 25, 75, 90)))
_MOST_TOGETHER, _DRAWN = 4096, 400
_MOST_CHOICES = 200
_MARGIN = Fraction(1, 2**20)  # larger than the boxes in which corners are held

Values = Mapping[sp.Symbol, Fraction]
Point = tuple[Fraction, ...]  # in the force space of the simple problem


class Subject:
    """What the methods of proof are asked about; a law given by a formula and one given by a boundary curve differ in the rest."""

    law: Law

    def __init__(self, question_steps: int, effort: Fraction, whole: Budget | None = None) -> None:
        self._question_steps, self.effort = int(question_steps * effort), effort
        self.whole = whole or Budget(ANY_STEPS)  # what everything about the law may cost together
        self._spent, self.budget = 0, Budget(0)
        self.allow(2 * question_steps)
        self._answers: dict[Question, Answer] = {}
        self.known: dict[object, Any] = {}  # kept by `fact`, which knows the types

    def allow(self, steps: int) -> None:
        """What is asked from now on shares this many steps, times the effort; what comes after is left open."""
        self._spent = self.spent
        self.budget = Budget(int(steps * self.effort), self.whole)

    @property
    def spent(self) -> int:
        """The steps that everything asked so far has cost."""
        return self._spent + self.budget.spent

    def decided(self, question: Question) -> Answer:
        """The answer; where it leaves the question open, it is kept if all the steps of a question were to be had."""
        if (known := self._answers.get(question)) is not None:
            return known
        part = self.budget.part(self._question_steps)
        whole = part.left == self._question_steps
        answer = decide(question, part)
        if answer.holds is not None or whole:
            self._answers[question] = answer
        return answer

    def may_prove(self, claim: str) -> bool:
        """Whether a proof of the claim counts that the kernel does not confirm."""
        return False

    @cached_property
    def free(self) -> tuple[sp.Symbol, ...]:
        """Parameters that are not fixed."""
        return tuple(self.law.free())

    @cached_property
    def ranges(self) -> tuple[sp.Basic, ...]:
        """Those of the free parameters, each by itself, as relations."""
        return tuple(r for x, domain in self.law.free().items() for r in domain.relations(x))

    @cached_property
    def given(self) -> tuple[sp.Basic, ...]:
        """The domain of the free parameters, as relations."""
        fixed = self.law.fixed_values()
        return tuple(r for r in (*self.ranges, *(c.xreplace(fixed) for c in self.law.constraints)) if r != sp.true)

    @cached_property
    def constraints_defined(self) -> bool:
        """Whether each constraint as written is shown to have a value."""
        return defined(texts(self.law, self.law.constraints, self.law.written_constraints), self.law.parameters)

    def may_refute(self, claim: str, points: Mapping[str, Mapping[str, str]]) -> bool:
        """Whether a violation of the claim at exact points, by role and by name, lies in the ranges of the law, a corner with its sides.

        A sharp point is shown by ways out of it, and lies in the ranges as these do: it may be at an end of one.
        """
        edge = _MARGIN if claim == "smoothness" and "outside" not in points else Fraction(0)
        beside = {name: edge if name in self.law.forces else Fraction(0) for name in self.domain}
        return all(
            name in point and all(rational(Fraction(point[name]) + step) in span for step in {-beside[name], beside[name]})
            for point in points.values()
            for name, span in self.domain.items()
        )

    @property
    def domain(self) -> Mapping[str, Domain]:
        """The ranges of the pressure and of forces in which the claims are asked."""
        return self.law.domain if isinstance(self.law, Criterion) else {}

    def choices(self, most: int) -> Iterator[Values]:
        """Exact values of the free parameters inside the domain, the plainest first."""
        yield from islice(filter(self.admits, islice(plain_choices(self.free, self.given), _MOST_CHOICES)), most)

    def admits(self, values: Values) -> bool:
        """Whether the values satisfy every relation of the law's domain, in exact arithmetic."""
        exact = rationals(values)
        return all(holds_at(relation, exact) for relation in self.given)


S = TypeVar("S", bound=Subject)
T = TypeVar("T")


def fact(derive: Callable[[S], T]) -> Callable[[S], T]:
    """A derived form, made at most once for a subject; None says that it was not found within the budget, and is asked for again."""

    @wraps(derive)
    def once(subject: S) -> T:
        found: T | None = subject.known.get(derive)
        if found is None and (made := derive(subject)) is not None:
            found = subject.known[derive] = made
        return found  # type: ignore[return-value]

    return once


# -- exact values of parameters ----------------------------------------------------------------------------------------


def rationals(values: Values) -> dict[sp.Symbol, sp.Rational]:
    """The values as SymPy has them."""
    return {x: rational(v) for x, v in values.items()}


def plain_choices(free: Sequence[sp.Symbol], given: Sequence[sp.Basic]) -> Iterator[dict[sp.Symbol, Fraction]]:
    """Ends, middles and decades of each symbol's range together; where these are too many, some at random (fixed seed)."""
    grids = [_grid(x, given) for x in free]
    combinations = list(product(*grids)) if prod(len(g) for g in grids) <= _MOST_TOGETHER else []
    rng = random.Random(2)
    if not combinations:
        combinations = [tuple(rng.choice(g) for g in grids) for _ in range(_DRAWN)]
    plain, rest = combinations[:1], combinations[1:]
    rng.shuffle(rest)
    for combination in plain + rest:
        yield dict(zip(free, combination, strict=True))


def walk(starts: Sequence[Values], admits: Callable[[Values], bool], most: int = 200) -> Iterator[dict[sp.Symbol, Fraction]]:
    """``starts``, what lies between two of them, and where random steps lead (fixed seed), as long as may be: inside however thin a set.

    At most so many values are tried, those between two starts first.
    """
    yield from map(dict, starts)
    for one, two in combinations(starts, 2):
        middle = {x: (one[x] + two[x]) / 2 for x in one}
        if admits(middle):
            yield middle
    rng = random.Random(8)
    for here in map(dict, starts):
        left = most // len(starts)
        while left > 0:
            way = {x: rng.choice((-1, 0, 1)) for x in here}
            for k in range(0, 40, 4):
                left -= 1
                there = {x: value + max(abs(value), Fraction(1)) * way[x] / 2**k for x, value in here.items()}
                if any(way.values()) and admits(there):
                    here = there
                    yield dict(here)
                    break


def middle_of(x: sp.Symbol, given: Sequence[sp.Basic]) -> Fraction:
    """A value well inside the range of a symbol, by the relations that speak of it alone."""
    low, high = bounds(x, given)
    return _grid(x, given)[2] if low is not None and high is not None else _grid(x, given)[0]


def _grid(x: sp.Symbol, given: Sequence[sp.Basic]) -> list[Fraction]:
    low, high = bounds(x, given)
    if low is not None and high is not None:
        return [low + s * (high - low) for s in _SHARES]
    if low is None and high is None:
        return [Fraction(0), *_SCALES, *(-s for s in _SCALES)]
    start, sense = (low, 1) if low is not None else (high, -1)
    assert start is not None
    return [start + sense * s for s in _SCALES] + [start]
