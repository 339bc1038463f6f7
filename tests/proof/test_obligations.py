"""A formula that is undefined somewhere is not proved to be what it becomes once its parts have cancelled."""

from __future__ import annotations

import re

import pytest

from duhem import POSITIVE, Criterion, Domain, InputError, ParametricCriterion, Verdict, YieldSurface, verify
from duhem.law.criterion_file import reads
from duhem.proof.certificate import law_as_text
from duhem.proof.decide.question import obligations
from duhem.proof.facts.formula_subject import FormulaSubject
from duhem.proof.verdict import Trust
from tests.long import long_but, mostly_long

UNIT, SYMMETRIC = Domain.between(0, 1), Domain.between(-1, 1)


def law(g: str, forces: tuple[str, ...] = ("a", "b"), flow: tuple[str, ...] | None = None, **parameters: Domain) -> Criterion:
    return Criterion(name="law", g=g, forces=forces, pressure="p" if "(p)" in g else None, flow=flow, parameters=parameters)


@pytest.mark.parametrize(
    ("g", "domain", "message"),
    [
        ("norm(a, b) - max(1, log(q))*abs(p)", SYMMETRIC, "takes the logarithm of q, which is negative at q = "),
        ("max(norm(a, b) - 1, log(q))", UNIT, "takes the logarithm of q, which is 0 at q = 0"),
        ("norm(a, b) - exp(log(q))", UNIT, "takes the logarithm of q, which is 0 at q = 0"),
        ("norm(a, b) - sqrt(q)**2", SYMMETRIC, "takes a root of q, which is negative at q = "),
        ("norm(a, b) - q/q", UNIT, "divides by q, which is 0 at q = 0"),
        ("norm(a, b) - 1 + 0*log(q)", UNIT, "takes the logarithm of q, which is 0 at q = 0"),
        ("norm(a, b) - 1 + 0/(exp(q) - 1)", UNIT, r"divides by exp\(q\) - 1, which is 0 at q = 0"),
        ("norm(a, b) - 2**(1/q)", UNIT, "divides by q, which is 0 at q = 0"),
        ("norm(a, b) - 1 - q**(q - 1/2)", UNIT, "takes a power of q, which is 0 at q = 0"),
        ("norm(a, b) - 1 - abs(tan(2*q))", UNIT, r"divides by cos\(2\*q\), which is 0 somewhere between q = "),
        ("norm(a, b) - 1/(q**2 - 1/2)", UNIT, r"divides by q\*\*2 - 1/2, which is 0 somewhere between q = "),
        ("where(q > 1/2, norm(a, b), norm(a, b)/q) - 1", UNIT, "divides by q, which is 0 at q = 0"),
    ],
)
def test_a_law_undefined_for_admitted_parameters_is_an_error(g: str, domain: Domain, message: str) -> None:
    with pytest.raises(InputError, match=f"g {message}"):
        verify(law(g, q=domain), claims=["origin"])


@pytest.mark.parametrize(
    ("g", "domain"),
    [
        ("norm(a, b) - exp(log(q))", POSITIVE),
        ("norm(a, b) - q**(q + 1/2)", UNIT),
        ("where(q > 0, norm(a, b)/q, norm(a, b)) - 1", UNIT),
        ("where(q <= 0, norm(a, b), norm(a, b)*exp(log(q))) - 1", UNIT),
        ("norm(a, b)**q - 1", Domain.between("1/2", 3)),
        ("norm(a, b) - (1 + q)**(q - 1/2)", UNIT),
        ("norm(a, b) - tan(q)", Domain.between("1/10", "3/2")),
        ("norm(a, b) - 1/(1 + q**2)", Domain()),
    ],
)
def test_what_is_defined_over_its_whole_domain_may_be_proved(g: str, domain: Domain) -> None:
    assert FormulaSubject(law(g, q=domain)).doubtful == ()


CANCELLED = (
    "norm(a, b) - (1 + a/abs(a)/2)*abs(p)",  # two half-discs
    "norm(a, b) - (1 + pos(a)/a/2)*abs(p)",
    "norm(a, b) - (1 + sqrt(a**2)/a/2)*abs(p)",
    "norm(a, b) - a/a",  # a disc without its diameter
    "norm(a, b) - 1 + 0*log(abs(a))",
    "norm(a, b) - 1 + 0*exp(log(a))",  # half a disc
    "exp(log(a)) + b**2 - 1",
    "sqrt(a)**2 + b**2 - 1",
    "pos(a)*sqrt(a) + b**2 - 1",
    "a**3/a + b**2 - 1",
    "max(norm(a, b) - 1, norm(a, b) - 2 - b/(a - 3))",  # a pole far away
    "norm(a, b) - 1 + 0*tan(a)",
    "(a/abs(a))**2*norm(a, b) - 1",
)


