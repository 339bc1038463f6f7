"""Provers made to lie: an obligation dropped, a branch forgotten, a premise not asked.  The kernel confirms none of what they prove.

Each row is a false claim that a method does not prove, and proves once it is spoilt.  What is offered to the kernel then is
all a liar could hope for: the spoilt proof itself, and every claim before it given out as proved.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import Any

import pytest
import sympy as sp

import duhem.proof.statement as problem
import tests.oracles.prover.boundary as implicit
import tests.oracles.prover.composition as composition
import tests.oracles.prover.curvature as curvature_facts
import tests.oracles.prover.polar as polar
import tests.oracles.prover.polar_form as polar_facts
import tests.oracles.prover.polyhedral as polyhedral
from duhem import POSITIVE, Criterion, Domain, Verdict, verify
from duhem.derivation.support_function import SupportFunction
from duhem.expression import Norm
from duhem.proof.decide import Answer, Sense
from duhem.proof.facts.formula_subject import FormulaSubject
from duhem.proof.kernel.certificate import CLAIMS
from duhem.proof.methods import evidence
from duhem.proof.verdict import Evidence, Proof, Trust
from duhem.proof.verification import Confirmations, Standing
from tests.long import mostly_long
from tests.oracles.prover import evaluation as evaluated
from tests.oracles.prover import on_boundary, parallel
from tests.oracles.prover.consequences import by_convexity, by_normality
from tests.oracles.prover.decide import AskedSubject
from tests.oracles.prover.polar_form import PolarForm
from tests.oracles.prover.regularity import Regularity

Method = Callable[[FormulaSubject], Evidence | None]
Patch = Callable[[pytest.MonkeyPatch], None]
Ask = Callable[..., Answer]

UNIT = Domain.between(0, 1)
YES = Answer(True, "mutant")
PROVED = Evidence(Verdict.PROVED, "mutant", "so it is said")


def law(g: str, flow: Sequence[str] | None = None, forces: Sequence[str] = ("a", "b"), **parameters: Domain) -> Criterion:
    pressure = "p" if "abs(p)" in g else None
    return Criterion(name=g, g=g, forces=tuple(forces), pressure=pressure, flow=flow and tuple(flow), parameters=parameters)


def after(*settled: str) -> Callable[[Any], Method]:
    """A consequence as a method: the claims ``settled`` are proved before it, the others tested."""

    def bound(run: Any) -> Method:
        before = {name: PROVED if name in settled else replace(PROVED, verdict=Verdict.TESTED) for name in CLAIMS}
        return lambda subject: run(subject, before)

    return bound


# -- ways to spoil ----------------------------------------------------------------------------------------------------

_ask = AskedSubject.ask


def asking(change: Callable[..., Answer]) -> Patch:
    """Every question of a method goes through ``change(subject, expr, sense, given, circle)``."""

    def ask(subject: FormulaSubject, expr: Any, sense: Sense, *given: Any, circle: Any = None) -> Answer:
        return change(subject, expr, sense, given, circle)

    def patch(monkeypatch: pytest.MonkeyPatch) -> None:
        monkeypatch.setattr(AskedSubject, "ask", ask)
        monkeypatch.setattr(AskedSubject, "nonnegative", lambda subject, x: ask(subject, x, Sense.NONNEGATIVE).holds is True)

    return patch


def honest(subject: FormulaSubject, expr: Any, sense: Sense, given: Sequence[Any], circle: Any) -> Answer:
    return _ask(subject, expr, sense, *given, circle=circle)


def put(target: Any, name: str, value: Any) -> Patch:
    return lambda monkeypatch: monkeypatch.setattr(target, name, value)


def weak(subject: FormulaSubject, expr: Any, sense: Sense, given: Sequence[Any], circle: Any) -> Answer:
    return honest(subject, expr, Sense.NONNEGATIVE if sense is Sense.POSITIVE else sense, given, circle)


def only_if(*more: Callable[[Any], Any]) -> Callable[..., Answer]:
    """Further hypotheses, made from the circle's symbols or None."""
    return lambda subject, expr, sense, given, circle: honest(subject, expr, sense, (*given, *(m(circle) for m in more)), circle)


def strict(subject: FormulaSubject, expr: Any, sense: Sense, given: Sequence[Any], circle: Any) -> Answer:
    """The ends of the parameters' ranges, where they are 0, left out."""
    return honest(subject, expr, sense, (*given, *(sp.Gt(x, 0) for x in subject.simple.parameters)), circle)


