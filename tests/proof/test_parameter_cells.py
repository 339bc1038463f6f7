"""Cells of a parameter in the kernel: its numbers, laws over cells, and families of witnesses; what is wrong is refused."""

from __future__ import annotations

import random
from collections.abc import Sequence
from fractions import Fraction
from functools import reduce
from typing import Any

import numpy as np
import pytest
import sympy as sp

from duhem.law.catalogue import load
from duhem.proof.certificate import law_as_text
from duhem.proof.kernel.certificate import stated
from duhem.proof.kernel.domain import Bounds
from duhem.proof.kernel.parameter_tree import at_values, family_fails, law_where, own_domain, read_comparison, settled
from duhem.proof.kernel.polynomial import Polynomial, in_powers
from duhem.proof.kernel.signs import RAY, RealRoot, line, roots_between, sign_at
from duhem.proof.kernel.stated_law import StatedLaw
from duhem.proof.kernel.term import NotWritten
from duhem.regions.seen import value_of

FORM: dict[str, Any] = {"forces": ["q"], "pressure": None, "flow": None, "constraints": []}
ROOT_2 = RealRoot.read({"polynomial": ["-2", "0", "1"], "enclosure": ["1", "3/2"]})


def over(law: StatedLaw, *where: str) -> StatedLaw:
    """The law where comparisons hold."""
    return reduce(lambda here, text: law_where(here, read_comparison(text, [*law.parameters])), where, law)


def fails(claim: str, rule: str, law: StatedLaw, name: str, where: str, evidence: dict[str, Any]) -> str:
    return family_fails(claim, rule, over(law, *where.split(" and ")), [name], evidence)


def value(numbers: Sequence[Fraction | int], x: Fraction) -> Fraction:
    return reduce(lambda total, c: total * x + c, reversed(numbers), Fraction(0))


def law_named(name: str, **parameters: Any) -> StatedLaw:
    text = law_as_text(load(name))
    found = stated({**text, "parameters": {**text["parameters"], **parameters}})
    assert isinstance(found, StatedLaw)
    return found


@pytest.mark.parametrize("seed", range(5))
def test_a_polynomial_keeps_its_value_where_it_is_reduced(seed: int) -> None:
    draw = random.Random(seed)
    numbers = [draw.randrange(-9, 10) for _ in range(draw.randrange(3, 7))]
    poly: Polynomial = {((RAY, i),) if i else (): Fraction(c) for i, c in enumerate(numbers) if c}
    for plain in ((-2, 0, 1), (-1, -1, 0, 3), (1, 4, -6, -4, 1)):
        low, high = next(
            (Fraction(k, 8), Fraction(k + 1, 8))
            for k in range(-32, 32)
            if roots_between(line(map(Fraction, plain)), Fraction(k, 8), Fraction(k + 1, 8))
        )
        root = RealRoot(plain, low, high)
        left = in_powers(root.reduced(poly), RAY)
        assert len(left) < len(plain)
        for _ in range(60):  # towards the root, where both are the same
            middle = (low + high) / 2
            low, high = (middle, high) if sign_at(plain, low) == sign_at(plain, middle) else (low, middle)
        assert abs(value(numbers, low) - value([part.get((), 0) for part in left], low)) < Fraction(1, 10**12)


@pytest.mark.parametrize(
    "given",
    [
        {"polynomial": ["-2", "0", "1"], "enclosure": ["-2", "2"]},  # two roots, and no change of sign
        {"polynomial": ["0", "-2", "0", "1"], "enclosure": ["-2", "2"]},  # three
        {"polynomial": ["1", "0", "1"], "enclosure": ["-2", "2"]},
        {"polynomial": ["4", "-4", "1"], "enclosure": ["1", "3"]},  # a double one
        {"polynomial": ["-2", "0", "1"], "enclosure": ["3/2", "1"]},
        {"polynomial": ["-1", "2"], "enclosure": ["0", "1"]},
        {"value": "1/2", "polynomial": []},
    ],
)
def test_what_is_no_number_is_refused(given: dict[str, Any]) -> None:
    with pytest.raises(NotWritten):
        RealRoot.read(given)


def test_numbers_by_their_roots() -> None:
    assert [roots_between((-2, 0, 1), low, high) for low, high in ((None, None), (Fraction(0), None), (Fraction(-1), Fraction(1)))] == [
        2,
        1,
        0,
    ]
    assert roots_between((0, -1, 1), Fraction(0), Fraction(1)) == 0  # strictly between
    assert ROOT_2.reduced({((RAY, 2),): Fraction(1)}) == {(): Fraction(2)}


