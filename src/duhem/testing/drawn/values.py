"""Numbers by decades, and values of a law's parameters inside its domains and constraints: nothing is drawn to be thrown away.

A number has two digits, none like another, so that it is short to read.  The parameters are drawn one after the other, each from a
table that holds the numbers the constraints leave to it once the earlier ones are known, the simplest first and those beside the ends
of what is left among the others.  Where the earlier ones leave nothing, values that are known to be admitted are changed one at a time.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import lru_cache
from itertools import islice, permutations
from random import Random
from typing import Any, TypeAlias

import numpy as np
import sympy as sp
from hypothesis import strategies as st

from duhem.errors import InputError
from duhem.expression.number import exact_number
from duhem.expression.numpy_ import compiled
from duhem.expression.rays import Rays
from duhem.law.domain import Domain
from duhem.law.formula_law import Criterion

__all__ = ["MANTISSAS", "Admitted", "Strategy", "admitted", "decades", "scaled", "simple", "table"]

Strategy: TypeAlias = st.SearchStrategy[Any]

MANTISSAS = (1.0, *(round(10.0 ** ((j * 0.6180339887498949) % 1.0), 1) for j in range(1, 12)))  # none like another


def scaled(mantissa: float, power: int) -> float:
    """The double nearest to m 10^k: of 4.1 and -1 it is 0.41, not what a product rounds to."""
    return float(f"{mantissa!r}e{power}")


def table(values: Sequence[Any]) -> Strategy:
    """One of ``values`` by its place: a single draw, and it shrinks towards the first."""
    return st.integers(0, len(values) - 1).map(values.__getitem__)


def decades(low: int, high: int, *, signed: bool = False) -> Strategy:
    """Floats m 10^k, low <= k <= high, 1 <= m < 10, each decade as likely as the next; it shrinks to 1 or the nearest."""
    powers = sorted(range(low, high + 1), key=abs)
    return table([s * scaled(m, k) for m in MANTISSAS for k in powers for s in ((1.0, -1.0) if signed else (1.0,))])


_ORDERS, _TRIES = 24, 8
_FAR = [scaled(1.0, k) for k in range(-12, 13)]


@lru_cache(maxsize=256)
def simple(domain: Domain) -> tuple[float, ...]:
    """Values of a domain by decades, the simplest first, ends of closed intervals and their neighbours among the others."""
    spread = [scaled(m, k) for m in MANTISSAS for k in (0, -1, 1, -2, 2, -3)]
    low, high = (None if end is None else float(end) for end in (domain.low, domain.high))
    if low is not None and high is not None:
        shares = [0.5, 0.25, 0.75, *(m / 10.0 for m in MANTISSAS[1:])]
        found = [low + s * (high - low) for s in shares] + [low, high, low + 1e-6 * (high - low), high - 1e-6 * (high - low)]
    elif low is not None:
        found = [low + x for x in spread] + [low]
    elif high is not None:
        found = [high - x for x in spread] + [high]
    else:
        found = [0.0, *(s * x for x in spread for s in (1.0, -1.0))]
    return tuple(x for x in found if x in domain)


@dataclass(frozen=True)
class Admitted:
    """The values a law admits of the parameters that are ``free``, in the order in which they are drawn.

    ``known`` are values that it admits, where some were found; None where the order alone reaches them.
    """

    law: Criterion
    free: tuple[str, ...]
    known: Mapping[str, float] | None = None

    def holds(self, values: Mapping[str, float]) -> bool:
        """Whether the numbers lie in their domains and satisfy every constraint, as exact decimals.

        Of constraints that need others too, nothing is said.
        """
        if not all(value in self.law.parameters[name] for name, value in values.items()):
            return False
        table = self.law.symbols()
        exact = {table[name]: exact_number(value) for name, value in values.items()} | _fixed(self.law)
        return all(relation.xreplace(exact) != False for relation in self.law.constraints)  # noqa: E712 (a SymPy truth value)

    def values(self, draw: Callable[[int], int]) -> dict[str, float]:
        """One value a parameter; ``draw(n)`` picks a place of a table of n."""
        taken: dict[str, float] = {}
        for name in self.free:
            if (found := self._one(name, taken, draw)) is None:
                return self._changed(draw)
            taken[name] = found
        return taken

    def _one(self, name: str, others: Mapping[str, float], draw: Callable[[int], int]) -> float | None:
        """A value out of the table, or the next in it that the constraints admit to the last digit too."""
        if not (table := self.table(name, others)):
            return None
        place = draw(len(table))
        return next((x for x in (*table[place:], *table[:place]) if self.holds({**others, name: x})), None)

    def table(self, name: str, taken: Mapping[str, float]) -> Sequence[float]:
        """What the domain of a parameter and the constraints on it and those ``taken`` leave to it."""
        base = simple(self.law.parameters[name])
        gaps = [_gap(self.law, i) for i in _about(self.law, name, frozenset(taken))]
        if not gaps:
            return base
        others = {n: x for n, x in taken.items() if n != name} | {str(s): float(v) for s, v in _fixed(self.law).items()}
        ends = [x for x in self.law.parameters[name].ends if np.isfinite(x)]
        own = {*base, *ends, *others.values(), *(s * x for x in _FAR for s in (1.0, -1.0))}
        grid = np.array(sorted(x for x in own if x in self.law.parameters[name]))
        found = [x for x, left in zip(base, _hold(gaps, others, name, np.array(base)), strict=True) if left]
        found += [x for low, high in _left(gaps, others, name, grid) for x in _between(low, high) if x in self.law.parameters[name]]
        return [*dict.fromkeys(found)]

    def _changed(self, draw: Callable[[int], int]) -> dict[str, float]:
        """Values that are known to be admitted, each in turn exchanged for one that the others leave to it."""
        if self.known is None:
            remedy = "fix some of its parameters"
            raise InputError(f"no parameters that {self.law.name} admits were found", where=self.law.name, remedy=remedy)
        values = dict(self.known)
        for name in self.free:
            found = self._one(name, values, draw)
            values[name] = values[name] if found is None else found
        return values


@lru_cache(maxsize=64)
def admitted(law: Criterion) -> Admitted:
    """The order of the parameters in which none of the earlier ones leaves too little, where one is found."""
    free = tuple(name for name, domain in law.parameters.items() if domain.value is None)
    bound = {str(s) for relation in law.constraints for s in relation.free_symbols} & {*free}
    rest = [name for name in free if name not in bound]
    best = Admitted(law, free)
    reached: list[dict[str, float]] = []
    for order in islice(permutations([name for name in free if name in bound]), _ORDERS):
        here = Admitted(law, (*order, *rest))
        ended = list(_tried(here))
        reached += ended
        if len(ended) == _TRIES:
            return Admitted(law, here.free, reached[0])
        if len(ended) > 0 and best.known is None:
            best = Admitted(law, here.free, ended[0])
    return best


def _tried(here: Admitted) -> Iterator[dict[str, float]]:
    """Yield the draws, of a few, that reach the last parameter."""
    dice = Random(0)
    for i in range(_TRIES):
        try:
            yield here.values(lambda n, i=i: dice.randrange(n) if i else 0)  # type: ignore[misc]
        except InputError:
            continue


def _fixed(law: Criterion) -> dict[sp.Symbol, sp.Rational]:
    table = law.symbols()
    return {table[name]: domain.value for name, domain in law.parameters.items() if domain.value is not None}


@lru_cache(maxsize=256)
def _about(law: Criterion, name: str, taken: frozenset[str]) -> tuple[int, ...]:
    """Return the constraints on ``name`` and on no others than those taken or fixed."""
    known = {*taken, name, *(n for n, domain in law.parameters.items() if domain.value is not None)}
    used = [{str(s) for s in relation.free_symbols} for relation in law.constraints]
    return tuple(i for i, names in enumerate(used) if name in names and names <= known)


@lru_cache(maxsize=256)
def _gap(law: Criterion, i: int) -> Callable[[Mapping[str, object]], np.ndarray]:
    """Return the margin by which a constraint is satisfied, as a function of values by name."""
    relation = law.constraints[i]
    symbols = tuple(relation.free_symbols)
    program = compiled(relation.gts - relation.lts, symbols)
    return lambda values: program(*(values[str(s)] for s in symbols))  # type: ignore[arg-type]


def _hold(gaps: list[Callable[..., np.ndarray]], others: Mapping[str, float], name: str, values: np.ndarray) -> np.ndarray:
    """Whether all constraints hold at ``values`` of a parameter."""
    with np.errstate(all="ignore"):
        return np.all([np.broadcast_to(gap({**others, name: values}), values.shape) > 0.0 for gap in gaps], axis=0)


def _left(gaps: list[Callable[..., np.ndarray]], others: Mapping[str, float], name: str, grid: np.ndarray) -> Iterator[tuple[float, float]]:
    """Intervals on which every constraint holds, to the last digit; found by the signs on a grid of each constraint alone."""
    breaks = {float(grid[0]), float(grid[-1])}
    for gap in gaps:

        def level(points: np.ndarray, gap: Callable[..., np.ndarray] = gap) -> np.ndarray:
            with np.errstate(all="ignore"):
                return -np.broadcast_to(gap({**others, name: points[..., 0]}), points.shape[:-1])

        inside = level(grid[:, None]) <= 0.0
        at = np.flatnonzero(inside[1:] != inside[:-1])
        start = np.where(inside[at], grid[at], grid[at + 1])
        out = np.where(inside[at], grid[at + 1], grid[at])
        rays = Rays(level, start[:, None], (out - start)[:, None])
        last, beyond = rays.narrowed(np.zeros(len(at)), np.ones(len(at)))
        breaks |= {float(x) for t in (last, beyond) for x in rays.at(t)[:, 0]}
    ordered = np.array(sorted(breaks))
    holds = _hold(gaps, others, name, 0.5 * ordered[:-1] + 0.5 * ordered[1:])
    yield from ((float(a), float(b)) for a, b, good in zip(ordered[:-1], ordered[1:], holds, strict=True) if good and b > a)


def _between(low: float, high: float) -> list[float]:
    """Numbers of an interval, the roundest first: in the middle, and ever nearer to the ends, up to the last digit."""
    size, near = high - low, [10.0**-k for k in (1, 2, 3, 6, 9, 12)]
    found = [low + s * size for s in (0.5, 0.25, 0.75, *near)] + [high - s * size for s in near]
    whole = sorted((s * x for x in _FAR for s in (1.0, -1.0) if low <= s * x <= high), key=lambda x: abs(np.log10(abs(x))))
    round_ = [*whole[:6], *(float(f"{x:.{digits}e}") for digits in (0, 1) for x in found[:3])]
    return [
        x for x in (*round_, *found, low, high, float(np.nextafter(low, np.inf)), float(np.nextafter(high, -np.inf))) if low <= x <= high
    ]
