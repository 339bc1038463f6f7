"""Shapes of K(sigma_n) onto which the closest point is known in closed form, and those of the built-in laws.

Every entry is an expression (or text) over the law's pressure and parameters.  Semi-axes are written ``coefficient x
load`` with the load common to all directions, so that a product such as mu |sigma_n| need not be rounded before a trial
stress is compared with it.  ``slope`` is the rate at which the law's own g grows with the gauge named in each class, at
the boundary: it turns the multiplier of the gauge into the multiplier of g.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, fields, replace
from typing import Any, TypeAlias

import sympy as sp

from duhem.expression.unevaluated import Verbatim

__all__ = ["BUILT_IN", "Disk", "Interval", "Quadrants", "Shape", "converted"]

Entry: TypeAlias = str | sp.Expr
_LOAD = "abs(sigma_n)"


@dataclass(frozen=True)
class Interval(Verbatim):
    """One force: -minus load <= sigma <= plus load.  Gauge: pos(sigma)/plus + neg(sigma)/minus."""

    plus: Entry
    minus: Entry
    load: Entry = _LOAD
    slope: Entry = "1"


@dataclass(frozen=True)
class Disk(Verbatim):
    """Two forces: |sigma| <= coefficient load.  Gauge: |sigma|."""

    coefficient: Entry = "1"
    load: Entry = _LOAD
    slope: Entry = "1"


@dataclass(frozen=True)
class Quadrants(Verbatim):
    """Two forces: a quarter ellipse per quadrant with semi-axes coefficient x load, about a centre (both in stress).

    Gauge: norm((sigma_a - centre_a)/a, (sigma_b - centre_b)/b) with a = a_plus where sigma_a >= centre_a, else a_minus,
    and b likewise (Antoni et al. 2007, Eq. 35).
    """

    a_plus: Entry
    a_minus: Entry
    b_plus: Entry
    b_minus: Entry
    load: Entry = _LOAD
    centre_a: Entry = "0"
    centre_b: Entry = "0"
    slope: Entry = "1"


Shape = Interval | Disk | Quadrants


def converted(shape: Any, change: Callable[[Any], Any]) -> Any:
    """Return the shape with every entry changed."""
    return replace(shape, **{entry.name: change(getattr(shape, entry.name)) for entry in fields(shape)})


BUILT_IN: Mapping[str, Shape] = {
    "antoni2007": Quadrants("mu_a_plus", "mu_a_minus", "mu_b_plus", "mu_b_minus"),
    "antoni2007-1d": Interval("mu_plus", "mu_minus"),
    "capped": Disk(load="min(mu*abs(sigma_n), tau_max)"),
    "cohesive": Disk(load="cohesion + mu*abs(sigma_n)"),
    "coulomb": Disk("mu"),
    "orthotropic": Quadrants("mu_a", "mu_a", "mu_b", "mu_b"),
    "regularised": Disk(
        load="sqrt(mu*abs(sigma_n)*(mu*abs(sigma_n) + 2*c))", slope="sqrt(mu*abs(sigma_n)*(mu*abs(sigma_n) + 2*c))/(mu*abs(sigma_n) + c)"
    ),
    "shifted-ellipse": Quadrants("mu_a", "mu_a", "mu_b", "mu_b", centre_a="shift*abs(sigma_n)"),
}
"""The shapes of built-in laws, by name.  A criterion file states no shape, because nothing would compare it with the formula."""
