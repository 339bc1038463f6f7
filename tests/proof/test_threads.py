"""Verdicts do not depend on who else is computing: eight threads at once say what one says alone."""

from __future__ import annotations

from concurrent.futures import ThreadPoolExecutor

import pytest

import duhem

LAWS = ("antoni2007", "coulomb", "orthotropic", "box", "shifted-ellipse")


def verdicts(name: str) -> tuple[tuple[str, str, str], ...]:
    return tuple((r.claim, str(r.verdict), r.method) for r in duhem.verify(name).results)


@pytest.mark.slow
def test_threads_say_what_one_says_alone() -> None:
    alone = {name: verdicts(name) for name in LAWS}
    with ThreadPoolExecutor(8) as pool:
        together = list(pool.map(verdicts, LAWS * 3))
    assert together == [alone[name] for name in LAWS * 3]
