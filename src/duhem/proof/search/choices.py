"""Parameter values to look at when scouting: exact, inside the domain, the plainest first."""

from __future__ import annotations

import random
from collections.abc import Iterator, Mapping, Sequence
from fractions import Fraction
from itertools import product
from math import prod
from typing import Any

import sympy as sp

from duhem.proof.facts.case import Case
from duhem.proof.witness.points import inside_domain, values_at

__all__ = ["choices", "fraction"]

_SCALES = (Fraction(1), Fraction(1, 2), Fraction(2), Fraction(1, 10), Fraction(10), Fraction(1, 100), Fraction(100))


def choices(case: Case, hints: Sequence[Mapping[sp.Symbol, Any]] = (), most: int = 40) -> Iterator[dict[sp.Symbol, Fraction]]:
    """Exact parameter values inside the domain: hints first, then ends, middles and decades of each range."""
    free = case.simple.parameters
    seen: set[tuple[Fraction, ...]] = set()

    def admitted(values: dict[sp.Symbol, Fraction]) -> bool:
        key = tuple(values.values())
        if key in seen or not inside_domain(case, {**values_at(case, values, [Fraction(0)] * len(case.simple.forces))}):
            return False
        exact = {x: sp.Rational(v.numerator, v.denominator) for x, v in values.items()}
        if case.simple.g.subs(exact).has(sp.nan, sp.zoo, sp.oo):
            return False
        seen.add(key)
        return True

    for hint in hints:
        if all(x in hint for x in free):
            exact = {x: fraction(hint[x]) for x in free}
            if admitted(exact):
                yield exact
    grids = [_range(case, x) for x in free]
    combinations = list(product(*grids)) if prod(len(g) for g in grids) <= 4096 else []
    rng = random.Random(2)
    if not combinations:
        combinations = [tuple(rng.choice(g) for g in grids) for _ in range(400)]
    plain, rest = combinations[:1], combinations[1:]
    rng.shuffle(rest)
    combinations = plain + rest
    found = 0
    for combination in combinations:
        values = dict(zip(free, combination, strict=True))
        if found < most and admitted(values):
            found += 1
            yield values


def fraction(value: Any) -> Fraction:
    """An exact number as a Fraction."""
    exact = sp.Rational(value)
    return Fraction(int(exact.p), int(exact.q))


def _range(case: Case, x: sp.Symbol) -> list[Fraction]:
    low = high = None
    for relation in case.simple.given:
        if getattr(relation, "gts", None) == x and relation.lts.is_Rational:
            low = fraction(relation.lts) if low is None else max(low, fraction(relation.lts))
        if getattr(relation, "lts", None) == x and relation.gts.is_Rational:
            high = fraction(relation.gts) if high is None else min(high, fraction(relation.gts))
    if low is not None and high is not None:
        shares = (
            Fraction(0),
            Fraction(1),
            Fraction(1, 2),
            Fraction(1, 100),
            Fraction(99, 100),
            Fraction(1, 4),
            Fraction(3, 4),
            Fraction(9, 10),
        )
        return [low + s * (high - low) for s in shares]
    if low is None and high is None:
        return [Fraction(0), *_SCALES, *(-s for s in _SCALES)]
    start, sense = (low, 1) if low is not None else (high, -1)
    assert start is not None
    return [start + sense * s for s in _SCALES] + [start]
