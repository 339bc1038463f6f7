"""Sums of squares with which a polynomial cancels, found by a conic solver and made exact.

Peyrl, Parrilo (2008), Theor. Comput. Sci. 409, 269: the numbers of a solution inside the cone are rounded and moved back onto
the equations.  On the edge of the cone the directions in which every solution is flat are left out first (facial reduction).  These
are found in many digits and made rational: a wrong guess finds no identity, and nothing else.
Nothing here is trusted: what comes out is an identity of fractions.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from itertools import product as pairs
from typing import Any

import clarabel
import flint
import numpy as np
from scipy import sparse

from duhem.proof.search.inner_point import inner_point

__all__ = ["Balance", "Block", "Exponents", "Multiples", "Pays", "Polynomial", "balanced", "free", "times"]

Exponents = tuple[int, ...]
Polynomial = Mapping[Exponents, Fraction]
Gram = tuple[tuple[Fraction, ...], ...]
Pays = Callable[[int], bool]  # for so many steps, before they are made; False where they are not to be had
_NOISE = 1e-4  # of what is found of t
_DENOMINATORS = (1, 2, 12, 60, 1000, 10**5, 10**8, 10**11)
_MOST_COLUMNS, _MOST_ROWS = 1500, 500
_MOST_DIGITS = 25_000  # binary ones of an entry, times the rows: beyond, an elimination takes seconds
_CHEAP_INSIDE, _MOST_INSIDE = 20_000, 7_000_000  # products of numbers a step: what costs less than another search, and what seconds
_LONG = 1000  # digits with which an elimination takes as long again
_SOLVED, _EXACT, _INSIDE = 3, 5, 5  # steps of an equation and a column to solve them and to make that exact, and of such a product in all
_FLAT = 1e-12  # a pivot taken for 0, by the greatest entry
_PLAIN, _NEAR = 10**7, Fraction(1, 10**16)  # the greatest denominator of a fraction, and how near to it is taken for it


@dataclass(frozen=True)
class Block:
    """The sums of squares of combinations of ``squares``, multiplied by ``factor``; ``name`` tells whoever asks which."""

    name: Any
    factor: Polynomial
    squares: tuple[Polynomial, ...]


@dataclass(frozen=True)
class Multiples:
    """The multiples of ``zero`` by combinations of the monomials ``by``."""

    name: Any
    zero: Polynomial
    by: tuple[Exponents, ...]


@dataclass(frozen=True)
class Balance:
    """What was found: blocks with their Gram matrices, and what each ``Multiples`` is multiplied by."""

    sums: tuple[tuple[Block, Gram], ...]
    multiples: tuple[tuple[Any, Polynomial], ...]


def free(_: int) -> bool:
    """Nobody counts."""
    return True


def balanced(start: Polynomial, blocks: Sequence[Block], multiples: Sequence[Multiples], pays: Pays = free) -> Balance | None:
    """Gram matrices and multipliers with which everything adds up to 0; None where the search finds none, or ``pays`` for no more."""
    left: Sequence[Block] | None = blocks
    while left is not None:
        system = _System.of(start, left, multiples)
        if system is None or not pays(_SOLVED * system.size) or (values := system.solved()) is None or not pays(_EXACT * system.size):
            return None
        exact, left = system.exact(values, pays), None
        if exact is None:
            exact, left = system.inside(values, pays)
        if exact is not None:
            return system.found(exact)
    return None


@dataclass(frozen=True)
class _System:
    """The equations of the coefficients: a column for each entry of a Gram matrix (i <= j) and for each multiplier."""

    start: Polynomial
    blocks: Sequence[Block]
    multiples: Sequence[Multiples]
    columns: Sequence[Polynomial]
    rows: Mapping[Exponents, int]

    @classmethod
    def of(cls, start: Polynomial, blocks: Sequence[Block], multiples: Sequence[Multiples]) -> _System | None:
        """None where they would be too many, or where nothing can cancel some part of ``start``."""
        size = sum(len(b.squares) * (len(b.squares) + 1) // 2 for b in blocks) + sum(len(m.by) for m in multiples)
        if size > _MOST_COLUMNS:
            return None
        columns = []
        for b in blocks:
            for j, q in enumerate(b.squares):
                scaled = times(b.factor, q)
                for i in range(j + 1):
                    both = times(scaled, b.squares[i])
                    columns.append(both if i == j else {m: 2 * c for m, c in both.items()})
        columns += [times(m.zero, {by: Fraction(1)}) for m in multiples for by in m.by]
        reached = sorted(set().union(*columns)) if columns else []
        if not set(start) <= set(reached) or len(reached) > _MOST_ROWS:
            return None
        return cls(start, blocks, multiples, columns, {m: r for r, m in enumerate(reached)})

    @property
    def size(self) -> int:
        """How many numbers the equations have."""
        return len(self.columns) * len(self.rows)

    def solved(self) -> Any | None:
        """The numbers of all columns with G - t I >= 0 for every Gram matrix G and the greatest t <= 1; None where t < 0."""
        sizes = [len(b.squares) for b in self.blocks]
        diagonal = np.array([i == j for size in sizes for j in range(size) for i in range(j + 1)])
        n, m = len(self.columns), len(diagonal)
        table = np.zeros((len(self.rows) + 1 + m, n + 1))  # the equations, then 1 - t, then the cones, upper triangle by column
        bound, goal = np.zeros(len(table)), np.zeros(n + 1)
        for j, p in enumerate(self.columns):
            for k, c in p.items():
                table[self.rows[k], j] = c
        for k, c in self.start.items():
            bound[self.rows[k]] = -c
        scale = max(1.0, float(np.abs(bound).max(initial=0.0)))
        bound, goal[n] = bound / scale, -1.0
        table[len(self.rows), n] = bound[len(self.rows)] = 1.0
        table[len(self.rows) + 1 :, :m] = np.diag(np.where(diagonal, -1.0, -(2**0.5)))
        table[len(self.rows) + 1 :, n] = diagonal
        cones = [clarabel.ZeroConeT(len(self.rows)), clarabel.NonnegativeConeT(1), *map(clarabel.PSDTriangleConeT, sizes)]
        settings = clarabel.DefaultSettings()
        settings.verbose, settings.max_iter = False, 100
        settings.tol_gap_abs = settings.tol_gap_rel = settings.tol_feas = 1e-10
        nothing = sparse.csc_matrix((n + 1, n + 1))
        answer = clarabel.DefaultSolver(nothing, goal, sparse.csc_matrix(table), bound, cones, settings).solve()
        x = np.array(answer.x)
        return scale * x[:n] if np.isfinite(x).all() and "Infeasible" not in str(answer.status) and x[n] >= -_NOISE else None

    def exact(self, values: Any, pays: Pays) -> list[Fraction] | None:
        """Fractions near ``values`` that satisfy the equations, with positive semidefinite Gram matrices."""
        rank, equations = self._independent()
        if equations is None:
            return None
        n = len(self.columns)
        a = flint.fmpq_mat(rank, n, [equations[i, j] for i in range(rank) for j in range(n)])
        b = flint.fmpq_mat(rank, 1, [equations[i, n] for i in range(rank)])
        across = a.transpose()
        normal = a * across
        for d in _DENOMINATORS:
            z = flint.fmpq_mat(n, 1, [flint.fmpq(round(float(x) * d), d) for x in values])
            z = z + across * normal.solve(b - a * z)  # the nearest solution of the equations
            exact = _fractions(z.entries())
            if all(_positive_semidefinite(gram, pays) for gram in self.grams(exact)):
                return exact
        return None

    def inside(self, values: Any, pays: Pays) -> tuple[list[Fraction] | None, list[Block] | None]:
        """The same by more digits than ``values`` have, if but few numbers are left free; else the blocks that may do, if fewer."""
        plain = not any(any(m) for b in self.blocks for m in b.factor)
        rank, equations = self._independent()
        price = self._price()
        if equations is None or price > (_MOST_INSIDE if plain else _CHEAP_INSIDE) or not pays(_INSIDE * int(price)):
            return None, None
        n, table = len(self.columns), [_fractions(row) for row in equations.tolist()[:rank]]
        pivots = [next(j for j in range(n) if row[j]) for row in table]
        chosen = [j for j in range(n) if j not in {*pivots}]

        def solution(free: Mapping[int, Fraction], right: int) -> list[Fraction]:
            z = [free.get(j, Fraction(0)) for j in range(n)]
            for p, row in zip(pivots, table, strict=True):
                z[p] = right * row[n] - sum((row[j] * c for j, c in free.items() if row[j]), Fraction(0))
            return z

        base = list(self.grams(solution({}, 1)))
        ways = [list(self.grams(solution({j: Fraction(1)}, 0))) for j in chosen]
        start, found = [Fraction(float(values[j])) for j in chosen], list[Fraction]()
        for y in inner_point(base, ways, start):
            found = solution(dict(zip(chosen, y, strict=True)), 1)
            if all(_positive_semidefinite(gram, pays) for gram in self.grams(found)):
                return found, None
        return None, self._curved(found) if found else None

    def _price(self) -> float:
        """Products of numbers in a step of that search, all equations being independent; infinite where it is none to be made."""
        free = len(self.columns) - len(self.rows)
        return float("inf") if self.multiples or free <= 0 else free**2 * sum(len(b.squares) ** 2 for b in self.blocks)

    def _curved(self, values: Sequence[Fraction]) -> list[Block] | None:
        """The blocks without the directions in which the Gram matrices are 0, as far as these look rational; None if there are none."""
        grams = list(self.grams(values))
        flat = _FLAT * max(abs(float(x)) for gram in grams for row in gram for x in row)
        kept = [replace(b, squares=_complement(b.squares, gram, flat)) for b, gram in zip(self.blocks, grams, strict=True)]
        less = any(len(b.squares) < len(before.squares) for b, before in zip(kept, self.blocks, strict=True))
        return [b for b in kept if b.squares] if less else None

    def _independent(self) -> tuple[int, Any]:
        """The reduced equations with their right-hand sides; None where they contradict each other."""
        n = len(self.columns)
        table = [[flint.fmpq(0)] * (n + 1) for _ in self.rows]
        for j, p in enumerate(self.columns):
            for m, c in p.items():
                table[self.rows[m]][j] = _rational(c)
        for m, c in self.start.items():
            table[self.rows[m]][n] = _rational(-c)
        reduced, rank = flint.fmpq_mat(len(table), n + 1, [x for row in table for x in row]).rref()
        contradiction = rank > 0 and all(reduced[rank - 1, j] == 0 for j in range(n))
        return rank, None if contradiction else reduced

    def grams(self, values: Sequence[Any]) -> Iterator[list[list[Any]]]:
        """The Gram matrices in the numbers of the columns."""
        first = 0
        for b in self.blocks:
            size = range(len(b.squares))
            yield [[values[first + max(i, j) * (max(i, j) + 1) // 2 + min(i, j)] for j in size] for i in size]
            first += len(size) * (len(size) + 1) // 2

    def found(self, values: Sequence[Fraction]) -> Balance:
        """The numbers of the columns put together again."""
        sums = []
        for b, gram in zip(self.blocks, self.grams(values), strict=True):
            if used := [i for i, row in enumerate(gram) if any(row)]:
                squares = tuple(b.squares[i] for i in used)
                sums.append((replace(b, squares=squares), tuple(tuple(gram[i][j] for j in used) for i in used)))
        rest = iter(values[len(values) - sum(len(m.by) for m in self.multiples) :])
        by = [(m.name, {k: c for k, c in zip(m.by, rest, strict=False) if c}) for m in self.multiples]
        return Balance(tuple(sums), tuple((name, p) for name, p in by if p))


def _positive_semidefinite(rows: list[list[Fraction]], pays: Pays) -> bool:
    """By elimination, the greatest entry of the diagonal first; of numbers too long to eliminate with, False."""
    digits = len(rows) * max((max(abs(x.numerator), x.denominator).bit_length() for row in rows for x in row), default=0)
    if digits > _MOST_DIGITS or not pays(len(rows) ** 3 * (1 + digits // _LONG)):
        return False
    while rows:
        k = max(range(len(rows)), key=lambda i: rows[i][i])
        if (pivot := rows[k][k]) <= 0:
            return not any(map(any, rows))
        left = [i for i in range(len(rows)) if i != k]
        rows = [[rows[i][j] - rows[i][k] * rows[k][j] / pivot for j in left] for i in left]
        if any(row[i] < 0 for i, row in enumerate(rows)):
            return False
    return True


def _complement(squares: tuple[Polynomial, ...], gram: Sequence[Sequence[Fraction]], flat: float) -> tuple[Polynomial, ...]:
    """Combinations of ``squares`` that span what is orthogonal to the null space of ``gram``; all where that does not look rational."""
    rest, kept = np.array(gram, dtype=float), list[int]()
    while rest.diagonal().max() > flat:
        kept.append(k := int(rest.diagonal().argmax()))
        rest -= np.outer(rest[k], rest[k]) / rest[k, k]
    gone = [k for k in range(len(squares)) if k not in kept]
    if not kept or not gone:
        return squares if kept else ()
    inner, outer = (flint.fmpq_mat([[_rational(gram[i][j]) for j in places] for i in kept]) for places in (kept, gone))
    shares = [_fractions(row) for row in inner.solve(outer).tolist()]
    plain = [[x.limit_denominator(_PLAIN) for x in row] for row in shares]
    if any(abs(x - y) > _NEAR for row, given in zip(plain, shares, strict=True) for x, y in zip(row, given, strict=True)):
        return squares
    return tuple(
        _combined([(Fraction(1), squares[k]), *zip(row, (squares[g] for g in gone), strict=True)])
        for k, row in zip(kept, plain, strict=True)
    )


def _combined(terms: Sequence[tuple[Fraction, Polynomial]]) -> Polynomial:
    total: dict[Exponents, Fraction] = {}
    for share, p in terms:
        for m, c in p.items():
            total[m] = total.get(m, Fraction(0)) + share * c
    return {m: c for m, c in total.items() if c}


def _fractions(numbers: Sequence[Any]) -> list[Fraction]:
    return [Fraction(int(x.p), int(x.q)) for x in numbers]


def _rational(x: Fraction) -> Any:
    return flint.fmpq(x.numerator, x.denominator)


def times(p: Polynomial, q: Polynomial) -> Polynomial:
    """Their product."""
    total: dict[Exponents, Fraction] = {}
    for (m, c), (n, d) in pairs(p.items(), q.items()):
        k = tuple(map(int.__add__, m, n))
        total[k] = total.get(k, Fraction(0)) + c * d
    return {m: c for m, c in total.items() if c}
