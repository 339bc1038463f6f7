"""Quotients that are a sign, and steps: a function that jumps across a line, where algebra on either side sees none.

A quotient is undefined on the line itself, and what is undefined is not in K: with it the claims about the origin and the
dissipation are left out.
"""

from __future__ import annotations

import random
from collections.abc import Callable
from fractions import Fraction

from tests.campaigns.false_proofs.trap import Trap, beside, interval, known, margin, written

__all__ = ["QUOTIENTS", "STEPS", "jumping"]

F = Fraction

# the sign of x, without a value at 0
QUOTIENTS = (
    "abs(X)/X", "X/abs(X)", "sqrt((X)**2)/X", "X/sqrt((X)**2)", "(pos(X)/X + neg(X)/X)", "(X)**3/abs(X)**3", "norm(X)/X", "max(X, -X)/X",
    "((X)**2)**(1/2)/X", "abs(X)*(X)**(-1)", "(X)*abs(X)**(-1)", "(2*pos(X)/X - 1)", "(1 - 2*neg(X)/abs(X))", "norm(X, 0)/X", "X/norm(X)",
    "(2*atan2(X, 0)/pi)", "(1 - 2*atan2(0, X)/pi)", "sign(X)*X/X",
)  # fmt: skip
# with one
STEPS = (
    "where(X > 0, 1, -1)", "where(X >= 0, 1, -1)", "where(X < 0, -1, 1)", "(1 - 2*where(X <= 0, 1, 0))", "(where(X > 0, 2, 0) - 1)",
    "where((X)**3 > 0, 1, -1)", "where(X > 0, 1, where(X < 0, -1, 1))", "(where(X > 0, 1, 0) - where(X <= 0, 1, 0))",
    "sign(X)", "where(X > 0 and X > -1, 1, -1)", "where(X > 0 or X > 1, 1, -1)",
)  # fmt: skip
LINES = ("a", "b", "(a + b)", "(a - 2*b)", "(3*a)", "(-b)")


def _sign(rng: random.Random, x: str | None = None) -> tuple[str, bool]:
    """A sign of a linear form, and whether it has a value on its zeros."""
    defined = rng.random() < 0.4
    return rng.choice(STEPS if defined else QUOTIENTS).replace("X", x or rng.choice(LINES)), defined


def radius(rng: random.Random) -> Trap:
    """|sigma| <= N (1 + e s(x)), 0 < |e| < 1: two half-discs of different radii, with corners where the line cuts them.

    A segment from the end of the larger half on the line to a point inside the lesser one leaves K beside the line.  On
    the line itself sigma . n = 0.
    """
    e = rng.choice([F(1, 2), F(-1, 3), margin(rng), -margin(rng)])
    s, defined = _sign(rng)
    g = rng.choice([
        f"norm(a, b) - abs(p)*(1 + {written(e)}*{s})", f"norm(a, b)/(1 + {written(e)}*{s}) - abs(p)",
        f"norm(a, b)**2 - p**2 - {written(e)}*{s}*p**2", f"a**4 + b**4 - p**4*(1 + {written(e)}*{s})",
    ])  # fmt: skip
    return Trap("two radii", g, known("od" if defined else "", "csn"))


def no_jump(rng: random.Random) -> Trap:
    """|sigma| + e x s(x) <= N, s with a value at 0: the kink e |x|, inward for e < 0."""
    e, x = beside(rng), rng.choice(["a", "b"])
    s = rng.choice(STEPS).replace("X", x)
    truth = known("od") | (known("cn") if e >= 0 else known("", "cn")) | (known("s") if e == 0 else known("", "s"))
    return Trap("a kink", f"norm(a, b) + {written(e)}*{x}*{s} - abs(p)", truth)


def of_a_parameter(rng: random.Random) -> Trap:
    """A sign of a parameter: a disc where the parameter has one sign, no law where it may be 0."""
    low = rng.choice([F(-1), F(0), -margin(rng), margin(rng), F(1, 2)])
    s, defined = _sign(rng, "q")
    g = f"norm(a, b) - abs(p)*(2 + {s})"
    return Trap("of a parameter", g, known("ocsnd"), {"q": interval(low, F(1))}, refused=not defined and low <= 0)


def half_disc(rng: random.Random) -> Trap:
    """The disc where x < 0 or x <= 0: convex, with two corners."""
    s, defined = _sign(rng)
    closed = defined and ">=" not in s and "< 0" not in s
    return Trap("half a disc", f"max(norm(a, b) - abs(p), {s} - 1/2)", known("ocnd" if closed else "c", "s"))


def disc_and_half_plane(rng: random.Random) -> Trap:
    """The disc or x < 0: not convex, with corners."""
    s, defined = _sign(rng)
    return Trap("a disc and a half-plane", f"min(norm(a, b) - abs(p), {s} + 1/2)", known("o" if defined else "", "csn"))


def quadrants(rng: random.Random) -> Trap:
    """Three quadrants, two opposite ones, or one."""
    s, t = (_sign(rng, x)[0] for x in ("a", "b"))
    form, truth = rng.choice([
        (f"{s} + {t} - 1", known("", "csn")), (f"min({s}, {t})", known("", "csn")), (f"({s})*({t})", known("", "cn")),
        (f"max({s}, {t})", known("c", "s")),
    ])  # fmt: skip
    return Trap("quadrants", form, truth, pressure=None)


def half_plane(rng: random.Random) -> Trap:
    """a <= d or a < d by a step: 0 in K, and dissipative, if d > 0; neither if d < 0."""
    d = beside(rng)
    s = rng.choice(STEPS).replace("X", f"(a - {written(d)})")
    inside = known("od") if d > 0 else known("", "od") if d < 0 else {}
    return Trap("half-plane", s, known("csn") | inside, pressure=None)


def hole(rng: random.Random) -> Trap:
    """The unit disc without the disc of radius h, by a step: neither the origin nor convex, however small h is."""
    h = rng.choice([F(0), margin(rng), F(1, 2)])
    g = rng.choice([
        f"norm(a, b) + where(norm(a, b) > {written(h)}, 0, 5) - 1", f"max(norm(a, b) - 1, where(norm(a, b) <= {written(h)}, 1, -1))",
        f"where(a**2 + b**2 <= {written(h)}**2, 1, norm(a, b) - 1)",
    ])  # fmt: skip
    return Trap("hole", g, known("", "ocn"), pressure=None)


def interval_of_one_force(rng: random.Random) -> Trap:
    """|a| <= N (1 + e s(a)), |e| < 1: an interval about 0."""
    e = rng.choice([F(1, 2), margin(rng), -margin(rng)])
    s, defined = _sign(rng, "a")
    truth = known("ocsnd") if defined else {}
    return Trap("one force", f"abs(a) - abs(p)*(1 + {written(e)}*{s})", truth, forces=("a",))


def flow(rng: random.Random) -> Trap:
    """A disc with the flow s(x) sigma: against the normal, and the force, where x < 0."""
    s, _ = _sign(rng)
    components = rng.choice([(f"a*{s}", f"b*{s}"), (f"a*{s}/norm(a, b)", f"b*{s}/norm(a, b)")])
    return Trap("flow", "norm(a, b) - abs(p)", known("ocs", "nd"), flow=components)


JUMPS: tuple[Callable[[random.Random], Trap], ...] = (
    radius, no_jump, of_a_parameter, half_disc, disc_and_half_plane, quadrants, half_plane, hole, interval_of_one_force, flow, radius,
)  # fmt: skip


def jumping(rng: random.Random, place: int) -> Trap:
    """One of them."""
    return JUMPS[place % len(JUMPS)](rng)
