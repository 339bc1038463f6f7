"""Laws whose set is nothing, everything, a point, a line or not what was meant: none is called what it is not."""

from __future__ import annotations

import re
from dataclasses import replace
from fractions import Fraction

import pytest
import sympy as sp

from duhem import POSITIVE, Criterion, Domain, InputError, Verdict, verify
from duhem.proof.claims import CLAIMS, ProofMethod
from duhem.proof.facts.formula_subject import FormulaSubject
from duhem.proof.facts.subject import rationals
from duhem.proof.verdict import Evidence, Trust
from duhem.proof.verification import Confirmations, Standing
from tests.long import long_at, long_but, mostly_long

PROVED, REFUTED = Verdict.PROVED, Verdict.REFUTED


def law(
    g: str,
    forces: tuple[str, ...] = ("a", "b"),
    flow: tuple[str, ...] | None = None,
    constraints: tuple[str, ...] = (),
    **parameters: Domain,
) -> Criterion:
    pressure = "p" if "(p)" in g else None
    return Criterion(name="law", g=g, forces=forces, pressure=pressure, flow=flow, constraints=constraints, parameters=parameters)


# -- one force ----------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("g", ["abs(a)", "a**2", "abs(a) - q", "pos(a)**2 + neg(a)"])
@pytest.mark.parametrize("forces", [("a",), ("a", "b")])
def test_a_point_or_a_line_has_no_smooth_boundary(g: str, forces: tuple[str, ...]) -> None:
    parameters = {"q": Domain.between(0, 1)} if "q" in g else {}
    assert verify(law(g, forces, **parameters), claims=["smoothness"])["smoothness"].verdict is not PROVED


@pytest.mark.slow
@pytest.mark.parametrize("g", ["abs(a) - m*abs(p)", "a", "-a", "a**2 + a - 1", "max(a - 1, -a/2)", "sqrt(abs(a)) - 1", "a**2 - 1"])
def test_an_interval_with_an_inside_has(g: str) -> None:
    parameters = {"m": POSITIVE} if "m*" in g else {}
    assert verify(law(g, ("a",), **parameters), claims=["smoothness"])["smoothness"].verdict is PROVED


# -- flows --------------------------------------------------------------------------------------------------------------


@pytest.mark.slow
@pytest.mark.parametrize(("flow",), long_but([2], zip([("0*a", "0*b"), ("a*pos(a)", "b*pos(a)"), ("a*abs(a - b)", "b*abs(a - b)")])))
def test_a_flow_that_vanishes_has_no_direction(flow: tuple[str, ...]) -> None:
    assert verify(law("norm(a, b) - 1", flow=flow), claims=["normality"])["normality"].verdict is not PROVED


# -- a vacuous question -------------------------------------------------------------------------------------------------

QUARTIC = "(a**4 + b**4 + c*a**2*b**2 - 1)"
OUTER = ("max({f}, 2*{f})", "{f} + abs({f})/2", "where({f} > 0, 3*{f}, {f})", "2*{f} + pos({f})", "{f} - neg({f})")


@pytest.mark.slow
@pytest.mark.parametrize("outer", mostly_long(OUTER, OUTER[0], OUTER[4]))
def test_a_boundary_along_a_seam_is_asked_about(outer: str) -> None:
    """Convex if and only if 0 <= c <= 6 (the sign of the curvature at 45 degrees and on the axes)."""
    g = outer.format(f=QUARTIC)
    beyond = verify(law(g, c=Domain.fixed("6.001")), claims=["convexity"])["convexity"].verdict
    assert beyond is not PROVED
    assert verify(law(g, c=Domain.fixed(6)), claims=["convexity"])["convexity"].verdict is not REFUTED


# -- closed forms that divide -------------------------------------------------------------------------------------------


@pytest.mark.slow
@pytest.mark.parametrize(
    "g",
    long_at(
        [2, 4],
        [
            "norm(e*a, b) - abs(p)",
            "abs(e*a) + abs(b) - 1",
            "norm(a, a + e*b)**2 + norm(a, e*b)**2 - 1",
            "norm(a, a + e*b, e*b) - 1",
            "norm(a + b, a + (1 - e)*b) - 1",
        ],
    ),
)
def test_a_potential_that_divides_by_what_may_vanish_is_not_proved(g: str) -> None:
    """At e = 0 the set is a strip or a band, and its support function infinite in one direction."""
    assert verify(law(g, e=Domain.between(0, 1)), claims=["duality"])["duality"].verdict is not PROVED
    assert verify(law(g, e=Domain.between("1/2", 1)), claims=["duality"])["duality"].verdict is PROVED


# -- sets that are hardly what was meant --------------------------------------------------------------------------------


