"""Identities by which polynomial conditions exclude each other (Stengle 1974), as the text that a checker reads.

A product of conditions > 0, plus sums of squares times products of conditions >= 0, plus multiples of what is 0, adds up to 0.
Weights under which all conditions are homogeneous, and changes of sign that leave them as they are, say which terms may occur.

The sums of squares are found by a conic solver and made exact: Peyrl, Parrilo (2008), Theor. Comput. Sci. 409, 269: the numbers of a
solution inside the cone are rounded and moved back onto the equations.  On the edge of the cone the directions in which every solution is
flat are left out first (facial reduction).  These are found in many digits and made rational: a wrong guess finds no identity, and nothing
else.  Where the slice of the cone is thin a point inside is found to many digits: of the matrices B + y_1 N_1 + y_2 N_2 + ... that are
positive definite one is sought by Newton's method on the barrier -log det (Nesterov, Nemirovskii 1994), on the way from B + s I, s large,
to s < 0.  It does not matter to the barrier how thin the slice is, and many digits bear it.
Nothing here is trusted: what comes out is an identity of fractions.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from functools import reduce
from itertools import combinations, combinations_with_replacement, islice, product
from math import comb
from typing import Any

import clarabel
import flint
import numpy as np
from scipy import sparse

from duhem.expression.balls import ball, precision

__all__ = ["Condition", "Pays", "Polynomial", "identity", "inner_point", "text"]

Exponents = tuple[int, ...]
Polynomial = Mapping[Exponents, Fraction]
Gram = tuple[tuple[Fraction, ...], ...]
Blocks = Sequence[Sequence[Sequence[Fraction]]]  # a symmetric matrix by the blocks on its diagonal
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
_BITS, _STEPS = 256, 120
_THINNEST = 1e-22  # s, of a matrix with entries up to 1, below which the slice is taken to have no inside
_FASTER = 20.0  # how much more s counts after each step that came near the middle
_SHORT = 0.9  # of the way to the edge of the cone
_FINEST = 40  # digits of what is found
_ONE = Fraction(1)
_MOST_TERMS = 20_000  # that a block may be chosen from
_TERM = 2  # steps of a term and a product
_MOST_STARTS = 6  # of the same degree
_FURTHER = (0, 2, 4)  # degrees beyond that of the conditions


@dataclass(frozen=True)
class Condition:
    """``poly`` ``op`` 0, with op one of ">", ">=", "=="; ``name`` is how the checker is told of it."""

    name: str
    poly: Polynomial
    op: str

    @property
    def degree(self) -> int:
        """The greatest of a term."""
        return max(map(sum, self.poly))

    def uses(self) -> set[int]:
        """The places of the variables in it."""
        return {i for m in self.poly for i, k in enumerate(m) if k}

    def over(self, places: Sequence[int]) -> Condition:
        """The same in these variables alone."""
        return Condition(self.name, {tuple(m[i] for i in places): c for m, c in self.poly.items()}, self.op)


def identity(names: Sequence[str], first: Condition, others: Sequence[Condition], pays: Pays) -> dict[str, Any] | None:
    """That ``first`` and ``others`` cannot hold together; None where no identity of low degree was found for what ``pays`` allows.

    ``names`` are the variables as the checker spells them.  Each identity has ``first`` in it: alone among the strict ones if
    it is strict, else multiplied by a square.  Only conditions in variables of its own and of the equations are used.
    """
    places = sorted(first.uses().union(*(c.uses() for c in others if c.op == "==")))
    stated = [c.over(places) for c in (first, *others) if c.uses() <= set(places)]
    if any(not c.poly for c in stated):
        return None
    strict = [c for c in stated[1:] if c.op == ">" and len(c.poly) == 1]
    bounded = sum(c.op != "==" for c in stated[1:])
    tried = list[Any]()
    both = dict.fromkeys(_Classes.of(stated, free) for free in (True, False))
    for degree, classes in product([max(c.degree for c in stated) + further for further in _FURTHER], both):
        for chosen in islice(_first_products(stated[0], strict, degree + degree % 2, classes), _MOST_STARTS):
            for width in range(min(bounded, 1), min(bounded, 2) + 1):
                if not pays(_price(stated, degree + degree % 2, width)):
                    return None
                start, blocks, multiples = _posed(stated, chosen, degree + degree % 2, width, classes)
                size = (chosen, classes, tuple(len(b.squares) for b in blocks), tuple(len(by) for _, by in multiples))
                if size not in tried and (found := balanced(start, blocks, multiples, pays)) is not None:
                    return _as_text(chosen, found, [names[i] for i in places])
                tried.append(size)
    return None


Multiples = tuple[Condition, tuple[Exponents, ...]]  # of what is 0, by combinations of these monomials


@dataclass(frozen=True)
class _Classes:
    """``weights``: under x_i -> s^w_i x_i every condition gets a factor; ``flips``: these signs leave it (an equation: up to sign)."""

    weights: tuple[tuple[int, ...], ...]
    flips: tuple[tuple[int, ...], ...]

    @classmethod
    def of(cls, stated: Sequence[Condition], free: bool) -> _Classes:
        """``free``: a condition x > 0 or x >= 0 is not to be used as a factor, so that the sign of x may be turned."""
        n = len(next(iter(stated[0].poly)))
        gaps, parities = list[Exponents](), list[Exponents]()
        for c in stated:
            base = next(iter(c.poly))
            differences = [tuple(map(int.__sub__, m, base)) for m in c.poly]
            gaps += differences
            if c is stated[0] or not free or len(c.poly) > 1 or sum(base) != 1:
                parities += differences if c.op == "==" else list(c.poly)
        weights = _null_space(list(dict.fromkeys(gaps)), n)
        flips = tuple(s for s in product((0, 1), repeat=n) if any(s) and all(_dot(s, m) % 2 == 0 for m in parities))
        return cls(weights, flips)

    def weight(self, m: Exponents) -> tuple[int, ...]:
        return tuple(_dot(w, m) for w in self.weights)

    def signs(self, m: Exponents) -> tuple[int, ...]:
        return tuple(_dot(s, m) % 2 for s in self.flips)


def _null_space(rows: Sequence[Exponents], n: int) -> tuple[tuple[int, ...], ...]:
    """Whole vectors that span what is orthogonal to the rows."""
    vectors, rank = flint.fmpz_mat(len(rows), n, [x for row in rows for x in row]).nullspace()
    return tuple(tuple(int(vectors[i, j]) for i in range(n)) for j in range(rank))


def _dot(a: Sequence[int], b: Sequence[int]) -> int:
    return sum(map(int.__mul__, a, b))


def _first_products(first: Condition, strict: Sequence[Condition], degree: int, classes: _Classes) -> Iterator[tuple[Condition, ...]]:
    """Products of conditions > 0 to begin with, the longest first: the first condition if it is strict, and variables of one sign.

    Where it is not strict, they have its weight, so that it may be taken times a number.
    """
    own = (first,) if first.op == ">" else ()
    room = degree - sum(c.degree for c in own)
    base = next(iter(first.poly))
    for size in range(room if strict else 0, -1, -1):
        for powers in _exponents(len(strict), size):
            factors = tuple(c for c, n in zip(strict, powers, strict=True) for _ in range(n))
            monomial = tuple(map(sum, zip(*(next(iter(c.poly)) for c in factors), strict=True))) if factors else (0,) * len(base)
            if any(classes.signs(monomial)):
                continue  # what the identity's other terms cannot cancel
            if own or classes.weight(monomial) == classes.weight(base) or not classes.weights:
                yield (*own, *factors)


def _exponents(n: int, total: int) -> Iterator[Exponents]:
    """All of n variables and of one total degree."""
    return (tuple(map(some.count, range(n))) for some in combinations_with_replacement(range(n), total))


def _price(stated: Sequence[Condition], degree: int, width: int) -> int:
    """Steps to pose it: each product is held against every term."""
    n, bounds = len(next(iter(stated[0].poly))), sum(c.op != "==" for c in stated[1:])
    return _TERM * comb(n + degree, n) * (len(stated) + sum(comb(bounds, w) for w in range(width + 1)))


def _posed(
    stated: Sequence[Condition], chosen: Sequence[Condition], degree: int, width: int, classes: _Classes
) -> tuple[Polynomial, list[Block], list[Multiples]]:
    """What is to be balanced for an identity that begins with the product of ``chosen``, with products of at most ``width`` bounds."""
    n = len(next(iter(stated[0].poly)))
    one: Polynomial = {(0,) * n: _ONE}
    start = reduce(times, (c.poly for c in chosen), one)
    terms = [m for total in range(degree + 1) for m in _exponents(n, total)] if comb(n + degree, n) <= _MOST_TERMS else []
    target = classes.weight(next(iter(start)))

    def fitting(poly: Polynomial, copies: int) -> Iterator[Exponents]:
        """The monomials that, taken ``copies`` times and with ``poly``, have the degree and weight of the start."""
        size, weight = max(map(sum, poly)), classes.weight(next(iter(poly)))
        for m in terms:
            reached = tuple(copies * w + v for w, v in zip(classes.weight(m), weight, strict=True))
            if copies * sum(m) + size <= degree and reached == target:
                yield m

    goal = [c for c in stated[:1] if c.op == ">="]
    bounds = [c for c in stated[1:] if c.op != "=="]
    blocks = list[Block]()
    for taken in (x for w in range(width + 1) for b in combinations(bounds, w) for x in ((b, (*goal, *b)) if goal else (b,))):
        factor = reduce(times, (c.poly for c in taken), one)
        by_signs: dict[tuple[int, ...], list[Polynomial]] = {}
        for m in fitting(factor, 2) if not any(classes.signs(next(iter(factor)))) else ():
            by_signs.setdefault(classes.signs(m), []).append({m: _ONE})
        blocks += [Block(taken, factor, tuple(squares)) for squares in by_signs.values()]
    multiples = [
        (c, tuple(m for m in fitting(c.poly, 1) if classes.signs(m) == classes.signs(next(iter(c.poly))))) for c in stated if c.op == "=="
    ]
    return start, blocks, multiples


def _as_text(chosen: Sequence[Condition], found: Balance, names: Sequence[str]) -> dict[str, Any]:
    sums, multiples = found
    return {
        "strict": [c.name for c in chosen],
        "sums": [
            {"times": [c.name for c in b.taken], "of": [text(q, names) for q in b.squares], "gram": [[str(x) for x in row] for row in gram]}
            for b, gram in sums
        ],
        "multiples": [{"of": c.name, "by": text(p, names)} for c, p in multiples],
    }


def text(p: Polynomial, names: Sequence[str]) -> str:
    """3/2*a**2*b + (-1*c) as the vocabulary spells it."""
    parts = []
    for m, c in p.items():
        powers = [x if k == 1 else f"{x}**{k}" for x, k in zip(names, m, strict=True) if k]
        parts.append("*".join([*([str(c)] if c != 1 or not powers else []), *powers]))
    return " + ".join(f"({x})" if x.startswith("-") else x for x in parts)


# -- sums of squares ---------------------------------------------------------------------------------------------------


@dataclass(frozen=True)
class Block:
    """The sums of squares of combinations of ``squares``, multiplied by ``factor``, a product of conditions ``taken``."""

    taken: tuple[Condition, ...]
    factor: Polynomial
    squares: tuple[Polynomial, ...]


def balanced(start: Polynomial, blocks: Sequence[Block], multiples: Sequence[Multiples], pays: Pays) -> Balance | None:
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


Balance = tuple[Sequence[tuple[Block, Gram]], Sequence[tuple[Condition, Polynomial]]]  # Gram matrices, and what equations are multiplied by


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
        size = sum(len(b.squares) * (len(b.squares) + 1) // 2 for b in blocks) + sum(len(by) for _, by in multiples)
        if size > _MOST_COLUMNS:
            return None
        columns = []
        for b in blocks:
            for j, q in enumerate(b.squares):
                scaled = times(b.factor, q)
                for i in range(j + 1):
                    both = times(scaled, b.squares[i])
                    columns.append(both if i == j else {m: 2 * c for m, c in both.items()})
        columns += [times(c.poly, {m: _ONE}) for c, by in multiples for m in by]
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
        parts, nothing = (*self.columns, {m: -c for m, c in self.start.items()}), flint.fmpq(0)
        reduced, rank = flint.fmpq_mat([[_rational(p[m]) if m in p else nothing for p in parts] for m in self.rows]).rref()
        contradiction = rank > 0 and all(reduced[rank - 1, j] == 0 for j in range(len(self.columns)))
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
        rest = iter(values[len(values) - sum(len(by) for _, by in self.multiples) :])
        found = [(zero, {m: c for m, c in zip(by, rest, strict=False) if c}) for zero, by in self.multiples]
        return sums, [(zero, p) for zero, p in found if p]


def _positive_semidefinite(gram: Sequence[Sequence[Fraction]], pays: Pays) -> bool:
    """Whether no eigenvalue is < 0: so the signs of the characteristic polynomial alternate; of numbers too long to compute it, False."""
    matrix = flint.fmpq_mat(len(gram), len(gram), [_rational(x) for row in gram for x in row])
    digits = len(gram) * max((int(x).bit_length() for x in matrix.numer_denom()[0].entries()), default=0)
    if digits > _MOST_DIGITS or not pays(len(gram) ** 3 * (1 + digits // _LONG)):
        return False
    return all((-1) ** (len(gram) - k) * c >= 0 for k, c in enumerate(matrix.charpoly()))


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
        _added(
            (m, share * c) for share, p in [(_ONE, squares[k]), *zip(row, (squares[g] for g in gone), strict=True)] for m, c in p.items()
        )
        for k, row in zip(kept, plain, strict=True)
    )


def _added(terms: Iterable[tuple[Exponents, Fraction]]) -> Polynomial:
    """The terms, each monomial once."""
    total: dict[Exponents, Fraction] = {}
    for m, c in terms:
        total[m] = total.get(m, Fraction(0)) + c
    return {m: c for m, c in total.items() if c}


def _fractions(numbers: Sequence[Any]) -> list[Fraction]:
    return [Fraction(int(x.p), int(x.q)) for x in numbers]


def _rational(x: Fraction) -> Any:
    return flint.fmpq(x.numerator, x.denominator)


def times(p: Polynomial, q: Polynomial) -> Polynomial:
    """Their product."""
    return _added((tuple(map(int.__add__, m, n)), c * d) for (m, c), (n, d) in product(p.items(), q.items()))


# -- a point inside the cone -------------------------------------------------------------------------------------------


def inner_point(base: Blocks, ways: Sequence[Blocks], start: Sequence[Fraction]) -> Iterator[list[Fraction]]:
    """Numbers y with which base + sum y_k ways_k is positive definite, as it seems, in ever more digits; none where none was found."""
    with precision(_BITS):
        found = _found(base, ways, start)
    if found is None:
        return
    for digits in range(3, _FINEST, 3):
        yield [Fraction(round(y * 10**digits), 10**digits) for y in found]


def _found(base: Blocks, ways: Sequence[Blocks], start: Sequence[Fraction]) -> list[Fraction] | None:
    """In phase one s is made small, in phase two the determinant great."""
    cone = _Slice.of(base, ways)
    y = [ball(x) for x in start]
    here = cone.at(y)
    size = max(abs(float(x)) for block in here for x in block.entries()) or 1.0
    lowest = min(float(np.linalg.eigvalsh(_floats(block))[0]) for block in here)
    room, count = ball(Fraction(max(-2 * lowest, 1e-9 * size))), sum(block.nrows() for block in here)
    raised = cone.raised()
    weight = count / float(room)
    for _ in range(_STEPS):
        if (step := raised.step(raised.at([*y, room]), weight)) is None:
            return None
        by, size_of_step = step
        y, room = [a + b for a, b in zip(y, by[:-1], strict=True)], room + by[-1]
        if float(room) < 0:
            break
        if size_of_step < 1:
            if count / weight < _THINNEST * size:
                return _middles(y)
            weight *= _FASTER
    else:
        return None
    for _ in range(_STEPS):
        if (step := cone.step(cone.at(y), 0.0)) is None:
            return None
        by, size_of_step = step
        y = [a + b for a, b in zip(y, by, strict=True)]
        if size_of_step < 1:
            break
    return _middles(y)


def _middles(y: Sequence[Any]) -> list[Fraction]:
    return _fractions([x.mid().fmpq() for x in y])


@dataclass(frozen=True)
class _Slice:
    """Matrices of Arb, a block each."""

    base: list[Any]
    ways: list[list[Any]]

    @classmethod
    def of(cls, base: Blocks, ways: Sequence[Blocks]) -> _Slice:
        def matrices(blocks: Blocks) -> list[Any]:
            return [flint.arb_mat(len(b), len(b), [ball(x) for row in b for x in row]) for b in blocks]

        return cls(matrices(base), [matrices(way) for way in ways])

    def raised(self) -> _Slice:
        """With the unit matrix as the last way."""
        unit = [flint.arb_mat(b.nrows(), b.nrows(), [int(i == j) for i in range(b.nrows()) for j in range(b.nrows())]) for b in self.base]
        return _Slice(self.base, [*self.ways, unit])

    def at(self, y: Sequence[Any]) -> list[Any]:
        """Its matrix."""
        found = list(self.base)
        for x, way in zip(y, self.ways, strict=True):
            found = [a + x * b for a, b in zip(found, way, strict=True)]
        return [a.mid() for a in found]

    def step(self, here: list[Any], weight: float) -> tuple[list[Any], float] | None:
        """Newton's for ``weight`` times the last number minus log det, or so much of it as stays inside; None where it fails.

        With it goes the size of the whole step in the norm of the barrier.
        """
        try:
            inverse = [block.inv().mid() for block in here]
            turned = [[(w * n).mid() for w, n in zip(inverse, way, strict=True)] for way in self.ways]
            slope = [-sum((d.trace() for d in blocks), flint.arb(0)) for blocks in turned]
            slope[-1] += weight
            count, width = len(turned), sum(block.nrows() ** 2 for block in here)
            rows = flint.arb_mat(count, width, [x for blocks in turned for d in blocks for x in d.entries()])
            columns = flint.arb_mat(count, width, [x for blocks in turned for d in blocks for x in d.transpose().entries()])
            curve = rows * columns.transpose()
            by = curve.mid().solve(flint.arb_mat(count, 1, [-x for x in slope]).mid()).mid()
        except ZeroDivisionError:  # a matrix is too near a singular one
            return None
        size = float(-sum((a * by[k, 0] for k, a in enumerate(slope)), flint.arb(0)).mid())
        change = [sum((by[k, 0] * turned[k][b] for k in range(1, count)), by[0, 0] * turned[0][b]) for b in range(len(here))]
        least = min(float(np.linalg.eigvals(_floats(c)).real.min()) for c in change)
        part = min(1.0, -_SHORT / least) if least < 0 else 1.0
        return ([(part * by[k, 0]).mid() for k in range(count)], max(size, 0.0) ** 0.5) if np.isfinite(least + size) else None


def _floats(matrix: Any) -> Any:
    return np.array([float(x) for x in matrix.entries()]).reshape(matrix.nrows(), matrix.ncols())
