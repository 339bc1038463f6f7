"""Chords with ends that move with the parameter, sections and tips: what refutes over whole cells, held to values worked out apart."""

from __future__ import annotations

import random
import re
from collections.abc import Callable, Iterator
from fractions import Fraction
from functools import cache
from typing import Any

import mpmath
import numpy as np
import pytest

import duhem
from duhem.proof.certificate import law_as_text
from duhem.proof.kernel.certificate import stated
from duhem.proof.kernel.dents import dents
from duhem.proof.kernel.signs import RealRoot
from duhem.proof.kernel.stated_law import StatedLaw
from duhem.regions import suggested
from duhem.regions.chords import Suggestion, _reach
from duhem.regions.places import Decided, ParameterCell
from duhem.regions.search import Asked
from tests.regions.test_planes import tampered

BETWEEN = duhem.Domain.between


def cap(low: Any = -1, high: Any = 1) -> duhem.Criterion:
    """|y| <= 1 + c exp(x) where |x| <= 1: convex if and only if c <= 0, and of no depth at c = 0."""
    box = {"x": BETWEEN(-1, 1)}
    return duhem.Criterion("cap", "abs(y) - 1 - c*exp(x)", {"c": BETWEEN(low, high)}, ("x", "y"), None, domain=box)


@cache
def refuted() -> duhem.ParameterRegion:
    return duhem.region(cap("1/8", 1), steps=4_000_000)


def test_ends_that_move_with_the_parameter_refute_over_whole_cells() -> None:
    done, moving = refuted(), 0
    assert done.exact and done.condition == "false" and duhem.recheck(done.certificate()).ok
    for one in done.known:
        evidence = one.leaf["evidence"]
        for c in np.linspace(float(one.cell.low.low), float(one.cell.high.low), 7):
            ends = [np.array([float(eval(evidence[key].get(f, "0"), {"c": c})) for f in ("x", "y")]) for key in ("p", "q")]
            level = [abs(y) - 1 - c * np.exp(x) for x, y in (*ends, (ends[0] + ends[1]) / 2)]
            assert level[0] <= 0 and level[1] <= 0 < level[2]
        moving += "*c" in "".join(evidence["p"].values())
    assert moving


def test_no_tampered_chord_confirms_a_false_cell() -> None:
    document, draw, confirmed = refuted().certificate(), random.Random(3), 0
    values = [draw.uniform(-2, 2) for _ in range(200)]
    for _ in range(60):
        try:
            done = duhem.recheck(tampered(document, draw))
        except duhem.InputError:
            continue
        for row in done.cells:
            if not row.reason and row.verdict in ("proved", "refuted"):
                confirmed += 1
                there = [c for c in values if eval(row.said.replace("everywhere", "True"), {"c": c})]
                assert all((c <= 0) is (row.verdict == "proved") for c in there), row
    assert confirmed


# -- tips and sections -------------------------------------------------------------------------------------------------

J2, I1 = "((s1 - s2)**2 + (s2 - s3)**2 + (s3 - s1)**2)/6", "(s1 + s2 + s3)"
SECTION = f"(({J2})**3 - c*((2*s1 - s2 - s3)*(2*s2 - s3 - s1)*(2*s3 - s1 - s2)/27)**2)**(1/6)"


def principal(g: str, **parameters: duhem.Domain) -> duhem.Criterion:
    return duhem.Criterion("tip", g, parameters, ("s1", "s2", "s3"), None)


def of_sectors(law: duhem.Criterion) -> list[Any]:
    found = stated(law_as_text(law))
    assert isinstance(found, StatedLaw)
    return list(dents(found, "sector"))


BEYOND = BETWEEN("5/2", 3)


@pytest.mark.parametrize(
    ("g", "dented"),
    [
        (f"{J2} + {SECTION} + {I1}/3 - 1", True),
        (f"{J2} + 2*({SECTION} - {I1}/3) - 1", True),
        (f"{SECTION} + {I1}/3 - 1", True),
        (f"(s1**2 + s2**2 + s3**2 - s1*s2 - s2*s3 - s3*s1) + {SECTION} + {I1}/3 - 1", True),  # J2 as a sum
        (f"{SECTION} - 1", True),
        (f"{J2} + {SECTION} - 1", False),  # the level is one
        (f"{J2} + {SECTION} + {I1}**2 - 1", False),
        (f"{J2} + {SECTION} + k*{I1} - 1", False),  # k may be 0
        (f"{J2} + {SECTION} + {I1} + sqrt(abs({I1})) - 1", False),
        (f"{J2} + {SECTION} + s1 - 1", False),
        (f"{SECTION} + {I1}/3 - norm(s1, s2) - 1", False),
    ],
)
def test_the_section_at_a_tip_is_that_of_the_lowest_part(g: str, dented: bool) -> None:
    law = principal(g, c=BEYOND, **({"k": BETWEEN(-1, 1)} if "k*" in g else {}))
    found = of_sectors(law)
    assert bool(found) is dented
    if dented and "2*(" in g:
        done = duhem.region(law, "c")
        assert done.exact and done.condition == "false" and duhem.recheck(done.certificate()).ok


