"""Value, gradient and Hessian of a formula with respect to the forces, on arrays of points.

Forward differentiation over the one formula tree, each node a rule for second-order jets.  Norms, those
spelt as powers included, are differentiated as norms, relative to their value, so that |s|^100 neither overflows nor
vanishes on the way.  At a kink (abs, pos, neg, max, min, where) a jet follows one smooth piece: the one that holds at
the point, or, when ``choices`` are given, the one they name.  So a piece can be followed beyond its own region, which
is what Newton's method at a corner needs, and one-sided gradients at a seam are gradients of pieces.

Second derivatives of a ``strict`` program are those of the formula itself at zeros of norms too, and nan where it has none there or
where eigenvalues are equal; else, and then at less cost, a norm at its zero is followed as a constant.

The rows are also run over names in place of arrays (:mod:`duhem.expression.scalar_jets`), so that each derivative stands here alone.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import lru_cache, partial, reduce
from itertools import combinations, count
from typing import Any

import numpy as np
import sympy as sp
from numpy.typing import NDArray

from duhem.errors import InputError
from duhem.expression import numpy_
from duhem.expression.elementary import ELEMENTARY, Elementary, array_function, on_arrays
from duhem.expression.fold import Recording, Table, recorded, same
from duhem.expression.numpy_ import Program, filled, length
from duhem.expression.pnorm import PNorm, recognised
from duhem.expression.vocabulary import COMPARISONS, Atan2, EigMax, Neg, Norm, Pos, Where, rows

__all__ = ["KINKED", "ROUNDING", "STEEPEST", "TABLE", "Choices", "Jet", "JetProgram", "formula", "program"]

Array = NDArray[np.float64]


ONE = np.ones(())


@dataclass(frozen=True)
class Entries:
    """A gradient of which only some columns (N,) are not zero, by their places i; that of a force itself is ``ONE``.

    Or a Hessian, by the places (i, j) with i <= j: of it the other half says nothing new.
    """

    of: Mapping[Any, Any]

    def dense(self, n: int, d: int) -> Array:
        """The gradient (n, d), column by column in memory."""
        out = np.zeros((d, n))
        for i, column in self.of.items():
            out[i] = column
        return out.T


@dataclass(frozen=True)
class Jet:
    """``value`` (N,), ``gradient`` (N, d) and ``hessian`` (N, d, d); None stands for zero.  ``order`` 1: no hessian is followed.

    A row that is run for a text has names in place of arrays, in :class:`Entries`.
    """

    value: Any
    gradient: Any = None
    hessian: Any = None
    order: int = 2


def times(factor: Any, array: Any) -> Any:
    """``factor`` (N,) or a number times an array (N, ...)."""
    if array is None:
        return None
    if isinstance(array, Entries):
        return Entries({i: factor if column is ONE else factor * column for i, column in array.of.items()})
    return _along(factor, array) * array


def _along(factor: Any, array: Any) -> Any:
    """``factor`` (N,) or a number as what meets an array (N, ...)."""
    own = getattr(factor, "ndim", 0)
    return factor.reshape(factor.shape + (1,) * (np.ndim(array) - own)) if own else factor


def added(first: Any, second: Any) -> Any:
    """The sum, where None is zero."""
    if first is None or second is None:
        return second if first is None else first
    if isinstance(first, Entries):
        return Entries({**first.of, **{i: first.of[i] + column if i in first.of else column for i, column in second.of.items()}})
    return first + second


def total(factors: Iterable[Any], arrays: Iterable[Any]) -> Any:
    """The sum of factors times arrays, as :func:`times` and :func:`added` have them."""
    return reduce(added, map(times, factors, arrays))


def outer(first: Any, second: Any, factor: Any = ONE) -> Any:
    """a b^T (N, d, d) times ``factor`` (N,) or a number; of entries the half that is kept."""
    if isinstance(first, Entries):
        return Entries({(i, j): a * b for i, a in times(factor, first).of.items() for j, b in second.of.items() if i <= j})
    product = first[:, :, None] * second[:, None, :]
    return product if factor is ONE else times(factor, product)


def chain(x: Jet, value: Any, slope: Any, curvature: Callable[[], Any]) -> Jet:
    """f(x) from f, f', f''."""
    if x.gradient is None:
        return Jet(value)
    gradient = times(slope, x.gradient)
    if x.order == 1:
        return Jet(value, gradient, None, 1)
    return Jet(value, gradient, added(times(slope, x.hessian), outer(x.gradient, x.gradient, curvature())))


