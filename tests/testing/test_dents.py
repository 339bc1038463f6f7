"""Dents of K in planes of forces: each is found at every seed and told in numbers that show it, and no convex K has one."""

from __future__ import annotations

import re

import numpy as np
import pytest
import sympy as sp

import duhem
from duhem.law.formula_law import Criterion
from duhem.testing import Report, conformance
from duhem.testing.checks.law_checks import Dents
from duhem.testing.checks.query import Query
from duhem.testing.drawn.case import Case, Region
from tests.long import long_but, mostly_long
from tests.testing.test_atlas_increments import ENTRIES, text_of
from tests.testing.test_properties import ALWAYS, AT_VALUES


def nothing(trial: np.ndarray, *_: object, **__: object) -> np.ndarray:
    return trial  # the checks of the law never ask


def asked(law: Criterion, seed: int, examples: int = 7) -> Report:
    return conformance(law, nothing, checks=["convexity"], max_examples=examples, rows=28, seed=seed, tries=20)


def of(g: str, forces: str = "a b", pressure: str | None = None) -> Criterion:
    return Criterion("set", g, {}, tuple(forces.split()), pressure)


DENTED = {
    "limacon, e = 0.51": duhem.load("limacon").fix({"e": "0.51"}),
    "limacon, e = 0.6": duhem.load("limacon").fix({"e": "0.6"}),
    "limacon, e = 0.9": duhem.load("limacon").fix({"e": "0.9"}),
    "the less of two boxes": of("min(max(abs(a)/2, abs(b)) - 1, max(abs(a), abs(b)/2) - 1)"),
    "the less of two thin ellipses": of("min(a**2/4e12 + b**2 - 1, a**2/1e12 + b**2/4 - 1)"),
    "far from the origin": of("min((a - 3)**2/4 + b**2 - 10, (a - 3)**2 + b**2/4 - 10)"),
    "a power of 0.99": of("abs(a)**0.99 + abs(b)**0.99 - 1"),
    "roots under pressure": of("sqrt(abs(a)*abs(p)) + sqrt(abs(b)*abs(p)) - 0.3*abs(p)", pressure="p"),
    "a dented square": of("max(abs(a), abs(b)) - 1 + 0.05*pos(0.2 - abs(b))"),
    "a wedge cut out": of("max(norm(a, b) - 1, 0.9 - a - 30*abs(b - 0.3))"),
    "without end": of("max(abs(a) - b, b - 1 - abs(a)/2)"),
    "three forces": of("abs(a)**0.8 + abs(b)**0.8 + abs(c)**0.8 - 1", "a b c"),
    "six forces": of("norm(a, b, c, d, e, f)**4 - norm(a, b, c, d, e, f)**3 - 0.5*(a**3 - 3*a*b**2)", "a b c d e f"),
}
WAISTED = "norm(a, b) - 0.3*abs(p)*(1 + {e}*a**4/norm(a, b)**4)"  # symmetric, without value at the origin
LOBED = "norm(a, b)**5 - norm(a, b)**4 - {e}*(a**3 - 3*a*b**2)*norm(a, b)"  # 0 there
SPATIAL = "norm(a, b, c)**5 - norm(a, b, c)**4 - {e}*a**4"
DENTED |= {
    "no value at the origin": of(WAISTED.format(e=0.6), pressure="p"),
    "lobes, 0 at the origin": of(LOBED.format(e=0.13)),
    "three forces, 0 at the origin": of(SPATIAL.format(e=0.6), "a b c"),
    "three forces, no value at the origin": of("norm(a, b, c) - 1 - 0.6*a**4/norm(a, b, c)**4", "a b c"),
}
EVERY = [(name, seed) for name in DENTED for seed in range(15)]
ORIGIN = [("no value at the origin", 1), ("lobes, 0 at the origin", 2), ("three forces, 0 at the origin", 0)]
KEPT = [
    *ORIGIN,
    ("limacon, e = 0.51", 0),
    ("limacon, e = 0.6", 3),
    ("far from the origin", 1),
    ("without end", 2),
    ("roots under pressure", 4),
]


@pytest.mark.slow
@pytest.mark.parametrize(("name", "seed"), long_but([18, 76, 152, 212], EVERY))
def test_a_dent_is_found_at_every_seed_and_told_by_stresses_that_show_it(name: str, seed: int) -> None:
    law = DENTED[name]
    (failure,) = asked(law, seed).failures
    case, table = failure.case, law.symbols()
    exact = {table[each]: sp.Rational(case.parameters[each]) for each in law.parameters}
    exact |= {} if law.pressure is None or case.pressure is None else {table[law.pressure]: sp.Rational(float(case.pressure[0]))}
    ends = case.inside[0], case.beside[0]
    level = [
        sp.N(law.g.subs(exact | dict(zip(law.force_symbols(), map(sp.Rational, point.tolist()), strict=True))), 60)
        for point in (*ends, 0.5 * (ends[0] + ends[1]))
    ]
    assert max(level[:2]) <= 0.0 < level[2]
    assert all(f"[{', '.join(f'{x:.6g}' for x in end)}]" in failure.message for end in ends)


