"""The kernel on star-shaped laws in the plane: signs on a line, over parameters, along the rays, and the gauge they make."""

from __future__ import annotations

from collections.abc import Mapping
from fractions import Fraction
from itertools import pairwise
from math import isqrt, prod
from random import Random
from typing import Any

import pytest

from duhem.proof.kernel.claims import objection, rules_of
from duhem.proof.kernel.curvature import over
from duhem.proof.kernel.definedness import divides_by_zero_force
from duhem.proof.kernel.plane_gauge import StarGauge
from duhem.proof.kernel.signs import RAY, line, nonnegative_on_the_line, parts, roots
from duhem.proof.kernel.signs import nonnegative as nonnegative_over
from duhem.proof.kernel.stated_law import StatedLaw
from duhem.proof.kernel.term import NotWritten, Term, parse
from tests.long import long_but, mostly_long

F = Fraction
POSITIVE = {"positive": True}


def span(low: F | int | str, high: F | int | str) -> dict[str, str]:
    return {"min": str(low), "max": str(high)}


def law(g: str, *constraints: str, forces: tuple[str, ...] = ("a", "b"), flow: Any = None, **parameters: Any) -> StatedLaw:
    pressure = "s" if "s" not in forces and "s1" not in forces else None
    given = {"forces": forces, "pressure": pressure, "parameters": parameters, "constraints": list(constraints), "g": g, "flow": flow}
    return StatedLaw.read(given)


def judged(stated: StatedLaw) -> tuple[bool, bool] | None:
    """Convex, smooth; None where the law is not shown to be star-shaped."""
    try:
        gauge = StarGauge(stated)
        return gauge.convex(), gauge.smooth()
    except NotWritten:
        return None


# -- on a line ---------------------------------------------------------------------------------------------------------


def drawn_polynomial(rng: Random) -> tuple[list[F], dict[F, int]]:
    """Coefficients and the real roots with their multiplicities."""
    multiplicities = {F(rng.randint(-6, 6), rng.randint(1, 4)): rng.randint(1, 4) for _ in range(rng.randint(0, 4))}
    factors = [[-r, F(1)] for r, n in multiplicities.items() for _ in range(n)]
    factors += [[F(rng.randint(1, 3)), F(rng.randint(-1, 1)), F(1)] for _ in range(rng.randint(0, 2))]
    found = [F(rng.choice((1, -1, 2)))]
    for factor in factors:
        found = [
            sum((found[i] * factor[k - i] for i in range(len(found)) if 0 <= k - i < len(factor)), F(0))
            for k in range(len(found) + len(factor) - 1)
        ]
    return found, multiplicities


@pytest.mark.slow
def test_signs_on_an_interval() -> None:
    rng, counted = Random(5), [0, 0, 0]
    for _ in range(400):
        coefficients, multiplicities = drawn_polynomial(rng)
        low = F(rng.randint(-8, 2), 3)
        high = low + F(rng.randint(0, 12), 3)
        touched = sorted({low, high, *(r for r in multiplicities if low <= r <= high)})
        between = [(a + b) / 2 for a, b in pairwise(touched)] or [low]
        weak = all(sum(c * x**k for k, c in enumerate(coefficients)) >= 0 for x in between)
        strict = weak and not any(low <= r <= high for r in multiplicities)
        p = line(coefficients)
        assert (nonnegative_on_the_line(p, low, high), nonnegative_on_the_line(p, low, high, strict=True)) == (weak, strict)
        found = list(roots(parts(p)[0], low, high)) if low < high else []
        inside = sorted(r for r in multiplicities if low < r < high) if low < high else []
        assert len(found) == len(inside) and all(a <= r <= b for (a, b), r in zip(found, inside, strict=True))
        assert [
            nonnegative_on_the_line(parts(p)[1], r, r) and nonnegative_on_the_line(line([-c for c in parts(p)[1]]), r, r) for r in inside
        ] == [multiplicities[r] % 2 == 1 for r in inside]
        for i, truth in enumerate((weak, strict, not weak)):
            counted[i] += truth
    assert min(counted) > 40


def test_the_polynomial_0_and_constants() -> None:
    zero, one = line([F(0)]), line([F(3)])
    assert nonnegative_on_the_line(zero, F(0), F(1)) and not nonnegative_on_the_line(zero, F(0), F(1), strict=True)
    assert nonnegative_on_the_line(one, F(0), F(1), strict=True) and not nonnegative_on_the_line(line([F(-1)]), F(0), F(1))


