"""The formula of pure numbers equals the law's own at any load and size."""

from __future__ import annotations

import math

import numpy as np
import pytest
import sympy as sp

import duhem
from duhem.expression.numpy_ import evaluate
from duhem.law.formula_law import Criterion
from duhem.projection.scaled_formula import of_pressure_alone, scaled
from tests.oracles.laws_by_hand import LAWS, increment

SCALED = [(law.name, law.parameters) for law in LAWS] + [
    ("antoni2007-1d", {"mu_plus": 0.2, "mu_minus": 0.1}),
    ("limacon", {"mu": 0.3, "e": 0.4}),
    ("drucker1949", {"k": 0.7, "c": 1.5}),
    ("lobes", {"mu": 0.3, "e": 0.05}),
    ("matchstick", {"mu_a": 0.3, "mu_b": 0.25}),
]


@pytest.mark.parametrize("name, parameters", SCALED, ids=[name for name, _ in SCALED])
def test_scaling_keeps_the_formula(name: str, parameters: dict[str, float]) -> None:
    law = duhem.load(name)
    asked = increment(law, np.ones((1, len(law.forces))), 0.0, parameters=parameters)
    pressure = law.symbols()[law.pressure] if law.pressure else None
    formula = scaled(asked.g, law.force_symbols(), pressure)
    random = np.random.default_rng(6)
    load, size = -random.uniform(0.1, 2, 20), 2.0 ** random.integers(-20, 20, 20)
    s = dict(zip(law.force_symbols(), random.normal(size=(len(law.forces), 20)), strict=True))
    raw = evaluate(asked.g, {f: v * size for f, v in s.items()} | ({} if pressure is None else {pressure: load}))
    h = evaluate(formula.expr, s | formula.values(load, size))
    terms = 1.0 + sum(np.abs(q) for q in formula.values(load, size).values())
    np.testing.assert_allclose(raw / size**formula.degree, h, rtol=1e-12, atol=1e-12 * np.max(terms))
    assert formula.degree >= 1  # every one of these laws has a degree


def test_an_angle_is_of_points_of_one_unit() -> None:
    """What is added to a coordinate is a datum with the unit of the forces."""
    law = Criterion("turned", "norm(sigma_a, sigma_b)*(2 + cos(atan2(sigma_b, sigma_a + 0.3*sigma_n)/2)) + sigma_n")
    n = law.symbols()["sigma_n"]
    formula = scaled(law.g, law.force_symbols(), n)
    assert formula.degree == 1
    a, b = law.force_symbols()
    size, load, s = np.array([4.0, 0.5]), np.array([-2.0, -3.0]), {a: np.array([0.25, -1.0]), b: np.array([-0.5, 2.0])}
    raw = evaluate(law.g, {f: v * size for f, v in s.items()} | {n: load})
    np.testing.assert_allclose(raw / size, evaluate(formula.expr, s | formula.values(load, size)), rtol=1e-14)


def test_a_formula_without_degree_keeps_its_unit_as_a_datum() -> None:
    law = Criterion("exponential", "exp(sigma_a/0.3) + abs(sigma_b) + sigma_n")
    n = law.symbols()["sigma_n"]
    formula = scaled(law.g, law.force_symbols(), n)
    a, b = law.force_symbols()
    h = evaluate(formula.expr, {a: np.array([0.25]), b: np.array([-0.5])} | formula.values(np.array([-2.0]), np.array([4.0])))
    np.testing.assert_allclose(h, math.exp(1 / 0.3) + 2.0 - 2.0, rtol=1e-14)
    assert formula.degree == 0


