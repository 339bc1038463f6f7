"""Places where a small fault in the kernel would not show in the laws that are known: each is looked at by itself."""

from __future__ import annotations

import math
from collections.abc import Mapping
from fractions import Fraction
from itertools import pairwise
from random import Random
from typing import Any

import pytest

from duhem.proof.kernel.curvature import over
from duhem.proof.kernel.domain import StatedDomain
from duhem.proof.kernel.plane_function import PlaneFunction
from duhem.proof.kernel.plane_gauge import arcs
from duhem.proof.kernel.signs import RAY, nonnegative, without_content
from duhem.proof.kernel.stated_law import StatedLaw
from duhem.proof.kernel.term import NotWritten, Term, number, parse
from tests.oracles import drawn_formulas

F = Fraction


def domain(*constraints: str, **parameters: Mapping[str, Any]) -> StatedDomain:
    law = {"forces": ("a", "b"), "pressure": "s", "parameters": parameters, "constraints": list(constraints), "g": "a", "flow": None}
    return over(StatedLaw.read(law))


# -- curvature ---------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("text", ["a**b", "pos(a)**b", "abs(a)**a", "norm(a, b)**b", "neg(a)**(b**2)", "(a*b)**a"])
def test_a_power_that_varies_needs_a_base_above_zero(text: str) -> None:
    assert not domain().facts(parse(text)).defined
    assert domain().facts(parse(f"(1 + abs({text.split('**')[0]}))**b")).defined


@pytest.mark.parametrize(
    "text",
    [
        "sqrt((abs(a)**(1/2))**2 + b**2)", "sqrt(min(abs(a), abs(b))**2 + 1)", "(pos(a)**3 - abs(b)**3)**(1/3)", "sqrt((a*b)**2 + b**2)",
        "sqrt((1 - norm(a, b))**2 + b**2)", "(abs(a)**3 + abs(b)**2)**(1/3)", "(abs(a)**(1/2) + abs(b)**(1/2))**2",
    ],
)  # fmt: skip
def test_what_is_no_norm_of_convex_sizes_is_not_convex(text: str) -> None:
    assert not domain().facts(parse(text)).convex


@pytest.mark.parametrize("text", ["abs(a)**q", "norm(a, b)**q", "norm(a, b)**(3/2)", "exp(norm(a, b))**q", "(pos(a) + neg(b))**(q + 1)"])
def test_a_power_of_one_or_more_keeps_what_is_convex(text: str) -> None:
    assert domain(q={"min": "1", "max": "3"}).facts(parse(text)).convex
    assert "q" not in text or "+ 1" in text or not domain(q={"min": "999/1000", "max": "3"}).facts(parse(text)).convex


# -- constants -----------------------------------------------------------------------------------------------------------


def test_a_constant_that_may_be_zero_is_not_divided_out() -> None:
    for text, allowed in (("q**(-1)*b0", False), ("q**(-2)*b0", False), ("m**(-1)*b0", True), ("m**(-3)*b0", True)):
        here = domain(q={"min": "-1", "max": "1"}, m={"positive": True}, b0={})
        poly = here.polynomial(parse(text))
        if allowed:
            assert without_content(poly, here) == here.polynomial(parse("b0"))
        else:
            with pytest.raises(NotWritten):
                without_content(poly, here)


@pytest.mark.parametrize(
    ("text", "holds"),
    [
        ("sin(q)", False), ("-sin(q)", False), ("1 + sin(q)", True), ("sin(q)**2", True), ("exp(q)", True), ("-exp(q)", False),
        ("q", False), ("exp(q)*q**2", True), ("cos(q) + 2", True), ("tanh(q)", False), ("-tanh(q)", False), ("tanh(m)", True),
        ("-tanh(m)", False), ("log(2 + m)", True), ("m - exp(q)", False), ("exp(q) - m", False),
    ],
)  # fmt: skip
def test_a_constant_reaches_as_far_as_its_sign_says(text: str, holds: bool) -> None:
    """A question on the line whose only other variable is a constant of known or unknown sign."""
    here = domain(q={"min": "-2", "max": "2"}, m={"positive": True}, t2={"min": "0"})
    for asked in (text, f"({text})*m", f"({text})*t2"):
        poly = here.polynomial(parse(asked))
        along = {tuple(sorted((RAY, 2) if x.name == "t2" else (x, n) for x, n in m)): c for m, c in poly.items()}
        try:
            assert holds or not nonnegative(along, (F(-1), F(1)), here)
        except NotWritten:
            continue


@pytest.mark.parametrize(
    ("text", "above", "strict"),
    [
        ("abs(q)", True, False), ("-abs(q)", False, False), ("abs(q) + 1", True, True), ("sqrt(t)", True, False),
        ("sqrt(t) + 1", True, True), ("tanh(t)", True, False), ("tanh(m)", True, True), ("exp(q)", True, True),
        ("tanh(t) + abs(q)", True, False), ("sqrt(m)", True, True), ("-sqrt(t) - 1", False, False),
    ],
)  # fmt: skip
def test_a_constant_that_may_be_zero_is_an_end(text: str, above: bool, strict: bool) -> None:
    here = domain(q={"min": "-2", "max": "2"}, m={"positive": True}, t={"min": "0"})
    poly = here.polynomial(parse(text))
    found = [nonnegative(poly, (F(-1), F(1)), here, sharply) for sharply in (False, True)]
    assert found == [above, strict]
    assert [nonnegative({m: -c for m, c in poly.items()}, (F(-1), F(1)), here, sharply) for sharply in (False, True)][1] is (
        text == "-sqrt(t) - 1"
    )


