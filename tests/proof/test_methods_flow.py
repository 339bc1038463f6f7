"""What is said of the slip direction, each method asked alone: parallel to the normal or not, turned by how much, backward where."""

from __future__ import annotations

import math
from collections.abc import Sequence
from fractions import Fraction
from typing import Any

import pytest

from duhem import Criterion, Domain, Verdict, verify
from duhem.law.criterion_file import reads
from duhem.proof.facts.formula_subject import FormulaSubject
from duhem.proof.methods import evidence, refuters
from duhem.proof.search import boundary_identities
from duhem.proof.search.boundary_points import BoundaryScout, scouts
from duhem.proof.verdict import Evidence, Proof, Witness
from duhem.proof.witness.points import EnclosedPoint
from tests.long import long_at, long_but
from tests.oracles.prover import on_boundary, parallel
from tests.oracles.prover.decide import AskedSubject
from tests.oracles.reevaluation import confirmed

A_B, DISC = ("a", "b"), "a**2 + b**2 - 1"
STAR = "min(a**2 + 4*b**2, 4*a**2 + b**2) - 1"


def subject(
    g: str = DISC, slip: Sequence[str] | None = None, forces: Sequence[str] = A_B, pressure: str | None = None, **of: Any
) -> FormulaSubject:
    parameters = {name: of.pop(name) for name in ("q", "m") if name in of}
    law = Criterion("law", g, forces=tuple(forces), pressure=pressure, flow=slip and tuple(slip), parameters=parameters, **of)
    return AskedSubject(law)


def floats(point: Any, names: Sequence[str] = A_B) -> list[float]:
    return [float(Fraction(point[name])) for name in names]


@pytest.mark.slow
@pytest.mark.parametrize(
    ("g", "slip", "normal"),
    [
        (DISC, ("a", "b"), True),
        (DISC, ("3*a", "3*b"), True),
        (DISC, ("a*(2 + b)", "b*(2 + b)"), True),
        (DISC, ("a*(a**2 + b**2)", "b"), True),  # on the boundary alone
        (DISC, ("-a", "-b"), False),
        (DISC, ("a", "2*b"), False),
        (DISC, ("a - b/100", "b + a/100"), False),
        (DISC, ("a*b", "b*b"), False),  # turns back, and vanishes
        (DISC, ("a*b**2", "b**3"), False),  # vanishes
        (DISC, ("0*a", "0*b"), False),
        ("(a**2 + b**2 - 1)**2", ("a", "b"), False),  # no normal
        ("a**2 + 2*b**2 - 1", ("a", "2*b"), True),
        ("a**2 + 2*b**2 - 1", ("a", "b"), False),
        ("a**2 + b**2 + pos(b)**2 - 1", ("a", "b + pos(b)"), True),
        ("a**2 + b**2 + pos(b)**2 - 1", ("a", "b"), False),
        ("where(a > 0, 1, 2)*(a**2 + b**2) - 1", ("a", "b"), False),  # it jumps
        (DISC, None, False),
    ],
)
def test_a_flow_parallel_to_the_normal(g: str, slip: Sequence[str] | None, normal: bool) -> None:
    found = parallel.normality(subject(g, slip))
    if not normal:
        assert found is None
        return
    detail = "the flow is a non-negative multiple of grad g wherever g = 0, and K is convex"
    assert found is not None and (found.verdict, found.detail) == (Verdict.PROVED, detail) and found.method.startswith("parallel (")
    for offered in evidence.normality_parallel(subject(g, slip)):
        assert offered.proof is not None and offered.proof.rule == "parallel"


def test_in_three_forces_every_pair_of_components_counts() -> None:
    for slip, normal in (("a b c", True), ("a b 2*c", False), ("a 2*b c", False), ("2*a b c", False), ("a b -c", False)):
        assert (parallel.normality(subject("a**2 + b**2 + c**2 - 1", slip.split(), "abc")) is not None) is normal
    (proved,) = evidence.normality_parallel(subject(DISC, ("2*a", "2*b")))
    assert isinstance(proved.proof, Proof)


