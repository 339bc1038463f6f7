"""Homogeneous functions of the ordered principal values of a deviator, by their shape in the sector of the plane where these lie.

With X = s1 and s2, s3 = -X/2 +- d, 0 <= d <= 3 X/2, F of degree k is X^k p(d/X).  F^(1/k) is convex where (p^(1/k))'' >= 0 in the sector
and no kink at its walls turns inward: p'(0) >= 0 and p(3/2) >= (2/k) p'(3/2).  p = U/V, polynomials in d and square roots.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field
from typing import Any, NamedTuple

import sympy as sp

from duhem.expression import EigMax, Where
from tests.oracles.prover.section import Asked, Meaning

__all__ = ["Ordered", "Sector", "sectors"]

_D = sp.Symbol("half of the others' gap", real=True)  # no name of a law has blanks
_X = sp.Symbol("greatest deviator", positive=True)
_C = sp.Symbol("cos 3 theta", real=True)
_FAR = sp.Rational(3, 2)
_SECOND, _THIRD = sp.Rational(3, 4) + _D**2, sp.Rational(1, 4) - _D**2
_COS3 = 3 * sp.sqrt(3) / 2 * _THIRD * _SECOND ** sp.Rational(-3, 2)


class Ordered(NamedTuple):
    """X^degree p(d/X)."""

    degree: sp.Expr
    p: sp.Expr

    def shape(self, ask: Asked, opened: tuple[sp.Basic, ...]) -> tuple[bool, bool]:
        """Whether F^(1/degree) is convex, and F >= 0; ``opened`` leaves out ends of parameters' ranges, of which F is the limit."""
        k, roots = self.degree, dict[sp.Symbol, sp.Expr]()
        over, under = sp.fraction(sp.together(_rooted(self.p, roots)))
        u, v = (_Rooted(sp.expand(x), roots) for x in (over, under))
        if any(not x.expr.is_polynomial(_D, *roots) for x in (u, v)) or any(not q.is_polynomial(_D) for q in roots.values()):
            return False, False
        if not all(_within(ask, q) for q in roots.values()) or not v.above(ask, strict=True):
            return False, False
        above = u.above(ask)
        if not all(_within(ask, q, *opened, strict=True) for q in roots.values()) or (k != 1 and not u.above(ask, strict=True)):
            return False, above
        m = u.slope().times(v).plus(u.times(v.slope()), -1)
        bend = m.slope().times(v).plus(m.times(v.slope()), -2)
        if k != 1:
            bend = u.times(bend).plus(m.times(m), 1 / k - 1)
        near, far = m.at(0, ask), u.times(v).plus(m, -2 / k).at(_FAR, ask)
        return bend.above(ask, opened) and near.above(ask, opened) and far.above(ask, opened), above


@dataclass(frozen=True)
class _Rooted:
    """A polynomial in d and roots w = sqrt(q), perhaps with negative powers of these."""

    expr: sp.Expr
    roots: Mapping[sp.Symbol, sp.Expr]

    def times(self, other: _Rooted) -> _Rooted:
        return _Rooted(self._lowered(self.expr * other.expr), self.roots)

    def plus(self, other: _Rooted, scale: Any = 1) -> _Rooted:
        return _Rooted(self._lowered(self.expr + scale * other.expr), self.roots)

    def slope(self) -> _Rooted:
        inner = (sp.diff(self.expr, w) * sp.diff(q, _D) / (2 * w) for w, q in self.roots.items())
        return _Rooted(self._lowered(sp.diff(self.expr, _D) + sp.Add(*inner)), self.roots)

    def _lowered(self, expr: sp.Expr) -> sp.Expr:
        """With w^2 = q."""
        expr = sp.expand(expr)
        for w, q in self.roots.items():
            parts = sp.collect(expr, w, evaluate=False)
            expr = sp.expand(sp.Add(*(c * _power(x, w, q) for x, c in parts.items())))
        return expr

    def at(self, place: Any, ask: Asked) -> _Rooted:
        cleared, found = self.cleared(), dict[sp.Expr, sp.Expr]()
        for w, q in self.roots.items():
            root = sp.sqrt(sp.factor(q.subs(_D, place)))
            found[w] = root.replace(sp.Abs, lambda x: x if ask(x) else -x if ask(-x) else sp.Abs(x))
        return _Rooted(sp.expand(cleared.subs(_D, place).xreplace(found)), {})

    def cleared(self) -> sp.Expr:
        """A positive multiple without negative powers of roots."""
        expr = sp.expand(self.expr)
        for w in self.roots:
            least = min(t.as_powers_dict()[w] for t in sp.Add.make_args(expr))
            expr = sp.expand(expr * w**-least) if least < 0 else expr
        return self._lowered(expr)

    def above(self, ask: Asked, given: tuple[sp.Basic, ...] = (), strict: bool = False) -> bool:
        """Whether each part, by products of roots, is >= 0; all of them not 0 at once if ``strict``."""
        form = sp.Poly(self.cleared(), *self.roots) if self.roots else None
        parts = dict(form.terms()) if form is not None else {(): self.cleared()}
        if not all(_within(ask, part, *given) for part in parts.values()):
            return False
        squares = sp.Add(*(c**2 * sp.Mul(*(q**n for n, q in zip(m, self.roots.values(), strict=True))) for m, c in parts.items()))
        return not strict or _within(ask, squares, *given, strict=True)