def least_order(jets: Sequence[Jet]) -> int:
    """Constants have all derivatives, whatever is followed of the rest."""
    return min([j.order for j in jets if j.gradient is not None], default=2)


def weighted(value: Any, factors: Sequence[Any], jets: Sequence[Jet]) -> Jet:
    """The ``value`` with the derivatives of a sum of jets times ``factors`` that are held fixed."""
    gradient, hessian = total(factors, (j.gradient for j in jets)), total(factors, (j.hessian for j in jets))
    return Jet(value, gradient, hessian, least_order(jets))


def bent(jet: Jet, a: Any, b: Any) -> Jet:
    """The jet with a b^T + b a^T added to its second derivatives, if these are followed."""
    if jet.order == 1 or a is None or b is None:
        return jet
    return replace(jet, hessian=added(jet.hessian, added(outer(a, b), outer(b, a))))


Choices = NDArray[np.int8]

_TINY = 1e-120  # below this share of a norm an argument counts as this share: keeps |x|^(p-2) finite for p < 2


class _Met:
    """What is noted during one evaluation: the pieces followed, those given or else those that hold, and the nodes with a shift."""

    def __init__(self, given: Choices | None, size: int, kinks: int, shifts: int) -> None:
        self.given = given
        self.taken = np.zeros((kinks, size), dtype=np.int8).T if given is None else given
        self.shifts = shifts
        self.shifted: dict[int, _ShiftedNorm | Axes] = {}

    def choose(self, index: int, natural: NDArray[Any]) -> NDArray[Any]:
        if self.given is None:
            self.taken[:, index] = natural
        return self.taken[:, index]

    def with_shift(self, jet: Jet, index: int, node: _ShiftedNorm | Axes) -> Jet:
        """The ``jet`` of a node with its shift, a variable of its own; what the node adds is left to :func:`_finished`."""
        self.shifted[index] = node
        return replace(jet, gradient=jet.gradient + np.eye(jet.gradient.shape[1])[index - self.shifts])


@dataclass(frozen=True)
class JetProgram:
    """A formula over the forces, then the other symbols, as recorded steps; ``kinks`` of them choose a piece, ``shifts`` have a shift."""

    kinks: int
    shifts: int
    strict: bool
    recording: Recording

    def __call__(self, forces: Array, others: Sequence[Array], choices: Choices | None = None, second: bool = True) -> tuple[Jet, Choices]:
        """Jet at ``forces`` (N, d) with the ``others`` (N,) fixed, and the piece followed at each kink (N, kinks)."""
        n, d = forces.shape
        size = d + self.shifts if second else d
        noted = _Met(choices, n, self.kinks, self.shifts)
        order = 2 if second else 1
        columns, units = np.ascontiguousarray(forces.T), [Entries({i: ONE}) for i in range(d)]
        slopes = [unit.dense(n, size) for unit in units] if second else units  # column by column in memory, and so is what comes of them
        given = [Jet(column, slope, None, order) for column, slope in zip(columns, slopes, strict=True)]
        given += [Jet(v, order=order) for v in others]
        with np.errstate(all="ignore"):
            last = self.recording.value(given, noted)
            value = np.broadcast_to(last.value, (n,))
            if not second:
                return Jet(value, (last.gradient or Entries({})).dense(n, d)), noted.taken
            gradient = np.zeros((n, size)) if last.gradient is None else last.gradient
            hessian = np.zeros((n, size, size)) if last.hessian is None else last.hessian
            hessian = _finished(noted.shifted, gradient, hessian, forces, self.strict)
        return Jet(value, gradient[:, :d], hessian[:, :d, :d]), noted.taken


def formula(expr: sp.Expr, forces: Sequence[sp.Symbol], others: Sequence[sp.Symbol], strict: bool = False) -> JetProgram:
    """``expr`` compiled once: differentiated in the ``forces``, the ``others`` held fixed."""
    return _compiled(expr, (*forces, *others), strict)


