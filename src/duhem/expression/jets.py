"""Value, gradient and Hessian of a formula with respect to the forces, on arrays of points.

Forward differentiation over the one formula tree, each node a rule for second-order jets.  Norms, those
spelt as powers included, are differentiated as norms, relative to their value, so that |s|^100 neither overflows nor
vanishes on the way.  At a kink (abs, pos, neg, max, min, where) a jet follows one smooth piece: the one that holds at
the point, or, when ``choices`` are given, the one they name.  So a piece can be followed beyond its own region, which
is what Newton's method at a corner needs, and one-sided gradients at a seam are gradients of pieces.

Second derivatives of a ``strict`` program are those of the formula itself at zeros of norms too, and nan where it has none there or
where eigenvalues are equal; else, and then at less cost, a norm at its zero is followed as a constant.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import lru_cache, partial, reduce
from itertools import combinations, count
from typing import Any

import numpy as np
import sympy as sp
from numpy.typing import NDArray

from duhem.errors import InputError
from duhem.expression import numpy_
from duhem.expression.elementary import ELEMENTARY, Elementary, array_function, on_arrays
from duhem.expression.fold import Table
from duhem.expression.jet import Array, Jet, added, chain, least_order, outer, times
from duhem.expression.length import length
from duhem.expression.limits import filled
from duhem.expression.numpy_ import Program
from duhem.expression.pnorm import PNorm, recognised
from duhem.expression.recording import Recording, recorded
from duhem.expression.shifted_jets import Shifted, finished
from duhem.expression.shifted_jets import eigmax as shifted_eigmax
from duhem.expression.shifted_jets import norm as shifted_norm
from duhem.expression.vocabulary import Atan2, EigMax, Neg, Norm, Pos, Where

__all__ = ["KINKED", "TABLE", "Choices", "Jet", "JetProgram", "formula", "program"]

Choices = NDArray[np.int8]

_TINY = 1e-120  # below this share of a norm an argument counts as this share: keeps |x|^(p-2) finite for p < 2


class _Met:
    """What is noted during one evaluation: the pieces followed, those given or else those that hold, and the nodes with a shift."""

    def __init__(self, given: Choices | None, size: int, kinks: int, shifts: int) -> None:
        self.given = given
        self.taken = np.zeros((kinks, size), dtype=np.int8).T if given is None else given
        self.shifts = shifts
        self.shifted: dict[int, Shifted] = {}

    def choose(self, index: int, natural: NDArray[Any]) -> NDArray[Any]:
        if self.given is not None:
            return self.given[:, index]
        self.taken[:, index] = natural
        return natural if natural.ndim else np.broadcast_to(natural, len(self.taken))


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
        columns, units = np.ascontiguousarray(forces.T), np.zeros((d, size, n))
        for i in range(d):
            units[i, i] = 1.0
        given = [Jet(columns[i], units[i].T, None, order) for i in range(d)]  # column by column in memory, and so is what comes of them
        given += [Jet(v, order=order) for v in others]
        with np.errstate(all="ignore"):
            last = self.recording.value(given, noted)
            value = np.broadcast_to(last.value, (n,))
            gradient = np.zeros((n, size)) if last.gradient is None else last.gradient
            if not second:
                return Jet(value, gradient, None), noted.taken
            hessian = np.zeros((n, size, size)) if last.hessian is None else last.hessian
            hessian = finished(noted.shifted, gradient, hessian, forces, self.strict)
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
    met, shifts = count(), count()

    def smooth(row: Callable[..., Jet]) -> Callable[[Any], Callable[..., Jet]]:
        return lambda node: partial(_smooth, row, node)

    def kinked(row: Callable[..., Jet]) -> Callable[[Any], Callable[..., Jet]]:
        return lambda node: partial(row, node, next(met))

    def shifted(row: Callable[..., Jet]) -> Callable[[Any], Callable[..., Jet]]:
        return lambda node: partial(row, node, next(shifts))

    rows = {**TABLE, **_AT_ZERO} if strict else TABLE
    table = {kind: (kinked if kind in KINKED else shifted if row in _SHIFTED else smooth)(row) for kind, row in rows.items()}
    recording = recorded(recognised(expr), order, table, lambda node: partial(_same, Jet(np.array(_number(node)))))
    return JetProgram(next(met), next(shifts), strict, recording)


def _same(jet: Jet, _: _Met) -> Jet:
    return jet


def _smooth(row: Callable[..., Jet], node: Any, _: _Met, *arguments: Jet) -> Jet:
    return row(node, *arguments)


def _number(node: Any) -> float:
    if node.is_Rational:
        try:
            return int(node.p) / int(node.q)
        except OverflowError:
            raise InputError("a number of the formula is too large for double precision", remedy="rescale it") from None
    if node.is_number:
        return float(node)
    if node in (sp.true, sp.false):
        return float(node is sp.true)
    raise InputError(f"{node} has no value", remedy="give a value for each symbol of the formula")


def _add(_: Any, *terms: Jet) -> Jet:
    return reduce(
        lambda a, b: Jet(a.value + b.value, added(a.gradient, b.gradient), added(a.hessian, b.hessian), least_order((a, b))),
        terms,
    )


def _product(a: Jet, b: Jet) -> Jet:
    gradient, order = added(times(a.value, b.gradient), times(b.value, a.gradient)), least_order((a, b))
    hessian = added(times(a.value, b.hessian), times(b.value, a.hessian))
    if order == 2 and a.gradient is not None and b.gradient is not None:
        cross = outer(a.gradient, b.gradient)
        hessian = added(hessian, cross + np.swapaxes(cross, 1, 2))
    return Jet(a.value * b.value, gradient, hessian, order)


def _power(node: Any, base: Jet, exponent: Jet) -> Jet:
    if exponent.gradient is not None:
        return _elementary(ELEMENTARY["exp"], _product(exponent, _elementary(ELEMENTARY["log"], base)))
    e, b = exponent.value, base.value
    if node.exp == 2:
        return chain(base, np.square(b), 2.0 * b, lambda: np.full_like(b, 2.0))
    if base.gradient is None:
        return Jet(np.power(b, e))
    slope = e * np.power(b, e - 1) if node.exp != 1 else np.ones_like(b)
    return chain(base, np.power(b, e), slope, lambda: e * (e - 1) * np.power(b, e - 2))


def _elementary(word: Elementary, x: Jet) -> Jet:
    v = array_function(word.numpy)(x.value)
    if x.gradient is None:
        return Jet(v)
    s = on_arrays(word.slope)(x=x.value, v=v)
    return chain(x, v, s, lambda: on_arrays(word.bend)(x=x.value, v=v, s=s))


def _atan2(node: Any, y: Jet, x: Jet) -> Jet:
    size = np.hypot(x.value, y.value)
    c, s = x.value / size, y.value / size  # nan at (0, 0)
    gradient = added(times(c / size, y.gradient), times(-s / size, x.gradient))
    value = numpy_.TABLE[Atan2](node, y.value, x.value)
    if (order := least_order((y, x))) == 1:
        return Jet(value, gradient, None, 1)
    hessian = added(times(c / size, y.hessian), times(-s / size, x.hessian))
    if gradient is not None:  # the angle turns as the size grows
        growth = added(times(c / size, x.gradient), times(s / size, y.gradient))
        assert growth is not None
        cross = outer(gradient, growth)
        hessian = added(hessian, -(cross + np.swapaxes(cross, 1, 2)))
    return Jet(value, gradient, hessian, order)


def _eigmax(_: Any, index: int, noted: _Met, *entries: Jet) -> Jet:
    return shifted_eigmax(index, noted.shifted, noted.shifts, entries)


def _norm(_: Any, *args: Jet) -> Jet:
    return _p_norm(2.0, _length(args), args)


def _norm_at_zero(_: Any, index: int, noted: _Met, *args: Jet) -> Jet:
    return shifted_norm(index, noted.shifted, noted.shifts, _p_norm(2.0, _length(args), args, turning=False), args, round=True)


def _pnorm(_: Any, p: Jet, *args: Jet) -> Jet:
    exponent = float(p.value)
    sizes = [np.abs(a.value) for a in args]
    largest = reduce(np.maximum, sizes)
    unit = np.where((largest > 0.0) & np.isfinite(largest), largest, 1.0)
    value = unit * np.power(reduce(np.add, [np.power(s / unit, exponent) for s in sizes]), 1.0 / exponent)
    return _p_norm(exponent, value, args)


def _pnorm_at_zero(node: Any, index: int, noted: _Met, p: Jet, *args: Jet) -> Jet:
    return shifted_norm(index, noted.shifted, noted.shifts, _pnorm(node, p, *args), args, round=False)


def _length(args: Sequence[Jet]) -> Any:
    return length(*(a.value for a in args))


def _p_norm(p: float, value: Any, args: tuple[Jet, ...], turning: bool = True) -> Jet:
    """(sum |a_i|^p)^(1/p) of value P: slopes (|a_i|/P)^(p-1), second derivatives by pairs, so that they keep their sign."""
    unit = np.where(value > 0.0, value, 1.0)
    shares = [np.minimum(np.abs(a.value) / unit, 1.0) for a in args]
    if p == 2.0:
        slopes = [np.copysign(s, a.value) for a, s in zip(args, shares, strict=True)]
    else:
        slopes = [np.sign(a.value) * np.power(s, p - 1) for a, s in zip(args, shares, strict=True)]
    gradient: Array | None = None
    hessian: Array | None = None
    for a, slope in zip(args, slopes, strict=True):
        gradient = added(gradient, times(slope, a.gradient))
        hessian = added(hessian, times(slope, a.hessian))
    if (order := least_order(args)) == 1:
        return Jet(value, gradient, None, 1)
    signs = [np.where(a.value < 0, -1.0, 1.0) for a in args]
    for i, j in combinations(range(len(args)), 2) if turning else ():
        turn = added(times(shares[j] * signs[i], args[i].gradient), times(-shares[i] * signs[j], args[j].gradient))
        if turn is None:
            continue
        weight = (p - 1) * np.power(np.maximum(shares[i], _TINY), p - 2) * np.power(np.maximum(shares[j], _TINY), p - 2) / unit
        hessian = added(hessian, times(np.where(value > 0.0, weight, 0.0), outer(turn, turn)))
    return Jet(value, gradient, hessian, order)


def _abs(_: Any, index: int, noted: _Met, x: Jet) -> Jet:
    side = noted.choose(index, np.where(x.value < 0, -1, 1))
    return _chain_linear(x, side.astype(np.float64))


def _ramp(node: Any, index: int, noted: _Met, x: Jet) -> Jet:
    # at 0 the piece beyond it, for pos and neg alike: where both took the zero piece, their law would lose its curvature
    rising = x.value >= 0 if node.slope > 0 else x.value < 0
    side = noted.choose(index, rising)
    slope = side.astype(np.float64)
    return _chain_linear(x, slope if node.slope == 1 else node.slope * slope)


def _chain_linear(x: Jet, slope: Array) -> Jet:
    return Jet(slope * x.value, times(slope, x.gradient), times(slope, x.hessian), x.order)


def _extreme(node: Any, index: int, noted: _Met, *args: Jet) -> Jet:
    sense = 1 if isinstance(node, sp.Max) else -1
    values = np.broadcast_arrays(*(sense * a.value for a in args), noted.taken[:, index])[:-1]
    return _select(noted.choose(index, np.argmax(np.stack(values), axis=0)), args)


def _where(_: Any, index: int, noted: _Met, condition: Jet, then: Jet, otherwise: Jet) -> Jet:
    holds = np.broadcast_to(condition.value == 1.0, noted.taken[:, index].shape)
    return _select(noted.choose(index, np.where(holds, 0, 1)), (then, otherwise))


def _select(which: NDArray[Any], args: tuple[Jet, ...]) -> Jet:
    """The chosen argument at each point."""
    value = np.choose(which, [a.value for a in args])

    def chosen(parts: list[Array | None]) -> Array | None:
        known = [p for p in parts if p is not None]
        if not known:
            return None
        shape = which.shape + (1,) * (known[0].ndim - 1)
        picked = np.zeros((which.size, *known[0].shape[1:]))
        for i, part in enumerate(parts):
            if part is not None:
                picked = np.where(which.reshape(shape) == i, part, picked)
        return picked

    return Jet(value, chosen([a.gradient for a in args]), chosen([a.hessian for a in args]), least_order(args))


def _comparison(compare: Callable[[Any, Any], Any]) -> Callable[..., Jet]:
    return lambda _, a, b: Jet(np.where(compare(a.value, b.value), 1.0, 0.0))


_SMOOTH: Table[Jet] = {
    sp.Add: _add,
    sp.Mul: lambda _, *factors: reduce(_product, factors),
    sp.Pow: _power,
    **{word.node: lambda _, x, word=word: _elementary(word, x) for word in ELEMENTARY.values()},
    Atan2: _atan2,
    Norm: _norm,
    EigMax: _eigmax,
    PNorm: _pnorm,
    sp.StrictGreaterThan: _comparison(np.greater),
    sp.GreaterThan: _comparison(np.greater_equal),
    sp.StrictLessThan: _comparison(np.less),
    sp.LessThan: _comparison(np.less_equal),
}
KINKED: Table[Jet] = {sp.Abs: _abs, Pos: _ramp, Neg: _ramp, sp.Max: _extreme, sp.Min: _extreme, Where: _where}
_AT_ZERO: Table[Jet] = {Norm: _norm_at_zero, PNorm: _pnorm_at_zero}
_SHIFTED = (_eigmax, *_AT_ZERO.values())
TABLE: Table[Jet] = {**_SMOOTH, **KINKED}
