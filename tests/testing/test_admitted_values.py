"""Values of parameters are built inside the constraints, however little these leave."""

from __future__ import annotations

from random import Random

import pytest

import duhem
from duhem.errors import InputError
from duhem.law.atlas.entry import file_of, groups
from duhem.law.formula_law import Criterion
from duhem.testing.drawn.values import Admitted, admitted
from tests.long import mostly_long


def law(order: str, *constraints: str) -> Criterion:
    domains = {name: duhem.Domain(positive=True) for name in order}
    return duhem.Criterion(
        name="x", g=f"norm(u, v) - {' - '.join(order)}", forces=("u", "v"), pressure=None, parameters=domains, constraints=constraints
    )


def values(found: Admitted, n: int = 20) -> list[dict[str, float]]:
    dice = Random(1)
    return [found.values(dice.randrange) for _ in range(n)]


THIN = {
    "a slice": ("abc", ["a < b", "b < 1.0001*a"]),
    "a chain declared backwards": ("cab", ["a < b", "b < c"]),
    "a sum that only large ones reach": ("abc", ["a + b + c > 5000", "c < 1"]),
    "a product": ("cab", ["a*b < c**2", "c < a"]),
}


@pytest.mark.slow
@pytest.mark.parametrize("name", mostly_long(THIN, "a slice"))
def test_every_draw_is_admitted(name: str) -> None:
    order, constraints = THIN[name]
    found = admitted(law(order, *constraints))
    drawn = values(found)
    assert all(found.holds(each) for each in drawn)
    assert len({tuple(sorted(each.items())) for each in drawn}) > 15
    assert max(each["a"] for each in drawn) > 100 * min(each["a"] for each in drawn)


def test_values_beside_the_ends_are_among_them() -> None:
    found = admitted(law("ab", "a < b"))
    table = found.table("b", {"a": 1.0})
    assert min(table) < 1.0 + 1e-12 and max(table) > 1e3 and table[0] in (10.0, 1.5, 2.0, 4.1)
    assert [x for x in table if not found.holds({"a": 1.0, "b": x})] in ([], [1.0])


def test_a_dead_end_is_left_by_what_is_known() -> None:
    """In this order the first two may leave nothing to the third."""
    chain = law("cab", "a < b", "b < c")
    blind = Admitted(chain, ("c", "a", "b"), {"c": 3.0, "a": 1.0, "b": 2.0})
    assert blind.table("b", {"c": 1.0, "a": 2.0}) == []
    assert all(blind.holds(each) for each in values(blind, 4))
    changed = blind.values(lambda n: 0)  # 1 for the first two
    assert blind.holds(changed) and changed["c"] != 3.0
    with pytest.raises(InputError, match="no parameters that x admits"):
        Admitted(chain, ("c", "a", "b")).values(lambda n: 0)


def _constrained(name: str) -> bool:
    """By its text: to load every law takes seconds, in every process that collects tests."""
    file = file_of(name)
    return file is not None and "\nconstraints = " in file.read_text("utf-8")


CONSTRAINED = [name for of_group in groups().values() for name in of_group if _constrained(name)]


@pytest.mark.slow
@pytest.mark.parametrize("name", mostly_long(CONSTRAINED, "zmitrowicz"))
def test_constrained_laws_of_the_atlas(name: str) -> None:
    known = duhem.load(name)
    assert known.constraints
    found = admitted(known)
    for each in values(found, 10):
        assert found.holds(each)
        known.fix(each)
