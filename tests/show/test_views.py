"""Every result of the public calls shows itself: one short line, HTML and Markdown that escape what a user wrote, values that are plain."""

from __future__ import annotations

import json
from collections.abc import Callable
from functools import cache
from typing import Any

import numpy as np
import pytest

import duhem
from duhem.show.printing import Shown
from duhem.testing.conformance import conformance
from duhem.testing.snapshots import Differences, differences
from tests.show.test_sheets import HOSTILE, LAW, Read

CURVE = duhem.ParametricCriterion(HOSTILE, ("mu*cos(phi)", "sin(phi)/3"), {"mu": duhem.Domain.between("1/2", 1)})
DENTED = duhem.Criterion(HOSTILE, "abs(sigma_a*sigma_b) - 1 + sigma_n", summary=HOSTILE, source=HOSTILE)
CLAIMS = ("origin", "convexity")
LONGEST = 200  # characters of a line that a console shows


@cache
def verified() -> Any:
    return duhem.verify(DENTED, claims=CLAIMS)


def path() -> Any:
    return duhem.Path.linear(np.outer(np.arange(3), [3.0, 4.0]), pressure=-1.0)


def changed() -> Any:
    entry: dict[str, Any] = {"law": {"name": "one"}, "claims": {}, "increments": []}
    return differences(entry, entry | {"law": {"name": HOSTILE}})


def identified() -> Any:
    angle = np.linspace(0.0, 2.0 * np.pi, 12, endpoint=False)
    return duhem.identify(np.column_stack([0.5 * np.cos(angle), 0.5 * np.sin(angle), -np.ones(12)]), "coulomb")


RESULTS: dict[str, Callable[[], Any]] = {
    "Criterion": lambda: LAW,
    "ParametricCriterion": lambda: CURVE,
    "Atlas": duhem.atlas,
    "AtlasEntry": lambda: duhem.atlas()["hill90"],
    "Verification": verified,
    "ClaimResult": lambda: verified()["convexity"],
    "Witness": lambda: verified()["convexity"].witness,
    "Recheck": lambda: duhem.recheck(verified().certificate()),
    "Derivation": lambda: duhem.derive(LAW),
    "Equation": lambda: duhem.derive(LAW)["state_law"],
    "Projection": lambda: duhem.project("coulomb", [[0.1, 0.0], [3.0, 4.0]], -1.0, 2.0, {"mu": 0.5}),
    "History": lambda: duhem.simulate("coulomb", path(), stiffness=1.0, parameters={"mu": 0.5}),
    "Histories": lambda: duhem.simulate(
        "coulomb", duhem.Paths.linear(np.zeros((2, 2, 2)) + 0.1, pressure=-np.ones((2, 2))), stiffness=1.0, parameters={"mu": 0.5}
    ),
    "Identification": identified,
    "Summary": lambda: duhem.campaign([(DENTED, {})], CLAIMS, workers=1),
    "Report": lambda: conformance("coulomb", lambda t, n, k, p: t, checks=["feasibility"], max_examples=3),
    "Differences": changed,
}
COLUMNS = ("History", "Histories")  # to_dict() is the columns of a table, as pandas takes them


@cache
def made(name: str) -> Any:
    return RESULTS[name]()


@pytest.fixture(params=RESULTS)
def result(request: pytest.FixtureRequest) -> Any:
    found = made(request.param)
    assert type(found).__name__ == request.param and isinstance(found, Shown)
    return found


@pytest.mark.slow
def test_a_result_shows_itself(result: Any) -> None:
    line = repr(result)
    assert line.startswith("<") and line.endswith(">") and "\n" not in line and len(line) <= LONGEST
    for page in (result.to_html(), result._repr_html_()):
        assert Read(page).said.strip() and "$x" not in Read(page).typeset  # which holds that tags close and carry nothing
    markdown = result._repr_markdown_()
    assert markdown.strip() and "<script" not in markdown and "$x$" not in markdown
    assert result.to_text().strip()
    plain = result.to_dict()
    if type(result).__name__ in COLUMNS:
        assert {(column.dtype.kind, column.ndim, len(column)) for column in plain.values()} == {("f", 1, len(plain["time"]))}
    else:
        assert plain and json.loads(json.dumps(plain, allow_nan=False)) == plain


@pytest.mark.slow
def test_what_a_user_wrote_is_shown_as_it_is() -> None:
    for name in ("Criterion", "Verification", "Derivation", "Differences"):
        assert HOSTILE in Read(made(name).to_html()).said, name
    said = Read(made("Summary").to_html()).said
    assert "<script>" in said and "claims=['origin', 'convexity'])" in said  # a call as it is pasted, of blanks that are blanks


@pytest.mark.slow
def test_laws_and_derivations_are_formulas() -> None:
    for shown in (LAW, CURVE):
        assert shown._repr_latex_().startswith(r"$\displaystyle ")
    derived = duhem.derive("coulomb")
    assert derived._repr_latex_().count("$$") == 2 * len(derived) == 2 * len(derived.to_dict()["equations"])
    assert derived["state_law"]._repr_latex_().endswith(r"\tag{25}\end{equation*}")
    assert derived["state_law"].to_dict()["formula"] == "sigma_a = k_a*(u_a - uin_a); sigma_b = k_b*(u_b - uin_b)"
    for read in (Read(derived._repr_html_()).said, Read(derived.to_html()).said):
        assert all(f"({e.number}) {e.name}: {e.note}" in read for e in derived)


def test_numbers_stand_beside_exact_texts() -> None:
    law = duhem.Criterion("n", "norm(sigma_a, sigma_b) + mu*sigma_n - c", {"mu": duhem.Domain.fixed("3/5"), "c": duhem.POSITIVE})
    assert law.to_dict()["domains"] == {
        "mu": {"min": 0.6, "max": 0.6, "value": 0.6, "positive": False},
        "c": {"min": 0.0, "max": None, "value": None, "positive": True},
    }
    huge = duhem.Domain.fixed("1e400")
    assert (huge.numbers()["value"], huge.plain()) == (None, "1" + 400 * "0")
    found = duhem.verify("limacon", {"e": "3/5"}, claims="convexity")
    assert found.to_dict()["domains"]["e"]["value"] == 0.6 and found.to_dict()["parameters"]["e"] == "3/5"
    (claim,) = found.to_dict()["claims"]
    exact, numbers = claim["witness"]["points"], claim["witness_numbers"]["points"]
    assert numbers["p"].keys() == exact["p"].keys()
    for role, point in exact.items():
        for name, text in point.items():
            over, _, under = text.partition("/")
            assert numbers[role][name] == int(over) / int(under or 1)


def test_an_increment_is_a_table_of_points() -> None:
    done = made("Projection")
    table = done.to_columns()
    assert list(table) == ["status", "sigma_a", "sigma_b", "slip_a", "slip_b", "multiplier", "dissipation", "residual"]
    assert {len(column) for column in table.values()} == {2} and table["status"] == ["stick", "slip"]
    assert table["slip_b"].tolist() == done.slip[:, 1].tolist() and table["sigma_a"].tolist() == done.stress[:, 0].tolist()


def test_nothing_changed_is_false_and_says_so() -> None:
    assert not Differences() and Differences().to_text() == "as kept" and Differences() == ()