def without_domain(subject: FormulaSubject, expr: Any, sense: Sense, given: Sequence[Any], circle: Any) -> Answer:
    """Every parameter at 1/2 instead of over its range."""
    half = dict.fromkeys(subject.simple.parameters, sp.Rational(1, 2))
    return honest(subject, sp.sympify(expr).subs(half), sense, [r for r in (g.subs(half) for g in given) if r is not sp.true], circle)


def granted(*senses: Sense) -> Callable[..., Answer]:
    """Questions of these senses are not asked."""
    return lambda *q: YES if q[2] in senses else honest(*q)


def first_piece(subject: FormulaSubject) -> Any:
    return _pieces(subject)[:1]


_pieces, _simple = FormulaSubject.pieces.func, FormulaSubject.simple.func
_solution, _curvature = polyhedral.Affine.solution, PolarForm.curvature
_arcs = polar_facts.polar_form
_rules = curvature_facts._CurvatureRules
_add, _mul, _power, _words = _rules.add, _rules.mul, _rules.power, curvature_facts.WORDS


def one_arc(subject: FormulaSubject) -> PolarForm | None:
    form = _arcs(subject)
    return None if form is None else replace(form, arcs=form.arcs[:1])


def more_gamma(self: PolarForm, arc: Any) -> Any:
    return _curvature(self, arc) + 3 * sp.Mul(*(base**2 for base in arc.expr))


def flipped(run: Callable[..., Any]) -> Callable[..., Any]:
    return lambda *args: -run(*args)


def anything(self: Any, node: Any, *parts: Any) -> Any:
    return curvature_facts.Curvature(convex=True, quasiconvex=True)


def convex_of_any(*parts: Any) -> Any:
    return replace(_words[Norm](*parts), convex=True, quasiconvex=True)


def sums_of_quasiconvex(self: Any, node: Any, *terms: Any) -> Any:
    return replace(_add(self, node, *terms), quasiconvex=all(t.quasiconvex for t in terms))


def signs_of_scales_forgotten(self: Any, node: Any, *factors: Any) -> Any:
    moving = [f for f in factors if not f.constant]
    return moving[0] if len(moving) == 1 else _mul(self, node, *factors)


def every_power_convex(self: Any, node: Any, base: Any, exponent: Any) -> Any:
    return replace(_power(self, node, base, exponent), convex=base.convex, quasiconvex=base.quasiconvex)


def half_of_it(found: SupportFunction) -> SupportFunction:
    return replace(found, potential=found.potential / 2, requires=())


def without_requirements(found: SupportFunction) -> SupportFunction:
    return replace(found, requires=())


def turned_round(found: SupportFunction) -> SupportFunction:
    """With the two senses of every slip exchanged."""
    return replace(found, potential=found.potential.xreplace({d: -d for d in found.rates}), requires=())


_support = FormulaSubject.support.func


def no_outer_power(g: sp.Expr) -> sp.Expr:
    return g.base if g.is_Pow else g


def associated(subject: FormulaSubject) -> Any:
    simple = _simple(subject)
    return replace(simple, faces=tuple(face._replace(flow=None) for face in simple.faces))


def faces_alone(self: Any, *relations: Any) -> Any:
    return False if relations[0][1] == "<=" else _solution(self, *relations)


def last_force_irrelevant(g: Any, forces: Any) -> list[tuple[int, ...]]:
    return [(0,) * (len(forces) - 1) + (1,)]


# -- the rows ---------------------------------------------------------------------------------------------------------


@dataclass(frozen=True)
class Lie:
    """``claim`` is false of ``law`` (for duality: the potential is another).  With ``patch``, ``spoilt`` or else ``method`` proves it."""

    name: str
    patch: Patch
    claim: str
    method: Method
    law: Criterion
    spoilt: Method | None = None


def no_patch(monkeypatch: pytest.MonkeyPatch) -> None:
    """Nothing is changed but what the method starts from."""


