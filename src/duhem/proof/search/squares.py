"""Sums of squares with which a polynomial cancels, found by a conic solver and made exact.

Peyrl, Parrilo (2008), Theor. Comput. Sci. 409, 269: the numbers of a solution inside the cone are rounded and moved back onto
the equations.  On the edge of the cone the directions in which every solution is flat are left out first (facial reduction): where
the form is 0 each square vanishes.  These are found in floats and made rational: a wrong guess finds no identity, and nothing else.
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

__all__ = ["Balance", "Block", "Exponents", "Multiples", "Polynomial", "balanced", "times"]

Exponents = tuple[int, ...]
Polynomial = Mapping[Exponents, Fraction]
Gram = tuple[tuple[Fraction, ...], ...]
_DENOMINATORS = (1, 2, 12, 60, 1000, 10**5, 10**8, 10**11)
_MOST_COLUMNS, _MOST_ROWS = 1500, 500
_MOST_DIGITS = 25_000  # binary ones of an entry, times the rows: beyond, an elimination takes seconds
_CHEAP_INSIDE, _MOST_INSIDE = 20_000, 7_000_000  # products of numbers a step: what costs less than another search, and what seconds
_TRIED, _IMPROVED, _ENOUGH = 40, 80, 1e-12  # random points for each start; how often a start is improved; a gradient taken for 0
_MOST_ENTRIES = 40_000_000  # entries of second derivatives, all starts together
_LOOKS, _FAR = 500, 1e-6  # points at which a form is looked at, and what is taken for another sign
_STARTS, _GAP = 4, 1e-4  # looks for zeros a square; how far singular values drop behind the last that is not 0


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


def balanced(
    start: Polynomial, blocks: Sequence[Block], multiples: Sequence[Multiples], spheres: Sequence[Sequence[int]] = ()
) -> Balance | None:
    """Gram matrices and multipliers with which everything adds up to 0; None where the search finds none.

    -start is homogeneous in the variables of each of ``spheres``, if they are given, and nothing is known but that it is to be >= 0.
    """
    if spheres and _positive_somewhere(start, spheres):
        return None
    plain = bool(spheres) and not multiples and all(set(b.factor) == {(0,) * len(next(iter(start)))} for b in blocks)
    for again in (False, True):
        system = _System.of(start, blocks, multiples)
        if system is None or (solution := system.solved()) is None:
            return None
        margin, values = solution
        if margin < -1e-4:
            return None
        if (exact := system.exact(values)) is not None:
            return system.found(exact)
        found = _vanishing(start, blocks, spheres) if plain and not again else None
        if found is None:
            cheap = system.price_inside() <= (_MOST_INSIDE if plain and not again else _CHEAP_INSIDE)
            exact = system.exact_inside(values) if cheap else None
            return None if exact is None else system.found(exact)
        blocks = found
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

    def solved(self) -> tuple[float, Any] | None:
        """The greatest t <= 1 with G - t I >= 0 for every Gram matrix G, and the numbers of all columns."""
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
        return (float(x[n]), scale * x[:n]) if np.isfinite(x).all() and "Infeasible" not in str(answer.status) else None

    def exact(self, values: Any) -> list[Fraction] | None:
        """Fractions near ``values`` that satisfy the equations, with positive semidefinite Gram matrices."""
        nearest = self._projected()
        if nearest is None:
            return None
        for d in _DENOMINATORS:
            exact = nearest([Fraction(round(float(x) * d), d) for x in values])
            if all(_positive_semidefinite(gram) for gram in self.grams(exact)):
                return exact
        return None

    def exact_inside(self, values: Any) -> list[Fraction] | None:
        """The same by more digits than ``values`` have, where but few numbers are left free by the equations."""
        rank, equations = self._independent()
        if equations is None:
            return None
        n, table = len(self.columns), [[Fraction(int(x.p), int(x.q)) for x in row] for row in equations.tolist()[:rank]]
        pivots = [next(j for j in range(n) if row[j]) for row in table]
        chosen = [j for j in range(n) if j not in {*pivots}]

        def solution(free: Mapping[int, Fraction], right: int) -> list[Fraction]:
            z = [free.get(j, Fraction(0)) for j in range(n)]
            for p, row in zip(pivots, table, strict=True):
                z[p] = right * row[n] - sum((row[j] * c for j, c in free.items() if row[j]), Fraction(0))
            return z

        base = list(self.grams(solution({}, 1)))
        ways = [list(self.grams(solution({j: Fraction(1)}, 0))) for j in chosen]
        start = [Fraction(float(values[j])) for j in chosen]
        for y in inner_point(base, ways, start):
            exact = solution(dict(zip(chosen, y, strict=True)), 1)
            if all(_positive_semidefinite(gram) for gram in self.grams(exact)):
                return exact
        return None

    def price_inside(self) -> float:
        """Products of numbers in a step of that search, all equations being independent; infinite where it is none to be made."""
        free = len(self.columns) - len(self.rows)
        return float("inf") if self.multiples or free <= 0 else free**2 * sum(len(b.squares) ** 2 for b in self.blocks)

    def _projected(self) -> Callable[[Sequence[Fraction]], list[Fraction]] | None:
        """The way to the nearest solution of the equations; None where they contradict each other."""
        rank, equations = self._independent()
        if equations is None:
            return None
        n = len(self.columns)
        a = flint.fmpq_mat(rank, n, [equations[i, j] for i in range(rank) for j in range(n)])
        b = flint.fmpq_mat(rank, 1, [equations[i, n] for i in range(rank)])
        across = a.transpose()
        normal = a * across

        def nearest(values: Sequence[Fraction]) -> list[Fraction]:
            z = flint.fmpq_mat(n, 1, [flint.fmpq(x.numerator, x.denominator) for x in values])
            z = z + across * normal.solve(b - a * z)
            return [Fraction(int(z[i, 0].p), int(z[i, 0].q)) for i in range(n)]

        return nearest

    def _independent(self) -> tuple[int, Any]:
        """The reduced equations with their right-hand sides; None where they contradict each other."""
        n = len(self.columns)
        table = [[flint.fmpq(0)] * (n + 1) for _ in self.rows]
        for j, p in enumerate(self.columns):
            for m, c in p.items():
                table[self.rows[m]][j] = flint.fmpq(c.numerator, c.denominator)
        for m, c in self.start.items():
            table[self.rows[m]][n] = flint.fmpq(-c.numerator, c.denominator)
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


def _positive_semidefinite(rows: list[list[Fraction]]) -> bool:
    """By elimination, the greatest entry of the diagonal first; of numbers too long to eliminate with, False."""
    digits = max((max(abs(x.numerator), x.denominator).bit_length() for row in rows for x in row), default=0)
    if digits * len(rows) > _MOST_DIGITS:
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


def _positive_somewhere(start: Polynomial, spheres: Sequence[Sequence[int]]) -> bool:
    """Whether it is, by far, at one of many points."""
    values = _values_at(_on_spheres(len(next(iter(start))), spheres, _LOOKS), start)
    return bool(values.max() > _FAR * max(abs(float(c)) for c in start.values()))


def _vanishing(start: Polynomial, blocks: Sequence[Block], spheres: Sequence[Sequence[int]]) -> list[Block] | None:
    """The blocks without what does not vanish at the zeros of ``start``, as far as these look rational; None if all does."""
    points = _touching_points({m: -c for m, c in start.items()}, spheres, _STARTS * sum(len(b.squares) for b in blocks))
    spans = list[tuple[Any, tuple[int, float]]]()
    for block in blocks if len(points) else ():
        _, sizes, axes = np.linalg.svd(_values_at(points, *block.squares))
        sizes = np.concatenate([sizes, np.zeros(len(axes) - len(sizes))])
        drops = sizes[1:] / np.maximum(sizes[:-1], 1e-300)
        rank, precision = (int(np.argmin(drops)) + 1 if len(drops) else 1), 1e-14  # how many directions, and how sharply they end
        if len(drops):
            precision = max(precision, float(sizes[rank] / sizes[0]))
        none = sizes[0] < _GAP or (len(drops) and drops[rank - 1] > _GAP)
        spans.append((axes[: 0 if none else rank], (int((0.01 / precision) ** 0.5), 100 * precision)))
    return _without(blocks, spans)


def _without(blocks: Sequence[Block], spans: Sequence[tuple[Any, tuple[int, float]]]) -> list[Block] | None:
    """The blocks without some directions each; None if that leaves out nothing."""
    kept = [replace(b, squares=_complement(b.squares, *span)) for b, span in zip(blocks, spans, strict=False)]
    less = any(len(b.squares) < len(before.squares) for b, before in zip(kept, blocks, strict=False))
    return [b for b in kept if b.squares] if less else None


def _complement(squares: tuple[Polynomial, ...], null: Any, rational: tuple[int, float]) -> tuple[Polynomial, ...]:
    """Combinations of ``squares`` that span what is orthogonal to the rows of ``null``, these made rational; all where they are not.

    They are rational if all are as near as said to fractions with such denominators.
    """
    rows, pivots, (most, near) = null.copy(), list[int](), rational
    for r in range(len(rows)):  # Gauss-Jordan, the greatest entry as pivot: entries of a rational space come out rational
        p, c = max(((p, c) for p in range(r, len(rows)) for c in range(rows.shape[1])), key=lambda at: abs(rows[at]))
        rows[[r, p]] = rows[[p, r]]
        rows[r] /= rows[r, c]
        for i in range(len(rows)):
            if i != r:
                rows[i] -= rows[i, c] * rows[r]
        pivots.append(c)
    exact = [[Fraction(float(x)).limit_denominator(most) for x in row] for row in rows]
    if any(abs(float(f) - x) > near for row, given in zip(exact, rows, strict=True) for f, x in zip(row, given, strict=True)):
        return squares
    found = list[Polynomial]()
    for f in (c for c in range(len(squares)) if c not in pivots):
        taken = [(f, Fraction(1)), *((p, -row[f]) for p, row in zip(pivots, exact, strict=True))]
        found.append(added(*({m: x * c for m, c in squares[k].items()} for k, x in taken if x)))
    return tuple(found)


def added(*polynomials: Polynomial) -> Polynomial:
    """Their sum."""
    total: dict[Exponents, Fraction] = {}
    for p in polynomials:
        for m, c in p.items():
            total[m] = total.get(m, Fraction(0)) + c
    return {m: c for m, c in total.items() if c}


def times(p: Polynomial, q: Polynomial) -> Polynomial:
    """Their product."""
    total: dict[Exponents, Fraction] = {}
    for (m, c), (n, d) in pairs(p.items(), q.items()):
        k = tuple(map(int.__add__, m, n))
        total[k] = total.get(k, Fraction(0)) + c * d
    return {m: c for m, c in total.items() if c}


def _slope(p: Polynomial, i: int) -> Polynomial:
    return {(*m[:i], m[i] - 1, *m[i + 1 :]): c * m[i] for m, c in p.items() if m[i]}


def _values_at(x: Any, *forms: Polynomial) -> Any:
    """The forms at each row of x, a column each."""
    monomials = list(dict.fromkeys(m for p in forms for m in p))
    powers = np.array(monomials).reshape(len(monomials), x.shape[1])
    table = x[:, :, None] ** np.arange(powers.max(initial=0) + 1)
    values = np.ones((len(x), len(monomials)))
    for i in range(x.shape[1]):
        values *= table[:, i, powers[:, i]]
    return values @ np.array([[float(p.get(m, 0)) for p in forms] for m in monomials])


def _on_spheres(n: int, spheres: Sequence[Sequence[int]], count: int) -> Any:
    """Random points of n variables (fixed seed), those of each sphere of unit length."""
    x = np.random.default_rng(7).standard_normal((count, n))
    for s in spheres:
        x[:, s] /= np.linalg.norm(x[:, s], axis=1, keepdims=True)
    return x


def _touching_points(form: Polynomial, spheres: Sequence[Sequence[int]], starts: int) -> Any:
    """Zeros of the form as rows, the variables of each of ``spheres``, in which it is homogeneous, having unit length."""
    n = len(next(iter(form)))
    if starts * n * n * len(form) > _MOST_ENTRIES:
        return np.empty((0, n))
    slopes = [_slope(form, i) for i in range(n)]
    bends = [_slope(p, j) for p in slopes for j in range(n)]
    lengths: list[Polynomial] = [{tuple(2 * (i == j) for i in range(n)): Fraction(1) for j in s} for s in spheres]
    gaps, derivatives = [*slopes, *lengths], [*bends, *(_slope(p, j) for p in lengths for j in range(n))]
    level = np.array([0.0] * n + [1.0] * len(spheres))
    x = _on_spheres(n, spheres, _TRIED * starts)
    x = x[np.argsort(_values_at(x, form)[:, 0], kind="stable")[:starts]]
    gap, damping = _values_at(x, *gaps) - level, np.full(len(x), 1e-2)
    for _ in range(_IMPROVED):
        size = (gap**2).sum(axis=1)
        if (size < _ENOUGH**2).all():
            break
        left, sizes, axes = np.linalg.svd(_values_at(x, *derivatives).reshape(len(x), len(gaps), n), full_matrices=False)
        parts = np.einsum("pgk,pg->pk", left, gap) * sizes / (sizes**2 + (damping * sizes[:, 0] ** 2)[:, None] + 1e-300)
        tried = x - np.einsum("pkv,pk->pv", axes, parts)
        new_gap = _values_at(tried, *gaps) - level
        better = (new_gap**2).sum(axis=1) < size
        x, gap = np.where(better[:, None], tried, x), np.where(better[:, None], new_gap, gap)
        damping = np.clip(np.where(better, damping / 10, damping * 5), 1e-16, 1e6)
    return x[np.abs(gap).max(axis=1) < _ENOUGH * max(1.0, max(abs(float(c)) for c in form.values()))]
