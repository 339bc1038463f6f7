"""Small random questions whose answer is known because of how they are made.

A false one is built around a point: every hypothesis is moved until it holds there, mostly with equality, and the goal until
it fails there.  A true one is its certificate multiplied out: squares, squares times hypotheses >= 0, and anything times
hypotheses = 0, or hypotheses that contradict each other.
"""

from __future__ import annotations

import random
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction

import sympy as sp

from duhem.expression import Neg, Norm, Pos, Where, symbol
from duhem.expression.number import rational
from duhem.proof.decide import Question, Sense
from tests.proof.decide.truth import Point, UnsuitedError, violated

__all__ = ["GOALS", "SYMBOLS", "Violated", "in_a_box", "true_ones", "violated_ones"]

SYMBOLS = tuple(symbol(name) for name in "xyz")
N, P, Z = Sense.NONNEGATIVE, Sense.POSITIVE, Sense.ZERO
_PLACES = tuple(Fraction(n) for n in ("-2", "-1", "-1/2", "0", "0", "1/2", "1", "2"))
_ROUND = [(1, 0), (0, 1), (-1, 0), (0, -1), ("3/5", "4/5"), ("-4/5", "3/5"), ("5/13", "-12/13")]


@dataclass(frozen=True)
class Violated:
    """A question and a point where it is violated."""

    question: Question
    point: Point


@dataclass(frozen=True)
class Near:
    """Random polynomials, few terms with small coefficients, moved to a value at a point."""

    rng: random.Random
    at: Point

    def __call__(self, to: int | Fraction, degree: int = 2) -> sp.Expr:
        symbols = tuple(self.at)
        terms = [[self.rng.choice(symbols) for _ in range(self.rng.randint(0, degree))] for _ in range(self.rng.randint(1, 3))]
        scales = [Fraction(self.rng.choice((-3, -2, -1, 1, 2, 3)), self.rng.choice((1, 1, 1, 2))) for _ in terms]
        here = sum((c * sp.prod([self.at[s] for s in term]) for c, term in zip(scales, terms, strict=True)), Fraction(0))
        return sp.Add(rational(Fraction(to - here)), *(rational(c) * sp.Mul(*term) for c, term in zip(scales, terms, strict=True)))

    def away(self, least: int = 1) -> sp.Expr:
        """A symbol less its value at the point, shifted up."""
        x = self.rng.choice(tuple(self.at))
        return x - rational(self.at[x]) + least

    def apart(self) -> sp.Expr:
        """The squared distance from the point."""
        return sp.Add(*((x - rational(v)) ** 2 for x, v in self.at.items()))


# Hypotheses that hold at the point: f moves polynomials, x is a symbol, a its value, d is 1 or 2.
_HYPOTHESES: Sequence[Callable[[Near, sp.Symbol, sp.Rational, int], Sequence[sp.Basic]]] = (
    lambda f, x, a, d: [sp.Ge(x, a)],
    lambda f, x, a, d: [sp.Le(x, a)],
    lambda f, x, a, d: [sp.Ge(x, a), sp.Eq(x, a)],
    lambda f, x, a, d: [sp.Eq(x, a)],
    lambda f, x, a, d: [sp.Ge(x, a), sp.Le(x, a)],
    lambda f, x, a, d: [sp.Ge(x - a, 0), sp.Ge(a - x, 0)],
    lambda f, x, a, d: [sp.Ge(2 * x, 2 * a), sp.Ge(x, a), sp.Ge(x, a - d)],  # redundant bounds
    lambda f, x, a, d: [sp.Gt(x, a - d), sp.Lt(x, a + d)],
    lambda f, x, a, d: [sp.Ge(f(0), 0)],
    lambda f, x, a, d: [r(both, 0) for both in (f(0),) for r in (sp.Le, sp.Ge)],
    lambda f, x, a, d: [sp.Eq(f(0), 0)],
    lambda f, x, a, d: [sp.Gt(f(d), 0)],
    lambda f, x, a, d: [sp.Ne(f(d), 0)],
    lambda f, x, a, d: [sp.Eq((x - a) * (x - a - d), 0)],  # two values
    lambda f, x, a, d: [sp.Eq((x - a) * (x**2 + 1), 0)],
    lambda f, x, a, d: [sp.Le((x - a) ** 2, 0)],
    lambda f, x, a, d: [sp.Eq(f.apart(), 0)],  # one point
    lambda f, x, a, d: [sp.Le(f.apart(), d)],
    lambda f, x, a, d: [sp.Eq(x - a + d * f.away(0), 0)],  # a line
    lambda f, x, a, d: [sp.Eq(f(0) ** 2, 0)],
    lambda f, x, a, d: [sp.Ge(-(f(0) ** 2), 0)],
    lambda f, x, a, d: [sp.Ge(1 / f(1), 1)],
    lambda f, x, a, d: [sp.Ge(sp.Abs(f(-1)), 1)],
)