POWERS = [
    "abs(sigma_a)**3 + abs(sigma_b)**3 - abs(sigma_n)**3",
    "abs(sigma_a)**5 + abs(sigma_b)**5 - 7*abs(sigma_n)**5",
    "abs(sigma_a)**3 + abs(sigma_b)**3 + sigma_n**3",
    "pos(sigma_a)**3 + pos(sigma_b)**3 + 2*sigma_n**3",
    "sigma_a**2*abs(sigma_a) + sigma_b**2*abs(sigma_b) + sigma_n**5/sigma_n**2",
    "norm(sigma_a, sigma_b)**3 + sigma_n**3",
    "norm(sigma_a, sigma_b)**5 + pi*sigma_n**5/3",
    "norm(sigma_a, sigma_b)**4 - 2*sigma_n**4",
    "norm(sigma_a, sigma_b)**(5/2) - 2*abs(sigma_n)**(5/2)",
    "(abs(sigma_a)**3 + abs(sigma_b)**3)**(1/3) + sigma_n",
    "(abs(sigma_a)**3 + abs(sigma_b)**3)**(2/3) - sigma_n**2",
    "abs(sigma_a)**3 + abs(sigma_b)**3 + sigma_n**3 - (2 - 3*sigma_n)**3",
    "abs(sigma_a)**3 + abs(sigma_b)**3 + sigma_n*(2 - 3*sigma_n)**2",
    "abs(sigma_a)**3 + abs(sigma_b)**3 + sigma_n**3/(1 - sigma_n)",
    "abs(sigma_a)**3 - abs(sigma_n)*sigma_a**2 + abs(sigma_b)**3 + 2*sigma_n**3",
    "abs(sigma_a)**3 + abs(sigma_b)**3 + sigma_n**3*exp(sigma_n)",
]


@pytest.mark.parametrize("g", POWERS)
def test_odd_powers_of_the_load_keep_their_sign(g: str) -> None:
    law = Criterion("powers", g)
    n, (a, b) = law.symbols()["sigma_n"], law.force_symbols()
    formula = scaled(law.g, (a, b), n)
    random = np.random.default_rng(3)
    load, size = -random.uniform(0.1, 2, 8), 2.0 ** random.integers(-9, 9, 8)
    s = {a: random.normal(size=8), b: random.normal(size=8)}
    raw = evaluate(law.g, {f: v * size for f, v in s.items()} | {n: load})
    h = evaluate(formula.expr, s | formula.values(load, size))
    reach = 1.0 + sum((np.abs(v) ** formula.degree for v in (*s.values(), *formula.values(load, size).values())), np.zeros(8))
    np.testing.assert_allclose(raw / size**formula.degree, h, rtol=1e-12, atol=1e-12 * np.max(reach))
    assert formula.degree >= 1


@pytest.mark.slow
@pytest.mark.parametrize("load", [1e-150, 1.0, 1e150])
@pytest.mark.parametrize(
    "g, stress",
    [
        ("abs(sigma_a)**3 + abs(sigma_b)**3 - abs(sigma_n)**3", 0.5 ** (1 / 3)),
        ("pos(sigma_a)**3 + pos(sigma_b)**3 + sigma_n**3", 0.5 ** (1 / 3)),
        ("abs(sigma_a)**5 + abs(sigma_b)**5 + sigma_n**5", 0.5 ** (1 / 5)),
        ("norm(sigma_a, sigma_b)**3 + sigma_n**3", 0.5**0.5),
        ("(abs(sigma_a)**3 + abs(sigma_b)**3)**(1/3) + sigma_n", 0.5 ** (1 / 3)),
    ],
)
def test_a_load_in_odd_powers_is_projected_onto(g: str, stress: float, load: float) -> None:
    found = duhem.project(Criterion("powers", g), [3.0 * load, 3.0 * load], -load)
    assert found.status[0] == duhem.Status.SLIP
    np.testing.assert_allclose(found.stress[0] / load, [stress, stress], rtol=1e-9)


@pytest.mark.parametrize("count", [0, 1, 3])
def test_a_datum_that_cancels_has_a_value_for_any_number_of_pressures(count: int) -> None:
    """Also where the pressure has been put in, so that the datum is one number."""
    p = sp.Symbol("p", real=True)
    for datum in (1 - sp.cos(sp.Rational(1, 10**9)), 1 - sp.cos(p)):
        found = of_pressure_alone(datum, {p: np.full(count, 1e-9)}).value
        np.testing.assert_allclose(np.broadcast_to(found, (count,)), np.full(count, 5e-19), rtol=1e-15)
