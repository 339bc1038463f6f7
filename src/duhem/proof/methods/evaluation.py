"""What direct evaluation decides: g at the origin, and rational points where an inequality fails."""

from __future__ import annotations

from fractions import Fraction

import sympy as sp

from duhem.expression.text import formula
from duhem.proof.decide import Sense
from duhem.proof.facts.case import Case
from duhem.proof.verdict import Evidence, Verdict, Witness
from duhem.proof.witness.rational_points import decimal_pair, describe, sign_at

__all__ = ["origin", "origin_refuted"]


def origin(case: Case) -> Evidence | None:
    """g(0) <= 0 for every pressure and parameter."""
    if case.at_origin is None:
        return None
    answer = case.ask(-case.at_origin, Sense.NONNEGATIVE)
    if answer.holds is not True:
        return None
    stated = case.law.g.xreplace(dict.fromkeys(case.law.force_symbols(), sp.S.Zero))
    return Evidence(Verdict.PROVED, f"evaluation ({answer.method})", f"g(0) = {formula(stated)} <= 0")


def origin_refuted(case: Case) -> Evidence | None:
    """Parameters at which g(0) > 0."""
    zero = [Fraction(0)] * len(case.simple.forces)
    hint = None if case.at_origin is None else case.ask(-case.at_origin, Sense.NONNEGATIVE).point
    for parameters in case.choices(40, [hint] if hint else []):
        values = case.values_at(parameters, zero)
        sign, enclosure = sign_at(case.problem.g, values)
        if sign == 1:
            witness = Witness(
                describe(case, values, forces=False),
                {"origin": describe(case, values)},
                {"g(0)": decimal_pair(enclosure)},
                "g > 0 at zero force: 0 is not in K",
            )
            return Evidence(Verdict.REFUTED, "witness-point", "zero force is outside K", witness)
    return None
