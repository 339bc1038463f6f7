r"""One side of a wedge and its average over a period, symbolically, from Coulomb's law on the side alone.

Forces are those of a spring on the wedge, per unit area: F_n along n (negative: it presses), F_t along t_a.  A side of slope
t = dz/du has the unit normal (-t, 1)/sqrt(1 + t^2) and the tangent (1, t)/sqrt(1 + t^2) in (t_a, n).
Source: Antoni et al. (2007), Eqs. (2)-(12); ``direction`` is +1 for slip along +t_a, -1 for the opposite way.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache
from typing import Any

import sympy as sp

from duhem.expression import symbol
from duhem.expression.number import exact_number

__all__ = [
    "DELTA",
    "F_0",
    "HEIGHT",
    "K_F",
    "K_N",
    "MU",
    "PERIOD",
    "SLOPE",
    "SPANS",
    "Averages",
    "U",
    "apparent",
    "averages",
    "exact_coefficients",
    "height",
    "mean",
    "side_forces",
    "sliding",
    "spring_force",
]

SLOPE = {side: symbol(f"tan_{side}", positive=True) for side in ("alpha", "beta")}
MU = {side: symbol(f"mu_{side}", nonnegative=True) for side in ("alpha", "beta")}
HEIGHT, K_N, K_F, DELTA = (symbol(name, positive=True) for name in ("h", "k_n", "k_f", "delta"))
F_0 = symbol("F_0", nonpositive=True)
U = symbol("u_ta", nonnegative=True)
PERIOD = HEIGHT * (1 / SLOPE["alpha"] + 1 / SLOPE["beta"])
SPANS = {"alpha": (U, 0, HEIGHT / SLOPE["alpha"]), "beta": (U, HEIGHT / SLOPE["alpha"], PERIOD)}  # of u_ta on either side
_SIDES = (*SLOPE.values(), *MU.values())


def side_forces(pressing: sp.Expr, along: sp.Expr, slope: sp.Expr) -> tuple[sp.Expr, sp.Expr]:
    """(F_t, F_n) of a force that presses a side and pulls along its tangent (Eq. 2)."""
    size = sp.sqrt(1 + slope**2)
    return (along + slope * pressing) / size, (slope * along - pressing) / size


def apparent(mu: sp.Expr, slope: sp.Expr, direction: int) -> sp.Expr:
    """-F_t/F_n on a side, solved from Coulomb's law (3): the tangential force is direction * mu times the pressing one."""
    normal_force, tangential_force = symbol("F_n", negative=True), symbol("F_t")
    along = tangential_force + slope * normal_force  # both scaled by sqrt(1 + slope^2)
    pressing = -(normal_force - slope * tangential_force)
    (solved,) = sp.solve(along - direction * mu * pressing, tangential_force)
    return _signed(sp.cancel(-solved / normal_force))


def _signed(expr: sp.Expr) -> sp.Expr:
    """In factors, those of the denominator written with the sign they have without friction turned positive."""
    _, denominator = sp.fraction(sp.factor(expr))
    factors = [
        f if f.subs(dict.fromkeys(f.free_symbols - set(SLOPE.values()), 0)).could_extract_minus_sign() is False else -f
        for f in sp.Mul.make_args(denominator)
    ]
    return sp.cancel(expr * sp.Mul(*factors)).factor() / sp.Mul(*factors)


def sliding(side: str) -> sp.Expr:
    """What must be positive for springs to slide up a side (Eqs. 4, 16): the denominator of the apparent coefficient."""
    return 1 - MU[side] * SLOPE[side]


def height(side: str) -> sp.Expr:
    """Height u_n of a spring's end at u_ta on a side (Eq. 8): up from A, down to B."""
    if side == "alpha":
        return U * SLOPE["alpha"]
    return HEIGHT * (1 + SLOPE["beta"] / SLOPE["alpha"]) - U * SLOPE["beta"]


def spring_force(side: str) -> sp.Expr:
    """F_n = F_0 - k_n u_n (Eq. 9, with the sign that gives Eq. 10)."""
    return F_0 - K_N * height(side)


@dataclass(frozen=True)
class Averages:
    """Mean forces over one period for one direction of slip: ``normal`` (7), and ``coefficient``, the tangential (11) over it."""

    normal: sp.Expr
    coefficient: sp.Expr


def mean(force: Mapping[str, sp.Expr]) -> sp.Expr:
    """The mean over a period of a force on either side: u_ta in [0, h/tan alpha] on Gamma_alpha, up to L on Gamma_beta (Eqs. 7, 11)."""
    return sp.factor(sp.cancel(sp.Add(*(sp.integrate(force[side], span) for side, span in SPANS.items())) / PERIOD))


@cache
def averages(direction: int) -> Averages:
    """The mean forces of springs that slide in the one or the other direction."""
    slopes = {"alpha": SLOPE["alpha"], "beta": -SLOPE["beta"]}
    forces = {side: spring_force(side) for side in SPANS}
    normal = mean(forces)
    tangential = mean({side: -apparent(MU[side], slopes[side], direction) * force for side, force in forces.items()})
    return Averages(normal, _signed(sp.cancel(-direction * tangential / normal)))


@cache
def _quotients() -> tuple[tuple[sp.Poly, sp.Poly], ...]:
    """Numerator and denominator of the coefficient in each direction, which take numbers much sooner than the printed form."""
    written = (sp.fraction(averages(direction).coefficient) for direction in (+1, -1))
    return tuple((sp.Poly(over, *_SIDES), sp.Poly(under, *_SIDES)) for over, under in written)


def exact_coefficients(values: Mapping[str, Any]) -> tuple[sp.Rational, sp.Rational]:
    """(mu_a_plus, mu_a_minus) at exact ``tan_alpha``, ``tan_beta``, ``mu_alpha``, ``mu_beta``."""
    at = [exact_number(values[s.name]) for s in _SIDES]
    plus, minus = (over(*at) / under(*at) for over, under in _quotients())
    return plus, minus
