"""Small faults put into a law, and into duhem itself: each must show.

Mutants of the four-quadrant ellipse: the inadmissible ones are refuted with witnesses that hold in another arithmetic,
those that happen to be admissible are recognised as such.  Mutants of the deciders and methods: each must change an
answer of the truth table below.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, replace
from functools import partial
from typing import Any

import pytest
import sympy as sp

import duhem.proof.facts.subject as subject_module
import duhem.proof.methods.refuters as refuters_module
import duhem.proof.statement as problem_module
import duhem.proof.witness.points as witness_module
import tests.oracles.prover.boundary as implicit
import tests.oracles.prover.curvature as curvature_module
import tests.oracles.prover.decide as deciders_module
import tests.oracles.prover.polar as polar
from duhem import POSITIVE, Criterion, Verdict, Witness, load, verify
from duhem.proof.claims import CLAIMS as CLAIMS_BY_NAME
from duhem.proof.claims import ProofMethod
from duhem.proof.decide import Answer, Question, Sense, decide
from duhem.proof.facts.formula_subject import FormulaSubject
from tests.long import mostly_long
from tests.oracles.prover.decide import AskedSubject, Relation, System
from tests.oracles.prover.polar_form import PolarForm
from tests.oracles.prover.regularity import Regularity
from tests.oracles.prover.table import PROVERS
from tests.oracles.reevaluation import confirmed

PROVED, REFUTED = Verdict.PROVED, Verdict.REFUTED

# -- mutants of the law -----------------------------------------------------------------------------------------------

MU = ("mu_a_plus", "mu_a_minus", "mu_b_plus", "mu_b_minus")
A = "(pos(sigma_a)/mu_a_plus + neg(sigma_a)/mu_a_minus)"
B = "(pos(sigma_b)/mu_b_plus + neg(sigma_b)/mu_b_minus)"
N = "abs(sigma_n)"
GRADIENT = (
    "pos(sigma_a)/mu_a_plus**2 - neg(sigma_a)/mu_a_minus**2",
    "pos(sigma_b)/mu_b_plus**2 - neg(sigma_b)/mu_b_minus**2",
)
CLAIMS = ("origin", "convexity", "smoothness", "normality", "dissipation")
ADMISSIBLE = dict.fromkeys(CLAIMS, True)


@dataclass(frozen=True)
class Mutant:
    """A changed law and the truth about it; claims left out have no agreed truth for a law so broken.

    ``elusive`` claims are false where g has no gradient to show it (a jump, a flat g): they may stay open, and must not be proved.
    """

    name: str
    g: str
    truth: Mapping[str, bool]
    flow: tuple[str, str] | None = None
    elusive: tuple[str, ...] = ()

    def law(self) -> Criterion:
        return Criterion(name=self.name, g=self.g, parameters=dict.fromkeys(MU, POSITIVE), flow=self.flow)


DENTED = {"origin": True, "convexity": False, "normality": False, "dissipation": True}
EQUIVALENT = [
    Mutant("the law itself", f"norm({A}, {B}) - {N}", ADMISSIBLE),
    Mutant("a sign lost inside a square", f"norm(pos(sigma_a)/mu_a_plus - neg(sigma_a)/mu_a_minus, {B}) - {N}", ADMISSIBLE),
    Mutant("both signs swapped inside a square", f"norm(neg(sigma_a)/mu_a_minus - pos(sigma_a)/mu_a_plus, {B}) - {N}", ADMISSIBLE),
    Mutant("no square root", f"{A}**2 + {B}**2 - {N}", ADMISSIBLE),
    Mutant("no square root on either side", f"{A}**2 + {B}**2 - {N}**2", ADMISSIBLE),
    Mutant("mu for 1/mu everywhere", f"norm(pos(sigma_a)*mu_a_plus + neg(sigma_a)*mu_a_minus, {B}) - {N}", ADMISSIBLE),
    Mutant("mu for 1/mu in one sense", f"norm(pos(sigma_a)*mu_a_plus + neg(sigma_a)/mu_a_minus, {B}) - {N}", ADMISSIBLE),
    Mutant("one sense left out", f"norm(pos(sigma_a)/mu_a_plus, {B}) - {N}", ADMISSIBLE),
    Mutant(
        "coefficients of the axes exchanged",
        f"norm(pos(sigma_a)/mu_b_plus + neg(sigma_a)/mu_b_minus, pos(sigma_b)/mu_a_plus + neg(sigma_b)/mu_a_minus) - {N}",
        ADMISSIBLE,
    ),
    Mutant("cubes for squares", f"({A}**3 + {B}**3)**(1/3) - {N}", ADMISSIBLE),
    Mutant("a sum for a norm: corners", f"{A} + {B} - {N}", {**ADMISSIBLE, "smoothness": False}),
    Mutant("a maximum for a norm: corners", f"max({A}, {B}) - {N}", {**ADMISSIBLE, "smoothness": False}),
    Mutant("the normal written out as the flow", f"norm({A}, {B}) - {N}", ADMISSIBLE, GRADIENT),
    Mutant("the normal to another length", f"norm({A}, {B}) - {N}", ADMISSIBLE, (f"3*({GRADIENT[0]})", f"3*({GRADIENT[1]})")),
]
INADMISSIBLE = [
    Mutant("the sign of the pressure", f"norm({A}, {B}) - sigma_n", {"origin": False}),
    Mutant("the sign of g", f"{N} - norm({A}, {B})", {"origin": False, "convexity": False, "normality": False, "dissipation": False}),
    Mutant("a difference of squares", f"{A}**2 - {B}**2 - {N}**2", {"origin": True, "convexity": False, "normality": False}),
    Mutant("a minimum for a norm", f"min({A}, {B}) - {N}", {"origin": True, "convexity": False, "normality": False}),
    Mutant("square roots for squares", f"(sqrt({A}) + sqrt({B}))**2 - {N}", DENTED),
    Mutant("an inward seam", f"norm({A}, {B}) - {A}/2 - {N}", DENTED),
    Mutant(
        "an inward seam on one side",
        f"norm({A}, {B}) - pos(sigma_a)/(2*mu_a_plus) - {N}",
        {"origin": True, "convexity": False, "normality": False},
    ),
    Mutant(
        "a coefficient of the wrong quadrant",
        f"where(sigma_a > 0, norm({A}, abs(sigma_b)/mu_b_plus), norm({A}, {B})) - {N}",
        {"origin": True, "convexity": False, "normality": False},
    ),
    Mutant(
        "the coefficients of the two senses exchanged in one half",
        f"where(sigma_a > 0, norm({A}, {B}), norm({A}, pos(sigma_b)/mu_b_minus + neg(sigma_b)/mu_b_plus)) - {N}",
        {"origin": True, "convexity": False},
        elusive=("normality",),
    ),
    Mutant(
        "mu for 1/mu in one quadrant",
        f"where(sigma_b > 0, norm(abs(sigma_a)/mu_a_plus, {B}), norm(abs(sigma_a)*mu_a_plus, {B})) - {N}",
        {"origin": True, "convexity": False, "normality": False},
    ),
    Mutant(
        "shifted away from the origin",
        f"norm((sigma_a - 2*mu_a_plus*{N})/mu_a_plus, {B}) - {N}",
        {"origin": False, "convexity": True, "smoothness": True, "normality": True, "dissipation": False},
    ),
    Mutant(
        "the senses mixed between the axes",
        f"norm(pos(sigma_a)/mu_a_plus + neg(sigma_b)/mu_b_minus, pos(sigma_b)/mu_b_plus + neg(sigma_a)/mu_a_minus) - {N}",
        {**ADMISSIBLE, "smoothness": False},
    ),
    Mutant(
        "a sign lost in the flow",
        f"norm({A}, {B}) - {N}",
        {**ADMISSIBLE, "normality": False, "dissipation": False},
        (GRADIENT[0].replace("-", "+"), GRADIENT[1]),
    ),
    Mutant(
        "the flow reversed",
        f"norm({A}, {B}) - {N}",
        {**ADMISSIBLE, "normality": False, "dissipation": False},
        (f"-({GRADIENT[0]})", f"-({GRADIENT[1]})"),
    ),
    Mutant(
        "squares lost in the flow",
        f"norm({A}, {B}) - {N}",
        {**ADMISSIBLE, "normality": False},
        ("pos(sigma_a)/mu_a_plus - neg(sigma_a)/mu_a_minus", "pos(sigma_b)/mu_b_plus - neg(sigma_b)/mu_b_minus"),
    ),
    Mutant(
        "coefficients exchanged in the flow",
        f"norm({A}, {B}) - {N}",
        {**ADMISSIBLE, "normality": False},
        ("pos(sigma_a)/mu_b_plus**2 - neg(sigma_a)/mu_b_minus**2", "pos(sigma_b)/mu_a_plus**2 - neg(sigma_b)/mu_a_minus**2"),
    ),
    Mutant("the flow radial", f"norm({A}, {B}) - {N}", {**ADMISSIBLE, "normality": False}, ("sigma_a", "sigma_b")),
    Mutant(
        "the flow turned by a right angle",
        f"norm({A}, {B}) - {N}",
        {**ADMISSIBLE, "normality": False, "dissipation": False},
        (f"-({GRADIENT[1]})", GRADIENT[0]),
    ),
    Mutant("the flow along the boundary of a disk", f"norm({A}, {B}) - {N}", {**ADMISSIBLE, "normality": False}, ("-sigma_b", "sigma_a")),
    Mutant("one component of the flow left out", f"norm({A}, {B}) - {N}", {**ADMISSIBLE, "normality": False}, (GRADIENT[0], "0")),
    Mutant(
        "a flow hidden by a flat g",
        f"pos(norm({A}, {B}) - {N})**2",
        {"origin": True, "convexity": True, "normality": False},
        ("-sigma_b", "sigma_a"),
    ),
    Mutant(
        "a flat g away from the origin",
        f"pos(norm((sigma_a - 2*mu_a_plus*{N})/mu_a_plus, {B}) - {N})**2",
        {"origin": False, "convexity": True, "normality": True},
        elusive=("dissipation",),
    ),
]


MUTANTS = [*EQUIVALENT, *INADMISSIBLE]
DEAR = (  # most of the time of all; of their kind another stays
    *("the normal to another length", "coefficients exchanged in the flow", "one component of the flow left out"),
    *("the flow along the boundary of a disk", "the flow reversed", "squares lost in the flow", "a flat g away from the origin"),
    *("the normal written out as the flow", "a maximum for a norm: corners", "the flow turned by a right angle"),
    *("a sign lost in the flow", "square roots for squares", "an inward seam on one side", "mu for 1/mu in one quadrant"),
)


@pytest.mark.slow
@pytest.mark.parametrize("mutant", mostly_long(MUTANTS, *(m for m in MUTANTS if m.name not in DEAR)), ids=lambda m: m.name)
def test_mutants_of_the_law(mutant: Mutant) -> None:
    law = mutant.law()
    found = verify(law, claims=[*mutant.truth, *mutant.elusive])
    expected = {claim: PROVED if true else REFUTED for claim, true in mutant.truth.items()}
    assert {claim: found[claim].verdict for claim in mutant.truth} == expected
    assert PROVED not in [found[claim].verdict for claim in mutant.elusive]
    for result in found.results:
        assert result.witness is None or confirmed(law, result.claim, result.witness), result.claim


def test_each_list_holds_what_it_says() -> None:
    standard = ("origin", "convexity", "normality", "dissipation")
    assert all(m.truth[c] for m in EQUIVALENT for c in standard)
    assert all(not all(m.truth.values()) for m in INADMISSIBLE)


# -- mutants of duhem -------------------------------------------------------------------------------------------------


@dataclass(frozen=True)
class Row:
    """``true`` False with ``hard``: the claim is false, and it is enough that it is not proved."""

    law: Criterion
    claim: str
    true: bool
    hard: bool = False


def _law(g: str, constraints: tuple[str, ...] = (), flow: tuple[str, str] | None = None, *positive: str) -> Criterion:
    return Criterion(name=g, g=g, constraints=constraints, flow=flow, parameters=dict.fromkeys(positive, POSITIVE))


def _built_in(name: str, **at: str) -> Criterion:
    return load(name).fix(at)


WAVES = "norm(sigma_a, sigma_b)**4 + {}*(sigma_a**4 - 6*sigma_a**2*sigma_b**2 + sigma_b**4) - abs(sigma_n)*norm(sigma_a, sigma_b)**3"
# 1 + c (cos^4 + cos^3 + cos^2) as a gauge: gamma'' + gamma is least 1 - 2 c where cos < 0, and 1 - 6 c where cos > 0.
R = "norm(sigma_a, sigma_b)"
BULGE = f"{R}**4 + where({{}}, {{}}*(sigma_a**4 + sigma_a**3*{R} + sigma_a**2*{R}**2), 0) - abs(sigma_n)*{R}**3"
LENS = ("mu_a**2 <= 2*mu_b**2", "mu_b**2 <= 2*mu_a**2")
HIPPOPEDE = "norm(sigma_a, sigma_b)**2 - abs(sigma_n)*norm(mu_a*sigma_a, mu_b*sigma_b)"

# flat sides, on which the midpoints of chords seem outside in floats
RHOMBUS = "where(sigma_a > 0, sigma_a, -sigma_a)/3 + where(sigma_b > 0, sigma_b, -sigma_b)/7 - abs(sigma_n)"
# two discs that touch at sigma_a = sqrt(2)/3, where the gradient vanishes
DISC = "((sigma_a - (sqrt(2)/3 {} 1)*abs(sigma_n))**2 + sigma_b**2 - sigma_n**2)"
TOUCHING = f"{DISC.format('+')}*{DISC.format('-')}"

TABLE = [
    Row(_built_in("antoni2007"), "convexity", True),
    Row(_built_in("antoni2007"), "smoothness", True),
    Row(_built_in("quartic", c="6"), "convexity", True),
    Row(_built_in("quartic", c="7"), "convexity", False),
    Row(_law(WAVES.format("1/15")), "convexity", True),
    Row(_law(WAVES.format("(1/15 + 1/10000000)")), "convexity", False, hard=True),
    Row(_law(BULGE.format("sigma_a < 0", "1/3")), "convexity", True),
    Row(_law(BULGE.format("sigma_a > 0", "(1/6 + 1/10000000)")), "convexity", False, hard=True),
    Row(_built_in("matchstick"), "convexity", False),
    Row(_law(HIPPOPEDE, LENS, None, "mu_a", "mu_b"), "convexity", True),
    Row(_built_in("radial-flow"), "normality", False),
    Row(_built_in("radial-flow", mu_a="1/5", mu_b="1/5"), "normality", True),
    Row(_law("norm(sigma_a, sigma_b) - abs(sigma_a)/1000 - abs(sigma_n)"), "convexity", False, hard=True),
    Row(_law("norm(sigma_a, sigma_b) + abs(sigma_a)/1000 - abs(sigma_n)"), "convexity", True),
    Row(_law("norm(pos(sigma_a) + neg(sigma_b), pos(sigma_b) + neg(sigma_a)) - abs(sigma_n)"), "smoothness", False),
    Row(_law("sqrt(abs(sigma_a)) + sqrt(abs(sigma_b)) - sqrt(abs(sigma_n))"), "convexity", False),
    Row(_law("min(norm(sigma_a, 2*sigma_b), norm(2*sigma_a, sigma_b)) - abs(sigma_n)"), "convexity", False),
    Row(_law("sigma_b**2 - sigma_a**2*(1 + sigma_a/abs(sigma_n))"), "smoothness", False, hard=True),
    Row(_law("sin(norm(sigma_a, sigma_b)/abs(sigma_n)) - 1/2"), "dissipation", False, hard=True),
    Row(_law("norm(sigma_a - 2*abs(sigma_n), sigma_b) - abs(sigma_n)"), "origin", False),
    Row(_law(RHOMBUS), "convexity", True),
    Row(_law(TOUCHING), "smoothness", False, hard=True),
]
APART = "((sigma_a - 3*abs(sigma_n))**2 + sigma_b**2 - abs(sigma_n)**2)*((sigma_a + 3*abs(sigma_n))**2 + sigma_b**2 - abs(sigma_n)**2)"


def _answered(row: Row) -> str | None:
    """A row of the table answered wrongly, left open though it was decided, or refuted by a witness that does not hold."""
    result = verify(row.law, claims=[row.claim])[row.claim]
    if result.verdict is PROVED:
        good = row.true
    elif result.verdict is REFUTED:
        assert result.witness is not None
        good = not row.true and confirmed(row.law, row.claim, result.witness)
    else:
        good = row.hard
    return None if good else f"{row.law.name}: {row.claim} {result.verdict} by {result.method}"


def _answered_elsewhere(row: Row) -> str | None:
    """The same of the second opinion and of the methods that are not the kernel's, which its proofs leave nothing to say in ``verify``."""
    subject = AskedSubject(row.law)
    subject.check_defined()
    others = [m.run for m in CLAIMS_BY_NAME[row.claim].methods if isinstance(m, ProofMethod) and m.takes is FormulaSubject]
    decided = set[Verdict]()
    for run in (*PROVERS.get(row.claim, ()), *others):
        subject.allow(CLAIMS_BY_NAME[row.claim].steps)
        if (found := run(subject)) is None or found.verdict not in (PROVED, REFUTED):
            continue
        holds = found.witness is None or confirmed(row.law, row.claim, found.witness)
        if (found.verdict is PROVED) is not row.true or not holds:
            return f"{row.law.name}: {row.claim} {found.verdict} by {found.method}"
        decided.add(found.verdict)
    return None if decided or row.hard else f"{row.law.name}: {row.claim} is open"