@pytest.mark.slow
@pytest.mark.parametrize("g", long_but([*range(5), 6, 7, 11, 12], CANCELLED))
def test_nothing_is_proved_of_a_formula_that_is_undefined_at_some_forces(g: str) -> None:
    """But that 0 is in K, where the formula has a value there, and that no ray from 0 enters K again, a line missing or not."""
    at_zero = {"origin"} if "sqrt(a)" in g or "a - 3" in g or "tan" in g else set()
    along_rays = {"dissipation"} if "sqrt(a)" in g or "abs(a))**2" in g or "a/abs(a)/2" in g else set()
    proved = {r.claim: r.trust for r in verify(law(g)).results if r.verdict is Verdict.PROVED}
    assert proved.keys() <= {"state_laws"} | at_zero | along_rays
    assert proved.get("origin", Trust.CHECKED) is Trust.CHECKED


@pytest.mark.parametrize("g", ["exp(log(a)) + b**2 - 1 - a", "sqrt(a + 1)**2 + b**2 - 3", "norm(a, b) - 1 + 0*log(b + 2)"])
def test_a_witness_lies_where_the_formula_is_defined(g: str) -> None:
    """Convex sets, once what is undefined is left out: simplified formulas must not refute them."""
    assert not [r.claim for r in verify(law(g), claims=["convexity"]).results if r.verdict is Verdict.REFUTED]


@pytest.mark.slow
@pytest.mark.parametrize("claims", mostly_long([["origin", "convexity"], None], ["origin", "convexity"]))
def test_zero_over_zero_at_zero_force_is_taken_by_closure(claims: list[str] | None) -> None:
    """A quotient of equal degrees in the forces: what it is at zero force alone does not matter."""
    found = verify(law("max(a**2/(a**2 + b**2) - 1, norm(a, b) - abs(p))"), claims=claims)
    assert not [r.claim for r in found.results if r.verdict is Verdict.REFUTED]
    assert verify(law("norm(a, b)**3/norm(a, b)**2 - abs(p)"), claims=["convexity"])["convexity"].verdict is Verdict.PROVED


@pytest.mark.slow
@pytest.mark.parametrize(
    ("flow",),
    long_but(
        [1, 2],
        zip([("a*log(b)**2", "b*log(b)**2"), ("a*log(b)/log(b)", "b + 0*log(b)"), ("a + 0/b", "b"), ("a", "sqrt(b)**2 + b - sqrt(b)**2")]),
    ),
)
def test_a_flow_that_is_undefined_somewhere_proves_nothing_of_the_flow(flow: tuple[str, str]) -> None:
    found = verify(law("norm(a, b) - 1", flow=flow), claims=["convexity", "normality", "dissipation"])
    assert [r.claim for r in found.results if r.verdict is Verdict.PROVED] == ["convexity"]
    assert [r.claim for r in found.results if r.verdict is Verdict.REFUTED] == []
    assert "duhem could not show that the flow has a value on the whole boundary" in found.remarks[0]


def test_a_flow_is_certified_as_it_was_written() -> None:
    written = law("norm(a, b) - 1", flow=("a*exp(log(2))", "b + b"))
    assert law_as_text(written)["flow"] == ["a*exp(log(2))", "b + b"]
    assert law_as_text(written.fix({}))["flow"] == ["a*exp(log(2))", "b + b"]
    read = reads('[criterion]\nname = "f"\nforces = ["a", "b"]\ng = "norm(a, b) - 1"\n[flow]\ndirection = ["a/a*a", "b"]')
    assert law_as_text(read)["flow"] == ["a/a*a", "b"]


def test_bounds_hold_for_what_is_tied_to_a_parameter_too() -> None:
    tied = Criterion("tied", "norm(a, b)/q - 1", {"q": Domain.between(0, 1), "m": Domain.between("1/2", 1)}, ("a", "b"), None, ("q >= m",))
    assert verify(tied, claims="convexity")["convexity"].verdict is Verdict.PROVED
    loose = Criterion("loose", "norm(a, b)/q - 1", {"q": Domain.between(0, 1), "m": Domain.between(0, 1)}, ("a", "b"), None, ("q >= m",))
    with pytest.raises(InputError, match="divides by q, which is 0 at q = 0"):
        verify(loose)


def test_a_divisor_that_jumps_over_zero_is_never_zero() -> None:
    assert FormulaSubject(law("norm(a, b)/where(q > 1, 1, -1) - 1", q=Domain.between(0, 2))).doubtful == ()
    with pytest.raises(InputError, match="which is 0"):
        verify(law("norm(a, b)/(q - 1) - 1", q=Domain.between(0, 2)))


def test_a_polar_angle_is_continued_across_the_pole_of_its_tangent() -> None:
    assert FormulaSubject(law("norm(a, b) - 1 - cos(2*atan(b/a))/10")).doubtful == ()
    assert FormulaSubject(law("norm(a, b) - 1 - cos(3*atan(b/a))/10")).doubtful != ()


