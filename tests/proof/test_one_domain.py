"""A law has one domain, and what one rule shows of a term serves all: it is what a domain of nobody else would show."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import suppress
from fractions import Fraction
from itertools import pairwise
from typing import Any

import pytest

import duhem
from duhem.proof.certificate import law_as_text
from duhem.proof.kernel import certificate as kernel
from duhem.proof.kernel import signs
from duhem.proof.kernel.claims import objection, rules_of
from duhem.proof.kernel.curvature import over
from duhem.proof.kernel.definedness import Reader
from duhem.proof.kernel.deviatoric import DeviatoricReader
from duhem.proof.kernel.domain import ANY, NEGATIVE, POSITIVE, ZERO, StatedDomain
from duhem.proof.kernel.polynomial import Polynomial
from duhem.proof.kernel.signs import RAY
from duhem.proof.kernel.stated_law import StatedLaw
from duhem.proof.kernel.steps import TooDearError, within
from duhem.proof.kernel.term import NotWritten, Term, minus, parse
from tests.proof.small_laws import PARAMETERS, law

CLAIMS = ("origin", "convexity", "smoothness", "normality", "dissipation")
BEFORE = frozenset(CLAIMS)
J2 = "((a - b)**2 + a**2 + b**2)/6"
TEXTS = {
    "an ellipse": "sqrt(a**2 + a*b + m**2*b**2) - m*abs(s)",
    "of a deviator": f"sqrt({J2})*(1 + m*(a + b)*(2*a - b)*(2*b - a)/(2*sqrt({J2})**3 + where({J2} > 0, 0, 1))) - k*abs(s)",
    "of principal values": "max(a, b, 0) - min(a, b, 0) + m*sqrt(a**2 + b**2) - k",
    "guarded": "where(a > 0, a**2/(a + k), 0) + abs(b)*exp(m) - k*abs(s)",
    "of loads": "max(b**2 - k*sqrt(k*a + k**2)*k, -a - k)",
    "powers": "(abs(a)**3 + abs(b)**3)**(1/3)*exp(m) - abs(s)",
}


def rules(stated_law: StatedLaw) -> list[tuple[str, str]]:
    return [(claim, rule) for claim in CLAIMS for rule in rules_of(claim, stated_law)]


def asked(stated_law: StatedLaw, order: list[tuple[str, str]]) -> dict[tuple[str, str], str]:
    return {(claim, rule): objection(claim, rule, BEFORE, stated_law, {}) for claim, rule in order}


def remembered(stated_law: StatedLaw) -> dict[object, Any]:
    """All that was kept in the domains of a law, and of those that were made of it."""
    return dict(_remembered(stated_law, "", set()))


def _remembered(stated_law: StatedLaw, where: str, seen: set[int]) -> Iterator[tuple[object, Any]]:
    for (question, beside), found in list(getattr(stated_law, "_found", {}).items()):
        for i, one in enumerate(found if isinstance(found, tuple | list) else [found]):
            here = f"{where}/{getattr(question, '__name__', question)} {[x for x in beside if isinstance(x, str)]} {i}"
            if isinstance(one, StatedLaw) and id(one) not in seen:
                seen.add(id(one))
                yield from _remembered(one, here, seen)
            elif isinstance(one, StatedDomain):
                yield from _kept(one, here, seen)


def _kept(domain: StatedDomain, where: str, seen: set[int]) -> Iterator[tuple[object, Any]]:
    if id(domain) in seen:
        return
    seen.add(id(domain))
    for what in ("known", "_polynomials", "_spans", "_compared"):
        yield from (((where, what, term), found) for term, found in getattr(domain, what).items())
    for what, term, found in ((what, term, found) for what, own in domain.kept.items() for term, found in own.items()):
        if what == "deviators":
            yield from (((where, what, term, i, read), value) for i, reader in enumerate(found) for read, value in reader.known.items())
        elif isinstance(found, StatedDomain):
            yield from _kept(found, f"{where}/{what} {term}", seen)
        elif what not in ("guarded", "undecided"):
            yield (where, what, term), found


def half_known(text: str, cuts: int = 12) -> list[object]:
    """What is kept otherwise where the rules were interrupted somewhere than where they were not."""
    whole = law(text)
    with within(1 << 40) as purse:
        asked(whole, rules(whole))
    right, wrong = remembered(whole), list[object]()
    for i in range(cuts):
        cut = law(text)
        with suppress(TooDearError), within(purse.spent * (i + 1) // (cuts + 1)):
            asked(cut, rules(cut))
        wrong += [key for key, found in remembered(cut).items() if key not in right or right[key] != found]
    return wrong


@pytest.mark.parametrize("name", TEXTS)
def test_what_an_interrupted_rule_leaves_is_known(name: str) -> None:
    assert not half_known(TEXTS[name])


def test_what_is_left_half_known_would_be_seen(monkeypatch: pytest.MonkeyPatch) -> None:
    """A reader that notes None for a term while it reads it."""

    def noted(self: DeviatoricReader, term: Term) -> Any:
        if term not in self.known:
            self.known[term] = None
            with suppress(NotWritten):
                self.known[term] = self.shortened(self._read(self.replaced(term)))
        return self.known[term]

    monkeypatch.setattr(DeviatoricReader, "value", noted)
    assert half_known(TEXTS["of a deviator"], 30)


@pytest.mark.parametrize("name", TEXTS)
def test_in_whatever_order_rules_are_asked_each_says_what_it_says_alone(name: str) -> None:
    one, other = law(TEXTS[name]), law(TEXTS[name])
    said = asked(one, rules(one))
    assert said == asked(other, rules(other)[::-1])
    assert said == {rule: asked(law(TEXTS[name]), [rule])[rule] for rule in said}
    kept, again = remembered(one), remembered(other)
    assert all(kept[key] == again[key] for key in kept.keys() & again.keys())


@pytest.mark.parametrize("name", TEXTS)
def test_each_fact_is_that_of_a_domain_where_nothing_else_was_asked(name: str) -> None:
    one = law(TEXTS[name])
    asked(one, rules(one))
    domain = over(one)
    for term, known in [*domain.known.items()][::4]:
        assert StatedDomain(law(TEXTS[name]), domain.rules).facts(term) == known


def test_the_order_of_constants_does_not_depend_on_those_before() -> None:
    texts = [f"exp({x}) + exp({y}) - exp({z})" for x, y, z in (("m", "k", "e"), ("q", "-m", "k"), ("e", "q", "m"), ("2*m", "p", "m"))]
    one, other = law("a", parameters=PARAMETERS), law("a", parameters=PARAMETERS)
    forwards = [over(one).facts(parse(text)) for text in texts]
    assert forwards == [over(other).facts(parse(text)) for text in texts[::-1]][::-1]


def test_how_much_is_too_much_is_asked_of_each_question_alone(monkeypatch: pytest.MonkeyPatch) -> None:
    names = [Term("name", name=n) for n in ("m", "e", "q", "p", "k")]
    long: Polynomial = {((x, 1), (y, 1), *(((RAY, i),) if i else ())): Fraction(1) for i, (x, y) in enumerate(pairwise(names))}
    short: Polynomial = {((Term("name", name="m"), 1),): Fraction(1)}
    monkeypatch.setattr(signs, "_MOST_SHARES", 8)
    here = over(law("a", parameters=PARAMETERS))
    for _ in range(3):  # neither is the short question spoilt by the long one, nor is the long one answered bit by bit
        with pytest.raises(NotWritten, match="too much"):
            signs.nonnegative(long, (Fraction(0), Fraction(1)), here)
        assert signs.nonnegative(short, (Fraction(0), Fraction(1)), here, strict=True)


def test_what_is_shown_on_one_side_is_shown_there_alone() -> None:
    """A constant is what it is on either side, and is asked once."""
    here, a, b = over(law("a", parameters=PARAMETERS)), parse("a"), parse("b")
    inside = here.where({a: True})
    assert inside.facts(parse("a")).sign == POSITIVE and here.facts(a).sign == inside.facts(b).sign == ANY
    assert here.where({b: True}).facts(a).sign == ANY and here.where({minus(a): True}).facts(a).sign == NEGATIVE
    assert inside.where({b: False}).facts(parse("a + b")).sign == POSITIVE and inside.facts(parse("a + b")).sign == ANY
    assert inside is here.where({a: True}) is not here.where({a: False}) and here.where({a: False}).facts(a).sign == ZERO | POSITIVE
    assert inside.facts(parse("m*exp(q)")) is here.facts(parse("m*exp(q)")) and parse("m*exp(q)") not in inside.known


def test_what_holds_under_a_guard_holds_there_alone() -> None:
    """1/(q + p) has a value where q + p > 0, and p < 0 makes no law in which it has none."""
    one = law("where(m > 1, sqrt(m - 1), sqrt(1 - m))*abs(a) + sqrt(m - 1)*abs(b) - 1")
    reader, outer = Reader(over(one)), parse("sqrt(m - 1)")
    for _ in range(2):
        assert reader.undecided(parse("where(m > 1, sqrt(m - 1), sqrt(1 - m))")) is None
        assert reader.undecided(outer) == outer and not over(one).facts(outer).defined


def test_a_proof_that_fits_its_steps_by_what_was_shown_before_is_confirmed_from_scratch() -> None:
    known, rule = duhem.load("antoni2007"), ("smoothness", "composition")
    alone, after = (StatedLaw.read(law_as_text(known)) for _ in range(2))
    asked(after, [("convexity", "composition")])
    with within(5_000), pytest.raises(TooDearError):
        asked(alone, [rule])
    with within(5_000):
        assert not asked(after, [rule])[rule]
    verified = duhem.verify(known)
    again = kernel.recheck(verified.certificate())
    assert verified["smoothness"].method == rule[1] and all(row.confirmed for row in again)
