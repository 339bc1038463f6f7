"""Rules of composition beyond Grant, Boyd, Ye: even functions of roots and bent sums, each with neighbours for which they do not hold.

The kernel and the prover answer separately; what either shows of drawn laws is held against chords.
"""

from __future__ import annotations

import math
from random import Random
from typing import Any

import pytest

from duhem import Criterion
from duhem.law.domain import POSITIVE, REAL, Domain
from duhem.proof.certificate import law_as_text
from duhem.proof.kernel.curvature import over
from duhem.proof.kernel.stated_law import StatedLaw
from tests.long import long_but
from tests.oracles import drawn_formulas
from tests.proof.composed import by_kernel, by_prover

FORCES = ("a", "b", "t")
R = "sqrt(((a - h*b)/2)**2 + (p*t)**2)"
U = "(a + h*b)/2"
PAIR = f"abs({U} + {R})**m + abs({U} - {R})**m"
SIDES = "abs(x) - k*(x)".replace("x", "2*a - b + h*t")


def law(g: str, **parameters: Domain) -> Criterion:
    return Criterion(name="law", g=g, forces=FORCES, pressure=None, parameters=parameters)


SHAPE = {"h": REAL, "p": POSITIVE}
ABOVE_ONE, FROM_BELOW = Domain.between("1", "30"), Domain.between("99/100", "30")
UNIT, BEYOND = Domain.between("-1", "1"), Domain.between("-1", "1.001")

CASES = [
    (f"{PAIR} - 1", {"m": ABOVE_ONE}, True),
    (f"{PAIR} - 1", {"m": FROM_BELOW}, False),
    (f"({PAIR})**(1/m) - 1", {"m": ABOVE_ONE}, True),
    (f"e*({PAIR}) + (2 - e)*abs(2*{R})**m - 1", {"m": ABOVE_ONE, "e": Domain.between("0", "2")}, True),  # Barlat, Lian (1989)
    (f"e*({PAIR}) + (2 - e)*abs(2*{R})**m - 1", {"m": ABOVE_ONE, "e": Domain.between("0", "2.001")}, False),
    (f"max(abs({U} + {R}), abs({R} - {U}), 2*{R}) - 1", {}, True),  # Tresca's in the plane
    (f"abs({U} + {R})**m + abs({U} - 2*{R})**m - 1", {"m": ABOVE_ONE}, False),  # not even
    (f"abs({U} - {R})**m - 1", {"m": ABOVE_ONE}, False),
    (f"exp({R}) + exp(-{R}) - 3", {}, True),
    (f"exp({R}) - exp(-{R}) - 3", {}, False),  # odd: convex, but not by this rule
    (f"abs({U} + {R} - b**2)**m + abs({U} - {R} - b**2)**m - 1", {"m": ABOVE_ONE}, False),  # u not affine
    (f"({SIDES})**m - 1", {"m": ABOVE_ONE, "k": UNIT}, True),
    (f"({SIDES})**m - 1", {"m": ABOVE_ONE, "k": BEYOND}, False),
    (f"({SIDES})**m + abs(t)**m - 1", {"m": FROM_BELOW, "k": UNIT}, False),
    ("b + 3*pos(max(a, b)) - 3*neg(max(a, b)) - 1", {}, True),  # Lubliner et al. (1989)
    ("b + 3*pos(max(a, b)) - 3.001*neg(max(a, b)) - 1", {}, False),
    ("2*pos(max(a, b)) + k*neg(max(a, b)) - 1", {"k": Domain.between("-2", "0")}, True),
    ("2*pos(max(a, b)) + k*neg(max(a, b)) - 1", {"k": Domain.between("-2", "0.001")}, False),  # falls, then rises
    ("2*pos(a - b) + k*neg(a - b) - 1", {"k": Domain.between("-2", "9")}, True),
    ("2*pos(a - b) + k*neg(a - b) - 1", {"k": Domain.between("-2.001", "9")}, False),
    ("abs(min(a, b)) - k*min(a, b) - 1", {"k": Domain.between("1", "2")}, True),
    ("abs(min(a, b)) - k*min(a, b) - 1", {"k": Domain.between("0.999", "2")}, False),
]


@pytest.mark.slow
@pytest.mark.parametrize(("g", "parameters", "convex"), long_but([0, 3, 6, 7, *range(9, 22)], CASES))
def test_a_rule_holds_as_far_as_its_conditions_and_no_further(g: str, parameters: dict[str, Domain], convex: bool) -> None:
    criterion = law(g, **{n: d for n, d in {**SHAPE, **parameters}.items() if n in g})
    shown = by_kernel(criterion)
    assert (shown.defined and shown.quasiconvex) is convex
    assert by_prover(criterion) is convex


