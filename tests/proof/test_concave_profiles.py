"""Products along a load, bodies below them, and powers that are not counted: what is proved holds at many chords, and mutants stay open."""

from __future__ import annotations

import re
from random import Random

import numpy as np
import pytest

from duhem import Criterion, verify
from duhem.expression.numpy_ import evaluate
from duhem.law.domain import POSITIVE, Domain
from duhem.proof.certificate import law_as_text
from duhem.proof.kernel.certificate import stated
from duhem.proof.kernel.claims import objection
from tests.campaigns import profiles
from tests.long import mostly_long

ABOVE = {"p": Domain.between(0, None)}
AT_LEAST_0, AT_LEAST_1, ANY = Domain.between(0, None), Domain.between(1, None), Domain()
CAP = "(q - a*p)**2 - M**2*p**2*(1 - (p/c)**n)"  # Taiebat, Dafalias (2008), with n = 20
FOOTING = "max(norm(q, t) - M*p*pos(1 - p/c)**0.95, p - c)"  # Nova, Montrasio (1991)
SHEAR = "abs(q) - M*p*(1 - b*log(p/c))"  # Hujeux (1985)
CASM = "(abs(q)/(M*p))**n + log(p/c)"  # Yu (1998)
CUBIC = "max(q**2 - p*(c - p)*(c + h*p), p - c, -p)"
CLOSED = "max(abs(q) + where(p > 0, M*p*log(p/c), 0), -p)"
SPREAD = "(max(q, p) - min(p, t))**n - c"
UNIT = "pos(q) + a*(exp(-neg(q)) - 1) + abs(p) - c"  # the exponential linear unit of networks
OF_SQUARES = "pos(q**2 + p**2 - c) + exp(-neg(q**2 + p**2 - c)/2)*2 - 3"

