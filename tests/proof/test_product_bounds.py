"""Powers below products of loads: Lade and Duncan's cone, and neighbours that are not convex or not shown to be."""

from __future__ import annotations

import pytest

from duhem import Criterion, verify
from duhem.law.domain import POSITIVE, Domain
from duhem.proof.certificate import law_as_text
from duhem.proof.kernel import region
from duhem.proof.kernel.stated_law import StatedLaw
from duhem.proof.verdict import Trust, Verdict
from tests.long import long_but
from tests.oracles.prover.curvature import convex_in_its_region as region_of
from tests.oracles.prover.decide import AskedSubject

LADE = "max(-x, -y, -z, (x + y + z)**3 - k*x*y*z)"
K = {"k": POSITIVE}

CASES = [
    (LADE, K, True),
    (LADE, {"k": Domain.between("-1", "60")}, False),
    (LADE.replace("-z, ", ""), K, False),  # z may be < 0
    (LADE.replace("**3", "**2"), K, False),  # three factors
    (LADE.replace("**3", "**4"), K, True),  # and a constant
    (LADE.replace("**3 - k*x*y*z", "**2 - k*x*y"), K, True),
    (LADE.replace("(x + y + z)**3", "(x - y)**3"), K, True),  # of either sign, below what is >= 0
    (LADE.replace("(x + y + z)**3", "(x - y)**4"), K, True),
    (LADE.replace("(x + y + z)**3", "(x**2 - y**2)**3"), K, False),
    (LADE.replace("(x + y + z)**3", "(x**2 - y)**4"), K, False),  # |u| is not convex
    (LADE.replace("x*y*z", "x*y*(z + x**2)"), K, False),  # a factor not concave
    (LADE.replace("x*y*z", "x*y*(z - 1)"), K, False),  # a factor that may be < 0
    (LADE.replace("x*y*z", "x*y*(z + 1)"), K, True),
]


def law(g: str, parameters: dict[str, Domain]) -> Criterion:
    return Criterion(name="law", g=g, forces=("x", "y", "z"), pressure=None, parameters=parameters)


@pytest.mark.slow
@pytest.mark.parametrize(("g", "parameters", "convex"), long_but([0, 2, 3, 6, 7, 10, 11], CASES))
def test_what_is_below_a_product(g: str, parameters: dict[str, Domain], convex: bool) -> None:
    stated = StatedLaw.read(law_as_text(law(g, parameters)))
    assert region.convex_in_its_region(stated) is convex
    subject = AskedSubject(law(g, parameters))
    subject.allow(20_000_000)
    assert region_of(subject).quasiconvex is convex


def test_it_is_proved_and_checked() -> None:
    found = verify(law(LADE, K), claims=["convexity"])["convexity"]
    assert (found.verdict, found.trust) == (Verdict.PROVED, Trust.CHECKED)


@pytest.mark.slow
def test_below_a_product_of_more_factors_than_the_power_it_is_not_convex() -> None:
    """Zero is in K, and what is near it on the way to any other point is not."""
    found = verify(law(LADE.replace("**3", "**2"), {"k": Domain.fixed("60")}), claims=["convexity"])["convexity"]
    assert found.verdict is Verdict.REFUTED
