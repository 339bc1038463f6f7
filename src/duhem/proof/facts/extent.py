"""Sets that are hardly what was meant: nothing, everything, one point, no inside, no end.  Suspected at a few points, then proved."""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction
from itertools import product

import sympy as sp

from duhem.expression import UNDEFINED
from duhem.expression.balls import ball, certain_sign, enclose
from duhem.proof.decide import Sense
from duhem.proof.facts.formula_subject import FormulaSubject
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
    if signs.all({1}, _NEAR, Fraction(1), _FAR) and subject.ask(problem.g, Sense.POSITIVE, away).holds is True:
        if subject.at_origin is not None and subject.positive(subject.at_origin):
            return Extent(f"K is empty: g > 0 for all forces{_cause(subject)}", False)
        if subject.at_origin is not None and subject.nonnegative(-subject.at_origin):
            return Extent(_point(subject), False)
        return None
    if signs.all({0, -1}, _FAR, Fraction(1), _NEAR) and subject.ask(-problem.g, Sense.NONNEGATIVE).holds is True:
        return Extent("K is everything: g <= 0 for all forces", False)
    if signs.all({0, 1}, Fraction(0), _NEAR, Fraction(1), _FAR) and subject.ask(problem.g, Sense.NONNEGATIVE).holds is True:
        return Extent("K has no inside: g >= 0 for all forces", True)
    return _unbounded(subject, signs)


class _Signs:
    """Signs of g at one parameter choice: at zero force, near it and far away, along axes and diagonals; each found when asked for."""

    def __init__(self, subject: FormulaSubject) -> None:
        d = len(subject.simple.forces)
        axes = [tuple(s * (i == k) for i in range(d)) for k in range(d) for s in (1, -1)]
        self.ways = axes if d > _MOST_FORCES else [way for way in product((0, 1, -1), repeat=d) if any(way)]
        self._subject, self._known = subject, dict[tuple[Fraction, ...], int | None]()
        self._parameters = next(subject.choices(1), None)

    def at(self, reach: Fraction, way: tuple[int, ...]) -> int | None:
        """The sign at so far a point in that direction; None where it is not certain."""
        if self._parameters is None:
            return None
        if (point := tuple(reach * w for w in way)) not in self._known:
            here = self._subject.values_at(self._parameters, point)
            self._known[point] = certain_sign(enclose(self._subject.problem.stated, {x: ball(v) for x, v in here.items()}))
        return self._known[point]

    def all(self, wanted: set[int], *reaches: Fraction) -> bool:
        """Whether every point looked at has such a sign."""
        return self._parameters is None or all(self.at(r, way) in wanted for r in reaches for way in self.ways)


@fact
def _signs(subject: FormulaSubject) -> _Signs:
    return _Signs(subject)


def _point(subject: FormulaSubject) -> str:
    gone = _invariant(subject)
    return (
        f"K is a {'line' if gone == 1 else f'space of {gone} dimensions'} without inside" if gone else "K is the point 0: g > 0 elsewhere"
    )


def _invariant(subject: FormulaSubject) -> int:
    """In how many directions of the forces g does not change."""
    return len(subject.problem.principal().forces) - len(subject.simple.forces)


def _cause(subject: FormulaSubject) -> str:
    """The likely reason: a pressure taken for positive."""
    law = subject.law
    if law.pressure is None or subject.problem.magnitude is None or f"abs({law.pressure})" in as_written(law)[0].replace(" ", ""):
        return ""
    turned = law.g.xreplace({law.symbols()[law.pressure]: subject.problem.magnitude, **law.settled()})
    there = turned.xreplace(dict.fromkeys(law.force_symbols(), sp.S.Zero))
    if there.has(*UNDEFINED) or not subject.nonnegative(-there.xreplace(dict(subject.simple.slice))):
        return ""
    return f" ({law.pressure} <= 0 in compression: write abs({law.pressure}))"


def _unbounded(subject: FormulaSubject, signs: _Signs) -> Extent | None:
    """Along forces that the simple problem has set to 0, or all the way in one of the directions."""
    if (gone := _invariant(subject)) and subject.at_origin is not None and subject.nonnegative(-subject.at_origin):
        return Extent(f"K is unbounded: g does not change along {gone} direction{'s' * (gone > 1)} of the forces", True)
    t, forces = sp.Dummy("t", positive=True), subject.simple.forces
    for way in [way for way in signs.ways if signs.at(_FAR, way) in (-1, 0)][:1]:
        if subject.ask(-subject.simple.g.xreplace({x: w * t for x, w in zip(forces, way, strict=True)}), Sense.NONNEGATIVE).holds is True:
            ray = ", ".join(f"{x} = {'-' * (w < 0)}t" if w else f"{x} = 0" for x, w in zip(forces, way, strict=True))
            return Extent(f"K is unbounded: g <= 0 at {ray} for all t > 0", True)
    return None