R = "norm(a, b)"
WAVES = law(f"{R}**4 + (1/15 + 1/1000)*(a**4 - 6*a**2*b**2 + b**4) - abs(p)*{R}**3")
LIMACON = law(f"{R}**2 - abs(p)*({R} + 3/5*a)")
BULGE = law(f"{R}**4 + where(a < 0, 0, (1/6 + 1/1000)*(a**4 + a**3*{R} + a**2*{R}**2)) - abs(p)*{R}**3")
DENT = law("norm(a, b) - abs(a)/1000 - abs(p)")
CORNER = law("norm(a, b) + abs(a)/1000 - abs(p)")
CORNERED = law("a**2 + b**2 + abs(a)/2 - 1")
DENTED = law("a**2 + b**2 - abs(a)/8 - 1")
QUARTIC = law("a**4 + 7*a**2*b**2 + b**4 - 1")
SEAMED = law("where(a < 0, 0, 16*a**2*b**2) + a**4 + b**4 - 1")
EIGHT = law("((a - 3)**2 + b**2 - 1)*((a + 3)**2 + b**2 - 1)")
DISC, ROUND = law("norm(a, b) - abs(p)"), law("a**2 + b**2 - 1")
OUTSIDE, CROSS = law("1 - a**2 - b**2"), law("a**2 - b**2")
SHIFTED = law("norm(a - 2, b) - 1")
RAMPS = law("norm(pos(a) + neg(a)/2, b) - abs(p)")
NOTCHED = law("max(min(a, b), a - 1, b - 1, -a - 1, -b - 1)")


def flowing(g: str, *flow: str) -> Criterion:
    return law(g, flow=flow)


def duality(change: Callable[[SupportFunction], SupportFunction]) -> Patch:
    """The support function of K, changed."""

    def support(subject: FormulaSubject) -> SupportFunction | None:
        return None if (found := _support(subject)) is None else change(found)

    return put(FormulaSubject, "support", property(support))