# -- laws over cells ---------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("where", "low", "high", "left_out"),
    [
        ("x >= 1 and x <= sqrt(2)", "1", "sqrt(2)", (False, False)),
        ("x > sqrt(2) and x < 1 + sqrt(5)/2", "sqrt(2)", "1 + sqrt(5)/2", (True, True)),
        ("x <= sqrt(3) and x < sqrt(2) and x > -7 and x > -sqrt(2)/2", "-sqrt(2)/2", "sqrt(2)", (True, True)),
        ("x >= sqrt(2)", "sqrt(2)", None, (False, False)),
        ("x < -sqrt(2)", None, "-sqrt(2)", (True, False)),
    ],
)
def test_an_end_that_is_no_fraction_is_reached_by_a_share(where: str, low: str, high: str, left_out: tuple[bool, bool]) -> None:
    law = StatedLaw.read({**FORM, "g": "x*q**2 - 1 + 0*y", "parameters": {"x": {}, "y": {}}, "constraints": ["x - y <= 1"]})
    done = settled(over(law, *where.split(" and ")), ["x"])
    bounds = done.parameters["share of x"]
    assert set(done.parameters) == {"share of x", "y"} and (bounds.open, bounds.open_high) == left_out and len(done.constraints) == 1
    number = {name: float(sp.sympify(end)) for name, end in (("low", low), ("high", high)) if end is not None}
    place = {"q": np.array([1.0]), "y": np.array([0.0])}
    for share in (0.0, 0.25, 1.0):
        x = value_of(done.g, {**place, "share of x": np.array([share])})[0] + 1
        ends = number.get("low"), number.get("high")
        expected = ends[1] - share if ends[0] is None else ends[0] + share if ends[1] is None else ends[0] + share * (ends[1] - ends[0])
        assert abs(x - expected) < 1e-12


def test_what_is_one_value_is_put_in_and_what_a_law_says_stays() -> None:
    law = StatedLaw.read({**FORM, "g": "x*q**2 - 1", "parameters": {"x": {"min": "0"}}, "constraints": ["x <= 2"]})
    assert settled(over(law, "x >= 1", "x <= 1"), ["x"]).parameters == {}
    assert settled(law, ["x"]) == law and settled(over(law, "x <= sqrt(2)"), []) == over(law, "x <= sqrt(2)")
    for wrong in ("x <= sqrt(-2)", "x <= 1/0", "x <= q", "x*q"):
        with pytest.raises((NotWritten, ArithmeticError)):
            read_comparison(wrong, ["x"])


def test_values_of_other_parameters_must_be_admitted() -> None:
    law = law_named("shifted-ellipse")
    put = over(law, "shift >= -2", "shift <= 2")
    for values in (
        {"mu_a": "1", "mu_b": "1"},
        {"mu_a": "-1"},
        {"mu_a": "0"},
        {"mu_a": "1/0"},
        {"mu_a": "mu_b", "mu_b": "mu_a"},
        {"k": "1"},
    ):
        with pytest.raises((NotWritten, ZeroDivisionError)):  # at shift = 2 the first does not hold |shift| < mu_a
            at_values(put, values, ["shift"])
    assert set(at_values(put, {"mu_a": "3", "mu_b": "1"}, ["shift"]).parameters) == {"shift"}


@pytest.mark.parametrize(
    ("constraint", "names", "left"),
    [
        ("x*x >= 2", [], True), ("x*x >= 2", ["x", "y"], True), ("x + y >= 2", ["x", "y"], True), ("x + y >= 2", [], None),
        ("x + y >= 2", ["x"], None), ("x >= z", ["x", "z"], None), ("x + z >= 0", [], False), ("x + z >= 1", ["x"], False),
    ],
)  # fmt: skip
def test_what_relates_what_is_left_is_assumed_of_a_region_alone(constraint: str, names: list[str], left: bool | None) -> None:
    """At z = 1, x and y being >= 0: None is refused, False is shown and goes."""
    ranges = {name: {"min": "0"} for name in ("x", "y", "z")}
    law = StatedLaw.read({**FORM, "g": "x*q**2 + y - z", "parameters": ranges, "constraints": [constraint]})
    if left is None:
        with pytest.raises(NotWritten):
            at_values(law, {"z": "1"}, names)
    else:
        assert at_values(law, {"z": "1"}, names).constraints == law.constraints * left


@pytest.mark.parametrize("relation", ["b**3 + a <= 1", "a + b**3 < 1", "a*exp(b) <= 1", "b**3 <= 1 - a**2"])
def test_one_value_to_which_a_relation_leaves_no_other_is_not_refuted(relation: str) -> None:
    """Two branches of a hyperbola: so it is for every a > 0, but where b >= 0 is left no value there is no law."""
    given = {"forces": ["q", "p"], "pressure": None, "flow": None, "g": "q**2 - a*p**2 - 1 + 0*b", "constraints": [relation]}
    law = StatedLaw.read({**given, "parameters": {"a": {"min": "0", "max": "2"}, "b": {"min": "0"}}})
    chord = {"p": {"q": "2", "p": "3"}, "q": {"q": "2", "p": "-3"}}
    for value in ("1/2", "3/2"):
        one = f"a >= {value} and a <= {value}"
        refused = [bool(fails("convexity", "chord", law, "a", one, {**chord, "values": b})) for b in ({}, {"b": "0"})]
        assert refused == [True, value == "3/2"]


def test_the_domain_of_a_parameter_is_by_range_and_constraints() -> None:
    assert own_domain(law_named("limacon"), "e") == Bounds(Fraction(0), Fraction(1), False, True)


