"""A law against the claims: each examined in order, its evidence kept, what each proof rests on, the whole as one value.

The kernel's rules are asked first, and are given every proof that others make.
"""

from __future__ import annotations

import json
import time
from collections.abc import Callable, Iterable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass, field, replace
from fractions import Fraction
from threading import RLock
from typing import Any, ClassVar, NamedTuple

from duhem.errors import InputError, meant
from duhem.expression.balls import precision
from duhem.law.catalogue import load
from duhem.law.curve_law import Law
from duhem.law.formula_law import Criterion
from duhem.law.parameter_domain import check_domain
from duhem.omitted import LeftOut
from duhem.proof.certificate import certificate, law_as_text
from duhem.proof.claims import CHEAP, CLAIMS, COUPLED, EVERY, OnMethod, asked_of
from duhem.proof.decide import ANY_STEPS, EFFORTS, Budget
from duhem.proof.facts.curve_subject import CurveSubject
from duhem.proof.facts.formula_subject import FormulaSubject, RateSubject
from duhem.proof.facts.graph_subject import GraphSubject
from duhem.proof.facts.subject import Subject
from duhem.proof.in_state import dissipating, epigraph, rate_epigraph
from duhem.proof.kernel.certificate import OVER, stated
from duhem.proof.kernel.claims import needs_of, objection, row_of, rules_of
from duhem.proof.kernel.curve import Stated
from duhem.proof.kernel.steps import TooDearError, within
from duhem.proof.kernel.term import NotWritten
from duhem.proof.methods.coupled import polar_of_the_cone
from duhem.proof.remarks import not_needed, remarks, scope
from duhem.proof.verdict import ClaimResult, Evidence, Proof, Trust, Unsettled, Verdict
from duhem.show.place import AnyPath, check_place, write
from duhem.show.printing import Shown
from duhem.version import __version__

__all__ = [
    "ClaimResult", "Confirmations", "Coupled", "Standing", "Verification", "claim_results", "verdict_within", "verify", "wanted_claims",
]  # fmt: skip

_TURN = RLock()
_BITS = 53  # what Arb starts with
_SHARE = 4  # such a part of the steps left may go to a claim that another rests on
_MOST_STEPS = 20_000_000  # for a proof that somebody offers
_OVER_ALL = "over the whole domain of the law, of which this is a part"


class Coupled(NamedTuple):
    """Unilateral contact with friction as one law in (sigma, p): the verdict on de Saxcé's ``bipotential``, and the ``trust`` of a proof.

    ``support_function`` is Phi_1(d), of K(-1), as text; it is finite where each form of ``finite_where_zero`` is 0.  ``dilatancy`` says
    what normality of the cone of all (sigma, p) would predict.  Both are None where the kernel confirms no closed form, or K is no cone.
    """

    bipotential: str
    trust: str | None
    support_function: str | None = None
    finite_where_zero: tuple[str, ...] = ()
    dilatancy: str | None = None

    @classmethod
    def of(cls, subject: Subject, results: Iterable[ClaimResult]) -> Coupled:
        """What the results say together."""
        found = {result.claim: result for result in results}
        trust = found["bipotential"].trust
        own = cls(found["bipotential"].verdict.value, None if trust is None else trust.value)
        shown = found["homogeneity"].trust is found["duality"].trust is Trust.CHECKED
        if not shown or (closed := polar_of_the_cone(subject)) is None:
            return own
        told = f"normality in forces and pressure together would open the contact with v_n = {closed[0]} while it slips"
        return own._replace(support_function=closed[0], finite_where_zero=closed[1], dilatancy=f"{told}, and the law has p v_n = 0")


