"""A law against the claims: each examined in order, its evidence kept, the whole as one value."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from typing import Any

import sympy as sp

from duhem.errors import InputError
from duhem.expression.text import formula
from duhem.law.catalogue import load
from duhem.law.curve_law import Law
from duhem.law.formula_law import Criterion
from duhem.law.parameter_domain import check_domain
from duhem.left_out import LeftOut
from duhem.proof.claims import CLAIMS
from duhem.proof.decide import Question, Sense, decide
from duhem.proof.facts.case import Case
from duhem.proof.facts.curve import CurveCase
from duhem.proof.facts.regularity import regularity
from duhem.proof.verdict import Evidence, Verdict, Witness
from duhem.version import __version__

__all__ = ["ClaimResult", "Verification", "verify"]


@dataclass(frozen=True)
class ClaimResult:
    """One row of the verdict table; ``seconds`` of wall clock, ``scope`` what the verdict ranges over."""

    claim: str
    verdict: Verdict
    method: str
    scope: str
    seconds: float
    detail: str
    witness: Witness | None = None

    def to_dict(self) -> dict[str, Any]:
        """The row as the JSON report has it."""
        return {
            "claim": self.claim,
            "verdict": self.verdict.value,
            "method": self.method,
            "scope": self.scope,
            "seconds": round(self.seconds, 4),
            "detail": self.detail,
            "witness": None if self.witness is None else self.witness.to_dict(),
        }


@dataclass(frozen=True)
class Verification:
    """Everything found about ``criterion`` (with the asked parameters fixed)."""

    criterion: Law
    results: tuple[ClaimResult, ...]
    left_out: tuple[LeftOut, ...]
    remarks: tuple[str, ...]

    def __getitem__(self, claim: str) -> ClaimResult:
        for result in self.results:
            if result.claim == claim:
                return result
        raise KeyError(claim)

    @property
    def generalized_standard(self) -> bool | None:
        """Origin, convexity and normality all proved; False if one is refuted; None if open or not asked."""
        return self._together("origin", "convexity", "normality")

    @property
    def dissipative(self) -> bool | None:
        """Dissipation proved; False if refuted; None if open or not asked."""
        return self._together("dissipation")

    def _together(self, *claims: str) -> bool | None:
        verdicts = {r.claim: r.verdict for r in self.results}
        found = [verdicts.get(c) for c in claims]
        if Verdict.REFUTED in found:
            return False
        return True if all(v is Verdict.PROVED for v in found) else None

    def to_dict(self) -> dict[str, Any]:
        """The JSON report of the interface."""
        return {
            "duhem": __version__,
            "criterion": self.criterion.name,
            "parameters": {name: domain.describe() for name, domain in self.criterion.parameters.items()},
            "claims": [r.to_dict() for r in self.results],
            "generalized_standard": self.generalized_standard,
            "dissipative": self.dissipative,
            "left_out": [x.to_dict() for x in self.left_out],
            "remarks": list(self.remarks),
        }


def verify(
    law: str | Law,
    parameters: Mapping[str, Any] | None = None,
    claims: Iterable[str] | None = None,
    *,
    on_claim: Callable[[ClaimResult], None] | None = None,
) -> Verification:
    """Prove or refute every claim (or those named) over the law's whole parameter domain and every pressure.

    ``parameters`` fixes some values (exactly: decimals are rationals); ``on_claim`` is called as each result is in.
    Raises InputError for an unknown law, parameter or claim, and for values outside the domain.
    """
    criterion: Law = load(law).fix(parameters)
    check_domain(criterion)
    wanted = _wanted(claims)
    case = Case(criterion) if isinstance(criterion, Criterion) else CurveCase(criterion)
    if isinstance(case, Case):
        _check_quotients(case)
    settled: dict[str, Evidence] = {}
    results = []
    for name in CLAIMS:
        if name not in _with_needs(wanted):
            continue
        start = time.perf_counter()
        settled[name] = evidence = CLAIMS[name].examine(case, settled)
        seconds = time.perf_counter() - start
        if name in wanted:
            result = ClaimResult(
                name, evidence.verdict, evidence.method, _scope(criterion, evidence), seconds, evidence.detail, evidence.witness
            )
            results.append(result)
            if on_claim is not None:
                on_claim(result)
    return Verification(criterion, tuple(results), _left_out(criterion, wanted, settled), _remarks(case) if isinstance(case, Case) else ())


def _check_quotients(case: Case) -> None:
    """Raise InputError where the formula divides by something that is 0 for admitted parameter values."""
    problem, forces = case.problem, set(case.law.force_symbols())
    remedy = "keep its domain away from there (positive = true, or a least value above 0)"
    if problem.g.has(sp.zoo, sp.nan, sp.oo, -sp.oo):
        raise InputError(f"{formula(case.law.g)} is undefined at the fixed values", where=case.law.name, remedy=remedy)
    bases = {p.base for p in problem.g.atoms(sp.Pow) if p.exp.could_extract_minus_sign() and not p.base.free_symbols & forces}
    for base in sorted(bases, key=str):
        answer = decide(Question(base**2, Sense.POSITIVE, problem.given))
        point = {x: v for x, v in (answer.point or {}).items() if x in base.free_symbols}
        if answer.holds is False and base.free_symbols <= point.keys() and base.subs(point) == 0:
            at = ", ".join(f"{x} = {v}" for x, v in point.items())
            raise InputError(f"g divides by {formula(base)}, which is 0 at {at}", where=case.law.name, remedy=remedy)


def _wanted(claims: Iterable[str] | None) -> tuple[str, ...]:
    names = tuple(CLAIMS) if claims is None else tuple(claims)
    for name in names:
        if name not in CLAIMS:
            raise InputError(f"unknown claim {name!r}", remedy=f"the claims are: {', '.join(CLAIMS)}")
    return names


def _with_needs(wanted: tuple[str, ...]) -> set[str]:
    needed: set[str] = set()
    queue = list(wanted)
    while queue:
        name = queue.pop()
        if name not in needed:
            needed.add(name)
            queue.extend(CLAIMS[name].needs)
    return needed


def _scope(law: Law, evidence: Evidence) -> str:
    if evidence.verdict is Verdict.REFUTED:
        return "at the witness"
    if evidence.verdict is Verdict.TESTED:
        return "sampled parameters"
    fixed = [f"{n} = {d.value}" for n, d in law.parameters.items() if d.value is not None]
    if not fixed:
        return "all parameters"
    return f"all other parameters, {', '.join(fixed)}" if len(fixed) < len(law.parameters) else ", ".join(fixed)


def _left_out(law: Law, wanted: tuple[str, ...], settled: Mapping[str, Evidence]) -> tuple[LeftOut, ...]:
    parts = [LeftOut("thermal", "isothermal law: no temperature among its variables, so D_th and the entropy do not enter")]
    if law.flow is None:
        parts.append(LeftOut("flow check", "associated law: the slip is the normality rule itself"))
    if law.pressure is None:
        parts.append(LeftOut("pressure", "the law has none: K is one set"))
    if len(law.forces) == 1:
        parts.append(LeftOut("seams", "one force: the boundary has no seam to cross"))
    if not any(e.verdict in (Verdict.REFUTED, Verdict.TESTED) for e in settled.values()):
        parts.append(LeftOut("numerical search", "every examined claim was settled by proof"))
    parts.extend(LeftOut(f"claim {name}", "not asked for") for name in CLAIMS if name not in wanted)
    return tuple(parts)


def _remarks(case: Case) -> tuple[str, ...]:
    """Statements often made of such laws that hold only with an exception."""
    facts = regularity(case.problem.g, case)
    tips = sorted({formula(_stated(case, tip)) for tip in facts.tips}) if facts.known and not facts.kinks else []
    if not tips:
        return ()
    at_zero = case.problem.g.xreplace(dict.fromkeys(case.problem.forces, sp.S.Zero))
    place = f"where {', '.join(tips)} = 0"
    inside = "; that point is inside K for sigma_n < 0, so the boundary is not touched" if case.law.pressure and at_zero.is_negative else ""
    return (f"'g is differentiable' holds with one exception: not {place}{inside}",)


def _stated(case: Case, expr: sp.Expr) -> sp.Expr:
    """An expression of the problem in the law's own names."""
    magnitude, pressure = case.problem.magnitude, case.law.pressure
    return expr if magnitude is None or pressure is None else expr.xreplace({magnitude: sp.Abs(sp.Symbol(pressure, real=True))})