Goal = tuple[sp.Expr, Sense]
# Goals that fail at the point, by what a decider has to do with them first.
GOALS: Mapping[str, Sequence[Callable[[Near], Goal]]] = {
    "polynomial": (
        lambda f: (f(-1), N),
        lambda f: (f(Fraction(-1, 2)), P),
        lambda f: (f(0), P),
        lambda f: (f(1), Z),
        lambda f: (f(-1), Z),
        lambda f: (f(0) ** 2, P),  # 0 at the point, positive beside
        lambda f: (f(0) ** 2 + f(0) ** 2, P),
        lambda f: (f(2) ** 2 * f(-1), N),  # an even factor that does not vanish
        lambda f: (sp.expand(f.away() ** 2 * f(-1)), N),
        lambda f: (f.away() ** 3 * f(-1), N),
        lambda f: (sp.expand(f.away(-1) * f(1)), N),
        lambda f: (f.away(0) ** 2 * f(2) ** 2, P),
        lambda f: (-(f(2) ** 2), N),
        lambda f: (f(1) * f(-1), N),
        lambda f: (sp.expand(f(-1) * f(2) * f.away()), N),
        lambda f: (f.apart(), P),
        lambda f: (f.apart() - Fraction(1, 100), N),
        lambda f: (sp.Integer(0), P),
        lambda f: (sp.Integer(-1), N),
        lambda f: (sp.Integer(1), Z),
    ),
    "quotient": (
        lambda f: (f(2) / f(-2), N),
        lambda f: (f(-1) / f(1), N),
        lambda f: (f(1) / f(-2) ** 3, P),
        lambda f: (f(-1) / f(-2) ** 2, N),
        lambda f: (1 / f(2) + 1 / f(-1), P),
        lambda f: (f(0) / f(1), P),
        lambda f: (f(1) / f(-1), Z),
        lambda f: (f(2) ** 2 / f(0), N),  # undefined at the point, and so are those below
        lambda f: (f(1) ** 2 / f(0) ** 2, P),
        lambda f: (1 / (1 / f(0) + f(1)), N),
        lambda f: (f(0) ** 2 / f(0) ** 2, N),
        lambda f: (f(0) / f(0), Z),
        lambda f: (f.away(0) / f.apart(), Z),
    ),
    "root": (
        lambda f: (sp.sqrt(f(4)) - 2, P),
        lambda f: (1 - sp.sqrt(f(4)), N),
        lambda f: (sp.sqrt(f(4)) + f(-3), N),
        lambda f: (sp.sqrt(f(0)), P),
        lambda f: (sp.sqrt(1 / f(4)) - 1, N),
        lambda f: (f(-1) / sp.sqrt(f(4)), N),
        lambda f: (Norm(f(0), f(0)), P),
        lambda f: (1 - Norm(f(2), f(0)), N),
        lambda f: (sp.sqrt(sp.sqrt(f(4)) - 2) - 1, N),
        lambda f: (sp.sqrt(f(-1)) + 1, P),  # undefined at the point, and so are those below
        lambda f: (f(0) * sp.sqrt(f(-1)) + 1, P),
        lambda f: (sp.sqrt(1 / f(0)) + 1, P),
        lambda f: (sp.sqrt(f(0) ** 2 / f(0) ** 2 + 1), N),
        lambda f: (1 / sp.sqrt(f(0)), N),
        lambda f: (Norm(sp.sqrt(f(-1)), f(0)), N),
        lambda f: (Norm(1 / f(0), 1), P),
        lambda f: (f(2) / Norm(f(0), f(0)), Z),
        lambda f: (sp.sqrt(sp.sqrt(f(4)) - 3), N),
    ),
    "kink": (
        lambda f: (sp.Abs(f(0)), P),
        lambda f: (sp.Abs(f(-1)) - 2, N),
        lambda f: (sp.Abs(f(-1)) + f(-1), P),
        lambda f: (Pos(f(-1)), P),
        lambda f: (Neg(f(0)), P),
        lambda f: (Pos(f(1)) - 2 * Neg(f(-1)), N),
        lambda f: (sp.Max(f(-1), f(-2)), N),
        lambda f: (sp.Min(f(1), f(-1)), N),
        lambda f: (sp.Max(f(0), f(0)), P),
        lambda f: (sp.Min(f(0) ** 2, f(1)), P),
        lambda f: (Where(sp.Gt(f(0), 0), 1, f(-1)), N),
        lambda f: (Where(sp.Ge(f(0), 0), f(-1), 1), N),
        lambda f: (Where(sp.Lt(f(0), 0), 1, -sp.Abs(f(1))), N),
        lambda f: (Where(sp.Le(f(0), 0), f(0), 1), P),
        lambda f: (sp.Abs(f(0)) / f(0) + 2, P),  # undefined at the point, and so are those below
        lambda f: (1 / sp.Abs(f(0)), P),
        lambda f: (sp.Max(1, 1 / f(0)), P),
        lambda f: (sp.Max(0, sp.sqrt(f(-1))), N),
        lambda f: (sp.Abs(sp.sqrt(f(-1)) + 1), N),
        lambda f: (sp.Abs(sp.log(f(-1))), N),
        lambda f: (sp.Max(1, sp.log(f(0))), P),
    ),
    "transcendental": (
        lambda f: (sp.exp(f(0)) - 1, P),
        lambda f: (1 - 2 * sp.exp(f(0)), N),
        lambda f: (f(-1) * sp.exp(f(0)), N),
        lambda f: (sp.exp(f(0)) + f(-1), P),
        lambda f: (sp.tanh(f(0)) + f(-1), N),
        lambda f: (sp.log(f(1)) + f(-1), N),
        lambda f: (sp.exp(f(0)) * sp.Abs(f(0)), P),
        lambda f: (1 + sp.log(f(0)) ** 2, P),  # undefined at the point, and so are those below
        lambda f: (sp.exp(f(0)) * sp.sqrt(f(-1)), N),
        lambda f: (sp.exp(f(0)) / f(0), N),
    ),
}


