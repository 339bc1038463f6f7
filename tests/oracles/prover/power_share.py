"""Dissipation of a flow of the law's own whose power is a constant times g and something >= 0, such as sqrt(J2) + beta I1 of a cone.

Where a tip of g is 0, as at an apex, the formula of such a flow may have no value: there the slip is any mean of limits of the flow from
around (Koiter 1953).  Their power is >= 0 too, for what is >= c g around is so in the limit.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping

import sympy as sp

from duhem.expression.text import formula
from duhem.proof.decide import Question, Sense
from duhem.proof.facts.definedness import open_obligations
from duhem.proof.facts.formula_subject import FormulaSubject
from duhem.proof.verdict import Evidence, Proof, Verdict
from tests.oracles.prover.regularity import regularity

__all__ = ["dissipation"]

Terms = Mapping[tuple[int, ...], sp.Expr]
_MOST_ROOTS, _MOST_SHARES = 4, 6


def dissipation(subject: FormulaSubject) -> Evidence | None:
    """sigma . d = c g + something >= 0, so that it is >= 0 wherever g = 0."""
    law, problem = subject.law, subject.problem
    if law.flow is None or law.surfaces or law.potential is not None or subject.doubtful or not subject.joined(problem.g):
        return None
    if not _defined_but_at_tips(subject):
        return None
    forces, settled = law.force_symbols(), law.settled()
    g = law.g.xreplace(settled)
    power = sp.Add(*(x * d.xreplace(settled) for x, d in zip(forces, law.flow, strict=True)))
    roots = {y: sp.Dummy(f"r{i}", positive=True) for i, y in enumerate(_radicands(g + power, forces))}
    if len(roots) > _MOST_ROOTS or (found := [_terms(expr, forces, roots) for expr in (power, g)]).count(None):
        return None
    back = {r: sp.sqrt(y) for y, r in roots.items()}
    variables = (*forces, *roots.values())
    for share in _shares(*(terms for terms in found if terms is not None)):
        of_power, of_g = (terms or {} for terms in found)
        coefficients = {m: sp.factor(of_power.get(m, sp.S.Zero) - share * of_g.get(m, sp.S.Zero)) for m in {**of_power, **of_g}}
        rest = sp.Add(*(c * sp.Mul(*(x**n for x, n in zip(variables, m, strict=True))) for m, c in coefficients.items())).xreplace(back)
        answer = subject.decided(Question(rest.xreplace(problem.compressed), Sense.NONNEGATIVE, problem.given))
        if answer.holds is True:
            detail = (
                f"force . flow = {formula(share)}*g + {formula(rest)}, which is >= 0 wherever g = 0; at an apex so are the flow's limits"
            )
            proof = Proof("power-share", {"share": formula(share), "rest": formula(rest)})
            return Evidence(Verdict.PROVED, f"power-share ({answer.method})", detail, proof=proof)
    return None


def _defined_but_at_tips(subject: FormulaSubject) -> bool:
    """Whether the flow has a value wherever tips of g, which are 0 on no open set, are not 0."""
    problem, found = subject.problem, regularity(subject.problem.g, subject)
    if not subject.doubtful_flow:
        return True
    tips = [tip for tip in found.tips if _rarely_zero(tip, problem.forces)] if found.known and not found.kinks else []
    there = tuple(sp.StrictGreaterThan(tip, 0) for tip in tips)
    return bool(there) and not any(open_obligations(subject, problem, trees, there) for trees in problem.stated_flows)


def _rarely_zero(tip: sp.Expr, forces: tuple[sp.Symbol, ...]) -> bool:
    return bool(tip.is_polynomial(*forces) and any(c.is_number for c in sp.Poly(tip, *forces).coeffs()))


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
