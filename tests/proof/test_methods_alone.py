"""Refuters mask provers: where a claim is refuted first, what a method of proof would have said is never heard.  Here it is.

Every method that may prove a claim is asked by itself about laws of which it is false: the adversary's, and a part of the traps
(all of them, with more effort: ``python -m tests.campaigns.false_proofs --alone``).
"""

from __future__ import annotations

import pytest

from duhem.proof.claims import CLAIMS
from tests.campaigns.false_proofs.alone import false_proofs_alone, proofs_alone, provers
from tests.campaigns.false_proofs.table import traps
from tests.long import long_but, mostly_long
from tests.proof.test_adversary import CLAIMS as LETTERS
from tests.proof.test_adversary import DEAR, ROWS, Row

FALSE = [(row, letter) for row in ROWS for letter in row.false]
NAMED = [f"{row.name}-{LETTERS[letter]}" for row, letter in FALSE]


@pytest.mark.slow
@pytest.mark.parametrize(
    ("row", "letter"),
    mostly_long(FALSE, *(asked for asked in FALSE if asked[0].name not in DEAR)),
    ids=NAMED,
)
def test_no_method_proves_what_is_false_of_the_adversary_s_laws(row: Row, letter: str) -> None:
    truth = {LETTERS[c]: c in row.true for c in row.true + row.false}
    assert list(proofs_alone(row.law(), LETTERS[letter], truth, "quick")) == []


@pytest.mark.slow
@pytest.mark.parametrize("place", long_but([0, 2, 4, 6], range(8)))
def test_no_method_proves_what_is_false_of_a_trap(place: int) -> None:
    *_, (_, trap) = traps(place + 1, seed=4)
    assert false_proofs_alone(trap, "quick") == {}, trap.toml()


def test_the_methods_that_prove_are_asked() -> None:
    """Not so few that the rest says nothing, and no refuter."""
    asked = {claim: [m.run.__module__.rpartition(".")[2] for m in provers(claim)] for claim in CLAIMS}
    assert {"composition", "polyhedral", "polar", "boundary"} <= set(asked["convexity"])
    assert {"composition", "polar", "on_boundary"} <= set(asked["smoothness"])
    assert {"degrees", "power_share", "polar", "on_boundary"} <= set(asked["dissipation"])
    assert asked["duality"] == ["evidence"] and "evaluation" in asked["origin"] and asked["normality"]
    assert "refuters" not in {name for names in asked.values() for name in names}
