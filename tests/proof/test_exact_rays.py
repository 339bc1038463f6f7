"""Sets with faces, edges, whiskers and narrow dents that no sample meets, and neighbours that are convex."""

from __future__ import annotations

import pytest

from duhem import Criterion, verify
from duhem.proof.facts.formula_subject import FormulaSubject
from duhem.proof.methods import refuters
from duhem.proof.verdict import Verdict
from tests.long import long_but

CONE = "max(-a, -b, -c, (a + b + c)*(a*b + b*c + c*a) - 35/3*a*b*c)"  # Matsuoka, Nakai (1974): with the axes
FAR = "(a**4 + b**4 + c**4)/9"  # far away it outweighs what is of degree 4
HILL = "((a + b)**4 + (a - b)**4 + c**4)/9"
TURNED = {"a": "(a + 2*b)", "b": "(a - b + c)", "c": "(b - 3*c)"}


def turned(g: str) -> str:
    return "".join(TURNED.get(x, x) for x in g.replace("max", "M")).replace("M", "max")


def found(g: str, forces: tuple[str, ...]) -> bool:
    subject = FormulaSubject(Criterion(name="law", g=g, forces=forces, pressure=None))
    subject.allow(4_000_000)
    return refuters.convexity_between_exact_rays(subject) is not None


@pytest.mark.parametrize(
    ("g", "forces", "dented"),
    [
        (CONE, "abc", True),
        (turned(CONE), "abc", True),
        (CONE.replace("(a*b + b*c + c*a)", "(a + b + c)**2").replace("35/3", "30"), "abc", False),  # Lade, Duncan (1975): without
        (turned(CONE).replace("*35/3", "*0"), "abc", True),
        ("max(-a, -b, -c, a*b + b*c + c*a)", "abc", True),  # the axes alone
        ("max(-a, -b, a*b)", "ab", True),
        ("max(-a, -b, a - b, b - a)", "ab", False),  # a ray
        ("min(norm(a, b) - 1, abs(a) + pos(abs(b) - 2))", "ab", True),  # a disc with whiskers
        ("min(norm(a, b) - 1, abs(a) + pos(abs(b) - 1))", "ab", False),
        ("min(norm(a, b, c) - 1, norm(a - b, c) + pos(abs(b) - 1))", "abc", True),
        ("max(norm(a, b) - 1, where(abs(a) > 0, 0, b))", "ab", True),  # without half of its diameter
        ("max(norm(a, b) - 1, where(abs(a) > 0, 0, -1))", "ab", False),
    ],
)
def test_what_no_sample_meets(g: str, forces: str, dented: bool) -> None:
    assert found(g, tuple(forces)) is dented


@pytest.mark.long
def test_what_follows_for_the_slip() -> None:
    law = Criterion(name="law", g=CONE, forces=("a", "b", "c"), pressure=None)
    result = verify(law, claims=["convexity", "normality"])
    assert {r.verdict for r in result.results} == {Verdict.REFUTED}


@pytest.mark.slow
@pytest.mark.parametrize(
    ("g", "forces", "dented"),
    long_but(
        [0, 1, 7, 8],
        [
            (f"(a**2)**(6/5) + 4*b**2 + c**2 + a*b*c**2/10 + {FAR} - 1", "abc", True),  # a dent 1e-16 deep: no second derivative by a
            ("(a**2)**(6/5) + 4*b**2 + c**2 - 1", "abc", False),
            (f"(a**2)**(4/5) + 4*b**2 + c**2 + a*b*c**2/10 + {FAR} - 1", "abc", False),  # an infinite one
            (f"a**2 + 4*b**2 + c**2 + a*b*c**2/10 + {FAR} - 1", "abc", False),
            (f"(a**2)**(6/5) + b**2 + c**2 + d**2 + a*(b - d)*c**2/10 + {FAR} + d**4/9 - 1", "abcd", True),
            pytest.param("(a**2)**(6/5) + b**2 + c**2 + d**2 + a*(b - d)*c*(c - 2)*0 - 1", "abcd", False, marks=pytest.mark.long),
            (f"((a + b)**2)**(6/5) + 4*(a - b)**2 + c**2 + (a**2 - b**2)*c**2/10 + {HILL} - 1", "abc", True),  # Hill (1990), at pure shear
            ("10*abs(a)**(5/2) + b**2 - a**2/1000 - 1", "ab", True),
            ("10*abs(a)**(5/2) + b**2 + a**2/1000 - 1", "ab", False),
        ],
    ),
)
def test_dents_too_narrow_for_samples(g: str, forces: str, dented: bool) -> None:
    law = Criterion(name="law", g=g, forces=tuple(forces), pressure=None)
    assert (verify(law, claims=["convexity"])["convexity"].verdict is Verdict.REFUTED) is dented