# -- over parameters ---------------------------------------------------------------------------------------------------

REACHES: list[tuple[dict[str, Any], tuple[str, ...], list[F], list[F]]] = [  # domain, constraints, inside, ends that count
    (span(0, 1), (), [F(1, 9), F(1, 2), F(8, 9)], [F(0), F(1)]),
    (span(-1, 1), ("e < 1",), [F(-8, 9), F(0), F(8, 9)], [F(-1)]),
    (POSITIVE, (), [F(1, 99), F(1), F(99)], []),
    ({"min": "-2"}, ("e > -2",), [F(-199, 100), F(0), F(50)], []),
    ({"max": "3"}, (), [F(-50), F(0), F(2)], [F(3)]),
    ({}, (), [F(-99), F(-1), F(1), F(99)], [F(0)]),
]


@pytest.mark.slow
@pytest.mark.parametrize(("reach",), long_but([2], [(one,) for one in REACHES]), ids=lambda reach: str(reach[0]))
def test_signs_over_a_parameter(reach: tuple[dict[str, Any], tuple[str, ...], list[F], list[F]]) -> None:
    given, constraints, inside, ends = reach
    domain, e, rng, shown = over(law("a - e", *constraints, e=given)), Term("name", name="e"), Random(8), [0, 0]
    for _ in range(250):
        drawn = {(i, j): F(rng.randint(-1, 6)) for i in range(3) for j in range(3) if rng.random() < 0.6} | {(0, 0): F(rng.randint(0, 20))}
        poly = {tuple((x, n) for x, n in ((RAY, i), (e, j)) if n): c for (i, j), c in drawn.items() if c}
        poly = {tuple(sorted(m)): c for m, c in poly.items()}
        values = [
            sum(c * t**i * x**j for (i, j), c in drawn.items()) for t in (F(-1), F(-1, 3), F(0), F(1, 2), F(1)) for x in (*inside, *ends)
        ]
        weak, strict = (nonnegative_over(poly, (F(-1), F(1)), domain, s) for s in (False, True))
        assert not weak or min(values) >= 0
        assert not strict or min(values) > 0
        assert weak or not strict
        shown[0], shown[1] = shown[0] + weak, shown[1] + strict
    assert shown[1] > 0


def test_an_open_end_may_be_a_zero_and_a_closed_one_not() -> None:
    t_free = {(): F(1), ((Term("name", name="e"), 1),): F(-1)}  # 1 - e
    at = (F(-1), F(1))
    assert nonnegative_over(t_free, at, over(law("a", "e < 1", e=span(0, 1))), strict=True)
    assert nonnegative_over(t_free, at, over(law("a", e=span(0, 1))))
    assert not nonnegative_over(t_free, at, over(law("a", e=span(0, 1))), strict=True)
    assert not nonnegative_over(t_free, at, over(law("a", "e <= 1", e=span(0, 2))), strict=True)
    assert not nonnegative_over(t_free, at, over(law("a", "f < 1", e=span(0, 2), f=span(0, 2))))


@pytest.mark.parametrize(
    ("constraints", "expected"),
    [
        (["5*abs(m) <= k"], (True, True)),
        (["-k <= 5*m", "5*m <= k"], (True, True)),
        (["5*abs(m) <= k", "0 < n"], (True, True)),
        (["4*abs(m) <= k"], (False, True)),
        (["-k <= 4*m", "5*m <= k"], (False, True)),
        (["abs(m) < k"], (False, True)),
        (["abs(m) <= k"], None),  # the coefficient of friction may be 0
        (["5*m <= k"], None),
    ],
    ids=str,
)
def test_a_wave_of_friction_that_a_constraint_bounds(constraints: list[str], expected: tuple[bool, bool] | None) -> None:
    """k + m cos 2 theta is convex exactly for 5 |m| <= k."""
    assert judged(law("norm(a, b) + s*(k + m*cos(2*atan2(b, a)))", *constraints, k=POSITIVE, m={}, n={})) == expected


