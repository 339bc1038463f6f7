"""Cells of a parameter in the kernel: its numbers, laws over cells, and families of witnesses; what is wrong is refused."""

from __future__ import annotations

import random
from collections.abc import Sequence
from fractions import Fraction
from functools import reduce
from typing import Any

import pytest

from duhem.law.catalogue import load
from duhem.proof.certificate import law_as_text
from duhem.proof.kernel.certificate import stated
from duhem.proof.kernel.domain import Bounds
from duhem.proof.kernel.parameter_cells import ParameterCell, at_values, covers, law_over, own_domain, refutation_fails
from duhem.proof.kernel.polynomial import Polynomial, in_powers
from duhem.proof.kernel.real_root import RealRoot
from duhem.proof.kernel.signs import RAY, line, roots_between, sign_at
from duhem.proof.kernel.stated_law import StatedLaw
from duhem.proof.kernel.term import NotWritten

ROOT_2 = RealRoot.read({"polynomial": ["-2", "0", "1"], "enclosure": ["1", "3/2"]})


def at(x: str) -> RealRoot:
    return RealRoot.of(Fraction(x))


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


def test_the_sign_of_a_polynomial_holds_on_its_cell_alone() -> None:
    law = law_named("matchstick", mu_b={"value": "1"})
    put, _ = law_over(law, "mu_a", ParameterCell(at("1"), ROOT_2), "sign")
    assert put.constraints[-1].op == ">="
    put, _ = law_over(law, "mu_a", ParameterCell(at("1"), ROOT_2, False, True), "sign")
    assert put.constraints[-1].op == ">"
    other = RealRoot.read({"polynomial": ["-2", "0", "1"], "enclosure": ["-3/2", "-1"]})
    put, _ = law_over(law, "mu_a", ParameterCell(other, ROOT_2, True, False), "sign")
    assert [c.op for c in put.constraints[-2:]] == [">=", ">="]  # a sharp one would leave out the end that belongs to it
    wild = RealRoot.read({"polynomial": ["-2", "0", "3", "0", "-1"], "enclosure": ["5/4", "3/2"]})  # of (x^2 - 1)(2 - x^2)
    with pytest.raises(NotWritten, match="root inside"):
        law_over(law, "mu_a", ParameterCell(at("1/2"), wild), "sign")
    with pytest.raises(NotWritten):
        law_over(law, "mu_a", ParameterCell(at("1"), ROOT_2), "range")


def test_values_of_other_parameters_must_be_admitted() -> None:
    law = law_named("shifted-ellipse")
    put, _ = law_over(law, "shift", ParameterCell(at("-2"), at("2")), "range")
    for values in (
        {"mu_a": "1", "mu_b": "1"},
        {"mu_a": "-1"},
        {"mu_a": "0"},
        {"mu_a": "1/0"},
        {"mu_a": "mu_b", "mu_b": "mu_a"},
        {"k": "1"},
    ):
        with pytest.raises((NotWritten, ZeroDivisionError)):  # at shift = 2 the first does not hold |shift| < mu_a
            at_values(put, values, {})
    assert set(at_values(put, {"mu_a": "3", "mu_b": "1"}, {}).parameters) == {"shift"}


@pytest.mark.parametrize("relation", ["b**3 + a <= 1", "a + b**3 < 1", "a*exp(b) <= 1", "b**3 <= 1 - a**2"])
def test_one_value_to_which_a_relation_leaves_no_other_is_not_refuted(relation: str) -> None:
    """Two branches of a hyperbola: so it is for every a > 0, but where b >= 0 is left no value there is no law."""
    given = {"forces": ["q", "p"], "pressure": None, "flow": None, "g": "q**2 - a*p**2 - 1 + 0*b", "constraints": [relation]}
    law = StatedLaw.read({**given, "parameters": {"a": {"min": "0", "max": "2"}, "b": {"min": "0"}}})
    chord = {"p": {"q": "2", "p": "3"}, "q": {"q": "2", "p": "-3"}}
    for value in ("1/2", "3/2"):
        one = ParameterCell(at(value), at(value))
        refused = [bool(refutation_fails("convexity", "chord", law, "a", one, "range", {**chord, "values": b})) for b in ({}, {"b": "0"})]
        assert refused == [True, value == "3/2"]


