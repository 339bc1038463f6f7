"""Branches of a formula with choices: each choice belongs to one side, and who owns the equality is kept in mind."""

import sympy as sp

from duhem.expression import Where
from duhem.expression.branches import branches

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