def test_what_a_tip_shows_is_so() -> None:
    """A chord of K near the tip, at a value beyond the end of the section: worked out in floating point."""

    def g(s: np.ndarray) -> float:
        d = s - s.mean()
        return float(d @ d / 2 + ((d @ d / 2) ** 3 - 2.5 * np.prod(d) ** 2) ** (1 / 6) + s.sum() / 3 - 1)

    base, reach = np.ones(3) * (1 - 1e-4), []
    for turn in (-0.1, 0.1):  # about pure shear, where J3 = 0
        way, low, high = np.array([1.0, 0, -1]) + turn * np.array([1.0, -2, 1]), 0.0, 1.0
        for _ in range(80):
            middle = (low + high) / 2
            low, high = (middle, high) if g(base + middle * way) <= 0 else (low, middle)
        reach.append(base + low * way)
    assert max(map(g, reach)) <= 0 < 1e-9 < g((reach[0] + reach[1]) / 2)


@pytest.mark.long
def test_the_atlas_beyond_what_was_published() -> None:
    for name, over, short in (
        ("menetrey-willam", {"e": "0:1"}, "e >= 1/2"),
        ("yu", {"b": "0:2"}, "b <= 1"),
    ):
        done = duhem.region(name, over=over)
        assert done.exact and done.short == short and duhem.recheck(done.certificate()).ok


@pytest.mark.parametrize("name", ["bresler-pister", "wiebols-cook"])
def test_lines_leave_what_is_no_polynomial_of_the_forces(name: str) -> None:
    law = duhem.load(name)
    (c,) = {"c", "C"} & {*law.parameters}
    fixed = {"a": 1, "b": 1} if c == "c" else {"A": 1, "B": 1}
    done = duhem.region(law.fix(fixed), over={c: (-1, 1)})
    assert done.exact and done.short == f"{c} <= 0" and duhem.recheck(done.certificate()).ok


@pytest.mark.parametrize(
    ("g", "low", "high"),
    [
        ("x**2 - c*abs(x*y) + y**2 - 1", "3/2", "5/2"),  # without end along the diagonals for c >= 2
        ("x**2 - 2*c*abs(x*y) + 4*y**2 - 1", "3/2", "5/2"),
        ("max(norm(x, y) - c*abs(x) - 1, norm(x, y) - c*abs(y) - 1)", "9/10", "6/5"),  # along the axes for c >= 1
    ],
)
def test_ends_that_stay_refute_where_k_opens_inside_the_cell(g: str, low: str, high: str) -> None:
    """How far a line stays in K has no bound from a value in the cell on, so no end that moves with the parameter follows it."""
    asked = Asked(duhem.Criterion("opens", g, {"c": BETWEEN(low, high)}, ("x", "y"), None), "convexity", ("c",))
    found = asked.refuted(asked.whole)
    assert found is not None and found.leaf["rule"] == "chord"
    with mpmath.workdps(40):
        for c in (mpmath.mpf(k) / 100 for k in range(int(100 * Fraction(low)), int(100 * Fraction(high)) + 1)):
            p, q = ([exactly(found.leaf["evidence"][key].get(f, "0"), c=c) for f in ("x", "y")] for key in ("p", "q"))
            words = {"abs": abs, "max": max, "norm": mpmath.hypot, "c": c}
            levels = [exactly(g, x=x, y=y, **words) for x, y in (p, q, [(u + v) / 2 for u, v in zip(p, q, strict=True)])]
            assert levels[0] <= 0 and levels[1] <= 0 < levels[2]


# -- near an end of a cell ---------------------------------------------------------------------------------------------

WEDGE = "abs(y) + pos(x) - k*neg(x) - 1"  # its edges at x = 0 meet inward for k > 1
LENS = "max(abs(y) - sqrt(pos((x - x**2)*(2*(1 - a)*x + a))), -x, x - 1)"  # a needle at x = 0 for a < 0, at x = 1 for a > 2
BOX = {"x": BETWEEN(-1, 1)}
NEAR: dict[str, tuple[str, str, dict[str, Any], tuple[str, str], str]] = {
    "a kink, from below": (WEDGE, "k", BOX, ("1", "3"), "(k - (1))"),
    "a kink, from above": (WEDGE.replace("- k*", "- (2 - k)*"), "k", BOX, ("1", "-1"), "(1 - k)"),
    "a tip": (LENS, "a", {}, ("0", "-1/2"), "(0 - a)"),
    "the other tip": (LENS, "a", {}, ("2", "5/2"), "(a - (2))"),
}


