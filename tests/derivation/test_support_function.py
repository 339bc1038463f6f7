"""The dissipation potential in closed form, against brute force, against formulas written by hand, and against itself."""

from __future__ import annotations

import subprocess
import sys
from collections.abc import Sequence
from dataclasses import replace
from functools import cache
from random import Random

import mpmath
import numpy as np
import pytest
import sympy as sp

from duhem.derivation.gauge import Holder, Polytope, Side
from duhem.derivation.support_function import SupportFunction, biconjugate, defects, rate_symbols, sample_values, support_function
from duhem.expression import Neg, Norm, Pos, mpmath_, numpy_
from duhem.law.catalogue import load
from duhem.law.domain import POSITIVE, REAL, Domain
from duhem.law.formula_law import Criterion
from tests.long import long_at, long_but, mostly_long

CLOSED = (
    "antoni2007", "antoni2007-1d", "box", "capped", "cohesive", "coulomb", "orthotropic", "polygon", "radial-flow", "regularised",
    "rotated-flow", "shifted-ellipse", "superellipse", "tresca", "von-mises",
)  # fmt: skip
SHORT = (  # one of each kind
    "box", "coulomb", "orthotropic", "radial-flow", "squares", "form off centre", "half ellipses", "off-centre diamond", "p = 4",
    "interval off centre", "unknown sign",
)  # fmt: skip
OPEN = ("drucker1949", "hosford", "limacon", "lobes", "matchstick", "quartic")


def made(g: str, forces: Sequence[str] = ("sigma_a", "sigma_b"), pressure: str | None = "sigma_n", **domains: Domain) -> Criterion:
    return Criterion("made", g, {"mu": POSITIVE, "nu": POSITIVE} | domains, tuple(forces), pressure)


MADE = {
    "squares": made("(sigma_a/mu)**2 + (sigma_b/nu)**2 - sigma_n**2"),
    "rotated ellipse": made("norm((sigma_a + sigma_b)/mu, (sigma_a - sigma_b)/nu) - abs(sigma_n)"),
    "quadratic form": made("sqrt(sigma_a**2 + 2*k*sigma_a*sigma_b + sigma_b**2) - mu*abs(sigma_n)", k=Domain.between("-0.9", "0.9")),
    "form off centre": made("sigma_a**2 + sigma_a*sigma_b + sigma_b**2 + sigma_a*sigma_n - mu*sigma_n**2"),
    "octagon": made("max(abs(sigma_a), abs(sigma_b), (abs(sigma_a) + abs(sigma_b))/sqrt(2)) - mu*abs(sigma_n)"),
    "diamond": made("abs(sigma_a)/mu + pos(sigma_b)/nu + neg(sigma_b)/mu - abs(sigma_n)"),
    "triangle": made("max(sigma_a, sigma_b, -sigma_a - sigma_b) - mu*abs(sigma_n)"),
    "box by sides": made("max(sigma_a - mu*abs(sigma_n), -sigma_a - nu*abs(sigma_n), abs(sigma_b) - mu*abs(sigma_n))"),
    "turned box": made("max(abs(sigma_a + sigma_b)/mu, abs(sigma_a - sigma_b)/nu) - abs(sigma_n)"),
    "half ellipses": made("norm(sigma_a/where(sigma_a >= 0, mu, nu), sigma_b/mu) + sigma_n"),
    "pos and neg squared": made("pos(sigma_a)**2/mu**2 + neg(sigma_a)**2/nu**2 + sigma_b**2/mu**2 - sigma_n**2"),
    "off-centre diamond": made("pos(sigma_a - mu) + 2*neg(sigma_a - mu) + abs(sigma_b) - nu*abs(sigma_n)"),
    "p = 3/2": made("abs(sigma_a)**(3/2) + abs(sigma_b)**(3/2) - (mu*abs(sigma_n))**(3/2)"),
    "p = 4": made("(sigma_a/mu)**4 + (sigma_b/nu)**4 - sigma_n**4"),
    "interval off centre": made("x**2 - x - mu", ("x",), None),
    "unknown sign": made("norm(sigma_a + k*sigma_b, sigma_a - k*sigma_b) - mu*abs(sigma_n)", k=REAL),
}


@cache
def closed(name: str) -> tuple[Criterion, SupportFunction]:
    law = MADE.get(name) or load(name)
    found = support_function(law)
    assert found is not None
    return law, found


def values_of(law: Criterion, found: SupportFunction, seed: int) -> dict[sp.Symbol, sp.Rational]:
    return next(sample_values(law, found.requires, Random(seed), 1))


