"""The exact check that makes a refutation: signs of g at rational points, in balls of rising precision.

Nothing is refuted by a float.  A candidate is made rational, evaluated in the law as stated (no simplification), and
kept only if every sign is certain; where one stays open the candidate is dropped.
"""

from __future__ import annotations

from collections.abc import Sequence
from decimal import ROUND_CEILING, ROUND_FLOOR, Context, Decimal
from fractions import Fraction
from typing import Any

import sympy as sp

from duhem.expression.balls import ball, certain_sign, enclose, precision
from duhem.expression.number import fraction
from duhem.proof.facts.formula_subject import FormulaSubject
from duhem.proof.facts.parameter_choices import Values, rationals
from duhem.proof.verdict import Witness

__all__ = ["chord", "decimal_pair", "describe", "origin_outside", "sign_at"]

_PRECISIONS = (64, 128, 256, 512, 1024, 2048)


def sign_at(expr: sp.Expr, values: Values, exact: bool = False) -> tuple[int | None, Any]:
    """Certain sign of ``expr`` at exact values (None if no precision settles it) and the enclosure that shows it.

    If ``exact``, also of what is 0 as a fraction, which balls cannot tell.
    """
    enclosure = None
    for bits in _PRECISIONS:
        with precision(bits):
            enclosure = enclose(expr, {x: ball(v) for x, v in values.items()})
            if (sign := certain_sign(enclosure)) is not None:
                return sign, enclosure
    if exact and enclosure is not None and enclosure.is_finite():
        number = expr.xreplace(rationals(values))
        if number.is_Rational:
            return int(sp.sign(number)), ball(fraction(number))
    return None, enclosure


def chord(
    subject: FormulaSubject, parameters: Values, p: Sequence[Fraction], q: Sequence[Fraction], touching: bool = False
) -> Witness | None:
    """Non-convexity: g(p) <= 0, g(q) <= 0 and g > 0 at the midpoint, or None if that is not certain.

    If ``touching``, points on the boundary count too where their coordinates show it in fractions.
    """
    middle = [(a + b) / 2 for a, b in zip(p, q, strict=True)]
    points = {
        "p": subject.values_at(parameters, p),
        "q": subject.values_at(parameters, q),
        "midpoint": subject.values_at(parameters, middle),
    }
    if not subject.admits(points["p"]):
        return None
    shown = {}
    for role, values in points.items():
        sign, enclosure = sign_at(subject.problem.stated, values, touching)
        if sign is None or (sign > 0) != (role == "midpoint"):
            return None
        shown[f"g({role})"] = decimal_pair(enclosure)
    return Witness(
        parameters=describe(subject, points["p"], forces=False),
        points={role: describe(subject, values) for role, values in points.items()},
        values=shown,
        statement="g(p) <= 0 and g(q) <= 0, yet g > 0 at the midpoint of p and q: {g <= 0} is not convex",
    )


def origin_outside(subject: FormulaSubject, parameters: Values) -> Witness | None:
    """g(0) > 0 at admitted parameters, or None if that is not certain."""
    values = subject.values_at(parameters, [Fraction(0)] * len(subject.simple.forces))
    sign, enclosure = sign_at(subject.problem.stated, values)
    if sign != 1:
        return None
    return Witness(
        parameters=describe(subject, values, forces=False),
        points={"origin": describe(subject, values)},
        values={"g(0)": decimal_pair(enclosure)},
        statement="g > 0 at zero force: 0 is not in K",
    )


def describe(subject: FormulaSubject, values: Values, forces: bool = True) -> dict[str, str]:
    """Exact strings by name: forces and pressure, or the parameters."""
    law = subject.law
    if forces:
        named = {str(x): str(values[x]) for x in subject.problem.forces}
        if law.pressure is not None and subject.problem.magnitude is not None:
            named[law.pressure] = str(-values.get(subject.problem.magnitude, Fraction(1)))
        return named
    table = law.symbols()
    return {name: str(values[table[name]]) for name in law.parameters if table[name] in values}


def decimal_pair(enclosure: Any) -> tuple[str, str]:
    """The ends of a ball in decimal with 17 digits, rounded outward."""
    ends = []
    for end, rounding in ((enclosure.lower(), ROUND_FLOOR), (enclosure.upper(), ROUND_CEILING)):
        exact = end.fmpq()
        context = Context(prec=17, rounding=rounding)
        ends.append(str(context.divide(Decimal(int(exact.p)), Decimal(int(exact.q)))))
    return ends[0], ends[1]
