"""Smoothness of laws of J2 and J3: the axis where J2 = 0, at which cos 3 theta has no value, must be off the boundary."""

import pytest

from duhem import Criterion, Domain
from duhem.proof.certificate import law_as_text
from duhem.proof.kernel.certificate import stated
from duhem.proof.kernel.claims import objection
from tests.long import long_but, mostly_slow
from tests.oracles.prover import composition
from tests.oracles.prover.decide import AskedSubject

J2, J3 = "((a-b)**2+(b-c)**2+(c-a)**2)/6", "(2*a-b-c)*(2*b-c-a)*(2*c-a-b)/27"
ARGYRIS = f"sqrt({J2})*(1+K)/(2*K) + (1-K)/(2*K)*(3*sqrt(3)/2)*({J3})/({J2}) - k"
EEKELEN = f"sqrt({J2})*(1 + K*(3*sqrt(3)/2)*({J3})/({J2})**(3/2))**0.229 - k"
POSITIVE = Domain(positive=True)


def law(g, shape, size=POSITIVE):
    return Criterion("law", g, {"K": shape, "k": size}, forces=("a", "b", "c"), pressure=None)


def smooth(g, shape, size=POSITIVE):
    return not objection("smoothness", "composition", frozenset(), stated(law_as_text(law(g, shape, size))), {})


def proved(g, shape, size=POSITIVE):
    return composition.smoothness(AskedSubject(law(g, shape, size))) is not None


CYLINDERS = [(ARGYRIS, Domain.between("0.8", 1)), (EEKELEN, Domain.fixed("0.7"))]


@pytest.mark.parametrize(("g", "shape"), mostly_slow(CYLINDERS, CYLINDERS[1]))
def test_a_cylinder_is_smooth(g, shape):
    assert smooth(g, shape) and proved(g, shape)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("g", "shape", "size"),
    long_but(
        [1, 3],
        [
            (ARGYRIS, Domain.between("0.8", 1), Domain.between(0, 1)),  # for k = 0 K is the axis
            (ARGYRIS + " + a + b + c", Domain.between("0.8", 1), POSITIVE),  # a cone: its tip is on the axis
            pytest.param(ARGYRIS + " + abs(a - b)", Domain.between("0.8", 1), POSITIVE, marks=pytest.mark.long),  # a kink
            (EEKELEN, Domain.fixed("1.1"), POSITIVE),  # what is raised to a power is 0 at some angle
            (EEKELEN.replace("- k", "+ k"), Domain.fixed("0.7"), POSITIVE),  # K is empty
        ],
    ),
)
def test_what_only_looks_like_one_is_not_shown_to_be(g, shape, size):
    assert not smooth(g, shape, size) and not proved(g, shape, size)


@pytest.mark.slow
def test_without_convexity_it_is_by_euler_s_relation():
    shape = Domain.between("0.5", 1)
    assert proved(ARGYRIS, shape) and not smooth(ARGYRIS, shape)