# -- families of witnesses ---------------------------------------------------------------------------------------------

DENT = {"family": "gauge", "dent": "arc 1", "at": {"value": "0"}, "values": {"mu": "1"}}


@pytest.mark.parametrize(
    ("low", "left_out", "changed", "holds"),
    [
        ("1/2", True, {}, True),
        ("1/2", False, {}, False),
        ("499999999999/1000000000000", True, {}, False),
        ("1/2", True, {"at": {"value": "1/100"}}, False),
        ("1/2", True, {"dent": "arc 0"}, False),
        ("1/2", True, {"values": {"mu": "0"}}, False),
        ("1/2", True, {"values": {"e": "3/4"}}, False),
        ("1/2", True, {"more": 1}, False),
    ],
)
def test_a_dent_must_be_there_for_every_value(low: str, left_out: bool, changed: dict[str, Any], holds: bool) -> None:
    said = fails("convexity", "dent", law_named("limacon"), "e", f"e >{'' if left_out else '='} {low}", {**DENT, **changed})
    assert (said == "") is holds


def test_dents_at_algebraic_places() -> None:
    place = {"polynomial": ["-1", "2", "1"], "enclosure": ["470832/1136689", "665857/1607521"]}
    evidence = {"family": "gauge", "dent": "arc 0", "at": place, "values": {"mu": "1"}}
    quartic = law_named("quartic")
    assert fails("convexity", "dent", quartic, "c", "c > 6", evidence) == ""
    assert fails("convexity", "dent", quartic, "c", "c > 5", evidence)
    assert fails("convexity", "dent", quartic, "c", "c >= 6", evidence)
    assert fails("smoothness", "dent", quartic, "c", "c > 6", evidence)


def test_lines_and_points() -> None:
    form: dict[str, Any] = {
        "name": "form",
        "forces": ["x", "y"],
        "pressure": None,
        "constraints": [],
        "flow": None,
        "parameters": {"b": {}},
    }
    law = stated({**form, "g": "x**2 + b*x*y + y**2 - 1"})
    assert isinstance(law, StatedLaw)
    evidence = {"through": {"x": "2", "y": "2"}, "along": {"x": "1", "y": "-1"}}
    for low, open_ in (("2", False), ("1", True)):
        assert bool(fails("convexity", "line", law, "b", f"b > {low}", evidence)) is open_
    inside = {**evidence, "through": {"x": "0", "y": "0"}}
    assert fails("convexity", "line", law, "b", "b > 2", inside)
    flat = stated({**form, "flow": ["b*x", "y"], "g": "x**2 + y**2 - k", "parameters": {"b": {}, "k": {"positive": True, "max": None}}})
    assert isinstance(flat, StatedLaw)
    point = {"point": {"x": "1"}, "scale": "k"}
    assert fails("dissipation", "point", flat, "b", "b < 0", point) == ""
    assert fails("dissipation", "point", flat, "b", "b <= 0", point)
    assert fails("dissipation", "point", flat, "b", "b < 0", {"point": {"x": "1"}, "values": {"k": "2"}})
    assert fails("dissipation", "point", flat, "b", "b < 0", {"point": {"y": "1"}, "scale": "k"})
    assert fails("dissipation", "point", flat, "k", "k > 0", {**point, "values": {"b": "-1"}})


def test_chords() -> None:
    law, here = law_named("limacon"), "e >= 3/5 and e <= 3/5"
    p, q = ({"sigma_a": "-41/100", "sigma_b": b} for b in ("13/50", "-13/50"))
    evidence = {"p": p, "q": q, "values": {"mu": "1"}, "pressure": "-1"}
    assert fails("convexity", "chord", law, "e", here, evidence) == ""
    assert fails("convexity", "chord", law, "e", "e >= 3/5", evidence)
    others: list[dict[str, Any]] = [{"pressure": "1"}, {"pressure": "-2"}, {"q": p}, {"q": {}}, {"p": {"sigma_a": "-mu"}}]
    for changed in others:
        assert fails("convexity", "chord", law, "e", here, {**evidence, **changed})


def test_a_family_leaves_the_parameter_free() -> None:
    """At one value of the parameter alone a witness says nothing of the others, by whatever name that is fixed."""
    apart, dent = law_named("matchstick", mu_b={"value": "1"}), {"family": "gauge", "dent": "arc 0", "at": {"value": "-1"}}
    for where in ("mu_a >= 1 and mu_a <= 3", "mu_a >= 1 and mu_a <= sqrt(10)", "mu_a >= 3 and mu_a <= 3"):
        for values in ({"mu_a": "3"}, {"share of mu_a": "1"}):
            assert fails("convexity", "dent", apart, "mu_a", where, {**dent, "values": values})
    for where in ("mu_a > sqrt(2)", "mu_a > sqrt(2) and mu_a <= sqrt(10)", "mu_a >= 3 and mu_a <= 3"):
        assert fails("convexity", "dent", apart, "mu_a", where, {**dent, "values": {}}) == ""
    assert fails("convexity", "dent", apart, "mu_a", "mu_a >= sqrt(2)", {**dent, "values": {}})
