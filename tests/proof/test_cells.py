"""Questions in two variables against sampling, and at margins of zero."""

from __future__ import annotations

import random

import numpy as np
import pytest
import sympy as sp

from duhem.expression import symbol
from duhem.proof.decide import Answer, Budget
from tests.long import long_but
from tests.oracles.prover.decide import Relation, System, by_smt

x, y = symbol("x"), symbol("y")


def _system(goal: sp.Expr, op: str, *given: tuple[sp.Expr, str]) -> System:
    return System(Relation(sp.expand(goal), op), tuple(Relation(sp.expand(p), o) for p, o in given), (), (x, y))


def _ask(goal: sp.Expr, op: str, *given: tuple[sp.Expr, str]) -> Answer:
    return by_smt(_system(goal, op, *given), Budget(10_000_000))


def _poly(rng: random.Random, degree: int) -> sp.Expr:
    terms = [x**i * y**j for i in range(degree + 1) for j in range(degree + 1 - i)]
    return sp.Add(*(sp.Rational(rng.randint(-4, 4), rng.choice([1, 1, 2, 3])) * t for t in rng.sample(terms, min(len(terms), 4))))


def _curve_points(curve: sp.Expr) -> np.ndarray:
    """Points of the curve over many x."""
    rows = sp.Poly(curve, y).all_coeffs()
    columns = [sp.lambdify(x, c, "numpy") for c in rows]
    found = []
    for at in np.linspace(-4, 4, 401) + 1e-4:
        for root in np.roots([float(c(at)) for c in columns]):
            if abs(root.imag) < 1e-9 * (1 + abs(root)):
                found.append((at, root.real))
    return np.array(found).reshape(-1, 2)


def _values(expr: sp.Expr, points: np.ndarray) -> np.ndarray:
    return np.broadcast_to(sp.lambdify((x, y), expr, "numpy")(*points.T), len(points))


def _consistent(answer: Answer, goal: sp.Expr, given: list[tuple[sp.Expr, str]], points: np.ndarray) -> None:
    inside = np.ones(len(points), dtype=bool)
    for p, op in given:
        if op in (">", ">="):
            inside &= _values(p, points) > 1e-7
    if answer.holds is True:
        assert not np.any(inside & (_values(goal, points) < -1e-6 * (1 + np.sum(points**2, axis=1) ** 3)))
    if answer.holds is False:
        assert answer.point is not None
        at = {v: sp.Float(answer.point[v], 40) for v in (x, y)}
        assert goal.subs(at) < 1e-15 * (1 + abs(at[x]) ** 6 + abs(at[y]) ** 6)
        for p, op in given:
            value = p.subs(at)
            assert abs(value) < 1e-12 * (1 + abs(at[x]) ** 6 + abs(at[y]) ** 6) if op == "==" else value > -1e-15


@pytest.mark.slow
@pytest.mark.parametrize("seed", long_but([1, 4, 6, 10, 13, 16, 18, 22, 26, 27, 31, 34, 37, 39], range(40)))
def test_along_a_random_curve(seed: int) -> None:
    rng = random.Random(f"plane/{seed}")
    curve, goal = _poly(rng, rng.choice([2, 3, 4])) - 1, _poly(rng, rng.choice([1, 2, 3]))
    given = [(curve, "=="), *((_poly(rng, rng.choice([1, 2])), rng.choice([">", ">="])) for _ in range(rng.randint(0, 2)))]
    if not curve.has(y) or not curve.has(x):
        curve, given[0] = curve + x * y, (curve + x * y, "==")
    answer = _ask(goal, rng.choice([">=", ">"]), *given)
    _consistent(answer, goal, given, _curve_points(curve))


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(30))
def test_in_a_random_region(seed: int) -> None:
    rng = random.Random(f"region/{seed}")
    goal = _poly(rng, rng.choice([2, 4])) + rng.choice([0, 2, 5]) * (x**4 + y**4 + 1)
    given = [(_poly(rng, rng.choice([1, 2])), ">") for _ in range(rng.randint(0, 2))] + [(x, ">=")] * rng.randint(0, 1)
    answer = _ask(goal, rng.choice([">=", ">"]), *given)
    _consistent(answer, goal, given, np.random.default_rng(seed).uniform(-3, 3, (20000, 2)))


ELLIPSE = (2 * x**2 + y**2 - 1, "==")


@pytest.mark.parametrize(
    ("goal", "op", "given", "holds"),
    [
        ((x - y) ** 2 * (x + 3), ">=", [ELLIPSE], True),  # touches 0 along the curve
        (1 - y, ">=", [ELLIPSE], True),
        (1 - y, ">", [ELLIPSE], False),  # 0 at the top
        (1 + sp.Rational(1, 10**30) - y, ">", [ELLIPSE], True),
        (1 - sp.Rational(1, 10**30) - y, ">=", [ELLIPSE], False),
        (2 * x**2 + y**2 - 1, "==", [ELLIPSE], True),
        (x**2 + y**2 - sp.Rational(1, 2), ">=", [ELLIPSE], True),
        (-1, ">", [(x**2 + y**2 + 1, "==")], True),  # an empty curve
        (-1, ">", [(x**2 + y**2, "==")], False),  # one point
        (-1, ">", [((x - 1) ** 2 + (y - 2) ** 2, "==")], False),
        (y, ">=", [((x**2 + y**2 - 4) * (y - 3), "=="), (x - 1, ">")], False),  # on one of two components
        (x, ">=", [(x * (x**2 + y**2 + 1), "==")], True),  # an upright line
        (x - 1, ">=", [(x * (x**2 + y**2 + 1), "==")], False),
        (x + y, ">=", [(x * y - 1, "=="), (x, ">")], True),
        (x + y - 2, ">=", [(x * y - 1, "=="), (x, ">")], True),
        (x * y, ">=", [(x, ">"), (y, ">")], True),
        (x * y - x - y + 1, ">=", [(x - 1, ">="), (y - 1, ">=")], True),
        (x**2 + y**2 - 2 * x * y, ">=", [], True),
        (x**2 + y**2 - 2 * x * y, ">", [], False),
        (x**4 + y**4 + 1 - 3 * x**2 * y**2, ">=", [], False),
        (x**4 * y**2 + x**2 * y**4 + 1 - 3 * x**2 * y**2, ">=", [], True),  # Motzkin: >= 0 and no sum of squares
        (-1, ">=", [(x - 1, ">="), (2 - 2 * x, ">="), (y, ">")], False),  # a region without an inside, and not empty
        (y, ">=", [(10 * x - 3, ">="), (3 - 10 * x, ">="), (y - x, ">=")], True),
    ],
)
def test_margins_of_zero_and_degenerate_sets(goal: sp.Expr, op: str, given: list[tuple[sp.Expr, str]], holds: bool) -> None:
    assert _ask(sp.sympify(goal), op, *given).holds is holds
