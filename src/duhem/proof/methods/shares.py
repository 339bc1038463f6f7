"""Evidence that a flow of the law's own dissipates: its power is a constant times g and something >= 0, so that it is >= 0 where g = 0.

Such is sqrt(J2) + beta I1 of a cone.  Where a tip of g is 0, as at an apex, the formula of the flow may have no value: there the slip
is any mean of limits of the flow from around (Koiter 1953), and the power of these is >= 0 too.  The kernel decides what is >= 0.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import replace

import sympy as sp

from duhem.expression.parse import parse_expression
from duhem.expression.text import formula
from duhem.proof.facts.formula_subject import FormulaSubject
from duhem.proof.statement.problem import by_degree
from duhem.proof.verdict import Evidence, Proof, Verdict

__all__ = ["dissipation", "dissipation_of_potential"]

Terms = Mapping[tuple[int, ...], sp.Expr]
_MOST_ROOTS, _MOST_SHARES = 4, 6


def dissipation(subject: FormulaSubject) -> Iterator[Evidence]:
    """sigma . d = c g + rest, for the constants c with which a term of the power goes."""
    law = subject.law
    if law.flow is None or law.surfaces or law.potential is not None:
        return
    forces, settled = law.force_symbols(), law.settled()
    g = law.g.xreplace(settled)
    power = sp.Add(*(x * d.xreplace(settled) for x, d in zip(forces, law.flow, strict=True)))
    roots = {y: sp.Dummy(f"r{i}", positive=True) for i, y in enumerate(_radicands(g + power, forces))}
    if len(roots) > _MOST_ROOTS or (of_power := _terms(power, forces, roots)) is None or (of_g := _terms(g, forces, roots)) is None:
        return
    back = {r: sp.sqrt(y) for y, r in roots.items()}
    variables = (*forces, *roots.values())
    for share in _shares(of_power, of_g):
        coefficients = {m: sp.factor(of_power.get(m, sp.S.Zero) - share * of_g.get(m, sp.S.Zero)) for m in {**of_power, **of_g}}
        rest = sp.Add(*(c * sp.Mul(*(x**n for x, n in zip(variables, m, strict=True))) for m, c in coefficients.items())).xreplace(back)
        detail = f"force . flow = {formula(share)}*g + {formula(rest)}, which is >= 0 wherever g = 0; at an apex so are the flow's limits"
        proof = Proof("power-share", {"share": formula(share), "rest": formula(rest)})
        yield Evidence(Verdict.PROVED, "power-share", detail, proof=proof)


def _radicands(expr: sp.Expr, forces: tuple[sp.Symbol, ...]) -> list[sp.Expr]:
    """What stands under square roots and depends on the forces."""
    powers = (p for p in expr.atoms(sp.Pow) if p.exp.is_Rational and p.exp.q == 2 and p.base.free_symbols & set(forces))
    return sorted({p.base for p in powers}, key=sp.default_sort_key)


def _terms(expr: sp.Expr, forces: tuple[sp.Symbol, ...], roots: Mapping[sp.Expr, sp.Symbol]) -> Terms | None:
    """The coefficients by powers of forces and roots r, r^2 put for what is under them; None where it is no such polynomial."""
    plain = expr.replace(lambda p: p.is_Pow and p.base in roots and p.exp.is_Rational, lambda p: roots[p.base] ** (2 * p.exp))
    over, under = sp.fraction(sp.together(plain))
    if not all(part.is_polynomial(*forces, *roots.values()) for part in (over, under)):
        return None
    for y, r in roots.items():
        over = sp.reduced(over, [y - r**2], *forces)[1] if y.is_polynomial(*forces) else over
    whole = sp.cancel(over / under)
    if not whole.is_polynomial(*forces, *roots.values()):
        return None
    return dict(sp.Poly(whole, *forces, *roots.values()).terms())


def _shares(power: Terms, g: Terms) -> Iterator[sp.Expr]:
    """Constants with which a term of the power goes, 0 first."""
    ratios = (sp.cancel(power.get(m, sp.S.Zero) / c) for m, c in g.items() if any(m))
    yield from [*dict.fromkeys([sp.S.Zero, *ratios])][:_MOST_SHARES]


def dissipation_of_potential(subject: FormulaSubject) -> Iterator[Evidence]:
    """A flow that is the gradient of a potential P has sigma . d = sum of k P_k; where g = 0 a multiple of g may be taken from it.

    So it is for every mean of gradients that meet at a kink or a tip, of which the formula of the flow says nothing.
    """
    law, problem = subject.law, subject.problem
    if law.potential is None:
        return
    potential = parse_expression(law.potential, law.symbols()).subs({**law.settled(), **problem.compressed})
    if (parts := by_degree(replace(problem, g=potential))) is None:
        return
    power, g = (_by_forces(expr, problem.forces) for expr in (sp.Add(*(k * part for k, part in parts.items())), problem.g))
    degrees = ", ".join(map(str, sorted(parts)))
    detail = f"the potential has parts of degree {degrees} in the forces, so force . flow >= 0 wherever g = 0"
    for share in dict.fromkeys([sp.S.Zero, *(sp.cancel(power[part] / c) for part, c in g.items() if part in power and part != 1)]):
        yield Evidence(Verdict.PROVED, "potential", detail, proof=Proof("potential", {"share": formula(_in_pressure(subject, share))}))


def _by_forces(expr: sp.Expr, forces: tuple[sp.Symbol, ...]) -> Mapping[sp.Expr, sp.Expr]:
    """The terms of a sum: what depends on the forces, and its coefficient."""
    found: dict[sp.Expr, sp.Expr] = {}
    for term in sp.Add.make_args(sp.expand(expr, deep=False)):
        scale, part = term.as_independent(*forces, as_Add=False)
        found[part] = found.get(part, sp.S.Zero) + scale
    return found


def _in_pressure(subject: FormulaSubject, expr: sp.Expr) -> sp.Expr:
    """In the law's own names."""
    magnitude, pressure = subject.problem.magnitude, subject.law.pressure
    return expr if magnitude is None or pressure is None else expr.xreplace({magnitude: -subject.law.symbols()[pressure]})
