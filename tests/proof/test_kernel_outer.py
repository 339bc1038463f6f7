"""What is done to a formula in the end is undone where it keeps the sign, and only there."""

from __future__ import annotations

from typing import Any

import pytest

from duhem.proof.kernel.claims import objection
from duhem.proof.kernel.simpler_laws import without_outer_map
from duhem.proof.kernel.stated_law import StatedLaw
from duhem.proof.kernel.term import parse

DISC = "(norm(a, b) - 1)"


def law(g: str) -> StatedLaw:
    parameters = {"k": {"positive": True}, "q": {"min": "-1", "max": "1"}}
    given: dict[str, Any] = {"forces": ("a", "b"), "pressure": "s", "parameters": parameters, "constraints": [], "g": g, "flow": None}
    return StatedLaw.read(given)


@pytest.mark.slow
@pytest.mark.parametrize(
    "form",
    [
        "2*F", "max(F, 2*F)", "F**3", "F**5 + F", "F*exp(F)", "tanh(F)", "F/(1 + abs(F))", "F*(1 + F**2)", "where(F > 0, 2*F, F)",
        "where(F >= 0, F**3, F)", "F*abs(F)", "F/sqrt(1 + F**2)", "pos(F) - 2*neg(F)", "sqrt(pos(F)) - neg(F)**2", "F*(1 + a**2)",
        "k*F + k*F**3", "F*exp(b)", "atan(F)**3", "-s*F", "F*norm(a, s)", "(F*exp(a))**3",
    ],
)  # fmt: skip
def test_what_keeps_the_sign_is_undone(form: str) -> None:
    found = without_outer_map(law(form.replace("F", DISC)))
    assert found.g == parse(DISC)
    assert not objection("smoothness", "composition", frozenset(), law(form.replace("F", DISC)), {})


@pytest.mark.parametrize(
    "form",
    [
        "abs(F)", "F**2", "-F", "F - 1/10**9", "F**3 - F", "exp(F)", "F*(a - 1)", "F*(1 + q)", "q*F", "k*F + b", "F*norm(a, b)", "1/F",
        "F*(1/2 + sin(F))", "where(F >= 0, F + 1, F)", "where(F > 0, F, F - 1)", "where(F >= 0, F, 1)", "max(F, 0)", "pos(F)", "F*sqrt(F)",
        "F*log(a)", "F/a", "F**3/F**2", "s*F", "F + s", "max(F, a)", "F*exp(F)/(1 - F)", "F*where(a > 0, 1, 2)", "min(F, 1/10**9)*F",
        "tan(F)", "F*F*F*F", "F - F",
    ],
)  # fmt: skip
def test_what_does_not_keep_it_is_left(form: str) -> None:
    assert without_outer_map(law(form.replace("F", DISC))).g != parse(DISC)
