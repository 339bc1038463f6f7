"""What a program gives as a law is held to the language as a text is: anything else is one InputError with its place."""

from __future__ import annotations

import math
from collections.abc import Callable
from fractions import Fraction
from typing import Any

import numpy as np
import pytest
import sympy as sp
from sympy.physics.units import meter

from duhem import Criterion, Domain, InputError, ParametricCriterion, YieldSurface, criterion
from duhem.expression.vocabulary import Where
from duhem.law.criterion_file import reads
from duhem.law.shapes import Disk

A, B = sp.symbols("a b", real=True)
PHI, T = sp.symbols("phi t", real=True)
SIZE = sp.sqrt(A**2 + B**2)

NOT_REAL = [
    sp.I * A - 1, sp.I * A * B - 1, sp.log(-1) + sp.Abs(A) - 1, SIZE - 1 + sp.I, sp.cbrt(-8) + sp.Abs(A), sp.asin(2) * A - 1,
    sp.acos(-2) + A, sp.sqrt(-1 - A**2), Where(A > 0, sp.sqrt(-2), A), sp.Max(A, B) - sp.sqrt(-B**2 - 1),
    sp.Add(sp.I * A, -sp.I * A, B, evaluate=False), (-2) ** A - 1, sp.Abs(A) + sp.Pow(-2, sp.Rational(1, 3), evaluate=False),
]  # fmt: skip
NOT_FINITE = [
    sp.zoo * A, sp.Abs(A) - sp.oo, A + sp.Pow(0, -1, evaluate=False), A * float("inf"), sp.Mul(0, sp.zoo, A, evaluate=False),
]  # fmt: skip
NOT_DECLARED = [sp.Symbol("k", positive=True) * A - 1, sp.Symbol("M", commutative=False) * A, sp.MatrixSymbol("M", 2, 2)[0, 0] + A,
                sp.Dummy("a") + B, sp.re(sp.Symbol("z")) + A]  # fmt: skip
ASSUMED_OTHERWISE = [sp.Symbol("a", **own) * B - 1 for own in ({}, {"positive": True}, {"imaginary": True}, {"integer": True})]
NO_MEANING = [
    sp.Heaviside(A) - 1, sp.Piecewise((A, A > 0), (0, True)) - 1, sp.Integral(T, (T, 0, A)) - 1, sp.Integral(B, (B, 0, A)) - 1,
    sp.Function("h")(A) - 1, sp.Function("Norm")(A) - 1, meter * A, sp.EulerGamma * A, sp.AccumBounds(0, 1) * A, sp.Matrix([A]),
    sp.sec(A), sp.floor(A), sp.conjugate(sp.Symbol("a", real=True) + sp.Function("h")(B)), Where(sp.Eq(A, 1), A, B),
]  # fmt: skip
NO_FORMULA = [None, [A - 1], (A - 1, B), {}, True, A.is_real, sp.true, np.array([1.0, 2.0]), object(), sp.Symbol, sp.Interval(0, 1), b"a"]
TOO_LARGE = [A**2000 - 1, 10**10_000 * A, sp.Integer(10) ** 3000 + A]
FAMILIES = [
    (NOT_REAL, "not real"), (NOT_FINITE, "not real and finite"), (NOT_DECLARED, "is not declared"),
    (ASSUMED_OTHERWISE, "has other assumptions than the law's a"), (NO_MEANING, "no meaning is given"), (NO_FORMULA, "is no formula"),
    ([A <= 1, sp.Eq(A, 1), sp.Ne(A, B)], "is a comparison"), (TOO_LARGE, "too large"),
]  # fmt: skip
REFUSED = [(given, why) for family, why in FAMILIES for given in family]


def _law(**stated: Any) -> Criterion:
    return Criterion(**{"name": "x", "g": SIZE - 1, "forces": ("a", "b"), "pressure": None, **stated})