def _apart() -> str | None:
    """The scouts never let such a claim reach this method."""
    return None if implicit.convexity(AskedSubject(_law(APART))) is None else "two disks apart: convexity proved"


def _below_zero() -> str | None:
    """Likewise."""
    t = sp.Symbol("t", real=True)
    return "a parabola is nowhere negative" if decide(Question((t - 1) * (t - 2), Sense.NONNEGATIVE)).holds is True else None


ELSEWHERE = [row for row in TABLE if not CLAIMS_BY_NAME[row.claim].needs]
ASKED: list[Callable[[], str | None]] = [*(partial(_answered, row) for row in TABLE), _apart, _below_zero]
ASKED += [partial(_answered_elsewhere, row) for row in ELSEWHERE]


def _faults(first: int = 0) -> Iterator[str]:
    """Whatever is answered wrongly, the questions from the ``first`` on before the others."""
    for ask in (*ASKED[first:], *ASKED[:first]):
        if fault := ask():
            yield fault


@pytest.mark.long
def test_the_table_is_right() -> None:
    assert list(_faults()) == []


Patch = Callable[[pytest.MonkeyPatch], None]


def _deciding(change: Callable[[Question, Answer], Answer]) -> Patch:
    def patch(monkeypatch: pytest.MonkeyPatch) -> None:
        asked = AskedSubject.decided
        monkeypatch.setattr(subject_module, "decide", lambda question, budget=None: change(question, decide(question, budget)))
        monkeypatch.setattr(AskedSubject, "decided", lambda subject, question: change(question, asked(subject, question)))

    return patch