@pytest.mark.parametrize("constraint", ["2*abs(m) <= k", "abs(m) < k"])
def test_signs_over_what_a_constraint_bounds(constraint: str) -> None:
    domain, rng, shown = over(law("a - k", constraint, k=POSITIVE, m={})), Random(3), [0, 0]
    k, m = (Term("name", name=n) for n in "km")
    ways = [F(i, 2 if constraint[0] == "2" else 1) for i in (-1, 0, 1)]  # m, for k = 1: the signs at k are those at 1
    for _ in range(60):
        drawn = {(i, j): F(rng.randint(-2, 3) + 6 * (i == j == 0)) for i in range(3) for j in range(3)}
        poly = {tuple(sorted((x, n) for x, n in ((RAY, i), (m, j), (k, 2 - j)) if n)): c for (i, j), c in drawn.items() if c}
        values = [sum(c * t**i * x**j for (i, j), c in drawn.items()) for t in (F(-1), F(-1, 2), F(0), F(1, 3), F(1)) for x in ways]
        weak, strict = (nonnegative_over(poly, (F(-1), F(1)), domain, s) for s in (False, True))
        assert not weak or min(values) >= 0
        assert not strict or min(values) > 0 or (constraint[0] != "2" and min(values) == 0)
        assert weak or not strict
        shown[0], shown[1] = shown[0] + weak, shown[1] + strict
    assert shown[1] > 3


@pytest.mark.parametrize("constraint", ["m < k", "m <= k"])
def test_what_is_linear_between_ends_that_touch_0(constraint: str) -> None:
    """k A + m (B - A) is between k A and k B for 0 <= m <= k; A and B have zeros of even multiplicity at any place, or change sign."""
    domain, rng, shown = over(law("a - k", constraint, k=POSITIVE, m={"min": "0"})), Random(5), [0, 0]
    k, m = (Term("name", name=n) for n in "km")
    grid = [F(i, 40) for i in range(-40, 41)]

    def drawn() -> list[F]:
        root, level, turned = F(rng.randint(-9, 9), 7), rng.choice((0, 0, 1)), rng.choice((1, 1, 1, -1))
        return [turned * (root * root + level), turned * -2 * root, F(turned)]

    for _ in range(30):
        a, b = drawn(), drawn()
        shares = ((k, a), (m, [d - c for c, d in zip(a, b, strict=True)]))
        drawn_poly = {tuple(sorted((x, n) for x, n in ((RAY, i), (of, 1)) if n)): c for of, own in shares for i, c in enumerate(own) if c}
        weak, strict = (nonnegative_over(drawn_poly, (F(-1), F(1)), domain, s) for s in (False, True))
        at_ends = [[sum(c * t**i for i, c in enumerate(end)) for t in grid] for end in (a, b)]
        assert weak is all(nonnegative_on_the_line(line(end), F(-1), F(1)) for end in (a, b))
        between = [x + share * (y - x) for x, y in zip(*at_ends, strict=True) for share in (F(0), F(1, 2), F(99, 100))]
        assert not strict or min(between) > 0
        assert not strict or constraint == "m < k" or min(at_ends[1]) > 0
        shown[0], shown[1] = shown[0] + weak, shown[1] + strict
    assert shown[0] > 10 and shown[1] > 0


@pytest.mark.parametrize(
    ("constraint", "m", "right"),
    [
        ("m < k", {"min": "0"}, True),
        ("abs(m) < k", {}, True),
        ("m <= k", {"min": "0"}, False),
        ("m < 2*k", {"min": "0"}, False),
        ("m < k + n", {"min": "0"}, False),
        ("m < k", {}, False),
        ("n < k", {"min": "0"}, False),
    ],
)
@pytest.mark.parametrize("waves", [2, 4])
def test_a_wave_that_a_constraint_keeps_above_0(constraint: str, m: dict[str, str], right: bool, waves: int) -> None:
    wavy = law(f"norm(a, b) + s*(k + m*cos({waves}*atan2(b, a)))", constraint, k=POSITIVE, m=m, n=POSITIVE)
    assert (judged(wavy) is not None) is right


def test_a_constraint_may_leave_one_value() -> None:
    here, e = over(law("a - e", "e >= 1", e=span(0, 1))), Term("name", name="e")
    for shift, factor, weak, strict in (
        (-1, 1, True, False),
        (1, -1, True, False),
        (0, 1, True, True),
        (-2, 1, False, False),
        (2, -1, True, True),
    ):
        poly = {m: F(c) for m, c in (((), shift), (((e, 1),), factor)) if c}
        assert (nonnegative_over(poly, (F(-1), F(1)), here), nonnegative_over(poly, (F(-1), F(1)), here, strict=True)) == (weak, strict)


# -- thresholds --------------------------------------------------------------------------------------------------------