def _chord(parameters: dict[str, str] | None = None, **points: dict[str, str]) -> Witness:
    return Witness(parameters or {}, points, {}, "made up")


def left_by(chord: Witness) -> dict[str, Evidence]:
    """What is settled where a chord leaves K."""
    return {"convexity": Evidence(Verdict.REFUTED, "witness-chord", "", chord)}


ACROSS = _chord(p={"a": "1", "b": "0"}, q={"a": "0", "b": "1"}, midpoint={"a": "1/2", "b": "1/2"})


@pytest.mark.parametrize("turn", [1, -1])
def test_the_normal_where_a_chord_leaves_the_set(turn: int) -> None:
    ends = {"p": {"a": "1", "b": "0"}, "q": {"a": "0", "b": str(turn)}, "midpoint": {"a": "1/2", "b": f"{turn}/2"}}
    found = refuters.normality_at_chord(subject(STAR), left_by(_chord(**ends)))
    assert found is not None and (found.verdict, found.method) == (Verdict.REFUTED, "witness-normal")
    assert found.detail == "grad g is not in the normal cone where a chord leaves K" and found.witness is not None
    shown, (a, b) = found.witness, floats(found.witness.points["inside"])
    assert set(shown.points) == {"inside", "outside", "tau"} and shown.points["tau"] in (ends["p"], ends["q"])
    normal = min(((2 * a, 8 * b), (8 * a, 2 * b)), key=lambda n: abs(n[0] * a + n[1] * b - 2))
    leaning = sum(n * (t - x) for n, t, x in zip(normal, floats(shown.points["tau"]), (a, b), strict=True))
    low, high = map(float, shown.values["grad g . (tau - sigma)"])
    assert 0 < low - 1e-9 <= leaning <= high + 1e-9
    assert shown.statement.startswith(
        "the way from `inside` to the midpoint of a chord of K crosses the boundary outward, at a sigma between"
    )


def test_a_chord_says_nothing_of_another_flow() -> None:
    assert refuters.normality_at_chord(subject(STAR, A_B), left_by(ACROSS)) is None
    inside = _chord(p={"a": "1/2", "b": "0"}, q={"a": "0", "b": "1/2"}, midpoint={"a": "1/4", "b": "1/4"})
    found = refuters.normality_at_chord(subject(DISC), left_by(inside))
    assert found is not None and (found.verdict, found.method) == (Verdict.UNDECIDED, "witness-chord")
    assert refuters.normality_at_chord(subject(DISC), {"convexity": Evidence(Verdict.UNDECIDED, "none", "")}) is None


def test_a_chord_is_read_with_its_parameters_and_its_pressure() -> None:
    law = subject("a**2 + b**2 - q*abs(p) - p**2", pressure="p", q=Domain.between(0, 1))
    ends = {role: {"a": x, "b": y, "p": "-3"} for role, x, y in (("p", "1", "0"), ("q", "0", "1/3"), ("midpoint", "1/2", "1/6"))}
    parameters, p, q, middle = refuters._read(law, _chord({"q": "2/3"}, **ends))
    table = law.law.symbols()
    magnitude = law.simple.magnitude
    expected = {table["q"]: Fraction(2, 3)} | (
        {magnitude: Fraction(3)} if magnitude in law.simple.parameters and magnitude is not None else {}
    )
    assert parameters == expected and (p, q, middle) == ((1, 0), (0, Fraction(1, 3)), (Fraction(1, 2), Fraction(1, 6)))


def _on_the_circle(inside: Sequence[float], outside: Sequence[float], radius: float = 1.0) -> list[float]:
    """Where the way from one point to the other leaves the disc."""
    low, high = 0.0, 1.0
    for _ in range(60):
        middle = (low + high) / 2
        at = [a + middle * (b - a) for a, b in zip(inside, outside, strict=True)]
        low, high = (middle, high) if math.hypot(*at) <= radius else (low, middle)
    return at