@dataclass(frozen=True, repr=False)
class Verification(Shown):
    """Everything found about ``criterion`` (with the asked parameters fixed).

    ``rests_on`` holds the claims that were not asked for, and that those asked for rest on.  ``vacuous`` where K has no boundary
    point at which anything could dissipate: a remark says why.  ``interrupted`` where somebody stopped it: nothing is concluded then.
    ``coupled`` where the law in forces and pressure together was asked for.
    """

    printed_by: ClassVar[str] = "duhem.proof.report"

    criterion: Law
    results: tuple[ClaimResult, ...]
    left_out: tuple[LeftOut, ...]
    remarks: tuple[str, ...]
    rests_on: tuple[ClaimResult, ...] = ()
    effort: str = "normal"
    vacuous: bool = False
    interrupted: bool = False
    coupled: Coupled | None = None

    def __repr__(self) -> str:
        return f"<Verification of {self.criterion.name}: {', '.join(f'{r.claim} {r.verdict}' for r in self.results) or 'no claim'}>"

    def __iter__(self) -> Iterator[ClaimResult]:
        return iter(self.results)

    def __getitem__(self, claim: str) -> ClaimResult:
        for result in self.results:
            if result.claim == claim:
                return result
        asked = ", ".join(result.claim for result in self.results) or "none"
        if isinstance(claim, str) and claim in EVERY:
            raise InputError(f"the claim {claim!r} was not selected", remedy=f"name it in claims; the selected claims are: {asked}")
        raise InputError(f"unknown claim {claim!r}", remedy=meant(claim, CLAIMS, f"the selected claims are: {asked}"))

    @property
    def generalized_standard(self) -> bool | None:
        """Origin, convexity and normality all proved, and the state laws of a law with an energy; False if one is refuted, else None.

        None too of a law with rates beside its multiplier, which are not shown to derive from a potential.
        """
        answer = self._together(*self.of_standard)
        return None if answer and isinstance(self.criterion, Criterion) and self.criterion.rates else answer

    @property
    def of_standard(self) -> tuple[str, ...]:
        """The claims that a generalized standard law meets."""
        energy = isinstance(self.criterion, Criterion) and self.criterion.energy is not None
        return ("origin", "convexity", "normality", *(["state_laws"] if energy else []))

    @property
    def of_dissipative(self) -> tuple[str, ...]:
        """The claims that together say D = D_intr + D_th >= 0."""
        heat = isinstance(self.criterion, Criterion) and self.criterion.heat
        return ("dissipation", *(["thermal"] if heat else []))

    @property
    def dissipative(self) -> bool | None:
        """Dissipation proved, and thermal of a law with heat; False if one is refuted; None if open, not asked or ``vacuous``."""
        answer = self._together(*self.of_dissipative)
        return None if answer and self.vacuous else answer

    def _together(self, *claims: str) -> bool | None:
        verdicts = {} if self.interrupted else {r.claim: r.verdict for r in self.results}
        found = [verdicts.get(c) for c in claims]
        if Verdict.REFUTED in found:
            return False
        return True if all(v is Verdict.PROVED for v in found) else None

    def certificate(self, file: AnyPath | None = None) -> dict[str, Any]:
        """The proofs for :func:`duhem.recheck`, as an object for JSON; written into ``file`` too, if one is given.

        It has the law's text, each claim's verdict and trust and, where the kernel confirmed it, rule and evidence; the same at every run.
        Raises InputError where duhem found no exact values of the parameters in their domain, or where the file cannot be written.
        """
        if file is not None:
            check_place(file)
        document = certificate(self.criterion, (*self.rests_on, *self.results))
        if file is not None:
            write(file, json.dumps(document, indent=1, ensure_ascii=False) + "\n")
        return document

    def to_dict(self) -> dict[str, Any]:
        """The JSON report of the interface."""
        return {
            "duhem": __version__,
            "criterion": self.criterion.name,
            "parameters": {name: domain.plain() for name, domain in self.criterion.parameters.items()},
            "domains": {name: domain.numbers() for name, domain in self.criterion.parameters.items()},
            **({} if self.effort == "normal" else {"effort": self.effort}),
            "claims": [r.to_dict() for r in self.results],
            "generalized_standard": self.generalized_standard,
            "dissipative": self.dissipative,
            **({} if self.coupled is None else {"coupled": self.coupled._asdict()}),
            "left_out": [x.to_dict() for x in self.left_out],
            "remarks": list(self.remarks),
            **({"interrupted": True} if self.interrupted else {}),
        }