LIMACON = "norm(a, b)**2 + mu*s*(norm(a, b) + e*a)"
LOBES = "mu*s*(e*(a**3 - 3*a*b**2) + norm(a, b)**3) + norm(a, b)**4"
GAUGE_LOBES = "norm(a, b)**4 + e*(a**4 - 6*a**2*b**2 + b**4) + mu*s*norm(a, b)**3"
QUARTIC = "a**4 + b**4 + e*a**2*b**2 - mu**4*s**4"
MATCHSTICK = "s*norm(e*a, b) + norm(a, b)**2"
DRUCKER = (
    "-e*(-s1 - s2 + 2*s3)**2*(-s1 + 2*s2 - s3)**2*(2*s1 - s2 - s3)**2/729 - mu**6 + ((-s1 + s3)**2/6 + (s1 - s2)**2/6 + (s2 - s3)**2/6)**3"
)
THREE = ("s1", "s2", "s3")
THRESHOLDS = [  # formula, forces, a value inside, the threshold
    (LIMACON, None, F(0), F(1, 2)),
    (LIMACON, None, F(0), F(-1, 2)),
    (LOBES, None, F(0), F(1, 10)),
    (LOBES, None, F(0), F(-1, 10)),
    (GAUGE_LOBES, None, F(0), F(1, 15)),
    (GAUGE_LOBES, None, F(0), F(-1, 15)),
    (QUARTIC, None, F(1), F(6)),
    (QUARTIC, None, F(1), F(0)),
    (DRUCKER, THREE, F(1), F(9, 4)),
    (DRUCKER, THREE, F(-1), F(-27, 8)),
]


@pytest.mark.slow
@pytest.mark.parametrize(("g", "forces", "inside", "edge"), long_but([*range(3), 6, 7], THRESHOLDS), ids=lambda v: str(v)[:14])
def test_convex_up_to_the_threshold_and_not_beyond(g: str, forces: tuple[str, ...] | None, inside: F, edge: F) -> None:
    outward = 1 if edge > inside else -1
    for beyond, convex in ((F(0), True), (F(1, 10**9), False), (F(1, 1000), False)):
        ends = sorted((inside, edge + outward * beyond))
        assert judged(law(g, forces=forces or ("a", "b"), mu=POSITIVE, e=span(*ends))) == (convex, True)


@pytest.mark.parametrize(
    ("constraint", "convex"),
    [("e + f <= 1/2", True), ("(e - 1/4)**2 <= 1/16", True), ("e + f <= 500001/1000000", False), ("e*(1 + f) < 2", False)],
)
def test_a_threshold_said_by_a_constraint(constraint: str, convex: bool) -> None:
    assert judged(law(LIMACON, constraint, "e < 1", mu=POSITIVE, e=span(0, 7), f=span(0, 1))) == (convex, True)


def test_an_irrational_threshold() -> None:  # norm(m a, b) r^-1 <= 1 on the circle bends inward for m^2 > 2 and m^2 < 1/2
    assert judged(law(MATCHSTICK, e=span("70711/100000", "141421/100000"))) == (True, True)
    assert judged(law(MATCHSTICK, e=span(1, "141422/100000"))) == (False, True)
    assert judged(law(MATCHSTICK, e=span("70710/100000", 1))) == (False, True)
    assert judged(law(MATCHSTICK, e=POSITIVE)) == (False, True)


