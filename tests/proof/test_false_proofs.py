"""Laws built to deceive (tests/campaigns/false_proofs): none is answered against its truth, none is confirmed by the kernel.

A fixed part of what ``python -m tests.campaigns.false_proofs`` goes through.
"""

from __future__ import annotations

import tomllib
from collections import Counter
from itertools import islice

import pytest

from duhem import InputError
from tests.campaigns.false_proofs.judge import judge, kernel_confirms
from tests.campaigns.false_proofs.table import FAMILIES, traps
from tests.long import mostly_long

BY_THE_KERNEL = 24
VERIFIED = 9


@pytest.mark.slow
@pytest.mark.parametrize("first, last", mostly_long([(6, 12), (0, BY_THE_KERNEL)], (6, 12)))  # of the first six one takes nine seconds
def test_the_kernel_confirms_nothing_false(first: int, last: int) -> None:
    shown: Counter[str] = Counter()
    for family, trap in islice(traps(last), first, None):
        try:
            confirmed = kernel_confirms(trap.law())
        except InputError:
            assert trap.refused or trap.refusable, trap.toml()
            continue
        false = [claim for claim in confirmed if claim != "state_laws" and (trap.refused or trap.truth.get(claim) is False)]
        assert not false, f"{false} of\n{trap.toml()}"
        shown[family] += sum(trap.truth.get(claim, False) for claim in confirmed)
    assert set(shown) == set(FAMILIES)  # it is not silent about what is true


@pytest.mark.slow
@pytest.mark.parametrize("place", mostly_long(range(VERIFIED), 0, 1, 3, 4))
def test_no_verdict_is_wrong(place: int) -> None:
    *_, (_, trap) = traps(place + 1, seed=3)
    answered = judge(trap)
    assert not answered.wrong, trap.toml()


def test_each_family_has_claims_of_both_kinds() -> None:
    kinds = {(family, true) for family, trap in traps(120) for true in [*trap.truth.values(), *([False] if trap.refused else [])]}
    assert kinds == {(family, true) for family in FAMILIES for true in (True, False)}


def test_the_laws_repeat_themselves_and_are_files() -> None:
    one, two = ([trap.toml() for _, trap in traps(60)] for _ in range(2))
    assert one == two and len(set(one)) == len(one)
    assert all(set(tomllib.loads(text)) <= {"criterion", "parameters", "flow"} for text in one)
