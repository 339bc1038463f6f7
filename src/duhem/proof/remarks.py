"""What is said beside the verdicts: what each ranges over, which parts a law does not need, what is odd about it."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping

import sympy as sp

from duhem.expression.parse import parse_expression
from duhem.expression.text import formula
from duhem.law.curve_law import Law
from duhem.law.formula_law import Criterion
from duhem.left_out import LeftOut
from duhem.proof.facts.definedness import broken_at
from duhem.proof.facts.extent import Extent, extent
from duhem.proof.facts.formula_subject import FormulaSubject
from duhem.proof.facts.subject import Subject
from duhem.proof.facts.undefined import undefined_place
from duhem.proof.kernel.certificate import stated
from duhem.proof.kernel.curvature import over
from duhem.proof.kernel.domain import StatedLaw
from duhem.proof.kernel.regularity import tips
from duhem.proof.kernel.steps import TooDearError, within
from duhem.proof.kernel.term import UNREADABLE, Term
from duhem.proof.law_text import law_as_text
from duhem.proof.verdict import CONTRADICTION, Evidence, Verdict

__all__ = ["not_needed", "remarks", "scope"]

_CONTINUED = "where it is 0/0 but has a limit, it is read as that limit (K is closed), and of the formula so read "
_STEPS = 8_000_000  # for what is asked here and in no claim


def scope(law: Law, verdict: Verdict) -> str:
    """The parameters, and ranges of pressure and forces, over which a verdict holds."""
    if verdict is Verdict.REFUTED:
        return "at the witness"
    if verdict is Verdict.TESTED:
        return "sampled parameters"
    fixed = [f"{n} = {d.value}" for n, d in law.parameters.items() if d.value is not None]
    ranges = [d.stated(n) for n, d in law.domain.items()] if isinstance(law, Criterion) else []
    every = [] if fixed and len(fixed) == len(law.parameters) else ["all other parameters" if fixed else "all parameters"]
    return ", ".join([*every, *fixed, *ranges])


def not_needed(law: Law, verdicts: Iterable[Verdict]) -> Iterator[LeftOut]:
    """Parts of the examination that this law, or what was decided of it, makes needless."""
    yield LeftOut("thermal", "isothermal law: no temperature among its variables, so D_th and the entropy do not enter")
    if law.associated:
        yield LeftOut("flow check", "associated law: the slip is the normality rule itself")
    if law.pressure is None:
        yield LeftOut("pressure", "the law has none: K is one set")
    if len(law.forces) == 1:
        yield LeftOut("seams", "one force: the boundary has no seam to cross")
    found = set(verdicts)
    if Verdict.PROVED in found and found <= {Verdict.PROVED, Verdict.NOT_APPLICABLE}:
        yield LeftOut("numerical search", "every examined claim was settled by proof")


def remarks(subject: Subject, settled: Mapping[str, Evidence]) -> tuple[tuple[str, ...], bool]:
    """What a reader should know first: defects, what is odd about the law, and what holds of it with an exception.

    And whether K has no boundary point but 0, so that nothing is said when nothing is found to dissipate less than 0.
    """
    found = tuple(f"{claim}: {evidence.detail}" for claim, evidence in settled.items() if evidence.method == CONTRADICTION)
    if not isinstance(subject, FormulaSubject):
        return found, False
    subject.allow(_STEPS)
    odd = extent(subject)
    return (*found, *_oddities(subject, odd, settled), *_tips(subject)), odd is not None and not odd.boundary


def _oddities(subject: FormulaSubject, odd: Extent | None, settled: Mapping[str, Evidence]) -> Iterator[str]:
    law = subject.law
    if subject.doubtful:
        first = subject.doubtful[0]
        part = formula(_stated(subject, first.expr))
        place = undefined_place(subject, first)
        proved = any(evidence.verdict is Verdict.PROVED for claim, evidence in settled.items() if claim != "state_laws")
        yield (
            f"g may be undefined for some forces: it {first.does} {part}; "
            + (_CONTINUED if proved else "where it is, the point is not in K, and of such a formula ")
            + "nothing is proved but what the kernel confirms"
            + (place and f". It may be undefined {place}")
        )
    elif subject.doubtful_flow:
        broken = next(((o, at) for o in subject.doubtful_flow if (at := broken_at(subject.problem, o)) is not None), None)
        first = broken[0] if broken else subject.doubtful_flow[0]
        part = formula(_stated(subject, first.expr))
        yield (
            f"the flow {f'has no value at {_admitted(subject, broken[1])}' if broken else 'may be undefined on the boundary'}: "
            f"it {first.does} {part}; "
            "of such a flow nothing is proved but what the kernel confirms"
        )
    if odd is not None:
        yield odd.what
    flows = (law.flow, *(surface.flow for surface in law.surfaces))
    used = law.g.free_symbols.union(*(c.free_symbols for flow in flows for c in flow or ()))
    if unused := [name for name, x in law.symbols().items() if x not in used]:
        yield f"g does not depend on {', '.join(unused)}"


def _tips(subject: FormulaSubject) -> Iterator[str]:
    law = subject.law
    tips = _singular(subject)
    if not tips:
        return
    certain = subject.at_origin is not None and subject.at_origin.is_negative
    place = f"where {', '.join(tips)} = 0"
    inside = f"; that point is inside K for {law.pressure} < 0, so the boundary is not touched" if law.pressure and certain else ""
    yield f"'g is differentiable' holds with one exception: not {place}{inside}"


def _singular(subject: FormulaSubject) -> list[str]:
    """What is 0 where g may fail to be differentiable, as the kernel sees it; none where it sees more than such tips."""
    law, compressed = subject.law, subject.problem.compressed
    with within(_STEPS):
        try:
            seen = stated(law_as_text(law))
            found = tips(seen.g, over(seen)) if isinstance(seen, StatedLaw) else frozenset[Term]()
        except (*UNREADABLE, TooDearError):
            return []
    read = (parse_expression(_text(tip), law.symbols()).xreplace(compressed) for tip in found)
    return sorted({formula(_stated(subject, _without_powers(tip, subject))) for tip in read})


def _without_powers(tip: sp.Expr, subject: FormulaSubject) -> sp.Expr:
    """What is 0 where the tip is: what stands under a root or a power, without factors in which there is no force."""
    tip = tip.as_independent(*subject.problem.forces, as_Add=False)[1]
    return _without_powers(tip.base, subject) if tip.is_Pow and tip.exp.is_positive else tip


def _text(term: Term) -> str:
    """A term as a formula that can be read again."""
    parts = [_text(a) for a in term.args]
    if term.op == "number":
        return f"({term.value})"
    if term.op == "name":
        return term.name
    return f"({f' {term.op} '.join(parts)})" if term.op in ("+", "*", "**", "<", "<=", ">", ">=") else f"{term.op}({', '.join(parts)})"


def _admitted(subject: FormulaSubject, values: Mapping[sp.Symbol, sp.Rational]) -> str:
    """Values of parameters and of the size of the pressure, in the law's own names."""
    magnitude, pressure = subject.problem.magnitude, subject.law.pressure
    return ", ".join(f"{pressure} = {-v}" if x is magnitude else f"{x} = {v}" for x, v in values.items())


def _stated(subject: FormulaSubject, expr: sp.Expr) -> sp.Expr:
    """An expression of the problem in the law's own names."""
    magnitude, pressure = subject.problem.magnitude, subject.law.pressure
    return expr if magnitude is None or pressure is None else expr.xreplace({magnitude: sp.Abs(sp.Symbol(pressure, real=True))})
