"""Functions of J2 and J3 alone: rho^k f(c), rho = sqrt(J2), c = cos 3 theta, by their shape in the deviatoric plane.

rho f(cos 3 theta) is convex where f'' + f >= 0 in theta: 9 (1 - c^2) f'' - 9 c f' + f >= 0 for -1 <= c <= 1; symmetric in the
eigenvalues, it is a convex function of the tensor (Davis 1957).  For f = cos(b - acos(gamma c)/3) that is 0 <= b <= pi/3.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from itertools import permutations
from typing import Any, NamedTuple, Protocol

import sympy as sp

__all__ = ["Meaning", "Section", "meaning_of"]

_C = sp.Symbol("cos 3 theta", real=True)  # no name of a law has blanks
_W = sp.Symbol("J3", real=True)  # where J2 = 1
_HIGHEST = 12


class Asked(Protocol):
    """Whether a constant, or an expression where further relations hold, is >= 0 (or > 0)."""

    def __call__(self, expr: sp.Expr, *given: sp.Basic, strict: bool = False) -> bool: ...


class Section(NamedTuple):
    """rho^degree f(c)."""

    degree: sp.Expr
    f: sp.Expr

    def positive(self, ask: Asked) -> bool:
        """Whether f > 0 for -1 <= c <= 1."""
        factors = [p.base if p.is_Pow else p for p in sp.Mul.make_args(self.f)]
        return all(_on_section(ask, part, strict=True) for part in factors)

    def nonnegative(self, ask: Asked) -> bool:
        """Whether f >= 0."""
        return self.lode(ask) if self.f.has(sp.cos, sp.sin) else self.positive(ask) or _on_section(ask, self.f)

    def convex(self, ask: Asked) -> bool:
        """Whether rho^degree f, or for another degree than 1 its root rho f^(1/degree), is convex."""
        if self.f.has(sp.cos, sp.sin):
            return self.degree == 1 and self.lode(ask)
        if self.degree == 1 and self.f.is_polynomial(_C):
            return _on_section(ask, _bend(self.f))
        if not self.positive(ask):
            return False
        rate = sum(self._exponent(p) * sp.diff(b, _C) / b for p in sp.Mul.make_args(self.f) for b in [p.base if p.is_Pow else p])
        rate = sp.together(rate / self.degree)
        bend = 9 * (1 - _C**2) * (sp.diff(rate, _C) + rate**2) - 9 * _C * rate + 1  # over f^(1/degree)
        over, under = sp.fraction(sp.together(bend))
        square = sp.expand(over * under)  # under is a product of the bases, each to some power
        return _on_section(ask, square)

    @staticmethod
    def _exponent(power: sp.Expr) -> sp.Expr:
        return power.exp if power.is_Pow else sp.S.One

    def lode(self, ask: Asked) -> bool:
        """Whether f is A cos(b - acos(gamma c)/3), A >= 0, 0 <= b <= pi/3, |gamma| <= 1."""
        scale, wave = self.f.as_independent(_C, as_Add=False)
        if not isinstance(wave, sp.cos | sp.sin) or not ask(scale):
            return False
        angle = wave.args[0] if isinstance(wave, sp.cos) else sp.pi / 2 - wave.args[0]
        offset, turn = angle.as_independent(_C, as_Add=True)
        third, inverse = turn.as_independent(_C, as_Add=False)
        if abs(third) != sp.Rational(1, 3) or not isinstance(inverse, sp.atan | sp.acos):
            return False
        (y,) = inverse.args
        gamma = sp.simplify(sp.diff(y, _C).subs(_C, 0))
        if isinstance(inverse, sp.atan):  # acos z = pi/2 - atan(z/sqrt(1 - z^2))
            rest, way = y**2 * (1 - gamma**2 * _C**2) - gamma**2 * _C**2, 1 / (3 * third)
            offset = way * offset + sp.pi / 6
        else:
            rest, way = y - gamma * _C, -1 / (3 * third)
            offset = way * offset
        if gamma.has(_C) or sp.simplify(rest) != 0 or not all(ask(1 - s * gamma) for s in (1, -1)):
            return False
        return ask(sp.expand(offset / sp.pi)) and ask(sp.expand(sp.Rational(1, 3) - offset / sp.pi))


def _bend(f: sp.Expr) -> sp.Expr:
    return sp.expand(9 * (1 - _C**2) * sp.diff(f, _C, 2) - 9 * _C * sp.diff(f, _C) + f)


def _on_section(ask: Asked, expr: sp.Expr, strict: bool = False) -> bool:
    """Asked of c between -1 and 1, or of J3 = (2 sqrt(3)/9) c where that is free of roots."""
    if not expr.has(_C):
        return ask(expr, strict=strict)
    if expr.has(sp.sqrt(3)):
        other = sp.expand(expr.subs(_C, 3 * sp.sqrt(3) / 2 * _W))
        if not other.has(sp.sqrt(3)):
            return ask(other, sp.GreaterThan(4 - 27 * _W**2, 0), strict=strict)
    return ask(expr, sp.GreaterThan(_C + 1, 0), sp.GreaterThan(1 - _C, 0), strict=strict)


@dataclass(frozen=True)
class Meaning:
    """J2 and J3 of the tensor that the forces may be, as polynomials; each expression is read once."""

    forces: tuple[sp.Symbol, ...]
    second: sp.Expr
    third: sp.Expr
    known: dict[sp.Expr, Section | None] = field(default_factory=dict, compare=False, repr=False)

    def read(self, expr: sp.Expr) -> Section | None:
        """The expression as such a function; None where it is none."""
        if expr not in self.known:
            self.known[expr] = self._read(expr)
        return self.known[expr]

    def _read(self, expr: sp.Expr) -> Section | None:
        if not expr.free_symbols & {*self.forces}:
            return Section(sp.S.Zero, expr)
        if expr.is_polynomial(*self.forces):
            return self._polynomial(expr)
        if expr.is_Mul:
            plain = sp.Mul(*(a for a in expr.args if a.is_polynomial(*self.forces)))
            read = [self.read(plain), *(self.read(a) for a in expr.args if not a.is_polynomial(*self.forces))]
            known = [r for r in read if r is not None]
            return Section(sum(r.degree for r in known), sp.Mul(*(r.f for r in known))) if len(known) == len(read) else None
        if expr.is_Add:
            read = [self.read(a) for a in expr.args]
            known = [r for r in read if r is not None]
            if len(known) < len(read) or len({r.degree for r in known}) > 1:
                return None
            return Section(known[0].degree, sp.Add(*(r.f for r in known)))
        if expr.is_Pow and not expr.exp.free_symbols & {*self.forces}:
            base = self.read(expr.base)
            return None if base is None else Section(base.degree * expr.exp, base.f**expr.exp)
        if isinstance(expr, sp.cos | sp.sin | sp.atan | sp.acos):
            inner = self.read(expr.args[0])
            return Section(sp.S.Zero, expr.func(inner.f)) if inner is not None and inner.degree == 0 else None
        return None

    def emptied(self, expr: Any) -> Any:
        """The formula where J2 = 0: with 0 for its functions of J2 and J3 of a degree above 0."""
        if not expr.free_symbols & {*self.forces} or expr.is_Symbol or expr.is_Relational:
            return expr
        section = self.read(expr)
        if section is not None and section.degree.is_positive:
            return sp.S.Zero
        return expr.func(*map(self.emptied, expr.args))

    def _polynomial(self, expr: sp.Expr) -> Section | None:
        form = sp.Poly(expr, *self.forces)
        k = form.total_degree()
        if not form.is_homogeneous or not 2 <= k <= _HIGHEST:
            return None
        powers = [j for j in range(k // 3 + 1) if (k - 3 * j) % 2 == 0]
        unknown = sp.symbols(f"a:{len(powers)}", cls=sp.Dummy)
        gap = expr - sum(a * self.second ** ((k - 3 * j) // 2) * self.third**j for a, j in zip(unknown, powers, strict=True))
        solved = [*sp.linsolve(sp.Poly(gap, *self.forces).coeffs(), *unknown)] if powers else []
        if not solved or {*unknown} & sp.Tuple(*solved[0]).free_symbols:
            return None
        return Section(sp.Integer(k), sum(a * (2 * sp.sqrt(3) / 9 * _C) ** j for a, j in zip(solved[0], powers, strict=True)))


def meaning_of(g: sp.Expr, forces: Sequence[sp.Symbol], left: Sequence[sp.Symbol]) -> Meaning | None:
    """What tensor the forces of a law are, if J2 of one stands in its formula."""
    parts = [part for part in g.atoms(sp.Add) if part.is_polynomial(*left) and sp.Poly(part, *left).total_degree() == 2]
    for meaning in _meanings(forces, left) if parts else ():
        if any(found is not None and found.degree == 2 for found in map(meaning.read, parts)):
            return meaning
    return None


def _meanings(forces: Sequence[sp.Symbol], left: Sequence[sp.Symbol]) -> Iterator[Meaning]:
    """The tensors that a law's forces may be, those not ``left`` being 0: principal values, components in the plane or in space."""
    x: list[Any] = [f if f in left else sp.S.Zero for f in forces]
    zero = sp.S.Zero
    tensors: list[tuple[Any, ...]] = []
    if len(x) in (2, 3):
        tensors.append(((*x, zero)[:3], (zero, zero, zero)))
    if len(x) in (3, 4):
        tensors.append(((x[0], x[1], zero if len(x) == 3 else x[2]), (zero, zero, x[-1])))
    if len(x) == 6:
        tensors += [(x[:3], shear) for shear in permutations(x[3:])]
    for normal, (yz, zx, xy) in tensors:
        mean = sum(normal) / 3
        s = sp.Matrix([[normal[0] - mean, xy, zx], [xy, normal[1] - mean, yz], [zx, yz, normal[2] - mean]])
        yield Meaning(tuple(f for f in forces if f in left), sp.expand((s * s).trace() / 2), sp.expand(s.det()))
