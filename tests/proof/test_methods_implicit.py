"""The methods for implicit surfaces and for polygons, each asked alone: what it proves and of which neighbours it is silent."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence

import pytest
import sympy as sp

from duhem import Criterion, Domain, Verdict, verify
from duhem.expression.branches import Branch
from duhem.proof.decide import Answer
from duhem.proof.facts.formula_subject import FormulaSubject
from duhem.proof.methods import evidence
from duhem.proof.verdict import Evidence
from tests.long import long_but
from tests.oracles.prover import boundary as implicit
from tests.oracles.prover import on_boundary, polyhedral
from tests.oracles.prover.decide import AskedSubject

CASSINI = "(a**2 + b**2)**2 - 2*(a**2 - b**2)"  # less e**2 - 1: convex for e >= 2
a, b, c = sp.symbols("a b c", real=True)


def subject(
    g: str, forces: str = "ab", flow: Sequence[str] | None = None, parameters: Mapping[str, Domain] | None = None
) -> FormulaSubject:
    return AskedSubject(Criterion("law", g, forces=tuple(forces), pressure=None, flow=flow and tuple(flow), parameters=parameters or {}))


METHODS = {
    "c": implicit.convexity,
    "s": on_boundary.smoothness_on_boundary,
    "d": on_boundary.dissipation_on_boundary,
    "h": implicit.hessian,
}
TWO: dict[str, str] = {  # by which methods it is proved: convexity, smoothness, dissipation, that g is convex
    "a**2 + b**2 - 1": "csdh",
    "a**2 + 2*b**2 + b - 1": "csdh",
    "a**2 + b**2 + 3*a*b/2 + a/2 - 1": "csdh",
    f"{CASSINI} - 65/16": "csd",
    f"{CASSINI} - 261/100": "sd",
    "max(a**2 + b**2 - 1, a - 1/2)": "cdh",
    "max(a**2 + 4*b**2, 4*a**2 + b**2) - 1": "cdh",
    "min(a**2 + 4*b**2, 4*a**2 + b**2) - 1": "d",
    "a**2 + b**2 + pos(b)**2 - 1": "csdh",
    "a**2 + b**2 - pos(b)**2/2 - 1": "csdh",
    "a**2 + b**2 + abs(b) - 1": "cdh",
    "a**2 + b**2 - abs(b)/2 - 1": "d",
    "a**4 + b**4 - 1": "csdh",
    "abs(a) + abs(b) - 1": "cdh",
    "where(a > 0, a**2 + b**2, 2*a**2 + b**2) - 1": "csdh",
    "where(a > 0, a**2 + b**2, a**2 + 2*b**2) - 1": "",  # it jumps
    "where(a > 0, 1, 2)*(a**2 + b**2) - 1": "",  # two half discs, each of which is round
    "where(a > 0, a**2 + b**2, a**2 + b**2 - a) - 1": "cdh",
    "where(a > 0, a**2 + b**2, a**2 + b**2 + a) - 1": "d",
    "a**2 + b**2 + 1": "sdh",  # nowhere
    "(a - 2)**2 + b**2 - 1": "sh",
    "(a - 1)**2 + b**2 - 1": "sdh",
    "(a**2 + b**2 - 1)**2": "",
    "abs(a**2 + b**2 - 1)": "",  # a line, with normals on both sides
    "(a**2 + b**2 - 1)**3": "csdh",  # an odd power is the same law
    "(a - b)**2 - 1": "csdh",
    "b - a**2 - 1": "s",
    "a**2 + b**2 - b**3 - 1": "s",
}


@pytest.mark.slow
@pytest.mark.parametrize("g", long_but([0, 1, 4, 5, *range(7, 10), *range(12, 18), *range(19, 22), *range(23, 28)], TWO))
def test_in_two_forces(g: str) -> None:
    law = subject(g)
    assert "".join(letter for letter, method in METHODS.items() if method(law) is not None) == TWO[g]
    assert not list(evidence.convexity_on_boundary(law)) or set(TWO[g]) & {"c", "h"}


THREE = {
    "a**2 + b**2 + c**2 - 1": "csdh",
    "a**2 + b**2 - c**2 - 1": "sd",
    "a**2 + b**2/2 + c**2 + a*c - 1": "csdh",
    "a**2 + b**2 + abs(c) - 1": "dh",
    "a**2 + b**2 + c**2 + pos(c)**2 - 1": "sdh",
}
ONE = {
    "a**2 - 1": "csdh",
    "a**2 + a - 1": "csdh",
    "abs(a) - 1": "sdh",
    "a**4 - a**2 - 1": "csd",
    "a**3 - 1": "csd",
    "a**2 - 3*abs(a) + 2": "s",
    "a**2": "h",
}


@pytest.mark.slow
@pytest.mark.parametrize("g", long_but([0, 3, 5, 6, 9, 11], {**THREE, **ONE}))
def test_in_three_forces_and_in_one(g: str) -> None:
    law = subject(g, "abc" if g in THREE else "a")
    assert "".join(letter for letter, method in METHODS.items() if method(law) is not None) == {**THREE, **ONE}[g]


@pytest.mark.slow
@pytest.mark.parametrize("g", long_but([0, 5, 8, 10, 13, 15, 19, 21, 24, 28, 31, 34, 37, 39], {**TWO, **THREE, **ONE}))
def test_what_was_shown_of_a_boundary_is_proved(g: str) -> None:
    letters = {**TWO, **THREE, **ONE}[g]
    true = {"convexity": "c" in letters or "h" in letters, "smoothness": "s" in letters, "dissipation": "d" in letters}
    law = subject(g, "abc" if g in THREE else "a" if g in ONE else "ab").law
    found = verify(law, claims=[claim for claim, holds in true.items() if holds] or ["origin"])
    assert {r.claim for r in found.results if r.claim in true and r.verdict is not Verdict.PROVED} == set()


@pytest.mark.long
@pytest.mark.parametrize("turn", [(1, 2, 1, -1)])
def test_polygons_with_corners_outward_and_inward(turn: tuple[int, int, int, int]) -> None:
    """max(|u|, |v|) + t min(|u|, |v|) = 1 is convex for t <= 1, in whatever coordinates; so it is where its corners are not alike."""
    i, j, k, m = turn
    u, v = f"abs({i}*a + {j}*b + a/7)", f"abs({k}*a + {m}*b)"
    for t, convex in (("1/4", True), ("2", False)):
        law = subject(f"max({u}, {v}) + {t}*min({u}, {v}) - 1")
        assert [method(law) is not None for method in (implicit.convexity, on_boundary.smoothness_on_boundary)] == [convex, False]
        assert (polyhedral.convexity(law) is not None) is convex


def test_what_the_kernel_is_offered() -> None:
    """Before a decider is asked; what deciders show then has no other evidence."""
    round_, kinked, flat = subject("a**2 + b**2 - 1"), subject("max(a**2 + b**2 - 1, a - 1/2)"), subject("a**2 - 1", "a")
    joined = subject("a**2 + b**2 + pos(b)**2 - 1")
    rises = {"outward"}
    assert offers(evidence.convexity_on_boundary, round_) == [("implicit-curvature", {*rises, "directions", "inward"})]
    assert offers(evidence.convexity_on_boundary, flat) == [("implicit-curvature", rises)]
    assert offers(evidence.convexity_on_boundary, kinked) == []
    for law in (round_, joined):
        assert offers(evidence.smoothness_by_identities, law)[0] == ("regular-value", rises)
    assert offers(evidence.dissipation_by_identities, kinked) == [("boundary-power", rises)]


def offers(finder: Callable[[FormulaSubject], Iterable[Evidence]], law: FormulaSubject) -> list[tuple[str, set[str]]]:
    proofs = [found.proof for found in finder(law)]
    return [(proof.rule, {*proof.evidence}) for proof in proofs if proof is not None]


def test_what_they_say() -> None:
    round_, kinked, flat = subject("a**2 + b**2 - 1"), subject("max(a**2 + b**2 - 1, a - 1/2)"), subject("a**2 - 1", "a")
    joined = subject("a**2 + b**2 + pos(b)**2 - 1")
    found = implicit.convexity(round_), implicit.convexity(kinked), implicit.convexity(flat)
    assert [f and (f.verdict, f.method, f.detail) for f in found] == [
        (Verdict.PROVED, "implicit-curvature (sign-rules)", "K is star-shaped about 0 and its boundary curves inward everywhere"),
        (
            Verdict.PROVED,
            "implicit-curvature (sign-rules)",
            "K is star-shaped about 0 and its boundary curves inward everywhere and kinks outward on every seam",
        ),
        (Verdict.PROVED, "implicit-curvature", "K is an interval: star-shaped about 0 on a line"),
    ]
    smooth = on_boundary.smoothness_on_boundary(round_), on_boundary.smoothness_on_boundary(joined)
    assert [f and (f.method, f.detail) for f in smooth] == [
        ("regular-value (smt-z3)", "grad g != 0 wherever g = 0"),
        ("regular-value (smt-z3)", "grad g != 0 wherever g = 0, with one direction on both sides of each seam"),
    ]
    power = on_boundary.dissipation_on_boundary(kinked)
    assert power is not None and (power.method, power.detail) == ("boundary-power (sign-rules, smt-z3)", "force . flow >= 0 wherever g = 0")
    plain = implicit.hessian(kinked)
    assert plain is not None and (plain.method, plain.proof) == ("hessian (sign-rules)", None)
    assert plain.detail == "g is convex: second derivatives >= 0 on each branch, gradient never jumps down"
    sides = polyhedral.convexity(subject("max(a + 2*b, -a, a - b) - 1"))
    assert sides is not None and sides.method == "polyhedral (smt-z3)"
    assert sides.detail == "K is the intersection of the 3 half-spaces that its faces span"


@pytest.mark.parametrize(("low", "proved"), [("0", "h"), ("1/10", "csdh")])
def test_at_the_ends_of_a_range(low: str, proved: str) -> None:
    """A disc of radius 0 has no inside and no normal."""
    law = subject("a**2 + b**2 - q", parameters={"q": Domain.between(low, 1)})
    assert "".join(letter for letter, method in METHODS.items() if method(law) is not None) == proved


@pytest.mark.parametrize(
    ("flow", "proved"),
    [
        (("a", "b"), True),
        (("a - b", "a + b"), True),
        (("-b", "a"), True),
        (("-a", "-b"), False),
        (("a - 3*b", "0"), False),
        (("a", "-b"), False),
    ],
)
def test_the_power_of_a_flow_of_its_own(flow: Sequence[str], proved: bool) -> None:
    assert (on_boundary.dissipation_on_boundary(subject("a**2 + b**2 - 1", flow=flow)) is not None) is proved


def test_too_many_branches() -> None:
    eight, sixteen = subject("abs(a) + abs(b) + abs(a - b) - 1"), subject("abs(a) + abs(b) + abs(a - b) + abs(a + b) - 1")
    assert implicit.hessian(eight) is not None
    assert [method(sixteen) for method in (implicit.hessian, implicit.convexity, on_boundary.smoothness_on_boundary)] == [None] * 3


def test_the_second_derivative_along_a_tangent() -> None:
    bend, given = implicit._bend(a**2 * b, (a, b))
    assert sp.expand(bend) == -6 * a**4 * b and given == ()
    bend, (tangent,) = implicit._bend(a**2 * b + c**3, (a, b, c))
    v = sorted(bend.free_symbols - {a, b, c}, key=str)
    assert sp.expand(bend) == sp.expand(2 * b * v[0] ** 2 + 4 * a * v[0] * v[1] + 6 * c * v[2] ** 2)
    assert isinstance(tangent, sp.Eq) and sp.expand(tangent.lhs - (2 * a * b * v[0] + a**2 * v[1] + 3 * c**2 * v[2])) == 0 == tangent.rhs


@pytest.mark.parametrize(
    ("g", "switch", "crossed"),
    [
        (a**2 + b**2 - 1, b, True),
        (a**2 + b**2 - 1, b - 1, False),  # touches
        (a**2 + b**2 - 1, b - 2, True),  # does not meet
        (a + b - 1, a + b - 1, False),  # runs along
        (a + b - 1, a - b, True),
        (a + b - 1, 2 * a + b - 1, True),
    ],
)
def test_whether_the_boundary_crosses_a_seam(g: sp.Expr, switch: sp.Expr, crossed: bool) -> None:
    law = subject("a**2 + b**2 - 1")
    assert implicit._crossed(law, Branch({switch: 1}, g)) is crossed and implicit._crossed(law, Branch({}, g)) is True
    assert implicit._crossed(law, Branch({a - 3 * b - 9: -1, switch: 1}, g)) is crossed
    assert implicit._crossed(subject("a**2 - 1", "a"), Branch({}, a**2 - 1)) is False


def test_an_open_answer_says_nothing_of_a_seam(monkeypatch: pytest.MonkeyPatch) -> None:
    law = subject("a**2 + b**2 - 1")
    for answer in (Answer(None), Answer(False)):
        monkeypatch.setattr(AskedSubject, "ask", lambda *_, told=answer, **__: told)
        assert implicit._crossed(law, Branch({b: 1}, a**2 + b**2 - 1)) is False
        assert implicit._outward_kink(law, Branch({b: 1}, a**2 + b**2 - 1), Branch({b: -1}, a**2 + 2 * b**2 - 1)) is False
        assert implicit._star(law, (Branch({}, a**2 + b**2 - 1),)) is False and implicit._regular(law, sp.exp(a), ()) is False


def test_a_kink_between_two_branches() -> None:
    law = subject("a**2 + b**2 - 1")
    disc, flat, steep = a**2 + b**2 - 1, a - sp.Rational(1, 2), 4 * a**2 + b**2 - 1

    def outward(before: sp.Expr, after: sp.Expr, switch: sp.Expr, sign: int = 1) -> bool:
        one, two = Branch({switch: -sign}, before), Branch({switch: sign}, after)
        return implicit._outward_kink(law, one, two) and implicit._outward_kink(law, two, one)

    assert outward(disc, flat, flat - disc) and not outward(flat, disc, flat - disc)
    assert outward(disc, 2 * disc, a) and outward(disc, disc, a)
    other = a**2 + 4 * b**2 - 1
    assert outward(other, steep, steep - other) and not outward(steep, other, steep - other)
    assert outward(other, steep, other - steep, -1) and not outward(steep, other, other - steep, -1)
    assert not implicit._outward_kink(law, Branch({a: 1}, disc), Branch({b: 1}, steep))  # no seam to tell
    assert implicit._outward_kink(law, Branch({a: 1}, disc), Branch({b: 1}, disc))


def test_whether_a_switch_shows_the_normal_of_its_seam() -> None:
    law = subject("a**2 + b**2 - 1")
    assert implicit._regular(law, a - b, ()) and implicit._regular(law, a * b, ()) and not implicit._regular(law, (a - b) ** 3, ())
    assert implicit._regular(law, sp.exp(a) + b, ()) and not implicit._regular(law, (sp.exp(a) - 1) ** 2, ())


def test_star_shape() -> None:
    for g, star in ((a**2 + b**2 - 1, True), ((a - 1) ** 2 + b**2 - 2, True), ((a - 2) ** 2 + b**2 - 1, False), (a**2 - b**2 + 1, False)):
        law = subject(str(g))
        assert implicit._star(law, law.pieces or ()) is star
    assert implicit._star(subject("a**2 + b**2"), (Branch({}, a**2 + b**2),)) is False  # 0 is no inside
    law = subject("a**2 + b**2 - 1")
    assert implicit._star(law, (Branch({a: 1}, a - 1), Branch({a: -1}, -a - 1))) is True
    assert implicit._star(law, (Branch({a: 1}, a - 1), Branch({a: -1}, a + 1))) is False


@pytest.mark.slow
@pytest.mark.parametrize(
    ("g", "forces", "convex"),
    [
        ("max(a, b, -a - b) - 1", "ab", True),
        ("abs(a) + abs(b) + abs(c) - 1", "abc", True),
        ("max(abs(a), abs(b)) - 1", "ab", True),
        ("min(max(a, b, -a - b), 2) - 1", "ab", True),
        ("min(a, b) - 1", "ab", False),
        ("max(min(a - 1, b - 1), a - 2, b - 2, -a - 1, -b - 1)", "ab", False),
        ("max(a, b)", "ab", True),
        ("max(a - 1, -1 - a, 0)", "ab", False),  # 0 on a whole cell
        ("max(a - 1, -1 - a, 1)", "ab", False),  # nothing at all
        ("max(a, -a)", "ab", False),  # a line
        ("max(a, -a) + 1", "ab", False),
        ("max(a - 1, b**2 - 1)", "ab", False),
        ("a + b - 1", "ab", False),  # one piece: another method's
        ("where(a > 0, a, 2*a) - 1", "ab", False),
        ("abs(a) - abs(b) - 1", "ab", False),
        ("abs(abs(a) - 2) - 1", "a", False),
        ("max(abs(a) - 1, min(a, 0) - 3)", "a", True),
    ],
)
def test_polyhedra(g: str, forces: str, convex: bool) -> None:
    assert (polyhedral.convexity(subject(g, forces)) is not None) is convex


def test_polyhedra_have_no_parameters() -> None:
    assert polyhedral.convexity(subject("abs(a) + q*abs(b) - 1", parameters={"q": Domain.between("1/2", 1)})) is None
    assert polyhedral._plane(2 * a - 4 * b + 6, (a, b)) == polyhedral._plane(-a + 2 * b - 3, (a, b)) != polyhedral._plane(a - 2 * b, (a, b))


@pytest.mark.slow
@pytest.mark.parametrize("size", long_but([0, 3], ["1/1000", "1/64", "1", "1000"]))
@pytest.mark.parametrize(
    ("body", "convex"),
    [
        ("a**2 + b**2 - abs(a) - 1", False),
        ("a**2 + 2*b**2 - abs(a + b) - 1", False),
        ("a**4 + b**4 + a**2 + b**2 - abs(b)/3 - 1", False),
        ("a**2 + b**2 + abs(a) - 1", True),
    ],
)
def test_the_size_of_g_does_not_matter_at_a_kink(body: str, convex: bool, size: str) -> None:
    law = AskedSubject(Criterion("law", f"({body})*({size})", {}, forces=("a", "b"), pressure=None))
    assert (implicit.convexity(law) is not None) is convex
