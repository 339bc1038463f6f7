"""Forms of even degree in the kernel: what their matrices show is so, and of quartic forms in the plane that they show all there is."""

from __future__ import annotations

from random import Random

import pytest
import sympy as sp

from duhem.proof.kernel.curvature import over
from duhem.proof.kernel.dents import Dent, dents
from duhem.proof.kernel.semidefinite import catalecticant, homogeneous_parts, semidefinite
from duhem.proof.kernel.signs import RealRoot
from duhem.proof.kernel.stated_law import StatedLaw
from duhem.proof.kernel.term import NotWritten
from tests.long import mostly_long
from tests.oracles.quartic_forms import convex, everywhere_at_most_zero

X, Y, Z = sp.symbols("x y z", real=True)


def law(g: object, forces: tuple[str, ...] = ("x", "y"), *constraints: str) -> StatedLaw:
    parameters = {"a": {}, "m": {"positive": True}, "e": {"min": "-1", "max": "1"}}
    given = {"forces": forces, "pressure": None, "parameters": parameters, "constraints": constraints}
    return StatedLaw.read({**given, "g": str(g), "flow": None})


def proved(stated: StatedLaw) -> bool:
    found = over(stated).facts(stated.g)
    return found.defined and found.convex


def refuting(stated: StatedLaw) -> list[Dent]:
    try:
        return [dent for dent in dents(stated, "form") if dent.at(RealRoot.of(dent.between[0]))]
    except NotWritten:
        return []


def drawn(draw: Random) -> list[sp.Rational]:
    """The coefficients of a form that is often close to where convexity ends: of powers of lines, and something more or less."""
    rows = [(draw.randrange(-3, 4), draw.randrange(-3, 4)) for _ in range(draw.choice([1, 2, 2, 3]))]
    form = sp.Poly(sum(((p * X + q * Y) ** 4 for p, q in rows), X**4 * 0), X, Y)
    more = sp.Rational(draw.randrange(-3, 4), draw.choice([1, 10, 1000])) if draw.random() < 0.8 else 0
    form += sp.Poly(more * X ** draw.randrange(5) * Y**4, X, Y) if draw.random() < 0.1 else sp.Poly(more * (X * Y) ** 2, X, Y)
    return [form.coeff_monomial(X ** (4 - k) * Y**k) for k in range(5)]


@pytest.mark.parametrize(("seed", "count"), mostly_long([(1, 20), (2, 1000)], (1, 20)))
def test_a_quartic_form_is_proved_or_refuted_as_its_hessian_says(seed: int, count: int) -> None:
    draw, seen = Random(seed), set[bool]()
    for _ in range(count):
        if not any(c := drawn(draw)):
            continue  # a law is of its forces
        stated = law(sp.expand(sum(ck * X ** (4 - k) * Y**k for k, ck in enumerate(c))) - 1)
        seen.add(holds := convex(c))
        assert proved(stated) is holds, c
        assert bool(refuting(stated)) is (not holds and not everywhere_at_most_zero(c)), c
    assert seen == {True, False}


@pytest.mark.parametrize(
    ("g", "holds"),
    [
        ("x**4 + 6*x**2*y**2 + y**4", True),
        ("x**4 + 6.000001*x**2*y**2 + y**4", False),
        ("x**4 - x**2*y**2/10**6 + y**4", False),
        ("(x + y)**6 + (x - 2*y)**6 + x**2 - x*y + y**2 + x - 1", True),
        ("(x + y)**6 + (x - 2*y)**6 - x**6/10**3", False),
        ("(x + y)**4 + (y - z)**4 + (x + y + z)**4", True),
        ("(x + y)**4 + (y - z)**4 + (x + y + z)**4 - z**4/10**3", False),
        ("x**4 + e*x**3*y + x**2*y**2 + e*x*y**3 + y**4", True),
        ("x**4 + 2*e*x**3*y + x**2*y**2 + 2*e*x*y**3 + y**4", False),
        ("m*(x**4 + 6*x**2*y**2 + y**4) + x**3", False),
        ("a*x**4", False),
        ("x**4 + 6*x**2*y**2 + y**4 + abs(z)", True),
        ("x**4 + 6*x**2*y**2 + y**4 - abs(z)", False),
    ],
)
def test_what_matrices_show(g: str, holds: bool) -> None:
    assert proved(law(g, ("x", "y", "z"))) is holds


def test_a_matrix_is_that_of_the_form_in_products_of_vectors() -> None:
    stated = law("x**4 + 5*x**3*y + 7*x**2*y**2 + 11*x*y**3 + 13*y**4")
    domain = over(stated)
    matrix = catalecticant(homogeneous_parts(domain.polynomial(stated.g), domain)[4], 4)
    found = [[str(domain.polynomial(entry)[()]) for entry in row] for row in matrix]
    assert found == [["1", "5/4", "7/6"], ["5/4", "7/6", "11/4"], ["7/6", "11/4", "13"]]
    assert not semidefinite(matrix, domain)


@pytest.mark.parametrize(
    "g",
    [
        "x**4 + 9*x**2*y**2 + y**4 + 1",  # no star
        "x**4 + 9*x**2*y**2 + y**4 + x**2 - 1",  # more than a form
        "-x**4 - 9*x**2*y**2 - y**4 - 1",  # everything
        "a*x**4 + 9*a*x**2*y**2 + a*y**4 - 1",  # everything, for some
        "x**4 + 6*x**2*y**2 + y**4 - 1",
        "x**6 + 99*x**3*y**3 + y**6 - 1",
        "x**4 + (0/e)*9*x**2*y**2 + y**4 - 1",  # no value for e = 0
        "abs(x)**3 + 9*x**2*y + y**3 - 1",
        "-x**2 - y**2 - 1",
        "x**2 + e*y**2 - 1",
    ],
)
def test_of_what_no_minor_shows_a_dent(g: str) -> None:
    assert not refuting(law(g))


@pytest.mark.parametrize(
    "g", ["x**2 - y**2 + a*x + 1", "x*y", "m*x**2 + (e - 2)*y**2 + a*y", "x**4 - m*y**4 - 1", "x**2 + 3*x*y + y**2 + a"]
)
def test_what_falls_somewhere_and_rises_somewhere_is_not_convex(g: str) -> None:
    assert refuting(law(g))


def test_constraints_on_coefficients_tell_minors() -> None:
    form = "x**4 + a*x**3*y + 2*x**2*y**2 + a*x*y**3 + y**4 - 1"
    assert proved(law(form, ("x", "y"), "9*a**2 <= 32")) and not proved(law(form, ("x", "y"), "9*a**2 <= 32.0001"))
    assert refuting(law(form, ("x", "y"), "9*a**2 > 32")) and not refuting(law(form, ("x", "y"), "9*a**2 >= 32"))
