"""Sums of squares with which a polynomial cancels, found by a conic solver and made exact.

Peyrl, Parrilo (2008), Theor. Comput. Sci. 409, 269: the numbers of a solution inside the cone are rounded and moved back onto
the equations.  On the edge of the cone the directions in which every solution is flat are left out first (facial reduction).
Nothing here is trusted: what comes out is an identity of fractions.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from functools import partial
from typing import Any

from duhem.proof.search.blocks import Block, Exponents, Polynomial, added, times
from duhem.proof.search.faces import combined, positive_somewhere, stretched, vanishing, without_flat_directions
from duhem.proof.search.inner_point import inner_point

__all__ = ["Balance", "Multiples", "balanced"]

Gram = tuple[tuple[Fraction, ...], ...]
_DENOMINATORS = (1, 2, 12, 60, 1000, 10**5, 10**8, 10**11)
_MOST_COLUMNS, _MOST_ROWS = 1500, 500
_MOST_DIGITS = 25_000  # binary ones of an entry, times the rows: beyond, an elimination takes seconds
_PROJECTED, _INSIDE = 400, 0.2  # times a solution is moved onto the equations and so far into the cone, in its own units
_CHEAP_INSIDE, _MOST_INSIDE = 20_000, 7_000_000  # products of numbers a step: what costs less than another search, and what seconds
_SETTLED = 3  # times it is moved onto the equations in the end
_FLAT = (1e-4, 1e-5, 1e-6)  # an eigenvalue that small, relative to the greatest, is taken for 0


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
    if spheres and positive_somewhere(start, spheres):
        return None
    touched = not spheres or bool(multiples) or any(set(b.factor) != {(0,) * len(next(iter(start)))} for b in blocks)
    for flat in (*_FLAT, None):
        system = _System.of(start, blocks, multiples)
        if system is None or (solution := system.solved()) is None:
            return None
        margin, values = solution
        if margin < -1e-4:
            return None
        exact, price = system.exact(values), system.price_inside()
        if exact is None and price <= _CHEAP_INSIDE:
            exact = system.exact_inside(values)
        found = None if touched or exact is not None else vanishing(start, blocks, spheres)
        if exact is None and found is None and not touched:
            exact = system.exact_by_stretching(spheres)
            if exact is None and _CHEAP_INSIDE < price <= _MOST_INSIDE:
                exact = system.exact_inside(values)
        if exact is not None:
            return system.found(exact)
        touched = True
        if found is None and flat is not None:
            found = without_flat_directions(blocks, list(system._grams(values)), flat)
        if found is None:
            return None
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
        import clarabel
        import numpy as np
        from scipy import sparse

        n, entries = len(self.columns), [(self.rows[m], j, float(c)) for j, p in enumerate(self.columns) for m, c in p.items()]
        rhs = np.zeros(len(self.rows))
        for m, c in self.start.items():
            rhs[self.rows[m]] = -float(c)
        scale = max(1.0, float(np.abs(rhs).max(initial=0.0)))
        at, to, what = zip(*entries, strict=True)
        equations = sparse.csc_matrix((what, (at, to)), shape=(len(self.rows), n + 1))
        parts, right = [equations, sparse.csc_matrix(([1.0], ([0], [n])), shape=(1, n + 1))], [rhs / scale, np.ones(1)]
        cones: list[Any] = [clarabel.ZeroConeT(len(self.rows)), clarabel.NonnegativeConeT(1)]
        first = 0
        for b in self.blocks:
            size = len(b.squares)
            upper = [(i, j) for j in range(size) for i in range(j + 1)]
            cells = [(r, first + r, -1.0 if i == j else -(2**0.5)) for r, (i, j) in enumerate(upper)]
            cells += [(r, n, 1.0) for r, (i, j) in enumerate(upper) if i == j]
            at, to, what = zip(*cells, strict=True)
            parts.append(sparse.csc_matrix((what, (at, to)), shape=(len(upper), n + 1)))
            right.append(np.zeros(len(upper)))
            cones.append(clarabel.PSDTriangleConeT(size))
            first += len(upper)
        goal = np.zeros(n + 1)
        goal[n] = -1.0
        settings = clarabel.DefaultSettings()
        settings.verbose, settings.max_iter = False, 100
        settings.tol_gap_abs = settings.tol_gap_rel = settings.tol_feas = 1e-10
        matrix, bound = sparse.vstack(parts).tocsc(), np.concatenate(right)
        answer = clarabel.DefaultSolver(sparse.csc_matrix((n + 1, n + 1)), goal, matrix, bound, cones, settings).solve()
        x = np.array(answer.x)
        return (float(x[n]), scale * x[:n]) if np.isfinite(x).all() and "Infeasible" not in str(answer.status) else None

    def exact(self, values: Any) -> list[Fraction] | None:
        """Fractions near ``values`` that satisfy the equations, with positive semidefinite Gram matrices."""
        alone = self._alone()
        nearest = partial(self._corrected, alone) if alone else self._projected()
        if nearest is None:
            return None
        for d in _DENOMINATORS:
            exact = nearest([Fraction(round(float(x) * d), d) for x in values])
            if all(_positive_semidefinite(gram) for gram in self._grams(exact)):
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

        base = list(self._grams(solution({}, 1)))
        ways = [list(self._grams(solution({j: Fraction(1)}, 0))) for j in chosen]
        start = [Fraction(float(values[j])) for j in chosen]
        for y in inner_point(base, ways, start):
            exact = solution(dict(zip(chosen, y, strict=True)), 1)
            if all(_positive_semidefinite(gram) for gram in self._grams(exact)):
                return exact
        return None

    def price_inside(self) -> float:
        """Products of numbers in a step of that search, all equations being independent; infinite where it is none to be made."""
        free = len(self.columns) - len(self.rows)
        return float("inf") if self.multiples or free <= 0 else free**2 * sum(len(b.squares) ** 2 for b in self.blocks)

    def exact_by_stretching(self, spheres: Sequence[Sequence[int]]) -> list[Fraction] | None:
        """The same from a solution in other units, where a margin is so thin that in these it drowns; for columns in one row each."""
        import numpy as np

        alone = self._alone()
        if not alone or (matrices := stretched(self.start, self.blocks, spheres)) is None:
            return None
        changed = [
            replace(b, squares=tuple(combined(b.squares, row) for row in rows)) for b, rows in zip(self.blocks, matrices, strict=True)
        ]
        other = _System.of(self.start, changed, ())
        if other is None or other.rows.keys() != self.rows.keys() or (solution := other.solved()) is None or solution[0] <= 0:
            return None
        grams = [np.array(gram, dtype=float) for gram in other._grams(solution[1])]
        try:
            units = [np.linalg.cholesky(gram).T @ np.array(rows, dtype=float) for gram, rows in zip(grams, matrices, strict=True)]
        except np.linalg.LinAlgError:
            return None
        exact_units = [[[Fraction(float(x)) for x in row] for row in unit] for unit in units]
        table, target = self._table(units), np.zeros(len(self.rows))
        for m, c in self.start.items():
            target[self.rows[m]] = -float(c)
        back, values = np.linalg.pinv(table), [np.eye(len(unit)) for unit in units]
        for _ in range(_PROJECTED):  # onto the equations and into the cone in turn
            values = _less(values, back @ (table @ np.concatenate([v.ravel() for v in values]) - target))
            spectra = [np.linalg.eigh(v) for v in values]
            if min(float(sizes[0]) for sizes, _ in spectra) > _INSIDE / 2:
                break
            values = [axes @ np.diag(np.maximum(sizes, _INSIDE)) @ axes.T for sizes, axes in spectra]
        here = list[Fraction]()
        for _ in range(_SETTLED):
            here = [x for gram, rows in zip(values, exact_units, strict=True) for x in _upper(_congruent(gram, rows))]
            gap, parts = np.zeros(len(self.rows)), ({m: x * c for m, c in p.items()} for x, p in zip(here, self.columns, strict=True))
            for m, missing in added(self.start, *parts).items():
                gap[self.rows[m]] = float(missing)
            values = _less(values, back @ gap)
        exact = self._corrected(alone, here)
        return exact if all(_positive_semidefinite(gram) for gram in self._grams(exact)) else None

    def _table(self, units: Sequence[Any]) -> Any:
        """The equations by the entries of matrices Y, the Gram matrices being U' Y U."""
        import numpy as np

        table, first, parts = np.zeros((len(self.rows), len(self.columns))), 0, list[Any]()
        for j, p in enumerate(self.columns):
            for m, c in p.items():
                table[self.rows[m], j] = float(c)
        for unit in units:
            size = len(unit)
            cells = [(i, j) for j in range(size) for i in range(j + 1)]
            both = (np.outer(unit[:, i], unit[:, j]) for i, j in cells)
            entries = np.stack([((b + b.T) / 2).ravel() for b in both])
            parts.append(table[:, first : first + len(cells)] @ entries)
            first += len(cells)
        return np.hstack(parts)

    def _alone(self) -> Mapping[int, Sequence[tuple[int, Fraction]]]:
        """For each row the columns in nothing but it, with their numbers there; empty where some row has none."""
        alone: dict[int, list[tuple[int, Fraction]]] = {}
        for j, p in enumerate(self.columns):
            if len(p) == 1:
                ((m, c),) = p.items()
                alone.setdefault(self.rows[m], []).append((j, c))
        return alone if len(alone) == len(self.rows) else {}

    def _corrected(self, alone: Mapping[int, Sequence[tuple[int, Fraction]]], values: Sequence[Fraction]) -> list[Fraction]:
        """What is missing in each row, given to the columns in nothing but it: the denominators stay small."""
        z, parts = list(values), ({m: x * c for m, c in p.items()} for x, p in zip(values, self.columns, strict=True) if x)
        for m, missing in added(self.start, *parts).items():
            own = alone[self.rows[m]]
            size = sum(c * c for _, c in own)
            for j, c in own:
                z[j] -= missing * c / size
        return z

    def _projected(self) -> Callable[[Sequence[Fraction]], list[Fraction]] | None:
        """The way to the nearest solution of the equations; None where they contradict each other."""
        import flint

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
        import flint

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

    def _grams(self, values: Sequence[Any]) -> Iterator[list[list[Any]]]:
        first = 0
        for b in self.blocks:
            size = range(len(b.squares))
            yield [[values[first + max(i, j) * (max(i, j) + 1) // 2 + min(i, j)] for j in size] for i in size]
            first += len(size) * (len(size) + 1) // 2

    def found(self, values: Sequence[Fraction]) -> Balance:
        """The numbers of the columns put together again."""
        sums = []
        for b, gram in zip(self.blocks, self._grams(values), strict=True):
            if used := [i for i, row in enumerate(gram) if any(row)]:
                squares = tuple(b.squares[i] for i in used)
                sums.append((replace(b, squares=squares), tuple(tuple(gram[i][j] for j in used) for i in used)))
        rest = iter(values[len(values) - sum(len(m.by) for m in self.multiples) :])
        by = [(m.name, {k: c for k, c in zip(m.by, rest, strict=False) if c}) for m in self.multiples]
        return Balance(tuple(sums), tuple((name, p) for name, p in by if p))


def _less(matrices: Sequence[Any], entries: Any) -> list[Any]:
    """The symmetric matrices without the entries, one after the other."""
    left = []
    for one in matrices:
        part, entries = entries[: one.size].reshape(one.shape), entries[one.size :]
        left.append(one - (part + part.T) / 2)
    return left


def _congruent(gram: Any, rows: Sequence[Sequence[Fraction]]) -> list[list[Fraction]]:
    """S' G S."""
    exact = [[Fraction(float(x)) for x in row] for row in gram]
    size = range(len(exact))
    half = [[sum((exact[i][k] * rows[k][j] for k in size if rows[k][j]), Fraction(0)) for j in size] for i in size]
    return [[sum((rows[k][i] * half[k][j] for k in size if rows[k][i]), Fraction(0)) for j in size] for i in size]


def _upper(gram: Sequence[Sequence[Fraction]]) -> list[Fraction]:
    """Its entries as the columns have them."""
    return [gram[i][j] for j in range(len(gram)) for i in range(j + 1)]


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