def test_a_dent_that_is_deep_is_told_in_round_numbers() -> None:
    (failure,) = asked(DENTED["limacon, e = 0.6"], 0).failures
    assert failure.case.parameters == {"mu": 1.0, "e": 0.6} and failure.case.pressure == [-1.0]
    assert failure.message == "[-0.41, 0.3] and [-0.41, -0.3] lie in K, and their midpoint [-0.41, 0] does not"


# An increment of a law with a state or with rates is no closest point of K, and is not asked for alone.
MORE = re.compile(r"^\[(energy|dissipation)\]", flags=re.M)
CONVEX = [(*law, 0) for law in (*ALWAYS, *AT_VALUES)] + [
    (name, {}, 0) for name, entry in ENTRIES.items() if entry.verdicts["convexity"] != "refuted" and not MORE.search(text_of(name))
]


@pytest.mark.slow
@pytest.mark.parametrize(
    ("name", "values", "seed"),
    mostly_long(
        [(name, values, seed) for name, values, _ in CONVEX for seed in range(5)],
        ("limacon", {"e": "1/2"}, 0),
        ("coulomb", {}, 1),
        ("tresca", {}, 0),
        ("cpb06", {}, 0),  # |s| + s is 0 for s < 0, and a little less by rounding in 60 digits
    ),
    ids=str,
)
def test_no_convex_set_is_said_to_have_one(name: str, values: dict[str, str], seed: int) -> None:
    report = asked(duhem.load(name).fix(values), seed, 10)
    assert not report.failed and report.tried["convexity"]["pairs of stresses"] >= 280


ROUND = {
    "no value at the origin": of(WAISTED.format(e=0.1), pressure="p"),
    "lobes": of(LOBED.format(e=0.09)),  # convex to 0.1
    "three forces": of(SPATIAL.format(e=0.1), "a b c"),
}


@pytest.mark.slow
@pytest.mark.parametrize(
    ("name", "seed"), mostly_long([(name, seed) for name in ROUND for seed in range(5)], *((name, 0) for name in ROUND))
)
def test_nor_one_whose_g_is_zero_at_the_origin_or_has_no_value_there(name: str, seed: int) -> None:
    report = asked(ROUND[name], seed, 4)
    assert not report.failed and report.tried["convexity"]["pairs of boundary points"] >= 4 * 64 * 31


def test_where_no_stress_surely_lies_inside_the_report_says_that_boundary_points_were_left_out() -> None:
    (said,) = asked(of("pos(norm(a, b) - 1)"), 0, 2).tested()
    lacking = "and on no pairs of boundary points, which need a stress inside K, and none is known"
    assert said == f"convexity was tested only on 56 pairs of stresses, {lacking}; duhem verify searches for a proof"
    assert "which need" not in asked(of("norm(a, b) - 1"), 0, 2).tested()[0]
    assert "boundary" not in asked(of("abs(a) - 1", "a"), 0, 2).tested()[0]  # two points


def planes(law: Criterion, trial: list[list[float]], inside: list[list[float]], beside: list[list[float]]) -> Dents:
    zero, none = np.zeros((len(trial), 2)), np.zeros(len(trial))
    case = Case({}, np.eye(2), None, zero, zero, zero, np.array(inside), np.array(beside), none, 2.0, zero[:, None], None)
    return Dents(Query(Region(law, {}), case, nothing, (), 1e-9))


def test_two_planes_of_a_case_are_looked_at_and_those_of_a_set_without_a_point_inside_are_not() -> None:
    zero, way = [[0.0, 0.0]] * 3, [[1.0, 0.0], [0.0, 1.0], [1.0, 1.0]]
    assert planes(of("norm(a, b) - 1"), zero, way, way).pairs == 2 * 64 * 31
    assert planes(of("norm(a, b)"), zero, way, way).pairs == 0


def test_what_rounding_makes_of_a_flat_side_is_no_dent() -> None:
    """Whose ends lie on a side to the last digit; and a dent of a part in 10^13, less than the middle is moved by."""
    inner = np.zeros(2)
    side = Region(of("max(abs(a), abs(b)) - 1"), {})
    assert not side.dented(np.array([1.0, 0.7]), np.array([1.0, -0.1]), inner, 0.0)
    for depth, dented in (("1e-13", False), ("1e-11", True)):
        hollow = Region(of(f"max(abs(a), abs(b)) - 1 + {depth}*pos(1 - abs(b))"), {})
        assert hollow.dented(np.array([1.0, 1.0]), np.array([1.0, -1.0]), inner, 0.0) is dented
    assert not Region(of("norm(a, b) - 1"), {}).dented(np.array([1.1, 0.0]), np.array([1.0, 1.0]), inner, 0.0)  # neither lies in K