@lru_cache(maxsize=256)
def program(expr: sp.Basic, symbols: tuple[sp.Symbol, ...]) -> Program:
    """The value alone, over ``symbols``, with limits where it is 0/0; compiled once, like :func:`formula`."""
    return filled(expr, symbols)


@lru_cache(maxsize=256)
def _compiled(expr: sp.Expr, order: tuple[sp.Symbol, ...], strict: bool) -> JetProgram:
    rows = {**TABLE, **_AT_ZERO} if strict else TABLE
    return made_of(rows, expr, order, lambda node: partial(same, Jet(np.array(numpy_.constant(node)))), strict)


def made_of(
    rows: Table[Jet], expr: sp.Basic, order: tuple[sp.Symbol, ...], constant: Callable[[Any], Callable[..., Jet]], strict: bool = False
) -> JetProgram:
    """The program of these ``rows``; the row of a node that chooses a piece or has a shift takes its number and what is noted first."""
    met, shifts = count(), count()

    def smooth(row: Callable[..., Jet]) -> Callable[[Any], Callable[..., Jet]]:
        return lambda node: lambda _, *arguments: row(node, *arguments)

    def numbered(row: Callable[..., Jet], numbers: Iterator[int]) -> Callable[[Any], Callable[..., Jet]]:
        return lambda node: partial(row, node, next(numbers))

    table = {kind: numbered(row, met) if kind in KINKED else smooth(row) for kind, row in rows.items()}
    table |= {kind: numbered(rows[kind], shifts) for kind in (EigMax, *(_AT_ZERO if strict else ()))}
    recording = recorded(recognised(expr), order, table, constant)
    return JetProgram(next(met), next(shifts), strict, recording)


def _sum(a: Jet, b: Jet) -> Jet:
    return Jet(a.value + b.value, added(a.gradient, b.gradient), added(a.hessian, b.hessian), least_order((a, b)))


def _product(a: Jet, b: Jet) -> Jet:
    return bent(weighted(a.value * b.value, (a.value, b.value), (b, a)), a.gradient, b.gradient)


def _power(node: Any, base: Jet, exponent: Jet) -> Jet:
    if exponent.gradient is not None:
        return _elementary(ELEMENTARY["exp"], _product(exponent, _elementary(ELEMENTARY["log"], base)))
    e, b = exponent.value, base.value
    if node.exp == 2:
        return chain(base, np.square(b), 2.0 * b, lambda: 2.0)
    if base.gradient is None:
        return Jet(np.power(b, e))
    return chain(base, np.power(b, e), e * np.power(b, e - 1), lambda: e * (e - 1) * np.power(b, e - 2))


def _elementary(word: Elementary, x: Jet) -> Jet:
    v = array_function(word.numpy)(x.value)
    if x.gradient is None:
        return Jet(v)
    s = on_arrays(word.slope)(x=x.value, v=v)
    return chain(x, v, s, lambda: on_arrays(word.bend)(x=x.value, v=v, s=s))


def _atan2(node: Any, y: Jet, x: Jet) -> Jet:
    size = np.hypot(x.value, y.value)
    c, s = x.value / size / size, y.value / size / size  # nan at (0, 0)
    turn = weighted(numpy_.TABLE[Atan2](node, y.value, x.value), (c, -s), (y, x))
    return bent(turn, times(-1.0, turn.gradient), total((c, s), (x.gradient, y.gradient)))  # the angle turns less as the size grows


def _pnorm(node: Any, p: Jet, *args: Jet) -> Jet:
    every = np.ravel(p.value)
    if (every != every[0]).any():
        raise InputError("the exponent of a sum of powers differs from point to point", remedy="compute the points of each by themselves")
    exponent = float(every[0])
    return _p_norm(exponent, numpy_.TABLE[PNorm](node, exponent, *(a.value for a in args)), args)


