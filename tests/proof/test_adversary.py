"""Laws built to deceive the proof methods: a wrong verdict is never given, whatever else stays open.

Each row states what is true, derived by hand.  A claim that is true must not be refuted, one that is false must not be
proved; open, tested and not applicable are honest answers.  Claims a row leaves out have no agreed truth there.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

import pytest
import sympy as sp

from duhem import POSITIVE, Criterion, Domain, InputError, Verdict, verify
from duhem.expression.abbreviations import Stress
from tests.long import mostly_long

UNIT = Domain.between(0, 1)
CLAIMS = {"o": "origin", "c": "convexity", "s": "smoothness", "n": "normality", "d": "dissipation", "u": "duality"}


@dataclass(frozen=True)
class Row:
    """``a``, ``b`` are the forces and ``p`` the pressure; ``true`` and ``false`` name claims by first letter (u: duality)."""

    name: str
    g: str
    true: str = ""
    false: str = ""
    parameters: dict[str, Domain] = field(default_factory=dict)
    flow: tuple[str, ...] | None = None
    forces: tuple[str, ...] = ("a", "b")

    def law(self) -> Criterion:
        pressure = "p" if "abs(p)" in self.g else None
        return Criterion(name=self.name, g=self.g, parameters=self.parameters, flow=self.flow, forces=self.forces, pressure=pressure)


ROWS = (
    # Newton's method for a corner comes to where a logarithm has no value
    Row("log-of-a-size", "abs(a) + abs(b) + log(abs(a - 2*b)) - 1", false="s"),
    Row("log-of-a-size-in-a-cone", "norm(a, b) + log(abs(a)) - 1"),
    # seams that cross at zero force, which has no size to measure a chord by
    Row(
        "griffith-continuous",
        "where(3*max(a, b) + min(a, b) > 0, 2*max(a, b)*(max(a, b) - 1), (a - b)**2/8 + a + b)",
        true="oc",
    ),
    # a tangent beyond a right angle has another sign than its angle
    Row("hyperbola by tan(2)", "a**2 + b**2*tan(2) - 1", "o", "c"),
    Row("hyperbola by a hair", "a**2 + b**2*(tan(2) + 2.185039863261518991643306102313682543432) - 1", "o", "c"),
    Row("lozenge turned out", "abs(a) + abs(b)*(tan(2) + 2) - 1", "o", "c"),
    Row("hyperbolas of a range", "a**2 + b**2*tan(q) - 1", "o", "c", {"q": Domain.between(2, 3)}),
    Row("empty by tan(2)", "a**2 + b**2 - tan(2)", "", "o"),
    Row("empty by a range", "norm(a, b) - c*tan(q)", "", "o", {"c": POSITIVE, "q": Domain.between(2, 3)}),
    Row("turned back by tan(2)", "norm(a, b) - 1", "ocs", "nd", flow=("a*tan(2)", "b*tan(2)")),
    Row("ellipse by tan(-2)", "a**2 + b**2*tan(-2) - 1", "ocsnd"),
    # Outside of a set that would be admissible: the sign of both halves of g = A - B is wrong.
    Row("outside-disc", "abs(p) - norm(a, b)", "s", "ocnd"),
    Row("outside-disc-weighted", "k*(abs(p) - norm(a, b))", "s", "ocnd", {"k": POSITIVE}),
    Row("outside-disc-pressure", "abs(p)*(1 - norm(a, b))", "s", "ocnd"),
    Row("outside-ellipse", "1 - a**2 - 4*b**2", "s", "ocnd"),
    Row("outside-ball", "abs(p) - norm(a, b, c)", "s", "ocnd", forces=("a", "b", "c")),
    Row("outside-interval", "abs(p) - abs(a)", "", "ocnd", forces=("a",)),
    Row("outside-and-origin", "abs(p)*norm(a, b) - norm(a, b)**2", "o", "cnd"),
    # A common factor of A and B that vanishes or changes sign belongs to the set.
    Row("disc-and-line", "a**2*(norm(a, b) - abs(p))", "o", "cn"),
    Row("half-disc-half-outside", "a*(norm(a, b) - 1)", "o", "csnd"),
    # A branch that holds only on a line.
    Row("thin-square", "where(a**2 > 0, a**2 + b**2, 0) - 1", "o", "cn"),
    Row("thin-factor", "norm(a, b)*where(a**2 > 0, 1, 0) - abs(p)", "o", "cn"),
    Row("thin-abs", "where(abs(a) > 0, norm(a, b), 0) - 1", "o", "cn"),
    Row("thin-nested", "where(a >= 0, where(a <= 0, 0, norm(a, b)), norm(a, b)) - 1", "o", "cn"),
    Row("punctured-disc", "norm(a, b) + where(norm(a, b) > 0, 0, 5) - 1", "", "ocn"),
    Row("thin-flow", "norm(a, b) - abs(p)", "ocs", "nd", flow=("where(b**2 > 0, a, -a)", "b")),
    Row("thin-flow-abs", "norm(a, b) - 1", "ocs", "nd", flow=("where(abs(b) > 0, a, -a)", "b")),
    # Where a logarithm is not defined, nothing is in the set.
    Row("log-annulus", "log((a**2 + b**2)/p**2 - 1) + 0*abs(p)", "", "ocn"),
    Row("log-strips", "log(a**2 - 1)", "", "ocn", forces=("a",)),
    Row("log-beyond", "log(a - 1)", "c", "o", forces=("a",)),
    # The gradient of g vanishes on the boundary; the normal of K does not.
    Row("square-of-ramp", "pos(norm(a - 2, b) - 1)**2", "cn", "od"),
    Row("square-of-ramp-against", "pos(norm(a, b) - abs(p))**2", "oc", "nd", flow=("-a", "-b")),
    Row("square-of-ramp-across", "pos(norm(a, b) - 1)**2", "oc", "n", flow=("b", "-a")),
    Row("odd-powers", "((a - 2)**2 + b**2 - 1)**3 + ((a - 2)**2 + b**2 - 1)**5", "csn", "od"),
    Row("one-point", "(a - 1)**2 + b**2", "cn", "od"),
    Row("circle-only", "(a**2 + b**2 - 1)**2", "", "ocn"),
    # The boundary is not where g = 0.
    Row("jump", "where(a > -1/2, 1, -1)", "csn", "od"),
    Row("jump-against", "where(a > 1, 1, -1)", "ocs", "nd", flow=("-1", "0")),
    Row("pole-against", "1/(norm(a, b) - 2)", "oc", "nd", flow=("-a", "-b")),
    Row("pole-far-away", "(a**2 + b**2 - 1)/(1 - 1e-16*(a**2 + b**2))", "o", "cn"),
    Row("pole-at-one-value", "(a**2 + b**2 - 1)/(1 + ((q - 1/3)**2 - 1e-6)*(a**2 + b**2))", "o", "cn", {"q": UNIT}),
    Row("poles", "tan(a) + b - 1", "o", "cn"),
    Row("quotient", "1/a + b - 1", "", "cn"),
    # A dent that shows for a sliver of the parameters only, on a seam whose switch has no gradient.
    Row("cubic-switch", "where(a**3 >= 0, a, -a)*((q - 1/3)**2 - 1e-6) + 3*b - 1", "o", "cn", {"q": UNIT}),
    # Hidden kinks.
    Row("hidden-square-root", "sqrt(a**2 - 2*a*b + b**2) + norm(a, b) - 1", "ocnd", "s"),
    Row("hidden-norm", "norm(a - b, b - a) + norm(a, b) - 1", "ocnd", "s"),
    Row("norm-of-one-side", "norm(pos(-a), a - 2) - 1/3", "", "od"),
    Row("norm-of-maximum", "norm(max(a - b, b), neg(a)**3) - 3", "o", "s"),
    Row("norm-with-branch-root", "norm(norm(a + 1, 2*a - b)**2, norm(neg(a + 1/2)**(3/2), neg(a + 1)**2)) - 1/3"),
    Row("branch-without-forces", "abs(a) + max(a + b, a + 1) - 1/3", "c", ""),
    Row("branch-by-another", "max(where(a + 1 >= 1/2, min(a + 1/2, a - 2), pos(a + 1/2)), norm(abs(b - 1), neg(a + 1)**(3/2))) - 2"),
    Row("removable-kink", "abs(a)*abs(a) + b**2 - 1", "ocsnd"),
    Row("redundant-maximum", "max(norm(a, b), abs(a)) - 1", "ocsnd"),
    Row("redundant-minimum", "min(norm(a, b) - 1, norm(a - 1/2, b) - 1/2)", "ocsnd"),
    Row("touching-discs", "min(norm(a - 1, b) - 1, norm(a + 1, b) - 1)", "od", "csn"),
    # Exponents that cross 1, or a parameter that reaches 0.
    Row("concave-power", "abs(a)**q + abs(b)**q - 1", "o", "csn", {"q": Domain.between("1/2", 3)}),
    Row("power-from-one", "abs(a)**q + abs(b)**q - 1", "ocn", "s", {"q": Domain.between(1, 3)}),
    Row("weight-reaches-zero", "q*norm(a, b) - 1", "ocn", parameters={"q": UNIT}),
    Row("width-reaches-zero", "norm(a, q*b) - 1", "ocsnd", "", {"q": UNIT}),
    Row("size-reaches-zero", "norm(a, b) - q", "ocnd", "", {"q": UNIT}),
    # Everything, nothing, and formulas that are undefined almost everywhere.
    Row("everything", "-1 - a**2 - b**2", "ocsnd"),
    Row("everything-in-one-direction", "-1 - a**2", "ocsnd"),
    Row("nothing", "norm(a, b) + abs(p)", "c", "o"),
    Row("defined-far-away", "sqrt(a - 1e6) - 1", "c", "o"),
    Row("flow-undefined", "norm(a, b) - 1", "ocs", "n", flow=("log(a - 5)", "b")),
    Row("quartic-under-pressure", "abs(p)*(1 - a**2 - 2*b**2 + a**4)", "", "ocnd"),
    Row("quartic-weighted", "k*(1 - a**2 - 2*b**2 + a**4)", "", "ocnd", {"k": POSITIVE}),
    Row("annulus", "(norm(a, b) - 2)**2 - 1", "s", "ocnd"),
    Row("half-plane-without-origin", "1 - a", "cs", "od"),
)

DEAR = (  # most of the time of all
    *("branch-by-another", "norm-with-branch-root", "cubic-switch", "odd-powers"),
    *("hidden-square-root", "pole-at-one-value", "redundant-minimum", "pole-against"),
    *("redundant-maximum", "square-of-ramp", "quartic-under-pressure", "thin-flow"),
    *("outside-ball", "outside-disc-weighted", "outside-disc-pressure", "square-of-ramp-against", "touching-discs", "concave-power"),
    *("norm-of-maximum", "punctured-disc", "quartic-weighted", "annulus", "size-reaches-zero"),
    *("lozenge turned out", "empty by a range", "turned back by tan(2)"),
)


@pytest.mark.slow
@pytest.mark.parametrize("row", mostly_long(ROWS, *(row for row in ROWS if row.name not in DEAR)), ids=lambda row: row.name)
def test_never_a_wrong_verdict(row: Row) -> None:
    law = row.law()
    result = verify(law)
    verdicts = {r.claim: r.verdict for r in result.results}
    wrong = [f"{CLAIMS[c]} refuted although true" for c in row.true if verdicts[CLAIMS[c]] is Verdict.REFUTED]
    wrong += [f"{CLAIMS[c]} proved although false" for c in row.false if verdicts[CLAIMS[c]] is Verdict.PROVED]
    assert not wrong
    for r in result.results:
        if r.witness is not None and r.claim in ("origin", "convexity"):
            assert_holds(law, r.claim, r.witness)


@pytest.mark.parametrize("g", ["norm(a, b)/q - 1", "norm(a/(q - 1/2), b) - 1"])
def test_a_law_undefined_inside_its_domain_is_bad_input(g: str) -> None:
    with pytest.raises(InputError, match=r"g divides by .*, which is 0 at q"):
        verify(Row("divides", g, "", parameters={"q": UNIT}).law())


def test_a_dent_that_is_infinitely_deep_gives_no_chord_and_no_crash() -> None:
    """The part of the stress that the cosine multiplies is the greatest principal deviator, so that K is convex; nothing proves it."""
    g = "I1 + sqrt(J2)*cos(acos(where(J2 > 0, cos3theta, 0))/3) - c"
    law = Criterion("tip", g, {"c": POSITIVE}, pressure=None, stress=Stress("sigma", "principal"))
    assert verify(law, claims=["convexity"])["convexity"].verdict in (Verdict.TESTED, Verdict.PROVED)


def assert_holds(law: Criterion, claim: str, witness: Any) -> None:
    """The witness read back from its strings, in SymPy's arithmetic instead of Arb's."""
    table = law.symbols()

    def g(role: str) -> sp.Expr:
        values = {**witness.parameters, **witness.points[role]}
        return law.g.rewrite(sp.Pow).subs({table[name]: sp.Rational(text) for name, text in values.items()}).evalf(60)

    if claim == "origin":
        assert g("origin") > 0
        return
    ends, middle = (witness.points["p"], witness.points["q"]), witness.points["midpoint"]
    assert g("p") <= 0 and g("q") <= 0 and g("midpoint") > 0
    assert all(sp.Rational(ends[0][x]) + sp.Rational(ends[1][x]) == 2 * sp.Rational(middle[x]) for x in law.forces)
