"""A law as text, which is all that the kernel knows of it, and a verification written down so that the kernel can check it."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

from duhem.errors import InputError
from duhem.expression.fold import graph_of
from duhem.law.curve_law import Law, ParametricCriterion
from duhem.law.domain import Domain
from duhem.law.formula_law import Criterion, YieldSurface
from duhem.law.state import Variable
from duhem.proof.facts.formula_subject import admitted_values
from duhem.proof.kernel.certificate import SCHEMA, digest
from duhem.proof.statement import texts
from duhem.proof.verdict import ClaimResult

__all__ = ["certificate", "law_as_text"]


def law_as_text(law: Law) -> dict[str, Any]:
    """The law as the kernel reads it: every formula as text, numbers too."""
    return {
        "name": law.name,
        "forces": list(law.forces),
        "pressure": law.pressure,
        "parameters": {name: _domain(domain) for name, domain in law.parameters.items()},
        "constraints": texts(law, law.constraints, law.written_constraints),
        **(_curve(law) if isinstance(law, ParametricCriterion) else _formula(law)),
    }


def _curve(law: ParametricCriterion) -> dict[str, Any]:
    parts = texts(law, law.components(), law.written)
    return {"angle": law.angle, "boundary": parts[:2], "flow": None if law.flow is None else parts[2:]}


def _formula(law: Criterion) -> dict[str, Any]:
    domain = {"domain": {n: _domain(d) for n, d in law.domain.items()}} if law.domain else {}
    if law.forces_of_rates:
        return _state(law)
    return ({"surfaces": [_bound(law, s) for s in law.surfaces]} if law.surfaces else _bound(law, law)) | domain | _state(law)


def _state(law: Criterion) -> dict[str, Any]:
    """The variables with their forces, the energy and the rates, where a law has them."""
    found: dict[str, Any] = {"variables": {name: _variable(own) for name, own in law.variables.items()}} if law.variables else {}
    if law.energy is not None:
        found["energy"] = texts(law, (law.energy,), (law.written_energy,))[0]
    for key in ("rates", "unforced", "heat", "forces_of_rates"):
        named, written = getattr(law, key), getattr(law, f"written_{key}")
        if named:
            found[key] = dict(zip(named, texts(law, tuple(named.values()), [written[name] for name in named]), strict=True))
    return found


def _variable(own: Variable) -> dict[str, Any]:
    kinds = {kind: True for kind in ("observable", "temperature") if getattr(own, kind)}
    return kinds | ({} if own.force is None else {"force": own.force})


def _bound(law: Criterion, stated: Criterion | YieldSurface) -> dict[str, Any]:
    graph = graph_of(stated.g)
    g, *flow = texts(law, (stated.g, *(stated.flow or ())), (graph.last if graph else stated.written, *stated.written_flow))
    define = {"define": [list(pair) for pair in graph.nodes]} if graph else {}
    own = flow if stated.potential is None else {"potential": stated.potential}
    viscous = {"viscous": True} if stated is law and law.viscous else {}
    return {"g": g, "flow": None if stated.flow is None else own, **define, **viscous}


def _domain(domain: Domain) -> dict[str, Any]:
    if domain.value is not None:
        return {"value": str(domain.value)}
    high = None if domain.high is None else str(domain.high)
    return {"positive": True, "max": high} if domain.positive else {"min": None if domain.low is None else str(domain.low), "max": high}


def certificate(law: Law, results: Iterable[ClaimResult]) -> dict[str, Any]:
    """What was decided of a law as a JSON object: deterministic, without times, with a hash of its content.

    Each claim has its :class:`~duhem.proof.verdict.Trust` and, where the kernel confirmed it, the rule and its evidence.
    Raises InputError where no exact parameter values of the domain are found.
    """
    if (inhabited := admitted_values(law)) is None:
        raise InputError("no exact point of the parameters' domain was found", where=law.name, remedy="fix a parameter with --set")
    document = {"schema": SCHEMA, "law": law_as_text(law), "inhabited": dict(inhabited), "claims": [_claim(result) for result in results]}
    return document | {"sha256": digest(document)}


def _claim(result: ClaimResult) -> dict[str, Any]:
    return {
        "claim": result.claim,
        "verdict": result.verdict.value,
        "trust": None if result.trust is None else result.trust.value,
        "method": result.method,
        "rule": None if result.proof is None else result.proof.rule,
        "evidence": {} if result.proof is None else dict(result.proof.evidence),
    }
