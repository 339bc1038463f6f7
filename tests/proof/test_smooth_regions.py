"""Sets that are round at the ends of their loads, each beside one that has a tip, an edge or a corner there."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from random import Random

import pytest

from duhem import Criterion, Domain
from duhem.proof.certificate import law_as_text
from duhem.proof.kernel.certificate import stated
from duhem.proof.kernel.claims import objection
from duhem.proof.kernel.stated_law import StatedLaw
from tests.long import long_but
from tests.oracles import drawn_formulas
from tests.oracles.prover import rounded
from tests.oracles.prover.decide import AskedSubject

between, fixed = Domain.between, Domain.fixed
P = "((p + 1/2)/2)"
J2, J3 = "((a-b)**2+(b-p)**2+(p-a)**2)/6", "(2*a-b-p)*(2*b-p-a)*(2*p-a-b)/27"
COS = f"(3*sqrt(3)/2)*({J3})/({J2})**(3/2)"
DROP = "max(A - sqrt(pos((P - pos(P)**m)*(2*(1 - k)*P + k))), -P, P - 1)"  # Bigoni, Piccolroaz (2004), A = norm(a, b) for one
LODE = DROP.replace("A", f"sqrt({J2})*cos(beta*pi/6 - acos(gamma*{COS})/3)").replace("P", "(1/3 - (a + b + p)/9)")
PLAIN = {"k": between("1/10", "19/10"), "m": between("11/10", 3)}
SHAPE = {"k": fixed("0.3"), "m": fixed(2), "beta": fixed("0.19")}


def spelt(g: str, gauge: str = "norm(a, b)", load: str = P, **_: Domain) -> str:
    return g.replace("A", gauge).replace("P", load)


def law(*parts: str, load: str = P, **domains: Domain) -> Criterion:
    g = spelt(*parts, load=load)
    given = {name: domain for name, domain in domains.items() if name in g}
    return Criterion("law", g, given, forces=("a", "b", "p"), pressure=None)


later = partial(partial, law)  # a law is made where it is asked for, not by all who collect tests

ROUND = [
    pytest.param(later(DROP, **PLAIN), marks=pytest.mark.slow),
    pytest.param(later(DROP, "norm(a + b/2, pos(b))", **PLAIN), marks=pytest.mark.long),
    pytest.param(later(DROP, "abs(a + b)", **PLAIN), marks=pytest.mark.long),
    pytest.param(later("max(A - 2*(P - P**2)**(2/3), -P, P - 1)"), marks=pytest.mark.slow),
    later("max(A**2 - (P - P**2)**(2/3), -P, P - 1)"),
    pytest.param(later("max(A - k*(P - P**2)**m, -P, P - 1)", k=Domain(positive=True), m=between("1/9", "8/9")), marks=pytest.mark.slow),
    pytest.param(later(LODE, gamma=between("-9/10", "9/10"), **SHAPE), marks=pytest.mark.long),
]
NOT_ROUND = [
    later(DROP, k=between(0, 1), m=fixed(2)),  # k = 0: the root rises like the load, a tip
    pytest.param(later(DROP, k=between(1, 2), m=fixed(2)), marks=pytest.mark.long),  # k = 2: so at the other end
    later(DROP, k=fixed(1), m=between(1, 3)),  # m = 1: a line
    later(DROP, "(abs(a) + abs(b))", **PLAIN),  # edges
    pytest.param(later(DROP, "(norm(a, b) + 1/10)", **PLAIN), marks=pytest.mark.long),  # the tip of the norm lies on the boundary
    pytest.param(later(DROP, "(norm(a, b) - 1/10)", **PLAIN), marks=pytest.mark.long),  # K ends in discs
    later(DROP, "(a**2 + b**2 - 1/100)", **PLAIN),
    later("max(A - (P*(1 - P)*(1 + 20*P)*(1 + 20*P))**(9/10), -P, P - 1)"),  # not convex, though each factor is concave
    later("max(A - sqrt(P**2*(1 - P)), -P, P - 1)"),  # a tip: what is 0 there is not concave
    later(DROP.replace("-P,", "-P, a - 1/10,"), **PLAIN),  # cut by a load that no root knows of
    pytest.param(later(DROP.replace("-P,", "-P, -P/2,"), **PLAIN), marks=pytest.mark.long),  # twice the same end: not asked for
    later("max(A - 2*(P - P**2)**m, -P, P - 1)", m=between("1/2", 1)),  # m = 1: tips
    later("max(A - sqrt(P), -P, P - 1)"),  # K ends in a disc
    later("max(A - sqrt(P*(2 - P)), -P, P - 1)"),
    later("max(A - sqrt(P - P**2) - sqrt(P), -P, P - 1)"),
    later("max(A - sqrt(pos(P*(1 - P)*(1 - P))), -P, P - 1)"),  # not concave
    later("max(A - sqrt(pos((1 - abs(2*P - 1))*(1 + P))), -P, P - 1)"),  # a kink of the root between the ends
    later("max(A - sqrt(pos(pos(P)*(1 - P))), P - 1)"),  # one end is not said
    later("max(A - sqrt(P - P**2), -P, P - 1, norm(a, b) - 1/4)"),  # cut by a cylinder
    pytest.param(later(LODE, gamma=fixed(1), **SHAPE), marks=pytest.mark.long),  # corners of the section
    later(DROP, load="((p - 1/2)/2)", **PLAIN),  # the origin is not in K: where else g < 0 is not said
]


def confirmed(law: Criterion, **inside: str) -> bool:
    return not objection("smoothness", "composition", frozenset(), stated(law_as_text(law)), {"inside": inside})


@pytest.mark.parametrize("made", long_but([3, 5], ROUND), ids=lambda made: spelt(*made.args, **made.keywords)[:40])
def test_round_at_its_ends(made: Callable[[], Criterion]) -> None:
    law = made()
    assert confirmed(law)
    if not law.parameters:  # the deciders of the second opinion do not know powers with free exponents
        assert rounded.smoothness(AskedSubject(law)) is not None


@pytest.mark.slow
@pytest.mark.parametrize(
    "made", long_but([0, *range(6, 9), *range(11, 19), 20], NOT_ROUND), ids=lambda made: spelt(*made.args, **made.keywords)[:40]
)
def test_a_neighbour_is_not_shown_to_be(made: Callable[[], Criterion]) -> None:
    law = made()
    assert not confirmed(law)
    assert rounded.smoothness(AskedSubject(law)) is None


@pytest.mark.slow
def test_a_point_inside_may_be_told() -> None:
    assert confirmed(NOT_ROUND[-1](), p="1") and not confirmed(NOT_ROUND[-1](), p="5/2")


def profile(rng: Random) -> str:
    """Half the width of K along p, perhaps 0 at p = 0 and p = 1."""
    rest = rng.choice(("p*(1 - p)", "p - pos(p)**M", "p*(2 - p)", "min(p, 1 - p)", "p - p*abs(p)", "p*(1 - p)*(1 + k*p)", "p*(k - p)"))
    rest = rest.replace("M", rng.choice(("1/2", "3/2", "3"))).replace("k", rng.choice(("1", "2", "1/2")))
    return f"pos({rest})**({rng.choice(('1/2', '1/3', '1', '2/3'))})"


def has_a_corner(text: StatedLaw) -> bool:
    """By the width at points close to each other: it jumps at the ends, does not rise steeply, or has a kink between."""

    def width(p: float) -> float:
        return -drawn_formulas.value(text.g.args[0], {"a": 0.0, "p": p})

    tips = any(not width(end) == 0 < width(beside) > 50 * abs(end - beside) for end, beside in ((0.0, 1e-7), (1.0, 1 - 1e-7)))
    slopes = [[(width(p + h) - width(p)) / h for h in (1e-6, -1e-6)] for p in (0.25, 0.5, 0.75)]
    return tips or any(abs(one - two) > 1e-3 for one, two in slopes)


@pytest.mark.long
def test_what_is_confirmed_of_drawn_profiles_has_no_corner() -> None:
    rng, shown, cornered = Random(3), 0, 0
    for _ in range(40):
        g = f"max(abs(a) - {profile(rng)}, -p, p - 1)"
        text = stated(law_as_text(Criterion("law", g, {}, forces=("a", "p"), pressure=None)))
        assert isinstance(text, StatedLaw)
        holds, corner = not objection("smoothness", "composition", frozenset(), text, {"inside": {"p": "1/2"}}), has_a_corner(text)
        assert not (holds and corner), g
        shown, cornered = shown + holds, cornered + corner
    assert shown > 4 and cornered > 8  # else nothing was asked
