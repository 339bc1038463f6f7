"""The greatest and the least of expressions are the very expressions that SymPy builds, without its comparing what points keep apart."""

from __future__ import annotations

import random

import pytest
import sympy as sp

from duhem.errors import InputError
from duhem.expression.build import greatest, least
from duhem.expression.numpy_ import evaluate
from duhem.expression.parse import parse_expression
from duhem.expression.pnorm import recognised
from duhem.expression.vocabulary import EigMax, Norm, Pos, Where, symbol

X, Y, Z = (symbol(name) for name in "xyz")
A, B, S = symbol("a", positive=True), symbol("b", nonnegative=True), symbol("s", nonpositive=True)
COUNT = sp.Symbol("n", integer=True, positive=True)
BOTH = pytest.mark.parametrize(("ours", "theirs"), [(greatest, sp.Max), (least, sp.Min)])
GIVEN = [
    (),
    (X,),
    (X, X),
    (X, Y),
    (X, 0),
    (X, X + 1),
    (A, -B, S),  # the signs of the symbols decide
    (A, 0),
    (A * X, B * Y, -Z),
    (A + 1, X, 1),
    (sp.Abs(X), 2 * sp.Abs(X), Y),
    (sp.Abs(X), -sp.Abs(Y)),
    (sp.Max(X, Y), Z),
    (sp.Min(X, Y), Z),
    (sp.Max(X, Y), sp.Max(X, Z)),
    (sp.Min(X, Y), sp.Min(X, Z)),
    (sp.Max(X, Y, evaluate=False), sp.Max(X, X + 1, evaluate=False)),
    (X**2, Y, -(X**2)),
    (sp.log(X), Y, sp.log(X) + 1),
    (sp.sqrt(A), sp.sqrt(A) - 1, -sp.exp(X)),
    (sp.Integer(2), sp.pi, X, 3),
    (X, sp.oo),
    (X, -sp.oo),
    (COUNT, 1),
    (X, sp.Abs(X)),
    (X, Pos(X)),
    (A * (X + Y), A * X + A * Y, Z),
    (sp.Symbol("q"), X),
    (EigMax(X, Y, Z, 0, 0, 0), X),
    (Norm(X, Y), Pos(X), Z),
    (Where(X > 0, X, Y), Z, Where(X > 0, X, Y) + 1),
]


def _alike(one: sp.Basic, other: sp.Basic) -> bool:
    return one == other and hash(one) == hash(other) and sp.srepr(one) == sp.srepr(other)


@BOTH
@pytest.mark.parametrize("given", GIVEN, ids=str)
def test_it_is_what_sympy_builds(ours, theirs, given):
    given = tuple(map(sp.sympify, given))
    assert _alike(ours(*given), theirs(*given))


@pytest.mark.slow
@BOTH
def test_drawn_arguments_give_what_sympy_builds(ours, theirs):
    """Many of the drawn pairs are such that one is always the greater."""
    drawn = random.Random(7)
    shorter = 0
    for _ in range(16):
        forms = [drawn.choice((X, Y, A, B, S, sp.Abs(X), sp.Abs(X - Y), Norm(X, Y), sp.Min(X, A))) for _ in range(drawn.randint(2, 4))]
        given = [drawn.choice((-1, 1, 2, A)) * form + drawn.choice((0, 0, 1, B)) for form in forms]
        made = theirs(*given)
        assert _alike(ours(*given), made), given
        shorter += len(made.args if isinstance(made, theirs) else [made]) < len(set(given))
    assert shorter > 2


@BOTH
def test_what_is_no_real_number_is_refused(ours, theirs):
    for given in ((X, sp.I), (sp.zoo, X), (sp.Symbol("q", imaginary=True), X)):
        for build in (ours, theirs):
            with pytest.raises(ValueError, match="not comparable"):
                build(*given)


def test_sides_of_a_polygon_are_not_compared(monkeypatch):
    """A section with thirty-two sides: SymPy would try 496 pairs in eight ways each."""

    def compared(*_):
        raise AssertionError("SymPy compares")

    sides = [f"{c}*x + {s}*y" for c in range(-4, 4) for s in (-3, -1, 2, 5)]
    known = {"x": X, "y": Y}
    forms = [parse_expression(side, known) for side in sides]
    monkeypatch.setattr(sp.Max, "_is_connected", compared)
    for text in (", ".join(sides), f"max({', '.join(sides[:20])}), max({', '.join(sides[20:])})"):
        assert set(parse_expression(f"max({text})", known).args) == set(forms)
    with pytest.raises(AssertionError, match="SymPy compares"):
        sp.Max(*forms)


@pytest.mark.parametrize("extreme", ["max", "min"])
@pytest.mark.parametrize("number", ["(1 + sqrt(2))**4", "(1 + abs(norm(1, 1)))**4", "(2 - sqrt(3))**6*(1 + sqrt(5))"])
def test_norms_are_recognised_beside_numbers_that_sympy_does_not_compare(extreme, number):
    """Where an extreme is built anew of parts that have changed, SymPy would ask which is the greater."""
    given = parse_expression(f"{extreme}(sqrt(x**2 + y**2), norm(x + x, 3), {number}) + sqrt((x - y)**2 + y**2)", {"x": X, "y": Y})
    found, point = recognised(given), {X: 1.5, Y: -0.25}
    assert not any(p.base.is_Add for p in found.atoms(sp.Pow) if p.free_symbols)
    assert evaluate(given, point) == pytest.approx(float(given.subs(point)))


@pytest.mark.parametrize("exponent", [400, 5000])
def test_a_number_beyond_double_precision_is_told_by_its_size(exponent):
    with pytest.raises(InputError, match=rf"about 10\*\*{exponent} is too large .*; rescale the formula"):
        evaluate(symbol("x") + sp.Integer(10) ** exponent, {symbol("x"): 1.0})
