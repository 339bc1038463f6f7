"""Edges of sets in several forces: cusps and ridges at exact points, dents beside them, and neighbours that are smooth or convex."""

from __future__ import annotations

import pytest

from duhem import Criterion
from duhem.proof.facts.formula_subject import FormulaSubject
from duhem.proof.methods.refuters import convexity_beside_edges, normality_at_chord, smoothness_at_sharp_points
from duhem.proof.search.edges import edges
from tests.long import long_but
from tests.oracles.reevaluation import confirmed


def law(g: str) -> Criterion:
    forces = tuple(x for x in "abcde" if x in g.replace("abs", "").replace("max", ""))
    return Criterion(name="law", g=g, forces=forces, pressure=None)


def subject(criterion: Criterion) -> FormulaSubject:
    found = FormulaSubject(criterion)
    found.allow(8_000_000)
    return found


def test_edges_are_where_all_loads_but_one_vanish() -> None:
    one = subject(law("abs(a - b)**(3/2) + abs(b + 2*c) + c**4 - abs(a + 1) + max(a - b, 0) + where(b + 2*c > 1, a - b, 0)**4 - 1"))
    ways = ((-2, -2, 1), (1, 0, 0), (1, 1, 0))
    assert set(edges(one.simple.g, one.simple.forces)) == {*ways, *(tuple(-c for c in way) for way in ways)}


def test_every_load_is_left_out_by_some_edge_and_none_is_told_twice() -> None:
    loads = ["a", "a + b", "b - c", "c + d", "d - e", "a - e", "b + e", "2*a"]
    one = subject(law(" + ".join(f"abs({load})**{k + 2}" for k, load in enumerate(loads)) + " - 1"))
    forces = one.simple.forces
    found = edges(one.simple.g, forces)
    assert len(found) == len(set(found))
    for load in loads:
        assert any(eval(load, dict(zip("abcde", edge, strict=True))) for edge in found)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("g", "sharp"),
    long_but(
        [0, 3, 8, *range(10, 13)],
        [
            ("abs(a + b)**(1/5) + (a - 2*b)**4 - 1", True),
            ("abs(a + b)**(1/5) + abs(b - c)**(17/10) + (a - 2*b + c/3)**4 - 1", True),
            pytest.param("abs(a + b)**(999999/1000000) + abs(b - c)**(17/10) + (a - 2*b + c/3)**4 - 1", True, marks=pytest.mark.long),
            ("abs(a + b) + abs(b - c)**(17/10) + (a - 2*b + c/3)**4 - 1", True),
            pytest.param("abs(a + b)**(1000001/1000000) + abs(b - c)**(17/10) + (a - 2*b + c/3)**4 - 1", False, marks=pytest.mark.long),
            ("abs(a + b)**(6/5) + (a - 2*b)**4 - 1", False),
            ("(abs(a/3 + b)**(9/10) + abs(b - c)**(9/10) + abs(2*c - a)**(9/10))**(10/9) - 1", True),
            pytest.param(
                "(abs(a/3 + b)**(11/10) + abs(b - c)**(11/10) + abs(2*c - a)**(11/10))**(10/11) - 1", False, marks=pytest.mark.long
            ),
            ("norm(a + b, b - c, 2*c) - 1", False),
            ("norm(a + b, b - c, 2*c) + abs(a)/3 - 1", False),  # a ridge where no fraction is on the boundary
            ("2*a**2 + b**2 + 3*abs(a*b) - 1", True),
            ("max(abs(a + b), abs(2*b), abs(c)) - 1", False),  # faces: a corner, and no point
            ("-abs(a + b)**(1/2) + (a - 2*b)**4 - 1", False),
        ],
    ),
)
def test_a_sharp_edge_at_a_fraction(g: str, sharp: bool) -> None:
    criterion = law(g)
    found = smoothness_at_sharp_points(subject(criterion))
    assert (found is not None) is sharp
    if found is not None:
        assert found.witness is not None and confirmed(criterion, "smoothness", found.witness)


@pytest.mark.parametrize(
    ("g", "dented"),
    [
        ("abs(a + b)**(999999999/1000000000) + (2*a - b)**2 - 1", True),
        ("abs(a + b)**(9999/10000) + abs(b - c)**(17/10) + (a - 2*b + c/3)**4 - 2/3", True),
        ("abs(a + b) + abs(b - c)**(17/10) + (a - 2*b + c/3)**4 - 1", False),
        ("abs(a + b)**(1000000001/1000000000) + (2*a - b)**2 - 1", False),
        ("abs(a + b)**(999999999/1000000000) + (2*a - b)**2 + 1", False),  # nothing
        ("(abs(a + b)**(999999999/1000000000))**2 + (2*a - b)**2 - 1", False),
        ("3*abs(a + b) - abs(a + b)**2/10**9 + (2*a - b)**2 - 1", False),  # beside the edge the other square outweighs it
        ("3*abs(a + b) - abs(a + b)**2/10**9 + abs(2*a - b) - 1", True),
        ("where(a > 1, 1, -1) + abs(b)**(99/100)", False),  # g does not rise towards the end of the edge: it jumps there
        ("max(where(a > 1, 1, -1), where(b > 1, 1, -1)) + abs(a)**(99/100)/9", False),
        ("max(abs(a)**(99/100) + abs(b) - 1, log(1/2 - abs(a - b)))", True),  # g has no value at the ends of other edges
    ],
)
def test_a_dent_beside_an_edge(g: str, dented: bool) -> None:
    criterion = law(g)
    found = convexity_beside_edges(subject(criterion))
    assert (found is not None) is dented
    if found is not None:
        assert found.witness is not None and confirmed(criterion, "convexity", found.witness)


@pytest.mark.slow
@pytest.mark.parametrize(
    "g",
    [
        "abs(a + b)**(999999/1000000) + abs(b - c)**(17/10) + (a - 2*b + c/3)**4 - 1",  # the chord lies where two loads are 0
        pytest.param(
            "abs(a)**(999/1000) + abs(a + b)**(3/2) + abs(b - c)**2*abs(b - c) + abs(c + d) + abs(d - e)**3 + abs(a - e) + abs(b + e) - 1",
            marks=pytest.mark.long,
        ),
    ],
)
def test_the_slip_beside_such_a_dent(g: str) -> None:
    """Of the second there are too many branches to list."""
    criterion = law(g)
    one = subject(criterion)
    chord = convexity_beside_edges(one)
    assert chord is not None and chord.witness is not None
    found = normality_at_chord(one, {"convexity": chord})
    assert found is not None and found.witness is not None
    assert confirmed(criterion, "normality", found.witness)
