"""A second-order jet on an array of points, and what sums, products and functions make of jets."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

__all__ = ["Array", "Jet", "added", "chain", "least_order", "outer", "times"]

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Jet:
    """``value`` (N,), ``gradient`` (N, d) and ``hessian`` (N, d, d); None stands for zero.  ``order`` 1: no hessian is followed."""

    value: Array
    gradient: Array | None = None
    hessian: Array | None = None
    order: int = 2


def times(factor: Any, array: Array | None) -> Array | None:
    """``factor`` (N,) or a number times an array (N, ...)."""
    if array is None:
        return None
    f = np.asarray(factor)
    return f.reshape(f.shape + (1,) * (array.ndim - f.ndim)) * array if f.ndim else f * array


def added(first: Array | None, second: Array | None) -> Array | None:
    """The sum, where None is zero."""
    if first is None or second is None:
        return second if first is None else first
    return first + second


def outer(first: Array, second: Array) -> Array:
    """a b^T (N, d, d)."""
    return first[:, :, None] * second[:, None, :]


def chain(x: Jet, value: Any, slope: Any, curvature: Callable[[], Any]) -> Jet:
    """f(x) from f, f', f''."""
    if x.gradient is None:
        return Jet(value)
    gradient = times(slope, x.gradient)
    if x.order == 1:
        return Jet(value, gradient, None, 1)
    return Jet(value, gradient, added(times(slope, x.hessian), times(curvature(), outer(x.gradient, x.gradient))))


def least_order(jets: Sequence[Jet]) -> int:
    """Constants have all derivatives, whatever is followed of the rest."""
    return min([j.order for j in jets if j.gradient is not None], default=2)