@pytest.mark.slow
@pytest.mark.parametrize(
    ("g", "said", "vacuous"),
    [
        ("norm(a, b) - m*p", "K is empty: g > 0 for all forces (p <= 0 in compression: write abs(p))", True),
        ("norm(a, b) + m*abs(p)", "K is empty: g > 0 for all forces", True),
        ("-m - a**2 - b**2", "K contains all forces: g <= 0 everywhere", True),
        ("m*norm(a, b)", "K is the point 0: g > 0 elsewhere", True),
        ("m*(a - b)**2", "K is a line without interior points: g > 0 elsewhere", False),
        ("(a - 1)**2 + m*b**2", "K has no interior points: g >= 0 for all forces, and g = 0 in K", False),
        ("abs(a - b) - m*abs(p)", "K is unbounded: g does not change along 1 direction of the forces", False),
        ("abs(a) - m*b", "K is unbounded: g <= 0 at a = 0, b = t for all t > 0", False),
        ("norm(a, b) - abs(p)", "g does not depend on m", False),
        ("norm(a, b) - a/a - m", "duhem could not show that g has a value for all forces: it divides by a. ", False),
    ],
)
def test_an_odd_law_is_named_first(g: str, said: str, vacuous: bool) -> None:
    stated = Criterion(name="law", g=g, forces=("a", "b"), pressure="p" if "p" in g else None, parameters={"m": POSITIVE})
    found = verify(stated, claims=["origin", "dissipation"])
    assert found.remarks[0].startswith(said) and (said.endswith(". ") or found.remarks[0] == said)
    assert found.vacuous is vacuous
    assert found.dissipative is not True or not vacuous
    assert not vacuous or "dissipative: the claim says nothing here" in found.to_text()


def test_a_remark_has_the_law_s_own_name_of_the_pressure() -> None:
    remarks = verify(Criterion("own names", "norm(a, b) + p/2", forces=("a", "b"), pressure="p"), claims=["origin"]).remarks
    place = "that point is inside K for p < 0, so the boundary is not touched"
    assert remarks == (f"g is not differentiable at zero force; {place}",)


def test_an_ordinary_law_is_not_called_odd() -> None:
    for name in ("antoni2007", "quartic"):
        found = verify(name, claims=["origin"])
        odd = ("K ", "It is not", "g does not depend", "g has no value")
        assert not found.vacuous and not [r for r in found.remarks if r.startswith(odd)]
    for g in ("norm(q*a, b) - 1", "norm(a, b) - q"):  # odd at q = 0 alone
        assert not [r for r in verify(law(g, q=Domain.between(0, 1)), claims=["origin"]).remarks if r.startswith("K ")]


@pytest.mark.parametrize("claim", ["convexity", "smoothness", "normality"])
def test_a_prover_that_lies_proves_nothing(claim: str) -> None:
    """Only what the kernel confirms counts: of the disk it finds a rule by itself, of the astroid and the turned flow none."""
    lying = replace(CLAIMS[claim], methods=(ProofMethod(FormulaSubject, lambda _: Evidence(PROVED, "spoilt", "")),))
    turned = law("norm(a, b) - 1", flow=("a - 9*b", "b + 9*a"))
    false = turned if claim == "normality" else law("sqrt(abs(a)) + sqrt(abs(b)) - 1")
    assert lying.examine(FormulaSubject(false), {}, Confirmations(false)).verdict is Verdict.UNDECIDED
    assert lying.examine(FormulaSubject(false), {}).verdict is Verdict.UNDECIDED
    disk = law("norm(a, b) - 1")
    kernel = Confirmations(disk, standings={name: Standing(Trust.CHECKED) for name in ("origin", "convexity")})
    assert lying.examine(FormulaSubject(disk), {}, kernel).verdict is PROVED


# -- what was tested ----------------------------------------------------------------------------------------------------


@pytest.mark.slow
@pytest.mark.parametrize(
    ("constraints",),
    long_at([1], zip([("e < m", "m < e + 1e-6"), ("3*e <= 2*m", "2*m <= 3*e"), ("m**2 < 2*e**2", "2*e**2 < m**2 + 1e-9")])),
)
def test_parameters_are_drawn_inside_thin_constraints(constraints: tuple[str, ...]) -> None:
    unit = Domain.between(0, 1)
    subject = FormulaSubject(law("norm(a, b) - e*tanh(a) - m", constraints=constraints, e=unit, m=unit))
    drawn = list(subject.choices(8))
    e = subject.law.symbols()["e"]
    assert len({values[e] for values in drawn}) >= 6
    assert max(values[e] for values in drawn) > Fraction(1, 4)
    assert all(c.subs(rationals(values)) == sp.true for c in subject.law.constraints for values in drawn)


def test_sampling_says_what_it_looked_at() -> None:
    found = verify(law("abs(a) + a**2*b**2*tanh(b)**2 - b"), claims=["dissipation"])["dissipation"]
    assert found.verdict is Verdict.TESTED
    assert re.match(r"no violation at \d\d+ boundary points of 1 parameter choice ", found.detail)  # 0 is an apex of K


def test_a_part_of_k_that_no_ray_from_an_apex_leaves_is_found() -> None:
    found = verify(law("abs(a) + a**2*b**2*tanh(b) - b"), claims=["dissipation"])["dissipation"]  # b < 0 with a far away is in K too
    assert found.verdict is Verdict.REFUTED and found.witness is not None


