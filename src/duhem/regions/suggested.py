"""Families of witnesses that floating point suggests over a cell: points, lines and dents, told exactly.  Nothing here is trusted."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from contextlib import suppress
from fractions import Fraction
from itertools import combinations, islice, product
from typing import Any, NamedTuple

import numpy as np
import sympy as sp

from duhem.proof.kernel.constant_value import exact_value
from duhem.proof.kernel.curvature import over
from duhem.proof.kernel.dents import FAMILIES, Dent, dents
from duhem.proof.kernel.forms import by_forces
from duhem.proof.kernel.normal_form import normal
from duhem.proof.kernel.polynomial import Monomial, Polynomial, in_powers, number_in, times, total, written
from duhem.proof.kernel.real_root import RealRoot
from duhem.proof.kernel.signs import RAY
from duhem.proof.kernel.stated_law import StatedLaw
from duhem.proof.kernel.term import UNREADABLE, Term, factors, number, parse
from duhem.regions.numbers import closest_fractions, narrowed
from duhem.regions.seen import RAYS, Array, count, looked_at, polynomial_at, value_of

__all__ = ["Suggestion", "suggestions"]

_FINE = 160  # binary digits of a place: a polynomial is reduced by that of its place, and its coefficients are long
_PLAIN = tuple(map(Fraction, ("0", "1", "-1", "1/2", "2")))  # components of the points that are tried
_GRID = 8  # parts of a range
_FEW_POINTS = 3  # outside of K, through which lines are tried
_STEPS = tuple(tuple(Fraction(k, n) for k in range(-n, n + 1)) for n in (8, 2))  # of components of two and of three forces


class Suggestion(NamedTuple):
    """A rule that refutes, with its evidence."""

    rule: str
    evidence: Mapping[str, Any]


def suggestions(
    law: StatedLaw, whole: StatedLaw, claim: str, names: Sequence[str], away: Sequence[str] = (), ends: Sequence[RealRoot] = ()
) -> Iterator[Suggestion]:
    """Families for a law over a cell, its other parameters fixed as they are not in the ``whole``; the most promising first.

    ``away`` are formulas of the parameters ``names`` that are >= 0 on the cell, ``ends`` the numbers at which a cell of one ends.
    """
    if claim == "origin":
        yield Suggestion("evaluation", {})
    places = looked_at(law)
    if not count(places):
        return
    if claim == "dissipation" and law.flow is not None and {*names} <= {*whole.parameters}:
        with suppress(*UNREADABLE):
            yield from _of_points(whole, names, away)
    if claim == "convexity":
        for told in (_of_chords, _of_lines):
            with suppress(*UNREADABLE):
                yield from told(law, places)
    if claim in ("convexity", "normality"):
        for family in FAMILIES:
            with suppress(*UNREADABLE):
                yield from _of_dents(dents(law, family), places, ends)


def _of_points(law: StatedLaw, names: Sequence[str], away: Sequence[str]) -> Iterator[Suggestion]:
    """Points u + d v with plain u and v, d a formula that is >= 0 on the cell, where force . flow < 0; a parameter makes g = 0 there.

    That parameter stands in g as a term of its own, with the factor -1.
    """
    scale = next((n for n in law.parameters if n not in names and _stands_alone(law.g, n)), None)
    if scale is None or law.flow is None:
        return
    places = looked_at(law, names)
    size = count(places)
    places |= {n: np.ones(size) for n in law.parameters if n not in (*names, scale)}
    plain = {str(x): np.full(size, float(x)) for x in _PLAIN}
    starts = plain | {n: places[n] for n in names if len(law.forces) <= 2}
    for words in away:
        distance = value_of(parse(words), places)
        for u, v in product(product(starts, repeat=len(law.forces)), product(plain, repeat=len(law.forces))):
            forces = {f: starts[a] + plain[b] * distance for f, a, b in zip(law.forces, u, v, strict=True)}
            there = {**places, **forces, scale: np.zeros(size)}
            there[scale] = level = value_of(law.g, there)
            power = sum((forces[f] * value_of(d, there) for f, d in zip(law.forces, law.flow, strict=True)), np.zeros(size))
            if np.all(level > 0) and np.all(power < 0):
                parts = {
                    f: [*([a] if a != "0" else []), *([f"{b}*{words}"] if b != "0" else [])]
                    for f, a, b in zip(law.forces, u, v, strict=True)
                }
                yield Suggestion("point", {"point": {f: " + ".join(said) for f, said in parts.items() if said}, "scale": scale})
                return


def _stands_alone(g: Term, name: str) -> bool:
    """Whether a name stands in a sum as a term of its own, with the factor -1, and nowhere else."""
    terms = [term for term in (g.args if g.op == "+" else ()) if name in term.names()]
    return len(terms) == 1 and terms[0].op == "*" and sorted(x.op for x in factors(terms[0])) == ["name", "number"]


def _of_lines(law: StatedLaw, places: Mapping[str, Array]) -> Iterator[Suggestion]:
    """Lines through a point outside K along which a polynomial g falls both ways, at all of the values that are looked at."""
    domain = over(law)
    parts, size = by_forces(domain.polynomial(normal(law.g, domain, True)), domain), count(places)
    if any(x.op != "name" or n < 0 for moving in parts for x, n in moving):
        return
    degree = max(sum(n for _, n in moving) for moving in parts)
    top = written(total(*(times({moving: Fraction(1)}, part) for moving, part in parts.items() if sum(n for _, n in moving) == degree)))
    here = {**places, "": np.zeros(size)}

    def along(term: Term, way: Mapping[str, str], scale: float = 1.0) -> Array:
        return value_of(term, here | {f: scale * value_of(parse(way.get(f, "0")), here) for f in law.forces})

    points = list(_plain_ways(law.forces))
    outside = (_scaled(way, scale) for scale in (4, 64, 4096) for way in points if np.all(along(law.g, way, scale) > 0))
    throughs = list(islice(outside, _FEW_POINTS)) if degree % 2 == 0 else []
    for way in points if throughs else ():
        if np.all(along(top, way) < 0):
            yield from (Suggestion("line", {"through": through, "along": way}) for through in throughs)


def _scaled(way: Mapping[str, str], scale: int) -> dict[str, str]:
    return {f: str(scale * Fraction(x)) for f, x in way.items()}


def _of_chords(law: StatedLaw, places: Mapping[str, Array]) -> Iterator[Suggestion]:
    """Chords of a grid over the ranges of one or two forces: their ends lie in K at all of the values, their midpoints at none."""
    ends = [own[:2] for f in law.forces for name, own in law.ranges if name == f]
    each = [[low + (high - low) * k / _GRID for k in range(_GRID + 1)] for low, high in ends if low is not None and high is not None]
    if len(each) != len(law.forces) or len(each) > 2:
        return
    points, size = dict(zip(product(range(_GRID + 1), repeat=len(each)), product(*each), strict=True)), count(places)

    def forces_at(place: tuple[int, ...]) -> dict[str, Fraction]:
        return dict(zip(law.forces, points[place], strict=True))

    values = {at: value_of(law.g, {**places, **{f: np.full(size, float(x)) for f, x in forces_at(at).items()}}) for at in points}
    inside, outside = [at for at, g in values.items() if np.all(g <= 0)], {at for at, g in values.items() if np.all(g > 0)}
    pairs = ((p, q, [a + b for a, b in zip(p, q, strict=True)]) for p, q in combinations(inside, 2))
    left = ((p, q) for p, q, twice in pairs if not any(a % 2 for a in twice) and tuple(a // 2 for a in twice) in outside)
    for chord in islice(left, _FEW_POINTS):
        told = {key: {f: str(x) for f, x in forces_at(end).items()} for key, end in zip("pq", chord, strict=True)}
        yield Suggestion("chord", {**told, **({} if law.pressure is None else {"pressure": "-1"})})


def _plain_ways(forces: Sequence[str]) -> Iterator[dict[str, str]]:
    """Vectors along axes, of two or three forces others with short components too."""
    yield from ({f: "1"} for f in forces)
    if 1 < len(forces) <= len(_STEPS) + 1:
        for one in product(_STEPS[len(forces) - 2], repeat=len(forces)):
            if len([x for x in one if x]) > 1:
                yield {f: str(x) for f, x in zip(forces, one, strict=True) if x}


def _of_dents(found: Iterable[Dent], places: Mapping[str, Array], ends: Sequence[RealRoot]) -> Iterator[Suggestion]:
    """The rays where a dent is < 0 at all of the values that are looked at."""
    for dent in found:
        with suppress(*UNREADABLE):
            for ray in _rays(dent, places, ends):
                at = np.full(count(places), float(ray.low + ray.high) / 2)
                if np.all(polynomial_at(dent.poly, {RAY.name: at, **places}) < 0):
                    yield Suggestion("dent", {"family": dent.family, "dent": dent.name, "at": ray.written()})


def _rays(dent: Dent, places: Mapping[str, Array], ends: Sequence[RealRoot]) -> Iterator[RealRoot]:
    """Where a dent is deepest near each end of the cell and in its middle, as short numbers, or as its double roots."""
    low, high = dent.between
    if dent.seam or low == high:
        yield RealRoot.of(low)
        return
    rays = np.linspace(float(low), float(high), RAYS)
    seen, size = set[RealRoot](), count(places)
    for i in dict.fromkeys((0, size - 1, size // 2)):
        depth = polynomial_at(dent.poly, {RAY.name: rays, **{n: np.full_like(rays, x[i]) for n, x in places.items()}})
        deepest = float(rays[int(np.nanargmin(depth))])
        for x in closest_fractions(deepest):
            if abs(float(x) - deepest) < 0.02 and low <= x <= high and (ray := RealRoot.of(x)) not in seen:
                seen.add(ray)
                yield ray
        for end in ends if len(places) == 1 else ():
            if (root := _double_root(dent.poly, next(iter(places)), end.low, deepest)) is not None and root not in seen:
                seen.add(root)
                yield root


def _double_root(poly: Polynomial, variable: str, at: Fraction, near: float) -> RealRoot | None:
    """Where a dent begins: the multiple root that the polynomial has at the end of a cell, near a place."""
    t = sp.Symbol("t")
    coefficients = [number_in(_at_number(part, variable, at)) for part in in_powers(poly, RAY)]
    if any(c is None for c in coefficients) or not any(coefficients):
        return None
    whole = sp.Poly([sp.Rational(c.numerator, c.denominator) for c in reversed(coefficients) if c is not None], t, domain="QQ")
    for factor, _ in sp.factor_list(whole)[1]:
        if factor.degree() < 2:
            continue
        plain = [int(c) for c in reversed(sp.Poly(factor, t).clear_denoms(convert=True)[1].all_coeffs())]
        for root in np.roots(plain[::-1]):
            if abs(root.imag) < 1e-6 and abs(root.real - near) < 0.02:
                x = Fraction(float(root.real))
                if (found := narrowed(tuple(plain), x - Fraction(1, 2**24), x + Fraction(1, 2**24), _FINE)) is not None:
                    return found
    return None


def _at_number(poly: Polynomial, variable: str, at: Fraction) -> Polynomial:
    """With a number for the parameter, and -1 for the pressure."""
    found: Polynomial = {}
    for m, c in poly.items():
        rest: Monomial = ()
        for x, n in m:
            others = x.names() - {variable}
            if x == RAY or len(others) > 1 or (others and variable in x.names()):
                rest = (*rest, (x, n))
            else:
                swap = {Term("name", name=variable): number(at), **{Term("name", name=other): number(-1) for other in others}}
                c *= exact_value(x.put(swap)) ** n
        found[rest] = found.get(rest, Fraction(0)) + c
    return {m: c for m, c in found.items() if c}
