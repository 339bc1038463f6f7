"""Whether quartic forms in the plane are convex, by the roots of their Hessians in exact numbers (Sturm 1829)."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import sympy as sp

__all__ = ["convex", "everywhere_at_most_zero"]

_X, _Y, _T = sp.symbols("x y t", real=True)


def _nonnegative(form: Any) -> bool:
    """Whether a form is >= 0 along all (1, t) and (t, 1)."""
    return all(_on_the_line(sp.Poly(form.subs(way), _T)) for way in ({_X: 1, _Y: _T}, {_X: _T, _Y: 1}))


def _on_the_line(p: sp.Poly) -> bool:
    if p.is_zero or p.degree() == 0:
        return bool(p.LC() >= 0)
    crosses = any(factor.count_roots() for factor, n in p.sqf_list()[1] if n % 2)
    return not crosses and bool(p.LC() > 0) and bool(p.eval(0) >= 0)


def _form(coefficients: Sequence[Any]) -> Any:
    return sp.Add(*(c * _X ** (4 - k) * _Y**k for k, c in enumerate(coefficients)))


def convex(coefficients: Sequence[Any]) -> bool:
    """Whether sum c_k x^(4 - k) y^k is convex."""
    hessian = sp.hessian(_form(coefficients), (_X, _Y))
    return _nonnegative(sp.expand(hessian.det())) and _nonnegative(sp.expand(hessian.trace()))


def everywhere_at_most_zero(coefficients: Sequence[Any]) -> bool:
    """Whether it is nowhere > 0."""
    return _nonnegative(sp.expand(-_form(coefficients)))