def _strictness_lost(monkeypatch: pytest.MonkeyPatch) -> None:
    def weaker(question: Question) -> Question:
        return replace(question, sense=Sense.NONNEGATIVE if question.sense is Sense.POSITIVE else question.sense)

    asked = AskedSubject.decided
    monkeypatch.setattr(subject_module, "decide", lambda question, budget=None: decide(weaker(question), budget))
    monkeypatch.setattr(AskedSubject, "decided", lambda subject, question: asked(subject, weaker(question)))


def _hypotheses_negated(monkeypatch: pytest.MonkeyPatch) -> None:
    """The region of an arc or a branch taken on its other side."""
    from duhem.expression.branches import Branch

    def turned(piece: Branch) -> Branch:
        return Branch({s: -sign for s, sign in piece.signs.items()}, piece.expr)

    whole, inside = Branch.conditions, implicit.interior
    monkeypatch.setattr(Branch, "conditions", lambda self: whole(turned(self)))
    for oracle in (implicit, polar):
        monkeypatch.setattr(oracle, "interior", lambda piece: inside(turned(piece)))


def _set(target: Any, name: str, value: Any) -> Patch:
    return lambda monkeypatch: monkeypatch.setattr(target, name, value)


def _chord(skipped: tuple[str, ...]) -> Patch:
    """The exact check of a chord with the signs of some of its points not looked at."""

    def patch(monkeypatch: pytest.MonkeyPatch) -> None:
        look = witness_module.sign_at

        def chord(subject: FormulaSubject, parameters: Any, p: Any, q: Any, touching: bool = False) -> Witness | None:
            middle = [(a + b) / 2 for a, b in zip(p, q, strict=True)]
            points = {"p": p, "q": q, "midpoint": middle}
            at = {role: subject.values_at(parameters, x) for role, x in points.items()}
            for role, values in at.items():
                sign, _ = look(subject.problem.g, values)
                if role not in skipped and (sign is None or (sign > 0) != (role == "midpoint")):
                    return None
            return witness_module.witness(subject, at, {}, "a chord")

        monkeypatch.setattr(refuters_module, "chord", chord)

    return patch


