"""Families of witnesses that floating point suggests over a cell: points, lines and dents, told exactly.  Nothing here is trusted."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from contextlib import suppress
from fractions import Fraction
from itertools import islice, product

import numpy as np
import sympy as sp

from duhem.proof.kernel.constant_value import exact_value
from duhem.proof.kernel.dents import FAMILIES, Dent, dents
from duhem.proof.kernel.polynomial import Polynomial, in_powers, written
from duhem.proof.kernel.signs import RAY, RealRoot
from duhem.proof.kernel.stated_law import StatedLaw
from duhem.proof.kernel.term import UNREADABLE, NotWritten, Term, factors, number, parse
from duhem.regions.chords import Family, Suggestion, along, chords
from duhem.regions.places import narrowed
from duhem.regions.seen import RAYS, Array, count, looked_at, polynomial_at, value_of

__all__ = ["suggestions"]

_FINE = 160  # binary digits of a place: a polynomial is reduced by that of its place, and its coefficients are long
_PLAIN = tuple(map(Fraction, ("0", "1", "-1", "1/2", "2")))  # components of the points that are tried
_FEW, _VERY_FAR = 4, 2.0**30  # lines, or chords
_STEPS = tuple(tuple(Fraction(k, n) for k in range(-n, n + 1)) for n in (8, 2))  # of components of two and of three forces


def suggestions(
    law: StatedLaw, whole: StatedLaw, claim: str, names: Sequence[str], away: Sequence[str] = (), ends: Sequence[RealRoot] = (),
    turning: Sequence[Fraction] = (), first: Sequence[Family] = (),
) -> Iterator[Suggestion]:  # fmt: skip
    """Families for a law over a cell, its other parameters fixed as they are not in the ``whole``; the most promising first.

    ``away`` are formulas of the parameters ``names`` that are >= 0 on the cell, ``ends`` the numbers at which a cell of one ends,
    ``turning`` those at which the claim holds, and ``first`` the families of chords with which the search begins.
    """
    if claim == "origin":
        yield Suggestion("evaluation", {})
    places = looked_at(law)
    if not count(places):
        return
    found: list[Iterator[Suggestion]] = [along(law, places, turning, first)]
    if claim == "dissipation" and law.flow is not None and {*names} <= {*whole.parameters}:
        found.append(_of_points(whole, names, away))
    if claim == "convexity" and not law.ranges:
        found.append(islice(_of_lines(law, places), _FEW))
    if claim in ("convexity", "normality"):
        found += [_of_dents(dents(law, family), places, ends) for family in FAMILIES]
    if claim == "convexity":
        found.append(islice(chords(law, places, turning), _FEW))
    for families in found:
        with suppress(*UNREADABLE):
            yield from families


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
                told = ((f, [part for part in (a, f"{b}*{words}") if part[0] != "0"]) for f, a, b in zip(law.forces, u, v, strict=True))
                yield Suggestion("point", {"point": {f: " + ".join(parts) for f, parts in told if parts}, "scale": scale})
                return


def _stands_alone(g: Term, name: str) -> bool:
    """Whether a name stands in a sum as a term of its own, with the factor -1, and nowhere else."""
    terms = [term for term in (g.args if g.op == "+" else ()) if name in term.names()]
    return len(terms) == 1 and terms[0].op == "*" and sorted(x.op for x in factors(terms[0])) == ["name", "number"]


def _of_lines(law: StatedLaw, places: Mapping[str, Array]) -> Iterator[Suggestion]:
    """Lines through a point outside K along which g is < 0 far away both ways, at all of the values that are looked at."""

    def along(way: Mapping[str, Fraction], scale: float) -> Array:
        return value_of(law.g, {**places, **{f: np.full(count(places), scale * float(way.get(f, 0))) for f in law.forces}})

    ways = list(_plain_ways(law.forces))
    if (found := next(((way, scale) for scale in (4, 64, 4096) for way in ways if np.all(along(way, scale) > 0)), None)) is not None:
        through = {f: str(found[1] * x) for f, x in found[0].items()}
        both = (way for way in ways if all(np.all(along(way, far) < 0) for far in (_VERY_FAR, -_VERY_FAR)))
        yield from (Suggestion("line", {"through": through, "along": {f: str(x) for f, x in way.items()}}) for way in both)


def _plain_ways(forces: Sequence[str]) -> Iterator[dict[str, Fraction]]:
    """Vectors along axes, of two or three forces others with short components too."""
    yield from ({f: Fraction(1)} for f in forces)
    if 1 < len(forces) <= len(_STEPS) + 1:
        for one in product(_STEPS[len(forces) - 2], repeat=len(forces)):
            if len([x for x in one if x]) > 1:
                yield {f: x for f, x in zip(forces, one, strict=True) if x}


def _of_dents(found: Iterable[Dent], places: Mapping[str, Array], ends: Sequence[RealRoot]) -> Iterator[Suggestion]:
    """The rays where a dent is < 0 at all of the values that are looked at."""
    for dent in found:
        with suppress(*UNREADABLE):
            for ray in dict.fromkeys(_rays(dent, places, ends)):
                at = np.full(count(places), float(ray.low + ray.high) / 2)
                if np.all(polynomial_at(dent.poly, {RAY.name: at, **places}) < 0):
                    yield Suggestion("dent", {"family": dent.family, "dent": dent.name, "at": ray.written()})


def _rays(dent: Dent, places: Mapping[str, Array], ends: Sequence[RealRoot]) -> Iterator[RealRoot]:
    """Where a dent is deepest near each end of the cell and in its middle, as short numbers, or as its double roots."""
    low, high = dent.between
    if dent.seam or low == high:
        yield RealRoot.of(low)
        return
    rays, size = np.linspace(float(low), float(high), RAYS), count(places)
    for i in dict.fromkeys((0, size - 1, size // 2)):
        depth = polynomial_at(dent.poly, {RAY.name: rays, **{n: np.full_like(rays, x[i]) for n, x in places.items()}})
        deepest = float(rays[int(np.nanargmin(depth))])
        close = (Fraction(deepest).limit_denominator(n) for n in (1, 2, 3, 4, 8, 16, 64))
        yield from (RealRoot.of(x) for x in close if abs(float(x) - deepest) < 0.02 and low <= x <= high)
        variable, *others = places
        yield from filter(None, (_double_root(dent.poly, variable, end.low, deepest) for end in ends if not others))


def _double_root(poly: Polynomial, variable: str, at: Fraction, near: float) -> RealRoot | None:
    """Where a dent begins: the multiple root that the polynomial has at the end of a cell, near a place; the pressure is -1 there."""
    with suppress(NotWritten):
        parts = [written(part) for part in in_powers(poly, RAY)]
        here = {Term("name", name=n): number(at if n == variable else -1) for part in parts for n in part.names()}
        whole = sp.Poly([sp.Rational(str(exact_value(part.put(here)))) for part in reversed(parts)], t := sp.Symbol("t"))
        for factor in (factor for factor, _ in sp.factor_list(whole)[1] if factor.degree() >= 2):
            plain = tuple(int(c) for c in reversed(sp.Poly(factor, t).clear_denoms(convert=True)[1].all_coeffs()))
            for root in np.roots(plain[::-1]):
                if abs(root.imag) < 1e-6 and abs(root.real - near) < 0.02:
                    x = Fraction(float(root.real))
                    if (found := narrowed(plain, x - Fraction(1, 2**24), x + Fraction(1, 2**24), _FINE)) is not None:
                        return found
    return None