def _power(x: sp.Expr, w: sp.Symbol, q: sp.Expr) -> sp.Expr:
    n = x.as_powers_dict()[w]
    return q ** (n // 2) * w ** (n % 2) if n > 1 else x


def _within(ask: Asked, expr: sp.Expr, *given: sp.Basic, strict: bool = False) -> bool:
    expr = sp.expand(expr)
    if not expr.has(_D):
        return ask(expr, *given, strict=strict)
    return ask(expr, sp.GreaterThan(_D, 0), sp.GreaterThan(_FAR - _D, 0), *given, strict=strict)


def _rooted(expr: Any, roots: dict[sp.Symbol, sp.Expr]) -> Any:
    """With symbols for square roots of what has d in it."""
    if not expr.has(_D) or not expr.args:
        return expr
    args = [_rooted(a, roots) for a in expr.args]
    if expr.is_Pow and expr.exp.is_Rational and expr.exp.q == 2:
        over, under = (sp.expand(x) for x in sp.fraction(sp.together(args[0])))
        return _root(over, roots) ** (2 * expr.exp) * _root(under, roots) ** (-2 * expr.exp)
    return expr.func(*args)


def _root(square: sp.Expr, roots: dict[sp.Symbol, sp.Expr]) -> sp.Expr:
    if not square.has(_D):
        return sp.sqrt(square)
    for w, q in roots.items():
        if square == w**2:
            return w
        if (share := sp.cancel(square / q)).is_number and share.is_positive:
            return sp.sqrt(share) * w
    w = sp.Dummy("root", positive=True)
    roots[w] = square
    return w


@dataclass(frozen=True)
class Sector:
    """A tensor, and the terms that are its greatest or least principal value."""

    meaning: Meaning
    free: Mapping[sp.Expr, sp.Expr]
    known: dict[sp.Expr, Ordered | None] = field(default_factory=dict, compare=False, repr=False)

    def read(self, expr: sp.Expr) -> Ordered | None:
        """The expression as such a function; None where it is none."""
        if expr not in self.known:
            self.known[expr] = self._read(expr.xreplace(self.free))
        return self.known[expr]

    def _read(self, expr: Any) -> Ordered | None:
        own = {*self.meaning.forces, _X, _D}
        if not expr.free_symbols & own:
            return Ordered(sp.S.Zero, expr)
        if expr.is_polynomial(*own):
            return self._polynomial(expr)
        if isinstance(expr, Where):
            return self._choice(*expr.args)
        if isinstance(expr, sp.cos):
            return self._cosine(expr.args[0])
        if expr.is_Mul or expr.is_Add:
            plain, others = sp.sift(expr.args, lambda a: bool(a.is_polynomial(*own)), binary=True)
            read = [self._read(a) for a in ((expr.func(*plain), *others) if plain else others)]
            known = [r for r in read if r is not None]
            if len(known) < len(read) or (expr.is_Add and len({r.degree for r in known}) > 1):
                return None
            degree = sum(r.degree for r in known) if expr.is_Mul else known[0].degree
            return Ordered(degree, expr.func(*(r.p for r in known)))
        if expr.is_Pow and not expr.exp.free_symbols & own:
            base = self._read(expr.base)
            return None if base is None else Ordered(base.degree * expr.exp, base.p**expr.exp)
        return None

    def _polynomial(self, expr: sp.Expr) -> Ordered | None:
        found, degrees = sp.S.Zero, set[sp.Expr]()
        for (i, j), part in sp.Poly(expr, _X, _D).terms():
            section = self.meaning.read(sp.expand(part))
            if section is None:
                return None
            degrees.add(section.degree + i + j)
            p = sp.expand(_SECOND ** (section.degree / 2) * section.f.subs(_C, _COS3))
            found += sp.expand(sp.simplify(p)) * _D**j
        return Ordered(degrees.pop(), sp.expand(found)) if len(degrees) == 1 else None

    def _cosine(self, angle: sp.Expr) -> Ordered | None:
        third, inverse = angle.as_coeff_Mul()
        if abs(third) != sp.Rational(1, 3) or not isinstance(inverse, sp.acos) or (c := self._read(inverse.args[0])) is None:
            return None
        if c.degree != 0 or sp.simplify(c.p - _COS3) != 0:
            return None
        return Ordered(sp.S.Zero, sp.sqrt(3) / 2 / sp.sqrt(_SECOND))

    def _choice(self, condition: Any, away: sp.Expr, here: sp.Expr) -> Ordered | None:
        """What is chosen where J2 > 0, if the rest is 0."""
        if isinstance(condition, sp.StrictLessThan | sp.LessThan):
            size = condition.rhs - condition.lhs
        elif isinstance(condition, sp.StrictGreaterThan | sp.GreaterThan):
            size = condition.lhs - condition.rhs
        else:
            return None
        if isinstance(condition, sp.LessThan | sp.GreaterThan):
            size, away, here = -size, here, away
        found = self._read(sp.expand(size))
        value = self._read(away)
        share = None if found is None or found.degree != 2 else sp.cancel(found.p / _SECOND)
        if here != 0 or value is None or share is None or not share.is_number or not share.is_positive:
            return None
        return value if value.degree.is_positive else None


def sectors(expr: sp.Expr, forces: tuple[sp.Symbol, ...], meaning: Meaning | None, linear: Callable[[sp.Expr], bool]) -> Iterator[Sector]:
    """Those of the tensors whose greatest or least principal value stands in a formula; else of that which the forces are."""
    parts = sorted((e for e in expr.atoms(EigMax, sp.Max, sp.Min) if e.free_symbols & {*forces}), key=sp.default_sort_key)
    parts = [e for e in parts if (isinstance(e, EigMax) or len(e.args) == 3) and all(map(linear, e.args))]
    known = dict[sp.Expr, Sector]()
    for part in parts:
        if part not in known:
            sector = Sector(_meaning(part, forces), {e: v for e in parts if (v := _value(e, part)) is not None})
            known |= dict.fromkeys(sector.free, sector)
            yield sector
    if not parts and meaning is not None:
        yield Sector(meaning, {})


def _meaning(part: sp.Expr, forces: tuple[sp.Symbol, ...]) -> Meaning:
    x, y, z, *shear = part.args
    yz, zx, xy = shear or (sp.S.Zero,) * 3
    mean = (x + y + z) / 3
    s = sp.Matrix([[x - mean, xy, zx], [xy, y - mean, yz], [zx, yz, z - mean]])
    return Meaning(forces, sp.expand((s * s).trace() / 2), sp.expand(s.det()))


def _value(part: sp.Expr, told: sp.Expr) -> sp.Expr | None:
    """A greatest or least principal value by the mean, X and d of the tensor that another is of."""
    mean = sp.Add(*told.args[:3]) / 3
    for sense in (1, -1):
        if _entries(part, sense) == _entries(told, 1):
            greatest = isinstance(part, sp.Min) is (sense < 0)
            return sense * (mean + (_X if greatest else -_X / 2 - _D))
    return None


def _entries(part: sp.Expr, sense: int) -> tuple[Any, ...]:
    entries = [sp.expand(sense * a) for a in part.args]
    return ("matrix", *entries) if isinstance(part, EigMax) else ("loads", *sorted(entries, key=sp.default_sort_key))