def asked_near(name: str) -> tuple[Asked, ParameterCell]:
    """The question over a cell without the end at which K turns convex, where the claim is known to hold."""
    g, parameter, ranges, (turning, far), _ = NEAR[name]
    low, high = sorted(map(Fraction, (turning, far)))
    law = duhem.Criterion("near", g, {parameter: BETWEEN(str(low), str(high))}, ("x", "y"), None, domain=ranges)
    asked, at = Asked(law, "convexity", (parameter,)), RealRoot.of(Fraction(turning))
    asked._known[ParameterCell(at, at)] = Decided(ParameterCell(at, at), {"verdict": "proved"})
    return asked, ParameterCell(RealRoot.of(low), RealRoot.of(high), at.low == low, at.low == high)


@cache
def near(name: str) -> dict[str, Any]:
    asked, cell = asked_near(name)
    found = asked.refuted(cell)
    assert found is not None and found.leaf["rule"] == "chord"
    return dict(found.leaf["evidence"])


def exactly(text: str, **names: Any) -> Any:
    """A formula in as many digits as mpmath works with."""
    return eval(re.sub(r"\d+", r"mpf(\g<0>)", text), {"mpf": mpmath.mpf, **names})


def level(name: str, at: list[Any], of: Any) -> Any:
    """g, written again."""
    x, y = at
    if "kink" in name:
        return abs(y) + max(x, 0) - (of if "below" in name else 2 - of) * max(-x, 0) - 1
    return max(abs(y) - mpmath.sqrt(max((x - x**2) * (2 * (1 - of) * x + of), 0)), -x, x - 1)


@pytest.mark.parametrize("name", NEAR)
def test_one_chord_refutes_as_near_to_an_end_as_one_likes(name: str) -> None:
    """In forty digits, down to 1e-12 beside the end: both ends of the chord lie in K, and the midpoint does not."""
    _, parameter, _, (turning, far), distance = NEAR[name]
    evidence = near(name)
    assert distance in str(evidence)
    with mpmath.workdps(40):
        start, end = exactly(turning), exactly(far)
        for share in (mpmath.mpf(10) ** -12, mpmath.mpf(10) ** -6, *(mpmath.mpf(k) / 500 for k in range(1, 501))):
            of = start + share * (end - start)
            p, q = ([exactly(evidence[key].get(f, "0"), **{parameter: of}) for f in ("x", "y")] for key in ("p", "q"))
            middle = [(u + v) / 2 for u, v in zip(p, q, strict=True)]
            assert level(name, p, of) <= 0 and level(name, q, of) <= 0 < level(name, middle, of), of


@pytest.mark.parametrize("name", NEAR)
def test_what_refutes_up_to_an_end_refutes_nothing_at_it_or_beyond(name: str) -> None:
    asked, cell = asked_near(name)
    g, parameter, ranges, (turning, far), _ = NEAR[name]
    told, at = Suggestion("chord", near(name)), Fraction(turning)
    assert asked.refutes(asked.over(cell), told)
    assert not asked.refutes(asked.over(cell._replace(open=False, open_high=False)), told)
    wide = Asked(duhem.Criterion("near", g, {parameter: BETWEEN(-3, 5)}, ("x", "y"), None, domain=ranges), "convexity", (parameter,))
    for k in range(9):
        x = RealRoot.of(at + Fraction(k, 16) * (at - Fraction(far)))
        assert not wide.refutes(wide.over(ParameterCell(x, x)), told)


def test_the_search_begins_with_the_lines_that_refuted_the_cell_before(monkeypatch: pytest.MonkeyPatch) -> None:
    asked = Asked(cap("1/8", 1), "convexity", ("c",))
    quarter, half, one = (RealRoot.of(Fraction(x)) for x in ("1/4", "1/2", "1"))
    assert asked.refuted(ParameterCell(half, one)) is not None and asked.chords

    def again(*_: Any) -> Iterator[Any]:
        yield pytest.fail("all lines are looked at again")

    monkeypatch.setattr(suggested, "chords", again)
    assert asked.refuted(ParameterCell(quarter, half, False, True)) is not None


# -- of angles ---------------------------------------------------------------------------------------------------------