@pytest.mark.parametrize(
    ("g", "parameters", "expected"),
    [
        ("norm(a, b) + e*abs(a) - mu*abs(s)", {"e": span(0, 1)}, (True, False)),  # a kink outward
        ("norm(a, b) - e*abs(a) - mu*abs(s)", {"e": span(0, "1/2")}, (False, False)),  # a kink inward
        ("norm(a, b) + e*abs(a) - mu*abs(s)", {"e": span("-1/1000000000", 1)}, (False, False)),
        ("norm(a, b) + pos(a)**2/norm(a, b) - mu*abs(s)", {}, (True, True)),  # no kink: the slopes agree
        ("norm(a, b) + 1001/1000*pos(a)**2/norm(a, b) - mu*abs(s)", {}, (False, True)),
        ("norm(pos(a)/2 + neg(a)*3, b) - mu*abs(s)", {}, (True, True)),
        ("max(norm(a, b), 5*abs(a)/4) - mu*abs(s)", {}, (True, False)),
        ("min(norm(a, b), norm(2*a, b/2)) - mu*abs(s)", {}, (False, False)),
        ("max(norm(a, 2*b), norm(2*a, b)) - mu*abs(s)", {}, (True, False)),  # where they cross is irrational in a and b
        ("max(norm(a, b), norm(2*a, b)) - mu*abs(s)", {}, (True, True)),  # they touch
        ("(a**4 + b**4)**(1/4) - mu*abs(s)", {}, (True, True)),
        ("where(a >= 0, norm(a, b), norm(2*a, b)) - mu*abs(s)", {}, (True, True)),
        ("where(a >= 0, norm(a, b), (16*a**4 + b**4)**(1/4)) - mu*abs(s)", {}, (True, True)),
        ("where(a > 0, norm(a, b), abs(a) + abs(b)) - mu*abs(s)", {}, (True, False)),
        ("max(abs(a) + 2*abs(b), 2*abs(a) + abs(b)) - mu*abs(s)", {}, (True, False)),
        ("(norm(a, b) + e*a)*(norm(a, b) - mu*abs(s))", {"e": span(0, "1/2")}, (True, True)),  # multiplied out
        ("s*(mu*norm(a, b) + norm(a, b)**2/s)", {}, (True, True)),
        ("max(abs(a)*(1/(1 + e) + e/(1 + e)), abs(a)) + abs(b) - mu*abs(s)", {"e": span(0, 1)}, (True, False)),  # 0 multiplied through
        ("where(e*a/(e - 2) - a <= 0, 2*a, -a) + abs(b) - mu*abs(s)", {"e": span(0, 1)}, (True, False)),  # by what is < 0
    ],
)
def test_kinks_and_seams(g: str, parameters: dict[str, Any], expected: tuple[bool, bool]) -> None:
    assert judged(law(g, mu=POSITIVE, **parameters)) == expected


@pytest.mark.parametrize(
    ("g", "parameters"),
    [
        ("norm(a, b) + a*b/a - abs(s)", {}),  # undefined on a ray
        ("norm(a, b) + 0/a - abs(s)", {}),
        ("norm(a, b) + 0*sqrt(a) - abs(s)", {}),
        ("norm(a, b)**2/norm(a, 2*a) - abs(s)", {}),
        ("norm(a, b)*(e/e) - abs(s)", {"e": span(0, 1)}),
        ("norm(a, b) - e*abs(s)", {"e": span(0, 1)}),  # K may be a point
        ("norm(a, b) + e*a - abs(s)", {"e": span(0, 1)}),  # and unbounded
        ("abs(a) - abs(s)", {}),
        ("norm(e*a, b) - abs(s)", {"e": span(0, 1)}),
        ("norm(a, b) + abs(s)", {}),
        ("-norm(a, b) + abs(s)", {}),
        ("norm(a, b) + a**2 - abs(s)", {}),  # three degrees
        ("exp(norm(a, b)) - abs(s)", {}),
        ("norm(a, b)*(1 + where(a > 1, 1, 0)) - abs(s)", {}),  # a step, not along rays
        ("where(a > 0, norm(a, b), 2*norm(a, b)) - abs(s)", {}),  # a jump
        ("where(a >= 0, where(a > 0, norm(a, b), 2*norm(a, b)), norm(a, b)) - abs(s)", {}),  # on one ray only
        ("where(a*a <= 0, 2*norm(a, b), norm(a, b)) - abs(s)", {}),
        ("norm(a, b)*(1 + e*a/abs(a)) - abs(s)", {"e": span(0, "1/2")}),
        ("norm(a, b)*where(a > 2*b, where(2*b < a, 1, 2), 1) + where(a >= 3*b, norm(a, b), 0) - abs(s)", {}),
    ],
)
def test_what_is_no_gauge_is_not_taken_for_one(g: str, parameters: dict[str, Any]) -> None:
    assert judged(law(g, **parameters)) is None


@pytest.mark.parametrize(
    ("g", "star"),
    [
        ("max(abs(s1 - s2), abs(s2 - s3), abs(s3 - s1)) - 1", True),
        ("norm(s1 - s2, s2 - s3) + 0/(s3 - 1) - 1", False),  # the same on s3 = 0, undefined elsewhere
        ("norm(s1 - s2, s2 - s3) + 0*sqrt(s3) - 1", False),
        ("norm(s1 - s2, s2) - 1", False),
        ("norm(s1 - 2*s2, s2 - 2*s3) - 1", False),
    ],
)
def test_three_forces_of_which_only_differences_count(g: str, star: bool) -> None:
    assert (judged(law(g, forces=THREE)) is not None) is star


