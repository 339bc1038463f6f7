"""Loads known to be >= 0 in a region: the signs that they leave."""

from __future__ import annotations

from collections.abc import Callable, Collection

import sympy as sp

from duhem.expression.invariance import affine
from duhem.proof.search.edges import greatest, loads_of

__all__ = ["above_within", "affine", "alone", "concave_above_within", "loads_and_others", "loads_of"]


def loads_and_others(g: sp.Expr, forces: Collection[sp.Symbol]) -> tuple[list[sp.Expr], list[sp.Expr]]:
    """What a maximum is taken of: loads and the rest."""
    parts = greatest(g)
    return [part for part in parts if affine(part, forces)], [part for part in parts if not affine(part, forces)]


def above_within(expr: sp.Expr, loads: Collection[sp.Expr], forces: Collection[sp.Symbol], above: Callable[[sp.Expr], bool]) -> bool:
    """Whether an affine expression is a load >= 0, times a constant >= 0, and another such constant; ``above`` tells of constants."""
    return any(split is not None and all(map(above, split)) for split in (_split(expr, load, forces) for load in loads))


def _split(expr: sp.Expr, load: sp.Expr, forces: Collection[sp.Symbol]) -> tuple[sp.Expr, sp.Expr] | None:
    """(c, d) with expr = c load + d."""
    x = next(f for f in sorted(forces, key=str) if load.has(f))
    share = sp.cancel(sp.diff(expr, x) / sp.diff(load, x))
    if share.free_symbols & set(forces) or any(sp.cancel(sp.diff(expr, y) - share * sp.diff(load, y)) != 0 for y in forces):
        return None
    zero = dict.fromkeys(forces, sp.S.Zero)
    return share, sp.cancel(expr.xreplace(zero) - share * load.xreplace(zero))


def concave_above_within(
    expr: sp.Expr, loads: Collection[sp.Expr], forces: Collection[sp.Symbol], above: Callable[[sp.Expr], bool]
) -> bool:
    """Whether an expression, concave where all loads are >= 0, depends on one load alone, and is >= 0 at two ends of it where they are."""
    return any(
        _above_at_both_ends(expr, one, two, forces, above) and all(_above_at(two, one, x, forces, above) for x in loads)
        for one in loads
        for two in loads
        if one != two
    )


def _above_at(other: sp.Expr, load: sp.Expr, asked: sp.Expr, forces: Collection[sp.Symbol], above: Callable[[sp.Expr], bool]) -> bool:
    """Whether a load is >= 0 where ``load`` is 0 and where ``other`` is, all forces but one being 0 there."""
    x = next(f for f in sorted(forces, key=str) if load.has(f))
    zero = dict.fromkeys(forces, sp.S.Zero)
    places = (zero | {x: -end.xreplace(zero) / sp.diff(end, x)} for end in (load, other))
    return all(above(sp.simplify(asked.xreplace(place))) for place in places)


def _above_at_both_ends(
    expr: sp.Expr, load: sp.Expr, other: sp.Expr, forces: Collection[sp.Symbol], above: Callable[[sp.Expr], bool]
) -> bool:
    split = _split(other, load, forces)
    if split is None or above(split[0]) or not above(-split[0]):
        return False
    along = sp.Symbol("the load", real=True)
    of_load = alone(expr, load, along, forces)
    if of_load is None:
        return False
    return all(above(sp.simplify(of_load.subs(along, end))) for end in (sp.S.Zero, -split[1] / split[0]))


def alone(expr: sp.Expr, load: sp.Expr, along: sp.Symbol | sp.Integer, forces: Collection[sp.Symbol]) -> sp.Expr | None:
    """The expression where a load is ``along``; None where the forces enter by more than that load."""
    x = next(f for f in sorted(forces, key=str) if load.has(f))
    place = sp.expand(x + (along - load) / sp.diff(load, x))
    found = expr.xreplace({x: place}) if not (place.free_symbols & set(forces)) else _put(expr, x, place)
    return None if found.free_symbols & set(forces) else found


def _put(expr: sp.Expr, x: sp.Symbol, place: sp.Expr) -> sp.Expr:
    """The expression with x put, every sum in it expanded so that other forces drop out."""
    if not expr.has(x) or not expr.args:
        return place if expr == x else expr
    found = expr.func(*(_put(a, x, place) for a in expr.args))
    return sp.expand(found) if found.is_Add or found.is_Mul else found