PLACES: dict[str, Callable[[Any], Any]] = {
    "g of x": lambda given: criterion(name="x", forces=("a", "b"), pressure=None)(lambda a, b: given),
    "flow of x": lambda given: _law(flow=(A, given)),
    "g of surface 2 of x": lambda given: _law(g=sp.nan, surfaces=(YieldSurface(A - 1), YieldSurface(given))),
    "flow of surface 1 of x": lambda given: _law(g=sp.nan, surfaces=(YieldSurface(A - 1, flow=(given, 0)), YieldSurface(B - 1))),
    "closed form of x": lambda given: _law(closed_form=Disk(given, "1")),
}  # fmt: skip


@pytest.mark.parametrize("place", PLACES)
def test_what_is_no_real_formula_is_refused_in_one_line(place: str) -> None:
    for given, why in REFUSED:
        with pytest.raises(InputError, match=why) as caught:
            PLACES[place](given)
        assert caught.value.where == place and caught.value.remedy and "\n" not in str(caught.value), given


def test_curves_are_held_to_the_same() -> None:
    swap = {A: sp.cos(PHI), B: sp.sin(PHI)}
    for family, why in (
        (NOT_REAL[:4], "not real"),
        ([sp.zoo * A, sp.nan], "not real and finite"),
        (NO_FORMULA, "is no formula"),
        ([A < 1], "is a comparison"),
    ):
        for given in family:
            turned = given.xreplace(swap) if isinstance(given, sp.Expr) else given
            for pair in ({"boundary": (sp.cos(PHI), turned)}, {"boundary": ("cos(phi)", "sin(phi)"), "flow": (turned, "1")}):
                with pytest.raises(InputError, match=why) as caught:
                    ParametricCriterion("x", **pair)
                assert caught.value.where == f"{'flow' if 'flow' in pair else 'boundary'} of x"
    for given in (5, "ab", {"a": 1}, sp.cos(PHI)):
        with pytest.raises(InputError, match="boundary is no list"):
            ParametricCriterion("x", given)


def test_the_file_refuses_it_for_the_same_reason() -> None:
    for text in ("sqrt(-1)*a - 1", "log(-1) + abs(a) - 1", "asin(2)*a - 1", "(-2)**a", "sqrt(-1 - a**2)"):
        with pytest.raises(InputError) as read:
            reads(f'[criterion]\nname = "x"\nforces = ["a"]\npressure = false\ng = "{text}"\n')
        made = eval(text, {"a": A, "sqrt": sp.sqrt, "log": sp.log, "asin": sp.asin, "abs": abs})  # our own text
        with pytest.raises(InputError) as caught:
            _law(g=made)
        assert "not real" in caught.value.what and caught.value.what in read.value.what and caught.value.remedy == read.value.remedy


def test_what_is_a_formula_is_taken_as_the_text_is() -> None:
    alike = {
        "abs(a)*3/10 - 1.5": (0.3 * sp.Abs(A) - 1.5, sp.Abs(A) * Fraction(3, 10) - Fraction(3, 2), np.float64(0.3) * sp.Abs(A) - 1.5),
        "abs(a)**1.3001 - 1": (sp.Abs(A) ** 1.3001 - 1,),
        "sign(a)*a - 1": (sp.sign(A) * A - 1,),
        "atan2(a, b) + a": (sp.atan2(A, B) + A,),
        "where(a > 0, a, b)": (Where(A > 0, A, B),),
        "exp(a) - pi": (sp.exp(A) - sp.pi,),
    }
    for text, made in alike.items():
        for given in (text, *made):
            assert _law(g=given).g == _law(g=text).g


def test_a_fixed_value_that_makes_it_unreal_is_refused() -> None:
    law = _law(g=SIZE - sp.sqrt(-sp.Symbol("k", real=True)), parameters={"k": Domain()})
    assert law.fix({"k": -1}).g.has(sp.Symbol("k", real=True))
    with pytest.raises(InputError, match="not real"):
        law.fix({"k": 1})


