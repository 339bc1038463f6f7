"""Families of witnesses that floating point suggests: where a dent is deepest on a cell, as an exact place.  Nothing here is trusted."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from contextlib import suppress
from fractions import Fraction
from itertools import pairwise, product
from typing import Any, NamedTuple

import numpy as np
import sympy as sp
from numpy.typing import NDArray

from duhem.proof.kernel.bounds import Bounds
from duhem.proof.kernel.constant_value import exact_value
from duhem.proof.kernel.curvature import over
from duhem.proof.kernel.dents import Dent, dents
from duhem.proof.kernel.domain import StatedLaw
from duhem.proof.kernel.forms import quadratic
from duhem.proof.kernel.parameter_cells import ParameterCell
from duhem.proof.kernel.polynomial import Monomial, Polynomial, in_powers, number_in
from duhem.proof.kernel.real_root import RealRoot
from duhem.proof.kernel.signs import RAY
from duhem.proof.kernel.term import COMPARISONS, UNREADABLE, Term, factors, number
from duhem.regions.numbers import closest_fractions, narrowed

__all__ = ["Suggestion", "changes", "suggestions"]

Array = NDArray[np.float64]
_RAYS, _PLACES, _SAMPLES, _ZERO = 721, 9, 97, 1e-11
_FINE = 160  # binary digits of a place: a polynomial is reduced by that of its place, and its coefficients are long
_PLAIN = tuple(map(Fraction, ("0", "1", "-1", "1/2", "2")))  # components of the points that are tried
_AT_END = 2.0**-20  # how near to an end of a cell it is looked, as a share


class Suggestion(NamedTuple):
    """A rule that refutes, with its evidence."""

    rule: str
    evidence: Mapping[str, Any]


def suggestions(
    law: StatedLaw, whole: StatedLaw, claim: str, name: str, cell: ParameterCell, swap: Mapping[Term, Term]
) -> Iterator[Suggestion]:
    """Families for a law over a cell, its other parameters fixed as they are not in the ``whole``; the most promising first."""
    if claim == "origin":
        yield Suggestion("evaluation", {})
    free = [n for n, own in law.parameters.items() if not own.single]
    if claim == "dissipation" and law.flow is not None:
        with suppress(*UNREADABLE):
            yield from _of_points(whole, name, cell)
    if claim == "convexity" and len(free) <= 1:
        with suppress(*UNREADABLE):
            yield from _of_forms(law, free[0] if free else name)
    if claim in ("convexity", "normality") and len(free) <= 1:
        for family in ("sector", "gauge"):
            with suppress(*UNREADABLE):
                yield from _of_dents(list(dents(law, family)), law, free[0] if free else name, cell, bool(swap))


def _of_points(law: StatedLaw, name: str, cell: ParameterCell) -> Iterator[Suggestion]:
    """Points u + d v with plain u and v, d the distance from an end of the cell, where force . flow < 0; a parameter makes g = 0 there.

    That parameter stands in g as a term of its own, with the factor -1.
    """
    scale = next((n for n in law.parameters if n != name and _stands_alone(law.g, n)), None)
    if scale is None or name not in law.parameters or law.flow is None:
        return
    values = np.array(_looked_at(law, name))
    others = {n: np.ones_like(values) for n in law.parameters if n not in (name, scale)}
    for end, way in ((cell.high, -1), (cell.low, 1)):
        at = Fraction(0) if end is None or not end.exact else end.low
        away, words = way * (values - float(at)), f"({name} - ({at}))" if way > 0 else f"({at} - {name})"
        for u, v in product(product(_PLAIN, repeat=len(law.forces)), repeat=2):
            forces = {f: float(a) + float(b) * away for f, a, b in zip(law.forces, u, v, strict=True)}
            there = {**others, name: values, **forces}
            size = _of(law.g, {**there, scale: np.zeros_like(values)})
            power = sum(
                (forces[f] * _of(d, there | {scale: size}) for f, d in zip(law.forces, law.flow, strict=True)), np.zeros_like(values)
            )
            if np.all(size > 0) and np.all(power < 0):
                parts = {f: [*([str(a)] if a else []), *([f"{b}*{words}"] if b else [])] for f, a, b in zip(law.forces, u, v, strict=True)}
                point = {f: " + ".join(said) for f, said in parts.items() if said}
                yield Suggestion("point", {"point": point, "scale": scale})
                return


def _stands_alone(g: Term, name: str) -> bool:
    """Whether a name stands in a sum as a term of its own, with the factor -1, and nowhere else."""
    terms = [term for term in (g.args if g.op == "+" else ()) if name in term.names()]
    return len(terms) == 1 and terms[0].op == "*" and sorted(x.op for x in factors(terms[0])) == ["name", "number"]


def _of_forms(law: StatedLaw, variable: str) -> Iterator[Suggestion]:
    """Lines through a point outside K along which a quadratic g falls, at all of the values that are looked at."""
    matrix, row, constant = quadratic(law.g, law.forces, over(law))
    values = _looked_at(law, variable)

    def number_at(term: Term, x: float) -> float:
        return float(_of(term, {variable: np.array([x])})[0])

    forms = [(np.array([[number_at(a, x) for a in line] for line in matrix]), np.array([number_at(b, x) for b in row]),
              number_at(constant, x)) for x in values]  # fmt: skip
    for form, _, _ in (forms[0], forms[-1], forms[len(forms) // 2]):
        sizes, axes = np.linalg.eigh(form)
        if sizes[0] >= 0:
            continue
        way, up = (_short(axes[:, k]) for k in (0, -1))
        if not all(way @ a @ way < 0 for a, _, _ in forms):
            continue
        for scale in (1.0, 4.0, 64.0, 4096.0):
            point = scale * up
            if all(point @ a @ point + b @ point + c > 0 for a, b, c in forms):
                told = ({f: str(Fraction(x).limit_denominator(64)) for f, x in zip(law.forces, v, strict=True) if x} for v in (point, way))
                yield Suggestion("line", dict(zip(("through", "along"), told, strict=True)))
                break


def _short(vector: Array) -> Array:
    """A direction with small fractions for components."""
    scaled = vector / np.max(np.abs(vector))
    return np.array([float(Fraction(float(x)).limit_denominator(8)) for x in scaled])


def _of_dents(found: list[Dent], law: StatedLaw, variable: str, cell: ParameterCell, by_share: bool) -> Iterator[Suggestion]:
    """The places where a dent is < 0 at all of the values of the variable that are looked at."""
    values = _looked_at(law, variable)
    for dent in found:
        with suppress(*UNREADABLE):
            for place in _places(dent, variable, values, cell, by_share):
                at = np.array([float(place.low + place.high) / 2])
                if all(_value(dent.poly, {RAY.name: at, variable: np.array([v])})[0] < 0 for v in values):
                    yield Suggestion("dent", {"family": dent.family, "dent": dent.name, "at": place.written()})


def _looked_at(law: StatedLaw, variable: str) -> list[float]:
    """Values of the one parameter that is left, near its ends and between them; none for a law without one."""
    if variable not in law.parameters:
        return [0.0]
    own = law.parameters[variable]
    return _in(own, [_AT_END, 2.0**-10, *np.linspace(0.05, 0.95, _PLACES), 1 - 2.0**-10, *([] if None in own[:2] else [1 - _AT_END])])


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


def _places(dent: Dent, variable: str, values: list[float], cell: ParameterCell, by_share: bool) -> Iterator[RealRoot]:
    """Where a dent is deepest near each end of the cell and in its middle, as short numbers, or as its double roots."""
    low, high = dent.between
    if dent.seam or low == high:
        yield RealRoot.of(low)
        return
    rays = np.linspace(float(low), float(high), _RAYS)
    seen = set[RealRoot]()
    for value in (values[0], values[-1], values[len(values) // 2]):
        depth = _value(dent.poly, {RAY.name: rays, variable: np.full_like(rays, value)})
        deepest = float(rays[int(np.nanargmin(depth))])
        for x in closest_fractions(deepest):
            if abs(float(x) - deepest) < 0.02 and low <= x <= high and (place := RealRoot.of(x)) not in seen:
                seen.add(place)
                yield place
        for end in () if by_share else (cell.low, cell.high):
            if (
                end is not None
                and end.exact
                and (root := _double_root(dent.poly, variable, end.low, deepest)) is not None
                and root not in seen
            ):
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


# -- where it changes --------------------------------------------------------------------------------------------------


def changes(law: StatedLaw, name: str) -> list[tuple[float, float, bool]] | None:
    """Stretches of the one parameter that is left, and whether the dents of the law are seen to be >= 0 there; None where none are told."""
    found = list[Dent]()
    for family in ("sector", "gauge"):
        with suppress(*UNREADABLE):
            found = found or list(dents(law, family))
    if not found:
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
        seen = _value(dent.poly, at) / np.maximum(_value(dent.poly, at, size=True), 1e-300)
        i = int(np.argmin(seen))
        step = (high - low) / (len(rays) - 1) if high > low else 0.0
        low, high = max(low, rays[i] - step), min(high, rays[i] + step)
        rays = np.linspace(low, high, 65 if high > low else 1)
    return float(np.min(seen))


# -- in floating point -------------------------------------------------------------------------------------------------


def _value(poly: Polynomial, at: Mapping[str, Array], size: bool = False) -> Array:
    """A polynomial at many places, or the sum of the sizes of its terms; infinite where it has no value."""
    total = np.zeros(len(next(iter(at.values()))))
    with np.errstate(all="ignore"):
        for m, c in poly.items():
            part = np.full_like(total, float(c))
            for x, n in m:
                part = part * _of(x, at) ** float(n)
            total = total + (np.abs(part) if size else part)
    return np.where(np.isnan(total), np.inf, total)


def _of(term: Term, at: Mapping[str, Array]) -> Array:
    """A term at many places; ValueError for a word that is not read here."""
    size = len(next(iter(at.values())))
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
        case "where":
            one, two = (_of(side, at) for side in term.args[0].args)
            held = {"<": one < two, "<=": one <= two, ">": one > two, ">=": one >= two}[term.args[0].op]
            return np.where(held, args[1], args[2])
        case "max" | "min":
            return np.asarray(getattr(np, term.op)(args, axis=0))
    raise ValueError(f"{term.op} is not read here")
