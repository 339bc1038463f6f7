"""The slip direction on the boundary: normal to K or not, dissipative or not.

For an associated law the flow is the normality rule itself (Moreau 1970; Antoni et al. 2007, Eqs. 28, 36): it lies in
the normal cone of K exactly when K is convex there.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterator, Sequence
from fractions import Fraction
from typing import TYPE_CHECKING

import sympy as sp

from duhem.expression.number import rational
from duhem.proof.decide import Sense
from duhem.proof.facts.formula_subject import FormulaSubject
from duhem.proof.facts.parameter_choices import Values
from duhem.proof.search.boundary_identities import parallel
from duhem.proof.search.suggestion import Exit, Point
from duhem.proof.statement.problem import Face
from duhem.proof.verdict import Evidence, Proof, Verdict, Witness
from duhem.proof.witness.enclosed_point import EnclosedPoint, enclosed, enclosed_flow, enclosed_normal, over_box, violation

if TYPE_CHECKING:
    from duhem.proof.search.boundary_points import BoundaryScout

__all__ = ["dissipation_refuted", "normality", "normality_refuted", "normality_refuted_by_chord"]

_NORMALITY = "the flow at the boundary point between `inside` and `outside` points towards tau, a point of K: it is not in the normal cone"
_DISSIPATION = "force . flow < 0 at the boundary point between `inside` and `outside`"


def normality(subject: FormulaSubject) -> Evidence | None:
    """A flow of the law's own, or of a surface, is parallel to grad g and points the same way, wherever g = 0 in K (K convex).

    K lies in {g <= 0} and is convex, so g does not rise from the boundary point towards any point of K.
    """
    own = [face for face in subject.simple.faces if face.flow is not None]
    if not own or not all(_parallel(subject, face) for face in own):
        return None
    proof = Proof("parallel", parallel(subject)) if parallel(subject) else None
    detail = "the flow is a non-negative multiple of grad g wherever g = 0, and K is convex"
    return Evidence(Verdict.PROVED, "parallel", detail, proof=proof)


def _parallel(subject: FormulaSubject, face: Face) -> bool:
    """Whether the flow of a face is a positive multiple of grad g wherever the face is the boundary."""
    pieces, flow, forces = subject.on_boundary(face), face.flow or (), subject.simple.forces
    if pieces is None:
        return False
    for g, there in pieces:
        gradient = [sp.diff(g, x) for x in forces]
        if subject.ask(sp.Add(*(d**2 for d in gradient)), Sense.POSITIVE, *there).holds is not True:
            return False  # where grad g = 0 every flow would look parallel to it
        if subject.ask(sp.Add(*(d**2 for d in flow)), Sense.POSITIVE, *there).holds is not True:
            return False  # where the flow is 0 it has no direction
        for i, j in itertools.combinations(range(len(gradient)), 2):
            if subject.ask(flow[i] * gradient[j] - flow[j] * gradient[i], Sense.ZERO, *there).holds is not True:
                return False
        along = sum(d * n for d, n in zip(flow, gradient, strict=True))
        if subject.ask(along, Sense.NONNEGATIVE, *there).holds is not True:
            return False
    return True


def normality_refuted_by_chord(subject: FormulaSubject, chord: Witness) -> Evidence | None:
    """Associated flow on a non-convex K: where a chord from p to q leaves K, the normal there points towards q."""
    if not subject.problem.associated:
        return None
    parameters, p, q, middle = _read(subject, chord)
    statement = (
        "the way from `inside` to the midpoint of a chord of K crosses the boundary outward, at a sigma between `inside` and `outside`, "
        "so grad g . (tau - sigma) > 0 there for one end tau of the chord: the normal is not in the normal cone of K"
    )
    # n . (midpoint - sigma) > 0 where a segment to the midpoint leaves K, whatever it comes from; so for p or q as well
    starts = [p, q, [Fraction(0)] * len(p), *([c * s for c in end] for s in (Fraction(1, 2), Fraction(7, 8)) for end in (p, q))]
    starts += [[s * Fraction(c) for c in _beside(len(p))] for s in (Fraction(1, 2**6), Fraction(1, 2**30), Fraction(1, 2**60))]
    ways = ((start, target) for start in itertools.chain(starts, _centre(subject, parameters)) for target in (q, p))
    for start, target in ways:
        if start is target:
            continue

        def turned_away(point: EnclosedPoint, target: Sequence[Fraction] = target) -> sp.Expr | None:
            normal = enclosed_normal(subject, point)
            if normal is None:
                return None
            return sp.Add(*(n * (rational(t) - x) for n, t, x in zip(normal, target, subject.simple.forces, strict=True)))

        witness = violation(subject, parameters, start, middle, turned_away, "grad g . (tau - sigma)", statement, wanted=1, target=target)
        if witness is not None:
            return Evidence(Verdict.REFUTED, "witness-normal", "grad g is not in the normal cone where a chord leaves K", witness)
    return None


def _beside(n: int) -> list[int]:
    """Whole numbers of many sizes: beside 0 along them few kinks are met, along all of which both ends of a chord may lie."""
    return [(-1) ** (i // 2) * (1 + i * i % 7 + 10 * i) for i in range(n)]


def _centre(subject: FormulaSubject, parameters: Values) -> Iterator[list[Fraction]]:
    """A point well inside K; the ends of a chord may lie on its boundary, with no way into K between them."""
    from duhem.proof.search.boundary_points import scouts

    yield from (list(exit.inside) for scout in scouts(subject, 6) if scout.parameters == parameters for exit in scout.towards_zero_force())


def _read(subject: FormulaSubject, chord: Witness) -> tuple[Values, list[Fraction], list[Fraction], list[Fraction]]:
    table = subject.law.symbols()
    parameters = {table[name]: Fraction(value) for name, value in chord.parameters.items() if table[name] in subject.simple.parameters}
    if subject.simple.magnitude in subject.simple.parameters and subject.simple.magnitude is not None:
        parameters[subject.simple.magnitude] = -Fraction(chord.points["p"][str(subject.law.pressure)])
    points = [[Fraction(chord.points[role][str(x)]) for x in subject.simple.forces] for role in ("p", "q", "midpoint")]
    return parameters, points[0], points[1], points[2]


def normality_refuted(subject: FormulaSubject, choices: int = 12, near: bool = True) -> Evidence | None:
    """A boundary point whose flow points towards another point of K, the worst direction first.

    The other point is first sought all along the boundary, then it is zero force, towards which a flow of negative power
    points, then (if ``near``) close by, at the scale of the deviation itself; at so many choices of the parameters.
    """
    if subject.simple.associated:
        return None
    from duhem.proof.search.boundary_points import scouts  # numpy, only when something is looked for

    for scout in scouts(subject, choices):
        if len(scout.boundary) < 2:
            continue
        zero = (Fraction(0),) * len(subject.simple.forces)
        at_rest = ((exit, zero) for exit in scout.least_power(5))
        for exit, target in itertools.chain(scout.far_targets(), at_rest, _on_the_boundary(subject, scout) if near else ()):
            if witness := _leans_towards(subject, exit, target):
                return Evidence(Verdict.REFUTED, "witness-flow", "the flow leaves the normal cone of K", witness)
    return None


def _on_the_boundary(subject: FormulaSubject, scout: BoundaryScout) -> Iterator[tuple[Exit, Point]]:
    """Targets close by as points that are surely in K."""
    for exit, turned in scout.near_targets():
        if found := enclosed(subject, turned.parameters, turned.inside, turned.outside, 80):
            yield exit, found.inside


def _leans_towards(subject: FormulaSubject, exit: Exit, target: Point) -> Witness | None:

    def leaning(point: EnclosedPoint) -> sp.Expr | None:
        if (flow := enclosed_flow(subject, point)) is None:
            return None
        return sp.Add(*(d * (rational(t) - x) for d, t, x in zip(flow, target, subject.simple.forces, strict=True)))

    name = "flow . (tau - sigma)"
    return violation(
        subject, exit.parameters, exit.inside, exit.outside, leaning, name, _NORMALITY, 1, target, lambda b: _angles(subject, b)
    )


def dissipation_refuted(subject: FormulaSubject, choices: int = 12) -> Evidence | None:
    """A boundary point where force . flow < 0, at so many choices of the parameters."""
    from duhem.proof.search.boundary_points import scouts

    def power(point: EnclosedPoint) -> sp.Expr | None:
        flow = enclosed_flow(subject, point)
        return None if flow is None else sp.Add(*(x * d for x, d in zip(subject.simple.forces, flow, strict=True)))

    for scout in scouts(subject, choices):
        for exit in itertools.chain(scout.towards_zero_force(), scout.least_power(5)):
            if witness := violation(subject, exit.parameters, exit.inside, exit.outside, power, "force . flow", _DISSIPATION):
                return Evidence(Verdict.REFUTED, "witness-power", "force . flow is negative on the boundary", witness)
    return None


def _angles(subject: FormulaSubject, point: EnclosedPoint) -> dict[str, float]:
    """Deviation of the flow from the normal at the enclosed point, and the flow's own angle (two forces), in degrees."""
    normal, flow = enclosed_normal(subject, point), enclosed_flow(subject, point)
    if normal is None or flow is None:
        return {}
    n, d = ([float(over_box(c, subject, point).mid()) for c in vector] for vector in (normal, flow))
    n_size, d_size = math.hypot(*n), math.hypot(*d)
    apart, along = (math.hypot(*(a / n_size + way * b / d_size for a, b in zip(n, d, strict=True))) for way in (-1, 1))
    measures = {"deviation_degrees": math.degrees(2 * math.atan2(apart, along))}  # exact for small angles too (Kahan 2006)
    if len(d) == 2:
        measures["slip_angle_degrees"] = math.degrees(math.atan2(d[1], d[0]))
    return measures
