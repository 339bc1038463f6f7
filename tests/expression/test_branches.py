"""Branches of a formula with choices: each choice belongs to one side, and who owns the equality is kept in mind."""

import sympy as sp

from duhem.expression import Where
from duhem.expression.branches import branches
from duhem.expression.number import InertNumber

X = sp.Symbol("x", real=True)
OPEN, CLOSED = Where(X > 0, 1, -1), Where(X >= 0, 1, -1)


def _regions(*exprs):
    return {(b.signs.get(X), tuple(b.expr)) for b in branches(sp.Tuple(*exprs))}


def test_one_choice_made_twice_is_made_alike():
    assert _regions(OPEN, 2 * OPEN) == {(1, (1, 2)), (-1, (-1, -2))}
    assert _regions(CLOSED, 2 * CLOSED) == {(1, (1, 2)), (-1, (-1, -2))}


def test_two_choices_may_differ_where_both_sides_own_the_equality():
    assert _regions(OPEN, CLOSED) == {(1, (1, 1)), (-1, (-1, -1)), (0, (-1, 1))}


def test_a_side_without_the_equality_meets_no_branch_that_is_there_alone():
    at_zero = Where(X >= 0, Where(X <= 0, 5, 0), 0)  # 5 at x = 0 alone
    assert (0, (5, -1)) in _regions(at_zero, OPEN) and not any(found == (5, 1) for _, found in _regions(at_zero, OPEN))
    assert (0, (5, 1)) in _regions(at_zero, CLOSED) and not any(found == (5, -1) for _, found in _regions(at_zero, CLOSED))


def test_an_exponent_of_long_integers_is_left_alone_on_a_branch() -> None:
    """SymPy makes polynomials of degree 1000001 of it where it asks cosh for its sign."""
    a = sp.Symbol("a", real=True)
    long, short = InertNumber(sp.Rational(1000001, 1000000)), InertNumber(sp.Rational(101, 100))
    above, below = branches(sp.cosh(sp.Abs(a) ** long - 1))
    assert {above.expr, below.expr} == {sp.cosh(a**long - 1), sp.cosh((-a) ** long - 1)}
    assert branches(sp.Abs(a) ** short)[0].expr == a ** sp.Rational(101, 100)


def test_branches_that_contradict_each_other_are_not_multiplied_out() -> None:
    """Twelve terms with the same three switches have 3**12 choices, of which few agree."""
    a, b, c = sp.symbols("a b c", real=True)
    expr = sp.Add(*(sp.Max(a, b, c) * sp.exp(k * a) for k in range(12)))
    assert {piece.expr.subs({x: 0 for x in (a, b, c)}) for piece in branches(expr)} == {0}
    assert {piece.expr.coeff(sp.exp(a)) for piece in branches(expr)} == {a, b, c}
