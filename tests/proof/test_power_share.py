"""Flows of the law's own on cones: the power is a multiple of g and something >= 0; at the apex the flow has limits and no value."""

from __future__ import annotations

import re

import pytest

from duhem import Criterion, Domain, verify
from duhem.proof.certificate import law_as_text
from duhem.proof.kernel.certificate import stated
from duhem.proof.kernel.claims import objection
from duhem.proof.verdict import Trust, Verdict
from tests.long import long_but, mostly_slow
from tests.oracles.prover import power_share
from tests.oracles.prover.decide import AskedSubject

J2 = "((a-b)**2 + (b-c)**2 + (c-a)**2)/6"
R = "sqrt(a**2 + b**2)"
POSITIVE, between, fixed = Domain(positive=True), Domain.between, Domain.fixed


def dilatant(*constraints: str, alpha: Domain, beta: Domain, k: Domain = POSITIVE) -> Criterion:
    """Drucker and Prager's cone with the flow of a flatter one."""
    flow = tuple(f"(2*{x}-{y}-{z})/(6*sqrt({J2})) + beta" for x, y, z in ("abc", "bca", "cab"))
    parameters = {"alpha": alpha, "beta": beta, "k": k}
    return Criterion("law", f"sqrt({J2}) + alpha*(a+b+c) - k", parameters, ("a", "b", "c"), None, constraints=constraints, flow=flow)


def cone(g: str, *flow: str, k: Domain = POSITIVE) -> Criterion:
    g, *flow = (re.sub(r"\br\b", R, text) for text in (g, *flow))
    return Criterion("law", g, {"k": k}, ("a", "b", "c"), None, flow=tuple(flow))


SHOWN = [
    dilatant(alpha=fixed("0.2"), beta=fixed("0.05")),
    dilatant(alpha=fixed("0.2"), beta=fixed("0.2")),
    dilatant("beta <= alpha", alpha=between("1/10", 1), beta=between(0, 1)),
    cone("r + c - k", "a/r", "b/r", "1/2"),
    cone("r + c - k", "2*a/r", "2*b/r", "1"),  # of another length
    cone("r + c - k", "a/r", "b/r", "1/2", k=between(0, 1)),
]
NOT_SHOWN = [
    dilatant(alpha=fixed("0.2"), beta=fixed("0.25")),
    dilatant(alpha=fixed("0.2"), beta=fixed("0.05"), k=between(-1, 1)),
    dilatant(alpha=between("1/10", 1), beta=between(0, 1)),
    dilatant(alpha=fixed("0.2"), beta=fixed("-0.01")),
    cone("r + c - k", "-a/r", "-b/r", "-1/2"),
    cone("r + c - k", "a/r", "b/r", "1/2 + 0/a"),  # undefined where the cone is smooth
    cone("r**2 + c**2 - k", "a/r", "b/r", "c"),  # undefined at the poles of a ball
    cone("norm(pos(a), b) + c - k", "a/norm(pos(a), b)", "b/norm(pos(a), b)", "1/2"),
    cone("max(r + c - k, r + 2*c - k)", "a/r", "b/r", "1/2"),
]


def confirmed(law: Criterion, share: str, rest: str) -> bool:
    return not objection("dissipation", "power-share", frozenset(), stated(law_as_text(law)), {"share": share, "rest": rest})


@pytest.mark.parametrize("law", long_but([1, 3, 4], mostly_slow(SHOWN, SHOWN[0])))
def test_the_power_is_a_share_of_g_and_something_more(law: Criterion) -> None:
    found = power_share.dissipation(AskedSubject(law))
    assert found is not None and found.proof is not None
    assert not objection("dissipation", "power-share", frozenset(), stated(law_as_text(law)), found.proof.evidence)


@pytest.mark.slow
@pytest.mark.parametrize("law", long_but([1, 3, 5, 6, 8], NOT_SHOWN))
def test_what_only_looks_so(law: Criterion) -> None:
    assert power_share.dissipation(AskedSubject(law)) is None


@pytest.mark.slow
def test_the_kernel_asks_for_itself() -> None:
    law, rest = SHOWN[0], f"3/4*sqrt({J2}) + k/4"
    assert confirmed(law, "1/4", rest)
    for share, other in (("1/3", rest), ("1/4", rest + " + k"), ("0", f"sqrt({J2}) + (a+b+c)/20"), ("a/a/4", rest), ("1/4 + 0*a", rest)):
        assert not confirmed(law, share, other)
    assert confirmed(dilatant(alpha=fixed("0.2"), beta=fixed("0.2")), "1", "k")
    assert not confirmed(dilatant(alpha=fixed("0.2"), beta=fixed("0.2"), k=between(-1, 1)), "1", "k")
    rests = [re.sub(r"\br\b", R, rest) for rest in ("r/2 + k/2", "r + c**2", "r")]
    for other in NOT_SHOWN[5:]:
        assert not any(confirmed(other, share, rest) for share in ("0", "1/2") for rest in rests)


@pytest.mark.slow
def test_the_apex_is_no_obstacle_and_the_verdict_is_checked() -> None:
    found = verify(SHOWN[0], claims=["dissipation", "normality"])
    assert (found["dissipation"].verdict, found["dissipation"].trust) == (Verdict.PROVED, Trust.CHECKED)
    assert found["normality"].verdict is Verdict.REFUTED
    assert "For such a flow, duhem reports only proofs that the kernel confirms" in found.remarks[0]
    assert verify(NOT_SHOWN[0], claims=["dissipation"])["dissipation"].verdict is Verdict.REFUTED