CONVEX = [
    (CAP, {"n": AT_LEAST_1}, ABOVE),
    (CAP, {"n": AT_LEAST_0}, ABOVE),
    (CAP.replace("**n", "**20"), {}, ABOVE),
    (CAP.replace("- M", "+ t**2 - M"), {"n": AT_LEAST_0}, ABOVE),
    ("max(abs(q) - M*p*sqrt(1 - (p/c)**n), p - c, -p)", {"n": AT_LEAST_1}, {}),
    ("max(abs(q) - M*p*(1 - (p/c)**n)**b, p - c, -p)", {"n": AT_LEAST_1, "b": Domain.between("1/10", 1)}, {}),
    (FOOTING, {}, {}),
    (FOOTING.replace("0.95", "b"), {"b": Domain.between("1/10", 1)}, {}),
    (SHEAR, {"b": POSITIVE}, ABOVE),
    (SHEAR, {"b": POSITIVE}, {}),
    ("max(abs(q) + M*(c + p)*exp(p) - 10*c, -p)", {}, {}),
    ("max(abs(q) + M*(c - p)*exp(-p) - 10*c, p, -c - p)", {}, {}),
    ("q**2 + M**2*p**2*log(p/c)", {}, ABOVE),
    (CASM, {"n": AT_LEAST_1}, ABOVE),
    (CUBIC, {"h": Domain.between("-9/10", 3)}, {}),
    ("max(q**2 - p**2*(c - p)**2*(2 + h), p - c, -p)", {"h": Domain.between(0, 1)}, {}),
    ("c - exp(-(q**2) - p**2)", {}, {}),
    ("-tanh(c - abs(q) - p**2)", {}, {}),
    (CLOSED, {}, {}),
    (CLOSED.replace("log(p/c)", "(2 + log(p/c))"), {}, {}),
    (SPREAD, {"n": AT_LEAST_1}, {}),
    (SPREAD.replace("(max", "(abs(p) + max"), {"n": AT_LEAST_1}, {}),
    (UNIT, {"a": Domain.between(0, 1)}, {}),
    (UNIT.replace("abs(p)", "pos(q) + pos(p) + exp(-neg(q)) + exp(-neg(p)/2)*3/2"), {"a": Domain.between(0, 1)}, {}),
    (OF_SQUARES, {}, {}),
]  # fmt: skip
OPEN = [
    (CAP, {"n": Domain.between(-1, None)}, ABOVE),
    (CAP, {"n": AT_LEAST_0}, {}),
    (CAP.replace("- M", "- t**2 - M"), {"n": AT_LEAST_0}, ABOVE),
    (CAP.replace("1 - (p/c)**n", "(p/c)**n - 1"), {"n": AT_LEAST_0}, ABOVE),
    (CAP.replace("*p**2*", "*p**3*"), {"n": AT_LEAST_0}, ABOVE),
    (CAP.replace("*p**2*", "*(p - 1)**2*"), {"n": AT_LEAST_0}, ABOVE),
    (CAP.replace("- a*p", "- a*p**2"), {"n": AT_LEAST_0}, ABOVE),
    (CAP.replace("**n", "**20"), {}, {}),  # two drops
    (FOOTING.replace("0.95", "1.05"), {}, {}),
    (FOOTING.replace("*p*", "*p**2*"), {}, {}),
    (FOOTING.replace(", p - c", ", p + t - c"), {}, {}),
    (FOOTING.replace("pos(1 - p/c)", "pos(b*(1 - p/c))"), {"b": Domain.between(0, 1)}, {}),  # for b = 0 nothing bounds p from below
    (SHEAR.replace("- b", "+ b"), {"b": POSITIVE}, ABOVE),
    (SHEAR.replace("log(p/c)", "log(p/c)**2"), {"b": POSITIVE}, ABOVE),
    (SHEAR, {"b": ANY}, ABOVE),
    ("max(abs(q) - M*p*(1 - (p/c)**n)**b, p - c, -p)", {"n": AT_LEAST_1, "b": Domain.between("1/10", 2)}, {}),
    ("max(abs(q) - M*(c - p)*(1 - (p/c)**n), p - c, -p)", {"n": AT_LEAST_1}, {}),  # both factors fall
    ("max(abs(q) + M*(c - p)*exp(p) - 10*c, -p, p - c)", {}, {}),  # one rises, one falls
    ("max(abs(q) + M*(c + p)*exp(t) - 10*c, -p, -t)", {}, {}),  # two loads
    ("q**2 - M**2*p**2*log(p/c)", {}, ABOVE),
    (CASM, {"n": Domain.between("1/2", 2)}, ABOVE),
    (CASM.replace("+ log", "- log"), {"n": AT_LEAST_1}, ABOVE),
    (CASM.replace("M*p", "M*q"), {"n": AT_LEAST_1}, ABOVE),
    (CASM.replace("M*p", "M*(p + c)"), {"n": AT_LEAST_1}, ABOVE),
    (CUBIC, {"h": Domain.between(-2, "1/2")}, {}),
    ("q**2 - M/p", {}, ABOVE),
    ("c - exp(q**2 + p**2)", {}, {}),
    ("exp(-(q**2) - p**2) - c", {}, {}),
    ("max(q**2/p**3 - c, p - c)", {}, ABOVE),
    ("max((q - a*p)**2 - 1/p, c - 2*p)", {}, {}),
    ("max(q**2 - (2*p - c)**2*(2 + h), p - c, -p)", {"h": Domain.between(0, 1)}, {}),  # two wedges that touch inside
    ("max(q**2 - p*(c - p)*(2*p - c)**2*(2 + h), p - c, -p)", {"h": Domain.between(0, 1)}, {}),
    ("q**2 - p*p", {}, {}),  # two wedges, as p p >= 0 bounds p on no side
    ("q**2 - M*(p + c)*(p + c)", {}, {}),
    ("max(abs(q)**3 - M*p*(2*p), t - q)", {}, {}),
    (CUBIC.replace(", -p)", ")"), {"h": Domain.between("-9/10", 3)}, {}),
    (CLOSED.replace(", 0)", ", 1)"), {}, {}),
    (CLOSED.replace(", -p)", ")"), {}, {}),
    (CLOSED.replace("M*p*", "M*"), {}, {}),
    (CLOSED.replace("p > 0", "p >= 0"), {}, {}),
    (CLOSED.replace("p > 0", "p - c > 0"), {}, {}),
    (CLOSED.replace("M*p*log", "-M*p*log"), {}, {}),
    (CLOSED.replace("M*p*log(p/c)", "M*p*log(p/c)*exp(1/p)"), {}, {}),
    (SPREAD.replace("max(q, p)", "2*max(q, p)"), {"n": AT_LEAST_1}, {}),
    (SPREAD.replace("max(q, p)", "max(q, q)"), {"n": AT_LEAST_1}, {}),
    (SPREAD + " + abs(t)", {"n": Domain.between("1/2", 2)}, {}),
    (UNIT, {"a": Domain.between(0, "101/100")}, {}),
    (UNIT, {"a": Domain.between(-1, 1)}, {}),
    (UNIT.replace("neg(q)", "neg(p)"), {"a": Domain.between(0, 1)}, {}),
    (UNIT.replace("neg(q)", "neg(-q)"), {"a": Domain.between(0, 1)}, {}),
    (UNIT.replace("neg(q)", "2*neg(q)"), {"a": Domain.between("1/10", 1)}, {}),
    (UNIT.replace("pos(q)", "pos(q)/2"), {"a": Domain.between(0, 1)}, {}),
    (UNIT.replace("abs(p)", "abs(p) + exp(-neg(q))"), {"a": Domain.between("1/10", 1)}, {}),  # two beside one ramp
    (UNIT.replace("abs(p)", "abs(p) + exp(-(p**2))"), {"a": Domain.between(0, 1)}, {}),
    (UNIT.replace("(q)", "(-(q**2))"), {"a": Domain.between("1/10", 1)}, {}),  # pos of it is 0
    (OF_SQUARES.replace("q**2", "abs(q)**(1/2)"), {}, {}),
    (OF_SQUARES.replace("/2)", ")"), {}, {}),
]  # fmt: skip