@pytest.mark.parametrize(
    ("g", "closed"),
    [
        ("norm(a, b) + a*b/norm(a, b) - abs(s)", True),
        ("norm(a, b) - abs(s)", False),
        ("where(norm(a, b) > 0, norm(a, b) - abs(s), 1/norm(a, b))", False),
        ("norm(a, b) + 0*a - abs(s)/(1 + norm(a, b))", False),
    ],
)
def test_zero_force_belongs_to_k_by_closure_only_where_nothing_else_is_said(g: str, closed: bool) -> None:
    assert divides_by_zero_force(law(g).g, over(law(g))) is closed


def test_a_value_at_zero_force_counts() -> None:
    stated = law("where(norm(a, b) > 0, norm(a, b), 2*abs(s)) - abs(s)")  # a disc without its centre
    for claim in ("origin", "convexity", "smoothness"):  # at zero force there is no power
        assert all(objection(claim, rule, frozenset(), stated, {}) for rule in rules_of(claim, stated))


def test_a_flow_of_its_own_is_no_gradient() -> None:
    settled = frozenset({"origin"})
    assert objection("dissipation", "homogeneity", settled, law("norm(a, b) - abs(s)"), {}) == ""
    assert objection("dissipation", "homogeneity", settled, law("norm(a, b) - abs(s)", flow=["-a", "-b"]), {})


# -- drawn gauges, in exact arithmetic ---------------------------------------------------------------------------------


def value(term: Term, at: Mapping[str, F]) -> F:
    """Of a formula without roots other than norms that are rational."""
    if term.op == "number":
        return term.value
    if term.op == "name":
        return at[term.name]
    x = [value(a, at) for a in term.args]
    if term.op == "norm":
        square = sum((v * v for v in x), F(0))
        root = F(isqrt(square.numerator), isqrt(square.denominator))
        assert root * root == square
        return root
    if term.op in (">", ">="):
        return F(x[0] > x[1] or (term.op == ">=" and x[0] == x[1]))
    words = {
        "+": lambda: sum(x, F(0)), "*": lambda: prod(x, start=F(1)), "**": lambda: x[0] ** int(x[1]), "abs": lambda: abs(x[0]),
        "pos": lambda: max(x[0], F(0)), "neg": lambda: max(-x[0], F(0)), "max": lambda: max(x), "min": lambda: min(x),
        "where": lambda: x[1] if x[0] else x[2],
    }  # fmt: skip
    return words[term.op]()


_LEAVES = ("a", "b", "norm(a, b)", "a - b", "a*b/norm(a, b)", "b**2/norm(a, b)", "a**3/norm(a, b)**2", "e*a", "e*norm(a, b)")


def drawn_gauge(rng: Random, depth: int) -> str:
    """A formula of degree 1 whose value is rational wherever norm(a, b) is."""
    share = F(rng.randint(-4, 4), rng.choice((2, 3, 5)))
    if depth == 0:
        return rng.choice(
            ("a", "b", "norm(a, b)", "a - b", "a*b/norm(a, b)", "b**2/norm(a, b)", "a**3/norm(a, b)**2", "e*a", "e*norm(a, b)")
        )
    one, two = drawn_gauge(rng, depth - 1), drawn_gauge(rng, rng.randrange(depth))
    shape = rng.random()
    if shape < 0.35:
        return f"({one} + ({share})*({two}))"
    if shape < 0.55:
        return f"{rng.choice(('abs', 'pos', 'neg'))}({one})"
    if shape < 0.75:
        return f"{rng.choice(('max', 'min'))}({one}, {two})"
    if shape < 0.85:
        return f"where({rng.choice(('a', 'b', 'a - b', 'norm(a, b) - 2*a'))} {rng.choice(('>', '>='))} 0, {one}, {two})"
    return f"({one})*({two})/norm(a, b)"


RAYS = sorted(
    {F(i, j) for j in (1, 2, 3, 7) for i in range(-j, j + 1)} | {F(10**6 + k, 2 * 10**6) for k in (-1, 1)} | {F(k, 10**6) for k in (-1, 1)}
)


