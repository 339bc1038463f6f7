"""Where the kernel says a parameter lies: every value that the domain and the constraints admit is there."""

from __future__ import annotations

from fractions import Fraction
from random import Random
from typing import Any

import pytest

from duhem.proof.kernel.bounds import ANY, NEGATIVE, POSITIVE, ZERO, Bounds
from duhem.proof.kernel.constant_value import exact_value
from duhem.proof.kernel.curvature import over
from duhem.proof.kernel.stated_law import StatedLaw, inhabited
from duhem.proof.kernel.term import NotWritten, Term, number, parse
from tests.long import mostly_long

F = Fraction
UNIT, WIDE = {"min": "0", "max": "1"}, {"min": "-5", "max": "5"}


def law(*constraints: str, **parameters: Any) -> StatedLaw:
    given = {"forces": ["a"], "pressure": None, "parameters": parameters, "constraints": list(constraints), "g": "abs(a) - 1", "flow": None}
    return StatedLaw.read(given)


@pytest.mark.parametrize(
    ("constraints", "parameters", "expected"),
    [
        (["x <= 1/2 - y"], {"x": WIDE, "y": UNIT}, (-5, F(1, 2), False, False)),
        (["x + y < 1/2"], {"x": WIDE, "y": UNIT}, (-5, F(1, 2), False, True)),
        (["x <= y", "x >= y - 1/1000"], {"x": WIDE, "y": {"min": "-2", "max": "3"}}, (F(-2001, 1000), 3, False, False)),
        (["x*y <= 2"], {"x": WIDE, "y": {"min": "1", "max": "2"}}, (-5, 2, False, False)),
        (["x*y <= -2"], {"x": WIDE, "y": {"min": "1", "max": "2"}}, (-5, -1, False, False)),
        (["x*y <= 2"], {"x": WIDE, "y": UNIT}, (-5, 5, False, False)),  # y may be 0
        (["-x*y <= 2"], {"x": WIDE, "y": {"min": "1", "max": "2"}}, (-2, 5, False, False)),
        (["(x - 1/3)**2 <= (2/3)**2"], {"x": WIDE}, (F(-1, 3), 1, False, False)),
        (["x**2 < 4/9"], {"x": WIDE}, (F(-2, 3), F(2, 3), True, True)),
        (["x**2 > 4/9"], {"x": WIDE}, (-5, 5, False, False)),
        (["x > 0"], {"x": WIDE}, (0, 5, True, False)),
        (["x >= 0", "x > 0"], {"x": WIDE}, (0, 5, True, False)),
        (["x < y", "y < z", "z < 1"], {"x": WIDE, "y": WIDE, "z": WIDE}, (-5, 1, False, True)),
        (["x < y"], {"x": WIDE, "y": {"value": "2"}}, (-5, 2, False, True)),
        (["x < y"], {"x": WIDE, "y": {"positive": True}}, (-5, 5, False, False)),
        (["1/x > 1"], {"x": WIDE}, (-5, 5, False, False)),
        (["x*x*x > 1"], {"x": WIDE}, (-5, 5, False, False)),
        (["sqrt(x) > 1"], {"x": WIDE}, (-5, 5, False, False)),
        (["abs(x) < 3/2"], {"x": WIDE}, (F(-3, 2), F(3, 2), True, True)),
        (["abs(x - 1) + y <= 2"], {"x": WIDE, "y": UNIT}, (-1, 3, False, False)),
        (["abs(x) > 3/2"], {"x": WIDE}, (-5, 5, False, False)),
        (["y*abs(x) - abs(x) < 1"], {"x": WIDE, "y": UNIT}, (-5, 5, False, False)),  # |x| stands twice
    ],
    ids=str,
)
def test_where_a_parameter_lies(constraints: list[str], parameters: dict[str, Any], expected: tuple[Any, ...]) -> None:
    assert tuple(over(law(*constraints, **parameters)).bounds["x"]) == expected


def test_an_inexact_root_is_enclosed() -> None:
    known = over(law("x**2 < 2", x=WIDE)).bounds["x"]
    assert known.low is not None and known.high is not None
    assert known.low**2 >= 2 and known.high**2 >= 2
    assert not known.open and not known.open_high


@pytest.mark.parametrize("constraints", [("x > 5",), ("x**2 < 1", "x > 1")])
def test_an_empty_domain_proves_nothing(constraints: tuple[str, ...]) -> None:
    with pytest.raises(NotWritten):
        over(law(*constraints, x=WIDE, y=WIDE))


FREE = {"x": {}, "y": {"positive": True}, "z": {}}
SQUARE = "y**2 - x**2"