def boundary(law: Criterion, found: SupportFunction, values: dict[sp.Symbol, sp.Rational], count: int = 4000) -> np.ndarray:
    """Points of K on rays from a point inside it, by bisection of g in double precision; (points, forces)."""
    forces = law.force_symbols()
    fixed = {s: float(v) for s, v in values.items()}
    centre = np.array([float(c.subs(values)) for c in found.centre])
    turns = np.linspace(0, 2 * np.pi, count, endpoint=False)
    if len(forces) == 1:
        rays: np.ndarray = np.array([[1.0], [-1.0]])
    else:
        plane = np.eye(2) if len(forces) == 2 else np.array([[1, -1, 0], [1, 1, -2]]) / np.sqrt([[2], [6]])  # the deviatoric plane
        rays = np.outer(np.cos(turns), plane[0]) + np.outer(np.sin(turns), plane[1])
    low, high = np.zeros(len(rays)), np.full(len(rays), 1e6)

    def g(t: np.ndarray) -> np.ndarray:
        points = centre + t[:, None] * rays
        return numpy_.evaluate(law.g, {**dict(zip(forces, points.T, strict=True)), **fixed})

    for _ in range(64):
        middle = (low + high) / 2
        inside = g(middle) <= 0
        low, high = np.where(inside, middle, low), np.where(inside, high, middle)
    return np.asarray(centre + low[:, None] * rays)


def directions(found: SupportFunction, seed: int) -> np.ndarray:
    """Rates on the domain of the potential."""
    d = np.random.default_rng(seed).normal(size=(40, len(found.rates)))
    return d - d.mean(axis=1, keepdims=True) if len(found.rates) == 3 else d


@pytest.mark.slow
@pytest.mark.parametrize("name", mostly_long([*CLOSED, *MADE], *SHORT))
def test_potential_is_the_greatest_product_over_the_boundary(name: str) -> None:
    law, found = closed(name)
    values = values_of(law, found, 1)
    points, d = boundary(law, found, values), directions(found, 1)
    fixed = {s: float(v) for s, v in values.items()}
    claimed = numpy_.evaluate(found.potential, {**dict(zip(found.rates, d.T, strict=True)), **fixed})
    brute = (d @ points.T).max(axis=1)
    reach = np.abs(points).max() * np.linalg.norm(d, axis=1)
    assert np.all(brute <= claimed + 1e-9 * reach)
    # Two neighbouring rays are 2 pi/4000 apart: next to a corner that much of the support value may be missed.
    assert np.all(brute >= claimed - 4e-3 * reach)


def by_hand() -> dict[str, sp.Expr]:
    d_a, d_b, d_t, d1, d2, d3 = (sp.Symbol(n, real=True) for n in ("d_a", "d_b", "d_t", "d_s1", "d_s2", "d_s3"))

    def par(law: str, name: str) -> sp.Symbol:
        return load(law).symbols()[name]

    n = load("coulomb").symbols()["sigma_n"]
    a1, a2, b1, b2 = (par("antoni2007", f"mu_{side}") for side in ("a_plus", "a_minus", "b_plus", "b_minus"))
    p = par("superellipse", "p")
    q = p / (p - 1)
    mu, nu = par("orthotropic", "mu_a"), par("orthotropic", "mu_b")
    y, shift, c, coh = par("tresca", "yield_stress"), par("shifted-ellipse", "shift"), par("regularised", "c"), par("cohesive", "cohesion")
    friction = par("coulomb", "mu")
    return {
        "antoni2007": -n * sp.sqrt((a1 * Pos(d_a) + a2 * Neg(d_a)) ** 2 + (b1 * Pos(d_b) + b2 * Neg(d_b)) ** 2),
        "antoni2007-1d": -n * (par("antoni2007-1d", "mu_plus") * Pos(d_t) + par("antoni2007-1d", "mu_minus") * Neg(d_t)),
        "box": -n * (mu * sp.Abs(d_a) + nu * sp.Abs(d_b)),
        "coulomb": -n * friction * sp.sqrt(d_a**2 + d_b**2),
        "cohesive": (coh - friction * n) * sp.sqrt(d_a**2 + d_b**2),
        "capped": sp.Min(-friction * n, par("capped", "tau_max")) * sp.sqrt(d_a**2 + d_b**2),
        "orthotropic": -n * sp.sqrt((mu * d_a) ** 2 + (nu * d_b) ** 2),
        "regularised": sp.sqrt((c - friction * n) ** 2 - c**2) * sp.sqrt(d_a**2 + d_b**2),
        "shifted-ellipse": -n * (shift * d_a + sp.sqrt((mu * d_a) ** 2 + (nu * d_b) ** 2)),
        "superellipse": -n * ((mu * sp.Abs(d_a)) ** q + (nu * sp.Abs(d_b)) ** q) ** (1 / q),
        "tresca": y * sp.Max(sp.Abs(d1), sp.Abs(d2), sp.Abs(d3)),
        "von-mises": y * sp.sqrt(sp.Rational(2, 3) * (d1**2 + d2**2 + d3**2)),
    }