LIES = (
    # what the deciders say
    Lie("everything is proved", asking(lambda *q: YES), "convexity", polar.convexity, WAVES),
    Lie(
        "refuted for proved", asking(lambda *q: YES if honest(*q).holds is False else honest(*q)),
        "convexity", implicit.hessian, law("a**2 - b**2/1000 - 1"),
    ),
    Lie(
        "undecided for proved", asking(lambda *q: YES if honest(*q).holds is None else honest(*q)),
        "convexity", implicit.hessian, law("sin(a)**2/1000 + exp(-b**2) - 2"),
    ),
    Lie("strict signs made weak", asking(weak), "smoothness", on_boundary.smoothness_on_boundary, CROSS),
    Lie("equalities not asked", asking(granted(Sense.ZERO)), "smoothness", polar.smoothness, CORNER),
    Lie("equalities not asked on seams", asking(granted(Sense.ZERO)), "smoothness", on_boundary.smoothness_on_boundary, CORNERED),
    Lie("signs not asked", asking(granted(Sense.POSITIVE, Sense.NONNEGATIVE)), "dissipation", polar.dissipation, OUTSIDE),
    Lie("the sign asked of the opposite", asking(lambda s, e, *q: honest(s, -e, *q)), "origin", evaluated.origin, OUTSIDE),
    Lie("half of the circle asked", asking(only_if(lambda c: sp.Gt(c[0], 0) if c else sp.true)), "convexity", polar.convexity, LIMACON),
    Lie("hypotheses that contradict each other", asking(only_if(lambda c: sp.false)), "convexity", polar.convexity, WAVES),
    Lie("ends of ranges left out", asking(strict), "smoothness", on_boundary.smoothness_on_boundary, law("a**2 - b**2 - q", q=UNIT)),
    Lie(
        "one value of a parameter asked", asking(without_domain),
        "convexity", polar.convexity, law(f"{R}**2 - abs(p)*({R} + e*a)", e=UNIT),
    ),
    Lie(
        "vacuous on the boundary", asking(lambda *q: YES if any(isinstance(r, sp.Eq) for r in q[3]) else honest(*q)),
        "convexity", implicit.convexity, QUARTIC,
    ),
    # the law made simpler than it is
    Lie("every parameter scaled to 1", put(problem, "removable", lambda e, r, candidates: list(candidates)),
        "convexity", polar.convexity, law("a**4 + c*a**2*b**2 + b**4 - 1", c=POSITIVE)),
    Lie("a force taken for irrelevant", put(problem, "invariant_directions", last_force_irrelevant),
        "convexity", composition.convexity, law("a**2 - b**2 - 1")),
    Lie("one force where there are two", put(problem, "invariant_directions", last_force_irrelevant),
        "smoothness", composition.smoothness, law("max(a, b) - 1")),
    Lie("a square taken for a rising map", put(problem, "without_outer_map", no_outer_power),
        "convexity", composition.convexity, law("(norm(a, b) - 1)**2")),
    Lie("the origin put inside", put(FormulaSubject, "at_origin", sp.Integer(-1)), "origin", evaluated.origin, OUTSIDE),
    # polar form
    Lie("jumps at seams not asked", put(polar, "_jumps", lambda form, sense: True), "convexity", polar.convexity, DENT),
    Lie("jumps not asked for smoothness", put(polar, "_jumps", lambda form, sense: True), "smoothness", polar.smoothness, CORNER),
    Lie("seams skipped", put(PolarForm, "seams", lambda form: iter(())), "convexity", polar.convexity, DENT),
    Lie("slopes taken backwards", put(PolarForm, "slope", flipped(PolarForm.slope)), "convexity", polar.convexity, DENT),
    Lie("gamma counted four times", put(PolarForm, "curvature", more_gamma), "convexity", polar.convexity, WAVES),
    Lie("arcs forgotten but the first", put(polar, "polar_form", one_arc), "convexity", polar.convexity, BULGE),
    Lie("a gauge that jumps", put(PolarForm, "continuous", lambda form: True),
        "convexity", polar.convexity, law("norm(a, b) - abs(p)*(1 + where(a > 0, 1, 1/2))")),
    Lie("Euler without the signs of A and B", put(polar, "polar_form", lambda subject: True), "dissipation", polar.dissipation, OUTSIDE),
    Lie("star-shaped without a look", put(polar, "polar_form", lambda subject: True), "origin", polar.origin, law("1/norm(a, b) + 1")),
    # implicit form
    Lie("the star shape not asked", put(implicit, "_star", lambda *_: True), "convexity", implicit.convexity, EIGHT),
    Lie("kinks not asked", put(implicit, "_outward_kink", lambda *_: True), "convexity", implicit.convexity, DENTED),
    Lie("branches forgotten but the first", put(FormulaSubject, "pieces", property(first_piece)), "convexity", implicit.convexity, SEAMED),
    Lie("one branch's Hessian", put(FormulaSubject, "pieces", property(first_piece)),
        "convexity", implicit.hessian, law("b**2 + a*abs(a) - 1")),
    Lie("jumps of g not asked", put(FormulaSubject, "continuous", True),
        "convexity", implicit.convexity, law("a**2 + b**2 - where(a > 0, 1, 2)")),
    Lie("the gradient for the flow", put(FormulaSubject, "simple", property(associated)),
        "dissipation", on_boundary.dissipation_on_boundary, flowing("a**2 + b**2 - 1", "-a", "-b")),
    Lie("no gradient, no power", asking(granted(Sense.POSITIVE)),
        "dissipation", on_boundary.dissipation_on_boundary, law("pos(norm(a - 2, b) - 1)**2")),
    Lie("the power not asked", asking(granted(Sense.NONNEGATIVE)), "dissipation", on_boundary.dissipation_on_boundary, OUTSIDE),
    # composition
    Lie("kinks cancel everywhere", put(Regularity, "cancelling", property(lambda self: True)),
        "smoothness", composition.smoothness, law("norm(abs(a - 1) + abs(b), b) - 3")),
    Lie("tips not looked at", put(composition, "_off_boundary", lambda *_: True),
        "smoothness", composition.smoothness, law("norm(a - 1, b)/2 + a - 1")),
    Lie("a regular value without a look", put(composition, "_regular", lambda subject: ("so it is said", Proof("euler"))),
        "smoothness", composition.smoothness, CROSS),
    Lie("inside at a point that is not",
        put(composition, "_regular", lambda subject: ("so it is said", Proof("composition", {"inside": {"a": "0", "b": "1"}}))),
        "smoothness", composition.smoothness, CROSS),
    Lie("sums of quasiconvex functions", put(_rules, "add", sums_of_quasiconvex),
        "convexity", composition.convexity, law("sqrt(abs(a)) + sqrt(abs(b)) - 1")),
    Lie("a minimum for a maximum", put(_rules, "minimum", _rules.maximum),
        "convexity", composition.convexity, law("min(norm(a, 2*b), norm(2*a, b)) - 1")),
    Lie("the sign of a factor forgotten", put(_rules, "mul", signs_of_scales_forgotten), "convexity", composition.convexity, OUTSIDE),
    Lie("every power convex", put(_rules, "power", every_power_convex),
        "convexity", composition.convexity, law("abs(a)**(1/2) + abs(b)**(1/2) - 1")),
    Lie("a norm of anything convex", put(curvature_facts, "WORDS", {**_words, Norm: convex_of_any}),
        "convexity", composition.convexity, law("norm(min(abs(a), abs(b)), 1) - 2")),
    Lie("a product convex", put(_rules, "mul", anything), "convexity", composition.convexity, law("a*b - 1")),
    # half-spaces
    Lie("K not compared with its half-spaces", put(polyhedral.Affine, "solution", faces_alone), "convexity", polyhedral.convexity, NOTCHED),
    # flows and premises
    Lie("the direction of the flow not asked", asking(granted(Sense.ZERO)),
        "normality", parallel.normality, flowing("a**2 + b**2 - 1", "a", "2*b")),
    Lie("the sense of the flow not asked", asking(granted(Sense.NONNEGATIVE)),
        "normality", parallel.normality, flowing("a**2 + b**2 - 1", "-a", "-b")),
    Lie("parallel to no gradient", asking(granted(Sense.POSITIVE)),
        "normality", parallel.normality, flowing("pos(norm(a, b) - 1)**2", "b", "-a")),
    Lie("normal to a K not convex", no_patch, "normality", after()(on_boundary.normality_parallel), flowing("1 - a**2 - b**2", "-a", "-b"),
        after("convexity")(on_boundary.normality_parallel)),
    Lie("associated with a K not convex", no_patch, "normality", after()(by_convexity), DENT, after("convexity")(by_convexity)),
    Lie("dissipation without the origin", no_patch, "dissipation", after("normality")(by_normality), SHIFTED,
        after("origin", "normality")(by_normality)),
    # duality
    Lie("requirements not asked", duality(without_requirements),
        "duality", evidence.duality, law("norm(a, b) - q", q=Domain.between(-1, 1))),
    Lie("half of the potential", duality(half_of_it), "duality", evidence.duality, DISC),
    Lie("the senses of the slips exchanged", duality(turned_round), "duality", evidence.duality, RAMPS),
)  # fmt: skip
DEAR = (  # of a method whose other lies stay
    *("arcs forgotten but the first", "ends of ranges left out", "half of the circle asked", "one value of a parameter asked"),
    *("slopes taken backwards", "gamma counted four times"),
)


