"""What is said of each elementary function holds at many numbers, worked out in many digits."""

from __future__ import annotations

from itertools import pairwise, product
from math import inf, isnan

import mpmath
import numpy as np
import pytest
import sympy as sp

from duhem.expression.elementary import ELEMENTARY, Elementary, array_function, imports, on_arrays
from tests.oracles.prover.decide import SIGNS

EACH = pytest.mark.parametrize("word", ELEMENTARY.values(), ids=lambda word: word.name)


def points(word: Elementary) -> list[float]:
    least, most = max(word.domain[0], -6.0), min(word.domain[1], 6.0)
    return [float(x) for x in np.linspace(least, most, 40)[1:-1]]


def values(word: Elementary) -> list[mpmath.mpf]:
    return [getattr(mpmath.mp, word.name)(mpmath.mpf(x)) for x in points(word)]


@EACH
def test_signs_and_slopes(word: Elementary) -> None:
    rises = [b - a for a, b in pairwise(values(word))]
    bends = [b - a for a, b in pairwise(rises)]
    assert not word.increasing or min(rises) > 0
    assert word.curvature != "convex" or min(bends) > 0
    assert word.curvature != "concave" or max(bends) < 0
    if word.name in SIGNS and not word.poles:
        value, place, sense = SIGNS[word.name]
        assert all((f > value) == (sense * (x - place) > 0) for x, f in zip(points(word), values(word), strict=True))
    assert word.analytic == (word.name not in ("log", "tan", "asin", "acos"))


@EACH
def test_limits(word: Elementary) -> None:
    for x, limit in zip((-1e4, 1e4), word.far or (), strict=False):
        found = getattr(mpmath.mp, word.name)(mpmath.mpf(x))
        assert isnan(limit) or (abs(found) > 1e300 if abs(limit) == inf else abs(found - limit) < 1e-30), limit
        assert isnan(limit) or found * limit >= 0


@EACH
def test_texts_are_the_derivatives(word: Elementary) -> None:
    x = sp.Symbol("x", real=True)
    f = word.node(x)
    for at in points(word):
        v = array_function(word.numpy)(at)
        slope, bend = (float(f.diff(x, k).subs(x, sp.Rational(at)).evalf(30)) for k in (1, 2))
        s = on_arrays(word.slope)(x=at, v=v)
        assert s == pytest.approx(slope, rel=1e-13)
        assert on_arrays(word.bend)(x=at, v=v, s=s) == pytest.approx(bend, rel=1e-12, abs=1e-13)


@EACH
def test_a_value_is_off_by_no_more_than_its_bound(word: Elementary) -> None:
    f, number = getattr(mpmath.mp, word.name), mpmath.mpf
    with mpmath.workdps(40):
        for x, e in product(points(word), (0.0, 1e-9, 1e-3, 0.3)):
            with np.errstate(all="ignore"):
                bound = float(on_arrays(word.off)(x=x, v=float(f(number(x))), e=e))
            for at in (number(x) - number(e), number(x) + number(e)):
                if max(word.domain[0], -6.0) <= at <= word.domain[1]:
                    assert abs(f(at) - f(number(x))) <= bound * (1 + 1e-9), (x, e)


def test_a_function_that_numpy_lacks_is_python_s_in_a_text_and_scipy_s_on_arrays() -> None:
    assert imports(["erf", "sin"]) == "from math import erf\nfrom numpy import sin"
    assert array_function("erf")(np.array([0.0, 9.0])).tolist() == [0.0, 1.0]
