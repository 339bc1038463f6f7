"""Families of witnesses that floating point suggests: where a dent is deepest on a cell, as an exact place.  Nothing here is trusted."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from contextlib import suppress
from fractions import Fraction
from itertools import chain, islice, pairwise, product
from typing import Any, NamedTuple

import numpy as np
import sympy as sp
from numpy.typing import NDArray

from duhem.proof.kernel.bounds import Bounds
from duhem.proof.kernel.constant_value import exact_value
from duhem.proof.kernel.curvature import over
from duhem.proof.kernel.dents import Dent, dents
from duhem.proof.kernel.domain import StatedLaw, gap
from duhem.proof.kernel.forms import by_forces, quadratic
from duhem.proof.kernel.polynomial import Monomial, Polynomial, in_powers, number_in, times, total, written
from duhem.proof.kernel.real_root import RealRoot
from duhem.proof.kernel.signs import RAY
from duhem.proof.kernel.term import COMPARISONS, UNREADABLE, NotWritten, Term, factors, number, parse
from duhem.regions.boundaries import falling_directions
from duhem.regions.numbers import closest_fractions, narrowed

__all__ = ["Array", "Holding", "Suggestion", "changes", "looked_at", "suggestions", "value_of"]

Array = NDArray[np.float64]
_RAYS, _PLACES, _SAMPLES, _ZERO = 721, 9, 97, 1e-11
_FINE = 160  # binary digits of a place: a polynomial is reduced by that of its place, and its coefficients are long
_PLAIN = tuple(map(Fraction, ("0", "1", "-1", "1/2", "2")))  # components of the points that are tried
_FEW_POINTS = 3  # outside of K, through which lines are tried
_MOST_PLACES = 30  # of several parameters
_STEPS = tuple(tuple(Fraction(k, n) for k in range(-n, n + 1)) for n in (8, 2))  # of components of two and of three forces
_AT_END = 2.0**-20  # how near to an end of a cell it is looked, as a share


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
    if not _count(places):
        return
    if claim == "dissipation" and law.flow is not None and {*names} <= {*whole.parameters}:
        with suppress(*UNREADABLE):
            yield from _of_points(whole, names, away)
    if claim == "convexity":
        with suppress(*UNREADABLE):
            yield from _of_lines(law, places)
    if claim in ("convexity", "normality"):
        for family in ("sector", "gauge"):
            with suppress(*UNREADABLE):
                yield from _of_dents(list(dents(law, family)), places, ends)


def _of_points(law: StatedLaw, names: Sequence[str], away: Sequence[str]) -> Iterator[Suggestion]:
    """Points u + d v with plain u and v, d a formula that is >= 0 on the cell, where force . flow < 0; a parameter makes g = 0 there.

    That parameter stands in g as a term of its own, with the factor -1.
    """
    scale = next((n for n in law.parameters if n not in names and _stands_alone(law.g, n)), None)
    if scale is None or law.flow is None:
        return
    places = looked_at(law, names)
    size = _count(places)
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
    parts, size = by_forces(over(law).polynomial(law.g), over(law)), _count(places)
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
    axes, exact = len(law.forces), falling_directions(law) if degree == 2 else ()
    tried = list[dict[str, str]]()
    for way in chain(points[:axes], exact, _of_eigenvectors(law, here), points[axes:]) if throughs else ():
        if way not in tried and np.all(along(top, way) < 0):
            tried.append(way)
            yield from (Suggestion("line", {"through": through, "along": way}) for through in throughs)


def _scaled(way: Mapping[str, str], scale: int) -> dict[str, str]:
    return {f: str(scale * Fraction(x)) for f, x in way.items()}


def _plain_ways(forces: Sequence[str]) -> Iterator[dict[str, str]]:
    """Vectors along axes, of two or three forces others with short components too."""
    yield from ({f: "1"} for f in forces)
    if 1 < len(forces) <= len(_STEPS) + 1:
        for one in product(_STEPS[len(forces) - 2], repeat=len(forces)):
            if len([x for x in one if x]) > 1:
                yield {f: str(x) for f, x in zip(forces, one, strict=True) if x}


def _of_eigenvectors(law: StatedLaw, here: Mapping[str, Array]) -> Iterator[dict[str, str]]:
    """Along which a quadratic g falls most at some of the values."""
    with suppress(NotWritten):
        many = _forms(quadratic(law.g, law.forces, over(law))[0], here)
        for form in (many[0], many[-1], many[len(many) // 2]):
            way = np.linalg.eigh(form)[1][:, 0]
            short = (Fraction(float(x)).limit_denominator(8) for x in way / np.max(np.abs(way)))
            yield {f: str(x) for f, x in zip(law.forces, short, strict=True) if x}


def _of_dents(found: list[Dent], places: Mapping[str, Array], ends: Sequence[RealRoot]) -> Iterator[Suggestion]:
    """The rays where a dent is < 0 at all of the values that are looked at."""
    for dent in found:
        with suppress(*UNREADABLE):
            for ray in _rays(dent, places, ends):
                at = np.full(_count(places), float(ray.low + ray.high) / 2)
                if np.all(_value(dent.poly, {RAY.name: at, **places}) < 0):
                    yield Suggestion("dent", {"family": dent.family, "dent": dent.name, "at": ray.written()})


def looked_at(law: StatedLaw, names: Iterable[str] | None = None) -> dict[str, Array]:
    """Values of the parameters that are free, near their ends and between them, as far as the constraints on these alone allow them."""
    free = [n for n, own in law.parameters.items() if not own.single and (names is None or n in names)]
    shares = [_AT_END, 2.0**-10, *np.linspace(0.05, 0.95, _PLACES), 1 - 2.0**-10]
    if len(free) > 1:
        shares = [_AT_END, *np.linspace(0, 1, max(3, int(_MOST_PLACES ** (1 / len(free)))))[1:-1]]
    each = [_in(own, [*shares, *([] if None in own[:2] else [1 - _AT_END])]) for own in map(law.parameters.__getitem__, free)]
    grid = np.array(list(product(*each))).reshape(-1, len(free))
    places = dict(zip(free, grid.T, strict=True)) if free else {}
    for c in law.constraints if len(free) > 1 else ():
        with suppress(ValueError):
            if c.names() <= {*free}:
                held = value_of(gap(c), places) > (-_ZERO if len(c.op) == 2 else _ZERO)
                places = {n: x[held] for n, x in places.items()}
    return places


def _count(places: Mapping[str, Array]) -> int:
    """How many there are: one of no parameter."""
    return len(next(iter(places.values()), [0.0]))


def _in(own: Bounds, shares: Sequence[float]) -> list[float]:
    """Values at shares of the way between two ends; after x/(1 + x) from the one end, or from 0 both ways."""
    low, high = (None if end is None else float(end) for end in own[:2])
    if low is not None and high is not None:
        return [low + (high - low) * s for s in shares]
    far = [s / (1 - s) for s in shares]
    if low is not None:
        return [low + x for x in far]
    down = [(0.0 if high is None else high) - x for x in reversed(far)]
    return down if high is not None else [*down, 0.0, *far]


def _rays(dent: Dent, places: Mapping[str, Array], ends: Sequence[RealRoot]) -> Iterator[RealRoot]:
    """Where a dent is deepest near each end of the cell and in its middle, as short numbers, or as its double roots."""
    low, high = dent.between
    if dent.seam or low == high:
        yield RealRoot.of(low)
        return
    rays = np.linspace(float(low), float(high), _RAYS)
    seen, size = set[RealRoot](), _count(places)
    for i in dict.fromkeys((0, size - 1, size // 2)):
        depth = _value(dent.poly, {RAY.name: rays, **{n: np.full_like(rays, x[i]) for n, x in places.items()}})
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


class Holding(NamedTuple):
    """Where the claim of a law seems to hold: by its dents, by the least eigenvalue of a quadratic g, or by g at zero force."""

    dents: tuple[Dent, ...]
    forms: tuple[tuple[Term, ...], ...]
    at_zero: Term | None = None

    @classmethod
    def of(cls, law: StatedLaw, claim: str) -> Holding | None:
        """None where that tells nothing."""
        if claim == "origin":
            at_zero = law.g.put({Term("name", name=f): number(0) for f in law.forces})
            with suppress(*UNREADABLE):
                value_of(at_zero, looked_at(law))
                return cls((), (), at_zero)
        if claim != "convexity":
            return None
        with suppress(*UNREADABLE):
            matrix = quadratic(law.g, law.forces, over(law))[0]
            return cls((), tuple(map(tuple, matrix)))
        found = _told_dents(law)
        return cls(tuple(found), ()) if found else None

    def margins(self, places: Mapping[str, Array]) -> Array:
        """By how much it seems to hold at some places, as a share of what is added up; < 0 where it seems to fail."""
        if self.at_zero is not None:
            return -value_of(self.at_zero, places)
        if self.forms:
            return _least_eigenvalues(self.forms, places)
        least = np.full(_count(places), np.inf)
        for dent in self.dents:
            rays = np.linspace(float(dent.between[0]), float(dent.between[1]), _RAYS // 4 if dent.between[1] > dent.between[0] else 1)
            at = {name: np.repeat(x, len(rays)) for name, x in places.items()} | {RAY.name: np.tile(rays, len(least))}
            least = np.minimum(least, _relative(dent.poly, at).reshape(len(least), -1).min(axis=1))
        return np.where(np.abs(least) <= _ZERO, 0.0, least)


def _least_eigenvalues(matrix: Sequence[Sequence[Term]], places: Mapping[str, Array]) -> Array:
    """Of a form in forces that are measured so that no square in it has another factor than 1, 0 or -1."""
    many = _forms(matrix, places)
    sizes = np.sqrt(np.abs(np.diagonal(many, axis1=1, axis2=2)))
    sizes[sizes == 0] = 1.0
    return np.asarray(np.linalg.eigvalsh(many / sizes[:, :, None] / sizes[:, None, :])[:, 0])


def _forms(matrix: Sequence[Sequence[Term]], places: Mapping[str, Array]) -> Array:
    return np.moveaxis(np.array([[value_of(a, places) for a in line] for line in matrix]), 2, 0)


def _told_dents(law: StatedLaw) -> list[Dent]:
    for family in ("sector", "gauge"):
        with suppress(*UNREADABLE):
            if found := list(dents(law, family)):
                return found
    return []


# -- where it changes --------------------------------------------------------------------------------------------------


def changes(law: StatedLaw, name: str) -> list[tuple[float, float, bool]] | None:
    """Stretches of the one parameter that is left, and whether the dents of the law are seen to be >= 0 there; None where none are told."""
    if not (found := _told_dents(law)):
        return None

    def round_at(x: float) -> bool:
        return all(_least(dent, name, x) >= -_ZERO for dent in found)

    try:
        places = _in(law.parameters[name], np.linspace(0, 1, _SAMPLES + 2)[1:-1].tolist())
        flags = [round_at(x) for x in places]
        stretches, start = list[tuple[float, float, bool]](), places[0]
        for (x, one), (y, two) in pairwise(zip(places, flags, strict=True)):
            if one != two:
                low, high = x, y
                while high - low > 1e-13 * max(1.0, abs(low)) and low < (middle := (low + high) / 2) < high:
                    low, high = (middle, high) if round_at(middle) == one else (low, middle)
                stretches.append((start, low, one))
                start = high
        return [*stretches, (start, places[-1], flags[-1])]
    except UNREADABLE:
        return None


def _least(dent: Dent, name: str, x: float) -> float:
    """The least value of a dent, as a share of the sizes that are added up."""
    low, high = map(float, dent.between)
    rays = np.linspace(low, high, _RAYS if high > low else 1)
    for _ in range(4 if high > low else 1):  # closer to where it is least
        at = {RAY.name: rays, name: np.full_like(rays, x)}
        seen = _relative(dent.poly, at)
        i = int(np.argmin(seen))
        step = (high - low) / (len(rays) - 1) if high > low else 0.0
        low, high = max(low, rays[i] - step), min(high, rays[i] + step)
        rays = np.linspace(low, high, 65 if high > low else 1)
    return float(np.min(seen))


# -- in floating point -------------------------------------------------------------------------------------------------


def _relative(poly: Polynomial, at: Mapping[str, Array]) -> Array:
    """A polynomial at many places, as a share of the sizes that are added up."""
    return _value(poly, at) / np.maximum(_value(poly, at, size=True), 1e-300)


def _value(poly: Polynomial, at: Mapping[str, Array], size: bool = False) -> Array:
    """A polynomial at many places, or the sum of the sizes of its terms; infinite where it has no value."""
    total = np.zeros(_count(at))
    with np.errstate(all="ignore"):
        for m, c in poly.items():
            part = np.full_like(total, float(c))
            for x, n in m:
                part = part * value_of(x, at) ** float(n)
            total = total + (np.abs(part) if size else part)
    return np.where(np.isnan(total), np.inf, total)


def value_of(term: Term, at: Mapping[str, Array]) -> Array:
    """A term at many places, not a number where it has no value; ValueError for a word that is not read here."""
    with np.errstate(all="ignore"):
        return _of(term, at)


def _of(term: Term, at: Mapping[str, Array]) -> Array:
    size = _count(at)
    if term.op == "number":
        return np.full(size, float(term.value))
    if term.op == "name":
        if term.name == "pi":
            return np.full(size, np.pi)
        if term.name not in at:
            return np.full(size, -1.0)  # the pressure
        return at[term.name]
    args = [_of(a, at) if a.op not in COMPARISONS else np.zeros(size) for a in term.args]
    match term.op:
        case "+":
            return sum(args, np.zeros(size))
        case "*":
            return np.prod(args, axis=0)
        case "**":
            return args[0] ** args[1]
        case "abs":
            return np.abs(args[0])
        case "norm":
            return np.sqrt(sum((a * a for a in args), np.zeros(size)))
        case "exp" | "log" | "sin" | "cos" | "tan" | "sinh" | "cosh" | "tanh":
            return np.asarray(getattr(np, term.op)(args[0]))
        case "asin" | "acos" | "atan":
            return np.asarray(getattr(np, f"arc{term.op[1:]}")(args[0]))
        case "where":
            one, two = (_of(side, at) for side in term.args[0].args)
            held = {"<": one < two, "<=": one <= two, ">": one > two, ">=": one >= two}[term.args[0].op]
            return np.where(held, args[1], args[2])
        case "max" | "min":
            return np.asarray(getattr(np, term.op)(args, axis=0))
    raise ValueError(f"{term.op} is not read here")
