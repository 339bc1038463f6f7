"""Functions of J2 and J3 in a law: what tensor its forces are, and what such functions are on the hydrostatic axis, by continuity."""

from __future__ import annotations

from collections.abc import Callable

import sympy as sp

from duhem.expression import defined_at
from duhem.proof.decide import Sense
from duhem.proof.facts.formula_subject import FormulaSubject
from duhem.proof.facts.subject import fact
from tests.oracles.prover.section import Meaning, meaning_of

__all__ = ["asked", "limit_at_origin", "meaning", "on_axis", "positive_off_axis"]


@fact
def _meaning(subject: FormulaSubject) -> tuple[Meaning | None]:
    return (meaning_of(subject.simple.g, subject.law.force_symbols(), subject.simple.forces),)


def asked(subject: FormulaSubject) -> Callable[..., bool]:
    """Who says whether an expression is >= 0, or > 0, where relations hold; False also when it is undecided."""

    def holds(expr: sp.Expr, *given: sp.Basic, strict: bool = False) -> bool:
        return subject.ask(expr, Sense.POSITIVE if strict else Sense.NONNEGATIVE, *given).holds is True

    return holds


def meaning(subject: FormulaSubject) -> Meaning | None:
    """What tensor the forces of the simple problem are, if J2 of one stands in it."""
    return _meaning(subject)[0]


def limit_at_origin(subject: FormulaSubject) -> sp.Expr | None:
    """g at zero force, by continuity where it is undefined there: functions of J2 and J3 are 0."""
    tensor = meaning(subject)
    if subject.at_origin is not None or tensor is None:
        return subject.at_origin
    return defined_at(tensor.emptied(subject.simple.g), dict.fromkeys(subject.simple.forces, sp.S.Zero))


def positive_off_axis(subject: FormulaSubject, expr: sp.Expr) -> bool:
    """Whether an expression is a function of J2 and J3 that is > 0 where J2 is."""
    tensor = meaning(subject)
    section = None if tensor is None else tensor.read(expr)
    return section is not None and section.positive(asked(subject))


def on_axis(subject: FormulaSubject, expr: sp.Expr, tip: sp.Expr) -> sp.Expr | None:
    """An expression, by continuity, where ``tip`` is 0, if that is where J2 = 0 alone."""
    tensor = meaning(subject)
    return tensor.emptied(expr) if tensor is not None and positive_off_axis(subject, tip) else None
