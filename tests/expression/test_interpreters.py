"""The interpreters of formulas: NumPy, mpmath and CVXPY mean the same by every word of the vocabulary."""

from __future__ import annotations

import math
from fractions import Fraction
from typing import Any

import cvxpy as cp
import mpmath
import numpy as np
import pytest
import sympy as sp
from hypothesis import given, settings
from hypothesis import strategies as st

from duhem.errors import InputError
from duhem.expression import NODES, Neg, Norm, Pos, Where, cvxpy_, mpmath_, numpy_, symbol
from tests.expression.by_hand import ROWS, x, y
from tests.long import long_but

m = symbol("m", positive=True)
SHARP = (sp.StrictGreaterThan, sp.GreaterThan, sp.StrictLessThan, sp.LessThan)


def decades(low: int = -12, high: int = 12) -> st.SearchStrategy[float]:
    """Numbers of either sign with every decade equally likely, and zero."""
    size = st.builds(lambda k, mantissa: mantissa * 10.0**k, st.integers(low, high), st.floats(1, 10))
    return st.one_of(st.just(0.0), size, size.map(lambda a: -a))


# -- every word ------------------------------------------------------------------------------------------


def test_a_cotangent_that_sympy_makes_of_a_tangent_has_its_value() -> None:
    """tan(x + pi/2) is -cot(x), which is no word of the language; so is what is put in for a number in a formula that was read."""
    turned = sp.tan(x + y).subs(y, sp.pi / 2)
    assert turned.has(sp.cot)
    assert float(numpy_.compiled(turned, (x,))(0.3)) == pytest.approx(math.tan(0.3 + math.pi / 2), rel=1e-14)


WITH_CURVATURE = [kind for kind in NODES if kind not in cvxpy_.NUMBERS_ONLY and kind is not sp.Mul]  # x y has none


@pytest.mark.parametrize("kind", WITH_CURVATURE, ids=lambda kind: kind.__name__)
def test_cvxpy_atoms_have_the_value_of_the_formula_and_a_curvature(kind: type) -> None:
    formula, expected = ROWS[kind]
    atom = cvxpy_.expression(formula, {x: _variable(-3.0), y: _variable(4.0)})
    assert atom.value == pytest.approx(expected, rel=4e-16, abs=0)
    assert atom.is_dcp() and not atom.is_constant()


@pytest.mark.parametrize("kind", sorted(cvxpy_.NUMBERS_ONLY, key=lambda kind: kind.__name__), ids=lambda kind: kind.__name__)
def test_what_has_no_curvature_is_refused_on_variables(kind: type) -> None:
    assert cvxpy_.NUMBERS_ONLY[kind]
    with pytest.raises(InputError, match="no DCP atom"):
        cvxpy_.expression(ROWS[kind][0], {x: cp.Variable(), y: cp.Variable()})


@pytest.mark.slow
@given(decades(), decades())
@settings(max_examples=150, deadline=None)
def test_numpy_agrees_with_mpmath_in_every_decade(a: float, b: float) -> None:
    for kind, (formula, _) in ROWS.items():
        if kind is sp.Add:
            continue  # cancels; the laws below are compared with that in mind
        point = {x: a, y: b}
        fine, plain = mpmath_.evaluate(formula, point, 60), float(numpy_.evaluate(formula, point))
        if math.isnan(plain):
            assert mpmath.isnan(fine), formula
        elif abs(fine) > 1e300 or 0 < abs(fine) < 1e-300:
            assert plain == pytest.approx(float(fine), rel=1e-12), formula
        else:
            assert abs(plain - fine) <= 8 * 2.0**-53 * abs(fine), formula


@given(st.lists(decades(-6, 6), min_size=2, max_size=6))
@settings(max_examples=100, deadline=None)
def test_sums_agree_to_the_size_of_their_terms(values: list[float]) -> None:
    names = [symbol(f"x{i}") for i in range(len(values))]
    point = dict(zip(names, values, strict=True))
    fine = mpmath_.evaluate(sp.Add(*names), point, 60)
    assert abs(float(numpy_.evaluate(sp.Add(*names), point)) - fine) <= len(values) * 2.0**-53 * sum(map(abs, values))