RADIAL: dict[str, Callable[[float, float, float], float]] = {  # g without a value at zero force, and where a ray leaves K
    "norm(x, y) + a*x*y/norm(x, y) - 1": lambda a, c, s: 1 / (1 + a * c * s),
    "norm(x, y)*(2 + a*x**3/norm(x, y)**3) - 1": lambda a, c, s: 1 / (2 + a * c**3),
    "x**2 + y**2 + a*x**2*y**2/(x**2 + y**2) - 1": lambda a, c, s: (1 + a * c**2 * s**2) ** -0.5,
    "1 + a*x*y/norm(x, y)": lambda a, c, s: np.nan,  # it is outside at once
}


@pytest.mark.parametrize("g", RADIAL)
def test_rays_start_where_an_angle_has_no_value(g: str) -> None:
    law = stated(law_as_text(duhem.Criterion("radial", g, {"a": BETWEEN("1/4", 1)}, ("x", "y"), None)))
    assert isinstance(law, StatedLaw)
    values, turns = np.array([0.25, 0.5, 0.75]), np.linspace(0.1, 6.2, 40)
    ways = np.array([np.cos(turns), np.sin(turns)]).T[:, None]
    expected = [[RADIAL[g](a, *way[0]) for a in values] for way in ways]
    assert np.allclose(_reach(law, {"a": values}, np.zeros_like(ways), ways), expected, rtol=1e-9, equal_nan=True)


GAMMA, SHARES = mpmath.mpf(9) / 10, (0, 1e-9, *np.linspace(0.02, 0.98, 25).tolist(), 1)


def of_bigoni(beta: Any, *s: Any) -> Any:
    """g of Bigoni and Piccolroaz with the numbers of the atlas, written again, within its meridian."""
    p = -mpmath.fsum(s) / 3
    d = [x + p for x in s]
    second, third, f = mpmath.fsum(x * x for x in d) / 2, mpmath.fprod(d), (p + mpmath.mpf("0.1")) / mpmath.mpf("1.1")
    assert 0 < f < 1
    angle = mpmath.acos(GAMMA * 3 * mpmath.sqrt(3) / 2 * third / second**1.5) / 3
    meridian = mpmath.mpf("1.1") * mpmath.sqrt((f - f * f) * (2 * mpmath.mpf("0.7") * f + mpmath.mpf("0.3")))
    return mpmath.sqrt(3 * second) * mpmath.cos(beta * mpmath.pi / 6 - angle) - meridian


def of_beta() -> Asked:
    return Asked(duhem.load("bigoni-piccolroaz").within({"beta": BETWEEN(-1, 3)}), "convexity", ("beta",))


@pytest.mark.parametrize("near", [("-1/7", "-1/10"), ("-1/19", "-1/26"), ("53/26", "39/19"), ("-1/26", "-1/30")])
def test_chords_between_rays_refute_where_the_lode_angle_enters(near: tuple[str, str]) -> None:
    """The ends of the chords lie in K at many values of the cell, and the midpoint does not: in thirty digits."""
    low, high = (RealRoot.of(Fraction(x)) for x in near)
    found = of_beta().refuted(ParameterCell(low, high))
    assert found is not None and found.leaf["rule"] == "chord"
    evidence = found.leaf["evidence"]
    with mpmath.workdps(30):
        for share in SHARES:
            beta = exactly(near[0]) * (1 - share) + exactly(near[1]) * share
            p, q = ([exactly(evidence[key].get(f"sigma_{i}", "0"), beta=beta) for i in (1, 2, 3)] for key in ("p", "q"))
            levels = [of_bigoni(beta, *s) for s in (p, q, [(x + y) / 2 for x, y in zip(p, q, strict=True)])]
            assert levels[0] <= 0 and levels[1] <= 0 < levels[2], beta


@pytest.mark.long
def test_beside_a_convex_end_no_chord_is_looked_for_that_would_leave_k_there_too() -> None:
    """K is still convex a little below beta = 0 (the curvature of 1/r shows it), so nothing refutes up to there; it is cheap to see."""
    least = 6 / mpmath.pi * (mpmath.acos(GAMMA) / 3 - mpmath.atan(mpmath.sqrt(1 - GAMMA**2) / (3 * GAMMA)))
    zero, asked = RealRoot.of(Fraction(0)), of_beta()
    asked._known[ParameterCell(zero, zero)] = Decided(ParameterCell(zero, zero), {"verdict": "proved"})
    for n in (5, 26, 47):
        assert -mpmath.mpf(1) / n < least < -mpmath.mpf(1) / 54
        before = asked.steps
        assert asked.refuted(ParameterCell(RealRoot.of(Fraction(-1, n)), zero, True, True)) is None
        assert asked.steps - before < 400_000
