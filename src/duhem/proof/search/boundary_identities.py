"""Identities about a law's formula, as evidence for the kernel: convex sums, a boundary that rises outward and curves inward.

They speak of the law as stated, not of an equivalent slice of it.  Where the formula is not made of polynomials none is found.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import Any

import sympy as sp

from duhem.expression.branches import Branch, TooManyBranchesError, branches, thick
from duhem.expression.text import formula
from duhem.law.formula_law import Criterion
from duhem.proof.facts.formula_subject import FormulaSubject
from duhem.proof.facts.subject import fact
from duhem.proof.search.identities import Condition, identity

__all__ = ["convex_sums", "directions", "inward", "outward"]

_GOAL, _BOUNDARY, _TANGENT = "the goal", "the boundary", "the tangent"
_MOST_PIECES, _MOST_MONOMIALS = 64, 150
Identities = tuple[Mapping[str, Any], ...]


@fact
def outward(subject: FormulaSubject) -> Identities:
    """For every piece of g, why force . flow > 0 (>= 0 for a flow of the law's own) wherever it is 0; none where one is missing."""
    law, found = subject.law, list[Mapping[str, Any]]()
    by_formula: dict[sp.Basic, list[Branch]] = {}
    for branch in _pieces(sp.Tuple(_settled(law, law.g), *(_settled(law, d) for d in law.flow or ()))):
        by_formula.setdefault(branch.expr, []).append(branch)
    for (g, *flow), where in by_formula.items():
        power = _along(law.force_symbols(), flow or [sp.diff(g, x) for x in law.force_symbols()])
        goal, given = Condition(_GOAL, -power, ">" if flow else ">="), [Condition(_BOUNDARY, g, "=="), *_domain(law)]
        if (anywhere := identity(goal, given)) is not None:  # as if the piece were g everywhere
            found.append(anywhere)
            continue
        for branch in where:
            if not branch.signs or (here := identity(goal, [*_sides(branch), *given])) is None:
                return ()
            found.append(here)
    return tuple(found)


@fact
def inward(subject: FormulaSubject) -> Identities:
    """Why the second derivative of g along every tangent is >= 0 on the boundary; none where that was not found."""
    law, forces = subject.law, subject.law.force_symbols()
    g, v = _settled(law, law.g), _components(law)
    if not g.is_polynomial(*forces):
        return ()
    tangent = _along(v, [sp.diff(g, x) for x in forces])
    given = [Condition(_BOUNDARY, g, "=="), Condition(_TANGENT, tangent, "=="), *_domain(law)]
    known = identity(Condition(_GOAL, -_along(v, [sp.diff(tangent, x) for x in forces]), ">"), given)
    return () if known is None else (known,)


@fact
def convex_sums(subject: FormulaSubject) -> Mapping[sp.Expr, Mapping[str, Any]]:
    """The sums in g that are convex polynomials in the forces though no composition, each with its identity."""
    law, forces, v = subject.law, subject.law.force_symbols(), _components(subject.law)
    found = {}
    for f in sorted(_settled(law, law.g).atoms(sp.Add), key=sp.default_sort_key):
        if not f.is_polynomial(*forces) or sp.Poly(f, *forces).total_degree() < 2 or sp.Poly(f, *forces).length() > _MOST_MONOMIALS:
            continue
        bend = _along(v, [sp.diff(_along(v, [sp.diff(f, x) for x in forces]), x) for x in forces])
        if (known := identity(Condition(_GOAL, -bend, ">"), _domain(law))) is not None:
            found[f] = known
    return found


def directions(law: Criterion) -> list[str]:
    """A name for the component of a direction along each force, which the law does not use."""
    prefix = "v_"
    while any(prefix + x in law.symbols() for x in law.forces):
        prefix = "v" + prefix
    return [prefix + x for x in law.forces]


def _settled(law: Criterion, expr: sp.Expr) -> sp.Expr:
    return expr.subs(law.settled())


def _pieces(expr: sp.Basic) -> Sequence[Branch]:
    try:
        return thick(branches(expr, _MOST_PIECES))
    except TooManyBranchesError:
        return ()


def _along(v: Sequence[sp.Expr], gradient: Sequence[sp.Expr]) -> sp.Expr:
    return sp.Add(*(x * d for x, d in zip(v, gradient, strict=True)))


def _components(law: Criterion) -> list[sp.Symbol]:
    return [sp.Symbol(name, real=True) for name in directions(law)]


def _sides(branch: Branch) -> Iterator[Condition]:
    for switch, sign in branch.signs.items():
        yield Condition(formula(sign * switch), sign * switch, ">=")


def _domain(law: Criterion) -> list[Condition]:
    """What the parameters and the pressure satisfy, as the kernel has it."""
    table, found = law.symbols(), []
    if law.pressure is not None:
        found.append((-table[law.pressure], ">"))
    for name, domain in law.parameters.items():
        x = table[name]
        if domain.value is None:
            found += [(x, ">")] if domain.positive else [] if domain.low is None else [(x - domain.low, ">=")]
            found += [] if domain.high is None else [(domain.high - x, ">=")]
    found += [(c.gts - c.lts, ">" if isinstance(c, sp.StrictGreaterThan | sp.StrictLessThan) else ">=") for c in law.constraints]
    return [Condition(formula(poly), poly, op) for poly, op in found]
