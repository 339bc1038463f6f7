"""In how many directions of the forces g does not change: at least as many as algebra finds, at most as many as its gradients leave.

The gradients of g at some points span a space of some rank r; along a direction in which g does not change each of them is 0, so
that of n forces at most n - r directions are left.
"""

from __future__ import annotations

from fractions import Fraction
from random import Random
from typing import Any

import flint

from duhem.expression.ball_series import compiled, derivatives
from duhem.expression.balls import ball, certain_sign
from duhem.proof.facts.formula_subject import FormulaSubject

__all__ = ["flat_directions", "most_flat_directions"]

_POINTS, _SCALES = 6, (Fraction(1, 4), Fraction(1), Fraction(4))  # for each force, at each scale
Row = list[Any]


def flat_directions(subject: FormulaSubject) -> int:
    """How many independent ones are found, for every parameter value and pressure; the law has no flow of its own.

    Of a law that is isotropic in six components the simple problem has the principal stresses: one direction among them is the
    pressure's, and two are all deviators, of which there are five in six components.
    """
    problem = subject.problem.principal()
    found = len(problem.forces) - len(subject.simple.forces)
    return {0: 0, 1: 1, 2: 5}[found] if len(problem.forces) < len(subject.problem.forces) else found


def most_flat_directions(subject: FormulaSubject) -> int:
    """How many there are at most, at one choice of the parameters."""
    forces, values = subject.problem.forces, next(subject.choices(1), None)
    if values is None:
        return len(forces)
    known = {x: ball(v) for x, v in subject.values_at(values, (Fraction(0),) * len(subject.simple.forces)).items()}
    names = [*forces, *(x for x in known if x not in forces)]
    run, rng, rows = compiled([subject.problem.g], names), Random(5), list[Row]()
    for scale in _SCALES:
        for _ in range(_POINTS * len(forces)):
            point = [scale * Fraction(rng.randint(-999, 999), 500) for _ in forces]
            rows.append([_slope(run, [ball(v) for v in point], i, [known[x] for x in names[len(forces) :]]) for i in range(len(forces))])
    return len(forces) - _rank([row for row in rows if all(x.is_finite() for x in row)])


def _slope(run: Any, point: Row, i: int, others: Row) -> Any:
    """The derivative of g by one of the forces."""
    moved = [flint.arb_series([x, 1], prec=2) if k == i else x for k, x in enumerate(point)]
    return derivatives(run(*moved, *others)[0], 1)[1]


def _rank(rows: list[Row]) -> int:
    """The rank that rows of balls certainly have, by elimination with pivots that are certainly not 0."""
    rank = 0
    while pivots := [(abs(x).lower(), j, row) for row in rows for j, x in enumerate(row) if certain_sign(x) in (1, -1)]:
        _, j, pivot = max(pivots, key=lambda found: float(found[0]))
        rank += 1
        rows = [[x - y * row[j] / pivot[j] for x, y in zip(row, pivot, strict=True)] for row in rows if row is not pivot]
        rows = [[x for k, x in enumerate(row) if k != j] for row in rows]
    return rank