def drawn_gauges(seed: int, count: int) -> tuple[list[int], list[str]]:
    """How many are shown to be a gauge, convex and smooth, and what is false in that."""
    rng, shown, wrong = Random(seed), [0, 0, 0], list[str]()
    for _ in range(count):
        size = F(rng.randint(1, 12), 2)
        text = f"({size})*norm(a, b) + {drawn_gauge(rng, rng.randint(1, 3))}"
        found, formula = judged(law(f"{text} - abs(s)", e=span(0, "1/2"))), parse(text)
        if found is None:
            continue
        for i, claim in enumerate((True, *found)):
            shown[i] += claim
        for e in (F(0), F(1, 2), F(rng.randint(0, 8), 16)):
            turned = [(side * (1 - t * t), side * 2 * t) for side in (1, -1) for t in RAYS]
            values = [value(formula, {"a": x, "b": y, "e": e}) for x, y in turned]
            if min(values) <= 0:
                wrong.append(f"{text} <= 0 at {e}")
            for k in range(len(turned) if found[0] else 0):
                for far in (1, 4):
                    i, j = k - far, (k + far) % len(turned)
                    (x, y), (u, v), (p, q) = turned[i], turned[j], turned[k]
                    det = x * v - y * u
                    if det > 0:  # the middle ray is a sum of the outer ones
                        alpha, beta = (p * v - q * u) / det, (x * q - y * p) / det
                        if alpha >= 0 and beta >= 0 and values[k] > alpha * values[i] + beta * values[j]:
                            wrong.append(f"{text} not convex at {p, q}, {e}")
    return shown, wrong[:5]


@pytest.mark.slow
@pytest.mark.parametrize("count", mostly_long([24, 60], 24))
def test_what_is_shown_of_drawn_gauges_holds_on_drawn_rays(count: int) -> None:
    shown, wrong = drawn_gauges(1, count)
    assert wrong == []
    assert min(shown) > count / 12


# -- seams that are roots ----------------------------------------------------------------------------------------------

R, GAUGE = "norm(a, b)", "(norm(a, b) + {e}*a)"


def bridged(e: F, line_off: F | int = 0, cone_off: F | int = 0) -> StatedLaw:
    """A limacon whose dent is bridged by -4 e a <= m |s| where 2 e a <= -r: exactly, or by a line or in a cone that is off."""
    under, line, cone = GAUGE.format(e=e), f"{-4 * e * (1 + line_off)}*a", f"({-2 * e}*a - {1 + cone_off}*{R})"
    return law(f"max({line}*{under}, {R}**2 - 20*pos({cone})*{under}) - m*abs(s)*{under}", m=POSITIVE)


@pytest.mark.parametrize("e", [F(4, 5), F(5, 8), F(3, 5), F(9, 10)])
def test_a_boundary_is_seen_to_go_on_smoothly_where_a_line_touches_it(e: F) -> None:
    assert judged(bridged(e)) == (True, True)  # the seam is a root of 3 t^2 = 13 and the like, where gamma' does not jump


@pytest.mark.parametrize("off", [F(1, 10**k) for k in (2, 4, 8, 12)])
def test_a_line_or_a_cone_that_is_off_is_not_taken_for_one_that_touches(off: F) -> None:
    for wrong in (bridged(F(4, 5), line_off=-off), bridged(F(4, 5), cone_off=off), bridged(F(4, 5), cone_off=-off)):
        assert judged(wrong) in (None, (False, False))  # a corner that turns inward, or a jump
    assert judged(bridged(F(4, 5), line_off=off)) in (None, (True, False))  # the line cuts K, in corners that turn outward


def test_a_jump_between_two_seams_that_come_together_is_seen() -> None:
    for c in (F(1701, 1000), F(1999, 1000), 2 - F(1, 10**6), 2 - F(1, 10**9)):  # of 2 the line b = m |s| touches the circle
        assert judged(law(f"max({R}, {2 / c}*b) - m*abs(s)", m=POSITIVE)) in (None, (True, False))
        assert judged(law(f"{R} - pos(2*b - {c}*{R})/4 - m*abs(s)", m=POSITIVE)) in (None, (False, False))
    assert judged(law(f"max({R}, b) - m*abs(s)", m=POSITIVE)) == (True, True)


def test_a_maximum_of_many_arms_is_left_to_other_rules() -> None:
    arms = ", ".join(f"{F(k, 7)}*a + {F(30 - k, 11)}*b" for k in range(30))
    assert judged(law(f"max({arms}, -a, -b) - m*abs(s)", m=POSITIVE)) is None
