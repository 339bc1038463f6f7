"""Where a ray from the origin leaves K."""

from __future__ import annotations

from typing import Any

from duhem.benchmark.reference.formula import NoReference, Slice

__all__ = ["extents", "reach", "root"]

_FARTHEST = 14  # 2^(2^14): how far a ray is followed for the boundary

Vector = list[Any]


def extents(plain: Slice, y: Vector) -> Vector | None:
    """How far K reaches along each coordinate; None where it is the origin alone."""
    m, mp = len(y), plain.formula.context
    if plain.read([0 * c for c in y]).value > 100 * mp.eps * abs(plain.read(y).value):
        raise NoReference("the origin is not inside K")
    hint = max(abs(c) for c in y)
    axes = [[s * (1 if i == j else 0) for j in range(m)] for i in range(m) for s in (1, -1)]
    ends = [reach(plain, [mp.mpf(c) for c in axis], hint, digits=3) for axis in axes]
    toward = reach(plain, y, mp.mpf(1), digits=3)
    if toward is None:
        if any(r is not None for r in ends):
            raise NoReference("the origin is not inside K")
        return None
    sizes = []
    for i in range(m):
        both = [r for r in ends[2 * i : 2 * i + 2] if r is not None]
        sizes.append(max(both) if both else toward * hint)
    return sizes


def reach(slice_: Slice, direction: Vector, hint: Any, digits: int) -> Any:
    """The t > 0 at which g(t direction) = 0, to ``digits``; None where no point of the ray lies in K."""
    mp = slice_.formula.context

    def at(t: Any) -> Any:
        value = slice_.read([t * c for c in direction]).value
        return mp.inf if mp.isnan(value) else value

    low = high = hint
    f_low = f_high = at(hint)
    for power in range(_FARTHEST):
        factor = mp.mpf(2) ** (2**power)
        if f_low > 0:
            high, f_high = low, f_low
            low = low / factor
            f_low = at(low)
        elif f_high <= 0:
            low, f_low = high, f_high
            high = high * factor
            f_high = at(high)
        else:
            break
    if f_low > 0:
        return None
    if f_high <= 0:
        raise NoReference("K does not end along a ray")
    while high > 4 * low:  # brackets found by growing factors are wide
        middle = mp.sqrt(low * high)
        f = at(middle)
        low, f_low, high, f_high = (middle, f, high, f_high) if f <= 0 else (low, f_low, middle, f)
    return root(at, low, f_low, high, f_high, mp.mpf(10) ** -digits)


def root(at: Any, low: Any, f_low: Any, high: Any, f_high: Any, tolerance: Any) -> Any:
    """Regula falsi with the Illinois weights, a halving wherever it dawdles."""
    side = 0
    for turn in range(400):
        if f_low == 0 or high - low <= tolerance * high:
            return low
        infinite = f_high - f_low == f_high.context.inf if hasattr(f_high, "context") else False
        t = (low + high) / 2 if turn % 3 == 2 or infinite else (low * f_high - high * f_low) / (f_high - f_low)
        if not low < t < high:
            t = (low + high) / 2
        f = at(t)
        if f == 0:
            return t
        if f < 0:
            low, f_low = t, f
            f_high = f_high / 2 if side < 0 else f_high
            side = -1
        else:
            high, f_high = t, f
            f_low = f_low / 2 if side > 0 else f_low
            side = 1
    return low
