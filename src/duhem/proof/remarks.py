"""What is said beside the verdicts: what each ranges over, which parts a law does not need, what holds with an exception."""

from __future__ import annotations

from collections.abc import Iterable, Iterator

import sympy as sp

from duhem.expression.text import formula
from duhem.law.curve_law import Law
from duhem.left_out import LeftOut
from duhem.proof.facts.formula_subject import FormulaSubject
from duhem.proof.facts.regularity import regularity
from duhem.proof.facts.subject import Subject
from duhem.proof.verdict import Verdict

__all__ = ["not_needed", "remarks", "scope"]


def scope(law: Law, verdict: Verdict) -> str:
    """The parameters over which a verdict holds."""
    if verdict is Verdict.REFUTED:
        return "at the witness"
    if verdict is Verdict.TESTED:
        return "sampled parameters"
    fixed = [f"{n} = {d.value}" for n, d in law.parameters.items() if d.value is not None]
    if not fixed:
        return "all parameters"
    return f"all other parameters, {', '.join(fixed)}" if len(fixed) < len(law.parameters) else ", ".join(fixed)


def not_needed(law: Law, verdicts: Iterable[Verdict]) -> Iterator[LeftOut]:
    """Parts of the examination that this law, or what was decided of it, makes needless."""
    yield LeftOut("thermal", "isothermal law: no temperature among its variables, so D_th and the entropy do not enter")
    if law.flow is None:
        yield LeftOut("flow check", "associated law: the slip is the normality rule itself")
    if law.pressure is None:
        yield LeftOut("pressure", "the law has none: K is one set")
    if len(law.forces) == 1:
        yield LeftOut("seams", "one force: the boundary has no seam to cross")
    if not any(verdict in (Verdict.REFUTED, Verdict.TESTED) for verdict in verdicts):
        yield LeftOut("numerical search", "every examined claim was settled by proof")


def remarks(subject: Subject) -> tuple[str, ...]:
    """Statements often made of such laws that hold only with an exception."""
    if not isinstance(subject, FormulaSubject):
        return ()
    problem, law = subject.problem, subject.law
    facts = regularity(problem.g, subject)
    tips = sorted({formula(_stated(subject, tip)) for tip in facts.tips}) if facts.known and not facts.kinks else []
    if not tips:
        return ()
    at_zero = problem.g.xreplace(dict.fromkeys(problem.forces, sp.S.Zero))
    place = f"where {', '.join(tips)} = 0"
    inside = "; that point is inside K for sigma_n < 0, so the boundary is not touched" if law.pressure and at_zero.is_negative else ""
    return (f"'g is differentiable' holds with one exception: not {place}{inside}",)


def _stated(subject: FormulaSubject, expr: sp.Expr) -> sp.Expr:
    """An expression of the problem in the law's own names."""
    magnitude, pressure = subject.problem.magnitude, subject.law.pressure
    return expr if magnitude is None or pressure is None else expr.xreplace({magnitude: sp.Abs(sp.Symbol(pressure, real=True))})