def test_without_a_boundary_point_nothing_was_tested() -> None:
    found = verify(law("tanh(a**2)*cos(a) + 1", ("a",)), claims=["convexity", "dissipation"])
    assert {r.verdict for r in found.results} == {Verdict.UNDECIDED}


@pytest.mark.parametrize(
    "g",
    long_but(
        [1, 2, 5], ["abs(norm(a, b) - 1)", "abs(a*b)", "(a**2 + b**2 - 1)**2", "a**2*b**2", "min(abs(a), abs(b)) - 1", "1 - norm(a, b)"]
    ),
)
def test_where_a_chord_leaves_k_no_look_for_chords_is_reported_as_vain(g: str) -> None:
    found = verify(law(g), claims=["convexity", "normality"])
    assert found["convexity"].verdict is REFUTED and found["normality"].verdict in (REFUTED, Verdict.UNDECIDED)
    assert "no chord was found" not in found["normality"].detail


@pytest.mark.parametrize("constraint", ["b > 4/b", "b > sqrt(b - 3)", "1/(b - 3) > 0"])
@pytest.mark.parametrize("domain", long_but([1, 3], [Domain.between(0, 5), Domain.between(0), Domain(), POSITIVE]))
def test_a_constraint_does_not_hold_where_it_has_no_value(constraint: str, domain: Domain) -> None:
    """There SymPy has zoo or I, which it compares with nothing; the kernel proves nothing where a constraint may have no value."""
    found = verify(law("norm(x, y) - 1 + 0*b", ("x", "y"), constraints=(constraint,), b=domain), claims=["origin", "convexity"])
    assert not {r.verdict for r in found.results} & {REFUTED}
    decided = law("norm(x, y) - 1 + 0*b", ("x", "y"), constraints=(constraint,), b=Domain.between(Fraction(7, 2), 5))
    assert {r.verdict for r in verify(decided, claims=["origin", "convexity"]).results} == {PROVED}


def test_a_constraint_that_no_value_satisfies_is_an_error() -> None:
    with pytest.raises(InputError, match="no parameter values satisfy"):
        verify(law("norm(x, y) - b", ("x", "y"), constraints=("b > 4/b",), b=Domain.between(0, 2)))


# -- ends of the run ----------------------------------------------------------------------------------------------------


@pytest.mark.long
@pytest.mark.parametrize("c", [1, 5])
def test_a_curvature_that_stays_open_in_three_forces_ends_no_run(c: int) -> None:
    found = verify(law(f"a**4 + b**4 + c**4 + {c}*a**2*b**2*c**2 - 1", ("a", "b", "c")), claims=["convexity"])
    assert found["convexity"].verdict is not REFUTED  # 20,000 points of the boundary show no dent


def test_what_is_empty_for_some_parameters_is_not_called_unbounded() -> None:
    assert not any("unbounded" in line for line in verify(law("a**2 + q", q=Domain.between(-1, 1)), claims=["origin"]).remarks)
    assert any("unbounded" in line for line in verify(law("a**2 - q", q=Domain.between(1, 2)), claims=["origin"]).remarks)


@pytest.mark.slow
@pytest.mark.parametrize(
    "g",
    long_at(
        [1, 3],
        [
            "abs(a**3 - b) + exp(exp(exp(a/10)*b)) - 3",  # Newton's method leaps to where no number can be written out
            "max(norm(a, b) - 1, norm(a, b)*log(1 - abs(p)))",
            "norm(a, b) - sqrt(1 - abs(p))",
            "max(norm(a, b) - 1, 1/(a*b))",
            "max(where(a > 1, 1, -1), where(b > 1, 1, -1))",
            "min(norm(a, b) - 1, 2*pos(b)/b - 1/2)",
        ],
    ),
)
def test_no_formula_ends_the_run(g: str) -> None:
    claims = ["smoothness"] if "exp" in g else ["origin", "convexity", "smoothness"]
    assert not [r for r in verify(law(g), claims=claims).results if r.claim == "smoothness" and r.verdict is PROVED]


@pytest.mark.parametrize("level", ["46", "200"])
def test_all_but_a_hole_that_is_small_from_afar_is_not_convex(level: str) -> None:
    below = ["pos(7*a/5 + b/3)", "pos(-a - 7*b/5)", "pos(a + b/4)", "pos(a + 3*b/10)", "pos(b/5 - a)", "pos(a/5 - b)"]
    weights = {"3/10": (2, 0.4, 0.7, 1, 0.8, 1), "13/10": (0.8, 0.1, 1, 0.7, 0.8, 0.9)}
    inner = {last: " + ".join(f"{w}*{z}" for w, z in zip(row, below, strict=True)) for last, row in weights.items()}
    g = f"{level} - " + " - ".join(f"({last})*pos({sums} - 1/2)" for last, sums in inner.items())
    found = verify(law(g), claims=["convexity"])["convexity"]
    assert (found.verdict, found.method) == (REFUTED, "witness-chord")