@pytest.mark.slow
@pytest.mark.parametrize("name", by_hand())
def test_potential_is_the_published_formula(name: str) -> None:
    expected = by_hand()[name]
    law, found = closed(name)
    for seed in range(4):
        values = values_of(law, found, seed)
        for d in directions(found, seed)[:8]:
            exact = [sp.Rational(round(x * 1000), 1000) for x in d]
            if len(exact) == 3:
                exact[2] = -exact[0] - exact[1]
            point = {**values, **dict(zip(found.rates, exact, strict=True))}
            gap = mpmath_.evaluate(found.potential, point, 40) - mpmath_.evaluate(expected, point, 40)
            assert abs(gap) < 1e-30


@pytest.mark.slow
@pytest.mark.parametrize("name", mostly_long([*CLOSED, *MADE], *SHORT))
def test_maximiser_lies_on_the_boundary_and_attains(name: str) -> None:
    law, found = closed(name)
    assert found.maximiser is not None
    values = values_of(law, found, 5)
    for d in directions(found, 5)[:10]:
        exact = [sp.Rational(round(x * 1000), 1000) for x in d]
        if len(exact) == 3:
            exact[2] = -exact[0] - exact[1]
        point = {**values, **dict(zip(found.rates, exact, strict=True))}
        stress = [mpmath_.evaluate(c, point, 50) for c in found.maximiser]
        attained = mpmath.fsum(s * mpmath.mpf(int(x.p)) / int(x.q) for s, x in zip(stress, exact, strict=True))
        assert abs(attained - mpmath_.evaluate(found.potential, point, 50)) < 1e-13  # the sum is in double precision
        assert abs(mpmath_.evaluate(law.g, {**values, **dict(zip(law.force_symbols(), stress, strict=True))}, 50)) < 1e-35


@pytest.mark.parametrize("name", OPEN)
def test_no_closed_form_is_said_so(name: str) -> None:
    assert support_function(load(name)) is None


@pytest.mark.parametrize(
    "g",
    [
        "min(norm(sigma_a, sigma_b), abs(sigma_a)) - mu*abs(sigma_n)",  # not convex
        "sqrt(abs(sigma_a)) + sqrt(abs(sigma_b)) - sqrt(mu*abs(sigma_n))",  # p = 1/2: not convex
        "sigma_a - mu*abs(sigma_n)",  # half-plane
        "max(sigma_a, sigma_b) - mu*abs(sigma_n)",  # unbounded
        "pos(sigma_a) + abs(sigma_b) - mu*abs(sigma_n)",  # unbounded
        "sigma_a**2 - sigma_b**2 - mu*sigma_n**2",  # hyperbola
        "(abs(sigma_a) - 3)**2 - 1",  # an even power is not increasing on what changes sign
        "norm(sigma_a, sigma_b) + norm(sigma_a, 2*sigma_b) - mu*abs(sigma_n)",  # a sum whose polar is no rule of ours
        "norm(sigma_a, sigma_b) + mu*abs(sigma_n)",  # empty
    ],
)
def test_what_the_rules_do_not_cover_is_none(g: str) -> None:
    assert support_function(made(g)) is None


@pytest.mark.slow
def test_fixed_parameters_open_special_cases() -> None:
    assert support_function(load("quartic"), {"c": 0}) is not None
    two, mises = support_function(load("hosford"), {"m": 2}), support_function(load("von-mises"))
    assert two is not None and mises is not None and two.potential == mises.potential
    assert support_function(load("superellipse"), {"p": 4, "mu_a": "0.2"}) is not None


def test_a_force_g_ignores_must_not_slip() -> None:
    found = support_function(made("abs(sigma_a) - mu*abs(sigma_n)"))
    assert found is not None and found.domain == (found.rates[1],)
    assert not found.potential.has(found.rates[1])


@pytest.mark.slow
def test_conditions_are_stated() -> None:
    found = support_function(MADE["quadratic form"])
    k = MADE["quadratic form"].symbols()["k"]
    assert found is not None and any(sp.expand(r - (1 - k**2)) == 0 for r in found.requires)
    plain = support_function(load("antoni2007"))
    assert plain is not None and plain.requires == ()


@pytest.mark.slow
def test_steps_name_their_theorems() -> None:
    for name in CLOSED:
        found = closed(name)[1]
        assert len(found.steps) >= 3
        assert all("Rockafellar 1970" in step for step in found.steps)


def test_rates_are_named_after_forces_and_never_clash() -> None:
    assert [r.name for r in rate_symbols(load("tresca"))] == ["d_s1", "d_s2", "d_s3"]
    assert [r.name for r in rate_symbols(made("norm(sigma_a, sigma_b) - d_a*mu", d_a=POSITIVE))] == ["dd_a", "d_b"]


