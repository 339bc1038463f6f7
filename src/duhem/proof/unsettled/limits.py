"""Where formulas have no value or jump, and what to write: for a part a value where a load is 0, or the formula without the divisor.

Whether K stays what it was is looked at in floats, close to where the load is 0: the value that is written there need not be a limit.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from contextlib import suppress
from dataclasses import replace
from fractions import Fraction
from functools import partial
from itertools import islice, product

import numpy as np
import sympy as sp
from numpy.typing import NDArray

from duhem.expression.numpy_ import Program, compiled
from duhem.law.domain import REAL
from duhem.proof.facts.formula_subject import FormulaSubject
from duhem.proof.kernel.constant_value import exact_value
from duhem.proof.kernel.curvature import within_ranges
from duhem.proof.kernel.definedness import Reader, rarely_zero
from duhem.proof.kernel.domain import NEGATIVE, StatedDomain
from duhem.proof.kernel.identity import multiplied_out
from duhem.proof.kernel.stated_law import StatedLaw
from duhem.proof.kernel.term import NotWritten, Term, factors, number, product_of, sum_of
from duhem.proof.search.boundary_points import scouts
from duhem.proof.unsettled.ranges import others_at, places_in_ranges
from duhem.proof.unsettled.term_text import Names, in_text

__all__ = ["holds_a_place", "keeps_k", "named_around", "same_points", "short", "split", "times", "with_values", "with_values_at_rest"]

_MOST = 4  # parts in one formula, and ways to choose each
_CHOICES, _DRAWN, _MOVES = 2, 24, 30  # of parameters; of places, and around each; to a zero of a size
_NEAR, _TINY, _SAME, _ROUNDING = 1e-6, 1e-11, 1e-3, 1e-9
_SCALES = (0.9, 0.99, 0.999, 1.001, 1.01, 1.1)  # times points of the boundary
_ZERO, _ONE = number(0), number(1)
_OF_DEGREE_ONE = ("abs", "norm", "pos", "neg", "max", "min")  # of what is multiplied by a size they are multiplied by it


def with_values(read: StatedLaw, names: Names) -> Iterator[tuple[str, Term]]:
    """What to write, and g then: 0 for parts without a value, from the smallest to the largest, in g and in g times what it divides by.

    At last it is so at zero force alone: K may end where other loads are 0.
    """
    domain, seen = within_ranges(read), {read.g}
    if Reader(domain).undecided(read.g) is None:
        return
    _, size, power = (tip := _tip(read.g, domain)) or (read.g, _ONE, _ZERO)
    products = () if read.viscous else (times(read.g, size, power, domain),)  # of a potential a multiple is another law
    starts = (read.g, *products) if tip else ()
    ways: list[tuple[Term, Callable[[Term], tuple[Term, ...] | None]]] = [(start, partial(_tip, domain=domain)) for start in starts]
    ways.append((read.g, partial(_none_at_zero, domain=domain)))
    for (start, find), rank, first in product(ways, range(_MOST), (0, _MOST)):  # of the first part the smallest, or of all parts alike
        g, put = start, dict[Term, Term]()
        while (found := find(g)) is not None and len(put) < _MOST:
            above = _above(start, found[0], names)
            x = above[min(rank, len(above) - 1, rank if put else first)]
            limit = Term("where", (Term(">", (found[1], _ZERO)), x, _ZERO))
            if (changed := g.put({x: limit})) == g or any(x in own.parts() or own in x.parts() for own in put.values()):
                g = read.g  # what is put in has that part again, or stands in it
                break
            g, put[x] = changed, limit
        if g not in seen:
            seen.add(g)
            told = " and ".join(f"{in_text(limit, names)} for {in_text(x, names)}" for x, limit in put.items()) + ", if you mean 0 there"
            whole = f"{in_text(g, names)} for g, which is {in_text(_raised(size, power), names)} times g"
            yield f"write {told if start is read.g else whole}", g


def with_values_at_rest(read: StatedLaw, names: Names) -> tuple[str, dict[str, str]] | None:
    """What to write, and the forces as functions of the rates then: 0 where a size of rates that they divide by is 0; None without one."""
    domain, written, told = within_ranges(read), dict[str, str](), dict[str, list[str]]()
    driven = {f"{name}_rate": own.force for name, own in read.variables if own.force and own.kind == "internal"}
    for rate, own in zip(read.forces, read.flow or (), strict=True):
        force, tip = driven[rate], _tip(own, domain)
        limit = own if tip is None else Term("where", (Term(">", (tip[1], _ZERO)), own, _ZERO))
        written[force] = in_text(limit, {})
        if tip is not None:
            told.setdefault(in_text(tip[1], names), []).append(force)
    ways = (f"where({size} > 0, F, 0) for the formula F of {' and of '.join(forces)}" for size, forces in told.items())
    return (f"write {', and '.join(ways)}, if you mean 0 there", written) if told else None


def _none_at_zero(g: Term, domain: StatedDomain) -> tuple[Term, Term] | None:
    """A part of a formula, as it is written, that is not shown to have a value at zero force, and the size of all forces."""
    forces = tuple(Term("name", name=force) for force in domain.law.forces)
    zero = dict.fromkeys(forces, _ZERO)
    part = Reader(domain).undecided(g.put(zero))
    own = (x for x in g.parts() if x.put(zero) == part and not domain.constant(x))
    return next(((x, Term("norm", forces)) for x in own), None)


def _tip(g: Term, domain: StatedDomain) -> tuple[Term, Term, Term] | None:
    """A part without a value, what is 0 there and else > 0, and the power of it that divides; None where that is not seen."""
    if (part := Reader(domain).undecided(g)) is None or part.op not in ("**", "log", "atan2"):
        return None
    size, power = (Term("norm", part.args) if part.op == "atan2" else part), Fraction(1)
    while size.op in ("**", "log"):
        power *= abs(size.args[1].value) if size.op == "**" else 1
        size = size.args[0]
    loads = [x for x in factors(size) if not x.names() or not domain.constant(x)]
    if not loads:
        return None
    size = loads[0] if len(loads) == 1 else size if len(loads) == len(factors(size)) else Term("*", tuple(loads))
    if domain.facts(size).sign & NEGATIVE or not rarely_zero(size, domain):
        return None
    risen = (x.args[1] for x in g.parts() if x.op == "**" and x.args[1].op != "number" and part in x.args[0].parts())
    return part, size, next(risen, number(power or 1))


def _above(g: Term, part: Term, names: Names) -> list[Term]:
    """Parts that hold a part: those that have a name, then the product that it stands in, then the term of the sum; the smallest first."""
    found = [x for x in g.parts() if x != part and part in x.parts()]
    whole = [x for x in found if x.op == "*"]
    return [*named_around(g, part, names), *whole[:1], *whole[-1:], *found[:1]] or [part]


def named_around(g: Term, part: Term, names: Names) -> list[Term]:
    """Parts with a name that hold a part, the smallest first; of the words of a tensor those that the law writes, not what is in them."""
    found = [x for x in g.parts() if x != part and part in x.parts() and isinstance(names.get(x), str)]
    words = [x for x in found if "(" in str(names[x])]
    return [x for x in found if x not in words or x in g.put({y: _ZERO for y in words if y != x and x in y.parts()}).parts()]


def times(term: Term, size: Term, power: Term, domain: StatedDomain) -> Term:
    """A formula times a power of a size, powers of which are put together in each term, by which it may divide."""
    if term.op == "+":
        return sum_of(*(times(a, size, power, domain) for a in term.args if a != _ZERO))
    if term.op == "**" and term.args[1] == power and power.op != "number":
        return Term("**", (times(term.args[0], size, _ONE, domain), power))
    rest, own = split(term, size, domain)
    if term.op in _OF_DEGREE_ONE and _divides(term, size, domain) and not domain.facts(size).sign & NEGATIVE:
        return term._replace(args=tuple(times(a, size, power, domain) for a in term.args))
    for x in rest:
        if x != term and x.op in ("+", "**", *_OF_DEGREE_ONE) and _divides(x, size, domain):
            outer = [] if own == _ZERO else [_raised(size, own)]
            return product_of(*(times(y, size, power, domain) if y is x else y for y in rest), *outer)
    left = short(multiplied_out(sum_of(own, power), domain))
    return product_of(*rest, *([] if left == _ZERO else [_raised(size, left)]))


def _divides(term: Term, size: Term, domain: StatedDomain) -> bool:
    """Whether a part of a term is divided by a size."""
    return any(e.op == "number" and e.value < 0 for x in term.parts() for e in split(x, size, domain)[1:])


def _raised(size: Term, power: Term) -> Term:
    return size if power == _ONE else Term("**", (size, power))


def split(term: Term, size: Term, domain: StatedDomain) -> tuple[list[Term], Term]:
    """The factors of a term but for powers of a size, and the power of that."""
    if factors(term) == factors(size):
        return [], _ONE
    if term.op == "**" and domain.constant(term.args[1]):
        rest, own = split(term.args[0], size, domain)
        if own != _ZERO:
            power = short(multiplied_out(product_of(own, term.args[1]), domain))
            return [Term("**", (product_of(*rest), term.args[1]))] if rest else [], power
    if term.op == "*":
        parts = [split(a, size, domain) for a in term.args]
        return [x for rest, _ in parts for x in rest], short(multiplied_out(sum_of(*(own for _, own in parts)), domain))
    return ([] if term == _ONE else [term]), _ZERO


def short(constant: Term) -> Term:
    """A fraction where it is one."""
    with suppress(NotWritten):
        return constant if constant.names() else number(exact_value(constant))
    return constant


@np.errstate(all="ignore")  # where a formula has no value it is nan, or infinite
def keeps_k(subject: FormulaSubject, g: str) -> bool:
    """Whether K seems to be as before where g has no value and a changed g has: one near those around, or of a sign found there."""
    old, new, low, high = _both(subject, g)
    law, rng, n = subject.law, np.random.default_rng(7), len(subject.law.forces)
    equal = np.outer((0.0, 1.0, -1.0, 30.0, -30.0), np.arange(n) < (3 if law.stress else n))
    drawn = rng.standard_normal((_DRAWN, n)) * (1 - np.eye(n)[np.arange(_DRAWN) % n])
    places = np.concatenate([equal, drawn, 30 * drawn])
    divisors = [compiled(x, law.symbols().values()) for x in _divisors(law.g) if x.free_symbols & set(law.force_symbols())]
    for parameters in islice(subject.choices(_CHOICES), _CHOICES):
        others = others_at(subject, parameters)
        at_zero = [z for divisor in divisors for z in _where_zero(divisor, drawn, others) if (low <= z).all() and (z <= high).all()]
        for z in (*(z for z in np.clip(places, low, high) if not np.isfinite(old(*z, *others))), *at_zero):
            here = float(new(*z, *others))
            around = np.clip(z + _NEAR * max(1.0, np.abs(z).max()) * np.concatenate([equal[:3], drawn]), low, high)
            near = old(*around.T, *others)
            near = near[near > -np.inf]  # K ends where g rises without end
            found = np.any(near <= 0) if here <= _ROUNDING else np.all(near > 0)
            if np.isfinite(here) and len(near) and not (found or np.all(np.abs(near - here) <= _SAME * (1 + abs(here)))):
                return False
    return True


@np.errstate(all="ignore")
def same_points(subject: FormulaSubject, g: str) -> int:
    """How many points lie in K, or outside, for g as it is and for a changed g; 0 where one lies in one K alone.

    Among the points are zero force and many of which some forces are 0.
    """
    old, new, low, high = _both(subject, g)
    drawn, seen = places_in_ranges(subject.law), 0
    for scout in scouts(subject, 2 * _CHOICES):
        near = [scale * scout.boundary for scale in _SCALES] if scout.boundary.shape[1] == len(low) else []
        points = np.clip(np.concatenate([drawn, *near]), low, high)
        one, two = (np.broadcast_to(run(*points.T, *others_at(subject, scout.parameters)), len(points)) for run in (old, new))
        sizes, far = np.sort(np.abs([one, two]), axis=0), 1 + np.abs(points).max(axis=1)
        clear = ~(sizes[0] <= _ROUNDING * far) | (sizes[1] > _SAME * far)  # both are close to 0 at the boundary
        if np.any((one <= 0)[clear] != (two <= 0)[clear]):
            return 0
        seen += int(clear.sum())
    return seen


@np.errstate(all="ignore")
def holds_a_place(subject: FormulaSubject) -> bool:
    """Whether g < 0 at a drawn place, for the first choice of parameters."""
    run, points = compiled(subject.law.g, subject.law.symbols().values()), places_in_ranges(subject.law)
    return any(np.any(run(*points.T, *others_at(subject, parameters)) < 0) for parameters in islice(subject.choices(1), 1))


def _both(subject: FormulaSubject, g: str) -> tuple[Program, Program, NDArray[np.float64], NDArray[np.float64]]:
    """g as it is and as it is changed, and the ends of the ranges of the forces."""
    law = subject.law
    old, new = (compiled(x.g, law.symbols().values()) for x in (law, replace(law, g=g, written="", surfaces=())))
    low, high = np.array([law.domain.get(name, REAL).ends for name in law.forces]).T
    return old, new, low, high


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
