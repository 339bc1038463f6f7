"""Dissipation by Euler's relation alone, and signs of what holds exponentials; beside each what is almost so and false."""

from fractions import Fraction

import pytest

from duhem import Criterion, Domain, verify
from duhem.proof.certificate import law_as_text
from duhem.proof.kernel.certificate import stated
from duhem.proof.kernel.claims import objection
from duhem.proof.verdict import Trust, Verdict
from tests.long import long_but
from tests.oracles.prover import degrees
from tests.oracles.prover.decide import AskedSubject

POSITIVE = Domain(positive=True)


def law(g, forces=("a", "b", "c"), pressure=None, **parameters):
    return Criterion("law", g, parameters, forces=forces, pressure=pressure)


def checked(one):
    return objection("dissipation", "homogeneity", frozenset(), stated(law_as_text(one)), {}) == ""


@pytest.mark.parametrize(
    "g",
    [
        "a**4 - 5*a**2*b**2 + b**4 + c**4 - 1",  # K is not convex and has no end
        "a**6 + b**2 + c**4 - k",  # of three degrees
        "max(abs(a) - 2*b, norm(b, c) - a) - k",
        "(a**2 + b**2 + c**2)**(3/2) + a*b*c - k",
    ],
)
def test_what_rises_outward_by_its_degrees(g):
    one = law(g, k=POSITIVE)
    found = degrees.dissipation(AskedSubject(one))
    assert found is not None and found.verdict is Verdict.PROVED and checked(one)


@pytest.mark.parametrize("g", ["(a**2 + b**2 + c**2)**2 - norm(a, b, c)", "a**2 + b**2 + c**2 - a"])
def test_at_zero_force_the_power_is_zero_anyway(g):
    assert degrees.dissipation(AskedSubject(law(g))) is not None


@pytest.mark.parametrize(
    "one",
    [
        law("a**2 + b**2 + c**2 - 3*a + 2"),  # 0 is outside
        law("a**2 - b**2 + c**2 - a"),  # so do A and B
        law("a**4 - 5*a**2*b**2 + b**4 + c**4 - k", k=Domain.between(0, 1)),  # B may be 0
        law("where(a > 0, norm(a, b, c), 2*norm(a, b, c)) - 1"),  # it jumps
        law("norm(a, b, c) - exp(a)"),  # of no degree
        Criterion("law", "norm(a, b, c) - 1", {}, forces=("a", "b", "c"), pressure=None, flow=("-a", "-b", "-c")),
    ],
)
def test_what_only_looks_so(one):
    assert degrees.dissipation(AskedSubject(one)) is None and not checked(one)


LOADED = "norm(a, b) - k*(1 - exp(-m*abs(sigma_n)/k))"


def load(g, m=POSITIVE):
    return law(g, ("a", "b"), "sigma_n", k=POSITIVE, m=m)


def test_an_exponential_lies_on_one_side_of_1():
    found = verify(load(LOADED), claims=["origin", "smoothness", "dissipation"])
    assert [(r.verdict, r.trust) for r in found.results] == [(Verdict.PROVED, Trust.CHECKED)] * 3


@pytest.mark.parametrize(
    "one",
    long_but(
        [0, 2],
        [
            load(LOADED.replace("exp(-m", "exp(m")),
            load(LOADED.replace("(1 -", "(1/2 -")),
            load(LOADED.replace("(1 -", "(999/1000 -")),
            load(LOADED, Domain.between(-1, 1)),
        ],
    ),
)
def test_nothing_of_an_exponential_is_proved_beyond_that(one):
    assert verify(one, claims=["origin"])["origin"].verdict is not Verdict.PROVED


@pytest.mark.slow
def test_where_the_exponent_may_be_0_the_tip_may_be_on_the_boundary():
    found = verify(load(LOADED, Domain.between(0, Fraction(1))), claims=["origin", "smoothness"])
    assert found["origin"].verdict is Verdict.PROVED and found["smoothness"].verdict is not Verdict.PROVED


CONE = "max(-a, -b, -c, (a + b + c)*(a*b + b*c + c*a) - k*a*b*c)"  # Matsuoka, Nakai (1974)


@pytest.mark.parametrize(
    "g", [CONE, "max(-a, a**2 - b**2, k*c*norm(a, b))", "abs(a) - k*norm(b, c)", "max(a**3, min(b, -c**2))", "(a*b*c)**3"]
)
def test_the_normals_of_a_cone_are_across_the_force(g):
    one = law(g, k=POSITIVE)
    found = degrees.dissipation(AskedSubject(one))
    assert found is not None and found.verdict is Verdict.PROVED and checked(one)


@pytest.mark.parametrize(
    "one",
    [
        law("max(-a, -b, -c, (a + b + c)*(a*b + b*c + c*a) - k*a*b*c - a)", k=POSITIVE),
        law("max(-a, -b - k, c)", k=POSITIVE),  # its tip is elsewhere
        law("max(a + b**2, -c)"),
        law("where(a > 1, a**2 - b**2, a**2 - 2*b**2)"),
        law("a**2*b + a*b*p", forces=("a", "b"), pressure="p"),
        Criterion("law", "abs(a) - norm(b, c)", {}, forces=("a", "b", "c"), pressure=None, flow=("-a", "-b", "-c")),
    ],
)
def test_what_only_looks_like_a_cone(one):
    assert degrees.dissipation(AskedSubject(one)) is None and not checked(one)
