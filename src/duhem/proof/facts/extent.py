"""Sets that are hardly what was meant: nothing, everything, one point, no inside, no end.  Suspected at a few points, then proved."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction
from itertools import product

import sympy as sp

from duhem.expression.balls import ball, certain_sign, enclose
from duhem.proof.decide import Sense
from duhem.proof.facts.formula_subject import FormulaSubject
from duhem.proof.facts.parameter_choices import Values
from duhem.proof.facts.subject import fact
from duhem.proof.statement.problem import as_written

__all__ = ["Extent", "extent"]

_NEAR, _FAR = Fraction(1, 2**20), Fraction(2**40)
_MOST_FORCES = 3  # of the directions along which it looks there are 3^n


@dataclass(frozen=True)
class Extent:
    """``what`` K is for every parameter value and pressure; ``boundary`` False where it has no boundary point but 0."""

    what: str
    boundary: bool


@fact
def extent(subject: FormulaSubject) -> Extent | None:
    """What is out of the ordinary about K, proved; None where nothing is, or nothing is shown."""
    if subject.doubtful:
        return None
    problem, forces = subject.simple, subject.simple.forces
    away = sp.StrictGreaterThan(sp.Add(*(x**2 for x in forces)), 0)
    signs = _signs(subject)
    outside = {s for reach, _, s in signs if reach}
    if outside == {1} and subject.ask(problem.g, Sense.POSITIVE, away).holds is True:
        if subject.at_origin is not None and subject.positive(subject.at_origin):
            return Extent(f"K is empty: g > 0 for all forces{_cause(subject)}", False)
        if subject.at_origin is not None and subject.nonnegative(-subject.at_origin):
            return Extent(_point(subject), False)
        return None
    if outside <= {0, -1} and subject.ask(-problem.g, Sense.NONNEGATIVE).holds is True:
        return Extent("K is everything: g <= 0 for all forces", False)
    if {s for *_, s in signs} <= {0, 1} and subject.ask(problem.g, Sense.NONNEGATIVE).holds is True:
        return Extent("K has no inside: g >= 0 for all forces", True)
    return _unbounded(subject, [way for reach, way, s in signs if reach == _FAR and s in (-1, 0)])


def _signs(subject: FormulaSubject) -> list[tuple[Fraction, tuple[int, ...], int | None]]:
    """Signs of g at one parameter choice: at zero force, near it and far away, along axes and diagonals."""
    d = len(subject.simple.forces)
    ways = (
        product((0, 1, -1), repeat=d) if d <= _MOST_FORCES else (tuple(s * (i == k) for i in range(d)) for k in range(d) for s in (1, -1))
    )
    points = [(Fraction(0), (0,) * d), *((reach, way) for way in ways if any(way) for reach in (_NEAR, Fraction(1), _FAR))]
    for parameters in subject.choices(1):

        def sign(reach: Fraction, way: tuple[int, ...], parameters: Values = parameters) -> int | None:
            here = subject.values_at(parameters, [reach * w for w in way])
            return certain_sign(enclose(subject.problem.stated, {x: ball(v) for x, v in here.items()}))

        return [(reach, way, sign(reach, way)) for reach, way in points]
    return []


def _point(subject: FormulaSubject) -> str:
    gone = _invariant(subject)
    return (
        f"K is a {'line' if gone == 1 else f'space of {gone} dimensions'} without inside" if gone else "K is the point 0: g > 0 elsewhere"
    )


def _invariant(subject: FormulaSubject) -> int:
    """In how many directions of the forces g does not change."""
    return len(subject.problem.forces) - len(subject.simple.forces)


def _cause(subject: FormulaSubject) -> str:
    """The likely reason: a pressure taken for positive."""
    law = subject.law
    if law.pressure is None or subject.problem.magnitude is None or f"abs({law.pressure})" in as_written(law)[0].replace(" ", ""):
        return ""
    turned = law.g.xreplace({law.symbols()[law.pressure]: subject.problem.magnitude, **law.settled()})
    there = turned.xreplace(dict.fromkeys(law.force_symbols(), sp.S.Zero))
    if there.has(sp.nan, sp.zoo) or not subject.nonnegative(-there.xreplace(dict(subject.simple.slice))):
        return ""
    return f" ({law.pressure} <= 0 in compression: write abs({law.pressure}))"


def _unbounded(subject: FormulaSubject, ways: Sequence[tuple[int, ...]]) -> Extent | None:
    """Along forces that the simple problem has set to 0, or all the way in one of the directions."""
    if (gone := _invariant(subject)) and subject.at_origin is not None and subject.nonnegative(-subject.at_origin):
        return Extent(f"K is unbounded: g does not change along {gone} direction{'s' * (gone > 1)} of the forces", True)
    t, forces = sp.Dummy("t", positive=True), subject.simple.forces
    for way in ways[:1]:
        if subject.ask(-subject.simple.g.xreplace({x: w * t for x, w in zip(forces, way, strict=True)}), Sense.NONNEGATIVE).holds is True:
            ray = ", ".join(f"{x} = {'-' * (w < 0)}t" if w else f"{x} = 0" for x, w in zip(forces, way, strict=True))
            return Extent(f"K is unbounded: g <= 0 at {ray} for all t > 0", True)
    return None
