"""Kinks off the boundary, power along rays and of potentials, corners: what is confirmed holds in floats, near misses are not."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from itertools import pairwise
from typing import Any

import numpy as np
import pytest

from duhem import Criterion, Domain
from duhem.proof.facts.formula_subject import FormulaSubject
from duhem.proof.kernel.claims import objection
from duhem.proof.kernel.stated_law import StatedLaw
from duhem.proof.methods import evidence, refuters
from duhem.proof.verification import Confirmations
from tests.oracles.reevaluation import confirmed as shown_again

POSITIVE = {"positive": True}
UNIT = {"min": "0", "max": "1"}
MORE = {"min": "1", "max": "3"}
WORDS: Mapping[str, Any] = {
    "abs": np.abs, "sqrt": np.sqrt, "log": np.log, "exp": np.exp, "cosh": np.cosh, "cos": np.cos, "sin": np.sin, "max": np.maximum,
    "norm": np.hypot, "pos": lambda x: np.maximum(x, 0), "where": np.where,
}  # fmt: skip
RADII = np.geomspace(1e-3, 1e3, 4000)


def stated(g: str, parameters: Mapping[str, Any], **more: Any) -> StatedLaw:
    given = {"forces": ("a", "b"), "pressure": None, "parameters": parameters, "constraints": (), "g": g, "flow": None}
    return StatedLaw.read(given | more)


def confirmed(claim: str, rule: str, law: StatedLaw) -> bool:
    return not objection(claim, rule, frozenset(), law, {})


# -- in floats -----------------------------------------------------------------------------------------------------------


def level(text: str, values: Mapping[str, float]) -> Any:
    code = compile(text, "g", "eval")
    return lambda a, b: eval(code, {"__builtins__": {}}, {**WORDS, **values, "a": a, "b": b})  # the formulas of this file


def on_boundary(g: Any, angle: float, low: float = 0.0) -> Iterator[tuple[float, float]]:
    """Where g changes its sign along a ray."""
    with np.errstate(all="ignore"):
        along = np.broadcast_to(g(RADII * math.cos(angle), RADII * math.sin(angle)), RADII.shape)
        for k in np.flatnonzero(np.isfinite(along[:-1]) & np.isfinite(along[1:]) & (np.sign(along[:-1]) * np.sign(along[1:]) < 0)):
            one, two, start = RADII[k], RADII[k + 1], along[k]
            for _ in range(60):
                middle = (one + two) / 2
                one, two = (middle, two) if g(middle * math.cos(angle), middle * math.sin(angle)) * start > 0 else (one, middle)
            yield one * math.cos(angle), one * math.sin(angle)


def slope(g: Any, a: float, b: float) -> tuple[float, float]:
    step = 1e-7 * math.hypot(a, b)
    with np.errstate(all="ignore"):
        return float(g(a + step, b) - g(a - step, b)) / (2 * step), float(g(a, b + step) - g(a, b - step)) / (2 * step)


def least_power(g: Any, h: Any = None, angles: Any = None) -> float:
    """The least of sigma . d/(|sigma| |d|) on g = 0, d the gradient of h, of g without one."""
    found = [1.0]
    for angle in np.linspace(-math.pi, math.pi, 361)[:-1] + 1e-3 if angles is None else angles:
        for a, b in on_boundary(g, angle):
            x, y = slope(h or g, a, b)
            if (size := math.hypot(x, y) * math.hypot(a, b)) and math.isfinite(size):
                found.append((a * x + b * y) / size)
    return min(found)


def turn(g: Any, width: float) -> float:
    """The most that the normal turns between rays so far apart, near where it turns most."""
    angles, step, found = np.linspace(-math.pi, math.pi, 181) + 1e-3, math.pi / 90, 0.0
    while step > width:
        normals = [(angle, math.atan2(*slope(g, *place))) for angle in angles for place in [*on_boundary(g, angle)][:1]]
        turns = [abs((two - one + math.pi) % (2 * math.pi) - math.pi) for (_, one), (_, two) in pairwise(normals)]
        k = int(np.argmax(turns))
        found, middle, step = turns[k], (normals[k][0] + normals[k + 1][0]) / 2, step / 5
        angles = middle + step * np.arange(-5, 6)
    return found


# -- smoothness ----------------------------------------------------------------------------------------------------------

SMOOTH = [  # and values of the parameters
    ("(a**2 + 2*b**2)**(11/10) + (a**2 + b**2)**(1/10)*(a**2 - 4*a*b) - k", {"k": 1.0}),  # a root is 0 at 0 alone
    ("(a**2 + b**2)**(1/5)*(a**2 + b**2 + a*b) + (a**2)**(6/5) - k", {"k": 2.0}),
    ("sqrt(m*a**2 + 2*c*m*a*b + b**2) + a/5 - k", {"m": 2.0, "c": 0.5, "k": 1.0}),  # definite by the constraint
    ("cosh(sqrt(a**2 + c**2*b**2)) + b**2 - 1 - k", {"c": 0.0, "k": 1.0}),  # even in the root, which is 0 on a line for c = 0
]
NOT_SMOOTH = [
    ("sqrt(a**2) + b**2 - k", {"k": 1.0}),  # 0 on a line that the boundary crosses
    ("sqrt((a + c*b)**2) + b**2 - k", {"c": 0.5, "k": 1.0}),
    ("sqrt(c*a**2 + m*b**2) + a**2 + b**2/9 - k", {"c": 0.0, "m": 1.0, "k": 1.0}),  # definite but for c = 0
    ("sqrt((a - 1)**2 + b**2)/2 + a - 1", {}),  # the root is 0 on the boundary
    ("sqrt(m*a**2 - 2*m*a*b + m*b**2) + (a + b)**2 + a**2/9 - k", {"m": 1.0, "k": 1.0}),  # semidefinite alone
    ("abs(a + c*b) + (a**2 + b**2)**2 - k", {"c": 0.5, "k": 1.0}),
    ("exp(sqrt(a**2)) + b**2 - 1 - k", {"k": 1.0}),  # not even in the root
]
PARAMETERS = {"k": POSITIVE, "m": MORE, "c": UNIT}


def smooth(g: str) -> bool:
    bound = ["m*c**2 < 1"] if "2*c*m" in g else []
    return any(confirmed("smoothness", rule, stated(g, PARAMETERS, constraints=bound)) for rule in ("composition", "euler"))


@pytest.mark.parametrize(("g", "values"), SMOOTH)
def test_a_kink_inside_does_not_matter(g: str, values: Mapping[str, float]) -> None:
    assert smooth(g)
    assert turn(level(g, values), 1e-5) < 1e-2


@pytest.mark.parametrize(("g", "values"), NOT_SMOOTH)
def test_a_kink_on_the_boundary_matters(g: str, values: Mapping[str, float]) -> None:
    assert not smooth(g)
    assert turn(level(g, values), 1e-5) > 0.1


@pytest.mark.parametrize(
    ("g", "right"),
    [
        ("b**2 + (a + c*m)*(a - k)", True),  # g(0) = 0 where c = 0, and it falls from there
        ("b**2 + (a + c*m)*(a - k) + m", False),  # nowhere <= 0 for small k
        ("b**2 + (a + c)*(a - c)", False),  # a point, for c = 0
        ("b**2 + (a - m)*(a - k)", False),  # a point, for k = m
        ("b**2 + (a - m)*(a - m - k)", True),
        ("b**2 + (a - m)**4 - c", False),  # no quadratic
    ],
)
def test_convex_and_below_zero_on_an_axis(g: str, right: bool) -> None:
    assert confirmed("smoothness", "composition", stated(g, PARAMETERS)) is right


# -- power along rays ----------------------------------------------------------------------------------------------------

QUADRANT = np.linspace(0.01, math.pi / 2 - 0.01, 60)
HALF = np.linspace(-math.pi / 2 + 0.01, math.pi / 2 - 0.01, 90)
RISES = [
    ("abs(b) + m*a*log(a/k)", {"m": 1.2, "k": 1.0}),
    ("(b/(m*a))**n + log(a/k)/log(1 + m)", {"m": 1.0, "k": 1.0, "n": 2.5}),
    ("b/a + m*log(a) - c", {"m": 1.0, "c": 1.0}),
    ("abs(b)**n + abs(a)**n - k", {"n": 1.5, "k": 1.0}),
    ("(abs(b)**n + abs(a)**n)**(1/n) + a*log(a/k)", {"n": 1.5, "k": 1.0}),
    ("a/k - (1 + b/a)**(-m)", {"k": 1.0, "m": 2.0}),
    ("where(b > m*a/2, b - k, b**2 + a**2 - k)", {"m": 1.0, "k": 1.0}),
    ("where(b > 0, b - m*a + a*(a/k)**m, a**2 - k**2)", {"m": 1.0, "k": 1.0}),  # >= 0 alone, and a graph
    ("where(3*max(a, b) + a + b > 0, max(a, b) - k, (a - b)**2/k + a + b)", {"k": 1.0}),
]
FALLS = [
    ("abs(b) + m*(a - 1)*log(a - 1)", {"m": 9.0}),  # what is under the logarithm is of no degree
    ("abs(b) - a*log(a) - k", {"k": 1.0}),  # 0 is outside
    ("b/a - m*log(a) - c", {"m": 1.0, "c": 1.0}),
    ("abs(b)**n - abs(a)**n + k", {"n": 1.5, "k": 1.0}),
    ("where(b > 1, b - 3, 9*(a - 1)**2 + (b - 1)**2 - 1)", {}),  # a choice that a ray changes
    ("where(b > m*a/2, 1 - b, b**2 + a**2 - 4)", {"m": 1.0}),  # one value falls
]
RANGES = {"a": {"min": "0"}}
EXPONENTS = {"n": MORE, **PARAMETERS}


@pytest.mark.parametrize(("g", "values"), RISES)
def test_the_power_by_degrees_and_logarithms(g: str, values: Mapping[str, float]) -> None:
    positive = "log" in g or "/a)" in g or "(a/k)" in g
    both = "b/" in g or "(a/k)" in g
    ranges = {**RANGES, **({"b": {"min": "0"}} if both else {})} if positive else {}
    assert confirmed("dissipation", "homogeneity", stated(g, EXPONENTS, domain=ranges))
    angles = None if not positive else QUADRANT if both else HALF
    assert least_power(level(g, values), angles=angles) > -1e-6


@pytest.mark.parametrize(("g", "values"), FALLS)
def test_a_power_that_may_be_negative(g: str, values: Mapping[str, float]) -> None:
    assert not confirmed("dissipation", "homogeneity", stated(g, EXPONENTS, domain=RANGES if "log" in g else {}))
    assert least_power(level(g, values), angles=HALF if "log" in g else None) < -1e-3


def test_nothing_is_said_of_smoothness_where_a_formula_ends() -> None:
    """{b^2 <= a^2 (1 - a)} has a corner at 0, where this formula of it has no value."""
    assert not any(confirmed("smoothness", rule, stated("a - 1 + b**2/a**2", {}, domain=RANGES)) for rule in ("composition", "euler"))


# -- potentials ----------------------------------------------------------------------------------------------------------

OUTWARD = [
    ("a**2 + 2*k*cosh(b/k)", {"k": 0.5}),
    ("abs(a)**n/k + abs(b)**n", {"k": 0.5, "n": 1.0}),
    ("exp(a) - a + b**2", {}),  # no slope at 0
    ("norm(pos(a)/k + pos(-a), b)", {"k": 0.5}),
    ("sqrt((pos(a)/k + pos(-a))**2 + b**2)", {"k": 0.5}),
    ("norm(where(a > 0, a, 0)/k + pos(-a), b)", {"k": 0.5}),
    ("a**4 + c*(a*b)**2 + b**4", {"c": 0.5}),
]
INWARD = [
    ("(a - k)**2 + b**2", {"k": 3.0}),  # least elsewhere
    ("exp(a) + b**2", {}),
    ("abs(a) + c*b", {"c": 0.9}),
    ("a**2 + 2*k*cosh(b/k - 1)", {"k": 3.0}),
    ("sqrt((pos(a)/k + pos(-a))**2 + (b - k)**2)", {"k": 3.0}),
    ("norm(where(a > 0, a, 0) + pos(-a), b - k)", {"k": 3.0}),
    ("a**4 - 3*a**2 + b**2", {}),  # even, not convex
    ("cos(a) + cos(b)", {}),
]


@pytest.mark.parametrize(("potential", "values", "right"), [(*one, True) for one in OUTWARD] + [(*one, False) for one in INWARD])
def test_a_convex_potential_least_at_zero(potential: str, values: Mapping[str, float], right: bool) -> None:
    g = "a**2 + b**2 + a*b - 1"
    law = stated(g, EXPONENTS, flow={"potential": potential})
    assert confirmed("dissipation", "convex-potential", law) is right
    assert bool(least_power(level(g, values), level(potential, values)) > -1e-6) is right


@pytest.mark.parametrize("potential", ["sqrt(pos(a)**2 + pos(b)**2)", "norm(where(a > 0, a, 0), pos(b))", "sqrt(c**2*a**2 + pos(b)**2)"])
def test_not_one_whose_gradient_has_no_value_in_a_quadrant(potential: str) -> None:
    law = stated("a**2 + b**2 + a*b - 1", EXPONENTS, flow={"potential": potential})
    assert not confirmed("dissipation", "convex-potential", law)


@pytest.mark.parametrize(
    ("direction", "right"),
    [
        (("(M - q/p)/(1 - N)", "1"), True),
        (("(M - q/p)/(1 + N)", "1"), True),
        (("(q/p - M)/(1 - N)", "1"), False),
        (("-2*M/N", "1"), False),
    ],
)
def test_a_share_of_g_with_an_exponent_that_is_a_parameter(direction: tuple[str, str], right: bool) -> None:
    nor_sand = Criterion(
        "law",
        "q - M*p/N*(1 + (N - 1)*(p/k)**(N/(1 - N)))",
        {"M": Domain.between("0.8", "1.6"), "N": Domain.between("0.1", "0.5"), "k": Domain(positive=True)},
        forces=("p", "q"),
        pressure=None,
        flow=direction,
        domain={"p": Domain.between(0), "q": Domain.between(0)},
    )
    kernel = Confirmations(nor_sand)
    assert any(kernel.confirms("dissipation", found) for found in evidence.dissipation_by_shares(FormulaSubject(nor_sand))) is right


# -- corners and saddles -------------------------------------------------------------------------------------------------


def formula(g: str, forces: tuple[str, ...] = ("a", "b"), **parameters: Domain) -> Criterion:
    return Criterion("law", g, parameters, forces=forces, pressure=None)


@pytest.mark.parametrize(
    ("g", "cornered"),
    [
        ("where(3*max(a, b) + min(a, b) > 0, max(a, b) - 1, (a - b)**2/8 + a + b)", True),  # jumps, but not at its corner
        ("where(b > -2, abs(a) + b - 1, a**2 + b**2 - 9)", True),
        ("where(b > 0, a**2 + b**2 - 1, a**2 + 4*b**2 - 1)", False),
    ],
)
def test_a_corner_beside_a_choice(g: str, cornered: bool) -> None:
    one = formula(g)
    found = refuters.smoothness_at_corners(FormulaSubject(one))
    assert (found is not None) is cornered
    assert found is None or (found.witness is not None and shown_again(one, "smoothness", found.witness))


@pytest.mark.parametrize(
    ("g", "saddle"),
    [
        ("a**2 - c*b**2 + 2*a*b + c*a - b - k", True),
        ("a**2 + c*b**2 + b - k", False),
        ("a**2 - b**2 - 1 - k", False),
    ],
)
def test_a_quadric_that_is_a_cone_for_some_parameters(g: str, saddle: bool) -> None:
    one = formula(g, k=Domain(positive=True), c=Domain.between("0.1", 3))
    found = refuters.smoothness_at_sharp_points(FormulaSubject(one))
    assert (found is not None) is saddle
    assert found is None or (found.witness is not None and shown_again(one, "smoothness", found.witness))
