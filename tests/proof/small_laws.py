"""Laws of the forces a and b at the pressure s, with parameters of every kind of range, for the kernel alone."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from duhem.proof.kernel.claims import objection
from duhem.proof.kernel.curvature import over
from duhem.proof.kernel.domain import StatedDomain
from duhem.proof.kernel.polynomial import Polynomial
from duhem.proof.kernel.stated_law import StatedLaw
from duhem.proof.kernel.term import parse
from tests.oracles import drawn_formulas

__all__ = ["confirmed", "domain", "law", "poly"]

# Of every kind of range; a law alone goes without the last four, since rules of curvature call their directions v and w.
PARAMETERS = {**drawn_formulas.PARAMETERS, "u": {}, "w": {"min": "1"}, "v": {"max": "-1"}, "h": {"positive": True, "max": "2"}}


def law(g: str, forces: Sequence[str] = ("a", "b"), flow: Any = None, **more: Any) -> StatedLaw:
    given = {"forces": forces, "pressure": "s", "parameters": drawn_formulas.PARAMETERS, "constraints": [], "g": g, "flow": flow}
    return StatedLaw.read(given | more)


def domain(*constraints: str, g: str = "a") -> StatedDomain:
    return over(law(g, parameters=PARAMETERS, constraints=list(constraints)))


def poly(text: str) -> Polynomial:
    return domain().polynomial(parse(text))


def confirmed(claim: str, rule: str, stated: StatedLaw, evidence: Any = None, settled: str = "") -> bool:
    return not objection(claim, rule, frozenset(settled.split()), stated, evidence or {})
