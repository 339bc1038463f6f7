"""A claim that fails at an end of a parameter's range only, or just beyond it, the range said in a dozen ways."""

from __future__ import annotations

import random
from collections.abc import Callable
from fractions import Fraction

from tests.campaigns.false_proofs.trap import Range, Trap, beside, known, margin, ranged

__all__ = ["ending"]

F = Fraction


def _trap(kind: str, g: str, truth: dict[str, bool], x: Range, pressure: str | None = "p", refused: bool = False) -> Trap:
    return Trap(kind, g, truth, x.parameters, x.constraints, pressure=pressure, refused=refused)


def _either(claims: str, holds: bool) -> dict[str, bool]:
    return known(claims) if holds else known("", claims)


def quartic(rng: random.Random) -> Trap:
    """a^4 + c a^2 b^2 + b^4 <= N^4: convex if and only if 0 <= c <= 6 (maps.py)."""
    low, high = (F(0), 6 + beside(rng)) if rng.random() < 0.6 else (beside(rng), F(5))
    x = ranged(rng, "c", low, high)
    return _trap("quartic", "a**4 + b**4 + c*a**2*b**2 - p**4", known("osd") | _either("cn", low >= 0 and high <= 6), x)


def waves(rng: random.Random) -> Trap:
    """The gauge r (1 + e cos 3 theta): convex if and only if |e| <= 1/8 (maps.py)."""
    x = ranged(rng, "e", F(0), F(1, 8) * (1 + beside(rng)))
    g = "norm(a, b)**3 + e*(a**3 - 3*a*b**2) - abs(p)*norm(a, b)**2"
    return _trap("waves", g, known("osd") | _either("cn", x.high <= F(1, 8)), x)


def limacon(rng: random.Random) -> Trap:
    """r <= N (1 + e cos theta): convex if and only if |e| <= 1/2 (maps.py)."""
    x = ranged(rng, "e", F(0), F(1, 2) * (1 + beside(rng)))
    return _trap("limacon", "norm(a, b)**2 - abs(p)*(norm(a, b) + e*a)", known("osd") | _either("cn", x.high <= F(1, 2)), x)


def shifted(rng: random.Random) -> Trap:
    """A disc about (s N, 0): 0 in K, and dissipative, if and only if s <= 1."""
    x = ranged(rng, "s", F(0), 1 + beside(rng))
    g = rng.choice(["norm(a - s*abs(p), b) - abs(p)", "(a - s*abs(p))**2 + b**2 - p**2"])
    return _trap("shifted", g, known("csn") | _either("od", x.high <= 1), x)


def width(rng: random.Random) -> Trap:
    """|(e a, b)| <= N: a strip at e = 0, whose support function is infinite in most directions; no formula of finite values is it."""
    low = rng.choice([F(0), F(0), margin(rng), F(-1)])
    x = ranged(rng, "e", low, F(1))
    g = rng.choice(["norm(e*a, b) - abs(p)", "(e*a)**2 + b**2 - p**2", "norm(e*a, b)/abs(p) - 1", "norm(abs(e)*a, b) - abs(p)"])
    return _trap("width", g, known("ocsnd") | _either("u", low > 0), x)


def strip(rng: random.Random) -> Trap:
    """max(e |a|, |b|) <= N or e |a| + |b| <= N: corners for e > 0, none where e is 0; duality as for the width."""
    low = rng.choice([F(0), margin(rng)])
    x = ranged(rng, "e", low, F(1))
    return _trap(
        "strip", rng.choice(["max(e*abs(a), abs(b)) - abs(p)", "e*abs(a) + abs(b) - abs(p)"]), known("ocnd", "s") | _either("u", low > 0), x
    )


def parabola(rng: random.Random) -> Trap:
    """b <= 1 + q a^2: convex if and only if q <= 0.  sigma . n has the sign of b - 2 q a^2 = 1 - q a^2 there."""
    x = ranged(rng, "q", F(-1), beside(rng))
    return _trap("parabola", "b - q*a**2 - 1", known("os") | _either("cnd", x.high <= 0), x, None)


def conic(rng: random.Random) -> Trap:
    """q a^2 + b^2 <= 1: an ellipse, a strip, or between the branches of a hyperbola; sigma . grad g = 2."""
    low = rng.choice([F(0), F(-1), -margin(rng), margin(rng)])
    x = ranged(rng, "q", low, F(2))
    return _trap("conic", "q*a**2 + b**2 - 1", known("osd") | _either("cn", low >= 0), x, None)


def size(rng: random.Random) -> Trap:
    """|sigma| <= q: empty for q < 0."""
    x = ranged(rng, "q", beside(rng), F(1))
    return _trap("size", rng.choice(["norm(a, b) - q", "norm(a, b) - q*abs(p)"]), known("cd") | _either("o", x.low >= 0), x)


def weight(rng: random.Random) -> Trap:
    """q |sigma| <= 1: a disc, or everything for q <= 0."""
    x = ranged(rng, "q", beside(rng), F(1))
    return _trap("weight", "q*norm(a, b) - 1", known("ocsnd"), x, None)


def exponent(rng: random.Random) -> Trap:
    """|a|^q + |b|^q <= 1: convex if and only if q >= 1, C^1 if and only if q > 1."""
    x = ranged(rng, "q", 1 + beside(rng), F(3))
    g = rng.choice(["abs(a)**q + abs(b)**q - 1", "(abs(a)**q + abs(b)**q)**(1/q) - 1"])
    return _trap("exponent", g, known("od") | _either("cn", x.low >= 1) | _either("s", x.low > 1), x, None)


def divisor(rng: random.Random) -> Trap:
    """A division by q - h, which may be 0 or keeps away from it."""
    h = rng.choice([F(0), F(1, 2), F(1)])
    meets = rng.random() < 0.5
    low, high = (h - 1, h + 1) if meets else (h + margin(rng), h + 2)
    if meets and rng.random() < 0.5:
        low, high = rng.choice([(h, h + 1), (h - 1, h)])
    x, by = ranged(rng, "q", low, high), f"(q - {h})"
    g = rng.choice(["norm(a/Q, b) - abs(p)", "norm(a, b)/Q**2 - abs(p)", "a**2/Q**2 + b**2 - p**2", "norm(a, b) - abs(p)*(2 + 1/Q**2)"])
    return _trap("divisor", g.replace("Q", by), known("ocsnd"), x, refused=meets)


def mixture(rng: random.Random) -> Trap:
    """(1 - w) of a disc and w of an inward kink: convex if and only if w = 0 throughout."""
    x = ranged(rng, "w", F(0), rng.choice([margin(rng), F(1, 2)]))
    return _trap("mixture", "(1 - w)*norm(a, b) + w*(norm(a, b) - abs(a)/2) - abs(p)", known("od", "csn"), x)


ENDS: tuple[Callable[[random.Random], Trap], ...] = (
    quartic, waves, limacon, shifted, width, strip, parabola, conic, size, weight, exponent, divisor, mixture, width,
)  # fmt: skip


def ending(rng: random.Random, place: int) -> Trap:
    """One of them."""
    return ENDS[place % len(ENDS)](rng)
