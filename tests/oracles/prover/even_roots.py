"""Formulas that are even functions of roots in them, such as f(u - r) + f(u + r), the eigenvalues of a tensor being u -+ r.

If G(x, z) is quasiconvex and even in each z_i, it does not fall as z_i >= 0 grows; G(x, r(x)) with r_i convex and >= 0 then is
quasiconvex, and convex if G is (Davis 1957; Lewis 1996).
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterator
from typing import Any

import sympy as sp

from duhem.expression import Norm

__all__ = ["even", "freed", "outermost_roots"]


def outermost_roots(expr: sp.Expr, forces: Collection[sp.Symbol], convex: Callable[[sp.Expr], bool]) -> Iterator[sp.Expr]:
    """Those that are ``convex`` and >= 0."""
    rooted = isinstance(expr, Norm) or (expr.is_Pow and expr.exp.is_Rational and 0 < expr.exp < 1)
    if rooted and expr.free_symbols & set(forces) and convex(expr):
        yield expr
        return
    for part in expr.args:
        yield from outermost_roots(part, forces, convex)


def freed(expr: sp.Expr, roots: Collection[sp.Expr], forces: Collection[sp.Symbol]) -> Iterator[tuple[sp.Expr, dict[sp.Symbol, sp.Expr]]]:
    """The formula with a free z for each root, and what they stand for; then with |z| where no other part of the forces is added to it.

    Roots of one thing, multiplied out, are one.
    """
    known: dict[sp.Expr, sp.Symbol] = {}
    names = {root: known.setdefault(sp.expand(root), sp.Dummy(f"z{i}", real=True)) for i, root in enumerate(roots)}
    meant = {z: root for root, z in reversed(names.items())}
    for sized in (False, True):
        yield _freed(expr, names, sized, set(forces)), meant


def even(expr: sp.Expr, names: Collection[sp.Symbol]) -> bool:
    """Whether it is even in each of some symbols."""
    turned = [expr.xreplace({z: -z}) for z in names]
    return all(other == expr or sp.expand(other - expr) == 0 for other in turned)


def _freed(expr: Any, names: dict[sp.Expr, sp.Symbol], sized: bool, forces: set[sp.Symbol]) -> Any:
    if expr in names:
        return sp.Abs(names[expr]) if sized else names[expr]
    if not expr.args or not expr.free_symbols & forces:
        return expr
    if expr.is_Pow:  # y^k for a root y^e
        for root, z in names.items():
            if root.is_Pow and root.base == expr.base:
                return sp.Abs(z) ** (expr.exp / root.exp)
    if sized and expr.is_Add and any(part.is_polynomial(*forces) and part.free_symbols & forces for part in expr.args):
        return expr.func(*(_multiple(part, names, forces) or _freed(part, names, sized, forces) for part in expr.args))
    return expr.func(*(_freed(part, names, sized, forces) for part in expr.args))


def _multiple(term: sp.Expr, names: dict[sp.Expr, sp.Symbol], forces: set[sp.Symbol]) -> sp.Expr | None:
    """c z for c r."""
    scale, part = term.as_independent(*forces, as_Add=False)
    return scale * names[part] if part in names else None
