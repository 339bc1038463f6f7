"""K within the region that loads in g leave: caps, meridians between two ends, logarithms of a load; and neighbours that are not convex."""

from __future__ import annotations

from random import Random

import pytest

from duhem import Criterion
from duhem.law.domain import POSITIVE, Domain
from duhem.proof.certificate import law_as_text
from duhem.proof.kernel.claims import convexity
from duhem.proof.kernel.stated_law import StatedLaw
from tests.long import long_but, mostly_slow
from tests.oracles import drawn_formulas
from tests.oracles.prover.curvature import convex_in_its_region, curvature
from tests.oracles.prover.decide import AskedSubject

between = Domain.between
ALPHA, M = {"A": between(0, 2)}, {"m": between(2, 2)}
MERIDIAN = "sqrt(pos((P - pos(P)**m)*(2*(1 - A)*P + A)))"  # Bigoni, Piccolroaz (2004)
CAP = f"max(norm(a, b) - {MERIDIAN}, -P, P - 1)"

CASES = [
    (CAP, {**ALPHA, **M}, True),
    (CAP, {"A": between(0, "2.001"), **M}, False),  # the factor falls below 0 at the one end
    (CAP, {"A": between("-0.001", 1), **M}, False),
    (CAP.replace("P - pos(P)**m", "P - 1.01*pos(P)**m"), {**ALPHA, **M}, False),  # no more >= 0 up to the end
    (CAP.replace("norm(a, b)", "norm(a, b) - abs(a)/2"), {**ALPHA, **M}, False),
    (CAP.replace(", -P,", ","), {**ALPHA, **M}, False),  # one end is missing
    (CAP.replace("P - 1)", "P + a - 1)"), {**ALPHA, **M}, False),  # the other end is no end of P
    (CAP.replace("sqrt(pos(", "(pos(").replace("+ A)))", "+ A)))**(0.51)"), {**ALPHA, **M}, False),  # two factors to more than 1/2
    ("norm(a, b) + k*p*log(p/c)", {"k": POSITIVE, "c": POSITIVE}, True),  # Roscoe, Schofield (1963)
    ("norm(a, b) - k*p*log(p/c)", {"k": POSITIVE, "c": POSITIVE}, False),
    ("norm(a, b) + k*p*log((p + a)/c)", {"k": POSITIVE, "c": POSITIVE}, False),
    ("norm(a, b) + k*p*log(abs(p))", {"k": POSITIVE}, False),
    ("norm(a, b) + where(p > 1, p*log(p), 0)", {}, False),
    ("max(a**2 - p*b, -p)", {}, False),
    ("max(norm(a, b) + sqrt(p) - 1, -p)", {}, False),  # >= 0 in the region alone, and no seminorm
    ("max(norm(a, b) + sqrt(p*(1 - p)) - 1, -p, p - 1)", {}, False),
    ("max(b + sqrt(p**2 + a**2) - 1, -p)", {}, True),
    ("max(a**2/p + b**2 - 1, -p)", {}, True),  # it divides by 0 at the end, where K has no point
]  # fmt: skip


def law(g: str, parameters: dict[str, Domain]) -> Criterion:
    g = g.replace("P", "((p + 1/2)/2)")
    return Criterion(name="law", g=g, forces=("a", "b", "p"), pressure=None, parameters={n: d for n, d in parameters.items() if n in g})


@pytest.mark.parametrize(("g", "parameters", "convex"), long_but([1, 5, 8, 9, 12, 16, 17], mostly_slow(CASES, *CASES[::4])))
def test_a_region_is_where_its_loads_say(g: str, parameters: dict[str, Domain], convex: bool) -> None:
    criterion = law(g, parameters)
    assert convexity(StatedLaw.read(law_as_text(criterion)), {}) is convex


ASKED = [case for case in CASES if "where" not in case[0]]


@pytest.mark.slow
@pytest.mark.parametrize(("g", "parameters", "convex"), long_but([8, 9, 11, 13, 15, 16], ASKED))
def test_the_prover_agrees(g: str, parameters: dict[str, Domain], convex: bool) -> None:
    subject = AskedSubject(law(g, parameters))
    subject.allow(20_000_000)
    shown = curvature(subject.simple.g, subject).quasiconvex or convex_in_its_region(subject).quasiconvex
    assert shown is convex or "/p" in g  # that a formula has a value is asked elsewhere


def drawn(rng: Random) -> str:
    """A cap on a meridian of powers of the load, some of them concave and some not."""
    u = rng.choice(("p", "(p + 1)/2", "(1 - p)"))
    rest = rng.choice((f"({u})*(1 - {u})", f"{u} - pos({u})**({rng.choice(('1/2', '3/2', 3))})", f"({u})*({rng.randint(-1, 2)} + {u})"))
    side = rng.choice(("norm(a, b)", "abs(a) - b", "max(a, b, -a)", "a**2 + abs(b)"))
    root = rng.choice(("1/2", "1/3", "1", "2/3"))
    return f"max({side} - pos({rest})**({root}), -({u}), {u} - 1)"


@pytest.mark.long
def test_chords_do_not_contradict_what_is_shown_of_drawn_caps() -> None:
    rng, shown = Random(11), 0
    for _ in range(40):
        stated = StatedLaw.read(law_as_text(law(drawn(rng), {})))
        if not convexity(stated, {}):
            continue
        shown += 1
        for _ in range(60):
            one, two = ({f: rng.choice((0.0, rng.uniform(-1.2, 1.2))) for f in "abp"} for _ in range(2))
            share = rng.choice((0.5, 0.1))
            middle = {f: one[f] * (1 - share) + two[f] * share for f in one}
            p, q, m = (drawn_formulas.value(stated.g, x) for x in (one, two, middle))
            assert not (p <= 0 and q <= 0) or m <= 1e-9, stated.g
    assert shown > 6
