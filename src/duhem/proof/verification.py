"""A law against the claims: each examined in order, its evidence kept, the whole as one value."""

from __future__ import annotations

import json
import time
from collections.abc import Callable, Iterable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass
from difflib import get_close_matches
from functools import partial
from threading import RLock
from typing import Any, ClassVar, NamedTuple

from duhem.errors import InputError
from duhem.expression.balls import precision
from duhem.law.catalogue import load
from duhem.law.curve_law import Law
from duhem.law.formula_law import Criterion
from duhem.law.parameter_domain import check_domain
from duhem.left_out import LeftOut
from duhem.proof.certificate import certificate
from duhem.proof.claims import CHEAP, CLAIMS
from duhem.proof.decide import EFFORTS, Budget
from duhem.proof.facts.curve_subject import CurveSubject
from duhem.proof.facts.formula_subject import FormulaSubject
from duhem.proof.facts.subject import Subject
from duhem.proof.remarks import not_needed, remarks, scope
from duhem.proof.trust import Confirmations
from duhem.proof.verdict import CONTRADICTION, ClaimResult, Evidence, Trust, Verdict
from duhem.show.place import AnyPath, check_place, write
from duhem.show.printing import Shown
from duhem.version import __version__

__all__ = ["ClaimResult", "Verification", "claim_results", "verdict_within", "verify", "wanted_claims"]

_TURN = RLock()
_BITS = 53  # what Arb starts with
_SHARE = 4  # such a part of the steps left may go to a claim that another rests on


