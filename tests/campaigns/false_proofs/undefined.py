"""Functions outside their domain: logarithms, roots and quotients that have no value at some admitted parameters or forces.

A law without a value at an admitted parameter is no law.  Where only some forces have none, they are not in K.
"""

from __future__ import annotations

import random
from collections.abc import Callable
from fractions import Fraction

from tests.campaigns.false_proofs.trap import Trap, known, margin, ranged

__all__ = ["undefined"]

F = Fraction

# a function of q that is > 0, or a bounded one, where q > 0; without a value for some q <= 0 (at 0 too, or below 0 only)
AT_ZERO = (
    "max(1, log(Q))", "max(1, 1/Q)", "2 + abs(Q)/Q", "1 + Q/Q", "exp(log(Q))", "1 + 0*log(Q)", "2 + 0/Q", "1 + log(Q)/log(Q + 2)**2*0",
    "1 + Q**(-1)", "1 + abs(log(Q))", "2 + log(Q) - log(Q)", "1 + Q**2/Q", "1 + Q**(-1/2)", "1 + 1/abs(Q)", "norm(1, log(Q))", "exp(-1/Q)",
    "exp(1/Q)", "1 + pos(1/Q)", "1 + Q*Q**(-1)", "max(2, tanh(log(Q)))", "min(2, 1 + 1/Q**2)", "1 + sqrt(Q)/sqrt(Q)", "2 + sin(1/Q)",
    "max(1, log10(Q))", "2 + 0*log10(Q)", "2 + atan2(Q, 0)", "2 + cos(3*atan2(Q, 2*Q))", "2 + sinh(1/Q)/cosh(1/Q)",
)  # fmt: skip
BELOW = (
    "1 + sqrt(Q)", "1 + sqrt(Q)**2", "1 + Q**(1/2)", "1 + Q**(3/2)", "max(1, sqrt(Q))", "1 + 0*sqrt(Q)", "2 + sqrt(Q) - sqrt(Q)",
    "1 + abs(sqrt(Q))", "norm(1, sqrt(Q))", "1 + pos(Q)*sqrt(Q)", "1 + exp(sqrt(Q))", "1 + Q**(1/4)", "1 + (Q**3)**(1/2)",
    "1 + acos(1 - Q)", "2 + asin(1 - Q)", "1 + 0*acos(1 - Q)", "1 + cos(acos(1 - Q))**2", "1 + where(Q < 9 or sqrt(Q) > 0, sqrt(Q), 1)",
)  # fmt: skip


def radius(rng: random.Random) -> Trap:
    """|sigma| <= N R(q), or |sigma|/R(q) <= N, R > 0 wherever it has a value."""
    at_zero = rng.random() < 0.6
    word = rng.choice(AT_ZERO if at_zero else BELOW)
    low = rng.choice([F(-1), F(0), -margin(rng), F(1, 10), F(-1), margin(rng)])
    refused = low < 0 or (at_zero and low == 0)
    shift = rng.choice([F(0), F(1), F(-1, 2)])
    x = ranged(rng, "q", low + shift, F(2) + shift)
    r = word.replace("Q", f"(q - ({shift}))" if shift else "q")
    g = rng.choice([f"norm(a, b) - abs(p)*({r})", f"norm(a, b)/({r}) - abs(p)", f"norm(a, b)**2 - p**2*({r})**2"])
    return Trap("radius", g, {} if refused else known("ocsnd"), x.parameters, x.constraints, refused=refused)


def pole(rng: random.Random) -> Trap:
    """A tangent of a parameter: without a value at pi/2 = 1.5707..."""
    meets = rng.random() < 0.5
    x = ranged(rng, "q", F(0), F(2) if meets else F(3, 2))
    return Trap(
        "pole", "norm(a, b) - abs(p)*(1 + abs(tan(q)))", {} if meets else known("ocsnd"), x.parameters, x.constraints, refused=meets
    )


