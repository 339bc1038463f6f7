r"""The oblique limit curve runs around zero in polar order, T x T' > 0, for every profile: proved in steps.

In the frame d = (cos phi, sin phi), e = (-sin phi, cos phi), with a side of slope t, u = w mu, w^2 = (1 + t^2)/(1 + t^2 c^2),
D = 1 - u t c, c = cos phi, s = sin phi, the traction R of the side and its derivative R' by phi are

    R.d = t c + u (1 + t^2 c^2)/D,   R.e = -t s/D,   R'.e = u (w^2 - u t c)/D^2,   R'.d = -u^2 t s/D^2.

T x T' = (T.d)(T'.e) - (T.e)(T'.d).  With x = tan alpha and y = tan beta as slopes x, -y and weights y, x the terms t c cancel in
T.d, and (T.e)(T'.d) = x^2 y^2 s^2 (1/D_1 - 1/D_2)(u_1^2/D_1^2 - u_2^2/D_2^2) up to the factor 1/(x + y)^2.  For c >= 0 it is less than
what the side alpha alone gives to (T.d)(T'.e); for c < 0 the sides change places (phi -> pi - phi).
"""

from __future__ import annotations

import sympy as sp

from duhem.expression import symbol
from duhem.proof.decide import Question, Sense, decide
from duhem.proof.verdict import Evidence, Verdict

__all__ = ["star_shaped"]

_X, _Y, _U, _V = (symbol(name, positive=True) for name in ("x", "y", "u", "v"))
_C, _S = symbol("c", nonnegative=True), symbol("s")


def star_shaped() -> Evidence:
    """T x T' > 0 at every angle, for every profile with mu_alpha tan alpha < 1, mu_beta tan beta < 1 (Eqs. 4, 16)."""
    if not all(_vanishes(gap) for gap in _identities()):
        return Evidence(Verdict.UNDECIDED, "none", "an identity of the frame fails")
    alpha, beta = _parts(_X, _U), _parts(-_Y, _V)
    product = (_Y * alpha[1] + _X * beta[1]) * (_Y * alpha[3] + _X * beta[3])  # (T.e)(T'.d)
    ahead, behind = 1 / (1 - _U * _X * _C), 1 / (1 + _V * _Y * _C)
    most = _X**2 * _Y**2 * _S**2 * (ahead - behind) * _U**2 * ahead**2
    below = most - _X**2 * _Y**2 * _S**2 * (ahead - behind) * _V**2 * behind**2
    if not _vanishes(product - below):
        return Evidence(Verdict.UNDECIDED, "none", "the product (T.e)(T'.d) has another form")
    alone = (_Y * (alpha[0] - _X * _C)) * (_Y * alpha[2])
    given = (_U * _X * _C < 1, _C <= 1)
    on_circle = {_S**2: 1 - _C**2}
    steps = (
        (1 - (1 + _X**2) * _C**2 / (1 + _X**2 * _C**2), Sense.NONNEGATIVE, (_C <= 1,)),  # w c <= 1, so u x c <= mu x < 1
        (ahead - behind, Sense.NONNEGATIVE, given),  # what is left out of (T.e)(T'.d) is negative
        (beta[0] + _Y * _C, Sense.NONNEGATIVE, given),  # what is left out of (T.d)(T'.e) is not
        (beta[2], Sense.NONNEGATIVE, given),
        (alpha[0] - _X * _C, Sense.POSITIVE, given),
        (alpha[2], Sense.POSITIVE, given),
        ((alone - most).subs(on_circle), Sense.POSITIVE, given),
    )
    answers = [decide(Question(sp.together(expr), sense, hypotheses)) for expr, sense, hypotheses in steps]
    if any(answer.holds is not True for answer in answers):
        return Evidence(Verdict.UNDECIDED, "none", "a step stayed open")
    methods = ", ".join(sorted({answer.method for answer in answers}))
    return Evidence(Verdict.PROVED, methods, "(T.d)(T'.e) exceeds (T.e)(T'.d) already by the side that is climbed")


def _parts(t: sp.Expr, u: sp.Symbol) -> tuple[sp.Expr, sp.Expr, sp.Expr, sp.Expr]:
    """R.d, R.e, R'.e, R'.d of a side as the module states them."""
    free = 1 - u * t * _C
    w2 = (1 + t**2) / (1 + t**2 * _C**2)
    return t * _C + u * (1 + t**2 * _C**2) / free, -t * _S / free, u * (w2 - u * t * _C) / free**2, -(u**2) * t * _S / free**2


def _identities() -> list[sp.Expr]:
    """What must vanish for those to be right, from R = (t + u c, u s)/D and u' = u t^2 c s/(1 + t^2 c^2)."""
    t, u = symbol("t"), _U
    mu = symbol("mu", positive=True)
    w = sp.sqrt((1 + t**2) / (1 + t**2 * _C**2))
    growth = t**2 * _C * _S / (1 + t**2 * _C**2)
    traction = ((t + u * _C) / (1 - u * t * _C), u * _S / (1 - u * t * _C))
    turned = [_C * sp.diff(r, _S) - _S * sp.diff(r, _C) + u * growth * sp.diff(r, u) for r in traction]
    found = (_along(traction), _across(traction), _across(turned), _along(turned))
    slope_of_u = sp.cancel(sp.together(-_S * sp.diff(sp.log(mu * w), _C))) - growth
    return [slope_of_u, *(a - b for a, b in zip(found, _parts(t, u), strict=True))]


def _along(v: tuple[sp.Expr, ...] | list[sp.Expr]) -> sp.Expr:
    return v[0] * _C + v[1] * _S


def _across(v: tuple[sp.Expr, ...] | list[sp.Expr]) -> sp.Expr:
    return v[1] * _C - v[0] * _S


def _vanishes(expr: sp.Expr) -> bool:
    """Whether an expression is 0 on c^2 + s^2 = 1."""
    numerator, _ = sp.fraction(sp.cancel(sp.together(expr)))
    return bool(sp.expand(sp.rem(sp.expand(numerator), _S**2 + _C**2 - 1, _S)) == 0)