def violated_ones(seed: str, count: int, kind: str, most: int = 3) -> Iterator[Violated]:
    """Questions of a kind of ``GOALS`` in up to ``most`` variables, violated at their points; some on the circle."""
    rng, found = random.Random(seed), 0
    while found < count:
        symbols = SYMBOLS[: rng.randint(1, most)]
        circle = (symbols[0], symbols[1]) if len(symbols) > 1 and rng.random() < 0.25 else None
        on = dict(zip(circle, map(Fraction, rng.choice(_ROUND)), strict=True)) if circle else {}
        at = {x: on[x] if x in on else rng.choice(_PLACES) for x in symbols}
        near = Near(rng, at)
        given: list[sp.Basic] = []
        try:
            for _ in range(rng.randint(0, 3)):
                x = rng.choice(symbols)
                given += rng.choice(_HYPOTHESES)(near, x, rational(at[x]), rng.randint(1, 2))
            expr, sense = rng.choice(GOALS[kind])(near)
            given += [sp.Eq(circle[0] ** 2 + circle[1] ** 2, 1)] if circle else []
            question = Question(expr, sense, tuple(r for r in given if r is not sp.true))
            usable = not any(e.has(sp.nan, sp.zoo, sp.I) for e in (expr, *given)) and violated(question, at)
        except (UnsuitedError, ValueError):  # the value is no fraction; max(1, zoo)
            continue
        if usable:
            found += 1
            yield Violated(question, at)


def in_a_box(question: Question, symbols: Iterable[sp.Symbol], by: int = 2) -> Question:
    """The same within a box, on whose boundary the point may lie."""
    box = tuple(r for x in symbols for r in (sp.Ge(x, -by), sp.Le(x, by)))
    return Question(question.expr, question.sense, (*question.given, *box))


def true_ones(seed: str, count: int, most: int = 3) -> Iterator[Question]:
    """Polynomial questions that hold."""
    rng, found = random.Random(seed), 0
    while found < count:
        at = {x: rng.choice(_PLACES) for x in SYMBOLS[: rng.randint(1, most)]}
        expr, sense, *given = rng.choice(_TRUE)(Near(rng, at))
        if sp.false not in given:
            found += 1
            yield Question(sp.expand(expr), sense, tuple(r for r in given if r is not sp.true))


def _certified(f: Near) -> tuple[sp.Basic | Sense, ...]:
    weak, equal, strict = f(0, 1), f(0), f.rng.randint(0, 1)
    goal = f.rng.choice((1, f.away(0) ** 2, sp.S.Half)) * weak + f.rng.choice((-2, 1, f.away(0))) * equal + f(0, 1) ** 2 + strict
    return goal, P if strict else N, sp.Ge(weak, 0), sp.Eq(equal, 0)


def _squares(f: Near) -> tuple[sp.Basic | Sense, ...]:
    x = f.away(0)
    return f(0) ** 2 + f(1, 1) ** 2, N, *f.rng.choice(((), (sp.Ge(x, 0),), (sp.Gt(x, 1),), (sp.Eq(x, 0),)))


def _pinned(f: Near) -> tuple[sp.Basic | Sense, ...]:
    to, sense = f.rng.choice(((0, N), (1, P), (0, Z)))
    ends = [(x, rational(v)) for x, v in f.at.items()]
    pins = [f.rng.choice(([sp.Eq(x, v)], [sp.Ge(x, v), sp.Le(x, v)], [sp.Le((x - v) ** 2, 0)])) for x, v in ends]
    return f(to, 3), sense, *(r for pin in pins for r in pin)


def _contradictory(f: Near) -> tuple[sp.Basic | Sense, ...]:
    x, p = f.away(0), f(0)
    given = f.rng.choice(
        (
            (sp.Eq(x, 1), sp.Le(x, 0)),
            (sp.Ge(x, 1), sp.Lt(x, 1)),
            (sp.Eq(x, 0), sp.Ne(x, 0)),
            (sp.Ge(p, 1), sp.Le(p, -1)),
            (sp.Eq(x * p, 1), sp.Eq(p, 0)),
        )
    )
    return f.rng.choice((sp.S.NegativeOne, f(0))), f.rng.choice((N, P, Z)), *given


_TRUE = (_certified, _squares, _pinned, _contradictory)