@given(decades(), decades())
@settings(max_examples=100, deadline=None)
def test_comparisons_are_exact_and_kinks_take_the_right_side(a: float, b: float) -> None:
    point = {x: a, y: b}
    assert numpy_.evaluate(Where(x < y, x, y), point) == min(a, b)
    assert numpy_.evaluate(Pos(x) - Neg(x), point) == a
    for kind in SHARP:
        assert numpy_.evaluate(kind(x, y), point) == float(mpmath_.evaluate(kind(x, y), point))


# -- NumPy ------------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("size", [1e-300, 1e-200, 1.0, 1e200, 1e300])
def test_norm_neither_overflows_nor_vanishes(size: float) -> None:
    value = numpy_.evaluate(Norm(x, y, m), {x: 2 * size, y: -3 * size, m: 6 * size})
    assert value == pytest.approx(7 * size, rel=4e-16)


@pytest.mark.parametrize("size", [1e-300, 1e-3, 1e300])
@pytest.mark.parametrize("p", [1.5, 3.0, 1000.0])
def test_norms_spelt_as_powers_neither_overflow_nor_vanish(size: float, p: float) -> None:
    formula = ((sp.Abs(x) / 2) ** m + sp.Abs(y) ** m) ** (1 / m)
    assert numpy_.evaluate(formula, {x: -2 * size, y: size, m: p}) == pytest.approx(2 ** (1 / p) * size, rel=1e-15)
    assert numpy_.evaluate(sp.sqrt(x**2 + y**2), {x: 3 * size, y: 4 * size}) == pytest.approx(5 * size, rel=4e-16)
    odd = numpy_.evaluate(formula, {x: [0.0, math.inf, math.nan], y: [0.0, 1.0, 1.0], m: p})
    np.testing.assert_array_equal(odd, [0.0, math.inf, math.nan])


def test_only_norms_are_taken_for_norms() -> None:
    cube = (x**3 + y**3) ** sp.Rational(1, 3)
    assert numpy_.evaluate(cube, {x: -1.0, y: 2.0}) == pytest.approx(7 ** (1 / 3), rel=4e-16)
    assert np.isnan(numpy_.evaluate(cube, {x: -2.0, y: 1.0}))
    assert numpy_.evaluate(1 / sp.sqrt(x**2 + y**2), {x: 3.0, y: 4.0}) == 0.2
    assert numpy_.evaluate(sp.sqrt(x**2 - y**2), {x: 5.0, y: 4.0}) == 3.0
    assert numpy_.evaluate(sp.sqrt(x**2 + y**4), {x: 3.0, y: 2.0}) == 5.0


def test_branches_not_taken_are_silent_and_harmless() -> None:
    formula = Where(x > 0, sp.log(x) + 1 / x, sp.sqrt(-x) + sp.exp(-x))
    values = numpy_.evaluate(formula, {x: [-800.0, -4.0, 0.0, 1.0]})
    np.testing.assert_allclose(values, [math.inf, 2 + math.exp(4), 1.0, 1.0], rtol=1e-15)


def test_undefined_is_nan_and_nan_spreads() -> None:
    assert np.isnan(numpy_.evaluate(sp.sqrt(x), {x: -1.0}))
    assert np.isnan(numpy_.evaluate(Where(sp.sqrt(x) > 0, y, 2 * y), {x: -1.0, y: 1.0}))
    assert mpmath.isnan(mpmath_.evaluate(Where(sp.sqrt(x) > 0, y, 2 * y), {x: -1.0, y: 1.0}))
    for extreme in (sp.Max, sp.Min):
        assert np.isnan(numpy_.evaluate(extreme(sp.log(x), y), {x: -1.0, y: 1.0}))
        assert mpmath.isnan(mpmath_.evaluate(extreme(sp.log(x), y), {x: -1.0, y: 1.0}))


def test_values_broadcast_and_the_result_is_fresh() -> None:
    grid = np.arange(6.0).reshape(2, 3)
    assert numpy_.evaluate(x + y, {x: grid, y: [1.0, 2.0, 3.0]}).shape == (2, 3)
    assert numpy_.evaluate(sp.Integer(5), {x: grid}).tolist() == [[5.0] * 3] * 2
    same = numpy_.evaluate(x, {x: grid})
    same[0, 0] = 99.0
    assert grid[0, 0] == 0.0
    whole = np.zeros(3)  # an array of its own, no view
    numpy_.evaluate(x, {x: whole})[0] = 99.0
    assert whole[0] == 0.0