def _p_norm(p: float, value: Any, args: tuple[Jet, ...], turning: bool = True) -> Jet:
    """(sum |a_i|^p)^(1/p) of value P: slopes (|a_i|/P)^(p-1), second derivatives by pairs, so that they keep their sign."""
    unit = np.where(value > 0.0, value, 1.0)
    one = 1.0 / unit
    shares = [np.minimum(np.abs(a.value) / unit, 1.0) for a in args]
    slopes = parts = [np.copysign(x, a.value) for a, x in zip(args, shares, strict=True)]
    steep: list[Any] = [1.0] * len(parts)
    if p != 2.0:
        steep = [np.power(share if p > 2.0 else np.maximum(share, _TINY), p - 2) for share in shares]
        slopes = [part * s for part, s in zip(parts, steep, strict=True)]
    if p < 2.0:  # which says more of a small share
        slopes = [np.sign(part) * np.power(share, p - 1) for part, share in zip(parts, shares, strict=True)]
    jet = weighted(value, slopes, args)
    if jet.order == 1:
        return jet
    hessian = jet.hessian
    for i, j in combinations(range(len(args)), 2) if turning else ():
        turn = total((parts[j], -parts[i]), (args[i].gradient, args[j].gradient))
        if turn is not None:
            weight = (p - 1) * steep[i] * steep[j] * one
            hessian = added(hessian, outer(turn, turn, np.where(value > 0.0, weight, 0.0)))
    return replace(jet, hessian=hessian)


def _abs(_: Any, index: int, noted: _Met, x: Jet) -> Jet:
    return _multiple(np.where(noted.choose(index, np.where(x.value < 0, -1, 1)) == 1, 1.0, -1.0), x)


def _ramp(node: Any, index: int, noted: _Met, x: Jet) -> Jet:
    # at 0 the piece beyond it, for pos and neg alike: where both took the zero piece, their law would lose its curvature
    beyond = x.value >= 0 if node.slope > 0 else x.value < 0
    return _multiple(np.where(noted.choose(index, np.where(beyond, 1, 0)) == 1, float(node.slope), 0.0), x)


def _multiple(slope: Any, x: Jet) -> Jet:
    return weighted(slope * x.value, (slope,), (x,))


def _extreme(node: Any, index: int, noted: _Met, *args: Jet) -> Jet:
    sense = 1 if isinstance(node, sp.Max) else -1
    values = np.broadcast_arrays(*(sense * a.value for a in args))
    return select(noted.choose(index, np.argmax(np.stack(values), axis=0)), args)


def _where(_: Any, index: int, noted: _Met, condition: Jet, then: Jet, otherwise: Jet) -> Jet:
    return select(noted.choose(index, np.where(condition.value == 1.0, 0, 1)), (then, otherwise))


def select(which: Any, args: Sequence[Jet]) -> Jet:
    """The chosen argument at each point."""

    def chosen(parts: list[Any]) -> Any:
        known = [p for p in parts if p is not None]
        if not known:
            return None
        if isinstance(known[0], Entries):
            places = sorted({i for p in known for i in p.of})
            return Entries({i: chosen([None if p is None else p.of.get(i) for p in parts]) for i in places})
        at = _along(which, known[0])
        *others, picked = (0.0 if part is None else part for part in parts)
        for i, part in reversed(list(enumerate(others))):
            picked = np.where(at == i, part, picked)
        return picked

    value, gradient, hessian = (chosen([getattr(a, name) for a in args]) for name in ("value", "gradient", "hessian"))
    return Jet(value, gradient, hessian, least_order(args))


# -- norms and eigenvalues with a shift ---------------------------------------------------------------------------------
#
# A formula of norms and of greatest eigenvalues, which have no second derivatives themselves at 0 or where eigenvalues are equal, may
# have one all the same: |a|^2, or a symmetric function of all eigenvalues.  So such a node has a shift, a variable of its own beside the
# forces, and the slope f' and curvature f'' in the shift tell what is to be added:
#
#     of a norm e = |a|       f'/e (sum da_i^2 - de^2)
#     of an eigenvalue e      sum over the others l of 2 f'/(e - l) (n . dA m)^2, n and m their unit eigenvectors
#
# Where f is smooth it is even in |a|, or in the gap e - l, and the quotients go to f'' and f''/2 (A. S. Lewis and H. S. Sendov, 2001,
# SIAM J. Matrix Anal. Appl. 23, 368-386).  Where f' does not go to 0 with them, f has a kink and no second derivative.

ROUNDING = 1e-13  # f' is known to this share of the formula's slope, and of what f'' makes of the argument's size
STEEPEST = 1e7  # a slope that changes by this many times itself over the argument's size is that of a cusp, met beside it
_NOTHING = 1e-10  # of the argument's size: a norm, or a gap between eigenvalues, that may be 0