def verify(
    law: str | Law,
    parameters: Mapping[str, Any] | None = None,
    claims: Iterable[str] | None = None,
    *,
    effort: str = "normal",
    coupled: bool = False,
    on_claim: Callable[[ClaimResult], None] | None = None,
    on_method: OnMethod | None = None,
) -> Verification:
    """Prove or refute the claims about a law, for all values of its parameters and for every pressure.

    ``claims`` selects some claims; by default all of them are decided.  ``parameters`` fixes some values, exactly: decimals are read as
    fractions.  The cost of a claim is counted in steps and not in seconds; ``effort`` is ``quick``, ``normal`` or ``thorough``, and
    multiplies the budget of steps by 1/8, 1 or 8. ``coupled`` asks two claims more, about forces and pressure together: whether unilateral
    contact with this friction has a bipotential (:class:`Coupled`). ``on_claim`` is called with each result.  ``on_method`` is called
    before a method tries a claim, with the claim, the method and the budget of steps: ``spent`` and ``left``. Raises InputError for an
    unknown law, parameter, claim or effort, and for values outside the domain.
    """
    criterion: Law = load(law).fix(parameters)
    asked = (*wanted_claims(claims, criterion), *COUPLED) if coupled else claims
    subject, settled, wanted, results, rests_on = _examined(criterion, asked, effort, on_claim, on_method, criterion.whole, explained=True)
    parts = (
        *not_needed(criterion, [evidence.verdict for evidence in settled.values()]),
        *(LeftOut(f"claim {name}", "not selected") for name in asked_of(criterion) if name not in wanted),
    )
    with _alone():
        said, empty = remarks(subject, settled)
        together = Coupled.of(subject, (*results, *rests_on)) if coupled else None
    return Verification(criterion, results, parts, said, rests_on, effort, empty, coupled=together)


def claim_results(law: Law, claims: Iterable[str] | None = None, effort: str = "normal") -> tuple[ClaimResult, ...]:
    """The results of :func:`verify` alone, where nobody reads what is said beside them."""
    *_, results, _ = _examined(law, claims, effort)
    return results