def test_compiled_walks_once_and_shares_what_is_equal() -> None:
    size = Norm(x, y)
    program = numpy_.compiled(size**2 + size + sp.exp(size), [x, y])
    assert len(program.recording.steps) == 5  # norm, exponent, square, exp, sum
    for a in (3.0, 0.0):
        assert program(a, 4.0) == numpy_.evaluate(size**2 + size + sp.exp(size), {x: a, y: 4.0})


def test_numpy_faults_name_the_place() -> None:
    with pytest.raises(InputError, match="y has no value"):
        numpy_.evaluate(x + y, {x: 1.0})
    with pytest.raises(InputError, match="no meaning is given to sign"):
        numpy_.evaluate(sp.sign(x), {x: 1.0})
    with pytest.raises(InputError, match="1 values are given for 2"):
        numpy_.compiled(x + y, [x, y])(1.0)
    with pytest.raises(InputError, match="too large"):
        numpy_.evaluate(x + sp.Integer(10) ** 400, {x: 1.0})


def test_rationals_and_constants_are_rounded_once() -> None:
    assert numpy_.evaluate(sp.Rational(1, 3), {}) == 1 / 3
    assert numpy_.evaluate(sp.Integer(10) ** 400 / (sp.Integer(10) ** 399 + 1), {}) == 10.0
    assert numpy_.evaluate(sp.pi + sp.E, {}) == math.pi + math.e


# -- mpmath -----------------------------------------------------------------------------------------------------------


def test_mpmath_gives_the_digits_asked_for_and_leaves_the_global_precision_alone() -> None:
    before = mpmath.mp.dps
    value = mpmath_.evaluate(Norm(x, y), {x: 1, y: Fraction(1, 3)}, dps=50)
    with mpmath.workdps(60):
        error = abs(mpmath.mpf(value) ** 2 - mpmath.mpf(10) / 9)
    assert error < 1e-49
    assert mpmath.mp.dps == before


def test_mpmath_reads_exact_values() -> None:
    for tenth in (sp.Rational(1, 10), Fraction(1, 10), "0.1"):
        assert abs(mpmath_.evaluate(10 * x - 1, {x: tenth}, dps=60)) < 1e-58
    assert abs(mpmath_.evaluate(10 * x - 1, {x: 0.1}, dps=60)) > 1e-18  # a float counts as the binary number it is
    with pytest.raises(InputError, match="y has no value"):
        mpmath_.evaluate(x + y, {x: 1})


# -- CVXPY ------------------------------------------------------------------------------------------------------------


def _variable(value: Any) -> cp.Variable:
    variable = cp.Variable(np.shape(value))
    variable.value = value
    return variable


def _free() -> dict[sp.Symbol, Any]:
    return {x: cp.Variable(name="x"), y: cp.Variable(name="y"), m: cp.Parameter(pos=True, name="m")}


CONVEX = [
    Norm(Pos(x) / m + 3 * Neg(x), Pos(y) / m + Neg(y)) - m,
    sp.sqrt(x**2 + y**2),
    sp.sqrt(x**2 / m**2 + 4 * y**2 + 9),
    (x**4 + y**4) ** sp.Rational(1, 4),
    (sp.Abs(x) ** 3 + sp.Abs(y) ** 3) ** sp.Rational(1, 3),
    ((sp.Abs(x) / m) ** sp.Rational(5, 2) + sp.Abs(y) ** sp.Rational(5, 2) / 2) ** sp.Rational(2, 5),
    sp.Max(sp.Abs(x) / m, sp.Abs(y)),
    Norm(x, y) - sp.Min(m, 2),
    x**2 + y**4 + sp.Abs(x) ** 3,
    x**6 + 2**y + sp.exp(x**2) - sp.log(y),
    Norm(x - m, y),
]


@pytest.mark.parametrize("formula", CONVEX, ids=str)
def test_dcp_accepts(formula: sp.Expr) -> None:
    assert cvxpy_.dcp_fault(formula, _free()) is None


