"""Laws whose set is nothing, everything, a point, a line or not what was meant: none is called what it is not."""

from __future__ import annotations

import pytest

from duhem import POSITIVE, Criterion, Domain, Verdict, verify

PROVED, REFUTED = Verdict.PROVED, Verdict.REFUTED


def law(g: str, forces: tuple[str, ...] = ("a", "b"), flow: tuple[str, ...] | None = None, **parameters: Domain) -> Criterion:
    return Criterion(name="law", g=g, forces=forces, pressure="p" if "p" in g else None, flow=flow, parameters=parameters)


# -- one force ----------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("g", ["abs(a)", "a**2", "abs(a) - q", "pos(a)**2 + neg(a)"])
@pytest.mark.parametrize("forces", [("a",), ("a", "b")])
def test_a_point_or_a_line_has_no_smooth_boundary(g: str, forces: tuple[str, ...]) -> None:
    parameters = {"q": Domain.between(0, 1)} if "q" in g else {}
    assert verify(law(g, forces, **parameters), claims=["smoothness"])["smoothness"].verdict is not PROVED


@pytest.mark.parametrize("g", ["abs(a) - m*abs(p)", "a", "-a", "a**2 + a - 1", "max(a - 1, -a/2)", "sqrt(abs(a)) - 1", "a**2 - 1"])
def test_an_interval_with_an_inside_has(g: str) -> None:
    parameters = {"m": POSITIVE} if "m*" in g else {}
    assert verify(law(g, ("a",), **parameters), claims=["smoothness"])["smoothness"].verdict is PROVED


# -- flows --------------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("flow", [("0*a", "0*b"), ("a*pos(a)", "b*pos(a)"), ("a*abs(a - b)", "b*abs(a - b)")])
def test_a_flow_that_vanishes_has_no_direction(flow: tuple[str, ...]) -> None:
    assert verify(law("norm(a, b) - 1", flow=flow), claims=["normality"])["normality"].verdict is not PROVED


# -- a vacuous question -------------------------------------------------------------------------------------------------

QUARTIC = "(a**4 + b**4 + c*a**2*b**2 - 1)"
OUTER = ("max({f}, 2*{f})", "{f} + abs({f})/2", "where({f} > 0, 3*{f}, {f})", "2*{f} + pos({f})", "{f} - neg({f})")


@pytest.mark.parametrize("outer", OUTER)
def test_a_boundary_along_a_seam_is_asked_about(outer: str) -> None:
    """Convex if and only if 0 <= c <= 6 (the sign of the curvature at 45 degrees and on the axes)."""
    g = outer.format(f=QUARTIC)
    beyond = verify(law(g, c=Domain.fixed("6.001")), claims=["convexity"])["convexity"].verdict
    assert beyond is not PROVED
    assert verify(law(g, c=Domain.fixed(6)), claims=["convexity"])["convexity"].verdict is not REFUTED


# -- closed forms that divide -------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    "g",
    [
        "norm(e*a, b) - abs(p)",
        "abs(e*a) + abs(b) - 1",
        "norm(a, a + e*b)**2 + norm(a, e*b)**2 - 1",
        "norm(a, a + e*b, e*b) - 1",
        "norm(a + b, a + (1 - e)*b) - 1",
    ],
)
def test_a_potential_that_divides_by_what_may_vanish_is_not_proved(g: str) -> None:
    """At e = 0 the set is a strip or a band, and its support function infinite in one direction."""
    assert verify(law(g, e=Domain.between(0, 1)), claims=["duality"])["duality"].verdict is not PROVED
    assert verify(law(g, e=Domain.between("1/2", 1)), claims=["duality"])["duality"].verdict is PROVED
