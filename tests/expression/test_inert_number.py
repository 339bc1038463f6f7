"""Exponents with long denominators: the numbers of a fit or of a random test, on which SymPy would write out huge integers."""

import numpy as np
import pytest
import sympy as sp

from duhem import POSITIVE, Criterion, Domain, Verdict, load, project, verify
from duhem.expression import mpmath_
from duhem.expression.number import InertNumber, inert_exponent
from duhem.expression.parse import parse_expression
from tests.long import long_at

P = "3.00123456789"
LAW = {"mu_a": "0.30123457", "mu_b": "0.2012347919", "p": P}


def test_a_held_number_is_one_object_with_the_value_of_its_rational() -> None:
    value = sp.Rational(300123, 100000)
    inert = inert_exponent(value)
    assert isinstance(inert, InertNumber) and inert is InertNumber(value) and inert != InertNumber(value + 1)
    assert inert.is_positive and inert > 3 and inert < 4 and sp.Rational(5, 2) == inert_exponent(sp.Rational(5, 2))
    power = sp.Rational(3, 10) ** inert
    assert power.args == (sp.Rational(3, 10), inert)
    assert abs(mpmath_.evaluate(power, {}, 40) - mpmath_.evaluate(sp.exp(value * sp.log(sp.Rational(3, 10))), {}, 40)) < 1e-39


@pytest.mark.slow
@pytest.mark.parametrize("p", long_at([0], [P, "2.99", "1.0700001"]))
def test_a_law_with_such_an_exponent_is_verified(p: str) -> None:
    done = verify("superellipse", LAW | {"p": p})
    assert {result.verdict for result in done.results} == {Verdict.PROVED}


def test_a_false_law_with_such_an_exponent_is_refuted() -> None:
    law = Criterion(
        "concave", "(abs(sigma_a)/0.3012345)**p + (abs(sigma_b)/mu)**p - abs(sigma_n)**p",
        parameters={"p": Domain.between("0.5", "4"), "mu": POSITIVE},
    )  # fmt: skip
    found = verify(law, {"p": "0.70123456789"}, claims=["convexity"])["convexity"]
    assert found.verdict is Verdict.REFUTED and found.witness is not None
    assert verify(law, {"p": "1.70123456789"}, claims=["convexity"])["convexity"].verdict is Verdict.PROVED


def test_written_into_the_formula() -> None:
    x = sp.Symbol("x", real=True)
    inert = parse_expression("(abs(x)/0.3012345)**3.00123456789", {"x": x}).atoms(InertNumber)
    assert inert == {InertNumber(sp.Rational(300123456789, 10**11))}


@pytest.mark.slow
def test_projected_by_two_methods() -> None:
    trial, numbers = [[0.3, 0.4], [-0.5, 0.01]], {name: float(value) for name, value in LAW.items()}
    newton, cvxpy = (project(load("superellipse"), trial, -1.0, [1.0, 2.0], numbers, method=m) for m in ("newton", "cvxpy"))
    assert (newton.status == 1).all() and (cvxpy.status == 1).all()
    assert np.abs(newton.stress - cvxpy.stress).max() < 1e-9
    a, b = (np.abs(newton.stress[:, i]) / numbers[name] for i, name in enumerate(("mu_a", "mu_b")))
    assert np.abs(a ** numbers["p"] + b ** numbers["p"] - 1.0).max() < 1e-13
