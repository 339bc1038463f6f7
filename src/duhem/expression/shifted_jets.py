"""Second derivatives of formulas of norms and of greatest eigenvalues, which have none themselves at 0 or where eigenvalues are equal.

A formula of them may have one all the same: |a|^2, or a symmetric function of all eigenvalues.  So such a node has a shift, a
variable of its own beside the forces, and the slope f' and curvature f'' in the shift tell what is to be added:

    of a norm e = |a|       f'/e (sum da_i^2 - de^2)
    of an eigenvalue e      sum over the others l of 2 f'/(e - l) (n . dA m)^2, n and m their unit eigenvectors

Where f is smooth it is even in |a|, or in the gap e - l, and the quotients go to f'' and f''/2 (A. S. Lewis and H. S. Sendov, 2001,
SIAM J. Matrix Anal. Appl. 23, 368-386).  Where f' does not go to 0 with them, f has a kink and no second derivative.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import reduce
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from duhem.expression.jet import Array, Jet, added, least_order, outer, times
from duhem.expression.length import length
from duhem.expression.matrices import rows

__all__ = ["ROUNDING", "STEEPEST", "Shifted", "eigmax", "finished", "norm"]

ROUNDING = 1e-13  # f' is known to this share of the formula's slope, and of what f'' makes of the argument's size
STEEPEST = 1e7  # a slope that changes by this many times itself over the argument's size is that of a cusp, met beside it
_NOTHING = 1e-10  # of the argument's size: a norm, or a gap between eigenvalues, that may be 0


@dataclass(frozen=True)
class _Slope:
    """Of a formula f in one shift, (N,): f' and f'', what f' may be off by, how much it may change over the ``size`` of the argument."""

    rate: Array
    bend: Array
    known: Array
    steepest: Array
    size: Array

    def vanishes_at(self, distance: Array) -> NDArray[np.bool_]:
        """Whether f' is f'' times the distance (N,) from where it is to vanish, up to rounding, and f'' is not as large as at a cusp."""
        return np.asarray((np.abs(self.rate - self.bend * distance) <= self.known) & (np.abs(self.bend) * self.size <= self.steepest))


class Shifted(Protocol):
    """What was noted at a node with a shift; ``steepness`` (N,) the size of all slopes of its argument."""

    @property
    def steepness(self) -> Array: ...

    def bends(self, by: _Slope, strict: bool) -> Array:
        """What is added (N, D, D); nan at a kink if ``strict``."""


def finished(noted: Mapping[int, Shifted], gradient: Array, hessian: Array, forces: Array, strict: bool) -> Array:
    """The Hessian (N, D, D) with what the shifted nodes add; the shifts come after the ``forces`` (N, d)."""
    d = forces.shape[1]
    slope, size_of_forces = length(*gradient[:, :d].T), length(*forces.T)
    for index in sorted(noted, reverse=True):  # a node inside another is met before it
        node = noted[index]
        rate, bend, size = gradient[:, d + index], hessian[:, d + index, d + index], node.steepness * size_of_forces
        by_argument = slope / node.steepness
        by = _Slope(rate, bend, ROUNDING * (by_argument + np.abs(bend) * size), STEEPEST * by_argument, size)
        used = (rate != 0.0) | (bend != 0.0)  # another piece of the formula may have no value there
        hessian = hessian + np.where(used[:, None, None], node.bends(by, strict), 0.0)
    return hessian


def _steepness(parts: Sequence[Jet]) -> Array:
    return np.sqrt(sum(np.square(a.gradient).sum(axis=1) for a in parts if a.gradient is not None))


# -- norms -----------------------------------------------------------------------------------------------------------------


@dataclass(frozen=True)
class _Norm:
    """|a| with its slopes (N, D), and those of its parts; ``round``: of exponent 2."""

    value: Array
    slopes: Array
    parts: Sequence[Jet]
    round: bool

    @property
    def steepness(self) -> Array:
        return _steepness(self.parts)

    def bends(self, by: _Slope, strict: bool) -> Array:
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


def norm(index: int, noted: dict[int, Shifted], shifts: int, jet: Jet, parts: Sequence[Jet], round: bool) -> Jet:
    """The ``jet`` of a norm of the ``parts`` with its shift; what a round one adds is left to :func:`finished`."""
    if jet.gradient is None or jet.order == 1:
        return jet
    noted[index] = _Norm(jet.value, jet.gradient, parts, round)
    return Jet(jet.value, jet.gradient + _shift(jet.gradient, index, shifts), jet.hessian, jet.order)


# -- eigenvalues -----------------------------------------------------------------------------------------------------------


@dataclass(frozen=True)
class _Axes:
    """The eigenvalues (N, 3), rising, and n . dA m (N, D) for the axis n of the greatest and m of the least and the middle."""

    values: Array
    turns: tuple[Array, Array]
    steepness: Array

    def bends(self, by: _Slope, strict: bool) -> Array:
        gaps = self.values[..., 2:] - self.values[..., :2]
        outermost, nearest = gaps[..., 0], gaps[..., 1]
        smooth = by.vanishes_at(nearest / 2)
        kink = (~smooth & (nearest <= _NOTHING * by.size)) | ~self.values.any(axis=-1) if strict else False
        tiny = np.finfo(np.float64).tiny  # where all three are equal, those of A and of -A have half of the outermost pair each
        limits = (by.bend * (nearest + tiny) / (outermost + 2 * tiny), by.bend)
        quotients = (
            np.where(kink, np.nan, np.where(smooth, limit, 2 * by.rate / gap))
            for limit, gap in zip(limits, (outermost, nearest), strict=True)
        )
        return np.asarray(sum(share[:, None, None] * outer(turn, turn) for share, turn in zip(quotients, self.turns, strict=True)))


def eigmax(index: int, noted: dict[int, Shifted], shifts: int, entries: Sequence[Jet]) -> Jet:
    """n . dA n with the unit eigenvector n; what its turning adds is left to :func:`finished`."""
    size = np.broadcast_shapes(*(a.value.shape for a in entries))
    matrices = np.stack([np.stack([np.broadcast_to(a.value, size) for a in row], axis=-1) for row in rows(*entries)], axis=-2)
    values, vectors = _decomposed(matrices)
    low, middle, n = np.moveaxis(vectors, -1, 0)
    value, order = values[..., -1], least_order(entries)

    def along(m: Array) -> Array | None:
        """n . (dA) m."""
        terms = [times(n[..., i] * m[..., i], a.gradient) for i, a in enumerate(entries[:3])]
        pairs = ((1, 2), (0, 2), (0, 1))
        terms += [times(n[..., i] * m[..., j] + n[..., j] * m[..., i], a.gradient) for (i, j), a in zip(pairs, entries[3:], strict=True)]
        return reduce(added, terms)

    gradient = along(n)
    if gradient is None or order == 1:
        return Jet(value, gradient, None, order)
    weights = [n[..., 0] ** 2, n[..., 1] ** 2, n[..., 2] ** 2]
    weights += [2 * n[..., i] * n[..., j] for i, j in ((1, 2), (0, 2), (0, 1))]
    hessian = reduce(added, (times(w, a.hessian) for w, a in zip(weights, entries, strict=True)))
    turns = along(low), along(middle)
    assert turns[0] is not None and turns[1] is not None
    noted[index] = _Axes(values, (turns[0], turns[1]), _steepness(entries))
    return Jet(value, gradient + _shift(gradient, index, shifts), hessian, order)


def _shift(gradient: Array, index: int, shifts: int) -> Array:
    return np.eye(gradient.shape[1])[index - shifts]


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
