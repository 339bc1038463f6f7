"""What is wrong only in small or in large states, or only beside an end of a range, is refuted with such a state."""

from __future__ import annotations

from fractions import Fraction
from typing import Any

import pytest

from duhem import POSITIVE, Criterion, Domain, Verdict
from duhem.law.state import Variable
from duhem.proof.verification import verify


def made(energy: str, domain: Domain | None = None, temperature: bool = False, **given: Any) -> Criterion:
    variables = {"u": Variable("sigma", observable=True), "u_in": Variable("sigma"), "alpha": Variable("A", domain=domain or Domain())}
    if temperature:
        variables["T"] = Variable(temperature=True, domain=POSITIVE)
    parameters = {"R": POSITIVE, "k": POSITIVE, **given.pop("parameters", {})}
    return Criterion(
        "made", "abs(sigma) + A - R", parameters, ("sigma", "A"), None, energy=f"k/2*(u - u_in)**2 + {energy}", variables=variables, **given
    )


SMALL = Domain.between(Fraction(1, 10**7), Fraction(1, 10**6))
RATES = {"rates": {"alpha": "A*(1 - A**2/10**6)"}}
WRONG = {
    "a small dent of psi": ("state_laws", made("alpha**4 - alpha**2*e", parameters={"e": SMALL})),
    "a dent at the end of a range": ("state_laws", made("alpha**3", Domain.between(Fraction(-1, 1000), None))),
    "a rate that turns at a large force": ("dissipation", made("alpha**2/2", **RATES)),
    "a rate that is wrong near rest": ("dissipation", made("alpha**2/2", rates={"alpha": "A + 1/1000"})),
    "a conductance that is negative when it is hot": ("thermal", made("alpha**2/2 - T**2", temperature=True, heat={"B": "1 - B/1000"})),
}  # fmt: skip
RIGHT = {
    "no dent": ("state_laws", made("alpha**4 + alpha**2*e", parameters={"e": Domain.between(0, Fraction(1, 10**6))})),
    "a rate that never turns": ("dissipation", made("alpha**2/2", rates={"alpha": "A*(1 - A**2/10**6 + A**4)"})),
}


@pytest.mark.parametrize("name", WRONG)
def test_a_state_of_another_size_refutes(name: str) -> None:
    claim, law = WRONG[name]
    found = verify(law, claims=[claim])[claim]
    assert found.verdict is Verdict.REFUTED and found.witness is not None


@pytest.mark.parametrize("name", RIGHT)
def test_what_is_right_in_all_states_is_proved(name: str) -> None:
    claim, law = RIGHT[name]
    assert verify(law, claims=[claim])[claim].verdict is Verdict.PROVED
