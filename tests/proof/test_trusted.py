"""How much of the kernel a proof rests on: the campaign that counts it, and that it stays below 3,000 lines of code, but for one law."""

from __future__ import annotations

import pytest

from duhem import load, verify
from tests.campaigns.trusted import trusted

MOST = {"antoni2007": 3_000, "willam-warnke-tensor": 3_400}  # its convexity rests on 3,374: rules of the deviator and of the plane, too


@pytest.mark.slow
@pytest.mark.parametrize("name", ["antoni2007", pytest.param("willam-warnke-tensor", marks=pytest.mark.long)])
def test_a_proof_rests_on_a_part_of_the_kernel(name: str) -> None:
    found = {proof.claim: proof for proof in trusted(name, verify(load(name)).certificate())}
    assert {"origin", "convexity", "dissipation", "state_laws"} <= set(found)
    assert all(100 < proof.lines <= MOST[name] for proof in found.values())
    assert found["state_laws"].lines < min(found["origin"].lines, found["convexity"].lines)  # which read the formula