@pytest.mark.slow
@pytest.mark.parametrize("formula", long_but([1, 2, 4, 6, 8, 10], CONVEX), ids=str)
@given(decades(-6, 0), decades(-6, 0).filter(lambda b: b > 0))
@settings(max_examples=10, deadline=None)
def test_atoms_have_the_value_of_the_formula(formula: sp.Expr, a: float, b: float) -> None:
    plain = numpy_.evaluate(formula, {x: a, y: b, m: 0.25})
    close = pytest.approx(plain, rel=1e-13, abs=1e-12)
    assert cvxpy_.expression(formula, {x: _variable(a), y: _variable(b), m: 0.25}).value == close
    assert cvxpy_.expression(formula, {x: _variable([a, -a]), y: _variable([b, b]), m: 0.25}).value[0] == close


@pytest.mark.parametrize(
    ("formula", "part", "remedy"),
    [
        (sp.sqrt(x**2 + y) + Norm(x, y), "sqrt(x**2 + y)", "norm(x, y)"),
        (Norm(sp.Max(x / m, -2 * x), y), "norm(max(-2*x, x/m), y)", "pos(x)"),
        (x * y + x**2, "x*y", "one factor"),
        (x**3, "x**3", "give the base a sign"),
        (1 / x, "1/x", "give the base a sign"),
        (2 * (x**2 - y**2), "2*x**2 - 2*y**2", "one curvature"),
        (sp.Max(1 - Norm(x, y), x), "max(x, 1 - norm(x, y))", "convex"),
        (Where(x > 0, x, y), "x > 0", "fix its argument"),
        (sp.sin(x) + y, "sin(x)", "fix its argument"),
        (x**m, "exponent of x**m", "fix its value"),
        (m - Norm(x, y), "m - norm(x, y)", "concave"),
    ],
    ids=str,
)
def test_dcp_names_the_offending_part_and_a_remedy(formula: sp.Expr, part: str, remedy: str) -> None:
    fault = cvxpy_.dcp_fault(formula, _free())
    assert fault is not None
    assert part in fault and remedy in fault


def test_numbers_may_use_the_whole_vocabulary() -> None:
    formula = Where(m > 1, sp.sin(m), sp.cos(m)) * Norm(x, y)
    assert cvxpy_.dcp_fault(formula, {**_free(), m: 0.5}) is None
    value = cvxpy_.expression(formula, {x: _variable(3.0), y: _variable(4.0), m: 0.5}).value
    assert value == pytest.approx(5 * math.cos(0.5), rel=1e-15)
    with pytest.raises(InputError, match="not real and finite"):
        cvxpy_.expression(sp.log(m) * x, {x: cp.Variable(), m: -1.0})


def test_powers_are_exact_cones() -> None:
    """Support function of a p-norm ball at an exponent that no small fraction approximates: the q-norm (Hölder)."""
    p = math.e
    a, b = cp.Variable(), cp.Variable()
    unit = cvxpy_.expression((sp.Abs(x) ** m + sp.Abs(y) ** m) ** (1 / m), {x: a, y: b, m: p})
    value = cp.Problem(cp.Maximize(3 * a - 2 * b), [unit <= 1]).solve(solver=cp.CLARABEL)
    q = p / (p - 1)
    assert value == pytest.approx((3**q + 2**q) ** (1 / q), rel=1e-7)
    cube = cvxpy_.expression(sp.Abs(x) ** m, {x: a, m: p})
    assert cp.Problem(cp.Maximize(a), [cube <= 10]).solve(solver=cp.CLARABEL) == pytest.approx(10 ** (1 / p), rel=1e-7)


def test_a_batch_is_solved_point_by_point() -> None:
    rng = np.random.default_rng(2007)
    trial = rng.normal(size=(2, 5))
    a, b = cp.Variable(5), cp.Variable(5)
    g = cvxpy_.expression(Norm(x / m, y), {x: a, y: b, m: 1.0})
    cp.Problem(cp.Minimize(cp.sum_squares(a - trial[0]) + cp.sum_squares(b - trial[1])), [g <= 0.5]).solve(solver=cp.CLARABEL)
    radial = trial * np.minimum(1.0, 0.5 / np.hypot(*trial))
    np.testing.assert_allclose([a.value, b.value], radial, atol=1e-6)
