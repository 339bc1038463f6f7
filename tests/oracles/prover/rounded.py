"""Sets that are round where they end: K = {A <= S} where all loads in a maximum are <= 0, S = c (h_1 ... h_k)^e, c > 0, 0 < e < 1.

Let A >= 0 be convex and C^1 where it is not 0, the h concave and >= 0 where the loads are <= 0, and A < S somewhere inside.  Between the
ends of the loads S > 0, so that A = S is not 0 on the boundary, and A - S is convex and C^1 near it.  At an end, where one h alone is 0,
A = 0, and S rises like t^e on the way t inside but A like t: every way inside points into K, and the load's normal is the only one.
So the boundary of Bigoni and Piccolroaz's K (2004, IJSS 41, 2855) is C^1 at both of its tips.
"""

from __future__ import annotations

from collections.abc import Sequence

import sympy as sp

from duhem.expression import Pos
from duhem.proof.facts.formula_subject import FormulaSubject
from duhem.proof.verdict import Evidence, Proof, Verdict
from tests.oracles.prover.curvature import curvature
from tests.oracles.prover.deviator import limit_at_origin, on_axis
from tests.oracles.prover.loads import alone, loads_and_others
from tests.oracles.prover.regularity import regularity

__all__ = ["smoothness"]


def smoothness(subject: FormulaSubject) -> Evidence | None:
    """g is the greatest of loads and such an A - S, and g < 0 at the origin, by continuity."""
    loads, others = loads_and_others(subject.simple.g, subject.simple.forces)
    if not loads or len(others) != 1 or (origin := limit_at_origin(subject)) is None or not subject.positive(-origin):
        return None
    if (split := _gauge_and_root(others[0], subject)) is None:
        return None
    gauge, root = split
    within = [sp.expand(-load) for load in loads]
    size = curvature(gauge, subject)
    if not (size.convex and size.nonnegative and curvature(root, subject, loads=within).concave):
        return None
    parts = _moving(_inner(root), subject)
    if not subject.positive(sp.Mul(*(h for h in sp.Mul.make_args(_inner(root)) if h not in parts))):
        return None
    shapes = [curvature(h, subject, loads=within) for h in parts]
    if not all(shape.concave and shape.nonnegative for shape in shapes):
        return None
    if not all(_smooth_but_where_zero(part, subject) for part in (gauge, *parts)):
        return None
    if not all(_ends_round(load, loads, parts, subject) for load in loads):
        return None
    detail = "K is convex, its boundary C^1 between the ends of its loads, and round at these, where the root in g is 0"
    return Evidence(Verdict.PROVED, "composition", detail, proof=Proof("composition"))


def _gauge_and_root(f: sp.Expr, subject: FormulaSubject) -> tuple[sp.Expr, sp.Expr] | None:
    """A and (h_1 ... h_k)^e of f = A - c (h_1 ... h_k)^e."""
    for term in sp.Add.make_args(f):
        scale, root = term.as_independent(*subject.simple.forces, as_Add=False)
        if not root.is_Pow or root.exp.free_symbols & set(subject.simple.forces) or not subject.positive(-scale):
            continue
        if subject.positive(root.exp) and subject.positive(1 - root.exp):
            return f - term, root
    return None


def _inner(root: sp.Expr) -> sp.Expr:
    """h_1 ... h_k, which is >= 0."""
    base: sp.Expr = root.base
    return base.args[0] if isinstance(base, Pos) else base


def _moving(product: sp.Expr, subject: FormulaSubject) -> list[sp.Expr]:
    return [h for h in sp.Mul.make_args(product) if h.free_symbols & set(subject.simple.forces)]


def _smooth_but_where_zero(expr: sp.Expr, subject: FormulaSubject) -> bool:
    """Whether it is C^1 wherever it is not 0: it is 0 where a tip is, be it by continuity, as functions of J2 and J3 are where J2 = 0."""
    found = regularity(expr, subject)
    return found.known and found.cancelling and all(_vanishes_with(tip, expr, subject) for tip in found.tips)


def _vanishes_with(tip: sp.Expr, expr: sp.Expr, subject: FormulaSubject) -> bool:
    factors = [f.base if f.is_Pow and f.exp.is_positive else f for f in sp.Mul.make_args(expr)]
    return tip in factors or on_axis(subject, expr, tip) == 0


def _ends_round(load: sp.Expr, loads: Sequence[sp.Expr], parts: Sequence[sp.Expr], subject: FormulaSubject) -> bool:
    """Whether the other loads are < 0 where this one is 0, and of the h one is 0 there and the others > 0."""
    forces = subject.simple.forces
    others = [alone(other, load, sp.S.Zero, forces) for other in loads if other is not load]
    ends = [alone(h, load, sp.S.Zero, forces) for h in parts]
    if any(value is None for value in (*others, *ends)) or not all(subject.positive(-value) for value in others if value is not None):
        return False
    zero = [value for value in ends if value is not None and sp.simplify(value).is_zero]
    return len(zero) == 1 and all(subject.positive(value) for value in ends if value is not None and value not in zero)
