"""A verification written down so that the kernel can check it: the law's text, the claims, the rule and evidence of each."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import sympy as sp

from duhem.derivation.support_function import support_function
from duhem.errors import InputError
from duhem.expression.parse import parse_expression
from duhem.expression.text import formula
from duhem.law.catalogue import load_formula
from duhem.law.domain import Domain
from duhem.law.formula_law import Criterion
from duhem.law.parameter_domain import simple_points
from duhem.proof.facts.parameter_choices import plain_choices, rationals
from duhem.proof.kernel.certificate import CLAIMS, SCHEMA, digest
from duhem.proof.kernel.claims import confirmed, rules_of
from duhem.proof.kernel.domain import StatedLaw
from duhem.proof.verdict import Verdict
from duhem.proof.verification import ClaimResult, Verification

__all__ = ["certificate", "law_as_text"]

_SOLVERS = ("smt", "z3")


def certificate(verification: Verification) -> dict[str, Any]:
    """The certificate as a JSON object: deterministic, without times, with a hash of its content.

    Each claim has ``trust``: ``checked`` where the kernel confirmed the proof against the law's text, ``solver`` where it
    rests on the word of a solver, ``prover`` where the kernel has no rule for the argument; null where nothing is proved.
    Raises InputError for a law given by a boundary curve, whose text the kernel does not read.
    """
    law = load_formula(verification.criterion)
    claims = [_claim(result, law) for result in verification.results]
    stated = StatedLaw.read(law_as_text(law))
    settled = set[str]()
    for claim in sorted((c for c in claims if c["verdict"] == "proved"), key=lambda c: CLAIMS.index(c["claim"])):
        for rule in rules_of(claim["claim"]):
            if confirmed(claim["claim"], rule, frozenset(settled), stated, claim["evidence"]):
                claim["rule"], claim["trust"] = rule, "checked"
                settled.add(claim["claim"])
                break
    document = {"schema": SCHEMA, "law": law_as_text(law), "inhabited": _inhabited(law), "claims": claims}
    return document | {"sha256": digest(document)}


def law_as_text(law: Criterion) -> dict[str, Any]:
    """The law as the kernel reads it: every formula as text."""
    return {
        "name": law.name,
        "forces": list(law.forces),
        "pressure": law.pressure,
        "parameters": {name: _domain(domain) for name, domain in law.parameters.items()},
        "constraints": [formula(c) for c in law.constraints],
        "g": _as_written(law),
        "flow": None if law.flow is None else [formula(c) for c in law.flow],
    }


def _as_written(law: Criterion) -> str:
    """The formula as it was given, if it still is the law's; else as the law has it."""
    try:
        return law.written if law.written and parse_expression(law.written, law.symbols()) == law.g else formula(law.g)
    except InputError:
        return formula(law.g)


def _domain(domain: Domain) -> dict[str, Any]:
    if domain.value is not None:
        return {"value": str(domain.value)}
    high = None if domain.high is None else str(domain.high)
    return {"positive": True, "max": high} if domain.positive else {"min": None if domain.low is None else str(domain.low), "max": high}


def _inhabited(law: Criterion) -> dict[str, str]:
    """A point of the parameters' domain, which shows that a claim over it is not empty."""
    table = law.symbols()
    free = [table[name] for name, domain in law.parameters.items() if domain.value is None]
    given = [r for x in free for r in law.parameters[x.name].relations(x)]
    for point in (*simple_points(law), *map(rationals, plain_choices(free, [*given, *law.constraints]))):
        whole = {table[n]: d.value for n, d in law.parameters.items() if d.value is not None} | dict(point)
        if all(r.subs(whole) in (sp.true, True) for r in (*given, *law.constraints)):
            return {x.name: str(value) for x, value in whole.items()}
    raise InputError("no exact point of the parameters' domain was found", where=law.name, remedy="fix a parameter with --set")


def _claim(result: ClaimResult, law: Criterion) -> dict[str, Any]:
    """One claim with the method that settled it; no rule of the kernel yet."""
    method, _, inside = result.method.partition(" (")
    trust = None if result.verdict is not Verdict.PROVED else "solver" if any(s in inside for s in _SOLVERS) else "prover"
    found = {"claim": result.claim, "verdict": result.verdict.value, "trust": trust, "method": result.method, "rule": None}
    return found | {"evidence": _evidence(method, law)}


def _evidence(method: str, law: Criterion) -> Mapping[str, Any]:
    if method != "polar-gauge" or (found := support_function(law)) is None:
        return {}
    return {"potential": formula(found.potential), "slips": {f: x.name for f, x in zip(law.forces, found.rates, strict=True)}}