@dataclass(frozen=True)
class ByShift:
    """Of a formula f in one shift, (N,): f' and f'', the ``size`` of the argument and the formula's slope by the argument."""

    rate: Any
    bend: Any
    size: Any
    slope: Any

    @property
    def known(self) -> Any:
        """What f' may be off by."""
        return ROUNDING * (self.slope + np.abs(self.bend) * self.size)

    @property
    def used(self) -> Any:
        """Another piece of the formula may have no value there."""
        return (self.rate != 0.0) | (self.bend != 0.0)

    def vanishes_at(self, distance: Any) -> Any:
        """Whether f' is f'' times the distance (N,) from where it is to vanish, up to rounding, and f'' is not as large as at a cusp."""
        off = np.abs(self.rate - self.bend * distance)
        return (off <= self.known) & (np.abs(self.bend) * self.size <= STEEPEST * self.slope)


def _finished(noted: Mapping[int, _ShiftedNorm | Axes], gradient: Array, hessian: Array, forces: Array, strict: bool) -> Array:
    """The Hessian (N, D, D) with what the shifted nodes add; the shifts come after the ``forces`` (N, d)."""
    d = forces.shape[1]
    slope, size_of_forces = length(*gradient[:, :d].T), length(*forces.T)
    for index in sorted(noted, reverse=True):  # a node inside another is met before it
        node = noted[index]
        rate, bend, steepness = gradient[:, d + index], hessian[:, d + index, d + index], node.steepness
        by = ByShift(rate, bend, steepness * size_of_forces, slope / steepness)
        hessian = hessian + np.where(by.used[:, None, None], node.bends(by, strict), 0.0)
    return hessian


def steepness(parts: Sequence[Jet]) -> Any:
    """The root of the sum of the squares of all slopes."""
    slopes = (a.gradient for a in parts if a.gradient is not None)
    return np.sqrt(reduce(np.add, [np.square(column) for g in slopes for column in (g.of.values() if isinstance(g, Entries) else g.T)]))


@dataclass(frozen=True)
class _ShiftedNorm:
    """|a| with its slopes (N, D), those of its parts and how steep these are; ``round``: of exponent 2."""

    value: Array
    slopes: Array
    parts: Sequence[Jet]
    steepness: Array
    round: bool

    def bends(self, by: ByShift, strict: bool) -> Array:
        """Of a norm that is not round only what is unknown at 0: its own second derivatives are followed."""
        there = self.value <= _NOTHING * by.size
        smooth = by.vanishes_at(self.value)
        if not self.round:
            flat = smooth & (np.abs(by.bend) * by.size <= by.known)
            return np.where(there & ~flat, np.nan, 0.0)[:, None, None] * np.ones(self.slopes.shape[1])
        share = np.where(smooth, by.bend, np.where(there & strict, np.nan, by.rate / np.where(there, np.inf, self.value)))
        squares = reduce(added, (None if a.gradient is None else outer(a.gradient, a.gradient) for a in self.parts))
        assert squares is not None
        return share[:, None, None] * (squares - outer(self.slopes, self.slopes))


def _norm_at_zero(_: Any, index: int, noted: _Met, *args: Jet) -> Jet:
    return _shifted(index, noted, _p_norm(2.0, length(*(a.value for a in args)), args, turning=False), args, round=True)


def _pnorm_at_zero(node: Any, index: int, noted: _Met, p: Jet, *args: Jet) -> Jet:
    return _shifted(index, noted, _pnorm(node, p, *args), args, round=False)


def _shifted(index: int, noted: _Met, jet: Jet, parts: Sequence[Jet], round: bool) -> Jet:
    if jet.gradient is None or jet.order == 1:
        return jet
    return noted.with_shift(jet, index, _ShiftedNorm(jet.value, jet.gradient, parts, steepness(parts), round))


