"""Where the kernel says a parameter lies: every value that the domain and the constraints admit is there."""

from __future__ import annotations

from fractions import Fraction
from random import Random
from typing import Any

import pytest

from duhem.proof.kernel.bounds import Bounds
from duhem.proof.kernel.curvature import over
from duhem.proof.kernel.stated_law import StatedLaw, inhabited
from duhem.proof.kernel.term import NotWritten
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
