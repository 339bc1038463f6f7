"""Polynomials of a stress written in its invariants J2 and J3, the forces being components or principal values of a tensor.

Which components they are is tried in the usual orders; what is found is confirmed as an identity, so that no name counts.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from fractions import Fraction
from itertools import permutations, product
from typing import NamedTuple

from duhem.proof.kernel.polynomial import ONE, Polynomial, negated, times, total
from duhem.proof.kernel.term import NotWritten, Term

__all__ = ["Invariants", "invariants", "of_tensor"]

_HIGHEST = 12
Point = dict[Term, Fraction]


class Invariants(NamedTuple):
    """J2 = s:s/2 and J3 = det s of the deviator s, as polynomials of the forces."""

    forces: tuple[Term, ...]
    second: Polynomial
    third: Polynomial

    def of(self, poly: Polynomial) -> tuple[int, dict[int, Polynomial]]:
        """(k, a) with poly = sum of a_j J2^((k - 3 j)/2) J3^j, homogeneous in the forces; NotWritten where it is none of that."""
        degrees = {sum(n for x, n in m if x in self.forces) for m in poly}
        if len(degrees) != 1 or not 0 <= (k := degrees.pop()) <= _HIGHEST:
            raise NotWritten("a polynomial of the forces is not homogeneous")
        powers = [j for j in range(k // 3 + 1) if (k - 3 * j) % 2 == 0]
        found = self._solved(poly, k, powers)
        terms = [times(found[j], self._power((k - 3 * j) // 2, j)) for j in powers]
        if total(poly, *map(negated, terms)):
            raise NotWritten("a polynomial of the forces has other invariants than J2 and J3")
        return k, found

    def _power(self, i: int, j: int) -> Polynomial:
        found = ONE
        for part in (self.second,) * i + (self.third,) * j:
            found = times(found, part)
        return found

    def _solved(self, poly: Polynomial, k: int, powers: Sequence[int]) -> dict[int, Polynomial]:
        """The a_j, from the values at as many points."""
        rows, used = list[tuple[list[Fraction], Polynomial]](), list[int]()
        for values in product(range(4), repeat=len(self.forces)):
            point = dict(zip(self.forces, map(Fraction, reversed(values)), strict=True))
            two, three = (_at(form, point).get((), Fraction(0)) for form in (self.second, self.third))
            row, value = [two ** ((k - 3 * j) // 2) * three**j for j in powers], _at(poly, point)
            for pivot, (known, had) in zip(used, rows, strict=True):
                share = row[pivot] / known[pivot]
                row = [x - share * y for x, y in zip(row, known, strict=True)]
                value = total(value, {m: -share * c for m, c in had.items()})
            if any(row):
                used.append(next(i for i, x in enumerate(row) if x))
                rows.append((row, value))
            if len(rows) == len(powers):
                break
        else:
            raise NotWritten("the invariants of the forces are not independent")
        found: dict[int, Polynomial] = {}
        for pivot, (row, value) in reversed([*zip(used, rows, strict=True)]):
            others = [{m: -x * c for m, c in found[j].items()} for j, x in zip(powers, row, strict=True) if x and j in found]
            found[powers[pivot]] = {m: c / row[pivot] for m, c in total(value, *others).items()}
        return found


def _at(poly: Polynomial, point: Point) -> Polynomial:
    """The value at a point of the forces, a polynomial in the constants."""
    found: Polynomial = {}
    for m, c in poly.items():
        for x, n in m:
            c *= point[x] ** n if x in point else 1
        found = total(found, {tuple((x, n) for x, n in m if x not in point): c})
    return found


def invariants(forces: Sequence[str]) -> Iterator[Invariants]:
    """Those of the tensors that two to six forces may be: principal values, components in the plane or in space."""
    names = tuple(Term("name", name=f) for f in forces)
    x: list[Polynomial] = [{((name, 1),): Fraction(1)} for name in names]
    zero: Polynomial = {}
    if len(x) in (2, 3):
        yield of_tensor(names, (*x, zero)[:3], (zero, zero, zero))
    if len(x) in (3, 4):  # xx yy xy, xx yy zz xy
        yield of_tensor(names, (x[0], x[1], zero if len(x) == 3 else x[2]), (zero, zero, x[-1]))
    if len(x) == 6:
        for shear in permutations(x[3:]):
            yield of_tensor(names, x[:3], shear)


def of_tensor(forces: tuple[Term, ...], normal: Sequence[Polynomial], shear: Sequence[Polynomial]) -> Invariants:
    """Of the normal components xx, yy, zz and the shear components yz, zx, xy."""
    third = Fraction(1, 3)
    mean = {m: third * c for m, c in total(*normal).items()}
    xx, yy, zz = (total(s, negated(mean)) for s in normal)
    yz, zx, xy = shear
    second = total(*(_scaled(Fraction(1, 2), times(s, s)) for s in (xx, yy, zz)), *(times(t, t) for t in shear))
    cross = (times(times(s, t), _scaled(Fraction(-1), t)) for s, t in ((xx, yz), (yy, zx), (zz, xy)))
    det = total(times(times(xx, yy), zz), _scaled(Fraction(2), times(times(yz, zx), xy)), *cross)
    return Invariants(forces, second, det)


def _scaled(factor: Fraction, poly: Polynomial) -> Polynomial:
    return {m: factor * c for m, c in poly.items()}
