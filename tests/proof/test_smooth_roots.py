"""Sums that are even in a root are C^1 where the root is 0, a cone beside it is not: each with neighbours that have a corner."""

import pytest
import sympy as sp

from duhem import Criterion, Domain
from duhem.proof.certificate import law_as_text
from duhem.proof.kernel.certificate import stated
from duhem.proof.kernel.claims import objection
from duhem.proof.kernel.curvature import over
from duhem.proof.kernel.regularity import smooth_near_the_boundary
from duhem.proof.kernel.stated_law import StatedLaw
from tests.long import long_but, mostly_slow
from tests.oracles.prover import composition
from tests.oracles.prover.decide import AskedSubject
from tests.oracles.prover.even_roots import even, freed
from tests.oracles.prover.regularity import regularity

U, R = "(a + b)/2", "sqrt(((a - b)/2)**2 + t**2)"
PAIR = f"abs({U} + {R})**m + abs({U} - {R})**m"
ABOVE_ONE = (Domain.between(1), "m > 1")


def law(g: str, m: Domain | None, *constraints: str, **more: Domain) -> Criterion:
    parameters = {"m": m, **more} if m else more
    return Criterion("law", g, parameters, forces=("a", "b", "t"), pressure=None, constraints=constraints)


SMOOTH = [
    law(PAIR + " - 1", Domain.fixed(3)),
    law(PAIR + " - 1", *ABOVE_ONE),
    law(PAIR + f" + (2 - c)*(2*{R})**m - 1", *ABOVE_ONE, c=Domain.between(0, 2)),
    law(f"({PAIR})**(1/m) - 1", *ABOVE_ONE),
    law(f"pos({U} + {R})**m + pos({U} - {R})**m - 1", *ABOVE_ONE),
    law(f"exp({U} + {R}) + exp({U} - {R}) - 3", None),
    law("abs(a + norm(b, t))**3 + abs(a - norm(b, t))**3 - 1", None),
]
CORNERED = [
    law(PAIR + " - 1", Domain.between(1)),  # for m = 1 the greatest of |u| and r
    law(PAIR + " - 1", Domain.fixed(1)),
    law(f"abs({U} + {R})**3 + 2*abs({U} - {R})**3 - 1", None),  # not even in the root
    law(f"2*abs({U} + {R})**3 + abs({U} - {R})**3 - 1", None),
    law(f"{R} + a**2 + b**2 - 1", None),  # a tip where a = b, t = 0
    law(f"pos({U} + {R}) + pos({U} - {R}) - 1", None),
    law(f"exp({U} + {R}) + exp({U}) - 3", None),
    law("abs(a + norm(b, t)**(1/2))**3 + abs(a - norm(b, t)**(1/2))**3 - 1", None),  # the square of the root is a cone
    law(f"{PAIR} + abs(a) - 1", Domain.fixed(3)),
    law("abs(a + norm(b, pos(t) + 1))**3 + abs(a - norm(b, pos(t) + 1))**3 - 9", None),  # a kink inside the root
    law(f"({PAIR})**(1/m) - k", *ABOVE_ONE, k=Domain.between(0, 1)),  # for k = 0 a point
]


@pytest.mark.slow
@pytest.mark.parametrize("law", long_but([1, 2, 5, 6], mostly_slow(SMOOTH, SMOOTH[-1])), ids=lambda law: law.written[:40])
def test_even_in_a_root_is_smooth(law: Criterion) -> None:
    assert not objection("smoothness", "composition", frozenset(), stated(law_as_text(law)), {})
    assert composition.smoothness(AskedSubject(law)) is not None


@pytest.mark.parametrize("law", long_but([1, 3, 4, 6, 9, 10], mostly_slow(CORNERED, CORNERED[-1])), ids=lambda law: law.written[:40])
def test_a_corner_beside_it_is_seen(law: Criterion) -> None:
    """Whether or not K is convex, which would be asked too."""
    text, subject = stated(law_as_text(law)), AskedSubject(law)
    assert isinstance(text, StatedLaw) and not smooth_near_the_boundary(text.g, over(text))
    found = regularity(subject.simple.g, subject)
    assert not found.known or found.kinks or found.tips
    assert composition.smoothness(subject) is None


def test_roots_of_one_thing_in_two_forms_are_one() -> None:
    x, y, t = forces = sp.symbols("x y t", real=True)
    roots = [sp.sqrt((x / 2 - y / 3) ** 2 + t**2), sp.sqrt((-x / 2 + y / 3) ** 2 + t**2)]
    assert roots[0] != roots[1]
    expr, meant = next(freed((x + roots[0]) ** 8 + (roots[1] - x) ** 8, roots, forces))
    assert list(meant.values()) == roots[:1] and even(expr, meant)
    expr, meant = next(freed((x + roots[0]) ** 8 + (roots[1] - x - y) ** 8, roots, forces))
    assert len(meant) == 1 and not even(expr, meant)
