"""Apparent friction of a rough profile of wedges: coefficients along the ridge normal, limit point at any slip angle, nearest ellipse.

Body 2 carries long wedges; their sides have slopes tan(alpha) (facing slip along +t_a) and tan(beta) (facing slip along
-t_a) and local friction mu_alpha, mu_beta.  Body 1 is a bed of independent springs normal to the mean plane.
Angles in radians, in (0, pi/2); coefficients dimensionless; arguments broadcast.

Source: Antoni, Ligier, Saffré, Pastor (2007), Eqs. (4), (6), (13), (15), (16).

One side of a wedge and its average over a period are symbolic too, from Coulomb's law on the side alone.  Forces are those of a
spring on the wedge, per unit area: F_n along n (negative: it presses), F_t along t_a.  A side of slope t = dz/du has the unit
normal (-t, 1)/sqrt(1 + t^2) and the tangent (1, t)/sqrt(1 + t^2) in (t_a, n).
Source: Antoni et al. (2007), Eqs. (2)-(12); ``direction`` is +1 for slip along +t_a, -1 for the opposite way.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache
from typing import Any

import numpy as np
import sympy as sp
from numpy.typing import ArrayLike, NDArray

from duhem.errors import InputError
from duhem.expression import symbol
from duhem.expression.given_array import reals
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
    "FourQuadrantFit",
    "U",
    "apparent",
    "associated_fit",
    "averages",
    "coefficients",
    "exact_coefficients",
    "height",
    "limit_point",
    "mean",
    "side_forces",
    "sliding",
    "slip_direction",
    "spring_force",
]

Array = NDArray[np.float64]


def coefficients(alpha: ArrayLike, beta: ArrayLike, mu_alpha: ArrayLike, mu_beta: ArrayLike) -> tuple[Array, Array]:
    """(mu_plus, mu_minus), the apparent coefficients for slip along +t_a (Eq. 13) and -t_a (Eq. 15).

    mu_plus  = [H(mu_alpha, alpha) tan beta + H(mu_beta, -beta) tan alpha]/(tan alpha + tan beta),
    mu_minus = [H(mu_beta, beta) tan alpha + H(mu_alpha, -alpha) tan beta]/(tan alpha + tan beta),
    H(x, y) = (x + tan y)/(1 - x tan y) (Eq. 6).  Each has the shape to which the arguments broadcast.

    InputError when an angle is outside (0, pi/2), a coefficient negative, a number not finite, the shapes do not broadcast,
    or a side cannot slide: mu_alpha tan(alpha) >= 1 (Eq. 4), mu_beta tan(beta) >= 1 (Eq. 16).
    """
    ta, tb, ma, mb = _profile(alpha, beta, mu_alpha, mu_beta)
    plus = (_apparent(ma, ta) * tb + _apparent(mb, -tb) * ta) / (ta + tb)
    minus = (_apparent(mb, tb) * ta + _apparent(ma, -ta) * tb) / (ta + tb)
    return plus, minus


def limit_point(phi: ArrayLike, alpha: ArrayLike, beta: ArrayLike, mu_alpha: ArrayLike, mu_beta: ArrayLike) -> Array:
    """Traction (..., 2) per unit |sigma_n| while the body slips in the direction :func:`slip_direction` (phi).

    On a side of slope t along t_a the tip of a spring moves with v = (cos phi, sin phi, t cos phi) and is pushed by a
    force along n/|n| - mu v/|v| with n = (-t, 0, 1); the traction is the tangential over the vertical part, averaged over
    the two sides (t = tan alpha and -tan beta) by their horizontal lengths.  phi = 0 and pi give mu_plus and -mu_minus.

    ``phi`` in radians, measured from t_a towards t_b; it broadcasts with the profile.  InputError as :func:`coefficients`.
    """
    ta, tb, ma, mb, angle = _profile(alpha, beta, mu_alpha, mu_beta, phi)
    one, other = _traction(angle, ta, ma), _traction(angle, -tb, mb)
    return (one * tb[..., None] + other * ta[..., None]) / (ta + tb)[..., None]


def slip_direction(phi: ArrayLike) -> Array:
    """(cos phi, sin phi), shape (..., 2): the unit direction of slip that goes with :func:`limit_point`."""
    angle = _finite("phi", phi)
    return np.stack([np.cos(angle), np.sin(angle)], axis=-1)


def _apparent(mu: Array, slope: Array) -> Array:
    """H of Eq. (6) in terms of the slope tan y."""
    return (mu + slope) / (1 - mu * slope)


def _traction(phi: Array, slope: Array, mu: Array) -> Array:
    """Traction of one side, (..., 2); 1 - w mu slope cos phi > 0 because |w cos phi| <= 1 with w = |n|/|v|."""
    c, s = np.cos(phi), np.sin(phi)
    w = np.sqrt((1 + slope**2) / (1 + (slope * c) ** 2))
    return np.stack([slope + w * mu * c, w * mu * s], axis=-1) / (1 - w * mu * slope * c)[..., None]


def _profile(alpha: ArrayLike, beta: ArrayLike, mu_alpha: ArrayLike, mu_beta: ArrayLike, *more: ArrayLike) -> tuple[Array, ...]:
    """Slopes, coefficients and what else broadcasts with them, or an InputError."""
    names = ("alpha", "beta", "mu_alpha", "mu_beta", "phi")
    arrays = [_finite(name, value) for name, value in zip(names, (alpha, beta, mu_alpha, mu_beta, *more), strict=False)]
    for name, array in zip(names[:2], arrays[:2], strict=True):
        _refuse((array <= 0) | (array >= np.pi / 2), name, array, "is outside (0, pi/2)", "give angles in radians")
    for name, array in zip(names[2:4], arrays[2:4], strict=True):
        _refuse(array < 0, name, array, "is negative", "give coefficients of friction >= 0")
    for i, array in enumerate(arrays[1:], 1):
        try:
            np.broadcast_shapes(*(a.shape for a in arrays[:i]), array.shape)
        except ValueError:
            others = ", ".join(f"{n} {a.shape}" for n, a in zip(names, arrays[:i], strict=False))
            raise InputError(
                f"shape {array.shape} does not broadcast with {others}", where=names[i], remedy="give scalars or arrays of one shape"
            ) from None
    wide = np.broadcast_arrays(*arrays)
    slopes = [np.tan(wide[0]), np.tan(wide[1])]
    for side, angle, slope, mu, equation in zip(names[:2], wide[:2], slopes, wide[2:4], ("Eq. 4", "Eq. 16"), strict=True):
        rounding = 4 * np.finfo(float).eps * (1 + 2 * angle / np.sin(2 * angle))  # of the tangent of a rounded angle
        text = f"makes mu_{side} tan({side}) >= 1: the springs cannot slide up this side ({equation})"
        _refuse(mu * slope >= 1 - rounding, f"mu_{side}", mu, text, f"keep mu_{side} tan({side}) < 1")
    return (*slopes, *wide[2:])


def _finite(name: str, value: ArrayLike) -> Array:
    if (array := reals(value)) is None:
        raise InputError("this is not an array of real numbers", where=name, remedy="give a number or an array of numbers")
    _refuse(~np.isfinite(array), name, array, "is not finite", "give finite numbers")
    return array


def _refuse(bad: NDArray[np.bool_], name: str, array: Array, fault: str, remedy: str) -> None:
    if bad.any():
        index = tuple(int(i) for i in np.argwhere(bad)[0])
        place = f"{name}[{', '.join(map(str, index))}]" if index else name
        raise InputError(f"{array[index]:g} {fault}", where=place, remedy=remedy)


@dataclass(frozen=True)
class FourQuadrantFit:
    """Coefficients of ``antoni2007`` and how well they do.

    ``largest_error`` is the greatest |limit load of the fit / true limit load - 1| over loading directions;
    ``root_mean_square`` the mean over slip angles.
    """

    mu_a_plus: float
    mu_a_minus: float
    mu_b_plus: float
    mu_b_minus: float
    largest_error: float
    root_mean_square: float

    def parameters(self) -> dict[str, float]:
        """The four coefficients by the names of the law ``antoni2007``."""
        return {name: getattr(self, name) for name in ("mu_a_plus", "mu_a_minus", "mu_b_plus", "mu_b_minus")}


def associated_fit(alpha: float, beta: float, mu_alpha: float, mu_beta: float, *, angles: int = 3600) -> FourQuadrantFit:
    """The associated four-quadrant criterion (Antoni et al. 2007, Eq. 35) that comes nearest to the oblique limit curve; angles in radians.

    gamma(s)^2 = (s_a/mu_a^+-)^2 + (s_b/mu_b^+-)^2 is linear in the four 1/mu^2, so gamma(T)^2 = 1 is fitted by least squares over
    ``angles`` slip directions; the error is measured afterwards, as the relative error of the limit load along each loading direction.

    InputError as :func:`duhem.micromodel.wedge.coefficients`, for fewer than 16 angles, and for a profile without friction,
    whose limit curve is a point.
    """
    if angles < 16:
        raise InputError(f"{angles} slip directions are too few", where="angles", remedy="give 16 or more")
    phi = 2 * np.pi * (np.arange(angles) + 0.5) / angles
    points = limit_point(phi, alpha, beta, mu_alpha, mu_beta)
    squares = np.concatenate([np.where(points > 0, points, 0) ** 2, np.where(points < 0, points, 0) ** 2], axis=1)
    if not (squares.max(axis=0) > 0).all():
        raise InputError("the limit curve does not surround zero", where="mu_alpha, mu_beta", remedy="give a coefficient > 0")
    scale = squares.max(axis=0)
    inverse = np.linalg.lstsq(squares / scale, np.ones(angles), rcond=None)[0] / scale
    if not (inverse > 0).all():
        raise InputError(
            "no four-quadrant ellipse comes near this limit curve", where="profile", remedy="give gentler slopes or less friction"
        )
    error = 1 / np.sqrt(squares @ inverse) - 1
    a_plus, b_plus, a_minus, b_minus = (float(x) for x in 1 / np.sqrt(inverse))
    rms = float(np.sqrt(np.mean(error**2)))
    return FourQuadrantFit(a_plus, a_minus, b_plus, b_minus, float(np.abs(error).max()), rms)


# -- one side, symbolically --------------------------------------------------------------------------------------------


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
