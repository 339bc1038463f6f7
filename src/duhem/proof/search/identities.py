"""Identities by which polynomial conditions exclude each other (Stengle 1974), as the text that a checker reads.

A product of conditions > 0, plus sums of squares times products of conditions >= 0, plus multiples of what is 0, adds up to 0.
Weights under which all conditions are homogeneous, and changes of sign that leave them as they are, say which terms may occur.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from fractions import Fraction
from functools import reduce
from itertools import combinations, islice, product
from math import comb
from typing import Any

from duhem.proof.search.squares import Balance, Block, Exponents, Multiples, Pays, Polynomial, balanced, free, times

__all__ = ["Condition", "identity", "text"]

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


def identity(names: Sequence[str], first: Condition, others: Sequence[Condition], pays: Pays = free) -> dict[str, Any] | None:
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
                size = (chosen, classes, tuple(len(b.squares) for b in blocks), tuple(len(m.by) for m in multiples))
                if size not in tried and (found := balanced(start, blocks, multiples, pays)) is not None:
                    return _as_text(chosen, found, [names[i] for i in places])
                tried.append(size)
    return None


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
    import flint

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
    if n <= 1:
        if n or not total:
            yield (total,) * n
        return
    for k in range(total, -1, -1):
        for rest in _exponents(n - 1, total - k):
            yield (k, *rest)


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
            if copies * sum(m) + size <= degree and all(
                copies * w + v == t for w, v, t in zip(classes.weight(m), weight, target, strict=True)
            ):
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
        Multiples(c, c.poly, tuple(m for m in fitting(c.poly, 1) if classes.signs(m) == classes.signs(next(iter(c.poly)))))
        for c in stated
        if c.op == "=="
    ]
    return start, blocks, multiples


def _as_text(chosen: Sequence[Condition], found: Balance, names: Sequence[str]) -> dict[str, Any]:
    return {
        "strict": [c.name for c in chosen],
        "sums": [
            {"times": [c.name for c in b.name], "of": [text(q, names) for q in b.squares], "gram": [[str(x) for x in row] for row in gram]}
            for b, gram in found.sums
        ],
        "multiples": [{"of": c.name, "by": text(p, names)} for c, p in found.multiples],
    }


def text(p: Polynomial, names: Sequence[str]) -> str:
    """3/2*a**2*b + (-1*c) as the vocabulary spells it."""
    parts = []
    for m, c in p.items():
        powers = [x if k == 1 else f"{x}**{k}" for x, k in zip(names, m, strict=True) if k]
        parts.append("*".join([*([str(c)] if c != 1 or not powers else []), *powers]))
    return " + ".join(f"({x})" if x.startswith("-") else x for x in parts)