@dataclass(frozen=True, repr=False)
class Verification(Shown):
    """Everything found about ``criterion`` (with the asked parameters fixed).

    ``rests_on`` holds the claims that were not asked for, and that those asked for rest on.  ``vacuous`` where K has no boundary
    point at which anything could dissipate: a remark says why.  ``interrupted`` where somebody stopped it: nothing is concluded then.
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

    def __repr__(self) -> str:
        return f"<Verification of {self.criterion.name}: {', '.join(f'{r.claim} {r.verdict}' for r in self.results) or 'no claim'}>"

    def __iter__(self) -> Iterator[ClaimResult]:
        return iter(self.results)

    def __getitem__(self, claim: str) -> ClaimResult:
        for result in self.results:
            if result.claim == claim:
                return result
        asked = ", ".join(result.claim for result in self.results) or "none"
        if isinstance(claim, str) and claim in CLAIMS:
            raise InputError(f"the claim {claim!r} was not asked for", remedy=f"name it in claims; those asked for are: {asked}")
        near = get_close_matches(str(claim), CLAIMS, n=1)
        raise InputError(f"unknown claim {claim!r}", remedy=f"did you mean {near[0]!r}?" if near else f"those asked for are: {asked}")

    @property
    def generalized_standard(self) -> bool | None:
        """Origin, convexity and normality all proved; False if one is refuted; None if open or not asked."""
        return self._together("origin", "convexity", "normality")

    @property
    def dissipative(self) -> bool | None:
        """Dissipation proved; False if refuted; None if open, not asked or ``vacuous``."""
        answer = self._together("dissipation")
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
        Raises InputError where no exact values of the parameters are found in their domain, or where the file cannot be written.
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
    on_claim: Callable[[ClaimResult], None] | None = None,
    on_method: Callable[[str, str, Budget], None] | None = None,
) -> Verification:
    """Prove or refute every claim (or the one or those named) over the law's whole parameter domain and every pressure.

    ``parameters`` fixes some values (exactly: decimals are rationals); ``on_claim`` is called as each result is in,
    ``on_method`` before a method tries a claim, with both and the steps from which it draws: ``spent``, and ``left``.
    What a claim may cost is counted in steps, not by a clock; ``effort`` quick, normal or thorough multiplies them.
    Raises InputError for an unknown law, parameter, claim or effort, and for values outside the domain.
    """
    criterion: Law = load(law).fix(parameters)
    examined = _examined(criterion, claims, effort, on_claim, on_method, criterion.whole)
    parts = (
        *not_needed(criterion, [evidence.verdict for evidence in examined.settled.values()]),
        *(LeftOut(f"claim {name}", "not asked for") for name in CLAIMS if name not in examined.wanted),
    )
    with _alone():
        said, empty = remarks(examined.subject, examined.settled)
    return Verification(criterion, examined.results, parts, said, examined.rests_on, effort, empty)


def claim_results(law: Law, claims: Iterable[str] | None = None, effort: str = "normal") -> tuple[ClaimResult, ...]:
    """The results of :func:`verify` alone, where nobody reads what is said beside them."""
    return _examined(law, claims, effort).results


def verdict_within(law: Criterion, claim: str, steps: int) -> Verdict:
    """The verdict on one claim, for which no more than so many steps are spent on everything together.

    The kernel is asked before anything is derived from the law, and about the claims that its rules may rest on only where that shows
    nothing: of most laws that is all.  What finds proofs comes before what refutes.  InputError where the domain is empty.
    """
    check_domain(law)
    kernel, asked = Confirmations(law, Budget(steps)), CLAIMS[claim]
    with _alone():
        if kernel.proof(claim, CHEAP.steps) is None:
            for name in sorted(kernel.needs(claim)):
                if (needed := kernel.proof(name, kernel.whole.left // _SHARE)) is not None:
                    kernel.of(name, needed, ())
        subject = FormulaSubject(law, EFFORTS["quick"], kernel.whole)
        found = asked.provers_first().examine(subject, {}, kernel)
        if kernel.of(claim, found, ()).trust not in (None, Trust.CHECKED):
            found = asked.contradiction(subject, {claim: found}) or found
    return found.verdict


class _Examined(NamedTuple):
    """A law with its claims settled; ``results`` are of those ``wanted``."""

    subject: Subject
    settled: Mapping[str, Evidence]
    wanted: tuple[str, ...]
    results: tuple[ClaimResult, ...]
    rests_on: tuple[ClaimResult, ...]


def _examined(
    criterion: Law,
    claims: Iterable[str] | None,
    effort: str,
    on_claim: Callable[[ClaimResult], None] | None = None,
    on_method: Callable[[str, str, Budget], None] | None = None,
    whole: Law | None = None,
) -> _Examined:
    """``whole`` is the law over wider domains: what is proved of that is proved of this part."""
    check_domain(criterion)
    wanted = wanted_claims(claims)
    if not isinstance(effort, str) or effort not in EFFORTS:
        raise InputError(f"unknown effort {effort!r}", remedy=f"one of: {', '.join(EFFORTS)}")
    with _alone():
        share = EFFORTS[effort]
        subject = FormulaSubject(criterion, share) if isinstance(criterion, Criterion) else CurveSubject(criterion, share)
        subject.check_defined()  # one that is undefined somewhere in its domain is an InputError
    settled: dict[str, Evidence] = {}
    confirmations = Confirmations(criterion)
    needed = _closed(wanted, lambda name: {*CLAIMS[name].needs, *confirmations.needs(name)})
    results: list[ClaimResult] = []
    for name in (name for name in CLAIMS if name in needed):
        start, before = time.perf_counter(), subject.spent + confirmations.spent
        with _alone():
            told = partial(_tell, on_method, subject, name)
            settled[name] = evidence = CLAIMS[name].examine(subject, settled, confirmations, told)
            standing = confirmations.of(name, evidence, CLAIMS[name].needs)
            doubted = standing.trust not in (None, Trust.CHECKED)
            if doubted and (against := CLAIMS[name].contradiction(subject, settled)) is not None:
                settled[name] = evidence = against
                standing = confirmations.of(name, evidence, CLAIMS[name].needs)
            if whole is not None and (proof := _of_the_whole(name, evidence, standing.trust, whole, effort)) is not None:
                evidence = settled[name] = confirmations.of_a_part(name, proof, whole)
                standing = confirmations.of(name, evidence, CLAIMS[name].needs)
        seconds = time.perf_counter() - start
        verdict, witness, steps = evidence.verdict, evidence.witness, subject.spent + confirmations.spent - before
        said = scope(criterion, verdict), seconds, evidence.detail
        found = ClaimResult(name, verdict, evidence.method, *said, witness, standing.trust, standing.proof, steps)
        results.append(found)
        if name in wanted and on_claim is not None:
            on_claim(found)
    used = _closed(wanted, lambda name: {*CLAIMS[name].needs, *confirmations.rests_on(name)})
    asked, others = (tuple(r for r in results if (r.claim in wanted) is own and r.claim in used) for own in (True, False))
    return _Examined(subject, settled, wanted, asked, others)


def _of_the_whole(name: str, evidence: Evidence, best: Trust | None, whole: Law, effort: str) -> ClaimResult | None:
    """A claim of the whole law where that is proved with more trust than the part; None where it is not, or need not be asked."""
    if evidence.verdict is Verdict.REFUTED or evidence.method == CONTRADICTION or best is Trust.CHECKED:
        return None
    (found,) = claim_results(whole, (name,), effort)
    better = found.trust is not None and (best is None or Trust.weakest(found.trust, best) is not found.trust)
    return found if better else None


def _tell(on_method: Callable[[str, str, Budget], None] | None, subject: Subject, claim: str, method: str) -> None:
    if on_method is not None:
        on_method(claim, method, subject.budget)


@contextmanager
def _alone() -> Iterator[None]:
    """SymPy's assumptions and Arb's precision belong to the process: a thread has them to itself, as they are at the start."""
    with _TURN, precision(_BITS):
        yield


def wanted_claims(claims: Iterable[str] | None) -> tuple[str, ...]:
    """The claims named, all of them for None; InputError for what is none."""
    every = f"the claims are: {', '.join(CLAIMS)}"
    if not isinstance(claims, Iterable | None):
        raise InputError(f"{claims!r} names no claims", where="claims", remedy=every)
    names = tuple(CLAIMS) if claims is None else (claims,) if isinstance(claims, str) else tuple(claims)
    for name in names:
        if not isinstance(name, str) or name not in CLAIMS:
            near = get_close_matches(str(name), CLAIMS, n=1)
            raise InputError(f"unknown claim {name!r}", remedy=f"did you mean {near[0]!r}? {every}" if near else every)
    return names


def _closed(wanted: tuple[str, ...], needs: Callable[[str], Iterable[str]]) -> set[str]:
    """The claims, those that they need, those that these need, and so on."""
    found: set[str] = set()
    queue = list(wanted)
    while queue:
        name = queue.pop()
        if name not in found:
            found.add(name)
            queue.extend(needs(name))
    return found
