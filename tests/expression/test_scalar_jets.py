"""Derivatives as text against those on arrays, for every word of the language, pieces at kinks included."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
import sympy as sp

from duhem.errors import InputError
from duhem.expression import WORDS, symbol
from duhem.expression.jets import formula
from duhem.expression.parse import parse_expression
from duhem.expression.scalar_bounds import FUNCTIONS
from duhem.expression.scalar_jets import scalar_jets
from tests.expression.text_as_functions import named

FORCES = tuple(map(symbol, "abc"))
LOAD = symbol("p")
KNOWN = {s.name: s for s in (*FORCES, LOAD)}
TEXTS = [
    "a - 2*b + c*p - 3", "a*b*c - p", "a**2 + b**3 - c**4/p", "1/(1 + a**2) + (2 + b**2)**(-3)", "sqrt(2 + a*b) - (3 + c)**(5/2)",
    "(3 + a)**0.7 - p", "(3 + a)**(b + 2)", "(3 + a)**p - b", "norm(a, b) - c", "norm(a/3, 2*b, c - a) + p", "norm(a)", "norm(p, 2)",
    "(abs(a)**3 + abs(b)**3 + abs(a - b)**3)**(1/3) - p", "((a/p)**8 + (b/2)**8)**(1/8) - c", "(abs(a)**1.5 + abs(b)**1.5)**(1/1.5) + c",
    "abs(a - b) + pos(c) - neg(a*b)", "max(a, b, c - p, a*b)", "min(a**2, 1 - b) - max(c, 0)", "where(a > b, a**2, b*c)",
    "where(a >= 0 and b < c, norm(a, b), c - p)", "exp(a/3) + log(3 + b) - tanh(c)", "sin(a) + cos(b)*tan(c/2)",
    "asin(a/4)*acos(b/4) + atan(c)", "softplus(a - b*c) + logsumexp(a, 2*b, c)",
    "atan2(a, b) + c*atan2(b*c, 3 + a)", "sinh(a/2) - cosh(b)*c", "sign(a)*b + log10(3 + c)",
    "eigmax(a, b, c, a, b, c) - p", "eigmax(a, b, 1, c, 0, a*b) + eigmax(-a, -b, -1, -c, 0, -a*b)", "eigmax(p, 2, 3, 0, 1, p) - a",
    "max(eigmax(a, b, a, c, p, b), eigmax(eigmax(a, c, 1, b, b, 1), b, c, 0, a, 1))**2",
    "norm(a, b) - p*(1 + 0.4*a/norm(a, b))", "sqrt((a - b)**2 + (b - c)**2 + (c - a)**2) - p", "p**2 - 3",
]  # fmt: skip


def _functions(g: sp.Expr) -> tuple[Any, Any, int, tuple[float, ...]]:
    found = scalar_jets(g, FORCES, (LOAD,))
    space = named(*FUNCTIONS)
    exec(f"{found.level}\n\n{found.piece}", space)  # what a compiler would be given
    return space["level"], space["piece"], found.kinks, found.constants


def _points() -> list[np.ndarray]:
    rng = np.random.default_rng(4)
    return [*rng.uniform(-1.5, 1.5, (12, 3)), *(rng.uniform(-1.5, 1.5, 3).round() for _ in range(8))]


def test_every_word_is_asked_about() -> None:
    assert all(any(f"{word}(" in text for text in TEXTS) for word in WORDS)


@pytest.mark.slow
@pytest.mark.parametrize("text", TEXTS)
@np.errstate(all="ignore")
def test_they_are_those_on_arrays(text: str) -> None:
    g = parse_expression(text, KNOWN)
    level, piece, kinks, numbers = _functions(g)
    jets = formula(g, FORCES, (LOAD,))
    assert kinks == jets.kinks
    compared = 0
    for point in _points():
        v, m, q = np.array([point, np.full(3, np.nan)]), np.full((1, 3, 3), np.nan), np.array([1.75, *numbers])
        choices = np.zeros((1, kinks), dtype=np.int8)
        value = piece(v, 0, q, True, choices, 0, 1, m, 0)
        jet, taken = jets(point[None], [q[:1]])
        if not (np.isfinite(jet.value[0]) and np.isfinite(jet.gradient).all() and np.isfinite(jet.hessian).all()):
            continue
        compared += 1
        assert value == pytest.approx(jet.value[0], rel=1e-13, abs=1e-14) and level(v, 0, q) == pytest.approx(value, rel=1e-14, abs=1e-14)
        assert v[1] == pytest.approx(jet.gradient[0], rel=1e-12, abs=1e-12)
        assert m[0] == pytest.approx(jet.hessian[0], rel=1e-11, abs=1e-11)
        named, _ = jets(point[None], [q[:1]], taken)
        assert piece(v, 0, q, False, choices, 0, 1, m, 0) == pytest.approx(named.value[0], rel=1e-13, abs=1e-14)
    assert compared >= 8


@pytest.mark.parametrize("text", ["abs(a) + pos(b) - neg(c)", "max(a, b**2, c)", "where(a > 0, a*b, b - c)"])
def test_a_piece_is_followed_beyond_its_own_region(text: str) -> None:
    g = parse_expression(text, KNOWN)
    _, piece, kinks, numbers = _functions(g)
    q, m, choices = np.array([1.0, *numbers]), np.empty((1, 3, 3)), np.zeros((1, kinks), dtype=np.int8)
    start, beyond = np.array([1.0, 0.3, -0.2]), np.array([-2.0, -1.3, 1.7])
    v = np.array([start, np.zeros(3)])
    piece(v, 0, q, True, choices, 0, 1, m, 0)
    v[0] = beyond
    value = piece(v, 0, q, False, choices, 0, 1, m, 0)
    named = {"abs(a) + pos(b) - neg(c)": beyond[0] + beyond[1] + beyond[2], "max(a, b**2, c)": beyond[0], "where(a > 0, a*b, b - c)": 2.6}
    assert value == pytest.approx(named[text])


@pytest.mark.parametrize("text", TEXTS)
def test_nothing_is_computed_twice_or_times_one(text: str) -> None:
    found = scalar_jets(parse_expression(text, KNOWN), FORCES, (LOAD,))
    for function in (found.level, found.gradient, found.pair_piece, found.piece):
        said = [line.partition(" = ")[2] for line in function.splitlines() if line.startswith("    t")]
        assert len(set(said)) == len(said) and not any("(1.0) *" in line or "* (1.0)" in line for line in said)


@pytest.mark.parametrize("text", ["norm(a, b) - c", "(abs(a)**3 + abs(b)**3)**(1/3)", "(abs(a)**1.5 + abs(b)**1.5)**(1/1.5)"])
def test_a_norm_is_infinite_where_a_force_is_and_keeps_the_size_of_others(text: str) -> None:
    g = parse_expression(text, KNOWN)
    level, _, _, numbers = _functions(g)
    for size, expected in ((np.inf, np.inf), (1e300, 1e300), (1e-300, 1e-300)):
        assert level(np.array([[-size, 0.0, 0.0]]), 0, np.array([1.0, *numbers])) == pytest.approx(expected, rel=1e-14)


def test_what_has_no_derivatives_as_text_is_refused() -> None:
    with pytest.raises(InputError):
        scalar_jets(parse_expression("(abs(a)**p + abs(b)**p)**(1/p)", {**KNOWN, "p": symbol("p", positive=True)}), FORCES, ())