@pytest.mark.parametrize("degrees", [45, -45])
def test_a_flow_that_leans(degrees: int) -> None:
    slip = ("a - b", "b + a") if degrees > 0 else ("a + b", "b - a")
    found = refuters.normality_at_points(subject(DISC, slip))
    assert found is not None and (found.verdict, found.method) == (Verdict.REFUTED, "witness-flow")
    assert found.detail == "the flow leaves the normal cone of K" and found.witness is not None
    shown = found.witness
    inside, outside, tau = (floats(shown.points[role]) for role in ("inside", "outside", "tau"))
    low, high = map(float, shown.values["flow . (tau - sigma)"])
    for x, y in (inside, outside):
        d = (x - y, y + x) if degrees > 0 else (x + y, y - x)
        assert 0 < low - 1e-9 <= d[0] * (tau[0] - x) + d[1] * (tau[1] - y) <= high + 1e-9
    assert math.hypot(*tau) <= 1 + 1e-12 and 0.8 < math.hypot(*inside) <= 1 < math.hypot(*outside) < 1.2
    assert abs(shown.measures["deviation_degrees"] - 45) < 1e-6
    x, y = _on_the_circle(inside, outside)
    assert abs(math.remainder(shown.measures["slip_angle_degrees"] - math.degrees(math.atan2(y, x)) - degrees, 360)) < 1e-6
    assert all(len(text) <= 12 for point in shown.points.values() for text in point.values())
    assert "it is not in the normal cone" in shown.statement


def test_a_flow_that_leans_a_little_shows_close_by() -> None:
    law = subject("a**2 + 2*b**2 - 1", ("a", "2*b + a/500"))
    found = refuters.normality_at_points(law, 1)
    assert found is not None and found.witness is not None and 0 < found.witness.measures["deviation_degrees"] < 0.2


@pytest.mark.slow
@pytest.mark.parametrize(("slip",), long_at([0], zip([("a", "b"), ("2*a*(3 + b)", "2*b*(3 + b)"), None])))
def test_a_normal_flow_is_not_refuted(slip: Sequence[str] | None) -> None:
    assert refuters.normality_at_points(subject(DISC, slip), 1) is None
    assert refuters.dissipation_at_points(subject(DISC, slip), 1) is None


@pytest.mark.parametrize(
    ("g", "slip"), [(DISC, ("-a", "-b")), (DISC, ("a - 3*b", "b - 3*a")), ("(a - 2)**2 + b**2 - 1", None), (DISC, ("a - 3/2", "b"))]
)
def test_a_flow_of_negative_power(g: str, slip: Sequence[str] | None) -> None:
    found = refuters.dissipation_at_points(subject(g, slip), 1)
    assert found is not None and (found.verdict, found.method) == (Verdict.REFUTED, "witness-power")
    assert found.detail == "force . flow is negative on the boundary" and found.witness is not None
    x, y = floats(found.witness.points["inside"])
    d = {"-a": (-x, -y), "a - 3*b": (x - 3 * y, y - 3 * x), "a - 3/2": (x - 1.5, y)}[slip[0]] if slip else (2 * (x - 2), 2 * y)
    low, high = map(float, found.witness.values["force . flow"])
    assert low - 1e-9 <= x * d[0] + y * d[1] <= high + 1e-9 < 0
    assert found.witness.statement == "force . flow < 0 at the boundary point between `inside` and `outside`"


def test_a_flow_of_power_that_is_seldom_negative() -> None:
    assert refuters.dissipation_at_points(subject(DISC, ("a - 2*b", "b + 2*a")), 1) is None
    assert refuters.dissipation_at_points(subject("(a - 1)**2 + b**2 - 1"), 1) is None


