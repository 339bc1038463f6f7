"""Names that might collide with those that a prover makes for itself, with SymPy's, or with each other in Unicode.

Each law has the truth of its formula, whatever its letters are; the formulas are such that a collision would change it.
"""

from __future__ import annotations

import random
import unicodedata
from collections.abc import Callable
from dataclasses import replace
from fractions import Fraction

from tests.campaigns.false_proofs.trap import Trap, beside, interval, known

__all__ = ["named"]

F = Fraction

NAMES = (
    "abs_sigma_n", "abs_p", "abs_a", "N", "n", "t", "x", "y", "z", "u", "v", "w", "s", "r", "c", "q", "tip", "v0", "v1", "l_0_0", "l_1_0",
    "L_0_0", "k_0_0", "d_a", "d_b", "dd_a", "e0", "E0", "theta", "gamma", "beta", "zeta", "lamda", "Lambda", "sigma", "psi", "phi", "S",
    "E", "I", "O", "Q", "C", "oo", "nan", "zoo", "pi_", "Symbol", "Dummy", "Abs", "Max", "Rational", "_", "__", "_x", "x0", "re", "im",
    "signed", "Pos", "Norm", "Where", "True_", "true", "false", "Id", "u_0", "w_0", "one", "half", "σ", "μ", "θ",
    "λ", "γ", "\u0430", "\uff58", "\u00b5", "\U0001d461", "\u2113", "\u2126", "\u017f", "\ufb01", "x\u0301", "\u00e9", "e\u0301",
)  # fmt: skip
RESERVED = ("lambda", "pi", "norm", "abs", "where", "max", "and", "None", "True", "if")
ALIKE = (
    ("\u00b5", "\u03bc"), ("\uff58", "x"), ("\u017f", "s"), ("\U0001d461", "t"), ("\u212a", "K"), ("\u2113", "l"), ("\u00e9", "e\u0301"),
    ("\U0001d40d", "N"), ("\u2126", "\u03a9"),
)  # fmt: skip


def _plain(name: str) -> bool:
    """Letters, digits and underscores, each spelled in the one way that Python keeps."""
    return unicodedata.normalize("NFKC", name) == name and all(c.isalnum() or c == "_" for c in name)


def subtracted(rng: random.Random, x: str) -> Trap:
    """|sigma| <= N - x, x > 0: empty for x > N."""
    return Trap("subtracted", f"norm(a, b) + {x} - abs(p)", known("cd", "o"), {x: "{ positive = true }"})


def added(rng: random.Random, x: str) -> Trap:
    """|sigma| <= x N - 2 N, x in [1, 3]: empty for x < 2."""
    return Trap("added", f"norm(a, b) + 2*abs(p) - {x}*abs(p)", known("cd", "o"), {x: interval(F(1), F(3))})


def quartic(rng: random.Random, x: str) -> Trap:
    """a^4 + x a^2 b^2 + b^4 <= N^4: convex if and only if 0 <= x <= 6 (maps.py)."""
    high = 6 + beside(rng)
    truth = known("osd") | (known("cn") if high <= 6 else known("", "cn"))
    return Trap("quartic", f"a**4 + b**4 + {x}*a**2*b**2 - p**4", truth, {x: interval(F(0), high)})


def limacon(rng: random.Random, x: str) -> Trap:
    """r <= N (1 + x cos theta): convex if and only if |x| <= 1/2 (maps.py)."""
    high = F(1, 2) * (1 + beside(rng))
    truth = known("osd") | (known("cn") if high <= F(1, 2) else known("", "cn"))
    return Trap("limacon", f"norm(a, b)**2 - abs(p)*(norm(a, b) + {x}*a)", truth, {x: interval(F(0), high)})


def width(rng: random.Random, x: str) -> Trap:
    """|(x a, b)| <= N: a strip at x = 0."""
    low = rng.choice([F(0), F(1, 2)])
    return Trap("width", f"norm({x}*a, b) - abs(p)", known("ocsnd") | (known("u") if low else known("", "u")), {x: interval(low, F(2))})


def force(rng: random.Random, x: str) -> Trap:
    """The quartic in forces of those names, c just beyond 6 or at it."""
    c, other = 6 + beside(rng), rng.choice(["y", "t_", "b"])
    truth = known("osd") | (known("cn") if c <= 6 else known("", "cn"))
    return Trap("force", f"{x}**4 + {other}**4 + ({c})*{x}**2*{other}**2 - p**4", truth, forces=(x, other))


def pressure(rng: random.Random, x: str) -> Trap:
    """A disc that is empty for m > |pressure|."""
    m = rng.choice([f"abs_{x}", "m", "N"])
    return Trap("pressure", f"norm(a, b) + {m} - abs({x})", known("cd", "o"), {m: "{ positive = true }"}, pressure=x)


def of_a_flow(rng: random.Random, x: str) -> Trap:
    """A disc with the flow (x a, b), normal to it for x = 1 only."""
    return Trap("flow", "norm(a, b) - abs(p)", known("ocsd", "n"), {x: interval(F(1, 2), F(2))}, flow=(f"{x}*a", "b"))


def reserved(rng: random.Random) -> Trap:
    """A word of the language or of Python as a name."""
    x = rng.choice(RESERVED)
    return Trap("reserved", f"norm(a, b) - {x}*abs(p)", {}, {x: "{ positive = true }"}, refused=True)


def alike(rng: random.Random) -> Trap:
    """Two names that Unicode writes as one: which is meant?  The set is empty where the first is less than the second."""
    x, y = rng.choice(ALIKE)
    both = {x: "{ positive = true }", y: "{ positive = true }"}
    return Trap("alike", f"norm(a, b) - ({x} - {y})*abs(p)", known("", "o"), both, refused=True)


FORMULAS: tuple[Callable[[random.Random, str], Trap], ...] = (
    subtracted, quartic, width, added, force, limacon, pressure, of_a_flow,
)  # fmt: skip


def named(rng: random.Random, place: int) -> Trap:
    """Every name in turn, the formulas too; one in twelve is no name, or two in one."""
    if place % 12 == 11:
        return rng.choice([reserved, alike])(rng)
    x = NAMES[place % len(NAMES)]
    made = FORMULAS[(place + place // len(NAMES)) % len(FORMULAS)](rng, x)
    declared = [*made.forces, made.pressure, *made.parameters]
    if len(set(declared)) < len(declared):
        made = FORMULAS[0](rng, x)
    return replace(made, kind=f"{made.kind} {x}", refusable=not _plain(x))