# Mutants: the internal check is what stands between a wrong rule and a wrong answer.


@pytest.mark.slow
@pytest.mark.parametrize("factor", ["1 + 10**-9", "1 - 10**-9"])
@pytest.mark.parametrize("name", long_but([1, 3], ["antoni2007", "box", "superellipse", "tresca", "shifted-ellipse"]))
def test_a_potential_slightly_off_is_caught(name: str, factor: str) -> None:
    law, found = closed(name)
    assert not defects(law, found)
    off = 1 + sp.Rational(1, 10**9) * (1 if "+" in factor else -1)
    assert defects(law, replace(found, potential=found.potential * off))


@pytest.mark.slow
def test_swapped_coefficients_and_false_maximisers_are_caught() -> None:
    law = load("antoni2007")
    found = support_function(law)
    assert found is not None and found.maximiser is not None
    s = law.symbols()
    swapped = {s["mu_a_plus"]: s["mu_a_minus"], s["mu_a_minus"]: s["mu_a_plus"]}
    consistent = replace(
        found, potential=found.potential.xreplace(swapped), maximiser=tuple(m.xreplace(swapped) for m in found.maximiser)
    )  # potential and maximiser agree with one another, and not with K
    assert defects(law, consistent)
    assert defects(law, replace(found, maximiser=tuple(m / 2 for m in found.maximiser)))
    assert defects(law, replace(found, maximiser=tuple(2 * m for m in found.maximiser)))


def test_without_a_maximiser_a_potential_too_small_is_still_caught() -> None:
    law = load("coulomb")
    found = support_function(law)
    assert found is not None
    assert not defects(law, replace(found, maximiser=None))
    assert defects(law, replace(found, maximiser=None, potential=found.potential * sp.Rational(9, 10)))


def test_a_claim_that_is_undefined_or_infinite_is_no_claim() -> None:
    law = load("coulomb")
    found = support_function(law)
    assert found is not None and found.maximiser is not None
    d = found.rates[0]
    for wrong in (sp.log(-1 - d**2), 1 / (Pos(d) * Neg(d))):  # nan, and 1/0
        for claim in (
            {"potential": found.potential + wrong},
            {"maximiser": (wrong, *found.maximiser[1:])},
            {"potential": wrong, "maximiser": None},
        ):
            (said,) = defects(law, replace(found, **claim))
            assert "cannot be evaluated" in said


@pytest.mark.slow
@pytest.mark.parametrize(
    ("owner", "attribute", "wrong", "name"),
    long_at(
        [0],
        [
            (Side, "polar", lambda self, c: self.up * Pos(c[self.row]) + self.down * Neg(c[self.row]), "antoni2007"),
            (Holder, "polar", lambda self, c: Norm(*c.values()), "box"),
            (Polytope, "polar", lambda self, d: sp.Max(*self._products(d)[1:]), "tresca"),
        ],
    ),
)
def test_a_wrong_polar_rule_gives_no_answer(owner: type, attribute: str, wrong: object, name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    assert support_function(load(name)) is not None
    monkeypatch.setattr(owner, attribute, wrong)
    assert support_function(load(name)) is None


@pytest.mark.slow
@pytest.mark.parametrize("name", mostly_long([*CLOSED, *MADE], *SHORT))
def test_polar_of_the_polar_is_the_gauge(name: str) -> None:
    law, found = closed(name)
    back = biconjugate(law, found)
    assert back is not None and back.agrees
    values = values_of(law, found, 9)
    random = Random(9)
    for _ in range(20):
        x = {f: sp.Rational(random.randint(-50, 50), 7) for f in law.force_symbols()}
        outside = mpmath_.evaluate(back.gauge, {**values, **x}, 40) - 1
        g = mpmath_.evaluate(law.g, {**values, **x}, 40)
        assert (outside > 0) == (g > 0)


def test_a_false_potential_has_another_biconjugate() -> None:
    law = load("orthotropic")
    found = support_function(law)
    assert found is not None
    s = law.symbols()
    other = biconjugate(law, replace(found, potential=found.potential.subs({s["mu_a"]: 2 * s["mu_a"]})))
    assert other is not None and not other.agrees


@pytest.mark.slow
def test_import_is_light() -> None:
    heavy = "{'numpy', 'cvxpy', 'z3', 'flint', 'clarabel', 'hypothesis', 'matplotlib'}"
    first = "import sys, sympy; before = set(sys.modules)"  # SymPy itself takes flint where it finds it
    code = f"{first}; import duhem.derivation.support_function; print(sorted({heavy} & set(sys.modules) - before))"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "[]"