@pytest.mark.long
def test_all_coefficients_and_exponents_of_the_planar_eigenvalue_laws() -> None:
    """Barlat et al. (2003) and, in plane stress, (2005): for every m >= 1, whatever the coefficients."""
    names = [f"{x}{i}" for x in "cd" for i in range(1, 6)]

    def pair(x: str) -> tuple[str, str]:
        one, two = f"({x}1*a + {x}2*b)", f"({x}3*a + {x}4*b)"
        return f"({one} + {two})/2", f"sqrt((({one} - {two})/2)**2 + ({x}5*t)**2)"

    (u, r), (v, s) = pair("c"), pair("d")
    eight = f"abs(2*{r})**m + abs(3*({v}) + {s})**m + abs(3*({v}) - {s})**m - 2"
    first, second = (f"({u} + {r})", f"({u} - {r})", "(c1*a - c2*b)"), (f"({v} + {s})", f"({v} - {s})", "(d1*a - d2*b)")
    eighteen = " + ".join(f"abs({x} - {y})**m" for x in first for y in second) + " - 4"
    for g in (eight, eighteen):
        assert by_kernel(law(g, m=ABOVE_ONE, **dict.fromkeys(names, REAL))).quasiconvex
        assert not by_kernel(law(g, m=FROM_BELOW, **dict.fromkeys(names, REAL))).quasiconvex


def drawn(rng: Random) -> str:
    """A sum of powers of u + c r and of |x| - k x, some of them convex."""
    x = f"({rng.randint(-3, 3)}*a + {rng.randint(-2, 2)}*b + {rng.randint(1, 2)}*t)"
    c, m = rng.choice(("", "", "2*")), rng.choice(("0.9", "1", "3/2", "2", "3"))
    one, two = f"abs({x} + {R})", f"abs({x} - {c}{R})"
    k = rng.choice(("0.5", "-0.7", "1", "1.2"))
    bent = rng.choice((f"(abs({x}) - {k}*{x})", f"pos({x}) - {k}*neg({x})", f"pos(max(a, {x})) - {k}*neg(max(a, {x}))"))
    joined = rng.choice((f"{one}**({m}) + {two}**({m})", f"max({one}, {two})", f"norm({one}, {two})"))
    return rng.choice((joined, f"({bent})**({m})" if bent[0] == "(" else bent, f"{joined} + {bent}", f"max({joined}, {bent})"))


@pytest.mark.parametrize("seed", range(2))
@pytest.mark.long
def test_chords_do_not_contradict_what_is_shown_of_drawn_laws(seed: int) -> None:
    rng, shown = Random(seed), 0
    for _ in range(25):
        stated = StatedLaw.read(law_as_text(law(f"{drawn(rng)} - 1".replace("h", "0.8").replace("p*t", "1.3*t"))))
        found = over(stated).facts(stated.g)
        shown += found.defined and found.quasiconvex
        assert not (found.defined and found.quasiconvex) or _chord(stated.g, rng, 40) is None, stated.g
    assert shown > 4


def _chord(g: Any, rng: Random, tries: int) -> str | None:
    """Two points between which g is above its values there, in floats with a margin."""
    for _ in range(tries):
        one, two = ({f: rng.choice((0.0, 1.0, rng.gauss(0, 1))) for f in FORCES} for _ in range(2))
        if rng.random() < 0.3:  # across where the root is 0
            one["a"] = 0.8 * one["b"]
            two = {**one, "t": -one["t"]}
        p, q = (drawn_formulas.value(g, x) for x in (one, two))
        for share in (0.5, 0.01, 0.9):
            middle = drawn_formulas.value(g, {f: one[f] * (1 - share) + two[f] * share for f in FORCES})
            if math.isfinite(middle) and middle > max(p, q) + 1e-9 * (1 + abs(p) + abs(q)):
                return f"{one}, {two}, {share}"
    return None


def test_the_chords_would_show_a_neighbour() -> None:
    """Of laws that are not convex by little, so that the silence of the chords says something."""
    rng = Random(5)
    wrong = (
        f"abs({U} + {R})**3 + abs({U} - 2*{R})**3 - 1",
        "(abs(a - b) - 1.5*(a - b))**3 + abs(t) - 1",
        "b + pos(max(a, t)) - 3*neg(max(a, t))",
    )
    for g in wrong:
        stated = StatedLaw.read(law_as_text(law(g.replace("h", "0.8").replace("p*t", "1.3*t"))))
        assert _chord(stated.g, rng, 4000) is not None, g