def test_constraints_are_comparisons_of_formulas() -> None:
    k = sp.Symbol("k", positive=True)
    own = {"parameters": {"k": Domain(positive=True)}, "g": SIZE - k}
    assert _law(constraints=[k < 1, k > 0, True], **own).constraints == (k < 1,)
    bad = [
           (5, "no comparison"), (k, "no comparison"), (sp.Eq(k, 1), "no comparison"), (None, "no comparison"), (False, "never holds"),
           (sp.Symbol("k") < 1, "other assumptions"), (sp.Symbol("q") < 1, "not declared"),
           (sp.StrictLessThan(k, sp.oo, evaluate=False), "not real and finite"), (sp.And(k < 1, k < 2, evaluate=False), "no comparison"),
    ]  # fmt: skip
    for given, why in bad:
        with pytest.raises(InputError, match=why):
            _law(constraints=[given], **own)
    for whole in (5, "k < 1", k < 1):
        with pytest.raises(InputError, match="constraints is no list"):
            _law(constraints=whole, **own)


def test_arguments_are_the_names_of_the_law_however_they_are_passed() -> None:
    def plain(a, b, mu):
        return sp.Abs(a) - mu * b

    def named(a, *, b, mu):
        return sp.Abs(a) - mu * b

    def placed(a, b, /, mu):
        return sp.Abs(a) - mu * b

    def default(a, b, mu=0.3):
        return sp.Abs(a) - mu * b

    def starred(a, b, *mu):
        return sp.Abs(a)

    def doubled(a, b, **mu):
        return sp.Abs(a)

    make = criterion(name="x", forces=("a", "b"), pressure=None)
    assert make(plain) == make(named) == make(placed)
    for function, why in ((default, "mu has a default"), (starred, r"\*mu names nothing"), (doubled, r"\*\*mu names nothing")):
        with pytest.raises(InputError, match=why) as caught:
            make(function)
        assert caught.value.where == function.__name__ and caught.value.remedy
    for given in (5, "a", dict):
        with pytest.raises(InputError, match="no function"):
            make(given)


def test_a_function_that_cannot_take_symbols_is_refused_with_its_cause() -> None:
    make = criterion(name="x", forces=("a", "b"), pressure=None)
    unfit = (lambda a, b: a if a > b else b, lambda a, b: math.sqrt(a), lambda a, b: sp.Max(a, sp.log(-3 - b**2)), lambda a, b: a / b + {})
    for function in unfit:
        with pytest.raises(InputError, match="cannot be computed with symbols") as caught:
            make(function)
        assert caught.value.where == "<lambda>" and caught.value.remedy and caught.value.__cause__ is not None
    with pytest.raises(InputError, match="the value is not real"):  # what the function says itself stays
        make(lambda a, b: _law(g=sp.I * a).g)


def test_the_rest_of_a_law_is_what_it_should_be() -> None:
    bad = [
        ({"closed_form": "disc"}, "'disc' is no shape"), ({"closed_form": Disk}, "is no shape"), ({"flow": 5}, "flow is no list"),
        ({"flow": "ab"}, "flow is no list"), ({"forces": "ab"}, "forces is no list"), ({"forces": 5}, "forces is no list"),
        ({"pressure": 5}, "5 is not a name"), ({"forces": (A, B)}, "a is not a name"),
        ({"surfaces": (YieldSurface(sp.nan), YieldSurface(A - 1)), "g": sp.nan}, "there is no g"),
    ]  # fmt: skip
    for stated, why in bad:
        with pytest.raises(InputError, match=why) as caught:
            _law(**stated)
        assert caught.value.where and caught.value.remedy
        if "surfaces" not in stated:
            with pytest.raises(InputError, match=why):
                criterion(**{"name": "x", "forces": ("a", "b"), "pressure": None, **stated})(lambda a, b: a - 1)
