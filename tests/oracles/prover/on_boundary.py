"""Smoothness, dissipation and normality on the boundary, face by face and branch by branch, each by the signs that z3 shows."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from itertools import combinations

import sympy as sp

from duhem.expression.branches import Branch, plain_switches, seams, smooth_below, thick
from duhem.proof.decide import Sense
from duhem.proof.facts.formula_subject import FormulaSubject
from duhem.proof.statement import Face
from duhem.proof.verdict import Evidence, Verdict
from tests.oracles.prover.where import on, within

__all__ = ["dissipation_on_boundary", "normality_parallel", "smoothness_on_boundary"]

Asked = tuple[sp.Expr, Sense, tuple[sp.Basic, ...]]  # a sign, and where it is asked
_MOST_PIECES = 8


def smoothness_on_boundary(subject: FormulaSubject) -> Evidence | None:
    """grad g does not vanish on the boundary and keeps its direction across every seam that the boundary crosses."""
    pieces, forces = subject.pieces, subject.simple.forces
    if pieces is None or len(pieces) > _MOST_PIECES or not subject.continuous:
        return None
    asked: list[Asked] = [(_square(_gradient(p.expr, forces)), Sense.POSITIVE, (*p.conditions(), sp.Eq(p.expr, 0))) for p in pieces]
    for between in seams(pieces):
        before, after = between.before.expr, between.after.expr
        one, two = _gradient(before, forces), _gradient(after, forces)
        on_seam = (*within(between), *on(between), sp.Eq(before, 0))
        asked += [(minor, Sense.ZERO, on_seam) for minor in (after, *_minors(one, two))]
        asked.append((_dot(one, two), Sense.POSITIVE, on_seam))
    told = "" if len(pieces) == 1 else ", with one direction on both sides of each seam"
    return _by_signs(subject, asked, "regular-value", f"grad g != 0 wherever g = 0{told}")


def dissipation_on_boundary(subject: FormulaSubject) -> Evidence | None:
    """force . flow >= 0 on the boundary, face by face and branch by branch; the flow is grad g where there is none of its own."""
    forces, asked = subject.simple.forces, list[Asked]()
    for face in subject.simple.faces:
        if (pieces := _on_boundary(subject, face)) is None:
            return None
        for g, there in pieces:
            flow = face.flow or _gradient(g, forces)
            if not face.flow:  # where grad g = 0 it says nothing of the normal
                asked.append((_square(flow), Sense.POSITIVE, there))
            asked.append((sp.factor_terms(sp.expand(subject.power(flow))), Sense.NONNEGATIVE, there))
    return _by_signs(subject, asked, "boundary-power", "force . flow >= 0 wherever g = 0")


def normality_parallel(subject: FormulaSubject, settled: Mapping[str, Evidence]) -> Evidence | None:
    """A flow of the law's own, or of a surface, is parallel to grad g and points the same way, wherever g = 0 in K, K being convex.

    K lies in {g <= 0}, so g does not rise from the boundary point towards any point of K.
    """
    own = [face for face in subject.simple.faces if face.flow is not None]
    if settled["convexity"].verdict is not Verdict.PROVED or not own:
        return None
    forces, asked = subject.simple.forces, list[Asked]()
    for face in own:
        if (pieces := _on_boundary(subject, face)) is None:
            return None
        for g, there in pieces:
            flow, gradient = face.flow or (), _gradient(g, forces)
            asked += [
                (_square(gradient), Sense.POSITIVE, there),  # where grad g = 0 every flow would look parallel to it
                (_square(flow), Sense.POSITIVE, there),  # where the flow is 0 it has no direction
                *((minor, Sense.ZERO, there) for minor in _minors(flow, gradient)),
                (_dot(flow, gradient), Sense.NONNEGATIVE, there),
            ]
    return _by_signs(subject, asked, "parallel", "the flow is a non-negative multiple of grad g wherever g = 0, and K is convex")


def _by_signs(subject: FormulaSubject, asked: Sequence[Asked], name: str, detail: str) -> Evidence | None:
    """Proved if the deciders show every sign that is asked; the name of the proof says by which methods."""
    used = set[str]()
    for expr, sense, there in asked:
        answer = subject.ask(expr, sense, *there)
        if answer.holds is not True:
            return None
        used.add(answer.method)
    return Evidence(Verdict.PROVED, f"{name} ({', '.join(sorted(used))})", detail)


def _gradient(g: sp.Expr, forces: Sequence[sp.Symbol]) -> tuple[sp.Expr, ...]:
    return tuple(sp.diff(g, x) for x in forces)


def _square(vector: Sequence[sp.Expr]) -> sp.Expr:
    return sp.Add(*(d**2 for d in vector))


def _dot(one: Sequence[sp.Expr], two: Sequence[sp.Expr]) -> sp.Expr:
    return sp.Add(*(a * b for a, b in zip(one, two, strict=True)))


def _minors(one: Sequence[sp.Expr], two: Sequence[sp.Expr]) -> list[sp.Expr]:
    """The components of their vector product."""
    return [one[i] * two[j] - one[j] * two[i] for i, j in combinations(range(len(one)), 2)]


def _on_boundary(subject: FormulaSubject, face: Face) -> tuple[tuple[sp.Expr, tuple[sp.Basic, ...]], ...] | None:
    """Where a face of the simple problem is the boundary of K: its g on smooth closed branches, each with what holds there.

    None where there are too many of them, or the boundary may lie elsewhere than on g = 0.
    """
    within = [sp.LessThan(smooth, 0) for other in face.others for smooth in smooth_below(other)]
    apart = not subject.doubtful and subject.joined(subject.simple.g) and subject.joined(face.g) if face.others else subject.continuous
    pieces = (subject.pieces if face.g == subject.simple.g else _pieces(face.g)) if apart else None
    if pieces is None or sp.false in within:
        return None if pieces is None else ()
    return tuple((p.expr, (*p.conditions(), *(r for r in within if r != sp.true), sp.Eq(p.expr, 0))) for p in pieces)


def _pieces(g: sp.Expr) -> tuple[Branch, ...] | None:
    found = thick(g)
    return None if found is None else plain_switches(found)
