"""Unilateral contact with friction as one law: whether K grows as the pressure does, and de Saxcé's bipotential.

With p = |sigma_n| >= 0, the opening rate v_n >= 0, p v_n = 0, and K(sigma_n) = p K_1, b(d, v_n; sigma, p) = I(sigma in p K_1) +
I(v_n >= 0) + p Phi_1(d) with the support function Phi_1 of K_1.  So b - (sigma . d - p v_n) = (p Phi_1(d) - sigma . d) + p v_n >= 0, and 0
exactly on the law.  (d, -v_n) would be normal to the cone {sigma in p K_1} with v_n = Phi_1(d) (de Saxcé, Feng 1991).
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import replace
from fractions import Fraction
from functools import partial
from itertools import product

import sympy as sp

from duhem.expression.number import rational
from duhem.expression.text import formula
from duhem.proof.facts.formula_subject import FormulaSubject
from duhem.proof.facts.subject import Subject, Values
from duhem.proof.verdict import Evidence, Proof, Verdict
from duhem.proof.witness.points import decimal_pair, sign_at, witness

__all__ = ["bipotential", "bipotential_left_open", "bipotential_of_no_cone", "homogeneity_along_rays", "polar_of_the_cone"]

_LOADS = tuple(Fraction(2) ** k for k in (0, 1, 10, -10, 20, -20))
_BESIDE = tuple(Fraction(n, 1000) for n in (875, 1125, 995, 1005))  # of where K ends
_FARTHEST, _HALVINGS, _MOST_CHOICES = Fraction(2) ** 40, 24, 4
_STRETCHED = "g <= 0 at `inside` and g > 0 at `outside`, which is a multiple of it, pressure included: K(sigma_n) is not |sigma_n| K(-1)"
_SUM = "so b - (sigma . d - p v_n) = (p Phi_1(d) - sigma . d) + p v_n >= 0, and 0 exactly if p v_n = 0 and d is normal to K at sigma"
_PREMISES = ("homogeneity", "origin", "convexity", "normality")
_ABOVE = "The slip d of the law at this point has p Phi_1(d) >= tau . d > sigma . d, so that b > sigma . d - p v_n on the law itself: "


def homogeneity_along_rays(subject: FormulaSubject) -> Evidence | None:
    """A ray of forces and pressure together that leaves K, or why the claim means nothing."""
    law, g, load = subject.law, subject.problem.stated, subject.problem.magnitude
    if law.pressure is None or load is None or law.viscous:
        reason = "rates that derive from a potential have no K" if law.viscous else "the law has no pressure"
        return Evidence(Verdict.NOT_APPLICABLE, "none", reason)
    zero, span = [Fraction(0)] * len(subject.simple.forces), law.domain.get(law.pressure)
    first, *loads = [p for p in _LOADS if span is None or rational(-p) in span] or _LOADS
    for values, x, sense in product(subject.choices(_MOST_CHOICES), subject.problem.forces, (1, -1)):
        base = subject.values_at(values, zero)

        def at(share: Fraction, p: Fraction, base: Values = base, x: sp.Symbol = x, sense: int = sense) -> Values:
            return {**base, load: p, x: sense * share * p}

        end = _end(g, partial(at, p=first))
        for p, beside in product(loads, _BESIDE):
            share = (end * beside).limit_denominator(10_000)
            ordered = sorted((at(share, q) for q in (first, p)), key=lambda point: sign_at(g, point)[0] or 0)
            points = dict(zip(("inside", "outside"), ordered, strict=True))
            signs = {role: sign_at(g, point) for role, point in points.items()}
            if [sign for sign, _ in signs.values()] == [-1, 1]:
                shown = {f"g({role})": decimal_pair(enclosure) for role, (_, enclosure) in signs.items()}
                found = witness(subject, points, shown, _STRETCHED)
                return Evidence(Verdict.REFUTED, "witness-ray", "K is not proportional to the pressure", found)
    return None


def _end(g: sp.Expr, at: Callable[[Fraction], Values]) -> Fraction:
    """Where K seems to end along a force: as a share of the pressure."""
    low, high = Fraction(0), Fraction(1)
    while high < _FARTHEST and sign_at(g, at(high))[0] == -1:
        low, high = high, 2 * high
    for _ in range(_HALVINGS):
        middle = (low + high) / 2
        low, high = (middle, high) if sign_at(g, at(middle))[0] == -1 else (low, middle)
    return low


def bipotential_of_no_cone(subject: Subject, settled: Mapping[str, Evidence]) -> Evidence | None:
    """Nothing where K is not proportional to the pressure; refuted where the slip of the law is not normal to K."""
    cone, normal = settled["homogeneity"], settled["normality"]
    if cone.verdict in (Verdict.REFUTED, Verdict.NOT_APPLICABLE):
        return Evidence(Verdict.NOT_APPLICABLE, "none", f"b is made with the gauge of K_1, and the law has none: {cone.detail}")
    if cone.verdict is Verdict.PROVED and normal.witness is not None:
        against = replace(normal.witness, statement=_ABOVE + normal.witness.statement)
        return Evidence(Verdict.REFUTED, normal.method, "the law slips where b > sigma . d - p v_n", against)
    return None


def bipotential(subject: Subject) -> Iterator[Evidence]:
    """What the kernel confirms where it has confirmed each premise: with Phi_1 in closed form, by definition, or of a smooth K."""
    closed = polar_of_the_cone(subject)
    for rule in ("polar-gauge", "support-function", "one-normal"):
        known = f"Phi_1(d) = {closed[0]}" if closed and rule == "polar-gauge" else "Phi_1 is the support function of K_1"
        yield Evidence(Verdict.PROVED, rule, f"{known}, {_SUM}", proof=Proof(rule))


def bipotential_left_open(subject: Subject, settled: Mapping[str, Evidence]) -> Evidence:
    """What it rests on and is not proved."""
    left = [f"{name} ({settled[name].verdict.replace('_', ' ')})" for name in _PREMISES if settled[name].verdict is not Verdict.PROVED]
    missing = f"not proved: {', '.join(left)}" if left else "not all of them are confirmed by the kernel"
    return Evidence(Verdict.UNDECIDED, "none", f"b rests on {', '.join(_PREMISES)}; {missing}")


def polar_of_the_cone(subject: Subject) -> tuple[str, tuple[str, ...]] | None:
    """Phi_1(d) and the forms of d that vanish where it is finite, as text, for whoever knows that both are proved."""
    if not isinstance(subject, FormulaSubject) or subject.law.pressure is None or (found := subject.support) is None:
        return None
    unit = found.potential.xreplace({subject.law.symbols()[subject.law.pressure]: sp.S.NegativeOne})
    return formula(unit), tuple(map(formula, found.domain))
