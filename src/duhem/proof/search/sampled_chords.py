"""Chords that seem to leave K, in floats: the boundary is sampled along rays in plane sections.

Midpoints of chords of many lengths are tried, which sees inward kinks, dents and separate components.
"""

from __future__ import annotations

from collections.abc import Iterator
from fractions import Fraction
from typing import Any

import numpy as np
import sympy as sp
from numpy.typing import NDArray

from duhem.expression.numpy_ import compiled
from duhem.expression.rays import Rays, first_exit
from duhem.proof.facts.formula_subject import FormulaSubject
from duhem.proof.facts.parameter_choices import Values
from duhem.proof.search.descent import lowest
from duhem.proof.search.suggestion import Chord

__all__ = ["looked_between", "sampled_chords"]

Array = NDArray[np.float64]
_ANGLES, _SECTIONS = 720, 24
_SECTION, _NODE = 10_000, 1_200  # steps of a section, and of each node of the formula over its points
_RADII = 10.0 ** np.linspace(-6, 6, 144)


def sampled_chords(subject: FormulaSubject, most: int = 40) -> Iterator[Chord]:
    """Chords worth an exact look, one choice of parameters after the other while steps are left."""
    price = _sections(len(subject.simple.forces)) * (_SECTION + _NODE * sum(1 for _ in sp.preorder_traversal(subject.simple.g)))
    for parameters in subject.choices(most):
        if not subject.budget.pays(price):
            return
        seen: list[int] = []
        yield from _in_choice(subject, parameters, seen)
        subject.known[sampled_chords, tuple(parameters.items())] = sum(seen)


def looked_between(subject: FormulaSubject) -> list[int]:
    """Between how many boundary points chords were tried in vain, a parameter choice each."""
    return [n for key, n in subject.known.items() if isinstance(key, tuple) and key[0] is sampled_chords and n > 0]


def _in_choice(subject: FormulaSubject, parameters: Values, seen: list[int]) -> Iterator[Chord]:
    forces = subject.simple.forces
    run = compiled(subject.formula_at(parameters), forces)

    def value(points: Array) -> Array:
        return run(*np.moveaxis(points, -1, 0))

    centre = _centre(value, len(forces))
    if centre is None:
        return
    for p, q, p_anchor, q_anchor in _suspects(value, centre, seen):
        for digits in (1, 2, 3, 4, 6, 9, 12, 16):  # the fewest decimals that still show it, for those who check by hand
            pull = 10.0**-digits
            yield Chord(
                parameters,
                *(
                    tuple(Fraction(round(float(c) * 10**digits), 10**digits) for c in x + pull * (a - x))
                    for x, a in ((p, p_anchor), (q, q_anchor))
                ),
            )


def _centre(value: Any, d: int) -> Array | None:
    """A point of K: the origin, or the lowest that is found."""
    origin = np.zeros(d)
    if value(origin) <= 0:
        return origin
    return lowest(value, d, np.random.default_rng(3), (-3, 3))


def _suspects(value: Any, centre: Array, seen: list[int]) -> Iterator[tuple[Array, Array, Array, Array]]:
    """Pairs of points of K whose midpoint seems outside, each with a point further inside to be pulled towards."""
    d = len(centre)
    yield from _random_pairs(value, d)
    rng = np.random.default_rng(4)
    for section in range(_sections(d)):
        if d == 1:
            directions = np.array([[1.0], [-1.0]])
        else:
            turn = 2 * np.pi * np.arange(_ANGLES) / _ANGLES
            frame = np.eye(d)[:2] if section == 0 else np.linalg.qr(rng.standard_normal((d, 2)))[0].T
            directions = np.outer(np.cos(turn), frame[0]) + np.outer(np.sin(turn), frame[1])
        yield from _along_rays(value, centre, directions, seen)


def _sections(d: int) -> int:
    """How many plane sections of d forces are looked at."""
    return 1 if d <= 2 else _SECTIONS


def _random_pairs(value: Any, d: int) -> Iterator[tuple[Array, Array, Array, Array]]:
    """Points of K of many sizes, each with its opposite and with another one: sees holes that rays step over."""
    rng = np.random.default_rng(6)
    points = rng.standard_normal((4000, d)) * 10.0 ** rng.uniform(-2, 2, (4000, 1))
    inner = points[value(points) <= 0]
    for others in (-inner, rng.permutation(inner)):
        heights = value((inner + others) / 2)
        score = np.where((value(others) <= 0) & np.isfinite(heights), heights, -np.inf)
        for k in np.argsort(-score)[:2]:
            if score[k] > 0:
                yield inner[k], others[k], inner[k], others[k]


def _along_rays(value: Any, centre: Array, directions: Array, seen: list[int]) -> Iterator[tuple[Array, Array, Array, Array]]:
    """``seen`` takes up how many rays left K."""
    rays = Rays(value, centre, directions)
    inside = rays.inside(_RADII)
    last, first = rays.narrowed(*first_exit(inside, _RADII))
    boundary = rays.at(last)
    seen.append(int(np.count_nonzero((last > 0) & (last < first))))
    # A ray that comes back into K after leaving it shows a gap by itself.
    later = inside & (first[:, None] < _RADII)
    who = np.flatnonzero(later.any(axis=1))[:8]
    back = np.argmax(later[who], axis=1)
    gap = Rays(value, centre, directions[who])
    enter, _ = gap.narrowed(_RADII[back], _RADII[back - 1])
    for leave, entry, farther in zip(boundary[who], gap.at(enter), gap.at(_RADII[back]), strict=True):
        yield leave, entry, centre, farther
    n = len(directions)
    best: list[tuple[float, int, int]] = []
    for step in (1, 2, 4, 8, 16, 32, 64, 100, 128, 180, 220, 256, 300):
        if step >= n:
            break
        other = np.roll(boundary, -step, axis=0)
        heights = value((boundary + other) / 2)
        size = np.linalg.norm(other - boundary, axis=1)
        score = np.where(np.isfinite(heights) & (size > 0), heights, -np.inf)
        top = int(np.argmax(score))
        if score[top] > 0:
            best.append((float(score[top]), top, (top + step) % n))
    for _, i, j in sorted(best, reverse=True):
        yield boundary[i], boundary[j], centre, centre
