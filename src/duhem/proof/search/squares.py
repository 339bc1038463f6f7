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
from itertools import product as pairs
from types import MappingProxyType
from typing import Any

__all__ = ["Balance", "Block", "Exponents", "Multiples", "Polynomial", "added", "balanced", "times"]

Exponents = tuple[int, ...]
Polynomial = Mapping[Exponents, Fraction]
Gram = tuple[tuple[Fraction, ...], ...]
_DENOMINATORS = (1, 2, 12, 60, 1000, 10**5, 10**8, 10**11)
_MOST_COLUMNS, _MOST_ROWS = 1500, 500
_MOST_DIGITS = 25_000  # binary ones of an entry, times the rows: beyond, an elimination takes seconds
_FLAT = (1e-4, 1e-5, 1e-6)  # an eigenvalue that small, relative to the greatest, is taken for 0
_BLUNT = MappingProxyType({60: 2e-3})  # the greatest denominator of what is taken for rational, and how near it is
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


def balanced(
    start: Polynomial, blocks: Sequence[Block], multiples: Sequence[Multiples], spheres: Sequence[Sequence[int]] = ()
) -> Balance | None:
    """Gram matrices and multipliers with which everything adds up to 0; None where the search finds none.

    -start is homogeneous in the variables of each of ``spheres``, if they are given, and nothing is known but that it is to be >= 0.
    """
    if spheres and _positive_somewhere(start, spheres):
        return None
    touched = not spheres or bool(multiples) or any(set(b.factor) != {(0,) * len(next(iter(start)))} for b in blocks)
    for flat in (*_FLAT, None):
        system = _System.of(start, blocks, multiples)
        if system is None or (solution := system.solved()) is None:
            return None
        margin, values = solution
        if margin < -1e-4:
            return None
        if (exact := system.exact(values)) is not None:
            return system.found(exact)
        smaller = None if touched else _vanishing(start, blocks, spheres)
        touched = True
        if smaller is None and (flat is None or (smaller := _reduced(system, values, flat)) is None):
            return None
        blocks = smaller
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


def _positive_somewhere(start: Polynomial, spheres: Sequence[Sequence[int]]) -> bool:
    """Whether it is, by far, at one of many points."""
    import numpy as np

    from duhem.proof.search.touching_points import on_spheres, values_at

    factors = [float(c) for c in start.values()]
    return bool(values_at(on_spheres(len(next(iter(start))), spheres, _LOOKS), start).max() > _FAR * np.abs(factors).max())


def _vanishing(start: Polynomial, blocks: Sequence[Block], spheres: Sequence[Sequence[int]]) -> list[Block] | None:
    """The blocks without what does not vanish at the zeros of ``start``, as far as these look rational; None if all does."""
    import numpy as np

    from duhem.proof.search.touching_points import touching_points, values_at

    found = touching_points({m: -c for m, c in start.items()}, spheres, _STARTS * sum(len(b.squares) for b in blocks))
    kept, less = list[Block](), False
    for block in blocks if len(found) else ():
        values = np.stack([values_at(found, q) for q in block.squares], axis=1)
        _, sizes, axes = np.linalg.svd(values)
        sizes = np.concatenate([sizes, np.zeros(len(axes) - len(sizes))])
        drops = sizes[1:] / np.maximum(sizes[:-1], 1e-300)
        last = int(np.argmin(drops)) if len(drops) else 0
        if sizes[0] < _GAP or (len(drops) and drops[last] > _GAP):
            kept.append(block)
            continue
        rank = last + 1 if len(drops) else 1
        precision = max(1e-14, float(sizes[rank] / sizes[0]) if rank < len(sizes) else 0.0)
        left = _complement(block.squares, axes[:rank], {int((0.01 / precision) ** 0.5): 100 * precision})
        less = less or len(left) < len(block.squares)
        if left:
            kept.append(replace(block, squares=left))
    return kept if less else None


def _reduced(system: _System, values: Any, flat: float) -> list[Block] | None:
    """The blocks without the directions in which the Gram matrices are flat, as far as these look rational; None if none is."""
    import numpy as np

    kept, less = list[Block](), False
    for block, gram in zip(system.blocks, system._grams(values), strict=True):
        sizes, axes = np.linalg.eigh(np.array(gram, dtype=float))
        null = sizes < flat * max(1.0, float(np.abs(sizes).max()))
        left = block.squares if not null.any() else _complement(block.squares, axes[:, null].T)
        less = less or len(left) < len(block.squares)
        if left:
            kept.append(replace(block, squares=left))
    return kept if less else None


def _complement(squares: tuple[Polynomial, ...], null: Any, looks: Mapping[int, float] = _BLUNT) -> tuple[Polynomial, ...]:
    """Combinations of ``squares`` that span what is orthogonal to the rows of ``null``, these made rational; all where they are not.

    They are rational if for one of the greatest denominators in ``looks`` all are so near.
    """
    import numpy as np

    rows, pivots = np.array(null), list[int]()
    for r in range(len(rows)):  # Gauss-Jordan, the greatest entry as pivot: entries of a rational space come out rational
        p, c = max(((p, c) for p in range(r, len(rows)) for c in range(rows.shape[1])), key=lambda at: abs(rows[at]))
        rows[[r, p]] = rows[[p, r]]
        rows[r] /= rows[r, c]
        for i in range(len(rows)):
            if i != r:
                rows[i] -= rows[i, c] * rows[r]
        pivots.append(c)
    for most, near in looks.items():
        exact = [[Fraction(float(x)).limit_denominator(most) for x in row] for row in rows]
        if max(abs(float(f) - x) for row, given in zip(exact, rows, strict=True) for f, x in zip(row, given, strict=True)) <= near:
            break
    else:
        return squares
    free = [c for c in range(len(squares)) if c not in pivots]
    found = []
    for f in free:
        parts = [squares[f], *({m: -row[f] * c for m, c in squares[p].items()} for p, row in zip(pivots, exact, strict=True))]
        found.append(added(*parts))
    return tuple(found)


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
