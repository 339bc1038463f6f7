"""Functions of one load, of one size, and choices of them: what is proved holds at many chords, and neighbours stay open."""

from __future__ import annotations

import re

import numpy as np
import pytest

from duhem import Criterion
from duhem.expression.numpy_ import evaluate
from duhem.law.domain import POSITIVE, Domain
from duhem.proof.certificate import law_as_text
from duhem.proof.kernel.certificate import stated
from duhem.proof.kernel.claims import objection

ABOVE, BELOW = {"p": Domain.between(0)}, {"p": Domain.between(None, 0)}
KNOWN = {"M": POSITIVE, "c": POSITIVE, "d": POSITIVE, "b": Domain.between(0), "k": Domain(), "n": Domain.between(1)}
CASSON = "(r**2/2 - 4*sqrt(c)*r**(3/2)/3 + c*r - c**2/6)/M"
POTENTIALS = [  # functions of r, a size; they are C^1 but where the last word says so
    (f"where(r > c, {CASSON}, 0)", "smooth"),
    (f"where(r <= c, 0, {CASSON})", "smooth"),
    ("where(r > c, (r - c)**2/M, 0)", "smooth"),
    ("where(r > c, M*((r - c)/d)**((M + 1)/M), 0)", "smooth"),
    ("where(r < c, r**2/2, c*r - c**2/2)", "smooth"),
    ("where(r >= c, r**2/2 + b*(r - c), r**2/2)", "kink"),
    ("where(r < c, b*r, r**2/2 + b*c - c**2/2 + b*(r - c))", "kink"),
    ("where(r > c, r - c, 0)", "kink"),
    ("r**2/(1 + r/c)", "smooth"),
    ("log(cosh(r/c))", "smooth"),
]
NOT_CONVEX = [
    "where(r > c, (r - c)**2/M + 1, 0)",  # it jumps
    "where(r > c, (r - c)**2/M, (r - c)/M)",  # its slope falls
    "where(r > c, r**2/2 - c**2/2, b*(r - c))",
    "where(r > c, (r - c)**2/M, c - r)",
    f"where(r > d, {CASSON}, 0)",  # it changes over elsewhere
    f"where(r > c, {CASSON.replace('4*', '5*')}, 0)",
    f"where(r > c, -({CASSON}), 0)",
    "where(r > c, log(r/c), 0)",
    "r**2/2 - 4*sqrt(c)*r**(3/2)/3 + c*r",
    "r/(1 + r/c)",
    "r**2/(1 - r/c)",
    "log(1 + r**2)",
]


def law(g: str, ranges: dict[str, Domain], constraints: list[str]) -> Criterion:
    used = {name: domain for name, domain in KNOWN.items() if re.search(rf"\b{name}\b", " ".join((g, *constraints)))}
    forces = tuple(f for f in ("q", "p", "t") if re.search(rf"\b{f}\b", g))
    return Criterion("law", g, used, forces, None, domain=ranges, constraints=tuple(constraints))


def proved(claim: str, criterion: Criterion, rule: str = "composition") -> bool:
    return not objection(claim, rule, frozenset(), stated(law_as_text(criterion)), {})


def leaves(criterion: Criterion, within: dict[str, Domain]) -> bool:
    """Whether the middle of a chord of K is not in K, at some of many chords: between points that lie close to the boundary."""
    random = np.random.default_rng(11)
    ends = {name: (float(d.low or 0.0), float(d.high or 3)) if d != Domain() else (-2.0, 2.0) for name, d in criterion.parameters.items()}
    for _ in range(12):
        values = {x: random.uniform(*ends[name]) + 0.05 * (ends[name][0] == 0) for name, x in criterion.symbols().items() if name in ends}
        points = random.uniform(-4, 4, (2, 4_000, len(criterion.forces)))
        for name, domain in within.items():
            i = criterion.forces.index(name)
            points[..., i] = np.abs(points[..., i]) * (-1 if domain.low is None else 1)
        with np.errstate(all="ignore"):
            one, two, middle = (
                evaluate(criterion.g, values | dict(zip(criterion.force_symbols(), x.T, strict=True)))
                for x in (*points, points.mean(axis=0))
            )
        if np.any((one <= 0) & (two <= 0) & ~(middle <= 1e-9)):
            return True
    return False


