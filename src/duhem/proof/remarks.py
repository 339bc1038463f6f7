"""What is said beside the verdicts: what each ranges over, which parts a law does not need, what is odd about it."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping

import sympy as sp

from duhem.expression.text import formula
from duhem.law.curve_law import Law
from duhem.law.formula_law import Criterion
from duhem.left_out import LeftOut
from duhem.proof.facts.extent import Extent, extent
from duhem.proof.facts.formula_subject import FormulaSubject
from duhem.proof.facts.special_places import limits_taken, singular_places, undefined_place
from duhem.proof.facts.subject import Subject
from duhem.proof.verdict import CONTRADICTION, Evidence, Verdict

__all__ = ["not_needed", "remarks", "scope"]

_CONTINUED = "Where g is 0/0 and has a limit, it is read as that limit, for K is closed. "
_NOT_SHOWN_OF_THE_FLOW = "It is not shown that the flow has a value on all of the boundary"
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
    return (*found, *_oddities(subject, odd, settled), *_singular(subject)), odd is not None and not odd.boundary


def _oddities(subject: FormulaSubject, odd: Extent | None, settled: Mapping[str, Evidence]) -> Iterator[str]:
    law = subject.law
    proved = any(evidence.verdict is Verdict.PROVED for claim, evidence in settled.items() if claim != "state_laws")
    if subject.doubtful:
        first = subject.doubtful[0]
        place = undefined_place(subject, first)
        yield (
            f"It is not shown that g has a value for all forces: it {first.does} {formula(_stated(subject, first.expr))}. "
            + (f"g has no value {place}. " if place else "")
            + (_CONTINUED if proved else "A point at which g has no value is not in K. ")
            + "Of such a formula nothing is proved but what the kernel confirms"
        )
    elif subject.doubtful_flow:
        broken = next(((o, at) for o in subject.doubtful_flow if (at := subject.broken_at(o)) is not None), None)
        first = broken[0] if broken else subject.doubtful_flow[0]
        part = formula(_stated(subject, first.expr))
        has = f"The flow has no value at {_admitted(subject, broken[1])}" if broken else _NOT_SHOWN_OF_THE_FLOW
        yield f"{has}: it {first.does} {part}. Of such a flow nothing is proved but what the kernel confirms"
    if proved:
        yield from limits_taken(subject)
    if odd is not None:
        yield odd.what
    flows = (law.flow, *(surface.flow for surface in law.surfaces))
    used = law.g.free_symbols.union(*(c.free_symbols for flow in flows for c in flow or ()))
    if unused := [name for name, x in law.symbols().items() if x not in used]:
        yield f"g does not depend on {', '.join(unused)}"


def _singular(subject: FormulaSubject) -> Iterator[str]:
    """Where g is not differentiable, and that K's boundary does not touch the place if that is so."""
    pressure = subject.law.pressure
    for place in singular_places(subject):
        where = ", ".join(f"{x} = {formula(_stated(subject, value))}" for x, value in place.forces.items() if value != x)
        points = "those points are" if any(value.free_symbols & set(place.forces) for value in place.forces.values()) else "that point is"
        inside = f"; {points} inside K{f' for {pressure} < 0' if pressure else ''}, so the boundary is not touched" if place.inside else ""
        yield f"g is not differentiable at {'zero force' if place.zero_force else where}{inside}"


def _admitted(subject: FormulaSubject, values: Mapping[sp.Symbol, sp.Rational]) -> str:
    """Values of parameters and of the size of the pressure, in the law's own names."""
    magnitude, pressure = subject.problem.magnitude, subject.law.pressure
    return ", ".join(f"{pressure} = {-v}" if x is magnitude else f"{x} = {v}" for x, v in values.items())


def _stated(subject: FormulaSubject, expr: sp.Expr) -> sp.Expr:
    """An expression of the problem in the law's own names."""
    magnitude, pressure = subject.problem.magnitude, subject.law.pressure
    return expr if magnitude is None or pressure is None else expr.xreplace({magnitude: sp.Abs(sp.Symbol(pressure, real=True))})
