"""Laws in sigma and Y with a slip and a hardening alpha, as values and as files, and what is asked of many of them."""

from __future__ import annotations

from fractions import Fraction
from typing import Any

import pytest
import sympy as sp

from duhem import Criterion, Domain, InputError
from duhem.law.criterion_file import reads
from duhem.law.state import Variable
from duhem.proof.certificate import law_as_text
from duhem.proof.kernel.claims import objection
from duhem.proof.kernel.stated_law import StatedLaw
from duhem.proof.kernel.steps import within

__all__ = [
    "ABOVE_0", "ALONG", "AT_LEAST_0", "BELOW_0", "FILE", "ONE", "PRAGER", "QUADRATIC", "RECOVERS", "RECOVERY", "SHARE", "SLIP",
    "armstrong_frederick", "isotropic", "kinematic", "law", "misread", "refused", "violated", "viscous",
]  # fmt: skip

AT_LEAST_0, ABOVE_0 = Domain.between(0, None), Domain(low=Domain.between(0, None).low, positive=True)
BELOW_0 = Domain.between(-2, -1)
SLIP = {"u": Variable("sigma", observable=True), "u_in": Variable("sigma")}
QUADRATIC = "k/2*(u - u_in)**2"
PRAGER = "norm(sigma + Y) - R"
ALONG = "(sigma + Y)/norm(sigma + Y)"


def law(g: str, energy: str, *, flow: Any = None, variables: Any = None, rates: Any = None, **parameters: Domain) -> Criterion:
    """In sigma and Y, whose variables are the slip and alpha."""
    state = SLIP | ({"alpha": Variable("Y")} if variables is None else variables)
    domains, rates = {"R": ABOVE_0, "k": ABOVE_0, **parameters}, rates or {}
    return Criterion("made", g, domains, ("sigma", "Y"), None, flow=flow, energy=energy, variables=state, rates=rates)


def kinematic(**parameters: Domain) -> Criterion:
    return law(PRAGER, f"{QUADRATIC} + C/2*alpha**2", **{"C": ABOVE_0, **parameters})


def armstrong_frederick(rates: Any = None, **parameters: Domain) -> Criterion:
    domains = {"C": ABOVE_0, "gamma": AT_LEAST_0, **parameters}
    return law(PRAGER, f"{QUADRATIC} + C/2*alpha**2", flow=(ALONG, f"{ALONG} - gamma*alpha"), rates=rates, **domains)


def isotropic(hardening: Domain) -> Criterion:
    variables = SLIP | {"alpha": Variable("A", domain=AT_LEAST_0)}
    energy = f"{QUADRATIC} + H/2*alpha**2"
    parameters = {"mu": ABOVE_0, "H": hardening, "k": ABOVE_0}
    return Criterion("isotropic", "abs(sigma) + A - mu*abs(sigma_n)", parameters, ("sigma", "A"), energy=energy, variables=variables)


def viscous(potential: str, forces: tuple[str, ...] = ("a", "b"), **parameters: Domain) -> Criterion:
    return Criterion("viscous", potential, {**dict.fromkeys(("A", "R"), ABOVE_0), **parameters}, forces, None, viscous=True)


def refused(given: Criterion, claim: str, rule: str, evidence: Any = None, settled: Any = (), **changed: Any) -> str:
    """The kernel's objection to a rule for a law with other texts, "" if it has none."""
    stated = StatedLaw.read(law_as_text(given) | changed)
    with within(20_000_000):
        return objection(claim, rule, frozenset(settled), stated, evidence or {})


SHARE = {"share": "1", "rest": "R + gamma*C*alpha**2"}
RECOVERY = "c/C*abs(Y)**(m - 1)*Y"
RECOVERS = {"c": ABOVE_0, "m": Domain.between(1, None)}


def misread(file: str, before: str, after: str) -> str:
    """What is said of a file with another text in one place."""
    assert before in file
    with pytest.raises(InputError) as fault:
        reads(file.replace(before, after))
    return str(fault.value)


def violated(given: Criterion, claim: str, witness: Any) -> None:
    """The state of a witness, put in by hand with SymPy alone: the energy sags, or the power of flow or rates is negative there."""
    table = given.symbols()

    def at(point: dict[str, str]) -> dict[Any, Any]:
        return {table.get(x, sp.Symbol(x)): sp.Rational(v) for x, v in {**witness.parameters, **point}.items()}

    if claim == "state_laws":
        p, q, middle = (witness.points[role] for role in ("p", "q", "midpoint"))
        heights = [given.energy.subs(at({x: v for x, v in point.items() if x in table})) for point in (p, q, middle)]
        assert all(Fraction(middle[x]) == (Fraction(p[x]) + Fraction(q[x])) / 2 for x in middle)
        assert 2 * heights[2] > heights[0] + heights[1]
        return
    forces = {own.force: -given.energy.diff(table[x]) for x, own in given.variables.items() if own.internal}
    here = at(next(iter(witness.points.values())))
    for force, own in forces.items():
        here.setdefault(table[force], own.subs(here))
    flow = {f: d for f, d in zip(given.forces, given.flow, strict=True)}
    rates = {given.variables[x].force: r for x, r in given.rates.items()}
    powers = [sum(here[table[f]] * x.subs(here) for f, x in each.items()) for each in (flow, rates) if each]
    assert any(power.doit() < 0 for power in powers)


FILE = """\
[criterion]
name = "hardening"
forces = ["sigma", "X"]
pressure = false
g = "norm(sigma + X) - R"

[parameters]
R = { positive = true }
C = { positive = true }
gamma = { min = 0 }
k = { positive = true }

[energy]
psi = "k/2*(u - u_in)**2 + C/2*alpha**2"

[variables]
u = { observable = true, force = "sigma" }
w = {}
alpha = { force = "X", min = -1, max = 1 }
u_in = { force = "sigma" }

[flow]
direction = ["1", "(sigma + X)/norm(sigma + X) - gamma*alpha", "(sigma + X)/norm(sigma + X)"]

[dissipation]
rates = { alpha = "X/C" }
"""

ONE = """\
[criterion]
name = "one"
forces = ["sigma"]
pressure = false
g = "abs(sigma) - R"
[parameters]
R = { positive = true }
k = { positive = true }
C = { positive = true }
[energy]
psi = "k/2*(u - u_in)**2 + (0)"
[variables]
u = { observable = true, force = "sigma" }
u_in = { force = "sigma" }
"""
