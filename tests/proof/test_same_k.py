"""Forms of g with the same K: of the same sign as g wherever g has a value in the ranges, and tried, so that an open claim is decided."""

from __future__ import annotations

from contextlib import suppress
from random import Random

import pytest

from duhem import Criterion, Verdict
from duhem.law.domain import POSITIVE, Domain
from duhem.proof.certificate import law_as_text
from duhem.proof.kernel.stated_law import StatedLaw
from duhem.proof.kernel.term import number, parse
from duhem.proof.unsettled.forms import same_k
from duhem.proof.unsettled.limits import times
from duhem.proof.unsettled.term_text import in_text
from duhem.proof.verification import verdict_within
from tests.oracles import drawn_formulas
from tests.proof.test_open_claims import changed, opened

LOADS = {"p": Domain.between(0), "q": Domain.between(0)}
SOME = {"m": POSITIVE, "c": POSITIVE, "n": Domain.between("1/2", 3), "b": Domain.between(-1, 1)}


def loaded(g: str, **domain: Domain) -> Criterion:
    used = {name: own for name, own in SOME.items() if name in parse(g).names()}
    return Criterion("loaded", g, used, ("p", "q"), None, domain=domain or LOADS)


# g, and whether forms are found
FORMS = [
    ("log(p/c) + log(1 + q**2/(m**2*p**2)) - n", 2),
    ("m*log(p/c) + q - m*n", 1),
    ("2*log(c + p) - log(c + q) + b", 1),
    ("q - m*p*(1 + log(c/p))", 0),
    ("q - m*p*log(c/p**2)", 0),
    ("-log(c/(p*q)) + b", 1),
    ("q - m*sqrt(p)", 0),
    ("q + c - m*(p + c)**(2/3)", 0),
    ("q/(c + m*p) + p**2 - 1", 1),
    ("(q - b*p)**2 - (c - q/p*b)*p**2*(1 - p*m)", 1),
    ("p*q - p*m + p*q/(c + p)", 1),  # 0 along p = 0, where it has a value
    ("q**2/(c - m*p)**2 + p**2 - 1", 1),
    ("q/p - m + p", 1),
    ("b*log(p/c) + q - 1", 0),  # the sign of b is open
    ("b*sqrt(p) + q - 1", 0),
    ("q - 1 - m*sqrt(p)", 0),  # the left side may be < 0
    ("q/(c - p) - 1", 0),  # what it divides by may be < 0
    ("p**2 + q**2 - 1", 0),
]  # fmt: skip


@pytest.mark.parametrize(("g", "least"), FORMS)
def test_a_form_has_the_sign_of_g_wherever_g_has_a_value(g: str, least: int) -> None:
    law = loaded(g)
    term, forms, draw = parse(g), same_k(StatedLaw.read(law_as_text(law))), Random(g)
    assert len(forms) >= least and (least or not forms)
    compared = 0
    for _ in range(400):
        at = {name: draw.choice((0.0, draw.uniform(0, 1), draw.uniform(0, 5))) for name in "pq"}
        at |= {"m": draw.uniform(0.1, 3), "c": draw.uniform(0.1, 3), "n": draw.uniform(0.5, 3), "b": draw.uniform(-1, 1)}
        with suppress(ValueError, OverflowError, ZeroDivisionError):
            here = drawn_formulas.value(term, at)
            for form in forms:
                assert in_text(parse(in_text(form, {})), {}) == in_text(form, {})
                value = drawn_formulas.value(form, at)
                assert min(abs(here), abs(value)) < 1e-9 or (here > 0) is (value > 0), (in_text(form, {}), at, here, value)
                compared += 1
    assert compared > 100 or not forms


def test_what_a_product_has_of_a_size_stays_when_it_is_multiplied_by_it() -> None:
    g = parse("p**2*(m - q/p) + q")
    form, at = times(g, parse("p"), number(1)), {"p": 2.0, "q": 3.0, "m": 0.5}
    assert drawn_formulas.value(form, at) == pytest.approx(2 * drawn_formulas.value(g, at))


# g, ranges, claim: open as it is written, and decided of the form that is suggested
DECIDED: list[tuple[str, dict[str, Domain], str]] = [
    ("log(p/c) + log(1 + q**2/(m**2*p**2)) - n", LOADS, "convexity"),
    ("log(p/c) + log(1 + q**2/(m**2*p**2)) - n", LOADS, "normality"),
]  # fmt: skip


@pytest.mark.parametrize(("g", "domain", "claim"), DECIDED)
def test_a_form_is_suggested_that_decides_the_claim(g: str, domain: dict[str, Domain], claim: str) -> None:
    law = loaded(g, **domain)
    action = next(action for action in opened(law, claim).actions if action.startswith("write g = "))
    assert verdict_within(changed(law, action), claim, 3_000_000) is Verdict.PROVED