@pytest.mark.slow
@pytest.mark.parametrize("name", long_but([0, 1, 3, 4], ["abs_p", "N", "t", "tip", "rho0", "theta", "v0", "x0"]))
def test_a_parameter_may_have_any_name(name: str) -> None:
    """K holds the origin for one sign of the parameter only, and is a disc whatever it is called."""
    found = verify(law(f"norm(a, b) - {name}*abs(p)", **{name: POSITIVE}), claims=["origin", "duality"])
    assert found["origin"].verdict is Verdict.PROVED and f"{name}" in found["duality"].detail
    turned = verify(law(f"norm(a, b) - ({name} - abs(p))", **{name: POSITIVE}), claims=["origin"])
    assert turned["origin"].verdict is Verdict.REFUTED


def test_names_that_python_spells_alike_are_one_name() -> None:
    twins = {"\N{MICRO SIGN}": POSITIVE, "\N{GREEK SMALL LETTER MU}": UNIT}
    with pytest.raises(InputError, match="given twice, in two spellings"):
        Criterion(name="law", g="norm(a, b) - 1", forces=("a", "b"), parameters=twins)


@pytest.mark.parametrize(
    ("flow", "low", "message"),
    [
        (("a/q", "b/q"), 0, "divides by q, which is 0 at q = 0; .* q != 0 .positive = true"),
        (("a*log(q)", "b*log(q)"), 0, "takes the logarithm of q, which is 0 at q = 0; .* q > 0 .positive = true"),
        (("a*sqrt(q - 1/4)", "b"), 0, r"takes a root of q - 1/4, which is negative at q = 1/\d+; admit only values with q >= 1/4$"),
        (("a", "b*sqrt(1/4 - 2*q)"), 0, "takes a root of .*; admit only values with q <= 1/8$"),
        (("a*sqrt(q**2 - 1)", "b"), 0, r"takes a root of .*; admit only values with q\*\*2 - 1 >= 0$"),
        (("a", "b/(q - 2)"), 0, "divides by q - 2, which is 0 .*; admit only values with q != 2$"),
    ],
)
def test_a_flow_undefined_for_admitted_parameters_is_an_error_of_the_flow(flow: tuple[str, str], low: int, message: str) -> None:
    with pytest.raises(InputError, match=f"^law: the flow {message}"):
        FormulaSubject(law("norm(a, b) - 1", flow=flow, q=Domain.between(low))).check_defined()
    surfaces = (YieldSurface("abs(a) - 1"), YieldSurface("abs(b) - 1", flow=flow))
    several = Criterion(name="law", surfaces=surfaces, forces=("a", "b"), pressure=None, parameters={"q": Domain.between(low)})
    with pytest.raises(InputError, match=f"^law: the flow of surface 2 {message}"):
        FormulaSubject(several).check_defined()


@pytest.mark.slow
@pytest.mark.parametrize(
    ("root", "low", "at"),
    [
        ("-p - 1", None, r"p = -1/\d+: it takes a root of abs\(p\) - 1"),
        pytest.param("p + 1", "-1.0000001", r"p = -10000001/10000000: it takes a root of 1", marks=pytest.mark.long),
        pytest.param("p + q", None, r"q = \S+, p = -\S+: it takes a root", marks=pytest.mark.long),
    ],
)
def test_a_flow_without_a_value_at_some_pressure_is_said_and_loses_no_other_claim(root: str, low: str | None, at: str) -> None:
    flow, domain = (f"a*sqrt({root})", f"b*sqrt({root})"), {"p": Domain.between(low)} if low else {}
    own = {"q": POSITIVE} if "q" in root else {}
    odd = Criterion("law", "norm(a, b) + p", own, ("a", "b"), "p", flow=flow, domain=domain)
    found = verify(odd, claims=["origin", "dissipation"], effort="quick")
    assert {r.claim for r in found.results if r.verdict is Verdict.PROVED} == {"origin"}
    assert re.match(f"The flow has no value at {at}", found.remarks[0])


def test_a_flow_with_a_value_at_every_admitted_pressure_is_not_said_to_have_none() -> None:
    for root, low in (("p + 1", "-1"), ("1 - p", None)):
        flow, domain = (f"a*sqrt({root})", f"b*sqrt({root})"), {"p": Domain.between(low)} if low else {}
        subject = FormulaSubject(Criterion("law", "norm(a, b) + p", {}, ("a", "b"), "p", flow=flow, domain=domain))
        assert all(subject.broken_at(o) is None for o in obligations(subject.problem.stated_flows[0][0]))


@pytest.mark.slow
def test_the_search_is_silent_where_there_is_nothing_to_measure() -> None:
    """Warnings are errors here: points that stand still, slips of no length, sizes beyond doubles."""
    for boundary, flow in ((("cos(phi)", "0"), None), (("0", "0"), None), (("cos(phi)", "0"), ("0", "0"))):
        verify(ParametricCriterion("law", boundary, flow=flow), effort="quick")
    verify(law("sign(a) - 1/2"), effort="quick")
    verify(law("norm(a, b)/1e300 - 1", flow=("1e200*a", "1e250*b")), effort="quick")