def test_angles_between_flow_and_normal() -> None:
    def angles(slip: Sequence[str], x: Fraction, y: Fraction, forces: Sequence[str] = A_B, g: str = DISC) -> dict[str, float]:
        beside = (x + Fraction(1, 10**15), y, Fraction(0))[: len(forces)]
        return refuters._angles(subject(g, slip, forces), EnclosedPoint({}, (x, y, Fraction(0))[: len(forces)], beside))

    x, y = Fraction(3, 5), Fraction(4, 5)
    along = math.degrees(math.atan2(4, 3))
    for slip, apart, slope in (
        (A_B, 0, along),
        (("-b", "a"), 90, along + 90),
        (("-a", "-b"), 180, along - 180),
        (("a + b", "b - a"), 45, along - 45),
    ):
        found = angles(slip, x, y)
        assert abs(found["deviation_degrees"] - apart) < 1e-9 and abs(found["slip_angle_degrees"] - slope) < 1e-9
    assert abs(angles(("a - b/10**9", "b + a/10**9"), x, y)["deviation_degrees"] - math.degrees(1e-9)) < 1e-13
    spatial = angles(("a", "b", "a"), x, y, "abc", "a**2 + b**2 + c**2 - 1")
    assert set(spatial) == {"deviation_degrees"} and abs(spatial["deviation_degrees"] - math.degrees(math.atan(0.6))) < 1e-9
    assert angles(A_B, Fraction(0), Fraction(1), g="a**2 + b**2 + abs(a)*(b - 1) - 1") == {}  # on a seam


def test_chords_of_a_star() -> None:
    for method in (refuters.convexity_by_scouting, refuters.convexity_at_seams):
        found = method(subject(STAR))
        assert found is not None and (found.verdict, found.method) == (Verdict.REFUTED, "witness-chord")
        assert found.detail == "a chord between two points of K leaves K" and found.witness is not None
        p, q, middle = (floats(found.witness.points[role]) for role in ("p", "q", "midpoint"))
        assert all(min(x * x + 4 * y * y, 4 * x * x + y * y) <= 1 for x, y in (p, q))
        assert min(middle[0] ** 2 + 4 * middle[1] ** 2, 4 * middle[0] ** 2 + middle[1] ** 2) > 1
        assert [u + v for u, v in zip(p, q, strict=True)] == pytest.approx([2 * m for m in middle])
        assert method(subject("max(a**2 + 4*b**2, 4*a**2 + b**2) - 1")) is None


def test_chords_across_a_dent() -> None:
    dented = subject("a**4 + b**4 - 3*a**2*b**2/2 - 1")
    for method in (refuters.convexity_at_clear_dents, refuters.convexity_at_deepest_dents, refuters.convexity_at_dents):
        found = method(dented)
        assert found is not None and found.verdict is Verdict.REFUTED and found.method == "witness-chord"
        assert method(subject("a**4 + b**4 + a**2*b**2 - 1")) is None
    assert refuters.convexity_at_dents(subject("a - b**2 - 1")) is not None and refuters.convexity_at_seams(dented) is None
    assert refuters.convexity_at_seams(subject("min(a, b, c) - 1", forces="abc")) is None


