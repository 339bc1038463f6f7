"""For which coefficients quartic forms in the plane are convex: exact regions, held to the roots of Hessians, and their certificates."""

from __future__ import annotations

import random
from fractions import Fraction
from functools import cache
from typing import Any

import pytest
import sympy as sp

import duhem
from duhem.regions import PavedRegion
from tests.long import mostly_long
from tests.oracles.quartic_forms import convex, everywhere_at_most_zero
from tests.regions.test_planes import Point, compiled, confirms_only_what_is_true, points, verdict_of

BETWEEN = duhem.Domain.between
A_AND_B = {"a": BETWEEN(-3, 3), "b": BETWEEN(-1, 7)}
# g, the parameters, the coefficients of the form, and the region
FORMS: dict[str, tuple[str, dict[str, duhem.Domain], str, str]] = {
    "turned into itself": (
        "x**4 + a*x**3*y + b*x**2*y**2 + a*x*y**3 + y**4 - 1", A_AND_B, "1 a b a 1",
        "b >= 0 and b <= 6 and 9*a**2 - 2*b**2 - 12*b <= 0",
    ),
    "under a pressure": (
        "x**4 + a*x**3*y + b*x**2*y**2 + a*x*y**3 + y**4 - (m*p)**4", A_AND_B | {"m": duhem.POSITIVE}, "1 a b a 1",
        "b >= 0 and b <= 6 and 9*a**2 - 2*b**2 - 12*b <= 0",
    ),
    "turned by a right angle": (
        "(x**2 + y**2)**2 + a*(x*y)**2 + b*x*y*(x**2 - y**2) - 1", {"a": BETWEEN(-3, 6), "b": BETWEEN(-3, 3)}, "1 b 2+a -b 1",
        "a >= -2 and a <= 4 and 2*a**2 - 4*a + 9*b**2 - 16 <= 0",
    ),
    "skew": (
        "x**4 + a*x**3*y + b*x**2*y**2 + y**4 - 1", A_AND_B, "1 a b 0 1", "b >= 0 and b <= 6 and 27*a**2 + 2*b**3 - 72*b <= 0",
    ),
    "odd powers": (
        "x**4 + a*x**3*y + 2*x**2*y**2 + b*x*y**3 + y**4 - 1", {"a": BETWEEN(-3, 3), "b": BETWEEN(-3, 3)}, "1 a 2 b 1",
        "27*a**2 - 18*a*b + 27*b**2 - 128 <= 0",
    ),
    "of a leading coefficient": (
        "a*x**4 + x**3*y + b*x**2*y**2 + y**4 - 1", {"a": BETWEEN(-1, 3), "b": BETWEEN(-1, 7)}, "a 1 b 0 1",
        "a >= 0 and b >= 0 and 8*a*b - 3 >= 0 and 36*a - b**2 >= 0 and 72*a*b - 2*b**3 - 27 >= 0",
    ),
    "even": (
        "A*x**4 + B*x**2*y**2 + C*y**4 - 1", {"A": BETWEEN(-1, 3), "B": BETWEEN(-3, 7), "C": BETWEEN("1/10", 3)}, "A 0 B 0 C",
        "A >= 0 and B >= 0 and 36*A*C - B**2 >= 0",
    ),
    "of three": (
        "x**4 + a*x**3*y + b*x**2*y**2 + c*x*y**3 + y**4 - 1", A_AND_B | {"c": BETWEEN(-3, 3)}, "1 a b c 1",
        "b >= 0 and b <= 6 and 3*a**2 - 8*b <= 0 and 8*b - 3*c**2 >= 0 and 27*a**2 - 9*a*b*c + 2*b**3 - 72*b + 27*c**2 <= 0",
    ),
}  # fmt: skip
_ALWAYS = ("turned into itself", "skew", "even")


@cache
def found(name: str) -> PavedRegion:
    g, parameters, _, _ = FORMS[name]
    law = duhem.Criterion(name=name, pressure="p" if "p" in g else None, forces=("x", "y"), g=g, parameters=parameters)
    done = duhem.region(law, tuple(parameter for parameter in parameters if parameter != "m"))
    assert isinstance(done, PavedRegion)
    return done


def holds(name: str, at: Point) -> bool:
    """Whether K is convex: the form is, or K is everything."""
    exact = {parameter: sp.Rational(x.numerator, x.denominator) for parameter, x in at.items()}
    coefficients = [sp.sympify(text).subs(exact) for text in FORMS[name][2].split()]
    return convex(coefficients) or everywhere_at_most_zero(coefficients)


@pytest.mark.parametrize("name", mostly_long(FORMS, *_ALWAYS))
def test_regions_of_quartic_forms_are_exact(name: str) -> None:
    done = found(name)
    assert done.exact and done.short == FORMS[name][3] and duhem.recheck(done.certificate()).ok
    assert all(cell.trust == "checked" for cell in done.cells)


@pytest.mark.parametrize(
    ("name", "count"),
    mostly_long([*((name, 12) for name in _ALWAYS), *((name, 2000) for name in FORMS)], *((name, 12) for name in _ALWAYS)),
)
def test_verdicts_of_quartic_forms_are_those_of_their_hessians(name: str, count: int) -> None:
    done = found(name)
    cells = compiled(done)
    edges = [{"a": x, "b": b} for b in map(Fraction, (0, 6)) for x in map(Fraction, (-4, 0, 3))]
    edges = [at for at in edges if {*at} == {*done.everything.box} and all(done.everything.box[n].holds(x) for n, x in at.items())]
    for at in (*points(done, count), *edges):
        assert verdict_of(cells, at) == ("proved" if holds(name, at) else "refuted"), at


@pytest.mark.long
@pytest.mark.parametrize(("name", "count"), [(name, 100) for name in _ALWAYS])
def test_no_tampered_certificate_of_a_quartic_form_confirms_a_false_region(name: str, count: int) -> None:
    exact = cache(lambda at: holds(name, dict(at)))
    document: dict[str, Any] = found(name).certificate()
    drawn = {tuple(sorted(at.items())) for at in points(found(name), 40, seed=random.Random(3).randrange(99))}
    assert {exact(at) for at in drawn} == {True, False}
    assert confirms_only_what_is_true(document, found(name), lambda at: exact(tuple(sorted(at.items()))), count) > count / 4