# -- along the rays --------------------------------------------------------------------------------------------------------


def drawn(rng: Random, depth: int) -> str:
    if depth == 0:
        return rng.choice(("a", "b", "a + b", "a - 2*b", "-a", "3*b", "a - b/2"))
    one, two = (f"({drawn(rng, depth - 1)})" for _ in range(2))
    return rng.choice((
        f"abs{one}", f"pos{one}", f"neg{one}", f"norm{one}", f"norm({one}, {two})", f"max({one}, {two})", f"min({one}, {two})",
        f"{one} + {two}", f"{one} - {two}", f"{one}*{two}", f"{one}**2", f"{one}**3", f"-2*{one}", f"where({one} > 0, {one}, {two})",
        f"where({one} <= {two}, {two}, 0)", f"norm({one}, 0)", f"norm(0, {one}, {two})",
    ))  # fmt: skip


def value(found: PlaneFunction, t: float) -> float:
    def of(poly: Any) -> float:
        return sum(float(c) * math.prod(t**n for _, n in m) for m, c in (poly.items() if isinstance(poly, dict) else poly))

    return of(found.poly) * math.prod(of(base) ** float(n[()]) for base, n in found.powers.items())


@pytest.mark.slow
def test_a_formula_along_a_ray_has_the_formula_s_value() -> None:
    rng, here, compared = Random(5), domain(), 0
    for _ in range(150):
        text = drawn(rng, rng.choice((1, 2, 2, 3)))
        term: Term = parse(text)
        try:
            sides = list(arcs(term, ("a", "b"), here))
        except NotWritten:
            continue
        compared += _compared(term, sides)
    assert compared > 500


@pytest.mark.parametrize(
    "text",
    [
        "abs(a) + 2*pos(b) - neg(a - b)", "norm(a, b)*(2 + a/norm(a, b))", "norm(a, 0)", "norm(0, a - b, 0)", "norm(a, b, a + b)**3",
        "max(a, b, -a)",
        "min(a, 2*b, a + b)", "(a**2 + b**2)**(3/2) - norm(a, b)**3/2", "(abs(a)**3 + abs(b)**3 + norm(a, b)**3)**(1/3)",
        "a**2/norm(a, b) + b",
        "(2*norm(a, b) + a)**(1/2)*(2*norm(a, b) + a)**(1/2)", "(2*norm(a, b) + a)**(3/2) + (2*norm(a, b) + a)**(1/2)*b",
        "where(a > 0, a, b)",
        "where(4*a <= 3*b, norm(a, b), a)", "where(a >= 0, where(b < 0, 1, 2)*a, 3*a)", "max(norm(a, b), 2*abs(a) + b/2)", "abs(a*b)*a",
        "max(a**2, b**2)*norm(a, b)**-1",
        "min(norm(a, b), (a**2 + 3*b**2)**(1/2))", "max(norm(a, 2*b), norm(2*a, b))", "pos(a)*neg(b) + 3",
        "(a**2 + b**2 + a*b)**(-1/2)*(a - b)",
    ],
)  # fmt: skip
def test_a_formula_along_the_rays(text: str) -> None:
    here, term = domain(), parse(text)
    sides = list(arcs(term, ("a", "b"), here))
    assert [side[0][0].side for side in sides] == [1, -1]
    for side in sides:  # all of it, arc by arc
        ends = [arc for arc, _ in side if not arc.single]
        assert ends[0].start == (-1, -1) and ends[-1].stop == (1, 1)
        assert all(one.stop == two.start for one, two in pairwise(ends))
    assert _compared(term, sides) >= 6


def _compared(term: Term, sides: list[Any]) -> int:
    """At how many places the values along the rays were held against the formula's."""
    compared = 0
    for arc, found in (pair for side in sides for pair in side):
        for share in (0.21, 0.5, 0.83):
            t = float(arc.start[1]) + share * float(arc.stop[0] - arc.start[1])
            at = {"a": arc.side * (1 - t * t), "b": arc.side * 2 * t}
            assert sum(value(part, t) for part in found.values()) == pytest.approx(_honest(term, at), rel=1e-9, abs=1e-9), (term, at)
            compared += 1
    return compared


def _honest(term: Term, at: Mapping[str, float]) -> float:
    """The value, branches of ``where`` chosen here."""
    if term.op == "where":
        condition, then, otherwise = term.args
        left, right = (_honest(x, at) for x in condition.args)
        gap = 0.0 if math.isclose(left, right, abs_tol=1e-12) else left - right
        holds = {"<": gap < 0, "<=": gap <= 0, ">": gap > 0, ">=": gap >= 0}[condition.op]
        return _honest(then if holds else otherwise, at)
    if term.op in ("number", "name"):
        return drawn_formulas.value(term, at)
    return drawn_formulas.value(term._replace(args=tuple(number(F(_honest(x, at))) for x in term.args)), at)
