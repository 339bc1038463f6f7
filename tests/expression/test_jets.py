"""Jets against SymPy's derivatives, and against themselves without the second ones."""

from __future__ import annotations

import numpy as np
import pytest
import sympy as sp

import duhem
from duhem.expression.jets import formula
from duhem.expression.vocabulary import Atan2, EigMax, Neg, Norm, Pos, Where
from tests.oracles.optimality import CONVEX, R, increment


@pytest.mark.slow
def test_jets_are_the_derivatives():
    a, b, c = sp.symbols("a b c", real=True)
    for text in ("exp(a*b) + log(2 + c**2)*sin(a)", "tanh(a - b)*atan(c) + cos(b)**3/(3 + a**2)", "(a**6 + b**6 + c**6)**(1/6)"):
        expr = sp.parse_expr(text.replace("1/6", "Rational(1, 6)"), {"a": a, "b": b, "c": c})
        x = np.random.default_rng(0).standard_normal((5, 3))
        jet, _ = formula(expr, (a, b, c), ())(x, ())
        for i, point in enumerate(x):
            at = dict(zip((a, b, c), point, strict=True))
            gradient = [float(expr.diff(s).subs(at)) for s in (a, b, c)]
            hessian = [[float(expr.diff(s, t).subs(at)) for s in (a, b, c)] for t in (a, b, c)]
            np.testing.assert_allclose(jet.gradient[i], gradient, rtol=1e-11, atol=1e-13)
            np.testing.assert_allclose(jet.hessian[i], hessian, rtol=1e-11, atol=1e-12)


@pytest.mark.parametrize(("law", "values"), CONVEX, ids=lambda x: x if isinstance(x, str) else "")
def test_first_derivatives_alone_are_the_same(law, values):
    d = len(duhem.load(law).forces)
    question = increment(law, np.random.default_rng(1).standard_normal((40, d)), -1.0, **values)
    names = question.law.force_symbols()
    others = [question.law.symbols()[question.law.pressure]] if question.law.pressure else []
    compiled = formula(question.g, names, others)
    given = [question.pressure] if others else []
    both, pieces = compiled(question.trial, given)
    first, same = compiled(question.trial, given, second=False)
    np.testing.assert_array_equal(first.gradient, both.gradient)
    np.testing.assert_array_equal(first.value, both.value)
    np.testing.assert_array_equal(pieces, same)
    assert first.hessian is None and both.hessian is not None


@pytest.mark.parametrize(
    "text",
    [
        "Max(a, 2*b, 1)", "Min(a*b, c, -a)", "Where(a > b, a*c, 3)", "Where(a > 0, 5, Where(b > c, b**3, c))", "Pos(a)*Neg(b) + Abs(c)",
        "Norm(Pos(a) - Neg(a), b) + c*exp(a)", "Atan2(a, 2 + b**2)*c", "EigMax(a, b, 1, c, 0, a*b)", "2*a", "7", "a + a*b + b",
    ],
)  # fmt: skip
def test_columns_of_first_derivatives_are_those_of_the_second(text):
    names = sp.symbols("a b c", real=True)
    words = {word.__name__: word for word in (Where, Pos, Neg, Norm, Atan2, EigMax)}
    compiled = formula(sp.parse_expr(text, {**words, **dict(zip("abc", names, strict=True))}), names, ())
    points = np.random.default_rng(3).standard_normal((60, 3))
    both, pieces = compiled(points, ())
    first, same = compiled(points, (), second=False)
    np.testing.assert_array_equal(first.gradient, both.gradient)
    np.testing.assert_array_equal(pieces, same)
    step = 1e-6
    for i, way in enumerate(np.eye(3)):
        rise = compiled(points + step * way, (), second=False)[0].value - compiled(points - step * way, (), second=False)[0].value
        np.testing.assert_allclose(first.gradient[:, i], rise / (2 * step), rtol=1e-7, atol=1e-7)


def test_high_exponents_have_finite_slopes():
    question = increment("hosford", [[1.0, 1e-4, -1.0], [1.0, 1.0, -1.0]], m=R(100), yield_stress=R(1, 1000))
    jet, _ = formula(question.g, question.law.force_symbols(), ())(question.trial, ())
    assert np.isfinite(jet.gradient).all() and np.isfinite(jet.hessian).all()
    np.testing.assert_allclose(jet.gradient.sum(axis=1), 0, atol=1e-15)  # no pressure part
