"""Where rays leave a set {level <= 0}, in doubles, many rays at once.

The set is known by its level alone; a point at which that is undefined lies outside.  There are two ways to close in on
the boundary.  :class:`Rays` halves between a point inside and one outside and asks for signs only, so that kinks, jumps
and overflow don't matter and equal signs give equal numbers.  :func:`crossing` reads the values too and takes far fewer
evaluations.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np
import sympy as sp
from numpy.typing import NDArray

from duhem.expression.numpy_ import compiled

__all__ = ["Rays", "crossing", "evenly_between", "exits", "first_exit"]

Array = NDArray[np.float64]
Index = NDArray[np.intp]
Flags = NDArray[np.bool_]

_BITS = 60  # of an interval that ends at most twice as far out as it begins: more than a double holds


@dataclass(frozen=True)
class Rays:
    """The points start + t way, t >= 0, of M rays: ``start`` (d,) or (M, d), ``way`` (M, d); ``level`` of points (M, n, d) is (M, n)."""

    level: Callable[[Array], Array]
    start: Array
    way: Array

    def at(self, t: Array) -> Array:
        """The points (M, d) at ``t`` (M,)."""
        return self.start + t[:, None] * self.way

    def inside(self, t: Array) -> Flags:
        """Which points lie in the set (M, n), at ``t`` (n,) or (M, n)."""
        start = self.start if self.start.ndim == 1 else self.start[:, None, :]
        found: Flags = self.level(start + t[..., None] * self.way[:, None, :]) <= 0.0
        return found

    def narrowed(self, inner: Array, outer: Array, bits: int = _BITS, at_once: int = 1) -> tuple[Array, Array]:
        """``inner`` (M,) and ``outer`` (M,), on either side of the boundary and either one farther, brought together.

        By halving; ``at_once`` bits a round cost 2^at_once - 1 points on each ray and save calls where rays are few.
        """
        shares = np.arange(1, 2**at_once) / 2**at_once
        for _ in range(0, bits, at_once):
            inner, outer = self._cut(inner, inner[:, None] + (outer - inner)[:, None] * shares, outer)
        return inner, outer

    def ended(self, inner: Array, outer: Array, at_once: int = 4, bits: int = 64) -> tuple[Array, Array]:
        """As :meth:`narrowed`, for numbers >= 0 that may be hundreds of decades apart: half of the doubles between them go a bit."""
        for _ in range(0, bits, at_once):
            inner, outer = self._cut(inner, evenly_between(inner, outer, 2**at_once), outer)
        return inner, outer

    def _cut(self, inner: Array, between: Array, outer: Array) -> tuple[Array, Array]:
        """Where the ray is left first, of what lies ``between`` (M, n)."""
        out, row = ~self.inside(between), np.arange(len(inner))
        first = np.where(out.any(axis=1), np.argmax(out, axis=1), between.shape[1])
        ends = np.column_stack([inner, between, outer])
        return ends[row, first], ends[row, first + 1]

    def left(self, radii: Array, bits: int = _BITS, at_once: int = 1) -> tuple[Array, Array]:
        """The last t inside and the first outside (M,), by :func:`first_exit` and then to the last digit."""
        return self.narrowed(*first_exit(self.inside(radii), radii), bits, at_once)


def exits(
    g: sp.Expr, forces: Sequence[sp.Symbol], ways: Array, radii: Array, others: Mapping[sp.Symbol, float], bits: int = _BITS
) -> tuple[Array, Array]:
    """Where the rays from zero along ``ways`` (M, d) leave {g <= 0}, its ``others`` at their numbers; (M,) each, as :meth:`Rays.left`."""
    program = compiled(g, [*forces, *others])
    rays = Rays(lambda points: program(*np.moveaxis(points, -1, 0), *others.values()), np.zeros(ways.shape[1]), ways)
    return rays.left(radii, bits)


def evenly_between(low: Array, high: Array, parts: int) -> Array:
    """Numbers (M, parts - 1) that cut ``low`` (M,) to ``high``, both >= 0, into parts of as many doubles: their bits count them."""
    bits, last, cut = low.view(np.int64)[:, None], high.view(np.int64)[:, None], np.arange(1, parts)
    share, rest = np.divmod(last - bits, parts)
    return np.asarray((bits + share * cut + rest * cut // parts).view(np.float64))


def first_exit(inside: Flags, radii: Array) -> tuple[Array, Array]:
    """Between which of the increasing ``radii`` (n,) each ray (M, n) is left first.

    From 0 where the first one is outside already.  Both are the last radius where none is outside: halving leaves them equal,
    and on no other ray are they.
    """
    first, none = np.argmin(inside, axis=1), inside.all(axis=1)
    low = np.where(first > 0, radii[np.maximum(first, 1) - 1], 0.0)
    return np.where(none, radii[-1], low), np.where(none, radii[-1], radii[first])


def crossing(level: Callable[[Array, Index], Array], inside: Array, outside: Array) -> tuple[Array, Flags]:
    """The share t in (0, 1) at which inside + t (outside - inside) leaves K, to the last digit from within; (M,) each.

    A bracket is found downwards from 1 by ever longer steps, then closed by Chandrupatla's method (1997), which falls
    back on bisection.  The second array tells where none was found: no point of the ray is inside.
    """
    ray = outside - inside
    everyone = np.arange(len(ray))

    def at(t: Array, who: Index) -> Array:
        return level(inside[who] + t[:, None] * ray[who], who)

    high, f_high = np.ones(len(ray)), at(np.ones(len(ray)), everyone)
    low, f_low = np.zeros(len(ray)), np.full(len(ray), np.nan)
    who, step = everyone, 0.5
    while who.size and step > 1e-200:
        t = high[who] * step
        f = at(t, who)
        found = f <= 0
        low[who[found]], f_low[who[found]] = t[found], f[found]
        who = who[~found]
        high[who], f_high[who] = t[~found], f[~found]
        step *= step
    none = np.isnan(f_low)
    return _closed(at, low, f_low, high, f_high, everyone[~none]), none


def _closed(at: Callable[[Array, Index], Array], low: Array, f_low: Array, high: Array, f_high: Array, who: Index) -> Array:
    x, y = np.stack([low, high, low]), np.stack([f_low, f_high, f_low])  # one end, the other, and the one before, with their levels
    share = np.full(len(low), 0.5)
    with np.errstate(all="ignore"):
        for _ in range(200):
            who = who[np.abs(high[who] - low[who]) > 2.3e-16 * high[who]]
            who = who[(f_low[who] != 0)]
            if not who.size:
                break
            (a, b, _), (fa, fb, _) = x[:, who], y[:, who]
            t = a + share[who] * (b - a)
            middle = low[who] + 0.5 * (high[who] - low[who])
            t = np.where((t <= low[who]) | (t >= high[who]), middle, t)
            f = at(t, who)
            same = np.sign(f) == np.sign(fa)
            a, b, c = x[:, who] = t, np.where(same, b, a), np.where(same, a, b)
            fa, fb, fc = y[:, who] = f, np.where(same, fb, fa), np.where(same, fa, fb)
            into = f <= 0
            low[who[into]], f_low[who[into]] = t[into], f[into]
            high[who[~into]], f_high[who[~into]] = t[~into], f[~into]
            xi, phi = (a - b) / (c - b), (fa - fb) / (fc - fb)
            quadratic = (phi**2 < xi) & ((1 - phi) ** 2 < 1 - xi)
            guess = fa / (fb - fa) * fc / (fb - fc) + (c - a) / (b - a) * fa / (fc - fa) * fb / (fc - fb)
            least = 1.2e-16 * high[who] / np.abs(b - a)
            guess = np.clip(guess, least, 1 - least)
            share[who] = np.where(quadratic & np.isfinite(guess), guess, 0.5)
    return low
