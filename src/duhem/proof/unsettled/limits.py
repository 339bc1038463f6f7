"""Where formulas have no value or jump, and what to write: for a part a value where a load is 0, or the formula without the divisor.

Whether K stays what it was is looked at in floats, close to where the load is 0: the value that is written there need not be a limit.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import replace
from fractions import Fraction
from itertools import islice, product

import numpy as np
import sympy as sp
from numpy.typing import NDArray

from duhem.expression.numpy_ import Program, compiled
from duhem.law.domain import Domain
from duhem.proof.facts.formula_subject import FormulaSubject
from duhem.proof.kernel.constant_value import exact_value
from duhem.proof.kernel.curvature import within_ranges
from duhem.proof.kernel.definedness import Reader, rarely_zero
from duhem.proof.kernel.domain import NEGATIVE, StatedDomain, gap
from duhem.proof.kernel.stated_law import StatedLaw
from duhem.proof.kernel.term import NotWritten, Term, factors, number, product_of, sum_of
from duhem.proof.unsettled.term_text import Names, in_text

__all__ = ["jump", "keeps_k", "with_values"]

_MOST = 4  # parts in one formula, and ways to choose each
_CHOICES, _DRAWN, _MOVES = 2, 24, 30  # of parameters; of places, and around each; to a zero of a size
_PLACES = tuple(map(Fraction, ("0", "1", "-1", "2", "-2", "3", "-3", "6", "-6", "1/2", "-1/2")))
_NEAR, _TINY, _SAME, _ROUNDING = 1e-6, 1e-11, 1e-3, 1e-9
_ZERO, _ONE = number(0), number(1)


def with_values(read: StatedLaw, names: Names) -> Iterator[tuple[str, Term]]:
    """What to write, and g then: 0 for parts without a value, from the smallest to the largest, in g and in g times what it divides by."""
    domain, seen = within_ranges(read), set[Term]()
    if (tip := _tip(read.g, domain)) is None:
        return
    _, size, power = tip
    for start, rank in product((read.g, _times(read.g, size, power)), range(_MOST)):
        g, put = start, list[tuple[Term, Term]]()
        while (tip := _tip(g, domain)) is not None and len(put) < _MOST:
            above = _above(start, tip[0], names)
            x = above[min(rank, len(above) - 1)]
            limit = Term("where", (Term(">", (tip[1], _ZERO)), x, _ZERO))
            if (changed := g.put({x: limit})) == g or any(x in other.parts() for _, other in put):
                g = read.g  # what is put in has that part again
                break
            g = changed
            put.append((x, limit))
        if g != read.g and g not in seen:
            seen.add(g)
            told = " and ".join(f"{in_text(limit, names)} for {in_text(x, names)}" for x, limit in put) + ", if you mean 0 there"
            whole = f"{in_text(g, names)} for g, which is {in_text(_raised(size, power), names)} times g"
            yield f"write {told if start is read.g else whole}", g


def _tip(g: Term, domain: StatedDomain) -> tuple[Term, Term, Term] | None:
    """A part without a value, what is 0 there and else > 0, and the power of it that divides; None where that is not seen."""
    if (part := Reader(domain).undecided(g)) is None or part.op not in ("**", "log", "atan2"):
        return None
    size, power = (Term("norm", part.args) if part.op == "atan2" else part), Fraction(1)
    while size.op in ("**", "log"):
        power *= abs(size.args[1].value) if size.op == "**" else 1
        size = size.args[0]
    loads = [x for x in factors(size) if not x.names() or not domain.constant(x)]
    size = loads[0] if len(loads) == 1 else size if len(loads) == len(factors(size)) else Term("*", tuple(loads))
    if domain.facts(size).sign & NEGATIVE or not rarely_zero(size, domain):
        return None
    risen = (x.args[1] for x in g.parts() if x.op == "**" and x.args[1].op != "number" and part in x.args[0].parts())
    return part, size, next(risen, number(power or 1))


def _above(g: Term, part: Term, names: Names) -> list[Term]:
    """Parts that hold a part: those that have a name, then the product that it stands in, then the term of the sum; the smallest first."""
    found = [x for x in g.parts() if x != part and part in x.parts()]
    whole = [x for x in found if x.op == "*"]
    return [*(x for x in found if isinstance(names.get(x), str)), *whole[:1], *whole[-1:], *found[:1]] or [part]


def _times(term: Term, size: Term, power: Term) -> Term:
    """A formula times a power of a size by which it may divide."""
    if term.op == "+":
        return sum_of(*(_times(a, size, power) for a in term.args if a != _ZERO))
    if term.op == "**" and term.args[1] == power and power.op != "number":
        return Term("**", (_times(term.args[0], size, _ONE), power))
    rest, own = _split(term, size)
    for x in rest:
        if x != term and x.op in ("+", "**") and any(_split(y, size)[1] < 0 for y in x.parts()):
            outer = [] if not own else [_raised(size, number(own))]
            return product_of(*(_times(y, size, power) if y is x else y for y in rest), *outer)
    left = number(own + power.value) if power.op == "number" else sum_of(number(own), power)
    return product_of(*rest, *([] if left == _ZERO else [_raised(size, left)]))


def _raised(size: Term, power: Term) -> Term:
    return size if power == _ONE else Term("**", (size, power))


def _split(term: Term, size: Term) -> tuple[list[Term], Fraction]:
    """The factors of a term but for powers of a size, and the power of that."""
    if factors(term) == factors(size):
        return [], Fraction(1)
    if term.op == "**" and term.args[1].op == "number" and (found := _split(term.args[0], size))[1]:
        return [Term("**", (product_of(*found[0]), term.args[1]))] if found[0] else [], found[1] * term.args[1].value
    if term.op == "*":
        parts = [_split(a, size) for a in term.args]
        return [x for rest, _ in parts for x in rest], sum((own for _, own in parts), Fraction(0))
    return [term], Fraction(0)


@np.errstate(all="ignore")  # where a formula has no value it is nan, or infinite
def keeps_k(subject: FormulaSubject, g: str) -> bool:
    """Whether K seems to be as before where g has no value and a changed g has: one near those around, or of a sign found there."""
    law, rng, n = subject.law, np.random.default_rng(7), len(subject.law.forces)
    table, ranges = law.symbols(), [law.domain.get(f, Domain()) for f in law.forces]
    old, new = (compiled(x.g, table.values()) for x in (law, replace(law, g=g, written="")))
    low, high = np.array([[-np.inf if x.low is None else float(x.low), np.inf if x.high is None else float(x.high)] for x in ranges]).T
    equal = np.outer((0.0, 1.0, -1.0, 30.0, -30.0), np.arange(n) < (3 if law.stress else n))
    drawn = rng.standard_normal((_DRAWN, n)) * (1 - np.eye(n)[np.arange(_DRAWN) % n])
    places = np.concatenate([equal, drawn, 30 * drawn])
    divisors = [compiled(x, table.values()) for x in _divisors(law.g) if x.free_symbols & set(law.force_symbols())]
    for parameters in islice(subject.choices(_CHOICES), _CHOICES):
        known = subject.named(subject.values_at(parameters, subject.nowhere))
        others = [float(known[name]) for name in [*table][n:]]
        at_zero = [z for divisor in divisors for z in _where_zero(divisor, drawn, others) if (low <= z).all() and (z <= high).all()]
        for z in (*(z for z in np.clip(places, low, high) if not np.isfinite(old(*z, *others))), *at_zero):
            here = float(new(*z, *others))
            around = np.clip(z + _NEAR * max(1.0, np.abs(z).max()) * np.concatenate([equal[:3], drawn]), low, high)
            near = old(*around.T, *others)
            near = near[np.isfinite(near)]
            found = np.any(near <= 0) if here <= _ROUNDING else np.all(near > 0)
            if np.isfinite(here) and len(near) and not (found or np.all(np.abs(near - here) <= _SAME * (1 + abs(here)))):
                return False
    return True


def _divisors(g: sp.Expr) -> list[sp.Expr]:
    """What a formula divides by, and what is 0 where a logarithm or an angle in it has no value."""
    powers = [x.base for x in g.atoms(sp.Pow) if x.exp.could_extract_minus_sign()]
    return [*powers, *(x.args[0] for x in g.atoms(sp.log)), *(sp.sqrt(x.args[0] ** 2 + x.args[1] ** 2) for x in g.atoms(sp.atan2))]


def _where_zero(size: Program, places: NDArray[np.float64], others: Sequence[float]) -> NDArray[np.float64]:
    """Places at which a size is 0: others are moved there along its slope, and those that do not come there are left out."""
    for _ in range(_MOVES):
        ways = [_TINY * (np.arange(places.shape[1]) == i) for i in range(places.shape[1])]
        slope = np.stack([(size(*(places + way).T, *others) - size(*(places - way).T, *others)) / (2 * _TINY) for way in ways], axis=1)
        value, steep = size(*places.T, *others), (slope**2).sum(axis=1)
        places = places - np.divide(value, steep, out=np.zeros_like(value), where=steep > _ROUNDING)[:, None] * slope
    return places[np.abs(size(*places.T, *others)) <= 10 * _TINY]


def jump(choice: Term, forces: Sequence[str], values: Mapping[str, Fraction]) -> str:
    """A plain place at which a choice by the forces changes over from one value to another, in exact arithmetic; "" where none is found."""
    condition, one, two = choice.args
    moving = sorted(choice.names() & {*forces})
    for place in product(_PLACES, repeat=len(moving)):
        at = {**values, **dict(zip(moving, place, strict=True))}
        swap = {Term("name", name=name): number(value) for name, value in at.items()}
        with suppress(NotWritten, ZeroDivisionError):
            border, a, b = (exact_value(x.put(swap)) for x in (gap(condition), one, two))
            if border == 0 and a != b:
                return f"; it jumps from {a} to {b} at {', '.join(f'{name} = {at[name]}' for name in sorted(choice.names()))}"
    return ""