@pytest.mark.slow
def test_corners_and_sharp_points() -> None:
    found = refuters.smoothness_at_corners(subject("abs(a) + b**2 - 1"))
    assert found is not None and found.witness is not None and found.witness.points
    assert (found.verdict, found.method, found.detail) == (
        Verdict.REFUTED,
        "witness-corner",
        "the outward normal jumps at a corner of the boundary",
    )
    at = next(iter(found.witness.points.values()))
    assert abs(float(Fraction(at["a"]))) < 1e-6 and abs(abs(float(Fraction(at["b"]))) - 1) < 1e-6
    assert (
        refuters.smoothness_at_corners(subject("a**2 + b**2 + pos(b)**2 - 1")) is None
        and refuters.smoothness_at_corners(subject(DISC)) is None
    )
    tip = refuters.smoothness_at_sharp_points(subject("norm(a, b) + c - 1", forces="abc"))
    assert tip is not None and (tip.verdict, tip.method, tip.detail) == (
        Verdict.REFUTED,
        "witness-sharp-point",
        "the boundary has a sharp point",
    )
    assert refuters.smoothness_at_sharp_points(subject(DISC)) is None
    within = {"b": Domain.between("-1/2", "1/2")}
    assert refuters.smoothness_at_corners(subject("abs(a) + b**2 - 1", domain=within)) is None  # where the claim is not asked
    edge = refuters.smoothness_at_corners(subject("max(norm(a, b), abs(c)) - 1", forces="abc"))
    assert edge is not None and edge.method == "witness-corner"


def test_what_shows_that_a_flow_is_parallel() -> None:
    for slip in (A_B, ("a*(1 + abs(b))", "b*(1 + abs(b))")):
        (known,) = evidence.normality_parallel(subject(DISC, slip))
        assert known.proof is not None and set(known.proof.evidence) == {"along", "across"}
        assert on_boundary.normality_parallel(subject(DISC, slip), {"convexity": Evidence(Verdict.TESTED, "", "")}) is None


@pytest.mark.parametrize("slip", [("-b", "b - m*a"), ("b - m*a", "-b")])
def test_no_identity_is_sought_without_end(slip: tuple[str, str], monkeypatch: pytest.MonkeyPatch) -> None:
    """K is empty: identities of ever higher degrees would be tried, of each component across the normal."""
    monkeypatch.setattr(boundary_identities, "_MOST_STEPS", 100_000)
    asked = subject("a**2 + b**2 - b + 1", slip, m=Domain.between(1, None), domain={"b": Domain.between(0, 1)})
    assert boundary_identities.parallel(asked) == {}
    assert asked.whole.spent <= 100_000  # nothing is sought once one is missing


def test_of_two_surfaces_each_flow_counts() -> None:
    text = '[criterion]\nname = "x"\nforces = ["a", "b"]\npressure = false\n' + "".join(
        f'[[surface]]\ng = "{g}"\nflow = ["{{}}", "{{}}"]\n' for g in (DISC, "a - 1/2")
    )
    for slips, normal in ((("a", "b", "1", "0"), True), (("a", "b", "1", "1/9"), False), (("a", "2*b", "1", "0"), False)):
        law = reads(text.format(*slips))
        assert (parallel.normality(AskedSubject(law)) is not None) is normal  # type: ignore[arg-type]


def test_a_centre_is_inside_at_the_same_parameters() -> None:
    law = subject("(a - 2)**2 + b**2 - q", q=Domain.between(1, 2))
    choice = next(law.choices(1))
    (q,) = choice
    inside = list(refuters._centre(law, choice))
    assert inside and all((x - 2) ** 2 + y * y < choice[q] for x, y in inside)
    assert not list(refuters._centre(law, {q: Fraction(1234, 1001)}))


def test_targets_close_by_are_inside() -> None:
    law = subject("a**2 + 2*b**2 - 1", ("a", "2*b + a/500"))
    scout = next(scouts(law, 1))
    near = list(refuters._on_the_boundary(law, scout))
    assert near and all(0 <= 1 - x * x - 2 * y * y < Fraction(1, 10**9) for _, (x, y) in near)


def test_a_deviation_that_shows_close_by_alone() -> None:
    law = subject("a**2 + 2*b**2 - 1", ("a", "2*b + a/500"))
    assert refuters.normality_at_points(law, 1, near=False) is None