def test_cells_must_cover_the_domain() -> None:
    half, whole = at("1/2"), Bounds(Fraction(0), Fraction(1), False, True)
    low, high = ParameterCell(at("0"), half), ParameterCell(half, at("1"), True, True)
    assert covers(whole, [low, high])
    assert not covers(whole, [low._replace(open_high=True), high])
    assert not covers(whole, [low, high._replace(low=at("3/4"))])
    assert not covers(whole, [low._replace(open=True), high])
    assert not covers(Bounds(Fraction(0), Fraction(1)), [low, high])
    assert not covers(whole, [high, low]) and not covers(whole, [])
    assert own_domain(law_named("limacon"), "e") == whole


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
        ("1/2", True, {"section": {"sigma_a": "x"}}, False),
        ("1/2", True, {"section": {"sigma_a": "x + 1", "sigma_b": "y"}}, False),
        ("1/2", True, {"section": {"sigma_a": "-x", "sigma_b": "y"}}, False),
        ("1/2", True, {"section": {"sigma_a": "-x", "sigma_b": "y"}, "dent": "arc 0"}, True),
    ],
)
def test_a_dent_must_be_there_for_every_value(low: str, left_out: bool, changed: dict[str, Any], holds: bool) -> None:
    cell = ParameterCell(at(low), at("1"), left_out, True)
    said = refutation_fails("convexity", "dent", law_named("limacon"), "e", cell, "range", {**DENT, **changed})
    assert (said == "") is holds


def test_dents_at_algebraic_places() -> None:
    cell = ParameterCell(at("6"), None, True)
    place = {"polynomial": ["-1", "2", "1"], "enclosure": ["470832/1136689", "665857/1607521"]}
    evidence = {"family": "gauge", "dent": "arc 0", "at": place, "values": {"mu": "1"}}
    quartic = law_named("quartic")
    assert refutation_fails("convexity", "dent", quartic, "c", cell, "range", evidence) == ""
    assert refutation_fails("convexity", "dent", quartic, "c", cell._replace(low=at("5")), "range", evidence)
    assert refutation_fails("convexity", "dent", quartic, "c", cell._replace(open=False), "range", evidence)
    assert refutation_fails("smoothness", "dent", quartic, "c", cell, "range", evidence)


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
    for low, fails in (("2", False), ("1", True)):
        assert bool(refutation_fails("convexity", "line", law, "b", ParameterCell(at(low), None, True), "range", evidence)) is fails
    inside = {**evidence, "through": {"x": "0", "y": "0"}}
    assert refutation_fails("convexity", "line", law, "b", ParameterCell(at("2"), None, True), "range", inside)
    flat = stated({**form, "flow": ["b*x", "y"], "g": "x**2 + y**2 - k", "parameters": {"b": {}, "k": {"positive": True, "max": None}}})
    assert isinstance(flat, StatedLaw)
    below = ParameterCell(None, at("0"), False, True)
    point = {"point": {"x": "1"}, "scale": "k"}
    assert refutation_fails("dissipation", "point", flat, "b", below, "range", point) == ""
    assert refutation_fails("dissipation", "point", flat, "b", ParameterCell(None, at("0")), "range", point)
    assert refutation_fails("dissipation", "point", flat, "b", below, "range", {"point": {"x": "1"}, "values": {"k": "2"}})
    assert refutation_fails("dissipation", "point", flat, "b", below, "range", {"point": {"y": "1"}, "scale": "k"})
    assert refutation_fails(
        "dissipation", "point", flat, "k", ParameterCell(at("0"), None, True), "range", {**point, "values": {"b": "-1"}}
    )


def test_chords() -> None:
    law, cell = law_named("limacon"), ParameterCell(at("3/5"), at("1"), False, True)
    p, q = ({"sigma_a": "-41/100", "sigma_b": b} for b in ("13/50", "-13/50"))
    evidence = {"p": p, "q": q, "values": {"mu": "1"}, "pressure": "-1"}
    here = ParameterCell(at("3/5"), at("3/5"))
    assert refutation_fails("convexity", "chord", law, "e", here, "range", evidence) == ""
    assert refutation_fails("convexity", "chord", law, "e", cell, "range", evidence)
    others: list[dict[str, Any]] = [{"pressure": "1"}, {"pressure": "-2"}, {"q": p}, {"q": {}}, {"p": {"sigma_a": "-mu"}}]
    for changed in others:
        assert refutation_fails("convexity", "chord", law, "e", here, "range", {**evidence, **changed})


def test_a_family_leaves_the_parameter_free() -> None:
    """At one value of the parameter alone a witness says nothing of the others, by whatever name that is fixed."""
    apart, cell = law_named("matchstick", mu_b={"value": "1"}), ParameterCell(at("1"), at("3"))
    for way, name in (("range", "mu_a"), ("share", "mu_a"), ("share", "share of the cell")):
        evidence = {"family": "gauge", "dent": "arc 0", "at": {"value": "-1"}, "values": {name: "1" if way == "share" else "3"}}
        assert refutation_fails("convexity", "dent", apart, "mu_a", cell, way, evidence)
    evidence["values"] = {}
    assert refutation_fails("convexity", "dent", apart, "mu_a", ParameterCell(at("2"), at("3")), "share", evidence) == ""
