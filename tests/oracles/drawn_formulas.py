"""Formulas drawn at random in the vocabulary, undefined ones included, and their values by ``math`` alone."""

from __future__ import annotations

import math
from collections.abc import Mapping
from random import Random
from typing import Any

from duhem.proof.kernel.term import Term

FORCES = ("a", "b")
PARAMETERS = {
    "m": {"positive": True},
    "e": {"min": "0", "max": "1/2"},
    "q": {"min": "-1", "max": "1"},
    "p": {"min": "1", "max": "4"},
    "k": {"min": "-2", "max": "-1/2"},
}
CONSTRAINTS = ("e < m", "q < p")
_LEAVES = ("a", "b", "a", "b", "m", "e", "q", "p", "k", "s", "1", "2", "0", "1/2", "a-b", "a+b", "abs(s)", "-1", "3")
_EXPONENTS = ("2", "3", "1/2", "p", "1/p", "4", "-1", "0", "1", "3/2", "m", "q", "-2", "2/3")
_WORDS = ("abs", "exp", "log", "tanh", "atan", "pos", "neg", "sqrt", "norm", "max", "min", "norm", "max", "abs", "pos", "sin", "cos")


def text(rng: Random, depth: int) -> str:
    """A formula of the forces a and b, the pressure s and the parameters."""
    if depth == 0 or rng.random() < 0.12:
        return rng.choice(_LEAVES)
    shape = rng.random()
    if shape < 0.22:
        return f"({text(rng, depth - 1)} + {text(rng, depth - 1)})"
    if shape < 0.3:
        return f"({text(rng, depth - 1)} - {text(rng, depth - 1)})"
    if shape < 0.56:
        return f"({text(rng, depth - 1)}){'*' if shape < 0.48 else '/'}({text(rng, depth - 1)})"
    if shape < 0.68:
        return f"({text(rng, depth - 1)})**({rng.choice(_EXPONENTS)})"
    word = rng.choice(_WORDS)
    return f"{word}({', '.join(text(rng, depth - 1) for _ in range(rng.choice((1, 2, 2, 3)) if word in ('norm', 'max', 'min') else 1))})"


def law(g: str) -> dict[str, Any]:
    """The law of a certificate over that formula."""
    return {"forces": list(FORCES), "pressure": "s", "parameters": PARAMETERS, "constraints": list(CONSTRAINTS), "g": g, "flow": None}


def parameters(rng: Random) -> dict[str, float]:
    """A point of the parameters' domain, often at an end of it, and a pressure."""
    while True:
        point = {
            "m": 10 ** rng.uniform(-2, 2),
            "e": rng.choice((0.0, 0.5, rng.uniform(0, 0.5))),
            "q": rng.choice((-1.0, 1.0, 0.0, rng.uniform(-1, 1))),
            "p": rng.choice((1.0, 4.0, 2.0, rng.uniform(1, 4))),
            "k": rng.choice((-2.0, -0.5, rng.uniform(-2, -0.5))),
            "s": -(10 ** rng.uniform(-2, 2)),
        }
        if point["e"] < point["m"] and point["q"] < point["p"]:
            return point


def forces(rng: Random) -> dict[str, float]:
    """A point of the plane of forces, often on an axis."""
    return {f: rng.choice((0.0, 1.0, -1.0, rng.gauss(0, 1) * 10 ** rng.uniform(-2, 2))) for f in FORCES}


def value(term: Term, at: Mapping[str, float]) -> float:
    """The formula's value; ValueError where it is undefined."""
    if term.op == "number":
        return float(term.value)
    if term.op == "name":
        return at[term.name]
    x = [value(a, at) for a in term.args] if term.op != "where" else []
    if term.op == "**":
        whole = term.args[1].op == "number" and term.args[1].value.denominator == 1
        if whole and x[1] == 0:
            return 1.0
        if (x[0] < 0 and not whole) or (x[0] == 0 and x[1] <= 0):
            raise ValueError(f"{x[0]} ** {x[1]}")
        return float(x[0] ** x[1])
    if term.op == "where":
        return value(term.args[1 if value(term.args[0], at) else 2], at)
    if term.op in _SEVERAL:
        return float(_SEVERAL[term.op](x))
    return float(_ONE[term.op](x[0]))


_SEVERAL = {
    "+": sum, "*": math.prod, "max": max, "min": min, "norm": lambda x: math.hypot(*x),
    "<": lambda x: x[0] < x[1], "<=": lambda x: x[0] <= x[1], ">": lambda x: x[0] > x[1], ">=": lambda x: x[0] >= x[1],
    "atan2": lambda x: math.atan2(*x) if any(x) else math.log(0), "eigmax": lambda x: _greatest_eigenvalue(*x),
}  # fmt: skip
_ONE = {
    "abs": abs, "exp": math.exp, "log": math.log, "sin": math.sin, "cos": math.cos, "tan": math.tan, "tanh": math.tanh, "atan": math.atan,
    "asin": math.asin, "acos": math.acos, "sinh": math.sinh, "cosh": math.cosh,
    "pos": lambda x: max(x, 0.0), "neg": lambda x: max(-x, 0.0),
}  # fmt: skip


def _greatest_eigenvalue(xx: float, yy: float, zz: float, yz: float, xz: float, xy: float) -> float:
    """Of a symmetric matrix, by its invariants."""
    mean = (xx + yy + zz) / 3
    x, y, z = xx - mean, yy - mean, zz - mean
    second = (x * x + y * y + z * z) / 2 + yz * yz + xz * xz + xy * xy
    third = x * y * z + 2 * yz * xz * xy - x * yz**2 - y * xz**2 - z * xy**2
    angle = math.acos(max(-1.0, min(1.0, third / 2 * (3 / second) ** 1.5))) / 3 if second else 0.0
    return mean + 2 * math.sqrt(second / 3) * math.cos(angle)
