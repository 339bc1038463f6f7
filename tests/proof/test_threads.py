"""Verdicts do not depend on who else is computing: eight threads at once say what one says alone."""

from __future__ import annotations

from concurrent.futures import ThreadPoolExecutor

import pytest

import duhem
from tests.campaigns.determinism import in_processes
from tests.long import mostly_long

LAWS = ("antoni2007", "coulomb", "orthotropic", "box", "shifted-ellipse")


def verdicts(name: str) -> tuple[tuple[str, str, str], ...]:
    return tuple((r.claim, str(r.verdict), r.method) for r in duhem.verify(name).results)


@pytest.mark.slow
@pytest.mark.parametrize("count", mostly_long([2, len(LAWS)], 2))
def test_threads_say_what_one_says_alone(count: int) -> None:
    laws = LAWS[:count]
    alone = {name: verdicts(name) for name in laws}
    with ThreadPoolExecutor(8) as pool:
        together = list(pool.map(verdicts, laws * 4))
    assert together == [alone[name] for name in laws * 4]


@pytest.mark.slow
def test_processes_with_other_hashes_say_the_same() -> None:
    one, two = in_processes(("1", "7"), ("coulomb",))
    assert one == two and set(one) == {"coulomb"}