def law(g: str, own: dict[str, Domain], ranges: dict[str, Domain]) -> Criterion:
    known = {"M": POSITIVE, "c": POSITIVE, "a": ANY} | own
    used = {name: domain for name, domain in known.items() if re.search(rf"\b{name}\b", g)}
    return Criterion("law", g, used, ("q", "p", "t") if re.search(r"\bt\b", g) else ("q", "p"), None, domain=ranges)


def proved(criterion: Criterion) -> bool:
    return not objection("convexity", "composition", frozenset(), stated(law_as_text(criterion)), {})


@pytest.mark.parametrize(("g", "own", "ranges"), CONVEX)
def test_a_profile_that_is_concave_is_proved_and_no_chord_leaves_k(g: str, own: dict[str, Domain], ranges: dict[str, Domain]) -> None:
    criterion, random = law(g, own, ranges), np.random.default_rng(5)
    assert proved(criterion)
    ends = {name: (float(d.low or 0.05), float(d.high or 4)) for name, d in criterion.parameters.items()}
    for _ in range(6):
        values = {x: random.uniform(*ends[name]) for name, x in criterion.symbols().items() if name in ends}
        points = random.uniform(-3, 3, (2, 3_000, len(criterion.forces)))
        points[..., 1] = np.abs(points[..., 1]) if ranges or "log" in g else points[..., 1]
        places = [values | dict(zip(criterion.force_symbols(), x.T, strict=True)) for x in (*points, points.mean(axis=0))]
        with np.errstate(all="ignore"):
            one, two, middle = (evaluate(criterion.g, place) for place in places)
        assert not np.any((one <= 0) & (two <= 0) & (middle > 1e-9))


@pytest.mark.parametrize(("g", "own", "ranges"), OPEN)
def test_a_profile_that_is_not_is_left_open(g: str, own: dict[str, Domain], ranges: dict[str, Domain]) -> None:
    assert not proved(law(g, own, ranges))


SMOOTH = [
    ("abs(q) - p - 1", {"p": Domain.between(0)}, True),  # the kink is at q = 0, where g < 0
    ("abs(q) - p - 1", {"p": Domain.between("-1/2")}, True),
    ("abs(q) - p - 1/2", {"p": Domain.between("-1/2")}, False),
    ("abs(q) - p - 1", {}, False),
    ("abs(q) - p", {"p": Domain.between(0)}, False),
    ("abs(q) + abs(p) - 1", {"p": Domain.between(0)}, False),
    ("norm(q, p) + pos(q - 2) - 1", {}, False),
]


@pytest.mark.parametrize(("g", "ranges", "smooth"), SMOOTH)
def test_a_kink_where_g_is_not_0_is_no_corner(g: str, ranges: dict[str, Domain], smooth: bool) -> None:
    given = stated(law_as_text(Criterion("law", g, {}, ("q", "p"), None, domain=ranges)))
    assert (not objection("smoothness", "composition", frozenset(), given, {})) is smooth


FLOWS = [
    ("(m + k)*c", "1 - m*k", "k", ["m*k < 1"], True),  # PorePy's: mu* = (m + tan psi)/(1 - m tan psi)
    ("(m + k)*c", "1 - m*k", "2*k", ["m*k < 1"], False),
    ("(m + k)*c", "1 - m*k", "k", ["m*k < 1", "k <= 1"], True),
    ("(m - k)*c", "1 + m*k", "k", ["k <= m"], False),
    ("m*c", "1", "m", [], True),
    ("m*c", "1", "m + k", [], False),
]


@pytest.mark.parametrize(("over", "below", "opening", "constraints", "holds"), mostly_long(FLOWS, FLOWS[1]))
def test_a_flow_that_opens_dissipates_where_its_share_of_g_has_a_divisor_that_may_be_0(
    over: str, below: str, opening: str, constraints: list[str], holds: bool
) -> None:
    criterion = Criterion(
        "law", f"norm(a, b) + {over}/({below})", {"m": AT_LEAST_0, "k": AT_LEAST_0}, ("a", "b", "c"), None,
        constraints=tuple(constraints), flow=("a/norm(a, b)", "b/norm(a, b)", opening),
    )  # fmt: skip
    assert (verify(criterion, claims=["dissipation"])["dissipation"].verdict.value == "proved") is holds


@pytest.mark.long
def test_no_chord_contradicts_what_is_proved_of_drawn_profiles() -> None:
    rng = Random(3)
    shown = [criterion for criterion, _ in zip(profiles.drawn(rng), range(300), strict=False) if profiles.proved(criterion)]
    assert len(shown) > 10 and not any(profiles.leaves(criterion, rng) for criterion in shown)