_curvature, _turn = PolarForm.curvature, PolarForm.turn
_of_add = curvature_module._CurvatureRules.add


def _quasiconvex_sums(self: Any, node: Any, *terms: Any) -> Any:
    return replace(_of_add(self, node, *terms), quasiconvex=all(t.quasiconvex for t in terms))


def _any_parameters(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(FormulaSubject, "admits", lambda subject, values: True)


def _backwards(self: PolarForm, arc: Any) -> Any:
    return -sp.Add(*(a * _turn(self, p) / p for p, a in zip(arc.expr, arc.exponents, strict=True)))


_polynomials = deciders_module.polynomial_system


def _nowhere(question: Question) -> System:
    system = _polynomials(question)
    return replace(system, given=(*system.given, Relation(sp.S.NegativeOne, ">=")))


def _with_gamma(times: int) -> Any:
    return lambda self, arc: _curvature(self, arc) + times * sp.Mul(*(p**2 for p in arc.expr))


MUTATIONS: dict[str, Patch] = {
    "the seam condition dropped": _set(polar, "_jumps", lambda form, sense: True),
    "the curvature with its sign flipped": _set(PolarForm, "curvature", lambda self, arc: -_curvature(self, arc)),
    "the curvature without gamma": _set(PolarForm, "curvature", _with_gamma(-1)),
    "the curvature with gamma twice": _set(PolarForm, "curvature", _with_gamma(1)),
    "theta turned the wrong way in the slopes": _set(PolarForm, "slope", _backwards),
    "a chord whose midpoint is not looked at": _chord(("midpoint",)),
    "a chord whose ends are not looked at": _chord(("p", "q")),
    "a witness outside the domain": _any_parameters,
    "everything proved": _deciding(lambda question, answer: Answer(True, "mutant")),
    "unknown taken for proved": _deciding(lambda question, answer: Answer(True, "mutant") if answer.holds is None else answer),
    "false taken for proved": _deciding(lambda question, answer: Answer(True, "mutant") if answer.holds is False else answer),
    "proved taken for false": _deciding(lambda question, answer: Answer(False, "mutant") if answer.holds is True else answer),
    "equalities not looked at": _deciding(lambda question, answer: Answer(True, "mutant") if question.sense is Sense.ZERO else answer),
    "strict signs taken for weak ones": _strictness_lost,
    "branches looked at on the wrong side": _hypotheses_negated,
    "polynomials asked where nothing is": _set(deciders_module, "polynomial_system", _nowhere),
    "kinks taken to cancel everywhere": _set(Regularity, "cancelling", property(lambda self: True)),
    "sums of quasiconvex functions taken for quasiconvex": _set(curvature_module._CurvatureRules, "add", _quasiconvex_sums),
    "a minimum taken for a maximum": _set(curvature_module._CurvatureRules, "minimum", curvature_module._CurvatureRules.maximum),
    "the star shape not looked at": _set(implicit, "_star", lambda subject, piece: True),
    "every parameter set to 1": _set(problem_module, "removable", lambda expressions, relations, candidates: list(candidates)),
    "a force taken for irrelevant": _set(problem_module, "invariant_directions", lambda g, forces: [(0,) * (len(forces) - 1) + (1,)]),
}  # fmt: skip


# The question that told of a mutant when it was last seen, asked first: where it tells no more, the others are asked all the same.
TELLING = {
    "the seam condition dropped": 34,
    "the curvature with its sign flipped": 28,
    "the curvature without gamma": 28,
    "the curvature with gamma twice": 29,
    "theta turned the wrong way in the slopes": 34,
    "a chord whose midpoint is not looked at": 41,
    "a chord whose ends are not looked at": 38,
    "a witness outside the domain": 33,
    "everything proved": 29,
    "unknown taken for proved": 18,
    "false taken for proved": 29,
    "proved taken for false": 28,
    "strict signs taken for weak ones": 42,
    "equalities not looked at": 10,
    "branches looked at on the wrong side": 31,
    "kinks taken to cancel everywhere": 36,
    "sums of quasiconvex functions taken for quasiconvex": 37,
    "a minimum taken for a maximum": 38,
    "the star shape not looked at": 22,
    "every parameter set to 1": 32,
    "a force taken for irrelevant": 27,
}


TOLD_LATE = (  # of a dear question alone; of their kind others stay
    "unknown taken for proved", "a chord whose ends are not looked at", "equalities not looked at", "polynomials asked where nothing is",
)  # fmt: skip


@pytest.mark.slow
@pytest.mark.parametrize("name", mostly_long(MUTATIONS, *(name for name in MUTATIONS if name not in TOLD_LATE)))
def test_mutants_of_duhem_are_caught(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    MUTATIONS[name](monkeypatch)
    assert next(_faults(TELLING.get(name, 0)), None) is not None
