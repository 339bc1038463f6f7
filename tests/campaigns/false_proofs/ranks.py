"""Linear maps of the forces that lose rank at some admitted parameters: K is a strip there, its support function infinite.

Every other claim is true: K = {|M sigma| <= N} is convex, smooth (an ellipse or a strip), and holds the origin.  A closed
form of the dual potential with finite values divides by the determinant, and is true only where the range keeps off its zeros.
"""

from __future__ import annotations

import random
from collections.abc import Callable
from fractions import Fraction

from tests.campaigns.false_proofs.trap import Trap, interval, known, margin, ranged, written

__all__ = ["losing_rank"]

F = Fraction

# |M(e) sigma| <= N; the determinant is a multiple of a power of e - s
FORMS = (
    "norm(a, a + D*b)**2 + norm(a, D*b)**2 - p**2", "norm(a + e*b, a + S*b) - abs(p)", "norm(D*a + b, b) - abs(p)",
    "(D*a + b)**2 + b**2 - p**2", "norm(a + b, D*b) - abs(p)", "norm(D*a, D*b + a) - abs(p)",
    "sqrt((a + e*b)**2 + (a + S*b)**2) - abs(p)",
    "norm(D**2*a + b, b) - abs(p)", "norm(a + b, b + a + D*a) - abs(p)",
)  # fmt: skip


def single(rng: random.Random) -> Trap:
    """One parameter e over a range with or without s."""
    s, meets = F(rng.randint(-2, 2), 2), rng.random() < 0.6
    low, high = rng.choice([(s - 1, s + 1), (s, s + 1), (s - 1, s)]) if meets else (s + margin(rng), s + 1)
    x = ranged(rng, "e", low, high)
    g = rng.choice(FORMS).replace("D", f"(e - {written(s)})").replace("S", written(s))
    return Trap("one parameter", g, known("ocsnd") | (known("", "u") if meets else known("u")), x.parameters, x.constraints)


def pair(rng: random.Random) -> Trap:
    """|(a + e b, f a + b)| <= N, of determinant 1 - e f: two parameters that may or may not reach e f = 1."""
    kind = rng.choice(["corner", "inside", "off", "touching"])
    high = F(1) if kind == "corner" else F(2) if kind in ("inside", "touching") else 1 - margin(rng)
    constraints = (f"e*f <= {written(1 - margin(rng))}",) if kind == "inside" and rng.random() < 0.5 else ()
    constraints = ("e*f <= 1",) if kind == "touching" else constraints
    meets = kind != "off" and (kind != "inside" or not constraints)
    parameters = {"e": interval(F(0), high), "f": interval(F(0), high)}
    g = rng.choice(["norm(a + e*b, f*a + b) - abs(p)", "(a + e*b)**2 + (f*a + b)**2 - p**2"])
    return Trap("two parameters", g, known("ocsnd") | (known("", "u") if meets else known("u")), parameters, constraints)


def polygon(rng: random.Random) -> Trap:
    """A parallelogram that becomes a strip at e = s: the same with corners."""
    s, meets = F(rng.randint(-1, 1)), rng.random() < 0.6
    x = ranged(rng, "e", s if meets else s + margin(rng), s + 1)
    u, v = "a + e*b", f"a + {written(s)}*b"
    g = rng.choice([f"max(abs({u}), abs({v})) - abs(p)", f"abs({u}) + abs({v}) - abs(p)"])
    return Trap("parallelogram", g, known("ocnd", "s") | (known("", "u") if meets else known("u")), x.parameters, x.constraints)


def space(rng: random.Random) -> Trap:
    """|(a + b, b + e c, c + a)| <= N, of determinant 1 + e."""
    meets = rng.random() < 0.6
    low = rng.choice([F(-1), F(-2)]) if meets else -1 + margin(rng)
    x = ranged(rng, "e", low, F(1))
    truth = known("ocsnd") | (known("", "u") if meets else known("u"))
    return Trap("three forces", "norm(a + b, b + e*c, c + a) - abs(p)", truth, x.parameters, x.constraints, forces=("a", "b", "c"))


def ramps(rng: random.Random) -> Trap:
    """The ellipse of four half-axes; where a coefficient may be 0 one of them is infinite."""
    meets = rng.random() < 0.6
    x = ranged(rng, "e", F(0) if meets else margin(rng), F(1))
    g = rng.choice([
        "norm(e*pos(a) + neg(a), b) - abs(p)", "norm(pos(a) + neg(a), e*pos(b) + 2*neg(b)) - abs(p)",
        "norm(e*abs(a), pos(b) + e*neg(b)) - abs(p)",
    ])  # fmt: skip
    return Trap("ramps", g, known("ocsnd") | (known("", "u") if meets else known("u")), x.parameters, x.constraints)


RANKS: tuple[Callable[[random.Random], Trap], ...] = (single, pair, polygon, single, space, ramps)


def losing_rank(rng: random.Random, place: int) -> Trap:
    """One of them."""
    return RANKS[place % len(RANKS)](rng)