# (formula, true, false): what has no value is left out of K
FORCES = (
    ("norm(a, b) - 1 + 0*log(a)", "c", "s"),  # the half-disc a > 0
    ("norm(a, b) - 1 + log(a) - log(a)", "c", "s"),
    ("norm(a, b) - 1 + 0*log10(a)", "c", "s"),
    ("norm(a, b) - 1 + 0*acos(2*a)", "oc", "s"),  # |a| <= 1/2
    ("norm(a, b) - 1 + asin(2*a) - asin(2*a)", "oc", "s"),
    ("cos(acos(2*a))*2 + b**2 - 1", "oc", "s"),
    ("norm(a, b) - 1 + 0*atan2(a, 0)", "", "cn"),  # without the line a = 0
    ("norm(a, b) - 2 + sin(atan2(a, 0))**2", "", "cn"),
    ("norm(a, b) - 1 + sqrt(a) - sqrt(a)", "oc", "s"),  # a >= 0
    ("norm(a, b) - 1 + 0*sqrt(a)", "oc", "s"),
    ("sqrt(a)**2 + b**2 - 1", "oc", "s"),
    ("(sqrt(a)**2)**2 + b**2 - 1", "oc", "s"),
    ("pos(a)*sqrt(a) + b**2 - 1", "oc", "s"),
    ("exp(log(a)) + abs(b) - 1", "c", "s"),
    ("exp(2*log(a)) + b**2 - 1", "c", "s"),
    ("max(norm(a, b) - 1, log(a))", "c", "s"),
    ("max(norm(a, b) - 1, sqrt(a) - 2)", "oc", "s"),
    ("norm(a, b) - 1 + 0/a", "", "cn"),  # without the line a = 0
    ("a**2/a + b - 1", "", "cn"),
    ("(a*b)/b + b**2 - 1", "", "cn"),
    ("norm(a, b)*a/a - 1", "", "cn"),
    ("norm(a, b) - abs(a)/abs(a)", "", "cn"),
    ("a**2 + (b**2)**2/b**2 - 1", "", "cn"),
    ("(norm(a, b) - 1)**(1/3)", "", "ocn"),  # the circle, or the outside
    ("(norm(a, b) - 1)**(3/2)", "", "ocn"),
    ("sqrt(norm(a, b) - 1)", "", "ocn"),
    ("sqrt(a**2 + b**2 - 1)**2", "", "ocn"),
    ("exp(log(norm(a, b) - 1)) - 1", "", "ocn"),  # a ring
    ("log(norm(a, b) - 1)", "", "ocn"),
    ("(norm(a, b) - 2)*sqrt(norm(a, b) - 1)**2", "", "ocn"),
    ("norm(a, b) - 1 + 0*sqrt(norm(a, b) - 1/2)", "", "ocn"),
    ("norm(a, b) - 1 + 0*log(norm(a, b) - 1/1000000000)", "", "ocn"),
    ("norm(a, b) - 1 + 0*sqrt(1/4 - norm(a, b)) - 0*sqrt(1/4 - norm(a, b))", "ocsn", ""),  # a disc of radius 1/4
    ("max(norm(a, b) - 1, 0*sqrt(a*b))", "o", "csn"),  # two quadrants of the disc
    ("norm(a, b) - 1 + 0*sqrt(a*b)", "o", "csn"),
    ("norm(a, b) - 1 + sqrt(a**2 - 1/100) - sqrt(a**2 - 1/100)", "", "ocsn"),
    ("norm(a, b) + 0*tan(2*a) - 1", "", "cn"),
    ("min(norm(a, b) - 1, 0*log(a) + 1)", "c", "s"),
    ("abs(a)**(1/2)*a**(1/2) + b**2 - 1", "oc", "s"),
    ("(a**(1/2))**4 + b**2 - 1", "oc", "s"),
    ("a**(5/2)/sqrt(a) + b**2 - 1", "c", "s"),
)  # fmt: skip


def of_forces(rng: random.Random) -> Trap:
    """One of a list, at some scale."""
    g, true, false = rng.choice(FORCES)
    scale = rng.choice(["", "", "2*(G)", "k*(G)"])
    parameters = {"k": "{ positive = true }"} if "k" in scale else {}
    return Trap("of forces", scale.replace("G", g) or g, known(true, false), parameters, pressure=None)


def under_a_root(rng: random.Random) -> Trap:
    """A threshold function under a power that has a value for f >= 0 only: K is the curve f = 0, or f >= 0 is dropped from it."""
    f = rng.choice(["a**2 + b**2 - 1", "a**4 + b**4 - 1", "norm(a, 2*b) - 1", "abs(a) + abs(b) - 1"])
    word = rng.choice(["sqrt(F)", "(F)**(3/2)", "(F)**(1/4)", "sqrt(F)**3", "(F)*sqrt(F)", "exp(log(F)/2)", "sqrt(F)*abs(F)"])
    return Trap("under a root", word.replace("F", f), known("", "o" if "log" in word else "ocn"), pressure=None)


UNDEFINED: tuple[Callable[[random.Random], Trap], ...] = (radius, of_forces, radius, of_forces, pole, under_a_root, of_forces)


def undefined(rng: random.Random, place: int) -> Trap:
    """One of them."""
    return UNDEFINED[place % len(UNDEFINED)](rng)
