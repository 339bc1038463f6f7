"""The smooth branches of g with their gradients, and the places of the boundary where the gradients disagree.

A seam is where a switching function of the formula vanishes.  Whether the gradient is continuous there is decided on
points of the boundary of K, found from g alone at exact random parameters: the two one-sided gradients are compared at
distances 1e-20 and 1e-40 from the seam.  A gap that stays is a corner; a gap that dies out is none.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import combinations
from random import Random
from typing import Any

import sympy as sp

from duhem.derivation.support_function import BITS, ROUGH, finite, sample_values
from duhem.expression import mpmath_
from duhem.expression.branches import Branch, thick
from duhem.expression.mpmath_ import reach
from duhem.expression.vocabulary import Norm
from duhem.law.formula_law import Criterion

__all__ = ["MOST", "Corner", "Pieces", "Seams", "pieces", "seams"]

MOST = 16


@dataclass(frozen=True)
class Pieces:
    """The smooth branches of g with their gradients, going round the quadrants where the switches are the forces."""

    conditions: tuple[sp.Basic, ...]
    switches: tuple[dict[sp.Expr, int], ...]
    values: tuple[sp.Expr, ...]
    gradients: tuple[tuple[sp.Expr, ...], ...]

    def joined(self, values: Sequence[sp.Expr]) -> sp.Expr:
        """One expression by branches."""
        if len(set(values)) == 1:
            return values[0]
        return sp.Piecewise(*zip(values, self.conditions, strict=True), evaluate=False)


@dataclass(frozen=True)
class Corner:
    """Two branches, by index, that meet on the boundary where ``switch`` = 0 with different normals."""

    switch: sp.Expr
    first: int
    second: int


@dataclass(frozen=True)
class Seams:
    """What the boundary does where branches meet: its corners, and whether every seam met was decided."""

    met: int
    corners: tuple[Corner, ...]
    decided: bool


def pieces(law: Criterion) -> Pieces | None:
    """The branches of g with an inside, or None where they are too many to print."""
    if (found := thick(law.g, MOST)) is None:
        return None
    forces = law.force_symbols()
    order = list(dict.fromkeys(switch for b in found for switch in b.signs))
    order.sort(key=lambda s: (forces.index(s) if s in forces else len(forces), sp.default_sort_key(s)))
    found = tuple(sorted(found, key=lambda b: _gray([b.signs.get(s, 1) for s in reversed(order)])))
    values = tuple(_unsigned(b.expr) for b in found)
    return Pieces(
        tuple(_region(b) for b in found),
        tuple(dict(b.signs) for b in found),
        values,
        tuple(tuple(value.diff(f) for f in forces) for value in values),
    )


def _unsigned(expr: sp.Expr) -> sp.Expr:
    """Norms of -x written as norms of x."""
    return expr.replace(Norm, lambda *args: Norm(*[-a if a.could_extract_minus_sign() else a for a in args]))


def _gray(signs: Sequence[int]) -> int:
    """Place in the order where neighbours differ in one sign: ++, -+, --, +- for two."""
    place, flipped = 0, 0
    for sign in signs:
        flipped ^= sign < 0
        place = 2 * place + flipped
    return place


def _region(branch: Branch) -> sp.Basic:
    kinds = {1: sp.GreaterThan, -1: sp.LessThan}
    parts = [kinds[sign](switch, 0, evaluate=False) for switch, sign in branch.signs.items()]
    return sp.And(*parts, evaluate=False) if len(parts) > 1 else parts[0] if parts else sp.true


def seams(law: Criterion, found: Pieces) -> Seams:
    """Every place seen where two branches meet on the boundary, and whether the normal jumps there."""
    forces, symbols = law.force_symbols(), law.symbols()
    others = [s for s in symbols.values() if s not in forces]
    crossings = [s for s in dict.fromkeys(s for signs in found.switches for s in signs) if s.has(*forces)]
    if not crossings:
        return Seams(0, (), True)
    straight = {s: _plane(s, forces) for s in crossings}
    decided = all(plane is not None for plane in straight.values())
    fine, rough, names = mpmath_.digits(90), mpmath_.digits(ROUGH), [*forces, *others]
    g = mpmath_.compiled([law.g], names, rough)
    every = list(dict.fromkeys(s for signs in found.switches for s in signs))
    signs_at = mpmath_.compiled(every, names, fine)
    gradients = [mpmath_.compiled(gradient, names, fine) for gradient in found.gradients]
    verdicts: dict[tuple[int, int], tuple[sp.Expr, set[bool | None]]] = {}
    random = Random(36)
    for values in sample_values(law, (), random, 2):
        rest = [values[s] for s in others]
        for switch, plane in straight.items():
            if plane is None:
                continue
            for x in _on_seam(fine, rough, g, rest, plane, values, random):
                active = _active(found, every, signs_at(*x, *rest))
                for i, j in combinations(active, 2):
                    if found.switches[i].get(switch, 0) * found.switches[j].get(switch, 0) != -1:
                        continue
                    seen = verdicts.setdefault((i, j), (switch, set()))
                    seen[1].add(_jumps(fine, found, gradients, x, rest, plane, values, switch, i, j))
    corners, normals = [], set()
    for (i, j), (switch, seen_here) in verdicts.items():
        decided &= seen_here in ({True}, {False})
        pair = frozenset((found.gradients[i], found.gradients[j]))
        if seen_here == {True} and pair not in normals:
            normals.add(pair)
            corners.append(Corner(switch, i, j))
    return Seams(len(verdicts), tuple(corners), decided)


def _plane(switch: sp.Expr, forces: Sequence[sp.Symbol]) -> tuple[sp.Expr, ...] | None:
    """The coefficients of a linear switching function; None for any other."""
    if not switch.is_polynomial(*forces):
        return None
    row = tuple(switch.diff(f) for f in forces)
    linear = sp.expand(switch - sp.Add(*[c * f for c, f in zip(row, forces, strict=True)])) == 0
    return row if linear and not any(c.has(*forces) for c in row) else None


def _on_seam(
    fine: Any, rough: Any, g: Callable[..., list[Any]], rest: list[Any], plane: Sequence[sp.Expr],
    values: Mapping[sp.Symbol, sp.Rational], random: Random,
) -> Iterator[list[Any]]:  # fmt: skip
    """Points of the boundary of K on the plane of the seam, along rays in it from the origin; ``g`` in rough digits."""
    rows = sp.Matrix([[c.xreplace(values) for c in plane]])
    basis = [[fine.mpf(sp.N(c, 90)) for c in vector] for vector in rows.nullspace()]
    both_ways = [[fine.mpf(1)], [fine.mpf(-1)]]
    chosen = both_ways if len(basis) == 1 else [[fine.mpf(random.gauss(0, 1)) for _ in basis] for _ in range(6)]
    for weights in chosen:
        ray = [fine.fsum(w * vector[i] for w, vector in zip(weights, basis, strict=True)) for i in range(len(plane))]
        t = reach(rough, lambda x: g(*x, *rest)[0], [rough.mpf(0)] * len(plane), [rough.mpf(r) for r in ray], BITS)
        if t is not None:
            yield [fine.mpf(t) * r for r in ray]


def _active(found: Pieces, every: Sequence[sp.Expr], at: Sequence[Any]) -> list[int]:
    """The branches whose region contains the point."""
    sizes = dict(zip(every, at, strict=True))
    near = -(10.0**-60)
    return [i for i, signs in enumerate(found.switches) if all(sign * sizes[s] >= near for s, sign in signs.items())]


def _jumps(
    fine: Any, found: Pieces, gradients: Sequence[Callable[..., list[Any]]], x: Sequence[Any], rest: list[Any], plane: Sequence[sp.Expr],
    values: Mapping[sp.Symbol, sp.Rational], switch: sp.Expr, i: int, j: int,
) -> bool | None:  # fmt: skip
    """Whether the direction of the gradient differs between branches i and j as the seam is approached."""
    across = [fine.mpf(sp.N(c.xreplace(values), 90)) for c in plane]
    gaps = []
    for distance in (fine.mpf(10) ** -20, fine.mpf(10) ** -40):
        units = []
        for branch in (i, j):
            side = found.switches[branch][switch] * distance
            try:
                row = finite(gradients[branch](*(a + side * c for a, c in zip(x, across, strict=True)), *rest))
                size = fine.sqrt(fine.fsum(v * v for v in row))
                units.append([v / size for v in row])
            except (ArithmeticError, TypeError, ValueError):
                return None
        gaps.append(fine.sqrt(fine.fsum((a - b) ** 2 for a, b in zip(*units, strict=True))))
    if gaps[1] < fine.mpf(10) ** -15:
        return False
    ratio = gaps[1] / gaps[0]
    return True if ratio > 0.99 else False if ratio < 0.9 else None
