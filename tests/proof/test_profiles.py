"""Bodies with a profile along a load, {Q <= h(t)}: kernel and prover against h at many places, and neighbours that are not convex."""

from __future__ import annotations

from random import Random

import pytest

from duhem import Criterion, verify
from duhem.law.domain import POSITIVE, Domain
from duhem.proof.certificate import law_as_text
from duhem.proof.kernel.claims import convexity
from duhem.proof.kernel.stated_law import StatedLaw
from duhem.proof.verdict import Trust, Verdict
from tests.long import long_but
from tests.oracles.prover.curvature import convex_in_its_region
from tests.oracles.prover.decide import AskedSubject

DROP = "max(((a - b)/2)**2 - ((a + b)/2)**2*(1 + (a + b)/(2*P)), a + b)"  # Rothrock (1975)
P = {"P": POSITIVE}

CASES = [
    (DROP, P, True),
    (DROP.replace("2*P", "2"), {}, True),
    (DROP.replace(", a + b)", ", a + b - P/1000)"), P, False),  # a second body beyond the point
    (DROP.replace(", a + b)", ", a + b + P/1000)"), P, True),
    (DROP.replace(", a + b)", ", -a - b)"), P, False),  # the body without an end
    (DROP.replace(", a + b)", ", a)"), P, False),  # no end of a + b
    (DROP.replace(", a + b)", ", a, a + b)"), P, True),
    (DROP, {"P": Domain.between(-1, 1)}, False),
    (DROP.replace("(a - b)/2", "(a - b + (a + b)**2)/2"), P, False),  # what is squared is not affine
    (DROP.replace("((a - b)/2)**2", "(-((a - b)/2)**2)"), P, False),
    ("max(a**2 - b**2*(1 + b)*(2 - b), -b)", {}, False),  # the profile bends outward at the point
    ("max(a**2 - b**2, b)", {}, True),
    ("max(a**2 - b**2, b - 1/1000)", {}, False),
    ("max(a**2 - b**2 - 1/1000, b)", {}, False),  # one sheet of a hyperbola: outward
    ("max(a**2 - b**2 + 1/1000, b)", {}, True),
    ("a**2 - b**2 + 1/1000", {}, False),  # both sheets
    ("a**2 - b**2*(1 - b**2)", {}, False),  # two drops that touch
    ("a**2 + b**2*(1 - b)**2*(2 - b)", {}, False),  # two points and a half-line
    ("max(a**2 + b**2*(1 - b)**2, b - 1/2)", {}, True),  # one point
    ("max(a**2 + b**2*(1 - b)**2, b - 1)", {}, False),  # two, one at the end
    ("a**2 - (1 - b**2)*(4 - b**2)", {}, False),  # a lens, and what lies beyond 2
    ("max(a**2 - (1 - b**2)*(4 - b**2), b - 1, -b - 1)", {}, True),
    ("a**2 - (1 - b**2)*(2 - b**2/2)", {}, False),
    ("max(a**2 - b*(1 - b)**3, -b, b - 1)", {}, False),  # a cusp at 1
    ("max(a**2 - b*(1 - b)**2, -b, b - 1)", {}, True),
    ("(a + b)**2 - (2*a + b)*(1 - (2*a + b)**3)", {}, True),  # no load is given: h is of degree 4 in 2 a + b
    ("(a + b)**2 - (2*a + b)*(1 - 2*(2*a + b)**2 - (2*a + b)**3)", {}, False),
    ("max(a**2 + a*c + c**2 - b**2*(1 + b), b)", {}, True),
    ("max(a**2 + 2*a*c + c**2 - b**2*(1 + b), b)", {}, True),  # a cylinder
    ("max(a**2 + 3*a*c + c**2 - b**2*(1 + b), b)", {}, False),  # Q is no sum of squares
    ("max(a**2 + c**2 + a*b**2 - b**2*(1 + b), b)", {}, False),
    ("max(a**2 + k*c**2 - b**2*(1 + b), b)", {"k": POSITIVE}, True),
    ("max(a**2 + k*c**2 - b**2*(1 + b), b)", {"k": Domain.between(-1, 1)}, False),
]  # fmt: skip


def law(g: str, parameters: dict[str, Domain]) -> Criterion:
    return Criterion(name="law", g=g, forces=("a", "b", "c") if "c" in g else ("a", "b"), pressure=None, parameters=parameters)


def by_kernel(criterion: Criterion) -> bool:
    return convexity(StatedLaw.read(law_as_text(criterion)), {})


def by_prover(criterion: Criterion) -> bool:
    subject = AskedSubject(criterion)
    subject.allow(16_000_000)
    return convex_in_its_region(subject).quasiconvex


@pytest.mark.slow
@pytest.mark.parametrize(("g", "parameters", "convex"), long_but([1, 5, 9, 11, 13, 15, 17, 20, 22, 24, 26, 27, 29, 31], CASES))
def test_a_body_is_convex_where_its_profile_is(g: str, parameters: dict[str, Domain], convex: bool) -> None:
    assert by_kernel(law(g, parameters)) is convex
    assert by_prover(law(g, parameters)) is convex


def profile_seen(h: list[int], low: int, high: int) -> bool | None:
    """Whether h has a convex profile between two ends, as its values at many places say; None where it is >= 0 at no more than two."""
    steps = 1680  # halves are among the places
    t = [low * steps + i * (high - low) for i in range(steps + 1)]  # times the steps
    values, first, second = (_values(p, t, steps) for p in (h, _slope(h), _slope(_slope(h))))
    inside = [i for i, v in enumerate(values) if v >= 0]
    if len(inside) < 3:
        return None
    if inside[-1] - inside[0] >= len(inside) or any(values[i] == 0 for i in inside[1:-1]):
        return False
    return all(first[i] ** 2 >= 2 * values[i] * second[i] for i in inside)


def _values(p: list[int], t: list[int], steps: int) -> list[int]:
    """Times a power of the steps."""
    top = len(p) - 1
    return [sum(c * x**k * steps ** (top - k) for k, c in enumerate(p)) for x in t]


def _slope(p: list[int]) -> list[int]:
    return [k * c for k, c in enumerate(p)][1:]


@pytest.mark.slow
def test_the_kernel_says_what_values_say() -> None:
    random, found = Random(5), list[bool]()
    while len(found) < 40:
        low, high = sorted(random.sample(range(-4, 5), 2))
        h = [random.choice((1, -1))]
        for _ in range(random.randint(1, 4)):
            root = random.choice([2 * low, 2 * high, random.randint(-8, 8)])  # twice that
            h = [2 * a - root * b for a, b in zip([0, *h], [*h, 0], strict=True)]
        h[0] += random.choice((0, 0, 1))
        if (seen := profile_seen(h, low, high)) is None:
            continue
        text = " + ".join(f"({c})*b**{k}" for k, c in enumerate(h))
        g = f"max(a**2 - ({text}), b - ({high}), ({low}) - b)"
        stated = {"forces": ["a", "b"], "pressure": None, "g": g, "flow": None, "parameters": {}, "constraints": []}
        found.append(convexity(StatedLaw.read(stated), {}))
        assert found[-1] is seen, (text, low, high)
    assert min(found.count(True), found.count(False)) > 8


def test_a_drop_for_every_strength() -> None:
    result = verify(law(DROP, P), claims=["convexity", "normality", "dissipation"])
    assert {r.verdict for r in result.results} == {Verdict.PROVED}
    assert {r.trust for r in result.results} == {Trust.CHECKED}
