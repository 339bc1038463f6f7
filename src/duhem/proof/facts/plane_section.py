"""A law in a plane of its force space, and the smooth pieces of its formula that meet in a small box of that plane.

A kink of the formula is opened only where the box does not decide it, so that a maximum of many faces is cheap near an edge of
two.  The square root of a square that the plane makes of a sum of squares is a kink as well: so the tip of a cone becomes one.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from typing import Any

import sympy as sp

from duhem.expression import UNDEFINED, EigMax, Neg, Norm, Pos, Where
from duhem.expression.balls import certain_sign, enclose
from duhem.expression.branches import Branch, almost_everywhere, oriented, plain_switches, thick
from duhem.expression.number import rational
from duhem.expression.vocabulary import KINKS
from duhem.proof.decide import Sense
from duhem.proof.facts.formula_subject import FormulaSubject
from duhem.proof.facts.subject import Values, rationals

__all__ = ["LocalPiece", "PlaneSection", "kinks_decided", "local_pieces"]

_MOST_PIECES, _MOST_OPERATIONS = 16, 100
Box = Mapping[sp.Symbol, Any]


@dataclass(frozen=True)
class PlaneSection:
    """The points ``base`` + a u + b v of the force space; ``along`` holds u and v, ``at`` the symbols of a and b."""

    forces: tuple[sp.Symbol, ...]
    base: tuple[Fraction, ...]
    along: tuple[tuple[Fraction, ...], tuple[Fraction, ...]]
    at: tuple[sp.Symbol, sp.Symbol]

    @classmethod
    def whole(cls, forces: tuple[sp.Symbol, sp.Symbol]) -> PlaneSection:
        """All of a force space that is a plane, in the forces themselves."""
        one, zero = Fraction(1), Fraction(0)
        return cls(forces, (zero, zero), ((one, zero), (zero, one)), forces)

    @classmethod
    def through(cls, forces: tuple[sp.Symbol, ...], base: Sequence[Fraction], u: Sequence[Fraction], v: Sequence[Fraction]) -> PlaneSection:
        """The plane through a point along two directions."""
        a, b = sp.symbols("a b", real=True, cls=sp.Dummy)
        return cls(forces, tuple(base), (tuple(u), tuple(v)), (a, b))

    def point(self, place: Sequence[Fraction]) -> tuple[Fraction, ...]:
        """The forces at the coordinates a, b."""
        a, b = place
        return tuple(x + a * u + b * v for x, u, v in zip(self.base, *self.along, strict=True))

    def coordinates(self) -> dict[sp.Symbol, sp.Expr]:
        """Each force as a formula in a and b."""
        a, b = self.at
        return {x: rational(z) + rational(u) * a + rational(v) * b for x, z, u, v in zip(self.forces, self.base, *self.along, strict=True)}


@dataclass(frozen=True)
class LocalPiece(Branch):
    """``expr`` = g in the plane; ``gradient`` = grad g there, by all forces; ``needed`` what the formula as written asks there.

    ``of_space`` where the plane itself has made no kink of g or of its slopes.
    """

    gradient: tuple[sp.Expr, ...]
    needed: tuple[tuple[sp.Expr, Sense], ...]
    of_space: bool


def local_pieces(
    subject: FormulaSubject, parameters: Values, section: PlaneSection, box: Box, whole_space: bool = True
) -> tuple[LocalPiece, ...]:
    """The pieces of g that the ``box`` (a ball for each of a and b) meets, their switches in a and b; none where that is not seen.

    Each has left those switches only whose sign the box leaves open.  Where they are not 0, g has in all forces the gradient said;
    unless ``whole_space``, what is said of g in the plane will do, and is cheaper.
    """
    place, exact = section.coordinates(), rationals(subject.values_at(parameters, section.base))
    settled = {x: value for x, value in exact.items() if x not in place}
    asked = [(o.expr.xreplace(settled), o.sense) for o in subject.doubtful] if whole_space else []
    around = {x: enclose(form, box) for x, form in place.items()}
    formula = subject.formula_at(parameters)
    beside = almost_everywhere(formula, place)
    if beside.has(Where) and not almost_everywhere(formula).has(Where):
        return ()  # the plane lies where a formula holds that holds nowhere beside it
    near, found = kinks_decided(_diagonal(beside, place), around), dict[Any, LocalPiece]()
    if near.has(*KINKS) and near.count_ops() > _MOST_OPERATIONS:
        return ()  # its arms would be compared for minutes
    for whole in plain_switches(thick(near, _MOST_PIECES) or ()):
        slopes = [sp.diff(whole.expr, x) for x in section.forces] if whole_space else []
        parts = (sp.Tuple(whole.expr, *slopes), sp.Tuple(*whole.signs), sp.Tuple(*(e for e, _ in asked)))
        if (pieces := thick(_in_plane(sp.Tuple(*parts), {**place}), _MOST_PIECES)) is None:
            return ()
        for piece in pieces:
            (expr, *gradient), switches, needs = _cancelled(piece.expr, {})
            signs = [(_plain(e), sign) for e, sign in (*zip(switches, whole.signs.values(), strict=True), *piece.signs.items())]
            if (left := _open(signs, box)) is None:
                continue
            if sp.Tuple(expr, *gradient, *needs).has(*UNDEFINED, *KINKS) or any(s.is_zero for s, _ in signs):
                return ()  # it is not seen which piece holds where
            needed = tuple((e, sense) for e, (_, sense) in zip(needs, asked, strict=True))
            of_space = not piece.signs or not _in_plane(sp.Tuple(whole.expr, *slopes), {**place}).has(*KINKS)
            found.setdefault((frozenset(left.items()), expr), LocalPiece(left, expr, tuple(gradient), needed, of_space))
    return tuple(found.values())


def _diagonal(g: sp.Expr, place: Mapping[sp.Symbol, sp.Expr]) -> sp.Expr:
    """With the greatest entry for the greatest eigenvalue of a matrix that is diagonal throughout the plane.

    Where one entry alone is the greatest its gradient in all forces is the eigenvalue's: n is an axis, and a shear's share 2 n_i n_j is 0.
    """
    flat = {e: sp.Max(*e.args[:3]) for e in g.atoms(EigMax) if all(sp.expand(s.xreplace({**place})) == 0 for s in e.args[3:])}
    return g.xreplace(flat)


def kinks_decided(expr: sp.Basic, box: Box) -> sp.Basic:
    """The same over the box, with every kink left out that the box decides."""
    if not expr.has(*KINKS):
        return expr
    args = [kinks_decided(a, box) for a in expr.args]
    if isinstance(expr, sp.Max | sp.Min):
        sense = 1 if isinstance(expr, sp.Max) else -1
        values = [enclose(sense * a, box) for a in args]
        kept = [a for a, v in zip(args, values, strict=True) if not any(v < other for other in values)]
        return expr.func(*kept)
    if isinstance(expr, sp.Abs | Pos | Neg) and (sign := certain_sign(enclose(args[0], box))) is not None:
        slope = getattr(expr, "slope", sign)
        return slope * args[0] if sign == slope else sp.S.Zero
    if isinstance(expr, Where) and (holds := enclose(args[0], box)) is not None:
        return args[1] if holds else args[2]
    return expr.func(*args)


def _in_plane(expr: sp.Basic, known: dict[sp.Basic, sp.Basic]) -> sp.Basic:
    """The formula with the forces put in place, what is under a root multiplied out: the root of a square becomes a size.

    ``known`` holds the forces, and in the end every part.
    """
    if expr not in known:
        args = [_in_plane(a, known) for a in expr.args]
        if isinstance(expr, Norm):
            known[expr] = sp.sqrt(_plain(sp.Add(*(a**2 for a in args))))
        elif args:
            root = expr.is_Pow and not expr.exp.is_Integer
            known[expr] = expr.func(_plain(args[0]), *args[1:]) if root else expr.func(*args)
        else:
            known[expr] = expr
    return known[expr]


def _cancelled(expr: sp.Basic, known: dict[sp.Basic, sp.Basic]) -> sp.Basic:
    """The formula with common factors taken out of what divides, so that they cancel; ``known`` holds the parts that are done."""
    if expr not in known:
        args = [_cancelled(a, known) for a in expr.args]
        if expr.is_Pow and expr.exp.is_negative and args[0].is_Add:
            args[0] = sp.factor_terms(args[0])
        known[expr] = expr.func(*args) if args else expr
    return known[expr]


def _plain(expr: sp.Expr) -> sp.Expr:
    """A polynomial multiplied out; anything else as it is."""
    return sp.expand(expr) if expr.is_polynomial(*expr.free_symbols) else expr


def _open(signs: Iterable[tuple[sp.Expr, int]], box: Box) -> dict[sp.Expr, int] | None:
    """The switches in the plane that the box leaves open, each in one form; None where a piece with such signs is not met."""
    left: dict[sp.Expr, int] = {}
    for switch, wanted in signs:
        core, flip = oriented(switch)
        sign = certain_sign(enclose(core, box))
        if sign is None and left.setdefault(core, wanted * flip) == wanted * flip:
            continue
        if sign != wanted * flip:
            return None
    return left
