"""A formula with kinks as smooth branches: which side of each switching function, and the expression there.

Kinks come from abs, pos, neg, max, min and where.  Each has switching functions; a branch fixes the sign of every
switch it met, and its expression holds on the closed region where the signs are as said.  One-sided limits at a seam
are values of branch expressions, never two-sided limits.  Beside them stand what else takes a kink by its pieces: seams as simple as they
are, what is <= 0 wherever a maximum is, and gradients, with the pieces of a kink behind a ``where``.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import reduce
from itertools import combinations, permutations
from types import MappingProxyType
from typing import Any

import sympy as sp

from duhem.errors import InputError
from duhem.expression import Norm
from duhem.expression.build import settled, unacceptable
from duhem.expression.fold import fold
from duhem.expression.number import InertNumber
from duhem.expression.vocabulary import KINKS, EigMax, Neg, Pos, Where, adopted

__all__ = [
    "Branch", "Seam", "TooManyBranchesError", "almost_everywhere", "branches", "gradient", "jacobian", "oriented", "plain_switches",
    "seam", "seams", "smooth_below", "thick",
]  # fmt: skip

_LONG = 60  # operations
_MOST_DEGREE = 10_000


class TooManyBranchesError(Exception):
    """The formula has more branches than asked for."""


@dataclass(frozen=True)
class Branch:
    """``expr`` holds where each switch has its sign: +1 for switch >= 0, -1 for switch <= 0, 0 for switch = 0.

    A sign 0 makes the branch thin, a set without inside; only ``where`` gives such branches a value of their own.  The switches
    in ``apart`` are not 0 in it: the other side of a ``where`` owns the equality.
    """

    signs: Mapping[sp.Expr, int]
    expr: Any
    apart: frozenset[sp.Expr] = field(default=frozenset(), kw_only=True)

    def conditions(self) -> tuple[sp.Basic, ...]:
        """The region as relations."""
        return tuple(sp.GreaterThan(sign * switch, 0) if sign else sp.Eq(switch, 0) for switch, sign in self.signs.items())


def oriented(switch: sp.Expr) -> tuple[sp.Expr, int]:
    """A switch reduced to a canonical one with the same zero set, and the sign relating the two.

    Positive factors are dropped, so that ``sigma_a`` and ``sigma_a/mu`` are one switch.
    """
    number, rest = switch.as_coeff_Mul()
    factors = [factor for factor in sp.Mul.make_args(rest) if not factor.is_positive]
    sign = (-1) ** sum(factor.is_negative is True for factor in (number, *factors))
    core = sp.Mul(*(factor for factor in factors if not factor.is_negative))
    if core.is_Add and core.could_extract_minus_sign():
        core, sign = -core, -sign
    return core, sign


def branches(expr: sp.Basic, most: int = 64) -> tuple[Branch, ...]:
    """All sign-consistent branches of ``expr``; raises TooManyBranchesError above ``most``."""

    wheres = expr.has(Where)  # then what holds only where a switch is 0 must be kept

    def row(made: Callable[..., Iterable[Branch | None]]) -> Callable[..., tuple[Branch, ...]]:
        return lambda node, *values: _capped((b for where, parts in _joint(values, wheres) for b in made(node, where, parts, wheres)), most)

    class _Table(dict[type, Callable[..., tuple[Branch, ...]]]):
        def get(self, key: Any, default: Any = None) -> Any:
            if key is EigMax:
                raise TooManyBranchesError("the branches of an eigenvalue are not told apart")
            # every other node is smooth: rebuild it branch by branch
            return super().get(key, row(_rebuilt))

    return fold(expr, _Table(dict.fromkeys(KINKS, row(_split))), lambda leaf: (Branch({}, leaf),))


def almost_everywhere(expr: Any, place: Mapping[sp.Symbol, sp.Expr] = MappingProxyType({})) -> Any:
    """The formula but on the zeros of sums of squares: with what ``where`` chooses elsewhere, if its condition asks that one is > 0.

    Of a choice by one that is 0 throughout a ``place``, symbols given by others, nothing is left out.
    """
    if not isinstance(expr, sp.Basic) or not expr.has(Where):
        return expr
    args = [almost_everywhere(a, place) for a in expr.args]
    if isinstance(expr, Where) and isinstance(args[0], sp.Rel):
        closed = isinstance(args[0], sp.GreaterThan | sp.LessThan)
        gap = (args[0].gts - args[0].lts) * (-1 if closed else 1)
        if gap.is_extended_nonnegative and sp.expand(gap.xreplace({**place})) != 0:
            return args[2 if closed else 1]
    return expr.func(*args)


def thick(expr: sp.Basic, most: int = 64) -> tuple[Branch, ...] | None:
    """The branches with an inside, enough where the formula is known not to jump; None where there are more than ``most`` branches."""
    try:
        return tuple(b for b in branches(expr, most) if 0 not in b.signs.values())
    except TooManyBranchesError:
        return None


def _capped(found: Iterable[Branch | None], most: int) -> tuple[Branch, ...]:
    kept: dict[tuple[Any, ...], Branch] = {}
    for branch in filter(None, found):
        kept.setdefault((frozenset(branch.signs.items()), branch.apart, branch.expr), branch)
        if len(kept) > most:
            raise TooManyBranchesError(f"more than {most} branches")
    return tuple(kept.values())


def _joint(values: Sequence[tuple[Branch, ...]], thin: bool) -> list[tuple[Branch, tuple[Branch, ...]]]:
    """Where one branch of each argument holds together, and these: what contradicts itself early is not multiplied further."""
    found = [(Branch({}, None), tuple[Branch, ...]())]
    for own in values:
        more = ((*parts, one) for _, parts in found for one in own)
        found = [(where, parts) for parts in more if (where := _together(parts, thin)) is not None]
    return found


def _together(parts: Sequence[Branch], thin: bool) -> Branch | None:
    """Where all of them hold, without a formula; opposite signs leave switch = 0, which counts only if ``thin`` branches do."""
    signs: dict[sp.Expr, int] = {}
    apart = frozenset[sp.Expr]().union(*(part.apart for part in parts))
    for part in parts:
        for switch, sign in part.signs.items():
            if signs.setdefault(switch, sign) != sign:
                if not thin or switch in apart:
                    return None
                signs[switch] = 0
    return Branch(signs, None, apart=apart)


def _left_alone(exponent: sp.Expr) -> sp.Expr:
    """An exponent that SymPy would make polynomials of that degree of is kept as it was written."""
    return InertNumber(exponent) if exponent.is_Rational and max(abs(exponent.p), exponent.q) > _MOST_DEGREE else exponent


def _rebuilt(node: sp.Basic, where: Branch, parts: tuple[Branch, ...], thin: bool) -> Iterable[Branch | None]:
    expr = node.func(*(_left_alone(p.expr) if node.is_Pow and p is parts[1] else p.expr for p in parts))
    if not expr.has(sp.Abs):
        yield replace(where, expr=expr)
        return
    for inner in branches(expr):  # a norm that is left with one argument has become an absolute value
        if (joint := _together([where, inner], thin)) is not None:
            yield replace(joint, expr=inner.expr)


def _with(where: Branch, more: Iterable[tuple[sp.Expr, int]], expr: sp.Expr, thin: bool = False, strict: bool = False) -> Branch | None:
    """The branch further restricted by sign * switch >= 0, or > 0 if ``strict``; None where that contradicts.

    Where it leaves only switch = 0 the answer is None too, unless ``thin`` branches count.
    """
    parts = [where]
    for switch, sign in more:
        core, flip = oriented(switch)
        wanted = sign * flip
        if core.is_number:
            if core.has(sp.zoo, sp.nan) or wanted * core < 0:
                return None  # nothing has a value there, or it contradicts
            continue
        never, always = (core.is_extended_nonpositive, core.is_extended_nonnegative)[::wanted]
        if never and (not thin or core.is_nonzero):
            return None
        if never or not always:
            parts.append(Branch({core: 0 if never else wanted}, None, apart=frozenset([core] if strict else ())))
    joint = _together(parts, thin)
    return None if joint is None else replace(joint, expr=expr)


def _split(node: sp.Basic, where: Branch, parts: tuple[Branch, ...], thin: bool) -> Iterable[Branch | None]:
    values = [p.expr for p in parts]
    if isinstance(node, sp.Abs | Pos | Neg):
        slope, below = (1, -values[0]) if isinstance(node, sp.Abs) else (node.slope, sp.S.Zero)
        yield _with(where, [(values[0], slope)], slope * values[0])
        yield _with(where, [(values[0], -slope)], below)
    elif isinstance(node, sp.Max | sp.Min):
        sense = 1 if isinstance(node, sp.Max) else -1
        for i, value in enumerate(values):
            others = [_plain(value - v) for j, v in enumerate(values) if j != i and v != value]
            yield _with(where, [(d, sense) for d in others], value)
    else:
        condition, then, otherwise = values
        if condition in (sp.true, sp.false):
            yield replace(where, expr=then if condition is sp.true else otherwise)
            return
        gap = _plain(condition.gts - condition.lts)
        closed = isinstance(condition, sp.GreaterThan | sp.LessThan)  # which side owns the equality
        yield _with(where, [(gap, 1)], then, thin=closed, strict=not closed)
        yield _with(where, [(gap, -1)], otherwise, thin=not closed, strict=closed)


def _plain(expr: sp.Expr) -> sp.Expr:
    """Multiplied out, so that a switch is met again in one form; but for long terms that are no polynomials, where that takes seconds."""
    terms = sp.Add.make_args(expr)
    if all(term.is_polynomial() or term.count_ops() <= _LONG for term in terms):
        return sp.expand(expr)
    return sp.Add(*(sp.expand(term) if term.is_polynomial() else term for term in terms))


@dataclass(frozen=True)
class Seam:
    """Where two branches may meet: the switches ``crossed``, whose sign differs, are 0; those ``kept`` have their sign there."""

    before: Branch
    after: Branch
    crossed: tuple[sp.Expr, ...]
    kept: Mapping[sp.Expr, int]


def seam(before: Branch, after: Branch) -> Seam | None:
    """The seam between two branches; None where no switch has opposite signs in them."""
    crossed = tuple(s for s, sign in after.signs.items() if before.signs.get(s) == -sign)
    kept = {s: sign for s, sign in {**before.signs, **after.signs}.items() if s not in crossed}
    return Seam(before, after, crossed, kept) if crossed else None


def seams(pieces: Sequence[Branch], both_ways: bool = False) -> Iterator[Seam]:
    """The seams between branches whose expressions differ, each pair once, or ``both_ways``."""
    for before, after in (permutations if both_ways else combinations)(pieces, 2):
        if before.expr != after.expr and (found := seam(before, after)) is not None:
            yield found


def plain_switches(pieces: Iterable[Branch]) -> tuple[Branch, ...]:
    """The branches with each switch sqrt(p) - sqrt(q) replaced by p - q, which has its sign and no root."""
    found = []
    for piece in pieces:
        signs: dict[sp.Expr, int] = {}
        for switch, sign in piece.signs.items():
            core, flip = oriented(_squared(switch))
            if core in signs and signs[core] != sign * flip:
                core, flip = switch, 1  # two switches that have become one: kept apart, as they came
            signs[core] = sign * flip
        found.append(Branch(signs, piece.expr))
    return tuple(found)


def _squared(switch: sp.Expr) -> sp.Expr:
    if not (switch.is_Add and len(switch.args) == 2):
        return switch
    squares = [_square(term) for term in switch.args]
    if None in squares or {s.is_positive for _, s in squares} != {True, False}:  # type: ignore[misc]
        return switch
    return sp.expand(sp.Add(*(square * sense for square, sense in squares)))  # type: ignore[misc]


def _square(term: sp.Expr) -> tuple[sp.Expr, sp.Integer] | None:
    """The square of +- a root, or of a number, and the sign; None for anything else."""
    scale, root = term.as_coeff_Mul()
    if not scale.is_Rational:
        return None
    if isinstance(root, Norm):
        under = sp.Add(*(c**2 for c in root.args))
    elif root.is_Pow and root.exp == sp.S.Half and root.base.is_nonnegative:  # else it may be undefined
        under = root.base
    elif root == 1:
        under = root
    else:
        return None
    return scale**2 * under, sp.sign(scale)


_MOST = 32


def smooth_below(expr: sp.Expr) -> tuple[sp.Expr, ...]:
    """Formulas without a kink that are <= 0 wherever ``expr`` is; none where that is not seen, or they are too many.

    A kink that is added, times something positive, is replaced by each of what it is the greatest of.
    """
    found = tuple(dict.fromkeys(_smaller(expr)))
    return found if len(found) <= _MOST else ()


def _smaller(expr: sp.Expr) -> Iterator[sp.Expr]:
    if not expr.has(*KINKS):
        yield expr
        return
    for term in sp.Add.make_args(expr):
        if values := _values(term):
            for value in values:
                yield from _smaller(expr - term + value)
            return


def _values(term: sp.Expr) -> tuple[sp.Expr, ...]:
    """What a kink, times something positive, is the greatest of; none where the term is no such thing."""
    positive = [f for f in sp.Mul.make_args(term) if f.is_positive]
    rest = [f for f in sp.Mul.make_args(term) if not f.is_positive]
    if len(rest) != 1:
        return ()
    kink, factor = rest[0], sp.Mul(*positive)
    if isinstance(kink, sp.Abs):
        return factor * kink.args[0], -factor * kink.args[0]
    if isinstance(kink, Pos | Neg):
        return kink.slope * factor * kink.args[0], sp.S.Zero
    return tuple(factor * value for value in kink.args) if isinstance(kink, sp.Max) else ()


def gradient(potential: sp.Expr, forces: Sequence[sp.Symbol]) -> tuple[sp.Expr, ...]:
    """The derivatives by ``forces``; where pieces meet at a kink, that of one of them.  InputError where a part has no derivative."""
    opened = potential.replace(lambda node: isinstance(node, sp.Abs | sp.Max | sp.Min), _pieces)
    found = tuple(settled(sp.diff(opened, x)) for x in forces)
    for part in found:
        if fault := unacceptable(part, potential.free_symbols):
            raise InputError(f"the potential has no gradient in the words of the language: {fault.what}", remedy="give the flow itself")
    return found


def _pieces(node: Any) -> sp.Expr:
    """A kink as the choice between its pieces."""
    if isinstance(node, sp.Abs):
        return Where(node.args[0] >= 0, node.args[0], -node.args[0])
    greatest = isinstance(node, sp.Max)
    return reduce(lambda rest, a: Where(a >= rest if greatest else a <= rest, a, rest), node.args)


def jacobian(system: Sequence[sp.Expr], unknowns: Sequence[sp.Symbol]) -> sp.Matrix | None:
    """The derivatives of formulas, a row each; None where one cannot be said in the words of the language."""
    found = sp.Matrix(system).jacobian(list(unknowns)).applyfunc(adopted)
    return None if any(unacceptable(part, found.free_symbols) for part in found) else found
