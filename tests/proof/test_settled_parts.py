"""Rules that multiply out, go to ends of ranges or look along a load: what they must not lose sight of."""

from __future__ import annotations

import re
from typing import Any

import pytest

from duhem import Criterion, Domain, verify
from duhem.proof.kernel.claims import objection
from duhem.proof.kernel.stated_law import StatedLaw
from tests.long import long_at, long_but

X = "(max(a, b, c) - (a + b + c)/3)"
J = "((a - b)**2 + (b - c)**2 + (c - a)**2)"
RANGE = {"q": Domain(low=0, high=1)}
JUMPING = [
    "where(q > 0, 1, -1)*(max(a, b, 0) - (a + b)/3) + abs(a + b) - 1",
    f"where(q > 0, 1, -1)*{X} + abs(a + b + c) - 1",
    f"where(q < 1, 1, -1)*{X} + abs(a + b + c) - 1",
    f"(atan2(q - 1, -1) + 3)*{X} + abs(a + b + c) - 1",
]


def stated(g: str, **more: object) -> Criterion:
    return Criterion(name="law", g=g, forces=forces(g), pressure=None, parameters=RANGE if "q" in g else {}, **more)  # type: ignore[arg-type]


def forces(g: str) -> tuple[str, ...]:
    return tuple(sorted(set(re.findall(r"\b[abctu]\b", g))))


def refused(claim: str, rule: str, g: str, settled: frozenset[str] = frozenset(), flow: list[str] | None = None, **evidence: Any) -> bool:
    """By the kernel alone, which knows nothing but the text."""
    parameters = {"q": {"min": "0", "max": "1"}} if "q" in g else {}
    law = {"name": "law", "forces": forces(g), "pressure": None, "parameters": parameters, "constraints": [], "g": g, "flow": flow}
    return bool(objection(claim, rule, settled, StatedLaw.read(law), evidence))


@pytest.mark.slow
@pytest.mark.parametrize("g", long_but([0, 2], JUMPING))
def test_what_jumps_at_the_end_of_a_range_is_not_its_limit(g: str) -> None:
    assert refused("convexity", "composition", g)


@pytest.mark.slow
def test_such_a_law_is_refuted_at_that_end() -> None:
    assert verify(stated(JUMPING[0]), claims=["convexity"])["convexity"].verdict.value == "refuted"


@pytest.mark.slow
@pytest.mark.parametrize(
    "g",
    long_but([0, 3, 4, 7], [
        f"exp(1/0)*{J} - 1", f"exp(log(-1 - q**2))*{J} - 1", f"exp(sqrt(q - 1/2))*{J} - 1", f"exp(log(-1))*{X} - 1",
        "(max(a*b/b, b, c) - (a + b + c)/3)**2 - 1", "(max(a + b**2/b - b, b, c) - (a + b + c)/3)**2 - 1",
        f"where({J} > 0, {J}, 0*log(a)) - 1", f"where({J} > 0, {J}, 1/0*0) - 1",
    ]),
)  # fmt: skip
def test_what_has_no_value_is_asked_before_it_cancels(g: str) -> None:
    for claim, rule in (("convexity", "composition"), ("origin", "evaluation"), ("smoothness", "composition")):
        assert refused(claim, rule, g)


def test_nothing_is_put_in_a_comparison_by_continuity() -> None:
    third = "(2*a - b - c)*(2*b - a - c)*(2*c - a - b)"
    assert refused("origin", "evaluation", (f"where(({J}**3 + ({third})**2)/{J} > 0, 1 + {J}, -1)"))


@pytest.mark.slow
@pytest.mark.parametrize(
    "g",
    long_at(
        [1],
        [
            "max(-t, t - 1, -2*t - 4, u**3 - (3*t - 1 - t**3)*(t + 1))",
            "max(-t, t - 1, 3 - 4*t, u**3 - (7/16*t - 119/320 - (t - 3/4)**3)*(t + 1))",
            "max(-t, t - 1, 1/3 - t, t - 2/3, u - abs(6*abs(t - 1/3) + 4*abs(2/3 - t) - 5/3))",
        ],
    ),
)
def test_a_function_concave_between_all_loads_is_not_asked_beyond_them(g: str) -> None:
    assert refused("convexity", "composition", g)
    assert verify(stated(g), claims=["convexity"])["convexity"].verdict.value != "proved"


@pytest.mark.parametrize(
    "g",
    [
        "where(a >= 0 and a <= 0, (abs(b) - 1)**2*(abs(b) - 3), abs(a) + abs(b) - 1)",
        "where(a >= 0 and a <= 0, (b**2 - 1)*(b**2 - 1/4), norm(a, b) - 1)",
    ],
)
def test_a_formula_on_a_ray_is_of_the_degree_of_its_neighbours(g: str) -> None:
    assert refused("convexity", "fan", g, frozenset({"origin"}))


def test_an_angle_that_may_jump_lets_no_power_follow_from_g() -> None:
    g, flow = "-a*atan2(1 - a, -1)", ["-atan2(1 - a, -1)"]
    assert refused("dissipation", "power-share", g, flow=flow, share="1", rest="0")
    outward = [{"strict": ["the goal"], "sums": [], "multiples": [{"of": "the boundary", "by": "1"}]}]
    assert refused("dissipation", "boundary-power", g, flow=flow, outward=outward)


def test_a_number_of_too_many_digits_is_not_written_out() -> None:
    assert refused("origin", "evaluation", ("abs(a) + sqrt(3) - (((2**200)**200)**200)**150"))