@dataclass(frozen=True)
class Axes:
    """How far the greatest eigenvalue is above the least and the middle one (N,), and n . dA m (N, D) for its axis n and theirs.

    ``vanishes``: whether the matrix is 0.
    """

    gaps: tuple[Any, Any]
    turns: Sequence[Any]
    steepness: Any
    vanishes: Any = False

    def bends(self, by: ByShift, strict: bool) -> Array:
        return np.asarray(sum(outer(turn, turn, share) for share, turn in zip(self.shares(by, strict), self.turns, strict=True)))

    def shares(self, by: ByShift, strict: bool = False) -> list[Any]:
        """What each turn counts."""
        outermost, nearest = self.gaps
        smooth = by.vanishes_at(0.5 * nearest)
        kink = (~smooth & (nearest <= _NOTHING * by.size)) | self.vanishes if strict else False
        tiny = np.finfo(np.float64).tiny  # where all three are equal, those of A and of -A have half of the outermost pair each
        limits = (by.bend * (nearest + tiny) / (outermost + 2 * tiny), by.bend)
        pairs = zip(limits, self.gaps, strict=True)
        return [np.where(kink, np.nan, np.where(smooth, limit, 2.0 * by.rate / gap)) for limit, gap in pairs]


def _eigmax(_: Any, index: int, noted: _Met, *entries: Jet) -> Jet:
    """n . dA n with the unit eigenvector n; what its turning adds is left to :func:`_finished`."""
    size = np.broadcast_shapes(*(a.value.shape for a in entries))
    matrices = np.stack([np.stack([np.broadcast_to(a.value, size) for a in row], axis=-1) for row in rows(*entries)], axis=-2)
    values, vectors = _decomposed(matrices)
    least, middle, n = np.moveaxis(vectors, (-1, -2), (0, 1))
    jet = weighted(values[..., -1], form(n, n), entries)
    if jet.gradient is None or jet.order == 1:
        return jet
    turns = [total(form(n, m), (a.gradient for a in entries)) for m in (least, middle)]
    gaps = values[..., 2] - values[..., 0], values[..., 2] - values[..., 1]
    return noted.with_shift(jet, index, Axes(gaps, turns, steepness(entries), ~values.any(axis=-1)))


def form(n: Sequence[Any], m: Sequence[Any]) -> list[Any]:
    """Of n . A m the weights of the entries of A: xx, yy, zz, yz, xz, xy."""
    return [n[i] * m[i] for i in range(3)] + [n[i] * m[j] + n[j] * m[i] for i, j in ((1, 2), (0, 2), (0, 1))]


def _decomposed(matrices: Array) -> tuple[Array, Array]:
    """Eigenvalues (..., 3), rising, and unit eigenvectors in columns (..., 3, 3); nan for a matrix with an undefined entry.

    A and -A get the same axes to the last digit, also where an eigenvalue is double and any axes in its plane will do; not if A = 0.
    """
    known = np.isfinite(matrices.sum(axis=(-2, -1), keepdims=True))
    entries = np.where(known, matrices, 0.0)
    listed = entries.reshape(*entries.shape[:-2], 9)
    leading = np.argmax(listed != 0.0, axis=-1)[..., None]
    turned = np.take_along_axis(listed, leading, axis=-1)[..., None] < 0.0
    values, vectors = np.linalg.eigh(np.where(turned, -entries, entries) + 0.0)  # no -0
    values = np.where(turned[..., 0], -values[..., ::-1], values)
    return np.where(known[..., 0], values, np.nan), np.where(turned, vectors[..., ::-1], vectors)


KINKED: Table[Jet] = {sp.Abs: _abs, Pos: _ramp, Neg: _ramp, sp.Max: _extreme, sp.Min: _extreme, Where: _where}
TABLE: Table[Jet] = {
    sp.Add: lambda _, *terms: reduce(_sum, terms),
    sp.Mul: lambda _, *factors: reduce(_product, factors),
    sp.Pow: _power,
    **{word.node: lambda _, x, word=word: _elementary(word, x) for word in ELEMENTARY.values()},
    Atan2: _atan2,
    Norm: lambda _, *args: _p_norm(2.0, length(*(a.value for a in args)), args),
    EigMax: _eigmax,
    PNorm: _pnorm,
    **{kind: lambda _, a, b, holds=holds: Jet(np.where(holds(a.value, b.value), 1.0, 0.0)) for kind, holds in COMPARISONS.items()},
    **KINKED,
}
_AT_ZERO: Table[Jet] = {Norm: _norm_at_zero, PNorm: _pnorm_at_zero}
