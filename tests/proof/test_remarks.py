"""What is said beside the verdicts: of sets of known kind, of the laws that were once told untruths about, and every text has a row."""

from __future__ import annotations

import ast
import re
from collections.abc import Iterator
from importlib import import_module
from inspect import getsource
from typing import Any

import pytest

from duhem import POSITIVE, Criterion, Domain, Verdict, verify
from tests.campaigns.remarks import ROWS, drawn, faults
from tests.long import long_but, mostly_long

TELLING = ("duhem.proof.remarks", "duhem.proof.facts.special_places")
INSIDE = "; that point is inside K, so the boundary is not touched"


def remarks(g: str, forces: tuple[str, ...] = ("a", "b"), claims: tuple[str, ...] = ("origin",), **more: Any) -> tuple[str, ...]:
    pressure = "n" if re.search(r"\bn\b", g) else None
    return verify(Criterion("law", g, forces=forces, pressure=pressure, **more), claims=claims).remarks


def texts(source: str) -> Iterator[str]:
    """The longest literal part of what a module yields as a sentence, or names as an extent."""
    for node in ast.walk(ast.parse(source)):
        if isinstance(node, ast.Call) and getattr(node.func, "id", "") == "Extent":
            told: ast.AST | None = node.args[0]
        elif isinstance(node, ast.Yield) and isinstance(node.value, ast.Constant | ast.JoinedStr | ast.BinOp):
            told = node.value
        else:
            continue
        parts = [part.value for part in ast.walk(told or ast.Pass()) if isinstance(part, ast.Constant) and isinstance(part.value, str)]
        if parts and " " in (longest := max(parts, key=len)).strip():
            yield longest.strip()


def without_row(source: str) -> list[str]:
    rows = [re.sub(r"\\(.)", r"\1", text) for text, _ in ROWS]
    return [text for text in texts(source) if not any(text.rstrip("., ") in row for row in rows)]


def test_every_sentence_that_can_be_printed_has_a_row_in_the_campaign() -> None:
    found = {name: getsource(import_module(name)) for name in TELLING}
    assert sum(len(list(texts(source))) for source in found.values()) >= 12
    assert {name: without_row(source) for name, source in found.items()} == {name: [] for name in TELLING}
    assert without_row('def f():\n    yield f"K is a torus of {n} holes"') and without_row('Extent("K is a torus", True)')


@pytest.mark.slow
@pytest.mark.parametrize("count", mostly_long([8, 24], 8))
def test_nothing_untrue_is_said_of_sets_of_known_kind(count: int) -> None:
    found, said = dict[str, list[str]](), 0
    for case in drawn(count, seed=9):
        verified = verify(case.law, claims=["origin"])
        said += len(verified.remarks)
        if wrong := faults(case, verified.remarks, verified.vacuous):
            found[f"{case.kind}: {case.law.g}"] = wrong
    assert found == {} and said > count * 0.4


@pytest.mark.long
def test_the_campaign_knows_an_untruth() -> None:
    """Each sentence is untrue of some of the sets."""
    sentences = (
        "K is empty: g > 0 for all forces",
        "K contains all forces: g <= 0 everywhere",
        "K is the point 0: g > 0 elsewhere",
        "K is a line without interior points: g > 0 elsewhere",
        "K is a space of 4 dimensions without interior points: g > 0 elsewhere",
        "K has no interior points: g >= 0 for all forces, and g = 0 in K",
        "K is unbounded: g does not change along 4 directions of the forces",
        "K is unbounded: g does not change along -3 direction of the forces",
        "K is unbounded: g <= 0 at x1 = t, x2 = t for all t > 0",
        "g is not differentiable at x1 = 17, x2 = 19",
        "g does not depend on x2",
        "g has no value at zero force: it divides by x1, which is 0 there; duhem uses the limit of g there, and K is closed",
    )
    discs = [
        case
        for case in drawn(200, seed=3)
        if case.kind in ("inside", "ramp", "greater", "two") and case.law.forces == ("x1", "x2") and case.flat == 0
    ]
    assert discs
    for sentence in sentences:
        assert any(faults(case, [sentence], False) for case in discs), sentence
    assert all(faults(case, [], True) for case in discs)


STRESS = {"stress": {"name": "s", "kind": "3d"}, "forces": ("sigma_a", "sigma_b"), "parameters": {"c": POSITIVE}}
CONE = {"define": {"p": "I1(s)/3", "q": "sqrt(3*J2(s))"}, "parameters": {"c": POSITIVE, "d": Domain.between(0, 1)}}


@pytest.mark.parametrize("potential", [None, "J2(s)", "I1(s)**2 + J2(s)"])
@pytest.mark.parametrize(
    ("g", "said"),
    [
        ("J2(s) + I1(s)**2 - c", ""),
        ("J2(s) - c", "K is unbounded: g does not change along 1 direction of the forces"),
        ("I1(s) - c", "K is unbounded: g does not change along 5 directions of the forces"),
        ("J2(s) + 0*c", "K is a line without interior points: g > 0 elsewhere"),
        ("I1(s)**2 + 0*c", "K is a space of 5 dimensions without interior points: g > 0 elsewhere"),
        ("J2(s) + I1(s)**2 + 0*c", "K is the point 0: g > 0 elsewhere"),
        ("J2(s) + I1(s)**2 + c", "K is empty: g > 0 for all forces"),
    ],
)
def test_the_flow_changes_nothing_about_the_set(g: str, said: str, potential: str | None) -> None:
    found = [remark for remark in remarks(g, potential=potential, **STRESS) if remark.startswith("K ")]  # type: ignore[arg-type]
    assert found == ([said] if said else [])