@pytest.mark.parametrize(
    ("constraints", "constant", "sign"),
    [
        (["x <= y", "-y <= x"], SQUARE, ZERO | POSITIVE),
        (["x < y", "-y < x"], SQUARE, POSITIVE),
        (["x < y", "-y <= x"], SQUARE, ZERO | POSITIVE),
        (["abs(x) < y"], SQUARE, POSITIVE),
        (["abs(x/y) <= 1"], SQUARE, ZERO | POSITIVE),
        (["abs(x) < y"], "1 - x**2/y**2", POSITIVE),
        (["abs(x - z) <= y"], "y**2 - x**2 + 2*x*z - z**2", ZERO | POSITIVE),
        (["x**3 <= y**3", "-y**3 <= x**3"], "y**6 - x**6", ZERO | POSITIVE),
        (["abs(x) < z"], "z", POSITIVE),
        (["abs(x) + 3*abs(z) <= y"], "y + x - 2*z", ZERO | POSITIVE),
        (["5*abs(x) + 17*abs(z) < y"], "y + x - 3*z", POSITIVE),
        (["5*abs(x) + 17*abs(z) < y"], "y + 5*x + 18*z", ANY),
        (["5*abs(x) - 17*abs(z) < y"], "y + x", ANY),
        (["5*abs(x) <= y"], "y**2 - 6*x*y + 5*x**2", ZERO | POSITIVE),
        (["4*abs(x) <= y"], "y**2 - 6*x*y + 5*x**2", ANY),
        (["x < y"], SQUARE, ANY),
        (["x < y", "x < 2*y"], SQUARE, ANY),
        (["x <= y", "-2*y <= x"], SQUARE, ANY),
        (["abs(x) > y"], SQUARE, ANY),
        (["y <= abs(x)", "abs(x) <= 2*y"], SQUARE, ANY),
        (["abs(x) <= z"], "z**2 - 2*x**2", ANY),
    ],
    ids=str,
)
def test_what_two_constraints_say_of_a_square(constraints: list[str], constant: str, sign: int) -> None:
    """A bound from either side, or one of a size: neither alone says it.  The last ones are false somewhere."""
    known = law(*constraints, **FREE)
    assert over(known).sign(parse(constant)) == sign


@pytest.mark.long
def test_signs_that_follow_of_two_constraints_hold_wherever_they_do() -> None:
    rng, seen, told = Random(5), 0, 0
    for _ in range(12):
        p, q, c, d = *rng.sample("xz", 2), rng.randint(1, 3), rng.randint(0, 2)
        one, two = (f"{rng.randint(1, 3)}*{rng.choice(('y', q))} + {rng.randint(0, 2)}" for _ in range(2))
        both = [f"{p} - {d}*{q} <= {one}", f"-({two}) < {p} - {d}*{q}"]
        stated = law(*rng.choice((both, [f"abs({p} - {d}*{q}) <= {one}"])), **FREE)
        for other in rng.sample((one, two), 2):
            constant = f"({one})*({other}) - {p}**2 + 2*{d}*{p}*{q} - {d * d}*{q}**2 + {c - 2}*({one} - ({other}))*({p} - {d}*{q})"
            sign = over(stated).sign(parse(constant))
            told += sign != ANY
            for point in ({n: F(rng.randint(-12, 12), 4) for n in "xyz"} for _ in range(30)):
                if inhabited(stated.parameters, stated.constraints, point):
                    seen += 1
                    value = exact_value(parse(constant).put({Term("name", name=n): number(x) for n, x in point.items()}))
                    assert sign & (POSITIVE if value > 0 else NEGATIVE if value < 0 else ZERO), (stated.constraints, constant, point)
    assert seen > 100 and told > 5


@pytest.mark.slow
@pytest.mark.parametrize("count", mostly_long([40, 100], 40))
def test_no_admitted_point_is_left_out(count: int) -> None:
    rng, admitted, signs = Random(2), 0, ("<", "<=", ">", ">=")
    for _ in range(count):
        domains = {n: rng.choice((UNIT, WIDE, {"min": "1", "max": "2"}, {"positive": True}, {"max": "2"})) for n in ("x", "y", "z")}
        shapes = (
            "{p} {r} {q} + {c}",
            "{p}*{q} {r} {c}",
            "({p} - {c})**2 {r} {d}",
            "{c}*{p} - {d}*{q} {r} {p}",
            "{p}*({q} - {c}) {r} {d}*{p}",
        )
        constraints = [
            rng.choice(shapes).format(
                p=rng.choice("xyz"), q=rng.choice("xyz"), r=rng.choice(signs), c=rng.randint(-2, 2), d=rng.randint(0, 3)
            )
            for _ in range(rng.randint(1, 3))
        ]
        stated = law(*constraints, **domains)
        points = [{n: F(rng.randint(-10, 10), rng.choice((1, 2, 3))) for n in "xyz"} for _ in range(60)]
        inside = [p for p in points if inhabited(stated.parameters, stated.constraints, p)]
        admitted += len(inside)
        if inside:
            bounds = over(stated).bounds
            assert [(constraints, point) for point in inside for n, x in point.items() if not bounds[n].holds(x)] == []
    assert admitted > count


def test_a_range_that_covers_another_holds_every_number_of_it() -> None:
    ends = [None, *map(F, range(-1, 2))]
    ranges = [
        Bounds(low, high, low is not None and left_out, high is not None and high_left_out)
        for low in ends
        for high in ends
        for left_out in (False, True)
        for high_left_out in (False, True)
    ]
    numbers = [F(k, 4) for k in range(-12, 13)]
    inside = {own: {x for x in numbers if own.holds(x)} for own in ranges}
    for one in ranges:
        for other in ranges:
            if inside[other]:  # of an empty one nothing is asked
                assert one.covers(other) == (inside[other] <= inside[one])