PROVED = [
    ("abs(q) - c - M*p/(d + p)", ABOVE, []),
    ("abs(q) - p/(c + b*p)", ABOVE, []),  # where b = 0 too
    ("abs(q) - p/(1 + p/c)", ABOVE, []),
    ("abs(q) - (c + M*p)/(1 + b*p)", ABOVE, ["M >= b*c"]),
    ("abs(q) + (c + M*p)/(1 + b*p) - k", ABOVE, ["M <= b*c"]),
    ("norm(q, t) + M*p/(1 - p/c)", BELOW, []),
    ("norm(q, t) - M*p/sqrt(1 + p/c)", ABOVE, []),
    ("abs(q) - c*tanh(p/d)", ABOVE, []),
    ("abs(q) - c*atan(p/d)", ABOVE, []),
    ("q - M*p/n*(1 + (n - 1)*(p/c)**(n/(1 - n)))", ABOVE, []),
    ("abs(q) - sqrt(min(M*p, d*(c - p)))", {}, []),
    ("norm(q, t) - c*min(p, M*(d - p))**(1/3)", {}, []),
    ("norm(q, t)/(1 + norm(q, t)/c) - k", {}, []),  # it rises
    ("M*q**2 + 2*k*q*p + c*p**2 + b*q - 1", {}, ["abs(k) < sqrt(M*c)"]),
]
OPEN = [
    ("abs(q) - c + M*p/(d + p)", ABOVE, []),
    ("abs(q) - c - M*p/(d + p)", BELOW, []),
    ("abs(q) - c - M*p/(d + p)", {}, []),
    ("abs(q) - c - M*p/(p - d)", ABOVE, []),
    ("abs(q) - (c + M*p)/(1 + b*p)", ABOVE, []),
    ("abs(q) - (c + M*p)/(1 + b*p)", ABOVE, ["M <= b*c"]),
    ("abs(q) - (c + M*p)/(1 + k*p)", ABOVE, ["M >= k*c"]),
    ("norm(q, t) - M*p*sqrt(1 + p/c)", ABOVE, []),
    ("abs(q) - c*tanh(p/d)", {"p": Domain.between(-1)}, []),
    ("abs(q) - c*tanh(p*t/d)", {"p": ABOVE["p"], "t": ABOVE["p"]}, []),
    ("abs(q) - c*tanh((p - t)/d)", {"p": ABOVE["p"], "t": ABOVE["p"]}, []),
    ("abs(q) - sqrt(max(M*p, d*(c - p)))", {}, []),
    ("norm(q, t) - c*min(p, M*(d - p))**2", {}, []),
    ("c/2 - abs(q)/(1 + abs(q)/c)", {}, []),
    ("abs(q) - c + log(cosh(log(3 + p)))", ABOVE, []),  # cosh(log t) is convex, and its logarithm is not
    ("abs(q) - c + log(cosh(sqrt(1 + p)))", ABOVE, []),
    ("abs(q) - 1 + ((p - 1)**2)**(1/4)", {}, []),  # at p = 1 it has no slope, and f'' >= 0 nowhere
    ("abs(q) - 1 - ((p - 1)**2)**(3/4)", {}, []),
    ("M*q**2 + 2*k*q*p + c*p**2 + b*q - 1", {}, ["abs(k) < 2*sqrt(M*c)"]),
    ("M*q**2 + 2*k*q*p + c*p**2 + b*q - 1", {}, ["k < sqrt(M*c)"]),
]


@pytest.mark.parametrize(("g", "ranges", "constraints"), PROVED)
def test_a_function_of_one_load_that_bends_one_way_bounds_a_convex_set(g: str, ranges: dict[str, Domain], constraints: list[str]) -> None:
    criterion = law(g, ranges, constraints)
    if re.search(r"\bn\b", g):
        criterion = Criterion("law", g, {"M": POSITIVE, "c": POSITIVE, "n": Domain.between("1/10", "1/2")}, ("q", "p"), None, domain=ranges)
    assert proved("convexity", criterion)
    assert constraints or not leaves(criterion, ranges)


@pytest.mark.parametrize(("g", "ranges", "constraints"), OPEN)
def test_a_neighbour_that_does_not_bend_one_way_stays_open(g: str, ranges: dict[str, Domain], constraints: list[str]) -> None:
    assert not proved("convexity", law(g, ranges, constraints))


@pytest.mark.parametrize("size", ["abs(q)", "norm(q, t)"])
@pytest.mark.parametrize(("potential", "kind"), POTENTIALS)
def test_pieces_that_meet_with_a_slope_that_does_not_fall_are_convex(potential: str, kind: str, size: str) -> None:
    criterion = law(f"{potential.replace('r', size).replace('sq' + size + 't', 'sqrt').replace('whe' + size + 'e', 'where')} - p", {}, [])
    assert proved("convexity", criterion) and not leaves(criterion, {})
    assert proved("smoothness", criterion, "euler") is (kind == "smooth")


@pytest.mark.parametrize("potential", NOT_CONVEX)
def test_pieces_that_jump_or_whose_slope_falls_are_not_convex(potential: str) -> None:
    g = f"{potential.replace('r', 'abs(q)').replace('sqabs(q)t', 'sqrt').replace('wheabs(q)e', 'where')} - p"
    assert not proved("convexity", law(g, {}, [])) and leaves(law(g, {}, []), {})


@pytest.mark.parametrize("rest", ["abs(q)", "q**2"])
@pytest.mark.parametrize("low", [-1, -2])
@pytest.mark.parametrize("condition", ["p**2 > {}", "p**2 >= {}", "p**2*(p + {}) > {}**2*(p + {})"])
def test_pieces_that_meet_at_an_end_of_the_range_may_jump_inside_it(condition: str, low: int, rest: str) -> None:
    """At p = low both functions are 0, with the slopes 1 and -1; the choice changes over at p = -low too, and jumps there."""
    condition = condition.format(low**2, low**2, low**2) if "+" not in condition else condition.replace("{}", str(-low))
    g, ranges = f"where({condition}, p - ({low}), {low} - p) + {rest} - {-3 * low}", {"p": Domain.between(low)}
    assert not proved("convexity", law(g, ranges, [])) and not proved("smoothness", law(g, ranges, []))
    assert leaves(law(g, ranges, []), ranges) or "+" in condition


INSIDE = [
    ("norm(q, t) - M*p/(1 + p/d) - c", ABOVE, True),
    ("norm(q, t) - M*p/(1 + p/d)", ABOVE, False),  # a tip at p = 0
    ("abs(q) - c - M*p/(d + p)", ABOVE, True),
    ("abs(q) + c - M*p/(d + p)", ABOVE, False),
    ("norm(q, t) - M*p/(1 + p/d) - k", ABOVE, False),
]


@pytest.mark.parametrize(("g", "ranges", "smooth"), INSIDE)
def test_a_set_within_ranges_is_smooth_where_its_tips_lie_inside(g: str, ranges: dict[str, Domain], smooth: bool) -> None:
    assert proved("smoothness", law(g, ranges, [])) is smooth