def verdict_within(law: Criterion, claim: str, steps: int | Budget) -> Verdict:
    """The verdict on one claim, for which no more than so many steps are spent on everything together, or those of a budget.

    The kernel is asked before anything is derived from the law, and about the claims that its rules may rest on only where that shows
    nothing: of most laws that is all.  What finds proofs comes before what refutes.  InputError where the domain is empty.
    """
    check_domain(law)
    kernel, asked = Confirmations(law, Budget(steps) if isinstance(steps, int) else steps), CLAIMS[claim]
    with _alone():
        if kernel.proof(claim, CHEAP.steps, CHEAP.as_written) is None:
            for name in sorted(kernel.needs(claim)):
                if (needed := kernel.proof(name, kernel.whole.left // _SHARE, CHEAP.as_written)) is not None:
                    kernel.of(name, needed)
        subject = dict(_in_state(law, EFFORTS["quick"], kernel.whole)).get(claim) or FormulaSubject(law, EFFORTS["quick"], kernel.whole)
        before = {name: CLAIMS[name].provers_first().examine(subject, {}, kernel) for name in asked.needs if name == "convexity"}
        found = asked.provers_first().examine(subject, before, kernel)
    return found.verdict


def _examined(
    criterion: Law,
    claims: Iterable[str] | None,
    effort: str,
    on_claim: Callable[[ClaimResult], None] | None = None,
    on_method: OnMethod | None = None,
    whole: Law | None = None,
    explained: bool = False,
) -> tuple[Subject, Mapping[str, Evidence], tuple[str, ...], tuple[ClaimResult, ...], tuple[ClaimResult, ...]]:
    """A law with its claims settled, which of them are wanted, the results of these, and of the others that they rest on.

    ``whole`` is the law over wider domains: what is proved of that is proved of this part.  Of each open claim that is wanted, it is
    ``explained`` what is open.
    """
    check_domain(criterion)
    wanted = wanted_claims(claims, criterion)
    if not isinstance(effort, str) or effort not in EFFORTS:
        raise InputError(f"unknown effort {effort!r}", remedy=f"one of: {', '.join(EFFORTS)}")
    with _alone():
        share = EFFORTS[effort]
        whole_law = _subject(criterion, share)
        whole_law.check_defined()  # one that is undefined somewhere in its domain is an InputError
        about: dict[str, Subject] = {**dict.fromkeys(EVERY, whole_law), **dict(_in_state(criterion, share))}
    settled: dict[str, Evidence] = {}
    confirmations = Confirmations(criterion)
    needed = _closed(wanted, lambda name: {*EVERY[name].needs, *confirmations.needs(name)})
    results: list[ClaimResult] = []
    explain: Callable[[str, Subject, Mapping[str, Evidence]], Unsettled | None] | None = None
    for name in (name for name in EVERY if name in needed):
        subject = about[name]
        start, before = time.perf_counter(), subject.spent + confirmations.spent
        with _alone():
            settled[name] = evidence = EVERY[name].examine(subject, settled, confirmations, on_method)
            standing = confirmations.of(name, evidence)
            if whole is not None and (proof := _of_the_whole(name, evidence, standing.trust, whole, effort)) is not None:
                evidence = settled[name] = confirmations.of_a_part(name, proof, whole)
                standing = confirmations.of(name, evidence)
        seconds = time.perf_counter() - start
        verdict, witness, steps = evidence.verdict, evidence.witness, subject.spent + confirmations.spent - before
        left = None
        if name in wanted and explained and verdict in (Verdict.TESTED, Verdict.UNDECIDED):
            from duhem.proof.unsettled.open_claims import OpenClaims  # numpy, only where a claim is open

            explain = explain or OpenClaims(criterion, verdict_within).unsettled
            with _alone():
                left = explain(name, subject, settled)
        said = scope(criterion, verdict), seconds, evidence.detail
        found = ClaimResult(name, verdict, evidence.method, *said, witness, standing.trust, standing.proof, steps, left)
        results.append(found)
        if name in wanted and on_claim is not None:
            on_claim(found)
    used = _closed(wanted, lambda name: {*EVERY[name].needs, *confirmations.rests_on(name)})
    asked, others = (tuple(r for r in results if (r.claim in wanted) is own and r.claim in used) for own in (True, False))
    return whole_law, settled, wanted, asked, others


def _subject(law: Law, share: Fraction) -> FormulaSubject | CurveSubject | GraphSubject:
    """The law under examination, by its kind."""
    if not isinstance(law, Criterion):
        return CurveSubject(law, share)
    return (GraphSubject if law.graph else RateSubject if law.forces_of_rates else FormulaSubject)(law, share)


def _in_state(law: Law, share: Fraction, steps: Budget | None = None) -> Iterator[tuple[str, FormulaSubject]]:
    """The claims that are about other forces where a law has an energy or a potential of rates, with what is examined for each."""
    if not isinstance(law, Criterion):
        return
    if law.viscous:
        potential = FormulaSubject(rate_epigraph(law), share, steps, of=law)
        yield from ((name, potential) for name in CLAIMS if name not in ("state_laws", "thermal"))
    if (stored := epigraph(law)) is not None:
        yield "state_laws", FormulaSubject(stored, share, steps, of=law)
    if (found := dissipating(law)) is not None:
        in_state = FormulaSubject(found.law, share, steps, of=law, state=found)
        try:
            in_state.check_defined()
        except InputError as fault:
            raise InputError(f"with the forces that the energy gives, {fault.what}", where=fault.where, remedy=fault.remedy) from None
        yield "dissipation", in_state


def _of_the_whole(name: str, evidence: Evidence, best: Trust | None, whole: Law, effort: str) -> ClaimResult | None:
    """A claim of the whole law where that is proved with more trust than the part; None where it is not, or need not be asked."""
    if evidence.verdict is Verdict.REFUTED or best is Trust.CHECKED:
        return None
    (found,) = claim_results(whole, (name,), effort)
    return found if found.trust is Trust.CHECKED or (best is None and found.trust is not None) else None


@contextmanager
def _alone() -> Iterator[None]:
    """SymPy's assumptions and Arb's precision belong to the process: a thread has them to itself, as they are at the start."""
    with _TURN, precision(_BITS):
        yield


def wanted_claims(claims: Iterable[str] | None, law: Law | None = None, where: str = "") -> tuple[str, ...]:
    """The claims named, for None all that are asked of a law; InputError for what is none."""
    every = f"the claims are: {', '.join(CLAIMS)}"
    if not isinstance(claims, Iterable | None):
        raise InputError(f"{claims!r} names no claims", where="claims", remedy=every)
    names = asked_of(law) if claims is None else (claims,) if isinstance(claims, str) else tuple(claims)
    for name in names:
        if not isinstance(name, str) or name not in EVERY:
            raise InputError(f"unknown claim {name!r}", where=where, remedy=meant(name, CLAIMS, every, both=True))
    return names


def _closed(wanted: tuple[str, ...], needs: Callable[[str], Iterable[str]]) -> set[str]:
    """The claims, those that they need, those that these need, and so on."""
    found = set(wanted)
    while more := {name for each in found for name in needs(each)} - found:
        found |= more
    return found


# -- what a proof rests on ---------------------------------------------------------------------------------------------


@dataclass(frozen=True)
class Standing:
    """What a proof rests on and, where the kernel confirmed it, how.  Where a claim is not proved both are None."""

    trust: Trust | None = None
    proof: Proof | None = None


@dataclass
class Confirmations:
    """The proofs of one law so far, and how each stands.  It is the kernel as the claims ask it; its work draws on the ``whole``."""

    law: Law
    whole: Budget = field(default_factory=lambda: Budget(ANY_STEPS))
    standings: dict[str, Standing] = field(default_factory=dict)
    spent: int = 0

    def __post_init__(self) -> None:
        self._stated = _stated(self.law)
        # the claim, the proof, ``as_written``, whether it holds, and the steps that were allowed, where they were too few
        self._answers: list[tuple[str, Proof, bool | None, bool, int]] = []

    def needs(self, claim: str) -> frozenset[str]:
        """The claims that the kernel's rules for a claim may rest on."""
        return frozenset() if self._stated is None else needs_of(claim, self._stated)

    def rests_on(self, claim: str) -> frozenset[str]:
        """The claims that the rule which proved a claim rests on; none where no rule did."""
        found = self.standings.get(claim)
        return frozenset() if found is None or found.proof is None else self._needed(claim, found.proof)

    def proof(self, claim: str, steps: int, as_written: bool | None = None) -> Evidence | None:
        """What the first rule proves that needs no evidence, each within so many steps; None where none does."""
        found = next((offer for offer in self._in_order(claim) if self._accepts(claim, offer, steps, as_written)), None)
        row = None if found is None or self._stated is None else row_of(claim, found.rule, self._stated)
        return None if found is None or row is None else Evidence(Verdict.PROVED, found.rule, row.sentence, proof=found)

    def confirms(self, claim: str, evidence: Evidence) -> bool:
        """Whether the kernel accepts a proof: it asks itself whether what its rule needs is defined, of this claim alone."""
        found = self._accepted(claim, evidence.proof)
        return found is not None and self._needed(claim, found) <= self._checked()

    def of(self, claim: str, evidence: Evidence) -> Standing:
        """How a proof stands, where the claims that its rule needs came before."""
        self.standings.pop(claim, None)  # a proof may have turned out to be none
        if evidence.verdict is not Verdict.PROVED:
            return Standing()
        proof = self._accepted(claim, evidence.proof)
        premises = () if proof is None else self._needed(claim, proof)
        own = Trust.PROVER if proof is None else Trust.CHECKED
        trust = Trust.weakest(own, *(self.standings[name].trust or Trust.PROVER for name in premises))
        self.standings[claim] = Standing(trust, proof if trust is Trust.CHECKED else None)
        return self.standings[claim]

    def of_a_part(self, claim: str, whole: ClaimResult, law: Law) -> Evidence:
        """A proof that holds over all of a ``law``, said of this one, which has parts of the domains of its parameters."""
        detail, proof = f"{whole.detail} (shown {_OVER_ALL})", whole.proof
        if proof is not None:
            domains = {
                name: domain for name, domain in law_as_text(law)["parameters"].items() if law.parameters[name] != self.law.parameters[name]
            }
            proof = replace(proof, evidence={**proof.evidence, OVER: domains})
        return Evidence(Verdict.PROVED, whole.method, detail, proof=proof)

    def _checked(self) -> frozenset[str]:
        return frozenset(name for name, found in self.standings.items() if found.trust is Trust.CHECKED)

    def _needed(self, claim: str, proof: Proof) -> frozenset[str]:
        row = None if self._stated is None else row_of(claim, proof.rule, self._stated)
        return frozenset() if row is None else row.needed

    def _in_order(self, claim: str) -> Iterator[Proof]:
        """The rules without evidence whose needs are met; first those that rest on nothing but what was checked."""
        offers = [] if self._stated is None else [Proof(rule) for rule in rules_of(claim, self._stated)]
        checked = self._checked()
        yield from sorted(offers, key=lambda offer: not self._needed(claim, offer) <= checked)

    def _accepted(self, claim: str, offered: Proof | None) -> Proof | None:
        """The proof that the kernel accepts: the one that is offered; where none is, by a rule that needs no evidence."""
        offers = self._in_order(claim) if offered is None else (offered,)
        return next((offer for offer in offers if self._accepts(claim, offer, _MOST_STEPS)), None)

    def _accepts(self, claim: str, offer: Proof, steps: int, as_written: bool | None = None) -> bool:
        """Whether the kernel has no objection to a proof, found within so many steps."""
        if self._stated is None:
            return False
        steps = min(steps, self.whole.left)
        refused = set[bool | None]()
        for name, proof, read, holds, allowed in reversed(self._answers):
            if (name, proof) == (claim, offer):
                if holds:
                    return True
                refused |= {read} if allowed >= steps else set()
        if {as_written, None} & refused or {True, False} <= refused:
            return False
        settled, allowed = frozenset(self.standings), ANY_STEPS
        with within(steps) as purse:
            try:
                asked = _stated(self.law, offer.evidence.get(OVER)) if OVER in offer.evidence else self._stated
                holds = asked is not None and not objection(claim, offer.rule, settled, asked, offer.evidence, as_written)
            except TooDearError:
                holds, allowed = False, steps
        self.spent += purse.spent
        self.whole.pays(min(purse.spent, steps))  # the last step may have been too dear
        if holds or self._needed(claim, offer) <= settled:  # else it may still be proved
            self._answers.append((claim, offer, as_written, holds, allowed))
        return holds


def _stated(law: Law, over: Mapping[str, Any] | None = None) -> Stated | None:
    """The law as the kernel has it, perhaps over wider domains; None where that reads nothing of it."""
    try:
        return stated(law_as_text(law), over)
    except (NotWritten, OverflowError, RecursionError):
        return None
