"""Every built-in law on some of its extreme cases, against the reference; the whole is tests/campaigns/extremes.py."""

from __future__ import annotations

from pathlib import Path

import pytest

import duhem
from duhem.benchmark.contenders import Contender
from duhem.benchmark.extreme_cases import stress
from duhem.law import builtin
from duhem.law.formula_law import Criterion
from duhem.projection.methods import METHODS
from tests.campaigns.extremes import CONVEX, law, lines
from tests.long import long_but


def test_no_law_is_forgotten() -> None:
    """All but curves and laws with a flow of their own, whose increment is no closest point."""
    every = {name: duhem.load(name) for name in (file.stem.replace("_", "-") for file in Path(builtin.__path__[0]).glob("[!_]*.*"))}
    assert {name for name, found in every.items() if isinstance(found, Criterion) and found.associated} == set(CONVEX)


@pytest.mark.slow
@pytest.mark.parametrize("name", long_but([1, 4, 16], CONVEX))
def test_nothing_is_silently_wrong(name: str) -> None:
    chosen = [Contender.of(method, method) for method in METHODS if method != "cvxpy"]
    question = law(name)
    found = [c for c in chosen if c.method.name == "newton" or question.closed_form is not None]
    result = stress(question, axes=("boundary distance", "trial size"), contenders=found, every=13)
    assert {row.label for row in result.rows} == {"1e0", "1e-13", "1e16"} and result.reference <= 1e-40
    assert [row.failure for row in result.rows if row.failure] == []
    assert {method: wrong[0] for method, wrong in result.silently_wrong.items()} == {c.name: 0 for c in found}
    assert all(refusal.held for refusal in result.refusals)
    assert len(lines(result)) >= len(found)
