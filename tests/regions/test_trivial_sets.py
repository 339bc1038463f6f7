"""Where K is everything, empty or one point, and where only a corner of the ranges is not convex: cells like any others."""

from __future__ import annotations

import random
from fractions import Fraction
from typing import Any

import pytest

import duhem
from duhem.proof.certificate import law_as_text
from duhem.proof.kernel.certificate import stated
from duhem.proof.kernel.claims import objection
from duhem.regions import PavedRegion
from duhem.show.printing import latex, text
from tests.long import long_but

BETWEEN = duhem.Domain.between
BOX = {"x": BETWEEN(-1, 1), "y": BETWEEN(-1, 1)}


def law(g: str, domain: Any = None, **parameters: duhem.Domain) -> duhem.Criterion:
    return duhem.Criterion(name="sets", pressure=None, forces=("x", "y"), g=g, domain=domain or {}, parameters=parameters)


@pytest.mark.parametrize(
    ("rule", "g", "holds"),
    [
        ("sign", "-x**4 - x**2*y**2 - 1", True),  # everything
        ("sign", "x**4 - x**2*y**2 + y**4 + 1", True),  # empty
        ("sign", "x*y - 1 - x**2 - y**2", True),
        ("sign", "-x**2*y**2", True),
        ("sign", "x**4 + 9*x**2*y**2 + y**4", False),  # one point
        ("sign", "x**2*y**2", False),  # two lines
        ("sign", "1 - x**2*y**2", False),
        ("sign", "-1/(x*y)**2", False),  # has not always a value
        ("polar-sign", "x**4 + 9*x**2*y**2 + y**4", True),
        ("polar-sign", "abs(x*y) + x**2 + y**2", True),
        ("polar-sign", "norm(x, y)**3 + x**2*norm(x, y) - 3*x*y**2 + x**2 + y**2", True),
        ("polar-sign", "abs(x) + abs(y) - norm(x, y)/2", True),
        ("polar-sign", "abs(x) + abs(y) - norm(x, y)", False),  # two lines
        ("polar-sign", "x**4 - 2*x**2*y**2 + y**4", False),
        ("polar-sign", "x**4 - 3*x**2*y**2 + y**4", False),
        ("polar-sign", "where(x > 0, x**2 + y**2, x**2 - y**2)", False),
        ("polar-sign", "where(x >= 0, 1, -1)*(x**2 + y**2)", False),
        ("polar-sign", "x**2*y**2 + x**2 - x**3", False),
    ],
)
def test_sets_without_a_boundary(rule: str, g: str, holds: bool) -> None:
    known = stated(law_as_text(law(g)))
    assert (objection("convexity", rule, frozenset(), known, {}) == "") is holds


@pytest.mark.parametrize(
    ("g", "condition"),
    [
        ("x**4 + 9*x**2*y**2 + y**4 - r", "r <= 0"),
        ("x**4 + 9*x**2*y**2 + y**4 - r**2", "r = 0"),
        *long_but([], [("r*x**4 - y**4 - 1", "r <= 0"), ("x**2 + r**2*x*y - 1", "r = 0")]),
    ],
)
def test_a_region_of_one_parameter_has_such_sets(g: str, condition: str) -> None:
    done = duhem.region(law(g, r=BETWEEN(-1, 2)), steps=10_000_000)
    assert done.exact and done.short == condition and duhem.recheck(done.certificate()).ok


def test_a_region_of_two_parameters_has_such_sets() -> None:
    """a x^4 + b y^4 <= 1: everything, a strip, bounded, or two branches that no point between them joins."""
    done = duhem.region(law("a*x**4 + b*y**4 - 1", a=BETWEEN(-1, 3), b=BETWEEN(-2, 1)), steps=10_000_000)
    assert isinstance(done, PavedRegion) and done.exact and duhem.recheck(done.certificate()).ok
    draw = random.Random(5)
    for a, b in [(draw.randrange(-8, 25), draw.randrange(-16, 9)) for _ in range(60)]:
        point = {"a": Fraction(a, 8), "b": Fraction(b, 8)}
        said = {cell.verdict for cell in done.cells if eval(cell.condition, {}, dict(point))}
        assert said == {"proved" if (a >= 0) == (b >= 0) or 0 in (a, b) else "refuted"}, point
    assert "a = 0 and " in done.sentence and "a == 0 and " in done.condition and "a = 0" in text(done) and "a = 0" in latex(done)


CORNERS = ("e - (x - 1)**2 - (y - 1)**2", "e - (x + 1)**2 - 3*(y - 1)**2", "e - 12*max(abs(x - 1), abs(y + 1))**2")


@pytest.mark.parametrize("g", long_but([0], CORNERS))
def test_a_corner_that_is_cut_out_is_seen(g: str) -> None:
    """K is the ranges without a small part at a corner, and no chord leaves it but there."""
    done = duhem.region(law(g, BOX, e=BETWEEN("1/200", "1/160")), steps=3_000_000)
    assert done.exact and done.condition == "false" and duhem.recheck(done.certificate()).ok
    for cell in done.cells:
        assert cell.witness is not None and cell.witness["rule"] == "chord"
        said = [cell.witness[key].get(f, "0") for f in ("x", "y") for key in ("p", "q")]
        assert all(abs(eval(text, {"e": e})) <= 1 for text in said for e in (1 / 200, 1 / 180, 1 / 160))


def test_a_corner_that_is_cut_off_by_a_line_is_convex() -> None:
    done = duhem.region(law("e - abs(x - 1) - abs(y - 1)", BOX, e=BETWEEN("1/10", "1/4")), steps=300_000)
    assert all(cell.verdict != "refuted" for cell in done.cells)


def test_a_line_leaves_what_is_no_polynomial_of_all_forces() -> None:
    """exp(x) + c y^2 <= 2 contains all of a line along y but a part, where c < 0."""
    done = duhem.region(law("exp(x) + c*y**2 - 2", c=BETWEEN(-1, 1)), steps=3_000_000)
    assert done.exact and done.short == "c >= 0" and duhem.recheck(done.certificate()).ok
    assert all(cell.witness["rule"] == "line" for cell in done.cells if cell.witness is not None)