def test_the_cone_of_the_guide_is_unbounded_along_the_pressure_alone() -> None:
    ray = "s_xx = -t, s_yy = -t, s_zz = -t, s_yz = 0, s_xz = 0, s_xy = 0"
    apex = "s_xx = s_zz, s_yy = s_zz, s_yz = 0, s_xz = 0, s_xy = 0"
    for potential in (None, "q + d/2*p"):
        found = remarks("q + d*p - c", potential=potential, **{**STRESS, **CONE})  # type: ignore[arg-type]
        assert [r for r in found if "could not show" not in r] == [
            f"K is unbounded: g <= 0 at {ray} for all t > 0",
            f"g is not differentiable at {apex}",
        ]


@pytest.mark.parametrize(
    ("g", "said"),
    long_but(
        [2, 3, 7, 11, 13],
        [
            ("pos(norm(a, b) - abs(n))", []),
            ("max(0, norm(a, b) - abs(n))", []),
            ("(a - 1)**2 + b**2", ["K has no interior points: g >= 0 for all forces, and g = 0 in K"]),
            ("sqrt((a**2 - 1)**2) + a**2 - 1 + 0*b", ["g does not depend on b"]),  # 0 for |a| <= 1
            ("sqrt(a**4 - 2*a**2 + 1) + a**2 - 1 + abs(b)*0", ["g does not depend on b"]),
            ("sqrt(a**2 + b**2 + 1) - 2", []),
            ("(a**2 + b**2)**(3/4) - abs(n)**(3/2)", []),
            ("norm(a, b) - 1", [f"g is not differentiable at zero force{INSIDE}"]),
            ("norm(a, b) - abs(n)", [f"g is not differentiable at zero force{INSIDE.replace('K,', 'K for n < 0,')}"]),
            ("norm(a - 1, b) + norm(a, b) - 1", ["g is not differentiable at a = 1, b = 0", "g is not differentiable at zero force"]),
            ("norm(a - 2, b) + norm(a, b)/2 - 1", ["g is not differentiable at a = 2, b = 0"]),
            ("norm(a, b)**2 + norm(a, b)**3 - 1", []),
            ("abs(a - m*b) - 1 + 0*norm(a, b)", []),
            ("b**2", ["K is a line without interior points: g > 0 elsewhere", "g does not depend on a"]),
            (
                "norm(a, b)*(2 - norm(a, b)) - 1",
                ["K contains all forces: g <= 0 everywhere", f"g is not differentiable at zero force{INSIDE}"],
            ),
        ],
    ),
)
def test_what_is_said_is_so(g: str, said: list[str]) -> None:
    parameters = {"m": POSITIVE} if "m*" in g else {}
    found = [r for r in remarks(g, parameters=parameters) if not r.startswith("K is unbounded")]
    assert [r for r in found if said or not r.startswith("g does not")] == said


def test_a_tip_on_the_boundary_is_not_called_inside() -> None:
    found = remarks("norm(a, b) + norm(a - abs(n), b)/2 - abs(n)", claims=("smoothness",))
    assert found == (
        "g is not differentiable at a = abs(n), b = 0",
        "g is not differentiable at zero force; that point is inside K for n < 0, so the boundary is not touched",
    )


def test_a_line_is_not_called_vacuous() -> None:
    for g, vacuous in (
        ("b**2", False),
        ("(a - b)**2 + 0*a", False),
        ("a**2 + b**2", True),
        ("(a - 1)**2 + b**2", False),
        ("-(a**2) - 1", True),
    ):
        assert verify(Criterion("law", g, forces=("a", "b"), pressure=None), claims=["dissipation"]).vacuous is vacuous


def test_a_scale_that_moves_with_a_parameter_is_not_taken_for_a_direction() -> None:
    """The lines on which a = m b are others for each m: with m = 1 put in, they would be a = b."""
    assert not [r for r in remarks("abs(a - m*b) - 1", parameters={"m": POSITIVE}) if "unbounded" in r]
    assert not [r for r in remarks("abs(a - m*b) + 0*m", parameters={"m": POSITIVE}) if "unbounded" in r]


@pytest.mark.parametrize("k", [2, 4])
def test_an_angle_that_divides_by_0_on_a_line_is_read_as_no_limit(k: int) -> None:
    """Where a = 0 the formula has no value, so that these points are not in K, which then is not convex: nothing is proved of it."""
    law = Criterion("law", f"norm(a, b) - abs(n)*(1 + 1/40*cos({k}*atan(b/a)))", forces=("a", "b"), pressure="n")
    assert Verdict.PROVED not in {verify(law, claims=[c])[c].verdict for c in ("origin", "convexity", "smoothness", "dissipation")}


def test_a_limit_at_zero_force_is_said() -> None:
    (said,) = remarks("norm(a, b) + a*b/norm(a, b)/4 - 1", claims=("convexity",))
    why = "g has no value at zero force: it divides by norm(a, b), which is 0 there"
    assert said == f"{why}; duhem uses the limit of g there, and K is closed"


def test_a_value_at_zero_force_that_is_a_limit_is_called_one() -> None:
    found = verify("ottosen", claims=["origin"])["origin"]
    assert "or its limit where g has no value at zero force, is <= 0" in found.detail
