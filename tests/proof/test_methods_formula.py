"""The methods that read a formula off, each asked alone: what it proves, in its words and with which evidence, and where it is silent."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import Any

import pytest
import sympy as sp

from duhem import POSITIVE, Criterion, Domain, Verdict
from duhem.expression import Norm
from duhem.proof.facts.formula_subject import FormulaSubject
from duhem.proof.methods import evidence, refuters
from duhem.proof.verdict import Evidence, Proof
from tests.long import long_but
from tests.oracles.prover import composition, convex_sums, degrees, polar, rounded, state_laws
from tests.oracles.prover import evaluation as evaluated
from tests.oracles.prover.decide import AskedSubject

UNIT = Domain.between(0, 1)
Method = Callable[[FormulaSubject], Evidence | None]
A_B = ("a", "b")
a, b = sp.symbols("a b", real=True)


def subject(g: str, forces: Sequence[str] = A_B, pressure: str | None = None, **law: Any) -> FormulaSubject:
    parameters = {name: law.pop(name) for name in ("q", "m") if name in law}
    return AskedSubject(Criterion("law", g, forces=tuple(forces), pressure=pressure, parameters=parameters, **law))


def told(found: Evidence | None) -> tuple[str, str, str, Mapping[str, Any]] | None:
    """Verdict, method, detail and, of the evidence of the proof, the rule."""
    return found and (found.verdict.value, found.method, found.detail, found.proof.rule if found.proof else "")  # type: ignore[return-value]


NO_KINK = "g has no kink, no tip lies on the boundary, and grad g != 0 on it "
AT_ORIGIN = "because g is convex and negative at the origin"


@pytest.mark.parametrize(
    ("g", "law", "detail", "proof"),
    [
        ("norm(a, b) - 1", {}, NO_KINK + AT_ORIGIN, Proof("composition")),
        ("a**2 + b**2 - 1", {}, NO_KINK + AT_ORIGIN, Proof("composition")),
        (
            "a**2 + b**2 + pos(b)**2 - 1",
            {},
            "every kink lies where the function under it vanishes, no tip lies on the boundary, and grad g != 0 on it " + AT_ORIGIN,
            Proof("composition"),
        ),
        ("exp(a) + exp(-a) + b**2 - 3", {}, NO_KINK + AT_ORIGIN, Proof("composition")),
        ("q*norm(a, b) - 1", {"q": UNIT}, NO_KINK + AT_ORIGIN, Proof("composition")),
        ("a**3 - 1", {"forces": "a"}, NO_KINK + "by Euler's relation", Proof("euler")),
        (
            "norm(a - 2, b - 1) - 1",
            {},
            NO_KINK + "because g is convex and negative at (2, 1)",
            Proof("composition", {"inside": {"a": "2", "b": "1"}}),
        ),
        (
            "(a - 1)**2 + b**2 - 1/2",
            {},
            NO_KINK + "because g is convex and negative at (1, 0)",
            Proof("composition", {"inside": {"a": "1", "b": "0"}}),
        ),
    ],
)
def test_smoothness_by_composition(g: str, law: dict[str, Any], detail: str, proof: Proof) -> None:
    found = composition.smoothness(subject(g, **law))
    assert found == Evidence(Verdict.PROVED, found.method if found else "", detail, proof=proof)
    assert found is not None and found.method == "composition"


@pytest.mark.parametrize(
    ("g", "law"),
    [
        ("abs(a) + b**2 - 1", {}),
        ("max(norm(a, b), 2*abs(a)) - 1", {}),
        ("norm(a, b) - a/2 - 1", {}),  # the tip depends on what the rest is
        ("norm(a - 1, b)", {}),  # a point
        ("(a - 1)**2 + b**2", {}),
        ("norm(a, b)", {}),
        ("norm(a, b) - q", {"q": UNIT}),
        ("norm(a, b) + 1", {}),
        ("norm(a, b) + a**2 - 1", {}),
        ("a**2", {"forces": "a"}),
        ("abs(a)", {"forces": "a"}),
        ("abs(a) - q", {"forces": "a", "q": UNIT}),
        ("a**2 + 1", {"forces": "a"}),
        ("a**2*(a - 1)", {"forces": "a"}),
    ],
)
def test_where_composition_does_not_show_smoothness(g: str, law: dict[str, Any]) -> None:
    assert composition.smoothness(subject(g, **law)) is None


@pytest.mark.parametrize(
    "g", ["a**2 - 1", "abs(a) - 1/2", "(a - 1)**2 - 4", "a - 1", "max(a, 0) - 1", "max(a - 1, -a)", "max(a, -1 - a)", "max(a - 3, -a)"]
)
def test_an_interval_with_an_inside(g: str) -> None:
    detail = "K is an interval with interior points: at each of its ends the normal is +1 or -1"
    assert composition.smoothness(subject(g, "a")) == Evidence(Verdict.PROVED, "one-dimensional", detail)


def test_an_interval_as_wide_as_the_pressure() -> None:
    assert composition._interval(subject("max(a - abs(p), -a)", "a", "p"))
    assert composition._interval(subject("max(a - abs(p) - q, -a)", "a", "p", q=UNIT)) and not composition._interval(
        subject("abs(a) + abs(p)", "a", "p")
    )
    assert not composition._interval(subject("max(a - 1/2, -a)", "a")) and not composition._interval(subject("1 - a**2", "a"))


def test_a_tip_is_off_the_boundary_where_the_rest_has_a_sign() -> None:
    tip = Norm(a, b)
    for g, off in (("norm(a, b) - 1", True), ("1 - norm(a, b)", True), ("norm(a, b)", False), ("norm(a, b) + a - 1", False)):
        law = subject(g)
        inside = next(iter(law.simple.g.atoms(Norm)))
        assert composition._off_boundary(law, inside) is off, g
    assert (
        composition._off_boundary(
            subject("norm(a, b) - q", q=UNIT), tip.xreplace(dict(zip((a, b), subject("a").law.force_symbols(), strict=True)))
        )
        is False
    )


def test_what_has_its_limit_where_a_mark_is_zero() -> None:
    mark, p = sp.Dummy("tip", positive=True), sp.Symbol("p", positive=True)
    tame = [mark, a, mark + a, mark * a, mark**2, mark**p, Norm(mark, a), sp.exp(a), sp.sqrt(mark)]
    wild = [1 / mark, mark**-p, mark**a, 2**mark, sp.exp(mark), sp.log(mark), sp.Abs(mark - a), mark ** (mark + 1)]
    assert all(composition._tame(node, mark) for node in tame) and not any(composition._tame(node, mark) for node in wild)


@pytest.mark.parametrize(
    ("g", "detail"),
    [
        ("a + b - 1", "g is convex: g is affine"),
        ("a**2 + b**2 - 1", "g is convex: even powers of affine functions are convex"),
        (
            "norm(a, b)**3 - 1",
            "g is convex: a Euclidean norm of affine or of convex non-negative functions is convex; x^p is convex and increasing",
        ),
        ("a**3 + b - 1", None),
        ("abs(a) - abs(b)", None),
        ("sqrt(norm(a, b)) - 1", "g is quasiconvex: a Euclidean norm"),
        ("a*b - 1", None),
        ("norm(a, b) - 2*abs(a)", None),
    ],
)
def test_convexity_by_composition(g: str, detail: str | None) -> None:
    found = composition.convexity(subject(g))
    assert (found is None) if detail is None else (found is not None and found.detail.startswith(detail))
    assert found is None or (found.verdict, found.method, found.proof) == (Verdict.PROVED, "composition", Proof("composition"))


def test_convexity_by_sums_of_squares() -> None:
    found = convex_sums.convexity(subject("a**4 + a**2*b**2 + b**4 + a - 1"))
    assert found is not None and (found.verdict, found.method) == (Verdict.PROVED, "sos-convexity")
    assert (
        found.detail == "g is convex: even powers of affine functions are convex; a polynomial is convex by sums of squares"
        and found.proof is not None
    )
    assert found.proof.rule == "composition" and set(found.proof.evidence) == {"directions", "convex sums"}
    assert convex_sums.convexity(subject("a**4 - 3*a**2*b**2 + b**4 + a - 1")) is None
    assert convex_sums.convexity(subject("a**2 + b**2 - 1")) is None  # the polar form says more
    three = convex_sums.convexity(subject("a**2 + b**2 + c**2 + a*b - 1", "abc"))
    assert three is not None and three.detail.startswith("g is convex")
    root = convex_sums.convexity(subject("sqrt(sqrt(a**4 + b**4 + a**2*b**2 + 1)) + a - 3"))
    assert root is None or root.detail.startswith("g is ")


POWER = "so sigma . grad g > 0 wherever g = 0"


@pytest.mark.parametrize(
    ("g", "method", "degrees_"),
    [
        ("norm(a, b) - 1", "homogeneity (sign-rules)", "0, 1"),
        ("norm(a, b)**3 - 1", "homogeneity (sign-rules)", "0, 3"),
        ("abs(a) + b**2 - 1", "homogeneity (sign-rules)", "0, 1, 2"),
        ("a**2 + b**2 - a", "homogeneity (smt-z3)", "1, 2"),
        ("a**3 - 1", "homogeneity (sign-rules)", "0, 3"),
        ("where(a > 0, a, 2*a) + b**2 - 1", "homogeneity (sign-rules)", "0, 1, 2"),
    ],
)
def test_dissipation_by_degrees(g: str, method: str, degrees_: str) -> None:
    detail = f"g has parts of degree {degrees_} in the forces, {POWER}"
    assert degrees.dissipation(subject(g)) == Evidence(Verdict.PROVED, method, detail, proof=Proof("homogeneity"))


@pytest.mark.parametrize(
    ("g", "law"),
    [
        ("1 - a**2 - b**2", {}),
        ("a**2 + b**3 - 1", {}),
        ("norm(a - 1, b) - 1", {}),
        ("norm(a, b) + 1 - a**2", {}),
        ("where(a > 0, 1, 2)*norm(a, b) - 1", {}),  # it jumps
        ("norm(a, b) - 1", {"flow": A_B}),
        ("norm(a, b) + q - 1 - a**2", {"q": UNIT}),
        ("max(abs(a) - abs(b), b - 1)", {}),
        ("where(a > 0, 1, 2)*abs(a) - where(b > 0, a, -a)", {}),
        ("abs(a) - abs(b)", {"flow": A_B}),
    ],
)
def test_where_degrees_say_nothing(g: str, law: dict[str, Any]) -> None:
    assert degrees.dissipation(subject(g, **law)) is None


@pytest.mark.parametrize("g", ["abs(a) - abs(b)", "max(norm(a, b) - 2*a, b)", "min(a, b, norm(a, b) - 2*b)", "a*b"])
def test_dissipation_of_a_cone(g: str) -> None:
    detail = "g keeps its sign along each ray from 0, so K is a cone: its normals are across the force, and the power is 0"
    assert degrees.dissipation(subject(g)) == Evidence(Verdict.PROVED, "homogeneity", detail, proof=Proof("homogeneity"))


@pytest.mark.parametrize(
    ("potential", "found"),
    [
        ("norm(a, b) + c/2", ("potential (smt-z3)", "1", "1/2")),
        ("norm(a, b) + c", ("potential (sign-rules)", "1", "1")),
        ("a**2 + b**2 + c**2", ("potential (sign-rules)", "2", "0")),
        ("a**2 + b**4 + norm(b, c)", ("potential (smt-z3)", "1, 2, 4", "0")),
        ("norm(a, b) + 2*c", None),
        ("norm(a, b) - c", None),
        ("-a**2 - b**2 - c**2", None),
        ("norm(a, b) + where(c > 0, c, 1)", None),
        ("exp(a) + norm(b, c)", None),
        (None, None),
    ],
)
def test_dissipation_of_a_potential(potential: str | None, found: tuple[str, str, str] | None) -> None:
    """Where norm(a, b) + c = 1."""
    evidence = degrees.dissipation_of_potential(subject("norm(a, b) + c - 1", "abc", potential=potential))
    if found is None:
        assert evidence is None
    else:
        method, parts, share = found
        detail = f"the potential has parts of degree {parts} in the forces, so force . flow >= 0 wherever g = 0"
        assert evidence == Evidence(Verdict.PROVED, method, detail, proof=Proof("potential", {"share": share}))


def test_a_share_of_the_potential_in_the_law_s_own_names() -> None:
    law = subject("norm(a, b) + c - m*abs(p)", "abc", "p", potential="norm(a, b) + c/m", m=Domain.between(1, 2))
    found = degrees.dissipation_of_potential(law)
    assert found is not None and found.proof == Proof("potential", {"share": "1/m"})
    assert degrees._in_pressure(law, law.problem.magnitude) == -law.law.symbols()["p"]
    assert degrees._by_forces(2 * a * b + 3 * a + 5 * sp.Symbol("k") - a, (a, b)) == {a * b: 2, a: 2, sp.S.One: 5 * sp.Symbol("k")}
    assert (
        degrees.dissipation_of_potential(subject("norm(a, b) + c - m", "abc", potential="norm(a, b) + m*c", m=Domain.between(1, 2))) is None
    )


P = "((p + 1/2)/2)"
LENS = "max(norm(a, b) - 2*(P - P**2)**(2/3), -P, P - 1)"


@pytest.mark.slow
@pytest.mark.parametrize(
    ("g", "round_"),
    long_but(
        [1, 3, 4, 7, 9, 11],
        [
            (LENS, True),
            ("max(norm(a, b)**2 - (P - P**2)**(2/3), -P, P - 1)", True),
            (LENS.replace("norm(a, b)", "norm(a, b) + 1/10"), False),  # its tip lies on the boundary
            (LENS.replace("norm(a, b)", "abs(a) + abs(b)"), False),  # edges
            (LENS.replace("2/3", "1"), False),  # no round end
            (LENS.replace("2*(", "-2*("), False),
            (LENS.replace("(P - P**2)", "P"), False),  # a disc at one end
            (LENS.replace("-P, P - 1", "P - 1"), False),  # one end is not said
            (LENS.replace("-P,", "-P, a - 1/10,"), False),  # cut by a load that no root knows of
            (LENS.replace("(P - P**2)", "(P*(1 - P)*(1 - P))"), False),  # not concave
            (LENS.replace("P", "(P + 1)").replace("(P + 1) - 1", "P"), False),  # 0 is not inside
            ("norm(a, b) - 1", False),
        ],
    ),
)
def test_what_is_round_at_the_ends_of_its_loads(g: str, round_: bool) -> None:
    found = rounded.smoothness(subject(g.replace("P", P), "abp"))
    detail = "K is convex, its boundary C^1 between the ends of its loads, and round at these, where the root in g is 0"
    assert found == (Evidence(Verdict.PROVED, "composition", detail, proof=Proof("composition")) if round_ else None)


def test_the_sign_at_zero_force() -> None:
    for g, at in (("norm(a, b) - 1", "-1"), ("norm(a - 1, b) - 1", "0"), ("a**2 + b**2 - q", "-q")):
        found = evaluated.origin(subject(g, **({"q": UNIT} if "q" in g else {})))
        assert told(found) == ("proved", "evaluation (sign-rules)", f"g(0) = {at} <= 0", "")
    for g in ("norm(a - 2, b) - 1", "norm(a, b) + a*b/norm(a, b)/4 - 1", "norm(a, b) - q + 1/2"):
        assert evaluated.origin(subject(g, **({"q": UNIT} if "q" in g else {}))) is None
    out = refuters.origin_at_parameters(subject("(a - 1)**2 + b**2 - q", q=Domain.between(0, 2)))
    assert out is not None and (out.verdict, out.method, out.detail) == (Verdict.REFUTED, "witness-point", "zero force is outside K")
    assert (
        out.witness is not None and sp.Rational(out.witness.parameters["q"]) < 1 and out.witness.points == {"origin": {"a": "0", "b": "0"}}
    )
    assert refuters.origin_at_parameters(subject("norm(a, b) - 1")) is None
    assert refuters.origin_at_parameters(subject("norm(a, b) + a*b/norm(a, b)/4 - 1")) is None


EULER = "g = A - B with A, B > 0 homogeneous of degrees a > b, so sigma . grad g = (a - b) A > 0 on the boundary"
SEAMS = "and gamma' never jumps down where two meet"
POLAR: dict[str, tuple[str | None, str | None, bool]] = {  # convexity and smoothness, and whether there is a gauge at all
    "norm(a, b) - 1": ("polar-curvature (composition): all round", "no seam", True),
    "norm(a, b) + a*b/norm(a, b)/4 - 1": ("polar-curvature (smt-z3): all round", "no seam", True),
    "norm(a, b)**2 - a*b/3 - norm(a, b)": ("polar-curvature (smt-z3): all round", "no seam", True),
    "norm(a, b) + abs(a)/2 - 1": (f"polar-curvature (composition): on each of 2 arcs, {SEAMS}", None, True),
    "max(norm(a, b), 2*abs(a)) - 1": (f"polar-curvature (composition): on each of 4 arcs, {SEAMS}", None, True),
    "norm(a, b) - abs(a)/2 - 1": (None, None, True),
    "min(norm(a, b), 2*abs(a)) - 1": (None, None, False),
    "norm(a, b) - 9*a*b/norm(a, b)/10 - 1": (None, "no seam", True),
    "norm(a, b) + abs(a)*a/norm(a, b)/4 - 1": ("?", "gamma' equal on both sides of each seam", True),
    "norm(a, b) - 1 + a": (None, None, False),  # unbounded
    "norm(a - 1, b) - 2": (None, None, False),
}


@pytest.mark.slow
@pytest.mark.parametrize("g", long_but([0, 3, 5, 6, 9, 10], POLAR))
def test_the_polar_form(g: str) -> None:
    law, (convex, smooth, star) = subject(g), POLAR[g]
    found = polar.convexity(law)
    if convex != "?":
        method, _, arcs = (convex or "").partition(": ")
        detail = f"the boundary r = 1/gamma(theta) bends inwards nowhere: gamma'' + gamma >= 0 {arcs}"
        expected = ("proved", method, detail, "polar-curvature")
        assert told(found) == (expected if convex else None)
    seams = ("proved", "polar-seams", f"gamma > 0 is smooth on each arc, {smooth}", "polar-seams")
    assert told(polar.smoothness(law)) == (seams if smooth else None)
    assert told(polar.dissipation(law)) == (("proved", "euler", EULER, "euler") if star else None)
    closure = ("proved", "polar-form", "K is star-shaped about 0 (if the formula is 0/0 at 0, K is closed there)", "polar-form")
    assert told(polar.origin(law)) == (closure if "/norm" in g and star else None)


def test_a_flow_of_its_own_is_no_gradient_of_the_gauge() -> None:
    assert polar.dissipation(subject("norm(a, b) - 1", flow=A_B)) is None


def test_the_potential_of_a_gauge() -> None:
    found = evidence.duality(subject("norm(a, q*b) - 1", q=POSITIVE))
    assert found is not None and found.verdict is Verdict.PROVED and found.method == "polar-gauge"
    assert found.detail.startswith("Phi(d) = norm(d_a, d_b/q); the dissipation potential is the conjugate")
    assert found.proof == Proof("polar-gauge", {"potential": "norm(d_a, d_b/q)", "slips": {"a": "d_a", "b": "d_b"}})
    flat = evidence.duality(subject("abs(a) - 1"))
    assert flat is not None and flat.proof is not None and flat.proof.evidence["flat"] == ["d_b"]
    assert evidence.duality(subject("norm(a, q*b) - 1", q=UNIT)) is None and evidence.duality(subject("norm(a, b) - q", q=UNIT)) is None
    none = "no closed form found: the rules of the polar gauge give none for the dissipation potential of this law"
    assert evidence.duality(subject("abs(a) + b**2 - 1")) == Evidence(Verdict.NOT_APPLICABLE, "polar-gauge", none)
    part = "no closed form found: the claims have a range of a, and no closed form is known for a part of K"
    assert evidence.duality(subject("norm(a, b) - 1", domain={"a": UNIT})) == Evidence(Verdict.NOT_APPLICABLE, "polar-gauge", part)


@pytest.mark.parametrize("forces", ["a", "ab", "abc"])
def test_the_state_laws(forces: str) -> None:
    found = state_laws.state_laws(subject("norm(" + ", ".join(forces) + ") - 1", forces))
    detail = "sigma = k (u - u_in) = dpsi/du = -dpsi/du_in; psi = |L^T (u - u_in)|^2/2 with k = L L^T is a sum of squares"
    assert found == Evidence(Verdict.PROVED, "symbolic", detail)


def test_what_was_looked_at_proves_nothing(monkeypatch: pytest.MonkeyPatch) -> None:
    one = refuters._tested("no violation at", [720])
    assert one == Evidence(
        Verdict.TESTED, "sampling", "no violation at 720 boundary points of 1 parameter choice (fixed random seeds); this is not a proof"
    )
    two = refuters._tested("no chord was found that leaves K between", [3, 4])
    assert two is not None
    assert (
        two.detail
        == "no chord was found that leaves K between 7 boundary points of 2 parameter choices (fixed random seeds); this is not a proof"
    )
    assert refuters._tested("no violation at", []) is None
    slips = refuters.dissipation_by_sampling(subject("norm(a, b) - 1", flow=A_B))
    assert slips == one and refuters.normality_by_sampling(subject("norm(a, b) - 1", flow=A_B)) == one
    monkeypatch.setattr(refuters, "convexity_by_sampling", lambda subject: two)
    assert refuters.normality_by_sampling(subject("norm(a, b) - 1")) == two
    assert refuters.dissipation_by_sampling(subject("norm(a, b) + 1", flow=A_B)) is None