@pytest.mark.slow
@pytest.mark.parametrize("lie", mostly_long(LIES, *(lie for lie in LIES if lie.name not in DEAR)), ids=lambda lie: lie.name)
def test_a_lie_is_not_confirmed(lie: Lie) -> None:
    honestly = lie.method(AskedSubject(lie.law))
    with pytest.MonkeyPatch.context() as monkeypatch:
        lie.patch(monkeypatch)
        told = (lie.spoilt or lie.method)(AskedSubject(lie.law))
    assert told is not None and told.verdict is Verdict.PROVED
    assert honestly is None or honestly.verdict is not Verdict.PROVED or honestly.detail != told.detail
    confirmations = Confirmations(lie.law)
    for claim in CLAIMS[: CLAIMS.index(lie.claim)]:
        confirmations.of(claim, PROVED)
    standing = confirmations.of(lie.claim, told)
    assert standing is not None and standing.trust is not Trust.CHECKED


@pytest.mark.parametrize(
    ("own", "premise", "stands"),
    [
        ("something (smt-z3)", Trust.PROVER, Trust.PROVER),
        ("something", Trust.SOLVER, Trust.PROVER),
        ("something", Trust.CHECKED, Trust.PROVER),
    ],
)
def test_a_proof_stands_no_better_than_what_it_rests_on(own: str, premise: Trust, stands: Trust) -> None:
    """The flow of a law of its own: the kernel has no rule for it here, so that the method's own word counts."""
    law = Criterion("turned", "norm(a, b) - 1", forces=("a", "b"), pressure=None, flow=("a - b", "a + b"))
    confirmations = Confirmations(law, standings={"convexity": Standing(premise)})
    standing = confirmations.of("normality", Evidence(Verdict.PROVED, own, ""))
    assert standing is not None and standing.trust is stands


@pytest.mark.parametrize("premise", list(Trust))
def test_a_consequence_stands_as_what_it_rests_on(premise: Trust) -> None:
    law = Criterion("disc", "norm(a, b) - 1", forces=("a", "b"), pressure=None)
    confirmations = Confirmations(law, standings={"convexity": Standing(premise)})
    standing = confirmations.of("normality", Evidence(Verdict.PROVED, "anything (smt-z3)", ""))
    assert standing is not None and standing.trust is premise


def test_no_rule_is_named_that_did_not_prove_it() -> None:
    """K is star-shaped and not convex: the boundary is smooth by Euler's relation, and not because g is convex."""
    law = Criterion("star", "a**4 - 5*a**2*b**2 + b**4 + c**4 - 1", forces=("a", "b", "c"), pressure=None)
    offered = {rule: Evidence(Verdict.PROVED, rule, "", proof=Proof(rule)) for rule in ("composition", "euler")}
    assert [Confirmations(law).confirms("smoothness", evidence) for evidence in offered.values()] == [False, True]
    assert verify(law, claims=["smoothness"])["smoothness"].method == "euler"