def test_a_flow_towards_zero_force() -> None:
    """At its least power the flow leans towards zero force, wherever else it may lean."""
    law = subject(DISC, ("-a", "-b"))
    exit = next(iter(next(scouts(law, 1)).least_power(5)))
    found = refuters._leans_towards(law, exit, (Fraction(0), Fraction(0)))
    assert found is not None and found.points["tau"] == {"a": "0", "b": "0"}
    assert refuters._leans_towards(law, exit, (Fraction(5), Fraction(5))) is None  # no point of K
    assert refuters._leans_towards(subject(DISC, A_B), exit, (Fraction(0), Fraction(0))) is None


def test_zero_force_is_a_target_by_itself(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(BoundaryScout, "far_targets", lambda scout: iter(()))
    found = refuters.normality_at_points(subject(DISC, ("-a", "-b")), 1, near=False)
    assert found is not None and found.witness is not None and found.witness.points["tau"] == {"a": "0", "b": "0"}


@pytest.mark.parametrize(
    "g",
    long_but(
        [0, 2],
        [
            "a**3 + b**2 - c",
            "a**2*(a**2 - 4)*(a**2 - 9) + b**2 - c",
            "2*sin(a) + b**2 - c",
            pytest.param("a**3 + b**2 + abs(b) - c*(1 + a**2/100)", marks=pytest.mark.long),
        ],
    ),
)
def test_where_a_ray_comes_back_into_k_an_associated_slip_does_work_on_it(g: str) -> None:
    """g falls along the ray there: K is not star-shaped about zero force."""
    law = Criterion("again", g, {"c": Domain(low=1, high=2)}, ("a", "b"), None)
    found = verify(law, claims=["dissipation"])["dissipation"]
    assert found.verdict is Verdict.REFUTED and found.witness is not None and confirmed(law, "dissipation", found.witness)


@pytest.mark.parametrize("angle", ["0", "1/5", "-3/10"])
def test_a_flow_is_refuted_where_zero_force_is_the_apex_of_a_cone(angle: str) -> None:
    """A point of the boundary, drawn towards the apex, stays on it; drawn towards a point inside it lies in K."""
    cone = f"abs(a*cos({angle}) + b*sin({angle})) + (b*cos({angle}) - a*sin({angle}))/2"
    law = Criterion("cone", cone, {}, forces=A_B, pressure=None, flow=(f"sign(a)*cos({angle})", f"sign(a)*sin({angle})"))
    found = refuters.normality_at_points(AskedSubject(law))
    assert found is not None and found.witness is not None and confirmed(law, "normality", found.witness)


@pytest.mark.parametrize(
    ("g", "slip", "ranges"),
    [
        ("abs(a) - q*(2 - b)**m", ("sign(a)", "1/3"), {"b": Domain.between(None, 0)}),
        ("abs(a) - q*(2 + b)**m", ("sign(a)", "1/3"), {"b": Domain.between(0)}),
        ("abs(a) - q*b - m", ("sign(a)", "q/2"), {"b": Domain.between(0)}),
        ("norm(a, b) - q", ("a + b/3", "b"), {"a": Domain.between(0), "b": Domain.between("1/7", 5)}),
        (DISC, ("a", "2*b"), {"a": Domain.between("1/3", "2/3")}),
        (DISC, ("a - 2", "b"), {"b": Domain.between("-1/9", "1/9")}),
    ],
)
def test_where_a_flow_leans_is_shown_in_the_ranges_of_the_forces(g: str, slip: Sequence[str], ranges: dict[str, Domain]) -> None:
    """Rounded points are shown only where they lie in these: else nothing would be refuted."""
    parameters = {"q": Domain(positive=True), "m": Domain.between("1/2", 1)}
    law = Criterion("law", g, {x: d for x, d in parameters.items() if x in g}, A_B, None, flow=tuple(slip), domain=ranges)
    found = verify(law, claims=["normality"])["normality"]
    assert found.verdict is Verdict.REFUTED and found.method == "witness-flow" and confirmed(law, "normality", found.witness)
    assert all(point[name] in span for point in found.witness.points.values() for name, span in ranges.items())
